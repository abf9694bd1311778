/* SPDX-License-Identifier: MIT */
/* What servos remember: flash, reboot, factory reset, baud, supply and cables. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/sim.h>

#include "tests/support/simkit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static simkit kit;

enum { CHEST = 12, R_HIP_P = 2 };

static bool answers(const char *ping)
{
    simkit_packet(&kit, ping, 1);
    return kit.n_got == 1 && kit.got[0] == 0x07;
}

/* ---- power-up ------------------------------------------------------------------------------ */

TEST(power_up_is_limp_with_goals_at_zero)
{
    simkit_start(&kit, NULL);
    assert_int_equal(grobo_sim_servos(&kit.sim), 20);
    for (int i = 0; i < 20; i++) {
        grobo_sim_view view = simkit_look(&kit, i);
        assert_int_equal(view.torque, GROBO_TORQUE_OFF);
        assert_int_equal(simkit_register(&kit, i, GROBO_RS30X_GOAL), 0);
        assert_int_equal(simkit_register(&kit, i, GROBO_RS30X_ID),
                         grobo_i_gr001_model.joints[i].motor);
        assert_int_equal(simkit_register(&kit, i, GROBO_RS30X_MODEL),
                         grobo_i_gr001_model.joints[i].servo_model);
        assert_false(view.moving || view.stalled || view.deaf);
    }
    assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_POSITION), 200);
}

TEST(limp_start_is_within_stops_and_of_the_seed)
{
    static simkit other;
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP,
                                     .seed = 7};
    const grobo_sim_config third = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_LIMP,
                                    .seed = 8};
    simkit_start(&kit, &config);
    simkit_start(&other, &config);
    int differ = 0;
    for (int i = 0; i < 20; i++) {
        const grobo_joint *joint = &grobo_i_gr001_model.joints[i];
        int32_t mdeg = simkit_look(&kit, i).angle_mdeg;
        assert_int_equal(mdeg, simkit_look(&other, i).angle_mdeg);
        assert_true(mdeg >= joint->min_rad * 57295.8 - 1 && mdeg <= joint->max_rad * 57295.8 + 1);
    }
    simkit_start(&other, &third);
    for (int i = 0; i < 20; i++) {
        differ += simkit_look(&kit, i).angle_mdeg != simkit_look(&other, i).angle_mdeg;
    }
    assert_true(differ > 10);
}

TEST(a_start_at_zero_keeps_the_stops)
{
    static grobo_joint joints[3];
    static const grobo_model bent =
        GROBO_TABLE(grobo_model, .name = "bent", GROBO_MODEL_JOINTS(joints), .n_joints = 3);
    static const char *const joint_names[] = {"below", "across", "above"};
    static const double min_rad[] = {-2, -1, 0.5}, max_rad[] = {-0.5, 1, 2};
    for (uint8_t i = 0; i < 3; i++) {
        joints[i] = (grobo_joint){.name = joint_names[i],
                                  .min_rad = min_rad[i],
                                  .max_rad = max_rad[i],
                                  .max_speed_rad_s = 5,
                                  .init_rad = min_rad[i],
                                  .motor = (uint8_t)(i + 1),
                                  .mirror = i,
                                  .mirror_sign = 1};
    }
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .model = &bent,
                                     .start = GROBO_SIM_START_ZERO};
    simkit_start(&kit, &config);
    assert_int_equal(simkit_look(&kit, 0).angle_mdeg, -28648);
    assert_int_equal(simkit_look(&kit, 1).angle_mdeg, 0);
    assert_int_equal(simkit_look(&kit, 2).angle_mdeg, 28648);
}

TEST(there_is_no_servo_beyond_the_last)
{
    grobo_sim_view view;
    simkit_start(&kit, NULL);
    assert_int_equal(grobo_sim_look(&kit.sim, 20, &view), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_look(&kit.sim, -1, &view), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_set_blocked(&kit.sim, 20, true), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_find(&kit.sim, 21), GROBO_ERR_NOTFOUND);
}

