/* SPDX-License-Identifier: MIT */
/*
 * Makes const tables of servo models: `servos DIR` writes C to standard output, of DIR/table.yaml
 * and the files of the models that it lists. `make servos` runs it for src/servo/models; what it
 * writes is committed, so that firmware needs no such tool. `servos --document DIR` writes lines of
 * docs/servo-models.md instead.
 */
#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/robots/file/servo.h"

enum { MODELS = 64, ROWS = 1024, SETS = 255, RATES = 64, BUFFER_BYTES = 16 * 1024 };

/* A register or a rate, and the models that have it, bit by bit. */
typedef struct shared_row {
    grobo_servo_register reg;
    uint64_t models;
} shared_row;

typedef struct shared_rate {
    grobo_servo_rate rate;
    uint64_t models;
} shared_rate;

typedef struct table {
    const char *dir;
    char symbol[64], name[64], header[64];
    int n_models, n_rows, n_rates, n_sets;
    grobo_i_servo_draft models[MODELS];
    shared_row rows[ROWS];
    shared_rate rates[RATES];
    uint64_t sets[SETS];
} table;

static grobo_diagnostics *list;
static bool failed;

static int read_stream(void *ctx, void *buffer, size_t size)
{
    size_t n = fread(buffer, 1, size, ctx);
    return n == 0 && ferror((FILE *)ctx) ? GROBO_ERR_IO : (int)n;
}

static int read_like(grobo_i_servo_draft *draft, grobo_i_reader *reader, const char *name,
                     grobo_i_place place);

/* Reads DIR/NAME.yaml with a function of its own. */
static int read_file(const char *dir, const char *name,
                     int (*read)(grobo_i_reader *reader, void *ctx), void *ctx)
{
    static char paths[MODELS * 4][256];
    static int next;
    char *path = paths[next++ % (MODELS * 4)];
    snprintf(path, sizeof paths[0], "%s/%s.yaml", dir, name);
    FILE *file = fopen(path, "rb");
    if (!file) {
        fprintf(stderr, "%s: no such file\n", path);
        failed = true;
        return GROBO_ERR_IO;
    }
    const grobo_source source = {read_stream, file};
    grobo_i_reader reader = {.options = {.keep_going = true},
                             .file = path,
                             .mem = grobo_mem_default(),
                             .list = list,
                             .input = {.source = &source, .size = BUFFER_BYTES}};
    reader.input.buffer = malloc(BUFFER_BYTES);
    int result = reader.input.buffer ? read(&reader, ctx) : GROBO_ERR_NOMEM;
    free(reader.input.buffer);
    fclose(file);
    failed = failed || result < 0;
    return result;
}

static int read_block(grobo_i_reader *reader, void *draft)
{
    return grobo_i_servo_read(reader, draft);
}

static int read_model(grobo_i_reader *reader, void *ctx)
{
    grobo_i_servo_draft *draft = ctx;
    int result = grobo_i_servo_read(reader, draft);
    return result < 0 ? result : grobo_i_servo_finish(reader, draft);
}

static int read_like(grobo_i_servo_draft *draft, grobo_i_reader *reader, const char *name,
                     grobo_i_place place)
{
    grobo_i_servo_text own;
    memcpy(own, draft->name, sizeof own);
    if (++draft->depth > GROBO_I_SERVO_LIKES) {
        return grobo_i_refuse(reader, GROBO_ERR_CAP, "depth", place, "like: too deep");
    }
    int result = read_file(draft->ctx, name, read_block, draft);
    draft->depth--; /* its sources are those of the file too, until that has its own */
    memcpy(draft->name, own, sizeof own);
    return result;
}

/* ---- table.yaml ---------------------------------------------------------------------------- */

static int read_string(grobo_i_events *events, const char *what, char *to, size_t size)
{
    char *text = NULL;
    int result = grobo_i_read_string(events, what, &text);
    if (result == 0 && text) {
        snprintf(to, size, "%s", text);
        grobo_i_free_text(events->reader->mem, text);
    }
    return result;
}

static int read_symbol(grobo_i_events *events, void *target)
{
    table *t = target;
    return read_string(events, "symbol", t->symbol, sizeof t->symbol);
}

static int read_title(grobo_i_events *events, void *target)
{
    table *t = target;
    return read_string(events, "name", t->name, sizeof t->name);
}

static int read_header(grobo_i_events *events, void *target)
{
    table *t = target;
    return read_string(events, "header", t->header, sizeof t->header);
}

