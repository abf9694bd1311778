/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/core/ics.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/conn/wire.h"

/* Behind a network a reply may take as long as it likes. */
enum { TCP_MARGIN_US = 50000 };

int servos_read(conn *c, int id, int address, int length, uint8_t *data)
{
    grobo_register_io io = {
        .id = (uint8_t)id, .address = (uint16_t)address, .length = (uint16_t)length};
    c->data = data;
    c->data_bytes = (size_t)length;
    int error = conn_wait(c, grobo_robot_registers(c->robot, &io));
    c->data = NULL; /* it is the caller's */
    return error;
}

int servos_get(conn *c, int id, const grobo_servo_model *servo, const grobo_servo_register *reg,
               int32_t *value)
{
    uint8_t bytes[FAMILY_PIECE_BYTES] = {0};
    uint16_t from = 0;
    int length = family_piece(grobo_robot_driver(c->robot), servo, reg, &from);
    int error = length ? servos_read(c, id, from, length, bytes) : GROBO_ERR_UNSUPPORTED;
    if (!error) {
        *value = grobo_servo_register_get(servo, reg, bytes + (reg->address - from));
    }
    return error;
}

/* No command reads the torque of a KRS, of which its flags tell. */
int servos_torque(conn *c, int id, const grobo_servo_model *servo, int32_t *torque)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servo, GROBO_ROLE_TORQUE);
    bool by_flags = grobo_servo_series(servo) == grobo_ics_table();
    int32_t value = 0;
    reg = by_flags ? grobo_servo_register_named(servo, "flags") : reg;
    int error = reg ? servos_get(c, id, servo, reg, &value) : GROBO_ERR_UNSUPPORTED;
    if (!error) {
        *torque = !by_flags                       ? value
                  : (value & GROBO_ICS_FLAG_FREE) ? GROBO_TORQUE_OFF
                                                  : GROBO_TORQUE_ON;
    }
    return error;
}

/* RS30x return at most so much, and the board's line is shared. */
enum { RS30X_BLOCK_BYTES = 30 };

/* Bytes that one frame reads. */
typedef struct run {
    uint16_t from;
    int length; /* 0: row can be written only */
} run;

/* As many registers as one frame reads from number `first` on, of which the last is wanted; where
 * none can begin there, the piece that holds it. */
static run run_of(const conn *c, const grobo_servo_model *servo, size_t first,
                  const servos_visit *visit)
{
    const grobo_driver *driver = grobo_robot_driver(c->robot);
    const grobo_servo_register *begin = grobo_servo_register_row(servo, first), *end = begin;
    int most = family_is(driver, "rs30x") ? RS30X_BLOCK_BYTES : FAMILY_PIECE_BYTES;
    run r = {begin->address, 0};
    for (int n = family_block(driver, servo, first, most); n > 0; n--) {
        end = grobo_servo_register_row(servo, first + (size_t)n - 1);
        if (visit->wants(end)) {
            break;
        }
    }
    /* The last may be told only with what is behind it. */
    int n = family_block(driver, servo, first, end->address + end->bytes - begin->address);
    if (n == 0) {
        r.length = family_piece(driver, servo, begin, &r.from);
    } else {
        end = grobo_servo_register_row(servo, first + (size_t)n - 1);
        r.length = end->address + end->bytes - begin->address;
    }
    return r;
}

int servos_each(conn *c, int id, const grobo_servo_model *servo, const servos_visit *visit)
{
    const grobo_servo_register *reg;
    uint8_t bytes[FAMILY_PIECE_BYTES] = {0};
    run have = {0, 0};
    int error = GROBO_OK;
    for (size_t i = 0; !error && (reg = grobo_servo_register_row(servo, i)) != NULL; i++) {
        if (!visit->wants(reg)) {
            continue;
        }
        if (reg->address + reg->bytes > have.from + have.length) {
            have = run_of(c, servo, i, visit);
            error = have.length > 0 ? servos_read(c, id, have.from, have.length, bytes) : GROBO_OK;
        }
        if (!error && have.length > 0) {
            visit->take(visit->ctx, reg,
                        grobo_servo_register_get(servo, reg, bytes + (reg->address - have.from)));
        }
    }
    return error;
}

