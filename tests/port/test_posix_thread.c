/* SPDX-License-Identifier: MIT */
/* Threads of the POSIX port and signals. */
#include <signal.h>
#include <string.h>
#include <unistd.h>

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

/* On Linux a lock with priority inheritance holds the number of the thread that has it, for the
 * kernel to raise that one (futex(2)). This thread is the process's first. */
TEST(a_lock_inherits_priorities)
{
    grobo_mutex mutex;
    int words[sizeof mutex / sizeof(int)];

    if (access("/proc/self/task", F_OK) != 0) {
        skip();
    }
    assert_int_equal(grobo_mutex_init(&mutex), GROBO_OK);
    grobo_mutex_lock(&mutex);
    memcpy(words, &mutex, sizeof words);
    grobo_mutex_unlock(&mutex);
    grobo_mutex_deinit(&mutex);
    /* The lock's word, of glibc and of musl. */
    assert_true(words[0] == getpid() || words[1] == getpid());
}
