/* SPDX-License-Identifier: MIT */
/* Joints that follow others (couple.c). */
#ifndef GROBO_ROBOT_COUPLE_I_H
#define GROBO_ROBOT_COUPLE_I_H

#include <grobo/core/static.h>

/* Joints that follow others (grobo_joint.ratio); a build for plain drivers has none. */
static inline grobo_joint_mask grobo_i_followers(const grobo_robot *robot)
{
    return GROBO_DRIVERS_PLAIN ? 0 : robot->followers;
}
/* These, those that they follow, and those that follow them. */
grobo_joint_mask grobo_i_find_coupled(const grobo_robot *robot, grobo_joint_mask joints);
static inline grobo_joint_mask grobo_i_coupled(const grobo_robot *robot, grobo_joint_mask joints)
{
    return grobo_i_followers(robot) == 0 ? joints : grobo_i_find_coupled(robot, joints);
}
/* True if these contain a joint without the one that it follows, *joint. */
bool grobo_i_find_alone(const grobo_robot *robot, grobo_joint_mask joints, int *joint);
static inline bool grobo_i_follows_alone(const grobo_robot *robot, grobo_joint_mask joints,
                                         int *joint)
{
    return grobo_i_followers(robot) != 0 && grobo_i_find_alone(robot, joints, joint);
}
/* Sets the joints that follow those of a target, and no others of them. */
void grobo_i_set_coupled(const grobo_robot *robot, grobo_posture *target);
static inline void grobo_i_couple(const grobo_robot *robot, grobo_posture *target)
{
    if (grobo_i_followers(robot) != 0) {
        grobo_i_set_coupled(robot, target);
    }
}
/* Gives a joint and the one that it follows the same time. */
void grobo_i_join_times(const grobo_robot *robot, grobo_target *target);
static inline void grobo_i_couple_times(const grobo_robot *robot, grobo_target *target)
{
    if (grobo_i_followers(robot) != 0) {
        grobo_i_join_times(robot, target);
    }
}
/* Servos on one shaft come to rest at one place: those of `may`, where one of them is told to; one
 * that gets a frame of its own, where the other one was told to. */
void grobo_i_join_rest(const grobo_robot *robot, grobo_joint_mask may, grobo_target *target);
static inline void grobo_i_couple_rest(const grobo_robot *robot, grobo_joint_mask may,
                                       grobo_target *target)
{
    if (grobo_i_followers(robot) != 0) {
        grobo_i_join_rest(robot, may, target);
    }
}
/* True if a raw frame that moves these so would tear servos on one shaft apart; *joint: which. */
bool grobo_i_find_torn(const grobo_robot *robot, const grobo_posture *target, int *joint);
static inline bool grobo_i_tears(const grobo_robot *robot, const grobo_posture *target, int *joint)
{
    return grobo_i_followers(robot) != 0 && grobo_i_find_torn(robot, target, joint);
}
/* Narrows the limits of a joint to those of the joints that it moves with. */
void grobo_i_couple_limits(const grobo_robot *robot, int joint, double *min_rad, double *max_rad);
/* How far a joint that follows is from where it should be, by the reading of it or of the other one
 * that just came; NaN where they tell nothing of that. */
double grobo_i_apart_rad(const grobo_robot *robot, int follower, int read);

#endif
