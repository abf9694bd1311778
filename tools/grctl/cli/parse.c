/* SPDX-License-Identifier: MIT */
/* Parsing of command lines against the tables of cli.h. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/cli.h"
#include "tools/grctl/lang/lang.h"

typedef struct parser {
    cli_line *line;
    char *const *argv;
    int argc, at;
    bool only_arguments; /* after "--" */
    char *complaint;
    size_t capacity;
    bool mistaken; /* the first mistake is in complaint */
} parser;

static bool complain(parser *p, const char *format, ...) __attribute__((format(printf, 2, 3)));

static bool complain(parser *p, const char *format, ...)
{
    va_list list;
    if (p->mistaken) {
        return false;
    }
    p->mistaken = true;
    va_start(list, format);
    vsnprintf(p->complaint, p->capacity, lang_text(format), list);
    va_end(list);
    return false;
}

bool cli_read_number(const char *text, double *number)
{
    char *end = NULL;
    if (strspn(text, "0123456789+-.eE") != strlen(text) || *text == '\0') {
        return false;
    }
    double value = strtod(text, &end);
    if (end == text || *end != '\0' || !isfinite(value)) {
        return false;
    }
    *number = value;
    return true;
}

const cli_command *cli_find_command(const char *name)
{
    for (size_t i = 0; i < cli_n_commands; i++) {
        if (strcmp(cli_commands[i]->name, name) == 0) {
            return cli_commands[i];
        }
    }
    return NULL;
}

/* Index of a word in "a|b|c", or -1. */
static int choice_index(const char *words, const char *word)
{
    size_t length = strlen(word);
    for (int i = 0;; i++) {
        size_t n = strcspn(words, "|");
        if (n == length && strncmp(words, word, n) == 0) {
            return i;
        }
        if (words[n] == '\0') {
            return -1;
        }
        words += n + 1;
    }
}

static bool take_number(parser *p, const cli_option *o, cli_value *v, const char *text)
{
    double number;
    if (!cli_read_number(text, &number) || (!o->real && number != floor(number)) ||
        number < o->min || number > o->max) {
        return complain(p, "--%s: '%s' is not a %s from %.10g to %.10g", o->name, text,
                        o->real ? _("number") : _("whole number"), o->min, o->max);
    }
    v->number = number;
    return true;
}

static bool check_value(parser *p, const cli_option *o, cli_value *v, const char *text)
{
    switch (o->kind) {
    case CLI_FLAG:
        return true;
    case CLI_TEXT:
        return *text || complain(p, "--%s needs a value: %s", o->name, o->value);
    case CLI_NUMBER:
        return take_number(p, o, v, text);
    case CLI_CHOICE:
        v->choice = choice_index(o->value, text);
        if (v->choice < 0) {
            return complain(p, "--%s: invalid value '%s' (%s)", o->name, text, o->value);
        }
        return true;
    }
    return false;
}

/* A value that is refused is as one that was not given. */
static bool take_value(parser *p, const cli_option *o, cli_value *v, const char *text)
{
    cli_value taken = {.given = v->given + 1, .text = text};
    if (!check_value(p, o, &taken, text)) {
        return false;
    }
    *v = taken;
    return true;
}

bool cli_take_value(const cli_option *option, cli_value *value, const char *text, char *complaint,
                    size_t capacity)
{
    parser p = {.complaint = complaint, .capacity = capacity};
    return take_value(&p, option, value, text);
}

/* The i-th option that may stand here: the command's own, then the global ones, then NULL. */
static const cli_option *nth_option(parser *p, size_t i, cli_value **value)
{
    const cli_command *command = p->line->command;
    size_t own = command ? command->n_options : 0;
    if (i < own) {
        *value = &p->line->option[i];
        return &command->options[i];
    }
    if (i - own >= GLOBAL_COUNT) {
        return NULL;
    }
    *value = &p->line->global[i - own];
    return &cli_global_options[i - own];
}

static const cli_option *find_letter(parser *p, char letter, cli_value **value)
{
    const cli_option *o;
    for (size_t i = 0; (o = nth_option(p, i, value)) != NULL && o->letter != letter; i++) {
        continue;
    }
    return o;
}

/* By its name, or by the beginning of it; *rival is another that begins so, or NULL. */
static const cli_option *find_name(parser *p, const char *name, size_t length, cli_value **value,
                                   const cli_option **rival)
{
    const cli_option *o, *found = NULL;
    cli_value *at;
    *rival = NULL;
    for (size_t i = 0; (o = nth_option(p, i, &at)) != NULL; i++) {
        bool whole = strlen(o->name) == length;
        if (length == 0 || strncmp(o->name, name, length) != 0 || (o->whole && !whole)) {
            continue;
        }
        if (found && !whole) {
            *rival = *rival ? *rival : o;
            continue;
        }
        found = o;
        *value = at;
        if (whole) {
            *rival = NULL;
            break;
        }
    }
    return found;
}

