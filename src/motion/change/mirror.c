/* SPDX-License-Identifier: MIT */
/* Left for right: y changes its sign, joints and links change places with their other side. */
#include <string.h>

#include "src/model/joint.h"
#include "src/motion/store/container.h"

/* The joint whose link is called so, or -1. */
static int joint_of_link(const grobo_model *model, const char *name)
{
    for (int j = 0; j < model->n_joints; j++) {
        if (strcmp(grobo_i_joint(model, j)->name, name) == 0) {
            return j;
        }
    }
    return -1;
}

/* Names that begin with a side have another one: only a table knows which. */
static bool is_sided(const char *name)
{
    return strncmp(name, "R_", 2) == 0 || strncmp(name, "L_", 2) == 0 ||
           strncmp(name, "RLEG", 4) == 0 || strncmp(name, "LLEG", 4) == 0 ||
           strncmp(name, "RARM", 4) == 0 || strncmp(name, "LARM", 4) == 0;
}

/* The link of the other side: link index is joint + 1, its name that of the joint. */
static int mirror_identity(grobo_ik_link *link, const grobo_model *model)
{
    int joint = link->name[0] != '\0' ? joint_of_link(model, link->name) : link->index - 1;

    if (joint < 0 && (link->index <= 0 || link->name[0] != '\0')) {
        return is_sided(link->name) ? GROBO_ERR_NOTFOUND : 0; /* the root, or another middle one */
    }
    if (joint >= model->n_joints) {
        return GROBO_ERR_NOTFOUND;
    }
    joint = grobo_i_joint(model, joint)->mirror;
    const char *name = grobo_i_joint(model, joint)->name;
    size_t length = strlen(name);
    if (link->name[0] != '\0') {
        if (length >= sizeof link->name) {
            return GROBO_ERR_NOTFOUND;
        }
        memcpy(link->name, name, length + 1);
    }
    link->index = link->index >= 0 ? joint + 1 : link->index;
    return 0;
}

/* Mirrored at the plane y = 0: M R M with M = diag(1, -1, 1). */
static void mirror_target(grobo_ik_link *link)
{
    /* 0 - x and not -x: no file should say -0. */
    link->translation_m[1] = 0 - link->translation_m[1];
    link->parting_direction[1] = 0 - link->parting_direction[1];
    for (int i = 0; i < 9; i++) {
        if ((i / 3 == 1) != (i % 3 == 1)) {
            link->rotation[i] = 0 - link->rotation[i];
        }
    }
}

static int mirror_extra(grobo_i_extra *extra, const grobo_model *model)
{
    grobo_joint_mask stationary = 0;

    for (int j = 0; j < model->n_joints; j++) {
        if ((extra->info.stationary & GROBO_JOINT_BIT(j)) != 0) {
            stationary |= GROBO_JOINT_BIT(grobo_i_joint(model, j)->mirror);
        }
    }
    extra->info.stationary = stationary;
    extra->info.zmp_m[1] = 0 - extra->info.zmp_m[1];
    for (int i = 0; i < extra->n_links; i++) {
        int result = mirror_identity(&extra->links[i], model);
        if (result < 0) {
            return result;
        }
        mirror_target(&extra->links[i]);
    }
    return 0;
}

static int mirror_all(grobo_motion *motion, const grobo_model *model)
{
    for (size_t n = 0; n < motion->size; n++) {
        grobo_posture posture;
        grobo_i_row row;
        (void)grobo_motion_get(motion, n, &posture);
        int result = grobo_posture_mirror(&posture, model);
        if (result == 0) {
            result = grobo_motion_set(motion, n, &posture);
        }
        if (result == 0 && grobo_i_row_at(motion, n, &row) && *row.extra != NULL) {
            grobo_i_forget_positions(motion->mem, *row.extra); /* angles change places */
            result = mirror_extra(*row.extra, model);
        }
        if (result < 0) {
            return result;
        }
    }
    return 0;
}

int grobo_motion_mirror(grobo_motion *motion, const grobo_model *model)
{
    if (motion == NULL || model == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_motion *made;

    if (model->n_joints != motion->n_joints) {
        return GROBO_ERR_ARG;
    }
    int result = grobo_motion_dup(motion, &made);
    if (result < 0) {
        return result;
    }
    result = mirror_all(made, model);
    if (result == 0) {
        grobo_i_swap(motion, made);
    }
    grobo_motion_free(made);
    return result;
}
