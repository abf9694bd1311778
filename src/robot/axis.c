/* SPDX-License-Identifier: MIT */
/* Where a joint is, by what it was sent to and by what was read last. */
#include <math.h>
#include <stdlib.h>

#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/model/joint.h"
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/gate.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/state.h"
#include "src/robot/wheel.h"

/* The goals of a trajectory are on the wire's grid: this part of its step is no other goal. */
#define SAME_GOAL_STEPS 0.6

double grobo_i_same_goal_rad(const grobo_robot *robot, int joint)
{
    return SAME_GOAL_STEPS * grobo_i_driver_of(robot, joint)->angle_step_rad;
}

double grobo_i_trajectory_at(const grobo_robot_trajectory *trajectory, int64_t now_us)
{
    int64_t at_us = grobo_i_later(now_us, trajectory->from_us);
    if (at_us >= trajectory->to_us) {
        return trajectory->to_rad;
    }
    double part =
        (double)(at_us - trajectory->from_us) / (double)(trajectory->to_us - trajectory->from_us);
    return trajectory->from_rad + (trajectory->to_rad - trajectory->from_rad) * part;
}

/* The set point of a joint that was sent nowhere: beside the angle by the error that carries it. A
 * servo that reports the time of its trajectory, and that this is over, has it at its goal. */
static double set_point(const grobo_robot_axis *axis)
{
    const grobo_joint_state *state = &axis->state;
    double angle_rad = state->angle_rad + grobo_i_load(axis);
    bool over = (state->valid & GROBO_FIELD_TIME) != 0 && state->time_us >= state->goal_time_us;
    if (!over || state->goal_rad == state->angle_rad || !grobo_i_axis_is_on(axis)) {
        return angle_rad;
    }
    double most_rad = grobo_i_is_stray(axis) ? GROBO_I_HANGS_RAD : GROBO_I_OFF_TRAJECTORY_RAD;
    bool known = axis->goal_us == axis->angle_us || /* or nobody else has sent it elsewhere since */
                 (grobo_i_has_target(axis) &&       /* and it stands there yet, or again */
                  (grobo_i_is_stray(axis) ? state->speed_dps == 0 : grobo_i_goal_is_told(axis)));
    return known && grobo_i_near_rad(state->goal_rad, state->angle_rad, most_rad) ? state->goal_rad
                                                                                  : angle_rad;
}

double grobo_i_axis_commanded(const grobo_robot_axis *axis, int64_t now_us)
{
    if (grobo_i_is_stray(axis)) {
        const grobo_robot_trajectory own = {axis->state.angle_rad, axis->state.goal_rad,
                                            axis->angle_us, axis->own_until_us};
        return axis->own_until_us > axis->angle_us ? grobo_i_trajectory_at(&own, now_us)
                                                   : set_point(axis);
    }
    int64_t at_us =
        grobo_i_is_in_segments(axis) ? grobo_i_sooner(now_us, axis->told_to_us) : now_us;
    return grobo_i_trajectory_at(&axis->trajectory, at_us);
}

int64_t grobo_i_axis_until(const grobo_robot_axis *axis)
{
    return grobo_i_is_stray(axis) ? axis->own_until_us : axis->trajectory.to_us;
}

/* One that is so near the end of its trajectory is there. */
#define LAGS_RAD (1 * 0.017453292519943295)

/* Where a joint is, and how fast it turns. */
typedef struct course {
    double at_rad, rad_s;
} course;

/* Who goes where nobody knows is not believed to do so for longer. */
#define GOES_ON_S 0.2

static course go_on(course c, double time_s)
{
    c.at_rad += c.rad_s * time_s;
    return c;
}

/* It changes its speed to another one, which takes time. */
static course speed_up(course c, double to_rad_s, double accel_rad_s2, double time_s)
{
    double change_s = fmin(fabs(to_rad_s - c.rad_s) / accel_rad_s2, time_s);
    double change_rad_s = copysign(accel_rad_s2, to_rad_s - c.rad_s) * change_s;
    c.at_rad += (c.rad_s + change_rad_s / 2) * change_s;
    c.rad_s += change_rad_s;
    return go_on(c, time_s - change_s);
}

