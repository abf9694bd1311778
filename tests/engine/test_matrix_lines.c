/* SPDX-License-Identifier: MIT */
/*
 * Robots of every family with 1 to 64 joints at the slowest, the factory's and the fastest rate of
 * their line, each in one go: connect, read, init, move, play keys and at a rate, stop on the way,
 * torque off. Judged by a far side (tests/support/far_side.h): joints arrive, stand and are limp,
 * no frame is broken, and nothing trips. What a line cannot do is on a list, each with its reason:
 * it is refused at once, before a joint moves.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "src/robot/slot.h"
#include "tests/support/halt_kit.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { LONG_MS = 60000, KEY_US = 500000, KEYS = 5, ABOVE_ALL = GROBO_JOINTS_MAX + 1 };

typedef struct line {
    const char *of;
    int ids; /* as many as a line takes, from 1 on */
    int baud_bps;
    int refused; /* from so many joints on moves of all are refused */
    const char *why;
} line;

static const line lines[] = {
    {"board", 64, 115200, ABOVE_ALL, "goals are whole: no frame is due"},
    {"bus", 64, 9600, ABOVE_ALL, "the same"},
    {"bus", 64, 115200, ABOVE_ALL, "the same"},
    {"bus", 64, 460800, ABOVE_ALL, "the same"},
    {"dxl2", 64, 9600, 17, "17 goals take 245 ms, a reading 115 ms, a segment 380 ms"},
    {"dxl2", 64, 57600, 64, "64 goals take 147 ms, 64 readings in 2 s as long again each time"},
    {"dxl2", 64, 4000000, ABOVE_ALL, NULL},
    {"dxl1", 64, 9600, 6, "6 readings take 253 ms, goals 40 ms, one more reading 42 ms"},
    {"dxl1", 64, 1000000, ABOVE_ALL, NULL},
    {"mx", 64, 9600, 6, "the same"},
    {"mx", 64, 57600, 40, "40 readings take 297 ms, goals 36 ms: 350 ms are spare enough"},
    {"mx", 64, 3000000, ABOVE_ALL, NULL},
    {"sts", 64, 38400, 17, "17 readings take 170 ms, goals 38 ms, and 17 readings may be begun"},
    {"sts", 64, 1000000, ABOVE_ALL, NULL},
    {"scs", 64, 38400, 31, "31 readings take 324 ms, goals 59 ms"},
    {"scs", 64, 1000000, ABOVE_ALL, NULL},
    {"ics", 31, 115200, ABOVE_ALL, "goals are answered: nothing else needs be read in time"},
    {"ics", 31, 625000, ABOVE_ALL, NULL},
    {"ics", 31, 1250000, ABOVE_ALL, NULL},
    {"lx16a", 64, 115200, 64, "64 readings take 427 ms, each is needed in 400 ms"},
};
static const int counts[] = {1, 6, 17, 20, 22, 31, 40, 64};

enum { LINES = sizeof lines / sizeof lines[0], COUNTS = sizeof counts / sizeof counts[0] };

static halt_robot made;
static char what[120];
static struct {
    int awaited, result, trips;
    bool ended;
    grobo_trip trip;
    grobo_sequencer_state state;
} seen;

static void note(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_TRIP) {
        seen.trips++;
        seen.trip = event->u.trip.trip;
    } else if (event->kind == GROBO_EVENT_JOB && event->u.job.number == seen.awaited) {
        seen.ended = true;
        seen.result = event->u.job.result;
    } else if (event->kind == GROBO_EVENT_PLAY) {
        seen.state = event->u.play.to;
    }
}

static grobo_joint_mask all(void)
{
    return GROBO_JOINTS_ALL(made.n_joints);
}

static grobo_posture at(double deg, int64_t time_us)
{
    grobo_posture p;
    assert_int_equal(grobo_posture_init(&p, made.n_joints), GROBO_OK);
    for (int j = 0; j < made.n_joints; j++) {
        p.angle_rad[j] = RAD(deg);
    }
    p.set = all();
    p.time_us = time_us;
    (void)grobo_posture_clamp(&p, made.driver.model);
    return p;
}

