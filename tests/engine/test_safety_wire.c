/* SPDX-License-Identifier: MIT */
/* A frame is judged and noted at the moment it leaves, whatever its origin: not when it was asked
 * for. The rig fails where a goal is too fast or torque comes on away from its goal. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/raw_frames.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip;

/* ---- a line that is full --------------------------------------------------------------------- */

/* Stays, then turns the neck at 20 deg/s. */
static const rig_key waits_then_turns[] = {
    {0, {{NECK, 0}}}, {1500, {{NECK, 0}}}, {4000, {{NECK, -50}}}};

/* Plays at a rate at which there is no room on the line beside the frames. */
static void play_on_full_line(const grobo_robot_config *config)
{
    const grobo_play_options full = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                     .rate_hz = rig_wiring == GROBO_WIRING_BOARD ? 50 : 100,
                                     .unwatched = true};
    rig_start(&rig, config, NULL);
    rig_clip_init(&clip, waits_then_turns, 3);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &full), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 500000);
    rig_forget(&rig);
}

TEST_WITH(rig_wirings, a_raw_goal_that_waits_is_judged_when_it_leaves)
{
    play_on_full_line(&quiet);
    grobo_jitter jitter;
    int number = raw_goal(&rig, NECK, 40, 200); /* 200 deg/s from where it is now */
    assert_true(number > 0);
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_RAW);
    rig_expect(&rig, number, GROBO_ERR_SPEED); /* 450 deg/s when the line is free */
    assert_int_equal(raw_times_sent(&rig), 0);
    grobo_robot_jitter(&rig.robot, &jitter);
    assert_true(jitter.max_us < 2000); /* and no played frame had to wait for it */
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 50) < 0.2);
}

TEST_WITH(rig_wirings, a_raw_goal_that_nobody_waits_for_does_not_leave)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    const grobo_rs30x_goal goal = {NECK_ID, 0, 200};
    play_on_full_line(&quiet);
    int n = grobo_frame_goal(rig.driver->protocol, &goal, frame, sizeof frame);
    int64_t until_us = rig.now_us + 1000000;
    int number = grobo_robot_raw_until(&rig.robot, frame, (size_t)n, until_us);
    rig_expect(&rig, number, GROBO_ERR_STALE);
    assert_in_range(rig.now_us, until_us, until_us + 2000);
    rig_run(&rig, 6000000);
    assert_int_equal(rig_sent_ms(&rig, NECK_ID), -1);
    assert_int_equal(grobo_robot_raw_until(&rig.robot, frame, (size_t)n, rig.now_us - 1),
                     GROBO_ERR_STALE);
    rig_expect(&rig, grobo_robot_raw_until(&rig.robot, frame, (size_t)n, rig.now_us + 1), GROBO_OK);
}

TEST_WITH(rig_wirings, a_raw_goal_that_is_slow_enough_leaves_late)
{
    play_on_full_line(&quiet);
    rig_expect(&rig, raw_goal(&rig, NECK, 40, 400), GROBO_OK);
    assert_int_equal(raw_times_sent(&rig), 1);
    rig_run(&rig, 500000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 40) < 0.2);
}

/* ---- stops ----------------------------------------------------------------------------------- */

static void ask_stop(void)
{
    assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
}

static void ask_stop_at_once(void)
{
    assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
}

static void ask_cancel(void)
{
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
}

static void ask_estop(void)
{
    assert_true(grobo_robot_estop(&rig.robot) > 0);
}

static void ask_exit(void)
{
    assert_true(grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD) > 0);
}

static void lose_line(void)
{
    grobo_sim_plug(&rig.sim, false, rig.now_us);
}

static const struct {
    void (*ask)(void);
    int result;
} stops[] = {{ask_stop, GROBO_ERR_CANCELED},   {ask_stop_at_once, GROBO_ERR_CANCELED},
             {ask_cancel, GROBO_ERR_CANCELED}, {ask_estop, GROBO_ERR_CANCELED},
             {ask_exit, GROBO_ERR_CANCELED},   {lose_line, GROBO_ERR_UNPLUGGED}};

/* Whatever would move a joint and has not left by a stop never does; its job is told. */
TEST_WITH(rig_wirings, a_stop_cancels_a_raw_goal_that_waits)
{
    for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i++) {
        play_on_full_line(&quiet);
        int number = raw_goal(&rig, R_ELBOW, 10, 2000);
        rig_run(&rig, 1000000);
        assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_RAW);
        stops[i].ask();
        rig_expect(&rig, number, stops[i].result);
        rig_run(&rig, 8000000);
        assert_int_equal(raw_times_sent(&rig), 0);
    }
}

