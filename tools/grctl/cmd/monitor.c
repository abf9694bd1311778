/* SPDX-License-Identifier: MIT */
/* monitor: everything at a glance, and the keys to act on it. */
#include <math.h>
#include <string.h>
#include <unistd.h>

#include <grobo/core/wheel.h>
#include <grobo/estop.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/term/screen.h"
#include "tools/grctl/view/monitor.h"

enum {
    DRAW_US = 50000,
    SENSE_US = 300000,
    NUDGE_MS = 300,
    INIT_MS = 3000,
    GROUP_KEYS = MONITOR_GROUP_KEYS,
    FIRST_ROWS = 12,
    GROUP_US = 500000
};

__attribute__((format(printf, 3, 4))) static void say(monitor *m, bool bad, const char *format, ...)
{
    va_list list;
    if (*m->said) {
        snprintf(m->log[m->n_log++ % MONITOR_LOG], MONITOR_TEXT_BYTES, "%.*s",
                 MONITOR_TEXT_BYTES - 1, m->said);
    }
    va_start(list, format);
    vsnprintf(m->said, sizeof m->said, lang_text(format), list);
    va_end(list);
    m->bad = bad;
}

/* What a request came to: a number > 0 is that of a job, whose end is told by on_event(). */
static void say_request(monitor *m, int result, const char *doing)
{
    const char *busy = monitor_busy(m);
    doing = lang_text(doing);
    if (result == GROBO_ERR_STATE) {
        say(m, true, "%s: not now, the robot is busy: %s", doing, busy ? busy : _("moving"));
    } else if (result < 0) {
        say(m, true, "%s: %s", doing, app_error_text(result));
    } else {
        say(m, false, "%s", doing);
    }
    if (result > 0) {
        m->job = result;
        m->doing = doing;
    }
}

/* An emergency stop of another command stands here too. */
static bool may_move(monitor *m)
{
    if (!grobo_estop_stands(conn_device(&m->c))) {
        return true;
    }
    say(m, true, "an emergency stop stands: R releases it");
    return false;
}

/* ---- what keys do ---------------------------------------------------------------------------- */

static void choose_joint(monitor *m, int joint)
{
    m->cursor = joint;
    m->chosen = GROBO_JOINT_BIT(joint);
}

static void choose_group(monitor *m, int group)
{
    if (group >= m->model->n_groups) {
        return;
    }
    m->chosen = m->model->groups[group].joints;
    say(m, false, "%s", m->model->groups[group].name);
}

static bool torque_is_on(const monitor *m, int joint)
{
    grobo_joint_info i;
    return grobo_robot_joint(m->c.robot, joint, &i) == 0 && i.torque_known &&
           i.state.torque == GROBO_TORQUE_ON;
}

static int first_chosen(const monitor *m)
{
    int joint = 0;
    while (!(m->chosen & GROBO_JOINT_BIT(joint))) {
        joint++;
    }
    return joint;
}

/* Less torque does not wait for a move to end: it ends the move. */
static void switch_torque(monitor *m, grobo_torque mode, const char *doing)
{
    if (mode == GROBO_TORQUE_ON && !may_move(m)) {
        return;
    }
    int result = grobo_robot_torque(m->c.robot, m->chosen, mode);
    if (result == GROBO_ERR_STATE && mode != GROBO_TORQUE_ON &&
        grobo_robot_cancel(m->c.robot) == GROBO_OK) {
        result = grobo_robot_torque(m->c.robot, m->chosen, mode);
    }
    say_request(m, result, doing);
}

static void toggle_torque(monitor *m)
{
    if (torque_is_on(m, first_chosen(m))) {
        switch_torque(m, GROBO_TORQUE_OFF, "torque off");
    } else {
        switch_torque(m, GROBO_TORQUE_ON, "torque on");
    }
}

/* Would the way lead out of the limits, from where the joint already stands? */
static bool is_at_limit(const grobo_joint *j, double from_rad, double by_rad)
{
    double near_rad = grobo_rad_from_deg(0.05);
    return by_rad > 0 ? from_rad > j->max_rad - near_rad : from_rad < j->min_rad + near_rad;
}

/* Of wheels' most, by one key and by the other. */
static const double gentle_part = 0.2, brisk_part = 0.5;

