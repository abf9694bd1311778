/* SPDX-License-Identifier: MIT */
/* What moves a joint: its states, and the events that change them (state.c). */
#ifndef GROBO_ROBOT_STATE_H
#define GROBO_ROBOT_STATE_H

#include <grobo/core/static.h>

/* grobo_robot_axis.phase. The last three have a target. */
typedef enum grobo_i_joint_state {
    GROBO_I_JOINT_UNKNOWN = 0, /* not read since the link came up, or since a frame that nobody
                                * here can read */
    GROBO_I_JOINT_IDLE,        /* read, and sent nowhere: limp, or held by what was before */
    GROBO_I_JOINT_READY,       /* its goal was read back to be where it is: torque may come on */
    GROBO_I_JOINT_EXTERNAL,    /* externally moved: it turns, and nobody knows where to */
    GROBO_I_JOINT_SENT,        /* on the trajectory it was sent on, or at rest at its end */
    GROBO_I_JOINT_IN_SEGMENTS, /* the same, and told its trajectory in segments */
    GROBO_I_JOINT_STRAY,       /* sent somewhere, and read not to be on its trajectory: it lost the
                                * frame, is blocked, or another program moves it */
    GROBO_I_JOINT_STATES
} grobo_i_joint_state;

typedef enum grobo_i_joint_event {
    /* The link went down, or a frame has left that may have moved or restarted the servo. */
    GROBO_I_JOINT_FORGET = 0,
    /* Readings of an angle: as it should be, externally moved, off its trajectory. */
    GROBO_I_JOINT_READ,
    GROBO_I_JOINT_TURNS,
    GROBO_I_JOINT_STRAYS,
    /* Its goal was read: it is where the joint is, or it is not, or must be read anew. */
    GROBO_I_JOINT_HOLDS,
    GROBO_I_JOINT_LOOSE,
    /* Frames that have left: a goal; and that was the first segment of one; a goal where the joint
     * is, for one without torque. */
    GROBO_I_JOINT_GOAL,
    GROBO_I_JOINT_SEGMENT,
    GROBO_I_JOINT_HOLD,
    /* A frame that takes torque away has left, or it was read to be gone; it was read to have come
     * on. */
    GROBO_I_JOINT_OFF,
    GROBO_I_JOINT_ON,
    /* Its trajectory is replaced by the place where it is, or ends where it was told to go. */
    GROBO_I_JOINT_REST,
    GROBO_I_JOINT_EVENTS
} grobo_i_joint_event;

/* Changes the state of a joint. Asserted: no frame with a goal has left for an unknown joint, a
 * segment follows the goal noted for it, and a joint with a target is not externally moved. */
void grobo_i_joint_to(grobo_robot_axis *axis, grobo_i_joint_event event);

/* It was read since the link came up. */
static inline bool grobo_i_is_sensed(const grobo_robot_axis *axis)
{
    return axis->phase != GROBO_I_JOINT_UNKNOWN;
}

/* It was sent somewhere since then. */
static inline bool grobo_i_has_target(const grobo_robot_axis *axis)
{
    return axis->phase >= GROBO_I_JOINT_SENT;
}

static inline bool grobo_i_is_external(const grobo_robot_axis *axis)
{
    return axis->phase == GROBO_I_JOINT_EXTERNAL;
}

static inline bool grobo_i_is_in_segments(const grobo_robot_axis *axis)
{
    return axis->phase == GROBO_I_JOINT_IN_SEGMENTS;
}

static inline bool grobo_i_is_stray(const grobo_robot_axis *axis)
{
    return axis->phase == GROBO_I_JOINT_STRAY;
}

static inline bool grobo_i_is_ready(const grobo_robot_axis *axis)
{
    return axis->phase == GROBO_I_JOINT_READY;
}

#endif
