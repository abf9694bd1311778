/* SPDX-License-Identifier: MIT */
/* The Win32 port: names of COM ports, the lock that names its holder, what errors mean. */
#include <stdlib.h>
#include <string.h>

#include "ports/win32/win32.h"
#include "tests/support/test.h"

static grobo_os_cause cause;

TEST(a_port_has_three_names)
{
    static const char *const names[] = {"COM10", "com10", "\\\\.\\COM10", "\\\\.\\com10"};
    char text[64];

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        assert_int_equal(grobo_port_identity(names[i], text, sizeof text), GROBO_OK);
        assert_string_equal(text, "COM10");
        assert_int_equal(grobo_i_win32_path(names[i], text, sizeof text), GROBO_OK);
        assert_int_equal(_stricmp(text, "\\\\.\\COM10"), 0);
    }
    assert_int_equal(grobo_port_identity("tcp:Robot:1", text, sizeof text), GROBO_OK);
    assert_string_equal(text, "tcp:Robot:1");
    assert_int_equal(grobo_port_identity("COM10", text, 5), GROBO_ERR_SPACE);
    assert_int_equal(grobo_port_identity(NULL, text, sizeof text), GROBO_ERR_ARG);
    assert_int_equal(grobo_i_win32_path("", text, sizeof text), GROBO_ERR_ARG);
    assert_int_equal(grobo_i_win32_path("\\\\.\\", text, sizeof text), GROBO_ERR_ARG);
}

TEST(what_is_no_port_is_told_apart)
{
    const grobo_port_ops *ops = grobo_port_serial_ops();
    grobo_port *port = malloc(ops->size_bytes);

    assert_non_null(port);
    assert_int_equal(ops->open(port, "", 115200, &cause), GROBO_ERR_ARG);
    assert_int_equal(ops->open(port, "COM250", 115200, &cause), GROBO_ERR_NOENT);
    assert_int_equal(cause.code, ERROR_FILE_NOT_FOUND);
    assert_int_equal(ops->open(port, "C:\\windows", 115200, &cause), GROBO_ERR_ISDIR);
    assert_int_equal(ops->open(port, "C:\\windows\\win.ini", 115200, &cause), GROBO_ERR_TYPE);
    assert_int_equal(ops->open(port, "NUL", 115200, &cause), GROBO_ERR_TYPE);
    free(port);
}

TEST(a_lock_names_its_holder)
{
    char name[64] = "nobody";
    HANDLE lock = grobo_i_win32_lock("COM77");

    assert_non_null(lock);
    assert_null(grobo_i_win32_lock("\\\\.\\com77"));
    assert_int_equal(grobo_port_owner("com77", name, sizeof name), GetCurrentProcessId());
    assert_string_equal(name, "test_win32_serial.exe");
    assert_int_equal(grobo_port_owner("COM7", name, sizeof name), 0);
    grobo_i_win32_unlock(lock);
    assert_int_equal(grobo_port_owner("COM77", name, sizeof name), 0);
}

TEST(every_way_to_lose_a_device_is_unplugged)
{
    static const DWORD codes[] = {ERROR_ACCESS_DENIED,     ERROR_NOT_READY,
                                  ERROR_BAD_COMMAND,       ERROR_GEN_FAILURE,
                                  ERROR_BROKEN_PIPE,       433 /* ERROR_NO_SUCH_DEVICE */,
                                  ERROR_OPERATION_ABORTED, ERROR_DEVICE_NOT_CONNECTED,
                                  WSAECONNRESET,           WSAECONNABORTED};

    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        assert_int_equal(grobo_i_win32_fail(&cause, codes[i], "read"), GROBO_ERR_UNPLUGGED);
        assert_int_equal(cause.code, codes[i]);
        assert_int_equal(strncmp(cause.text, "read: ", 6), 0);
        assert_true(strlen(cause.text) > 6);
        assert_null(strpbrk(cause.text, "\r\n"));
    }
    assert_int_equal(grobo_i_win32_fail(&cause, ERROR_CRC, "read"), GROBO_ERR_IO);
}

static int count(void *ctx, const grobo_port_info *info)
{
    assert_true(strlen(info->path) > 0);
    assert_true(info->usb_vendor >= -1);
    ++*(int *)ctx;
    return 0;
}

TEST(the_ports_of_this_machine_can_be_listed)
{
    int n = 0;
    int listed = grobo_port_list(count, &n);

    assert_int_equal(listed, n);
}
