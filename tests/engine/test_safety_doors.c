/* SPDX-License-Identifier: MIT */
/* Doors to a motor beside the targets, and what is known of joints that others may have moved. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip, other;

static int raw(const char *bytes, size_t size)
{
    return grobo_robot_raw(&rig.robot, (const uint8_t *)bytes, size);
}

static void move_to(int joint, double deg)
{
    grobo_posture target = rig_posture(&rig, joint, deg, 100);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
}

/* ---- soft first move ------------------------------------------------------------------------- */

TEST(a_joint_that_a_hand_may_have_moved_begins_softly)
{
    rig_start(&rig, &quiet, NULL);
    move_to(NECK, 10);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(NECK), 0), 0);
    assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 40000, 0), 0);
    rig_forget(&rig);
    move_to(NECK, -20);
    assert_in_range(rig_sent_ms(&rig, NECK_ID), 990, 2000); /* 60 deg at 60 deg/s */
    rig_forget(&rig);
    move_to(NECK, 40); /* from there it is the servo's speed again */
    assert_in_range(rig_sent_ms(&rig, NECK_ID), 100, 300);
}

TEST(free_mode_is_left_softly)
{
    rig_start(&rig, &quiet, NULL);
    move_to(NECK, 10);
    assert_int_equal(grobo_robot_free(&rig.robot, rig_all(&rig), true), GROBO_OK);
    assert_int_equal(grobo_sim_set_load(&rig.sim, NECK, 200), 0);
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, 40000, 500000), 0);
    rig_run(&rig, 500000);
    assert_int_equal(grobo_sim_set_load(&rig.sim, NECK, 0), 0);
    rig_run(&rig, 2000000);
    rig_expect(&rig, grobo_robot_free(&rig.robot, rig_all(&rig), false), GROBO_OK);
    double way_deg = rig_angle_deg(&rig, NECK) + 20;
    rig_forget(&rig);
    move_to(NECK, -20);
    assert_true(rig_sent_ms(&rig, NECK_ID) >= way_deg / 60 * 1000 - 10);
}

/* A motion of the board's own, or a frame that nobody can read, may have moved anything. */
TEST(after_targets_that_are_not_ours_joints_are_read_anew)
{
    grobo_robot_config config = quiet;
    config.accept_unknown_raw = true;
    for (int by_raw = 0; by_raw < 2; by_raw++) {
        rig_start(&rig, &config, NULL);
        rig_power(&rig);
        move_to(NECK, 10);
        rig_expect(&rig,
                   by_raw ? raw("\x50\x4D\x03", 3)
                          : grobo_robot_stored(&rig.robot, GROBO_STORED_SLOT, 3),
                   GROBO_OK);
        grobo_posture target = rig_posture(&rig, NECK, 12, 10);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STALE);
        rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), 0), GROBO_OK);
        move_to(NECK, -20);
        assert_in_range(rig_sent_ms(&rig, NECK_ID), 490, 600); /* 30 deg */
    }
}

/* Joints that nobody read or switched on would move in frames only. */
TEST(a_second_file_moves_what_was_made_ready)
{
    static const rig_key one[] = {{0, {{NECK, 0}}}, {500, {{NECK, 5}}}};
    rig_start(&rig, &quiet, NULL);
    rig_clip_init(&clip, one, 2);
    rig_clip_init(&other, one, 2);
    clip.only = GROBO_JOINT_BIT(NECK);
    other.only = GROBO_JOINT_BIT(R_KNEE);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &clip.clip, NULL), 1);
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &other.clip, NULL), GROBO_ERR_STATE);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .also = GROBO_JOINT_BIT(R_KNEE)};
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &other.clip, NULL), 1);
    assert_int_equal(rig_torque(&rig, R_KNEE), GROBO_TORQUE_ON);
    assert_int_equal(rig_torque(&rig, 0), GROBO_TORQUE_OFF);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
}

TEST(a_second_file_is_approached_as_slowly_as_the_first)
{
    static const rig_key near[] = {{0, {{NECK, 0}}}, {500, {{NECK, 5}}}};
    static const rig_key far[] = {{0, {{NECK, -45}}}, {500, {{NECK, -40}}}};
    grobo_robot_config config = quiet;
    config.approach_dps = 20;
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    rig_clip_init(&clip, near, 2);
    rig_clip_init(&other, far, 2);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &other.clip, NULL), 1);
    int64_t begun_us = rig.now_us;
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    assert_true(rig.now_us - begun_us > 2500000); /* 50 deg at 20 deg/s, and what is played */
}

