/* SPDX-License-Identifier: MIT */
/* The functions of grobo_driver for robots of RS30x servos; driver.h says what each does. */
#ifndef GROBO_CORE_RS30X_DRIVER_H
#define GROBO_CORE_RS30X_DRIVER_H

#include <grobo/core/driver.h>
#include <grobo/core/rs30x.h>
#include <grobo/core/sequencer.h>

int grobo_i_rs30x_check(const grobo_driver *self, void *ctx, int part, grobo_exchange *exchange);
int grobo_i_rs30x_posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                          grobo_exchange *exchange);
int grobo_i_rs30x_torque(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                         grobo_torque mode, int part, grobo_exchange *exchange);
int grobo_i_rs30x_sense(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                        grobo_exchange *exchange);
int grobo_i_rs30x_parse(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                        grobo_joint_state *state);
grobo_write_kind grobo_i_rs30x_write_kind(const grobo_driver *self, const grobo_register_io *io);
int grobo_i_rs30x_registers(const grobo_driver *self, void *ctx, const grobo_register_io *io,
                            grobo_exchange *exchange);
int grobo_i_rs30x_command(const grobo_driver *self, void *ctx, int id, grobo_servo_command command,
                          grobo_exchange *exchange);
int grobo_i_rs30x_stored(const grobo_driver *self, void *ctx, grobo_stored_kind kind, int number,
                         grobo_exchange *exchange);
int grobo_i_rs30x_inspect(const grobo_driver *self, void *ctx, const uint8_t *frame, size_t size,
                          grobo_target *target, grobo_joint_mask *torqued);

/* What every table of RS30x servos has: for use in its initialiser. */
#define GROBO_I_RS30X_FUNCTIONS                                                                    \
    .time_step_us = GROBO_PLAY_TIME_UNIT_US, .time_max_us = GROBO_PLAY_TIME_MAX_US,                \
    .angle_step_rad = 0.1 * 0.017453292519943295, .check = grobo_i_rs30x_check,                    \
    .posture = grobo_i_rs30x_posture, .torque = grobo_i_rs30x_torque,                              \
    .sense = grobo_i_rs30x_sense, .parse = grobo_i_rs30x_parse,                                    \
    .write_kind = grobo_i_rs30x_write_kind, .registers = grobo_i_rs30x_registers,                  \
    .command = grobo_i_rs30x_command, .inspect = grobo_i_rs30x_inspect,                            \
    .timed_posture = grobo_i_rs30x_posture

#endif
