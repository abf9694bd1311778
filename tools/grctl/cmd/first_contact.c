/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/bringup/contact.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cmd/commands.h"

enum { OPT_OUT, OPT_COMPARE };

static const cli_option options[] = {
    [OPT_OUT] = OPTION_TEXT("out", 'o', "PREFIX",
                            "prefix of the names of report and traces (first-contact-ROBOT)"),
    [OPT_COMPARE] = OPTION_TEXT("compare", 0, "REPORT.json",
                                "say what differs from another report of this robot"),
};

static int run(app *a)
{
    contact_orders orders = {.joint = -1,
                             .out = app_option(a, OPT_OUT)->text,
                             .other = app_option(a, OPT_COMPARE)->text};
    int status = 0;
    if (a->line.n_arguments > 0) {
        const char *name = a->line.argument[0];
        orders.joint = joints_parse_one(a, name, strlen(name), &status);
        if (orders.joint < 0) {
            return status;
        }
    }
    return contact_run(a, &orders);
}

const cli_command cmd_first_contact = {
    .name = "first-contact",
    .lines = CLI_LINES_ONE,
    COMMAND_ARGUMENTS("[JOINT]", 0, 1, CLI_ARG_JOINT),
    .summary = "test what grctl assumes of a real robot, step by step",
    .details =
        "For the first person who connects a robot of this kind. It first only reads: which\n"
        "servos answer, models and firmware, all registers, how late replies are, whether an\n"
        "adapter echoes, whether GR001's board stores a frame before it forwards it. Then, each\n"
        "step confirmed by you: the torque of JOINT (the last one) comes on, which should not\n"
        "make it jump; it moves by 2 degrees and back; and its servo, limp, is set to another\n"
        "baud rate and back, which shows when a rate takes effect. A joint that was limp is limp\n"
        "again. Ctrl-C waits until the servo is back at its rate; how to find a servo that is\n"
        "lost is printed before.\n"
        "\n"
        "It writes PREFIX.txt and PREFIX.json, with what was found and whether it is as assumed,\n"
        "and a trace of each part; please send them to the authors. The exit status is 1 if\n"
        "something is not as assumed. --compare says, and keeps in the report, what differs from\n"
        "that of another robot of this kind, as of a simulated one: verdicts, models, firmware\n"
        "and the registers that a servo keeps without power. With --yes it does not ask: answers\n"
        "are lines of standard input, or no.\n",
    .example = "  grctl first-contact gripper\n"
               "  grctl -d sim --robot so101 --yes first-contact --compare real.json\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
