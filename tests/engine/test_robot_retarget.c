/* SPDX-License-Identifier: MIT */
/* Targets that come before the one before is reached. */
#include <math.h>
#include <stdint.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

enum { TARGETS = 40 };

static grobo_test_rig rig;

/* True if a frame holds a goal of the neck: a short packet, or an entry of a long one (id 0, then
 * address, bytes of an entry, entries, each led by its id: RS30x manual 6.2). */
static bool is_goal(const uint8_t *p, size_t size)
{
    bool found = size == 12 && p[2] == NECK_ID && p[4] == GROBO_RS30X_GOAL;
    bool is_long = size > 7 && p[2] == 0 && p[4] == GROBO_RS30X_GOAL;
    for (int i = 0; is_long && i < p[6]; i++) {
        found = found || p[7 + i * p[5]] == NECK_ID;
    }
    return found;
}

/* Goals of the neck in the frames sent since the last rig_forget(). */
static int goals_sent(void)
{
    int n = 0;
    for (size_t i = 0; i < rig.n_sent; i++) {
        const uint8_t *p;
        size_t size = rig_packet(&rig.sent[i], &p);
        n += is_goal(p, size);
    }
    return n;
}

static int move(double angle_deg, int time_ms)
{
    grobo_posture target = rig_posture(&rig, NECK, angle_deg, time_ms);
    return grobo_robot_move(&rig.robot, &target);
}

static int retarget(double angle_deg, int time_ms)
{
    grobo_posture target = rig_posture(&rig, NECK, angle_deg, time_ms);
    return grobo_robot_retarget(&rig.robot, &target);
}

/* Torque is on, and the slow first move is over. */
static void begin(const grobo_robot_config *config)
{
    rig_start(&rig, config, NULL);
    rig_power(&rig);
    rig_expect(&rig, move(1, 100), GROBO_OK);
    rig_forget(&rig);
}

TEST_WITH(rig_wirings, each_target_of_a_stream_leaves)
{
    for (int rate_hz = 10; rate_hz <= 20; rate_hz += 10) {
        begin(NULL);
        int number = move(0, 100);
        assert_true(number > 0);
        for (int i = 1; i < TARGETS; i++) {
            rig_run(&rig, 1000000 / rate_hz);
            assert_int_equal(goals_sent(), i);
            assert_int_equal(retarget(10 * sin(i / 5.0), 100), number);
        }
        rig_expect(&rig, number, GROBO_OK);
        assert_int_equal(goals_sent(), TARGETS);
        assert_int_equal(rig_count(&rig, GROBO_EVENT_JOB), 1);
        assert_true(fabs(rig_angle_deg(&rig, NECK) - 10 * sin((TARGETS - 1) / 5.0)) < 0.2);
    }
}

/* The speed is the joint's, and the time is counted from where it is by then. */
TEST_WITH(rig_wirings, a_target_turns_a_joint_round_on_its_way)
{
    begin(&quiet);
    int number = move(30, 1000);
    rig_run(&rig, 500000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 15) < 5);
    assert_int_equal(retarget(-30, 10), number);
    rig_run(&rig, 50000);
    assert_true(rig_sent_ms(&rig, NECK_ID) > 10);
    rig_expect(&rig, number, GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 30) < 0.2);
}

/* While the job waits, reads back, and sends: it goes on with the last target. */
TEST_WITH(rig_wirings, a_target_may_come_at_any_moment)
{
    for (int after_us = 40000; after_us < 260000; after_us += 1700) {
        begin(NULL);
        int number = move(5, 100);
        rig_run(&rig, after_us);
        int again =
            grobo_robot_job(&rig.robot) == GROBO_JOB_MOVE ? retarget(-5, 100) : move(-5, 100);
        assert_true(again >= number);
        rig_expect(&rig, again, GROBO_OK);
        assert_true(fabs(rig_angle_deg(&rig, NECK) + 5) < 0.2);
        assert_int_equal(goals_sent(), 2);
    }
}

/* The last target is read back, and sent again where it was lost. */
TEST_WITH(rig_wirings, a_lost_target_is_sent_again)
{
    begin(&quiet);
    int number = move(5, 100);
    rig_run(&rig, 60000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    assert_int_equal(retarget(-5, 100), number);
    rig_run(&rig, 60000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_expect(&rig, number, GROBO_OK);
    assert_true(goals_sent() > 2);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 5) < 0.2);
}

