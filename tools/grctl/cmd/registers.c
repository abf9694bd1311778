/* SPDX-License-Identifier: MIT */
/* servo-get and servo-set: the registers of one servo, by name. */
#include <math.h>
#include <string.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/decode/registers.h"

enum { OPT_FLASH };

static const cli_option set_options[] = {
    [OPT_FLASH] = {.name = "flash",
                   .kind = CLI_FLAG,
                   .help = "keep it over power-off too; takes a second"},
};

static const grobo_rs30x_register *find_register(app *a, const char *name, int *status)
{
    const grobo_rs30x_register *reg = grobo_rs30x_register_named(name);
    char known[1024] = "";
    size_t at = 0;
    if (reg)
        return reg;
    for (size_t i = 0; (reg = grobo_rs30x_register_row(i)) != NULL; i++) {
        int n = snprintf(known + at, sizeof known - at, " %s", reg->name);
        at += n > 0 && (size_t)n < sizeof known - at ? (size_t)n : 0;
    }
    *status = app_fail(a, EXIT_USAGE, "NOTFOUND", "no register '%s'; there are:%s", name, known);
    return NULL;
}

/* The counts of the register, which servo-set takes, and what they mean. */
static void print_value(const grobo_rs30x_register *reg, int32_t value)
{
    char counts[REGISTERS_TEXT_BYTES], text[REGISTERS_TEXT_BYTES];
    snprintf(counts, sizeof counts, "%d", value);
    registers_text(reg, value, text, sizeof text);
    app_print("%3d  %-18s %6s", reg->address, reg->name, counts);
    if (strcmp(text, counts) != 0)
        app_print("  %12s", text);
    app_print("\n");
}

/* Beside the counts what they mean: under a key with its unit, or as a word. */
static json_t *value_json(const grobo_rs30x_register *reg, int32_t value)
{
    char key[REGISTERS_TEXT_BYTES];
    json_t *o = json_pack("{s:s,s:i,s:i,s:s}", "name", reg->name, "address", reg->address, "value",
                          value, "unit", reg->unit);
    json_t *meaning = registers_json(reg, value);
    registers_key(reg, key, sizeof key);
    if (strcmp(key, reg->name) != 0)
        json_object_set(o, key, meaning);
    else if (json_is_string(meaning))
        json_object_set(o, "word", meaning);
    json_decref(meaning);
    return o;
}

/* Reads the memory in the two halves that every model returns, No.0-59. */
static int read_all(conn *c, int id, uint8_t *memory)
{
    int error = servos_read(c, id, 0, 30, memory);
    return error ? error : servos_read(c, id, 30, 30, memory + 30);
}

static int get(conn *c, int id, const grobo_rs30x_register *only)
{
    uint8_t memory[GROBO_REGISTERS] = {0};
    const grobo_rs30x_register *reg;
    json_t *list = json_array();
    int error = only ? servos_read(c, id, only->address, only->bytes, memory + only->address)
                     : read_all(c, id, memory);
    if (error) {
        json_decref(list);
        return conn_fail_servo(c, error, id);
    }
    for (size_t i = 0; (reg = grobo_rs30x_register_row(i)) != NULL; i++) {
        int32_t value = grobo_rs30x_register_get(reg, memory + reg->address);
        if (only && reg != only)
            continue;
        if (c->a->json)
            json_array_append_new(list, value_json(reg, value));
        else
            print_value(reg, value);
    }
    if (c->a->json)
        app_print_json(json_pack("{s:i,s:O}", "id", id, "registers", list));
    json_decref(list);
    return EXIT_DONE;
}

static int run_get(app *a)
{
    conn c;
    int status = 0;
    const grobo_rs30x_register *only = NULL;
    int id = servos_parse_id(a, a->line.argument[0], &status);
    if (id < 0)
        return status;
    if (a->line.n_arguments > 1 && !(only = find_register(a, a->line.argument[1], &status)))
        return status;
    status = conn_open(&c, a);
    if (!status)
        status = get(&c, id, only);
    return conn_close(&c, status);
}

