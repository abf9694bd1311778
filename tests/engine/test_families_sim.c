/* SPDX-License-Identifier: MIT */
/* The engine on simulated servos of each family: postures, a faulty line, an overload, stops. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/ics.h>
#include <grobo/core/robot.h>
#include <grobo/core/sim.h>

#include "src/robot/axis.h"
#include "src/robot/reading.h"
#include "src/robot/state.h"
#include "src/sim/servo/shaft.h"
#include "tests/support/family_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { JOINTS = FAMILY_JOINTS, MS = 1000, S = 1000000 };

static family_kit kit;

static const grobo_robot_config watched = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 50 * MS};

TEST_FOR(family, family_next, postures_are_played)
{
    family_start(&kit, row, &watched, NULL);
    assert_int_equal(family_move(&kit, 30, 1000), GROBO_OK);
    family_at(&kit, 30);
    kit.most_dps = 0;
    assert_int_equal(family_move(&kit, -40, 1500), GROBO_OK);
    family_at(&kit, -40);
    assert_true(kit.most_dps < 1.3 * 70 / 1.5);            /* straight in time */
    assert_int_equal(family_move(&kit, 60, 10), GROBO_OK); /* as fast as they can */
    family_run(&kit, 200 * MS);                            /* STS has ramps */
    family_at(&kit, 60);
    assert_int_equal(kit.n_trips, 0);
}

/* A line that loses and breaks bytes, and servos that do not hear: what was sent arrives all the
 * same, nothing kit.trips, and no servo goes faster than it may. */
TEST_FOR(family, family_next, a_faulty_line_moves_nothing_wrong)
{
    static const char faults[] = "drop=0.002,flip=0.002,silent=0.01,rubbish=0.02,split=0.05";
    grobo_robot_config config = watched;
    config.lost_replies = -1;
    family_start(&kit, row, &config, NULL);
    assert_int_equal(family_move(&kit, 0, 1000), GROBO_OK);
    assert_int_equal(grobo_sim_set_faults(&kit.sim, faults, strlen(faults)), 5);
    int arrived = 0;
    for (int k = 0; k < 20; k++) {
        int result = family_move(&kit, k % 2 == 0 ? 50 : -30, 800);
        arrived += result == GROBO_OK;
        family_run(&kit,
                   500 * MS); /* one that has a speed instead of a time is late for a lost frame */
        if (result == GROBO_OK) {
            family_at(&kit, k % 2 == 0 ? 50 : -30);
        }
    }
    assert_true(arrived >= 16);
    assert_int_equal(kit.n_trips, 0);
    assert_true(kit.robot.bus.stats.timeouts > 0 && kit.robot.bus.stats.retries > 0);
    assert_true(kit.robot.bus.stats.resync_bytes + kit.robot.bus.stats.late_bytes > 0);
}

TEST_FOR(family, family_next, an_emergency_stop_stops)
{
    family_start(&kit, row, &watched, NULL);
    assert_int_equal(family_move(&kit, 30, 1000), GROBO_OK);
    grobo_posture p = family_posture(&kit, -60, 3000);
    assert_true(grobo_robot_move(&kit.robot, &p) > 0);
    family_run(&kit, 1000 * MS);
    double before_deg = family_angle_deg(&kit, 0);
    assert_true(before_deg < 20 && before_deg > -30);
    assert_int_equal(family_wait(&kit, grobo_robot_estop(&kit.robot)), GROBO_OK);
    family_run(&kit, S);
    assert_true(fabs(family_angle_deg(&kit, 0) - before_deg) < 8);
    for (int j = 0; j < JOINTS; j++) {
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(&kit.sim, j, &view), GROBO_OK);
        assert_int_equal(view.torque, GROBO_TORQUE_ON);
        assert_false(view.moving);
    }
    assert_int_equal(grobo_robot_move(&kit.robot, &p), GROBO_ERR_LATCHED);
}

