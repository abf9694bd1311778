/* SPDX-License-Identifier: MIT */
/* Wheels of every family that has them, against their simulated servos in virtual time: two wheels,
 * the second mounted the other way round, and two joints. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/feetech.h>
#include <grobo/core/ics.h>
#include <grobo/core/rs30x.h>
#include <grobo/core/sim.h>
#include <grobo/core/wheel.h>
#include <grobo/motion.h>

#include "tests/support/family_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { MS = 1000, S = 1000000, WHEELS = 3, JOINTS = 12 };

static family_kit kit;
static const grobo_robot_config defaults = {GROBO_ROBOT_CONFIG_INIT};

/* Beside those of the kit: other series, with ways of their own to be a wheel. */
static const family others[] = {
    {"mx", &grobo_i_dxl1_table, "MX-28", grobo_dxl1_driver_init, 1, 1000000, false},
    {"xl320", &grobo_i_dxl2_table, "XL-320", grobo_dxl2_driver_init, 1, 1000000, false},
    {"hls", &grobo_i_sts_table, "HLS3606", grobo_feetech_driver_init, 1, 1000000, false},
    {"p", &grobo_i_dxl2_table, "PM42-010-S260-R", grobo_dxl2_driver_init, 1, 1000000, false},
    {"pro", &grobo_i_dxl2_table, "H42-20-S300-R", grobo_dxl2_driver_init, 1, 1000000, false},
};

static const family *next_wheel(const family *before)
{
    const size_t n = sizeof others / sizeof others[0];
    if (before >= others && before < others + n) {
        return before + 1 < others + n ? before + 1 : NULL;
    }
    const family *next = family_next(before);
    return next == NULL || strcmp(next->name, "ics") == 0 ? others : next;
}

#define EACH_FAMILY(f) for (const family *f = next_wheel(NULL); f != NULL; f = next_wheel(f))

static void make_wheels(family_kit *k)
{
    for (int j = 0; j < 2; j++) {
        k->joints[j].min_rad = k->joints[j].max_rad = 0;
        k->joints[j].wheel = true;
        k->joints[j].max_speed_rad_s = RAD(120);
        k->joints[j].accel_rad_s2 = RAD(400);
    }
}

static void start(const family *f, const grobo_robot_config *config)
{
    const grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .seed = 7, .mounted = true};
    family_start_as(&kit, f, config, &sim, make_wheels);
}

/* Signed, of the joint. */
static double speed_dps(int joint)
{
    grobo_sim_step(&kit.sim, kit.now_us);
    double before_deg = family_angle_deg(&kit, joint);
    family_run(&kit, 20 * MS);
    grobo_sim_step(&kit.sim, kit.now_us);
    return (family_angle_deg(&kit, joint) - before_deg) * 50;
}

static void power(void)
{
    int result = family_wait(&kit, grobo_robot_torque(&kit.robot, WHEELS, GROBO_TORQUE_ON));
    if (result != GROBO_OK) {
        fail_msg("%s: torque on: %s", kit.family->name, grobo_error_name(result));
    }
}

static int drive(double a_dps, double b_dps)
{
    const double rad_s[FAMILY_JOINTS] = {RAD(a_dps), RAD(b_dps)};
    return grobo_robot_drive(&kit.robot, WHEELS, rad_s);
}

/* Asks again every 100 ms. */
static void drive_for(double a_dps, double b_dps, int64_t us)
{
    for (int64_t end_us = kit.now_us + us; kit.now_us < end_us;) {
        int result = drive(a_dps, b_dps);
        if (result != GROBO_OK) {
            fail_msg("%s: drive: %s, trip %s", kit.family->name, grobo_error_name(result),
                     grobo_trip_name(kit.n_trips > 0 ? kit.trips[0] : GROBO_TRIP_NONE));
        }
        family_run(&kit, 100 * MS);
    }
}

