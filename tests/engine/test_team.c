/* SPDX-License-Identifier: MIT */
/* Several robots in step: three engines, each against its simulator, on one virtual clock. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/team.h>

#include "tests/support/counted_mem.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

enum { N = 3, MOTION = 110 /* bytes of a frame that moves all joints */ };

typedef struct seat {
    int member;
} seat;

static grobo_test_rig rigs[N];
static seat seats[N];
static rig_clip clips[N];
static grobo_team *team;
static grobo_team_event_info told[64];
static int n_told;
static int64_t look_us; /* when the team asked to be called */

static const rig_key nod[] = {
    {0, {{NECK, 0}}}, {500, {{NECK, 30}}}, {1000, {{NECK, -30}}}, {2000, {{NECK, 20}}}};

static void on_team(void *ctx, const grobo_team_event_info *event)
{
    (void)ctx;
    assert_true(n_told < 64);
    told[n_told++] = *event;
}

static void on_robot(grobo_test_rig *rig, const grobo_event *event)
{
    grobo_team_event(team, ((seat *)rig->ctx)->member, event);
    look_us = rig->now_us;
}

static const grobo_team_event_info *last(grobo_team_event_kind kind)
{
    for (int i = n_told; i-- > 0;) {
        if (told[i].kind == kind) {
            return &told[i];
        }
    }
    return NULL;
}

/* The joints stand at 0 degrees but for the necks, which have farther to go one after the other. */
static void start(grobo_team_policy policy)
{
    grobo_team_config config = {GROBO_TEAM_CONFIG_INIT, .policy = policy, .on_event = on_team};
    n_told = 0;
    look_us = 0;
    assert_int_equal(grobo_team_new(&config, &team), GROBO_OK);
    for (int i = 0; i < N; i++) {
        rig_start_at(&rigs[i], -15.0 * i, NULL);
        rigs[i].on_event = on_robot;
        rigs[i].ctx = &seats[i];
        rig_clip_init(&clips[i], nod, sizeof nod / sizeof nod[0]);
        seats[i].member = grobo_team_add(team, &rigs[i].robot);
        assert_int_equal(seats[i].member, i);
    }
    int64_t latest_us = 0;
    for (int i = 0; i < N; i++) {
        latest_us = rigs[i].now_us > latest_us ? rigs[i].now_us : latest_us;
    }
    for (int i = 0; i < N; i++) {
        rig_run(&rigs[i], latest_us - rigs[i].now_us);
        rig_forget(&rigs[i]);
    }
}

static int end(void)
{
    grobo_team_free(team);
    team = NULL;
    return 0;
}

static const test_fixture fixture[] = {{NULL, NULL, end}};

/* All go on by a millisecond at a time, so one clock is enough for the team. */
static void run(int64_t us)
{
    for (int64_t t = 0; t < us; t += 1000) {
        for (int i = 0; i < N; i++) {
            rig_run(&rigs[i], 1000);
        }
        if (rigs[0].now_us >= look_us) {
            look_us = grobo_team_step(team, rigs[0].now_us);
        }
    }
}

static void play(int expected)
{
    const grobo_clip *all[N] = {&clips[0].clip, &clips[1].clip, &clips[2].clip};
    assert_int_equal(grobo_team_play(team, all, false, NULL, rigs[0].now_us), expected);
    look_us = 0;
}

static void run_until(grobo_team_state state)
{
    for (int i = 0; grobo_team_get_state(team) != state; i++) {
        assert_true(i < 60000);
        run(1000);
    }
}

static grobo_team_member at(int i)
{
    grobo_team_member member;
    assert_int_equal(grobo_team_get(team, i, &member), GROBO_OK);
    return member;
}

/* When the second frame of its motion left: the first is the approach. */
static int64_t began_us(const grobo_test_rig *rig)
{
    int n = 0;
    for (size_t i = 0; i < rig->n_sent; i++) {
        if (rig->sent[i].size == MOTION && ++n == 2) {
            return rig->sent[i].at_us;
        }
    }
    return 0;
}

