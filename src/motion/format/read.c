/* SPDX-License-Identifier: MIT */
/* From a path, memory or a source to a motion: opens, guesses the format, picks the reader. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/reader.h"

enum { BUFFER_BYTES = 64 * 1024 };

/* ---- input -------------------------------------------------------------------------------- */

int grobo_i_input_fill(grobo_i_input *input)
{
    if (input->first > 0) {
        memmove(input->buffer, input->buffer + input->first, input->last - input->first);
        input->last -= input->first;
        input->first = 0;
    }
    if (input->ended || input->last == input->size) {
        return 0;
    }
    size_t room = input->size - input->last;
    int got = input->source->read(input->source->ctx, input->buffer + input->last, room);
    if (got < 0) {
        return got;
    }
    input->ended = got == 0;
    input->last += (size_t)got;
    input->total_bytes += (uint64_t)got;
    return input->total_bytes > GROBO_FILE_MAX_BYTES ? GROBO_ERR_CAP : got;
}

/* ---- complaints --------------------------------------------------------------------------- */

static void say(grobo_i_reader *reader, const grobo_i_said *said, const char *format, va_list args)
{
    char message[256];

    if (reader->list != NULL) {
        grobo_i_format_message(message, sizeof message, format, args);
        grobo_diagnostics_add(reader->list,
                              &(grobo_diagnostic){reader->file, said->code, message, said->line,
                                                  said->column, said->severity});
    }
}

int grobo_i_refuse(grobo_i_reader *reader, int result, const char *code, grobo_i_place place,
                   const char *format, ...)
{
    va_list args;

    va_start(args, format);
    say(reader, &(grobo_i_said){NULL, code, place.line, place.column, GROBO_SEVERITY_ERROR}, format,
        args);
    va_end(args);
    return result;
}

int grobo_i_complain(grobo_i_reader *reader, int result, const char *code, grobo_i_place place,
                     const char *format, ...)
{
    va_list args;

    va_start(args, format);
    say(reader, &(grobo_i_said){NULL, code, place.line, place.column, GROBO_SEVERITY_ERROR}, format,
        args);
    va_end(args);
    if (reader->result == 0) {
        reader->result = result;
    }
    return reader->options.keep_going ? 0 : result;
}

void grobo_i_warn(grobo_i_reader *reader, const char *code, grobo_i_place place, const char *format,
                  ...)
{
    va_list args;

    va_start(args, format);
    say(reader, &(grobo_i_said){NULL, code, place.line, place.column, GROBO_SEVERITY_WARNING},
        format, args);
    va_end(args);
}

void grobo_i_note(grobo_i_reader *reader, const char *code, grobo_i_place place, const char *format,
                  ...)
{
    va_list args;

    va_start(args, format);
    say(reader, &(grobo_i_said){NULL, code, place.line, place.column, GROBO_SEVERITY_NOTE}, format,
        args);
    va_end(args);
}

/* Places cost more than the angles themselves: later postures of a long file are named by line. */
static int keep_position(grobo_i_reader *reader, const grobo_i_row *row, int joint,
                         grobo_i_place place)
{
    uint8_t n_joints = reader->motion->n_joints;

    if (!reader->options.keep_positions || reader->motion->size > GROBO_MOTION_POSITIONS_MAX) {
        return 0;
    }
    grobo_i_extra *extra = grobo_i_extra_of(reader->mem, row);
    if (extra == NULL) {
        return GROBO_ERR_NOMEM;
    }
    if (extra->positions == NULL) {
        size_t bytes = (size_t)n_joints * 2 * sizeof *extra->positions;
        extra->positions = grobo_i_new(reader->mem, bytes);
        if (extra->positions == NULL) {
            return GROBO_ERR_NOMEM;
        }
        extra->n_positions = n_joints;
    }
    extra->positions[2 * joint] = place.line;
    extra->positions[2 * joint + 1] = place.column;
    return 0;
}

int grobo_i_take_time(grobo_i_reader *reader, double *time_s, double found_s, grobo_i_place place)
{
    bool in_range = found_s >= 0 && found_s <= GROBO_I_TIME_MAX_S;

    *time_s = in_range ? found_s : 0;
    return in_range
               ? 0
               : grobo_i_complain(reader, GROBO_ERR_SYNTAX, "time-range", place,
                                  found_s < 0 ? "a time before 0" : "a time beyond 10^9 seconds");
}

int grobo_i_set_angle(grobo_i_reader *reader, const grobo_i_row *row, int joint, double angle_rad,
                      grobo_i_place place)
{
    int result = 0;

    if (!(fabs(angle_rad) <= GROBO_I_ANGLE_MAX_RAD)) {
        angle_rad = 0;
        result = grobo_i_complain(reader, GROBO_ERR_SYNTAX, "angle-range", place,
                                  "an angle beyond 10^6 radians");
    }
    row->angle_rad[joint] = angle_rad;
    *row->set |= GROBO_JOINT_BIT(joint);
    return result < 0 ? result : keep_position(reader, row, joint, place);
}

/* ---- formats ------------------------------------------------------------------------------ */

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

int grobo_motion_format_find(const char *name)
{
    for (int format = GROBO_FORMAT_AUTO; format <= GROBO_FORMAT_YAML; format++) {
        if (same_word(name, grobo_motion_format_name((grobo_motion_format)format))) {
            return format;
        }
    }
    if (same_word(name, "seq") || same_word(name, "yml")) {
        return GROBO_FORMAT_YAML;
    }
    return GROBO_ERR_NOTFOUND;
}

