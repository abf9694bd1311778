/* SPDX-License-Identifier: MIT */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/robot.h>
#include <grobo/session.h>

#include "tests/support/guarded.h"
#include "tests/support/tables.h"

const char guarded_again[] = "exec ${EMULATOR:-} \"$0\" \"$@\"";

int guarded_new(const char *program, grobo_guard **guard)
{
    const char *const arguments[] = {"-c", guarded_again, program, "guard", NULL};
    const grobo_guard_config config = {GROBO_GUARD_CONFIG_INIT, .program = "/bin/sh",
                                       .arguments = arguments};

    return grobo_guard_new(&config, guard);
}

/* ---- the guard ---------------------------------------------------------------------------- */

static const grobo_driver *find(void *ctx, const char *name, grobo_wiring wiring, const void *data,
                                size_t bytes, void **driver_ctx)
{
    (void)ctx;
    (void)driver_ctx;
    return strcmp(name, "GR001") == 0 && bytes == 5 && memcmp(data, "known", 5) == 0
               ? grobo_gr001_driver(wiring)
               : NULL;
}

static int be_guard(void)
{
    static const grobo_guard_program program = {GROBO_GUARD_PROGRAM_INIT, .driver = find};

    return grobo_guard_run(&program) == GROBO_OK ? 0 : 1;
}

/* ---- the program -------------------------------------------------------------------------- */

/* What it does once the joint is on its way. */
static const char *mode;

static struct event_base *its_base;
static grobo_session *its_session;
static grobo_guard *its_guard;

static bool is_mode(const char *name)
{
    return strcmp(mode, name) == 0;
}

/* One line for the test. */
static void say(const char *word)
{
    printf("%s %d\n", word, grobo_guard_pid(its_guard));
    fflush(stdout);
}

static void end_program(const char *why)
{
    say(why);
    exit(9);
}

static void on_line(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    grobo_posture target;

    (void)ctx;
    switch (event) {
    case GROBO_SESSION_EVENT_UP:
        grobo_posture_init(&target, grobo_i_gr001_model.n_joints);
        grobo_posture_set_deg(&target,
                              grobo_model_joint_of_motor(&grobo_i_gr001_model, GUARDED_MOTOR),
                              GUARDED_TO_DEG);
        target.time_us = is_mode("rest") || is_mode("ask") ? 300000 : 20000000;
        if (grobo_robot_move(grobo_session_robot(session), &target) < 0) {
            end_program("moves-not");
        }
        say("up");
        break;
    case GROBO_SESSION_EVENT_LOST:
        say(grobo_error_name(error));
        break;
    case GROBO_SESSION_EVENT_FAILED:
        end_program(grobo_error_name(error));
        break;
    case GROBO_SESSION_EVENT_UNGUARDED:
        say(error == GROBO_ERR_UNSUPPORTED ? "refused" : "unguarded");
        break;
    }
}

/* Leaves a child that has all descriptors, and has freed a guard that is not its own. */
static void leave_child(void)
{
    int ends[2];
    char byte = 0;

    if (pipe(ends) != 0) {
        end_program("pipe");
    }
    if (fork() == 0) {
        grobo_guard_free(its_guard);
        (void)write(ends[1], &byte, 1);
        for (;;) {
            pause();
        }
    }
    (void)read(ends[0], &byte, 1);
}

static void hang(void);

static void on_robot(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (is_mode("ask") && event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_MOVE) {
        hang();
    }
}

/* Holds the loop up until SIGUSR1 comes. */
static void hang(void)
{
    sigset_t wanted;
    int number;

    sigemptyset(&wanted);
    sigaddset(&wanted, SIGUSR1);
    (void)sigprocmask(SIG_BLOCK, &wanted, NULL);
    say("hanging");
    (void)sigwait(&wanted, &number);
}

static void close_all(void)
{
    for (int fd = STDERR_FILENO; fd < 64; fd++) {
        (void)close(fd);
    }
}

static void do_as_the_mode_says(void)
{
    if (is_mode("hang")) {
        hang();
        return;
    }
    if (is_mode("deaf") || is_mode("dumb")) {
        close_all();
        if (is_mode("dumb")) {
            hang();
        }
        return;
    }
    if (is_mode("fork")) {
        leave_child();
    }
    if (is_mode("end")) {
        event_base_loopbreak(its_base);
    } else if (is_mode("close")) {
        grobo_session_close(its_session);
        say("closed");
    } else if (!is_mode("watch")) {
        (void)raise(is_mode("stop") || is_mode("halt") ? SIGSTOP : SIGKILL);
    }
}

/* So many ticks after a frame that moves the joint has left; an emergency stop comes between. */
enum { TICK_US = 10000, MOVING_TICKS = 30, ESTOP_TICKS = 40, ESTOP_DIES_TICKS = 50 };

static void on_tick(evutil_socket_t fd, short what, void *ctx)
{
    static int ticks;
    grobo_robot *robot = grobo_session_robot(its_session);
    bool moving = grobo_robot_moving(robot) && grobo_robot_get_counters(robot)->motion_frames > 0;

    (void)fd;
    (void)what;
    (void)ctx;
    if (is_mode("rest")) {
        if (!moving && ticks == 0 && grobo_robot_get_counters(robot)->motion_frames > 0) {
            ticks++;
            say("resting");
        }
        return;
    }
    if ((ticks == 0 && !moving) || is_mode("ask")) {
        return;
    }
    ticks++;
    if (ticks == MOVING_TICKS) {
        say("moving");
    }
    if (is_mode("estop") && ticks == ESTOP_TICKS) {
        (void)grobo_robot_estop(grobo_session_robot(its_session));
    }
    if (ticks == (is_mode("estop") ? ESTOP_DIES_TICKS : MOVING_TICKS)) {
        do_as_the_mode_says();
    }
}

static int be_program(const char *self, const char *device)
{
    struct timeval period = {0, TICK_US};
    /* On a busy machine a pseudo-terminal hands on what it was given 170 ms later. */
    grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = GROBO_SENSE_NEVER,
                                .timeout_us = 300000};
    grobo_session_config config = {GROBO_SESSION_CONFIG_INIT,
                                   .device = device,
                                   .baud_bps = GUARDED_BPS,
                                   .robot = &robot,
                                   .reconnect = !is_mode("halt"),
                                   .on_event = on_line,
                                   .on_robot = on_robot,
                                   .guard_data = is_mode("strange") ? "other" : "known",
                                   .guard_bytes = 5};
    struct event *tick;

    /* One that exec does not close: it must not be the guard's. */
    if (dup(STDOUT_FILENO) < 0 || guarded_new(self, &its_guard) != GROBO_OK) {
        return 8;
    }
    robot.on_exit =
        is_mode("off") || is_mode("stop") || is_mode("hang") ? GROBO_EXIT_OFF : GROBO_EXIT_DEFAULT;
    its_base = grobo_loop_new();
    config.base = its_base;
    config.guard = its_guard;
    if (its_base == NULL || grobo_session_new(&config, &its_session) < 0 ||
        grobo_session_open(its_session) < 0) {
        return 7;
    }
    tick = event_new(its_base, -1, EV_PERSIST, on_tick, NULL);
    event_add(tick, &period);
    event_base_dispatch(its_base);
    event_free(tick);
    grobo_session_free(its_session);
    event_base_free(its_base);
    grobo_guard_free(its_guard);
    return 0;
}

int guarded_main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "guard") == 0) {
        return be_guard();
    }
    if (argc == 4 && strcmp(argv[1], "program") == 0) {
        mode = argv[2];
        return be_program(argv[0], argv[3]);
    }
    return -1;
}
