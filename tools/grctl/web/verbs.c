/* SPDX-License-Identifier: MIT */
/* What a page may ask of the robot. */
#include <string.h>

#include <grobo/core/port.h>
#include <grobo/core/wheel.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/web/serve.h"

enum { MOVE_MS = 1000, JOG_MS = 300 };

/* ---- what a body has ------------------------------------------------------------------------- */

/* The joints of a FIELD_JOINTS: a list of names, or "all"; false: refused. */
static bool read_joints(serve *s, http_request *r, const json_t *given, grobo_joint_mask *joints)
{
    const char *names[CLI_ARGUMENTS_MAX];
    char said[APP_LINE_BYTES];
    app quiet = *s->a;
    size_t n = json_array_size(given);
    if (json_is_string(given)) {
        *joints = GROBO_JOINTS_ALL(s->model->n_joints);
        return true;
    }
    if (n == 0 || n > CLI_ARGUMENTS_MAX) { /* no name is not all names, as on a command line */
        http_refuse(r, 400, "arg", "joints: %zu names; expected 1 to %d", n, CLI_ARGUMENTS_MAX);
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        names[i] = json_string_value(json_array_get(given, i));
    }
    app_hush(&quiet, said);
    int status = joints_parse_all(&quiet, (int)n, names, joints);
    if (status) {
        serve_refuse_said(r, status, &quiet);
    }
    return status == 0;
}

/* {"R_KNEE_P": -40}; false: refused. */
static bool read_angles(serve *s, http_request *r, const json_t *angles, const char *doing,
                        grobo_posture *target)
{
    char said[APP_LINE_BYTES];
    const char *name;
    json_t *value;
    app quiet = *s->a;
    int status = 0;
    app_hush(&quiet, said);
    grobo_posture_init(target, s->model->n_joints);
    json_object_foreach((json_t *)angles, name, value)
    {
        int joint = joints_parse_one(&quiet, name, strlen(name), &status);
        if (joint < 0) {
            serve_refuse_said(r, status, &quiet);
            return false;
        }
        grobo_posture_set_deg(target, joint, json_number_value(value));
    }
    status = joints_check_limits(&quiet, target, doing);
    if (status) {
        int joint = -1;
        grobo_posture_check(target, s->model, &joint);
        json_t *error = serve_refusal(quiet.failed, said);
        serve_blame(error, s, joint, joint >= 0 ? grobo_deg_from_rad(target->angle_rad[joint]) : 0);
        http_reply_json(r, 422, json_pack("{s:o}", "error", error));
    }
    return status == 0;
}

static void read_time(const json_t *body, double otherwise, grobo_posture *target)
{
    const json_t *time = json_object_get(body, "time_ms");
    grobo_posture_set_time_ms(target, time ? json_number_value(time) : otherwise);
}

/* ---- a motion -------------------------------------------------------------------------------- */

void verb_pause(serve *s, http_request *r, json_t *body)
{
    (void)body;
    int result = grobo_robot_pause(s->c.robot);
    if (result >= 0) { /* a resume from before is void; where to go on from may be chosen */
        based_tell(&s->based, grobo_now_us());
        s->paused = s->based.sequence;
    }
    serve_accept(s, r, result, "pause");
}

void verb_resume(serve *s, http_request *r, json_t *body)
{
    json_int_t seen = json_integer_value(json_object_get(body, "sequence"));
    if ((uint64_t)seen < s->paused) {
        http_refuse(r, 409, "stale",
                    "resume: based on state %lld, but since then: the motion was paused; look at "
                    "the present state first",
                    (long long)seen);
        return;
    }
    serve_accept(s, r, grobo_robot_resume(s->c.robot), "resume");
}

void verb_seek(serve *s, http_request *r, json_t *body)
{
    double ms = json_number_value(json_object_get(body, "t_ms"));
    serve_accept(s, r, grobo_robot_seek(s->c.robot, (int64_t)(ms * 1000)), "seek");
}

void verb_speed(serve *s, http_request *r, json_t *body)
{
    double pct = json_number_value(json_object_get(body, "speed_pct"));
    int result = grobo_robot_speed(s->c.robot, (int)pct);
    if (result >= 0) {
        s->player.speed_pct = (uint16_t)pct;
    }
    serve_accept(s, r, result, "speed");
}

