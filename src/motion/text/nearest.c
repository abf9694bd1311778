/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "src/motion/text/nearest.h"

enum { LENGTH_MAX = 63, EDITS_MAX = 2 };

static int least(int a, int b, int c)
{
    int smaller = a < b ? a : b;
    return smaller < c ? smaller : c;
}

/* Levenshtein's distance, a row at a time. */
static int distance(const char *from, size_t n_from, const char *to, size_t n_to)
{
    int row[LENGTH_MAX + 1];
    for (size_t j = 0; j <= n_to; j++) {
        row[j] = (int)j;
    }
    for (size_t i = 1; i <= n_from; i++) {
        int diagonal = row[0];
        row[0] = (int)i;
        for (size_t j = 1; j <= n_to; j++) {
            int above = row[j];
            row[j] = least(above + 1, row[j - 1] + 1, diagonal + (from[i - 1] != to[j - 1]));
            diagonal = above;
        }
    }
    return row[n_to];
}

void grobo_i_nearest_try(grobo_i_nearest *nearest, const char *typed, const char *candidate)
{
    size_t n_typed = strlen(typed), n_candidate = strlen(candidate);
    int most = nearest->word != NULL ? nearest->edits - 1 : EDITS_MAX;
    if (n_typed > LENGTH_MAX || n_candidate > LENGTH_MAX) {
        return;
    }
    int edits = distance(typed, n_typed, candidate, n_candidate);
    if (edits <= most && 2 * edits <= (int)n_candidate) {
        nearest->word = candidate;
        nearest->edits = edits;
    }
}