static void turns_at(int joint, double dps)
{
    double is_dps = speed_dps(joint);
    if (fabs(is_dps - dps) > 3) { /* outputs are whole counts of a coarse scale */
        fail_msg("%s: wheel %d turns at %f deg/s, not %f", kit.family->name, joint, is_dps, dps);
    }
}

static void starts(const family *f)
{
    start(f, &defaults);
    power();
    turns_at(0, 0);
    drive_for(90, -60, 1500 * MS);
    turns_at(0, 90);
    turns_at(1, -60);
}

TEST(wheels_turn_at_the_speeds_asked_for_and_end_by_themselves)
{
    EACH_FAMILY(f)
    {
        starts(f);
        grobo_wheel_info info;
        assert_int_equal(grobo_robot_wheel(&kit.robot, 0, &info), GROBO_OK);
        assert_true(fabs(info.asked_rad_s - RAD(90)) < 1e-9 && !info.stands);
        assert_true(grobo_robot_moving(&kit.robot));
        grobo_joint_info joint;
        assert_int_equal(grobo_robot_joint(&kit.robot, 1, &joint), GROBO_OK);
        if (joint.state.speed_dps > -40 || joint.state.speed_dps < -80) {
            fail_msg("%s: read at %d deg/s", f->name, (int)joint.state.speed_dps);
        }
        family_run(&kit, 600 * MS); /* nobody asks anew */
        turns_at(0, 0);
        turns_at(1, 0);
        family_run(&kit, 3 * S);
        if (kit.n_halted != 1 || kit.halted.joints != WHEELS || kit.halted.failed != 0) {
            fail_msg("%s: halted %u times, %x, failed %x", f->name, kit.n_halted,
                     (unsigned)kit.halted.joints, (unsigned)kit.halted.failed);
        }
        assert_int_equal(grobo_robot_wheel(&kit.robot, 0, &info), GROBO_OK);
        assert_true(info.stands && info.asked_rad_s == 0 && info.told_rad_s == 0);
        assert_false(grobo_robot_moving(&kit.robot));
        assert_int_equal(kit.n_trips, 0);
    }
}

/* The fastest change of a shaft's speed that was seen. */
static double last_deg[2], last_dps[2], most_dps2;
static int64_t last_us;

static void watch_ramp(family_kit *k)
{
    int64_t us = k->now_us - last_us;
    if (us < 200 * MS) {
        return;
    }
    for (int j = 0; j < 2; j++) {
        double deg = family_angle_deg(k, j);
        double dps = (deg - last_deg[j]) * 1e6 / (double)us;
        most_dps2 = fmax(most_dps2, fabs(dps - last_dps[j]) * 1e6 / (double)us);
        last_deg[j] = deg;
        last_dps[j] = dps;
    }
    last_us = k->now_us;
}

TEST(speeds_change_by_no_more_than_the_acceleration)
{
    EACH_FAMILY(f)
    {
        start(f, &defaults);
        power();
        most_dps2 = 0;
        last_us = kit.now_us;
        for (int j = 0; j < 2; j++) {
            last_deg[j] = family_angle_deg(&kit, j);
            last_dps[j] = 0;
        }
        kit.on_look = watch_ramp;
        drive_for(120, 120, S);
        drive_for(-120, 120, 1500 * MS);
        drive_for(0, 0, S);
        kit.on_look = NULL;
        if (most_dps2 > 1.6 * 400 || most_dps2 < 200) { /* in steps of 50 ms and more */
            fail_msg("%s: %f deg/s2", f->name, most_dps2);
        }
        turns_at(0, 0);
        family_run(&kit, 2 * S);
        assert_int_equal(kit.halted.joints, WHEELS); /* on their ramp to rest, too */
        assert_int_equal(kit.n_trips, 0);
    }
}

/* ---- stopped --------------------------------------------------------------------------------- */

