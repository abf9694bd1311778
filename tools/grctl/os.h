/* SPDX-License-Identifier: MIT */
/*
 * What the command asks of the operating system beyond grobo/port.h. A folder of os/ has it for
 * each, and keys.h, pipe.h and checkup_node() of checkup.h too.
 */
#ifndef GRCTL_OS_H
#define GRCTL_OS_H

#include <stdbool.h>
#include <stdio.h>

#include <event2/event.h>

/* ---- the process ---------------------------------------------------------------------------- */

/*
 * Before anything is opened: fills standard input, output and error where they are closed, so that
 * no file opened later gets their place (what is printed would go into it, and it may be the
 * robot's line), and has all of them take bytes as they are. Standard error
 * may be buffered from then on.
 */
void os_start(void);

bool os_is_terminal(FILE *stream);
/*
 * What kept a stream from being written, given the errno of it: EPIPE where nobody reads, which a
 * system may call otherwise, and a C library forget.
 */
int os_write_cause(FILE *stream, int cause);
/* The width of the terminal behind a stream; 80 where it does not say. */
int os_columns(FILE *stream);
/* Are characters beyond ASCII shown, and as UTF-8? */
bool os_shows_utf8(void);

/* A file to write and to read that is gone when it is closed, or NULL. */
FILE *os_temporary(void);
/* What print() writes, to be freed; NULL when there is no room. */
char *os_printed(void (*print)(FILE *to));

/* Runs a program, words ending with NULL. Returns its exit status, or -1: it is not here. */
int os_run(const char *const *words, FILE *in, FILE *out);

/* ---- signals -------------------------------------------------------------------------------- */

/* What ends a command: Ctrl-C, a request, the end of its terminal, Ctrl-\; in the C library's
 * numbers. */
enum { OS_INTERRUPT, OS_TERMINATE, OS_HANGUP, OS_QUIT, OS_ENDINGS };
extern const int os_endings[OS_ENDINGS];

/* SIGPIPE's number in exit statuses, also where there is no such signal. */
enum { OS_BROKEN_PIPE = 13 };

/* Has handler called for each of os_endings, now and again. */
void os_catch_endings(void (*handler)(int number));
/* Did who started us say that this one is to be ignored? */
bool os_is_ignored(int number);
/*
 * Before a loop watches os_endings: what a console says becomes one of them, and writing where
 * nobody reads is an error and not the end.
 */
void os_take_signals(void);

/* ---- files ---------------------------------------------------------------------------------- */

/* Of which not every system says so when it is opened as a file. */
bool os_is_folder(const char *path);
/* The configuration file: 0 the user's, 1 the machine's. False where there is none. */
bool os_config_path(int which, char *path, size_t capacity);
/*
 * The user's own folders for what lasts until log-out, 0 to OS_FOLDERS - 1; made where missing, and
 * nobody else's. Not each process of a user has the same of them: who leaves word leaves it in all.
 */
enum { OS_FOLDERS = 2 };
bool os_private_folder(int which, char *path, size_t capacity);
/* Where the links that a device's path has lead to, from the root. False where nothing is there. */
bool os_true_path(const char *device, char *path, size_t capacity);
/* An empty file that marks something: made, removed (fine when it is not there), looked for. */
bool os_mark(const char *path);
bool os_unmark(const char *path);
bool os_is_marked(const char *path);

/* ---- standard input on an event loop -------------------------------------------------------- */

/* Has this stand in for standard input, unless it is a file, for which nobody has to wait. */
bool os_input_take(FILE *from);

typedef void (*os_input_fn)(void *ctx, const char *bytes, size_t size);

typedef struct os_input {
    /* private */
    struct event *readable, *resumed;
    os_input_fn fn;
    void *ctx;
} os_input;

/*
 * Hears standard input from now on, if it is a pipe or a terminal that this process has in the
 * foreground; its end ends nothing.
 */
void os_input_start(os_input *input, struct event_base *base, os_input_fn fn, void *ctx);
void os_input_stop(os_input *input);

/*
 * What becomes readable when os_input_read() has something; it asks the system for more.
 * EVUTIL_INVALID_SOCKET: there is nothing to wait for, all that will come is there.
 */
evutil_socket_t os_input_await(void);
/* Returns how many bytes, 0 none now, -1 the end. */
int os_input_read(void *bytes, size_t capacity);

#endif