/* A servo may be set up to answer nothing but what is read: what it has tells. */
static int look_after(conn *c, const grobo_register_io *io)
{
    uint8_t is[FAMILY_PIECE_BYTES];
    int error = servos_read(c, io->id, io->address, io->length, is);
    return !error && memcmp(is, io->data, io->length) != 0 ? GROBO_ERR_TIMEOUT : error;
}

int servos_put(conn *c, int id, const grobo_servo_model *servo, const grobo_servo_register *reg,
               int32_t value)
{
    uint8_t bytes[FAMILY_PIECE_BYTES] = {0};
    uint16_t from = reg->address;
    int length = family_piece(grobo_robot_driver(c->robot), servo, reg, &from);
    int error = length > reg->bytes ? servos_read(c, id, from, length, bytes) : GROBO_OK;
    if (!error) {
        error = grobo_servo_register_put(servo, reg, value, bytes + (reg->address - from));
    }
    if (error < 0) {
        return error;
    }
    grobo_register_io io = {.id = (uint8_t)id,
                            .address = from,
                            .length = (uint16_t)(length ? length : reg->bytes),
                            .data = bytes};
    error = conn_wait(c, grobo_robot_registers(c->robot, &io));
    return error == GROBO_ERR_TIMEOUT ? look_after(c, &io) : error;
}

int servos_model(conn *c, int id, const grobo_servo_model **servo)
{
    const grobo_driver *driver = grobo_robot_driver(c->robot);
    const grobo_servo_register *reg;
    uint8_t bytes[4];
    *servo = family_servo(driver, id);
    reg = grobo_servo_register_of(*servo, GROBO_ROLE_MODEL);
    if (!reg || grobo_model_joint_of_motor(driver->model, id) >= 0) {
        return GROBO_OK;
    }
    int error = servos_read(c, id, reg->address, reg->bytes, bytes);
    const grobo_servo_model *found = error ? NULL : family_identify(driver, bytes);
    if (!error && !found && family_is_any(*servo)) {
        app_note(c->a, "servo %d: unknown model %d; as %s, what all of its series have", id,
                 (int)grobo_servo_register_get(*servo, reg, bytes), (*servo)->name);
    }
    *servo = found ? found : *servo;
    return error;
}

int servos_wait(conn *c, int baud_bps, int length, uint32_t margin_us, int retries,
                uint32_t *timeout_us)
{
    bool remote = strncmp(conn_device(c), "tcp:", 4) == 0;
    grobo_robot_config config = conn_robot_config(c->a);
    uint32_t wire_us;
    int error = wire_read_us(grobo_robot_driver(c->robot), baud_bps, length, &wire_us);
    if (error) {
        return error;
    }
    if (!config.retries) {
        config.retries = retries;
    }
    if (!config.timeout_us) {
        config.timeout_us = wire_us + (remote ? TCP_MARGIN_US : margin_us);
    }
    if (timeout_us) {
        *timeout_us = config.timeout_us;
    }
    return grobo_robot_configure(c->robot, &config);
}

int servos_parse_id(app *a, const char *text, int *status)
{
    double number;
    if (cli_read_number(text, &number)) {
        const grobo_protocol *protocol = app_driver(a)->protocol;
        if (number >= protocol->id_min && number <= protocol->id_max &&
            number == (double)(int)number) {
            return (int)number;
        }
        *status = app_fail(a, EXIT_USAGE, "ARG", "'%s' is not an id from %d to %d", text,
                           protocol->id_min, protocol->id_max);
        return -1;
    }
    int joint = joints_parse_one(a, text, strlen(text), status);
    return joint < 0 ? -1 : grobo_model_motor_of_joint(app_model(a), joint);
}
