/* SPDX-License-Identifier: MIT */
/* The robots of a group play a motion in step. */
#include <grobo/core/robot.h>

#include "tools/grctl/os/keys.h"
#include "tools/grctl/play/frames.h"
#include "tools/grctl/play/robot_group.h"

enum { KEY_ESTOP = 'e', KEY_STOP = 's', KEY_PAUSE = ' ' };

typedef struct act {
    robot_group all;
    keys input;
    bool paused, estopped;
} act;

/* ---- while it is played ---------------------------------------------------------------------- */

static void on_team(void *ctx, const grobo_team_event_info *event)
{
    act *c = ctx;
    const app *a = c->all.a;
    switch (event->kind) {
    case GROBO_TEAM_EVENT_START:
        if (a->json) {
            app_print_json(
                json_pack("{s:b,s:I}", "starts", 1, "start_us", (json_int_t)event->at_us));
        }
        app_detail(a, "all are ready; they begin in %lld ms",
                   (long long)((event->at_us - grobo_now_us()) / 1000));
        break;
    case GROBO_TEAM_EVENT_OUT:
        app_note(a, "%s is out: %s", c->all.seats[event->member].name,
                 grobo_error_text(event->result));
        break;
    case GROBO_TEAM_EVENT_PAUSED:
        c->paused = true;
        app_note(a, "the others pause; space continues without it, s stops them");
        break;
    case GROBO_TEAM_EVENT_READY:
    case GROBO_TEAM_EVENT_ENDED:
        break;
    }
}

static void on_key(void *ctx, int key)
{
    act *c = ctx;
    grobo_team *team = c->all.team;
    switch (key) {
    case KEY_ESTOP:
        c->estopped = true;
        (void)grobo_team_estop(team);
        break;
    case KEY_STOP:
        (void)grobo_team_stop(team, false);
        break;
    case KEY_PAUSE:
        c->paused = !c->paused;
        (void)(c->paused ? grobo_team_pause(team) : grobo_team_resume(team));
        break;
    }
    robot_group_look(&c->all);
}

/* Over when the last posture of each has been read back too. */
static bool is_over(const robot_group *t)
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
static int watch(robot_group *t)
{
    while (!is_over(t) && !t->host.signal) {
        if (event_base_loop(t->host.base, EVLOOP_ONCE) != 0) {
            return app_fail_error(t->a, EXIT_ROBOT, GROBO_ERR_IO, "play");
        }
    }
    if (t->host.signal) {
        (void)grobo_team_stop(t->team, false);
    }
    return EXIT_DONE;
}

/* ---- before ---------------------------------------------------------------------------------- */

/* Every file is checked for every robot before the first line is opened. */
static int prepare(robot_group *t)
{
    int status = EXIT_DONE;
    for (int i = 0; i < t->n && !status; i++) {
        seat *s = &t->seats[i];
        status = s->status = seat_open(t, i);
        if (!status) {
            status = s->status = seat_load(s);
        }
    }
    for (int i = 0; i < t->n && !status; i++) {
        t->seats[i].chosen = true;
        status = t->seats[i].status = seat_prepare(&t->seats[i]);
    }
    return status;
}

static int play(act *c)
{
    static const grobo_team_policy policies[] = {GROBO_TEAM_STOP_ALL, GROBO_TEAM_PAUSE_ALL,
                                                 GROBO_TEAM_CONTINUE};
    robot_group *t = &c->all;
    const cli_value *lost = app_option(t->a, PLAY_IF_LOST);
    for (int i = 0; i < t->n; i++) {
        t->seats[i].c.moving = true;
    }
    (void)robot_group_play(t, policies[lost->given ? lost->choice : 0],
                           &t->seats[0].list.options[0]);
    if (keys_start(&c->input, t->host.base, false, on_key, c) && t->a->tty_err) {
        app_note(t->a, "space: pause   s: stop   e: EMERGENCY STOP");
    }
    int status = watch(t);
    keys_stop(&c->input);
    return status;
}

/* ---- after ----------------------------------------------------------------------------------- */

static void report(const seat *s)
{
    if (s->a.json) {
        json_t *summary = frames_json(&s->c), *named = json_pack("{s:s}", "name", s->name);
        json_object_update(named, summary);
        json_decref(summary);
        app_print_json(named);
    } else {
        frames_print(&s->c, s->a.place);
    }
}

/* How it went for one; said only of who ended by itself. */
static int seat_result(const act *c, seat *s)
{
    grobo_team_member how;
    if (!c->all.team || grobo_team_get(c->all.team, s->member, &how) < 0) {
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
    if (c->estopped) {
        int error = conn_end_estop(&s->c);
        return error ? conn_fail(&s->c, error, "estop")
                     : app_fail_trip(&s->a, GROBO_TRIP_ESTOP,
                                     "play: emergency stop; 'grctl estop --reset' releases it");
    }
    if (how.result == GROBO_ERR_CANCELED) {
        return app_fail(&s->a, EXIT_ROBOT, grobo_error_name(how.result),
                        "play: stopped with the others");
    }
    return conn_fail(&s->c, how.result, "play");
}

static int finish(act *c, int status, bool played)
{
    robot_group *t = &c->all;
    for (int i = 0; played && i < t->n; i++) {
        t->seats[i].status = seat_result(c, &t->seats[i]);
    }
    for (int i = 0; i < t->n; i++) {
        seat *s = &t->seats[i];
        int left = seat_close(s, s->status ? s->status : status);
        status = left > status ? left : status;
    }
    robot_group_end(t);
    return status;
}

int play_together(app *a)
{
    act c = {.paused = false};
    config_group group = *a->group;
    if (a->line.n_arguments > 1) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED", "play: a group plays one file at a time");
    }
    if (app_option(a, PLAY_DRY_RUN)->given) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "--dry-run: %s is a group of robots; try one of them, such as -d %s",
                        group.name, group.robot[0]);
    }
    int status = robot_group_begin(&c.all, a, group.robot, group.n);
    bool plays = false;
    c.all.on_team = on_team;
    c.all.ctx = &c;
    if (!status) {
        status = prepare(&c.all);
        plays = !status;
    }
    if (plays) {
        status = play(&c);
    }
    return finish(&c, status, plays);
}
