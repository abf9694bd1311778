/* SPDX-License-Identifier: MIT */
/* The robots of a group play a motion in step, on one loop. */
#include <stdlib.h>
#include <string.h>

#include <grobo/team.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/os/keys.h"
#include "tools/grctl/play/play.h"

enum { KEY_ESTOP = 'e', KEY_STOP = 's', KEY_PAUSE = ' ' };

typedef struct troupe troupe;

/* One robot. */
typedef struct seat {
    troupe *all;
    app a;
    config_robot robot;
    conn c;
    playlist list;
    bool is_open;
    int member, status;
} seat;

struct troupe {
    app *a;
    seat *seats;
    int n;
    grobo_team *team;
    struct event *timer;
    keys input;
    bool paused, estopped;
};

static const char *name_of(const troupe *t, int member)
{
    return t->a->group->robot[member];
}

/* ---- while it is played ---------------------------------------------------------------------- */

/* Lets the team look at the time, now and when it wants to. */
static void look(troupe *t)
{
    int64_t now_us = grobo_now_us();
    int64_t at_us = grobo_team_step(t->team, now_us);
    if (at_us != GROBO_NEVER_US) {
        int64_t rest_us = at_us > now_us ? at_us - now_us : 0;
        const struct timeval rest = {.tv_sec = (int)(rest_us / 1000000),
                                     .tv_usec = (int)(rest_us % 1000000)};
        (void)evtimer_add(t->timer, &rest);
    }
}

static void on_timer(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    look(ctx);
}

static void on_robot(conn *c, const grobo_event *event)
{
    seat *s = c->ctx;
    grobo_team_event(s->all->team, s->member, event);
    if (event->kind != GROBO_EVENT_JOINT) {
        look(s->all);
    }
}

static void on_team(void *ctx, const grobo_team_event_info *event)
{
    troupe *t = ctx;
    int64_t soon_us = event->at_us - grobo_now_us();
    switch (event->kind) {
    case GROBO_TEAM_EVENT_START:
        if (t->a->json) {
            app_print_json(
                json_pack("{s:b,s:I}", "starts", 1, "start_us", (json_int_t)event->at_us));
        }
        app_detail(t->a, "all are ready; they begin in %lld ms", (long long)(soon_us / 1000));
        break;
    case GROBO_TEAM_EVENT_OUT:
        app_note(t->a, "%s is out: %s", name_of(t, event->member), grobo_error_text(event->result));
        break;
    case GROBO_TEAM_EVENT_PAUSED:
        t->paused = true;
        app_note(t->a, "the others pause; space goes on without it, s stops them");
        break;
    case GROBO_TEAM_EVENT_ENDED:
        break;
    }
}

static void on_key(void *ctx, int key)
{
    troupe *t = ctx;
    switch (key) {
    case KEY_ESTOP:
        t->estopped = true;
        (void)grobo_team_estop(t->team);
        break;
    case KEY_STOP:
        (void)grobo_team_stop(t->team, false);
        break;
    case KEY_PAUSE:
        t->paused = !t->paused;
        (void)(t->paused ? grobo_team_pause(t->team) : grobo_team_resume(t->team));
        break;
    }
    look(t);
}

static bool is_over(const troupe *t)
{
    for (int i = 0; i < t->n; i++) {
        const conn *c = &t->seats[i].c;
        if (c->up && !c->link_error && grobo_robot_settling(c->robot)) {
            return false;
        }
    }
    return grobo_team_get_state(t->team) == GROBO_TEAM_ENDED;
}

/* A signal is told to all: it ends the motion smoothly, and conn_close() leaves each robot. */
static int watch(troupe *t)
{
    conn *first = &t->seats[0].c;
    while (!is_over(t) && !first->signal) {
        if (event_base_loop(first->base, EVLOOP_ONCE) != 0) {
            return GROBO_ERR_IO;
        }
    }
    if (first->signal) {
        (void)grobo_team_stop(t->team, false);
    }
    return GROBO_OK;
}

/* ---- before ---------------------------------------------------------------------------------- */

static int seat_open(troupe *t, int i)
{
    seat *s = &t->seats[i];
    s->all = t;
    s->a = *t->a;
    s->a.clamps = app_option(t->a, PLAY_CLAMP)->given > 0;
    snprintf(s->a.place, sizeof s->a.place, "%s: ", name_of(t, i));
    int status = config_apply_member(&s->a, name_of(t, i), &s->robot);
    if (!status) {
        status = robot_choose(&s->a);
    }
    if (!status) {
        status = playlist_load(&s->list, &s->a);
    }
    if (status) {
        return status;
    }
    s->is_open = true;
    status = i == 0 ? conn_open_to_move(&s->c, &s->a)
                    : conn_open_to_move_beside(&s->c, &s->a, &t->seats[0].c);
    s->c.ctx = s;
    return status;
}

/* Increments count from where each robot is. */
static int seat_prepare(seat *s)
{
    conn *c = &s->c;
    grobo_joint_mask all = GROBO_JOINTS_ALL(app_model(&s->a)->n_joints);
    grobo_posture sensed;
    int error =
        conn_wait(c, grobo_robot_sense(grobo_session_robot(c->session), all, GROBO_SENSE_FULL));
    if (error) {
        return conn_fail(c, error, "play");
    }
    grobo_robot_posture(c->robot, GROBO_NEVER_US, &sensed);
    return playlist_prepare(&s->list, &s->a, &sensed);
}

