/* SPDX-License-Identifier: MIT */
/* Plays a motion file at double speed. */
#include <stdio.h>

#include <grobo/grobo.h>

int main(int argc, char **argv)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                          .device = argc > 2 ? argv[2] : "sim"};
    const grobo_control_config config = {GROBO_CONTROL_CONFIG_INIT, .session = &session,
                                         .motion_dir = "motions"};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .speed_pct = 200};
    grobo_control *control;
    if (grobo_control_new(&config, &control) < 0) {
        return 1;
    }
    int result = grobo_control_load_motion(control, argc > 1 ? argv[1] : "greet", NULL);
    if (result >= 0) {
        printf("%d postures\n", result);
        result = grobo_control_connect(control, 0);
    }
    if (result >= 0) {
        result = grobo_control_play_motion(control, &options);
    }
    if (result >= 0) {
        result = grobo_control_wait(control, GROBO_NEVER_US);
    }
    printf("play: %s\n", grobo_error_text(result));
    grobo_control_free(control);
    return result < 0;
}
