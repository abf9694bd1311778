/* SPDX-License-Identifier: MIT */
#include "tools/grctl/web/web.h"

int web_run(app *a, const web_options *options)
{
    (void)options;
    return app_fail(a, EXIT_ROBOT, "UNSUPPORTED",
                    "serve: this grctl was built without evhttp (libevent_extra)");
}
