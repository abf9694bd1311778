/* SPDX-License-Identifier: MIT */
/* An engine of two lines: two families with the same ids on both, in virtual time. Each line has a
 * wire of its own, with simulated servos or with the far side, which judges the stops. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/lines.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/posture.h>
#include <grobo/robot_file.h>

#include "src/base/instant.h"
#include "tests/support/family_kit.h"
#include "tests/support/far_side.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { MS = 1000, S = 1000000, EACH = 3, JOINTS = 2 * EACH, ALL = (1 << JOINTS) - 1 };

typedef struct wire {
    const family *f;
    grobo_sim sim;
    far_side far; /* family NULL: the simulator is there */
    const grobo_servo_model *servos[EACH];
    int frames;
    int64_t first_us; /* the first frame since it was FAR_NEVER */
} wire;

static struct {
    wire wire[2];
    grobo_joint joints[JOINTS];
    grobo_model model;
    grobo_lines lines;
    grobo_driver driver;
    grobo_robot robot;
    int64_t now_us;
    grobo_event_job done[64];
    unsigned n_done;
    grobo_trip_info trip;
    unsigned n_trips, n_halted, n_played;
    grobo_event_halted halted;
} kit;

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        kit.done[kit.n_done++ % 64] = event->u.job;
    } else if (event->kind == GROBO_EVENT_TRIP) {
        kit.trip = event->u.trip;
        kit.n_trips++;
    } else if (event->kind == GROBO_EVENT_HALTED) {
        kit.halted = event->u.halted;
        kit.n_halted++;
    } else if (event->kind == GROBO_EVENT_PLAY && event->u.play.to == GROBO_SEQUENCER_FINISHED) {
        kit.n_played++;
    }
}

static void make_joints(void)
{
    static const char *const names[JOINTS] = {"L1", "R1", "L2", "R2", "L3", "R3"};
    for (int j = 0; j < JOINTS; j++) {
        wire *w = &kit.wire[j % 2];
        const grobo_servo_model *servo = grobo_servo_model_named(w->f->table, w->f->servo);
        assert_non_null(servo);
        w->servos[j / 2] = servo;
        kit.joints[j] = (grobo_joint){.name = names[j],
                                      .min_rad = RAD(-90),
                                      .max_rad = RAD(90),
                                      .max_speed_rad_s = RAD(0.8 * servo->speed_dps),
                                      .servo_model = servo->number,
                                      .motor = (uint8_t)(j / 2 + 1), /* the same on both */
                                      .mirror = (uint8_t)(j ^ 1),
                                      .mirror_sign = 1,
                                      .sign = 1,
                                      .line = (uint8_t)(j % 2)};
    }
    kit.model = (grobo_model)GROBO_TABLE(grobo_model, .name = "two", GROBO_MODEL_JOINTS(kit.joints),
                                         .n_joints = JOINTS);
}

static void power_up(wire *w, const grobo_model *model)
{
    grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT,
                            .seed = 7,
                            .model = model,
                            .wiring = GROBO_WIRING_BUS,
                            .servos = w->servos,
                            .families = grobo_i_sim_families,
                            .baud_bps = w->f->baud_bps,
                            .echo = w->f->echo,
                            .mounted = true,
                            .supply_mv = w->servos[0]->voltage_mv};
    assert_int_equal(grobo_sim_init(&w->sim, &sim, kit.now_us), GROBO_OK);
}

/* far: the far side has the servos, with the same registers. */
static void start_with(const family *left, const family *right, const far_family *far_left,
                       const far_family *far_right, const grobo_robot_config *config)
{
    const far_family *far[2] = {far_left, far_right};
    memset(&kit, 0, sizeof kit);
    kit.now_us = S;
    kit.wire[0].f = left;
    kit.wire[1].f = right;
    make_joints();
    assert_int_equal(grobo_lines_split(&kit.lines, &kit.model), GROBO_OK);
    for (int i = 0; i < 2; i++) {
        grobo_lines_line *line = &kit.lines.line[i];
        wire *w = &kit.wire[i];
        line->driver.size = sizeof line->driver;
        assert_int_equal(w->f->init(&line->driver, &line->model), GROBO_OK);
        line->baud_bps = w->f->baud_bps;
        line->echo = far[i] != NULL ? far[i]->echo : w->f->echo;
        w->first_us = FAR_NEVER;
        if (far[i] != NULL) {
            far_begin(&w->far, far[i], EACH, kit.now_us);
            w->far.baud_bps = (int)w->f->baud_bps;
        } else {
            power_up(w, &line->model);
        }
    }
    kit.driver.size = sizeof kit.driver;
    assert_int_equal(grobo_lines_driver_init(&kit.driver, &kit.lines, &kit.model), GROBO_OK);
    assert_int_equal(grobo_robot_init(&kit.robot, &kit.driver, NULL, config, kit.now_us), GROBO_OK);
    grobo_robot_on_event(&kit.robot, on_event, NULL);
    grobo_robot_link_up(&kit.robot, kit.now_us);
}