/* Joints join, and none is forgotten. */
TEST_WITH(rig_wirings, the_joints_before_go_along)
{
    begin(&quiet);
    int number = move(5, 500);
    rig_run(&rig, 60000);
    grobo_posture target = rig_posture(&rig, L_ELBOW, 20, 500);
    assert_int_equal(grobo_robot_retarget(&rig.robot, &target), GROBO_ERR_STATE);
    assert_int_equal(grobo_posture_set_deg(&target, NECK, 8), 0);
    assert_int_equal(grobo_robot_retarget(&rig.robot, &target), number);
    rig_expect(&rig, number, GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 8) < 0.2);
    assert_true(fabs(rig_angle_deg(&rig, L_ELBOW) - 20) < 0.2);
}

TEST_WITH(rig_wirings, what_must_not_be_redirected_is_not)
{
    rig_start(&rig, &quiet, NULL);
    assert_int_equal(retarget(5, 100), GROBO_ERR_STATE);
    rig_power(&rig);
    assert_int_equal(retarget(5, 100), GROBO_ERR_STATE);
    int number = move(5, 100); /* the slow first one */
    assert_int_equal(retarget(6, 100), GROBO_ERR_STATE);
    rig_run(&rig, 60000);
    assert_int_equal(retarget(6, 100), GROBO_ERR_STATE);
    rig_expect(&rig, number, GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 5) < 0.2);

    number = move(0, 500);
    assert_int_equal(retarget(6, 100), GROBO_ERR_STATE); /* the joint is still being read */
    rig_run(&rig, 60000);
    assert_int_equal(retarget(-60, 100), GROBO_ERR_LIMIT);
    grobo_posture bad = rig_posture(&rig, NECK, 0, 100);
    bad.angle_rad[NECK] = NAN;
    assert_int_equal(grobo_robot_retarget(&rig.robot, &bad), GROBO_ERR_NAN);
    bad.set = 0;
    assert_int_equal(grobo_robot_retarget(&rig.robot, &bad), GROBO_ERR_ARG);
    rig_expect(&rig, number, GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, NECK)) < 0.2);

    /* A joint that is limp does not join. */
    rig_expect(&rig, grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(L_ELBOW), GROBO_TORQUE_OFF),
               GROBO_OK);
    number = move(5, 500);
    rig_run(&rig, 60000);
    grobo_posture both = rig_posture(&rig, NECK, 8, 100);
    assert_int_equal(grobo_posture_set_deg(&both, L_ELBOW, 0), 0);
    assert_int_equal(grobo_robot_retarget(&rig.robot, &both), GROBO_ERR_STATE);
    (void)grobo_robot_estop(&rig.robot);
    assert_int_equal(retarget(6, 100), GROBO_ERR_LATCHED);
    grobo_robot_link_down(&rig.robot, rig.now_us);
    assert_int_equal(retarget(6, 100), GROBO_ERR_CLOSED);
}

/* As a move does; what is moved otherwise stays with who moves it. */
TEST_WITH(rig_wirings, joints_besides_are_taken_from_other_moves)
{
    begin(&quiet);
    grobo_posture chest = rig_posture(&rig, CHEST, -10, 1000);
    grobo_posture both = rig_posture(&rig, NECK, -5, 1000);
    assert_int_equal(grobo_posture_set_deg(&both, CHEST, -5), 0);
    int number = move(5, 1000);
    rig_run(&rig, 200000);
    int other = grobo_robot_move(&rig.robot, &chest);
    rig_run(&rig, 200000);
    assert_int_equal(grobo_robot_retarget(&rig.robot, &both), number);
    rig_expect(&rig, other, GROBO_ERR_SUPERSEDED);
    rig_expect(&rig, number, GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, CHEST) + 5) < 0.2);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 5) < 0.2);

    number = move(5, 1000);
    rig_run(&rig, 200000);
    other = grobo_robot_torque(&rig.robot, GROBO_JOINT_BIT(CHEST), GROBO_TORQUE_OFF);
    assert_true(other > 0);
    assert_int_equal(grobo_robot_retarget(&rig.robot, &both), GROBO_ERR_STATE);
    rig_expect(&rig, other, GROBO_OK);
    rig_expect(&rig, number, GROBO_OK);
}

/* Another move has taken the chest; the next target takes it back, and the job ends well. */
TEST_WITH(rig_wirings, a_joint_that_was_taken_comes_back)
{
    begin(&quiet);
    grobo_posture both = rig_posture(&rig, NECK, -5, 1000);
    assert_int_equal(grobo_posture_set_deg(&both, CHEST, -5), 0);
    grobo_posture chest = rig_posture(&rig, CHEST, -10, 1000);
    int number = grobo_robot_move(&rig.robot, &both);
    rig_run(&rig, 300000);
    int other = grobo_robot_move(&rig.robot, &chest);
    rig_run(&rig, 300000);
    assert_int_equal(grobo_robot_retarget(&rig.robot, &both), number);
    rig_expect(&rig, other, GROBO_ERR_SUPERSEDED);
    const grobo_event_job *job = rig_expect(&rig, number, GROBO_OK);
    assert_true(job->failed == 0);
    assert_true(fabs(rig_angle_deg(&rig, CHEST) + 5) < 0.2);
}

