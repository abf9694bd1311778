/* SPDX-License-Identifier: MIT */
/* A session's states: opening, checking, up, lost, coming back; and what it is told. */
#include <stdio.h>
#include <string.h>

#include "src/base/sized.h"
#include "src/link/guard/guard.h"
#include "src/link/serial/loop.h"
#include "src/link/session/session.h"
#include "src/robot/lines.h"
#include "src/robot/query.h"
#include "src/robot/robot.h"

/* ---- closing ------------------------------------------------------------------------------ */

/* Until a robot has answered, nothing is sent to whoever is there but the check. */
static void configure(grobo_session *session, bool up)
{
    /* Cannot fail: the configuration was taken before. */
    (void)grobo_i_robot_configure(&session->robot, &session->robot_config, up);
}

/* Takes the line away from the engine, which tells what that ends. */
static void drop_line(grobo_session *session)
{
    if (session->state == GROBO_SESSION_CHECKING || session->state == GROBO_SESSION_UP) {
        grobo_robot_link_down(&session->robot, grobo_now_us());
        configure(session, false);
    }
    grobo_i_session_guard_release(session);
    for (int i = 0; i < session->n_wires; i++) {
        grobo_serial_close(session->wire[i].serial);
        session->wire[i].backlog_bytes = 0;
        session->wire[i].opened = false;
    }
    session->lost_error = 0;
    session->check_job = 0;
    session->check_ended = false;
}

static void close_now(grobo_session *session)
{
    drop_line(session);
    grobo_i_session_scan_end(session);
    grobo_i_session_estop_end(session);
    session->state = GROBO_SESSION_CLOSED;
    session->closing = false;
}

static void destroy(grobo_session *session)
{
    const grobo_mem *mem = session->config.mem;

    grobo_i_session_guard_free(session);
    grobo_i_session_wake_free(session);
    grobo_timer_free(session->timer);
    for (int i = 0; i < session->n_wires; i++) {
        grobo_serial_free(session->wire[i].serial);
    }
    grobo_i_session_estop_end(session);
    grobo_i_session_scan_end(session);
    for (int i = 0; i < session->n_wires; i++) {
        grobo_i_session_sim_free(&session->wire[i]);
    }
    grobo_i_free(mem, session, session->bytes);
}

/* ---- opening ------------------------------------------------------------------------------ */

/* Which of several could not be opened. */
static void name_port(grobo_session *session, const session_wire *wire)
{
    const grobo_os_cause cause = session->cause;

    (void)snprintf(session->cause.text, sizeof session->cause.text, "%.60s: %.60s", wire->path,
                   cause.text);
}

static int open_device(grobo_session *session, const char *device)
{
    int r = session->line->open(&session->wire[0], device);

    if (r < 0 && session->n_wires > 1) {
        name_port(session, &session->wire[0]);
    }
    for (int i = 1; i < session->n_wires && r >= 0; i++) {
        session_wire *wire = &session->wire[i];

        r = session->line->open(wire, session->was_up ? wire->stable : wire->path);
        if (r < 0) {
            name_port(session, wire);
        }
    }
    for (int i = 0; i < session->n_wires && r < 0; i++) {
        grobo_serial_close(session->wire[i].serial);
    }

    session->turn_us = 0; /* that may take its time */
    if (r >= 0) {
        session->state = GROBO_SESSION_OPENING;
    }
    return r;
}

/* Opens the first port of the scan, from the present one on, that can be opened. */
static int open_next(grobo_session *session)
{
    session_scan *scan = session->scan;

    for (; scan->at < scan->count; scan->at++) {
        if (open_device(session, scan->path[scan->at]) >= 0) {
            return GROBO_OK;
        }
    }
    session->cause.code = 0;
    snprintf(session->cause.text, sizeof session->cause.text, "no robot on any of %d serial ports",
             scan->count);
    grobo_i_session_scan_end(session);
    return GROBO_ERR_NOTFOUND;
}

/* ---- losing ------------------------------------------------------------------------------- */

static void wait_for_return(grobo_session *session)
{
    session->state = GROBO_SESSION_WAITING;
    session->retry_us = grobo_now_us() + session->pause_us;
    session->pause_us *= 2;
    if (session->pause_us > GROBO_RECONNECT_MAX_US) {
        session->pause_us = GROBO_RECONNECT_MAX_US;
    }
}