/* The program dies: an arm ends within a segment of its way. */
TEST_FOR(family, family_next, without_its_host_an_arm_stops)
{
    family_start(&kit, row, &watched, NULL);
    assert_int_equal(family_move(&kit, 40, 1000), GROBO_OK);
    grobo_posture p = family_posture(&kit, -50, 4000);
    assert_true(grobo_robot_move(&kit.robot, &p) > 0);
    family_run(&kit, 1000 * MS);
    double then_deg = family_angle_deg(&kit, 0);
    kit.now_us += 3 * (int64_t)S;
    grobo_sim_step(&kit.sim, kit.now_us);
    assert_true(then_deg - family_angle_deg(&kit, 0) < 90.0 * 450 / 4000);
}

TEST_FOR(family, family_next, heat_stops_for_safety)
{
    family_start(&kit, row, &watched, NULL);
    assert_int_equal(family_move(&kit, 20, 1000), GROBO_OK);
    assert_int_equal(grobo_sim_set_temperature(&kit.sim, 2, 68), GROBO_OK);
    family_run(&kit, 300 * MS);
    assert_true(kit.n_trips > 0);
    assert_true(kit.trips[0] == GROBO_TRIP_TEMPERATURE || kit.trips[0] == GROBO_TRIP_OVERHEATED);
}

/* Of some families a goal switches torque on: none leaves for a joint that was let go. */
TEST_FOR(family, family_next, a_limp_joint_is_not_sent_anywhere)
{
    family_start(&kit, row, &watched, NULL);
    assert_int_equal(family_move(&kit, 20, 1000), GROBO_OK);
    int number = grobo_robot_torque(&kit.robot, GROBO_JOINTS_ALL(JOINTS), GROBO_TORQUE_OFF);
    assert_int_equal(family_wait(&kit, number), GROBO_OK);
    grobo_posture p = family_posture(&kit, -40, 500);
    (void)grobo_robot_send(&kit.robot, &p);
    family_run(&kit, S);
    family_at(&kit, 20);
    grobo_target target = {.posture = family_posture(&kit, 10, 500)};
    for (int j = 0; j < JOINTS; j++) {
        target.joint_time_us[j] = S;
        target.from_rad[j] = target.posture.angle_rad[j] + 0.17;
    }
    for (int part = 0; part < 2; part++) { /* the second of KRS is the goal */
        grobo_exchange raw = {.frame_bytes = 0};
        if (kit.driver.posture(&kit.driver, NULL, &target, part, &raw) > 0) {
            (void)grobo_robot_raw(&kit.robot, raw.frame, raw.frame_bytes);
        }
        family_run(&kit, S);
    }
    family_at(&kit, 20);
}

/* Another program has sent a joint on its way, and its servo tells no speed: it is seen all the
 * same, and not sent elsewhere from a place where it is no more. */
TEST_FOR(family, family_next, a_joint_that_another_moves_is_not_sent_anywhere)
{
    static const grobo_robot_config quiet = {GROBO_ROBOT_CONFIG_INIT,
                                             .sense_interval_us = GROBO_SENSE_NEVER};
    family_start(&kit, row, &quiet, NULL);
    for (int on = 1; on >= 0; on--) {
        grobo_target target = {.posture = family_posture(&kit, 80, 3000)};
        for (int j = 0; j < JOINTS; j++) {
            target.joint_time_us[j] = 3 * (int64_t)S;
        }
        grobo_exchange sent;
        for (int part = 0;; part++) {
            memset(&sent, 0, sizeof sent);
            int more = on ? kit.driver.torque(&kit.driver, NULL, GROBO_JOINTS_ALL(JOINTS),
                                              GROBO_TORQUE_ON, part, &sent)
                          : kit.driver.posture(&kit.driver, NULL, &target, part, &sent);
            if (more <= 0) {
                break;
            }
            assert_int_equal(grobo_sim_rx(&kit.sim, sent.frame, sent.frame_bytes, kit.now_us),
                             sent.frame_bytes);
            kit.now_us += 50 * MS;
            uint8_t b[GROBO_FRAME_MAX_BYTES];
            grobo_sim_step(&kit.sim, kit.now_us);
            while (grobo_sim_tx(&kit.sim, b, sizeof b, kit.now_us) > 0) {
            }
        }
    }
    grobo_posture p = family_posture(&kit, -60, 1000);
    int number = grobo_robot_move(&kit.robot, &p);
    int result = number < 0 ? number : family_wait(&kit, number);
    if (result != GROBO_ERR_STATE) {
        fail_msg("%s: %s", row->name, grobo_error_name(result));
    }
}