TEST_WITH(fixture, they_begin_together_however_far_they_are)
{
    start(GROBO_TEAM_STOP_ALL);
    play(GROBO_OK);
    run_until(GROBO_TEAM_ENDED);
    int64_t start_us = last(GROBO_TEAM_EVENT_START)->at_us;
    for (int i = 0; i < N; i++) {
        assert_int_equal(began_us(&rigs[i]), start_us);
        assert_int_equal(at(i).state, GROBO_TEAM_ENDED);
        assert_int_equal(at(i).result, GROBO_OK);
        assert_true(rig_angle_deg(&rigs[i], NECK) > 19 && rig_angle_deg(&rigs[i], NECK) < 21);
    }
    assert_int_equal(n_told, 2);
    assert_int_equal(last(GROBO_TEAM_EVENT_ENDED)->result, GROBO_OK);
    play(GROBO_OK); /* and once more */
    run_until(GROBO_TEAM_ENDED);
}

TEST_WITH(fixture, a_time_to_begin_is_kept)
{
    start(GROBO_TEAM_STOP_ALL);
    const grobo_clip *one = &clips[0].clip;
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT,
                                        .start_us = rigs[0].now_us + 7000000};
    assert_int_equal(grobo_team_play(team, &one, true, &options, rigs[0].now_us), GROBO_OK);
    look_us = 0;
    run_until(GROBO_TEAM_PLAYS);
    assert_int_equal(last(GROBO_TEAM_EVENT_START)->at_us, options.start_us);
    run_until(GROBO_TEAM_ENDED);
    for (int i = 0; i < N; i++) {
        assert_int_equal(began_us(&rigs[i]), options.start_us);
    }
}

TEST_WITH(fixture, a_start_may_be_told_later)
{
    start(GROBO_TEAM_STOP_ALL);
    const grobo_clip *one = &clips[0].clip;
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .start_us = GROBO_START_LATER};
    int64_t now_us = rigs[0].now_us;
    assert_int_equal(grobo_team_play(team, &one, true, &options, now_us), GROBO_OK);
    look_us = 0;
    assert_int_equal(grobo_team_start_at(team, now_us + 9000000, now_us), GROBO_ERR_STATE);
    run_until(GROBO_TEAM_READY);
    assert_non_null(last(GROBO_TEAM_EVENT_READY));
    run(5000000);
    now_us = rigs[0].now_us;
    assert_int_equal(grobo_team_get_state(team), GROBO_TEAM_READY);
    assert_int_equal(grobo_team_start_at(team, now_us - 1, now_us), GROBO_ERR_STALE);
    assert_int_equal(grobo_team_start_at(team, now_us + 12345, now_us), GROBO_OK);
    assert_int_equal(grobo_team_start_at(team, now_us + 12345, now_us), GROBO_ERR_STATE);
    look_us = 0;
    run_until(GROBO_TEAM_ENDED);
    for (int i = 0; i < N; i++) {
        assert_int_equal(began_us(&rigs[i]), now_us + 12345);
    }
}

static void lose(int i)
{
    grobo_robot_link_down(&rigs[i].robot, rigs[i].now_us);
    rig_run(&rigs[i], 0);
    look_us = 0;
}

TEST_WITH(fixture, all_stop_when_one_is_lost)
{
    start(GROBO_TEAM_STOP_ALL);
    play(GROBO_OK);
    run_until(GROBO_TEAM_PLAYS);
    run(700000);
    lose(1);
    run_until(GROBO_TEAM_ENDED);
    assert_int_equal(last(GROBO_TEAM_EVENT_OUT)->member, 1);
    assert_int_equal(last(GROBO_TEAM_EVENT_OUT)->result, GROBO_ERR_UNPLUGGED);
    assert_int_equal(at(1).result, GROBO_ERR_UNPLUGGED);
    assert_int_equal(at(0).result, GROBO_ERR_CANCELED);
    assert_int_equal(at(2).result, GROBO_ERR_CANCELED);
    assert_int_equal(last(GROBO_TEAM_EVENT_ENDED)->result, GROBO_ERR_UNPLUGGED);
    run(500000);
    for (int i = 0; i < N; i += 2) { /* on the way from 30 to -30, never there */
        assert_true(rig_angle_deg(&rigs[i], NECK) > -10);
        assert_false(grobo_robot_moving(&rigs[i].robot));
    }
}

