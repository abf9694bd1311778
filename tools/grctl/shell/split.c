/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/shell/shell.h"

/* Takes one word to `to`; returns where it ended, or NULL with a quote open. */
static char *take_word(char *from, char **to)
{
    char quote = '\0';
    for (; *from && (quote || !strchr(" \t\r\n", *from)); from++) {
        if (*from == '\\' && quote != '\'' && from[1]) {
            *(*to)++ = *++from;
        } else if (quote && *from == quote) {
            quote = '\0';
        } else if (!quote && (*from == '"' || *from == '\'')) {
            quote = *from;
        } else {
            *(*to)++ = *from;
        }
    }
    return quote ? NULL : from;
}

int shell_split(char *line, char **words, int most)
{
    int n = 0;
    for (char *from = line + strspn(line, " \t\r\n"); *from && *from != '#' && n < most;) {
        char *to = from;
        words[n++] = to;
        from = take_word(from, &to);
        if (!from) {
            return SHELL_OPEN_QUOTE;
        }
        bool more = *from != '\0';
        *to = '\0';
        if (!more) {
            break;
        }
        from++;
        from += strspn(from, " \t\r\n");
        if (n == most && *from && *from != '#') {
            return SHELL_TOO_MANY;
        }
    }
    return n;
}
