/* SPDX-License-Identifier: MIT */
/* A serial port whose n-th call to the system fails, for every n and every way to fail. */
#include <stdint.h>
#include <string.h>

#include <event2/event.h>

#include <grobo/core/serial.h>

#include "tests/support/line.h"
#include "tests/support/test.h"

#define BYTES 300

/* What happens to the chosen call. */
typedef enum { NOTHING_NOW, ONE_BYTE, GONE, BROKEN } fate;

static const fate fates[] = {NOTHING_NOW, ONE_BYTE, GONE, BROKEN};

/* The real port behind the failing one, which has the same storage. */
static const grobo_port_ops *real;
static struct {
    fate fate;
    int countdown; /* calls until it strikes */
    bool struck;
    int opens, closes;
} fault;

static struct event_base *base;
static test_line line;
static struct event *echo;
static struct {
    uint8_t bytes[BYTES];
    size_t size;
    int losses;
    int error;
    bool late;
} seen;

/* ---- the failing port --------------------------------------------------------------------- */

static bool strikes(void)
{
    fault.countdown--;
    fault.struck = fault.struck || fault.countdown == 0;
    return fault.countdown == 0;
}

/* The result of a call that is struck; ONE_BYTE is for the caller to do. */
static int struck_result(grobo_os_cause *cause)
{
    memset(cause, 0, sizeof *cause);
    switch (fault.fate) {
    case NOTHING_NOW:
    case ONE_BYTE:
        return 0;
    case GONE:
        return GROBO_ERR_UNPLUGGED;
    case BROKEN:
        return GROBO_ERR_IO;
    }
    return 0;
}

static int failing_open(grobo_port *port, const char *device, int baud_bps, grobo_os_cause *cause)
{
    int r = strikes() ? struck_result(cause) : GROBO_OK;

    if (r >= 0) {
        r = real->open(port, device, baud_bps, cause);
    }
    fault.opens += r >= 0 ? 1 : 0;
    return r;
}

static void failing_close(grobo_port *port)
{
    fault.closes++;
    real->close(port);
}

static int failing_ready(grobo_port *port, grobo_os_cause *cause)
{
    return strikes() ? struck_result(cause) : real->ready(port, cause);
}

static int failing_read(grobo_port *port, void *buf, size_t size, grobo_os_cause *cause)
{
    if (strikes()) {
        return fault.fate == ONE_BYTE ? real->read(port, buf, 1, cause) : struck_result(cause);
    }
    return real->read(port, buf, size, cause);
}

static int failing_write(grobo_port *port, const void *buf, size_t size, grobo_os_cause *cause)
{
    if (strikes()) {
        return fault.fate == ONE_BYTE ? real->write(port, buf, 1, cause) : struck_result(cause);
    }
    return real->write(port, buf, size, cause);
}

/* ---- the other side ----------------------------------------------------------------------- */

static void on_master(evutil_socket_t fd, short what, void *arg)
{
    uint8_t buf[64];
    size_t size = test_line_read_some(&line, buf, sizeof buf);

    (void)fd;
    (void)what;
    (void)arg;
    if (size > 0) {
        test_line_write(&line, buf, size);
    }
}

static void on_data(void *ctx, grobo_serial *serial, const uint8_t *bytes, size_t size)
{
    (void)serial;
    (void)ctx;
    assert_true(size <= sizeof seen.bytes - seen.size);
    memcpy(seen.bytes + seen.size, bytes, size);
    seen.size += size;
    if (seen.size == BYTES) {
        event_base_loopbreak(base);
    }
}

static void on_event(void *ctx, grobo_serial *serial, grobo_serial_event event, int error)
{
    (void)serial;
    (void)ctx;
    if (event == GROBO_SERIAL_UNPLUGGED || event == GROBO_SERIAL_FAILED) {
        assert_int_equal(event == GROBO_SERIAL_UNPLUGGED, error == GROBO_ERR_UNPLUGGED);
        seen.losses++;
        seen.error = error;
        event_base_loopbreak(base);
    }
}

static void on_late(void *ctx, grobo_timer *timer, int64_t late_us)
{
    (void)timer;
    (void)late_us;
    (void)ctx;
    seen.late = true;
    event_base_loopbreak(base);
}

/* ---- the trial ---------------------------------------------------------------------------- */

