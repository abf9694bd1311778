/* SPDX-License-Identifier: MIT */
/*
 * Wheels that turn. A speed that was asked for holds for GROBO_DRIVE_US. Meanwhile a frame every
 * 100 ms tells it again, so that one that is lost is made up for, and one every 50 ms leads to it
 * from the speed before. Where nobody asks anew in time the wheel is halted: told to stand, read
 * back until it does, and told again where it does not (halted.c).
 */
#include <math.h>
#include <string.h>

#include <grobo/core/wheel.h>

#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/budget.h"
#include "src/robot/lines.h"
#include "src/robot/orders.h"
#include "src/robot/query.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/speed.h"
#include "src/robot/stand.h"
#include "src/robot/turn.h"
#include "src/robot/wheel.h"

grobo_joint_mask grobo_model_wheels(const grobo_model *model)
{
    grobo_joint_mask wheels = 0;
    for (int j = 0; model != NULL && j < model->n_joints; j++) {
        wheels |= grobo_i_joint_is_wheel(model, j) ? GROBO_JOINT_BIT(j) : 0;
    }
    return wheels;
}

#if GROBO_DRIVERS_PLAIN

int grobo_robot_drive(grobo_robot *robot, grobo_joint_mask wheels, const double *rad_s)
{
    (void)wheels;
    return robot == NULL || rad_s == NULL ? GROBO_ERR_ARG : GROBO_ERR_UNSUPPORTED;
}

int grobo_robot_wheel(const grobo_robot *robot, int joint, grobo_wheel_info *info)
{
    (void)joint;
    return robot == NULL || info == NULL ? GROBO_ERR_ARG : GROBO_ERR_UNSUPPORTED;
}

#else

/* How often wheels are told their speeds again, and on the way to another speed. */
#define TELL_US 100000
#define RAMP_US 50000
/* A speed asked for anew waits no longer than that for its frame. */
#define LEAST_US 20000
/* Frames of wheels have this part of the line's time at most; one must be over by a part of the
 * time that a speed holds for, with a reading of all. */
#define LINE_PART 4
#define HOLD_PART 4

/* How long the frames for these wheels have their line. */
static uint32_t frames_on(const grobo_robot *robot, int line, grobo_joint_mask wheels)
{
    static const double still[GROBO_JOINTS_MAX];
    const grobo_driver *driver = robot->driver;
    uint32_t us = 0;
    int more = wheels != 0;
    for (int part = 0; more > 0 && part < GROBO_ROBOT_SLOTS; part++) {
        grobo_exchange exchange;
        memset(&exchange, 0, offsetof(grobo_exchange, frame));
        more = driver->speed(driver, robot->driver_ctx, wheels, still, part, &exchange);
        us += more > 0 ? grobo_i_line_us(grobo_i_bus_read(robot, line), &exchange) : 0;
    }
    return us;
}

/* Of the line that has them for longest: lines have their frames at the same time. */
static uint32_t frames_us(const grobo_robot *robot, grobo_joint_mask wheels)
{
    uint32_t most_us = 0;
    for (int i = 0; i < grobo_i_lines(robot); i++) {
        uint32_t us = frames_on(robot, i, wheels & grobo_i_joints_on(robot, i));
        most_us = us > most_us ? us : most_us;
    }
    return most_us;
}

/* ---- the request ----------------------------------------------------------------------------- */

/* Jobs that have the robot for themselves. */
static bool is_alone(const grobo_robot_task *job)
{
    return job->kind == GROBO_JOB_EXIT || job->kind == GROBO_JOB_ESTOP ||
           job->kind == GROBO_JOB_COMMAND || job->kind == GROBO_JOB_STORED ||
           job->kind == GROBO_JOB_CHECK;
}

static int fail(grobo_robot *robot, int joint, double rad_s, int error)
{
    robot->fault_joint = joint;
    robot->fault_deg = grobo_deg_from_rad(rad_s);
    return error;
}

