/* SPDX-License-Identifier: MIT */
/* scan and info: which servos answer, and what they are. */
#include <math.h>
#include <string.h>

#include "tools/grctl/bringup/scan.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/lang/lang.h"

enum { OPT_ALL_BAUD, OPT_FAMILY, OPT_FIRST, OPT_LAST };

static const cli_option options[] = {
    [OPT_ALL_BAUD] =
        OPTION_FLAG("all-baud", 0, "at every baud rate that servos know (with --wiring bus)"),
    [OPT_FAMILY] = OPTION_CHOICE("family", 0, family_or_all,
                                 "look for these servos on a line, at their usual rates"),
    [OPT_FIRST] =
        OPTION_WHOLE("first", 0, "ID", 0, SCAN_IDS - 1, "begin with this id (the lowest)"),
    [OPT_LAST] = OPTION_WHOLE("last", 0, "ID", 0, SCAN_IDS - 1, "end with this id (the highest)"),
};

typedef struct found {
    const app *a;
    const grobo_driver *driver;
    const grobo_robot_family *family; /* what is looked for; NULL: the robot's servos */
    bool guessing;                    /* whatever there is: only models that are known count */
    json_t *list, *failed;            /* NULL: as text */
    int n, silent;
    bool unsure;              /* the line was disturbed, or an id answers in no way that fits */
    int64_t took_us, wire_us; /* of asking */
    progress bar;
    int rate, n_rates; /* the rate that is asked at, of so many */
} found;

/* The name of the joint that this id moves, NULL for none. */
static const char *joint_name(const found *f, int id)
{
    int joint = f->family ? -1 : grobo_model_joint_of_motor(f->driver->model, id);
    return joint < 0 ? NULL : grobo_model_joint(f->driver->model, joint)->name;
}

/* One that answers with its identity, or (NULL) wrongly, or not at all where it should. */
static json_t *servo_json(const found *f, int id, int baud_bps, const scan_identity *is, int error)
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
    const scan_identity is = scan_identity_of(f->driver, bytes);
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

/* ---- scan ------------------------------------------------------------------------------------ */

/* On a terminal only: 127 silent ids take a second, and eleven rates more than ten. */
static void show_progress(const scan_pass *p, int id)
{
    found *f = p->ctx;
    char text[48];
    double part = (double)(id - p->first) / (p->last - p->first + 1);
    if (!f->bar.shown) {
        return;
    }
    snprintf(text, sizeof text, "%d bps, id %d", p->baud_bps, id);
    progress_draw(&f->bar, (f->rate + part) / f->n_rates, text);
}

static void report_pass(found *f, const scan_pass *p)
{
    progress_clear(&f->bar);
    for (int id = p->first; id <= p->last; id++) {
        if (p->there[id]) {
            report(f, id, p->baud_bps, p->identity[id]);
        } else if (p->why[id]) {
            report_failed(f, id, p->baud_bps, p->why[id]);
        } else {
            f->silent++;
        }
    }
    f->unsure |= !p->sure;
    f->took_us += p->took_us;
    f->wire_us += (int64_t)p->wire_us * (p->last - p->first + 1);
}

static int first_id(const app *a, const grobo_driver *driver)
{
    return (int)fmax(app_number(a, OPT_FIRST, 0), driver->protocol->id_min);
}

static int last_id(const app *a, const grobo_driver *driver)
{
    return (int)fmin(app_number(a, OPT_LAST, SCAN_IDS), driver->protocol->id_max);
}

static int scan_ids(conn *c, found *f, int baud_bps)
{
    static scan_pass p;
    memset(&p, 0, sizeof p);
    p.driver = f->driver;
    p.baud_bps = baud_bps;
    p.first = first_id(c->a, f->driver);
    p.last = last_id(c->a, f->driver);
    p.own = true;
    p.progress = show_progress;
    p.ctx = f;
    int error = scan_line(c, &p);
    report_pass(f, &p);
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

static void begin_rate(scan_search *s, scan_pass *p, int rate, int n_rates)
{
    found *f = s->ctx;
    f->rate = rate;
    f->n_rates = n_rates;
    p->progress = show_progress;
    p->ctx = f;
}

static void end_rate(scan_search *s, const grobo_robot_family *family, conn *c, const scan_pass *p)
{
    found *f = s->ctx;
    (void)c;
    f->family = family;
    f->driver = p->driver;
    report_pass(f, p);
}

static int run_families(app *a)
{
    found f = {.a = a,
               .guessing = strcmp(app_option(a, OPT_FAMILY)->text, "all") == 0,
               .list = a->json ? json_array() : NULL,
               .failed = a->json ? json_array() : NULL};
    scan_search search = {.family = app_option(a, OPT_FAMILY)->text,
                          .all_rates = app_option(a, OPT_ALL_BAUD)->given > 0,
                          .first = (int)app_number(a, OPT_FIRST, 0),
                          .last = (int)app_number(a, OPT_LAST, SCAN_IDS - 1),
                          .who = N_("scan: --family needs a line"),
                          .begins = begin_rate,
                          .ends = end_rate,
                          .ctx = &f};
    progress_start(&f.bar, a);
    int status = scan_families(a, &search);
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
    return family_servo(driver, grobo_model_joint(driver->model, 0)->motor)
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
                       : run_families(a);
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
    const grobo_model *model = conn_model(c);
    bool board = grobo_driver_wiring(grobo_robot_driver(c->robot)) == GROBO_WIRING_BOARD;
    uint16_t address = 0;
    const grobo_driver *driver = grobo_robot_driver(c->robot);
    int length = family_identity(driver, family_servo(driver, -1), &address);
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
        uint8_t bytes[FAMILY_PIECE_BYTES];
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
    .lines = CLI_LINES_EACH,
    .arguments = "",
    .summary = "find the servo ids that answer",
    .details =
        "Asks every id for its model and prints those that answer, however late. A silent id\n"
        "costs 4 ms beside the wire's time. Where something comes late or broken, missing ids are\n"
        "asked again with more time; a joint of the robot that is missing is asked again in any\n"
        "case. --timeout MS gives each more time. The exit status is 1 if no servo answers, or if\n"
        "the result is not certain. Nothing moves.\n"
        "--family looks for servos of a family instead of the robot's, at their usual rates, at\n"
        "that of -b, or with --all-baud at all rates; 'all' tries every family and counts models\n"
        "that it knows.\n",
    .example = "  grctl scan --last 20\n  grctl scan --wiring bus --all-baud\n"
               "  grctl scan --family all --last 10\n",
    COMMAND_OPTIONS(options),
    .run = run_scan,
};

const cli_command cmd_info = {
    .name = "info",
    .lines = CLI_LINES_EACH,
    .heading = "See",
    .arguments = "",
    .summary = "print models and firmware of the board and the servos",
    .details = "Prints how the robot is reached and what each of its servos is. A servo that does\n"
               "not answer is named and makes the exit status 1. Nothing moves.\n",
    .run = run_info,
};
