/* SPDX-License-Identifier: MIT */
/* init, move and pose: one posture, reached safely and read back. */
#include <math.h>
#include <string.h>

#include <grobo/core/wheel.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/view/render.h"

enum { OPT_TIME };
enum { MOVE_MS = 1000, INIT_MS = 2000, LONGEST_MS = 163830 };
/* More than servos stay behind under a load: something is in the way. */
static const double there_deg = 5;

static const cli_option init_options[] = {
    [OPT_TIME] = OPTION_WHOLE("time", 't', "MS", 0, LONGEST_MS,
                              "time to get there; more where that is safer (2000)"),
};

static const cli_option pose_options[] = {
    [OPT_TIME] = OPTION_WHOLE("time", 't', "MS", 0, LONGEST_MS,
                              "time to get there; more where that is safer (1000)"),
};

static void report(const conn *c, const grobo_posture *target)
{
    int joint;
    double worst = render_worst_error(c, &joint);
    if (c->a->json) {
        app_print_json(json_pack("{s:o,s:o}", "joints", render_joints_json(c, target->set),
                                 "max_error_deg", app_json_number(joint < 0 ? NAN : worst, 2)));
    } else if (joint >= 0) {
        const grobo_model *model = conn_model(c);
        const char *name = grobo_model_joint(model, joint)->name;
        char text[JOINTS_TEXT_BYTES];
        joints_error_text(model, joint, worst, text);
        if (worst < there_deg) {
            app_note(c->a, "done; largest error %s (%s)", text, name);
        } else {
            app_note(c->a, "not reached: largest error %s (%s); is it blocked?", text, name);
        }
    }
}

/* The engine gave the joints more time than was asked for. */
static void report_longer(const conn *c, const grobo_posture *target, int64_t began_us)
{
    double asked_ms = (double)target->time_us / 1e3;
    double took_ms = (double)(grobo_now_us() - began_us) / 1e3;
    grobo_robot_counters n;
    conn_counters(c, &n);
    if (n.stretched > 0 && took_ms > asked_ms) {
        app_note(c->a, "it took %.0f ms, not %.0f: no joint moves faster than its servo can",
                 took_ms, asked_ms);
    }
}

/* A joint that follows another one goes where that one is sent. */
static int check_followers(app *a, const grobo_posture *target, const char *doing)
{
    const grobo_model *model = app_model(a);
    for (int j = 0; j < model->n_joints; j++) {
        const grobo_joint *joint = grobo_model_joint(model, j);
        const char *first = grobo_model_joint(model, joint->follows)->name;
        bool named = joint->ratio != 0 && (target->set & GROBO_JOINT_BIT(j)) != 0;
        if (named && (target->set & GROBO_JOINT_BIT(joint->follows)) == 0) {
            return app_fail(a, EXIT_USAGE, "ARG", "%s: %s follows %s; move %s instead", doing,
                            joint->name, first, first);
        }
    }
    return 0;
}

static int go(app *a, const grobo_posture *target, const char *doing)
{
    conn c;
    int status = check_followers(a, target, doing);
    if (status) {
        return status;
    }
    status = conn_open_to_move(&c, a);
    if (!status) {
        int64_t began_us = grobo_now_us();
        int job = grobo_robot_move(c.robot, target);
        c.moving = job > 0; /* refused at once: nothing moves, nothing is to be left */
        int error = conn_wait_shown(&c, job, doing, target->time_us);
        if (error) {
            status = conn_fail(&c, error, doing);
        } else {
            report(&c, target);
            report_longer(&c, target, began_us);
        }
    }
    return conn_close(&c, status);
}

static int run_init(app *a)
{
    grobo_posture target;
    grobo_posture_init_pose(&target, app_model(a));
    grobo_posture_set_time_ms(&target, app_number(a, OPT_TIME, INIT_MS));
    return go(a, &target, "init");
}

