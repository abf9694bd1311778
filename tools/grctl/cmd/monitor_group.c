/* SPDX-License-Identifier: MIT */
/* The robots of a group, seen together: a line each, again and again. */
#include <math.h>

#include <grobo/core/robot.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/keys.h"
#include "tools/grctl/play/robot_group.h"
#include "tools/grctl/view/render.h"

enum { RETRY_US = 5000000, KEY_ESTOP = 'e', KEY_QUIT = 'q' };

typedef struct view {
    robot_group all;
    keys input;
    bool over, estopped;
    int64_t retry_us;
} view;

/* ---- a robot --------------------------------------------------------------------------------- */

static bool is_there(const seat *s)
{
    return s->is_open && s->c.up && !s->c.link_error;
}

static const char *doing(const seat *s)
{
    return grobo_robot_is_playing(s->c.robot)
               ? grobo_sequencer_state_name(grobo_robot_play_state(s->c.robot))
           : grobo_robot_moving(s->c.robot) ? _("moves")
                                            : _("stands");
}

static const char *stop_of(const view *v, const seat *s)
{
    grobo_trip_info trip;
    grobo_robot_tripped(s->c.robot, &trip);
    return trip.trip == GROBO_TRIP_NONE ? "-"
           : !v->estopped               ? _(grobo_trip_name(trip.trip))
           : !s->c.estop_ended          ? _("requested")
           : s->c.estop_result < 0      ? _("NOT seen to stop: use its switch")
                                        : _("stopped, read back");
}

static void show(const view *v, const seat *s)
{
    if (!is_there(s)) {
        app_print("%-16s  %s\n", s->name, _("not there"));
        return;
    }
    const grobo_model *model = app_model(&s->a);
    seat_worst w = seat_get_worst(s);
    char heat[64] = "-", supply[16] = "-";
    if (w.hottest >= 0) {
        snprintf(heat, sizeof heat, "%s %.0f C", grobo_model_joint(model, w.hottest)->name,
                 w.hottest_c);
    }
    if (!isnan(w.lowest_v)) {
        snprintf(supply, sizeof supply, "%.2f V", w.lowest_v);
    }
    app_print("%-16s  %-10s  %3d/%-3d  %-20s  %-8s  %s\n", s->name, doing(s), w.on, model->n_joints,
              heat, supply, stop_of(v, s));
}

/* As `status` says it, with the name. */
static void show_json(const seat *s)
{
    if (is_there(s)) {
        const grobo_model *model = app_model(&s->a);
        app_print_json(json_pack("{s:s,s:s,s:o,s:o,s:s}", "robot", model->name, "device",
                                 conn_device(&s->c), "joints",
                                 render_joints_json(&s->c, GROBO_JOINTS_ALL(model->n_joints)),
                                 "link", conn_link_json(&s->c), "name", s->name));
    }
}

/* ---- all of them ----------------------------------------------------------------------------- */

static void on_draw(evutil_socket_t fd, short what, void *ctx)
{
    view *v = ctx;
    const app *a = v->all.a;
    (void)fd;
    (void)what;
    if (a->tty_out && output_is_behind(stdout)) {
        return; /* the next table is as good */
    }
    if (!a->json) {
        app_print_home(a);
        app_print("robot             state       torque   hottest               supply    stop\n");
    }
    for (int i = 0; i < v->all.n; i++) {
        if (a->json) {
            show_json(&v->all.seats[i]);
        } else {
            show(v, &v->all.seats[i]);
        }
    }
    v->over = v->over || !output_flush();
}

static void estop(view *v)
{
    v->estopped = true;
    for (int i = 0; i < v->all.n; i++) {
        seat *s = &v->all.seats[i];
        if (s->is_open) {
            s->c.estop_ended = false;
            (void)grobo_robot_estop(s->c.robot);
        }
    }
}

static void on_key(void *ctx, int key)
{
    view *v = ctx;
    if (key == KEY_ESTOP) {
        estop(v);
    }
    v->over = v->over || key == KEY_QUIT;
}

/* One that is not there, or whose line is lost for good, is tried again every 5 s. */
static void open_all(view *v, bool first)
{
    char why[APP_LINE_BYTES];
    for (int i = 0; i < v->all.n; i++) {
        seat *s = &v->all.seats[i];
        if (s->is_open && s->c.link_error) {
            (void)seat_close(s, EXIT_ROBOT);
        }
        if (!s->is_open && seat_try(&v->all, i, why) && first) {
            app_note(v->all.a, "%s; tried again every 5 s", *why ? why : s->name);
        }
    }
    v->retry_us = grobo_now_us() + RETRY_US;
}

static int watch(view *v, int64_t interval_us)
{
    struct event *draw = conn_every(v->all.host.base, interval_us, on_draw, v);
    bool fine = draw != NULL;
    bool hears = fine && keys_start(&v->input, v->all.host.base, true, on_key, v);
    if (hears && v->all.a->tty_err) {
        app_note(v->all.a, "e: EMERGENCY STOP of all   q: quit");
    }
    while (fine && !v->over && !v->all.host.signal) {
        fine = event_base_loop(v->all.host.base, EVLOOP_ONCE) == 0;
        if (grobo_now_us() >= v->retry_us) {
            open_all(v, false);
        }
    }
    if (hears) {
        keys_stop(&v->input);
    }
    conn_forget(draw);
    return fine ? EXIT_DONE : app_fail_error(v->all.a, EXIT_ROBOT, GROBO_ERR_IO, "monitor");
}

/* An emergency stop is not left before it was carried out. */
static int leave(view *v, int status)
{
    for (int i = 0; i < v->all.n; i++) {
        seat *s = &v->all.seats[i];
        if (v->estopped && is_there(s) && conn_end_estop(&s->c) < 0) {
            status = app_fail(&s->a, EXIT_ROBOT, "BUSY", "estop: NOT seen to stop; use its switch");
        }
        int left = seat_close(s, EXIT_DONE);
        status = left > status ? left : status;
    }
    return status;
}

int monitor_group(app *a, int64_t interval_us)
{
    view v = {.over = false};
    config_group group = *a->group;
    int status = robot_group_begin(&v.all, a, group.robot, group.n);
    if (!status) {
        a->reconnects = true;
        open_all(&v, true);
        status = watch(&v, interval_us);
        int signal = v.all.host.signal;
        status = leave(&v, status);
        status = signal && !status ? EXIT_SIGNAL + signal : status;
        a->reconnects = false;
    }
    robot_group_end(&v.all);
    return status;
}
