/* SPDX-License-Identifier: MIT */
/*
 * Playing without a port: the same engine that drives a robot drives the simulator in virtual
 * time, and what it would send is printed. The simulated robot stands in the first posture.
 */
#include <math.h>
#include <string.h>

#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/session.h>

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/trace.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/play/play.h"

typedef struct rehearsal {
    app *a;
    grobo_robot robot;
    grobo_sim sim;
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

static void print_frame(rehearsal *r, const uint8_t *frame, int size)
{
    const grobo_driver *driver = grobo_robot_driver(&r->robot);
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
        app_print_json(json_pack("{s:o,s:s}", "time_ms", app_json_number(time_ms, 3), "hex", hex));
    } else {
        app_print("%.0f %s\n", time_ms, hex);
    }
}

/* So many rounds in one instant, and time stands still. */
enum { ROUNDS_AT_ONCE = 10000 };

/* One round of the pump; false when nothing will happen any more. */
static bool turn(rehearsal *r)
{
    uint8_t buf[GROBO_FRAME_MAX_BYTES];
    size_t n = grobo_sim_tx(&r->sim, buf, sizeof buf, r->now_us);
    int sent;
    trace_bytes(&r->trace, GROBO_DIR_RX, r->now_us, buf, n);
    if (n) {
        grobo_robot_rx(&r->robot, buf, n, r->now_us);
    }
    grobo_robot_step(&r->robot, r->now_us);
    while ((sent = grobo_robot_tx(&r->robot, buf, sizeof buf, r->now_us)) > 0) {
        trace_bytes(&r->trace, GROBO_DIR_TX, r->now_us, buf, (size_t)sent);
        print_frame(r, buf, sent);
        grobo_sim_rx(&r->sim, buf, (size_t)sent, r->now_us);
    }
    int64_t next = grobo_robot_deadline(&r->robot, r->now_us);
    int64_t other = grobo_sim_packet_deadline(&r->sim);
    next = other < next ? other : next;
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
    for (int j = 0; j < first.n_joints; j++) {
        if (first.set & GROBO_JOINT_BIT(j)) {
            grobo_sim_set_angle(&r->sim, j,
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

int play_dry_run(playlist *list, app *a)
{
    static rehearsal r;
    grobo_wiring wiring = (grobo_wiring)app_global(a, GLOBAL_WIRING)->choice;
    static grobo_robot_sim sim;
    grobo_robot_config config = {
        GROBO_ROBOT_CONFIG_INIT, .limit_policy = a->clamps ? GROBO_LIMIT_CLAMP : GROBO_LIMIT_REFUSE,
        .sense_interval_us = GROBO_SENSE_NEVER, .bus = {.baud_bps = conn_baud(a)}};
    trace_line line = {.device = GROBO_DEVICE_SIM, .wiring = wiring};
    grobo_posture start;
    memset(&r, 0, sizeof r);
    r.a = a;
    if (robot_of(a)->n_lines > 0) {
        return app_fail(
            a, EXIT_USAGE, "UNSUPPORTED",
            "play --dry-run: %s has %d lines, and frames are shown of one; 'grctl -d sim "
            "play' plays it on all",
            robot_of(a)->name, robot_of(a)->n_lines);
    }
    robot_sim(a, &sim);
    r.start_us = -1;
    grobo_posture_init_pose(&start, app_model(a));
    int status = playlist_prepare(list, a, &start);
    if (!status) {
        status = trace_open(&r.trace, a, &line, 0);
    }
    if (status) {
        return status;
    }
    int error = grobo_sim_init(&r.sim, &sim.config, 0);
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
