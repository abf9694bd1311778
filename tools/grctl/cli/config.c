/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <yaml.h>

#include <grobo/model.h>
#include <grobo/session.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/node.h"
#include "tools/grctl/os/os.h"

typedef struct reader {
    app *a;
    char path[CONFIG_PATH_BYTES]; /* of the file being read, or read last */
    yaml_parser_t parser;
    yaml_event_t event; /* the last one read */
    bool has_event;
    int status; /* of the first complaint */
    char wanted[CONFIG_NAME_BYTES];
    bool wants_default;
    char default_path[CONFIG_PATH_BYTES]; /* of the file that names the default */
    config_robot *robot;
    config_group *group;      /* where it is wanted, or NULL */
    const grobo_model *model; /* of the robot that is read */
    bool has_warn_fall, warn_fall;
    cli_guess guess; /* the robot whose name is nearest to the wanted one */
    char nearest[CONFIG_NAME_BYTES];
} reader;

/* ---- events --------------------------------------------------------------------------------- */

static int complain(reader *r, const yaml_mark_t *at, const char *format, const char *what)
{
    char text[384];
    snprintf(text, sizeof text, lang_text(format), lang_text(what));
    if (!r->status) {
        r->status = app_fail(r->a, EXIT_FILE, "SYNTAX", "%s:%zu:%zu: %s", r->path, at->line + 1,
                             at->column + 1, text);
    }
    return r->status;
}

static int next(reader *r)
{
    if (r->has_event) {
        yaml_event_delete(&r->event);
    }
    r->has_event = yaml_parser_parse(&r->parser, &r->event) != 0;
    if (!r->has_event) {
        return complain(r, &r->parser.problem_mark, "%s",
                        r->parser.problem ? r->parser.problem : "cannot be read");
    }
    if (r->event.type == YAML_ALIAS_EVENT) {
        return complain(r, &r->event.start_mark, "%s", "aliases are not known here");
    }
    return 0;
}

static const char *scalar(const reader *r)
{
    return r->event.type == YAML_SCALAR_EVENT ? (const char *)r->event.data.scalar.value : NULL;
}

/* Calls `take` with each key of the mapping that the last event began, the value being next. */
static int each_key(reader *r, int (*take)(reader *r, const char *key))
{
    json_t *seen = json_object();
    if (r->event.type != YAML_MAPPING_START_EVENT) {
        complain(r, &r->event.start_mark, "%s", "a mapping is wanted here");
    }
    while (!r->status && next(r) == 0 && r->event.type != YAML_MAPPING_END_EVENT) {
        char key[CONFIG_NAME_BYTES];
        if (!scalar(r) || r->event.data.scalar.length >= sizeof key) {
            complain(r, &r->event.start_mark, "%s", "a name is wanted here");
            break;
        }
        snprintf(key, sizeof key, "%s", scalar(r));
        if (json_object_get(seen, key)) {
            complain(r, &r->event.start_mark, "%s is there twice", key);
            break;
        }
        json_object_set_new(seen, key, json_true());
        take(r, key);
    }
    json_decref(seen);
    return r->status;
}

/* ---- values --------------------------------------------------------------------------------- */

/* A value as the option of that name would take it. */
static int take_option(reader *r, int global, cli_value *value)
{
    const cli_option *o = &cli_global_options[global];
    char complaint[256];
    if (next(r)) {
        return r->status;
    }
    if (!scalar(r)) {
        return complain(r, &r->event.start_mark, "%s", "a single value is wanted here");
    }
    memset(value, 0, sizeof *value);
    if (!cli_take_value(o, value, scalar(r), complaint, sizeof complaint)) {
        return complain(r, &r->event.start_mark, "%s", complaint);
    }
    value->text = NULL; /* lives no longer than the event */
    return 0;
}

static int take_truth(reader *r, bool *truth)
{
    if (next(r)) {
        return r->status;
    }
    if (!scalar(r) || (strcmp(scalar(r), "true") != 0 && strcmp(scalar(r), "false") != 0)) {
        return complain(r, &r->event.start_mark, "%s", "true or false is wanted here");
    }
    *truth = strcmp(scalar(r), "true") == 0;
    return 0;
}

static int take_flag(reader *r, cli_value *value)
{
    bool given = false;
    if (take_truth(r, &given)) {
        return r->status;
    }
    value->given = given;
    return 0;
}

