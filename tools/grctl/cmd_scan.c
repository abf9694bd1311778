/* SPDX-License-Identifier: MIT */
/* scan and info: which servos answer, and what they are. */
#include <string.h>

#include "commands.h"
#include "servos.h"
#include "wire.h"

enum { OPT_ALL_BAUD, OPT_FIRST, OPT_LAST };
enum { IDENTITY_BYTES = 3, FEW = 4 }; /* No.0-1 model, No.2 firmware */

static const cli_option options[] = {
    [OPT_ALL_BAUD] = {.name = "all-baud",
                      .kind = CLI_FLAG,
                      .help = "at every baud rate that servos know (with --wiring bus)"},
    [OPT_FIRST] = {.name = "first",
                   .kind = CLI_NUMBER,
                   .value = "ID",
                   .help = "begin with this id (1)",
                   .min = 1,
                   .max = GROBO_SERVO_ID_MAX},
    [OPT_LAST] = {.name = "last",
                  .kind = CLI_NUMBER,
                  .value = "ID",
                  .help = "end with this id (127)",
                  .min = 1,
                  .max = GROBO_SERVO_ID_MAX},
};

typedef struct found {
    json_t *list; /* NULL: as text */
    int n, silent;
    int64_t took_us, wire_us; /* of asking */
} found;

static const char *model_name(const uint8_t *identity)
{
    const char *name = grobo_rs30x_model_name((uint16_t)(identity[0] | identity[1] << 8));
    return name ? name : "unknown model";
}

/* The name of the joint that this id moves on GR001, "" for none. */
static const char *joint_name(int id)
{
    int joint = grobo_model_joint_of_motor(&grobo_gr001_model, id);
    return joint < 0 ? "" : grobo_gr001_model.joints[joint].name;
}

static void report(found *f, int id, int baud_bps, const uint8_t *identity)
{
    f->n++;
    if (f->list)
        json_array_append_new(f->list, json_pack("{s:i,s:s,s:i,s:i,s:s}", "id", id, "model",
                                                 model_name(identity), "firmware", identity[2],
                                                 "baud_bps", baud_bps, "joint", joint_name(id)));
    else
        printf("%3d  %-8s  firmware %3d  %6d bps  %s\n", id, model_name(identity), identity[2],
               baud_bps, joint_name(id));
}

/* ---- scan ------------------------------------------------------------------------------------ */

/* One baud rate. */
typedef struct pass {
    bool there[GROBO_SERVO_ID_MAX + 1], strange[GROBO_SERVO_ID_MAX + 1];
    uint8_t identity[GROBO_SERVO_ID_MAX + 1][IDENTITY_BYTES];
    int first, last;
} pass;

/* Asks who has not answered; silence is an answer. 0 when all were asked. */
static int ask_silent(conn *c, pass *p)
{
    for (int id = p->first; id <= p->last; id++) {
        int error;
        if (p->there[id] || p->strange[id])
            continue;
        error = servos_read(c, id, GROBO_RS30X_MODEL, IDENTITY_BYTES, p->identity[id]);
        if (c->signal || c->link_error)
            return error;
        p->there[id] = error == GROBO_OK;
        p->strange[id] = error && error != GROBO_ERR_TIMEOUT && error != GROBO_ERR_SHORT;
        if (p->strange[id])
            app_note(c->a, "id %d answers, but: %s (two servos with one id?)", id,
                     grobo_error_text(error));
    }
    return GROBO_OK;
}

/*
 * Who comes too late is no silent servo: then all that seem silent are asked again, with patience,
 * and a few are asked so from the first.
 */
static int ask_all(conn *c, found *f, pass *p, int baud_bps)
{
    const grobo_bus_stats *stats = grobo_robot_get_bus_stats(c->robot);
    bool few = p->last - p->first < FEW;
    uint32_t late = stats->late_bytes, wire_us = 0;
    int64_t began_us = grobo_now_us();
    int error = wire_read_us(grobo_robot_driver(c->robot), baud_bps, IDENTITY_BYTES, &wire_us);
    if (!error)
        error = servos_wait(c, baud_bps, IDENTITY_BYTES,
                            few ? SERVOS_PATIENT_US : WIRE_SILENT_MARGIN_US, -1);
    if (!error)
        error = ask_silent(c, p);
    if (!error && stats->late_bytes != late && !few) {
        error = servos_wait(c, baud_bps, IDENTITY_BYTES, SERVOS_PATIENT_US, -1);
        if (!error)
            error = ask_silent(c, p);
    }
    f->took_us += grobo_now_us() - began_us;
    f->wire_us += (int64_t)wire_us * (p->last - p->first + 1);
    return error;
}

static int scan_ids(conn *c, found *f, int baud_bps)
{
    pass p = {.first = (int)app_number(c->a, OPT_FIRST, 1),
              .last = (int)app_number(c->a, OPT_LAST, GROBO_SERVO_ID_MAX)};
    int error = ask_all(c, f, &p, baud_bps);
    for (int id = p.first; id <= p.last; id++) {
        if (p.there[id])
            report(f, id, baud_bps, p.identity[id]);
        else
            f->silent += !p.strange[id];
    }
    return error;
}

