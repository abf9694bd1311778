/* SPDX-License-Identifier: MIT */
/*
 * How the base stands: readings that are no readings are refused, the latest one reaches the
 * stabilizer, an old one does not, and the base of a simulated body is read by itself.
 */
#include <math.h>
#include <string.h>

#include <grobo/core/imu.h>
#include <grobo/core/robot_plant.h>
#include <grobo/core/sim_physics.h>
#include <grobo/core/virtual.h>

#include "tests/support/test.h"

#define PI 3.14159265358979323846

enum { ANKLE = 4 };

static const grobo_imu leaning = {0.02, 0.1, {0.5, -0.25, 0.125}};

/* What a stabilizer was handed. */
static struct {
    int calls, known;
    grobo_imu last;
    int result;
} seen;

static int by_imu(const grobo_driver *self, void *ctx, const grobo_imu *imu,
                  const grobo_posture *sensed, grobo_posture *target)
{
    assert_non_null(self);
    assert_null(ctx);
    assert_true(sensed->n_joints == target->n_joints);
    seen.calls++;
    if (imu != NULL) {
        seen.known++;
        seen.last = *imu;
        target->angle_rad[ANKLE] += imu->pitch_rad;
    }
    return seen.result;
}

/* Behind stabilize(), which sees the target first. */
static int by_angles(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                     grobo_posture *target)
{
    (void)self;
    (void)ctx;
    (void)sensed;
    target->angle_rad[ANKLE] = 0.2;
    return 0;
}

static grobo_driver driver;
static grobo_virtual *robot;

/* The plant's joints go where they are driven to at once; its base leans. */
static grobo_imu of_plant;
static int plant_result;

static int plant_step(void *ctx, const grobo_sim_drive *drive, double dt_s, grobo_sim_state *state)
{
    const int *n = ctx;
    for (int j = 0; j < *n; j++) {
        double rad_s = drive[j].damping_nms > 0 ? drive[j].torque_nm / drive[j].damping_nms : 0;
        rad_s = fmin(fmax(rad_s, fmax(drive[j].low_rad_s, -3)), fmin(drive[j].high_rad_s, 3));
        state[j].speed_rad_s = rad_s;
        state[j].angle_rad += rad_s * dt_s;
    }
    return 0;
}

static int plant_imu(void *ctx, grobo_imu *imu)
{
    (void)ctx;
    *imu = of_plant;
    return plant_result;
}

static void begin(const grobo_sim_config *sim, bool by_both)
{
    driver = (grobo_driver)GROBO_TABLE_INIT(grobo_driver);
    assert_int_equal(grobo_driver_copy(&driver, grobo_gr001_driver(GROBO_WIRING_BUS)), GROBO_OK);
    driver.stabilize_by = by_imu;
    driver.stabilize = by_both ? by_angles : NULL;
    memset(&seen, 0, sizeof seen);
    const grobo_virtual_config config = {GROBO_VIRTUAL_CONFIG_INIT, .driver = &driver, .sim = sim};
    assert_int_equal(grobo_virtual_new(&config, &robot), GROBO_OK);
    grobo_robot *engine = grobo_virtual_robot(robot);
    assert_true(grobo_robot_torque(engine, GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON) > 0);
    assert_int_equal(grobo_virtual_run(robot, 3000000), GROBO_OK);
}

/* A move of the ankle to 0, until its stabilizer was asked and its frame has left. @return what the
 * request returned */
static int move(void)
{
    grobo_posture target = {.n_joints = 20, .set = GROBO_JOINT_BIT(ANKLE), .time_us = 500000};
    int calls = seen.calls, job = grobo_robot_move(grobo_virtual_robot(robot), &target);
    for (int ms = 0; job > 0 && seen.calls == calls && ms < 100; ms++) {
        assert_int_equal(grobo_virtual_run(robot, 1000), GROBO_OK);
    }
    assert_int_equal(grobo_virtual_run(robot, job > 0 ? 20000 : 0), GROBO_OK);
    return job;
}

static double told_rad(void)
{
    grobo_joint_info info;
    assert_int_equal(grobo_robot_joint(grobo_virtual_robot(robot), ANKLE, &info), GROBO_OK);
    return info.target_rad;
}

TEST(the_tilt_is_the_angle_from_upright)
{
    const grobo_imu over = {PI, 0, {0, 0, 0}}, bent = {0, -PI / 2, {0, 0, 0}};
    const grobo_imu both = {0.3, 0.4, {9, 9, 9}}, none = {0, 0, {0, 0, 0}};
    assert_true(fabs(grobo_imu_tilt(&over) - PI) < 1e-9);
    assert_true(fabs(grobo_imu_tilt(&bent) - PI / 2) < 1e-9);
    assert_true(fabs(grobo_imu_tilt(&both) - acos(cos(0.3) * cos(0.4))) < 1e-12);
    assert_true(grobo_imu_tilt(&none) == 0);
    assert_true(grobo_imu_tilt(NULL) == 0);
}

