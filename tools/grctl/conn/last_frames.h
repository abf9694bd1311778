/* SPDX-License-Identifier: MIT */
/* The last frames of a line and what came after each: for who asks why something failed. */
#ifndef GRCTL_LAST_FRAMES_H
#define GRCTL_LAST_FRAMES_H

#include <grobo/core/protocol.h>
#include <grobo/core/serial.h>

enum { LAST_FRAMES = 80, LAST_FRAME_BYTES = 64 };

typedef struct last_frame {
    int64_t at_us, got_us; /* when it was sent; when the first byte came after it */
    uint8_t sent[LAST_FRAME_BYTES], got[LAST_FRAME_BYTES];
    size_t n_sent, n_got; /* at most LAST_FRAME_BYTES are kept */
} last_frame;

typedef struct last_frames {
    /* private */
    last_frame frame[LAST_FRAMES]; /* ring */
    unsigned n;                    /* ever sent */
} last_frames;

/* What became of a request. */
typedef struct last_try {
    const last_frame *frame; /* the last attempt; NULL: none is known */
    int attempts;            /* in a row */
    int64_t took_us;         /* the last one, until the next frame or now */
} last_try;

void last_frames_note(last_frames *all, grobo_direction direction, int64_t now_us,
                      const uint8_t *bytes, size_t size);

/* The one sent last, NULL: none was. */
const last_frame *last_frames_newest(const last_frames *all);

/* The last request to a servo of this id. */
last_try last_frames_to(const last_frames *all, const grobo_protocol *protocol, int id,
                        int64_t now_us);

/* "sent 53 0C FA AF ...; received nothing" */
void last_frames_text(const last_frame *frame, char *text, size_t capacity);

#endif
