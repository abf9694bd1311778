/* SPDX-License-Identifier: MIT */
/*
 * A robot behind a USB adapter that is pulled out while it moves, and put back after another one
 * has taken its place: its guard must not keep the old name from that one. GROBO_TEST_DEVICE is the
 * name to open, GROBO_TEST_NAME the one under /dev/serial/by-id. The caller pulls the adapter when
 * this prints "@unplug", plugs the other one in at "@other", and the robot's at "@plug".
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/robot.h>

#include "tests/support/guarded.h"
#include "tests/support/loop.h"
#include "tests/support/os.h"
#include "tests/support/session_kit.h"
#include "tests/support/test.h"

static const char *self;
static grobo_guard *guard;
static int watch;       /* inotify of the folders of devices and of names that stay */
static int64_t gone_us; /* when a device went */
static int64_t here_us; /* when a name came */
static void on_change(evutil_socket_t fd, short what, void *ctx)
{
    union {
        struct inotify_event event;
        char bytes[4096];
    } buf;
    ssize_t size = read((int)fd, buf.bytes, sizeof buf.bytes);

    (void)what;
    (void)ctx;
    for (ssize_t at = 0; at < size;) {
        struct inotify_event event;

        memcpy(&event, buf.bytes + at, sizeof event);
        if ((event.mask & IN_DELETE) != 0) {
            gone_us = grobo_now_us();
        } else {
            here_us = grobo_now_us();
            event_base_loopbreak(base);
        }
        at += (ssize_t)(sizeof event + event.len);
    }
}

/* Where the joints are, in tenths of a degree. */
static void sense(int16_t *angle_ddeg, size_t n)
{
    grobo_robot *robot = grobo_session_robot(session);

    assert_int_equal(session_kit_await(grobo_robot_sense(
                         grobo_session_robot(session), GROBO_JOINTS_ALL((int)n), GROBO_SENSE_FULL)),
                     GROBO_OK);
    for (size_t i = 0; i < n; i++) {
        grobo_joint_info info;

        assert_int_equal(grobo_robot_joint(robot, (int)i, &info), GROBO_OK);
        angle_ddeg[i] = (int16_t)(grobo_deg_from_rad(info.state.angle_rad) * 10.0);
    }
}

static void ask(const char *what)
{
    printf("%s\n", what);
    assert_int_equal(fflush(stdout), 0);
}

enum { JOINTS = 20 };

/* Lets one joint go on a long way; returns the job. */
static int set_going(void)
{
    grobo_posture far_off;

    assert_int_equal(session_kit_await(grobo_robot_torque(
                         grobo_session_robot(session), GROBO_JOINTS_ALL(JOINTS), GROBO_TORQUE_ON)),
                     GROBO_OK);
    assert_int_equal(grobo_posture_init(&far_off, JOINTS), GROBO_OK);
    assert_int_equal(grobo_posture_set_deg(&far_off, 13, 30.0), GROBO_OK);
    far_off.time_us = 20000000;
    return grobo_robot_move(grobo_session_robot(session), &far_off);
}

static void lose_it(int job)
{
    int64_t cpu_us;

    ask("@unplug");
    loop_run_until(base, &seen.losts, 1);
    assert_int_equal(seen.error, GROBO_ERR_UNPLUGGED);
    assert_true(strlen(grobo_session_cause(session)->text) > 0);
    assert_int_equal(seen.job, job);
    assert_int_equal(seen.result, GROBO_ERR_UNPLUGGED);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_WAITING);

    cpu_us = test_cpu_us();
    loop_run_for(base, 1000000);
    cpu_us = test_cpu_us() - cpu_us;
    print_message("told %lld us after the device went; %lld us of processor time in 1 s\n",
                  (long long)(seen.at_us - gone_us), (long long)cpu_us);
    /* An emulated processor: tests/link is stricter with time, on a pseudo-terminal. */
    assert_true(gone_us > 0 && seen.at_us - gone_us < 200000);
    assert_true(cpu_us < 100000);
    assert_int_equal(seen.losts + seen.fails, 1);
}

/* Another adapter takes the old name: it is not the robot. */
static void leave_the_other_alone(const char *device)
{
    seen.tapped[GROBO_DIR_TX] = 0;
    ask("@other");
    while (here_us == 0) {
        assert_false(loop_run(base, 20000000));
    }
    assert_int_equal(access(device, F_OK), 0);
    loop_run_for(base, 500000);
    assert_int_equal(seen.tapped[GROBO_DIR_TX], 0);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_WAITING);
}

static struct event *changes; /* below /dev */

static int set_up(void)
{
    guard = NULL;
    assert_int_equal(guarded_new(self, &guard), GROBO_OK);
    session_kit_begin();
    watch = inotify_init1(IN_NONBLOCK);
    assert_true(inotify_add_watch(watch, "/dev", IN_DELETE) >= 0);
    assert_true(inotify_add_watch(watch, "/dev/serial/by-id", IN_CREATE | IN_MOVED_TO) >= 0);
    changes = event_new(base, watch, EV_READ | EV_PERSIST, on_change, NULL);
    assert_non_null(changes);
    return event_add(changes, NULL);
}

static int tear_down(void)
{
    event_free(changes);
    session_kit_end();
    grobo_guard_free(guard);
    return close(watch);
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

TEST_WITH(fixture, an_adapter_pulled_out_in_a_motion_and_put_back)
{
    const char *device = getenv("GROBO_TEST_DEVICE");
    int16_t before_ddeg[JOINTS];
    int16_t after_ddeg[JOINTS];
    uint64_t frames;

    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = device,
                                            .reconnect = true, .guard = guard,
                                            .guard_data = "known", .guard_bytes = 5});
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.ups, 1);
    lose_it(set_going());
    leave_the_other_alone(device);

    frames = grobo_robot_get_counters(grobo_session_robot(session))->motion_frames;
    ask("@plug");
    loop_run_until(base, &seen.ups, 2);
    print_message("up %lld us after its name came back\n", (long long)(seen.at_us - here_us));
    assert_true(seen.at_us - here_us < 500000);
    assert_string_equal(grobo_session_device(session), getenv("GROBO_TEST_NAME"));

    sense(before_ddeg, JOINTS);
    loop_run_for(base, 1000000);
    sense(after_ddeg, JOINTS);
    assert_memory_equal(after_ddeg, before_ddeg, sizeof before_ddeg);
    assert_int_equal(grobo_robot_get_counters(grobo_session_robot(session))->motion_frames, frames);
    assert_int_equal(seen.fails + seen.unguarded, 0);
}

int main(int argc, char **argv)
{
    int status = guarded_main(argc, argv);

    if (status >= 0) {
        return status;
    }
    self = argv[0];
    if (getenv("GROBO_TEST_DEVICE") == NULL || getenv("GROBO_TEST_NAME") == NULL) {
        fprintf(stderr, "GROBO_TEST_DEVICE and GROBO_TEST_NAME say what to test\n");
        return 2;
    }
    return test_main(argc, argv);
}
