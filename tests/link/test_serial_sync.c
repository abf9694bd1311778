/* SPDX-License-Identifier: MIT */
/* The serial port without a loop: rows SC01..SC22 of the original, on a pty or a cable. */
#include <fcntl.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <grobo/core/serial.h>

#include "tests/support/line.h"
#include "tests/support/test.h"

static test_line line;
static grobo_serial *serial;

static int set_up(void)
{
    serial = test_line_open_serial(&line, 30);
    return 0;
}

static int tear_down(void)
{
    grobo_serial_free(serial);
    test_line_close(&line);
    return 0;
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

TEST(a_port_without_a_device_waits_for_one)
{
    grobo_serial *made;
    char name[] = "/dev/somewhere";

    assert_int_equal(grobo_serial_new(NULL, &made), GROBO_OK);
    assert_null(grobo_serial_device(made));
    assert_int_equal(grobo_serial_baud(made), 115200);
    assert_int_equal(grobo_serial_get_mode(made), GROBO_SERIAL_SYNC);
    assert_int_equal(grobo_serial_handle(made), GROBO_HANDLE_NULL);
    assert_false(grobo_serial_is_open(made));
    assert_int_equal(grobo_serial_open(made), GROBO_ERR_ARG);
    assert_int_equal(grobo_serial_set_device(made, name), GROBO_OK);
    name[5] = 'X'; /* it is a copy */
    assert_string_equal(grobo_serial_device(made), "/dev/somewhere");
    assert_int_equal(grobo_serial_set_device(made, NULL), GROBO_OK);
    assert_null(grobo_serial_device(made));
    grobo_serial_free(made);
    grobo_serial_free(NULL);
}

TEST(bad_configurations_are_refused)
{
    char long_name[GROBO_DEVICE_MAX_BYTES + 1];
    grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .baud_bps = -1};
    grobo_serial *made = NULL;

    memset(long_name, 'x', sizeof long_name - 1);
    long_name[sizeof long_name - 1] = '\0';
    assert_int_equal(grobo_serial_new(&config, &made), GROBO_ERR_ARG);
    config = (grobo_serial_config){GROBO_SERIAL_CONFIG_INIT, .silence_ms = -1};
    assert_int_equal(grobo_serial_new(&config, &made), GROBO_ERR_ARG);
    config = (grobo_serial_config){GROBO_SERIAL_CONFIG_INIT, .mode = GROBO_SERIAL_ASYNC};
    assert_int_equal(grobo_serial_new(&config, &made), GROBO_ERR_ARG);
    config = (grobo_serial_config){GROBO_SERIAL_CONFIG_INIT,
                                   .tx_queue_bytes = GROBO_SERIAL_QUEUE_BYTES + 1};
    assert_int_equal(grobo_serial_new(&config, &made), GROBO_ERR_CAP);
    config = (grobo_serial_config){GROBO_SERIAL_CONFIG_INIT, .device = long_name};
    assert_int_equal(grobo_serial_new(&config, &made), GROBO_ERR_CAP);
    assert_int_equal(grobo_serial_new(NULL, NULL), GROBO_ERR_ARG);
    assert_null(made);
}

