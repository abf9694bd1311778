/* SPDX-License-Identifier: MIT */
/* What may stand next on a command line, by the tables of cli.h. */
#include <string.h>

#include <grobo/robot_file.h>

#include "tools/grctl/cli/cli.h"

/* ---- what completes a word ------------------------------------------------------------------- */

static void offer(const cli_offer *to, const char *word, size_t length, const char *help)
{
    char text[256];
    size_t typed = strlen(to->prefix);
    if (length < typed || length >= sizeof text || strncmp(word, to->prefix, typed) != 0) {
        return;
    }
    snprintf(text, sizeof text, "%.*s", (int)length, word);
    to->found(to->ctx, text, help);
}

void cli_offer_word(const cli_offer *to, const char *word, const char *help)
{
    offer(to, word, strlen(word), help);
}

/* The words of "a|b|c". */
static void offer_words(const cli_offer *to, const char *words, size_t length)
{
    for (size_t at = 0, n; at < length; at += n + 1) {
        const char *end = memchr(words + at, '|', length - at);
        n = end ? (size_t)(end - words) - at : length - at;
        offer(to, words + at, n, "");
    }
}

void cli_offer_kind(const cli_offer *to, cli_argument kind)
{
    const grobo_model *model = to->model;
    switch (kind) {
    case CLI_ARG_NONE:
    case CLI_ARG_WORD:
    case CLI_ARG_FILE:
        break;
    case CLI_ARG_COMMAND:
        for (size_t i = 0; i < cli_n_commands; i++) {
            cli_offer_word(to, cli_commands[i]->name, cli_commands[i]->summary);
        }
        break;
    case CLI_ARG_JOINT:
        for (int i = 0; i < model->n_groups; i++) {
            cli_offer_word(to, model->groups[i].name, "");
        }
        for (int i = 0; i < model->n_joints; i++) {
            cli_offer_word(to, grobo_model_joint(model, i)->name, "");
        }
        break;
    case CLI_ARG_ROBOT:
        for (size_t i = 0; grobo_robot_def_at(i); i++) {
            cli_offer_word(to, grobo_robot_def_at(i)->name, grobo_robot_def_at(i)->title);
        }
        break;
    case CLI_ARG_DEVICE:
        offer_words(to, "auto|sim|tcp:", strlen("auto|sim|tcp:"));
        break;
    }
}

static void offer_options(const cli_offer *to, const cli_option *options, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        char name[64];
        snprintf(name, sizeof name, "--%s", options[i].name);
        cli_offer_word(to, name, options[i].help);
        if (options[i].letter) {
            snprintf(name, sizeof name, "-%c", options[i].letter);
            cli_offer_word(to, name, options[i].help);
        }
    }
}

/* ---- where the word stands ------------------------------------------------------------------- */

static const cli_option *find_in(const cli_option *options, size_t n, const char *word)
{
    for (size_t i = 0; i < n; i++) {
        if ((word[1] == '-' && strcmp(word + 2, options[i].name) == 0) ||
            (word[1] == options[i].letter && word[1] && word[2] == '\0')) {
            return &options[i];
        }
    }
    return NULL;
}

/* The option whose value follows this word, or NULL. */
static const cli_option *find_option(const cli_command *command, const char *word)
{
    const cli_option *o = command ? find_in(command->options, command->n_options, word) : NULL;
    if (!o) {
        o = find_in(cli_global_options, GLOBAL_COUNT, word);
    }
    return o && o->kind != CLI_FLAG ? o : NULL;
}

cli_place cli_find_place(const cli_command *command, int n, char *const *words)
{
    cli_place place = {.command = command};
    for (int i = 0; i < n && !place.unknown; i++) {
        if (strcmp(words[i], "=") == 0) { /* bash splits --color=auto */
            continue;
        }
        if (place.option) {
            place.option = NULL;
        } else if (words[i][0] == '-') {
            place.option = find_option(place.command, words[i]);
        } else if (place.command) {
            place.n_arguments++;
        } else {
            place.command = cli_find_command(words[i]);
            place.unknown = !place.command;
        }
    }
    return place;
}