/* ---- raw frames ------------------------------------------------------------------------------ */

/* What moves, but is no joint of the model, has no limits to be held against. */
TEST(raw_frames_reach_known_motors_only)
{
    static const struct {
        const char *bytes;
        size_t size;
    } refused[] = {
        {"\x53\x0C\xFA\xAF\x15\x00\x1E\x04\x01\x64\x00\x64\x00\x0E", 14}, /* goal of motor 21 */
        {"\x53\x09\xFA\xAF\x15\x00\x24\x01\x01\x01\x30", 11},             /* its torque on */
        {"\x53\x12\xFA\xAF\x00\x00\x1E\x05\x02\x02\x64\x00\x64\x00\x15\x64\x00\x64\x00\x0E", 20},
        {"\x53\x09\xFA\xAF\x02\x00\x24\x01\x01\x03\x25", 11}, /* a torque that there is not */
        {"\x53\x08\xFA\xAF\x02\x20\xFF\x00\x00\xDD", 10},     /* reboot, flash, factory reset */
        {"\x53\x08\xFA\xAF\x02\x40\xFF\x00\x00\xBD", 10},
        {"\x53\x08\xFA\xAF\x02\x10\xFF\x00\x00\xED", 10},
        {"\x53\x09\xFA\xAF\x02\x00\x04\x01\x01\x15\x13", 11},     /* id 21 */
        {"\x53\x09\xFA\xAF\x02\x00\x05\x01\x01\x01\x06", 11},     /* reverse */
        {"\x53\x0A\xFA\xAF\x02\x00\x08\x02\x01\xDC\x05\xD0", 12}, /* limit 1500 */
    };
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    rig_forget(&rig);
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        uint8_t sum = 0;
        for (size_t k = 4; k < refused[i].size; k++) { /* the frame is what it is meant to be */
            sum ^= (uint8_t)refused[i].bytes[k];
        }
        assert_int_equal(sum, 0);
        assert_int_equal(raw(refused[i].bytes, refused[i].size), GROBO_ERR_UNSUPPORTED);
    }
    assert_int_equal(rig.n_sent, 0);
}

/* The first from a sensed posture is soft; then it is the servo's speed. */
TEST(raw_targets_behind_the_first_may_be_fast)
{
    /* Motor 2 to 10.0 degrees in 200 ms, to 30.0 in 60 ms, in 50 ms. */
    const char *first = "\x53\x0C\xFA\xAF\x02\x00\x1E\x04\x01\x64\x00\x14\x00\x69";
    const char *fast = "\x53\x0C\xFA\xAF\x02\x00\x1E\x04\x01\x2C\x01\x06\x00\x32";
    const char *faster = "\x53\x0C\xFA\xAF\x02\x00\x1E\x04\x01\x2C\x01\x05\x00\x31";
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    assert_int_equal(raw(fast, 14), GROBO_ERR_SPEED);
    rig_expect(&rig, raw(first, 14), GROBO_OK);
    assert_int_equal(raw(fast, 14), GROBO_ERR_SPEED);
    rig_run(&rig, 200000);
    assert_int_equal(raw(faster, 14), GROBO_ERR_SPEED);
    rig_expect(&rig, raw(fast, 14), GROBO_OK);
    rig_run(&rig, 100000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 30) < 0.1);
}

TEST(an_unknown_frame_is_not_sent_while_latched)
{
    grobo_robot_config config = quiet;
    config.accept_unknown_raw = true;
    rig_start(&rig, &config, NULL);
    rig_expect(&rig, grobo_robot_estop(&rig.robot), GROBO_OK);
    assert_int_equal(raw("\x50\x4D\x01", 3), GROBO_ERR_LATCHED);
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
    rig_expect(&rig, raw("\x50\x4D\x01", 3), GROBO_OK);
}

