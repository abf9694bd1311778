/* SPDX-License-Identifier: MIT */
/* stop: the smooth one. */
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"

static int run_stop(app *a)
{
    conn c;
    int status = conn_open(&c, a);
    if (!status) {
        int error = conn_wait_shown(&c, grobo_robot_exit(c.robot, GROBO_EXIT_HOLD), "stop", 0);
        if (error) {
            status = conn_fail(&c, error, "stop");
        } else {
            app_done(a, "stopped; joints with torque hold where they are");
        }
    }
    return conn_close(&c, status);
}

const cli_command cmd_stop = {
    .name = "stop",
    .arguments = "",
    .summary = "stop smoothly and hold",
    .details = "Makes every joint that has torque hold where it is. A motion that another grctl\n"
               "plays is stopped by a signal to it (Ctrl-C): it has the port. A mistake on the\n"
               "command line, a bad configuration and a trace that cannot be written are reported\n"
               "after the stop, and signals wait for it.\n",
    .stops = true,
    .group = CLI_GROUP_EACH,
    .run = run_stop,
};
