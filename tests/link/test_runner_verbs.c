/* SPDX-License-Identifier: MIT */
/* One set of verbs: the engine of a runner, used by any thread. */

#include "tests/support/runner_kit.h"
#include "tests/support/test.h"

enum { THREADS = 4, ROUNDS = 25 };

static const int joints[THREADS] = {12, 13, 16, 19};

static grobo_posture target_of(int joint, double angle_deg, int time_ms)
{
    grobo_posture target;
    assert_int_equal(grobo_posture_init(&target, 20), GROBO_OK);
    assert_int_equal(grobo_posture_set_deg(&target, joint, angle_deg), GROBO_OK);
    assert_int_equal(grobo_posture_set_time_ms(&target, time_ms), GROBO_OK);
    return target;
}

TEST_WITH(with_and_without_thread, a_program_is_three_lines)
{
    runner_come_up();
    grobo_robot *robot = grobo_runner_robot(runner);
    grobo_posture target = target_of(13, 20, 200);
    assert_int_equal(grobo_runner_wait_job(runner, grobo_robot_move(robot, &target), 0), GROBO_OK);
    double angle_rad = 0;
    assert_int_equal(grobo_runner_read_angle(runner, 13, &angle_rad, 0), GROBO_OK);
    assert_in_range((unsigned)grobo_ddeg_from_rad(angle_rad), 195, 205);
}

TEST_WITH(with_and_without_thread, an_error_of_the_request_is_the_result)
{
    runner_come_up();
    grobo_robot *robot = grobo_runner_robot(runner);
    grobo_posture target = target_of(13, 400, 200);
    assert_int_equal(grobo_runner_wait_job(runner, grobo_robot_move(robot, &target), 0),
                     GROBO_ERR_LIMIT);
    assert_int_equal(grobo_runner_wait_job(runner, 0, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_runner_wait_job(runner, 1000000, 0), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_runner_wait_job(NULL, 1, 0), GROBO_ERR_ARG);
    assert_null(grobo_runner_robot(NULL));
}

/* What a thread found, to be asserted by the test's own. */
typedef struct caller {
    grobo_thread thread;
    int joint;
    int bad; /* the first result that was not wanted */
} caller;

static GROBO_THREAD_FUNC move_to_and_fro(void *arg)
{
    caller *c = arg;
    grobo_robot *robot = grobo_runner_robot(runner);
    for (int i = 0; i < ROUNDS && c->bad == GROBO_OK; i++) {
        grobo_posture target;
        grobo_joint_info info;
        (void)grobo_posture_init(&target, 20);
        (void)grobo_posture_set_deg(&target, c->joint, i % 2 == 0 ? -3 : -1);
        (void)grobo_posture_set_time_ms(&target, 20);
        int result = grobo_runner_wait_job(runner, grobo_robot_move(robot, &target), 0);
        if (result == GROBO_ERR_FULL) {
            continue; /* there are more threads than places */
        }
        c->bad = result;
        if (grobo_robot_joint(robot, c->joint, &info) < 0 || info.status < 0) {
            c->bad = GROBO_ERR_IO;
        }
    }
    GROBO_THREAD_RETURN;
}

TEST_WITH(with_and_without_thread, threads_move_joints_of_their_own)
{
    caller callers[THREADS];
    runner_come_up();
    for (int i = 0; i < THREADS; i++) {
        callers[i] = (caller){.joint = joints[i]};
        assert_int_equal(grobo_thread_start(&callers[i].thread, move_to_and_fro, &callers[i]),
                         GROBO_OK);
    }
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(grobo_thread_join(callers[i].thread), GROBO_OK);
        assert_int_equal(callers[i].bad, GROBO_OK);
    }
}

TEST_WITH(with_and_without_thread, an_emergency_stop_ends_the_moves_of_all_threads)
{
    runner_come_up();
    grobo_robot *robot = grobo_runner_robot(runner);
    grobo_posture target = target_of(13, 30, 5000);
    int job = grobo_robot_move(robot, &target);
    assert_true(job > 0);
    assert_true(grobo_robot_is_pending(robot, job));
    assert_int_equal(grobo_runner_estop(runner), GROBO_OK);
    int result = grobo_runner_wait_job(runner, job, 0);
    assert_true(result == GROBO_ERR_CANCELED || result == GROBO_ERR_LATCHED);
    assert_int_equal(grobo_robot_move(robot, &target), GROBO_ERR_LATCHED);
    assert_int_equal(grobo_robot_reset(robot), GROBO_ERR_STATE); /* the loop's alone */
}