TEST_WITH(fixture, a_closed_port_says_so)
{
    uint8_t byte = 0;
    grobo_handle handle = grobo_serial_handle(serial);

    assert_int_equal(write(handle, "h", 1), 1); /* it is the line's */
    test_line_read(&line, &byte, 1);
    assert_int_equal(byte, 'h');
    grobo_serial_close(serial);
    assert_int_equal(fcntl(handle, F_GETFD), -1);
    grobo_serial_close(serial);
    assert_false(grobo_serial_is_open(serial));
    assert_int_equal(grobo_serial_handle(serial), GROBO_HANDLE_NULL);
    assert_int_equal(grobo_serial_read(serial, &byte, 1), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_serial_write(serial, &byte, 1), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_serial_receive(serial, &byte, 1), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_serial_send(serial, &byte, 1), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_serial_waiting(serial), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_serial_discard(serial), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_serial_set_low_latency(serial), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_serial_low_latency(serial), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    assert_true(grobo_serial_is_open(serial));
    assert_true(grobo_serial_handle(serial) >= 0);
    assert_int_equal(grobo_serial_open(serial), GROBO_ERR_STATE);
}

TEST_WITH(fixture, an_open_port_keeps_device_and_mode)
{
    assert_int_equal(grobo_serial_set_device(serial, "/dev/other"), GROBO_ERR_STATE);
    assert_string_equal(grobo_serial_device(serial), line.device);
    assert_int_equal(grobo_serial_set_mode(serial, GROBO_SERIAL_SYNC), GROBO_ERR_STATE);
    grobo_serial_close(serial);
    assert_int_equal(grobo_serial_set_mode(serial, GROBO_SERIAL_SYNC), GROBO_OK);
    assert_int_equal(grobo_serial_set_mode(serial, GROBO_SERIAL_ASYNC), GROBO_ERR_ARG);
    assert_int_equal(grobo_serial_get_mode(serial), GROBO_SERIAL_SYNC);
}

TEST_WITH(fixture, every_byte_passes_both_ways)
{
    uint8_t out[256];
    uint8_t in[256];
    grobo_serial_counters counters;

    for (size_t i = 0; i < sizeof out; i++) {
        out[i] = (uint8_t)i;
    }
    assert_int_equal(grobo_serial_send(serial, out, sizeof out), sizeof out);
    test_line_read(&line, in, sizeof in);
    assert_memory_equal(in, out, sizeof out);
    memset(in, 0, sizeof in);
    test_line_write(&line, out, sizeof out);
    assert_int_equal(grobo_serial_receive(serial, in, sizeof in), sizeof in);
    assert_memory_equal(in, out, sizeof out);
    grobo_serial_get_counters(serial, &counters);
    assert_int_equal(counters.tx_bytes, sizeof out);
    assert_int_equal(counters.rx_bytes, sizeof in);
    assert_int_equal(counters.opens, 1);
    assert_int_equal(grobo_serial_send(serial, out, 0), 0);
    assert_int_equal(grobo_serial_receive(serial, in, 0), 0);
}

TEST_WITH(fixture, receive_takes_exactly_what_is_asked_for)
{
    uint8_t buf[4];

    test_line_write(&line,
                    "\x07"
                    "abcd",
                    5);
    assert_int_equal(grobo_serial_receive(serial, buf, 1), 1);
    assert_int_equal(buf[0], 7);
    assert_int_equal(grobo_serial_receive(serial, buf, 4), 4);
    assert_memory_equal(buf, "abcd", 4);
}

TEST_WITH(fixture, silence_ends_a_receive_and_drops_what_came)
{
    int64_t start_us = grobo_now_us();
    uint8_t buf[26];
    grobo_serial_counters counters;

    assert_int_equal(grobo_serial_receive(serial, buf, sizeof buf), GROBO_ERR_TIMEOUT);
    assert_true(grobo_now_us() - start_us >= 30000);
    test_line_write(&line, "0123456789", 10);
    assert_int_equal(grobo_serial_receive(serial, buf, sizeof buf), GROBO_ERR_SHORT);
    assert_int_equal(grobo_serial_waiting(serial), 0);
    grobo_serial_get_counters(serial, &counters);
    assert_int_equal(counters.dropped_bytes, 10);
    test_line_write(&line, "ABCDEFGHIJKLMNOPQRSTUVWXYZ", 26);
    assert_int_equal(grobo_serial_receive(serial, buf, sizeof buf), 26);
    assert_memory_equal(buf, "ABCDEFGHIJKLMNOPQRSTUVWXYZ", 26);
}

/* A device that never pauses and never sends all: a byte at each read, one read each 10 ms. */
static int read_slowly(grobo_port *port, void *buf, size_t size, grobo_os_cause *cause)
{
    static int64_t next_us;

    (void)port;
    (void)cause;
    if (grobo_now_us() < next_us || size == 0) {
        return 0;
    }
    next_us = grobo_now_us() + 10000;
    *(uint8_t *)buf = 0x55;
    return 1;
}

TEST_WITH(fixture, a_trickle_does_not_stretch_a_receive)
{
    grobo_port_ops ops = *grobo_port_serial_ops();
    const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = line.device,
                                        .ops = &ops};
    grobo_serial_counters counters;
    uint8_t buf[400];
    int64_t start_us;

    grobo_serial_free(serial);
    ops.read = read_slowly;
    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    test_line_write(&line, "x", 1); /* never read: the line is readable all the time */
    start_us = grobo_now_us();
    assert_int_equal(grobo_serial_receive(serial, buf, sizeof buf), GROBO_ERR_SHORT);
    /* 400 bytes would take 4 s. */
    assert_in_range(grobo_now_us() - start_us, 100000, 2000000);
    grobo_serial_get_counters(serial, &counters);
    assert_true(counters.rx_bytes > 0);
    assert_int_equal(counters.dropped_bytes, counters.rx_bytes);
    grobo_serial_free(serial);
    serial = NULL;
}

