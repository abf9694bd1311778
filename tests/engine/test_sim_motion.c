/* SPDX-License-Identifier: MIT */
/* Shafts: moves at servo speed and over the goal time, torque, currents, temperatures, hands. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/sim.h>

#include "tests/support/simkit.h"
#include "tests/support/test.h"

static simkit kit;

/* R_SHOULDER_P, motor 3, RS302CD, +-150 deg, at 20 deg; R_HIP_P, motor 10, RS301CR, at 20 deg. */
enum { SHOULDER = 14, R_HIP_P = 2 };

static void start_with_torque(const grobo_sim_config *config)
{
    simkit_start(&kit, config);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    simkit_forget(&kit);
}

static int32_t angle(int servo)
{
    return simkit_look(&kit, servo).angle_mdeg;
}

/* ---- moves --------------------------------------------------------------------------------- */

TEST(a_goal_time_is_kept)
{
    start_with_torque(NULL);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 84 03 64 00", 0);
    int64_t t0 = kit.now_us;
    assert_int_equal(angle(SHOULDER), 20000);
    simkit_run(&kit, 250000);
    assert_int_equal(angle(SHOULDER), 37500);
    assert_int_equal(simkit_look(&kit, SHOULDER).speed_dps, 70);
    assert_true(simkit_look(&kit, SHOULDER).moving);
    simkit_run(&kit, 250000);
    assert_int_equal(angle(SHOULDER), 55000);
    simkit_packet(&kit, "FA AF 03 0F 2A 06 00", 14);
    assert_int_equal(simkit_i16(&kit, 9), (kit.got_us[0] - t0) / 10000);
    assert_int_equal(simkit_i16(&kit, 11), 70);
    simkit_run(&kit, 500000);
    assert_int_equal(angle(SHOULDER), 90000);
    assert_false(simkit_look(&kit, SHOULDER).moving);
    simkit_packet(&kit, "FA AF 03 0F 2A 06 00", 14);
    assert_int_equal(simkit_i16(&kit, 7), 900);
    assert_int_equal(simkit_i16(&kit, 9), 100);
    assert_int_equal(simkit_i16(&kit, 11), 0);
}

/* 60 degrees take 0.16 s (RS302CD), 0.11 s (RS301CR), less at a higher voltage. */
TEST(full_speed_is_that_of_the_servo)
{
    const grobo_sim_config fresh = {GROBO_SIM_CONFIG_INIT, .supply_mv = 8140};
    start_with_torque(NULL);
    simkit_packet(&kit, "FA AF 00 00 1E 05 02 03 20 03 00 00 0A 20 03 00 00", 0);
    simkit_run(&kit, 80000);
    assert_in_range(angle(SHOULDER), 49999, 50001);
    assert_in_range(simkit_look(&kit, SHOULDER).speed_dps, 374, 376);
    simkit_run(&kit, 30000);
    assert_int_equal(angle(R_HIP_P), 80000);
    assert_int_not_equal(angle(SHOULDER), 80000);
    simkit_run(&kit, 50001);
    assert_int_equal(angle(SHOULDER), 80000);

    start_with_torque(&fresh);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 20 03 00 00", 0);
    simkit_run(&kit, 160000 * 10 / 11 / 2);
    assert_in_range(angle(SHOULDER), 49990, 50010);
}

TEST(too_short_a_time_is_full_speed)
{
    start_with_torque(NULL);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 20 03 01 00", 0);
    simkit_run(&kit, 80000);
    assert_in_range(angle(SHOULDER), 49999, 50001);
}

TEST(a_new_goal_starts_where_the_shaft_is)
{
    start_with_torque(NULL);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 84 03 64 00", 0);
    simkit_run(&kit, 500000);
    int32_t before = angle(SHOULDER);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 00 00 64 00", 0);
    assert_in_range(angle(SHOULDER), before, before + 300);
    simkit_run(&kit, 500000);
    assert_in_range(angle(SHOULDER), before / 2, before / 2 + 200);
    simkit_run(&kit, 500000);
    assert_int_equal(angle(SHOULDER), 0);
}

TEST(a_goal_without_a_time_takes_the_last_one)
{
    start_with_torque(NULL);
    simkit_packet(&kit, "FA AF 03 00 20 02 01 C8 00", 0);
    assert_false(simkit_look(&kit, SHOULDER).moving);
    simkit_packet(&kit, "FA AF 03 00 1E 02 01 90 01", 0);
    simkit_run(&kit, 1000000);
    assert_int_equal(angle(SHOULDER), 30000);
}

