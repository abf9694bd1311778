/* SPDX-License-Identifier: MIT */
/* Frames under way: which slots are taken, what the bus is told, and what is taken back. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "tests/support/axes_kit.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

enum { SLOTS = GROBO_ROBOT_SLOTS };

/* A frame of this kind waits for the line, in the slot of that index. */
static grobo_robot_slot *submit(int at, grobo_i_use use, grobo_robot_order order)
{
    grobo_robot_slot *slot = grobo_i_slot_take(&robot, use);
    assert_ptr_equal(slot, &robot.slots[at]);
    slot->order = order;
    assert_int_equal(driver.sense(&driver, NULL, 0, GROBO_SENSE_ALL, &robot.built), 0);
    assert_int_equal(grobo_i_slot_send(slot, &robot.built, GROBO_PRIORITY_USER), GROBO_OK);
    return slot;
}

/* What lies behind the slots looks like a slot of no robot that must not be taken for one: who
 * looks at it crashes. */
static void put_behind_the_slots(const grobo_robot_slot *image)
{
    grobo_robot_slot ghost = *image;
    assert_true(sizeof robot.events >= sizeof ghost);
    assert_int_equal(offsetof(grobo_robot, events),
                     offsetof(grobo_robot, slots) + sizeof robot.slots);
    ghost.robot = NULL;
    robot.events_n = 0;
    memcpy(robot.events, &ghost, sizeof ghost);
}

/* Of the first 32; all others are free. */
static void expect_used(uint32_t be)
{
    for (int i = 0; i < SLOTS; i++) {
        assert_int_equal(robot.slots[i].use != GROBO_I_USE_FREE, i < 32 && (be >> i & 1) != 0);
    }
}

/* ---- taking ---------------------------------------------------------------------------------- */

TEST_WITH(rig_wirings, three_slots_are_kept_for_halts)
{
    start();
    robot.acting = 9;
    for (int i = 0; i < SLOTS; i++) {
        grobo_i_use use = i < SLOTS - 3 ? GROBO_I_USE_PLAIN : GROBO_I_USE_HALT;
        assert_int_equal(grobo_i_slot_find(&robot, GROBO_I_USE_HALT), i);
        assert_int_equal(grobo_i_slot_find(&robot, GROBO_I_USE_PLAIN), i < SLOTS - 3 ? i : -1);
        grobo_robot_slot *slot = grobo_i_slot_take(&robot, use);
        assert_ptr_equal(slot, &robot.slots[i]);
        assert_ptr_equal(slot->robot, &robot);
        assert_int_equal(slot->use, use);
        assert_int_equal(slot->job, use == GROBO_I_USE_HALT ? 0 : 9); /* it outlives its job */
        assert_true(slot->due_us == GROBO_NEVER_US);
    }
    put_behind_the_slots(&(grobo_robot_slot){.use = GROBO_I_USE_FREE});
    assert_int_equal(grobo_i_slot_find(&robot, GROBO_I_USE_HALT), -1);
    assert_null(grobo_i_slot_take(&robot, GROBO_I_USE_HALT));
    assert_null(grobo_i_slot_take(&robot, GROBO_I_USE_JOB));
    grobo_i_slot_drop(&robot.slots[4]); /* one that a halt may take, no other */
    assert_int_equal(grobo_i_slot_find(&robot, GROBO_I_USE_HALT), 4);
    assert_int_equal(grobo_i_slot_find(&robot, GROBO_I_USE_PLAIN), 4); /* three halts have theirs */
    grobo_i_slot_drop(&robot.slots[SLOTS - 1]);
    assert_int_equal(grobo_i_slot_find(&robot, GROBO_I_USE_PLAIN), 4);
    (void)grobo_i_slot_take(&robot, GROBO_I_USE_PLAIN);
    assert_int_equal(grobo_i_slot_find(&robot, GROBO_I_USE_PLAIN), -1);
    assert_int_equal(grobo_i_slot_find(&robot, GROBO_I_USE_HALT), SLOTS - 1);
}

/* Behind the last one that is taken nobody looks. */
TEST_WITH(rig_wirings, the_end_of_the_slots_is_known)
{
    start();
    assert_int_equal(robot.slots_end, 0);
    for (int i = 0; i < 4; i++) {
        (void)grobo_i_slot_take(&robot, GROBO_I_USE_PLAIN);
        assert_int_equal(robot.slots_end, i + 1);
    }
    grobo_i_slot_drop(&robot.slots[1]);
    grobo_i_slot_drop(&robot.slots[2]);
    assert_int_equal(robot.slots_end, 4);
    (void)grobo_i_slot_take(&robot, GROBO_I_USE_PLAIN);
    assert_int_equal(robot.slots_end, 4);
    grobo_i_slot_drop(&robot.slots[3]);
    assert_int_equal(robot.slots_end, 2);
    grobo_i_slot_drop(&robot.slots[0]);
    grobo_i_slot_drop(&robot.slots[1]);
    assert_int_equal(robot.slots_end, 0);
}

TEST_WITH(rig_wirings, a_slot_is_taken_clean)
{
    start();
    memset(&robot.slots[0], 0xA5, sizeof robot.slots[0]);
    memset(&robot.built, 0xA5, sizeof robot.built);
    robot.slots[0].use = GROBO_I_USE_FREE;
    robot.slots[0].txn.pending_ = false;
    grobo_robot_slot be = {.robot = &robot, .due_us = GROBO_NEVER_US, .use = GROBO_I_USE_SENSE};
    const grobo_robot_slot *slot = grobo_i_slot_take(&robot, GROBO_I_USE_SENSE);
    assert_ptr_equal(slot, &robot.slots[0]);
    assert_memory_equal(&robot.built, &(grobo_exchange){0}, offsetof(grobo_exchange, frame));
    assert_memory_equal(&slot->order, &be.order, sizeof be.order);
    assert_true(slot->due_us == be.due_us && slot->given_us == 0 && slot->asked_us == 0);
    assert_false(slot->refused || slot->reads);
    assert_int_equal(slot->joint, 0);
}

