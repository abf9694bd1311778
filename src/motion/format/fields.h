/* SPDX-License-Identifier: MIT */
/*
 * Reading YAML by tables: a mapping is a table of its keys, each with the function that reads its
 * value. Every function here reads exactly one node, also one that it complains about, so that
 * reading can go on behind it.
 */
#ifndef GROBO_MOTION_FIELDS_H
#define GROBO_MOTION_FIELDS_H

#include "src/motion/format/events.h"

typedef struct grobo_i_field {
    const char *name;
    const char *other; /* a second spelling, or NULL */
    int (*read)(grobo_i_events *events, void *target);
} grobo_i_field;

typedef struct grobo_i_fields {
    const char *what; /* "a ref": for complaints */
    const grobo_i_field *fields;
    size_t count; /* at most 32 */
    /* Reads the value of a key that is in no field. */
    int (*unknown)(grobo_i_events *events, void *target, const char *key);
} grobo_i_fields;

/*
 * Reads a mapping into target. Keys given twice are refused; merge keys (<<) give what the mapping
 * itself does not. *seen gets bit i for field i, and is untouched if there is no mapping.
 */
int grobo_i_read_map(grobo_i_events *events, const grobo_i_fields *fields, void *target,
                     uint32_t *seen);
/* Calls read for each entry of a list; a null is an empty list. */
int grobo_i_read_list(grobo_i_events *events, const char *what,
                      int (*read)(grobo_i_events *events, void *target), void *target);
int grobo_i_skip(grobo_i_events *events);

/* Of a wrong value these complain and leave *value alone. `what` names it in the complaint. */
int grobo_i_read_double(grobo_i_events *events, const char *what, double *value);
int grobo_i_read_long(grobo_i_events *events, const char *what, long low, long high, long *value);
int grobo_i_read_bool(grobo_i_events *events, const char *what, bool *value);
/* A list of numbers, each with its place where places are asked for. */
typedef struct grobo_i_numbers {
    double *values;
    grobo_i_place *places; /* or NULL */
    int count, cap;        /* more than cap are refused */
    double bad;            /* in the place of one that was complained of */
} grobo_i_numbers;
int grobo_i_read_numbers(grobo_i_events *events, const char *what, grobo_i_numbers *list);
/* Exactly count numbers, at most 9; NaN in the place of one that was complained of. */
int grobo_i_read_doubles(grobo_i_events *events, const char *what, double *values, int count);
/* A copy of a scalar, null being ""; freed by grobo_i_free_text(). An old *value is freed. */
int grobo_i_read_string(grobo_i_events *events, const char *what, char **value);
/*
 * Reads the one document of a file, a mapping, by a function that reads it. Aliases are refused.
 * @param what the file, in complaints: "a robot's file"
 * @return 0, or an error that is said
 */
int grobo_i_read_document(grobo_i_reader *reader, const char *what,
                          int (*read)(grobo_i_events *events, void *target), void *target);
uint64_t grobo_i_hash(const char *text);
/* True for a plain scalar that means nothing: empty, ~, null. */
bool grobo_i_is_null(const grobo_i_event *event);
/*
 * Keeps the value of a key: adds it to a list of kept keys. Line breaks and quotes are made such
 * that it can be written on one line.
 */
int grobo_i_keep_value(grobo_i_events *events, grobo_i_kept **list, const grobo_kept *where);

#endif