static int scan_all_bauds(conn *c, found *f)
{
    grobo_serial *serial = grobo_session_serial(c->session);
    for (int code = 0; code <= GROBO_RS30X_BAUD_CODE_MAX; code++) {
        int baud_bps = grobo_rs30x_baud_bps((uint8_t)code);
        int error = grobo_serial_set_baud(serial, baud_bps);
        if (error < 0) {
            app_note(c->a, "%d bps: %s", baud_bps, grobo_error_text(error));
            continue;
        }
        error = scan_ids(c, f, baud_bps);
        if (error)
            return error;
    }
    return GROBO_OK;
}

static int scan(conn *c)
{
    const cli_value *baud = app_global(c->a, GLOBAL_BAUD);
    int baud_bps = baud->given ? (int)baud->number : GROBO_BAUD_DEFAULT_BPS;
    bool all = app_option(c->a, OPT_ALL_BAUD)->given > 0;
    found f = {.list = c->a->json ? json_array() : NULL};
    int error = all ? scan_all_bauds(c, &f) : scan_ids(c, &f, baud_bps);
    if (error) {
        json_decref(f.list);
        return conn_fail(c, error, "scan");
    }
    if (c->a->json)
        app_print_json(json_pack("{s:o,s:i,s:o,s:o}", "servos", f.list, "silent", f.silent,
                                 "took_ms", app_json_number((double)f.took_us / 1e3, 1), "wire_ms",
                                 app_json_number((double)f.wire_us / 1e3, 1)));
    else
        app_note(c->a, "%d servo%s; %d silent; %.0f ms, of which the wire took %.0f", f.n,
                 f.n == 1 ? "" : "s", f.silent, (double)f.took_us / 1e3, (double)f.wire_us / 1e3);
    return f.n ? EXIT_DONE : EXIT_ROBOT;
}

static int run_scan(app *a)
{
    conn c;
    int status;
    if (app_option(a, OPT_ALL_BAUD)->given && app_global(a, GLOBAL_WIRING)->choice != 1)
        return app_fail(a, EXIT_USAGE, "USAGE",
                        "scan: --all-baud needs --wiring bus: the board knows one rate only");
    if (app_number(a, OPT_FIRST, 1) > app_number(a, OPT_LAST, GROBO_SERVO_ID_MAX))
        return app_fail(a, EXIT_USAGE, "USAGE", "scan: --first is behind --last");
    status = conn_open_unchecked(&c, a);
    if (!status && app_option(a, OPT_ALL_BAUD)->given && grobo_session_sim(c.session))
        status = app_fail(a, EXIT_USAGE, "USAGE",
                          "scan: --all-baud needs a line; 'grctl sim --wiring bus' makes one");
    else if (!status)
        status = scan(&c);
    return conn_close(&c, status);
}

/* ---- info ----------------------------------------------------------------------------------- */

static int info(conn *c)
{
    const grobo_model *model = grobo_robot_driver(c->robot)->model;
    bool board = app_global(c->a, GLOBAL_WIRING)->choice == 0;
    found f = {.list = c->a->json ? json_array() : NULL};
    const cli_value *baud = app_global(c->a, GLOBAL_BAUD);
    int baud_bps = baud->given ? (int)baud->number : GROBO_BAUD_DEFAULT_BPS;
    int silent = 0;
    if (!c->a->json)
        printf("%s on %s, %s\n", model->name, conn_device(c),
               board ? "through its board, which answers" : "servos straight on the bus");
    for (int motor = 1; motor <= model->n_joints; motor++) {
        uint8_t identity[IDENTITY_BYTES];
        int error = servos_read(c, motor, GROBO_RS30X_MODEL, IDENTITY_BYTES, identity);
        if (c->signal || c->link_error) {
            json_decref(f.list);
            return conn_fail(c, error, "info");
        }
        if (error == GROBO_OK) {
            report(&f, motor, baud_bps, identity);
            continue;
        }
        silent++;
        app_note(c->a, "motor %d (%s): %s", motor, joint_name(motor), grobo_error_text(error));
    }
    if (c->a->json)
        app_print_json(json_pack("{s:s,s:s,s:s,s:o}", "robot", model->name, "device",
                                 conn_device(c), "wiring", board ? "board" : "bus", "servos",
                                 f.list));
    return silent ? EXIT_ROBOT : EXIT_DONE;
}

static int run_info(app *a)
{
    conn c;
    int status = conn_open(&c, a);
    if (!status)
        status = info(&c);
    return conn_close(&c, status);
}

const cli_command cmd_scan = {
    .name = "scan",
    .arguments = "",
    .summary = "which servo ids answer",
    .details = "Asks every id once for its model and prints those that answer. A silent id costs\n"
               "4 ms beside the wire's time; replies that come later make it ask again, with more\n"
               "patience. --timeout MS gives each more time. Exit status 1 if none answers.\n"
               "Nothing moves.\n",
    .example = "  grctl scan --last 20\n  grctl scan --wiring bus --all-baud\n",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
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