static void start(const family *left, const family *right)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT};
    start_with(left, right, NULL, NULL, &config);
}

static double angle_deg(int joint)
{
    wire *w = &kit.wire[joint % 2];
    if (w->far.family != NULL) {
        return far_angle(&w->far, joint / 2, kit.now_us);
    }
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&w->sim, joint / 2, &view), GROBO_OK);
    return view.angle_mdeg / 1000.0;
}

static int torque_of(int joint)
{
    wire *w = &kit.wire[joint % 2];
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&w->sim, joint / 2, &view), GROBO_OK);
    return (int)view.torque;
}

static void receive(int line)
{
    wire *w = &kit.wire[line];
    uint8_t b[GROBO_FRAME_MAX_BYTES];
    int n;
    while ((n = w->far.family != NULL ? far_give(&w->far, b, sizeof b, kit.now_us)
                                      : (int)grobo_sim_tx(&w->sim, b, sizeof b, kit.now_us)) > 0) {
        grobo_robot_line_rx(&kit.robot, line, b, (size_t)n, kit.now_us);
    }
}

static void transmit(int line)
{
    wire *w = &kit.wire[line];
    uint8_t b[GROBO_FRAME_MAX_BYTES];
    int n = grobo_robot_line_tx(&kit.robot, line, b, sizeof b, kit.now_us);
    assert_true(n >= 0);
    if (n > 0) {
        w->frames++;
        w->first_us = w->first_us == FAR_NEVER ? kit.now_us : w->first_us;
        if (w->far.family != NULL) {
            far_take(&w->far, b, n, kit.now_us);
        } else {
            assert_int_equal(grobo_sim_rx(&w->sim, b, (size_t)n, kit.now_us), n);
        }
    }
}

static int64_t next_of(wire *w)
{
    return w->far.family != NULL ? far_next_us(&w->far) : grobo_sim_deadline(&w->sim);
}

static void run(int64_t us)
{
    int64_t until_us = kit.now_us + us;
    for (int spins = 0; kit.now_us <= until_us; spins++) {
        assert_true(spins < 4000000);
        receive(0);
        receive(1);
        grobo_robot_step(&kit.robot, kit.now_us);
        transmit(0);
        transmit(1);
        int64_t next_us = grobo_robot_deadline(&kit.robot, kit.now_us);
        next_us = grobo_i_sooner(next_us, next_of(&kit.wire[0]));
        next_us = grobo_i_sooner(next_us, next_of(&kit.wire[1]));
        if (next_us > until_us) {
            kit.now_us = until_us;
            return;
        }
        kit.now_us = grobo_i_later(kit.now_us, next_us);
    }
}

static const grobo_event_job *wait(int number)
{
    if (number <= 0) {
        fail_msg("%s and %s: refused: %s, trip %d", kit.wire[0].f->name, kit.wire[1].f->name,
                 grobo_error_name(number), (int)kit.trip.trip);
    }
    for (int64_t end_us = kit.now_us + 60 * (int64_t)S; kit.now_us < end_us; run(MS)) {
        for (unsigned i = 0; i < kit.n_done && i < 64; i++) {
            if (kit.done[i].number == number) {
                return &kit.done[i];
            }
        }
    }
    fail_msg("job %d does not end", number);
    return NULL;
}

static grobo_posture posture(double deg, int time_ms)
{
    grobo_posture p;
    assert_int_equal(grobo_posture_init(&p, JOINTS), 0);
    for (int j = 0; j < JOINTS; j++) {
        p.angle_rad[j] = RAD(deg - 5 * j);
    }
    p.set = GROBO_JOINTS_ALL(JOINTS);
    p.time_us = time_ms * (int64_t)MS;
    return p;
}

