/* SPDX-License-Identifier: MIT */
/*
 * The equations of a servo. Motor and friction: Duclusaud and others, Extended Friction Models for
 * the Physics Simulation of Servo Actuators (ICRA 2025, arXiv 2410.08650). Dead zone, slope, punch:
 * the manuals of Futaba RS30x and DYNAMIXEL AX.
 */
#include <math.h>

#include "src/sim/physics/motor.h"

static double clamp(double x, double most)
{
    return x < -most ? -most : x > most ? most : x;
}

double grobo_i_loop_duty(const grobo_i_loop *loop, double error_rad, double speed_error_rad_s,
                         double *integral)
{
    bool above = error_rad > 0;
    double beyond = fabs(error_rad) - loop->dead_rad[above];
    double duty = 0;
    if (beyond > 0 && loop->slope_rad[above] > 0) {
        duty = loop->punch + (1 - loop->punch) * beyond / loop->slope_rad[above];
        duty = copysign(duty, error_rad);
    } else if (beyond > 0) {
        duty = loop->kp * fabs(error_rad);
        duty = copysign(duty < loop->punch ? loop->punch : duty, error_rad);
    }
    if (loop->ki > 0) {
        *integral = clamp(*integral, loop->duty_max / loop->ki);
        duty += loop->ki * *integral;
    }
    return clamp(duty + loop->kd * speed_error_rad_s, loop->duty_max);
}

double grobo_i_motor_torque(const grobo_sim_motor *motor, double applied_v, double speed_rad_s)
{
    return motor->kt_nm_a * (applied_v - motor->kt_nm_a * speed_rad_s) / motor->resistance_ohm;
}

double grobo_i_motor_friction(const grobo_sim_friction *f, double motor_nm, double external_nm,
                              double speed_rad_s)
{
    double most = f->base_nm + f->viscous_nms * fabs(speed_rad_s);
    if (f->stribeck_rad_s <= 0) {
        return most;
    }
    double slow = exp(-pow(fabs(speed_rad_s / f->stribeck_rad_s), f->stribeck_power));
    most += slow * f->stribeck_nm;
    most += fabs(external_nm * f->load_external - motor_nm * f->load_motor);
    most += slow * fabs(external_nm * f->load_external_s - motor_nm * f->load_motor_s);
    if ((external_nm < 0) != (motor_nm < 0)) {
        double e = fabs(external_nm), m = fabs(motor_nm);
        most += slow * (e < m ? f->square_external * e * e : e > m ? f->square_motor * m * m : 0);
    }
    return most;
}
