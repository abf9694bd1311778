/* SPDX-License-Identifier: MIT */
/*
 * Joints that follow others: two servos on one shaft, or a finger that mirrors another one. Each
 * servo is a joint of the engine, read, judged, halted and read back like any other. What is here
 * makes one of them of two: requests are widened to both before they are looked at, a target sets
 * both, both get the same time, and both have the limits of the narrower one.
 *
 * Servos on one shaft (grobo_joint.apart_rad) are stopped at one place too, since two goals would
 * have them work against each other, and watched: a shaft is at one place, so that what is read of
 * one must lie where the other one was meanwhile.
 */
#include <math.h>

#include "src/base/instant.h"
#include "src/robot/couple.h"
#include "src/robot/robot.h"
#include "src/robot/state.h"

static const grobo_joint *joint_of(const grobo_robot *robot, int joint)
{
    return grobo_i_joint(robot->driver->model, joint);
}

/* The next of the joints that follow others, behind this one; n_joints: there is none. */
static int next_follower(const grobo_robot *robot, int after)
{
    int n = robot->driver->model->n_joints;
    int j = grobo_i_followers(robot) == 0 ? n : after + 1;
    while (j < n && !grobo_i_has(grobo_i_followers(robot), j)) {
        j++;
    }
    return j;
}

static int first_follower(const grobo_robot *robot)
{
    return next_follower(robot, -1);
}

static int n_joints(const grobo_robot *robot)
{
    return robot->driver->model->n_joints;
}

grobo_joint_mask grobo_i_find_coupled(const grobo_robot *robot, grobo_joint_mask joints)
{
    for (int f = first_follower(robot); f < n_joints(robot); f = next_follower(robot, f)) {
        joints |= grobo_i_has(joints, f) ? GROBO_JOINT_BIT(grobo_i_first(joint_of(robot, f))) : 0;
    }
    for (int f = first_follower(robot); f < n_joints(robot); f = next_follower(robot, f)) {
        joints |= grobo_i_has(joints, grobo_i_first(joint_of(robot, f))) ? GROBO_JOINT_BIT(f) : 0;
    }
    return joints;
}

bool grobo_i_find_alone(const grobo_robot *robot, grobo_joint_mask joints, int *joint)
{
    for (int f = first_follower(robot); f < n_joints(robot); f = next_follower(robot, f)) {
        if (grobo_i_has(joints, f) && !grobo_i_has(joints, grobo_i_first(joint_of(robot, f)))) {
            *joint = f;
            return true;
        }
    }
    return false;
}

void grobo_i_set_coupled(const grobo_robot *robot, grobo_posture *target)
{
    for (int f = first_follower(robot); f < n_joints(robot); f = next_follower(robot, f)) {
        const grobo_joint *joint = joint_of(robot, f);
        target->set &= ~GROBO_JOINT_BIT(f);
        if (grobo_i_has(target->set, grobo_i_first(joint))) {
            target->angle_rad[f] = target->angle_rad[grobo_i_first(joint)] * grobo_i_ratio(joint);
            target->set |= GROBO_JOINT_BIT(f);
        }
    }
}

void grobo_i_join_times(const grobo_robot *robot, grobo_target *target)
{
    for (int f = first_follower(robot); f < n_joints(robot); f = next_follower(robot, f)) {
        int first = grobo_i_first(joint_of(robot, f));
        if (grobo_i_has(target->posture.set, f) && grobo_i_has(target->posture.set, first)) {
            int64_t *time_us = target->joint_time_us;
            time_us[first] = time_us[f] = grobo_i_later(time_us[first], time_us[f]);
        }
    }
}

/* A frame of one servo alone sends it where the other one was just told to rest, unless that is
 * further from its own place, or where it would brake to, than servos on one shaft may be. */
static void rest_beside(const grobo_robot *robot, int joint, int other, const grobo_joint *pair,
                        grobo_posture *to)
{
    const grobo_robot_axis *beside = &robot->axes[other];
    double scale = joint == grobo_i_first(pair) ? 1 / grobo_i_ratio(pair) : grobo_i_ratio(pair);
    double rest_rad = beside->trajectory.to_rad * scale;
    bool rests = grobo_i_has(robot->halted_all, other) && !grobo_i_is_stray(beside);
    double off_rad = fmin(fabs(rest_rad - to->angle_rad[joint]),
                          fabs(rest_rad - robot->axes[joint].state.angle_rad));
    if (rests && off_rad <= grobo_i_apart(pair)) {
        to->angle_rad[joint] = rest_rad;
    }
}

