/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/core/motion.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/play/check.h"
#include "tools/grctl/play/play.h"

/* Legs given by ikLinks are no matter for a warning where they are solved. */
static void say_warnings(const app *a, const grobo_diagnostics *found, bool legs_solved)
{
    grobo_diagnostic d;
    for (size_t k = 0; grobo_diagnostics_get(found, k, &d) == 0; k++) {
        if (!legs_solved || strcmp(d.code, "legs-by-ik") != 0) {
            file_say_one(a, &d);
        }
    }
}

/* An angle outside its joint's limits: --clamp takes it to the limit. */
static bool is_limit(const grobo_diagnostic *d)
{
    return strcmp(d->code, "limit") == 0 || strcmp(d->code, "limit-between") == 0;
}

/* A motion of another robot was judged by file_fits(). */
static bool is_of_another(const grobo_diagnostic *d)
{
    return strcmp(d->code, "target-body") == 0 || strcmp(d->code, "joint-missing") == 0;
}

/* The first error that would be refused in play; false: there is none. */
static bool find_refused(const app *a, const grobo_diagnostics *found, grobo_diagnostic *d)
{
    for (size_t k = 0; grobo_diagnostics_get(found, k, d) == 0; k++) {
        if (d->severity == GROBO_SEVERITY_ERROR && !(a->clamps && is_limit(d)) &&
            !is_of_another(d)) {
            return true;
        }
    }
    return false;
}

static int fail(app *a, const char *path, int error)
{
    return app_fail_error(a, EXIT_FILE, error, "%s", path);
}

/* Whether it is still too fast however slowly it is played: no time lies between two postures. */
static bool has_no_time(const app *a, const playlist *list, int i)
{
    grobo_check_options how = {GROBO_CHECK_OPTIONS_INIT, .name = list->path[i], .speed_pct = 1};
    grobo_diagnostics *found = NULL;
    grobo_diagnostic d;
    bool refused = false;
    if (grobo_diagnostics_new(NULL, &found) == GROBO_OK &&
        grobo_motion_check(list->motion[i], app_model(a), &how, found) >= 0) {
        for (size_t k = 0; grobo_diagnostics_get(found, k, &d) == 0; k++) {
            refused = refused || strcmp(d.code, "too-fast") == 0;
        }
    }
    grobo_diagnostics_free(found);
    return refused;
}

/* Says the first thing that would be refused in play, with its place in the file. */
static int check_one(app *a, const playlist *list, int i, grobo_slack_taken *slack,
                     grobo_diagnostics *found)
{
    uint16_t speed_pct = list->options[i].speed_pct; /* beyond 100 % moves may be stretched */
    grobo_check_options how = {GROBO_CHECK_OPTIONS_INIT, .name = list->path[i],
                               .speed_pct = speed_pct < 100 ? speed_pct : 100, .slack = slack};
    grobo_diagnostic d;
    char text[1024];
    int error = grobo_motion_check(list->motion[i], app_model(a), &how, found);
    if (error < 0) {
        return fail(a, list->path[i], error);
    }
    if (!find_refused(a, found, &d)) {
        return list->body[i] ? body_refuse(a, list->path[i], list->motion[i], list->body[i], slack)
                             : 0;
    }
    file_format(&d, false, text, sizeof text);
    return app_fail(a, EXIT_SAFETY, is_limit(&d) ? "LIMIT" : "SPEED", "%s; %s", text,
                    is_limit(&d)              ? _("--clamp plays it at the limit")
                    : has_no_time(a, list, i) ? _("no --speed gives it time: give that posture a "
                                                  "later time in the file")
                                              : _("a lower --speed gives it time"));
}

/* One warning of angles that are played at a limit, one where the robot would fall. */
static int add_warnings(app *a, const playlist *list, int i, grobo_slack_taken *slack,
                        grobo_diagnostics *found)
{
    check_whole_how how = {.path = list->path[i],
                           .what = CHECK_FALL,
                           .speed_pct = list->options[i].speed_pct,
                           .slack = slack};
    grobo_body_options body;
    int error = body_options_read(a, PLAY_BODY, 0, &body);
    if (error) {
        return error;
    }
    check_report_slack(list->path[i], app_model(a), slack, found);
    if (app_option(a, PLAY_FORCE)->given || !config_warns_of_falls(a)) {
        return 0;
    }
    error = check_whole(a, list->motion[i], &body, &how, found);
    return error < 0 ? fail(a, list->path[i], error) : 0;
}

