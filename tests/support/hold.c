/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include "tests/support/hold.h"
#include "tests/support/test.h"

void hold_init(hold *h)
{
    h->wanted = h->held = false;
    assert_int_equal(grobo_mutex_init(&h->lock), GROBO_OK);
    assert_int_equal(grobo_cond_init(&h->changed), GROBO_OK);
}

void hold_deinit(hold *h)
{
    grobo_cond_deinit(&h->changed);
    grobo_mutex_deinit(&h->lock);
}

void hold_here(hold *h)
{
    grobo_mutex_lock(&h->lock);
    while (h->wanted) {
        h->held = true;
        grobo_cond_wake_all(&h->changed);
        grobo_cond_wait(&h->changed, &h->lock, GROBO_NEVER_US);
    }
    h->held = false;
    grobo_mutex_unlock(&h->lock);
}

void hold_begin(hold *h)
{
    int64_t end_us = grobo_now_us() + 10000000;

    grobo_mutex_lock(&h->lock);
    h->wanted = true;
    while (!h->held && grobo_now_us() < end_us) {
        grobo_cond_wait(&h->changed, &h->lock, end_us);
    }
    grobo_mutex_unlock(&h->lock);
    assert_true(h->held);
}

void hold_end(hold *h)
{
    grobo_mutex_lock(&h->lock);
    h->wanted = false;
    grobo_cond_wake_all(&h->changed);
    grobo_mutex_unlock(&h->lock);
}
