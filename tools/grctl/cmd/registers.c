/* SPDX-License-Identifier: MIT */
/* servo-get and servo-set: the registers of one servo, by name. */
#include <math.h>
#include <string.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/change.h"
#include "tools/grctl/conn/eeprom.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/registers.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/lang/lang.h"

enum { OPT_FLASH, OPT_RESTORE };

static const cli_option set_options[] = {
    [OPT_FLASH] = OPTION_FLAG("flash", 0, "keep it over power-off too; takes a second"),
    [OPT_RESTORE] = OPTION_TEXT("restore", 0, "FILE", "write back what a file says the servo kept"),
};

/* A servo of the command line, as far as it is known before it is asked. */
static int find_servo(app *a, const grobo_servo_model **servo)
{
    int status = 0;
    int id = servos_parse_id(a, a->line.argument[0], &status);
    if (id < 0) {
        return -status;
    }
    *servo = family_servo(app_driver(a), id);
    if (!*servo) {
        return -app_fail(a, EXIT_SAFETY, "UNSUPPORTED", "%s: servos of %s have no registers",
                         a->line.command->name, app_model(a)->name);
    }
    return id;
}

static const grobo_servo_register *find_register(app *a, const grobo_servo_model *servo,
                                                 const char *name, int *status)
{
    const grobo_servo_register *reg = grobo_servo_register_named(servo, name);
    char known[2048] = "";
    size_t at = 0;
    if (reg) {
        return reg;
    }
    for (size_t i = 0; (reg = grobo_servo_register_row(servo, i)) != NULL; i++) {
        int n = snprintf(known + at, sizeof known - at, " %s", reg->name);
        at += n > 0 && (size_t)n < sizeof known - at ? (size_t)n : 0;
    }
    *status = app_fail(a, EXIT_USAGE, "NOTFOUND", "no register '%s'; %s has:%s", name, servo->name,
                       known);
    return NULL;
}

/* The counts of the register, which servo-set takes, and what they mean. */
static void print_value(const grobo_servo_model *servo, const grobo_servo_register *reg,
                        int32_t value)
{
    char counts[REGISTERS_TEXT_BYTES], text[REGISTERS_TEXT_BYTES];
    snprintf(counts, sizeof counts, "%d", value);
    registers_text(servo, reg, value, text, sizeof text);
    app_print("%3d  %-20s %6s", reg->address, reg->name, counts);
    if (strcmp(text, counts) != 0) {
        app_print("  %12s", text);
    }
    app_print("\n");
}

/* As the file of its model says it. */
static const char *access_of(const grobo_servo_register *reg)
{
    static const char *const words[] = {"r", "rw", "kept r", "kept rw"};
    return words[((reg->flags & GROBO_REGISTER_KEPT) != 0) * 2 +
                 ((reg->flags & GROBO_REGISTER_W) != 0)];
}

/* Beside the counts what they mean: under a key with its unit, or as a word. */
static json_t *value_json(const grobo_servo_model *servo, const grobo_servo_register *reg,
                          int32_t value)
{
    char key[REGISTERS_TEXT_BYTES];
    json_t *o = json_pack("{s:s,s:i,s:i,s:s,s:s,s:[i,i]}", "name", reg->name, "address",
                          reg->address, "value", value, "unit", reg->unit, "access", access_of(reg),
                          "range", (int)reg->min, (int)reg->max);
    json_t *meaning = registers_json(servo, reg, value);
    registers_key(reg, key, sizeof key);
    if (strcmp(key, reg->name) != 0) {
        json_object_set(o, key, meaning);
    } else if (json_is_string(meaning)) {
        json_object_set(o, "word", meaning);
    }
    json_decref(meaning);
    return o;
}

static void show(conn *c, const grobo_servo_model *servo, const grobo_servo_register *reg,
                 int32_t value, json_t *list)
{
    if (c->a->json) {
        json_array_append_new(list, value_json(servo, reg, value));
    } else {
        print_value(servo, reg, value);
    }
}

/* What servo-get asks for: names of the command line, none for all. */
typedef struct wanted {
    conn *c;
    const grobo_servo_model *servo;
    json_t *list;
} wanted;

