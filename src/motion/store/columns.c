/* SPDX-License-Identifier: MIT */
#include "src/motion/store/columns.h"

bool grobo_i_motor_order(const grobo_model *model, int columns, uint8_t *joints)
{
    bool by_motor = model != NULL && columns <= model->n_joints;

    columns = columns < GROBO_JOINTS_MAX ? columns : GROBO_JOINTS_MAX;
    if (by_motor) {
        (void)grobo_model_motor_order(model, joints);
    }
    for (int c = 0; !by_motor && c < columns; c++) {
        joints[c] = (uint8_t)c;
    }
    return by_motor;
}

int grobo_i_m_columns(const grobo_motion *motion, const grobo_model *model, uint8_t *joints)
{
    int n_joints =
        model != NULL && motion->n_joints < model->n_joints ? model->n_joints : motion->n_joints;
    grobo_joint_mask set = 0, first = 0;
    grobo_i_row row;
    int columns = 0;

    (void)grobo_i_motor_order(model, n_joints, joints);
    for (size_t n = 0; grobo_i_row_at(motion, n, &row); n++) {
        if (n > 0 && *row.set != set) {
            return 0;
        }
        set = *row.set;
    }
    while (columns < n_joints && (set & GROBO_JOINT_BIT(joints[columns])) != 0) {
        first |= GROBO_JOINT_BIT(joints[columns++]);
    }
    return first == set ? columns : 0;
}
