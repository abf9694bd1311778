/* SPDX-License-Identifier: MIT */
/*
 * The rounds of the loop, and how threads hand calls to it. A call takes a slot, and the loop calls
 * its function, again and again, until it is over. The caller sleeps at the condition meanwhile;
 * or, where no thread runs the loop, runs it itself. Nothing of this takes a descriptor or memory.
 */
#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/link/runner/runner.h"
#include "src/link/session/session.h"

/* ---- slots -------------------------------------------------------------------------------- */

static runner_slot *take_slot(grobo_runner *runner, int most)
{
    for (int i = 0; i < most; i++) {
        if (runner->slot[i].state == CALL_FREE) {
            runner->slots_end = i < runner->slots_end ? runner->slots_end : i + 1;
            atomic_fetch_add(&runner->calls, 1);
            return &runner->slot[i];
        }
    }
    return NULL;
}

static void release(grobo_runner *runner, runner_slot *slot)
{
    slot->state = CALL_FREE;
    while (runner->slots_end > 0 && runner->slot[runner->slots_end - 1].state == CALL_FREE) {
        runner->slots_end--;
    }
    atomic_fetch_sub(&runner->calls, 1);
}

static void hand_over(grobo_runner *runner, runner_slot *slot, grobo_runner_fn fn, void *arg)
{
    GROBO_ASSERT(slot->state == CALL_FREE && fn != NULL);
    slot->fn = fn;
    slot->arg = arg;
    slot->job = NULL;
    slot->users = false;
    slot->impatient = false;
    slot->ticket = ++runner->tickets;
    slot->state = CALL_OPEN;
    grobo_i_runner_wake(runner);
}

/* ---- on the loop -------------------------------------------------------------------------- */

/* The oldest call after a ticket. */
static runner_slot *next_call(grobo_runner *runner, uint64_t after)
{
    runner_slot *next = NULL;

    for (int i = 0; i < runner->slots_end; i++) {
        runner_slot *slot = &runner->slot[i];

        if (slot->state == CALL_OPEN && slot->ticket > after &&
            (next == NULL || slot->ticket < next->ticket)) {
            next = slot;
        }
    }
    return next;
}

static void settle(grobo_runner *runner, runner_slot *slot, int result)
{
    GROBO_ASSERT(slot->state == CALL_RUNNING);
    if (result == CALL_PENDING) {
        slot->state = CALL_OPEN;
    } else if (slot->posted) {
        slot->posted = false;
        release(runner, slot);
    } else {
        slot->result = result;
        slot->state = CALL_DONE;
    }
    if (slot->state == CALL_DONE || slot->impatient) {
        grobo_i_runner_wake_all(runner);
    }
}

static int call_user(grobo_runner *runner, grobo_runner_fn fn, void *arg)
{
    int64_t since_us = grobo_i_session_enter_callback(runner->session);
    int r = fn(arg, runner);

    grobo_i_session_leave_callback(runner->session, GROBO_CALLBACK_CALL, since_us);
    return r;
}

/* With the lock: true if a call has to be looked at though nothing comes. */
static bool is_to_be_polled(const grobo_runner *runner)
{
    for (int i = 0; i < runner->slots_end; i++) {
        const runner_slot *slot = &runner->slot[i];
        const runner_job *job = slot->job;

        if (slot->state == CALL_OPEN && (job == NULL || job->number == 0)) {
            return true;
        }
    }
    return false;
}

static void serve_calls(grobo_runner *runner)
{
    runner_slot *slot;
    uint64_t after = 0;

    grobo_mutex_lock(&runner->lock);
    atomic_store(&runner->woken, false);
    uint64_t last = runner->tickets; /* what a callback hands over has the next round */
    while ((slot = next_call(runner, after)) != NULL && slot->ticket <= last) {
        grobo_runner_fn fn = slot->fn;
        void *arg = slot->arg;
        bool users = slot->users;
        int result;

        after = slot->ticket;
        slot->state = CALL_RUNNING;
        grobo_mutex_unlock(&runner->lock);
        grobo_i_session_attend(runner->session);
        result = users ? call_user(runner, fn, arg) : fn(arg, runner);
        grobo_mutex_lock(&runner->lock);
        settle(runner, slot, result);
    }
    runner->asked = is_to_be_polled(runner);
    grobo_mutex_unlock(&runner->lock);
}

