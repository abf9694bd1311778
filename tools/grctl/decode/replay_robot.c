/* SPDX-License-Identifier: MIT */
/*
 * A trace against a real robot. Every frame is judged before the first one is sent: reads may
 * go, goals and torque go through the engine's gate after a question, the rest is refused.
 */
#include <string.h>

#include <grobo/core/driver.h>
#include <grobo/core/robot.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/decode/replay.h"
#include "tools/grctl/decode/words.h"
#include "tools/grctl/lang/lang.h"

typedef enum danger {
    HARMLESS, /* reads */
    MOVES,    /* goals, torque: the engine can judge them */
    REFUSED   /* settings, flash, stored motions, broken frames: nobody can */
} danger;

typedef struct plan {
    replay *r;
    conn c;
    uint64_t moves;
    grobo_joint_mask torqued; /* joints whose torque the trace switches on */
    int64_t start_us;         /* of the replay, by our clock */
    int64_t last_us;          /* of its last frame, from there */
    progress bar;
    int status; /* why it has to end, 0: it need not */
    bool reads; /* for itself: these replies are not compared */
} plan;

/* ---- judging ------------------------------------------------------------------------------- */

static bool is_motion_register(unsigned address)
{
    return (address >= GROBO_RS30X_GOAL && address <= GROBO_RS30X_GOAL_TIME + 1) ||
           address == GROBO_RS30X_TORQUE;
}

typedef enum carried { NO_PACKET, CHECK, PACKET } carried;

/* The one good packet of a frame; a frame may ask the board itself instead. */
static carried packet_of(const frame *f, grobo_rs30x_packet *p)
{
    grobo_board_frame board;
    bool good = false;
    const uint8_t *bytes = f->bytes;
    size_t n = f->size;
    if (f->kind == FRAME_BOARD && grobo_board_peek(f->bytes, f->size, &board) > 0) {
        if (board.kind == GROBO_BOARD_CHECK) {
            return CHECK;
        }
        bytes = board.packet;
        n = board.packet_bytes;
    }
    int size = n > 0 ? grobo_rs30x_peek(bytes, n, GROBO_ACCEPT_COMMANDS, p, &good) : 0;
    return size > 0 && (size_t)size == n && good ? PACKET : NO_PACKET;
}

static danger judge(const frame *f)
{
    const unsigned acts = GROBO_RS30X_FLASH | GROBO_RS30X_REBOOT | GROBO_RS30X_FACTORY;
    grobo_rs30x_packet p;
    switch (packet_of(f, &p)) {
    case NO_PACKET:
        return REFUSED;
    case CHECK:
        return HARMLESS;
    case PACKET:
        break;
    }
    if (p.flags & (acts | 0x80)) {
        return REFUSED;
    }
    if (p.data_bytes == 0) {
        return HARMLESS;
    }
    size_t n = p.kind == GROBO_RS30X_LONG ? (size_t)p.length - 1 : p.data_bytes;
    for (size_t i = 0; i < n; i++) {
        if (!is_motion_register(p.address + (unsigned)i)) {
            return REFUSED;
        }
    }
    return MOVES;
}

static void note_torque(plan *p, const frame *f)
{
    const grobo_driver *driver = grobo_gr001_driver(p->r->wiring);
    grobo_target target = {0};
    grobo_joint_mask torqued[GROBO_TORQUE_BRAKE + 1] = {0};
    grobo_posture_init(&target.posture, driver->model->n_joints);
    if (driver->inspect(driver, NULL, f->bytes, f->size, &target, torqued) >= 0) {
        p->torqued |= torqued[GROBO_TORQUE_ON];
    }
}

static void judge_frame(void *ctx, const frame *f)
{
    static char text[WORDS_BYTES];
    replay *r = ctx;
    plan *p = r->ctx;
    if (p->status || f->kind == FRAME_CUT || f->kind == FRAME_RUBBISH) {
        return;
    }
    p->last_us = f->time_us;
    switch (judge(f)) {
    case HARMLESS:
        return;
    case MOVES:
        p->moves++;
        note_torque(p, f);
        return;
    case REFUSED:
        words_say(f, false, "", text, sizeof text);
        text[strcspn(text, "\n")] = '\0';
        p->status =
            app_fail(r->a, EXIT_SAFETY, "UNSUPPORTED",
                     "replay: at %.3f ms: not to a real robot: %s", (double)f->time_us / 1e3, text);
    }
}

static int judge_chunk(void *ctx, const pcapng_chunk *chunk)
{
    plan *p = ctx;
    if (chunk->direction == PCAPNG_OUT) {
        frames_feed(&p->r->host, chunk->time_us - p->r->first_us, chunk->bytes, chunk->size);
    }
    return p->status;
}

static int ask(const plan *p)
{
    app *a = p->r->a;
    char answer[8] = "";
    if (p->moves == 0 || app_global(a, GLOBAL_YES)->given) {
        return 0;
    }
    if (!a->tty_err || !a->tty_in) {
        return app_fail(a, EXIT_SAFETY, "UNSUPPORTED",
                        "replay: %llu frames move joints of a real robot; say --yes if it may",
                        (unsigned long long)p->moves);
    }
    output_complain(_("%llu frames move joints of the robot at %s. Send them? [y/N] "),
                    (unsigned long long)p->moves, app_global(a, GLOBAL_DEVICE)->text);
    if (!fgets(answer, sizeof answer, stdin) || (answer[0] != 'y' && answer[0] != 'Y')) {
        return app_fail(a, EXIT_SAFETY, "UNSUPPORTED", "replay: nothing was sent");
    }
    return 0;
}

