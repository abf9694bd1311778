/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/lines.h>
#include <grobo/core/port.h>
#include <grobo/core/robot.h>
#include <grobo/estop.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/conn/auto_ports.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/fall.h"
#include "tools/grctl/conn/guard.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

const char *conn_requested(const app *a)
{
    const char *fallback = getenv("GRCTL_DEVICE");
    if (app_global(a, GLOBAL_DEVICE)->given) {
        return app_global(a, GLOBAL_DEVICE)->text;
    }
    return fallback && *fallback ? fallback : GROBO_DEVICE_AUTO;
}

bool conn_is_auto(const app *a)
{
    return strcmp(conn_requested(a), GROBO_DEVICE_AUTO) == 0;
}

/* ---- what comes from the loop --------------------------------------------------------------- */

static void on_session(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    conn_link *link = ctx;
    (void)session;
    switch (event) {
    case GROBO_SESSION_EVENT_UP:
        link->up = true;
        break;
    case GROBO_SESSION_EVENT_LOST:
        link->up = false;
        if (!link->user || !link->user->a->reconnects || link->kept) {
            link->link_error = error ? error : GROBO_ERR_UNPLUGGED;
        }
        break;
    case GROBO_SESSION_EVENT_FAILED:
        link->link_error = error ? error : GROBO_ERR_UNPLUGGED;
        break;
    case GROBO_SESSION_EVENT_UNGUARDED:
        if (link->user) {
            app_note(link->user->a,
                     "the guard has ended: if grctl is killed, joints continue to their goals");
        }
        break;
    }
    if (link->user) {
        link->user->up = link->up;
        link->user->link_error = link->link_error;
    }
    link->news |= !link->user && link->link_error;
}

static void note_halted(conn *c, grobo_joint_mask failed)
{
    c->unstopped = failed;
    if (failed) {
        app_note(c->a,
                 "stopped, but joints cannot be read back and may still move: %d; switch the robot "
                 "off",
                 grobo_joints_count(failed));
    }
}

static void on_robot(void *ctx, const grobo_event *event)
{
    conn_link *link = ctx;
    conn *c = link->user;
    if (!c && event->kind == GROBO_EVENT_TRIP) {
        link->trip = event->u.trip;
        link->news = true;
    }
    if (!c) {
        return;
    }
    if (event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_ESTOP) {
        c->estop_ended = true;
        c->estop_result = event->u.job.result;
    }
    if (event->kind == GROBO_EVENT_JOB && event->u.job.number == c->waiting_for) {
        c->job = event->u.job;
        c->waiting_for = 0;
        if (c->data && c->job.size) {
            memcpy(c->data, c->job.data, c->job.size < c->data_bytes ? c->job.size : c->data_bytes);
        }
    }
    if (event->kind == GROBO_EVENT_TRIP) {
        c->trip = event->u.trip;
    }
    if (event->kind == GROBO_EVENT_HALTED) {
        note_halted(c, event->u.halted.failed);
    }
    if (c->on_event) {
        c->on_event(c, event);
    }
}

static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    conn_link *link = ctx;
    conn *c = link->user;
    int line = grobo_session_tapped(link->session);
    trace_bytes(&link->trace, line, direction, now_us, bytes, size);
    if (!c) {
        return;
    }
    trace_bytes(&c->trace, line, direction, now_us, bytes, size);
    conn_note_bytes(c, direction, now_us, bytes, size);
    if (c->on_bytes) {
        c->on_bytes(c, direction, now_us, bytes, size);
    }
}

/* ---- waiting -------------------------------------------------------------------------------- */

static bool job_done(conn *c)
{
    return c->waiting_for == 0;
}

/* Did a signal come that ends the command? None ends one that stops the robot. */
static bool is_interrupted(const conn *c)
{
    return c->signal && !c->leaving && !c->a->stops;
}

