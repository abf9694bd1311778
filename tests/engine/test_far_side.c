/* SPDX-License-Identifier: MIT */
/* The far side that judges stops: it answers the frames that the manuals print, and its shafts go
 * where they are sent, in their time. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/far_side.h"
#include "tests/support/test.h"

enum { BEGIN_US = 1000000, SECOND_US = 1000000 };

static far_side far;
static int64_t now_us;

static int bytes_of(const char *hex, uint8_t *bytes)
{
    int n = 0;
    for (char *end = NULL; *hex != '\0'; hex = end) {
        bytes[n++] = (uint8_t)strtoul(hex, &end, 16);
    }
    return n;
}

static void send(const char *hex)
{
    uint8_t bytes[FAR_FRAME_BYTES];
    far_take(&far, bytes, bytes_of(hex, bytes), now_us);
}

static void expect(const char *hex)
{
    uint8_t wanted[FAR_FRAME_BYTES], got[FAR_FRAME_BYTES];
    int n = bytes_of(hex, wanted);
    now_us += 30000;
    assert_int_equal(far_give(&far, got, (int)sizeof got, now_us), n);
    assert_memory_equal(got, wanted, (size_t)n);
}

static void begin(const far_family *family)
{
    now_us = BEGIN_US;
    far_begin(&far, family, 3, now_us);
}

/* Frames of the manuals and of clients, and what comes back. */
TEST(printed_frames_are_answered)
{
    begin(&far_board);
    send("41 00");
    expect("07");
    send("54 09 FA AF 01 0F 30 02 00 3C 0A"); /* current of motor 1 */
    expect("FD DF 01 00 30 02 01 14 00 26");
    begin(&far_bus);
    send("FA AF 01 01 24 01 01 01 25"); /* torque, asks for an acknowledgement */
    expect("07");
    assert_int_equal(far.joint[0].torque, 1);
    begin(&far_dxl2);
    far.joint[0].reg[0] = 6; /* XM430-W210, as the manual's example has it */
    far.joint[0].reg[6] = 0x26;
    send("FF FF FD 00 01 03 00 01 19 4E");
    expect("FF FF FD 00 01 07 00 55 00 06 04 26 65 5D");
    begin(&far_dxl1);
    send("FF FF 01 02 01 FB");
    expect("FF FF 01 02 00 FC");
    send("FF FF 01 04 02 2B 01 CC"); /* temperature */
    expect("FF FF 01 03 00 23 D8");
    begin(&far_mx);
    send("FF FF 01 04 02 00 02 F6"); /* model */
    expect("FF FF 01 04 00 1D 00 DD");
    send("FF FF FE 09 92 00 02 01 1E 02 02 24 1D"); /* goal of 1, position of 2 */
    expect("FF FF 01 04 00 00 08 F2 FF FF 02 04 00 00 08 F1");
    begin(&far_scs);
    send("FF FF 01 04 02 38 02 BE"); /* position, high byte first */
    expect("FF FF 01 04 00 02 00 F8");
    send("FF FF FE 05 82 38 02 01 3F"); /* they have no read of many */
    expect("");
    begin(&far_ics);
    send("81 3A 4C");
    expect("81 3A 4C 01 3A 4C"); /* its echo first */
    send("A1 01");
    expect("A1 01 21 01 1E");
    begin(&far_lx16a);
    send("55 55 01 03 1C DF");
    expect("55 55 01 05 1C F4 01 E8");
}

TEST(a_broken_frame_is_not_obeyed)
{
    begin(&far_bus);
    send("FA AF 01 01 24 01 01 01 2C");
    expect("");
    assert_int_equal(far.joint[0].torque, 0);
    assert_int_equal(far.broken_frames, 1);
    begin(&far_lx16a);
    send("55 55 01 03 1C DE");
    expect("");
}

/* ---- shafts ---------------------------------------------------------------------------------- */

