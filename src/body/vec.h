/* SPDX-License-Identifier: MIT */
/* Vectors of 3 and row-major 3x3 matrices. An output must not overlap an input unless said so. */
#ifndef GROBO_SRC_BODY_VEC_H
#define GROBO_SRC_BODY_VEC_H

#include <math.h>

#define BODY_PI 3.14159265358979323846

/* out = a, b scaled and added; out may be a or b. */
static inline void vec_add_scaled(double out[3], const double a[3], double k, const double b[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = a[i] + k * b[i];
    }
}

static inline double vec_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vec_cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* out = m v */
static inline void mat_vec(double out[3], const double m[9], const double v[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
    }
}

/* out = m^T v */
static inline void mat_t_vec(double out[3], const double m[9], const double v[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = m[i] * v[0] + m[3 + i] * v[1] + m[6 + i] * v[2];
    }
}

/* out = a b */
static inline void mat_mul(double out[9], const double a[9], const double b[9])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
        }
    }
}

/* out = a^T b */
static inline void mat_t_mul(double out[9], const double a[9], const double b[9])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
        }
    }
}

/* Rotation by an angle about a unit axis (Rodrigues). */
static inline void mat_axis_angle(double out[9], const double axis[3], double angle_rad)
{
    const double s = sin(angle_rad);
    const double c = cos(angle_rad);
    const double x = axis[0], y = axis[1], z = axis[2];

    out[0] = c + x * x * (1 - c);
    out[1] = x * y * (1 - c) - z * s;
    out[2] = x * z * (1 - c) + y * s;
    out[3] = y * x * (1 - c) + z * s;
    out[4] = c + y * y * (1 - c);
    out[5] = y * z * (1 - c) - x * s;
    out[6] = z * x * (1 - c) - y * s;
    out[7] = z * y * (1 - c) + x * s;
    out[8] = c + z * z * (1 - c);
}

#endif
