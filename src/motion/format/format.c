/* SPDX-License-Identifier: MIT */
/* The formats of motion files: names, the kind of motion that each holds, reader and writer. */
#include <string.h>

#include "src/motion/format/format.h"

/* By grobo_motion_format. */
static const grobo_i_format rows[] = {
    [GROBO_FORMAT_M] = {.name = "m",
                        .kind = GROBO_MOTION_POSTURES,
                        .sniff = grobo_i_sniff_m,
                        .read = grobo_i_read_m,
                        .write = grobo_i_write_m},
    [GROBO_FORMAT_PSEQ] = {.name = "pseq",
                           .kind = GROBO_MOTION_KEYS,
                           .read = grobo_i_read_yaml,
                           .write = grobo_i_write_pseq},
    [GROBO_FORMAT_MSEQ] = {.name = "mseq",
                           .kind = GROBO_MOTION_STEPS,
                           .read = grobo_i_read_yaml,
                           .write = grobo_i_write_pseq},
    [GROBO_FORMAT_YAML] = {.name = "yaml",
                           .extensions = {"yml", "seq"},
                           .kind = GROBO_MOTION_FRAMES,
                           .read = grobo_i_read_yaml,
                           .write = grobo_i_write_yaml},
};
enum { N_ROWS = sizeof rows / sizeof rows[0] };

const grobo_i_format *grobo_i_format_row(grobo_motion_format format)
{
    return (unsigned)format < N_ROWS && rows[format].name != NULL ? &rows[format] : NULL;
}

const grobo_i_format *grobo_i_format_sniff(const unsigned char *text, size_t size)
{
    const grobo_i_format *other = NULL;
    for (int i = N_ROWS - 1; i >= 0; i--) {
        const grobo_i_format *row = grobo_i_format_row((grobo_motion_format)i);
        if (row != NULL && row->sniff != NULL && row->sniff(text, size)) {
            return row;
        }
        other = row != NULL && row->sniff == NULL ? row : other;
    }
    return other;
}

const char *grobo_motion_format_name(grobo_motion_format format)
{
    const grobo_i_format *row = grobo_i_format_row(format);
    return row != NULL ? row->name : format == GROBO_FORMAT_AUTO ? "auto" : "unknown";
}

static bool same_word(const char *a, const char *b)
{
    for (; *a != '\0' && *b != '\0'; a++, b++) {
        char low = *a >= 'A' && *a <= 'Z' ? (char)(*a + ('a' - 'A')) : *a;
        if (low != *b) {
            return false;
        }
    }
    return *a == *b;
}

static bool has_extension(const grobo_i_format *row, const char *word)
{
    bool has = same_word(word, row->name);
    for (size_t i = 0; i < sizeof row->extensions / sizeof row->extensions[0]; i++) {
        has = has || (row->extensions[i] != NULL && same_word(word, row->extensions[i]));
    }
    return has;
}

grobo_motion_format grobo_motion_format_of_path(const char *path)
{
    const char *dot = path != NULL ? strrchr(path, '.') : NULL;
    for (int i = 0; dot != NULL && i < N_ROWS; i++) {
        const grobo_i_format *row = grobo_i_format_row((grobo_motion_format)i);
        if (row != NULL && has_extension(row, dot + 1)) {
            return (grobo_motion_format)i;
        }
    }
    return GROBO_FORMAT_AUTO;
}

grobo_motion_kind grobo_motion_format_kind(grobo_motion_format format)
{
    const grobo_i_format *row = grobo_i_format_row(format);
    return row != NULL ? row->kind : GROBO_MOTION_KEYS;
}

grobo_motion_format grobo_motion_kind_format(grobo_motion_kind kind)
{
    for (int i = 0; i < N_ROWS; i++) {
        const grobo_i_format *row = grobo_i_format_row((grobo_motion_format)i);
        if (row != NULL && row->kind == kind) {
            return (grobo_motion_format)i;
        }
    }
    return GROBO_FORMAT_AUTO;
}