/* The command line of the visit: wants() knows no more than the register. */
static const cli_line *asked;

static bool is_asked(const grobo_servo_register *reg)
{
    bool found = asked->n_arguments == 1;
    for (int i = 1; i < asked->n_arguments && !found; i++) {
        found = strcmp(asked->argument[i], reg->name) == 0;
    }
    return found;
}

static void take(void *ctx, const grobo_servo_register *reg, int32_t value)
{
    const wanted *w = ctx;
    show(w->c, w->servo, reg, value, w->list);
}

/* Whether all that is asked for are registers of the servo. */
static int check_names(app *a, const grobo_servo_model *servo)
{
    int status = 0;
    for (int i = 1; i < a->line.n_arguments && !status; i++) {
        (void)find_register(a, servo, a->line.argument[i], &status);
    }
    return status;
}

/* One register is read by itself: a servo without blocks may tell it otherwise. */
static int read_asked(conn *c, int id, const grobo_servo_model *servo, json_t *list)
{
    wanted w = {c, servo, list};
    const servos_visit visit = {is_asked, take, &w};
    int32_t value;
    asked = &c->a->line;
    if (asked->n_arguments != 2) {
        return servos_each(c, id, servo, &visit);
    }
    const grobo_servo_register *reg = grobo_servo_register_named(servo, asked->argument[1]);
    int error = servos_get(c, id, servo, reg, &value);
    if (!error) {
        show(c, servo, reg, value, list);
    }
    return error;
}

static int get(conn *c, int id)
{
    const grobo_servo_model *servo;
    int error = servos_model(c, id, &servo);
    if (error) {
        return conn_fail_servo(c, error, id);
    }
    int status = check_names(c->a, servo);
    if (status) {
        return status;
    }
    json_t *list = json_array();
    error = read_asked(c, id, servo, list);
    if (!error && c->a->json) {
        app_print_json(
            json_pack("{s:i,s:s,s:O}", "id", id, "model", servo->name, "registers", list));
    }
    json_decref(list);
    return error ? conn_fail_servo(c, error, id) : EXIT_DONE;
}

static int run_get(app *a)
{
    conn c;
    int status = 0;
    const grobo_servo_model *servo;
    int id = find_servo(a, &servo);
    if (id < 0) {
        return -id;
    }
    /* Before anybody is asked; another servo may have other registers. */
    if (grobo_model_joint_of_motor(app_model(a), id) >= 0) {
        status = check_names(a, servo);
    }
    if (status) {
        return status;
    }
    status = conn_open_named(&c, a);
    if (!status) {
        status = get(&c, id);
    }
    return conn_close(&c, status);
}

/* ---- servo-set ------------------------------------------------------------------------------ */

/* "delay 1 (150 us) -> 2 (200 us)" */
static void change_text(const servo_change *what, int32_t before, char *text, size_t capacity)
{
    char was[REGISTERS_TEXT_BYTES], is[REGISTERS_TEXT_BYTES];
    registers_text(what->servo, what->reg, before, was, sizeof was);
    registers_text(what->servo, what->reg, what->value, is, sizeof is);
    if (*what->reg->unit) {
        snprintf(text, capacity, "%s %d (%s) -> %d (%s)", what->reg->name, before, was, what->value,
                 is);
    } else {
        snprintf(text, capacity, "%s %d -> %d", what->reg->name, before, what->value);
    }
}

/* A rate that the line does not have. Only what it has can be asked through the board. */
static bool changes_rate(const conn *c, const servo_change *what)
{
    return what->reg->role == GROBO_ROLE_BAUD && change_bps(what) != (int32_t)conn_baud(c->a) &&
           !app_driver(c->a)->protocol->relay;
}

/* What is asked on a terminal before anything is kept; true to go on. */
static bool confirmed(conn *c, const servo_change *what, int32_t before)
{
    char answer[8], text[4 * REGISTERS_TEXT_BYTES];
    if (!change_is_kept(what)) {
        return true;
    }
    change_text(what, before, text, sizeof text);
    if (change_needs_command(what)) {
        app_note(c->a, "servo %d: %s, and No.4-29 go to flash%s: keep its power on", what->id, text,
                 changes_rate(c, what) ? _(", then it restarts") : "");
    } else {
        app_note(c->a, "servo %d: %s, kept over power-off", what->id, text);
    }
    if (app_global(c->a, GLOBAL_YES)->given || !c->a->tty_in) {
        return true;
    }
    output_complain(_("Write it? [y/N] "));
    return fgets(answer, sizeof answer, stdin) && (answer[0] == 'y' || answer[0] == 'Y');
}