static int read_entry(grobo_i_events *events, void *target)
{
    table *t = target;
    char name[64] = "";
    int result = read_string(events, "a model", name, sizeof name);
    if (result < 0 || t->n_models == MODELS) {
        return result < 0 ? result : GROBO_ERR_CAP;
    }
    grobo_i_servo_draft *draft = &t->models[t->n_models++];
    draft->like = read_like;
    draft->ctx = (void *)(uintptr_t)t->dir;
    return read_file(t->dir, name, read_model, draft);
}

static int read_models(grobo_i_events *events, void *target)
{
    return grobo_i_read_list(events, "models", read_entry, target);
}

/* The table's own file: make.sh wants to know it. */
static int skip_value(grobo_i_events *events, void *target)
{
    (void)target;
    return grobo_i_skip(events);
}

static int read_table(grobo_i_reader *reader, void *ctx)
{
    static const grobo_i_field fields[] = {{"symbol", NULL, read_symbol},
                                           {"name", NULL, read_title},
                                           {"header", NULL, read_header},
                                           {"models", NULL, read_models},
                                           {"file", NULL, skip_value}};
    static const grobo_i_fields keys = {"table.yaml", fields, 5, NULL};
    grobo_i_events events;
    uint32_t seen = 0;
    int result = grobo_i_input_fill(&reader->input);
    result = result < 0 ? result : grobo_i_events_begin(&events, reader);
    if (result < 0) {
        return result;
    }
    result = grobo_i_read_map(&events, &keys, ctx, &seen);
    grobo_i_events_end(&events);
    return result < 0 ? result : reader->result < 0 || seen != 0x1F ? GROBO_ERR_SYNTAX : GROBO_OK;
}

/* ---- rows of all models -------------------------------------------------------------------- */

static bool same_register(const grobo_servo_register *a, const grobo_servo_register *b)
{
    return strcmp(a->name, b->name) == 0 && strcmp(a->unit, b->unit) == 0 && a->min == b->min &&
           a->max == b->max && a->factory == b->factory && a->address == b->address &&
           a->bytes == b->bytes && a->sign == b->sign && a->flags == b->flags && a->role == b->role;
}

static void add_register(table *t, const grobo_servo_register *reg, int model)
{
    int i = 0;
    while (i < t->n_rows && !same_register(&t->rows[i].reg, reg)) {
        i++;
    }
    if (i == ROWS) {
        failed = true;
        return;
    }
    if (i == t->n_rows) {
        t->rows[t->n_rows++] = (shared_row){.reg = *reg};
    }
    t->rows[i].models |= (uint64_t)1 << model;
}

static void add_rate(table *t, const grobo_servo_rate *rate, int model)
{
    int i = 0;
    while (i < t->n_rates &&
           (t->rates[i].rate.code != rate->code || t->rates[i].rate.bps != rate->bps)) {
        i++;
    }
    if (i == RATES) {
        failed = true;
        return;
    }
    if (i == t->n_rates) {
        t->rates[t->n_rates++] = (shared_rate){.rate = *rate};
    }
    t->rates[i].models |= (uint64_t)1 << model;
}

/* By address; those of one address as the models come that have them. */
static int by_address(const void *a, const void *b)
{
    const shared_row *x = a, *y = b;
    if (x->reg.address != y->reg.address) {
        return x->reg.address < y->reg.address ? -1 : 1;
    }
    uint64_t first_x = x->models & (~x->models + 1), first_y = y->models & (~y->models + 1);
    return first_x < first_y ? -1 : first_x > first_y;
}

static int by_code(const void *a, const void *b)
{
    const shared_rate *x = a, *y = b;
    return x->rate.code != y->rate.code ? x->rate.code - y->rate.code
                                        : (x->models < y->models ? -1 : x->models > y->models);
}

static void merge(table *t)
{
    for (int m = 0; m < t->n_models; m++) {
        const grobo_i_servo_draft *draft = &t->models[m];
        for (int i = 0; i < draft->n_rows; i++) {
            add_register(t, &draft->rows[i].reg, m);
        }
        for (int i = 0; i < draft->n_rates; i++) {
            add_rate(t, &draft->rates[i], m);
        }
    }
    qsort(t->rows, (size_t)t->n_rows, sizeof t->rows[0], by_address);
    qsort(t->rates, (size_t)t->n_rates, sizeof t->rates[0], by_code);
}

