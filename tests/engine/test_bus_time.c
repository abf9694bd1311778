/* SPDX-License-Identifier: MIT */
/* The bus and time: costs, deadlines, learnt margins, room for motion frames. */
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

#include "src/bus/time.h"
#include "tests/support/bus_peer.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, FRAME = GROBO_FRAME_MAX_BYTES, JOINTS = 20 };

static void make_pose(peer *p, request *r)
{
    grobo_rs30x_goal goals[JOINTS];
    for (int i = 0; i < JOINTS; i++) {
        goals[i] = (grobo_rs30x_goal){(uint8_t)(i + 1), 0, 2};
    }
    int n = grobo_frame_goals(p->bus.config.protocol, goals, JOINTS, r->frame, FRAME);
    peer_txn(p, &r->txn, r->frame, n, GROBO_PRIORITY_MOTION);
}

/* 11 + 8 + 26 + 26 bytes and 100 us, as the wire's description reckons: about 6.3 ms. */
TEST(a_full_read_through_the_board_costs_71_bytes)
{
    peer p;
    request r;
    grobo_bus_cost cost;
    peer_init(&p, NULL);
    peer_read(&p, &r, 1, 18, GROBO_PRIORITY_SENSE);
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.request_us, 955);
    assert_int_equal(cost.servo_us, 695 + 100 + 2257);
    assert_int_equal(cost.reply_us, 2257);
    assert_int_equal(cost.total_us, 6264);
    assert_int_equal(cost.timeout_us, 6264 + GROBO_BUS_MARGIN_FIRST_US);
    r.txn.timeout_us = 50 * MS;
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.timeout_us, 50 * MS);
}

TEST(other_costs_follow_the_same_rule)
{
    peer p;
    request r;
    grobo_bus_cost cost;
    peer_init(&p, NULL);
    make_pose(&p, &r);
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.request_us, 9549);
    assert_int_equal(cost.servo_us, 9375);
    assert_int_equal(cost.reply_us, 0);
    int n = grobo_board_check(r.frame, FRAME);
    peer_txn(&p, &r.txn, r.frame, n, GROBO_PRIORITY_USER);
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.total_us, 174 + 87); /* nothing goes to the servos */
    n = grobo_board_slot(1, r.frame, FRAME);
    peer_txn(&p, &r.txn, r.frame, n, GROBO_PRIORITY_USER);
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.total_us, 261);

    const grobo_bus_config fast = {
        .protocol = &grobo_i_rs30x_protocol, .baud_bps = 460800, .return_delay_us = 1000};
    peer_init(&p, &fast);
    peer_read(&p, &r, 1, 18, GROBO_PRIORITY_SENSE);
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.request_us, 174);
    assert_int_equal(cost.servo_us, 0);
    assert_int_equal(cost.reply_us, 1000 + 565);

    /* Rounded up: 110 bits take 110 us, or 2 us where 1 us is a little too short. */
    static const uint32_t rates_bps[] = {1000000, 109999999};
    for (int i = 0; i < 2; i++) {
        const grobo_bus_config round = {.baud_bps = rates_bps[i]};
        peer_init(&p, &round);
        peer_read(&p, &r, 1, 2, GROBO_PRIORITY_SENSE);
        grobo_bus_cost_of(&p.bus, &r.txn, &cost);
        assert_int_equal(cost.request_us, i == 0 ? 110 : 2);
    }

    const grobo_bus_config mixed = {.baud_bps = 460800, .servo_baud_bps = 9600};
    peer_init(&p, &mixed);
    peer_read(&p, &r, 1, 2, GROBO_PRIORITY_SENSE);
    grobo_bus_cost_of(&p.bus, &r.txn, &cost);
    assert_int_equal(cost.request_us, 239);
    assert_int_equal(cost.servo_us, 8334 + 100 + 10417);
    assert_int_equal(cost.reply_us, 218);
}