/* A wheel that is to turn must have been read, hold, and be within its limit. */
static int admit_wheel(grobo_robot *robot, int joint, double *rad_s)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double most_rad_s = grobo_i_speed_limit(robot, joint, false);
    if (!isfinite(*rad_s)) {
        return fail(robot, joint, 0, GROBO_ERR_NAN);
    }
    if (fabs(*rad_s) > most_rad_s * (1 + 1e-9)) {
        if (robot->config.limit_policy == GROBO_LIMIT_REFUSE) {
            return fail(robot, joint, *rad_s, GROBO_ERR_LIMIT);
        }
        *rad_s = copysign(most_rad_s, *rad_s);
        robot->counters.clamped++;
    }
    return *rad_s == 0 ? GROBO_OK
           : !grobo_i_is_sensed(axis)
               ? fail(robot, joint, *rad_s,
                      axis->status == GROBO_ERR_SETUP ? GROBO_ERR_SETUP : GROBO_ERR_STALE)
           : !grobo_i_axis_is_on(axis) ? fail(robot, joint, *rad_s, GROBO_ERR_STATE)
                                       : GROBO_OK;
}

static int admit(grobo_robot *robot, grobo_joint_mask wheels)
{
    if (wheels == 0 || (wheels & ~grobo_i_all_joints(robot)) != 0) {
        return GROBO_ERR_ARG;
    }
    if ((wheels & ~robot->wheels) != 0) {
        return fail(robot, grobo_i_lowest(wheels & ~robot->wheels), 0, GROBO_ERR_UNSUPPORTED);
    }
    robot->fault_joint = -1;
    return !robot->link                        ? GROBO_ERR_CLOSED
           : grobo_i_is_latched(robot)         ? GROBO_ERR_LATCHED
           : grobo_i_jobs_any(robot, is_alone) ? GROBO_ERR_STATE
           : (wheels & robot->halts_owed) != 0 ? GROBO_ERR_STATE
                                               : GROBO_OK;
}

/* True if the line carries the frames of all wheels and a reading often enough. */
static bool line_fits(const grobo_robot *robot)
{
    uint32_t reading_us = 0;
    const grobo_i_line line = grobo_i_line_of_robot(robot);
    (void)grobo_i_reading_cost(&line, &reading_us);
    return (frames_us(robot, robot->wheels) + reading_us) * HOLD_PART <= GROBO_DRIVE_US;
}

int grobo_robot_drive(grobo_robot *robot, grobo_joint_mask wheels, const double *rad_s)
{
    double checked[GROBO_JOINTS_MAX];
    if (robot == NULL || rad_s == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = admit(robot, wheels);
    for (int j = 0; result >= 0 && j < robot->driver->model->n_joints; j++) {
        checked[j] = rad_s[j];
        result = grobo_i_has(wheels, j) ? admit_wheel(robot, j, &checked[j]) : result;
    }
    if (result >= 0 && !line_fits(robot)) {
        result = GROBO_ERR_UNWATCHED;
    }
    for (int j = 0; result >= 0 && j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(wheels, j)) {
            bool anew = axis->asked_rad_s != checked[j];
            axis->asked_rad_s = checked[j];
            axis->asked_until_us = robot->now_us + GROBO_DRIVE_US;
            robot->wheels_us =
                anew ? grobo_i_sooner(robot->wheels_us, robot->wheels_told_us + LEAST_US)
                     : robot->wheels_us;
        }
    }
    grobo_i_end(robot);
    return result < 0 ? result : GROBO_OK;
}

int grobo_robot_wheel(const grobo_robot *robot, int joint, grobo_wheel_info *info)
{
    if (robot == NULL || info == NULL || joint < 0 || joint >= robot->driver->model->n_joints) {
        return GROBO_ERR_ARG;
    }
    if (!grobo_i_is_wheel(robot, joint)) {
        return GROBO_ERR_UNSUPPORTED;
    }
    grobo_i_lock(robot);
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool asked = axis->asked_until_us > grobo_i_now(robot);
    info->asked_rad_s = asked ? axis->asked_rad_s : 0;
    info->told_rad_s = axis->told_rad_s;
    info->left_us = asked && axis->asked_rad_s != 0 ? axis->asked_until_us - grobo_i_now(robot) : 0;
    info->stands = grobo_i_stands(robot, joint) && !grobo_i_wheel_is_told(axis);
    grobo_i_unlock(robot);
    return GROBO_OK;
}

