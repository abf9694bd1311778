/* SPDX-License-Identifier: MIT */
/* Two reports of a first contact beside each other: a real robot's and the simulator's. */
#ifndef GRCTL_CONTACT_COMPARE_H
#define GRCTL_CONTACT_COMPARE_H

#include "tools/grctl/bringup/contact_step.h"

/* Reads a report, PREFIX.json, of this robot. Returns 0, or the exit status, the reason said. */
int contact_read_report(app *a, const char *path, json_t **report);
/*
 * Says and keeps what differs from it, and returns that as JSON: verdicts of steps, models,
 * firmware, and registers that a servo keeps without power. What is measured differs each time, and
 * is left out.
 */
json_t *contact_compare(contact *k, const json_t *other);

#endif
