/* SPDX-License-Identifier: MIT */
/* Every command, each in a file of its name. */
#ifndef GRCTL_COMMANDS_H
#define GRCTL_COMMANDS_H

#include "cli.h"

extern const cli_command cmd_check;
extern const cli_command cmd_convert;
extern const cli_command cmd_estop;
extern const cli_command cmd_help;
extern const cli_command cmd_info;
extern const cli_command cmd_init;
extern const cli_command cmd_move;
extern const cli_command cmd_play;
extern const cli_command cmd_plot;
extern const cli_command cmd_ports;
extern const cli_command cmd_pose;
extern const cli_command cmd_scan;
extern const cli_command cmd_scenario;
extern const cli_command cmd_servo;
extern const cli_command cmd_servo_get;
extern const cli_command cmd_servo_set;
extern const cli_command cmd_show;
extern const cli_command cmd_sim;
extern const cli_command cmd_slot;
extern const cli_command cmd_status;
extern const cli_command cmd_stop;
extern const cli_command cmd_version;

#endif
