/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/grctl/os/pipe.h"

enum { WRITER_MS = 1000 };

typedef struct pipe_source {
    int fd;
    bool begun; /* a writer was there */
} pipe_source;

bool pipe_is(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISFIFO(status.st_mode);
}

static ssize_t read_some(int fd, void *buffer, size_t size)
{
    ssize_t n;
    do {
        n = read(fd, buffer, size);
    } while (n < 0 && errno == EINTR);
    return n;
}

/* Opened without blocking, a pipe reads as ended while nobody has opened it for writing. */
static ssize_t read_first(pipe_source *p, void *buffer, size_t size)
{
    struct pollfd one = {.fd = p->fd, .events = POLLIN};
    ssize_t n = read_some(p->fd, buffer, size);
    if (n == 0) {
        (void)poll(&one, 1, WRITER_MS);
        n = read_some(p->fd, buffer, size);
    }
    bool silent = n < 0 && errno == EAGAIN;
    p->begun = true;
    if (fcntl(p->fd, F_SETFL, 0) != 0) {
        return -1;
    }
    return silent ? read_some(p->fd, buffer, size) : n;
}

static int read_pipe(void *ctx, void *buffer, size_t size)
{
    pipe_source *p = ctx;
    ssize_t n = p->begun ? read_some(p->fd, buffer, size) : read_first(p, buffer, size);
    return n < 0 ? GROBO_ERR_IO : (int)n;
}

int pipe_read(const char *path, const grobo_read_options *options, grobo_diagnostics *list,
              grobo_motion **motion)
{
    pipe_source pipe = {.fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
    grobo_source source = {.read = read_pipe, .ctx = &pipe};
    grobo_read_options named = options ? *options : (grobo_read_options){GROBO_READ_OPTIONS_INIT};
    if (pipe.fd < 0) {
        return errno == EACCES ? GROBO_ERR_PERM : GROBO_ERR_IO;
    }
    named.name = path;
    int result = grobo_motion_read(&source, &named, list, motion);
    (void)close(pipe.fd);
    return result;
}
