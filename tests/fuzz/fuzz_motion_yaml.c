/* SPDX-License-Identifier: MIT */
/* Any bytes as a .yaml file: refused with a place, or a motion that can be played. */
#include "tests/fuzz/motion_target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return run_reader(data, size, GROBO_FORMAT_YAML);
}
