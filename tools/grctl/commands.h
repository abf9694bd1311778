/* SPDX-License-Identifier: MIT */
/* Every command, each in a file of its name. */
#ifndef GRCTL_COMMANDS_H
#define GRCTL_COMMANDS_H

#include "cli.h"

extern const cli_command cmd_help;
extern const cli_command cmd_ports;
extern const cli_command cmd_version;

#endif
