/* SPDX-License-Identifier: MIT */
/*
 * The only way to motors. A frame that moves a joint, switches torque, or has an unknown effect on
 * a servo carries an order. Whatever its origin, the order is judged and its frame is built at the
 * moment the frame leaves, at each attempt, by the frames that have left before and by the latest
 * readings. The engine updates what it knows of the joints at that moment too, not at the request.
 *
 *   judge()                the one judgement of all orders
 *   make_frame()           the only caller of the driver's functions that build motor frames
 *   note()                 updates what is known of the joints once the frame has left
 *   grobo_i_gate_leave()   called by the bus just before a frame leaves: judges, builds, notes
 *   grobo_i_gate_judge(), grobo_i_gate_build()   judge a request, so that it is refused at once
 */
#include <math.h>
#include <string.h>

#include "src/base/angle.h"
#include "src/base/assert.h"
#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/gate.h"
#include "src/robot/lines.h"
#include "src/robot/often.h"
#include "src/robot/query.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/speed.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/trajectories.h"
#include "src/robot/weight.h"
#include "src/robot/wheel.h"

/* The contents of an order's frame. */
typedef struct saying {
    grobo_target target;                              /* where to, for orders that move */
    grobo_joint_mask torqued[GROBO_TORQUE_BRAKE + 1]; /* what it switches, by mode */
    grobo_i_speeds speeds;                            /* of an order for wheels */
    bool as_asked; /* a goal of all its joints, to where each was asked to go, in that time */
} saying;

/* When an order is judged: at the request, when its first frame is built, and each time that the
 * frame leaves. */
typedef enum moment { ASKED, BUILT, LEAVES, LEAVES_AGAIN } moment;

/* ---- judging --------------------------------------------------------------------------------- */

static bool all_limited(const grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j) && !grobo_i_torque_is_limited(robot, j)) {
            return false;
        }
    }
    return true;
}

/* Refuses joints that must not move: unread, without torque, in free mode, externally moved, or
 * without their torque limit. */
static int judge_joints(grobo_robot *robot, grobo_joint_mask joints)
{
    if (!grobo_i_all_sensed(robot, joints, &robot->fault_joint)) {
        return GROBO_ERR_STALE;
    }
    if (!grobo_i_all_on(robot, grobo_i_woken(robot, joints))) {
        return GROBO_ERR_STATE;
    }
    /* A person moves a joint in free mode; another program moves one that is externally moved. */
    bool moved = grobo_i_externally_moved(robot, joints, &robot->fault_joint);
    bool others = moved || (joints & robot->free_joints) != 0;
    return others || !all_limited(robot, joints) ? GROBO_ERR_STATE : GROBO_OK;
}

/* The goal that ends a motion for a joint: between its place and the point where it comes to rest
 * under even deceleration in that time: none is turned back. A joint that lags, or that a raw frame
 * moves, is not where the clip is. */
static double rest_of(const grobo_robot *robot, int joint, bool soft)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if (axis->last == 0) { /* told by what has no number: a raw frame, or a halt behind it */
        return grobo_i_goal_to_rest(robot, joint, robot->now_us + GROBO_I_HALT_AHEAD_US);
    }
    double here_rad = grobo_i_axis_place(robot, joint);
    double to_rad = axis->trajectory.to_rad - grobo_i_load(axis); /* where it turns to */
    if (!GROBO_DRIVERS_PLAIN && grobo_i_hangs_in_goal(robot, joint)) {
        return axis->trajectory.to_rad; /* it has not begun to go on from there */
    }
    double rad_s = fmin(grobo_i_axis_speed(robot, joint), grobo_i_speed_limit(robot, joint, soft));
    double most_rad = rad_s * (double)axis->next_time_us / 1e6 / 2;
    if (!GROBO_DRIVERS_PLAIN) { /* a servo with ramps comes to rest no sooner */
        double rest_rad = grobo_i_axis_reached(robot, joint, robot->now_us);
        most_rad = fmax(most_rad, fabs(rest_rad - here_rad));
        to_rad = rest_rad == here_rad ? to_rad : rest_rad;
    }
    int side = (to_rad > here_rad) - (to_rad < here_rad);
    double goal_rad = grobo_i_goal_near(axis, axis->next_rad, here_rad, most_rad, side);
    if (!GROBO_DRIVERS_PLAIN) {
        double lag_rad = grobo_i_lag_kept(robot, joint, here_rad);
        goal_rad = fabs(goal_rad - here_rad) < fabs(lag_rad) ? here_rad + lag_rad : goal_rad;
    }
    return goal_rad;
}

/* Fills in the goals of an order, except for joints that a goal would energise. @return true if
 * there are such joints. */
