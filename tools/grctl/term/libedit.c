/* SPDX-License-Identifier: MIT */
/*
 * Lines edited with libedit, with a history that outlives the shell. What libedit writes is kept,
 * and goes on as all output does (output.h): a terminal that takes nothing holds up nobody.
 */
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <wchar.h>

#include <histedit.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/term/edit.h"

enum { HISTORY_LINES = 1000, CANDIDATES_MAX = 256, WORD_BYTES = 256, PATH_BYTES = 1024 };

struct line_reader {
    line_owner owner;
    EditLine *edit;
    FILE *to; /* what libedit writes to: */
    char *text;
    size_t size;
    History *history;
    struct event *resumed; /* SIGCONT */
    const char *prompt;
    bool reading;
    bool interrupted;
    char path[PATH_BYTES]; /* of the history, "": it is not kept */
};

/* ---- reading -------------------------------------------------------------------------------- */

static char *give_prompt(EditLine *edit)
{
    static char text[64];
    line_reader *reader = NULL;
    el_get(edit, EL_CLIENTDATA, &reader);
    snprintf(text, sizeof text, "%s", reader->prompt);
    return text;
}

/* Shows what libedit and its functions have written. */
static void show(line_reader *reader)
{
    (void)fflush(reader->to);
    output_bytes(reader->text, reader->size);
    (void)output_flush();
    (void)fseeko(reader->to, 0, SEEK_SET);
    reader->size = 0;
}

/* Above the line that is typed, which then stands below. */
static void tell_news(line_reader *reader)
{
    fputs("\n", reader->to);
    show(reader);
    reader->owner.tell(reader->owner.ctx);
    el_set(reader->edit, EL_REFRESH, NULL);
}

/* Whoever had the terminal meanwhile left it in another mode; libedit does not look. */
static void on_resumed(evutil_socket_t number, short what, void *ctx)
{
    line_reader *reader = ctx;
    (void)number;
    (void)what;
    if (!reader->reading || tcgetpgrp(STDIN_FILENO) != getpgrp()) {
        return;
    }
    el_set(reader->edit, EL_PREP_TERM, 0);
    el_set(reader->edit, EL_PREP_TERM, 1);
    el_set(reader->edit, EL_REFRESH, NULL);
    show(reader);
}

/* A character, once the loop says that there is one. */
static int get_character(EditLine *edit, wchar_t *out)
{
    line_reader *reader = NULL;
    mbstate_t state = {0};
    el_get(edit, EL_CLIENTDATA, &reader);
    for (;;) {
        show(reader);
        int stopped = reader->owner.wait(reader->owner.ctx);
        char byte;
        if (stopped == LINE_NEWS) {
            tell_news(reader);
            continue;
        }
        if (stopped) {
            reader->interrupted = true;
            return -1;
        }
        if (read(STDIN_FILENO, &byte, 1) <= 0) {
            return 0;
        }
        size_t n = mbrtowc(out, &byte, 1, &state);
        if (n == (size_t)-1) {
            *out = L'?';
            return 1;
        }
        if (n != (size_t)-2) {
            return 1;
        }
    }
}

/* ---- completion ----------------------------------------------------------------------------- */

typedef struct candidates {
    int n;
    bool whole; /* the last one found */
    char word[CANDIDATES_MAX][WORD_BYTES];
} candidates;

static void take_candidate(void *ctx, const char *word, bool whole)
{
    candidates *c = ctx;
    for (int i = 0; i < c->n; i++) {
        if (strcmp(c->word[i], word) == 0) {
            return;
        }
    }
    if (c->n >= CANDIDATES_MAX) {
        return;
    }
    snprintf(c->word[c->n++], WORD_BYTES, "%s", word);
    c->whole = whole;
}

/* What all candidates begin with. */
static size_t common(const candidates *c)
{
    size_t n = strlen(c->word[0]);
    for (int i = 1; i < c->n; i++) {
        for (size_t k = 0; k < n; k++) {
            if (c->word[i][k] != c->word[0][k]) {
                n = k;
            }
        }
    }
    return n;
}

static int compare(const void *a, const void *b)
{
    return strcmp(a, b);
}

static void list_candidates(candidates *c, FILE *to)
{
    qsort(c->word, (size_t)c->n, WORD_BYTES, compare);
    putc('\n', to);
    for (int i = 0; i < c->n; i++) {
        fprintf(to, "%s%s", c->word[i], i + 1 < c->n ? "  " : "\n");
    }
}