static double seconds(int64_t from_us, int64_t to_us)
{
    return to_us > from_us ? (double)(to_us - from_us) / 1e6 : 0;
}

/* True of one whose goal is known, be it the one it was sent to, where it may stand by now, or that
 * its servo told of. */
static bool is_guided(const grobo_robot_axis *axis)
{
    return grobo_i_is_stray(axis) ? axis->own_until_us > axis->angle_us : grobo_i_has_target(axis);
}

/* 0 of a trajectory that leads nowhere, whatever its time. */
static double trajectory_speed(const grobo_robot_trajectory *trajectory)
{
    double way_rad = fabs(trajectory->to_rad - trajectory->from_rad);
    return way_rad > 0 ? way_rad / seconds(trajectory->from_us, trajectory->to_us) : 0;
}

static bool tells_speed(const grobo_robot_axis *axis)
{
    return axis->seen_dps != GROBO_I_NO_SPEED;
}

/* What was read last. A speed that is too high for the joint was misread. */
#define MISREAD_PART 1.5

static course seen(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double most_rad_s = MISREAD_PART * grobo_i_joint(robot->driver->model, joint)->max_speed_rad_s;
    double rad_s = tells_speed(axis) ? grobo_rad_from_deg(axis->seen_dps) : 0;
    return (course){axis->seen_rad, copysign(fmin(fabs(rad_s), most_rad_s), rad_s)};
}

/* A speed as it is kept. */
static int16_t dps_of(int32_t dps)
{
    return (int16_t)(dps < -INT16_MAX ? -INT16_MAX : dps > INT16_MAX ? INT16_MAX : dps);
}

/* Between angles so far apart lies a speed. */
#define APART_S 0.01

/* An angle alone would hide that a joint turns; but of one that nobody here has sent it shows where
 * it does not go as it was read to. */
static void see_angle(grobo_robot_axis *axis, int64_t asked_us, double angle_rad)
{
    double time_s = seconds(axis->seen_us, asked_us);
    if (grobo_i_has_target(axis) || time_s < APART_S) {
        return;
    }
    double mean_dps = grobo_deg_from_rad(angle_rad - axis->seen_rad) / time_s;
    if (fabs(mean_dps - axis->seen_dps) > abs(axis->seen_dps) / 2.0) {
        axis->seen_rad = angle_rad;
        axis->seen_us = asked_us;
        axis->seen_dps = dps_of((int32_t)lround(mean_dps));
    }
}

void grobo_i_axis_seen(grobo_robot_axis *axis, int64_t asked_us, const grobo_joint_state *got)
{
    bool told = (got->valid & GROBO_FIELD_SPEED) != 0;
    bool known = tells_speed(axis) && axis->seen_us >= axis->told_us &&
                 seconds(axis->seen_us, asked_us) < GOES_ON_S;
    if (known && !told) {
        if (!GROBO_DRIVERS_PLAIN) {
            see_angle(axis, asked_us, got->angle_rad);
        }
        return;
    }
    axis->seen_rad = got->angle_rad;
    axis->seen_us = asked_us;
    axis->seen_dps = told ? dps_of(got->speed_dps) : GROBO_I_NO_SPEED;
}

bool grobo_i_axis_tells_turn(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    return !GROBO_DRIVERS_PLAIN && tells_speed(axis) && (axis->state.valid & GROBO_FIELD_TIME) == 0;
}

/* The speed that the frame of its trajectory asked for. Where that trajectory leads nowhere,
 * drivers have a joint go the rest of the trajectory before at the approach speed. */
static double told_speed(const grobo_robot *robot, int joint)
{
    const grobo_robot_trajectory *trajectory = &robot->axes[joint].trajectory;
    return fabs(trajectory->to_rad - trajectory->from_rad) <
                   grobo_i_driver_of(robot, joint)->angle_step_rad
               ? grobo_i_driver_of(robot, joint)->limits.approach_rad_s
               : trajectory_speed(trajectory);
}

/* The loop of a servo that carries a load is so late behind its ramp. */
#define LOOP_S 0.15

