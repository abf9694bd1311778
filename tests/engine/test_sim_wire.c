/* SPDX-License-Identifier: MIT */
/* Time on the wires: the board's line, the servos' bus, both wirings, to the microsecond. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/sim.h>

#include "tests/support/simkit.h"
#include "tests/support/test.h"

static simkit kit;

/* End of the n-th byte time at a rate, rounded up to the microsecond that sees it. */
static int64_t bytes_us(int64_t n, int64_t bps)
{
    return (n * 10000000 + bps - 1) / bps;
}

TEST(check_costs_three_bytes)
{
    simkit_start(&kit, NULL);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "07");
    assert_int_equal(kit.got_us[0] - t0, bytes_us(3, 115200));
    assert_true(grobo_sim_deadline(&kit.sim) == GROBO_NEVER_US);
}

TEST(read_costs_71_bytes_and_the_delay)
{
    simkit_start(&kit, NULL);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A", 100000);
    assert_int_equal(kit.n_got, 26);
    for (int i = 0; i < 26; i++) {
        assert_int_equal(kit.got_us[i] - t0, 100 + bytes_us(46 + i, 115200));
    }
    assert_int_equal(kit.got_us[25] - t0, 6264);
}

TEST(return_delay_is_waited)
{
    simkit_start(&kit, NULL);
    simkit_ask(&kit, "53 09 FA AF 01 00 07 01 01 12 14", 100000);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A", 100000);
    assert_int_equal(kit.n_got, 26);
    assert_int_equal(kit.got_us[25] - t0, 1000 + bytes_us(71, 115200));
}

TEST(pose_frame_is_stored_and_forwarded)
{
    static const char pose[] =
        "53 6C FA AF 00 00 1E 05 14 01 00 00 64 00 02 00 00 64 00 03 00 00 64 00 04 00 00 64 00 "
        "05 00 00 64 00 06 00 00 64 00 07 00 00 64 00 08 00 00 64 00 09 00 00 64 00 0A 00 00 64 "
        "00 0B 00 00 64 00 0C 00 00 64 00 0D 00 00 64 00 0E 00 00 64 00 0F 00 00 64 00 10 00 00 "
        "64 00 11 00 00 64 00 12 00 00 64 00 13 00 00 64 00 14 00 00 64 00 1B";
    simkit_start(&kit, NULL);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, pose, 100000);
    grobo_sim_event frame, packet, goal;
    assert_int_equal(simkit_events(&kit, GROBO_SIM_FRAME, &frame), 1);
    assert_int_equal(frame.time_us - t0, bytes_us(110, 115200));
    assert_int_equal(simkit_events(&kit, GROBO_SIM_PACKET, &packet), 1);
    assert_int_equal(packet.time_us - t0, bytes_us(218, 115200));
    assert_int_equal(simkit_events(&kit, GROBO_SIM_GOAL, &goal), 20);
    assert_int_equal(goal.time_us, packet.time_us);
    assert_int_equal(goal.value2, 100);
    assert_int_equal(kit.n_got, 0);
}

/* ---- when to look ---------------------------------------------------------------------------- */

typedef int64_t (*deadline_fn)(const grobo_sim *sim);

/*
 * Sends, then turns by a deadline until the simulator is idle: how often that is, and which bytes
 * have come when. A deadline in the past is a turn too, so that a loop that spins is noticed.
 */
static int turns(deadline_fn deadline, const char *hex)
{
    int n = 0;
    simkit_send(&kit, hex);
    for (int64_t at_us; (at_us = deadline(&kit.sim)) != GROBO_NEVER_US; n++) {
        assert_true(n < 1000);
        kit.now_us = at_us > kit.now_us ? at_us : kit.now_us;
        size_t got =
            grobo_sim_tx(&kit.sim, kit.got + kit.n_got, SIMKIT_BYTES - kit.n_got, kit.now_us);
        while (got-- > 0) {
            kit.got_us[kit.n_got++] = kit.now_us;
        }
    }
    return n;
}

