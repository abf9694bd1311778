/* SPDX-License-Identifier: MIT */
/* What -v and -vv tell of the bytes of the line. */
#include "tools/grctl/cli/output.h"
#include "tools/grctl/conn/conn.h"

enum { HEX_BYTES = 1024 };

/* From -vv on, but not over a full screen. */
static void show_bytes(conn *c, char direction, int64_t at_us, const uint8_t *bytes, size_t size)
{
    char text[HEX_BYTES];
    if (c->a->verbosity < 2 || c->a->hushed || size == 0)
        return;
    if (!c->shown_us)
        c->shown_us = at_us;
    grobo_hex(text, sizeof text, bytes, size);
    output_complain("%10.3f  %c  %s\n", (double)(at_us - c->shown_us) / 1e3, direction, text);
}

void conn_show_answer(conn *c)
{
    const last_frame *last = last_frames_newest(&c->last);
    if (last)
        show_bytes(c, '<', last->got_us, last->got, last->n_got);
}

void conn_note_bytes(conn *c, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                     size_t size)
{
    if (direction == GROBO_DIR_TX) {
        conn_show_answer(c);
        show_bytes(c, '>', now_us, bytes, size);
    }
    last_frames_note(&c->last, direction, now_us, bytes, size);
}
