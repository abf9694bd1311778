/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/serial.h>

#include "tools/grctl/decode/explain.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/sim/strict.h"

/* Bytes that collide within this time are one offence. */
#define ONE_COLLISION_US 20000

enum { WHY_BYTES = 128 };

/* ---- reporting ------------------------------------------------------------------------------- */

static void report_text(const sim_strict *s, const char *code, int64_t at_us, const char *hex,
                        const char *why)
{
    if (!os_takes_line(stderr)) {
        return; /* nobody reads: the count remains */
    }
    fprintf(stderr, "grctl: sim: robot %d: %.3f ms: %s: %s: %s\n", s->robot,
            (double)(at_us - s->start_us) / 1e3, code, why, hex);
    fflush(stderr);
}

static void report(sim_strict *s, const char *code, int64_t at_us, const uint8_t *bytes, size_t n,
                   const char *why)
{
    char hex[3 * FRAMES_BUFFER_BYTES + 1] = "";
    s->offences++;
    (void)grobo_hex(bytes, n, hex, sizeof hex);
    if (s->a->json) {
        app_print_json(json_pack("{s:s,s:i,s:o,s:s,s:s}", "offence", code, "robot", s->robot,
                                 "time_ms", app_json_number((double)(at_us - s->start_us) / 1e3, 3),
                                 "bytes", hex, "message", why));
    } else {
        report_text(s, code, at_us, hex, why);
    }
}

/* ---- what a packet says ---------------------------------------------------------------------- */

/* What is wrong with the data that a packet writes from an address on; false: nothing. */
static bool wrong_data(uint8_t address, const uint8_t *data, size_t n, char *why)
{
    if (address + n > GROBO_REGISTERS) {
        snprintf(why, WHY_BYTES, "it writes No.%d, behind the last register",
                 (int)(address + n - 1));
        return true;
    }
    const telegram_part part = {.address = address, .length = (int)n, .data = data};
    for (int at = 0; at < part.length;) {
        const explain_item item = explain_item_at(EXPLAIN_RS30X, &part, at);
        if (explain_is_wrong(&item, why, WHY_BYTES)) {
            return true;
        }
        at += item.bytes;
    }
    return false;
}

/* What no servo can do with a whole packet of a good sum; NULL: nothing. The code of it. */
static const char *wrong_packet(const grobo_rs30x_packet *p, const uint8_t *bytes, size_t n,
                                char *why)
{
    grobo_reply reply;
    size_t step = p->kind == GROBO_RS30X_LONG ? p->length : p->data_bytes;
    size_t skip = p->kind == GROBO_RS30X_LONG ? 1 : 0;
    bool writes = p->address < GROBO_REGISTERS; /* No.255 stands in commands */
    if (p->kind == GROBO_RS30X_SHORT && grobo_rs30x_reply_to(bytes, n, &reply) < 0) {
        snprintf(why, WHY_BYTES, "it asks for what no servo returns (flags %02X)", p->flags);
        return "request";
    }
    for (size_t at = 0; writes && step > 0 && at + step <= p->data_bytes; at += step) {
        if (skip && (p->data[at] < 1 || p->data[at] > GROBO_RS30X_ID_MAX)) {
            snprintf(why, WHY_BYTES, "id %d is outside 1..%d", p->data[at], GROBO_RS30X_ID_MAX);
            return "range";
        }
        if (wrong_data(p->address, p->data + at + skip, step - skip, why)) {
            return "range";
        }
    }
    return NULL;
}

/* ---- what the client writes ------------------------------------------------------------------ */

/* A frame of the board asks for as many bytes as its packet is answered by. */
static bool wrong_relay(const frame *f, char *why)
{
    grobo_reply reply;
    int bytes = grobo_rs30x_reply_to(f->board.packet, f->board.packet_bytes, &reply);
    int asked = f->board.kind == GROBO_BOARD_ASK ? f->board.reply_bytes : 0;
    if (f->board.kind > GROBO_BOARD_ASK || bytes < 0 || bytes == asked) {
        return false;
    }
    snprintf(why, WHY_BYTES, "it asks the board for %d bytes, the servo returns %d", asked, bytes);
    return true;
}

/* The same for servos that are no RS30x; NULL: nothing. */
static const char *wrong_telegram(const sim_strict *s, const uint8_t *bytes, size_t n,
                                  const telegram **said, char *why)
{
    static telegram told;
    const dialect_frame as = {.sum_ok = true};
    memset(&told, 0, sizeof told);
    s->talk.dialect->explain(bytes, n, &as, &told);
    *said = &told;
    return explain_offence(&s->talk, &told, why, WHY_BYTES);
}

static void on_telegram(sim_strict *s, const frame *f)
{
    char why[WHY_BYTES] = "the sum is wrong";
    const telegram *said;
    const char *code = f->sum_ok ? wrong_telegram(s, f->bytes, f->size, &said, why) : "sum";
    if (code) {
        report(s, code, f->end_us, f->bytes, f->size, why);
    }
}

static void on_whole(sim_strict *s, const frame *f)
{
    if (s->talk.dialect) {
        on_telegram(s, f);
        return;
    }
    char why[WHY_BYTES] = "";
    const uint8_t *bytes = f->kind == FRAME_BOARD ? f->board.packet : f->bytes;
    if (f->has_packet && !f->sum_ok) {
        report(s, "sum", f->end_us, f->bytes, f->size, "the sum is wrong");
        return;
    }
    const char *code = f->has_packet ? wrong_packet(&f->packet, bytes, f->packet_size, why) : NULL;
    if (!code && f->kind == FRAME_BOARD && f->has_packet && wrong_relay(f, why)) {
        code = "relay";
    }
    if (code) {
        report(s, code, f->end_us, f->bytes, f->size, why);
    }
}