/* ---- servo-set ------------------------------------------------------------------------------ */

typedef struct change {
    int id;
    const grobo_rs30x_register *reg;
    int32_t value;
    bool flash;
} change;

/* "delay 1 (150 us) -> 2 (200 us)" */
static void change_text(const change *what, int32_t before, char *text, size_t capacity)
{
    char was[REGISTERS_TEXT_BYTES], is[REGISTERS_TEXT_BYTES];
    registers_text(what->reg, before, was, sizeof was);
    registers_text(what->reg, what->value, is, sizeof is);
    if (*what->reg->unit)
        snprintf(text, capacity, "%s %d (%s) -> %d (%s)", what->reg->name, before, was, what->value,
                 is);
    else
        snprintf(text, capacity, "%s %d -> %d", what->reg->name, before, what->value);
}

/* A rate that the line does not have. Only what it has can be asked through the board. */
static bool changes_rate(const conn *c, const change *what)
{
    return what->reg->address == GROBO_RS30X_BAUD &&
           grobo_rs30x_baud_bps((uint8_t)what->value) != (int32_t)conn_baud(c->a) &&
           app_global(c->a, GLOBAL_WIRING)->choice == GROBO_WIRING_BUS;
}

/* What is asked on a terminal before flash is written; true to go on. */
static bool confirmed(conn *c, const change *what, int32_t before)
{
    char answer[8], text[4 * REGISTERS_TEXT_BYTES];
    if (!what->flash)
        return true;
    change_text(what, before, text, sizeof text);
    app_note(c->a, "servo %d: %s, and No.4-29 go to flash%s: keep its power on", what->id, text,
             changes_rate(c, what) ? ", then it restarts" : "");
    if (app_global(c->a, GLOBAL_YES)->given || !c->a->tty_in)
        return true;
    output_complain("Write it? [y/N] ");
    return fgets(answer, sizeof answer, stdin) && (answer[0] == 'y' || answer[0] == 'Y');
}

static int write_it(conn *c, const change *what)
{
    uint8_t bytes[2] = {0};
    grobo_register_io io = {.id = (uint8_t)what->id,
                            .address = what->reg->address,
                            .length = what->reg->bytes,
                            .data = bytes};
    int id = what->reg->address == GROBO_RS30X_ID ? (int)what->value : what->id;
    int error;
    grobo_rs30x_register_put(what->reg, what->value, bytes);
    error = conn_wait(c, grobo_robot_registers(grobo_session_robot(c->session), &io));
    if (!error && what->flash)
        error = conn_wait(
            c, grobo_robot_command(grobo_session_robot(c->session), id, GROBO_SERVO_FLASH));
    return error;
}

/* baud_bps: where the servo answers after its rate was written, 0 where nothing is to be said. */
static void report(const conn *c, int id, const change *what, int32_t before, int baud_bps)
{
    char text[4 * REGISTERS_TEXT_BYTES], where[32] = "";
    const char *kept = what->flash ? ", kept in flash" : "; lost at power-off without --flash";
    change_text(what, before, text, sizeof text);
    if (baud_bps)
        snprintf(where, sizeof where, "; it answers at %d bps", baud_bps);
    if (baud_bps && !what->flash && baud_bps != grobo_rs30x_baud_bps((uint8_t)what->value))
        kept = "; takes effect at a restart, and is lost there without --flash";
    if (c->a->json) {
        json_t *o = json_pack("{s:i,s:s,s:i,s:i,s:b}", "id", id, "name", what->reg->name, "before",
                              before, "value", what->value, "flash", what->flash);
        if (baud_bps)
            json_object_set_new(o, "baud_bps", json_integer(baud_bps));
        app_print_json(o);
    } else {
        app_note(c->a, "servo %d: %s%s%s", id, text, kept, where);
    }
}

/* After these a goal means another angle: a servo that holds would go there at once. */
static bool changes_goal(const grobo_rs30x_register *reg)
{
    return reg->address == GROBO_RS30X_ID || reg->address == GROBO_RS30X_REVERSE ||
           reg->address == GROBO_RS30X_CW_LIMIT || reg->address == GROBO_RS30X_CCW_LIMIT;
}

