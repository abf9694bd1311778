/* SPDX-License-Identifier: MIT */
/* How a program of this command begins: grctl, and those beside it. */
#ifndef GRCTL_START_H
#define GRCTL_START_H

#include "tools/grctl/cli/cli.h"

typedef struct start_program {
    const cli_command *const *commands;
    size_t n_commands;
    const char *word; /* alone on the line it is another program's main, or NULL */
    int (*run_word)(void);
} start_program;

/* The words this process was called with, ending with NULL, from the beginning of main() on. */
extern char *const *start_words;

/* All of main(): the exit status. */
int start(int argc, char **argv, const start_program *program);

#endif
