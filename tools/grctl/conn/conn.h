/* SPDX-License-Identifier: MIT */
/*
 * A robot on the command line: open it, ask it, wait for it, leave it as the exit policy says.
 * Everything waits inside the event loop, so a signal or a lost port is noticed at once.
 */
#ifndef GRCTL_CONN_H
#define GRCTL_CONN_H

#include <event2/event.h>

#include <grobo/session.h>

#include "tools/grctl/conn/guard.h"
#include "tools/grctl/conn/last_frames.h"
#include "tools/grctl/conn/trace.h"
#include "tools/grctl/conn/trims.h"
#include "tools/grctl/os/os.h"

typedef struct conn conn;

/* What a command wants to hear beside the end of its job. */
typedef void (*conn_event_fn)(conn *c, const grobo_event *event);

/* Every byte of the line, beside --trace. */
typedef void (*conn_bytes_fn)(conn *c, grobo_direction direction, int64_t now_us,
                              const uint8_t *bytes, size_t size);

/*
 * What stands behind a connection: the loop, the signals it hears, the session. A command makes
 * one for itself; a shell keeps one open and lends it to its commands (app.link).
 */
typedef struct conn_link {
    /* private */
    struct event_base *base;
    struct event *signals[OS_ENDINGS_MAX + 1]; /* the last is Ctrl-Z */
    int n_signals;
    grobo_session *session;
    trims trims;                /* its driver, for a configured robot */
    grobo_robot_sim sim;        /* of GROBO_DEVICE_SIM */
    grobo_sim_physics *physics; /* its world; NULL: none */
    conn *user;                 /* the command that has it now, NULL between two */
    int signal;                 /* the first signal that came between two commands, 0 none */
    int link_error;             /* why the link is lost, 0 while it stands */
    bool up;                    /* the line is open */
    bool answered;              /* the robot has answered */
    bool news; /* between two commands the line was lost, or the engine stopped for this: */
    grobo_trip_info trip;
    trace trace; /* of the shell's --trace */
    /* set by a shell */
    grobo_joint_mask free_joints; /* in free mode */
    app *owner;                   /* of the shell */
    bool kept;                    /* conn_close() leaves it open */
    struct conn_link *beside;     /* of a command with several robots: the next one, */
    bool borrows;                 /* with the loop of the first */
    grobo_guard *guard;           /* NULL: none */
    guard_robot guarded;          /* what it needs */
} conn_link;

struct conn {
    app *a;
    conn_link *link; /* &own, or the shell's */
    conn_link own;
    struct event_base *base;     /* the link's */
    grobo_session *session;      /* the link's */
    grobo_robot *robot;          /* the session's */
    trace trace;                 /* of --trace */
    last_frames last;            /* for -v */
    int64_t quiet_by_us;         /* when the line is closed though a reading is under way */
    int64_t shown_us;            /* when -vv showed its first byte, 0: none yet */
    grobo_robot_counters before; /* the engine's, when the command began */
    conn_event_fn on_event;
    conn_bytes_fn on_bytes;
    void *ctx;           /* for on_event, on_bytes */
    grobo_event_job job; /* how the last job ended */
    uint8_t *data;       /* where the job's data is copied to, at most data_bytes of it */
    size_t data_bytes;
    int waiting_for;      /* number of the job that is waited for, 0 none */
    int signal;           /* the first signal that came, 0 none */
    int link_error;       /* why the link is lost, 0 while it stands */
    grobo_trip_info trip; /* why the engine stopped, if it did */
    bool estop_ended;     /* an emergency stop was carried out, with this result: */
    int estop_result;
    grobo_joint_mask unstopped; /* joints of the last stop that could not be read back */
    int open_error;             /* why it could not be opened, 0: it was not tried, or it could */
    bool up;        /* the line is open, and the robot has answered where that was asked */
    bool moving;    /* a motion is or may be under way; the exit policy ends it */
    bool leaving;   /* the exit policy is being carried out: signals wait */
    bool suspended; /* by Ctrl-Z, when the robot stood */
};

/*
 * Opens the device of the command line and checks that a robot answers. Returns 0, or the exit
 * status with the reason said. conn_close() is called in either case.
 */
int conn_open(conn *c, app *a);

/* The same, but nobody needs to answer: for scans. */
int conn_open_unchecked(conn *c, app *a);

/* The same where the device is named, else conn_open(): for what asks a servo by itself. */
int conn_open_named(conn *c, app *a);

/*
 * The same for a command that moves the robot: refused after an emergency stop. From then on the
 * joints are watched, see conn_watch().
 */
int conn_open_to_move(conn *c, app *a);

/*
 * The same as conn_open() for one more robot beside a first link: they have one loop, and a signal
 * is told to all. Closed before the first; signals are caught by the first.
 */
int conn_open_beside(conn *c, app *a, conn_link *first);
/* The same for one that moves too: conn_open_to_move(). */
int conn_open_to_move_beside(conn *c, app *a, conn_link *first);

/* Where an emergency stop is being carried out: until it is verified. Returns as conn_wait(). */
int conn_end_estop(conn *c);

