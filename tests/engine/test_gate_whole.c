/* SPDX-License-Identifier: MIT */
/* The gate at its bounds, and what it notes when a frame leaves. */
#include <math.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "src/robot/gate.h"
#include "src/robot/slot.h"
#include "src/robot/speed.h"
#include "src/robot/trip.h"
#include "tests/support/raw_frames.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip, other;

static const rig_key nod[] = {{0, {{NECK, 40}}}, {500, {{NECK, 30}}}};

static int send(int joint, double deg, int time_ms)
{
    grobo_posture target = rig_posture(&rig, joint, deg, time_ms);
    return grobo_robot_send(&rig.robot, &target);
}

static void sense(grobo_joint_mask joints, grobo_sense_kind kind)
{
    rig_expect(&rig, grobo_robot_sense(&rig.robot, joints, kind), GROBO_OK);
}

static int id_of(int joint)
{
    return rig.driver->model->joints[joint].motor;
}

/* ---- speed ----------------------------------------------------------------------------------- */

/* 375 deg/s, and 0.1 degree for rounding: a long way shows a limit that is off by a hundredth. */
TEST_WITH(rig_wirings, the_speed_of_a_joint_is_exact)
{
    static const struct {
        double way_deg;
        int least_ms;
    } rows[] = {{149.9, 400}, {150.0, 400}, {150.3, 410}};
    rig_start_at(&rig, 0, &quiet);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        rig_run(&rig, 1000000);
        assert_int_equal(send(SHOULDER, -80, 1000), GROBO_OK);
        rig_run(&rig, 1500000);
        assert_int_equal(send(SHOULDER, -80 + rows[i].way_deg, 10), GROBO_OK);
        rig_run(&rig, 50000);
        assert_int_equal(rig_sent_ms(&rig, id_of(SHOULDER)), rows[i].least_ms);
    }
}

/* Where it is already, too: the wire has no time of nothing. */
TEST_WITH(rig_wirings, no_way_takes_the_least_time)
{
    rig_start_at(&rig, 0, &quiet);
    grobo_target target = {.posture = rig_posture(&rig, NECK, 0, 0)};
    const grobo_robot_order order = {.joints = GROBO_JOINT_BIT(NECK), .each = true};
    assert_int_equal(grobo_i_gate_time(&rig.robot, &order, &target), GROBO_OK);
    assert_int_equal(target.joint_time_us[NECK], 10000);
    assert_int_equal(target.joint_time_us[CHEST], 0);
}

/* Why it was stopped may be that somebody took hold of it. */
TEST_WITH(rig_wirings, the_first_target_after_a_reset_is_slow)
{
    rig_start_at(&rig, 0, &quiet);
    grobo_i_trip(&rig.robot, GROBO_TRIP_TEMPERATURE, CHEST, 75, true);
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
    assert_int_equal(send(NECK, 20, 100), GROBO_OK);
    rig_run(&rig, 50000);
    assert_in_range(rig_sent_ms(&rig, NECK_ID), 320, 340); /* at 60 deg/s */
}

/* ---- who may be moved ------------------------------------------------------------------------ */

/* The target waits for the line, and a hand takes the joint. */
TEST_WITH(rig_wirings, a_target_that_waits_does_not_reach_a_joint_that_is_free_by_then)
{
    rig_start_at(&rig, 0, &quiet);
    assert_int_equal(send(NECK, 20, 500), GROBO_OK);
    assert_int_equal(grobo_robot_free(&rig.robot, GROBO_JOINT_BIT(NECK), true), 0);
    rig_run(&rig, 100000);
    assert_int_equal(rig_sent_ms(&rig, NECK_ID), -1);
    assert_true(fabs(rig_angle_deg(&rig, NECK)) < 0.1);
}

