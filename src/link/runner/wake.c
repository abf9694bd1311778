/* SPDX-License-Identifier: MIT */
/* What everything else of a runner uses: the lock, waking, and who is in a round. */
#include <string.h>

#include "src/base/assert.h"
#include "src/link/runner/runner.h"
#include "src/link/session/session.h"

/* The rounds that a thread is in, one inside another, of different runners. */
static _Thread_local const round_frame *rounds;

void grobo_i_runner_begin_round(round_frame *frame, const grobo_runner *runner)
{
    *frame = (round_frame){runner, rounds};
    rounds = frame;
}

void grobo_i_runner_end_round(const round_frame *frame)
{
    GROBO_ASSERT(rounds == frame);
    rounds = frame->outer;
}

bool grobo_i_runner_inside(const grobo_runner *runner)
{
    const round_frame *frame = rounds;

    while (frame != NULL && frame->runner != runner) {
        frame = frame->outer;
    }
    return frame != NULL;
}

/* Somebody is there. */
static void note_call(grobo_runner *runner)
{
    if (runner->owner_timeout_us > 0 && !grobo_i_runner_inside(runner)) {
        atomic_store(&runner->called_us, grobo_now_us());
        atomic_store(&runner->owner_lost, false);
    }
}

void grobo_i_runner_lock(grobo_runner *runner)
{
    grobo_mutex_lock(&runner->lock);
    note_call(runner);
}

void grobo_i_runner_unlock(grobo_runner *runner)
{
    grobo_mutex_unlock(&runner->lock);
}

void grobo_i_runner_copy(grobo_runner *runner, void *to, const void *from, size_t size)
{
    grobo_i_runner_lock(runner);
    memcpy(to, from, size);
    grobo_i_runner_unlock(runner);
}

/* ---- the engine's lock -------------------------------------------------------------------- */

/* Its address is the name of this thread. */
static _Thread_local char me;

static void engine_lock(void *ctx)
{
    grobo_runner *runner = ctx;

    if (atomic_load(&runner->engine_thread) != &me) {
        note_call(runner);
        grobo_mutex_lock(&runner->engine);
        GROBO_ASSERT(runner->engine_depth == 0);
        atomic_store(&runner->engine_thread, &me);
    }
    runner->engine_depth++;
}

static void engine_unlock(void *ctx)
{
    grobo_runner *runner = ctx;

    GROBO_ASSERT(runner->engine_depth > 0);
    runner->engine_depth--;
    if (runner->engine_depth == 0) {
        atomic_store(&runner->engine_thread, NULL);
        grobo_mutex_unlock(&runner->engine);
    }
}

static bool is_elsewhere(const void *ctx)
{
    return !grobo_i_runner_inside(ctx);
}

void grobo_i_runner_share(grobo_runner *runner)
{
    const session_share share = {engine_lock, engine_unlock, is_elsewhere, runner};

    grobo_i_session_share(runner->session, &share);
}

/* ---- waking ------------------------------------------------------------------------------- */

void grobo_i_runner_wake(grobo_runner *runner)
{
    if (!atomic_exchange(&runner->woken, true)) {
        grobo_i_session_wake(runner->session);
    }
}

void grobo_i_runner_sleep(grobo_runner *runner, int64_t end_us)
{
    runner->sleepers++;
    grobo_cond_wait(&runner->changed, &runner->lock, end_us);
    GROBO_ASSERT(runner->sleepers > 0);
    runner->sleepers--;
}

void grobo_i_runner_wake_all(grobo_runner *runner)
{
    grobo_cond_wake_all(&runner->changed);
}
