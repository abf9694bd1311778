/* SPDX-License-Identifier: MIT */
/* How long the command ($GRCTL) takes from its start to its end when there is nothing to do. */
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <grobo/port.h>

enum { RUNS = 100, ALLOWED_US = 5000 };

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

int main(void)
{
    const char *command = getenv("GRCTL");
    int64_t took_us[RUNS];
    posix_spawn_file_actions_t files;
    if (!command || posix_spawn_file_actions_init(&files) != 0 ||
        posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0) != 0) {
        fputs("start: no command in $GRCTL\n", stderr);
        return 1;
    }
    for (int i = 0; i < RUNS; i++) {
        took_us[i] = run_once(command, &files);
        if (took_us[i] < 0) {
            fputs("start: the command failed\n", stderr);
            return 1;
        }
    }
    posix_spawn_file_actions_destroy(&files);
    qsort(took_us, RUNS, sizeof took_us[0], compare);
    printf("start: %.2f ms at best, half of %d runs below %.2f ms (%.0f ms allowed at best)%s\n",
           (double)took_us[0] / 1e3, RUNS, (double)took_us[RUNS / 2] / 1e3, ALLOWED_US / 1e3,
           took_us[0] <= ALLOWED_US ? "" : "  TOO SLOW");
    return took_us[0] <= ALLOWED_US ? 0 : 1;
}