static bool unknown_option(parser *p, const char *name, size_t length)
{
    cli_guess guess = {.name = name, .length = length};
    const cli_option *o;
    cli_value *value;
    for (size_t i = 0; (o = nth_option(p, i, &value)) != NULL; i++) {
        cli_guess_try(&guess, o->name);
    }
    return guess.best ? complain(p, "unknown option --%.*s; did you mean --%s?", (int)length, name,
                                 guess.best)
                      : complain(p, "unknown option --%.*s", (int)length, name);
}

/* True if what follows is no value of an option that can do without. */
static bool stands_alone(const parser *p, const cli_option *o)
{
    return o->optional && (p->at >= p->argc || choice_index(o->value, p->argv[p->at]) < 0);
}

/* --name, --name=value, --name value; of the name, as much as tells it from the others */
static bool parse_long(parser *p, const char *token)
{
    const char *name = token + 2;
    size_t length = strcspn(name, "=");
    const char *text = name[length] == '=' ? name + length + 1 : NULL;
    cli_value *value = NULL;
    const cli_option *rival, *o = find_name(p, name, length, &value, &rival);
    if (!o) {
        return unknown_option(p, name, length);
    }
    if (rival) {
        return complain(p, "--%.*s may be --%s or --%s", (int)length, name, o->name, rival->name);
    }
    if (o->kind == CLI_FLAG) {
        return text ? complain(p, "--%s takes no value", o->name) : take_value(p, o, value, "");
    }
    if (!text && stands_alone(p, o)) {
        value->given++;
        return true;
    }
    if (!text) {
        if (p->at >= p->argc) {
            return complain(p, "--%s needs a value: %s", o->name, o->value);
        }
        text = p->argv[p->at++];
    }
    return take_value(p, o, value, text);
}

/* -abc, -d value, -dvalue */
static bool parse_short(parser *p, const char *token)
{
    for (const char *c = token + 1; *c; c++) {
        cli_value *value = NULL;
        const cli_option *o = find_letter(p, *c, &value);
        if (!o) {
            return complain(p, "unknown option -%c", *c);
        }
        if (o->kind == CLI_FLAG) {
            if (!take_value(p, o, value, "")) {
                return false;
            }
            continue;
        }
        if (c[1]) {
            return take_value(p, o, value, c + 1);
        }
        if (p->at >= p->argc) {
            return complain(p, "-%c needs a value: %s", *c, o->value);
        }
        return take_value(p, o, value, p->argv[p->at++]);
    }
    return true;
}

static bool parse_argument(parser *p, const char *token)
{
    cli_line *line = p->line;
    if (!line->command) {
        line->command = cli_find_command(token);
        if (line->command) {
            return true;
        }
        const char *nearest = cli_nearest_command(token);
        return nearest ? complain(p, "no command '%s'; did you mean '%s'?", token, nearest)
                       : complain(p, "no command '%s'", token);
    }
    if (!*token && line->command->argument == CLI_ARG_FILE) {
        return complain(p, "the file name is empty");
    }
    if (line->n_arguments >= CLI_ARGUMENTS_MAX) {
        return complain(p, "more than %d arguments", CLI_ARGUMENTS_MAX);
    }
    line->argument[line->n_arguments++] = token;
    return true;
}

/* A token such as -40 or -.5 is a number, not an option. */
static bool is_option(const char *token)
{
    return token[0] == '-' && token[1] != '\0' && !strchr("0123456789.", token[1]);
}

static bool check_count(parser *p)
{
    const cli_command *command = p->line->command;
    int n = p->line->n_arguments;
    if (!command || p->line->global[GLOBAL_HELP].given) {
        return true;
    }
    if (n < command->min_arguments) {
        return complain(p, "%s needs %s", command->name, command->arguments);
    }
    if (command->max_arguments >= 0 && n > command->max_arguments) {
        return complain(p, "%s: '%s' is one argument too many", command->name,
                        p->line->argument[command->max_arguments]);
    }
    return true;
}

bool cli_parse(cli_line *line, int argc, char *const *argv, char *complaint, size_t capacity)
{
    parser p = {.line = line,
                .argv = argv,
                .argc = argc,
                .at = 1,
                .complaint = complaint,
                .capacity = capacity};
    memset(line, 0, sizeof *line);
    while (p.at < argc) {
        const char *token = argv[p.at++];
        if (!p.only_arguments && strcmp(token, "--") == 0) {
            p.only_arguments = true;
            continue;
        }
        if (p.only_arguments || !is_option(token)) {
            parse_argument(&p, token);
        } else if (token[1] == '-') {
            parse_long(&p, token);
        } else {
            parse_short(&p, token);
        }
        if (p.mistaken && !line->command &&
            token[0] != '-') { /* no command: nothing to go on for */
            break;
        }
    }
    return check_count(&p) && !p.mistaken;
}