/* Whatever began before it: the move is found among all jobs, by its joints. */
TEST_WITH(rig_wirings, a_move_is_found_behind_other_jobs)
{
    begin(&quiet);
    for (int j = R_HIP_R; j < CHEST; j++) { /* a reading that takes long */
        assert_int_equal(grobo_sim_set_cable(&rig.sim, j, GROBO_SIM_CABLE_MUTE), 0);
    }
    const grobo_joint_mask silent = GROBO_JOINTS_ALL(CHEST) & ~GROBO_JOINT_BIT(HIP);
    assert_true(grobo_robot_sense(&rig.robot, silent, GROBO_SENSE_FULL) > 0);
    grobo_posture elbow = rig_posture(&rig, L_ELBOW, 20, 2000);
    int other = grobo_robot_move(&rig.robot, &elbow);
    int number = move(30, 2000);
    while (goals_sent() == 0) {
        rig_run(&rig, 1000);
    }
    rig_run(&rig, 10000);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_SENSE);
    assert_int_equal(retarget(-5, 100), number);
    assert_int_equal(grobo_robot_retarget(&rig.robot, &elbow), other);
    rig_expect(&rig, number, GROBO_OK);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 5) < 0.2);
    rig_expect(&rig, other, GROBO_OK);
}

/* Moves of single joints asked for at once share a job; each goes to another target by itself, or
 * takes one of a further joint, and the others go on. */
TEST_WITH(rig_wirings, one_of_several_moves_is_redirected)
{
    begin(&quiet);
    grobo_posture elbow = rig_posture(&rig, L_ELBOW, 60, 2000);
    grobo_posture chest = rig_posture(&rig, CHEST, -10, 2000);
    int number = move(30, 2000);
    assert_int_equal(grobo_robot_move(&rig.robot, &elbow), number);
    assert_int_equal(retarget(5, 100), GROBO_ERR_STATE); /* they are still being read */
    rig_run(&rig, 500000);
    assert_true(fabs(rig_angle_deg(&rig, L_ELBOW) - 30) < 2);
    for (int i = 0; i < TARGETS; i++) {
        rig_run(&rig, 20000);
        assert_int_equal(retarget(5 + i * 0.1, 100), number);
    }
    rig_run(&rig, 300000); /* the elbow takes its 2 s, from when its frame left */
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 5 - (TARGETS - 1) * 0.1) < 0.3);
    double elbow_deg = rig_angle_deg(&rig, L_ELBOW);
    assert_true(elbow_deg > 45 && elbow_deg < 58);

    grobo_posture two = rig_posture(&rig, NECK, -5, 1000);
    assert_int_equal(grobo_posture_set_deg(&two, CHEST, -10), 0);
    assert_int_equal(grobo_robot_retarget(&rig.robot, &chest), GROBO_ERR_STATE);
    assert_int_equal(grobo_robot_retarget(&rig.robot, &two), number);
    const grobo_event_job *job = rig_expect(&rig, number, GROBO_OK);
    assert_true(job->failed == 0);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 5) < 0.3);
    assert_true(fabs(rig_angle_deg(&rig, CHEST) + 10) < 0.3);
    assert_true(fabs(rig_angle_deg(&rig, L_ELBOW) - 60) < 0.3);
}

/* One frame of both was lost: what goes elsewhere is not sent back, and both arrive. */
TEST_WITH(rig_wirings, a_lost_frame_of_several_moves_is_made_good)
{
    begin(&quiet);
    grobo_posture elbow = rig_posture(&rig, L_ELBOW, 60, 500);
    int number = move(10, 500);
    assert_int_equal(grobo_robot_move(&rig.robot, &elbow), number);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, L_ELBOW, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 80000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, L_ELBOW, GROBO_SIM_CABLE_IN), 0);
    (void)retarget(-5, 500);
    const grobo_event_job *job = rig_expect(&rig, number, GROBO_OK);
    assert_true(job->failed == 0);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - (goals_sent() > 1 ? -5 : 10)) < 0.3);
    assert_true(fabs(rig_angle_deg(&rig, L_ELBOW) - 60) < 0.3);
}
