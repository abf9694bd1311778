/* SPDX-License-Identifier: MIT */
/* A line of an .m file, "time a1 .. an": any text is refused with nothing changed, or gives a
 * posture that fits the model and has finite angles only. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include <grobo/model.h>
#include <grobo/posture.h>

#include "tests/fuzz/target.h"
#include "tests/support/tables.h"

static void check_accepted(const grobo_posture *posture, const grobo_model *model, int n)
{
    MUST(n <= model->n_joints && (posture->set & ~GROBO_JOINTS_ALL(model->n_joints)) == 0);
    for (int j = 0; j < model->n_joints; j++) {
        MUST((posture->set & GROBO_JOINT_BIT(j)) == 0 || isfinite(posture->angle_rad[j]));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const grobo_model *model = &grobo_i_gr001_model;
    grobo_posture posture;
    grobo_posture before;
    memset(&posture, 0, sizeof posture);
    MUST(grobo_posture_init(&posture, model->n_joints) >= 0);
    before = posture;
    int result = grobo_posture_parse(&posture, model, (const char *)data, size);
    if (result >= 0) {
        check_accepted(&posture, model, result);
    } else {
        MUST(grobo_posture_equal(&posture, &before) && posture.time_us == before.time_us);
    }
    return 0;
}
