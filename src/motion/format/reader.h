/* SPDX-License-Identifier: MIT */
/* What all readers of motion files share: input, complaints, the motion being made. */
#ifndef GROBO_MOTION_READER_H
#define GROBO_MOTION_READER_H

#include "src/motion/store/container.h"
#include "src/motion/store/diagnostics.h"

/* A buffer over a source. Bytes first..last-1 are there to be taken. */
typedef struct grobo_i_input {
    const grobo_source *source;
    unsigned char *buffer;
    size_t size, first, last;
    uint64_t total_bytes; /* read so far */
    bool ended;
} grobo_i_input;

/* A place in a file, both counted from 1; 0: unknown. */
typedef struct grobo_i_place {
    uint32_t line, column;
} grobo_i_place;

typedef struct grobo_i_reader {
    grobo_read_options options;
    const char *file;
    const grobo_mem *mem;
    grobo_diagnostics *list;
    grobo_i_input input;
    grobo_motion *motion;
    grobo_i_place top; /* where the file says what it is; 0: unknown */
    int result;        /* the first complaint, with keep_going */
} grobo_i_reader;

/*
 * Reads more into the buffer, behind what is left in it, which moves to its start.
 * @return bytes added, 0 at the end or if the buffer is full, or an error: what the source gave,
 * GROBO_ERR_CAP beyond GROBO_FILE_MAX_BYTES.
 */
int grobo_i_input_fill(grobo_i_input *input);

/* Says what is wrong, and result is returned: reading ends. */
int grobo_i_refuse(grobo_i_reader *reader, int result, const char *code, grobo_i_place place,
                   const char *format, ...) GROBO_I_FORMAT(5, 6);
/* As grobo_i_refuse(), but with keep_going 0 is returned, and the caller makes the best of it. */
int grobo_i_complain(grobo_i_reader *reader, int result, const char *code, grobo_i_place place,
                     const char *format, ...) GROBO_I_FORMAT(5, 6);
void grobo_i_warn(grobo_i_reader *reader, const char *code, grobo_i_place place, const char *format,
                  ...) GROBO_I_FORMAT(4, 5);
void grobo_i_note(grobo_i_reader *reader, const char *code, grobo_i_place place, const char *format,
                  ...) GROBO_I_FORMAT(4, 5);
/* A time of a key pose or a frame, in seconds from 0 to GROBO_I_TIME_MAX_S; else it becomes 0. */
int grobo_i_take_time(grobo_i_reader *reader, double *time_s, double found_s, grobo_i_place place);
/*
 * Sets the angle of a joint of a row, which stands at place in the file: refuses one that is too
 * large, and remembers the place where the caller of reading wants that.
 */
int grobo_i_set_angle(grobo_i_reader *reader, const grobo_i_row *row, int joint, double angle_rad,
                      grobo_i_place place);

#endif
