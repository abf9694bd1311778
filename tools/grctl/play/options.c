/* SPDX-License-Identifier: MIT */
#include <grobo/core/motion.h>

#include "tools/grctl/play/check.h"
#include "tools/grctl/play/options.h"

bool body_options_given(const app *a, int base)
{
    for (int i = 0; i < BODY_OPTIONS; i++) {
        if (app_option(a, base + i)->given) {
            return true;
        }
    }
    return false;
}

static int fail(app *a, const char *path, int error)
{
    return app_fail_error(a, EXIT_FILE, error, "%s: legs cannot be solved", path);
}

/* What --like names: a file as Choreonoid's window shows it by default; as 1.1 made motions for the
 * real robot; and as later versions make them. See docs/guide/whole-body.md. */
static const grobo_body_options likes[] = {
    {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC, .step = GROBO_BODY_STEP_STEALTHY,
     .zmp = GROBO_BODY_ZMP_AUTO},
    {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC, .zmp = GROBO_BODY_ZMP_AUTO,
     .balance = GROBO_BODY_BALANCE_COMPAT11},
    {GROBO_BODY_OPTIONS_INIT, .ik = GROBO_BODY_IK_NUMERIC, .zmp = GROBO_BODY_ZMP_AUTO,
     .balance = GROBO_BODY_BALANCE_ON},
};

/* The option's word; `preset` where it is not given, or --balance without a word. */
static int choice(const app *a, int option, int preset)
{
    const cli_value *v = app_option(a, option);
    return v->given && v->text ? v->choice : preset;
}

int body_options_read(app *a, int base, double rate_hz, grobo_body_options *options)
{
    static const grobo_body_zmp_source zmps[] = {GROBO_BODY_ZMP_AUTO, GROBO_BODY_ZMP_FILE};
    const cli_value *like = app_option(a, base + BODY_LIKE);
    grobo_body_options o = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 0};
    int zmp = choice(a, base + BODY_ZMP, -1);
    if (like->given) {
        o = likes[like->choice];
    }
    o.ik = (grobo_body_ik)choice(a, base + BODY_IK, (int)o.ik);
    o.step = (grobo_body_step)choice(a, base + BODY_STEP, (int)o.step);
    o.balance = (grobo_body_balance)choice(a, base + BODY_BALANCE, (int)o.balance);
    if (zmp >= 0) {
        o.zmp = zmps[zmp];
    } else if (o.balance != GROBO_BODY_BALANCE_OFF) {
        o.zmp = GROBO_BODY_ZMP_AUTO;
    }
    o.rate_hz = rate_hz;
    *options = o;
    if (o.ik == GROBO_BODY_IK_OFF && o.balance != GROBO_BODY_BALANCE_OFF) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "%s: --ik off and a balancer cannot be used together; add --balance off",
                        a->line.command->name);
    }
    return 0;
}

int body_make(app *a, int base, const char *path, const grobo_motion *motion, double rate_hz,
              grobo_body **body)
{
    grobo_body_options options;
    int error = body_options_read(a, base, rate_hz, &options);
    if (error) {
        return error;
    }
    if (!whole_applies(a, motion, &options)) {
        if (options.balance != GROBO_BODY_BALANCE_OFF) {
            app_note(a, "%s: no legs by ikLinks: the balancer has nothing to move", path);
        }
        return 0;
    }
    error = grobo_body_new(whole_robot_of(a, motion).body, motion, &options, NULL, body);
    return error ? fail(a, path, error) : 0;
}

/* ---- refusing ------------------------------------------------------------------------------- */

typedef struct refusal {
    whole_robot robot;
    bool any, clamps;
    grobo_slack_taken *slack;
    grobo_body_finding first;
} refusal;

