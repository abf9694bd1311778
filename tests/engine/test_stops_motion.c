/* SPDX-License-Identifier: MIT */
/* Motions that are stopped, by whatever stops them: softly, ahead, and then it is quiet. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/robot.h>

#include "tests/support/raw_frames.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip;

/* From -45 to 45 degrees in 2 s, then a while there. */
static const rig_key rise[] = {{0, {{NECK, -45}}}, {2000, {{NECK, 45}}}, {4000, {{NECK, 45}}}};

enum { STOP, STOP_AT_ONCE, EXIT, TRIP, PAUSE, WAYS };

static void begin_to_play(grobo_play_mode mode)
{
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = mode, .rate_hz = 30};
    rig_clip_init(&clip, rise, 3);
    clip.only = GROBO_JOINT_BIT(NECK);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
}

static void stop_by(int way)
{
    switch (way) {
    case STOP:
    case STOP_AT_ONCE:
        assert_int_equal(grobo_robot_stop(&rig.robot, way == STOP_AT_ONCE), GROBO_OK);
        break;
    case EXIT:
        assert_true(grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD) > 0);
        break;
    case TRIP:
        assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, 75), 0);
        rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), GROBO_SENSE_FULL),
                   GROBO_OK);
        break;
    default:
        assert_int_equal(grobo_robot_pause(&rig.robot), GROBO_OK);
        break;
    }
}

TEST_WITH(rig_wirings, whatever_stops_a_motion_throws_no_joint_back)
{
    static const grobo_play_mode modes[] = {GROBO_PLAY_KEY, GROBO_PLAY_RATE};
    for (int i = 0; i < 2 * WAYS; i++) {
        int way = i / 2;
        rig_start_at(&rig, -45, &quiet);
        begin_to_play(modes[i % 2]);
        rig_run(&rig, 1000000);
        stop_by(way);
        double asked_deg = rig_angle_deg(&rig, NECK);
        double most_deg = asked_deg;
        for (int ms = 0; ms < 400; ms++) {
            rig_run(&rig, 1000);
            double deg = rig_angle_deg(&rig, NECK);
            assert_true(deg >= most_deg - (way == STOP_AT_ONCE ? 2 : 0.3));
            most_deg = fmax(deg, most_deg);
        }
        /* Half of the 200 ms that it takes, behind a frame that is a period old. */
        assert_true(most_deg - asked_deg < 45 * 0.15);
        double here_deg = rig_angle_deg(&rig, NECK);
        assert_true(here_deg > -5 && here_deg < 8);
        rig_run(&rig, 1000000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
        grobo_sequencer_state now = grobo_robot_play_state(&rig.robot);
        assert_int_equal(now, way == PAUSE ? GROBO_SEQUENCER_PAUSED : GROBO_SEQUENCER_IDLE);
    }
}

/* The frame that brings the motion to rest waits behind a reading, and something else comes. */
TEST_WITH(rig_wirings, a_stop_is_not_lost_by_what_comes_behind_it)
{
    enum { AGAIN, LEAVE, LET_GO, HEAT, SEND, SEND_BOTH, BEHINDS };
    for (int i = 0; i < 2 * BEHINDS; i++) {
        const grobo_joint_mask others = GROBO_JOINT_BIT(CHEST) | GROBO_JOINT_BIT(NECK);
        bool at_once = i % 2 != 0;
        rig_start_at(&rig, -45, &quiet);
        rig_clip_init(&clip, rise, 3);
        clip.only = others;
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, 500000);
        assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, i / 2 == HEAT ? 75 : 30), 0);
        grobo_sim_cable cable = i / 2 < SEND ? GROBO_SIM_CABLE_IN : GROBO_SIM_CABLE_MUTE;
        assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, cable), 0);
        int number = grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), GROBO_SENSE_ALL);
        rig_run(&rig, 500);
        assert_int_equal(grobo_robot_stop(&rig.robot, at_once), GROBO_OK);
        rig_run(&rig, 500);
        double asked_deg = rig_angle_deg(&rig, NECK);
        grobo_posture chest = rig_posture(&rig, CHEST, -5, 1000);
        grobo_posture both = chest;
        assert_int_equal(grobo_posture_set_deg(&both, NECK, asked_deg), 0);
        switch (i / 2) {
        case AGAIN:
            assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
            break;
        case LEAVE:
            assert_true(grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD) > 0);
            break;
        case LET_GO:
            assert_true(grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(CHEST), GROBO_TORQUE_OFF) >
                        0);
            break;
        case HEAT:
            rig_expect(&rig, number, GROBO_OK);
            assert_int_equal(rig_count(&rig, GROBO_EVENT_TRIP), 1);
            break;
        default: /* at once it is over while its frame waits */
            rig.robot.bus.free_us += 20000;
            rig_run(&rig, 12000);
            assert_int_equal(grobo_robot_send(&rig.robot, i / 2 == SEND ? &chest : &both),
                             at_once ? GROBO_OK : GROBO_ERR_STATE);
            break;
        }
        rig_run(&rig, 1500000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - asked_deg) < 8);
        assert_true(i / 2 < SEND || !at_once || fabs(rig_angle_deg(&rig, CHEST) + 5) < 0.2);
    }
}

