/* SPDX-License-Identifier: MIT */
/*
 * What a servo keeps over power-off, as a file: an object with id, model and registers by name, in
 * counts. Whoever is about to change it saves it first.
 */
#ifndef GRCTL_EEPROM_H
#define GRCTL_EEPROM_H

#include "tools/grctl/conn/conn.h"

enum { EEPROM_PATH_BYTES = 512 };

/*
 * Reads all registers of a servo that survive power-off and that can be written, and saves them to
 * a new file below the folder of the user's state. Returns 0 and its path, or the exit status with
 * the reason said: then nothing may be written.
 */
int eeprom_save(conn *c, int id, const grobo_servo_model *servo, char *path, size_t capacity);

/*
 * Reads such a file, for a servo of this model. Returns 0 and an object of registers, the caller's,
 * or the exit status with the reason said.
 */
int eeprom_load(app *a, const char *path, const grobo_servo_model *servo, json_t **registers);

#endif
