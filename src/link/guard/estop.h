/* SPDX-License-Identifier: MIT */
/* What a session knows of the marks of its device: estop.c. */
#ifndef GROBO_LINK_ESTOP_I_H
#define GROBO_LINK_ESTOP_I_H

#include <grobo/estop.h>

#include "ports/common/notes.h"

/* What the names of marks begin with, among those of notes. */
#define GROBO_I_ESTOP_MARK "estop-"

/* Marks that may stand at a time, each with an id of its own. */
enum { ESTOP_HEARD = DEVICE_NAMES * NOTE_FOLDERS };

typedef struct grobo_i_estop_watch {
    bool on;
    bool armed; /* the marks that stood at the beginning have been looked at */
    grobo_i_device_names names;
    char heard[ESTOP_HEARD][sizeof((grobo_estop *)0)->id]; /* marks that stand and were obeyed */
    int n_heard;
    int64_t looked_us;
    grobo_estop_answer say; /* to be written, GROBO_ESTOP_NOBODY: nothing */
    int result;             /* of GROBO_ESTOP_FAILED */
} grobo_i_estop_watch;

/* Registers this process as the one that has the device; it answers for it from now on. */
void grobo_i_estop_watch_begin(grobo_i_estop_watch *watch, const char *device);

/* The same process has it no more. Fine where it never had. */
void grobo_i_estop_watch_end(grobo_i_estop_watch *watch);

/*
 * Looks for marks that have not been heard; they are then. Returns true if there is one.
 * pending: one of them has not reached the robot by any program.
 */
bool grobo_i_estop_watch_look(grobo_i_estop_watch *watch, bool *pending);

/* Changes when another process than the last one is registered for the device; 0: none is. Takes no
 * descriptor. */
uint64_t grobo_i_estop_holder_stamp(const grobo_i_device_names *names);

/* Writes what is to be said. */
void grobo_i_estop_watch_answer(grobo_i_estop_watch *watch);

/* Clears the marks of its device that it has heard. GROBO_ERR_STATE where one stands that it has
 * not: it was set since the last look, and is to be obeyed. */
int grobo_i_estop_watch_clear(grobo_i_estop_watch *watch, grobo_os_cause *cause);

#endif
