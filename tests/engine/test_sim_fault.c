/* SPDX-License-Identifier: MIT */
/* Faults: what each does, how often, the same again for the same seed. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/sim.h>

#include "tests/support/simkit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static simkit kit, twin;

static const char read_1[] = "54 09 FA AF 01 0F 24 12 00 38 1A";
static const char bus_read_1[] = "FA AF 01 0F 24 12 00 38";

static void start(simkit *k, grobo_wiring wiring, int fault, double rate)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = wiring, .seed = 42};
    simkit_start(k, &config);
    assert_int_equal(grobo_sim_set_fault(&k->sim, fault, rate), 0);
}

/* ---- names and rates ----------------------------------------------------------------------- */

TEST(names_are_found)
{
    for (int i = 0; i < (int)GROBO_SIM_FAULTS; i++) {
        const char *name = grobo_sim_fault_name(i);
        assert_non_null(name);
        assert_int_equal(grobo_sim_fault_find(name, strlen(name)), i);
    }
    assert_null(grobo_sim_fault_name(-1));
    assert_null(grobo_sim_fault_name(GROBO_SIM_FAULTS));
    assert_int_equal(grobo_sim_fault_find("dro", 3), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_sim_fault_find("", 0), GROBO_ERR_NOTFOUND);
}

static int set(const char *list)
{
    return grobo_sim_set_faults(&kit.sim, list, strlen(list));
}

TEST(lists_of_rates_are_read_whole_or_not_at_all)
{
    simkit_start(&kit, NULL);
    assert_int_equal(set(""), 0);
    assert_int_equal(set("drop=0.5,flip=25%"), 2);
    assert_int_equal(kit.sim.fault_below[GROBO_SIM_FAULT_DROP], UINT32_MAX / 2);
    assert_int_equal(kit.sim.fault_below[GROBO_SIM_FAULT_FLIP], UINT32_MAX / 4);
    static const char *const bad[] = {"drop=0,flip",   "drop=0,flip=",      "drop=0,flip=1.5",
                                      "drop=0,,",      "drop=0,flip=1.2.3", "drop=0,flip=-1",
                                      "drop=0,flip=x", "drop=0,flip=%"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_true(set(bad[i]) < 0);
        assert_int_equal(kit.sim.fault_below[GROBO_SIM_FAULT_DROP], UINT32_MAX / 2);
    }
    assert_int_equal(set("drip=0.1"), GROBO_ERR_NOTFOUND);
    assert_int_equal(set("drop=2"), GROBO_ERR_ARG);
    assert_int_equal(set("all=1"), GROBO_SIM_FAULTS - 1);
    assert_int_equal(kit.sim.fault_below[GROBO_SIM_FAULT_HANG_UP], 0);
    assert_int_equal(grobo_sim_set_fault(&kit.sim, -1, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_set_fault(&kit.sim, GROBO_SIM_FAULTS, 0), GROBO_ERR_ARG);
}

/* ---- each kind ----------------------------------------------------------------------------- */

TEST(dropped_bytes_are_gone)
{
    start(&kit, GROBO_WIRING_BOARD, GROBO_SIM_FAULT_DROP, 1);
    simkit_ask(&kit, read_1, 100000);
    simkit_expect(&kit, "");
    assert_int_equal(kit.sim.stats.rx_bytes, 11);
    assert_int_equal(kit.sim.stats.injected[GROBO_SIM_FAULT_DROP], 11);
}

TEST(flipped_bytes_differ_in_one_bit)
{
    uint8_t clean[26];
    start(&kit, GROBO_WIRING_BOARD, GROBO_SIM_FAULT_FLIP, 0);
    simkit_ask(&kit, read_1, 100000);
    memcpy(clean, kit.got, sizeof clean);
    simkit_send(&kit, read_1);
    simkit_run(&kit, 2000);
    assert_int_equal(grobo_sim_set_fault(&kit.sim, GROBO_SIM_FAULT_FLIP, 1), 0);
    simkit_run(&kit, 10000);
    assert_int_equal(kit.n_got, 26);
    for (int i = 0; i < 26; i++) {
        unsigned differ = kit.got[i] ^ (unsigned)clean[i];
        assert_true(differ != 0 && (differ & (differ - 1)) == 0);
    }
}

TEST(duplicated_replies_come_twice)
{
    start(&kit, GROBO_WIRING_BOARD, GROBO_SIM_FAULT_DUPLICATE, 1);
    simkit_ask(&kit, read_1, 100000);
    assert_int_equal(kit.n_got, 52);
    assert_memory_equal(kit.got, kit.got + 26, 26);
    start(&kit, GROBO_WIRING_BUS, GROBO_SIM_FAULT_DUPLICATE, 1);
    simkit_ask(&kit, bus_read_1, 100000);
    assert_int_equal(kit.n_got, 52);
    assert_memory_equal(kit.got, kit.got + 26, 26);
}

TEST(delayed_replies_come_later_and_whole)
{
    int64_t longest_us = 0;
    start(&kit, GROBO_WIRING_BOARD, GROBO_SIM_FAULT_DELAY, 1);
    for (int i = 0; i < 50; i++) {
        int64_t t0 = kit.now_us;
        simkit_ask(&kit, read_1, 100000);
        assert_int_equal(kit.n_got, 26);
        assert_true(kit.got_us[25] - t0 > 6264);
        assert_true(kit.got_us[25] - t0 <= 6265 + GROBO_SIM_DELAY_MAX_US);
        longest_us = kit.got_us[25] - t0 > longest_us ? kit.got_us[25] - t0 : longest_us;
    }
    assert_true(longest_us > 6264 + GROBO_SIM_DELAY_MAX_US / 2);
}

TEST(split_replies_pause_once_inside)
{
    static const grobo_wiring wirings[] = {GROBO_WIRING_BOARD, GROBO_WIRING_BUS};
    for (int w = 0; w < 2; w++) {
        start(&kit, wirings[w], GROBO_SIM_FAULT_SPLIT, 1);
        for (int i = 0; i < 20; i++) {
            simkit_ask(&kit, w == 0 ? read_1 : bus_read_1, 100000);
            assert_int_equal(kit.n_got, 26);
            int pauses = 0;
            for (int k = 1; k < 26; k++) {
                pauses += kit.got_us[k] - kit.got_us[k - 1] > 87;
            }
            assert_int_equal(pauses, 1);
        }
    }
}

TEST(rubbish_comes_in_front)
{
    static const grobo_wiring wirings[] = {GROBO_WIRING_BOARD, GROBO_WIRING_BUS};
    for (int w = 0; w < 2; w++) {
        start(&kit, wirings[w], GROBO_SIM_FAULT_RUBBISH, 1);
        simkit_ask(&kit, w == 0 ? read_1 : bus_read_1, 100000);
        assert_in_range(kit.n_got, 27, 34);
        static const uint8_t head[] = {0xFD, 0xDF, 0x01, 0x00, 0x24, 0x12, 0x01};
        assert_memory_equal(kit.got + kit.n_got - 26, head, sizeof head);
    }
}

TEST(silent_servos_hear_nothing)
{
    start(&kit, GROBO_WIRING_BOARD, GROBO_SIM_FAULT_SILENT, 1);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    assert_int_equal(kit.sim.stats.injected[GROBO_SIM_FAULT_SILENT], 20);
    assert_int_equal(simkit_look(&kit, 0).torque, GROBO_TORQUE_OFF);
    simkit_ask(&kit, read_1, 100000);
    simkit_expect(&kit, "");
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "07");
}

