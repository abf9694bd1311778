/* SPDX-License-Identifier: MIT */
/*
 * The guard's process. It waits for one of: a message of the program, the program's death, the
 * program being stopped or silent while joints move, the line's hang-up. For death, stop and
 * silence it runs the engine of robot.h on the port it was given: the exit policy is carried out by
 * the same code that `grctl stop` uses. What that takes it has as soon as it has the port: later
 * the system may have neither descriptors nor memory for it.
 */
#include <string.h>

#include <grobo/core/lines.h>
#include <grobo/core/serial.h>
#include <grobo/core/static.h>

#include "src/base/instant.h"
#include "src/base/sized.h"
#include "src/link/guard/estop.h"
#include "src/link/guard/guard.h"
#include "src/link/serial/loop.h"

/* Of GROBO_GUARD_BOUND_US: what stopping may take, and what it leaves for switching torque off. */
#define STOP_US (GROBO_GUARD_BOUND_US - 300000)
#define OFF_US 600000

/* So much of a silence counts between two looks: where this process is held up, the program may
 * have been too. */
#define LOOK_MAX_US 100000

/* A frame on its way to the board, on to the servo, and its reply; and the servo's thinking. */
#define QUIET_BYTES (3 * GROBO_FRAME_MAX_BYTES)
#define QUIET_EXTRA_US 10000
#define QUIET_MAX_US 400000
#define BITS_A_BYTE 10

typedef struct guard_run {
    const grobo_guard_program *program;
    grobo_i_guard_watch watch;
    guard_shared *shared; /* `own`, or mapped */
    guard_shared own;
    /* since when nothing was heard of the program */
    unsigned beats;
    int64_t silent_us, looked_us;
    /* what comes */
    struct {
        guard_message message;
        uint8_t data[GROBO_GUARD_DATA_BYTES];
    } in;
    size_t have;
    grobo_handle came; /* with the message that is not complete yet */
    /* the port it has */
    bool has_port;
    bool lent; /* the robot was stopped: another program may have the port */
    grobo_i_device_names names;
    uint64_t holder; /* grobo_i_estop_holder_stamp() of the program */
    grobo_handle line;
    guard_message how;
    const grobo_driver *driver;
    void *driver_ctx;
    int n_lines;                        /* of its ports, the first n_lines are there */
    grobo_handle more[GROBO_LINES_MAX]; /* of the lines behind the first one */
    grobo_port *port[GROBO_LINES_MAX];
    const grobo_port_ops *ops[GROBO_LINES_MAX];
    bool gone[GROBO_LINES_MAX]; /* while the robot is stopped */
    /* the engine, while it stops the robot */
    grobo_robot robot;
    int ended_job, result; /* the job that ended last */
} guard_run;

/* ---- the port it has ---------------------------------------------------------------------- */

static void forget(guard_run *run)
{
    run->has_port = run->lent = false;
    run->line = GROBO_HANDLE_NULL;
    run->n_lines = 1;
}

/* The program has released the device, or it is gone. */
static void drop(guard_run *run)
{
    if (run->has_port) {
        grobo_i_guard_drop(run->line);
    }
    for (int i = 1; i < run->n_lines; i++) {
        grobo_i_guard_drop(run->more[i]);
    }
    forget(run);
}

static const grobo_port_ops *ops_of(const guard_message *message)
{
    return message->connection ? grobo_port_tcp_ops() : grobo_port_serial_ops();
}

/* The port of another line, which comes before that of the first one. */
static void take_more(guard_run *run)
{
    if (run->has_port) {
        drop(run);
    }
    if (run->came != GROBO_HANDLE_NULL && run->n_lines < GROBO_LINES_MAX) {
        run->ops[run->n_lines] = ops_of(&run->in.message);
        run->more[run->n_lines++] = run->came;
        run->came = GROBO_HANDLE_NULL;
    }
}

static void say(guard_run *run, char word)
{
    /* Nobody may be left to hear it. */
    (void)grobo_i_guard_send(run->watch.socket, &word, 1, GROBO_HANDLE_NULL);
}

/* False where it cannot be had. */
static bool share(guard_run *run)
{
    void *at;

    if (run->came == GROBO_HANDLE_NULL || run->shared != &run->own ||
        grobo_i_guard_map(run->came, sizeof *run->shared, &at) < 0) {
        return false;
    }
    run->shared = at;
    return true;
}