TEST_WITH(fixture, others_pause_and_go_on_without_the_lost_one)
{
    start(GROBO_TEAM_PAUSE_ALL);
    play(GROBO_OK);
    run_until(GROBO_TEAM_PLAYS);
    run(700000);
    lose(2);
    assert_int_equal(last(GROBO_TEAM_EVENT_PAUSED)->member, 2);
    run(3000000);
    assert_int_equal(grobo_team_get_state(team), GROBO_TEAM_PLAYS);
    double deg = rig_angle_deg(&rigs[0], NECK);
    assert_true(deg > -10);
    assert_int_equal(grobo_robot_play_state(&rigs[0].robot), GROBO_SEQUENCER_PAUSED);
    assert_int_equal(grobo_robot_play_state(&rigs[1].robot), GROBO_SEQUENCER_PAUSED);
    assert_int_equal(grobo_team_resume(team), GROBO_OK);
    assert_int_equal(grobo_team_resume(team), GROBO_ERR_STATE);
    run_until(GROBO_TEAM_ENDED);
    assert_int_equal(at(0).result, GROBO_OK);
    assert_int_equal(at(1).result, GROBO_OK);
    assert_int_equal(at(2).result, GROBO_ERR_UNPLUGGED);
    assert_true(rig_angle_deg(&rigs[0], NECK) > 19);
}

TEST_WITH(fixture, others_go_on_where_that_is_asked)
{
    start(GROBO_TEAM_CONTINUE);
    play(GROBO_OK);
    run_until(GROBO_TEAM_PLAYS);
    int64_t start_us = last(GROBO_TEAM_EVENT_START)->at_us;
    run(700000);
    lose(0);
    run_until(GROBO_TEAM_ENDED);
    assert_int_equal(at(1).result, GROBO_OK);
    assert_in_range(rigs[1].now_us - start_us, 2000000, 2200000);
    assert_null(last(GROBO_TEAM_EVENT_PAUSED));
}

TEST_WITH(fixture, who_is_not_there_in_time_holds_nobody_up)
{
    start(GROBO_TEAM_CONTINUE);
    grobo_team_free(team);
    grobo_team_config config = {GROBO_TEAM_CONFIG_INIT, .policy = GROBO_TEAM_CONTINUE,
                                .prepare_us = 900000, .on_event = on_team};
    assert_int_equal(grobo_team_new(&config, &team), GROBO_OK);
    for (int i = 0; i < N; i++) {
        assert_int_equal(grobo_team_add(team, &rigs[i].robot), i);
    }
    static const rig_key far[] = {{0, {{SHOULDER, -90}}}, {500, {{SHOULDER, -80}}}};
    rig_clip_init(&clips[1], far, 2);
    play(GROBO_OK);
    run_until(GROBO_TEAM_ENDED);
    assert_int_equal(at(1).result, GROBO_ERR_TIMEOUT);
    assert_int_equal(at(0).result, GROBO_OK);
    assert_int_equal(at(2).result, GROBO_OK);
    assert_int_equal(began_us(&rigs[0]), last(GROBO_TEAM_EVENT_START)->at_us);
    assert_true(rig_angle_deg(&rigs[1], SHOULDER) > -70); /* stopped on its way */
}

TEST_WITH(fixture, a_refusal_stops_those_that_were_asked)
{
    start(GROBO_TEAM_STOP_ALL);
    (void)grobo_robot_estop(&rigs[1].robot);
    run(1000000);
    play(GROBO_ERR_LATCHED);
    run_until(GROBO_TEAM_ENDED);
    assert_int_equal(at(0).result, GROBO_ERR_CANCELED);
    assert_int_equal(at(2).result, GROBO_ERR_CANCELED);
    for (int i = 0; i < N; i++) {
        assert_int_equal(began_us(&rigs[i]), 0);
    }
}

