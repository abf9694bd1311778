/* SPDX-License-Identifier: MIT */
/* Linux: notes that come and go, by inotify(7). The other systems' answer is at the end. */
#include "ports/common/notes.h"
#include "ports/posix/posix.h"

#ifdef __linux__

#include <limits.h>
#include <stdint.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/vfs.h>
#include <unistd.h>

/* Renamed to its name, or made with it; IN_ATTRIB: it belongs to the user alone from now on. */
#define OF_NOTES (IN_CREATE | IN_MOVED_TO | IN_CLOSE_WRITE | IN_ATTRIB | IN_DELETE | IN_MOVED_FROM)
#define OF_FOLDER (IN_DELETE_SELF | IN_MOVE_SELF)

/* File systems on which all that writes is this machine's, by statfs(2): inotify tells nothing of
 * what another machine writes. */
static bool is_local(const char *path)
{
    static const uint32_t local[] = {
        0x01021994, /* tmpfs */
        0x858458F6, /* ramfs */
        0x0000EF53, /* ext2 to ext4 */
        0x9123683E, /* btrfs */
        0x58465342, /* xfs */
        0xF2F52010, /* f2fs */
        0x794C7630, /* overlayfs */
        0x2FC12FC1, /* zfs */
        0x24051905, /* ubifs */
        0x000072B6, /* jffs2 */
    };
    struct statfs fs;
    bool found = false;

    if (statfs(path, &fs) != 0) {
        return false;
    }
    for (size_t i = 0; i < sizeof local / sizeof local[0] && !found; i++) {
        found = (uint32_t)fs.f_type == local[i];
    }
    return found;
}

grobo_socket grobo_i_note_watch_open(void)
{
    grobo_i_note_folders folders;
    bool whole = grobo_i_posix_note_folders(&folders) > 0;
    int fd = whole ? inotify_init1(IN_NONBLOCK | IN_CLOEXEC) : -1;

    if (fd < 0) {
        return GROBO_SOCKET_NULL;
    }
    for (int i = 0; i < NOTE_FOLDERS && whole; i++) {
        const char *path = folders.path[i];

        whole =
            path[0] == '\0' ||
            (is_local(path) && inotify_add_watch(fd, path, OF_NOTES | OF_FOLDER | IN_ONLYDIR) >= 0);
    }
    if (!whole) {
        (void)close(fd);
        fd = GROBO_SOCKET_NULL;
    }
    return fd;
}

void grobo_i_note_watch_close(grobo_socket watch)
{
    if (watch != GROBO_SOCKET_NULL) {
        (void)close(watch);
    }
}

static grobo_i_note_news news_of(const struct inotify_event *event, const char *prefix)
{
    bool named = event->len > 0;

    if ((event->mask & (OF_FOLDER | IN_IGNORED | IN_UNMOUNT)) != 0 ||
        (!named && (event->mask & IN_ATTRIB) != 0)) { /* whose it is, and who may enter */
        return NOTE_NEWS_GONE;
    }
    bool lost = (event->mask & IN_Q_OVERFLOW) != 0;

    return lost || (named && strncmp(event->name, prefix, strlen(prefix)) == 0) ? NOTE_NEWS_NOTE
                                                                                : NOTE_NEWS_NONE;
}

grobo_i_note_news grobo_i_note_watch_read(grobo_socket watch, const char *prefix)
{
    union {
        struct inotify_event aligned;
        char bytes[4 * (sizeof(struct inotify_event) + NAME_MAX + 1)];
    } buf;
    grobo_i_note_news news = NOTE_NEWS_NONE;
    ssize_t got;

    while ((got = read(watch, buf.bytes, sizeof buf.bytes)) > 0) {
        for (size_t at = 0; at + sizeof buf.aligned <= (size_t)got;) {
            const struct inotify_event *event = (const void *)(buf.bytes + at);
            grobo_i_note_news its = news_of(event, prefix);

            news = its > news ? its : news;
            at += sizeof *event + event->len;
        }
    }
    return news;
}

#else

grobo_socket grobo_i_note_watch_open(void)
{
    return GROBO_SOCKET_NULL;
}

void grobo_i_note_watch_close(grobo_socket watch)
{
    (void)watch;
}

grobo_i_note_news grobo_i_note_watch_read(grobo_socket watch, const char *prefix)
{
    (void)watch;
    (void)prefix;
    return NOTE_NEWS_NONE;
}

#endif
