/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/play/whole.h"

/* A body that was made, of a robot whose file has feet; they stay. */
typedef struct made {
    struct made *next;
    const grobo_robot_def *def;
    bool solved; /* its legs are of the kind that is */
    grobo_robot_body body;
} made;

static const grobo_body_model *body_of(const grobo_robot_def *def)
{
    static made *all;
    made *one = all;
    while (one && one->def != def) {
        one = one->next;
    }
    if (!one) {
        one = def->n_feet > 0 ? calloc(1, sizeof *one) : NULL;
        if (!one) {
            return NULL;
        }
        *one = (made){.next = all, .def = def};
        one->solved = grobo_robot_def_body(def, &one->body) == GROBO_OK;
        all = one;
    }
    return one->solved ? &one->body.model : NULL;
}

const grobo_body_model *whole_legs(const app *a, const grobo_model *model)
{
    if (model == grobo_gr001_model()) {
        return grobo_gr001_body();
    }
    if (robot_of(a)->model == model) {
        return body_of(robot_of(a));
    }
    for (size_t i = 0; grobo_robot_def_at(i); i++) {
        if (grobo_robot_def_at(i)->model == model) {
            return body_of(grobo_robot_def_at(i));
        }
    }
    return NULL;
}

whole_robot whole_robot_of(const app *a, const grobo_motion *motion)
{
    const grobo_model *model = file_model(a, motion);
    return model ? (whole_robot){model, whole_legs(a, model)} : (whole_robot){app_model(a), NULL};
}

bool whole_applies(const app *a, const grobo_motion *motion, const grobo_body_options *options)
{
    return options->ik != GROBO_BODY_IK_OFF && grobo_motion_get_kind(motion) == GROBO_MOTION_KEYS &&
           grobo_body_wanted(whole_robot_of(a, motion).body, motion);
}

int whole_open(const app *a, whole *w, const grobo_motion *motion, const grobo_clip_options *plain,
               const grobo_body_options *options)
{
    memset(w, 0, sizeof *w);
    if (!whole_applies(a, motion, options)) {
        return grobo_motion_clip(motion, plain, &w->clip);
    }
    int error = grobo_body_new(whole_robot_of(a, motion).body, motion, options, NULL, &w->body);
    if (!error) {
        grobo_body_clip(w->body, false, &w->clip);
    }
    return error;
}

void whole_close(whole *w)
{
    if (!w->body && w->clip.key) {
        grobo_motion_clip_free(&w->clip);
    }
    grobo_body_free(w->body);
    memset(w, 0, sizeof *w);
}

grobo_joint_mask whole_joints(const grobo_body_model *model)
{
    grobo_joint_mask joints = 0;
    for (int foot = 0; model && foot < 2; foot++) {
        for (int link = model->feet[foot].link; link > 0; link = model->links[link].parent) {
            joints |= GROBO_JOINT_BIT(model->links[link].joint);
        }
    }
    return joints;
}

/* ---- two feet on the ground ---------------------------------------------------------------- */

static void stand(const grobo_body_model *body, grobo_ik_link *link, int foot)
{
    const grobo_body_foot *at = &body->feet[foot];
    memset(link, 0, sizeof *link);
    snprintf(link->name, sizeof link->name, "%s", body->links[at->link].name);
    link->index = at->link;
    link->is_base = foot == 0;
    link->is_touching = true;
    link->rotation[0] = link->rotation[4] = link->rotation[8] = 1;
    link->translation_m[2] = -at->sole_m[2];
}

/* With a foot as base and no target for the waist no leg is solved: the angles are as they are. */
static int stand_on_feet(const grobo_body_model *body, grobo_motion *keys)
{
    grobo_ik_link feet[2];
    stand(body, &feet[0], 0);
    stand(body, &feet[1], 1);
    return grobo_motion_set_ik_links(keys, 0, feet, 2);
}

/* The same postures as key poses, with Choreonoid's curve between them: straight lines would have
 * no acceleration but in their corners. */
static int to_keys(const grobo_model *model, const grobo_motion *motion, grobo_motion **keys)
{
    grobo_write_options how = {GROBO_WRITE_OPTIONS_INIT, .model = model};
    return grobo_motion_convert(motion, GROBO_MOTION_KEYS, &how, NULL, keys);
}

int whole_body(const app *a, grobo_body **body, const grobo_motion *motion,
               const grobo_body_options *options, bool *standing)
{
    const grobo_body_options as_they_are = {GROBO_BODY_OPTIONS_INIT, .rate_hz = options->rate_hz};
    grobo_motion *keys = NULL;
    const whole_robot robot = whole_robot_of(a, motion);
    *standing = !whole_applies(a, motion, options);
    if (!*standing) {
        return grobo_body_new(robot.body, motion, options, NULL, body);
    }
    if (!robot.body) {
        return GROBO_ERR_TYPE;
    }
    int error = to_keys(robot.model, motion, &keys);
    if (!error && grobo_motion_size(keys) == 0) {
        error = GROBO_ERR_EMPTY;
    }
    for (size_t i = 0; !error && i < grobo_motion_size(keys); i++) {
        error = grobo_motion_set_ik_links(keys, i, NULL, 0);
    }
    if (!error) {
        error = stand_on_feet(robot.body, keys);
    }
    if (!error) {
        error = grobo_body_new(robot.body, keys, &as_they_are, NULL, body);
    }
    grobo_motion_free(keys);
    return error;
}