/* By packets there is a turn for each packet on each wire, and the reply is there as early. */
TEST(a_reading_takes_a_turn_for_each_packet)
{
    static const grobo_sim_config bus = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS};
    static const grobo_sim_config echo = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS,
                                          .echo = true};
    static const grobo_sim_config ftdi = {GROBO_SIM_CONFIG_INIT, .latency_us = 16000};
    static const struct {
        const grobo_sim_config *config;
        const char *hex;
        int turns, bytes;
    } lines[] = {
        {NULL, "54 09 FA AF 01 0F 24 12 00 38 1A", 4, 26},
        {NULL, "41 00", 2, 1},
        {NULL, "53 09 FA AF 01 00 24 01 01 01 24", 2, 0},
        {NULL, "54 09 FA AF 01 0F", 2, 0}, /* the second: it stalls */
        {&bus, "FA AF 01 0F", 1, 0},
        {&ftdi, "54 09 FA AF 01 0F 24 12 00 38 1A", 5, 26},
        {&bus, "FA AF 01 0F 24 12 00 38", 2, 26},
        {&echo, "FA AF 01 0F 24 12 00 38", 2, 34},
        {&bus, "FA AF 01 0F 24 12 00 38 FA AF 02 00 24 01 01 00 26", 3, 26},
        {&bus, "55 55 FA FA AF 01 0F 24 12 00 38", 2, 26},
    };
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        simkit_start(&kit, lines[i].config);
        int64_t t0 = kit.now_us;
        int by_bytes = turns(grobo_sim_deadline, lines[i].hex);
        size_t n = kit.n_got;
        int64_t last_us = n > 0 ? kit.got_us[n - 1] - t0 : 0;
        uint8_t bytes[64];
        assert_true(n <= sizeof bytes);
        for (size_t k = 1; k < n && lines[i].config != &ftdi; k++) { /* each in its own time */
            assert_in_range(kit.got_us[k] - kit.got_us[k - 1], 86, 300);
        }
        memcpy(bytes, kit.got, n);
        simkit_start(&kit, lines[i].config);
        int by_packets = turns(grobo_sim_packet_deadline, lines[i].hex);
        assert_int_equal(n, lines[i].bytes);
        assert_int_equal(by_packets, lines[i].turns);
        assert_true(by_bytes >= by_packets);
        assert_int_equal(kit.n_got, n);
        assert_memory_equal(kit.got, bytes, n);
        assert_int_equal(n > 0 ? kit.got_us[n - 1] - t0 : 0, last_us);
    }
}

/* ---- the board ----------------------------------------------------------------------------- */

TEST(frames_that_come_while_it_relays_wait)
{
    simkit_start(&kit, NULL);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit,
               "54 09 FA AF 01 0F 24 12 00 38 1A 54 09 FA AF 02 0F 24 12 00 3B 1A 41 00 "
               "53 09 FA AF 03 00 24 01 01 01 26",
               1000000);
    assert_int_equal(kit.n_got, 53);
    assert_int_equal(kit.got[2], 1);
    assert_int_equal(kit.got[28], 2);
    assert_int_equal(kit.got[52], 7);
    /* The first reply is out after 71 bytes; the second frame has waited and costs 60 more. */
    assert_int_equal(kit.got_us[25] - t0, 6264);
    assert_in_range(kit.got_us[51] - t0, 200 + bytes_us(131, 115200), 201 + bytes_us(131, 115200));
    assert_in_range(kit.got_us[52] - t0, 200 + bytes_us(132, 115200), 201 + bytes_us(132, 115200));
    assert_int_equal(simkit_look(&kit, 14).torque, GROBO_TORQUE_ON);
}

TEST(a_flooded_board_loses_bytes_and_counts_them)
{
    simkit_start(&kit, NULL);
    uint8_t flood[GROBO_SIM_WIRE_BYTES + 100];
    memset(flood, 0x41, sizeof flood);
    /* A read from a servo that is away keeps the board busy while the flood comes. */
    const grobo_sim_config patient = {GROBO_SIM_CONFIG_INIT, .board_silence_us = 1000000};
    simkit_start(&kit, &patient);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, 12, GROBO_SIM_CABLE_OUT), 0);
    simkit_send(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A");
    assert_int_equal(grobo_sim_rx_room(&kit.sim), GROBO_SIM_WIRE_BYTES - 11);
    size_t took = grobo_sim_rx(&kit.sim, flood, sizeof flood, kit.now_us);
    assert_int_equal(took, GROBO_SIM_WIRE_BYTES - 11);
    assert_int_equal(grobo_sim_rx(&kit.sim, flood, 1, kit.now_us), 0);
    simkit_run(&kit, 500000);
    assert_int_equal(kit.sim.stats.rx_bytes, GROBO_SIM_WIRE_BYTES);
    assert_int_equal(kit.sim.stats.overflows, took - GROBO_SIM_FIFO_BYTES);
    simkit_run(&kit, 1000000);
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "07");
}

