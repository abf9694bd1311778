/* SPDX-License-Identifier: MIT */
/*
 * Wheels against the far side (tests/support/far_side.h), which shares no code with the library or
 * its simulator: stopped in every way at every moment from the first frame on, with none or one of
 * the frames behind the stop lost. The judge sees shafts alone.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/feetech.h>
#include <grobo/core/static.h>
#include <grobo/core/wheel.h>

#include "src/base/instant.h"
#include "tests/support/far_side.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)
#define DEG(rad) ((rad) / 0.017453292519943295)
#define MOST_DPS 120.0
#define ACCEL_DPS2 400.0

enum { MS = 1000, S = 1000000, JOINTS = 3, WHEELS = 3 };

typedef struct kind {
    const far_family *far;
    const grobo_servo_table *table;
    const char *servo;
    int (*init)(grobo_driver *driver, const grobo_model *model);
    int mode; /* the register */
    bool watches;
} kind;

static const kind kinds[] = {
    {&far_sts, &grobo_i_sts_table, "STS3215", grobo_feetech_driver_init, 33, false},
    {&far_dxl2, &grobo_i_dxl2_table, "XL430-W250", grobo_dxl2_driver_init, 11, true},
};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

static grobo_joint joints[JOINTS];
static grobo_model model;
static grobo_driver driver;
static grobo_robot robot;
static far_side far;
static int64_t now_us;
static int result_of[64]; /* of jobs, by number */
static grobo_event_halted halted;
static int n_halted;
static double fastest_dps, steepest_dps2;
static bool quits; /* the host is dead: nothing is pumped */

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB && event->u.job.number < 64) {
        result_of[event->u.job.number] = event->u.job.result <= 0 ? event->u.job.result : 0;
    } else if (event->kind == GROBO_EVENT_HALTED) {
        halted = event->u.halted;
        n_halted++;
    }
}

static double dps_of(int joint)
{
    (void)far_angle(&far, joint, now_us);
    return far.joint[joint].dps * (joint == 1 ? -1 : 1);
}

/* No shaft is ever faster than its limit, nor speeds up faster than it may; a stop may brake. */
static void judge_speeds(void)
{
    static double before_dps[2];
    static int64_t before_us;
    for (int j = 0; j < 2; j++) {
        double dps = dps_of(j);
        fastest_dps = fmax(fastest_dps, fabs(dps));
        if (now_us - before_us >= 300 * MS && fabs(dps) > fabs(before_dps[j])) {
            double gained_dps = fabs(dps - before_dps[j]);
            steepest_dps2 = fmax(steepest_dps2, gained_dps * 1e6 / (double)(now_us - before_us));
        }
    }
    if (now_us - before_us >= 300 * MS || now_us < before_us) {
        before_us = now_us;
        before_dps[0] = dps_of(0);
        before_dps[1] = dps_of(1);
    }
}

static void run(int64_t us)
{
    int64_t until_us = now_us + us;
    for (int spins = 0; now_us < until_us; spins++) {
        uint8_t bytes[FAR_FRAME_BYTES];
        int n;
        assert_true(spins < 1000000);
        far_step(&far, now_us);
        while ((n = far_give(&far, bytes, (int)sizeof bytes, now_us)) > 0 && !quits) {
            grobo_robot_rx(&robot, bytes, (size_t)n, now_us);
        }
        int64_t next_us = far_next_us(&far);
        if (!quits) {
            grobo_robot_step(&robot, now_us);
            n = grobo_robot_tx(&robot, bytes, sizeof bytes, now_us);
            assert_true(n >= 0);
            if (n > 0) {
                far_take(&far, bytes, n, now_us);
            }
            next_us = grobo_i_sooner(grobo_robot_deadline(&robot, now_us), far_next_us(&far));
        }
        judge_speeds();
        now_us = grobo_i_sooner(grobo_i_later(next_us, now_us), until_us);
    }
}

static void make_engine(const kind *k)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT};
    config.bus.baud_bps = (uint32_t)k->far->baud_bps;
    assert_int_equal(grobo_robot_init(&robot, &driver, NULL, &config, now_us), GROBO_OK);
    grobo_robot_on_event(&robot, on_event, NULL);
    grobo_robot_link_up(&robot, now_us);
    memset(result_of, 1, sizeof result_of);
    n_halted = 0;
}