/* baud_bps: where the servo answers after its rate was written, 0 where nothing is to be said. */
static void report(const conn *c, const servo_change *what, int32_t before, int baud_bps)
{
    char text[4 * REGISTERS_TEXT_BYTES], where[64] = "";
    bool ram = (what->reg->flags & GROBO_REGISTER_KEPT) == 0;
    const char *kept = change_is_kept(what)
                           ? change_needs_command(what) ? _(", kept in flash") : _(", kept")
                       : ram ? _("; lost at power-off")
                             : _("; lost at power-off without --flash");
    change_text(what, before, text, sizeof text);
    if (baud_bps) {
        snprintf(where, sizeof where, _("; it answers at %d bps"), baud_bps);
    }
    if (baud_bps && !change_is_kept(what) && baud_bps != change_bps(what)) {
        kept = _("; takes effect at a restart, and is lost there without --flash");
    }
    if (c->a->json) {
        app_print_json(json_pack("{s:i,s:s,s:i,s:i,s:b,s:o*}", "id", change_id(what), "name",
                                 what->reg->name, "before", before, "value", what->value, "flash",
                                 change_is_kept(what), "baud_bps",
                                 baud_bps ? json_integer(baud_bps) : NULL));
    } else {
        app_note(c->a, "servo %d: %s%s%s", change_id(what), text, kept, where);
    }
}

static grobo_write_kind kind_of(const app *a, const servo_change *what)
{
    const uint8_t bytes[FAMILY_PIECE_BYTES] = {0};
    uint16_t from = what->reg->address;
    int length = family_piece(app_driver(a), what->servo, what->reg, &from);
    const grobo_register_io io = {.id = (uint8_t)what->id,
                                  .address = from,
                                  .length = (uint16_t)(length ? length : what->reg->bytes),
                                  .data = bytes};
    return app_driver(a)->write_kind(app_driver(a), &io);
}

/* Whether a servo holds; of a joint its reading too, without which the engine refuses a setting. */
static int read_torque(conn *c, const servo_change *what, int32_t *torque)
{
    int joint = grobo_model_joint_of_motor(conn_model(c), what->id);
    int error = servos_torque(c, what->id, what->servo, torque);
    if (error || joint < 0) {
        return error;
    }
    error = conn_sense(c, GROBO_JOINT_BIT(joint), GROBO_SENSE_FULL);
    return error == GROBO_ERR_SETUP ? GROBO_OK : error; /* what this may put right */
}

/* After a setting a goal may mean another angle: it is written to a servo without torque only. The
 * engine refuses it to a joint too, and to one that it has not read. */
static int expect_loose(conn *c, const servo_change *what)
{
    const grobo_servo_register *reg = grobo_servo_register_of(what->servo, GROBO_ROLE_TORQUE);
    int32_t torque = GROBO_TORQUE_OFF;
    char servo[JOINTS_SERVO_BYTES];
    bool restarts = change_needs_command(what) && changes_rate(c, what);
    if ((kind_of(c->a, what) != GROBO_WRITE_SETTING && !restarts) || !reg) {
        return EXIT_DONE;
    }
    int error = read_torque(c, what, &torque);
    if (error) {
        return conn_fail_servo(c, error, what->id);
    }
    if (torque != GROBO_TORQUE_ON) {
        return EXIT_DONE;
    }
    if (grobo_model_joint_of_motor(conn_model(c), what->id) < 0) {
        return app_fail(c->a, EXIT_SAFETY, "STATE",
                        "servo-set: servo %d holds, and would %s with another %s; it is no joint "
                        "of this robot: switch its power off and on first",
                        what->id, restarts ? _("restart limp") : _("jump"), what->reg->name);
    }
    return app_fail(c->a, EXIT_SAFETY, "STATE",
                    "servo-set: servo %d holds, and would %s with another %s; first: grctl servo "
                    "off %s",
                    what->id, restarts ? _("restart limp") : _("jump"), what->reg->name,
                    joints_servo_of(c->a, what->id, "m", servo));
}

