/* SPDX-License-Identifier: MIT */
/* Completion for bash, made from the tables. */
#include <grobo/model.h>

#include "tools/grctl/cli/cli.h"

static void put_words(FILE *to, const char *words, size_t length)
{
    for (size_t i = 0; i < length; i++)
        putc(words[i] == '|' ? ' ' : words[i], to);
}

static void put_option_names(FILE *to, const cli_option *options, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        fprintf(to, " --%s", options[i].name);
        if (options[i].letter)
            fprintf(to, " -%c", options[i].letter);
    }
}

/* How _grctl_fill is told what completes a thing. */
static const char *kind_word(cli_argument argument)
{
    switch (argument) {
    case CLI_ARG_NONE:
    case CLI_ARG_WORD:
        return "nothing";
    case CLI_ARG_COMMAND:
        return "commands";
    case CLI_ARG_JOINT:
        return "joints";
    case CLI_ARG_FILE:
        return "files";
    case CLI_ARG_DEVICE:
        return "devices";
    }
    return "nothing";
}

/* One row an option with a value: "    play:--speed|play:-s) kind=nothing ;;" */
static void put_values(FILE *to, const char *command, const cli_option *options, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const cli_option *o = &options[i];
        const char *words = o->value;
        size_t length;
        if (o->kind == CLI_FLAG)
            continue;
        fprintf(to, "    %s:--%s", command, o->name);
        if (o->letter)
            fprintf(to, "|%s:-%c", command, o->letter);
        if (o->kind == CLI_CHOICE) {
            fputs(") kind=words words='", to);
            for (const char *word; (word = cli_next_word(&words, &length)) != NULL;)
                fprintf(to, "%.*s%s", (int)length, word, *words ? " " : "");
            fputs("' ;;\n", to);
        } else {
            fprintf(to, ") kind=%s ;;\n", kind_word(cli_option_argument(o)));
        }
    }
}

static void put_joints(FILE *to)
{
    const grobo_model *model = &grobo_gr001_model;
    fputs("_grctl_joints='", to);
    for (int i = 0; i < model->n_groups; i++)
        fprintf(to, "%s ", model->groups[i].name);
    for (int i = 0; i < model->n_joints; i++)
        fprintf(to, "%s%s", model->joints[i].name, i + 1 < model->n_joints ? " " : "'\n");
}

static void put_commands(FILE *to)
{
    fputs("_grctl_commands='", to);
    for (size_t i = 0; i < cli_n_commands; i++)
        fprintf(to, "%s%s", cli_commands[i]->name, i + 1 < cli_n_commands ? " " : "'\n");
}

/* What a command's options and arguments are. */
static void put_command(FILE *to, const cli_command *c)
{
    size_t length;
    const char *first = cli_first_argument(c, &length);
    fprintf(to, "    %s)\n        options='", c->name);
    put_option_names(to, c->options, c->n_options);
    fprintf(to, "'\n        kind=%s\n", kind_word(c->argument));
    if (first) {
        fputs("        [ \"$2\" -eq 0 ] && kind=words words='", to);
        put_words(to, first, length);
        fputs("'\n", to);
    }
    fputs("        ;;\n", to);
}

static const char functions[] =
    "\n"
    "# _grctl_fill KIND WORDS PREFIX: sets COMPREPLY.\n"
    "_grctl_fill() {\n"
    "    local IFS=$' \\t\\n' list=\n"
    "    case $1 in\n"
    "    words) list=$2 ;;\n"
    "    commands) list=$_grctl_commands ;;\n"
    "    joints) list=$_grctl_joints ;;\n"
    "    devices) list='auto sim tcp:' ;;\n"
    "    esac\n"
    "    case $1 in\n"
    "    files|devices)\n"
    "        IFS=$'\\n'\n"
    "        compopt -o filenames 2>/dev/null\n"
    "        COMPREPLY=($(compgen -f -- \"$3\"))\n"
    "        IFS=$' \\t\\n'\n"
    "        ;;\n"
    "    esac\n"
    "    [ -z \"$list\" ] || COMPREPLY+=($(compgen -W \"$list\" -- \"$3\"))\n"
    "}\n"
    "\n"
    "_grctl() {\n"
    "    local current=${COMP_WORDS[COMP_CWORD]} before= command= word kind words options\n"
    "    local -i i n=0\n"
    "    COMPREPLY=()\n"
    "    # bash takes --color=auto apart: --color = auto\n"
    "    [ \"$current\" = '=' ] && current=\n"
    "    for ((i = 1; i < COMP_CWORD; i++)); do\n"
    "        word=${COMP_WORDS[i]}\n"
    "        if [ \"$word\" = '=' ]; then\n"
    "            continue\n"
    "        elif [ -n \"$before\" ]; then\n"
    "            before=\n"
    "        elif [[ $word == -* ]]; then\n"
    "            _grctl_value \"$command\" \"$word\" && before=$word\n"
    "        elif [ -z \"$command\" ]; then\n"
    "            command=$word\n"
    "        else\n"
    "            n+=1\n"
    "        fi\n"
    "    done\n"
    "    kind= words=\n"
    "    if [ -n \"$before\" ]; then\n"
    "        _grctl_value \"$command\" \"$before\"\n"
    "        _grctl_fill \"$kind\" \"$words\" \"$current\"\n"
    "        return\n"
    "    fi\n"
    "    options=\n"
    "    [ -z \"$command\" ] && kind=commands || _grctl_command \"$command\" $n\n"
    "    if [[ $current == -* ]]; then\n"
    "        _grctl_fill words \"$options $_grctl_global\" \"$current\"\n"
    "    else\n"
    "        _grctl_fill \"$kind\" \"$words\" \"$current\"\n"
    "    fi\n"
    "}\n"
    "\n"
    "complete -F _grctl grctl\n";

void cli_print_bash(FILE *to)
{
    fputs("# bash completion for grctl; made by 'grctl completion bash'.\n", to);
    put_commands(to);
    put_joints(to);
    fputs("_grctl_global='", to);
    put_option_names(to, cli_global_options, GLOBAL_COUNT);
    fputs("'\n\n# _grctl_value COMMAND OPTION: sets kind and words of its value, fails if none."
          "\n_grctl_value() {\n    case $1:$2 in\n",
          to);
    for (size_t i = 0; i < cli_n_commands; i++)
        put_values(to, cli_commands[i]->name, cli_commands[i]->options, cli_commands[i]->n_options);
    put_values(to, "*", cli_global_options, GLOBAL_COUNT);
    fputs("    *) return 1 ;;\n    esac\n}\n\n"
          "# _grctl_command COMMAND N: sets options, and kind and words of its argument N.\n"
          "_grctl_command() {\n    case $1 in\n",
          to);
    for (size_t i = 0; i < cli_n_commands; i++)
        put_command(to, cli_commands[i]);
    fputs("    esac\n}\n", to);
    fputs(functions, to);
}
