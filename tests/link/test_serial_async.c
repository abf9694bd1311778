/* SPDX-License-Identifier: MIT */
/* The serial port on an event loop, on a pty or a cable. */
#include <stdint.h>
#include <string.h>

#include <event2/event.h>

#include <grobo/core/serial.h>

#include "src/link/serial/serial.h"
#include "tests/support/counted_mem.h"
#include "tests/support/line.h"
#include "tests/support/loop.h"
#include "tests/support/os.h"
#include "tests/support/test.h"

static test_line line;
/* Of the calls that wait, which none of this mode does: longer than a busy machine may take. */
enum { SILENCE_MS = 2000 };

static struct event_base *base;
static grobo_serial *serial;
static counted_mem counter; /* of the port's memory */
static grobo_mem mem;

/* What the callbacks saw. */
static struct {
    uint8_t bytes[65536];
    size_t size;
    size_t stop_at;  /* leave the loop when so many bytes came */
    int events[4];   /* by grobo_serial_event */
    int stop_events; /* bits of events that end the loop */
    int error;       /* of the last event */
    bool free_on_data, free_on_event, reopen_on_event;
    bool floods;      /* bytes are counted only */
    size_t flood;     /* a flood's bytes in one write */
    size_t tapped[2]; /* by grobo_direction */
} seen;

static void on_data(void *ctx, grobo_serial *from, const uint8_t *bytes, size_t size)
{
    assert_ptr_equal(ctx, &seen);
    assert_true(size > 0);
    if (seen.floods) {
        return;
    }
    assert_true(size <= sizeof seen.bytes - seen.size);
    memcpy(seen.bytes + seen.size, bytes, size);
    seen.size += size;
    if (seen.free_on_data) {
        grobo_serial_free(from);
        serial = NULL;
    }
    if (seen.size >= seen.stop_at) {
        event_base_loopbreak(base);
    }
}

static void on_event(void *ctx, grobo_serial *from, grobo_serial_event event, int error)
{
    assert_ptr_equal(ctx, &seen);
    seen.events[event]++;
    seen.error = error;
    if (seen.free_on_event) {
        grobo_serial_free(from);
        serial = NULL;
    }
    if (seen.reopen_on_event && event == GROBO_SERIAL_UNPLUGGED) {
        assert_int_equal(grobo_serial_set_device(from, line.device), GROBO_OK);
        assert_int_equal(grobo_serial_open(from), GROBO_OK);
    }
    if ((seen.stop_events & (1 << event)) != 0) {
        event_base_loopbreak(base);
    }
}

static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    assert_ptr_equal(ctx, &seen);
    assert_true(now_us > 0);
    assert_non_null(bytes);
    seen.tapped[direction] += size;
}

static void run_until_bytes(size_t size)
{
    seen.stop_at = size;
    if (seen.size < size) {
        assert_false(loop_run(base, 5000000));
    }
    assert_int_equal(seen.size, size);
}

static void run_until_event(grobo_serial_event event)
{
    seen.stop_events = 1 << event;
    assert_false(loop_run(base, 5000000));
}

static int set_up(void)
{
    const grobo_serial_config config = {
        GROBO_SERIAL_CONFIG_INIT, .device = line.device, .mode = GROBO_SERIAL_ASYNC,
        .silence_ms = SILENCE_MS, .on_data = on_data,    .on_event = on_event,
        .on_tap = on_tap,         .ctx = &seen,
    };
    grobo_serial_config with_base = config;

    counter = (counted_mem){0};
    mem = counted_mem_of(&counter);
    with_base.mem = &mem;
    memset(&seen, 0, sizeof seen);
    seen.stop_at = SIZE_MAX;
    test_line_open(&line);
    base = grobo_loop_new();
    with_base.base = base;
    assert_non_null(base);
    assert_int_equal(grobo_serial_new(&with_base, &serial), GROBO_OK);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    assert_int_equal(seen.events[GROBO_SERIAL_OPENED], 0);
    run_until_event(GROBO_SERIAL_OPENED);
    return 0;
}

static int tear_down(void)
{
    grobo_serial_free(serial);
    event_base_free(base);
    test_line_close(&line);
    return 0;
}

