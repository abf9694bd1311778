/* SPDX-License-Identifier: MIT */
/*
 * The simulator takes what comes in one piece whole. Beside a robot that takes each byte for
 * itself, because a fault of bytes is on that never strikes and somebody is to talk in an hour,
 * nobody sees a difference: the same things happen to the servos at the same times, and the same
 * bytes come at the same times, whatever the host writes and whenever it looks.
 */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/rs30x.h>
#include <grobo/core/sim.h>

#include "src/sim/servo/talk.h"
#include "tests/support/simkit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static simkit whole, bytewise;

static uint32_t chance;

static uint32_t draw(uint32_t below)
{
    chance = chance * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)chance * below) >> 32);
}

static uint8_t any_id(void)
{
    return draw(8) == 0 ? GROBO_RS30X_ID_ALL : (uint8_t)(1 + draw(21)); /* 21: nobody */
}

static int any_frame(const grobo_protocol *protocol, uint8_t *buf, size_t cap)
{
    grobo_rs30x_goal goals[20];
    const int n = 1 + (int)draw(20);
    const uint8_t value = (uint8_t)draw(3);
    for (int i = 0; i < n; i++) {
        goals[i] = (grobo_rs30x_goal){.id = (uint8_t)(i + 1),
                                      .pos_ddeg = (int16_t)((int)draw(600) - 300),
                                      .time_cs = (uint16_t)draw(100)};
    }
    switch (draw(5)) {
    case 0:
        return grobo_frame_goals(protocol, goals, (size_t)n, buf, cap);
    case 1:
        return grobo_frame_read(protocol, (uint8_t)(1 + draw(21)), (uint8_t)(30 + draw(12)),
                                (uint8_t)(1 + draw(18)), buf, cap);
    case 2:
        return grobo_frame_torque(protocol, any_id(), (grobo_torque)value, buf, cap);
    case 3: {
        int size = grobo_rs30x_write_u8(any_id(), 0, GROBO_RS30X_DELAY, value, buf, cap);
        return grobo_frame_wrap(protocol, buf, (size_t)size, buf, cap);
    }
    default:
        return grobo_frame_goal(protocol, goals, buf, cap);
    }
}

/* Rubbish before it, a byte wrong, its end missing; mostly nothing. */
static int spoil(uint8_t *buf, int n)
{
    switch (draw(16)) {
    case 0:
        buf[draw((uint32_t)n)] ^= (uint8_t)(1u << draw(8));
        return n;
    case 1:
        return 1 + (int)draw((uint32_t)n);
    case 2:
        memmove(buf + 2, buf, (size_t)n);
        buf[0] = 0x53;
        return n + 2;
    case 3: /* the board returns a part of the reply */
        buf[n - 1] = buf[0] == 0x54 ? (uint8_t)(1 + draw(buf[n - 1])) : buf[n - 1];
        return n;
    default:
        return n;
    }
}

static void write_both(const uint8_t *bytes, size_t n)
{
    assert_int_equal(grobo_sim_rx(&whole.sim, bytes, n, whole.now_us), n);
    assert_int_equal(grobo_sim_rx(&bytewise.sim, bytes, n, bytewise.now_us), n);
}

static void run_both(int64_t us)
{
    simkit_run(&whole, us);
    simkit_run(&bytewise, us);
}

static void assert_same(void)
{
    assert_int_equal(whole.n_events, bytewise.n_events);
    assert_true(whole.n_events <= SIMKIT_EVENTS);
    for (size_t i = 0; i < whole.n_events; i++) {
        const grobo_sim_event *a = &whole.events[i], *b = &bytewise.events[i];
        assert_int_equal(a->kind, b->kind);
        assert_int_equal(a->time_us, b->time_us);
        assert_int_equal(a->servo, b->servo);
        assert_int_equal(a->value, b->value);
        assert_int_equal(a->value2, b->value2);
        assert_int_equal(a->n_bytes, b->n_bytes);
    }
    assert_int_equal(whole.n_got, bytewise.n_got);
    assert_memory_equal(whole.got, bytewise.got, whole.n_got);
    assert_memory_equal(whole.got_us, bytewise.got_us, whole.n_got * sizeof *whole.got_us);
    assert_memory_equal(&whole.sim.stats, &bytewise.sim.stats, sizeof whole.sim.stats);
    for (int i = 0; i < whole.sim.n_servos; i++) {
        assert_memory_equal(whole.sim.servo[i].reg, bytewise.sim.servo[i].reg,
                            sizeof whole.sim.servo[i].reg);
    }
}

