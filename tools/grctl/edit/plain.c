/* SPDX-License-Identifier: MIT */
/* Lines without editing, where libedit was not there when grctl was built. */
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/shell/shell.h"

struct line_reader {
    shell *s;
};

line_reader *line_open(shell *s)
{
    line_reader *reader = malloc(sizeof *reader);
    if (reader)
        reader->s = s;
    return reader;
}

/* Returns 0, or LINE_INTERRUPTED. What the terminal has of the line so far it shows no more. */
static int await_input(shell *s, const char *prompt)
{
    int stopped;
    while ((stopped = line_wait(s)) == LINE_NEWS) {
        putchar('\n');
        fflush(stdout);
        conn_link_news(&s->link, s->a);
        fputs(prompt, stdout);
        fflush(stdout);
    }
    return stopped;
}

int line_read(line_reader *reader, const char *prompt, char *line, size_t capacity)
{
    size_t n = 0;
    fputs(prompt, output_stream());
    fflush(stdout);
    for (;;) {
        char c;
        int got;
        if (await_input(reader->s, prompt)) {
            putchar('\n');
            return LINE_INTERRUPTED;
        }
        got = os_input_read(&c, 1);
        if (got < 0) {
            putchar('\n');
            return LINE_END;
        }
        if (got > 0 && c == '\n')
            break;
        if (got > 0 && c != '\r' && n < capacity)
            line[n++] = c;
    }
    if (n == capacity)
        return LINE_TOO_LONG;
    line[n] = '\0';
    return (int)n;
}

void line_close(line_reader *reader)
{
    free(reader);
}