/* A wheel turns for as long as a speed holds; a key that is held repeats. */
static void nudge_wheels(monitor *m, grobo_joint_mask wheels, double by)
{
    double rad_s[GROBO_JOINTS_MAX] = {0};
    for (int j = 0; j < m->model->n_joints; j++) {
        double most_rad_s = grobo_model_joint(m->model, j)->max_speed_rad_s;
        rad_s[j] = copysign((fabs(by) > 1 ? brisk_part : gentle_part) * most_rad_s, by);
    }
    int result = grobo_robot_drive(m->c.robot, wheels, rad_s);
    if (result == GROBO_ERR_STATE) {
        say(m, true, "no torque there: t switches it on");
    } else {
        say_request(m, result, "drive");
    }
}

/* Only what holds is nudged: a limp joint may stand where its weight took it. By so many degrees,
 * or what else the joint is given in. */
static void nudge(monitor *m, double by)
{
    grobo_posture target;
    int at_limit = -1;
    double limit_rad = 0;
    if (!may_move(m)) {
        return;
    }
    grobo_joint_mask wheels = m->chosen & grobo_model_wheels(m->model);
    if (wheels) {
        nudge_wheels(m, wheels, by);
    }
    if (m->chosen && !(m->chosen & ~wheels)) {
        return;
    }
    grobo_posture_init(&target, m->model->n_joints);
    for (int j = 0; j < m->model->n_joints; j++) {
        grobo_joint_info i;
        if (!(m->chosen & ~wheels & GROBO_JOINT_BIT(j)) || !torque_is_on(m, j) ||
            grobo_robot_joint(m->c.robot, j, &i) < 0) {
            continue;
        }
        double from_rad = i.has_target ? i.target_rad : i.state.angle_rad;
        const grobo_joint *joint = grobo_model_joint(m->model, j);
        double by_rad = grobo_model_angle(m->model, j, by) - grobo_model_angle(m->model, j, 0);
        if (is_at_limit(joint, from_rad, by_rad)) {
            at_limit = j;
            limit_rad = by_rad > 0 ? joint->max_rad : joint->min_rad;
            continue;
        }
        grobo_posture_set_rad(&target, j, from_rad + by_rad);
    }
    if (!target.set && at_limit >= 0) {
        char text[JOINTS_TEXT_BYTES];
        say(m, true, "%s is at its limit: %s", grobo_model_joint(m->model, at_limit)->name,
            joints_text(m->model, at_limit, limit_rad, 0, text));
        return;
    }
    if (!target.set) {
        say(m, true, "no torque there: t switches it on");
        return;
    }
    grobo_posture_clamp(&target, m->model);
    grobo_posture_set_time_ms(&target, NUDGE_MS);
    say_request(m, grobo_robot_move(m->c.robot, &target), "nudge");
}

static void go_init(monitor *m)
{
    grobo_posture target;
    if (!may_move(m)) {
        return;
    }
    grobo_posture_init_pose(&target, m->model);
    grobo_posture_set_time_ms(&target, INIT_MS);
    say_request(m, grobo_robot_move(m->c.robot, &target), "move to the initial posture");
}

static void start_play(monitor *m)
{
    grobo_posture sensed;
    int job;
    if (!m->list.n) {
        say(m, true, "nothing to play: grctl monitor FILE...");
        return;
    }
    if (!may_move(m)) {
        return;
    }
    grobo_robot_posture(m->c.robot, GROBO_NEVER_US, &sensed);
    if (!m->prepared && playlist_prepare(&m->list, m->c.a, &sensed) != EXIT_DONE) {
        return; /* it has said why */
    }
    m->prepared = true;
    job = grobo_robot_play(m->c.robot, &m->list.clip[0], &m->list.options[0]);
    if (job > 0) {
        m->keys.speed_pct = 100;
    }
    say_request(m, job, "play");
}

static void reset(monitor *m)
{
    int error = grobo_robot_reset(m->c.robot);
    say_request(m, error, "stop released; nothing moves by itself");
    m->c.trip = (grobo_trip_info){0};
}

static bool take_choice(monitor *m, int key)
{
    if (key >= '0' && key < '0' + GROUP_KEYS) {
        choose_group(m, key - '0');
    } else if (key == SCREEN_KEY_UP || key == SCREEN_KEY_DOWN) {
        choose_joint(m, monitor_below(&m->layout, m->cursor, key == SCREEN_KEY_DOWN ? 1 : -1));
    } else if (key == SCREEN_KEY_LEFT || key == SCREEN_KEY_RIGHT) {
        choose_joint(m, monitor_beside(&m->layout, m->cursor, key == SCREEN_KEY_RIGHT ? 1 : -1));
    } else {
        return false;
    }
    return true;
}