/* Of a servo with ramps that tells its speed: from there and then to the speed of its
 * trajectory, and to rest at its end. */
static course on_ramps(const grobo_robot *robot, int joint, int64_t now_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_robot_trajectory *trajectory = &axis->trajectory;
    double accel_rad_s2 = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), accel_rad_s2);
    double wanted_rad_s = told_speed(robot, joint);
    course c = seen(robot, joint);
    int64_t seen_us = axis->seen_us;
    double end_rad = grobo_i_is_in_segments(axis)
                         ? grobo_i_trajectory_at(trajectory, axis->told_to_us)
                         : trajectory->to_rad;
    end_rad -= grobo_i_load(axis);
    double loop_s = grobo_i_load(axis) != 0 ? LOOP_S : 0;
    if ((seconds(trajectory->from_us, seen_us) - loop_s) * accel_rad_s2 > 2 * wanted_rad_s) {
        wanted_rad_s = fmin(wanted_rad_s, fabs(c.rad_s)); /* too weak to be as fast by then */
    }
    c = go_on(c, fmin(seconds(seen_us, trajectory->from_us), GOES_ON_S));
    double left_rad = end_rad - c.at_rad;
    wanted_rad_s = left_rad == 0 ? 0 : copysign(wanted_rad_s, left_rad);
    c = speed_up(c, wanted_rad_s, accel_rad_s2,
                 seconds(grobo_i_later(seen_us, trajectory->from_us), now_us));
    double still_rad = copysign(end_rad - c.at_rad, (end_rad - c.at_rad) * left_rad);
    if (c.rad_s * left_rad <= 0) {
        return c;
    }
    double most_rad_s = sqrt(2 * accel_rad_s2 * fmax(still_rad, 0)); /* that it still can brake */
    c.rad_s = copysign(fmin(fabs(c.rad_s), most_rad_s), left_rad);
    c.at_rad = still_rad <= 0 ? end_rad : c.at_rad;
    return c;
}

/* How far a joint can have come since it was read: at the speed of its trajectory, or the one it
 * was read to have; at its most where it was told since. */
static double most_since(const grobo_robot *robot, int joint, int64_t now_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double rad_s = grobo_i_joint(robot->driver->model, joint)->max_speed_rad_s;
    if (axis->seen_us >= axis->trajectory.from_us) {
        rad_s = fmax(trajectory_speed(&axis->trajectory), fabs(seen(robot, joint).rad_s));
    }
    return rad_s * seconds(axis->seen_us, now_us);
}

/* Where the trajectory is by now, but not further than the joint can have come. One that is
 * before its trajectory comes along it, too. */
static double along(const grobo_robot *robot, int joint, int64_t now_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double way_rad = grobo_i_axis_commanded(axis, now_us) - grobo_i_load(axis);
    double most_rad = most_since(robot, joint, now_us);
    double end_rad = axis->trajectory.to_rad - grobo_i_load(axis);
    bool before = (way_rad - axis->seen_rad) * (end_rad - axis->seen_rad) < 0 &&
                  axis->seen_us >= axis->trajectory.from_us;
    double left_rad = (before ? end_rad : way_rad) - axis->seen_rad;
    return axis->seen_rad + copysign(fmin(fabs(left_rad), most_rad), left_rad);
}

/* Between two angles lies the speed of a servo that tells none: so long, at most. A goal that was
 * read meanwhile is that of its way. */
#define MEANWHILE_US 500000

/* One that nobody here has sent goes no further than the goal that its servo told of with that. */
static bool tells_end(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool mean = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed);
    int64_t before_us = mean ? MEANWHILE_US : 0;
    return axis->goal_us != GROBO_NEVER_US && axis->goal_us + before_us >= axis->angle_us;
}

