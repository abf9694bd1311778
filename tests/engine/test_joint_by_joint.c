/* SPDX-License-Identifier: MIT */
/*
 * Torque, readings, moves and brake asked for joint by joint in one go: none is refused, each ends
 * once, every joint is as it was asked for, and the line carries no more frames than for one
 * request of all joints. All families, robots of 1 to 64 joints, slow and fast lines; judged by a
 * far side (tests/support/far_side.h).
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/halt_kit.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { MANY_US = 300, LONG_S = 60, MOVE_US = 900000, NUMBERS = 1024 };

typedef enum kind { ON, READ, MOVE, OFF, BRAKE, KINDS } kind;
static const char *const kind_names[] = {"torque on", "read", "move", "torque off", "brake"};

typedef struct set_up {
    const char *name, *of;
    int baud_bps;
    int joints[5]; /* ends with 0 */
} set_up;

static const set_up set_ups[] = {
    {"on the board", "board", 115200, {1, 6, 20, 64}},
    {"on a slow bus", "bus", 57600, {1, 6, 20, 64}},
    {"on a fast bus", "bus", 460800, {1, 6, 20, 64}},
    {"DYNAMIXEL 2 on a slow line", "dxl2", 57600, {1, 6, 20, 64}},
    {"DYNAMIXEL 2 on a fast line", "dxl2", 3000000, {1, 6, 20, 64}},
    {"AX on a slow line", "dxl1", 57600, {1, 6, 20, 32}},
    {"AX on a fast line", "dxl1", 1000000, {1, 6, 20, 32}},
    {"MX on a fast line", "mx", 1000000, {1, 6, 20, 40}},
    {"STS on the slowest line", "sts", 38400, {1, 6}},
    {"STS on a slow line", "sts", 115200, {1, 6, 20}},
    {"STS on a fast line", "sts", 1000000, {1, 6, 20, 64}},
    {"SCS on a fast line", "scs", 1000000, {1, 6, 20, 40}},
    {"KRS on a slow line", "ics", 115200, {1, 6, 20, 31}},
    {"KRS on a fast line", "ics", 1250000, {1, 6, 20, 31}},
    {"LX-16A", "lx16a", 115200, {1, 6, 20, 40}},
};

static halt_robot made;
static int read_joints[GROBO_JOINTS_MAX];
static int ends[NUMBERS];
static int bad_end; /* the first error that a job ended with */
static grobo_joint_mask bad_joints;
static double most_dps;

static void note(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOINT && event->u.joint.result >= 0) {
        read_joints[event->u.joint.joint]++;
    } else if (event->kind == GROBO_EVENT_JOB) {
        assert_in_range(event->u.job.number, 1, NUMBERS - 1);
        ends[event->u.job.number]++;
        bad_end = bad_end < 0 ? bad_end : event->u.job.result;
        bad_joints |= event->u.job.failed;
    }
}

static double target_deg(int joint)
{
    return joint % 2 == 0 ? 4 : -3;
}

static grobo_posture target_of(grobo_joint_mask joints, int64_t time_us)
{
    grobo_posture p;
    assert_int_equal(grobo_posture_init(&p, made.n_joints), 0);
    for (int j = 0; j < made.n_joints; j++) {
        p.angle_rad[j] = RAD(target_deg(j));
    }
    p.set = joints;
    p.time_us = time_us;
    (void)grobo_posture_clamp(&p, made.driver.model);
    return p;
}

static int ask(kind d, grobo_joint_mask joints, int64_t time_us)
{
    grobo_posture target = target_of(joints, time_us);
    switch (d) {
    case ON:
        return grobo_robot_torque(&halt.robot, joints, GROBO_TORQUE_ON);
    case READ:
        return grobo_robot_sense(&halt.robot, joints, GROBO_SENSE_FULL);
    case MOVE:
        return grobo_robot_move(&halt.robot, &target);
    case OFF:
        return grobo_robot_torque(&halt.robot, joints, GROBO_TORQUE_OFF);
    case BRAKE:
        return grobo_robot_torque(&halt.robot, joints, GROBO_TORQUE_BRAKE);
    case KINDS:
        break;
    }
    return GROBO_ERR_ARG;
}

/* No goal asks for more than its joint's speed. */
static void judge_speed(void *ctx, const far_news *news)
{
    (void)ctx;
    most_dps = news->is_goal && news->ask_dps > most_dps ? news->ask_dps : most_dps;
}

static bool can_brake(void)
{
    return made.far == &far_board || made.far == &far_bus;
}

static int end_of(kind d)
{
    return d == BRAKE && !can_brake() ? GROBO_ERR_UNSUPPORTED : GROBO_OK;
}

static int far_torque_of(kind d)
{
    return d == ON || d == MOVE || end_of(d) < 0 ? 1 : d == BRAKE ? 2 : 0;
}

