/* SPDX-License-Identifier: MIT */
/*
 * A guard: guard.c has the program's side, run.c that of the process; session/guard.c has when a
 * session uses it.
 *
 * What goes over the socket, between two builds of the same library:
 * - to the guard: messages of guard_message and its data. SHARE brings the memory that both have;
 *   TAKE the port, and how to speak on it, behind MORE with the port of each other line of a robot
 *   that has several; STATE what changed since; RELEASE takes the ports back;
 *   at the end of the stream the program has ended well where it had no port there, else it has
 *   died, or has closed its descriptors.
 * - to the program: guard_hello once, then a byte for each of guard_word.
 *
 * States of the process: idle (no port), watching (a port, the program lives), stopping (it died,
 * is stopped, or has not been heard), and lent (it has stopped the robot, another program may have
 * the port, and torque goes off if the program dies before one had it).
 *
 * Who has the line is one word in the shared memory. The program gives it up, and the guard takes
 * it, by one exchange; the program looks at it before each of its bytes leaves. So whoever wakes up
 * after the guard has taken it sends nothing, and is told GUARD_TAKEN; the port is then the guard's
 * alone to release. The memory holds the program's heartbeat too.
 */
#ifndef GROBO_LINK_GUARD_I_H
#define GROBO_LINK_GUARD_I_H

#include <stdatomic.h>

#include <grobo/core/robot.h>
#include <grobo/guard.h>

#include "ports/common/guard.h"

/* Changes with the layout of guard_message. */
#define GUARD_MAGIC UINT32_C(0x47524434)

typedef enum guard_kind {
    GUARD_TAKE = 1,
    GUARD_STATE,
    GUARD_RELEASE,
    GUARD_SHARE,
    GUARD_MORE
} guard_kind;

/* Who has the line. */
enum guard_line { GUARD_LINE_PROGRAM, GUARD_LINE_GUARD, GUARD_LINE_NOBODY };

/* What both processes have; where the system has no such memory, each has one of its own. */
typedef struct guard_shared {
    atomic_uint line;  /* guard_line: bytes leave the program only while it is 0 */
    atomic_uint beats; /* counts the rounds of the program's loop, and wraps around */
} guard_shared;

/* Bytes from the guard. */
enum guard_word {
    GUARD_TAKEN = 'T',  /* the robot is being stopped: the program has no port any more */
    GUARD_REFUSED = 'X' /* that port cannot be guarded */
};

/* What the guard says first: the program's build and the guard's are alike. */
typedef struct guard_hello {
    uint32_t magic;
    uint32_t message_bytes;
} guard_hello;

/* What the guard does with the torque. */
typedef enum guard_policy { GUARD_HOLD, GUARD_OFF, GUARD_ESTOP } guard_policy;

typedef struct guard_message {
    uint32_t magic;
    uint32_t kind;   /* guard_kind */
    uint32_t policy; /* guard_policy */
    uint32_t moves;  /* joints are on their way */
    /* of TAKE */
    uint32_t connection; /* a TCP connection, not a serial port; of MORE too */
    uint32_t data_bytes; /* behind the message */
    grobo_wiring wiring;
    grobo_robot_config robot;
    char driver[32];
    char device[GROBO_DEVICE_MAX_BYTES];
} guard_message;

struct grobo_guard {
    grobo_i_guard_process process;
    const grobo_mem *mem;
    guard_shared *shared; /* `own`, or mapped */
    guard_shared own;
    guard_message message; /* what it knows of the port it has */
    bool has_port;
    bool taken;   /* it stops the robot: nothing may be sent on the port given to it */
    bool refused; /* it cannot guard the port given to it */
    bool ended;
};

/* Each of these does nothing in a process that the program forked, or when the guard has ended. */

/* Gives it a port; message->data_bytes of data go with it. */
void grobo_i_guard_take(grobo_guard *guard, const guard_message *message, const void *data,
                        grobo_handle handle);

/* Gives it the port of a line behind the first one, before that. */
void grobo_i_guard_more(grobo_guard *guard, bool connection, grobo_handle handle);

/* Says what has changed, if it has, and that the program lives. */
void grobo_i_guard_tell(grobo_guard *guard, guard_policy policy, bool moves);

/* Takes the port back, before it is closed; where the guard has taken it, `taken`. */
void grobo_i_guard_release(grobo_guard *guard);

/* Reads what it says, without waiting: `taken`, `refused` and `ended` are new then. */
void grobo_i_guard_hear(grobo_guard *guard);

#endif
