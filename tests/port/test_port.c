/* SPDX-License-Identifier: MIT */
/* Clock, threads, locks and waiting: what every port brings. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <signal.h>

#include <cmocka.h>

#include <grobo/port.h>

#include "line.h"

static void the_clock_goes_on(void **state)
{
    int64_t before_us = grobo_now_us();

    (void)state;
    assert_true(before_us > 0);
    for (int i = 0; i < 1000; i++) {
        int64_t now_us = grobo_now_us();

        assert_true(now_us >= before_us);
        before_us = now_us;
    }
}

static void the_clock_counts_microseconds(void **state)
{
    test_line line;
    int64_t start_us = grobo_now_us();
    int64_t took_us;

    (void)state;
    test_line_open(&line);
    assert_int_equal(grobo_port_wait(line.fd, GROBO_PORT_READABLE, 50000), 0);
    took_us = grobo_now_us() - start_us;
    assert_true(took_us >= 50000);
    assert_true(took_us < 1000000);
    test_line_close(&line);
}

typedef struct {
    grobo_mutex mutex;
    int count;
    bool took_signals;
    grobo_thread self;
} shared;

static GROBO_THREAD_FUNC count_up(void *arg)
{
    shared *s = arg;
    sigset_t mask;

    pthread_sigmask(SIG_SETMASK, NULL, &mask);
    for (int i = 0; i < 10000; i++) {
        grobo_mutex_lock(&s->mutex);
        s->count++;
        s->took_signals = s->took_signals || sigismember(&mask, SIGINT) == 0;
        grobo_mutex_unlock(&s->mutex);
    }
    GROBO_THREAD_RETURN;
}

static void threads_exclude_each_other_and_take_no_signals(void **state)
{
    shared s = {.count = 0};
    grobo_thread threads[4];
    sigset_t mask;

    (void)state;
    assert_int_equal(grobo_mutex_init(&s.mutex), GROBO_OK);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(grobo_thread_start(&threads[i], count_up, &s), GROBO_OK);
        assert_false(grobo_thread_is_self(threads[i]));
    }
    for (int i = 0; i < 4; i++) {
        assert_int_equal(grobo_thread_join(threads[i]), GROBO_OK);
    }
    assert_int_equal(s.count, 40000);
    assert_false(s.took_signals);
    pthread_sigmask(SIG_SETMASK, NULL, &mask);
    assert_int_equal(sigismember(&mask, SIGINT), 0);
    grobo_mutex_deinit(&s.mutex);
}

static GROBO_THREAD_FUNC join_self(void *arg)
{
    shared *s = arg;

    grobo_mutex_lock(&s->mutex);
    s->count = grobo_thread_is_self(s->self) ? grobo_thread_join(s->self) : 1;
    grobo_mutex_unlock(&s->mutex);
    GROBO_THREAD_RETURN;
}

static void a_thread_does_not_join_itself(void **state)
{
    shared s = {.count = 0};

    (void)state;
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

static void waiting_tells_what_is_ready(void **state)
{
    test_line line;

    (void)state;
    test_line_open(&line);
    assert_int_equal(grobo_port_wait(line.fd, GROBO_PORT_READABLE, 0), 0);
    assert_int_equal(grobo_port_wait(line.fd, GROBO_PORT_READABLE, -5), 0);
    assert_int_equal(grobo_port_wait(line.fd, GROBO_PORT_READABLE | GROBO_PORT_WRITABLE, 1000000),
                     GROBO_PORT_WRITABLE);
    test_line_close(&line);
    assert_true(grobo_port_wait(line.fd, GROBO_PORT_READABLE, 1000) >= 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_clock_goes_on),
        cmocka_unit_test(the_clock_counts_microseconds),
        cmocka_unit_test(threads_exclude_each_other_and_take_no_signals),
        cmocka_unit_test(a_thread_does_not_join_itself),
        cmocka_unit_test(waiting_tells_what_is_ready),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
