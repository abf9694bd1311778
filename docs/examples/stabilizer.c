/* SPDX-License-Identifier: MIT */
/* A stabilizer keeps the gripper of a simulated SO-101 level, whatever the wrist is told. */
#include <stdio.h>
#include <string.h>

#include <grobo/grobo.h>

static int keep_level(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                      grobo_posture *target)
{
    (void)self, (void)ctx, (void)sensed;
    if ((target->set & 0xE) == 0xE) { /* shoulder_lift, elbow_flex, wrist_flex */
        target->angle_rad[3] = -(target->angle_rad[1] + target->angle_rad[2]);
    }
    return GROBO_OK;
}

int main(void)
{
    const grobo_robot_def *def = NULL;
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_robot_sim sim;
    grobo_runner *arm = NULL;
    grobo_posture at = {.n_joints = 6, .set = 0xE, .angle_rad = {0, 0.3, 0.2, 0}};
    for (size_t i = 0; (def = grobo_robot_def_at(i)) != NULL && strcmp(def->name, "so101"); i++) {
    }
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = "sim",
                                          .driver = &driver, .sim = &sim.config};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    int result = grobo_robot_def_driver(def, def->wiring, &driver);
    driver.stabilize = keep_level;
    result = result < 0 ? result : grobo_robot_def_sim(def, def->wiring, &sim);
    result = result < 0 ? result : grobo_runner_new(&config, &arm);
    result = result < 0 ? result : grobo_runner_connect(arm, 0);
    result = result < 0 ? result : grobo_robot_move(grobo_runner_robot(arm), &at);
    result = result < 0 ? result : grobo_runner_wait_job(arm, result, GROBO_NEVER_US);
    result = result < 0 ? result : grobo_runner_read_posture(arm, &at, 0);
    printf("wrist_flex %.1f rad: %s\n", at.angle_rad[3], grobo_error_text(result));
    return grobo_runner_free(arm) < 0 || result < 0;
}
