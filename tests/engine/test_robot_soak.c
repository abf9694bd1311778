/* SPDX-License-Identifier: MIT */
/*
 * A restless user on a bad line: random requests under faults of every kind, with the rig's
 * invariants checked at every frame and every reading:
 *   - no goal outside limits, none faster than its joint;
 *   - no torque comes on but with the goal where the joint is;
 *   - no reading that is not the joint's own, given after it was asked for, taken once;
 *   - a stop is reached within its bound, and nothing follows it;
 *   - nothing moves because a line is back.
 * All of them hold on every line. Two like flips pass the sum of a packet: the witness knows of
 * each such packet, and only that one joint is excused, until it is read again.
 *
 * GROBO_SOAK=10 (or make soak SEEDS=10) makes it half an hour of virtual time for each of ten
 * seeds and every line; without it a minute each. GROBO_SOAK_FROM is the first seed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rig.h"

static grobo_test_rig rig;
static rig_clip clip;
static uint32_t random_state;
static const rig_key sway[] = {{0, {{NECK, 0}}},
                               {800, {{NECK, 40}, {SHOULDER, 90}}},
                               {1500, {{NECK, -40}, {R_KNEE, -100}}},
                               {2500, {{SHOULDER, -90}}}};

/* Bounds of stops: the first frame of one may wait for the longest frame on the wire, and then
 * for a host that has just stalled; all of it for a robot that restarts again and again. */
enum { ESTOP_FRAME_US = 25000, ESTOP_US = 10000000, EXIT_US = 10010000 };

/* What all runs together came to. */
static struct {
    unsigned runs, moves, plays, singles, torque_on, trips, ruined, stops, stops_cut;
    unsigned made_up_commands, made_up_replies, made_up_believed, doubled, excused;
    uint64_t frames, believed, injected[GROBO_SIM_FAULTS];
    int64_t virtual_us, estop_us, stopped_us, exit_us; /* the longest */
} total;

static uint32_t pick(uint32_t n)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (random_state >> 8) % n;
}

static void request_move(void)
{
    int joint = (int)pick(20);
    const grobo_joint *limits = &rig.driver->model->joints[joint];
    double part = pick(1001) / 1000.0;
    double deg = grobo_deg_from_rad(limits->min_rad + (limits->max_rad - limits->min_rad) * part);
    grobo_posture target = rig_posture(&rig, joint, deg, (int)pick(2000));
    (void)grobo_robot_move(&rig.robot, &target, rig.now_us);
}

/* A program of one's own that sends a target every 20 ms. */
static void request_targets(void)
{
    int joint = (int)pick(20);
    const grobo_joint *limits = &rig.driver->model->joints[joint];
    for (unsigned left = pick(50); left > 0; left--) {
        double part = pick(1001) / 1000.0;
        double rad = limits->min_rad + (limits->max_rad - limits->min_rad) * part;
        grobo_posture target = rig_posture(&rig, joint, grobo_deg_from_rad(rad), (int)pick(200));
        rig.asked = true;
        total.singles += grobo_robot_send(&rig.robot, &target, rig.now_us) == GROBO_OK;
        rig_run(&rig, 20000);
    }
}

static void request_play(void)
{
    grobo_play_options options = {.mode = pick(2) ? GROBO_PLAY_RATE : GROBO_PLAY_KEY,
                                  .rate_hz = (uint16_t)(10 + pick(50)),
                                  .repeat = 1 + (int32_t)pick(3),
                                  .mirror = pick(4) == 0,
                                  .speed_pct = (uint16_t)(50 + pick(200))};
    (void)grobo_robot_play(&rig.robot, &clip.clip, &options, rig.now_us);
}

static void request_control(void)
{
    switch (pick(6)) {
    case 0:
        (void)grobo_robot_pause(&rig.robot, rig.now_us);
        break;
    case 1:
        (void)grobo_robot_resume(&rig.robot, rig.now_us);
        break;
    case 2:
        (void)grobo_robot_stop(&rig.robot, pick(2) == 0, rig.now_us);
        break;
    case 3:
        (void)grobo_robot_seek(&rig.robot, (int64_t)pick(2500000), rig.now_us);
        break;
    case 4:
        (void)grobo_robot_speed(&rig.robot, 20 + (int)pick(300), rig.now_us);
        break;
    default:
        (void)grobo_robot_cancel(&rig.robot, rig.now_us);
        break;
    }
}

static void request_torque(void)
{
    grobo_joint_mask joints = pick(2) ? rig_all(&rig) : GROBO_JOINT_BIT(pick(20));
    (void)grobo_robot_torque(&rig.robot, joints, (grobo_torque)pick(3), rig.now_us);
}