static int move(double deg, int time_ms)
{
    grobo_posture p = posture(deg, time_ms);
    return grobo_robot_move(&kit.robot, &p);
}

static void assert_at(double deg)
{
    for (int j = 0; j < JOINTS; j++) {
        double off_deg = fabs(angle_deg(j) - (deg - 5 * j));
        if (off_deg > 1.5) {
            fail_msg("%s and %s: joint %d is at %f, not %f", kit.wire[0].f->name,
                     kit.wire[1].f->name, j, angle_deg(j), deg - 5 * j);
        }
    }
}

/* The furthest that a joint goes in the next 300 ms. */
static double turns_deg(void)
{
    double before[JOINTS], most = 0;
    for (int j = 0; j < JOINTS; j++) {
        before[j] = angle_deg(j);
    }
    run(300 * MS);
    for (int j = 0; j < JOINTS; j++) {
        most = fmax(most, fabs(angle_deg(j) - before[j]));
    }
    return most;
}

static void go(double deg)
{
    const grobo_event_job *job = wait(move(deg, 1000));
    if (job->result != GROBO_OK) {
        fail_msg("%s and %s: %s, joint %d, trip %d", kit.wire[0].f->name, kit.wire[1].f->name,
                 grobo_error_name(job->result), job->joint, (int)kit.trip.trip);
    }
}

/* Checked, read, moved, and each joint at its own angle, though ids are alike. */
static void move_two(const family *left, const family *right)
{
    start(left, right);
    assert_int_equal(grobo_robot_lines(&kit.robot), 2);
    assert_int_equal(wait(grobo_robot_check(&kit.robot))->result, GROBO_OK);
    assert_int_equal(wait(grobo_robot_sense(&kit.robot, ALL, GROBO_SENSE_FULL))->result, GROBO_OK);
    go(30);
    assert_at(30);
    go(-10);
    assert_at(-10);
    for (int j = 0; j < JOINTS; j++) {
        grobo_joint_info info;
        assert_int_equal(grobo_robot_joint(&kit.robot, j, &info), GROBO_OK);
        assert_true(fabs(info.state.angle_rad - RAD(-10 - 5 * j)) < RAD(1.5));
        assert_int_equal(info.status, GROBO_OK);
    }
    assert_int_equal(kit.n_trips, 0);
}

TEST(every_two_families_are_one_robot)
{
    for (const family *l = family_next(NULL); l != NULL; l = family_next(l)) {
        for (const family *r = family_next(NULL); r != NULL; r = family_next(r)) {
            move_two(l, r);
        }
    }
}

typedef struct stop_way {
    const char *name;
    bool latches;
    int (*ask)(void);
} stop_way;

static int ask_stop(void)
{
    return grobo_robot_stop(&kit.robot, true);
}

static int ask_cancel(void)
{
    return grobo_robot_cancel(&kit.robot);
}

static int ask_estop(void)
{
    return grobo_robot_estop(&kit.robot);
}

static int ask_exit(void)
{
    return grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
}

static const stop_way stops[] = {
    {"stop", false, ask_stop},
    {"cancel", false, ask_cancel},
    {"estop", true, ask_estop},
    {"exit", false, ask_exit},
};

static void stop_two(const family *left, const family *right, const stop_way *way)
{
    start(left, right);
    go(60);
    int moving = move(-60, 4000);
    assert_true(moving > 0);
    run(1500 * MS);
    double before[JOINTS];
    for (int j = 0; j < JOINTS; j++) {
        before[j] = angle_deg(j);
    }
    kit.wire[0].first_us = kit.wire[1].first_us = FAR_NEVER;
    int64_t asked_us = kit.now_us;
    assert_true(way->ask() >= 0);
    run(1500 * MS);
    for (int i = 0; i < 2; i++) { /* one frame of the slowest line, and 10 ms */
        int64_t late_us = kit.wire[i].first_us - asked_us;
        if (kit.wire[i].first_us == FAR_NEVER || late_us > 15 * MS) {
            fail_msg("%s and %s, %s: line %d is told after %d us", left->name, right->name,
                     way->name, i, (int)late_us);
        }
    }
    for (int j = 0; j < JOINTS; j++) {
        double went_deg = fabs(angle_deg(j) - before[j]);
        if (went_deg > 10 || fabs(angle_deg(j) - (-60 - 5 * j)) < 20) {
            fail_msg("%s and %s, %s: joint %d went on by %f", left->name, right->name, way->name, j,
                     went_deg);
        }
    }
    double turns = turns_deg();
    if (turns > 0.5) {
        fail_msg("%s and %s, %s: turns on, %f", left->name, right->name, way->name, turns);
    }
    assert_int_equal(move(0, 500) > 0, way->latches ? false : way->ask != ask_exit || true);
}

