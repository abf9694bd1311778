/* SPDX-License-Identifier: MIT */
/*
 * How a motion is stored, for the files of this folder.
 *
 * Rows (a key's time, set joints, angles) stand in chunks of some 32 KiB; the table of chunks is
 * the only thing that is moved when a motion grows. A chunk has its own width in joints, so that
 * a motion that gets more joints need not be copied. What only key poses have hangs on a row.
 */
#ifndef GROBO_MOTION_CONTAINER_H
#define GROBO_MOTION_CONTAINER_H

#include <grobo/core/motion.h>

/* Latest time of a posture, either way: far beyond use, and exact in microseconds. */
#define GROBO_I_TIME_MAX_S 1e9

/* Largest angle or increment, either way: some 160,000 turns. Sums of a whole file stay finite. */
#define GROBO_I_ANGLE_MAX_RAD 1e6

/* Joints in a line of a key pose: Choreonoid's, and that before 1.5, whose line break counted. */
#define GROBO_I_LINE_ITEMS 10
#define GROBO_I_LINE_ITEMS_OLD 9

typedef struct grobo_i_kept {
    struct grobo_i_kept *next;
    size_t key_bytes;   /* with the NUL */
    size_t value_bytes; /* with the NUL */
    grobo_kept_level level;
    uint8_t link;
    char text[]; /* key, NUL, value, NUL */
} grobo_i_kept;

typedef struct grobo_i_extra {
    grobo_key_info info;
    grobo_ik_link *links;
    grobo_i_kept *kept;
    char *name;
    uint32_t *positions; /* line, column of each joint's angle; NULL if not kept */
    uint8_t n_links;
    uint8_t n_positions; /* joints */
} grobo_i_extra;

typedef struct grobo_i_chunk {
    size_t start; /* number of its first row */
    size_t count, capacity;
    uint8_t width;     /* joints a row has room for */
    double *angle_rad; /* the block: width * capacity, then the other columns */
    double *time_s;
    grobo_joint_mask *set;
    grobo_i_extra **extra;
    uint32_t *line;
} grobo_i_chunk;

struct grobo_motion {
    const grobo_mem *mem;
    grobo_i_chunk *chunks;
    size_t n_chunks, chunk_room;
    size_t size;
    size_t place;
    double frame_rate_hz;
    char *name;
    char *target_body;
    grobo_i_kept *kept;
    grobo_motion_kind kind;
    uint8_t n_joints;
    uint8_t line_items; /* joints that a line of .pseq has */
    bool few_columns;   /* its lines of .m had fewer angles than the robot has motors */
    bool frame_times;
    bool reverse;
};

/* One row: pointers into its chunk, valid until rows come or go. */
typedef struct grobo_i_row {
    double *time_s;
    grobo_joint_mask *set;
    grobo_i_extra **extra;
    uint32_t *line;
    double *angle_rad; /* at least n_joints of the motion after grobo_i_row_wide() */
    uint8_t width;
} grobo_i_row;

/* ---- rows ---- */
bool grobo_i_row_at(const grobo_motion *motion, size_t n, grobo_i_row *row);
/* As grobo_i_row_at(), and its chunk is made wide enough for n_joints of the motion. */
int grobo_i_row_wide(grobo_motion *motion, size_t n, grobo_i_row *row);
/* Inserts a row before row n: time 0, nothing set, no extra. */
int grobo_i_row_insert(grobo_motion *motion, size_t n, grobo_i_row *row);
/* Moves time, angles and extra of a row to a fresh row of another motion of the same allocator. */
void grobo_i_move_row(const grobo_i_row *to, const grobo_i_row *from, int n_joints);
void grobo_i_row_remove(grobo_motion *motion, size_t n);
/* Time of row n as files have it, computed for frames at a rate. n must be there. */
double grobo_i_time_s(const grobo_motion *motion, size_t n);
/* True if times are what the rate says. */
bool grobo_i_at_rate(const grobo_motion *motion);
/* The step that a difference of times means, 0 for the default. */
int64_t grobo_i_step_us(grobo_motion_kind kind, double from_s, double to_s);
/* True if posture n takes the default time; a first one at 0 takes none. */
bool grobo_i_takes_default(const grobo_motion *motion, size_t n);
int64_t grobo_i_us_from_s(double time_s);
/* Adds shift_s to the times of rows first.. */
void grobo_i_shift_times(grobo_motion *motion, size_t first, double shift_s);
/* Appends copies of the rows first..last-1 of another motion, times shifted; on error some may
 * have been appended: for motions that are thrown away then. */
int grobo_i_copy_rows(grobo_motion *motion, const grobo_motion *from, size_t first, size_t last,
                      double shift_s);
/* An empty motion with all that `like` has but postures. */
int grobo_i_new_like(const grobo_motion *like, grobo_motion **motion);
/* True for a motion whose target body is the model, any robot of the original library, or none. */
bool grobo_i_is_named_for(const grobo_motion *motion, const grobo_model *model);
/* Its joints can be those of the model, which need not be so: grobo_motion_is_for(). */
bool grobo_i_has_joints_of(const grobo_motion *motion, const grobo_model *model);
/* Where a motion starts: at the posture given; NULL: where grobo_motion_start() says. */
void grobo_i_start(const grobo_motion *motion, const grobo_model *model, const grobo_posture *given,
                   grobo_posture *start);
/* Appends what was read of a robot: absolute angles, reached in their own time. An empty motion of
 * frames becomes one of postures; GROBO_ERR_TYPE for one of increments or of frames at a rate. */
int grobo_i_record(grobo_motion *motion, const grobo_posture *sensed);
/* Moves all postures of a motion into an empty one of the same allocator. */
void grobo_i_take_rows(grobo_motion *to, grobo_motion *from);
/* Exchanges all contents of two motions of the same allocator. */
void grobo_i_swap(grobo_motion *a, grobo_motion *b);

/* ---- extras ---- */
/* The extra of a row, made if it has none; NULL without memory. */
grobo_i_extra *grobo_i_extra_of(const grobo_mem *mem, const grobo_i_row *row);
grobo_i_extra *grobo_i_extra_dup(const grobo_mem *mem, const grobo_i_extra *from);
void grobo_i_extra_free(const grobo_mem *mem, grobo_i_extra *extra);
/* Forgets where in its file a key's angles stood. */
void grobo_i_forget_positions(const grobo_mem *mem, grobo_i_extra *extra);
int grobo_i_kept_add(const grobo_mem *mem, grobo_i_kept **list, const grobo_kept *kept);
int grobo_i_kept_dup(const grobo_mem *mem, const grobo_i_kept *from, grobo_i_kept **list);
/* Takes the kept keys of a level out of a list. */
void grobo_i_drop_kept(const grobo_mem *mem, grobo_i_kept **list, grobo_kept_level level);
void grobo_i_kept_free(const grobo_mem *mem, grobo_i_kept *list);

#endif
