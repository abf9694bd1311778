/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/decode/dialect.h"

static const dialect *const dialects[] = {&dialect_dxl2, &dialect_dxl1,  &dialect_sts,
                                          &dialect_scs,  &dialect_lx16a, &dialect_ics};

const dialect *dialect_named(const char *name)
{
    for (size_t i = 0; i < sizeof dialects / sizeof *dialects; i++) {
        if (strcmp(dialects[i]->name, name) == 0) {
            return dialects[i];
        }
    }
    return NULL;
}
