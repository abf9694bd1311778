/* SPDX-License-Identifier: MIT */
/* Register tables of any family: looked up, values taken from bytes and put into them. */
#include <grobo/core/registers.h>

enum { BYTES_MAX = 4 };

static bool same_text(const char *a, const char *b)
{
    for (; *a != '\0' && *a == *b; a++, b++) {
    }
    return *a == *b;
}

const grobo_servo_table *grobo_servo_series(const grobo_servo_model *model)
{
    return model == NULL                  ? NULL
           : model->table->series != NULL ? model->table->series
                                          : model->table;
}

const grobo_servo_model *grobo_servo_model_named(const grobo_servo_table *table, const char *name)
{
    for (int i = 0; table != NULL && name != NULL && i < table->model_count; i++) {
        if (same_text(table->models[i].name, name)) {
            return &table->models[i];
        }
    }
    return NULL;
}

const grobo_servo_model *grobo_servo_model_numbered(const grobo_servo_table *table, uint16_t number)
{
    for (int i = 0; table != NULL && i < table->model_count; i++) {
        if (table->models[i].number == number) {
            return &table->models[i];
        }
    }
    return NULL;
}

/* Whether a model is in a set of its table. */
static bool is_in(const grobo_servo_model *model, uint8_t set)
{
    return (model->table->sets[set] >> (model - model->table->models) & 1) != 0;
}

/* The next register of the model behind one (NULL: its first); NULL behind the last. */
static const grobo_servo_register *next(const grobo_servo_model *model,
                                        const grobo_servo_register *reg)
{
    if (model == NULL) {
        return NULL;
    }
    const grobo_servo_register *end = model->table->registers + model->table->register_count;
    for (reg = reg == NULL ? model->table->registers : reg + 1; reg < end; reg++) {
        if (is_in(model, reg->set)) {
            return reg;
        }
    }
    return NULL;
}

const grobo_servo_register *grobo_servo_register_row(const grobo_servo_model *model, size_t index)
{
    const grobo_servo_register *reg = next(model, NULL);
    for (; reg != NULL && index > 0; index--) {
        reg = next(model, reg);
    }
    return reg;
}

const grobo_servo_register *grobo_servo_register_named(const grobo_servo_model *model,
                                                       const char *name)
{
    const grobo_servo_register *reg = name == NULL ? NULL : next(model, NULL);
    while (reg != NULL && !same_text(reg->name, name)) {
        reg = next(model, reg);
    }
    return reg;
}

/* Of a model no two registers share a byte, so that whichever row holds it is the one. */
const grobo_servo_register *grobo_servo_register_at(const grobo_servo_model *model,
                                                    uint16_t address)
{
    if (model == NULL) {
        return NULL;
    }
    const grobo_servo_register *rows = model->table->registers;
    size_t low = 0, high = model->table->register_count;
    while (low < high) { /* rows before low begin at the address or before it */
        size_t middle = low + (high - low) / 2;
        if (rows[middle].address <= address) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    for (; low > 0 && address < rows[low - 1].address + BYTES_MAX; low--) {
        const grobo_servo_register *reg = &rows[low - 1];
        if (is_in(model, reg->set) && address < reg->address + reg->bytes) {
            return reg;
        }
    }
    return NULL;
}

const grobo_servo_register *grobo_servo_register_of(const grobo_servo_model *model,
                                                    grobo_register_role role)
{
    const grobo_servo_register *reg = role == GROBO_ROLE_NONE ? NULL : next(model, NULL);
    while (reg != NULL && reg->role != role) {
        reg = next(model, reg);
    }
    return reg;
}

/* Where byte i, counted from the lowest, stands. */
static int place(const grobo_servo_model *model, const grobo_servo_register *reg, int i)
{
    return model->table->big_endian ? reg->bytes - 1 - i : i;
}

static int32_t with_sign(uint32_t raw, const grobo_servo_register *reg)
{
    if (reg->sign == GROBO_SIGN_NONE) {
        return (int32_t)(raw & INT32_MAX);
    }
    if (reg->sign == GROBO_SIGN_TWOS) {
        uint32_t sign = (uint32_t)1 << (reg->bytes * 8 - 1);
        return (raw & sign) != 0 ? -1 - (int32_t)(~raw & (sign - 1)) : (int32_t)raw;
    }
    uint32_t sign = (uint32_t)1 << reg->sign;
    int32_t magnitude = (int32_t)(raw & (sign - 1));
    return (raw & sign) != 0 ? -magnitude : magnitude;
}

int32_t grobo_servo_register_get(const grobo_servo_model *model, const grobo_servo_register *reg,
                                 const uint8_t *bytes)
{
    if (model == NULL || reg == NULL || bytes == NULL) {
        return 0;
    }
    uint32_t raw = 0;
    if (model->table->big_endian) {
        for (int i = 0; i < reg->bytes; i++) {
            raw = raw << 8 | bytes[i];
        }
    } else {
        for (int i = reg->bytes; i > 0; i--) {
            raw = raw << 8 | bytes[i - 1];
        }
    }
    return with_sign(raw, reg);
}

int grobo_servo_register_put(const grobo_servo_model *model, const grobo_servo_register *reg,
                             int32_t value, uint8_t *bytes)
{
    if (model == NULL || reg == NULL || bytes == NULL) {
        return GROBO_ERR_ARG;
    }
    if (value < reg->min || value > reg->max) {
        return GROBO_ERR_LIMIT;
    }
    uint32_t raw = (uint32_t)value;
    if (reg->sign > GROBO_SIGN_TWOS && value < 0) {
        raw = ((uint32_t)1 << reg->sign) | (uint32_t)-value;
    }
    for (int i = 0; i < reg->bytes; i++) {
        bytes[place(model, reg, i)] = (uint8_t)(raw >> 8 * i & 0xFF);
    }
    return reg->bytes;
}

int32_t grobo_servo_baud_bps(const grobo_servo_model *model, int32_t code)
{
    for (int i = 0; model != NULL && i < model->table->rate_count; i++) {
        const grobo_servo_rate *rate = &model->table->rates[i];
        if (rate->code == code && is_in(model, rate->set)) {
            return rate->bps;
        }
    }
    return GROBO_ERR_ARG;
}

int grobo_servo_baud_code(const grobo_servo_model *model, int32_t baud_bps)
{
    if (model == NULL) {
        return GROBO_ERR_ARG;
    }
    for (int i = 0; i < model->table->rate_count; i++) {
        const grobo_servo_rate *rate = &model->table->rates[i];
        if (rate->bps == baud_bps && is_in(model, rate->set)) {
            return rate->code;
        }
    }
    return GROBO_ERR_UNSUPPORTED;
}
