/* SPDX-License-Identifier: MIT */
/* Whether a joint that was told to stand goes on all the same, by its last reading: an exit and an
 * emergency stop halt it anew. */
#include <math.h>
#include <stdlib.h>

#include "src/base/instant.h"
#include "src/robot/astray.h"
#include "src/robot/axis.h"
#include "src/robot/halted.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/state.h"
#include "src/robot/wheel.h"

/* Nearer than this to its goal, a servo is there. */
#define THERE_RAD (0.2 * 0.017453292519943295)

/* A servo that turns yet so near the end of its trajectory comes to rest there; nearer and
 * slower, it stands and trembles. */
#define ARRIVES_RAD (3 * 0.017453292519943295)
#define TREMBLES_RAD (1 * 0.017453292519943295)
#define TREMBLES_DPS 60
#define ARRIVES_US 20000

/* Of one that tells no more than its speed; plain ones tell the time of their way. */
static bool still_turns(const grobo_robot *robot, int joint)
{
    if (GROBO_DRIVERS_PLAIN) {
        return false;
    }
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool trembles = grobo_i_has_target(axis) && !grobo_i_is_stray(axis) &&
                    abs(axis->seen_dps) < TREMBLES_DPS &&
                    grobo_i_near_rad(axis->trajectory.to_rad - grobo_i_load(axis), axis->seen_rad,
                                     TREMBLES_RAD);
    return grobo_i_axis_tells_turn(robot, joint) && !trembles &&
           axis->state.torque == GROBO_TORQUE_ON && abs(axis->seen_dps) >= GROBO_I_SLOW_DPS;
}

/* It is let go on, and looked at once more. One that swings in its load has arrived. */
bool grobo_i_arrives(grobo_robot *robot, int joint)
{
    if (GROBO_DRIVERS_PLAIN) {
        return false;
    }
    grobo_robot_axis *axis = &robot->axes[joint];
    bool swings = grobo_i_load(axis) != 0 && grobo_i_swings(robot, joint);
    bool arrives =
        grobo_i_has_target(axis) && !grobo_i_is_stray(axis) && still_turns(robot, joint) &&
        !swings &&
        grobo_i_near_rad(axis->trajectory.to_rad - grobo_i_load(axis), axis->seen_rad, ARRIVES_RAD);
    if (arrives) {
        axis->trajectory.to_us = grobo_i_later(axis->trajectory.to_us, robot->now_us + ARRIVES_US);
    }
    return arrives;
}

/* A joint so far from the goal that its servo just told of, and turning there, however slowly, is
 * on its trajectory: one that sags under its load turns the other way, or not at all. */
#define CREEPS_FAR_RAD (3 * 0.017453292519943295)
#define CREEPS_DPS 2
/* One that swings so has turned back by then. */
#define TURNS_BACK_US 500000

bool grobo_i_creeps_to_its_goal(const grobo_robot *robot, int joint)
{
    if (GROBO_DRIVERS_PLAIN || grobo_i_is_wheel(robot, joint)) {
        return false; /* plain ones do not tell that they turn (grobo_i_axis_tells_turn()) */
    }
    const grobo_robot_axis *axis = &robot->axes[joint];
    double left_rad = axis->state.goal_rad - grobo_i_load(axis) - axis->seen_rad;
    int64_t begun_us = grobo_i_later(robot->job->begun_us, axis->told_us);
    bool may_turn_back =
        robot->now_us - begun_us <= TURNS_BACK_US && grobo_i_may_sag(robot, joint, begun_us);
    return grobo_i_axis_tells_turn(robot, joint) && axis->goal_us == axis->angle_us &&
           abs(axis->seen_dps) >= CREEPS_DPS && axis->seen_dps * left_rad > 0 &&
           fabs(left_rad) > CREEPS_FAR_RAD && !may_turn_back;
}

/* True if the servo, just read, says that it is on a trajectory; notes that trajectory. One that
 * has time left creeps, however slowly. So near its goal one that reports no speed may hang:
 * whether it creeps, the next reading shows (step_moved()). */
bool grobo_i_goes_on(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_joint_state *state = &axis->state;
    int64_t left_us = state->goal_time_us - state->time_us;
    bool creeps = (state->valid & GROBO_FIELD_TIME) != 0 && axis->goal_us == axis->angle_us &&
                  left_us > 0 &&
                  !grobo_i_near_rad(state->goal_rad, state->angle_rad,
                                    state->speed_dps != 0 ? THERE_RAD : GROBO_I_HANGS_RAD);
    bool turns = (still_turns(robot, joint) && !grobo_i_swings(robot, joint)) ||
                 grobo_i_creeps_to_its_goal(robot, joint);
    if (state->torque != GROBO_TORQUE_ON ||
        (axis->own_until_us <= robot->now_us && !grobo_i_is_external(axis) && !creeps && !turns)) {
        return false;
    }
    if (creeps) {
        axis->own_until_us = grobo_i_later(axis->own_until_us, axis->goal_us + left_us);
    }
    grobo_i_astray(robot, joint);
    return true;
}
