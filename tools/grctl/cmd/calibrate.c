/* SPDX-License-Identifier: MIT */
/* calibrate: what a robot of its kind does not have alike: offsets and ranges that servos keep, or
 * the trims of a configured robot. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tools/grctl/bringup/homing.h"
#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/each_line.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/lang/lang.h"

enum { OPT_DRY_RUN, OPT_FROM, OPT_RESTORE, OPT_OUT };

static const cli_option options[] = {
    [OPT_DRY_RUN] = OPTION_FLAG("dry-run", 0, "show what would be written, write nothing"),
    [OPT_FROM] = OPTION_TEXT("from", 0, "FILE", "take a calibration of LeRobot's form"),
    [OPT_RESTORE] = OPTION_TEXT("restore", 0, "FILE", "write back what the servos held before"),
    [OPT_OUT] =
        OPTION_TEXT("out", 'o', "FILE", "keep the calibration there (ROBOT-calibration.json)"),
};

static void show(const app *a, const config_robot *before, const config_robot *after)
{
    json_t *list = json_array();
    const grobo_model *model = app_model(a);
    for (int j = 0; j < model->n_joints; j++) {
        if (!a->json && after->trim_deg[j] != before->trim_deg[j]) {
            app_print("%5d  %-12s  %6.1f -> %6.1f deg\n", grobo_model_joint(model, j)->motor,
                      grobo_model_joint(model, j)->name, before->trim_deg[j], after->trim_deg[j]);
        }
        json_array_append_new(list, json_pack("{s:i,s:i,s:s,s:o,s:o}", "joint", j, "motor",
                                              grobo_model_joint(model, j)->motor, "name",
                                              grobo_model_joint(model, j)->name, "before_deg",
                                              app_json_number(before->trim_deg[j], 1), "trim_deg",
                                              app_json_number(after->trim_deg[j], 1)));
    }
    if (a->json) {
        app_print_json(json_pack("{s:s,s:o,s:b,s:o}", "robot", after->name, "file",
                                 app_json_text(after->path), "written",
                                 !app_option(a, OPT_DRY_RUN)->given, "joints", list));
    } else {
        json_decref(list);
    }
}

/* Asked on a terminal only; nobody is asked to answer for a script. */
static bool confirmed(const app *a, const config_robot *robot)
{
    int answer, c;
    if (!a->tty_in || app_global(a, GLOBAL_YES)->given) {
        return true;
    }
    output_complain(_("write these trims of %s to %s? [y/N] "), robot->name, robot->path);
    answer = c = getchar();
    while (c != '\n' && c != EOF) {
        c = getchar();
    }
    return answer == 'y' || answer == 'Y';
}

static int finish(app *a, config_robot *after, grobo_joint_mask joints)
{
    if (app_option(a, OPT_DRY_RUN)->given) {
        show(a, a->robot, after);
        return EXIT_DONE;
    }
    if (!a->json) {
        show(a, a->robot, after);
    }
    if (!confirmed(a, after)) {
        return app_fail(a, EXIT_USAGE, "CANCELED", "calibrate: nothing was written");
    }
    int status = config_write_trims(a, after, joints);
    if (status) {
        return status;
    }
    if (a->json) {
        show(a, a->robot, after);
    } else {
        app_note(a, "trims of %s written to %s", after->name, after->path);
    }
    return EXIT_DONE;
}

static int set_trim(app *a, config_robot *after, int joint, double deg)
{
    deg = round(deg * 10) / 10;
    if (fabs(deg) > CONFIG_TRIM_MAX_DEG) {
        return app_fail(a, EXIT_SAFETY, "LIMIT",
                        "calibrate: %s is %.1f deg off, more than %d; does its horn sit right?",
                        grobo_model_joint(app_model(a), joint)->name, deg, CONFIG_TRIM_MAX_DEG);
    }
    after->trim_deg[joint] = deg == 0 ? 0 : deg;
    return EXIT_DONE;
}

/* Where the joints stand is called the initial posture: what they read beside it is the trim. */
static int measure(app *a, config_robot *after)
{
    conn c;
    const grobo_model *model = app_model(a);
    int status = conn_open(&c, a);
    int error = status ? 0 : conn_sense(&c, GROBO_JOINTS_ALL(model->n_joints), GROBO_SENSE_FULL);
    if (error) {
        status = conn_fail(&c, error, "calibrate");
    }
    for (int j = 0; j < model->n_joints && !status; j++) {
        grobo_joint_info i;
        if (grobo_robot_joint(c.robot, j, &i) < 0) {
            continue;
        }
        status = set_trim(
            a, after, j,
            a->robot->trim_deg[j] +
                grobo_deg_from_rad(i.state.angle_rad - grobo_model_joint(model, j)->init_rad));
    }
    return conn_close(&c, status);
}