/* Nor is a pause, whose motion goes on to wait. */
TEST_WITH(rig_wirings, a_pause_is_not_lost_by_what_comes_behind_it)
{
    for (int cancels = 0; cancels < 2; cancels++) {
        rig_start_at(&rig, -45, &quiet);
        rig_clip_init(&clip, rise, 3);
        clip.only = GROBO_JOINT_BIT(CHEST) | GROBO_JOINT_BIT(NECK);
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, 500000);
        assert_true(grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), GROBO_SENSE_ALL) > 0);
        rig_run(&rig, 500);
        assert_true(raw_goal(&rig, SHOULDER, 0, 1000) > 0);
        assert_int_equal(grobo_robot_pause(&rig.robot), GROBO_OK);
        rig_run(&rig, 500);
        double asked_deg = rig_angle_deg(&rig, NECK);
        assert_true(
            cancels ? grobo_robot_cancel(&rig.robot) == GROBO_OK
                    : grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(CHEST), GROBO_TORQUE_OFF) > 0);
        rig_run(&rig, 1500000);
        assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_PAUSED);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - asked_deg) < 8);
    }
}

/* What a stop may add to the way of a joint: half of what it does in the 200 ms of a smooth one,
 * and what it does while the frame is on its way. */
static double stop_way_deg(int way)
{
    return 375 * ((way == STOP_AT_ONCE ? 0.005 : 0.1) + 0.04);
}

/* The clip is through with a way that takes the joint half a second. */
TEST_WITH(rig_wirings, a_stop_begins_where_a_joint_is_that_is_behind)
{
    static const rig_key leap[] = {
        {0, {{SHOULDER, 100}}}, {100, {{SHOULDER, -100}}}, {4000, {{SHOULDER, -100}}}};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                        .rate_hz = 30};
    for (int way = 0; way < WAYS; way++) {
        rig_start_at(&rig, 0, &quiet);
        rig_clip_init(&clip, leap, 3);
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, 200000);
        stop_by(way);
        double asked_deg = rig_angle_deg(&rig, SHOULDER);
        assert_true(asked_deg > 0);
        rig_run(&rig, 1500000);
        assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - asked_deg) < stop_way_deg(way));
    }
}

/* A weak supply: the shoulder falls 60 degrees behind, and is read. */
TEST_WITH(rig_wirings, a_stop_of_a_motion_begins_where_a_weak_joint_is)
{
    static const rig_key leap[] = {
        {0, {{SHOULDER, -100}}}, {540, {{SHOULDER, 100}}}, {4000, {{SHOULDER, 100}}}};
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                       .sense_interval_us = GROBO_SENSE_NEVER, .voltage_mv = -1};
    for (int way = 0; way < WAYS; way++) {
        rig_start_at(&rig, 0, &config);
        rig_clip_init(&clip, leap, 3);
        clip.only = GROBO_JOINT_BIT(SHOULDER);
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
        while (rig_angle_deg(&rig, SHOULDER) > -99.5) {
            rig_run(&rig, 10000);
        }
        grobo_sim_set_supply(&rig.sim, 7400 * 2 / 3);
        while (rig_angle_deg(&rig, SHOULDER) < -20) {
            rig_run(&rig, 1000);
        }
        rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(SHOULDER), GROBO_SENSE_FULL),
                   GROBO_OK);
        stop_by(way);
        double asked_deg = rig_angle_deg(&rig, SHOULDER);
        rig_run(&rig, 1500000);
        assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - asked_deg) < stop_way_deg(way));
        assert_true(way != STOP_AT_ONCE ||
                    rig_sent_ms(&rig, grobo_i_gr001_model.joints[SHOULDER].motor) <= 20);
    }
}

/* The clip has the neck at 30 degrees by then. */
TEST_WITH(rig_wirings, a_stop_leaves_a_joint_where_a_raw_goal_sent_it)
{
    for (int way = 0; way < WAYS; way++) {
        rig_start_at(&rig, -45, &quiet);
        begin_to_play(GROBO_PLAY_KEY);
        rig_run(&rig, 500000);
        rig_expect(&rig, raw_goal(&rig, NECK, -45, 1000), GROBO_OK);
        rig_run(&rig, 1100000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) + 45) < 0.1);
        stop_by(way);
        rig_run(&rig, 1500000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) + 45) < 0.5);
    }
}

