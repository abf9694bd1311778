/* SPDX-License-Identifier: MIT */
#include <locale.h>
#include <string.h>

#include <grobo/version.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cli/commands.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/run.h"
#include "tools/grctl/conn/guard.h"
#include "tools/grctl/os/os.h"

const cli_option cli_global_options[GLOBAL_COUNT] = {
    [GLOBAL_DEVICE] =
        {.name = "device",
         .letter = 'd',
         .kind = CLI_TEXT,
         .value = "DEV",
         .help = "a port, auto, sim, tcp:HOST:PORT or a configured name; else $GRCTL_DEVICE"},
    [GLOBAL_BAUD] = {.name = "baud",
                     .letter = 'b',
                     .kind = CLI_NUMBER,
                     .value = "N",
                     .help = "bits per second of the line (115200)",
                     .min = 9600,
                     .max = 4000000},
    [GLOBAL_WIRING] = {.name = "wiring",
                       .kind = CLI_CHOICE,
                       .value = "board|bus",
                       .help = "through GR001's board, or servos straight on a bus"},
    [GLOBAL_ECHO] = {.name = "echo",
                     .kind = CLI_FLAG,
                     .help = "the bus's adapter returns what is sent: one wire both ways"},
    [GLOBAL_JSON] = {.name = "json",
                     .kind = CLI_FLAG,
                     .help = "results as JSON, one object a line"},
    [GLOBAL_QUIET] = {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .help = "errors only"},
    [GLOBAL_VERBOSE] = {.name = "verbose",
                        .letter = 'v',
                        .kind = CLI_FLAG,
                        .help = "more: the bytes of a failure; twice: every byte"},
    [GLOBAL_TRACE] = {.name = "trace",
                      .kind = CLI_TEXT,
                      .value = "FILE",
                      .help = "write every byte with its time and direction, as pcapng"},
    [GLOBAL_TIMEOUT] = {.name = "timeout",
                        .kind = CLI_NUMBER,
                        .value = "MS",
                        .help = "wait so long for a reply (computed from the baud rate)",
                        .min = 1,
                        .max = 60000},
    [GLOBAL_RETRIES] = {.name = "retries",
                        .kind = CLI_NUMBER,
                        .value = "N",
                        .help = "ask again so often (2)",
                        .min = 0,
                        .max = 20},
    [GLOBAL_ON_EXIT] = {.name = "on-exit",
                        .kind = CLI_CHOICE,
                        .value = "off|hold|sit",
                        .help = "what the servos do when the command ends or dies (hold)"},
    [GLOBAL_YES] = {.name = "yes", .letter = 'y', .kind = CLI_FLAG, .help = "no questions"},
    [GLOBAL_COLOR] = {.name = "color",
                      .kind = CLI_CHOICE,
                      .value = "auto|always|never",
                      .help = "colours; NO_COLOR is honoured"},
    [GLOBAL_HELP] = {.name = "help", .letter = 'h', .kind = CLI_FLAG, .help = "this help"},
    [GLOBAL_VERSION] = {.name = "version", .letter = 'V', .kind = CLI_FLAG, .help = "the version"},
};

#define POINTER(name) &cmd_##name,
const cli_command *const cli_commands[] = {GRCTL_COMMANDS(POINTER)};
#undef POINTER
const size_t cli_n_commands = sizeof cli_commands / sizeof cli_commands[0];

int main(int argc, char **argv)
{
    static app a;
    os_start();
    if (argc == 2 && strcmp(argv[1], "guard") == 0)
        return guard_main();
    guard_note_program(argv[0]);
    setlocale(LC_CTYPE, "");
    return output_finish(&a, run_line(&a, argc, argv, NULL, NULL));
}
