/* SPDX-License-Identifier: MIT */
/* Notes between the programs of one user, in directories that nobody else may enter. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ports/common/notes.h"
#include "ports/posix/posix.h"

enum { PATH_BYTES = NOTE_FOLDER_BYTES + NOTE_NAME_BYTES + 32 };

static const char shared_parent[] = "/tmp";

/* ---- whose notes -------------------------------------------------------------------------- */

static _Thread_local struct {
    bool on;
    uid_t user;
} other;

static uid_t its_user(void)
{
    return other.on ? other.user : geteuid();
}

bool grobo_i_is_root(void)
{
    return geteuid() == 0;
}

int grobo_i_note_user_begin(unsigned user, unsigned group)
{
    int r = grobo_i_is_root() ? grobo_i_posix_be_user((uid_t)user, (gid_t)group) : GROBO_ERR_PERM;

    if (r >= 0) {
        other.on = true;
        other.user = (uid_t)user;
    }
    return r;
}

void grobo_i_note_user_end(void)
{
    if (other.on) {
        other.on = false;
        (void)grobo_i_posix_be_user(geteuid(), getegid());
    }
}

/* ---- directories -------------------------------------------------------------------------- */

/* Belongs to the user, and nobody else may look into it. */
static bool is_private(const char *path)
{
    struct stat st;

    return lstat(path, &st) == 0 && S_ISDIR(st.st_mode) && st.st_uid == its_user() &&
           (st.st_mode & 077) == 0;
}

/* Nobody but the user and root can rename what is in it. */
static bool is_safe_parent(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISDIR(st.st_mode) &&
           (st.st_uid == its_user() || st.st_uid == 0) &&
           ((st.st_mode & 022) == 0 || (st.st_mode & S_ISVTX) != 0);
}

static bool make_private(const char *path)
{
    return mkdir(path, 0700) == 0 && is_private(path);
}

/* That of the login session, which a service or a job of cron does not have. */
static bool session_folder(char *path, bool make)
{
    char its[32];
    const char *run = getenv("XDG_RUNTIME_DIR");

    if (other.on) { /* as pam_systemd(8) makes it */
        snprintf(its, sizeof its, "/run/user/%lu", (unsigned long)other.user);
        run = its;
    }
    if (run == NULL || run[0] != '/') {
        return false;
    }
    static const char name[] = "/grobo";
    size_t size = strlen(run);

    if (size > NOTE_FOLDER_BYTES - sizeof name || !is_safe_parent(run)) {
        return false;
    }
    memcpy(path, run, size);
    memcpy(path + size, name, sizeof name);
    return is_private(path) || (make && make_private(path));
}

/* The user's directory whose name begins with `base`: another one. */
static bool find_substitute(const char *base, char *path)
{
    const char *prefix = base + sizeof shared_parent;
    size_t size = strlen(prefix);
    DIR *parent = opendir(shared_parent);
    const struct dirent *entry;
    bool found = false;

    if (parent == NULL) {
        return false;
    }
    while (!found && (entry = readdir(parent)) != NULL) {
        int n = -1;

        if (strncmp(entry->d_name, prefix, size) == 0 && entry->d_name[size] == '.') {
            n = snprintf(path, NOTE_FOLDER_BYTES, "%s/%s", shared_parent, entry->d_name);
        }
        found = n > 0 && n < NOTE_FOLDER_BYTES && is_private(path);
    }
    (void)closedir(parent);
    return found;
}

/* The plain name of the next one, in the end of `buf`: it is asked for twenty times a second. */
static const char *shared_name(char buf[64])
{
    static const char prefix[] = "/grobo-";
    const size_t in = sizeof shared_parent - 1, size = sizeof prefix - 1;
    unsigned long uid = its_user();
    char *at = buf + 63;

    *at = '\0';
    do {
        *--at = (char)('0' + uid % 10);
        uid /= 10;
    } while (uid > 0);
    memcpy(at - size, prefix, size);
    return memcpy(at - size - in, shared_parent, in);
}

/*
 * That of all processes of the user. Another user can take its name first, so that one with a
 * random ending is made; it gets the plain name as soon as that is free. The search is paid for
 * only in this state.
 */
static bool shared_folder(char *path, bool make)
{
    char buf[64];
    const char *base = shared_name(buf);
    struct stat st;

    memcpy(path, base, strlen(base) + 1);
    if (is_private(base)) {
        return true;
    }
    if (!is_safe_parent(shared_parent)) {
        return false;
    }
    bool taken = lstat(base, &st) == 0;

    if (find_substitute(base, path)) {
        if (!taken && rename(path, base) == 0) {
            snprintf(path, NOTE_FOLDER_BYTES, "%s", base);
        }
        return is_private(path);
    }
    snprintf(path, NOTE_FOLDER_BYTES, "%s%s", base, taken ? ".XXXXXX" : "");
    if (!make) {
        return false;
    }
    return taken ? mkdtemp(path) != NULL && is_private(path) : make_private(path);
}

static bool find_folder(int folder, bool make, char *path)
{
    return folder == 0 ? session_folder(path, make) : shared_folder(path, make);
}

