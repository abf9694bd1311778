/* SPDX-License-Identifier: MIT */
/*
 * `grctl play` on a real pty: which frames arrive, when, and where the robot ends. Real time, with
 * bounds wide enough for a busy machine; bench_play has the narrow ones.
 */
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/loop.h>
#include <grobo/core/sim.h>

#include "tests/support/files.h"
#include "tests/support/spy.h"
#include "tests/support/test.h"

enum { LIMIT_S = 60, MOTORS = 20, KEYS_MAX = 64, TRIES = 3 };
enum {
    SLACK_US = 60000, /* in what a frame says, and in how slowly a robot is approached */
    SEEN_US = 300000  /* in when it is seen, by a process that waits its turn too */
};

static const char greet[] = "motions/greet.pseq";

/* Protocol 5: the initial posture, in motor order. greet begins and ends there. */
static const int init_ddeg[MOTORS] = {0, 0,    200,  0, -200, -200, 0, 200, 0,   200,
                                      0, -400, -200, 0, 0,    -200, 0, 400, 200, 0};

static spy s;
static grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT};

/* What the hook of a simulator has seen. */
static struct {
    int goal_ddeg[MOTORS]; /* by servo */
    bool goal_set[MOTORS];
    int torque_on;
} seen;

static int set_up(void)
{
    sim = (grobo_sim_config){GROBO_SIM_CONFIG_INIT};
    memset(&s, 0, sizeof s);
    memset(&seen, 0, sizeof seen);
    return 0;
}

