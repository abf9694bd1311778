/* SPDX-License-Identifier: MIT */
/* What a fleet says: names, orders, what was done before, another's clock. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/test.h"
#include "tools/grctl/fleet/message.h"

static const char id[] = "00112233445566778899aabbccddeeff";
static const char other[] = "ffeeddccbbaa99887766554433221100";

TEST(names_leave_no_way_out_of_a_topic)
{
    char long_name[FLEET_NAME_BYTES + 1];
    memset(long_name, 'a', FLEET_NAME_BYTES);
    long_name[FLEET_NAME_BYTES] = '\0';
    assert_true(fleet_is_name("arm-1_B"));
    assert_true(fleet_is_name(long_name + 1));
    assert_false(fleet_is_name(long_name));
    static const char *const bad[] = {"", "a/b", "+", "#", "a b", "a.b", "\xc3\xa4", "$x", "a\n"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(fleet_is_name(bad[i]));
    }
    assert_false(fleet_is_name(NULL));
}

TEST(topics_are_taken_apart)
{
    char part[4][FLEET_NAME_BYTES], topic[FLEET_TOPIC_BYTES];
    assert_true(fleet_topic(topic, "h", "cmd", "stop", NULL));
    assert_string_equal(topic, "grobo/v1/h/cmd/stop");
    assert_int_equal(fleet_parts(topic, part), 3);
    assert_string_equal(part[0], "h");
    assert_string_equal(part[2], "stop");
    static const char *const bad[] = {"",
                                      "grobo/v1",
                                      "grobo/v1/",
                                      "grobo/v2/h",
                                      "x/v1/h",
                                      "grobo/v1/h//x",
                                      "grobo/v1/a/b/c/d/e",
                                      "grobo/v1/+",
                                      "grobo/v1/a b"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(fleet_parts(bad[i], part), 0);
    }
    char word[FLEET_TOPIC_BYTES];
    memset(word, 'x', sizeof word);
    word[sizeof word - 1] = '\0';
    assert_false(fleet_topic(topic, word, NULL, NULL, NULL));
}

TEST(payloads_are_objects_of_this_version)
{
    static const char *const bad[] = {"",
                                      "[]",
                                      "{}",
                                      "{\"v\":2}",
                                      "{\"v\":1",
                                      "{\"v\":1}x",
                                      "{\"v\":\"1\"}",
                                      "\xff",
                                      "{\"v\":1,\"v\":1}"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_null(fleet_read(bad[i], strlen(bad[i])));
    }
    char deep[8192];
    memset(deep, '[', sizeof deep);
    assert_null(fleet_read(deep, sizeof deep));
    json_t *object = fleet_read("{\"v\":1,\"n\":1.5,\"t\":7}", 21);
    assert_non_null(object);
    assert_int_equal(fleet_number(object, "n", -3), -3);
    assert_null(fleet_text(object, "t"));
    json_decref(object);
    /* A time of which the clock of another is taken away, or to which it is added. */
    object =
        json_pack("{s:I,s:I,s:I}", "far", INT64_MAX, "past", INT64_MIN, "most", INT64_C(1) << 53);
    assert_int_equal(fleet_number(object, "far", -3), -3);
    assert_int_equal(fleet_number(object, "past", -3), -3);
    assert_int_equal(fleet_number(object, "most", -3), INT64_C(1) << 53);
    json_decref(object);
}

static json_t *body(const char *id_, int64_t issued_us, int64_t deadline_us)
{
    return json_pack("{s:i,s:s,s:s,s:s,s:I,s:I}", "v", 1, "id", id_, "from", other, "epoch", id,
                     "issued_us", (json_int_t)issued_us, "deadline_us", (json_int_t)deadline_us);
}

static const char *read_order(json_t *object)
{
    fleet_order order;
    const char *why = NULL;
    (void)fleet_order_read(&order, "play", object, &why);
    json_decref(object);
    return why;
}