/* ---- requests that wait for their turn ---------------------------------------------------- */

/* A request, how often it was made, and what it was told last. */
typedef struct asked {
    int times;
    int refused; /* of these */
} asked;

static int switch_elbow_on(void *arg, grobo_runner *of)
{
    asked *a = arg;
    int job = grobo_robot_torque(grobo_runner_robot(of), GROBO_JOINT_BIT(13), GROBO_TORQUE_ON);

    a->times++;
    a->refused += job < 0;
    return job;
}

TEST_WITH(with_and_without_thread, a_request_waits_until_the_robot_takes_it)
{
    asked a = {0};
    grobo_posture target = target_of(13, 20, 200);

    runner_come_up();
    grobo_robot *robot = grobo_runner_robot(runner);
    int move = grobo_robot_move(robot, &target);
    assert_true(move > 0);
    assert_int_equal(grobo_robot_torque(robot, GROBO_JOINT_BIT(13), GROBO_TORQUE_ON),
                     GROBO_ERR_STATE); /* what the request would be told now */
    assert_int_equal(grobo_runner_request(runner, switch_elbow_on, &a, 0), GROBO_OK);
    assert_int_equal(a.times, a.refused + 1);
    assert_false(grobo_robot_is_pending(robot, move));
    assert_int_equal(grobo_runner_wait_job(runner, move, 0), GROBO_OK);
    assert_int_equal(runner_torque_of(runner, 13), GROBO_TORQUE_ON);
}

TEST_WITH(with_and_without_thread, a_request_that_waits_too_long_is_not_made)
{
    asked a = {0};
    grobo_posture target = target_of(13, 20, 1000);

    runner_come_up();
    grobo_robot *robot = grobo_runner_robot(runner);
    int move = grobo_robot_move(robot, &target);
    assert_true(move > 0);
    assert_int_equal(grobo_runner_request(runner, switch_elbow_on, &a, 30000), GROBO_ERR_TIMEOUT);
    assert_int_equal(a.times, a.refused);
    assert_int_equal(grobo_runner_wait_job(runner, move, 0), GROBO_OK);
    assert_int_equal(runner_torque_of(runner, 13), GROBO_TORQUE_ON);
}

static int refuse(void *arg, grobo_runner *of)
{
    (void)of;
    return *(int *)arg;
}

TEST_WITH(with_and_without_thread, a_request_refused_for_itself_ends_at_once)
{
    int result = GROBO_ERR_LIMIT;

    runner_come_up();
    assert_int_equal(grobo_runner_request(runner, refuse, &result, 0), GROBO_ERR_LIMIT);
    result = GROBO_ERR_STATE; /* and nothing runs that it could wait for */
    assert_int_equal(grobo_runner_request(runner, refuse, &result, 0), GROBO_ERR_STATE);
    result = 0;
    assert_int_equal(grobo_runner_request(runner, refuse, &result, 0), 0);
}

static GROBO_THREAD_FUNC switch_to_and_fro(void *arg)
{
    caller *c = arg;

    for (int i = 0; i < 6 && c->bad == GROBO_OK; i++) {
        c->bad = grobo_runner_torque(runner, GROBO_JOINT_BIT(c->joint),
                                     i % 2 == 0 ? GROBO_TORQUE_ON : GROBO_TORQUE_BRAKE, 0);
    }
    GROBO_THREAD_RETURN;
}

TEST_WITH(with_and_without_thread, threads_switch_torque_in_turn_beside_a_move)
{
    caller callers[THREADS];
    grobo_posture target = target_of(0, 5, 300);

    runner_come_up();
    int move = grobo_robot_move(grobo_runner_robot(runner), &target);
    assert_true(move > 0);
    for (int i = 0; i < THREADS; i++) {
        callers[i] = (caller){.joint = joints[i]};
        assert_int_equal(grobo_thread_start(&callers[i].thread, switch_to_and_fro, &callers[i]),
                         GROBO_OK);
    }
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(grobo_thread_join(callers[i].thread), GROBO_OK);
        assert_int_equal(callers[i].bad, GROBO_OK);
        assert_int_equal(runner_torque_of(runner, joints[i]), GROBO_TORQUE_BRAKE);
    }
    assert_int_equal(grobo_runner_wait_job(runner, move, 0), GROBO_OK);
}
