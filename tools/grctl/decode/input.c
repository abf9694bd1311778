/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "tools/grctl/decode/input.h"
#include "tools/grctl/os/os.h"

int input_open(input *in, app *a, const char *path)
{
    memset(in, 0, sizeof *in);
    errno = 0;
    if (strcmp(path, "-") == 0) {
        in->file = stdin;
        in->name = "(standard input)";
    } else {
        in->file = fopen(path, "rb");
        in->name = path;
    }
    if (in->file) {
        in->n_peeked = fread(in->peeked, 1, sizeof in->peeked, in->file);
    }
    if (!in->file || ferror(in->file)) {
        int cause = in->name == path && os_is_folder(path) ? EISDIR : errno;
        input_close(in);
        return app_fail_cause(a, EXIT_FILE, cause, "%s", path);
    }
    return 0;
}

void input_close(input *in)
{
    if (in->file && in->file != stdin) {
        fclose(in->file);
    }
    in->file = NULL;
}

bool input_is_pcapng(const input *in)
{
    return in->n_peeked == sizeof in->peeked && pcapng_is_start(in->peeked);
}

size_t input_read(void *ctx, void *buffer, size_t size)
{
    input *in = ctx;
    size_t n = in->n_peeked - in->given;
    if (n > size) {
        n = size;
    }
    memcpy(buffer, in->peeked + in->given, n);
    in->given += n;
    return n + fread((uint8_t *)buffer + n, 1, size - n, in->file);
}

int input_getc(input *in)
{
    return in->given < in->n_peeked ? in->peeked[in->given++] : getc(in->file);
}

int input_fail(const input *in, app *a, const pcapng_reader *reader)
{
    if (ferror(in->file)) {
        return app_fail(a, EXIT_FILE, "IO", "%s: it could not be read to its end", in->name);
    }
    return app_fail(a, EXIT_FILE, grobo_error_name(reader->error), "%s: %s", in->name,
                    reader->problem);
}
