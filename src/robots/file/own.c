/* SPDX-License-Identifier: MIT */
/*
 * A user's own servo model. Driver and simulated servo of a series are made for its registers, so a
 * file may change what a model is (name, number, scale, speed, torque, current, voltage, firmware,
 * rates, ranges, defaults) and add registers that only their names reach. It may not move, drop or
 * redefine what the series has.
 */
#include <stdio.h>
#include <string.h>

#include <grobo/core/sim_static.h>

#include "src/base/memory.h"
#include "src/motion/text/nearest.h"
#include "src/robots/file/families.h"
#include "src/robots/file/own.h"
#include "src/robots/file/servo.h"

enum { BUFFER_BYTES = 16 * 1024, PATH_BYTES = 4096 };

struct grobo_i_own_servo {
    grobo_i_own_servo *next;
    grobo_i_name servo; /* as the robot's file names it */
    bool good;
    const grobo_servo_model *like;
    const grobo_robot_family *family;
    uint64_t all; /* the one set of models */
    grobo_servo_table table;
    grobo_servo_register registers[GROBO_I_SERVO_ROWS];
    grobo_i_servo_draft draft;
};

bool grobo_i_is_own_servo(const char *servo)
{
    return strncmp(servo, "./", 2) == 0;
}

/* ---- like ------------------------------------------------------------------------------------ */

static int take_like(grobo_i_servo_draft *draft, grobo_i_reader *reader, const char *name,
                     grobo_i_place place)
{
    grobo_i_own_servo *own = draft->ctx;
    grobo_i_nearest nearest = {NULL, 0};
    const grobo_servo_model *model;
    if (own->like != NULL) {
        return grobo_i_refuse(reader, GROBO_ERR_SYNTAX, "like", place, "like: given twice");
    }
    for (size_t i = 0; (model = grobo_i_family_row(own->family, i)) != NULL; i++) {
        if (strcmp(model->name, name) == 0) {
            own->like = model;
            draft->place = place;
            draft->no_joint = (model->flags & GROBO_MODEL_NO_JOINT) != 0;
            grobo_i_servo_copy(draft, model);
            return 0;
        }
        grobo_i_nearest_try(&nearest, name, model->name);
    }
    char what[96];
    snprintf(what, sizeof what, "servo of family %s called", own->family->name);
    (void)grobo_i_complain_word(reader, place, what, name,
                                nearest.word != NULL ? nearest.word : "");
    return GROBO_ERR_SYNTAX; /* nothing below can be judged */
}

/* ---- what may differ ------------------------------------------------------------------------- */

static const grobo_i_servo_row *row_named(const grobo_i_servo_draft *draft, const char *name)
{
    for (int i = 0; i < draft->n_rows; i++) {
        if (strcmp(draft->rows[i].name, name) == 0) {
            return &draft->rows[i];
        }
    }
    return NULL;
}

static bool same_place(const grobo_servo_register *a, const grobo_i_servo_row *row)
{
    const grobo_servo_register *b = &row->reg;
    return a->address == b->address && a->bytes == b->bytes && a->sign == b->sign &&
           a->role == b->role && a->flags == b->flags && strcmp(a->unit, row->unit) == 0;
}

/* Registers of the series: each is there, and means the same. */
static void check_series(grobo_i_reader *reader, const grobo_i_own_servo *own)
{
    const grobo_servo_register *reg;
    for (size_t i = 0; (reg = grobo_servo_register_row(own->like, i)) != NULL; i++) {
        const grobo_i_servo_row *row = row_named(&own->draft, reg->name);
        if (row == NULL) {
            (void)grobo_i_complain(reader, GROBO_ERR_SYNTAX, "register", own->draft.place,
                                   "register %s: %s has it, so this model must have it too",
                                   reg->name, own->like->name);
        } else if (!same_place(reg, row)) {
            (void)grobo_i_complain(reader, GROBO_ERR_SYNTAX, "register", row->place,
                                   "register %s: only its range and default may differ from %s's",
                                   reg->name, own->like->name);
        }
    }
}

