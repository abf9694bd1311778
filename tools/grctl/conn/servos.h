/* SPDX-License-Identifier: MIT */
/* Single servos by their id: asking for registers, quickly where nobody may be there. */
#ifndef GRCTL_SERVOS_H
#define GRCTL_SERVOS_H

#include "tools/grctl/conn/conn.h"

/*
 * Reads `length` registers of a servo into data.
 * Returns GROBO_OK or the error; nothing is said.
 */
int servos_read(conn *c, int id, int address, int length, uint8_t *data);

/*
 * Which servo an id is: a joint's as the robot has it, another one as it says; where neither is
 * known, the first of its family. NULL: its family has no registers. Returns GROBO_OK or the error.
 */
int servos_model(conn *c, int id, const grobo_servo_model **servo);

/* The value of one register, in its counts; as above. */
int servos_get(conn *c, int id, const grobo_servo_model *servo, const grobo_servo_register *reg,
               int32_t *value);

/* Whether a servo holds, a grobo_torque. GROBO_ERR_UNSUPPORTED: it does not tell. As above. */
int servos_torque(conn *c, int id, const grobo_servo_model *servo, int32_t *torque);

/* Registers of a servo, each taken when it was read. */
typedef struct servos_visit {
    bool (*wants)(const grobo_servo_register *reg);
    void (*take)(void *ctx, const grobo_servo_register *reg, int32_t value);
    void *ctx;
} servos_visit;

/* Reads those that are wanted, by rising address, in as few frames as the family can; those that
 * can be written only are left out. Returns GROBO_OK or the error. */
int servos_each(conn *c, int id, const grobo_servo_model *servo, const servos_visit *visit);

/*
 * Writes it, where several are written in one piece with the others as they are. As above; a value
 * that the register does not take is GROBO_ERR_LIMIT. Of a servo that is silent it is read back.
 */
int servos_put(conn *c, int id, const grobo_servo_model *servo, const grobo_servo_register *reg,
               int32_t value);

/* Beyond the wire's time, where a reply is sure to be wanted and the host may be busy. */
enum { SERVOS_PATIENT_US = 30000 };

/*
 * From now on a reply of `length` registers is waited for no longer than the wire takes at this
 * speed, and margin_us more (over a network longer), and so often again (-1: never), unless the
 * command line says otherwise. *timeout_us, where not NULL: how long that is in all. Returns
 * GROBO_OK or the error.
 */
int servos_wait(conn *c, int baud_bps, int length, uint32_t margin_us, int retries,
                uint32_t *timeout_us);

/* Reads an id of the command line: one of the robot's protocol, or a joint's name. -1: *status is
 * set. */
int servos_parse_id(app *a, const char *text, int *status);

#endif
