/* SPDX-License-Identifier: MIT */
/* Families of servos: their names, registers, and where a servo of one is looked for. */
#ifndef GRCTL_FAMILY_H
#define GRCTL_FAMILY_H

#include <grobo/driver.h>
#include <grobo/registers.h>

typedef struct family {
    const char *name;               /* "sts", as --family takes it */
    const grobo_protocol *protocol; /* of its own bus */
    const grobo_servo_table *table; /* of its registers */
    int usual_bps[3];               /* rates at which they are found; 0: no more */
    /* The driver of a robot of such servos. */
    int (*driver)(grobo_driver *driver, const grobo_model *model);
} family;

/* Family number i; NULL behind the last. */
const family *family_row(size_t i);

/*
 * A driver to look for servos of a family with: its one joint has the highest id and is nobody's.
 * Static: until the next call.
 */
const grobo_driver *family_driver(const family *f);

/* Whether a driver's servos may be of the family of this name; behind a board are RS30x. */
bool family_is(const grobo_driver *driver, const char *name);

/* The family of a servo. */
const char *family_of(const grobo_servo_model *servo);

/* The family of a driver's servos: of its first joint, where it has several. */
const char *family_name(const grobo_driver *driver);

/*
 * The servo of a driver's joint by its id; of an id that is no joint's, and of a joint whose servo
 * is not named, the first model of the family. NULL: the family has no registers.
 */
const grobo_servo_model *family_servo(const grobo_driver *driver, int id);

/* The servo of this number; NULL: not known. */
const grobo_servo_model *family_numbered(const grobo_driver *driver, uint16_t number);

/* The run of registers that tells what a servo is: model and firmware; where a family has none, the
 * id. Returns its bytes, at most FAMILY_IDENTITY_BYTES; 0: there is none. */
enum { FAMILY_IDENTITY_BYTES = 16 };
int family_identity(const grobo_servo_model *servo, uint16_t *address);

/* As family_numbered(), of the bytes in register MODEL, whose order the series decides. */
const grobo_servo_model *family_identify(const grobo_driver *driver, const uint8_t *bytes);

#endif
