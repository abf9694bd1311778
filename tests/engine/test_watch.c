/* SPDX-License-Identifier: MIT */
/* The watch, reading by reading: what trips it, of which joint, and at which bound. */
#include <stdint.h>
#include <string.h>

#include "tests/support/axes_kit.h"
#include "tests/support/test.h"

static const grobo_robot_config watching = {GROBO_ROBOT_CONFIG_INIT, .temperature_c = 60,
                                            .current_ma = 500, .voltage_mv = 6000,
                                            .lost_replies = 3};

/* What trips, trips latched, now and of this joint; GROBO_TRIP_NONE: nothing has. */
static void expect_trip(grobo_trip reason, int joint, double value)
{
    const grobo_trip_info *trip = &robot.trip;
    assert_int_equal(trip->trip, reason);
    assert_int_equal(trip->latched, reason != GROBO_TRIP_NONE);
    assert_int_equal(trip->joint, reason != GROBO_TRIP_NONE ? joint : -1);
    assert_int_equal(robot.counters.trips, reason != GROBO_TRIP_NONE);
    if (reason != GROBO_TRIP_NONE) {
        expect_equal(trip->value, value, "value");
        assert_true(trip->at_us == robot.now_us);
    }
}

static void read_as(int joint, grobo_joint_state got)
{
    grobo_i_watch_reading(&robot, joint, &got);
}

TEST_WITH(rig_wirings, heat_above_the_bound_trips)
{
    static const struct {
        int temperature_c, bound_c;
        bool known, overheated;
        grobo_trip trip;
        double value;
    } rows[] = {
        {60, 60, true, false, GROBO_TRIP_NONE, 0},
        {61, 60, true, false, GROBO_TRIP_TEMPERATURE, 61},
        {61, 60, false, false, GROBO_TRIP_NONE, 0},
        {61, 0, true, false, GROBO_TRIP_NONE, 0},
        {2, 1, true, false, GROBO_TRIP_TEMPERATURE, 2},
        {40, 60, true, true, GROBO_TRIP_OVERHEATED, 40},
        {40, 60, false, true, GROBO_TRIP_OVERHEATED, 0},
        {70, 60, true, true, GROBO_TRIP_OVERHEATED, 70},
    };
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start_with(&watching);
            robot.config.temperature_c = rows[i].bound_c;
            read_as(j, (grobo_joint_state){.temperature_c = (int16_t)rows[i].temperature_c,
                                           .overheated = rows[i].overheated,
                                           .valid = rows[i].known ? GROBO_FIELD_TEMPERATURE : 0});
            expect_trip(rows[i].trip, j, rows[i].value);
            expect_axes();
        }
    }
}

/* For a second without a break, of one joint; a reading without it tells nothing. */
TEST_WITH(rig_wirings, current_above_the_bound_for_a_second_trips)
{
    const grobo_joint_state high = {.current_ma = 501, .valid = GROBO_FIELD_CURRENT};
    const grobo_joint_state at = {.current_ma = 500, .valid = GROBO_FIELD_CURRENT};
    const grobo_joint_state nothing = {.valid = GROBO_FIELD_ANGLE};
    for (int j = 0; j < N; j++) {
        for (int late = 0; late < 2; late++) {
            start_with(&watching);
            driver.limits.current_us = S;
            read_as(j, high);
            robot.now_us += S / 2;
            read_as(other_of(j), high);
            read_as(j, nothing);
            read_as(j, high);
            robot.now_us += S / 2 - !late;
            read_as(j, high);
            expect_trip(late ? GROBO_TRIP_CURRENT : GROBO_TRIP_NONE, j, 501);
            assert_true(robot.axes[j].current_since_us == NOW);
            assert_true(robot.axes[other_of(j)].current_since_us == NOW + S / 2);
            read_as(j, at);
            assert_true(robot.axes[j].current_since_us == GROBO_NEVER_US);
        }
        start_with(&watching);
        robot.config.current_ma = 0; /* none */
        driver.limits.current_us = 0;
        read_as(j, high);
        expect_trip(GROBO_TRIP_NONE, j, 0);
        robot.config.current_ma = 500;
        read_as(j, high);
        expect_trip(GROBO_TRIP_CURRENT, j, 501);
    }
}

