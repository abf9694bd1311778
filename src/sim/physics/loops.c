/* SPDX-License-Identifier: MIT */
/*
 * Position loops, by the registers that a model has, whatever its family. Where a manual gives a
 * unit it is used, where a work has measured one (grobo_sim_motor.duty_per_rad) that; docs/
 * simulator.md lists which gains are neither.
 */

#include "src/sim/physics/loops.h"
#include "src/sim/physics/physics.h"
#include "src/sim/servo/registers.h"

#define PI 3.14159265358979323846
#define RAD(deg) ((deg)*PI / 180)

/* X series: PWM counts for an error of one count of position, a turn of them (manual of the series:
 * P / 128, I / 65536, D / 16; the first is 256 by the identified XL330). */
#define X_PWM 885.0
#define X_TURN 4096.0
#define X_P 256.0
#define X_I 65536.0
#define X_D 16.0
#define X_RATE_HZ 1000.0 /* of its loop. An assumption */
#define X_P_CHOSEN 800.0 /* of most X: for P and PRO(A) without a factory gain, for PRO at theirs */
/* MX with Protocol 1.0: P / 8, I * 1000 / 2048, D * 4 / 1000 (manual). */
#define MX_P 8.0
#define MX_I (1000.0 / 2048)
#define MX_D (4.0 / 1000)
/* Where nobody has identified the duty of an MX at an error: as MX-64 and MX-106. */
#define MX_DUTY 0.158
/* Feetech's, where nobody has: as STS3215. Its fit has the D that it was made with inside. */
#define STS_DUTY 0.166
#define STS_D_FITTED 32
#define STS_RATE_HZ 1000.0 /* an assumption */
/* Futaba's and Kondo's units are printed, Hiwonder has no registers: all of this is chosen. */
#define ICS_SLOPE_DEG 90.0 /* full duty at this, divided by the stretch */
#define LX_SLOPE_DEG 8.0
#define OVERLOAD 0.8

static const grobo_servo_register *row(const grobo_sim_servo *servo, const char *name)
{
    return grobo_servo_register_named(servo->model, name);
}

/* The value of a register; `none` where the model has none of this name. */
static double value(const grobo_sim_servo *servo, const char *name, double none)
{
    const grobo_servo_register *reg = row(servo, name);
    return reg == NULL ? none
                       : grobo_servo_register_get(servo->model, reg, &servo->reg[reg->address]);
}

static double tick_rad(const grobo_sim_servo *servo)
{
    return RAD(grobo_i_dxl_tick_mdeg(servo) / 1000);
}

/* AX and RS30x: compliance. Sides are those of the shaft. */
static void compliance(const grobo_sim_servo *servo, grobo_i_loop *loop)
{
    bool degrees = grobo_i_same_text(row(servo, "cw_slope")->unit, "1 deg");
    const char *const margins[] = {"cw_margin", "ccw_margin"};
    const char *const slopes[] = {"cw_slope", "ccw_slope"};
    for (int side = 0; side < 2; side++) {
        double margin = value(servo, margins[side], 0), slope = value(servo, slopes[side], 0);
        loop->dead_rad[side] = degrees ? RAD(margin / 10) : margin * tick_rad(servo);
        loop->slope_rad[side] = degrees ? RAD(slope) : slope * tick_rad(servo);
        if (loop->slope_rad[side] <= 0) { /* none: full at once */
            loop->slope_rad[side] = tick_rad(servo);
        }
    }
    loop->punch = value(servo, "punch", 0) / (degrees ? 10000 : 1023);
}

