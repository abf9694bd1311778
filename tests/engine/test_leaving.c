/* SPDX-License-Identifier: MIT */
/* Who leaves, and who stops: the steps of leaving by themselves, and how requests begin. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/axes_kit.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip;

/* ---- steps ----------------------------------------------------------------------------------- */

/* The steps of a script that are looked at. */
enum { QUIET = 0, STRAYS = 5, DOUBT = 6, MOVED = 8, AIM_REST = 5 };

/* A job is about to take this step of its script. */
static void begin_job(grobo_job_kind kind, const grobo_robot_step_fn *script, unsigned at)
{
    grobo_robot_task *job = robot.job;
    job->script = script;
    job->kind = kind;
    job->number = 5;
    job->at = at + 1;
    job->joints = GROBO_JOINTS_ALL(N);
    job->begun_us = NOW;
    job->joint = -1;
    job->until_us = job->bound_us = GROBO_NEVER_US;
}

static int take_step(void)
{
    return robot.job->script[robot.job->at - 1](&robot);
}

TEST_WITH(rig_wirings, who_leaves_waits_until_all_is_quiet)
{
    for (int j = 0; j < N; j++) {
        for (int what = 0; what < 5; what++) {
            start();
            begin_job(GROBO_JOB_EXIT, grobo_i_script_exit_hold, QUIET);
            robot.axes[j].trajectory.to_us = what == 1 ? NOW + 1 : NOW;
            robot.axes[j].next = what == 2;
            robot.sequencer.state = what == 3 ? GROBO_SEQUENCER_STOPPING : GROBO_SEQUENCER_IDLE;
            if (what == 4) {
                assert_non_null(grobo_i_slot_take(&robot, GROBO_I_USE_HALT));
            }
            assert_int_equal(take_step(), what == 0 ? GROBO_I_NEXT : GROBO_I_WAIT);
            assert_int_equal(robot.job->at, what == 0 ? 1 : 0); /* it is looked at again */
            assert_true(robot.job->until_us == (what == 0 ? GROBO_NEVER_US : NOW + 5 * MS));
        }
    }
}

/* No weight has an RS30x further from its goal. */
#define NEAR_DEG 5.0

/* What a servo told of where it is going, as it was read just now. */
typedef struct told {
    grobo_torque torque;
    int64_t own_us; /* until when it moves, from now */
    bool external;
    int64_t left_us; /* of its goal's time */
    double apart_deg;
    int dps;
    bool is_old; /* its goal was read before */
    bool astray;
    int64_t until_us; /* until when it moves then, from now */
    int64_t way_us;   /* and its way */
} told;

static const told tellings[] = {
    {GROBO_TORQUE_ON, 1, false, 0, 30, 0, false, true, 1, 100 * MS},
    {GROBO_TORQUE_ON, 100 * MS + 1, false, 0, 30, 0, false, true, 100 * MS + 1, 100 * MS + 1},
    {GROBO_TORQUE_ON, 0, false, 0, 30, 0, false, false, 0, 0},
    {GROBO_TORQUE_ON, -9, true, 0, 0, 0, false, true, -9, 100 * MS},
    {GROBO_TORQUE_ON, -9, false, 3 * S, 0.21, 1, false, true, 3 * S - 5, 3 * S - 5},
    {GROBO_TORQUE_ON, -9, false, 3 * S, -0.21, -1, false, true, 3 * S - 5, 3 * S - 5},
    {GROBO_TORQUE_ON, -9, false, 3 * S, 0.19, 1, false, false, 0, 0},
    {GROBO_TORQUE_ON, -9, false, 3 * S, 0.21, 1, true, false, 0, 0},
    {GROBO_TORQUE_ON, -9, false, 0, 30, 0, false, false, 0, 0},
    {GROBO_TORQUE_ON, -9, false, 1, 30, 0, false, true, -4, 100 * MS},
    {GROBO_TORQUE_ON, 2 * S, false, 1 * S, 30, 0, false, true, 2 * S, 2 * S},
    {GROBO_TORQUE_ON, 1 * S, false, 2 * S, 30, 0, false, true, 2 * S - 5, 2 * S - 5},
    /* At no speed it may hang in its load: the next reading shows whether it creeps. */
    {GROBO_TORQUE_ON, -9, false, 3 * S, 0.21, 0, false, false, 0, 0},
    {GROBO_TORQUE_ON, -9, false, 3 * S, NEAR_DEG - 0.1, 0, false, false, 0, 0},
    {GROBO_TORQUE_ON, -9, false, 3 * S, NEAR_DEG + 0.1, 0, false, true, 3 * S - 5, 3 * S - 5},
    {GROBO_TORQUE_OFF, 1, true, 3 * S, 30, 0, false, false, 0, 0},
    {GROBO_TORQUE_BRAKE, 1, true, 3 * S, 30, 0, false, false, 0, 0},
};
enum { TELLINGS = sizeof tellings / sizeof tellings[0] };

