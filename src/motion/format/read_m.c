/* SPDX-License-Identifier: MIT */
/* .m: a posture a line, "ms a1 .. an", in 0.1 degree and the order of the motors. */
#include <math.h>
#include <string.h>

#include "src/motion/format/read.h"
#include "src/motion/store/columns.h"
#include "src/motion/text/number.h"
#include "src/motion/text/units.h"

enum { COLUMNS_MAX = GROBO_JOINTS_MAX };

typedef struct m_file {
    grobo_i_reader *reader;
    uint32_t line;
    uint32_t blank; /* the first blank line since the last posture, 0 none */
    int columns;    /* angles of each line, -1 before the first */
    uint8_t joints[COLUMNS_MAX];
} m_file;

/* One line taken apart. */
typedef struct m_line {
    double values[1 + COLUMNS_MAX];
    uint32_t column[1 + COLUMNS_MAX];
    int count;
} m_line;

static bool is_blank(unsigned char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* The first posture decides how many angles all have, and whose they are. */
static int set_columns(m_file *file, int columns)
{
    grobo_i_reader *reader = file->reader;
    const grobo_model *model = reader->options.model;
    grobo_i_place place = {file->line, 0};
    bool by_motor = grobo_i_motor_order(model, columns, file->joints);

    file->columns = columns;
    if (by_motor && columns < model->n_joints) {
        reader->motion->few_columns = true;
        grobo_i_warn(reader, "columns", place, "%d angles for the %d motors of %s", columns,
                     model->n_joints, model->name);
    } else if (model != NULL && !by_motor) {
        grobo_i_warn(reader, "columns", place,
                     "%d angles for the %d motors of %s: taken in the order of joints", columns,
                     model->n_joints, model->name);
    }
    int result = grobo_motion_set_joints(reader->motion, by_motor ? model->n_joints : columns);
    return result < 0 ? result : 0;
}

static int complain_columns(const m_file *file, const m_line *line)
{
    grobo_i_place place = {file->line, line->column[line->count - 1]};

    if (line->count - 1 < 1) {
        return grobo_i_complain(file->reader, GROBO_ERR_SYNTAX, "columns", place,
                                "a time without angles");
    }
    return grobo_i_complain(file->reader, GROBO_ERR_SYNTAX, "columns", place,
                            "%d angles where the lines before have %d", line->count - 1,
                            file->columns);
}

static int add_posture(m_file *file, const m_line *line)
{
    grobo_motion *motion = file->reader->motion;
    grobo_i_row row;

    if (file->columns < 0 && line->count > 1) {
        int result = set_columns(file, line->count - 1);
        if (result < 0) {
            return result;
        }
    }
    if (line->count - 1 != file->columns) {
        return complain_columns(file, line);
    }
    if (fabs(line->values[0]) > GROBO_I_TIME_MAX_S * 1000) {
        return grobo_i_complain(file->reader, GROBO_ERR_SYNTAX, "time-range",
                                (grobo_i_place){file->line, line->column[0]},
                                "a time beyond 10^9 seconds");
    }
    int result = grobo_i_row_insert(motion, motion->size, &row);
    if (result < 0) {
        return result;
    }
    *row.time_s = line->values[0] * GROBO_I_M_SECOND / GROBO_I_M_SECOND_UNITS;
    *row.line = file->line;
    for (int c = 0; c < file->columns && result == 0; c++) {
        int joint = file->joints[c];
        double angle_rad = line->values[1 + c] * GROBO_I_M_ANGLE / GROBO_I_M_ANGLE_UNITS;
        result = grobo_i_set_angle(file->reader, &row, joint, angle_rad,
                                   (grobo_i_place){file->line, line->column[1 + c]});
    }
    return result;
}

/* @return 1: line is filled; 0: blank or a comment, or a complaint; or an error. */
static int take_apart(m_file *file, const unsigned char *text, size_t length, m_line *line)
{
    line->count = 0;
    for (size_t i = 0; i < length;) {
        if (is_blank(text[i])) {
            i++;
            continue;
        }
        size_t first = i;
        grobo_i_place place = {file->line, (uint32_t)first + 1};
        while (i < length && !is_blank(text[i])) {
            i++;
        }
        if (line->count == 0 && text[first] == '#') {
            return 0;
        }
        if (first > 0 && text[first - 1] == '\r') { /* two lines of an old Macintosh, not one */
            return grobo_i_complain(file->reader, GROBO_ERR_SYNTAX, "line-end", place,
                                    "a line must end with LF or CRLF, not CR alone");
        }
        if (line->count > COLUMNS_MAX) {
            return grobo_i_refuse(file->reader, GROBO_ERR_CAP, "columns", place,
                                  "more than %d angles", COLUMNS_MAX);
        }
        if (!grobo_i_parse_number((const char *)text + first, i - first,
                                  &line->values[line->count])) {
            int shown = i - first < 32 ? (int)(i - first) : 32;
            return grobo_i_complain(file->reader, GROBO_ERR_SYNTAX, "number", place,
                                    "'%.*s' is not a number", shown, (const char *)text + first);
        }
        line->column[line->count++] = place.column;
    }
    if (line->count == 0 && file->blank == 0) {
        file->blank = file->line;
    }
    return line->count > 0;
}

static int read_line(m_file *file, const unsigned char *text, size_t length)
{
    m_line line;

    file->line++;
    if (file->line == 1 && length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) {
        text += 3;
        length -= 3;
    }
    int result = take_apart(file, text, length, &line);
    if (result <= 0) {
        return result;
    }
    if (file->blank != 0) {
        grobo_i_place place = {file->blank, 0};
        file->blank = 0;
        result = grobo_i_complain(file->reader, GROBO_ERR_SYNTAX, "blank-line", place,
                                  "a blank line with postures behind it");
        if (result < 0) {
            return result;
        }
    }
    return add_posture(file, &line);
}

/* All whole lines of the buffer, and at the end of the file what is left. */
static int read_lines(m_file *file, grobo_i_input *input)
{
    int result = 0;

    while (result == 0 && input->first < input->last) {
        const unsigned char *text = input->buffer + input->first;
        size_t there = input->last - input->first;
        const unsigned char *newline = memchr(text, '\n', there);
        size_t length = newline != NULL ? (size_t)(newline - text) : there;
        if (length > GROBO_M_LINE_MAX_BYTES) {
            return grobo_i_refuse(file->reader, GROBO_ERR_CAP, "line-length",
                                  (grobo_i_place){file->line + 1, 0}, "longer than %d bytes",
                                  GROBO_M_LINE_MAX_BYTES);
        }
        if (newline == NULL && !input->ended) {
            return 0;
        }
        input->first += length + (newline != NULL);
        result = read_line(file, text, length);
    }
    return result;
}

int grobo_i_read_m(grobo_i_reader *reader)
{
    m_file file = {.reader = reader, .columns = -1};
    grobo_i_input *input = &reader->input;
    int result;

    reader->motion->kind = GROBO_MOTION_POSTURES;
    for (;;) {
        result = read_lines(&file, input);
        if (result < 0 || input->ended) {
            break;
        }
        result = grobo_i_input_fill(input);
        if (result < 0) {
            return grobo_i_refuse(reader, result, "read", (grobo_i_place){file.line, 0}, "%s",
                                  grobo_error_text(result));
        }
    }
    return result;
}

/* ---- what it looks like ------------------------------------------------------------------- */

static size_t span_of(const unsigned char *text, size_t size, size_t first, const char *accepted)
{
    while (first < size && text[first] != '\0' && strchr(accepted, text[first]) != NULL) {
        first++;
    }
    return first;
}

static bool starts_a_number(const unsigned char *text, size_t size, size_t at)
{
    return span_of(text, size, at, "0123456789+-.") > at;
}

bool grobo_i_sniff_m(const unsigned char *text, size_t size)
{
    bool marked = size >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0;
    size_t i = span_of(text, size, marked ? 3 : 0, " \t\r\n");

    while (i < size && text[i] == '#') {
        const unsigned char *newline = memchr(text + i, '\n', size - i);
        i = newline != NULL ? span_of(text, size, (size_t)(newline - text), " \t\r\n") : size;
    }
    size_t behind = span_of(text, size, span_of(text, size, i, "0123456789+-.eE"), " \t");
    return starts_a_number(text, size, i) && starts_a_number(text, size, behind);
}
