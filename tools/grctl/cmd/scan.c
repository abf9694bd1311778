/* SPDX-License-Identifier: MIT */
/* scan and info: which servos answer, and what they are. */
#include <math.h>
#include <string.h>

#include "tools/grctl/cli/progress.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/servo/family.h"

enum { OPT_ALL_BAUD, OPT_FAMILY, OPT_FIRST, OPT_LAST };
enum { IDS = 256, FEW = 4 };

/* Looks at all ids that are missing, at most so many; a line is quiet after LISTEN_US without a
 * byte, or twice the worst lateness seen, and is not listened to for longer than LISTEN_MAX_US. */
enum { LOOKS_MAX = 4, LISTEN_US = 150000, LISTEN_MAX_US = 2000000 };

static const cli_option options[] = {
    [OPT_ALL_BAUD] =
        OPTION_FLAG("all-baud", 0, "at every baud rate that servos know (with --wiring bus)"),
    [OPT_FAMILY] = OPTION_CHOICE("family", 0, "all|rs30x|dxl2|dxl1|sts|scs",
                                 "look for these servos on a line, at their usual rates"),
    [OPT_FIRST] = OPTION_WHOLE("first", 0, "ID", 0, IDS - 1, "begin with this id (the lowest)"),
    [OPT_LAST] = OPTION_WHOLE("last", 0, "ID", 0, IDS - 1, "end with this id (the highest)"),
};

typedef struct found {
    const app *a;
    const grobo_driver *driver;
    const family *family;  /* what is looked for; NULL: the robot's servos */
    bool guessing;         /* whatever there is: only models that are known count */
    json_t *list, *failed; /* NULL: as text */
    int n, silent;
    bool unsure;              /* the line was disturbed, or an id answers in no way that fits */
    int64_t took_us, wire_us; /* of asking */
    progress bar;
    int rate, n_rates; /* the rate that is asked at, of so many */
} found;

/* What the registers of family_identity() say. */
typedef struct identity {
    const char *model, *family;
    bool known;
    int32_t firmware; /* -1: not told */
} identity;

static identity identity_of(const grobo_driver *driver, const uint8_t *bytes)
{
    const grobo_servo_model *any = family_servo(driver, -1);
    const grobo_servo_register *reg = grobo_servo_register_of(any, GROBO_ROLE_MODEL);
    identity is = {
        .model = any->table->name, .family = family_of(any), .known = true, .firmware = -1};
    uint16_t from = 0;
    (void)family_identity(any, &from);
    if (reg) {
        const grobo_servo_model *model = family_identify(driver, bytes + (reg->address - from));
        is.known = model != NULL;
        is.family = family_of(model ? model : any);
        is.model = model ? model->name : "unknown model";
    }
    reg = grobo_servo_register_of(any, GROBO_ROLE_FIRMWARE);
    if (reg) {
        is.firmware = grobo_servo_register_get(any, reg, bytes + (reg->address - from));
    }
    return is;
}

/* The name of the joint that this id moves, NULL for none. */
static const char *joint_name(const found *f, int id)
{
    int joint = f->family ? -1 : grobo_model_joint_of_motor(f->driver->model, id);
    return joint < 0 ? NULL : f->driver->model->joints[joint].name;
}

/* One that answers with its identity, or (NULL) wrongly, or not at all where it should. */
static json_t *servo_json(const found *f, int id, int baud_bps, const identity *is, int error)
{
    int joint = joint_name(f, id) ? grobo_model_joint_of_motor(f->driver->model, id) : -1;
    return json_pack("{s:i,s:o?,s:s?,s:s*,s:o*,s:o*,s:i,s:o*}", "id", id, "joint",
                     joint < 0 ? NULL : json_integer(joint), "name", joint_name(f, id), "family",
                     f->family && is ? is->family : NULL, "model",
                     is ? json_string(is->model) : NULL, "firmware",
                     is && is->firmware >= 0 ? json_integer(is->firmware) : NULL, "baud_bps",
                     baud_bps, "status", is ? NULL : app_json_code(grobo_error_name(error)));
}

static void report(found *f, int id, int baud_bps, const uint8_t *bytes)
{
    const identity is = identity_of(f->driver, bytes);
    const char *name = f->family ? is.family : joint_name(f, id);
    char firmware[24] = "";
    if (f->guessing && !is.known) {
        return;
    }
    f->n++;
    if (is.firmware >= 0) {
        snprintf(firmware, sizeof firmware, "firmware %3d", (int)is.firmware);
    }
    if (f->list) {
        json_array_append_new(f->list, servo_json(f, id, baud_bps, &is, 0));
    } else {
        app_print("%3d  %-8s  %12s  %6d bps  %s\n", id, is.model, firmware, baud_bps,
                  name ? name : "");
    }
}