static void unshare(guard_run *run)
{
    if (run->shared != &run->own) {
        grobo_i_guard_unmap(run->shared, sizeof *run->shared);
    }
}

/* The line is the guard's from now on. False: the program is just giving it up. */
static bool claim(guard_run *run)
{
    unsigned had = GUARD_LINE_PROGRAM;

    return atomic_compare_exchange_strong(&run->shared->line, &had, GUARD_LINE_GUARD) ||
           had == GUARD_LINE_GUARD;
}

static const grobo_driver *find_driver(guard_run *run)
{
    const guard_message *how = &run->in.message;
    const grobo_guard_program *program = run->program;

    run->driver_ctx = NULL;
    if (program->driver != NULL) {
        return program->driver(program->ctx, how->driver, how->wiring, run->in.data,
                               how->data_bytes, &run->driver_ctx);
    }
    return strcmp(how->driver, "GR001") == 0 && how->data_bytes == 0
               ? grobo_gr001_driver(how->wiring)
               : NULL;
}

static void take(guard_run *run)
{
    const grobo_lines *lines;

    if (run->has_port) {
        drop(run);
    }
    run->driver = find_driver(run);
    lines = grobo_driver_lines(run->driver);
    if (run->came == GROBO_HANDLE_NULL || run->driver == NULL ||
        run->n_lines != (lines == NULL ? 1 : lines->n_lines)) {
        drop(run);
        say(run, GUARD_REFUSED);
        return;
    }
    run->has_port = true;
    run->line = run->came;
    run->came = GROBO_HANDLE_NULL;
    run->how = run->in.message;
    run->ops[0] = ops_of(&run->how);
    run->own.line = GUARD_LINE_PROGRAM;
    grobo_i_device_names_find(run->how.device, &run->names);
    run->holder = grobo_i_estop_holder_stamp(&run->names);
}

/* False: it asks for what this system does not have. */
static bool obey(guard_run *run)
{
    bool can = true;

    run->in.message.driver[sizeof run->in.message.driver - 1] = '\0';
    run->in.message.device[sizeof run->in.message.device - 1] = '\0';
    switch ((guard_kind)run->in.message.kind) {
    case GUARD_TAKE:
        take(run);
        break;
    case GUARD_STATE:
        run->how.policy = run->in.message.policy;
        run->how.moves = run->in.message.moves;
        break;
    case GUARD_RELEASE:
        drop(run);
        break;
    case GUARD_SHARE:
        can = share(run);
        break;
    case GUARD_MORE:
        take_more(run);
        break;
    }
    if (run->came != GROBO_HANDLE_NULL) {
        grobo_i_guard_drop(run->came);
        run->came = GROBO_HANDLE_NULL;
    }
    return can;
}

/* Takes what has come of a message. False at the end of the stream, or where it makes no sense. */
static bool take_some(guard_run *run)
{
    size_t want = sizeof run->in.message;
    int got;

    if (run->have >= want) {
        want += run->in.message.data_bytes;
    }
    got = grobo_i_guard_receive(run->watch.socket, (char *)&run->in + run->have, want - run->have,
                                &run->came);
    if (got < 0) {
        return false;
    }
    run->have += (size_t)got;
    if (run->have < sizeof run->in.message) {
        return true;
    }
    if (run->in.message.magic != GUARD_MAGIC || run->in.message.data_bytes > sizeof run->in.data) {
        return false;
    }
    if (run->have == sizeof run->in.message + run->in.message.data_bytes) {
        run->have = 0;
        return obey(run);
    }
    return true;
}

/* ---- stopping the robot ------------------------------------------------------------------- */

static void on_robot(void *ctx, const grobo_event *event)
{
    guard_run *run = ctx;

    if (event->kind == GROBO_EVENT_JOB) {
        run->ended_job = event->u.job.number;
        run->result = event->u.job.result;
    }
}

/* A line of several that is gone keeps the others from nothing. @return < 0: all are. */
static int lose(guard_run *run, int line, int error)
{
    bool any = false;

    run->gone[line] = true;
    for (int i = 0; i < run->n_lines; i++) {
        any = any || !run->gone[i];
    }
    grobo_robot_line_down(&run->robot, line, grobo_now_us());
    return any ? GROBO_OK : error;
}

