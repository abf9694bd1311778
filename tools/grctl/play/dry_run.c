/* SPDX-License-Identifier: MIT */
/*
 * Playing without a port: the same engine that drives a robot drives the simulator in virtual
 * time, and what it would send is printed. The simulated robot stands in the first posture.
 */
#include <math.h>
#include <string.h>

#include <grobo/core/lines.h>
#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/session.h>

#include "tools/grctl/cli/narrow.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/trace.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/play/play.h"

typedef struct rehearsal {
    app *a;
    grobo_robot robot;
    int n_lines;
    grobo_sim sim[GROBO_LINES_MAX]; /* of each line */
    trace trace;
    int64_t now_us;
    int64_t start_us; /* of the first frame, -1: none yet */
    int job_result;   /* of the last job; 1 while it runs */
    bool playing, over;
    int error;
    unsigned long frames;
    int rounds; /* of the pump, in this instant */
} rehearsal;

static void on_event(void *ctx, const grobo_event *event)
{
    rehearsal *r = ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        r->job_result = event->u.job.result;
    } else if (event->kind == GROBO_EVENT_PLAY) {
        grobo_sequencer_state to = event->u.play.to;
        r->playing = true;
        r->over = to == GROBO_SEQUENCER_FINISHED || to == GROBO_SEQUENCER_IDLE ||
                  to == GROBO_SEQUENCER_FAILED;
        if (to == GROBO_SEQUENCER_FAILED) {
            r->error = event->u.play.error;
        }
    }
}

static void print_frame(rehearsal *r, int line, const uint8_t *frame, int size)
{
    const grobo_driver *driver = grobo_robot_driver(&r->robot);
    const grobo_lines *lines = grobo_driver_lines(driver);
    const char *name = lines ? lines->line[line].name : NULL;
    driver = lines ? &lines->line[line].driver : driver;
    char hex[3 * GROBO_FRAME_MAX_BYTES + 1] = "";
    grobo_target target = {0};
    grobo_joint_mask torqued[GROBO_TORQUE_BRAKE + 1] = {0};
    if (!r->playing || driver->inspect(driver, NULL, frame, (size_t)size, &target, torqued) < 0 ||
        target.posture.set == 0) {
        return;
    }
    if (r->start_us < 0) {
        r->start_us = r->now_us;
    }
    double time_ms = (double)(r->now_us - r->start_us) / 1e3;
    for (int i = 0; i < size; i++) {
        snprintf(hex + 3 * i, 4, "%02X%s", frame[i], i + 1 < size ? " " : "");
    }
    r->frames++;
    if (r->a->json) {
        app_print_json(json_pack("{s:o,s:s,s:s*}", "time_ms", app_json_number(time_ms, 3), "hex",
                                 hex, "line", name));
    } else {
        app_print("%.0f %s%s%s\n", time_ms, name ? name : "", name ? ": " : "", hex);
    }
}

/* So many rounds in one instant, and time stands still. */
enum { ROUNDS_AT_ONCE = 10000 };

static void speak(rehearsal *r, int line)
{
    uint8_t buf[GROBO_FRAME_MAX_BYTES];
    int sent;
    while ((sent = grobo_robot_line_tx(&r->robot, line, buf, sizeof buf, r->now_us)) > 0) {
        trace_bytes(&r->trace, line, GROBO_DIR_TX, r->now_us, buf, (size_t)sent);
        print_frame(r, line, buf, sent);
        grobo_sim_rx(&r->sim[line], buf, (size_t)sent, r->now_us);
    }
}

/* One round of the pump; false when nothing will happen any more. */
static bool turn(rehearsal *r)
{
    uint8_t buf[GROBO_FRAME_MAX_BYTES];
    for (int line = 0; line < r->n_lines; line++) {
        size_t n = grobo_sim_tx(&r->sim[line], buf, sizeof buf, r->now_us);
        trace_bytes(&r->trace, line, GROBO_DIR_RX, r->now_us, buf, n);
        if (n) {
            grobo_robot_line_rx(&r->robot, line, buf, n, r->now_us);
        }
    }
    grobo_robot_step(&r->robot, r->now_us);
    int64_t next = GROBO_NEVER_US;
    for (int line = 0; line < r->n_lines; line++) {
        speak(r, line);
        int64_t other = grobo_sim_packet_deadline(&r->sim[line]);
        next = other < next ? other : next;
    }
    int64_t own = grobo_robot_deadline(&r->robot, r->now_us);
    next = own < next ? own : next;
    if (next == GROBO_NEVER_US) {
        return false;
    }
    r->rounds = next > r->now_us ? 0 : r->rounds + 1;
    if (next > r->now_us) {
        r->now_us = next;
    }
    return r->rounds < ROUNDS_AT_ONCE;
}

