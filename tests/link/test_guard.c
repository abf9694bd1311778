/* SPDX-License-Identifier: MIT */
/*
 * A guard stops the robot of a program that dies. The test serves a simulated robot; this same
 * executable is the program and its guard, see guarded.h.
 */
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/sim.h>
#include <grobo/guard.h>
#include <grobo/session.h>

#include "tests/support/folder.h"
#include "tests/support/guarded.h"
#include "tests/support/leash.h"
#include "tests/support/loop.h"
#include "tests/support/test.h"

/* How much longer than it says a busy machine may take. */
#define GRACE_US INT64_C(700000)

static const char *self;

static struct event_base *base;
static grobo_sim_server *server;
static pid_t program;
static leash its_leash; /* with a child that it leaves */
static bool program_ended;
static int64_t ended_us;
static FILE *from_program;
static struct event *heard;
static char said[1024];   /* its words, a blank before and after each */
static size_t understood; /* of them, by await_word() */
static int guard_pid;
static size_t bytes_sent; /* to the robot */
static char device[256];  /* of the robot */

static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    (void)now_us;
    (void)bytes;
    (void)ctx;
    bytes_sent += direction == GROBO_DIR_RX ? size : 0;
}

static void on_word(evutil_socket_t fd, short what, void *ctx)
{
    char word[64];
    int pid;

    (void)fd;
    (void)what;
    (void)ctx;
    if (fscanf(from_program, "%63s %d", word, &pid) == 2) {
        size_t length = strlen(said);

        assert_true(snprintf(said + length, sizeof said - length, "%s ", word) <
                    (int)(sizeof said - length));
        guard_pid = pid != 0 ? pid : guard_pid;
    } else {
        event_del(heard);
    }
}

static void serve(bool tcp)
{
    grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .baud_bps = GUARDED_BPS};
    grobo_sim_server_config config = {GROBO_SIM_SERVER_CONFIG_INIT, .sim = &sim, .no_pty = tcp,
                                      .tcp = tcp ? "tcp:127.0.0.1:0" : NULL, .on_tap = on_tap};

    snprintf(device, sizeof device, "%s", in_folder("robot"));
    config.link = tcp ? NULL : device;
    server = loop_serve(base, config);
    if (tcp) {
        snprintf(device, sizeof device, "%s", grobo_sim_server_device(server));
    }
}

static void start(const char *how)
{
    int ends[2];

    assert_int_equal(pipe(ends), 0);
    program = fork();
    assert_true(program >= 0);
    if (program == 0) {
        (void)setpgid(0, 0);
        (void)dup2(ends[1], STDOUT_FILENO);
        (void)close(ends[0]);
        (void)close(ends[1]);
        execl("/bin/sh", "sh", "-c", guarded_again, self, "program", how, device, (char *)NULL);
        _exit(127);
    }
    (void)setpgid(program, program); /* whoever of both is first */
    leash_put(&its_leash, program);
    (void)close(ends[1]);
    from_program = fdopen(ends[0], "r");
    assert_non_null(from_program);
    setvbuf(from_program, NULL, _IONBF, 0);
    heard = event_new(base, ends[0], EV_READ | EV_PERSIST, on_word, NULL);
    assert_int_equal(event_add(heard, NULL), 0);
}

static void await(bool (*is_so)(void))
{
    int64_t end_us = grobo_now_us() + 20000000;

    while (!is_so()) {
        assert_true(grobo_now_us() < end_us);
        loop_run_for(base, 5000);
    }
}

static char awaited[64];

static bool is_said(void)
{
    const char *at = strstr(said + understood, awaited);

    if (at != NULL) {
        understood = (size_t)(at - said) + strlen(awaited) - 1;
    }
    return at != NULL;
}

/* Words are understood in their order, others between them are passed over. */
static void await_word(const char *wanted)
{
    snprintf(awaited, sizeof awaited, " %s ", wanted);
    await(is_said);
}

static bool has_ended(void)
{
    if (!program_ended && waitpid(program, NULL, WNOHANG) == program) {
        program_ended = true;
        ended_us = grobo_now_us();
    }
    return program_ended;
}

static grobo_sim_view look(void)
{
    grobo_sim *sim = grobo_sim_server_sim(server);
    grobo_sim_view view;

    grobo_sim_server_pump(server);
    assert_int_equal(grobo_sim_look(sim, grobo_sim_find(sim, GUARDED_MOTOR), &view), 0);
    return view;
}