int conn_wait_until(conn *c, bool (*done)(conn *c))
{
    while (!done || !done(c)) {
        if (is_interrupted(c)) {
            return GROBO_ERR_CANCELED;
        }
        if (c->link_error) {
            return c->link_error;
        }
        if (event_base_loop(c->base, EVLOOP_ONCE) != 0) {
            return GROBO_ERR_IO;
        }
    }
    /* The engine may know what its events have not told yet: a stop that came by a key, say. One
     * round: there may always be something to do (a session without memory for its timer). */
    (void)event_base_loop(c->base, EVLOOP_NONBLOCK | EVLOOP_ONCE);
    return GROBO_OK;
}

int conn_wait(conn *c, int job)
{
    memset(&c->job, 0, sizeof c->job);
    if (job < 0) {
        return job;
    }
    c->waiting_for = job;
    int error = conn_wait_until(c, job_done);
    c->waiting_for = 0;
    return error ? error : c->job.result;
}

int conn_sense(conn *c, grobo_joint_mask joints, grobo_sense_kind kind)
{
    return conn_wait(c, grobo_robot_sense(c->robot, joints, kind));
}

/* What a person sees of it. */
enum { SHOW_US = 100000, LONG_US = 2000000 };

typedef struct waiting {
    progress bar;
    const char *doing;
    int64_t began_us, expected_us;
} waiting;

static void on_show(evutil_socket_t fd, short what, void *ctx)
{
    waiting *w = ctx;
    int64_t took_us = grobo_now_us() - w->began_us;
    bool in_time = took_us < w->expected_us;
    char text[64];
    (void)fd;
    (void)what;
    if (took_us < LONG_US && w->expected_us < LONG_US) {
        return;
    }
    if (in_time) {
        snprintf(text, sizeof text, _("%s: %.1f of %.1f s"), w->doing, (double)took_us / 1e6,
                 (double)w->expected_us / 1e6);
    } else {
        snprintf(text, sizeof text, "%s: %.1f s", w->doing, (double)took_us / 1e6);
    }
    progress_draw(&w->bar, in_time ? (double)took_us / (double)w->expected_us : -1, text);
}

int conn_wait_shown(conn *c, int job, const char *doing, int64_t expected_us)
{
    waiting w = {.doing = doing, .began_us = grobo_now_us(), .expected_us = expected_us};
    struct event *tick = NULL;
    progress_start(&w.bar, c->a);
    if (job > 0 && w.bar.shown) {
        tick = conn_every(c->base, SHOW_US, on_show, &w);
    }
    int error = conn_wait(c, job);
    conn_forget(tick);
    progress_clear(&w.bar);
    return error;
}

void conn_note(evutil_socket_t fd, short what, void *ctx)
{
    bool *flag = ctx;
    (void)fd;
    (void)what;
    *flag = true;
}

struct timeval conn_timeval(int64_t us)
{
    return (struct timeval){.tv_sec = (int)(us / 1000000), .tv_usec = (int)(us % 1000000)};
}

struct event *conn_every(struct event_base *base, int64_t period_us, event_callback_fn fn,
                         void *ctx)
{
    struct timeval period = conn_timeval(period_us);
    struct event *timer = event_new(base, -1, EV_PERSIST, fn, ctx);
    if (timer && event_add(timer, &period) != 0) {
        event_free(timer);
        timer = NULL;
    }
    return timer;
}

void conn_forget(struct event *event)
{
    if (event) {
        event_free(event);
    }
}

int conn_sleep_until(conn *c, int64_t at_us)
{
    bool awake = false;
    int64_t rest_us = at_us - grobo_now_us();
    struct timeval rest = conn_timeval(rest_us > 0 ? rest_us : 0);
    struct event *timer = evtimer_new(c->base, conn_note, &awake);
    int error = GROBO_OK;
    if (!timer || evtimer_add(timer, &rest) != 0) {
        conn_forget(timer);
        return GROBO_ERR_NOMEM;
    }
    while (!awake && (!c->signal || c->a->stops) && !c->link_error && !error) {
        if (event_base_loop(c->base, EVLOOP_ONCE) != 0) {
            error = GROBO_ERR_IO;
        }
    }
    event_free(timer);
    if (c->signal && !c->a->stops) {
        return GROBO_ERR_CANCELED;
    }
    return c->link_error ? c->link_error : error;
}

