/* SPDX-License-Identifier: MIT */
/* Completion for zsh, made from the tables. */
#include <string.h>

#include <grobo/model.h>

#include "tools/grctl/cli/cli.h"

/* Inside '...', where _arguments gives : [ ] and \ a meaning. */
static void put(FILE *to, const char *text)
{
    for (; *text; text++) {
        if (*text == '\'')
            fputs("'\\''", to);
        else if (strchr(":[]\\", *text))
            fprintf(to, "\\%c", *text);
        else
            putc(*text, to);
    }
}

static const char *action(cli_argument argument)
{
    switch (argument) {
    case CLI_ARG_NONE:
    case CLI_ARG_WORD:
        return " ";
    case CLI_ARG_COMMAND:
        return "_grctl_commands";
    case CLI_ARG_JOINT:
        return "_grctl_joints";
    case CLI_ARG_FILE:
        return "_files";
    case CLI_ARG_DEVICE:
        return "_grctl_devices";
    }
    return " ";
}

static void put_choice(FILE *to, const char *words, size_t length)
{
    putc('(', to);
    for (size_t i = 0; i < length; i++)
        putc(words[i] == '|' ? ' ' : words[i], to);
    putc(')', to);
}

/* '(-s --speed)'{-s,--speed}'[speed in percent]:PCT: ' */
static void put_options(FILE *to, const cli_option *options, size_t n, const char *indent)
{
    for (size_t i = 0; i < n; i++) {
        const cli_option *o = &options[i];
        fputs(indent, to);
        if (o->letter)
            fprintf(to, "{-%c,--%s}'[", o->letter, o->name);
        else
            fprintf(to, "'--%s[", o->name);
        put(to, o->help);
        putc(']', to);
        if (o->kind == CLI_CHOICE) {
            fputs(o->optional ? "::word:" : ":word:", to);
            put_choice(to, o->value, strlen(o->value));
        } else if (o->kind != CLI_FLAG) {
            putc(':', to);
            put(to, o->value);
            fprintf(to, ":%s", action(cli_option_argument(o)));
        }
        fputs("'\n", to);
    }
}

static void put_command(FILE *to, const cli_command *c)
{
    size_t length;
    const char *first = cli_first_argument(c, &length);
    fprintf(to, "  (%s)\n    own=(\n", c->name);
    put_options(to, c->options, c->n_options, "      ");
    if (first) {
        fputs("      '1:word:", to);
        put_choice(to, first, length);
        fputs("'\n", to);
    }
    if (*c->arguments) {
        fputs("      '*:", to);
        put(to, c->arguments);
        fprintf(to, ":%s'\n", action(c->argument));
    }
    fputs("    ) ;;\n", to);
}

static void put_lists(FILE *to)
{
    const grobo_model *model = &grobo_gr001_model;
    fputs("_grctl_commands() {\n  local -a commands=(\n", to);
    for (size_t i = 0; i < cli_n_commands; i++) {
        fprintf(to, "    '%s:", cli_commands[i]->name);
        put(to, cli_commands[i]->summary);
        fputs("'\n", to);
    }
    fputs("  )\n  _describe command commands\n}\n\n_grctl_joints() {\n  compadd --", to);
    for (int i = 0; i < model->n_groups; i++)
        fprintf(to, " %s", model->groups[i].name);
    for (int i = 0; i < model->n_joints; i++)
        fprintf(to, " %s", model->joints[i].name);
    fputs("\n}\n\n_grctl_devices() {\n  compadd -- auto sim\n  _files\n}\n\n", to);
}

void cli_print_zsh(FILE *to)
{
    fputs("#compdef grctl\n# zsh completion for grctl; made by 'grctl completion zsh'.\n\n", to);
    put_lists(to);
    fputs("_grctl() {\n  local curcontext=$curcontext state line\n  local -a global own\n"
          "  global=(\n",
          to);
    put_options(to, cli_global_options, GLOBAL_COUNT, "    ");
    fputs("  )\n"
          "  _arguments -C -s $global '1:command:_grctl_commands' '*:: :->rest' && return\n"
          "  [[ $state == rest ]] || return 1\n"
          "  case $words[1] in\n",
          to);
    for (size_t i = 0; i < cli_n_commands; i++)
        put_command(to, cli_commands[i]);
    fputs("  esac\n  _arguments -s $global $own\n}\n\n"
          "if [[ $funcstack[1] == _grctl ]]; then _grctl \"$@\"; else compdef _grctl grctl; fi\n",
          to);
}
