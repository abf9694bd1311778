/* SPDX-License-Identifier: MIT */
/*
 * What any port must do, by the functions of grobo/core/port.h alone: a serial port against a
 * pseudo-terminal, a connection against a listener. Where the system has no pseudo-terminals,
 * GROBO_TEST_SERIAL names two serial ports joined by a null-modem cable: "COM10,COM11"; with
 * GROBO_TEST_NO_PARITY they need have no parity bit.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/port.h>

#include "tests/support/test.h"

/* Two ends of a line, and what kind of line it is. */
typedef struct {
    const grobo_port_ops *near_ops;
    const grobo_port_ops *far_ops;
    grobo_port *near_port;
    grobo_port *far_port;
    bool near_is_open, far_is_open;
    char device[GROBO_DEVICE_MAX_BYTES];
    char far_device[GROBO_DEVICE_MAX_BYTES];
    bool serial;
} line;

static line the_line;
static grobo_os_cause cause;

static void make_storage(line *l)
{
    /* Rubbish in it: open() must not need it clean. */
    l->near_port = malloc(l->near_ops->size_bytes);
    l->far_port = malloc(l->far_ops->size_bytes);
    assert_non_null(l->near_port);
    assert_non_null(l->far_port);
    memset(l->near_port, 0xA5, l->near_ops->size_bytes);
    memset(l->far_port, 0xA5, l->far_ops->size_bytes);
}

static int open_near(line *l)
{
    int r = l->near_ops->open(l->near_port, l->device, 115200, &cause);

    l->near_is_open = r >= 0;
    return r;
}

static void close_near(line *l)
{
    if (l->near_is_open) {
        l->near_ops->close(l->near_port);
        l->near_is_open = false;
    }
}

static void close_far(line *l)
{
    if (l->far_is_open) {
        l->far_ops->close(l->far_port);
        l->far_is_open = false;
    }
}

/* Bytes of the test before may still be on their way through a cable. */
static void await_silence(const grobo_port_ops *ops, grobo_port *port)
{
    uint8_t rest[4096];

    while (grobo_port_wait(ops->socket(port), GROBO_PORT_READABLE, 20000) > 0) {
        assert_true(ops->read(port, rest, sizeof rest, &cause) > 0);
    }
}

static int set_up_serial(void)
{
    const char *pair = getenv("GROBO_TEST_SERIAL");
    line *l = &the_line;

    memset(l, 0, sizeof *l);
    l->serial = true;
    l->near_ops = grobo_port_serial_ops();
    l->far_ops = pair != NULL ? grobo_port_serial_ops() : grobo_port_pty_ops();
    if (l->far_ops == NULL) {
        print_message("no pseudo-terminals and no GROBO_TEST_SERIAL: serial ports not tested\n");
        return 0;
    }
    make_storage(l);
    if (pair != NULL) {
        size_t size = strcspn(pair, ",");

        assert_true(size < sizeof l->device && pair[size] == ',');
        memcpy(l->device, pair, size);
        assert_true(strlen(pair + size + 1) < sizeof l->far_device);
        memcpy(l->far_device, pair + size + 1, strlen(pair + size + 1) + 1);
    }
    assert_int_equal(l->far_ops->open(l->far_port, l->far_device, 115200, &cause), GROBO_OK);
    l->far_is_open = true;
    if (pair == NULL) {
        assert_int_equal(grobo_port_pty_path(l->far_port, l->device, sizeof l->device), GROBO_OK);
    }
    assert_int_equal(open_near(l), GROBO_OK);
    if (pair != NULL) {
        await_silence(l->far_ops, l->far_port);
    }
    return 0;
}

static int set_up_tcp(void)
{
    line *l = &the_line;
    grobo_socket listener;
    int tcp_port;
    int r;

    memset(l, 0, sizeof *l);
    l->near_ops = grobo_port_tcp_ops();
    l->far_ops = grobo_port_tcp_ops();
    make_storage(l);
    assert_int_equal(grobo_port_listen("tcp:127.0.0.1:0", &listener, &tcp_port, &cause), GROBO_OK);
    assert_true(tcp_port > 0 && tcp_port < 65536);
    assert_int_equal(grobo_port_accept(listener, l->far_port, &cause), GROBO_ERR_EMPTY);
    assert_true(snprintf(l->device, sizeof l->device, "tcp:127.0.0.1:%d", tcp_port) > 0);
    assert_int_equal(open_near(l), GROBO_OK);
    assert_int_equal(grobo_port_wait(listener, GROBO_PORT_READABLE, 5000000), GROBO_PORT_READABLE);
    assert_int_equal(grobo_port_accept(listener, l->far_port, &cause), GROBO_OK);
    l->far_is_open = true;
    grobo_port_listen_close(listener);
    do {
        r = l->near_ops->ready(l->near_port, &cause);
        assert_true(r >= 0);
        if (r == 0) {
            assert_true(grobo_port_wait(l->near_ops->socket(l->near_port), GROBO_PORT_WRITABLE,
                                        5000000) > 0);
        }
    } while (r == 0);
    return 0;
}