/* Such a register is written to a servo without torque only. The engine refuses it to a joint too,
 * and to one that it has not read. */
static int expect_loose(conn *c, const change *what)
{
    int joint = grobo_model_joint_of_motor(grobo_robot_driver(c->robot)->model, what->id);
    uint8_t torque = GROBO_TORQUE_OFF;
    int error;
    bool restarts = what->flash && changes_rate(c, what);
    if (!changes_goal(what->reg) && !restarts)
        return EXIT_DONE;
    error = servos_read(c, what->id, GROBO_RS30X_TORQUE, 1, &torque);
    if (!error && joint >= 0)
        error = conn_wait(c, grobo_robot_sense(grobo_session_robot(c->session),
                                               GROBO_JOINT_BIT(joint), GROBO_SENSE_FULL));
    if (error)
        return conn_fail_servo(c, error, what->id);
    if (torque != GROBO_TORQUE_ON)
        return EXIT_DONE;
    return app_fail(c->a, EXIT_SAFETY, "STATE",
                    "servo-set: servo %d holds, and would %s with another %s; first: grctl servo "
                    "off m%d",
                    what->id, restarts ? "restart limp" : "jump", what->reg->name, what->id);
}

/* Two servos of one id answer together, and nobody could give one of them another. */
static int expect_free_id(conn *c, const change *what)
{
    uint8_t model[2];
    int error;
    if (what->reg->address != GROBO_RS30X_ID || what->value == what->id)
        return EXIT_DONE;
    error = servos_read(c, what->value, GROBO_RS30X_MODEL, sizeof model, model);
    if (error == GROBO_ERR_TIMEOUT)
        return EXIT_DONE;
    if (error)
        return conn_fail_servo(c, error, what->value);
    return app_fail(
        c->a, EXIT_SAFETY, "EXISTS",
        "servo-set: a servo with the id %d is there already; two of one id cannot be told "
        "apart; see 'grctl scan'",
        what->value);
}

/* ---- another baud rate: the servo is followed ------------------------------------------------ */

/* The line, and the wait for a reply, at another rate. */
static int tune(conn *c, int baud_bps)
{
    grobo_sim *sim = grobo_session_sim(c->session);
    int error = sim ? grobo_sim_set_line_bps(sim, (uint32_t)baud_bps)
                    : grobo_serial_set_baud(grobo_session_serial(c->session), baud_bps);
    return error < 0 ? error : servos_wait(c, baud_bps, 1, SERVOS_PATIENT_US, 0, NULL);
}

/* At which of two rates the servo answers, or an error. The line stays there. */
static int find_rate(conn *c, const change *what, int first_bps, int second_bps, uint8_t *code)
{
    const int rates_bps[] = {first_bps, second_bps};
    int error = GROBO_OK;
    for (int i = 0; i < 2; i++) {
        error = tune(c, rates_bps[i]);
        if (!error)
            error = servos_read(c, what->id, GROBO_RS30X_BAUD, 1, code);
        if (!error)
            return rates_bps[i];
        if (!conn_is_of_reply(error))
            break;
    }
    return error;
}

/* Writes the rate; with --flash keeps it and restarts the servo. Returns the rate at which it
 * answers then, and its register, or an error. */
static int move_rate(conn *c, const change *what, int old_bps, int new_bps, uint8_t *code)
{
    const change only = {.id = what->id, .reg = what->reg, .value = what->value};
    int at_bps, error = write_it(c, &only);
    if (error)
        return error;
    at_bps = find_rate(c, what, old_bps, new_bps, code);
    if (at_bps < 0 || *code != what->value || !what->flash)
        return at_bps;
    error = conn_wait(
        c, grobo_robot_command(grobo_session_robot(c->session), what->id, GROBO_SERVO_FLASH));
    if (!error)
        error = conn_wait(
            c, grobo_robot_command(grobo_session_robot(c->session), what->id, GROBO_SERVO_REBOOT));
    return error ? error : find_rate(c, what, new_bps, old_bps, code);
}

