/* SPDX-License-Identifier: MIT */
/*
 * The inside of a grobo_session, each file below the next: inside.c the calls that may call back,
 * stop.c what others ask of it, guard.c its guard, line.c the port or the simulator, pump.c its
 * bytes, session.c its states.
 */
#ifndef GROBO_LINK_SESSION_I_H
#define GROBO_LINK_SESSION_I_H

#include <stdatomic.h>

#include <event2/event.h>

#include <grobo/core/lines.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/session.h>

#include "src/link/guard/estop.h"

/* Serial ports found for GROBO_DEVICE_AUTO. */
typedef struct session_scan {
    int count;
    int at; /* the one that is tried */
    char path[GROBO_SCAN_PORTS_MAX][GROBO_DEVICE_MAX_BYTES];
} session_scan;

/* One line of the engine: its port or its simulator. */
typedef struct session_wire {
    grobo_session *session;
    int line;
    char path[GROBO_DEVICE_MAX_BYTES];   /* as configured, of a robot of several lines */
    char used[GROBO_DEVICE_MAX_BYTES];   /* as opened */
    char stable[GROBO_DEVICE_MAX_BYTES]; /* the name it will have when it comes back */
    grobo_serial *serial;
    struct session_sim *simulated; /* the simulator and what it did not take; NULL: none yet */
    grobo_sim *sim;                /* the one in there */
    size_t backlog_bytes;          /* of a frame that the simulator took in part, see line.c */
    size_t given_bytes;  /* of the frame given to the line last; 0: it may not be taken back */
    size_t given_behind; /* bytes of it behind its sum */
    bool opened;         /* the connection is made */
    grobo_i_estop_watch estop; /* the marks of the device */
} session_wire;

/* What a session speaks over: grobo_i_session_port or grobo_i_session_sim. */
typedef struct session_line {
    int (*open)(session_wire *wire, const char *device); /* < 0: `cause` says why */

    /* Gives the engine what has come, all until *until_us. < 0: gone, where nothing else tells. */
    int (*take)(session_wire *wire, int64_t *until_us);

    /* A frame is taken from the engine, which judges it, when nothing is left of the one before. */
    bool (*has_room)(session_wire *wire);
    void (*give)(session_wire *wire, const uint8_t *frame, size_t size);

    /* As grobo_i_serial_take_back(). */
    void (*take_back)(session_wire *wire, size_t size, size_t behind);

    /* When to look at it, which tells nothing by the loop. */
    int64_t (*deadline)(const session_wire *wire);
} session_line;

extern const session_line grobo_i_session_port, grobo_i_session_sim;

/* How a session's engine is used by other threads than the loop's; zeroed: it is not. */
typedef struct session_share {
    void (*lock)(void *ctx);
    void (*unlock)(void *ctx);
    bool (*is_elsewhere)(const void *ctx); /* this thread is not the loop's */
    void *ctx;
} session_share;

struct grobo_session {
    grobo_session_config config;         /* pointers to copied things are NULL */
    char device[GROBO_DEVICE_MAX_BYTES]; /* as configured */
    grobo_robot_config robot_config;     /* in effect while up */
    grobo_os_cause cause;

    grobo_session_state state;
    bool was_up; /* since open: then a failed attempt is not the end, if so configured */
    grobo_timer *timer;

    grobo_sim_config sim_config;
    const session_line *line;
    uint64_t sim_tx_bytes, sim_rx_bytes;
    int tapped;                         /* line of the bytes that on_tap was told last */
    int n_wires;                        /* lines of the engine */
    session_wire wire[GROBO_LINES_MAX]; /* the first n_wires of them */
    int lost_error;                     /* of one that is lost while the others are stopped; 0 */
    int64_t lost_by_us;                 /* they are closed by then */

    grobo_socket
        mark_socket; /* tells of marks; GROBO_SOCKET_NULL: they are looked at by the clock */
    struct event *mark_event;

    session_scan *scan; /* while one goes on */
    int check_job;      /* number of the check that runs, 0 none */
    bool check_ended;
    int check_result;
    int64_t retry_us; /* next attempt while WAITING */
    int64_t pause_us; /* the pause before it */

