/* SPDX-License-Identifier: MIT */
/* Round trips: what was read, written to its own format and read again, is the same to the bit;
 * written to any other format it can be read, with as many postures. */
#include <string.h>

#include <grobo/core/motion.h>

#include "tests/fuzz/motion_target.h"
#include "tests/support/tables.h"

typedef struct bytes {
    uint8_t *data;
    size_t size;
} bytes;

static int take(void *ctx, const void *data, size_t size)
{
    bytes *to = ctx;
    uint8_t *grown = realloc(to->data, to->size + size);

    MUST(grown != NULL);
    memcpy(grown + to->size, data, size);
    to->data = grown;
    to->size += size;
    return 0;
}

static void trip(const grobo_motion *motion, grobo_motion_format format)
{
    grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .model = &grobo_i_gr001_model,
                                   .exact = true};
    bytes file = {NULL, 0};
    int result = grobo_motion_write(motion, format, &options, &(grobo_sink){take, &file}, NULL);

    MUST(result == 0 || result == GROBO_ERR_EMPTY);
    if (result == 0) {
        grobo_motion *back = read_bytes(file.data, file.size, format, false);
        MUST(back != NULL);
        MUST(grobo_motion_size(back) == grobo_motion_size(motion));
        if (grobo_motion_format_kind(format) == grobo_motion_get_kind(motion)) {
            /* A file cannot say of how many joints a body is that it does not list. */
            MUST(grobo_motion_set_joints(back, grobo_motion_joints(motion)) >= 0);
            MUST(grobo_motion_equal(motion, back));
        }
        grobo_motion_free(back);
    }
    free(file.data);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    grobo_motion *motion = read_bytes(data, size, GROBO_FORMAT_AUTO, false);

    if (motion != NULL) {
        for (int format = GROBO_FORMAT_M; format <= GROBO_FORMAT_YAML; format++) {
            trip(motion, (grobo_motion_format)format);
        }
    }
    grobo_motion_free(motion);
    return 0;
}