static void lose_robot(grobo_session *session, int error)
{
    drop_line(session);
    session->pause_us = GROBO_RECONNECT_FIRST_US;
    if (session->config.reconnect) {
        wait_for_return(session);
    } else {
        session->state = GROBO_SESSION_CLOSED;
    }
    grobo_i_session_say(session, GROBO_SESSION_EVENT_LOST, error);
}

/* An attempt came to nothing: the next port, the next time, or the end. */
static void lose_attempt(grobo_session *session, int error)
{
    drop_line(session);
    if (session->scan != NULL) {
        session->scan->at++;
        error = open_next(session);
        if (error >= 0) {
            return;
        }
    } else if (session->was_up && session->config.reconnect) {
        wait_for_return(session);
        return;
    }
    session->state = GROBO_SESSION_CLOSED;
    grobo_i_session_say(session, GROBO_SESSION_EVENT_FAILED, error);
}

static void lose(grobo_session *session, int error)
{
    switch (session->state) {
    case GROBO_SESSION_UP:
        lose_robot(session, error);
        break;
    case GROBO_SESSION_OPENING:
    case GROBO_SESSION_CHECKING:
    case GROBO_SESSION_WAITING:
        lose_attempt(session, error);
        break;
    case GROBO_SESSION_CLOSED:
        break;
    }
}

/* ---- checking ----------------------------------------------------------------------------- */

static void be_up(grobo_session *session)
{
    grobo_i_session_scan_end(session);
    /* By now the system has given it its names. The simulator goes by none. */
    for (int i = 0; i < session->n_wires; i++) {
        session_wire *wire = &session->wire[i];

        if (grobo_port_identity(wire->used, wire->stable, sizeof wire->stable) < 0) {
            memcpy(wire->stable, wire->used, sizeof wire->stable);
        }
    }
    session->state = GROBO_SESSION_UP;
    session->was_up = true;
    configure(session, true);
    grobo_i_session_estop_arm(session);
    grobo_i_session_guard_take(session);
    session->turn_us = 0;
    grobo_i_session_say(session, GROBO_SESSION_EVENT_UP, GROBO_OK);
}

/* Who is there? Asked anew behind an emergency stop, which goes before everything. */
static void ask_who(grobo_session *session)
{
    session->check_job =
        session->config.skip_check ? GROBO_ERR_UNSUPPORTED : grobo_robot_check(&session->robot);
    if (session->check_job < 0 && grobo_robot_job(&session->robot) != GROBO_JOB_ESTOP) {
        /* A driver without a check takes who is there for its robot. */
        session->check_result =
            session->check_job == GROBO_ERR_UNSUPPORTED ? GROBO_OK : session->check_job;
        session->check_ended = true;
    }
}

/* The line is open. */
static void start_check(grobo_session *session)
{
    session->state = GROBO_SESSION_CHECKING;
    session->check_ended = false;
    if (session->scan == NULL) { /* of many ports only the robot's counts */
        grobo_i_session_estop_arm(session);
    }
    grobo_robot_link_up(&session->robot, grobo_now_us());
    ask_who(session);
}

static void end_check(grobo_session *session)
{
    int result = session->check_result;

    session->check_ended = false;
    session->check_job = 0;
    if (result >= 0) {
        be_up(session);
    } else {
        session->cause.code = 0;
        snprintf(session->cause.text, sizeof session->cause.text, "no answer to the check");
        lose(session, result);
    }
}

static void on_robot(void *ctx, const grobo_event *event)
{
    grobo_session *session = ctx;

    if (session->freed) {
        return;
    }
    bool checking = session->state == GROBO_SESSION_CHECKING;
    bool job = event->kind == GROBO_EVENT_JOB;
    bool estop = job && event->u.job.kind == GROBO_JOB_ESTOP;
    bool stop = event->kind == GROBO_EVENT_TRIP || estop;

    if (estop) {
        grobo_i_session_estop_ended(session, event->u.job.result);
    }

    if (stop) {
        grobo_i_session_note_latch(session);
    }
    if (checking && job && event->u.job.number == session->check_job) {
        /* Only an emergency stop takes its place. */
        session->check_ended = event->u.job.result != GROBO_ERR_CANCELED;
        session->check_result = event->u.job.result;
    }
    if (checking && job && stop) {
        ask_who(session);
    }
    if (!checking || stop) {
        grobo_i_session_guard_tell(session); /* who is told may hold up the loop */
        grobo_i_session_tell_robot(session, event);
    }
}

