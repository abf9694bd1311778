/* SPDX-License-Identifier: MIT */
/* .m: a posture a line. */
#include <math.h>

#include "src/motion/format/write.h"
#include "src/motion/store/columns.h"
#include "src/motion/text/number.h"
#include "src/motion/text/units.h"

/* Largest changes that rounding to whole numbers makes, in the file's units. */
typedef struct rounding {
    double ms, ddeg;
} rounding;

static void put_scaled(grobo_i_out *out, double value, double unit, double units)
{
    out->used +=
        grobo_i_format_scaled(value, unit, units, grobo_i_reserve(out, GROBO_I_NUMBER_BYTES));
}

static void put_whole(grobo_i_out *out, double value, double *change)
{
    double whole = round(value);

    *change = fmax(*change, fabs(value - whole));
    /* Never "-0": the original reads integers. */
    grobo_i_put_number(out, whole == 0 ? 0 : whole);
}

static void put_line(const grobo_i_writing *writing, const grobo_i_row *row, const uint8_t *joints,
                     int columns, rounding *changes)
{
    grobo_i_out *out = writing->out;
    bool integers = !writing->options->exact;

    if (integers) {
        put_whole(out, *row->time_s * GROBO_I_M_SECOND_UNITS, &changes->ms);
    } else {
        put_scaled(out, *row->time_s, GROBO_I_M_SECOND, GROBO_I_M_SECOND_UNITS);
    }
    grobo_i_put(out, " ", 1);
    for (int c = 0; c < columns; c++) {
        int j = joints[c];
        double angle_rad = row->angle_rad[j];
        grobo_i_put(out, " ", 1);
        if (integers) {
            put_whole(out, angle_rad * GROBO_I_M_ANGLE_UNITS / GROBO_I_M_ANGLE, &changes->ddeg);
        } else {
            put_scaled(out, angle_rad, GROBO_I_M_ANGLE, GROBO_I_M_ANGLE_UNITS);
        }
    }
    grobo_i_put(out, "\n", 1);
}

void grobo_i_write_m(const grobo_i_writing *writing, const grobo_motion *motion)
{
    uint8_t joints[GROBO_JOINTS_MAX];
    rounding changes = {0, 0};
    grobo_i_row row;

    int columns = grobo_i_m_columns(motion, writing->options->model, joints);
    for (size_t n = 0; grobo_i_row_at(motion, n, &row) && writing->out->result == 0; n++) {
        put_line(writing, &row, joints, columns, &changes);
    }
    if (changes.ms > 1e-6 || changes.ddeg > 1e-6) {
        char ms[GROBO_I_NUMBER_BYTES], ddeg[GROBO_I_NUMBER_BYTES];
        ms[grobo_i_format_number(round(changes.ms * 1e3) / 1e3, ms)] = '\0';
        ddeg[grobo_i_format_number(round(changes.ddeg * 1e3) / 1e4, ddeg)] = '\0';
        grobo_i_say(writing->list,
                    &(grobo_i_said){writing->options->name, "rounded", 0, 0, GROBO_SEVERITY_NOTE},
                    "rounded to whole milliseconds and 0.1 degrees, by at most %s ms and %s "
                    "degrees",
                    ms, ddeg);
    }
}