/*
 * Whether a servo changes its rate at once or when it restarts, no manual at hand says: it is
 * looked for at both.
 */
static int set_rate(conn *c, const change *what, int32_t before)
{
    int old_bps = (int)conn_baud(c->a), new_bps = grobo_rs30x_baud_bps((uint8_t)what->value);
    int at_bps, error;
    uint8_t code = 0;
    if (strncmp(conn_device(c), "tcp:", 4) == 0)
        return app_fail(c->a, EXIT_SAFETY, "UNSUPPORTED",
                        "servo-set: the rate of a line behind TCP is not set from here; a servo "
                        "with another one could not be reached");
    error = tune(c, new_bps); /* before anything is written: the line must know the rate */
    if (!error)
        error = tune(c, old_bps);
    if (error)
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error),
                        "servo-set: %s at %d bps: %s; nothing was written", conn_device(c), new_bps,
                        grobo_error_text(error));
    at_bps = move_rate(c, what, old_bps, new_bps, &code);
    error = tune(c, old_bps);
    if (conn_is_of_reply(at_bps))
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(at_bps),
                        "servo %d answers neither at %d nor at %d bps after writing; look for it "
                        "with 'grctl scan --all-baud'",
                        what->id, old_bps, new_bps);
    if (at_bps < 0 || error < 0)
        return conn_fail_servo(c, at_bps < 0 ? at_bps : error, what->id);
    if (code != what->value || (what->flash && at_bps != new_bps))
        return app_fail(c->a, EXIT_ROBOT, "MISMATCH",
                        "servo %d answers at %d bps, and its baud is %d, not %d, after writing%s",
                        what->id, at_bps, code, what->value, what->flash ? " and a restart" : "");
    report(c, what->id, what, before, at_bps);
    return EXIT_DONE;
}

static int set(conn *c, const change *what)
{
    uint8_t bytes[2] = {0};
    int32_t before;
    int id = what->reg->address == GROBO_RS30X_ID ? (int)what->value : what->id;
    int error = expect_loose(c, what);
    if (!error)
        error = expect_free_id(c, what);
    if (error)
        return error;
    error = servos_read(c, what->id, what->reg->address, what->reg->bytes, bytes);
    if (error)
        return conn_fail_servo(c, error, what->id);
    before = grobo_rs30x_register_get(what->reg, bytes);
    if (!confirmed(c, what, before))
        return app_fail(c->a, EXIT_USAGE, "CANCELED", "servo-set: nothing was written");
    if (changes_rate(c, what))
        return set_rate(c, what, before);
    error = write_it(c, what);
    if (!error)
        error = servos_read(c, id, what->reg->address, what->reg->bytes, bytes);
    if (error)
        return conn_fail_servo(c, error, id);
    if (grobo_rs30x_register_get(what->reg, bytes) != what->value)
        return app_fail(c->a, EXIT_ROBOT, "MISMATCH", "servo %d: %s is %d, not %d, after writing",
                        id, what->reg->name, grobo_rs30x_register_get(what->reg, bytes),
                        what->value);
    report(c, id, what, before, 0);
    return EXIT_DONE;
}

/* These go through the engine's gate only, by other commands. */
static bool moves_motor(const grobo_rs30x_register *reg)
{
    return reg->address == GROBO_RS30X_GOAL || reg->address == GROBO_RS30X_GOAL_TIME ||
           reg->address == GROBO_RS30X_TORQUE;
}

/* In counts of the register; a baud rate may be given as it is, too. */
static bool read_value(const grobo_rs30x_register *reg, const char *text, int32_t *counts)
{
    double value;
    if (!cli_read_number(text, &value))
        return false;
    for (uint8_t code = 0; reg->address == GROBO_RS30X_BAUD && code <= GROBO_RS30X_BAUD_CODE_MAX;
         code++)
        if (value == grobo_rs30x_baud_bps(code))
            value = code;
    if (value < reg->min || value > reg->max || value != floor(value))
        return false;
    *counts = (int32_t)value;
    return true;
}