/* ---- what the bus is told -------------------------------------------------------------------- */

/* A joint that was lost is asked once by the background, and nobody waits long for it. */
TEST_WITH(rig_wirings, what_the_bus_is_told_of_a_frame)
{
    static const struct {
        grobo_i_use use;
        bool reads;
        int lost, retries; /* lost: readings of that joint; retries: configured, -1 for none */
        int tries;
        bool patient;
    } rows[] = {
        {GROBO_I_USE_SENSE, true, 0, 2, 2, true},  {GROBO_I_USE_SENSE, true, 1, 2, 0, false},
        {GROBO_I_USE_JOB, true, 1, 2, 2, false},   {GROBO_I_USE_JOB, true, 0, 2, 2, true},
        {GROBO_I_USE_JOB, true, 0, -1, 0, false},  {GROBO_I_USE_JOB, false, 1, 3, 3, true},
        {GROBO_I_USE_SENSE, false, 1, 1, 1, true},
    };
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start_with(&(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT, .retries = rows[i].retries,
                                             .timeout_us = 1234});
            robot.axes[j].lost = (uint16_t)rows[i].lost;
            grobo_robot_slot *slot = grobo_i_slot_take(&robot, rows[i].use);
            slot->joint = (uint8_t)j;
            slot->reads = rows[i].reads;
            assert_int_equal(driver.sense(&driver, NULL, j, GROBO_SENSE_ALL, &robot.built), 0);
            assert_int_equal(grobo_i_slot_send(slot, &robot.built, GROBO_PRIORITY_SENSE), GROBO_OK);
            const grobo_txn *txn = &slot->txn;
            assert_int_equal(txn->retries, rows[i].tries);
            assert_int_equal(txn->patient, rows[i].patient);
            assert_int_equal(txn->priority, GROBO_PRIORITY_SENSE);
            assert_int_equal(txn->timeout_us, 1234);
            assert_ptr_equal(txn->frame, robot.frames);
            assert_int_equal(txn->frame_bytes, robot.built.frame_bytes);
            assert_memory_equal(txn->frame, robot.built.frame, txn->frame_bytes);
            assert_memory_equal(&txn->reply, &robot.built.reply, sizeof txn->reply);
            assert_ptr_equal(txn->ctx, slot);
            assert_true(txn->sent_us == -1 && slot->given_us == NOW);
        }
    }
}

TEST_WITH(rig_wirings, what_the_bus_does_not_take_is_free_again)
{
    start();
    grobo_robot_slot *slot = grobo_i_slot_take(&robot, GROBO_I_USE_JOB);
    assert_int_equal(grobo_i_slot_send(slot, &robot.built, GROBO_PRIORITY_USER),
                     GROBO_ERR_ARG); /* no frame */
    expect_used(0);
}

static int leave_result;

static int leave_as_told(grobo_robot_slot *slot)
{
    robot.built.frame_bytes = 5;
    robot.built.reply.kind = GROBO_REPLY_ACK;
    return leave_result < 0 ? leave_result : grobo_i_slot_renew(slot);
}

/* Its question is as old as its first attempt, and the frame is the one built for this attempt. */
TEST_WITH(rig_wirings, a_frame_is_asked_for_when_its_first_attempt_leaves)
{
    static const int64_t sent_us[] = {-1, 0, 1, NOW - 1};
    for (size_t i = 0; i < sizeof sent_us / sizeof sent_us[0]; i++) {
        for (int refused = 0; refused < 2; refused++) {
            start();
            grobo_robot_slot *slot = submit(0, GROBO_I_USE_JOB, (grobo_robot_order){0});
            robot.leave = leave_as_told;
            leave_result = refused ? GROBO_ERR_STATE : GROBO_OK;
            slot->asked_us = 77;
            slot->txn.sent_us = sent_us[i];
            uint16_t bytes = slot->txn.frame_bytes;
            assert_int_equal(slot->txn.leave(slot->txn.ctx, &slot->txn), leave_result);
            assert_int_equal(slot->refused, refused);
            assert_true(slot->asked_us == (i == 0 && !refused ? NOW : 77));
            assert_int_equal(slot->txn.frame_bytes, refused ? bytes : 5);
            assert_int_equal(slot->txn.reply.kind, refused ? GROBO_REPLY_RETURN : GROBO_REPLY_ACK);
        }
    }
}

static void do_nothing(grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    (void)slot;
    (void)result;
    (void)reply;
}

/* Only a named reply to the first attempt of the last frame says that the frame has left. */
TEST_WITH(rig_wirings, an_answer_says_that_its_frame_has_left)
{
    enum { ONE_ATTEMPT = 1 };
    static const struct {
        int result;
        int attempts;
        int left_later_us;
        int kind; /* -1: no packet */
        bool answered;
    } rows[] = {
        {GROBO_OK, ONE_ATTEMPT, 0, GROBO_PACKET_RETURN, true},
        {GROBO_ERR_NACK, ONE_ATTEMPT, 0, GROBO_PACKET_RETURN, false},
        {GROBO_OK, ONE_ATTEMPT + 1, 0, GROBO_PACKET_RETURN, false},
        {GROBO_OK, ONE_ATTEMPT, 1, GROBO_PACKET_RETURN, false},
        {GROBO_OK, ONE_ATTEMPT, 0, GROBO_PACKET_ACK, false},
        {GROBO_OK, ONE_ATTEMPT, 0, -1, false},
        {GROBO_ERR_TIMEOUT, ONE_ATTEMPT, 0, -1, false},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_packet reply = {.kind = (grobo_packet_kind)rows[i].kind};
        uint8_t frame[GROBO_FRAME_MAX_BYTES];
        start();
        robot.answered = true;
        grobo_robot_slot *slot = submit(0, GROBO_I_USE_JOB, (grobo_robot_order){0});
        assert_true(grobo_robot_tx(&robot, frame, sizeof frame, NOW + 5) > 0);
        assert_false(robot.answered);
        robot.left_us += rows[i].left_later_us;
        slot->txn.attempts_ = (uint8_t)rows[i].attempts;
        robot.over = do_nothing;
        slot->txn.pending_ = false;
        slot->txn.done(slot->txn.ctx, &slot->txn, rows[i].result, rows[i].kind < 0 ? NULL : &reply);
        assert_int_equal(robot.answered, rows[i].answered);
    }
}

