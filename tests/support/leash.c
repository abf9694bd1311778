/* SPDX-License-Identifier: MIT */
#include <signal.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/leash.h"
#include "tests/support/test.h"

/* Descriptors of the test: its robot's line would stay open. */
enum { DESCRIPTORS = 1024 };

static void watch(int end, int group)
{
    char byte;
    ssize_t got;

    (void)setsid(); /* who ends the group of the test leaves this one */
    for (int fd = 0; fd < DESCRIPTORS; fd++) {
        if (fd != end) {
            (void)close(fd);
        }
    }
    got = read(end, &byte, 1);
    if (got == 0) {
        (void)kill(-group, SIGKILL);
    }
    _exit(0);
}

void leash_put(leash *l, int group)
{
    int ends[2];

    assert_int_equal(pipe(ends), 0);
    l->watcher = fork();
    assert_true(l->watcher >= 0);
    if (l->watcher == 0) {
        watch(ends[0], group);
    }
    (void)close(ends[0]);
    l->end = ends[1];
}

void leash_take(leash *l)
{
    if (l->end < 0) {
        return;
    }
    assert_int_equal(write(l->end, "", 1), 1);
    (void)close(l->end);
    (void)waitpid(l->watcher, NULL, 0);
    l->end = -1;
}