grobo_motion_format grobo_motion_format_of_path(const char *path)
{
    const char *dot = strrchr(path, '.');
    int format = dot != NULL ? grobo_motion_format_find(dot + 1) : GROBO_FORMAT_AUTO;

    return format > 0 ? (grobo_motion_format)format : GROBO_FORMAT_AUTO;
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

static size_t span(const unsigned char *text, size_t size, size_t first, const char *accepted)
{
    while (first < size && text[first] != '\0' && strchr(accepted, text[first]) != NULL) {
        first++;
    }
    return first;
}

static bool starts_a_number(const unsigned char *text, size_t size, size_t at)
{
    return span(text, size, at, "0123456789+-.") > at;
}

/* Of a .m file the first word that is no comment is a number with another one behind it. */
static bool looks_like_m(const unsigned char *text, size_t size)
{
    size_t i = span(text, size, 0, " \t\r\n");

    while (i < size && text[i] == '#') {
        const unsigned char *newline = memchr(text + i, '\n', size - i);
        i = newline != NULL ? span(text, size, (size_t)(newline - text), " \t\r\n") : size;
    }
    size_t behind = span(text, size, span(text, size, i, "0123456789+-.eE"), " \t");
    return starts_a_number(text, size, i) && starts_a_number(text, size, behind);
}

/* ---- reading ------------------------------------------------------------------------------ */

static int read_as(grobo_i_reader *reader)
{
    grobo_motion_format format = reader->options.format;
    bool forced = format != GROBO_FORMAT_AUTO;
    int got = grobo_i_input_fill(&reader->input);

    if (got < 0) {
        return grobo_i_refuse(reader, got, "read", (grobo_i_place){0, 0}, "%s",
                              grobo_error_text(got));
    }
    if (!forced) {
        format = grobo_motion_format_of_path(reader->file);
    }
    if (format == GROBO_FORMAT_M ||
        (format == GROBO_FORMAT_AUTO && looks_like_m(reader->input.buffer, (size_t)got))) {
        return grobo_i_read_m(reader);
    }
    return grobo_i_read_yaml(reader, format, forced);
}

int grobo_motion_read(const grobo_source *source, const grobo_read_options *options,
                      grobo_diagnostics *list, grobo_motion **motion)
{
    grobo_i_reader reader = {.list = list, .input = {.source = source, .size = BUFFER_BYTES}};

    if (options != NULL) {
        reader.options = *options;
    }
    if (reader.options.format < GROBO_FORMAT_AUTO || reader.options.format > GROBO_FORMAT_YAML) {
        return GROBO_ERR_ARG;
    }
    reader.file = reader.options.name != NULL ? reader.options.name : "";
    reader.mem = reader.options.mem != NULL ? reader.options.mem : grobo_mem_default();
    int result = grobo_motion_new(&reader.motion, GROBO_MOTION_KEYS, 0, reader.mem);
    if (result < 0) {
        return result;
    }
    reader.input.buffer = grobo_i_alloc(reader.mem, BUFFER_BYTES);
    result = reader.input.buffer != NULL ? read_as(&reader) : GROBO_ERR_NOMEM;
    grobo_i_free(reader.mem, reader.input.buffer, BUFFER_BYTES);
    if (result >= 0) {
        result = reader.result;
    }
    if (result < 0) {
        grobo_motion_free(reader.motion);
        return result;
    }
    *motion = reader.motion;
    return 0;
}

typedef struct memory_source {
    const unsigned char *data;
    size_t left;
} memory_source;

static int read_memory(void *ctx, void *buffer, size_t size)
{
    memory_source *memory = ctx;
    size_t count = memory->left < size ? memory->left : size;

    if (count > 0) {
        memcpy(buffer, memory->data, count);
        memory->data += count;
        memory->left -= count;
    }
    return (int)count;
}

int grobo_motion_read_memory(const void *data, size_t size, const grobo_read_options *options,
                             grobo_diagnostics *list, grobo_motion **motion)
{
    memory_source memory = {data, size};

    return grobo_motion_read(&(grobo_source){read_memory, &memory}, options, list, motion);
}

static int error_of_errno(void)
{
    switch (errno) {
    case ENOENT:
    case ENOTDIR:
        return GROBO_ERR_NOENT;
    case EACCES:
    case EPERM:
        return GROBO_ERR_PERM;
    case EISDIR:
        return GROBO_ERR_ISDIR;
    default:
        return GROBO_ERR_IO;
    }
}

static int read_stream(void *ctx, void *buffer, size_t size)
{
    FILE *stream = ctx;
    size_t count = fread(buffer, 1, size, stream);

    return count == 0 && ferror(stream) ? error_of_errno() : (int)count;
}

int grobo_motion_read_file(const char *path, const grobo_read_options *options,
                           grobo_diagnostics *list, grobo_motion **motion)
{
    grobo_read_options named = {.name = path};

    if (options != NULL) {
        named = *options;
        named.name = options->name != NULL ? options->name : path;
    }
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) {
        int result = error_of_errno();
        grobo_i_say(list, &(grobo_i_said){named.name, "open", 0, 0, GROBO_SEVERITY_ERROR}, "%s",
                    result == GROBO_ERR_NOENT ? "no such file" : grobo_error_text(result));
        return result;
    }
    int result = grobo_motion_read(&(grobo_source){read_stream, stream}, &named, list, motion);
    (void)fclose(stream);
    return result;
}
