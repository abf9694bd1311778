/* SPDX-License-Identifier: MIT */
/* What frames cost on the wire, by the same figures that the bus plans with. */
#ifndef GRCTL_WIRE_H
#define GRCTL_WIRE_H

#include <grobo/core/robot.h>

typedef struct wire_cost {
    char name[24];
    int frame_bytes, reply_bytes;
    uint32_t total_us; /* from the first byte until the line is free again */
} wire_cost;

enum { WIRE_MOTION, WIRE_READ_FULL, WIRE_READ_ANGLE, WIRE_COSTS };

/* What the line of this command's robot allows. Returns 0 or GROBO_ERR_ARG for a baud rate that is
 * none. */
int wire_budget(const grobo_driver *driver, int baud_bps, grobo_budget *budget);

/* True if the line is too slow for moves of all joints at once, of a robot that is moved in
 * segments. Then *rate_bps is the lowest rate of its servos that is enough; 0: none is. */
bool wire_is_slow(const grobo_driver *driver, int baud_bps, int *rate_bps);

/* What to say then, and what helps; static until the next call. */
const char *wire_slow_text(const grobo_driver *driver, int baud_bps, int rate_bps);

/* Fills all WIRE_COSTS of them. Returns 0 or GROBO_ERR_ARG for a baud rate that is none. */
int wire_measure(const grobo_driver *driver, int baud_bps, wire_cost *costs);

/*
 * How often each of n joints in free mode is read while the others are watched, a second; 0 for a
 * baud rate that is none.
 */
double wire_taught_hz(const grobo_driver *driver, int baud_bps, int n);

/*
 * Beyond the wire's time, until a servo is taken for silent: for an adapter that is set for low
 * latency, and this machine. The bus keeps quiet for 1 ms more: it all stays below 4 ms.
 */
enum { WIRE_SILENT_MARGIN_US = 2500 };

/*
 * The time on the line of reading `length` registers of a servo, until its reply is whole.
 * Returns 0 or GROBO_ERR_ARG.
 */
int wire_read_us(const grobo_driver *driver, int baud_bps, int length, uint32_t *time_us);

/* Whether an adapter has returned what was sent to it, by what a bus met that did not reckon with
 * that: of each request rubbish, or with some families a packet, before its reply. */
bool wire_echoes(const grobo_bus_stats *n);

#endif
