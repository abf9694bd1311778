/* SPDX-License-Identifier: MIT */
/* A folder for a test's files, among the temporary ones. */
#ifndef GROBO_TESTS_FOLDER_H
#define GROBO_TESTS_FOLDER_H

#include <stddef.h>

/* The one that folder_set_up() made last. */
extern char folder[256];

/* A set-up: a new folder. */
int folder_set_up(void);

/* The path of a name in it; good until four others were asked for. */
const char *in_folder(const char *name);

/* Removes these files where they are there, and the folder; fails the test if more was left. */
void folder_remove(const char *const *names, size_t n);

#endif