TEST(bad_configurations_are_refused)
{
    static grobo_sim sim;
    const grobo_model none = GROBO_TABLE(grobo_model, .name = "none");
    const grobo_sim_config bad_model = {GROBO_SIM_CONFIG_INIT, .model = &none};
    const grobo_sim_config slow = {GROBO_SIM_CONFIG_INIT, .baud_bps = 10};
    const grobo_sim_config hot = {GROBO_SIM_CONFIG_INIT, .ambient_c = 100};
    const grobo_sim_config odd = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS,
                                  .baud_bps = 100000};
    assert_int_equal(grobo_sim_init(&sim, &bad_model, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_init(&sim, &slow, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_init(&sim, &hot, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_init(&sim, &odd, 0), GROBO_ERR_ARG);
}

/* ---- flash and reboot ---------------------------------------------------------------------- */

TEST(reboot_forgets_what_is_not_in_flash)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 01 00 18 02 01 05 06", 0);
    simkit_packet(&kit, "FA AF 01 00 23 02 01 32 01", 0);
    simkit_ask(&kit, "53 08 FA AF 01 20 FF 00 00 DE", 10000);
    assert_int_equal(simkit_look(&kit, CHEST).torque, GROBO_TORQUE_OFF);
    assert_true(simkit_look(&kit, CHEST).deaf);
    assert_false(answers("FA AF 01 01 FF 00 00"));
    simkit_run(&kit, 500000);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_CW_MARGIN), 2);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_MAX_TORQUE), 100);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REBOOT, NULL), 1);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_TORQUE, NULL), 2);
}

TEST(flash_takes_a_second_and_lasts)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 02 00 18 02 01 05 06", 0);
    simkit_packet(&kit, "FA AF 02 40 FF 00 00", 0);
    simkit_run(&kit, 900000);
    assert_false(answers("FA AF 02 01 FF 00 00"));
    simkit_run(&kit, 100000);
    assert_true(answers("FA AF 02 01 FF 00 00"));
    assert_int_equal(simkit_events(&kit, GROBO_SIM_SAVED, NULL), 1);
    simkit_packet(&kit, "FA AF 02 20 FF 00 00", 0);
    simkit_run(&kit, 600000);
    int neck = simkit_servo(&kit, 2);
    assert_int_equal(simkit_register(&kit, neck, GROBO_RS30X_CW_MARGIN), 5);
    assert_int_equal(simkit_register(&kit, neck, GROBO_RS30X_CCW_MARGIN), 6);
}

/* Who writes to a servo that is busy is told of, and with which packet. */
TEST(a_busy_servo_misses_what_it_is_told)
{
    grobo_sim_event event;
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 01 40 FF 00 00", 0);
    simkit_packet(&kit, "FA AF 01 00 24 01 01 01", 0);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_MISSED, &event), 1);
    assert_int_equal(event.servo, CHEST);
    assert_int_equal(event.value, GROBO_SIM_BUSY_FLASH);
    assert_int_equal(event.n_bytes, 9);
    simkit_packet(&kit, "FA AF 02 00 24 01 01 01", 0);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_MISSED, NULL), 1);
    simkit_run(&kit, 1000000);
    simkit_packet(&kit, "FA AF 01 20 FF 00 00", 0);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_MISSED, &event), 2);
    assert_int_equal(event.value, GROBO_SIM_BUSY_REBOOT);
}

TEST(flash_goes_from_one_simulator_to_the_next)
{
    uint8_t flash[GROBO_SIM_FLASH_BYTES], before[GROBO_SIM_FLASH_BYTES];
    simkit_start(&kit, NULL);
    assert_int_equal(grobo_sim_get_flash(&kit.sim, CHEST, before), 0);
    simkit_packet(&kit, "FA AF 01 00 04 01 01 63", 0);
    simkit_packet(&kit, "FA AF 63 00 1C 02 01 2C 01", 0);
    assert_int_equal(grobo_sim_get_flash(&kit.sim, CHEST, flash), 0);
    assert_memory_equal(flash, before, sizeof flash);
    simkit_packet(&kit, "FA AF 63 40 FF 00 00", 0);
    simkit_run(&kit, 1000000);
    assert_int_equal(grobo_sim_get_flash(&kit.sim, CHEST, flash), 0);
    assert_int_equal(grobo_sim_get_flash(&kit.sim, 20, flash), GROBO_ERR_ARG);

    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 01 00 24 01 01 01", 0);
    assert_int_equal(grobo_sim_set_flash(&kit.sim, CHEST, flash), 0);
    assert_int_equal(simkit_look(&kit, CHEST).torque, GROBO_TORQUE_OFF);
    assert_int_equal(simkit_look(&kit, CHEST).id, 99);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_PUNCH), 300);
    assert_true(answers("FA AF 63 01 00 00 01"));
    memcpy(before, flash, sizeof flash);
    /* The id, the rate, a reserved byte, a limit's high byte: what no servo can have. */
    static const struct {
        uint8_t at, value;
    } wrong[] = {{0, 0}, {0, 128}, {2, 11}, {8, 1}, {5, 0x7F}, {1, 2}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        flash[wrong[i].at] = wrong[i].value;
        assert_int_equal(grobo_sim_set_flash(&kit.sim, CHEST, flash), GROBO_ERR_LIMIT);
        memcpy(flash, before, sizeof flash);
    }
    assert_int_equal(grobo_sim_set_flash(&kit.sim, -1, flash), GROBO_ERR_ARG);
    assert_int_equal(simkit_look(&kit, CHEST).id, 99);
}

