/* SPDX-License-Identifier: MIT */
/* The same requests on another clock: the same frames, the same events. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/robot.h>

#include "tests/support/next_random.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig, first;
static rig_clip clip, other;
static uint32_t random_state;

static const rig_key sway[] = {{0, {{NECK, 0}}},
                               {800, {{NECK, 40}, {SHOULDER, 90}}},
                               {1500, {{NECK, -40}, {R_KNEE, -100}}},
                               {2500, {{SHOULDER, -90}}}};
static const rig_key nod[] = {{0, {{NECK, 10}}}, {600, {{NECK, -10}, {CHEST, 20}}}};

static uint32_t pick(uint32_t n)
{
    return next_random(&random_state) % n;
}

static grobo_posture any_target(void)
{
    int joint = (int)pick(20);
    const grobo_joint *limits = &rig.driver->model->joints[joint];
    double part = pick(1001) / 1000.0;
    double rad = limits->min_rad + (limits->max_rad - limits->min_rad) * part;
    return rig_posture(&rig, joint, grobo_deg_from_rad(rad), (int)pick(1500));
}

static void send_targets(void)
{
    for (unsigned left = pick(20); left > 0; left--) {
        grobo_posture target = any_target();
        (void)grobo_robot_send(&rig.robot, &target);
        rig_run(&rig, 20000);
    }
}

static void send_raw(void)
{
    uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
    grobo_rs30x_goal goal = {NECK_ID, (int16_t)((int)pick(800) - 400), (uint16_t)(1 + pick(200))};
    int n = pick(3) == 0   ? grobo_frame_read(grobo_wiring_protocol(rig_wiring), R_ELBOW_ID, 42, 2,
                                              frame, sizeof frame)
            : pick(3) == 0 ? grobo_frame_torque(grobo_wiring_protocol(rig_wiring), NECK_ID,
                                                (grobo_torque)pick(3), frame, sizeof frame)
                           : grobo_frame_goals(grobo_wiring_protocol(rig_wiring), &goal, 1, frame,
                                               sizeof frame);
    assert_true(n > 0);
    (void)grobo_robot_raw(&rig.robot, frame, (size_t)n);
}

static void play(void)
{
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT,
                                  .mode = pick(2) ? GROBO_PLAY_RATE : GROBO_PLAY_KEY,
                                  .rate_hz = (uint16_t)(10 + pick(50)),
                                  .repeat = 1 + (int32_t)pick(3),
                                  .mirror = pick(4) == 0,
                                  .speed_pct = (uint16_t)(50 + pick(200))};
    (void)grobo_robot_play(&rig.robot, &clip.clip, &options);
}

static void control(void)
{
    switch (pick(7)) {
    case 0:
        (void)grobo_robot_pause(&rig.robot);
        break;
    case 1:
        (void)grobo_robot_resume(&rig.robot);
        break;
    case 2:
        (void)grobo_robot_stop(&rig.robot, pick(2) == 0);
        break;
    case 3:
        (void)grobo_robot_seek(&rig.robot, (int64_t)pick(2500000));
        break;
    case 4:
        (void)grobo_robot_speed(&rig.robot, 20 + (int)pick(300));
        break;
    case 5:
        (void)grobo_robot_enqueue(&rig.robot, &other.clip, NULL);
        break;
    default:
        (void)grobo_robot_cancel(&rig.robot);
        break;
    }
}

static void request(void)
{
    static const uint8_t delay[1] = {2};
    grobo_register_io io = {R_ELBOW_ID, 7, 1, pick(2) ? delay : NULL};
    grobo_posture target = any_target();
    switch (pick(16)) {
    case 0:
    case 1:
    case 2:
        (void)grobo_robot_move(&rig.robot, &target);
        break;
    case 3:
    case 4:
        play();
        break;
    case 5:
        send_targets();
        break;
    case 6:
        send_raw();
        break;
    case 7:
        (void)grobo_robot_torque(&rig.robot, pick(2) ? rig_all(&rig) : GROBO_JOINT_BIT(pick(20)),
                                 (grobo_torque)pick(3));
        break;
    case 8:
        (void)grobo_robot_registers(&rig.robot, &io);
        break;
    case 9:
        (void)grobo_robot_free(&rig.robot, GROBO_JOINT_BIT(NECK), true);
        break;
    case 10:
        (void)grobo_robot_exit(&rig.robot, (grobo_exit_policy)pick(4));
        break;
    case 11:
        (void)grobo_robot_estop(&rig.robot);
        break;
    case 12:
        (void)grobo_robot_command(&rig.robot, NECK_ID, GROBO_SERVO_REBOOT);
        break;
    default:
        control();
        break;
    }
}

/* Requests come between the engine's own times: the host's clock has gone on since. */
static void live(uint32_t seed, int64_t epoch_us)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                 .sense_interval_us = (int64_t)(1 + seed % 3 * 150000)};
    grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .seed = 7, .start = GROBO_SIM_START_LIMP};
    random_state = seed * 2654435761u + 17;
    rig_epoch_us = epoch_us;
    rig_start(&rig, &config, &sim);
    rig_epoch_us = 1000000;
    rig_clip_init(&clip, sway, 4);
    rig_clip_init(&other, nod, 2);
    rig_power(&rig);
    for (int i = 0; i < 25; i++) {
        grobo_trip_info trip;
        rig.now_us += pick(4) * 777;
        request();
        if (pick(8) == 0) {
            rig_stall(&rig, (int64_t)pick(300000));
        }
        rig_run(&rig, (int64_t)pick(900000));
        grobo_robot_tripped(&rig.robot, &trip);
        if (trip.latched) {
            rig.now_us += 777;
            (void)grobo_robot_reset(&rig.robot);
        }
    }
}

static void expect_alike(int64_t later_us)
{
    assert_int_equal(rig.n_sent, first.n_sent);
    for (size_t i = 0; i < rig.n_sent; i++) {
        assert_true(rig.sent[i].at_us - first.sent[i].at_us == later_us);
        assert_int_equal(rig.sent[i].size, first.sent[i].size);
        assert_memory_equal(rig.sent[i].bytes, first.sent[i].bytes, rig.sent[i].size);
    }
    assert_int_equal(rig.n_events, first.n_events);
    for (size_t i = 0; i < rig.n_events; i++) {
        const grobo_event *a = &first.events[i];
        const grobo_event *b = &rig.events[i];
        assert_true(b->kind == a->kind && b->now_us - a->now_us == later_us);
        assert_true(a->kind != GROBO_EVENT_JOB ||
                    (b->u.job.number == a->u.job.number && b->u.job.result == a->u.job.result));
        assert_true(a->kind != GROBO_EVENT_TRIP || b->u.trip.at_us - a->u.trip.at_us == later_us);
    }
    assert_memory_equal(grobo_robot_get_counters(&rig.robot),
                        grobo_robot_get_counters(&first.robot), sizeof(grobo_robot_counters));
}

TEST_WITH(rig_wirings, the_engine_does_not_care_where_the_clock_begins)
{
    static const int64_t epochs_us[] = {77777777, INT64_C(86400000000) * 365};
    for (uint32_t seed = 0; seed < 6; seed++) {
        live(seed, 1);
        first = rig;
        live(seed, epochs_us[seed % 2]);
        expect_alike(epochs_us[seed % 2] - 1);
    }
}
