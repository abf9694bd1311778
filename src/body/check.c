/* SPDX-License-Identifier: MIT */
/* The lint of a walk. */
#include <string.h>

#include "src/base/sized.h"
#include "src/body/body.h"
#include "src/body/polygon.h"
#include "src/body/vec.h"
#include "src/model/joint.h"

#define SLIP_DEFAULT_M 1e-3
/* A limit is kept when the angle rounded to the wire's 0.1 degree keeps it. */
#define LIMIT_TOLERANCE_RAD (0.05 * BODY_PI / 180)

/* One finding may be open for each of these: two legs out of reach, the ZMP, no support, two feet
 * slipping, and limit and speed of each joint. */
enum {
    OPEN_UNREACHABLE = 0,
    OPEN_ZMP = OPEN_UNREACHABLE + 2,
    OPEN_NO_SUPPORT,
    OPEN_SLIP,
    OPEN_LIMIT = OPEN_SLIP + 2,
    OPEN_SPEED = OPEN_LIMIT + GROBO_JOINTS_MAX,
    OPEN_COUNT = OPEN_SPEED + GROBO_JOINTS_MAX
};

struct open_finding {
    grobo_body_finding finding;
    bool open;
    double badness; /* larger is worse */
};

struct checking {
    grobo_body *body;
    const grobo_body_check_options *options;
    double rate_hz; /* frames a second as they are played */
    int n_findings;
    struct open_finding open[OPEN_COUNT];
    double stance_m[2][4][3]; /* where a standing foot's corners came to stand */
    bool stood[2];
};

/* A frame and what is needed of the one before. */
struct moment {
    grobo_body_report report;
    double q_rad[GROBO_JOINTS_MAX];
    double beyond_rad[GROBO_JOINTS_MAX]; /* its limit, before slack is taken */
    grobo_transform links[GROBO_BODY_LINKS_MAX];
};

static void close_finding(struct checking *now, struct open_finding *open)
{
    if (open->open && now->options->finding != NULL) {
        now->options->finding(now->options->ctx, &open->finding);
    }
    open->open = false;
}

/* A problem is there in this frame; `badness` says which frame is the worst. */
static void note(struct checking *now, int slot, const grobo_body_finding *seen, double badness)
{
    struct open_finding *open = &now->open[slot];

    if (!open->open) {
        open->finding = *seen;
        open->open = true;
        open->badness = badness;
        now->n_findings++;
    } else if (badness > open->badness) {
        open->badness = badness;
        open->finding.worst_s = seen->worst_s;
        open->finding.worst = seen->worst;
    }
    open->finding.end_s = seen->worst_s;
}

/* A problem is there or not. */
static void look(struct checking *now, int slot, bool bad, const grobo_body_finding *seen,
                 double badness)
{
    if (bad) {
        note(now, slot, seen, badness);
    } else {
        close_finding(now, &now->open[slot]);
    }
}

static grobo_body_finding finding_at(grobo_body_problem problem, int index, double time_s,
                                     double worst)
{
    const grobo_body_finding finding = {problem, index, time_s, time_s, time_s, worst};

    return finding;
}

static void check_reach(struct checking *now, const grobo_body_report *report)
{
    for (int foot = 0; foot < 2; foot++) {
        const int link = now->body->model->feet[foot].link;
        const grobo_body_finding seen = finding_at(GROBO_BODY_UNREACHABLE, link, report->time_s, 0);

        look(now, OPEN_UNREACHABLE + foot, (report->unreachable >> link & 1) != 0, &seen, 0);
    }
}

static void check_joints(struct checking *now, const struct moment *at, const struct moment *before)
{
    const grobo_model *robot = now->options->robot;
    const double t_s = at->report.time_s;

    for (int j = 0; robot != NULL && j < robot->n_joints; j++) {
        const grobo_joint *joint = grobo_i_joint(robot, j);
        const double beyond = at->beyond_rad[j];
        const double way = before == NULL ? 0 : fabs(at->q_rad[j] - before->q_rad[j]);
        const double speed = way * now->rate_hz;
        const grobo_body_finding limit = finding_at(GROBO_BODY_JOINT_LIMIT, j, t_s, beyond);
        const grobo_body_finding fast = finding_at(GROBO_BODY_JOINT_SPEED, j, t_s, speed);

        look(now, OPEN_LIMIT + j, beyond > LIMIT_TOLERANCE_RAD, &limit, beyond);
        look(now, OPEN_SPEED + j, speed > joint->max_speed_rad_s, &fast, speed);
    }
}

