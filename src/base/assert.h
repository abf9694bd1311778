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
#define GROBO_ASSERTS false /* for loops that do nothing else */
#else
#include <assert.h>
#define GROBO_ASSERT(that) assert(that)
#define GROBO_ASSERTS true
#endif

#endif
