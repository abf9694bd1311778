/* SPDX-License-Identifier: MIT */
/* Linux: who has a device open, by /proc. The other systems' answer is at the end. */
#include <stdio.h>

#include "ports/common/notes.h"
#include "ports/posix/posix.h"

#ifdef __linux__

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

/* /proc/locks is readable by all, and says who has the flock: "1: FLOCK ADVISORY WRITE pid
 * major:minor:inode 0 EOF". */
static int lock_holder(const struct stat *node)
{
    FILE *locks = fopen("/proc/locks", "re");
    char line[160];
    int holder = 0;

    if (locks == NULL) {
        return 0;
    }
    while (holder == 0 && fgets(line, sizeof line, locks) != NULL) {
        unsigned major_no;
        unsigned minor_no;
        uint64_t inode;
        int pid;

        if (sscanf(line, "%*d: FLOCK %*s %*s %d %x:%x:%" SCNu64, &pid, &major_no, &minor_no,
                   &inode) == 4 &&
            pid > 0 && major_no == major(node->st_dev) && minor_no == minor(node->st_dev) &&
            inode == (uint64_t)node->st_ino) {
            holder = pid;
        }
    }
    (void)fclose(locks);
    return holder;
}

/* Does this descriptor of a process carry a flock? Its fdinfo says so, see proc(5). */
static bool carries_lock(int pid, const char *fd)
{
    char path[64];
    char line[160];
    FILE *info;
    bool found = false;

    snprintf(path, sizeof path, "/proc/%d/fdinfo/%.20s", pid, fd);
    info = fopen(path, "re");
    while (!found && info != NULL && fgets(line, sizeof line, info) != NULL) {
        found = strncmp(line, "lock:", 5) == 0 && strstr(line, "FLOCK") != NULL;
    }
    if (info != NULL) {
        (void)fclose(info);
    }
    return found;
}

static bool has_open(int pid, const struct stat *node, bool locked)
{
    char path[64];
    DIR *fds;
    const struct dirent *entry;
    bool found = false;

    snprintf(path, sizeof path, "/proc/%d/fd", pid);
    fds = opendir(path);
    if (fds == NULL) {
        return false;
    }
    while (!found && (entry = readdir(fds)) != NULL) {
        struct stat st;

        found = fstatat(dirfd(fds), entry->d_name, &st, 0) == 0 && S_ISCHR(st.st_mode) &&
                st.st_rdev == node->st_rdev && st.st_ino == node->st_ino &&
                st.st_dev == node->st_dev && (!locked || carries_lock(pid, entry->d_name));
    }
    (void)closedir(fds);
    return found;
}

/*
 * The first process that has the device open, with the lock of it if so wanted, of those that this
 * user may look into.
 */
static int user_of(const struct stat *node, bool locked)
{
    DIR *proc = opendir("/proc");
    const struct dirent *entry;
    int user = 0;

    if (proc == NULL) {
        return 0;
    }
    while (user == 0 && (entry = readdir(proc)) != NULL) {
        char *end;
        long pid = strtol(entry->d_name, &end, 10);

        if (*end == '\0' && pid > 0 && pid != getpid() && has_open((int)pid, node, locked)) {
            user = (int)pid;
        }
    }
    (void)closedir(proc);
    return user;
}

/* One that died may have left its lock to others with the same opening: its guard, or a child. */
static int holder_of(const struct stat *node)
{
    int pid = lock_holder(node);
    bool died = pid != 0 && kill(pid, 0) != 0 && errno == ESRCH;
    int heir = died ? user_of(node, true) : 0;

    return heir != 0 ? heir : pid;
}

static void name_of(int pid, char *name, size_t name_bytes)
{
    char path[64];
    FILE *comm;

    snprintf(path, sizeof path, "/proc/%d/comm", pid);
    comm = fopen(path, "re");
    if (comm == NULL || fgets(name, (int)name_bytes, comm) == NULL) {
        snprintf(name, name_bytes, "?");
    }
    if (comm != NULL) {
        (void)fclose(comm);
    }
    name[strcspn(name, "\n")] = '\0';
}