static int key_at(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    *at_us = (int64_t)i * KEY_US;
    *posture = at(i % 2 == 0 ? -10 : 10, i == 0 ? 0 : KEY_US);
    return 0;
}

static int sample_at(void *ctx, int64_t t_us, grobo_posture *posture)
{
    (void)ctx;
    *posture = at(-10 * cos((double)t_us / KEY_US * 180 * RAD(1)), 0);
    return 0;
}

/* ---- steps ----------------------------------------------------------------------------------- */

static int await(int number)
{
    seen.awaited = number;
    seen.ended = false;
    for (int ms = 0; number > 0 && ms < LONG_MS && !seen.ended; ms++) {
        halt_run(HALT_MS);
    }
    return number <= 0 ? number : seen.ended ? seen.result : GROBO_ERR_TIMEOUT;
}

static void expect(const char *step, int result, int expected)
{
    if (result != expected) {
        fail_msg("%s: %s: %s, not %s (trip: %s)", what, step, grobo_error_name(result),
                 grobo_error_name(expected), seen.trips > 0 ? grobo_trip_name(seen.trip) : "none");
    }
    if (seen.trips > 0) {
        fail_msg("%s: %s: stopped for safety: %s", what, step, grobo_trip_name(seen.trip));
    }
}

/* All joints are read to be there, and stand on the far side. */
static void expect_at(const char *step, double deg)
{
    grobo_posture p = at(deg, 0);
    halt_run(500 * HALT_MS);
    expect("read", await(grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_FULL)), GROBO_OK);
    for (int j = 0; j < made.n_joints; j++) {
        grobo_joint_info info;
        assert_int_equal(grobo_robot_joint(&halt.robot, j, &info), GROBO_OK);
        double off_deg = (info.state.angle_rad - p.angle_rad[j]) / RAD(1);
        if (far_turns(&halt.far, made.driver.model->joints[j].motor - 1, halt.now_us) ||
            fabs(off_deg) > 2) {
            fail_msg("%s: %s: joint %d is %.1f degrees off", what, step, j + 1, off_deg);
        }
    }
}

static int play(grobo_play_mode mode)
{
    const grobo_clip clip = {.key = key_at,
                             .sample = sample_at,
                             .length_us = (KEYS - 1) * KEY_US,
                             .n_keys = KEYS,
                             .n_joints = (uint8_t)made.n_joints};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = mode};
    int result = await(grobo_robot_play(&halt.robot, &clip, &options));
    for (int ms = 0; result >= 0 && ms < LONG_MS; ms++) {
        halt_run(HALT_MS);
        if (!grobo_robot_is_playing(&halt.robot) && !grobo_robot_settling(&halt.robot)) {
            return seen.state == GROBO_SEQUENCER_FINISHED ? GROBO_OK : GROBO_ERR_CANCELED;
        }
    }
    return result < 0 ? result : GROBO_ERR_TIMEOUT;
}

static void stop_on_the_way(void)
{
    grobo_posture p = at(10, 3000000);
    assert_true(grobo_robot_move(&halt.robot, &p) > 0);
    halt_run(600 * HALT_MS);
    expect("stop", grobo_robot_stop(&halt.robot, true), GROBO_OK);
    for (int ms = 0; ms < 20000 && grobo_robot_moving(&halt.robot); ms++) {
        halt_run(HALT_MS);
    }
    halt_run(600 * HALT_MS);
    for (int j = 0; j < made.n_joints; j++) {
        if (far_turns(&halt.far, made.driver.model->joints[j].motor - 1, halt.now_us)) {
            fail_msg("%s: joint %d turns behind a stop", what, j + 1);
        }
    }
}

static void expect_limp(void)
{
    expect("torque off", await(grobo_robot_torque(&halt.robot, all(), GROBO_TORQUE_OFF)), GROBO_OK);
    for (int j = 0; j < made.n_joints; j++) {
        if (halt.far.joint[made.driver.model->joints[j].motor - 1].torque != 0) {
            fail_msg("%s: joint %d has torque yet", what, j + 1);
        }
    }
}

