/* SPDX-License-Identifier: MIT */
#ifndef GROBO_TESTS_NOBODY_H
#define GROBO_TESTS_NOBODY_H

/*
 * Calls do_it in a process of a user without rights, and returns its result, 0 or negative. Skips
 * the test where this is not root, who alone can become another user.
 */
int as_nobody(int (*do_it)(void *ctx), void *ctx);

#endif
