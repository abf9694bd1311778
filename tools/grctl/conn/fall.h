/* SPDX-License-Identifier: MIT */
/*
 * Torque off is a fall: which joints drop, and how far, by the masses of the robot's file. Where
 * the file has no masses nothing is known, and nothing is said.
 */
#ifndef GRCTL_FALL_H
#define GRCTL_FALL_H

#include "tools/grctl/conn/conn.h"

/* Names in a note the joints that drop when these lose their torque where they were read last; the
 * others hold. A joint that is without torque now is none of them. False where none drops. */
bool fall_note(conn *c, grobo_joint_mask joints);

/* The same, and where somebody can answer and did not say --yes, a question. Returns 0, or the exit
 * status of a command that is not to go on, with the reason said. */
int fall_ask(conn *c, grobo_joint_mask joints, const char *command);

#endif
