/* SPDX-License-Identifier: MIT */
/* Events that wait on disk for a broker. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/test.h"
#include "tools/grctl/cli/sync.h"
#include "tools/grctl/fleet/message.h"
#include "tools/grctl/fleet/spool.h"

static const char path[] = "test_fleet_spool.tmp", old[] = "test_fleet_spool.tmp.old";
static int64_t first, last;
static int n;

static void take(void *ctx, json_t *event)
{
    int64_t number = fleet_number(event, "n", -1);
    (void)ctx;
    assert_true(n == 0 || number == last + 1);
    first = n == 0 ? number : first;
    last = number;
    n++;
}

static void empty(void)
{
    n = 0;
    spool_empty(path, take, NULL);
}

static void add(int number)
{
    json_t *event = json_pack("{s:i,s:i,s:s}", "v", 1, "n", number, "message", "link_down");
    assert_true(spool_add(path, event));
    json_decref(event);
}

static int clean(void)
{
    sync_end();
    (void)remove(path);
    (void)remove(old);
    return 0;
}

static const test_fixture fixture[] = {{NULL, clean, clean}};

TEST_WITH(fixture, what_is_kept_comes_in_its_order_once)
{
    for (int i = 0; i < 5; i++) {
        add(i);
    }
    empty();
    assert_int_equal(n, 5);
    assert_int_equal(first, 0);
    empty();
    assert_int_equal(n, 0);
}

/* As a full disk or a power failure leaves it. */
TEST_WITH(fixture, half_a_line_takes_no_other_with_it)
{
    static const char half[] = "{\"v\":1,\"n\":0,\"mess";
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(half, 1, sizeof half - 1, file), sizeof half - 1);
    assert_int_equal(fclose(file), 0);
    add(1);
    add(2);
    empty();
    assert_int_equal(n, 2);
    assert_int_equal(first, 1);
}

static long size_of(const char *name)
{
    FILE *file = fopen(name, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    long size = ftell(file);
    fclose(file);
    return size;
}

TEST_WITH(fixture, the_oldest_go_where_it_is_full)
{
    enum { MANY = 12000 };
    for (int i = 0; i < MANY; i++) {
        add(i);
    }
    assert_true(size_of(path) <= SPOOL_FILE_BYTES && size_of(old) <= SPOOL_FILE_BYTES);
    empty();
    assert_int_equal(last, MANY - 1);
    assert_in_range(n, 2000, MANY - 1);
}

TEST_WITH(fixture, lines_that_cannot_be_read_are_dropped)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs("{\"v\":1,\"n\":\nrubbish\n{\"v\":2,\"n\":3}\n", file);
    fclose(file);
    add(7);
    empty();
    assert_int_equal(n, 1);
    assert_int_equal(first, 7);
}
