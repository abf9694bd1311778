/* SPDX-License-Identifier: MIT */
#include <math.h>

#include <grobo/core/motion.h>

#include "tools/grctl/play/check.h"

/* Nearer to the edge real feet, floors and servos decide. */
static const double margin_least_m = 0.005;

/* Frames and postures that are looked at unasked: a few hundredths of a second. */
enum { FALL_RATE_HZ = 100, FALL_FRAMES_MOST = 10000, FALL_POSTURES_MOST = 10000 };

typedef struct finder {
    whole_robot robot;
    const check_whole_how *how;
    const grobo_motion *motion;
    grobo_diagnostics *list;
    bool standing; /* the feet are taken to stand: joints were checked as they are */
    bool lies;     /* a body that can fall does, or may */
    /* for CHECK_FALL */
    bool falls, stood, steps, too_fast;
    grobo_body_finding fall; /* the worst */
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

static const char *side_name(int side)
{
    static const char *const names[] = {"on its face", "on its back", "to its left",
                                        "to its right"};
    return names[side];
}

/* What it is and how bad, without its time. */
static void describe(const whole_robot *robot, const grobo_body_finding *f, char *text,
                     size_t capacity)
{
    const grobo_joint *joint = grobo_model_joint(robot->model, f->index);
    const grobo_body_link *link = &robot->body->links[f->index];
    switch (f->problem) {
    case GROBO_BODY_UNREACHABLE:
        snprintf(text, capacity, "%s: the leg does not reach its target", link->name);
        return;
    case GROBO_BODY_ZMP_MARGIN:
        snprintf(text, capacity, "the ZMP is %s%.1f mm %s the soles", f->worst < 0 ? "" : "only ",
                 fabs(f->worst) * 1e3, f->worst < 0 ? "outside" : "inside");
        return;
    case GROBO_BODY_NO_SUPPORT:
        snprintf(text, capacity, "no foot stands");
        return;
    case GROBO_BODY_FOOT_SLIP:
        snprintf(text, capacity, "%s: the standing foot slips %.1f mm", link->name, f->worst * 1e3);
        return;
    case GROBO_BODY_JOINT_LIMIT:
        snprintf(text, capacity, "%s: %.1f degrees beyond its limit", joint->name,
                 grobo_deg_from_rad(f->worst));
        return;
    case GROBO_BODY_JOINT_SPEED:
        snprintf(text, capacity, "%s: %.0f degrees a second, the servo does %.0f", joint->name,
                 grobo_deg_from_rad(f->worst), grobo_deg_from_rad(joint->max_speed_rad_s));
        return;
    case GROBO_BODY_FALL:
        snprintf(text, capacity,
                 f->worst > 0 ? "the robot falls %s on a floor that slopes by %.1f degrees"
                              : "the robot falls %s",
                 side_name(f->index), grobo_deg_from_rad(f->worst));
        return;
    }
}

static grobo_severity severity_of(const grobo_body_finding *f)
{
    bool warns = (f->problem == GROBO_BODY_ZMP_MARGIN && f->worst >= 0) ||
                 (f->problem == GROBO_BODY_FALL && f->worst > 0);
    return warns || f->problem == GROBO_BODY_FOOT_SLIP || f->problem == GROBO_BODY_JOINT_SPEED
               ? GROBO_SEVERITY_WARNING
               : GROBO_SEVERITY_ERROR;
}

/* True if grobo_motion_check() does not see it, or it was asked for. */
static bool is_wanted(const finder *f, const grobo_body_finding *finding)
{
    switch (finding->problem) {
    case GROBO_BODY_JOINT_LIMIT:
    case GROBO_BODY_JOINT_SPEED:
        return (f->how->what & CHECK_LEGS) != 0 && !f->standing &&
               (whole_joints(f->robot.body) & GROBO_JOINT_BIT(finding->index));
    case GROBO_BODY_UNREACHABLE:
        return (f->how->what & CHECK_LEGS) != 0;
    case GROBO_BODY_ZMP_MARGIN:
    case GROBO_BODY_NO_SUPPORT:
        return (f->how->what & CHECK_BALANCE) != 0 && (!f->standing || f->lies);
    case GROBO_BODY_FOOT_SLIP:
    case GROBO_BODY_FALL:
        return (f->how->what & CHECK_BALANCE) != 0;
    }
    return false;
}

static void report(const finder *f, const grobo_body_finding *finding, const char *prefix,
                   grobo_diagnostic *d)
{
    char what[160], message[280];
    d->file = f->how->path;
    d->message = message;
    d->line = line_at(f->motion, finding->begin_s);
    describe(&f->robot, finding, what, sizeof what);
    if (finding->end_s > finding->begin_s) {
        snprintf(message, sizeof message, "%s%s, at %.2f s (from %.2f to %.2f s)", prefix, what,
                 finding->worst_s, finding->begin_s, finding->end_s);
    } else {
        snprintf(message, sizeof message, "%s%s, at %.2f s", prefix, what, finding->worst_s);
    }
    grobo_diagnostics_add(f->list, d);
}

/* Keeps the worst of what makes the robot fall; none is as bad as no foot on the ground. */
static void note_fall(finder *f, const grobo_body_finding *finding)
{
    bool jumps = finding->problem == GROBO_BODY_NO_SUPPORT;
    f->too_fast = f->too_fast || finding->problem == GROBO_BODY_JOINT_SPEED;
    if (finding->problem == GROBO_BODY_FOOT_SLIP) {
        f->steps = f->steps || finding->worst > CHECK_STEP_LEAST_M;
    }
    if (!jumps && (finding->problem != GROBO_BODY_ZMP_MARGIN || finding->worst >= 0)) {
        return;
    }
    if (f->falls &&
        (f->fall.problem == GROBO_BODY_NO_SUPPORT || (!jumps && finding->worst >= f->fall.worst))) {
        return;
    }
    f->falls = true;
    f->fall = *finding;
}

static void add(void *ctx, const grobo_body_finding *finding)
{
    finder *f = ctx;
    grobo_diagnostic d = {.code = grobo_body_problem_name(finding->problem),
                          .severity = severity_of(finding)};
    f->lies = f->lies || finding->problem == GROBO_BODY_FALL;
    note_fall(f, finding);
    if (!is_wanted(f, finding)) {
        return;
    }
    if (finding->problem == GROBO_BODY_JOINT_LIMIT && f->how->slack &&
        check_takes_slack(f->robot.model, finding)) {
        check_add_slack(f->how->slack, finding);
    } else {
        report(f, finding, "", &d);
    }
}

static void see_frame(void *ctx, const grobo_body_balance_frame *frame)
{
    finder *f = ctx;
    f->stood = f->stood || frame->standing[0] || frame->standing[1];
}

/* Only where it is certain: not of a motion that says nowhere that a foot stands, nor of one whose
 * feet, taken to stand, move. */
static void report_fall(const finder *f)
{
    grobo_diagnostic d = {.code = "fall", .severity = GROBO_SEVERITY_WARNING};
    if (f->falls && f->stood && !(f->standing && f->steps)) {
        report(f, &f->fall, "the robot would fall: ", &d);
    }
}

static void skip(const char *path, const char *why, grobo_diagnostics *list)
{
    grobo_diagnostic d = {.file = path,
                          .code = "balance-unknown",
                          .message = why,
                          .severity = GROBO_SEVERITY_WARNING};
    grobo_diagnostics_add(list, &d);
}

/* ---- angles at a limit ---------------------------------------------------------------------- */

bool check_takes_slack(const grobo_model *model, const grobo_body_finding *limit)
{
    double max_rad = grobo_model_joint(model, limit->index)->max_rad;
    return grobo_model_take_slack(model, limit->index, max_rad + limit->worst) == max_rad;
}

void check_add_slack(grobo_slack_taken *slack, const grobo_body_finding *limit)
{
    slack->n++;
    if (limit->worst <= slack->worst_rad) {
        return;
    }
    slack->worst_rad = limit->worst;
    slack->joint = limit->index;
}

void check_report_slack(const char *path, const grobo_model *model, const grobo_slack_taken *slack,
                        grobo_diagnostics *list)
{
    char message[160];
    grobo_diagnostic d = {.file = path,
                          .code = "limit-slack",
                          .message = message,
                          .line = slack->line,
                          .severity = GROBO_SEVERITY_WARNING};
    if (slack->n == 0) {
        return;
    }
    snprintf(message, sizeof message,
             "%zu angle%s up to %.1f degrees outside %s limits (%s): clamped", slack->n,
             slack->n == 1 ? "" : "s", grobo_deg_from_rad(slack->worst_rad),
             slack->n == 1 ? "its" : "their", grobo_model_joint(model, slack->joint)->name);
    grobo_diagnostics_add(list, &d);
}

/* ---- all of it ------------------------------------------------------------------------------ */

/* Frames close enough to see a fall, and no more of them than unasked work may cost. */
static double fall_rate(const grobo_motion *motion)
{
    double length_s = (double)grobo_motion_length_us(motion, -1) / 1e6;
    return length_s * FALL_RATE_HZ <= FALL_FRAMES_MOST ? FALL_RATE_HZ : FALL_FRAMES_MOST / length_s;
}

/* Solves every frame and tells what is found. Faster than a servo a move takes longer than the file
 * says: where it is played so fast, what is certain is a fall at the speed of the file. */
static int look_at(finder *f, grobo_body *body)
{
    grobo_body_check_options look = {
        GROBO_BODY_CHECK_OPTIONS_INIT,
        .robot = f->robot.model,
        .margin_m = f->how->what & CHECK_BALANCE ? margin_least_m : 0,
        .speed_pct = f->how->speed_pct,
        .takes_slack = f->how->slack != NULL,
        .frame = see_frame,
        .finding = add,
        .ctx = f,
        .falls = (f->how->what & CHECK_BALANCE) != 0,
    };
    int error = grobo_body_check(body, &look);
    if (error < 0 || f->how->what != CHECK_FALL || !f->falls || !f->too_fast ||
        look.speed_pct <= 100) {
        return error;
    }
    look.speed_pct = 100;
    f->falls = false;
    return grobo_body_check(body, &look);
}

/* A motion whose balance was asked for and is not known. */
static int report_unknown(const check_whole_how *how, int error, grobo_diagnostics *list)
{
    if (error != GROBO_ERR_TYPE && error != GROBO_ERR_EMPTY) {
        return error < 0 ? error : 0;
    }
    if (how->what & CHECK_BALANCE) {
        skip(how->path,
             error == GROBO_ERR_TYPE
                 ? "for a robot whose feet are not known: its balance is unknown"
                 : "has no postures to balance",
             list);
    }
    return 0;
}

int check_whole(const app *a, const grobo_motion *motion, const grobo_body_options *options,
                const check_whole_how *how, grobo_diagnostics *list)
{
    finder f = {.robot = whole_robot_of(a, motion), .how = how, .motion = motion, .list = list};
    bool legs = (how->what & CHECK_LEGS) != 0 && whole_applies(a, motion, options);
    bool fall = (how->what & CHECK_FALL) != 0 && grobo_motion_size(motion) <= FALL_POSTURES_MOST;
    bool asked = legs || (how->what & CHECK_BALANCE) != 0;
    grobo_body_options used = *options;
    grobo_body *body = NULL;
    if (!asked && !fall) {
        return 0;
    }
    if (!asked) {
        used.rate_hz = fall_rate(motion);
    }
    int error = whole_body(a, &body, motion, &used, &f.standing);
    if (!error) {
        error = look_at(&f, body);
    }
    grobo_body_free(body);
    if (error >= 0 && fall) {
        report_fall(&f);
    }
    return report_unknown(how, error, list);
}