/* ---- the engine's host --------------------------------------------------------------------- */

static int64_t on_clock(void *ctx)
{
    (void)ctx;
    return grobo_now_us();
}

static bool is_elsewhere(const grobo_session *session)
{
    return session->share.is_elsewhere != NULL && session->share.is_elsewhere(session->share.ctx);
}

static void on_lock(void *ctx)
{
    const grobo_session *session = ctx;

    session->share.lock(session->share.ctx);
}

static void on_unlock(void *ctx)
{
    const grobo_session *session = ctx;

    session->share.unlock(session->share.ctx);
}

/* Emergency stops that were not posted count as those do, see grobo_runner_reset(). */
static void count_estops(grobo_session *session)
{
    grobo_i_lock(&session->robot);
    unsigned estops = (unsigned)session->robot.counters.estops;
    grobo_i_session_note_latch(session); /* a stop, or a reset */
    grobo_i_unlock(&session->robot);
    if (atomic_load(&session->seen_estops) != estops &&
        atomic_exchange(&session->seen_estops, estops) != estops &&
        !atomic_load(&session->obeying)) {
        atomic_fetch_add(&session->estops, 1);
    }
}

/* Lets the engine send what it has to, and asks it for its next deadline. */
static void pump(grobo_session *session)
{
    grobo_i_session_enter(session);
    grobo_i_session_leave(session);
}

static void on_request(void *ctx)
{
    grobo_session *session = ctx;

    count_estops(session);
    if (is_elsewhere(session)) {
        grobo_i_session_wake(session);
    } else {
        pump(session);
    }
}

static bool on_stopped(void *ctx)
{
    return grobo_session_is_latched(ctx);
}

/* One that was set since the last look is obeyed, not cleared. */
static int on_reset(void *ctx)
{
    grobo_session *session = ctx;
    grobo_trip_info trip;
    int r = GROBO_OK;

    if (is_elsewhere(session)) {
        return GROBO_ERR_STATE; /* the marks of other programs belong to the loop */
    }
    grobo_i_session_enter(session);
    grobo_i_session_obey(session); /* what was posted came before */
    grobo_i_session_estop_look_anew(session);
    grobo_i_session_estop_look(session);
    grobo_robot_tripped(&session->robot, &trip);
    if (grobo_robot_job(&session->robot) == GROBO_JOB_ESTOP) {
        r = GROBO_ERR_STATE;
    } else if (trip.trip == GROBO_TRIP_ESTOP) {
        r = grobo_i_session_estop_clear(session);
    }
    session->depth--; /* the request itself pumps */
    return r;
}

static void set_host(grobo_session *session)
{
    const bool shared = session->share.lock != NULL;
    const grobo_robot_host host = {
        .clock = on_clock,
        .wake = on_request,
        .is_stopped = on_stopped,
        .may_reset = on_reset,
        .lock = shared ? on_lock : NULL,
        .unlock = shared ? on_unlock : NULL,
        .ctx = session,
    };

    grobo_robot_set_host(&session->robot, &host);
}

void grobo_i_session_share(grobo_session *session, const session_share *share)
{
    session->share = *share;
    set_host(session);
}

/* ---- the loop's calls --------------------------------------------------------------------- */

/* The last leave does what callbacks asked for, and pumps. */
static void on_leave(grobo_session *session)
{
    if (session->depth == 1 && !session->freed) {
        grobo_i_session_report_slow(session);
    }
    if (session->depth == 1 && !session->freed) {
        grobo_i_session_obey(session);
        grobo_i_session_estop_look(session);
    }
    /* Still inside: the callbacks of what follows may come back here. */
    while (session->depth == 1 && session->check_ended && !session->closing) {
        end_check(session);
    }
    if (session->depth == 1 && !session->closing && grobo_i_session_has_stopped(session)) {
        lose(session, session->lost_error);
    }
    if (session->depth == 1 && session->closing) {
        close_now(session);
    }
    session->depth--;
    if (session->depth > 0) {
        return;
    }
    if (session->freed) {
        destroy(session);
    } else {
        grobo_i_session_send(session);
        grobo_i_session_estop_answer(session);
    }
}

