/* SPDX-License-Identifier: MIT */
/* A request acts on the situation that its page had seen, or not at all. */
#include <stdint.h>
#include <string.h>

#include "tests/support/test.h"
#include "tools/grctl/web/based.h"

#define MS INT64_C(1000)

static based b;
static char said[BASED_COMPLAINT_BYTES];

static int begin(void)
{
    memset(&b, 0, sizeof b);
    memset(said, 0, sizeof said);
    return 0;
}

static const test_fixture fixture[] = {{NULL, begin, NULL}};

static bool check_number(json_int_t n, int64_t now_us)
{
    json_t *sequence = json_integer(n);
    bool fine = based_check(&b, sequence, now_us, "reset", said);
    json_decref(sequence);
    return fine;
}

TEST_WITH(fixture, a_state_is_fresh_for_a_second)
{
    based_tell(&b, 0);
    assert_true(check_number(1, 1000 * MS));
    assert_false(check_number(1, 1001 * MS));
    assert_non_null(strstr(said, "less than a second ago"));
    based_tell(&b, 1001 * MS);
    assert_true(check_number(2, 1001 * MS));
    assert_false(check_number(1, 1001 * MS));
}

TEST_WITH(fixture, numbers_of_no_state_are_refused)
{
    static const json_int_t none[] = {0, -1, 3, INT64_MAX, INT64_MIN};
    based_tell(&b, 0);
    based_tell(&b, 0);
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        assert_false(check_number(none[i], 0));
    }
    json_t *text = json_string("2");
    assert_false(based_check(&b, text, 0, "reset", said));
    assert_false(based_check(&b, NULL, 0, "reset", said));
    json_decref(text);
}

TEST_WITH(fixture, what_came_before_a_change_is_void)
{
    based_tell(&b, 0);
    assert_true(check_number(1, 10 * MS));
    based_change(&b, 10 * MS, "stop by %s", "Anna");
    assert_false(check_number(1, 10 * MS));
    assert_string_equal(said, "reset: based on state 1, but since then: stop by Anna; look at the "
                              "present state first");
    assert_true(check_number(2, 10 * MS)); /* of the answer to that stop */
    based_tell(&b, 33 * MS);
    assert_true(check_number(3, 40 * MS));
    assert_true(check_number(2, 40 * MS));
}

TEST_WITH(fixture, a_second_stop_voids_what_was_based_on_the_first)
{
    based_tell(&b, 0);
    based_change(&b, 10 * MS, "stop by Anna");
    based_change(&b, 20 * MS, "stop by Ben");
    assert_false(check_number(2, 20 * MS));
    assert_non_null(strstr(said, "stop by Ben"));
    assert_true(check_number(3, 20 * MS));
}

TEST_WITH(fixture, many_states_within_a_second_forget_the_oldest)
{
    for (int i = 0; i < BASED_KEPT + 1; i++) {
        based_tell(&b, 0);
    }
    assert_false(check_number(1, 0));
    assert_true(check_number(2, 0));
}
