/* SPDX-License-Identifier: MIT */
/* The inside of a grobo_serial: serial.c has its life, serial_io.c its bytes. */
#ifndef GROBO_LINK_SERIAL_I_H
#define GROBO_LINK_SERIAL_I_H

#include <event2/event.h>

#include <grobo/serial.h>

/* Longest a connection may take to be established. */
#define CONNECT_TIMEOUT_US INT64_C(2000000)

/* Longest a synchronous send waits for a line that takes nothing. */
#define SEND_TIMEOUT_US INT64_C(1000000)

/* Most bytes taken from the system by one read. */
#define READ_BYTES 4096

/* What is still to be told by on_event, one bit each; told in the order of the bits. */
enum { TELL_OPENED = 1, TELL_DRAINED = 2, TELL_LOST = 4 };

struct grobo_serial {
    grobo_serial_config config; /* device and ops: see below */
    char device[GROBO_DEVICE_MAX_BYTES];
    bool has_device;
    grobo_os_cause cause;
    grobo_serial_counters counters;

    const grobo_port_ops *ops; /* of the open port; NULL when closed */
    grobo_port *port;
    size_t port_bytes;
    bool ready;       /* open and connected */
    int quick_result; /* of set_low_latency of the open port */

    struct event *rx;   /* readable; while open in asynchronous mode */
    struct event *tx;   /* writable; added while bytes are queued or a connection is made */
    struct event *tell; /* made active when there is something to tell */
    unsigned to_tell;
    int lost_error; /* of TELL_LOST */

    uint8_t *queue; /* a ring */
    size_t head;
    size_t used;

    unsigned pins; /* callbacks running; the object stays while there are any */
    bool freed;    /* grobo_serial_free() came in one of them */
};

/* Closes a port whose device is gone or that failed; asynchronous mode will be told. */
int grobo_i_serial_lose(grobo_serial *serial, int error);

/* Has on_event called from the loop. */
void grobo_i_serial_tell(grobo_serial *serial, unsigned what);

/* Reads once; the port is closed when that fails. */
int grobo_i_serial_take(grobo_serial *serial, void *buf, size_t size);

/* Writes queued bytes as far as the system takes them, waits for the writable event if not all. */
int grobo_i_serial_flush(grobo_serial *serial);

#endif
