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

/* What the line of a trace is. */
typedef struct trace_line {
    const char *device;
    grobo_wiring wiring;
    int baud_bps; /* 0: the default */
    int number;   /* of the robot, where there are several: from 2 on it ends the file's name */
} trace_line;

/*
 * Begins the trace that the command line asks for, if it does; now_us is the present time of the
 * clock that trace_bytes() will be given. Returns 0, or the exit status with the reason said; a
 * command that stops the robot waits for no reader of a pipe, and hears of a failure at the end.
 */
int trace_open(trace *t, app *a, const trace_line *line, int64_t now_us);

/* Bytes that went over the line. What cannot be written is told by trace_close(). */
void trace_bytes(trace *t, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                 size_t size);

/* Ends it. Returns `status`, or the exit status of a trace that could not be written. */
int trace_close(trace *t, app *a, int status);

/* The wiring that a trace's interface tells. False: it does not. */
bool trace_wiring(const pcapng_interface *interface, grobo_wiring *wiring);

#endif
