/* SPDX-License-Identifier: MIT */
/* The ports of this machine for `-d auto`: what is tried, what is named, which was used last. */
#ifndef GRCTL_AUTO_PORTS_H
#define GRCTL_AUTO_PORTS_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/conn/choose.h"

/* The ports of this machine. Below 0 where the system cannot list them. */
int auto_ports(choice *all);
/* Names what is blocked, each with its fix; where there is no adapter, the UARTs with their -d. */
void auto_report(const app *a, const choice *all);
/* Notes that a robot was found on the device, and says so where `auto` chose it. */
void auto_used(const app *a, const char *device, bool is_auto);

#endif
