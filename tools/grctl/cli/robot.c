/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot_plant.h>
#include <grobo/session.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/narrow.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/node.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/os/pipe.h"

/* Read files; they live as long as the process. */
typedef struct kept {
    char path[ROBOT_PATH_BYTES];
    grobo_robot_def *def;
    struct kept *next;
} kept;
static kept *all;

/* A pipe would be waited for. */
int robot_read(const char *path, grobo_diagnostics *list, grobo_robot_def **def)
{
    return os_is_folder(path) ? GROBO_ERR_ISDIR
           : pipe_is(path)    ? GROBO_ERR_UNSUPPORTED
                              : grobo_robot_def_read_file(path, list, NULL, def);
}

const char *robot_read_fault(int error)
{
    return error == GROBO_ERR_ISDIR         ? _("is a folder, not a robot's file")
           : error == GROBO_ERR_UNSUPPORTED ? _("is a pipe; a robot's file must be a regular file")
                                            : file_error_text(error);
}

static bool is_path(const char *name)
{
    return strpbrk(name, "/\\.") != NULL;
}

static const grobo_robot_def *find_file(const char *path, char *complaint, size_t capacity)
{
    grobo_diagnostics *list = NULL;
    grobo_diagnostic d;
    for (const kept *k = all; k; k = k->next) {
        if (strcmp(k->path, path) == 0) {
            return k->def;
        }
    }
    kept *one = calloc(1, sizeof *one);
    int error = one && strlen(path) < sizeof one->path ? grobo_diagnostics_new(NULL, &list)
                                                       : GROBO_ERR_NOMEM;
    if (!error) {
        error = robot_read(path, list, &one->def);
    }
    if (!error) {
        snprintf(one->path, sizeof one->path, "%s", path);
        one->next = all;
        all = one;
    } else if (list && grobo_diagnostics_get(list, 0, &d) == 0) {
        file_format(&d, false, complaint, capacity);
    } else {
        snprintf(complaint, capacity, "%s: %s", path, robot_read_fault(error));
    }
    grobo_diagnostics_free(list);
    if (error) {
        free(one);
        return NULL;
    }
    return one->def;
}

const grobo_robot_def *robot_find(const char *name, char *complaint, size_t capacity)
{
    cli_guess guess = {.name = name, .length = strlen(name)};
    if (is_path(name)) {
        return find_file(name, complaint, capacity);
    }
    if (grobo_robot_def_find(name)) {
        return grobo_robot_def_find(name);
    }
    for (size_t i = 0; grobo_robot_def_at(i); i++) {
        cli_guess_try(&guess, grobo_robot_def_at(i)->name);
    }
    if (guess.best) {
        snprintf(complaint, capacity, _("no robot called '%s'; did you mean %s?"), name,
                 guess.best);
    } else {
        snprintf(
            complaint, capacity,
            _("no robot called '%s'; 'grctl robot list' has them, and a file is named with its "
              "folder: ./%s.yaml"),
            name, name);
    }
    return NULL;
}

const grobo_robot_def *robot_of(const app *a)
{
    return a->def ? a->def : grobo_robot_def_at(0);
}

/* GR001's driver is there for either wiring; any other is made. */
static int make_driver(app *a, const char *name)
{
    cli_value *wiring = &a->line.global[GLOBAL_WIRING];
    a->driver = NULL;
    if (!wiring->given) {
        wiring->choice = (int)a->def->wiring;
    }
    if (a->def == grobo_robot_def_at(0)) {
        return 0;
    }
    a->made.size = sizeof a->made;
    int error = grobo_robot_def_driver(a->def, (grobo_wiring)wiring->choice, &a->made);
    if (error == GROBO_ERR_UNSUPPORTED) {
        return app_fail(a, EXIT_USAGE, grobo_error_name(error),
                        "--wiring board: the servos of %s cannot be behind GR001's board", name);
    }
    a->driver = &a->made;
    return error ? app_fail_error(a, EXIT_FILE, error, "%s", name) : 0;
}

/* "has no line 'lft'; it has left, right": the text lives until the next call. */
static const char *no_line_text(const grobo_robot_def *def, const char *name, size_t size)
{
    static char text[APP_LINE_BYTES];
    snprintf(text, sizeof text, _("%s has no line '%.*s'; it has %s, %s%s"), def->name, (int)size,
             name, def->lines[0].name, def->lines[1].name, def->n_lines > 2 ? ", ..." : "");
    return text;
}

/* The line that the options name. A stop is for the whole robot. */
static int take_line(app *a)
{
    const cli_value *line = app_global(a, GLOBAL_LINE);
    const grobo_robot_def *def = a->def;
    if (!line->given || (a->line.command && a->line.command->stops)) {
        return EXIT_DONE;
    }
    if (def->n_lines == 0) {
        return app_fail(a, EXIT_USAGE, "ARG", "--line %s: %s has one line", line->text, def->name);
    }
    int number = narrow_find(def, line->text);
    return number < 0 ? app_fail(a, EXIT_USAGE, "NOTFOUND", "%s",
                                 no_line_text(def, line->text, strlen(line->text)))
                      : narrow_to(a, number);
}

int robot_on_line(app *a, int line)
{
    int status = narrow_to(a, line);
    return status ? status : make_driver(a, a->def->name);
}

/* What the robot is called, and by whom: "" where that is said already. */
static const char *name_of(const app *a, const char **whose)
{
    const cli_value *option = app_global(a, GLOBAL_ROBOT);
    const char *fallback = getenv("GRCTL_ROBOT");
    *whose = "";
    if (option->given) {
        return option->text;
    }
    if (a->robot && *a->robot->def) {
        return a->robot->def;
    }
    if (!fallback || !*fallback) {
        return grobo_robot_def_at(0)->name;
    }
    *whose = "$GRCTL_ROBOT: ";
    return fallback;
}

