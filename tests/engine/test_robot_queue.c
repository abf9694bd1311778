/* SPDX-License-Identifier: MIT */
/* Requests that are made while others are carried out: side by side, in place of them, behind. */
#include <stdint.h>

#include <grobo/core/robot.h>

#include "src/robot/state.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;

static const grobo_joint_mask neck = GROBO_JOINT_BIT(NECK);
static const grobo_joint_mask elbow = GROBO_JOINT_BIT(R_ELBOW);

/* Torque is on, and the slow first moves are over. */
static void begin(void)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 1, 100);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    rig_forget(&rig);
}

static int move(int joint, double angle_deg, int time_ms)
{
    grobo_posture target = rig_posture(&rig, joint, angle_deg, time_ms);
    int number = grobo_robot_move(&rig.robot, &target);
    rig.asked = true;
    return number;
}

static int move_both(double angle_deg, int time_ms)
{
    grobo_posture target = rig_posture(&rig, NECK, angle_deg, time_ms);
    assert_int_equal(grobo_posture_set_deg(&target, R_ELBOW, -angle_deg), GROBO_OK);
    return grobo_robot_move(&rig.robot, &target);
}

/* The end of a job among the events so far, or NULL. */
static const grobo_event_job *end_of(int number)
{
    for (size_t i = 0; i < rig.n_events; i++) {
        const grobo_event *event = &rig.events[i];
        if (event->kind == GROBO_EVENT_JOB && event->u.job.number == number) {
            return &event->u.job;
        }
    }
    return NULL;
}

static void expect_at(int joint, double angle_deg)
{
    assert_in_range((int)(10 * (rig_angle_deg(&rig, joint) - angle_deg + 100)), 995, 1005);
}

TEST_WITH(rig_wirings, moves_of_different_joints_run_side_by_side)
{
    begin();
    int64_t begun_us = rig.now_us;
    int first = move(NECK, 30, 2000);
    int second = move(R_ELBOW, -30, 1000);
    assert_true(first > 0 && second > first);
    rig_expect(&rig, second, GROBO_OK);
    assert_null(end_of(first));
    assert_true(rig.now_us - begun_us < 1500000);
    expect_at(R_ELBOW, -30);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_MOVE);
    rig_expect(&rig, first, GROBO_OK);
    assert_true(rig.now_us - begun_us < 2500000);
    expect_at(NECK, 30);
}

TEST_WITH(rig_wirings, a_reading_runs_beside_a_move)
{
    begin();
    int moving = move(NECK, 30, 2000);
    rig_run(&rig, 500000);
    const grobo_event_job *read =
        rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_FULL), GROBO_OK);
    assert_int_equal(read->failed, 0);
    assert_null(end_of(moving));
    rig_expect(&rig, moving, GROBO_OK);
}

TEST_WITH(rig_wirings, a_move_takes_its_joint_from_the_one_before)
{
    for (int wait_ms = 0; wait_ms <= 900; wait_ms += 30) {
        begin();
        int both = move_both(30, 1000);
        rig_run(&rig, wait_ms * 1000);
        int one = move(NECK, -10, 600);
        assert_true(one > both);
        const grobo_event_job *left = rig_expect(&rig, both, GROBO_ERR_SUPERSEDED);
        assert_int_equal(left->failed, neck);
        rig_expect(&rig, one, GROBO_OK);
        rig_run(&rig, 1000000);
        expect_at(NECK, -10);
        expect_at(R_ELBOW, -30);
    }
}

/* The rig fails where a joint is told to be faster than it may, from where it is by then. */
TEST_WITH(rig_wirings, a_move_of_a_fast_joint_begins_where_it_is_when_the_frame_leaves)
{
    for (int step = 0; step < 40; step++) {
        begin();
        int away = move(NECK, 50, 10);
        rig_run(&rig, 60000);
        int back = move(NECK, -10 - step / 10.0, 10);
        assert_true(back > away);
        rig_expect(&rig, back, GROBO_OK);
        expect_at(NECK, -10 - step / 10.0);
    }
}

