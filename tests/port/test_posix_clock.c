/* SPDX-License-Identifier: MIT */
/*
 * The clock of the POSIX port and a machine that sleeps: in a time namespace of Linux, where the
 * time since boot has a day more than that which the machine was awake.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include <grobo/core/port.h>

#include "tests/support/test.h"

enum { NOT_KNOWN = 2, STOOD = 99, APART_S = 60 };

static const char *program;

/* Of this process: 0 where the clock counts the time that the machine slept. */
static int counts_sleep(void)
{
    FILE *uptime = fopen("/proc/uptime", "re");
    double up_s = -1;
    int n = uptime != NULL ? fscanf(uptime, "%lf", &up_s) : 0;

    if (uptime != NULL) {
        (void)fclose(uptime);
    }
    if (n != 1) {
        return NOT_KNOWN;
    }
    double apart_s = (double)grobo_now_us() / 1e6 - up_s;

    return apart_s > -APART_S && apart_s < APART_S ? 0 : STOOD;
}

TEST(the_clock_goes_on_while_the_machine_sleeps)
{
    char line[1024];

    int n = snprintf(line, sizeof line,
                     "u=-T; unshare -T true 2>/dev/null || u=-rT; unshare $u true 2>/dev/null || "
                     "exit %d; exec unshare $u --boottime 86400 '%s' sleeps",
                     NOT_KNOWN, program);
    assert_in_range(n, 1, sizeof line - 1);
    int status = system(line);
    assert_true(WIFEXITED(status));
    assert_int_not_equal(WEXITSTATUS(status), STOOD);
    if (WEXITSTATUS(status) != 0) { /* nor may an emulator's program be started so */
        print_message("no time namespaces here\n");
        skip();
    }
}

/* A condition sleeps by a clock of its own. */
TEST(a_condition_wakes_in_time)
{
    grobo_mutex mutex;
    grobo_cond cond;
    int64_t start_us = grobo_now_us();

    assert_int_equal(grobo_mutex_init(&mutex), GROBO_OK);
    assert_int_equal(grobo_cond_init(&cond), GROBO_OK);
    grobo_mutex_lock(&mutex);
    while (grobo_now_us() < start_us + 20000) {
        grobo_cond_wait(&cond, &mutex, start_us + 20000);
    }
    grobo_mutex_unlock(&mutex);
    assert_true(grobo_now_us() - start_us < 10000000);
    grobo_cond_deinit(&cond);
    grobo_mutex_deinit(&mutex);
}

int main(int argc, char **argv)
{
    program = argv[0];
    if (argc == 2 && strcmp(argv[1], "sleeps") == 0) {
        int status = counts_sleep();

        if (status == 0) {
            a_condition_wakes_in_time();
        }
        return status;
    }
    return test_main(argc, argv);
}
