/* SPDX-License-Identifier: MIT */
/* What the loop of a runner is told by its session, and hands on to the user's callbacks. */
#include <grobo/core/robot.h>

#include "src/link/runner/runner.h"
#include "src/link/session/session.h"

/* ---- the line ----------------------------------------------------------------------------- */

void grobo_i_runner_down(grobo_runner *runner, int error)
{
    runner->line_error = error;
    grobo_i_runner_lock(runner);
    runner->up = false;
    runner->losses++;
    grobo_i_runner_unlock(runner);
}

void grobo_i_runner_on_event(void *ctx, grobo_session *session, grobo_session_event event,
                             int error)
{
    grobo_runner *runner = ctx;

    switch (event) {
    case GROBO_SESSION_EVENT_UP:
        runner->exited = false;
        grobo_i_runner_lock(runner);
        runner->up = true;
        grobo_i_runner_unlock(runner);
        break;
    case GROBO_SESSION_EVENT_LOST:
    case GROBO_SESSION_EVENT_FAILED:
        grobo_i_runner_down(runner, error);
        break;
    case GROBO_SESSION_EVENT_UNGUARDED:
        break;
    }
    const grobo_runner_event kept = {.of_line = true, .line = event, .error = error};
    grobo_i_runner_keep(runner, &kept);
    if (runner->user.on_event != NULL) {
        runner->user.on_event(runner->user.ctx, session, event, error);
    }
}

/* ---- the engine --------------------------------------------------------------------------- */

static uint64_t frames_sent(grobo_runner *runner)
{
    return grobo_robot_get_counters(runner_robot(runner))->motion_frames;
}

bool grobo_i_runner_has_exited(grobo_runner *runner)
{
    return runner->exited && runner->exit_frames == frames_sent(runner);
}

static void on_job(grobo_runner *runner, const grobo_event_job *ended)
{
    runner->exited = ended->kind == GROBO_JOB_EXIT && ended->result >= 0;
    runner->exit_frames = frames_sent(runner);
    grobo_i_runner_lock(runner);
    bool awaited = grobo_i_runner_end_job(runner, ended);
    grobo_i_runner_unlock(runner);
    if (awaited) { /* behind the lock, which they take first */
        grobo_i_runner_wake_all(runner);
    }
}

void grobo_i_runner_on_robot(void *ctx, const grobo_event *event)
{
    grobo_runner *runner = ctx;

    if (event->kind == GROBO_EVENT_JOB) {
        on_job(runner, &event->u.job);
    }
    if (runner->capacity > 0) {
        const grobo_runner_event kept = {.event = *event};
        grobo_i_runner_keep(runner, &kept);
    }
    if (runner->user.on_robot != NULL) {
        runner->user.on_robot(runner->user.ctx, event);
    }
}

/* ---- the bytes ---------------------------------------------------------------------------- */

void grobo_i_runner_on_tap(void *ctx, grobo_direction direction, int64_t now_us,
                           const uint8_t *bytes, size_t size)
{
    const grobo_runner *runner = ctx;

    runner->user.on_tap(runner->user.ctx, direction, now_us, bytes, size);
}