TEST(a_silent_servo_makes_a_reply_short)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .board_silence_us = 3000};
    simkit_start(&kit, &config);
    assert_int_equal(grobo_sim_set_cable(&kit.sim, 12, GROBO_SIM_CABLE_MUTE), 0);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A 41 00", 100000);
    simkit_expect(&kit, "07");
    assert_int_equal(kit.sim.stats.short_replies, 1);
    assert_int_equal(kit.got_us[0] - t0, 3000 + bytes_us(20, 115200));
}

TEST(asking_for_more_waits_and_for_less_cuts)
{
    simkit_start(&kit, NULL);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "54 09 FA AF 01 0F 30 02 00 3C 1A", 100000);
    assert_int_equal(kit.n_got, 10);
    assert_int_equal(kit.got_us[9] - t0, 100 + 2000 + bytes_us(39, 115200));
    assert_int_equal(kit.sim.stats.short_replies, 1);
    simkit_ask(&kit, "54 09 FA AF 01 0F 24 12 00 38 0A", 100000);
    assert_int_equal(kit.n_got, 10);
    assert_int_equal(kit.got[5], 18);
    simkit_run(&kit, 100000);
    assert_int_equal(kit.sim.stats.stray_bytes, 16);
}

TEST(a_reply_nobody_asked_for_goes_nowhere)
{
    simkit_start(&kit, NULL);
    simkit_ask(&kit, "53 08 FA AF 01 0F 24 12 00 38", 100000);
    simkit_expect(&kit, "");
    simkit_run(&kit, 100000);
    assert_int_equal(kit.sim.stats.stray_bytes, 26);
}

TEST(slots_and_scenarios_are_noted)
{
    simkit_start(&kit, NULL);
    simkit_ask(&kit, "50 4D 03", 100000);
    simkit_ask(&kit, "50 53 00", 100000);
    simkit_ask(&kit, "50 53 09", 100000);
    simkit_expect(&kit, "");
    assert_int_equal(kit.sim.stats.slots, 1);
    assert_int_equal(kit.sim.stats.last_slot, 3);
    assert_int_equal(kit.sim.stats.scenarios, 2);
    assert_int_equal(kit.sim.stats.last_scenario, 9);
    grobo_sim_event event;
    assert_int_equal(simkit_events(&kit, GROBO_SIM_SLOT, &event), 1);
    assert_int_equal(event.value, 3);
}

TEST(a_stalled_frame_is_forgotten)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .board_stall_us = 10000};
    simkit_start(&kit, &config);
    simkit_ask(&kit, "53 09 FA AF 01 00", 5000);
    simkit_run(&kit, 9000);
    simkit_ask(&kit, "24 01 01 01 24", 100000);
    assert_int_equal(simkit_look(&kit, 12).torque, GROBO_TORQUE_ON);
    simkit_ask(&kit, "53 09 FA AF 01 00", 5000);
    simkit_run(&kit, 20000);
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "07");
}

/* ---- servos straight on the line ----------------------------------------------------------- */

TEST(bus_read_costs_34_bytes_and_the_delay)
{
    static const uint32_t rates[] = {9600, 38400, 115200, 460800};
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++) {
        const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS,
                                         .baud_bps = rates[i]};
        simkit_start(&kit, &config);
        int64_t t0 = kit.now_us;
        simkit_packet(&kit, "FA AF 01 0F 24 12 00", 26);
        assert_int_equal(kit.n_got, 26);
        assert_int_equal(kit.got_us[0] - t0, 100 + bytes_us(9, rates[i]));
        assert_int_equal(kit.got_us[25] - t0, 100 + bytes_us(34, rates[i]));
    }
}

TEST(board_frames_mean_nothing_to_servos)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS};
    simkit_start(&kit, &config);
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "");
    simkit_ask(&kit, "53 09 FA AF 01 00 24 01 01 01 24", 100000);
    assert_int_equal(simkit_look(&kit, 12).torque, GROBO_TORQUE_ON);
}

TEST(a_stalled_packet_is_forgotten)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS};
    simkit_start(&kit, &config);
    simkit_ask(&kit, "FA AF 01 00 24", 5000);
    simkit_run(&kit, 5000);
    simkit_ask(&kit, "01 01 01 24", 100000);
    assert_int_equal(simkit_look(&kit, 12).torque, GROBO_TORQUE_ON);
    simkit_ask(&kit, "FA AF 01 00 24", 5000);
    simkit_run(&kit, 15000);
    simkit_ask(&kit, "FA AF 01 00 24 01 01 00 25", 100000);
    assert_int_equal(simkit_look(&kit, 12).torque, GROBO_TORQUE_OFF);
    assert_int_equal(kit.sim.stats.stalls, 1);
    grobo_sim_event event;
    assert_int_equal(simkit_events(&kit, GROBO_SIM_STALLED, &event), 1);
    assert_int_equal(event.n_bytes, 5);
}