static int fail_angle(app *a, const char *doing, int joint, const char *text)
{
    switch (grobo_model_unit(app_model(a), joint)) {
    case GROBO_UNIT_DEG:
        return app_fail(a, EXIT_USAGE, "ARG", "%s: '%s' is not an angle in degrees", doing, text);
    case GROBO_UNIT_MM:
        return app_fail(a, EXIT_USAGE, "ARG", "%s: '%s' is not a place in mm", doing, text);
    case GROBO_UNIT_PCT:
        return app_fail(a, EXIT_USAGE, "ARG", "%s: '%s' is not a number of percent", doing, text);
    }
    return EXIT_USAGE;
}

static int run_move(app *a)
{
    const char *name = a->line.argument[0];
    const char *angle = a->line.argument[1];
    const char *time = a->line.n_arguments > 2 ? a->line.argument[2] : NULL;
    grobo_posture target;
    double angle_rad, ms = MOVE_MS;
    int status = 0;
    int joint = joints_parse_one(a, name, strlen(name), &status);
    if (joint < 0) {
        return status;
    }
    if (!joints_read_angle(app_model(a), joint, angle, &angle_rad)) {
        return fail_angle(a, "move", joint, angle);
    }
    if (time && (!cli_read_number(time, &ms) || ms < 0 || ms > LONGEST_MS)) {
        return app_fail(a, EXIT_USAGE, "ARG", "move: '%s' is not a time of 0 to %d ms", time,
                        LONGEST_MS);
    }
    grobo_posture_init(&target, app_model(a)->n_joints);
    grobo_posture_set_rad(&target, joint, angle_rad);
    grobo_posture_set_time_ms(&target, ms);
    status = joints_check_limits(a, &target, "move");
    return status ? status : go(a, &target, "move");
}

/* ---- pose ----------------------------------------------------------------------------------- */

/* "@greet.pseq:3": posture 3, counted from 1; without a number the first. */
static int pose_of_file(app *a, const char *spec, grobo_posture *target)
{
    char path[GROBO_PATH_MAX_BYTES];
    const char *colon = strrchr(spec, ':');
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(a)};
    grobo_motion *motion = NULL;
    double number = 1;
    size_t length = strlen(spec);
    if (colon && cli_read_number(colon + 1, &number)) {
        length = (size_t)(colon - spec);
    }
    if (length == 0 || length >= sizeof path || number < 1 || number > 1e9 ||
        number != floor(number)) {
        return app_fail(a, EXIT_USAGE, "ARG", "pose: '@%s' is not @FILE or @FILE:N", spec);
    }
    memcpy(path, spec, length);
    path[length] = '\0';
    int status = file_load(a, path, &read, &motion);
    if (status) {
        return status;
    }
    status = file_fits(a, path, motion, false);
    if (!status && grobo_motion_get(motion, (size_t)number - 1, target) < 0) {
        status = app_fail(a, EXIT_USAGE, "ARG", "pose: %s has %zu postures, no number %.0f", path,
                          grobo_motion_size(motion), number);
    }
    target->n_joints = app_model(a)->n_joints;
    target->set &= ~grobo_model_wheels(app_model(a)); /* their columns count for nothing */
    grobo_motion_free(motion);
    return status;
}

/* "R_KNEE_P=-40" */
static int pose_of_joint(app *a, const char *text, grobo_posture *target)
{
    size_t length = strcspn(text, "=");
    double angle_rad;
    int status = 0;
    int joint = joints_parse_one(a, text, length, &status);
    if (joint < 0) {
        return status;
    }
    if (text[length] != '=' ||
        !joints_read_angle(app_model(a), joint, text + length + 1, &angle_rad)) {
        return app_fail(a, EXIT_USAGE, "ARG", "pose: '%s' is not JOINT=DEG", text);
    }
    if (target->set & GROBO_JOINT_BIT(joint)) {
        return app_fail(a, EXIT_USAGE, "ARG", "pose: '%s': %s is there twice", text,
                        grobo_model_joint(app_model(a), joint)->name);
    }
    grobo_posture_set_rad(target, joint, angle_rad);
    return 0;
}