static void ignore_reply(grobo_robot_slot *slot, const grobo_packet *reply)
{
    (void)slot;
    (void)reply;
}

/* And so does the first of several, unless it refuses. */
TEST_WITH(rig_wirings, one_of_several_answers_says_that_their_frame_has_left)
{
    for (int refused = 0; refused < 2; refused++) {
        const grobo_packet reply = {.kind = GROBO_PACKET_RETURN, .refused = refused};
        uint8_t frame[GROBO_FRAME_MAX_BYTES];
        start();
        grobo_robot_slot *slot = submit(0, GROBO_I_USE_SENSE, (grobo_robot_order){0});
        assert_true(grobo_robot_tx(&robot, frame, sizeof frame, NOW + 5) > 0);
        robot.each = ignore_reply;
        slot->txn.each(slot->txn.ctx, &slot->txn, &reply);
        assert_int_equal(robot.answered, !refused);
    }
}

/* ---- taking back ----------------------------------------------------------------------------- */

static const grobo_i_use uses[] = {GROBO_I_USE_JOB,     GROBO_I_USE_SENSE, GROBO_I_USE_MOTION,
                                   GROBO_I_USE_SEGMENT, GROBO_I_USE_HALT,  GROBO_I_USE_PLAIN};
enum { USES = sizeof uses / sizeof uses[0] };

/* One of each use, of jobs 1 to 6 in turn, in the first slots. */
static void submit_all_uses(void)
{
    start();
    for (int i = 0; i < USES; i++) {
        submit(i, uses[i], (grobo_robot_order){0})->job = i + 1;
    }
    robot.over = NULL; /* nothing goes on from here */
}

static int ended;

static void count_ended(grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    (void)slot;
    assert_int_equal(result, GROBO_ERR_CANCELED);
    assert_null(reply);
    ended++;
}

TEST_WITH(rig_wirings, frames_of_one_use_are_taken_back)
{
    for (int i = 0; i < USES; i++) {
        for (int of_job = 0; of_job < 2; of_job++) {
            submit_all_uses();
            robot.over = count_ended;
            ended = 0;
            put_behind_the_slots(&robot.slots[i]);
            assert_true(grobo_i_slots_busy(&robot, uses[i]));
            if (of_job) {
                grobo_i_slots_cancel_job(&robot, i + 1);
            } else {
                grobo_i_slots_cancel(&robot, uses[i]);
            }
            expect_used(((1U << USES) - 1) & ~(1U << i));
            assert_int_equal(ended, 1);
            assert_false(grobo_i_slots_busy(&robot, uses[i]));
            grobo_i_slots_cancel_job(&robot, USES + 1);
            assert_int_equal(ended, 1);
        }
    }
}

/* Wherever they are, up to the last slot. */
TEST_WITH(rig_wirings, every_slot_is_looked_at)
{
    for (int at = 0; at < SLOTS; at++) {
        start();
        robot.slots_end = SLOTS;
        for (int i = 0; i < SLOTS; i++) {
            grobo_i_use use = i == at ? GROBO_I_USE_MOTION : GROBO_I_USE_SENSE;
            grobo_robot_slot *slot = &robot.slots[i];
            slot->robot = &robot;
            slot->use = (uint8_t)use;
            slot->job = i == at ? 4 : 5;
            slot->order =
                (grobo_robot_order){.joints = 2,
                                    .kind = GROBO_I_ORDER_TORQUE,
                                    .torque = i == at ? GROBO_TORQUE_ON : GROBO_TORQUE_BRAKE};
            assert_int_equal(driver.sense(&driver, NULL, 0, GROBO_SENSE_ALL, &robot.built), 0);
            assert_int_equal(
                grobo_i_slot_send(slot, &robot.built,
                                  i == at ? GROBO_PRIORITY_MOTION : GROBO_PRIORITY_SENSE),
                GROBO_OK);
        }
        robot.over = count_ended;
        ended = 0;
        assert_true(grobo_i_slots_busy(&robot, GROBO_I_USE_MOTION));
        assert_true(grobo_i_slots_wait(&robot, 2, GROBO_I_ORDER_TORQUE, GROBO_TORQUE_ON));
        switch ((at + (N & 1)) % 4) { /* on both wirings all of the last slots */
        case 0:
            grobo_i_slots_cancel_goals(&robot, GROBO_JOINTS_ALL(64), true);
            break;
        case 1:
            grobo_i_slots_cancel_job(&robot, 4);
            break;
        case 2:
            grobo_i_slots_keep_off(&robot, 2);
            break;
        default:
            grobo_i_slots_cancel(&robot, GROBO_I_USE_MOTION);
            break;
        }
        for (int i = 0; i < SLOTS; i++) {
            assert_int_equal(robot.slots[i].use != GROBO_I_USE_FREE, i != at);
        }
    }
}

static void count_in_order(grobo_robot_slot *slot, int result, const grobo_packet *reply)
{
    (void)reply;
    assert_int_equal(result, GROBO_ERR_CANCELED);
    assert_int_equal(slot->order.part, ended);
    ended++;
}