/* What the robot would refuse is refused before anything is opened. */
static int find_rate(app *a, grobo_budget *line)
{
    double rate_hz = app_number(a, PLAY_RATE, 0);
    int error = wire_budget(app_driver(a), (int)conn_baud(a), line);
    if (error < 0) {
        return app_fail_error(a, EXIT_USAGE, error, "play");
    }
    if (rate_hz > line->watched_hz && !app_option(a, PLAY_UNWATCHED)->given) {
        return app_fail(a, EXIT_SAFETY, grobo_error_name(GROBO_ERR_UNWATCHED),
                        "play: %.0f frames a second leave no time to read the joints (at most %d); "
                        "--unwatched plays them all the same",
                        rate_hz, line->watched_hz);
    }
    return 0;
}

static void set_options(grobo_play_options *o, const app *a, grobo_motion_kind kind)
{
    bool keyed = kind == GROBO_MOTION_POSTURES || kind == GROBO_MOTION_STEPS;
    *o = (grobo_play_options){GROBO_PLAY_OPTIONS_INIT};
    if (app_option(a, PLAY_KEY)->given) {
        keyed = true;
    }
    if (app_option(a, PLAY_RATE)->given) {
        keyed = false;
    }
    o->mode = keyed ? GROBO_PLAY_KEY : GROBO_PLAY_RATE;
    o->rate_hz = (uint16_t)app_number(a, PLAY_RATE, 0);
    o->unwatched = app_option(a, PLAY_UNWATCHED)->given > 0;
    o->reverse = app_option(a, PLAY_REVERSE)->given > 0;
    o->mirror = app_option(a, PLAY_MIRROR)->given > 0;
    o->repeat = (int32_t)app_number(a, PLAY_REPEAT, 1);
    o->speed_pct = (uint16_t)app_number(a, PLAY_SPEED, 100);
}

/* First what has a place in the file, then what only shows when the legs are solved. */
static int solve_and_check(app *a, playlist *list, int i, const grobo_budget *line)
{
    double rate_hz = list->options[i].rate_hz > 0 ? list->options[i].rate_hz : line->default_hz;
    grobo_slack_taken slack = {.n = 0};
    grobo_diagnostics *found = NULL;
    int status = body_make(a, PLAY_BODY, list->path[i], list->motion[i], rate_hz, &list->body[i]);
    int error = status ? 0 : grobo_diagnostics_new(NULL, &found);
    if (error) {
        return fail(a, list->path[i], error);
    }
    if (!status) {
        status = check_one(a, list, i, &slack, found);
    }
    if (!status) {
        status = add_warnings(a, list, i, &slack, found);
    }
    if (!status) {
        say_warnings(a, found, list->body[i] != NULL);
    }
    grobo_diagnostics_free(found);
    return status;
}

/* A file has the joints that it lists, the robot all: the others are not set. */
static void widen(const app *a, grobo_motion *motion)
{
    if (grobo_motion_joints(motion) < app_model(a)->n_joints) {
        (void)grobo_motion_set_joints(motion, app_model(a)->n_joints);
    }
}

static bool sets_joints(const grobo_motion *motion)
{
    grobo_posture posture;
    for (size_t i = 0; grobo_motion_get(motion, i, &posture) == 0; i++) {
        if (posture.set) {
            return true;
        }
    }
    return false;
}

/* The next of the list, with the line's budget. */
static int take(playlist *list, app *a, const char *path, grobo_motion *motion,
                const grobo_budget *line)
{
    int i = list->n++;
    list->path[i] = path;
    list->motion[i] = motion;
    int status = file_fits(a, path, motion, app_option(a, PLAY_FORCE)->given > 0);
    if (status) {
        return status;
    }
    widen(a, motion);
    if (grobo_motion_size(motion) == 0) {
        return app_fail(a, EXIT_FILE, "EMPTY", "%s: has no postures", path);
    }
    if (grobo_motion_length_us(motion, -1) > GROBO_PLAY_LENGTH_MAX_US) {
        return fail(a, path, GROBO_ERR_CAP);
    }
    set_options(&list->options[i], a, grobo_motion_get_kind(motion));
    status = solve_and_check(a, list, i, line);
    if (!status && !list->body[i] && !sets_joints(motion)) {
        return app_fail(a, EXIT_FILE, "EMPTY", "%s: no posture sets any joint", path);
    }
    return status;
}

int playlist_take(playlist *list, app *a, const char *path, grobo_motion *motion)
{
    grobo_budget line;
    memset(list, 0, sizeof *list);
    int status = find_rate(a, &line);
    if (status) {
        grobo_motion_free(motion);
        return status;
    }
    status = take(list, a, path, motion, &line);
    list->options[0].from_us = (int64_t)(app_number(a, PLAY_FROM, 0) * 1000);
    return status;
}