/* It has left, and no motion that is being played drives this joint: the stop does. */
TEST_WITH(rig_wirings, a_stop_halts_what_a_raw_goal_moves_beside_a_motion)
{
    const grobo_play_options slow = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                     .rate_hz = 10};
    rig_start(&rig, &quiet, NULL);
    rig_clip_init(&clip, waits_then_turns, 3);
    clip.only = GROBO_JOINT_BIT(NECK);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &slow), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_expect(&rig, raw_goal(&rig, SHOULDER, 60, 6000), GROBO_OK);
    rig_run(&rig, 1000000);
    ask_stop();
    rig_run(&rig, 200000);
    double here_deg = rig_angle_deg(&rig, SHOULDER);
    assert_true(here_deg > 22 && here_deg < 32);
    rig_run(&rig, 6000000);
    assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - here_deg) < 0.1);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
}

/* So it does with one that a target sent on its way before the motion began. */
TEST_WITH(rig_wirings, a_stop_halts_what_was_sent_before_a_motion)
{
    const grobo_play_options slow = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                     .rate_hz = 10};
    rig_start_at(&rig, 0, &quiet);
    rig_clip_init(&clip, waits_then_turns, 3);
    clip.only = GROBO_JOINT_BIT(NECK);
    grobo_posture target = rig_posture(&rig, SHOULDER, 60, 6000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &slow), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    ask_stop();
    rig_run(&rig, 300000);
    double here_deg = rig_angle_deg(&rig, SHOULDER);
    rig_run(&rig, 6000000);
    assert_true(fabs(rig_angle_deg(&rig, SHOULDER) - here_deg) < 0.1);
}

/* ---- free mode ------------------------------------------------------------------------------- */

static void refuse_send(void)
{
    grobo_posture target = rig_posture(&rig, SHOULDER, -60, 500);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STATE);
}

static void refuse_raw(void)
{
    assert_int_equal(raw_goal(&rig, SHOULDER, -60, 500), GROBO_ERR_STATE);
}

static void refuse_both(void)
{
    refuse_send();
    refuse_raw();
}

/* A hand pushes the shoulder until it gives way; after_us later somebody asks for a target. The rig
 * fails where torque comes on away from the goal. */
static void push_and_ask(int64_t after_us, void (*ask)(void))
{
    const grobo_sim_config jumps = {GROBO_SIM_CONFIG_INIT, .jump_on_torque = true};
    rig_start(&rig, NULL, &jumps);
    rig_power(&rig);
    assert_int_equal(grobo_robot_free(&rig.robot, rig_all(&rig), true), GROBO_OK);
    rig_run(&rig, 200000);
    assert_int_equal(grobo_sim_set_load(&rig.sim, SHOULDER, 900), 0);
    while (rig_torque(&rig, SHOULDER) != GROBO_TORQUE_BRAKE) {
        rig_run(&rig, 100);
    }
    assert_int_equal(grobo_sim_set_load(&rig.sim, SHOULDER, 0), 0);
    rig_run(&rig, after_us);
    ask();
    rig_run(&rig, 600000);
    assert_int_equal(rig_torque(&rig, SHOULDER), GROBO_TORQUE_ON); /* it holds again */
    assert_true(fabs(rig_angle_deg(&rig, SHOULDER)) < 60);
}

TEST_WITH(rig_wirings, a_joint_in_free_mode_takes_no_target)
{
    for (int64_t after_us = 0; after_us < 200000; after_us += 4900) {
        push_and_ask(after_us, refuse_both);
    }
}

TEST_WITH(rig_wirings, moving_a_joint_takes_it_out_of_free_mode)
{
    rig_start(&rig, NULL, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_robot_free(&rig.robot, rig_all(&rig), true), GROBO_OK);
    rig_run(&rig, 500000);
    refuse_send();
    grobo_posture target = rig_posture(&rig, SHOULDER, -20, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    target = rig_posture(&rig, SHOULDER, -25, 500);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    target = rig_posture(&rig, NECK, 5, 500);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STATE);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, SHOULDER) + 25) < 0.2);
}

/* ---- what is noted, and when ----------------------------------------------------------------- */

/* A frame after which joints are not where they were known to be. */
static int ask_stored(void)
{
    return grobo_robot_stored(&rig.robot, GROBO_STORED_SLOT, 3);
}

static int ask_unknown(void)
{
    return grobo_robot_raw(&rig.robot, (const uint8_t *)"\x50\x4D\x03", 3);
}

static int ask_raw_off(void)
{
    return raw_torque(&rig, NECK, GROBO_TORQUE_OFF);
}

static int ask_reboot(void)
{
    return raw_reboot(&rig, NECK);
}

static int ask_limit(void)
{
    return raw_cw_limit(&rig, NECK, 40);
}

