/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/play/check.h"
#include "tools/grctl/web/analyse.h"
#include "tools/grctl/web/pose.h"

/* Frames of the balance, and how many of them are told. */
enum { BALANCE_HZ = 100, BALANCE_FRAMES_MAX = 10000, BALANCE_TOLD_MAX = 1500 };

bool analysis_begin(analysis *n, const app *a, const char *path)
{
    memset(n, 0, sizeof *n);
    n->app = *a;
    app_hush(&n->app, n->said);
    n->app.line =
        (cli_line){.command = cli_find_command("play"), .argument = {path}, .n_arguments = 1};
    memcpy(n->app.line.global, a->line.global, sizeof n->app.line.global);
    return grobo_diagnostics_new(NULL, &n->found) == GROBO_OK;
}

void analysis_end(analysis *n)
{
    playlist_free(&n->list);
    grobo_motion_free(n->motion);
    grobo_diagnostics_free(n->found);
    json_decref(n->findings);
    json_decref(n->balance);
}

static const char *path_of(const analysis *n)
{
    return n->app.line.argument[0];
}

/* ---- balance --------------------------------------------------------------------------------- */

typedef struct balancing {
    analysis *n;
    size_t every, seen; /* every so many frames are told */
    bool stood, steps;
    grobo_body_finding fall;
    bool falls;
} balancing;

static void tell(json_t *balance, const char *key, json_t *value)
{
    json_t *list = json_object_get(balance, key);
    if (!list) {
        list = json_array();
        json_object_set_new(balance, key, list);
    }
    json_array_append_new(list, value);
}

static json_t *point_json(const double *p)
{
    return json_pack("[o,o,o]", app_json_number(p[0], 4), app_json_number(p[1], 4),
                     app_json_number(p[2], 4));
}

static void see_frame(void *ctx, const grobo_body_balance_frame *frame)
{
    balancing *b = ctx;
    bool stands = frame->standing[0] || frame->standing[1];
    b->stood |= stands;
    if (!b->n->balance || b->seen++ % b->every != 0) {
        return;
    }
    tell(b->n->balance, "time_ms", app_json_number(frame->time_s * 1e3, 1));
    tell(b->n->balance, "margin_mm", app_json_number(stands ? frame->margin_m * 1e3 : NAN, 1));
    tell(b->n->balance, "com_m", point_json(frame->com_m));
    tell(b->n->balance, "zmp_m", point_json(frame->zmp_m));
}

static void see_finding(void *ctx, const grobo_body_finding *f)
{
    balancing *b = ctx;
    bool angle = f->problem == GROBO_BODY_JOINT_LIMIT || f->problem == GROBO_BODY_JOINT_SPEED;
    bool falls = f->problem == GROBO_BODY_NO_SUPPORT ||
                 (f->problem == GROBO_BODY_ZMP_MARGIN && f->worst < 0);
    b->steps |= f->problem == GROBO_BODY_FOOT_SLIP && f->worst > CHECK_STEP_LEAST_M;
    if (falls && (!b->falls || f->begin_s < b->fall.begin_s)) {
        b->falls = true;
        b->fall = *f;
    }
    json_t *finding = json_pack(
        "{s:o,s:o,s:o,s:o,s:o}", "problem", app_json_code(grobo_body_problem_name(f->problem)),
        "begin_ms", app_json_number(f->begin_s * 1e3, 1), "end_ms",
        app_json_number(f->end_s * 1e3, 1), "worst_ms", app_json_number(f->worst_s * 1e3, 1),
        "worst", app_json_number(angle ? grobo_deg_from_rad(f->worst) : f->worst, 5));
    if (angle) {
        json_object_set_new(finding, "joint", json_integer(f->index));
    }
    json_array_append_new(b->n->findings, finding);
}

/* As `check` judges it: a fall is told where it is certain. */
static void look_at_balance(analysis *n, bool told)
{
    double length_s = (double)grobo_motion_length_us(n->motion, -1) / 1e6;
    double rate_hz =
        length_s * BALANCE_HZ <= BALANCE_FRAMES_MAX ? BALANCE_HZ : BALANCE_FRAMES_MAX / length_s;
    grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .rate_hz = rate_hz};
    double speed_pct = app_number(&n->app, PLAY_SPEED, 100);
    balancing b = {.n = n, .every = (size_t)(length_s * rate_hz / BALANCE_TOLD_MAX) + 1};
    grobo_body_check_options look = {GROBO_BODY_CHECK_OPTIONS_INIT,
                                     .robot = app_model(&n->app),
                                     .speed_pct = (uint16_t)(speed_pct < 100 ? speed_pct : 100),
                                     .takes_slack = true,
                                     .frame = see_frame,
                                     .finding = see_finding,
                                     .ctx = &b};
    grobo_body *body = NULL;
    if (!pose_body(&n->app) ||
        whole_body(&n->app, &body, n->motion, &options, &n->assumed) != GROBO_OK) {
        return;
    }
    n->findings = json_array();
    n->balance =
        told ? json_pack("{s:[],s:[],s:[],s:[]}", "time_ms", "margin_mm", "com_m", "zmp_m") : NULL;
    if (grobo_body_check(body, &look) >= 0 && b.falls && b.stood && !(n->assumed && b.steps)) {
        n->falls = true;
        n->falls_s = b.fall.begin_s;
    }
    grobo_body_free(body);
}

