/* SPDX-License-Identifier: MIT */
/*
 * How much of the wire is used, and for what: readings of all joints against what the wire allows,
 * beside motion frames that keep their deadlines.
 *
 * What the wire allows (protocol 2: 115200 bps, ten bits a byte, both lines, the board stores and
 * forwards), with R bytes of registers, n = 8 + R of the reply, d = 100 us of return delay:
 *
 *   board:  reading       (11 + 8 + n + n) * 10 / 115200 s + d    R = 18: 6264 us, R = 2: 3486 us
 *           all 20 goals  (110 + 108) * 10 / 115200 s             18924 us
 *   bus:    reading       (8 + n) * 10 / 115200 s + d             R = 18: 3052 us, R = 2: 1663 us
 *           all 20 goals  108 * 10 / 115200 s                     9375 us
 *
 *   alone:                 1 / reading                            a second
 *   beside f frames:       f * floor((1 / f - goals) / reading)   a second: none is cut in two
 */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "src/robot/slot.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

enum { JOINTS = 20, LENGTH_S = 5, SECOND_US = 1000000 };

static grobo_test_rig rig;
static rig_clip clip;
static unsigned taken[JOINTS]; /* readings, by joint */
static const rig_key sway[] = {{0, {{NECK, 0}}}, {2000, {{NECK, 30}}}, {30000, {{NECK, -30}}}};

/* One way of using the wire. */
typedef struct use {
    grobo_wiring wiring;
    bool position_only;
    int frames_hz; /* 0: no motion */
} use;

static double reading_us(const use *u)
{
    int reply = 8 + (u->position_only ? 2 : 18);
    int bytes = u->wiring == GROBO_WIRING_BOARD ? 11 + 8 + reply + reply : 8 + reply;
    return bytes * 10e6 / 115200 + 100;
}

static double goals_us(const use *u)
{
    return (u->wiring == GROBO_WIRING_BOARD ? 110 + 108 : 108) * 10e6 / 115200;
}

/* Readings a second that the wire allows. */
static double allowed_hz(const use *u)
{
    if (u->frames_hz == 0) {
        return 1e6 / reading_us(u);
    }
    return u->frames_hz * floor((1e6 / u->frames_hz - goals_us(u)) / reading_us(u));
}

static void on_event(grobo_test_rig *r, const grobo_event *event)
{
    (void)r;
    if (event->kind == GROBO_EVENT_JOINT && event->u.joint.result == GROBO_OK) {
        taken[event->u.joint.joint]++;
    }
}

static void start(const use *u)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1,
                                 .sense_position_only = u->position_only, .lost_replies = -1};
    rig_start_driver(&rig, grobo_gr001_driver(u->wiring), &config, NULL);
    rig_clip_init(&clip, sway, sizeof sway / sizeof *sway);
    rig.on_event = on_event;
    rig_power(&rig);
    if (u->frames_hz > 0) {
        grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                      .rate_hz = (uint16_t)u->frames_hz, .unwatched = true};
        rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_OK);
        rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
        rig_run(&rig, SECOND_US);
    }
    rig_forget(&rig);
    memset(taken, 0, sizeof taken);
}

static bool is_goals(const rig_frame *frame)
{
    return frame->size >= 108;
}

/* Motion frames leave to the microsecond; a reading that was begun is over when the next does. */
static void check_frames(const use *u)
{
    grobo_jitter jitter;
    const rig_frame *before = NULL;
    int frames = 0;
    for (size_t i = 0; i < rig.n_sent; i++) {
        const rig_frame *frame = &rig.sent[i];
        if (is_goals(frame) && before != NULL && !is_goals(before)) {
            assert_true((double)(frame->at_us - before->at_us) >= reading_us(u) - 1);
        }
        frames += is_goals(frame);
        before = frame;
    }
    grobo_robot_jitter(&rig.robot, &jitter);
    assert_true(frames >= LENGTH_S * u->frames_hz - 1);
    assert_int_equal(jitter.max_us, 0);
    assert_int_equal(grobo_robot_get_counters(&rig.robot)->late_frames, 0);
}

static void expect_rate(const use *u)
{
    unsigned all = 0;
    start(u);
    rig_run(&rig, LENGTH_S * SECOND_US);
    for (int j = 0; j < JOINTS; j++) {
        all += taken[j];
        assert_true(taken[j] + 1 >= 0.95 * LENGTH_S * allowed_hz(u) / JOINTS); /* each its share */
    }
    print_message("# %s, %s, %d frames/s: %.1f readings/s, the wire allows %.1f\n",
                  u->wiring == GROBO_WIRING_BOARD ? "board" : "bus",
                  u->position_only ? "position" : "full state", u->frames_hz,
                  all / (double)LENGTH_S, allowed_hz(u));
    assert_true(all >= 0.95 * LENGTH_S * allowed_hz(u));
    assert_true(all <= LENGTH_S * allowed_hz(u) + 1);
    check_frames(u);
}

TEST(readings_alone_fill_the_wire)
{
    for (int i = 0; i < 4; i++) {
        expect_rate(&(use){i < 2 ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS, i % 2 == 1, 0});
    }
}