TEST(time_may_jump_by_hours)
{
    start_with_torque(NULL);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 84 03 FF 3F", 0);
    kit.now_us += 81915000;
    assert_int_equal(angle(SHOULDER), 55000);
    kit.now_us += 7200LL * 1000000;
    assert_int_equal(angle(SHOULDER), 90000);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_TIME), 16383);
    assert_true(grobo_sim_deadline(&kit.sim) == GROBO_NEVER_US);
}

/* Neither torque nor a hand is a move: the time of the last one stays. */
TEST(the_present_time_is_that_of_moves_alone)
{
    simkit_start(&kit, NULL);
    simkit_run(&kit, 5000000);
    simkit_packet(&kit, "FA AF 03 00 24 01 01 01", 0);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_TIME), 0);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 84 03 64 00", 0);
    simkit_run(&kit, 3000000);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_TIME), 100);
    simkit_packet(&kit, "FA AF 03 00 24 01 01 00", 0);
    simkit_run(&kit, 1000000);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_TIME), 100);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, SHOULDER, 50000, 500000), 0);
    simkit_run(&kit, 1000000);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_TIME), 100);
    simkit_packet(&kit, "FA AF 03 00 24 01 01 01", 0);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_TIME), 100);
}

TEST(mechanical_stops_stall)
{
    start_with_torque(NULL);
    simkit_packet(&kit, "FA AF 0A 00 1E 02 01 DC 05", 0);
    simkit_run(&kit, 1000000);
    grobo_sim_view view = simkit_look(&kit, R_HIP_P);
    assert_int_equal(view.angle_mdeg, 120000);
    assert_true(view.stalled);
    assert_int_equal(view.current_ma, 1200);
    simkit_packet(&kit, "FA AF 0A 00 23 01 01 32", 0);
    assert_int_equal(simkit_look(&kit, R_HIP_P).current_ma, 600);
    simkit_packet(&kit, "FA AF 0A 00 1E 02 01 00 00", 0);
    simkit_run(&kit, 1000000);
    assert_false(simkit_look(&kit, R_HIP_P).stalled);
}

/*
 * The servo aims at the goal, and its speed is that of the way to the goal: 20 to 150 degrees in
 * 2 s passes the stop at 120 after 100/130 of the time. From there the motor stalls, and the time
 * of the move runs on to its end.
 */
TEST(a_stop_is_met_at_the_speed_of_the_way_to_the_goal)
{
    start_with_torque(NULL);
    simkit_packet(&kit, "FA AF 0A 00 1E 04 01 DC 05 C8 00", 0);
    simkit_run(&kit, 1000000);
    assert_in_range(angle(R_HIP_P), 84999, 85001);
    assert_int_equal(simkit_look(&kit, R_HIP_P).speed_dps, 65);
    simkit_run(&kit, 538000);
    assert_in_range(angle(R_HIP_P), 119900, 119999);
    assert_true(simkit_look(&kit, R_HIP_P).moving);
    assert_false(simkit_look(&kit, R_HIP_P).stalled);
    simkit_run(&kit, 1000);
    grobo_sim_view view = simkit_look(&kit, R_HIP_P);
    assert_int_equal(view.angle_mdeg, 120000);
    assert_int_equal(view.target_mdeg, 120000);
    assert_int_equal(view.speed_dps, 0);
    assert_false(view.moving);
    assert_true(view.stalled);
    assert_int_equal(view.current_ma, 1200);
    assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_TIME), 153);
    simkit_run(&kit, 261000);
    assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_TIME), 180);
    simkit_run(&kit, 1000000);
    assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_TIME), 200);
}

/* Where nothing can move, from the first moment on, the time of the move runs as well. */
TEST(time_runs_at_a_stop_and_while_blocked)
{
    simkit_start(&kit, NULL);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, R_HIP_P, 120000, 0), 0);
    assert_int_equal(grobo_sim_set_blocked(&kit.sim, SHOULDER, true), 0);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    simkit_packet(&kit, "FA AF 00 00 1E 05 02 0A DC 05 64 00 03 00 00 64 00", 0);
    for (int i = 0; i < 2; i++) {
        int servo = i == 0 ? R_HIP_P : SHOULDER;
        assert_true(simkit_look(&kit, servo).stalled);
        assert_int_equal(simkit_look(&kit, servo).current_ma, i == 0 ? 1200 : 693);
        assert_int_equal(simkit_register(&kit, servo, GROBO_RS30X_TIME), 0);
    }
    simkit_run(&kit, 400000);
    assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_TIME), 40);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_TIME), 40);
    /* Free again, the servo makes up for the way in the time that is left. */
    assert_int_equal(grobo_sim_set_blocked(&kit.sim, SHOULDER, false), 0);
    simkit_run(&kit, 300000);
    assert_in_range(angle(SHOULDER), 9999, 10001);
    simkit_run(&kit, 2000000);
    assert_int_equal(angle(SHOULDER), 0);
    assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_TIME), 100);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_TIME), 100);
}

