/* SPDX-License-Identifier: MIT */
/* A process that is held up does not take what waits for it for a servo's silence. */
#include <poll.h>
#include <stdint.h>

#include <event2/event.h>

#include <grobo/core/robot.h>
#include <grobo/core/static.h>
#include <grobo/session.h>

#include "tests/support/line.h"
#include "tests/support/loop.h"
#include "tests/support/test.h"

static const uint8_t ACK = 0x07; /* of the board, to a check */

static test_line line;
static struct event_base *base;
static grobo_session *session;
static grobo_timer *answer;
static int ups;

static void on_event(void *ctx, grobo_session *from, grobo_session_event event, int error)
{
    (void)from;
    (void)ctx;
    assert_int_equal(event, GROBO_SESSION_EVENT_UP);
    assert_int_equal(error, GROBO_OK);
    ups++;
    event_base_loopbreak(base);
}

/*
 * The request has come. Until the loop goes on, the answer's time and the session's time limit both
 * have passed: it runs them one after the other, without a look at the line between them.
 */
static void on_request(evutil_socket_t fd, short what, void *ctx)
{
    uint8_t request[2];
    int64_t limit_us = grobo_robot_deadline(grobo_session_robot(session), grobo_now_us());

    (void)fd;
    (void)what;
    (void)ctx;
    test_line_read(&line, request, sizeof request);
    assert_int_equal(request[0], 0x41);
    assert_int_not_equal(limit_us, GROBO_NEVER_US);
    assert_int_equal(grobo_timer_set(answer, grobo_now_us()), GROBO_OK);
    assert_true(grobo_timer_deadline(answer) < limit_us);
    while (grobo_now_us() <= limit_us) {
    }
}

/* Returns when the answer lies before the session. */
static void on_answer(void *ctx, grobo_timer *timer, int64_t late_us)
{
    struct pollfd near = {.fd = grobo_serial_handle(grobo_session_serial(session)),
                          .events = POLLIN};

    (void)timer;
    (void)late_us;
    (void)ctx;
    test_line_write(&line, &ACK, sizeof ACK);
    assert_int_equal(poll(&near, 1, 5000), 1);
}

TEST(what_has_come_is_read_before_time_is_up)
{
    /* No smaller than what a loaded machine may take between the request and on_request(). */
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT, .bus.margin_us = 1000000};
    grobo_session_config config = {GROBO_SESSION_CONFIG_INIT, .on_event = on_event,
                                   .robot = &robot};
    const grobo_bus_stats *stats;
    struct event *request;

    test_line_open(&line);
    base = grobo_loop_new();
    assert_non_null(base);
    config.base = base;
    config.device = line.device;
    request = event_new(base, line.fd, EV_READ, on_request, NULL);
    assert_non_null(request);
    assert_int_equal(event_add(request, NULL), 0);
    assert_int_equal(grobo_timer_new(base, on_answer, NULL, NULL, &answer), GROBO_OK);
    assert_int_equal(grobo_session_new(&config, &session), GROBO_OK);
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    assert_false(loop_run(base, 10000000));
    assert_int_equal(ups, 1);
    stats = grobo_robot_get_bus_stats(grobo_session_robot(session));
    assert_int_equal(stats->tx_frames, 1);
    assert_int_equal(stats->replies, 1);
    assert_int_equal(stats->timeouts, 0);
    grobo_session_free(session);
    grobo_timer_free(answer);
    event_free(request);
    event_base_free(base);
    test_line_close(&line);
}