/* ---- in time --------------------------------------------------------------------------------- */

static bool is_driven(const grobo_robot_axis *axis)
{
    return axis->asked_rad_s != 0 || axis->told_rad_s != 0;
}

/* Wheels that turn, or are on the way to rest. */
static grobo_joint_mask driven(const grobo_robot *robot)
{
    grobo_joint_mask wheels = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        bool is = grobo_i_is_wheel(robot, j) && is_driven(&robot->axes[j]);
        wheels |= is ? GROBO_JOINT_BIT(j) : 0;
    }
    return wheels;
}

/* Those that nobody has asked for in time. */
static grobo_joint_mask ended(const grobo_robot *robot)
{
    grobo_joint_mask wheels = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool is = grobo_i_is_wheel(robot, j) && axis->asked_rad_s != 0 &&
                  axis->asked_until_us <= robot->now_us;
        wheels |= is ? GROBO_JOINT_BIT(j) : 0;
    }
    return wheels;
}

static bool are_on_ramp(const grobo_robot *robot, grobo_joint_mask wheels)
{
    bool are = false;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        are = are || (grobo_i_has(wheels, j) && axis->asked_rad_s != axis->told_rad_s);
    }
    return are;
}

/* A halt that waits is not overtaken, and no frame waits behind another one. */
static bool is_busy(const grobo_robot *robot)
{
    return grobo_i_slots_busy(robot, GROBO_I_USE_SPEED) ||
           grobo_i_slots_busy(robot, GROBO_I_USE_HALT);
}

void grobo_i_wheels_step(grobo_robot *robot)
{
    if (robot->wheels == 0) {
        return;
    }
    grobo_joint_mask over = ended(robot);
    if (over != 0) {
        grobo_i_gate_halt(robot, over);
    }
    grobo_joint_mask wheels = driven(robot);
    if (wheels == 0 || robot->wheels_us > robot->now_us || is_busy(robot)) {
        return;
    }
    int64_t least_us = LINE_PART * (int64_t)frames_us(robot, wheels);
    int64_t next_us = are_on_ramp(robot, wheels) ? RAMP_US : TELL_US;
    robot->wheels_told_us = robot->now_us;
    robot->wheels_us = robot->now_us + grobo_i_later(next_us, least_us);
    grobo_i_gate_speeds(robot, wheels);
}

int64_t grobo_i_wheels_deadline(const grobo_robot *robot)
{
    int64_t at_us = GROBO_NEVER_US;
    if (robot->wheels == 0) {
        return at_us;
    }
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_is_wheel(robot, j) && axis->asked_rad_s != 0) {
            at_us = grobo_i_sooner(at_us, axis->asked_until_us);
        }
    }
    return driven(robot) != 0 && !is_busy(robot) ? grobo_i_sooner(at_us, robot->wheels_us) : at_us;
}

/* ---- the line -------------------------------------------------------------------------------- */

void grobo_i_wheels_link(grobo_robot *robot, bool up)
{
    if (up && robot->wheels_owed != 0) {
        grobo_joint_mask wheels = robot->wheels_owed;
        robot->wheels_owed = 0;
        grobo_i_gate_halt(robot, wheels);
    }
    for (int j = 0; !up && j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_is_wheel(robot, j)) {
            bool turned = !grobo_i_axis_is_limp(axis) &&
                          (grobo_i_wheel_is_told(axis) || grobo_i_wheel_is_seen(axis));
            robot->wheels_owed |= turned ? GROBO_JOINT_BIT(j) : 0;
            axis->asked_rad_s = axis->told_rad_s = 0;
            axis->stalled_us = GROBO_NEVER_US;
        }
    }
}

#endif
