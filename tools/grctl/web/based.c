/* SPDX-License-Identifier: MIT */
/* Refuses requests that are based on a situation that is past. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tools/grctl/web/based.h"

void based_tell(based *b, int64_t now_us)
{
    b->sequence++;
    b->told_us[b->sequence % BASED_KEPT] = now_us;
}

void based_change(based *b, int64_t now_us, const char *format, ...)
{
    va_list values;
    based_tell(b, now_us);
    b->changed = b->sequence;
    va_start(values, format);
    vsnprintf(b->what, sizeof b->what, format, values);
    va_end(values);
}

bool based_is_fresh(const based *b, const json_t *sequence, int64_t now_us)
{
    json_int_t n = json_integer_value(sequence);
    if (!json_is_integer(sequence) || n <= 0 || (uint64_t)n > b->sequence ||
        b->sequence - (uint64_t)n >= BASED_KEPT) {
        return false;
    }
    return now_us - b->told_us[n % BASED_KEPT] <= BASED_STALE_US;
}

bool based_check(const based *b, const json_t *sequence, int64_t now_us, const char *doing,
                 char complaint[BASED_COMPLAINT_BYTES])
{
    json_int_t n = json_integer_value(sequence);
    if (json_is_integer(sequence) && n > 0 && (uint64_t)n < b->changed) {
        snprintf(complaint, BASED_COMPLAINT_BYTES,
                 "%s: based on state %lld, but since then: %s; look at the present state first",
                 doing, (long long)n, b->what);
        return false;
    }
    if (!based_is_fresh(b, sequence, now_us)) {
        snprintf(complaint, BASED_COMPLAINT_BYTES,
                 "%s: sequence is not that of a state told less than a second ago; look at the "
                 "present state first",
                 doing);
        return false;
    }
    return true;
}
