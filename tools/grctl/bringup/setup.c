/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include <grobo/core/unit.h>

#include "tools/grctl/bringup/ask.h"
#include "tools/grctl/bringup/checkup.h"
#include "tools/grctl/bringup/found.h"
#include "tools/grctl/bringup/homing.h"
#include "tools/grctl/bringup/ids.h"
#include "tools/grctl/bringup/setup.h"
#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/each_line.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/conn/auto_ports.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/node.h"
#include "tools/grctl/os/os.h"

enum { TRIES = 5 };

typedef struct guide {
    app *a;
    char device[GROBO_DEVICE_MAX_BYTES]; /* as the configuration gets it */
    char robot[ROBOT_PATH_BYTES];        /* a name, or the path of a file */
    char file[ROBOT_PATH_BYTES];         /* of a robot that was made, or "" */
    char name[ASK_BYTES];
    char config[CONFIG_PATH_BYTES];
    int baud_bps; /* 0: the robot's own */
    int n_read;   /* joints that answered */
    int n_setup;  /* joints that answered, and are not set up */
    bool named;   /* in the configuration */
    bool calibrated;
    bool fresh; /* its servos got their ids now */
} guide;

static void set_global(app *a, int global, const char *text)
{
    a->line.global[global] = (cli_value){.given = 1, .text = text};
}

static int gave_up(const guide *g)
{
    int status = ask_signal() ? EXIT_SIGNAL + ask_signal() : EXIT_USAGE;
    return app_fail(g->a, status, "CANCELED", "setup: ended; nothing more was changed");
}

/* ---- the port -------------------------------------------------------------------------------- */

static void list_ports(const guide *g, const choice *all)
{
    for (int i = 0; i < all->n_usb; i++) {
        const grobo_port_info *info = &all->usb[i];
        app_note(g->a, "  %d  %s  %04x:%04x %s", i + 1, info->path,
                 (unsigned)info->usb_vendor & 0xffff, (unsigned)info->usb_product & 0xffff,
                 info->product);
    }
}

/* One of several adapters. */
static int choose_port(guide *g, const choice *all)
{
    char answer[ASK_BYTES];
    double number = 0;
    list_ports(g, all);
    for (int i = 0; i < TRIES; i++) {
        if (!ask_line(g->a, "which of these is the robot's?", "1", answer)) {
            return gave_up(g);
        }
        if (cli_read_number(answer, &number) && number >= 1 && number <= all->n_usb &&
            number == (int)number) {
            const grobo_port_info *info = &all->usb[(int)number - 1];
            /* The name that stays when it is plugged in elsewhere. */
            snprintf(g->device, sizeof g->device, "%s", *info->by_id ? info->by_id : info->path);
            return 0;
        }
    }
    return app_fail(g->a, EXIT_USAGE, "ARG", "setup: '%s' is not in the list", answer);
}

static int find_port(guide *g)
{
    static choice all;
    if (!conn_is_auto(g->a)) {
        snprintf(g->device, sizeof g->device, "%s", conn_requested(g->a));
        return 0;
    }
    int error = auto_ports(&all);
    if (error < 0) {
        return app_fail_error(g->a, EXIT_ROBOT, error, "cannot list serial ports");
    }
    auto_report(g->a, &all);
    if (all.n_usb == 0) {
        return app_fail(g->a, EXIT_ROBOT, "NOENT",
                        all.n_blocked ? "setup: no adapter may be opened; fix that and run it "
                                        "again"
                                      : "setup: no USB adapter is here; plug the robot's cable in "
                                        "and run it again, or try it with -d sim");
    }
    if (all.n_usb == 1) {
        snprintf(g->device, sizeof g->device, "%s",
                 *all.usb[0].by_id ? all.usb[0].by_id : all.usb[0].path);
        return 0;
    }
    return choose_port(g, &all);
}

static bool is_port(const char *device)
{
    return strcmp(device, GROBO_DEVICE_SIM) != 0 && strncmp(device, "tcp:", 4) != 0;
}

