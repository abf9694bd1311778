/* SPDX-License-Identifier: MIT */
/* What the files of src/link share. */
#ifndef GROBO_LINK_LINK_H
#define GROBO_LINK_LINK_H

#include <sys/time.h>

#include <grobo/core/loop.h>
#include <grobo/types.h>

#include "src/base/memory.h"

/* A span of time as libevent takes it; negative is 0. */
struct timeval grobo_i_link_timeval(int64_t span_us);

/* grobo_timer_set() where the time is known. */
int grobo_i_timer_set(grobo_timer *timer, int64_t deadline_us, int64_t now_us);

/* Where grobo_timer_set() had no memory: called back in the loop's next round, whatever the time.
 * It takes no memory. Not for a loop of single rounds (EVLOOP_ONCE): that would not end. */
void grobo_i_timer_instead(grobo_timer *timer);

#endif
