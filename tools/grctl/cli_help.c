/* SPDX-License-Identifier: MIT */
/* Help texts, made from the tables. */
#include <string.h>

#include "cli.h"

enum { COLUMN = 26 };

static void print_option(FILE *to, const cli_option *o)
{
    char left[64];
    int n;
    if (o->letter)
        n = snprintf(left, sizeof left, "-%c, --%s", o->letter, o->name);
    else
        n = snprintf(left, sizeof left, "    --%s", o->name);
    if (o->kind != CLI_FLAG && n > 0 && (size_t)n < sizeof left)
        snprintf(left + n, sizeof left - (size_t)n, o->optional ? " [%s]" : " %s", o->value);
    if (strlen(left) < COLUMN)
        fprintf(to, "  %-*s  %s\n", COLUMN, left, o->help);
    else
        fprintf(to, "  %s\n  %-*s  %s\n", left, COLUMN, "", o->help);
}

static void print_global_options(FILE *to)
{
    fputs("\nGlobal options, before or after the command:\n", to);
    for (size_t i = 0; i < GLOBAL_COUNT; i++)
        print_option(to, &cli_global_options[i]);
}

void cli_print_overview(FILE *to)
{
    fputs("grctl drives serial command-servo robots, first of all the GR001 humanoid.\n\n"
          "usage: grctl [GLOBAL OPTIONS] COMMAND [OPTIONS] [ARGUMENTS]\n\nCommands:\n",
          to);
    for (size_t i = 0; i < cli_n_commands; i++)
        fprintf(to, "  %-12s%s\n", cli_commands[i]->name, cli_commands[i]->summary);
    print_global_options(to);
    fputs("\nA joint is named by name (R_KNEE_P), motor (m12) or joint id (j3); a group by name:\n"
          "all body right_arm left_arm arms right_leg left_leg legs, or by its number 0..7.\n"
          "Angles are degrees, times milliseconds. 'grctl help COMMAND' says more.\n",
          to);
}

void cli_print_command(FILE *to, const cli_command *command)
{
    fprintf(to, "grctl %s - %s\n\nusage: grctl %s%s%s%s\n\n%s", command->name, command->summary,
            command->name, command->n_options ? " [OPTIONS]" : "", *command->arguments ? " " : "",
            command->arguments, command->details);
    if (command->n_options) {
        fputs("\nOptions:\n", to);
        for (size_t i = 0; i < command->n_options; i++)
            print_option(to, &command->options[i]);
    }
    print_global_options(to);
    if (command->example)
        fprintf(to, "\nExamples:\n%s", command->example);
}