static bool all_numbers(const app *a)
{
    double number;
    for (int i = 0; i < a->line.n_arguments; i++) {
        if (!cli_read_number(a->line.argument[i], &number)) {
            return false;
        }
    }
    return true;
}

/* Angles of all motors, in the order of their numbers, as a line of a .m file has them. */
static int pose_of_motors(app *a, grobo_posture *target)
{
    uint8_t joints[GROBO_JOINTS_MAX];
    (void)grobo_model_motor_order(app_model(a), joints);
    for (int i = 0; i < a->line.n_arguments; i++) {
        double angle_rad;
        int joint = joints[i];
        if (!joints_read_angle(app_model(a), joint, a->line.argument[i], &angle_rad)) {
            return fail_angle(a, "pose", joint, a->line.argument[i]);
        }
        grobo_posture_set_rad(target, joint, angle_rad);
    }
    return 0;
}

static int run_pose(app *a)
{
    grobo_posture target;
    const char *first = a->line.argument[0];
    int n = a->line.n_arguments, status = 0;
    grobo_posture_init(&target, app_model(a)->n_joints);
    if (first[0] == '@' && n == 1) {
        status = pose_of_file(a, first + 1, &target);
    } else if (n == app_model(a)->n_joints && !strchr(first, '=')) {
        status = pose_of_motors(a, &target);
    } else if (all_numbers(a)) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "pose takes %d angles, in the order of the motors, not %d",
                        app_model(a)->n_joints, n);
    } else {
        for (int i = 0; i < n && !status; i++) {
            status = pose_of_joint(a, a->line.argument[i], &target);
        }
    }
    if (!status) {
        status = joints_check_limits(a, &target, "pose");
    }
    grobo_posture_set_time_ms(&target, app_number(a, OPT_TIME, MOVE_MS));
    return status ? status : go(a, &target, "pose");
}

const cli_command cmd_pose = {
    .name = "pose",
    COMMAND_ARGUMENTS("DEG... | JOINT=DEG... | @FILE[:N]", 1, -1, CLI_ARG_JOINT),
    .summary = "move many joints at once",
    .details =
        "Moves all joints (an angle each in the order of the motors, as a line of a .m file\n"
        "has them), those named, or to posture N of a motion file (the first). All\n"
        "start and arrive together. An angle outside a joint's limits is refused with\n"
        "exit status 4, and nothing moves. Linear joints and grippers with a range are given\n"
        "in mm and percent, as 'grctl joints' lists them.\n",
    .example = "  grctl pose R_ELBOW_P=-45 L_ELBOW_P=45\n"
               "  grctl pose --time 3000 @motions/greet.pseq:2\n",
    COMMAND_OPTIONS(pose_options),
    .run = run_pose,
};

const cli_command cmd_init = {
    .name = "init",
    .arguments = "",
    .summary = "go to the initial posture",
    .details = "Switches torque on where it is off, goes to the initial posture and reads back\n"
               "where the joints are. The first move from an unknown posture is slow.\n",
    .example = "  grctl init\n  grctl init --time 5000\n",
    COMMAND_OPTIONS(init_options),
    .group = CLI_GROUP_EACH,
    .run = run_init,
};

const cli_command cmd_move = {
    .name = "move",
    COMMAND_ARGUMENTS("JOINT DEG [MS]", 2, 3, CLI_ARG_JOINT),
    .summary = "move one joint",
    .details =
        "Moves one joint to an angle, in the time given (1000 ms) or as much longer as the\n"
        "servo needs, and reads back where it is. Torque comes on where it is off. An\n"
        "angle outside the joint's limits is refused with exit status 4. A linear joint is\n"
        "given in mm, a gripper with a range in percent; a unit may stand behind the number\n"
        "(50%, 120mm, -40deg).\n",
    .example = "  grctl move R_KNEE_P -40\n"
               "  grctl move m2 15 500\n"
               "  grctl move gripper 50%\n",
    .run = run_move,
};