/* The simulated robot takes the first posture, as far as the motion gives one. */
static void take_first_posture(rehearsal *r, const grobo_clip *clip)
{
    grobo_posture first;
    int64_t at_us;
    if (clip->relative || clip->key(clip->ctx, 0, &first, &at_us) < 0) {
        return;
    }
    const grobo_lines *lines = grobo_driver_lines(grobo_robot_driver(&r->robot));
    for (int j = 0; j < first.n_joints; j++) {
        if (first.set & GROBO_JOINT_BIT(j)) {
            grobo_sim_set_angle(&r->sim[lines ? lines->line_of[j] : 0],
                                lines ? lines->joint_on[j] : j,
                                (int32_t)lround(grobo_deg_from_rad(first.angle_rad[j]) * 1e3), 0);
        }
    }
}

static int play(rehearsal *r, playlist *list)
{
    int error = grobo_robot_play(&r->robot, &list->clip[0], &list->options[0]);
    r->job_result = 1;
    while (error >= 0 && r->job_result > 0 && turn(r)) {
    }
    if (error >= 0) {
        error = r->job_result > 0 ? GROBO_ERR_TIMEOUT : r->job_result;
    }
    for (int i = 1; i < list->n && error >= 0; i++) {
        error = grobo_robot_enqueue(&r->robot, &list->clip[i], &list->options[i]);
    }
    while (error >= 0 && !r->over && turn(r)) {
    }
    if (error >= 0 && !r->over) {
        error = GROBO_ERR_TIMEOUT;
    }
    return error < 0 ? error : r->error;
}

/* A simulator for each line. */
static int make_sims(rehearsal *r)
{
    static grobo_robot_sim sim[GROBO_LINES_MAX];
    const grobo_robot_def *def = robot_of(r->a);
    int error = GROBO_OK;
    r->n_lines = def->n_lines > 0 ? def->n_lines : 1;
    robot_sim(r->a, &sim[0]);
    for (int i = 0; i < r->n_lines && !error; i++) {
        const grobo_robot_def *line = def->n_lines > 0 ? narrow_def(def, i) : NULL;
        if (def->n_lines > 0) {
            error = line ? grobo_robot_def_sim(line, line->wiring, &sim[i]) : GROBO_ERR_NOMEM;
        }
        error = error ? error : grobo_sim_init(&r->sim[i], &sim[i].config, 0);
    }
    return error;
}

int play_dry_run(playlist *list, app *a)
{
    static rehearsal r;
    grobo_wiring wiring = (grobo_wiring)app_global(a, GLOBAL_WIRING)->choice;
    grobo_robot_config config = {
        GROBO_ROBOT_CONFIG_INIT, .limit_policy = a->clamps ? GROBO_LIMIT_CLAMP : GROBO_LIMIT_REFUSE,
        .sense_interval_us = GROBO_SENSE_NEVER, .bus = {.baud_bps = conn_baud(a)}};
    trace_line line = {.device = GROBO_DEVICE_SIM, .wiring = wiring};
    grobo_posture start;
    memset(&r, 0, sizeof r);
    r.a = a;
    r.start_us = -1;
    grobo_posture_init_pose(&start, app_model(a));
    int status = playlist_prepare(list, a, &start);
    if (!status) {
        status = trace_open_robot(&r.trace, a, &line, 0);
    }
    if (status) {
        return status;
    }
    int error = make_sims(&r);
    if (!error) {
        error = grobo_robot_init(&r.robot, app_driver(a), NULL, &config, 0);
    }
    if (!error) {
        take_first_posture(&r, &list->clip[0]);
        grobo_robot_on_event(&r.robot, on_event, &r);
        grobo_robot_link_up(&r.robot, 0);
        error = play(&r, list);
    }
    int rate_bps;
    if (error == GROBO_ERR_UNWATCHED && wire_is_slow(app_driver(a), (int)conn_baud(a), &rate_bps)) {
        status = app_fail(a, EXIT_SAFETY, grobo_error_name(error), "%s",
                          wire_slow_text(app_driver(a), (int)conn_baud(a), rate_bps));
    } else if (error < 0) {
        status = app_fail_error(a, app_status_of(error), error, "play");
    }
    return trace_close(&r.trace, a, status);
}