/* Of a servo that tells how it turns, and of which no trajectory or its ramps are known. */
static course turning(const grobo_robot *robot, int joint, int64_t now_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if (is_guided(axis)) {
        return on_ramps(robot, joint, now_us);
    }
    double end_rad = axis->state.goal_rad - grobo_i_load(axis);
    course c = go_on(seen(robot, joint), fmin(seconds(axis->seen_us, now_us), GOES_ON_S));
    bool mean = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed);
    bool at_end = mean && /* its speed is of before that */
                  fabs(end_rad - axis->seen_rad) <= grobo_i_same_goal_rad(robot, joint);
    bool passes = (end_rad - axis->seen_rad) * (end_rad - c.at_rad) < 0;
    bool there = tells_end(robot, joint) && (at_end || passes);
    return there ? (course){end_rad, 0} : c;
}

static bool has_course(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool known =
        !is_guided(axis) || (!grobo_i_is_stray(axis) &&
                             GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), accel_rad_s2) > 0);
    return grobo_i_axis_tells_turn(robot, joint) && known;
}

/* True of one that was read, since it was told, to be elsewhere than its trajectory was by then:
 * it is too weak, or the frame before was lost. */
static bool is_beside(const grobo_robot_axis *axis)
{
    double asked_rad =
        fabs(axis->seen_rad - grobo_i_trajectory_at(&axis->trajectory, axis->seen_us));
    double came_rad =
        fabs(axis->seen_rad - grobo_i_trajectory_at(&axis->trajectory, axis->angle_us));
    return axis->seen_us >= axis->told_us && fmin(asked_rad, came_rad) > GROBO_I_OFF_TRAJECTORY_RAD;
}

/* So soon behind its frame a joint with a weight turns slower than it will. */
#define BEGINS_US 100000

/* Of a servo that tells the time of its trajectory: there, but for one beside it, which goes on
 * to its goal at the speed that it told, and one that cannot have come there since it was read. One
 * beside it may have missed the frame and come to the end of the trajectory before: none is taken
 * to be further than it is by now. */
static double by_time(const grobo_robot *robot, int joint, int64_t now_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double way_rad = grobo_i_axis_commanded(axis, now_us);
    double rad_s = grobo_i_joint(robot->driver->model, joint)->max_speed_rad_s;
    if ((axis->state.valid & GROBO_FIELD_SPEED) == 0 || grobo_i_is_stray(axis)) {
        return way_rad;
    }
    bool beside = is_beside(axis);
    if (beside) {
        const grobo_robot_trajectory rest = {axis->seen_rad, axis->trajectory.to_rad, axis->seen_us,
                                             axis->trajectory.to_us};
        bool begins = axis->seen_us - axis->told_us < BEGINS_US && axis->state.speed_dps != 0;
        rad_s =
            fmin(begins ? trajectory_speed(&rest) : grobo_rad_from_deg(abs(axis->state.speed_dps)),
                 rad_s);
        now_us = robot->now_us;
    }
    double left_rad = (beside ? axis->trajectory.to_rad : way_rad) - axis->seen_rad;
    double most_rad = rad_s * seconds(axis->seen_us, now_us);
    bool behind = beside || fabs(left_rad) - most_rad > GROBO_I_OFF_TRAJECTORY_RAD;
    return behind ? axis->seen_rad + copysign(fmin(most_rad, fabs(left_rad)), left_rad) : way_rad;
}

/* Of servos that do not tell how they turn, or that have no ramps: on a way that is known. */
static double on_trajectory_at(const grobo_robot *robot, int joint, int64_t at_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if ((axis->state.valid & GROBO_FIELD_TIME) != 0) {
        return by_time(robot, joint, at_us);
    }
    return is_guided(axis) && !grobo_i_is_stray(axis)
               ? along(robot, joint, at_us)
               : grobo_i_axis_commanded(axis, at_us) - grobo_i_load(axis);
}

double grobo_i_axis_place(const grobo_robot *robot, int joint)
{
    return has_course(robot, joint) ? turning(robot, joint, robot->now_us).at_rad
                                    : on_trajectory_at(robot, joint, robot->now_us);
}

double grobo_i_axis_speed(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if (has_course(robot, joint)) {
        return fabs(turning(robot, joint, robot->now_us).rad_s);
    }
    const grobo_robot_trajectory trajectory =
        grobo_i_is_stray(axis)
            ? (grobo_robot_trajectory){axis->state.angle_rad, axis->state.goal_rad, axis->angle_us,
                                       axis->own_until_us}
            : axis->trajectory;
    return trajectory.to_us > robot->now_us ? trajectory_speed(&trajectory) : 0;
}

