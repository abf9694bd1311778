/* SPDX-License-Identifier: MIT */
/* Completion for fish, made from the tables. */
#include <string.h>

#include <grobo/model.h>

#include "tools/grctl/cli/cli.h"

/* Inside '...', where fish knows \' and \\ only. */
static void put(FILE *to, const char *text)
{
    for (; *text; text++) {
        if (*text == '\'' || *text == '\\')
            putc('\\', to);
        putc(*text, to);
    }
}

static void put_words(FILE *to, const char *words, size_t length)
{
    fputs(" -a '", to);
    for (size_t i = 0; i < length; i++)
        putc(words[i] == '|' ? ' ' : words[i], to);
    putc('\'', to);
}

/* What completes an argument or a value, as options of `complete`. */
static const char *source(cli_argument argument)
{
    switch (argument) {
    case CLI_ARG_NONE:
    case CLI_ARG_WORD:
        return " -f";
    case CLI_ARG_COMMAND:
        return " -f -a \"$__grctl_commands\"";
    case CLI_ARG_JOINT:
        return " -f -a \"$__grctl_joints\"";
    case CLI_ARG_FILE:
        return " -F";
    case CLI_ARG_DEVICE:
        return " -F -a 'auto sim'";
    }
    return " -f";
}

static void put_options(FILE *to, const char *command, const cli_option *options, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const cli_option *o = &options[i];
        fputs("complete -c grctl", to);
        if (command)
            fprintf(to, " -n '__fish_seen_subcommand_from %s'", command);
        if (o->letter)
            fprintf(to, " -s %c", o->letter);
        fprintf(to, " -l %s", o->name);
        if (o->kind == CLI_CHOICE) {
            fputs(o->optional ? "" : " -x", to);
            put_words(to, o->value, strlen(o->value));
        } else if (o->kind != CLI_FLAG) {
            fprintf(to, " -r%s", source(cli_option_argument(o)));
        }
        fputs(" -d '", to);
        put(to, o->help);
        fputs("'\n", to);
    }
}

static void put_command(FILE *to, const cli_command *c)
{
    size_t length;
    const char *first = cli_first_argument(c, &length);
    fprintf(to, "complete -c grctl -n __fish_use_subcommand -a %s -d '", c->name);
    put(to, c->summary);
    fputs("'\n", to);
    if (first) {
        fprintf(to, "complete -c grctl -n '__fish_seen_subcommand_from %s'", c->name);
        put_words(to, first, length);
        putc('\n', to);
    }
    if (c->argument == CLI_ARG_JOINT || c->argument == CLI_ARG_FILE ||
        c->argument == CLI_ARG_COMMAND)
        fprintf(to, "complete -c grctl -n '__fish_seen_subcommand_from %s'%s\n", c->name,
                source(c->argument));
    put_options(to, c->name, c->options, c->n_options);
}

void cli_print_fish(FILE *to)
{
    const grobo_model *model = &grobo_gr001_model;
    fputs("# fish completion for grctl; made by 'grctl completion fish'.\nset -g __grctl_joints",
          to);
    for (int i = 0; i < model->n_groups; i++)
        fprintf(to, " %s", model->groups[i].name);
    for (int i = 0; i < model->n_joints; i++)
        fprintf(to, " %s", model->joints[i].name);
    fputs("\nset -g __grctl_commands", to);
    for (size_t i = 0; i < cli_n_commands; i++)
        fprintf(to, " %s", cli_commands[i]->name);
    fputs("\ncomplete -c grctl -f\n", to);
    put_options(to, NULL, cli_global_options, GLOBAL_COUNT);
    for (size_t i = 0; i < cli_n_commands; i++)
        put_command(to, cli_commands[i]);
}
