/* SPDX-License-Identifier: MIT */
/* A robot of two RS30x servos on a bare bus, described in a table; simulated here. */
#include <stdio.h>

#include <grobo/grobo.h>

/* Limits and speed in radians, the number of the servo, its own mirror (grobo/model.h). */
#define JOINT(called, i, most)                                                                     \
    {                                                                                              \
        .name = (called), .min_rad = -(most), .max_rad = (most), .max_speed_rad_s = 6.5,           \
        .motor = (i) + 1, .mirror = (i), .mirror_sign = 1                                          \
    }
static const grobo_joint joints[] = {JOINT("PAN", 0, 1.5), JOINT("TILT", 1, 0.8)};
static const grobo_model model =
    GROBO_TABLE(grobo_model, .name = "HEAD", GROBO_MODEL_JOINTS(joints), .n_joints = 2);

int main(int argc, char **argv)
{
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_posture target;
    grobo_runner *runner;
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                          .device = argc > 1 ? argv[1] : "sim", .driver = &driver};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    if (grobo_rs30x_driver_init(&driver, &model, grobo_rs30x_protocol()) < 0 ||
        grobo_runner_new(&config, &runner) < 0) {
        return 1;
    }
    (void)grobo_posture_init(&target, model.n_joints);
    (void)grobo_posture_set_deg(&target, 0, 30);
    (void)grobo_posture_set_deg(&target, 1, -20);
    int result = grobo_runner_connect(runner, 0);
    if (result >= 0) {
        int job = grobo_robot_move(grobo_runner_robot(runner), &target);
        result = grobo_runner_wait_job(runner, job, 0);
    }
    printf("%s: %s\n", grobo_runner_name(runner), grobo_error_text(result));
    (void)grobo_runner_free(runner);
    return result < 0;
}