static bool aim_goal(const grobo_robot *robot, const grobo_robot_order *order, bool soft,
                     grobo_target *target)
{
    bool wakes = GROBO_I_EXTRA(robot->driver, goal_energises), sleeps = false;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool last = axis->next == 0 && axis->last == order->number; /* again, or its next part */
        bool meant = grobo_i_has(order->joints, j) && (axis->next == order->number || last);
        bool unknown =
            order->rests ? grobo_i_axis_is_unknown(robot, j) : wakes && grobo_i_may_sleep(robot, j);
        if (meant && unknown) {
            sleeps = true;
        } else if (meant) {
            target->posture.angle_rad[j] = order->rests ? rest_of(robot, j, soft) : axis->next_rad;
            target->joint_time_us[j] = axis->next_time_us;
            target->posture.set |= GROBO_JOINT_BIT(j);
        }
    }
    return sleeps;
}

/* True if no joint is skipped, clamped, or given more time than was asked for. */
static bool goes_as_asked(const grobo_robot *robot, const grobo_robot_order *order,
                          const grobo_target *target)
{
    bool same = target->posture.set == order->joints && !order->rests;
    for (int j = 0; same && j < robot->driver->model->n_joints; j++) {
        same = !grobo_i_has(order->joints, j) ||
               target->joint_time_us[j] == robot->axes[j].next_time_us;
    }
    return same;
}

/* Clamps the angles of a goal to the limits, and lengthens its times to what the joints need from
 * where they are now. */
static int judge_trajectory(grobo_robot *robot, const grobo_robot_order *order, saying *says)
{
    int clamped = grobo_i_target_clamp(robot, &says->target.posture); /* one may rest outside */
    int result = grobo_i_gate_time(robot, order, &says->target);
    says->as_asked = clamped == 0 && goes_as_asked(robot, order, &says->target);
    return result;
}

/* True if another judgement of a trajectory that was just judged changes nothing. */
static bool is_judged(grobo_robot *robot, const grobo_robot_order *order, const saying *says)
{
    saying again = *says;
    return judge_trajectory(robot, order, &again) >= 0 &&
           again.as_asked == goes_as_asked(robot, order, &says->target);
}

/* A goal goes to its target unless a later target supersedes it, and gets more time where it leaves
 * late. When its frame is built, the request has clamped and timed it already, from the same
 * joints, limits and instant (grobo_i_gate_send()). An order that rests has another goal. */
static int judge_goal(grobo_robot *robot, const grobo_robot_order *order, moment when, saying *says)
{
    grobo_target *target = &says->target;
    if (robot->trip.latched && (!order->stops || robot->trip.trip == GROBO_TRIP_ESTOP)) {
        return GROBO_ERR_LATCHED;
    }
    bool sleeps = aim_goal(robot, order, robot->soft || order->soft, target);
    if (order->rests) {
        grobo_i_couple_rest(robot, target->posture.set, target);
    }
    if (target->posture.set == 0) {
        return sleeps || order->rests ? GROBO_ERR_EMPTY : GROBO_ERR_SUPERSEDED;
    }
    int result = judge_joints(robot, target->posture.set);
    if (result >= 0 && (when != BUILT || order->rests)) {
        result = judge_trajectory(robot, order, says);
    } else if (result >= 0) {
        says->as_asked = target->posture.set == order->joints;
        GROBO_ASSERT(!GROBO_ASSERT_WALKS || is_judged(robot, order, says));
    }
    return result;
}

/* The time in which a joint outside its limits is moved to them, at the approach speed: once its
 * torque comes on, or a halt finds it there. */
static int64_t draw_time_us(const grobo_robot *robot, int joint, double from_rad, double to_rad)
{
    int64_t step_us = grobo_i_driver_of(robot, joint)->time_step_us;
    double way_rad = fabs(to_rad - from_rad);
    double steps = ceil(way_rad / grobo_i_speed_limit(robot, joint, true) * 1e6 / (double)step_us);
    double most = (double)(grobo_i_driver_of(robot, joint)->time_max_us / step_us);
    return (int64_t)fmin(fmax(steps, 1), most) * step_us;
}

/* Joints that a halt may name though they do not move: a goal would not wake them. */
static grobo_joint_mask may_be_told(const grobo_robot *robot)
{
    grobo_joint_mask may = 0;
    for (int j = 0; grobo_i_followers(robot) != 0 && j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool on =
            grobo_i_axis_is_on(axis) || !GROBO_I_EXTRA(grobo_i_driver_of(robot, j), goal_energises);
        may |= grobo_i_is_sensed(axis) && on ? GROBO_JOINT_BIT(j) : 0;
    }
    return may & ~robot->halts_owed;
}

/* True of a joint that may move, though nobody has seen it: an owed halt is for that. */
static bool may_go_on(const grobo_robot *robot, const grobo_robot_order *order, int joint)
{
    bool may = grobo_i_is_mute(robot, joint) || grobo_i_may_creep(robot, joint);
    return may && order->owed && !grobo_i_stands(robot, joint);
}