/* May it be opened, is it quick: what is wrong comes with the line that mends it. */
static int check_port(guide *g)
{
    checkup k;
    app quiet = *g->a;
    quiet.json = false;
    checkup_start(&k, &quiet);
    k.aside = true;
    set_global(g->a, GLOBAL_DEVICE, g->device);
    if (!is_port(g->device)) {
        return 0;
    }
    app_note(g->a, "the port: %s", g->device);
    return checkup_port(&k, g->device)
               ? 0
               : app_fail(g->a, EXIT_ROBOT, "PERM", "setup: fix this and run setup again");
}

/* ---- the robot ------------------------------------------------------------------------------- */

/* Whether a robot of the library answers as it usually does. */
static bool answers(guide *g, const char *name)
{
    char said[APP_LINE_BYTES];
    conn c;
    app one = *g->a;
    one.hushed = said;
    one.json = false;
    set_global(&one, GLOBAL_ROBOT, name);
    if (robot_choose(&one) != 0) {
        return false;
    }
    int status = conn_open(&c, &one);
    return conn_close(&c, status) == EXIT_DONE;
}

/* A path beside the configuration that nothing has. */
static bool free_path(const char *name, char *path, size_t capacity)
{
    char config[CONFIG_PATH_BYTES];
    if (!os_config_path(0, config, sizeof config) || !os_make_folders(config)) {
        return false;
    }
    char *end = config + strlen(config);
    while (end > config && end[-1] != '/' && end[-1] != '\\') {
        end--;
    }
    *end = '\0';
    for (int number = 1; number < 100; number++) {
        char behind[8] = "";
        if (number > 1) {
            snprintf(behind, sizeof behind, "-%d", number);
        }
        int n = snprintf(path, capacity, "%s%s%s.yaml", config, name, behind);
        bool fits = n > 0 && (size_t)n < capacity;
        if (!fits || !file_is_there(path)) {
            return fits;
        }
    }
    return false;
}

static int write_robot(guide *g, const found_servos *all)
{
    static sketch s;
    char complaint[APP_LINE_BYTES], name[ASK_BYTES];
    app plain = *g->a;
    if (!ask_line(g->a, "no robot that is known; a file is written. What is it called?", "robot",
                  name)) {
        return gave_up(g);
    }
    found_sketch(g->a, all, name, &s);
    if (!sketch_order(&s, complaint, sizeof complaint) ||
        !sketch_fit(&s, complaint, sizeof complaint)) {
        return app_fail(g->a, EXIT_ROBOT, "CAP", "setup: %s", complaint);
    }
    if (!free_path(s.name, g->file, sizeof g->file)) {
        return app_fail(g->a, EXIT_FILE, "NOENT", "setup: there is no place for a robot's file");
    }
    plain.json = false;
    int status = sketch_write(&plain, &s, g->file, NULL);
    snprintf(g->robot, sizeof g->robot, "%s", g->file);
    return status;
}

/* The robots of the library with these servos: one of them, or a file. */
static int choose_robot(guide *g, const found_servos *all)
{
    char question[APP_LINE_BYTES], answer[ASK_BYTES], complaint[APP_LINE_BYTES];
    const char *first = NULL;
    size_t n = (size_t)snprintf(question, sizeof question, "%s", _("these may be"));
    for (size_t i = 0; grobo_robot_def_at(i); i++) {
        if (found_fits(all, grobo_robot_def_at(i))) {
            first = first ? first : grobo_robot_def_at(i)->name;
            n += (size_t)snprintf(question + n, sizeof question - n, " %s,",
                                  grobo_robot_def_at(i)->name);
        }
    }
    if (!first) {
        return write_robot(g, all);
    }
    snprintf(question + n, sizeof question - n, "%s", _(" or another (new). Which?"));
    for (int i = 0; i < TRIES; i++) {
        if (!ask_line(g->a, question, first, answer)) {
            return gave_up(g);
        }
        if (strcmp(answer, "new") == 0) {
            return write_robot(g, all);
        }
        if (robot_find(answer, complaint, sizeof complaint)) {
            snprintf(g->robot, sizeof g->robot, "%s", answer);
            return 0;
        }
        app_note(g->a, "%s", complaint);
    }
    return app_fail(g->a, EXIT_USAGE, "NOTFOUND", "setup: %s", complaint);
}

