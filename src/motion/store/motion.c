/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "src/base/assert.h"
#include "src/base/memory.h"
#include "src/base/sized.h"
#include "src/motion/store/container.h"
#include "src/motion/text/utf8.h"

/* ---- making and freeing ------------------------------------------------------------------- */

int grobo_motion_new(grobo_motion_kind kind, int n_joints, const grobo_mem *mem,
                     grobo_motion **motion)
{
    if (motion == NULL || kind < GROBO_MOTION_POSTURES || kind > GROBO_MOTION_FRAMES ||
        n_joints < 0) {
        return GROBO_ERR_ARG;
    }
    if (n_joints > GROBO_JOINTS_MAX) {
        return GROBO_ERR_CAP;
    }
    mem = mem != NULL ? mem : grobo_mem_default();
    grobo_motion *made = grobo_i_new(mem, sizeof *made);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->mem = mem;
    made->kind = kind;
    made->n_joints = (uint8_t)n_joints;
    *motion = made;
    return 0;
}

void grobo_motion_free(grobo_motion *motion)
{
    if (motion == NULL) {
        return;
    }
    grobo_motion_clear(motion);
    grobo_i_free_text(motion->mem, motion->name);
    grobo_i_free_text(motion->mem, motion->target_body);
    grobo_i_kept_free(motion->mem, motion->kept);
    grobo_i_free(motion->mem, motion, sizeof *motion);
}

int grobo_i_new_like(const grobo_motion *like, grobo_motion **motion)
{
    grobo_motion *made;
    int result = grobo_motion_new(like->kind, like->n_joints, like->mem, &made);

    if (result < 0) {
        return result;
    }
    made->frame_rate_hz = like->frame_rate_hz;
    made->line_items = like->line_items;
    made->few_columns = like->few_columns;
    made->frame_times = like->frame_times;
    made->reverse = like->reverse;
    result = grobo_motion_set_name(made, grobo_motion_name(like));
    if (result == 0) {
        result = grobo_motion_set_target_body(made, grobo_motion_target_body(like));
    }
    if (result == 0) {
        result = grobo_i_kept_dup(like->mem, like->kept, &made->kept);
    }
    if (result < 0) {
        grobo_motion_free(made);
        return result;
    }
    *motion = made;
    return 0;
}

void grobo_i_swap(grobo_motion *a, grobo_motion *b)
{
    grobo_motion other = *a;

    *a = *b;
    *b = other;
}

void grobo_i_take_rows(grobo_motion *to, grobo_motion *from)
{
    grobo_motion empty = *to;

    GROBO_ASSERT(to->size == 0 && to->mem == from->mem);
    to->chunks = from->chunks;
    to->n_chunks = from->n_chunks;
    to->chunk_room = from->chunk_room;
    to->size = from->size;
    from->chunks = empty.chunks;
    from->n_chunks = empty.n_chunks;
    from->chunk_room = empty.chunk_room;
    from->size = 0;
}

