/* SPDX-License-Identifier: MIT */
/*
 * What only a real driver can show of a serial port: speeds it has and has not, low latency, its
 * place in the list of ports. GROBO_TEST_SERIAL names two ports joined by a cable, and
 * GROBO_TEST_DRIVER the first one's driver, 8250 or ftdi_sio.
 */
#include <linux/serial.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <grobo/core/serial.h>

#include "tests/support/line.h"
#include "tests/support/test.h"

/* Speeds are of both kinds: with a B constant and without. The lists end with 0. */
typedef struct driver {
    const char *name;
    int takes_bps[10];
    int refuses_bps[6];
    int usb_vendor, usb_product;
    const char *by_id; /* part of the name in /dev/serial/by-id, "" for none */
    int latency_ms;    /* while open; -1 for no such timer */
} driver;

/* An 8250 divides 115200 by a whole number, whatever its driver says; an FT232BM ends at 3 MHz. */
static const driver drivers[] = {
    {.name = "8250",
     .takes_bps = {50, 300, 9600, 38400, 57600, 115200, 14400, 12800, 28500},
     .refuses_bps = {460800, 230400, 1000000, 100000, 31250},
     .usb_vendor = -1,
     .usb_product = -1,
     .by_id = "",
     .latency_ms = -1},
    {.name = "ftdi_sio",
     .takes_bps = {300, 9600, 57600, 115200, 460800, 1000000, 3000000, 250000, 31250},
     .refuses_bps = {4000000, 3500000, 5000000},
     .usb_vendor = 0x0403,
     .usb_product = 0x6001,
     .by_id = "/dev/serial/by-id/usb-",
     .latency_ms = 1},
};

static const driver *expected;
static test_line line;
static grobo_serial *serial;

static int set_up(void)
{
    serial = test_line_open_serial(&line, 2000);
    return 0;
}

static int tear_down(void)
{
    grobo_serial_free(serial);
    test_line_close(&line);
    return 0;
}

static const test_fixture on_line[] = {{NULL, set_up, tear_down}};

static void assert_bytes_pass(void)
{
    char back[5];

    assert_int_equal(grobo_serial_send(serial, "there", 5), 5);
    test_line_read(&line, back, 5);
    assert_memory_equal(back, "there", 5);
    test_line_write(&line, "again", 5);
    assert_int_equal(grobo_serial_receive(serial, back, 5), 5);
    assert_memory_equal(back, "again", 5);
}

TEST_WITH(on_line, speeds_it_has_are_set_on_an_open_port)
{
    for (const int *bps = expected->takes_bps; *bps != 0; bps++) {
        int r = grobo_serial_set_baud(serial, *bps);

        print_message("%d bps: %d %s\n", *bps, r, r < 0 ? grobo_serial_cause(serial)->text : "");
        assert_true(r > 0 && abs(r - *bps) * 50 <= *bps);
        assert_int_equal(grobo_serial_baud(serial), *bps);
    }
    assert_int_equal(grobo_serial_set_baud(serial, 115200), 115200);
    assert_bytes_pass();
}

TEST_WITH(on_line, speeds_it_has_not_are_refused_and_leave_the_old_one)
{
    assert_int_equal(grobo_serial_set_baud(serial, 57600), 57600);
    for (const int *bps = expected->refuses_bps; *bps != 0; bps++) {
        int r = grobo_serial_set_baud(serial, *bps);

        print_message("%d bps: %d %s\n", *bps, r, r < 0 ? grobo_serial_cause(serial)->text : "");
        assert_int_equal(r, GROBO_ERR_UNSUPPORTED);
        assert_non_null(strstr(grobo_serial_cause(serial)->text, "device takes "));
        assert_int_equal(grobo_serial_baud(serial), 57600);
        assert_true(grobo_serial_is_open(serial));
    }
    assert_int_equal(grobo_serial_set_baud(serial, 115200), 115200);
    assert_bytes_pass();
}

TEST_WITH(on_line, opening_asks_for_low_latency)
{
    struct serial_struct settings;

    assert_int_equal(grobo_serial_low_latency(serial), GROBO_OK);
    assert_int_equal(ioctl(grobo_serial_handle(serial), TIOCGSERIAL, &settings), 0);
    assert_true((settings.flags & (int)ASYNC_LOW_LATENCY) != 0);
}

static int keep(void *ctx, const grobo_port_info *info)
{
    grobo_port_info *found = ctx;

    if (strcmp(info->path, line.device) != 0) {
        return 0;
    }
    *found = *info;
    return 1;
}

TEST_WITH(on_line, the_list_describes_it)
{
    grobo_port_info info;

    assert_int_equal(grobo_port_list(keep, &info), 1);
    assert_int_equal(info.usb_vendor, expected->usb_vendor);
    assert_int_equal(info.usb_product, expected->usb_product);
    assert_int_equal(strncmp(info.by_id, expected->by_id, strlen(expected->by_id)), 0);
    assert_int_equal(info.latency_ms, expected->latency_ms);
    assert_int_equal(info.owner_pid, getpid());
    assert_int_equal(info.open_result, GROBO_ERR_BUSY);
    grobo_serial_close(serial);
    assert_int_equal(grobo_port_list(keep, &info), 1);
    assert_int_equal(info.open_result, GROBO_OK);
}

/* The system waits 30 s at close for a line that takes nothing. */
TEST_WITH(on_line, closing_waits_no_longer_than_the_line_needs)
{
    static uint8_t block[65536];
    int64_t start_us = grobo_now_us();
    int taken = sizeof block;

    test_line_close(&line);
    while (taken == sizeof block && grobo_now_us() - start_us < 2000000) {
        taken = grobo_serial_write(serial, block, sizeof block);
    }
    if (taken == sizeof block) {
        print_message("this line takes bytes faster than they can be written\n");
        skip();
    }
    start_us = grobo_now_us();
    grobo_serial_close(serial);
    print_message("closed in %lld ms\n", (long long)(grobo_now_us() - start_us) / 1000);
    assert_true(grobo_now_us() - start_us < 2000000);
}

int main(int argc, char **argv)
{
    const char *name = getenv("GROBO_TEST_DRIVER");

    for (size_t i = 0; name != NULL && i < sizeof drivers / sizeof drivers[0]; i++) {
        if (strcmp(drivers[i].name, name) == 0) {
            expected = &drivers[i];
        }
    }
    if (expected == NULL || getenv("GROBO_TEST_SERIAL") == NULL) {
        fprintf(stderr, "GROBO_TEST_SERIAL and GROBO_TEST_DRIVER say what to test\n");
        return 2;
    }
    return test_main(argc, argv);
}
