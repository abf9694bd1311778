/* SPDX-License-Identifier: MIT */
/* Lines without editing, where libedit was not there when grctl was built. */
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/term/edit.h"

struct line_reader {
    line_owner owner;
};

static void say(const char *text)
{
    output_bytes(text, strlen(text));
    (void)output_flush();
}

line_reader *line_open(const line_owner *owner)
{
    line_reader *reader = malloc(sizeof *reader);
    if (reader) {
        reader->owner = *owner;
    }
    return reader;
}

/* Returns 0, or LINE_INTERRUPTED. What the terminal has of the line so far it shows no more. */
static int await_input(const line_owner *owner, const char *prompt)
{
    int stopped;
    while ((stopped = owner->wait(owner->ctx)) == LINE_NEWS) {
        say("\n");
        owner->tell(owner->ctx);
        say(prompt);
    }
    return stopped;
}

int line_read(line_reader *reader, const char *prompt, char *line, size_t capacity)
{
    size_t n = 0;
    say(prompt);
    for (;;) {
        char c;
        if (await_input(&reader->owner, prompt)) {
            say("\n");
            return LINE_INTERRUPTED;
        }
        int got = os_input_read(&c, 1);
        if (got < 0) {
            say("\n");
            return LINE_END;
        }
        if (got > 0 && c == '\n') {
            break;
        }
        if (got > 0 && c != '\r' && n < capacity) {
            line[n++] = c;
        }
    }
    if (n == capacity) {
        return LINE_TOO_LONG;
    }
    line[n] = '\0';
    return (int)n;
}

void line_close(line_reader *reader)
{
    free(reader);
}
