/* SPDX-License-Identifier: MIT */
/* For tests of the classic shelf: `g` is a simulated GR001 that is connected, alone on its line, in
 * virtual time: TEST_WITH(alone, ...). A test program includes it once. */
#ifndef TESTS_CLASSIC_ALONE_H
#define TESTS_CLASSIC_ALONE_H

#include <grobo/classic/classic.h>

#include "tests/support/test.h"
#include "tests/support/virtual_clock.h"

static GR001 *g;

static int set_up(void)
{
    g = GR001_new("sim");
    assert_non_null(g);
    return SerialRobot_connect(g) == 1 ? 0 : -1;
}

static int tear_down(void)
{
    GR001_delete(g);
    g = NULL;
    return 0;
}

static const test_fixture alone[] = {{NULL, set_up, tear_down}};

/* Until it rests. */
static void go(void)
{
    assert_int_equal(SerialRobot_wait(g, 20000), 0);
}

#endif