static bool stands(void)
{
    return !look().moving;
}

static void assert_it_stopped_on_its_way(grobo_torque torque)
{
    grobo_sim_view view = look();

    assert_false(view.moving);
    assert_int_equal(view.torque, torque);
    assert_true(view.angle_mdeg < GUARDED_FROM_DEG * 1000 &&
                view.angle_mdeg > GUARDED_TO_DEG * 1000);
}

/* Can the next program have the port? */
static bool is_free(void)
{
    const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = device,
                                        .baud_bps = GUARDED_BPS};
    grobo_serial *serial;
    int r;

    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    r = grobo_serial_open(serial);
    grobo_serial_free(serial);
    assert_true(r == GROBO_OK || r == GROBO_ERR_BUSY);
    return r == GROBO_OK;
}

/* A process that waits to be reaped by whoever inherited it is gone too. */
static bool guard_is_gone(void)
{
    char path[64];
    char state = 'Z';
    FILE *stat;

    assert_true(guard_pid > 0);
    if (kill(guard_pid, 0) != 0) {
        return true;
    }
    snprintf(path, sizeof path, "/proc/%d/stat", guard_pid);
    stat = fopen(path, "r");
    if (stat != NULL) {
        (void)fscanf(stat, "%*d (%*[^)]) %c", &state);
        (void)fclose(stat);
    }
    return stat != NULL && state == 'Z';
}

/* Memory that two programs share. */
static bool has_heartbeat(void)
{
    return access("/proc/self/stat", R_OK) == 0;
}

static void run_until_it_dies(const char *how)
{
    start(how);
    await_word("moving");
    await(has_ended);
}

static int set_up(void)
{
    (void)folder_set_up();
    base = grobo_loop_new();
    assert_non_null(base);
    server = NULL;
    program = 0;
    its_leash.end = -1;
    program_ended = false;
    from_program = NULL;
    heard = NULL;
    snprintf(said, sizeof said, " ");
    understood = 0;
    guard_pid = 0;
    bytes_sent = 0;
    return 0;
}

static int tear_down(void)
{
    leash_take(&its_leash);
    if (program > 0) {
        (void)kill(-program, SIGKILL); /* with a child that it left */
    }
    if (program > 0 && !program_ended) {
        (void)waitpid(program, NULL, 0);
    }
    if (from_program != NULL) {
        event_free(heard);
        (void)fclose(from_program);
    }
    grobo_sim_server_free(server);
    event_base_free(base);
    folder_remove(NULL, 0);
    return 0;
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

TEST_WITH(fixture, a_killed_program)
{
    serve(false);
    run_until_it_dies("kill");
    await(stands);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
    await(is_free);
    assert_true(grobo_now_us() < ended_us + GROBO_GUARD_BOUND_US + GRACE_US);
    await(guard_is_gone);
}

TEST_WITH(fixture, a_robot_behind_a_connection)
{
    serve(true);
    run_until_it_dies("kill");
    await(stands);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
    await(guard_is_gone);
}

/* Servos that do not answer cost the guard all its time, and not more. */
TEST_WITH(fixture, a_robot_that_is_silent)
{
    serve(false);
    start("kill");
    await_word("moving");
    for (int i = 0; i < 20; i++) {
        (void)grobo_sim_set_cable(grobo_sim_server_sim(server), i, GROBO_SIM_CABLE_MUTE);
    }
    await(has_ended);
    await(is_free);
    assert_true(grobo_now_us() < ended_us + GROBO_GUARD_BOUND_US + GRACE_US);
    await(guard_is_gone);
}

TEST_WITH(fixture, torque_goes_off_where_the_policy_says_so)
{
    serve(false);
    run_until_it_dies("off");
    await(guard_is_gone);
    assert_it_stopped_on_its_way(GROBO_TORQUE_OFF);
}

/* The servo does not hear the program's, but the guard's. */
TEST_WITH(fixture, an_emergency_stop_stays_one)
{
    grobo_sim *sim;
    int elbow;

    serve(false);
    sim = grobo_sim_server_sim(server);
    elbow = grobo_sim_find(sim, GUARDED_MOTOR);
    start("estop");
    await_word("moving");
    assert_int_equal(grobo_sim_set_cable(sim, elbow, GROBO_SIM_CABLE_MUTE), 0);
    await(has_ended);
    assert_int_equal(grobo_sim_set_cable(sim, elbow, GROBO_SIM_CABLE_IN), 0);
    await(guard_is_gone);
    assert_it_stopped_on_its_way(GROBO_TORQUE_BRAKE);
}

/* The child has the port, its lock and the guard's socket, and lives on. */
TEST_WITH(fixture, a_child_that_survives)
{
    int64_t end_us;

    serve(false);
    run_until_it_dies("fork");
    end_us = ended_us + GROBO_GUARD_BOUND_US + GRACE_US;
    await(stands);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
    await(is_free);
    await(guard_is_gone);
    assert_true(grobo_now_us() < end_us);
    assert_int_equal(kill(-program, SIGKILL), 0); /* it was there */
}

TEST_WITH(fixture, a_program_that_is_stopped)
{
    if (access("/proc/self/stat", R_OK) != 0) {
        skip(); /* only Linux tells */
    }
    serve(false);
    start("stop");
    await_word("moving");
    await(stands);
    await(is_free);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON); /* not off, as one that is dead wants it */
    assert_false(guard_is_gone());
    assert_int_equal(kill(program, SIGCONT), 0);
    await_word("STALLED");
    await_word("up"); /* it opens the port again, and its guard has it again */
    (void)kill(program, SIGKILL);
    await(has_ended);
    await(guard_is_gone);
    await(is_free);
    assert_it_stopped_on_its_way(GROBO_TORQUE_OFF); /* the policy of one that is dead */
}