TEST(a_write_keeps_the_line_until_the_servos_have_it)
{
    peer p;
    request a, b;
    peer_init(&p, NULL);
    make_pose(&p, &a);
    make_pose(&p, &b);
    assert_int_equal(grobo_bus_submit(&p.bus, &a.txn), GROBO_OK);
    assert_int_equal(grobo_bus_submit(&p.bus, &b.txn), GROBO_OK);
    peer_run(&p, 1);
    assert_int_equal(grobo_bus_free_at(&p.bus, p.now_us), 18924);
    peer_run(&p, S);
    assert_int_equal(p.sent[1].at_us, 18924);
    assert_int_equal(p.ended[0].at_us, 18924);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(grobo_bus_free_at(&p.bus, p.now_us), p.now_us);
}

/* A board known to take the next frame while it forwards: the servo bus is the bottleneck. */
TEST(an_overlapping_board_takes_the_next_frame_earlier)
{
    peer p;
    request a, b;
    const grobo_bus_config config = {.overlap = true};
    peer_init(&p, &config);
    make_pose(&p, &a);
    peer_read(&p, &b, 1, 18, GROBO_PRIORITY_SENSE);
    assert_int_equal(grobo_bus_submit(&p.bus, &a.txn), GROBO_OK);
    assert_int_equal(grobo_bus_submit(&p.bus, &b.txn), GROBO_OK);
    peer_run(&p, 9549);
    assert_int_equal(p.sent_count, 2);
    assert_int_equal(p.sent[1].at_us, 9549);
    assert_int_equal(p.ended[0].at_us, 9549);
    assert_int_equal(p.bus.over_us, 18924 + 695 + 100 + 2257 + 2257);
}

TEST(deadlines_say_when_to_come_back)
{
    peer p;
    request r;
    uint8_t buf[FRAME];
    const grobo_bus_config config = {.margin_us = 4 * MS};
    peer_init(&p, &config);
    assert_int_equal(grobo_bus_deadline(&p.bus, 0), GROBO_NEVER_US);
    peer_read(&p, &r, 1, 18, GROBO_PRIORITY_SENSE);
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    assert_int_equal(grobo_bus_deadline(&p.bus, 5 * MS), 5 * MS);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, FRAME, 5 * MS), 11);
    assert_int_equal(grobo_bus_deadline(&p.bus, 5 * MS), 5 * MS + 6264 + 4 * MS);
    grobo_bus_step(&p.bus, 5 * MS + 6264 + 4 * MS - 1);
    assert_int_equal(p.bus.stats.timeouts, 0);
    grobo_bus_step(&p.bus, 5 * MS + 6264 + 4 * MS);
    assert_int_equal(p.bus.stats.timeouts, 1);
    assert_int_equal(grobo_bus_deadline(&p.bus, 15264), 15264 + GROBO_BUS_QUIET_US);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, FRAME, 15264), 0);
    r.txn.timeout_us = 7 * MS;
    assert_int_equal(grobo_bus_tx(&p.bus, buf, FRAME, 20 * MS), 11);
    assert_int_equal(grobo_bus_deadline(&p.bus, 20 * MS), 27 * MS);
}

/* A process that slept past the deadline finds the reply in its buffer: it is taken, not lost. */
TEST(a_late_pump_still_takes_what_came_in_time)
{
    peer p;
    request r;
    uint8_t buf[FRAME];
    peer_init(&p, NULL);
    peer_read(&p, &r, 1, 2, GROBO_PRIORITY_SENSE);
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    assert_int_equal(grobo_bus_tx(&p.bus, buf, FRAME, 0), 11);
    peer_position_at(&p, 0, 1, 42);
    p.now_us = S;
    peer_run(&p, S);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.bus.stats.timeouts, 0);
}

static uint32_t timeout_after(peer *p, int replies, int64_t reply_after_us)
{
    request r;
    grobo_bus_cost cost;
    p->reply_after_us = reply_after_us;
    for (int i = 0; i < replies; i++) {
        p->ended_count = 0;
        p->sent_count = 0;
        peer_read(p, &r, 1, 2, GROBO_PRIORITY_SENSE);
        assert_int_equal(grobo_bus_submit(&p->bus, &r.txn), GROBO_OK);
        peer_run(p, p->now_us + S);
        assert_int_equal(p->ended[0].result, GROBO_OK);
    }
    peer_read(p, &r, 1, 2, GROBO_PRIORITY_SENSE);
    grobo_bus_cost_of(&p->bus, &r.txn, &cost);
    return cost.timeout_us - cost.total_us;
}