/* The motion goes on, and its next frame is seconds away. */
TEST_WITH(rig_wirings, a_cancel_halts_what_a_raw_goal_moves_in_a_motion)
{
    rig_start_at(&rig, -45, &quiet);
    begin_to_play(GROBO_PLAY_KEY);
    rig_run(&rig, 500000);
    int number = raw_goal_with_ack(&rig, NECK, 40, 400);
    while (raw_times_sent(&rig) == 0) {
        rig_run(&rig, 100);
    }
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
    rig_expect(&rig, number, GROBO_ERR_CANCELED);
    rig_run(&rig, 300000);
    double here_deg = rig_angle_deg(&rig, NECK);
    assert_true(here_deg < 0);
    rig_run(&rig, 500000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
    assert_true(grobo_robot_is_playing(&rig.robot));
}

/* The shoulder needs longer than its clip, and the next one does not move it. */
TEST_WITH(rig_wirings, a_stop_reaches_a_joint_of_the_clip_before)
{
    static const rig_key leap[] = {{0, {{SHOULDER, 100}}}, {100, {{SHOULDER, -100}}}};
    static rig_clip next;
    for (int way = 0; way <= PAUSE; way++) {
        const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .also = GROBO_JOINT_BIT(NECK)};
        rig_start_at(&rig, -45, &quiet);
        rig_clip_init(&clip, leap, 2);
        rig_clip_init(&next, rise, 3);
        clip.only = GROBO_JOINT_BIT(SHOULDER);
        next.only = GROBO_JOINT_BIT(NECK);
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
        assert_int_equal(grobo_robot_enqueue(&rig.robot, &next.clip, NULL), 1);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, 200000);
        stop_by(way);
        double asked_deg = rig_angle_deg(&rig, SHOULDER);
        assert_true(asked_deg > 0);
        rig_run(&rig, 1500000);
        assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - asked_deg) < stop_way_deg(STOP));
    }
}

static int goals_sent(void)
{
    int goals = 0;
    for (size_t i = 0; i < rig.n_sent; i++) {
        const uint8_t *packet;
        goals += rig_packet(&rig.sent[i], &packet) > 8 && packet[4] == GROBO_RS30X_GOAL;
    }
    return goals;
}

/* A raw goal moved the neck before the motion did: it is the motion's by now, and rests with it. */
TEST_WITH(rig_wirings, a_stop_is_smooth_where_a_raw_goal_was_before)
{
    rig_start_at(&rig, -45, &quiet);
    rig_expect(&rig, raw_goal(&rig, NECK, -44, 200), GROBO_OK);
    begin_to_play(GROBO_PLAY_KEY);
    rig_run(&rig, 1000000);
    rig_forget(&rig);
    stop_by(STOP);
    rig_run(&rig, 1000000);
    assert_int_equal(goals_sent(), 1);
}

/* While the end of a motion is read back, joint by joint, and repeated where it was lost. */
TEST_WITH(rig_wirings, a_stop_after_a_motion_is_not_undone_by_its_end)
{
    bool settles = true;
    for (int ms = 1; settles; ms += 8) {
        rig_start_at(&rig, -45, &quiet);
        begin_to_play(GROBO_PLAY_KEY);
        rig_run(&rig, 3800000);
        rig_expect(&rig, raw_goal(&rig, SHOULDER, 120, 2500), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
        rig_run(&rig, ms * 1000);
        settles = grobo_robot_settling(&rig.robot);
        assert_true(settles || ms > 50);
        assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
        double asked_deg = rig_angle_deg(&rig, SHOULDER);
        rig_run(&rig, 3000000);
        assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - asked_deg) < 5);
    }
}

/* The one frame of a target is lost, and the joint is read to stand still where it was. */
TEST_WITH(rig_wirings, a_stop_moves_no_joint_that_lost_its_frame)
{
    const grobo_robot_config reading = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 200000};
    rig_start_at(&rig, -45, &reading);
    grobo_posture target = rig_posture(&rig, NECK, 45, 3000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 15000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_run(&rig, 1500000);
    assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 45) < 0.1);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 3500000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 45) < 0.1);
}

/* The line was away while a joint moved, and it was read once on its way: long after that it is
 * where its servo has come by itself, and a stop does not send it back. */