int robot_choose(app *a)
{
    char complaint[APP_LINE_BYTES - 32];
    const char *whose, *name = name_of(a, &whose);
    const char *configured =
        a->robot && *a->robot->def ? a->robot->def : grobo_robot_def_at(0)->name;
    a->def = robot_find(name, complaint, sizeof complaint);
    if (!a->def) {
        return app_fail(a, is_path(name) ? EXIT_FILE : EXIT_USAGE,
                        is_path(name) ? "SYNTAX" : "NOTFOUND", "%s%s", whose, complaint);
    }
    a->def_name = name;
    int status = take_line(a);
    status = status ? status : make_driver(a, name); /* which a stop needs in any case */
    bool given = app_global(a, GLOBAL_ROBOT)->given > 0;
    if (!status && a->robot && (given || a->robot->trimmed || a->robot->offsets) &&
        strcmp(name, configured) != 0) { /* trims are of the joints of one robot */
        return app_fail(a, EXIT_USAGE, "ARG", "%s%s: %s of %s is another robot: %s",
                        given ? "--robot " : whose, name, a->robot->name, a->robot->path,
                        configured);
    }
    return status;
}

void robot_of_words(app *a, int n, char *const *words)
{
    char hushed[APP_LINE_BYTES];
    cli_value *option = &a->line.global[GLOBAL_ROBOT];
    for (int i = 0; i + 1 < n; i++) {
        bool alone = strcmp(words[i], "--robot") == 0;
        if (alone || strncmp(words[i], "--robot=", strlen("--robot=")) == 0) {
            const char *name = alone ? words[i + 1] : words[i] + strlen("--robot=");
            *option = (cli_value){.given = 1, .text = name};
        }
    }
    a->hushed = hushed;
    (void)robot_choose(a);
    a->hushed = NULL;
}

const char *robot_path(const app *a)
{
    static char path[ROBOT_PATH_BYTES];
    if (robot_of(a) == grobo_robot_def_at(0)) {
        return "";
    }
    if (!is_path(a->def_name) || !node_true_path(a->def_name, path, sizeof path)) {
        return a->def_name;
    }
    return path;
}

void robot_sim(const app *a, grobo_robot_sim *sim)
{
    const cli_value *baud = app_global(a, GLOBAL_BAUD);
    (void)grobo_robot_def_sim(robot_of(a), (grobo_wiring)app_global(a, GLOBAL_WIRING)->choice, sim);
    if (baud->given) {
        sim->config.baud_bps = (uint32_t)baud->number;
    }
}

/* True if a simulated robot has weight: as asked for, else by its environment or its file. */
static bool wants_physics(const app *a, bool has_weight)
{
    enum { AUTO, OFF };
    const cli_value *asked = app_global(a, GLOBAL_PHYSICS);
    const char *set = getenv("GRCTL_PHYSICS");
    if (asked->choice != AUTO) {
        return asked->choice != OFF;
    }
    return set && *set ? strcmp(set, "off") != 0 && (has_weight || strcmp(set, "on") == 0)
                       : has_weight;
}

static bool has_line(const grobo_robot_def *def, const char *name, size_t size)
{
    int i = 0;
    while (i < def->n_lines &&
           (strncmp(def->lines[i].name, name, size) != 0 || def->lines[i].name[size] != '\0')) {
        i++;
    }
    return i < def->n_lines;
}

const char *robot_lines_fault(const app *a, const char *device)
{
    static char text[APP_LINE_BYTES];
    const grobo_robot_def *def = robot_of(a);
    if (def->n_lines == 0 || strcmp(device, GROBO_DEVICE_SIM) == 0 ||
        strcmp(device, GROBO_DEVICE_AUTO) == 0) {
        return NULL;
    }
    for (const char *item = device; *item; item += strcspn(item, ","), item += *item == ',') {
        size_t name = strcspn(item, "=,");
        if (item[name] != '=') {
            snprintf(text, sizeof text,
                     _("%s has %d lines: a port is wanted for each, -d %s=PORT,%s=PORT"), def->name,
                     def->n_lines, def->lines[0].name, def->lines[1].name);
            return text;
        }
        if (!has_line(def, item, name)) {
            return no_line_text(def, item, name);
        }
    }
    return NULL;
}

int robot_physics(const app *a, grobo_sim_config *config, grobo_sim_physics **physics)
{
    const grobo_robot_def *def = robot_of(a);
    *physics = NULL;
    bool whole = config->model == def->model; /* else servos alone */
    if (def->n_lines > 0) {
        return app_global(a, GLOBAL_PHYSICS)->choice > 1 ? GROBO_ERR_UNSUPPORTED : GROBO_OK;
    }
    if (!wants_physics(a, whole && grobo_robot_def_has_weight(def))) {
        return GROBO_OK;
    }
    int result;
    if (whole) {
        result = grobo_robot_def_physics(def, true, NULL, physics);
    } else {
        const grobo_sim_physics_config alone = {GROBO_SIM_PHYSICS_CONFIG_INIT,
                                                .model = config->model, .real_time = true};
        result = grobo_sim_physics_new(&alone, NULL, physics);
    }
    config->physics = *physics;
    return result;
}

const char *robot_payload_link(const app *a)
{
    const grobo_robot_def *def = robot_of(a);
    return def->n_links > 0 && def->payload_link >= 0 ? def->links[def->payload_link].name : NULL;
}