/* From the adapter nobody knows to the one that is there: a few ms, and back when it slows down. */
TEST(the_margin_is_learnt_from_the_replies)
{
    peer p;
    peer_init(&p, NULL);
    p.obliging = true;
    assert_int_equal(timeout_after(&p, 0, 0), GROBO_BUS_MARGIN_FIRST_US);
    assert_int_equal(timeout_after(&p, 1, 200), GROBO_BUS_MARGIN_MIN_US);
    assert_int_equal(timeout_after(&p, 50, 200), GROBO_BUS_MARGIN_MIN_US);
    for (int64_t slow_us = 400; slow_us <= 16 * MS; slow_us += 400) {
        uint32_t margin_us = timeout_after(&p, 10, slow_us);
        assert_true(margin_us >= slow_us);
    }
    assert_true(timeout_after(&p, 1, 16 * MS) <= GROBO_BUS_MARGIN_MAX_US);
    assert_int_equal(timeout_after(&p, 100, 200), GROBO_BUS_MARGIN_MIN_US);
}

/* The mean with an eighth of what is new, its deviation with a quarter, the worst slowly
 * forgotten; by hand. */
TEST(what_is_learnt_of_each_reply)
{
    static const struct {
        int late_us, overhead_us, deviation_us, worst_us;
    } rows[] = {{2000, 2000, 1000, 2000},     {400, 1800, 1150, 1994},  {5000, 2200, 1662, 5000},
                {-300, 1925, 1796, 4981},     {1925, 1925, 1347, 4970}, {50000, 6684, 10529, 40000},
                {40000, 10848, 16225, 40000}, {0, 9492, 14881, 39844}};
    peer p;
    grobo_txn txn = {.attempts_ = 1};
    peer_init(&p, NULL);
    p.bus.active = &txn;
    p.bus.worst_us = 1000;
    p.bus.over_us = S;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        p.bus.now_us = p.bus.over_us + rows[i].late_us;
        grobo_i_bus_learn(&p.bus);
        assert_int_equal(p.bus.overhead_us, rows[i].overhead_us);
        assert_int_equal(p.bus.deviation_us, rows[i].deviation_us);
        assert_int_equal(p.bus.worst_us, rows[i].worst_us);
    }
    p.bus.active = NULL;
}

/* What comes late counts as that, up to half of what is waited for it; the next one is due then. */
TEST(a_late_reply_is_the_worst_up_to_half_of_the_hold)
{
    static const struct {
        int64_t late_us;
        int32_t worst_us;
    } rows[] = {{0, 1000},      {999, 1000},    {1001, 1001},   {29999, 29999},
                {30000, 30000}, {30001, 30000}, {60000, 30000}, {INT32_MAX, 30000}};
    const grobo_bus_config config = {.hold_us = 60000};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        peer p;
        peer_init(&p, &config);
        grobo_bus_hold *hold = &p.bus.hold[2];
        *hold = (grobo_bus_hold){.key = 5, .owed = 2, .due_us = S};
        p.bus.worst_us = 1000;
        p.bus.over_us = 77;
        p.bus.now_us = S + rows[i].late_us;
        assert_false(grobo_i_bus_settle(&p.bus, 6));
        assert_true(grobo_i_bus_settle(&p.bus, 5));
        assert_int_equal(p.bus.worst_us, rows[i].worst_us);
        assert_int_equal(hold->owed, 1);
        assert_int_equal(hold->due_us, 77);
    }
}

static size_t forwarded;

static size_t forward_some(const uint8_t *frame, size_t n)
{
    (void)frame;
    (void)n;
    return forwarded;
}

/* On the servos' bus is what the board forwards, be it a single byte. */
TEST(what_a_board_forwards_takes_its_time)
{
    grobo_relay relay = *grobo_i_board_protocol.relay;
    grobo_protocol protocol = grobo_i_board_protocol;
    static const uint32_t bytes_us[] = {0, 87, 174, 261}; /* rounded up */
    protocol.relay = &relay;
    relay.forwarded = forward_some;
    for (forwarded = 0; forwarded < 4; forwarded++) {
        const grobo_bus_config config = {.protocol = &protocol};
        peer p;
        request r;
        grobo_bus_cost cost;
        peer_init(&p, &config);
        peer_read(&p, &r, 1, 18, GROBO_PRIORITY_SENSE);
        grobo_bus_cost_of(&p.bus, &r.txn, &cost);
        uint32_t be_us = forwarded == 0 ? 0 : bytes_us[forwarded] + 100 + 2257;
        assert_int_equal(cost.servo_us, be_us);
        assert_int_equal(cost.total_us, 955 + 2257 + be_us);
    }
}

