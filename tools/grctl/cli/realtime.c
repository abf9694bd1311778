/* SPDX-License-Identifier: MIT */
/* Each part is asked of the system by itself, so that the one it refuses can be named. */
#include <stdint.h>
#include <stdlib.h>

#include <grobo/core/port.h>

#include "tools/grctl/cli/realtime.h"
#include "tools/grctl/lang/lang.h"

enum { PRIORITY_MAX = 99, CPUS = 64 };

/* A number without a sign or a blank; false: none, or beyond `most`. */
static bool take_number(const char **at, long most, long *number)
{
    char *end;

    if (**at < '0' || **at > '9') {
        return false;
    }
    *number = strtol(*at, &end, 10);
    *at = end;
    return *number <= most;
}

/* "50", "50@3", "50@2,3". */
static bool read_wish(const char *text, grobo_realtime *wish)
{
    long number;

    *wish = (grobo_realtime){.policy = GROBO_REALTIME_FIFO, .mlock = true};
    if (!take_number(&text, PRIORITY_MAX, &number) || number < 1) {
        return false;
    }
    wish->priority = (int)number;
    for (char before = '@'; *text == before; before = ',') {
        text++;
        if (!take_number(&text, CPUS - 1, &number)) {
            return false;
        }
        wish->cpus |= UINT64_C(1) << number;
    }
    return *text == '\0';
}

int realtime_begin(app *a, int option)
{
    const cli_value *v = app_option(a, option);
    grobo_realtime wish;
    int error;

    if (!v->given) {
        return 0;
    }
    if (!read_wish(v->text, &wish)) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "--realtime %s: wanted is a priority of 1 to 99, and where it shall run "
                        "CPUs of 0 to 63, such as 50 or 50@3",
                        v->text);
    }
    error = grobo_thread_realtime(&(grobo_realtime){.mlock = true});
    if (error < 0) {
        /* It matters where memory is short; the priority matters always. */
        app_note(a, "--realtime: memory is not locked, 'ulimit -l' must be unlimited: %s",
                 _(grobo_error_text(error)));
    }
    error = grobo_thread_realtime(&(grobo_realtime){.cpus = wish.cpus});
    if (error < 0) {
        return app_fail_error(a, EXIT_ROBOT, error, "--realtime %s: not on that CPU", v->text);
    }
    wish = (grobo_realtime){.policy = wish.policy, .priority = wish.priority};
    error = grobo_thread_realtime(&wish);
    if (error < 0) {
        return app_fail_error(a, EXIT_ROBOT, error,
                              "--realtime: no priority %d ('ulimit -r' must be %d or more: "
                              "docs/guide/realtime.md)",
                              wish.priority, wish.priority);
    }
    return 0;
}
