/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include <grobo/core/serial.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/decode/decoder.h"
#include "tools/grctl/decode/words.h"

static double ms_of(const decoder *d, int64_t time_us)
{
    return (double)(time_us - d->first_us) / 1e3;
}

static void count(decoder *d, const frame *f)
{
    switch (f->kind) {
    case FRAME_BOARD:
    case FRAME_PACKET:
    case FRAME_ECHO:
        d->count.frames++;
        d->count.bad_sums += !f->sum_ok;
        break;
    case FRAME_CUT:
        d->count.cut++;
        break;
    case FRAME_RUBBISH:
        d->count.rubbish_bytes += f->size;
        break;
    }
}

static void print_hex(const frame *f)
{
    char hex[3 * FRAMES_BUFFER_BYTES + 1];
    if (grobo_hex(f->bytes, f->size, hex, sizeof hex) > 0) {
        app_print("    %s\n", hex);
    }
}

static void print_text(const decoder *d, const frame *f, const char *note)
{
    static char text[WORDS_BYTES];
    words_say(f, d->a->color_out, note, text, sizeof text);
    if (d->timed) {
        app_print("%10.3f  %s%s%-7s  ", ms_of(d, f->time_us), d->line ? d->line : "",
                  d->line ? ": " : "", words_side(f->side));
    }
    app_print("%s", text);
    if (d->a->verbosity > 0) {
        print_hex(f);
    }
}

static void print_json(const decoder *d, const frame *f, bool answer, bool fits, int64_t asked_us)
{
    double reply_ms = (double)(f->end_us - asked_us) / 1e3;
    json_t *line =
        json_pack("{s:o*}", "time_ms", d->timed ? app_json_number(ms_of(d, f->time_us), 3) : NULL);
    json_t *words = words_json(f);
    json_t *reply = json_pack("{s:o*,s:o*}", "reply_time_ms",
                              answer && fits && d->timed ? app_json_number(reply_ms, 3) : NULL,
                              "asked_for", answer ? json_boolean(fits) : NULL);
    json_object_update(line, words);
    json_object_update(line, reply);
    json_decref(words);
    json_decref(reply);
    app_json_line(d->line);
    app_print_json(line);
    app_json_line(NULL);
}

/* Who said which servo it is, has its registers from here on. */
static void learn(decoder *d, const frame *f)
{
    static grobo_telegram said;
    if (f->kind == FRAME_PACKET && f->as.reply && f->sum_ok) {
        memset(&said, 0, sizeof said);
        d->talk.words->explain(f->bytes, f->size, &f->as, &said);
        talk_learn(&d->talk, &said);
    }
}

/* Replies are told apart from what nobody asked for, as far as there are requests at all. */
static void on_frame(void *ctx, const frame *f)
{
    decoder *d = ctx;
    char note[64] = "";
    int64_t asked_us = 0;
    bool answer = false, fits = false;
    count(d, f);
    if (f->side == FRAMES_HOST && f->kind <= FRAME_PACKET && f->sum_ok) {
        ledger_ask(&d->asked, f);
    } else if (f->side == FRAMES_ROBOT && f->kind == FRAME_PACKET && d->asked.requests > 0) {
        answer = true;
        fits = ledger_take(&d->asked, 0, f, &asked_us);
        d->count.unasked += !fits;
        if (fits && d->timed) {
            snprintf(note, sizeof note, "; %.3f ms after its request",
                     (double)(f->end_us - asked_us) / 1e3);
        } else if (!fits) {
            snprintf(note, sizeof note, "; nobody asked for it");
        }
    }
    learn(d, f);
    if (d->a->json) {
        print_json(d, f, answer, fits, asked_us);
    } else {
        print_text(d, f, note);
    }
}

static void on_settled(void *ctx, const ledger_entry *entry)
{
    decoder *d = ctx;
    if (entry->answer[0].state == LEDGER_ANSWERED) {
        d->count.answered++;
    } else {
        d->count.unanswered++;
    }
}

/* Who talks on a line of this family: the robot's joints, where its servos are of it. */
static talk talk_of(const grobo_driver *driver, const char *name)
{
    talk t = {.words = talk_named(name)};
    if (!family_is(driver, talk_family(t.words)->name)) {
        return t;
    }
    t.model = driver->model;
    for (int j = 0; j < t.model->n_joints; j++) {
        int id = grobo_model_joint(t.model, j)->motor;
        const grobo_servo_model *servo = family_servo(driver, id);
        bool told = !servo || grobo_servo_series(servo) == t.words->table;
        t.servo[id] = told ? servo : NULL;
    }
    return t;
}

void decoder_init(decoder *d, app *a, unsigned wiring, const grobo_driver *driver, const char *name)
{
    *d = (decoder){.a = a, .talk = talk_of(driver, name)};
    for (int side = FRAMES_EITHER; side <= FRAMES_ROBOT; side++) {
        frames_init(&d->lines[side], &d->talk, (frames_side)side, wiring, on_frame, d);
    }
    ledger_init(&d->asked, 1, on_settled, d);
}

void decoder_pass(decoder *d, int64_t time_us)
{
    for (int i = FRAMES_EITHER; i <= FRAMES_ROBOT; i++) {
        frames_pass(&d->lines[i], time_us);
    }
}

void decoder_feed(decoder *d, frames_side side, int64_t time_us, const uint8_t *bytes, size_t n)
{
    if (!d->begun) {
        d->first_us = time_us;
    }
    d->begun = true;
    decoder_pass(d, time_us);
    frames_feed(&d->lines[side], time_us, bytes, n);
}

void decoder_end(decoder *d)
{
    for (int side = FRAMES_EITHER; side <= FRAMES_ROBOT; side++) {
        frames_end(&d->lines[side]);
    }
    ledger_end(&d->asked);
}

void decoder_add(decoder *d, const decoder *other)
{
    d->asked.requests += other->asked.requests;
    d->count.frames += other->count.frames;
    d->count.bad_sums += other->count.bad_sums;
    d->count.cut += other->count.cut;
    d->count.rubbish_bytes += other->count.rubbish_bytes;
    d->count.answered += other->count.answered;
    d->count.unanswered += other->count.unanswered;
    d->count.unasked += other->count.unasked;
}

int decoder_status(const decoder *d)
{
    return d->count.bad_sums || d->count.cut ? EXIT_FILE : EXIT_DONE;
}

void decoder_summary(decoder *d)
{
    app *a = d->a;
    if (a->json) {
        app_print_json(
            json_pack("{s:b,s:I,s:I,s:I,s:I,s:I,s:I,s:I}", "done", 1, "frames",
                      (json_int_t)d->count.frames, "bad_sums", (json_int_t)d->count.bad_sums, "cut",
                      (json_int_t)d->count.cut, "rubbish_bytes", (json_int_t)d->count.rubbish_bytes,
                      "answered", (json_int_t)d->count.answered, "unanswered",
                      (json_int_t)d->count.unanswered, "unasked", (json_int_t)d->count.unasked));
        return;
    }
    output_flush();
    app_note(a,
             "%llu frames, %llu with a wrong sum, %llu cut off, %llu bytes of rubbish; of %llu "
             "requests %llu were answered; %llu replies nobody asked for",
             d->count.frames, d->count.bad_sums, d->count.cut, d->count.rubbish_bytes,
             (unsigned long long)d->asked.requests, d->count.answered, d->count.unasked);
}
