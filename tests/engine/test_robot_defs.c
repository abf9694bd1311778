/* SPDX-License-Identifier: MIT */
/* Each robot that comes with the library: in its simulator the engine finds, moves and stops it. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/robot.h>
#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/robot_file.h>

#include "src/robots/robots.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { S = 1000000 };

static grobo_robot_sim configured;
static grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
static grobo_robot robot;
static grobo_sim sim;
static int64_t now_us;
static int result;
static bool done;

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        done = true;
        result = event->u.job.result;
    }
}

static void start(const grobo_robot_def *def, grobo_wiring wiring)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .bus = {.baud_bps = def->baud_bps}};
    now_us = S;
    assert_int_equal(grobo_robot_def_driver(def, wiring, &driver), GROBO_OK);
    assert_int_equal(grobo_robot_def_sim(def, wiring, &configured), GROBO_OK);
    assert_int_equal(grobo_sim_init(&sim, &configured.config, now_us), GROBO_OK);
    assert_int_equal(grobo_robot_init(&robot, &driver, NULL, &config, now_us), GROBO_OK);
    grobo_robot_on_event(&robot, on_event, NULL);
    grobo_robot_link_up(&robot, now_us);
}

/* Time on the wire of the sync reads that left, with their replies: 10 us a byte at 1 Mbps. */
static int64_t read_us;

static void note_sync_read(const uint8_t *bytes, int n)
{
    enum { INSTRUCTION = 4, LENGTH = 6, HEAD_BYTES = 8, STATUS_BYTES = 6 };
    if (n > HEAD_BYTES && bytes[INSTRUCTION] == GROBO_DXL2_SYNC_READ) {
        int servos = n - HEAD_BYTES;
        read_us += 10 * (n + servos * (STATUS_BYTES + bytes[LENGTH]));
    }
}

static void pump(void)
{
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    size_t got;
    while ((got = grobo_sim_tx(&sim, bytes, sizeof bytes, now_us)) > 0) {
        grobo_robot_rx(&robot, bytes, got, now_us);
    }
    grobo_robot_step(&robot, now_us);
    int n;
    while ((n = grobo_robot_tx(&robot, bytes, sizeof bytes, now_us)) > 0) {
        note_sync_read(bytes, n);
        (void)grobo_sim_rx(&sim, bytes, (size_t)n, now_us);
    }
    int64_t next_us = grobo_robot_deadline(&robot, now_us);
    int64_t sim_us = grobo_sim_packet_deadline(&sim);
    next_us = sim_us < next_us ? sim_us : next_us;
    now_us = next_us > now_us ? next_us : now_us + 1;
}

static void finish(int job)
{
    int64_t until_us = now_us + 60 * (int64_t)S;
    assert_true(job > 0);
    done = false;
    while (!done && now_us < until_us) {
        pump();
    }
    if (!done || result != GROBO_OK) {
        fail_msg("%s: %s", driver.name, done ? grobo_error_text(result) : "does not end");
    }
}

/* A quarter of the way to the upper limit. */
static grobo_posture some_posture(void)
{
    grobo_posture to;
    grobo_posture_init_pose(&to, driver.model);
    for (int j = 0; j < to.n_joints; j++) {
        const grobo_joint *joint = &driver.model->joints[j];
        to.angle_rad[j] += (joint->max_rad - joint->init_rad) / 4;
    }
    to.time_us = S;
    return to;
}

/* Where the shafts are, seen from outside: the joint's angle through sign, zero and gear. */
static void shafts_are_at(const grobo_posture *to)
{
    for (int j = 0; j < to->n_joints; j++) {
        const grobo_joint *joint = &driver.model->joints[j];
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(&sim, j, &view), GROBO_OK);
        double want_deg = grobo_deg_from_rad(grobo_joint_to_servo(joint, to->angle_rad[j]));
        if (fabs(view.angle_mdeg / 1e3 - want_deg) > 1.0) {
            fail_msg("%s: %s is at %.1f deg, not %.1f", driver.name, joint->name,
                     view.angle_mdeg / 1e3, want_deg);
        }
    }
}