TEST(a_drive_mode_without_time_is_refused)
{
    family_start(&kit, family_named("dxl2"), &watched, NULL);
    family_set_up(&kit, 2, GROBO_ROLE_DIRECTION, 0);
    assert_int_equal(family_move(&kit, 20, 1000), GROBO_ERR_SETUP);
    assert_true(fabs(family_angle_deg(&kit, 0)) < 0.2);
}

/* What its angles mean is not known; its torque is. */
TEST(a_servo_set_up_otherwise_is_made_limp)
{
    /* What P and PRO keep lies far before their torque, LX and KRS tell one value a frame. */
    static const family rows[] = {
        {"dxl2", &grobo_i_dxl2_table, "XM430-W350", grobo_dxl2_driver_init, 0.5, 1000000, false},
        {"p", &grobo_i_dxl2_table, "PH54-200-S500-R", grobo_dxl2_driver_init, 0.5, 1000000, false},
        {"pro", &grobo_i_dxl2_table, "H54-200-S500-R", grobo_dxl2_driver_init, 0.5, 1000000, false},
        {"dxl1", &grobo_i_dxl1_table, "AX-12A", grobo_dxl1_driver_init, 1, 1000000, false},
        {"sts", &grobo_i_sts_table, "STS3215", grobo_feetech_driver_init, 0.5, 1000000, false},
        {"scs", &grobo_i_scs_table, "SCS0009", grobo_feetech_driver_init, 1, 1000000, false},
        {"lx16a", &grobo_i_lx16a_table, "LX-16A", grobo_lx16a_driver_init, 0.5, 115200, true},
        {"ics", &grobo_i_ics_table, "KRS-3301", grobo_ics_driver_init, 0.5, 115200, true},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        grobo_sim_view view;
        family_start(&kit, &rows[i], &watched, NULL);
        family_set_up(&kit, 2, GROBO_ROLE_MAX_POSITION, kit.servos[2]->middle);
        family_set_up(&kit, 2, GROBO_ROLE_TORQUE, 1);
        assert_int_equal(grobo_sim_look(&kit.sim, 2, &view), GROBO_OK);
        assert_int_equal(view.torque, GROBO_TORQUE_ON);
        assert_int_equal(
            family_wait(&kit, grobo_robot_torque(&kit.robot, GROBO_JOINT_BIT(2), GROBO_TORQUE_OFF)),
            GROBO_OK);
        assert_int_equal(grobo_sim_look(&kit.sim, 2, &view), GROBO_OK);
        assert_int_equal(view.torque, GROBO_TORQUE_OFF);
        assert_true(family_wait(&kit, grobo_robot_torque(&kit.robot, GROBO_JOINT_BIT(2),
                                                         GROBO_TORQUE_ON)) < 0);
        assert_true(family_move(&kit, 20, 1000) < 0);
        assert_int_equal(grobo_sim_look(&kit.sim, 2, &view), GROBO_OK);
        assert_int_equal(view.torque, GROBO_TORQUE_OFF);
    }
}

/* With a brake or without: a hand that overcomes a servo in free mode takes the joint along, and
 * the joint stays where it was left. KRS servos do not tell their goal: they hold on. */
TEST_FOR(family, family_next, a_hand_moves_a_free_joint)
{
    if (row->table == &grobo_i_ics_table) {
        return;
    }
    family_start(&kit, row, &watched, NULL);
    assert_int_equal(family_move(&kit, 0, 1000), GROBO_OK);
    assert_int_equal(grobo_robot_free(&kit.robot, 0xF, true), GROBO_OK);
    family_run(&kit, 500 * MS);
    for (int deg = 20; deg <= 60; deg += 20) {
        assert_int_equal(grobo_sim_set_angle(&kit.sim, 0, 1000 * deg, 300 * MS), GROBO_OK);
        family_run(&kit, S);
        double off_deg = fabs(family_angle_deg(&kit, 0) - deg);
        if (off_deg > 4) {
            fail_msg("%s: left at %d, stands at %.1f deg", row->name, deg,
                     family_angle_deg(&kit, 0));
        }
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(&kit.sim, 0, &view), GROBO_OK);
        assert_int_equal(view.torque, GROBO_TORQUE_ON);
    }
}

