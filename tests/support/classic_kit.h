/* SPDX-License-Identifier: MIT */
/*
 * Statements of the classic shelf beside the original library: what leaves here and what is
 * returned is compared with what the original sends and returns for the statement in C++.
 * classic_original.h has that, as it was measured; tests/export/classic.sh measures it again where
 * the original's sources are (GROBO_ORIGINAL). Where the two differ, the table of a test says what
 * leaves here instead, and why.
 */
#ifndef GROBO_TESTS_CLASSIC_KIT_H
#define GROBO_TESTS_CLASSIC_KIT_H

#include <grobo/classic/classic.h>

#include "tests/support/folder.h"
#include "tests/support/frame_words.h"
#include "tests/support/test.h"

/* A row of a test's table. */
typedef struct statement {
    const char *name; /* begins with the row of docs/seed-map.md */
    void (*run)(void);
    const char *cxx;  /* the statement of the original */
    const char *ours; /* what it is here; NULL: the same as there; "torque": from there on */
    const char *why;  /* it differs */
} statement;

/* What statements are about: a robot, two postures of 100 ms, an empty motion. */
extern GR001 *g;
extern RobotPosture *p, *q;
extern RobotMotion *m;

/* The files of the statements, in the folder of folder.h. */
void classic_make_files(void);
void classic_remove_files(void);

/* Postures and motion for the next statement. */
void classic_begin(void);

/* Runs a statement, and compares. */
void classic_judge(const statement *row);

/* The program: `--cxx` prints its statements in C++, `--original` what was measured of them,
 * `--files FOLDER` makes the files; otherwise its tests. */
int classic_main(int argc, char **argv, const statement *statements, size_t n);

/* What statements say. */
void say(double value);
void say_file(const char *path);
void say_posture(const RobotPosture *posture);
void say_motion(const RobotMotion *motion);

#endif