static void on_frame(void *ctx, const frame *f)
{
    sim_strict *s = ctx;
    switch (f->kind) {
    case FRAME_BOARD:
    case FRAME_PACKET:
        on_whole(s, f);
        break;
    case FRAME_ECHO:
        break;
    case FRAME_CUT:
        report(s, "cut", f->end_us, f->bytes, f->size, "its rest never came");
        break;
    case FRAME_RUBBISH:
        report(s, "rubbish", f->end_us, f->bytes, f->size, "it is no frame");
        break;
    }
}

/* ---- what happens in the simulator ----------------------------------------------------------- */

static void on_packet(sim_strict *s, const grobo_sim_event *event)
{
    s->n_packet = event->n_bytes < sizeof s->packet ? event->n_bytes : sizeof s->packet;
    memcpy(s->packet, event->bytes, s->n_packet);
    s->told = false;
}

/* Refused for what only this servo lacks: the rest has been reported by the packet itself. */
static void on_refused(sim_strict *s, const grobo_sim_event *event)
{
    char why[WHY_BYTES];
    grobo_rs30x_packet packet;
    const telegram *said;
    bool sum_ok;
    if (s->talk.dialect) {
        if (!s->told && !wrong_telegram(s, s->packet, s->n_packet, &said, why)) {
            s->told = true;
            report(s, "refused", event->time_us, s->packet, s->n_packet, "the servo cannot do it");
        }
        return;
    }
    int size = grobo_rs30x_peek(s->packet, s->n_packet, GROBO_ACCEPT_COMMANDS, &packet, &sum_ok);
    if (s->told || size <= 0 || wrong_packet(&packet, s->packet, s->n_packet, why)) {
        return;
    }
    s->told = true;
    snprintf(why, sizeof why, "the servo cannot do it (No.%d)", (int)event->value);
    report(s, "refused", event->time_us, s->packet, s->n_packet, why);
}

static bool is_order(const sim_strict *s, const grobo_sim_event *event)
{
    char why[WHY_BYTES];
    const telegram *said;
    if (!s->talk.dialect) {
        return event->bytes[2] == 0 || (event->bytes[3] & 0xF0) != 0 || event->n_bytes > 8;
    }
    (void)wrong_telegram(s, event->bytes, event->n_bytes, &said, why);
    return !said->action || (!strstr(said->action, "read") && strcmp(said->action, "ping") != 0);
}

/* To ask whether a servo is back is no offence, to tell it something is: nobody hears it. */
static void on_missed(sim_strict *s, const grobo_sim_event *event)
{
    bool writes = is_order(s, event);
    if (s->told || !writes) {
        return;
    }
    s->told = true;
    report(s, "busy", event->time_us, event->bytes, event->n_bytes,
           event->value == GROBO_SIM_BUSY_FLASH ? "the servo writes its flash"
                                                : "the servo restarts");
}

static void on_collision(sim_strict *s, const grobo_sim_event *event)
{
    bool again = s->collision_us != 0 && event->time_us - s->collision_us < ONE_COLLISION_US;
    if (event->value == 0 || s->wiring != GROBO_WIRING_BUS) {
        return;
    }
    s->collision_us = event->time_us;
    if (!again) {
        report(s, "talk", event->time_us, s->last, s->n_last, "it is sent while a servo replies");
    }
}

void sim_strict_event(sim_strict *s, const grobo_sim_event *event)
{
    if (!s->a) {
        return;
    }
    if (event->kind == GROBO_SIM_PACKET) {
        on_packet(s, event);
    } else if (event->kind == GROBO_SIM_REFUSED) {
        on_refused(s, event);
    } else if (event->kind == GROBO_SIM_MISSED) {
        on_missed(s, event);
    } else if (event->kind == GROBO_SIM_COLLISION) {
        on_collision(s, event);
    } else if (event->kind == GROBO_SIM_STALLED) {
        report(s, "stall", event->time_us, event->bytes, event->n_bytes,
               "it pauses for more than 10 ms, and the servos forget it");
    }
}

/* ---- from begin to end ----------------------------------------------------------------------- */

void sim_strict_start(sim_strict *s, app *a, int robot, grobo_wiring wiring, const dialect *d)
{
    *s = (sim_strict){.a = a,
                      .robot = robot,
                      .wiring = wiring,
                      .start_us = grobo_now_us(),
                      .talk = {.dialect = d}};
    frames_init(&s->host, FRAMES_HOST,
                wiring == GROBO_WIRING_BUS ? (unsigned)FRAMES_BUS : (unsigned)FRAMES_BOARD,
                on_frame, s);
    frames_set_talk(&s->host, &s->talk);
}

void sim_strict_bytes(sim_strict *s, int64_t now_us, const uint8_t *bytes, size_t n)
{
    if (!s->a) {
        return;
    }
    s->n_last = n < sizeof s->last ? n : sizeof s->last;
    memcpy(s->last, bytes, s->n_last);
    frames_feed(&s->host, now_us, bytes, n);
}

void sim_strict_end(sim_strict *s)
{
    if (s->a) {
        frames_end(&s->host);
    }
}
