/* SPDX-License-Identifier: MIT */
/* scan and info: which servos answer, and what they are. */
#include <string.h>

#include "tools/grctl/cli/progress.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/conn/wire.h"

enum { OPT_ALL_BAUD, OPT_FIRST, OPT_LAST };
enum { IDENTITY_BYTES = 3, FEW = 4 }; /* No.0-1 model, No.2 firmware */

/* Looks at all ids that are missing, at most so many; a line is quiet after LISTEN_US without a
 * byte, or twice the worst lateness seen, and is not listened to for longer than LISTEN_MAX_US. */
enum { LOOKS_MAX = 4, LISTEN_US = 150000, LISTEN_MAX_US = 2000000 };

static const cli_option options[] = {
    [OPT_ALL_BAUD] =
        OPTION_FLAG("all-baud", 0, "at every baud rate that servos know (with --wiring bus)"),
    [OPT_FIRST] = OPTION_WHOLE("first", 0, "ID", 1, GROBO_RS30X_ID_MAX, "begin with this id (1)"),
    [OPT_LAST] = OPTION_WHOLE("last", 0, "ID", 1, GROBO_RS30X_ID_MAX, "end with this id (127)"),
};

typedef struct found {
    const app *a;
    json_t *list, *failed; /* NULL: as text */
    int n, silent;
    bool unsure;              /* the line was disturbed, or an id answers in no way that fits */
    int64_t took_us, wire_us; /* of asking */
    progress bar;
    int rate, n_rates; /* the rate that is asked at, of so many */
} found;

static const char *model_name(const uint8_t *identity)
{
    const char *name = grobo_rs30x_model_name((uint16_t)(identity[0] | identity[1] << 8));
    return name ? name : "unknown model";
}

/* The name of the joint that this id moves, NULL for none. */
static const char *joint_name(const app *a, int id)
{
    int joint = grobo_model_joint_of_motor(app_model(a), id);
    return joint < 0 ? NULL : app_model(a)->joints[joint].name;
}

/* One that answers with its identity, or (NULL) wrongly, or not at all where it should. */
static json_t *servo_json(const app *a, int id, int baud_bps, const uint8_t *identity, int error)
{
    int joint = grobo_model_joint_of_motor(app_model(a), id);
    return json_pack("{s:i,s:o?,s:s?,s:o*,s:o*,s:i,s:o*}", "id", id, "joint",
                     joint < 0 ? NULL : json_integer(joint), "name", joint_name(a, id), "model",
                     identity ? json_string(model_name(identity)) : NULL, "firmware",
                     identity ? json_integer(identity[2]) : NULL, "baud_bps", baud_bps, "status",
                     identity ? NULL : app_json_code(grobo_error_name(error)));
}

static void report(found *f, int id, int baud_bps, const uint8_t *identity)
{
    const char *name = joint_name(f->a, id);
    f->n++;
    if (f->list) {
        json_array_append_new(f->list, servo_json(f->a, id, baud_bps, identity, 0));
    } else {
        app_print("%3d  %-8s  firmware %3d  %6d bps  %s\n", id, model_name(identity), identity[2],
                  baud_bps, name ? name : "");
    }
}

static void report_failed(found *f, int id, int baud_bps, int error)
{
    if (f->failed) {
        json_array_append_new(f->failed, servo_json(f->a, id, baud_bps, NULL, error));
    }
}

/* ---- what comes ------------------------------------------------------------------------------ */

/* One baud rate. Every whole reply on the line counts for its servo, whenever it comes. */
typedef struct pass {
    found *f;
    bool there[GROBO_RS30X_ID_MAX + 1];
    int why[GROBO_RS30X_ID_MAX + 1]; /* the error of one that answered in no way that fits, or 0 */
    uint8_t identity[GROBO_RS30X_ID_MAX + 1][IDENTITY_BYTES];
    int64_t asked_us[GROBO_RS30X_ID_MAX + 1];
    int baud_bps, first, last, asking;
    int64_t heard_us;             /* when the last byte came, 0: none has */
    int64_t worst_us;             /* the longest that a reply took */
    uint32_t rubbish;             /* bytes that are of no whole packet, when the look began */
    int n;                        /* servos found */
    bool late;                    /* a reply came after its time */
    uint32_t wire_us, timeout_us; /* of a reply: its time on the wire, and what it is given */
    grobo_rs30x_parser parser;
} pass;

static bool tells_identity(const grobo_rs30x_packet *p)
{
    return p->kind == GROBO_RS30X_RETURN && p->address == GROBO_RS30X_MODEL &&
           p->length == IDENTITY_BYTES && (p->flags & GROBO_RS30X_STATUS_REFUSED) == 0;
}

