/* SPDX-License-Identifier: MIT */
/* Why a request was refused, in words: joint, value, range and unit, whatever was asked for, in
 * every family: a joint in degrees, one in millimetres, one in percent, and a wheel. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/unit.h>
#include <grobo/core/wheel.h>

#include "src/robot/state.h"
#include "tests/support/family_kit.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { WHEEL = 3, WHEELS = GROBO_JOINT_BIT(WHEEL), HELD = 7 };

static family_kit kit;
static const grobo_robot_config defaults = {GROBO_ROBOT_CONFIG_INIT};

static void turns_none(family_kit *k)
{
    static const char *const names[] = {"arm", "slide", "grip", "left"};
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        k->joints[j].name = names[j];
    }
    k->joints[1].unit = GROBO_UNIT_MM; /* 90 degrees are -45 mm: it counts the other way round */
    k->joints[1].unit_rad = RAD(-2);
    k->joints[2].unit = GROBO_UNIT_PCT;
    k->joints[2].unit_zero_rad = RAD(-90);
    k->joints[2].unit_rad = RAD(1.8);
}

static void has_wheel(family_kit *k)
{
    turns_none(k);
    k->joints[WHEEL].min_rad = k->joints[WHEEL].max_rad = 0;
    k->joints[WHEEL].wheel = true;
    k->joints[WHEEL].max_speed_rad_s = RAD(120);
    k->joints[WHEEL].accel_rad_s2 = RAD(400);
}

static bool may_turn(const family *f)
{
    return strcmp(f->name, "ics") != 0;
}

static void start(const family *f)
{
    const grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .seed = 7, .mounted = true};
    family_start_as(&kit, f, &defaults, &sim, may_turn(f) ? has_wheel : turns_none);
    assert_int_equal(family_wait(&kit, grobo_robot_torque(&kit.robot, HELD, GROBO_TORQUE_ON)), 0);
}

static void says(int result, const char *wanted)
{
    char text[200];
    int n = grobo_robot_error_text(&kit.robot, result, text, sizeof text);
    assert_string_equal(text, wanted);
    assert_int_equal(n, (int)strlen(wanted));
}

static grobo_posture posture_of(int joint, double deg)
{
    grobo_posture posture;
    assert_int_equal(grobo_posture_init(&posture, FAMILY_JOINTS), 0);
    posture.angle_rad[joint] = RAD(deg);
    posture.set = GROBO_JOINT_BIT(joint);
    posture.time_us = 500000;
    return posture;
}

typedef struct refusal {
    const char *name;
    int joint;
    double deg;
    const char *text;
} refusal;

/* The second joint's servo is mounted the other way round: that is none of the caller's. */
static const refusal refusals[] = {
    {"deg, above", 0, 95,
     "outside a joint's limits: motor 1 (arm), 95.0 deg is not within -90.0 to 90.0 deg"},
    {"deg, below", 0, -90.4,
     "outside a joint's limits: motor 1 (arm), -90.4 deg is not within -90.0 to 90.0 deg"},
    {"mm, below", 1, 100,
     "outside a joint's limits: motor 2 (slide), -50.0 mm is not within -45.0 to 45.0 mm"},
    {"mm, above", 1, -91,
     "outside a joint's limits: motor 2 (slide), 45.5 mm is not within -45.0 to 45.0 mm"},
    {"%, above", 2, 99,
     "outside a joint's limits: motor 3 (grip), 105.0 % is not within 0.0 to 100.0 %"},
    {"%, hardly above", 2, 90.06,
     "outside a joint's limits: motor 3 (grip), 100.03 % is not within 0.0 to 100.0 %"},
    {"%, below", 2, -99,
     "outside a joint's limits: motor 3 (grip), -5.0 % is not within 0.0 to 100.0 %"},
};