static bool is_idle(conn *c)
{
    return grobo_robot_job(c->robot) == GROBO_JOB_NONE;
}

/* ---- opening -------------------------------------------------------------------------------- */

static bool is_tcp(const char *device)
{
    return strncmp(device, "tcp:", 4) == 0;
}

/* Why the device cannot be used, and what to do about it. */
static const char *advice(const conn *c, int error)
{
    switch (error) {
    case GROBO_ERR_BUSY: /* an estop says itself what to do */
        return c->a->hushed ? "" : _("; end that program, or stop its robot: 'grctl estop'");
    case GROBO_ERR_NOENT:
        if (is_tcp(conn_device(c))) {
            return _("; does a serial server listen there?");
        }
        return _("; see 'grctl ports' for what there is");
    case GROBO_ERR_TYPE:
    case GROBO_ERR_ISDIR:
        return _("; see 'grctl ports' for what there is");
    case GROBO_ERR_PERM:
        return _("; may your user open it? it often takes membership of the group dialout");
    case GROBO_ERR_TIMEOUT:
        return _("; is the robot switched on, and its baud rate right?");
    case GROBO_ERR_NOTFOUND:
        return _("; is its cable in? see 'grctl ports', or try '-d sim'");
    }
    return "";
}

static bool bytes_passed(const conn *c, grobo_direction direction)
{
    uint64_t tx_bytes, rx_bytes;
    grobo_session_bytes(c->session, &tx_bytes, &rx_bytes);
    return (direction == GROBO_DIR_TX ? tx_bytes : rx_bytes) > 0;
}

/* What is wrong with the device, where the error's own text would not say it. */
static const char *open_trouble(const conn *c, int error)
{
    const grobo_os_cause *cause = grobo_session_cause(c->session);
    switch (error) {
    case GROBO_ERR_NOTFOUND:
        return _("no robot answers on any USB adapter that may be opened");
    case GROBO_ERR_TIMEOUT:
        return _("no robot answers");
    case GROBO_ERR_TYPE:
        return _("is not a serial port");
    case GROBO_ERR_NOENT: /* which way it cannot be reached */
        return is_tcp(conn_device(c)) && *cause->text ? cause->text : app_error_text(error);
    }
    return app_error_text(error);
}

static int try_port(void *ctx, const grobo_port_info *info)
{
    static char nearest[GROBO_DEVICE_MAX_BYTES];
    cli_guess *guess = ctx;
    const char *before = guess->best;
    int edits = guess->edits;
    cli_guess_try(guess, info->path);
    if (guess->best && (!before || guess->edits != edits)) { /* the info lives for this call */
        snprintf(nearest, sizeof nearest, "%s", info->path);
        guess->best = nearest;
    }
    return 0;
}

/* The robot or port that is nearest to the name of a device that is none, or NULL. */
static const char *near_device(const app *a, const char *name)
{
    cli_guess guess = {.name = name, .length = strlen(name)};
    if (a->nearest_device) {
        return a->nearest_device;
    }
    if (strchr(name, '/') && !is_tcp(name)) {
        grobo_port_list(try_port, &guess);
    }
    return guess.best;
}

/* What could not be opened. The ports of several lines are in the robot's file. */
static const char *name_of_closed(const conn *c, int error)
{
    const grobo_robot_def *def = robot_of(c->a);
    return def->n_lines > 0 && conn_is_auto(c->a) ? def->name
           : error == GROBO_ERR_NOTFOUND          ? GROBO_DEVICE_AUTO
                                                  : conn_device(c);
}