TEST_WITH(rig_wirings, a_move_that_has_no_joint_left_ends_at_once)
{
    for (int wait_ms = 0; wait_ms <= 900; wait_ms += 30) {
        begin();
        int first = move(NECK, 30, 1000);
        rig_run(&rig, wait_ms * 1000);
        int second = move(NECK, -10, 600);
        const grobo_event_job *left = end_of(first);
        assert_non_null(left);
        assert_int_equal(left->result, GROBO_ERR_SUPERSEDED);
        assert_int_equal(left->failed, neck);
        rig_expect(&rig, second, GROBO_OK);
        expect_at(NECK, -10);
    }
}

TEST_WITH(rig_wirings, moves_and_readings_wait_in_their_order)
{
    begin();
    int holding = grobo_robot_check(&rig.robot);
    int number[GROBO_ROBOT_QUEUE];
    for (int i = 0; i < GROBO_ROBOT_QUEUE; i++) {
        number[i] = i % 2 == 0 ? move(i == 0 ? NECK : R_ELBOW, 10 + i, 300 + i)
                               : grobo_robot_sense(&rig.robot, neck,
                                                   i == 1 ? GROBO_SENSE_ALL : GROBO_SENSE_GOAL);
        assert_true(number[i] > holding && (i == 0 || number[i] > number[i - 1]));
    }
    assert_int_equal(move(NECK, 5, 300), GROBO_ERR_FULL);
    assert_int_equal(grobo_robot_sense(&rig.robot, neck, GROBO_SENSE_FULL), GROBO_ERR_FULL);
    for (int i = 0; i < GROBO_ROBOT_QUEUE; i++) {
        assert_null(end_of(number[i]));
    }
    rig_expect(&rig, holding, GROBO_OK);
    for (int i = 0; i < GROBO_ROBOT_QUEUE; i++) {
        rig_expect(&rig, number[i], GROBO_OK);
    }
    expect_at(NECK, 10);
    expect_at(R_ELBOW, 12);
}

TEST_WITH(rig_wirings, nobody_waits_longer_than_two_seconds)
{
    begin();
    int64_t asked_us = rig.now_us;
    int holding = grobo_robot_command(&rig.robot, R_ELBOW_ID, GROBO_SERVO_REBOOT); /* for 2 s */
    int late = move(NECK, 30, 1000);
    assert_true(holding > 0 && late > holding);
    rig_run(&rig, GROBO_ROBOT_QUEUE_US - 1000);
    assert_null(end_of(late));
    const grobo_event_job *end = rig_expect(&rig, late, GROBO_ERR_STALE);
    assert_int_equal(end->failed, neck);
    assert_in_range(rig.now_us - asked_us, GROBO_ROBOT_QUEUE_US, GROBO_ROBOT_QUEUE_US + 1000);
    rig_expect(&rig, holding, GROBO_OK);
    expect_at(NECK, 1);
}

static int do_stop(void)
{
    return grobo_robot_stop(&rig.robot, false);
}

static int do_cancel(void)
{
    return grobo_robot_cancel(&rig.robot);
}

static int do_exit(void)
{
    return grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD);
}

static int do_estop(void)
{
    return grobo_robot_estop(&rig.robot);
}

static int do_link_down(void)
{
    grobo_robot_link_down(&rig.robot, rig.now_us);
    return GROBO_OK;
}