/* It continues while the guard is still busy: the port stays the guard's. */
TEST_WITH(fixture, a_program_that_continues_too_early)
{
    size_t bytes;

    if (access("/proc/self/stat", R_OK) != 0) {
        skip(); /* only Linux tells */
    }
    serve(false);
    start("halt");
    await_word("moving");
    for (int i = 0; i < 20; i++) {
        (void)grobo_sim_set_cable(grobo_sim_server_sim(server), i, GROBO_SIM_CABLE_MUTE);
    }
    bytes = bytes_sent;
    for (int64_t end_us = grobo_now_us() + 20000000; bytes_sent == bytes;) {
        assert_true(grobo_now_us() < end_us);
        loop_run_for(base, 5000);
    }
    assert_int_equal(kill(program, SIGCONT), 0);
    await_word("STALLED");
    assert_false(is_free());
    await(is_free);
}

/* Stopped first and killed then: the policy is that of one that died. */
TEST_WITH(fixture, a_program_that_is_stopped_and_then_killed)
{
    if (access("/proc/self/stat", R_OK) != 0) {
        skip(); /* only Linux tells */
    }
    serve(false);
    start("stop");
    await_word("moving");
    await(stands);
    await(is_free);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
    (void)kill(program, SIGKILL);
    await(has_ended);
    await(guard_is_gone);
    assert_it_stopped_on_its_way(GROBO_TORQUE_OFF);
    assert_true(is_free());
}

/* Nobody's torque goes off behind his back: another program has had the robot meanwhile. */
TEST_WITH(fixture, a_program_that_is_stopped_and_followed_by_another)
{
    const grobo_session_config config = {GROBO_SESSION_CONFIG_INIT, .base = base, .device = device,
                                         .baud_bps = GUARDED_BPS};
    grobo_session *session = NULL;
    int64_t end_us = grobo_now_us() + 20000000;

    if (access("/proc/self/stat", R_OK) != 0) {
        skip(); /* only Linux tells */
    }
    serve(false);
    start("stop");
    await_word("moving");
    await(stands);
    await(is_free);
    assert_int_equal(grobo_session_new(&config, &session), GROBO_OK);
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    while (grobo_session_get_state(session) != GROBO_SESSION_UP) {
        assert_true(grobo_now_us() < end_us);
        loop_run_for(base, 5000);
    }
    grobo_session_free(session);
    (void)kill(program, SIGKILL);
    await(has_ended);
    await(guard_is_gone);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
    assert_true(is_free());
}

