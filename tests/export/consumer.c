/* SPDX-License-Identifier: MIT */
/* A stranger's program, C11 and C++11 alike: it knows the installed headers and the library. */
#include <stdio.h>
#include <string.h>

#include <grobo/error.h>
#include <grobo/runner.h>
#include <grobo/version.h>

int main(void)
{
    if (strcmp(grobo_version(), GROBO_VERSION_STRING) != 0 || GROBO_VERSION_NUMBER < 100) {
        fprintf(stderr, "headers are %s, library is %s\n", GROBO_VERSION_STRING, grobo_version());
        return 1;
    }
    grobo_session_config session;
    grobo_runner_config config;
    memset(&session, 0, sizeof session);
    memset(&config, 0, sizeof config);
    session.size = sizeof session;
    session.device = "sim";
    config.size = sizeof config;
    config.session = &session;
    grobo_runner *runner = NULL;
    int result = grobo_runner_new(&config, &runner);
    if (result < 0 || grobo_runner_free(runner) < 0) {
        fprintf(stderr, "no robot: %s\n", grobo_error_text(result));
        return 1;
    }
    puts(grobo_error_text(GROBO_ERR_TIMEOUT));
    return 0;
}