/* It was read, and does not hold: a second file would move it in frames only. */
TEST_WITH(rig_wirings, a_second_file_moves_no_joint_without_torque)
{
    rig_start(&rig, &quiet, NULL);
    rig_clip_init(&clip, nod, 2);
    rig_clip_init(&other, nod, 2);
    clip.only = GROBO_JOINT_BIT(NECK);
    other.only = GROBO_JOINT_BIT(R_KNEE);
    sense(rig_all(&rig), GROBO_SENSE_ALL);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &other.clip, NULL), GROBO_ERR_STATE);
}

/* ---- torque ---------------------------------------------------------------------------------- */

TEST_WITH(rig_wirings, a_goal_holds_within_two_degrees)
{
    rig_start_at(&rig, 0, &quiet);
    for (int sign = -1; sign <= 1; sign += 2) {
        double here_rad = rig.robot.axes[NECK].state.angle_rad;
        rig.robot.axes[NECK].state.goal_rad = here_rad + sign * grobo_rad_from_deg(1.95);
        assert_true(grobo_i_goal_holds(&rig.robot, NECK));
        rig.robot.axes[NECK].state.goal_rad = here_rad + sign * grobo_rad_from_deg(2.05);
        assert_false(grobo_i_goal_holds(&rig.robot, NECK));
    }
}

/* Whatever ran last: what free mode switches waits behind a stop. */
TEST_WITH(rig_wirings, free_mode_is_not_as_urgent_as_a_stop)
{
    bool seen = false;
    rig_start_at(&rig, 0, &quiet);
    rig_expect(&rig, grobo_robot_estop(&rig.robot), GROBO_OK);
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
    assert_int_equal(grobo_robot_free(&rig.robot, rig_all(&rig), true), GROBO_OK);
    for (int i = 0; i < 10000 && rig_torque(&rig, NECK) != GROBO_TORQUE_ON; i++) {
        for (int s = 0; s < GROBO_ROBOT_SLOTS; s++) {
            const grobo_robot_slot *slot = &rig.robot.slots[s];
            bool switches =
                slot->use != GROBO_I_USE_FREE && slot->order.kind == GROBO_I_ORDER_TORQUE;
            assert_true(!switches || slot->txn.priority == GROBO_PRIORITY_USER);
            seen = seen || switches;
        }
        rig_run(&rig, 100);
    }
    assert_true(seen);
}

/* A raw goal has sent it on a long way without torque. Now it holds where it is, and is on none. */
TEST_WITH(rig_wirings, what_begins_to_hold_is_on_no_way)
{
    rig_start(&rig, &quiet, NULL);
    sense(rig_all(&rig), GROBO_SENSE_ALL);
    rig_expect(&rig, raw_goal(&rig, NECK, 10, 10000), GROBO_OK);
    rig_run(&rig, 5000000);
    (void)grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_TORQUE_ON);
    while (rig.torque_on == 0) {
        rig_run(&rig, 100);
    }
    assert_false(grobo_robot_moving(&rig.robot));
    rig_forget(&rig);
    (void)grobo_robot_stop(&rig.robot, true);
    rig_run(&rig, 100000);
    assert_int_equal(rig_sent_ms(&rig, NECK_ID), -1);
}

/* It goes on meanwhile, and a stop finds it on its way. */
TEST_WITH(rig_wirings, what_begins_to_hold_leaves_its_neighbour_on_its_way)
{
    rig_start_at(&rig, 0, &quiet);
    for (int j = NECK; j >= CHEST; j--) { /* each once */
        int moved = j == NECK ? CHEST : NECK;
        double from_deg = rig_angle_deg(&rig, moved);
        rig_expect(&rig, grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(j), 0), 0);
        assert_int_equal(send(moved, from_deg - 40, 5000), GROBO_OK);
        rig_run(&rig, 500000);
        rig_expect(&rig, grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(j), GROBO_TORQUE_ON), 0);
        assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
        rig_run(&rig, 500000);
        double here_deg = rig_angle_deg(&rig, moved);
        assert_true(here_deg < from_deg - 2 && here_deg > from_deg - 15);
        rig_run(&rig, 500000);
        assert_true(fabs(rig_angle_deg(&rig, moved) - here_deg) < 0.01);
    }
}