void verb_halt(serve *s, http_request *r, json_t *body)
{
    (void)body;
    stops_halt(s);
    serve_accept(s, r, GROBO_OK, "halt");
}

/* ---- joints ---------------------------------------------------------------------------------- */

void verb_move(serve *s, http_request *r, json_t *body)
{
    const json_t *pose = json_object_get(body, "pose"),
                 *angles = json_object_get(body, "angle_deg");
    grobo_posture target;
    if (!pose == !angles) {
        http_refuse(r, 400, "arg", "move: expected either angle_deg or pose");
        return;
    }
    if (pose) {
        grobo_posture_init_pose(&target, s->model);
    } else if (!read_angles(s, r, angles, "move", &target)) {
        return;
    }
    read_time(body, MOVE_MS, &target);
    s->jogs = s->jog_waits = false;
    int job = grobo_robot_move(s->c.robot, &target);
    serve_accept(s, r, serve_note_job(s, job, "move"), "move");
}

/* The newest target: into the move that is under way, else a new one. Later where neither goes. */
void verb_jog_on(serve *s)
{
    if (!s->jog_waits || !s->c.up) {
        return;
    }
    grobo_robot *robot = s->c.robot;
    int job = grobo_robot_retarget(robot, &s->jog);
    if (job == GROBO_ERR_STATE && grobo_robot_job(robot) != GROBO_JOB_MOVE &&
        grobo_robot_job(robot) != GROBO_JOB_PLAY) {
        job = grobo_robot_move(robot, &s->jog);
        if (job > 0) {
            serve_note_job(s, job, NULL);
        }
    }
    if (job >= 0) {
        s->jog_waits = false;
    } else if (job != GROBO_ERR_STATE && job != GROBO_ERR_FULL) {
        s->jogs = s->jog_waits = false;
        events_tell(&s->events, "job", "error",
                    json_pack("{s:o}", "result", app_json_code(grobo_error_name(job))), "jog: %s",
                    grobo_error_text(job));
    }
}

void verb_jog(serve *s, http_request *r, json_t *body)
{
    grobo_posture target;
    if (!read_angles(s, r, json_object_get(body, "angle_deg"), "jog", &target)) {
        return;
    }
    read_time(body, JOG_MS, &target);
    if (!s->jogs && serve_is_moving(s)) {
        serve_refuse(s, r, GROBO_ERR_STATE, "jog");
        return;
    }
    /* What a target sets must include what the one before has set. */
    if (s->jogs && grobo_robot_job(s->c.robot) == GROBO_JOB_MOVE) {
        grobo_posture before = s->jog;
        int64_t time_us = target.time_us;
        grobo_posture_merge(&before, &target);
        target = before;
        target.time_us = time_us;
    }
    s->jog = target;
    s->jogs = s->jog_waits = true;
    verb_jog_on(s);
    if (!s->jogs) {
        serve_refuse(s, r, GROBO_ERR_STATE, "jog");
        return;
    }
    serve_accept(s, r, GROBO_OK, "jog");
}

/* {"left": 90}, degrees a second; false: refused. */
static bool read_speeds(serve *s, http_request *r, const json_t *speeds, grobo_joint_mask *wheels,
                        double *rad_s)
{
    char said[APP_LINE_BYTES];
    const char *name;
    json_t *value;
    app quiet = *s->a;
    app_hush(&quiet, said);
    *wheels = 0;
    json_object_foreach((json_t *)speeds, name, value)
    {
        int status = 0, joint = joints_parse_one(&quiet, name, strlen(name), &status);
        if (joint < 0) {
            serve_refuse_said(r, status, &quiet);
            return false;
        }
        if (!(grobo_model_wheels(s->model) & GROBO_JOINT_BIT(joint))) {
            http_refuse(r, 422, "unsupported", "drive: %s is not a wheel",
                        grobo_model_joint(s->model, joint)->name);
            return false;
        }
        *wheels |= GROBO_JOINT_BIT(joint);
        rad_s[joint] = grobo_rad_from_deg(json_number_value(value));
    }
    return true;
}

static bool all_on(serve *s, grobo_joint_mask joints)
{
    bool on = true;
    for (int j = 0; j < s->model->n_joints; j++) {
        grobo_joint_info info;
        on = on && (!(joints & GROBO_JOINT_BIT(j)) ||
                    (grobo_robot_joint(s->c.robot, j, &info) >= 0 && info.torque_known &&
                     info.state.torque == GROBO_TORQUE_ON));
    }
    return on;
}