static bool all_opened(const grobo_session *session)
{
    bool all = true;

    for (int i = 0; i < session->n_wires; i++) {
        all = all && session->wire[i].opened;
    }
    return all;
}

static void on_serial(void *ctx, grobo_serial *serial, grobo_serial_event event, int error)
{
    session_wire *wire = ctx;
    grobo_session *session = wire->session;

    grobo_i_session_enter(session);
    switch (event) {
    case GROBO_SERIAL_OPENED:
        wire->opened = true;
        if (all_opened(session)) {
            start_check(session);
        }
        break;
    case GROBO_SERIAL_DRAINED:
        break;
    case GROBO_SERIAL_UNPLUGGED:
    case GROBO_SERIAL_FAILED:
        session->cause = *grobo_serial_cause(serial);
        if (session->n_wires > 1 && session->state == GROBO_SESSION_UP) {
            grobo_i_session_lose_wire(wire, error);
        } else {
            lose(session, error);
        }
        break;
    }
    grobo_i_session_leave(session);
}

/* With a line: what it has, and the time. */
static void look(grobo_session *session)
{
    int r = grobo_i_session_step(session);

    if (r < 0) {
        lose(session, r);
        grobo_robot_step(&session->robot, grobo_now_us());
    }
}

void grobo_i_session_look(grobo_session *session)
{
    grobo_i_session_enter(session);
    if (session->state == GROBO_SESSION_CHECKING || session->state == GROBO_SESSION_UP) {
        look(session);
    }
    grobo_i_session_leave(session);
}

/* The line is lost. The time may be that of a look at the marks. */
static void try_again(grobo_session *session)
{
    if (grobo_now_us() >= session->retry_us) {
        /* By the name that stays: the old one may be another device's by now. */
        int r = open_device(session, session->wire[0].stable);

        if (r < 0) {
            lose(session, r);
        }
    }
}

static void attend_time(grobo_session *session)
{
    grobo_i_session_enter(session);
    switch (session->state) {
    case GROBO_SESSION_OPENING:
        start_check(session);
        break;
    case GROBO_SESSION_CHECKING:
    case GROBO_SESSION_UP:
        look(session);
        break;
    case GROBO_SESSION_WAITING:
        try_again(session);
        break;
    case GROBO_SESSION_CLOSED:
        break;
    }
    grobo_i_session_leave(session);
}

static void on_time(void *ctx, grobo_timer *timer, int64_t late_us)
{
    (void)timer;
    (void)late_us;
    attend_time(ctx);
}

static void on_guard(evutil_socket_t fd, short what, void *ctx)
{
    grobo_session *session = ctx;

    (void)fd;
    (void)what;
    grobo_i_session_enter(session);
    if (grobo_i_session_guard_hear(session)) {
        lose(session, GROBO_ERR_STALLED);
        session->config.guard->taken = false;
    }
    grobo_i_session_leave(session);
}

/* ---- the public functions ----------------------------------------------------------------- */

static int set_device(grobo_session *session, const char *device)
{
    if (strlen(device) >= sizeof session->device) {
        return GROBO_ERR_CAP;
    }
    memmove(session->device, device, strlen(device) + 1);
    memcpy(session->wire[0].used, session->device, sizeof session->wire[0].used);
    session->line = strcmp(session->device, GROBO_DEVICE_SIM) == 0 ? &grobo_i_session_sim
                                                                   : &grobo_i_session_port;
    return session->n_wires > 1 ? grobo_i_session_set_paths(session) : GROBO_OK;
}

