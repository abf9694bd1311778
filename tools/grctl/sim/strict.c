/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/core/serial.h>

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

/* What no servo can do with a whole command of a good sum; NULL: nothing. The code of it. */
static const char *wrong_telegram(const sim_strict *s, const uint8_t *bytes, size_t n, bool relay,
                                  const grobo_telegram **said, char *why)
{
    static grobo_telegram told;
    const grobo_words_frame as = {.sum_ok = true, .relay = relay};
    memset(&told, 0, sizeof told);
    s->talk.words->explain(bytes, n, &as, &told);
    *said = &told;
    return explain_offence(&s->talk, bytes, n, &told, why, WHY_BYTES);
}

static void on_whole(sim_strict *s, const frame *f)
{
    char why[WHY_BYTES] = "the sum is wrong";
    const grobo_telegram *said;
    const char *code =
        f->sum_ok ? wrong_telegram(s, f->bytes, f->size, f->as.relay, &said, why) : "sum";
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
    const grobo_telegram *said;
    if (s->told || wrong_telegram(s, s->packet, s->n_packet, false, &said, why)) {
        return;
    }
    s->told = true;
    if (s->talk.words->numbered) {
        snprintf(why, sizeof why, "the servo cannot do it (No.%d)", (int)event->value);
    } else {
        snprintf(why, sizeof why, "the servo cannot do it");
    }
    report(s, "refused", event->time_us, s->packet, s->n_packet, why);
}

static bool is_order(const sim_strict *s, const grobo_sim_event *event)
{
    static const char *const questions[] = {"ping", "nothing"};
    char why[WHY_BYTES];
    const grobo_telegram *said;
    (void)wrong_telegram(s, event->bytes, event->n_bytes, false, &said, why);
    for (size_t i = 0; said->action && i < sizeof questions / sizeof *questions; i++) {
        if (strcmp(said->action, questions[i]) == 0) {
            return false;
        }
    }
    return !said->action || !strstr(said->action, "read");
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

/* A servo that got another id is known by that. */
static void on_register(sim_strict *s, const grobo_sim_event *event)
{
    const grobo_servo_model *servo = s->servos ? s->servos[event->servo] : NULL;
    const grobo_servo_register *id = grobo_servo_register_of(servo, GROBO_ROLE_ID);
    if (id && event->value == id->address && event->value2 >= 0 && event->value2 < TALK_IDS) {
        s->talk.servo[event->value2] = servo;
    }
}

void sim_strict_event(sim_strict *s, const grobo_sim_event *event)
{
    if (!s->a) {
        return;
    }
    if (event->kind == GROBO_SIM_REGISTER) {
        on_register(s, event);
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

void sim_strict_start(sim_strict *s, app *a, int robot, const grobo_sim_config *sim,
                      const grobo_words *words)
{
    grobo_wiring wiring = sim->wiring;
    *s = (sim_strict){.a = a,
                      .robot = robot,
                      .wiring = wiring,
                      .start_us = grobo_now_us(),
                      .servos = sim->servos,
                      .talk = {.words = words}};
    for (int i = 0; sim->servos && i < sim->model->n_joints; i++) {
        s->talk.servo[grobo_model_joint(sim->model, i)->motor] = sim->servos[i];
    }
    frames_init(&s->host, &s->talk, FRAMES_HOST,
                wiring == GROBO_WIRING_BUS ? GROBO_WORDS_BUS : GROBO_WORDS_BOARD, on_frame, s);
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