static int woken;

static void count_woken(family_kit *k, const grobo_sim_event *event)
{
    (void)k;
    woken += event->kind == GROBO_SIM_TORQUE && event->value == GROBO_TORQUE_ON;
}

/* The supply dips, and the arm sinks while its servos restart. */
static void dip(void)
{
    woken = 0;
    kit.on_sim = count_woken;
    grobo_sim_set_supply(&kit.sim, GROBO_SIM_BROWN_OUT_MV - 500);
    family_run(&kit, 20 * MS);
    grobo_sim_set_supply(&kit.sim, kit.servos[0]->voltage_mv);
    for (int j = 0; j < JOINTS; j++) {
        assert_int_equal(grobo_sim_set_angle(&kit.sim, j, 0, 300 * MS), GROBO_OK);
    }
}

/* What sank stays where it is, in every family: also where the next goal would switch the torque
 * on, whoever sends it, and however seldom joints are read. */
TEST_FOR(family, family_next, nothing_is_woken_after_a_dip)
{
    enum { MOVE, STREAM, STOP, WAYS };
    static const int64_t intervals_us[] = {50 * MS, 500 * MS, GROBO_SENSE_NEVER};
    for (int run = 0; run < WAYS * 3 * 2; run++) {
        int way = run % WAYS;
        const grobo_robot_config config = {
            GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = intervals_us[run / WAYS % 3],
            .goals = run < WAYS * 3 ? GROBO_GOALS_SEGMENTS : GROBO_GOALS_WHOLE};
        family_start(&kit, row, &config, NULL);
        assert_int_equal(family_move(&kit, 60, 1000), GROBO_OK);
        grobo_posture p = family_posture(&kit, -60, 5000);
        assert_true(grobo_robot_move(&kit.robot, &p) > 0);
        family_run(&kit, S);
        dip();
        for (int i = 0; i < 150; i++) {
            family_run(&kit, 20 * MS);
            p = family_posture(&kit, 10 - 0.3 * i, 20);
            (void)(way == STREAM ? grobo_robot_send(&kit.robot, &p)
                   : way == STOP ? grobo_robot_stop(&kit.robot, true)
                                 : 0);
        }
        if (woken > 0) {
            fail_msg("%s: %d servos are woken, run %d", row->name, woken, run);
        }
    }
}

/* A reply that is lost is no dip: the arm goes on. */
TEST_FOR(family, family_next, a_lost_reply_ends_no_way)
{
    family_start(&kit, row, &watched, NULL);
    assert_int_equal(family_move(&kit, 60, 1000), GROBO_OK);
    grobo_posture p = family_posture(&kit, -60, 2000);
    int number = grobo_robot_move(&kit.robot, &p);
    family_run(&kit, 500 * MS);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, 1, GROBO_SIM_CABLE_MUTE), GROBO_OK);
    family_run(&kit, 70 * MS);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, 1, GROBO_SIM_CABLE_IN), GROBO_OK);
    assert_int_equal(family_wait(&kit, number), GROBO_OK);
    family_run(&kit, 200 * MS);
    family_at(&kit, -60);
}

/* How far the first joint goes on behind a stop so many milliseconds into a fast move, and how far
 * back again. */
static void stop_at(const family *f, int ms, uint32_t supply_pct, double *on_deg, double *back_deg)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 50 * MS,
                                       .voltage_mv = -1};
    family_start(&kit, f, &config, NULL);
    assert_int_equal(family_move(&kit, 85, 1000), GROBO_OK);
    grobo_sim_set_supply(&kit.sim, kit.servos[0]->voltage_mv * supply_pct / 100);
    grobo_posture p = family_posture(&kit, -60, 10);
    assert_true(grobo_robot_move(&kit.robot, &p) > 0);
    family_run(&kit, ms * MS);
    (void)grobo_robot_stop(&kit.robot, true); /* the fastest are there */
    double then_deg = family_angle_deg(&kit, 0), last_deg = then_deg;
    *back_deg = 0;
    for (int i = 0; i < 120; i++) {
        family_run(&kit, 5 * MS);
        *back_deg = fmax(*back_deg, family_angle_deg(&kit, 0) - last_deg);
        last_deg = fmin(family_angle_deg(&kit, 0), last_deg);
    }
    *on_deg = then_deg - last_deg;
}

