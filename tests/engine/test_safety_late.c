/* SPDX-License-Identifier: MIT */
/* Frames that wait for the line, and frames that are tried again: what is right when they leave. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "src/robot/slot.h"
#include "src/robot/trip.h"
#include "tests/support/raw_frames.h"
#include "tests/support/test.h"

static grobo_test_rig rig;

/* ---- tried again ----------------------------------------------------------------------------- */

TEST_WITH(rig_wirings, a_raw_goal_is_tried_again)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    rig_forget(&rig);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 1000);
    rig_expect(&rig, raw_goal_with_ack(&rig, NECK, 10, 1000), GROBO_ERR_TIMEOUT);
    assert_int_equal(raw_times_sent(&rig), 3);
}

/* A later target has left between two attempts: the old one must not undo it. */
TEST_WITH(rig_wirings, a_raw_goal_is_not_tried_again_over_a_later_target)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    rig_forget(&rig);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 1000);
    int number = raw_goal_with_ack(&rig, NECK, 10, 1000);
    rig_run(&rig, 1000);
    assert_int_equal(raw_times_sent(&rig), 1);
    grobo_posture target = rig_posture(&rig, NECK, -5, 1000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_expect(&rig, number, GROBO_ERR_SUPERSEDED);
    assert_int_equal(raw_times_sent(&rig), 1);
}

/* Its first attempt is why nothing is known of the joint: no reason to refuse the second. */
TEST_WITH(rig_wirings, a_setting_is_tried_again)
{
    rig_start(&rig, &quiet, NULL);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0), GROBO_OK);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 1000);
    rig_forget(&rig);
    int number = raw_cw_limit(&rig, NECK, 40);
    while (raw_times_sent(&rig) < 1) {
        rig_run(&rig, 100);
    }
    rig_run(&rig, 2000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_expect(&rig, number, GROBO_OK);
    assert_true(raw_times_sent(&rig) > 1);
}

/* ---- a line that keeps frames waiting -------------------------------------------------------- */

/* Bytes out of turn: on a bus, frames wait until the line has been quiet for a moment. */
static void babble(int64_t us)
{
    for (int64_t end_us = rig.now_us + us; rig.now_us < end_us;) {
        grobo_robot_rx(&rig.robot, (const uint8_t *)"\x55", 1, rig.now_us);
        rig_run(&rig, 500);
    }
}

/* The rig fails where it is sent faster than the joint can move. */
TEST_WITH(rig_wirings, a_target_that_waits_gets_its_time_when_it_leaves)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, -45, 1000);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    target = rig_posture(&rig, NECK, 45, 250);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 125000);
    grobo_robot_rx(&rig.robot, (const uint8_t *)"\x55", 1, rig.now_us);
    target = rig_posture(&rig, NECK, -45, 10);
    rig_forget(&rig);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    babble(60000);
    rig_run(&rig, 100000);
    int64_t least_ms = rig_wiring == GROBO_WIRING_BUS ? 160 : 120; /* from 60 ms on, or from here */
    assert_in_range(rig_sent_ms(&rig, NECK_ID), least_ms, 200);
    rig_run(&rig, 500000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 45) < 0.2);
}

/* The host is held up between the request and the line; the joint goes on meanwhile. */
TEST_WITH(rig_wirings, a_halt_that_leaves_late_throws_no_joint_back)
{
    for (int64_t stall_us = 0; stall_us <= 150000; stall_us += 10000) {
        rig_start(&rig, &quiet, NULL);
        rig_power(&rig);
        grobo_posture target = rig_posture(&rig, NECK, 45, 500);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 1000000);
        target = rig_posture(&rig, NECK, -45, 500);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 200000);
        assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
        rig_stall(&rig, stall_us);
        double last_deg = rig_angle_deg(&rig, NECK);
        for (int ms = 0; ms < 400; ms++) {
            rig_run(&rig, 1000);
            assert_true(rig_angle_deg(&rig, NECK) <= last_deg + 0.11);
            last_deg = fmin(last_deg, rig_angle_deg(&rig, NECK));
        }
        assert_true(last_deg > -44); /* and it was stopped */
    }
}

