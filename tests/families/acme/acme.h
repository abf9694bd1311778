/* SPDX-License-Identifier: MIT */
/*
 * An invented family of servos, whose directory a stranger would write (docs/guide/own-servo.md).
 * A frame is C5 id n op data sum of a host, and 5C id n error data sum of a servo: n counts op or
 * error and data, the sum is the xor of what stands between, with 5A. Operations are those of
 * DYNAMIXEL, registers have addresses of one byte.
 */
#ifndef GROBO_SERVO_ACME_H
#define GROBO_SERVO_ACME_H

#include <grobo/core/driver.h>
#include <grobo/core/dxl2.h>

enum { ACME_OVERHEAD_BYTES = 5, ACME_FRAME_MAX_BYTES = 120, ACME_ID_MAX = 99, ACME_ID_ALL = 255 };

/* Bits of an error, and of the register error. */
enum { ACME_REFUSED = 1, ACME_OVERHEATED = 4 };

extern const grobo_servo_table grobo_i_acme_table;
extern const grobo_protocol grobo_i_acme_protocol;

/* The frame that n bytes begin with, as grobo_protocol.measure. */
int grobo_i_acme_measure(const uint8_t *bytes, size_t n, unsigned accept);
/* Frames as the driver of registers has them; a reply is taken apart too. */
int grobo_i_acme_build(const grobo_dxl2_packet *packet, uint8_t *buf, size_t cap);
int grobo_i_acme_parse(const uint8_t *frame, size_t n, uint8_t *data, size_t cap,
                       grobo_dxl2_packet *packet);
/* What a servo answers. */
int grobo_i_acme_answer(uint8_t id, uint8_t error, const uint8_t *data, size_t n, uint8_t *buf,
                        size_t cap);
/* The sum that a frame should have. */
uint8_t grobo_i_acme_sum(const uint8_t *frame, size_t n);

int grobo_i_acme_driver_init(grobo_driver *driver, const grobo_model *model);

#endif
