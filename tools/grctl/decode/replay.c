/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/conn/family.h"
#include "tools/grctl/decode/replay.h"
#include "tools/grctl/decode/words.h"

/* Differences shown as text, unless -v asks for all. */
enum { SHOWN = 5 };

#define LENGTH_MAX_US (24 * 3600 * INT64_C(1000000))

/* ---- the trace ----------------------------------------------------------------------------- */

/* A clock that was set, or nonsense, is not to be waited for. */
static int refuse_length(const replay *r, int64_t at_us)
{
    if (r->first_us < 0 || at_us <= LENGTH_MAX_US) {
        return 0;
    }
    return app_fail(r->a, EXIT_FILE, "CAP",
                    "%s: a packet %.0f s after the first: a trace of more than a day is not "
                    "replayed",
                    r->path, (double)at_us / 1e6);
}

/* Whether a chunk is for the robot's line: of a trace of several lines those of its name are.
 * Negative: who said what is not known; the reason is said. */
static int is_for(const replay *r, const pcapng_reader *reader, const pcapng_chunk *chunk)
{
    if (reader->n_interfaces > 1 && !r->line) {
        app_fail(r->a, EXIT_USAGE, "ARG",
                 "%s: a trace of %u lines, and %s has one: name the robot of the trace by --robot",
                 r->path, reader->n_interfaces, app_model(r->a)->name);
        return -1;
    }
    if (reader->n_interfaces == 1 && r->each) {
        app_fail(r->a, EXIT_USAGE, "ARG", "%s: a trace of one line: choose it, as by --line %s",
                 r->path, r->line);
        return -1;
    }
    return reader->n_interfaces == 1 || strcmp(chunk->interface->name, r->line) == 0;
}

int replay_read(replay *r, replay_fn use, void *ctx)
{
    static pcapng_reader reader;
    pcapng_chunk chunk;
    input in;
    int more = 0;
    int status = input_open(&in, r->a, r->path);
    if (status) {
        return status;
    }
    pcapng_reader_init(&reader, input_read, &in);
    while (!status && (more = pcapng_read(&reader, &chunk)) > 0) {
        int its = is_for(r, &reader, &chunk);
        status = its < 0 ? EXIT_USAGE : refuse_length(r, chunk.time_us - r->first_us);
        if (!status && its) {
            status = use(ctx, &chunk);
        }
    }
    if (more < 0) {
        status = input_fail(&in, r->a, &reader);
    }
    input_close(&in);
    return status;
}

/* ---- comparing ----------------------------------------------------------------------------- */

static const char *verdict_of(replay *r, const ledger_entry *entry, unsigned long long **counter)
{
    const ledger_answer *recorded = &entry->answer[REPLAY_RECORDED];
    const ledger_answer *replayed = &entry->answer[REPLAY_REPLAYED];
    bool was = recorded->state == LEDGER_ANSWERED, is = replayed->state == LEDGER_ANSWERED;
    *counter = &r->count.differ;
    if (!was && !is) {
        *counter = &r->count.silent;
        return "silent";
    }
    if (!is) {
        *counter = &r->count.missing;
        return "missing";
    }
    if (!was) {
        *counter = &r->count.extra;
        return "extra";
    }
    if (recorded->size == replayed->size &&
        memcmp(recorded->bytes, replayed->bytes, recorded->size) == 0) {
        *counter = &r->count.equal;
        return "equal";
    }
    return "differ";
}

static bool frame_of(const replay *r, frames_side side, const uint8_t *bytes, size_t n, frame *f)
{
    unsigned wiring = r->wiring == GROBO_WIRING_BOARD ? GROBO_WORDS_BOARD : GROBO_WORDS_BUS;
    return frame_peek(&r->talk, side, wiring, bytes, n, f) == (int)n;
}

static void print_one(const replay *r, const char *who, frames_side side, const uint8_t *bytes,
                      size_t n)
{
    static char text[WORDS_BYTES];
    frame f;
    if (n == 0) {
        snprintf(text, sizeof text, "nothing\n");
    } else if (frame_of(r, side, bytes, n, &f)) {
        words_say(&f, r->a->color_out, "", text, sizeof text);
    }
    app_print("    %-9s %s", who, text);
}

static json_t *json_of(const replay *r, frames_side side, const uint8_t *bytes, size_t n)
{
    frame f;
    return n > 0 && frame_of(r, side, bytes, n, &f) ? words_json(&f) : json_null();
}

static void print_difference(const replay *r, const ledger_entry *e, const char *verdict)
{
    const ledger_answer *was = &e->answer[REPLAY_RECORDED], *is = &e->answer[REPLAY_REPLAYED];
    double time_ms = (double)e->time_us / 1e3;
    if (r->a->json) {
        app_print_json(json_pack("{s:I,s:o,s:s,s:o,s:o,s:o}", "request", (json_int_t)e->number,
                                 "time_ms", app_json_number(time_ms, 3), "verdict", verdict,
                                 "asked", json_of(r, FRAMES_HOST, e->bytes, e->size), "recorded",
                                 json_of(r, FRAMES_ROBOT, was->bytes, was->size), "replayed",
                                 json_of(r, FRAMES_ROBOT, is->bytes, is->size)));
        return;
    }
    app_print("request %llu at %.3f ms: %s\n", (unsigned long long)e->number, time_ms, verdict);
    print_one(r, "asked", FRAMES_HOST, e->bytes, e->size);
    print_one(r, "recorded", FRAMES_ROBOT, was->bytes, was->size);
    print_one(r, "replayed", FRAMES_ROBOT, is->bytes, is->size);
}