    /* any thread, signal handlers: see stop.c */
    atomic_uint asked;
    atomic_bool latched;         /* the engine's trip, as of the last time it was looked at */
    atomic_uint estops;          /* emergency stops asked for; wraps around */
    atomic_uint seen_estops;     /* of the engine's */
    atomic_bool obeying;         /* one that was posted, or that another program asked for */
    grobo_socket wake_socket[2]; /* a byte from 1 to 0 wakes the loop */
    struct event *wake;
    void (*on_time)(grobo_session *session); /* the deadline has come, or may have */
    bool untimed;        /* the timer could not be set: each wake-up is its time */
    bool always_listens; /* also while closed */
    bool exit_owed;      /* asked for while an emergency stop is carried out */
    grobo_exit_policy exit_policy;

    unsigned in_callback;  /* callbacks that run, one inside another */
    grobo_event_slow slow; /* to be reported, count 0: nothing */

    struct event *guard_news; /* the guard's socket; NULL without a guard */
    bool unguarded;           /* told that there is none any more */

    unsigned depth;                           /* calls that may call back, one inside another */
    int64_t turn_us;                          /* the clock, as last read inside of them; 0: not */
    void (*on_leave)(grobo_session *session); /* of session.c: counts down, and settles */
    bool closing;                             /* closed in a callback */
    bool freed;                               /* freed in a callback */

    session_share share; /* of the engine with other threads */
    size_t bytes;        /* of all this, as the robot has joints */
    grobo_robot robot;   /* the last member: grobo_i_robot_bytes() */
};

/* ---- inside.c ---- */

/* Around everything that may call back; the last leave does what callbacks asked for, and pumps. */
void grobo_i_session_enter(grobo_session *session);
void grobo_i_session_leave(grobo_session *session);

/* The time: as it was read last inside of enter and leave, by a callback that has returned or for
 * what the line had; read anew where that was not, or where something took its time since. */
int64_t grobo_i_session_now(grobo_session *session);

/* Around every callback of the user. The first returns what the second takes. */
int64_t grobo_i_session_enter_callback(grobo_session *session);
void grobo_i_session_leave_callback(grobo_session *session, grobo_callback callback,
                                    int64_t since_us);

/* Reports the slow ones; inside of enter and leave. */
void grobo_i_session_report_slow(grobo_session *session);

/* The user's callbacks, where there are any. No event of the line while the session is closed. */
void grobo_i_session_say(grobo_session *session, grobo_session_event event, int error);
void grobo_i_session_tell_robot(grobo_session *session, const grobo_event *event);
/* The bytes of a line: ctx is its session_wire. */
void grobo_i_session_tell_tap(void *ctx, grobo_direction direction, int64_t now_us,
                              const uint8_t *bytes, size_t size);

/* ---- stop.c ---- */

/* Any thread, signal handlers: has the loop make a round. */
void grobo_i_session_wake(grobo_session *session);

/* Any thread: true while a posted request has not been looked at. */
bool grobo_i_session_has_asked(const grobo_session *session);

/* Carries out what was posted; inside of enter and leave. */
void grobo_i_session_obey(grobo_session *session);

/* The same at any place, where something was posted. */
void grobo_i_session_attend(grobo_session *session);

/* Notes for grobo_session_is_latched() what the engine says. */
void grobo_i_session_note_latch(grobo_session *session);

/* Two sockets that hear each other; GROBO_SOCKET_NULL before. GROBO_OK, GROBO_ERR_NOMEM. */
int grobo_i_session_pair_new(grobo_socket pair[2]);
void grobo_i_session_pair_free(const grobo_socket pair[2]);

/* Makes and ends the wake-up socket. */
int grobo_i_session_wake_new(grobo_session *session);
void grobo_i_session_wake_free(grobo_session *session);

/* The loop waits for the socket while the session is not closed, or always; or no more. */
int grobo_i_session_listen(grobo_session *session, bool always);
void grobo_i_session_rest(grobo_session *session);

/*
 * Emergency stops that other programs ask for (grobo/estop.h). Nothing leaves when the last look at
 * the marks is older than GROBO_ESTOP_WATCH_US: a program that was stopped looks before it sends.
 * Between frames the system tells of new marks, or the clock where it does not.
 */