/* Three in a row of any joints, and then anew. */
TEST_WITH(rig_wirings, three_low_voltages_in_a_row_trip)
{
    const grobo_joint_state low = {.voltage_mv = 5999, .valid = GROBO_FIELD_VOLTAGE};
    const grobo_joint_state at = {.voltage_mv = 6000, .valid = GROBO_FIELD_VOLTAGE};
    const grobo_joint_state nothing = {.valid = GROBO_FIELD_ANGLE};
    for (int j = 0; j < N; j++) {
        start_with(&watching);
        read_as(j, low);
        read_as(j, low);
        read_as(j, at);
        read_as(j, low);
        read_as(other_of(j), low);
        read_as(other_of(j), nothing);
        expect_trip(GROBO_TRIP_NONE, j, 0);
        assert_int_equal(robot.low_readings, 2);
        read_as(j, low);
        expect_trip(GROBO_TRIP_VOLTAGE, j, 5999);
        assert_int_equal(robot.low_readings, 0);
        robot.config.voltage_mv = 0;
        robot.low_readings = 2;
        read_as(j, low);
        assert_int_equal(robot.low_readings, 0);
        robot.config.voltage_mv = 1; /* the lowest that is watched for */
        read_as(j, (grobo_joint_state){.voltage_mv = 0, .valid = GROBO_FIELD_VOLTAGE});
        assert_int_equal(robot.low_readings, 1);
    }
}

/* Off, though it was switched on: to be braked is not to be lost. */
TEST_WITH(rig_wirings, torque_that_is_lost_trips)
{
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 12; i++) {
            start_with(&watching);
            grobo_torque has = (grobo_torque)(i % 3);
            robot.axes[j].wants_torque = i / 3 % 2 != 0;
            bool lost = has == GROBO_TORQUE_OFF && i / 3 == 1;
            keep_axes();
            read_as(j, (grobo_joint_state){.torque = has,
                                           .valid =
                                               i / 3 < 2 ? GROBO_FIELD_TORQUE : GROBO_FIELD_ANGLE});
            expect_trip(lost ? GROBO_TRIP_TORQUE_LOST : GROBO_TRIP_NONE, j, 0);
            if (lost) {
                before[j].wants_torque = false;
                before[j].phase = GROBO_I_JOINT_IDLE;
            }
            expect_axes();
        }
    }
}

/* While something moves, this one or another. */
TEST_WITH(rig_wirings, lost_replies_trip_while_something_moves)
{
    static const struct {
        int lost, bound;
        bool moves, moved_by_job;
        bool trips;
    } rows[] = {{2, 3, true, true, false}, {3, 3, true, false, true},   {4, 3, true, false, true},
                {3, 3, false, true, true}, {3, 3, false, false, false}, {9, 0, true, true, false},
                {1, 1, true, false, true}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start_with(&watching);
            robot.config.lost_replies = rows[i].bound;
            robot.axes[j].lost = (uint16_t)rows[i].lost;
            robot.axes[other_of(j)].lost = (uint16_t)(5 - rows[i].lost);
            if (rows[i].moves) {
                set_going(third_of(j));
            }
            robot.job->kind = rows[i].moved_by_job ? GROBO_JOB_MOVE : GROBO_JOB_NONE;
            grobo_i_watch_lost(&robot, j);
            expect_trip(rows[i].trips ? GROBO_TRIP_LOST_REPLIES : GROBO_TRIP_NONE, j, rows[i].lost);
            assert_int_equal(robot.slots[0].use,
                             rows[i].trips && rows[i].moves ? GROBO_I_USE_HALT : 0);
        }
    }
}

/* ---- what a trip ends ------------------------------------------------------------------------ */

/* How it trips: latched, not latched, an emergency stop. */
enum { LATCHED, NOT_LATCHED, ESTOP, HOWS };

static void trip_in_a_job(grobo_job_kind kind, grobo_torque torque, int how)
{
    start();
    robot.events_n = robot.events_head = 0;
    robot.job->kind = kind;
    robot.job->torque = torque;
    robot.free_joints = 6;
    set_going(3);
    grobo_i_trip(&robot, how == ESTOP ? GROBO_TRIP_ESTOP : GROBO_TRIP_LIMIT, 3, 7.5,
                 how != NOT_LATCHED);
}

static bool moves_or_switches_on(grobo_job_kind kind, grobo_torque torque)
{
    static const bool always[GROBO_JOB_SETTLE + 1] = {[GROBO_JOB_MOVE] = true,
                                                      [GROBO_JOB_PLAY] = true,
                                                      [GROBO_JOB_STORED] = true,
                                                      [GROBO_JOB_RAW] = true,
                                                      [GROBO_JOB_SETTLE] = true};
    return always[kind] || (kind == GROBO_JOB_TORQUE && torque == GROBO_TORQUE_ON);
}