static bool take_nudge(monitor *m, int key)
{
    static const char nudges[] = "[]{}";
    static const double by[] = {-1, 1, -5, 5};
    const char *found = key > 0 && key < 128 ? strchr(nudges, key) : NULL;
    if (found) {
        nudge(m, by[found - nudges]);
    }
    return found != NULL;
}

/* Of a motion; s ends any other move too. */
static void take_play_key(monitor *m, int key)
{
    const char *busy = monitor_busy(m);
    if (grobo_robot_is_playing(m->c.robot) || (key == 's' && busy)) {
        play_keys_take(&m->keys, key);
    } else if (key > 0 && key < 128 && strchr(" +=-s", key)) {
        say(m, true, "nothing is playing%s%s", busy ? _("; the robot is busy: ") : "",
            busy ? busy : "");
    }
}

static void take_key(monitor *m, int key)
{
    if (key == 'q') {
        m->over = true;
        return;
    }
    if (key == 'e') {
        play_keys_estop(&m->keys);
        say(m, true, "emergency stop");
        return;
    }
    if (take_choice(m, key)) {
        return;
    }
    if (!m->c.up) {
        say(m, true, "the line is lost");
        return;
    }
    if (take_nudge(m, key)) {
        return;
    }
    if (key == 't') {
        toggle_torque(m);
    } else if (key == 'b') {
        switch_torque(m, GROBO_TORQUE_BRAKE, "brake");
    } else if (key == 'i') {
        go_init(m);
    } else if (key == 'p') {
        start_play(m);
    } else if (key == 'R') {
        reset(m);
    } else {
        take_play_key(m, key);
    }
}

/* ---- what comes from the loop ---------------------------------------------------------------- */

static void on_input(evutil_socket_t fd, short what, void *ctx)
{
    monitor *m = ctx;
    int key;
    (void)fd;
    (void)what;
    while ((key = screen_key()) != SCREEN_KEY_NONE) {
        take_key(m, key);
    }
    monitor_draw(m);
}

static void on_draw(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    monitor_draw(ctx);
}

/* The files behind the first, once that is on its way. */
static void queue_others(monitor *m)
{
    int error = GROBO_OK;
    for (int i = 1; i < m->list.n && error >= 0; i++) {
        error = grobo_robot_enqueue(m->c.robot, &m->list.clip[i], &m->list.options[i]);
        if (error < 0) {
            say(m, true, "%s: %s", m->list.path[i], app_error_text(error));
        }
    }
}

/* How the job ended that was asked for last; an end by our own hand is no complaint. */
static void say_end(monitor *m, const grobo_event_job *job)
{
    const char *joint = job->joint >= 0 ? grobo_model_joint(m->model, job->joint)->name : "";
    if (job->number != m->job) {
        return;
    }
    m->job = 0;
    if (job->result == GROBO_ERR_CANCELED) {
        say(m, false, "%s: stopped", m->doing);
    } else if (job->result < 0) {
        say(m, true, "%s: %s%s%s", m->doing, joint, *joint ? ": " : "",
            app_error_text(job->result));
    } else if (job->kind == GROBO_JOB_PLAY) {
        queue_others(m);
    } else {
        say(m, false, "%s: done", m->doing);
    }
}

static void say_play(monitor *m, grobo_sequencer_state to)
{
    if (to == GROBO_SEQUENCER_FINISHED) {
        say(m, false, "played");
    } else if (to == GROBO_SEQUENCER_IDLE) {
        say(m, false, "play: stopped");
    }
}

static void on_event(conn *c, const grobo_event *event)
{
    monitor *m = c->ctx;
    if (event->kind == GROBO_EVENT_LINK_DOWN) {
        m->up_us = event->now_us;
        m->drops++;
    } else if (event->kind == GROBO_EVENT_TRIP) {
        say(m, true, "stopped for safety: %s", _(grobo_trip_name(event->u.trip.trip)));
    } else if (event->kind == GROBO_EVENT_PLAY) {
        say_play(m, event->u.play.to);
    } else if (event->kind == GROBO_EVENT_JOB) {
        say_end(m, &event->u.job);
    }
}

static bool is_over(conn *c)
{
    const monitor *m = c->ctx;
    return m->over;
}

/* ---- the whole of it ------------------------------------------------------------------------- */

/* Until somebody quits. Returns why it ended otherwise, or 0. */
static int watch(monitor *m)
{
    struct event *tick = conn_every(m->c.base, DRAW_US, on_draw, m);
    struct event *input = event_new(m->c.base, STDIN_FILENO, EV_READ | EV_PERSIST, on_input, m);
    int error = tick && input && event_add(input, NULL) == 0 ? GROBO_OK : GROBO_ERR_NOMEM;
    if (!error) {
        monitor_draw(m);
        error = conn_wait_until(&m->c, is_over);
    }
    conn_forget(tick);
    conn_forget(input);
    return error;
}

