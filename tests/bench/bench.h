/* SPDX-License-Identifier: MIT */
/*
 * What programs of tests/bench print: one row a figure, its columns parted by tabs. run.sh puts
 * those of one measure side by side: ours, the floor, the peers.
 */
#ifndef GROBO_TESTS_BENCH_H
#define GROBO_TESTS_BENCH_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* `who` is "grobo" for us; the floor of a measure has a name that begins with "floor ". */
static inline void bench_row(const char *scenario, const char *measure, const char *who,
                             double value)
{
    printf("%s\t%s\t%s\t%.6g\n", scenario, measure, who, value);
    (void)fflush(stdout);
}

/* A number of the command line; ends the program where it is none. */
static inline long bench_number(const char *text)
{
    char *end;
    long number = strtol(text, &end, 10);

    if (*text == '\0' || *end != '\0' || number < 0) {
        fprintf(stderr, "bench: '%s' is not a number\n", text);
        exit(2);
    }
    return number;
}

/* Processor time of this process. */
static inline double bench_cpu_us(void)
{
    struct timespec now = {0};

    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e6 + (double)now.tv_nsec / 1e3;
}

#endif
