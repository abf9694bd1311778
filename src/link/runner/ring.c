/* SPDX-License-Identifier: MIT */
/*
 * What is kept of a runner for who looks on: events, and the snapshot.
 *
 * Readings have a ring of their own, so that however many of them come, the end of a job is not
 * displaced. Events are numbered as they come and taken in that order from whichever ring has the
 * older; a gap in the numbers is what was lost. Of each ring the oldest makes way, so what was lost
 * is always told with a later event. The socket has a byte while there is an event.
 */
#include <string.h>

#include <grobo/core/robot.h>

#include "src/base/assert.h"
#include "src/base/memory.h"
#include "src/base/sized.h"
#include "src/link/runner/runner.h"
#include "src/link/session/session.h"
#include "src/robot/query.h"

typedef struct runner_kept {
    uint64_t number;
    grobo_runner_event event;
} runner_kept;

int grobo_i_runner_ring_new(grobo_runner *runner, size_t capacity)
{
    if (capacity == 0) {
        return GROBO_OK;
    }
    size_t bytes = capacity * sizeof(runner_kept);
    runner->capacity = capacity;
    runner->told.kept = grobo_i_new(runner->mem, bytes);
    runner->readings.kept = grobo_i_new(runner->mem, bytes);
    if (runner->told.kept == NULL || runner->readings.kept == NULL) {
        return GROBO_ERR_NOMEM;
    }
    return grobo_i_session_pair_new(runner->event_socket);
}

void grobo_i_runner_ring_free(grobo_runner *runner)
{
    size_t bytes = runner->capacity * sizeof(runner_kept);
    grobo_i_session_pair_free(runner->event_socket);
    grobo_i_free(runner->mem, runner->told.kept, bytes);
    grobo_i_free(runner->mem, runner->readings.kept, bytes);
}

/* ---- keeping ------------------------------------------------------------------------------ */

/* The place of the next event; the oldest makes way where the ring is full. */
static runner_kept *place_in(runner_ring *ring, size_t capacity)
{
    GROBO_ASSERT(ring->head < capacity && ring->n <= capacity);
    if (ring->n == capacity) {
        ring->head = (ring->head + 1) % capacity;
        ring->n--;
    }
    ring->n++;
    return &ring->kept[(ring->head + ring->n - 1) % capacity];
}

static bool is_reading(const grobo_runner_event *event)
{
    return !event->of_line &&
           (event->event.kind == GROBO_EVENT_JOINT || event->event.kind == GROBO_EVENT_ROUND);
}

static bool is_job(const grobo_runner_event *event)
{
    return !event->of_line && event->event.kind == GROBO_EVENT_JOB;
}

/* The data of a job is valid in the callback only. */
static void keep_data(grobo_runner_event *event)
{
    grobo_event_job *job = &event->event.u.job;
    if (is_job(event) && job->size > 0) {
        GROBO_ASSERT(job->size <= sizeof event->data); /* a frame, or registers of one */
        memcpy(event->data, job->data, job->size);
    }
}

void grobo_i_runner_keep(grobo_runner *runner, const grobo_runner_event *event)
{
    if (runner->capacity == 0) {
        return;
    }
    grobo_i_runner_lock(runner);
    runner_ring *ring = is_reading(event) ? &runner->readings : &runner->told;
    runner_kept *kept = place_in(ring, runner->capacity);
    kept->number = ++runner->event_number;
    kept->event = *event;
    keep_data(&kept->event);
    if (!runner->readable) {
        runner->readable = true;
        (void)send(runner->event_socket[1], "", 1, 0); /* there is room: it is the only byte */
    }
    grobo_i_runner_unlock(runner);
}

/* ---- taking ------------------------------------------------------------------------------- */

/* With the lock: the ring that has the oldest event. */
static runner_ring *oldest(grobo_runner *runner)
{
    runner_ring *told = &runner->told;
    runner_ring *readings = &runner->readings;
    if (told->n == 0 || readings->n == 0) {
        return told->n > 0 ? told : readings;
    }
    return told->kept[told->head].number < readings->kept[readings->head].number ? told : readings;
}

/* With the lock. @return 1, 0: there is none, GROBO_ERR_ARG: the size is nonsense. */
static int take(grobo_runner *runner, grobo_runner_event *event)
{
    runner_ring *ring = oldest(runner);
    if (ring->n == 0) {
        return 0;
    }
    runner_kept *kept = &ring->kept[ring->head];
    GROBO_ASSERT(kept->number > runner->taken_number);
    kept->event.lost = kept->number - runner->taken_number - 1;
    if (!grobo_i_sized_give(event, &kept->event, sizeof kept->event)) {
        return GROBO_ERR_ARG;
    }
    runner->taken_number = kept->number;
    ring->head = (ring->head + 1) % runner->capacity;
    ring->n--;
    if (runner->told.n + runner->readings.n == 0) {
        char byte;
        (void)recv(runner->event_socket[0], &byte, 1, 0);
        runner->readable = false;
    }
    return 1;
}

int grobo_runner_next_event(grobo_runner *runner, grobo_runner_event *event)
{
    if (runner == NULL || event == NULL) {
        return GROBO_ERR_ARG;
    }
    if (runner->capacity == 0) {
        return GROBO_ERR_STATE;
    }
    grobo_i_runner_lock(runner);
    int r = take(runner, event);
    grobo_i_runner_unlock(runner);
    if (r > 0 && is_job(event)) {
        event->event.u.job.data = event->event.u.job.size > 0 ? event->data : NULL;
    }
    return r;
}

grobo_socket grobo_runner_event_socket(const grobo_runner *runner)
{
    return runner == NULL ? GROBO_SOCKET_NULL : runner->event_socket[0];
}

/* ---- the snapshot ------------------------------------------------------------------------- */

int grobo_runner_snapshot(grobo_runner *runner, grobo_snapshot *snapshot)
{
    if (runner == NULL || snapshot == NULL) {
        return GROBO_ERR_ARG;
    }
    const grobo_robot *robot = runner_robot(runner);
    grobo_snapshot seen = {
        .latched = grobo_session_is_latched(runner->session),
        .n_joints = runner->driver->model->n_joints,
    };
    grobo_i_runner_lock(runner);
    seen.connected = runner->up;
    grobo_i_runner_unlock(runner);
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
