/* SPDX-License-Identifier: MIT */
/* robot: the robots there are, and what is wrong with a file of one. Offline. */
#include <string.h>

#include "tools/grctl/bringup/ask.h"
#include "tools/grctl/bringup/found.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/lang/lang.h"

enum { OPT_FAMILY, OPT_SERVO, OPT_IDS, OPT_ORDER, OPT_NAME, OPT_OUT, OPT_MJCF, OPT_URDF, OPT_FREE };

static const cli_option options[] = {
    [OPT_FAMILY] = OPTION_CHOICE("family", 0, family_names,
                                 "family of its servos (import: feetech; new: all)"),
    [OPT_SERVO] = OPTION_TEXT("servo", 0, "MODEL[,MODEL]...",
                              "import: its servos, one for all or for each joint"),
    [OPT_IDS] =
        OPTION_TEXT("ids", 0, "JOINT=ID,...", "import: id of each joint, those of @FILE, or 1-4,7"),
    [OPT_ORDER] = OPTION_CHOICE("order", 0, "chain|file",
                                "import: joints along the chain, or as a URDF lists them (chain)"),
    [OPT_NAME] = OPTION_TEXT("name", 0, "NAME", "import, new: name of the robot"),
    [OPT_OUT] =
        OPTION_TEXT("out", 'o', "FILE", "import, new, export: the file to write (standard output)"),
    [OPT_MJCF] = OPTION_FLAG("mjcf", 0, "export: as MuJoCo's MJCF"),
    [OPT_URDF] = OPTION_FLAG("urdf", 0, "export: as URDF"),
    [OPT_FREE] = OPTION_FLAG("free", 0, "export: an MJCF whose base is free, as with feet"),
};

static int run_list(const app *a)
{
    json_t *list = json_array();
    for (size_t i = 0; grobo_robot_def_at(i); i++) {
        const grobo_robot_def *def = grobo_robot_def_at(i);
        if (!a->json) {
            app_print("%-18s %-12s %2d joints  %s\n", def->name, def->family->name,
                      def->model->n_joints, def->title);
        }
        json_array_append_new(list, json_pack("{s:s,s:s,s:s,s:i}", "name", def->name, "title",
                                              def->title, "family", def->family->name, "n_joints",
                                              def->model->n_joints));
    }
    if (a->json) {
        app_print_json(json_pack("{s:o}", "robots", list));
    } else {
        json_decref(list);
    }
    return EXIT_DONE;
}

/* ---- one ------------------------------------------------------------------------------------ */

static const char *exit_name(grobo_exit_policy policy)
{
    switch (policy) {
    case GROBO_EXIT_OFF:
        return "off";
    case GROBO_EXIT_SIT:
        return "sit";
    case GROBO_EXIT_DEFAULT:
    case GROBO_EXIT_HOLD:
        break;
    }
    return "hold";
}

static json_t *usb_json(const grobo_robot_def *def)
{
    json_t *list = json_array();
    for (int i = 0; i < def->n_usb; i++) {
        char text[16];
        snprintf(text, sizeof text, "%04x:%04x", def->usb[i].vendor, def->usb[i].product);
        json_array_append_new(list, json_string(text));
    }
    return list;
}

static double mass_kg(const grobo_robot_def *def)
{
    double sum = 0;
    for (int i = 0; i < def->n_links; i++) {
        sum += def->links[i].mass_kg;
    }
    return sum;
}

static json_t *whole_json(const grobo_robot_def *def)
{
    const grobo_safety_limits *limits = &def->limits;
    return json_pack(
        "{s:s,s:s,s:s,s:s,s:s,s:I,s:o,s:{s:i,s:i,s:I,s:I,s:I,s:o},s:s,s:b,s:i,s:i,s:o}", "name",
        def->name, "title", def->title, "model", def->model->name, "family", def->family->name,
        "wiring", def->wiring == GROBO_WIRING_BOARD ? "board" : "bus", "baud_bps",
        (json_int_t)def->baud_bps, "usb", usb_json(def), "safety", "temperature_c",
        limits->temperature_c, "lost_replies", limits->lost_replies, "current_ma",
        (json_int_t)limits->current_ma, "current_ms", (json_int_t)(limits->current_us / 1000),
        "voltage_mv", (json_int_t)limits->voltage_mv, "approach_dps",
        app_json_number(grobo_deg_from_rad(limits->approach_rad_s), 1), "exit",
        exit_name(def->on_exit), "arm", def->arm, "n_joints", def->model->n_joints, "n_links",
        def->n_links, "mass_kg", app_json_number(mass_kg(def), 3));
}

