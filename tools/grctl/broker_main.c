/* SPDX-License-Identifier: MIT */
/* grctl-serve and grctl-fleet: they differ in what they are linked with, and have brokers. */
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/start.h"
#include "tools/grctl/fleet/mqtt.h"
#include "tools/grctl/fleet/mqtt_host.h"

#define POINTER(name) &cmd_##name,
static const cli_command *const commands[] = {GRCTL_COMMANDS(POINTER)};
#undef POINTER

int main(int argc, char **argv)
{
    static const start_program program = {.commands = commands,
                                          .n_commands = sizeof commands / sizeof commands[0],
                                          .word = MQTT_HOST_WORD,
                                          .run_word = mqtt_host_main};
    mqtt_note_program(argv[0]);
    return start(argc, argv, &program);
}
