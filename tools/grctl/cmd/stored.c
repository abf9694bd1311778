/* SPDX-License-Identifier: MIT */
/* slot and scenario: what the board has in its own memory. */
#include <grobo/core/robot.h>

#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"

static int start(app *a, grobo_stored_kind kind, const char *what)
{
    conn c;
    double number;
    const char *text = a->line.argument[0];
    int error;
    if (!cli_read_number(text, &number) || number < 0 || number > 255 ||
        number != (double)(int)number) {
        return app_fail(a, EXIT_USAGE, "ARG", "%s: '%s' is not a number from 0 to 255", what, text);
    }
    if (!app_driver(a)->stored) {
        return app_fail(a, EXIT_USAGE, grobo_error_name(GROBO_ERR_UNSUPPORTED),
                        "%s: %s has no board here that keeps motions; 'grctl play' plays files",
                        what, app_model(a)->name);
    }
    int status = conn_open_to_move(&c, a);
    if (!status) {
        error = conn_wait(&c, grobo_robot_stored(c.robot, kind, (int)number));
        if (error) {
            status = conn_fail(&c, error, what);
        } else {
            app_report(a, json_pack("{s:i}", what, (int)number),
                       "%s %d was asked for; the board does not say whether it plays", what,
                       (int)number);
        }
    }
    return conn_close(&c, status);
}

static int run_slot(app *a)
{
    return start(a, GROBO_STORED_SLOT, "slot");
}

static int run_scenario(app *a)
{
    return start(a, GROBO_STORED_SCENARIO, "scenario");
}

const cli_command cmd_slot = {
    .name = "slot",
    .lines = CLI_LINES_ONE,
    COMMAND_ARGUMENTS("N", 1, 1, CLI_ARG_WORD),
    .summary = "play a motion stored in the board",
    .details = "Asks the board to play motion N of its own memory. Its angles are the board's:\n"
               "nothing here can check them, and the board sends no answer.\n",
    .run = run_slot,
};

const cli_command cmd_scenario = {
    .name = "scenario",
    .lines = CLI_LINES_ONE,
    COMMAND_ARGUMENTS("N", 1, 1, CLI_ARG_WORD),
    .summary = "play a scenario stored in the board",
    .details = "Asks the board to play scenario N of its own memory, a sequence of motions. Its\n"
               "angles are the board's: nothing here can check them, and the board sends no\n"
               "answer.\n",
    .run = run_scenario,
};
