/* SPDX-License-Identifier: MIT */
/* The equations of a servo, at its shaft: position loop, motor, friction. Pure functions. */
#ifndef GROBO_SIM_MOTOR_H
#define GROBO_SIM_MOTOR_H

#include <grobo/core/sim_physics.h>

/* A position loop as its registers have it. Errors in radians of the servo's shaft. */
typedef struct grobo_i_loop {
    double kp;             /* duty for 1 rad */
    double ki;             /* duty a second for 1 rad */
    double kd;             /* duty for 1 rad/s */
    double dead_rad[2];    /* no output within: errors below 0, above */
    double slope_rad[2];   /* full duty so far behind the dead zone; 0: kp counts */
    double punch;          /* the least duty outside of the dead zone */
    double duty_max;       /* 0..1 */
    double current_max_a;  /* 0: no limit */
    bool strained_by_duty; /* overload is judged by duty, else by current */
} grobo_i_loop;

/* The duty for an error; `integral` is of the error in rad s, bounded by what the duty can use. */
double grobo_i_loop_duty(const grobo_i_loop *loop, double error_rad, double speed_error_rad_s,
                         double *integral);

/* Torque of a motor at volts and speed. */
double grobo_i_motor_torque(const grobo_sim_motor *motor, double applied_v, double speed_rad_s);

/* The largest friction that can act: motor and external torque, speed. */
double grobo_i_motor_friction(const grobo_sim_friction *friction, double motor_nm,
                              double external_nm, double speed_rad_s);

#endif