TEST_WITH(rig_wirings, what_waits_ends_with_what_ends_the_rest)
{
    static const struct {
        int (*end)(void);
        int result;
    } rows[] = {
        {do_stop, GROBO_ERR_CANCELED},       {do_cancel, GROBO_ERR_CANCELED},
        {do_exit, GROBO_ERR_CANCELED},       {do_estop, GROBO_ERR_CANCELED},
        {do_link_down, GROBO_ERR_UNPLUGGED},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        begin();
        double elbow_deg = rig_angle_deg(&rig, R_ELBOW);
        assert_true(grobo_robot_check(&rig.robot) > 0);
        int waits = move(NECK, 30, 1000);
        int behind = move(R_ELBOW, 30, 1200);
        assert_true(waits > 0 && behind > waits);
        assert_true(rows[i].end() >= 0);
        rig_run(&rig, 3000000);
        assert_int_equal(rig_wait(&rig, waits)->result, rows[i].result);
        assert_int_equal(rig_wait(&rig, behind)->result, rows[i].result);
        expect_at(NECK, 1);
        expect_at(R_ELBOW, elbow_deg);
    }
}

TEST_WITH(rig_wirings, a_trip_ends_what_waits)
{
    begin();
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, NECK, 75), 0);
    int sensing = grobo_robot_torque(&rig.robot, neck, GROBO_TORQUE_ON);
    int waits = move(NECK, 30, 1000);
    assert_true(sensing > 0 && waits > sensing);
    assert_int_equal(rig_wait(&rig, waits)->result, GROBO_ERR_LATCHED);
    expect_at(NECK, 1);
}

TEST_WITH(rig_wirings, torque_off_goes_before_a_move)
{
    for (int wait_ms = 0; wait_ms <= 900; wait_ms += 30) {
        begin();
        int both = move_both(30, 1000);
        rig_run(&rig, wait_ms * 1000);
        int64_t asked_us = rig.now_us;
        rig_expect(&rig, grobo_robot_torque(&rig.robot, elbow, GROBO_TORQUE_OFF), GROBO_OK);
        assert_true(rig.now_us - asked_us < 100000);
        assert_int_equal(rig_torque(&rig, R_ELBOW), GROBO_TORQUE_OFF);
        const grobo_event_job *left = rig_expect(&rig, both, GROBO_ERR_SUPERSEDED);
        assert_int_equal(left->failed, elbow);
        expect_at(NECK, 30);
        assert_int_equal(rig_torque(&rig, R_ELBOW), GROBO_TORQUE_OFF);
    }
}

TEST_WITH(rig_wirings, what_needs_a_joint_at_rest_is_refused_while_it_moves)
{
    begin();
    const grobo_register_io of_neck = {.id = NECK_ID, .address = 42, .length = 2};
    const grobo_register_io of_elbow = {.id = R_ELBOW_ID, .address = 42, .length = 2};
    assert_true(move(NECK, 30, 2000) > 0);
    rig_run(&rig, 500000);
    assert_int_equal(grobo_robot_torque(&rig.robot, neck | elbow, GROBO_TORQUE_ON),
                     GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_registers(&rig.robot, &of_neck), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_free(&rig.robot, neck, true), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_free(&rig.robot, elbow, true), GROBO_ERR_STATE);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, elbow, GROBO_TORQUE_ON), GROBO_OK);
    rig_expect(&rig, grobo_robot_registers(&rig.robot, &of_elbow), GROBO_OK);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_MOVE);
}

static const rig_key arm[] = {{0, {{R_ELBOW, 0}}}, {1500, {{R_ELBOW, 40}}}, {3000, {{R_ELBOW, 0}}}};

TEST_WITH(rig_wirings, the_head_turns_while_an_arm_plays)
{
    for (grobo_play_mode mode = GROBO_PLAY_KEY; mode <= GROBO_PLAY_RATE; mode++) {
        rig_clip clip;
        const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = mode};
        begin();
        rig_clip_init(&clip, arm, 3);
        clip.only = elbow;
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        assert_int_equal(move(R_ELBOW, 10, 500), GROBO_ERR_STATE);
        assert_int_equal(move_both(10, 500), GROBO_ERR_STATE);
        int turning = move(NECK, 30, 1000);
        assert_true(turning > 0);
        clip.only = neck;
        assert_int_equal(grobo_robot_enqueue(&rig.robot, &clip.clip, &options), GROBO_ERR_STATE);
        clip.only = elbow;
        rig_expect(&rig, turning, GROBO_OK);
        assert_true(grobo_robot_is_playing(&rig.robot));
        expect_at(NECK, 30);
        rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
        rig_run(&rig, 1000000);
        expect_at(NECK, 30);
        expect_at(R_ELBOW, 0);
        grobo_robot_counters counters = *grobo_robot_get_counters(&rig.robot);
        assert_int_equal(counters.late_frames, 0);
    }
}