TEST(readings_fill_the_gaps_between_frames)
{
    static const int rates_hz[] = {20, 30, 40, 50};
    for (int i = 0; i < 16; i++) {
        expect_rate(
            &(use){i < 8 ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS, i % 2 == 1, rates_hz[i / 2 % 4]});
    }
}

/* Servos that do not answer, and lost bytes, cost readings and no frame its time. */
TEST(a_bad_line_delays_no_frame)
{
    static const int rates_hz[] = {20, 30, 40};
    for (int i = 0; i < 6; i++) {
        use u = {GROBO_WIRING_BOARD, i % 2 == 1, rates_hz[i / 2]};
        start(&u);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), 0);
        assert_int_equal(grobo_sim_set_fault(&rig.sim, GROBO_SIM_FAULT_SILENT, 0.05), 0);
        assert_int_equal(grobo_sim_set_fault(&rig.sim, GROBO_SIM_FAULT_DROP, 0.002), 0);
        rig_run(&rig, 3 * SECOND_US);
        grobo_jitter jitter;
        grobo_robot_jitter(&rig.robot, &jitter);
        assert_true(jitter.frames >= (uint64_t)(3 * u.frames_hz));
        assert_int_equal(jitter.max_us, 0);
    }
}

/*
 * A free joint is read with its goal: 24 bytes of registers, 7306 us through the board, 3746 us on
 * a bus. The others, which hold, are read in full once a second for heat and voltage.
 */
static void expect_free_rate(grobo_wiring wiring, grobo_joint_mask joints, int n)
{
    const use full = {wiring, false, 0};
    double free_us = reading_us(&full) + (wiring == GROBO_WIRING_BOARD ? 12 : 6) * 10e6 / 115200;
    double allowed_hz = (1 - (JOINTS - n) * reading_us(&full) / 1e6) * 1e6 / free_us / n;
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = GROBO_SENSE_NEVER};
    rig_start_driver(&rig, grobo_gr001_driver(wiring), &config, NULL);
    rig.on_event = on_event;
    rig_power(&rig);
    assert_int_equal(grobo_robot_free(&rig.robot, joints, true), GROBO_OK);
    rig_run(&rig, SECOND_US);
    memset(taken, 0, sizeof taken);
    rig_run(&rig, LENGTH_S * SECOND_US);
    print_message("# %s, %d of 20 joints taught: each read %.1f times a second, "
                  "the wire allows %.1f\n",
                  wiring == GROBO_WIRING_BOARD ? "board" : "bus", n,
                  taken[R_KNEE] / (double)LENGTH_S, allowed_hz);
    for (int j = 0; j < JOINTS; j++) {
        if (joints & GROBO_JOINT_BIT(j)) {
            assert_true(taken[j] + 1 >= 0.95 * LENGTH_S * allowed_hz);
        } else {
            assert_in_range(taken[j], LENGTH_S - 1, LENGTH_S + 1);
        }
    }
}

TEST(a_taught_arm_has_the_wire)
{
    static const struct {
        int n;
        grobo_joint_mask joints;
    } taught[] = {{1, GROBO_JOINT_BIT(R_KNEE)},
                  {3, 7u << R_KNEE},
                  {6, 63u << R_KNEE},
                  {20, GROBO_JOINTS_ALL(JOINTS)}};
    for (int i = 0; i < 8; i++) {
        expect_free_rate(i < 4 ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS, taught[i % 4].joints,
                         taught[i % 4].n);
    }
}

/* Nothing wakes the host for a reading that finds no room before a frame has left. */
TEST(a_reading_without_room_does_not_spin)
{
    rig_start(&rig, &quiet, NULL);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_fault(&rig.sim, GROBO_SIM_FAULT_SILENT, 1), 0);
    grobo_robot_slot *last = NULL;
    grobo_robot_slot *slot;
    while ((slot = grobo_i_slot_take(&rig.robot, GROBO_I_USE_PLAIN)) != NULL) {
        assert_int_equal(
            rig.driver->sense(rig.driver, NULL, NECK, GROBO_SENSE_FULL, &rig.robot.built), 0);
        assert_int_equal(grobo_i_slot_send(slot, &rig.robot.built, GROBO_PRIORITY_SENSE), GROBO_OK);
        last = slot;
    }
    assert_non_null(last);
    assert_int_equal(grobo_robot_free(&rig.robot, GROBO_JOINT_BIT(NECK), true), GROBO_OK);
    rig_run(&rig, 10000);
    assert_true(grobo_robot_deadline(&rig.robot, rig.now_us) > rig.now_us);
    assert_int_equal(grobo_bus_cancel(&rig.robot.bus, &last->txn), GROBO_OK);
    assert_true(grobo_robot_deadline(&rig.robot, rig.now_us) <= rig.now_us);
    assert_int_equal(grobo_sim_set_fault(&rig.sim, GROBO_SIM_FAULT_SILENT, 0), 0);
    rig_forget(&rig);
    rig_run(&rig, 3000000);
    assert_true(rig_count(&rig, GROBO_EVENT_JOINT) > 10); /* then it is read */
}
