/* SPDX-License-Identifier: MIT */
/*
 * The rounds of the loop, and how threads hand calls to it. A call takes a slot, and the loop calls
 * its function, again and again, until it is over. The caller sleeps at the condition meanwhile;
 * or, where no thread runs the loop, runs it itself. Nothing of this takes a descriptor or memory.
 */
#include "src/base/assert.h"
#include "src/link/session/session.h"
#include "src/link/thread/thread.h"

/* ---- slots -------------------------------------------------------------------------------- */

static control_slot *take_slot(grobo_control *control, size_t most)
{
    for (size_t i = 0; i < most; i++) {
        if (control->slot[i].state == CALL_FREE) {
            return &control->slot[i];
        }
    }
    return NULL;
}

static void hand_over(grobo_control *control, control_slot *slot, grobo_control_fn fn, void *arg)
{
    GROBO_ASSERT(slot->state == CALL_FREE && fn != NULL);
    slot->fn = fn;
    slot->arg = arg;
    slot->users = false;
    slot->impatient = false;
    slot->ticket = ++control->tickets;
    slot->state = CALL_OPEN;
    grobo_i_control_wake(control);
}

/* ---- on the loop -------------------------------------------------------------------------- */

/* The oldest call after a ticket. */
static control_slot *next_call(grobo_control *control, uint64_t after)
{
    control_slot *next = NULL;

    for (size_t i = 0; i < CONTROL_SLOTS; i++) {
        control_slot *slot = &control->slot[i];

        if (slot->state == CALL_OPEN && slot->ticket > after &&
            (next == NULL || slot->ticket < next->ticket)) {
            next = slot;
        }
    }
    return next;
}

static void settle(grobo_control *control, control_slot *slot, int result)
{
    GROBO_ASSERT(slot->state == CALL_RUNNING);
    if (result == CALL_PENDING) {
        slot->state = CALL_OPEN;
    } else if (slot->posted) {
        slot->posted = false;
        slot->state = CALL_FREE;
    } else {
        slot->result = result;
        slot->state = CALL_DONE;
    }
    if (slot->state == CALL_DONE || slot->impatient) {
        grobo_i_control_wake_all(control);
    }
}

static int call_user(grobo_control *control, grobo_control_fn fn, void *arg)
{
    int64_t since_us = grobo_i_session_enter_callback(control->session);
    int r = fn(arg, control);

    grobo_i_session_leave_callback(control->session, GROBO_CALLBACK_CALL, since_us);
    return r;
}

/* What was posted by grobo_session_post_estop() and its like goes before every call. */
static void serve(grobo_control *control)
{
    control_slot *slot;
    uint64_t after = 0;

    grobo_mutex_lock(&control->lock);
    control->woken = false;
    uint64_t last = control->tickets; /* what a callback hands over has the next round */
    while ((slot = next_call(control, after)) != NULL && slot->ticket <= last) {
        grobo_control_fn fn = slot->fn;
        void *arg = slot->arg;
        bool users = slot->users;
        int result;

        after = slot->ticket;
        slot->state = CALL_RUNNING;
        grobo_mutex_unlock(&control->lock);
        grobo_i_session_attend(control->session);
        result = users ? call_user(control, fn, arg) : fn(arg, control);
        grobo_mutex_lock(&control->lock);
        settle(control, slot, result);
    }
    grobo_mutex_unlock(&control->lock);
    grobo_i_session_attend(control->session);
}

/* ---- a round ------------------------------------------------------------------------------ */

int64_t grobo_control_get_period_us(grobo_control *control)
{
    RETURN_LOCKED(control, int64_t, 0, control->period_us);
}

void grobo_i_control_round(grobo_control *control, int64_t end_us)
{
    round_frame frame;

    grobo_i_control_begin_round(&frame, control);
    if (control->tick_us == GROBO_NEVER_US) {
        control->tick_us = grobo_now_us() + grobo_control_get_period_us(control);
    }
    if (grobo_timer_set(control->timer, end_us < control->tick_us ? end_us : control->tick_us) <
        0) {
        grobo_i_session_wake(control->session); /* a round that does not wait, and the next one */
    }
    (void)event_base_loop(control->base, EVLOOP_ONCE);
    grobo_i_control_look_at_play(control);
    serve(control);
    grobo_i_control_end_round(&frame);
}

void grobo_i_control_take_turn(grobo_control *control, int64_t end_us)
{
    control->looping = true;
    grobo_mutex_unlock(&control->lock);
    grobo_i_control_round(control, end_us);
    grobo_mutex_lock(&control->lock);
    control->looping = false;
    grobo_i_control_wake_all(control);
}

void grobo_i_control_end_calls(grobo_control *control)
{
    round_frame frame;

    grobo_i_control_begin_round(&frame, control);
    grobo_i_control_lock(control);
    control->freeing = true;
    grobo_i_control_unlock(control);
    serve(control);
    grobo_i_control_end_round(&frame);
}

/* ---- waiting ------------------------------------------------------------------------------ */

/* With the lock: runs the loop, or sleeps while another thread does, until the call is over. */
static int wait_for(grobo_control *control, control_slot *slot, int64_t end_us)
{
    int result = GROBO_ERR_TIMEOUT;

    while (slot->state != CALL_DONE && (slot->state == CALL_RUNNING || grobo_now_us() < end_us)) {
        if (control->looping || control->running) {
            /* A function that runs uses our storage: it has to be over before we may give up. */
            slot->impatient = slot->state == CALL_RUNNING;
            grobo_i_control_sleep(control, slot->impatient ? GROBO_NEVER_US : end_us);
        } else {
            grobo_i_control_take_turn(control, end_us);
        }
    }
    if (slot->state == CALL_DONE) {
        result = slot->result;
    }
    GROBO_ASSERT(slot->state == CALL_DONE || slot->state == CALL_OPEN);
    slot->state = CALL_FREE;
    return result;
}

