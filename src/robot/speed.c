/* SPDX-License-Identifier: MIT */
/*
 * Where a target may be, and how long a joint needs at least to get there: the limits and speeds
 * that the gate holds every order to.
 */
#include <math.h>

#include "src/base/angle.h"
#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/lines.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/speed.h"
#include "src/robot/weight.h"

/* ---- numbers and limits ---------------------------------------------------------------------- */

/* Draws a joint in that would go further than its servo lets it. */
static bool draw_in(const grobo_robot *robot, int joint, double *angle_rad)
{
    if ((robot->axes[joint].state.valid & GROBO_FIELD_RANGE) == 0 &&
        grobo_i_followers(robot) == 0) {
        return false;
    }
    const grobo_i_limits limits = grobo_i_joint_limits(robot, joint);
    double inside_rad = fmin(fmax(*angle_rad, limits.min_rad), limits.max_rad);
    bool beyond = grobo_ddeg_from_rad(*angle_rad) != grobo_ddeg_from_rad(inside_rad);
    *angle_rad = beyond ? inside_rad : *angle_rad;
    return beyond;
}

/* As grobo_posture_check() and _clamp(), of the limits that hold. */
int grobo_i_target_check(const grobo_robot *robot, const grobo_posture *target, int *joint)
{
    int result = grobo_posture_check(target, robot->driver->model, joint);
    for (int j = 0; result >= 0 && j < target->n_joints; j++) {
        double angle_rad = target->angle_rad[j];
        if (grobo_i_has(target->set, j) && draw_in(robot, j, &angle_rad)) {
            *joint = j;
            result = GROBO_ERR_LIMIT;
        }
    }
    return result;
}

int grobo_i_target_clamp(const grobo_robot *robot, grobo_posture *target)
{
    int clamped = grobo_posture_clamp(target, robot->driver->model);
    for (int j = 0; clamped >= 0 && j < target->n_joints; j++) {
        clamped += grobo_i_has(target->set, j) && draw_in(robot, j, &target->angle_rad[j]);
    }
    return clamped;
}

int grobo_i_gate_target(grobo_robot *robot, grobo_posture *target)
{
    int joint = -1;
    grobo_i_couple(robot, target);
    int result = grobo_i_target_check(robot, target, &joint);
    if (result == GROBO_ERR_LIMIT && robot->config.limit_policy == GROBO_LIMIT_CLAMP) {
        int clamped = grobo_i_target_clamp(robot, target);
        if (clamped >= 0) {
            robot->counters.clamped += (unsigned)clamped;
            return GROBO_OK;
        }
        result = clamped; /* a joint behind the first one has no number at all */
        joint = -1;
    }
    robot->fault_joint = joint;
    robot->fault_deg = joint >= 0 ? grobo_deg_from_rad(target->angle_rad[joint]) : 0;
    return result;
}

/* ---- speed ----------------------------------------------------------------------------------- */

void grobo_i_gate_soften(grobo_robot *robot)
{
    robot->soft = true;
    robot->soft_us = GROBO_NEVER_US;
}

/* Who times targets of his own may be early by this. */
#define EARLY_US 10000

void grobo_i_gate_single(grobo_robot *robot)
{
    if (robot->now_us >= robot->soft_us - EARLY_US) {
        robot->soft = false; /* where the first target was, it is by now */
    }
}

double grobo_i_speed_limit(const grobo_robot *robot, int joint, bool soft)
{
    double most = grobo_i_joint(robot->driver->model, joint)->max_speed_rad_s;
    double limit_rad_s = most * robot->config.speed_limit_pct / 100;
    double approach_rad_s = grobo_rad_from_deg(robot->config.approach_dps);
    return soft ? fmin(approach_rad_s, limit_rad_s) : limit_rad_s;
}

/* Where a trajectory begins: one to rest where the joint is, any other where the trajectory
 * before is by now. */
double grobo_i_begin_of(const grobo_robot *robot, const grobo_robot_order *order, int joint)
{
    bool halts = order->kind == GROBO_I_ORDER_HALT || order->rests;
    return halts && !grobo_i_hangs_in_goal(robot, joint)
               ? grobo_i_axis_place(robot, joint) + grobo_i_load_kept(&robot->axes[joint])
               : grobo_i_axis_commanded(&robot->axes[joint], robot->now_us);
}

/* The least time from there, in microseconds. */
double grobo_i_trajectory_us(const grobo_robot *robot, int joint, double from_rad, double to_rad,
                             bool soft)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    /* Angles are rounded on the wire: that much further is not faster. */
    double way_rad =
        fmax(fabs(to_rad - from_rad) - grobo_i_driver_of(robot, joint)->angle_step_rad, 0);
    double time_us = way_rad / grobo_i_speed_limit(robot, joint, soft) * 1e6;
    /* One that moves goes on until the frame is there. */
    return soft && axis->trajectory.to_us > robot->now_us ? fmax(time_us, GROBO_I_HALT_TIME_US)
                                                          : time_us;
}

