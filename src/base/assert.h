/* SPDX-License-Identifier: MIT */
/*
 * What always holds (docs/design.md). An assertion is about this program alone: what a caller, a
 * file or the wire may bring is checked and refused instead. NDEBUG compiles them out, as firmware
 * does; every build of the tests has them.
 */
#ifndef GROBO_BASE_ASSERT_H
#define GROBO_BASE_ASSERT_H

#include <stdbool.h>

#ifdef NDEBUG
/* Not evaluated, but still compiled: what it names is used. */
#define GROBO_ASSERT(that) ((void)(0 && (that)))
#else
#include <assert.h>
#define GROBO_ASSERT(that) assert(that)
#endif

/* True where all slots, joints and queues are walked through at each call, only to assert: in the
 * tests with sanitizers and under sabotage (-DGROBO_WALKS). The engine takes half as long again. */
#if defined(GROBO_WALKS) && !defined(NDEBUG)
#define GROBO_ASSERT_WALKS true
#else
#define GROBO_ASSERT_WALKS false
#endif

#endif