double grobo_i_axis_brake_us(const grobo_robot *robot, int joint)
{
    double accel_rad_s2 = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), accel_rad_s2);
    return accel_rad_s2 > 0 ? grobo_i_axis_speed(robot, joint) / accel_rad_s2 * 1e6 : 0;
}

double grobo_i_axis_reached(const grobo_robot *robot, int joint, int64_t rest_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double accel_rad_s2 = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), accel_rad_s2);
    if (!has_course(robot, joint)) {
        return on_trajectory_at(robot, joint, rest_us);
    }
    const course c = turning(robot, joint, robot->now_us);
    double on_rad = fabs(c.rad_s) * seconds(robot->now_us, rest_us);
    if (accel_rad_s2 > 0) {
        on_rad = fmax(on_rad, c.rad_s * c.rad_s / (2 * accel_rad_s2));
    }
    bool guided = is_guided(axis) && !grobo_i_is_stray(axis);
    double end_rad = (guided ? axis->trajectory.to_rad : axis->state.goal_rad) - grobo_i_load(axis);
    double left_rad = end_rad - c.at_rad;
    bool ends = guided || tells_end(robot, joint);
    bool beyond = ends && c.rad_s * left_rad > 0 && on_rad > fabs(left_rad);
    return beyond ? end_rad : c.at_rad + copysign(on_rad, c.rad_s);
}

void grobo_i_axis_told(grobo_robot *robot, int joint)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if (GROBO_I_EXTRA(robot->driver, accel_rad_s2) > 0 &&
        grobo_i_driver_of(robot, joint)->accel_rad_s2 > 0 && has_course(robot, joint)) {
        const course c = turning(robot, joint, robot->now_us);
        axis->seen_rad = c.at_rad;
        axis->seen_us = robot->now_us;
        axis->seen_dps = dps_of((int32_t)lround(grobo_deg_from_rad(c.rad_s)));
    }
}

grobo_i_limits grobo_i_joint_limits(const grobo_robot *robot, int joint)
{
    const grobo_joint *model = grobo_i_joint(robot->driver->model, joint);
    const grobo_joint_state *state = &robot->axes[joint].state;
    grobo_i_limits limits = {model->min_rad, model->max_rad};
    if ((state->valid & GROBO_FIELD_RANGE) != 0) {
        limits.min_rad = fmax(limits.min_rad, state->low_rad);
        limits.max_rad = fmin(limits.max_rad, state->high_rad);
    }
    if (grobo_i_followers(robot) != 0) {
        grobo_i_couple_limits(robot, joint, &limits.min_rad, &limits.max_rad);
    }
    return limits;
}

bool grobo_i_torque_is_limited(const grobo_robot *robot, int joint)
{
    const grobo_joint_state *state = &robot->axes[joint].state;
    return GROBO_DRIVERS_PLAIN ||
           grobo_i_joint(robot->driver->model, joint)->torque_limit_pct == 0 ||
           ((state->valid & GROBO_FIELD_TORQUE_LIMIT) != 0 && state->torque_limited);
}

double grobo_i_axis_target(const grobo_robot_axis *axis)
{
    return axis->next != 0 ? axis->next_rad : axis->trajectory.to_rad;
}

void grobo_i_axis_rest(grobo_robot_axis *axis, int64_t now_us)
{
    double goal_rad = set_point(axis);
    axis->trajectory = (grobo_robot_trajectory){goal_rad, goal_rad, now_us, now_us};
    grobo_i_joint_to(axis, GROBO_I_JOINT_REST);
}

void grobo_i_axis_here(grobo_robot_axis *axis, int64_t now_us)
{
    grobo_i_axis_rest(axis, now_us);
    if (axis->own_until_us > axis->angle_us) { /* by now it may have arrived */
        axis->trajectory = (grobo_robot_trajectory){axis->state.angle_rad, axis->state.goal_rad,
                                                    axis->angle_us, axis->own_until_us};
    }
}