static int fill(grobo_session *session, const grobo_session_config *config)
{
    const grobo_driver *driver = config->driver;
    int baud_bps = config->baud_bps > 0 ? config->baud_bps : GROBO_BAUD_DEFAULT_BPS;
    const grobo_lines *lines = grobo_driver_lines(driver);

    session->n_wires = lines == NULL ? 1 : lines->n_lines;
    for (int i = 0; i < session->n_wires; i++) {
        session->wire[i].session = session;
        session->wire[i].line = i;
    }
    session->robot.driver = driver; /* until the engine is made */
    int r = set_device(session, config->device);

    session->wake_socket[0] = session->wake_socket[1] = GROBO_SOCKET_NULL;
    session->mark_socket = GROBO_SOCKET_NULL;
    if (r < 0) {
        return r;
    }
    session->config = *config;
    session->config.device = NULL;
    session->config.robot = NULL;
    session->config.sim = NULL;
    if (grobo_i_sized_take(&session->robot_config, sizeof session->robot_config, config->robot) <
            0 ||
        grobo_i_sized_take(&session->sim_config, sizeof session->sim_config, config->sim) < 0) {
        return GROBO_ERR_ARG;
    }
    if (session->robot_config.bus.baud_bps == 0) {
        session->robot_config.bus.baud_bps = (uint32_t)baud_bps;
    }
    session->sim_config.wiring = grobo_driver_wiring(driver);
    session->sim_config.echo = session->robot_config.bus.echo;
    if (session->sim_config.model == NULL) {
        session->sim_config.model = driver->model;
    }
    if (session->sim_config.baud_bps == 0) {
        session->sim_config.baud_bps = (uint32_t)baud_bps;
    }
    r = grobo_robot_init_sized(&session->robot, grobo_i_robot_bytes(driver), driver,
                               config->driver_ctx, &session->robot_config, grobo_now_us());
    set_host(session);
    return r;
}

static int make_serial(grobo_session *session, session_wire *wire)
{
    const grobo_lines *lines = grobo_driver_lines(session->robot.driver);
    const grobo_driver *driver = grobo_i_line_driver(&session->robot, wire->line, NULL);
    const grobo_serial_config serial = {
        GROBO_SERIAL_CONFIG_INIT,
        .baud_bps = lines != NULL && lines->line[wire->line].baud_bps > 0
                        ? (int)lines->line[wire->line].baud_bps
                        : session->config.baud_bps,
        .format = {.parity = driver->protocol->parity,
                   .stop_bits = session->config.format.stop_bits,
                   .rs485 = session->config.format.rs485},
        .base = session->config.base,
        .mode = GROBO_SERIAL_ASYNC,
        .tx_queue_bytes = GROBO_FRAME_MAX_BYTES, /* a frame is sent when nothing waits */
        .on_data = grobo_i_session_on_data,
        .on_event = on_serial,
        .on_tap = session->config.on_tap != NULL ? grobo_i_session_tell_tap : NULL,
        .ctx = wire,
        .mem = session->config.mem,
    };
    return grobo_serial_new(&serial, &wire->serial);
}

static int make_parts(grobo_session *session)
{
    int r = GROBO_OK;

    for (int i = 0; i < session->n_wires && r >= 0; i++) {
        r = make_serial(session, &session->wire[i]);
    }
    if (r >= 0) {
        r = grobo_timer_new(session->config.base, on_time, session, session->config.mem,
                            &session->timer);
    }
    if (r >= 0) {
        r = grobo_i_session_guard_new(session, on_guard);
    }
    session->on_time = attend_time;
    return r < 0 ? r : grobo_i_session_wake_new(session);
}

int grobo_session_new(const grobo_session_config *config, grobo_session **session)
{
    grobo_session_config taken;
    grobo_session *made;
    int r;

    if (session == NULL || grobo_i_sized_take(&taken, sizeof taken, config) < 0 ||
        taken.base == NULL || taken.device == NULL || taken.baud_bps < 0) {
        return GROBO_ERR_ARG;
    }
    if (taken.driver == NULL) {
        taken.driver = grobo_gr001_driver(GROBO_WIRING_BOARD);
    }
    if (grobo_driver_check(taken.driver) < 0) {
        return GROBO_ERR_ARG;
    }
    config = &taken;
    size_t bytes = offsetof(grobo_session, robot) + grobo_i_robot_bytes(taken.driver);
    made = grobo_i_new(config->mem, bytes);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->bytes = bytes;
    made->on_leave = on_leave;
    r = fill(made, config);
    made->config.mem = config->mem;
    if (r >= 0) {
        r = make_parts(made);
    }
    if (r < 0) {
        destroy(made);
        return r;
    }
    grobo_robot_on_event(&made->robot, on_robot, made);
    configure(made, false);
    *session = made;
    return GROBO_OK;
}

