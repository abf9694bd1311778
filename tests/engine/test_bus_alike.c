/* SPDX-License-Identifier: MIT */
/* The same requests and replies on another clock: the same frames, the same ends. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

#include "tests/support/bus_peer.h"
#include "tests/support/next_random.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, FRAME = GROBO_FRAME_MAX_BYTES };

static const uint8_t ack = GROBO_RS30X_ACK;

/* Requests of all kinds, replies in time, late, broken or none, spans kept free. */
static void live(peer *p, uint32_t seed, int64_t origin_us)
{
    static request r[200];
    const grobo_bus_config config = {.protocol = seed % 2 ? &grobo_i_rs30x_protocol
                                                          : &grobo_i_board_protocol,
                                     .overlap = seed % 3 == 0,
                                     .hold_us = 20 * MS};
    peer_init(p, &config);
    p->now_us = origin_us;
    for (int i = 0; i < 60; i++) {
        uint8_t id = (uint8_t)(1 + next_random(&seed) % 4);
        grobo_priority priority = (grobo_priority)(next_random(&seed) % GROBO_PRIORITIES);
        uint32_t what = next_random(&seed) % 8;
        if (what < 5) {
            peer_read(p, &r[i], id, 2, priority);
            r[i].txn.retries = (uint8_t)(next_random(&seed) % 3);
            r[i].txn.patient = what == 0;
            r[i].txn.start_by_us = what == 1 ? p->now_us + 3 * MS : 0;
            (void)grobo_bus_submit(&p->bus, &r[i].txn);
            if (next_random(&seed) % 3 != 0) {
                int64_t at_us = p->now_us + 1500 + next_random(&seed) % 9000;
                peer_position_at(p, at_us, id, (int16_t)i);
            }
        } else if (what == 5) {
            peer_submit_ping(p, &r[i], id, 1);
            peer_bytes_at(p, p->now_us + 2 * MS + next_random(&seed) % 3000, &ack, 1);
        } else {
            peer_submit_goal(p, &r[i], id, priority);
        }
        if (next_random(&seed) % 4 == 0) {
            grobo_bus_reserve(&p->bus, p->now_us + next_random(&seed) % 20000, 5 * MS);
        }
        peer_run(p, p->now_us + next_random(&seed) % 12000);
    }
    peer_run(p, p->now_us + S);
}

TEST(the_bus_does_not_care_where_the_clock_begins)
{
    static const int64_t origins_us[] = {7777777, INT64_C(86400000000) * 365};
    static peer first, p;
    for (uint32_t seed = 0; seed < 60; seed++) {
        live(&first, seed, 1);
        for (int i = 0; i < 2; i++) {
            live(&p, seed, origins_us[i]);
            assert_int_equal(p.sent_count, first.sent_count);
            assert_int_equal(p.ended_count, first.ended_count);
            for (int k = 0; k < p.sent_count; k++) {
                assert_int_equal(p.sent[k].at_us - origins_us[i], first.sent[k].at_us - 1);
                assert_int_equal(p.sent[k].id, first.sent[k].id);
            }
            for (int k = 0; k < p.ended_count; k++) {
                assert_int_equal(p.ended[k].at_us - origins_us[i], first.ended[k].at_us - 1);
                assert_int_equal(p.ended[k].result, first.ended[k].result);
            }
            assert_memory_equal(&p.bus.stats, &first.bus.stats, sizeof p.bus.stats);
        }
    }
}
