/* SPDX-License-Identifier: MIT */
/* The engine and a simulated robot that has weight. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <grobo/core/robot_plant.h>
#include <grobo/posture.h>

#include "tests/support/test.h"
#include "tests/support/weight_kit.h"

weight_world weight;

static int64_t clock_us(void *ctx)
{
    (void)ctx;
    return weight.now_us;
}

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        weight.ended = event->u.job.number;
        weight.result = event->u.job.result;
        weight.ended_us = weight.now_us;
    } else if (event->kind == GROBO_EVENT_TRIP) {
        weight.tripped = event->u.trip.trip;
        weight.tripped_joint = event->u.trip.joint;
        weight.tripped_us = event->u.trip.at_us;
    }
}

static void exchange(void)
{
    uint8_t buf[256];
    int n;
    size_t got;
    do {
        while ((got = grobo_sim_tx(&weight.sim, buf, sizeof buf, weight.now_us)) > 0) {
            grobo_robot_rx(&weight.robot, buf, got, weight.now_us);
        }
        grobo_robot_step(&weight.robot, weight.now_us);
        while ((n = grobo_robot_tx(&weight.robot, buf, sizeof buf, weight.now_us)) > 0) {
            if (weight.lose > 0) {
                weight.lose--;
            } else {
                assert_int_equal(grobo_sim_rx(&weight.sim, buf, (size_t)n, weight.now_us), n);
            }
        }
    } while (grobo_sim_deadline(&weight.sim) <= weight.now_us);
}

void weight_run(int64_t us)
{
    for (int64_t until_us = weight.now_us + us; weight.now_us < until_us;) {
        weight.now_us += 250;
        exchange();
    }
}

int weight_wait(int job)
{
    assert_true(job > 0);
    int64_t until_us = weight.now_us + 60LL * WEIGHT_S;
    while (weight.ended != job && weight.now_us < until_us) {
        weight_run(WEIGHT_MS);
    }
    assert_int_equal(weight.ended, job);
    return weight.result;
}

void weight_wait_if(int job)
{
    if (job > 0) {
        (void)weight_wait(job);
    }
}

double weight_angle_deg(int joint)
{
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&weight.sim, joint, &view), 0);
    return view.angle_mdeg / 1000.0;
}

double weight_goal_deg(int joint)
{
    const grobo_servo_register *reg =
        grobo_servo_register_of(weight.setting.servos[joint], GROBO_ROLE_GOAL);
    int32_t ticks = 0;
    assert_int_equal(grobo_sim_get_register(&weight.sim, joint, reg->address, &ticks), 0);
    return (ticks - 2048) * 360 / 4096.0;
}

double weight_load_nm(int joint)
{
    grobo_sim_physics_view view;
    assert_int_equal(grobo_sim_physics_look(weight.physics, joint, &view), 0);
    return view.load_nm;
}

void weight_new_engine(void)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT};
    const grobo_robot_host host = {.clock = clock_us};
    assert_int_equal(grobo_robot_init(&weight.robot, &weight.driver, NULL, &config, weight.now_us),
                     0);
    grobo_robot_set_host(&weight.robot, &host);
    grobo_robot_on_event(&weight.robot, on_event, NULL);
    grobo_robot_link_up(&weight.robot, weight.now_us);
    weight.tripped = GROBO_TRIP_NONE;
    weight_run(50 * WEIGHT_MS);
}

static const grobo_robot_def *robot_named(const char *name)
{
    assert_non_null(grobo_robot_def_find(name));
    return grobo_robot_def_find(name);
}

static void set_register(int joint, const grobo_servo_register *reg, int32_t value)
{
    if (reg != NULL) {
        assert_int_equal(grobo_sim_set_register(&weight.sim, joint, reg->address, value), 0);
    }
}

/* ---- a plant in another process -------------------------------------------------------------- */

static int plant_in, plant_out;

static void whole(bool writes, void *bytes, size_t n)
{
    for (size_t at = 0; at < n;) {
        uint8_t *from = (uint8_t *)bytes + at;
        ssize_t got = writes ? write(plant_out, from, n - at) : read(plant_in, from, n - at);
        assert_true(got > 0);
        at += (size_t)got;
    }
}