TEST_WITH(rig_wirings, frames_are_taken_back_in_the_order_of_their_slots)
{
    for (int how = 0; how < 4; how++) {
        start();
        for (int i = 0; i < 4; i++) {
            submit(i, GROBO_I_USE_MOTION,
                   (grobo_robot_order){.joints = 2,
                                       .part = (uint8_t)i,
                                       .kind = GROBO_I_ORDER_TORQUE,
                                       .torque = GROBO_TORQUE_ON})
                ->job = 4;
        }
        robot.over = count_in_order;
        ended = 0;
        if (how == 0) {
            grobo_i_slots_cancel(&robot, GROBO_I_USE_MOTION);
        } else if (how == 1) {
            grobo_i_slots_cancel_job(&robot, 4);
        } else if (how == 2) {
            grobo_i_slots_cancel_goals(&robot, GROBO_JOINTS_ALL(64), true);
        } else {
            grobo_i_slots_keep_off(&robot, 2);
        }
        assert_int_equal(ended, 4);
    }
}

/* Those that have left are on their way already, and what moves other joints goes on waiting. */
TEST_WITH(rig_wirings, goals_that_wait_are_taken_back)
{
    for (int j = 0; j < N; j++) {
        const grobo_joint_mask of[] = {GROBO_JOINT_BIT(j), GROBO_JOINT_BIT(other_of(j)),
                                       GROBO_JOINT_BIT(third_of(j)), GROBO_JOINTS_ALL(N)};
        for (int i = 0; i < 4; i++) {
            for (int sent = -1; sent <= 1; sent++) {
                submit_all_uses();
                for (int k = 0; k < USES; k++) {
                    robot.slots[k].order.joints = bits(j, other_of(j));
                }
                robot.over = count_ended;
                ended = 0;
                put_behind_the_slots(&robot.slots[2]);
                robot.slots[2].txn.sent_us = sent;
                grobo_i_slots_cancel_goals(&robot, of[i], false);
                unsigned taken = i == 2 ? 0 : sent < 0 ? 4U | 8U : 8U;
                expect_used(((1U << USES) - 1) & ~taken);
                assert_int_equal(ended, (taken & 4U) / 4 + (taken & 8U) / 8);
            }
        }
    }
}

/* Whatever joints a motion that is played moves. */
TEST_WITH(rig_wirings, played_goals_that_wait_are_taken_back_if_asked)
{
    for (int played = 0; played < 2; played++) {
        for (int sent = -1; sent <= 1; sent++) {
            submit_all_uses();
            for (int k = 0; k < USES; k++) {
                robot.slots[k].order.joints = 1;
                robot.slots[k].due_us = k == 3 ? GROBO_NEVER_US : NOW;
            }
            robot.slots[2].txn.sent_us = sent;
            robot.over = count_ended;
            ended = 0;
            grobo_i_slots_cancel_goals(&robot, 2, played);
            unsigned taken = played && sent < 0 ? 4U : 0;
            expect_used(((1U << USES) - 1) & ~taken);
            assert_int_equal(ended, taken / 4);
        }
    }
}

/* Torque that waits to come on for one of these joints; nothing else, and no other's. */
TEST_WITH(rig_wirings, torque_that_waits_is_kept_off)
{
    for (int j = 0; j < N; j++) {
        const grobo_robot_order on = {.joints = bits(j, other_of(j)),
                                      .kind = GROBO_I_ORDER_TORQUE,
                                      .torque = GROBO_TORQUE_ON};
        grobo_robot_order off = on;
        grobo_robot_order hold = on;
        grobo_robot_order others = on;
        off.torque = GROBO_TORQUE_BRAKE;
        hold.kind = GROBO_I_ORDER_HOLD;
        others.joints = ~on.joints;
        for (int i = 0; i < 3; i++) {
            start();
            submit(0, GROBO_I_USE_PLAIN, off);
            submit(1, GROBO_I_USE_PLAIN, hold);
            submit(2, GROBO_I_USE_PLAIN, others);
            submit(3, GROBO_I_USE_PLAIN, on);
            submit(4, GROBO_I_USE_PLAIN, on);
            put_behind_the_slots(&robot.slots[4]);
            robot.slots[4].txn.sent_us = 0; /* has left */
            robot.over = count_ended;
            ended = 0;
            grobo_joint_mask to = i == 0   ? GROBO_JOINT_BIT(j)
                                  : i == 1 ? GROBO_JOINT_BIT(other_of(j))
                                           : GROBO_JOINT_BIT(third_of(j));
            grobo_i_slots_keep_off(&robot, to);
            expect_used(i < 2 ? 1U | 2U | 4U | 16U : 1U | 2U | 8U | 16U);
            assert_int_equal(ended, 1);
        }
    }
}

TEST_WITH(rig_wirings, a_frame_that_waits_is_known_by_what_it_does)
{
    for (int j = 0; j < N; j++) {
        const grobo_joint_mask bit = GROBO_JOINT_BIT(j);
        start();
        grobo_robot_slot *slot = submit(0, GROBO_I_USE_PLAIN,
                                        (grobo_robot_order){.joints = bits(j, other_of(j)),
                                                            .kind = GROBO_I_ORDER_TORQUE,
                                                            .torque = GROBO_TORQUE_ON});
        put_behind_the_slots(&(grobo_robot_slot){
            .use = GROBO_I_USE_PLAIN,
            .txn = {.sent_us = -1},
            .order = {.joints = GROBO_JOINTS_ALL(N), .kind = GROBO_I_ORDER_HOLD}});
        assert_true(grobo_i_slots_wait(&robot, bit, GROBO_I_ORDER_TORQUE, GROBO_TORQUE_ON));
        assert_false(grobo_i_slots_wait(&robot, bit, GROBO_I_ORDER_TORQUE, GROBO_TORQUE_BRAKE));
        assert_false(grobo_i_slots_wait(&robot, bit, GROBO_I_ORDER_HOLD, GROBO_TORQUE_ON));
        assert_false(grobo_i_slots_wait(&robot, bit, GROBO_I_ORDER_HOLD, GROBO_TORQUE_OFF));
        assert_false(grobo_i_slots_wait(&robot, GROBO_JOINT_BIT(third_of(j)), GROBO_I_ORDER_TORQUE,
                                        GROBO_TORQUE_ON));
        slot->txn.sent_us = 0;
        assert_false(grobo_i_slots_wait(&robot, bit, GROBO_I_ORDER_TORQUE, GROBO_TORQUE_ON));
    }
}

