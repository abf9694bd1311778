/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/reader.h"

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

static void say(grobo_i_reader *reader, grobo_severity severity, const char *code,
                grobo_i_place place, const char *format, va_list args)
{
    char message[256];

    if (reader->list != NULL) {
        grobo_i_format_message(message, sizeof message, format, args);
        grobo_diagnostics_add(
            reader->list,
            &(grobo_diagnostic){reader->file, code, message, place.line, place.column, severity});
    }
}

int grobo_i_refuse(grobo_i_reader *reader, int result, const char *code, grobo_i_place place,
                   const char *format, ...)
{
    va_list args;

    va_start(args, format);
    say(reader, GROBO_SEVERITY_ERROR, code, place, format, args);
    va_end(args);
    return result;
}

int grobo_i_complain(grobo_i_reader *reader, int result, const char *code, grobo_i_place place,
                     const char *format, ...)
{
    va_list args;

    va_start(args, format);
    say(reader, GROBO_SEVERITY_ERROR, code, place, format, args);
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
    say(reader, GROBO_SEVERITY_WARNING, code, place, format, args);
    va_end(args);
}

void grobo_i_note(grobo_i_reader *reader, const char *code, grobo_i_place place, const char *format,
                  ...)
{
    va_list args;

    va_start(args, format);
    say(reader, GROBO_SEVERITY_NOTE, code, place, format, args);
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
