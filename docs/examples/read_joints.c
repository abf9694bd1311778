/* SPDX-License-Identifier: MIT */
/* Connects to a robot and prints the angle of each joint. The robot does not move. */
#include <stdio.h>

#include <grobo/grobo.h>

int main(int argc, char **argv)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                          .device = argc > 1 ? argv[1] : "sim"};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session,
                                        .skip_exit = true};
    grobo_runner *runner;
    grobo_posture posture;
    if (grobo_runner_new(&config, &runner) < 0) {
        return 1;
    }
    int result = grobo_runner_connect(runner, 0);
    if (result >= 0) {
        result = grobo_runner_read_posture(runner, &posture, 0);
    }
    const grobo_model *model = grobo_robot_driver(grobo_runner_robot(runner))->model;
    for (int j = 0; result >= 0 && j < model->n_joints; j++) {
        double angle_deg;
        if (grobo_posture_get_deg(&posture, j, &angle_deg) >= 0) {
            printf("%-12s %7.1f deg\n", grobo_model_joint(model, j)->name, angle_deg);
        }
    }
    if (result < 0) {
        fprintf(stderr, "read: %s\n", grobo_error_text(result));
    }
    grobo_runner_free(runner);
    return result < 0;
}