/* Reads the joints in the background, so that heat, current, low voltage and silence stop them. */
void conn_watch(conn *c, bool on);

/*
 * Waits for the end of the job that a request returned (an error < 0 is handed through).
 * Returns the job's result; GROBO_ERR_CANCELED when a signal came, GROBO_ERR_UNPLUGGED when the
 * link is lost.
 */
int conn_wait(conn *c, int job);

/* Reads joints, and waits for that. */
int conn_sense(conn *c, grobo_joint_mask joints, grobo_sense_kind kind);

/* The joints of the robot that is connected: with its trims. */
const grobo_model *conn_model(const conn *c);

/*
 * The same, and a terminal shows for how long: after 2 s, or at once where it should take longer.
 * expected_us: how long it should take, 0 where nobody knows. `doing`: "move".
 */
int conn_wait_shown(conn *c, int job, const char *doing, int64_t expected_us);

/* Runs the loop until `done` (which may be NULL) says so, a signal comes or the link is lost; as
 * conn_wait(). */
int conn_wait_until(conn *c, bool (*done)(conn *c));

/* Waits for a moment of grobo_now_us(); as conn_wait(). */
int conn_sleep_until(conn *c, int64_t at_us);

/* For an event of the loop: sets the bool that ctx points to. */
void conn_note(evutil_socket_t fd, short what, void *ctx);

struct timeval conn_timeval(int64_t us);
/* Has fn called again and again. NULL: there is no memory. */
struct event *conn_every(struct event_base *base, int64_t period_us, event_callback_fn fn,
                         void *ctx);

/* Ends an event; NULL is allowed. */
void conn_forget(struct event *event);

/*
 * Says why a job failed, naming joint and cause, and returns the exit status. `doing`: "move".
 * A signal is not complained about: conn_close() gives its status.
 */
int conn_fail(conn *c, int error, const char *doing);

/* What a trip measured, as " (72 deg C)" behind its name; "" where nothing was. */
void conn_trip_value(const grobo_trip_info *t, char *text, size_t text_bytes);

/* Whether an error says that a reply did not come, or came broken. */
bool conn_is_of_reply(int error);

/* What is set up otherwise at a joint's servo than the joint needs, and what fixes it. */
typedef struct conn_setup {
    char fact[256]; /* register, value, what is wanted */
    char fix[256];
} conn_setup;

/* False: nothing is, by what was read of it last. */
bool conn_setup_of(const conn *c, int joint, conn_setup *s);

/* Of conn_fail(): what the job's joint did. The prefix ("init: ") is put before that. */
int conn_fail_job(conn *c, int error, const char *prefix);

/* As conn_fail(), for one servo by its id, whether it is a joint's or not. */
int conn_fail_servo(conn *c, int error, int id);

/* Of the line's tap: keeps what -v tells of a failure, shows it at once from -vv on. */
void conn_note_bytes(conn *c, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                     size_t size);
/* -vv: what has come since the last frame, in one piece. */
void conn_show_answer(conn *c);

/* The baud rate that the global options ask for, or the default. */
uint32_t conn_baud(const app *a);

/*
 * The engine's counters since this command began, for a command that may be one of a shell's: the
 * engine itself counts from when the link was opened.
 */
void conn_counters(const conn *c, grobo_robot_counters *counters);

/* The engine's configuration that the global options ask for. */
grobo_robot_config conn_robot_config(const app *a);

/*
 * Ends it: carries out the exit policy when one was asked for, a signal came or a motion was cut
 * short, then closes. Returns the exit status: `status`, or that of the signal, or 1 when the
 * policy could not be carried out.
 */
int conn_close(conn *c, int status);

/*
 * A link for a shell: app.link points to it while its commands run. Nothing is opened before a
 * command needs it. conn_link_deinit() in either case.
 */
int conn_link_init(conn_link *link);

/*
 * Closes what is open: carries out the exit policy that was asked for. What came between two
 * commands is its signal. Returns as conn_close(). The link may be used again.
 */
int conn_link_close(conn_link *link, app *a, int status);
void conn_link_deinit(conn_link *link);

/*
 * Between two commands: has the joints read in the background, which finds heat, low voltage and
 * lost torque; and says what has happened since the last command. Returns its exit status, or 0.
 */
void conn_link_idle(conn_link *link, app *a);
int conn_link_news(conn_link *link, app *a);

/* Of conn_link_init() and conn_link_deinit(): false where there is no memory. */
bool conn_signals_init(conn_link *link);
void conn_signals_deinit(conn_link *link);

/* Suspends the process until it continues; the terminal is as it was meanwhile. */
void conn_suspend(void);

/* The signals are caught while a command has the link, and between these two. */
void conn_link_watch(conn_link *link);
void conn_link_unwatch(conn_link *link);

/* True if ports are looked through for a robot. */
bool conn_is_auto(const app *a);

/* The device of the command line, or "auto". */
const char *conn_requested(const app *a);

/* The name of the device in use, for messages. */
const char *conn_device(const conn *c);

/* The link's counters as JSON: {"tx_frames": ...}. */
json_t *conn_link_json(const conn *c);

#endif