TEST_WITH(rig_wirings, a_stop_believes_no_old_reading_of_a_joint_that_turns)
{
    static const grobo_sense_kind kinds[] = {GROBO_SENSE_POSITION, GROBO_SENSE_GOAL,
                                             GROBO_SENSE_FULL, GROBO_SENSE_ALL};
    for (int i = 0; i < 8; i++) {
        rig_start_at(&rig, -45, &quiet);
        grobo_posture target = rig_posture(&rig, NECK, 45, 3000);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 1000000);
        grobo_robot_link_down(&rig.robot, rig.now_us);
        grobo_robot_link_up(&rig.robot, rig.now_us);
        assert_true(grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(NECK), kinds[i % 4]) > 0);
        rig_run(&rig, i < 4 ? 4000000 : 500000);
        double asked_deg = rig_angle_deg(&rig, NECK);
        assert_int_equal(grobo_robot_stop(&rig.robot, i % 2 == 0), GROBO_OK);
        rig_run(&rig, 1000000);
        if (fabs(rig_angle_deg(&rig, NECK) - asked_deg) > 5) {
            fail_msg("row %d: stopped at %.1f, and stands at %.1f deg", i, asked_deg,
                     rig_angle_deg(&rig, NECK));
        }
    }
}

/* It creeps on, where an earlier target has sent it: the stop is for that way. */
TEST_WITH(rig_wirings, a_stop_ends_the_way_of_a_joint_that_lost_its_frame)
{
    for (int angle_too = 0; angle_too < 2; angle_too++) {
        rig_start_at(&rig, -45, &quiet);
        grobo_posture target = rig_posture(&rig, NECK, 45, 13000);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 500000);
        target.time_us = 3000000;
        assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 15000);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
        rig_run(&rig, 1000000);
        for (int i = 0; i <= angle_too; i++) { /* the angle alone tells nothing new */
            grobo_sense_kind kind = i == 0 ? GROBO_SENSE_ALL : GROBO_SENSE_POSITION;
            rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(NECK), kind), GROBO_OK);
        }
        double asked_deg = rig_angle_deg(&rig, NECK);
        assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
        rig_run(&rig, 3000000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - asked_deg) < 2);
    }
}

/* The frame that was to turn it round is lost, and it is read ahead of its way, without its goal:
 * at full speed, or slowly where the way is over. */
TEST_WITH(rig_wirings, a_stop_ends_a_way_that_was_to_be_over)
{
    static const struct {
        int there_ms, back_ms, read_ms;
        double most_deg; /* that it may be pulled back or go on */
    } rows[] = {{530, 5000, 300, 20}, {8000, 200, 900, 3}, {8000, 5000, 2500, 3}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        rig_start_at(&rig, 0, &quiet);
        grobo_posture target = rig_posture(&rig, SHOULDER, -100, 1000);
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
        target = rig_posture(&rig, SHOULDER, 100, rows[i].there_ms);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 150000);
        target = rig_posture(&rig, SHOULDER, -100, rows[i].back_ms);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, SHOULDER, GROBO_SIM_CABLE_MUTE), 0);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 15000);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, SHOULDER, GROBO_SIM_CABLE_IN), 0);
        rig_run(&rig, rows[i].read_ms * 1000);
        rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(SHOULDER), GROBO_SENSE_FULL),
                   GROBO_OK);
        double asked_deg = rig_angle_deg(&rig, SHOULDER);
        assert_true(grobo_robot_moving(&rig.robot));
        assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
        rig_run(&rig, 3000000);
        assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - asked_deg) < rows[i].most_deg);
        assert_false(grobo_robot_moving(&rig.robot));
    }
}

/* Who is not read again is not taken to move for ever. */
TEST_WITH(rig_wirings, what_turns_off_its_way_is_forgotten)
{
    rig_start_at(&rig, 0, &quiet);
    grobo_posture target = rig_posture(&rig, SHOULDER, 100, 10000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 4000000);
    target = rig_posture(&rig, SHOULDER, 0, 600);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, SHOULDER, GROBO_SIM_CABLE_MUTE), 0);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 15000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, SHOULDER, GROBO_SIM_CABLE_IN), 0);
    rig_run(&rig, 1500000);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(SHOULDER), GROBO_SENSE_FULL),
               GROBO_OK);
    rig_run(&rig, GROBO_WATCH_US - 100000);
    assert_true(grobo_robot_moving(&rig.robot));
    rig_run(&rig, 100000);
    assert_false(grobo_robot_moving(&rig.robot));
}

/* Another program moves it, where this one may not: to its limit it comes softly. */
TEST_WITH(rig_wirings, a_stop_outside_the_limits_is_slow)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    const grobo_rs30x_goal goal = {NECK_ID, 490, 1000};
    rig_start_narrow(&rig);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 15, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    int n = grobo_frame_goals(rig.driver->protocol, &goal, 1, frame, sizeof frame);
    assert_int_equal(grobo_sim_rx(&rig.sim, frame, (size_t)n, rig.now_us), n);
    rig_run(&rig, 8000000);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_SENSE_ALL),
               GROBO_OK);
    assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
    double before_deg = rig_angle_deg(&rig, NECK);
    assert_true(before_deg > 40);
    for (int i = 0; i < 20; i++) {
        rig_run(&rig, 50000);
        double deg = rig_angle_deg(&rig, NECK);
        assert_true(before_deg - deg < 0.05 * 66);
        before_deg = deg;
    }
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 20) < 0.2);
}

