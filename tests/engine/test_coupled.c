/* SPDX-License-Identifier: MIT */
/*
 * Joints that follow others, on simulated servos of every family: B shares a shaft with A and turns
 * the other way, D goes to half of C the other way. What their shafts do is looked at, not what the
 * engine says.
 */
#include <math.h>
#include <stdlib.h>

#include <grobo/core/robot.h>
#include <grobo/core/sim.h>

#include "src/servo/families.h"
#include "tests/support/family_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { A, B, C, D, MS = 1000, S = 1000000, APART_DEG = 5 };

static family_kit kit;
static const grobo_robot_config watched = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 100 * MS};

static int rs30x_init(grobo_driver *driver, const grobo_model *model)
{
    return grobo_i_family_rs30x.init[GROBO_WIRING_BUS](driver, model);
}

/* Those of the kit, and RS30x. */
static const family *each(const family *before)
{
    static const family rs30x = {"rs30x", &grobo_i_rs30x_table, "RS301CR", rs30x_init, 0.5, 115200,
                                 false};
    if (before == &rs30x) {
        return NULL;
    }
    const family *next = family_next(before);
    return next != NULL ? next : &rs30x;
}

static void couple(family_kit *k)
{
    k->joints[B].follows = A;
    k->joints[B].ratio = 1;
    k->joints[B].apart_rad = RAD(APART_DEG);
    k->joints[D].follows = C;
    k->joints[D].ratio = -0.5;
    k->joints[D].min_rad = RAD(-45);
    k->joints[D].max_rad = RAD(45);
    assert_int_equal(grobo_model_check(&k->model), 0);
}

static double most_apart_deg;
static int frames_apart; /* looks at which the goals of A and B were not of one frame */

/* Both shafts, and the goals of their servos. */
static void look_at_both(family_kit *k)
{
    grobo_sim_view a, b;
    assert_int_equal(grobo_sim_look(&k->sim, A, &a), GROBO_OK);
    assert_int_equal(grobo_sim_look(&k->sim, B, &b), GROBO_OK);
    most_apart_deg = fmax(most_apart_deg, abs(a.angle_mdeg + b.angle_mdeg) / 1000.0);
    bool on = a.torque == GROBO_TORQUE_ON && b.torque == GROBO_TORQUE_ON;
    frames_apart += on && abs(a.target_mdeg + b.target_mdeg) > k->family->near_deg * 1000;
}

static void begin(const family *row)
{
    family_start_as(&kit, row, &watched, NULL, couple);
    kit.on_look = look_at_both;
    most_apart_deg = 0;
    frames_apart = 0;
    assert_int_equal(
        family_wait(&kit, grobo_robot_torque(&kit.robot, GROBO_JOINT_BIT(A) | GROBO_JOINT_BIT(C),
                                             GROBO_TORQUE_ON)),
        GROBO_OK);
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(&kit.sim, j, &view), GROBO_OK);
        assert_int_equal(view.torque, GROBO_TORQUE_ON);
    }
    frames_apart = 0;
}

static grobo_posture to(double a_deg, double c_deg, int time_ms)
{
    grobo_posture p;
    assert_int_equal(grobo_posture_init(&p, FAMILY_JOINTS), 0);
    p.angle_rad[A] = RAD(a_deg);
    p.angle_rad[C] = RAD(c_deg);
    p.set = GROBO_JOINT_BIT(A) | GROBO_JOINT_BIT(C);
    p.time_us = time_ms * (int64_t)MS;
    return p;
}

static void expect_at(double a_deg, double c_deg)
{
    const double wanted_deg[FAMILY_JOINTS] = {a_deg, a_deg, c_deg, -c_deg / 2};
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        double is_deg = family_angle_deg(&kit, j);
        if (fabs(is_deg - wanted_deg[j]) > kit.family->near_deg) {
            fail_msg("%s: joint %d is at %.2f deg, not %.2f", kit.family->name, j, is_deg,
                     wanted_deg[j]);
        }
    }
}