/* Without stops a servo goes wherever its limit registers let it. */
TEST(without_stops_a_servo_goes_to_its_limits)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .no_stops = true};
    start_with_torque(&config);
    assert_int_equal(angle(R_HIP_P), 20000);
    simkit_packet(&kit, "FA AF 0A 00 1E 02 01 DC 05", 0);
    simkit_run(&kit, 1000000);
    assert_int_equal(angle(R_HIP_P), 150000);
    assert_false(simkit_look(&kit, R_HIP_P).stalled);
    simkit_packet(&kit, "FA AF 0A 00 24 01 01 00", 0);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, R_HIP_P, 400000, 0), 0);
    assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_POSITION), 4000);
}

/* ---- torque -------------------------------------------------------------------------------- */

TEST(torque_on_holds_the_present_position)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 84 03 64 00", 0);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_GOAL), 900);
    simkit_run(&kit, 1000000);
    assert_int_equal(angle(SHOULDER), 20000);
    simkit_packet(&kit, "FA AF 03 00 24 01 01 01", 0);
    simkit_run(&kit, 1000000);
    assert_int_equal(angle(SHOULDER), 20000);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_GOAL), 200);
}

TEST(torque_on_may_jump_by_configuration)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .jump_on_torque = true};
    simkit_start(&kit, &config);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 84 03 64 00", 0);
    simkit_packet(&kit, "FA AF 03 00 24 01 01 01", 0);
    simkit_run(&kit, 200000);
    assert_int_equal(angle(SHOULDER), 90000);
}

TEST(off_and_brake_stop_a_move)
{
    static const char *const stops[] = {"FA AF 03 00 24 01 01 00", "FA AF 03 00 24 01 01 02"};
    for (int i = 0; i < 2; i++) {
        start_with_torque(NULL);
        simkit_packet(&kit, "FA AF 03 00 1E 04 01 84 03 64 00", 0);
        simkit_run(&kit, 500000);
        simkit_packet(&kit, stops[i], 0);
        int32_t there = angle(SHOULDER);
        assert_in_range(there, 55000, 55300);
        simkit_run(&kit, 1000000);
        assert_int_equal(angle(SHOULDER), there);
        assert_int_equal(simkit_look(&kit, SHOULDER).current_ma, 6);
        simkit_packet(&kit, "FA AF 03 00 24 01 01 01", 0);
        simkit_run(&kit, 1000000);
        assert_int_equal(angle(SHOULDER), there);
        assert_int_equal(simkit_events(&kit, GROBO_SIM_TORQUE, NULL), 2);
    }
}

/* ---- current and voltage ------------------------------------------------------------------- */

TEST(currents_tell_idle_hold_move_and_load)
{
    simkit_start(&kit, NULL);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_CURRENT), 6);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_CURRENT), 40);
    assert_int_equal(grobo_sim_set_load(&kit.sim, SHOULDER, 100), 0);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_CURRENT), 140);
    assert_int_equal(grobo_sim_set_load(&kit.sim, SHOULDER, 0), 0);
    assert_int_equal(grobo_sim_set_load(&kit.sim, SHOULDER, -1), GROBO_ERR_ARG);
    simkit_packet(&kit, "FA AF 03 00 1E 02 01 84 03", 0);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_CURRENT), 300);
}

TEST(the_supply_sags_under_current)
{
    simkit_start(&kit, NULL);
    assert_int_equal(simkit_register(&kit, 0, GROBO_RS30X_VOLTAGE), 738);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    assert_int_equal(simkit_register(&kit, 0, GROBO_RS30X_VOLTAGE), 732);
    grobo_sim_set_supply(&kit.sim, 6000);
    assert_int_equal(simkit_register(&kit, 0, GROBO_RS30X_VOLTAGE), 592);
}

TEST(a_weaker_supply_slows_a_move_under_way)
{
    start_with_torque(NULL);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 20 03 00 00", 0);
    simkit_run(&kit, 80000);
    grobo_sim_set_supply(&kit.sim, 5550);
    simkit_run(&kit, 80000);
    assert_in_range(angle(SHOULDER), 72490, 72510);
}

/* ---- temperature --------------------------------------------------------------------------- */

