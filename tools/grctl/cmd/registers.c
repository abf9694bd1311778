/* SPDX-License-Identifier: MIT */
/* servo-get and servo-set: the registers of one servo, by name. */
#include <math.h>
#include <string.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/change.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/servo/family.h"
#include "tools/grctl/servo/registers.h"

enum { OPT_FLASH };

static const cli_option set_options[] = {
    [OPT_FLASH] = OPTION_FLAG("flash", 0, "keep it over power-off too; takes a second"),
};

/* Nothing longer is read at once: RS30x return at most this much, and lines are shared. */
enum { BLOCK_BYTES = 30 };

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

/* Beside the counts what they mean: under a key with its unit, or as a word. */
static json_t *value_json(const grobo_servo_model *servo, const grobo_servo_register *reg,
                          int32_t value)
{
    char key[REGISTERS_TEXT_BYTES];
    json_t *o = json_pack("{s:s,s:i,s:i,s:s}", "name", reg->name, "address", reg->address, "value",
                          value, "unit", reg->unit);
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

/* Registers from number `first` on that are read at once. Returns how many, or the error. */
static int show_block(conn *c, int id, const grobo_servo_model *servo, size_t first, json_t *list)
{
    const grobo_servo_register *begin = grobo_servo_register_row(servo, first), *reg;
    uint8_t bytes[FAMILY_PIECE_BYTES] = {0};
    int n = family_block(grobo_robot_driver(c->robot), servo, first, BLOCK_BYTES);
    if (n == 0) { /* it can be written only */
        return 1;
    }
    reg = grobo_servo_register_row(servo, first + (size_t)n - 1);
    int error =
        servos_read(c, id, begin->address, reg->address + reg->bytes - begin->address, bytes);
    for (int i = 0; i < n && !error; i++) {
        reg = grobo_servo_register_row(servo, first + (size_t)i);
        show(c, servo, reg,
             grobo_servo_register_get(servo, reg, bytes + (reg->address - begin->address)), list);
    }
    return error ? error : n;
}

static int show_all(conn *c, int id, const grobo_servo_model *servo, json_t *list)
{
    int n = 1;
    for (size_t first = 0; n > 0 && grobo_servo_register_row(servo, first); first += (size_t)n) {
        n = show_block(c, id, servo, first, list);
        if (n < 0) {
            return n;
        }
    }
    return GROBO_OK;
}

static int get(conn *c, int id, const char *only)
{
    const grobo_servo_model *servo;
    const grobo_servo_register *reg = NULL;
    int32_t value;
    int status = 0;
    int error = servos_model(c, id, &servo);
    if (error) {
        return conn_fail_servo(c, error, id);
    }
    if (only && !(reg = find_register(c->a, servo, only, &status))) {
        return status;
    }
    json_t *list = json_array();
    if (!reg) {
        error = show_all(c, id, servo, list);
    } else if (!(error = servos_get(c, id, servo, reg, &value))) {
        show(c, servo, reg, value, list);
    }
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
    const char *only = a->line.n_arguments > 1 ? a->line.argument[1] : NULL;
    int id = find_servo(a, &servo);
    if (id < 0) {
        return -id;
    }
    /* Before anybody is asked; another servo may have other registers. */
    if (only && grobo_model_joint_of_motor(app_model(a), id) >= 0 &&
        !find_register(a, servo, only, &status)) {
        return status;
    }
    status = conn_open(&c, a);
    if (!status) {
        status = get(&c, id, only);
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
static int read_torque(conn *c, const servo_change *what, const grobo_servo_register *reg,
                       int32_t *torque)
{
    int joint = grobo_model_joint_of_motor(conn_model(c), what->id);
    int error = servos_get(c, what->id, what->servo, reg, torque);
    bool told = error != GROBO_ERR_UNSUPPORTED;
    if ((error && told) || joint < 0) {
        return error;
    }
    error = conn_sense(c, GROBO_JOINT_BIT(joint), GROBO_SENSE_FULL);
    grobo_joint_info i;
    if (!told && grobo_robot_joint(c->robot, joint, &i) == 0) {
        *torque = i.state.valid & GROBO_FIELD_TORQUE ? (int32_t)i.state.torque : GROBO_TORQUE_ON;
    }
    return error == GROBO_ERR_SETUP ? GROBO_OK : error; /* what this may put right */
}

/* After a setting a goal may mean another angle: it is written to a servo without torque only. The
 * engine refuses it to a joint too, and to one that it has not read. */
static int expect_loose(conn *c, const servo_change *what)
{
    const grobo_servo_register *reg = grobo_servo_register_of(what->servo, GROBO_ROLE_TORQUE);
    int32_t torque = GROBO_TORQUE_OFF;
    bool restarts = change_needs_command(what) && changes_rate(c, what);
    if ((kind_of(c->a, what) != GROBO_WRITE_SETTING && !restarts) || !reg) {
        return EXIT_DONE;
    }
    int error = read_torque(c, what, reg, &torque);
    if (error == GROBO_ERR_UNSUPPORTED) {
        return app_fail(c->a, EXIT_SAFETY, grobo_error_name(error),
                        "servo-set: servo %d does not tell whether it holds; name it in a robot's "
                        "file, which can make it limp",
                        what->id);
    }
    if (error) {
        return conn_fail_servo(c, error, what->id);
    }
    if (torque != GROBO_TORQUE_ON) {
        return EXIT_DONE;
    }
    return app_fail(c->a, EXIT_SAFETY, "STATE",
                    "servo-set: servo %d holds, and would %s with another %s; first: grctl servo "
                    "off m%d",
                    what->id, restarts ? _("restart limp") : _("jump"), what->reg->name, what->id);
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
    return changes_rate(c, what) ? set_rate(c, what, before) : write_and_verify(c, what, before);
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

/* DYNAMIXEL that answer nothing but pings, or in another protocol, could not be asked again. */
static bool would_hide(const servo_change *what)
{
    bool pings_alone =
        what->reg->role == GROBO_ROLE_REPLY_LEVEL && what->value == 0 && what->reg->max > 1;
    return pings_alone || (strcmp(what->reg->name, "protocol_type") == 0 && what->value != 2);
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
    what.id = find_servo(a, &what.servo);
    int status = what.id < 0 ? -what.id : parse_change(a, &what);
    if (status) {
        return status;
    }
    status = conn_open(&c, a);
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
    COMMAND_ARGUMENTS("ID [KEY]", 1, 2, CLI_ARG_JOINT),
    .summary = "read a servo's registers by name",
    .details =
        "Prints every register of a servo, or one: address, name, value as it is stored and\n"
        "what that means. ID is the servo's id or the name of a joint.\n",
    .example = "  grctl servo-get 12\n  grctl servo-get R_KNEE_P delay\n",
    .run = run_get,
};

const cli_command cmd_servo_set = {
    .name = "servo-set",
    COMMAND_ARGUMENTS("ID KEY VALUE", 3, 3, CLI_ARG_JOINT),
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
        "when it restarts.\n",
    .example = "  grctl servo-set 12 delay 2 --flash\n  grctl servo-set 1 id 21\n",
    COMMAND_OPTIONS(set_options),
    .run = run_set,
};
