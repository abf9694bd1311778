/* SPDX-License-Identifier: MIT */
/* A robot follows another one: every period the leader's posture becomes the follower's target. */
#include <stdio.h>

#include <grobo/core/robot.h>
#include <grobo/grobo.h>

static int follow(grobo_runner *leader, grobo_robot *follower)
{
    grobo_posture posture;
    int result = grobo_runner_read_posture(leader, &posture, 0);
    posture.time_us = 100000;
    /* The move under way gets another target; the first one is begun. */
    result = result < 0 ? result : grobo_robot_retarget(follower, &posture);
    return result == GROBO_ERR_STATE ? grobo_robot_move(follower, &posture) : result;
}

int main(int argc, char **argv)
{
    grobo_runner *robots[2] = {NULL, NULL};
    int result = GROBO_OK;
    for (int i = 0; result >= 0 && i < 2; i++) {
        const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                              .device = argc > i + 1 ? argv[i + 1] : "sim"};
        const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
        result = grobo_runner_new(&config, &robots[i]);
        result = result < 0 ? result : grobo_runner_start(robots[i]);
        result = result < 0 ? result : grobo_runner_connect(robots[i], 0);
    }
    for (int steps = 0; result >= 0 && steps < 20; steps++) {
        result = follow(robots[0], grobo_runner_robot(robots[1]));
    }
    result = result < 0 ? result : grobo_runner_wait(robots[1], 0);
    printf("%s\n", result >= 0 ? "followed" : grobo_error_text(result));
    for (int i = 0; i < 2; i++) {
        (void)grobo_runner_free(robots[i]);
    }
    return result < 0;
}