/* Goals of 90 degrees, or what comes near, in a second or at 90 deg/s; torque first. */
static const struct {
    const far_family *family;
    const char *torque, *goal;
} ways[] = {
    {&far_bus, "FA AF 03 00 24 01 01 01 26", "FA AF 03 00 1E 04 01 84 03 64 00 FB"},
    {&far_board, "53 09 FA AF 03 00 24 01 01 01 26", "53 0C FA AF 03 00 1E 04 01 84 03 64 00 FB"},
    {&far_sts, "FF FF 03 04 03 28 01 CC", "FF FF 03 09 03 2A 00 0C 00 00 00 04 B6"},
    {&far_mx, "FF FF 03 04 03 18 01 DC", "FF FF 03 07 03 1E 00 0C 84 00 44"},
    {&far_scs, "FF FF 03 04 03 28 01 CC", "FF FF 03 09 03 2A 03 33 03 E8 00 00 A5"},
    {&far_lx16a, "55 55 03 04 1F 01 D8", "55 55 03 07 01 6B 03 E8 03 9B"},
};

TEST(a_shaft_goes_straight_in_its_time)
{
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        begin(ways[i].family);
        send(ways[i].torque);
        now_us += 20000;
        send(ways[i].goal);
        int64_t due_us = far.frame[0].due_us + ways[i].family->dead_us;
        assert_int_equal(far.n_frames, 1);
        far_step(&far, due_us + SECOND_US / 2);
        double half_deg = far_angle(&far, 2, due_us + SECOND_US / 2);
        assert_true(fabs(half_deg - 45) < 0.5);
        assert_true(far_turns(&far, 2, due_us + SECOND_US / 2));
        assert_true(fabs(far_angle(&far, 2, due_us + SECOND_US * 11 / 10) - 90) < 0.5);
        assert_false(far_turns(&far, 2, due_us + SECOND_US * 11 / 10));
        assert_int_equal(far.broken_frames, 0);
    }
}

/* Acceleration 1 is 8.79 deg/s2: after a second it turns at that speed and has gone half of it. */
TEST(a_shaft_with_ramps_speeds_up_evenly)
{
    begin(&far_sts);
    send("FF FF 03 0B 03 28 01 01 00 0C 00 00 00 04 B4");
    int64_t due_us = far.frame[0].due_us + far_sts.dead_us;
    far_step(&far, due_us + SECOND_US);
    assert_true(fabs(far_angle(&far, 2, due_us + SECOND_US) - 8.79 / 2) < 0.1);
    assert_true(fabs(far.joint[2].dps - 8.79) < 0.1);
    assert_int_equal(far.broken_frames, 0);
}

TEST(a_goal_wakes_who_it_wakes)
{
    begin(&far_sts);
    send("FF FF 03 09 03 2A 00 0C 00 00 00 04 B6");
    now_us += SECOND_US / 2;
    assert_true(far_angle(&far, 2, now_us) == 0 || far_turns(&far, 2, now_us));
    far_step(&far, now_us);
    assert_int_equal(far.joint[2].torque, 1);
    begin(&far_bus);
    send("FA AF 03 00 1E 04 01 84 03 64 00 FB");
    now_us += SECOND_US;
    far_step(&far, now_us);
    assert_int_equal(far.joint[2].torque, 0);
    assert_true(far_angle(&far, 2, now_us) == 0);
}

/* The first motor frame is lost and nobody takes it; the second is obeyed. */
TEST(the_frame_that_was_chosen_is_lost)
{
    begin(&far_lx16a);
    far.lose_motor = 0;
    send("55 55 03 07 01 6B 03 E8 03 9B");
    now_us += SECOND_US;
    far_step(&far, now_us);
    assert_true(far_angle(&far, 2, now_us) == 0);
    assert_true(far.joint[2].missed);
    assert_int_equal(far.lost_frames, 1);
    send("55 55 03 07 01 6B 03 E8 03 9B");
    far_step(&far, now_us + 2 * SECOND_US);
    now_us += 2 * SECOND_US;
    assert_true(fabs(far_angle(&far, 2, now_us) - 90) < 0.5);
    assert_true(far.joint[2].missed); /* the host has not heard of it */
    send("55 55 03 03 1C DD");
    expect("55 55 03 05 1C 6B 03 6D");
    assert_false(far.joint[2].missed);
}

/* 100 ms without a word: it stops, and takes no goal until its watchdog is cleared. */
TEST(a_watchdog_stops_its_shaft)
{
    begin(&far_dxl2);
    far_foreign(&far, 2, 90, 90, now_us);
    far.joint[2].reg[98] = 5;
    double at_deg = far_angle(&far, 2, now_us + SECOND_US);
    assert_true(fabs(at_deg - 9) < 0.1);
    assert_int_equal(far.joint[2].reg[98], 0xFF);
}
