/* SPDX-License-Identifier: MIT */
/*
 * The fields of a request's body: which there are, of what type, in which range. A body is checked
 * whole before anything is done with it: a name that is mistyped must not mean its default.
 */
#ifndef GRCTL_WEB_FIELDS_H
#define GRCTL_WEB_FIELDS_H

#include <stdbool.h>
#include <stddef.h>

#include <jansson.h>

enum { FIELDS_TEXT_BYTES = 320 };

typedef enum field_kind {
    FIELD_TEXT,    /* 1 to `most` bytes, 0: any number */
    FIELD_FLAG,    /* true or false */
    FIELD_NUMBER,  /* `least` to `most` */
    FIELD_WHOLE,   /* the same, without a fraction */
    FIELD_WORD,    /* one of `words` */
    FIELD_JOINTS,  /* a list of names of joints or groups that is not empty, or "all" */
    FIELD_ANGLES,  /* an object of numbers by name, not empty */
    FIELD_NUMBERS, /* a list of `least` to `most` numbers */
    FIELD_LIST,    /* a list of anything */
    FIELD_OBJECT   /* an object of anything */
} field_kind;

typedef struct field {
    const char *name; /* NULL ends a list of fields */
    field_kind kind;
    bool needed, nullable;
    double least, most;
    const char *words; /* "on, off" */
} field;

/* The greatest whole number of JSON: there is no other end. */
#define FIELD_NO_END 9007199254740991.0

/* The number of the last state that a request is based on. */
#define FIELD_SEQUENCE                                                                             \
    {                                                                                              \
        .name = "sequence", .kind = FIELD_WHOLE, .needed = true, .least = 1, .most = FIELD_NO_END  \
    }

/*
 * Whether an object has what it needs, and nothing else. Else `complaint` has one line: the name of
 * `what`, the field, and what is expected. `body` may be no object.
 */
bool fields_fit(const json_t *body, const field *fields, const char *what,
                char complaint[FIELDS_TEXT_BYTES]);

#endif