void grobo_i_note_folders_find(grobo_i_note_folders *folders)
{
    for (int i = 0; i < NOTE_FOLDERS; i++) {
        if (!find_folder(i, false, folders->path[i])) {
            folders->path[i][0] = '\0';
        }
    }
}

int grobo_i_posix_note_folders(grobo_i_note_folders *folders)
{
    const char *run = getenv("XDG_RUNTIME_DIR");
    int n = 0;

    for (int i = 0; i < NOTE_FOLDERS; i++) {
        bool has = find_folder(i, true, folders->path[i]);

        if (!has && (i != 0 || (run != NULL && run[0] != '\0'))) {
            return GROBO_ERR_NOENT; /* there may be one later */
        }
        if (!has) {
            folders->path[i][0] = '\0';
        }
        n += has;
    }
    return n;
}

/* The path of a name in a directory. */
static bool join(const char *in, const char *name, char *path)
{
    size_t folder = strlen(in), size = strlen(name) + 1;

    if (folder == 0 || folder + 1 + size > PATH_BYTES) {
        return false;
    }
    memcpy(path, in, folder);
    path[folder] = '/';
    memcpy(path + folder + 1, name, size);
    return true;
}

/* The same in a directory that can be trusted. */
static bool place(int folder, const char *name, bool make, char *path)
{
    char in[NOTE_FOLDER_BYTES];

    return find_folder(folder, make, in) && join(in, name, path);
}

/* ---- notes -------------------------------------------------------------------------------- */

static bool write_text(int fd, const char *text)
{
    size_t left = strlen(text);

    while (left > 0) {
        ssize_t put = write(fd, text, left);

        if (put < 0 && errno != EINTR) {
            return false;
        }
        if (put > 0) {
            text += put;
            left -= (size_t)put;
        }
    }
    return true;
}

/* Replaces the note at once: what is there meanwhile is whole. */
static int write_at(const char *path, const char *text, grobo_os_cause *cause)
{
    char next[PATH_BYTES + 16];
    int fd;
    bool whole;
    int code;

    snprintf(next, sizeof next, "%s~%ld", path, (long)getpid());
    (void)unlink(next);
    fd = open(next, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (fd < 0) {
        return grobo_i_posix_fail(cause, errno, path);
    }
    whole = write_text(fd, text);
    code = errno;
    if (close(fd) != 0 && whole) {
        code = errno;
        whole = false;
    }
    if (whole && rename(next, path) != 0) {
        code = errno;
        whole = false;
    }
    if (!whole) {
        (void)unlink(next);
    }
    return whole ? GROBO_OK : grobo_i_posix_fail(cause, code, path);
}

int grobo_i_note_write(const char *name, const char *text, grobo_os_cause *cause)
{
    char path[PATH_BYTES];
    int written = 0;
    int r = grobo_i_port_refuse(cause, GROBO_ERR_PERM,
                                "no directory that belongs to this user alone (mode 0700)");

    for (int folder = 0; folder < NOTE_FOLDERS; folder++) {
        if (place(folder, name, true, path)) {
            int error = write_at(path, text, cause);

            written |= error < 0 ? 0 : 1 << folder;
            r = error < 0 ? error : r;
        }
    }
    return written != 0 ? written : r;
}

/* A file that the user made, and that nobody else may have written to. */
static bool is_own(const struct stat *st)
{
    return S_ISREG(st->st_mode) && st->st_uid == its_user() && (st->st_mode & 022) == 0;
}

int grobo_i_note_read(const grobo_i_note_folders *in, int folder, const char *name, char *text,
                      size_t text_bytes)
{
    char path[PATH_BYTES];
    struct stat st;
    ssize_t got = 0;
    int fd;

    if (!join(in->path[folder], name, path) || lstat(path, &st) != 0 || !is_own(&st)) {
        return GROBO_ERR_NOENT;
    }
    /* Where another user's is read, he may put a pipe in its place meanwhile: it must not wait. */
    fd = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd >= 0) {
        got = read(fd, text, text_bytes - 1);
        (void)close(fd);
    } else if (errno == ENOENT) {
        return GROBO_ERR_NOENT;
    }
    text[got > 0 ? got : 0] = '\0';
    return GROBO_OK;
}

/* A note that is replaced is another file, with a time of its own. */
uint64_t grobo_i_note_stamp(const grobo_i_note_folders *in, int folder, const char *name)
{
    char path[PATH_BYTES];
    struct stat st;

    if (!join(in->path[folder], name, path) || lstat(path, &st) != 0) {
        return 0;
    }
    return ((uint64_t)st.st_ino << 32 ^ (uint64_t)st.st_mtime) + 1;
}

int grobo_i_note_remove(const char *name, grobo_os_cause *cause)
{
    char path[PATH_BYTES];
    int r = GROBO_OK;

    for (int folder = 0; folder < NOTE_FOLDERS; folder++) {
        if (place(folder, name, false, path) && unlink(path) != 0 && errno != ENOENT) {
            r = grobo_i_posix_fail(cause, errno, path);
        }
    }
    return r;
}