static void let_go_astray(int joint, const told *row)
{
    grobo_robot_axis *axis = &robot.axes[joint];
    axis->state.torque = row->torque;
    axis->state.goal_rad = axis->state.angle_rad + RAD(row->apart_deg);
    axis->state.goal_time_us = 4 * S + row->left_us;
    axis->state.time_us = 4 * S;
    axis->state.speed_dps = row->dps;
    axis->own_until_us = NOW + row->own_us;
    axis->goal_us = axis->angle_us - row->is_old;
    axis->phase = row->external ? GROBO_I_JOINT_EXTERNAL : GROBO_I_JOINT_IDLE;
}

/* Its way is the one that its servo tells of; where it tells of none, it moves until the halt has
 * left, which is sent to it alone, and then all is looked at again. */
TEST_WITH(rig_wirings, who_leaves_stops_what_others_set_going)
{
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < TELLINGS; i++) {
            const told *row = &tellings[i];
            start();
            begin_job(GROBO_JOB_EXIT, grobo_i_script_exit_hold, STRAYS);
            let_go_astray(j, row);
            keep_axes();
            assert_int_equal(take_step(), GROBO_I_NEXT);
            if (row->astray) {
                const grobo_joint_state *at = &robot.axes[j].state;
                bool tells = row->until_us > -5; /* after it was read */
                before[j].own_until_us = NOW + row->until_us;
                before[j].trajectory =
                    (grobo_robot_trajectory){at->angle_rad, tells ? at->goal_rad : at->angle_rad,
                                             tells ? NOW - 5 : NOW, NOW + row->way_us};
                before[j].phase = GROBO_I_JOINT_STRAY;
            }
            expect_axes();
            assert_true(halting() == (row->astray ? GROBO_JOINT_BIT(j) : 0));
            assert_int_equal(robot.job->at, row->astray ? QUIET : STRAYS + 1);
            assert_int_equal(robot.job->rounds, row->astray);
        }
    }
}

/* A joint that reports no speed, and has time left to a goal elsewhere, is stopped once it was read
 * to have left its place; until then it is looked at again. */
TEST_WITH(rig_wirings, who_leaves_stops_what_creeps_at_no_speed)
{
    static const told creeps = {GROBO_TORQUE_ON, -9, false, 3 * S, 4, 0, false, true, 0, 0};
    for (int j = 0; j < N; j++) {
        for (int left = 0; left < 2; left++) {
            start();
            begin_job(GROBO_JOB_EXIT, grobo_i_script_exit_hold, MOVED);
            let_go_astray(j, &creeps);
            robot.job->pending = GROBO_JOINT_BIT(j);
            robot.axes[j].stood_us = NOW - 5;
            robot.axes[j].still_us = left ? NOW : NOW - 100 * MS;
            assert_int_equal(take_step(), GROBO_I_NEXT);
            assert_true(halting() == (left ? GROBO_JOINT_BIT(j) : 0));
            assert_int_equal(robot.job->at, left ? QUIET : DOUBT);
        }
    }
}

/* Of servos that tell no more than how fast they turn: one that turns near the end of its way is
 * looked at once more, one that trembles there stands, any other is stopped anew. */