TEST(the_margin_doubles_with_every_retry)
{
    peer p;
    request r;
    peer_init(&p, NULL);
    p.obliging = true;
    timeout_after(&p, 1, 0);
    p.obliging = false;
    int64_t from_us = p.now_us;
    peer_read(&p, &r, 1, 2, GROBO_PRIORITY_SENSE);
    r.txn.retries = 5;
    p.ended_count = p.sent_count = 0;
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    peer_run(&p, from_us + S);
    static const int margins_ms[] = {3, 6, 12, 24, 40};
    for (int i = 0; i < 5; i++) {
        int64_t took_us = p.sent[i + 1].at_us - p.sent[i].at_us;
        assert_int_equal(took_us, 3488 + margins_ms[i] * MS + GROBO_BUS_QUIET_US);
    }
    assert_int_equal(p.ended[0].at_us, p.sent[5].at_us + 3488 + 40 * MS);
}

/* A patient read of servo 1 on a line on which replies come at once. @return the time at which it
 * is submitted */
static int64_t ask_patiently(peer *p, const grobo_bus_config *config, request *r)
{
    peer_init(p, config);
    p->obliging = true;
    timeout_after(p, 1, 0);
    p->obliging = false;
    p->ended_count = p->sent_count = 0;
    peer_read(p, r, 1, 2, GROBO_PRIORITY_SENSE);
    r->txn.patient = true;
    return p->now_us;
}

/* Three attempts are over after 3 x 3488 + 3000 + 6000 + 12000 and twice the quiet, 33 ms. */
TEST(a_patient_read_outlasts_a_stall_at_the_other_end)
{
    peer p;
    request r;
    int64_t from_us = ask_patiently(&p, NULL, &r);
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    peer_position_at(&p, from_us + 55 * MS, 1, 42);
    peer_run(&p, from_us + S);
    assert_int_equal(p.sent_count, 3);
    assert_int_equal(p.ended[0].result, GROBO_OK);
    assert_int_equal(p.ended[0].value, 42);
    assert_int_equal(p.ended[0].at_us, from_us + 55 * MS);
}

static int64_t given_up_after(const grobo_bus_config *config, grobo_priority priority,
                              uint32_t timeout_us)
{
    peer p;
    request r;
    int64_t from_us = ask_patiently(&p, config, &r);
    r.txn.priority = priority;
    r.txn.timeout_us = timeout_us;
    assert_int_equal(grobo_bus_submit(&p.bus, &r.txn), GROBO_OK);
    peer_run(&p, from_us + S);
    assert_int_equal(p.ended[0].result, GROBO_ERR_TIMEOUT);
    return p.ended[0].at_us - from_us;
}

/* One of a motion or a stop is not, others of its kind would wait behind it. */
TEST(patience_has_its_limits)
{
    const grobo_bus_config fixed = {.margin_us = 4 * MS};
    const int64_t wire_us = 3 * 3488 + 2 * GROBO_BUS_QUIET_US;
    const int64_t patient_us = wire_us + (3 + 6 + 40) * MS;
    const int64_t usual_us = wire_us + (3 + 6 + 12) * MS;
    assert_int_equal(given_up_after(NULL, GROBO_PRIORITY_SENSE, 0), patient_us);
    assert_int_equal(given_up_after(NULL, GROBO_PRIORITY_USER, 0), patient_us);
    assert_int_equal(given_up_after(NULL, GROBO_PRIORITY_MOTION, 0), usual_us);
    assert_int_equal(given_up_after(NULL, GROBO_PRIORITY_STOP, 0), usual_us);
    assert_int_equal(given_up_after(&fixed, GROBO_PRIORITY_USER, 0), wire_us + 3 * 4 * MS);
    assert_int_equal(given_up_after(NULL, GROBO_PRIORITY_USER, 7 * MS),
                     3 * 7 * MS + 2 * GROBO_BUS_QUIET_US);
}