/* A read that finds nothing, and a process held up behind it while a byte comes. */
static bool holds_up;

static int read_and_hold_up(grobo_port *port, void *buf, size_t size, grobo_os_cause *cause)
{
    int got = grobo_port_serial_ops()->read(port, buf, size, cause);
    int64_t until_us = grobo_now_us() + 31000;

    if (holds_up) {
        holds_up = false;
        assert_int_equal(got, 0);
        test_line_write(&line, "\x07", 1);
        test_line_await_arrival(&line);
        while (grobo_now_us() < until_us) {
        }
    }
    return got;
}

TEST_WITH(fixture, what_has_come_is_read_before_there_is_silence)
{
    grobo_port_ops ops = *grobo_port_serial_ops();
    const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = line.device,
                                        .silence_ms = 30, .ops = &ops};
    uint8_t byte = 0;

    grobo_serial_free(serial);
    ops.read = read_and_hold_up;
    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    holds_up = true;
    assert_int_equal(grobo_serial_receive(serial, &byte, 1), 1);
    assert_int_equal(byte, 0x07);
    assert_false(holds_up);
    grobo_serial_free(serial);
    serial = NULL;
}

/* Waits until so many bytes are there to be read. */
static void await_bytes(int count)
{
    int64_t end_us = grobo_now_us() + 5000000;

    while (grobo_serial_waiting(serial) < count) {
        assert_true(grobo_now_us() < end_us);
    }
    assert_int_equal(grobo_serial_waiting(serial), count);
}

TEST_WITH(fixture, silence_is_100_ms_where_nothing_else_is_said)
{
    const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = line.device};
    uint8_t byte = 0;
    int64_t start_us;

    grobo_serial_free(serial);
    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    start_us = grobo_now_us();
    assert_int_equal(grobo_serial_receive(serial, &byte, 1), GROBO_ERR_TIMEOUT);
    assert_in_range(grobo_now_us() - start_us, 100000, 1000000);
}

TEST_WITH(fixture, low_level_read_and_write_take_what_there_is)
{
    uint8_t buf[16];

    assert_int_equal(grobo_serial_read(serial, buf, sizeof buf), 0);
    test_line_write(&line, "abc", 3);
    await_bytes(3);
    assert_int_equal(grobo_serial_read(serial, buf, sizeof buf), 3);
    assert_memory_equal(buf, "abc", 3);
    assert_int_equal(grobo_serial_write(serial, "xyz", 3), 3);
    test_line_read(&line, buf, 3);
    assert_memory_equal(buf, "xyz", 3);
    assert_int_equal(grobo_serial_write(serial, "0123456789abcdef", 16), 16); /* the line is free */
    test_line_read(&line, buf, 16);
    assert_memory_equal(buf, "0123456789abcdef", 16);
}

