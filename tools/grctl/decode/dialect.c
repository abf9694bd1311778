/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/decode/dialect.h"

const grobo_servo_model *talk_servo(const talk *t, int id)
{
    const grobo_servo_model *known = id >= 0 && id < DIALECT_IDS ? t->servo[id] : NULL;
    if (known || !t->dialect->table) {
        return known;
    }
    return &t->dialect->table->models[0];
}

const char *talk_joint(const talk *t, int id)
{
    int joint = t && t->model ? grobo_model_joint_of_motor(t->model, id) : -1;
    return joint < 0 ? NULL : t->model->joints[joint].name;
}

void talk_ask(talk *t, const uint8_t *bytes, size_t n)
{
    if (n <= sizeof t->sent[0].bytes) {
        memmove(&t->sent[1], &t->sent[0], (DIALECT_SENT_MAX - 1) * sizeof t->sent[0]);
        memcpy(t->sent[0].bytes, bytes, n);
        t->sent[0].n = n;
    }
}

void talk_learn(talk *t, const telegram *said)
{
    for (size_t i = 0; said->reply && t->dialect->table && i < said->n_parts; i++) {
        const telegram_part *part = &said->part[i];
        const grobo_servo_register *reg =
            grobo_servo_register_of(&t->dialect->table->models[0], GROBO_ROLE_MODEL);
        if (reg && part->data && part->id >= 0 && part->id < DIALECT_IDS && part->address >= 0 &&
            part->address <= reg->address &&
            part->address + part->length >= reg->address + reg->bytes) {
            int32_t number = grobo_servo_register_get(&t->dialect->table->models[0], reg,
                                                      part->data + (reg->address - part->address));
            const grobo_servo_model *found =
                grobo_servo_model_numbered(t->dialect->table, (uint16_t)number);
            t->servo[part->id] = found ? found : t->servo[part->id];
        }
    }
}

void dialect_sum(const uint8_t *bytes, size_t n, telegram *to)
{
    unsigned sum = 0;
    for (size_t i = 2; i + 1 < n; i++) {
        sum += bytes[i];
    }
    to->sum_bytes = 1;
    to->sum = bytes[n - 1];
    to->right_sum = ~sum & 0xFF;
}

const sent_frame *dialect_asked(const dialect *d, const dialect_look *look, size_t size)
{
    for (int i = 0; i < DIALECT_SENT_MAX && look->sent; i++) {
        if (look->sent[i].n > 0 && d->answers(&look->sent[i], look->bytes, size)) {
            return &look->sent[i];
        }
    }
    return NULL;
}

int dialect_echo(const dialect_look *look)
{
    int open = -1;
    for (int i = 0; i < DIALECT_SENT_MAX && look->sent; i++) {
        const sent_frame *sent = &look->sent[i];
        size_t n = look->n < sent->n ? look->n : sent->n;
        if (sent->n == 0 || memcmp(sent->bytes, look->bytes, n) != 0) {
            continue;
        }
        if (n == sent->n) {
            return (int)n;
        }
        open = 0;
    }
    return open;
}
