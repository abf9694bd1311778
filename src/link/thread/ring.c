/* SPDX-License-Identifier: MIT */
/*
 * What is kept of a control for who looks on: events, and the snapshot.
 *
 * Readings have a ring of their own, so that however many of them come, the end of a job is not
 * displaced. Events are numbered as they come and taken in that order from whichever ring has the
 * older; a gap in the numbers is what was lost. Of each ring the oldest makes way, so what was lost
 * is always told with a later event. The socket has a byte while there is an event.
 */
#include <string.h>

#include "src/base/assert.h"
#include "src/base/memory.h"
#include "src/base/sized.h"
#include "src/link/session/session.h"
#include "src/link/thread/thread.h"
#include "src/robot/robot.h"

typedef struct control_kept {
    uint64_t number;
    grobo_control_event event;
} control_kept;

int grobo_i_control_ring_new(grobo_control *control, size_t capacity)
{
    if (capacity == 0) {
        return GROBO_OK;
    }
    size_t bytes = capacity * sizeof(control_kept);
    control->capacity = capacity;
    control->told.kept = grobo_i_new(control->mem, bytes);
    control->readings.kept = grobo_i_new(control->mem, bytes);
    if (control->told.kept == NULL || control->readings.kept == NULL) {
        return GROBO_ERR_NOMEM;
    }
    return grobo_i_session_pair_new(control->event_socket);
}

void grobo_i_control_ring_free(grobo_control *control)
{
    size_t bytes = control->capacity * sizeof(control_kept);
    grobo_i_session_pair_free(control->event_socket);
    grobo_i_free(control->mem, control->told.kept, bytes);
    grobo_i_free(control->mem, control->readings.kept, bytes);
}

/* ---- keeping ------------------------------------------------------------------------------ */

/* The place of the next event; the oldest makes way where the ring is full. */
static control_kept *place_in(control_ring *ring, size_t capacity)
{
    GROBO_ASSERT(ring->head < capacity && ring->n <= capacity);
    if (ring->n == capacity) {
        ring->head = (ring->head + 1) % capacity;
        ring->n--;
    }
    ring->n++;
    return &ring->kept[(ring->head + ring->n - 1) % capacity];
}

static bool is_reading(const grobo_control_event *event)
{
    return !event->of_line &&
           (event->event.kind == GROBO_EVENT_JOINT || event->event.kind == GROBO_EVENT_ROUND);
}

static bool is_job(const grobo_control_event *event)
{
    return !event->of_line && event->event.kind == GROBO_EVENT_JOB;
}

/* The data of a job is valid in the callback only. */
static void keep_data(grobo_control_event *event)
{
    grobo_event_job *job = &event->event.u.job;
    if (is_job(event) && job->size > 0) {
        GROBO_ASSERT(job->size <= sizeof event->data); /* a frame, or registers of one */
        memcpy(event->data, job->data, job->size);
    }
}

void grobo_i_control_keep(grobo_control *control, const grobo_control_event *event)
{
    if (control->capacity == 0) {
        return;
    }
    grobo_i_control_lock(control);
    control_ring *ring = is_reading(event) ? &control->readings : &control->told;
    control_kept *kept = place_in(ring, control->capacity);
    kept->number = ++control->event_number;
    kept->event = *event;
    keep_data(&kept->event);
    if (!control->readable) {
        control->readable = true;
        (void)send(control->event_socket[1], "", 1, 0); /* there is room: it is the only byte */
    }
    grobo_i_control_unlock(control);
}

/* ---- taking ------------------------------------------------------------------------------- */

/* With the lock: the ring that has the oldest event. */
static control_ring *oldest(grobo_control *control)
{
    control_ring *told = &control->told;
    control_ring *readings = &control->readings;
    if (told->n == 0 || readings->n == 0) {
        return told->n > 0 ? told : readings;
    }
    return told->kept[told->head].number < readings->kept[readings->head].number ? told : readings;
}

/* With the lock. @return 1, 0: there is none, GROBO_ERR_ARG: the size is nonsense. */
static int take(grobo_control *control, grobo_control_event *event)
{
    control_ring *ring = oldest(control);
    if (ring->n == 0) {
        return 0;
    }
    control_kept *kept = &ring->kept[ring->head];
    GROBO_ASSERT(kept->number > control->taken_number);
    kept->event.lost = kept->number - control->taken_number - 1;
    if (!grobo_i_sized_give(event, &kept->event, sizeof kept->event)) {
        return GROBO_ERR_ARG;
    }
    control->taken_number = kept->number;
    ring->head = (ring->head + 1) % control->capacity;
    ring->n--;
    if (control->told.n + control->readings.n == 0) {
        char byte;
        (void)recv(control->event_socket[0], &byte, 1, 0);
        control->readable = false;
    }
    return 1;
}

int grobo_control_next_event(grobo_control *control, grobo_control_event *event)
{
    if (control == NULL || event == NULL) {
        return GROBO_ERR_ARG;
    }
    if (control->capacity == 0) {
        return GROBO_ERR_STATE;
    }
    grobo_i_control_lock(control);
    int r = take(control, event);
    grobo_i_control_unlock(control);
    if (r > 0 && is_job(event)) {
        event->event.u.job.data = event->event.u.job.size > 0 ? event->data : NULL;
    }
    return r;
}

grobo_socket grobo_control_event_socket(const grobo_control *control)
{
    return control == NULL ? GROBO_SOCKET_NULL : control->event_socket[0];
}

/* ---- the snapshot ------------------------------------------------------------------------- */

int grobo_control_snapshot(grobo_control *control, grobo_snapshot *snapshot)
{
    if (control == NULL || snapshot == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_robot *robot = control_robot(control);
    grobo_snapshot seen = {
        .latched = grobo_session_is_latched(control->session),
        .n_joints = control->driver->model->n_joints,
    };
    grobo_i_control_lock(control);
    seen.connected = control->up;
    grobo_i_control_unlock(control);
    grobo_i_lock(robot); /* all at one moment: each function takes it again */
    seen.now_us = grobo_now_us();
    seen.moving = grobo_robot_moving(robot);
    seen.settling = grobo_robot_settling(robot);
    seen.job = grobo_robot_job(robot);
    grobo_robot_tripped(robot, &seen.trip);
    grobo_robot_progress(robot, &seen.play);
    seen.counters = *grobo_robot_get_counters(robot);
    for (int j = 0; j < seen.n_joints; j++) {
        (void)grobo_robot_joint(robot, j, &seen.joints[j]);
    }
    grobo_i_unlock(robot);
    return grobo_i_sized_give(snapshot, &seen, sizeof seen) ? seen.n_joints : GROBO_ERR_ARG;
}
