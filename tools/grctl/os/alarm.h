/* SPDX-License-Identifier: MIT */
/*
 * A timer of a loop that can always be set: it is pending all its life, and to change the time of
 * one that is takes no memory. Its function, which is called again and again, clears it first.
 * Where nobody has set it for ALARM_NEVER_S it is called too, and nobody has asked for that.
 */
#ifndef GRCTL_OS_ALARM_H
#define GRCTL_OS_ALARM_H

#include <stdint.h>

#include <event2/event.h>

/* Never: a year and a half. Some systems refuse to wait for more than three. */
enum { ALARM_NEVER_S = 50000000 };

static inline void alarm_clear(struct event *alarm)
{
    static const struct timeval never = {.tv_sec = ALARM_NEVER_S};
    (void)event_add(alarm, &never);
}

/* Rings so long from now, at most ALARM_NEVER_S. */
static inline void alarm_set(struct event *alarm, int64_t us)
{
    const struct timeval after = {.tv_sec = (int)(us / 1000000), .tv_usec = (int)(us % 1000000)};
    (void)event_add(alarm, &after);
}

/* NULL: no memory. For event_free(). */
static inline struct event *alarm_new(struct event_base *base, event_callback_fn fn, void *ctx)
{
    static const struct timeval never = {.tv_sec = ALARM_NEVER_S};
    struct event *alarm = event_new(base, -1, EV_PERSIST, fn, ctx);
    if (alarm && event_add(alarm, &never) != 0) {
        event_free(alarm);
        alarm = NULL;
    }
    return alarm;
}

#endif
