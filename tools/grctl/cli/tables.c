/* SPDX-License-Identifier: MIT */
/* The options that every command takes, and the commands, which main() tells. */
#include "tools/grctl/cli/cli.h"

const cli_command *const *cli_commands;
size_t cli_n_commands;

const cli_option cli_global_options[GLOBAL_COUNT] = {
    [GLOBAL_DEVICE] =
        OPTION_TEXT("device", 'd', "DEV",
                    "a port, auto, sim, tcp:HOST:PORT or a configured name; else $GRCTL_DEVICE"),
    [GLOBAL_ROBOT] = OPTION_TEXT(
        "robot", 0, "ROBOT", "which robot, by its name or file (gr001); see 'grctl robot list'"),
    [GLOBAL_LINE] = OPTION_TEXT("line", 0, "NAME",
                                "one line of a robot that has several, as a robot of its own"),
    [GLOBAL_BAUD] =
        OPTION_WHOLE("baud", 'b', "N", 9600, 4000000, "bits per second of the line (the robot's)"),
    [GLOBAL_WIRING] = OPTION_CHOICE("wiring", 0, "board|bus",
                                    "through GR001's board, or servos straight on a bus"),
    [GLOBAL_ECHO] =
        OPTION_FLAG("echo", 0, "the bus's adapter returns what is sent: one wire both ways"),
    [GLOBAL_PHYSICS] = OPTION_CHOICE("physics", 0, "auto|off|on",
                                     "weight, friction and motors of a simulated robot, or shafts "
                                     "that are where they are told; auto: as $GRCTL_PHYSICS says, "
                                     "else weight where the robot's file has masses"),
    [GLOBAL_JSON] = OPTION_FLAG("json", 0, "results as JSON, one object a line"),
    [GLOBAL_QUIET] = OPTION_FLAG("quiet", 'q', "errors only"),
    [GLOBAL_VERBOSE] =
        OPTION_FLAG("verbose", 'v', "more: the bytes of a failure; twice: every byte"),
    [GLOBAL_TRACE] =
        OPTION_TEXT("trace", 0, "FILE", "write every byte with its time and direction, as pcapng"),
    [GLOBAL_TIMEOUT] = {.name = "timeout", /* --time is how long a move takes, for some commands */
                        .kind = CLI_NUMBER,
                        .value = "MS",
                        .help = "time to wait for a reply (computed from the baud rate)",
                        .min = 1,
                        .max = 60000,
                        .whole = true},
    [GLOBAL_RETRIES] = OPTION_WHOLE("retries", 0, "N", 0, 20, "number of retries (2)"),
    [GLOBAL_ON_EXIT] = OPTION_CHOICE("on-exit", 0, "off|hold|sit",
                                     "what the servos do when the command ends or dies (hold)"),
    [GLOBAL_YES] = OPTION_FLAG("yes", 'y', "ask no questions"),
    [GLOBAL_COLOR] =
        OPTION_CHOICE("color", 0, "auto|always|never", "colours; NO_COLOR is honoured"),
    [GLOBAL_HELP] = OPTION_FLAG("help", 'h', "this help"),
    [GLOBAL_VERSION] = OPTION_FLAG("version", 'V', "print the version"),
};
