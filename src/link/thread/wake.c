/* SPDX-License-Identifier: MIT */
/* What everything else of a control uses: the lock, waking, and who is in a round. */
#include <string.h>

#include "src/base/assert.h"
#include "src/link/session/session.h"
#include "src/link/thread/thread.h"

/* The rounds that a thread is in, one inside another, of different controls. */
static _Thread_local const round_frame *rounds;

void grobo_i_control_begin_round(round_frame *frame, const grobo_control *control)
{
    *frame = (round_frame){control, rounds};
    rounds = frame;
}

void grobo_i_control_end_round(const round_frame *frame)
{
    GROBO_ASSERT(rounds == frame);
    rounds = frame->outer;
}

bool grobo_i_control_inside(const grobo_control *control)
{
    const round_frame *frame = rounds;

    while (frame != NULL && frame->control != control) {
        frame = frame->outer;
    }
    return frame != NULL;
}

void grobo_i_control_lock(grobo_control *control)
{
    bool inside = grobo_i_control_inside(control);

    grobo_mutex_lock(&control->lock);
    if (!inside) {
        control->called_us = grobo_now_us();
        control->owner_lost = false;
    }
}

void grobo_i_control_unlock(grobo_control *control)
{
    grobo_mutex_unlock(&control->lock);
}

void grobo_i_control_copy(grobo_control *control, void *to, const void *from, size_t size)
{
    grobo_i_control_lock(control);
    memcpy(to, from, size);
    grobo_i_control_unlock(control);
}

/* ---- the engine's lock -------------------------------------------------------------------- */

/* Its address is the name of this thread. */
static _Thread_local char me;

static void engine_lock(void *ctx)
{
    grobo_control *control = ctx;

    if (atomic_load(&control->engine_thread) != &me) {
        if (!grobo_i_control_inside(control)) {
            grobo_i_control_lock(control); /* somebody is there */
            grobo_i_control_unlock(control);
        }
        grobo_mutex_lock(&control->engine);
        GROBO_ASSERT(control->engine_depth == 0);
        atomic_store(&control->engine_thread, &me);
    }
    control->engine_depth++;
}

static void engine_unlock(void *ctx)
{
    grobo_control *control = ctx;

    GROBO_ASSERT(control->engine_depth > 0);
    control->engine_depth--;
    if (control->engine_depth == 0) {
        atomic_store(&control->engine_thread, NULL);
        grobo_mutex_unlock(&control->engine);
    }
}

static bool is_elsewhere(const void *ctx)
{
    return !grobo_i_control_inside(ctx);
}

void grobo_i_control_share(grobo_control *control)
{
    const session_share share = {engine_lock, engine_unlock, is_elsewhere, control};

    grobo_i_session_share(control->session, &share);
}

/* ---- waking ------------------------------------------------------------------------------- */

void grobo_i_control_wake(grobo_control *control)
{
    if (!control->woken) {
        control->woken = true;
        grobo_i_session_wake(control->session);
    }
}

void grobo_i_control_sleep(grobo_control *control, int64_t end_us)
{
    control->sleepers++;
    grobo_cond_wait(&control->changed, &control->lock, end_us);
    GROBO_ASSERT(control->sleepers > 0);
    control->sleepers--;
}

void grobo_i_control_wake_all(grobo_control *control)
{
    grobo_cond_wake_all(&control->changed);
}
