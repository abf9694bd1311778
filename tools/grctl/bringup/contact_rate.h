/* SPDX-License-Identifier: MIT */
#ifndef GRCTL_CONTACT_RATE_H
#define GRCTL_CONTACT_RATE_H

#include "tools/grctl/bringup/contact_step.h"

/* Another baud rate and back, where the person wants it. Returns the exit status. */
int contact_try_rates(contact *k);

#endif
