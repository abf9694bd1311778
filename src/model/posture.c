/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/posture.h>

#include "src/base/angle.h"
#include "src/model/joint.h"

#define PI 3.14159265358979323846

/* What register No.32-33 can hold: 16383 x 10 ms. */
#define TIME_MAX_MS 163830.0

double grobo_deg_from_rad(double angle_rad)
{
    return angle_rad * 180.0 / PI;
}

double grobo_rad_from_deg(double angle_deg)
{
    return angle_deg * PI / 180.0;
}

int16_t grobo_ddeg_from_rad(double angle_rad)
{
    int16_t small;
    if (grobo_i_ddeg(angle_rad, &small)) {
        return small;
    }
    double ddeg = round(angle_rad * 1800.0 / PI);
    if (isnan(ddeg)) {
        return 0;
    }
    if (ddeg >= INT16_MAX) {
        return INT16_MAX;
    }
    return ddeg <= INT16_MIN ? INT16_MIN : (int16_t)ddeg;
}

double grobo_rad_from_ddeg(int angle_ddeg)
{
    return angle_ddeg * PI / 1800.0;
}

int grobo_posture_init(grobo_posture *posture, int n_joints)
{
    if (posture == NULL) {
        return GROBO_ERR_ARG;
    }
    if (n_joints < 0 || n_joints > GROBO_JOINTS_MAX) {
        return GROBO_ERR_CAP;
    }
    memset(posture, 0, sizeof *posture);
    posture->time_us = GROBO_POSTURE_TIME_US;
    posture->n_joints = (uint8_t)n_joints;
    return 0;
}

void grobo_posture_init_pose(grobo_posture *posture, const grobo_model *model)
{
    if (posture == NULL || model == NULL) {
        return;
    }
    (void)grobo_posture_init(posture, model->n_joints);
    for (int j = 0; j < model->n_joints; j++) {
        posture->angle_rad[j] = grobo_i_joint(model, j)->init_rad;
        posture->set |= grobo_i_joint_is_wheel(model, j) ? 0 : GROBO_JOINT_BIT(j);
    }
}

static bool has_joint(const grobo_posture *posture, int joint)
{
    return joint >= 0 && joint < posture->n_joints;
}

static bool is_set(const grobo_posture *posture, int joint)
{
    return (posture->set & GROBO_JOINT_BIT(joint)) != 0;
}

int grobo_posture_set_rad(grobo_posture *posture, int joint, double angle_rad)
{
    if (posture == NULL || !has_joint(posture, joint)) {
        return GROBO_ERR_ARG;
    }
    if (!isfinite(angle_rad)) {
        return GROBO_ERR_NAN;
    }
    posture->angle_rad[joint] = angle_rad;
    posture->set |= GROBO_JOINT_BIT(joint);
    return 0;
}

int grobo_posture_set_deg(grobo_posture *posture, int joint, double angle_deg)
{
    return grobo_posture_set_rad(posture, joint, grobo_rad_from_deg(angle_deg));
}

int grobo_posture_get_rad(const grobo_posture *posture, int joint, double *angle_rad)
{
    if (posture == NULL || angle_rad == NULL || !has_joint(posture, joint)) {
        return GROBO_ERR_ARG;
    }
    if (!is_set(posture, joint)) {
        return GROBO_ERR_EMPTY;
    }
    *angle_rad = posture->angle_rad[joint];
    return 0;
}

int grobo_posture_get_deg(const grobo_posture *posture, int joint, double *angle_deg)
{
    if (angle_deg == NULL) {
        return GROBO_ERR_ARG;
    }
    double angle_rad;
    int result = grobo_posture_get_rad(posture, joint, &angle_rad);
    if (result == 0) {
        *angle_deg = grobo_deg_from_rad(angle_rad);
    }
    return result;
}

int grobo_posture_all_rad(const grobo_posture *posture, double *angle_rad, size_t capacity)
{
    if (posture == NULL || angle_rad == NULL) {
        return GROBO_ERR_ARG;
    }
    if (capacity < posture->n_joints) {
        return GROBO_ERR_SPACE;
    }
    for (int j = 0; j < posture->n_joints; j++) {
        angle_rad[j] = is_set(posture, j) ? posture->angle_rad[j] : (double)NAN;
    }
    return posture->n_joints;
}

