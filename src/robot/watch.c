/* SPDX-License-Identifier: MIT */
/* Judges what is read, and stops for safety. */
#include <math.h>
#include <stdlib.h>

#include "src/robot/axis.h"
#include "src/robot/blocked.h"
#include "src/robot/couple.h"
#include "src/robot/query.h"
#include "src/robot/robot.h"
#include "src/robot/state.h"
#include "src/robot/trip.h"
#include "src/robot/watch.h"
#include "src/robot/wheel.h"

/* So many readings of a low voltage in a row, of whatever joints: they share a battery. */
#define LOW_READINGS 3

/* ---- readings -------------------------------------------------------------------------------- */

static void watch_heat(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    bool known = (got->valid & GROBO_FIELD_TEMPERATURE) != 0;
    if (got->overheated) {
        grobo_i_trip(robot, GROBO_TRIP_OVERHEATED, joint, known ? got->temperature_c : 0, true);
    } else if (known && robot->config.temperature_c > 0 &&
               got->temperature_c > robot->config.temperature_c) {
        grobo_i_trip(robot, GROBO_TRIP_TEMPERATURE, joint, got->temperature_c, true);
    }
}

static void watch_current(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if ((got->valid & GROBO_FIELD_CURRENT) == 0) {
        return;
    }
    if (robot->config.current_ma == 0 || got->current_ma <= robot->config.current_ma) {
        axis->current_since_us = GROBO_NEVER_US;
        return;
    }
    if (axis->current_since_us == GROBO_NEVER_US) {
        axis->current_since_us = robot->now_us;
    }
    if (robot->now_us - axis->current_since_us >=
        grobo_i_driver_of(robot, joint)->limits.current_us) {
        grobo_i_trip(robot, GROBO_TRIP_CURRENT, joint, got->current_ma, true);
    }
}

static void watch_voltage(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    if ((got->valid & GROBO_FIELD_VOLTAGE) == 0) {
        return;
    }
    if (robot->config.voltage_mv == 0 || got->voltage_mv >= robot->config.voltage_mv) {
        robot->low_readings = 0;
    } else if (++robot->low_readings >= LOW_READINGS) {
        robot->low_readings = 0;
        grobo_i_trip(robot, GROBO_TRIP_VOLTAGE, joint, got->voltage_mv, true);
    }
}

static void watch_torque(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if ((got->valid & GROBO_FIELD_TORQUE) != 0 && axis->wants_torque &&
        got->torque == GROBO_TORQUE_OFF) {
        axis->wants_torque = false;
        grobo_i_joint_to(axis, GROBO_I_JOINT_OFF);
        grobo_i_trip(robot, GROBO_TRIP_TORQUE_LOST, joint, 0, true);
    }
}

/* Servos on one shaft that are read to be so far apart so often in a row are. */
#define APART_READINGS 3

static void watch_apart(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    for (int f = 0; grobo_i_followers(robot) != 0 && f < robot->driver->model->n_joints; f++) {
        const grobo_joint *own = grobo_i_joint(robot->driver->model, f);
        if (!grobo_i_has(grobo_i_followers(robot), f)) {
            continue;
        }
        bool watched = grobo_i_apart(own) > 0, told = (got->valid & GROBO_FIELD_ANGLE) != 0;
        double apart_rad = watched && told ? grobo_i_apart_rad(robot, f, joint) : NAN;
        if (apart_rad <= grobo_i_apart(own)) {
            robot->axes[f].n_apart = 0;
        } else if (apart_rad > grobo_i_apart(own) && ++robot->axes[f].n_apart >= APART_READINGS) {
            robot->axes[f].n_apart = 0;
            grobo_i_trip(robot, GROBO_TRIP_APART, f, grobo_deg_from_rad(apart_rad), true);
        }
    }
}

#if !GROBO_DRIVERS_PLAIN
/* A wheel that was told at least so much, and turns at less than that part of it for so long, is
 * held fast. */
#define BLOCKED_RAD_S (20 * 0.017453292519943295)
#define BLOCKED_PART 8
#define BLOCKED_US 1000000

static void look_at_wheel(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    const unsigned speed = GROBO_FIELD_SPEED;
    double told_rad_s = fabs(axis->told_rad_s);
    double seen_rad_s = grobo_rad_from_deg(abs(axis->state.speed_dps));
    bool slow = (axis->state.valid & speed) != 0 && told_rad_s >= BLOCKED_RAD_S &&
                !grobo_i_axis_is_limp(axis) && seen_rad_s * BLOCKED_PART < told_rad_s;
    if (!slow) {
        axis->stalled_us = GROBO_NEVER_US;
    } else if (axis->stalled_us == GROBO_NEVER_US) {
        axis->stalled_us = robot->now_us;
    } else if (robot->now_us - axis->stalled_us >= BLOCKED_US) {
        axis->stalled_us = GROBO_NEVER_US;
        grobo_i_trip(robot, GROBO_TRIP_BLOCKED, joint, axis->state.speed_dps, true);
    }
}
#endif

static void watch_way(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
#if !GROBO_DRIVERS_PLAIN
    if (grobo_i_is_wheel(robot, joint)) {
        look_at_wheel(robot, joint);
        return;
    }
#endif
    grobo_i_blocked_look(robot, joint, got);
}

void grobo_i_watch_reading(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    watch_heat(robot, joint, got);
    watch_current(robot, joint, got);
    watch_voltage(robot, joint, got);
    watch_torque(robot, joint, got);
    watch_apart(robot, joint, got);
    watch_way(robot, joint, got);
}

void grobo_i_watch_lost(grobo_robot *robot, int joint)
{
    int limit = robot->config.lost_replies;
    int lost = robot->axes[joint].lost;
    bool moves = grobo_i_in_motion(robot) || grobo_i_moving(robot, robot->now_us);
    if (limit > 0 && lost >= limit && moves) {
        grobo_i_trip(robot, GROBO_TRIP_LOST_REPLIES, joint, lost, true);
    }
}
