/* SPDX-License-Identifier: MIT */
/* Two robots play the same motion in step: both begin at one time of the same clock. */
#include <stdio.h>

#include <grobo/grobo.h>

int main(int argc, char **argv)
{
    grobo_runner *robots[2] = {NULL, NULL};
    int result = GROBO_OK;
    for (int i = 0; result >= 0 && i < 2; i++) {
        const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                              .device = argc > i + 1 ? argv[i + 1] : "sim"};
        const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session,
                                            .motion_dir = "motions"};
        result = grobo_runner_new(&config, &robots[i]);
        if (result >= 0) {
            result = grobo_runner_start(robots[i]);
        }
        if (result >= 0) {
            result = grobo_runner_connect(robots[i], 0);
        }
        if (result >= 0) {
            result = grobo_runner_load_motion(robots[i], "greet", NULL);
        }
    }
    /* Each approaches its first posture by then, and waits. */
    const grobo_play_options how = {GROBO_PLAY_OPTIONS_INIT, .start_us = grobo_now_us() + 2000000};
    for (int i = 0; result >= 0 && i < 2; i++) {
        result = grobo_runner_play_motion(robots[i], &how);
    }
    for (int i = 0; result >= 0 && i < 2; i++) {
        result = grobo_runner_wait(robots[i], GROBO_NEVER_US);
        printf("robot %d: %s\n", i + 1, grobo_error_text(result));
    }
    for (int i = 0; i < 2; i++) {
        (void)grobo_runner_free(robots[i]);
    }
    return result < 0;
}
