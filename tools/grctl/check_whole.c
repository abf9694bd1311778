/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "check_whole.h"
#include "file.h"

/* Nearer to the edge real feet, floors and servos decide. */
static const double margin_least_m = 0.005;

typedef struct finder {
    const char *path;
    const grobo_motion *motion;
    grobo_diagnostics *list;
    bool balance;
    bool standing; /* the feet are taken to stand: joints were checked as they are */
} finder;

/* The line of the last key before a time. */
static uint32_t line_at(const grobo_motion *motion, double at_s)
{
    uint32_t line = 0;
    double before_s = -1, time_s;
    for (size_t i = 0; grobo_motion_time_s(motion, i, &time_s) == 0; i++) {
        if (time_s <= at_s + 1e-9 && time_s >= before_s) {
            line = grobo_motion_line(motion, i);
            before_s = time_s;
        }
    }
    return line;
}

static const char *link_name(int link)
{
    return grobo_gr001_body.links[link].name;
}

/* What it is and how bad, without its time. */
static void describe(const grobo_body_finding *f, char *text, size_t capacity)
{
    const grobo_joint *joint = &grobo_gr001_model.joints[f->index];
    switch (f->problem) {
    case GROBO_BODY_UNREACHABLE:
        snprintf(text, capacity, "%s: the leg does not reach its target", link_name(f->index));
        return;
    case GROBO_BODY_ZMP_MARGIN:
        snprintf(text, capacity, "the ZMP is %s%.1f mm %s the soles", f->worst < 0 ? "" : "only ",
                 fabs(f->worst) * 1e3, f->worst < 0 ? "outside" : "inside");
        return;
    case GROBO_BODY_NO_SUPPORT:
        snprintf(text, capacity, "no foot stands");
        return;
    case GROBO_BODY_FOOT_SLIP:
        snprintf(text, capacity, "%s: the standing foot slips %.1f mm", link_name(f->index),
                 f->worst * 1e3);
        return;
    case GROBO_BODY_JOINT_LIMIT:
        snprintf(text, capacity, "%s: %.1f degrees beyond its limit", joint->name,
                 grobo_deg_from_rad(f->worst));
        return;
    case GROBO_BODY_JOINT_SPEED:
        snprintf(text, capacity, "%s: %.0f degrees a second, the servo does %.0f", joint->name,
                 grobo_deg_from_rad(f->worst), grobo_deg_from_rad(joint->max_speed_rad_s));
        return;
    }
}

static grobo_severity severity_of(const grobo_body_finding *f)
{
    bool near = f->problem == GROBO_BODY_ZMP_MARGIN && f->worst >= 0;
    return near || f->problem == GROBO_BODY_FOOT_SLIP || f->problem == GROBO_BODY_JOINT_SPEED
               ? GROBO_SEVERITY_WARNING
               : GROBO_SEVERITY_ERROR;
}

/* True if grobo_motion_check() does not see it, or it was asked for. */
static bool is_wanted(const finder *f, const grobo_body_finding *finding)
{
    switch (finding->problem) {
    case GROBO_BODY_JOINT_LIMIT:
    case GROBO_BODY_JOINT_SPEED:
        return !f->standing && (whole_joints() & GROBO_JOINT_BIT(finding->index));
    case GROBO_BODY_UNREACHABLE:
        return true;
    case GROBO_BODY_ZMP_MARGIN:
    case GROBO_BODY_NO_SUPPORT:
    case GROBO_BODY_FOOT_SLIP:
        return f->balance;
    }
    return false;
}

static void add(void *ctx, const grobo_body_finding *finding)
{
    const finder *f = ctx;
    char what[160], message[240];
    grobo_diagnostic d = {.file = f->path,
                          .code = grobo_body_problem_name(finding->problem),
                          .message = message,
                          .line = line_at(f->motion, finding->begin_s),
                          .severity = severity_of(finding)};
    if (!is_wanted(f, finding))
        return;
    describe(finding, what, sizeof what);
    if (finding->end_s > finding->begin_s)
        snprintf(message, sizeof message, "%s, at %.2f s (from %.2f to %.2f s)", what,
                 finding->worst_s, finding->begin_s, finding->end_s);
    else
        snprintf(message, sizeof message, "%s, at %.2f s", what, finding->worst_s);
    grobo_diagnostics_add(f->list, &d);
}

static void skip(const char *path, const char *why, grobo_diagnostics *list)
{
    grobo_diagnostic d = {.file = path,
                          .code = "balance-unknown",
                          .message = why,
                          .severity = GROBO_SEVERITY_WARNING};
    grobo_diagnostics_add(list, &d);
}

int check_whole(const char *path, const grobo_motion *motion, const grobo_body_options *options,
                bool balance, grobo_diagnostics *list)
{
    finder f = {.path = path, .motion = motion, .list = list, .balance = balance};
    grobo_body_check_options how = {
        .robot = &grobo_gr001_model, .margin_m = margin_least_m, .finding = add, .ctx = &f};
    grobo_body *body = NULL;
    int error;
    if (!balance && !whole_applies(motion, options))
        return 0;
    error = whole_body(&body, motion, options, &f.standing);
    if (!error)
        error = grobo_body_check(body, &how);
    grobo_body_free(body);
    if (error == GROBO_ERR_TYPE || error == GROBO_ERR_EMPTY) {
        skip(path,
             error == GROBO_ERR_TYPE ? "not made for GR001: its balance is unknown"
                                     : "has no postures to balance",
             list);
        return 0;
    }
    return error < 0 ? error : 0;
}
