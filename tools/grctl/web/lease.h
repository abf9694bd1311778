/* SPDX-License-Identifier: MIT */
/*
 * Who drives: one page at a time, as long as it beats. A table of times and names; what follows
 * from its loss is the caller's. Times are those of grobo_now_us().
 */
#ifndef GRCTL_WEB_LEASE_H
#define GRCTL_WEB_LEASE_H

#include <stdbool.h>
#include <stdint.h>

#include "tools/grctl/web/access.h"

enum { LEASE_NAME_BYTES = 128, LEASE_ID_BYTES = 8 + 1 };
/* Who was asked has this time to answer. */
#define LEASE_ASK_US INT64_C(10000000)

/* A page that drives, or asks to. */
typedef struct lease_page {
    char secret[ACCESS_SECRET_BYTES]; /* "": there is none */
    char id[LEASE_ID_BYTES];          /* of it, for everybody */
    char name[LEASE_NAME_BYTES];
    int64_t since_us;
} lease_page;

typedef struct lease {
    lease_page holder, asker;
    int64_t beat_us; /* of the holder's last sign of life */
} lease;

/*
 * The lease for a page of that name; `secret` of one that has asked, or "". Refused while another
 * holds it, unless who comes has asked and waited, or `at_once`.
 */
bool lease_take(lease *l, const char *name, const char *secret, bool at_once, int64_t now_us);
/* Asks the one who holds it. False: nobody does. */
bool lease_ask(lease *l, const char *name, int64_t now_us);
/* Gives it back, to who has asked. False: that is not the holder. */
bool lease_give(lease *l, const char *secret, int64_t now_us);
/* Refuses what was asked. False: that is not the holder. */
bool lease_deny(lease *l, const char *secret);
/* Takes it from whoever has it. */
void lease_end(lease *l);

bool lease_is_held(const lease *l);
bool lease_is_holder(const lease *l, const char *secret);
/* A sign of life. False: that is not the holder. */
bool lease_beat(lease *l, const char *secret, int64_t now_us);
/* How long the holder has been silent; 0 where there is none. */
int64_t lease_silent_us(const lease *l, int64_t now_us);

#endif