static unsigned char complete(EditLine *edit, int key)
{
    static candidates found;
    char text[WORD_BYTES + 1];
    const LineInfo *info = el_line(edit);
    size_t length = (size_t)(info->cursor - info->buffer);
    line_reader *reader = NULL;
    (void)key;
    found.n = 0;
    el_get(edit, EL_CLIENTDATA, &reader);
    size_t replaced =
        reader->owner.complete(reader->owner.ctx, info->buffer, length, take_candidate, &found);
    if (found.n == 0) {
        return CC_REFRESH_BEEP;
    }
    size_t n = common(&found);
    if (found.n > 1 && n <= replaced) {
        list_candidates(&found, reader->to);
        return CC_REDISPLAY;
    }
    snprintf(text, sizeof text, "%.*s%s", (int)n, found.word[0],
             found.n == 1 && found.whole ? " " : "");
    el_deletestr(edit, (int)replaced);
    if (el_insertstr(edit, text) < 0) {
        return CC_ERROR;
    }
    return CC_REFRESH;
}

/* ---- history -------------------------------------------------------------------------------- */

static void open_history(line_reader *reader)
{
    HistEvent event;
    reader->history = history_init();
    if (!reader->history) {
        return;
    }
    history(reader->history, &event, H_SETSIZE, HISTORY_LINES);
    history(reader->history, &event, H_SETUNIQUE, 1);
    if (!os_state_path("history", reader->path, sizeof reader->path)) {
        *reader->path = '\0';
    }
    if (*reader->path) {
        history(reader->history, &event, H_LOAD, reader->path);
    }
    el_set(reader->edit, EL_HIST, history, reader->history);
}

static void remember(line_reader *reader, const char *line)
{
    HistEvent event;
    if (!reader->history || line[strspn(line, " \t\n")] == '\0') {
        return;
    }
    history(reader->history, &event, H_ENTER, line);
    if (!*reader->path) {
        return;
    }
    mode_t mask = umask(0077); /* what was typed is nobody else's */
    history(reader->history, &event, H_SAVE, reader->path);
    umask(mask);
}

/* ---- the reader ----------------------------------------------------------------------------- */

static void forget(line_reader *reader)
{
    if (reader->to) {
        (void)fclose(reader->to);
    }
    free(reader->text);
    free(reader);
}

line_reader *line_open(const line_owner *owner)
{
    line_reader *reader = calloc(1, sizeof *reader);
    if (!reader) {
        return NULL;
    }
    reader->owner = *owner;
    reader->prompt = "";
    reader->to = open_memstream(&reader->text, &reader->size);
    reader->edit = reader->to ? el_init_fd("grctl", stdin, reader->to, stderr, STDIN_FILENO,
                                           STDOUT_FILENO, STDERR_FILENO)
                              : NULL;
    if (!reader->edit) {
        forget(reader);
        return NULL;
    }
    el_set(reader->edit, EL_CLIENTDATA, reader);
    el_set(reader->edit, EL_EDITOR, "emacs");
    el_set(reader->edit, EL_PROMPT, give_prompt);
    el_set(reader->edit, EL_GETCFN, get_character);
    el_set(reader->edit, EL_ADDFN, "grctl-complete", "Complete a word", complete);
    el_set(reader->edit, EL_BIND, "^I", "grctl-complete", NULL);
    el_set(reader->edit, EL_BIND, "^R", "em-inc-search-prev", NULL);
    open_history(reader);
    el_source(reader->edit, NULL);
    reader->resumed = evsignal_new(owner->base, SIGCONT, on_resumed, reader);
    if (!reader->resumed || event_add(reader->resumed, NULL) != 0) {
        line_close(reader);
        return NULL;
    }
    return reader;
}

int line_read(line_reader *reader, const char *prompt, char *line, size_t capacity)
{
    int n = 0;
    reader->prompt = prompt;
    reader->interrupted = false;
    reader->reading = true;
    const char *text = el_gets(reader->edit, &n);
    reader->reading = false;
    if (reader->interrupted) {
        el_reset(reader->edit);
    }
    bool ends = reader->interrupted || !text || n <= 0;
    if (ends) {
        putc('\n', reader->to);
    }
    show(reader);
    if (ends) {
        return reader->interrupted ? LINE_INTERRUPTED : LINE_END;
    }
    remember(reader, text);
    if (strcspn(text, "\n") >= capacity) {
        return LINE_TOO_LONG;
    }
    snprintf(line, capacity, "%.*s", (int)strcspn(text, "\n"), text);
    return (int)strlen(line);
}

void line_close(line_reader *reader)
{
    if (reader->history) {
        history_end(reader->history);
    }
    if (reader->resumed) {
        event_free(reader->resumed);
    }
    el_end(reader->edit);
    show(reader);
    forget(reader);
}
