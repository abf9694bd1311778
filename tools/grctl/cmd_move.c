/* SPDX-License-Identifier: MIT */
/* init and move: one posture, reached safely and read back. */
#include <string.h>

#include "commands.h"
#include "joints.h"
#include "render.h"

enum { OPT_INIT_TIME };
enum { MOVE_MS = 1000, INIT_MS = 2000, LONGEST_MS = 163830 };

static const cli_option init_options[] = {
    [OPT_INIT_TIME] = {.name = "time",
                       .letter = 't',
                       .kind = CLI_NUMBER,
                       .value = "MS",
                       .help = "time to get there; more where that is safer (2000)",
                       .min = 0,
                       .max = LONGEST_MS},
};

static void report(const conn *c, const grobo_posture *target)
{
    int64_t now_us = grobo_now_us();
    int joint;
    double worst = render_worst_error(c, now_us, &joint);
    if (c->a->json) {
        json_t *list = json_array();
        for (int j = 0; j < target->n_joints; j++)
            if (target->set & GROBO_JOINT_BIT(j))
                json_array_append_new(list, render_joint_json(c, j, now_us));
        app_print_json(json_pack("{s:o,s:o}", "joints", list, "max_error_deg",
                                 joint < 0 ? json_null() : app_json_number(worst, 2)));
    } else if (joint >= 0) {
        app_note(c->a, "there; largest error %.1f deg (%s)", worst,
                 grobo_robot_driver(c->robot)->model->joints[joint].name);
    }
}

static int go(app *a, const grobo_posture *target, const char *doing)
{
    conn c;
    int status = conn_open(&c, a);
    if (!status) {
        int error;
        c.moving = true;
        error = conn_wait(&c, grobo_session_move(c.session, target));
        if (error)
            status = conn_fail(&c, error, doing);
        else
            report(&c, target);
    }
    return conn_close(&c, status);
}

static int run_init(app *a)
{
    grobo_posture target;
    grobo_posture_init_pose(&target, &grobo_gr001_model);
    grobo_posture_set_time_ms(&target, app_number(a, OPT_INIT_TIME, INIT_MS));
    return go(a, &target, "init");
}

static int run_move(app *a)
{
    const char *name = a->line.argument[0];
    const char *angle = a->line.argument[1];
    const char *time = a->line.n_arguments > 2 ? a->line.argument[2] : NULL;
    grobo_posture target;
    double deg, ms = MOVE_MS;
    int status = 0;
    int joint = joints_parse_one(a, name, strlen(name), &status);
    if (joint < 0)
        return status;
    if (!cli_read_number(angle, &deg))
        return app_fail(a, EXIT_USAGE, "USAGE", "move: '%s' is not an angle in degrees", angle);
    if (time && (!cli_read_number(time, &ms) || ms < 0 || ms > LONGEST_MS))
        return app_fail(a, EXIT_USAGE, "USAGE", "move: '%s' is not a time of 0 to %d ms", time,
                        LONGEST_MS);
    grobo_posture_init(&target, grobo_gr001_model.n_joints);
    grobo_posture_set_deg(&target, joint, deg);
    grobo_posture_set_time_ms(&target, ms);
    status = joints_check_limits(a, &target, "move");
    return status ? status : go(a, &target, "move");
}

const cli_command cmd_init = {
    .name = "init",
    .arguments = "",
    .summary = "go to the initial posture",
    .details = "Switches torque on where it is off, goes to the initial posture and reads back\n"
               "where the joints are. The first move from an unknown posture is slow.\n",
    .example = "  grctl init\n  grctl init --time 5000\n",
    .options = init_options,
    .n_options = sizeof init_options / sizeof init_options[0],
    .run = run_init,
};

const cli_command cmd_move = {
    .name = "move",
    .arguments = "JOINT DEG [MS]",
    .summary = "move one joint",
    .details = "Moves one joint to an angle, in the time given (1000 ms) or as much longer as the\n"
               "servo needs, and reads back where it is. Torque comes on where it is off. An\n"
               "angle outside the joint's limits is refused with exit status 4.\n",
    .example = "  grctl move R_KNEE_P -40\n  grctl move m2 15 500\n",
    .min_arguments = 2,
    .max_arguments = 3,
    .argument = CLI_ARG_JOINT,
    .run = run_move,
};