static int fail_unnamed(app *a)
{
    return homing_fits(a)
               ? app_fail(a, EXIT_USAGE, "ARG",
                          "calibrate: -d must name a robot of ~/.config/grctl/config.yaml; see "
                          "'grctl help calibrate'")
               : app_fail(a, EXIT_USAGE, "ARG",
                          "calibrate: the servos of %s keep no calibration, and -d names no robot "
                          "of ~/.config/grctl/config.yaml, where it has trims",
                          robot_of(a)->name);
}

/* Servos of several lines: each line has ids of its own. */
static int run_lines(app *a, bool files)
{
    return files ? app_fail(a, EXIT_USAGE, "ARG",
                            "calibrate: a file is of one line: choose it, as by --line %s",
                            robot_of(a)->lines[0].name)
                 : each_line_all(a);
}

/* Trims of all joints, as they stand, or of the one that is named. */
static int trim(app *a)
{
    double deg;
    int status = 0;
    config_robot after = *a->robot;
    grobo_joint_mask joints = GROBO_JOINTS_ALL(app_model(a)->n_joints);
    if (a->line.n_arguments == 0) {
        status = measure(a, &after);
    } else {
        const char *name = a->line.argument[0];
        int joint = joints_parse_one(a, name, strlen(name), &status);
        if (joint < 0) {
            return status;
        }
        if (!cli_read_number(a->line.argument[1], &deg)) {
            return app_fail(a, EXIT_USAGE, "ARG", "calibrate: '%s' is not an angle in degrees",
                            a->line.argument[1]);
        }
        joints = GROBO_JOINT_BIT(joint);
        status = set_trim(a, &after, joint, deg);
    }
    return status ? status : finish(a, &after, joints);
}

static int run(app *a)
{
    const homing_orders orders = {.from = app_option(a, OPT_FROM)->text,
                                  .restore = app_option(a, OPT_RESTORE)->text,
                                  .out = app_option(a, OPT_OUT)->text,
                                  .dry_run = app_option(a, OPT_DRY_RUN)->given > 0};
    bool files = orders.from || orders.restore || orders.out;
    bool has_trims = a->robot && !grobo_model_joint(app_model(a), 0)->calibrated;
    if (a->line.n_arguments == 0 && robot_of(a)->n_lines > 0 && !has_trims) {
        return run_lines(a, files);
    }
    if (a->line.n_arguments == 0 && homing_fits(a) && (files || !has_trims)) {
        return homing_run(a, &orders);
    }
    if (files) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "calibrate: the servos of %s keep no calibration; it has trims",
                        robot_of(a)->name);
    }
    if (!a->robot) {
        return fail_unnamed(a);
    }
    if (a->line.n_arguments == 1) {
        return app_fail(a, EXIT_USAGE, "ARG", "calibrate needs JOINT DEG, or neither");
    }
    return trim(a);
}

const cli_command cmd_calibrate = {
    .name = "calibrate",
    COMMAND_ARGUMENTS("[JOINT DEG]", 0, 2, CLI_ARG_JOINT),
    .summary = "set the middle of servos, or write trims",
    .details =
        "Servos of Feetech (STS) and DYNAMIXEL (X) keep where their middle is. Press enter,\n"
        "and torque goes off; put every joint into the middle of its range and press enter,\n"
        "then move every joint to both of its ends and press enter. The offset and the limits\n"
        "go to the servos, and to a file of LeRobot's form, which --from reads. From then on a\n"
        "joint goes as far as its servo, and no further than the robot's file says. AX and SCS\n"
        "keep no offset, but their limits. What the servos held before is written to a file\n"
        "first; --restore writes it back, as it would any file of that form. The robot's file\n"
        "says 'calibrated: true'; its servos move only once they are.\n"
        "\n"
        "Other robots have trims. Switch torque off, put the robot by hand into its initial\n"
        "posture, and run it: what the joints read beside that posture becomes their trims. With\n"
        "JOINT and DEG it sets the trim of one joint and speaks to no robot. A trim is added\n"
        "to every angle that goes to the servo and taken from every angle it reports; limits\n"
        "hold for both.\n\n"
        "The robot is one of ~/.config/grctl/config.yaml or /etc/grctl/config.yaml:\n\n"
        "  default: kitchen\n"
        "  robots:\n"
        "    kitchen:\n"
        "      device: /dev/serial/by-id/usb-FTDI_FT232R-if00-port0\n"
        "      robot: gr001           # or another name, or a file\n"
        "      wiring: board          # or bus; and echo: true if its adapter has one\n"
        "      baud: 115200\n"
        "      on_exit: hold          # or off, sit: where a motion is cut short\n"
        "      trim: {R_KNEE_P: 1.5}  # degrees\n"
        "      offset: {m12: 2}       # added to what is read only\n\n"
        "Only the trims change in the file: it is replaced as a whole when the new one is safely\n"
        "stored.\n",
    .example = "  grctl --robot so101 -d /dev/ttyACM0 calibrate\n"
               "  grctl --robot so101 -d /dev/ttyACM0 calibrate --from lerobot.json\n"
               "  grctl -d kitchen servo off\n  grctl -d kitchen calibrate\n"
               "  grctl -d kitchen calibrate R_KNEE_P 1.5\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
