/* SPDX-License-Identifier: MIT */
#include <math.h>

#include <grobo/core/interpolate.h>

/* ---- order: a heap sort, as it needs no memory and never degrades ---- */

/* True if pose a comes after pose b. Never true both ways, so the order is the only one. */
static bool comes_after(const double *t_s, size_t a, size_t b)
{
    if (t_s[a] > t_s[b]) {
        return true;
    }
    return !(t_s[a] < t_s[b]) && a < b;
}

static void sift_down(const double *t_s, size_t *heap, size_t root, size_t n)
{
    size_t child;
    while ((child = 2 * root + 1) < n) {
        if (child + 1 < n && comes_after(t_s, heap[child + 1], heap[child])) {
            child++;
        }
        if (!comes_after(t_s, heap[child], heap[root])) {
            return;
        }
        size_t held = heap[root];
        heap[root] = heap[child];
        heap[child] = held;
        root = child;
    }
}

void grobo_spline_order(const double *t_s, size_t n, size_t *order)
{
    if (t_s == NULL || order == NULL) {
        return;
    }
    for (size_t i = 0; i < n; i++) {
        order[i] = i;
    }
    for (size_t i = n / 2; i-- > 0;) {
        sift_down(t_s, order, i, n);
    }
    for (size_t end = n; end-- > 1;) {
        size_t held = order[0];
        order[0] = order[end];
        order[end] = held;
        sift_down(t_s, order, 0, end);
    }
}

/* ---- building ---- */

int grobo_spline_append(grobo_spline_track *track, double t_s, double value,
                        double max_transition_s, bool stationary)
{
    if (track == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_spline_key *last = track->n > 0 ? &track->keys[track->n - 1] : NULL;

    if (!isfinite(t_s) || !isfinite(value) || !isfinite(max_transition_s)) {
        return GROBO_ERR_NAN;
    }
    if (last != NULL && t_s < last->t_s) {
        return GROBO_ERR_ARG;
    }
    bool hold = last != NULL && max_transition_s > 0.0 && t_s - last->t_s > max_transition_s;
    int added = hold ? 2 : 1;
    if (track->capacity - track->n < (size_t)added) {
        return GROBO_ERR_SPACE;
    }
    if (hold) {
        last->flags |= GROBO_SPLINE_STATIONARY;
        track->keys[track->n++] =
            (grobo_spline_key){.t_s = t_s - max_transition_s,
                               .value = last->value,
                               .flags = GROBO_SPLINE_STATIONARY | GROBO_SPLINE_HOLD};
    }
    track->keys[track->n++] = (grobo_spline_key){
        .t_s = t_s, .value = value, .flags = stationary ? GROBO_SPLINE_STATIONARY : 0u};
    return added;
}

static double inner_slope(const grobo_spline_key *key)
{
    double before = key[0].value - key[-1].value;
    double after = key[1].value - key[0].value;
    double before_s = key[0].t_s - key[-1].t_s;
    double after_s = key[1].t_s - key[0].t_s;

    if ((key->flags & GROBO_SPLINE_STATIONARY) != 0 || before * after <= 0.0 ||
        fabs(before) < GROBO_SPLINE_FLAT || fabs(after) < GROBO_SPLINE_FLAT) {
        return 0.0;
    }
    /* Across a jump there is no slope to speak of. */
    if (before_s < GROBO_SPLINE_JUMP_S || after_s < GROBO_SPLINE_JUMP_S) {
        return 0.0;
    }
    return (before / before_s + after / after_s) / 2.0;
}

void grobo_spline_prepare(grobo_spline_key *keys, size_t n)
{
    if (keys == NULL) {
        return;
    }
    for (size_t i = 0; i < n; i++) {
        keys[i].slope = i > 0 && i + 1 < n ? inner_slope(&keys[i]) : 0.0;
    }
}

/* ---- reading ---- */

double grobo_spline_cubic(const grobo_spline_key *a, const grobo_spline_key *b, double t_s)
{
    if (a == NULL || b == NULL) {
        return 0;
    }
    double length_s = b->t_s - a->t_s;
    if (length_s < GROBO_SPLINE_JUMP_S) {
        return b->value;
    }
    double s = (t_s - a->t_s) / length_s;
    double rise = b->value - a->value;
    double start = a->slope * length_s;
    double end = b->slope * length_s;
    /* Hermite's cubic by Horner's rule. */
    return a->value +
           s * (start + s * (3.0 * rise - 2.0 * start - end + s * (start + end - 2.0 * rise)));
}

/* Number of keys at or before t_s. */
static size_t count_until(const grobo_spline_key *keys, size_t n, double t_s)
{
    size_t low = 0;
    size_t high = n;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (keys[middle].t_s <= t_s) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* The same, near where the last search ended. */
static size_t count_from(const grobo_spline_key *keys, size_t n, double t_s, size_t hint)
{
    enum { STEPS_MAX = 4 };
    if (hint > n || (hint > 0 && keys[hint - 1].t_s > t_s)) {
        return count_until(keys, n, t_s);
    }
    for (int step = 0; step <= STEPS_MAX; step++) {
        if (hint == n || keys[hint].t_s > t_s) {
            return hint;
        }
        hint++;
    }
    return hint + count_until(keys + hint, n - hint, t_s);
}

double grobo_spline_at(const grobo_spline_key *keys, size_t n, double t_s, size_t *cursor)
{
    if (keys == NULL && n > 0) {
        return 0;
    }
    size_t i = cursor != NULL ? count_from(keys, n, t_s, *cursor) : count_until(keys, n, t_s);
    if (cursor != NULL) {
        *cursor = i;
    }
    if (n == 0) {
        return 0.0;
    }
    if (i == 0) {
        return keys[0].value;
    }
    if (i == n) {
        return keys[n - 1].value;
    }
    return grobo_spline_cubic(&keys[i - 1], &keys[i], t_s);
}
