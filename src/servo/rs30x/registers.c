/* SPDX-License-Identifier: MIT */
/* The memory map as a table, and its codes. A file of its own: firmware need not link it. */
#include <grobo/rs30x.h>

#include "src/base/bytes.h"

#define ROW(name, text, address, bytes, sign, access, unit, min, max, kept)                        \
    {text,                                                                                         \
     unit,                                                                                         \
     (min),                                                                                        \
     (max),                                                                                        \
     (address),                                                                                    \
     (bytes),                                                                                      \
     (sign) != 0,                                                                                  \
     GROBO_RS30X_ACCESS_##access,                                                                  \
     GROBO_RS30X_KEPT_##kept},

static const grobo_rs30x_register rows[] = {GROBO_RS30X_REGISTER_LIST(ROW)};

#undef ROW

#define NUMBER(name, text, address, bytes, sign, access, unit, min, max, kept) NUMBER_##name,
#define FIRST(name, text, address, bytes, sign, access, unit, min, max, kept)                      \
    [address] = NUMBER_##name + 1,

/* By the address of a register's first byte, its row + 1; 0: none begins there. */
enum { GROBO_RS30X_REGISTER_LIST(NUMBER) };
static const uint8_t row_from[UINT8_MAX + 1] = {GROBO_RS30X_REGISTER_LIST(FIRST)};

#undef NUMBER
#undef FIRST

static const int32_t bauds_bps[] = {9600,  14400,  19200,  28800,  38400, 57600,
                                    76800, 115200, 153600, 230400, 460800};

size_t grobo_rs30x_register_count(void)
{
    return sizeof rows / sizeof rows[0];
}

const grobo_rs30x_register *grobo_rs30x_register_row(size_t index)
{
    return index < grobo_rs30x_register_count() ? &rows[index] : NULL;
}

static bool same_text(const char *a, const char *b)
{
    for (; *a != '\0' && *a == *b; a++, b++) {
    }
    return *a == *b;
}

const grobo_rs30x_register *grobo_rs30x_register_named(const char *name)
{
    if (name == NULL) {
        return NULL;
    }
    for (size_t i = 0; i < grobo_rs30x_register_count(); i++) {
        if (same_text(rows[i].name, name)) {
            return &rows[i];
        }
    }
    return NULL;
}

const grobo_rs30x_register *grobo_rs30x_register_at(uint8_t address)
{
    int row = row_from[address];
    if (row == 0 && address > 0 && row_from[address - 1] != 0 &&
        rows[row_from[address - 1] - 1].bytes == 2) {
        row = row_from[address - 1];
    }
    return row > 0 ? &rows[row - 1] : NULL;
}

int32_t grobo_rs30x_register_get(const grobo_rs30x_register *reg, const uint8_t *bytes)
{
    if (reg == NULL || bytes == NULL) {
        return 0;
    }
    if (reg->bytes == 1) {
        return bytes[0];
    }
    return reg->is_signed ? grobo_i_get_i16(bytes) : grobo_i_get_u16(bytes);
}

int grobo_rs30x_register_put(const grobo_rs30x_register *reg, int32_t value, uint8_t *bytes)
{
    if (reg == NULL || bytes == NULL) {
        return GROBO_ERR_ARG;
    }
    if (value < reg->min || value > reg->max) {
        return GROBO_ERR_LIMIT;
    }
    if (reg->bytes == 1) {
        bytes[0] = (uint8_t)value;
    } else {
        grobo_i_put_u16(bytes, (uint16_t)value);
    }
    return reg->bytes;
}

const char *grobo_rs30x_model_name(uint16_t model)
{
    switch (model) {
    case GROBO_RS30X_RS301CR:
        return "RS301CR";
    case GROBO_RS30X_RS302CD:
        return "RS302CD";
    case GROBO_RS30X_RS303MR:
        return "RS303MR";
    case GROBO_RS30X_RS304MD:
        return "RS304MD";
    default:
        return NULL;
    }
}

int32_t grobo_rs30x_baud_bps(uint8_t code)
{
    return code <= GROBO_RS30X_BAUD_CODE_MAX ? bauds_bps[code] : GROBO_ERR_ARG;
}

int grobo_rs30x_baud_code(uint32_t baud_bps)
{
    for (int code = 0; code <= GROBO_RS30X_BAUD_CODE_MAX; code++) {
        if ((uint32_t)bauds_bps[code] == baud_bps) {
            return code;
        }
    }
    return GROBO_ERR_UNSUPPORTED;
}
