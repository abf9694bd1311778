/* SPDX-License-Identifier: MIT */
/* The families whose frames can be decoded, by the names that users give them. */
#include <string.h>

#include "tools/grctl/decode/talk.h"

const grobo_words *talk_named(const char *name)
{
    for (const grobo_family *f = grobo_families(); f->robot; f++) {
        for (const grobo_words *const *words = f->words; *words; words++) {
            if (strcmp((*words)->name, name) == 0) {
                return *words;
            }
        }
    }
    return NULL;
}

static bool has(const grobo_robot_family *family, const grobo_servo_table *table)
{
    size_t i = 0;
    while (family->tables[i] && family->tables[i] != table) {
        i++;
    }
    return family->tables[i] != NULL;
}

const grobo_words *talk_of_servo(const grobo_servo_model *servo)
{
    const grobo_family *f = grobo_families();
    while (f->robot && !(servo && has(f->robot, grobo_servo_series(servo)))) {
        f++;
    }
    for (const grobo_words *const *words = f->robot ? f->words : NULL; words && *words; words++) {
        if ((*words)->table == grobo_servo_series(servo)) {
            return *words;
        }
    }
    return f->robot ? f->words[0] : NULL; /* its values are no registers */
}

const grobo_robot_family *talk_family(const grobo_words *words)
{
    for (const grobo_family *f = grobo_families(); f->robot; f++) {
        for (const grobo_words *const *its = f->words; *its; its++) {
            if (*its == words) {
                return f->robot;
            }
        }
    }
    return NULL;
}

const grobo_servo_model *talk_servo(const talk *t, int id)
{
    const grobo_servo_table *table = t->words->table;
    if (t->words->last_model) {
        return &table->models[table->model_count - 1];
    }
    const grobo_servo_model *known = id >= 0 && id < TALK_IDS ? t->servo[id] : NULL;
    return known ? known : &table->models[0];
}

const char *talk_joint(const talk *t, int id)
{
    int joint = t && t->model ? grobo_model_joint_of_motor(t->model, id) : -1;
    return joint < 0 ? NULL : grobo_model_joint(t->model, joint)->name;
}

void talk_ask(talk *t, const uint8_t *bytes, size_t n)
{
    if (n <= sizeof t->sent[0].bytes) {
        memmove(&t->sent[1], &t->sent[0], (GROBO_WORDS_SENT_MAX - 1) * sizeof t->sent[0]);
        memcpy(t->sent[0].bytes, bytes, n);
        t->sent[0].n = n;
    }
}

void talk_learn(talk *t, const grobo_telegram *said)
{
    for (size_t i = 0; said->reply && i < said->n_parts; i++) {
        const grobo_telegram_part *part = &said->part[i];
        const grobo_servo_register *reg =
            grobo_servo_register_of(&t->words->table->models[0], GROBO_ROLE_MODEL);
        if (reg && part->data && part->id >= 0 && part->id < TALK_IDS && part->address >= 0 &&
            part->address <= reg->address &&
            part->address + part->length >= reg->address + reg->bytes) {
            int32_t number = grobo_servo_register_get(&t->words->table->models[0], reg,
                                                      part->data + (reg->address - part->address));
            const grobo_servo_model *found =
                grobo_servo_model_numbered(t->words->table, (uint16_t)number);
            const grobo_servo_model *known = t->servo[part->id];
            bool same = known && known->number == number; /* several may have one number */
            t->servo[part->id] = found && !same ? found : known;
        }
    }
}
