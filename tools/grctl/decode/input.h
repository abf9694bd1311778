/* SPDX-License-Identifier: MIT */
/* A file or standard input whose first bytes may be looked at before it is read. */
#ifndef GRCTL_INPUT_H
#define GRCTL_INPUT_H

#include <stdio.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/conn/pcapng.h"

enum { INPUT_PEEK_BYTES = 4 };

typedef struct input {
    FILE *file;
    const char *name; /* for messages */
    uint8_t peeked[INPUT_PEEK_BYTES];
    size_t n_peeked;
    size_t given; /* of the peeked bytes */
} input;

/* "-": standard input. Returns 0, or the exit status with the reason said. */
int input_open(input *in, app *a, const char *path);
void input_close(input *in);

/* True if it begins as pcapng files do. */
bool input_is_pcapng(const input *in);

/* A pcapng_source: as fread. */
size_t input_read(void *ctx, void *buffer, size_t size);

/* One byte, or EOF. */
int input_getc(input *in);

/* Says why a trace can be read no further, and returns the exit status. */
int input_fail(const input *in, app *a, const pcapng_reader *reader);

#endif