TEST_WITH(rig_wirings, who_leaves_waits_for_what_turns)
{
    static const struct {
        int dps;
        double left_deg;
        bool on, tells_time, again, halts;
    } rows[] = {
        {7, 30, true, false, false, false},     {8, 30, true, false, true, true},
        {-8, -30, true, false, true, true},     {8, 30, false, false, false, false},
        {8, 30, true, true, false, false},      {8, 3.1, true, false, true, true},
        {8, 2.9, true, false, true, false},     {59, 0.9, true, false, false, false},
        {-59, -0.9, true, false, false, false}, {60, 0.9, true, false, true, false},
        {8, -1.1, true, false, true, false},
    };
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            begin_job(GROBO_JOB_EXIT, grobo_i_script_exit_hold, STRAYS);
            grobo_robot_axis *axis = &robot.axes[j];
            axis->state.valid = GROBO_FIELD_ANGLE | GROBO_FIELD_SPEED | GROBO_FIELD_TORQUE |
                                (rows[i].tells_time ? GROBO_FIELD_TIME : 0);
            axis->state.torque = rows[i].on ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF;
            axis->state.time_us = axis->state.goal_time_us = 0;
            axis->own_until_us = 0;
            axis->phase = GROBO_I_JOINT_SENT;
            axis->seen_rad = axis->state.angle_rad;
            axis->seen_dps = (int16_t)rows[i].dps;
            axis->trajectory.to_rad = axis->seen_rad + RAD(rows[i].left_deg);
            axis->trajectory.to_us = NOW - 1;
            assert_int_equal(take_step(), GROBO_I_NEXT);
            if ((halting() != 0) != rows[i].halts || (robot.job->at == QUIET) != rows[i].again) {
                fail_msg("row %zu: joint %d", i, j);
            }
            assert_true((axis->trajectory.to_us > NOW) == rows[i].again);
        }
    }
}

/* Nobody knows of it where it is; its neighbour is stopped all the same. */
TEST_WITH(rig_wirings, who_leaves_does_not_look_at_what_was_not_read)
{
    for (int j = 0; j < N; j++) {
        start();
        begin_job(GROBO_JOB_EXIT, grobo_i_script_exit_hold, STRAYS);
        let_go_astray(j, &tellings[0]);
        let_go_astray(other_of(j), &tellings[0]);
        let_go_astray(third_of(j), &tellings[0]);
        robot.job->joints = all_but(third_of(j));
        robot.job->failed = GROBO_JOINT_BIT(other_of(j)) | GROBO_JOINT_BIT(j ^ 1);
        robot.job->result = GROBO_ERR_TIMEOUT;
        assert_int_equal(take_step(), GROBO_I_NEXT);
        assert_true(halting() == GROBO_JOINT_BIT(j));
        assert_true(robot.job->failed == (GROBO_JOINT_BIT(other_of(j)) | GROBO_JOINT_BIT(j ^ 1)));
        assert_int_equal(robot.job->result, GROBO_ERR_TIMEOUT);
    }
}

/* Ten times, then it is told which joint does not stop; an emergency stop goes on for longer, and
 * who has just begun is patient with a servo that is deaf. */
TEST_WITH(rig_wirings, who_leaves_gives_up_on_a_joint_that_goes_on)
{
    static const struct {
        grobo_job_kind kind;
        int rounds;
        int64_t begun_us, read_us; /* ago */
        bool halts, fails;
    } rows[] = {
        {GROBO_JOB_EXIT, 9, 2500000, 0, true, false},
        {GROBO_JOB_EXIT, 10, 2499999, 0, false, false},
        {GROBO_JOB_EXIT, 10, 2500000, 0, false, true},
        {GROBO_JOB_ESTOP, 19, 2500000, 2500000, true, false},
        {GROBO_JOB_ESTOP, 20, 2499999, 2500000, true, false},
        {GROBO_JOB_ESTOP, 20, 2500000, 2499999, true, false}, /* it was heard since then */
        {GROBO_JOB_ESTOP, 20, 2500000, 2500000, true, true},
    };
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start();
            begin_job(rows[i].kind, grobo_i_script_exit_hold, STRAYS);
            robot.job->begun_us = NOW - rows[i].begun_us;
            robot.job->rounds = rows[i].rounds;
            robot.job->pending = bits(j, other_of(j));
            let_go_astray(j, &tellings[0]);
            robot.axes[j].angle_us = NOW - rows[i].read_us;
            robot.axes[other_of(j)].angle_us = NOW; /* stands, and waits for nobody */
            assert_int_equal(take_step(), GROBO_I_NEXT);
            if ((halting() != 0) != rows[i].halts) {
                fail_msg("row %zu: joint %d", i, j);
            }
            assert_true(robot.job->failed == (rows[i].fails ? GROBO_JOINT_BIT(j) : 0));
            assert_int_equal(robot.job->joint, rows[i].fails ? j : -1);
            assert_int_equal(robot.job->result, rows[i].fails ? GROBO_ERR_MISMATCH : GROBO_OK);
            assert_int_equal(robot.job->at, rows[i].fails ? STRAYS + 1 : QUIET);
            assert_true(robot.job->pending ==
                        (rows[i].fails ? GROBO_JOINT_BIT(other_of(j)) : bits(j, other_of(j))));
        }
    }
}

