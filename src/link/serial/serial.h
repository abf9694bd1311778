/* SPDX-License-Identifier: MIT */
/* The inside of a grobo_serial: io.c has the open port, serial.c on top of it its life. */
#ifndef GROBO_LINK_SERIAL_I_H
#define GROBO_LINK_SERIAL_I_H

#include <stdatomic.h>

#include <event2/event.h>

#include <grobo/core/serial.h>

/* Longest a connection may take to be established. */
#define CONNECT_TIMEOUT_US INT64_C(2000000)

/* Longest a synchronous send waits for a line that takes nothing. */
#define SEND_TIMEOUT_US INT64_C(1000000)

/* Most bytes taken from the system by one read. */
#define READ_BYTES 4096

/*
 * How much an asynchronous port is read: each read that returns bytes costs READ_COST_US, each
 * byte BYTE_COST_US. The budget grows by 1 us a us, up to READ_BUDGET_US. A port whose budget is
 * spent is paused: it is read again when the budget is back. So a peer that never stops writing
 * (behind a pseudo-terminal or a connection) causes at most 10000 reads and 1 MB a second, after a
 * burst of 2500 reads or 250 kB, and cannot keep the loop busy. A line up to 1 Mbit/s pauses only
 * where each of its bytes comes by a read of its own, without a gap, and then for 0.1 ms.
 */
#define READ_BUDGET_US INT64_C(250000)
enum { READ_COST_US = 100, BYTE_COST_US = 1 };

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

    struct event *rx;     /* readable; while open in asynchronous mode and not paused */
    struct event *tx;     /* writable; added while bytes are queued or a connection is made */
    struct event *resume; /* the end of a pause */
    bool paused;          /* nothing is read: the budget is spent */
    int64_t spent_us;     /* up to this time the budget is spent */
    int64_t read_us;      /* just before the last read */
    bool more;            /* that read filled its buffer: there may be more */
    struct event *tell;   /* made active when there is something to tell */
    unsigned to_tell;
    int lost_error; /* of TELL_LOST */

    uint8_t *queue; /* a ring */
    size_t head;
    size_t used;

    const atomic_uint *barred; /* not 0: another process has the line; NULL: none can have it */

    unsigned pins; /* callbacks running; the object stays while there are any */
    bool freed;    /* grobo_serial_free() came in one of them */
};

/* Closes a port whose device is gone or that failed; asynchronous mode will be told. */
int grobo_i_serial_lose(grobo_serial *serial, int error);

/* What a function of an open port answers otherwise: GROBO_ERR_ARG where there is no port or what
 * else it was given is not sound, GROBO_ERR_CLOSED. */
int grobo_i_serial_check(const grobo_serial *serial, bool sound);

/* Has on_event called from the loop. */
void grobo_i_serial_tell(grobo_serial *serial, unsigned what);

/* Reads once; the port is closed when that fails. It may pause the port. */
int grobo_i_serial_take(grobo_serial *serial, void *buf, size_t size);

/*
 * Takes back the last frame sent, which alone may not have left: `size` bytes, with `behind` bytes
 * behind its sum (`size`: it has none). All of it is dropped where none of it has left. The rest of
 * a torn one would be missed at the other end, which would take what follows for it: it goes with a
 * wrong sum, and no servo obeys. Nothing can be done where the system has taken the sum.
 */
void grobo_i_serial_take_back(grobo_serial *serial, size_t size, size_t behind);

/* Writes queued bytes as far as the system takes them, waits for the writable event if not all. */
int grobo_i_serial_flush(grobo_serial *serial);

#endif
