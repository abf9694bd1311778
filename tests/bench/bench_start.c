/* SPDX-License-Identifier: MIT */
/* How long the command ($GRCTL) takes from its start to its end when there is nothing to do, beside
 * a program that does nothing; and where there is a simulated robot to look at, beside its wire. */
#include <fcntl.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <grobo/core/port.h>
#include <grobo/core/robot.h>
#include <grobo/core/static.h>

#include "tests/bench/bench.h"

enum { RUNS = 100, STATUS_RUNS = 15 };

extern char **environ;

static int compare(const void *a, const void *b)
{
    int64_t left = *(const int64_t *)a, right = *(const int64_t *)b;
    return left < right ? -1 : left > right;
}

/* Microseconds from spawning to the end, or -1. */
static int64_t run_once(const char *const *argv, const posix_spawn_file_actions_t *files)
{
    int64_t begun_us = grobo_now_us();
    int status = -1;
    pid_t pid;
    if (posix_spawn(&pid, argv[0], files, NULL, (char *const *)argv, environ) != 0 ||
        waitpid(pid, &status, 0) != pid || status != 0) {
        return -1;
    }
    return grobo_now_us() - begun_us;
}

static bool measure(const char *what, int runs, const char *who, const char *const *argv)
{
    char measure[64];
    int64_t took_us[RUNS];
    posix_spawn_file_actions_t files;

    if (posix_spawn_file_actions_init(&files) != 0 ||
        posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0) != 0) {
        return false;
    }
    for (int i = 0; i < runs; i++) {
        took_us[i] = run_once(argv, &files);
        if (took_us[i] < 0) {
            fprintf(stderr, "bench_start: %s failed\n", argv[0]);
            return false;
        }
    }
    posix_spawn_file_actions_destroy(&files);
    qsort(took_us, (size_t)runs, sizeof took_us[0], compare);
    (void)snprintf(measure, sizeof measure, "%s, median, ms", what);
    bench_row("S14", measure, who, (double)took_us[runs / 2] / 1e3);
    (void)snprintf(measure, sizeof measure, "%s, p99, ms", what);
    bench_row("S14", measure, who, (double)took_us[runs * 99 / 100] / 1e3);
    return true;
}

/* What a wire at 115200 bps takes to read all joints. */
static double wire_ms(void)
{
    static grobo_robot robot;
    grobo_budget budget = {0};

    (void)grobo_robot_init(&robot, grobo_gr001_driver(GROBO_WIRING_BOARD), NULL, NULL, 0);
    (void)grobo_robot_budget(&robot, &budget);
    return 20 * (double)budget.reading_us / 1e3;
}

int main(void)
{
    const char *command = getenv("GRCTL");

    if (command == NULL) {
        fputs("bench_start: no command in $GRCTL\n", stderr);
        return 1;
    }
    static const char version[] = "start of grctl version", status[] = "grctl -d sim status";
    const char *const ours[] = {command, "version", NULL};
    const char *const nothing[] = {"/bin/true", NULL};
    const char *const looks[] = {command, "-d", "sim", "status", NULL};
    bool good = measure(version, RUNS, "grobo", ours) &&
                measure(version, RUNS, "floor true", nothing) &&
                measure(status, STATUS_RUNS, "grobo", looks);

    bench_row("S14", "grctl -d sim status, median, ms", "floor wire", wire_ms());
    return good ? 0 : 1;
}