TEST(flash_and_reboot_in_one_packet)
{
    simkit_start(&kit, NULL);
    simkit_ask(&kit, "53 09 FA AF 01 60 07 01 01 12 74", 10000);
    int64_t t0 = kit.now_us;
    simkit_run(&kit, 1400000);
    assert_false(answers("FA AF 01 01 FF 00 00"));
    simkit_run(&kit, 100000);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_DELAY), 18);
    grobo_sim_event saved, reboot;
    assert_int_equal(simkit_events(&kit, GROBO_SIM_SAVED, &saved), 1);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REBOOT, &reboot), 1);
    assert_int_equal(saved.time_us, t0 + 1000000);
    assert_int_equal(reboot.time_us, saved.time_us);
}

TEST(power_lost_while_saving_is_a_flash_error)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 01 00 18 01 01 09", 0);
    simkit_packet(&kit, "FA AF 01 40 FF 00 00", 0);
    simkit_run(&kit, 500000);
    grobo_sim_step(&kit.sim, kit.now_us);
    grobo_sim_set_supply(&kit.sim, 0);
    simkit_run(&kit, 100000);
    grobo_sim_set_supply(&kit.sim, 7400);
    simkit_run(&kit, 600000);
    simkit_packet(&kit, "FA AF 01 0F 18 01 00", 9);
    simkit_expect(&kit, "FD DF 01 08 18 01 01 02 13");
    simkit_packet(&kit, "FA AF 01 40 FF 00 00", 0);
    simkit_run(&kit, 1100000);
    simkit_packet(&kit, "FA AF 01 0F 18 01 00", 9);
    simkit_expect(&kit, "FD DF 01 00 18 01 01 02 1B");
}

TEST(factory_reset_in_both_spellings)
{
    static const char *const spellings[] = {"FA AF 0A 10 FF FF 00", "FA AF 0A 10 FF FF 00 FF"};
    for (int i = 0; i < 2; i++) {
        simkit_start(&kit, NULL);
        simkit_packet(&kit, "FA AF 0A 00 08 02 01 64 00", 0);
        simkit_packet(&kit, spellings[i], 0);
        simkit_run(&kit, 1000000);
        assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_ID), 1);
        assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_CW_LIMIT), 1500);
        simkit_packet(&kit, "FA AF 01 20 FF 00 00", 0);
        simkit_run(&kit, 600000);
        assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_ID), 1);
        assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_ID), 1);
    }
}

/* ---- baud ---------------------------------------------------------------------------------- */

/* No.6, flash and reboot all at the old rate, as programs for these servos do it. */
TEST(a_rate_takes_effect_at_the_restart)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS};
    simkit_start(&kit, &config);
    simkit_packet(&kit, "FA AF 01 00 06 01 01 0A", 0);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_BAUD), 10);
    assert_int_equal(simkit_look(&kit, CHEST).baud_bps, 115200);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    simkit_packet(&kit, "FA AF 01 40 FF 00 00", 0);
    simkit_run(&kit, 1000000);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    simkit_packet(&kit, "FA AF 01 20 FF 00 00", 0);
    simkit_run(&kit, 500000);
    assert_false(answers("FA AF 01 01 FF 00 00"));
    assert_int_equal(grobo_sim_set_line_bps(&kit.sim, 460800), 0);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    assert_int_equal(simkit_look(&kit, CHEST).baud_bps, 460800);
    /* A factory reset too is one of the next restart, here by the supply. */
    simkit_packet(&kit, "FA AF 01 10 FF FF 00", 0);
    simkit_run(&kit, 1000000);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    grobo_sim_set_supply(&kit.sim, 0);
    grobo_sim_set_supply(&kit.sim, 7400);
    simkit_run(&kit, 500000);
    assert_false(answers("FA AF 01 01 FF 00 00"));
    assert_int_equal(simkit_look(&kit, CHEST).baud_bps, 115200);
}