static bool writes_many(void)
{
    return kit.family->table != &grobo_i_lx16a_table && kit.family->table != &grobo_i_ics_table;
}

/* ---- moving --------------------------------------------------------------------------------- */

TEST_FOR(family, each, both_go_in_one_frame)
{
    begin(row);
    grobo_posture p = to(40, 30, 900);
    assert_int_equal(family_wait(&kit, grobo_robot_move(&kit.robot, &p)), GROBO_OK);
    expect_at(40, 30);
    p = to(-35, -60, 300);
    assert_int_equal(family_wait(&kit, grobo_robot_move(&kit.robot, &p)), GROBO_OK);
    expect_at(-35, -60);
    if (writes_many()) {
        assert_int_equal(frames_apart, 0);
    }
    assert_true(most_apart_deg < APART_DEG);
    assert_int_equal(kit.n_trips, 0);
}

TEST_FOR(family, each, one_joint_takes_its_partner_along)
{
    begin(row);
    grobo_posture p = to(25, 0, 500);
    p.set = GROBO_JOINT_BIT(A);
    assert_int_equal(family_wait(&kit, grobo_robot_move(&kit.robot, &p)), GROBO_OK);
    expect_at(25, 0);
    p = to(25, 50, 500);
    p.set =
        GROBO_JOINT_BIT(C) | GROBO_JOINT_BIT(D); /* where D was asked to go counts for nothing */
    p.angle_rad[D] = RAD(44);
    assert_int_equal(family_wait(&kit, grobo_robot_move(&kit.robot, &p)), GROBO_OK);
    expect_at(25, 50);
}

TEST_FOR(family, each, a_target_and_a_retarget_take_both)
{
    begin(row);
    grobo_posture p = to(30, 20, 600);
    assert_int_equal(grobo_robot_send(&kit.robot, &p), GROBO_OK);
    family_run(&kit, 5 * S);
    expect_at(30, 20);
    p = to(20, 10, 300); /* the first one is slow, and takes no other target */
    assert_int_equal(family_wait(&kit, grobo_robot_move(&kit.robot, &p)), GROBO_OK);
    p = to(-30, -20, 2000);
    int number = grobo_robot_move(&kit.robot, &p);
    assert_true(number > 0);
    family_run(&kit, 900 * MS);
    p = to(10, 15, 800);
    assert_int_equal(grobo_robot_retarget(&kit.robot, &p), number);
    assert_int_equal(family_wait(&kit, number), GROBO_OK);
    expect_at(10, 15);
    assert_true(most_apart_deg < APART_DEG);
    assert_int_equal(kit.n_trips, 0);
}

TEST_FOR(family, each, one_that_follows_is_not_sent_anywhere)
{
    begin(row);
    grobo_posture p = to(0, 0, 500);
    p.set = GROBO_JOINT_BIT(B);
    p.angle_rad[B] = RAD(20);
    assert_int_equal(grobo_robot_move(&kit.robot, &p), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_robot_send(&kit.robot, &p), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_robot_retarget(&kit.robot, &p), GROBO_ERR_UNSUPPORTED);
    p.set |= GROBO_JOINT_BIT(C);
    assert_int_equal(grobo_robot_move(&kit.robot, &p), GROBO_ERR_UNSUPPORTED);
    family_run(&kit, S);
    expect_at(0, 0);
}

static int sway(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    *at_us = (int64_t)i * 600 * MS;
    *posture = to(i % 2 != 0 ? 30 : -30, i % 2 != 0 ? -40 : 40, 600);
    posture->set |= GROBO_JOINT_BIT(B); /* as a recording has it */
    posture->angle_rad[B] = RAD(-20);
    return 0;
}

