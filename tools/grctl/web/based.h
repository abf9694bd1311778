/* SPDX-License-Identifier: MIT */
/*
 * What a request is based on. Each state that is told has a number, and a request that moves,
 * switches or releases something names the one that its page had seen. It is refused where that
 * state is older than a second, or where something has happened since then that the page had not
 * seen: a stop, say. A request that was held up on its way acts on no newer situation. Times are
 * those of grobo_now_us().
 */
#ifndef GRCTL_WEB_BASED_H
#define GRCTL_WEB_BASED_H

#include <stdbool.h>
#include <stdint.h>

#include <jansson.h>

/* What is based on an older state is refused. */
#define BASED_STALE_US INT64_C(1000000)

enum { BASED_KEPT = 128, BASED_TEXT_BYTES = 192, BASED_COMPLAINT_BYTES = 384 };

typedef struct based {
    uint64_t sequence; /* of the last state, 0: none yet */
    uint64_t changed;  /* of the last change, 0: none yet */
    char what[BASED_TEXT_BYTES];
    int64_t told_us[BASED_KEPT]; /* when the last ones were told */
} based;

/* There is a next state. */
void based_tell(based *b, int64_t now_us);
/* Something happened ("stop by Anna"), a state of its own: what was asked for before is void. */
void based_change(based *b, int64_t now_us, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* That state was told less than a second ago. */
bool based_is_fresh(const based *b, const json_t *sequence, int64_t now_us);
/* And nothing has happened since. Else `complaint` says what: "reset: ...". */
bool based_check(const based *b, const json_t *sequence, int64_t now_us, const char *doing,
                 char complaint[BASED_COMPLAINT_BYTES]);

#endif