TEST(a_raw_target_that_never_left_is_not_where_a_joint_is)
{
    rig_start(&rig, &quiet, NULL);
    move_to(NECK, -40);
    const char *goal = "\x53\x0C\xFA\xAF\x02\x00\x1E\x04\x01\x90\x01\xF4\x01\x7D"; /* 40, 5 s */
    rig_forget(&rig);
    assert_true(raw(goal, 14) > 0);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
    rig_run(&rig, 6000000);
    assert_false(rig_packet_was_sent(&rig, goal + 2, 12));
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 40) < 0.1);
    grobo_posture target = rig_posture(&rig, NECK, 40, 10);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 20000);
    assert_in_range(rig_sent_ms(&rig, NECK_ID), 200, 400); /* 80 deg at 375 deg/s */
}

TEST(torque_switched_off_by_a_raw_frame_is_no_loss)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 200000};
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    rig_expect(&rig, raw("\x53\x09\xFA\xAF\x02\x00\x24\x01\x01\x00\x26", 11), GROBO_OK);
    rig_run(&rig, 1000000);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_OFF);
    assert_null(rig_last(&rig, GROBO_EVENT_TRIP));
    grobo_posture target = rig_posture(&rig, NECK, 10, 500);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STATE);
}

/* ---- what the caller gets wrong ------------------------------------------------------------- */

TEST(raw_reads_of_any_register_pass)
{
    rig_start(&rig, &quiet, NULL);
    for (uint8_t at = 0; at < 54; at++) {
        uint8_t frame[16];
        int n = grobo_frame_read(&grobo_i_board_protocol, NECK_ID, at, 1, frame, sizeof frame);
        rig_expect(&rig, grobo_robot_raw(&rig.robot, frame, (size_t)n), GROBO_OK);
    }
}

TEST(joints_that_there_are_not_are_refused)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 10, 500);
    target.set |= GROBO_JOINT_BIT(25);
    assert_int_equal(grobo_robot_move(&rig.robot, &target), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_ARG);
}

/* ---- settings of servos ---------------------------------------------------------------------- */

/* A servo that holds would jump to the new limit, or to the mirror of its goal. */
TEST(settings_that_move_a_holding_servo_are_refused)
{
    static const uint8_t data[2] = {1, 0};
    static const uint8_t addresses[] = {GROBO_RS30X_ID, GROBO_RS30X_REVERSE, GROBO_RS30X_CW_LIMIT,
                                        GROBO_RS30X_CCW_LIMIT};
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    for (size_t i = 0; i < sizeof addresses; i++) {
        grobo_register_io io = {NECK_ID, addresses[i], addresses[i] < 8 ? 1 : 2, data};
        assert_int_equal(grobo_robot_registers(&rig.robot, &io), GROBO_ERR_STATE);
    }
    rig_expect(&rig, grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_OFF), GROBO_OK);
    grobo_register_io io = {NECK_ID, GROBO_RS30X_REVERSE, 1, data};
    rig_expect(&rig, grobo_robot_registers(&rig.robot, &io), GROBO_OK);
    /* What is known of it is from before: nothing moves it unread. */
    grobo_posture target = rig_posture(&rig, NECK, 10, 500);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_STALE);
}

TEST(flash_has_the_silence_it_needs)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    rig_start(&rig, &config, NULL);
    rig_run(&rig, 100000);
    int number = grobo_robot_command(&rig.robot, NECK_ID, GROBO_SERVO_FLASH);
    assert_true(number > 0);
    rig_run(&rig, 60000); /* what was under way is over, and the command is sent */
    rig_forget(&rig);
    rig_run(&rig, 1000000);
    assert_int_equal(rig.n_sent, 0);
    rig_expect(&rig, number, GROBO_OK);
    rig_run(&rig, 100000);
    assert_true(rig.n_sent > 0);
}

TEST(a_servo_is_not_restarted_under_a_motion)
{
    static const rig_key sway[] = {{0, {{NECK, 0}}}, {1000, {{NECK, 30}}}, {3000, {{NECK, -30}}}};
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    rig_clip_init(&clip, sway, 3);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    for (int c = GROBO_SERVO_FLASH; c <= GROBO_SERVO_FACTORY_RESET; c++) {
        assert_int_equal(grobo_robot_command(&rig.robot, NECK_ID, (grobo_servo_command)c),
                         GROBO_ERR_STATE);
    }
}

/* ---- ends ------------------------------------------------------------------------------------ */