TEST(each_moves_in_its_simulator)
{
    for (int i = 0; grobo_i_robot_defs[i] != NULL; i++) {
        start(grobo_i_robot_defs[i], grobo_i_robot_defs[i]->wiring);
        finish(grobo_robot_check(&robot));
        grobo_posture to = some_posture();
        finish(grobo_robot_move(&robot, &to));
        shafts_are_at(&to);
        grobo_posture back;
        grobo_posture_init_pose(&back, driver.model);
        back.time_us = S;
        finish(grobo_robot_move(&robot, &back));
        shafts_are_at(&back);
        to.angle_rad[0] = driver.model->joints[0].max_rad + 0.1;
        assert_int_equal(grobo_robot_move(&robot, &to), GROBO_ERR_LIMIT);
        finish(grobo_robot_exit(&robot, GROBO_EXIT_OFF));
    }
}

/* At power-up a joint stands in its initial posture, and its stops are its limits, whatever way its
 * servo is mounted. */
TEST(servos_stand_as_they_are_mounted)
{
    for (int i = 0; grobo_i_robot_defs[i] != NULL; i++) {
        start(grobo_i_robot_defs[i], grobo_i_robot_defs[i]->wiring);
        for (int j = 0; j < driver.model->n_joints; j++) {
            const grobo_joint *joint = &driver.model->joints[j];
            grobo_sim_view view;
            assert_int_equal(grobo_sim_look(&sim, j, &view), GROBO_OK);
            assert_true(fabs(view.angle_mdeg / 1e3 - grobo_deg_from_rad(grobo_joint_to_servo(
                                                         joint, joint->init_rad))) < 0.01);
            double ends_deg[2] = {grobo_deg_from_rad(grobo_joint_to_servo(joint, joint->min_rad)),
                                  grobo_deg_from_rad(grobo_joint_to_servo(joint, joint->max_rad))};
            for (int end = 0; end < 2; end++) {
                int32_t beyond = ends_deg[end] > ends_deg[1 - end] ? 900000 : -900000;
                assert_int_equal(grobo_sim_set_angle(&sim, j, beyond, 0), GROBO_OK);
                assert_int_equal(grobo_sim_look(&sim, j, &view), GROBO_OK);
                assert_true(fabs(view.angle_mdeg / 1e3 - ends_deg[end]) < 0.01);
            }
        }
    }
}

/* Six STS3215 are read as fast as their wire goes: at least 95 % of it. */
TEST(an_arm_is_read_as_fast_as_its_wire)
{
    start(&grobo_i_robot_so101, GROBO_WIRING_BUS);
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .bus = {.baud_bps = 1000000},
                                 .sense_interval_us = 1};
    assert_int_equal(grobo_robot_configure(&robot, &config), GROBO_OK);
    finish(grobo_robot_sense(&robot, GROBO_JOINTS_ALL(6), GROBO_SENSE_FULL));
    read_us = 0;
    int64_t from_us = now_us;
    while (now_us < from_us + S) {
        pump();
    }
    print_message("%.1f %% of the wire\n", (double)read_us * 100 / (double)(now_us - from_us));
    assert_true(read_us * 100 >= 95 * (now_us - from_us));
    assert_true(read_us <= now_us - from_us);
}

TEST(gr001_is_on_a_bus_too)
{
    start(grobo_i_robot_defs[0], GROBO_WIRING_BUS);
    grobo_posture to = some_posture();
    finish(grobo_robot_move(&robot, &to));
    shafts_are_at(&to);
    assert_int_equal(grobo_robot_def_driver(grobo_i_robot_defs[1], GROBO_WIRING_BOARD, &driver),
                     GROBO_ERR_UNSUPPORTED);
}