bool grobo_i_axis_is_on(const grobo_robot_axis *axis)
{
    return axis->torque_known && axis->state.torque == GROBO_TORQUE_ON;
}

bool grobo_i_axis_is_limp(const grobo_robot_axis *axis)
{
    return axis->torque_known && axis->state.torque != GROBO_TORQUE_ON;
}

bool grobo_i_may_sleep(const grobo_robot *robot, int joint)
{
    return GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), goal_energises) &&
           robot->now_us - robot->axes[joint].heard_us > GROBO_I_RESTART_US;
}

/* What was read of a joint that goes where nobody knows is too old by then. */
#define ASTRAY_OLD_US 20000

/* One that is sent, or read to be still, is known. Read, but not whether it turns: nobody here has
 * sent it anywhere, its servo may be on a way. */
bool grobo_i_axis_is_unknown(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool turns = grobo_i_is_stray(axis) || grobo_i_is_external(axis);
    bool unknown = !grobo_i_is_sensed(axis);
    if (grobo_i_is_wheel(robot, joint)) {
        return unknown; /* speed 0 stops it wherever it is */
    }
    if (turns) {
        unknown = axis->own_until_us <= robot->now_us &&
                  abs(axis->state.speed_dps) >= GROBO_I_SLOW_DPS &&
                  robot->now_us - axis->angle_us > ASTRAY_OLD_US;
    } else if (!grobo_i_has_target(axis) && !tells_speed(axis)) {
        unknown = unknown || !GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed);
    }
    return unknown || grobo_i_may_sleep(robot, joint);
}

bool grobo_i_may_halt(const grobo_robot *robot)
{
    return robot->trip.trip != GROBO_TRIP_ESTOP || robot->holds_at_stop;
}

void grobo_i_axis_cut(grobo_robot_axis *axis)
{
    axis->trajectory.to_rad = grobo_i_trajectory_at(&axis->trajectory, axis->told_to_us);
    axis->trajectory.to_us = grobo_i_sooner(axis->trajectory.to_us, axis->told_to_us);
    grobo_i_joint_to(axis, GROBO_I_JOINT_REST);
}

bool grobo_i_axis_moves(const grobo_robot_axis *axis, int64_t now_us)
{
    return !grobo_i_axis_is_limp(axis) &&
           grobo_i_later(grobo_i_axis_until(axis), axis->trajectory.to_us) > now_us;
}

bool grobo_i_trajectory_is_short(const grobo_robot_axis *axis)
{
    return grobo_i_has_target(axis) && grobo_i_is_in_segments(axis) &&
           axis->told_to_us < axis->trajectory.to_us;
}

bool grobo_i_goal_is_told(const grobo_robot_axis *axis)
{
    return axis->goal_us != GROBO_NEVER_US && axis->goal_us > axis->told_us;
}

/* ---- weight ---------------------------------------------------------------------------------- */

/* No weight that a servo can carry makes a larger error; of a limited torque a part of that. The
 * softest loop that is known, of an XL330 with the weight of an arm, has 14 degrees. */
#define LOAD_MOST_RAD (20 * 0.017453292519943295)
/* A joint that swings is not faster, nor further from where it hangs; and it rests by then. */
#define SWINGS_DPS 40
#define SWINGS_RAD (3 * 0.017453292519943295)
#define SAGS_US 1500000
/* A mean speed hides that another program moves it: so long at most it is taken to sag, and where
 * it was sent nowhere, which changes what carries it by little. */
#define SAGS_MEAN_US 1000000
#define SAGS_THERE_US 320000

double grobo_i_load_most(const grobo_robot *robot, int joint)
{
    int pct = grobo_i_joint(robot->driver->model, joint)->torque_limit_pct;
    return pct > 0 ? LOAD_MOST_RAD * pct / 100 : LOAD_MOST_RAD;
}

/* True of one that is not counted along its trajectory, and was read to turn, or not to. A mean
 * speed shows that of a joint alone that was sent here: others may move it elsewhere between two
 * angles. */