static void take_replies(pass *p, int64_t now_us)
{
    grobo_rs30x_packet packet;
    while (grobo_rs30x_parser_next(&p->parser, &packet) > 0) {
        int id = packet.id;
        if (!tells_identity(&packet) || p->asked_us[id] == 0) {
            continue;
        }
        int64_t took_us = now_us - p->asked_us[id];
        if (took_us > p->worst_us) {
            p->worst_us = took_us;
        }
        p->late |= took_us > p->timeout_us;
        p->there[id] = true;
        memcpy(p->identity[id], packet.data, IDENTITY_BYTES);
    }
}

static void on_bytes(conn *c, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                     size_t size)
{
    pass *p = c->ctx;
    if (direction == GROBO_DIR_TX) {
        p->asked_us[p->asking] = now_us;
        return;
    }
    p->heard_us = now_us;
    while (size > 0) {
        size_t took = grobo_rs30x_parser_feed(&p->parser, bytes, size);
        take_replies(p, now_us);
        bytes += took;
        size -= took;
    }
}

static int64_t quiet_at(const pass *p, int64_t since_us)
{
    int64_t quiet_us = 2 * p->worst_us > LISTEN_US ? 2 * p->worst_us : LISTEN_US;
    return (p->heard_us > since_us ? p->heard_us : since_us) + quiet_us;
}

/* Until the line is quiet: nothing that was asked can be answered any more. */
static int listen_on(conn *c, pass *p)
{
    int64_t since_us = grobo_now_us(), at_us;
    int error;
    do {
        at_us = quiet_at(p, since_us);
        error = conn_sleep_until(c, at_us);
    } while (!error && quiet_at(p, since_us) > at_us && grobo_now_us() < since_us + LISTEN_MAX_US);
    grobo_rs30x_parser_end(&p->parser); /* a packet that is cut is followed by none of its bytes */
    take_replies(p, grobo_now_us());
    return error;
}

/* ---- scan ------------------------------------------------------------------------------------ */

static int ask(conn *c, pass *p, int id)
{
    uint8_t identity[IDENTITY_BYTES];
    p->asking = id;
    int error = servos_read(c, id, GROBO_RS30X_MODEL, IDENTITY_BYTES, identity);
    bool silent = error == GROBO_ERR_TIMEOUT || error == GROBO_ERR_SHORT;
    p->why[id] = silent ? 0 : error;
    return c->signal || c->link_error ? error : GROBO_OK;
}

/* So long that nothing is asked while a reply to the question before may come. */
static uint32_t patience(const pass *p)
{
    return (uint32_t)(2 * p->worst_us) + SERVOS_PATIENT_US;
}

/* On a terminal only: 127 silent ids take a second, and eleven rates more than ten. */
static void show_progress(const pass *p, int id)
{
    char text[48];
    double part = (double)(id - p->first) / (p->last - p->first + 1);
    if (!p->f->bar.shown) {
        return;
    }
    snprintf(text, sizeof text, "%d bps, id %d", p->baud_bps, id);
    progress_draw(&p->f->bar, (p->f->rate + part) / p->f->n_rates, text);
}

/* Asks all ids that are missing, and listens to what is still on its way. */
static int look(conn *c, pass *p, uint32_t margin_us)
{
    int error = servos_wait(c, p->baud_bps, IDENTITY_BYTES, margin_us, -1, &p->timeout_us);
    p->late = false;
    p->rubbish = p->parser.framer.stats.dropped_bytes;
    for (int id = p->first; id <= p->last && !error; id++) {
        show_progress(p, id);
        if (!p->there[id]) {
            error = ask(c, p, id);
        }
    }
    progress_clear(&p->f->bar);
    if (!error) {
        error = listen_on(c, p);
    }
    p->rubbish = p->parser.framer.stats.dropped_bytes - p->rubbish;
    p->n = 0;
    for (int id = p->first; id <= p->last; id++) {
        p->n += p->there[id];
    }
    return error;
}

/* One that the robot should have is missing, though others answer. */
static bool misses_joint(const conn *c, const pass *p)
{
    const grobo_model *model = grobo_robot_driver(c->robot)->model;
    for (int joint = 0; joint < model->n_joints && p->heard_us; joint++) {
        int id = grobo_model_motor_of_joint(model, joint);
        if (id >= p->first && id <= p->last && !p->there[id]) {
            return true;
        }
    }
    return false;
}

static bool has_suspects(const pass *p)
{
    for (int id = p->first; id <= p->last; id++) {
        if (p->why[id] && !p->there[id]) {
            return true;
        }
    }
    return false;
}