/* As many as there is room for; the last place is kept for taking torque away. */
TEST_WITH(rig_wirings, torque_off_finds_room)
{
    begin();
    static const int joints[GROBO_ROBOT_JOBS] = {CHEST, NECK, SHOULDER, R_ELBOW};
    int number[GROBO_ROBOT_JOBS];
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        number[i] = move(joints[i], joints[i] == R_ELBOW ? -30 : -5, 2000);
        assert_true(number[i] > 0);
        rig_run(&rig, 125000); /* asked for at once it would join the one before */
    }
    grobo_joint_mask last = GROBO_JOINT_BIT(CHEST);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, last, GROBO_TORQUE_OFF), GROBO_OK);
    assert_int_equal(rig_torque(&rig, CHEST), GROBO_TORQUE_OFF);
    assert_int_equal(rig_wait(&rig, number[GROBO_ROBOT_JOBS - 1])->result, GROBO_ERR_CANCELED);
    assert_int_equal(rig_wait(&rig, number[0])->result, GROBO_ERR_SUPERSEDED);
    rig_expect(&rig, number[1], GROBO_OK);
}

/* ---- asked for as a job before ends ---------------------------------------------------------- */

static int awaited, canceled, runs, redirected;

static void ask_as_it_ends(grobo_test_rig *r, const grobo_event *event)
{
    if (event->kind == GROBO_EVENT_JOB && event->u.job.number == awaited) {
        grobo_posture target = rig_posture(r, R_ELBOW, -20, 500);
        runs = grobo_robot_job(&r->robot);
        redirected = grobo_robot_retarget(&r->robot, &target);
        canceled = grobo_robot_cancel(&r->robot);
    }
}

/* The callback is called before the place of what has ended is another's. */
TEST_WITH(rig_wirings, a_callback_stops_what_runs_beside_what_has_ended)
{
    begin();
    awaited = move(NECK, 10, 300);
    int other = move(R_ELBOW, -60, 4000);
    rig.on_event = ask_as_it_ends;
    rig_expect(&rig, awaited, GROBO_OK);
    rig.on_event = NULL;
    assert_int_equal(runs, GROBO_JOB_MOVE);
    assert_int_equal(redirected, other);
    assert_int_equal(canceled, GROBO_OK);
    rig_expect(&rig, other, GROBO_ERR_CANCELED);
}

/* One ends where its frame would leave: nobody was told of it yet. */
TEST_WITH(rig_wirings, a_refused_frame_hides_no_job)
{
    begin();
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    const grobo_rs30x_goal goal = {NECK_ID, 100, 100};
    int n = grobo_frame_goal(rig.driver->protocol, &goal, frame, sizeof frame);
    rig.robot.bus.free_us = rig.now_us + 20000; /* the line is taken */
    assert_true(grobo_robot_raw(&rig.robot, frame, (size_t)n) > 0);
    int moving = move(R_ELBOW, -60, 4000);
    rig.robot.axes[NECK].phase =
        GROBO_I_JOINT_EXTERNAL; /* it was read to be moved by somebody else */
    rig.now_us += 20000;
    (void)grobo_robot_tx(&rig.robot, frame, sizeof frame, rig.now_us);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_MOVE);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
    rig_expect(&rig, moving, GROBO_ERR_CANCELED);
}
