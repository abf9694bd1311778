/* SPDX-License-Identifier: MIT */
/* One thread moves the robot, another one looks at it meanwhile. Neither runs the loop. */
#include <stdio.h>

#include <grobo/grobo.h>

static GROBO_THREAD_FUNC move(void *arg)
{
    grobo_posture target;
    grobo_posture_init_pose(&target, &grobo_gr001_model);
    target.time_us = 500000;
    int job = grobo_robot_move(grobo_control_robot(arg), &target);
    printf("move: %s\n", grobo_error_text(grobo_control_wait_job(arg, job, GROBO_NEVER_US)));
    GROBO_THREAD_RETURN;
}

int main(int argc, char **argv)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                          .device = argc > 1 ? argv[1] : "sim"};
    const grobo_control_config config = {GROBO_CONTROL_CONFIG_INIT, .session = &session};
    grobo_control *control;
    grobo_thread mover;
    if (grobo_control_new(&config, &control) < 0) {
        return 1;
    }
    if (grobo_control_start_thread(control) < 0 || grobo_control_connect(control, 0) < 0 ||
        grobo_thread_start(&mover, move, control) < 0) {
        (void)grobo_control_free(control);
        return 1;
    }
    int looked = 0;
    double angle_rad;
    for (; looked < 5 && grobo_control_read_angle(control, 0, &angle_rad, 0) >= 0; looked++) {
    }
    (void)grobo_thread_join(mover);
    printf("looked %d times\n", looked);
    return grobo_control_free(control) < 0;
}