/* The largest way of a corner since the foot came to stand. */
static void check_slip(struct checking *now, int foot, const grobo_body_balance_frame *frame)
{
    const double slip_m = now->options->slip_m > 0 ? now->options->slip_m : SLIP_DEFAULT_M;
    double moved_m = 0;

    if (frame->standing[foot] && !now->stood[foot]) {
        memcpy(now->stance_m[foot], frame->sole_m[foot], sizeof now->stance_m[foot]);
    }
    now->stood[foot] = frame->standing[foot];
    for (int i = 0; i < 4 && frame->standing[foot]; i++) {
        double way[3];

        vec_add_scaled(way, frame->sole_m[foot][i], -1, now->stance_m[foot][i]);
        moved_m = fmax(moved_m, sqrt(vec_dot(way, way)));
    }
    const grobo_body_finding seen =
        finding_at(GROBO_BODY_FOOT_SLIP, now->body->model->feet[foot].link, frame->time_s, moved_m);

    look(now, OPEN_SLIP + foot, moved_m > slip_m, &seen, moved_m);
}

/* Height of the ground: the mean of the standing soles' corners. */
static double ground_m(const grobo_body_balance_frame *frame)
{
    double sum = 0;
    int n = 0;

    for (int foot = 0; foot < 2; foot++) {
        for (int i = 0; i < 4 && frame->standing[foot]; i++) {
            sum += frame->sole_m[foot][i][2];
            n++;
        }
    }
    return n > 0 ? sum / n : 0;
}

/* ZMP inside the convex hull of the standing soles. */
static double support_margin(grobo_body_balance_frame *frame)
{
    double hull[17][2];
    const int n = grobo_i_support(frame->standing, frame->sole_m, hull);

    return n == 0 ? -INFINITY : grobo_i_polygon_margin(hull, n, frame->zmp_m);
}

static bool feet_have_targets(const grobo_body *body)
{
    return body->options.ik != GROBO_BODY_IK_OFF &&
           (body->target[GROBO_I_RIGHT].n > 0 || body->target[GROBO_I_LEFT].n > 0);
}

/* The frame's balance; rate is the rate of change of momentum. */
static void fill_frame(const struct checking *now, const struct moment *at,
                       const grobo_momentum *rate, grobo_body_balance_frame *frame)
{
    const grobo_body_model *model = now->body->model;
    double mass_kg;

    memset(frame, 0, sizeof *frame);
    frame->time_s = at->report.time_s;
    frame->has_desired = at->report.has_zmp;
    memcpy(frame->desired_m, at->report.zmp_m, sizeof frame->desired_m);
    for (int foot = 0; foot < 2; foot++) {
        frame->standing[foot] = at->report.touching[foot];
        grobo_i_sole_corners(&model->feet[foot], &at->links[model->feet[foot].link],
                             frame->sole_m[foot]);
    }
    mass_kg = grobo_body_com(model, at->links, frame->com_m);
    frame->zmp_m[2] = ground_m(frame);
    grobo_body_zmp(frame->com_m, mass_kg, rate, frame->zmp_m);
    frame->margin_m = support_margin(frame);
}

static void check_balance(struct checking *now, const grobo_body_balance_frame *frame)
{
    const bool stands = frame->standing[0] || frame->standing[1];
    const grobo_body_finding zmp =
        finding_at(GROBO_BODY_ZMP_MARGIN, 0, frame->time_s, frame->margin_m);
    const grobo_body_finding jump = finding_at(GROBO_BODY_NO_SUPPORT, 0, frame->time_s, 0);

    look(now, OPEN_ZMP, stands && frame->margin_m < now->options->margin_m, &zmp, -frame->margin_m);
    look(now, OPEN_NO_SUPPORT, !stands, &jump, 0);
    for (int foot = 0; foot < 2; foot++) {
        check_slip(now, foot, frame);
    }
}