static const test_fixture on_line[] = {{NULL, set_up, tear_down}};

TEST_WITH(on_line, bytes_come_by_callback_and_leave_by_send)
{
    uint8_t back[3];

    test_line_write(&line, "hello", 5);
    run_until_bytes(5);
    assert_memory_equal(seen.bytes, "hello", 5);
    assert_int_equal(grobo_serial_send(serial, "abc", 3), 3);
    test_line_read(&line, back, 3);
    assert_memory_equal(back, "abc", 3);
    assert_int_equal(seen.tapped[GROBO_DIR_RX], 5);
    assert_int_equal(seen.tapped[GROBO_DIR_TX], 3);
    assert_int_equal(grobo_serial_pending(serial), 0);
}

TEST_WITH(on_line, nothing_waits_in_this_mode)
{
    uint8_t byte;
    int64_t start_us = grobo_now_us();

    assert_int_equal(grobo_serial_receive(serial, &byte, 1), GROBO_ERR_STATE);
    assert_int_equal(grobo_serial_read(serial, &byte, 1), 0);
    assert_int_equal(grobo_serial_set_mode(serial, GROBO_SERIAL_SYNC), GROBO_ERR_STATE);
    assert_int_equal(grobo_serial_get_mode(serial), GROBO_SERIAL_ASYNC);
    assert_true(grobo_now_us() - start_us < 1000 * SILENCE_MS);
    grobo_serial_close(serial);
    assert_int_equal(grobo_serial_set_mode(serial, GROBO_SERIAL_SYNC), GROBO_OK);
    assert_int_equal(grobo_serial_get_mode(serial), GROBO_SERIAL_SYNC);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    test_line_write(&line, "s", 1);
    assert_int_equal(grobo_serial_receive(serial, &byte, 1), 1); /* as this mode does */
    assert_int_equal(byte, 's');
}

/* Fills the line and the queue; returns how many bytes of a counting pattern were taken. */
static size_t fill(size_t block_bytes)
{
    uint8_t block[512];
    size_t total = 0;

    for (;;) {
        int r;

        for (size_t i = 0; i < block_bytes; i++) {
            block[i] = (uint8_t)((total + i) % 251);
        }
        r = grobo_serial_send(serial, block, block_bytes);
        if (r == GROBO_ERR_FULL) {
            return total;
        }
        assert_int_equal(r, block_bytes);
        total += block_bytes;
        if (total >= 1000000) {
            test_line_needs_pty("this line takes bytes as fast as they are written");
        }
        assert_true(total < 1000000);
    }
}

static void on_master(evutil_socket_t fd, short what, void *arg)
{
    (void)fd;
    (void)what;
    (void)arg;
    seen.size += test_line_read_some(&line, seen.bytes + seen.size, 1000);
}

TEST_WITH(on_line, a_full_queue_refuses_and_drains_in_order)
{
    size_t total = fill(500);
    grobo_serial_counters counters;
    struct event *reader;

    assert_true(grobo_serial_pending(serial) > 0);
    assert_true(grobo_serial_pending(serial) <= GROBO_SERIAL_QUEUE_BYTES);
    assert_int_equal(grobo_serial_write(serial, "x", 1), 0);
    grobo_serial_get_counters(serial, &counters);
    assert_int_equal(counters.full, 1);
    assert_true(counters.short_writes > 0);

    reader = event_new(base, line.fd, EV_READ | EV_PERSIST, on_master, NULL);
    assert_non_null(reader);
    assert_int_equal(event_add(reader, NULL), 0);
    run_until_event(GROBO_SERIAL_DRAINED);
    assert_int_equal(seen.events[GROBO_SERIAL_DRAINED], 1);
    assert_int_equal(grobo_serial_pending(serial), 0);
    event_free(reader);
    test_line_read(&line, seen.bytes + seen.size, total - seen.size);
    for (size_t i = 0; i < total; i++) {
        assert_int_equal(seen.bytes[i], i % 251);
    }
}

/* ---- a peer that never pauses -------------------------------------------------------------- */

static void on_room(evutil_socket_t fd, short what, void *arg)
{
    static const uint8_t rubbish[READ_BYTES];

    (void)fd;
    (void)what;
    (void)arg;
    (void)test_line_write_some(&line, rubbish, seen.flood);
}

