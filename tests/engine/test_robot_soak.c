/* SPDX-License-Identifier: MIT */
/*
 * A restless user on a bad line: random requests under faults of every kind, with the rig's
 * invariants checked at every frame and every reading. GROBO_SOAK=1 makes it half an hour of
 * virtual time for each of many seeds; without it some minutes.
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

enum { NECK = 13, SHOULDER = 14, R_KNEE = 3 };

static grobo_test_rig rig;
static rig_clip clip;
static uint32_t random_state;
static const rig_key sway[] = {{0, {{NECK, 0}}},
                               {800, {{NECK, 40}, {SHOULDER, 90}}},
                               {1500, {{NECK, -40}, {R_KNEE, -100}}},
                               {2500, {{SHOULDER, -90}}}};

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

/* A stop is reached within its bound, whatever the line does; only a line that goes ends it too. */
static void request_stop(void)
{
    bool estop = pick(2) == 0;
    int64_t asked_us = rig.now_us;
    int number = estop ? grobo_robot_estop(&rig.robot, rig.now_us)
                       : grobo_robot_exit(&rig.robot, (grobo_exit_policy)pick(4), rig.now_us);
    if (number == GROBO_ERR_CLOSED || number == GROBO_ERR_STATE) {
        return;
    }
    const grobo_event_job *job = rig_wait(&rig, number);
    assert_true(rig.now_us - asked_us <= (estop ? 20000000 : 10010000));
    for (int j = 0; estop && job->result >= 0 && j < 20; j++) {
        assert_int_not_equal(rig_torque(&rig, j), GROBO_TORQUE_ON);
    }
    assert_false(estop && grobo_robot_moving(&rig.robot, rig.now_us));
}

static void request(void)
{
    static void (*const kinds[])(void) = {request_move,    request_move,    request_play,
                                          request_play,    request_play,    request_torque,
                                          request_control, request_control, request_stop};
    grobo_trip_info trip;
    grobo_robot_tripped(&rig.robot, &trip);
    if (trip.latched && pick(2) == 0) {
        (void)grobo_robot_reset(&rig.robot, rig.now_us);
    }
    if (pick(12) == 0) {
        (void)grobo_robot_free(&rig.robot, rig_all(&rig), true, rig.now_us);
    }
    kinds[pick(sizeof kinds / sizeof kinds[0])]();
}

static void soak(uint32_t seed, const char *faults, int64_t length_us)
{
    bool flips = strstr(faults, "all") != NULL || strstr(faults, "flip") != NULL;
    bool loses = flips || strstr(faults, "drop") != NULL || strstr(faults, "silent") != NULL;
    grobo_robot_config config = {.sense_interval_us = (int64_t)(1 + seed % 3 * 150000),
                                 .lost_replies = 30};
    grobo_sim_config sim = {
        .seed = seed + 1, .start = GROBO_SIM_START_LIMP, .jump_on_torque = seed % 2 == 0};
    random_state = seed * 2654435761u + 17;
    rig_start(&rig, &config, &sim);
    rig_clip_init(&clip, sway, 4);
    rig.replug_us = 50000;
    assert_true(grobo_sim_set_faults(&rig.sim, faults, strlen(faults)) > 0);
    /* Two flips of one bit leave the sum right: what such a line says nobody can know. Where
     * frames are lost, where a joint is on its way is known only when it was read. */
    rig.check_owner = rig.check_hold = !flips;
    rig.check_speed = !loses;
    int64_t until_us = rig.now_us + length_us;
    int64_t marked_us = 0;
    while (rig.now_us < until_us) {
        if (rig.now_us - marked_us > 10000000) {
            rig_mark_owners(&rig);
            marked_us = rig.now_us;
        }
        request();
        rig_run(&rig, (int64_t)pick(1500000));
        if (pick(20) == 0) {
            rig_stall(&rig, (int64_t)pick(600000));
        }
        rig_forget(&rig);
    }
}

static const char *const lines[] = {
    "drop=0.01",
    "flip=0.01",
    "duplicate=0.01",
    "delay=0.01",
    "split=0.01",
    "rubbish=0.01",
    "silent=0.01",
    "dupid=0.01",
    "hangup=0.001",
    "brownout=0.001",
    ("duplicate=0.01,delay=0.01,split=0.01,rubbish=0.01,silent=0.01,dupid=0.01,"
     "hangup=0.001,brownout=0.001"),
    "all=0.01,hangup=0.001",
    "all=0.001",
};

static void invariants_hold_on_every_line(void **state)
{
    (void)state;
    bool whole = getenv("GROBO_SOAK") != NULL;
    uint32_t seeds = whole ? 10 : 1;
    int64_t length_us = whole ? 1800000000 : 60000000;
    for (uint32_t seed = 0; seed < seeds; seed++) {
        for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
            print_message("# seed %u, %s\n", (unsigned)(seed * 100 + i), lines[i]);
            soak(seed * 100 + (uint32_t)i, lines[i], length_us);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(invariants_hold_on_every_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
