/* SPDX-License-Identifier: MIT */
/* What every part of `serve` says to a request, and asks of the robot. */
#include <string.h>

#include <event2/event.h>

#include <grobo/core/port.h>

#include "tools/grctl/web/serve.h"

/* Each joint is read so often: what a picture needs that is drawn between two readings; and while
 * nobody looks and nothing has torque, for who asks once in a while. */
enum { SENSE_US = 200000, LIMP_US = 30000000 };

int64_t serve_ms(const serve *s, int64_t at_us)
{
    return (at_us - s->began_us) / 1000;
}

grobo_robot_config serve_config(const serve *s)
{
    grobo_robot_config config = conn_robot_config(s->a);
    config.sense_interval_us = !s->idle ? SENSE_US : s->warm ? 0 : LIMP_US;
    return config;
}

void serve_wake(serve *s)
{
    s->asked_us = grobo_now_us();
    if (s->idle) { /* what is told now is no state of long ago */
        based_tell(&s->based, s->asked_us);
        event_active(s->tick, EV_TIMEOUT, 0);
    }
}

bool serve_is_moving(const serve *s)
{
    return s->c.up && (grobo_robot_moving(s->c.robot) || grobo_robot_is_playing(s->c.robot) ||
                       grobo_robot_job(s->c.robot) == GROBO_JOB_PLAY);
}

bool serve_is_based(serve *s, http_request *r, const json_t *body, const char *doing)
{
    char complaint[BASED_COMPLAINT_BYTES];
    bool fine =
        based_check(&s->based, json_object_get(body, "sequence"), grobo_now_us(), doing, complaint);
    if (!fine) {
        json_t *refusal = serve_refusal("stale", complaint);
        json_object_set_new(refusal, "sequence", json_integer((json_int_t)s->based.sequence));
        http_reply_json(r, 409, json_pack("{s:o}", "error", refusal));
    }
    return fine;
}

/* A place for a job; the end of an older one is no news where all are taken, but who waits for it
 * gets its answer. */
static serve_job *place_of(serve *s)
{
    serve_job *slot = NULL;
    for (int i = SERVE_JOBS - 1; i >= 0; i--) {
        if (s->jobs[i].number == 0 || (!s->jobs[i].waiting && (!slot || slot->number != 0))) {
            slot = &s->jobs[i];
        }
    }
    return slot;
}

int serve_note_job(serve *s, int job, const char *doing)
{
    for (int i = 0; i < SERVE_JOBS; i++) {
        if (job > 0 && s->jobs[i].number == job) {
            return job; /* it joined one that is told already */
        }
    }
    serve_job *slot = place_of(s);
    if (job > 0 && slot) {
        *slot = (serve_job){.number = job, .doing = doing};
    }
    return job;
}

int serve_await_job(serve *s, int job, http_request *r, grobo_joint_mask joints)
{
    serve_job *slot = place_of(s);
    if (job > 0 && !slot) {
        return GROBO_ERR_FULL;
    }
    if (job > 0) {
        *slot = (serve_job){.number = job, .waiting = r, .joints = joints};
    }
    return job;
}

/* ---- refusals -------------------------------------------------------------------------------- */

static int status_of(int error)
{
    switch (error) {
    case GROBO_ERR_ARG:
    case GROBO_ERR_SYNTAX:
        return 400;
    case GROBO_ERR_NOENT:
    case GROBO_ERR_NOTFOUND:
        return 404;
    case GROBO_ERR_LIMIT:
    case GROBO_ERR_NAN:
    case GROBO_ERR_SPEED:
    case GROBO_ERR_UNREACHABLE:
    case GROBO_ERR_UNWATCHED:
    case GROBO_ERR_UNSUPPORTED:
    case GROBO_ERR_EMPTY:
        return 422;
    case GROBO_ERR_CLOSED:
    case GROBO_ERR_UNPLUGGED:
    case GROBO_ERR_NOMEM:
    case GROBO_ERR_TIMEOUT:
    case GROBO_ERR_IO:
        return 503;
    }
    return 409;
}

json_t *serve_refusal(const char *code, const char *message)
{
    return json_pack("{s:o,s:o}", "code", app_json_code(code), "message", app_json_text(message));
}

void serve_blame(json_t *refusal, const serve *s, int joint, double value)
{
    if (joint >= 0 && joint < s->model->n_joints) {
        json_object_set_new(refusal, "joint", json_integer(joint));
        json_object_set_new(refusal, "name", json_string(grobo_model_joint(s->model, joint)->name));
        json_object_set_new(refusal, "value", app_json_number(value, 3));
    }
}

void serve_refuse(serve *s, http_request *r, int error, const char *doing)
{
    json_t *refusal = json_pack("{s:o,s:o}", "code", app_json_code(grobo_error_name(error)),
                                "message", json_sprintf("%s: %s", doing, grobo_error_text(error)));
    double value = 0;
    int joint = error == GROBO_ERR_LIMIT || error == GROBO_ERR_NAN
                    ? grobo_robot_fault(s->c.robot, &value)
                    : -1;
    serve_blame(refusal, s, joint, value);
    if (error == GROBO_ERR_LATCHED && s->c.trip.trip != GROBO_TRIP_NONE) {
        json_object_set_new(refusal, "trip", app_json_code(grobo_trip_name(s->c.trip.trip)));
    }
    http_reply_json(r, status_of(error), json_pack("{s:o}", "error", refusal));
}

void serve_refuse_said(http_request *r, int status, const app *a)
{
    static const int statuses[] = {200, 409, 400, 422, 422};
    bool missing = strcmp(a->failed, grobo_error_name(GROBO_ERR_NOENT)) == 0 ||
                   strcmp(a->failed, grobo_error_name(GROBO_ERR_NOTFOUND)) == 0;
    json_t *refusal = serve_refusal(a->failed, a->hushed);
    int found = status > 0 && status <= EXIT_SAFETY ? statuses[status] : 409;
    if (strcmp(a->failed, grobo_error_name(GROBO_ERR_TYPE)) == 0) {
        found = 422; /* a motion of another robot */
    }
    http_reply_json(r, missing ? 404 : found, json_pack("{s:o}", "error", refusal));
}

void serve_accept(serve *s, http_request *r, int result, const char *doing)
{
    if (result < 0) {
        serve_refuse(s, r, result, doing);
        return;
    }
    json_t *body =
        json_pack("{s:b,s:I}", "done", result == 0, "sequence", (json_int_t)s->based.sequence);
    if (result > 0) {
        json_object_set_new(body, "job", json_integer(result));
    }
    http_reply_json(r, 200, body);
}
