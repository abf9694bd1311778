/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "output.h"

static int flush_errno; /* of the first write that failed */

void output_guard(void)
{
    static const int wrong_way[] = {O_WRONLY, O_RDONLY, O_RDONLY};
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", wrong_way[fd]) != fd)
            _exit(EXIT_ROBOT);
}

bool output_flush(void)
{
    bool broken = ferror(stdout) != 0;
    if (fflush(stdout) != 0 && !flush_errno)
        flush_errno = errno;
    else if (broken && !flush_errno)
        flush_errno = EIO; /* a write within printf(), which keeps no reason */
    return flush_errno == 0;
}

int output_finish(app *a, int status)
{
    if (output_flush() || status != EXIT_DONE)
        return status;
    if (flush_errno == EPIPE)
        return EXIT_SIGNAL + SIGPIPE;
    a->json = false; /* there is no output left to put it on */
    return app_fail(a, EXIT_ROBOT, "IO", "standard output: cannot write: %s",
                    strerror(flush_errno));
}
