/* SPDX-License-Identifier: MIT */
/* Clock, threads, locks and waiting: what every port brings. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <grobo/core/port.h>

#include "ports/common/common.h"
#include "tests/support/test.h"

TEST(the_clock_goes_on)
{
    int64_t before_us = grobo_now_us();

    assert_true(before_us > 0);
    for (int i = 0; i < 1000; i++) {
        int64_t now_us = grobo_now_us();

        assert_true(now_us >= before_us);
        before_us = now_us;
    }
}

/* A socket on which nothing comes. */
static grobo_socket silent_socket(void)
{
    grobo_os_cause cause;
    grobo_socket made = GROBO_SOCKET_NULL;
    int tcp_port;

    assert_int_equal(grobo_port_listen("tcp:127.0.0.1:0", &made, &tcp_port, &cause), GROBO_OK);
    assert_int_equal(grobo_port_start(), GROBO_OK);
    return made;
}

TEST(the_clock_counts_microseconds)
{
    grobo_socket silent = silent_socket();
    int64_t start_us = grobo_now_us();
    int64_t took_us;

    assert_int_equal(grobo_port_wait(silent, GROBO_PORT_READABLE, 50000), 0);
    took_us = grobo_now_us() - start_us;
    assert_true(took_us >= 50000);
    assert_true(took_us < 1000000);
    grobo_port_listen_close(silent);
}

typedef struct {
    grobo_mutex mutex;
    int count;
    grobo_thread self;
} shared;

static GROBO_THREAD_FUNC count_up(void *arg)
{
    shared *s = arg;

    for (int i = 0; i < 10000; i++) {
        grobo_mutex_lock(&s->mutex);
        s->count++;
        grobo_mutex_unlock(&s->mutex);
    }
    GROBO_THREAD_RETURN;
}

TEST(threads_exclude_each_other)
{
    shared s = {.count = 0};
    grobo_thread threads[4];

    assert_int_equal(grobo_mutex_init(&s.mutex), GROBO_OK);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(grobo_thread_start(&threads[i], count_up, &s), GROBO_OK);
        assert_false(grobo_thread_is_self(threads[i]));
    }
    for (int i = 0; i < 4; i++) {
        assert_int_equal(grobo_thread_join(threads[i]), GROBO_OK);
    }
    assert_int_equal(s.count, 40000);
    grobo_mutex_deinit(&s.mutex);
}

/* Two threads that pass a turn to each other at a condition. */
typedef struct {
    grobo_mutex mutex;
    grobo_cond cond;
    int turn;
    int64_t until_us;
} passing;

enum { TURNS = 2000 };

static GROBO_THREAD_FUNC take_odd_turns(void *arg)
{
    passing *p = arg;

    grobo_mutex_lock(&p->mutex);
    while (p->turn < TURNS) {
        if (p->turn % 2 == 1) {
            p->turn++;
            grobo_cond_wake_all(&p->cond);
        } else {
            grobo_cond_wait(&p->cond, &p->mutex, p->until_us);
        }
    }
    grobo_mutex_unlock(&p->mutex);
    GROBO_THREAD_RETURN;
}

TEST(a_condition_wakes_who_sleeps)
{
    static const int64_t untils_us[] = {GROBO_NEVER_US, GROBO_NEVER_US - 1};

    for (int i = 0; i < 2; i++) {
        passing p = {.turn = 0, .until_us = untils_us[i]};
        grobo_thread other;

        assert_int_equal(grobo_mutex_init(&p.mutex), GROBO_OK);
        assert_int_equal(grobo_cond_init(&p.cond), GROBO_OK);
        assert_int_equal(grobo_thread_start(&other, take_odd_turns, &p), GROBO_OK);
        grobo_mutex_lock(&p.mutex);
        while (p.turn < TURNS) {
            if (p.turn % 2 == 0) {
                p.turn++;
                grobo_cond_wake_all(&p.cond);
            } else {
                grobo_cond_wait(&p.cond, &p.mutex, p.until_us);
            }
        }
        grobo_mutex_unlock(&p.mutex);
        assert_int_equal(grobo_thread_join(other), GROBO_OK);
        grobo_cond_deinit(&p.cond);
        grobo_mutex_deinit(&p.mutex);
    }
}

TEST(sleeping_at_a_condition_ends_in_time)
{
    passing p = {.turn = 0};
    int64_t start_us;
    int sleeps = 0;

    assert_int_equal(grobo_mutex_init(&p.mutex), GROBO_OK);
    assert_int_equal(grobo_cond_init(&p.cond), GROBO_OK);
    grobo_mutex_lock(&p.mutex);
    start_us = grobo_now_us();
    grobo_cond_wait(&p.cond, &p.mutex, start_us - 1); /* has passed */
    while (grobo_now_us() < start_us + 50000) {
        grobo_cond_wait(&p.cond, &p.mutex, start_us + 50000);
        sleeps++;
    }
    assert_in_range(sleeps, 1, 100); /* it does not spin */
    assert_true(grobo_now_us() < start_us + 1000000);
    grobo_mutex_unlock(&p.mutex);
    grobo_cond_deinit(&p.cond);
    grobo_mutex_deinit(&p.mutex);
}