/* Joints that move stop ahead of where they are now, however long the order had to wait. */
static int judge_halt(grobo_robot *robot, const grobo_robot_order *order, grobo_target *target)
{
    if (!grobo_i_may_halt(robot) && !order->owed) {
        return GROBO_ERR_LATCHED;
    }
    int64_t rest_us = grobo_i_later(order->asked_us + GROBO_I_HALT_AHEAD_US,
                                    robot->now_us + GROBO_I_HALT_LEAST_US);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool goes_on = grobo_i_axis_moves(axis, robot->now_us) || grobo_i_axis_lags(robot, j) ||
                       grobo_i_is_external(axis) || may_go_on(robot, order, j);
        bool moves = grobo_i_is_sensed(axis) && goes_on &&
                     (!GROBO_I_EXTRA(grobo_i_driver_of(robot, j), goal_energises) ||
                      axis->wants_torque || grobo_i_axis_is_on(axis));
        if (grobo_i_has(order->joints & ~robot->halts_owed, j) && moves) {
            const grobo_i_limits limits = grobo_i_joint_limits(robot, j);
            double goal_rad = grobo_i_goal_to_rest(robot, j, rest_us);
            double in_rad = fmin(fmax(goal_rad, limits.min_rad), limits.max_rad);
            target->posture.angle_rad[j] = in_rad;
            target->joint_time_us[j] =
                grobo_i_later(GROBO_I_HALT_TIME_US, draw_time_us(robot, j, goal_rad, in_rad));
            target->posture.set |= GROBO_JOINT_BIT(j);
        }
    }
    if (target->posture.set == 0) {
        return GROBO_ERR_EMPTY;
    }
    grobo_i_couple_rest(robot, order->joints & may_be_told(robot), target);
    return grobo_i_gate_time(robot, order, target);
}

/* Sets the goal of each joint without torque to its latest reading; skips joints too far outside
 * their limits. */
static int judge_hold(const grobo_robot *robot, const grobo_robot_order *order,
                      grobo_target *target)
{
    if (robot->trip.latched) {
        return GROBO_ERR_LATCHED;
    }
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        double hold_rad = grobo_i_hold_rad(robot, j);
        bool limited = !GROBO_I_EXTRA(grobo_i_driver_of(robot, j), goal_energises) ||
                       grobo_i_torque_is_limited(robot, j);
        if (grobo_i_has(order->joints, j) && grobo_i_is_sensed(axis) && !isnan(hold_rad) &&
            limited && !grobo_i_axis_is_on(axis)) {
            target->posture.angle_rad[j] = hold_rad;
            target->joint_time_us[j] = draw_time_us(robot, j, axis->state.angle_rad, hold_rad);
            target->posture.set |= GROBO_JOINT_BIT(j);
        }
    }
    return target->posture.set == 0 ? GROBO_ERR_STATE : GROBO_OK;
}

bool grobo_i_goal_holds(const grobo_robot *robot, int joint)
{
    if (grobo_i_is_wheel(robot, joint)) {
        return (robot->axes[joint].state.valid & GROBO_FIELD_GOAL) != 0 &&
               grobo_i_wheel_goal(&robot->axes[joint]) == 0;
    }
    double near_rad = grobo_rad_from_deg(GROBO_I_HOLD_NEAR_DEG);
    double goal_rad = robot->axes[joint].state.goal_rad;
    return fabs(goal_rad - grobo_i_hold_rad(robot, joint)) <= near_rad; /* not of NaN */
}

/* After a longer wait for the line a hand may have moved the joint since it was read. */
#define ON_WAITS_US 2000000

/* Torque comes on only where the goal of the servo is the latest reading of the joint. */
static int judge_torque(const grobo_robot *robot, const grobo_robot_order *order, saying *says)
{
    bool on = order->torque == GROBO_TORQUE_ON;
    bool stale = robot->now_us - order->asked_us > ON_WAITS_US;
    grobo_joint_mask may = order->joints;
    for (int j = 0; on && j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        bool holds = !stale && grobo_i_is_ready(axis) && grobo_i_goal_holds(robot, j) &&
                     grobo_i_torque_is_limited(robot, j);
        if (!holds && !grobo_i_axis_is_on(axis)) {
            may &= ~GROBO_JOINT_BIT(j);
        }
    }
    says->torqued[order->torque] = may;
    if (on && robot->trip.latched) {
        return GROBO_ERR_LATCHED;
    }
    return may == 0 ? GROBO_ERR_STATE : GROBO_OK;
}

/* A raw frame may switch torque on only for joints that were just read to have torque: that changes
 * nothing. Any other joint needs a torque job. */
static int judge_raw_torque(const grobo_robot *robot, grobo_joint_mask on)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(on, j) && !grobo_i_axis_is_on(axis)) {
            return GROBO_ERR_STATE;
        }
        if (grobo_i_has(on, j) && robot->now_us - axis->torque_us > ON_WAITS_US) {
            return GROBO_ERR_STALE;
        }
    }
    return GROBO_OK;
}

/* Tolerance for the timing of targets that a caller sends as raw frames. */
#define RAW_TOLERANCE 1.02