static void take_moment(const struct checking *now, int frame, struct moment *moment)
{
    const grobo_model *robot = now->options->robot;

    (void)grobo_body_frame(now->body, frame, moment->q_rad, &moment->report);
    for (int j = 0; robot != NULL && j < robot->n_joints; j++) {
        double *q_rad = &moment->q_rad[j];

        moment->beyond_rad[j] = fmax(grobo_i_joint(robot, j)->min_rad - *q_rad,
                                     *q_rad - grobo_i_joint(robot, j)->max_rad);
        if (now->options->takes_slack) {
            *q_rad = grobo_model_take_slack(robot, j, *q_rad);
        }
    }
    grobo_body_forward(now->body->model, &moment->report.root, moment->q_rad, moment->links);
}

/* One frame between the one before (NULL: the first) and the next (NULL: the last). */
static void check_frame(struct checking *now, const struct moment *at, const struct moment *next,
                        grobo_momentum *last)
{
    const double rate_hz = now->rate_hz;
    grobo_momentum momentum = *last, rate;
    grobo_body_balance_frame frame;

    if (next != NULL) {
        const struct grobo_i_pose here = {at->q_rad, at->links};
        const struct grobo_i_pose there = {next->q_rad, next->links};

        grobo_i_momentum_between(now->body->model, &here, &there, rate_hz, &momentum);
    }
    for (int k = 0; k < 3; k++) {
        rate.p_kgm_s[k] = (momentum.p_kgm_s[k] - last->p_kgm_s[k]) * rate_hz;
        rate.l_kgm2_s[k] = (momentum.l_kgm2_s[k] - last->l_kgm2_s[k]) * rate_hz;
    }
    *last = momentum;
    fill_frame(now, at, &rate, &frame);
    if (feet_have_targets(now->body)) {
        check_balance(now, &frame);
    }
    if (now->options->frame != NULL) {
        now->options->frame(now->options->ctx, &frame);
    }
}

static void check_fall(struct checking *now)
{
    grobo_body_finding fall;

    if (grobo_i_falls(now->body, now->options, &fall)) {
        now->n_findings++;
        if (now->options->finding != NULL) {
            now->options->finding(now->options->ctx, &fall);
        }
    }
}

int grobo_body_check(grobo_body *body, const grobo_body_check_options *options)
{
    if (body == NULL || options == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_body_check_options how;
    const int taken = grobo_i_sized_take(&how, sizeof how, options);
    if (taken < 0) {
        return taken;
    }
    struct checking now = {.body = body, .options = &how};
    const double speed = how.speed_pct > 0 ? how.speed_pct / 100.0 : 1;
    grobo_momentum last = {{0, 0, 0}, {0, 0, 0}};
    struct moment moment[2];

    if (how.robot != NULL && how.robot->n_joints != body->model->n_joints) {
        return GROBO_ERR_ARG;
    }
    now.rate_hz = body->options.rate_hz * speed;
    if (how.falls) {
        check_fall(&now);
    }
    take_moment(&now, 0, &moment[0]);
    check_reach(&now, &moment[0].report);
    check_joints(&now, &moment[0], NULL);
    for (int i = 0; i < body->n_frames; i++) {
        const struct moment *at = &moment[i % 2];
        struct moment *next = i + 1 < body->n_frames ? &moment[(i + 1) % 2] : NULL;

        if (next != NULL) {
            take_moment(&now, i + 1, next);
            check_reach(&now, &next->report);
            check_joints(&now, next, at);
        }
        check_frame(&now, at, next, &last);
    }
    for (int i = 0; i < OPEN_COUNT; i++) {
        close_finding(&now, &now.open[i]);
    }
    return now.n_findings;
}

const char *grobo_body_problem_name(grobo_body_problem problem)
{
    switch (problem) {
    case GROBO_BODY_UNREACHABLE:
        return "unreachable";
    case GROBO_BODY_ZMP_MARGIN:
        return "zmp-margin";
    case GROBO_BODY_NO_SUPPORT:
        return "no-support";
    case GROBO_BODY_FOOT_SLIP:
        return "foot-slip";
    case GROBO_BODY_JOINT_LIMIT:
        return "joint-limit";
    case GROBO_BODY_JOINT_SPEED:
        return "joint-speed";
    case GROBO_BODY_FALL:
        return "fall";
    }
    return "unknown";
}