TEST(orders_are_whole)
{
    assert_null(read_order(body(id, 5, 9)));
    assert_string_equal(read_order(body("0011", 5, 9)), "it has no id");
    assert_string_equal(read_order(body("00112233445566778899AABBCCDDEEFF", 5, 9)), "it has no id");
    assert_string_equal(read_order(body(id, 9, 5)), "it has no times");
    assert_string_equal(read_order(body(id, -1, 5)), "it has no times");
    json_t *object = body(id, 5, 9);
    json_object_del(object, "from");
    assert_string_equal(read_order(object), "it does not say who sends it");
    object = body(id, 5, 9);
    json_object_set_new(object, "epoch", json_integer(4));
    assert_string_equal(read_order(object), "it has no epoch");
    object = body(id, 5, 9);
    json_object_del(object, "deadline_us");
    assert_string_equal(read_order(object), "it has no times");
}

static const char *judge(int64_t issued_us, int64_t deadline_us, int64_t now_us, const char *epoch)
{
    fleet_order order;
    const char *why;
    json_t *object = body(id, issued_us, deadline_us);
    assert_true(fleet_order_read(&order, "play", object, &why));
    why = fleet_order_judge(&order, epoch, now_us);
    json_decref(object);
    return why;
}

TEST(orders_are_of_now)
{
    int64_t s = 1000000;
    assert_null(judge(10 * s, 12 * s, 10 * s, id));
    assert_null(judge(10 * s, 12 * s, 12 * s, id));
    assert_string_equal(judge(10 * s, 12 * s, 12 * s + 1, id), "it is too late");
    assert_null(judge(10 * s, 12 * s, 19 * s / 2, id));
    assert_string_equal(judge(10 * s, 12 * s, 19 * s / 2 - 1, id), "it is from the future");
    assert_string_equal(judge(10 * s, 12 * s + 1, 10 * s, id), "it is valid for too long");
    assert_string_equal(judge(10 * s, 12 * s, 10 * s, other),
                        "it is for another life of this agent");
}

TEST(an_order_is_done_once)
{
    static fleet_seen seen;
    char made[FLEET_ID_BYTES];
    assert_null(fleet_seen_find(&seen, id));
    fleet_seen_begin(&seen, id);
    assert_string_equal(fleet_seen_find(&seen, id), "");
    fleet_seen_end(&seen, id, "{\"ok\":true}");
    assert_string_equal(fleet_seen_find(&seen, id), "{\"ok\":true}");
    for (int i = 0; i < FLEET_SEEN - 1; i++) {
        fleet_make_id(made);
        fleet_seen_begin(&seen, made);
    }
    assert_non_null(fleet_seen_find(&seen, id));
    fleet_make_id(made);
    fleet_seen_begin(&seen, made);
    assert_null(fleet_seen_find(&seen, id)); /* the oldest makes way */
    fleet_seen_end(&seen, id, "x");          /* and is no more */
    assert_null(fleet_seen_find(&seen, id));
    assert_int_equal(strlen(made), FLEET_ID_BYTES - 1);
    fleet_seen_free(&seen);
}

TEST(the_shortest_exchange_tells_the_clock)
{
    fleet_clock clock = {.n = 0};
    int64_t offset_us = 7, bound_us, true_us = 123456789;
    assert_false(fleet_clock_read(&clock, 0, &offset_us, &bound_us));
    for (int i = 0; i < 40; i++) { /* one way takes 100 us, the other up to 4 ms */
        int64_t sent_us = 1000000 + i * 10000, back_us = i % 8 == 3 ? 110 : 100 * (1 + i % 5 * 10);
        fleet_clock_add(&clock, sent_us, sent_us + 100 + true_us, sent_us + 100 + back_us);
        assert_true(fleet_clock_read(&clock, sent_us + 5000, &offset_us, &bound_us));
        assert_true(offset_us - true_us <= bound_us && true_us - offset_us <= bound_us);
    }
    assert_true(bound_us <= 110);
    assert_true(fleet_clock_read(&clock, 1390000 + 100000000, &offset_us, &bound_us));
    assert_in_range(bound_us, 5000, 5200); /* crystals differ */
}