TEST_EACH(refusal, refusals, what_moves_a_joint_says_what_it_can)
{
    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        grobo_posture beyond = posture_of(row->joint, row->deg);
        grobo_posture near = posture_of(row->joint, 2);
        grobo_posture within = posture_of(row->joint, 30);

        start(f);
        says(grobo_robot_move(&kit.robot, &beyond), row->text);
        says(grobo_robot_send(&kit.robot, &beyond), row->text);
        assert_int_equal(family_wait(&kit, grobo_robot_move(&kit.robot, &near)), 0);
        assert_true(grobo_robot_move(&kit.robot, &within) > 0);
        family_run(&kit, 150000);
        says(grobo_robot_retarget(&kit.robot, &beyond), row->text);
    }
}

TEST(a_wheel_says_how_fast_it_can_turn)
{
    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        double rad_s[FAMILY_JOINTS] = {0, 0, 0, RAD(-121.5)};
        if (!may_turn(f)) {
            continue;
        }
        start(f);
        assert_int_equal(family_wait(&kit, grobo_robot_torque(&kit.robot, WHEELS, GROBO_TORQUE_ON)),
                         0);
        says(grobo_robot_drive(&kit.robot, WHEELS, rad_s),
             "outside a joint's limits: motor 4 (left), -121.5 deg/s is not within -120.0 to "
             "120.0 deg/s");
        rad_s[WHEEL] = NAN;
        says(grobo_robot_drive(&kit.robot, WHEELS, rad_s), "not a finite number: motor 4 (left)");
    }
}

/* ---- a motion -------------------------------------------------------------------------------- */

static int key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    const refusal *row = ctx;
    *posture = posture_of(row->joint, i == 0 ? 0 : row->deg);
    *at_us = (int64_t)i * 500000;
    return GROBO_OK;
}

TEST_EACH(refusal, refusals, a_motion_says_which_joint_was_beyond_its_limits)
{
    refusal of = *row;
    const grobo_clip clip = {
        .key = key, .ctx = &of, .length_us = 500000, .n_keys = 2, .n_joints = FAMILY_JOINTS};

    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        start(f);
        assert_true(grobo_robot_play(&kit.robot, &clip, NULL) > 0);
        family_run(&kit, 3000000);
        assert_false(grobo_robot_is_playing(&kit.robot));
        says(GROBO_ERR_LIMIT, row->text);
    }
}

/* ---- what else is said ----------------------------------------------------------------------- */

TEST(a_number_that_is_none_names_its_joint_alone)
{
    grobo_posture target = posture_of(1, 0);
    start(family_named("sts"));
    target.angle_rad[1] = NAN;
    says(grobo_robot_move(&kit.robot, &target), "not a finite number: motor 2 (slide)");
}

/* A joint that was not read, and one whose servo takes no time that is as long. */
TEST(a_joint_that_cannot_be_sent_to_is_named)
{
    int slow = 0;
    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        const grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .seed = 7, .mounted = true};
        grobo_posture to = posture_of(1, 60);

        family_start_as(&kit, f, &defaults, &sim, turns_none);
        says(grobo_robot_send(&kit.robot, &to), "no fresh value: motor 2 (slide)");
        kit.joints[1].max_speed_rad_s = RAD(0.01);
        assert_int_equal(family_wait(&kit, grobo_robot_torque(&kit.robot, HELD, GROBO_TORQUE_ON)),
                         0);
        says(GROBO_ERR_STALE, grobo_error_text(GROBO_ERR_STALE)); /* it was read meanwhile */
        if (grobo_robot_send(&kit.robot, &to) == GROBO_ERR_SPEED) {
            says(GROBO_ERR_SPEED, "faster than the servo can move: motor 2 (slide)");
            slow++;
        }
    }
    assert_true(slow > 0);
}