/* A port is open: the marks that stand are those of its device. */
void grobo_i_session_estop_begin(session_wire *wire, const char *device);

/* The session has the device no more. */
void grobo_i_session_estop_end(grobo_session *session);

/* Before the robot is asked for anything: obeys the marks that stand. */
void grobo_i_session_estop_arm(grobo_session *session);

/* Looks for new marks, where that is due, and obeys them. Calls back. */
void grobo_i_session_estop_look(grobo_session *session);

/* Whether the last look is too old for a frame to leave. */
bool grobo_i_session_estop_old(const grobo_session *session, int64_t now_us);

/* When the loop looks though no frame leaves; GROBO_NEVER_US without a device, and where the system
 * tells of marks. */
int64_t grobo_i_session_estop_deadline(const grobo_session *session);

/* The marks are looked at by the next look; what is to be said of stops is written; marks that were
 * heard are cleared. */
void grobo_i_session_estop_look_anew(grobo_session *session);
void grobo_i_session_estop_answer(grobo_session *session);
int grobo_i_session_estop_clear(grobo_session *session);

/* An emergency stop has ended so. */
void grobo_i_session_estop_ended(grobo_session *session, int result);

/* ---- guard.c: each does nothing without a guard ---- */

/* Makes and frees what hears the guard; on_news gets the session. GROBO_OK, GROBO_ERR_CAP,
 * GROBO_ERR_NOMEM. */
int grobo_i_session_guard_new(grobo_session *session, event_callback_fn on_news);
void grobo_i_session_guard_free(grobo_session *session);

/* There is news: true where the guard has taken the port. */
bool grobo_i_session_guard_hear(grobo_session *session);

/* The port is open, and a robot answers: the guard gets it. */
void grobo_i_session_guard_take(grobo_session *session);

/* The port is about to be closed. */
void grobo_i_session_guard_release(grobo_session *session);

/* Before anything is sent. True: the guard has the port, and nothing may be. */
bool grobo_i_session_guard_has_it(grobo_session *session);

/* After: says whether joints are on their way. */
void grobo_i_session_guard_tell(grobo_session *session);

/* When the loop turns for the guard though nothing is due; GROBO_NEVER_US where nothing moves. */
int64_t grobo_i_session_guard_deadline(const grobo_session *session);

/* ---- line.c ---- */

/* Frees the simulator, where there is one. */
void grobo_i_session_sim_free(session_wire *wire);

/* Lists the ports to try; GROBO_ERR_NOTFOUND where there are none. */
int grobo_i_session_scan_begin(grobo_session *session);

/* The port of each line, by the device "NAME=PORT,NAME=PORT" or by what the lines say themselves.
 * GROBO_ERR_ARG: no such line, or no port; GROBO_ERR_CAP. */
int grobo_i_session_set_paths(grobo_session *session);
/* The first line without a port; NULL: each has one. */
const char *grobo_i_session_without_port(const grobo_session *session);

/* Forgets them. */
void grobo_i_session_scan_end(grobo_session *session);

/* ---- pump.c ---- */

/* Hands out what the engine wants to send as far as the line takes it, and sets the timer. */
void grobo_i_session_send(grobo_session *session);

/*
 * Lets the engine's time pass, with a line. What the line has for it is read first: a process that
 * was held up must not take for a servo's silence what has been waiting for it. < 0: the line is
 * gone, and no time has passed.
 */
int grobo_i_session_step(grobo_session *session);

/* Of a robot of several lines: one is gone, and the others stop; whether it is, and whether they
 * have stopped, so that the session may close them. */
void grobo_i_session_lose_wire(session_wire *wire, int error);
bool grobo_i_session_is_lost(const session_wire *wire);
bool grobo_i_session_has_stopped(const grobo_session *session);

/* Callback of the serial port. */
void grobo_i_session_on_data(void *ctx, grobo_serial *serial, const uint8_t *bytes, size_t size);

/* ---- session.c ---- */

/* From now on other threads may use the engine. */
void grobo_i_session_share(grobo_session *session, const session_share *share);

/* Reads what the line has now, and lets the engine's time pass. */
void grobo_i_session_look(grobo_session *session);

#endif
