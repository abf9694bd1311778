/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/web/lease.h"

static void make_page(lease_page *page, const char *name, int64_t now_us)
{
    char id[ACCESS_SECRET_BYTES];
    memset(page, 0, sizeof *page);
    access_make_secret(page->secret);
    access_make_secret(id); /* its own: it tells nothing of the secret */
    memcpy(page->id, id, sizeof page->id - 1);
    snprintf(page->name, sizeof page->name, "%s", name);
    page->since_us = now_us;
}

bool lease_is_held(const lease *l)
{
    return *l->holder.secret != '\0';
}

bool lease_is_holder(const lease *l, const char *secret)
{
    return lease_is_held(l) && secret && access_equal(secret, l->holder.secret);
}

static bool has_waited(const lease *l, const char *secret, int64_t now_us)
{
    return *l->asker.secret && secret && access_equal(secret, l->asker.secret) &&
           now_us - l->asker.since_us >= LEASE_ASK_US;
}

bool lease_take(lease *l, const char *name, const char *secret, bool at_once, int64_t now_us)
{
    if (lease_is_held(l) && !at_once && !lease_is_holder(l, secret) &&
        !has_waited(l, secret, now_us)) {
        return false;
    }
    lease_end(l);
    make_page(&l->holder, name, now_us);
    l->beat_us = now_us;
    return true;
}

bool lease_ask(lease *l, const char *name, int64_t now_us)
{
    if (!lease_is_held(l)) {
        return false;
    }
    make_page(&l->asker, name, now_us);
    return true;
}

bool lease_give(lease *l, const char *secret, int64_t now_us)
{
    if (!lease_is_holder(l, secret)) {
        return false;
    }
    l->holder = l->asker;
    memset(&l->asker, 0, sizeof l->asker);
    l->holder.since_us = l->beat_us = now_us;
    return true;
}

bool lease_deny(lease *l, const char *secret)
{
    if (!lease_is_holder(l, secret)) {
        return false;
    }
    memset(&l->asker, 0, sizeof l->asker);
    return true;
}

void lease_end(lease *l)
{
    memset(l, 0, sizeof *l);
}

bool lease_beat(lease *l, const char *secret, int64_t now_us)
{
    if (!lease_is_holder(l, secret)) {
        return false;
    }
    l->beat_us = now_us;
    return true;
}

int64_t lease_silent_us(const lease *l, int64_t now_us)
{
    return lease_is_held(l) ? now_us - l->beat_us : 0;
}