TEST(each_stop_reaches_both_lines)
{
    for (const family *l = family_next(NULL); l != NULL; l = family_next(l)) {
        const family *r = family_next(l) != NULL ? family_next(l) : family_next(NULL);
        for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i++) {
            stop_two(l, r, &stops[i]);
            stop_two(r, l, &stops[i]);
        }
    }
}

TEST(a_trip_of_one_line_stops_the_other)
{
    start(family_named("sts"), family_named("dxl2"));
    go(60);
    assert_true(move(-60, 4000) > 0);
    run(1000 * MS);
    assert_int_equal(grobo_sim_set_temperature(&kit.wire[1].sim, 0, 70), GROBO_OK);
    run(2500 * MS);
    assert_int_equal(kit.trip.trip, GROBO_TRIP_TEMPERATURE);
    assert_int_equal(kit.trip.joint, 1);
    assert_true(turns_deg() < 0.5);
    for (int j = 0; j < JOINTS; j++) {
        assert_true(angle_deg(j) > -50);
    }
    assert_int_equal(move(0, 500), GROBO_ERR_LATCHED);
}

/* The cable of one line is out while all moves: the other stops at once, the robot is latched, and
 * what comes back is read before it moves. */
static void lose(const family *left, const family *right, int line)
{
    start(left, right);
    go(60);
    int moving = move(-60, 4000);
    run(1500 * MS);
    grobo_sim_plug(&kit.wire[line].sim, false, kit.now_us);
    kit.wire[!line].first_us = FAR_NEVER;
    int64_t lost_us = kit.now_us;
    grobo_robot_line_down(&kit.robot, line, kit.now_us);
    assert_int_equal(kit.trip.trip, GROBO_TRIP_LOST_REPLIES);
    assert_int_equal(kit.trip.joint, line);
    assert_true(kit.trip.latched);
    assert_int_equal(wait(moving)->result, GROBO_ERR_LATCHED);
    int frames = kit.wire[line].frames;
    run(500 * MS);
    assert_true(kit.wire[!line].first_us - lost_us <= 15 * MS);
    assert_int_equal(kit.wire[line].frames, frames); /* nothing is sent to who is not there */
    double before[JOINTS];
    for (int j = 0; j < JOINTS; j++) {
        before[j] = angle_deg(j);
    }
    run(4000 * MS); /* no longer than a stop may wait, and no spinning meanwhile */
    for (int j = !line; j < JOINTS; j += 2) {
        assert_true(fabs(angle_deg(j) - before[j]) < 0.5);
    }
    grobo_joint_info info;
    assert_int_equal(grobo_robot_joint(&kit.robot, line, &info), GROBO_OK);
    assert_true(info.status < 0);
    grobo_sim_plug(&kit.wire[line].sim, true, kit.now_us);
    grobo_robot_line_up(&kit.robot, line, kit.now_us);
    assert_int_equal(move(0, 500), GROBO_ERR_LATCHED);
    assert_int_equal(grobo_robot_reset(&kit.robot), GROBO_OK);
    grobo_posture p = posture(0, 1000);
    assert_int_equal(grobo_robot_send(&kit.robot, &p), GROBO_ERR_STALE);
    go(0);
    assert_at(0);
}

TEST(a_line_that_is_lost_stops_the_robot_and_is_read_when_it_is_back)
{
    for (const family *l = family_next(NULL); l != NULL; l = family_next(l)) {
        lose(l, family_named("dxl2"), 0);
        lose(l, family_named("dxl2"), 1);
    }
}