static int judge_raw(grobo_robot *robot, const grobo_exchange *exchange, saying *says)
{
    const grobo_driver *driver = robot->driver;
    const grobo_target *target = &says->target;
    grobo_joint_mask on;
    for (int j = 0; j < driver->model->n_joints; j++) {
        says->target.from_rad[j] = grobo_i_axis_commanded(&robot->axes[j], robot->now_us);
    }
    int result = driver->inspect(driver, robot->driver_ctx, exchange->frame, exchange->frame_bytes,
                                 &says->target, says->torqued);
    if (result >= 0) {
        result = grobo_i_target_check(robot, &target->posture, &robot->fault_joint);
    }
    if (result >= 0 && grobo_i_tears(robot, &target->posture, &robot->fault_joint)) {
        result = GROBO_ERR_UNSUPPORTED;
    }
    if (result < 0) {
        return result;
    }
    on = says->torqued[GROBO_TORQUE_ON];
    if ((target->posture.set | on) != 0 && robot->trip.latched) {
        return GROBO_ERR_LATCHED;
    }
    result = judge_joints(robot, target->posture.set | on);
    if (result >= 0) {
        result = judge_raw_torque(robot, on);
    }
    if (result < 0) {
        return result;
    }
    grobo_i_gate_single(robot);
    for (int j = 0; j < driver->model->n_joints; j++) {
        double most_us = (double)target->joint_time_us[j] * RAW_TOLERANCE;
        if (grobo_i_has(target->posture.set, j) && grobo_i_may_sleep(robot, j)) {
            robot->fault_joint = j;
            return GROBO_ERR_STALE;
        }
        if (grobo_i_has(target->posture.set, j) &&
            most_us < grobo_i_trajectory_us(robot, j,
                                            grobo_i_axis_commanded(&robot->axes[j], robot->now_us),
                                            target->posture.angle_rad[j], robot->soft)) {
            robot->fault_joint = j;
            return GROBO_ERR_SPEED;
        }
    }
    return GROBO_OK;
}

/* Continues the trajectories of the joints; one that was superseded is skipped. */
static int judge_segment(grobo_robot *robot, const grobo_robot_order *order, grobo_target *target)
{
    if (robot->trip.latched) {
        return GROBO_ERR_LATCHED;
    }
    grobo_i_segments_aim(robot, order->joints, target);
    for (int j = 0;
         GROBO_I_EXTRA(robot->driver, goal_energises) && j < robot->driver->model->n_joints; j++) {
        target->posture.set &= ~(grobo_i_may_sleep(robot, j) ? GROBO_JOINT_BIT(j) : 0);
    }
    return target->posture.set == 0 ? GROBO_ERR_EMPTY : judge_joints(robot, target->posture.set);
}

/* A setting changes what a goal means: a servo that holds would jump. At the second attempt the
 * torque is unknown because of the first. */
static int judge_setting(const grobo_robot *robot, grobo_joint_mask joints, bool again)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(joints, j) &&
            (grobo_i_axis_is_on(axis) || (!axis->torque_known && !again))) {
            return axis->torque_known ? GROBO_ERR_STATE : GROBO_ERR_STALE;
        }
    }
    return GROBO_OK;
}

/* A command needs a silent line, so that nothing may move; the effect of an unknown frame on moving
 * joints cannot be known. */
static int judge_alone(const grobo_robot *robot)
{
    bool moves = grobo_i_is_playing(robot) || grobo_i_moving(robot, robot->now_us);
    return moves ? GROBO_ERR_STATE : GROBO_OK;
}

/* Clears the joints of the model alone: a microcontroller clears byte by byte. */
static void say_nothing(const grobo_robot *robot, saying *says)
{
    grobo_target *target = &says->target;
    const size_t n = robot->driver->model->n_joints;
    (void)grobo_posture_init(&target->posture, (int)n);
    memset(target->joint_time_us, 0, n * sizeof target->joint_time_us[0]);
    memset(target->from_rad, 0, n * sizeof target->from_rad[0]);
    memset(says->torqued, 0, sizeof says->torqued);
    says->speeds.joints = 0;
    says->as_asked = false;
}

static int judge(grobo_robot *robot, const grobo_robot_order *order, const grobo_exchange *exchange,
                 moment when, saying *says)
{
    say_nothing(robot, says);
    if (grobo_i_is_of_wheels(robot, order)) {
        return grobo_i_wheel_judge(robot, order, &says->speeds);
    }
    switch ((grobo_i_order_kind)order->kind) {
    case GROBO_I_ORDER_NONE:
        return GROBO_OK;
    case GROBO_I_ORDER_GOAL:
        return judge_goal(robot, order, when, says);
    case GROBO_I_ORDER_SEGMENT:
        return judge_segment(robot, order, &says->target);
    case GROBO_I_ORDER_HALT:
        return judge_halt(robot, order, &says->target);
    case GROBO_I_ORDER_HOLD:
        return judge_hold(robot, order, &says->target);
    case GROBO_I_ORDER_TORQUE:
        return judge_torque(robot, order, says);
    case GROBO_I_ORDER_RAW:
        return judge_raw(robot, exchange, says);
    case GROBO_I_ORDER_UNKNOWN:
        return robot->trip.latched ? GROBO_ERR_LATCHED : judge_alone(robot);
    case GROBO_I_ORDER_SETTING:
        return judge_setting(robot, order->joints, when == LEAVES_AGAIN);
    case GROBO_I_ORDER_COMMAND:
        return judge_alone(robot);
    case GROBO_I_ORDER_SPEED:
        break; /* for wheels alone */
    }
    GROBO_ASSERT(false); /* each kind returns above */
    return GROBO_ERR_ARG;
}