static void note_finding(void *ctx, const grobo_body_finding *finding)
{
    refusal *r = ctx;
    bool limit = finding->problem == GROBO_BODY_JOINT_LIMIT;
    bool refused = finding->problem == GROBO_BODY_UNREACHABLE || (limit && !r->clamps);
    if (limit && check_takes_slack(r->robot.model, finding)) {
        if (whole_joints(r->robot.body) &
            GROBO_JOINT_BIT(finding->index)) { /* the others are counted by key */
            check_add_slack(r->slack, finding);
        }
        return;
    }
    if (!refused || (r->any && r->first.begin_s <= finding->begin_s)) {
        return;
    }
    r->any = true;
    r->first = *finding;
}

int body_refuse(app *a, const char *path, const grobo_motion *motion, grobo_body *body,
                grobo_slack_taken *slack)
{
    refusal r = {.robot = whole_robot_of(a, motion), .clamps = a->clamps, .slack = slack};
    grobo_body_check_options how = {GROBO_BODY_CHECK_OPTIONS_INIT, .robot = r.robot.model,
                                    .finding = note_finding, .ctx = &r};
    int error = grobo_body_check(body, &how);
    if (error < 0) {
        return fail(a, path, error);
    }
    if (!r.any) {
        return 0;
    }
    if (r.first.problem == GROBO_BODY_UNREACHABLE) {
        return app_fail(a, EXIT_SAFETY, grobo_error_name(GROBO_ERR_UNREACHABLE),
                        "%s: at %.2f s a leg does not reach its target (%s); see --ik off", path,
                        r.first.begin_s, r.robot.body->links[r.first.index].name);
    }
    return app_fail(a, EXIT_SAFETY, grobo_error_name(GROBO_ERR_LIMIT),
                    "%s: at %.2f s %s is %.1f deg outside its limits once the legs are solved; "
                    "--clamp plays it at the limit",
                    path, r.first.begin_s, grobo_model_joint(r.robot.model, r.first.index)->name,
                    grobo_deg_from_rad(r.first.worst));
}

/* ---- as a motion ---------------------------------------------------------------------------- */

/* A key pose at each key time. */
static int keys_motion(grobo_body *body, grobo_motion **out)
{
    grobo_clip clip;
    grobo_motion *motion = NULL;
    grobo_body_clip(body, false, &clip);
    int error = grobo_motion_new(GROBO_MOTION_KEYS, clip.n_joints, NULL, &motion);
    for (size_t i = 0; i < clip.n_keys && !error; i++) {
        grobo_posture posture;
        int64_t at_us = 0;
        error = clip.key(clip.ctx, i, &posture, &at_us);
        if (!error) {
            error = grobo_motion_append_at(motion, (double)at_us / 1e6, &posture);
        }
    }
    if (error) {
        grobo_motion_free(motion);
    } else {
        *out = motion;
    }
    return error;
}

static int make_motion(app *a, const char *path, grobo_body *body, double rate_hz,
                       grobo_motion **out)
{
    int n = rate_hz > 0 ? grobo_body_frames(body, NULL, out) : keys_motion(body, out);
    if (n < 0) {
        return fail(a, path, n);
    }
    if (n > 0) {
        app_note(a, "%s: in %d frames a leg does not reach its target", path, n);
    }
    return 0;
}

int body_solve(app *a, int base, const char *path, const grobo_motion *motion, double rate_hz,
               grobo_motion **solved)
{
    grobo_body *body = NULL;
    grobo_kept kept;
    int status = body_make(a, base, path, motion, rate_hz, &body);
    if (!status && body) {
        status = make_motion(a, path, body, rate_hz, solved);
    }
    grobo_body_free(body);
    if (*solved) {
        (void)grobo_motion_set_name(*solved, grobo_motion_name(motion));
        (void)grobo_motion_set_target_body(*solved, grobo_motion_target_body(motion));
        for (size_t i = 0; grobo_motion_get_kept(motion, GROBO_MOTION_TOP, i, &kept) == 0; i++) {
            (void)grobo_motion_keep(*solved, GROBO_MOTION_TOP, &kept);
        }
    }
    return status;
}
