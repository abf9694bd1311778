/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "src/servo/item.h"

const grobo_i_item *grobo_i_item_of(const grobo_i_item *items, uint16_t code)
{
    for (; code != 0 && items->bytes > 0; items++) {
        if (items->write == code || items->read == code) {
            return items;
        }
    }
    return NULL;
}

const grobo_i_item *grobo_i_item_at(const grobo_i_item *items, unsigned address, unsigned bytes)
{
    for (; items->bytes > 0; items++) {
        if (items->address == address && items->bytes == bytes) {
            return items;
        }
    }
    return NULL;
}