/* Another program has sent it where it is not expected. */
TEST(a_joint_that_is_moved_by_another_program_is_named)
{
    char wanted[100];
    start(family_named("sts"));
    const grobo_joint *joint = grobo_model_joint(kit.robot.driver->model, 0);
    (void)snprintf(wanted, sizeof wanted, "%s: motor %d (%s)", grobo_error_text(GROBO_ERR_STATE),
                   joint->motor, joint->name);
    kit.robot.axes[0].phase = GROBO_I_JOINT_EXTERNAL;
    kit.robot.fault_joint = 0; /* as test_gate.c has it */
    says(GROBO_ERR_STATE, wanted);
}

TEST(an_error_of_no_joint_is_its_text_alone)
{
    grobo_posture beyond = posture_of(0, 95);
    char said[200];
    start(family_named("sts"));
    assert_int_equal(grobo_robot_move(&kit.robot, &beyond), GROBO_ERR_LIMIT);
    says(GROBO_ERR_STATE, grobo_error_text(GROBO_ERR_STATE));
    says(GROBO_ERR_STALE, grobo_error_text(GROBO_ERR_STALE));
    says(GROBO_OK, grobo_error_text(GROBO_OK));
    says(GROBO_ERR_LATCHED, grobo_error_text(GROBO_ERR_LATCHED)); /* it is not */
    grobo_posture wrong = posture_of(0, 0);
    wrong.n_joints = 3;
    assert_int_equal(grobo_robot_move(&kit.robot, &wrong), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_error_text(NULL, GROBO_ERR_ARG, said, sizeof said), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_error_text(&kit.robot, GROBO_ERR_ARG, NULL, 9), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_error_text(&kit.robot, GROBO_ERR_ARG, said, 0), GROBO_ERR_ARG);
}

TEST(a_text_is_cut_where_there_is_no_room)
{
    grobo_posture beyond = posture_of(0, 95);
    start(family_named("sts"));
    assert_int_equal(grobo_robot_move(&kit.robot, &beyond), GROBO_ERR_LIMIT);
    for (size_t room = 1; room < 100; room++) {
        char said[128];
        memset(said, '#', sizeof said);
        int n = grobo_robot_error_text(&kit.robot, GROBO_ERR_LIMIT, said, room);
        size_t whole = strlen(refusals[0].text);
        size_t cut = whole < room ? whole : room - 1;
        assert_int_equal(n, (int)cut);
        assert_memory_equal(said, refusals[0].text, cut);
        assert_int_equal(said[cut], '\0');
        assert_int_equal(said[room > cut + 1 ? room : cut + 1], '#');
    }
}

TEST(a_latched_stop_says_what_was_measured)
{
    start(family_named("sts"));
    assert_int_equal(grobo_sim_set_temperature(&kit.sim, 1, 69), 0);
    for (int i = 0; i < 100 && kit.n_trips == 0; i++) {
        grobo_posture target = posture_of(1, i % 2 == 0 ? 5 : 0);
        (void)family_wait(&kit, grobo_robot_move(&kit.robot, &target));
    }
    grobo_trip_info trip;
    grobo_robot_tripped(&kit.robot, &trip);
    assert_int_equal(trip.trip, GROBO_TRIP_TEMPERATURE);
    char wanted[120];
    (void)snprintf(wanted, sizeof wanted, "%s: over-temperature, motor 2 (slide), %.1f deg C",
                   grobo_error_text(GROBO_ERR_LATCHED), trip.value);
    grobo_posture target = posture_of(0, 5);
    says(grobo_robot_move(&kit.robot, &target), wanted);
}

TEST(an_emergency_stop_is_named)
{
    start(family_named("sts"));
    assert_int_equal(family_wait(&kit, grobo_robot_estop(&kit.robot)), 0);
    grobo_posture target = posture_of(0, 5);
    char wanted[120];
    (void)snprintf(wanted, sizeof wanted, "%s: emergency stop",
                   grobo_error_text(GROBO_ERR_LATCHED));
    says(grobo_robot_move(&kit.robot, &target), wanted);
}