int playlist_load(playlist *list, app *a)
{
    grobo_budget line;
    memset(list, 0, sizeof *list);
    if (app_option(a, PLAY_RATE)->given && app_option(a, PLAY_KEY)->given) {
        return app_fail(a, EXIT_USAGE, "ARG", "play: --rate and --key cannot be used together");
    }
    if (a->line.n_arguments > PLAY_FILES_MAX) {
        return app_fail(a, EXIT_USAGE, "ARG", "play: more than %d files", PLAY_FILES_MAX);
    }
    int status = find_rate(a, &line);
    for (int i = 0; !status && i < a->line.n_arguments; i++) {
        grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(a),
                                   .keep_positions = true};
        grobo_motion *motion = NULL;
        status = file_load(a, a->line.argument[i], &read, &motion);
        if (!status) {
            status = take(list, a, a->line.argument[i], motion, &line);
        }
    }
    list->options[0].from_us = (int64_t)(app_number(a, PLAY_FROM, 0) * 1000);
    return status;
}

/* Files behind the first may move other joints. */
static grobo_joint_mask joints_behind(const app *a, const playlist *list)
{
    grobo_joint_mask joints = 0;
    grobo_posture posture;
    int64_t at_us;
    for (int i = 1; i < list->n; i++) {
        if (list->options[i].mirror) {
            return GROBO_JOINTS_ALL(app_model(a)->n_joints);
        }
        for (size_t k = 0; k < list->clip[i].n_keys; k++) {
            if (list->clip[i].key(list->clip[i].ctx, k, &posture, &at_us) >= 0) {
                joints |= posture.set;
            }
        }
    }
    return joints;
}

/* ---- within the slack of limits ------------------------------------------------------------- */

static int within_slack(const playlist_view *v, int error, grobo_posture *posture)
{
    for (int j = 0; error >= 0 && j < posture->n_joints && j < v->model->n_joints; j++) {
        if (posture->set & GROBO_JOINT_BIT(j)) {
            posture->angle_rad[j] = grobo_model_take_slack(v->model, j, posture->angle_rad[j]);
        }
    }
    return error;
}

static int slack_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    const playlist_view *v = ctx;
    return within_slack(v, v->clip.key(v->clip.ctx, i, posture, at_us), posture);
}

static int slack_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    const playlist_view *v = ctx;
    return within_slack(v, v->clip.sample(v->clip.ctx, t_us, posture), posture);
}

/* Increments are no angles: they are played as they are. */
static void play_within_slack(playlist_view *view, grobo_clip *clip)
{
    *clip = view->clip;
    if (clip->relative) {
        return;
    }
    clip->key = slack_key;
    clip->sample = clip->sample ? slack_sample : NULL;
    clip->ctx = view;
}

int playlist_prepare(playlist *list, app *a, const grobo_posture *start)
{
    grobo_clip_options how = {GROBO_CLIP_OPTIONS_INIT, .start = start};
    for (int i = 0; i < list->n; i++) {
        int error = 0;
        if (list->body[i]) {
            grobo_body_clip(list->body[i], true, &list->view[i].clip);
        } else {
            error = grobo_motion_clip(list->motion[i], i == 0 ? &how : NULL, &list->view[i].clip);
        }
        if (error) {
            return fail(a, list->path[i], error);
        }
        list->view[i].model = app_model(a);
        play_within_slack(&list->view[i], &list->clip[i]);
        if (list->options[i].from_us > list->clip[i].length_us) {
            return app_fail(a, EXIT_USAGE, "ARG", "play: --from is beyond the end of %s (%.0f ms)",
                            list->path[i], (double)list->clip[i].length_us / 1e3);
        }
    }
    list->options[0].also = joints_behind(a, list);
    return 0;
}

int playlist_prepare_sensed(playlist *list, conn *c)
{
    grobo_joint_mask all = GROBO_JOINTS_ALL(conn_model(c)->n_joints);
    grobo_posture sensed;
    int error = conn_sense(c, all, GROBO_SENSE_FULL);
    if (error) {
        return conn_fail(c, error, "play");
    }
    grobo_robot_posture(c->robot, GROBO_NEVER_US, &sensed);
    return playlist_prepare(list, c->a, &sensed);
}

void playlist_free(playlist *list)
{
    for (int i = 0; i < list->n; i++) {
        if (list->view[i].clip.key && !list->body[i]) {
            grobo_motion_clip_free(&list->view[i].clip);
        }
        grobo_body_free(list->body[i]);
        grobo_motion_free(list->motion[i]);
    }
    list->n = 0;
}
