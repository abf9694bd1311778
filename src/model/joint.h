/* SPDX-License-Identifier: MIT */
/* A joint of a model whose program may have been compiled with joints of another size. */
#ifndef GROBO_MODEL_JOINT_H
#define GROBO_MODEL_JOINT_H

#include <stddef.h>

#include <grobo/model.h>

/* joint is 0..n-1. */
static inline const grobo_joint *grobo_i_joint(const grobo_model *model, int joint)
{
#if GROBO_TABLES_FIXED
    return &model->joints[joint];
#else
    const char *first = (const char *)model->joints;
    return (const grobo_joint *)(const void *)(first + (size_t)joint * model->joint_size);
#endif
}

/* What a joint has of the one that it follows (grobo_joint.ratio, .apart_rad, .follows); a build
 * for plain drivers has no joints that follow. */
#if GROBO_DRIVERS_PLAIN
static inline double grobo_i_ratio(const grobo_joint *joint)
{
    (void)joint;
    return 0;
}
static inline double grobo_i_apart(const grobo_joint *joint)
{
    (void)joint;
    return 0;
}
static inline int grobo_i_first(const grobo_joint *joint)
{
    (void)joint;
    return 0;
}
#else
static inline double grobo_i_ratio(const grobo_joint *joint)
{
    return joint->ratio;
}
static inline double grobo_i_apart(const grobo_joint *joint)
{
    return joint->apart_rad;
}
static inline int grobo_i_first(const grobo_joint *joint)
{
    return joint->follows;
}
#endif

/* What people give the joint in (grobo_joint.unit, .unit_zero_rad, .unit_rad); in a build for plain
 * drivers all are given in degrees. */
#if GROBO_DRIVERS_PLAIN
static inline int grobo_i_unit(const grobo_joint *joint)
{
    (void)joint;
    return 0;
}
static inline double grobo_i_unit_zero(const grobo_joint *joint)
{
    (void)joint;
    return 0;
}
static inline double grobo_i_unit_rad(const grobo_joint *joint)
{
    (void)joint;
    return 0;
}
#else
static inline int grobo_i_unit(const grobo_joint *joint)
{
    return joint->unit;
}
static inline double grobo_i_unit_zero(const grobo_joint *joint)
{
    return joint->unit_zero_rad;
}
static inline double grobo_i_unit_rad(const grobo_joint *joint)
{
    return joint->unit_rad;
}
#endif

/* Whether joints of this model are so large that they have a member; those of a build for plain
 * drivers have none behind the first version's. */
#if GROBO_DRIVERS_PLAIN
#define GROBO_I_JOINTS_HAVE(model, member) ((void)(model), false)
#elif GROBO_TABLES_FIXED
#define GROBO_I_JOINTS_HAVE(model, member) ((void)(model), true)
#else
#define GROBO_I_JOINTS_HAVE(model, member)                                                         \
    ((model)->joint_size >= offsetof(grobo_joint, member) + sizeof(((grobo_joint *)0)->member))
#endif

/* Whether joints of this size have a unit. */
static inline bool grobo_i_may_have_unit(const grobo_model *model)
{
    return GROBO_I_JOINTS_HAVE(model, unit_rad);
}

/* The line that a joint's servo is on (grobo_joint.line): the first one where joints of this size
 * have none, and in a build for one line. */
static inline int grobo_i_joint_line(const grobo_model *model, int joint)
{
#if GROBO_LINES_MAX > 1
    return grobo_i_may_have_unit(model) ? grobo_i_joint(model, joint)->line : 0;
#else
    (void)model;
    (void)joint;
    return 0;
#endif
}

/* Whether joints of this size have what one that follows has. */
static inline bool grobo_i_may_follow(const grobo_model *model)
{
    return GROBO_I_JOINTS_HAVE(model, follows);
}

/* Whether joints of this size may be wheels. */
static inline bool grobo_i_may_be_wheel(const grobo_model *model)
{
    return GROBO_I_JOINTS_HAVE(model, accel_rad_s2);
}

/* True of a wheel (grobo_joint.wheel); a build for plain drivers has none. */
static inline bool grobo_i_joint_is_wheel(const grobo_model *model, int joint)
{
#if GROBO_DRIVERS_PLAIN
    (void)model;
    (void)joint;
    return false;
#else
    return grobo_i_may_be_wheel(model) && grobo_i_joint(model, joint)->wheel;
#endif
}

/* True of one that follows another one. */
static inline bool grobo_i_joint_follows(const grobo_model *model, int joint)
{
    return grobo_i_may_follow(model) && grobo_i_ratio(grobo_i_joint(model, joint)) != 0;
}

#endif