static bool shows_swing(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool mean = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed);
    bool sent = grobo_i_has_target(axis) && !grobo_i_is_stray(axis);
    return !grobo_i_axis_is_counted(axis) && !grobo_i_is_wheel(robot, joint) &&
           axis->seen_dps != GROBO_I_NO_SPEED && (sent || !mean);
}

bool grobo_i_axis_goal(const grobo_robot *robot, int joint, double *goal_rad)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool sent = grobo_i_has_target(axis) && !grobo_i_is_stray(axis);
    *goal_rad = sent ? axis->trajectory.to_rad : axis->state.goal_rad;
    return sent ? !grobo_i_trajectory_is_short(axis)
                : axis->goal_us != GROBO_NEVER_US && axis->goal_us >= axis->told_us;
}

/* True of one that may not rest yet in the goal that it was told, or since then. */
static bool settles(const grobo_robot *robot, int joint, int64_t since_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    int64_t from_us = grobo_i_later(axis->told_us, since_us);
    if (GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed)) {
        double way_rad = fabs(axis->trajectory.to_rad - axis->trajectory.from_rad);
        bool there = way_rad <= grobo_i_same_goal_rad(robot, joint);
        return robot->now_us - from_us <= (there ? SAGS_THERE_US : SAGS_MEAN_US);
    }
    from_us = grobo_i_has_target(axis) ? grobo_i_later(from_us, axis->trajectory.to_us) : from_us;
    return robot->now_us - from_us <= SAGS_US;
}

bool grobo_i_swings(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double goal_rad, load_rad = grobo_i_load_kept(axis);
    if (!shows_swing(robot, joint) || !grobo_i_axis_goal(robot, joint, &goal_rad)) {
        return false;
    }
    double left_rad = goal_rad - load_rad - axis->seen_rad;
    bool mean = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed);
    bool now = (axis->goal_us == axis->angle_us && !mean) || settles(robot, joint, 0);
    bool sinks = now && axis->seen_dps * (goal_rad - axis->seen_rad) < 0;
    return (sinks && fabs(left_rad) <= grobo_i_load_most(robot, joint)) ||
           (load_rad != 0 && !mean && fabs(left_rad) <= SWINGS_RAD &&
            abs(axis->seen_dps) <= SWINGS_DPS);
}

bool grobo_i_may_sag(const grobo_robot *robot, int joint, int64_t since_us)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double goal_rad;
    return shows_swing(robot, joint) && grobo_i_axis_goal(robot, joint, &goal_rad) &&
           grobo_i_goal_is_told(axis) &&
           fabs(goal_rad - axis->seen_rad) <= grobo_i_load_most(robot, joint) &&
           settles(robot, joint, since_us);
}

/* ---- moving ---------------------------------------------------------------------------------- */

static bool turns(const grobo_robot_axis *axis)
{
    return abs(axis->seen_dps) >= GROBO_I_SLOW_DPS;
}

bool grobo_i_axis_is_late(const grobo_robot_axis *axis)
{
    double off_rad = axis->state.angle_rad + grobo_i_load(axis) - axis->trajectory.to_rad;
    return !tells_speed(axis) && fabs(off_rad) > LAGS_RAD;
}

/* A ramp that was not read may end so much later. */
#define RAMP_LATE_US 20000

/* It comes back with its ramps, and no faster than it was sent. */
static double way_back_s(const grobo_robot *robot, int joint, double way_rad)
{
    double accel_rad_s2 = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), accel_rad_s2);
    double sent_rad_s = fmax(told_speed(robot, joint), GROBO_I_REST_RAD_S);
    double rad_s = fmin(sqrt(way_rad * accel_rad_s2), sent_rad_s);
    return rad_s > 0 ? way_rad / rad_s + rad_s / accel_rad_s2 : 0;
}

/* Of a servo with ramps: what it takes to come to rest at the end of its trajectory, which it
 * passes, and comes back to, where it is too fast for what is left. */