/* A weak supply: joints fall back behind ways that they cannot go. They stop where they are, and
 * not where the way is by then; nor is one thrown back that keeps up, or begins softly. */
TEST_FOR(family, family_next, a_weak_joint_stops_where_it_is)
{
    static const struct {
        const char *name;
        double on_deg; /* 50 ms at the speed, and what it takes to get there */
    } rows[] = {{"dxl2", 16}, {"sts", 22}, {"dxl1", 19}, {"lx16a", 20}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        for (int ms = 350; ms <= 450 && strcmp(row->name, rows[i].name) == 0; ms += 10) {
            double on_deg, back_deg;
            stop_at(row, ms, 66, &on_deg, &back_deg);
            if (on_deg > rows[i].on_deg || back_deg > 2) {
                fail_msg("%s at %d ms: %.1f deg on, %.1f back", rows[i].name, ms, on_deg, back_deg);
            }
        }
    }
    for (int ms = 50; ms <= 800; ms += 30) {
        double on_deg, back_deg;
        stop_at(row, ms, 100, &on_deg, &back_deg);
        if (back_deg > 0.2) {
            fail_msg("%s at %d ms: %.1f deg back", row->name, ms, back_deg);
        }
    }
}

/* A stop is asked for, and latched at once: what was to stop does, also a servo that may just have
 * restarted, and whose halt has to wait for that. */
TEST_FOR(family, family_next, a_latch_lets_a_stop_leave_that_waits)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 50 * MS,
                                       .goals = GROBO_GOALS_WHOLE, .lost_replies = -1};
    for (int silent = 0; silent < 2; silent++) {
        family_start(&kit, row, &config, NULL);
        assert_int_equal(family_move(&kit, 60, 1000), GROBO_OK);
        grobo_posture p = family_posture(&kit, -60, 8000);
        assert_true(grobo_robot_move(&kit.robot, &p) > 0);
        family_run(&kit, S);
        for (int j = 0; silent && j < JOINTS; j++) {
            assert_int_equal(grobo_sim_set_cable(&kit.sim, j, GROBO_SIM_CABLE_MUTE), GROBO_OK);
        }
        family_run(&kit, 500 * MS);
        double then_deg = family_angle_deg(&kit, 0);
        assert_int_equal(grobo_robot_stop(&kit.robot, true), GROBO_OK);
        assert_int_equal(grobo_robot_latch(&kit.robot), GROBO_OK);
        for (int j = 0; j < JOINTS; j++) {
            assert_int_equal(grobo_sim_set_cable(&kit.sim, j, GROBO_SIM_CABLE_IN), GROBO_OK);
        }
        family_run(&kit, 5 * (int64_t)S);
        if (fabs(family_angle_deg(&kit, 0) - then_deg) > (silent ? 12 : 4)) {
            fail_msg("%s%s: stopped at %.1f deg, stands at %.1f", row->name,
                     silent ? ", silent" : "", then_deg, family_angle_deg(&kit, 0));
        }
    }
}

/* A host that was away has heard no servo meanwhile: that is no servo's fault, and nothing is
 * latched. */
TEST_FOR(family, family_next, a_stalled_host_blames_no_servo)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 50 * MS,
                                       .goals = GROBO_GOALS_SEGMENTS};
    for (int k = 0; k < 10; k++) {
        family_start(&kit, row, &config, NULL);
        assert_int_equal(family_move(&kit, 60, 1000), GROBO_OK);
        grobo_posture p = family_posture(&kit, -60, 8000);
        assert_true(grobo_robot_move(&kit.robot, &p) > 0);
        family_run(&kit, S + k * 7 * MS);
        kit.now_us += S;
        family_run(&kit, 100 * MS);
        if (kit.n_trips != 1 || kit.trips[0] != GROBO_TRIP_HOST_STALL) {
            fail_msg("%s, %d: %u trips, %s", row->name, k, kit.n_trips,
                     grobo_trip_name(kit.trips[0]));
        }
    }
}

