/* SPDX-License-Identifier: MIT */
/* Questions to a person at a terminal, while no line is open. With --yes nobody is asked: answers
 * are lines of standard input, unless that is a terminal, which is not read. */
#ifndef GRCTL_ASK_H
#define GRCTL_ASK_H

#include "tools/grctl/cli/app.h"

enum { ASK_BYTES = 256 };

/* True: there is a person, or --yes. Else says in one line what to run instead. */
bool ask_can(app *a, const char *instead, int *status);

/*
 * Asks, and looks the question up in the person's language; an empty line, the end of standard
 * input, and --yes at a terminal, is the answer that stands in the brackets. A person who ends the
 * input (Ctrl-D) means to end it all: false; so does Ctrl-C and its like, and nothing is asked any
 * more.
 */
bool ask_line(const app *a, const char *question, const char *usual, char *answer);

/* The signal that ended a question; 0: none. */
int ask_signal(void);

/* Whether the answer is yes; no by itself. The question as in ask_line(). */
bool ask_yes(const app *a, const char *question);

#endif