static int set_of(table *t, uint64_t models)
{
    int i = 0;
    while (i < t->n_sets && t->sets[i] != models) {
        i++;
    }
    if (i == SETS) {
        failed = true;
        return 0;
    }
    t->sets[i] = models;
    t->n_sets = i == t->n_sets ? i + 1 : t->n_sets;
    return i;
}

/* ---- C ------------------------------------------------------------------------------------- */

static const char *number(int32_t value)
{
    static char text[4][16];
    static unsigned next;
    char *to = text[next++ % 4];
    if (value == INT32_MIN || value == INT32_MAX) {
        return value == INT32_MIN ? "INT32_MIN" : "INT32_MAX";
    }
    snprintf(to, sizeof text[0], "%" PRId32, value);
    return to;
}

/* The name of the function that returns the table, without grobo_. */
static const char *own_part(const table *t)
{
    static const char prefix[] = "grobo_";
    return t->symbol + (strncmp(t->symbol, prefix, sizeof prefix - 1) == 0 ? sizeof prefix - 1 : 0);
}

static void print_row(table *t, const shared_row *row)
{
    static const char *const flags[] = {"R", "W", "E", "EW"};
    const grobo_servo_register *reg = &row->reg;
    char role[32] = "";
    snprintf(role, sizeof role, "%s", grobo_i_role_name((grobo_register_role)reg->role));
    for (char *c = role; *c; c++) {
        *c = (char)toupper((unsigned char)*c);
    }
    printf("    ROW(\"%s\", %u, %u, %u, %s, %s, \"%s\", %s, %s, %s, %d),\n", reg->name,
           reg->address, reg->bytes, reg->sign, flags[reg->flags & 3], role, reg->unit,
           number(reg->min), number(reg->max), number(reg->factory), set_of(t, row->models));
}

static bool same_indirect(const grobo_i_servo_draft *a, const grobo_i_servo_draft *b)
{
    bool same = a->n_indirect == b->n_indirect;
    for (int i = 0; same && i < a->n_indirect; i++) {
        const grobo_servo_indirect *x = &a->indirect[i], *y = &b->indirect[i];
        same = x->address == y->address && x->data == y->data && x->count == y->count;
    }
    return same;
}

/* The first model with the same runs of indirect registers. */
static int first_alike(const table *t, int model)
{
    int first = 0;
    while (!same_indirect(&t->models[first], &t->models[model])) {
        first++;
    }
    return first;
}

static void print_indirect(const table *t)
{
    for (int i = 0; i < t->n_models; i++) {
        const grobo_i_servo_draft *m = &t->models[i];
        if (m->n_indirect > 0 && first_alike(t, i) == i) {
            printf("static const grobo_servo_indirect indirect_%d[] = {", i);
            for (int k = 0; k < m->n_indirect; k++) {
                printf("{%u, %u, %u},", m->indirect[k].address, m->indirect[k].data,
                       m->indirect[k].count);
            }
            printf("};\n\n");
        }
    }
}

static const char *flags_of(const grobo_i_servo_draft *model)
{
    return model->no_joint && model->unverified ? "GROBO_MODEL_NO_JOINT | GROBO_MODEL_UNVERIFIED"
           : model->no_joint                    ? "GROBO_MODEL_NO_JOINT"
           : model->unverified                  ? "GROBO_MODEL_UNVERIFIED"
                                                : "0";
}

static void print_models(const table *t)
{
    print_indirect(t);
    printf("static const grobo_servo_model models[] = {\n");
    for (int i = 0; i < t->n_models; i++) {
        const grobo_servo_model *m = &t->models[i].model;
        printf("    {\"%s\", %u, %u, %u, %u, %u, %u, %u, %u, %u, %s, &grobo_i_%s",
               t->models[i].name, m->number, m->span_ticks, m->span_deg, m->middle, m->speed_dps,
               m->torque_mnm, m->current_ma, m->voltage_mv, m->firmware, flags_of(&t->models[i]),
               own_part(t));
        if (t->models[i].n_indirect > 0) {
            printf(", indirect_%d, %d", first_alike(t, i), t->models[i].n_indirect);
        } else {
            printf(", NULL, 0");
        }
        printf(", %u},\n", m->fast_firmware);
    }
    printf("};\n\n");
}