/* Reads what comes in the span; 0: nothing. */
static int read_line(guard_run *run, int line, uint8_t *bytes, size_t size, int64_t span_us)
{
    const grobo_port_ops *ops = run->ops[line];
    grobo_os_cause cause;
    int got = grobo_port_wait(ops->socket(run->port[line]), GROBO_PORT_READABLE, span_us);

    return got > 0 ? ops->read(run->port[line], bytes, size, &cause) : got;
}

/* The same of any line, which *line is then. Several are looked at in turn, for so long each. */
#define TURN_US 500
static int read_until(guard_run *run, int *line, uint8_t *bytes, size_t size, int64_t span_us)
{
    int64_t end_us = grobo_now_us() + span_us;
    int got = 0;

    if (run->n_lines == 1) {
        *line = 0;
        return read_line(run, 0, bytes, size, span_us);
    }
    do {
        for (*line = 0; *line < run->n_lines; (*line)++) {
            if (run->gone[*line]) {
                continue;
            }
            got = read_line(run, *line, bytes, size, grobo_i_sooner(span_us, TURN_US));
            got = got < 0 ? lose(run, *line, got) : got;
            if (got != 0) {
                return got;
            }
        }
    } while (grobo_now_us() < end_us);
    return 0;
}

static uint32_t slowest_bps(const guard_run *run)
{
    const grobo_lines *lines = grobo_driver_lines(run->driver);
    uint32_t found_bps = run->how.robot.bus.baud_bps;

    for (int i = 0; lines != NULL && i < lines->n_lines; i++) {
        uint32_t own_bps = lines->line[i].baud_bps;

        found_bps = own_bps > 0 && (i == 0 || own_bps < found_bps) ? own_bps : found_bps;
    }
    return found_bps;
}

/* What the program sent last leaves, and its replies come; < 0: the line is gone. */
static int await_quiet(guard_run *run)
{
    uint32_t baud_bps = slowest_bps(run);
    int64_t quiet_us = QUIET_EXTRA_US + (int64_t)QUIET_BYTES * BITS_A_BYTE * 1000000 /
                                            (baud_bps > 0 ? baud_bps : GROBO_BAUD_DEFAULT_BPS);
    int64_t now_us = grobo_now_us();
    int64_t end_us = now_us + QUIET_MAX_US;
    int64_t quiet_until_us = grobo_i_sooner(now_us + quiet_us, end_us);
    int got = 0;

    while (got >= 0 && now_us < quiet_until_us) {
        uint8_t dropped[256];
        int line;

        got = read_until(run, &line, dropped, sizeof dropped, quiet_until_us - now_us);
        now_us = grobo_now_us();
        if (got > 0) {
            quiet_until_us = grobo_i_sooner(now_us + quiet_us, end_us);
        }
    }
    return got;
}

/* Writes a whole frame; a line that takes nothing is as good as gone. */
static int put(guard_run *run, int line, const uint8_t *frame, size_t size, int64_t end_us)
{
    const grobo_port_ops *ops = run->ops[line];
    grobo_port *port = run->port[line];

    while (size > 0) {
        grobo_os_cause cause;
        int done = ops->write(port, frame, size, &cause);

        if (done == 0) {
            int64_t left_us = end_us - grobo_now_us();

            done = left_us > 0 ? grobo_port_wait(ops->socket(port), GROBO_PORT_WRITABLE, left_us)
                               : GROBO_ERR_TIMEOUT;
            if (done >= 0) {
                continue;
            }
        }
        if (done < 0) {
            return done;
        }
        frame += done;
        size -= (size_t)done;
    }
    return GROBO_OK;
}

static int pump_line(guard_run *run, int line, int64_t end_us)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    int size;
    int r = GROBO_OK;

    while (r >= 0 && (size = grobo_robot_line_tx(&run->robot, line, frame, sizeof frame,
                                                 grobo_now_us())) > 0) {
        r = put(run, line, frame, (size_t)size, end_us);
    }
    return r < 0 && run->n_lines > 1 ? lose(run, line, r) : r;
}

static int pump_out(guard_run *run, int64_t end_us)
{
    int r = GROBO_OK;

    for (int i = 0; i < run->n_lines && r >= 0; i++) {
        r = pump_line(run, i, end_us);
    }
    return r;
}