static void begin(const set_up *s, int n, kind d)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                       .sense_interval_us = GROBO_SENSE_NEVER};
    halt_robot_make(&made, s->of, n, s->baud_bps);
    halt_begin(&made, 0);
    halt_new_engine(&config);
    grobo_robot_on_event(&halt.robot, note, NULL);
    memset(ends, 0, sizeof ends);
    memset(read_joints, 0, sizeof read_joints);
    bad_end = 0;
    bad_joints = 0;
    if (d > READ) { /* all hold, and the slow first move is over */
        int number = ask(ON, GROBO_JOINTS_ALL(n), 0);
        assert_true(number > 0);
        for (int ms = 0; ends[number] == 0 && ms < LONG_S * 1000; ms++) {
            halt_run(HALT_MS);
        }
        assert_int_equal(ends[number], 1);
        grobo_posture here = target_of(GROBO_JOINTS_ALL(n), MOVE_US);
        for (int j = 0; j < n; j++) {
            here.angle_rad[j] = fmin(fmax(0, made.driver.model->joints[j].min_rad),
                                     made.driver.model->joints[j].max_rad);
        }
        number = grobo_robot_move(&halt.robot, &here);
        assert_true(number > 0);
        for (int ms = 0; ends[number] == 0 && ms < LONG_S * 1000; ms++) {
            halt_run(HALT_MS);
        }
        assert_int_equal(ends[number], 1);
    }
    assert_int_equal(bad_end, GROBO_OK);
    halt_run(HALT_S);
    memset(read_joints, 0, sizeof read_joints);
    halt.far.frames = 0;
    halt.far.hear = judge_speed;
    most_dps = 0;
}

/* Lets all of these jobs end, each once. */
static void await_all(const int *number, int n, int expected, const char *what)
{
    bool over = false;
    for (int ms = 0; !over && ms < LONG_S * 1000; ms++) {
        halt_run(HALT_MS);
        over = true;
        for (int i = 0; i < n; i++) {
            over = over && ends[number[i]] > 0;
        }
    }
    for (int i = 0; i < n; i++) {
        if (ends[number[i]] != 1) {
            fail_msg("%s: the job of request %d ended %d times", what, i + 1, ends[number[i]]);
        }
    }
    if (bad_end != expected) {
        fail_msg("%s: %s", what, grobo_error_name(bad_end));
    }
    assert_true(expected < 0 || bad_joints == 0);
}

static void expect_done(kind d, const char *what)
{
    grobo_posture target = target_of(GROBO_JOINTS_ALL(made.n_joints), 0);
    for (int j = 0; j < made.n_joints; j++) {
        int servo = made.driver.model->joints[j].motor - 1;
        if (d == READ && read_joints[j] == 0) {
            fail_msg("%s: joint %d was not read", what, j + 1);
        }
        if (halt.far.joint[servo].torque != far_torque_of(d)) {
            fail_msg("%s: torque of joint %d is %d", what, j + 1, halt.far.joint[servo].torque);
        }
        double place_rad;
        grobo_joint_info info;
        assert_int_equal(grobo_robot_joint(&halt.robot, j, &info), GROBO_OK);
        place_rad = info.state.angle_rad;
        if (d == MOVE && fabs(place_rad - target.angle_rad[j]) > RAD(1.5)) {
            fail_msg("%s: joint %d is %.2f degrees off", what, j + 1,
                     (place_rad - target.angle_rad[j]) / RAD(1));
        }
    }
    double allowed_dps = made.driver.model->joints[0].max_speed_rad_s / RAD(1) * 1.02 + 4;
    if (most_dps > allowed_dps) {
        fail_msg("%s: a goal asks for %.0f deg/s", what, most_dps);
    }
    assert_int_equal(halt.far.broken_frames, 0);
}

/* All at once: the frames that it takes. */
static int frames_of_one(const set_up *s, int n, kind d)
{
    char what[120];
    (void)snprintf(what, sizeof what, "%s, %s, %d joints at once", s->name, kind_names[d], n);
    begin(s, n, d);
    int number = ask(d, GROBO_JOINTS_ALL(n), MOVE_US);
    if (number <= 0) {
        fail_msg("%s: %s", what, grobo_error_name(number));
    }
    await_all(&number, 1, end_of(d), what);
    expect_done(d, what);
    return halt.far.frames;
}

/* gap_us: the engine runs so long behind each request; 0: it does not. step_us: how much longer
 * each move is than the one before. */
static int frames_of_each(const set_up *s, int n, kind d, int gap_us, int step_us)
{
    int number[GROBO_JOINTS_MAX];
    char what[120];
    (void)snprintf(what, sizeof what, "%s, %s, %d joints one by one, %d us and %d us between",
                   s->name, kind_names[d], n, gap_us, step_us);
    begin(s, n, d);
    for (int j = 0; j < n; j++) {
        number[j] = ask(d, GROBO_JOINT_BIT(j), MOVE_US + (int64_t)j * step_us);
        if (number[j] <= 0) {
            fail_msg("%s: request %d: %s", what, j + 1, grobo_error_name(number[j]));
        }
        if (gap_us > 0) {
            halt_run(gap_us);
        }
    }
    await_all(number, n, end_of(d), what);
    expect_done(d, what);
    return halt.far.frames;
}

TEST_EACH(set_up, set_ups, a_robot_is_asked_joint_by_joint)
{
    for (const int *n = row->joints; *n != 0; n++) {
        for (kind d = ON; d < KINDS; d++) {
            int one = frames_of_one(row, *n, d);
            int each = frames_of_each(row, *n, d, 0, 0);
            if (each > one) {
                fail_msg("%s, %s: %d joints take %d frames, one by one %d", row->name,
                         kind_names[d], *n, one, each);
            }
            (void)frames_of_each(row, *n, d, MANY_US, 0);
            if (d == MOVE) {
                (void)frames_of_each(row, *n, d, 0, 7000);
            }
        }
    }
}
