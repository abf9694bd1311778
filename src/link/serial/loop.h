/* SPDX-License-Identifier: MIT */
/* What the files of src/link share. */
#ifndef GROBO_LINK_LINK_H
#define GROBO_LINK_LINK_H

#include <sys/time.h>

#include <grobo/types.h>

#include "src/base/memory.h"

/* A span of time as libevent takes it; negative is 0. */
struct timeval grobo_i_link_timeval(int64_t span_us);

#endif
