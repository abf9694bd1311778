/* SPDX-License-Identifier: MIT */
/* A callback that holds its loop for as long as a test wants. */
#ifndef GROBO_TESTS_HOLD_H
#define GROBO_TESTS_HOLD_H

#include <grobo/core/port.h>

typedef struct hold {
    grobo_mutex lock;
    grobo_cond changed;
    bool wanted;
    bool held;
} hold;

void hold_init(hold *h);
void hold_deinit(hold *h);

/* In a callback: blocks between hold_begin() and hold_end(), and only then. */
void hold_here(hold *h);

/* Returns when the callback blocks. */
void hold_begin(hold *h);

/* Lets the callback return. */
void hold_end(hold *h);

#endif