TEST_WITH(rig_wirings, a_trip_ends_what_moves_or_switches_on)
{
    for (int i = 0; i < (GROBO_JOB_SETTLE + 1) * 3 * HOWS; i++) {
        grobo_job_kind kind = (grobo_job_kind)(i / HOWS / 3);
        grobo_torque torque = (grobo_torque)(i / HOWS % 3);
        bool latched = i % HOWS != NOT_LATCHED;
        bool ends = latched && moves_or_switches_on(kind, torque);
        trip_in_a_job(kind, torque, i % HOWS);
        assert_int_equal(robot.job->kind, ends ? GROBO_JOB_NONE : kind);
        bool tells = ends && kind != GROBO_JOB_SETTLE; /* which nobody asked for */
        assert_int_equal(robot.events_n, tells ? 2 : 1);
        assert_true(!tells || robot.events[1].u.job.result == GROBO_ERR_LATCHED);
        assert_true(robot.free_joints == (latched ? 0 : 6));
        /* Who leaves stops it already, and an emergency stop lets go of it. */
        bool halts = i % HOWS == LATCHED && kind != GROBO_JOB_EXIT;
        assert_int_equal(robot.slots[0].use, halts ? GROBO_I_USE_HALT : 0);
    }
}

TEST_WITH(rig_wirings, a_trip_is_told_and_kept_where_it_latches)
{
    static const grobo_trip kept[] = {GROBO_TRIP_LIMIT, GROBO_TRIP_NONE, GROBO_TRIP_ESTOP};
    for (int how = 0; how < HOWS; how++) {
        trip_in_a_job(GROBO_JOB_NONE, GROBO_TORQUE_OFF, how);
        assert_int_equal(robot.trip.trip, kept[how]);
        assert_int_equal(robot.counters.trips, 1);
        const grobo_event *event = &robot.events[0];
        assert_int_equal(event->kind, GROBO_EVENT_TRIP);
        assert_int_equal(event->u.trip.joint, 3);
        expect_equal(event->u.trip.value, 7.5, "value");
        assert_true(event->u.trip.at_us == NOW);
        assert_int_equal(event->u.trip.latched, how != NOT_LATCHED);
    }
}

/* Whether it latches or not: a stalled host begins anew. */
TEST_WITH(rig_wirings, a_trip_takes_back_targets_that_wait)
{
    for (int i = 0; i < 2 * N; i++) {
        bool latched = i % 2 != 0;
        start();
        grobo_robot_slot *slot = grobo_i_slot_take(&robot, GROBO_I_USE_MOTION);
        slot->order.joints = GROBO_JOINT_BIT(i / 2);
        assert_int_equal(driver.sense(&driver, NULL, 0, GROBO_SENSE_ALL, &robot.built), 0);
        assert_int_equal(grobo_i_slot_send(slot, &robot.built, GROBO_PRIORITY_MOTION), GROBO_OK);
        grobo_i_trip(&robot, GROBO_TRIP_HOST_STALL, -1, 0, latched);
        assert_int_equal(slot->use, GROBO_I_USE_FREE);
    }
}

TEST_WITH(rig_wirings, each_reason_has_a_name_of_its_own)
{
    static const char *const names[] = {"none",          "over-temperature", "servo overheated",
                                        "over-current",  "low voltage",      "lost replies",
                                        "torque lost",   "outside limits",   "not a number",
                                        "host stalled",  "emergency stop",   "servos apart",
                                        "joint blocked", "joint overloaded", "unknown"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        assert_string_equal(grobo_trip_name((grobo_trip)i), names[i]);
    }
}

TEST_WITH(rig_wirings, the_first_reason_stays_but_for_an_emergency_stop)
{
    start();
    grobo_i_trip(&robot, GROBO_TRIP_VOLTAGE, 1, 5000, true);
    grobo_i_trip(&robot, GROBO_TRIP_TEMPERATURE, 2, 70, true);
    assert_int_equal(robot.trip.trip, GROBO_TRIP_VOLTAGE);
    assert_int_equal(robot.counters.trips, 1);
    grobo_i_trip(&robot, GROBO_TRIP_ESTOP, -1, 0, true);
    assert_int_equal(robot.trip.trip, GROBO_TRIP_ESTOP);
    assert_int_equal(robot.trip.joint, -1);
    assert_int_equal(robot.counters.trips, 2);
}
