/* SPDX-License-Identifier: MIT */
/* Moves, currents, temperatures: functions of time, or of a world with weight (world.h). */
#ifndef GROBO_SIM_SHAFT_H
#define GROBO_SIM_SHAFT_H

#include <grobo/core/sim_static.h>

int32_t grobo_i_sim_angle_mdeg(const grobo_sim_servo *servo, int64_t t_us);
/* What the servo's plan is: where its shaft is without weight, and what its loop follows with. */
double grobo_i_sim_planned_mdeg(const grobo_sim_servo *servo, int64_t t_us);
double grobo_i_sim_planned_mdeg_s(const grobo_sim_servo *servo, int64_t t_us);
int32_t grobo_i_sim_speed_dps(const grobo_sim_servo *servo, int64_t t_us);
/* Signed, unrounded. */
double grobo_i_sim_speed_mdeg_s(const grobo_sim_servo *servo, int64_t t_us);
int32_t grobo_i_sim_current_ma(const grobo_sim_servo *servo, int64_t t_us);
int64_t grobo_i_sim_move_age_us(const grobo_sim_servo *servo, int64_t t_us);
bool grobo_i_sim_moving(const grobo_sim_servo *servo, int64_t t_us);
int32_t grobo_i_sim_mdeg_of_rad(double angle_rad);
/* How hard the motor works, 0..1 of its most, and since when it has worked harder than its
 * registers say is too much: GROBO_NEVER_US where it does not. */
double grobo_i_sim_strain(const grobo_sim_servo *servo);
int64_t grobo_i_sim_strained_us(const grobo_sim_servo *servo);
/* Moves towards the goal of the plant from here on; stops and stays here. */
void grobo_i_sim_drive(grobo_sim *sim, int servo);
void grobo_i_sim_halt(grobo_sim *sim, int servo);
/* The same where the shaft is, which may be elsewhere than its plan. */
void grobo_i_sim_rest(grobo_sim *sim, int servo);
/* Moves to the goal of its registers in the plant's time, but from under a hand later. */
void grobo_i_sim_set_out(grobo_sim *sim, int servo);
/* What the servo does goes on from where it is, under what has changed. */
void grobo_i_sim_go_on(grobo_sim *sim, int servo);
/* Torque goes from what it was to the value in its plant. */
void grobo_i_sim_torque(grobo_sim *sim, int servo, grobo_torque before);
/* Warms or cools up to until_us; torque goes where it gets too hot. */
void grobo_i_sim_warm(grobo_sim *sim, int servo, int64_t until_us);
/* Does so by this current until now. */
void grobo_i_sim_warm_by(grobo_sim *sim, int servo, double ma);

#endif
