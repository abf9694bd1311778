/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include <jansson.h>

#include "tests/support/files.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"
#include "tests/support/wire_vectors.h"

static void take_bytes(wire_bytes *to, const json_t *hex)
{
    int n = json_is_string(hex)
                ? vector_from_hex(json_string_value(hex), to->bytes, sizeof to->bytes)
                : 0;
    assert_true(n >= 0);
    to->n = (size_t)n;
}

static size_t take_list(wire_bytes *to, const json_t *list)
{
    size_t n = json_array_size(list);
    assert_true(n <= WIRE_LIST_MAX);
    for (size_t i = 0; i < n; i++) {
        take_bytes(&to[i], json_array_get(list, i));
    }
    return n;
}

static int number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_integer(value) ? (int)json_integer_value(value) : -1;
}

static const char *text(const json_t *object, const char *key)
{
    const char *value = json_string_value(json_object_get(object, key));
    return value != NULL ? value : "";
}

static void take(wire_vector *v, const json_t *from)
{
    const json_t *meaning = json_object_get(from, "meaning");
    const json_t *params = json_object_get(meaning, "params");
    const json_t *data = json_object_get(meaning, "data");
    *v = (wire_vector){.name = text(from, "name"),
                       .series = text(from, "series"),
                       .fault = text(from, "fault"),
                       .instruction = text(meaning, "instruction"),
                       .valid = json_is_true(json_object_get(from, "valid")),
                       .from_servo = strcmp(text(from, "direction"), "servo_to_host") == 0,
                       .id = number(meaning, "id"),
                       .error = number(meaning, "error"),
                       .address = number(meaning, "address"),
                       .count = number(meaning, "count"),
                       .command = number(meaning, "command")};
    take_bytes(&v->whole, json_object_get(from, "bytes"));
    take_bytes(&v->sent, json_object_get(from, "sent"));
    take_bytes(&v->data, data != NULL ? data : params);
    v->frame_count = take_list(v->frames, json_object_get(from, "frames"));
    v->chunk_count = take_list(v->chunks, json_object_get(from, "chunks"));
    if (v->valid) {
        v->frames[0] = v->whole;
        v->frame_count = 1;
    }
    if (v->chunk_count == 0) {
        v->chunks[0] = v->whole;
        v->chunk_count = 1;
    }
}

void wire_vectors_check(const char *file, void (*check)(const wire_vector *v), int at_least)
{
    static wire_vector v;
    char path[256];
    json_error_t error;

    (void)snprintf(path, sizeof path, "vectors/%s", file);
    json_t *all = json_load_file(shared_file(path), 0, &error);
    assert_non_null(all);
    assert_true(json_array_size(all) >= (size_t)at_least);
    for (size_t i = 0; i < json_array_size(all); i++) {
        take(&v, json_array_get(all, i));
        print_message("%s: %s\n", file, v.name);
        check(&v);
    }
    json_decref(all);
}

void wire_vector_scan(const wire_vector *v,
                      int (*measure)(const wire_vector *v, const uint8_t *bytes, size_t n))
{
    uint8_t kept[WIRE_BYTES_MAX];
    size_t used = 0;
    size_t found = 0;
    for (size_t c = 0; c <= v->chunk_count; c++) {
        bool end = c == v->chunk_count;
        if (!end) {
            memcpy(kept + used, v->chunks[c].bytes, v->chunks[c].n);
            used += v->chunks[c].n;
        }
        size_t at = 0;
        while (at < used) {
            int size = measure(v, kept + at, used - at);
            if (size == 0 && !end) {
                break;
            }
            if (size <= 0) {
                at++;
                continue;
            }
            assert_true(found < v->frame_count);
            assert_int_equal(size, v->frames[found].n);
            assert_memory_equal(kept + at, v->frames[found].bytes, (size_t)size);
            found++;
            at += (size_t)size;
        }
        used -= at;
        memmove(kept, kept + at, used);
    }
    assert_int_equal(found, v->frame_count);
}
