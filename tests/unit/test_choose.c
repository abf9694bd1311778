/* SPDX-License-Identifier: MIT */
/* Which ports `grctl -d auto` tries, in which order, and what it only names. */
#include <stdio.h>
#include <string.h>

#include "tests/support/test.h"
#include "tools/grctl/conn/choose.h"

static choice all;

static void take(const char *path, const char *by_id, int vendor, int open_result)
{
    grobo_port_info info = {.usb_vendor = vendor, .open_result = open_result};

    snprintf(info.path, sizeof info.path, "%s", path);
    snprintf(info.by_id, sizeof info.by_id, "%s", by_id);
    assert_int_equal(choose_take(&all, &info), 0);
}

static void take_three(void)
{
    choose_begin(&all);
    take("/dev/ttyUSB0", "/by-id/a", 0x403, GROBO_OK);
    take("/dev/ttyUSB1", "/by-id/b", 0x403, GROBO_OK);
    take("/dev/ttyUSB2", "", 0x403, GROBO_OK);
}

static void expect(const char *first, const char *second, const char *third)
{
    assert_string_equal(all.scan[0], first);
    assert_string_equal(all.scan[1], second);
    assert_string_equal(all.scan[2], third);
    assert_null(all.scan[3]);
}

TEST(the_port_used_last_comes_first)
{
    take_three();
    choose_end(&all, "");
    expect("/dev/ttyUSB0", "/dev/ttyUSB1", "/dev/ttyUSB2");
    take_three();
    choose_end(&all, "/by-id/b");
    expect("/dev/ttyUSB1", "/dev/ttyUSB0", "/dev/ttyUSB2");
    take_three();
    choose_end(&all, "/dev/ttyUSB2");
    expect("/dev/ttyUSB2", "/dev/ttyUSB0", "/dev/ttyUSB1");
    take_three();
    choose_end(&all, "/by-id/gone");
    expect("/dev/ttyUSB0", "/dev/ttyUSB1", "/dev/ttyUSB2");
}

TEST(uarts_of_the_board_are_named_but_not_tried)
{
    grobo_port_info console = {.path = "/dev/ttyAMA10", .usb_vendor = -1, .console = true};
    grobo_port_info bluetooth = {.path = "/dev/ttyAMA0", .usb_vendor = -1, .bluetooth = true};

    choose_begin(&all);
    take("/dev/ttyTHS1", "", -1, GROBO_OK);
    (void)choose_take(&all, &console);
    (void)choose_take(&all, &bluetooth);
    choose_end(&all, "/dev/ttyTHS1");
    assert_null(all.scan[0]);
    assert_int_equal(all.n_uart, 1);
    assert_string_equal(all.uart[0].path, "/dev/ttyTHS1");
}

TEST(blocked_adapters_are_kept_with_their_fix)
{
    char fix[256];

    choose_begin(&all);
    take("/dev/ttyUSB0", "", 0x403, GROBO_ERR_PERM);
    take("/dev/ttyACM0", "", -1, GROBO_ERR_BUSY); /* without sysfs: an adapter by its name */
    all.blocked[1].owner_pid = 42;
    snprintf(all.blocked[1].owner_name, sizeof all.blocked[1].owner_name, "minicom");
    choose_end(&all, "");
    assert_null(all.scan[0]);
    assert_int_equal(all.n_blocked, 2);
    choose_fix(&all.blocked[0], fix, sizeof fix);
    assert_string_equal(fix, "sudo usermod -aG dialout $USER, and log in again");
    choose_fix(&all.blocked[1], fix, sizeof fix);
    assert_string_equal(fix, "end minicom (pid 42)");
}
