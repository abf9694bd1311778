/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include <grobo/error.h>

typedef struct error_entry {
    int value;
    const char *name;
    const char *text;
} error_entry;

static const error_entry entries[] = {
#define ENTRY(name, value, text) {(value), #name, (text)},
    GROBO_ERROR_LIST(ENTRY)
#undef ENTRY
};

static const error_entry *find(int result)
{
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
        if (entries[i].value == result) {
            return &entries[i];
        }
    }
    return NULL;
}

const char *grobo_error_name(int result)
{
    if (result >= 0) {
        return "OK";
    }
    const error_entry *entry = find(result);
    return entry != NULL ? entry->name : "UNKNOWN";
}

const char *grobo_error_text(int result)
{
    if (result >= 0) {
        return "success";
    }
    const error_entry *entry = find(result);
    return entry != NULL ? entry->text : "unknown error";
}
