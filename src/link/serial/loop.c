/* SPDX-License-Identifier: MIT */
#include <event2/event.h>

#include <grobo/core/loop.h>
#include <grobo/core/port.h>

#include "src/link/serial/loop.h"

/* Longest span given to libevent at once; a later deadline is reached in several. */
#define SPAN_MAX_US INT64_C(3600000000)

struct grobo_timer {
    struct event *event;
    grobo_timer_fn fn;
    void *ctx;
    const grobo_mem *mem;
    int64_t deadline_us;
    int64_t armed_us; /* when the event comes, at the latest then; GROBO_NEVER_US: not added */
};

struct timeval grobo_i_link_timeval(int64_t span_us)
{
    struct timeval tv = {0, 0};

    if (span_us > 0) {
        /* Systems do not agree on the types: int goes into all of them. */
        tv.tv_sec = (int)(span_us / 1000000);
        tv.tv_usec = (int)(span_us % 1000000);
    }
    return tv;
}

/* For the four descriptors of a base libevent ends the program where it has none. Where another
 * thread takes them behind this look, it still does. */
static bool has_descriptors(void)
{
    evutil_socket_t pairs[2][2];
    int made = 0;

    while (made < 2 && evutil_socketpair(AF_UNIX, SOCK_STREAM, 0, pairs[made]) == 0) {
        made++;
    }
    for (int i = 0; i < 2 * made; i++) {
        evutil_closesocket(pairs[i / 2][i % 2]);
    }
    return made == 2;
}

struct event_base *grobo_loop_new(void)
{
    bool may = grobo_port_start() >= 0 && has_descriptors();
    struct event_config *config = may ? event_config_new() : NULL;
    struct event_base *base = NULL;

    if (config == NULL) {
        return NULL;
    }
    /*
     * Without a cached time, spans count from the moment a timer is set and not from the moment
     * the loop woke up, which a slow callback makes a while ago.
     */
    if (event_config_set_flag(config, EVENT_BASE_FLAG_PRECISE_TIMER) == 0 &&
        event_config_set_flag(config, EVENT_BASE_FLAG_NO_CACHE_TIME) == 0) {
        base = event_base_new_with_config(config);
    }
    event_config_free(config);
    return base;
}

void grobo_loop_free(struct event_base *base)
{
    if (base != NULL) {
        event_base_free(base);
    }
}

static void on_end(evutil_socket_t number, short what, void *ctx)
{
    (void)number, (void)what;
    event_base_loopbreak(ctx);
}

int grobo_loop_run(struct event_base *base, int64_t for_us)
{
    if (base == NULL || for_us < 0) {
        return GROBO_ERR_ARG;
    }
    if (for_us == 0) {
        return event_base_loop(base, EVLOOP_NONBLOCK) < 0 ? GROBO_ERR_IO : GROBO_OK;
    }
    struct event *end = evtimer_new(base, on_end, base);
    struct timeval tv = grobo_i_link_timeval(for_us);
    if (end == NULL || evtimer_add(end, &tv) != 0) {
        if (end != NULL) {
            event_free(end);
        }
        return GROBO_ERR_NOMEM;
    }
    int result = event_base_loop(base, 0);
    event_free(end);
    return result < 0 ? GROBO_ERR_IO : GROBO_OK;
}

static int arm(grobo_timer *timer)
{
    int64_t span_us = timer->deadline_us - grobo_now_us();
    struct timeval tv = grobo_i_link_timeval(span_us < SPAN_MAX_US ? span_us : SPAN_MAX_US);

    if (event_add(timer->event, &tv) != 0) {
        timer->deadline_us = timer->armed_us = GROBO_NEVER_US;
        return GROBO_ERR_NOMEM;
    }
    timer->armed_us = timer->deadline_us;
    return GROBO_OK;
}

static void on_time(evutil_socket_t fd, short what, void *arg)
{
    grobo_timer *timer = arg;
    int64_t late_us = grobo_now_us() - timer->deadline_us;

    (void)fd;
    (void)what;
    /* A base with a coarse clock or a cached time calls early. Other events may have taken the
     * memory meanwhile: then early is better than never. */
    if (late_us < 0 && arm(timer) == GROBO_OK) {
        return;
    }
    late_us = late_us < 0 ? 0 : late_us;
    timer->deadline_us = timer->armed_us = GROBO_NEVER_US;
    timer->fn(timer->ctx, timer, late_us);
}

int grobo_timer_new(struct event_base *base, grobo_timer_fn fn, void *ctx, const grobo_mem *mem,
                    grobo_timer **timer)
{
    grobo_timer *made;

    if (base == NULL || fn == NULL || timer == NULL) {
        return GROBO_ERR_ARG;
    }
    made = grobo_i_new(mem, sizeof *made);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->event = event_new(base, -1, 0, on_time, made);
    if (made->event == NULL) {
        grobo_i_free(mem, made, sizeof *made);
        return GROBO_ERR_NOMEM;
    }
    made->fn = fn;
    made->ctx = ctx;
    made->mem = mem;
    made->deadline_us = made->armed_us = GROBO_NEVER_US;
    *timer = made;
    return GROBO_OK;
}

void grobo_timer_free(grobo_timer *timer)
{
    if (timer != NULL) {
        event_free(timer->event);
        grobo_i_free(timer->mem, timer, sizeof *timer);
    }
}

int grobo_timer_set(grobo_timer *timer, int64_t deadline_us)
{
    return timer == NULL ? GROBO_ERR_ARG : grobo_i_timer_set(timer, deadline_us, grobo_now_us());
}

int grobo_i_timer_set(grobo_timer *timer, int64_t deadline_us, int64_t now_us)
{
    bool is_due = timer->deadline_us <= now_us;

    if (deadline_us == GROBO_NEVER_US && timer->deadline_us == GROBO_NEVER_US &&
        timer->armed_us == GROBO_NEVER_US) {
        return GROBO_OK;
    }

    /* The clock is never negative: what was before it has passed, however long ago. */
    timer->deadline_us = deadline_us < 0 ? 0 : deadline_us;
    if (deadline_us == GROBO_NEVER_US) {
        timer->armed_us = GROBO_NEVER_US;
        (void)event_del(timer->event);
        return GROBO_OK;
    }
    /* One that comes sooner is left, where that is not soon: a deadline that is put off again and
     * again is set anew now and then, and the loop does not wake up for what is over. */
    if (timer->armed_us <= timer->deadline_us && timer->armed_us > now_us &&
        timer->armed_us - now_us >= (timer->deadline_us - now_us) / 2) {
        return GROBO_OK;
    }
    /*
     * A callback that is due stays due: to add its event again would take it out of the loop's
     * present round, and a timer that is set anew in every round would never be called.
     */
    return is_due && deadline_us <= now_us ? GROBO_OK : arm(timer);
}

void grobo_i_timer_instead(grobo_timer *timer)
{
    timer->deadline_us = grobo_now_us();
    event_active(timer->event, EV_TIMEOUT, 1);
    /* Else the loop would go on with this one, and never look at its descriptors. */
    (void)event_base_loopcontinue(event_get_base(timer->event));
}

int64_t grobo_timer_deadline(const grobo_timer *timer)
{
    return timer == NULL ? GROBO_NEVER_US : timer->deadline_us;
}