TEST_WITH(rig_wirings, who_sits_down_aims_at_the_rest_of_what_holds)
{
    double rest_rad[GROBO_JOINTS_MAX];
    for (int j = 0; j < N; j++) {
        for (int has = 0; has < 2; has++) {
            start();
            for (int k = 0; k < N; k++) {
                rest_rad[k] = RAD(1 + k);
            }
            driver.rest_rad = has ? rest_rad : NULL;
            begin_job(GROBO_JOB_EXIT, grobo_i_script_exit_sit, AIM_REST);
            robot.job->rounds = 3;
            robot.job->joints = all_but(other_of(j));
            robot.axes[third_of(j)].state.torque = GROBO_TORQUE_BRAKE;
            make_limp(j);
            assert_int_equal(take_step(), GROBO_I_NEXT);
            grobo_joint_mask be = ~bits(j, other_of(j)) & all_but(third_of(j));
            assert_true(robot.job->target.set == be && robot.job->pending == be);
            assert_int_equal(robot.job->rounds, 0);
            assert_true(robot.soft && robot.soft_us == GROBO_NEVER_US);
            for (int k = 0; k < N; k++) {
                expect_equal(robot.job->target.angle_rad[k], has ? RAD(1 + k) : 0, "its rest");
            }
        }
    }
}

/* ---- requests -------------------------------------------------------------------------------- */

TEST_WITH(rig_wirings, an_exit_is_carried_out_as_it_is_asked_for)
{
    static const struct {
        grobo_exit_policy asked, config;
        bool latched;
        const grobo_robot_step_fn *be;
    } rows[] = {
        {GROBO_EXIT_OFF, GROBO_EXIT_HOLD, false, grobo_i_script_exit_off},
        {GROBO_EXIT_HOLD, GROBO_EXIT_OFF, false, grobo_i_script_exit_hold},
        {GROBO_EXIT_SIT, GROBO_EXIT_OFF, false, grobo_i_script_exit_sit},
        {GROBO_EXIT_SIT, GROBO_EXIT_OFF, true, grobo_i_script_exit_hold},
        {GROBO_EXIT_OFF, GROBO_EXIT_HOLD, true, grobo_i_script_exit_off},
        {GROBO_EXIT_DEFAULT, GROBO_EXIT_OFF, false, grobo_i_script_exit_off},
        {GROBO_EXIT_DEFAULT, GROBO_EXIT_HOLD, false, grobo_i_script_exit_hold},
        {GROBO_EXIT_DEFAULT, GROBO_EXIT_SIT, false, grobo_i_script_exit_sit},
        {GROBO_EXIT_DEFAULT, GROBO_EXIT_SIT, true, grobo_i_script_exit_hold},
    };
    static const int64_t bounds_us[] = {5 * S, INT64_MAX};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_robot_config config = {
            GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = GROBO_SENSE_NEVER,
            .on_exit = rows[i].config, .exit_bound_us = bounds_us[i % 2]};
        rig_start(&rig, &config, NULL);
        rig_power(&rig);
        if (rows[i].latched) {
            grobo_i_trip(&rig.robot, GROBO_TRIP_TEMPERATURE, CHEST, 75, true);
        }
        rig_run(&rig, 100000);
        rig_expect(&rig,
                   grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(CHEST), GROBO_SENSE_POSITION),
                   GROBO_OK);
        assert_int_equal(
            grobo_i_gate_torque(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_TORQUE_ON, GROBO_I_WHOLE),
            rows[i].latched ? GROBO_ERR_LATCHED : GROBO_OK);
        rig.robot.free_joints = rows[i].latched ? 0 : GROBO_JOINT_BIT(CHEST);
        int number = grobo_robot_exit(&rig.robot, rows[i].asked);
        const grobo_robot_task *job = rig.robot.job;
        assert_int_equal(job->number, number);
        assert_int_equal(job->kind, GROBO_JOB_EXIT);
        assert_ptr_equal(job->script, rows[i].be);
        assert_int_equal(job->torque, GROBO_TORQUE_OFF);
        assert_true(job->joints == rig_all(&rig) && rig.robot.free_joints == 0);
        assert_true(job->bound_us == (i % 2 == 0 ? rig.now_us + 5 * S : GROBO_NEVER_US));
        assert_false(grobo_i_slots_wait(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_I_ORDER_TORQUE,
                                        GROBO_TORQUE_ON));
        rig_expect(&rig, number, GROBO_OK);
    }
}

