/* SPDX-License-Identifier: MIT */
/*
 * How threads hand calls to the loop. A call takes a slot, and the loop calls its function, again
 * and again, until it is over. The caller sleeps at the slot's socket meanwhile; or, where nobody
 * runs the loop, runs it itself.
 */
#include <string.h>

#include "src/link/thread_i.h"

/* Longest sleep at once. */
#define SLEEP_MAX_US INT64_C(3600000000)

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

/* ---- waking ------------------------------------------------------------------------------- */

int grobo_i_control_pair(grobo_socket pair[2])
{
    evutil_socket_t made[2];

    /* libevent takes AF_UNIX for a local pair on every system. */
    if (grobo_port_start() < 0 || evutil_socketpair(AF_UNIX, SOCK_STREAM, 0, made) != 0) {
        return GROBO_ERR_NOMEM;
    }
    pair[0] = made[0];
    pair[1] = made[1];
    for (int i = 0; i < 2; i++) {
        if (evutil_make_socket_nonblocking(pair[i]) != 0 ||
            evutil_make_socket_closeonexec(pair[i]) != 0) {
            grobo_i_control_unpair(pair);
            return GROBO_ERR_NOMEM;
        }
    }
    return GROBO_OK;
}

void grobo_i_control_unpair(grobo_socket pair[2])
{
    for (int i = 0; i < 2; i++) {
        if (pair[i] != GROBO_SOCKET_NULL) {
            evutil_closesocket(pair[i]);
            pair[i] = GROBO_SOCKET_NULL;
        }
    }
}

void grobo_i_control_drain(grobo_socket socket)
{
    char bytes[16];

    while (recv(socket, bytes, sizeof bytes, 0) == (int)sizeof bytes) {
    }
}

static void ring(grobo_socket socket)
{
    /* A full socket has bytes enough to wake whoever sleeps there. */
    (void)send(socket, "", 1, 0);
}

void grobo_i_control_wake(grobo_control *control)
{
    if (!control->woken) {
        control->woken = true;
        ring(control->wake_socket[1]);
    }
}

void grobo_i_control_sleep(grobo_control *control, control_slot *slot, int64_t end_us)
{
    int64_t span_us = end_us == GROBO_NEVER_US ? SLEEP_MAX_US : end_us - grobo_now_us();

    slot->sleeping = true;
    grobo_mutex_unlock(&control->lock);
    (void)grobo_port_wait(slot->socket[0], GROBO_PORT_READABLE,
                          span_us < SLEEP_MAX_US ? span_us : SLEEP_MAX_US);
    grobo_i_control_drain(slot->socket[0]);
    grobo_mutex_lock(&control->lock);
    slot->sleeping = false;
}

static void tell(control_slot *slot)
{
    if (slot->sleeping) {
        ring(slot->socket[1]);
    }
}

void grobo_i_control_tell_all(grobo_control *control)
{
    tell(&control->runner);
    for (size_t i = 0; i < CONTROL_SLOTS; i++) {
        tell(&control->slot[i]);
    }
}

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

control_slot *grobo_i_control_take(grobo_control *control, size_t most)
{
    control_slot *slot = take_slot(control, most);

    if (slot != NULL && slot->socket[0] == GROBO_SOCKET_NULL &&
        grobo_i_control_pair(slot->socket) < 0) {
        return NULL;
    }
    if (slot != NULL) {
        slot->state = CALL_WAITER;
    }
    return slot;
}

static void hand_over(grobo_control *control, control_slot *slot, grobo_control_fn fn, void *arg)
{
    slot->fn = fn;
    slot->arg = arg;
    slot->job = NULL;
    slot->ticket = ++control->tickets;
    slot->state = CALL_OPEN;
    grobo_i_control_wake(control);
}

int grobo_i_control_post(grobo_control *control, grobo_control_fn fn, void *arg)
{
    control_slot *slot = take_slot(control, GROBO_CONTROL_CALLS_MAX);

    if (control->freeing || slot == NULL) {
        return control->freeing ? GROBO_ERR_CLOSED : GROBO_ERR_FULL;
    }
    slot->posted = true;
    hand_over(control, slot, fn, arg);
    return GROBO_OK;
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

static void settle(control_slot *slot, int result)
{
    if (result == CALL_PENDING) {
        slot->state = CALL_OPEN;
    } else if (slot->posted) {
        slot->posted = false;
        slot->state = CALL_FREE;
    } else {
        slot->result = result;
        slot->state = CALL_DONE;
    }
    if (slot->state != CALL_OPEN || slot->impatient) {
        tell(slot);
    }
}

void grobo_i_control_serve(grobo_control *control)
{
    control_slot *slot;
    uint64_t after = 0;
    uint64_t last;

    grobo_mutex_lock(&control->lock);
    last = control->tickets; /* what a callback hands over has its turn in the next round */
    while ((slot = next_call(control, after)) != NULL && slot->ticket <= last) {
        grobo_control_fn fn = slot->fn;
        void *arg = slot->arg;
        int result;

        after = slot->ticket;
        slot->state = CALL_RUNNING;
        grobo_mutex_unlock(&control->lock);
        result = fn(control, arg);
        grobo_mutex_lock(&control->lock);
        settle(slot, result);
    }
    grobo_mutex_unlock(&control->lock);
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
            grobo_i_control_sleep(control, slot, slot->impatient ? GROBO_NEVER_US : end_us);
        } else {
            grobo_i_control_take_turn(control, end_us);
        }
    }
    if (slot->state == CALL_DONE) {
        result = slot->result;
    }
    slot->job = NULL;
    slot->state = CALL_FREE;
    return result;
}