static void report_failed(found *f, int id, int baud_bps, int error)
{
    if (f->failed) {
        json_array_append_new(f->failed, servo_json(f, id, baud_bps, NULL, error));
    }
}

/* ---- what comes ------------------------------------------------------------------------------ */

/* One baud rate. Every whole reply on the line counts for its servo, whenever it comes. */
typedef struct pass {
    found *f;
    bool there[IDS];
    int why[IDS]; /* the error of one that answered in no way that fits, or 0 */
    uint8_t identity[IDS][FAMILY_IDENTITY_BYTES];
    int64_t asked_us[IDS];
    uint16_t address; /* of the registers that tell the identity */
    int bytes;        /* of them */
    int baud_bps, first, last, asking;
    int64_t heard_us;             /* when the last byte came, 0: none has */
    int64_t worst_us;             /* the longest that a reply took */
    uint32_t rubbish;             /* bytes of this look that are of no whole packet */
    int n;                        /* servos found */
    bool late;                    /* a reply came after its time */
    uint32_t wire_us, timeout_us; /* of a reply: its time on the wire, and what it is given */
    const grobo_protocol *protocol;
    uint8_t kept[GROBO_FRAME_MAX_BYTES]; /* of what came, from where a packet may begin */
    size_t n_kept;
} pass;

static void take_reply(pass *p, const grobo_packet *packet, int64_t now_us)
{
    int id = packet->id;
    if (packet->kind != GROBO_PACKET_RETURN || packet->refused || p->asked_us[id] == 0 ||
        packet->data_bytes != (size_t)p->bytes) {
        return;
    }
    int64_t took_us = now_us - p->asked_us[id];
    if (took_us > p->worst_us) {
        p->worst_us = took_us;
    }
    p->late |= took_us > p->timeout_us;
    p->there[id] = true;
    memcpy(p->identity[id], packet->data, packet->data_bytes);
}

static void drop(pass *p, size_t n)
{
    p->n_kept -= n;
    memmove(p->kept, p->kept + n, p->n_kept);
}

/* Packets of those that came, as far as they are whole; end: nothing more comes. */
static void take_replies(pass *p, int64_t now_us, bool end)
{
    while (p->n_kept > 0) {
        grobo_packet packet;
        uint8_t bytes[GROBO_FRAME_MAX_BYTES];
        int size =
            p->protocol->measure(p->kept, p->n_kept, GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS);
        if (size == 0 && !end && p->n_kept < sizeof p->kept) {
            return;
        }
        if (size <= 0) {
            p->rubbish++;
            drop(p, 1);
            continue;
        }
        memcpy(bytes, p->kept, (size_t)size); /* it may be changed */
        p->protocol->unpack(bytes, (size_t)size, &packet);
        take_reply(p, &packet, now_us);
        drop(p, (size_t)size);
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
        size_t room = sizeof p->kept - p->n_kept, took = size < room ? size : room;
        memcpy(p->kept + p->n_kept, bytes, took);
        p->n_kept += took;
        take_replies(p, now_us, false);
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
    take_replies(p, grobo_now_us(), true); /* none of the bytes of a packet that is cut follow */
    return error;
}

/* ---- scan ------------------------------------------------------------------------------------ */

static int ask(conn *c, pass *p, int id)
{
    uint8_t bytes[FAMILY_IDENTITY_BYTES];
    p->asking = id;
    int error = servos_read(c, id, p->address, p->bytes, bytes);
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
    int error = servos_wait(c, p->baud_bps, p->bytes, margin_us, -1, &p->timeout_us);
    p->late = false;
    p->rubbish = 0;
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
    for (int joint = 0; joint < model->n_joints && p->heard_us && !p->f->family; joint++) {
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
    int error = servos_wait(c, p->baud_bps, p->bytes, patience(p), -1, NULL);
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
                     app_error_text(p->why[id]));
        }
    }
    *sure = *sure && !has_suspects(p);
    return error;
}

