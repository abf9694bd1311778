/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include <event2/event.h>

#include <grobo/core/loop.h>
#include <grobo/core/port.h>

#include "tests/support/loop.h"
#include "tests/support/test.h"

typedef struct bounded_wait {
    struct event_base *base;
    bool passed;
} bounded_wait;

static void on_end_of_wait(void *ctx, grobo_timer *timer, int64_t late_us)
{
    bounded_wait *w = ctx;

    (void)timer;
    (void)late_us;
    w->passed = true;
    event_base_loopbreak(w->base);
}

bool loop_run(struct event_base *base, int64_t span_us)
{
    bounded_wait w = {.base = base};
    grobo_timer *timer;

    assert_int_equal(grobo_timer_new(base, on_end_of_wait, &w, NULL, &timer), GROBO_OK);
    assert_int_equal(grobo_timer_set(timer, grobo_now_us() + span_us), GROBO_OK);
    event_base_dispatch(base);
    grobo_timer_free(timer);
    return w.passed;
}

void loop_run_until(struct event_base *base, const int *count, int wanted)
{
    int64_t end_us = grobo_now_us() + 20000000;

    while (*count < wanted) {
        assert_true(grobo_now_us() < end_us);
        (void)loop_run(base, end_us - grobo_now_us());
    }
}

void loop_run_for(struct event_base *base, int64_t span_us)
{
    int64_t end_us = grobo_now_us() + span_us;

    while (grobo_now_us() < end_us) {
        (void)loop_run(base, end_us - grobo_now_us());
    }
}

grobo_sim_server *loop_serve(struct event_base *base, grobo_sim_server_config config)
{
    grobo_sim_server *server = NULL;
    grobo_os_cause cause = {0};

    config.base = base;
    assert_int_equal(grobo_sim_server_new(&config, &server, &cause), GROBO_OK);
    return server;
}
