/* SPDX-License-Identifier: MIT */
/* Frames of a motion that is set up. */
#include <string.h>

#include "src/body/body.h"
#include "src/body/vec.h"

int grobo_body_frame_count(const grobo_body *body)
{
    return body == NULL ? GROBO_ERR_ARG : body->n_frames;
}

grobo_joint_mask grobo_body_joints(const grobo_body *body)
{
    if (body == NULL) {
        return 0;
    }
    const bool waist = body->options.ik != GROBO_BODY_IK_OFF && body->target[GROBO_I_WAIST].n > 0;
    grobo_joint_mask joints = 0;

    for (int j = 0; j < body->model->n_joints; j++) {
        joints |= body->joints[j].n > 0 ? GROBO_JOINT_BIT(j) : 0;
    }
    for (int foot = 0; foot < 2; foot++) {
        for (int i = 0; i < GROBO_BODY_LEG_JOINTS; i++) {
            if (waist && body->target[GROBO_I_RIGHT + foot].n > 0) {
                joints |= GROBO_JOINT_BIT(body->model->links[body->leg[foot].link[i]].joint);
            }
        }
    }
    return joints;
}

/* The balancer's shift at a time, straight between its frames. */
static void shift_at(const grobo_body *body, double time_s, double shift_m[2])
{
    shift_m[0] = shift_m[1] = 0;
    if (body->balance == NULL) {
        return;
    }
    const double last = body->n_frames - 1;
    const double at = fmin(fmax(time_s * body->options.rate_hz, 0), last);
    const size_t i = (size_t)fmin(floor(at), fmax(last - 1, 0));
    const double part = at - (double)i;
    const double *w = body->balance + 2 * i;

    for (int k = 0; k < 2; k++) {
        shift_m[k] = w[k] + (part > 0 ? part * (w[k + 2] - w[k]) : 0);
    }
}

static void solve(grobo_body *body, double time_s, const double shift_m[2], double *q_rad,
                  grobo_body_report *report)
{
    grobo_body_report own;
    grobo_body_report *used = report != NULL ? report : &own;

    grobo_i_solve(body, fmin(time_s, body->end_s), shift_m, used);
    used->time_s = time_s;
    memcpy(q_rad, body->q_rad, (size_t)body->model->n_joints * sizeof *q_rad);
}

int grobo_body_frame(grobo_body *body, int frame, double *q_rad, grobo_body_report *report)
{
    if (q_rad == NULL || body == NULL) {
        return GROBO_ERR_ARG;
    }
    static const double none[2] = {0, 0};

    if (frame < 0 || frame >= body->n_frames) {
        return GROBO_ERR_ARG;
    }
    solve(body, (double)frame / body->options.rate_hz,
          body->balance != NULL ? body->balance + 2 * (size_t)frame : none, q_rad, report);
    return 0;
}

int grobo_body_sample(grobo_body *body, double time_s, double *q_rad, grobo_body_report *report)
{
    if (body == NULL || q_rad == NULL) {
        return GROBO_ERR_ARG;
    }
    double shift_m[2];

    if (!isfinite(time_s)) {
        return GROBO_ERR_NAN;
    }
    shift_at(body, time_s, shift_m);
    solve(body, time_s, shift_m, q_rad, report);
    return 0;
}