static int pump_in(guard_run *run, int64_t end_us)
{
    int64_t now_us = grobo_now_us();
    int64_t until_us = grobo_i_sooner(grobo_robot_deadline(&run->robot, now_us), end_us);
    uint8_t bytes[256];
    int line;
    int got = read_until(run, &line, bytes, sizeof bytes, until_us - now_us);

    if (got > 0) {
        grobo_robot_line_rx(&run->robot, line, bytes, (size_t)got, grobo_now_us());
    }
    if (got >= 0) {
        grobo_robot_step(&run->robot, grobo_now_us());
    }
    return got;
}

/* Lets the engine do a job that was just begun. */
static int do_job(guard_run *run, int job, int64_t end_us)
{
    int r = job;

    while (r >= 0 && run->ended_job != job) {
        r = grobo_now_us() < end_us ? pump_out(run, end_us) : GROBO_ERR_TIMEOUT;
        if (r >= 0) {
            r = pump_in(run, end_us);
        }
    }
    return r < 0 ? r : run->result;
}

static int exit_by(guard_run *run, grobo_exit_policy policy, int64_t end_us)
{
    return do_job(run, grobo_robot_exit(&run->robot, policy), end_us);
}

static int stop_robot(guard_run *run, guard_policy policy)
{
    int64_t end_us = grobo_now_us() + STOP_US;
    grobo_robot_config config = run->how.robot;

    config.sense_interval_us = GROBO_SENSE_NEVER;
    memset(run->gone, 0, sizeof run->gone);
    int r = grobo_robot_init(&run->robot, run->driver, run->driver_ctx, &config, grobo_now_us());
    r = r < 0 ? r : await_quiet(run);
    if (r < 0) {
        return r;
    }
    run->ended_job = 0;
    grobo_robot_on_event(&run->robot, on_robot, run);
    grobo_robot_link_up(&run->robot, grobo_now_us());
    for (int i = 0; i < run->n_lines; i++) {
        if (run->gone[i]) { /* before the link was up */
            grobo_robot_line_down(&run->robot, i, grobo_now_us());
        }
    }
    switch (policy) {
    case GUARD_ESTOP:
        return do_job(run, grobo_robot_estop(&run->robot), end_us);
    case GUARD_OFF:
        r = exit_by(run, GROBO_EXIT_HOLD, end_us - OFF_US);
        return r == GROBO_ERR_UNPLUGGED ? r : exit_by(run, GROBO_EXIT_OFF, end_us);
    case GUARD_HOLD:
        break;
    }
    return exit_by(run, GROBO_EXIT_HOLD, end_us);
}

static void report(const guard_run *run, grobo_guard_cause cause, int result)
{
    if (run->program->on_stop != NULL) {
        run->program->on_stop(run->program->ctx, cause, result);
    }
}

/* Whoever wants the robot may have it; if the program dies before anybody had, torque is still owed
 * to go off. */
static void lend(guard_run *run)
{
    for (int i = 0; i < run->n_lines; i++) {
        grobo_i_port_lend(run->port[i]);
    }
    run->lent = true;
}

static void close_ports(guard_run *run)
{
    for (int i = 0; i < run->n_lines; i++) {
        run->ops[i]->close(run->port[i]);
    }
    forget(run);
}

static bool reclaim_ports(guard_run *run)
{
    bool all = true;

    for (int i = 0; i < run->n_lines && all; i++) {
        all = grobo_i_port_reclaim(run->port[i]) == GROBO_OK;
    }
    return all;
}

static void stop(guard_run *run, grobo_guard_cause cause)
{
    guard_policy policy = cause == GROBO_GUARD_ASKED ? GUARD_ESTOP : (guard_policy)run->how.policy;
    bool may_continue = cause != GROBO_GUARD_DIED;
    int result;

    grobo_i_port_adopt(run->port[0], run->line);
    for (int i = 1; i < run->n_lines; i++) {
        grobo_i_port_adopt(run->port[i], run->more[i]);
    }
    /* A program may continue; a robot that fell does not. */
    result = stop_robot(run, may_continue && policy == GUARD_OFF ? GUARD_HOLD : policy);
    if (may_continue && policy == GUARD_OFF) {
        lend(run);
    } else {
        close_ports(run);
    }
    report(run, cause, result);
}

/* The program that was stopped has died. Where another one has had the robot since, it is that
 * one's; where no process could register, only who has it now is known. */
static void settle(guard_run *run)
{
    bool is_its = run->holder == 0 || run->holder == grobo_i_estop_holder_stamp(&run->names);

    if (run->how.policy == GUARD_OFF && is_its && reclaim_ports(run)) {
        int result = stop_robot(run, GUARD_OFF);

        close_ports(run);
        report(run, GROBO_GUARD_DIED, result);
    }
    drop(run);
}

