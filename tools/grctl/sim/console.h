/* SPDX-License-Identifier: MIT */
/* What happens to a simulated robot while it runs, told by a person: `sim`'s standard input. */
#ifndef GRCTL_SIM_CONSOLE_H
#define GRCTL_SIM_CONSOLE_H

#include <event2/event.h>

#include <grobo/core/sim_physics.h>
#include <grobo/sim_server.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/os/os.h"

enum { SIM_CONSOLE_BYTES = 256 };

typedef struct sim_console {
    app *a;
    struct event_base *base;
    const grobo_model *const *model; /* of each robot, borrowed */
    grobo_sim_server *const *server; /* n of them, borrowed */
    int n;
    const char *payload_link; /* of the robot; NULL: the last one */
    int robot;                /* the one that commands are for, from 0 */
    /* private */
    os_input input;
    char line[SIM_CONSOLE_BYTES];
    size_t used;
    bool too_long;
    char *word[4]; /* of the command being carried out */
    int n_words;
} sim_console;

/* The commands, for help. */
#define SIM_CONSOLE_HELP                                                                           \
    "  robot N                     the commands after this are for robot N\n"                      \
    "  fault KIND=RATE,...         as --fault\n"                                                   \
    "  silent SERVO on|off         it neither receives nor replies, but holds\n"                   \
    "  cable SERVO in|mute|out     out: no power, limp\n"                                          \
    "  block SERVO on|off          its shaft is held fast\n"                                       \
    "  turn SERVO DEG [MS]         a hand turns its shaft\n"                                       \
    "  load SERVO MA               extra current, as of a weight\n"                                \
    "  push SERVO NM               a hand pushes the joint (with weight)\n"                        \
    "  wall SERVO MIN MAX|off      walls on its shaft's way (with weight)\n"                       \
    "  payload KG [LINK]           a mass in the hand; 0: none (with weight)\n"                    \
    "  supply MOHM                 resistance of battery and wires (with weight)\n"                \
    "  temperature SERVO C         of its case\n"                                                  \
    "  id SERVO ID                 another id, also one in use\n"                                  \
    "  voltage V                   of the battery\n"                                               \
    "  plug in|out                 the host's cable\n"                                             \
    "  look [SERVO]                what it does\n"                                                 \
    "  quit\n"

/*
 * Listens for commands on standard input, if that is a pipe or a terminal that this process has in
 * the foreground; its end ends nothing. The fields above `private` are the caller's to fill.
 * False: no memory; sim_console_stop() follows all the same.
 */
bool sim_console_start(sim_console *console);
void sim_console_stop(sim_console *console);

#endif
