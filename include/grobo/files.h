/* SPDX-License-Identifier: MIT */
/**
 * @file files.h
 * @brief What writing files needs beyond the C library: each port brings one table of these.
 */
#ifndef GROBO_FILES_H
#define GROBO_FILES_H

#include <grobo/types.h>

GROBO_BEGIN_DECLS

/** Longest path that is handled, with its NUL. */
#define GROBO_PATH_MAX_BYTES 4096

/** A file being written. Caller's storage; its members belong to the port. */
typedef struct grobo_file {
    /* private */
    intptr_t handle;
    bool exclusive;
    bool direct;
    char path[GROBO_PATH_MAX_BYTES];
    char temporary[GROBO_PATH_MAX_BYTES];
} grobo_file;

/**
 * The functions. All return 0 or GROBO_ERR_NOENT, GROBO_ERR_PERM, GROBO_ERR_ISDIR,
 * GROBO_ERR_EXISTS, GROBO_ERR_SPACE (path too long), GROBO_ERR_DISK, GROBO_ERR_NOMEM (memory, or no
 * descriptor is left), GROBO_ERR_IO. Thread safe for different files.
 */
typedef struct grobo_files {
    /**
     * Begins to write a file that commit() puts in the place of path: a temporary one beside it
     * (where path is a symbolic link: beside what it leads to), with the old one's mode. What is
     * no regular file (a pipe, a terminal) is written to directly.
     * @param exclusive commit() fails with GROBO_ERR_EXISTS when path is there by then.
     */
    int (*create)(grobo_file *file, const char *path, bool exclusive);
    /** Writes all of data. After an error only discard() may follow. */
    int (*write)(grobo_file *file, const void *data, size_t size);
    /** Makes it safe on the disk, then puts it in its place. Ends it, even on error. */
    int (*commit)(grobo_file *file);
    /** Ends it and leaves nothing behind. */
    void (*discard)(grobo_file *file);
    /**
     * The true path of an existing file, every symbolic link followed, which must lie in
     * directory (also with its links followed) or below. GROBO_ERR_OUTSIDE: it does not.
     * GROBO_ERR_ISDIR: it is a directory.
     */
    int (*inside)(const char *directory, const char *name, char *path, size_t path_bytes);
    /** True if path leads to a regular file that is not empty, which create() would replace. */
    bool (*holds)(const char *path);
} grobo_files;

/** The operating system's files. Static; thread safe. Implemented by the port. */
GROBO_API const grobo_files *grobo_files_os(void);

GROBO_END_DECLS

#endif
