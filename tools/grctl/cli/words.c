/* SPDX-License-Identifier: MIT */
/* The known name that is nearest to a mistyped one. */
#include <ctype.h>
#include <string.h>

#include "tools/grctl/cli/cli.h"

static bool same(char a, char b)
{
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

/* Edits (insert, delete, replace, swap of neighbours) that turn a into b; names are short. */
static int distance(const char *a, size_t length, const char *b)
{
    enum { MOST = 24 };
    int d[MOST + 1][MOST + 1];
    int n = length < MOST ? (int)length : MOST, m = (int)strnlen(b, MOST);
    for (int i = 0; i <= n; i++) {
        d[i][0] = i;
    }
    for (int j = 0; j <= m; j++) {
        d[0][j] = j;
    }
    for (int i = 1; i <= n; i++) {
        for (int j = 1; j <= m; j++) {
            int best = d[i - 1][j - 1] + !same(a[i - 1], b[j - 1]);
            if (d[i - 1][j] + 1 < best) {
                best = d[i - 1][j] + 1;
            }
            if (d[i][j - 1] + 1 < best) {
                best = d[i][j - 1] + 1;
            }
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]) &&
                d[i - 2][j - 2] + 1 < best) {
                best = d[i - 2][j - 2] + 1;
            }
            d[i][j] = best;
        }
    }
    return d[n][m];
}

void cli_guess_try(cli_guess *guess, const char *candidate)
{
    int most = guess->best ? guess->edits - 1 : 2; /* more than two edits is another word */
    int edits = distance(guess->name, guess->length, candidate);
    if (edits <= most && 2 * edits < (int)strlen(candidate)) {
        guess->best = candidate;
        guess->edits = edits;
    }
}

const char *cli_nearest_command(const char *name)
{
    cli_guess guess = {.name = name, .length = strlen(name)};
    for (size_t i = 0; i < cli_n_commands; i++) {
        cli_guess_try(&guess, cli_commands[i]->name);
    }
    return guess.best;
}