static void print_table(table *t)
{
    static const char *const keeps[] = {"LIMP", "LOCK", "COMMAND"};
    printf("/* SPDX-License-Identifier: MIT */\n"
           "/* Made from %s by `make servos`: registers and models. */\n"
           "#include <grobo/%s>\n\n#include \"src/servo/row.h\"\n"
           "#include \"src/servo/tables.h\"\n\n",
           t->dir, t->header);
    printf("static const grobo_servo_register rows[] = {\n");
    for (int i = 0; i < t->n_rows; i++) {
        print_row(t, &t->rows[i]);
    }
    printf("};\n\n");
    print_models(t);
    if (t->n_rates > 0) {
        printf("static const grobo_servo_rate rates[] = {\n");
        for (int i = 0; i < t->n_rates; i++) {
            printf("    {%u, %d, %" PRId32 "},\n", t->rates[i].rate.code,
                   set_of(t, t->rates[i].models), t->rates[i].rate.bps);
        }
        printf("};\n\n");
    }
    printf("static const uint64_t sets[] = {\n");
    for (int i = 0; i < t->n_sets; i++) {
        printf("0x%" PRIX64 ",", t->sets[i]);
    }
    printf("};\n\nconst grobo_servo_table grobo_i_%s = {\n    .name = \"%s\",\n", own_part(t),
           t->name);
    printf("    LIST(registers, register_count, rows),\n    LIST(models, model_count, models),\n");
    if (t->n_rates > 0) {
        printf("    LIST(rates, rate_count, rates),\n");
    }
    printf("    .sets = sets,\n    .keeps = GROBO_KEEPS_%s,\n", keeps[t->models[0].keeps]);
    if (t->models[0].big_endian) {
        printf("    .big_endian = true,\n");
    }
    printf("};\n\nconst grobo_servo_table *%s(void)\n{\n", t->symbol);
    printf("    return &grobo_i_%s;\n}\n", own_part(t));
}

/* ---- docs/servo-models.md ------------------------------------------------------------------ */

static int bits(uint32_t mask)
{
    int n = 0;
    for (; mask != 0; mask &= mask - 1) {
        n++;
    }
    return n;
}

static void print_sources(const grobo_i_servo_draft *m)
{
    uint32_t used = 0;
    bool first = true;
    for (int i = 0; i < m->n_rows; i++) {
        used |= m->rows[i].layout | m->rows[i].values;
    }
    for (int i = 0; i < m->n_sources; i++) {
        if ((used >> i & 1) != 0) {
            printf("%s%s", first ? "" : ", ", m->source[i]);
            first = false;
        }
    }
}

/* A line a model: of how many of its registers two sources say the place, and the values. */
static void print_document(const table *t)
{
    for (int k = 0; k < t->n_models; k++) {
        const grobo_i_servo_draft *m = &t->models[k];
        int layout = 0, values = 0;
        for (int i = 0; i < m->n_rows; i++) {
            layout += bits(m->rows[i].layout) >= 2;
            values += bits(m->rows[i].values) >= 2;
        }
        printf("| %s | %s | %u | %d | %d | %d | %d | %d | ", m->name, t->name, m->model.number,
               m->n_rows, layout, m->n_rows - layout, values, m->n_rows - values);
        print_sources(m);
        printf(" |\n");
    }
}

static bool read_dir(table *t, const char *dir)
{
    grobo_diagnostic d;
    memset(t, 0, sizeof *t);
    t->dir = dir;
    (void)read_file(dir, "table", read_table, t);
    for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++) {
        fprintf(stderr, "%s:%u:%u: %s\n", d.file, d.line, d.column, d.message);
    }
    for (int i = 0; i < t->n_models && !failed; i++) {
        const grobo_i_servo_draft *m = &t->models[i];
        if (m->keeps != t->models[0].keeps || m->big_endian != t->models[0].big_endian) {
            fprintf(stderr, "%s: %s keeps values otherwise than the first\n", dir, m->name);
            failed = true;
        }
    }
    return !failed;
}

int main(int argc, char **argv)
{
    table *t = malloc(sizeof *t);
    bool document = argc == 3 && strcmp(argv[1], "--document") == 0;
    if (!t || (argc != 2 && !document) || grobo_diagnostics_new(NULL, &list) < 0) {
        fprintf(stderr, "usage: servos [--document] DIR\n");
        free(t);
        return 2;
    }
    if (read_dir(t, argv[argc - 1]) && document) {
        print_document(t);
    } else if (!failed) {
        merge(t);
        print_table(t);
    }
    grobo_diagnostics_free(list);
    free(t);
    return failed ? 1 : 0;
}