/* Its loop is held up, and nobody but its heart tells. */
TEST_WITH(fixture, a_program_that_hangs)
{
    size_t bytes;

    if (!has_heartbeat()) {
        skip(); /* only Linux has one */
    }
    serve(false);
    start("hang");
    await_word("hanging");
    await(stands);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON); /* not off: it may continue */
    await(is_free);
    assert_false(guard_is_gone());
    bytes = bytes_sent;
    assert_int_equal(kill(program, SIGUSR1), 0);
    await_word("STALLED"); /* before anything is sent */
    assert_int_equal(bytes_sent, bytes);
    await_word("up");
    (void)kill(program, SIGKILL);
    await(has_ended);
    await(guard_is_gone);
    assert_it_stopped_on_its_way(GROBO_TORQUE_OFF);
}

/* Where nothing moves, it may wait for a person as long as it likes. */
TEST_WITH(fixture, a_program_that_asks_a_person)
{
    serve(false);
    start("ask");
    await_word("hanging");
    loop_run_for(base, 2000000);
    assert_false(is_free()); /* the guard would have released it */
    assert_int_equal(kill(program, SIGUSR1), 0);
    loop_run_for(base, 200000);
    assert_string_equal(said + understood, " ");
    (void)kill(program, SIGKILL);
    await(has_ended);
    await(guard_is_gone);
}

/* One whose loop turns is left alone for longer than a silence, also while nothing is sent. */
TEST_WITH(fixture, a_program_that_only_waits)
{
    serve(false);
    start("watch");
    await_word("moving");
    loop_run_for(base, 2500000);
    assert_true(look().moving);
    assert_string_equal(said + understood, " ");
    (void)kill(program, SIGKILL);
    await(has_ended);
    await(guard_is_gone);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
}

/* Without its descriptors it has no loop, no port and no guard to tell: that guard stops. */
TEST_WITH(fixture, a_program_that_closes_all_its_descriptors)
{
    serve(false);
    start("deaf");
    await_word("moving");
    await(stands);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
    await(has_ended);
    await(is_free);
    await(guard_is_gone);
}

TEST_WITH(fixture, a_program_that_closes_them_and_hangs)
{
    serve(false);
    start("dumb");
    await_word("hanging");
    await(stands);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
    await(is_free);
    await(guard_is_gone);
}

/* Nothing that it needs then is still to be had from the system. */
TEST_WITH(fixture, a_guard_that_gets_nothing_any_more)
{
    char command[128];

    serve(false);
    start("watch");
    await_word("moving");
    snprintf(command, sizeof command, "exec prlimit --nofile=0 --as=1 --pid %d", guard_pid);
    if (system(command) != 0) {
        skip(); /* no such tool, or no such system */
    }
    (void)kill(program, SIGKILL);
    await(has_ended);
    await(stands);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
    await(guard_is_gone);
    assert_true(is_free());
}

TEST_WITH(fixture, a_program_that_ends_well)
{
    size_t bytes;

    serve(false);
    run_until_it_dies("end");
    assert_true(guard_is_gone()); /* it was waited for */
    assert_true(is_free());
    bytes = bytes_sent;
    loop_run_for(base, 300000);
    assert_int_equal(bytes_sent, bytes);
    assert_true(look().moving); /* no exit policy was asked for */
}

TEST_WITH(fixture, a_guard_that_is_killed)
{
    size_t bytes;

    serve(false);
    start("watch");
    await_word("moving");
    assert_int_equal(kill(guard_pid, SIGKILL), 0);
    await_word("unguarded");
    loop_run_for(base, 500000);
    assert_string_equal(said + understood, " "); /* once, and the session stays */
    assert_true(look().moving);
    (void)kill(program, SIGKILL);
    await(has_ended);
    bytes = bytes_sent;
    loop_run_for(base, 500000);
    assert_int_equal(bytes_sent, bytes);
    assert_true(look().moving); /* nobody is left to stop it */
}

/* How many descriptors of the guard lead to names like that; -1: the system does not tell. */
static int open_in_the_guard(const char *name)
{
    int count = -1;

    for (int fd = 0; fd < 20; fd++) {
        char path[64];
        char to[128];
        ssize_t size;

        snprintf(path, sizeof path, "/proc/%d/fd/%d", guard_pid, fd);
        size = readlink(path, to, sizeof to - 1);
        if (size > 0) {
            to[size] = '\0';
            count = (count < 0 ? 0 : count) +
                    (fd != STDERR_FILENO && strncmp(to, name, strlen(name)) == 0);
        }
    }
    return count;
}

static bool guard_has_a_terminal(void)
{
    return open_in_the_guard("/dev/pts/") != 0;
}

