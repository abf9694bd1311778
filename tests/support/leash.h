/* SPDX-License-Identifier: MIT */
/*
 * Ends the processes that a test started when the test itself is killed: a third process waits for
 * the end of a pipe that only the test holds. Also stopped processes, which could not look.
 */
#ifndef GROBO_TESTS_LEASH_H
#define GROBO_TESTS_LEASH_H

typedef struct leash {
    int end;     /* of the pipe, -1: none */
    int watcher; /* the third process */
} leash;

/* From now on a process group gets SIGKILL when this process ends. */
void leash_put(leash *l, int group);

/* The group has ended, or lives on. Also of a leash that was not put, where end is -1. */
void leash_take(leash *l);

#endif