/*
 * The first look is quick: it takes a servo for silent after milliseconds. Where anything came late
 * or broken, or where a joint is missing, those that are missing are asked again with patience,
 * until a look finds nothing more and hears no rubbish.
 */
static int look_until_sure(conn *c, pass *p, bool *sure)
{
    bool few = p->last - p->first < FEW;
    int error = GROBO_OK, looks = 0;
    *sure = false;
    for (; !error && !*sure && looks < LOOKS_MAX; looks++) {
        int before = p->n;
        error = look(c, p,
                     looks > 1      ? patience(p)
                     : looks || few ? SERVOS_PATIENT_US
                                    : WIRE_SILENT_MARGIN_US);
        bool clean = p->rubbish == 0 && !has_suspects(p);
        *sure = p->n == p->last - p->first + 1 ||
                (clean && (looks ? p->n == before : !p->late && !misses_joint(c, p)));
    }
    return error;
}

/* Nobody is accused but by an answer to a question on a quiet line, with all the time it may take.
 * One that is silent then is silent. */
static int question_suspects(conn *c, pass *p, bool *sure)
{
    int error = servos_wait(c, p->baud_bps, IDENTITY_BYTES, patience(p), -1, NULL);
    for (int id = p->first; id <= p->last && !error; id++) {
        if (!p->why[id] || p->there[id]) {
            continue;
        }
        error = ask(c, p, id);
        if (!error) {
            error = listen_on(c, p);
        }
        if (p->why[id] && !p->there[id] && !error) {
            app_note(c->a, "id %d answers, but: %s (two servos with one id?)", id,
                     grobo_error_text(p->why[id]));
        }
    }
    *sure = *sure && !has_suspects(p);
    return error;
}

static int ask_all(conn *c, found *f, pass *p)
{
    int64_t began_us = grobo_now_us();
    bool sure = false;
    int error =
        wire_read_us(grobo_robot_driver(c->robot), p->baud_bps, IDENTITY_BYTES, &p->wire_us);
    grobo_rs30x_parser_init(&p->parser, GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS);
    c->ctx = p;
    c->on_bytes = on_bytes;
    if (!error) {
        error = look_until_sure(c, p, &sure);
    }
    if (!error) {
        error = question_suspects(c, p, &sure);
    }
    c->on_bytes = NULL;
    f->unsure |= !sure;
    f->took_us += grobo_now_us() - began_us;
    f->wire_us += (int64_t)p->wire_us * (p->last - p->first + 1);
    return error;
}

static int scan_ids(conn *c, found *f, int baud_bps)
{
    pass p = {.f = f,
              .baud_bps = baud_bps,
              .first = (int)app_number(c->a, OPT_FIRST, 1),
              .last = (int)app_number(c->a, OPT_LAST, GROBO_RS30X_ID_MAX)};
    int error = ask_all(c, f, &p);
    for (int id = p.first; id <= p.last; id++) {
        if (p.there[id]) {
            report(f, id, baud_bps, p.identity[id]);
        } else if (p.why[id]) {
            report_failed(f, id, baud_bps, p.why[id]);
        } else {
            f->silent++;
        }
    }
    return error;
}

static int scan_all_bauds(conn *c, found *f)
{
    grobo_serial *serial = grobo_session_serial(c->session);
    for (int code = 0; code <= GROBO_RS30X_BAUD_CODE_MAX; code++) {
        int baud_bps = grobo_rs30x_baud_bps((uint8_t)code);
        f->rate = code;
        int error = grobo_serial_set_baud(serial, baud_bps);
        if (error < 0) {
            app_note(c->a, "%d bps: %s", baud_bps, grobo_error_text(error));
            continue;
        }
        error = scan_ids(c, f, baud_bps);
        if (error) {
            return error;
        }
    }
    return GROBO_OK;
}

static int scan(conn *c)
{
    bool all = app_option(c->a, OPT_ALL_BAUD)->given > 0;
    found f = {.a = c->a,
               .list = c->a->json ? json_array() : NULL,
               .failed = c->a->json ? json_array() : NULL};
    f.n_rates = all ? GROBO_RS30X_BAUD_CODE_MAX + 1 : 1;
    progress_start(&f.bar, c->a);
    int error = all ? scan_all_bauds(c, &f) : scan_ids(c, &f, (int)conn_baud(c->a));
    if (error) {
        json_decref(f.list);
        json_decref(f.failed);
        return conn_fail(c, error, "scan");
    }
    if (c->a->json) {
        app_print_json(json_pack("{s:o,s:o,s:i,s:b,s:o,s:o}", "servos", f.list, "failed", f.failed,
                                 "silent", f.silent, "sure", !f.unsure, "took_ms",
                                 app_json_number((double)f.took_us / 1e3, 1), "wire_ms",
                                 app_json_number((double)f.wire_us / 1e3, 1)));
    } else {
        app_note(c->a, "%d servo%s; %d silent; %.0f ms, of which the wire took %.0f", f.n,
                 f.n == 1 ? "" : "s", f.silent, (double)f.took_us / 1e3, (double)f.wire_us / 1e3);
    }
    if (f.unsure) {
        app_note(c->a, "not sure: bytes came that are of no whole reply; scan again, see "
                       "'grctl doctor'");
    }
    return f.n && !f.unsure ? EXIT_DONE : EXIT_ROBOT;
}