static int take_text(reader *r, char *text, size_t capacity)
{
    if (next(r)) {
        return r->status;
    }
    if (!scalar(r) || !*scalar(r) || r->event.data.scalar.length >= capacity) {
        return complain(r, &r->event.start_mark, "%s", "a name is wanted here");
    }
    snprintf(text, capacity, "%s", scalar(r));
    return 0;
}

static int unknown_joint(reader *r, const char *name)
{
    char text[3 * CONFIG_NAME_BYTES];
    const char *nearest = joints_nearest(r->model, name, strlen(name), false);
    snprintf(text, sizeof text, _("no joint called '%.*s'%s%s%s"), CONFIG_NAME_BYTES, name,
             nearest ? _("; did you mean ") : "", nearest ? nearest : "", nearest ? "?" : "");
    return complain(r, &r->event.start_mark, "%s", text);
}

/* The joint that the last event names, and its degrees. */
static int take_joint(reader *r, double *deg, grobo_joint_mask *seen)
{
    const char *name = scalar(r);
    int joint = name ? grobo_model_find_joint(r->model, name, strlen(name)) : -1;
    if (joint < 0) {
        return unknown_joint(r, name ? name : "");
    }
    if (*seen & GROBO_JOINT_BIT(joint)) {
        return complain(r, &r->event.start_mark, "%s is there twice", name);
    }
    *seen |= GROBO_JOINT_BIT(joint);
    if (next(r)) {
        return r->status;
    }
    if (!scalar(r) || !cli_read_number(scalar(r), &deg[joint]) ||
        deg[joint] < -CONFIG_TRIM_MAX_DEG || deg[joint] > CONFIG_TRIM_MAX_DEG) {
        return complain(r, &r->event.start_mark, "%s", "degrees from -20 to 20 are wanted");
    }
    return 0;
}

/* {JOINT: degrees, ...}; at_end: behind the last character of the mapping's text. */
static int take_degrees(reader *r, double *deg, size_t *at, size_t *at_end)
{
    if (next(r)) {
        return r->status;
    }
    if (r->event.type != YAML_MAPPING_START_EVENT) {
        return complain(r, &r->event.start_mark, "%s", "JOINT: degrees are wanted here");
    }
    bool flow = r->event.data.mapping_start.style == YAML_FLOW_MAPPING_STYLE;
    grobo_joint_mask seen = 0;
    *at = *at_end = r->event.start_mark.index;
    while (next(r) == 0 && r->event.type != YAML_MAPPING_END_EVENT) {
        if (take_joint(r, deg, &seen)) {
            return r->status;
        }
        *at_end = r->event.end_mark.index;
    }
    if (flow && !r->status) {
        *at_end = r->event.end_mark.index;
    }
    return r->status;
}

/* Which robot it is; a file may be named from the folder of the configuration. */
static int take_def(reader *r)
{
    config_robot *robot = r->robot;
    char complaint[APP_LINE_BYTES], name[CONFIG_PATH_BYTES];
    if (take_text(r, name, sizeof name)) {
        return r->status;
    }
    if (robot->trimmed || robot->offsets) {
        return complain(r, &r->event.start_mark, "%s",
                        "robot stands before trim and offset, which name its joints");
    }
    size_t folder = strcspn(name, "/\\.") < strlen(name) && name[0] != '/'
                        ? (size_t)(strrchr(r->path, '/') ? strrchr(r->path, '/') + 1 - r->path : 0)
                        : 0;
    if ((size_t)snprintf(robot->def, sizeof robot->def, "%.*s%s", (int)folder, r->path, name) >=
        sizeof robot->def) {
        return complain(r, &r->event.start_mark, "%s", "a path that is too long");
    }
    const grobo_robot_def *def = robot_find(robot->def, complaint, sizeof complaint);
    if (!def) {
        return complain(r, &r->event.start_mark, "%s", complaint);
    }
    r->model = def->model;
    robot->def_end = r->event.end_mark.index;
    return 0;
}