static int parse_change(app *a, change *what)
{
    int status = 0;
    what->id = servos_parse_id(a, a->line.argument[0], &status);
    if (what->id < 0)
        return status;
    what->reg = find_register(a, a->line.argument[1], &status);
    if (!what->reg)
        return status;
    if (what->reg->access == GROBO_RS30X_ACCESS_R)
        return app_fail(a, EXIT_USAGE, "ARG", "servo-set: register %s is read only",
                        what->reg->name);
    if (moves_motor(what->reg))
        return app_fail(a, EXIT_SAFETY, "UNSUPPORTED",
                        "servo-set: %s moves the motor; use 'grctl %s'", what->reg->name,
                        what->reg->address == GROBO_RS30X_TORQUE ? "servo" : "move");
    if (!read_value(what->reg, a->line.argument[2], &what->value))
        return app_fail(a, EXIT_USAGE, "LIMIT", "servo-set: '%s': %s takes %d to %d (counts of %s)",
                        a->line.argument[2], what->reg->name, what->reg->min, what->reg->max,
                        *what->reg->unit ? what->reg->unit : "1");
    if (what->reg->kept == GROBO_RS30X_KEPT_RAM && app_option(a, OPT_FLASH)->given)
        return app_fail(a, EXIT_USAGE, "ARG", "servo-set: flash does not keep register %s",
                        what->reg->name);
    if (what->reg->address == GROBO_RS30X_BAUD && what->value != GROBO_RS30X_BAUD_CODE_DEFAULT &&
        app_global(a, GLOBAL_WIRING)->choice == GROBO_WIRING_BOARD)
        return app_fail(a, EXIT_SAFETY, "UNSUPPORTED",
                        "servo-set: the bus behind the board has %d bps; a servo with another "
                        "baud rate could not be reached",
                        GROBO_BAUD_DEFAULT_BPS);
    what->flash = app_option(a, OPT_FLASH)->given > 0;
    return 0;
}

static int run_set(app *a)
{
    conn c;
    change what = {0};
    int status = parse_change(a, &what);
    if (status)
        return status;
    status = conn_open(&c, a);
    if (!status)
        status = set(&c, &what);
    return conn_close(&c, status);
}

const cli_command cmd_servo_get = {
    .name = "servo-get",
    .arguments = "ID [KEY]",
    .summary = "read a servo's registers by name",
    .details =
        "Prints every register of a servo, or one: address, name, value as it is stored and\n"
        "what that means. ID is the servo's id or the name of a joint.\n",
    .example = "  grctl servo-get 12\n  grctl servo-get R_KNEE_P delay\n",
    .min_arguments = 1,
    .max_arguments = 2,
    .argument = CLI_ARG_JOINT,
    .run = run_get,
};

const cli_command cmd_servo_set = {
    .name = "servo-set",
    .arguments = "ID KEY VALUE",
    .summary = "write a servo's register by name",
    .details =
        "Writes one register and reads it back. The value is what the register stores (see\n"
        "servo-get); a baud rate may be given as it is. With --flash the servo also keeps\n"
        "its settings over power-off; that is shown first and, on a terminal, asked for.\n"
        "Goal and torque are refused: move and servo set them safely; id, reverse and limits\n"
        "are refused while the servo holds, an id that another servo has, and through the board\n"
        "a baud rate other than 115200.\n"
        "\n"
        "On a bus a new baud rate is written at the old one. With --flash the servo keeps it and\n"
        "restarts, the command follows it to the new rate and verifies that it answers there;\n"
        "-b then reaches it. Without --flash the servo goes on at the old rate and forgets the\n"
        "new one when it restarts.\n",
    .example = "  grctl servo-set 12 delay 2 --flash\n  grctl servo-set 1 id 21\n",
    .options = set_options,
    .n_options = sizeof set_options / sizeof set_options[0],
    .min_arguments = 3,
    .max_arguments = 3,
    .argument = CLI_ARG_JOINT,
    .run = run_set,
};
