/* SPDX-License-Identifier: MIT */
/* What can and what cannot be opened, and who has it. */
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <grobo/core/serial.h>

#include "tests/support/files.h"
#include "tests/support/folder.h"
#include "tests/support/line.h"
#include "tests/support/nobody.h"
#include "tests/support/test.h"

/* Opens a device; returns the result, leaves the cause's text. */
static int try_open(const char *device, char *text, size_t text_bytes)
{
    const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = device};
    grobo_serial *serial;
    int r;

    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    r = grobo_serial_open(serial);
    if (r < 0) {
        assert_false(grobo_serial_is_open(serial));
    }
    snprintf(text, text_bytes, "%s", grobo_serial_cause(serial)->text);
    grobo_serial_free(serial);
    return r;
}

TEST(no_descriptor_is_left)
{
    char text[GROBO_CAUSE_MAX_BYTES];
    struct rlimit before;
    struct rlimit none;
    int serial;
    int tcp;

    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    none = before;
    none.rlim_cur = 0;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    serial = try_open("/dev/zero", text, sizeof text);
    tcp = try_open("tcp:127.0.0.1:1", text, sizeof text);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    assert_int_equal(serial, GROBO_ERR_NOMEM);
    assert_int_equal(tcp, GROBO_ERR_NOMEM);
}

TEST(what_is_no_serial_port_is_refused)
{
    static const char *const names[] = {"file"};
    const char *file;
    char text[GROBO_CAUSE_MAX_BYTES];

    (void)folder_set_up();
    file = in_folder(names[0]);
    assert_int_equal(try_open(file, text, sizeof text), GROBO_ERR_NOENT);
    assert_string_equal(text, "stat: No such file or directory");
    put_file(file, "");
    assert_int_equal(try_open(file, text, sizeof text), GROBO_ERR_TYPE);
    assert_int_equal(try_open(folder, text, sizeof text), GROBO_ERR_ISDIR);
    assert_int_equal(try_open("/dev/null", text, sizeof text), GROBO_ERR_TYPE);
    assert_int_equal(try_open("", text, sizeof text), GROBO_ERR_NOENT);
    folder_remove(names, 1);
}

/* A child that opens the device and keeps it until it is killed. */
static pid_t start_holder(const char *device)
{
    int ends[2];
    char byte = 0;
    pid_t pid;

    assert_int_equal(pipe(ends), 0);
    pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = device};
        grobo_serial *serial;

        if (grobo_serial_new(&config, &serial) == GROBO_OK &&
            grobo_serial_open(serial) == GROBO_OK && write(ends[1], "o", 1) == 1) {
            pause();
        }
        _exit(1);
    }
    assert_int_equal(close(ends[1]), 0);
    assert_int_equal(read(ends[0], &byte, 1), 1);
    assert_int_equal(close(ends[0]), 0);
    return pid;
}

static void stop_holder(pid_t pid)
{
    int status;

    assert_int_equal(kill(pid, SIGKILL), 0);
    assert_int_equal(waitpid(pid, &status, 0), pid);
}

TEST(a_second_open_is_refused_and_names_the_holder)
{
    test_line line;
    char text[GROBO_CAUSE_MAX_BYTES];
    char wanted[GROBO_CAUSE_MAX_BYTES];
    char name[64];
    pid_t pid;

    test_line_open(&line);
    pid = start_holder(line.device);
    assert_int_equal(try_open(line.device, text, sizeof text), GROBO_ERR_BUSY);
    if (grobo_port_owner(line.device, name, sizeof name) == 0) {
        print_message("the system does not tell who holds a lock: the name is not tested\n");
    } else {
        assert_int_equal(grobo_port_owner(line.device, name, sizeof name), pid);
        snprintf(wanted, sizeof wanted, "held by %s (pid %d)", name, (int)pid);
        assert_string_equal(text, wanted);
    }
    stop_holder(pid);
    /* A holder that was killed leaves nothing behind. */
    assert_int_equal(try_open(line.device, text, sizeof text), GROBO_OK);
    assert_int_equal(grobo_port_owner(line.device, name, sizeof name), 0);
    test_line_close(&line);
}

static int open_and_close(void *device)
{
    char text[GROBO_CAUSE_MAX_BYTES];

    return try_open(device, text, sizeof text);
}

TEST(without_permission_it_is_refused)
{
    test_line line;

    test_line_open(&line);
    assert_int_equal(chmod(line.device, 0600), 0);
    assert_int_equal(as_nobody(open_and_close, line.device), GROBO_ERR_PERM);
    assert_int_equal(chmod(line.device, 0666), 0);
    assert_int_equal(as_nobody(open_and_close, line.device), GROBO_OK);
    test_line_close(&line);
}

TEST(a_killed_holder_does_not_lock_other_users_out)
{
    test_line line;

    test_line_open(&line);
    assert_int_equal(chmod(line.device, 0666), 0);
    stop_holder(start_holder(line.device));
    assert_int_equal(as_nobody(open_and_close, line.device), GROBO_OK);
    test_line_close(&line);
}

TEST(the_line_is_raw_8n1)
{
    test_line line;
    grobo_serial *serial;
    struct termios tio;
    uint8_t byte = 0;
    grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = line.device};

    test_line_open(&line);
    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    assert_int_equal(tcgetattr(grobo_serial_handle(serial), &tio), 0);
    assert_int_equal(tio.c_cflag & CSIZE, CS8);
    assert_int_equal(tio.c_cflag & (CSTOPB | PARENB | CRTSCTS), 0);
    assert_int_equal(tio.c_lflag & (ICANON | ECHO | ISIG), 0);
    assert_int_equal(tio.c_iflag & (IXON | IXOFF | ICRNL | INLCR | ISTRIP), 0);
    assert_int_equal(tio.c_oflag & OPOST, 0);
    assert_int_equal(cfgetospeed(&tio), B115200);
    assert_int_equal(grobo_serial_baud(serial), GROBO_BAUD_DEFAULT_BPS);
    assert_int_equal(grobo_serial_write(serial, "x", 1), 1);
    test_line_read(&line, &byte, 1);
    assert_int_equal(byte, 'x');
    grobo_serial_free(serial);
    test_line_close(&line);
}