int grobo_posture_all_deg(const grobo_posture *posture, double *angle_deg, size_t capacity)
{
    if (angle_deg == NULL) {
        return GROBO_ERR_ARG;
    }
    int n = grobo_posture_all_rad(posture, angle_deg, capacity);
    for (int j = 0; j < n; j++) {
        angle_deg[j] = grobo_deg_from_rad(angle_deg[j]);
    }
    return n;
}

int grobo_posture_set_time_ms(grobo_posture *posture, double time_ms)
{
    if (posture == NULL || !(time_ms >= 0.0 && time_ms <= TIME_MAX_MS)) {
        return GROBO_ERR_ARG;
    }
    posture->time_us = (int64_t)round(time_ms * 1000.0);
    return 0;
}

int grobo_posture_copy(grobo_posture *dst, const grobo_posture *src, int offset)
{
    if (dst == NULL || src == NULL || offset < 0 || offset > src->n_joints) {
        return GROBO_ERR_ARG;
    }
    int n = src->n_joints - offset;
    if (n > dst->n_joints) {
        n = dst->n_joints;
    }
    if (n == 0) {
        offset = 0; /* it may be 64, and a shift by all bits is undefined */
    }
    /* memmove: src may be dst. */
    grobo_joint_mask moved = (src->set >> offset) & GROBO_JOINTS_ALL(n);
    memmove(dst->angle_rad, src->angle_rad + offset, (size_t)n * sizeof dst->angle_rad[0]);
    dst->set = (dst->set & ~GROBO_JOINTS_ALL(n)) | moved;
    dst->time_us = src->time_us;
    return n;
}

void grobo_posture_merge(grobo_posture *posture, const grobo_posture *over)
{
    if (posture == NULL || over == NULL) {
        return;
    }
    int n = over->n_joints < posture->n_joints ? over->n_joints : posture->n_joints;
    for (int j = 0; j < n; j++) {
        if (is_set(over, j)) {
            posture->angle_rad[j] = over->angle_rad[j];
        }
    }
    posture->set |= over->set & GROBO_JOINTS_ALL(n);
}

static bool same_joints(const grobo_posture *a, const grobo_posture *b)
{
    return a->n_joints == b->n_joints && a->set == b->set;
}

bool grobo_posture_equal(const grobo_posture *a, const grobo_posture *b)
{
    if (a == NULL || b == NULL || !same_joints(a, b)) {
        return false;
    }
    for (int j = 0; j < a->n_joints; j++) {
        if (is_set(a, j) && !(a->angle_rad[j] == b->angle_rad[j])) {
            return false;
        }
    }
    return true;
}

bool grobo_posture_near(const grobo_posture *a, const grobo_posture *b, double delta_rad)
{
    if (a == NULL || b == NULL || !same_joints(a, b)) {
        return false;
    }
    for (int j = 0; j < a->n_joints; j++) {
        if (is_set(a, j) && !(fabs(a->angle_rad[j] - b->angle_rad[j]) < delta_rad)) {
            return false;
        }
    }
    return true;
}

int grobo_posture_mirror(grobo_posture *posture, const grobo_model *model)
{
    if (posture == NULL || model == NULL || posture->n_joints != model->n_joints) {
        return GROBO_ERR_ARG;
    }
    grobo_posture before = *posture;
    posture->set = 0;
    for (int j = 0; j < model->n_joints; j++) {
        const grobo_joint *joint = grobo_i_joint(model, j);
        if (is_set(&before, joint->mirror)) {
            posture->angle_rad[j] = joint->mirror_sign * before.angle_rad[joint->mirror];
            posture->set |= GROBO_JOINT_BIT(j);
        }
    }
    return 0;
}

/* On the wire's grid: a limit read from a file in degrees is kept however it was rounded. */
static bool within_limits(const grobo_joint *joint, double angle_rad)
{
    int16_t ddeg = grobo_ddeg_from_rad(angle_rad);
    return ddeg >= grobo_ddeg_from_rad(joint->min_rad) &&
           ddeg <= grobo_ddeg_from_rad(joint->max_rad);
}