TEST(what_is_no_reading_is_refused_and_changes_nothing)
{
    begin(NULL, false);
    grobo_robot *engine = grobo_virtual_robot(robot);
    grobo_imu got;
    int64_t age_us;
    assert_int_equal(grobo_robot_imu(engine, &got, &age_us), GROBO_ERR_STALE);
    assert_int_equal(grobo_robot_set_imu(NULL, &leaning), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_set_imu(engine, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_imu(NULL, &got, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_imu(engine, NULL, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_set_imu(engine, &leaning), GROBO_OK);
    double *numbers[] = {&got.roll_rad, &got.pitch_rad, &got.rate_rad_s[0], &got.rate_rad_s[1],
                         &got.rate_rad_s[2]};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        got = leaning;
        *numbers[i] = i % 2 == 0 ? NAN : INFINITY;
        assert_int_equal(grobo_robot_set_imu(engine, &got), GROBO_ERR_NAN);
    }
    static const grobo_imu beyond[] = {
        {3.2, 0, {0}}, {-3.2, 0, {0}}, {0, 1.6, {0}}, {0, -1.6, {0}}};
    for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        assert_int_equal(grobo_robot_set_imu(engine, &beyond[i]), GROBO_ERR_LIMIT);
    }
    assert_int_equal(grobo_virtual_run(robot, 70000), GROBO_OK);
    assert_int_equal(grobo_robot_imu(engine, &got, &age_us), GROBO_OK);
    assert_memory_equal(&got, &leaning, sizeof got);
    assert_int_equal(age_us, 70000);
    static const grobo_imu most[] = {{PI, PI / 2, {0}}, {-PI, -PI / 2, {0}}};
    assert_int_equal(grobo_robot_set_imu(engine, &most[0]), GROBO_OK);
    assert_int_equal(grobo_robot_set_imu(engine, &most[1]), GROBO_OK);
    grobo_virtual_free(robot);
}

TEST(the_stabilizer_has_the_latest_reading_for_a_tenth_of_a_second)
{
    begin(NULL, false);
    grobo_robot *engine = grobo_virtual_robot(robot);
    assert_true(move() > 0); /* none was given */
    assert_int_equal(seen.calls, 1);
    assert_int_equal(seen.known, 0);
    assert_int_equal(grobo_virtual_run(robot, 2000000), GROBO_OK);
    static const grobo_imu before = {0, 0.3, {0, 0, 0}};
    assert_int_equal(grobo_robot_set_imu(engine, &before), GROBO_OK);
    assert_int_equal(grobo_robot_set_imu(engine, &leaning), GROBO_OK);
    assert_int_equal(grobo_virtual_run(robot, GROBO_IMU_AGE_US - 20000), GROBO_OK);
    assert_true(move() > 0);
    assert_int_equal(seen.known, 1);
    assert_memory_equal(&seen.last, &leaning, sizeof leaning);
    assert_true(fabs(told_rad() - 0.1) < 2e-3);
    assert_int_equal(grobo_virtual_run(robot, 2000000), GROBO_OK);
    assert_int_equal(grobo_robot_set_imu(engine, &leaning), GROBO_OK);
    assert_int_equal(grobo_virtual_run(robot, GROBO_IMU_AGE_US + 1000), GROBO_OK);
    assert_true(move() > 0); /* old */
    assert_int_equal(seen.known, 1);
    assert_true(fabs(told_rad()) < 2e-3);
    grobo_virtual_free(robot);
}

TEST(both_stabilizers_see_a_target_and_an_error_ends_it)
{
    begin(NULL, true);
    assert_int_equal(grobo_robot_set_imu(grobo_virtual_robot(robot), &leaning), GROBO_OK);
    assert_true(move() > 0);
    assert_true(fabs(told_rad() - 0.3) < 2e-3); /* 0.2 by angles, then 0.1 by the IMU */
    assert_int_equal(grobo_virtual_run(robot, 2000000), GROBO_OK);
    seen.result = GROBO_ERR_SPACE;
    int calls = seen.calls;
    (void)move();
    assert_true(seen.calls > calls);
    assert_true(fabs(told_rad() - 0.3) < 2e-3); /* 0.2 without a reading: it was not sent */
    grobo_virtual_free(robot);
}

TEST(the_base_of_a_body_of_a_program_is_read_by_itself)
{
    int n = 20;
    const grobo_sim_plant plant = {plant_step, &n, plant_imu};
    const grobo_model *model = grobo_gr001_driver(GROBO_WIRING_BUS)->model;
    const grobo_sim_physics_config world = {GROBO_SIM_PHYSICS_CONFIG_INIT, .model = model,
                                            .plant = &plant};
    grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .model = model};
    grobo_imu got;
    assert_int_equal(grobo_sim_physics_new(&world, NULL, &sim.physics), GROBO_OK);
    of_plant = leaning;
    plant_result = GROBO_OK;
    begin(&sim, false);
    assert_int_equal(grobo_sim_imu(grobo_virtual_sim(robot), &got), GROBO_OK);
    assert_memory_equal(&got, &leaning, sizeof got);
    assert_int_equal(grobo_sim_imu(NULL, &got), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_imu(grobo_virtual_sim(robot), NULL), GROBO_ERR_ARG);
    assert_true(move() > 0);
    assert_int_equal(seen.known, 1);
    plant_result = GROBO_ERR_IO; /* it tells nothing any more */
    assert_int_equal(grobo_virtual_run(robot, 2000000), GROBO_OK);
    assert_true(move() > 0);
    assert_int_equal(seen.known, 1);
    grobo_virtual_free(robot);
    grobo_sim_physics_free(sim.physics);
    begin(NULL, false);
    assert_int_equal(grobo_sim_imu(grobo_virtual_sim(robot), &got), GROBO_ERR_UNSUPPORTED);
    grobo_virtual_free(robot);
}