static bool is_on_ramp(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if (GROBO_I_EXTRA(robot->driver, accel_rad_s2) <= 0) {
        return false; /* no joint has any */
    }
    double accel_rad_s2 = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), accel_rad_s2);
    bool stood = !turns(axis) && axis->seen_us >= axis->trajectory.to_us;
    if (accel_rad_s2 <= 0 || stood || !grobo_i_is_sensed(axis) || !has_course(robot, joint) ||
        !is_guided(axis) || !grobo_i_axis_is_on(axis)) {
        return false;
    }
    const course c = seen(robot, joint);
    double end_rad = axis->trajectory.to_rad - grobo_i_load(axis);
    double left_rad = copysign(end_rad - c.at_rad, (end_rad - c.at_rad) * c.rad_s);
    double over_rad = c.rad_s * c.rad_s / (2 * accel_rad_s2) - left_rad;
    double back_s = fabs(c.rad_s) / accel_rad_s2 + way_back_s(robot, joint, fmax(over_rad, 0));
    double rad_s = fabs(turning(robot, joint, robot->now_us - RAMP_LATE_US).rad_s);
    return rad_s >= grobo_rad_from_deg(GROBO_I_SLOW_DPS) ||
           (over_rad > 0 && seconds(axis->seen_us, robot->now_us) < back_s);
}

bool grobo_i_axis_lags(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool stood =
        !turns(axis) && (grobo_i_is_stray(axis) || axis->seen_us >= axis->trajectory.to_us);
    if (stood || !tells_speed(axis) || !grobo_i_is_sensed(axis) || !grobo_i_has_target(axis) ||
        axis->seen_us < axis->told_us || !grobo_i_axis_is_on(axis)) {
        return false;
    }
    if (grobo_i_is_stray(axis)) { /* where to, nobody knows */
        return axis->own_until_us <= axis->seen_us &&
               robot->now_us - axis->seen_us <= GROBO_WATCH_US;
    }
    return grobo_i_axis_tells_turn(robot, joint) && is_guided(axis) &&
           !grobo_i_swings(robot, joint) &&
           fabs(grobo_i_axis_place(robot, joint) + grobo_i_load(axis) - axis->trajectory.to_rad) >
               LAGS_RAD;
}

bool grobo_i_moving(const grobo_robot *robot, int64_t now_us)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (axis->next != 0 || (grobo_i_is_sensed(axis) && grobo_i_axis_moves(axis, now_us)) ||
            (turns(axis) && grobo_i_axis_lags(robot, j)) || is_on_ramp(robot, j) ||
            (grobo_i_is_wheel(robot, j) && grobo_i_wheel_moves(axis))) {
            return true;
        }
    }
    return false;
}

/* A joint so near the goal that its own servo holds comes to rest there, or swings: no other
 * program moves it away. */
#define NEAR_GOAL_RAD (6 * 0.017453292519943295)

static bool is_near_goal(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    double goal_rad;
    return !grobo_i_axis_is_counted(axis) && grobo_i_axis_goal(robot, joint, &goal_rad) &&
           fabs(goal_rad - axis->seen_rad) <= NEAR_GOAL_RAD;
}

bool grobo_i_externally_moved(const grobo_robot *robot, grobo_joint_mask joints, int *joint)
{
    *joint = -1;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j) && grobo_i_is_external(&robot->axes[j]) &&
            !is_near_goal(robot, j)) {
            *joint = j;
            return true;
        }
    }
    return false;
}

bool grobo_i_all_sensed(const grobo_robot *robot, grobo_joint_mask joints, int *joint)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j) && !grobo_i_is_sensed(&robot->axes[j])) {
            *joint = j;
            return false;
        }
    }
    return true;
}

bool grobo_i_all_on(const grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j) && !grobo_i_axis_is_on(&robot->axes[j])) {
            return false;
        }
    }
    return true;
}

grobo_joint_mask grobo_i_all_joints(const grobo_robot *robot)
{
    return GROBO_JOINTS_ALL(robot->driver->model->n_joints);
}

int grobo_i_lowest(grobo_joint_mask joints)
{
    GROBO_ASSERT(joints != 0);
    int j = 0;
    while ((joints & 0xFF) == 0) {
        joints >>= 8;
        j += 8;
    }
    while ((joints & 1) == 0) {
        joints >>= 1;
        j++;
    }
    return j;
}
