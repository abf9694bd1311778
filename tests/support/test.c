/* SPDX-License-Identifier: MIT */
/* Keeps the tests of a program, and gives those that are asked for to cmocka. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/test.h"

enum { NAME_MAX_BYTES = 256 };

/* A test with one of its fixtures or rows. */
typedef struct trial {
    char name[NAME_MAX_BYTES];
    const test_i_entry *test;
    const test_fixture *fixture;
    const void *row;
} trial;

test_fixture test_i_around;
static test_i_entry *first;
static trial *trials;
static size_t n_trials;

void test_i_add(test_i_entry *entry)
{
    test_i_entry **at = &first;
    while (*at != NULL && (*at)->line < entry->line) {
        at = &(*at)->next;
    }
    entry->next = *at;
    *at = entry;
}

/* ---- which ones ------------------------------------------------------------------------------ */

static bool is_alike(char a, char b)
{
    return a == b || (strchr("_- ", a) != NULL && strchr("_- ", b) != NULL);
}

static bool has_in_it(const char *name, const char *word)
{
    for (; *name != '\0'; name++) {
        size_t n = 0;
        while (word[n] != '\0' && name[n] != '\0' && is_alike(name[n], word[n])) {
            n++;
        }
        if (word[n] == '\0') {
            return true;
        }
    }
    return false;
}

static void keep(const test_i_entry *test, const test_fixture *fixture, const void *row, int argc,
                 char **argv)
{
    trial t = {.test = test, .fixture = fixture, .row = row};
    const char *what = row != NULL ? test->row_name(row) : fixture != NULL ? fixture->name : NULL;
    (void)snprintf(t.name, sizeof t.name, "%s%s%s", test->name,
                   what == NULL  ? ""
                   : row != NULL ? ": "
                                 : ", ",
                   what == NULL ? "" : what);
    bool chosen = argc < 2;
    for (int i = 1; i < argc && !chosen; i++) {
        chosen = has_in_it(t.name, argv[i]);
    }
    if (!chosen) {
        return;
    }
    trial *more = realloc(trials, (n_trials + 1) * sizeof *trials);
    if (more == NULL) {
        abort();
    }
    trials = more;
    trials[n_trials++] = t;
}

static void choose(int argc, char **argv)
{
    for (const test_i_entry *t = first; t != NULL; t = t->next) {
        if (t->run_row != NULL) {
            for (const void *row = t->next_row(NULL); row != NULL; row = t->next_row(row)) {
                keep(t, NULL, row, argc, argv);
            }
        } else if (t->fixtures != NULL) {
            for (size_t i = 0; i < t->n_fixtures; i++) {
                keep(t, &t->fixtures[i], NULL, argc, argv);
            }
        } else {
            keep(t, NULL, NULL, argc, argv);
        }
    }
}

/* ---- for cmocka ------------------------------------------------------------------------------ */

static void (*last_words)(const void *row);

void test_if_it_breaks(void (*tell)(const void *row))
{
    last_words = tell;
}

static int set_up(void **state)
{
    const trial *t = *state;
    last_words = NULL;
    return t->fixture != NULL && t->fixture->set_up != NULL ? t->fixture->set_up() : 0;
}

static void run(void **state)
{
    const trial *t = *state;
    if (t->row != NULL) {
        t->test->run_row(t->row);
    } else {
        t->test->run();
    }
    last_words = NULL;
}

static int tear_down(void **state)
{
    const trial *t = *state;
    if (last_words != NULL) {
        last_words(t->row);
    }
    return t->fixture != NULL && t->fixture->tear_down != NULL ? t->fixture->tear_down() : 0;
}

static int begin(void **state)
{
    (void)state;
    return test_i_around.set_up != NULL ? test_i_around.set_up() : 0;
}

static int end(void **state)
{
    (void)state;
    return test_i_around.tear_down != NULL ? test_i_around.tear_down() : 0;
}

static int run_all(const char *program)
{
    struct CMUnitTest *tests = calloc(n_trials, sizeof *tests);
    if (tests == NULL) {
        abort();
    }
    for (size_t i = 0; i < n_trials; i++) {
        tests[i] = (struct CMUnitTest){trials[i].name, run, set_up, tear_down, &trials[i]};
    }
    int failed = _cmocka_run_group_tests(program, tests, n_trials, begin, end);
    free(tests);
    return failed;
}

int test_main(int argc, char **argv)
{
    bool list = argc == 2 && strcmp(argv[1], "--list") == 0;
    const char *program = argc > 0 ? argv[0] : "tests";
    choose(list ? 1 : argc, argv);
    for (size_t i = 0; list && i < n_trials; i++) {
        puts(trials[i].name);
    }
    int result = 0;
    if (n_trials == 0) {
        fprintf(stderr, "%s: no test is called so; --list prints the names\n", program);
        result = 2;
    } else if (!list) {
        result = run_all(program);
    }
    free(trials);
    return result;
}