/* ---- orders ---------------------------------------------------------------------------------- */

/* A target of one joint, so far from where it is. */
static grobo_posture target_of(int joint, double way_deg, int64_t time_us)
{
    grobo_posture target;
    assert_int_equal(grobo_posture_init(&target, N), 0);
    target.set = GROBO_JOINT_BIT(joint);
    target.angle_rad[joint] = here_rad(joint) + RAD(way_deg);
    target.time_us = time_us;
    return target;
}

static const grobo_i_motion plainly = {.priority = GROBO_PRIORITY_MOTION, .due_us = GROBO_NEVER_US};

/* In whole steps of the wire, one at least. */
TEST_WITH(rig_wirings, a_target_gets_the_time_that_it_asks_for)
{
    static const struct {
        int64_t asked_us, gets_us;
    } rows[] = {{0, 1230000},          {1, 10000},     {10000, 10000},
                {14999, 10000},        {15000, 20000}, {2000000, 2000000},
                {4999, 10000},         {5000, 10000},  {GROBO_PLAY_TIME_MAX_US, 163830000},
                {INT64_MAX, 163830000}};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            start_with(&(grobo_robot_config){GROBO_ROBOT_CONFIG_INIT, .default_time_us = 1234567});
            const grobo_posture target = target_of(j, 0.1, rows[i].asked_us);
            robot.motion = i == 0 ? UINT32_MAX : 41;
            robot.motion_us = 7;
            keep_axes();
            assert_int_equal(grobo_i_gate_send(&robot, &target, &plainly), GROBO_OK);
            before[j].next = i == 0 ? 1 : 42;
            before[j].next_rad = target.angle_rad[j];
            before[j].next_time_us = rows[i].gets_us;
            expect_axes();
            grobo_bus_cost cost;
            grobo_bus_cost_of(&robot.bus, &robot.slots[0].txn, &cost);
            assert_int_equal(robot.motion_us, cost.total_us);
            expect_used(1);
        }
    }
}

/* The others of a move get as much; the end of a motion takes no longer. */
TEST_WITH(rig_wirings, a_target_that_is_too_fast_gets_more_time)
{
    for (int j = 0; j < N; j++) {
        for (int how = 0; how < 4; how++) { /* all alike, each, the end of a motion, slowly */
            grobo_i_motion motion = plainly;
            start();
            grobo_posture target = target_of(j, j < 20 ? 20.05 : -20.05, 10000);
            target.set = bits(j, other_of(j));
            target.angle_rad[other_of(j)] = here_rad(other_of(j));
            motion.each = how == 1;
            motion.rests = how == 2;
            robot.soft = how == 3;
            assert_int_equal(grobo_i_gate_send(&robot, &target, &motion), GROBO_OK);
            double dps = how == 3 ? 60 : speed_dps(j);
            int64_t be_us = (int64_t)ceil((20.05 - 0.1) / dps * 100) * 10000;
            assert_int_equal(robot.axes[j].next_time_us, how == 2 ? 10000 : be_us);
            assert_int_equal(robot.axes[other_of(j)].next_time_us,
                             how == 1 || how == 2 ? 10000 : be_us);
        }
    }
}

TEST_WITH(rig_wirings, how_a_target_is_sent_is_in_its_order)
{
    for (int bit = 0; bit < 64; bit++) {
        start();
        robot.acting = 9;
        robot.soft = (bit & 1) != 0;
        const grobo_i_motion how = {.priority = (bit & 16) != 0 ? GROBO_PRIORITY_USER
                                                                : GROBO_PRIORITY_MOTION,
                                    .due_us = (bit & 32) != 0 ? NOW - 1 : GROBO_NEVER_US,
                                    .each = (bit & 2) != 0,
                                    .single = (bit & 4) != 0,
                                    .stops = (bit & 8) != 0,
                                    .rests = (bit & 3) == 3};
        const grobo_posture target = target_of(bit % N, 0.1, S);
        assert_int_equal(grobo_i_gate_send(&robot, &target, &how), GROBO_OK);
        const grobo_robot_slot *slot = &robot.slots[0];
        assert_int_equal(slot->order.kind, GROBO_I_ORDER_GOAL);
        assert_true(slot->order.joints == GROBO_JOINT_BIT(bit % N));
        assert_int_equal(slot->order.number, 1);
        assert_int_equal(slot->order.soft, (bit & 1) != 0);
        assert_int_equal(slot->order.each, how.each);
        assert_int_equal(slot->order.single, how.single);
        assert_int_equal(slot->order.stops, how.stops);
        assert_int_equal(slot->order.rests, how.rests);
        assert_true(slot->order.moves);
        assert_int_equal(slot->use, GROBO_I_USE_MOTION);
        assert_int_equal(slot->txn.priority, how.priority);
        assert_true(slot->due_us == how.due_us);
        assert_int_equal(slot->job, (bit & 32) != 0 ? 0 : 9); /* a played one is of no job */
    }
}

static int stabilized;

static int turn_by_a_degree(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                            grobo_posture *target)
{
    assert_ptr_equal(self, &driver);
    assert_non_null(ctx);
    assert_true(sensed->set == GROBO_JOINTS_ALL(N));
    for (int j = 0; j < N; j++) {
        expect_equal(sensed->angle_rad[j], here_rad(j), "sensed");
        target->angle_rad[j] += RAD(1);
    }
    return stabilized;
}