TEST(a_restart_without_flash_loses_the_rate)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS};
    simkit_start(&kit, &config);
    simkit_packet(&kit, "FA AF 01 00 06 01 01 0A", 0);
    simkit_packet(&kit, "FA AF 01 20 FF 00 00", 0);
    simkit_run(&kit, 500000);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_BAUD), GROBO_RS30X_BAUD_CODE_DEFAULT);
}

TEST(another_rate_is_not_understood_until_the_line_has_it)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS,
                                     .baud_at_once = true};
    simkit_start(&kit, &config);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    simkit_packet(&kit, "FA AF 01 00 06 01 01 0A", 0);
    assert_int_equal(simkit_look(&kit, CHEST).baud_bps, 460800);
    assert_false(answers("FA AF 01 01 FF 00 00"));
    assert_true(answers("FA AF 02 01 FF 00 00"));
    assert_int_equal(grobo_sim_set_line_bps(&kit.sim, 460800), 0);
    assert_false(answers("FA AF 02 01 FF 00 00"));
    assert_true(answers("FA AF 01 01 FF 00 00"));
    int64_t t0 = kit.now_us;
    simkit_packet(&kit, "FA AF 01 0F 24 12 00", 26);
    assert_int_equal(kit.n_got, 26);
    assert_int_equal(kit.got_us[25] - t0, 100 + (34 * 10000000 + 460799) / 460800);
    assert_int_equal(grobo_sim_set_line_bps(&kit.sim, 0), GROBO_ERR_ARG);
}

TEST(the_board_loses_a_servo_of_another_rate)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .baud_at_once = true};
    simkit_start(&kit, &config);
    simkit_ask(&kit, "53 09 FA AF 01 00 06 01 01 0A 0D", 10000);
    assert_false(answers("FA AF 01 01 FF 00 00"));
    assert_true(answers("FA AF 02 01 FF 00 00"));
}

TEST(the_board_hears_rubbish_at_another_rate)
{
    simkit_start(&kit, NULL);
    assert_int_equal(grobo_sim_set_line_bps(&kit.sim, 9600), 0);
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "");
    assert_int_equal(grobo_sim_set_line_bps(&kit.sim, 115200), 0);
    simkit_run(&kit, 100000);
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "07");
}

/* ---- supply and cables --------------------------------------------------------------------- */

TEST(a_brown_out_makes_servos_limp)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    grobo_sim_set_supply(&kit.sim, 4000);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(simkit_look(&kit, i).torque, GROBO_TORQUE_OFF);
        assert_int_equal(simkit_look(&kit, i).current_ma, 0);
    }
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "07");
    assert_false(answers("FA AF 01 01 FF 00 00"));
    grobo_sim_set_supply(&kit.sim, 7400);
    assert_false(answers("FA AF 01 01 FF 00 00"));
    simkit_run(&kit, 500000);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REBOOT, NULL), 20);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_TORQUE, NULL), 40);
}

TEST(an_empty_battery_powers_nothing_up)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .supply_mv = 4000};
    simkit_start(&kit, &config);
    assert_true(simkit_look(&kit, CHEST).deaf);
    assert_false(answers("FA AF 01 01 FF 00 00"));
}

TEST(a_mute_servo_holds_and_one_without_cable_is_limp)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, CHEST, GROBO_SIM_CABLE_MUTE), 0);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, R_HIP_P, GROBO_SIM_CABLE_OUT), 0);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, 20, GROBO_SIM_CABLE_OUT), GROBO_ERR_ARG);
    assert_false(answers("FA AF 01 01 FF 00 00"));
    assert_false(answers("FA AF 0A 01 FF 00 00"));
    assert_int_equal(simkit_look(&kit, CHEST).torque, GROBO_TORQUE_ON);
    assert_int_equal(simkit_look(&kit, R_HIP_P).torque, GROBO_TORQUE_OFF);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, CHEST, GROBO_SIM_CABLE_IN), 0);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, R_HIP_P, GROBO_SIM_CABLE_IN), 0);
    assert_true(answers("FA AF 01 01 FF 00 00"));
    simkit_run(&kit, 500000);
    assert_true(answers("FA AF 0A 01 FF 00 00"));
    assert_int_equal(simkit_look(&kit, CHEST).torque, GROBO_TORQUE_ON);
    assert_int_equal(simkit_look(&kit, R_HIP_P).torque, GROBO_TORQUE_OFF);
}