/* Two servos of one id answer together, and nobody could give one of them another. */
static int expect_free_id(conn *c, const servo_change *what)
{
    int32_t id;
    if (what->reg->role != GROBO_ROLE_ID || what->value == what->id) {
        return EXIT_DONE;
    }
    int error = servos_get(c, what->value, what->servo, what->reg, &id);
    if (error == GROBO_ERR_TIMEOUT) {
        return EXIT_DONE;
    }
    if (error) {
        return conn_fail_servo(c, error, what->value);
    }
    return app_fail(
        c->a, EXIT_SAFETY, "EXISTS",
        "servo-set: a servo with the id %d is there already; two of one id cannot be told "
        "apart; see 'grctl scan'",
        what->value);
}

/* ---- another baud rate: the servo is followed ------------------------------------------------ */

/*
 * Whether a servo changes its rate at once or when it restarts, no manual at hand says: it is
 * looked for at both.
 */
static int set_rate(conn *c, const servo_change *what, int32_t before)
{
    int old_bps = (int)conn_baud(c->a);
    int32_t code = 0;
    if (strncmp(conn_device(c), "tcp:", 4) == 0) {
        return app_fail(c->a, EXIT_SAFETY, "UNSUPPORTED",
                        "servo-set: the rate of a line behind TCP is not set from here; a servo "
                        "with another one could not be reached");
    }
    int error =
        change_tune(c, change_bps(what)); /* before anything is written: the line must know it */
    if (!error) {
        error = change_tune(c, old_bps);
    }
    if (error) {
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error),
                        "servo-set: %s at %d bps: %s; nothing was written", conn_device(c),
                        change_bps(what), app_error_text(error));
    }
    int at_bps = change_rate(c, what, old_bps, &code);
    error = change_tune(c, old_bps);
    if (conn_is_of_reply(at_bps)) {
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(at_bps),
                        "servo %d answers neither at %d nor at %d bps after writing; look for it "
                        "with 'grctl scan --all-baud'",
                        what->id, old_bps, change_bps(what));
    }
    if (at_bps < 0 || error < 0) {
        return conn_fail_servo(c, at_bps < 0 ? at_bps : error, what->id);
    }
    if (code != what->value || (what->flash && at_bps != change_bps(what))) {
        return app_fail(c->a, EXIT_ROBOT, "MISMATCH",
                        "servo %d answers at %d bps, and its baud is %d, not %d, after writing%s",
                        what->id, at_bps, code, what->value,
                        change_needs_command(what) ? _(" and a restart") : "");
    }
    report(c, what, before, at_bps);
    return EXIT_DONE;
}

/* ---- everything else ------------------------------------------------------------------------- */

static int write_and_verify(conn *c, const servo_change *what, int32_t before)
{
    int32_t after = before;
    int error = change_write(c, what);
    if (!error) {
        error = change_keep(c, what);
    }
    if (!error) {
        error = servos_get(c, change_id(what), what->servo, what->reg, &after);
    }
    if (error) {
        return conn_fail_servo(c, error, change_id(what));
    }
    if (after != what->value) {
        return app_fail(c->a, EXIT_ROBOT, "MISMATCH", "servo %d: %s is %d, not %d, after writing",
                        change_id(what), what->reg->name, after, what->value);
    }
    report(c, what, before, 0);
    return EXIT_DONE;
}

/* What the servo keeps now goes to a file first. */
static int save_first(conn *c, int id, const grobo_servo_model *servo)
{
    char path[EEPROM_PATH_BYTES];
    int status = eeprom_save(c, id, servo, path, sizeof path);
    if (!status) {
        app_note(c->a, "servo %d: what it keeps is saved: %s", id, path);
    }
    return status;
}

