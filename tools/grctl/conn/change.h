/* SPDX-License-Identifier: MIT */
/* A register of a servo is changed and kept; after a new baud rate the servo is followed. */
#ifndef GRCTL_CHANGE_H
#define GRCTL_CHANGE_H

#include "tools/grctl/conn/conn.h"

typedef struct servo_change {
    int id;
    const grobo_servo_model *servo;
    const grobo_servo_register *reg;
    int32_t value;
    bool flash; /* it is to survive power-off */
} servo_change;

/* Whether it survives power-off: some servos keep what they are told without flash, too. */
bool change_is_kept(const servo_change *what);

/* Whether a command keeps it, as RS30x need; they take a new rate when they restart. */
bool change_needs_command(const servo_change *what);

/* Of a baud rate: bits per second. */
int change_bps(const servo_change *what);

/* Where the servo is after it was written. */
int change_id(const servo_change *what);

/* Writes it; then change_keep() makes it last. Both return GROBO_OK or an error. */
int change_write(conn *c, const servo_change *what);
int change_keep(conn *c, const servo_change *what);

/* The line, and the wait for a reply, at another rate. Returns GROBO_OK or an error. */
int change_tune(conn *c, int baud_bps);

/* At which of two rates the servo answers, and its register; or an error. The line stays there. */
int change_find(conn *c, const servo_change *what, int first_bps, int second_bps, int32_t *code);

/*
 * Writes the rate at that of the line, old_bps; with flash keeps it and restarts a servo that needs
 * that. Returns the rate at which it answers then, where the line stays, and its register; or an
 * error.
 */
int change_rate(conn *c, const servo_change *what, int old_bps, int32_t *code);

#endif