/* Why the device that was asked for is not open. */
static int fail_closed(conn *c, int error)
{
    const grobo_os_cause *cause = grobo_session_cause(c->session);
    /* Of the others the system only says again what the error says. */
    bool tells = *cause->text && (error == GROBO_ERR_BUSY || error == GROBO_ERR_IO ||
                                  error == GROBO_ERR_UNSUPPORTED || error == GROBO_ERR_UNPLUGGED ||
                                  robot_of(c->a)->n_lines > 0);
    if (error == GROBO_ERR_TIMEOUT && is_tcp(conn_device(c)) && !bytes_passed(c, GROBO_DIR_TX)) {
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error),
                        "%s: %s; is the address right, and that machine on?", conn_device(c),
                        cause->text);
    }
    if (conn_is_of_reply(error) && bytes_passed(c, GROBO_DIR_RX)) {
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error),
                        "%s: bytes come, but no reply in them; is the baud rate right, and is it a "
                        "robot? see 'grctl doctor'",
                        conn_device(c));
    }
    return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error), "%s: %s%s%s%s%s",
                    name_of_closed(c, error), open_trouble(c, error), tells ? " (" : "",
                    tells ? cause->text : "", tells ? ")" : "", advice(c, error));
}

static int fail_open(conn *c, int error)
{
    c->open_error = error;
    const char *nearest = error == GROBO_ERR_NOENT ? near_device(c->a, conn_requested(c->a)) : NULL;
    if (nearest) {
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error), "%s: %s (did you mean '%s'?)",
                        conn_device(c), open_trouble(c, error), nearest);
    }
    return fail_closed(c, error);
}

grobo_robot_config conn_robot_config(const app *a)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                 .readback_correction = a->robot && a->robot->offsets,
                                 .sense_interval_us = GROBO_SENSE_NEVER};
    const cli_value *timeout = app_global(a, GLOBAL_TIMEOUT);
    const cli_value *retries = app_global(a, GLOBAL_RETRIES);
    const cli_value *on_exit = app_global(a, GLOBAL_ON_EXIT);
    if (a->clamps) {
        config.limit_policy = GROBO_LIMIT_CLAMP;
    }
    if (timeout->given) {
        config.timeout_us = (uint32_t)(timeout->number * 1000);
    }
    if (retries->given) {
        config.retries = retries->number > 0 ? (int)retries->number : -1;
    }
    if (on_exit->given) {
        config.on_exit = (grobo_exit_policy)(on_exit->choice + GROBO_EXIT_OFF);
    }
    return config;
}

/* What `auto` tries: for the life of the session. NULL, all ports: for any other device, or where
 * the system cannot list ports. */
static const char *const *ports_of_auto(const app *a)
{
    static choice all;
    if (!conn_is_auto(a) || auto_ports(&all) < 0) {
        return NULL;
    }
    if (!a->hushed) {
        auto_report(a, &all);
    }
    return all.scan;
}

static int make_session(conn *c, const char *device, bool check)
{
    app *a = c->a;
    int error = conn_link_init(c->link);
    if (!error && !output_detach() && !a->stops) {
        error = GROBO_ERR_NOMEM;
    }
    if (error) {
        return error;
    }
    robot_sim(a, &c->link->sim);
    grobo_sim_physics_free(c->link->physics); /* of a session that is gone */
    error = robot_physics(a, &c->link->sim.config, &c->link->physics);
    if (error) {
        return error;
    }
    grobo_robot_config robot = conn_robot_config(a);
    robot.bus.echo = app_global(a, GLOBAL_ECHO)->given > 0;
    const grobo_driver *driver = app_driver(a);
    if (a->robot) {
        driver = trims_driver(&c->link->trims, driver, a->robot);
    }
    grobo_session_config config = {GROBO_SESSION_CONFIG_INIT,
                                   .base = c->link->base,
                                   .device = device,
                                   .baud_bps = (int)conn_baud(a),
                                   .driver = driver,
                                   .driver_ctx = a->robot ? &c->link->trims : NULL,
                                   .robot = &robot,
                                   .sim = &c->link->sim.config,
                                   .scan = ports_of_auto(a),
                                   .skip_check = !check,
                                   .reconnect = a->reconnects,
                                   .on_event = on_session,
                                   .on_robot = on_robot,
                                   .on_tap = on_tap,
                                   .ctx = c->link,
                                   .guard = c->link->guard,
                                   .guard_data = &c->link->guarded,
                                   .guard_bytes = guard_data(a, &c->link->guarded)};
    return grobo_session_new(&config, &c->link->session);
}

