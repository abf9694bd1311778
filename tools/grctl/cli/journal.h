/* SPDX-License-Identifier: MIT */
/*
 * Postures of a recording, on disk as they come: a motion beside the file that they will be in,
 * PATH.part.m, which is gone when that is written. Whatever ends the program, or the machine, each
 * posture that the disk has is whole.
 */
#ifndef GRCTL_JOURNAL_H
#define GRCTL_JOURNAL_H

#include <stdbool.h>
#include <stdio.h>

#include <grobo/core/motion_io.h>
#include <grobo/files.h>

#include "tools/grctl/cli/heap.h"

typedef struct journal {
    char path[GROBO_PATH_MAX_BYTES];
    bool left; /* another recording has left one of the same target: this one has the next name */
    /* private */
    FILE *file;
    heap begins; /* where each posture begins, a long each */
    long size;
} journal;

/*
 * Begins one for a recording to the file target. What another recording has left there stays.
 * Returns 0 or errno; there is none then, which all functions below take for one.
 */
int journal_begin(journal *j, const char *target);
/* Returns 0 or errno: what is there stays, and nothing more comes to it. */
int journal_add(journal *j, const grobo_posture *posture, const grobo_model *model);
void journal_drop_last(journal *j);
/* How many postures it has. */
size_t journal_size(const journal *j);
/* Ends it. keeps: the file stays, and the disk has it. */
void journal_end(journal *j, bool keeps);

#endif