static void stand_soon(const char *what)
{
    family_run(&kit, 60 * MS);
    for (int j = 0; j < 2; j++) {
        double dps = speed_dps(j);
        if (fabs(dps) > 0.5) {
            fail_msg("%s, %s: wheel %d turns at %f deg/s", kit.family->name, what, j, dps);
        }
    }
}

TEST(everything_that_stops_joints_stops_wheels)
{
    EACH_FAMILY(f)
    {
        starts(f);
        assert_int_equal(grobo_robot_stop(&kit.robot, true), GROBO_OK);
        stand_soon("stop");
        starts(f);
        assert_int_equal(grobo_robot_stop(&kit.robot, false), GROBO_OK);
        stand_soon("smooth stop");
        starts(f);
        int number = grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
        stand_soon("exit");
        assert_int_equal(family_wait(&kit, number), GROBO_OK);
        assert_int_equal(drive(10, 10), GROBO_OK); /* it may be driven on */
        starts(f);
        number = grobo_robot_exit(&kit.robot, GROBO_EXIT_OFF);
        stand_soon("exit off");
        assert_int_equal(family_wait(&kit, number), GROBO_OK);
        assert_int_equal(drive(10, 10), GROBO_ERR_STATE);
        starts(f);
        number = grobo_robot_estop(&kit.robot);
        stand_soon("emergency stop");
        assert_int_equal(family_wait(&kit, number), GROBO_OK);
        assert_int_equal(drive(10, 10), GROBO_ERR_LATCHED);
    }
}

TEST(an_emergency_stop_that_releases_wheels_leaves_no_speed_behind)
{
    EACH_FAMILY(f)
    {
        grobo_robot_config config = defaults;
        config.estop_torque = GROBO_ESTOP_OFF;
        start(f, &config);
        power();
        drive_for(90, -60, S);
        assert_int_equal(family_wait(&kit, grobo_robot_estop(&kit.robot)), GROBO_OK);
        stand_soon("release");
        assert_int_equal(grobo_robot_reset(&kit.robot), GROBO_OK);
        double before_deg = family_angle_deg(&kit, 0);
        power();
        family_run(&kit, S);
        assert_true(fabs(family_angle_deg(&kit, 0) - before_deg) < 0.5);
    }
}

TEST(a_trip_stops_wheels_and_latches)
{
    EACH_FAMILY(f)
    {
        starts(f);
        grobo_sim_set_temperature(&kit.sim, 3, 75);
        family_run(&kit, 2500 * MS);
        assert_int_equal(kit.n_trips, 1);
        turns_at(0, 0);
        assert_int_equal(drive(10, 10), GROBO_ERR_LATCHED);
    }
}

/* ---- set up ---------------------------------------------------------------------------------- */

static bool by_limits(const family *f)
{
    return strcmp(f->name, "scs") == 0 || strcmp(f->name, "dxl1") == 0 ||
           strcmp(f->name, "mx") == 0;
}

static bool has_setup(const family *f)
{
    return strcmp(f->name, "lx16a") != 0; /* its mode comes with each speed, and is not kept */
}

/* Servo `servo` is set up for positions, or as a wheel. */
static void set_up(const family *f, int servo, bool wheel)
{
    int position = strcmp(f->name, "xl320") == 0                                      ? 2
                   : f->table == &grobo_i_dxl2_table && strcmp(f->name, "xl320") != 0 ? 3
                                                                                      : 0;
    if (by_limits(f)) {
        const grobo_servo_register *max =
            grobo_servo_register_of(kit.servos[servo], GROBO_ROLE_MAX_POSITION);
        family_set_up(&kit, servo, GROBO_ROLE_MIN_POSITION, 0);
        family_set_up(&kit, servo, GROBO_ROLE_MAX_POSITION, wheel ? 0 : max->factory);
    } else {
        family_set_up(&kit, servo, GROBO_ROLE_MODE, wheel ? 1 : position);
    }
}