void grobo_session_free(grobo_session *session)
{
    if (session == NULL) {
        return;
    }
    grobo_i_session_enter(session);
    session->freed = true;
    session->closing = true;
    grobo_i_session_leave(session);
}

/* Which port is which line, nobody can find out by asking: each must be told. */
static int open_lines(grobo_session *session)
{
    const char *name = grobo_i_session_without_port(session);

    if (name != NULL) {
        session->cause.code = 0;
        snprintf(session->cause.text, sizeof session->cause.text, "line '%.40s' has no port", name);
        return GROBO_ERR_NOTFOUND;
    }
    return open_device(session, session->wire[0].path);
}

int grobo_session_open(grobo_session *session)
{
    if (session == NULL) {
        return GROBO_ERR_ARG;
    }
    int r;

    if (session->state != GROBO_SESSION_CLOSED || session->closing) {
        return GROBO_ERR_STATE;
    }
    session->was_up = false;
    r = grobo_i_session_listen(session, false);
    if (r < 0) {
        return r;
    }
    if (session->n_wires > 1) {
        r = open_lines(session);
    } else if (strcmp(session->device, GROBO_DEVICE_AUTO) != 0) {
        r = open_device(session, session->device);
    } else {
        r = grobo_i_session_scan_begin(session);
        if (r >= 0) {
            r = open_next(session);
        }
    }
    pump(session);
    return r;
}

void grobo_session_close(grobo_session *session)
{
    if (session == NULL) {
        return;
    }
    grobo_i_session_enter(session);
    session->closing = true;
    grobo_i_session_leave(session);
}

int grobo_session_set_device(grobo_session *session, const char *device)
{
    if (session == NULL || device == NULL) {
        return GROBO_ERR_ARG;
    }
    return session->state != GROBO_SESSION_CLOSED ? GROBO_ERR_STATE : set_device(session, device);
}

int grobo_session_configure(grobo_session *session, const grobo_robot_config *config)
{
    if (session == NULL) {
        return GROBO_ERR_ARG;
    }
    int r = grobo_i_robot_configure(&session->robot, config, session->state == GROBO_SESSION_UP);

    if (r >= 0) {
        grobo_bus_config bus = session->robot_config.bus;

        /* Cannot fail: the engine has taken it. */
        (void)grobo_i_sized_take(&session->robot_config, sizeof session->robot_config, config);
        session->robot_config.bus = bus;
        pump(session);
    }
    return r;
}

/* ---- what it knows, its parts ------------------------------------------------------------- */

grobo_session_state grobo_session_get_state(const grobo_session *session)
{
    return session == NULL ? GROBO_SESSION_CLOSED : session->state;
}

const char *grobo_session_device(const grobo_session *session)
{
    return session == NULL ? NULL : session->n_wires > 1 ? session->device : session->wire[0].used;
}

const grobo_os_cause *grobo_session_cause(const grobo_session *session)
{
    return session == NULL ? NULL : &session->cause;
}

grobo_robot *grobo_session_robot(grobo_session *session)
{
    return session == NULL ? NULL : &session->robot;
}

grobo_sim *grobo_session_sim(grobo_session *session)
{
    return session == NULL ? NULL : session->wire[0].sim;
}

grobo_serial *grobo_session_serial(grobo_session *session)
{
    return session == NULL ? NULL : session->wire[0].serial;
}

int grobo_session_tapped(const grobo_session *session)
{
    return session == NULL ? GROBO_ERR_ARG : session->tapped;
}

void grobo_session_bytes(const grobo_session *session, uint64_t *tx_bytes, uint64_t *rx_bytes)
{
    if (session == NULL || tx_bytes == NULL || rx_bytes == NULL) {
        return;
    }
    *tx_bytes = session->sim_tx_bytes;
    *rx_bytes = session->sim_rx_bytes;
    for (int i = 0; i < session->n_wires; i++) {
        grobo_serial_counters counters;

        grobo_serial_get_counters(session->wire[i].serial, &counters);
        *tx_bytes += counters.tx_bytes;
        *rx_bytes += counters.rx_bytes;
    }
}
