/* SPDX-License-Identifier: MIT */
/* Families of servos by their drivers: what a servo is, its registers, where it is looked for. */
#ifndef GRCTL_FAMILY_H
#define GRCTL_FAMILY_H

#include <grobo/core/driver.h>
#include <grobo/core/registers.h>
#include <grobo/robot_file.h>

/* Names for options, filled by family_list(): of the families, the same behind "all", and of all
 * series that frames are read of. */
enum { FAMILY_NAMES_BYTES = 512 };
extern char family_names[FAMILY_NAMES_BYTES];
extern char family_or_all[FAMILY_NAMES_BYTES];
extern char family_series[FAMILY_NAMES_BYTES];
void family_list(void);

/* The family that a file names so, NULL: none. */
const grobo_robot_family *family_called(const char *name);

/* Rate number i at which servos of a family are looked for, the factory's first; 0 behind the
 * last. */
int family_usual_bps(const grobo_robot_family *family, size_t i);

/*
 * A driver to look for servos of a family with: its one joint has the highest id and is nobody's.
 * Static: until the next call.
 */
const grobo_driver *family_driver(const grobo_robot_family *family);

/* The family that has a servo; NULL: none. */
const grobo_robot_family *family_of_servo(const grobo_servo_model *servo);

/* Whether a driver's servos are of the family of this name. */
bool family_is(const grobo_driver *driver, const char *name);

/*
 * The servo of a driver's joint by its id; of an id that is no joint's what all of the family have,
 * where that is described, else its first model, as of a joint whose servo is not named. NULL: the
 * family has no registers.
 */
const grobo_servo_model *family_servo(const grobo_driver *driver, int id);

/* Whether a model stands for all of its series: one whose number is not known. */
bool family_is_any(const grobo_servo_model *servo);

/* The servo of this name in a family, NULL: none. */
const grobo_servo_model *family_model(const grobo_robot_family *family, const char *name);

/* The servo of a joint; NULL: not named, or of no family. */
const grobo_servo_model *family_joint_servo(const grobo_driver *driver, int joint);

/* The servo of this number, of those that the robot's joints name, else of the family; NULL: not
 * known. */
const grobo_servo_model *family_numbered(const grobo_driver *driver, uint16_t number);

/*
 * The registers that are read together with one: some families read several in one piece only.
 * From *address on; returns their bytes, at most FAMILY_PIECE_BYTES; 0: it cannot be read.
 */
enum { FAMILY_PIECE_BYTES = 160 };
int family_piece(const grobo_driver *driver, const grobo_servo_model *servo,
                 const grobo_servo_register *reg, uint16_t *address);

/*
 * How many registers, from number `first` on, are read at once: as many as fit into `most` bytes,
 * or into the one piece that they are read in. 0: number `first` cannot be read.
 */
int family_block(const grobo_driver *driver, const grobo_servo_model *servo, size_t first,
                 int most);

/* The run of registers that tells what a servo is: model and firmware; where a family has none, the
 * id. As family_piece(). */
int family_identity(const grobo_driver *driver, const grobo_servo_model *servo, uint16_t *address);

/* As family_numbered(), of the bytes in register MODEL, whose order the series decides. */
const grobo_servo_model *family_identify(const grobo_driver *driver, const uint8_t *bytes);

#endif