/* All of it waits, or nothing; what waited before goes on waiting. */
TEST_WITH(rig_wirings, a_target_that_is_refused_does_not_wait)
{
    static const struct {
        int result;
        bool unread, beyond, as_is, full;
    } rows[] = {
        {GROBO_OK, false, false, false, false},        {GROBO_OK, false, false, true, false},
        {GROBO_ERR_STALE, true, false, true, false},   {GROBO_ERR_LIMIT, false, true, true, false},
        {GROBO_ERR_SPACE, false, false, false, false}, {GROBO_ERR_FULL, false, false, true, true}};
    static const grobo_i_joint_state when[] = {GROBO_I_JOINT_SENT, GROBO_I_JOINT_UNKNOWN};
    for (int j = 0; j < N; j++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            const int result = rows[i].result;
            start();
            grobo_posture target = target_of(j, rows[i].beyond ? 300 : 2, rows[i].unread ? 1 : S);
            const grobo_i_motion how = {.priority = GROBO_PRIORITY_MOTION,
                                        .due_us = GROBO_NEVER_US,
                                        .as_is = rows[i].as_is};
            robot.axes[j].phase = (uint8_t)when[rows[i].unread];
            robot.axes[other_of(j)].next = 1000;
            robot.fault_joint = 99;
            driver.stabilize = turn_by_a_degree;
            stabilized = result == GROBO_ERR_SPACE ? GROBO_ERR_SPACE : GROBO_OK;
            for (int k = 0; rows[i].full && k < SLOTS; k++) {
                robot.slots[k].use = GROBO_I_USE_PLAIN;
                robot.slots_end = SLOTS;
            }
            assert_int_equal(grobo_i_gate_send(&robot, &target, &how), result);
            bool waits = result == GROBO_OK;
            assert_int_equal(robot.axes[j].next, waits);
            assert_int_equal(robot.axes[other_of(j)].next, 1000);
            assert_int_equal(robot.counters.stretched, 0); /* refused before it is timed */
            if (waits) {
                expect_equal(robot.axes[j].next_rad, here_rad(j) + RAD(rows[i].as_is ? 2 : 3),
                             "target");
            }
            assert_true(rows[i].full || robot.slots[0].use == (waits ? GROBO_I_USE_MOTION : 0));
            int fault = rows[i].unread || rows[i].beyond ? j : result == GROBO_ERR_SPACE ? 99 : -1;
            assert_int_equal(robot.fault_joint, fault);
        }
    }
}

static int joints_fit;  /* into one frame of this driver */
static int frames_each; /* that it needs for one joint; less than 0: it fails */
static grobo_driver roomy = GROBO_TABLE_INIT(grobo_driver);

static int posture_of_few(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                          grobo_exchange *exchange)
{
    int count = grobo_joints_count(target->posture.set);
    if (frames_each < 0) {
        return GROBO_ERR_SPACE;
    }
    int frames = count > joints_fit ? 2 : count == 1 ? frames_each : 1;
    int result = roomy.posture(self, ctx, target, 0, exchange);
    return part < frames ? result : 0;
}

