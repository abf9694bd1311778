/* SPDX-License-Identifier: MIT */
/* What a test starts does not outlive it, see support/leash.h. */
#include <signal.h>
#include <stdbool.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/leash.h"
#include "tests/support/test.h"

/* The end of a pipe that all processes of a test have, but the one that reads it here. */
typedef struct family {
    pid_t test, child;
    int all;
} family;

/* A child in a group of its own, which is stopped; returns when it is. */
static pid_t start_child(bool stopped)
{
    int status;
    pid_t child = fork();

    if (child == 0) {
        (void)setpgid(0, 0);
        (void)raise(SIGSTOP);
        for (;;) {
            pause();
        }
    }
    if (waitpid(child, &status, WUNTRACED) != child) {
        _exit(1);
    }
    if (!stopped) {
        (void)kill(child, SIGCONT);
    }
    return child;
}

/* A test with a child that says when both are there, and waits for its death. */
static void start_family(family *f, bool stopped)
{
    int all[2];

    assert_int_equal(pipe(all), 0);
    f->test = fork();
    assert_true(f->test >= 0);
    if (f->test == 0) {
        leash l;
        pid_t child;

        (void)close(all[0]);
        child = start_child(stopped);
        leash_put(&l, child);
        if (write(all[1], &child, sizeof child) != (ssize_t)sizeof child) {
            _exit(1);
        }
        for (;;) {
            pause();
        }
    }
    (void)close(all[1]);
    f->all = all[0];
    assert_int_equal(read(f->all, &f->child, sizeof f->child), sizeof f->child);
}

TEST(a_child_goes_with_its_test)
{
    char byte;

    for (int stopped = 0; stopped < 2; stopped++) {
        family f;

        start_family(&f, stopped);
        assert_int_equal(kill(f.child, 0), 0);
        assert_int_equal(kill(f.test, SIGKILL), 0);
        assert_int_equal(waitpid(f.test, NULL, 0), f.test);
        assert_int_equal(read(f.all, &byte, 1), 0); /* until nobody has it any more */
        (void)close(f.all);
    }
}

TEST(a_leash_that_is_taken_ends_nothing)
{
    pid_t child = start_child(false);
    leash l;
    int status;

    leash_put(&l, child);
    leash_take(&l);
    leash_take(&l);
    assert_int_equal(waitpid(child, &status, WNOHANG), 0);
    assert_int_equal(kill(child, SIGTERM), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(WTERMSIG(status), SIGTERM);
}