/* A reading that was on the line tells of one more joint that moves, sent there by nobody here. */
TEST_WITH(rig_wirings, a_halt_is_for_what_moves_when_it_leaves)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    const grobo_rs30x_goal goal = {NECK_ID, -400, 500};
    rig_start_at(&rig, 0, &quiet);
    grobo_posture target = rig_posture(&rig, NECK, 10, 200);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 500000);
    int n = grobo_frame_goals(rig.driver->protocol, &goal, 1, frame, sizeof frame);
    assert_int_equal(grobo_sim_rx(&rig.sim, frame, (size_t)n, rig.now_us), n);
    target = rig_posture(&rig, SHOULDER, 90, 5000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 500000);
    assert_true(grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_SENSE_ALL) > 0);
    rig_run(&rig, 1000);
    assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
    rig_run(&rig, 300000);
    double shoulder_deg = rig_angle_deg(&rig, SHOULDER);
    double neck_deg = rig_angle_deg(&rig, NECK);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - shoulder_deg) < 0.01);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - neck_deg) < 0.01);
}

/* Asked before the halt left and answered after it: of a joint that it does not stop it tells. */
TEST_WITH(rig_wirings, a_halt_makes_no_reading_of_others_stale)
{
    rig_start(&rig, &quiet, NULL);
    grobo_posture target = rig_posture(&rig, NECK, 10, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    target = rig_posture(&rig, NECK, -45, 5000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 500000);
    rig_forget(&rig);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), 0);
    int number = grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), GROBO_SENSE_ALL);
    rig_run(&rig, 1000);
    assert_int_equal(rig.n_sent, 1);
    assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
    while (goals_sent() == 0) {
        rig_run(&rig, 100);
    }
    assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_IN), 0);
    rig_expect(&rig, number, GROBO_OK);
    target = rig_posture(&rig, R_KNEE, rig_angle_deg(&rig, R_KNEE), 1000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STATE); /* limp */
    /* One that was never read is, to be halted; it is limp, too. */
    rig_run(&rig, 500000);
    target = rig_posture(&rig, CHEST, 0, 1000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STATE);
}

/* It was told to let go, did not hear that, and is known to hold, or not known not to. */
TEST_WITH(rig_wirings, a_stop_reaches_a_joint_that_was_to_let_go)
{
    for (int reads = 0; reads < 2; reads++) {
        rig_start_at(&rig, -45, &quiet);
        grobo_joint_mask neck = GROBO_JOINT_BIT(NECK);
        grobo_posture target = rig_posture(&rig, NECK, 45, 4000);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 500000);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
        int number = grobo_robot_torque(&rig.robot, neck, GROBO_TORQUE_OFF);
        rig_run(&rig, 4000);
        assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
        rig_expect(&rig, number, GROBO_ERR_CANCELED);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
        if (reads) {
            number = grobo_robot_sense(&rig.robot, neck, GROBO_SENSE_ALL);
            rig_expect(&rig, number, GROBO_OK);
        }
        assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
        rig_run(&rig, 300000);
        double here_deg = rig_angle_deg(&rig, NECK);
        rig_run(&rig, 1000000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
    }
}

/* A servo that writes its flash or restarts hears nothing for up to two seconds. */
TEST_WITH(rig_wirings, a_stop_reaches_a_servo_that_was_deaf)
{
    for (int exits = 0; exits < 2; exits++) {
        rig_start_at(&rig, 0, &quiet);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
        int number =
            exits ? grobo_robot_exit(&rig.robot, GROBO_EXIT_OFF) : grobo_robot_estop(&rig.robot);
        rig_run(&rig, 2200000);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
        rig_expect(&rig, number, GROBO_OK);
        assert_int_not_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
    }
}

/* One that is deaf when it is to halt and mute when it is read is read again, and halted. */
TEST_WITH(rig_wirings, leaving_looks_again_at_who_was_not_heard)
{
    rig_start_at(&rig, -45, &quiet);
    grobo_posture target = rig_posture(&rig, NECK, 45, 3000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 500000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    int number = grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD);
    for (int silent = 0; silent < 2000; silent++) { /* until its reading has failed */
        grobo_joint_info info;
        assert_int_equal(grobo_robot_joint(&rig.robot, NECK, &info), GROBO_OK);
        if (info.status == GROBO_ERR_TIMEOUT) {
            break;
        }
        rig_run(&rig, 1000);
    }
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_expect(&rig, number, GROBO_OK);
    double left_deg = rig_angle_deg(&rig, NECK);
    rig_run(&rig, 500000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - left_deg) < 0.01);
    assert_true(left_deg < 30);
}