/* However many frames wait for the line, there is room for the one that stops the robot. */
TEST_WITH(rig_wirings, a_halt_finds_room)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 45, 2000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 500000);
    int taken = 0;
    grobo_robot_slot *slot;
    while ((slot = grobo_i_slot_take(&rig.robot, GROBO_I_USE_PLAIN)) != NULL) {
        assert_int_equal(rig.driver->check(rig.driver, NULL, 0, &rig.robot.built), 1);
        assert_int_equal(grobo_i_slot_send(slot, &rig.robot.built, GROBO_PRIORITY_SENSE), GROBO_OK);
        taken++;
    }
    assert_true(taken >= 8); /* five small holds, a reading, a job's, a target */
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_FULL);
    assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
    rig_run(&rig, 300000);
    assert_true(rig_angle_deg(&rig, NECK) < 20);
}

/* ---- torque ---------------------------------------------------------------------------------- */

/* The neck is limp and is switched on, while targets for the others fill the line from some moment
 * on: what the job has asked for by then waits. */
static int switch_neck_on(const grobo_robot_config *config, int64_t after_us)
{
    rig_start(&rig, config, NULL);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(NECK), 0), 0);
    int number = grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_TORQUE_ON);
    rig_run(&rig, after_us);
    return number;
}

static void fill_line(int64_t us)
{
    grobo_posture others;
    grobo_posture_init_pose(&others, rig.driver->model);
    others.set &= ~GROBO_JOINT_BIT(NECK);
    for (int64_t end_us = rig.now_us + us; rig.now_us < end_us;) {
        assert_int_equal(grobo_robot_send(&rig.robot, &others), GROBO_OK);
        rig_run(&rig, 1000);
    }
}

/* Whenever it is: no torque comes on after the job that asked for it was cancelled. */
TEST_WITH(rig_wirings, torque_does_not_come_on_after_a_cancel)
{
    for (int64_t after_us = 0; after_us < 40000; after_us += 250) {
        int number = switch_neck_on(&quiet, after_us);
        fill_line(20000);
        if (grobo_robot_job(&rig.robot) == GROBO_JOB_NONE) {
            break;
        }
        unsigned on = rig.torque_on;
        assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
        rig_run(&rig, 100000);
        rig_expect(&rig, number, GROBO_ERR_CANCELED);
        assert_int_equal(rig.torque_on, on);
    }
}

/* A hand moves it, it is read, and then torque would come on where it was: the rig fails. */
TEST_WITH(rig_wirings, torque_comes_on_where_the_joint_was_read_last)
{
    for (int64_t after_us = 0; after_us < 40000; after_us += 250) {
        const grobo_robot_config reads = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
        grobo_joint_info info;
        int number = switch_neck_on(&reads, after_us);
        if (grobo_robot_job(&rig.robot) == GROBO_JOB_NONE) {
            break;
        }
        fill_line(20000);
        if (rig_torque(&rig, NECK) != GROBO_TORQUE_ON) {
            assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 30000, 0), 0);
        }
        int64_t moved_us = rig.now_us;
        do {
            fill_line(1000);
            assert_int_equal(grobo_robot_joint(&rig.robot, NECK, &info), 0);
            assert_true(rig.now_us - moved_us < 2000000);
        } while (rig.now_us - info.angle_age_us < moved_us);
        rig_expect(&rig, number, GROBO_OK);
    }
}

/* Nobody reads it meanwhile: what waited for too long to switch it on knows nothing of it. */
TEST_WITH(rig_wirings, torque_that_waited_for_long_stays_off)
{
    for (int64_t after_us = 0; after_us < 40000; after_us += 1000) {
        int number = switch_neck_on(&quiet, after_us);
        if (grobo_robot_job(&rig.robot) == GROBO_JOB_NONE) {
            break;
        }
        fill_line(2100000);
        if (rig_torque(&rig, NECK) != GROBO_TORQUE_ON) {
            assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 30000, 0), 0);
        }
        rig_expect(&rig, number, GROBO_OK);
    }
}

