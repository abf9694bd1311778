/* SPDX-License-Identifier: MIT */
/* What would go wrong if a motion were played on a robot. */
#include <math.h>
#include <string.h>

#include "src/base/sized.h"
#include "src/model/joint.h"
#include "src/motion/play/clip.h"
#include "src/motion/store/diagnostics.h"
#include "src/motion/text/number.h"

/* Less than this is not worth a word: half of what a servo can be told. */
#define ANGLE_SMALL_RAD (0.05 * 3.14159265358979323846 / 180)

typedef struct check {
    const grobo_motion *motion;
    const grobo_model *model;
    const grobo_check_options *options;
    grobo_diagnostics *list;
    const char *file;
    grobo_clip view;
    const grobo_i_clip *clip; /* view's */
    int n_joints;             /* that motion and model share */
    double speed;             /* times as fast as the file has it */
    size_t n_errors;
    /* by joint, while keys are gone through */
    double angle_rad[GROBO_JOINTS_MAX]; /* last key's */
    double at_s[GROBO_JOINTS_MAX];      /* and its time */
    size_t segment[GROBO_JOINTS_MAX];   /* of the track, that ends at the present key */
    grobo_joint_mask listed;            /* has had a key */
    grobo_joint_mask outside, fast;     /* the last key had that fault */
} check;

/* A number for a message, rounded to so many steps a unit. */
typedef struct shown {
    char text[GROBO_I_NUMBER_BYTES];
} shown;

static shown show(double value, double steps)
{
    shown number;
    double rounded = round(value * steps) / steps;
    size_t length = grobo_i_format_number(rounded == 0 ? 0 : rounded, number.text);

    number.text[length] = '\0';
    return number;
}

static shown show_deg(double angle_rad)
{
    return show(grobo_deg_from_rad(angle_rad), 10);
}

static grobo_i_said at_row(const check *c, size_t row, const char *code, grobo_severity severity)
{
    return (grobo_i_said){c->file, code, grobo_motion_line(c->motion, row), 0, severity};
}

/* As at_row(), at the angle of a joint where that is known. */
static grobo_i_said at_joint(const check *c, size_t row, int joint, const char *code,
                             grobo_severity severity)
{
    grobo_i_said said = at_row(c, row, code, severity);

    (void)grobo_motion_position(c->motion, row, joint, &said.line, &said.column);
    return said;
}

/* ---- the motion as a whole ---------------------------------------------------------------- */

/* Rows of angles are of all joints of a robot: fewer of them, or more, are another's. */
static void check_rows(check *c, bool named_for)
{
    bool frames = c->motion->kind == GROBO_MOTION_FRAMES;
    int n_joints = grobo_motion_joints(c->motion), has = c->model->n_joints;
    bool is_for = grobo_motion_is_for(c->motion, c->model);
    grobo_i_said said = {c->file, n_joints > has ? "joint-unknown" : "joint-missing", 0, 0,
                         is_for || !named_for ? GROBO_SEVERITY_WARNING : GROBO_SEVERITY_ERROR};

    if (frames && n_joints != has) {
        grobo_i_say(c->list, &said, "frames of %d joint%s for the %d of %s", n_joints,
                    n_joints == 1 ? "" : "s", has, c->model->name);
    } else if (c->motion->kind == GROBO_MOTION_POSTURES && !is_for && named_for) {
        grobo_i_say(c->list, &said, "postures of another number of joints than the %d of %s", has,
                    c->model->name);
    } else {
        return;
    }
    c->n_errors += said.severity == GROBO_SEVERITY_ERROR;
}

static void check_body(check *c)
{
    grobo_i_said said = {c->file, "empty", 0, 0, GROBO_SEVERITY_WARNING};
    bool named_for = grobo_i_is_named_for(c->motion, c->model);

    if (c->motion->size == 0) {
        grobo_i_say(c->list, &said, "no postures");
        return;
    }
    if (!named_for) {
        said.code = "target-body";
        said.severity = GROBO_SEVERITY_ERROR;
        c->n_errors++;
        grobo_i_say(c->list, &said, "made for %.60s, not for %s",
                    grobo_motion_target_body(c->motion), c->model->name);
    }
    check_rows(c, named_for);
}