int grobo_posture_check(const grobo_posture *posture, const grobo_model *model, int *joint)
{
    if (posture == NULL || model == NULL || posture->n_joints != model->n_joints ||
        (posture->set & ~GROBO_JOINTS_ALL(model->n_joints)) != 0) {
        return GROBO_ERR_ARG;
    }
    for (int j = 0; j < model->n_joints; j++) {
        const grobo_joint *limits = grobo_i_joint(model, j);
        /* Most are inside, and need not be rounded, which keeps the order. */
        if (!is_set(posture, j) ||
            grobo_i_inside(limits->min_rad, posture->angle_rad[j], limits->max_rad)) {
            continue;
        }
        int result = 0;
        if (!isfinite(posture->angle_rad[j])) {
            result = GROBO_ERR_NAN;
        } else if (!within_limits(limits, posture->angle_rad[j])) {
            result = GROBO_ERR_LIMIT;
        }
        if (result < 0) {
            if (joint != NULL) {
                *joint = j;
            }
            return result;
        }
    }
    return 0;
}

int grobo_posture_clamp(grobo_posture *posture, const grobo_model *model)
{
    if (posture == NULL || model == NULL) {
        return GROBO_ERR_ARG;
    }
    int result = grobo_posture_check(posture, model, NULL);
    if (result == GROBO_ERR_ARG || result == GROBO_OK) {
        return result;
    }
    for (int j = 0; j < model->n_joints; j++) {
        if (is_set(posture, j) && !isfinite(posture->angle_rad[j])) {
            return GROBO_ERR_NAN;
        }
    }
    int changed = 0;
    for (int j = 0; j < model->n_joints; j++) {
        const grobo_joint *joint = grobo_i_joint(model, j);
        if (is_set(posture, j) && !within_limits(joint, posture->angle_rad[j])) {
            bool low = posture->angle_rad[j] < joint->min_rad;
            posture->angle_rad[j] = low ? joint->min_rad : joint->max_rad;
            changed++;
        }
    }
    return changed;
}

/* ---- the line form ---- */

typedef struct cursor {
    const char *at;
    const char *end;
} cursor;

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

static bool skip_blanks(cursor *c)
{
    while (c->at < c->end && is_blank(*c->at)) {
        c->at++;
    }
    return c->at < c->end;
}

/* A decimal integer within +-limit that ends at a blank or at the end. */
static bool read_integer(cursor *c, int32_t limit, int32_t *value)
{
    bool negative = *c->at == '-';
    if (negative || *c->at == '+') {
        c->at++;
    }
    const char *first = c->at;
    int32_t sum = 0;
    while (c->at < c->end && *c->at >= '0' && *c->at <= '9' && sum <= limit) {
        sum = sum * 10 + (*c->at++ - '0');
    }
    if (c->at == first || sum > limit || (c->at < c->end && !is_blank(*c->at))) {
        return false;
    }
    *value = negative ? -sum : sum;
    return true;
}

int grobo_posture_parse(grobo_posture *posture, const grobo_model *model, const char *text,
                        size_t length)
{
    if ((text == NULL && length > 0) || posture == NULL || model == NULL) {
        return GROBO_ERR_ARG;
    }
    cursor c = {text, text + length};
    grobo_posture parsed;
    int32_t number;
    uint8_t joints[GROBO_JOINTS_MAX];
    int n = 0, n_joints = grobo_model_motor_order(model, joints);

    (void)grobo_posture_init(&parsed, model->n_joints);
    if (!skip_blanks(&c) || !read_integer(&c, (int32_t)TIME_MAX_MS, &number) || number < 0) {
        return GROBO_ERR_SYNTAX;
    }
    parsed.time_us = (int64_t)number * 1000;
    for (; skip_blanks(&c); n++) {
        if (!read_integer(&c, INT16_MAX, &number)) {
            return GROBO_ERR_SYNTAX;
        }
        if (n == n_joints) {
            return GROBO_ERR_CAP;
        }
        parsed.angle_rad[joints[n]] = grobo_rad_from_ddeg(number);
        parsed.set |= GROBO_JOINT_BIT(joints[n]);
    }
    *posture = parsed;
    return n;
}
