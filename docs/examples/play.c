/* SPDX-License-Identifier: MIT */
/* Plays a motion file at double speed. */
#include <stdio.h>

#include <grobo/grobo.h>

int main(int argc, char **argv)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                          .device = argc > 2 ? argv[2] : "sim"};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session,
                                        .motion_dir = "motions"};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .speed_pct = 200};
    grobo_runner *runner;
    if (grobo_runner_new(&config, &runner) < 0) {
        return 1;
    }
    int result = grobo_runner_load_motion(runner, argc > 1 ? argv[1] : "greet", NULL);
    if (result >= 0) {
        printf("%d postures\n", result);
        result = grobo_runner_connect(runner, 0);
    }
    if (result >= 0) {
        result = grobo_runner_play_motion(runner, &options);
    }
    if (result >= 0) {
        result = grobo_runner_wait(runner, GROBO_NEVER_US);
    }
    printf("play: %s\n", grobo_error_text(result));
    grobo_runner_free(runner);
    return result < 0;
}