/* Servos that are told a speed and no time come to rest as soon as others, also where they were
 * read to be behind the way that they were sent on: at a speed for the way that is left. */
TEST(a_joint_that_is_behind_stops_in_time)
{
    static const char *const told_speeds[] = {"sts", "dxl1"}; /* the first has ramps */
    for (int i = 0; i < 2; i++) {
        family_start(&kit, family_named(told_speeds[i]), &watched, NULL);
        assert_int_equal(family_move(&kit, 60, 1000), GROBO_OK);
        grobo_posture p = family_posture(&kit, -60, 6000);
        assert_true(grobo_robot_move(&kit.robot, &p) > 0);
        family_run(&kit, 1500 * MS);
        kit.most_dps = 0;
        family_run(&kit, 100 * MS);
        assert_true(kit.most_dps > 15 && kit.most_dps < 30);
        for (int j = 0; j < JOINTS; j++) {
            kit.robot.axes[j].state.angle_rad += 0.1;
        }
        assert_int_equal(grobo_robot_stop(&kit.robot, true), GROBO_OK);
        family_run(&kit, 50 * MS);
        assert_true(kit.most_dps > (i == 0 ? 24 : 55) && kit.most_dps < 70);
    }
}

typedef enum how_to_stop { STOP, EMERGENCY, LEAVE, LEAVE_AFTER_ANOTHER, HEAT, HOWS } how_to_stop;

/* A joint turns at full speed, may be sent the other way, and is stopped so long behind
 * that. */
typedef struct turn_back {
    bool turned;
    how_to_stop how;
    int joint, ms; /* the second joint is mounted the other way round */
    int64_t interval_us;
    double dps;      /* how fast it turned when it was stopped */
    double on_deg;   /* further than it needs to brake */
    double back_deg; /* less than that */
    double done_deg; /* how far it goes on once the stop is done */
} turn_back;

static double at_deg(int joint)
{
    grobo_sim_step(&kit.sim, kit.now_us);
    return family_angle_deg(&kit, joint);
}

static void send_fast(double deg, int ms)
{
    grobo_posture p = family_posture(&kit, deg, 10);
    assert_int_equal(grobo_robot_send(&kit.robot, &p), GROBO_OK);
    family_run(&kit, ms * MS);
}

/* What has to wait for a reading is over before: when it was, counts. */
static void begin_to_stop(const grobo_robot_config *config, how_to_stop how)
{
    if (how == LEAVE_AFTER_ANOTHER) {
        assert_int_equal(grobo_robot_init(&kit.robot, &kit.driver, NULL, config, kit.now_us),
                         GROBO_OK);
        family_listen(&kit);
    } else if (how == HEAT) {
        assert_int_equal(grobo_sim_set_temperature(&kit.sim, 0, 75), GROBO_OK);
        for (int i = 0; i < 1000 && kit.n_trips == 0; i++) {
            family_run(&kit, MS);
        }
        assert_true(kit.n_trips > 0);
    }
}

static void stop_now(how_to_stop how)
{
    if (how == EMERGENCY) {
        assert_int_equal(family_wait(&kit, grobo_robot_estop(&kit.robot)), GROBO_OK);
    } else if (how == LEAVE || how == LEAVE_AFTER_ANOTHER) {
        int number = grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
        assert_int_equal(family_wait(&kit, number), GROBO_OK);
    } else if (how == STOP) {
        (void)grobo_robot_stop(&kit.robot, true); /* the fastest are there */
    }
}

#define TURNS 6 /* of each way to stop: instants, joints, rates of readings */