/* Registers of the file alone. */
static void check_added(grobo_i_reader *reader, const grobo_i_own_servo *own)
{
    for (int i = 0; i < own->draft.n_rows; i++) {
        const grobo_i_servo_row *row = &own->draft.rows[i];
        const char *wrong = NULL;
        bool kept = (row->reg.flags & GROBO_REGISTER_KEPT) != 0;
        int end = kept ? GROBO_SIM_KEPT_BYTES : GROBO_SIM_REGISTER_BYTES;
        if (grobo_servo_register_named(own->like, row->name) != NULL) {
            bool writable = (row->reg.flags & GROBO_REGISTER_W) != 0;
            bool none = writable && row->reg.role != GROBO_ROLE_NONE && row->reg.max < 1;
            wrong = none ? "its range must reach 1" : NULL;
        } else if (own->family->fixed) {
            wrong = "servos of this family have no registers of their own";
        } else if (row->reg.role != GROBO_ROLE_NONE) {
            wrong = "a register that the series does not have can have no role";
        } else if (row->reg.address + row->reg.bytes > end) {
            wrong =
                kept ? "its address is too high for one that is kept" : "its address is too high";
        }
        if (wrong != NULL) {
            (void)grobo_i_complain(reader, GROBO_ERR_SYNTAX, "register", row->place,
                                   "register %s: %s", row->name, wrong);
        }
    }
}

static bool same_runs(const grobo_i_servo_draft *draft, const grobo_servo_model *like)
{
    bool same = draft->n_indirect == like->indirect_count;
    for (int i = 0; same && i < draft->n_indirect; i++) {
        const grobo_servo_indirect *a = &draft->indirect[i], *b = &like->indirect[i];
        same = a->address == b->address && a->data == b->data && a->count == b->count;
    }
    return same;
}

/* What a series is, beside its registers. */
static void check_whole(grobo_i_reader *reader, const grobo_i_own_servo *own)
{
    const grobo_i_servo_draft *draft = &own->draft;
    const grobo_servo_model *like = own->like;
    bool turns = draft->model.span_deg == 360, turned = like->span_deg == 360;
    bool joint = (like->flags & GROBO_MODEL_NO_JOINT) == 0;
    const struct {
        const char *key;
        bool same;
    } keys[] = {{"keeps", draft->keeps == like->table->keeps},
                {"big_endian", draft->big_endian == like->table->big_endian},
                {"joint", joint != draft->no_joint},
                {"indirect", same_runs(draft, like)},
                {"scale", turns == turned && draft->model.span_deg <= 360}};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        if (!keys[i].same) {
            (void)grobo_i_complain(reader, GROBO_ERR_SYNTAX, "series", draft->place,
                                   "%s: it must be as %s has it", keys[i].key, like->name);
        }
    }
}

/* ---- reading --------------------------------------------------------------------------------- */

static void make_table(grobo_i_own_servo *own)
{
    grobo_i_servo_draft *draft = &own->draft;
    const grobo_servo_table *series = own->like->table;
    for (int i = 0; i < draft->n_rows; i++) {
        own->registers[i] = draft->rows[i].reg;
        own->registers[i].set = 0;
    }
    for (int i = 0; i < draft->n_rates; i++) {
        draft->rates[i].set = 0;
    }
    own->all = 1;
    own->table = (grobo_servo_table){.name = series->name,
                                     .registers = own->registers,
                                     .models = &draft->model,
                                     .rates = draft->rates,
                                     .sets = &own->all,
                                     .register_count = (uint16_t)draft->n_rows,
                                     .model_count = 1,
                                     .rate_count = (uint8_t)draft->n_rates,
                                     .keeps = draft->keeps,
                                     .big_endian = draft->big_endian,
                                     .series = series};
    draft->model.name = draft->name;
    draft->model.table = &own->table;
}

static int read_own(grobo_i_reader *reader, grobo_i_own_servo *own)
{
    int result = grobo_i_servo_read(reader, &own->draft);
    if (result >= 0 && own->like == NULL) {
        result = grobo_i_refuse(reader, GROBO_ERR_SYNTAX, "missing", (grobo_i_place){1, 1},
                                "it has no 'like': the model of the library that talks as it does");
    }
    if (result >= 0 && *own->draft.name == '\0') {
        result = grobo_i_refuse(reader, GROBO_ERR_SYNTAX, "missing", (grobo_i_place){1, 1},
                                "it has no 'name'");
    }
    if (result >= 0) { /* a mistake is told once */
        check_series(reader, own);
        result = reader->result;
    }
    if (result >= 0) {
        result = grobo_i_servo_finish(reader, &own->draft);
    }
    if (result >= 0) {
        check_added(reader, own);
        check_whole(reader, own);
        result = reader->result;
    }
    return result;
}