TEST(talking_over_a_reply_spoils_both)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS};
    simkit_start(&kit, &config);
    simkit_send(&kit, "FA AF 01 0F 24 12 00 38");
    simkit_run(&kit, bytes_us(8, 115200) + 500);
    simkit_send(&kit, "FA AF 02 00 24 01 01 01 27");
    simkit_run(&kit, 100000);
    grobo_sim_event collision;
    assert_true(simkit_events(&kit, GROBO_SIM_COLLISION, &collision) >= 8);
    assert_int_equal(collision.value, 1);
    assert_int_equal(kit.sim.stats.packets, 1);
    assert_int_equal(simkit_look(&kit, simkit_servo(&kit, 2)).torque, GROBO_TORQUE_OFF);
    simkit_packet(&kit, "FA AF 02 00 24 01 01 01", 0);
    assert_int_equal(simkit_look(&kit, simkit_servo(&kit, 2)).torque, GROBO_TORQUE_ON);
}

/* Byte by byte on the wire: overlapping replies of different delays become their AND. */
TEST(replies_that_overlap_spoil_each_other)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS};
    simkit_start(&kit, &config);
    assert_int_equal(grobo_sim_set_register(&kit.sim, 12, GROBO_RS30X_ID, 2), 0);
    assert_int_equal(grobo_sim_set_register(&kit.sim, 12, GROBO_RS30X_DELAY, 2), 0);
    simkit_packet(&kit, "FA AF 02 0F 24 01 00", 9);
    grobo_sim_event collision;
    assert_true(simkit_events(&kit, GROBO_SIM_COLLISION, &collision) > 0);
    assert_int_equal(collision.value, 0);
    assert_true(kit.n_got >= 9);
    assert_true(simkit_events(&kit, GROBO_SIM_COLLISION, NULL) >= 7);
    static const uint8_t clean[] = {0xFD, 0xDF, 0x02, 0x00, 0x24, 0x01, 0x01, 0x00, 0x26};
    assert_memory_not_equal(kit.got, clean, sizeof clean);
}

/* The second payload follows the first at once, right into the reply that S has nobody wait for. */
TEST(the_board_too_may_talk_over_a_reply)
{
    simkit_start(&kit, NULL);
    simkit_ask(&kit, "53 08 FA AF 01 0F 24 12 00 38 53 09 FA AF 02 00 24 01 01 01 27", 100000);
    assert_true(simkit_events(&kit, GROBO_SIM_COLLISION, NULL) >= 8);
    assert_int_equal(kit.sim.stats.frames, 2);
    assert_int_equal(kit.sim.stats.packets, 1);
    assert_int_equal(simkit_look(&kit, simkit_servo(&kit, 2)).torque, GROBO_TORQUE_OFF);
}

TEST(a_crowd_of_one_id_is_only_heard_in_part)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS};
    simkit_start(&kit, &config);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(grobo_sim_set_register(&kit.sim, i, GROBO_RS30X_ID, 5), 0);
        assert_int_equal(grobo_sim_set_register(&kit.sim, i, GROBO_RS30X_DELAY, 100 + i), 0);
    }
    simkit_forget(&kit);
    /* Four questions before the first answer: 80 replies to come. */
    simkit_ask(&kit,
               "FA AF 05 0F 24 12 00 3C FA AF 05 0F 24 12 00 3C"
               "FA AF 05 0F 24 12 00 3C FA AF 05 0F 24 12 00 3C",
               100000);
    assert_int_equal(kit.n_got, GROBO_SIM_TALKS_MAX * 26);
    assert_int_equal(kit.sim.stats.overflows, (80 - GROBO_SIM_TALKS_MAX) * 26);
}

TEST(an_adapter_may_return_what_it_sends)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS,
                                     .echo = true};
    simkit_start(&kit, &config);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "FA AF 01 0F 24 01 00 2B", 100000);
    simkit_expect(&kit, "FA AF 01 0F 24 01 00 2B FD DF 01 00 24 01 01 00 25");
    assert_int_equal(kit.got_us[7] - t0, bytes_us(8, 115200));
    assert_int_equal(kit.got_us[16] - t0, 100 + bytes_us(17, 115200));
    simkit_ask(&kit, "FA AF 01 00 24 01 01 01 24", 100000);
    simkit_expect(&kit, "FA AF 01 00 24 01 01 01 24");
    simkit_ask(&kit, "12 34", 100000);
    simkit_expect(&kit, "12 34");
}

