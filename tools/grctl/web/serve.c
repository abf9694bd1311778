/* SPDX-License-Identifier: MIT */
/* serve: the loop, the robot's events, who drives. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <event2/http.h>

#include <grobo/core/port.h>

#include "tools/grctl/web/listener.h"
#include "tools/grctl/web/pose.h"
#include "tools/grctl/web/serve.h"

/* ---- jobs ------------------------------------------------------------------------------------ */

static json_t *result_json(const serve *s, const grobo_event_job *job)
{
    json_t *more = json_pack("{s:i,s:o}", "job", job->number, "result",
                             app_json_code(grobo_error_name(job->result)));
    if (job->result < 0 && job->joint >= 0 && job->joint < s->model->n_joints) {
        json_object_set_new(more, "joint", json_integer(job->joint));
    }
    return more;
}

/* The words of the command for an error of the robot. */
static void explain(serve *s, int error, const char *doing, char said[APP_LINE_BYTES])
{
    app *a = s->c.a, quiet = *a;
    *said = '\0';
    app_hush(&quiet, said);
    s->c.a = &quiet;
    (void)conn_fail(&s->c, error, doing);
    s->c.a = a;
}

static void say_end(serve *s, const serve_job *j, const grobo_event_job *job)
{
    char said[APP_LINE_BYTES];
    bool ours = job->result == GROBO_ERR_CANCELED || job->result == GROBO_ERR_SUPERSEDED;
    if (job->result >= 0 || ours) {
        events_tell(&s->events, "job", "info", result_json(s, job), "%s: %s", j->doing,
                    ours ? "stopped" : "done");
        return;
    }
    s->c.job = *job;
    explain(s, job->result, j->doing, said);
    events_tell(&s->events, "job", "error", result_json(s, job), "%s", said);
}

static void answer_capture(serve *s, const serve_job *j, const grobo_event_job *job)
{
    grobo_posture posture;
    if (job->result < 0 && job->failed == 0) {
        serve_refuse(s, j->waiting, job->result, "capture");
        return;
    }
    grobo_robot_posture(s->c.robot, GROBO_NEVER_US, &posture);
    posture.set &= j->joints & ~job->failed;
    http_reply_json(j->waiting, 200,
                    json_pack("{s:I,s:o}", "sequence", (json_int_t)s->based.sequence, "angle_deg",
                              pose_angles_json(&posture, s->model->n_joints, 2)));
}

static void end_job(serve *s, const grobo_event_job *job)
{
    for (int i = 0; i < SERVE_JOBS; i++) {
        serve_job j = s->jobs[i];
        if (j.number != job->number) {
            continue;
        }
        memset(&s->jobs[i], 0, sizeof s->jobs[i]);
        if (j.waiting) {
            answer_capture(s, &j, job);
        } else if (j.doing) {
            say_end(s, &j, job);
        }
    }
}

/* ---- what comes from the robot --------------------------------------------------------------- */

static void say_trip(serve *s)
{
    char said[APP_LINE_BYTES];
    if (s->stops.latched) { /* by us: it was told */
        return;
    }
    explain(s, GROBO_ERR_LATCHED, "robot", said);
    json_t *more = json_pack("{s:o}", "trip", app_json_code(grobo_trip_name(s->c.trip.trip)));
    if (s->c.trip.joint >= 0) {
        json_object_set_new(more, "joint", json_integer(s->c.trip.joint));
    }
    s->jogs = s->jog_waits = false;
    based_change(&s->based, grobo_now_us(), "safety stop: %s", grobo_trip_name(s->c.trip.trip));
    events_tell(&s->events, "trip", "error", more, "%s", said);
}

static void on_event(conn *c, const grobo_event *event)
{
    serve *s = c->ctx;
    stops_on_event(s, event);
    player_on_event(s, event);
    switch (event->kind) {
    case GROBO_EVENT_JOB:
        end_job(s, &event->u.job);
        verb_jog_on(s);
        break;
    case GROBO_EVENT_TRIP:
        say_trip(s);
        break;
    case GROBO_EVENT_LINK_DOWN:
        s->jogs = s->jog_waits = false;
        s->limp = 0;
        based_change(&s->based, event->now_us, "the line was lost");
        events_tell(&s->events, "link", "error", NULL, "the line is lost");
        break;
    case GROBO_EVENT_LINK_UP:
        based_change(&s->based, event->now_us, "the line came back");
        events_tell(&s->events, "link", "info", NULL, "the line is up: %s", conn_device(c));
        break;
    case GROBO_EVENT_UNWATCHED:
        events_tell(&s->events, "log", "warning", NULL, "this motion is played unwatched");
        break;
    case GROBO_EVENT_JOINT:
        s->readings++;
        break;
    case GROBO_EVENT_ROUND:
    case GROBO_EVENT_PLAY:
    case GROBO_EVENT_SLOW_CALLBACK:
        break;
    case GROBO_EVENT_HALTED:
        if (event->u.halted.failed) {
            events_tell(&s->events, "stop", "error", NULL,
                        "joints that cannot be read back may still move: %d",
                        grobo_joints_count(event->u.halted.failed));
        }
        break;
    }
}

