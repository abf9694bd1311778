/* SPDX-License-Identifier: MIT */
/* What may stand at the end of a line of the shell, by the tables of commands and words. */
#include <dirent.h>
#include <string.h>
#include <sys/stat.h>

#include <grobo/model.h>
#include <grobo/motion_io.h>

#include "tools/grctl/shell/shell.h"

typedef struct search {
    const char *prefix; /* the word so far, without its backslashes */
    size_t length;
    line_found_fn found;
    void *ctx;
} search;

static void offer(const search *s, const char *word, size_t length)
{
    char text[256];
    if (length >= sizeof text || length < s->length || strncmp(word, s->prefix, s->length) != 0)
        return;
    snprintf(text, sizeof text, "%.*s", (int)length, word);
    s->found(s->ctx, text, true);
}

static void offer_words(const search *s, const char *words, size_t length)
{
    const char *end = words + length;
    size_t n;
    for (const char *word; words < end && (word = cli_next_word(&words, &n)) != NULL;)
        offer(s, word, word + n > end ? (size_t)(end - word) : n);
}

static void offer_commands(const search *s, bool with_words)
{
    const shell_word *w;
    for (size_t i = 0; i < cli_n_commands; i++)
        offer(s, cli_commands[i]->name, strlen(cli_commands[i]->name));
    for (size_t i = 0; with_words && (w = shell_word_row(i)) != NULL; i++)
        if (*w->word)
            offer(s, w->word, strlen(w->word));
}

static void offer_joints(const search *s)
{
    const grobo_model *model = &grobo_gr001_model;
    for (int i = 0; i < model->n_groups; i++)
        offer(s, model->groups[i].name, strlen(model->groups[i].name));
    for (int i = 0; i < model->n_joints; i++)
        offer(s, model->joints[i].name, strlen(model->joints[i].name));
}

/* A name as it is typed: shell_split() takes the backslashes away. */
static void found_name(const search *s, const char *name, bool whole)
{
    char text[2048];
    size_t at = 0;
    for (; *name && at + 2 < sizeof text; name++) {
        if (strchr(" \t'\"\\#", *name))
            text[at++] = '\\';
        text[at++] = *name;
    }
    text[at] = '\0';
    s->found(s->ctx, text, whole);
}

/* Motions that go by their names: those of the folder motions, see read_motion(). */
static void offer_motions(const search *s)
{
    DIR *all = opendir("motions");
    struct dirent *entry;
    while (all && (entry = readdir(all)) != NULL) {
        char name[256];
        if (grobo_motion_format_of_path(entry->d_name) == GROBO_FORMAT_AUTO ||
            strncmp(entry->d_name, s->prefix, s->length) != 0)
            continue;
        snprintf(name, sizeof name, "%.*s", (int)(strrchr(entry->d_name, '.') - entry->d_name),
                 entry->d_name);
        if (strlen(name) >= s->length)
            found_name(s, name, true);
    }
    if (all)
        closedir(all);
}

/* Files of the folder that the word names, what begins with a dot only where a dot is typed. */
static void offer_files(const search *s)
{
    char folder[1024], path[2048];
    const char *slash = s->prefix + s->length;
    struct dirent *entry;
    DIR *all;
    while (slash > s->prefix && slash[-1] != '/')
        slash--;
    snprintf(folder, sizeof folder, "%.*s", (int)(slash - s->prefix), s->prefix);
    all = opendir(*folder ? folder : ".");
    while (all && (entry = readdir(all)) != NULL) {
        struct stat status;
        size_t typed = s->length - (size_t)(slash - s->prefix);
        bool is_folder;
        if (strncmp(entry->d_name, slash, typed) != 0 || (*entry->d_name == '.' && typed == 0))
            continue;
        snprintf(path, sizeof path, "%s%s", folder, entry->d_name);
        is_folder = stat(path, &status) == 0 && S_ISDIR(status.st_mode);
        if (is_folder)
            snprintf(path, sizeof path, "%s%s/", folder, entry->d_name);
        found_name(s, path, !is_folder);
    }
    if (all)
        closedir(all);
}

static void offer_kind(const search *s, cli_argument kind)
{
    switch (kind) {
    case CLI_ARG_NONE:
    case CLI_ARG_WORD:
        return;
    case CLI_ARG_COMMAND:
        offer_commands(s, false);
        return;
    case CLI_ARG_JOINT:
        offer_joints(s);
        return;
    case CLI_ARG_FILE:
        offer(s, "@record", strlen("@record"));
        offer_files(s);
        return;
    case CLI_ARG_DEVICE:
        offer_words(s, "auto|sim", strlen("auto|sim"));
        offer_files(s);
        return;
    }
}

