/* SPDX-License-Identifier: MIT */
/*
 * What moves a joint: every state meets every event. The judge keeps what the states stand for as
 * facts, each with a rule of its own, and knows nothing of the table.
 */
#include <string.h>

#include "src/robot/state.h"
#include "tests/support/test.h"

typedef struct facts {
    bool read;     /* where it is, is known */
    bool sent;     /* to a target, and torque was not taken away since */
    bool parts;    /* told in segments */
    bool stray;    /* read off its trajectory */
    bool ready;    /* its goal was read to be where it is */
    bool external; /* externally moved */
} facts;

static facts facts_of(int state)
{
    return (facts){.read = state != GROBO_I_JOINT_UNKNOWN,
                   .sent = state == GROBO_I_JOINT_SENT || state == GROBO_I_JOINT_IN_SEGMENTS ||
                           state == GROBO_I_JOINT_STRAY,
                   .parts = state == GROBO_I_JOINT_IN_SEGMENTS,
                   .stray = state == GROBO_I_JOINT_STRAY,
                   .ready = state == GROBO_I_JOINT_READY,
                   .external = state == GROBO_I_JOINT_EXTERNAL};
}

/* A frame with a goal leaves only for a joint that was read; a joint that was sent somewhere is
 * not externally moved; a segment begins the trajectory of the goal before it. */
static bool may_be(facts f, int event)
{
    switch ((grobo_i_joint_event)event) {
    case GROBO_I_JOINT_GOAL:
    case GROBO_I_JOINT_HOLD:
        return f.read;
    case GROBO_I_JOINT_SEGMENT:
        return f.sent && !f.parts && !f.stray;
    case GROBO_I_JOINT_TURNS:
        return !f.sent;
    case GROBO_I_JOINT_FORGET:
    case GROBO_I_JOINT_READ:
    case GROBO_I_JOINT_STRAYS:
    case GROBO_I_JOINT_HOLDS:
    case GROBO_I_JOINT_LOOSE:
    case GROBO_I_JOINT_OFF:
    case GROBO_I_JOINT_ON:
    case GROBO_I_JOINT_REST:
    case GROBO_I_JOINT_EVENTS:
        break;
    }
    return true;
}

static facts when_read(facts f, bool external, bool stray)
{
    bool parts = f.parts && !stray;
    return (facts){.read = true,
                   .sent = f.sent || (stray && f.read),
                   .parts = parts,
                   .stray = stray && f.read,
                   .ready = f.ready && !external && !stray,
                   .external = external};
}

/* Of a joint that nobody has read only a reading of where it is changes anything. */
static facts after(facts f, int event)
{
    const facts nothing = {0}, sent = {.read = true, .sent = true};
    const bool known = f.read;
    switch ((grobo_i_joint_event)event) {
    case GROBO_I_JOINT_FORGET:
        return nothing;
    case GROBO_I_JOINT_READ:
        return when_read(f, false, false);
    case GROBO_I_JOINT_TURNS:
        return when_read(f, true, false);
    case GROBO_I_JOINT_STRAYS:
        return known ? when_read(f, false, true) : nothing;
    case GROBO_I_JOINT_HOLDS:
        return known ? (facts){.read = true, .ready = true} : nothing;
    case GROBO_I_JOINT_LOOSE:
        f.ready = false;
        return f;
    case GROBO_I_JOINT_GOAL:
        return sent;
    case GROBO_I_JOINT_SEGMENT:
        return (facts){.read = true, .sent = true, .parts = true};
    case GROBO_I_JOINT_HOLD: /* whoever turns it goes on; what was ready for torque is so still */
        f.sent = f.parts = f.stray = false;
        return f;
    case GROBO_I_JOINT_OFF:
        f.sent = f.parts = f.stray = f.ready = false;
        return f;
    case GROBO_I_JOINT_ON: /* it holds, unless it was sent somewhere */
        return !known || f.sent ? f : sent;
    case GROBO_I_JOINT_REST:
        f.parts = f.stray = false;
        return f;
    case GROBO_I_JOINT_EVENTS:
        break;
    }
    return f;
}

TEST(every_state_and_every_event_follow_the_rules)
{
    int met = 0;
    for (int state = 0; state < GROBO_I_JOINT_STATES; state++) {
        for (int event = 0; event < GROBO_I_JOINT_EVENTS; event++) {
            const facts f = facts_of(state);
            grobo_robot_axis axis = {.phase = (uint8_t)state};
            if (!may_be(f, event)) {
                continue;
            }
            grobo_i_joint_to(&axis, (grobo_i_joint_event)event);
            const facts is = facts_of(axis.phase), be = after(f, event);
            if (axis.phase >= GROBO_I_JOINT_STATES || memcmp(&is, &be, sizeof is) != 0) {
                fail_msg("state %d, event %d: state %d", state, event, axis.phase);
            }
            met++;
        }
    }
    assert_int_equal(met, GROBO_I_JOINT_STATES * GROBO_I_JOINT_EVENTS - 11);
}

/* What other files ask of a state is what it stands for. */
TEST(states_are_asked_for_by_what_they_stand_for)
{
    for (int state = 0; state < GROBO_I_JOINT_STATES; state++) {
        const grobo_robot_axis axis = {.phase = (uint8_t)state};
        const facts be = facts_of(state);
        assert_int_equal(grobo_i_is_sensed(&axis), be.read);
        assert_int_equal(grobo_i_has_target(&axis), be.sent);
        assert_int_equal(grobo_i_is_in_segments(&axis), be.parts);
        assert_int_equal(grobo_i_is_stray(&axis), be.stray);
        assert_int_equal(grobo_i_is_ready(&axis), be.ready);
        assert_int_equal(grobo_i_is_external(&axis), be.external);
    }
}
