/* SPDX-License-Identifier: MIT */
/* What the parts of `serve` share: the robot, who drives it, what was told. */
#ifndef GRCTL_WEB_SERVE_H
#define GRCTL_WEB_SERVE_H

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/web/based.h"
#include "tools/grctl/web/events.h"
#include "tools/grctl/web/http.h"
#include "tools/grctl/web/lease.h"
#include "tools/grctl/web/library.h"
#include "tools/grctl/web/player.h"
#include "tools/grctl/web/stops.h"
#include "tools/grctl/web/tilt.h"
#include "tools/grctl/web/web.h"
#include "tools/grctl/web/worker.h"

/* How often a state is told; and how often is looked while nobody is there to be told. */
#define SERVE_STATE_US INT64_C(33333)
#define SERVE_IDLE_US INT64_C(1000000)
/* Nobody is there when the last request is so old, and no connection is left. */
#define SERVE_LEFT_US INT64_C(5000000)
/* Silence of who drives: jogging ends; a motion ends, and the lease. */
#define SERVE_JOG_LOST_US INT64_C(1000000)
#define SERVE_PLAY_LOST_US INT64_C(3000000)

/* A request for each joint of a robot, and some. */
enum { SERVE_JOBS = GROBO_JOINTS_MAX + 16, SERVE_HEARTBEAT_MS = 200 };

/* A job of the engine's that a request began. */
typedef struct serve_job {
    int number; /* 0: none */
    const char *doing;
    bool told;             /* nobody asked for it: its end is no news */
    http_request *waiting; /* for the angles it reads, or NULL */
    grobo_joint_mask joints;
} serve_job;

typedef struct serve serve;
struct serve {
    conn c;
    conn_link link; /* its loop, from before the robot is opened */
    bool ready;     /* the robot is there: before that only a stop is answered */
    app *a;
    const web_options *options;
    const grobo_model *model;
    http *http;
    struct event *tick;
    bool idle, warm;  /* nobody is there; torque was on then */
    int64_t asked_us; /* the last request */
    int64_t began_us;
    based based;     /* which state a request had seen */
    uint64_t paused; /* the state that the last pause made */
    events events;
    lease lease;
    int64_t left_us; /* when the lease was given back with something under way, 0: not */
    stops stops;
    worker *worker;
    library *library;
    player player;
    tilt tilt;
    serve_job jobs[SERVE_JOBS];
    grobo_joint_mask limp; /* in free mode */
    /* jogging: the newest target */
    grobo_posture jog;
    bool jogs, jog_waits;
    /* the load of the line, over the last second */
    int64_t load_us;
    uint64_t load_bytes;
    unsigned readings;
    double load_pct, load_hz; /* NAN: not known yet */
    bool ending;              /* a signal came: nothing more is begun */
};

/* Milliseconds of the server's clock. */
int64_t serve_ms(const serve *s, int64_t at_us);

/* Notes a job: its end becomes an event. Returns the number, or the error. */
int serve_note_job(serve *s, int job, const char *doing);
/* The same of a reading: its end answers this request, with the angles of these joints. Requests
 * may share a job. @return job, or GROBO_ERR_FULL. */
int serve_await_job(serve *s, int job, http_request *r, grobo_joint_mask joints);

/* Whether something moves, or is about to. */
bool serve_is_moving(const serve *s);

/* The engine's configuration while it serves. */
grobo_robot_config serve_config(const serve *s);

/* A request: from now on the state is fresh. */
void serve_wake(serve *s);

/* What a request is based on is still so; else it is refused. `doing`: "reset". */
bool serve_is_based(serve *s, http_request *r, const json_t *body, const char *doing);

/* ---- requests: by path ----------------------------------------------------------------------- */

bool serve_rule(void *ctx, const http_request *r, access_rule *rule);
void serve_request(void *ctx, http_request *r);
void serve_early(void *ctx, const http_request *r);

/* ---- JSON ------------------------------------------------------------------------------------ */

json_t *serve_robot_json(serve *s);
json_t *serve_state_json(serve *s);

/* ---- refusals -------------------------------------------------------------------------------- */

/* What an error is told by; and which joint is to blame, of -1 none. */
json_t *serve_refusal(const char *code, const char *message);
void serve_blame(json_t *refusal, const serve *s, int joint, double value);
/* By an error of the library: "move: ...". */
void serve_refuse(serve *s, http_request *r, int error, const char *doing);
/* By what app_fail() said to an app that is hushed, and the exit status it gave. */
void serve_refuse_said(http_request *r, int status, const app *a);
/* {"done": ..., "job": ...} for what a request to the engine returned, or why not. */
void serve_accept(serve *s, http_request *r, int result, const char *doing);

/* ---- verbs ----------------------------------------------------------------------------------- */

typedef void (*serve_verb_fn)(serve *s, http_request *r, json_t *body);
void verb_pause(serve *s, http_request *r, json_t *body);
void verb_resume(serve *s, http_request *r, json_t *body);
void verb_seek(serve *s, http_request *r, json_t *body);
void verb_speed(serve *s, http_request *r, json_t *body);
void verb_halt(serve *s, http_request *r, json_t *body);
void verb_move(serve *s, http_request *r, json_t *body);
void verb_jog(serve *s, http_request *r, json_t *body);
void verb_drive(serve *s, http_request *r, json_t *body);
void verb_torque(serve *s, http_request *r, json_t *body);
void verb_capture(serve *s, http_request *r, json_t *body);
void verb_reset(serve *s, http_request *r, json_t *body);
/* Again and again while jogging: the newest target goes out when the engine takes it. */
void verb_jog_on(serve *s);

#endif
