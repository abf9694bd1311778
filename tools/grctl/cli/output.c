/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdarg.h>
#include <string.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/writer.h"
#include "tools/grctl/os/os.h"

enum { OUT_QUEUE_BYTES = 256 * 1024, ERR_QUEUE_BYTES = 32 * 1024, STAGE_BYTES = 32 * 1024 };
enum { COMPLAINT_BYTES = 2048 };

static int flush_errno;   /* of the first write that failed */
static writer *out, *err; /* NULL: written by the C library */

/* What was printed for the writer since the last flush. */
static char stage[STAGE_BYTES];
static size_t staged;

static void note_error(int cause)
{
    if (cause && !flush_errno) {
        flush_errno = os_write_cause(stdout, cause);
    }
}

bool output_flush(void)
{
    if (out) {
        writer_put(out, stage, staged);
        staged = 0;
        note_error(writer_look(out).error);
        return flush_errno == 0;
    }
    int cause = ferror(stdout) ? EIO : 0; /* a write within printf(), which keeps no reason */
    if (fflush(stdout) != 0) {
        cause = errno;
    }
    note_error(cause);
    return flush_errno == 0;
}

void output_bytes(const void *bytes, size_t size)
{
    const char *from = bytes;
    if (!out) {
        if (fwrite(bytes, 1, size, stdout) < size) {
            note_error(errno);
        }
        return;
    }
    while (size > 0) {
        size_t room = sizeof stage - staged;
        size_t n = size < room ? size : room;
        memcpy(stage + staged, from, n);
        staged += n;
        from += n;
        size -= n;
        if (staged == sizeof stage) {
            output_flush();
        }
    }
}

int output_error(void)
{
    return flush_errno;
}

void output_print(const char *format, va_list list)
{
    if (!out) {
        if (vprintf(format, list) < 0) {
            note_error(errno);
        }
    } else {
        static char text[STAGE_BYTES];
        int n = vsnprintf(text, sizeof text, format, list);
        if (n > 0) {
            output_bytes(text, (size_t)n < sizeof text ? (size_t)n : sizeof text - 1);
        }
    }
}

FILE *output_stream(void)
{
    output_flush();
    if (out) {
        writer_drain(out);
    }
    return stdout;
}

void output_complain(const char *format, ...)
{
    char text[COMPLAINT_BYTES];
    va_list list;
    va_start(list, format);
    int n = vsnprintf(text, sizeof text, format, list);
    va_end(list);
    size_t size = n < 0 ? 0 : (size_t)n < sizeof text ? (size_t)n : sizeof text - 1;
    if (err) {
        writer_put(err, text, size);
        return;
    }
    fwrite(text, 1, size, stderr);
    fflush(stderr);
}

bool output_is_behind(const FILE *stream)
{
    const writer *to = stream == stdout ? out : err;
    return to && writer_look(to).behind;
}

bool output_detach(void)
{
    if (out) {
        return true;
    }
    output_flush();
    fflush(stderr);
    err = writer_new(stderr, ERR_QUEUE_BYTES);
    out = err ? writer_new(stdout, OUT_QUEUE_BYTES) : NULL;
    if (!out) {
        writer_free(err);
    }
    err = out ? err : NULL;
    return out != NULL;
}

output_dropped output_attach(void)
{
    output_dropped dropped = {0, 0};
    if (!out) {
        return dropped;
    }
    output_flush();
    writer_drain(out);
    writer_drain(err);
    note_error(writer_look(out).error);
    dropped = (output_dropped){writer_look(out).dropped, writer_look(err).dropped};
    writer_free(out);
    writer_free(err);
    out = err = NULL;
    return dropped;
}
