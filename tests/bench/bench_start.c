/* SPDX-License-Identifier: MIT */
/* How long the command ($GRCTL) takes from its start to its end when there is nothing to do, beside
 * a program that does nothing. */
#include <fcntl.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <grobo/port.h>

#include "tests/bench/bench.h"

enum { RUNS = 100 };

extern char **environ;

static int compare(const void *a, const void *b)
{
    int64_t left = *(const int64_t *)a, right = *(const int64_t *)b;
    return left < right ? -1 : left > right;
}

/* Microseconds from spawning to the end, or -1. */
static int64_t run_once(const char *command, const posix_spawn_file_actions_t *files)
{
    char *argv[] = {(char *)command, "version", NULL};
    int64_t begun_us = grobo_now_us();
    int status = -1;
    pid_t pid;
    if (posix_spawn(&pid, command, files, NULL, argv, environ) != 0 ||
        waitpid(pid, &status, 0) != pid || status != 0) {
        return -1;
    }
    return grobo_now_us() - begun_us;
}

static bool measure(const char *who, const char *command)
{
    int64_t took_us[RUNS];
    posix_spawn_file_actions_t files;

    if (posix_spawn_file_actions_init(&files) != 0 ||
        posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0) != 0) {
        return false;
    }
    for (int i = 0; i < RUNS; i++) {
        took_us[i] = run_once(command, &files);
        if (took_us[i] < 0) {
            fprintf(stderr, "bench_start: %s failed\n", command);
            return false;
        }
    }
    posix_spawn_file_actions_destroy(&files);
    qsort(took_us, RUNS, sizeof took_us[0], compare);
    bench_row("S14", "start of grctl version, median, ms", who, (double)took_us[RUNS / 2] / 1e3);
    bench_row("S14", "start of grctl version, p99, ms", who,
              (double)took_us[RUNS * 99 / 100] / 1e3);
    return true;
}

int main(void)
{
    const char *command = getenv("GRCTL");

    if (command == NULL) {
        fputs("bench_start: no command in $GRCTL\n", stderr);
        return 1;
    }
    return measure("grobo", command) && measure("floor true", "/bin/true") ? 0 : 1;
}
