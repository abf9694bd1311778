/* SPDX-License-Identifier: MIT */
/* slot and scenario: what the board has in its own memory. */
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"

static int start(app *a, grobo_stored_kind kind, const char *what)
{
    conn c;
    double number;
    const char *text = a->line.argument[0];
    int status, error;
    if (!cli_read_number(text, &number) || number < 0 || number > 255 ||
        number != (double)(int)number)
        return app_fail(a, EXIT_USAGE, "ARG", "%s: '%s' is not a number from 0 to 255", what, text);
    status = conn_open_to_move(&c, a);
    if (!status) {
        error =
            conn_wait(&c, grobo_robot_stored(grobo_session_robot(c.session), kind, (int)number));
        if (error)
            status = conn_fail(&c, error, what);
        else if (a->json)
            app_print_json(json_pack("{s:i}", what, (int)number));
        else
            app_note(a, "%s %d was asked for; the board does not say whether it plays", what,
                     (int)number);
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
    .arguments = "N",
    .summary = "play a motion stored in the board",
    .details = "Asks the board to play motion N of its own memory. Its angles are the board's:\n"
               "nothing here can check them, and the board sends no answer.\n",
    .min_arguments = 1,
    .max_arguments = 1,
    .argument = CLI_ARG_WORD,
    .run = run_slot,
};

const cli_command cmd_scenario = {
    .name = "scenario",
    .arguments = "N",
    .summary = "play a scenario stored in the board",
    .details = "Asks the board to play scenario N of its own memory, a sequence of motions. Its\n"
               "angles are the board's: nothing here can check them, and the board sends no\n"
               "answer.\n",
    .min_arguments = 1,
    .max_arguments = 1,
    .argument = CLI_ARG_WORD,
    .run = run_scenario,
};