static int set(conn *c, const servo_change *what)
{
    int32_t before = 0;
    int error = expect_loose(c, what);
    if (!error) {
        error = expect_free_id(c, what);
    }
    if (error) {
        return error;
    }
    error = servos_get(c, what->id, what->servo, what->reg, &before);
    if (error) {
        return conn_fail_servo(c, error, what->id);
    }
    if (!confirmed(c, what, before)) {
        return app_fail(c->a, EXIT_USAGE, "CANCELED", "servo-set: nothing was written");
    }
    error = change_is_kept(what) ? save_first(c, what->id, what->servo) : EXIT_DONE;
    return error                   ? error
           : changes_rate(c, what) ? set_rate(c, what, before)
                                   : write_and_verify(c, what, before);
}

/* DYNAMIXEL that answer nothing but pings, or in another protocol, could not be asked again. */
static bool would_hide(const servo_change *what)
{
    bool pings_alone =
        what->reg->role == GROBO_ROLE_REPLY_LEVEL && what->value == 0 && what->reg->max > 1;
    return pings_alone || (strcmp(what->reg->name, "protocol_type") == 0 && what->value != 2);
}

/* ---- --restore ------------------------------------------------------------------------------- */

/* The registers that differ from a file, in the order in which they are written (turn_of). */
typedef struct restore {
    servo_change change[FAMILY_PIECE_BYTES];
    int n;
} restore;

/* The others are written while the servo answers writes: a write that is not answered is waited for
 * each time. The id is last, as the servo has another one then. */
enum { TURNS = 4 };
static int turn_of(const grobo_servo_register *reg, const json_t *value)
{
    bool answers = reg->role == GROBO_ROLE_REPLY_LEVEL && json_integer_value(value) == reg->max;
    return answers                               ? 0
           : reg->role == GROBO_ROLE_ID          ? 3
           : reg->role == GROBO_ROLE_REPLY_LEVEL ? 2
                                                 : 1;
}

static int compare(conn *c, int id, const grobo_servo_model *servo, const json_t *registers,
                   restore *r)
{
    const grobo_servo_register *reg;
    int error = GROBO_OK;
    for (int turn = 0; turn < TURNS; turn++) {
        for (size_t i = 0; !error && (reg = grobo_servo_register_row(servo, i)) != NULL; i++) {
            const json_t *value = json_object_get(registers, reg->name);
            int32_t is;
            if (!value || turn_of(reg, value) != turn || r->n == FAMILY_PIECE_BYTES) {
                continue;
            }
            error = servos_get(c, id, servo, reg, &is);
            if (!error && is != json_integer_value(value)) {
                r->change[r->n++] =
                    (servo_change){.id = id,
                                   .servo = servo,
                                   .reg = reg,
                                   .value = (int32_t)json_integer_value(value),
                                   .flash = servo->table->keeps != GROBO_KEEPS_COMMAND};
            }
        }
    }
    return error ? conn_fail_servo(c, error, id) : EXIT_DONE;
}

/* What can be written while the servo is there: its rate is set by a command of its own. */
static int expect_restorable(conn *c, const restore *r)
{
    int status = EXIT_DONE;
    char servo[JOINTS_SERVO_BYTES];
    for (int i = 0; i < r->n && !status; i++) {
        const servo_change *what = &r->change[i];
        status = expect_loose(c, what);
        status = status ? status : expect_free_id(c, what);
        if (!status && what->reg->role == GROBO_ROLE_BAUD) {
            status = app_fail(c->a, EXIT_SAFETY, "UNSUPPORTED",
                              "servo-set: the file has another rate; first: grctl servo-set %s "
                              "baud %d --flash",
                              joints_servo_of(c->a, what->id, "", servo), what->value);
        }
        if (!status && would_hide(what)) {
            status = app_fail(c->a, EXIT_SAFETY, "UNSUPPORTED",
                              "servo-set: with %s %d a servo answers nothing that is asked from "
                              "here, and could not be set back",
                              what->reg->name, what->value);
        }
    }
    return status;
}