/* As few frames as the driver can do with, of joints of their own. */
TEST_WITH(rig_wirings, a_target_is_parted_as_the_driver_needs_it)
{
    static const struct {
        int joints, fit, each, frames;
        grobo_joint_mask be[4];
    } rows[] = {
        {6, 6, 1, 1, {0x3F}},       {6, 5, 1, 2, {0x07, 0x38}},
        {6, 3, 1, 2, {0x07, 0x38}}, {6, 2, 1, 3, {0x03, 0x0C, 0x30}},
        {5, 3, 1, 2, {0x07, 0x18}}, {4, 1, 1, 4, {1, 2, 4, 8}},
        {2, 1, 2, 4, {1, 1, 2, 2}}, {1, 6, 1, 1, {1}},
        {1, 6, 3, 3, {1, 1, 1}},    {1, 6, 0, 0, {0}},
        {2, 1, 0, 0, {0}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        start();
        grobo_posture target = target_of(0, 1, S);
        roomy = driver;
        driver.posture = posture_of_few;
        joints_fit = rows[i].fit;
        frames_each = rows[i].each;
        target.set = GROBO_JOINTS_ALL(rows[i].joints);
        for (int j = 0; j < rows[i].joints; j++) {
            target.angle_rad[j] = here_rad(j);
        }
        assert_int_equal(grobo_i_gate_send(&robot, &target, &plainly), GROBO_OK);
        expect_used((1U << rows[i].frames) - 1);
        for (int k = 0; k < rows[i].frames; k++) {
            const grobo_robot_order *order = &robot.slots[k].order;
            if (order->joints != rows[i].be[k]) {
                fail_msg("row %zu, frame %d: joints %llx", i, k, (unsigned long long)order->joints);
            }
            bool again = k > 0 && rows[i].be[k] == rows[i].be[k - 1];
            assert_int_equal(order->part, again ? robot.slots[k - 1].order.part + 1 : 0);
        }
        for (int j = 0; j < N; j++) { /* no frame, no waiting */
            assert_int_equal(robot.axes[j].next, j < rows[i].joints && rows[i].frames > 0);
        }
        frames_each = -1;
        target.set = 1;
        assert_int_equal(grobo_i_gate_send(&robot, &target, &plainly), GROBO_ERR_SPACE);
        expect_used((1U << rows[i].frames) - 1);
    }
}

TEST_WITH(rig_wirings, a_renewal_goes_with_the_motion_frames)
{
    for (int j = 0; j < N; j++) {
        start();
        set_going(j);
        robot.axes[j].phase = GROBO_I_JOINT_IN_SEGMENTS;
        robot.axes[j].told_to_us = NOW + 1;
        grobo_i_gate_renew(&robot, bits(j, other_of(j)));
        const grobo_robot_slot *slot = &robot.slots[0];
        expect_used(1);
        assert_int_equal(slot->use, GROBO_I_USE_SEGMENT);
        assert_int_equal(slot->txn.priority, GROBO_PRIORITY_MOTION);
        assert_int_equal(slot->order.kind, GROBO_I_ORDER_SEGMENT);
        assert_true(slot->order.joints == bits(j, other_of(j)));
        assert_true(slot->order.each && slot->order.moves && !slot->order.stops);
        assert_true(slot->due_us == GROBO_NEVER_US);
    }
}

/* As urgent as the job that asks; what the engine asks for by itself is as urgent as a user. */
TEST_WITH(rig_wirings, torque_is_as_urgent_as_what_asks_for_it)
{
    for (int by_job = 0; by_job < 2; by_job++) {
        for (int j = 0; j < N; j++) {
            start();
            robot.job->kind = by_job ? GROBO_JOB_ESTOP : GROBO_JOB_NONE;
            robot.job->priority = GROBO_PRIORITY_STOP; /* of the last one, where none runs */
            assert_int_equal(
                grobo_i_gate_torque(&robot, GROBO_JOINT_BIT(j), GROBO_TORQUE_BRAKE, GROBO_I_WHOLE),
                GROBO_OK);
            expect_used(1);
            const grobo_robot_slot *slot = &robot.slots[0];
            assert_int_equal(slot->txn.priority,
                             by_job ? GROBO_PRIORITY_STOP : GROBO_PRIORITY_USER);
            assert_int_equal(slot->use, GROBO_I_USE_PLAIN);
            assert_int_equal(slot->order.kind, GROBO_I_ORDER_TORQUE);
            assert_int_equal(slot->order.torque, GROBO_TORQUE_BRAKE);
            assert_true(slot->order.joints == GROBO_JOINT_BIT(j));
            assert_true(slot->order.asked_us == NOW && slot->due_us == GROBO_NEVER_US);
        }
    }
}

TEST_WITH(rig_wirings, torque_that_may_not_come_on_is_refused_by_name)
{
    for (int j = 0; j < N; j++) {
        start();
        make_limp(j);
        robot.axes[j].phase = GROBO_I_JOINT_IDLE;
        assert_int_equal(
            grobo_i_gate_torque(&robot, GROBO_JOINT_BIT(j), GROBO_TORQUE_ON, GROBO_I_WHOLE),
            GROBO_ERR_STATE);
        assert_int_equal(grobo_i_gate_torque(&robot, 0, GROBO_TORQUE_ON, GROBO_I_WHOLE), GROBO_OK);
        assert_int_equal(grobo_i_gate_hold(&robot, 0, GROBO_I_WHOLE), GROBO_OK);
        expect_used(0);
        driver.torque = NULL;
        assert_int_equal(
            grobo_i_gate_torque(&robot, GROBO_JOINT_BIT(j), GROBO_TORQUE_OFF, GROBO_I_WHOLE),
            GROBO_ERR_UNSUPPORTED);
    }
}

/* Four at a time, the lowest first. */
TEST_WITH(rig_wirings, small_frames_have_four_joints)
{
    start();
    grobo_joint_mask left = GROBO_JOINTS_ALL(10) & all_but(1);
    assert_true(grobo_i_take_chunk(&left, GROBO_I_SMALL) == 0x1D); /* 0, 2, 3, 4 */
    assert_true(left == 0x3E0);
    assert_true(grobo_i_take_chunk(&left, GROBO_I_WHOLE) == 0x3E0);
    assert_true(left == 0);
    left = GROBO_JOINTS_ALL(N);
    assert_true(grobo_i_take_chunk(&left, GROBO_I_WHOLE) == GROBO_JOINTS_ALL(N));
    for (int j = 0; j < 10; j++) {
        make_limp(j);
    }
    assert_int_equal(grobo_i_gate_hold(&robot, GROBO_JOINTS_ALL(10), GROBO_I_SMALL), GROBO_OK);
    expect_used(7);
    static const grobo_joint_mask be[] = {0xF, 0xF0, 0x300};
    for (int i = 0; i < 3; i++) {
        assert_true(robot.slots[i].order.joints == be[i]);
        assert_int_equal(robot.slots[i].order.kind, GROBO_I_ORDER_HOLD);
        assert_int_equal(robot.slots[i].txn.priority, GROBO_PRIORITY_USER);
        assert_int_equal(robot.slots[i].use, GROBO_I_USE_PLAIN);
    }
}

/* Of those that move by the time it leaves, first of all; targets that wait are gone by then. */
TEST_WITH(rig_wirings, a_halt_goes_to_what_moves)
{
    for (int j = 0; j < N; j++) {
        start();
        submit(0, GROBO_I_USE_MOTION, (grobo_robot_order){.joints = GROBO_JOINT_BIT(j)});
        submit(1, GROBO_I_USE_SEGMENT, (grobo_robot_order){.joints = GROBO_JOINT_BIT(other_of(j))});
        submit(2, GROBO_I_USE_SENSE, (grobo_robot_order){0});
        robot.over = count_ended;
        ended = 0;
        set_going(j);
        set_going(other_of(j));
        set_going(third_of(j));
        robot.axes[third_of(j)].phase = GROBO_I_JOINT_UNKNOWN;
        grobo_i_gate_halt(&robot, all_but(other_of(j)));
        assert_int_equal(ended, 2);
        expect_used(1U | 4U);
        const grobo_robot_slot *slot = &robot.slots[0];
        assert_int_equal(slot->use, GROBO_I_USE_HALT);
        assert_int_equal(slot->txn.priority, GROBO_PRIORITY_STOP);
        assert_int_equal(slot->order.kind, GROBO_I_ORDER_HALT);
        const grobo_joint_mask of =
            slot->order.joints; /* of all asked for, what fits into a frame */
        assert_true((of & bits(j, other_of(j))) == GROBO_JOINT_BIT(j));
        assert_true(of != GROBO_JOINT_BIT(j));
        assert_true(slot->order.asked_us == NOW && slot->order.each && slot->order.stops);
        assert_true(slot->due_us == GROBO_NEVER_US);
        assert_int_equal(slot->order.number, 0);
        assert_true(halting() == GROBO_JOINT_BIT(j));
        robot.axes[j].trajectory.to_us = NOW;
        robot.axes[third_of(j)].phase = GROBO_I_JOINT_SENT;
        assert_true(halting() == (of & GROBO_JOINT_BIT(third_of(j))));
    }
}

TEST_WITH(rig_wirings, a_halt_of_what_stands_is_not_sent)
{
    for (int j = 0; j < N; j++) {
        start();
        set_going(j);
        grobo_i_gate_halt(&robot, all_but(j));
        expect_used(0);
        assert_true(halting() == 0);
    }
}

/* Frames that move joints count, readings and the like do not. */
/* A stop waits for the reply that is under way no longer than that needs, and where none is under
 * way it changes nothing. */
TEST_WITH(rig_wirings, a_stop_hurries_the_reply_that_is_under_way)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    start();
    robot.bus.limit_us = GROBO_NEVER_US;
    grobo_i_slots_hurry(&robot);
    assert_true(robot.bus.limit_us == GROBO_NEVER_US);
    (void)submit(0, GROBO_I_USE_SENSE, (grobo_robot_order){.kind = GROBO_I_ORDER_NONE});
    assert_true(grobo_bus_tx(&robot.bus, frame, sizeof frame, NOW) > 0);
    int64_t over_us = robot.bus.over_us;
    assert_true(over_us > NOW && robot.bus.limit_us > over_us + GROBO_BUS_MARGIN_MIN_US);
    grobo_i_slots_hurry(&robot);
    assert_true(robot.bus.limit_us == over_us + GROBO_BUS_MARGIN_MIN_US);
    robot.bus.limit_us = GROBO_NEVER_US;
    robot.now_us = over_us + 1000; /* it is late: a moment from now */
    grobo_i_slots_hurry(&robot);
    assert_true(robot.bus.limit_us == over_us + 1000 + GROBO_BUS_MARGIN_MIN_US);
    robot.bus.limit_us = over_us + 1; /* it had less time than that already */
    grobo_i_slots_hurry(&robot);
    assert_true(robot.bus.limit_us == over_us + 1);
}