static int open_trace(conn *c, app *a, trace *t, const char *device)
{
    trace_line line = {.device = device,
                       .wiring = (grobo_wiring)app_global(c->a, GLOBAL_WIRING)->choice,
                       .baud_bps = (int)conn_baud(c->a)};
    return trace_open_robot(t, a, &line, grobo_now_us());
}

/* That of the command, and that of the shell it runs in. */
static int open_traces(conn *c, const char *device)
{
    int status = open_trace(c, c->a, &c->trace, device);
    if (!status && c->link->owner) {
        status = open_trace(c, c->link->owner, &c->link->trace, device);
    }
    return status;
}

/* The command takes the link, and with it the signals. */
static void take(conn *c, app *a)
{
    memset(c, 0, sizeof *c);
    c->a = a;
    c->link = a->link ? a->link : &c->own;
    if (c->link->session && c->link->link_error) { /* lost: the next command opens it again */
        grobo_session_free(c->link->session);
        c->link->session = NULL;
    }
    if (a->beside) {
        c->own.base = a->beside->base;
        c->own.borrows = true;
        c->own.beside = a->beside->beside;
        a->beside->beside = &c->own;
    }
    if (!c->link->session) {
        c->link->link_error = 0;
        c->link->up = c->link->answered = false;
        c->link->free_joints = 0;
    }
    c->link->user = c;
    c->base = c->link->base;
    c->session = c->link->session;
    c->robot = grobo_session_robot(c->session);
    c->up = c->link->up;
}

/* The open link of a shell, with what this command's options say. */
static int take_over(conn *c, bool check)
{
    grobo_robot_config config = conn_robot_config(c->a);
    int status = open_trace(c, c->a, &c->trace, conn_device(c));
    if (status) {
        return status;
    }
    conn_link_watch(c->link);
    config.bus.baud_bps = conn_baud(c->a);
    c->before = *grobo_robot_get_counters(c->robot);
    int error = grobo_robot_configure(c->robot, &config);
    if (!error) { /* an emergency stop from before the command, maybe */
        error = conn_wait_until(c, is_idle);
    }
    if (!error && check && !c->link->answered) {
        error = conn_wait(c, grobo_robot_check(c->robot));
    }
    if (error && !is_interrupted(c)) {
        return fail_open(c, error);
    }
    c->link->answered |= check;
    return error ? EXIT_ROBOT : EXIT_DONE;
}

static void say_found(conn *c)
{
    const grobo_serial *serial = grobo_session_serial(c->session);
    int answer = serial ? grobo_serial_low_latency(serial) : GROBO_ERR_CLOSED;
    bool is_port = strcmp(conn_device(c), GROBO_DEVICE_SIM) != 0 && !is_tcp(conn_device(c));
    app_detail(c->a, "robot found on %s", conn_device(c));
    if (is_port && !c->a->stops && !c->a->hushed) {
        auto_used(c->a, conn_device(c), conn_is_auto(c->a));
    }
    if (answer < 0 && answer != GROBO_ERR_UNSUPPORTED && answer != GROBO_ERR_CLOSED) {
        app_detail(c->a, "low latency: %s; see 'grctl doctor'", app_error_text(answer));
    }
}

/* How long a guard is waited for, and how often it is looked at. */
enum { GUARD_WAIT_US = 2500000, GUARD_LOOK_US = 50000 };

static bool opened(conn *c)
{
    return c->up;
}

static int try_once(conn *c)
{
    int error = grobo_session_open(c->session);
    return error ? error : conn_wait_until(c, opened);
}

/*
 * The guard of a grctl that died may have the device a moment longer, while it stops the robot.
 * With a last look when it has gone: it may have released the port since the port was tried.
 */