/* What the value of an option is, by its name in the table. */
static cli_argument value_kind(const cli_option *option)
{
    static const char *const files[] = {"FILE", "OUT", "PATH", "TRACE"};
    if (option->kind != CLI_TEXT) {
        return CLI_ARG_NONE;
    }
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (strncmp(option->value, files[i], strlen(files[i])) == 0) {
            return CLI_ARG_FILE;
        }
    }
    return strcmp(option->value, "DEV") == 0     ? CLI_ARG_DEVICE
           : strcmp(option->value, "ROBOT") == 0 ? CLI_ARG_ROBOT
           : strcmp(option->value, "LIST") == 0  ? CLI_ARG_JOINT
                                                 : CLI_ARG_NONE;
}

/* The length of the words that the first argument is one of ("on|off|brake"), or 0. */
static size_t first_argument_words(const char *arguments)
{
    size_t length = strspn(arguments, "abcdefghijklmnopqrstuvwxyz-|");
    bool ends = arguments[length] == '\0' || arguments[length] == ' ';
    return ends && memchr(arguments, '|', length) ? length : 0;
}

static cli_argument offer_argument(const cli_offer *to, const cli_place *place)
{
    const cli_command *command = place->command;
    size_t words = command ? first_argument_words(command->arguments) : 0;
    cli_argument kind = command ? command->argument : CLI_ARG_COMMAND;
    if (place->n_arguments == 0 && words) {
        offer_words(to, command->arguments, words);
        return CLI_ARG_NONE;
    }
    cli_offer_kind(to, kind);
    return kind;
}

static cli_argument offer_value(const cli_offer *to, const cli_option *option)
{
    cli_argument kind = value_kind(option);
    if (option->kind == CLI_CHOICE) {
        offer_words(to, option->value, strlen(option->value));
    }
    cli_offer_kind(to, kind);
    return kind;
}

cli_argument cli_offer_at(const cli_offer *to, const cli_place *place)
{
    const cli_command *command = place->command;
    if (place->unknown) {
        return CLI_ARG_NONE;
    }
    if (place->option && !place->option->optional) {
        return offer_value(to, place->option);
    }
    if (to->prefix[0] == '-') {
        if (command) {
            offer_options(to, command->options, command->n_options);
        }
        offer_options(to, cli_global_options, GLOBAL_COUNT);
        return CLI_ARG_NONE;
    }
    if (place->option) {
        (void)offer_value(to, place->option);
    }
    return offer_argument(to, place);
}

/* ---- for the shells of the system ------------------------------------------------------------ */

typedef struct printer {
    FILE *to;
    const char *word;
    int lead; /* how much of the word stands before what is completed: "--color=" */
} printer;

static void print_found(void *ctx, const char *word, const char *help)
{
    const printer *p = ctx;
    fprintf(p->to, "%.*s%s%s%s\n", p->lead, p->word, word, *help ? "\t" : "", help);
}

void cli_print_completions(FILE *to, const grobo_model *model, int n, char *const *words)
{
    cli_place place = cli_find_place(NULL, n - 1, words);
    printer p = {.to = to, .word = n > 0 ? words[n - 1] : ""};
    const char *equals = strchr(p.word, '=');
    if (equals && equals == p.word) {
        p.word++; /* of bash */
    } else if (equals && p.word[0] == '-') {
        char name[64];
        snprintf(name, sizeof name, "%.*s", (int)(equals - p.word), p.word);
        p.lead = (int)(equals - p.word) + 1;
        place.option = find_option(place.command, name);
    }
    cli_offer offer = {.prefix = p.word + p.lead, .model = model, .found = print_found, .ctx = &p};
    cli_argument kind = cli_offer_at(&offer, &place);
    if (kind == CLI_ARG_FILE || kind == CLI_ARG_DEVICE || kind == CLI_ARG_ROBOT) {
        fputs(":files\n", to);
    }
}