/* Whenever one is due while it waits: announced or not through the board, announced on a servo bus,
 * where after a failure everything keeps quiet. */
TEST(a_patient_read_delays_no_motion_frame)
{
    static const grobo_bus_config on_bus = {.protocol = &grobo_i_rs30x_protocol};
    for (int i = 0; i < 108; i++) {
        bool bus = i % 3 == 0;
        bool announced = i % 3 != 1;
        int64_t after_us = (bus ? 30 : 22) * MS + i * MS / 3;
        peer p;
        request read, pose;
        int64_t due_us = ask_patiently(&p, bus ? &on_bus : NULL, &read) + after_us;
        make_pose(&p, &pose);
        if (announced) {
            grobo_bus_reserve(&p.bus, due_us, 18924);
        }
        assert_int_equal(grobo_bus_submit(&p.bus, &read.txn), GROBO_OK);
        peer_run(&p, due_us - 1);
        assert_in_range(grobo_bus_pending(&p.bus), announced ? 0 : 1, bus ? 0 : 1);
        p.now_us = due_us;
        assert_int_equal(grobo_bus_submit(&p.bus, &pose.txn), GROBO_OK);
        peer_run(&p, due_us);
        assert_int_equal(pose.txn.sent_us, due_us);
    }
}

TEST(no_read_starts_that_would_reach_into_the_reserved_span)
{
    peer p;
    request r[3];
    peer_init(&p, NULL);
    p.obliging = true;
    for (int i = 0; i < 3; i++) {
        peer_read(&p, &r[i], (uint8_t)(i + 1), 2, GROBO_PRIORITY_SENSE);
        assert_int_equal(grobo_bus_submit(&p.bus, &r[i].txn), GROBO_OK);
    }
    grobo_bus_reserve(&p.bus, 7 * MS, 2 * MS);
    assert_true(grobo_bus_fits(&p.bus, 7 * MS - 3488, &r[0].txn));
    assert_false(grobo_bus_fits(&p.bus, 7 * MS - 3487, &r[0].txn));
    assert_false(grobo_bus_fits(&p.bus, 9 * MS - 1, &r[0].txn));
    assert_true(grobo_bus_fits(&p.bus, 9 * MS, &r[0].txn));
    peer_run(&p, S);
    assert_int_equal(p.sent[0].at_us, 0);
    assert_int_equal(p.sent[1].at_us, 3488);
    assert_int_equal(p.sent[2].at_us, 9 * MS);
    grobo_bus_reserve(&p.bus, S + MS, S);
    peer_read(&p, &r[0], 1, 2, GROBO_PRIORITY_SENSE);
    assert_int_equal(grobo_bus_submit(&p.bus, &r[0].txn), GROBO_OK);
    peer_run(&p, S + 2 * MS);
    assert_int_equal(p.sent_count, 3);
    grobo_bus_reserve(&p.bus, GROBO_NEVER_US, 0); /* taken away again */
    peer_run(&p, S + 3 * MS);
    assert_int_equal(p.sent_count, 4);
}

/* What nothing answers takes its wire time, however late replies are. */
TEST(lateness_of_replies_delays_no_frame_without_one)
{
    peer p;
    request goal, read;
    peer_init(&p, NULL);
    peer_read(&p, &read, 1, 2, GROBO_PRIORITY_USER);
    const grobo_rs30x_goal to = {1, 0, 0};
    int n = grobo_frame_goal(p.bus.config.protocol, &to, goal.frame, sizeof goal.frame);
    peer_txn(&p, &goal.txn, goal.frame, n, GROBO_PRIORITY_USER);
    grobo_bus_cost of_goal, of_read;
    grobo_bus_cost_of(&p.bus, &goal.txn, &of_goal);
    grobo_bus_cost_of(&p.bus, &read.txn, &of_read);
    p.bus.overhead_us = 700;
    grobo_bus_reserve(&p.bus, 20 * MS, MS);
    assert_true(grobo_bus_fits(&p.bus, 20 * MS - of_goal.total_us, &goal.txn));
    assert_false(grobo_bus_fits(&p.bus, 20 * MS - of_goal.total_us + 1, &goal.txn));
    assert_true(grobo_bus_fits(&p.bus, 20 * MS - of_read.total_us - 700, &read.txn));
    assert_false(grobo_bus_fits(&p.bus, 20 * MS - of_read.total_us - 699, &read.txn));
}