static int open_session(conn *c)
{
    int64_t until_us = grobo_now_us() + GUARD_WAIT_US;
    bool waits = true, waited = false;
    int error = try_once(c);
    while (waits && (error == GROBO_ERR_BUSY || error == GROBO_ERR_NOTFOUND)) {
        waits = guard_has(conn_is_auto(c->a) ? GROBO_DEVICE_AUTO : conn_device(c)) &&
                grobo_now_us() < until_us;
        if (!waits && !waited && error == GROBO_ERR_NOTFOUND) {
            break;
        }
        c->link_error = c->link->link_error = 0;
        if (waits && conn_sleep_until(c, grobo_now_us() + GUARD_LOOK_US) < 0) {
            break;
        }
        waited = true;
        error = try_once(c);
    }
    return error;
}

static int open_device(conn *c, app *a, bool check)
{
    char device[GROBO_DEVICE_MAX_BYTES];
    const char *asked = conn_requested(a);
    grobo_os_cause cause = {0};
    take(c, a);
    if (c->session) {
        return take_over(c, check);
    }
    if (a->portless) {
        return app_fail(a, EXIT_USAGE, "ARG", "nothing says which port line %s has: -d %s=PORT",
                        a->portless, a->portless);
    }
    if (!*asked) {
        return app_fail(a, EXIT_USAGE, "ARG", "--device: an empty name; see 'grctl ports'");
    }
    int error = grobo_port_resolve(asked, device, sizeof device, &cause);
    if (error) {
        return app_fail(a, app_status_of(error), grobo_error_name(error), "%s: %s", asked,
                        *cause.text ? cause.text : app_error_text(error));
    }
    if (a->moves) {
        guard_start(a, device, &c->link->guard);
    }
    error = open_traces(c, device);
    if (error) {
        return error;
    }
    error = make_session(c, device, check);
    if (error) {
        return app_fail_error(a, EXIT_ROBOT, error, "%s", device);
    }
    c->base = c->link->base;
    c->session = c->link->session;
    c->robot = grobo_session_robot(c->session);
    conn_link_watch(c->link);
    error = open_session(c);
    if (error && !is_interrupted(c)) {
        return fail_open(c, error);
    }
    c->link->answered = check && !error;
    c->trip = (grobo_trip_info){.trip = GROBO_TRIP_NONE}; /* of a stop that stands */
    if (!error) {                                         /* one that had not reached the robot */
        error = conn_wait_until(c, is_idle);
    }
    if (!error) {
        say_found(c);
    }
    return error ? EXIT_ROBOT : EXIT_DONE;
}

int conn_open(conn *c, app *a)
{
    return open_device(c, a, true);
}

int conn_open_unchecked(conn *c, app *a)
{
    return open_device(c, a, false);
}

int conn_open_named(conn *c, app *a)
{
    return open_device(c, a, conn_is_auto(a));
}

int conn_open_beside(conn *c, app *a, conn_link *first)
{
    a->beside = first;
    return conn_open(c, a);
}

int conn_open_to_move_beside(conn *c, app *a, conn_link *first)
{
    a->beside = first;
    return conn_open_to_move(c, a);
}

void conn_watch(conn *c, bool on)
{
    grobo_robot_config config = conn_robot_config(c->a);
    if (on) {
        config.sense_interval_us = 0; /* the engine's default */
    }
    (void)grobo_robot_configure(c->robot, &config);
}

int conn_open_to_move(conn *c, app *a)
{
    a->moves = true;
    int status = conn_open(c, a);
    if (status) {
        return status;
    }
    conn_watch(c, true);
    if (grobo_estop_stands(conn_device(c))) {
        return app_fail(a, EXIT_SAFETY, grobo_error_name(GROBO_ERR_LATCHED),
                        "%s: stopped by 'grctl estop'; 'grctl estop --reset' releases it",
                        conn_device(c));
    }
    return EXIT_DONE;
}

void conn_link_idle(conn_link *link, app *a)
{
    conn c = {.a = a};
    if (!link->session || !link->up) {
        return;
    }
    c.robot = grobo_session_robot(link->session);
    conn_watch(&c, true);
}

/* ---- leaving -------------------------------------------------------------------------------- */