static int take_field(reader *r, const char *key)
{
    config_robot *robot = r->robot;
    size_t at, end;
    if (!robot->first_at) {
        robot->first_at = r->event.start_mark.index;
        robot->first_column = r->event.start_mark.column;
    }
    if (strcmp(key, "device") == 0) {
        return take_text(r, robot->device, sizeof robot->device);
    }
    if (strcmp(key, "robot") == 0) {
        return take_def(r);
    }
    if (strcmp(key, "wiring") == 0) {
        return take_option(r, GLOBAL_WIRING, &robot->wiring);
    }
    if (strcmp(key, "echo") == 0) {
        return take_flag(r, &robot->echo);
    }
    if (strcmp(key, "baud") == 0) {
        return take_option(r, GLOBAL_BAUD, &robot->baud);
    }
    if (strcmp(key, "on_exit") == 0) {
        return take_option(r, GLOBAL_ON_EXIT, &robot->on_exit);
    }
    if (strcmp(key, "trim") == 0) {
        robot->trimmed = true;
        return take_degrees(r, robot->trim_deg, &robot->trim_at, &robot->trim_end);
    }
    if (strcmp(key, "offset") == 0) {
        robot->offsets = true;
        return take_degrees(r, robot->offset_deg, &at, &end);
    }
    return complain(
        r, &r->event.start_mark,
        "no key '%s'; there are device, robot, wiring, echo, baud, on_exit, trim, offset", key);
}

/* The name of a robot lives no longer than its event: the nearest one is copied. */
static void try_name(reader *r, const char *name)
{
    int edits = r->guess.best ? r->guess.edits : -1;
    r->guess.name = r->wanted;
    r->guess.length = strlen(r->wanted);
    cli_guess_try(&r->guess, name);
    if (r->guess.best && r->guess.edits != edits) {
        snprintf(r->nearest, sizeof r->nearest, "%s", name);
        r->guess.best = r->nearest;
    }
}

/* Every robot is checked; the one that is wanted is kept. */
static int take_robot(reader *r, const char *name)
{
    static config_robot one;
    config_robot *kept = r->robot;
    yaml_mark_t at = r->event.start_mark;
    memset(&one, 0, sizeof one);
    r->model = app_model(r->a);
    if (next(r)) {
        return r->status;
    }
    one.flow = r->event.type == YAML_MAPPING_START_EVENT &&
               r->event.data.mapping_start.style == YAML_FLOW_MAPPING_STYLE;
    r->robot = &one;
    each_key(r, take_field);
    r->robot = kept;
    if (!r->status && !*one.device) {
        return complain(r, &at, "robot %s has no device", name);
    }
    if (!r->status && strcmp(name, r->wanted) == 0) {
        *kept = one;
        snprintf(kept->name, sizeof kept->name, "%s", name);
        snprintf(kept->path, sizeof kept->path, "%s", r->path);
    }
    try_name(r, name);
    return r->status;
}

/* One more robot of a group. */
static int take_member(reader *r, config_group *one)
{
    const char *robot = scalar(r);
    if (!robot || !*robot || r->event.data.scalar.length >= sizeof one->robot[0]) {
        return complain(r, &r->event.start_mark, "%s", "the name of a robot is wanted here");
    }
    for (int i = 0; i < one->n; i++) {
        if (strcmp(one->robot[i], robot) == 0) {
            return complain(r, &r->event.start_mark, "%s is in the group already", robot);
        }
    }
    if (one->n == CONFIG_GROUP_MAX) {
        return complain(r, &r->event.start_mark, "%s", "a group has 64 robots at most");
    }
    snprintf(one->robot[one->n++], sizeof one->robot[0], "%s", robot);
    return 0;
}

/* Every group is checked; the one that is wanted is kept. */
static int take_group(reader *r, const char *name)
{
    static config_group one;
    yaml_mark_t at = r->event.start_mark;
    memset(&one, 0, sizeof one);
    if (next(r)) {
        return r->status;
    }
    if (r->event.type != YAML_SEQUENCE_START_EVENT) {
        return complain(r, &r->event.start_mark, "%s", "a list of robots is wanted here");
    }
    while (!r->status && next(r) == 0 && r->event.type != YAML_SEQUENCE_END_EVENT) {
        take_member(r, &one);
    }
    if (!r->status && one.n == 0) {
        return complain(r, &at, "group %s has no robots", name);
    }
    if (!r->status && r->group && strcmp(name, r->wanted) == 0) {
        *r->group = one;
        snprintf(r->group->name, sizeof r->group->name, "%s", name);
        snprintf(r->group->path, sizeof r->group->path, "%s", r->path);
    }
    try_name(r, name);
    return r->status;
}