/* Servos of a robot that is named do not all answer: new ones all have one id. */
static int offer_ids(guide *g, const grobo_robot_def *def, found_servos *all)
{
    char question[APP_LINE_BYTES];
    int status = found_look(g->a, def->family->name, all);
    if (status || (all->sure && all->n >= def->model->n_joints)) {
        return status;
    }
    snprintf(question, sizeof question,
             _("%d of its %d servos answer. Are they new, to be given their ids one at a time?"),
             all->n, def->model->n_joints);
    if (ask_yes(g->a, question)) {
        status = ids_give(g->a, def, all);
        g->fresh = status == 0;
    }
    return status;
}

/* One servo, or several that disturb each other, may be new ones; the robot is not known yet. */
static int offer_robot(guide *g, found_servos *all)
{
    char answer[ASK_BYTES], complaint[APP_LINE_BYTES] = "";
    for (int i = 0; i < TRIES; i++) {
        if (!ask_line(g->a,
                      "new servos all have one id. To give them their ids, one at a time, name the "
                      "robot; else no",
                      "no", answer)) {
            return gave_up(g);
        }
        if (strcmp(answer, "no") == 0) {
            return 0;
        }
        const grobo_robot_def *def = robot_find(answer, complaint, sizeof complaint);
        if (def && def->wiring == GROBO_WIRING_BUS) {
            int status = ids_give(g->a, def, all);
            snprintf(g->robot, sizeof g->robot, "%s", answer);
            g->fresh = status == 0;
            return status;
        }
        app_note(g->a, "%s",
                 def ? _("ids of servos behind a board are not given here") : complaint);
    }
    return app_fail(g->a, EXIT_USAGE, "NOTFOUND", "setup: '%s' is no robot", answer);
}

/* A robot with these servos: one that is known, or a file. */
static int take_found(guide *g, const found_servos *all)
{
    if (all->n == 0) {
        return app_fail(
            g->a, EXIT_ROBOT, "NOTFOUND",
            "setup: no servo answers on %s: switch the robot on, push its cables in, and "
            "run it again",
            g->device);
    }
    for (int i = 0; i < all->n; i++) {
        app_note(g->a, "  %3d  %-12s %7d bps  %s", all->servo[i].id, all->servo[i].servo->name,
                 all->servo[i].baud_bps, all->servo[i].family->name);
    }
    int status = choose_robot(g, all);
    if (!status) {
        char complaint[APP_LINE_BYTES];
        const grobo_robot_def *def = robot_find(g->robot, complaint, sizeof complaint);
        g->baud_bps =
            def && (int)def->baud_bps != all->servo[0].baud_bps ? all->servo[0].baud_bps : 0;
    }
    return status;
}

static int find_robot(guide *g)
{
    static found_servos all;
    app *a = g->a;
    bool simulated = strcmp(g->device, GROBO_DEVICE_SIM) == 0;
    if (app_global(a, GLOBAL_ROBOT)->given || simulated) {
        const char *path = robot_path(a);
        bool bus = (grobo_wiring)app_global(a, GLOBAL_WIRING)->choice == GROBO_WIRING_BUS;
        snprintf(g->robot, sizeof g->robot, "%s", *path ? path : robot_of(a)->name);
        return bus && !simulated ? offer_ids(g, robot_of(a), &all) : 0;
    }
    app_note(a, "asking which servos answer; nothing moves");
    if (answers(g, "gr001")) {
        snprintf(g->robot, sizeof g->robot, "gr001");
        app_note(a, "GR001's board answers");
        return 0;
    }
    int status = found_look(a, NULL, &all);
    if (status) {
        return status;
    }
    found_choose(a, &all);
    if (all.n == 1 || (all.n == 0 && !all.sure)) {
        status = offer_robot(g, &all);
    }
    return status || *g->robot ? status : take_found(g, &all);
}

