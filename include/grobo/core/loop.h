/* SPDX-License-Identifier: MIT */
/**
 * @file loop.h
 * @brief A libevent loop as robots need it, and timers with absolute deadlines.
 *
 * All of it belongs to the thread that runs the loop. The clock is grobo_now_us() of port.h.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_LOOP_H
#define GROBO_CORE_LOOP_H

#include <grobo/mem.h>
#include <grobo/types.h>

GROBO_BEGIN_DECLS

struct event_base;

/**
 * Makes an event_base whose timers keep microseconds: a default base rounds to the 4 ms of the
 * coarse clock and misses a period of 10 ms by 2. Any event_base works with this library, this
 * one keeps time. Freed by the caller with event_base_free(), after everything made on it.
 * @return NULL when memory or descriptors are out, or libevent has no backend.
 */
GROBO_API struct event_base *grobo_loop_new(void);

/** Frees a loop; NULL is fine. As event_base_free(), for programs that do not link libevent. */
GROBO_API void grobo_loop_free(struct event_base *base);

/**
 * Runs a loop for a time: all that comes meanwhile is called back, in this thread. For programs
 * whose own loop is another, and for those that do not link libevent.
 * @param for_us 0 or more; 0: what is due already
 * @return GROBO_OK, GROBO_ERR_ARG, GROBO_ERR_NOMEM, or GROBO_ERR_IO: libevent's backend has failed
 */
GROBO_API int grobo_loop_run(struct event_base *base, int64_t for_us);

/** A one-shot timer with an absolute deadline. */
typedef struct grobo_timer grobo_timer;

/**
 * Called when a deadline has come. The timer is not armed any more; it may be set again or freed
 * in here. `late_us` >= 0 is how long ago the deadline was. Without memory it may come early.
 */
typedef void (*grobo_timer_fn)(void *ctx, grobo_timer *timer, int64_t late_us);

/**
 * Makes a timer that is not armed.
 * @param base borrowed, must outlive the timer.
 * @param mem the allocator, borrowed; NULL: the C library's.
 * @param[out] timer freed with grobo_timer_free().
 * @return GROBO_OK, GROBO_ERR_ARG, GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_timer_new(struct event_base *base, grobo_timer_fn fn, void *ctx,
                              const grobo_mem *mem, grobo_timer **timer);

/** Disarms and frees; NULL is fine; legal inside the timer's own callback. */
GROBO_API void grobo_timer_free(grobo_timer *timer);

/**
 * Arms the timer for a moment of grobo_now_us(), in place of the one before. A moment that has
 * passed is called back in the loop's next round, not in here. GROBO_NEVER_US disarms.
 * A periodic timer adds its period to the deadline, never to the present: it does not drift.
 * @return GROBO_OK; GROBO_ERR_NOMEM (it is not armed; one that is armed already is never refused).
 */
GROBO_API int grobo_timer_set(grobo_timer *timer, int64_t deadline_us);

/** The moment the timer is armed for; GROBO_NEVER_US when it is not. */
GROBO_API int64_t grobo_timer_deadline(const grobo_timer *timer);

GROBO_END_DECLS

#endif