/* ---- who drives ------------------------------------------------------------------------------ */

/* What was declared when the motion began. */
static void lose_motion(serve *s)
{
    bool plays =
        grobo_robot_is_playing(s->c.robot) || grobo_robot_job(s->c.robot) == GROBO_JOB_PLAY;
    bool finishes = plays && s->player.on_lost == PLAYER_FINISH, endless = player_is_endless(s);
    if (finishes && !endless) {
        events_tell(&s->events, "lease", "warning", NULL,
                    "the page that drives is lost: the motion goes on");
        return;
    }
    bool leaves = plays && s->player.on_lost == PLAYER_EXIT;
    events_tell(&s->events, "lease", "warning", NULL, "the page that drives is lost: %s",
                leaves                ? "the exit policy is carried out"
                : finishes && endless ? "a loop has no end, the motion stops"
                                      : "the motion stops");
    stops_halt(s);
    if (leaves) {
        int job = grobo_robot_exit(s->c.robot, GROBO_EXIT_DEFAULT);
        serve_note_job(s, job, "exit");
    }
}

static void look_after_lease(serve *s)
{
    int64_t now_us = grobo_now_us(), silent_us = lease_silent_us(&s->lease, now_us);
    if (silent_us > SERVE_JOG_LOST_US && s->jogs) {
        events_tell(&s->events, "lease", "warning", NULL,
                    "the page that drives is silent: jogging stops");
        stops_halt(s);
    }
    if (lease_is_held(&s->lease)) {
        s->left_us = 0;
    } else if (s->left_us && now_us - s->left_us > SERVE_PLAY_LOST_US) { /* and nobody came */
        s->left_us = 0;
        if (serve_is_moving(s)) {
            lose_motion(s);
        }
    }
    if (silent_us <= SERVE_PLAY_LOST_US) {
        return;
    }
    if (serve_is_moving(s)) {
        lose_motion(s);
    } else {
        events_tell(&s->events, "lease", "info", NULL, "the page that drove is gone");
    }
    lease_end(&s->lease);
}

/* Jogging is over when its last target is reached. */
static void look_after_jog(serve *s)
{
    verb_jog_on(s);
    if (!serve_is_moving(s) && !s->jog_waits) {
        s->jogs = false;
    }
}

/* ---- the loop -------------------------------------------------------------------------------- */

/* Bytes and readings since a second ago. */
static void measure_load(serve *s, int64_t now_us)
{
    uint64_t tx_bytes, rx_bytes;
    int64_t passed_us = now_us - s->load_us;
    if (passed_us < 1000000) {
        return;
    }
    grobo_session_bytes(s->c.session, &tx_bytes, &rx_bytes);
    double bits = 10.0 * (double)(tx_bytes + rx_bytes - s->load_bytes); /* with start and stop */
    if (s->load_us > 0) {
        s->load_pct = 1e8 * bits / (double)conn_baud(s->a) / (double)passed_us;
        s->load_hz = 1e6 * s->readings / (double)passed_us;
    }
    s->load_us = now_us;
    s->load_bytes = tx_bytes + rx_bytes;
    s->readings = 0;
}

/* Torque is on somewhere, as far as is known: heat and current are watched as in any program. */
static bool has_torque(serve *s)
{
    grobo_joint_info i;
    for (int j = 0; j < s->model->n_joints; j++) {
        if (grobo_robot_joint(s->c.robot, j, &i) < 0 || !i.torque_known ||
            i.state.torque != GROBO_TORQUE_OFF) {
            return true;
        }
    }
    return false;
}

/* As often as somebody is there for it. */
static void set_pace(serve *s, bool idle, bool warm)
{
    const struct timeval period = conn_timeval(idle ? SERVE_IDLE_US : SERVE_STATE_US);
    if (idle == s->idle && warm == s->warm) {
        return;
    }
    s->idle = idle;
    s->warm = warm;
    grobo_robot_config config = serve_config(s);
    (void)grobo_session_configure(s->c.session, &config);
    (void)event_add(s->tick, &period);
}

