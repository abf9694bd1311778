/* SPDX-License-Identifier: MIT */
/*
 * What the command asks of the operating system beyond grobo/core/port.h. A folder of os/ has it
 * for each, and keys.h, node.h and pipe.h too.
 */
#ifndef GRCTL_OS_H
#define GRCTL_OS_H

#include <stdbool.h>
#include <stdint.h>
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
/* May bytes be written to this stream without waiting for its reader, as far as it can be known? */
bool os_takes_bytes(FILE *stream);
/* Writes all of it, past what the stream has buffered. Waits. Returns 0 or errno. */
int os_write(FILE *stream, const void *bytes, size_t size);
/* May a line be written to this stream without waiting for who reads it? */
bool os_takes_line(FILE *stream);
/* What print() writes, to be freed; NULL when there is no room. */
char *os_printed(void (*print)(FILE *to));

/*
 * The path of this very program, for posix_spawn() and the like. argv0 is how it was called; the
 * result is argv0 or static.
 */
const char *os_own_program(const char *argv0);
/*
 * The path of a program of this name in the directory of this very one, or in ../libexec/grctl of
 * that. False where there is none, or path is too small.
 */
bool os_beside(const char *argv0, const char *name, char *path, size_t capacity);
/* Becomes that program, with these words (ending with NULL; the first is replaced by the path).
 * Returns where that cannot be. */
void os_become(const char *path, char *const *words);
/* What this machine is called, "" where it has no name. */
void os_host_name(char *name, size_t capacity);
/* Suspends this process, as Ctrl-Z does without a handler; returns when it continues. */
void os_suspend(void);

/*
 * Starts a program, words ending with NULL, that reads and writes these; in NULL: what this process
 * reads, err NULL: where this process complains. Returns what os_wait() wants, or -1: it is not
 * here.
 */
intptr_t os_begin(const char *const *words, FILE *in, FILE *out, FILE *err);
/* Waits for its end. Returns its exit status, 128 where it has none, or -1. */
int os_wait(intptr_t program);

/* ---- signals -------------------------------------------------------------------------------- */

/* What ends a command: Ctrl-C, a request, the end of its terminal, Ctrl-\, and the system's other
 * signals that would end it and can be caught; in the C library's numbers. */
enum { OS_INTERRUPT, OS_TERMINATE, OS_HANGUP, OS_QUIT, OS_ENDINGS_MAX = 12 };
extern const int os_endings[];
extern const int os_n_endings;
/* What a terminal suspends a command by (Ctrl-Z), 0 where there is no such thing. */
extern const int os_suspension;

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

/*
 * A file to be written from its beginning, or NULL with errno. waits: for the reader of a pipe that
 * has a name, if it has none.
 */
FILE *os_create(const char *path, bool waits);
/* The same, but where there is something of that name: NULL with EEXIST. */
FILE *os_create_new(const char *path);
/* Ends a file, of which nothing is buffered, at this size; what is written next follows there. */
int os_cut(FILE *file, long size);
/* Waits until the disk has what was written to the file. Returns 0 or errno. */
int os_sync(FILE *file);
/* The same for the names of the folder of a file, where the system has such a thing. */
void os_sync_folder(const char *path);
/* Of which not every system says so when it is opened as a file. */
bool os_is_folder(const char *path);
/* The configuration file: 0 the user's, 1 the machine's. False where there is none. */
bool os_config_path(int which, char *path, size_t capacity);
/* Makes the folders of a file that are not there. False: it cannot. */
bool os_make_folders(char *path);
/* A file of the user's state ($XDG_STATE_HOME/grctl), its folders made. False: there is none. */
bool os_state_path(const char *name, char *path, size_t capacity);

/* A file that one process has for itself. */
typedef struct os_lock {
    /* private */
    intptr_t handle;
    char path[4096 + 8];
} os_lock;

/*
 * Takes a file for this process by a second one beside it, PATH.lock, whatever name leads to the
 * file; the file itself may be replaced meanwhile, and need not be there. The lock ends with the
 * process. Returns 0, EWOULDBLOCK where another process has it, or an errno.
 */
int os_lock_file(os_lock *lock, const char *path);
void os_unlock_file(os_lock *lock);

/* ---- standard input on an event loop -------------------------------------------------------- */

/* Has this stand in for standard input, unless it is a file, for which nobody has to wait. */
bool os_input_take(FILE *from);

/*
 * Waits until there is something to read, or the end. Returns 0, or the number of one of os_endings
 * that came meanwhile (where the system lets it be waited for; else it ends the process).
 */
int os_wait_to_read(void);

/* bytes NULL: nothing more is heard, for lack of memory. */
typedef void (*os_input_fn)(void *ctx, const char *bytes, size_t size);

typedef struct os_input {
    /* private */
    struct event *readable, *resumed;
    os_input_fn fn;
    void *ctx;
} os_input;

/*
 * Hears standard input from now on, if it is a pipe or a terminal that this process has in the
 * foreground; its end ends nothing. False: no memory; os_input_stop() follows all the same.
 */
bool os_input_start(os_input *input, struct event_base *base, os_input_fn fn, void *ctx);
void os_input_stop(os_input *input);

/*
 * What becomes readable when os_input_read() has something; it asks the system for more.
 * EVUTIL_INVALID_SOCKET: there is nothing to wait for, all that will come is there.
 */
evutil_socket_t os_input_await(void);
/* Returns how many bytes, 0 none now, -1 the end. */
int os_input_read(void *bytes, size_t capacity);

#endif