static void begin(const kind *k)
{
    static const char *const names[JOINTS] = {"left", "right", "pan"};
    const grobo_servo_model *servo = grobo_servo_model_named(k->table, k->servo);
    now_us = S;
    quits = false;
    for (int j = 0; j < JOINTS; j++) {
        joints[j] = (grobo_joint){.name = names[j],
                                  .max_speed_rad_s = RAD(MOST_DPS),
                                  .servo = servo,
                                  .servo_model = servo->number,
                                  .motor = (uint8_t)(j + 1),
                                  .mirror = (uint8_t)j,
                                  .mirror_sign = 1,
                                  .sign = j == 1 ? -1 : 1,
                                  .wheel = j < 2,
                                  .accel_rad_s2 = j < 2 ? RAD(ACCEL_DPS2) : 0,
                                  .min_rad = j < 2 ? 0 : -1,
                                  .max_rad = j < 2 ? 0 : 1};
    }
    model = (grobo_model)GROBO_TABLE(grobo_model, .name = "rover", GROBO_MODEL_JOINTS(joints),
                                     .n_joints = JOINTS);
    driver = (grobo_driver)GROBO_TABLE_INIT(grobo_driver);
    assert_int_equal(k->init(&driver, &model), GROBO_OK);
    far_begin(&far, k->far, JOINTS, now_us);
    for (int j = 0; j < 2; j++) {
        far.joint[j].reg[k->mode] = 1;
        far.joint[j].wheel = true;
    }
    make_engine(k);
    int number = grobo_robot_torque(&robot, WHEELS, GROBO_TORQUE_ON);
    assert_true(number > 0 && number < 64);
    run(500 * MS);
    assert_int_equal(result_of[number], GROBO_OK);
    fastest_dps = steepest_dps2 = 0;
}

static void drive_for(double a_dps, double b_dps, int64_t us)
{
    const double rad_s[JOINTS] = {RAD(a_dps), RAD(b_dps)};
    for (int64_t end_us = now_us + us; now_us < end_us;) {
        assert_int_equal(grobo_robot_drive(&robot, WHEELS, rad_s), GROBO_OK);
        run(grobo_i_sooner(end_us - now_us, 100 * MS));
    }
}

TEST(shafts_turn_as_asked)
{
    for (const kind *k = kinds; k < kinds + KINDS; k++) {
        begin(k);
        drive_for(120, -90, S);
        assert_true(fabs(dps_of(0) - 120) < 1 && fabs(dps_of(1) + 90) < 1);
        drive_for(-120, 90, 1500 * MS);
        assert_true(fabs(dps_of(0) + 120) < 1 && fabs(dps_of(1) - 90) < 1);
        drive_for(0, 0, S);
        assert_true(dps_of(0) == 0 && dps_of(1) == 0);
        assert_true(fastest_dps <= MOST_DPS + 1);
        assert_true(steepest_dps2 > ACCEL_DPS2 / 2 && steepest_dps2 < 1.25 * ACCEL_DPS2);
        drive_for(60, 60, 300 * MS);
        run(700 * MS); /* nobody asks any more */
        assert_true(dps_of(0) == 0 && dps_of(1) == 0);
    }
}

/* The frame of a speed left the engine so late that the speed is over: it turns nothing. */
TEST(a_frame_that_waited_too_long_turns_no_wheel)
{
    for (const kind *k = kinds; k < kinds + KINDS; k++) {
        uint8_t bytes[FAR_FRAME_BYTES];
        const double rad_s[JOINTS] = {RAD(100), RAD(100)};
        begin(k);
        assert_int_equal(grobo_robot_drive(&robot, WHEELS, rad_s), GROBO_OK);
        grobo_robot_step(&robot, now_us);
        now_us += GROBO_DRIVE_US + 50 * MS;
        int n = grobo_robot_tx(&robot, bytes, sizeof bytes, now_us);
        if (n > 0) { /* not to a servo that a goal wakes, and that was not heard for so long */
            far_take(&far, bytes, n, now_us);
        }
        now_us += 10 * MS;
        far_step(&far, now_us);
        assert_true(dps_of(0) == 0 && dps_of(1) == 0);
    }
}

/* What another program has left behind does not begin with the torque, though the frame that takes
 * it away is lost. */
TEST(torque_comes_on_only_where_speed_0_was_read_back)
{
    for (const kind *k = kinds; k < kinds + KINDS; k++) {
        begin(k);
        assert_int_equal(grobo_robot_exit(&robot, GROBO_EXIT_OFF) > 0, 1);
        run(S);
        for (int j = 0; j < 2; j++) {
            far.joint[j].reg[k->far == &far_sts ? 46 : 104] = 200;
            far.joint[j].wheel_dps = 50;
        }
        far.lose_motor = 0;
        double before_deg = far_angle(&far, 0, now_us);
        int number = grobo_robot_torque(&robot, WHEELS, GROBO_TORQUE_ON);
        run(S);
        assert_int_equal(result_of[number], GROBO_OK);
        assert_int_equal(far.joint[0].torque, 1);
        assert_true(fabs(far_angle(&far, 0, now_us) - before_deg) < 0.01);
    }
}