TEST_WITH(fixture, waiting_bytes_are_counted_and_dropped)
{
    assert_int_equal(grobo_serial_waiting(serial), 0);
    assert_int_equal(grobo_serial_discard(serial), 0);
    test_line_write(&line, "abcde", 5);
    await_bytes(5);
    assert_int_equal(grobo_serial_discard(serial), 5);
    assert_int_equal(grobo_serial_waiting(serial), 0);
    uint8_t many[200] = {0};
    test_line_write(&line, many, sizeof many);
    await_bytes(sizeof many);
    assert_int_equal(grobo_serial_discard(serial), sizeof many);
}

TEST_WITH(fixture, bytes_from_before_open_are_gone)
{
    uint8_t byte = 0;

    grobo_serial_close(serial);
    test_line_write(&line, "old", 3);
    test_line_await_arrival(&line);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    test_line_write(&line, "n", 1);
    assert_int_equal(grobo_serial_receive(serial, &byte, 1), 1);
    assert_int_equal(byte, 'n');
}

/* More than a pty holds, so that the line takes it in parts, while a child reads the other end. */
TEST_WITH(fixture, a_send_of_several_writes_arrives_whole)
{
    static uint8_t much[100000];
    grobo_serial_counters counters;
    int status = -1;

    test_line_needs_pty("a line that takes a part");
    for (size_t i = 0; i < sizeof much; i++) {
        much[i] = (uint8_t)(i * 7 + i / 251);
    }
    pid_t child = fork();
    if (child == 0) {
        static uint8_t got[sizeof much];
        test_line_read(&line, got, sizeof got);
        _exit(memcmp(got, much, sizeof much) != 0);
    }
    assert_true(child > 0);
    assert_int_equal(grobo_serial_send(serial, much, sizeof much), sizeof much);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    grobo_serial_get_counters(serial, &counters);
    assert_true(counters.short_writes > 0);
    assert_int_equal(counters.tx_bytes, sizeof much);
}

TEST_WITH(fixture, a_line_that_takes_nothing_ends_a_send)
{
    static uint8_t much[100000];
    int64_t start_us = grobo_now_us();
    grobo_serial_counters counters;

    test_line_needs_pty("a line that takes nothing");
    assert_int_equal(grobo_serial_send(serial, much, sizeof much), GROBO_ERR_TIMEOUT);
    assert_true(grobo_now_us() - start_us >= 1000000);
    grobo_serial_get_counters(serial, &counters);
    assert_true(counters.short_writes > 0);
    assert_true(counters.tx_bytes > 0 && counters.tx_bytes < sizeof much);
}

static speed_t line_speed(void)
{
    struct termios tio;

    assert_int_equal(tcgetattr(grobo_serial_handle(serial), &tio), 0);
    return cfgetospeed(&tio);
}

TEST_WITH(fixture, speed_changes_on_an_open_port)
{
    static const int rates[] = {9600, 19200, 57600, 115200, 230400, 460800};

    test_line_needs_pty("any speed");
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        assert_int_equal(grobo_serial_set_baud(serial, rates[i]), rates[i]);
        assert_int_equal(grobo_serial_baud(serial), rates[i]);
    }
    /* The line has it too, while it is open. */
    assert_int_equal(grobo_serial_set_baud(serial, 57600), 57600);
    assert_true(line_speed() == B57600);
    assert_int_equal(grobo_serial_set_baud(serial, 19200), 19200);
    assert_true(line_speed() == B19200);
    assert_int_equal(grobo_serial_set_baud(serial, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_serial_baud(serial), 19200);
    assert_true(line_speed() == B19200);
    grobo_serial_close(serial);
    assert_int_equal(grobo_serial_set_baud(serial, 57600), 57600);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    assert_int_equal(grobo_serial_baud(serial), 57600);
    assert_true(line_speed() == B57600);
    assert_int_equal(grobo_serial_set_baud(serial, 115200), 115200);
}