static int64_t end_of(const grobo_control *control, int64_t timeout_us)
{
    int64_t now_us = grobo_now_us();

    if (timeout_us <= 0) {
        timeout_us = control->timeout_us;
    }
    return timeout_us > GROBO_NEVER_US - now_us ? GROBO_NEVER_US : now_us + timeout_us;
}

/* A call as its caller has it. */
typedef struct call_wish {
    grobo_control_fn fn;
    void *arg;
    control_job *job; /* arg, where fn waits for a job */
    int64_t timeout_us;
    bool urgent;
    bool users;
} call_wish;

static int call_and_wait(grobo_control *control, const call_wish *wish)
{
    int64_t end_us = end_of(control, wish->timeout_us);
    int result = GROBO_ERR_FULL;

    grobo_i_control_lock(control);
    control_slot *slot = take_slot(control, wish->urgent ? CONTROL_SLOTS : GROBO_CONTROL_CALLS_MAX);
    if (slot != NULL) {
        hand_over(control, slot, wish->fn, wish->arg);
        slot->users = wish->users;
        if (wish->job != NULL) {
            wish->job->seen_losses = control->losses;
            wish->job->end_us = end_us;
        }
        result = wait_for(control, slot, end_us);
    }
    grobo_i_control_unlock(control);
    return result;
}

/* These two are where a control that is NULL is refused, for all public functions that come by. */
static int wait_outside(grobo_control *control, const call_wish *wish)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    return grobo_i_control_inside(control) ? GROBO_ERR_STATE : call_and_wait(control, wish);
}

/* In a callback at once, else handed over. */
static int call(grobo_control *control, const call_wish *wish)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!grobo_i_control_inside(control)) {
        return call_and_wait(control, wish);
    }
    grobo_i_session_attend(control->session);
    return wish->fn(wish->arg, control);
}

int grobo_i_control_call(grobo_control *control, grobo_control_fn fn, void *arg)
{
    const call_wish wish = {.fn = fn, .arg = arg};

    return call(control, &wish);
}

int grobo_i_control_wait(grobo_control *control, grobo_control_fn fn, void *arg, int64_t timeout_us)
{
    const call_wish wish = {.fn = fn, .arg = arg, .timeout_us = timeout_us};

    return wait_outside(control, &wish);
}

/* ---- jobs ------------------------------------------------------------------------------------
 * A job is the engine's: what is known of it here is its number, and how it has ended. */

/* On the loop: how a job has ended. */
static int result_of(grobo_control *control, int number)
{
    grobo_i_control_lock(control);
    int r = grobo_i_control_end_of_job(control, number);
    grobo_i_control_unlock(control);
    return r != CALL_PENDING || grobo_robot_is_pending(control_robot(control), number)
               ? r
               : GROBO_ERR_NOTFOUND;
}

/* Makes the request, again in each round while the engine refuses it beside what runs; then looks
 * how the job has ended. */
static int poll_job(void *arg, grobo_control *control)
{
    control_job *job = arg;

    if (job->number == 0) {
        job->begun_us = grobo_now_us();
        int r =
            job->seen_losses != control->losses ? GROBO_ERR_UNPLUGGED : job->start(control, job);

        if (r == GROBO_ERR_FULL ||
            (r == GROBO_ERR_STATE && grobo_robot_job(control_robot(control)) != GROBO_JOB_NONE)) {
            return CALL_PENDING; /* behind those that run */
        }
        if (r <= 0) {
            return r;
        }
        job->number = r;
    }
    int result = result_of(control, job->number);
    job->ended = result != CALL_PENDING;
    return result;
}

int grobo_i_control_job(grobo_control *control, control_job *job, int64_t timeout_us)
{
    const call_wish wish = {
        .fn = poll_job, .arg = job, .job = job, .timeout_us = timeout_us, .urgent = job->urgent};

    return wait_outside(control, &wish);
}

int grobo_control_wait_job(grobo_control *control, int job, int64_t timeout_us)
{
    control_job known = {.number = job};

    if (control == NULL || job == 0) {
        return GROBO_ERR_ARG;
    }
    return job < 0 ? job : grobo_i_control_job(control, &known, timeout_us);
}

/* ---- the public functions ----------------------------------------------------------------- */

int grobo_control_call(grobo_control *control, grobo_control_fn fn, void *arg)
{
    const call_wish wish = {.fn = fn, .arg = arg, .users = true};

    return fn != NULL ? call(control, &wish) : GROBO_ERR_ARG;
}

/* With the lock: hands over without waiting. */
static int post(grobo_control *control, grobo_control_fn fn, void *arg)
{
    control_slot *slot = take_slot(control, GROBO_CONTROL_CALLS_MAX);

    if (fn == NULL || control->freeing || slot == NULL) {
        return fn == NULL ? GROBO_ERR_ARG : control->freeing ? GROBO_ERR_CLOSED : GROBO_ERR_FULL;
    }
    slot->posted = true;
    hand_over(control, slot, fn, arg);
    slot->users = true;
    return GROBO_OK;
}

int grobo_control_post(grobo_control *control, grobo_control_fn fn, void *arg)
{
    RETURN_LOCKED(control, int, GROBO_ERR_ARG, post(control, fn, arg));
}