TEST(a_wheel_whose_servo_is_set_up_for_positions_never_turns)
{
    EACH_FAMILY(f)
    {
        grobo_joint_info info;
        if (!has_setup(f)) {
            continue;
        }
        start(f, &defaults);
        set_up(f, 0, false);
        assert_int_equal(family_wait(&kit, grobo_robot_torque(&kit.robot, WHEELS, GROBO_TORQUE_ON)),
                         GROBO_ERR_SETUP);
        assert_int_equal(drive(20, 20), GROBO_ERR_SETUP);
        assert_int_equal(grobo_robot_fault(&kit.robot, NULL), 0);
        assert_int_equal(grobo_robot_joint(&kit.robot, 0, &info), GROBO_OK);
        assert_int_equal(info.status, GROBO_ERR_SETUP);
        assert_int_equal(info.state.setup.reg->role,
                         by_limits(f) ? GROBO_ROLE_MAX_POSITION : GROBO_ROLE_MODE);
        assert_int_equal(info.state.setup.low, by_limits(f) ? 0 : 1);
        double before_deg = family_angle_deg(&kit, 0);
        int number = grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
        family_wait(&kit, number);
        assert_true(fabs(family_angle_deg(&kit, 0) - before_deg) < 0.5);
    }
}

TEST(a_joint_whose_servo_is_a_wheel_never_moves)
{
    EACH_FAMILY(f)
    {
        if (!has_setup(f)) {
            continue;
        }
        start(f, &defaults);
        set_up(f, 2, true);
        double before_deg = family_angle_deg(&kit, 2);
        assert_int_equal(family_wait(&kit, grobo_robot_torque(&kit.robot, JOINTS, GROBO_TORQUE_ON)),
                         GROBO_ERR_SETUP);
        family_run(&kit, S);
        assert_true(fabs(family_angle_deg(&kit, 2) - before_deg) < 0.5);
    }
}

static grobo_register_role speed_role(const family *f)
{
    return strcmp(f->name, "scs") == 0 ? GROBO_ROLE_GOAL_TIME
           : strcmp(f->name, "dxl2") == 0 || strcmp(f->name, "p") == 0 ||
                   strcmp(f->name, "lx16a") == 0
               ? GROBO_ROLE_GOAL_SPEED
               : GROBO_ROLE_SPEED;
}

/* What another program has left in the register of the speed does not begin with the torque. */
TEST(torque_comes_on_behind_a_speed_of_0)
{
    EACH_FAMILY(f)
    {
        start(f, &defaults);
        if (has_setup(f)) {
            family_set_up(&kit, 0, speed_role(f), 200);
        }
        double before_deg = family_angle_deg(&kit, 0);
        kit.lose = 1; /* and the first frame is lost */
        power();
        family_run(&kit, S);
        assert_true(fabs(family_angle_deg(&kit, 0) - before_deg) < 0.5);
    }
}

TEST(servos_without_a_mode_for_speeds_are_no_wheels)
{
    grobo_joint joint = {.name = "W",
                         .max_speed_rad_s = 1,
                         .motor = 1,
                         .mirror_sign = 1,
                         .wheel = true,
                         .accel_rad_s2 = 1};
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    const grobo_model model =
        GROBO_TABLE(grobo_model, .name = "one", GROBO_MODEL_JOINTS(&joint), .n_joints = 1);
    joint.servo = grobo_servo_model_named(&grobo_i_ics_table, "KRS-3301");
    assert_int_equal(grobo_ics_driver_init(&driver, &model), GROBO_ERR_ARG);
    joint.servo = NULL;
    assert_int_equal(grobo_rs30x_driver_init(&driver, &model, grobo_rs30x_protocol()),
                     GROBO_ERR_ARG);
    joint.servo = grobo_servo_model_named(&grobo_i_sts_table, "STS3215");
    assert_int_equal(grobo_feetech_driver_init(&driver, &model), GROBO_OK);
    /* What is no sound wheel, or is none and has its acceleration. */
    joint.accel_rad_s2 = 0;
    assert_int_equal(grobo_model_check(&model), GROBO_ERR_ARG);
    joint.accel_rad_s2 = INFINITY;
    assert_int_equal(grobo_model_check(&model), GROBO_ERR_ARG);
    joint.accel_rad_s2 = 1;
    joint.max_rad = 0.1;
    assert_int_equal(grobo_model_check(&model), GROBO_ERR_ARG);
    joint.wheel = false;
    joint.accel_rad_s2 = 0;
    assert_int_equal(grobo_model_check(&model), GROBO_OK);
    joint.accel_rad_s2 = 1;
    assert_int_equal(grobo_model_check(&model), GROBO_ERR_ARG);
}