static int ask_all(conn *c, found *f, pass *p)
{
    int64_t began_us = grobo_now_us();
    bool sure = false;
    int error = wire_read_us(grobo_robot_driver(c->robot), p->baud_bps, p->bytes, &p->wire_us);
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

static int first_id(const app *a, const grobo_driver *driver)
{
    return (int)fmax(app_number(a, OPT_FIRST, 0), driver->protocol->id_min);
}

static int last_id(const app *a, const grobo_driver *driver)
{
    return (int)fmin(app_number(a, OPT_LAST, IDS), driver->protocol->id_max);
}

static int scan_ids(conn *c, found *f, int baud_bps)
{
    pass p = {.f = f, .baud_bps = baud_bps, .protocol = f->driver->protocol};
    p.bytes = family_identity(family_servo(f->driver, -1), &p.address);
    p.first = first_id(c->a, f->driver);
    p.last = last_id(c->a, f->driver);
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
    const grobo_servo_table *table = family_servo(f->driver, -1)->table;
    for (int i = 0; i < table->rate_count; i++) {
        int baud_bps = table->rates[i].bps;
        f->rate = i;
        int error = grobo_serial_set_baud(serial, baud_bps);
        if (error < 0) {
            app_note(c->a, "%d bps: %s", baud_bps, app_error_text(error));
            continue;
        }
        error = scan_ids(c, f, baud_bps);
        if (error) {
            return error;
        }
    }
    return GROBO_OK;
}

/* Prints what was found, and returns the exit status. */
static int conclude(app *a, const found *f)
{
    if (a->json) {
        app_print_json(json_pack("{s:o,s:o,s:i,s:b,s:o,s:o}", "servos", f->list, "failed",
                                 f->failed, "silent", f->silent, "sure", !f->unsure, "took_ms",
                                 app_json_number((double)f->took_us / 1e3, 1), "wire_ms",
                                 app_json_number((double)f->wire_us / 1e3, 1)));
    } else {
        app_note(a, "%d servo%s; %d silent; %.0f ms, of which the wire took %.0f", f->n,
                 f->n == 1 ? "" : "s", f->silent, (double)f->took_us / 1e3,
                 (double)f->wire_us / 1e3);
    }
    if (f->unsure) {
        app_note(a, "not sure: bytes came that are of no whole reply; scan again, see "
                    "'grctl doctor'");
    }
    return f->n && !f->unsure ? EXIT_DONE : EXIT_ROBOT;
}

static int scan(conn *c)
{
    bool all = app_option(c->a, OPT_ALL_BAUD)->given > 0;
    found f = {.a = c->a,
               .driver = grobo_robot_driver(c->robot),
               .list = c->a->json ? json_array() : NULL,
               .failed = c->a->json ? json_array() : NULL};
    f.n_rates = all ? family_servo(f.driver, -1)->table->rate_count : 1;
    progress_start(&f.bar, c->a);
    int error = all ? scan_all_bauds(c, &f) : scan_ids(c, &f, (int)conn_baud(c->a));
    if (error) {
        json_decref(f.list);
        json_decref(f.failed);
        return conn_fail(c, error, "scan");
    }
    return conclude(c->a, &f);
}

/* ---- families ------------------------------------------------------------------------------- */

/* One family at one rate: the line is opened for it. */
static int look_for(app *a, found *f, int baud_bps)
{
    conn c;
    cli_value *baud = &a->line.global[GLOBAL_BAUD];
    const cli_value before = *baud;
    *baud = (cli_value){.given = 1, .number = baud_bps};
    a->driver = f->driver;
    int status = conn_open_unchecked(&c, a);
    if (!status && grobo_session_sim(c.session)) {
        status = app_fail(a, EXIT_USAGE, "ARG",
                          "scan: --family needs a line; 'grctl sim --servo' makes one");
    }
    int error = status ? 0 : scan_ids(&c, f, baud_bps);
    if (error) {
        status = conn_fail(&c, error, "scan");
    }
    status = conn_close(&c, status);
    *baud = before;
    return status;
}

/* At the rate of -b, or where such servos are found usually; with --all-baud at all they know. */
static int look_at_rates(app *a, found *f)
{
    const cli_value *asked = app_global(a, GLOBAL_BAUD);
    const cli_value *device = app_global(a, GLOBAL_DEVICE);
    const grobo_servo_table *table = f->family->table;
    bool all = app_option(a, OPT_ALL_BAUD)->given > 0;
    bool one = asked->given || (device->given && strncmp(device->text, "tcp:", 4) == 0);
    int n = one ? 1 : all ? table->rate_count : (int)(sizeof f->family->usual_bps / sizeof(int));
    int status = 0;
    f->n_rates = n;
    for (int i = 0; i < n && !status; i++) {
        int baud_bps = asked->given ? (int)asked->number
                       : all        ? table->rates[i].bps
                                    : f->family->usual_bps[i];
        f->rate = i;
        status = baud_bps > 0 ? look_for(a, f, baud_bps) : 0;
    }
    return status;
}

/* SCS talk as STS do, and are found with them. */
static int scan_families(app *a)
{
    const char *name = app_option(a, OPT_FAMILY)->text;
    found f = {.a = a,
               .guessing = strcmp(name, "all") == 0,
               .list = a->json ? json_array() : NULL,
               .failed = a->json ? json_array() : NULL};
    const grobo_driver *driver = a->driver;
    const config_robot *robot = a->robot;
    int status = 0;
    a->robot = NULL; /* its trims are of other joints */
    progress_start(&f.bar, a);
    for (size_t i = 0; (f.family = family_row(i)) != NULL && !status; i++) {
        bool twin = f.guessing && strcmp(f.family->name, "scs") == 0;
        f.driver = family_driver(f.family);
        if (f.driver && !twin && (f.guessing || strcmp(f.family->name, name) == 0)) {
            status = look_at_rates(a, &f);
        }
    }
    a->driver = driver;
    a->robot = robot;
    if (status) {
        json_decref(f.list);
        json_decref(f.failed);
        return status;
    }
    return conclude(a, &f);
}

/* 0 where the robot's servos tell what they are. */
static int need_registers(app *a)
{
    const grobo_driver *driver = app_driver(a);
    return family_servo(driver, driver->model->joints[0].motor)
               ? 0
               : app_fail(a, EXIT_SAFETY, "UNSUPPORTED", "%s: servos of %s have no registers",
                          a->line.command->name, driver->model->name);
}

static int run_scan(app *a)
{
    conn c;
    if (app_option(a, OPT_FAMILY)->given) {
        return a->link ? app_fail(a, EXIT_USAGE, "ARG",
                                  "scan: --family opens the line for itself; not in a shell")
                       : scan_families(a);
    }
    if (app_option(a, OPT_ALL_BAUD)->given && app_driver(a)->protocol->relay) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "scan: --all-baud needs --wiring bus: the board knows one rate only");
    }
    if (first_id(a, app_driver(a)) > last_id(a, app_driver(a))) {
        return app_fail(a, EXIT_USAGE, "ARG", "scan: --first is behind --last");
    }
    int status = need_registers(a);
    if (status) {
        return status;
    }
    status = conn_open_unchecked(&c, a);
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
    bool board = grobo_driver_wiring(grobo_robot_driver(c->robot)) == GROBO_WIRING_BOARD;
    uint16_t address = 0;
    int length = family_identity(family_servo(grobo_robot_driver(c->robot), -1), &address);
    found f = {.a = c->a,
               .driver = grobo_robot_driver(c->robot),
               .list = c->a->json ? json_array() : NULL,
               .failed = c->a->json ? json_array() : NULL};
    int baud_bps = (int)conn_baud(c->a), silent = 0;
    if (!c->a->json) {
        app_print("%s on %s, %s\n", model->name, conn_device(c),
                  board ? "through its board, which answers" : "servos straight on the bus");
    }
    for (int motor = 0; motor <= GROBO_SERVO_ID_MAX; motor++) {
        uint8_t bytes[FAMILY_IDENTITY_BYTES];
        if (!joint_name(&f, motor)) {
            continue;
        }
        int error = servos_read(c, motor, address, length, bytes);
        if (c->signal || c->link_error) {
            json_decref(f.list);
            json_decref(f.failed);
            return conn_fail(c, error, "info");
        }
        if (error == GROBO_OK) {
            report(&f, motor, baud_bps, bytes);
            continue;
        }
        silent++;
        report_failed(&f, motor, baud_bps, error);
        app_note(c->a, "motor %d (%s): %s", motor, joint_name(&f, motor), app_error_text(error));
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
    int status = need_registers(a);
    if (status) {
        return status;
    }
    status = conn_open(&c, a);
    if (!status) {
        status = info(&c);
    }
    return conn_close(&c, status);
}

const cli_command cmd_scan = {
    .name = "scan",
    .arguments = "",
    .summary = "which servo ids answer",
    .details =
        "Asks every id for its model and prints those that answer, however late. A silent\n"
        "id costs 4 ms beside the wire's time. Where something comes late or broken, or\n"
        "where a joint of the robot is missing, ids that are missing are asked again with\n"
        "patience. --timeout MS gives each more time. Exit status 1 if none answers, or if\n"
        "it is not sure who does. Nothing moves.\n"
        "--family looks for servos of a family instead of the robot's, at the rates where\n"
        "they are found usually, at that of -b, or with --all-baud at all; 'all' tries every\n"
        "family and counts models that it knows.\n",
    .example = "  grctl scan --last 20\n  grctl scan --wiring bus --all-baud\n"
               "  grctl scan --family all --last 10\n",
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