/* What was posted by grobo_session_post_estop() and its like goes before every call. Whoever calls
 * behind this look wakes the loop. */
static void serve(grobo_runner *runner)
{
    if (atomic_load(&runner->calls) > 0 || atomic_load(&runner->woken)) {
        serve_calls(runner);
    } else {
        runner->asked = false;
    }
    grobo_i_session_attend(runner->session);
}

/* ---- a round ------------------------------------------------------------------------------ */

/* When to look though nothing has come: each period for the service and for calls that are not
 * over, else when the owner may be lost. */
static int64_t next_look(grobo_runner *runner)
{
    int64_t next_us = GROBO_NEVER_US;

    if (runner->on_svc != NULL || runner->asked) {
        if (runner->tick_us == GROBO_NEVER_US) {
            runner->tick_us = grobo_now_us() + runner->period_us;
        }
        next_us = runner->tick_us;
    } else {
        runner->tick_us = GROBO_NEVER_US;
    }
    if (runner->owner_timeout_us > 0) {
        grobo_mutex_lock(&runner->lock);
        /* One that was lost may come back, and be lost again. */
        int64_t since_us =
            atomic_load(&runner->owner_lost) ? grobo_now_us() : atomic_load(&runner->called_us);
        grobo_mutex_unlock(&runner->lock);
        if (runner->owner_timeout_us < GROBO_NEVER_US - since_us) {
            next_us = grobo_i_sooner(next_us, since_us + runner->owner_timeout_us);
        }
    }
    return next_us;
}

void grobo_i_runner_round(grobo_runner *runner, int64_t end_us)
{
    round_frame frame;

    grobo_i_runner_begin_round(&frame, runner);
    if (grobo_timer_set(runner->timer, grobo_i_sooner(end_us, next_look(runner))) < 0) {
        grobo_i_session_wake(runner->session); /* a round that does not wait, and the next one */
    }
    (void)event_base_loop(runner->base, EVLOOP_ONCE);
    grobo_i_runner_look_at_play(runner);
    serve(runner);
    grobo_i_runner_end_round(&frame);
}

void grobo_i_runner_take_turn(grobo_runner *runner, int64_t end_us)
{
    runner->looping = true;
    grobo_mutex_unlock(&runner->lock);
    grobo_i_runner_round(runner, end_us);
    grobo_mutex_lock(&runner->lock);
    runner->looping = false;
    grobo_i_runner_wake_all(runner);
}

void grobo_i_runner_end_calls(grobo_runner *runner)
{
    round_frame frame;

    grobo_i_runner_begin_round(&frame, runner);
    grobo_i_runner_lock(runner);
    runner->freeing = true;
    grobo_i_runner_unlock(runner);
    serve(runner);
    grobo_i_runner_end_round(&frame);
}

/* ---- waiting ------------------------------------------------------------------------------ */

/* With the lock: runs the loop, or sleeps while another thread does, until the call is over. */
static int wait_for(grobo_runner *runner, runner_slot *slot, int64_t end_us)
{
    int result = GROBO_ERR_TIMEOUT;

    while (slot->state != CALL_DONE && (slot->state == CALL_RUNNING || grobo_now_us() < end_us)) {
        if (runner->looping || runner->running) {
            /* A function that runs uses our storage: it has to be over before we may give up. */
            slot->impatient = slot->state == CALL_RUNNING;
            grobo_i_runner_sleep(runner, slot->impatient ? GROBO_NEVER_US : end_us);
        } else {
            grobo_i_runner_take_turn(runner, end_us);
        }
    }
    if (slot->state == CALL_DONE) {
        result = slot->result;
    }
    GROBO_ASSERT(slot->state == CALL_DONE || slot->state == CALL_OPEN);
    release(runner, slot);
    return result;
}

static int64_t end_of(const grobo_runner *runner, int64_t timeout_us)
{
    int64_t now_us = grobo_now_us();

    if (timeout_us <= 0) {
        timeout_us = runner->timeout_us;
    }
    return timeout_us > GROBO_NEVER_US - now_us ? GROBO_NEVER_US : now_us + timeout_us;
}