TEST_FOR(family, each, a_motion_moves_both)
{
    begin(row);
    const grobo_clip clip = {
        .key = sway, .n_joints = FAMILY_JOINTS, .n_keys = 4, .length_us = 3 * 600 * MS};
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT};
    assert_int_equal(family_wait(&kit, grobo_robot_play(&kit.robot, &clip, &options)), GROBO_OK);
    for (int i = 0; i < 60 && grobo_robot_is_playing(&kit.robot); i++) {
        family_run(&kit, S / 4);
    }
    family_run(&kit, S);
    expect_at(30, -40);
    if (writes_many()) {
        assert_int_equal(frames_apart, 0);
    }
    assert_true(most_apart_deg < APART_DEG);
    assert_int_equal(kit.n_trips, 0);
}

/* ---- stopping ------------------------------------------------------------------------------- */

/* Stopped anywhere on its way, a shaft has one goal. */
TEST_FOR(family, each, a_stop_ends_at_one_place)
{
    for (int ms = 40; ms < 1600; ms += 120) {
        begin(row);
        grobo_posture p = to(60, 60, 1200);
        int number = grobo_robot_move(&kit.robot, &p);
        assert_true(number > 0);
        family_run(&kit, ms * MS);
        int result = grobo_robot_cancel(&kit.robot);
        assert_true(result == GROBO_OK || result == GROBO_ERR_STATE);
        family_run(&kit, 3 * S);
        grobo_sim_view a, b;
        assert_int_equal(grobo_sim_look(&kit.sim, A, &a), GROBO_OK);
        assert_int_equal(grobo_sim_look(&kit.sim, B, &b), GROBO_OK);
        if (abs(a.target_mdeg + b.target_mdeg) > row->near_deg * 1000 ||
            abs(a.angle_mdeg + b.angle_mdeg) > 2 * row->near_deg * 1000) {
            fail_msg("%s, after %d ms: goals %d and %d, shafts %d and %d mdeg", row->name, ms,
                     a.target_mdeg, -b.target_mdeg, a.angle_mdeg, -b.angle_mdeg);
        }
        assert_false(a.moving || b.moving);
        assert_true(most_apart_deg < APART_DEG);
        assert_int_equal(kit.n_trips, 0);
    }
}

/* The frame of a stop is lost: both are halted again. */
TEST_FOR(family, each, a_lost_stop_is_repeated)
{
    for (int lost = 1; lost <= 2; lost++) {
        begin(row);
        grobo_posture p = to(60, 60, 1500);
        assert_true(grobo_robot_move(&kit.robot, &p) > 0);
        family_run(&kit, 700 * MS);
        assert_int_equal(grobo_robot_cancel(&kit.robot), GROBO_OK);
        kit.lose = lost;
        family_run(&kit, 4 * S);
        grobo_sim_view a, b;
        assert_int_equal(grobo_sim_look(&kit.sim, A, &a), GROBO_OK);
        assert_int_equal(grobo_sim_look(&kit.sim, B, &b), GROBO_OK);
        assert_false(a.moving || b.moving);
        assert_true(a.angle_mdeg < 58000);
        if (abs(a.angle_mdeg + b.angle_mdeg) > APART_DEG * 1000) {
            fail_msg("%s, %d lost: %d and %d mdeg", row->name, lost, a.angle_mdeg, -b.angle_mdeg);
        }
    }
}

TEST_FOR(family, each, a_raw_frame_does_not_tear_them_apart)
{
    begin(row);
    grobo_target target = {0};
    grobo_exchange exchange = {0};
    target.posture = to(20, 0, 1000);
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        target.joint_time_us[j] = S;
    }
    target.posture.set = GROBO_JOINT_BIT(A);
    assert_int_equal(kit.driver.posture(&kit.driver, NULL, &target, 0, &exchange), 1);
    if (row->table == &grobo_i_ics_table) { /* its first frame is the speed */
        exchange = (grobo_exchange){0};
        assert_int_equal(kit.driver.posture(&kit.driver, NULL, &target, 1, &exchange), 1);
    }
    family_run(&kit, S);
    assert_int_equal(grobo_robot_raw(&kit.robot, exchange.frame, exchange.frame_bytes),
                     GROBO_ERR_UNSUPPORTED);
    family_run(&kit, S);
    expect_at(0, 0);
}