/* Nobody is connected, nothing is under way: a robot that is left alone costs nothing. */
static void look_after_pace(serve *s, int64_t now_us)
{
    bool left = now_us - s->asked_us > SERVE_LEFT_US && !http_has_clients(s->http);
    bool busy = lease_is_held(&s->lease) || s->left_us || s->jogs || s->jog_waits ||
                serve_is_moving(s) || grobo_robot_job(s->c.robot) != GROBO_JOB_NONE ||
                stops_are_busy(s);
    bool idle = left && !busy;
    set_pace(s, idle, idle && has_torque(s));
}

static void on_tick(evutil_socket_t fd, short what, void *ctx)
{
    serve *s = ctx;
    int64_t now_us = grobo_now_us();
    (void)fd;
    (void)what;
    look_after_pace(s, now_us);
    based_tell(&s->based, now_us);
    measure_load(s, now_us);
    stops_look(s);
    look_after_lease(s);
    look_after_jog(s);
    if (http_streams(s->http) > 0) {
        library_look(s);
        events_send_state(&s->events, serve_state_json(s));
    }
}

/* Before anything else: whoever presses STOP while the robot is being opened is heard. */
static int open_ports(serve *s)
{
    if (conn_link_init(s->a->link) != GROBO_OK) {
        return app_fail_error(s->a, EXIT_ROBOT, GROBO_ERR_NOMEM, "serve");
    }
    http_config config = {.base = s->a->link->base,
                          .rule = serve_rule,
                          .serve = serve_request,
                          .early = serve_early,
                          .ctx = s};
    int status = listener_open(s->a, s->options, &config, &s->events);
    s->http = s->events.to;
    return status;
}

static int start(serve *s)
{
    s->tick = conn_every(s->c.base, SERVE_STATE_US, on_tick, s);
    s->worker = worker_new(s->c.base);
    s->library = library_new(s->a, s->options->folder);
    if (!s->tick || !s->worker || !s->library) {
        return app_fail_error(s->a, EXIT_ROBOT, GROBO_ERR_NOMEM, "serve");
    }
    return EXIT_DONE;
}

static void finish(serve *s)
{
    s->ending = true;
    tilt_close(s);
    worker_free(s->worker);
    library_free(s->library);
    http_free(s->http);
    conn_forget(s->tick);
    s->http = s->events.to = NULL;
    events_free(&s->events);
}

static int run(serve *s)
{
    conn *c = &s->c;
    c->ctx = s;
    c->on_event = on_event;
    s->model = conn_model(c);
    s->load_pct = s->load_hz = NAN;
    grobo_robot_config config = serve_config(s);
    int error = grobo_session_configure(c->session, &config);
    int status = error ? conn_fail(c, error, "serve") : start(s);
    if (status) {
        return status;
    }
    s->ready = true;
    s->asked_us = grobo_now_us(); /* its link is opened by now */
    stops_begin(s);
    status = tilt_open(s);
    if (status) {
        return status;
    }
    on_tick(-1, 0, s); /* there is a state from the first request on */
    listener_announce(s->a, s->http);
    error = conn_wait_until(c, NULL);
    c->moving = c->up && serve_is_moving(s);
    c->on_event = NULL; /* nobody is told any more */
    return error ? conn_fail(c, error, "serve") : EXIT_DONE;
}

static int open_and_run(serve *s)
{
    int status = conn_open(&s->c, s->a);
    if (!status) {
        status = run(s);
    }
    finish(s);
    status = conn_close(&s->c, status);
    player_free(s); /* not before: the motion was played until then */
    return status;
}

int web_run(app *a, const web_options *options)
{
    static serve s;
    if (!os_is_folder(options->folder)) {
        return app_fail(a, EXIT_FILE, "NOENT", "serve: %s: no such folder", options->folder);
    }
    memset(&s, 0, sizeof s);
    s.a = a;
    s.options = options;
    s.began_us = s.events.began_us = grobo_now_us();
    a->moves = a->reconnects = true;
    conn_link *lent = a->link; /* a shell's */
    a->link = lent ? lent : &s.link;
    int status = open_ports(&s);
    if (!status) {
        status = open_and_run(&s);
    } else {
        finish(&s);
        conn_link_deinit(&s.link);
    }
    a->link = lent;
    a->reconnects = false;
    return status;
}