static int take_top(reader *r, const char *key)
{
    char name[CONFIG_NAME_BYTES];
    if (strcmp(key, "groups") == 0) {
        return next(r) ? r->status : each_key(r, take_group);
    }
    if (strcmp(key, "robots") == 0) {
        return next(r) ? r->status : each_key(r, take_robot);
    }
    if (strcmp(key, "warn_fall") == 0) {
        r->has_warn_fall = take_truth(r, &r->warn_fall) == 0;
        return r->status;
    }
    if (strcmp(key, "default") != 0) {
        return complain(r, &r->event.start_mark,
                        "no key '%s'; there are default, robots, groups, warn_fall", key);
    }
    if (take_text(r, name, sizeof name) == 0 && r->wants_default) {
        if (*r->robot->name == '\0' && *r->wanted == '\0') {
            snprintf(r->wanted, sizeof r->wanted, "%s", name);
            snprintf(r->default_path, sizeof r->default_path, "%s", r->path);
        }
    }
    return r->status;
}

/* ---- files ---------------------------------------------------------------------------------- */

/* A file, or a text where that is NULL. */
static int read_file(reader *r, FILE *file, const char *text, size_t size)
{
    if (!yaml_parser_initialize(&r->parser)) {
        return app_fail(r->a, EXIT_ROBOT, "NOMEM", "%s: not enough memory", r->path);
    }
    if (file) {
        yaml_parser_set_input_file(&r->parser, file);
    } else {
        yaml_parser_set_input_string(&r->parser, (const unsigned char *)text, size);
    }
    r->has_event = false;
    next(r);
    if (!r->status) {
        next(r);
    }
    if (!r->status && r->event.type == YAML_DOCUMENT_START_EVENT && next(r) == 0 &&
        !(scalar(r) && !*scalar(r))) { /* a file of comments alone */
        each_key(r, take_top);
    }
    if (r->has_event) {
        yaml_event_delete(&r->event);
    }
    yaml_parser_delete(&r->parser);
    return r->status;
}

/* Reads both files; the user's comes first. Returns 0 whether or not the robot was found. */
static int find(reader *r)
{
    for (int i = 0; i < 2 && !r->status && !*r->robot->name; i++) {
        /* `default` may stand behind `robots`: then the file is read again for its robot. */
        for (int round = 0; round < 2 && !r->status && !*r->robot->name; round++) {
            bool knew = *r->wanted != '\0';
            errno = 0;
            FILE *file = os_config_path(i, r->path, sizeof r->path) ? fopen(r->path, "r") : NULL;
            if (!file && errno && errno != ENOENT && errno != ENOTDIR) {
                return r->status = app_fail_cause(r->a, EXIT_FILE, errno, "%s", r->path);
            }
            if (!file) {
                break;
            }
            read_file(r, file, NULL, 0);
            fclose(file);
            if (knew) {
                break;
            }
        }
    }
    return r->status;
}

/* ---- applying ------------------------------------------------------------------------------- */

/* Commands that speak to no robot: a bad configuration does not keep them from working. */
static bool is_offline(const cli_command *command)
{
    static const char *const names[] = {
        "ports",      "check",   "show",   "plot",   "convert", "decode", "sim",   "help",
        "completion", "version", "budget", "joints", "robot",   "follow", "setup", "fleet"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (strcmp(command->name, names[i]) == 0) {
            return true;
        }
    }
    return false;
}

/* True where a name of the configuration may stand: no path, no scheme, none of the words. */
static bool may_be_name(const char *device)
{
    return *device && !strpbrk(device, "/:\\") && strcmp(device, "auto") != 0 &&
           strcmp(device, "sim") != 0 && strlen(device) < CONFIG_NAME_BYTES;
}

static void set_option(app *a, int global, const cli_value *value)
{
    if (value->given && !a->line.global[global].given) {
        a->line.global[global] = *value;
    }
}

/* No robot has the name: where it was asked for, it may be a device; conn_open() finds out. */
static int no_robot(reader *r, bool asked)
{
    static char nearest[CONFIG_NAME_BYTES];
    r->guess.name = r->wanted;
    r->guess.length = strlen(r->wanted);
    if (asked) {
        cli_guess_try(&r->guess, GROBO_DEVICE_AUTO);
        cli_guess_try(&r->guess, GROBO_DEVICE_SIM);
    }
    snprintf(nearest, sizeof nearest, "%s", r->guess.best ? r->guess.best : "");
    r->a->nearest_device = *nearest ? nearest : NULL;
    if (asked || !*r->wanted) {
        return 0;
    }
    return app_fail(r->a, EXIT_FILE, "NOTFOUND",
                    "%s: default '%s' is not a robot of the file%s%s%s", r->default_path, r->wanted,
                    *nearest ? _("; did you mean '") : "", nearest, *nearest ? "'?" : "");
}

