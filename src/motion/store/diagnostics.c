/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/store/diagnostics.h"
#include "src/motion/text/utf8.h"

enum { MESSAGE_BYTES = 256, FILES_MAX = 64, ENTRIES_FIRST = 8 };

enum { SEVERITIES = GROBO_SEVERITY_NOTE + 1 };

typedef struct entry {
    uint32_t line, column;
    grobo_severity severity;
    int file; /* of files, -1 none */
    char code[32];
    char message[MESSAGE_BYTES];
} entry;

struct grobo_diagnostics {
    const grobo_mem *mem;
    entry *entries;
    size_t count, room;
    size_t totals[SEVERITIES];
    char *files[FILES_MAX];
    int n_files;
};

int grobo_diagnostics_new(const grobo_mem *mem, grobo_diagnostics **list)
{
    if (list == NULL) {
        return GROBO_ERR_ARG;
    }
    mem = mem != NULL ? mem : grobo_mem_default();
    grobo_diagnostics *made = grobo_i_new(mem, sizeof *made);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->mem = mem;
    *list = made;
    return 0;
}

void grobo_diagnostics_clear(grobo_diagnostics *list)
{
    if (list == NULL) {
        return;
    }
    grobo_i_free(list->mem, list->entries, list->room * sizeof *list->entries);
    for (int i = 0; i < list->n_files; i++) {
        grobo_i_free_text(list->mem, list->files[i]);
    }
    const grobo_mem *mem = list->mem;
    memset(list, 0, sizeof *list);
    list->mem = mem;
}

void grobo_diagnostics_free(grobo_diagnostics *list)
{
    if (list != NULL) {
        grobo_diagnostics_clear(list);
        grobo_i_free(list->mem, list, sizeof *list);
    }
}

size_t grobo_diagnostics_total(const grobo_diagnostics *list, grobo_severity severity)
{
    return list != NULL && (unsigned)severity < SEVERITIES ? list->totals[severity] : 0;
}

size_t grobo_diagnostics_kept(const grobo_diagnostics *list)
{
    return list != NULL ? list->count : 0;
}

int grobo_diagnostics_get(const grobo_diagnostics *list, size_t i, grobo_diagnostic *diagnostic)
{
    if (list == NULL || diagnostic == NULL || i >= list->count) {
        return GROBO_ERR_ARG;
    }
    const entry *found = &list->entries[i];
    diagnostic->file = found->file >= 0 ? list->files[found->file] : "";
    diagnostic->code = found->code;
    diagnostic->message = found->message;
    diagnostic->line = found->line;
    diagnostic->column = found->column;
    diagnostic->severity = found->severity;
    return 0;
}

/* The number of a file's name; -1 without memory or when there are too many. */
static int file_number(grobo_diagnostics *list, const char *name)
{
    for (int i = list->n_files - 1; i >= 0; i--) {
        if (strcmp(list->files[i], name) == 0) {
            return i;
        }
    }
    if (name[0] == '\0' || list->n_files == FILES_MAX) {
        return -1;
    }
    char *copy = grobo_i_copy_text(list->mem, name, strlen(name));
    if (copy == NULL) {
        return -1;
    }
    list->files[list->n_files] = copy;
    return list->n_files++;
}

static bool make_room(grobo_diagnostics *list)
{
    if (list->count < list->room) {
        return true;
    }
    size_t room = list->room == 0 ? ENTRIES_FIRST : list->room * 2;
    room = room < GROBO_DIAGNOSTICS_MAX ? room : GROBO_DIAGNOSTICS_MAX;
    if (room == list->room) {
        return false;
    }
    entry *entries = list->mem->resize(list->mem->ctx, list->entries, list->room * sizeof *entries,
                                       room * sizeof *entries);
    if (entries == NULL) {
        return false;
    }
    list->entries = entries;
    list->room = room;
    return true;
}

/* Copies text, cut to size, between two characters and not within one. */
static void cut_copy(char *to, size_t size, const char *text)
{
    size_t length = strlen(text);

    if (length >= size) {
        length = size - 1;
        while (length > 0 && ((unsigned char)text[length] & 0xC0) == 0x80) {
            length--;
        }
    }
    memcpy(to, text, length);
    to[length] = '\0';
}

void grobo_diagnostics_add(grobo_diagnostics *list, const grobo_diagnostic *diagnostic)
{
    if (list == NULL || diagnostic == NULL || (unsigned)diagnostic->severity >= SEVERITIES) {
        return;
    }
    list->totals[diagnostic->severity]++;
    if (!make_room(list)) {
        return;
    }
    entry *added = &list->entries[list->count++];
    added->line = diagnostic->line;
    added->column = diagnostic->column;
    added->severity = diagnostic->severity;
    added->file = file_number(list, diagnostic->file != NULL ? diagnostic->file : "");
    cut_copy(added->code, sizeof added->code, diagnostic->code);
    cut_copy(added->message, sizeof added->message, diagnostic->message);
}

const char *grobo_severity_name(grobo_severity severity)
{
    static const char *const names[SEVERITIES] = {"error", "warning", "note"};

    return (unsigned)severity < SEVERITIES ? names[severity] : "unknown";
}

void grobo_i_format_message(char *message, size_t size, const char *format, va_list args)
{
    (void)vsnprintf(message, size, format, args);
    const char *end = message + strlen(message);

    for (char *p = message; p < end;) {
        size_t length = grobo_i_utf8_length(p, (size_t)(end - p));
        if (length == 0 || (unsigned char)*p < 0x20 || *p == 0x7F) {
            *p = '?';
            length = 1;
        }
        p += length;
    }
}

void grobo_i_say(grobo_diagnostics *list, const grobo_i_said *said, const char *format, ...)
{
    char message[MESSAGE_BYTES];
    va_list args;

    if (list == NULL) {
        return;
    }
    va_start(args, format);
    grobo_i_format_message(message, sizeof message, format, args);
    va_end(args);
    grobo_diagnostics_add(list, &(grobo_diagnostic){said->file, said->code, message, said->line,
                                                    said->column, said->severity});
}