TEST_WITH(fixture, a_stop_is_the_next_frame_of_each)
{
    for (int estop = 0; estop < 2; estop++) {
        start(GROBO_TEAM_CONTINUE);
        play(GROBO_OK);
        run_until(GROBO_TEAM_PLAYS);
        run(700000);
        int64_t at_us = rigs[0].now_us;
        size_t before[N];
        for (int i = 0; i < N; i++) {
            before[i] = rigs[i].n_sent;
        }
        int result = estop ? grobo_team_estop(team) : grobo_team_stop(team, true);
        assert_int_equal(result, GROBO_OK);
        run(50000);
        for (int i = 0; i < N; i++) {
            assert_true(rigs[i].n_sent > before[i]);
            assert_true(rigs[i].sent[before[i]].at_us - at_us < 25000); /* behind a reply */
            assert_int_equal(at(i).state, GROBO_TEAM_ENDED);
        }
        run(1000000);
        assert_int_equal(last(GROBO_TEAM_EVENT_ENDED)->result,
                         estop ? GROBO_ERR_LATCHED : GROBO_ERR_CANCELED);
        for (int i = 0; i < N; i++) {
            assert_int_equal(rig_torque(&rigs[i], NECK) == GROBO_TORQUE_ON, !estop);
        }
        assert_int_equal(grobo_team_stop(team, true), GROBO_ERR_STATE);
        grobo_team_free(team);
        team = NULL;
    }
}

TEST_WITH(fixture, requests_that_make_no_sense_are_refused)
{
    const grobo_clip *none[1] = {NULL};
    grobo_team_config config = {GROBO_TEAM_CONFIG_INIT, .policy = (grobo_team_policy)7};
    assert_int_equal(grobo_team_new(&config, &team), GROBO_ERR_ARG);
    assert_int_equal(grobo_team_new(NULL, &team), GROBO_OK);
    const grobo_clip *one = &clips[0].clip;
    assert_int_equal(grobo_team_play(team, &one, true, NULL, 0), GROBO_ERR_EMPTY);
    assert_int_equal(grobo_team_pause(team), GROBO_ERR_STATE);
    grobo_team_free(team);
    start(GROBO_TEAM_STOP_ALL);
    assert_int_equal(grobo_team_add(team, &rigs[0].robot), GROBO_ERR_ARG);
    assert_int_equal(grobo_team_play(team, none, true, NULL, 0), GROBO_ERR_ARG);
    play(GROBO_OK);
    play(GROBO_ERR_STATE);
    assert_int_equal(grobo_team_add(team, &rigs[0].robot), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_start_at(&rigs[0].robot, rigs[0].now_us), GROBO_ERR_STATE);
    assert_int_equal(grobo_team_get(team, N, NULL), GROBO_ERR_ARG);
}

TEST_WITH(fixture, a_start_in_the_past_is_refused)
{
    start(GROBO_TEAM_STOP_ALL);
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .start_us = GROBO_START_LATER};
    assert_true(grobo_robot_play(&rigs[0].robot, &clips[0].clip, &options) > 0);
    grobo_play_progress progress;
    grobo_robot_progress(&rigs[0].robot, &progress);
    assert_false(progress.ready);
    rig_run(&rigs[0], 5000000);
    grobo_robot_progress(&rigs[0].robot, &progress);
    assert_true(progress.ready);
    assert_int_equal(grobo_robot_start_at(&rigs[0].robot, rigs[0].now_us - 1), GROBO_ERR_STALE);
    assert_int_equal(grobo_robot_start_at(&rigs[0].robot, -1), GROBO_ERR_ARG);
    int64_t at_us = rigs[0].now_us + 20000; /* a reading that has the line now is over by then */
    assert_int_equal(grobo_robot_start_at(&rigs[0].robot, at_us), GROBO_OK);
    assert_int_equal(grobo_robot_start_at(&rigs[0].robot, at_us), GROBO_ERR_STATE);
    rig_wait_play(&rigs[0], GROBO_SEQUENCER_FINISHED);
    assert_int_equal(began_us(&rigs[0]), at_us);
}

TEST_WITH(fixture, no_memory_is_an_error)
{
    for (size_t fail_at = 1; fail_at <= 2; fail_at++) {
        counted_mem counter = {.fail_at = fail_at};
        const grobo_mem mem = counted_mem_of(&counter);
        grobo_team_config config = {GROBO_TEAM_CONFIG_INIT, .mem = &mem};
        int result = grobo_team_new(&config, &team);
        if (result >= 0) {
            result = grobo_team_add(team, &rigs[0].robot);
            grobo_team_free(team);
        }
        assert_int_equal(result, GROBO_ERR_NOMEM);
        assert_int_equal(counter.bytes, 0);
    }
    team = NULL;
}