static int tear_down(void)
{
    spy_close(&s);
    return 0;
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

/*
 * A machine that stands still for longer than a quarter of a second ends a motion by right, and
 * shows nothing else: it is played again, to a robot that has just started. Where the test stops
 * the command itself, that is what it wants to see.
 */
static int play(const char *a, const char *b, const char *c)
{
    const char *arguments[] = {"-q", "--json", "--timeout=300", "play", "--unwatched", a, b,
                               c,    NULL};
    if (!getenv("GRCTL")) {
        print_message("no GRCTL to run\n");
        skip();
    }
    for (int tries = 1;; tries++) {
        if (!s.server) {
            assert_true(spy_open(&s, &sim));
        }
        int status = spy_run(&s, arguments, LIMIT_S);
        if (status != 4 || s.on_pose || !strstr(s.out, "host stalled") || tries == TRIES) {
            return status;
        }
        print_message("the machine stood still: once more\n");
        spy_close(&s);
        memset(&s, 0, sizeof s);
        memset(&seen, 0, sizeof seen);
    }
}

/* A number of the line that ends the output; -1 where it is missing. */
static double said(const char *name)
{
    const char *done = strstr(s.out, "{\"done\":true");
    const char *at = done ? strstr(done, name) : NULL;
    return at ? strtod(at + strlen(name) + 2, NULL) : -1; /* behind ": */
}

/* The times of a .pseq, by its lines "    time: 1.5". */
static int key_times_us(const char *path, int64_t times_us[KEYS_MAX])
{
    size_t size;
    char *text = file_text(path, &size);
    int n = 0;
    assert_non_null(text);
    for (char *at = strstr(text, " time: "); at && n < KEYS_MAX; at = strstr(at + 1, " time: ")) {
        times_us[n++] = (int64_t)(strtod(at + 7, NULL) * 1e6 + 0.5);
    }
    free(text);
    return n;
}

static void expect_end(const int ddeg[MOTORS])
{
    for (int motor = 1; motor <= MOTORS; motor++) {
        grobo_sim_view view;
        int servo = grobo_sim_find(grobo_sim_server_sim(s.server), motor);
        assert_int_equal(grobo_sim_look(grobo_sim_server_sim(s.server), servo, &view), 0);
        assert_true(abs(view.angle_mdeg - 100 * ddeg[motor - 1]) <= 100);
        assert_int_equal(view.torque, GROBO_TORQUE_ON);
    }
}

/* ---- key poses ---------------------------------------------------------------------------- */

/*
 * The first frame sets goals to where the joints are, for the torque that comes on; the second is
 * the approach; of the rest, one leaves at each key but the last and lasts until the next. The one
 * that was seen soonest tells when the motion began: on a busy machine the others are late.
 */
static void expect_keys(const char *path)
{
    int64_t key_us[KEYS_MAX];
    int n = key_times_us(path, key_us);
    assert_true(n > 1);
    assert_int_equal(s.n_poses, n + 1);
    int64_t begin_us = INT64_MAX;
    for (int k = 1; k < n; k++) {
        const int64_t at_us = s.poses[k + 1].at_us - key_us[k - 1];
        begin_us = at_us < begin_us ? at_us : begin_us;
    }
    for (int k = 1; k < n; k++) {
        const spy_frame *frame = &s.poses[k + 1];
        const int64_t late_us = frame->at_us - begin_us - key_us[k - 1];
        const int64_t length_us = key_us[k] - key_us[k - 1];
        const int64_t time_us = INT64_C(10000) * spy_time_cs(frame, 1);
        assert_true(late_us <= 2 * SEEN_US);
        /* A frame that leaves late has so much less time. */
        assert_true(time_us >= length_us - late_us - SLACK_US);
        assert_true(time_us <= length_us + 10000);
        for (int motor = 2; motor <= MOTORS; motor++) {
            assert_int_equal(spy_time_cs(frame, motor), spy_time_cs(frame, 1));
        }
    }
}

TEST_WITH(fixture, test_keys)
{
    static const int bow =
        9; /* on the way to the ninth key pose: CHEST_P to -20 degrees, 3.6 s to 4.2 s */
    assert_int_equal(play("--key", greet, NULL), 0);
    expect_keys(greet);
    for (int motor = 1; motor <= MOTORS; motor++) {
        assert_int_equal(spy_angle_ddeg(&s.poses[10], motor), init_ddeg[motor - 1]);
    }
    assert_int_equal(spy_angle_ddeg(&s.poses[bow], 1), -200);
    assert_true(spy_time_cs(&s.poses[bow], 1) <= 60);
    assert_int_equal((int)said("frames"), s.n_poses - 1);
    assert_true(said("max_error_deg") >= 0 && said("max_error_deg") <= 0.1);
    expect_end(init_ddeg);
}

TEST_WITH(fixture, test_keys_of_a_real_motion)
{
    char *path = strdup(shared_file("data/choreonoid/GR001-SampleMotion1.pseq"));
    int last_ddeg[MOTORS];
    assert_int_equal(play("--key", path, NULL), 0);
    expect_keys(path);
    free(path);
    assert_true(said("max_error_deg") >= 0 && said("max_error_deg") <= 0.1);
    for (int motor = 1; motor <= MOTORS; motor++) {
        last_ddeg[motor - 1] = spy_angle_ddeg(&s.poses[s.n_poses - 1], motor);
    }
    expect_end(last_ddeg);
}

/* ---- resampled ---------------------------------------------------------------------------- */

TEST_WITH(fixture, test_rate)
{
    assert_int_equal(play("--rate=50", "--speed=200", greet), 0);
    /* The goals, and 2.5 s less what a busy machine skips. */
    assert_in_range(s.n_poses, 127 - (size_t)said("late_frames"), 127);
    assert_int_equal(s.n_poses - 1, (size_t)said("frames"));
    assert_in_range(s.poses[s.n_poses - 1].at_us - s.poses[1].at_us, 2500000 - SEEN_US,
                    2500000 + SEEN_US);
    expect_end(init_ddeg);
}

/* ---- a host that stalls ------------------------------------------------------------------- */

static int64_t stall_us;
static grobo_timer *wake;
static int64_t awake_us; /* when the child went on */

static void on_wake(void *ctx, grobo_timer *timer, int64_t late_us)
{
    (void)timer;
    (void)late_us;
    (void)ctx;
    awake_us = grobo_now_us();
    kill(s.child, SIGCONT);
}

/* A second into the motion the command is stopped, and it goes on a while later. */
static void on_pose(spy *of)
{
    if (of->n_poses != 50) {
        return;
    }
    kill(of->child, SIGSTOP);
    assert_int_equal(grobo_timer_new(of->base, on_wake, NULL, NULL, &wake), 0);
    assert_int_equal(grobo_timer_set(wake, grobo_now_us() + stall_us), 0);
}

static int play_with_a_stall(int64_t length_us)
{
    int status;
    assert_true(spy_open(&s, &sim));
    s.on_pose = on_pose;
    stall_us = length_us;
    wake = NULL;
    /* What the motion itself does: a guard would stop the robot after 100 ms. */
    assert_int_equal(setenv("GRCTL_GUARD", "", 1), 0);
    status = play("--rate=50", "--speed=200", greet);
    assert_int_equal(unsetenv("GRCTL_GUARD"), 0);
    grobo_timer_free(wake);
    return status;
}

TEST_WITH(fixture, test_short_stall)
{
    assert_int_equal(play_with_a_stall(150000), 0);
    /* 150 ms are seven frames; the last of them still fits. What was missed is not sent: when
     * frames arrive tells nothing, as this process may have been stalled too. */
    assert_true(said("late_frames") >= 6);
    assert_true(said("frames") <= 126 - 6);
    assert_int_equal(s.n_poses - 1, (size_t)said("frames"));
    expect_end(init_ddeg);
}

TEST_WITH(fixture, test_long_stall)
{
    size_t after = 0;
    assert_int_equal(play_with_a_stall(700000), 4);
    for (size_t i = 0; i < s.n_poses; i++) {
        after += s.poses[i].at_us >= awake_us;
    }
    assert_true(after <= 1); /* to hold where it is, no motion */
    assert_true(s.n_poses < 60);
}

/* ---- safety ------------------------------------------------------------------------------- */

static int32_t start_mdeg[MOTORS]; /* by servo */

static void on_sim(void *ctx, const grobo_sim_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_SIM_GOAL) {
        seen.goal_ddeg[event->servo] = event->value;
        seen.goal_set[event->servo] = true;
    } else if (event->kind == GROBO_SIM_TORQUE && event->value == GROBO_TORQUE_ON) {
        seen.torque_on++;
        assert_true(seen.goal_set[event->servo]);
        assert_true(abs(100 * seen.goal_ddeg[event->servo] - start_mdeg[event->servo]) <= 100);
    }
}

