/* SPDX-License-Identifier: MIT */
/* Attitudes. Roll, pitch, yaw: choreonoid-whole-body.md, section "Keys". */
#include "src/body/body.h"
#include "src/body/vec.h"

/* As near as this to straight up or down, yaw is taken to be 0. */
#define GIMBAL_RAD 1e-6

void grobo_i_rotation_of_rpy(double r[9], const double rpy[3])
{
    const double cr = cos(rpy[0]), sr = sin(rpy[0]);
    const double cp = cos(rpy[1]), sp = sin(rpy[1]);
    const double cy = cos(rpy[2]), sy = sin(rpy[2]);

    r[0] = cp * cy;
    r[1] = sr * sp * cy - cr * sy;
    r[2] = cr * sp * cy + sr * sy;
    r[3] = cp * sy;
    r[4] = sr * sp * sy + cr * cy;
    r[5] = cr * sp * sy - sr * cy;
    r[6] = -sp;
    r[7] = sr * cp;
    r[8] = cr * cp;
}

void grobo_i_rpy_of_rotation(double rpy[3], const double r[9])
{
    rpy[1] = atan2(-r[6], hypot(r[7], r[8]));
    if (fabs(rpy[1]) > BODY_PI / 2 - GIMBAL_RAD) {
        rpy[0] = atan2(-r[5], r[4]);
        rpy[2] = 0;
        return;
    }
    rpy[0] = atan2(r[7], r[8]);
    rpy[2] = atan2(r[3], r[0]);
}

void grobo_i_rotation_vector(double out[3], const double r[9])
{
    const double v[3] = {0.5 * (r[7] - r[5]), 0.5 * (r[2] - r[6]), 0.5 * (r[3] - r[1])};
    const double sine = sqrt(vec_dot(v, v));
    const double theta = atan2(sine, 0.5 * (r[0] + r[4] + r[8] - 1));
    const double k = sine > 0 ? theta / sine : 1;

    for (int i = 0; i < 3; i++) {
        out[i] = k * v[i];
    }
}