/* A call as its caller has it. */
typedef struct call_request {
    grobo_runner_fn fn;
    void *arg;
    runner_job *job; /* arg, where fn waits for a job */
    int64_t timeout_us;
    bool urgent;
    bool users;
} call_request;

static int call_and_wait(grobo_runner *runner, const call_request *request)
{
    int64_t end_us = end_of(runner, request->timeout_us);
    int result = GROBO_ERR_FULL;

    grobo_i_runner_lock(runner);
    runner_slot *slot = take_slot(runner, request->urgent ? RUNNER_SLOTS : GROBO_RUNNER_CALLS_MAX);
    if (slot != NULL) {
        hand_over(runner, slot, request->fn, request->arg);
        slot->users = request->users;
        if (request->job != NULL) {
            slot->job = request->job;
            request->job->seen_losses = runner->losses;
            request->job->end_us = end_us;
        }
        result = wait_for(runner, slot, end_us);
    }
    grobo_i_runner_unlock(runner);
    return result;
}

/* These two are where a runner that is NULL is refused, for all public functions that come by. */
static int wait_outside(grobo_runner *runner, const call_request *request)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    return grobo_i_runner_inside(runner) ? GROBO_ERR_STATE : call_and_wait(runner, request);
}

/* In a callback at once, else handed over. */
static int call(grobo_runner *runner, const call_request *request)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!grobo_i_runner_inside(runner)) {
        return call_and_wait(runner, request);
    }
    grobo_i_session_attend(runner->session);
    return request->fn(request->arg, runner);
}

int grobo_i_runner_call(grobo_runner *runner, grobo_runner_fn fn, void *arg)
{
    const call_request request = {.fn = fn, .arg = arg};

    return call(runner, &request);
}

int grobo_i_runner_wait(grobo_runner *runner, grobo_runner_fn fn, void *arg, int64_t timeout_us)
{
    const call_request request = {.fn = fn, .arg = arg, .timeout_us = timeout_us};

    return wait_outside(runner, &request);
}

/* ---- jobs ------------------------------------------------------------------------------------
 * A job is the engine's: what is known of it here is its number, and how it has ended. */

/* On the loop: how a job has ended. */
static int result_of(grobo_runner *runner, const runner_job *job)
{
    grobo_i_runner_lock(runner);
    int r = grobo_i_runner_end_of_job(runner, job->number, job->joints);
    grobo_i_runner_unlock(runner);
    return r != CALL_PENDING || grobo_robot_is_pending(runner_robot(runner), job->number)
               ? r
               : GROBO_ERR_NOTFOUND;
}

/* Makes the request, again in each round while the engine refuses it beside what runs; then looks
 * how the job has ended. */
static int poll_job(void *arg, grobo_runner *runner)
{
    runner_job *job = arg;

    if (job->number == 0) {
        job->begun_us = grobo_now_us();
        int r = job->seen_losses != runner->losses ? GROBO_ERR_UNPLUGGED : job->start(runner, job);

        if (r == GROBO_ERR_FULL ||
            (r == GROBO_ERR_STATE && grobo_robot_job(runner_robot(runner)) != GROBO_JOB_NONE)) {
            return CALL_PENDING; /* behind those that run */
        }
        if (r <= 0) {
            return r;
        }
        job->number = r;
    }
    int result = result_of(runner, job);
    job->ended = result != CALL_PENDING;
    return result;
}

static void unlink_job(grobo_runner *runner, const runner_job *job)
{
    runner_job **at = &runner->waiting;

    while (*at != job) {
        at = &(*at)->next;
    }
    *at = job->next;
}

/* With the lock: sleeps until the loop is told the end of a job that its caller began. */
static int await(grobo_runner *runner, runner_job *job)
{
    job->next = runner->waiting;
    runner->waiting = job;
    do {
        if (runner->looping || runner->running) {
            grobo_i_runner_sleep(runner, job->end_us);
        } else {
            grobo_i_runner_take_turn(runner, job->end_us);
        }
    } while (!job->ended && grobo_now_us() < job->end_us);
    unlink_job(runner, job);
    return job->ended ? job->result : GROBO_ERR_TIMEOUT;
}