static void on_settled(void *ctx, const ledger_entry *entry)
{
    replay *r = ctx;
    unsigned long long *counter;
    const char *verdict = verdict_of(r, entry, &counter);
    (*counter)++;
    if (counter == &r->count.equal || counter == &r->count.silent) {
        return;
    }
    unsigned long long differences = r->count.differ + r->count.missing + r->count.extra;
    if (r->a->json || r->a->verbosity > 0 || differences <= SHOWN) {
        print_difference(r, entry, verdict);
    }
}

static void on_answer(replay *r, int who, const frame *f)
{
    int64_t asked_us;
    if (f->kind == FRAME_PACKET && f->sum_ok) {
        if (!ledger_take(&r->asked, who, f, &asked_us)) {
            r->count.stray[who]++;
        }
    } else if (f->kind != FRAME_ECHO) {
        r->count.rubbish_bytes[who] += f->size;
    }
}

static void on_recorded(void *ctx, const frame *f)
{
    on_answer(ctx, REPLAY_RECORDED, f);
}

static void on_replayed(void *ctx, const frame *f)
{
    on_answer(ctx, REPLAY_REPLAYED, f);
}

void replay_begin(replay *r, frames_fn on_host)
{
    unsigned wiring = r->wiring == GROBO_WIRING_BOARD ? GROBO_WORDS_BOARD : GROBO_WORDS_BUS;
    const grobo_model *model = app_model(r->a);
    const grobo_words *own =
        talk_of_servo(family_servo(app_driver(r->a), grobo_model_joint(model, 0)->motor));
    r->talk = (talk){.words = own ? own : talk_named("rs30x"), .model = model};
    frames_init(&r->host, &r->talk, FRAMES_HOST, wiring, on_host, r);
    frames_init(&r->robot[REPLAY_RECORDED], &r->talk, FRAMES_ROBOT, wiring, on_recorded, r);
    frames_init(&r->robot[REPLAY_REPLAYED], &r->talk, FRAMES_ROBOT, wiring, on_replayed, r);
    ledger_init(&r->asked, LEDGER_SIDES, on_settled, r);
}

void replay_ask(replay *r, const frame *f)
{
    if (f->kind == FRAME_CUT || f->kind == FRAME_RUBBISH) {
        return;
    }
    r->count.frames++;
    ledger_ask(&r->asked, f);
}

void replay_answer(replay *r, int who, int64_t time_us, const uint8_t *bytes, size_t n)
{
    frames_feed(&r->robot[who], time_us, bytes, n);
}

/* ---- the end ------------------------------------------------------------------------------- */

static bool is_same(const replay *r)
{
    const unsigned long long *stray = r->count.stray, *rubbish = r->count.rubbish_bytes;
    return r->count.differ + r->count.missing + r->count.extra == 0 &&
           stray[REPLAY_RECORDED] == stray[REPLAY_REPLAYED] &&
           rubbish[REPLAY_RECORDED] == rubbish[REPLAY_REPLAYED];
}

int replay_report(replay *r)
{
    frames_end(&r->robot[REPLAY_RECORDED]);
    frames_end(&r->robot[REPLAY_REPLAYED]);
    ledger_end(&r->asked);
    bool ok = is_same(r);
    if (r->a->json) {
        app_print_json(
            json_pack("{s:b,s:b,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:{s:I,s:I},s:{s:I,s:I}}", "done", 1,
                      "ok", ok, "frames", (json_int_t)r->count.frames, "requests",
                      (json_int_t)r->asked.requests, "equal", (json_int_t)r->count.equal, "differ",
                      (json_int_t)r->count.differ, "missing", (json_int_t)r->count.missing, "extra",
                      (json_int_t)r->count.extra, "silent", (json_int_t)r->count.silent, "strays",
                      "recorded", (json_int_t)r->count.stray[REPLAY_RECORDED], "replayed",
                      (json_int_t)r->count.stray[REPLAY_REPLAYED], "rubbish_bytes", "recorded",
                      (json_int_t)r->count.rubbish_bytes[REPLAY_RECORDED], "replayed",
                      (json_int_t)r->count.rubbish_bytes[REPLAY_REPLAYED]));
        return ok ? EXIT_DONE : EXIT_ROBOT;
    }
    app_print("%llu frames sent, %llu call for a reply: %llu equal, %llu differ, %llu missing, "
              "%llu extra, %llu silent both times\n",
              r->count.frames, (unsigned long long)r->asked.requests, r->count.equal,
              r->count.differ, r->count.missing, r->count.extra, r->count.silent);
    for (int who = 0; who < LEDGER_SIDES; who++) {
        if (r->count.stray[who] || r->count.rubbish_bytes[who]) {
            app_print("%s: %llu replies nobody asked for, %llu bytes that are no reply\n",
                      who == REPLAY_RECORDED ? "recorded" : "replayed", r->count.stray[who],
                      r->count.rubbish_bytes[who]);
        }
    }
    return ok ? EXIT_DONE : EXIT_ROBOT;
}