/* The file's path: beside the robot's file, or below it. False: it is none, or too long. */
static bool path_of(const char *robot, const char *servo, char *path)
{
    size_t directory = 0;
    for (size_t i = 0; robot[i] != '\0'; i++) {
        directory = robot[i] == '/' || robot[i] == '\\' ? i + 1 : directory;
    }
    bool above = strstr(servo, "..") != NULL || strchr(servo, '\\') != NULL;
    int n = snprintf(path, PATH_BYTES, "%.*s%s", (int)directory, robot, servo + 2);
    return !above && directory < PATH_BYTES && n > 0 && n < PATH_BYTES && servo[2] != '\0';
}

/* Reads the file at path; what is wrong with it is in the list of the robot's file. */
static int read_file(grobo_i_reader *outer, const grobo_i_beside *beside, const char *path,
                     grobo_i_place place, grobo_i_own_servo *own)
{
    grobo_source source;
    int result = beside->open(beside->ctx, path, &source);
    if (result < 0) {
        return grobo_i_complain(outer, result, "open", place, "%s: %s", path,
                                result == GROBO_ERR_NOENT         ? "no such file"
                                : result == GROBO_ERR_UNSUPPORTED ? "is no regular file"
                                                                  : grobo_error_text(result));
    }
    grobo_i_reader reader = {.options = outer->options,
                             .file = path,
                             .mem = outer->mem,
                             .list = outer->list,
                             .input = {.source = &source, .size = BUFFER_BYTES}};
    reader.input.buffer = grobo_i_alloc(reader.mem, BUFFER_BYTES);
    result = reader.input.buffer != NULL ? read_own(&reader, own) : GROBO_ERR_NOMEM;
    grobo_i_free(reader.mem, reader.input.buffer, BUFFER_BYTES);
    beside->close(beside->ctx, &source);
    own->good = result >= 0;
    outer->result = outer->result < 0 ? outer->result : result;
    return result;
}

static const grobo_servo_model *model_of(const grobo_i_own_servo *own)
{
    return own->good ? &own->draft.model : NULL;
}

const grobo_servo_model *grobo_i_own_servo_find(grobo_i_reader *reader, grobo_i_robot_file *file,
                                                const grobo_robot_family *family, const char *servo,
                                                grobo_i_place place)
{
    char path[PATH_BYTES];
    for (const grobo_i_own_servo *own = file->own; own != NULL; own = own->next) {
        if (strcmp(own->servo, servo) == 0 && own->family == family) {
            return model_of(own);
        }
    }
    if (file->beside == NULL || !path_of(reader->file, servo, path)) {
        (void)grobo_i_complain(reader, GROBO_ERR_SYNTAX, "servo", place,
                               file->beside == NULL
                                   ? "'%s': only a robot that is read as a file has files beside it"
                                   : "'%s': a file beside the robot's file is wanted, or below it",
                               servo);
        return NULL;
    }
    grobo_i_own_servo *own = grobo_i_new(reader->mem, sizeof *own);
    if (own == NULL) {
        reader->result = GROBO_ERR_NOMEM;
        return NULL;
    }
    own->next = file->own;
    file->own = own;
    snprintf(own->servo, sizeof own->servo, "%s", servo);
    own->family = family;
    own->draft.like = take_like;
    own->draft.ctx = own;
    if (read_file(reader, file->beside, path, place, own) >= 0 && own->good) {
        make_table(own);
    }
    return model_of(own);
}

void grobo_i_own_servos_free(const grobo_mem *mem, grobo_i_own_servo *list)
{
    while (list != NULL) {
        grobo_i_own_servo *next = list->next;
        grobo_i_free(mem, list, sizeof *list);
        list = next;
    }
}
