/* SPDX-License-Identifier: MIT */
/* Builders of RS30x packets. */
#include <string.h>

#include "src/base/bytes.h"
#include "src/servo/rs30x/packet.h"

enum {
    POS_MAX_DDEG = 1500,
    TIME_MAX_CS = 16383,
    GOAL_BYTES = 4 /* position, time */
};

static int build_byte(uint8_t byte, uint8_t *buf, size_t cap)
{
    if (cap < 1) {
        return GROBO_ERR_SPACE;
    }
    buf[0] = byte;
    return 1;
}

/* A kind says which ids it may have; the form alone would take a LONG's id for a SHORT too. */
static bool id_fits_kind(const grobo_rs30x_packet *packet)
{
    return (packet->kind == GROBO_RS30X_LONG) == (packet->id == 0);
}

static bool data_fits(const uint8_t *header, const grobo_rs30x_packet *packet)
{
    if (packet->data_bytes == 1 && grobo_i_rs30x_is_reset(header)) {
        return packet->data[0] == 0xFF;
    }
    return grobo_i_rs30x_announced(header) == (int)packet->data_bytes;
}

int grobo_rs30x_build(const grobo_rs30x_packet *packet, uint8_t *buf, size_t cap)
{
    if (packet == NULL || buf == NULL) {
        return GROBO_ERR_ARG;
    }
    if (packet->kind == GROBO_RS30X_ACK_BYTE || packet->kind == GROBO_RS30X_NACK_BYTE) {
        bool ack = packet->kind == GROBO_RS30X_ACK_BYTE;
        return build_byte(ack ? GROBO_RS30X_ACK : GROBO_RS30X_NACK, buf, cap);
    }
    bool is_return = packet->kind == GROBO_RS30X_RETURN;
    const uint8_t header[GROBO_I_AT_DATA] = {
        is_return ? 0xFD : 0xFA, is_return ? 0xDF : 0xAF, packet->id,   packet->flags,
        packet->address,         packet->length,          packet->count};
    size_t size = packet->data_bytes + GROBO_RS30X_OVERHEAD_BYTES;
    if (size > GROBO_RS30X_PACKET_MAX_BYTES) {
        return GROBO_ERR_CAP;
    }
    if (!id_fits_kind(packet) || !data_fits(header, packet)) {
        return GROBO_ERR_ARG;
    }
    if (size > cap) {
        return GROBO_ERR_SPACE;
    }
    if (packet->data_bytes > 0) {
        memmove(buf + GROBO_I_AT_DATA, packet->data, packet->data_bytes);
    }
    memcpy(buf, header, sizeof header);
    buf[size - 1] = grobo_i_xor(buf + GROBO_I_AT_ID, size - GROBO_I_AT_ID - 1);
    return (int)size;
}

/* A short packet without data. */
static int build_bare(const uint8_t *fields, uint8_t *buf, size_t cap)
{
    grobo_rs30x_packet packet = {GROBO_RS30X_SHORT, fields[0], fields[1], fields[2],
                                 fields[3],         fields[4], NULL,      0};
    return grobo_rs30x_build(&packet, buf, cap);
}

int grobo_rs30x_read(uint8_t id, uint8_t address, uint8_t length, uint8_t *buf, size_t cap)
{
    if (length == 0 || address + length > GROBO_REGISTERS) {
        return GROBO_ERR_ARG;
    }
    const uint8_t fields[] = {id, GROBO_RS30X_WANT_GIVEN, address, length, 0};
    return build_bare(fields, buf, cap);
}

int grobo_rs30x_read_block(uint8_t id, grobo_rs30x_want want, uint8_t *buf, size_t cap)
{
    if (want < GROBO_RS30X_WANT_0_29 || want > GROBO_RS30X_WANT_60_127 || (want & 1) == 0) {
        return GROBO_ERR_ARG;
    }
    const uint8_t fields[] = {id, (uint8_t)want, 0, 0, 1};
    return build_bare(fields, buf, cap);
}

int grobo_rs30x_control(uint8_t id, uint8_t flags, uint8_t *buf, size_t cap)
{
    uint8_t known = GROBO_RS30X_FLASH | GROBO_RS30X_REBOOT;
    if (flags == 0 || (flags & ~known) != 0) {
        return GROBO_ERR_ARG;
    }
    const uint8_t fields[] = {id, flags, 0xFF, 0, 0};
    return build_bare(fields, buf, cap);
}

int grobo_rs30x_ping(uint8_t id, grobo_rs30x_ping_form form, uint8_t *buf, size_t cap)
{
    uint8_t fields[] = {id, GROBO_RS30X_WANT_ACK, 0xFF, 0, 0};
    switch (form) {
    case GROBO_RS30X_PING_FF_0_0:
        break;
    case GROBO_RS30X_PING_0_0_0:
        fields[2] = 0;
        break;
    case GROBO_RS30X_PING_FF_1_0:
        fields[3] = 1;
        break;
    }
    return build_bare(fields, buf, cap);
}