/* ---- reading and checking -------------------------------------------------------------------- */

static void check(analysis *n, bool balance)
{
    grobo_slack_taken slack = {.n = 0};
    grobo_check_options how = {GROBO_CHECK_OPTIONS_INIT, .name = path_of(n), .slack = &slack};
    check_whole_how legs = {.path = path_of(n), .what = CHECK_LEGS, .slack = &slack};
    grobo_body_options body = {GROBO_BODY_OPTIONS_INIT, .rate_hz = 0};
    grobo_posture start;
    grobo_motion *copy = NULL;
    (void)grobo_motion_check(n->motion, app_model(&n->app), &how, n->found);
    (void)check_whole(&n->app, n->motion, &body, &legs, n->found);
    check_report_slack(path_of(n), app_model(&n->app), &slack, n->found);
    look_at_balance(n, balance);
    if (grobo_motion_dup(n->motion, &copy) != GROBO_OK) {
        n->status = app_fail_error(&n->app, EXIT_ROBOT, GROBO_ERR_NOMEM, "play");
        return;
    }
    n->status = file_fits(&n->app, path_of(n), n->motion, false);
    if (n->status) {
        grobo_motion_free(copy);
        return;
    }
    n->app.line.option[PLAY_FORCE].given = 1; /* where it would fall is known already */
    n->status = playlist_take(&n->list, &n->app, path_of(n), copy);
    if (!n->status) {
        grobo_posture_init_pose(&start, app_model(&n->app));
        n->status = playlist_prepare(&n->list, &n->app, &start);
        n->clip = n->status == 0;
    }
}

void analysis_take(analysis *n, grobo_motion *motion, bool balance)
{
    n->motion = motion;
    check(n, balance);
}

void analysis_read(analysis *n, const void *bytes, size_t size, bool balance)
{
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(&n->app),
                               .name = path_of(n), .keep_positions = true, .keep_going = true};
    grobo_motion *motion = NULL;
    int error = grobo_motion_read_memory(bytes, size, &read, n->found, &motion);
    if (error) {
        n->status = app_fail_error(&n->app, EXIT_FILE, error, "%s", path_of(n));
        return;
    }
    analysis_take(n, motion, balance);
}

/* ---- as JSON --------------------------------------------------------------------------------- */

static const char *first_error(const analysis *n)
{
    grobo_diagnostic d;
    for (size_t i = 0; grobo_diagnostics_get(n->found, i, &d) == 0; i++) {
        if (d.severity == GROBO_SEVERITY_ERROR) {
            return d.message;
        }
    }
    return NULL;
}

json_t *analysis_check_json(const analysis *n)
{
    json_t *message = json_null(), *refused = NULL;
    if (n->status) {
        const char *said = n->motion || !first_error(n) ? n->said : first_error(n);
        message = app_json_text(said);
        refused = json_pack("{s:o,s:o}", "code", app_json_code(n->app.failed), "message",
                            app_json_text(said));
    } else if (n->falls) {
        json_decref(message);
        message = json_sprintf("would fall at %.1f s", n->falls_s);
    }
    return json_pack(
        "{s:b,s:o?,s:I,s:I,s:o,s:o}", "ok", n->status == 0, "refused", refused, "errors",
        (json_int_t)grobo_diagnostics_total(n->found, GROBO_SEVERITY_ERROR), "warnings",
        (json_int_t)grobo_diagnostics_total(n->found, GROBO_SEVERITY_WARNING), "falls_ms",
        app_json_number(n->falls ? n->falls_s * 1e3 : NAN, 1), "message", message);
}

json_t *analysis_diagnostics_json(const analysis *n)
{
    json_t *list = file_json(n->found), *d;
    size_t i;
    json_array_foreach(list, i, d)
    {
        json_object_del(d, "file");
    }
    return list;
}

json_t *analysis_balance_json(const analysis *n)
{
    if (!n->balance) {
        return json_null();
    }
    json_t *balance = json_pack("{s:b,s:O}", "assumed", n->assumed, "findings", n->findings);
    json_object_update(balance, n->balance);
    return balance;
}

static json_t *vector_json(const double *values, int n)
{
    json_t *list = json_array();
    for (int i = 0; i < n; i++) {
        json_array_append_new(list, json_real(isfinite(values[i]) ? values[i] : 0));
    }
    return list;
}

static json_t *link_json(const grobo_ik_link *l)
{
    return json_pack("{s:o,s:o,s:o,s:b,s:b,s:b,s:b}", "link",
                     *l->name ? app_json_text(l->name) : json_sprintf("%d", l->index), "p_m",
                     vector_json(l->translation_m, 3), "rotation", vector_json(l->rotation, 9),
                     "base", l->is_base, "stationary", l->is_stationary, "touching", l->is_touching,
                     "slave", l->is_slave);
}

