/* SPDX-License-Identifier: MIT */
/* Register tables of any family: looked up, values taken from bytes and put into them. */
#include <grobo/registers.h>

static bool same_text(const char *a, const char *b)
{
    for (; *a != '\0' && *a == *b; a++, b++) {
    }
    return *a == *b;
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

const grobo_servo_register *grobo_servo_register_row(const grobo_servo_model *model, size_t index)
{
    for (size_t i = 0; model != NULL && i < model->table->register_count; i++) {
        const grobo_servo_register *reg = &model->table->registers[i];
        if ((reg->groups & model->group) != 0 && index-- == 0) {
            return reg;
        }
    }
    return NULL;
}

const grobo_servo_register *grobo_servo_register_named(const grobo_servo_model *model,
                                                       const char *name)
{
    const grobo_servo_register *reg = NULL;
    for (size_t i = 0; name != NULL && (reg = grobo_servo_register_row(model, i)) != NULL; i++) {
        if (same_text(reg->name, name)) {
            break;
        }
    }
    return reg;
}

const grobo_servo_register *grobo_servo_register_at(const grobo_servo_model *model,
                                                    uint16_t address)
{
    const grobo_servo_register *reg = NULL;
    for (size_t i = 0; (reg = grobo_servo_register_row(model, i)) != NULL; i++) {
        if (address >= reg->address && address < reg->address + reg->bytes) {
            break;
        }
    }
    return reg;
}

const grobo_servo_register *grobo_servo_register_of(const grobo_servo_model *model,
                                                    grobo_register_role role)
{
    const grobo_servo_register *reg = NULL;
    for (size_t i = 0; (reg = grobo_servo_register_row(model, i)) != NULL; i++) {
        if (reg->role == role && role != GROBO_ROLE_NONE) {
            break;
        }
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
    for (int i = 0; i < reg->bytes; i++) {
        raw |= (uint32_t)bytes[place(model, reg, i)] << 8 * i;
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