TEST_FOR(family, each, torque_is_switched_of_both)
{
    static const int named[][2] = {{A, B}, {B, A}, {C, D}, {D, C}};
    for (int i = 0; i < 4; i++) {
        begin(row);
        int number = grobo_robot_torque(&kit.robot, GROBO_JOINT_BIT(named[i][0]), GROBO_TORQUE_OFF);
        assert_int_equal(family_wait(&kit, number), GROBO_OK);
        for (int j = 0; j < FAMILY_JOINTS; j++) {
            grobo_sim_view view;
            assert_int_equal(grobo_sim_look(&kit.sim, j, &view), GROBO_OK);
            bool off = j == named[i][0] || j == named[i][1];
            assert_int_equal(view.torque, off ? GROBO_TORQUE_OFF : GROBO_TORQUE_ON);
        }
    }
}

/* ---- watching ------------------------------------------------------------------------------- */

/* Turns the shaft of B alone, as no shaft that two servos share is turned. */
static void tear(double deg)
{
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&kit.sim, B, &view), GROBO_OK);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, B, view.angle_mdeg - (int)(deg * 1000), 0),
                     GROBO_OK);
    assert_int_equal(grobo_sim_set_blocked(&kit.sim, B, true), GROBO_OK);
}

TEST_FOR(family, each, servos_apart_stop_the_robot)
{
    begin(row);
    grobo_posture p = to(70, 0, 4000);
    int number = grobo_robot_move(&kit.robot, &p);
    assert_true(number > 0);
    family_run(&kit, 600 * MS);
    assert_int_equal(kit.n_trips, 0);
    tear(-12);
    assert_int_equal(family_wait(&kit, number), GROBO_ERR_LATCHED);
    assert_int_equal(kit.trips[0], GROBO_TRIP_APART);
    family_run(&kit, 2 * S);
    grobo_sim_view a;
    assert_int_equal(grobo_sim_look(&kit.sim, A, &a), GROBO_OK);
    assert_false(a.moving);
    assert_true(a.angle_mdeg < 40000);
    grobo_trip_info trip;
    grobo_robot_tripped(&kit.robot, &trip);
    assert_int_equal(trip.joint, B);
    assert_true(trip.value > APART_DEG && trip.value < 90);
    assert_int_equal(grobo_robot_reset(&kit.robot), GROBO_OK);
    family_run(&kit, 2 * S); /* it is so still */
    assert_int_equal(kit.n_trips, 2);
}

/* Servos whose horns were put on wrongly are found before they work against each other. */
TEST_FOR(family, each, servos_apart_get_no_torque)
{
    family_start_as(&kit, row, &watched, NULL, couple);
    kit.on_look = look_at_both;
    assert_int_equal(grobo_sim_set_angle(&kit.sim, B, 15000, 0), GROBO_OK);
    family_run(&kit, 2 * S);
    assert_int_equal(kit.n_trips, 1);
    assert_int_equal(kit.trips[0], GROBO_TRIP_APART);
    assert_int_equal(grobo_robot_torque(&kit.robot, GROBO_JOINT_BIT(A), GROBO_TORQUE_ON),
                     GROBO_ERR_LATCHED);
}

/* A hand turns the shaft of both, fast, and a little unevenly read: that is no fault. */
TEST_FOR(family, each, a_hand_is_no_fault)
{
    family_start_as(&kit, row, &watched, NULL, couple);
    kit.on_look = look_at_both;
    family_run(&kit, S);
    for (int i = 0; i < 12; i++) {
        int32_t mdeg = i % 3 == 0 ? 70000 : i % 3 == 1 ? -50000 : 10000;
        assert_int_equal(grobo_sim_set_angle(&kit.sim, A, mdeg, 400 * MS), GROBO_OK);
        assert_int_equal(grobo_sim_set_angle(&kit.sim, B, -mdeg, 400 * MS), GROBO_OK);
        family_run(&kit, (300 + 70 * i) * MS);
    }
    assert_int_equal(kit.n_trips, 0);
}
