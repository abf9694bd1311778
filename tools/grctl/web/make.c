/* SPDX-License-Identifier: MIT */
#include "tools/grctl/play/play.h"
#include "tools/grctl/web/edit.h"
#include "tools/grctl/web/library.h"
#include "tools/grctl/web/make.h"

/* Frames of many hours: refused before there is memory for them. A number has 2 bytes at least. */
static bool is_too_long(const grobo_motion *motion, grobo_motion_format format)
{
    double length_s = (double)grobo_motion_length_us(motion, -1) / 1e6;
    return format == GROBO_FORMAT_YAML && grobo_motion_get_kind(motion) != GROBO_MOTION_FRAMES &&
           length_s * GROBO_MOTION_RATE_HZ * 2 * grobo_motion_joints(motion) > LIBRARY_FILE_BYTES;
}

/* Targets of legs become angles, where the format has no place for them. 0 or the status. */
static int solve_legs(app *a, const char *name, grobo_motion_format format,
                      const grobo_motion *motion, grobo_motion **solved)
{
    double rate_hz = format == GROBO_FORMAT_YAML ? GROBO_MOTION_RATE_HZ : 0;
    grobo_body *body = NULL;
    if (format == GROBO_FORMAT_PSEQ) {
        return 0;
    }
    int status = body_make(a, PLAY_BODY, name, motion, rate_hz, &body);
    if (!status && body) {
        status = body_motion(a, name, body, rate_hz, solved);
    }
    grobo_body_free(body);
    if (*solved) {
        (void)grobo_motion_set_name(*solved, grobo_motion_name(motion));
        (void)grobo_motion_set_target_body(*solved, grobo_motion_target_body(motion));
    }
    return status;
}

int make_write(app *a, const char *name, const grobo_motion *motion, grobo_diagnostics *lost,
               char **bytes, size_t *size)
{
    grobo_motion_format format = grobo_motion_format_of_path(name);
    grobo_motion *solved = NULL;
    int error = GROBO_OK;
    if (is_too_long(motion, format)) {
        error = GROBO_ERR_CAP;
    } else if (solve_legs(a, name, format, motion, &solved)) {
        error = GROBO_ERR_UNREACHABLE;
    } else {
        error = edit_write(solved ? solved : motion, format, app_model(a), lost, bytes, size);
    }
    grobo_motion_free(solved);
    return error;
}
