/* SPDX-License-Identifier: MIT */
/* What an engine asks of its host: the time, a wake-up, a lock, a word before a reset. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;

static struct {
    int held; /* how often the lock is taken now */
    int deepest;
    int taken; /* from outside */
    int wakes, wakes_held;
    int told, told_held; /* events, and those told with the lock */
    int asked;           /* before a reset */
    int may;
} host;

static void on_lock(void *ctx)
{
    assert_ptr_equal(ctx, &host);
    host.taken += host.held == 0;
    host.held++;
    host.deepest = host.held > host.deepest ? host.held : host.deepest;
}

static void on_unlock(void *ctx)
{
    assert_ptr_equal(ctx, &host);
    assert_true(host.held > 0);
    host.held--;
}

static void on_wake(void *ctx)
{
    assert_ptr_equal(ctx, &host);
    host.wakes++;
    host.wakes_held += host.held > 0;
}

static int64_t on_clock(void *ctx)
{
    assert_ptr_equal(ctx, &host);
    return rig.now_us;
}

static int on_reset(void *ctx)
{
    assert_ptr_equal(ctx, &host);
    host.asked++;
    return host.may;
}

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    (void)event;
    host.told++;
    host.told_held += host.held > 0;
}

static void begin(void)
{
    const grobo_robot_host how = {.clock = on_clock,
                                  .wake = on_wake,
                                  .may_reset = on_reset,
                                  .lock = on_lock,
                                  .unlock = on_unlock,
                                  .ctx = &host};
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    memset(&host, 0, sizeof host);
    grobo_robot_set_host(&rig.robot, &how);
    grobo_robot_on_event(&rig.robot, on_event, NULL);
}

/* The lock was taken, and is free again. */
static void expect_locked(void)
{
    assert_true(host.taken > 0);
    assert_int_equal(host.held, 0);
    host.taken = 0;
}

/* That, and the pump was woken once, without the lock, before anybody was told of anything. */
static void expect_request(int result)
{
    assert_true(result >= 0);
    expect_locked();
    assert_int_equal(host.wakes, 1);
    assert_int_equal(host.wakes_held, 0);
    assert_int_equal(host.told, 0);
    host.wakes = 0;
}

TEST_WITH(rig_wirings, a_request_holds_the_lock_and_wakes_the_pump)
{
    const grobo_register_io io = {.id = R_ELBOW_ID, .address = 42, .length = 2};
    begin();
    expect_request(grobo_robot_configure(&rig.robot, &rig.robot.config)); /* readings may be due */
    grobo_posture aim = rig_posture(&rig, NECK, 10, 500);
    expect_request(grobo_robot_send(&rig.robot, &aim));
    expect_request(grobo_robot_stop(&rig.robot, false));
    expect_request(grobo_robot_move(&rig.robot, &aim));
    expect_request(grobo_robot_sense(&rig.robot, 1, GROBO_SENSE_FULL));
    expect_request(grobo_robot_registers(&rig.robot, &io));
    expect_request(grobo_robot_torque(&rig.robot, 2, GROBO_TORQUE_OFF));
    host.told = 0;
    expect_request(grobo_robot_cancel(&rig.robot));
    expect_request(grobo_robot_check(&rig.robot));
    expect_request(grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD));
    expect_request(grobo_robot_estop(&rig.robot));
}

TEST_WITH(rig_wirings, a_question_holds_the_lock)
{
    grobo_joint_info info;
    grobo_posture posture;
    grobo_trip_info trip;
    grobo_play_progress progress;
    begin();
    (void)grobo_robot_joint(&rig.robot, NECK, &info);
    expect_locked();
    (void)grobo_robot_posture(&rig.robot, GROBO_NEVER_US, &posture);
    expect_locked();
    (void)grobo_robot_target(&rig.robot, &posture);
    expect_locked();
    (void)grobo_robot_moving(&rig.robot);
    expect_locked();
    (void)grobo_robot_settling(&rig.robot);
    expect_locked();
    (void)grobo_robot_job(&rig.robot);
    expect_locked();
    (void)grobo_robot_is_pending(&rig.robot, 1);
    expect_locked();
    grobo_robot_tripped(&rig.robot, &trip);
    expect_locked();
    (void)grobo_robot_fault(&rig.robot, NULL);
    expect_locked();
    (void)grobo_robot_play_state(&rig.robot);
    expect_locked();
    (void)grobo_robot_is_playing(&rig.robot);
    expect_locked();
    (void)grobo_robot_is_quiet(&rig.robot);
    expect_locked();
    grobo_robot_progress(&rig.robot, &progress);
    expect_locked();
    (void)grobo_robot_stops(&rig.robot, rig.now_us);
    expect_locked();
    (void)grobo_robot_deadline(&rig.robot, rig.now_us);
    expect_locked();
    assert_int_equal(host.wakes, 0);
}