static int run_scan(app *a)
{
    conn c;
    if (app_option(a, OPT_ALL_BAUD)->given && app_global(a, GLOBAL_WIRING)->choice != 1) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "scan: --all-baud needs --wiring bus: the board knows one rate only");
    }
    if (app_number(a, OPT_FIRST, 1) > app_number(a, OPT_LAST, GROBO_RS30X_ID_MAX)) {
        return app_fail(a, EXIT_USAGE, "ARG", "scan: --first is behind --last");
    }
    int status = conn_open_unchecked(&c, a);
    if (!status && app_option(a, OPT_ALL_BAUD)->given && grobo_session_sim(c.session)) {
        status = app_fail(a, EXIT_USAGE, "ARG",
                          "scan: --all-baud needs a line; 'grctl sim --wiring bus' makes one");
    } else if (!status && app_option(a, OPT_ALL_BAUD)->given &&
               strncmp(conn_device(&c), "tcp:", 4) == 0) {
        status = app_fail(a, EXIT_USAGE, "ARG",
                          "scan: --all-baud: the rate of a line behind TCP is not set from here");
    } else if (!status) {
        status = scan(&c);
    }
    return conn_close(&c, status);
}

/* ---- info ----------------------------------------------------------------------------------- */

static int info(conn *c)
{
    const grobo_model *model = grobo_robot_driver(c->robot)->model;
    bool board = app_global(c->a, GLOBAL_WIRING)->choice == 0;
    found f = {.a = c->a,
               .list = c->a->json ? json_array() : NULL,
               .failed = c->a->json ? json_array() : NULL};
    int baud_bps = (int)conn_baud(c->a), silent = 0;
    if (!c->a->json) {
        app_print("%s on %s, %s\n", model->name, conn_device(c),
                  board ? "through its board, which answers" : "servos straight on the bus");
    }
    for (int motor = 1; motor <= model->n_joints; motor++) {
        uint8_t identity[IDENTITY_BYTES];
        int error = servos_read(c, motor, GROBO_RS30X_MODEL, IDENTITY_BYTES, identity);
        if (c->signal || c->link_error) {
            json_decref(f.list);
            json_decref(f.failed);
            return conn_fail(c, error, "info");
        }
        if (error == GROBO_OK) {
            report(&f, motor, baud_bps, identity);
            continue;
        }
        silent++;
        report_failed(&f, motor, baud_bps, error);
        app_note(c->a, "motor %d (%s): %s", motor, joint_name(c->a, motor),
                 grobo_error_text(error));
    }
    if (c->a->json) {
        app_print_json(json_pack("{s:s,s:s,s:s,s:o,s:o}", "robot", model->name, "device",
                                 conn_device(c), "wiring", board ? "board" : "bus", "servos",
                                 f.list, "failed", f.failed));
    }
    return silent ? EXIT_ROBOT : EXIT_DONE;
}

static int run_info(app *a)
{
    conn c;
    int status = conn_open(&c, a);
    if (!status) {
        status = info(&c);
    }
    return conn_close(&c, status);
}

const cli_command cmd_scan = {
    .name = "scan",
    .arguments = "",
    .summary = "which servo ids answer",
    .details = "Asks every id for its model and prints those that answer, however late. A silent\n"
               "id costs 4 ms beside the wire's time. Where something comes late or broken, or\n"
               "where a joint of the robot is missing, ids that are missing are asked again with\n"
               "patience. --timeout MS gives each more time. Exit status 1 if none answers, or if\n"
               "it is not sure who does. Nothing moves.\n",
    .example = "  grctl scan --last 20\n  grctl scan --wiring bus --all-baud\n",
    COMMAND_OPTIONS(options),
    .run = run_scan,
};

const cli_command cmd_info = {
    .name = "info",
    .arguments = "",
    .summary = "the board, the servos' models and firmware",
    .details = "Prints how the robot is reached and what each of its servos is. A servo that does\n"
               "not answer is named and makes the exit status 1. Nothing moves.\n",
    .run = run_info,
};
