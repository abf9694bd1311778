/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <string.h>

#include <event2/event.h>

#include <grobo/core/loop.h>

#include "tests/support/loop.h"
#include "tests/support/session_kit.h"
#include "tests/support/test.h"

struct event_base *base;
grobo_session *session;
session_seen seen;

static void on_event(void *ctx, grobo_session *from, grobo_session_event event, int error)
{
    assert_ptr_equal(ctx, &seen);
    seen.error = error;
    seen.at_us = grobo_now_us();
    switch (event) {
    case GROBO_SESSION_EVENT_UP:
        seen.ups++;
        break;
    case GROBO_SESSION_EVENT_LOST:
        seen.losts++;
        break;
    case GROBO_SESSION_EVENT_FAILED:
        seen.fails++;
        break;
    case GROBO_SESSION_EVENT_UNGUARDED:
        seen.unguarded++;
        break;
    }
    if (seen.then_line != NULL) {
        seen.then_line(from);
    }
    event_base_loopbreak(base);
}

static void on_robot(void *ctx, const grobo_event *event)
{
    assert_ptr_equal(ctx, &seen);
    seen.robot++;
    if (event->kind == GROBO_EVENT_JOB) {
        seen.job = event->u.job.number;
        seen.result = event->u.job.result;
        event_base_loopbreak(base);
    }
    if (seen.then_robot != NULL) {
        seen.then_robot(event);
    }
}

static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    assert_ptr_equal(ctx, &seen);
    assert_true(now_us > 0);
    assert_non_null(bytes);
    seen.tapped[direction] += size;
    seen.taps[direction]++;
}

void session_kit_begin(void)
{
    memset(&seen, 0, sizeof seen);
    session = NULL;
    base = grobo_loop_new();
    assert_non_null(base);
}

void session_kit_make(grobo_session_config config)
{
    /* No test without a configuration of its own is of how late a reply is. On a busy machine the
     * system hands on the bytes of a pseudo-terminal 170 ms later. */
    static const grobo_robot_config patient = {GROBO_ROBOT_CONFIG_INIT, .timeout_us = 300000,
                                               .stall_us = 30000000};

    config.robot = config.robot != NULL ? config.robot : &patient;
    config.base = base;
    config.on_event = on_event;
    config.on_robot = on_robot;
    config.on_tap = on_tap;
    config.ctx = &seen;
    assert_int_equal(grobo_session_new(&config, &session), GROBO_OK);
}

int session_kit_await(int job)
{
    assert_true(job > 0);
    loop_run_until(base, &seen.job, job);
    assert_int_equal(seen.job, job);
    return seen.result;
}

void session_kit_end(void)
{
    grobo_session_free(session);
    event_base_free(base);
}