/* Joints anywhere: they hold where they are, then go to the first posture slowly. */
TEST_WITH(fixture, test_limp_robot)
{
    sim = (grobo_sim_config){GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP, .seed = 7,
                             .hook = on_sim};
    assert_true(spy_open(&s, &sim));
    for (int servo = 0; servo < MOTORS; servo++) {
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(grobo_sim_server_sim(s.server), servo, &view), 0);
        start_mdeg[servo] = view.angle_mdeg;
    }
    assert_int_equal(play("--key", greet, NULL), 0);
    assert_int_equal(seen.torque_on, MOTORS);
    assert_true(s.n_poses > 3);
    for (int motor = 1; motor <= MOTORS; motor++) {
        const int servo = grobo_sim_find(grobo_sim_server_sim(s.server), motor);
        const int way_mdeg = abs(100 * spy_angle_ddeg(&s.poses[1], motor) - start_mdeg[servo]);
        const int time_ms = 10 * spy_time_cs(&s.poses[1], motor);
        assert_true(way_mdeg <= 61 * time_ms); /* 60 deg/s, and what rounding to 10 ms adds */
        assert_true(s.poses[2].at_us - s.poses[1].at_us >= 1000 * time_ms - SLACK_US);
    }
    expect_end(init_ddeg);
}

/* A motion with an angle outside limits: not one byte leaves. */
TEST_WITH(fixture, test_outside_limits)
{
    char path[] = "/tmp/test_play_line.XXXXXX";
    int fd = mkstemp(path);
    FILE *file = fd >= 0 ? fdopen(fd, "w") : NULL;
    int status;
    assert_non_null(file);
    fputs("1000 0 0 200 0 -200 -200 0 200 0 200 0 -400 -200 0 0 -200 0 400 200 0\n"
          "2000 0 0 200 0 -200 -200 0 200 0 200 0 -1330 -200 0 0 -200 0 400 200 0\n",
          file);
    fclose(file);
    status = play("--key", path, NULL);
    remove(path);
    assert_int_equal(status, 4);
    assert_int_equal(s.bytes, 0);
    assert_non_null(strstr(s.out, ":2:"));
    assert_non_null(strstr(s.out, "R_KNEE_P"));
}
