/* SPDX-License-Identifier: MIT */
/* Lines without editing, where libedit was not there when grctl was built. */
#include <stdlib.h>
#include <string.h>

#include "../shell.h"

struct line_reader {
    conn_link *link;
};

line_reader *line_open(conn_link *link)
{
    line_reader *reader = malloc(sizeof *reader);
    if (reader)
        reader->link = link;
    return reader;
}

int line_read(line_reader *reader, const char *prompt, char *line, size_t capacity)
{
    size_t n = 0;
    fputs(prompt, stdout);
    fflush(stdout);
    for (;;) {
        char c;
        int got;
        if (!line_wait(reader->link)) {
            putchar('\n');
            return LINE_INTERRUPTED;
        }
        got = os_input_read(&c, 1);
        if (got < 0)
            return LINE_END;
        if (got > 0 && c == '\n')
            break;
        if (got > 0 && c != '\r' && n + 1 < capacity)
            line[n++] = c;
    }
    line[n] = '\0';
    return (int)n;
}

void line_close(line_reader *reader)
{
    free(reader);
}
