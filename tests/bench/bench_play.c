/* SPDX-License-Identifier: MIT */
/* A minute of `grctl play` at 50 Hz on a pty: when frames arrive, against one grid of 20 ms. Ends
 * with 1 where they drift or scatter more than promised of an idle machine; on a busy one,
 * `chrt -f 50 make bench` measures the program instead of its neighbours. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/spy.h"

enum { PERIOD_US = 20000, SECOND = 50, LIMIT_S = 90 };

static const double drift_allowed_us = 1000, median_allowed_us = 100;

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double quantile(const double *values, size_t n, double part)
{
    static double sorted[SPY_FRAMES];
    memcpy(sorted, values, n * sizeof *sorted);
    qsort(sorted, n, sizeof *sorted, by_value);
    return sorted[(size_t)(part * (double)(n - 1))];
}

/* How far each frame is from its place in the grid that begins with the first; 0: the middle. */
static void deviations(const spy_frame *frames, size_t n, double *deviation_us)
{
    double middle;
    for (size_t i = 0; i < n; i++) {
        const double since_us = (double)(frames[i].at_us - frames[0].at_us);
        deviation_us[i] = since_us - PERIOD_US * round(since_us / PERIOD_US);
    }
    middle = quantile(deviation_us, n, 0.5);
    for (size_t i = 0; i < n; i++) {
        deviation_us[i] -= middle;
    }
}

int main(void)
{
    /* Five seconds made sixty. The posture of the torque comes first, then the motion. */
    const char *const arguments[] = {
        "-q", "--json", "play", "--rate=50", "--speed=8", "motions/greet.pseq", NULL};
    static double deviation_us[SPY_FRAMES], size_us[SPY_FRAMES];
    double drift_us, median_us;
    size_t n;
    spy s;
    int status = spy_open(&s, NULL) ? spy_run(&s, arguments, LIMIT_S) : -1;
    if (status != 0 || s.n_poses < 60 * SECOND) {
        fprintf(stderr, "bench_play: grctl ended with %d after %zu frames\n", status, s.n_poses);
        spy_close(&s);
        return 1;
    }
    n = s.n_poses - 1;
    deviations(s.poses + 1, n, deviation_us);
    for (size_t i = 0; i < n; i++) {
        size_us[i] = fabs(deviation_us[i]);
    }
    drift_us =
        quantile(deviation_us + n - SECOND, SECOND, 0.5) - quantile(deviation_us, SECOND, 0.5);
    median_us = quantile(size_us, n, 0.5);
    printf("%zu frames in %.2f s: drift %.0f us (promised below %.0f), off their places by %.0f us "
           "in the median (%.0f), %.0f us p99, %.0f us at most\n",
           n, (double)(s.poses[n].at_us - s.poses[1].at_us) / 1e6, drift_us, drift_allowed_us,
           median_us, median_allowed_us, quantile(size_us, n, 0.99), quantile(size_us, n, 1));
    printf("the command's own account: %s", strstr(s.out, "{\"done\""));
    spy_close(&s);
    return fabs(drift_us) < drift_allowed_us && median_us < median_allowed_us ? 0 : 1;
}
