/* SPDX-License-Identifier: MIT */
/*
 * What moves a joint, as far as the engine knows: one state, and a table of what each event makes
 * of it. Events are frames that have left and readings that were taken; nothing else changes the
 * state. docs/design.md has the diagram, and lists what is known of a joint besides.
 *
 * What time alone changes is no state: a joint that was sent somewhere moves, settles or holds
 * there by the times of its trajectory and by what was read (grobo_i_axis_moves(),
 * grobo_i_rests(), grobo_i_stands()). Torque is known apart from this.
 */
#include "src/base/assert.h"
#include "src/robot/state.h"

/* The letters of the table. NEVER: the caller has seen to it that the event cannot come then. */
enum {
    U = GROBO_I_JOINT_UNKNOWN,
    I = GROBO_I_JOINT_IDLE,
    R = GROBO_I_JOINT_READY,
    X = GROBO_I_JOINT_EXTERNAL,
    T = GROBO_I_JOINT_SENT,
    P = GROBO_I_JOINT_IN_SEGMENTS,
    S = GROBO_I_JOINT_STRAY,
    NEVER = GROBO_I_JOINT_STATES
};
#define N NEVER

/* Without assertions a transition that the table lacks leaves the joint unknown. */
static const uint8_t next_of[GROBO_I_JOINT_STATES][GROBO_I_JOINT_EVENTS] = {
    /* forget, read, turns, strays, holds, loose, goal, segment, hold, off, on, rest */
    [U] = {U, I, X, U, U, U, N, N, N, U, U, U}, [I] = {U, I, X, S, R, I, T, N, I, I, T, I},
    [R] = {U, R, X, S, R, I, T, N, R, I, T, R}, [X] = {U, I, X, S, R, X, T, N, X, X, T, X},
    [T] = {U, T, N, S, R, T, T, P, I, I, T, T}, [P] = {U, P, N, S, R, P, T, N, I, I, P, T},
    [S] = {U, T, N, S, R, S, T, N, I, I, S, T},
};

void grobo_i_joint_to(grobo_robot_axis *axis, grobo_i_joint_event event)
{
    uint8_t next = next_of[axis->phase][event];
    GROBO_ASSERT(next != NEVER);
    axis->phase = next != NEVER ? next : GROBO_I_JOINT_UNKNOWN; /* it is read before it moves */
}