static void offer_names(const search *s, const cli_option *options, size_t n)
{
    char name[64];
    for (size_t i = 0; i < n; i++) {
        snprintf(name, sizeof name, "--%s", options[i].name);
        offer(s, name, strlen(name));
    }
}

static const cli_option *find_in(const cli_option *options, size_t n, const char *word)
{
    for (size_t i = 0; i < n; i++)
        if ((word[1] == '-' && strcmp(word + 2, options[i].name) == 0) ||
            (word[1] == options[i].letter && word[1] && word[2] == '\0'))
            return &options[i];
    return NULL;
}

/* The option that waits for its value when this word stands before, or NULL. */
static const cli_option *waiting(const cli_command *command, const char *word)
{
    const cli_option *o = NULL;
    if (word[0] != '-')
        return NULL;
    if (command)
        o = find_in(command->options, command->n_options, word);
    if (!o)
        o = find_in(cli_global_options, GLOBAL_COUNT, word);
    return o && o->kind != CLI_FLAG && !o->optional ? o : NULL;
}

/* The command that a word stands for. */
static const cli_command *command_of(const char *word)
{
    const shell_word *w = shell_word_find(word);
    char name[32];
    if (!w)
        return cli_find_command(word);
    snprintf(name, sizeof name, "%.*s", w->command ? (int)strcspn(w->command, " ") : 0,
             w->command ? w->command : "");
    return cli_find_command(name);
}

/* What the arguments of a letter or word are, told by their names in the table. */
static cli_argument argument_of(const shell_word *w)
{
    if (strstr(w->arguments, "JOINT"))
        return CLI_ARG_JOINT;
    if (strstr(w->arguments, "NAME") || strstr(w->arguments, "FILE"))
        return CLI_ARG_FILE;
    return strstr(w->arguments, "DEV") ? CLI_ARG_DEVICE : CLI_ARG_NONE;
}

static void offer_argument(const search *s, const char *first, int n)
{
    const shell_word *w = shell_word_find(first);
    const cli_command *command = command_of(first);
    const char *words;
    size_t length;
    if (s->length && s->prefix[0] == '-') {
        if (command)
            offer_names(s, command->options, command->n_options);
        offer_names(s, cli_global_options, GLOBAL_COUNT);
    } else if (w) {
        offer_kind(s, argument_of(w));
        if (strstr(w->arguments, "NAME"))
            offer_motions(s);
    } else if (command && n == 1 && (words = cli_first_argument(command, &length)) != NULL) {
        offer_words(s, words, length);
    } else if (command) {
        offer_kind(s, command->argument);
    }
}

static bool is_escaped(const char *line, size_t at)
{
    return at > 0 && line[at - 1] == '\\';
}

/* Where the last word begins, and the word without its backslashes. */
static size_t last_word(const char *line, size_t length, char *word)
{
    size_t begin = length, n = 0;
    while (begin > 0 && (!strchr(" \t", line[begin - 1]) || is_escaped(line, begin - 1)))
        begin--;
    for (size_t i = begin; i < length; i++)
        if (line[i] != '\\' || is_escaped(line, i))
            word[n++] = line[i];
    word[n] = '\0';
    return begin;
}

size_t shell_complete(const char *line, size_t length, line_found_fn found, void *ctx)
{
    char text[SHELL_LINE_BYTES], word[SHELL_LINE_BYTES];
    char *words[SHELL_WORDS_MAX];
    search s = {.prefix = word, .found = found, .ctx = ctx};
    const cli_option *o;
    size_t begin;
    int n;
    if (length >= sizeof text)
        return 0;
    begin = last_word(line, length, word);
    s.length = strlen(word);
    snprintf(text, sizeof text, "%.*s", (int)begin, line);
    n = shell_split(text, words, SHELL_WORDS_MAX);
    if (n < 0)
        return 0;
    o = n > 0 ? waiting(command_of(words[0]), words[n - 1]) : NULL;
    if (n == 0)
        offer_commands(&s, true);
    else if (o && o->kind == CLI_CHOICE)
        offer_words(&s, o->value, strlen(o->value));
    else if (o)
        offer_kind(&s, cli_option_argument(o));
    else
        offer_argument(&s, words[0], n);
    return length - begin;
}
