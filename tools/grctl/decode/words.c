/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include <grobo/core/serial.h>

#include "tools/grctl/decode/explain.h"
#include "tools/grctl/decode/saytext.h"
#include "tools/grctl/decode/words.h"

const char *words_side(frames_side side)
{
    switch (side) {
    case FRAMES_HOST:
        return "host";
    case FRAMES_ROBOT:
        return "robot";
    case FRAMES_EITHER:
        break;
    }
    return "unknown";
}

static bool is_whole(const frame *f)
{
    return f->kind <= FRAME_ECHO;
}

static const grobo_telegram *telegram_of(const frame *f)
{
    static grobo_telegram said;
    memset(&said, 0, sizeof said);
    f->talk->words->explain(f->bytes, f->size, &f->as, &said);
    return &said;
}

/* ---- text ---------------------------------------------------------------------------------- */

static void say_telegram(text *t, const frame *f, const char *note)
{
    const grobo_telegram *said = telegram_of(f);
    *t->to = '\0';
    say(t, "%s", f->kind == FRAME_ECHO ? "echo: " : "");
    explain_say(t, f, said);
    say(t, "%s\n", note);
    if (f->kind != FRAME_ECHO) {
        explain_shares(t, said);
    }
}

/* Why no frame begins where rubbish looks like one. */
static void say_why(text *t, const frame *f)
{
    const char *why = NULL;
    for (size_t i = 0; f->talk->words->why && i < f->size && !why; i++) {
        why = f->talk->words->why(f->bytes + i, f->size - i);
    }
    if (why) {
        say(t, " (");
        say_bad(t, why);
        say(t, ")");
    }
}

void words_say(const frame *f, bool color, const char *note, char *to, size_t capacity)
{
    text t = {to, capacity, 0, color, f->talk};
    if (is_whole(f)) {
        say_telegram(&t, f, note);
        return;
    }
    *to = '\0';
    say_bad(&t, f->kind == FRAME_CUT ? "cut off:" : "rubbish:");
    say_hex(&t, f->bytes, f->size);
    if (f->kind == FRAME_RUBBISH) {
        say_why(&t, f);
    }
    say(&t, "%s\n", note);
}

/* ---- JSON ---------------------------------------------------------------------------------- */

static const char *kind_of(const frame *f, const grobo_telegram *said)
{
    switch (f->kind) {
    case FRAME_BOARD:
        return said->relay.kind;
    case FRAME_PACKET:
        return said->plain ? said->kind : said->reply ? "return" : "packet";
    case FRAME_ECHO:
        return "echo";
    case FRAME_CUT:
        return "cut";
    case FRAME_RUBBISH:
        break;
    }
    return "rubbish";
}

static json_t *reply_json(const grobo_telegram *said, const grobo_reply *reply, int known)
{
    static const char *const kinds[] = {"none", "ack", "return", "any"};
    if (known < 0 && known != GROBO_ERR_MISMATCH) {
        return json_pack("{s:o}", "error", app_json_code(grobo_error_name(known)));
    }
    bool returns = reply->kind == GROBO_REPLY_RETURN, differs = known == GROBO_ERR_MISMATCH;
    return json_pack("{s:s,s:I,s:o*,s:o*,s:o*,s:o*}", "kind", kinds[reply->kind], "bytes",
                     (json_int_t)reply->bytes, "id", returns ? json_integer(reply->id) : NULL,
                     "address", returns ? json_integer(reply->address) : NULL, "length",
                     returns ? json_integer(reply->length) : NULL, "asked_bytes",
                     differs ? json_integer(said->relay.asked_bytes) : NULL);
}

json_t *words_json(const frame *f)
{
    char hex[3 * FRAMES_BUFFER_BYTES + 1];
    grobo_reply reply;
    int known = explain_expects(f, &reply);
    const grobo_telegram *said = is_whole(f) ? telegram_of(f) : NULL;
    if (grobo_hex(f->bytes, f->size, hex, sizeof hex) < 0) {
        hex[0] = '\0';
    }
    bool numbered = f->kind == FRAME_BOARD && said->relay.number >= 0;
    bool replies = known != GROBO_ERR_TYPE && f->kind != FRAME_ECHO;
    return json_pack("{s:s,s:s,s:I,s:s,s:o*,s:o*,s:o*}", "from", words_side(f->side), "kind",
                     kind_of(f, said), "bytes", (json_int_t)f->size, "hex", hex, "number",
                     numbered ? json_integer(said->relay.number) : NULL, "packet",
                     said ? explain_packet(f, said) : NULL, "reply",
                     replies ? reply_json(said, &reply, known) : NULL);
}