int grobo_motion_dup(const grobo_motion *motion, grobo_motion **copy)
{
    if (motion == NULL || copy == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_motion *made;
    int result = grobo_i_new_like(motion, &made);

    if (result < 0) {
        return result;
    }
    result = grobo_i_copy_rows(made, motion, 0, motion->size, 0);
    if (result < 0) {
        grobo_motion_free(made);
        return result;
    }
    made->place = motion->place;
    *copy = made;
    return 0;
}

void grobo_motion_renew(grobo_motion *motion, grobo_motion_kind kind)
{
    if (motion == NULL) {
        return;
    }
    if ((unsigned)kind > GROBO_MOTION_FRAMES) {
        return;
    }
    grobo_motion_clear(motion);
    grobo_i_free_text(motion->mem, motion->name);
    grobo_i_free_text(motion->mem, motion->target_body);
    grobo_i_kept_free(motion->mem, motion->kept);
    motion->name = motion->target_body = NULL;
    motion->few_columns = false;
    motion->kept = NULL;
    motion->frame_rate_hz = 0;
    motion->line_items = 0;
    motion->frame_times = motion->reverse = false;
    motion->kind = kind;
}

/* ---- the robot it is for ------------------------------------------------------------------ */

/* Is that the model's name, or that of one with the same joints? */
static bool names(const char *body, const grobo_model *model)
{
    bool same = strcmp(body, model->name) == 0;

    const char *const *alike = GROBO_I_MEMBER(model, model->size, alike);

    for (size_t i = 0; !same && alike != NULL && alike[i] != NULL; i++) {
        same = strcmp(body, alike[i]) == 0;
    }
    return same;
}

bool grobo_i_is_named_for(const grobo_motion *motion, const grobo_model *model)
{
    const char *body = grobo_motion_target_body(motion);

    return body[0] == '\0' || strcmp(body, "SerialRobot") == 0 || names(body, model);
}

/* Key poses number their joints; rows of angles are of all joints, of which the robot is not named:
 * a row of six on a robot of twenty would move its first six joints. */
static bool has_other_rows(const grobo_motion *motion, const grobo_model *model)
{
    bool rows = motion->kind == GROBO_MOTION_FRAMES || motion->kind == GROBO_MOTION_POSTURES;

    return rows && motion->size > 0 &&
           (motion->few_columns || motion->n_joints != model->n_joints) &&
           !names(grobo_motion_target_body(motion), model);
}

bool grobo_i_has_joints_of(const grobo_motion *motion, const grobo_model *model)
{
    return motion != NULL && model != NULL && motion->n_joints <= model->n_joints &&
           grobo_i_is_named_for(motion, model);
}

bool grobo_motion_is_for(const grobo_motion *motion, const grobo_model *model)
{
    return grobo_i_has_joints_of(motion, model) && !has_other_rows(motion, model);
}

void grobo_motion_start(const grobo_motion *motion, const grobo_model *model, grobo_posture *start)
{
    if (motion == NULL || start == NULL) {
        return;
    }
    if (grobo_i_has_joints_of(motion, model)) {
        grobo_posture_init_pose(start, model);
    } else {
        (void)grobo_posture_init(start, motion->n_joints);
        start->set = GROBO_JOINTS_ALL(motion->n_joints);
    }
}

void grobo_i_start(const grobo_motion *motion, const grobo_model *model, const grobo_posture *given,
                   grobo_posture *start)
{
    if (given != NULL) {
        *start = *given;
    } else {
        grobo_motion_start(motion, model, start);
    }
}

/* ---- the motion itself -------------------------------------------------------------------- */

size_t grobo_motion_size(const grobo_motion *motion)
{
    return motion == NULL ? 0 : motion->size;
}

grobo_motion_kind grobo_motion_get_kind(const grobo_motion *motion)
{
    return motion == NULL ? GROBO_MOTION_POSTURES : motion->kind;
}

int grobo_motion_joints(const grobo_motion *motion)
{
    return motion == NULL ? GROBO_ERR_ARG : motion->n_joints;
}

int grobo_motion_set_joints(grobo_motion *motion, int n_joints)
{
    if (motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_row row;

    if (n_joints < 0) {
        return GROBO_ERR_ARG;
    }
    if (n_joints > GROBO_JOINTS_MAX) {
        return GROBO_ERR_CAP;
    }
    if (n_joints < motion->n_joints) {
        for (size_t n = 0; grobo_i_row_at(motion, n, &row); n++) {
            *row.set &= GROBO_JOINTS_ALL(n_joints);
        }
    }
    motion->n_joints = (uint8_t)n_joints;
    return n_joints;
}

static int set_text(const grobo_mem *mem, char **text, const char *value)
{
    size_t length = strlen(value);

    if (!grobo_i_utf8_ok(value, length)) {
        return GROBO_ERR_ARG;
    }
    if (length >= GROBO_YAML_SCALAR_MAX_BYTES) {
        return GROBO_ERR_CAP;
    }
    char *copy = grobo_i_copy_text(mem, value, length);
    if (copy == NULL) {
        return GROBO_ERR_NOMEM;
    }
    grobo_i_free_text(mem, *text);
    *text = copy;
    return 0;
}

const char *grobo_motion_name(const grobo_motion *motion)
{
    if (motion == NULL) {
        return NULL;
    }
    return motion->name != NULL ? motion->name : "";
}

int grobo_motion_set_name(grobo_motion *motion, const char *name)
{
    return motion == NULL || name == NULL ? GROBO_ERR_ARG
                                          : set_text(motion->mem, &motion->name, name);
}

const char *grobo_motion_target_body(const grobo_motion *motion)
{
    if (motion == NULL) {
        return NULL;
    }
    return motion->target_body != NULL ? motion->target_body : "";
}

int grobo_motion_set_target_body(grobo_motion *motion, const char *name)
{
    return motion == NULL || name == NULL ? GROBO_ERR_ARG
                                          : set_text(motion->mem, &motion->target_body, name);
}

double grobo_motion_frame_rate(const grobo_motion *motion)
{
    return motion == NULL ? 0 : motion->frame_rate_hz;
}

int grobo_motion_set_frame_rate(grobo_motion *motion, double rate_hz)
{
    if (motion == NULL) {
        return GROBO_ERR_ARG;
    }
    /* Slower than this, and times would not stay within GROBO_I_TIME_MAX_S. */
    double least_hz = GROBO_MOTION_FRAMES_MAX / GROBO_I_TIME_MAX_S;

    if (motion->kind != GROBO_MOTION_FRAMES || !isfinite(rate_hz) || !(rate_hz >= least_hz)) {
        return GROBO_ERR_ARG;
    }
    motion->frame_rate_hz = rate_hz;
    return 0;
}

bool grobo_motion_has_frame_times(const grobo_motion *motion)
{
    return motion != NULL && motion->frame_times;
}

int grobo_motion_set_frame_times(grobo_motion *motion, bool own)
{
    if (motion == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_row row;

    if (motion->kind != GROBO_MOTION_FRAMES) {
        return GROBO_ERR_ARG;
    }
    if (own && !motion->frame_times) {
        for (size_t n = 0; grobo_i_row_at(motion, n, &row); n++) {
            *row.time_s = grobo_i_time_s(motion, n);
        }
    }
    motion->frame_times = own;
    return 0;
}

/* ---- reading postures --------------------------------------------------------------------- */

int grobo_motion_get(const grobo_motion *motion, size_t n, grobo_posture *posture)
{
    if (motion == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row)) {
        return GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(posture, motion->n_joints);
    for (int j = 0; j < motion->n_joints && j < row.width; j++) {
        if (*row.set & GROBO_JOINT_BIT(j)) {
            posture->angle_rad[j] = row.angle_rad[j];
        }
    }
    posture->set = *row.set;
    posture->time_us = grobo_motion_step_us(motion, n);
    return 0;
}

int grobo_motion_rget(const grobo_motion *motion, size_t n, grobo_posture *posture)
{
    if (motion == NULL || n == 0 || n > motion->size) {
        return GROBO_ERR_ARG;
    }
    return grobo_motion_get(motion, motion->size - n, posture);
}

int grobo_motion_time_s(const grobo_motion *motion, size_t n, double *time_s)
{
    if (motion == NULL || time_s == NULL || n >= motion->size) {
        return GROBO_ERR_ARG;
    }
    *time_s = grobo_i_time_s(motion, n);
    return 0;
}

int64_t grobo_motion_step_us(const grobo_motion *motion, size_t n)
{
    if (motion == NULL) {
        return 0;
    }
    if (n >= motion->size) {
        return GROBO_ERR_ARG;
    }
    double from_s = n > 0 ? grobo_i_time_s(motion, n - 1) : 0;
    return grobo_i_step_us(motion->kind, from_s, grobo_i_time_s(motion, n));
}

int64_t grobo_motion_length_us(const grobo_motion *motion, int64_t default_us)
{
    if (motion == NULL) {
        return 0;
    }
    int64_t length_us = 0;

    if (motion->size == 0) {
        return 0;
    }
    if (motion->kind == GROBO_MOTION_KEYS || motion->kind == GROBO_MOTION_FRAMES) {
        return grobo_i_us_from_s(grobo_i_time_s(motion, motion->size - 1));
    }
    default_us = default_us < 0 ? GROBO_MOTION_DEFAULT_US : default_us;
    for (size_t n = 0; n < motion->size; n++) {
        int64_t step_us = grobo_motion_step_us(motion, n);

        step_us = grobo_i_takes_default(motion, n) ? default_us : step_us;
        length_us = step_us > INT64_MAX - length_us ? INT64_MAX : length_us + step_us;
    }
    return length_us;
}

uint32_t grobo_motion_line(const grobo_motion *motion, size_t n)
{
    if (motion == NULL) {
        return 0;
    }
    grobo_i_row row;

    return grobo_i_row_at(motion, n, &row) ? *row.line : 0;
}

bool grobo_motion_position(const grobo_motion *motion, size_t n, int joint, uint32_t *line,
                           uint32_t *column)
{
    if (motion == NULL || line == NULL || column == NULL) {
        return false;
    }
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row) || *row.extra == NULL || joint < 0 ||
        joint >= (*row.extra)->n_positions || (*row.extra)->positions[2 * joint] == 0) {
        return false;
    }
    *line = (*row.extra)->positions[2 * joint];
    *column = (*row.extra)->positions[2 * joint + 1];
    return true;
}

/* ---- walking through ---------------------------------------------------------------------- */

bool grobo_motion_set_reverse(grobo_motion *motion, bool reverse)
{
    if (motion == NULL) {
        return false;
    }
    motion->reverse = reverse;
    return reverse;
}

bool grobo_motion_is_reverse(const grobo_motion *motion)
{
    return motion != NULL && motion->reverse;
}

void grobo_motion_reset(grobo_motion *motion)
{
    if (motion != NULL) {
        /* Of an empty motion the last is SIZE_MAX: behind the end, as it must be. */
        motion->place = motion->reverse ? motion->size - 1 : 0;
    }
}

size_t grobo_motion_current(const grobo_motion *motion)
{
    return motion == NULL ? 0 : motion->place;
}

int grobo_motion_next(grobo_motion *motion, grobo_posture *posture)
{
    if (posture == NULL || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    if (grobo_motion_get(motion, motion->place, posture) < 0) {
        return 0;
    }
    /* Below 0 is SIZE_MAX. */
    motion->place += motion->reverse ? SIZE_MAX : 1;
    return 1;
}