TEST_WITH(fixture, speeds_need_not_be_those_of_a_table)
{
    static const int rates[] = {14400, 76800, 153600, 250000};

    test_line_needs_pty("any speed");
    const char *emulator = getenv("EMULATOR");
    if (emulator != NULL && *emulator != '\0') {
        print_message("the emulator passes on standard speeds only\n");
        skip();
    }
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        assert_int_equal(grobo_serial_set_baud(serial, rates[i]), rates[i]);
        assert_int_equal(grobo_serial_baud(serial), rates[i]);
    }
    assert_int_equal(grobo_serial_set_baud(serial, 115200), 115200);
}

TEST_WITH(fixture, low_latency_is_reported_where_there_is_none)
{
    test_line_needs_pty("a line without low latency");
    assert_int_equal(grobo_serial_low_latency(serial), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_serial_set_low_latency(serial), GROBO_ERR_UNSUPPORTED);
    assert_true(strlen(grobo_serial_cause(serial)->text) > 0);
}

TEST_WITH(fixture, a_hang_up_is_told_once_and_closes)
{
    uint8_t byte = 0;
    grobo_serial_counters counters;

    test_line_needs_pty("a hang-up");
    test_line_close(&line);
    assert_int_equal(grobo_serial_receive(serial, &byte, 1), GROBO_ERR_UNPLUGGED);
    assert_false(grobo_serial_is_open(serial));
    assert_int_equal(grobo_serial_receive(serial, &byte, 1), GROBO_ERR_CLOSED);
    grobo_serial_get_counters(serial, &counters);
    assert_int_equal(counters.unplugs, 1);
}

TEST_WITH(fixture, a_hang_up_is_found_by_sending_too)
{
    test_line_needs_pty("a hang-up");
    test_line_close(&line);
    assert_int_equal(grobo_serial_send(serial, "x", 1), GROBO_ERR_UNPLUGGED);
    assert_false(grobo_serial_is_open(serial));
}

static volatile sig_atomic_t alarms;

static void on_alarm(int number)
{
    (void)number;
    alarms++;
}

TEST_WITH(fixture, signals_do_not_cut_a_wait_short)
{
    const struct itimerval every_ms = {{0, 1000}, {0, 1000}};
    const struct itimerval off = {{0, 0}, {0, 0}};
    struct sigaction act = {0};
    struct sigaction before;
    int64_t start_us = grobo_now_us();
    uint8_t byte = 0;
    int r;

    act.sa_handler = on_alarm; /* without SA_RESTART */
    assert_int_equal(sigaction(SIGALRM, &act, &before), 0);
    assert_int_equal(setitimer(ITIMER_REAL, &every_ms, NULL), 0);
    r = grobo_serial_receive(serial, &byte, 1);
    assert_int_equal(setitimer(ITIMER_REAL, &off, NULL), 0);
    assert_int_equal(sigaction(SIGALRM, &before, NULL), 0);
    assert_int_equal(r, GROBO_ERR_TIMEOUT);
    assert_true(grobo_now_us() - start_us >= 30000);
    assert_true(alarms > 0);
}

TEST(hex_is_written_to_buffer_and_stream)
{
    static const uint8_t packet[] = {0xFA, 0xAF, 0x03};
    char text[9] = "unchange";
    char read_back[32] = "";
    FILE *stream = tmpfile();

    assert_int_equal(grobo_hex(packet, sizeof packet, text, 8), GROBO_ERR_SPACE);
    assert_string_equal(text, "unchange");
    assert_int_equal(grobo_hex(packet, sizeof packet, text, sizeof text), 8);
    assert_string_equal(text, "FA AF 03");
    assert_int_equal(grobo_hex(packet, 0, text, 1), 0);
    assert_string_equal(text, "");
    assert_non_null(stream);
    assert_int_equal(grobo_hex_print(packet, sizeof packet, stream), GROBO_OK);
    rewind(stream);
    assert_non_null(fgets(read_back, sizeof read_back, stream));
    assert_string_equal(read_back, "FA AF 03\n");
    assert_int_equal(fclose(stream), 0);
}