static void feetech(const grobo_sim_servo *servo, const grobo_sim_motor *motor, grobo_i_loop *loop)
{
    double duty = motor->duty_per_rad > 0 ? motor->duty_per_rad : STS_DUTY;
    loop->kp = value(servo, "position_p", 0) * duty;
    loop->ki = value(servo, "position_i", 0) * duty;
    loop->kd = (value(servo, "position_d", STS_D_FITTED) - STS_D_FITTED) * duty / STS_RATE_HZ;
    loop->dead_rad[0] = value(servo, "cw_dead_zone", 0) * tick_rad(servo);
    loop->dead_rad[1] = value(servo, "ccw_dead_zone", 0) * tick_rad(servo);
    loop->punch = value(servo, "startup_force", 0) / 1000;
    loop->strained_by_duty = true; /* its load register is the duty */
}

static void x_series(const grobo_sim_servo *servo, const grobo_sim_motor *motor, grobo_i_loop *loop)
{
    double counts = X_TURN / (2 * PI) / X_PWM, gain = value(servo, "position_p", 0);
    double duty = motor->duty_per_rad > 0 ? motor->duty_per_rad : counts / X_P;
    int32_t factory = row(servo, "position_p")->factory;
    bool untold = gain == 0 && factory == 0;
    if (factory > 0 && row(servo, "position_i") == NULL) { /* PRO: a unit that nobody tells */
        gain *= X_P_CHOSEN / factory;
    }
    loop->kp = (untold ? X_P_CHOSEN : gain) * duty;
    loop->ki = value(servo, "position_i", 0) / X_I * counts * X_RATE_HZ;
    loop->kd = value(servo, "position_d", 0) / X_D * counts / X_RATE_HZ;
}

static void mx(const grobo_sim_servo *servo, const grobo_sim_motor *motor, grobo_i_loop *loop)
{
    double duty = motor->duty_per_rad > 0 ? motor->duty_per_rad : MX_DUTY;
    loop->kp = value(servo, "position_p", 0) * duty;
    loop->ki = value(servo, "position_i", 0) * MX_I * duty * MX_P;
    loop->kd = value(servo, "position_d", 0) * MX_D * duty * MX_P;
}

static void kondo(const grobo_sim_servo *servo, grobo_i_loop *loop)
{
    double stretch = value(servo, "stretch_now", 1);
    for (int side = 0; side < 2; side++) {
        loop->dead_rad[side] = value(servo, "dead_band", 0) * tick_rad(servo);
        loop->slope_rad[side] = RAD(ICS_SLOPE_DEG / (stretch < 1 ? 1 : stretch));
    }
    loop->punch = value(servo, "punch", 0) / 100;
}

static double x_current_max_a(const grobo_sim_servo *servo)
{
    const grobo_servo_register *goal =
        grobo_servo_register_of(servo->model, GROBO_ROLE_GOAL_CURRENT);
    return goal != NULL && servo->plant.most_ma < servo->plant.stall_ma
               ? servo->plant.most_ma / 1000.0
               : 0;
}

void grobo_i_loop_read(const grobo_sim_servo *servo, const grobo_sim_motor *motor,
                       grobo_i_loop *loop)
{
    grobo_i_body *body = servo->body;
    *loop = (grobo_i_loop){.duty_max = motor->duty_max};
    body->strained_at = OVERLOAD;
    double part = (double)servo->plant.most_ma / servo->plant.stall_ma;
    if (row(servo, "cw_slope") != NULL) {
        compliance(servo, loop);
    } else if (row(servo, "startup_force") != NULL) {
        feetech(servo, motor, loop);
        body->strained_at = value(servo, "overload_torque", 100 * OVERLOAD) / 100;
    } else if (row(servo, "goal_pwm") != NULL) {
        x_series(servo, motor, loop);
        loop->current_max_a = x_current_max_a(servo);
        part = value(servo, "goal_pwm", X_PWM) / X_PWM;
        part = part < 0 ? -part : part;
    } else if (row(servo, "position_p") != NULL) {
        mx(servo, motor, loop);
    } else if (row(servo, "stretch_now") != NULL) {
        kondo(servo, loop);
    } else {
        loop->slope_rad[0] = loop->slope_rad[1] = RAD(LX_SLOPE_DEG);
    }
    loop->duty_max *= part > 1 ? 1 : part;
}