static const struct {
    int (*ask)(void);
    bool limp;     /* the neck must be without torque */
    bool by_board; /* a board only has it */
    int result;    /* of a target afterwards */
} unsettling[] = {{ask_stored, false, true, GROBO_ERR_STALE},
                  {ask_unknown, false, true, GROBO_ERR_STALE},
                  {ask_raw_off, false, false, GROBO_ERR_STATE},
                  {ask_reboot, true, false, GROBO_ERR_STATE},
                  {ask_limit, true, false, GROBO_ERR_STALE}};

/* True if the frame has left; of a board's own motion there is no packet. */
static bool has_unsettled(bool by_board)
{
    bool left = !by_board && raw_times_sent(&rig) > 0;
    for (size_t i = 0; by_board && i < rig.n_sent; i++) {
        left = left || rig.sent[i].bytes[0] == 0x50;
    }
    return left;
}

static bool neck_is_being_read(void)
{
    const grobo_txn *active = rig.robot.bus.active;
    return active != NULL && active->reply.kind == GROBO_REPLY_RETURN &&
           active->reply.id == NECK_ID;
}

/* A reading that was under way when somebody asked is taken before the frame leaves: what it tells
 * of the joint is of no use afterwards. */
TEST_WITH(rig_wirings, what_is_unknown_is_noted_when_the_frame_leaves)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1,
                                       .accept_unknown_raw = true};
    for (size_t i = 0; i < sizeof unsettling / sizeof unsettling[0]; i++) {
        if (unsettling[i].by_board && rig_wiring != GROBO_WIRING_BOARD) {
            continue;
        }
        rig_start(&rig, &config, NULL);
        rig_power(&rig);
        grobo_posture target = rig_posture(&rig, NECK, 1, 500);
        if (unsettling[i].limp) {
            rig_expect(&rig, grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(NECK), 0), GROBO_OK);
        }
        while (!neck_is_being_read()) {
            rig_run(&rig, 100);
        }
        rig_forget(&rig);
        assert_true(unsettling[i].ask() > 0);
        while (!has_unsettled(unsettling[i].by_board)) {
            rig_run(&rig, 100);
        }
        assert_true(rig_count(&rig, GROBO_EVENT_JOINT) > 0);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), unsettling[i].result);
    }
}

/* Asked before the frame, answered after it, at the second attempt: it may be an answer to the
 * first, and of before. The reading after that one counts. */
TEST_WITH(rig_wirings, a_late_answer_restores_nothing)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    while (!neck_is_being_read()) {
        rig_run(&rig, 100);
    }
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    rig_forget(&rig);
    assert_true(ask_raw_off() > 0);
    while (raw_times_sent(&rig) == 0) {
        rig_run(&rig, 100);
    }
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_forget(&rig);
    const grobo_event *event = NULL;
    while (event == NULL || event->u.joint.joint != NECK) {
        rig_run(&rig, 100);
        event = rig_last(&rig, GROBO_EVENT_JOINT);
    }
    grobo_joint_info info;
    assert_int_equal(grobo_robot_joint(&rig.robot, NECK, &info), 0);
    assert_int_equal(event->u.joint.result, GROBO_OK);
    assert_false(info.torque_known);
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_robot_joint(&rig.robot, NECK, &info), 0);
    assert_true(info.torque_known);
}

TEST_WITH(rig_wirings, nothing_unknown_is_sent_under_a_motion)
{
    grobo_robot_config config = quiet;
    config.accept_unknown_raw = true;
    if (rig_wiring != GROBO_WIRING_BOARD) {
        return;
    }
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 40, 2000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    for (int i = 0; i < 2; i++) { /* it waits for the line; it is on its way */
        assert_int_equal(ask_stored(), GROBO_ERR_STATE);
        assert_int_equal(ask_unknown(), GROBO_ERR_STATE);
        rig_run(&rig, 1000000);
    }
    rig_run(&rig, 1500000);
    rig_expect(&rig, ask_stored(), GROBO_OK);
    /* Asked for while nothing moved, but a target goes first. */
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0), GROBO_OK);
    int number = ask_stored();
    target.angle_rad[NECK] = 0;
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_expect(&rig, number, GROBO_ERR_STATE);
}

/* Lets time pass until so long after the neck's torque was read. */
static void read_neck_and_wait(int64_t us)
{
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(NECK), 0), GROBO_OK);
    rig_run(&rig, rig_last(&rig, GROBO_EVENT_JOINT)->now_us + us - rig.now_us);
}

