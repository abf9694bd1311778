/* SPDX-License-Identifier: MIT */
/* One thread moves the robot, another one looks at it meanwhile. Neither runs the loop. */
#include <stdio.h>

#include <grobo/core/runner.h>
#include <grobo/grobo.h>

static GROBO_THREAD_FUNC move(void *arg)
{
    grobo_posture target;
    grobo_posture_init_pose(&target, grobo_gr001_model());
    target.time_us = 500000;
    int job = grobo_robot_move(grobo_runner_robot(arg), &target);
    printf("move: %s\n", grobo_error_text(grobo_runner_wait_job(arg, job, GROBO_NEVER_US)));
    GROBO_THREAD_RETURN;
}

int main(int argc, char **argv)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                          .device = argc > 1 ? argv[1] : "sim"};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    grobo_runner *runner;
    grobo_thread mover;
    if (grobo_runner_new(&config, &runner) < 0) {
        return 1;
    }
    if (grobo_runner_start(runner) < 0 || grobo_runner_connect(runner, 0) < 0 ||
        grobo_thread_start(&mover, move, runner) < 0) {
        (void)grobo_runner_free(runner);
        return 1;
    }
    int looked = 0;
    double angle_rad;
    for (; looked < 5 && grobo_runner_read_angle(runner, 0, &angle_rad, 0) >= 0; looked++) {
    }
    (void)grobo_thread_join(mover);
    printf("looked %d times\n", looked);
    return grobo_runner_free(runner) < 0;
}
