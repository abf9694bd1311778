/* SPDX-License-Identifier: MIT */
/*
 * Notes that the programs of one user leave for each other, the processes that left them, and the
 * names under which they may know the same device. src/link makes emergency stops of these.
 *
 * A note is a small file in a directory that belongs to the user and that nobody else may enter
 * (POSIX: mode 0700, no symbolic link). What stands anywhere else is not read. There are two such
 * directories, because not every process of a user knows the same ones; a note is written into
 * both, and read from each.
 */
#ifndef GROBO_PORTS_NOTES_H
#define GROBO_PORTS_NOTES_H

#include <grobo/core/port.h>

enum { NOTE_FOLDERS = 2, NOTE_FOLDER_BYTES = 512, NOTE_NAME_BYTES = 240, NOTE_TEXT_BYTES = 2048 };

/* ---- notes: notes.c ------------------------------------------------------------------------- */

/*
 * Writes a note, or replaces it: a reader finds the old text or the new one. The directories are
 * made where they are missing.
 * Returns a bit (1 << folder) for each directory that has it now, or why none has: GROBO_ERR_PERM,
 * GROBO_ERR_NOMEM, GROBO_ERR_IO; then `cause` names the directory.
 */
int grobo_i_note_write(const char *name, const char *text, grobo_os_cause *cause);

/* The directories as they are now: who reads several notes looks once whom they belong to. An empty
 * path: there is none that can be trusted. */
typedef struct grobo_i_note_folders {
    char path[NOTE_FOLDERS][NOTE_FOLDER_BYTES];
} grobo_i_note_folders;
void grobo_i_note_folders_find(grobo_i_note_folders *folders);

/*
 * Reads a note of one directory; the text is cut to size. A note that is there but cannot be opened
 * (no free descriptor) is read as empty.
 * Returns GROBO_OK, or GROBO_ERR_NOENT where there is none that can be trusted.
 */
int grobo_i_note_read(const grobo_i_note_folders *in, int folder, const char *name, char *text,
                      size_t text_bytes);

/* What a note of one directory has until it is written again, 0 where there is none; takes no
 * descriptor. */
uint64_t grobo_i_note_stamp(const grobo_i_note_folders *in, int folder, const char *name);

/* Removes a note everywhere. GROBO_OK, also where there was none, or why one is left. */
int grobo_i_note_remove(const char *name, grobo_os_cause *cause);

/* ---- changes of notes: watch_linux.c ------------------------------------------------------- */

/*
 * Opens what becomes readable when a note comes, changes or goes in the directories as they are
 * now; they are made where they are missing. A child does not get it. The caller closes it.
 * Returns GROBO_SOCKET_NULL where the system does not tell of each of them (another system, no
 * descriptor free, a file system of the network): then the notes have to be looked at by the clock.
 */
grobo_socket grobo_i_note_watch_open(void);
void grobo_i_note_watch_close(grobo_socket watch);

/* What has come since it was read last. */
typedef enum grobo_i_note_news {
    NOTE_NEWS_NONE,
    NOTE_NEWS_NOTE, /* of a note with the prefix */
    NOTE_NEWS_GONE  /* a directory is another one, or none: open a new watch */
} grobo_i_note_news;
grobo_i_note_news grobo_i_note_watch_read(grobo_socket watch, const char *prefix);

/* ---- processes: process.c, process_linux.c -------------------------------------------------- */

/* A process, and not another one that has its number later. */
typedef struct grobo_i_process {
    int pid;
    uint64_t started; /* in the system's unit, since its start; 0: the system does not say */
} grobo_i_process;

void grobo_i_process_self(grobo_i_process *self);

/*
 * Is the process alive? Where `wake`, and it is stopped (SIGSTOP, Ctrl-Z), it continues.
 * Returns 0: alive; 1: alive, and it was stopped; GROBO_ERR_NOENT: it has exited; GROBO_ERR_PERM.
 */
int grobo_i_process_look(const grobo_i_process *process, bool wake);

/* ---- whoever has a device: owner_linux.c ---------------------------------------------------- */

/* A process that the system shows to have a device open. */
typedef struct grobo_i_holder {
    int pid;
    unsigned user, group;
    bool guard; /* it is called GROBO_GUARD_NAME */
} grobo_i_holder;

/*
 * Finds them, but for the calling process: those with the lock, where one has it. What the caller
 * may not look into is not found.
 * Returns their number, at most `max`; 0 for a device that is no serial port;
 * GROBO_ERR_UNSUPPORTED.
 */
int grobo_i_holders_find(const char *device, grobo_i_holder *holders, int max);

/*
 * Ends one of them by SIGTERM; asks a guard to stop the robot. By a pidfd, behind which the process
 * is looked at again: never another one that has its number by now. One that is stopped (SIGSTOP)
 * is left alone.
 * Returns GROBO_OK, GROBO_ERR_NOENT (it has the device no more), GROBO_ERR_STATE (it is stopped),
 * GROBO_ERR_PERM, GROBO_ERR_UNSUPPORTED.
 */
int grobo_i_holder_end(const char *device, const grobo_i_holder *holder);

/* ---- another user: notes.c, process_linux.c ------------------------------------------------- */

/*
 * Until the other call the notes are those of another user, and this thread has his rights on files
 * and no more: what he may have put into his directories leads nowhere else.
 * Returns GROBO_OK, GROBO_ERR_PERM (the caller is not root), GROBO_ERR_UNSUPPORTED.
 */
int grobo_i_note_user_begin(unsigned user, unsigned group);
bool grobo_i_is_root(void); /* it may do that */
void grobo_i_note_user_end(void);

/* ---- names of a device: names.c ------------------------------------------------------------- */

enum { DEVICE_NAMES = 6 };

/* The names that a device has, or had where it is missing now. */
typedef struct grobo_i_device_names {
    char name[DEVICE_NAMES][GROBO_DEVICE_MAX_BYTES];
    int n;
    int passing; /* the one that another device may have later, -1 none */
} grobo_i_device_names;

/* Follows links, and finds the name that stays when it is plugged in elsewhere. */
void grobo_i_device_names_find(const char *device, grobo_i_device_names *names);

#endif