/* Of two frames to a joint the first is lost: what would follow a goal is not sent, what a job asks
 * is. */
TEST_WITH(rig_wirings, a_lost_frame_of_a_job_takes_no_other_back)
{
    static const grobo_i_use of[] = {GROBO_I_USE_JOB, GROBO_I_USE_MOTION};
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        start();
        grobo_robot_order order = {.kind = GROBO_I_ORDER_GOAL, .joints = GROBO_JOINT_BIT(3)};
        (void)submit(0, of[i], order);
        order.part = 1;
        (void)submit(1, of[i], order);
        grobo_robot_slot first = robot.slots[0];
        first.txn.sent_us = NOW;
        grobo_i_frame_over(&first, GROBO_ERR_TIMEOUT, NULL);
        assert_int_equal(robot.slots[1].use, i == 0 ? GROBO_I_USE_JOB : GROBO_I_USE_FREE);
    }
}

TEST_WITH(rig_wirings, what_a_frame_was_for_decides_what_its_end_counts)
{
    for (int i = 0; i < USES; i++) {
        for (int lost = 0; lost < 2; lost++) {
            start();
            robot.link = false; /* nothing goes on from here */
            grobo_robot_slot over = {.robot = &robot,
                                     .use = (uint8_t)uses[i],
                                     .due_us = GROBO_NEVER_US,
                                     .txn = {.sent_us = NOW}};
            bool moves = uses[i] == GROBO_I_USE_MOTION || uses[i] == GROBO_I_USE_SEGMENT;
            over.reads = uses[i] == GROBO_I_USE_SENSE;
            grobo_i_frame_over(&over, lost ? GROBO_ERR_TIMEOUT : GROBO_OK, NULL);
            assert_int_equal(robot.counters.motion_frames, moves && !lost);
            assert_int_equal(robot.counters.late_frames, 0);
            assert_int_equal(robot.axes[0].lost, over.reads); /* of no reply nothing is read */
        }
    }
}

/* While a motion is played, of what it does not move: that it brings to rest by itself, and once it
 * stops, that is what its last frame moves. */
TEST_WITH(rig_wirings, a_stop_takes_back_what_waits_and_halts_what_is_not_played)
{
    enum { IDLE, SOME, ALL, STOPPING, HOWS };
    for (int j = 0; j < N; j++) {
        for (int how = 0; how < HOWS; how++) {
            start();
            submit(0, GROBO_I_USE_MOTION, (grobo_robot_order){.joints = GROBO_JOINT_BIT(j)});
            robot.over = count_ended;
            ended = 0;
            set_going(j);
            set_going(other_of(j));
            set_going(third_of(j));
            robot.sequencer.state = how == IDLE       ? GROBO_SEQUENCER_IDLE
                                    : how == STOPPING ? GROBO_SEQUENCER_STOPPING
                                                      : GROBO_SEQUENCER_PLAYING;
            robot.played_joints = how == SOME || how == STOPPING ? all_but(j) : GROBO_JOINTS_ALL(N);
            robot.sequencer.to.set = all_but(other_of(j));
            const grobo_joint_mask be[HOWS] = {[IDLE] = bits(j, other_of(j)) |
                                                        GROBO_JOINT_BIT(third_of(j)),
                                               [SOME] = GROBO_JOINT_BIT(j),
                                               [STOPPING] = bits(j, other_of(j))};
            grobo_i_stop_moves(&robot);
            assert_int_equal(ended, 1);
            assert_true(halting() == be[how]);
            for (int i = 0; i < SLOTS; i++) {
                const grobo_robot_slot *slot = &robot.slots[i];
                bool halts = slot->use == GROBO_I_USE_HALT;
                assert_true(halts || slot->use == GROBO_I_USE_FREE);
                assert_true(!halts || how == IDLE || (slot->order.joints & ~be[how]) == 0);
            }
        }
    }
}