static void check_times(check *c)
{
    bool steps = c->motion->kind == GROBO_MOTION_POSTURES || c->motion->kind == GROBO_MOTION_STEPS;
    size_t defaults = 0, first = 0;

    for (size_t n = 0; n < c->motion->size; n++) {
        double time_s = grobo_i_time_s(c->motion, n);
        double before_s = n > 0 ? grobo_i_time_s(c->motion, n - 1) : 0;
        if (steps && n > 0 && grobo_motion_step_us(c->motion, n) == 0) {
            first = defaults++ == 0 ? n : first;
        } else if (!steps && time_s < before_s) {
            grobo_i_said said = at_row(c, n, "time-back", GROBO_SEVERITY_WARNING);
            grobo_i_say(c->list, &said,
                        "at %s s, before the one above at %s s: played in order "
                        "of time",
                        show(time_s, 1e6).text, show(before_s, 1e6).text);
        }
    }
    if (defaults > 0) {
        grobo_i_said said = at_row(c, first, "step-default", GROBO_SEVERITY_NOTE);
        grobo_i_say(c->list, &said, "%lu steps give no time and take the default",
                    (unsigned long)defaults);
    }
}

/* Joints that key poses list and the robot has not: each where it is there first. */
static void check_unknown_joints(check *c)
{
    grobo_joint_mask told = 0;

    if (c->motion->kind == GROBO_MOTION_FRAMES) {
        return;
    }
    for (size_t n = 0; n < c->motion->size; n++) {
        grobo_i_row row;
        int first = -1, count = 0;
        (void)grobo_i_row_at(c->motion, n, &row);
        for (int j = c->model->n_joints; j < c->motion->n_joints; j++) {
            if ((*row.set & ~told & GROBO_JOINT_BIT(j)) != 0) {
                first = count++ == 0 ? j : first;
            }
        }
        told |= *row.set;
        if (count > 0) {
            grobo_i_said said = at_joint(c, n, first, "joint-unknown", GROBO_SEVERITY_WARNING);
            grobo_i_say(c->list, &said, "joint %d%s: %s has joints 0 to %d", first,
                        count > 1 ? " and others" : "", c->model->name, c->model->n_joints - 1);
        }
    }
}

/* ---- links -------------------------------------------------------------------------------- */

/* A link is called as the joint that moves it, and has the number behind it; 0 is the root. */
static bool link_known(const grobo_model *model, const grobo_ik_link *link)
{
    int joint =
        link->name[0] != '\0' ? grobo_model_find_joint(model, link->name, strlen(link->name)) : -1;

    if (link->index == 0) {
        return joint < 0;
    }
    if (link->index < 0) {
        return joint >= 0;
    }
    return link->index <= model->n_joints && (link->name[0] == '\0' || joint == link->index - 1);
}

/* Links that have been told of. When there is no more room, all further ones are told. */
typedef struct told_links {
    const grobo_ik_link *links[GROBO_IK_LINKS_MAX];
    size_t count;
} told_links;

/* False if the link is there already. */
static bool add_link(told_links *told, const grobo_ik_link *link)
{
    for (size_t i = 0; i < told->count; i++) {
        if (told->links[i]->index == link->index && strcmp(told->links[i]->name, link->name) == 0) {
            return false;
        }
    }
    if (told->count < GROBO_IK_LINKS_MAX) {
        told->links[told->count++] = link;
    }
    return true;
}

/* Links that key poses have and the robot has not: each where it is there first. */
static void check_links(check *c)
{
    told_links told = {.count = 0};

    for (size_t n = 0; n < c->motion->size; n++) {
        size_t count;
        const grobo_ik_link *links = grobo_motion_ik_links(c->motion, n, &count);
        for (size_t i = 0; i < count; i++) {
            if (!link_known(c->model, &links[i]) && add_link(&told, &links[i])) {
                grobo_i_said said = at_row(c, n, "link-unknown", GROBO_SEVERITY_WARNING);
                grobo_i_say(c->list, &said, "link '%s' with index %d is none of %s", links[i].name,
                            links[i].index, c->model->name);
            }
        }
    }
}

/* The joints that only link targets move: those of the legs. */
static grobo_joint_mask legs_of(const grobo_model *model)
{
    grobo_joint_mask legs = 0;

    (void)grobo_model_find_joints(model, "legs", 4, &legs);
    return legs;
}

