/* SPDX-License-Identifier: MIT */
/* --trace FILE: every byte of a command's line with its time and direction, as pcapng. */
#ifndef GRCTL_TRACE_H
#define GRCTL_TRACE_H

#include <grobo/core/serial.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cli/writer.h"
#include "tools/grctl/conn/pcapng.h"

typedef struct trace {
    /* private */
    FILE *file;    /* NULL: no trace */
    writer *queue; /* to it: a pipe may be full, a disk busy */
    char path[1024];
    int64_t to_wall_us; /* from our clock to that of the world */
    int error;          /* errno of the first failure, 0 none */
} trace;

/* What a line of a trace is. */
typedef struct trace_line {
    const char *name;   /* of a robot with several lines, NULL: it has one; with it: */
    const char *family; /* that of its servos */
    const char *device;
    grobo_wiring wiring;
    int baud_bps; /* 0: the default */
    int number;   /* of the robot, where there are several: from 2 on it ends the file's name */
} trace_line;

/*
 * Begins the trace of n lines (1..GROBO_LINES_MAX) that the command line asks for, if it does. An
 * interface is a line: of one line its device and wiring, of several their names and families,
 * with the device behind the family. now_us is the present time of the
 * clock that trace_bytes() will be given. Returns 0, or the exit status with the reason said; a
 * command that stops the robot waits for no reader of a pipe, and hears of a failure at the end.
 */
int trace_open(trace *t, app *a, const trace_line *lines, int n, int64_t now_us);

/* The same for the robot of the command: with its lines where it has several, of whose device
 * line->device is; else with this line. */
int trace_open_robot(trace *t, app *a, const trace_line *line, int64_t now_us);

/* Bytes that went over a line, 0..n-1. What cannot be written is told by trace_close(). */
void trace_bytes(trace *t, int line, grobo_direction direction, int64_t now_us,
                 const uint8_t *bytes, size_t size);

/* Ends it. Returns `status`, or the exit status of a trace that could not be written. */
int trace_close(trace *t, app *a, int status);

/* The family that the interface of a line of several tells, and in it the device; false: it tells
 * none. */
bool trace_family(const pcapng_interface *interface, char *family, size_t capacity,
                  const char **device);

/* The wiring that a trace's interface tells. False: it does not. */
bool trace_wiring(const pcapng_interface *interface, grobo_wiring *wiring);

#endif