int grobo_i_gate_judge(grobo_robot *robot, const grobo_robot_order *order,
                       const grobo_exchange *exchange)
{
    saying says;
    return judge(robot, order, exchange, ASKED, &says);
}

int grobo_i_gate_raw(grobo_robot *robot, const grobo_exchange *exchange, grobo_robot_order *order)
{
    const grobo_driver *driver = robot->driver;
    saying says;
    say_nothing(robot, &says);
    int result = driver->inspect == NULL
                     ? GROBO_ERR_UNSUPPORTED
                     : driver->inspect(driver, robot->driver_ctx, exchange->frame,
                                       exchange->frame_bytes, &says.target, says.torqued);
    grobo_joint_mask moved = says.target.posture.set | says.torqued[GROBO_TORQUE_ON];
    *order = (grobo_robot_order){.single = true};
    if (result == GROBO_ERR_UNSUPPORTED && robot->config.accept_unknown_raw) {
        order->kind = GROBO_I_ORDER_UNKNOWN;
        order->joints = grobo_i_all_joints(robot);
        order->moves = true;
    } else if (result < 0) {
        return result;
    } else {
        order->joints = moved | says.torqued[GROBO_TORQUE_OFF] | says.torqued[GROBO_TORQUE_BRAKE];
        order->kind = order->joints != 0 ? GROBO_I_ORDER_RAW : GROBO_I_ORDER_NONE;
        order->moves = moved != 0;
    }
    return grobo_i_gate_judge(robot, order, exchange);
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* The begin of a halt for servos that take a speed and no time. A halt counts the distance from
 * where the joint was read, so that a joint that lags comes to rest no later. */
static double begin_of_halt(const grobo_robot *robot, const grobo_target *target, int joint)
{
    double to_rad = target->posture.angle_rad[joint];
    double way_rad = fabs(target->from_rad[joint] - to_rad);
    const grobo_robot_axis *axis = &robot->axes[joint];
    double behind_rad = axis->state.angle_rad + grobo_i_load_kept(axis) - to_rad;
    double most_rad =
        grobo_i_speed_limit(robot, joint, true) * (double)target->joint_time_us[joint] / 1e6;
    return fabs(behind_rad) <= way_rad
               ? target->from_rad[joint]
               : to_rad + copysign(fmin(fabs(behind_rad), fmax(most_rad, way_rad)), behind_rad);
}

/* A trajectory of no length uses the approach speed. */
static double begin_of_rest(const grobo_robot *robot, const grobo_target *target, int joint)
{
    double to_rad = target->posture.angle_rad[joint];
    double way_rad = target->from_rad[joint] - to_rad;
    double rad_s = fmin(grobo_i_speed_limit(robot, joint, true), GROBO_I_REST_RAD_S);
    double least_rad = rad_s * (double)target->joint_time_us[joint] / 1e6;
    return fabs(way_rad) < grobo_i_driver_of(robot, joint)->angle_step_rad
               ? target->from_rad[joint]
               : to_rad + copysign(fmax(fabs(way_rad), least_rad), way_rad);
}

/* True if the driver uses angles and times only. */
static bool is_timed(const grobo_driver *driver)
{
    return driver->posture == GROBO_I_MEMBER(driver, driver->size, timed_posture);
}

/* The target of an order's frames: all of it, or its first segment. */
static const grobo_target *aim(const grobo_robot *robot, const grobo_robot_order *order,
                               saying *says, grobo_target *part)
{
    bool cut = order->kind == GROBO_I_ORDER_GOAL &&
               grobo_i_segments_cut(robot, order, &says->target, part);
    grobo_target *target = cut ? part : &says->target;
    bool timed = is_timed(robot->driver);
    for (int j = 0; !timed && j < robot->driver->model->n_joints; j++) {
        target->from_rad[j] = grobo_i_begin_of(robot, order, j);
        if (order->kind == GROBO_I_ORDER_HALT) {
            target->from_rad[j] = begin_of_halt(robot, target, j);
        }
        if (order->kind == GROBO_I_ORDER_HALT || order->rests) {
            target->from_rad[j] = begin_of_rest(robot, target, j);
        }
    }
    return target;
}

/* Builds part `part` of the frames; the only calls of these functions of a driver. */
static int make_frame(const grobo_robot *robot, const grobo_robot_order *order, const saying *says,
                      const grobo_target *target, int part, grobo_exchange *exchange)
{
    const grobo_driver *driver = robot->driver;
    memset(exchange, 0, offsetof(grobo_exchange, frame));
#if !GROBO_DRIVERS_PLAIN
    if (grobo_i_is_of_wheels(robot, order)) {
        return driver->speed(driver, robot->driver_ctx, says->speeds.joints, says->speeds.rad_s,
                             part, exchange);
    }
#endif
    return order->kind == GROBO_I_ORDER_TORQUE
               ? driver->torque(driver, robot->driver_ctx, says->torqued[order->torque],
                                (grobo_torque)order->torque, part, exchange)
               : driver->posture(driver, robot->driver_ctx, target, part, exchange);
}

/* A waiting frame reserves room for all joints of its order: a joint that it skips now may be in it
 * when it leaves. */
static void says_all(const grobo_robot *robot, const grobo_robot_order *order, saying *says)
{
    if (order->kind == GROBO_I_ORDER_TORQUE) {
        says->torqued[order->torque] = order->joints;
        return;
    }
    if (grobo_i_is_of_wheels(robot, order)) {
        says->speeds.joints = order->joints;
        return;
    }
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(order->joints & ~says->target.posture.set, j)) {
            says->target.joint_time_us[j] = grobo_i_driver_of(robot, j)->time_step_us;
        }
    }
    says->target.posture.set = order->joints;
}

