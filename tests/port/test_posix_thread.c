/* SPDX-License-Identifier: MIT */
/* Threads of the POSIX port and signals. */
#include <signal.h>

#include <grobo/core/port.h>

#include "tests/support/test.h"

static GROBO_THREAD_FUNC look_at_mask(void *arg)
{
    sigset_t mask;

    pthread_sigmask(SIG_SETMASK, NULL, &mask);
    *(int *)arg = sigismember(&mask, SIGINT);
    GROBO_THREAD_RETURN;
}

TEST(a_thread_takes_no_signals)
{
    grobo_thread thread;
    sigset_t mask;
    int blocked = -1;

    assert_int_equal(grobo_thread_start(&thread, look_at_mask, &blocked), GROBO_OK);
    assert_int_equal(grobo_thread_join(thread), GROBO_OK);
    assert_int_equal(blocked, 1);
    pthread_sigmask(SIG_SETMASK, NULL, &mask);
    assert_int_equal(sigismember(&mask, SIGINT), 0);
}