/* One register, read back. The engine knows a joint's torque before each write. */
static int write_one(conn *c, const servo_change *what)
{
    int joint = grobo_model_joint_of_motor(conn_model(c), what->id);
    int32_t after = 0;
    int error = joint < 0 ? GROBO_OK : conn_sense(c, GROBO_JOINT_BIT(joint), GROBO_SENSE_GOAL);
    if (!error || error == GROBO_ERR_SETUP) {
        error = change_write(c, what);
    }
    if (!error && what->flash) {
        error = change_keep(c, what);
    }
    if (!error) {
        error = servos_get(c, change_id(what), what->servo, what->reg, &after);
    }
    return error ? error : after == what->value ? GROBO_OK : GROBO_ERR_MISMATCH;
}

static int write_back(conn *c, const restore *r)
{
    int error = GROBO_OK, id = r->n > 0 ? r->change[0].id : 0;
    for (int i = 0; i < r->n && !error; i++) {
        error = write_one(c, &r->change[i]);
        id = change_id(&r->change[i]);
    }
    if (!error && r->n > 0 && !r->change[0].flash) { /* RS30x write their flash once */
        servo_change last = r->change[r->n - 1];
        last.flash = true;
        error = change_keep(c, &last);
    }
    return error ? conn_fail_servo(c, error, id) : EXIT_DONE;
}

static int restore_file(conn *c, int id, const grobo_servo_model *servo, const char *path)
{
    static restore r;
    json_t *registers = NULL;
    r.n = 0;
    int status = eeprom_load(c->a, path, servo, &registers);
    status = status ? status : compare(c, id, servo, registers, &r);
    json_decref(registers);
    status = status ? status : expect_restorable(c, &r);
    if (!status && r.n > 0) {
        status = save_first(c, id, servo);
        status = status ? status : write_back(c, &r);
    }
    if (!status && c->a->json) {
        app_print_json(json_pack("{s:i,s:s,s:i}", "id", id, "file", path, "written", r.n));
    } else if (!status) {
        app_note(c->a, "servo %d: as in %s again; registers written: %d", id, path, r.n);
    }
    return status;
}

static int run_restore(app *a, const char *path)
{
    conn c;
    const grobo_servo_model *servo;
    int id = find_servo(a, &servo);
    int status = id < 0 ? -id : conn_open_named(&c, a);
    if (status) {
        return id < 0 ? status : conn_close(&c, status);
    }
    int error = servos_model(&c, id, &servo);
    status = error ? conn_fail_servo(&c, error, id) : restore_file(&c, id, servo, path);
    return conn_close(&c, status);
}

/* In counts of the register; a baud rate may be given as it is, too. */
static bool read_value(const servo_change *what, const char *text, int32_t *counts)
{
    double value;
    if (!cli_read_number(text, &value)) {
        return false;
    }
    if (what->reg->role == GROBO_ROLE_BAUD && value >= 1200 && value <= INT32_MAX) {
        value = grobo_servo_baud_code(what->servo, (int32_t)value);
    }
    if (!(value >= what->reg->min && value <= what->reg->max) || value != floor(value)) {
        return false;
    }
    *counts = (int32_t)value;
    return true;
}

/* What the command line asks for, of the servo that what->servo is. */
static int parse_change(app *a, servo_change *what)
{
    int status = 0;
    what->reg = find_register(a, what->servo, a->line.argument[1], &status);
    if (!what->reg) {
        return status;
    }
    if ((what->reg->flags & GROBO_REGISTER_W) == 0) {
        return app_fail(a, EXIT_USAGE, "ARG", "servo-set: register %s is read only",
                        what->reg->name);
    }
    if (kind_of(a, what) == GROBO_WRITE_MOTOR) {
        return app_fail(a, EXIT_SAFETY, "UNSUPPORTED",
                        "servo-set: %s moves the motor; use 'grctl %s'", what->reg->name,
                        what->reg->role == GROBO_ROLE_TORQUE ? "servo" : "move");
    }
    if (!read_value(what, a->line.argument[2], &what->value)) {
        return app_fail(a, EXIT_USAGE, "LIMIT", "servo-set: '%s': %s takes %d to %d (counts of %s)",
                        a->line.argument[2], what->reg->name, what->reg->min, what->reg->max,
                        *what->reg->unit ? what->reg->unit : "1");
    }
    if (would_hide(what)) {
        return app_fail(
            a, EXIT_SAFETY, "UNSUPPORTED",
            "servo-set: with %s %d a servo answers nothing that is asked from here, and "
            "could not be set back",
            what->reg->name, what->value);
    }
    what->flash = app_option(a, OPT_FLASH)->given > 0;
    if ((what->reg->flags & GROBO_REGISTER_KEPT) == 0 && what->flash) {
        return app_fail(a, EXIT_USAGE, "ARG", "servo-set: flash does not keep register %s",
                        what->reg->name);
    }
    if (what->reg->role == GROBO_ROLE_BAUD && change_bps(what) != GROBO_BAUD_DEFAULT_BPS &&
        app_driver(a)->protocol->relay) {
        return app_fail(a, EXIT_SAFETY, "UNSUPPORTED",
                        "servo-set: the bus behind the board has %d bps; a servo with another "
                        "baud rate could not be reached",
                        GROBO_BAUD_DEFAULT_BPS);
    }
    return 0;
}

