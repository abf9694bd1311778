/* SPDX-License-Identifier: MIT */
/* grobo/files.h: files that are replaced whole, and paths that stay in a directory. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <grobo/files.h>

#include "ports/posix/posix.h"

enum { TEMPORARIES_MAX = 100 }; /* names tried for one */

/* ---- writing ------------------------------------------------------------------------------ */

/* A new file beside path, with the mode that any new file gets. */
static int open_temporary(grobo_file *file)
{
    for (int n = 0; n < TEMPORARIES_MAX; n++) {
        int length = snprintf(file->temporary, sizeof file->temporary, "%s.%ld-%d~", file->path,
                              (long)getpid(), n);
        if (length < 0 || (size_t)length >= sizeof file->temporary) {
            return GROBO_ERR_SPACE;
        }
        int fd = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0) {
            file->handle = fd;
            return 0;
        }
        if (errno != EEXIST) {
            return grobo_i_posix_file_error(errno);
        }
    }
    return GROBO_ERR_EXISTS;
}

static int open_direct(grobo_file *file)
{
    int fd = open(file->path, O_WRONLY | O_CLOEXEC);

    if (fd < 0) {
        return grobo_i_posix_file_error(errno);
    }
    file->handle = fd;
    file->direct = true;
    return 0;
}

/* Gives the new file the mode, and if possible the owner, of the one that it will replace. */
static void take_over(int fd, const struct stat *old)
{
    if (fchown(fd, old->st_uid, old->st_gid) != 0) {
        /* Only root may give files away; then it is ours, as any file we make. */
        errno = 0;
    }
    (void)fchmod(fd, old->st_mode & 07777);
}

/* file->path: what path leads to, if it is there. */
static int set_path(grobo_file *file, const char *path, bool exclusive)
{
    char *real = exclusive ? NULL : realpath(path, NULL);
    int result = grobo_i_port_copy(file->path, sizeof file->path, real != NULL ? real : path);

    free(real);
    return result;
}

/*
 * What stands at a path: 1, and 0 for nothing. A link that is left in a true path leads to what is
 * open, as /dev/stdout to a pipe, or to nothing.
 */
static int look(const char *path, struct stat *status, bool *direct)
{
    if (lstat(path, status) != 0) {
        return 0;
    }
    bool link = S_ISLNK(status->st_mode);
    if (link && stat(path, status) != 0) {
        return grobo_i_posix_file_error(errno);
    }
    if (S_ISDIR(status->st_mode)) {
        return GROBO_ERR_ISDIR;
    }
    *direct = link || !S_ISREG(status->st_mode);
    return 1;
}

static int create(grobo_file *file, const char *path, bool exclusive)
{
    struct stat old;
    bool direct = false;

    file->handle = -1;
    file->exclusive = exclusive;
    file->direct = false;
    int result = set_path(file, path, exclusive);
    if (result < 0) {
        return result;
    }
    int there = look(file->path, &old, &direct);
    if (exclusive && there != 0) {
        return GROBO_ERR_EXISTS;
    }
    if (there < 0 || direct) {
        return direct ? open_direct(file) : there;
    }
    /* A directory's permission would be enough to replace it; that is not what its owner meant. */
    if (there && access(file->path, W_OK) != 0) {
        return grobo_i_posix_file_error(errno);
    }
    result = open_temporary(file);
    if (result == 0 && there) {
        take_over((int)file->handle, &old);
    }
    return result;
}

static int write_all(grobo_file *file, const void *data, size_t size)
{
    const char *from = data;

    while (size > 0) {
        ssize_t put = write((int)file->handle, from, size);
        if (put < 0 && errno != EINTR) {
            return grobo_i_posix_file_error(errno);
        }
        if (put > 0) {
            from += put;
            size -= (size_t)put;
        }
    }
    return 0;
}