int config_check_name(app *a, const char *name)
{
    static config_robot robot;
    reader r = {.a = a, .robot = &robot};
    bool fits = strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") ==
                strlen(name);
    if (!may_be_name(name) || !fits) {
        return app_fail(a, EXIT_USAGE, "ARG", "'%s': a name of letters, digits, _ and - is wanted",
                        name);
    }
    memset(&robot, 0, sizeof robot);
    snprintf(r.wanted, sizeof r.wanted, "%s", name);
    find(&r);
    if (!r.status && *robot.name) {
        return app_fail(a, EXIT_USAGE, "EXISTS", "%s has a robot called %s already", robot.path,
                        name);
    }
    return r.status;
}

/* group: NULL where none is wanted. */
static int apply(app *a, config_robot *robot, config_group *group)
{
    const cli_value *device = app_global(a, GLOBAL_DEVICE);
    const char *fallback = getenv("GRCTL_DEVICE");
    const char *asked = device->given ? device->text : fallback && *fallback ? fallback : NULL;
    reader r = {.a = a, .robot = robot, .group = group, .wants_default = asked == NULL};
    a->nearest_device = NULL;
    if (is_offline(a->line.command) || (asked && !may_be_name(asked))) {
        return 0;
    }
    memset(robot, 0, sizeof *robot);
    if (asked) {
        snprintf(r.wanted, sizeof r.wanted, "%s", asked);
    }
    find(&r);
    if (group && *group->name && *robot->name) {
        return app_fail(a, EXIT_FILE, "ARG", "%s: a robot and a group are called %s", group->path,
                        group->name);
    }
    if (group && *group->name) {
        a->group = group;
        return r.status;
    }
    if (!*robot->name) {
        return r.status ? r.status : no_robot(&r, asked != NULL);
    }
    a->line.global[GLOBAL_DEVICE] = (cli_value){.given = 1, .text = robot->device};
    set_option(a, GLOBAL_WIRING, &robot->wiring);
    set_option(a, GLOBAL_ECHO, &robot->echo);
    set_option(a, GLOBAL_BAUD, &robot->baud);
    a->robot = robot;
    return r.status;
}

int config_apply(app *a)
{
    static config_robot robot;
    static config_group group;
    memset(&group, 0, sizeof group);
    a->group = NULL;
    return apply(a, &robot, &group);
}

int config_apply_member(app *a, const char *name, config_robot *robot)
{
    a->group = NULL;
    a->line.global[GLOBAL_DEVICE] = (cli_value){.given = 1, .text = name};
    int status = apply(a, robot, NULL);
    if (!status && !*robot->name && may_be_name(name)) {
        return app_fail(a, EXIT_FILE, "NOTFOUND", "no robot of that name is configured");
    }
    return status;
}

bool config_is_unknown_name(const app *a, const char *device)
{
    char path[GROBO_DEVICE_MAX_BYTES];
    return !a->robot && may_be_name(device) && !node_true_path(device, path, sizeof path);
}

bool config_warns_of_falls(const app *a)
{
    static config_robot robot;
    char hushed[APP_LINE_BYTES];
    app quiet = *a;
    reader r = {.a = &quiet, .robot = &robot};
    quiet.hushed = hushed;
    for (int i = 0; i < 2 && !r.has_warn_fall; i++) {
        FILE *file = os_config_path(i, r.path, sizeof r.path) ? fopen(r.path, "r") : NULL;
        memset(&robot, 0, sizeof robot);
        r.status = 0;
        if (!file) {
            continue;
        }
        read_file(&r, file, NULL, 0);
        fclose(file);
    }
    return !r.has_warn_fall || r.warn_fall;
}

bool config_find_in(const app *a, const char *text, size_t size, const config_robot *wanted,
                    config_robot *found)
{
    char hushed[APP_LINE_BYTES];
    app quiet = *a;
    reader r = {.a = &quiet, .robot = found};
    quiet.hushed = hushed;
    quiet.driver = NULL; /* it is not chosen yet where a configuration is read */
    memset(found, 0, sizeof *found);
    snprintf(r.wanted, sizeof r.wanted, "%s", wanted->name);
    snprintf(r.path, sizeof r.path, "%s", wanted->path);
    return !read_file(&r, NULL, text, size) && strcmp(found->name, wanted->name) == 0 &&
           strcmp(found->device, wanted->device) == 0;
}