void grobo_i_join_rest(const grobo_robot *robot, grobo_joint_mask may, grobo_target *target)
{
    for (int f = first_follower(robot); f < n_joints(robot); f = next_follower(robot, f)) {
        const grobo_joint *joint = joint_of(robot, f);
        grobo_joint_mask pair = GROBO_JOINT_BIT(f) | GROBO_JOINT_BIT(grobo_i_first(joint));
        grobo_posture *to = &target->posture;
        if (!(grobo_i_apart(joint) > 0) || (to->set & pair) == 0) {
            continue;
        }
        if ((may & pair) != pair) {
            bool first = grobo_i_has(to->set, grobo_i_first(joint));
            int one = first ? grobo_i_first(joint) : f, other = first ? f : grobo_i_first(joint);
            rest_beside(robot, one, other, joint, to);
            continue;
        }
        if (!grobo_i_has(to->set, grobo_i_first(joint))) {
            to->angle_rad[grobo_i_first(joint)] = to->angle_rad[f] / grobo_i_ratio(joint);
            target->joint_time_us[grobo_i_first(joint)] = target->joint_time_us[f];
        } else if (!grobo_i_has(to->set, f)) {
            target->joint_time_us[f] = target->joint_time_us[grobo_i_first(joint)];
        }
        to->angle_rad[f] = to->angle_rad[grobo_i_first(joint)] * grobo_i_ratio(joint);
        to->set |= pair;
    }
    grobo_i_join_times(robot, target);
}

/* The limits of its own servo, in angles of the joint that it is that many times. */
static void narrow(const grobo_robot *robot, int joint, double ratio, double *min_rad,
                   double *max_rad)
{
    const grobo_joint_state *state = &robot->axes[joint].state;
    if ((state->valid & GROBO_FIELD_RANGE) != 0) {
        double low_rad = state->low_rad / ratio, high_rad = state->high_rad / ratio;
        *min_rad = fmax(*min_rad, fmin(low_rad, high_rad));
        *max_rad = fmin(*max_rad, fmax(low_rad, high_rad));
    }
}

void grobo_i_couple_limits(const grobo_robot *robot, int joint, double *min_rad, double *max_rad)
{
    const grobo_joint *own = joint_of(robot, joint);
    bool follows = grobo_i_has(grobo_i_followers(robot), joint);
    int first = follows ? grobo_i_first(own) : joint;
    double to_first =
        follows ? 1 / grobo_i_ratio(own) : 1; /* from its angle to that of the first one */
    if (follows) {
        narrow(robot, first, to_first, min_rad, max_rad);
    }
    for (int f = first_follower(robot); f < n_joints(robot); f = next_follower(robot, f)) {
        if (f != joint && grobo_i_first(joint_of(robot, f)) == first) {
            narrow(robot, f, grobo_i_ratio(joint_of(robot, f)) * to_first, min_rad, max_rad);
        }
    }
}

/* A shaft that is read so soon after the other one has not turned meanwhile, but in a fast hand. */
#define AT_ONCE_US 50000

double grobo_i_apart_rad(const grobo_robot *robot, int follower, int read)
{
    const grobo_joint *joint = joint_of(robot, follower);
    int other = read == follower ? grobo_i_first(joint) : follower;
    const grobo_robot_axis *axis = &robot->axes[read], *beside = &robot->axes[other];
    bool told =
        beside->angle_us != GROBO_NEVER_US && (beside->state.valid & GROBO_FIELD_ANGLE) != 0;
    bool between = told && axis->before_us <= beside->angle_us;
    bool at_once = told && robot->now_us - beside->angle_us <= AT_ONCE_US;
    if ((read != follower && read != grobo_i_first(joint)) || (!between && !at_once)) {
        return NAN;
    }
    /* In angles of the one that follows: where the one just read was between its two readings. */
    double scale = read == follower ? 1 : grobo_i_ratio(joint);
    double beside_rad = beside->state.angle_rad * (read == follower ? grobo_i_ratio(joint) : 1);
    double b_rad = axis->state.angle_rad * scale;
    double a_rad = between ? axis->before_rad * scale : b_rad;
    return fmax(fmax(fmin(a_rad, b_rad) - beside_rad, beside_rad - fmax(a_rad, b_rad)), 0);
}

bool grobo_i_find_torn(const grobo_robot *robot, const grobo_posture *target, int *joint)
{
    for (int f = first_follower(robot); f < n_joints(robot); f = next_follower(robot, f)) {
        const grobo_joint *own = joint_of(robot, f);
        bool first = grobo_i_has(target->set, grobo_i_first(own)),
             second = grobo_i_has(target->set, f);
        double off_rad =
            target->angle_rad[f] - target->angle_rad[grobo_i_first(own)] * grobo_i_ratio(own);
        if (grobo_i_apart(own) > 0 &&
            (first != second || (first && fabs(off_rad) > grobo_i_apart(own)))) {
            *joint = f;
            return true;
        }
    }
    return false;
}