/* A robot that moves is let go when it stands: else its joints would fly on. */
TEST_WITH(rig_wirings, leaving_lets_go_when_the_joints_stand)
{
    for (int by_play = 0; by_play < 2; by_play++) {
        for (int ms = 300; ms < 1500; ms += 170) {
            rig_start_at(&rig, -45, &quiet);
            if (by_play) {
                begin_to_play(GROBO_PLAY_KEY);
            } else {
                grobo_posture target = rig_posture(&rig, NECK, 45, 2000);
                assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
            }
            rig_run(&rig, ms * 1000);
            int number = grobo_robot_exit(&rig.robot, GROBO_EXIT_OFF);
            double before_deg = 0;
            while (rig_torque(&rig, NECK) == GROBO_TORQUE_ON) {
                before_deg = rig_angle_deg(&rig, NECK);
                rig_run(&rig, 2000);
            }
            assert_true(fabs(rig_angle_deg(&rig, NECK) - before_deg) < 0.01);
            rig_expect(&rig, number, GROBO_OK);
        }
    }
}

TEST_WITH(rig_wirings, what_is_stopped_says_that_it_was_canceled)
{
    rig_start_at(&rig, 0, &quiet);
    grobo_posture target = rig_posture(&rig, NECK, 40, 2000);
    for (int at_once = 0; at_once < 2; at_once++) {
        int number = grobo_robot_move(&rig.robot, &target);
        rig_run(&rig, 800000);
        assert_int_equal(grobo_robot_stop(&rig.robot, at_once), GROBO_OK);
        rig_expect(&rig, number, GROBO_ERR_CANCELED);
        rig_run(&rig, 500000);
        rig_clip_init(&clip, rise, 3);
        number = grobo_robot_play(&rig.robot, &clip.clip, NULL);
        rig_run(&rig, 50000); /* it still reads the joints */
        assert_int_equal(grobo_robot_stop(&rig.robot, at_once), GROBO_OK);
        rig_expect(&rig, number, GROBO_ERR_CANCELED);
        rig_run(&rig, 500000);
        assert_int_equal(grobo_robot_stop(&rig.robot, at_once), GROBO_ERR_STATE);
        assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_ERR_STATE);
    }
}

/* The stop itself counts as asked for when it was asked for, between the engine's own times. */
TEST_WITH(rig_wirings, a_stop_is_dated_by_its_call)
{
    rig_start_at(&rig, 0, &quiet);
    rig_run(&rig, 500000);
    rig.now_us += 3210;
    assert_true(grobo_robot_estop(&rig.robot) > 0);
    grobo_trip_info trip;
    grobo_robot_tripped(&rig.robot, &trip);
    assert_true(trip.at_us == rig.now_us);
    assert_int_equal(trip.joint, -1);
    assert_true(trip.value == 0);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->trips, 1);
}

/* Whoever asks for it need not come back: the frame is there. */
TEST_WITH(rig_wirings, the_frame_that_stops_is_there_at_once)
{
    uint8_t buf[GROBO_RS30X_PACKET_MAX_BYTES];
    rig_start_at(&rig, 0, &quiet);
    grobo_posture target = rig_posture(&rig, NECK, 40, 2000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 500000);
    assert_true(grobo_robot_estop(&rig.robot) > 0);
    rig_frame first = {0};
    int n = grobo_robot_tx(&rig.robot, buf, sizeof buf, rig.now_us);
    assert_true(n > 0);
    first.size = (uint8_t)n;
    memcpy(first.bytes, buf, (size_t)n);
    const uint8_t *packet;
    (void)rig_packet(&first, &packet);
    assert_int_equal(packet[4], GROBO_RS30X_TORQUE);
}

/* A servo that could not go where it was sent is where it was read, not at its goal. */
TEST_WITH(rig_wirings, a_move_begins_where_the_joint_is)
{
    rig_start_at(&rig, 0, &quiet);
    assert_int_equal(grobo_sim_set_blocked(&rig.sim, NECK, true), 0);
    grobo_posture target = rig_posture(&rig, NECK, 40, 500);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 2000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK)) < 1);
    assert_int_equal(grobo_sim_set_blocked(&rig.sim, NECK, false), 0);
    rig_forget(&rig);
    target = rig_posture(&rig, NECK, 40, 10);
    (void)rig_wait(&rig, grobo_robot_move(&rig.robot, &target));
    double asked_deg = fabs(rig_angle_deg(&rig, NECK));
    assert_true(asked_deg > 39);
    assert_in_range(rig_sent_ms(&rig, NECK_ID), 100, 120); /* 40 deg at 375 deg/s */
}