/* Somebody may have taken the joint's torque since it was read, and a hand may have turned it. */
TEST_WITH(rig_wirings, a_raw_frame_switches_on_what_was_read_just_now)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    read_neck_and_wait(2000000);
    rig_expect(&rig, raw_torque(&rig, NECK, GROBO_TORQUE_ON), GROBO_OK);
    assert_int_equal(raw_torque(&rig, NECK, GROBO_TORQUE_ON), GROBO_ERR_STALE);
    rig_expect(&rig, raw_torque(&rig, SHOULDER, GROBO_TORQUE_OFF), GROBO_OK); /* off is no risk */
    read_neck_and_wait(2000001);
    assert_int_equal(raw_torque(&rig, NECK, GROBO_TORQUE_ON), GROBO_ERR_STALE);
    read_neck_and_wait(1000000);
    int number = raw_torque(&rig, NECK, GROBO_TORQUE_ON);
    rig_stall(&rig, 1100000); /* it waits meanwhile */
    rig_expect(&rig, number, GROBO_ERR_STALE);
}

/* It is the first target of a stream: until it is reached, the next ones are slow, too. */
TEST_WITH(rig_wirings, a_raw_goal_begins_softly)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    rig_expect(&rig, raw_goal(&rig, NECK, 10, 1000), GROBO_OK);
    double here_deg = rig_angle_deg(&rig, SHOULDER);
    grobo_posture target = rig_posture(&rig, SHOULDER, here_deg + 20, 100);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 1200000);
        int time_ms = rig_sent_ms(&rig, rig.driver->model->joints[SHOULDER].motor);
        assert_in_range(time_ms, i == 0 ? 320 : 100, i == 0 ? 340 : 100);
        target.angle_rad[SHOULDER] = grobo_rad_from_deg(here_deg);
    }
}

/* It has not let go of the joints: one that is without torque afterwards has lost it. */
TEST_WITH(rig_wirings, after_what_is_unknown_torque_is_still_wanted)
{
    if (rig_wiring != GROBO_WIRING_BOARD) {
        return;
    }
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    rig_expect(&rig, ask_stored(), GROBO_OK);
    assert_int_equal(grobo_sim_set_register(&rig.sim, NECK, GROBO_RS30X_TORQUE, 0), 0);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0), GROBO_OK);
    assert_non_null(rig_last(&rig, GROBO_EVENT_TRIP));
    assert_int_equal(rig_last(&rig, GROBO_EVENT_TRIP)->u.trip.trip, GROBO_TRIP_TORQUE_LOST);
}

/* Another program has stopped the robot, and has the wire: nothing is sent, not to stop it either.
 * The rig fails where a goal leaves. */
TEST_WITH(rig_wirings, a_latched_robot_is_not_halted)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 40, 5000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_robot_latch(&rig.robot), GROBO_OK);
    ask_stop();
    rig_run(&rig, 1000000);
}

/* A motion that rests is still a motion: it goes on by itself. */
TEST_WITH(rig_wirings, nothing_unknown_is_sent_in_a_pause)
{
    grobo_robot_config config = quiet;
    config.accept_unknown_raw = true;
    rig_start(&rig, &config, NULL);
    rig_clip_init(&clip, waits_then_turns, 3);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    assert_int_equal(grobo_robot_pause(&rig.robot), GROBO_OK);
    rig_run(&rig, 1000000);
    assert_int_equal(raw_reboot(&rig, NECK), GROBO_ERR_STATE);
    if (rig_wiring == GROBO_WIRING_BOARD) {
        assert_int_equal(ask_stored(), GROBO_ERR_STATE);
        assert_int_equal(ask_unknown(), GROBO_ERR_STATE);
    }
    ask_stop();
    rig_run(&rig, 1000000);
    rig_expect(&rig, raw_reboot(&rig, NECK), GROBO_OK);
}

static bool was_read_since(size_t i)
{
    for (; i < rig.n_events; i++) {
        const grobo_event *event = &rig.events[i];
        if (event->kind == GROBO_EVENT_JOINT && event->u.joint.joint == SHOULDER) {
            return event->u.joint.result == GROBO_OK;
        }
    }
    return false;
}

/* A limit is written to the shoulder, which a hand pushed and which is about to hold again. */
static void write_limit(void)
{
    rig_forget(&rig);
    int number = raw_cw_limit(&rig, SHOULDER, 150);
    size_t sent = 0;
    size_t events = 0;
    unsigned on = rig.torque_on;
    for (int64_t end_us = rig.now_us + 200000; number > 0 && rig.now_us < end_us;) {
        rig_run(&rig, 100);
        if (raw_times_sent(&rig) != sent) { /* the servo has not heard it yet */
            sent = raw_times_sent(&rig);
            events = rig.n_events;
            on = rig.torque_on;
            assert_int_not_equal(rig_torque(&rig, SHOULDER), GROBO_TORQUE_ON);
        }
        if (sent > 0 && rig.torque_on > on) { /* not before its goal was read anew */
            assert_true(was_read_since(events));
        }
    }
}

TEST_WITH(rig_wirings, no_limit_is_written_to_a_joint_that_holds_again)
{
    for (int64_t after_us = 0; after_us < 200000; after_us += 2500) {
        push_and_ask(after_us, write_limit);
    }
}
