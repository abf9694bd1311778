/* SPDX-License-Identifier: MIT */
/* What `decode` does with bytes, wherever they come from: frames in words, on standard output. */
#ifndef GRCTL_DECODER_H
#define GRCTL_DECODER_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/decode/frames.h"
#include "tools/grctl/decode/input.h"
#include "tools/grctl/decode/ledger.h"

typedef struct decoder {
    app *a;
    const char *line; /* its name, shown with each frame; NULL: the only one */
    frames lines[3];  /* by frames_side */
    talk talk;
    ledger asked;
    bool timed;       /* bytes come with their time; it is shown */
    bool begun;       /* first_us is set */
    int64_t first_us; /* what times are counted from */
    char note[96];
    struct {
        unsigned long long frames, bad_sums, cut, rubbish_bytes, answered, unanswered, unasked;
    } count;
} decoder;

/* wiring: GROBO_WORDS_BOARD, GROBO_WORDS_BUS or both, of what is believed of a host; driver: whose
 * joints may be on the line; name: the series (grobo_words.name). */
void decoder_init(decoder *d, app *a, unsigned wiring, const grobo_driver *driver,
                  const char *name);

void decoder_feed(decoder *d, frames_side side, int64_t time_us, const uint8_t *bytes, size_t n);

/* Time passes on a line beside others. */
void decoder_pass(decoder *d, int64_t time_us);

/* What was seen on another line is counted here too. */
void decoder_add(decoder *d, const decoder *other);

/* Nothing more comes. */
void decoder_end(decoder *d);

/* What was seen, on standard error for people, as the last line of JSON. */
void decoder_summary(decoder *d);
/* The exit status for what was seen: EXIT_FILE where a frame had a wrong sum or was cut off. */
int decoder_status(const decoder *d);

/* Lines of hex, as text or JSON, with or without times. Returns 0 or the exit status. */
int decode_text(decoder *d, input *in);

#endif
