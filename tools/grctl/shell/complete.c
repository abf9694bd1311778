/* SPDX-License-Identifier: MIT */
/* What may stand at the end of a line of the shell, by the tables of commands and words. */
#include <dirent.h>
#include <string.h>
#include <sys/stat.h>

#include <grobo/motion_io.h>

#include "tools/grctl/shell/shell.h"

typedef struct search {
    cli_offer to;
    size_t length; /* of to.prefix, the word so far without its backslashes */
    line_found_fn found;
    void *ctx;
} search;

static void on_found(void *ctx, const char *word, const char *help)
{
    const search *s = ctx;
    (void)help;
    s->found(s->ctx, word, true);
}

static void offer_first(const search *s)
{
    const shell_word *w;
    cli_offer_kind(&s->to, CLI_ARG_COMMAND);
    for (size_t i = 0; (w = shell_word_row(i)) != NULL; i++) {
        if (*w->word) {
            cli_offer_word(&s->to, w->word, w->help);
        }
    }
}

/* A name as it is typed: shell_split() takes the backslashes away. */
static void found_name(const search *s, const char *name, bool whole)
{
    char text[2048];
    size_t at = 0;
    for (; *name && at + 2 < sizeof text; name++) {
        if (strchr(" \t'\"\\#", *name)) {
            text[at++] = '\\';
        }
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
            strncmp(entry->d_name, s->to.prefix, s->length) != 0) {
            continue;
        }
        snprintf(name, sizeof name, "%.*s", (int)(strrchr(entry->d_name, '.') - entry->d_name),
                 entry->d_name);
        if (strlen(name) >= s->length) {
            found_name(s, name, true);
        }
    }
    if (all) {
        closedir(all);
    }
}

/* Files of the folder that the word names, what begins with a dot only where a dot is typed. */
static void offer_files(const search *s)
{
    char folder[1024], path[2048];
    const char *slash = s->to.prefix + s->length;
    struct dirent *entry;
    while (slash > s->to.prefix && slash[-1] != '/') {
        slash--;
    }
    snprintf(folder, sizeof folder, "%.*s", (int)(slash - s->to.prefix), s->to.prefix);
    DIR *all = opendir(*folder ? folder : ".");
    while (all && (entry = readdir(all)) != NULL) {
        struct stat status;
        size_t typed = s->length - (size_t)(slash - s->to.prefix);
        if (strncmp(entry->d_name, slash, typed) != 0 || (*entry->d_name == '.' && typed == 0)) {
            continue;
        }
        snprintf(path, sizeof path, "%s%s", folder, entry->d_name);
        bool is_folder = stat(path, &status) == 0 && S_ISDIR(status.st_mode);
        if (is_folder) {
            snprintf(path, sizeof path, "%s%s/", folder, entry->d_name);
        }
        found_name(s, path, !is_folder);
    }
    if (all) {
        closedir(all);
    }
}

/* The command that stands for a letter or word, or one that takes no arguments. */
static const cli_command *command_of(const shell_word *w)
{
    static const cli_command none = {.arguments = ""};
    char name[32];
    if (!w->command) {
        return &none;
    }
    snprintf(name, sizeof name, "%.*s", (int)strcspn(w->command, " "), w->command);
    return cli_find_command(name);
}

/* What the arguments of a letter or word are, by their names in the table. */
static cli_argument argument_of(const shell_word *w)
{
    if (strstr(w->arguments, "JOINT")) {
        return CLI_ARG_JOINT;
    }
    if (strstr(w->arguments, "NAME") || strstr(w->arguments, "FILE")) {
        return CLI_ARG_FILE;
    }
    return strstr(w->arguments, "DEV") ? CLI_ARG_DEVICE : CLI_ARG_NONE;
}

static void offer_next(const search *s, int n, char *const *words)
{
    const shell_word *w = shell_word_find(words[0]);
    cli_place place =
        w ? cli_find_place(command_of(w), n - 1, words + 1) : cli_find_place(NULL, n, words);
    bool is_argument = w && !place.option && s->to.prefix[0] != '-';
    cli_argument kind = is_argument ? argument_of(w) : cli_offer_at(&s->to, &place);
    if (is_argument) {
        cli_offer_kind(&s->to, kind);
    }
    if (kind == CLI_ARG_FILE) {
        cli_offer_word(&s->to, "@record", "");
    }
    if (kind == CLI_ARG_FILE || kind == CLI_ARG_DEVICE || kind == CLI_ARG_ROBOT) {
        offer_files(s);
    }
    if (is_argument && strstr(w->arguments, "NAME")) {
        offer_motions(s);
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
    while (begin > 0 && (!strchr(" \t", line[begin - 1]) || is_escaped(line, begin - 1))) {
        begin--;
    }
    for (size_t i = begin; i < length; i++) {
        if (line[i] != '\\' || is_escaped(line, i)) {
            word[n++] = line[i];
        }
    }
    word[n] = '\0';
    return begin;
}

size_t shell_complete(void *of, const char *line, size_t length, line_found_fn found, void *ctx)
{
    const shell *owner = of;
    char text[SHELL_LINE_BYTES], word[SHELL_LINE_BYTES];
    char *words[SHELL_WORDS_MAX];
    search s = {.to = {.prefix = word, .model = app_model(owner->a), .found = on_found, .ctx = &s},
                .found = found,
                .ctx = ctx};
    if (length >= sizeof text) {
        return 0;
    }
    size_t begin = last_word(line, length, word);
    s.length = strlen(word);
    snprintf(text, sizeof text, "%.*s", (int)begin, line);
    int n = shell_split(text, words, SHELL_WORDS_MAX);
    if (n < 0) {
        return 0;
    }
    if (n == 0) {
        offer_first(&s);
    } else {
        offer_next(&s, n, words);
    }
    return length - begin;
}
