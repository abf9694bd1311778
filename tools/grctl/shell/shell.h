/* SPDX-License-Identifier: MIT */
/* The parts of `grctl shell`. */
#ifndef GRCTL_SHELL_H
#define GRCTL_SHELL_H

#include <signal.h>

#include <grobo/core/motion.h>

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/term/edit.h"

enum {
    SHELL_LINE_BYTES = 4096,         /* typed */
    SHELL_SCRIPT_LINE_BYTES = 65536, /* with the byte that ends it */
    SHELL_WORDS_MAX = CLI_ARGUMENTS_MAX
};

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

enum { SHELL_OPEN_QUOTE = -1, SHELL_TOO_MANY = -2 };

/*
 * Splits a line into words in place, as a POSIX shell does with blanks, quotes and backslashes;
 * a word that begins with # ends it. Returns their number, or one of the above.
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
/* Its two lines of help. Returns what snprintf() does. */
int shell_word_text(const shell_word *w, char *text, size_t capacity);
/* That of a letter or word, NULL for none. */
const shell_word *shell_word_find(const char *name);
/* The command or word that is nearest to a name, or NULL; a command that it is comes first. */
const char *shell_nearest(const char *name);
/* What help and manual say of it, and the table behind that as paragraphs, in the language. */
extern const char shell_details[];
const char *shell_words(void);

/* A line begins: nothing is known of it. */
void shell_begin(shell *s);

/* The running line has what the shell's command line said, where it says nothing itself. */
void shell_inherit(shell *s);

/* Runs words as a command line of grctl. Returns its exit status. */
int shell_run(shell *s, int n, char **words);

/* ---- lines ---------------------------------------------------------------------------------- */

/* A script, read on the loop where it has to be waited for. */
typedef struct shell_script {
    FILE *file; /* NULL: standard input */
    char line[SHELL_SCRIPT_LINE_BYTES];
    const char *wrong; /* why the line cannot be run, or NULL */
    /* private */
    size_t used;     /* of the line */
    bool ended;      /* the line: the next byte begins another one */
    size_t at, held; /* of the block */
    char block[4096];
} shell_script;

/*
 * The next line. Returns its length, LINE_END, LINE_INTERRUPTED by a signal, or LINE_NEWS; after
 * these it goes on where it was.
 */
int shell_script_next(shell *s, shell_script *in);

/* A signal that came while no command had the robot and nobody waited for a line, 0 none. */
extern volatile sig_atomic_t shell_noted;

/*
 * Waits for standard input in the link's loop, so the line stays alive; s is the shell. Returns 0,
 * LINE_INTERRUPTED or LINE_NEWS: conn_link_news() has something to say.
 */
int shell_wait(void *s);

/* For line_owner. */
size_t shell_complete(void *of, const char *line, size_t length, line_found_fn found, void *ctx);

#endif