static bool all_stopped(void)
{
    for (int j = 0; j < 20; j++) {
        if (rig_torque(&rig, j) == GROBO_TORQUE_ON) {
            return false;
        }
    }
    return true;
}

static void most(int64_t *worst_us, int64_t us)
{
    *worst_us = us > *worst_us ? us : *worst_us;
}

/* The frame that stops leaves behind nothing but what is on the wire, and is repeated until every
 * joint was seen to have taken it, whatever the line does; only a line that goes ends that. */
static void request_estop(void)
{
    int64_t asked_us = rig.now_us;
    int64_t stopped_us = GROBO_NEVER_US;
    rig.torque_us = GROBO_NEVER_US;
    int number = grobo_robot_estop(&rig.robot, rig.now_us);
    if (number < 0) {
        assert_int_equal(number, GROBO_ERR_CLOSED);
        return;
    }
    while (rig.torque_us == GROBO_NEVER_US && rig.back_us == 0) {
        rig_run(&rig, 1000);
        assert_true(rig.now_us - asked_us <= ESTOP_FRAME_US);
    }
    const grobo_event *end = NULL;
    while (end == NULL) {
        rig_run(&rig, 1000);
        stopped_us = stopped_us == GROBO_NEVER_US && all_stopped() ? rig.now_us : stopped_us;
        assert_true(rig.now_us - asked_us <= ESTOP_US);
        const grobo_event *last = rig_last(&rig, GROBO_EVENT_JOB);
        end = last != NULL && last->u.job.number == number ? last : NULL;
    }
    if (end->u.job.result < 0) {
        /* Or a servo that the line gave another id: it says itself that it was not reached. */
        assert_true(end->u.job.result == GROBO_ERR_UNPLUGGED || rig.witness.settings_hit);
        total.stops_cut++;
        return;
    }
    total.stops++;
    most(&total.estop_us, rig.now_us - asked_us);
    if (rig.witness.misled == 0) {
        assert_true(stopped_us != GROBO_NEVER_US && all_stopped());
        most(&total.stopped_us, stopped_us - asked_us);
    }
    assert_false(grobo_robot_moving(&rig.robot, rig.now_us));
}

static void request_exit(void)
{
    int64_t asked_us = rig.now_us;
    int number = grobo_robot_exit(&rig.robot, (grobo_exit_policy)pick(4), rig.now_us);
    if (number > 0) {
        (void)rig_wait(&rig, number);
        assert_true(rig.now_us - asked_us <= EXIT_US);
        most(&total.exit_us, rig.now_us - asked_us);
    }
}

static void request(void)
{
    static void (*const kinds[])(void) = {request_move,    request_move,    request_play,
                                          request_play,    request_play,    request_torque,
                                          request_targets, request_control, request_control,
                                          request_estop,   request_exit};
    grobo_trip_info trip;
    rig.asked = true;
    grobo_robot_tripped(&rig.robot, &trip);
    if (trip.latched && pick(2) == 0) {
        (void)grobo_robot_reset(&rig.robot, rig.now_us);
    }
    if (pick(12) == 0) {
        (void)grobo_robot_free(&rig.robot, rig_all(&rig), true, rig.now_us);
    }
    kinds[pick(sizeof kinds / sizeof kinds[0])]();
}

static void on_event(grobo_test_rig *r, const grobo_event *event)
{
    (void)r;
    total.moves += event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_MOVE &&
                   event->u.job.result == GROBO_OK;
    total.plays += event->kind == GROBO_EVENT_PLAY && event->u.play.to == GROBO_SEQUENCER_FINISHED;
    total.trips += event->kind == GROBO_EVENT_TRIP;
}

static void add_up(void)
{
    total.frames += rig.frames;
    total.believed += rig.witness.believed;
    total.torque_on += rig.torque_on;
    total.made_up_commands += rig.witness.made_up_commands;
    total.made_up_replies += rig.witness.made_up_replies;
    total.made_up_believed += rig.witness.made_up_believed;
    total.doubled += rig.witness.doubled;
    total.excused += rig.excused;
    for (int i = 0; i < GROBO_SIM_FAULTS; i++) {
        total.injected[i] += rig.sim.stats.injected[i];
    }
}

static void start(uint32_t seed, const char *faults)
{
    grobo_wiring wiring = seed % 4 == 3 ? GROBO_WIRING_BUS : GROBO_WIRING_BOARD;
    grobo_robot_config config = {.sense_interval_us = (int64_t)(1 + seed % 3 * 150000),
                                 .lost_replies = 30};
    grobo_sim_config sim = {
        .seed = random_state, .start = GROBO_SIM_START_LIMP, .jump_on_torque = seed % 2 == 0};
    rig_start_driver(&rig, grobo_gr001_driver(wiring), &config, &sim);
    rig_clip_init(&clip, sway, 4);
    rig.on_event = on_event;
    rig.replug_us = 50000;
    assert_true(grobo_sim_set_faults(&rig.sim, faults, strlen(faults)) > 0);
}

