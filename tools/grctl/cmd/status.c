/* SPDX-License-Identifier: MIT */
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/view/render.h"

enum { OPT_WATCH, OPT_INTERVAL };

static const cli_option options[] = {
    [OPT_WATCH] = OPTION_FLAG("watch", 'w', "repeat until a signal"),
    [OPT_INTERVAL] = OPTION_WHOLE("interval", 'i', "MS", 20, 3600000,
                                  "time between two rounds of --watch (1000)"),
};

static void show(conn *c, grobo_joint_mask joints)
{
    const grobo_model *model = conn_model(c);
    if (!c->a->json) {
        if (app_option(c->a, OPT_WATCH)->given) {
            app_print_home(c->a);
        }
        render_status(c, joints);
        output_flush();
        return;
    }
    app_print_json(json_pack("{s:s,s:s,s:o,s:o}", "robot", model->name, "device", conn_device(c),
                             "joints", render_joints_json(c, joints), "link", conn_link_json(c)));
}

/* Why a joint is shown as not set up, and what fixes it: once, not at each round. */
static void say_setups(const conn *c, grobo_joint_mask joints)
{
    const grobo_model *model = conn_model(c);
    conn_setup why;
    for (int j = 0; j < model->n_joints && !app_option(c->a, OPT_WATCH)->given; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) && conn_setup_of(c, j, &why)) {
            app_note(c->a, "motor %d (%s): %s; %s", grobo_model_joint(model, j)->motor,
                     grobo_model_joint(model, j)->name, why.fact, why.fix);
        }
    }
}

/* One round; the exit status: a joint that stays silent is shown, and makes it 1. */
static int sense_and_show(conn *c, grobo_joint_mask joints)
{
    int error = conn_sense(c, joints, GROBO_SENSE_ALL);
    if (error && c->job.failed == 0) {
        return conn_fail(c, error, "status");
    }
    show(c, joints);
    say_setups(c, joints);
    return error ? EXIT_ROBOT : EXIT_DONE;
}

static int watch(conn *c, grobo_joint_mask joints)
{
    int64_t interval_us = (int64_t)app_number(c->a, OPT_INTERVAL, 1000) * 1000;
    int64_t next_us = grobo_now_us();
    int status, slept = GROBO_OK;
    do {
        status = sense_and_show(c, joints);
        next_us += interval_us;
        if (next_us < grobo_now_us()) {
            next_us = grobo_now_us();
        }
    } while (output_flush() && !c->signal && !c->link_error &&
             (slept = conn_sleep_until(c, next_us)) == GROBO_OK);
    return slept < 0 && c->link_error ? conn_fail(c, c->link_error, "status") : status;
}

/* Each robot by itself says what it has when it ends. */
static bool goes_on(const app *a)
{
    return app_option(a, OPT_WATCH)->given > 0;
}

static int run(app *a)
{
    conn c;
    if (a->group) {
        return monitor_group(a, (int64_t)app_number(a, OPT_INTERVAL, 1000) * 1000);
    }
    grobo_joint_mask joints;
    int status = joints_parse_all(a, a->line.n_arguments, a->line.argument, &joints);
    if (status) {
        return status;
    }
    status = conn_open(&c, a);
    if (!status) {
        status = app_option(a, OPT_WATCH)->given ? watch(&c, joints) : sense_and_show(&c, joints);
    }
    return conn_close(&c, status);
}

const cli_command cmd_status = {
    .name = "status",
    COMMAND_ARGUMENTS("[JOINT|GROUP]...", 0, -1, CLI_ARG_JOINT),
    .summary = "print angle, torque, current, temperature, voltage of joints",
    .details = "Reads every joint, or those named, and prints what it reports. A joint that does\n"
               "not answer is shown with the reason and makes the exit status 1; the others are\n"
               "shown all the same. Nothing moves.\n",
    .example = "  grctl status\n  grctl status right_arm --json\n"
               "  grctl status --watch --interval 200\n",
    COMMAND_OPTIONS(options),
    .group = CLI_GROUP_EACH,
    .goes_on = goes_on,
    .run = run,
};