/* Opens, sends bytes in three parts, has them echoed; the result of the first call that failed. */
static int run(grobo_serial *serial)
{
    uint8_t out[BYTES];
    int r = grobo_serial_open(serial);

    for (size_t i = 0; i < BYTES; i++) {
        out[i] = (uint8_t)(i % 251);
    }
    for (size_t at = 0; r >= 0 && at < BYTES; at += BYTES / 3) {
        r = grobo_serial_send(serial, out + at, BYTES / 3);
    }
    if (r >= 0 || grobo_serial_is_open(serial)) {
        event_base_dispatch(base);
    }
    if (r >= 0 && seen.losses == 0) {
        assert_int_equal(seen.size, BYTES);
        assert_memory_equal(seen.bytes, out, BYTES);
    }
    return r;
}

static void check(grobo_serial *serial, int r)
{
    int expected = fault.fate == GONE ? GROBO_ERR_UNPLUGGED : GROBO_ERR_IO;

    assert_false(seen.late);
    if (!fault.struck || fault.fate == NOTHING_NOW || fault.fate == ONE_BYTE) {
        assert_true(r >= 0);
        assert_int_equal(seen.losses, 0);
        assert_true(grobo_serial_is_open(serial));
    } else {
        /* Told once: by the call that met it, or by the event. */
        assert_true(r == expected || (r >= 0 && seen.losses == 1 && seen.error == expected));
        assert_false(grobo_serial_is_open(serial));
        assert_int_equal(fault.opens, fault.closes);
    }
}

static void try_one(fate what, int n)
{
    grobo_port_ops ops = *real;
    grobo_serial_config config = {
        GROBO_SERIAL_CONFIG_INIT, .device = line.device, .base = base, .mode = GROBO_SERIAL_ASYNC,
        .on_data = on_data,       .on_event = on_event,  .ops = &ops};
    grobo_serial *serial;
    grobo_timer *guard;

    ops.open = failing_open;
    ops.close = failing_close;
    ops.ready = failing_ready;
    ops.read = failing_read;
    ops.write = failing_write;
    memset(&seen, 0, sizeof seen);
    memset(&fault, 0, sizeof fault);
    fault.fate = what;
    fault.countdown = n;
    assert_int_equal(grobo_timer_new(base, on_late, NULL, NULL, &guard), GROBO_OK);
    assert_int_equal(grobo_timer_set(guard, grobo_now_us() + 5000000), GROBO_OK);
    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    check(serial, run(serial));
    grobo_serial_free(serial);
    assert_int_equal(fault.opens, fault.closes);
    grobo_timer_free(guard);
}

TEST(every_call_fails_once)
{
    real = grobo_port_serial_ops();
    base = grobo_loop_new();
    assert_non_null(base);
    for (size_t f = 0; f < sizeof fates / sizeof fates[0]; f++) {
        int n = 0;

        do {
            n++;
            test_line_open(&line);
            echo = event_new(base, line.fd, EV_READ | EV_PERSIST, on_master, NULL);
            assert_non_null(echo);
            assert_int_equal(event_add(echo, NULL), 0);
            try_one(fates[f], n);
            event_free(echo);
            test_line_close(&line);
        } while (fault.struck && n < 100);
        /* open, ready, three writes, a read at least */
        assert_true(n > 6);
    }
    event_base_free(base);
}

/* ---- what is not about bytes -------------------------------------------------------------- */

static int gone_baud(grobo_port *port, int baud_bps, grobo_os_cause *cause)
{
    (void)port;
    (void)baud_bps;
    (void)cause;
    return GROBO_ERR_UNPLUGGED;
}

static int gone(grobo_port *port, grobo_os_cause *cause)
{
    (void)port;
    (void)cause;
    return GROBO_ERR_UNPLUGGED;
}

static int set_baud(grobo_serial *serial)
{
    return grobo_serial_set_baud(serial, 57600);
}

TEST(a_call_that_finds_the_device_gone_closes_the_port)
{
    int (*const calls[])(grobo_serial * serial) = {set_baud, grobo_serial_set_low_latency,
                                                   grobo_serial_waiting};
    grobo_port_ops ops = *grobo_port_serial_ops();

    test_line_open(&line);
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = line.device, .ops = &ops};
        grobo_serial *serial;

        assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
        ops = *grobo_port_serial_ops();
        assert_int_equal(grobo_serial_open(serial), GROBO_OK);
        ops.set_baud = gone_baud;
        ops.set_low_latency = ops.waiting = gone;
        assert_int_equal(calls[i](serial), GROBO_ERR_UNPLUGGED);
        assert_false(grobo_serial_is_open(serial));
        assert_int_equal(calls[i](serial) < 0, i > 0); /* closed; a speed is for the next open */
        grobo_serial_free(serial);
    }
    test_line_close(&line);
}
