/* SPDX-License-Identifier: MIT */
/* Threads of the POSIX port and signals. */
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
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

/* What a thread gets of what it asks for. */
typedef struct asked {
    grobo_realtime how;
    int result, policy, priority, policy_of_child;
    bool on_its_cpu;
} asked;

/* Field 41 of /proc/self/stat, the scheduling policy, of proc(5); -1: no such file. */
static int policy_of_self(void)
{
    enum { POLICY = 41, FIRST_BEHIND_NAME = 3 };
    char text[1024] = "";
    FILE *file = fopen("/proc/self/stat", "r");
    size_t n = file != NULL ? fread(text, 1, sizeof text - 1, file) : 0;
    const char *at = n > 0 ? strrchr(text, ')') : NULL;

    if (file != NULL) {
        (void)fclose(file);
    }
    for (int field = FIRST_BEHIND_NAME; at != NULL && field <= POLICY; field++) {
        at = strchr(at + 1, ' ');
    }
    return at != NULL ? (int)strtol(at, NULL, 10) : -1;
}

/* What a process that is forked now runs as. */
static int policy_of_child(void)
{
    int status = 0;
    pid_t pid = fork();

    if (pid == 0) {
        _exit(policy_of_self() & 0xff);
    }
    return waitpid(pid, &status, 0) == pid && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The mask of CPUs as the kernel prints it is the one asked for. */
static bool runs_on(uint64_t cpus)
{
    char line[256];
    unsigned long long mask = 0;
    FILE *file = fopen("/proc/thread-self/status", "r");

    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (sscanf(line, "Cpus_allowed: %llx", &mask) == 1) {
            break;
        }
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    return mask == cpus;
}

static GROBO_THREAD_FUNC ask_for_it(void *arg)
{
    asked *a = arg;
    struct sched_param param = {.sched_priority = -1};

    a->result = grobo_thread_realtime(&a->how);
    a->policy = -1;
    (void)pthread_getschedparam(pthread_self(), &a->policy, &param);
    a->priority = param.sched_priority;
    a->policy_of_child = policy_of_child();
    a->on_its_cpu = a->how.cpus != 0 && runs_on(a->how.cpus);
    GROBO_THREAD_RETURN;
}

static asked what_it_gets(grobo_realtime how)
{
    asked a = {.how = how};
    grobo_thread thread;

    assert_int_equal(grobo_thread_start(&thread, ask_for_it, &a), GROBO_OK);
    assert_int_equal(grobo_thread_join(thread), GROBO_OK);
    return a;
}

TEST(a_realtime_that_nobody_can_have)
{
    static const grobo_realtime wrong[] = {
        {.policy = GROBO_REALTIME_FIFO},
        {.policy = GROBO_REALTIME_FIFO, .priority = -1},
        {.policy = GROBO_REALTIME_FIFO, .priority = 100},
        {.policy = GROBO_REALTIME_RR},
        {.policy = GROBO_REALTIME_RR, .priority = 100},
        {.priority = 1},
        {.policy = (grobo_realtime_policy)3, .priority = 1},
    };

    assert_int_equal(grobo_thread_realtime(NULL), GROBO_ERR_ARG);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        asked a = what_it_gets(wrong[i]);

        assert_int_equal(a.result, GROBO_ERR_ARG);
        assert_int_equal(a.policy, SCHED_OTHER);
    }
}

TEST(a_realtime_of_zeros_changes_nothing)
{
    asked a = what_it_gets((grobo_realtime){.policy = GROBO_REALTIME_NONE});

    assert_int_equal(a.result, GROBO_OK);
    assert_int_equal(a.policy, SCHED_OTHER);
}

/* The priority is the thread's own: neither its process's nor that of what it starts. */
TEST(a_priority_is_given_or_refused)
{
    static const struct {
        grobo_realtime_policy asked;
        int policy, priority;
    } rows[] = {{GROBO_REALTIME_FIFO, SCHED_FIFO, 1},
                {GROBO_REALTIME_FIFO, SCHED_FIFO, 99},
                {GROBO_REALTIME_RR, SCHED_RR, 7}};

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        asked a =
            what_it_gets((grobo_realtime){.policy = rows[i].asked, .priority = rows[i].priority});

        if (a.result == GROBO_ERR_PERM) {
            assert_int_equal(a.policy, SCHED_OTHER);
            continue;
        }
        assert_int_equal(a.result, GROBO_OK);
        assert_int_equal(a.policy & 0xff, rows[i].policy);
        assert_int_equal(a.priority, rows[i].priority);
        if (policy_of_self() >= 0) {
            assert_int_equal(a.policy_of_child, SCHED_OTHER);
        }
    }
    struct sched_param param;
    int policy = -1;

    assert_int_equal(pthread_getschedparam(pthread_self(), &policy, &param), 0);
    assert_int_equal(policy, SCHED_OTHER);
}

/* CPU 0 is in every machine, CPU 63 in few. */
TEST(a_thread_is_kept_to_its_cpus)
{
    asked first = what_it_gets((grobo_realtime){.cpus = 1});

    if (first.result == GROBO_ERR_UNSUPPORTED) {
        skip();
    }
    if (first.result != GROBO_ERR_NOTFOUND) { /* a container without it */
        assert_int_equal(first.result, GROBO_OK);
        assert_true(first.on_its_cpu);
        assert_int_equal(first.policy, SCHED_OTHER);
    }
    if (sysconf(_SC_NPROCESSORS_CONF) < 64) {
        asked last = what_it_gets((grobo_realtime){.cpus = UINT64_C(1) << 63});

        assert_int_equal(last.result, GROBO_ERR_NOTFOUND);
    }
}

/* Locked is all or nothing: with a limit, memory would be refused in the midst of a motion. */
static void child_asks_for_lock(int most_bytes)
{
    const struct rlimit limit = {.rlim_cur = (rlim_t)most_bytes, .rlim_max = (rlim_t)most_bytes};

    if (setrlimit(RLIMIT_MEMLOCK, &limit) != 0) {
        _exit(1);
    }
    int r = grobo_thread_realtime(&(grobo_realtime){.mlock = true});
    struct rlimit now;

    if (getrlimit(RLIMIT_MEMLOCK, &now) != 0) {
        _exit(2);
    }
    if (r == GROBO_OK) {
        _exit(now.rlim_cur == RLIM_INFINITY ? 0 : 3);
    }
    _exit(r == GROBO_ERR_PERM && now.rlim_cur == limit.rlim_cur ? 0 : 4);
}

TEST(memory_is_locked_without_a_limit_or_not_at_all)
{
    int status = -1;
    pid_t pid = fork();

    if (pid == 0) {
        child_asks_for_lock(65536);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(status, 0);
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
