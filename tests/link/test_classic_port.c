/* SPDX-License-Identifier: MIT */
/* SerialCom of the classic shelf on an open port: rows SC01..SC22, by its own functions. */
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include <grobo/classic/classic.h>

#include "tests/support/line.h"
#include "tests/support/test.h"

static test_line line;
static SerialCom *com;

static int set_up(void)
{
    test_line_open(&line);
    com = SerialCom_new(line.device);
    assert_non_null(com);
    return SerialCom_openPort(com) >= 0 ? 0 : -1;
}

static int tear_down(void)
{
    SerialCom_delete(com);
    test_line_close(&line);
    return 0;
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

/* Waits for bytes, 5 s at most. */
static void await_bytes(int n)
{
    struct pollfd ready = {.fd = com->handle, .events = POLLIN};

    for (int64_t end_us = grobo_now_us() + 5000000; SerialCom_chkBuffer(com) < n;) {
        assert_true(grobo_now_us() < end_us);
        (void)poll(&ready, 1, 1);
    }
    assert_int_equal(SerialCom_chkBuffer(com), n);
}

TEST_WITH(fixture, an_open_port_is_shown)
{
    char byte = 0;
    grobo_handle handle = com->handle;

    assert_int_equal(SerialCom_isConnected(com), 1);
    assert_string_equal(com->device, line.device);
    assert_int_equal(write(handle, "h", 1), 1); /* it is the line's */
    test_line_read(&line, &byte, 1);
    assert_int_equal(byte, 'h');
    assert_int_equal(SerialCom_openPort(com), -1); /* it is open */
    assert_int_equal(SerialCom_setDevPort(com, "/nowhere/port"), -1);
    assert_string_equal(com->device, line.device);
    assert_int_equal(SerialCom_setMode(com, 1), 0); /* it keeps the one it has */
    assert_int_equal(SerialCom_getMode(com), 0);
    SerialCom_closePort(com);
    assert_int_equal(fcntl(handle, F_GETFD), -1);
    assert_int_equal(SerialCom_isConnected(com), -1);
    assert_true(com->handle == GROBO_HANDLE_NULL);
    assert_int_equal(SerialCom_setMode(com, 1), 1);
    handle = SerialCom_openPort(com);
    assert_true(handle >= 0 && handle == com->handle);
    assert_int_equal(SerialCom_isConnected(com), 1);
    SerialCom_closePort(com);
    assert_int_equal(SerialCom_setDevPort(com, "/nowhere/port"), 0);
    assert_string_equal(com->device, "/nowhere/port");
    assert_int_equal(SerialCom_openPort(com), -1);
}

TEST_WITH(fixture, a_speed_may_be_a_constant_of_termios)
{
    static const struct {
        speed_t constant;
        int bps;
    } rows[] = {
        {B50, 50},           {B75, 75},           {B110, 110},       {B134, 134},
        {B150, 150},         {B200, 200},         {B300, 300},       {B600, 600},
        {B1200, 1200},       {B1800, 1800},       {B2400, 2400},     {B4800, 4800},
        {B9600, 9600},       {B19200, 19200},     {B38400, 38400},   {B57600, 57600},
        {B115200, 115200},   {B230400, 230400},   {B460800, 460800}, {B1000000, 1000000},
        {B2000000, 2000000}, {B4000000, 4000000},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        struct termios by_constant, by_number;
        SerialCom_closePort(com);
        com->baudrate = (int)rows[i].constant;
        assert_true(SerialCom_openPort(com) >= 0);
        assert_int_equal(tcgetattr(com->handle, &by_constant), 0);
        assert_int_equal(cfgetospeed(&by_constant), rows[i].constant);
        SerialCom_closePort(com);
        com->baudrate = rows[i].bps;
        assert_true(SerialCom_openPort(com) >= 0);
        assert_int_equal(tcgetattr(com->handle, &by_number), 0);
        assert_int_equal(cfgetospeed(&by_number), rows[i].constant);
    }
}

TEST_WITH(fixture, bytes_are_written_and_read)
{
    char bytes[100];

    assert_int_equal(SerialCom_chkBuffer(com), 0);
    assert_int_equal(SerialCom_Read(com, bytes, sizeof bytes), 0); /* none came */
    assert_int_equal(SerialCom_Write(com, "0123456789", 10), 10);
    test_line_read(&line, bytes, 10);
    assert_memory_equal(bytes, "0123456789", 10);
    assert_int_equal(SerialCom_Write(com, "x", 0), 0);
    test_line_write(&line, "abcdef", 6);
    await_bytes(6);
    assert_int_equal(SerialCom_Read(com, bytes, 2), 2);
    assert_memory_equal(bytes, "ab", 2);
    assert_int_equal(SerialCom_chkBuffer(com), 4);
    assert_int_equal(SerialCom_Read(com, bytes, sizeof bytes), 4);
    assert_memory_equal(bytes, "cdef", 4);
    assert_int_equal(SerialCom_Read(com, NULL, 1), -1);
    assert_int_equal(SerialCom_Read(com, bytes, -1), -1);
    assert_int_equal(SerialCom_Write(com, NULL, 1), -1);
    assert_int_equal(SerialCom_Write(com, bytes, -1), -1);
}

TEST_WITH(fixture, a_read_of_mode_1_does_not_wait)
{
    char bytes[8];

    SerialCom_closePort(com);
    assert_int_equal(SerialCom_setMode(com, 1), 1);
    assert_int_equal(com->mode, GROBO_SERIAL_ASYNC);
    assert_true(SerialCom_openPort(com) >= 0);
    assert_int_equal(SerialCom_Read(com, bytes, 3), 0);
    test_line_write(&line, "abc", 3);
    await_bytes(3);
    assert_int_equal(SerialCom_Read(com, bytes, 3), 3);
    assert_memory_equal(bytes, "abc", 3);
}

TEST_WITH(fixture, bytes_are_sent_and_received_whole)
{
    char bytes[300];

    memset(bytes, 0x5A, sizeof bytes);
    assert_int_equal(SerialCom_sendData(com, bytes, 300), 300);
    memset(bytes, 0, sizeof bytes);
    test_line_read(&line, bytes, 300);
    for (int i = 0; i < 300; i++) {
        assert_int_equal(bytes[i], 0x5A);
    }
    test_line_write(&line, "abcde", 5);
    assert_int_equal(SerialCom_recieveData(com, bytes, 3), 3);
    assert_memory_equal(bytes, "abc", 3);
    assert_int_equal(SerialCom_recieveData(com, bytes, 2), 2);
    assert_memory_equal(bytes, "de", 2);
    test_line_write(&line, "x", 1);
    assert_int_equal(SerialCom_recieveData(com, bytes, 2), -1); /* too few */
    assert_int_equal(SerialCom_chkBuffer(com), 0);              /* and dropped */
    assert_int_equal(SerialCom_recieveData(com, NULL, 1), -1);
    assert_int_equal(SerialCom_recieveData(com, bytes, -1), -1);
    assert_int_equal(SerialCom_sendData(com, NULL, 1), -1);
    assert_int_equal(SerialCom_sendData(com, bytes, -1), -1);
}

TEST_WITH(fixture, waiting_bytes_are_counted_and_dropped)
{
    char many[200] = {0};

    assert_int_equal(SerialCom_clearBuffer(com), 0);
    test_line_write(&line, many, sizeof many);
    await_bytes(sizeof many);
    assert_int_equal(SerialCom_clearBuffer(com), sizeof many);
    assert_int_equal(SerialCom_chkBuffer(com), 0);
}

/* Speeds by the number, and by the constants of Linux's termios.h. */
TEST_WITH(fixture, speeds_are_numbers_or_constants_of_termios)
{
    static const struct {
        int given, bps;
    } rows[] = {{1, 50},        {2, 75},          {13, 9600},       {15, 38400},
                {4097, 57600},  {4098, 115200},   {4099, 230400},   {4100, 460800},
                {4103, 921600}, {4104, 1000000},  {4107, 2000000},  {4111, 4000000},
                {9600, 9600},   {115200, 115200}, {230400, 230400}, {1000000, 1000000}};

    test_line_needs_pty("any speed");
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        assert_int_equal(SerialCom_setBaudrate(com, rows[i].given), rows[i].given);
        assert_int_equal(SerialCom_getBaudrate(com), rows[i].given);
        assert_int_equal(com->baudrate, rows[i].given);
        assert_int_equal(grobo_serial_baud(com->serial), rows[i].bps);
    }
    assert_int_equal(SerialCom_setBaudrate(com, -1), -1);
    assert_int_equal(com->baudrate, 1000000);
    SerialCom_closePort(com);
    com->baudrate = 4099; /* the field: taken when the port is opened */
    assert_true(SerialCom_openPort(com) >= 0);
    assert_int_equal(grobo_serial_baud(com->serial), 230400);
}

/* What printPacket() prints to standard error. */
TEST_WITH(fixture, a_packet_is_printed_in_hex)
{
    char text[64] = "", wanted[64];
    FILE *file = tmpfile(), *same = tmpfile();
    int kept = dup(STDERR_FILENO);

    assert_true(file != NULL && same != NULL && kept >= 0);
    (void)fflush(stderr);
    assert_true(dup2(fileno(file), STDERR_FILENO) >= 0);
    SerialCom_printPacket(com, NULL, 3);
    SerialCom_printPacket(com, "\x0A", 0);
    SerialCom_printPacket(com, "\x0A\xFE\x01", 3);
    (void)fflush(stderr);
    assert_true(dup2(kept, STDERR_FILENO) >= 0);
    (void)close(kept);
    rewind(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    assert_true(grobo_hex_print("\x0A\xFE\x01", 3, same) >= 0);
    rewind(same);
    wanted[fread(wanted, 1, sizeof wanted - 1, same)] = '\0';
    assert_string_equal(text, wanted);
    assert_non_null(strstr(text, "0A FE 01"));
    (void)fclose(file);
    (void)fclose(same);
}