/* The loop runs while the far end writes `flood` bytes whenever the line takes some. */
static grobo_serial_counters run_flooded(size_t flood)
{
    grobo_serial_counters counters;
    struct event *writer = event_new(base, line.fd, EV_WRITE | EV_PERSIST, on_room, NULL);

    assert_non_null(writer);
    assert_int_equal(event_add(writer, NULL), 0);
    seen.floods = true;
    seen.flood = flood;
    assert_true(loop_run(base, 700000));
    event_free(writer);
    grobo_serial_get_counters(serial, &counters);
    return counters;
}

/* What had been written is read, and then the line is as it was. */
static void assert_works_after_flood(void)
{
    uint64_t before;
    grobo_serial_counters counters = {.rx_bytes = 1};

    do {
        before = counters.rx_bytes;
        assert_true(loop_run(base, 50000));
        grobo_serial_get_counters(serial, &counters);
    } while (counters.rx_bytes != before);
    seen.floods = false;
    test_line_write(&line, "hello", 5);
    run_until_bytes(5);
    assert_memory_equal(seen.bytes, "hello", 5);
}

TEST_WITH(on_line, a_flood_is_read_no_faster_than_a_line_brings_bytes)
{
    int64_t budget_us = READ_BUDGET_US - grobo_now_us();
    grobo_serial_counters counters;

    test_line_needs_pty("more bytes than a line brings");
    counters = run_flooded(READ_BYTES);
    budget_us += grobo_now_us();
    assert_true(counters.rx_bytes > READ_BUDGET_US / 2); /* it does not stop reading */
    assert_true(counters.rx_bytes <= (uint64_t)budget_us + READ_BYTES);
    assert_works_after_flood();
}

TEST_WITH(on_line, a_flood_of_single_bytes_wakes_the_loop_no_faster)
{
    int64_t budget_us = READ_BUDGET_US - grobo_now_us();
    grobo_serial_counters counters;

    test_line_needs_pty("more bytes than a line brings");
    counters = run_flooded(1);
    budget_us += grobo_now_us();
    assert_true(counters.reads <= (uint64_t)(budget_us / READ_COST_US) + 1);
    assert_works_after_flood();
}

/* A callback that reads until nothing is left, as a session does, comes to an end. */
TEST_WITH(on_line, reading_a_flood_in_one_callback_ends)
{
    static uint8_t buf[READ_BYTES];
    int64_t end_us = grobo_now_us() + 500000;
    size_t total = 0;

    test_line_needs_pty("more bytes than a line brings");
    while (grobo_now_us() < end_us) {
        int got = grobo_serial_read(serial, buf, sizeof buf);

        assert_true(got >= 0);
        total += (size_t)got;
        (void)test_line_write_some(&line, buf, sizeof buf);
    }
    assert_true(total <= READ_BUDGET_US + 500000 + sizeof buf);
    seen.floods = true;
    assert_works_after_flood();
}

TEST_WITH(on_line, queued_bytes_can_be_dropped)
{
    (void)fill(500);
    grobo_serial_discard_output(serial);
    assert_int_equal(grobo_serial_pending(serial), 0);
    assert_true(loop_run(base, 20000));
    assert_int_equal(seen.events[GROBO_SERIAL_DRAINED], 0);
}

TEST_WITH(on_line, a_hang_up_is_one_event_and_then_silence)
{
    int64_t hung_up_us;
    int64_t cpu_before_us;

    test_line_needs_pty("a hang-up");
    test_line_close(&line);
    hung_up_us = grobo_now_us();
    run_until_event(GROBO_SERIAL_UNPLUGGED);
    assert_true(grobo_now_us() - hung_up_us < 500000); /* test_reconnect.c has the true bound */
    assert_int_equal(seen.error, GROBO_ERR_UNPLUGGED);
    assert_false(grobo_serial_is_open(serial));
    assert_true(strlen(grobo_serial_cause(serial)->text) > 0);

    cpu_before_us = test_cpu_us();
    assert_true(loop_run(base, 1000000));
    assert_true(test_cpu_us() - cpu_before_us < 10000); /* a hundredth */
    assert_int_equal(seen.events[GROBO_SERIAL_UNPLUGGED], 1);
    assert_int_equal(grobo_serial_send(serial, "x", 1), GROBO_ERR_CLOSED);
}