static GROBO_THREAD_FUNC join_self(void *arg)
{
    shared *s = arg;

    grobo_mutex_lock(&s->mutex);
    s->count = grobo_thread_is_self(s->self) ? grobo_thread_join(s->self) : 1;
    grobo_mutex_unlock(&s->mutex);
    GROBO_THREAD_RETURN;
}

TEST(a_thread_does_not_join_itself)
{
    shared s = {.count = 0};

    assert_int_equal(grobo_mutex_init(&s.mutex), GROBO_OK);
    grobo_mutex_lock(&s.mutex);
    assert_int_equal(grobo_thread_start(&s.self, join_self, &s), GROBO_OK);
    grobo_mutex_unlock(&s.mutex);
    assert_int_equal(grobo_thread_join(s.self), GROBO_OK);
    assert_int_equal(s.count, GROBO_ERR_STATE);
    assert_int_equal(grobo_thread_start(NULL, join_self, &s), GROBO_ERR_ARG);
    assert_int_equal(grobo_thread_start(&s.self, NULL, &s), GROBO_ERR_ARG);
    grobo_mutex_deinit(&s.mutex);
}

/* Calls a listener after a while. */
static GROBO_THREAD_FUNC call_later(void *arg)
{
    const grobo_port_ops *ops = grobo_port_tcp_ops();
    grobo_port *port = malloc(ops->size_bytes);
    grobo_socket silent = silent_socket();
    grobo_os_cause cause;

    assert_non_null(port);
    assert_int_equal(grobo_port_wait(silent, GROBO_PORT_READABLE, 50000), 0);
    assert_int_equal(ops->open(port, arg, 115200, &cause), GROBO_OK);
    ops->close(port);
    grobo_port_listen_close(silent);
    free(port);
    GROBO_THREAD_RETURN;
}

TEST(waiting_may_have_no_end)
{
    static const int64_t timeouts_us[] = {GROBO_NEVER_US, GROBO_NEVER_US - 1};

    for (int i = 0; i < 2; i++) {
        grobo_os_cause cause;
        grobo_socket listener;
        grobo_thread caller;
        char device[64];
        int tcp_port;

        assert_int_equal(grobo_port_listen("tcp:127.0.0.1:0", &listener, &tcp_port, &cause),
                         GROBO_OK);
        assert_true(snprintf(device, sizeof device, "tcp:127.0.0.1:%d", tcp_port) > 0);
        assert_int_equal(grobo_thread_start(&caller, call_later, device), GROBO_OK);
        assert_int_equal(grobo_port_wait(listener, GROBO_PORT_READABLE, timeouts_us[i]),
                         GROBO_PORT_READABLE);
        assert_int_equal(grobo_thread_join(caller), GROBO_OK);
        grobo_port_listen_close(listener);
    }
}

TEST(waiting_tells_what_is_ready)
{
    const grobo_port_ops *ops = grobo_port_tcp_ops();
    grobo_port *port = malloc(ops->size_bytes);
    grobo_os_cause cause;
    grobo_socket listener;
    char device[64];
    int tcp_port;

    assert_non_null(port);
    assert_int_equal(grobo_port_listen("tcp:127.0.0.1:0", &listener, &tcp_port, &cause), GROBO_OK);
    assert_int_equal(grobo_port_wait(listener, GROBO_PORT_READABLE, 0), 0);
    assert_int_equal(grobo_port_wait(listener, GROBO_PORT_READABLE, -5), 0);
    assert_true(snprintf(device, sizeof device, "tcp:127.0.0.1:%d", tcp_port) > 0);
    assert_int_equal(ops->open(port, device, 115200, &cause), GROBO_OK);
    assert_int_equal(
        grobo_port_wait(ops->socket(port), GROBO_PORT_READABLE | GROBO_PORT_WRITABLE, 1000000),
        GROBO_PORT_WRITABLE);
    assert_int_equal(grobo_port_wait(listener, GROBO_PORT_READABLE, 5000000), GROBO_PORT_READABLE);
    ops->close(port);
    grobo_port_listen_close(listener);
    free(port);
}

static int rate_taken(int asked_bps, int actual_bps)
{
    grobo_os_cause cause;

    return grobo_i_port_check_baud(asked_bps, actual_bps, &cause);
}

TEST(a_tolerance_of_two_percent)
{
    assert_int_equal(rate_taken(115200, 115200), 115200);
    assert_int_equal(rate_taken(115200, 117504), 117504);
    assert_int_equal(rate_taken(115200, 117600), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(rate_taken(76800, 76923), 76923);
    assert_int_equal(rate_taken(115200, 0), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(rate_taken(2000000, 115200), GROBO_ERR_UNSUPPORTED);
}
