/* SPDX-License-Identifier: MIT */
/*
 * Tests that register themselves, over cmocka. A file of tests has no list of them and no main():
 *
 *     #include "tests/support/test.h"
 *
 *     TEST(a_new_queue_is_empty)
 *     {
 *         assert_int_equal(queue_size(&queue), 0);
 *     }
 *
 * They run in the order in which they stand in the file. The program runs those alone in whose
 * names one of its arguments stands ("test_queue empty"), and "--list" prints the names. A blank
 * and a hyphen in an argument stand for an underscore.
 *
 * A program that is something else besides has a main(), which ends with test_main().
 */
#ifndef GROBO_TEST_TEST_H
#define GROBO_TEST_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* What stands around a test. Both may be NULL; they return 0, else the test has failed. */
typedef struct test_fixture {
    const char
        *name; /* told behind that of the test: "it_moves, on a bus"; NULL: nothing is told */
    int (*set_up)(void);
    int (*tear_down)(void);
} test_fixture;

/* A test by itself. */
#define TEST(test)                                                                                 \
    static void test(void);                                                                        \
    TEST_I_REGISTER(test, .run = test)                                                             \
    static void test(void)

/* A test that is run with each fixture of an array. */
#define TEST_WITH(fixture_array, test)                                                             \
    static void test(void);                                                                        \
    TEST_I_REGISTER(test, .run = test, .fixtures = (fixture_array),                                \
                    .n_fixtures = sizeof(fixture_array) / sizeof(fixture_array)[0])                \
    static void test(void)

/* A test that is run for each row, which it gets as `const type *row`. Rows are told by their
 * member `name`: "it_moves: lx16a". next(NULL) is the first row, next(row) that after it, NULL at
 * the end. */
#define TEST_FOR(type, next, test)                                                                 \
    static void test(const type *row);                                                             \
    TEST_I_ROWS(type, test)                                                                        \
    static const void *test##_row(const void *row)                                                 \
    {                                                                                              \
        return next((const type *)row);                                                            \
    }                                                                                              \
    static void test(const type *row)

/* The same for the rows of an array. */
#define TEST_EACH(type, row_array, test)                                                           \
    static void test(const type *row);                                                             \
    TEST_I_ROWS(type, test)                                                                        \
    static const void *test##_row(const void *before)                                              \
    {                                                                                              \
        const type *row = before == NULL ? (row_array) : (const type *)before + 1;                 \
        return row < (row_array) + sizeof(row_array) / sizeof(row_array)[0] ? row : NULL;          \
    }                                                                                              \
    static void test(const type *row)

/* Once in a file: what is done before the first of its tests and after the last one. */
#define TESTS_BETWEEN(before, after)                                                               \
    __attribute__((constructor)) static void test_i_between(void)                                  \
    {                                                                                              \
        test_i_around = (test_fixture){NULL, before, after};                                       \
    }

/* Of a test: what it tells, besides, where it does not come to its end; it gets the row. */
void test_if_it_breaks(void (*tell)(const void *row));

/* Runs the tests that the arguments choose; how many failed, 2 where none is called so. */
int test_main(int argc, char **argv);

/* ---- of the macros alone --------------------------------------------------------------------- */

typedef struct test_i_entry {
    const char *name;
    int line; /* constructors run in any order */
    void (*run)(void);
    const test_fixture *fixtures;
    size_t n_fixtures;
    void (*run_row)(const void *row);
    const void *(*next_row)(const void *row);
    const char *(*row_name)(const void *row);
    struct test_i_entry *next;
} test_i_entry;

extern test_fixture test_i_around;
void test_i_add(test_i_entry *entry);

#define TEST_I_REGISTER(test, ...)                                                                 \
    __attribute__((constructor)) static void test##_is_registered(void)                            \
    {                                                                                              \
        static test_i_entry entry = {.name = #test, .line = __LINE__, __VA_ARGS__};                \
        test_i_add(&entry);                                                                        \
    }

#define TEST_I_ROWS(type, test)                                                                    \
    static const void *test##_row(const void *before);                                             \
    static void test##_runs(const void *row)                                                       \
    {                                                                                              \
        test(row);                                                                                 \
    }                                                                                              \
    static const char *test##_name(const void *row)                                                \
    {                                                                                              \
        return ((const type *)row)->name;                                                          \
    }                                                                                              \
    TEST_I_REGISTER(test, .run_row = test##_runs, .next_row = test##_row, .row_name = test##_name)

#endif