/* True while a frame waits that switches torque on; that sets the goal to where the neck is. */
static bool torque_waits(void)
{
    return grobo_i_slots_wait(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_I_ORDER_TORQUE,
                              GROBO_TORQUE_ON);
}

static bool hold_waits(void)
{
    return grobo_i_slots_wait(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_I_ORDER_HOLD,
                              GROBO_TORQUE_OFF);
}

/* The neck is in free mode; a hand has let go of it, and it is about to hold again. */
static void let_go_of_neck_until(bool (*waits)(void))
{
    const grobo_robot_config reads = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    rig_start(&rig, &reads, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 0, 100); /* the slow first move is behind */
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    assert_int_equal(grobo_robot_free(&rig.robot, GROBO_JOINT_BIT(NECK), true), 0);
    assert_int_equal(grobo_sim_set_load(&rig.sim, NECK, 200), 0);
    rig_run(&rig, 300000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_BRAKE);
    if (waits == hold_waits) { /* the hand has turned it */
        assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 8000, 0), 0);
    }
    assert_int_equal(grobo_sim_set_load(&rig.sim, NECK, 0), 0);
    for (int ms = 0; !waits(); ms++) {
        assert_true(ms < 2000);
        fill_line(1000);
    }
    rig_forget(&rig);
}

static void let_go_of_neck(void)
{
    let_go_of_neck_until(torque_waits);
}

/* By less than what parts goal and angle. */
TEST_WITH(rig_wirings, a_joint_moved_again_is_not_switched_on)
{
    let_go_of_neck();
    unsigned on = rig.torque_on;
    assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 1500, 150000), 0);
    while (torque_waits() && rig_count(&rig, GROBO_EVENT_JOINT) < 10) {
        fill_line(1000);
    }
    assert_false(torque_waits());
    rig_run(&rig, 50000);
    assert_int_equal(rig.torque_on, on);
}

TEST_WITH(rig_wirings, a_joint_to_be_limp_is_not_switched_on_first)
{
    let_go_of_neck();
    unsigned on = rig.torque_on;
    rig_expect(&rig, grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_OFF), GROBO_OK);
    assert_int_equal(rig.torque_on, on);
}

/* Leaving ends free mode, and what was about to hold stays as it is. */
TEST_WITH(rig_wirings, nothing_is_switched_on_by_leaving)
{
    let_go_of_neck();
    unsigned on = rig.torque_on;
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD), GROBO_OK);
    assert_int_equal(rig.torque_on, on);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_BRAKE);
}

/* The neck's goal is set to where it is; the others, which hold, are sent on as fast as before. */
TEST_WITH(rig_wirings, a_joint_that_begins_to_hold_slows_no_other)
{
    let_go_of_neck_until(hold_waits);
    int id = rig.driver->model->joints[SHOULDER].motor;
    if (rig_wiring == GROBO_WIRING_BUS) {
        return; /* there the slow move after the neck was switched on last is not yet over */
    }
    while (rig_sent_ms(&rig, NECK_ID) < 0) {
        rig_run(&rig, 100);
    }
    grobo_posture target = rig_posture(&rig, SHOULDER, rig_angle_deg(&rig, SHOULDER) + 20, 100);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 5000);
    assert_int_equal(rig_sent_ms(&rig, id), 100);
}

/* Another program has stopped the robot, or a reading has. */
TEST_WITH(rig_wirings, nothing_that_waits_comes_on_after_a_stop)
{
    for (int way = 0; way < 4; way++) {
        let_go_of_neck_until(way % 2 == 0 ? torque_waits : hold_waits);
        unsigned on = rig.torque_on;
        if (way < 2) {
            assert_int_equal(grobo_robot_latch(&rig.robot), GROBO_OK);
        } else {
            grobo_i_trip(&rig.robot, GROBO_TRIP_TEMPERATURE, CHEST, 75, true);
        }
        rig_run(&rig, 100000);
        assert_int_equal(rig.torque_on, on);
        assert_int_equal(rig_sent_ms(&rig, NECK_ID), -1);
    }
}