/* A speed holds for 0.5 s: the page asks again while a finger holds the slider. Wheels without
 * torque get it first, and turn by the next request. */
void verb_drive(serve *s, http_request *r, json_t *body)
{
    double rad_s[GROBO_JOINTS_MAX] = {0};
    grobo_joint_mask wheels;
    if (!read_speeds(s, r, json_object_get(body, "speed_dps"), &wheels, rad_s)) {
        return;
    }
    int result = grobo_robot_drive(s->c.robot, wheels, rad_s);
    if ((result == GROBO_ERR_STATE || result == GROBO_ERR_STALE) && !all_on(s, wheels)) {
        result = serve_note_job(s, grobo_robot_torque(s->c.robot, wheels, GROBO_TORQUE_ON), NULL);
    }
    serve_accept(s, r, result, "drive");
}

/* Less torque does not wait for a move to end: it ends the move. */
static int switch_torque(serve *s, grobo_joint_mask joints, grobo_torque mode)
{
    grobo_robot *robot = s->c.robot;
    int result = grobo_robot_torque(robot, joints, mode);
    if (result == GROBO_ERR_STATE && mode != GROBO_TORQUE_ON &&
        grobo_robot_cancel(robot) == GROBO_OK) {
        result = grobo_robot_torque(robot, joints, mode);
    }
    if (result >= 0) {
        s->limp &= ~joints;
    }
    return result;
}

/* Free mode begins at once, and ends as a job. */
static int set_limp(serve *s, grobo_joint_mask joints, bool on)
{
    int result = grobo_robot_free(s->c.robot, joints, on);
    if (result >= 0) {
        s->limp = on ? s->limp | joints : s->limp & ~joints;
    }
    return result;
}

void verb_torque(serve *s, http_request *r, json_t *body)
{
    static const struct {
        const char *word;
        bool limp, on;
        grobo_torque mode;
    } modes[] = {{"on", false, true, GROBO_TORQUE_ON},
                 {"off", false, false, GROBO_TORQUE_OFF},
                 {"brake", false, false, GROBO_TORQUE_BRAKE},
                 {"limp", true, true, GROBO_TORQUE_OFF},
                 {"hold", true, false, GROBO_TORQUE_ON}};
    const char *word = json_string_value(json_object_get(body, "mode"));
    grobo_joint_mask joints;
    if (!read_joints(s, r, json_object_get(body, "joints"), &joints)) {
        return;
    }
    for (size_t i = 0; word && i < sizeof modes / sizeof modes[0]; i++) {
        if (strcmp(word, modes[i].word) == 0) {
            if (modes[i].mode == GROBO_TORQUE_ON || modes[i].limp) {
                if (!stops_may_move(s, r, body, "torque")) {
                    return;
                }
            }
            int result = modes[i].limp ? set_limp(s, joints, modes[i].on)
                                       : switch_torque(s, joints, modes[i].mode);
            if (result >= 0) {
                based_change(&s->based, grobo_now_us(), "torque was switched (%s)", word);
            }
            serve_accept(s, r, serve_note_job(s, result, "torque"), "torque");
            return;
        }
    }
    http_refuse(r, 400, "arg", "torque: mode is on, off, brake, limp or hold");
}

void verb_capture(serve *s, http_request *r, json_t *body)
{
    const json_t *given = json_object_get(body, "joints");
    grobo_joint_mask joints = GROBO_JOINTS_ALL(s->model->n_joints);
    if (given && !read_joints(s, r, given, &joints)) {
        return;
    }
    /* Those of several clients may be one job. */
    int job = grobo_robot_sense(s->c.robot, joints, GROBO_SENSE_FULL);
    job = serve_await_job(s, job, r, joints);
    if (job < 0) {
        serve_refuse(s, r, job, "capture");
    }
}

void verb_reset(serve *s, http_request *r, json_t *body)
{
    (void)body;
    int error = stops_reset(s);
    if (!error) {
        events_tell(&s->events, "stop", "info", NULL, "stop released; nothing moves by itself");
    }
    serve_accept(s, r, error, "reset");
}