/* Leaving is bounded from when it was asked for, too. */
TEST_WITH(rig_wirings, leaving_is_bounded_by_its_call)
{
    grobo_robot_config config = quiet;
    config.exit_bound_us = 100000;
    rig_start_at(&rig, 0, &config);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(grobo_sim_set_cable(&rig.sim, j, GROBO_SIM_CABLE_MUTE), 0);
    }
    rig_run(&rig, 500000);
    int64_t late_us = rig.now_us;
    rig.now_us += 70000;
    int number = grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD);
    const grobo_event_job *job = rig_expect(&rig, number, GROBO_ERR_TIMEOUT);
    assert_int_equal(job->number, number);
    assert_in_range(rig_last(&rig, GROBO_EVENT_JOB)->now_us - late_us, 170000, 170000);
}

/* Another program has stopped the robot while this one had it sit down: it does not, whatever was
 * on the way to be sent. */
TEST_WITH(rig_wirings, nobody_sits_down_after_an_emergency_stop)
{
    bool sits = false;
    for (int ms = 0; !sits; ms += 2) {
        rig_start_at(&rig, -30, &quiet);
        int number = grobo_robot_exit(&rig.robot, GROBO_EXIT_SIT);
        rig_run(&rig, ms * 1000);
        sits = goals_sent() > 0;
        assert_int_equal(grobo_robot_latch(&rig.robot), GROBO_OK);
        rig_forget(&rig);
        const grobo_event_job *job = rig_wait(&rig, number);
        assert_true(sits || job->result == GROBO_ERR_LATCHED);
        assert_int_equal(goals_sent(), 0);
    }
}

static bool broken;
static int (*sound_key)(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us);

static int key_that_breaks(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    return broken ? GROBO_ERR_EMPTY : sound_key(ctx, i, posture, at_us);
}

/* The key that was sent last may be seconds away: nobody would stop it any more. */
TEST_WITH(rig_wirings, a_clip_that_breaks_under_a_command_stops_the_robot)
{
    rig_start_at(&rig, -45, &quiet);
    rig_clip_init(&clip, rise, 3);
    clip.only = GROBO_JOINT_BIT(NECK);
    sound_key = clip.clip.key;
    clip.clip.key = key_that_breaks;
    broken = false;
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 500000);
    broken = true;
    assert_int_equal(grobo_robot_seek(&rig.robot, 100000), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_FAILED);
    rig_run(&rig, 200000);
    double here_deg = rig_angle_deg(&rig, NECK);
    assert_true(here_deg < -15);
    rig_run(&rig, 2000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
    /* A command that finds nothing to play stops nothing. */
    grobo_posture target = rig_posture(&rig, NECK, 30, 1000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 300000);
    assert_int_equal(grobo_robot_seek(&rig.robot, 100000), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_pause(&rig.robot), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_resume(&rig.robot), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_speed(&rig.robot, 50), GROBO_ERR_STATE);
    rig_run(&rig, 2000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 30) < 0.1);
}

static int (*sound_sample)(void *ctx, int64_t t_us, grobo_posture *posture);

static int sample_that_breaks(void *ctx, int64_t t_us, grobo_posture *posture)
{
    return broken ? GROBO_ERR_EMPTY : sound_sample(ctx, t_us, posture);
}

/* More frames than the line carries: one of them waits whenever it is, and never leaves. */
TEST_WITH(rig_wirings, nothing_of_a_broken_clip_leaves_any_more)
{
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                        .rate_hz = 150, .unwatched = true};
    for (int ms = 0; ms < 40; ms++) {
        rig_start_at(&rig, -45, &quiet);
        rig_clip_init(&clip, rise, 3);
        sound_sample = clip.clip.sample;
        clip.clip.sample = sample_that_breaks;
        broken = false;
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, 300000 + ms * 1000);
        broken = true;
        rig_wait_play(&rig, GROBO_SEQUENCER_FAILED);
        int64_t over_us = rig_last(&rig, GROBO_EVENT_PLAY)->now_us;
        rig_run(&rig, 500000);
        for (size_t i = 0; i < rig.n_sent; i++) {
            const uint8_t *p;
            size_t n = rig_packet(&rig.sent[i], &p);
            bool moves = n > 12 && p[2] == 0 && p[4] == GROBO_RS30X_GOAL;
            int time_ms = moves ? (p[10] | p[11] << 8) * 10 : 0;
            assert_false(moves && rig.sent[i].at_us > over_us && time_ms < 100);
        }
    }
}

/* A raw frame for all joints does not fit between those of the motion, readings do: it waits, and
 * ends with the reading that trips, not when its turn would come. */