/* Torque goes off beside a drive: nothing more is said to the wheels. */
TEST(wheels_without_torque_are_told_no_speed)
{
    for (const kind *k = kinds; k < kinds + KINDS; k++) {
        grobo_wheel_info info;
        begin(k);
        drive_for(100, 100, 300 * MS);
        int number = grobo_robot_torque(&robot, WHEELS, GROBO_TORQUE_OFF);
        run(200 * MS);
        assert_int_equal(result_of[number], GROBO_OK);
        int frames = far.motor_frames;
        assert_int_equal(grobo_robot_wheel(&robot, 0, &info), GROBO_OK);
        assert_true(info.asked_rad_s == 0 && info.left_us == 0);
        run(500 * MS);
        assert_int_equal(far.motor_frames, frames);
        assert_false(grobo_robot_moving(&robot));
    }
}

/* ---- stopped --------------------------------------------------------------------------------- */

typedef enum way {
    STOP,
    SOFTLY,
    EXIT_AND_HOLD,
    EXIT_AND_OFF,
    ESTOP,
    ESTOP_OFF,
    LINE,  /* the line is lost, and back 0.2 s later */
    GUARD, /* the program dies; another one leaves the robot well */
    WAYS
} way;

static const char *const way_names[WAYS] = {"stop",  "softly",     "exit, hold", "exit, off",
                                            "estop", "estop, off", "line",       "guard"};

static int64_t stop(const kind *k, way how)
{
    int64_t from_us = now_us;
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .estop_torque = GROBO_ESTOP_OFF};
    switch (how) {
    case STOP:
    case SOFTLY:
        (void)grobo_robot_stop(&robot, how == STOP);
        break;
    case EXIT_AND_HOLD:
    case EXIT_AND_OFF:
        assert_true(
            grobo_robot_exit(&robot, how == EXIT_AND_OFF ? GROBO_EXIT_OFF : GROBO_EXIT_HOLD) > 0);
        break;
    case ESTOP:
    case ESTOP_OFF:
        if (how == ESTOP_OFF) {
            assert_int_equal(grobo_robot_configure(&robot, &config), GROBO_OK);
        }
        assert_true(grobo_robot_estop(&robot) > 0);
        break;
    case LINE:
        grobo_robot_link_down(&robot, now_us);
        quits = true;
        run(200 * MS);
        quits = false;
        grobo_robot_link_up(&robot, now_us);
        from_us = now_us;
        break;
    case GUARD:
        make_engine(k);
        assert_true(grobo_robot_exit(&robot, GROBO_EXIT_HOLD) > 0);
        break;
    case WAYS:
        break;
    }
    return from_us;
}

/* How long until both stand for good. */
static int64_t rests_after(int64_t from_us)
{
    int64_t rest_us = now_us;
    for (int i = 0; i < 200; i++) {
        run(10 * MS);
        if (dps_of(0) != 0 || dps_of(1) != 0) {
            rest_us = now_us;
        }
    }
    return rest_us - from_us;
}

static void try_stop(const kind *k, way how, int64_t moment_us, int lose)
{
    begin(k);
    drive_for(110, -80, moment_us);
    far.lose_motor = lose;
    int64_t us = rests_after(stop(k, how));
    int64_t may_us = lose < 0 ? 40 * MS : 600 * MS;
    bool reported = n_halted > 0;
    bool believed = reported && (halted.joints & WHEELS) == WHEELS;
    if (us > may_us || dps_of(0) != 0 || dps_of(1) != 0) {
        fail_msg("%s, %s at %d ms, frame %d lost: turns for %d ms", k->far->name, way_names[how],
                 (int)(moment_us / MS), lose, (int)(us / MS));
    }
    if (how <= SOFTLY && moment_us > 0 && !believed) {
        fail_msg("%s, %s at %d ms, frame %d lost: %s", k->far->name, way_names[how],
                 (int)(moment_us / MS), lose, reported ? "not read to stand" : "not told");
    }
}

TEST(a_stop_at_any_moment_stops_every_wheel)
{
    for (const kind *k = kinds; k < kinds + KINDS; k++) {
        for (int how = STOP; how < WAYS; how++) {
            for (int64_t ms = 10; ms <= 700; ms += 23) {
                for (int lose = FAR_NEVER; lose <= 1; lose++) {
                    try_stop(k, (way)how, ms * MS, lose);
                }
            }
        }
    }
}

/* The host dies and nobody comes: a servo with a watchdog stops by itself. */
TEST(a_watchdog_stops_a_wheel_that_nobody_speaks_to)
{
    for (const kind *k = kinds; k < kinds + KINDS; k++) {
        begin(k);
        drive_for(100, 100, 600 * MS);
        quits = true;
        run(900 * MS);
        assert_true(k->watches ? dps_of(0) == 0 && dps_of(1) == 0 : dps_of(0) > 90);
    }
}

/* At rest it does not go off, however long: the next drive begins at once. */
TEST(a_wheel_that_stood_for_long_turns_again)
{
    for (const kind *k = kinds; k < kinds + KINDS; k++) {
        begin(k);
        drive_for(100, 100, 300 * MS);
        run(20 * (int64_t)S);
        drive_for(100, 100, 600 * MS);
        assert_true(fabs(dps_of(0) - 100) < 1);
    }
}
