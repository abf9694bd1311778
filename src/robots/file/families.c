/* SPDX-License-Identifier: MIT */
#include "src/robots/file/families.h"

const grobo_robot_family *const grobo_robot_families[] = {&grobo_i_family_rs30x,
                                                          &grobo_i_family_dynamixel2,
                                                          &grobo_i_family_dynamixel1,
                                                          &grobo_i_family_feetech,
                                                          &grobo_i_family_lx16a,
                                                          &grobo_i_family_ics,
                                                          NULL};

bool grobo_i_family_row(const grobo_robot_family *family, size_t index, grobo_i_servo *servo)
{
    if (family->tables == NULL) {
        const grobo_sim_type *type = grobo_sim_type_row(index);
        if (type != NULL) {
            *servo = (grobo_i_servo){type->name, type->model, type->speed_mdeg_s / 1e3};
        }
        return type != NULL;
    }
    const grobo_servo_table *const *table = family->tables;
    while (*table != NULL && index >= (*table)->model_count) {
        index -= (*table++)->model_count;
    }
    if (*table == NULL) {
        return false;
    }
    const grobo_servo_model *model = &(*table)->models[index];
    *servo = (grobo_i_servo){model->name, model->number, model->speed_dps};
    return true;
}

const grobo_servo_model *grobo_i_family_servo(const grobo_robot_family *family, uint16_t model)
{
    const grobo_servo_model *found = NULL;
    const grobo_servo_table *const *table = family->tables;
    for (; table != NULL && *table != NULL && found == NULL; table++) {
        found = grobo_servo_model_numbered(*table, model);
    }
    return found;
}
