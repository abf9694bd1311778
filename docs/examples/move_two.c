/* SPDX-License-Identifier: MIT */
/* Moves both elbows at the same time, and waits until they are there. */
#include <stdio.h>

#include <grobo/grobo.h>

int main(int argc, char **argv)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                          .device = argc > 1 ? argv[1] : "sim"};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    const grobo_model *model = grobo_gr001_model();
    grobo_runner *runner;
    grobo_posture target;
    if (grobo_runner_new(&config, &runner) < 0) {
        return 1;
    }
    (void)grobo_posture_init(&target, model->n_joints);
    (void)grobo_posture_set_deg(&target, grobo_model_find_joint(model, "R_ELBOW_P", 9), -45);
    (void)grobo_posture_set_deg(&target, grobo_model_find_joint(model, "L_ELBOW_P", 9), -45);
    (void)grobo_posture_set_time_ms(&target, 600);
    int result = grobo_runner_connect(runner, 0);
    if (result >= 0) {
        int job = grobo_robot_move(grobo_runner_robot(runner), &target);
        result = grobo_runner_wait_job(runner, job, GROBO_NEVER_US);
    }
    char said[160]; /* with joint, angle and limits where the angle is refused */
    (void)grobo_robot_error_text(grobo_runner_robot(runner), result, said, sizeof said);
    printf("move: %s\n", said);
    grobo_runner_free(runner);
    return result < 0;
}
