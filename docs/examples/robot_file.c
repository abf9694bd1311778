/* SPDX-License-Identifier: MIT */
/* A robot that a file describes (docs/guide/own-robot.md) goes to its initial posture. */
#include <stdio.h>

#include <grobo/grobo.h>

int main(int argc, char **argv)
{
    const char *path = argc > 1 ? argv[1] : "src/robots/so101.yaml";
    grobo_robot_def *def;
    grobo_robot_sim sim;
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_runner *runner = NULL;
    if (grobo_robot_def_read_file(path, NULL, NULL, &def) < 0 ||
        grobo_robot_def_driver(def, def->wiring, &driver) < 0 ||
        grobo_robot_def_sim(def, def->wiring, &sim) < 0) {
        return 1;
    }
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                          .device = argc > 2 ? argv[2] : "sim", .driver = &driver,
                                          .baud_bps = (int)def->baud_bps, .sim = &sim.config};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    int result = grobo_runner_new(&config, &runner);
    result = result < 0 ? result : grobo_runner_connect(runner, 0);
    if (result >= 0) {
        grobo_posture pose;
        grobo_posture_init_pose(&pose, def->model);
        int job = grobo_robot_move(grobo_runner_robot(runner), &pose);
        result = grobo_runner_wait_job(runner, job, GROBO_NEVER_US);
    }
    printf("%s: %s\n", def->title, grobo_error_text(result));
    (void)grobo_runner_free(runner);
    grobo_robot_def_free(def);
    return result < 0;
}