static bool guard_has_no_terminal(void)
{
    return open_in_the_guard("/dev/pts/") <= 0;
}

/* A device that is unplugged keeps its name only if nobody has it open any more. */
TEST_WITH(fixture, a_line_that_is_lost_and_comes_back)
{
    serve(false);
    start("watch");
    await_word("moving");
    await(guard_has_a_terminal);
    assert_int_equal(grobo_sim_server_plug(server, false), GROBO_OK);
    await_word("UNPLUGGED");
    await(guard_has_no_terminal);
    assert_false(guard_is_gone());
    assert_int_equal(grobo_sim_server_plug(server, true), GROBO_OK);
    await_word("up");
    await(guard_has_a_terminal);
    (void)kill(program, SIGKILL);
    await(has_ended);
    await(guard_is_gone);
    assert_it_stopped_on_its_way(GROBO_TORQUE_ON);
}

TEST_WITH(fixture, a_line_that_is_lost_while_the_program_cannot_say_so)
{
    serve(false);
    start("rest");
    await_word("resting");
    await(guard_has_a_terminal);
    assert_int_equal(kill(program, SIGSTOP), 0);
    assert_int_equal(grobo_sim_server_plug(server, false), GROBO_OK);
    await(guard_has_no_terminal);
}

/* What a program has written may come after it has closed its port. */
static size_t last_of_it(void)
{
    size_t before;
    do {
        before = bytes_sent;
        loop_run_for(base, 100000);
    } while (bytes_sent != before);
    return before;
}

TEST_WITH(fixture, a_port_that_is_closed)
{
    size_t bytes;

    serve(false);
    start("close");
    await_word("moving");
    await_word("closed");
    await(guard_has_no_terminal);
    assert_true(open_in_the_guard("pipe:") <= 0); /* nor anything else of the program */
    await(is_free);
    bytes = last_of_it();
    (void)kill(program, SIGKILL);
    await(has_ended);
    await(guard_is_gone);
    assert_int_equal(last_of_it(), bytes); /* it was the program's no more */
}

TEST_WITH(fixture, a_robot_that_it_does_not_know)
{
    serve(false);
    start("strange");
    await_word("refused");
    await(has_ended);
    await(guard_is_gone);
    assert_true(look().moving);
}

TEST_WITH(fixture, what_is_no_guard)
{
    const char *const nothing[] = {NULL};
    const char *many[20] = {0};
    grobo_guard_config config = {GROBO_GUARD_CONFIG_INIT, .program = "true", .arguments = nothing};
    grobo_guard *guard = NULL;

    assert_int_equal(grobo_guard_new(&config, &guard), GROBO_ERR_MISMATCH);
    config.program = "/nowhere/guard";
    assert_int_equal(grobo_guard_new(&config, &guard), GROBO_ERR_NOENT);
    for (size_t i = 0; i < 19; i++) {
        many[i] = "word";
    }
    config.arguments = many;
    assert_int_equal(grobo_guard_new(&config, &guard), GROBO_ERR_CAP);
    assert_null(guard);
    assert_int_equal(grobo_guard_new(NULL, NULL), GROBO_ERR_ARG);
    grobo_guard_free(NULL);
}

TEST_WITH(fixture, what_the_caller_gets_wrong)
{
    static const uint8_t data[GROBO_GUARD_DATA_BYTES + 1];
    grobo_session_config config = {GROBO_SESSION_CONFIG_INIT, .base = base, .device = "/dev/null",
                                   .guard_data = data};
    grobo_session *session = NULL;
    grobo_guard *guard = NULL;

    assert_int_equal(guarded_new(self, &guard), GROBO_OK);
    assert_true(grobo_guard_pid(guard) > 0);
    config.guard = guard;
    config.guard_bytes = sizeof data;
    assert_int_equal(grobo_session_new(&config, &session), GROBO_ERR_CAP);
    assert_null(session);
    guard_pid = grobo_guard_pid(guard);
    grobo_guard_free(guard);
    assert_true(guard_is_gone());
    assert_int_equal(grobo_guard_run(NULL), GROBO_ERR_ARG); /* not what a guard started */
}

int main(int argc, char **argv)
{
    int status = guarded_main(argc, argv);

    if (status >= 0) {
        return status;
    }
    self = argv[0];
    return test_main(argc, argv);
}