/* Up to a time, or until the line made up a command that changed what flash keeps, such as an id:
 * that is no robot any more. @return how long it was one. */
static int64_t live(int64_t length_us)
{
    int64_t from_us = rig.now_us;
    while (rig.now_us - from_us < length_us && !rig.witness.settings_hit) {
        request();
        rig_run(&rig, (int64_t)pick(pick(3) == 0 ? 8000000 : 1500000)); /* at times it gets on */
        if (pick(20) == 0) {
            rig_stall(&rig, (int64_t)pick(600000));
        }
        rig_forget(&rig);
    }
    return rig.now_us - from_us;
}

static void soak(uint32_t seed, const char *faults, int64_t length_us)
{
    random_state = seed * 2654435761u + 17;
    while (length_us > 0) {
        start(seed, faults);
        int64_t lived_us = live(length_us);
        length_us -= lived_us;
        total.virtual_us += lived_us;
        total.ruined += rig.witness.settings_hit;
        add_up();
    }
    total.runs++;
}

#define REPLIES "duplicate=0.01,delay=0.01,split=0.01,rubbish=0.01,silent=0.01,dupid=0.01"

/* Every kind alone, so that the robot gets on with what it is asked for; then together. */
static const char *const lines[] = {
    "drop=0.01",
    "flip=0.01",
    "duplicate=0.01",
    "delay=0.01",
    "split=0.01",
    "rubbish=0.01",
    "silent=0.01",
    "dupid=0.01",
    "hangup=0.01",
    "brownout=0.01",
    "hangup=0.001,brownout=0.001",
    REPLIES,
    REPLIES ",hangup=0.001,brownout=0.001",
    "all=0.001,hangup=0.001",
    "all=0.01,brownout=0.001",
    "all=0.01,hangup=0.01",
};

static void report(uint32_t seeds)
{
    print_message("# %u seeds, %u runs, %.0f virtual minutes: no rule broken\n", (unsigned)seeds,
                  total.runs, (double)total.virtual_us / 60e6);
    print_message("# %llu frames sent, %llu readings believed, each given by its own servo\n",
                  (unsigned long long)total.frames, (unsigned long long)total.believed);
    print_message("# faults:");
    for (int i = 0; i < GROBO_SIM_FAULTS; i++) {
        print_message(" %s %llu", grobo_sim_fault_name(i), (unsigned long long)total.injected[i]);
    }
    print_message("\n# %u moves and %u plays done, %u single targets, %u torques on, %u trips, %u "
                  "robots ruined\n",
                  total.moves, total.plays, total.singles, total.torque_on, total.trips,
                  total.ruined);
    print_message("# %u emergency stops seen through, %u ended by the line; robot limp after at "
                  "most %.1f s, seen to be after %.1f s; exits after %.1f s\n",
                  total.stops, total.stops_cut, (double)total.stopped_us / 1e6,
                  (double)total.estop_us / 1e6, (double)total.exit_us / 1e6);
    print_message("# made up by the line with a sum that is right: %u commands, %u replies (%u "
                  "believed); %u goals and torques excused by them; %u replies believed twice\n",
                  total.made_up_commands, total.made_up_replies, total.made_up_believed,
                  total.excused, total.doubled);
}

/* GROBO_SOAK: how many seeds of half an hour each; without it one of a minute. */
static void invariants_hold_on_every_line(void **state)
{
    (void)state;
    const char *wanted = getenv("GROBO_SOAK");
    const char *from = getenv("GROBO_SOAK_FROM");
    uint32_t seeds = wanted != NULL ? (uint32_t)strtoul(wanted, NULL, 10) : 1;
    uint32_t first = from != NULL ? (uint32_t)strtoul(from, NULL, 10) : 0;
    int64_t length_us = wanted != NULL ? 1800000000 : 60000000;
    for (uint32_t seed = first; seed < first + seeds; seed++) {
        for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
            print_message("# seed %u, %s\n", (unsigned)(seed * 100 + i), lines[i]);
            soak(seed * 100 + (uint32_t)i, lines[i], length_us);
        }
    }
    report(seeds);
    /* It was a soak and not a stall. */
    assert_true(total.believed > 100000 * seeds / (wanted != NULL ? 1 : 30));
    assert_true(total.moves > 0 && total.plays > 0 && total.stops > 0 && total.torque_on > 0);
    for (int i = 0; i < GROBO_SIM_FAULTS; i++) {
        assert_true(total.injected[i] > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(invariants_hold_on_every_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