static int tear_down(void)
{
    line *l = &the_line;

    close_near(l);
    close_far(l);
    free(l->near_port);
    free(l->far_port);
    return 0;
}

static const test_fixture on_serial[] = {{NULL, set_up_serial, tear_down}};
static const test_fixture on_both[] = {{"serial", set_up_serial, tear_down},
                                       {"tcp", set_up_tcp, tear_down}};

/* The line of this test; skips it where there is none. */
static line *line_of(void)
{
    line *l = &the_line;

    if (l->near_port == NULL) {
        skip();
    }
    return l;
}

/* ---- moving bytes ------------------------------------------------------------------------- */

static void write_all(const grobo_port_ops *ops, grobo_port *port, const uint8_t *bytes,
                      size_t size)
{
    while (size > 0) {
        int done = ops->write(port, bytes, size, &cause);

        assert_true(done >= 0 && (size_t)done <= size);
        if (done == 0) {
            assert_true(grobo_port_wait(ops->socket(port), GROBO_PORT_WRITABLE, 5000000) > 0);
        }
        bytes += done;
        size -= (size_t)done;
    }
}

static void read_all(const grobo_port_ops *ops, grobo_port *port, uint8_t *bytes, size_t size)
{
    while (size > 0) {
        int got = ops->read(port, bytes, size, &cause);

        assert_true(got >= 0 && (size_t)got <= size);
        if (got == 0) {
            assert_true(grobo_port_wait(ops->socket(port), GROBO_PORT_READABLE, 5000000) > 0);
        }
        bytes += got;
        size -= (size_t)got;
    }
}

/* ---- what must hold ----------------------------------------------------------------------- */

TEST_WITH(on_both, every_byte_value_passes_in_both_directions)
{
    line *l = line_of();
    uint8_t out[256];
    uint8_t in[256];

    for (size_t i = 0; i < sizeof out; i++) {
        out[i] = (uint8_t)i;
    }
    write_all(l->near_ops, l->near_port, out, sizeof out);
    read_all(l->far_ops, l->far_port, in, sizeof in);
    assert_memory_equal(in, out, sizeof out);
    memset(in, 0, sizeof in);
    write_all(l->far_ops, l->far_port, out, sizeof out);
    read_all(l->near_ops, l->near_port, in, sizeof in);
    assert_memory_equal(in, out, sizeof out);
}

TEST_WITH(on_both, nothing_there_is_nothing_and_takes_no_time)
{
    line *l = line_of();
    int64_t start_us = grobo_now_us();
    uint8_t byte;

    assert_int_equal(l->near_ops->ready(l->near_port, &cause), 1);
    assert_int_equal(l->near_ops->read(l->near_port, &byte, 1, &cause), 0);
    assert_int_equal(l->near_ops->waiting(l->near_port, &cause), 0);
    assert_true(grobo_now_us() - start_us < 500000);
    assert_int_equal(grobo_port_wait(l->near_ops->socket(l->near_port), GROBO_PORT_READABLE, 20000),
                     0);
    assert_true(grobo_now_us() - start_us >= 20000);
}

TEST_WITH(on_both, a_full_line_takes_less_and_never_waits)
{
    static uint8_t block[65536];
    line *l = line_of();
    int64_t start_us = grobo_now_us();
    bool was_short = false;

    for (int i = 0; i < 1000 && !was_short && grobo_now_us() - start_us < 2000000; i++) {
        int done = l->near_ops->write(l->near_port, block, sizeof block, &cause);

        assert_true(done >= 0);
        was_short = (size_t)done < sizeof block;
    }
    assert_true(grobo_now_us() - start_us < 5000000);
    l->near_ops->discard_output(l->near_port);
    if (!was_short && l->far_ops == grobo_port_serial_ops()) {
        print_message("this line takes bytes faster than they can be written\n");
        skip();
    }
    assert_true(was_short);
}

TEST_WITH(on_both, waiting_bytes_are_counted)
{
    line *l = line_of();
    uint8_t bytes[5];
    int64_t end_us = grobo_now_us() + 5000000;

    write_all(l->far_ops, l->far_port, (const uint8_t *)"abcde", 5);
    while (l->near_ops->waiting(l->near_port, &cause) < 5) {
        assert_true(grobo_now_us() < end_us);
    }
    assert_int_equal(l->near_ops->waiting(l->near_port, &cause), 5);
    read_all(l->near_ops, l->near_port, bytes, 5);
    assert_memory_equal(bytes, "abcde", 5);
}

TEST_WITH(on_both, handle_and_socket_are_there)
{
    line *l = line_of();

    assert_true(l->near_ops->handle(l->near_port) != GROBO_HANDLE_NULL);
    assert_true(l->near_ops->socket(l->near_port) != GROBO_SOCKET_NULL);
    assert_true(strlen(l->near_ops->name) > 0);
}

TEST_WITH(on_both, a_speed_is_set_on_an_open_port)
{
    static const int rates[] = {9600, 57600, 460800, 115200};
    line *l = line_of();

    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        int r = l->near_ops->set_baud(l->near_port, rates[i], &cause);

        assert_true(r == rates[i] || (r == GROBO_ERR_UNSUPPORTED && strlen(cause.text) > 0));
    }
    assert_int_equal(l->near_ops->set_baud(l->near_port, 115200, &cause), 115200);
}