/* What is asked of a robot with a line that is not there ends, and names its joints. */
TEST(a_stop_without_one_line_names_its_joints)
{
    start(family_named("dxl1"), family_named("sts"));
    go(20);
    grobo_robot_line_down(&kit.robot, 1, kit.now_us);
    const grobo_event_job *stop = wait(grobo_robot_estop(&kit.robot));
    assert_true(stop->result < 0);
    assert_int_equal(stop->failed, 2 + 8 + 32);
    assert_int_equal(wait(grobo_robot_sense(&kit.robot, ALL, GROBO_SENSE_FULL))->failed,
                     2 + 8 + 32);
    grobo_robot_link_down(&kit.robot, kit.now_us);
    grobo_robot_link_up(&kit.robot, kit.now_us); /* of all lines */
    assert_int_equal(wait(grobo_robot_check(&kit.robot))->result, GROBO_OK);
    assert_int_equal(wait(grobo_robot_sense(&kit.robot, ALL, GROBO_SENSE_FULL))->result, GROBO_OK);
}

TEST(a_check_needs_an_answer_of_each_line)
{
    for (int line = 0; line < 2; line++) {
        start(family_named("lx16a"), family_named("dxl1"));
        grobo_sim_plug(&kit.wire[line].sim, false, kit.now_us);
        assert_int_equal(wait(grobo_robot_check(&kit.robot))->result, GROBO_ERR_TIMEOUT);
    }
}

TEST(an_exit_takes_torque_away_on_both)
{
    start(family_named("dxl2"), family_named("scs"));
    go(10);
    for (int j = 0; j < JOINTS; j++) {
        assert_int_equal(torque_of(j), GROBO_TORQUE_ON);
    }
    assert_int_equal(wait(grobo_robot_exit(&kit.robot, GROBO_EXIT_OFF))->result, GROBO_OK);
    for (int j = 0; j < JOINTS; j++) {
        assert_int_equal(torque_of(j), GROBO_TORQUE_OFF);
    }
}

/* ---- motions --------------------------------------------------------------------------------- */

/* A wave of all joints. */
static int sample_wave(void *ctx, int64_t at_us, grobo_posture *p)
{
    (void)ctx;
    *p = posture(20 * sin(6.283185307179586 * (double)at_us / 2e6), 0);
    p->time_us = 0;
    return GROBO_OK;
}

static int key_of_wave(void *ctx, size_t index, grobo_posture *p, int64_t *at_us)
{
    *at_us = (int64_t)index * S / 4;
    return sample_wave(ctx, *at_us, p);
}

TEST(a_motion_is_played_in_time_on_both)
{
    const grobo_play_options at_rate = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE};
    const grobo_clip clip = {.sample = sample_wave,
                             .key = key_of_wave,
                             .n_keys = 17,
                             .length_us = 4 * S,
                             .n_joints = JOINTS};
    for (const family *l = family_next(NULL); l != NULL; l = family_next(l)) {
        start(l, family_named("sts"));
        go(0);
        int64_t from_us = kit.now_us;
        const grobo_event_job *job = wait(grobo_robot_play(&kit.robot, &clip, &at_rate));
        assert_int_equal(job->result, GROBO_OK);
        double most_deg = 0;
        int64_t began_us = kit.now_us;
        while (kit.n_played == 0 && kit.now_us - from_us < 8 * S) {
            run(10 * MS);
            for (int j = 0; j < JOINTS; j++) {
                grobo_play_progress progress;
                grobo_robot_progress(&kit.robot, &progress);
                double is_deg = 20 * sin(6.283185307179586 * (double)progress.t_us / 2e6) - 5 * j;
                most_deg =
                    fmax(most_deg, kit.now_us - began_us < S ? 0 : fabs(angle_deg(j) - is_deg));
            }
        }
        grobo_jitter jitter;
        grobo_robot_jitter(&kit.robot, &jitter);
        const grobo_robot_counters *counters = grobo_robot_get_counters(&kit.robot);
        if (kit.n_played != 1 || most_deg > 15 || counters->late_frames > 0 ||
            jitter.max_us > 10 * MS) {
            fail_msg("%s: played %u, %f beside, %d late, %d us", l->name, kit.n_played, most_deg,
                     (int)counters->late_frames, (int)jitter.max_us);
        }
        assert_int_equal(kit.n_trips, 0);
    }
}

/* ---- judged by the far side ------------------------------------------------------------------ */