/* In the wire's unit; GROBO_NEVER_US where the wire has no time that is long enough. */
static int64_t on_time_grid(const grobo_robot *robot, int joint, double needed_us)
{
    int64_t step_us = grobo_i_driver_of(robot, joint)->time_step_us;
    double steps = fmax(ceil(needed_us / (double)step_us), 1);
    double most = (double)(grobo_i_driver_of(robot, joint)->time_max_us / step_us);
    return steps > most ? GROBO_NEVER_US : (int64_t)steps * step_us;
}

/* The same in the wire's unit. */
static int64_t time_needed(const grobo_robot *robot, int joint, double from_rad, double to_rad,
                           bool soft)
{
    return on_time_grid(robot, joint, grobo_i_trajectory_us(robot, joint, from_rad, to_rad, soft));
}

int64_t grobo_i_gate_soft_us(const grobo_robot *robot, const grobo_posture *target)
{
    int64_t longest_us = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(target->set, j)) {
            double from_rad = grobo_i_axis_commanded(&robot->axes[j], robot->now_us);
            int64_t us = time_needed(robot, j, from_rad, target->angle_rad[j], true);
            longest_us = grobo_i_later(longest_us, us);
        }
    }
    return longest_us;
}

/* What stops a joint never asks for more than its speed from where it was read, either, where no
 * reading shows that it has begun its trajectory: the frame may be lost. For a halt any reading
 * since does. Of a stream the next frame makes good a lost one, so that a soft stop keeps its
 * time. The end of a motion gives a joint the time to brake. */
static int64_t time_of_order(const grobo_robot *robot, const grobo_robot_order *order, int joint,
                             double to_rad)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double from_rad = grobo_i_begin_of(robot, order, joint);
    int64_t needed_us = time_needed(robot, joint, from_rad, to_rad, robot->soft || order->soft);
    bool halts = order->kind == GROBO_I_ORDER_HALT && axis->seen_us < axis->told_us;
    bool at_once = axis->next_time_us < GROBO_I_HALT_TIME_US;
    bool alone = axis->trajectory.to_us - axis->trajectory.from_us >
                 GROBO_I_HALT_TIME_US; /* no next one soon */
    bool rests = order->rests && (at_once || alone);
    if (halts || (rests && axis->seen_us < axis->told_us + GROBO_I_BEGUN_US)) {
        from_rad = axis->seen_rad + grobo_i_load_kept(axis);
        int64_t unsure_us = time_needed(robot, joint, from_rad, to_rad, false);
        needed_us = grobo_i_later(needed_us, unsure_us);
    }
    double brake_us = order->rests ? grobo_i_axis_brake_us(robot, joint) : 0;
    return brake_us > 0 ? grobo_i_later(needed_us, on_time_grid(robot, joint,
                                                                brake_us + GROBO_I_HALT_LEAST_US))
                        : needed_us;
}

/* True where this time, a multiple of the wire's unit, is surely enough at full speed: without the
 * divisions of time_needed(), which are most of what a frame costs a processor that has none. What
 * is closer than the rounding of both is left to that. */
static bool is_ample(const grobo_robot *robot, int joint, double to_rad, grobo_i_span asked)
{
    double most_rad_s = grobo_i_joint(robot->driver->model, joint)->max_speed_rad_s;
    double from_rad = grobo_i_axis_commanded(&robot->axes[joint], robot->now_us);
    return grobo_i_gets_there(from_rad, to_rad, most_rad_s, asked);
}

/* All joints get the longest time, each in the unit of its wire. */
static void time_alike(const grobo_robot *robot, grobo_target *target, int64_t longest_us)
{
    bool one_unit = grobo_i_lines(robot) == 1;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        target->joint_time_us[j] =
            one_unit ? longest_us : on_time_grid(robot, j, (double)longest_us);
    }
}

int grobo_i_gate_time(grobo_robot *robot, const grobo_robot_order *order, grobo_target *target)
{
    bool soft = robot->soft || order->soft;
    /* Its times, as they were asked for; from where it is by its trajectory. */
    bool on_grid = order->kind == GROBO_I_ORDER_GOAL && !order->rests;
    bool stretched = false;
    int64_t longest_us = 0, asked_us = -1;
    grobo_i_span asked = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (!grobo_i_has(target->posture.set, j)) {
            continue;
        }
        double to_rad = target->posture.angle_rad[j];
        int64_t *time_us = &target->joint_time_us[j];
        if (*time_us != asked_us) {
            asked_us = *time_us;
            longest_us = grobo_i_later(longest_us, asked_us);
            bool may = on_grid && !soft && asked_us <= grobo_i_driver_of(robot, j)->time_max_us;
            asked = may ? grobo_i_span_of(asked_us, robot->config.speed_limit_pct) : 0;
        }
        if (asked > 0 && is_ample(robot, j, to_rad, asked)) {
            continue;
        }
        int64_t needed_us = time_of_order(robot, order, j, to_rad);
        if (needed_us == GROBO_NEVER_US) {
            robot->fault_joint = j;
            return GROBO_ERR_SPEED;
        }
        stretched = stretched || needed_us > *time_us;
        *time_us = grobo_i_later(needed_us, *time_us);
        longest_us = grobo_i_later(longest_us, *time_us);
    }
    robot->counters.stretched += stretched;
    grobo_i_couple_times(robot, target);
    if (!order->each) {
        time_alike(robot, target, longest_us);
    }
    return GROBO_OK;
}
