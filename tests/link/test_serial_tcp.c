/* SPDX-License-Identifier: MIT */
/* The serial port over TCP, with a server on the loopback. */
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/serial.h>

#include "tests/support/line.h"
#include "tests/support/test.h"

static int listener;
static char device[64];
static struct event_base *base;
static uint8_t seen[64];
static size_t seen_size;
static int events[4];
static int last_error;

static int set_up(void)
{
    struct sockaddr_in address = {.sin_family = AF_INET};
    socklen_t size = sizeof address;

    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    listener = socket(AF_INET, SOCK_STREAM, 0);
    assert_true(listener >= 0);
    assert_int_equal(bind(listener, (struct sockaddr *)&address, size), 0);
    assert_int_equal(getsockname(listener, (struct sockaddr *)&address, &size), 0);
    assert_int_equal(listen(listener, 1), 0);
    snprintf(device, sizeof device, "tcp:127.0.0.1:%d", ntohs(address.sin_port));
    base = grobo_loop_new();
    assert_non_null(base);
    seen_size = 0;
    memset(events, 0, sizeof events);
    last_error = GROBO_OK;
    return 0;
}

static int tear_down(void)
{
    event_base_free(base);
    assert_int_equal(close(listener), 0);
    return 0;
}

static const test_fixture with_server[] = {{NULL, set_up, tear_down}};

static void accept_peer(test_line *peer)
{
    struct pollfd one = {.fd = listener, .events = POLLIN};

    assert_int_equal(poll(&one, 1, 5000), 1);
    peer->fd = accept(listener, NULL, NULL);
    assert_true(peer->fd >= 0);
    assert_int_equal(fcntl(peer->fd, F_SETFL, O_NONBLOCK), 0);
}

static void on_data(void *ctx, grobo_serial *serial, const uint8_t *bytes, size_t size)
{
    (void)serial;
    (void)ctx;
    assert_true(size <= sizeof seen - seen_size);
    memcpy(seen + seen_size, bytes, size);
    seen_size += size;
    event_base_loopbreak(base);
}

static void on_event(void *ctx, grobo_serial *serial, grobo_serial_event event, int error)
{
    (void)serial;
    (void)ctx;
    events[event]++;
    last_error = error;
    event_base_loopbreak(base);
}

static int open_async(const char *name, grobo_serial **serial)
{
    const grobo_serial_config config = {
        GROBO_SERIAL_CONFIG_INIT,   .device = name,     .base = base,
        .mode = GROBO_SERIAL_ASYNC, .on_data = on_data, .on_event = on_event};

    assert_int_equal(grobo_serial_new(&config, serial), GROBO_OK);
    return grobo_serial_open(*serial);
}

TEST_WITH(with_server, bytes_sent_before_the_connection_stands_arrive)
{
    grobo_serial *serial;
    test_line peer;
    uint8_t back[5];

    assert_int_equal(open_async(device, &serial), GROBO_OK);
    assert_int_equal(grobo_serial_send(serial, "hello", 5), 5);
    accept_peer(&peer);
    event_base_dispatch(base);
    assert_int_equal(events[GROBO_SERIAL_OPENED], 1);
    test_line_read(&peer, back, 5);
    assert_memory_equal(back, "hello", 5);
    test_line_write(&peer, "world", 5);
    event_base_dispatch(base);
    assert_memory_equal(seen, "world", 5);
    assert_int_equal(grobo_serial_set_baud(serial, 460800), 460800);
    assert_int_equal(grobo_serial_set_low_latency(serial), GROBO_ERR_UNSUPPORTED);
    test_line_close(&peer);
    event_base_dispatch(base);
    assert_int_equal(events[GROBO_SERIAL_UNPLUGGED], 1);
    grobo_serial_free(serial);
}

TEST_WITH(with_server, a_refused_connection_is_told)
{
    grobo_serial *serial;

    assert_int_equal(close(listener), 0);
    listener = dup(0);
    last_error = open_async(device, &serial);
    /* The loopback may refuse at once; what is farther away does so later. */
    if (last_error == GROBO_OK) {
        event_base_dispatch(base);
        assert_int_equal(events[GROBO_SERIAL_FAILED], 1);
    }
    assert_int_equal(last_error, GROBO_ERR_NOENT);
    assert_false(grobo_serial_is_open(serial));
    grobo_serial_free(serial);
}

TEST_WITH(with_server, a_synchronous_port_waits_for_its_connection)
{
    const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = device,
                                        .silence_ms = 2000};
    grobo_serial *serial;
    test_line peer;
    uint8_t back[4];

    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    accept_peer(&peer);
    assert_int_equal(grobo_serial_send(serial, "ping", 4), 4);
    test_line_read(&peer, back, 4);
    assert_memory_equal(back, "ping", 4);
    test_line_write(&peer, "pong", 4);
    assert_int_equal(grobo_serial_receive(serial, back, 4), 4);
    assert_memory_equal(back, "pong", 4);
    test_line_close(&peer);
    assert_int_equal(grobo_serial_receive(serial, back, 4), GROBO_ERR_UNPLUGGED);
    grobo_serial_free(serial);
}

TEST(malformed_names_are_refused)
{
    static const char *const names[] = {
        "tcp:",          "tcp:host",  "tcp::80",           "tcp:1.2.3.4:",
        "tcp:1.2.3.4:x", "tcp:[]:80", "tcp:1.2.3.4:65536", "tcp:1.2.3.4:12345678901"};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = names[i]};
        grobo_serial *serial;

        assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
        assert_int_equal(grobo_serial_open(serial), GROBO_ERR_ARG);
        assert_string_equal(grobo_serial_cause(serial)->text, "not of the form tcp:HOST:PORT");
        grobo_serial_free(serial);
    }
}

TEST(names_are_looked_up_beforehand_only)
{
    const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT,
                                        .device = "tcp:no-such-host.invalid:80"};
    char numeric[GROBO_DEVICE_MAX_BYTES] = "";
    grobo_os_cause cause;
    grobo_serial *serial;

    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    assert_int_equal(grobo_serial_open(serial), GROBO_ERR_NOENT);
    grobo_serial_free(serial);
    assert_int_equal(grobo_port_resolve("tcp:127.0.0.1:80", numeric, sizeof numeric, &cause), 0);
    assert_string_equal(numeric, "tcp:127.0.0.1:80");
    assert_int_equal(grobo_port_resolve("tcp:[::1]:80", numeric, sizeof numeric, &cause), 0);
    assert_string_equal(numeric, "tcp:[::1]:80");
    assert_int_equal(grobo_port_resolve("/dev/ttyS0", numeric, sizeof numeric, &cause), 0);
    assert_string_equal(numeric, "/dev/ttyS0");
    assert_int_equal(grobo_port_resolve("/dev/ttyS0", numeric, 5, &cause), GROBO_ERR_SPACE);
    assert_int_equal(grobo_port_resolve("tcp:x", numeric, sizeof numeric, &cause), GROBO_ERR_ARG);
    assert_string_equal(numeric, "/dev/ttyS0");
}