/*
 * Each joint three times a second, in the background of whatever else goes on: the wire would carry
 * twice as much, but asking costs more of the processor than drawing.
 */
static int sense_often(conn *c)
{
    grobo_robot_config config = conn_robot_config(c->a);
    config.sense_interval_us = SENSE_US;
    return grobo_session_configure(c->session, &config);
}

/* Who leaves while something moves leaves it standing. */
static int leave(monitor *m, int error)
{
    conn *c = &m->c;
    c->moving = c->up && grobo_robot_moving(c->robot);
    if (!error && c->moving) {
        error = conn_wait(c, grobo_robot_exit(c->robot, GROBO_EXIT_HOLD));
    }
    return error ? conn_fail(c, error, "monitor") : EXIT_DONE;
}

static int run_screen(monitor *m)
{
    conn *c = &m->c;
    app *a = c->a;
    c->ctx = m;
    c->on_event = on_event;
    m->model = conn_model(c);
    m->keys = (play_keys){.c = c, .speed_pct = 100};
    m->blocks = os_shows_utf8();
    monitor_lay_out(&m->layout, m->model, FIRST_ROWS, 1);
    choose_joint(m, m->layout.cell[0].joint);
    int error = sense_often(c);
    if (error) {
        return conn_fail(c, error, "monitor");
    }
    output_flush(); /* what was printed stands before the screen */
    if (!screen_open(a->color_out)) {
        return app_fail(a, EXIT_ROBOT, "UNSUPPORTED", "monitor: cannot use this terminal");
    }
    a->hushed = m->said;
    error = watch(m);
    a->hushed = NULL;
    screen_close();
    return leave(m, error);
}

/* Where no full screen can be: the table again and again, which any terminal and pipe takes. */
static int run_plain(app *a)
{
    static const char *const words[] = {"grctl", "status", "--watch"};
    cli_line line = a->line;
    char complaint[1];
    app_note(a, "monitor: no full screen here; this is 'grctl status --watch'");
    if (!cli_parse(&a->line, 3, (char *const *)words, complaint, sizeof complaint)) {
        return EXIT_USAGE;
    }
    memcpy(a->line.global, line.global, sizeof line.global);
    return a->line.command->run(a);
}

static int run(app *a)
{
    static monitor m;
    if (a->group && a->line.n_arguments) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "monitor: a group is watched; to play, grctl -d %s play", a->group->name);
    }
    if (a->group) {
        return monitor_group(a, GROUP_US);
    }
    memset(&m, 0, sizeof m);
    int status = a->line.n_arguments ? playlist_load(&m.list, a) : EXIT_DONE;
    if (!status && (a->json || !screen_possible())) {
        status = run_plain(a);
    } else if (!status) {
        a->reconnects = a->moves = true;
        status = conn_open(&m.c, a);
        if (!status) {
            status = run_screen(&m);
        }
        status = conn_close(&m.c, status);
        a->reconnects = false;
    }
    playlist_free(&m.list);
    return status;
}

const cli_command cmd_monitor = {
    .name = "monitor",
    COMMAND_ARGUMENTS("[FILE]...", 0, -1, CLI_ARG_FILE),
    .summary = "show all joints live on the full screen, with keys",
    .details =
        "Shows all joints between their limits, their torque, temperature and current, the\n"
        "battery and the line, 20 times a second. Nothing moves until a key says so. A line that\n"
        "is lost is shown, and opened again when it is back. FILEs are what p plays.\n"
        "\n"
        "  arrows   choose a joint; 0 to 7: a group (all, body, right_arm, ...)\n"
        "  t, b     torque on or off; brake\n"
        "  [ ]      one degree down, up; { } five; a wheel turns for half a second\n"
        "  i        to the initial posture\n"
        "  p        play the files\n" PLAY_KEYS_HELP "  R        release a stop\n"
        "  q        quit; what moves is stopped first\n"
        "\n"
        "Of a group (-d stage) each robot has a line; the keys are e, an emergency stop of all,\n"
        "and q.\n"
        "\n"
        "Without a terminal that can show it (or with --json) it is 'status --watch'.\n",
    .example = "  grctl monitor\n  grctl -d sim monitor motions/greet.pseq\n",
    .group = CLI_GROUP_TOGETHER,
    .run = run,
};
