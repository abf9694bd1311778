/* SPDX-License-Identifier: MIT */
/* A robot follows another one: every period the leader's posture becomes the follower's target. */
#include <stdio.h>

#include <grobo/core/runner.h>

static int follow(grobo_runner *leader, grobo_runner *follower)
{
    grobo_posture posture;
    int result = grobo_runner_read_posture(leader, &posture, 0);
    posture.time_us = 100000;
    result = result < 0 ? result : grobo_runner_set_target_posture(follower, &posture);
    return result < 0 ? result : grobo_runner_start_motion(follower);
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
    result = result < 0 ? result : grobo_runner_init_position(robots[0]); /* a hand, elsewhere */
    for (int steps = 0; result >= 0 && steps < 20; steps++) {
        result = follow(robots[0], robots[1]);
    }
    result = result < 0 ? result : grobo_runner_wait(robots[1], 0);
    grobo_posture angles[2];
    for (int i = 0; i < 2; i++) {
        (void)grobo_runner_get_current_posture(robots[i], &angles[i]);
        (void)grobo_runner_free(robots[i]);
    }
    printf("%s\n", grobo_posture_near(&angles[0], &angles[1], 0.1) ? "followed" : "left behind");
    return result < 0;
}