TEST_WITH(on_line, a_hang_up_with_bytes_queued_is_one_event)
{
    test_line_needs_pty("a hang-up");
    (void)fill(500);
    test_line_close(&line);
    run_until_event(GROBO_SERIAL_UNPLUGGED);
    assert_true(loop_run(base, 20000));
    assert_int_equal(seen.events[GROBO_SERIAL_UNPLUGGED], 1);
    assert_int_equal(seen.events[GROBO_SERIAL_DRAINED], 0);
    assert_int_equal(grobo_serial_pending(serial), 0);
}

TEST_WITH(on_line, a_hang_up_found_by_send_is_told_from_the_loop)
{
    test_line_needs_pty("a hang-up");
    test_line_close(&line);
    assert_int_equal(grobo_serial_send(serial, "x", 1), GROBO_ERR_UNPLUGGED);
    assert_int_equal(seen.events[GROBO_SERIAL_UNPLUGGED], 0);
    run_until_event(GROBO_SERIAL_UNPLUGGED);
    assert_int_equal(seen.events[GROBO_SERIAL_UNPLUGGED], 1);
}

TEST_WITH(on_line, closing_drops_what_was_not_told_yet)
{
    test_line_needs_pty("a hang-up");
    test_line_close(&line);
    assert_int_equal(grobo_serial_send(serial, "x", 1), GROBO_ERR_UNPLUGGED);
    grobo_serial_close(serial);
    assert_true(loop_run(base, 20000));
    assert_int_equal(seen.events[GROBO_SERIAL_UNPLUGGED], 0);
}

TEST_WITH(on_line, a_lost_port_may_be_opened_again_in_its_event)
{
    test_line old = line;

    test_line_needs_pty("a hang-up");
    test_line_open(&line);
    seen.reopen_on_event = true;
    test_line_close(&old);
    run_until_event(GROBO_SERIAL_OPENED);
    assert_int_equal(seen.events[GROBO_SERIAL_UNPLUGGED], 1);
    assert_int_equal(seen.events[GROBO_SERIAL_OPENED], 2);
    test_line_write(&line, "back", 4);
    run_until_bytes(4);
    assert_memory_equal(seen.bytes, "back", 4);
}

TEST_WITH(on_line, it_may_be_freed_in_on_data)
{
    seen.free_on_data = true;
    test_line_write(&line, "x", 1);
    run_until_bytes(1);
    assert_null(serial);
    assert_true(loop_run(base, 10000));
    assert_int_equal(counter.bytes, 0);
}

TEST_WITH(on_line, it_may_be_freed_in_on_event)
{
    test_line_needs_pty("a hang-up");
    seen.free_on_event = true;
    test_line_close(&line);
    run_until_event(GROBO_SERIAL_UNPLUGGED);
    assert_null(serial);
    assert_true(loop_run(base, 10000));
}

TEST_WITH(on_line, each_lack_of_memory_is_told_and_leaks_nothing)
{
    counted_mem few;
    const grobo_mem few_mem = counted_mem_of(&few);
    const grobo_serial_config config = {
        GROBO_SERIAL_CONFIG_INIT,   .device = line.device, .base = base,
        .mode = GROBO_SERIAL_ASYNC, .on_data = on_data,    .mem = &few_mem};
    int failures = 0;
    int r = GROBO_ERR_NOMEM;

    grobo_serial_close(serial);
    for (size_t n = 1; r == GROBO_ERR_NOMEM; n++) {
        grobo_serial *made = NULL;

        assert_true(n <= 20);
        few = (counted_mem){.fail_at = n};
        r = grobo_serial_new(&config, &made);
        if (r == GROBO_OK) {
            r = grobo_serial_open(made);
            grobo_serial_free(made);
        } else {
            assert_null(made);
        }
        failures += r == GROBO_ERR_NOMEM ? 1 : 0;
        assert_int_equal(few.bytes, 0);
    }
    assert_int_equal(r, GROBO_OK);
    assert_int_equal(failures, 3);
}