/* Each line with its joints. */
static json_t *lines_json(const grobo_robot_def *def)
{
    json_t *list = json_array();
    for (int i = 0; i < def->n_lines; i++) {
        const grobo_robot_file_line *line = &def->lines[i];
        json_t *joints = json_array();
        for (int j = 0; j < def->model->n_joints; j++) {
            const grobo_joint *joint = grobo_model_joint(def->model, j);
            if (joint->line == i) {
                json_array_append_new(joints, json_string(joint->name));
            }
        }
        json_array_append_new(list, json_pack("{s:s,s:s,s:s,s:I,s:s?,s:b,s:o}", "name", line->name,
                                              "family", line->family->name, "wiring",
                                              line->wiring == GROBO_WIRING_BOARD ? "board" : "bus",
                                              "baud_bps", (json_int_t)line->baud_bps, "port",
                                              line->port, "echo", line->echo, "joints", joints));
    }
    return list;
}

static json_t *robot_json(const grobo_robot_def *def)
{
    json_t *robot = whole_json(def);
    if (def->n_lines > 0) {
        json_object_set_new(robot, "lines", lines_json(def));
    }
    return robot;
}

static void print_line(const grobo_robot_def *def)
{
    app_print("servos     %d of family %s\n", def->model->n_joints, def->family->name);
    app_print("line       %lu bps, %s", (unsigned long)def->baud_bps,
              def->wiring == GROBO_WIRING_BOARD ? "through its board" : "servos on a bus");
    for (int i = 0; i < def->n_usb; i++) {
        app_print("%s%04x:%04x", i ? " " : ", USB ", def->usb[i].vendor, def->usb[i].product);
    }
    app_print("\n");
}

static int joints_on(const grobo_robot_def *def, int line)
{
    int n = 0;
    for (int j = 0; j < def->model->n_joints; j++) {
        n += grobo_model_joint(def->model, j)->line == line;
    }
    return n;
}

static void print_lines(const grobo_robot_def *def)
{
    for (int i = 0; i < def->n_lines; i++) {
        const grobo_robot_file_line *line = &def->lines[i];
        app_print("line       %s: %d servos of family %s, %lu bps%s%s\n", line->name,
                  joints_on(def, i), line->family->name, (unsigned long)line->baud_bps,
                  line->port ? ", " : "", line->port ? line->port : "");
    }
}

static void print_robot(const grobo_robot_def *def)
{
    const grobo_safety_limits *limits = &def->limits;
    app_print_line("%s: %s", def->name, def->title);
    if (def->n_lines > 0) {
        print_lines(def);
    } else {
        print_line(def);
    }
    app_print("stops at   %d deg C, %d lost replies", limits->temperature_c, limits->lost_replies);
    if (limits->current_ma) {
        app_print(", %ld mA for %ld ms", (long)limits->current_ma,
                  (long)(limits->current_us / 1000));
    }
    if (limits->voltage_mv) {
        app_print(", %.1f V", limits->voltage_mv / 1e3);
    }
    app_print("\nat exit    %s\n", exit_name(def->on_exit));
    if (def->n_links) {
        app_print("geometry   %d parts, %.2f kg\n", def->n_links, mass_kg(def));
    } else {
        app_print("geometry   not in its file\n");
    }
    app_print("joints     grctl --robot %s joints\n", def->name);
}

static int run_show(app *a, const char *name)
{
    char complaint[APP_LINE_BYTES];
    const grobo_robot_def *def = name ? robot_find(name, complaint, sizeof complaint) : robot_of(a);
    if (!def) {
        return app_fail(a, EXIT_FILE, "NOTFOUND", "%s", complaint);
    }
    if (a->json) {
        app_print_json(robot_json(def));
    } else {
        print_robot(def);
    }
    return EXIT_DONE;
}

/* ---- what is wrong -------------------------------------------------------------------------- */

/* A joint that another servo moves than in the robot whose joints are called so. */
static bool warn_of_ids(const app *a, const grobo_robot_def *def)
{
    const grobo_robot_def *known = sketch_namesake(def->model);
    int n = 0;
    for (int j = 0; known && j < def->model->n_joints; j++) {
        const grobo_joint *joint = grobo_model_joint(def->model, j);
        int at = grobo_model_find_joint(known->model, joint->name, strlen(joint->name));
        if (at >= 0 && grobo_model_joint(known->model, at)->motor != joint->motor) {
            app_note(a, "%s: warning: %s has the id %d, in %s it has %d", def->name, joint->name,
                     joint->motor, known->name, grobo_model_joint(known->model, at)->motor);
            n++;
        }
    }
    return n > 0;
}

/* What is to be said of a line that does not carry moves of all joints; NULL: it does. */
static const char *slow_line(const grobo_robot_def *def)
{
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    int baud_bps = (int)def->baud_bps, rate_bps = 0;
    bool slow = grobo_robot_def_driver(def, def->wiring, &driver) >= 0 &&
                wire_is_slow(&driver, baud_bps, &rate_bps);
    return slow ? wire_slow_text(&driver, baud_bps, rate_bps) : NULL;
}

