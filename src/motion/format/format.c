/* SPDX-License-Identifier: MIT */
/* The formats of motion files: their names, and the kind of motion that each holds. */
#include <string.h>

#include <grobo/motion_io.h>

const char *grobo_motion_format_name(grobo_motion_format format)
{
    static const char *const names[] = {"auto", "m", "pseq", "mseq", "yaml"};

    return (unsigned)format < sizeof names / sizeof names[0] ? names[format] : "unknown";
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

grobo_motion_format grobo_motion_format_of_path(const char *path)
{
    const char *dot = path != NULL ? strrchr(path, '.') : NULL;

    if (dot == NULL) {
        return GROBO_FORMAT_AUTO;
    }
    for (int format = GROBO_FORMAT_M; format <= GROBO_FORMAT_YAML; format++) {
        if (same_word(dot + 1, grobo_motion_format_name((grobo_motion_format)format))) {
            return (grobo_motion_format)format;
        }
    }
    return same_word(dot + 1, "seq") || same_word(dot + 1, "yml") ? GROBO_FORMAT_YAML
                                                                  : GROBO_FORMAT_AUTO;
}

grobo_motion_kind grobo_motion_format_kind(grobo_motion_format format)
{
    static const grobo_motion_kind kinds[] = {GROBO_MOTION_KEYS, GROBO_MOTION_POSTURES,
                                              GROBO_MOTION_KEYS, GROBO_MOTION_STEPS,
                                              GROBO_MOTION_FRAMES};

    return (unsigned)format < sizeof kinds / sizeof kinds[0] ? kinds[format] : GROBO_MOTION_KEYS;
}

grobo_motion_format grobo_motion_kind_format(grobo_motion_kind kind)
{
    static const grobo_motion_format formats[] = {GROBO_FORMAT_M, GROBO_FORMAT_PSEQ,
                                                  GROBO_FORMAT_MSEQ, GROBO_FORMAT_YAML};

    return (unsigned)kind < sizeof formats / sizeof formats[0] ? formats[kind] : GROBO_FORMAT_AUTO;
}