/* Poses that move the legs by link targets and do not list all of their joints. */
static void check_legs(check *c)
{
    grobo_joint_mask legs = legs_of(c->model);
    size_t by_links = 0, listed = 0, first = 0;

    for (size_t n = 0; n < c->motion->size; n++) {
        grobo_i_row row;
        (void)grobo_i_row_at(c->motion, n, &row);
        bool has_links = *row.extra != NULL && (*row.extra)->n_links > 0;
        listed += (*row.set & legs) != 0;
        if (has_links && (*row.set & legs) != legs) {
            first = by_links++ == 0 ? n : first;
        }
    }
    if (legs != 0 && by_links > 0) {
        grobo_i_said said = at_row(c, first, "legs-by-ik", GROBO_SEVERITY_WARNING);
        grobo_i_say(c->list, &said,
                    "%lu of %lu poses give legs by ikLinks: without inverse kinematics the leg "
                    "joints move to the %lu poses that list them, the others move as listed",
                    (unsigned long)by_links, (unsigned long)c->motion->size, (unsigned long)listed);
    }
}

/* ---- limits and speeds -------------------------------------------------------------------- */

static bool is_outside(const grobo_joint *joint, double angle_rad)
{
    int ddeg = grobo_ddeg_from_rad(angle_rad);

    return ddeg < grobo_ddeg_from_rad(joint->min_rad) || ddeg > grobo_ddeg_from_rad(joint->max_rad);
}

/* Outside, and more than slack allows. */
static bool is_refused(const check *c, int j, double angle_rad)
{
    if (c->options->slack != NULL) {
        angle_rad = grobo_model_take_slack(c->model, j, angle_rad);
    }
    return is_outside(grobo_i_joint(c->model, j), angle_rad);
}

/* The angle is played at the limit that it exceeds; counted. */
static bool takes_slack(check *c, size_t row, int j, double angle_rad)
{
    grobo_slack_taken *taken = c->options->slack;
    double played_rad = grobo_model_take_slack(c->model, j, angle_rad);

    if (taken == NULL || played_rad == angle_rad) {
        return false;
    }
    if (taken->n++ == 0) {
        taken->line = grobo_motion_line(c->motion, row);
    }
    if (fabs(angle_rad - played_rad) > taken->worst_rad) {
        taken->worst_rad = fabs(angle_rad - played_rad);
        taken->joint = j;
    }
    return true;
}

/* In frames a fault goes on for many: its beginning is enough. */
static bool goes_on(const check *c, grobo_joint_mask before, int j)
{
    return c->motion->kind == GROBO_MOTION_FRAMES && (before & GROBO_JOINT_BIT(j)) != 0;
}

static void say_outside(check *c, size_t row, int j, double angle_rad, const char *where)
{
    const grobo_joint *joint = grobo_i_joint(c->model, j);
    grobo_i_said said =
        at_joint(c, row, j, where[0] != '\0' ? "limit-between" : "limit", GROBO_SEVERITY_ERROR);

    c->n_errors++;
    grobo_i_say(c->list, &said, "%s: %s degrees%s, outside %s..%s", joint->name,
                show_deg(angle_rad).text, where, show_deg(joint->min_rad).text,
                show_deg(joint->max_rad).text);
}

static void check_limit(check *c, size_t row, int j, double angle_rad)
{
    grobo_joint_mask bit = GROBO_JOINT_BIT(j);

    if (!is_outside(grobo_i_joint(c->model, j), angle_rad) || takes_slack(c, row, j, angle_rad)) {
        c->outside &= ~bit;
        return;
    }
    if (!goes_on(c, c->outside, j)) {
        say_outside(c, row, j, angle_rad, "");
    }
    c->outside |= bit;
}

/* Slope and turning points of the cubic between two keys, s from 0 to 1. */
typedef struct cubic {
    double b, c, d; /* q = a + b s + c s^2 + d s^3 */
    double length_s;
} cubic;

static cubic cubic_of(const grobo_spline_key *from, const grobo_spline_key *to)
{
    double h = to->t_s - from->t_s;
    double rise = to->value - from->value;
    double b = from->slope * h, e = to->slope * h;

    return (cubic){b, 3 * rise - 2 * b - e, b + e - 2 * rise, h};
}

