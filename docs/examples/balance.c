/* SPDX-License-Identifier: MIT */
/* GR001 leans against a push by its ankles, as an IMU has it: balance [DEVICE] <IMU */
#include <stdio.h>

#include <grobo/core/imu.h>
#include <grobo/core/runner.h>
#include <grobo/grobo.h>

#define PERIOD_S 0.02 /* from one line of the IMU to the next: each sends a target */
#define MOST_RAD 0.3

enum { RIGHT = 4, LEFT = 10 }; /* R_ANKLE_P, L_ANKLE_P */

static double held(double lean_rad)
{
    return lean_rad > MOST_RAD ? MOST_RAD : lean_rad < -MOST_RAD ? -MOST_RAD : lean_rad;
}

/* What is left of a tilt is leant against more and more: a push that stays, ankles that sag. */
static int lean(const grobo_driver *self, void *ctx, const grobo_imu *imu,
                const grobo_posture *sensed, grobo_posture *target)
{
    static double lasting; /* of the one robot of this program */
    double turn = imu ? 0.3 * imu->pitch_rad + 0.04 * imu->rate_rad_s[1] : 0;
    (void)self, (void)ctx, (void)sensed;
    lasting = held(lasting + (imu ? 2.0 * imu->pitch_rad * PERIOD_S : 0));
    turn = held(turn + lasting);
    target->angle_rad[RIGHT] += turn;
    target->angle_rad[LEFT] -= turn;
    return GROBO_OK;
}

static int stand(void *reading, grobo_runner *runner) /* on the robot's thread */
{
    grobo_posture still;
    grobo_posture_init_pose(&still, grobo_gr001_model());
    still.time_us = 40000;
    int result = grobo_robot_set_imu(grobo_runner_robot(runner), reading);
    return result < 0 ? result : grobo_robot_send(grobo_runner_robot(runner), &still);
}

/* A line: roll, pitch in degrees, three rates in degrees a second. */
static bool read_line(grobo_imu *imu)
{
    double deg[5] = {0};
    bool whole = scanf("%lf %lf %lf %lf %lf", &deg[0], &deg[1], &deg[2], &deg[3], &deg[4]) == 5;
    imu->roll_rad = grobo_rad_from_deg(deg[0]);
    imu->pitch_rad = grobo_rad_from_deg(deg[1]);
    for (int i = 0; i < 3; i++) {
        imu->rate_rad_s[i] = grobo_rad_from_deg(deg[2 + i]);
    }
    return whole;
}

int main(int argc, char **argv)
{
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT,
                                          .device = argc > 1 ? argv[1] : "sim", .driver = &driver};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    grobo_runner *gr001 = NULL;
    grobo_posture at = {0};
    grobo_imu imu;
    int result = grobo_driver_copy(&driver, grobo_gr001_driver(GROBO_WIRING_BOARD));
    driver.stabilize_by = lean;
    result = result < 0 ? result : grobo_runner_new(&config, &gr001);
    result = result < 0 ? result : grobo_runner_start(gr001);
    result = result < 0 ? result : grobo_runner_connect(gr001, 0);
    result =
        result < 0 ? result : grobo_runner_torque(gr001, GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON, 0);
    while (result >= 0 && read_line(&imu)) {
        result = grobo_runner_call(gr001, stand, &imu);
    }
    result = result < 0 ? result : grobo_runner_wait(gr001, 0);
    result = result < 0 ? result : grobo_runner_read_posture(gr001, &at, 0);
    printf("R_ANKLE_P %.0f deg: %s\n", grobo_deg_from_rad(at.angle_rad[RIGHT]),
           grobo_error_text(result < 0 ? result : GROBO_OK));
    return grobo_runner_free(gr001) < 0 || result < 0;
}
