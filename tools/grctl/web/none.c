/* SPDX-License-Identifier: MIT */
#include "tools/grctl/web/web.h"

static int is_missing(app *a)
{
    return app_fail(a, EXIT_ROBOT, "UNSUPPORTED",
                    "serve: this grctl was built without evhttp (libevent_extra)");
}

int web_run(app *a, const web_options *options)
{
    (void)options;
    return is_missing(a);
}

int web_run_fleet(app *a, const web_options *options, const broker *b, const char *group)
{
    (void)options;
    (void)b;
    (void)group;
    return is_missing(a);
}
