/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/store/container.h"

enum {
    CHUNK_BYTES = 32 * 1024, /* large enough for small overhead, small enough to move about */
    FIRST_ROWS = 16,         /* of the first chunk: most motions are small */
    ROWS_MIN = 16
};

static size_t row_bytes(size_t width)
{
    return width * sizeof(double) + sizeof(double) + sizeof(grobo_joint_mask) +
           sizeof(grobo_i_extra *) + sizeof(uint32_t);
}

static size_t chunk_bytes(const grobo_i_chunk *chunk)
{
    return row_bytes(chunk->width) * chunk->capacity;
}

/* Rows of the next chunk: doubling from a small one up to the chunk size. */
static size_t next_capacity(const grobo_motion *motion)
{
    size_t most = CHUNK_BYTES / row_bytes(motion->n_joints);
    size_t rows = motion->n_chunks < 8 ? (size_t)FIRST_ROWS << motion->n_chunks : most;

    most = most < ROWS_MIN ? ROWS_MIN : most;
    return rows < most ? rows : most;
}

/* Every column starts aligned: the widest come first, and all but the last have 8-byte items. */
static int chunk_init(const grobo_mem *mem, grobo_i_chunk *chunk, uint8_t width, size_t capacity)
{
    grobo_i_chunk made = {.capacity = capacity, .width = width};

    made.angle_rad = grobo_i_alloc(mem, chunk_bytes(&made));
    if (made.angle_rad == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made.time_s = made.angle_rad + capacity * width;
    made.set = (grobo_joint_mask *)(void *)(made.time_s + capacity);
    made.extra = (grobo_i_extra **)(void *)(made.set + capacity);
    made.line = (uint32_t *)(void *)(made.extra + capacity);
    *chunk = made;
    return 0;
}

static void chunk_free(const grobo_mem *mem, grobo_i_chunk *chunk)
{
    grobo_i_free(mem, chunk->angle_rad, chunk_bytes(chunk));
}

static void row_of(const grobo_i_chunk *chunk, size_t i, grobo_i_row *row)
{
    row->time_s = chunk->time_s + i;
    row->set = chunk->set + i;
    row->extra = chunk->extra + i;
    row->line = chunk->line + i;
    row->angle_rad = chunk->angle_rad + i * chunk->width;
    row->width = chunk->width;
}

/* Moves count rows within a chunk. */
static void move_rows(grobo_i_chunk *chunk, size_t to, size_t from, size_t count)
{
    size_t width = chunk->width;

    memmove(chunk->angle_rad + to * width, chunk->angle_rad + from * width,
            count * width * sizeof(double));
    memmove(chunk->time_s + to, chunk->time_s + from, count * sizeof *chunk->time_s);
    memmove(chunk->set + to, chunk->set + from, count * sizeof *chunk->set);
    memmove(chunk->extra + to, chunk->extra + from, count * sizeof *chunk->extra);
    memmove(chunk->line + to, chunk->line + from, count * sizeof *chunk->line);
}

/* Moves rows first.. of a chunk to the start of another that is empty, as wide as the motion. */
static void move_tail(grobo_i_chunk *to, grobo_i_chunk *from, size_t first)
{
    size_t count = from->count - first;
    size_t width = to->width < from->width ? to->width : from->width;

    for (size_t i = 0; i < count; i++) {
        memcpy(to->angle_rad + i * to->width, from->angle_rad + (first + i) * from->width,
               width * sizeof(double));
    }
    memcpy(to->time_s, from->time_s + first, count * sizeof *to->time_s);
    memcpy(to->set, from->set + first, count * sizeof *to->set);
    memcpy(to->extra, from->extra + first, count * sizeof *to->extra);
    memcpy(to->line, from->line + first, count * sizeof *to->line);
    to->count = count;
    from->count = first;
}

/* The chunk that holds row n, 0 <= n < size. */
static size_t chunk_holding(const grobo_motion *motion, size_t n)
{
    size_t low = 0, high = motion->n_chunks - 1;

    if (n >= motion->chunks[high].start) {
        return high;
    }
    while (low < high) {
        size_t middle = (low + high + 1) / 2;
        if (motion->chunks[middle].start <= n) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    return low;
}

bool grobo_i_row_at(const grobo_motion *motion, size_t n, grobo_i_row *row)
{
    if (n >= motion->size) {
        return false;
    }
    const grobo_i_chunk *chunk = &motion->chunks[chunk_holding(motion, n)];
    row_of(chunk, n - chunk->start, row);
    return true;
}

static int widen(grobo_motion *motion, grobo_i_chunk *chunk)
{
    grobo_i_chunk wide;

    if (chunk->width >= motion->n_joints) {
        return 0;
    }
    int result = chunk_init(motion->mem, &wide, motion->n_joints, chunk->capacity);
    if (result < 0) {
        return result;
    }
    size_t count = chunk->count;
    move_tail(&wide, chunk, 0);
    chunk->count = count;
    wide.start = chunk->start;
    chunk_free(motion->mem, chunk);
    *chunk = wide;
    return 0;
}

int grobo_i_row_wide(grobo_motion *motion, size_t n, grobo_i_row *row)
{
    if (n >= motion->size) {
        return GROBO_ERR_ARG;
    }
    grobo_i_chunk *chunk = &motion->chunks[chunk_holding(motion, n)];
    int result = widen(motion, chunk);
    if (result == 0) {
        row_of(chunk, n - chunk->start, row);
    }
    return result;
}

/* Makes room for one more entry of the table. */
static int grow_table(grobo_motion *motion)
{
    if (motion->n_chunks < motion->chunk_room) {
        return 0;
    }
    size_t room = motion->chunk_room == 0 ? 4 : motion->chunk_room * 2;
    grobo_i_chunk *chunks =
        motion->mem->resize(motion->mem->ctx, motion->chunks, motion->chunk_room * sizeof *chunks,
                            room * sizeof *chunks);
    if (chunks == NULL) {
        return GROBO_ERR_NOMEM;
    }
    motion->chunks = chunks;
    motion->chunk_room = room;
    return 0;
}

/* Puts an empty chunk of the motion's width before chunk `at`. */
static int insert_chunk(grobo_motion *motion, size_t at, size_t capacity)
{
    grobo_i_chunk chunk;
    int result = grow_table(motion);

    if (result == 0) {
        result = chunk_init(motion->mem, &chunk, motion->n_joints, capacity);
    }
    if (result < 0) {
        return result;
    }
    memmove(motion->chunks + at + 1, motion->chunks + at,
            (motion->n_chunks - at) * sizeof *motion->chunks);
    motion->chunks[at] = chunk;
    motion->n_chunks++;
    return 0;
}

/* A chunk with room for a row before row n, and where in it. */
static int make_room(grobo_motion *motion, size_t n, size_t *at)
{
    bool append = n == motion->size;
    size_t last = motion->n_chunks - 1; /* meaningless without chunks */

    if (motion->n_chunks == 0 ||
        (append && motion->chunks[last].count == motion->chunks[last].capacity)) {
        int result = insert_chunk(motion, motion->n_chunks, next_capacity(motion));
        if (result == 0) {
            *at = motion->n_chunks - 1;
            motion->chunks[*at].start = motion->size;
        }
        return result;
    }
    *at = append ? last : chunk_holding(motion, n);
    grobo_i_chunk *chunk = &motion->chunks[*at];
    if (chunk->count < chunk->capacity) {
        return widen(motion, chunk);
    }
    /* Full and in the middle: its upper half moves to a new chunk behind it. */
    int result = widen(motion, chunk);
    if (result == 0) {
        result = insert_chunk(motion, *at + 1, chunk->capacity);
    }
    if (result < 0) {
        return result;
    }
    chunk = &motion->chunks[*at];
    move_tail(chunk + 1, chunk, chunk->count / 2);
    chunk[1].start = chunk->start + chunk->count;
    *at += n > chunk[1].start;
    return 0;
}

int grobo_i_row_insert(grobo_motion *motion, size_t n, grobo_i_row *row)
{
    size_t at = 0;

    if (n > motion->size) {
        return GROBO_ERR_ARG;
    }
    if (motion->size >= GROBO_MOTION_FRAMES_MAX) {
        return GROBO_ERR_CAP;
    }
    int result = make_room(motion, n, &at);
    if (result < 0) {
        return result;
    }
    grobo_i_chunk *chunk = &motion->chunks[at];
    size_t i = n - chunk->start;
    if (i < chunk->count) {
        move_rows(chunk, i + 1, i, chunk->count - i);
    }
    chunk->count++;
    motion->size++;
    for (size_t k = at + 1; k < motion->n_chunks; k++) {
        motion->chunks[k].start++;
    }
    row_of(chunk, i, row);
    *row->time_s = 0;
    *row->set = 0;
    *row->extra = NULL;
    *row->line = 0;
    return 0;
}

void grobo_i_row_remove(grobo_motion *motion, size_t n)
{
    size_t at = chunk_holding(motion, n);
    grobo_i_chunk *chunk = &motion->chunks[at];
    size_t i = n - chunk->start;

    grobo_i_extra_free(motion->mem, chunk->extra[i]);
    move_rows(chunk, i, i + 1, chunk->count - i - 1);
    chunk->count--;
    motion->size--;
    for (size_t k = at + 1; k < motion->n_chunks; k++) {
        motion->chunks[k].start--;
    }
    if (chunk->count == 0) {
        chunk_free(motion->mem, chunk);
        memmove(chunk, chunk + 1, (motion->n_chunks - at - 1) * sizeof *chunk);
        motion->n_chunks--;
    }
}

void grobo_motion_clear(grobo_motion *motion)
{
    if (motion == NULL) {
        return;
    }
    for (size_t k = 0; k < motion->n_chunks; k++) {
        for (size_t i = 0; i < motion->chunks[k].count; i++) {
            grobo_i_extra_free(motion->mem, motion->chunks[k].extra[i]);
        }
        chunk_free(motion->mem, &motion->chunks[k]);
    }
    grobo_i_free(motion->mem, motion->chunks, motion->chunk_room * sizeof *motion->chunks);
    motion->chunks = NULL;
    motion->n_chunks = motion->chunk_room = motion->size = motion->place = 0;
    if (motion->kind == GROBO_MOTION_STEPS) {
        motion->kind = GROBO_MOTION_POSTURES;
    }
}

/* ---- times -------------------------------------------------------------------------------- */

bool grobo_i_at_rate(const grobo_motion *motion)
{
    return motion->kind == GROBO_MOTION_FRAMES && !motion->frame_times;
}

double grobo_i_time_s(const grobo_motion *motion, size_t n)
{
    grobo_i_row row;

    if (grobo_i_at_rate(motion)) {
        return motion->frame_rate_hz > 0 ? (double)n / motion->frame_rate_hz : 0;
    }
    return grobo_i_row_at(motion, n, &row) ? *row.time_s : 0;
}

int64_t grobo_i_us_from_s(double time_s)
{
    return (int64_t)llround(time_s * 1e6);
}

int64_t grobo_i_step_us(grobo_motion_kind kind, double from_s, double to_s)
{
    int64_t step_us = grobo_i_us_from_s(to_s) - grobo_i_us_from_s(from_s);
    bool defaults = kind == GROBO_MOTION_POSTURES || kind == GROBO_MOTION_STEPS;

    return step_us <= 0 || (defaults && step_us >= GROBO_MOTION_STEP_MAX_US) ? 0 : step_us;
}

bool grobo_i_takes_default(const grobo_motion *motion, size_t n)
{
    if (motion->kind == GROBO_MOTION_KEYS || motion->kind == GROBO_MOTION_FRAMES) {
        return false;
    }
    double from_s = n > 0 ? grobo_i_time_s(motion, n - 1) : 0, to_s = grobo_i_time_s(motion, n);
    bool begins = n == 0 && to_s == 0;
    return !begins && grobo_i_step_us(motion->kind, from_s, to_s) == 0;
}

void grobo_i_shift_times(grobo_motion *motion, size_t first, double shift_s)
{
    grobo_i_row row;

    for (size_t n = first; grobo_i_row_at(motion, n, &row); n++) {
        *row.time_s += shift_s;
    }
}