/* ---- sending ------------------------------------------------------------------------------- */

static void on_bytes(conn *c, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                     size_t size)
{
    plan *p = c->ctx;
    if (direction == GROBO_DIR_RX && !p->reads) {
        replay_answer(p->r, REPLAY_REPLAYED, now_us - p->start_us, bytes, size);
    }
}

/* What a robot may do to a frame that the comparison will tell; everything else ends it. */
static bool is_reply_trouble(int error)
{
    return conn_is_of_reply(error) || error == GROBO_ERR_NACK;
}

/* Frames of the trace are sent once; what replay asks by itself is asked again, as usual. */
static int asks_again(plan *p, bool again)
{
    grobo_robot_config config = conn_robot_config(p->r->a);
    if (!again) {
        config.retries = -1;
    }
    return grobo_robot_configure(p->c.robot, &config);
}

/* Torque comes on only where the joints were read just now: a frame that would not leave for that
 * is sent after a reading, whose replies are not those of the trace. */
static int send_one(plan *p, const frame *f)
{
    int error = conn_wait(&p->c, grobo_robot_raw(p->c.robot, f->bytes, f->size));
    if (error == GROBO_ERR_STALE && p->torqued) {
        p->reads = true;
        (void)asks_again(p, true);
        (void)conn_sense(&p->c, p->torqued, GROBO_SENSE_FULL);
        (void)asks_again(p, false);
        p->reads = false;
        error = conn_wait(&p->c, grobo_robot_raw(p->c.robot, f->bytes, f->size));
    }
    return error;
}

static void show_progress(plan *p, int64_t at_us)
{
    char text[64];
    if (p->last_us < 2000000) {
        return;
    }
    snprintf(text, sizeof text, _("replay: %.1f of %.1f s"), (double)at_us / 1e6,
             (double)p->last_us / 1e6);
    progress_draw(&p->bar, (double)at_us / (double)p->last_us, text);
}

static void send_frame(void *ctx, const frame *f)
{
    replay *r = ctx;
    plan *p = r->ctx;
    char doing[48];
    if (p->status || f->kind == FRAME_CUT || f->kind == FRAME_RUBBISH) {
        return;
    }
    replay_ask(r, f);
    show_progress(p, f->time_us);
    int error = conn_sleep_until(&p->c, p->start_us + f->time_us);
    if (!error) {
        error = send_one(p, f);
    }
    if (error && !is_reply_trouble(error)) {
        progress_clear(&p->bar);
        snprintf(doing, sizeof doing, _("replay: the frame at %.3f ms"), (double)f->time_us / 1e3);
        p->status = conn_fail(&p->c, error, doing);
    }
}

static int send_chunk(void *ctx, const pcapng_chunk *chunk)
{
    plan *p = ctx;
    int64_t at_us = chunk->time_us - p->r->first_us;
    if (chunk->direction == PCAPNG_OUT) {
        frames_feed(&p->r->host, at_us, chunk->bytes, chunk->size);
    } else if (chunk->direction == PCAPNG_IN) {
        replay_answer(p->r, REPLAY_RECORDED, at_us, chunk->bytes, chunk->size);
    }
    return p->status;
}

/* The line has become quiet before the trace begins: it is looked at so often. */
#define LOOK_US 5000

/*
 * The gate wants to know where the joints are, and torque to have come on safely. Then every
 * frame is sent once, and late replies to what was asked so far are let go by. From then on the
 * joints are not watched: replies to other questions would be compared with those of the trace.
 */
static int prepare(plan *p)
{
    grobo_joint_mask all = GROBO_JOINTS_ALL(conn_model(&p->c)->n_joints);
    int error = 0;
    if (p->moves) {
        error = conn_sense(&p->c, all, GROBO_SENSE_FULL);
    }
    if (!error && p->torqued) {
        error = conn_wait(&p->c, grobo_robot_torque(p->c.robot, p->torqued, GROBO_TORQUE_ON));
    }
    if (!error) {
        error = asks_again(p, false);
    }
    while (!error && !grobo_robot_is_quiet(p->c.robot)) { /* a joint that did not answer is asked */
        error = conn_sleep_until(&p->c, grobo_now_us() + LOOK_US);
    }
    if (!error) {
        error = conn_sleep_until(&p->c, grobo_now_us() + GROBO_BUS_HOLD_US);
    }
    return error ? conn_fail(&p->c, error, "replay") : 0;
}

static int send_all(plan *p)
{
    int status = p->moves ? conn_open_to_move(&p->c, p->r->a) : conn_open(&p->c, p->r->a);
    p->c.ctx = p;
    p->c.moving = p->moves > 0;
    if (!status) {
        status = prepare(p);
    }
    if (!status) {
        replay_begin(p->r, send_frame);
        progress_start(&p->bar, p->r->a);
        p->start_us = grobo_now_us();
        p->c.on_bytes = on_bytes;
        status = replay_read(p->r, send_chunk, p);
        if (!status) {
            frames_end(&p->r->host);
            status = p->status;
        }
        progress_clear(&p->bar);
        p->c.on_bytes = NULL; /* the exit policy is no part of it, and may try again */
        (void)asks_again(p, true);
    }
    return conn_close(&p->c, status);
}

int replay_to_robot(replay *r)
{
    static plan p;
    memset(&p, 0, sizeof p);
    p.r = r;
    r->ctx = &p;
    replay_begin(r, judge_frame);
    int status = replay_read(r, judge_chunk, &p);
    if (!status) {
        frames_end(&r->host);
        status = p.status;
    }
    if (!status) {
        status = ask(&p);
    }
    return status ? status : send_all(&p);
}
