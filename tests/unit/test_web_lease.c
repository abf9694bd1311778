/* SPDX-License-Identifier: MIT */
/* Who drives, and for how long. */
#include <stdint.h>
#include <string.h>

#include "tests/support/test.h"
#include "tools/grctl/web/lease.h"

#define SECOND INT64_C(1000000)

static lease l;
static char anna[ACCESS_SECRET_BYTES], ben[ACCESS_SECRET_BYTES];

static int anna_drives(void)
{
    memset(&l, 0, sizeof l);
    assert_true(lease_take(&l, "Anna", "", false, 5 * SECOND));
    memcpy(anna, l.holder.secret, sizeof anna);
    return 0;
}

static const test_fixture fixture[] = {{NULL, anna_drives, NULL}};

static void ben_asks(int64_t now_us)
{
    assert_true(lease_ask(&l, "Ben", now_us));
    memcpy(ben, l.asker.secret, sizeof ben);
}

TEST_WITH(fixture, one_drives_at_a_time)
{
    assert_int_equal(strlen(anna), 32);
    assert_true(lease_is_holder(&l, anna));
    assert_false(lease_is_holder(&l, ""));
    assert_false(lease_is_holder(&l, NULL));
    assert_false(lease_take(&l, "Ben", "", false, 6 * SECOND));
    assert_string_equal(l.holder.name, "Anna");
    assert_true(lease_take(&l, "Anna again", anna, false, 6 * SECOND));
    assert_false(lease_is_holder(&l, anna)); /* each has a secret of its own */
    assert_true(lease_take(&l, "Ben", "", true, 7 * SECOND));
    assert_string_equal(l.holder.name, "Ben");
}

TEST(nobody_is_no_holder)
{
    lease none = {.beat_us = 0};
    assert_false(lease_is_holder(&none, ""));
    assert_false(lease_beat(&none, "", SECOND));
    assert_false(lease_give(&none, "", SECOND));
    assert_false(lease_ask(&none, "Ben", SECOND));
    assert_true(lease_silent_us(&none, 100 * SECOND) == 0);
}

TEST_WITH(fixture, silence_is_counted_from_the_last_beat)
{
    assert_true(lease_silent_us(&l, 6 * SECOND) == SECOND);
    assert_false(lease_beat(&l, "0123", 7 * SECOND));
    assert_true(lease_silent_us(&l, 7 * SECOND) == 2 * SECOND);
    assert_true(lease_beat(&l, anna, 8 * SECOND));
    assert_true(lease_silent_us(&l, 8 * SECOND) == 0);
}

TEST_WITH(fixture, who_asked_may_take_after_ten_seconds)
{
    ben_asks(20 * SECOND);
    assert_false(lease_take(&l, "Ben", ben, false, 30 * SECOND - 1));
    assert_false(lease_take(&l, "Carl", "", false, 31 * SECOND));
    assert_true(lease_take(&l, "Ben", ben, false, 30 * SECOND));
    assert_string_equal(l.holder.name, "Ben");
    assert_false(lease_is_holder(&l, anna));
    assert_string_equal(l.asker.secret, ""); /* what was asked is over */
}

TEST_WITH(fixture, what_is_denied_is_over)
{
    ben_asks(20 * SECOND);
    assert_false(lease_deny(&l, ben));
    assert_true(lease_deny(&l, anna));
    assert_false(lease_take(&l, "Ben", ben, false, 40 * SECOND));
}

TEST_WITH(fixture, it_is_given_to_who_asked)
{
    ben_asks(20 * SECOND);
    assert_false(lease_give(&l, ben, 21 * SECOND));
    assert_true(lease_give(&l, anna, 21 * SECOND));
    assert_true(lease_is_holder(&l, ben));
    assert_false(lease_is_holder(&l, anna));
    assert_true(lease_silent_us(&l, 22 * SECOND) == SECOND);
    assert_true(lease_give(&l, ben, 23 * SECOND)); /* nobody has asked */
    assert_false(lease_is_held(&l));
}

TEST_WITH(fixture, a_stop_leaves_nobody)
{
    ben_asks(20 * SECOND);
    lease_end(&l);
    assert_false(lease_is_held(&l) || lease_is_holder(&l, anna) || lease_is_holder(&l, ben));
    assert_false(lease_take(&l, "Ben", ben, false, 40 * SECOND) && lease_is_holder(&l, ben));
}
