/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include <event2/event.h>

#include <grobo/core/loop.h>
#include <grobo/core/port.h>

#include "tests/support/test.h"

typedef struct {
    struct event_base *base;
    grobo_timer *timer;
    int calls;
    int wanted;
    int64_t next_us;
    int64_t earliest_us; /* least (now - deadline) seen */
} ticker;

static void on_tick(void *ctx, grobo_timer *timer, int64_t late_us)
{
    ticker *t = ctx;
    int64_t since_us = grobo_now_us() - t->next_us;

    assert_true(late_us >= 0);
    assert_int_equal(grobo_timer_deadline(timer), GROBO_NEVER_US);
    if (since_us < t->earliest_us) {
        t->earliest_us = since_us;
    }
    t->calls++;
    if (t->calls < t->wanted) {
        t->next_us += 2000;
        assert_int_equal(grobo_timer_set(timer, t->next_us), GROBO_OK);
    } else {
        event_base_loopbreak(t->base);
    }
}

static void run_ticks(struct event_base *base)
{
    ticker t = {.base = base, .wanted = 50, .earliest_us = INT64_MAX};
    int64_t start_us = grobo_now_us();
    int64_t took_us;

    assert_int_equal(grobo_timer_new(base, on_tick, &t, NULL, &t.timer), GROBO_OK);
    t.next_us = start_us + 2000;
    assert_int_equal(grobo_timer_set(t.timer, t.next_us), GROBO_OK);
    event_base_dispatch(base);
    took_us = grobo_now_us() - start_us;
    assert_int_equal(t.calls, 50);
    assert_true(t.earliest_us >= 0);
    /* 50 periods of 2 ms: each late by itself, none late for ever. The slack is for a busy host. */
    assert_true(took_us >= 100000);
    assert_true(took_us < 100000 + 1000000);
    grobo_timer_free(t.timer);
    event_base_free(base);
}

TEST(a_period_is_kept_and_never_early)
{
    struct event_base *base = grobo_loop_new();

    assert_non_null(base);
    run_ticks(base);
}

TEST(a_base_with_a_coarse_clock_is_never_early_either)
{
    struct event_base *base = event_base_new();

    assert_non_null(base);
    run_ticks(base);
}

static void free_in_callback(void *ctx, grobo_timer *timer, int64_t late_us)
{
    (void)late_us;
    ++*(int *)ctx;
    grobo_timer_free(timer);
}

TEST(a_past_deadline_is_called_from_the_loop_and_may_free)
{
    static const int64_t passed_us[] = {0, -1, INT64_MIN};
    struct event_base *base = grobo_loop_new();
    grobo_timer *timer;
    int calls = 0;

    for (int i = 0; i < 3; i++) {
        assert_int_equal(grobo_timer_new(base, free_in_callback, &calls, NULL, &timer), GROBO_OK);
        assert_int_equal(grobo_timer_set(timer, passed_us[i]), GROBO_OK);
        assert_int_equal(calls, i);
        event_base_dispatch(base);
        assert_int_equal(calls, i + 1);
    }
    event_base_free(base);
}

TEST(never_disarms)
{
    struct event_base *base = grobo_loop_new();
    grobo_timer *timer;
    int calls = 0;

    assert_int_equal(grobo_timer_new(base, free_in_callback, &calls, NULL, &timer), GROBO_OK);
    assert_int_equal(grobo_timer_set(timer, grobo_now_us() - 1), GROBO_OK);
    assert_int_equal(grobo_timer_set(timer, GROBO_NEVER_US), GROBO_OK);
    /* 1: no event is left to wait for. */
    assert_int_equal(event_base_dispatch(base), 1);
    assert_int_equal(calls, 0);
    assert_int_equal(grobo_timer_deadline(timer), GROBO_NEVER_US);
    grobo_timer_free(timer);
    grobo_timer_free(NULL);
    event_base_free(base);
}

/* A socket that is always readable, and a timer that is set anew whenever it is. */
typedef struct busy_loop {
    struct event_base *base;
    grobo_timer *timer;
    int rounds, calls;
} busy_loop;

static void set_anew(evutil_socket_t socket, short what, void *ctx)
{
    busy_loop *busy = ctx;

    (void)socket;
    (void)what;
    assert_int_equal(grobo_timer_set(busy->timer, grobo_now_us()), GROBO_OK);
    if (++busy->rounds == 100) {
        event_base_loopbreak(busy->base);
    }
}

static void end_busy_loop(void *ctx, grobo_timer *timer, int64_t late_us)
{
    busy_loop *busy = ctx;

    (void)timer;
    assert_true(late_us >= 0);
    busy->calls++;
    event_base_loopbreak(busy->base);
}

TEST(what_is_due_is_called_though_it_is_set_anew)
{
    busy_loop busy = {.base = grobo_loop_new()};
    evutil_socket_t pair[2];
    struct event *event;

    assert_int_equal(grobo_timer_new(busy.base, end_busy_loop, &busy, NULL, &busy.timer), GROBO_OK);
    assert_int_equal(evutil_socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
    assert_int_equal(send(pair[1], "", 1, 0), 1);
    event = event_new(busy.base, pair[0], EV_READ | EV_PERSIST, set_anew, &busy);
    assert_non_null(event);
    assert_int_equal(event_add(event, NULL), 0);
    event_base_dispatch(busy.base);
    assert_int_equal(busy.calls, 1);
    event_free(event);
    evutil_closesocket(pair[0]);
    evutil_closesocket(pair[1]);
    grobo_timer_free(busy.timer);
    event_base_free(busy.base);
}

static void *no_memory(void *ctx, void *ptr, size_t old_bytes, size_t new_bytes)
{
    (void)ctx;
    (void)ptr;
    (void)old_bytes;
    (void)new_bytes;
    return NULL;
}

TEST(refusals)
{
    static const grobo_mem none = {no_memory, NULL};
    struct event_base *base = grobo_loop_new();
    grobo_timer *timer = NULL;

    assert_int_equal(grobo_timer_new(NULL, on_tick, NULL, NULL, &timer), GROBO_ERR_ARG);
    assert_int_equal(grobo_timer_new(base, NULL, NULL, NULL, &timer), GROBO_ERR_ARG);
    assert_int_equal(grobo_timer_new(base, on_tick, NULL, &none, &timer), GROBO_ERR_NOMEM);
    assert_null(timer);
    event_base_free(base);
}