static int make_team(troupe *t)
{
    static const grobo_team_policy policies[] = {GROBO_TEAM_STOP_ALL, GROBO_TEAM_PAUSE_ALL,
                                                 GROBO_TEAM_CONTINUE};
    const cli_value *lost = app_option(t->a, PLAY_IF_LOST);
    const grobo_team_config config = {GROBO_TEAM_CONFIG_INIT,
                                      .policy = policies[lost->given ? lost->choice : 0],
                                      .on_event = on_team, .ctx = t};
    int error = grobo_team_new(&config, &t->team);
    for (int i = 0; !error && i < t->n; i++) {
        seat *s = &t->seats[i];
        s->member = grobo_team_add(t->team, s->c.robot);
        error = s->member < 0 ? s->member : GROBO_OK;
        s->c.on_event = on_robot;
    }
    t->timer = evtimer_new(t->seats[0].c.base, on_timer, t);
    return error || t->timer ? error : GROBO_ERR_NOMEM;
}

static int prepare(troupe *t)
{
    int status = EXIT_DONE;
    for (int i = 0; i < t->n && !status; i++) {
        status = t->seats[i].status = seat_open(t, i);
    }
    for (int i = 0; i < t->n && !status; i++) {
        status = t->seats[i].status = seat_prepare(&t->seats[i]);
    }
    int error = status ? GROBO_OK : make_team(t);
    return error ? app_fail_error(t->a, EXIT_ROBOT, error, "play") : status;
}

static int play(troupe *t)
{
    const grobo_clip *clips[CONFIG_GROUP_MAX];
    for (int i = 0; i < t->n; i++) {
        clips[i] = &t->seats[i].list.clip[0];
        t->seats[i].c.moving = true;
    }
    (void)grobo_team_play(t->team, clips, false, &t->seats[0].list.options[0], grobo_now_us());
    look(t);
    if (keys_start(&t->input, t->seats[0].c.base, false, on_key, t) && t->a->tty_err) {
        app_note(t->a, "space: pause   s: stop   e: EMERGENCY STOP");
    }
    int error = watch(t);
    keys_stop(&t->input);
    return error;
}

/* ---- after ----------------------------------------------------------------------------------- */

static void report(const seat *s)
{
    grobo_robot_counters n;
    grobo_jitter jitter;
    conn_counters(&s->c, &n);
    grobo_robot_jitter(s->c.robot, &jitter);
    if (s->a.json) {
        app_print_json(json_pack("{s:s,s:b,s:I,s:I,s:{s:I,s:I,s:I}}", "name", s->robot.name, "done",
                                 1, "frames", (json_int_t)n.motion_frames, "late_frames",
                                 (json_int_t)n.late_frames, "jitter_us", "p50",
                                 (json_int_t)jitter.p50_us, "p99", (json_int_t)jitter.p99_us, "max",
                                 (json_int_t)jitter.max_us));
        return;
    }
    app_print("%s: %llu frame%s, %llu late; jitter p50 %lld us, p99 %lld us, largest %lld us\n",
              s->robot.name, (unsigned long long)n.motion_frames, n.motion_frames == 1 ? "" : "s",
              (unsigned long long)n.late_frames, (long long)jitter.p50_us, (long long)jitter.p99_us,
              (long long)jitter.max_us);
}

/* How it went for one; said only of who ended by itself. */
static int seat_end(troupe *t, seat *s)
{
    grobo_team_member how;
    if (grobo_team_get(t->team, s->member, &how) < 0) {
        return EXIT_ROBOT;
    }
    if (how.result == GROBO_OK && how.state == GROBO_TEAM_ENDED) {
        s->c.moving = false;
        report(s);
        return EXIT_DONE;
    }
    if (s->c.signal) {
        return EXIT_SIGNAL;
    }
    if (t->estopped) {
        int error = conn_end_estop(&s->c);
        return error ? conn_fail(&s->c, error, "estop")
                     : app_fail_trip(&s->a, GROBO_TRIP_ESTOP,
                                     "play: emergency stop; 'grctl estop --reset' takes it back");
    }
    if (how.result == GROBO_ERR_CANCELED) {
        return app_fail(&s->a, EXIT_ROBOT, grobo_error_name(how.result),
                        "play: stopped with the others");
    }
    return conn_fail(&s->c, how.result, "play");
}

static int finish(troupe *t, int status, bool played)
{
    for (int i = 0; i < t->n; i++) { /* it is over, whatever they tell now */
        t->seats[i].c.on_event = NULL;
    }
    conn_forget(t->timer);
    for (int i = 0; played && i < t->n; i++) {
        t->seats[i].status = seat_end(t, &t->seats[i]);
    }
    for (int i = t->n; i-- > 0;) { /* the first has the loop and the signals */
        seat *s = &t->seats[i];
        if (s->is_open) {
            s->status = conn_close(&s->c, s->status ? s->status : status);
        }
        status = s->status > status ? s->status : status;
        playlist_free(&s->list);
    }
    return status;
}

int play_together(app *a)
{
    troupe t = {.a = a, .n = a->group->n};
    if (a->line.n_arguments > 1) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED", "play: a group plays one file at a time");
    }
    if (app_option(a, PLAY_DRY_RUN)->given) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "--dry-run: %s is a group of robots; try one of them, such as -d %s",
                        a->group->name, a->group->robot[0]);
    }
    t.seats = calloc((size_t)t.n, sizeof *t.seats);
    if (!t.seats) {
        return app_fail_error(a, EXIT_ROBOT, GROBO_ERR_NOMEM, "play");
    }
    int status = prepare(&t);
    bool plays = !status;
    if (plays && play(&t) < 0) {
        status = app_fail_error(a, EXIT_ROBOT, GROBO_ERR_IO, "play");
    }
    status = finish(&t, status, plays);
    grobo_team_free(t.team);
    free(t.seats);
    return status;
}