static void stop_far(const char *left, const far_family *far_left, const char *right,
                     const far_family *far_right, const stop_way *way)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT};
    family l = *family_named(left), r = *family_named(right);
    l.servo = l.table == &grobo_i_dxl2_table ? "XL430-W250" : l.servo; /* that of the far side */
    r.servo = r.table == &grobo_i_dxl2_table ? "XL430-W250" : r.servo;
    start_with(&l, &r, far_left, far_right, &config);
    go(60);
    assert_true(move(-60, 4000) > 0);
    run(1500 * MS);
    for (int i = 0; i < 2; i++) {
        assert_true(far_turns(&kit.wire[i].far, 0, kit.now_us));
        kit.wire[i].far.motor_left_us = FAR_NEVER;
    }
    int64_t asked_us = kit.now_us;
    double before[JOINTS];
    for (int j = 0; j < JOINTS; j++) {
        before[j] = angle_deg(j);
    }
    assert_true(way->ask() >= 0);
    run(600 * MS);
    for (int i = 0; i < 2; i++) {
        int64_t late_us = kit.wire[i].far.motor_left_us - asked_us;
        assert_true(kit.wire[i].far.motor_left_us != FAR_NEVER);
        if (late_us < 0 || late_us > 15 * MS) {
            fail_msg("%s and %s, %s: line %d hears of it after %d us", left, right, way->name, i,
                     (int)late_us);
        }
        assert_int_equal(kit.wire[i].far.broken_frames, 0);
    }
    for (int j = 0; j < JOINTS; j++) {
        assert_false(far_turns(&kit.wire[j % 2].far, j / 2, kit.now_us));
        assert_true(fabs(angle_deg(j) - before[j]) < 15);
    }
}

TEST(the_far_side_stops_on_both_lines)
{
    for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i++) {
        stop_far("sts", &far_sts, "dxl2", &far_dxl2, &stops[i]);
        stop_far("dxl1", &far_dxl1, "dxl2", &far_dxl2, &stops[i]);
        stop_far("lx16a", &far_lx16a, "scs", &far_scs, &stops[i]);
        stop_far("ics", &far_ics, "dxl1", &far_dxl1, &stops[i]);
    }
}

/* ---- servos by their ids --------------------------------------------------------------------- */

static uint8_t id_read;
static size_t size_read;

static void on_registers(void *ctx, const grobo_event *event)
{
    on_event(ctx, event);
    if (event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_REGISTERS) {
        size_read = event->u.job.size;
        id_read = size_read > 0 ? event->u.job.data[0] : 0;
    }
}