/* ---- waiting for it ----------------------------------------------------------------------- */

/* Has the program's loop not turned for too long? */
static bool is_silent(guard_run *run, bool heard)
{
    int64_t now_us = grobo_now_us();
    unsigned beats = atomic_load_explicit(&run->shared->beats, memory_order_relaxed);

    if (heard || run->shared == &run->own || beats != run->beats) {
        run->silent_us = 0;
    } else {
        run->silent_us +=
            now_us - run->looked_us < LOOK_MAX_US ? now_us - run->looked_us : LOOK_MAX_US;
    }
    run->beats = beats;
    run->looked_us = now_us;
    return run->silent_us >= GROBO_GUARD_SILENCE_US;
}

/* Takes the line from a program that may continue. */
static void take_over(guard_run *run, grobo_guard_cause cause)
{
    run->silent_us = 0;
    if (claim(run)) {
        say(run, GUARD_TAKEN);
        stop(run, cause);
    }
}

static void end(guard_run *run)
{
    if (run->has_port && run->lent) {
        settle(run);
    } else if (run->has_port && claim(run)) {
        stop(run, GROBO_GUARD_DIED);
    }
}

static bool look(guard_run *run)
{
    bool moves = run->has_port && !run->lent && run->how.moves;
    unsigned found = grobo_i_guard_await(&run->watch, run->line, moves);
    bool silent = is_silent(run, !moves || (found & GROBO_I_GUARD_NEWS) != 0);

    /* What the program said before it died is read first: it may have released the port. */
    if ((found & GROBO_I_GUARD_NEWS) != 0) {
        if (take_some(run)) {
            return true;
        }
        found |= GROBO_I_GUARD_DEAD;
    }
    if ((found & GROBO_I_GUARD_HUNG_UP) != 0) {
        drop(run);
    }
    if ((found & GROBO_I_GUARD_DEAD) != 0) {
        end(run);
        return false;
    }
    if (run->has_port && !run->lent &&
        (silent || (found & (GROBO_I_GUARD_STOPPED | GROBO_I_GUARD_ASKED)) != 0)) {
        take_over(run, (found & GROBO_I_GUARD_ASKED) != 0 ? GROBO_GUARD_ASKED
                       : silent                           ? GROBO_GUARD_SILENT
                                                          : GROBO_GUARD_STOPPED);
    }
    return true;
}

/* Room for a port of either kind. */
static size_t port_bytes(void)
{
    size_t serial_bytes = grobo_port_serial_ops()->size_bytes;
    size_t tcp_bytes = grobo_port_tcp_ops()->size_bytes;

    return serial_bytes > tcp_bytes ? serial_bytes : tcp_bytes;
}

static int make_ports(guard_run *run)
{
    int r = GROBO_OK;

    for (int i = 0; i < GROBO_LINES_MAX && r >= 0; i++) {
        run->port[i] = grobo_i_new(NULL, port_bytes());
        r = run->port[i] == NULL ? GROBO_ERR_NOMEM : GROBO_OK;
    }
    return r;
}

int grobo_guard_run(const grobo_guard_program *program)
{
    grobo_guard_program taken;
    const guard_hello hello = {GUARD_MAGIC, sizeof(guard_message)};
    int r = grobo_i_sized_take(&taken, sizeof taken, program);

    if (r < 0) {
        return r;
    }
    guard_run *run = grobo_i_new(NULL, sizeof *run);
    if (run == NULL) {
        return GROBO_ERR_NOMEM;
    }
    run->program = &taken;
    run->shared = &run->own;
    run->came = GROBO_HANDLE_NULL;
    forget(run);
    r = make_ports(run);
    r = r < 0 ? r : grobo_i_guard_begin(&run->watch);
    if (r >= 0) {
        r = grobo_i_guard_send(run->watch.socket, &hello, sizeof hello, GROBO_HANDLE_NULL);
        while (r >= 0 && look(run)) {
        }
        grobo_i_guard_cease(&run->watch);
    }
    drop(run);
    unshare(run);
    for (int i = 0; i < GROBO_LINES_MAX; i++) {
        grobo_i_free(NULL, run->port[i], port_bytes());
    }
    grobo_i_free(NULL, run, sizeof *run);
    return r < 0 ? r : GROBO_OK;
}