static int run_check(app *a, const char *path)
{
    grobo_diagnostics *list = NULL;
    grobo_robot_def *def = NULL;
    grobo_diagnostic d;
    int error = grobo_diagnostics_new(NULL, &list);
    if (!error) {
        error = robot_read(path, list, &def);
    }
    if (error && grobo_diagnostics_get(list, 0, &d) < 0) {
        grobo_diagnostics_free(list);
        return app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: %s", path,
                        robot_read_fault(error));
    }
    for (size_t i = 0; !a->json && grobo_diagnostics_get(list, i, &d) == 0; i++) {
        file_print(a, &d, "");
    }
    const char *slow = error ? NULL : slow_line(def);
    if (a->json) {
        app_print_json(json_pack("{s:b,s:o,s:s*}", "ok", !error, "diagnostics", file_json(list),
                                 "slow_line", slow));
    } else if (slow) {
        (void)warn_of_ids(a, def);
        app_note(a, "%s: %s", def->name, slow);
    } else if (!error && !warn_of_ids(a, def)) {
        app_note(a, "%s: %d joint%s, nothing wrong", def->name, def->model->n_joints,
                 def->model->n_joints == 1 ? "" : "s");
    }
    grobo_robot_def_free(def);
    grobo_diagnostics_free(list);
    return error ? EXIT_FILE : EXIT_DONE;
}

/* ---- servos --------------------------------------------------------------------------------- */

/* It tells no position, or bare counts, of which nobody knows what they are worth. */
static const char *why_no_joint(const grobo_servo_model *servo)
{
    const grobo_servo_register *position = grobo_servo_register_of(servo, GROBO_ROLE_POSITION);
    return position ? _("  cannot be a joint: its scale is not known")
                    : _("  cannot be a joint: it does not tell its position");
}

/* What a user should know of a model before it becomes a joint. */
static const char *note_of(const grobo_servo_model *servo)
{
    return (servo->flags & GROBO_MODEL_NO_JOINT) != 0 ? why_no_joint(servo)
           : (servo->flags & GROBO_MODEL_UNVERIFIED) != 0
               ? _("  speed, torque or current unverified")
               : "";
}

static void list_servos(const app *a, const grobo_robot_family *family, json_t *list)
{
    const grobo_servo_table *table;
    for (size_t i = 0; (table = family->tables[i]) != NULL; i++) {
        for (int m = 0; m < table->model_count; m++) {
            const grobo_servo_model *servo = &table->models[m];
            bool joint = (servo->flags & GROBO_MODEL_NO_JOINT) == 0;
            bool verified = (servo->flags & GROBO_MODEL_UNVERIFIED) == 0;
            if (!a->json) {
                app_print("%-12s %-15s %4d deg  %4d deg/s  %.1f V%s\n", family->name, servo->name,
                          servo->span_deg, servo->speed_dps, servo->voltage_mv / 1e3,
                          note_of(servo));
            }
            json_array_append_new(list, json_pack("{s:s,s:s,s:i,s:i,s:i,s:b,s:b}", "family",
                                                  family->name, "model", servo->name, "span_deg",
                                                  servo->span_deg, "speed_dps", servo->speed_dps,
                                                  "voltage_mv", servo->voltage_mv, "joint", joint,
                                                  "verified", verified));
        }
    }
}

static int run_servos(app *a, const char *name)
{
    json_t *list = json_array();
    int known = 0;
    for (size_t i = 0; grobo_robot_family_at(i); i++) {
        if (!name || strcmp(grobo_robot_family_at(i)->name, name) == 0) {
            list_servos(a, grobo_robot_family_at(i), list);
            known++;
        }
    }
    if (a->json && known) {
        app_print_json(json_pack("{s:O}", "servos", list));
    }
    json_decref(list);
    return known ? EXIT_DONE
                 : app_fail(a, EXIT_USAGE, "NOTFOUND",
                            "no family '%s'; 'grctl robot servos' has them", name);
}

/* ---- for simulators of bodies ---------------------------------------------------------------- */

static int run_export(app *a, const char *name)
{
    char complaint[APP_LINE_BYTES];
    bool urdf = app_option(a, OPT_URDF)->given > 0;
    if (urdf == (app_option(a, OPT_MJCF)->given > 0)) {
        return app_fail(a, EXIT_USAGE, "ARG", "robot export: one of --mjcf and --urdf is wanted");
    }
    if (urdf && app_option(a, OPT_FREE)->given) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "robot export: a URDF does not say whether its base is free");
    }
    const grobo_robot_def *def = name ? robot_find(name, complaint, sizeof complaint) : robot_of(a);
    if (!def) {
        return app_fail(a, EXIT_FILE, "NOTFOUND", "%s", complaint);
    }
    return sketch_export(a, def, urdf, app_option(a, OPT_FREE)->given > 0,
                         app_option(a, OPT_OUT)->text);
}