TEST(a_servo_is_named_by_its_line_and_id)
{
    start(family_named("sts"), family_named("dxl2"));
    grobo_robot_on_event(&kit.robot, on_registers, NULL);
    const grobo_register_io sts_id = {.id = 2, .address = 5, .length = 1};
    assert_int_equal(wait(grobo_robot_registers(&kit.robot, &sts_id))->result, GROBO_OK);
    assert_int_equal(id_read, 2);
    const grobo_register_io dxl_id = {.id = 3, .address = 7, .length = 1};
    int frames = kit.wire[1].frames;
    assert_int_equal(wait(grobo_robot_line_registers(&kit.robot, 1, &dxl_id))->result, GROBO_OK);
    assert_int_equal(id_read, 3);
    assert_true(kit.wire[1].frames > frames);
    assert_int_equal(grobo_robot_line_registers(&kit.robot, 2, &dxl_id), GROBO_ERR_ARG);
    const uint8_t ping[] = {0xFF, 0xFF, 1, 2, 1, 0xFB};
    assert_int_equal(grobo_robot_raw(&kit.robot, ping, sizeof ping), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(
        wait(grobo_robot_command(&kit.robot, GROBO_SERVO_ON(1, 2), GROBO_SERVO_REBOOT))->result,
        GROBO_OK);
    grobo_joint_info info;
    assert_int_equal(grobo_robot_joint(&kit.robot, 3, &info), GROBO_OK);
    assert_int_equal(grobo_robot_command(&kit.robot, GROBO_SERVO_ON(2, 2), GROBO_SERVO_REBOOT),
                     GROBO_ERR_ARG);
}

/* ---- what is refused ------------------------------------------------------------------------- */

TEST(lines_that_do_not_fit_are_refused)
{
    start(family_named("sts"), family_named("dxl2"));
    static grobo_lines lines;
    grobo_joint joints[JOINTS];
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    memcpy(joints, kit.joints, sizeof joints);
    grobo_model model = kit.model;
    model.joints = joints;
    joints[1].motor = 2; /* twice on line 1 */
    assert_int_equal(grobo_lines_split(&lines, &model), GROBO_ERR_ARG);
    joints[1].motor = 1;
    assert_int_equal(grobo_lines_split(&lines, &model), GROBO_OK);
    assert_int_equal(lines.on[0], 1 + 4 + 16);
    assert_int_equal(lines.line[1].model.n_joints, EACH);
    assert_string_equal(lines.line[1].model.joints[2].name, "R3");
    joints[0].line = GROBO_LINES_MAX;
    assert_int_equal(grobo_model_check(&model), GROBO_ERR_ARG);
    joints[0].line = 3; /* nobody is on line 2 */
    assert_int_equal(grobo_lines_split(&lines, &model), GROBO_ERR_ARG);
    for (int j = 0; j < JOINTS; j++) {
        joints[j].line = 0;
        joints[j].motor = (uint8_t)(j + 1);
    }
    assert_int_equal(grobo_lines_split(&lines, &model), GROBO_ERR_ARG); /* one line is none */
    assert_int_equal(grobo_lines_driver_init(&driver, &lines, &model), GROBO_ERR_ARG);
    memcpy(joints, kit.joints, sizeof joints);
    joints[2].follows = 1; /* on another line */
    joints[2].ratio = 1;
    assert_int_equal(grobo_lines_split(&lines, &model), GROBO_ERR_ARG);
    joints[2].follows = 0;
    assert_int_equal(grobo_lines_split(&lines, &model), GROBO_OK);
    assert_int_equal(lines.line[0].model.joints[1].follows, 0);
    assert_null(grobo_driver_lines(&kit.lines.line[0].driver));
    assert_ptr_equal(grobo_driver_lines(&kit.driver), &kit.lines);
    assert_int_equal(grobo_robot_line_tx(&kit.robot, 2, (uint8_t[8]){0}, 8, kit.now_us),
                     GROBO_ERR_ARG);
    assert_null(grobo_robot_line_stats(&kit.robot, 2));
    assert_int_equal(grobo_robot_lines(NULL), GROBO_ERR_ARG);
}

TEST(limits_of_the_robot_are_the_narrowest_of_its_lines)
{
    start(family_named("sts"), family_named("ics"));
    grobo_safety_limits *left = &kit.lines.line[0].driver.limits;
    grobo_safety_limits *right = &kit.lines.line[1].driver.limits;
    *left = (grobo_safety_limits){.temperature_c = 60, .lost_replies = 0, .approach_rad_s = 2};
    *right = (grobo_safety_limits){.temperature_c = 0, .lost_replies = 4, .approach_rad_s = 1};
    right->voltage_mv = 9000;
    assert_int_equal(grobo_lines_driver_init(&kit.driver, &kit.lines, &kit.model), GROBO_OK);
    assert_int_equal(kit.driver.limits.temperature_c, 60);
    assert_int_equal(kit.driver.limits.lost_replies, 4);
    assert_int_equal(kit.driver.limits.voltage_mv, 0);
    assert_true(kit.driver.limits.approach_rad_s == 1);
}

TEST(the_budget_is_that_of_both_lines)
{
    grobo_budget both, fast;
    start(family_named("lx16a"), family_named("sts"));
    assert_int_equal(grobo_robot_budget(&kit.robot, &both), GROBO_OK);
    const grobo_bus_config line = {.baud_bps = 1000000};
    assert_int_equal(grobo_budget_init(&fast, &kit.driver, NULL, &line), GROBO_OK);
    assert_int_equal(fast.motion_us, both.motion_us);
    assert_int_equal(fast.watched_hz, both.watched_hz);
    grobo_budget slow;
    const grobo_bus_config own = {.baud_bps = 115200, .echo = true};
    assert_int_equal(grobo_budget_init(&slow, &kit.lines.line[0].driver, NULL, &own), GROBO_OK);
    assert_int_equal(both.motion_us, slow.motion_us); /* the other one is faster, meanwhile */
    grobo_budget quick;
    assert_int_equal(grobo_budget_init(&quick, &kit.lines.line[1].driver, NULL, &line), GROBO_OK);
    /* One after the other, three here and three there. */
    assert_in_range(both.reading_us, slow.reading_us / 2, slow.reading_us / 2 + quick.reading_us);
    assert_true(both.watched_hz > 0);
}