static double peak_speed(const cubic *q)
{
    double peak = fmax(fabs(q->b), fabs(q->b + 2 * q->c + 3 * q->d));
    double turn = q->d != 0 ? -q->c / (3 * q->d) : -1;

    if (turn > 0 && turn < 1) {
        peak = fmax(peak, fabs(q->b + turn * (2 * q->c + turn * 3 * q->d)));
    }
    return peak / q->length_s;
}

/* How far outside its limits; negative inside. */
static double excess_rad(const grobo_joint *joint, double angle_rad)
{
    return fmax(joint->min_rad - angle_rad, angle_rad - joint->max_rad);
}

/* The value furthest outside the limits where the curve turns, or that of `to`. */
static double furthest(const cubic *q, const grobo_spline_key *from, const grobo_spline_key *to,
                       const grobo_joint *joint)
{
    double root = q->c * q->c - 3 * q->d * q->b;
    double worst = to->value;

    if (!(root > 0) || q->d == 0) {
        return worst;
    }
    for (int sign = -1; sign <= 1; sign += 2) {
        double s = (-q->c + sign * sqrt(root)) / (3 * q->d);
        double value = from->value + s * (q->b + s * (q->c + s * q->d));
        if (s > 0 && s < 1 && excess_rad(joint, value) > excess_rad(joint, worst)) {
            worst = value;
        }
    }
    return worst;
}

/* The curve that ends at a key: too steep, or swinging out of the limits. */
static void check_curve(check *c, size_t row, int j, double at_s)
{
    const grobo_joint *joint = grobo_i_joint(c->model, j);
    const grobo_spline_track *track = &c->clip->tracks[j].keys;
    size_t k = c->segment[j];

    while (k + 1 < track->n && track->keys[k].t_s < at_s) {
        k++;
    }
    c->segment[j] = k;
    if (k == 0 || track->keys[k].t_s - track->keys[k - 1].t_s < GROBO_SPLINE_JUMP_S) {
        return;
    }
    const grobo_spline_key *from = &track->keys[k - 1], *to = &track->keys[k];
    cubic q = cubic_of(from, to);
    double peak_rad_s = peak_speed(&q) * c->speed;
    double worst_rad = furthest(&q, from, to, joint);
    if (peak_rad_s > joint->max_speed_rad_s * 1.001) {
        grobo_i_said said = at_joint(c, row, j, "peak-speed", GROBO_SEVERITY_WARNING);
        grobo_i_say(c->list, &said,
                    "%s: up to %s degrees a second on the way here, the servo does %s", joint->name,
                    show_deg(peak_rad_s).text, show_deg(joint->max_speed_rad_s).text);
    }
    if (is_refused(c, j, to->value) || is_refused(c, j, from->value)) {
        return; /* told at the key */
    }
    if (is_refused(c, j, worst_rad)) {
        say_outside(c, row, j, worst_rad, " on the way here");
    } else if (!is_outside(joint, to->value) && !is_outside(joint, from->value)) {
        (void)takes_slack(c, row, j, worst_rad);
    }
}

/* Time that a joint has for its move to key i. */
static double time_for(const check *c, size_t i, size_t row, int j, double at_s)
{
    grobo_key_info info;

    if (c->clip->filling != GROBO_I_SPLINE) {
        return at_s - (i > 0 ? grobo_i_clip_at_s(c->clip, i - 1) : 0);
    }
    double gap_s = at_s - c->at_s[j];
    (void)grobo_motion_get_key(c->motion, row, &info);
    return info.max_transition_s > 0 && info.max_transition_s < gap_s ? info.max_transition_s
                                                                      : gap_s;
}