TEST(an_echo_is_of_what_was_on_the_line)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS,
                                     .echo = true};
    simkit_start(&kit, &config);
    simkit_send(&kit, "FA AF 01 0F 24 01 00 2B");
    simkit_run(&kit, bytes_us(8, 115200) + 100 + 10);
    simkit_ask(&kit, "00 00", 100000);
    assert_true(kit.sim.stats.collisions > 0);
    assert_true(kit.got[0] == 0);
    const grobo_sim_config board = {GROBO_SIM_CONFIG_INIT, .echo = true};
    assert_int_equal(grobo_sim_init(&kit.sim, &board, 0), GROBO_ERR_ARG);
}

/* ---- pacing and the cable ------------------------------------------------------------------ */

TEST(an_adapter_hands_over_what_came_together)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .latency_us = 16000};
    simkit_start(&kit, &config);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A", 100000);
    assert_int_equal(kit.n_got, 26);
    assert_int_equal(kit.got_us[0] - t0, 100 + bytes_us(46, 115200) + 16000);
    assert_int_equal(kit.got_us[25], kit.got_us[0]);
    t0 = kit.now_us;
    simkit_ask(&kit, "41 00 41 00", 100000);
    assert_int_equal(kit.n_got, 2);
    assert_int_equal(kit.got_us[0] - t0, bytes_us(3, 115200) + 16000);
    assert_int_equal(kit.got_us[1], kit.got_us[0]);
}

TEST(unpaced_takes_only_the_return_delay)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .unpaced = true};
    simkit_start(&kit, &config);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A", 100000);
    assert_int_equal(kit.n_got, 26);
    assert_in_range(kit.got_us[25] - t0, 100, 102);
}

TEST(a_host_that_never_reads_loses_bytes)
{
    simkit_start(&kit, NULL);
    const uint8_t check[] = {0x41, 0x00};
    for (int i = 0; i < GROBO_SIM_WIRE_BYTES + 5; i++) {
        kit.now_us += 1000;
        assert_int_equal(grobo_sim_rx(&kit.sim, check, 2, kit.now_us), 2);
    }
    grobo_sim_step(&kit.sim, kit.now_us + 1000);
    assert_int_equal(kit.sim.stats.overflows, 5);
    assert_true(grobo_sim_deadline(&kit.sim) <= kit.now_us);
    uint8_t got[GROBO_SIM_WIRE_BYTES + 5];
    assert_int_equal(grobo_sim_tx(&kit.sim, got, sizeof got, kit.now_us), GROBO_SIM_WIRE_BYTES);
    assert_int_equal(kit.sim.stats.tx_bytes, GROBO_SIM_WIRE_BYTES);
}

TEST(time_going_back_counts_as_standing_still)
{
    simkit_start(&kit, NULL);
    simkit_send(&kit, "41 00");
    uint8_t byte;
    assert_int_equal(grobo_sim_tx(&kit.sim, &byte, 1, kit.now_us + 1000), 1);
    const uint8_t check[] = {0x41, 0x00};
    assert_int_equal(grobo_sim_rx(&kit.sim, check, 2, kit.now_us), 2);
    assert_int_equal(grobo_sim_tx(&kit.sim, &byte, 1, kit.now_us + 1000), 0);
    assert_int_equal(grobo_sim_deadline(&kit.sim), kit.now_us + 1000 + bytes_us(2, 115200));
}

TEST(an_unplugged_cable_loses_what_is_on_the_line)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 03 00 24 01 01 01", 0);
    simkit_packet(&kit, "FA AF 03 00 1E 04 01 84 03 64 00", 0);
    simkit_send(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A");
    simkit_run(&kit, 4000);
    grobo_sim_plug(&kit.sim, false, kit.now_us);
    assert_true(grobo_sim_hung_up(&kit.sim));
    simkit_run(&kit, 500000);
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "");
    grobo_sim_plug(&kit.sim, true, kit.now_us);
    assert_false(grobo_sim_hung_up(&kit.sim));
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "07");
    simkit_run(&kit, 1000000);
    assert_int_equal(simkit_look(&kit, 14).angle_mdeg, 90000);
}