/* True if the driver would build the same frame at any time, from angles and times as requested: a
 * waiting frame need not be rebuilt. */
static bool stands(const grobo_robot *robot, const saying *says, const grobo_target *target)
{
    return is_timed(robot->driver) && says->as_asked && target == &says->target;
}

int grobo_i_gate_build(grobo_robot *robot, grobo_robot_order *order, grobo_exchange *exchange)
{
    saying says;
    grobo_target part;
    const grobo_target *target = &says.target;
    grobo_exchange next;
    int result = judge(robot, order, NULL, BUILT, &says);
    if (result >= 0) {
        says_all(robot, order, &says);
        target = aim(robot, order, &says, &part);
        order->stands = stands(robot, &says, target);
        result = make_frame(robot, order, &says, target, order->part, exchange);
    }
    bool several = order->part == 0 && grobo_joints_count(order->joints) > 1;
    if (result > 0 && several && make_frame(robot, order, &says, target, 1, &next) > 0) {
        return GROBO_ERR_CAP;
    }
    return result;
}

static bool is_built(const grobo_robot_order *order)
{
    return order->kind == GROBO_I_ORDER_GOAL || order->kind == GROBO_I_ORDER_SEGMENT ||
           order->kind == GROBO_I_ORDER_HALT || order->kind == GROBO_I_ORDER_HOLD ||
           order->kind == GROBO_I_ORDER_TORQUE ||
           (!GROBO_DRIVERS_PLAIN && order->kind == GROBO_I_ORDER_SPEED);
}

/* ---- noting ---------------------------------------------------------------------------------- */

static void forget(grobo_robot *robot, grobo_joint_mask joints, bool torque_too)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(joints, j)) {
            grobo_i_joint_to(axis, GROBO_I_JOINT_FORGET);
            axis->wants_torque = axis->wants_torque && !torque_too;
            axis->torque_known = axis->torque_known && !torque_too;
            axis->own_until_us = 0;
            grobo_i_stand_forget(axis);
        }
    }
    grobo_i_gate_soften(robot);
}

/* The trajectories that joints follow from now on. */
static void note_trajectory(grobo_robot *robot, const grobo_robot_order *order,
                            const grobo_target *target)
{
    int64_t now_us = robot->now_us;
    bool parts = order->kind == GROBO_I_ORDER_GOAL && grobo_i_goes_in_parts(robot, order);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(target->posture.set, j)) {
            grobo_robot_axis *axis = &robot->axes[j];
            double from_rad = grobo_i_begin_of(robot, order, j);
            grobo_i_axis_told(robot, j);
            axis->trajectory = (grobo_robot_trajectory){from_rad, target->posture.angle_rad[j],
                                                        now_us, now_us + target->joint_time_us[j]};
            axis->own_until_us = 0;
            robot->halts_owed &= ~GROBO_JOINT_BIT(j);
            grobo_i_joint_to(axis, GROBO_I_JOINT_GOAL);
            if (parts && grobo_i_segments_wanted(robot, j, target->joint_time_us[j])) {
                grobo_i_segments_begin(robot, j);
            }
        }
    }
}

static void note_hold(grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(joints, j)) {
            if (GROBO_I_EXTRA(grobo_i_driver_of(robot, j), goal_energises) &&
                !grobo_i_axis_is_on(&robot->axes[j])) {
                grobo_i_gate_soften(robot); /* it has torque by this */
            }
            grobo_i_axis_rest(&robot->axes[j], robot->now_us);
            robot->axes[j].own_until_us = 0;
            grobo_i_joint_to(&robot->axes[j], GROBO_I_JOINT_HOLD);
            robot->halts_owed &= ~GROBO_JOINT_BIT(j);
        }
    }
}

