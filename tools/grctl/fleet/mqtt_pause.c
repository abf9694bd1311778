/* SPDX-License-Identifier: MIT */
/* How long a connection that was lost pauses before the next attempt. */
#include <event2/util.h>

#include "tools/grctl/fleet/direct.h"

int pause_next_ms(int *pause_ms)
{
    unsigned char chance;
    evutil_secure_rng_get_bytes(&chance, sizeof chance);
    int now_ms = *pause_ms + *pause_ms * chance / 512;
    *pause_ms = 2 * *pause_ms < PAUSE_LONGEST_MS ? 2 * *pause_ms : PAUSE_LONGEST_MS;
    return now_ms;
}
