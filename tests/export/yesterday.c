/* SPDX-License-Identifier: MIT */
/*
 * A program that was compiled when configuration structures had two fields less, with the library
 * of today. Behind each structure is a fence: what a library takes from there, it refuses.
 */
#include <stdio.h>
#include <string.h>

#include <grobo/grobo.h>

#define FENCED(type, name, init)                                                                   \
    static struct {                                                                                \
        type config;                                                                               \
        unsigned char fence[256];                                                                  \
    } name = {{init}, {0}};                                                                        \
    memset(name.fence, 0xff, sizeof name.fence)

static int fail(const char *what, int result)
{
    fprintf(stderr, "%s: %s\n", what, grobo_error_text(result));
    return 1;
}

int main(void)
{
    FENCED(grobo_robot_config, robot, GROBO_ROBOT_CONFIG_INIT);
    FENCED(grobo_sim_config, sim, GROBO_SIM_CONFIG_INIT);
    FENCED(grobo_session_config, session, GROBO_SESSION_CONFIG_INIT);
    FENCED(grobo_control_config, control, GROBO_CONTROL_CONFIG_INIT);
    FENCED(grobo_serial_config, serial, GROBO_SERIAL_CONFIG_INIT);
    grobo_serial *port = NULL;
    grobo_control *robot_of = NULL;
    grobo_posture target;

    robot.config.speed_limit_pct = 50;
    sim.config.unpaced = true;
    session.config.device = "sim";
    session.config.robot = &robot.config;
    session.config.sim = &sim.config;
    control.config.session = &session.config;
    control.config.name = "yesterday's";
    int result = grobo_serial_new(&serial.config, &port);
    if (result < 0) {
        return fail("serial", result);
    }
    grobo_serial_free(port);
    result = grobo_control_new(&control.config, &robot_of);
    if (result < 0) {
        return fail("control", result);
    }
    result = grobo_control_connect(robot_of, 0);
    if (result >= 0) {
        grobo_posture_init_pose(&target, &grobo_gr001_model);
        result = grobo_control_wait_job(
            robot_of, grobo_robot_move(grobo_control_robot(robot_of), &target), 0);
    }
    if (result < 0 || strcmp(grobo_control_name(robot_of), "yesterday's") != 0) {
        return fail("move", result);
    }
    grobo_control_free(robot_of);
    printf("%d %d %d %d %d\n", (int)sizeof robot.config, (int)sizeof sim.config,
           (int)sizeof session.config, (int)sizeof control.config, (int)sizeof serial.config);
    return 0;
}