/* ---- its name -------------------------------------------------------------------------------- */

/* A name that the configuration does not have, from the robot's. */
static void propose(const guide *g, char *name)
{
    char hushed[APP_LINE_BYTES];
    app quiet = *g->a;
    const char *from = robot_of(g->a)->name;
    quiet.hushed = hushed;
    for (int number = 1; number < 100; number++) {
        char behind[8] = "";
        if (number > 1) {
            snprintf(behind, sizeof behind, "-%d", number);
        }
        snprintf(name, ASK_BYTES, "%.40s%s", from, behind);
        for (char *c = name; *c; c++) {
            *c = *c == '.' ? '-' : *c;
        }
        if (config_check_name(&quiet, name) != EXIT_USAGE) {
            return;
        }
    }
}

static int give_name(guide *g)
{
    char usual[ASK_BYTES], answer[ASK_BYTES];
    int status = 0;
    propose(g, usual);
    for (int i = 0; i < TRIES && (i == 0 || status == EXIT_USAGE); i++) {
        if (!ask_line(g->a, "its name, for -d?", usual, answer)) {
            return gave_up(g);
        }
        status = config_check_name(g->a, answer);
    }
    if (status) {
        return status;
    }
    memcpy(g->name, answer, strlen(answer) + 1); /* it fits: it was checked */
    const cli_value *wiring = app_global(g->a, GLOBAL_WIRING);
    const config_entry entry = {.name = g->name,
                                .device = g->device,
                                .def = g->robot,
                                .baud_bps = g->baud_bps,
                                .file = *g->file ? g->file : NULL,
                                .wiring = (grobo_wiring)wiring->choice == robot_of(g->a)->wiring
                                              ? NULL
                                          : wiring->choice ? "bus"
                                                           : "board"};
    status = config_add(g->a, &entry, g->config, sizeof g->config);
    if (!status) {
        g->named = true;
        app_note(g->a, "%s names it %s now; 'grctl setup --undo' undoes that", g->config, g->name);
    }
    return status;
}

/* ---- the joints ------------------------------------------------------------------------------ */

static int read_joints(guide *g)
{
    conn c;
    app *a = g->a;
    const grobo_model *model = app_model(a);
    int status = conn_open(&c, a);
    if (!status) {
        (void)conn_sense(&c, GROBO_JOINTS_ALL(model->n_joints), GROBO_SENSE_FULL);
    }
    for (int j = 0; j < model->n_joints && !status; j++) {
        grobo_joint_info i;
        bool read =
            grobo_robot_joint(c.robot, j, &i) == 0 && (i.state.valid & GROBO_FIELD_ANGLE) != 0;
        conn_setup why;
        g->n_read += read;
        if (!read && conn_setup_of(&c, j, &why)) {
            g->n_setup++;
            app_note(a, "  %-16s %s; %s", grobo_model_joint(model, j)->name, why.fact, why.fix);
        } else if (read) {
            app_note(a, "  %-16s %7.1f %s", grobo_model_joint(model, j)->name,
                     grobo_model_value(model, j, i.state.angle_rad),
                     grobo_unit_name(grobo_model_unit(model, j)));
        } else {
            app_note(a, "  %-16s does not answer as it should; see 'grctl -d %s doctor'",
                     grobo_model_joint(model, j)->name, g->name);
        }
    }
    return conn_close(&c, status);
}

static int offer_calibration(guide *g)
{
    const homing_orders orders = {0};
    if (!homing_fits(g->a)) {
        app_note(g->a, "its servos keep no calibration; trims: grctl -d %s calibrate", g->name);
        return 0;
    }
    if (!g->a->tty_in ||
        !ask_yes(g->a, "calibrate it now? Torque is switched off, and you move each joint "
                       "by hand; it can be undone")) {
        app_note(g->a, "to calibrate it later: grctl -d %s calibrate", g->name);
        return 0;
    }
    int status = homing_run(g->a, &orders);
    g->calibrated = status == EXIT_DONE;
    return status;
}

