/* SPDX-License-Identifier: MIT */
/* Every command: each stands in a file of its name, or of its family's. */
#ifndef GRCTL_COMMANDS_H
#define GRCTL_COMMANDS_H

#include <stdint.h>

#include "tools/grctl/cli/cli.h"

struct app;
/* The robots of app.group, a line each, until a signal or q. The exit status. */
int monitor_group(struct app *a, int64_t interval_us);

/* In the order of the overview; the first of each group has its heading. */
#define GRCTL_COMMANDS(X)                                                                          \
    X(setup)                                                                                       \
    X(ports)                                                                                       \
    X(doctor)                                                                                      \
    X(first_contact)                                                                               \
    X(scan)                                                                                        \
    X(calibrate)                                                                                   \
    X(info)                                                                                        \
    X(joints)                                                                                      \
    X(robot)                                                                                       \
    X(status)                                                                                      \
    X(monitor)                                                                                     \
    X(serve)                                                                                       \
    X(servo)                                                                                       \
    X(init)                                                                                        \
    X(move)                                                                                        \
    X(pose)                                                                                        \
    X(drive)                                                                                       \
    X(follow)                                                                                      \
    X(stop)                                                                                        \
    X(estop)                                                                                       \
    X(play)                                                                                        \
    X(record)                                                                                      \
    X(teach)                                                                                       \
    X(check)                                                                                       \
    X(show)                                                                                        \
    X(plot)                                                                                        \
    X(convert)                                                                                     \
    X(slot)                                                                                        \
    X(scenario)                                                                                    \
    X(servo_get)                                                                                   \
    X(servo_set)                                                                                   \
    X(budget)                                                                                      \
    X(decode)                                                                                      \
    X(replay)                                                                                      \
    X(sim)                                                                                         \
    X(agent)                                                                                       \
    X(fleet)                                                                                       \
    X(shell)                                                                                       \
    X(completion)                                                                                  \
    X(help)                                                                                        \
    X(version)

#define GRCTL_DECLARE(name) extern const cli_command cmd_##name;
GRCTL_COMMANDS(GRCTL_DECLARE)
#undef GRCTL_DECLARE

#endif
