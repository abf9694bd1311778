/* SPDX-License-Identifier: MIT */
/* Single servos by their id: asking for registers, quickly where nobody may be there. */
#ifndef GRCTL_SERVOS_H
#define GRCTL_SERVOS_H

#include "conn.h"

/*
 * Reads `length` registers of a servo into data.
 * Returns GROBO_OK or the error; nothing is said.
 */
int servos_read(conn *c, int id, int address, int length, uint8_t *data);

/*
 * From now on each servo is asked once, and waited for no longer than a reply of `length` registers
 * takes at this speed of the line: for scans. *wire_us is that time, without any margin. Returns
 * GROBO_OK or the error.
 */
int servos_hurry_at(conn *c, int baud_bps, int length, uint32_t *wire_us);

/* From now on as the options of the command line say. */
int servos_take_time(conn *c);

/* Reads an id of the command line: a number 1..127, or a joint's name. -1: *status is set. */
int servos_parse_id(app *a, const char *text, int *status);

#endif