static json_t *key_json(const analysis *n, size_t i)
{
    grobo_posture posture;
    grobo_key_info info;
    double time_s = 0;
    size_t n_links;
    json_t *links = json_array();
    grobo_motion_get(n->motion, i, &posture);
    grobo_motion_get_key(n->motion, i, &info);
    grobo_motion_time_s(n->motion, i, &time_s);
    const grobo_ik_link *link = grobo_motion_ik_links(n->motion, i, &n_links);
    for (size_t k = 0; k < n_links; k++) {
        json_array_append_new(links, link_json(&link[k]));
    }
    return json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "time_ms", app_json_number(time_s * 1e3, 6),
                     "name", app_json_text(grobo_motion_key_name(n->motion, i)), "angle_deg",
                     pose_angles_json(&posture, app_model(&n->app)->n_joints, 3), "stationary",
                     joints_json(info.stationary & GROBO_JOINTS_ALL(posture.n_joints)), "links",
                     links, "zmp_m", info.has_zmp ? vector_json(info.zmp_m, 3) : json_null(),
                     "max_transition_ms", app_json_number(info.max_transition_s * 1e3, 6));
}

json_t *analysis_keys_json(const analysis *n)
{
    json_t *list = json_array();
    size_t size = n->motion ? grobo_motion_size(n->motion) : 0;
    bool frames = n->motion && grobo_motion_get_kind(n->motion) == GROBO_MOTION_FRAMES;
    for (size_t i = 0; i < size && i < ANALYSE_FRAMES_MAX && !frames; i++) {
        json_array_append_new(list, key_json(n, i));
    }
    return list;
}

double analysis_length_ms(const analysis *n)
{
    return n->clip     ? (double)n->list.clip[0].length_us / 1e3
           : n->motion ? (double)grobo_motion_length_us(n->motion, -1) / 1e3
                       : 0;
}

const char *analysis_kind(const analysis *n)
{
    static const char *const kinds[] = {"postures", "keys", "steps", "frames"};
    return kinds[n->motion ? grobo_motion_get_kind(n->motion) : GROBO_MOTION_POSTURES];
}

/* At a time of the way it is played: reversed and mirrored as that is. */
static bool sample(analysis *n, int64_t t_us, grobo_posture *posture, json_t **root)
{
    const grobo_clip *clip = &n->list.clip[0];
    const grobo_play_options *o = &n->list.options[0];
    grobo_body *body = n->list.body[0];
    grobo_body_report report;
    double q_rad[GROBO_JOINTS_MAX];
    t_us = o->reverse ? clip->length_us - t_us : t_us;
    if (!clip->sample || clip->sample(clip->ctx, t_us, posture) < 0) {
        return false;
    }
    if (body && !o->mirror && grobo_body_sample(body, (double)t_us / 1e6, q_rad, &report) == 0) {
        *root = pose_placement_json(&report.root);
    }
    if (o->mirror) {
        grobo_posture_mirror(posture, app_model(&n->app));
    }
    if (!*root) {
        *root = pose_root_json(&n->app, posture);
    }
    return true;
}

typedef struct frames {
    json_t *time_ms, *angle_deg, *root;
} frames;

static void add_frame(analysis *n, int64_t t_us, frames *f)
{
    grobo_posture posture;
    json_t *root = NULL;
    if (!n->clip || !sample(n, t_us, &posture, &root)) {
        return;
    }
    json_array_append_new(f->time_ms, app_json_number((double)t_us / 1e3, 1));
    json_array_append_new(f->angle_deg,
                          pose_angles_json(&posture, app_model(&n->app)->n_joints, 3));
    json_array_append_new(f->root, root);
}

/* No list of roots where there is no body. */
static json_t *roots_json(const analysis *n, json_t *roots)
{
    if (pose_body(&n->app)) {
        return roots;
    }
    json_decref(roots);
    return json_null();
}

json_t *analysis_frames_json(analysis *n, double rate_hz)
{
    frames f = {json_array(), json_array(), json_array()};
    double length_s = n->clip ? (double)n->list.clip[0].length_us / 1e6 : 0;
    if (length_s * rate_hz >= ANALYSE_FRAMES_MAX) {
        rate_hz = (ANALYSE_FRAMES_MAX - 1) / length_s;
    }
    for (int i = 0; i <= (int)(length_s * rate_hz + 1e-9); i++) {
        add_frame(n, (int64_t)llround(i * 1e6 / rate_hz), &f);
    }
    json_decref(f.time_ms);
    return json_pack("{s:o,s:o,s:o}", "rate_hz", app_json_number(rate_hz, 6), "angle_deg",
                     f.angle_deg, "root", roots_json(n, f.root));
}

json_t *analysis_thumbnail_json(analysis *n)
{
    frames f = {json_array(), json_array(), json_array()};
    int64_t length_us = n->clip ? n->list.clip[0].length_us : 0;
    for (int i = 0; i < ANALYSE_POSES; i++) {
        add_frame(n, length_us * i / (ANALYSE_POSES - 1), &f);
    }
    return json_pack("{s:o,s:o,s:o}", "time_ms", f.time_ms, "angle_deg", f.angle_deg, "root",
                     roots_json(n, f.root));
}