enum { STEP_DEG = 5, STEP_US = 1500000 };

/* The joint goes a little, back to where it was, and is limp again. */
static int step_and_back(conn *c, int joint)
{
    const grobo_model *model = conn_model(c);
    const grobo_joint_mask bit = GROBO_JOINT_BIT(joint);
    grobo_joint_info is;
    int error = conn_sense(c, bit, GROBO_SENSE_FULL);
    if (!error) {
        error = grobo_robot_joint(c->robot, joint, &is);
    }
    if (error) {
        return error;
    }
    double at_deg = grobo_deg_from_rad(is.state.angle_rad);
    bool up = at_deg + STEP_DEG < grobo_deg_from_rad(grobo_model_joint(model, joint)->max_rad);
    const double ways_deg[] = {at_deg + (up ? STEP_DEG : -STEP_DEG), at_deg};
    c->moving = true; /* from here on every way out carries out the exit policy */
    error = conn_wait(c, grobo_robot_torque(c->robot, bit, GROBO_TORQUE_ON));
    for (int i = 0; i < 2 && !error; i++) {
        grobo_posture target;
        grobo_posture_init(&target, model->n_joints);
        grobo_posture_set_deg(&target, joint, ways_deg[i]);
        target.time_us = STEP_US;
        error = conn_wait(c, grobo_robot_move(c->robot, &target));
    }
    if (!error) {
        error = conn_wait(c, grobo_robot_torque(c->robot, bit, GROBO_TORQUE_OFF));
    }
    c->moving = error != GROBO_OK;
    return error;
}

/* Of a robot that was made ready now: its last joint. */
static int move_first(guide *g)
{
    conn c;
    char question[APP_LINE_BYTES];
    int joint = app_model(g->a)->n_joints - 1;
    const char *name = grobo_model_joint(app_model(g->a), joint)->name;
    snprintf(
        question, sizeof question,
        _("move it for the first time? %s goes %d degrees and back, slowly; keep a hand at the "
          "plug"),
        name, STEP_DEG);
    if (!(g->fresh || g->calibrated) || (g->n_setup > 0 && !g->calibrated) ||
        !ask_yes(g->a, question)) {
        return 0;
    }
    int status = conn_open_to_move(&c, g->a);
    int error = status ? GROBO_OK : step_and_back(&c, joint);
    if (error) {
        status = conn_fail(&c, error, "setup");
    } else if (!status) {
        app_note(g->a, "%s moved, and is limp again", name);
    }
    return conn_close(&c, status);
}

/* From here on the command speaks to the robot that was found. */
static int take_robot(guide *g)
{
    set_global(g->a, GLOBAL_ROBOT, g->robot);
    if (g->baud_bps) {
        g->a->line.global[GLOBAL_BAUD] = (cli_value){.given = 1, .number = g->baud_bps};
    }
    return robot_choose(g->a);
}

static void report(const guide *g)
{
    if (g->a->json) {
        app_print_json(json_pack("{s:o,s:o,s:o?,s:s,s:o,s:i,s:i}", "device",
                                 app_json_text(g->device), "robot", app_json_text(g->robot), "file",
                                 *g->file ? app_json_text(g->file) : NULL, "name", g->name,
                                 "config", app_json_text(g->config), "n_joints",
                                 app_model(g->a)->n_joints, "n_read", g->n_read));
        return;
    }
    int n = app_model(g->a)->n_joints, unread = n - g->n_read - (g->calibrated ? g->n_setup : 0);
    if (unread == 0) {
        app_note(g->a, "done. From now on: grctl -d %s status --watch", g->name);
    } else if (unread == g->n_setup) {
        app_note(g->a,
                 "%s has its name, but %d of its %d joints cannot move yet: first fix what is "
                 "said above; 'grctl -d %s doctor' says it again",
                 g->name, unread, n, g->name);
    } else {
        app_note(g->a,
                 "%s has its name, but %d of its %d joints do not answer: 'grctl -d %s doctor' "
                 "says why",
                 g->name, unread, n, g->name);
    }
}