TEST_WITH(rig_wirings, a_trip_ends_a_raw_job_that_waits_for_the_end_of_a_motion)
{
    const bool by_board = rig_wiring == GROBO_WIRING_BOARD;
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 100000};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                        .rate_hz = by_board ? 33 : 66, .repeat = 100,
                                        .unwatched = true};
    uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
    grobo_rs30x_goal goals[20];
    rig_start_at(&rig, -45, &config);
    rig_clip_init(&clip, rise, 3);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 500000);
    for (int j = 0; j < 20; j++) {
        goals[j] = (grobo_rs30x_goal){(uint8_t)(j + 1), 0, 500};
        int joint = grobo_model_joint_of_motor(rig.driver->model, j + 1);
        goals[j].pos_ddeg = (int16_t)lround(rig_angle_deg(&rig, joint) * 10);
    }
    int n = grobo_frame_goals(grobo_wiring_protocol(rig_wiring), goals, 20, frame, sizeof frame);
    assert_true(n > 0);
    int number = grobo_robot_raw(&rig.robot, frame, (size_t)n);
    assert_true(number > 0);
    rig_run(&rig, 300000);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_RAW);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, 75), 0);
    rig_expect(&rig, number, GROBO_ERR_LATCHED);
    assert_non_null(rig_last(&rig, GROBO_EVENT_TRIP));
    assert_true(rig_last(&rig, GROBO_EVENT_JOB)->now_us ==
                rig_last(&rig, GROBO_EVENT_TRIP)->now_us);
}

/* Its first attempt was lost, and before the second the joint was sent elsewhere: that stands. */
TEST_WITH(rig_wirings, a_raw_goal_is_not_tried_again_behind_a_later_target)
{
    for (int later = 0; later < 2; later++) {
        uint8_t packet[32];
        uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
        const uint8_t data[4] = {200, 0, 100, 0}; /* 20 degrees in 1 s */
        const grobo_rs30x_packet goal = {
            GROBO_RS30X_SHORT, NECK_ID, GROBO_RS30X_WANT_ACK, GROBO_RS30X_GOAL, 4, 1, data, 4};
        rig_start_at(&rig, 0, &quiet);
        int n = grobo_rs30x_build(&goal, packet, sizeof packet);
        n = grobo_frame_wrap(grobo_wiring_protocol(rig_wiring), packet, (size_t)n, frame,
                             sizeof frame);
        assert_true(n > 0);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
        int number = grobo_robot_raw(&rig.robot, frame, (size_t)n);
        assert_true(number > 0);
        rig_run(&rig, 5000); /* it is out, and nobody has it */
        assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
        if (later) {
            grobo_posture target = rig_posture(&rig, NECK, -10, 1000);
            assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        }
        rig_expect(&rig, number, later ? GROBO_ERR_SUPERSEDED : GROBO_OK);
        rig_run(&rig, 2000000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - (later ? -10 : 20)) < 0.1);
    }
}

/* ---- torque ---------------------------------------------------------------------------------- */

/* The host takes what came and lets time pass, but writes nothing. */
static void take_without_writing(int64_t us)
{
    uint8_t buf[64];
    size_t n;
    for (int64_t until_us = rig.now_us + us; rig.now_us < until_us; rig.now_us += 100) {
        while ((n = grobo_sim_tx(&rig.sim, buf, sizeof buf, rig.now_us)) > 0) {
            witness_arrived(&rig.witness, buf, n, rig.now_us);
            grobo_robot_rx(&rig.robot, buf, n, rig.now_us);
        }
        grobo_robot_step(&rig.robot, rig.now_us);
    }
}

/* A host stalls with the frame in its hands that switches torque on, and somebody turns the joint:
 * the frame is out of date. The rig fails where torque comes on away from the goal. */
TEST_WITH(rig_wirings, torque_that_waited_long_comes_on_for_nobody)
{
    int overtaken = 0;
    for (int ms = 1; ms < 400; ms += 3) {
        const grobo_sim_config jumps = {GROBO_SIM_CONFIG_INIT, .jump_on_torque = true};
        rig_start(&rig, &quiet, &jumps);
        int number = grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(NECK) | GROBO_JOINT_BIT(CHEST),
                                        GROBO_TORQUE_ON);
        assert_true(number > 0);
        rig_run(&rig, ms * 100);
        bool on_its_way = rig_torque(&rig, NECK) != GROBO_TORQUE_ON;
        take_without_writing(10000);
        if (on_its_way && rig_torque(&rig, NECK) != GROBO_TORQUE_ON) {
            assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 40000, 0), 0);
            overtaken++;
        }
        take_without_writing(2500000);
        (void)rig_wait(&rig, number);
    }
    assert_true(overtaken > 0);
}

/* ---- targets --------------------------------------------------------------------------------- */