TEST(a_ghost_with_the_same_id_spoils_the_reply)
{
    start(&kit, GROBO_WIRING_BOARD, GROBO_SIM_FAULT_DUPLICATE_ID, 0);
    simkit_ask(&kit, read_1, 100000);
    uint8_t clean[26];
    memcpy(clean, kit.got, sizeof clean);
    assert_int_equal(grobo_sim_set_fault(&kit.sim, GROBO_SIM_FAULT_DUPLICATE_ID, 1), 0);
    simkit_ask(&kit, read_1, 100000);
    assert_int_equal(kit.n_got, 26);
    assert_memory_not_equal(kit.got, clean, sizeof clean);
    for (int i = 0; i < 26; i++) {
        assert_int_equal(kit.got[i] & clean[i], kit.got[i]);
    }
}

TEST(a_hang_up_is_the_end_until_plugged_in)
{
    static const grobo_wiring wirings[] = {GROBO_WIRING_BOARD, GROBO_WIRING_BUS};
    for (int w = 0; w < 2; w++) {
        start(&kit, wirings[w], GROBO_SIM_FAULT_HANG_UP, 1);
        assert_false(grobo_sim_hung_up(&kit.sim));
        simkit_ask(&kit, w == 0 ? read_1 : bus_read_1, 100000);
        simkit_expect(&kit, "");
        assert_true(grobo_sim_hung_up(&kit.sim));
        assert_int_equal(grobo_sim_set_fault(&kit.sim, GROBO_SIM_FAULT_HANG_UP, 0), 0);
        simkit_run(&kit, 100000);
        grobo_sim_plug(&kit.sim, true, kit.now_us);
        simkit_ask(&kit, w == 0 ? read_1 : bus_read_1, 100000);
        assert_int_equal(kit.n_got, 26);
    }
}