/* The name of a file is safe when its directory is; some file systems have no such call. */
static void sync_directory(const char *path)
{
    char folder[GROBO_PATH_MAX_BYTES];

    if (grobo_i_port_copy(folder, sizeof folder, path) < 0) {
        return;
    }
    char *slash = strrchr(folder, '/');
    if (slash == folder) {
        slash++;
    }
    if (slash != NULL) {
        *slash = '\0';
    }
    int fd = open(slash != NULL ? folder : ".", O_RDONLY | O_CLOEXEC);
    if (fd >= 0) {
        (void)fsync(fd);
        (void)close(fd);
    }
}

/* Gives the temporary file its name, if nothing else has it. */
static int put_in_free_place(grobo_file *file)
{
    if (link(file->temporary, file->path) == 0) {
        (void)unlink(file->temporary);
        return 0;
    }
    if (errno == EEXIST) {
        return GROBO_ERR_EXISTS;
    }
    /* No links here: hold the place with an empty file. */
    int fd = open(file->path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0) {
        return grobo_i_posix_file_error(errno);
    }
    (void)close(fd);
    return rename(file->temporary, file->path) == 0 ? 0 : grobo_i_posix_file_error(errno);
}

static int put_in_place(grobo_file *file)
{
    if (file->exclusive) {
        return put_in_free_place(file);
    }
    return rename(file->temporary, file->path) == 0 ? 0 : grobo_i_posix_file_error(errno);
}

static void discard(grobo_file *file)
{
    if (file->handle >= 0) {
        (void)close((int)file->handle);
        file->handle = -1;
    }
    if (!file->direct) {
        (void)unlink(file->temporary);
    }
}

static int commit(grobo_file *file)
{
    int result = 0;

    /* A pipe or a terminal cannot be synced. */
    if (fsync((int)file->handle) != 0 && !file->direct) {
        result = grobo_i_posix_file_error(errno);
    }
    if (close((int)file->handle) != 0 && result == 0) {
        result = grobo_i_posix_file_error(errno);
    }
    file->handle = -1;
    if (file->direct) {
        return result;
    }
    if (result == 0) {
        result = put_in_place(file);
    }
    if (result < 0) {
        discard(file);
        return result;
    }
    sync_directory(file->path);
    return 0;
}

/* ---- paths -------------------------------------------------------------------------------- */

/* path lies in folder or below; both are true paths. */
static bool lies_in(const char *path, const char *folder)
{
    size_t length = strlen(folder);

    if (length > 0 && folder[length - 1] == '/') {
        return strncmp(path, folder, length) == 0;
    }
    return strncmp(path, folder, length) == 0 && path[length] == '/';
}

static int check_file(const char *real, const char *folder, char *path, size_t path_bytes)
{
    struct stat status;

    if (!lies_in(real, folder)) {
        return GROBO_ERR_OUTSIDE;
    }
    if (stat(real, &status) != 0) {
        return grobo_i_posix_file_error(errno);
    }
    return S_ISDIR(status.st_mode) ? GROBO_ERR_ISDIR : grobo_i_port_copy(path, path_bytes, real);
}

static int inside(const char *directory, const char *name, char *path, size_t path_bytes)
{
    char joined[GROBO_PATH_MAX_BYTES];
    char *folder = realpath(directory, NULL);

    if (folder == NULL) {
        return grobo_i_posix_file_error(errno);
    }
    int length = snprintf(joined, sizeof joined, "%s/%s", folder, name);
    int result = GROBO_ERR_SPACE;
    if (length > 0 && (size_t)length < sizeof joined) {
        char *real = realpath(joined, NULL);
        result = real != NULL ? check_file(real, folder, path, path_bytes)
                              : grobo_i_posix_file_error(errno);
        free(real);
    }
    free(folder);
    return result;
}

static bool holds(const char *path)
{
    struct stat status;

    return stat(path, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0;
}

int grobo_i_port_regular(const char *path)
{
    struct stat status;

    if (stat(path, &status) != 0) {
        return grobo_i_posix_file_error(errno);
    }
    return S_ISREG(status.st_mode)   ? GROBO_OK
           : S_ISDIR(status.st_mode) ? GROBO_ERR_ISDIR
                                     : GROBO_ERR_UNSUPPORTED;
}

const grobo_files *grobo_files_os(void)
{
    static const grobo_files files = {create, write_all, commit, discard, inside, holds};

    return &files;
}
