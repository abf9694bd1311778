/* SPDX-License-Identifier: MIT */
/* What silent servos cost a scan, in virtual time: the wire's own time, and 4 ms each. */
#include <stdint.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"
#include "tools/grctl/conn/wire.h"

enum { BAUD_BPS = 115200, FIRST_ID = 21, SILENT = 20, IDENTITY_BYTES = 3, SILENCE_US = 4000 };

static grobo_test_rig rig;

static void scan(grobo_wiring wiring, int baud_bps)
{
    const grobo_driver *driver = grobo_gr001_driver(wiring);
    uint32_t wire_us = 0;
    assert_int_equal(wire_read_us(driver, baud_bps, IDENTITY_BYTES, &wire_us), 0);
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = GROBO_SENSE_NEVER,
                                 .retries = -1, .timeout_us = wire_us + WIRE_SILENT_MARGIN_US,
                                 .bus.baud_bps = (uint32_t)baud_bps};
    rig_start_driver(&rig, driver, &config, NULL);
    int64_t begun_us = rig.now_us;
    for (int i = 0; i < SILENT; i++) {
        grobo_register_io io = {.id = (uint8_t)(FIRST_ID + i), .length = IDENTITY_BYTES};
        rig_expect(&rig, grobo_robot_registers(&rig.robot, &io), GROBO_ERR_TIMEOUT);
    }
    assert_in_range(rig.now_us - begun_us, (uint64_t)SILENT * wire_us,
                    (uint64_t)SILENT * (wire_us + SILENCE_US));
    print_message("# %d silent ids at %d bps: %.1f ms, of which the wire %.1f ms\n", SILENT,
                  baud_bps, (double)(rig.now_us - begun_us) / 1e3, SILENT * wire_us / 1e3);
    grobo_register_io io = {.id = 1, .length = IDENTITY_BYTES};
    rig_expect(&rig, grobo_robot_registers(&rig.robot, &io), GROBO_OK);
}

TEST(silent_servos_cost_4_ms_each_through_the_board)
{
    scan(GROBO_WIRING_BOARD, BAUD_BPS);
}

TEST(silent_servos_cost_4_ms_each_on_the_bus)
{
    scan(GROBO_WIRING_BUS, BAUD_BPS);
}
