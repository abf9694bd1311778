/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/robot_plant.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/fall.h"
#include "tools/grctl/view/render.h"

enum { OPT_LOWER };
static const cli_option options[] = {
    [OPT_LOWER] = OPTION_FLAG("lower", 0, "with off: go to the rest posture of the robot first"),
};

static bool parse_mode(const char *word, grobo_torque *mode)
{
    if (strcmp(word, "on") == 0) {
        *mode = GROBO_TORQUE_ON;
    } else if (strcmp(word, "off") == 0) {
        *mode = GROBO_TORQUE_OFF;
    } else if (strcmp(word, "brake") == 0) {
        *mode = GROBO_TORQUE_BRAKE;
    } else {
        return false;
    }
    return true;
}

static void print_json(const conn *c, grobo_joint_mask joints)
{
    json_t *list = json_array();
    const grobo_model *model = conn_model(c);
    for (int j = 0; j < model->n_joints; j++) {
        grobo_joint_info i;
        if (!(joints & GROBO_JOINT_BIT(j)) || grobo_robot_joint(c->robot, j, &i) < 0) {
            continue;
        }
        json_array_append_new(list, json_pack("{s:i,s:i,s:s,s:s}", "joint", j, "motor",
                                              grobo_model_joint(model, j)->motor, "name",
                                              grobo_model_joint(model, j)->name, "torque",
                                              render_torque(&i)));
    }
    app_print_json(json_pack("{s:o}", "joints", list));
}

/* An arm that fell swings on when its torque comes on, and is read until it rests: the next program
 * would find it moved by nobody it knows. */
#define TURNS_DPS 8
#define RESTS_DEG 0.5
#define LOOKS_AGAIN_US 80000
#define LOOKS_UNTIL_US 1500000

/* Where one turns, or has left where it was read before; those places are kept in `before`. */
static bool swings(const conn *c, grobo_joint_mask joints, double before[GROBO_JOINTS_MAX])
{
    bool any = false;
    for (int j = 0; j < conn_model(c)->n_joints; j++) {
        grobo_joint_info i;
        if (!(joints & GROBO_JOINT_BIT(j)) || grobo_robot_joint(c->robot, j, &i) < 0 ||
            !(i.state.valid & GROBO_FIELD_SPEED)) {
            continue;
        }
        double here_deg = grobo_deg_from_rad(i.state.angle_rad);
        any = any || abs(i.state.speed_dps) >= TURNS_DPS ||
              fabs(here_deg - before[j]) > RESTS_DEG; /* not of NAN: it was not read before */
        before[j] = here_deg;
    }
    return any;
}

/* The first look is at what was read to see the torque. A lost reading is another look. */
static int await_rest(conn *c, grobo_joint_mask joints)
{
    int64_t by_us = grobo_now_us() + LOOKS_UNTIL_US;
    double before[GROBO_JOINTS_MAX];
    int error = GROBO_OK;
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        before[j] = NAN;
    }
    while (!error && swings(c, joints, before) && grobo_now_us() < by_us) {
        error = conn_sleep_until(c, grobo_now_us() + LOOKS_AGAIN_US);
        error = error ? error : conn_sense(c, joints, GROBO_SENSE_FULL);
        error = conn_is_of_reply(error) ? GROBO_OK : error;
    }
    return error;
}

static int switch_torque(conn *c, grobo_joint_mask joints, grobo_torque mode, const char *word)
{
    if (mode == GROBO_TORQUE_ON) {
        c->moving = true;
    }
    int error = conn_wait_shown(c, grobo_robot_torque(c->robot, joints, mode), "servo", 0);
    if (error == GROBO_ERR_UNSUPPORTED && mode == GROBO_TORQUE_BRAKE) {
        return app_fail(c->a, EXIT_SAFETY, grobo_error_name(error),
                        "servo: the servos of %s have no brake; on holds, off releases",
                        grobo_robot_driver(c->robot)->model->name);
    }
    if (!error && mode == GROBO_TORQUE_ON) {
        error = await_rest(c, joints);
    }
    if (error) {
        return conn_fail(c, error, "servo");
    }
    int n = grobo_joints_count(joints);
    if (c->a->json) {
        print_json(c, joints);
    } else {
        app_note(c->a, "torque of %d joint%s is %s", n, n == 1 ? "" : "s", word);
    }
    return EXIT_DONE;
}

/* To the rest posture of the robot's file, softly. */
static int lower(conn *c, grobo_joint_mask joints)
{
    const grobo_driver *driver = grobo_robot_driver(c->robot);
    grobo_posture target;
    if (driver->rest_rad == NULL) {
        return app_fail(c->a, EXIT_SAFETY, "UNSUPPORTED",
                        "servo: the file of %s has no rest posture to lower it to; add one, or "
                        "move it down first",
                        driver->model->name);
    }
    (void)grobo_posture_init(&target, driver->model->n_joints);
    for (int j = 0; j < target.n_joints; j++) {
        target.angle_rad[j] = driver->rest_rad[j];
    }
    target.set = joints;
    c->moving = true;
    int error = conn_wait_shown(c, grobo_robot_move(c->robot, &target), "servo", 0);
    return error ? conn_fail(c, error, "servo") : EXIT_DONE;
}

/* It reads first: a joint that does not answer is left out, and torque off reports it. */
static int warn_of_fall(conn *c, grobo_joint_mask joints)
{
    if (grobo_robot_def_has_weight(robot_of(c->a))) {
        (void)conn_sense(c, GROBO_JOINTS_ALL(conn_model(c)->n_joints), GROBO_SENSE_FULL);
    }
    return fall_ask(c, joints, "servo");
}

static int run(app *a)
{
    conn c;
    grobo_joint_mask joints;
    grobo_torque mode;
    const char *word = a->line.argument[0];
    if (!parse_mode(word, &mode)) {
        return app_fail(a, EXIT_USAGE, "ARG", "servo: '%s' is not one of on, off, brake", word);
    }
    int status = joints_parse_all(a, a->line.n_arguments - 1, a->line.argument + 1, &joints);
    if (status) {
        return status;
    }
    bool lowers = app_option(a, OPT_LOWER)->given;
    if (lowers && mode != GROBO_TORQUE_OFF) {
        return app_fail(a, EXIT_USAGE, "ARG", "servo: --lower goes with off");
    }
    status = mode == GROBO_TORQUE_ON || lowers ? conn_open_to_move(&c, a) : conn_open(&c, a);
    if (!status && lowers) {
        status = lower(&c, joints);
    }
    if (!status && mode == GROBO_TORQUE_OFF) {
        status = warn_of_fall(&c, joints);
    }
    if (!status) {
        status = switch_torque(&c, joints, mode, word);
    }
    return conn_close(&c, status);
}

const cli_command cmd_servo = {
    .name = "servo",
    .heading = "Move",
    COMMAND_ARGUMENTS("on|off|brake [JOINT|GROUP]...", 1, -1, CLI_ARG_JOINT),
    .summary = "switch torque",
    .details =
        "Switches the torque of all joints, or of those named, and reads it back. Before\n"
        "torque comes on, each joint's target is set to where the joint is: nothing jumps.\n"
        "Hold the robot when you switch it off: it falls. Where its file has masses, the joints\n"
        "that drop are named, and a terminal asks once (--yes: it does not).\n",
    .example = "  grctl servo on\n  grctl servo off right_arm\n  grctl servo brake legs\n"
               "  grctl servo off --lower\n",
    .group = CLI_GROUP_EACH,
    COMMAND_OPTIONS(options),
    .run = run,
};