/* ---- stops ----------------------------------------------------------------------------------- */

/* Its approach takes a while and is read back: until then the motion is a job. */
TEST_WITH(rig_wirings, a_cancel_stops_a_motion_that_begins)
{
    rig_start_at(&rig, -45, &quiet);
    rig_clip_init(&clip, nod, 2);
    clip.only = GROBO_JOINT_BIT(NECK);
    int number = grobo_robot_play(&rig.robot, &clip.clip, NULL);
    while (grobo_robot_play_state(&rig.robot) != GROBO_SEQUENCER_APPROACHING) {
        rig_run(&rig, 100);
    }
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_PLAY);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
    rig_expect(&rig, number, GROBO_ERR_CANCELED);
    rig_run(&rig, 500000);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
    double here_deg = rig_angle_deg(&rig, NECK);
    assert_true(here_deg < -30);
    rig_run(&rig, 2000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
}

/* ---- readings -------------------------------------------------------------------------------- */

/* What a reading does not bring stays as it was. */
TEST_WITH(rig_wirings, a_short_reading_changes_nothing_else)
{
    static const grobo_sense_kind kinds[] = {GROBO_SENSE_POSITION, GROBO_SENSE_GOAL};
    rig_start_at(&rig, 10, &quiet);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, NECK, 40), 0);
    sense(GROBO_JOINT_BIT(NECK), GROBO_SENSE_ALL);
    const grobo_joint_state all = rig.robot.axes[NECK].state;
    assert_true(all.temperature_c > 30 && all.voltage_mv > 6000 && all.current_ma > 0);
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        sense(GROBO_JOINT_BIT(NECK), kinds[i]);
        const grobo_joint_state now = rig.robot.axes[NECK].state;
        assert_int_equal(now.valid, all.valid);
        assert_true(fabs(now.angle_rad - all.angle_rad) < 1e-9);
        assert_true(fabs(now.goal_rad - all.goal_rad) < 1e-9);
        assert_true(now.goal_time_us == all.goal_time_us && now.time_us == all.time_us);
        assert_int_equal(now.speed_dps, all.speed_dps);
        assert_int_equal(now.current_ma, all.current_ma);
        assert_int_equal(now.temperature_c, all.temperature_c);
        assert_int_equal(now.voltage_mv, all.voltage_mv);
        assert_int_equal(now.torque, all.torque);
    }
}

/* Its first attempt left at 0 on a clock that begins there; torque went before the second. */
TEST_WITH(rig_wirings, a_reading_of_the_first_moment_is_of_then)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    grobo_joint_info info;
    rig_epoch_us = 0;
    rig_start(&rig, &config, NULL);
    rig_epoch_us = 1000000;
    assert_int_equal(grobo_sim_set_cable(&rig.sim, HIP, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 1000);
    assert_int_equal(rig.sent[0].at_us, 0);
    assert_true(raw_torque(&rig, HIP, GROBO_TORQUE_OFF) > 0);
    while (raw_times_sent(&rig) == 0) {
        rig_run(&rig, 100);
    }
    assert_int_equal(grobo_sim_set_cable(&rig.sim, HIP, GROBO_SIM_CABLE_IN), 0);
    while (rig_count(&rig, GROBO_EVENT_JOINT) == 0) {
        rig_run(&rig, 100);
    }
    assert_int_equal(rig_last(&rig, GROBO_EVENT_JOINT)->u.joint.joint, HIP);
    assert_int_equal(rig_last(&rig, GROBO_EVENT_JOINT)->u.joint.result, GROBO_OK);
    assert_int_equal(grobo_robot_joint(&rig.robot, HIP, &info), 0);
    assert_false(info.torque_known);
}