/* Has Ctrl-Z ended the command, and the process was not suspended yet? */
static bool is_to_suspend(const conn *c)
{
    return c && c->signal == os_suspension && !c->suspended && c->up && !c->link_error;
}

/* After Ctrl-Z: every robot of the loop stands before the process is suspended, once. */
static void suspend(conn *c)
{
    conn_link *first = c->a->beside ? c->a->beside : c->link;
    if (!is_to_suspend(c)) {
        return;
    }
    for (const conn_link *link = first; link; link = link->beside) {
        conn *u = link->user;
        if (is_to_suspend(u)) {
            u->leaving = true;
            int job = grobo_robot_exit(u->robot, GROBO_EXIT_HOLD);
            u->waiting_for = job > 0 ? job : 0;
        }
    }
    for (const conn_link *link = first; link; link = link->beside) {
        conn *u = link->user;
        if (is_to_suspend(u)) {
            (void)conn_wait_until(u, job_done);
            u->waiting_for = 0;
            u->suspended = true;
        }
    }
    conn_suspend();
}

int conn_end_estop(conn *c)
{
    if (c->trip.trip != GROBO_TRIP_ESTOP || !c->up) {
        return GROBO_OK;
    }
    c->moving = false;
    c->leaving = true;
    return conn_wait_until(c, is_idle);
}

/* What the servos are to do now, or GROBO_EXIT_DEFAULT for nothing. */
static grobo_exit_policy policy_now(const conn *c, int status)
{
    const cli_value *asked = app_global(c->a, GLOBAL_ON_EXIT);
    if (asked->given) {
        return (grobo_exit_policy)(asked->choice + GROBO_EXIT_OFF);
    }
    if (c->moving && (c->signal || status != EXIT_DONE)) {
        return grobo_robot_driver(c->robot)->on_exit;
    }
    return GROBO_EXIT_DEFAULT;
}

static const char *policy_words(grobo_exit_policy policy)
{
    switch (policy) {
    case GROBO_EXIT_OFF:
        return _("are off");
    case GROBO_EXIT_SIT:
        return _("sat the robot down and are off");
    case GROBO_EXIT_HOLD:
    case GROBO_EXIT_DEFAULT:
        break;
    }
    return _("hold where they are");
}

/* Returns 0, or the exit status when it could not be done; that is said. */
static int carry_out_policy(conn *c, int status)
{
    int error = conn_end_estop(c); /* which comes before any policy */
    grobo_exit_policy policy = policy_now(c, status);
    if (error) {
        return conn_fail_job(c, error, _("the emergency stop could not be verified: "));
    }
    if (policy == GROBO_EXIT_DEFAULT || !c->up || c->link_error) {
        return EXIT_DONE;
    }
    c->leaving = true;
    if (policy == GROBO_EXIT_OFF) {
        (void)fall_note(c, GROBO_JOINTS_ALL(conn_model(c)->n_joints));
    }
    error = conn_wait_shown(c, grobo_robot_exit(c->robot, policy), "leaving", 0);
    if (error && !c->signal && !app_global(c->a, GLOBAL_ON_EXIT)->given) {
        return status; /* nobody asked for it, and why the command failed has been said */
    }
    if (error) {
        return conn_fail_job(c, error, _("the servos could not be left as asked: "));
    }
    if (c->signal) {
        app_note(c->a, "interrupted: the servos %s", policy_words(policy));
    }
    app_detail(c->a, "exit policy carried out");
    return EXIT_DONE;
}

/* A shell's link is left as the next command wants to find it. */
static void give_back(conn *c)
{
    grobo_serial *serial = c->session ? grobo_session_serial(c->session) : NULL;
    int baud_bps = (int)conn_baud(c->a);
    conn_link_unwatch(c->link);
    c->link->user = NULL;
    if (!c->up || c->link_error) { /* never came, or is gone */
        grobo_session_free(c->session);
        c->link->session = NULL;
        return;
    }
    if (grobo_robot_job(c->robot) != GROBO_JOB_NONE) {
        grobo_robot_cancel(c->robot);
    }
    if (serial && grobo_serial_baud(serial) != baud_bps) {
        grobo_serial_set_baud(serial, baud_bps);
    }
}