static int run_set(app *a)
{
    conn c;
    servo_change what = {0};
    const char *file = app_option(a, OPT_RESTORE)->text;
    bool restores = app_option(a, OPT_RESTORE)->given > 0;
    if (a->line.n_arguments != (restores ? 1 : 3)) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "servo-set: takes ID KEY VALUE, or ID --restore FILE");
    }
    if (restores) {
        return run_restore(a, file);
    }
    what.id = find_servo(a, &what.servo);
    int status = what.id < 0 ? -what.id : parse_change(a, &what);
    if (status) {
        return status;
    }
    status = conn_open_named(&c, a);
    const grobo_servo_model *before = what.servo;
    int error = status ? 0 : servos_model(&c, what.id, &what.servo);
    if (error) {
        status = conn_fail_servo(&c, error, what.id);
    } else if (!status && what.servo != before) {
        status = parse_change(a, &what);
    }
    if (!status) {
        status = set(&c, &what);
    }
    return conn_close(&c, status);
}

const cli_command cmd_servo_get = {
    .name = "servo-get",
    .lines = CLI_LINES_SERVO,
    .heading = "Servos, frames, the simulator",
    COMMAND_ARGUMENTS("ID [KEY]...", 1, CLI_ARGUMENTS_MAX, CLI_ARG_JOINT),
    .summary = "read a servo's registers by name",
    .details =
        "Prints every register of a servo, or those named: address, name, value as it is stored\n"
        "and what that means. ID is the servo's id or the name of a joint. Several registers are\n"
        "read in one frame where the servo can.\n",
    .example = "  grctl servo-get 12\n  grctl servo-get R_KNEE_P delay id\n",
    .run = run_get,
};

const cli_command cmd_servo_set = {
    .name = "servo-set",
    .lines = CLI_LINES_SERVO,
    COMMAND_ARGUMENTS("ID [KEY VALUE]", 1, 3, CLI_ARG_JOINT),
    .summary = "write a servo's register by name",
    .details =
        "Writes one register and reads it back. The value is what the register stores (see\n"
        "servo-get); a baud rate may be given as it is. With --flash the servo also keeps its\n"
        "settings over power-off; that is shown first and, on a terminal, asked for. Goal and\n"
        "torque are refused: move and servo set them safely. Id, direction, limits and other\n"
        "settings that decide where a goal is are refused while the servo holds. An id that\n"
        "another servo has, and through the board a baud rate other than 115200, are refused too.\n"
        "\n"
        "What --flash does depends on the servo: RS30x write their flash, Feetech's are unlocked\n"
        "for this one write, and DYNAMIXEL keep id, limits and the like always.\n"
        "\n"
        "On a bus a new baud rate is written at the old one. With --flash an RS30x keeps it and\n"
        "restarts, the command follows it to the new rate and verifies that it answers there; -b\n"
        "then reaches it. Without --flash the servo stays at the old rate and forgets the new one\n"
        "when it restarts.\n"
        "\n"
        "Before anything is written that survives power-off, all that the servo keeps is saved\n"
        "to a file; its name is printed. --restore FILE writes what differs from it back.\n",
    .example = "  grctl servo-set 12 delay 2 --flash\n  grctl servo-set 1 id 21\n"
               "  grctl servo-set 1 --restore FILE\n",
    COMMAND_OPTIONS(set_options),
    .run = run_set,
};
