/* SPDX-License-Identifier: MIT */
/* `grctl serve`: which page is served of what. */
#include "tools/grctl/cli/realtime.h"
#include "tools/grctl/fleet/message.h"
#include "tools/grctl/web/run.h"
#include "tools/grctl/web/web.h"

static int run_fleet(app *a, const web_options *o)
{
    static broker b;
    const cli_value *group = app_option(a, SERVE_GROUP);
    if (a->line.n_arguments) {
        return app_fail(a, EXIT_USAGE, "ARG", "serve --broker: motions are not of a fleet");
    }
    if (group->given && !fleet_is_name(group->text)) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "serve: letters, digits, _ and - in the name of a group");
    }
    int status = broker_read(&b, a);
    return status ? status : web_run_fleet(a, o, &b, group->given ? group->text : FLEET_ALL);
}

int serve_run(app *a)
{
    web_options o = {.folder = a->line.n_arguments ? a->line.argument[0] : ".",
                     .listen = app_option(a, SERVE_LISTEN)->text,
                     .name = app_option(a, SERVE_NAME)->text,
                     .imu = app_option(a, SERVE_IMU)->text,
                     .port = (uint16_t)app_number(a, SERVE_PORT, WEB_PORT),
                     .takes_over = app_option(a, SERVE_OPERATOR)->given > 0};
    int status = realtime_begin(a, SERVE_REALTIME);
    if (status) {
        return status;
    }
    return app_option(a, BROKER_URL)->given ? run_fleet(a, &o) : web_run(a, &o);
}