/* Torque goes off: a trajectory in segments ends where the servo was told to go. */
static void let_go(grobo_robot_axis *axis)
{
    if (grobo_i_is_in_segments(axis)) {
        grobo_i_axis_cut(axis);
    }
    grobo_i_joint_to(axis, GROBO_I_JOINT_OFF);
    axis->wants_torque = axis->torque_known = false;
}

/* Assumes that the switch succeeds; a later reading shows it. */
static void note_torque(grobo_robot *robot, const saying *says)
{
    grobo_joint_mask on = says->torqued[GROBO_TORQUE_ON];
    grobo_joint_mask off = says->torqued[GROBO_TORQUE_OFF] | says->torqued[GROBO_TORQUE_BRAKE];
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(off, j)) {
            let_go(axis);
        } else if (grobo_i_has(on, j) && !grobo_i_axis_is_on(axis)) {
            axis->torque_known = false;
            grobo_i_gate_soften(robot); /* a hand may have moved it as long as it was off */
        }
    }
}

static void note_pace(grobo_robot *robot, const grobo_robot_slot *slot, const grobo_target *target)
{
    int64_t longest_us = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        int64_t time_us = grobo_i_has(target->posture.set, j) ? target->joint_time_us[j] : 0;
        longest_us = grobo_i_later(longest_us, time_us);
    }
    if (slot->due_us != GROBO_NEVER_US) {
        robot->soft = false; /* what the sequencer sends next begins there */
    } else if (slot->order.single && robot->soft && robot->soft_us == GROBO_NEVER_US) {
        robot->soft_us = robot->now_us + longest_us;
    }
}

static void note_goals(grobo_robot *robot, const grobo_robot_slot *slot, const saying *says)
{
    const grobo_target *target = &says->target;
    if (target->posture.set == 0) {
        return;
    }
    note_trajectory(robot, &slot->order, target);
    note_pace(robot, slot, target);
    robot->played_joints &= ~target->posture.set;
    robot->played_joints |= slot->due_us != GROBO_NEVER_US ? target->posture.set : 0;
}

/* A driver that needs several frames for one joint has the goal in the last of them: until that has
 * left, the joint is on the trajectory of before. */
static bool is_before_goal(grobo_robot *robot, const grobo_robot_slot *slot, const saying *says)
{
    const grobo_robot_order *order = &slot->order;
    grobo_exchange next;
    return GROBO_I_EXTRA(robot->driver, tells_no_speed) && order->kind == GROBO_I_ORDER_GOAL &&
           grobo_joints_count(order->joints) == 1 &&
           grobo_i_driver_of(robot, grobo_i_lowest(order->joints))->tells_no_speed &&
           make_frame(robot, order, says, &says->target, order->part + 1, &next) > 0;
}

static void note(grobo_robot *robot, const grobo_robot_slot *slot, const saying *says)
{
    if (is_before_goal(robot, slot, says)) {
        robot->axes[grobo_i_lowest(slot->order.joints)].told_us = robot->now_us;
        return;
    }
    grobo_joint_mask stopped = grobo_i_wheel_note(robot, &says->speeds);
    switch ((grobo_i_order_kind)slot->order.kind) {
    case GROBO_I_ORDER_NONE:
    case GROBO_I_ORDER_SPEED:
    case GROBO_I_ORDER_GOAL:
    case GROBO_I_ORDER_HALT:
    case GROBO_I_ORDER_TORQUE:
    case GROBO_I_ORDER_RAW:
        note_torque(robot, says);
        note_goals(robot, slot, says);
        break;
    case GROBO_I_ORDER_SEGMENT:
        grobo_i_segments_told(robot, &says->target);
        return; /* the trajectory is the one that was noted */
    case GROBO_I_ORDER_HOLD:
        note_hold(robot, says->target.posture.set);
        break;
    case GROBO_I_ORDER_UNKNOWN:
        forget(robot, slot->order.joints, false);
        break;
    case GROBO_I_ORDER_SETTING:
    case GROBO_I_ORDER_COMMAND:
        forget(robot, slot->order.joints, true); /* the servo is without torque afterwards */
        break;
    }
    bool halts = slot->order.kind == GROBO_I_ORDER_HALT; /* of its joints those that move */
    grobo_joint_mask told =
        halts ? says->target.posture.set | says->speeds.joints : slot->order.joints;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(told, j)) {
            robot->axes[j].told_us = robot->now_us;
            grobo_i_stand_forget(&robot->axes[j]);
            robot->axes[j].last = slot->order.number;
        }
    }
    grobo_i_halt_left(robot, told & ~stopped, halts || slot->order.rests);
    if (stopped != 0) {
        grobo_i_halt_left(robot, stopped, true);
    }
    if (slot->order.kind == GROBO_I_ORDER_GOAL && !slot->order.stops) {
        grobo_i_often_soon(robot);
    }
    grobo_i_gate_unwait(robot, &slot->order);
}

/* ---- leaving --------------------------------------------------------------------------------- */

