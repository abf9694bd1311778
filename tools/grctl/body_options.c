/* SPDX-License-Identifier: MIT */
#include "body_options.h"
#include "whole.h"

bool body_options_given(const app *a, int base)
{
    for (int i = 0; i < BODY_OPTIONS; i++)
        if (app_option(a, base + i)->given)
            return true;
    return false;
}

static int fail(app *a, const char *path, int error)
{
    return app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: legs cannot be solved: %s", path,
                    grobo_error_text(error));
}

grobo_body_options body_options_read(const app *a, int base, double rate_hz)
{
    static const grobo_body_ik iks[] = {GROBO_BODY_IK_EXACT, GROBO_BODY_IK_NUMERIC,
                                        GROBO_BODY_IK_OFF};
    static const grobo_body_balance balances[] = {GROBO_BODY_BALANCE_OFF, GROBO_BODY_BALANCE_ON,
                                                  GROBO_BODY_BALANCE_COMPAT11};
    const cli_value *zmp = app_option(a, base + BODY_ZMP);
    return (grobo_body_options){
        .ik = iks[app_option(a, base + BODY_IK)->choice],
        .step = app_option(a, base + BODY_STEP)->choice == 1 ? GROBO_BODY_STEP_STEALTHY
                                                             : GROBO_BODY_STEP_NONE,
        .zmp = zmp->given && zmp->choice == 0 ? GROBO_BODY_ZMP_AUTO : GROBO_BODY_ZMP_FILE,
        .balance = balances[app_option(a, base + BODY_BALANCE)->choice],
        .rate_hz = rate_hz,
    };
}

int body_make(app *a, int base, const char *path, const grobo_motion *motion, double rate_hz,
              grobo_body **body)
{
    grobo_body_options options = body_options_read(a, base, rate_hz);
    int error;
    if (!whole_applies(motion, &options))
        return 0;
    error = grobo_body_new(body, &grobo_gr001_body, motion, &options, NULL);
    return error ? fail(a, path, error) : 0;
}

/* ---- refusing ------------------------------------------------------------------------------- */

typedef struct refusal {
    bool any, clamps;
    grobo_body_finding first;
} refusal;

static void note_finding(void *ctx, const grobo_body_finding *finding)
{
    refusal *r = ctx;
    bool refused = finding->problem == GROBO_BODY_UNREACHABLE ||
                   (finding->problem == GROBO_BODY_JOINT_LIMIT && !r->clamps);
    if (!refused || (r->any && r->first.begin_s <= finding->begin_s))
        return;
    r->any = true;
    r->first = *finding;
}

int body_refuse(app *a, const char *path, grobo_body *body)
{
    refusal r = {.clamps = a->clamps};
    grobo_body_check_options how = {
        .robot = &grobo_gr001_model, .finding = note_finding, .ctx = &r};
    int error = grobo_body_check(body, &how);
    if (error < 0)
        return fail(a, path, error);
    if (!r.any)
        return 0;
    if (r.first.problem == GROBO_BODY_UNREACHABLE)
        return app_fail(a, EXIT_SAFETY, grobo_error_name(GROBO_ERR_UNREACHABLE),
                        "%s: at %.2f s a leg does not reach its target (%s); see --ik off", path,
                        r.first.begin_s, grobo_gr001_body.links[r.first.index].name);
    return app_fail(a, EXIT_SAFETY, grobo_error_name(GROBO_ERR_LIMIT),
                    "%s: at %.2f s %s is %.1f deg outside its limits once the legs are solved; "
                    "--clamp plays it at the limit",
                    path, r.first.begin_s, grobo_gr001_model.joints[r.first.index].name,
                    grobo_deg_from_rad(r.first.worst));
}

/* ---- as a motion ---------------------------------------------------------------------------- */

/* A key pose at each key time. */
static int keys_motion(grobo_body *body, grobo_motion **out)
{
    grobo_clip clip;
    grobo_motion *motion = NULL;
    int error;
    grobo_body_clip(body, false, &clip);
    error = grobo_motion_new(&motion, GROBO_MOTION_KEYS, clip.n_joints, NULL);
    for (size_t i = 0; i < clip.n_keys && !error; i++) {
        grobo_posture posture;
        int64_t at_us = 0;
        error = clip.key(clip.ctx, i, &posture, &at_us);
        if (!error)
            error = grobo_motion_append_at(motion, (double)at_us / 1e6, &posture);
    }
    if (error)
        grobo_motion_free(motion);
    else
        *out = motion;
    return error;
}

int body_motion(app *a, const char *path, grobo_body *body, double rate_hz, grobo_motion **out)
{
    int n = rate_hz > 0 ? grobo_body_frames(body, NULL, out) : keys_motion(body, out);
    if (n < 0)
        return fail(a, path, n);
    if (n > 0)
        app_note(a, "%s: in %d frames a leg does not reach its target", path, n);
    return 0;
}