/* A joint that sags beyond its limit is stopped like any other. */
TEST(a_joint_outside_its_limits_can_be_stopped)
{
    rig_start_narrow(&rig);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_register(&rig.sim, NECK, GROBO_RS30X_GOAL, 225), 0);
    rig_run(&rig, 1000000);
    grobo_posture target = rig_posture(&rig, NECK, 10, 20000);
    assert_int_equal(grobo_posture_set_deg(&target, R_KNEE, -100), 0);
    int number = grobo_robot_move(&rig.robot, &target);
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
    rig_expect(&rig, number, GROBO_ERR_CANCELED);
    rig_run(&rig, 500000);
    double knee_deg = rig_angle_deg(&rig, R_KNEE);
    rig_run(&rig, 2000000);
    assert_true(fabs(rig_angle_deg(&rig, R_KNEE) - knee_deg) < 0.01);
}

/* Whatever moves it: a target that was sent and let go, or a raw one. */
TEST(leaving_stops_what_was_only_sent)
{
    for (int by_raw = 0; by_raw < 2; by_raw++) {
        rig_start(&rig, &quiet, NULL);
        rig_power(&rig);
        grobo_posture target = rig_posture(&rig, NECK, 40, 30000);
        if (by_raw) { /* 40 deg in 30 s */
            rig_expect(&rig, raw("\x53\x0C\xFA\xAF\x02\x00\x1E\x04\x01\x90\x01\xB8\x0B\x3B", 14),
                       GROBO_OK);
        } else {
            assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        }
        rig_run(&rig, 3000000);
        int64_t asked_us = rig.now_us;
        rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD), GROBO_OK);
        assert_true(rig.now_us - asked_us < 2000000);
        double here_deg = rig_angle_deg(&rig, NECK);
        assert_true(here_deg > 2 && here_deg < 6);
        rig_run(&rig, 2000000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
        rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_OFF), GROBO_OK);
        assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_OFF);
    }
}

/* What a killed program left: a fresh engine knows of no move, but the servos do. */
TEST(leaving_stops_what_another_program_set_going)
{
    for (int slow = 0; slow < 2; slow++) {
        rig_start(&rig, &quiet, NULL);
        rig_power(&rig);
        grobo_posture target = rig_posture(&rig, NECK, slow ? 20 : 45, slow ? 60000 : 5000);
        (void)grobo_robot_move(&rig.robot, &target);
        rig_run(&rig, 2000000);
        grobo_event_fn on_event = rig.robot.on_event;
        assert_int_equal(grobo_robot_init(&rig.robot, rig.driver, NULL, &quiet, rig.now_us), 0);
        rig_host(&rig);
        grobo_robot_on_event(&rig.robot, on_event, &rig);
        grobo_robot_link_up(&rig.robot, rig.now_us);
        rig_forget(&rig);
        rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD), GROBO_OK);
        double here_deg = rig_angle_deg(&rig, NECK);
        rig_run(&rig, 3000000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
        assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
    }
}

TEST(leaving_stops_though_the_first_frame_is_lost)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 45, 20000);
    (void)grobo_robot_move(&rig.robot, &target);
    rig_run(&rig, 2000000);
    int number = grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 30000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_expect(&rig, number, GROBO_OK);
    double here_deg = rig_angle_deg(&rig, NECK);
    assert_true(here_deg < 10);
    rig_run(&rig, 3000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
}

/* Heat, and whatever else latches, stops what was only sent too. */
TEST(a_trip_stops_what_was_only_sent)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 200000};
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 40, 30000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 3000000);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, 67), 0);
    rig_run(&rig, 1000000);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_TRIP), 1);
    double here_deg = rig_angle_deg(&rig, NECK);
    rig_run(&rig, 2000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
}

TEST(lost_replies_stop_what_was_only_sent)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 200000};
    rig_start(&rig, &config, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), 0);
    for (int i = 0; i < 200 && rig_last(&rig, GROBO_EVENT_TRIP) == NULL; i++) {
        grobo_posture target = rig_posture(&rig, NECK, 30 * sin(i * 0.1), 50);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 50000);
    }
    const grobo_event *event = rig_last(&rig, GROBO_EVENT_TRIP);
    assert_non_null(event);
    assert_int_equal(event->u.trip.trip, GROBO_TRIP_LOST_REPLIES);
}