TEST(a_blocked_shaft_heats_until_its_torque_is_cut)
{
    start_with_torque(NULL);
    assert_int_equal(grobo_sim_set_blocked(&kit.sim, R_HIP_P, true), 0);
    simkit_packet(&kit, "FA AF 0A 00 1E 02 01 00 00", 0);
    int64_t t0 = kit.now_us;
    kit.now_us += 60000000;
    double c = simkit_look(&kit, R_HIP_P).temperature_c;
    assert_true(fabs(c - (25 + 122.4 * (1 - exp(-0.2)))) < 0.1);
    kit.now_us += 60000000;
    simkit_packet(&kit, "FA AF 0A 0F 32 02 00", 10);
    assert_int_equal(kit.got[3], 0);
    kit.now_us += 40000000;
    simkit_packet(&kit, "FA AF 0A 0F 32 02 00", 10);
    assert_int_equal(kit.got[3], GROBO_RS30X_STATUS_HOT);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_OVERHEAT, NULL), 0);
    kit.now_us += 3600LL * 1000000;
    grobo_sim_view view = simkit_look(&kit, R_HIP_P);
    assert_int_equal(view.torque, GROBO_TORQUE_OFF);
    assert_true(view.temperature_c < 26);
    grobo_sim_event cut, torque;
    assert_int_equal(simkit_events(&kit, GROBO_SIM_OVERHEAT, &cut), 1);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_TORQUE, &torque), 1);
    assert_int_equal(cut.value, 80);
    assert_int_equal(torque.time_us, cut.time_us);
    double expected_us = 300e6 * log(122.4 / (122.4 - 55));
    assert_true(fabs((double)(cut.time_us - t0) - expected_us) < 2e5);
    assert_int_equal(angle(R_HIP_P), 20000);
}

TEST(an_overheated_servo_says_so_until_torque_is_written)
{
    start_with_torque(NULL);
    assert_int_equal(grobo_sim_set_temperature(&kit.sim, R_HIP_P, 90), 0);
    assert_int_equal(grobo_sim_set_temperature(&kit.sim, R_HIP_P, NAN), GROBO_ERR_ARG);
    simkit_packet(&kit, "FA AF 0A 0F 24 01 00", 9);
    simkit_expect(&kit, "FD DF 0A A0 24 01 01 00 8E");
    assert_int_equal(grobo_sim_set_temperature(&kit.sim, R_HIP_P, 30), 0);
    simkit_packet(&kit, "FA AF 0A 0F 24 01 00", 9);
    simkit_expect(&kit, "FD DF 0A 80 24 01 01 00 AE");
    simkit_packet(&kit, "FA AF 0A 00 24 01 01 01", 0);
    simkit_packet(&kit, "FA AF 0A 0F 24 01 00", 9);
    simkit_expect(&kit, "FD DF 0A 00 24 01 01 01 2F");
}

/* ---- hands --------------------------------------------------------------------------------- */

TEST(a_hand_moves_a_limp_shaft)
{
    simkit_start(&kit, NULL);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, SHOULDER, 60000, 1000000), 0);
    simkit_run(&kit, 500000);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_POSITION), 400);
    assert_int_equal(simkit_register(&kit, SHOULDER, GROBO_RS30X_SPEED), 40);
    simkit_run(&kit, 1000000);
    assert_int_equal(angle(SHOULDER), 60000);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, SHOULDER, 999000, 0), 0);
    assert_int_equal(angle(SHOULDER), 150000);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, SHOULDER, 0, -1), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, SHOULDER, 0, GROBO_NEVER_US), GROBO_ERR_ARG);
}

TEST(a_servo_drives_back_when_the_hand_lets_go)
{
    start_with_torque(NULL);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, SHOULDER, 50000, 500000), 0);
    simkit_run(&kit, 500000);
    assert_int_equal(angle(SHOULDER), 50000);
    simkit_run(&kit, 40000);
    assert_in_range(angle(SHOULDER), 34999, 35001);
    simkit_run(&kit, 1000000);
    assert_int_equal(angle(SHOULDER), 20000);
}

TEST(a_hand_goes_on_whatever_the_torque_becomes)
{
    start_with_torque(NULL);
    assert_int_equal(grobo_sim_set_angle(&kit.sim, SHOULDER, 80000, 600000), 0);
    simkit_run(&kit, 100000);
    simkit_packet(&kit, "FA AF 03 00 24 01 01 02", 0);
    simkit_run(&kit, 100000);
    assert_in_range(angle(SHOULDER), 39000, 42000);
    simkit_packet(&kit, "FA AF 03 00 24 01 01 01", 0);
    simkit_run(&kit, 100000);
    assert_in_range(angle(SHOULDER), 49000, 53000);
    simkit_packet(&kit, "FA AF 03 00 24 01 01 00", 0);
    simkit_run(&kit, 1000000);
    assert_int_equal(angle(SHOULDER), 80000);
}
