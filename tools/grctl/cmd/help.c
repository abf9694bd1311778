/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/shell/shell.h"

enum { OPT_MAN };

static const cli_option options[] = {
    [OPT_MAN] = OPTION_FLAG("man", 0, "print the man page grctl(1), as mdoc"),
};

static json_t *option_json(const cli_option *o)
{
    return json_pack("{s:s,s:s,s:o*,s:o*}", "name", o->name, "help", o->help, "letter",
                     o->letter ? json_stringn(&o->letter, 1) : NULL, "value",
                     o->kind == CLI_FLAG ? NULL : json_string(o->value));
}

static json_t *command_json(const cli_command *command)
{
    json_t *list = json_array();
    for (size_t i = 0; i < command->n_options; i++) {
        json_array_append_new(list, option_json(&command->options[i]));
    }
    return json_pack("{s:s,s:s,s:s,s:o}", "name", command->name, "arguments", command->arguments,
                     "summary", command->summary, "options", list);
}

/* ---- the letters and words of a shell ------------------------------------------------------- */

/* The rows that a name asks for: NULL all, else its own, or those that begin with it. */
typedef struct asked {
    const char *name;
    bool beginning;
} asked;

static bool is_asked(const asked *what, const shell_word *w)
{
    if (!what->name) {
        return true;
    }
    if (what->beginning) {
        return strncmp(w->word, what->name, strlen(what->name)) == 0;
    }
    return *what->name && (strcmp(w->letter, what->name) == 0 || strcmp(w->word, what->name) == 0);
}

/* Prints the rows, or adds them to a list. Returns how many there are. */
static int list_words(const asked *what, json_t *list)
{
    const shell_word *w;
    int n = 0;
    for (size_t i = 0; (w = shell_word_row(i)) != NULL; i++) {
        if (!is_asked(what, w)) {
            continue;
        }
        n++;
        if (list) {
            json_array_append_new(list,
                                  json_pack("{s:s,s:s,s:s,s:s}", "letter", w->letter, "word",
                                            w->word, "arguments", w->arguments, "help", w->help));
        } else {
            char row[256];
            shell_word_text(w, row, sizeof row);
            app_print("%s", row);
        }
    }
    return n;
}

/* Help on a letter or word, in a shell. False: it is none. */
static bool help_word(const app *a, const char *name)
{
    asked what = {.name = name, .beginning = shell_word_find(name) == NULL};
    json_t *list = a->json ? json_array() : NULL;
    bool found = *name && list_words(&what, list) > 0;
    if (found && list) {
        app_print_json(json_pack("{s:O}", "words", list));
    }
    json_decref(list);
    return found;
}

/* ---- help ----------------------------------------------------------------------------------- */

static int no_command(app *a, const char *name)
{
    const char *nearest = a->link ? shell_nearest(name) : cli_nearest_command(name);
    if (nearest) {
        return app_fail(a, EXIT_USAGE, "ARG", "no command '%s'; did you mean '%s'?", name, nearest);
    }
    return app_fail(a, EXIT_USAGE, "ARG", "no command '%s'; see '%shelp'", name,
                    a->link ? "" : "grctl ");
}

static json_t *commands_json(const cli_command *about)
{
    json_t *list = json_array();
    for (size_t i = 0; i < cli_n_commands; i++) {
        if (!about || about == cli_commands[i]) {
            json_array_append_new(list, command_json(cli_commands[i]));
        }
    }
    return list;
}

static const asked all_words = {NULL, false};

static void print_json(const app *a, const cli_command *about)
{
    json_t *o = app_option(a, OPT_MAN)->given
                    ? json_pack("{s:o}", "manual", app_json_printed(cli_print_manual))
                    : json_pack("{s:o}", "commands", commands_json(about));
    if (a->link && !about && !app_option(a, OPT_MAN)->given) {
        json_t *words = json_array();
        list_words(&all_words, words);
        json_object_set_new(o, "words", words);
    }
    app_print_json(o);
}

static void print_overview(const app *a)
{
    cli_print_overview(output_stream());
    if (!a->link) {
        return;
    }
    app_print("%s", _("\nLetters and words of this shell:\n"));
    list_words(&all_words, NULL);
}

static int run(app *a)
{
    const char *name = a->line.n_arguments ? a->line.argument[0] : NULL;
    const cli_command *about = name ? cli_find_command(name) : NULL;
    if (name && !about && a->link && help_word(a, name)) {
        return EXIT_DONE;
    }
    if (name && !about) {
        return no_command(a, name);
    }
    if (a->json) {
        print_json(a, about);
    } else if (app_option(a, OPT_MAN)->given) {
        cli_print_manual(output_stream());
    } else if (about) {
        cli_print_command(output_stream(), about);
    } else {
        print_overview(a);
    }
    return EXIT_DONE;
}

const cli_command cmd_help = {
    .name = "help",
    COMMAND_ARGUMENTS("[COMMAND]", 0, 1, CLI_ARG_COMMAND),
    .summary = "list the commands, or explain one",
    .details = "Prints the list of commands, or everything about one of them. In a shell it knows\n"
               "the letters and words of the shell too, also by their first letters.\n",
    .example = "  grctl help play\n  grctl help --man | man -l -\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
