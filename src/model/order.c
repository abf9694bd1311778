/* SPDX-License-Identifier: MIT */
/* Motor order: line by line, on each by the ids of the servos. */
#include <grobo/model.h>

#include "src/model/joint.h"

/* Whether a joint comes before another in motor order; of one motor twice the first stays first. */
static bool is_before(const grobo_model *model, int joint, int other)
{
    int line = grobo_i_joint_line(model, joint), others = grobo_i_joint_line(model, other);
    return line != others ? line < others
                          : grobo_i_joint(model, joint)->motor < grobo_i_joint(model, other)->motor;
}

int grobo_model_motor_order(const grobo_model *model, uint8_t *joints)
{
    if (model == NULL || joints == NULL) {
        return GROBO_ERR_ARG;
    }
    for (int j = 0; j < model->n_joints; j++) {
        int at = j;
        for (; at > 0 && is_before(model, j, joints[at - 1]); at--) {
            joints[at] = joints[at - 1];
        }
        joints[at] = (uint8_t)j;
    }
    return model->n_joints;
}