TEST(a_short_request_goes_where_a_long_one_does_not_fit)
{
    peer p;
    request longer, shorter;
    peer_init(&p, NULL);
    p.obliging = true;
    peer_read(&p, &longer, 1, 18, GROBO_PRIORITY_SENSE);
    longer.txn.priority = GROBO_PRIORITY_USER;
    peer_read(&p, &shorter, 2, 2, GROBO_PRIORITY_SENSE);
    grobo_bus_reserve(&p.bus, 5 * MS, MS);
    assert_int_equal(grobo_bus_submit(&p.bus, &longer.txn), GROBO_OK);
    assert_int_equal(grobo_bus_submit(&p.bus, &shorter.txn), GROBO_OK);
    peer_run(&p, 10 * MS);
    assert_int_equal(p.sent[0].id, 2);
    assert_int_equal(p.sent[1].id, 1);
    assert_int_equal(p.sent[1].at_us, 6 * MS);
}

typedef struct played {
    int reads;
    int64_t worst_us; /* lateness of a motion frame */
} played;

/* Motion frames of 20 joints at a period, reads of one joint after the other in between. */
static played play(peer *p, int64_t period_us, int frames, uint8_t silent_id)
{
    played result = {0, 0};
    request pose, reads[JOINTS];
    p->obliging = true;
    p->silent_id = silent_id;
    for (uint8_t i = 0; i < JOINTS; i++) {
        peer_read(p, &reads[i], (uint8_t)(i + 1), 2, GROBO_PRIORITY_SENSE);
        reads[i].txn.retries = 0;
        assert_int_equal(grobo_bus_submit(&p->bus, &reads[i].txn), GROBO_OK);
    }
    for (int k = 0; k < frames; k++) {
        int64_t at_us = (int64_t)k * period_us;
        p->sent_count = p->ended_count = 0;
        make_pose(p, &pose);
        assert_int_equal(grobo_bus_submit(&p->bus, &pose.txn), GROBO_OK);
        grobo_bus_reserve(&p->bus, at_us + period_us, 18924);
        peer_run(p, at_us + period_us - 1);
        int64_t late_us = pose.txn.sent_us - at_us;
        result.worst_us = late_us > result.worst_us ? late_us : result.worst_us;
        for (int i = 0; i < p->ended_count; i++) {
            if (p->ended[i].txn != &pose.txn) {
                result.reads++;
                assert_int_equal(grobo_bus_submit(&p->bus, p->ended[i].txn), GROBO_OK);
            }
        }
        p->now_us = at_us + period_us;
    }
    grobo_bus_cancel_all(&p->bus, GROBO_PRIORITY_ALL, GROBO_ERR_CANCELED);
    return result;
}

/* 50 ms less 18.924 for the pose leaves 31.076: eight reads of 3.488 ms, and all are made. */
TEST(the_gaps_are_filled_and_the_frames_are_on_time)
{
    peer p;
    peer_init(&p, NULL);
    played all = play(&p, 50 * MS, 200, 0);
    assert_int_equal(all.worst_us, 0);
    assert_int_equal(all.reads, 200 * 8);
    assert_int_equal(p.bus.stats.timeouts, 0);
}

/* With one servo silent a frame may wait for the reply that might come, not for its time-out. */
TEST(a_silent_servo_does_not_delay_the_frames)
{
    peer p;
    peer_init(&p, NULL);
    played all = play(&p, 50 * MS, 200, 7);
    assert_int_equal(all.worst_us, 0);
    assert_true(p.bus.stats.timeouts > 50);
    assert_true(all.reads > 200 * 7);
}

TEST(the_bus_is_small)
{
    assert_true(sizeof(grobo_bus) - GROBO_FRAME_MAX_BYTES <= 560);
    assert_true(sizeof(grobo_txn) <= 96);
}
