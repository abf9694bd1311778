/* SPDX-License-Identifier: MIT */
/* The parts of `grctl shell`. */
#ifndef GRCTL_SHELL_H
#define GRCTL_SHELL_H

#include <grobo/motion.h>

#include "conn.h"

enum { SHELL_LINE_BYTES = 4096, SHELL_WORDS_MAX = CLI_ARGUMENTS_MAX };

typedef struct shell {
    app *a;         /* of the shell's own command line */
    conn_link link; /* lent to the commands */
    app one;        /* the line that runs */
    grobo_motion *record;
    double time_ms;   /* of postures that are recorded, and of moves */
    bool reverse;     /* Start and DoRecord play backwards */
    bool over;        /* q */
    char device[256]; /* of connect; "": the command line's */
    const char *file; /* name of the script, NULL: a person types */
    int line;         /* of the script */
} shell;

/* ---- words ---------------------------------------------------------------------------------- */

/*
 * Splits a line into words in place, as a POSIX shell does with blanks, quotes and backslashes;
 * a word that begins with # ends it. Returns their number, or -1 when a quote stays open.
 */
int shell_split(char *line, char **words, int most);

/* ---- the original programs' letters and words ----------------------------------------------- */

typedef struct shell_word {
    const char *letter; /* "", or the letter of the same meaning */
    const char *word;   /* "", or the word */
    const char *arguments;
    const char *help;
    const char *command; /* what stands for it, split by blanks, or NULL: run */
    int (*run)(shell *s, int n, char **words);
} shell_word;

/* Row i of the table, NULL behind the last. */
const shell_word *shell_word_row(size_t i);
/* That of a letter or word, NULL for none. */
const shell_word *shell_word_find(const char *name);
/* The table as paragraphs, for help and manual. */
extern const char shell_details[];

/* The running line has what the shell's command line said, where it says nothing itself. */
void shell_inherit(shell *s);

/* Runs words as a command line of grctl. Returns its exit status. */
int shell_run(shell *s, int n, char **words);

/* ---- lines ---------------------------------------------------------------------------------- */

enum { LINE_END = -1, LINE_INTERRUPTED = -2 };

/* Tells what a word may be. */
typedef void (*line_found_fn)(void *ctx, const char *word, bool whole);

typedef struct line_reader line_reader;

/* NULL when there is no memory. The reader waits in the link's loop, so the line stays alive. */
line_reader *line_open(conn_link *link);
/* A line without its end. Returns its length, LINE_END, or LINE_INTERRUPTED by a signal. */
int line_read(line_reader *reader, const char *prompt, char *line, size_t capacity);
void line_close(line_reader *reader);

/* Waits for standard input in the link's loop: 1 readable, 0 a signal came. */
int line_wait(conn_link *link);

/*
 * What may stand at the end of the `length` bytes of a line: found() is called for each; whole is
 * false where more must follow (a folder). Returns how many bytes at the end they replace.
 */
size_t shell_complete(const char *line, size_t length, line_found_fn found, void *ctx);

#endif