/* ---- refused --------------------------------------------------------------------------------- */

TEST(speeds_are_checked_before_any_is_taken)
{
    const double nan_rad_s[FAMILY_JOINTS] = {0.5, NAN};
    const double some[FAMILY_JOINTS] = {0.5, 0.5, 0.5};
    grobo_wheel_info info;
    double dps;
    start(family_named("sts"), &defaults);
    assert_int_equal(drive(10, 10), GROBO_ERR_STALE);
    family_run(&kit, S); /* read */
    assert_int_equal(drive(10, 10), GROBO_ERR_STATE);
    assert_int_equal(drive(0, 0), GROBO_OK);
    power();
    assert_int_equal(drive(10, 121), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_robot_fault(&kit.robot, &dps), 1);
    assert_true(fabs(dps - 121) < 0.01);
    assert_int_equal(drive(10, -121), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_robot_drive(&kit.robot, WHEELS, nan_rad_s), GROBO_ERR_NAN);
    assert_int_equal(grobo_robot_drive(&kit.robot, 0, some), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_drive(&kit.robot, 16, some), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_drive(&kit.robot, 5, some), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_robot_fault(&kit.robot, NULL), 2);
    assert_int_equal(grobo_robot_drive(NULL, WHEELS, some), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_drive(&kit.robot, WHEELS, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_wheel(&kit.robot, 2, &info), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_robot_wheel(&kit.robot, 4, &info), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_wheel(&kit.robot, -1, &info), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_wheel(NULL, 0, &info), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_wheel(&kit.robot, 0, NULL), GROBO_ERR_ARG);
    family_run(&kit, S);
    turns_at(0, 0);                               /* none of them was taken */
    assert_int_equal(drive(120, -120), GROBO_OK); /* the limit itself */
    assert_int_equal(grobo_model_wheels(&kit.model), WHEELS);
    assert_int_equal(grobo_model_wheels(NULL), 0);
    grobo_robot_link_down(&kit.robot, kit.now_us);
    assert_int_equal(drive(10, 10), GROBO_ERR_CLOSED);
}

TEST(a_speed_beyond_the_limit_is_clamped_where_limits_clamp)
{
    grobo_robot_config config = defaults;
    config.limit_policy = GROBO_LIMIT_CLAMP;
    config.speed_limit_pct = 50;
    start(family_named("dxl2"), &config);
    power();
    drive_for(500, -30, 1500 * MS);
    turns_at(0, 60);
    turns_at(1, -30);
}

TEST(what_moves_joints_to_angles_refuses_wheels_or_leaves_them_out)
{
    grobo_posture pose;
    start(family_named("sts"), &defaults);
    grobo_posture_init_pose(&pose, &kit.model);
    assert_int_equal(pose.set, JOINTS);
    pose.time_us = 500 * MS;
    pose.angle_rad[2] = pose.angle_rad[3] = RAD(20);
    assert_int_equal(family_wait(&kit, grobo_robot_move(&kit.robot, &pose)), GROBO_OK);
    assert_true(fabs(family_angle_deg(&kit, 2) - 20) < 1);
    pose.set |= 2;
    assert_int_equal(grobo_robot_move(&kit.robot, &pose), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_robot_fault(&kit.robot, NULL), 1);
    assert_int_equal(grobo_robot_send(&kit.robot, &pose), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_robot_free(&kit.robot, WHEELS, true), GROBO_ERR_ARG);
}

/* Wheels turn beside a move, which a stop of the wheels' end does not touch. */
TEST(wheels_turn_beside_a_move)
{
    EACH_FAMILY(f)
    {
        starts(f);
        grobo_posture pose = family_posture(&kit, 40, 2000);
        pose.set = JOINTS;
        int number = grobo_robot_move(&kit.robot, &pose);
        assert_true(number > 0);
        drive_for(90, -60, S);
        turns_at(0, 90);
        assert_int_equal(family_wait(&kit, number), GROBO_OK);
        turns_at(0, 0);
        assert_true(fabs(family_angle_deg(&kit, 2) - 20) < 2);
        assert_int_equal(kit.n_trips, 0);
    }
}

/* ---- what goes wrong ------------------------------------------------------------------------- */

/* One of five frames is lost: speeds are told again, and so is the halt. */
static void lose_some(family_kit *k)
{
    static unsigned lost_behind;
    if (k->n_sent >= lost_behind + 5 || k->n_sent < lost_behind) {
        lost_behind = k->n_sent;
        k->lose = 1;
    }
}

TEST(lost_frames_are_made_up_for)
{
    EACH_FAMILY(f)
    {
        starts(f);
        kit.on_look = lose_some;
        drive_for(-90, 60, 1500 * MS);
        assert_true(speed_dps(0) < -45);
        assert_int_equal(grobo_robot_stop(&kit.robot, true), GROBO_OK);
        family_run(&kit, 1500 * MS);
        kit.on_look = NULL;
        kit.lose = 0;
        turns_at(0, 0);
        turns_at(1, 0);
        family_run(&kit, 3 * S);
        assert_int_equal(kit.halted.joints | kit.halted.failed, WHEELS);
    }
}

TEST(a_wheel_that_turned_as_the_line_was_lost_stops_with_the_line)
{
    EACH_FAMILY(f)
    {
        starts(f);
        grobo_robot_link_down(&kit.robot, kit.now_us);
        bool dog = kit.driver.watchdog_us > 0;
        for (int i = 0; i < 100; i++) {
            kit.now_us += 10 * MS;
            grobo_sim_step(&kit.sim, kit.now_us);
        }
        double before_deg = family_angle_deg(&kit, 0);
        kit.now_us += 100 * MS;
        grobo_sim_step(&kit.sim, kit.now_us);
        double way_deg = family_angle_deg(&kit, 0) - before_deg;
        assert_true(dog ? fabs(way_deg) < 0.1 : fabs(way_deg - 9) < 1);
        grobo_robot_link_up(&kit.robot, kit.now_us);
        stand_soon("line back");
        family_run(&kit, 4 * S);
        assert_true((kit.halted.joints & WHEELS) == WHEELS);
    }
}

/* A guard begins anew with a robot that turns: it knows nothing but the model. */
TEST(another_engine_stops_the_wheels_of_a_dead_program)
{
    EACH_FAMILY(f)
    {
        starts(f);
        grobo_robot_config config = defaults;
        config.bus.baud_bps = f->baud_bps;
        config.bus.echo = f->echo;
        assert_int_equal(grobo_robot_init(&kit.robot, &kit.driver, NULL, &config, kit.now_us),
                         GROBO_OK);
        family_listen(&kit);
        int number = grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
        stand_soon("guard");
        assert_int_equal(family_wait(&kit, number), GROBO_OK);
        grobo_joint_info info;
        assert_int_equal(grobo_robot_joint(&kit.robot, 0, &info), GROBO_OK);
        assert_true(info.stands);
    }
}

TEST(a_wheel_that_is_held_fast_stops_the_robot)
{
    EACH_FAMILY(f)
    {
        if (strcmp(f->name, "lx16a") == 0) {
            continue; /* tells no speed */
        }
        starts(f);
        assert_int_equal(grobo_sim_set_blocked(&kit.sim, 0, true), GROBO_OK);
        for (int i = 0; i < 25 && kit.n_trips == 0; i++) {
            (void)drive(90, -60);
            family_run(&kit, 100 * MS);
        }
        assert_int_equal(kit.n_trips, 1);
        assert_int_equal(kit.trips[0], GROBO_TRIP_BLOCKED);
        stand_soon("blocked");
    }
}

TEST(a_servo_that_restarts_while_it_turns_stops_the_robot)
{
    EACH_FAMILY(f)
    {
        starts(f);
        grobo_sim_set_supply(&kit.sim, 0);
        (void)drive(90, -60);
        family_run(&kit, 50 * MS);
        grobo_sim_set_supply(&kit.sim, (uint32_t)kit.servos[0]->voltage_mv);
        for (int i = 0; i < 30 && kit.n_trips == 0; i++) {
            (void)drive(90, -60);
            family_run(&kit, 100 * MS);
        }
        assert_true(kit.n_trips >= 1);
        turns_at(0, 0);
        turns_at(1, 0);
    }
}

static void make_fast(family_kit *k)
{
    make_wheels(k);
    k->joints[0].max_speed_rad_s = k->joints[1].max_speed_rad_s = RAD(290);
}

/* A shaft has no end: a quarter of an hour, and the position wraps as the register does. */
TEST(a_wheel_turns_on_and_on)
{
    const grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .seed = 7, .mounted = true};
    family_start_as(&kit, family_named("sts"), &defaults, &sim, make_fast);
    power();
    for (int i = 0; i < 2250; i++) {
        assert_int_equal(drive(290, -290), GROBO_OK);
        family_run(&kit, 400 * MS);
    }
    turns_at(0, 290);
    turns_at(1, -290);
    assert_int_equal(kit.n_trips, 0);
}

