/* SPDX-License-Identifier: MIT */
/* Time on the wires: the board's line, the servos' bus, both wirings, to the microsecond. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "simkit.h"

static simkit kit;

/* End of the n-th byte time at a rate, rounded up to the microsecond that sees it. */
static int64_t bytes_us(int64_t n, int64_t bps)
{
    return (n * 10000000 + bps - 1) / bps;
}

static void check_costs_three_bytes(void **state)
{
    (void)state;
    simkit_start(&kit, NULL);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "41 00", 100000);
    simkit_expect(&kit, "07");
    assert_int_equal(kit.got_us[0] - t0, bytes_us(3, 115200));
    assert_true(grobo_sim_deadline(&kit.sim) == GROBO_NEVER_US);
}

static void read_costs_71_bytes_and_the_delay(void **state)
{
    (void)state;
    simkit_start(&kit, NULL);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A", 100000);
    assert_int_equal(kit.n_got, 26);
    for (int i = 0; i < 26; i++) {
        assert_int_equal(kit.got_us[i] - t0, 100 + bytes_us(46 + i, 115200));
    }
    assert_int_equal(kit.got_us[25] - t0, 6264);
}

static void return_delay_is_waited(void **state)
{
    (void)state;
    simkit_start(&kit, NULL);
    simkit_ask(&kit, "53 09 FA AF 01 00 07 01 01 12 14", 100000);
    int64_t t0 = kit.now_us;
    simkit_ask(&kit, "54 09 FA AF 01 0F 24 12 00 38 1A", 100000);
    assert_int_equal(kit.n_got, 26);
    assert_int_equal(kit.got_us[25] - t0, 1000 + bytes_us(71, 115200));
}

static void pose_frame_is_stored_and_forwarded(void **state)
{
    (void)state;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(check_costs_three_bytes),
        cmocka_unit_test(read_costs_71_bytes_and_the_delay),
        cmocka_unit_test(return_delay_is_waited),
        cmocka_unit_test(pose_frame_is_stored_and_forwarded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