/* A short packet with data. */
static int build_write(const uint8_t *target, const uint8_t *data, size_t n, uint8_t *buf,
                       size_t cap)
{
    grobo_rs30x_packet packet = {GROBO_RS30X_SHORT, target[0], target[1], target[2],
                                 (uint8_t)n,        1,         data,      n};
    if (packet.address + n > GROBO_REGISTERS) {
        return GROBO_ERR_ARG;
    }
    return grobo_rs30x_build(&packet, buf, cap);
}

int grobo_rs30x_write_u8(uint8_t id, uint8_t flags, uint8_t address, uint8_t value, uint8_t *buf,
                         size_t cap)
{
    const uint8_t target[] = {id, flags, address};
    return build_write(target, &value, 1, buf, cap);
}

int grobo_rs30x_write_u16(uint8_t id, uint8_t flags, uint8_t address, uint16_t value, uint8_t *buf,
                          size_t cap)
{
    const uint8_t target[] = {id, flags, address};
    uint8_t data[2];
    grobo_i_put_u16(data, value);
    return build_write(target, data, sizeof data, buf, cap);
}

int grobo_rs30x_factory_reset(uint8_t id, grobo_rs30x_reset_form form, uint8_t *buf, size_t cap)
{
    static const uint8_t data = 0xFF;
    size_t n = form == GROBO_RS30X_RESET_BARE ? 0 : 1;
    grobo_rs30x_packet packet = {
        GROBO_RS30X_SHORT, id, GROBO_RS30X_FACTORY, 0xFF, 0xFF, 0, &data, n};
    return grobo_rs30x_build(&packet, buf, cap);
}

static int put_goal(const grobo_rs30x_goal *goal, uint8_t *at)
{
    if (goal->pos_ddeg < -POS_MAX_DDEG || goal->pos_ddeg > POS_MAX_DDEG ||
        goal->time_cs > TIME_MAX_CS) {
        return GROBO_ERR_LIMIT;
    }
    grobo_i_put_i16(at, goal->pos_ddeg);
    grobo_i_put_u16(at + 2, goal->time_cs);
    return GROBO_OK;
}

int grobo_rs30x_write_goal(const grobo_rs30x_goal *goal, uint8_t *buf, size_t cap)
{
    if (goal == NULL) {
        return GROBO_ERR_ARG;
    }
    const uint8_t target[] = {goal->id, 0, GROBO_RS30X_GOAL};
    uint8_t data[GOAL_BYTES];
    int result = put_goal(goal, data);
    return result < 0 ? result : build_write(target, data, sizeof data, buf, cap);
}

/* Room for a long packet: n servos with so many bytes each, id included. */
static int check_long(size_t n, size_t each, size_t cap)
{
    if (n == 0) {
        return GROBO_ERR_ARG;
    }
    if (n > (GROBO_RS30X_PACKET_MAX_BYTES - GROBO_RS30X_OVERHEAD_BYTES) / each) {
        return GROBO_ERR_CAP;
    }
    return n * each + GROBO_RS30X_OVERHEAD_BYTES <= cap ? GROBO_OK : GROBO_ERR_SPACE;
}

static bool is_servo(uint8_t id)
{
    return id >= 1 && id <= GROBO_RS30X_ID_MAX;
}

/* Completes a long packet whose data lies in place. */
static int finish_long(uint8_t address, size_t each, size_t n, uint8_t *buf, size_t cap)
{
    for (size_t i = 0; i < n; i++) {
        if (!is_servo(buf[GROBO_I_AT_DATA + i * each])) {
            return GROBO_ERR_ARG;
        }
    }
    grobo_rs30x_packet packet = {
        GROBO_RS30X_LONG,      0,       0, address, (uint8_t)each, (uint8_t)n,
        buf + GROBO_I_AT_DATA, n * each};
    return grobo_rs30x_build(&packet, buf, cap);
}

int grobo_rs30x_write_goals(const grobo_rs30x_goal *goals, size_t n, uint8_t *buf, size_t cap)
{
    if ((goals == NULL && n > 0) || buf == NULL) {
        return GROBO_ERR_ARG;
    }
    const size_t each = 1 + GOAL_BYTES;
    int result = check_long(n, each, cap);
    for (size_t i = 0; i < n && result >= 0; i++) {
        uint8_t *at = buf + GROBO_I_AT_DATA + i * each;
        at[0] = goals[i].id;
        result = put_goal(&goals[i], at + 1);
    }
    return result < 0 ? result : finish_long(GROBO_RS30X_GOAL, each, n, buf, cap);
}

int grobo_rs30x_write_bytes(uint8_t address, const grobo_rs30x_byte *bytes, size_t n, uint8_t *buf,
                            size_t cap)
{
    if (buf == NULL || (bytes == NULL && n > 0) || address >= GROBO_REGISTERS) {
        return GROBO_ERR_ARG;
    }
    const size_t each = 2;
    int result = check_long(n, each, cap);
    for (size_t i = 0; i < n && result >= 0; i++) {
        uint8_t *at = buf + GROBO_I_AT_DATA + i * each;
        at[0] = bytes[i].id;
        at[1] = bytes[i].value;
    }
    return result < 0 ? result : finish_long(address, each, n, buf, cap);
}
