/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdarg.h>
#include <string.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/writer.h"
#include "tools/grctl/os/os.h"

enum { OUT_QUEUE_BYTES = 256 * 1024, ERR_QUEUE_BYTES = 32 * 1024, STAGE_BYTES = 32 * 1024 };
enum { COMPLAINT_BYTES = 2048 };

static int flush_errno;   /* of the first write that failed */
static bool dropped;      /* some of standard output */
static writer *out, *err; /* NULL: written by the C library */

/* What was printed for the writer since the last flush. */
static char stage[STAGE_BYTES];
static size_t staged;

static void note_error(int cause)
{
    if (cause && !flush_errno)
        flush_errno = os_write_cause(stdout, cause);
}

bool output_flush(void)
{
    if (out) {
        writer_put(out, stage, staged);
        staged = 0;
        note_error(writer_error(out));
        return flush_errno == 0;
    }
    int cause = ferror(stdout) ? EIO : 0; /* a write within printf(), which keeps no reason */
    if (fflush(stdout) != 0)
        cause = errno;
    note_error(cause);
    return flush_errno == 0;
}

void output_bytes(const void *bytes, size_t size)
{
    const char *from = bytes;
    if (!out) {
        fwrite(bytes, 1, size, stdout); /* output_flush() finds out whether it failed */
        return;
    }
    while (size > 0) {
        size_t room = sizeof stage - staged;
        size_t n = size < room ? size : room;
        memcpy(stage + staged, from, n);
        staged += n;
        from += n;
        size -= n;
        if (staged == sizeof stage)
            output_flush();
    }
}

void app_print(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    if (!out) {
        vprintf(format, list);
    } else {
        static char text[STAGE_BYTES];
        int n = vsnprintf(text, sizeof text, format, list);
        if (n > 0)
            output_bytes(text, (size_t)n < sizeof text ? (size_t)n : sizeof text - 1);
    }
    va_end(list);
}

FILE *output_stream(void)
{
    output_flush();
    if (out)
        writer_drain(out);
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

bool output_is_behind(void)
{
    return err && writer_is_behind(err);
}

bool output_detach(void)
{
    if (out)
        return true;
    output_flush();
    fflush(stderr);
    err = writer_new(stderr, ERR_QUEUE_BYTES);
    out = err ? writer_new(stdout, OUT_QUEUE_BYTES) : NULL;
    if (!out)
        writer_free(err);
    err = out ? err : NULL;
    return out != NULL;
}

static void report_dropped(const app *a, const char *name, uint64_t n)
{
    if (n > 0)
        app_note(a, "standard %s: %llu messages were dropped: its reader was too slow", name,
                 (unsigned long long)n);
}

void output_attach(const app *a)
{
    if (!out)
        return;
    output_flush();
    writer_drain(out);
    writer_drain(err);
    note_error(writer_error(out));
    uint64_t lost_out = writer_dropped(out), lost_err = writer_dropped(err);
    writer_free(out);
    writer_free(err);
    out = err = NULL;
    dropped |= lost_out > 0;
    report_dropped(a, "output", lost_out);
    report_dropped(a, "error", lost_err);
}

int output_finish(app *a, int status)
{
    output_attach(a);
    if (output_flush() || status != EXIT_DONE)
        return status == EXIT_DONE && dropped ? EXIT_ROBOT : status;
    if (flush_errno == EPIPE)
        return EXIT_SIGNAL + OS_BROKEN_PIPE;
    a->json = false; /* there is no output left to put it on */
    return app_fail(a, EXIT_ROBOT, "IO", "standard output: cannot write: %s",
                    file_cause_text(flush_errno));
}
