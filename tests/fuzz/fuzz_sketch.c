/* SPDX-License-Identifier: MIT */
/* Any bytes as a URDF or a body of Choreonoid: refused, or the text of a robot's file. */
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/target.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/robot/sketch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static sketch s;
    char said[256] = "";
    const char *bytes = (const char *)data;
    s.n = 0;
    s.bare = false;
    s.family = family_called("feetech");
    memcpy(s.name, "robot", sizeof "robot");
    bool fine = size > 0 && bytes[0] == '<'
                    ? sketch_read_urdf(&s, "x", bytes, size, said, sizeof said)
                    : sketch_read_body(&s, "x", bytes, size, said, sizeof said);
    fine = fine && sketch_order(&s, said, sizeof said);
    MUST(fine || said[0] != '\0');
    if (!fine) {
        return 0;
    }
    MUST(sketch_joints(&s) > 0 && sketch_joints(&s) <= GROBO_JOINTS_MAX);
    for (int i = 0; i < sketch_joints(&s); i++) {
        sketch_joint(&s, i)->id = i + 1;
        sketch_joint(&s, i)->servo = family_model(s.family, "STS3215");
    }
    if (!sketch_fit(&s, said, sizeof said)) {
        MUST(*said);
        return 0;
    }
    char *text = sketch_text(&s);
    MUST(text == NULL || strlen(text) > 0);
    free(text);
    return 0;
}