TEST_WITH(rig_wirings, an_exit_stops_what_moves_whatever_the_job)
{
    static const grobo_job_kind kinds[] = {GROBO_JOB_NONE, GROBO_JOB_SENSE, GROBO_JOB_MOVE};
    for (int i = 0; i < 3; i++) {
        start();
        begin_job(kinds[i], grobo_i_script_sense, QUIET);
        robot.last_number = robot.job->number;
        set_going(3);
        assert_int_equal(grobo_robot_exit(&robot, GROBO_EXIT_HOLD), 6);
        assert_int_equal(robot.job->kind, GROBO_JOB_EXIT);
        assert_true(halting() == GROBO_JOINT_BIT(3));
    }
}

TEST_WITH(rig_wirings, an_exit_is_refused_by_name)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_robot_exit(&rig.robot, (grobo_exit_policy)(GROBO_EXIT_SIT + 1)),
                     GROBO_ERR_ARG);
    int number = grobo_robot_estop(&rig.robot);
    assert_true(number > 0);
    assert_int_equal(grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_exit(&rig.robot, GROBO_EXIT_SIT), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_ERR_STATE);
    rig_expect(&rig, number, GROBO_OK);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_ERR_STATE);
    rig_expect(&rig, grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD), GROBO_OK);
    grobo_robot_link_down(&rig.robot, rig.now_us);
    assert_int_equal(grobo_robot_exit(&rig.robot, (grobo_exit_policy)9), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_robot_estop(&rig.robot), GROBO_ERR_CLOSED);
}

/* What stops the robot is not cancelled, nor what the engine does by itself. */
TEST_WITH(rig_wirings, a_job_is_cancelled_that_somebody_asked_for)
{
    for (int i = 2 * GROBO_JOB_NONE; i <= 2 * GROBO_JOB_SETTLE + 1; i++) {
        int kind = i / 2;
        bool frame_moves = i % 2 != 0;
        bool stays = kind == GROBO_JOB_NONE || kind == GROBO_JOB_ESTOP || kind == GROBO_JOB_SETTLE;
        start();
        begin_job((grobo_job_kind)kind, grobo_i_script_exit_hold, QUIET);
        robot.last_number = robot.job->number;
        robot.job->order.moves = frame_moves;
        set_going(3);
        if (kind == GROBO_JOB_ESTOP) {
            latch(GROBO_TRIP_ESTOP);
        }
        assert_int_equal(grobo_robot_cancel(&robot), stays ? GROBO_ERR_STATE : GROBO_OK);
        assert_int_equal(robot.job->kind, stays ? kind : GROBO_JOB_NONE);
        /* What it moves is stopped, and no other job's. */
        bool moves = kind == GROBO_JOB_MOVE || kind == GROBO_JOB_PLAY || frame_moves;
        assert_true(halting() == (!stays && moves ? GROBO_JOINT_BIT(3) : 0));
    }
}

/* Another job than the one that began it. */
TEST_WITH(rig_wirings, a_motion_goes_on_when_a_reading_is_cancelled)
{
    static const rig_key slow[] = {{0, {{NECK, 0}}}, {3000, {{NECK, 30}}}};
    rig_start_at(&rig, 0, &quiet);
    rig_clip_init(&clip, slow, 2);
    clip.only = bits(NECK, CHEST);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, S);
    int number = grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_FULL);
    assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
    rig_expect(&rig, number, GROBO_ERR_CANCELED);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    rig_run(&rig, 200000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 30) < 0.1);
}

/* One that no line has carried is forgotten with the stop. */
TEST_WITH(rig_wirings, a_reset_owes_no_stop_to_the_next_line)
{
    for (int resets = 0; resets < 2; resets++) {
        rig_start(&rig, &quiet, NULL);
        rig_power(&rig);
        grobo_robot_link_down(&rig.robot, rig.now_us);
        assert_int_equal(grobo_robot_estop(&rig.robot), GROBO_ERR_CLOSED);
        assert_true(!resets || grobo_robot_reset(&rig.robot) == GROBO_OK);
        grobo_robot_link_up(&rig.robot, rig.now_us);
        assert_int_equal(grobo_robot_job(&rig.robot), resets ? GROBO_JOB_NONE : GROBO_JOB_ESTOP);
    }
}

