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

#endif