/* The doubles of tests/physics/plant_pipe.c. */
static int step_plant(void *ctx, const grobo_sim_drive *drive, double dt_s, grobo_sim_state *state)
{
    double out[GROBO_JOINTS_MAX * 6], in[GROBO_JOINTS_MAX * 3];
    int n = weight.def->model->n_joints;
    (void)ctx;
    (void)dt_s;
    for (int i = 0; i < n; i++) {
        const double one[] = {drive[i].torque_nm,     drive[i].damping_nms, drive[i].friction_nm,
                              drive[i].armature_kgm2, state[i].angle_rad,   state[i].speed_rad_s};
        memcpy(out + 6 * i, one, sizeof one);
    }
    whole(true, out, (size_t)n * 6 * sizeof out[0]);
    whole(false, in, (size_t)n * 3 * sizeof in[0]);
    for (int i = 0; i < n; i++) {
        state[i] = (grobo_sim_state){in[3 * i], in[3 * i + 1], in[3 * i + 2]};
    }
    return GROBO_OK;
}

static int make_physics(void)
{
    static const grobo_sim_plant plant = {.step = step_plant};
    const char *pipes = getenv("GROBO_PLANT");
    if (pipes == NULL) {
        return grobo_robot_def_physics(weight.def, false, NULL, &weight.physics);
    }
    assert_int_equal(sscanf(pipes, "%d,%d", &plant_in, &plant_out), 2);
    return grobo_robot_def_plant(weight.def, &plant, false, NULL, &weight.physics);
}

void weight_begin(const char *robot, int gain)
{
    weight_begin_def(robot_named(robot), gain);
}

void weight_begin_def(const grobo_robot_def *def, int gain)
{
    weight_finish();
    weight.def = def;
    const grobo_wiring wiring = weight.def->wiring;
    weight.driver.size = sizeof weight.driver;
    assert_int_equal(grobo_robot_def_driver(weight.def, wiring, &weight.driver), 0);
    assert_int_equal(grobo_robot_def_sim(weight.def, wiring, &weight.setting), 0);
    assert_int_equal(make_physics(), 0);
    weight.setting.config.physics = weight.physics;
    weight.now_us = WEIGHT_S;
    weight.ended = 0;
    weight.lose = 0;
    assert_int_equal(grobo_sim_init(&weight.sim, &weight.setting.config, weight.now_us), 0);
    for (int j = 0; j < weight.def->model->n_joints; j++) {
        const grobo_servo_model *servo = weight.setting.servos[j];
        if (gain > 0) {
            set_register(j, grobo_servo_register_named(servo, "position_p"), gain);
        }
        set_register(j, grobo_servo_register_of(servo, GROBO_ROLE_TORQUE), 1);
    }
    weight.now_us += 2 * WEIGHT_S;
    grobo_sim_step(&weight.sim, weight.now_us);
    weight_new_engine();
}

void weight_finish(void)
{
    grobo_sim_physics_free(weight.physics);
    weight.physics = NULL;
}

grobo_posture weight_target(int joint, double deg, int ms)
{
    grobo_posture target;
    assert_int_equal(grobo_posture_init(&target, weight.def->model->n_joints), 0);
    assert_int_equal(grobo_posture_set_rad(&target, joint, grobo_rad_from_deg(deg)), 0);
    target.time_us = ms * WEIGHT_MS;
    return target;
}

int weight_move(int joint, double deg, int ms)
{
    const grobo_posture target = weight_target(joint, deg, ms);
    int job = grobo_robot_move(&weight.robot, &target);
    return job < 0 ? job : weight_wait(job);
}

int weight_torque(grobo_torque mode)
{
    int job =
        grobo_robot_torque(&weight.robot, GROBO_JOINTS_ALL(weight.def->model->n_joints), mode);
    return job < 0 ? job : weight_wait(job);
}

const char *weight_do_nothing(unsigned which)
{
    const grobo_posture far_away = weight_target(0, 500, 500);
    switch (which) {
    case 0:
        weight_new_engine();
        return "connect";
    case 1:
        (void)weight_torque(GROBO_TORQUE_ON);
        return "torque on";
    default:
        assert_true(grobo_robot_move(&weight.robot, &far_away) < 0);
        weight_wait_if(grobo_robot_exit(&weight.robot, GROBO_EXIT_HOLD));
        weight_new_engine();
        return "a refused move";
    }
}