TEST(a_brown_out_reboots_all_and_takes_their_torque)
{
    start(&kit, GROBO_WIRING_BOARD, GROBO_SIM_FAULT_BROWN_OUT, 0);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, 3, GROBO_SIM_CABLE_OUT), 0);
    simkit_forget(&kit);
    assert_int_equal(grobo_sim_set_fault(&kit.sim, GROBO_SIM_FAULT_BROWN_OUT, 1), 0);
    simkit_ask(&kit, "41 00", 100000);
    assert_int_equal(grobo_sim_set_fault(&kit.sim, GROBO_SIM_FAULT_BROWN_OUT, 0), 0);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REBOOT, NULL), 19);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_TORQUE, NULL), 19);
    assert_true(simkit_look(&kit, 12).deaf);
    simkit_run(&kit, 500000);
    simkit_ask(&kit, read_1, 100000);
    assert_int_equal(kit.n_got, 26);
    assert_int_equal(kit.got[7], 0);
}

/* ---- chance -------------------------------------------------------------------------------- */

TEST(a_fault_strikes_as_often_as_its_rate_says)
{
    start(&kit, GROBO_WIRING_BOARD, GROBO_SIM_FAULT_SILENT, 0.01);
    for (int i = 0; i < 1000; i++) {
        simkit_packet(&kit, "FA AF FF 00 20 02 01 00 00", 0);
        simkit_forget(&kit);
    }
    assert_in_range(kit.sim.stats.injected[GROBO_SIM_FAULT_SILENT], 140, 260);
}

/* Reads all servos in turn under every fault; both kits must see the same. */
static void drive(simkit *k, uint32_t seed, grobo_wiring wiring)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = wiring, .seed = seed,
                                     .start = GROBO_SIM_START_LIMP};
    simkit_start(k, &config);
    static const char rates[] = "all=2%,hangup=0.005";
    assert_true(grobo_sim_set_faults(&k->sim, rates, strlen(rates)) > 0);
    simkit_packet(k, "FA AF FF 00 24 01 01 01", 0);
    for (int i = 0; i < 60; i++) {
        simkit_packet(k, "FA AF 03 00 1E 04 01 84 03 32 00", 0);
        simkit_packet(k, "FA AF 03 0F 24 12 00", 26);
        simkit_forget(k);
        if (grobo_sim_hung_up(&k->sim)) {
            grobo_sim_plug(&k->sim, true, k->now_us);
        }
        for (int s = 0; s < 20; s++) {
            grobo_sim_view view = simkit_look(k, s);
            const grobo_joint *joint = &grobo_i_gr001_model.joints[s];
            assert_true(view.angle_mdeg >= joint->min_rad * 57295.8 - 1);
            assert_true(view.angle_mdeg <= joint->max_rad * 57295.8 + 1);
        }
    }
}

TEST(the_same_seed_gives_the_same_again)
{
    uint32_t struck = 0;
    for (uint32_t seed = 1; seed <= 20; seed++) {
        grobo_wiring wiring = seed % 2 ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS;
        drive(&kit, seed, wiring);
        drive(&twin, seed, wiring);
        assert_memory_equal(&kit.sim.stats, &twin.sim.stats, sizeof kit.sim.stats);
        assert_int_equal(kit.now_us, twin.now_us);
        assert_memory_equal(kit.sim.servo, twin.sim.servo, sizeof kit.sim.servo);
        for (int i = 0; i < (int)GROBO_SIM_FAULTS; i++) {
            struck |= kit.sim.stats.injected[i] > 0 ? 1u << i : 0;
        }
    }
    assert_int_equal(struck, (1u << GROBO_SIM_FAULTS) - 1);
    drive(&kit, 1, GROBO_WIRING_BOARD);
    drive(&twin, 2, GROBO_WIRING_BOARD);
    assert_memory_not_equal(&kit.sim.stats, &twin.sim.stats, sizeof kit.sim.stats);
}

/* However the host's and the pump's calls fall in time, the wire's times are the same. */
TEST(the_pump_may_come_late_or_often)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .seed = 5};
    static const char rates[] = "rubbish=1,split=1,flip=1%";
    static const int64_t steps_us[] = {1, 7, 333, 40000};
    uint8_t first[64] = {0};
    for (size_t i = 0; i < sizeof steps_us / sizeof *steps_us; i++) {
        simkit_start(&kit, &config);
        assert_int_equal(grobo_sim_set_faults(&kit.sim, rates, strlen(rates)), 3);
        simkit_send(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A");
        for (int64_t t = 0; t < 40000; t += steps_us[i]) {
            grobo_sim_step(&kit.sim, kit.now_us + t);
        }
        simkit_run(&kit, 40000);
        assert_true(kit.n_got > 0 && kit.n_got <= sizeof first);
        if (i == 0) {
            memcpy(first, kit.got, kit.n_got);
        }
        assert_memory_equal(first, kit.got, kit.n_got);
    }
}