static void stop_turning(const family *f, turn_back *t)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                       .bus = {.baud_bps = f->baud_bps, .echo = f->echo},
                                       .sense_interval_us = t->interval_us};
    family_start(&kit, f, &config, NULL);
    assert_int_equal(family_move(&kit, 85, 2000), GROBO_OK);
    send_fast(-60, t->turned ? 250 : t->ms);
    if (t->turned) {
        send_fast(80, t->ms);
    }
    begin_to_stop(&config, t->how);
    double then_deg = at_deg(t->joint), low_deg = then_deg, high_deg = then_deg;
    const grobo_sim_servo *servo = &kit.sim.servo[t->joint];
    double v = kit.joints[t->joint].sign * grobo_i_sim_speed_mdeg_s(servo, kit.now_us) / 1000;
    double a = servo->plant.accel_mdeg_s2 / 1000.0;
    stop_now(t->how);
    double done_deg = at_deg(t->joint);
    for (int i = 0; i < 200; i++) {
        family_run(&kit, 5 * MS);
        low_deg = fmin(low_deg, at_deg(t->joint));
        high_deg = fmax(high_deg, at_deg(t->joint));
    }
    double brake_deg = a > 0 ? v * fabs(v) / 2 / a : 0;
    double on_deg = (at_deg(t->joint) - then_deg - brake_deg) * (v < 0 ? -1 : 1);
    t->dps = t->how == HEAT ? kit.servos[0]->speed_dps : fabs(v); /* it brakes already */
    t->on_deg = fmax(on_deg, 0);
    t->back_deg = fmax(-on_deg, v < 0 ? at_deg(t->joint) - low_deg : high_deg - at_deg(t->joint));
    t->done_deg = fabs(at_deg(t->joint) - done_deg);
}

/* A servo with ramps is far behind its way when it was sent back at full speed, and turns the other
 * way at first. It is not sent on to where its way is, nor pulled back, whatever stops it; and who
 * waits for the stop is told that it is done when it stands. Of what another program has sent, who
 * leaves has to find out first that it moves. */
TEST_FOR(family, family_next, a_joint_that_turns_back_stops_where_it_is)
{
    bool ramps = strcmp(row->name, "sts") == 0;
    for (int i = 0; i < TURNS * (int)HOWS; i++) {
        turn_back t = {.turned = i % 2 != 0,
                       .how = (how_to_stop)(i / TURNS),
                       .joint = i / 2 % 2,
                       .ms = 16 + 143 * (i % TURNS / 2),
                       .interval_us = i / 4 % 2 != 0 ? 50 * MS : 150 * MS};
        stop_turning(row, &t);
        bool others = t.how == LEAVE_AFTER_ANOTHER;
        double time_s = !others ? 0.055 : kit.driver.tells_no_speed ? 0.2 : 0.08;
        double most_deg = ramps ? (others ? 8 : 4) : time_s * t.dps;
        bool waits = t.how != STOP && t.how != HEAT;
        if (t.on_deg > most_deg || t.back_deg > 0.5 || (waits && t.done_deg > 0.5)) {
            fail_msg("%s, stop %d, at %d ms: %.0f deg/s, %.1f deg on, %.1f back, %.1f done",
                     row->name, t.how, t.ms, t.dps, t.on_deg, t.back_deg, t.done_deg);
        }
    }
}

/* Where it turns, a servo with ramps stands for a moment, far beside its trajectory; it has lost no
 * frame. */
TEST(a_joint_read_while_it_turns_back_is_not_astray)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 5 * MS};
    int slow = 0;
    for (int ms = 100; ms <= 250; ms += 50) {
        family_start(&kit, family_named("sts"), &config, NULL);
        assert_int_equal(family_move(&kit, 85, 2000), GROBO_OK);
        send_fast(-60, ms);
        send_fast(80, 0);
        for (int i = 0; i < 250; i++) {
            family_run(&kit, MS);
            const grobo_robot_axis *axis = &kit.robot.axes[0];
            double begun_rad = axis->trajectory.from_rad, off_rad = GROBO_I_OFF_TRAJECTORY_RAD;
            slow += abs(axis->seen_dps) < GROBO_I_SLOW_DPS && axis->seen_us > axis->told_us &&
                    fabs(axis->seen_rad - begun_rad) <= off_rad;
            assert_false(grobo_i_is_stray(axis));
        }
    }
    printf("%d slow\n", slow);
    assert_true(slow > 0);
}

