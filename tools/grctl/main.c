/* SPDX-License-Identifier: MIT */
/* The program grctl. */
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/start.h"

#define POINTER(name) &cmd_##name,
static const cli_command *const commands[] = {GRCTL_COMMANDS(POINTER)};
#undef POINTER

int main(int argc, char **argv)
{
    static const start_program grctl = {.commands = commands,
                                        .n_commands = sizeof commands / sizeof commands[0]};
    return start(argc, argv, &grctl);
}
