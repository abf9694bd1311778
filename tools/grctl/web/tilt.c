/* SPDX-License-Identifier: MIT */
/*
 * A body that is drawn by its joints alone stands with a sole flat on the ground. One whose IMU
 * says otherwise is drawn turned, its lowest part on the ground. Sag and backlash of servos are no
 * tilt: up to 5 degrees the picture stays flat.
 */
#include <math.h>
#include <string.h>

#include "tools/grctl/web/pose.h"
#include "tools/grctl/web/serve.h"
#include "tools/grctl/web/tilt.h"

/* It has fallen when it is tilted by more than the first, and is up again below the second. */
#define FALLEN_DEG 45
#define UP_DEG 30
#define DRAWN_DEG 5
/* An older reading says nothing of now. */
#define OLD_US INT64_C(1000000)

static bool is_known(const serve *s, grobo_imu *reading, int64_t *age_us)
{
    return grobo_robot_imu(s->c.robot, reading, age_us) == GROBO_OK && *age_us <= OLD_US;
}

/* Each reading: a fall, and its end, are events. */
static void on_reading(void *ctx, const grobo_imu *reading)
{
    serve *s = ctx;
    double deg = grobo_deg_from_rad(grobo_imu_tilt(reading));
    json_t *more = json_pack("{s:o}", "tilt_deg", app_json_number(deg, 1));
    if (!s->tilt.fallen && deg > FALLEN_DEG) {
        s->tilt.fallen = true;
        events_tell(&s->events, "fall", "error", more,
                    "the robot has fallen: it is tilted by %.0f degrees", deg);
    } else if (s->tilt.fallen && deg < UP_DEG) {
        s->tilt.fallen = false;
        events_tell(&s->events, "fall", "info", more, "the robot is up again");
    } else {
        json_decref(more);
    }
}

int tilt_open(serve *s)
{
    if (!s->options->imu) {
        return 0;
    }
    s->tilt.port.took = on_reading;
    s->tilt.port.ctx = s;
    return imu_open(&s->tilt.port, &s->c, s->options->imu);
}

void tilt_close(serve *s)
{
    imu_close(&s->tilt.port);
}

json_t *tilt_json(serve *s)
{
    grobo_imu reading;
    int64_t age_us;
    if (!is_known(s, &reading, &age_us)) {
        return json_null();
    }
    json_t *rates = json_array();
    for (int i = 0; i < 3; i++) {
        json_array_append_new(rates, app_json_number(grobo_deg_from_rad(reading.rate_rad_s[i]), 1));
    }
    return json_pack("{s:o,s:o,s:o,s:o,s:I,s:b}", "roll_deg",
                     app_json_number(grobo_deg_from_rad(reading.roll_rad), 1), "pitch_deg",
                     app_json_number(grobo_deg_from_rad(reading.pitch_rad), 1), "tilt_deg",
                     app_json_number(grobo_deg_from_rad(grobo_imu_tilt(&reading)), 1), "rate_dps",
                     rates, "age_ms", (json_int_t)(age_us / 1000), "fallen", s->tilt.fallen);
}

static double lowest_m(const grobo_body_stand *stood, const grobo_transform *links, int n_links)
{
    double lowest = INFINITY;
    for (int i = 0; i < n_links; i++) {
        lowest = fmin(lowest, links[i].p_m[2]);
    }
    for (int i = 0; i < 8; i++) {
        lowest = fmin(lowest, stood->sole_m[i / 4][i % 4][2]);
    }
    return lowest;
}

bool tilt_apply(serve *s, const grobo_posture *posture, grobo_body_stand *stood)
{
    const grobo_body_model *body = pose_body(s->a);
    grobo_transform links[GROBO_BODY_LINKS_MAX], root = stood->root;
    double q_rad[GROBO_JOINTS_MAX];
    grobo_imu reading;
    int64_t age_us;
    if (!body || !is_known(s, &reading, &age_us)) {
        return false;
    }
    const double rpy_rad[3] = {reading.roll_rad, reading.pitch_rad,
                               atan2(stood->root.r[3], stood->root.r[0])};
    pose_rotation(root.r, rpy_rad);
    double alike =
        root.r[2] * stood->root.r[2] + root.r[5] * stood->root.r[5] + root.r[8] * stood->root.r[8];
    if (alike > cos(grobo_rad_from_deg(DRAWN_DEG))) {
        return false;
    }
    for (int j = 0; j < body->n_joints; j++) {
        q_rad[j] = j < posture->n_joints ? posture->angle_rad[j] : 0;
    }
    (void)grobo_body_stand_pose(body, q_rad, &root, stood);
    grobo_body_forward(body, &root, q_rad, links);
    root.p_m[2] -= lowest_m(stood, links, body->n_links);
    (void)grobo_body_stand_pose(body, q_rad, &root, stood);
    return true;
}