TEST_WITH(rig_wirings, the_pump_holds_the_lock_but_not_while_it_tells)
{
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    begin();
    assert_true(grobo_robot_sense(&rig.robot, 1, GROBO_SENSE_FULL) > 0);
    host.taken = 0;
    assert_true(grobo_robot_tx(&rig.robot, bytes, sizeof bytes, rig.now_us) > 0);
    expect_locked();
    grobo_robot_rx(&rig.robot, bytes, 1, rig.now_us);
    expect_locked();
    assert_int_equal(host.told, 0);
    grobo_robot_link_down(&rig.robot, rig.now_us);
    expect_locked();
    assert_true(host.told >= 2); /* the line, and the job */
    grobo_robot_link_up(&rig.robot, rig.now_us);
    expect_locked();
    grobo_robot_step(&rig.robot, rig.now_us);
    expect_locked();
    assert_int_equal(host.told_held, 0);
    assert_true(host.deepest >= 1);
}

TEST_WITH(rig_wirings, a_reset_is_the_hosts_to_allow)
{
    begin();
    assert_int_equal(grobo_robot_latch(&rig.robot), GROBO_OK);
    grobo_trip_info trip;
    host.may = GROBO_ERR_PERM;
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_ERR_PERM);
    grobo_robot_tripped(&rig.robot, &trip);
    assert_true(trip.latched);
    host.may = GROBO_OK;
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
    grobo_robot_tripped(&rig.robot, &trip);
    assert_false(trip.latched);
    assert_int_equal(host.asked, 2);
}

/* The clock may stand behind the pump's last call: time does not go back. */
TEST_WITH(rig_wirings, time_is_the_clocks_but_never_goes_back)
{
    grobo_joint_info info;
    begin();
    assert_int_equal(grobo_robot_joint(&rig.robot, NECK, &info), GROBO_OK);
    int64_t age_us = info.angle_age_us;
    rig.now_us += 1234;
    assert_int_equal(grobo_robot_joint(&rig.robot, NECK, &info), GROBO_OK);
    assert_int_equal(info.angle_age_us, age_us + 1234);
    grobo_robot_step(&rig.robot, rig.now_us + 1000);
    assert_int_equal(grobo_robot_joint(&rig.robot, NECK, &info), GROBO_OK);
    assert_int_equal(info.angle_age_us, age_us + 2234);
}

static int plays;

static void pause_then(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        assert_int_equal(grobo_robot_pause(&rig.robot), GROBO_OK);
    }
    plays += event->kind == GROBO_EVENT_PLAY;
}

/* What is asked for in a callback is told before the pump that called it returns. */
TEST_WITH(rig_wirings, what_a_callback_begins_is_told_at_once)
{
    static const rig_key nod[] = {{0, {{NECK, 0}}}, {500, {{NECK, 20}}}, {1500, {{NECK, 0}}}};
    rig_clip clip;
    begin();
    rig_clip_init(&clip, nod, 3);
    clip.only = GROBO_JOINT_BIT(NECK);
    assert_true(grobo_robot_play(&rig.robot, &clip.clip, NULL) >= 0);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    grobo_posture aim = rig_posture(&rig, R_ELBOW, -40, 2000);
    assert_true(grobo_robot_move(&rig.robot, &aim) > 0);
    rig_run(&rig, 100000);
    grobo_robot_on_event(&rig.robot, pause_then, NULL);
    plays = 0;
    assert_true(grobo_robot_move(&rig.robot, &aim) > 0); /* ends the move before it */
    grobo_robot_step(&rig.robot, rig.now_us);
    assert_int_equal(plays, 1);
}

enum { MOVES = 60 };
static unsigned ends[MOVES], began_first;

static void count_end(void *ctx, const grobo_event *event)
{
    (void)ctx;
    unsigned i = event->kind == GROBO_EVENT_JOB ? (unsigned)event->u.job.number - began_first : 0;
    if (event->kind == GROBO_EVENT_JOB && i < MOVES) {
        ends[i]++;
    }
}

/* The loop is held up, and another thread moves on: each move ends the one before. */
TEST_WITH(rig_wirings, each_end_is_told_however_late)
{
    begin();
    grobo_robot_on_event(&rig.robot, count_end, NULL);
    memset(ends, 0, sizeof ends);
    unsigned begun = 0;
    for (int i = 0; i < MOVES; i++) {
        grobo_posture aim = rig_posture(&rig, NECK, i % 2 ? 20 : -20, 2000);
        int number = grobo_robot_move(&rig.robot, &aim);
        assert_true(number > 0 || number == GROBO_ERR_FULL);
        began_first = i == 0 ? (unsigned)number : began_first;
        begun += number > 0;
    }
    assert_int_equal(begun, 21); /* 20 ends wait */
    assert_int_equal(grobo_robot_stop(&rig.robot, true), GROBO_OK);
    assert_true(grobo_robot_estop(&rig.robot) > 0);
    grobo_robot_step(&rig.robot, rig.now_us);
    for (unsigned i = 0; i < begun; i++) {
        assert_int_equal(ends[i], 1);
    }
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->lost_events, 0);
}