static bool is_quiet(conn *c)
{
    return grobo_robot_is_quiet(c->robot) || grobo_now_us() >= c->quiet_by_us;
}

/*
 * The answer to a reading in the background is not left on the line for who comes next; on a line
 * that is too slow for its joints one reading follows the other for ever.
 */
static void await_quiet(conn *c)
{
    enum { QUIET_US = 1000000 };
    if (c->up && !c->link_error) {
        c->quiet_by_us = grobo_now_us() + QUIET_US;
        (void)conn_wait_until(c, is_quiet);
    }
}

/* Signals are for it no more. */
static void leave_others(conn *c)
{
    for (conn_link *link = c->a->beside; link; link = link->beside) {
        if (link->beside == c->link) {
            link->beside = c->link->beside;
        }
    }
}

int conn_close(conn *c, int status)
{
    int failed = EXIT_DONE;
    suspend(c);
    if (c->session) {
        conn_watch(c, false);
        failed = carry_out_policy(c, status);
        await_quiet(c);
    }
    conn_show_answer(c);
    if (failed) {
        status = failed;
    } else if (c->signal) {
        status = EXIT_SIGNAL + c->signal;
    }
    if (c->link->kept) {
        give_back(c);
    } else {
        grobo_session_free(c->session);
        c->link->session = NULL;
        leave_others(c);
        conn_link_deinit(c->link);
        if (!c->a->stops) { /* it may be an attempt that is repeated */
            app_attach(c->a);
        }
    }
    return trace_close(&c->trace, c->a, status);
}

/* ---- of a shell ----------------------------------------------------------------------------- */

int conn_link_init(conn_link *link)
{
    if (link->base) {
        return GROBO_OK;
    }
    link->base = grobo_loop_new();
    return link->base && conn_signals_init(link) ? GROBO_OK : GROBO_ERR_NOMEM;
}

int conn_link_close(conn_link *link, app *a, int status)
{
    conn c;
    int failed = EXIT_DONE;
    take(&c, a);
    c.signal = link->signal;
    if (c.session) {
        grobo_robot_tripped(c.robot, &c.trip);
        conn_link_watch(link);
        failed = carry_out_policy(&c, status);
        conn_link_unwatch(link);
    }
    if (failed) {
        status = failed;
    } else if (c.signal) {
        status = EXIT_SIGNAL + c.signal;
    }
    grobo_session_free(c.session);
    link->session = NULL;
    link->user = NULL;
    app_attach(a);
    status = trace_close(&link->trace, a, status);
    memset(&link->trace, 0, sizeof link->trace);
    return status;
}

void conn_link_deinit(conn_link *link)
{
    bool borrows = link->borrows;
    conn_signals_deinit(link);
    if (link->base && !borrows) {
        event_base_free(link->base);
    }
    grobo_guard_free(link->guard);
    grobo_sim_physics_free(link->physics);
    memset(link, 0, sizeof *link);
}

void conn_counters(const conn *c, grobo_robot_counters *counters)
{
    *counters = *grobo_robot_get_counters(c->robot);
    counters->motion_frames -= c->before.motion_frames;
    counters->late_frames -= c->before.late_frames;
    counters->stretched -= c->before.stretched;
    counters->clamped -= c->before.clamped;
}

json_t *conn_link_json(const conn *c)
{
    const grobo_bus_stats *n = grobo_robot_get_bus_stats(c->robot);
    return json_pack("{s:I,s:I,s:I,s:I,s:I,s:I}", "tx_frames", (json_int_t)n->tx_frames,
                     "rx_frames", (json_int_t)n->rx_frames, "timeouts", (json_int_t)n->timeouts,
                     "retries", (json_int_t)n->retries, "bad_sums", (json_int_t)n->bad_sums,
                     "resync_bytes", (json_int_t)n->resync_bytes);
}