void grobo_i_gate_unwait(grobo_robot *robot, const grobo_robot_order *order)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(order->joints, j) && order->number != 0 && axis->next == order->number) {
            axis->next = 0;
        }
    }
}

/* Joints of an order that wait for it, and whose place is unknown. */
static grobo_joint_mask unknown_of(const grobo_robot *robot, const grobo_robot_order *order)
{
    grobo_joint_mask joints = 0;
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        bool waits = robot->axes[j].next == order->number && grobo_i_axis_is_unknown(robot, j);
        joints |= waits ? order->joints & GROBO_JOINT_BIT(j) : 0;
    }
    return joints;
}

/* True if a retry is superseded: another frame has left for one of its joints since. */
static bool is_passed(const grobo_robot *robot, const grobo_robot_slot *slot)
{
    for (int j = 0; slot->txn.sent_us >= 0 && j < robot->driver->model->n_joints; j++) {
        if (grobo_i_has(slot->order.joints, j) && robot->axes[j].told_us > slot->txn.sent_us) {
            return true;
        }
    }
    return false;
}

/* What no frame may do, whatever the judgement was. */
static void assert_leaving(const grobo_robot_slot *slot, const saying *says)
{
    const grobo_robot *robot = slot->robot;
    const grobo_robot_order *order = &slot->order;
    const grobo_posture *to = &says->target.posture;
    grobo_joint_mask on = says->torqued[GROBO_TORQUE_ON];
    int joint = -1;
    GROBO_ASSERT(slot->txn.frame_bytes > 0);
    GROBO_ASSERT((to->set & ~grobo_i_all_joints(robot)) == 0 && (on & ~order->joints) == 0);
    GROBO_ASSERT(to->set == 0 || grobo_i_target_check(robot, to, &joint) == GROBO_OK);
    GROBO_ASSERT(!robot->trip.latched || on == 0);
    GROBO_ASSERT(!robot->trip.latched || to->set == 0 || order->stops);
    GROBO_ASSERT((to->set & robot->free_joints) == 0 || order->kind == GROBO_I_ORDER_HOLD ||
                 order->kind == GROBO_I_ORDER_HALT);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        GROBO_ASSERT(!grobo_i_has(to->set, j) || says->target.joint_time_us[j] > 0 ||
                     order->kind == GROBO_I_ORDER_RAW);
    }
}

/* The frame of a slot, where the judgement reads it. */
static const grobo_exchange *waiting(const grobo_robot_slot *slot)
{
    grobo_exchange *frame = &slot->robot->built;
    if (slot->order.kind == GROBO_I_ORDER_RAW) {
        frame->frame_bytes = slot->txn.frame_bytes;
        memcpy(frame->frame, slot->txn.frame, slot->txn.frame_bytes);
    }
    return frame;
}

/* True if the waiting frame equals the one that would be built now. */
static bool is_same_frame(const grobo_robot_slot *slot, const saying *says)
{
    grobo_exchange fresh;
    return make_frame(slot->robot, &slot->order, says, &says->target, slot->order.part, &fresh) >
               0 &&
           fresh.frame_bytes == slot->txn.frame_bytes &&
           memcmp(fresh.frame, slot->txn.frame, fresh.frame_bytes) == 0;
}

/* Builds the frame of a slot from the judged contents. */
static int build_anew(grobo_robot_slot *slot, saying *says)
{
    grobo_robot *robot = slot->robot;
    grobo_target part;
    const grobo_target *target = aim(robot, &slot->order, says, &part);
    if (slot->order.stands && stands(robot, says, target)) {
        GROBO_ASSERT(!GROBO_ASSERT_WALKS || is_same_frame(slot, says));
        return GROBO_OK;
    }
    slot->order.stands = false; /* it may be built for another time now */
    int result = make_frame(robot, &slot->order, says, target, slot->order.part, &robot->built);
    return result > 0 ? grobo_i_slot_renew(slot) : result == 0 ? GROBO_ERR_EMPTY : result;
}

int grobo_i_gate_leave(grobo_robot_slot *slot)
{
    grobo_robot *robot = slot->robot;
    moment when = slot->txn.sent_us >= 0 ? LEAVES_AGAIN : LEAVES;
    saying says;
    GROBO_ASSERT(slot->use != GROBO_I_USE_FREE && robot->link);
    if (slot->order.kind == GROBO_I_ORDER_NONE && slot->order.joints == 0) {
        return GROBO_OK; /* a reading: it tells no joint anything */
    }
    if (slot->order.rests) { /* who became unknown while it waited is not brought to rest by it */
        grobo_i_halt_owe(robot, unknown_of(robot, &slot->order));
    }
    int result = is_passed(robot, slot) ? GROBO_ERR_SUPERSEDED
                                        : judge(robot, &slot->order, waiting(slot), when, &says);
    if (result >= 0 && is_built(&slot->order)) {
        result = build_anew(slot, &says);
    }
    if (result < 0) {
        return result;
    }
    assert_leaving(slot, &says);
    note(robot, slot, &says);
    return GROBO_OK;
}