static int run(app *a)
{
    const char *what = a->line.argument[0];
    const char *name = a->line.n_arguments > 1 ? a->line.argument[1] : NULL;
    if (strcmp(what, "list") == 0 && !name) {
        return run_list(a);
    }
    if (strcmp(what, "show") == 0) {
        return run_show(a, name);
    }
    if (strcmp(what, "check") == 0 && name) {
        return run_check(a, name);
    }
    if (strcmp(what, "servos") == 0) {
        return run_servos(a, name);
    }
    if (strcmp(what, "import") == 0 && name) {
        bool asks = a->tty_in && !app_global(a, GLOBAL_YES)->given;
        const sketch_orders orders = {.family = app_option(a, OPT_FAMILY)->text,
                                      .servos = app_option(a, OPT_SERVO)->text,
                                      .ids = app_option(a, OPT_IDS)->text,
                                      .as_listed = app_option(a, OPT_ORDER)->choice == 1,
                                      .name = app_option(a, OPT_NAME)->text,
                                      .out = app_option(a, OPT_OUT)->text,
                                      .ask = asks ? ask_line : NULL};
        _Static_assert((int)ASK_BYTES <= (int)SKETCH_ANSWER_BYTES, "an answer fits");
        return sketch_import(a, name, &orders);
    }
    if (strcmp(what, "new") == 0 && !name) {
        return found_new(a, app_option(a, OPT_FAMILY)->text, app_option(a, OPT_NAME)->text,
                         app_option(a, OPT_OUT)->text);
    }
    if (strcmp(what, "export") == 0) {
        return run_export(a, name);
    }
    return app_fail(a, EXIT_USAGE, "ARG",
                    "robot takes list, show [NAME|FILE], check FILE, servos [FAMILY], import "
                    "FILE, export [NAME|FILE] or new; see 'grctl help robot'");
}

const cli_command cmd_robot = {
    .name = "robot",
    COMMAND_ARGUMENTS("list|show|check|servos|import|export|new [ROBOT]", 1, 2, CLI_ARG_ROBOT),
    .summary = "list known robots, write and check files of others",
    .details =
        "list: the robots that come with grctl. show: the contents of one of them, of a file, or\n"
        "of the robot of --robot. check: every problem of a file, with line and column; the exit\n"
        "status is 3 then. servos: the servos that a file may name, of all families or of one. No\n"
        "robot is asked.\n"
        "\n"
        "import: a robot's file from a URDF or a body of Choreonoid: joints, limits, speeds,\n"
        "parts with their masses. Servos that --family and --servo do not give are guessed, and a\n"
        "comment marks them, as it marks which way each turns. Limits that the\n"
        "servo does not reach are cut; joints that slide or follow another are treated as fixed.\n"
        "Ids are those of --ids; else those of a known robot whose joints have the same names;\n"
        "else they are asked for on a terminal, and missing ids are an error without one. --ids\n"
        "@FILE takes them from the robot in FILE by the names of joints. A list without names\n"
        "goes along the chain: it is shown, and needs a yes or --yes. Joints stand along the\n"
        "chain, too; with --order file as a URDF lists them, which is how Choreonoid numbers\n"
        "them: its motions fit then. A body that names the soles of two feet gets 'feet', and its\n"
        "legs are solved as GR001's.\n"
        "\n"
        "new: a robot's file of the servos that answer on the line of -d, of every family at its\n"
        "usual rates, or of --family, or at the rate of -b. Joints are called joint1 and so on;\n"
        "limits are those stored in the servos. A robot that comes with grctl and has these ids\n"
        "and servos is named.\n"
        "\n"
        "export: its links and joints for simulators of bodies, as MJCF (MuJoCo) or URDF:\n"
        "frames, masses, inertias, limits, soles. A robot with feet stands on a floor. What its\n"
        "file does not know is guessed, and a comment of the file says so. It is for\n"
        "python -m grobo.physics, see docs/guide/body.md.\n"
        "\n"
        "A robot is a YAML file: its joints with id, servo and limits, its line, its safety\n"
        "limits. docs/guide/own-robot.md describes the file, docs/robot.schema.json gives an\n"
        "editor its keys. Every command takes --robot NAME or --robot FILE; GRCTL_ROBOT and the\n"
        "key robot of a configured robot do the same.\n",
    .example = "  grctl robot list\n  grctl robot check ./arm.yaml\n"
               "  grctl --robot ./arm.yaml -d sim init\n"
               "  grctl robot import arm.urdf --family feetech --servo STS3215 -o arm.yaml\n"
               "  grctl -d /dev/ttyACM0 robot new -o arm.yaml\n"
               "  grctl robot export gr001 --mjcf -o gr001.xml\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
