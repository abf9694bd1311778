/* SPDX-License-Identifier: MIT */
/* Judges what is read, and stops for safety. */
#include "src/robot/robot.h"

/* So many readings of a low voltage in a row, of whatever joints: they share a battery. */
#define LOW_READINGS 3

static const char *const trip_names[] = {
    [GROBO_TRIP_NONE] = "none",
    [GROBO_TRIP_TEMPERATURE] = "over-temperature",
    [GROBO_TRIP_OVERHEATED] = "servo overheated",
    [GROBO_TRIP_CURRENT] = "over-current",
    [GROBO_TRIP_VOLTAGE] = "low voltage",
    [GROBO_TRIP_LOST_REPLIES] = "lost replies",
    [GROBO_TRIP_TORQUE_LOST] = "torque lost",
    [GROBO_TRIP_LIMIT] = "outside limits",
    [GROBO_TRIP_NUMBER] = "not a number",
    [GROBO_TRIP_HOST_STALL] = "host stalled",
    [GROBO_TRIP_ESTOP] = "emergency stop",
};

const char *grobo_trip_name(grobo_trip trip)
{
    size_t n = sizeof trip_names / sizeof trip_names[0];
    return (size_t)trip < n ? trip_names[trip] : "unknown";
}

bool grobo_i_in_motion(const grobo_robot *robot)
{
    return robot->job.kind == GROBO_JOB_MOVE || grobo_robot_is_playing(robot);
}

/* Jobs that a latched stop ends: those that move, or that switch torque on. */
static bool job_must_end(const grobo_robot *robot)
{
    switch (robot->job.kind) {
    case GROBO_JOB_MOVE:
    case GROBO_JOB_PLAY:
    case GROBO_JOB_STORED:
    case GROBO_JOB_RAW:
    case GROBO_JOB_SETTLE:
        return true;
    case GROBO_JOB_TORQUE:
        return robot->job.torque == GROBO_TORQUE_ON;
    case GROBO_JOB_NONE:
    case GROBO_JOB_CHECK:
    case GROBO_JOB_SENSE:
    case GROBO_JOB_REGISTERS:
    case GROBO_JOB_COMMAND:
    case GROBO_JOB_EXIT:
    case GROBO_JOB_ESTOP:
        return false;
    }
    return false;
}

void grobo_i_trip(grobo_robot *robot, grobo_trip reason, int joint, double value, bool latched)
{
    if (robot->trip.latched && reason != GROBO_TRIP_ESTOP) {
        return; /* the first reason stays */
    }
    grobo_event event = {.kind = GROBO_EVENT_TRIP};
    event.u.trip = (grobo_trip_info){reason, joint, value, robot->now_us, latched};
    if (latched) {
        robot->trip = event.u.trip;
        robot->free_joints = 0;
    }
    grobo_i_slots_cancel_goals(robot);
    robot->counters.trips++;
    grobo_i_tell(robot, &event);
    if (grobo_robot_is_playing(robot)) {
        (void)grobo_sequencer_stop(&robot->sequencer, false, robot->now_us);
    }
    if (latched && job_must_end(robot)) {
        grobo_i_job_end(robot, GROBO_ERR_LATCHED);
    }
    /* Before an emergency stop nothing goes out, and who leaves is on the way already. */
    if (latched && reason != GROBO_TRIP_ESTOP && robot->job.kind != GROBO_JOB_EXIT) {
        grobo_i_stop_moves(robot);
    }
}

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
    if (robot->now_us - axis->current_since_us >= robot->driver->limits.current_us) {
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
        axis->wants_torque = axis->has_target = axis->held = false;
        grobo_i_trip(robot, GROBO_TRIP_TORQUE_LOST, joint, 0, true);
    }
}

void grobo_i_watch_reading(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    watch_heat(robot, joint, got);
    watch_current(robot, joint, got);
    watch_voltage(robot, joint, got);
    watch_torque(robot, joint, got);
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