/*
 * A reading is asked for by its caller, where a thread is in the loop and nothing was handed over
 * before it: the engine is shared, and wakes the loop. @return CALL_PENDING: it has to be handed
 * over.
 */
static int read_directly(grobo_runner *runner, runner_job *job, int64_t timeout_us)
{
    int r = CALL_PENDING;

    if (runner == NULL || grobo_i_runner_inside(runner)) {
        return r;
    }
    grobo_i_runner_lock(runner);
    if (runner->running && runner->looping && atomic_load(&runner->calls) == 0 &&
        !grobo_i_session_has_asked(runner->session)) {
        job->end_us = end_of(runner, timeout_us);
        job->begun_us = grobo_now_us();
        job->number = job->start(runner, job);
        r = job->number > 0                                                   ? await(runner, job)
            : job->number == GROBO_ERR_FULL || job->number == GROBO_ERR_STATE ? CALL_PENDING
                                                                              : job->number;
        job->number = job->number > 0 ? job->number : 0;
    }
    grobo_i_runner_unlock(runner);
    return r;
}

int grobo_i_runner_job(grobo_runner *runner, runner_job *job, int64_t timeout_us)
{
    int r = job->direct ? read_directly(runner, job, timeout_us) : CALL_PENDING;

    if (r != CALL_PENDING) {
        return r;
    }
    const call_request request = {
        .fn = poll_job, .arg = job, .job = job, .timeout_us = timeout_us, .urgent = job->urgent};

    return wait_outside(runner, &request);
}

static int start_request(grobo_runner *runner, runner_job *job)
{
    return call_user(runner, job->request, job->request_arg);
}

int grobo_runner_request(grobo_runner *runner, grobo_runner_fn fn, void *arg, int64_t timeout_us)
{
    runner_job job = {.start = start_request, .request = fn, .request_arg = arg};

    return fn != NULL ? grobo_i_runner_job(runner, &job, timeout_us) : GROBO_ERR_ARG;
}

typedef struct torque_request {
    grobo_joint_mask joints;
    grobo_torque torque;
} torque_request;

static int request_torque(void *arg, grobo_runner *runner)
{
    const torque_request *wanted = arg;

    return grobo_robot_torque(runner_robot(runner), wanted->joints, wanted->torque);
}

int grobo_runner_torque(grobo_runner *runner, grobo_joint_mask joints, grobo_torque torque,
                        int64_t timeout_us)
{
    torque_request wanted = {joints, torque};

    return grobo_runner_request(runner, request_torque, &wanted, timeout_us);
}

int grobo_runner_wait_job(grobo_runner *runner, int job, int64_t timeout_us)
{
    runner_job known = {.number = job};

    if (runner == NULL || job == 0) {
        return GROBO_ERR_ARG;
    }
    if (job < 0) {
        return job;
    }
    int r = grobo_i_runner_job(runner, &known, timeout_us);

    return r == GROBO_ERR_TIMEOUT && !known.ended ? GROBO_ERR_PENDING : r;
}

/* ---- the public functions ----------------------------------------------------------------- */

int grobo_runner_call(grobo_runner *runner, grobo_runner_fn fn, void *arg)
{
    const call_request request = {.fn = fn, .arg = arg, .users = true};

    return fn != NULL ? call(runner, &request) : GROBO_ERR_ARG;
}

/* With the lock: hands over without waiting. */
static int post(grobo_runner *runner, grobo_runner_fn fn, void *arg)
{
    runner_slot *slot = take_slot(runner, GROBO_RUNNER_CALLS_MAX);

    if (fn == NULL || runner->freeing || slot == NULL) {
        return fn == NULL ? GROBO_ERR_ARG : runner->freeing ? GROBO_ERR_CLOSED : GROBO_ERR_FULL;
    }
    slot->posted = true;
    hand_over(runner, slot, fn, arg);
    slot->users = true;
    return GROBO_OK;
}

int grobo_runner_post(grobo_runner *runner, grobo_runner_fn fn, void *arg)
{
    RETURN_LOCKED(runner, int, GROBO_ERR_ARG, post(runner, fn, arg));
}