static void check_speed(check *c, size_t i, size_t row, int j, double angle_rad)
{
    const grobo_joint *joint = grobo_i_joint(c->model, j);
    grobo_joint_mask bit = GROBO_JOINT_BIT(j);
    double at_s = grobo_i_clip_at_s(c->clip, i);
    double way_rad = fabs(angle_rad - c->angle_rad[j]);
    double has_s = time_for(c, i, row, j, at_s) / c->speed;
    double needs_s = way_rad / joint->max_speed_rad_s;

    if (way_rad < ANGLE_SMALL_RAD || needs_s <= has_s * 1.001) {
        c->fast &= ~bit;
        if (c->clip->filling == GROBO_I_SPLINE) {
            check_curve(c, row, j, at_s);
        }
        return;
    }
    if (!goes_on(c, c->fast, j)) {
        grobo_i_said said = at_joint(c, row, j, "too-fast", GROBO_SEVERITY_ERROR);
        c->n_errors++;
        grobo_i_say(c->list, &said, "%s: %s degrees in %s ms, the servo needs %s ms", joint->name,
                    show_deg(way_rad).text, show(has_s * 1000, 10).text,
                    show(ceil(needs_s * 1000), 1).text);
    }
    c->fast |= bit;
}

/* A motion has angles, and a wheel none: said where its column has some. */
static void note_wheel(check *c, size_t row, int j, double angle_rad)
{
    grobo_joint_mask bit = GROBO_JOINT_BIT(j);

    if (angle_rad != 0 && (c->outside & bit) == 0) {
        grobo_i_said said = at_joint(c, row, j, "wheel", GROBO_SEVERITY_WARNING);
        grobo_i_say(c->list, &said, "%s: a wheel, which no motion turns: its column is not played",
                    grobo_i_joint(c->model, j)->name);
        c->outside |= bit;
    }
}

static void check_keys(check *c)
{
    for (size_t i = 0; i < c->motion->size; i++) {
        size_t row = grobo_i_clip_row(c->clip, i);
        grobo_i_row at;
        (void)grobo_i_row_at(c->motion, row, &at);
        for (int j = 0; j < c->n_joints; j++) {
            grobo_joint_mask bit = GROBO_JOINT_BIT(j);
            if ((*at.set & bit) == 0) {
                continue;
            }
            double angle_rad = grobo_i_clip_angle(c->clip, i, &at, j);
            if (grobo_i_joint_is_wheel(c->model, j)) {
                note_wheel(c, row, j, angle_rad);
                continue;
            }
            check_limit(c, row, j, angle_rad);
            if ((c->listed & bit) != 0) {
                check_speed(c, i, row, j, angle_rad);
            }
            c->listed |= bit;
            c->angle_rad[j] = angle_rad;
            c->at_s[j] = grobo_i_clip_at_s(c->clip, i);
        }
    }
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* What increments count from: the given posture, or the model's, as wide as the motion. */
static grobo_posture start_of(const check *c)
{
    grobo_posture start;

    grobo_i_start(c->motion, c->model, c->options->start, &start);
    for (int j = start.n_joints; j < c->motion->n_joints; j++) {
        start.angle_rad[j] = 0;
        start.set |= GROBO_JOINT_BIT(j);
    }
    start.n_joints = c->motion->n_joints > start.n_joints ? c->motion->n_joints : start.n_joints;
    return start;
}

int grobo_motion_check(const grobo_motion *motion, const grobo_model *model,
                       const grobo_check_options *options, grobo_diagnostics *list)
{
    if (motion == NULL || model == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_check_options wanted;
    check c;

    if (grobo_i_sized_take(&wanted, sizeof wanted, options) < 0) {
        return GROBO_ERR_ARG;
    }
    memset(&c, 0, sizeof c);
    c.motion = motion;
    c.model = model;
    c.options = &wanted;
    c.list = list;
    c.speed = c.options->speed_pct > 0 ? c.options->speed_pct / 100.0 : 1;
    c.file = c.options->name;
    c.n_joints = motion->n_joints < model->n_joints ? motion->n_joints : model->n_joints;
    grobo_posture start = start_of(&c);
    grobo_clip_options how = {GROBO_CLIP_OPTIONS_INIT, .style = wanted.style,
                              .default_us = wanted.default_us, .start = &start};
    int result = grobo_motion_clip(motion, &how, &c.view);
    if (result < 0) {
        return result;
    }
    c.clip = c.view.ctx;
    check_body(&c);
    check_times(&c);
    check_unknown_joints(&c);
    check_links(&c);
    check_legs(&c);
    check_keys(&c);
    grobo_motion_clip_free(&c.view);
    return c.n_errors > INT32_MAX ? INT32_MAX : (int)c.n_errors;
}
