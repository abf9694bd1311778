/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "file.h"
#include "os.h"
#include "output.h"

static int flush_errno; /* of the first write that failed */

bool output_flush(void)
{
    int cause = ferror(stdout) ? EIO : 0; /* a write within printf(), which keeps no reason */
    if (fflush(stdout) != 0)
        cause = errno;
    if (cause && !flush_errno)
        flush_errno = os_write_cause(stdout, cause);
    return flush_errno == 0;
}

int output_finish(app *a, int status)
{
    if (output_flush() || status != EXIT_DONE)
        return status;
    if (flush_errno == EPIPE)
        return EXIT_SIGNAL + OS_BROKEN_PIPE;
    a->json = false; /* there is no output left to put it on */
    return app_fail(a, EXIT_ROBOT, "IO", "standard output: cannot write: %s",
                    file_cause_text(flush_errno));
}