TEST_WITH(on_both, low_latency_is_set_or_refused_with_a_reason)
{
    line *l = line_of();
    int r = l->near_ops->set_low_latency(l->near_port, &cause);

    assert_true(r == GROBO_OK ||
                ((r == GROBO_ERR_UNSUPPORTED || r == GROBO_ERR_PERM) && strlen(cause.text) > 0));
}

TEST_WITH(on_both, the_far_end_gone_is_unplugged)
{
    line *l = line_of();
    uint8_t byte;

    if (l->far_ops == grobo_port_serial_ops()) {
        print_message("a closed serial port at the far end of a cable is not noticed\n");
        skip();
    }
    close_far(l);
    assert_true(grobo_port_wait(l->near_ops->socket(l->near_port), GROBO_PORT_READABLE, 5000000) >
                0);
    assert_int_equal(l->near_ops->read(l->near_port, &byte, 1, &cause), GROBO_ERR_UNPLUGGED);
    assert_true(strlen(cause.text) > 0);
}

TEST_WITH(on_serial, a_port_may_be_opened_again_in_the_same_storage)
{
    line *l = line_of();
    uint8_t byte = 0;

    for (int i = 0; i < 3; i++) {
        close_near(l);
        assert_int_equal(open_near(l), GROBO_OK);
        write_all(l->near_ops, l->near_port, (const uint8_t *)"x", 1);
        read_all(l->far_ops, l->far_port, &byte, 1);
        assert_int_equal(byte, 'x');
    }
}

TEST_WITH(on_serial, bytes_from_before_open_are_dropped)
{
    line *l = line_of();
    uint8_t byte = 0;

    close_near(l);
    write_all(l->far_ops, l->far_port, (const uint8_t *)"old", 3);
    if (l->far_ops == grobo_port_serial_ops()) {
        /* They take their time through a cable; nothing comes back. */
        assert_int_equal(
            grobo_port_wait(l->far_ops->socket(l->far_port), GROBO_PORT_READABLE, 50000), 0);
    }
    assert_int_equal(open_near(l), GROBO_OK);
    write_all(l->far_ops, l->far_port, (const uint8_t *)"n", 1);
    read_all(l->near_ops, l->near_port, &byte, 1);
    assert_int_equal(byte, 'n');
}

TEST_WITH(on_serial, a_second_open_is_refused)
{
    line *l = line_of();
    grobo_port *second = malloc(l->near_ops->size_bytes);

    assert_non_null(second);
    assert_int_equal(l->near_ops->open(second, l->device, 115200, &cause), GROBO_ERR_BUSY);
    assert_true(strlen(cause.text) > 0);
    free(second);
}

TEST_WITH(on_both, a_port_that_is_not_there_is_refused)
{
    line *l = line_of();
    const char *missing = l->serial ? "/dev/no-such-port" : "tcp:no such host:1";

    close_near(l);
    assert_int_equal(l->near_ops->open(l->near_port, missing, 115200, &cause), GROBO_ERR_NOENT);
    assert_true(strlen(cause.text) > 0);
}

/* Whatever the kind, bytes go on; of a serial port the speed may be set afterwards. */
TEST_WITH(on_both, a_form_of_bytes_may_be_asked_for)
{
    static const grobo_line_format formats[] = {
        {GROBO_PARITY_EVEN, 1, false}, {GROBO_PARITY_ODD, 2, false}, {GROBO_PARITY_NONE, 0, false}};
    line *l = &the_line;

    if (l->near_ops == NULL || !l->near_is_open) {
        skip();
    }
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        uint8_t byte = 0;

        if (formats[i].parity != GROBO_PARITY_NONE && getenv("GROBO_TEST_NO_PARITY") != NULL) {
            continue;
        }
        assert_int_equal(l->near_ops->set_format(l->near_port, &formats[i], &cause), GROBO_OK);
        assert_int_equal(l->far_ops->set_format(l->far_port, &formats[i], &cause), GROBO_OK);
        assert_int_equal(l->near_ops->set_baud(l->near_port, 57600, &cause), 57600);
        (void)l->far_ops->set_baud(l->far_port, 57600, &cause);
        assert_int_equal(l->near_ops->write(l->near_port, "a", 1, &cause), 1);
        assert_int_equal(
            grobo_port_wait(l->far_ops->socket(l->far_port), GROBO_PORT_READABLE, 5000000),
            GROBO_PORT_READABLE);
        assert_int_equal(l->far_ops->read(l->far_port, &byte, 1, &cause), 1);
        assert_int_equal(byte, 'a');
    }
    if (l->serial) {
        static const grobo_line_format three = {GROBO_PARITY_NONE, 3, false};
        static const grobo_line_format mark = {(grobo_parity)3, 1, false};

        assert_int_equal(l->near_ops->set_format(l->near_port, &three, &cause), GROBO_ERR_ARG);
        assert_int_equal(l->near_ops->set_format(l->near_port, &mark, &cause), GROBO_ERR_ARG);
    }
}
