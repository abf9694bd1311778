/* SPDX-License-Identifier: MIT */
/* Checks the fields of a request's body, and says what was expected. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tools/grctl/web/fields.h"

/* Of a name that is not ours. */
enum { SHOWN_BYTES = 40 };

static bool is_number(const json_t *value, const field *f)
{
    double number = json_number_value(value);
    return json_is_number(value) && number >= f->least && number <= f->most &&
           (f->kind != FIELD_WHOLE || number == floor(number));
}

/* One of "on, off". */
static bool is_word(const json_t *value, const char *words)
{
    const char *word = json_string_value(value);
    size_t n = word && !strpbrk(word, ", ") ? strlen(word) : 0;
    for (const char *at = words; n > 0 && at; at = strchr(at, ' ')) {
        at += *at == ' ';
        if (strncmp(at, word, n) == 0 && (at[n] == ',' || at[n] == '\0')) {
            return true;
        }
    }
    return false;
}

static bool are_texts(const json_t *list)
{
    size_t n = json_array_size(list), i = 0;
    while (i < n && json_is_string(json_array_get(list, i))) {
        i++;
    }
    return n > 0 && i == n;
}

static bool are_numbers(const json_t *list, const field *f)
{
    size_t n = json_array_size(list), i = 0;
    while (i < n && json_is_number(json_array_get(list, i))) {
        i++;
    }
    return json_is_array(list) && i == n && (double)n >= f->least && (double)n <= f->most;
}

static bool are_angles(const json_t *object)
{
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)object, name, value)
    {
        if (!json_is_number(value)) {
            return false;
        }
    }
    return json_object_size(object) > 0;
}

static bool is_valid(const json_t *value, const field *f)
{
    if (json_is_null(value)) {
        return f->nullable;
    }
    switch (f->kind) {
    case FIELD_TEXT:
        return json_is_string(value) &&
               (f->most <= 0 || (double)json_string_length(value) <= f->most);
    case FIELD_FLAG:
        return json_is_boolean(value);
    case FIELD_NUMBER:
    case FIELD_WHOLE:
        return is_number(value, f);
    case FIELD_WORD:
        return is_word(value, f->words);
    case FIELD_JOINTS:
        return are_texts(value) || is_word(value, "all");
    case FIELD_ANGLES:
        return are_angles(value);
    case FIELD_NUMBERS:
        return are_numbers(value, f);
    case FIELD_LIST:
        return json_is_array(value);
    case FIELD_OBJECT:
        return json_is_object(value);
    }
    return false;
}

/* What is expected of a field. */
static void expect(const field *f, char *text, size_t capacity)
{
    switch (f->kind) {
    case FIELD_TEXT:
        snprintf(text, capacity, "a text");
        break;
    case FIELD_FLAG:
        snprintf(text, capacity, "true or false");
        break;
    case FIELD_NUMBER:
        snprintf(text, capacity, "a number from %.15g to %.15g", f->least, f->most);
        break;
    case FIELD_WHOLE:
        if (f->most >= FIELD_NO_END) {
            snprintf(text, capacity, "a whole number, %.15g or more", f->least);
        } else {
            snprintf(text, capacity, "a whole number from %.15g to %.15g", f->least, f->most);
        }
        break;
    case FIELD_WORD:
        snprintf(text, capacity, "one of %s", f->words);
        break;
    case FIELD_JOINTS:
        snprintf(text, capacity, "a list of names of joints or groups, or \"all\"");
        break;
    case FIELD_ANGLES:
        snprintf(text, capacity, "degrees by name of joint, {\"NAME\": 0.0}");
        break;
    case FIELD_NUMBERS:
        if (f->least == f->most) {
            snprintf(text, capacity, "a list of %.15g numbers", f->most);
        } else {
            snprintf(text, capacity, "a list of %.15g to %.15g numbers", f->least, f->most);
        }
        break;
    case FIELD_LIST:
        snprintf(text, capacity, "a list");
        break;
    case FIELD_OBJECT:
        snprintf(text, capacity, "an object");
        break;
    }
    if (f->nullable) {
        size_t n = strlen(text);
        snprintf(text + n, capacity - n, ", or null");
    }
}

static bool complain(const field *f, const char *what, const char *why,
                     char complaint[FIELDS_TEXT_BYTES])
{
    char expected[FIELDS_TEXT_BYTES / 2];
    expect(f, expected, sizeof expected);
    snprintf(complaint, FIELDS_TEXT_BYTES, "%s: %s %s; expected %s", what, f->name, why, expected);
    return false;
}

/* The first bytes of a foreign name, up to a whole character and without what moves a cursor. */
static void shorten(const char *name, char text[SHOWN_BYTES])
{
    size_t n = strlen(name);
    bool whole = n < SHOWN_BYTES;
    n = whole ? n : SHOWN_BYTES - 1;
    while (!whole && n > 0 && ((unsigned char)name[n] & 0xC0) == 0x80) {
        n--;
    }
    for (size_t i = 0; i < n; i++) {
        text[i] = (unsigned char)name[i] < 0x20 || name[i] == 0x7f ? '?' : name[i];
    }
    text[n] = '\0';
}

static bool complain_of_unknown(const field *fields, const char *what, const char *name,
                                char complaint[FIELDS_TEXT_BYTES])
{
    char text[SHOWN_BYTES];
    shorten(name, text);
    int n = snprintf(complaint, FIELDS_TEXT_BYTES, "%s: unknown field '%s'; expected %s", what,
                     text, fields->name ? fields->name : "none");
    for (const field *f = fields; f->name && f[1].name && n < FIELDS_TEXT_BYTES; f++) {
        n += snprintf(complaint + n, FIELDS_TEXT_BYTES - (size_t)n, ", %s", f[1].name);
    }
    return false;
}

static const field *find(const field *fields, const char *name)
{
    for (const field *f = fields; f->name; f++) {
        if (strcmp(f->name, name) == 0) {
            return f;
        }
    }
    return NULL;
}

bool fields_fit(const json_t *body, const field *fields, const char *what,
                char complaint[FIELDS_TEXT_BYTES])
{
    const char *name;
    json_t *value;
    if (!json_is_object(body)) {
        snprintf(complaint, FIELDS_TEXT_BYTES, "%s: it is no object; expected {\"%s\": ...}", what,
                 fields->name ? fields->name : "");
        return false;
    }
    json_object_foreach((json_t *)body, name, value)
    {
        const field *f = find(fields, name);
        if (!f) {
            return complain_of_unknown(fields, what, name, complaint);
        }
        if (!is_valid(value, f)) {
            return complain(f, what, "is not valid", complaint);
        }
    }
    for (const field *f = fields; f->name; f++) {
        if (f->needed && !json_object_get(body, f->name)) {
            return complain(f, what, "is missing", complaint);
        }
    }
    return true;
}