static int64_t end_of(int64_t timeout_us)
{
    int64_t now_us = grobo_now_us();

    if (timeout_us <= 0) {
        timeout_us = GROBO_CONTROL_TIMEOUT_US;
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
} call_wish;

static int call_and_wait(grobo_control *control, const call_wish *wish)
{
    int64_t end_us = end_of(wish->timeout_us);
    control_slot *slot;
    int result = GROBO_ERR_FULL;

    grobo_i_control_lock(control);
    slot = grobo_i_control_take(control, wish->urgent ? CONTROL_SLOTS : GROBO_CONTROL_CALLS_MAX);
    if (slot != NULL) {
        hand_over(control, slot, wish->fn, wish->arg);
        slot->job = wish->job;
        if (wish->job != NULL) {
            wish->job->seen_losses = control->losses;
        }
        result = wait_for(control, slot, end_us);
    }
    grobo_i_control_unlock(control);
    return result;
}

int grobo_i_control_call(grobo_control *control, grobo_control_fn fn, void *arg)
{
    const call_wish wish = {.fn = fn, .arg = arg};

    return grobo_i_control_inside(control) ? fn(control, arg) : call_and_wait(control, &wish);
}

int grobo_i_control_urgent_call(grobo_control *control, grobo_control_fn fn, void *arg)
{
    const call_wish wish = {.fn = fn, .arg = arg, .urgent = true};

    return grobo_i_control_inside(control) ? fn(control, arg) : call_and_wait(control, &wish);
}

int grobo_i_control_wait(grobo_control *control, grobo_control_fn fn, void *arg, int64_t timeout_us)
{
    const call_wish wish = {.fn = fn, .arg = arg, .timeout_us = timeout_us};

    return grobo_i_control_inside(control) ? GROBO_ERR_STATE : call_and_wait(control, &wish);
}

/* ---- jobs --------------------------------------------------------------------------------- */

int grobo_i_control_poll_job(grobo_control *control, void *arg)
{
    control_job *job = arg;

    if (job->number == 0) {
        job->begun_us = grobo_now_us();
        int r =
            job->seen_losses != control->losses ? GROBO_ERR_UNPLUGGED : job->start(control, job);

        if (r == GROBO_ERR_STATE &&
            grobo_robot_job(grobo_session_robot(control->session)) != GROBO_JOB_NONE) {
            return CALL_PENDING; /* behind the one that runs */
        }
        if (r <= 0) {
            return r;
        }
        job->number = r;
        if (control->last_job == r) {
            job->ended = true;
            job->result = control->last_result;
        }
    }
    return job->ended ? job->result : CALL_PENDING;
}

int grobo_i_control_job(grobo_control *control, control_job *job, grobo_control_fn fn,
                        int64_t timeout_us)
{
    const call_wish wish = {.fn = fn != NULL ? fn : grobo_i_control_poll_job,
                            .arg = job,
                            .job = job,
                            .timeout_us = timeout_us};

    return grobo_i_control_inside(control) ? GROBO_ERR_STATE : call_and_wait(control, &wish);
}

int grobo_i_control_urgent_job(grobo_control *control, control_job *job, int64_t timeout_us)
{
    const call_wish wish = {.fn = grobo_i_control_poll_job,
                            .arg = job,
                            .job = job,
                            .timeout_us = timeout_us,
                            .urgent = true};

    return grobo_i_control_inside(control) ? GROBO_ERR_STATE : call_and_wait(control, &wish);
}

/* ---- the public functions ----------------------------------------------------------------- */

int grobo_control_call(grobo_control *control, grobo_control_fn fn, void *arg)
{
    return fn != NULL ? grobo_i_control_call(control, fn, arg) : GROBO_ERR_ARG;
}

int grobo_control_post(grobo_control *control, grobo_control_fn fn, void *arg)
{
    int r = GROBO_ERR_ARG;

    if (fn != NULL) {
        grobo_i_control_lock(control);
        r = grobo_i_control_post(control, fn, arg);
        grobo_i_control_unlock(control);
    }
    return r;
}