int grobo_i_posix_owner(const char *device, char *name, size_t name_bytes, bool *locked)
{
    struct stat node;
    int pid;

    *locked = false;
    if (stat(device, &node) != 0 || !S_ISCHR(node.st_mode)) {
        return 0;
    }
    pid = holder_of(&node);
    *locked = pid != 0;
    if (pid == 0) {
        pid = user_of(&node, false);
    }
    if (pid != 0 && name_bytes > 0) {
        name_of(pid, name, name_bytes);
    }
    return pid;
}

/* One process of /proc, if it has the device. */
static bool look_at(int pid, const struct stat *node, bool locked, grobo_i_holder *holder)
{
    char path[32];
    char name[64];
    struct stat st;

    snprintf(path, sizeof path, "/proc/%d", pid);
    if (pid == getpid() || !has_open(pid, node, locked) || stat(path, &st) != 0) {
        return false;
    }
    name_of(pid, name, sizeof name);
    *holder = (grobo_i_holder){.pid = pid,
                               .user = (unsigned)st.st_uid,
                               .group = (unsigned)st.st_gid,
                               .guard = strcmp(name, GROBO_GUARD_NAME) == 0};
    return true;
}

static int find_holders(const struct stat *node, bool locked, grobo_i_holder *holders, int max)
{
    DIR *proc = opendir("/proc");
    const struct dirent *entry;
    int n = 0;

    while (proc != NULL && n < max && (entry = readdir(proc)) != NULL) {
        char *end;
        long pid = strtol(entry->d_name, &end, 10);

        n += *end == '\0' && pid > 0 && look_at((int)pid, node, locked, &holders[n]);
    }
    if (proc != NULL) {
        (void)closedir(proc);
    }
    return n;
}

static bool is_port(const char *device, struct stat *node)
{
    return stat(device, node) == 0 && S_ISCHR(node->st_mode);
}

int grobo_i_holders_find(const char *device, grobo_i_holder *holders, int max)
{
    struct stat node;
    int n = 0;

    if (is_port(device, &node)) {
        n = find_holders(&node, true, holders, max);
        n = n > 0 ? n : find_holders(&node, false, holders, max);
    }
    return n;
}

int grobo_i_holder_end(const char *device, const grobo_i_holder *holder)
{
    const grobo_i_process process = {.pid = holder->pid};
    struct stat node;
    grobo_i_holder now;
    int pidfd = grobo_i_posix_open_process(holder->pid);
    int r;

    if (pidfd < 0) {
        return pidfd;
    }
    /* From here on the number is that of this process, or of nobody. */
    if (!is_port(device, &node) || !look_at(holder->pid, &node, false, &now) ||
        now.user != holder->user || now.guard != holder->guard) {
        r = GROBO_ERR_NOENT;
    } else if (grobo_i_process_look(&process, false) == 1) {
        r = GROBO_ERR_STATE;
    } else {
        r = grobo_i_posix_signal(pidfd, now.guard ? GUARD_SIGNAL : SIGTERM);
    }
    (void)close(pidfd);
    return r;
}

bool grobo_i_posix_exclusive_sticks(dev_t device)
{
    /* Unix 98 pty slaves: Documentation/admin-guide/devices.txt of the kernel. */
    return major(device) >= 136 && major(device) <= 143;
}

#else

int grobo_i_holders_find(const char *device, grobo_i_holder *holders, int max)
{
    (void)device;
    (void)holders;
    (void)max;
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_holder_end(const char *device, const grobo_i_holder *holder)
{
    (void)device;
    (void)holder;
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_posix_owner(const char *device, char *name, size_t name_bytes, bool *locked)
{
    (void)device;
    (void)name;
    (void)name_bytes;
    *locked = false;
    return 0;
}

bool grobo_i_posix_exclusive_sticks(dev_t device)
{
    (void)device;
    return false;
}

#endif

int grobo_port_owner(const char *device, char *name, size_t name_bytes)
{
    if (device == NULL || name == NULL) {
        return GROBO_ERR_ARG;
    }
    bool locked;

    return grobo_i_posix_owner(device, name, name_bytes, &locked);
}