/* ---- motions --------------------------------------------------------------------------------- */

/* Its column counts for nothing, which is said once where it has anything. */
TEST(a_motion_turns_no_wheel)
{
    grobo_motion *motion = NULL;
    grobo_diagnostics *list = NULL;
    grobo_diagnostic said;
    const grobo_check_options how = {GROBO_CHECK_OPTIONS_INIT};
    start(family_named("sts"), &defaults);
    assert_int_equal(grobo_motion_new(GROBO_MOTION_POSTURES, FAMILY_JOINTS, NULL, &motion), 0);
    for (int i = 0; i < 3; i++) {
        grobo_posture pose = family_posture(&kit, 0, 1000);
        pose.angle_rad[0] = 0;
        pose.angle_rad[1] = RAD(90 * i);
        pose.angle_rad[2] = RAD(10 * i);
        pose.angle_rad[3] = 0;
        assert_true(grobo_motion_append(motion, &pose) >= 0);
    }
    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    assert_int_equal(grobo_motion_check(motion, &kit.model, &how, list), 0);
    assert_int_equal(grobo_diagnostics_total(list, GROBO_SEVERITY_WARNING), 1);
    assert_int_equal(grobo_diagnostics_get(list, 0, &said), 0);
    assert_non_null(strstr(said.message, "B: a wheel, which no motion turns"));
    grobo_diagnostics_free(list);
    grobo_clip clip;
    const grobo_clip_options plain = {GROBO_CLIP_OPTIONS_INIT};
    assert_int_equal(grobo_motion_clip(motion, &plain, &clip), 0);
    double before_deg = family_angle_deg(&kit, 1);
    assert_int_equal(family_wait(&kit, grobo_robot_play(&kit.robot, &clip, NULL)), GROBO_OK);
    family_run(&kit, 5 * S);
    assert_true(fabs(family_angle_deg(&kit, 2) - 20) < 1);
    assert_true(fabs(family_angle_deg(&kit, 1) - before_deg) < 0.1);
    grobo_motion_clip_free(&clip);
    grobo_motion_free(motion);
}