static void start_both(const grobo_sim_config *config)
{
    simkit_start(&whole, config);
    simkit_start(&bytewise, config);
    assert_int_equal(grobo_sim_set_fault(&bytewise.sim, GROBO_SIM_FAULT_FLIP, 3e-10), 0);
    assert_true(bytewise.sim.fault_below[GROBO_SIM_FAULT_FLIP] > 0);
    grobo_i_sim_talk(&bytewise.sim, (const uint8_t[]){0}, 1, INT64_C(3600000000000));
}

/* A host that writes frame after frame, in one go or in two, at once or after a pause. */
static void drive(const grobo_protocol *protocol, uint32_t seed)
{
    uint8_t buf[2 * GROBO_REPLY_MAX_BYTES];
    chance = seed;
    for (int i = 0; i < 12; i++) {
        int n = any_frame(protocol, buf, GROBO_REPLY_MAX_BYTES);
        assert_true(n > 0);
        size_t size = (size_t)spoil(buf, n);
        size_t first = draw(4) == 0 ? draw((uint32_t)size + 1) : size;
        write_both(buf, first);
        if (first < size) {
            run_both(draw(3) == 0 ? 30000 : (int64_t)draw(3000));
            write_both(buf + first, size - first);
        }
        run_both(draw(3) == 0 ? (int64_t)draw(2000) : 40000);
    }
    run_both(100000);
    assert_same();
}

TEST(nobody_sees_a_difference)
{
    static const grobo_sim_config configs[] = {
        {GROBO_SIM_CONFIG_INIT},
        {GROBO_SIM_CONFIG_INIT, .latency_us = 16000},
        {GROBO_SIM_CONFIG_INIT, .board_silence_us = 60},
        {GROBO_SIM_CONFIG_INIT, .board_silence_us = 250},
        {GROBO_SIM_CONFIG_INIT, .nack = true},
        {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS},
        {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS, .echo = true},
    };
    uint32_t replies = 0;
    for (size_t i = 0; i < sizeof configs / sizeof *configs; i++) {
        const grobo_protocol *protocol = configs[i].wiring == GROBO_WIRING_BUS
                                             ? &grobo_i_rs30x_protocol
                                             : &grobo_i_board_protocol;
        for (uint32_t seed = 0; seed < 60; seed++) {
            start_both(&configs[i]);
            if (seed % 8 == 0) { /* not the rate of the board: each byte arrives as another one */
                assert_int_equal(grobo_sim_set_line_bps(&whole.sim, 57600), 0);
                assert_int_equal(grobo_sim_set_line_bps(&bytewise.sim, 57600), 0);
            }
            drive(protocol, seed * 77 + 1);
            replies += whole.n_got > 0;
        }
    }
    assert_true(replies > 100);
}

/* A fault that begins in the middle of a frame has its bytes one by one from there on. */
TEST(a_fault_may_begin_within_a_frame)
{
    start_both(NULL);
    uint8_t buf[GROBO_REPLY_MAX_BYTES];
    int n = grobo_frame_read(&grobo_i_board_protocol, 3, 42, 2, buf, sizeof buf);
    write_both(buf, (size_t)n);
    run_both(500);
    assert_int_equal(grobo_sim_set_fault(&whole.sim, GROBO_SIM_FAULT_FLIP, 3e-10), 0);
    run_both(100000);
    assert_int_equal(whole.n_got, 10);
    assert_memory_equal(whole.got, bytewise.got, 10);
    assert_memory_equal(whole.got_us, bytewise.got_us, 10 * sizeof *whole.got_us);
}