/* It is too weak for its way, behind whose end it turns yet: it was read to, and then for its angle
 * alone. */
TEST(a_stop_reaches_a_joint_read_for_its_angle_alone)
{
    static const char *const names[] = {"sts", "dxl1", "dxl2"};
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .goals = GROBO_GOALS_WHOLE,
                                       .sense_interval_us = GROBO_SENSE_NEVER, .voltage_mv = -1};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        family_start(&kit, family_named(names[i]), &config, NULL);
        assert_int_equal(family_move(&kit, 85, 2000), GROBO_OK);
        grobo_sim_set_supply(&kit.sim, kit.servos[0]->voltage_mv * 66u / 100);
        grobo_posture p = family_posture(&kit, -85, 10);
        p.set = GROBO_JOINT_BIT(0);
        assert_int_equal(grobo_robot_send(&kit.robot, &p), GROBO_OK);
        family_run(&kit, 20 * MS);
        while (kit.robot.axes[0].trajectory.to_us > kit.now_us) {
            family_run(&kit, 5 * MS);
        }
        for (int kind = 0; kind < 2; kind++) {
            grobo_sense_kind what = kind == 0 ? GROBO_SENSE_FULL : GROBO_SENSE_POSITION;
            int number = grobo_robot_sense(&kit.robot, p.set, what);
            assert_int_equal(family_wait(&kit, number), GROBO_OK);
        }
        assert_int_equal(grobo_robot_stop(&kit.robot, true), GROBO_OK);
        for (int k = 0; k < 8; k++) {
            family_run(&kit, 50 * MS);
        }
        double here_deg = family_angle_deg(&kit, 0);
        family_run(&kit, 2 * (int64_t)S);
        family_run(&kit, MS);
        assert_true(here_deg > -80 && fabs(family_angle_deg(&kit, 0) - here_deg) < 0.5);
    }
}

/* Those of servos that are told their acceleration with each goal: MX have such a register too far
 * away from the goal, and DYNAMIXEL X one that is a time. */
/* The longest interval that there is means hardly ever, and not as fast as the wire allows. */
TEST_FOR(family, family_next, a_very_long_interval_reads_once)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                       .sense_interval_us = GROBO_NEVER_US};
    family_start(&kit, row, &config, NULL);
    family_run(&kit, 3 * (int64_t)S);
    assert_in_range(kit.n_sent, 1, 16);
    assert_int_equal(family_move(&kit, 10, 500), GROBO_OK);
}

TEST(a_driver_tells_the_ramps_of_its_servos)
{
    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        double told_dps2 = strcmp(f->name, "sts") == 0 ? 254 * 8.79 : 0;
        family_start(&kit, f, &watched, NULL);
        assert_true(fabs(kit.driver.accel_rad_s2 / grobo_rad_from_deg(1) - told_dps2) < 0.01);
    }
    family_start(&kit, family_named("dxl1"), &watched, NULL);
    grobo_driver mx = GROBO_TABLE_INIT(grobo_driver);
    for (int j = 0; j < JOINTS; j++) {
        kit.joints[j].servo_model = grobo_servo_model_named(&grobo_i_dxl1_table, "MX-28")->number;
    }
    assert_int_equal(grobo_dxl1_driver_init(&mx, &kit.model), GROBO_OK);
    assert_true(mx.accel_rad_s2 == 0);
    family_start(&kit, family_named("sts"), &watched, NULL);
    for (int j = 0; j < JOINTS; j++) {
        kit.joints[j].gear = 0.5;
    }
    assert_int_equal(grobo_feetech_driver_init(&kit.driver, &kit.model), GROBO_OK);
    assert_true(fabs(kit.driver.accel_rad_s2 / grobo_rad_from_deg(1) - 508 * 8.79) < 0.01);
    kit.joints[2].servo_model = grobo_servo_model_named(&grobo_i_scs_table, "SCS0009")->number;
    assert_int_equal(grobo_feetech_driver_init(&kit.driver, &kit.model), GROBO_OK);
    assert_true(kit.driver.accel_rad_s2 == 0);
}