/* ---- cells ----------------------------------------------------------------------------------- */

static void begin(const char *of, int n, int baud_bps)
{
    static const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT};
    (void)snprintf(what, sizeof what, "%d joints of %s at %d bps", n, of, baud_bps);
    halt_robot_make(&made, of, n, baud_bps);
    halt_begin(&made, 0);
    halt_new_engine(&config);
    grobo_robot_on_event(&halt.robot, note, NULL);
    memset(&seen, 0, sizeof seen);
}

static void refuse_moves(void)
{
    grobo_posture p = at(0, 1000000);
    int motor_frames = halt.far.motor_frames;
    expect("init", grobo_robot_move(&halt.robot, &p), GROBO_ERR_UNWATCHED);
    expect("keys", play(GROBO_PLAY_KEY), GROBO_ERR_UNWATCHED);
    assert_int_equal(halt.far.motor_frames, motor_frames);
    p.set = GROBO_JOINT_BIT(0); /* one of them can */
    expect("a move of one", await(grobo_robot_move(&halt.robot, &p)), GROBO_OK);
}

static void drive(const grobo_budget *budget)
{
    grobo_posture p = at(0, 0);
    expect("init", await(grobo_robot_move(&halt.robot, &p)), GROBO_OK);
    expect_at("init", 0);
    p = at(-10, 1000000);
    expect("move", await(grobo_robot_move(&halt.robot, &p)), GROBO_OK);
    expect_at("move", -10);
    expect("keys", play(GROBO_PLAY_KEY), GROBO_OK);
    expect_at("keys", -10);
    expect("rate", play(GROBO_PLAY_RATE), budget->watched_hz > 0 ? GROBO_OK : GROBO_ERR_UNWATCHED);
    expect_at("rate", -10);
    stop_on_the_way();
}

static void run_cell(const line *l, int n)
{
    grobo_budget budget;
    begin(l->of, n, l->baud_bps);
    assert_int_equal(grobo_robot_budget(&halt.robot, &budget), GROBO_OK);
    expect("read", await(grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_ALL)), GROBO_OK);
    if (n >= l->refused) {
        assert_int_equal(budget.pace_us, 0);
        refuse_moves();
    } else {
        assert_true(!made.driver.arm || budget.pace_us >= GROBO_SEGMENT_RENEW_US);
        drive(&budget);
    }
    expect_limp();
    assert_int_equal(halt.far.broken_frames, 0);
}

static void run_line(const line *l)
{
    for (int i = 0; i < COUNTS && counts[i] <= l->ids; i++) {
        run_cell(l, counts[i]);
    }
}

TEST(a_line_does_what_it_can_board_and_bus)
{
    for (int i = 0; i < 4; i++) {
        run_line(&lines[i]);
    }
}

TEST(a_line_does_what_it_can_of_other_families)
{
    for (int i = 4; i < LINES; i++) {
        run_line(&lines[i]);
    }
}

/* ---- many frames ----------------------------------------------------------------------------- */

/* A family has two frames a joint: new goals, more of the ways before and a reading wait at a time.
 * There is a place for each, at every moment. */
TEST(a_place_is_left_however_many_frames_wait)
{
    for (int n = 20; n <= 31; n += 11) {
        for (int after_ms = 0; after_ms < 110; after_ms += 7) {
            begin("ics", n, 115200);
            grobo_posture p = at(0, 0);
            expect("init", await(grobo_robot_move(&halt.robot, &p)), GROBO_OK);
            p = at(40, 1500000);
            assert_true(grobo_robot_move(&halt.robot, &p) > 0);
            halt_run((400 + after_ms) * HALT_MS);
            p = at(-40, 2500000);
            assert_true(grobo_robot_retarget(&halt.robot, &p) > 0);
            seen.awaited = grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_FULL);
            for (int ms = 0; ms < 200; ms++) {
                assert_true(grobo_i_slot_find(&halt.robot, GROBO_I_USE_JOB) >= 0);
                halt_run(HALT_MS);
            }
            expect("read", seen.ended ? seen.result : await(seen.awaited), GROBO_OK);
        }
    }
}
