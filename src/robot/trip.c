/* SPDX-License-Identifier: MIT */
/* Stops for safety. */
#include "src/base/assert.h"
#include "src/robot/axis.h"
#include "src/robot/job.h"
#include "src/robot/query.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/stop.h"
#include "src/robot/trip.h"
#include "src/robot/wheel.h"

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
    [GROBO_TRIP_APART] = "servos apart",
    [GROBO_TRIP_BLOCKED] = "joint blocked",
    [GROBO_TRIP_OVERLOAD] = "joint overloaded",
};

const char *grobo_trip_name(grobo_trip trip)
{
    size_t n = sizeof trip_names / sizeof trip_names[0];
    return (size_t)trip < n ? trip_names[trip] : "unknown";
}

/* Jobs that a latched stop ends: those that move, or that switch torque on. */
static bool must_end(const grobo_robot_task *job)
{
    switch (job->kind) {
    case GROBO_JOB_MOVE:
    case GROBO_JOB_PLAY:
    case GROBO_JOB_STORED:
    case GROBO_JOB_RAW:
    case GROBO_JOB_SETTLE:
        return true;
    case GROBO_JOB_TORQUE:
        return job->torque == GROBO_TORQUE_ON;
    case GROBO_JOB_NONE:
    case GROBO_JOB_CHECK:
    case GROBO_JOB_SENSE:
    case GROBO_JOB_REGISTERS:
    case GROBO_JOB_COMMAND:
    case GROBO_JOB_EXIT:
    case GROBO_JOB_ESTOP:
        break;
    }
    return false;
}

void grobo_i_trip(grobo_robot *robot, grobo_trip reason, int joint, double value, bool latched)
{
    GROBO_ASSERT(reason != GROBO_TRIP_NONE && joint < robot->driver->model->n_joints);
    if (robot->trip.latched && (reason != GROBO_TRIP_ESTOP || robot->trip.trip == reason)) {
        return; /* the first reason stays, and is told once */
    }
    grobo_event event = {.kind = GROBO_EVENT_TRIP};
    event.u.trip = (grobo_trip_info){reason, joint, value, robot->now_us, latched};
    if (latched) {
        robot->trip = event.u.trip;
        robot->free_joints = 0;
    }
    grobo_i_wheels_forget(robot, latched ? grobo_i_all_joints(robot) : 0);
    grobo_i_slots_cancel_goals(robot, grobo_i_all_joints(robot), true);
    robot->counters.trips++;
    grobo_i_tell(robot, &event);
    if (grobo_i_is_playing(robot)) {
        (void)grobo_sequencer_stop(&robot->sequencer, false, robot->now_us);
    }
    grobo_i_queue_end(robot, latched ? GROBO_ERR_LATCHED : GROBO_ERR_CANCELED);
    if (latched) {
        grobo_i_jobs_end(robot, must_end, GROBO_ERR_LATCHED);
    }
    /* Before an emergency stop nothing goes out, and who leaves is on the trajectory already. */
    if (latched && reason != GROBO_TRIP_ESTOP && robot->jobs[0].kind != GROBO_JOB_EXIT) {
        grobo_i_stop_moves(robot);
    }
}