TEST_WITH(rig_wirings, an_emergency_stop_is_for_all_joints_and_bounded)
{
    for (int off = 0; off < 2; off++) {
        start_with(&(grobo_robot_config){
            GROBO_ROBOT_CONFIG_INIT, .estop_torque = off ? GROBO_ESTOP_OFF : GROBO_ESTOP_BRAKE});
        latch(GROBO_TRIP_ESTOP);
        robot.holds_at_stop = true;
        int number = grobo_i_estop_start(&robot);
        assert_int_equal(robot.job->number, number);
        assert_int_equal(robot.job->kind, GROBO_JOB_ESTOP);
        assert_ptr_equal(robot.job->script, grobo_i_script_torque_off);
        assert_true(robot.job->joints == GROBO_JOINTS_ALL(N));
        assert_int_equal(robot.job->torque, off ? GROBO_TORQUE_OFF : GROBO_TORQUE_BRAKE);
        assert_int_equal(robot.job->priority, GROBO_PRIORITY_STOP);
        assert_true(robot.job->bound_us == NOW + 10 * S);
        assert_false(robot.holds_at_stop);
        assert_int_equal(robot.slots[0].txn.priority, GROBO_PRIORITY_STOP); /* it is run at once */
        assert_int_equal(robot.slots[0].order.torque, robot.job->torque);
    }
}

/* All of the stop is forgotten, and what begins behind it begins slowly. */
TEST_WITH(rig_wirings, a_reset_makes_the_next_move_slow)
{
    for (int resets = 0; resets < 2; resets++) {
        grobo_trip_info trip;
        rig_start_at(&rig, 0, &quiet);
        if (resets) {
            rig.robot.low_readings = 2;
            grobo_i_trip(&rig.robot, GROBO_TRIP_TEMPERATURE, CHEST, 75, true);
            rig_run(&rig, 1000);
            assert_int_equal(grobo_robot_reset(&rig.robot), GROBO_OK);
        }
        grobo_robot_tripped(&rig.robot, &trip);
        assert_int_equal(trip.trip, GROBO_TRIP_NONE);
        assert_int_equal(trip.joint, -1);
        assert_true(trip.value == 0 && trip.at_us == 0 && !trip.latched);
        assert_int_equal(rig.robot.low_readings, 0);
        assert_false(rig.robot.stop_owed);
        grobo_posture target = rig_posture(&rig, NECK, 40, 10);
        rig_forget(&rig);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 5000);
        assert_int_equal(rig_sent_ms(&rig, NECK_ID), resets ? 670 : 110); /* 60, 375 deg/s */
    }
}

/* ---- while a motion is approached ------------------------------------------------------------ */

enum { CANCEL, STOP, EXIT, TRIP, WAYS };

static void stop_by(int way)
{
    switch (way) {
    case CANCEL:
        assert_int_equal(grobo_robot_cancel(&rig.robot), GROBO_OK);
        break;
    case STOP:
        assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
        break;
    case EXIT:
        assert_true(grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD) > 0);
        break;
    default:
        grobo_i_trip(&rig.robot, GROBO_TRIP_TEMPERATURE, CHEST, 75, true);
        break;
    }
}

/* Its job still reads back whether the first posture was taken: the sequencer stops as well, in the
 * 200 ms that it takes, and the joint rests after half of what it would do in them. */
TEST_WITH(rig_wirings, an_approach_is_stopped_whatever_stops_it)
{
    static const rig_key far[] = {{0, {{NECK, 45}}}, {1000, {{NECK, 0}}}};
    grobo_robot_config config = quiet;
    config.approach_dps = 20;
    for (int way = 0; way < WAYS; way++) {
        rig_start_at(&rig, 0, &config);
        rig_clip_init(&clip, far, 2);
        clip.only = bits(NECK, CHEST);
        int number = grobo_robot_play(&rig.robot, &clip.clip, NULL);
        rig_wait_play(&rig, GROBO_SEQUENCER_APPROACHING);
        assert_int_equal(rig.robot.job->kind, GROBO_JOB_PLAY);
        assert_int_equal(rig.robot.job->number, number);
        rig_forget(&rig);
        stop_by(way);
        assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_STOPPING);
        int64_t asked_us = rig.now_us;
        rig_expect(&rig, number, way == TRIP ? GROBO_ERR_LATCHED : GROBO_ERR_CANCELED);
        rig_wait_play(&rig, GROBO_SEQUENCER_IDLE);
        assert_in_range(rig.now_us - asked_us, 150000, 260000);
        double here_deg = rig_angle_deg(&rig, NECK);
        if (!(here_deg >= 1 && here_deg <= 5)) {
            fail_msg("way %d: the neck is at %.2f deg", way, here_deg);
        }
        rig_run(&rig, 3 * S);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.15);
    }
}
