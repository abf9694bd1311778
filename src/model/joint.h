/* SPDX-License-Identifier: MIT */
/* A joint of a model whose program may have been compiled with joints of another size. */
#ifndef GROBO_MODEL_JOINT_H
#define GROBO_MODEL_JOINT_H

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

/* Whether joints of this size have `ratio`, `apart_rad` and `follows`. */
#if GROBO_TABLES_FIXED
#define GROBO_I_HAS_FOLLOWS(model, joint) true
#else
#define GROBO_I_HAS_FOLLOWS(model, joint)                                                          \
    ((size_t)((const char *)(&(joint)->follows + 1) - (const char *)(joint)) <= (model)->joint_size)
#endif

/* True of one that follows another one: then it has these three members. */
static inline bool grobo_i_joint_follows(const grobo_model *model, int joint)
{
    const grobo_joint *of = grobo_i_joint(model, joint);
    return GROBO_I_HAS_FOLLOWS(model, of) && of->ratio != 0;
}

#endif
