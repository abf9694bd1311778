/* SPDX-License-Identifier: MIT */
/* What people give and read a joint in: grobo/core/unit.h. */
#include <math.h>

#include <grobo/core/unit.h>
#include <grobo/posture.h>

#include "src/model/joint.h"

/* A limit and a value that says the same differ by the last bits of a division. */
#define SAME_RAD 1e-9

static const grobo_joint *joint_of(const grobo_model *model, int joint)
{
    bool is_one = model != NULL && joint >= 0 && joint < model->n_joints;
    return is_one ? grobo_i_joint(model, joint) : NULL;
}

grobo_unit grobo_model_unit(const grobo_model *model, int joint)
{
    const grobo_joint *j = joint_of(model, joint);
    return j != NULL && grobo_i_may_have_unit(model) ? (grobo_unit)grobo_i_unit(j) : GROBO_UNIT_DEG;
}

const char *grobo_unit_name(grobo_unit unit)
{
    return unit == GROBO_UNIT_MM ? "mm" : unit == GROBO_UNIT_PCT ? "%" : "deg";
}

double grobo_model_change(const grobo_model *model, int joint, double by_rad)
{
    const grobo_joint *j = joint_of(model, joint);
    if (j == NULL) {
        return NAN;
    }
    bool has_unit = grobo_model_unit(model, joint) != GROBO_UNIT_DEG;
    return has_unit ? by_rad / grobo_i_unit_rad(j) : grobo_deg_from_rad(by_rad);
}

double grobo_model_value(const grobo_model *model, int joint, double angle_rad)
{
    const grobo_joint *j = joint_of(model, joint);
    bool has_unit = grobo_model_unit(model, joint) != GROBO_UNIT_DEG;
    double from_rad = has_unit ? grobo_i_unit_zero(j) : 0;
    return j == NULL ? NAN : grobo_model_change(model, joint, angle_rad - from_rad) + 0.0;
}

double grobo_model_angle(const grobo_model *model, int joint, double value)
{
    const grobo_joint *j = joint_of(model, joint);
    if (j == NULL) {
        return NAN;
    }
    if (grobo_model_unit(model, joint) == GROBO_UNIT_DEG) {
        return grobo_rad_from_deg(value);
    }
    double angle_rad = grobo_i_unit_zero(j) + value * grobo_i_unit_rad(j);
    return fabs(angle_rad - j->min_rad) < SAME_RAD   ? j->min_rad
           : fabs(angle_rad - j->max_rad) < SAME_RAD ? j->max_rad
                                                     : angle_rad;
}
