/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <string.h>

#include <grobo/error.h>

#include "src/base/sized.h"

/* What the caller says of its structure; 0: nonsense. */
static size_t size_of(const void *sized)
{
    size_t size;

    memcpy(&size, sized, sizeof size);
    return size > sizeof size && size <= SIZED_MAX_BYTES ? size : 0;
}

int grobo_i_sized_take(void *to, size_t to_bytes, const void *from)
{
    const uint8_t *bytes = from;
    size_t size = from != NULL ? size_of(from) : sizeof size;

    if (size == 0) {
        return GROBO_ERR_ARG;
    }
    for (size_t i = to_bytes; i < size; i++) {
        if (bytes[i] != 0) {
            return GROBO_ERR_ARG; /* of a newer version, and wanted */
        }
    }
    memset(to, 0, to_bytes);
    if (from != NULL) {
        memcpy(to, from, size < to_bytes ? size : to_bytes);
    }
    memcpy(to, &to_bytes, sizeof to_bytes);
    return GROBO_OK;
}

bool grobo_i_sized_give(void *to, const void *from, size_t from_bytes)
{
    size_t size = size_of(to);
    size_t most = size < from_bytes ? size : from_bytes;

    if (size == 0) {
        return false;
    }
    memcpy((uint8_t *)to + sizeof size, (const uint8_t *)from + sizeof size, most - sizeof size);
    return true;
}

bool grobo_i_table_fits(const void *table, size_t size, size_t known, size_t least)
{
    const uint8_t *bytes = table;
    bool fits = size >= least && size <= SIZED_MAX_BYTES;

    for (size_t i = known; fits && i < size; i++) {
        fits = bytes[i] == 0;
    }
    return fits;
}

void grobo_i_table_copy(void *to, size_t to_bytes, const void *from, size_t from_bytes)
{
    size_t most = to_bytes < from_bytes ? to_bytes : from_bytes;

    memcpy((uint8_t *)to + sizeof to_bytes, (const uint8_t *)from + sizeof to_bytes,
           most - sizeof to_bytes);
    memset((uint8_t *)to + most, 0, to_bytes - most);
}
