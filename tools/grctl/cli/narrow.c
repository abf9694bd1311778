/* SPDX-License-Identifier: MIT */
/* --line: one line of a robot that has several, as a robot of its own. */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/lines.h>
#include <grobo/session.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/narrow.h"

typedef struct narrowed {
    const grobo_robot_def *whole;
    int line;
    grobo_robot_def def;
    char name[2 * GROBO_NAME_MAX_BYTES];
    double rest_rad[GROBO_JOINTS_MAX];
    grobo_readback readback[GROBO_JOINTS_MAX];
    grobo_robot_motor motors[GROBO_JOINTS_MAX];
    config_robot robot; /* the configured one, with the trims of this line */
    char device[GROBO_DEVICE_MAX_BYTES];
    struct narrowed *next;
} narrowed;
static narrowed *all;

int narrow_find(const grobo_robot_def *def, const char *name)
{
    for (int i = 0; i < def->n_lines; i++) {
        if (strcmp(def->lines[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

/* What the robot has by joint, as the line counts its joints. */
static void take_joints(narrowed *n)
{
    const grobo_lines *lines = n->whole->on_lines;
    grobo_robot_def *def = &n->def;
    def->rest_rad = n->whole->rest_rad ? n->rest_rad : NULL;
    def->motors = n->whole->motors ? n->motors : NULL;
    for (int j = 0; j < n->whole->model->n_joints; j++) {
        int on = lines->joint_on[j];
        if (lines->line_of[j] == n->line && def->rest_rad) {
            n->rest_rad[on] = n->whole->rest_rad[j];
        }
        if (lines->line_of[j] == n->line && def->motors) {
            n->motors[on] = n->whole->motors[j];
        }
    }
    def->readback = n->readback;
    def->n_readback = 0;
    for (int i = 0; i < n->whole->n_readback; i++) {
        grobo_readback own = n->whole->readback[i];
        if (lines->line_of[own.joint] == n->line) {
            own.joint = lines->joint_on[own.joint];
            n->readback[def->n_readback++] = own;
        }
    }
}

static narrowed *narrow(const grobo_robot_def *def, int line)
{
    narrowed *n = all;
    while (n && (n->whole != def || n->line != line)) {
        n = n->next;
    }
    if (n) {
        return n;
    }
    n = calloc(1, sizeof *n);
    if (!n) {
        return NULL;
    }
    const grobo_robot_file_line *is = &def->lines[line];
    n->whole = def;
    n->line = line;
    n->def = *def;
    snprintf(n->name, sizeof n->name, "%s-%s", def->name, is->name);
    n->def.name = n->name;
    n->def.family = is->family;
    n->def.model = &def->on_lines->line[line].model;
    n->def.wiring = is->wiring;
    n->def.baud_bps = is->baud_bps;
    n->def.links = NULL;
    n->def.n_links = n->def.n_feet = n->def.n_lines = 0;
    n->def.payload_link = -1;
    n->def.lines = NULL;
    n->def.on_lines = NULL;
    take_joints(n);
    n->next = all;
    all = n;
    return n;
}

const grobo_robot_def *narrow_def(const grobo_robot_def *def, int line)
{
    const narrowed *n = narrow(def, line);
    return n ? &n->def : NULL;
}

bool narrow_device(const grobo_robot_def *def, int line, const char *device, char *port,
                   size_t capacity)
{
    const char *name = def->lines[line].name, *found = def->lines[line].port;
    size_t size = strlen(name);
    if (strcmp(device, GROBO_DEVICE_AUTO) != 0 && !strchr(device, '=')) {
        found = device;
    }
    for (const char *item = device; *item; item += strcspn(item, ","), item += *item == ',') {
        found = strncmp(item, name, size) == 0 && item[size] == '=' ? item + size + 1 : found;
    }
    size_t length = found ? strcspn(found, ",") : 0;
    if (length == 0 || length >= capacity) {
        return false;
    }
    memcpy(port, found, length);
    port[length] = '\0';
    return true;
}

/* Trims and offsets are by joint. */
static const config_robot *take_trims(narrowed *n, const config_robot *robot)
{
    const grobo_lines *lines = n->whole->on_lines;
    if (!robot || robot == &n->robot) {
        return robot;
    }
    n->robot = *robot;
    for (int j = 0; j < n->whole->model->n_joints; j++) {
        if (lines->line_of[j] == n->line) {
            n->robot.trim_deg[lines->joint_on[j]] = robot->trim_deg[j];
            n->robot.offset_deg[lines->joint_on[j]] = robot->offset_deg[j];
        }
    }
    return &n->robot;
}

int narrow_to(app *a, int line)
{
    const grobo_robot_def *def = a->def;
    narrowed *n = narrow(def, line);
    if (!n) {
        return app_fail_error(a, EXIT_ROBOT, GROBO_ERR_NOMEM, "%s", def->name);
    }
    a->def = &n->def;
    a->robot = take_trims(n, a->robot);
    const cli_value *device = app_global(a, GLOBAL_DEVICE);
    const char *fallback = getenv("GRCTL_DEVICE");
    const char *asked = device->given           ? device->text
                        : fallback && *fallback ? fallback
                                                : GROBO_DEVICE_AUTO;
    a->portless = NULL;
    a->on_line = def->lines[line].name;
    a->unasked = !device->given;
    if (narrow_device(def, line, asked, n->device, sizeof n->device)) {
        a->line.global[GLOBAL_DEVICE] = (cli_value){.given = 1, .text = n->device};
    } else {
        a->portless = def->lines[line].name;
    }
    a->line.global[GLOBAL_WIRING] = (cli_value){.given = 1, .choice = (int)n->def.wiring};
    if (def->lines[line].echo) {
        a->line.global[GLOBAL_ECHO].given = 1;
    }
    return EXIT_DONE;
}