/* ---- several lines --------------------------------------------------------------------------- */

/* A step for each line alone. Of the first one its port goes to the device of the whole robot. */
static int on_lines(guide *g, int (*const *steps)(guide *), char *device)
{
    app *a = g->a;
    const app whole = *a;
    const grobo_robot_def *def = robot_of(a);
    size_t n = 0;
    int status = 0;
    for (int line = 0; line < def->n_lines && !status; line++) {
        app_note(a, "line %s", def->lines[line].name);
        *a = whole;
        status = robot_on_line(a, line);
        a->portless = NULL; /* it is asked for */
        for (int i = 0; steps[i] && !status; i++) {
            status = steps[i](g);
        }
        if (device && !status) {
            n += (size_t)snprintf(device + n, GROBO_DEVICE_MAX_BYTES - n, "%s%s=%s",
                                  line > 0 ? "," : "", def->lines[line].name, g->device);
        }
        if (n >= GROBO_DEVICE_MAX_BYTES) {
            status = app_fail(a, EXIT_USAGE, "CAP", "setup: the names of the ports are too long");
        }
    }
    *a = whole;
    return status;
}

/* The robot is known: each line gets its port, and its servos their ids. */
static int find_lines(guide *g)
{
    static int (*const steps[])(guide *) = {find_port, check_port, find_robot, NULL};
    char device[GROBO_DEVICE_MAX_BYTES] = "";
    const char *path = robot_path(g->a);
    bool sim = app_global(g->a, GLOBAL_DEVICE)->given &&
               strcmp(app_global(g->a, GLOBAL_DEVICE)->text, GROBO_DEVICE_SIM) == 0;
    int status = on_lines(g, steps, device);
    snprintf(g->device, sizeof g->device, "%s", sim ? GROBO_DEVICE_SIM : device);
    snprintf(g->robot, sizeof g->robot, "%s", path);
    set_global(g->a, GLOBAL_DEVICE, g->device);
    return status;
}

static int calibrate_lines(guide *g)
{
    static int (*const steps[])(guide *) = {offer_calibration, NULL};
    return on_lines(g, steps, NULL);
}

int setup_run(app *a)
{
    static guide g;
    int status = 0;
    memset(&g, 0, sizeof g);
    g.a = a;
    if (a->link) {
        return app_fail(a, EXIT_USAGE, "ARG", "setup opens the line for itself; not in a shell");
    }
    if (!ask_can(a, "'grctl ports', 'grctl doctor', 'grctl robot new'", &status)) {
        return status;
    }
    status = each_line_refuse_trace(a);
    static int (*const one[])(guide *) = {find_port, check_port,  find_robot,        take_robot,
                                          give_name, read_joints, offer_calibration, move_first};
    static int (*const several[])(guide *) = {find_lines,  take_robot,      give_name,
                                              read_joints, calibrate_lines, move_first};
    bool lines = robot_of(a)->n_lines > 0;
    size_t n_steps = lines ? sizeof several / sizeof *several : sizeof one / sizeof *one;
    for (size_t i = 0; i < n_steps && !status; i++) {
        status = lines ? several[i](&g) : one[i](&g);
    }
    if (!status) {
        report(&g);
    } else if (*g.file && !g.named && remove(g.file) == 0) { /* nothing could undo it later */
        app_note(a, "the robot's file %s is removed again", g.file);
    }
    return status;
}

int setup_undo(app *a)
{
    static config_undone undone;
    int status = config_undo(a, &undone);
    if (status) {
        return status;
    }
    if (*undone.file && undone.removed) {
        app_note(a, "the robot's file %s is removed", undone.file);
    } else if (*undone.file) {
        app_note(a, "the robot's file %s has changed since setup wrote it, and stays", undone.file);
    }
    app_report(a,
               json_pack("{s:o,s:b,s:o?,s:b}", "config", app_json_text(undone.path), "undone", 1,
                         "file", *undone.file ? app_json_text(undone.file) : NULL, "removed",
                         undone.removed),
               "%s is as it was before", undone.path);
    return status;
}
