/* SPDX-License-Identifier: MIT */
#include "src/model/joint.h"
#include "src/robots/file/families.h"

#define FAMILY(name, directory)                                                                    \
    {&grobo_i_family_##name, &grobo_i_sim_##directory, grobo_i_words_##directory},
static const grobo_family families[] = {
#include "src/servo/families.list"
    {NULL, NULL, NULL}};
#undef FAMILY

#define FAMILY(name, directory) &grobo_i_family_##name,
const grobo_robot_family *const grobo_i_robot_families[] = {
#include "src/servo/families.list"
    NULL};
#undef FAMILY

#define FAMILY(name, directory) &grobo_i_sim_##directory,
const grobo_sim_family *const grobo_i_sim_families[] = {
#include "src/servo/families.list"
    NULL};
#undef FAMILY

const grobo_family *grobo_families(void)
{
    return families;
}

const grobo_robot_family *grobo_robot_family_at(size_t i)
{
    size_t n = sizeof grobo_i_robot_families / sizeof *grobo_i_robot_families;
    return i < n ? grobo_i_robot_families[i] : NULL;
}

const grobo_sim_family *const *grobo_sim_families(void)
{
    return grobo_i_sim_families;
}

const grobo_servo_model *grobo_i_family_row(const grobo_robot_family *family, size_t index)
{
    const grobo_servo_table *const *table = family->tables;
    while (*table != NULL && index >= (*table)->model_count) {
        index -= (*table++)->model_count;
    }
    return *table != NULL ? &(*table)->models[index] : NULL;
}

const grobo_servo_model *grobo_i_joint_servo(const grobo_robot_def *def, int joint)
{
    const grobo_joint *of = grobo_i_joint(def->model, joint);
    const grobo_servo_model *servo = of->servo;
    for (size_t i = 0; servo == NULL; i++) {
        const grobo_servo_model *row = grobo_i_family_row(def->family, i);
        if (row == NULL || row->number == of->servo_model) {
            return row;
        }
    }
    return servo;
}
