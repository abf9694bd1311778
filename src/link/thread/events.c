/* SPDX-License-Identifier: MIT */
/* What the loop of a control is told by its session, and hands on to the user's callbacks. */
#include <string.h>

#include "src/link/thread/thread.h"

/* ---- the line ----------------------------------------------------------------------------- */

void grobo_i_control_down(grobo_control *control, int error)
{
    control->line_error = error;
    control->recording = false;
    grobo_i_control_lock(control);
    control->up = false;
    control->losses++;
    grobo_i_control_unlock(control);
}

void grobo_i_control_on_event(void *ctx, grobo_session *session, grobo_session_event event,
                              int error)
{
    grobo_control *control = ctx;

    switch (event) {
    case GROBO_SESSION_EVENT_UP:
        control->exited = false;
        grobo_i_control_lock(control);
        control->up = true;
        grobo_i_control_unlock(control);
        break;
    case GROBO_SESSION_EVENT_LOST:
    case GROBO_SESSION_EVENT_FAILED:
        grobo_i_control_down(control, error);
        break;
    case GROBO_SESSION_EVENT_UNGUARDED:
        break;
    }
    const grobo_control_event kept = {.of_line = true, .line = event, .error = error};
    grobo_i_control_keep(control, &kept);
    if (control->user.on_event != NULL) {
        control->user.on_event(control->user.ctx, session, event, error);
    }
}

/* ---- the engine --------------------------------------------------------------------------- */

static uint64_t frames_sent(grobo_control *control)
{
    return grobo_robot_get_counters(control_robot(control))->motion_frames;
}

bool grobo_i_control_has_exited(grobo_control *control)
{
    return control->exited && control->exit_frames == frames_sent(control);
}

static void on_job(grobo_control *control, const grobo_event_job *ended)
{
    control->exited = ended->kind == GROBO_JOB_EXIT && ended->result >= 0;
    control->exit_frames = frames_sent(control);
    if (ended->kind == GROBO_JOB_RAW) {
        control->recording = false;
        control->raw_bytes = 0;
    }
    grobo_i_control_lock(control);
    grobo_i_control_end_job(control, ended);
    grobo_i_control_unlock(control);
}

void grobo_i_control_on_robot(void *ctx, const grobo_event *event)
{
    grobo_control *control = ctx;

    if (event->kind == GROBO_EVENT_JOB) {
        on_job(control, &event->u.job);
    }
    const grobo_control_event kept = {.event = *event};
    grobo_i_control_keep(control, &kept);
    if (control->user.on_robot != NULL) {
        control->user.on_robot(control->user.ctx, event);
    }
}

/* ---- the bytes ---------------------------------------------------------------------------- */

/* What comes between a raw command's leaving and its job's end is its reply. */
void grobo_i_control_on_tap(void *ctx, grobo_direction direction, int64_t now_us,
                            const uint8_t *bytes, size_t size)
{
    grobo_control *control = ctx;

    if (direction == GROBO_DIR_TX && control->raw_bytes > 0) {
        size_t same = size < control->raw_bytes ? size : control->raw_bytes;

        control->recording = control->recording || memcmp(bytes, control->raw, same) == 0;
    } else if (direction == GROBO_DIR_RX && control->recording) {
        size_t room = sizeof control->received - control->received_bytes;
        size_t taken = size < room ? size : room;

        memcpy(control->received + control->received_bytes, bytes, taken);
        control->received_bytes += taken;
    }
    if (control->user.on_tap != NULL) {
        control->user.on_tap(control->user.ctx, direction, now_us, bytes, size);
    }
}
