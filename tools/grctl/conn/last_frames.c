/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/conn/last_frames.h"
#include "tools/grctl/lang/lang.h"

static size_t append(uint8_t *to, size_t used, const uint8_t *bytes, size_t size)
{
    size_t room = LAST_FRAME_BYTES - used;
    size_t n = size < room ? size : room;
    memcpy(to + used, bytes, n);
    return used + n;
}

void last_frames_note(last_frames *all, grobo_direction direction, int64_t now_us,
                      const uint8_t *bytes, size_t size)
{
    last_frame *frame;
    if (direction == GROBO_DIR_TX) {
        frame = &all->frame[all->n++ % LAST_FRAMES];
        frame->at_us = now_us;
        frame->n_sent = append(frame->sent, 0, bytes, size);
        frame->n_got = 0;
    } else if (all->n > 0) {
        frame = &all->frame[(all->n - 1) % LAST_FRAMES];
        if (frame->n_got == 0) {
            frame->got_us = now_us;
        }
        frame->n_got = append(frame->got, frame->n_got, bytes, size);
    }
}

const last_frame *last_frames_newest(const last_frames *all)
{
    return all->n > 0 ? &all->frame[(all->n - 1) % LAST_FRAMES] : NULL;
}

/* A request to one servo. Of RS30x those that want an ACK, too: FA AF ID, bare or in a frame of the
 * board. */
static bool is_to(const last_frame *frame, const grobo_protocol *protocol, int id)
{
    grobo_reply reply = {.kind = GROBO_REPLY_NONE};
    if (protocol->reply_to(frame->sent, frame->n_sent, &reply) >= 0 &&
        reply.kind == GROBO_REPLY_RETURN) {
        return reply.id == id;
    }
    for (size_t i = 0; i + 2 < frame->n_sent; i++) {
        if (frame->sent[i] == 0xfa && frame->sent[i + 1] == 0xaf) {
            return frame->sent[i + 2] == id;
        }
    }
    return false;
}

static bool is_same(const last_frame *a, const last_frame *b)
{
    return a->n_sent == b->n_sent && memcmp(a->sent, b->sent, a->n_sent) == 0;
}

last_try last_frames_to(const last_frames *all, const grobo_protocol *protocol, int id,
                        int64_t now_us)
{
    last_try found = {0};
    unsigned known = all->n < LAST_FRAMES ? all->n : LAST_FRAMES;
    int64_t end_us = now_us;
    for (unsigned i = 1; i <= known; i++) {
        const last_frame *frame = &all->frame[(all->n - i) % LAST_FRAMES];
        if (found.frame && !is_same(frame, found.frame)) {
            break;
        }
        if (!found.frame && is_to(frame, protocol, id)) {
            found.frame = frame;
            found.took_us = end_us - frame->at_us;
        }
        found.attempts += found.frame != NULL;
        end_us = frame->at_us;
    }
    return found;
}

void last_frames_text(const last_frame *frame, char *text, size_t capacity)
{
    char sent[3 * LAST_FRAME_BYTES + 1], got[3 * LAST_FRAME_BYTES + 1];
    if (grobo_hex(frame->sent, frame->n_sent, sent, sizeof sent) < 0) {
        sent[0] = '\0';
    }
    if (frame->n_got == 0 || grobo_hex(frame->got, frame->n_got, got, sizeof got) < 0) {
        snprintf(got, sizeof got, _("nothing"));
    }
    snprintf(text, capacity, _("sent %s; received %s"), sent, got);
}
