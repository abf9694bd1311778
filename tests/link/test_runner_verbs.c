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
