/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/robot.h"
#include "tools/grctl/os/alarm.h"
#include "tools/grctl/play/robot_group.h"

/* A team is looked at at least so often while it plays. */
#define LOOK_MAX_US INT64_C(3600000000)

void robot_group_look(robot_group *t)
{
    int64_t now_us = grobo_now_us();
    int64_t at_us = t->team ? grobo_team_step(t->team, now_us) : GROBO_NEVER_US;
    if (at_us != GROBO_NEVER_US) {
        int64_t rest_us = at_us > now_us ? at_us - now_us : 0;
        alarm_set(t->timer, rest_us < LOOK_MAX_US ? rest_us : LOOK_MAX_US);
    }
}

static void on_timer(evutil_socket_t fd, short what, void *ctx)
{
    robot_group *t = ctx;
    (void)fd;
    (void)what;
    alarm_clear(t->timer);
    robot_group_look(t);
}

static void on_robot(conn *c, const grobo_event *event)
{
    seat *s = c->ctx;
    robot_group *t = s->all;
    bool begins = event->kind == GROBO_EVENT_PLAY && event->u.play.to == GROBO_SEQUENCER_PLAYING;
    if (begins && s->began_us == 0) {
        s->began_us = grobo_now_us();
    }
    if (t->team && s->member >= 0) {
        grobo_team_event(t->team, s->member, event);
    }
    if (t->on_robot) {
        t->on_robot(s, event);
    }
    if (event->kind != GROBO_EVENT_JOINT) {
        robot_group_look(t);
    }
}

int robot_group_begin(robot_group *t, app *a, char (*names)[CONFIG_NAME_BYTES], int n)
{
    memset(t, 0, sizeof *t);
    t->a = a;
    t->seats = calloc((size_t)n, sizeof *t->seats);
    int error = t->seats ? conn_link_init(&t->host) : GROBO_ERR_NOMEM;
    if (!error) {
        t->n = n;
        t->timer = alarm_new(t->host.base, on_timer, t);
        error = t->timer ? GROBO_OK : GROBO_ERR_NOMEM;
    }
    if (error) {
        return app_fail_error(a, EXIT_ROBOT, error, "%s", a->line.command->name);
    }
    conn_link_watch(&t->host);
    if (t->host.link_error) {
        return app_fail_error(a, EXIT_ROBOT, t->host.link_error, "%s", a->line.command->name);
    }
    for (int i = 0; i < n; i++) {
        t->seats[i].all = t;
        t->seats[i].name = names[i];
        t->seats[i].member = -1;
    }
    return EXIT_DONE;
}

int seat_open(robot_group *t, int i)
{
    seat *s = &t->seats[i];
    s->a = *t->a;
    snprintf(s->a.place, sizeof s->a.place, "%s: ", s->name);
    int status = config_apply_member(&s->a, s->name, &s->robot);
    if (!status) {
        status = robot_choose(&s->a);
    }
    if (status) {
        return status;
    }
    s->is_open = true;
    status = conn_open_to_move_beside(&s->c, &s->a, &t->host);
    s->c.ctx = s;
    s->c.on_event = on_robot;
    return status;
}

int seat_try(robot_group *t, int i, char why[APP_LINE_BYTES])
{
    seat *s = &t->seats[i];
    *why = '\0';
    t->a->hushed = why;
    int status = seat_open(t, i);
    if (status) {
        (void)seat_close(s, status);
    }
    t->a->hushed = s->a.hushed = NULL;
    return status;
}

int seat_load(seat *s)
{
    playlist_free(&s->list);
    s->a.clamps = app_option(&s->a, PLAY_CLAMP)->given > 0;
    return playlist_load(&s->list, &s->a);
}

int seat_prepare(seat *s)
{
    return playlist_prepare_sensed(&s->list, &s->c);
}

seat_worst seat_get_worst(const seat *s)
{
    seat_worst w = {.hottest = -1, .hottest_c = NAN, .lowest_v = NAN};
    grobo_joint_info info;
    for (int j = 0; j < app_model(&s->a)->n_joints; j++) {
        if (grobo_robot_joint(s->c.robot, j, &info) != 0) {
            continue;
        }
        w.on += info.torque_known && info.state.torque == GROBO_TORQUE_ON;
        if ((info.state.valid & GROBO_FIELD_TEMPERATURE) &&
            !(info.state.temperature_c <= w.hottest_c)) {
            w.hottest = j;
            w.hottest_c = info.state.temperature_c;
        }
        if (info.state.valid & GROBO_FIELD_VOLTAGE) {
            w.lowest_v = fmin(w.lowest_v, info.state.voltage_mv / 1000.0);
        }
    }
    return w;
}

static int make_team(robot_group *t, grobo_team_policy policy, const grobo_clip **clips)
{
    const grobo_team_config config = {GROBO_TEAM_CONFIG_INIT, .policy = policy,
                                      .on_event = t->on_team, .ctx = t->ctx};
    int error = grobo_team_new(&config, &t->team);
    int n = 0;
    for (int i = 0; !error && i < t->n; i++) {
        seat *s = &t->seats[i];
        if (s->chosen) {
            clips[n++] = &s->list.clip[0];
            s->began_us = 0;
            s->member = grobo_team_add(t->team, s->c.robot);
            error = s->member < 0 ? s->member : GROBO_OK;
        }
    }
    return error;
}

int robot_group_play(robot_group *t, grobo_team_policy policy, const grobo_play_options *options)
{
    const grobo_clip *clips[CONFIG_GROUP_MAX];
    int error = make_team(t, policy, clips);
    if (!error) {
        error = grobo_team_play(t->team, clips, false, options, grobo_now_us());
    }
    robot_group_look(t);
    return error;
}

void robot_group_disband(robot_group *t)
{
    grobo_team_free(t->team);
    t->team = NULL;
    for (int i = 0; i < t->n; i++) {
        t->seats[i].member = -1;
        t->seats[i].chosen = false;
    }
}

int seat_close(seat *s, int status)
{
    if (s->is_open) {
        s->c.on_event = NULL;
        status = conn_close(&s->c, status);
        s->is_open = false;
    }
    playlist_free(&s->list);
    return status;
}

void robot_group_end(robot_group *t)
{
    robot_group_disband(t);
    conn_forget(t->timer);
    conn_link_deinit(&t->host);
    free(t->seats);
    t->seats = NULL;
}
