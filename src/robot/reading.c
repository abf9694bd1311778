/* SPDX-License-Identifier: MIT */
/* What a reading tells of a joint. */
#include <math.h>
#include <stdlib.h>

#include "src/base/instant.h"
#include "src/model/joint.h"
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/gate.h"
#include "src/robot/reading.h"
#include "src/robot/robot.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/weight.h"
#include "src/robot/wheel.h"

static void merge(grobo_robot_axis *axis, const grobo_joint_state *got)
{
    grobo_joint_state *state = &axis->state;
    uint16_t valid = (uint16_t)(state->valid | got->valid);
    grobo_joint_state old = *state;
    *state = *got;
    state->valid = valid;
#define KEEP(bit, field)                                                                           \
    if ((got->valid & (bit)) == 0) {                                                               \
        state->field = old.field;                                                                  \
    }
    KEEP(GROBO_FIELD_ANGLE, angle_rad)
    KEEP(GROBO_FIELD_GOAL, goal_rad)
    KEEP(GROBO_FIELD_GOAL, goal_time_us)
    KEEP(GROBO_FIELD_TIME, time_us)
    KEEP(GROBO_FIELD_SPEED, speed_dps)
    KEEP(GROBO_FIELD_CURRENT, current_ma)
    KEEP(GROBO_FIELD_TEMPERATURE, temperature_c)
    KEEP(GROBO_FIELD_VOLTAGE, voltage_mv)
    KEEP(GROBO_FIELD_TORQUE, torque)
    KEEP(GROBO_FIELD_TORQUE_LIMIT, torque_limited)
    KEEP(GROBO_FIELD_FAST, fast)
    KEEP(GROBO_FIELD_RANGE, low_rad)
    KEEP(GROBO_FIELD_RANGE, high_rad)
#if !GROBO_DRIVERS_PLAIN
    KEEP(GROBO_FIELD_GOAL, goal_rad_s)
#endif
#undef KEEP
}

static double correction(const grobo_robot *robot, int joint)
{
    const grobo_driver *driver = robot->driver;
    double add_rad = 0;
    for (int i = 0; robot->config.readback_correction && i < driver->n_readback; i++) {
        add_rad += driver->readback[i].joint == joint ? driver->readback[i].add_rad : 0;
    }
    return add_rad;
}

double grobo_i_hold_rad(const grobo_robot *robot, int joint)
{
    const grobo_i_limits limits = grobo_i_joint_limits(robot, joint);
    double angle_rad = robot->axes[joint].state.angle_rad - correction(robot, joint);
    double outside_rad = grobo_rad_from_deg(GROBO_I_HOLD_OUTSIDE_DEG);
    if (grobo_i_is_wheel(robot, joint)) {
        return angle_rad;
    }
    bool near =
        angle_rad >= limits.min_rad - outside_rad && angle_rad <= limits.max_rad + outside_rad;
    return near ? fmin(fmax(angle_rad, limits.min_rad), limits.max_rad) : (double)NAN;
}

/* Where a servo is going, if it told: its angle was read. One that has time left creeps there,
 * however slowly. A host that was away, or another one, may have sent it.
 * @return whether it is externally moved: nobody knows where to. */
static bool take_move(grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    const unsigned move = GROBO_FIELD_GOAL | GROBO_FIELD_TIME;
    grobo_robot_axis *axis = &robot->axes[joint];
    bool torque = (got->valid & GROBO_FIELD_TORQUE) != 0 || axis->torque_known; /* in parts */
    if ((got->valid & GROBO_FIELD_SPEED) == 0 || !torque) {
        return grobo_i_is_external(axis);
    }
    bool on = axis->state.torque == GROBO_TORQUE_ON;
    bool moves = on && abs(got->speed_dps) >= GROBO_I_SLOW_DPS;
    if ((got->valid & move) == move) {
        double most_rad_s = grobo_i_joint(robot->driver->model, joint)->max_speed_rad_s;
        double way_rad = fabs(got->goal_rad - got->angle_rad);
        int64_t least_us = (int64_t)(way_rad / most_rad_s * 1e6);
        int64_t left_us = got->goal_time_us - got->time_us;
        bool creeps = on && got->speed_dps != 0 && left_us > 0;
        left_us = left_us > least_us ? left_us : least_us;
        axis->own_until_us = axis->angle_us + (moves || creeps ? left_us : 0);
    }
    return moves && !grobo_i_has_target(axis) && axis->own_until_us <= robot->now_us &&
           !grobo_i_swings(robot, joint) && !grobo_i_is_wheel(robot, joint);
}

/* True if the servo has told since the last frame that its goal is another one; or did so before
 * this reading, and does not move but on the trajectory it told of then. */
static bool has_not_taken(const grobo_robot *robot, int joint, const grobo_joint_state *got)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    bool as_told = abs(got->speed_dps) < GROBO_I_SLOW_DPS || axis->own_until_us > robot->now_us;
    bool before = grobo_i_goal_is_told(axis) && as_told;
    bool told = (got->valid & GROBO_FIELD_GOAL) != 0 || before;
    return told && fabs(axis->state.goal_rad - axis->trajectory.to_rad) >
                       grobo_i_same_goal_rad(robot, joint);
}

/* So long after its frame left a joint that is no place between the begin of its trajectory and
 * where it should be by then is not on it: a weak one is behind, one that turns back has done
 * so. */
#define TURNED_US 200000

/* One that is sent somewhere so fast, has had the time to begin, and stands so far beside its
 * trajectory is not on it. */
#define BEGUN_RAD_S (30 * 0.017453292519943295)
#define BESIDE_RAD (2 * 0.017453292519943295)

static bool is_fast(const grobo_robot_trajectory *trajectory, int64_t then_us)
{
    double way_rad = fabs(trajectory->to_rad - trajectory->from_rad);
    return trajectory->to_us > then_us &&
           way_rad * 1e6 > BEGUN_RAD_S * (double)(trajectory->to_us - trajectory->from_us);
}

/* True of one whose servo has ramps, and that was read last to turn the other way: it stands for a
 * moment where its trajectory begins. What was read last is in `axis` yet. */
static bool may_turn_back(const grobo_robot *robot, int joint, int64_t asked_us,
                          const grobo_joint_state *got)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    const grobo_robot_trajectory *trajectory = &axis->trajectory;
    bool ramps = GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), accel_rad_s2) > 0;
    if (!ramps || !grobo_i_has_target(axis) || axis->seen_dps == GROBO_I_NO_SPEED) {
        return false;
    }
    bool otherwise = abs(axis->seen_dps) >= GROBO_I_SLOW_DPS &&
                     axis->seen_dps * (trajectory->to_rad - trajectory->from_rad) < 0;
    return otherwise && asked_us - axis->told_us <= TURNED_US &&
           axis->told_us - axis->seen_us <= TURNED_US &&
           fabs(got->angle_rad - trajectory->from_rad) <= GROBO_I_OFF_TRAJECTORY_RAD;
}

/* A joint that stands still, or creeps, beside its trajectory has lost the frame, and so has one
 * that is ahead of it, or before it for long, or whose goal is another. Until the next one it is
 * where it was read, or on the trajectory that its servo told of: a stop would throw it to where
 * it should be by then. The angle alone tells nothing of it. */
static bool is_off_trajectory(const grobo_robot *robot, int joint, int64_t asked_us,
                              const grobo_joint_state *got, bool turns_back)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    if ((got->valid & GROBO_FIELD_SPEED) == 0) {
        return grobo_i_is_stray(axis);
    }
    if (!grobo_i_has_target(axis) || grobo_i_is_in_segments(axis)) {
        return false;
    }
    if (has_not_taken(robot, joint, got)) {
        return true;
    }
    double then_rad = grobo_i_trajectory_at(&axis->trajectory, asked_us);
    double now_rad = grobo_i_trajectory_at(&axis->trajectory, robot->now_us);
    double set_rad = got->angle_rad + grobo_i_load(axis);
    double beside_rad = fmin(fabs(set_rad - then_rad), fabs(set_rad - now_rad));
    bool between = (set_rad - axis->trajectory.from_rad) * (now_rad - set_rad) >= 0;
    bool elsewhere = !between && asked_us - axis->told_us > TURNED_US;
    bool stands = abs(got->speed_dps) < GROBO_I_SLOW_DPS && !turns_back;
    bool never_began = stands && is_fast(&axis->trajectory, asked_us) && beside_rad > BESIDE_RAD &&
                       asked_us - axis->told_us > GROBO_I_BEGUN_US;
    return never_began || (beside_rad > GROBO_I_OFF_TRAJECTORY_RAD && (elsewhere || stands));
}

/* No frame has told it the trajectory that it is taken to be on (grobo_i_astray()). */
static bool is_astray(const grobo_robot_axis *axis)
{
    return grobo_i_is_stray(axis) && axis->trajectory.from_us > axis->told_us;
}

/* What a reading tells of where the joint is by now. */
static void take_place(grobo_robot *robot, int joint, int64_t asked_us,
                       const grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if ((got->valid & GROBO_FIELD_GOAL) != 0) {
        axis->goal_us = robot->now_us;
    }
    if ((got->valid & GROBO_FIELD_TORQUE) != 0) {
        axis->torque_known = true;
        axis->torque_us = robot->now_us;
    }
    if ((got->valid & GROBO_FIELD_ANGLE) != 0) {
        bool turns_back = may_turn_back(robot, joint, asked_us, got);
        grobo_i_stand_seen(robot, joint, asked_us, axis->state.angle_rad);
        grobo_i_axis_seen(axis, asked_us, got);
        bool external = take_move(robot, joint, got);
        bool stray = is_astray(axis) || is_off_trajectory(robot, joint, asked_us, got, turns_back);
        grobo_i_joint_to(axis, stray      ? GROBO_I_JOINT_STRAYS
                               : external ? GROBO_I_JOINT_TURNS
                                          : GROBO_I_JOINT_READ);
        if (!grobo_i_axis_is_counted(axis) && !grobo_i_is_wheel(robot, joint)) {
            grobo_i_load_take(robot, joint, got);
        }
        if (!grobo_i_has_target(axis)) {
            grobo_i_axis_here(axis, robot->now_us);
        }
    }
}

/* A servo that is not set up for its joint tells its torque, so that it may be made limp, and what
 * it measures of itself; what its angles mean is not known. */
static void take_no_angles(grobo_robot *robot, int joint, int64_t asked_us, grobo_joint_state *got)
{
    got->valid &= (uint16_t) ~(GROBO_FIELD_ANGLE | GROBO_FIELD_GOAL | GROBO_FIELD_SPEED |
                               GROBO_FIELD_TIME | GROBO_FIELD_RANGE);
    merge(&robot->axes[joint], got);
    if (asked_us >= robot->axes[joint].told_us) {
        take_place(robot, joint, asked_us, got);
    }
}

/* An answer that came so late was on its way when the host was away: it is of then. */
#define LATE_ANSWER_US 100000

/* Between angles so far apart lies a speed. */
#define SPEED_LEAST_US 10000
#define SPEED_MOST_US 500000

/* The mean speed since the angle before, of a servo that tells none. */
static void take_speed(const grobo_robot *robot, int joint, int64_t read_us, grobo_joint_state *got)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    int64_t us = axis->angle_us == GROBO_NEVER_US ? 0 : read_us - axis->angle_us;
    const unsigned both = GROBO_FIELD_ANGLE | GROBO_FIELD_SPEED;
    if (GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed) &&
        (got->valid & both) == GROBO_FIELD_ANGLE && us >= SPEED_LEAST_US && us <= SPEED_MOST_US) {
        double way_rad = got->angle_rad - axis->state.angle_rad;
        double way_deg = grobo_deg_from_rad(grobo_i_wheel_apart(robot, joint, way_rad));
        got->speed_dps = (int32_t)(way_deg * 1e6 / (double)us);
        got->valid |= GROBO_FIELD_SPEED;
    }
}

/* Between an angle from before it was told to go elsewhere and one since then lies the speed of
 * neither trajectory; between one from before a stop and one since then, that of a joint that
 * another program may have set going meanwhile. */
static bool is_of_one_trajectory(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    return !GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed) ||
           axis->angle_us >= grobo_i_later(axis->told_us, robot->stop_us);
}

/* asked_us: when the joint was asked first. A late answer may be of before a frame that has left
 * meanwhile: it restores nothing of what that frame has made unknown. */
static void take_reading(grobo_robot *robot, int joint, int64_t asked_us, grobo_joint_state *got)
{
    grobo_robot_axis *axis = &robot->axes[joint];
    if ((got->valid & GROBO_FIELD_ANGLE) != 0) {
        got->angle_rad += correction(robot, joint);
    }
    bool late = !GROBO_DRIVERS_PLAIN && robot->now_us - asked_us > LATE_ANSWER_US;
    int64_t read_us = late ? asked_us : robot->now_us;
    take_speed(robot, joint, read_us, got);
    bool one_trajectory = is_of_one_trajectory(robot, joint);
    if (grobo_i_followers(robot) != 0 && (got->valid & GROBO_FIELD_ANGLE) != 0) {
        axis->before_rad = axis->state.angle_rad;
        axis->before_us = axis->angle_us;
    }
    merge(axis, got);
    axis->status = GROBO_OK;
    axis->lost = 0;
    if ((got->valid & GROBO_FIELD_ANGLE) != 0) {
        axis->angle_us = read_us;
    }
    if ((got->valid & GROBO_FIELD_TEMPERATURE) != 0) { /* not every family measures a current */
        axis->full_us = robot->now_us;
    }
    if (asked_us >= axis->told_us) {
        take_place(robot, joint, asked_us, got);
        axis->seen_dps = one_trajectory ? axis->seen_dps : GROBO_I_NO_SPEED;
    }
}

bool grobo_i_is_loss(int result)
{
    return result == GROBO_ERR_TIMEOUT || result == GROBO_ERR_SHORT ||
           result == GROBO_ERR_CHECKSUM || result == GROBO_ERR_MISMATCH;
}

/* The answer to a goal shows that it came, not what the servo made of it. */
static void note_goal(const grobo_robot_slot *slot, const grobo_joint_state *got)
{
    grobo_robot_axis *axis = &slot->robot->axes[slot->joint];
    bool read = (slot->reads || slot->many) && (got->valid & GROBO_FIELD_GOAL) != 0;
    axis->goal_is_read = axis->goal_is_read || (read && slot->asked_us >= axis->told_us);
}

/* What a servo says shows that it does not restart; that it has torque, only a reading shows: the
 * answer to a goal comes from one that the goal has woken, too. */
static void note_heard(const grobo_robot_slot *slot, const grobo_joint_state *got)
{
    grobo_robot *robot = slot->robot;
    grobo_robot_axis *axis = &robot->axes[slot->joint];
    bool read = slot->reads || slot->many;
    bool slept = grobo_i_may_sleep(robot, slot->joint);
    bool on = (got->valid & GROBO_FIELD_TORQUE) != 0 && got->torque == GROBO_TORQUE_ON;
    if ((read && on) || slot->robot->now_us - axis->heard_us <= GROBO_I_RESTART_US) {
        axis->heard_us = grobo_i_later(axis->heard_us, slot->asked_us);
    }
    /* Where one broken reply of many puts joints to sleep, that is often: the part of its
     * trajectory that it was not sent follows at once, since its last one ends soon. */
    bool many = GROBO_I_EXTRA(robot->driver, sense_many) != NULL;
    if (many && slept && grobo_i_is_in_segments(axis) && !grobo_i_may_sleep(robot, slot->joint)) {
        robot->renews_owed |= GROBO_JOINT_BIT(slot->joint);
    }
}

static void note_silence(grobo_robot *robot, int joint)
{
    int64_t before_us = robot->now_us - GROBO_I_RESTART_US - 1;
    robot->axes[joint].heard_us = grobo_i_sooner(robot->axes[joint].heard_us, before_us);
}

/* A driver may make anything of what comes off the wire. */
static bool is_finite(const grobo_joint_state *got)
{
    bool angle = (got->valid & GROBO_FIELD_ANGLE) == 0 || isfinite(got->angle_rad);
    bool goal = (got->valid & GROBO_FIELD_GOAL) == 0 || isfinite(got->goal_rad);
    return angle && goal;
}

/* A part of a reading whose first part has shown another setup: its angles mean as little. */
static bool is_part_of_unfit(const grobo_robot_slot *slot)
{
    return GROBO_I_EXTRA(slot->robot->driver, sense_more) != NULL && slot->reads &&
           slot->part > 0 && slot->robot->axes[slot->joint].status == GROBO_ERR_SETUP;
}

int grobo_i_reading_take(const grobo_robot_slot *slot, int result, const grobo_packet *reply,
                         grobo_joint_state *got)
{
    grobo_robot *robot = slot->robot;
    const grobo_driver *driver = robot->driver;
    int joint = slot->joint;
    *got = (grobo_joint_state){0};
    if (result >= 0 && reply == NULL) {
        result = GROBO_ERR_MISMATCH;
    }
    if (result >= 0) {
        result = driver->parse(driver, robot->driver_ctx, joint, reply, got);
    }
    if (result >= 0 && !is_finite(got)) {
        result = GROBO_ERR_MISMATCH;
    }
    if (result >= 0 && is_part_of_unfit(slot)) {
        got->setup = robot->axes[joint].state.setup;
        result = GROBO_ERR_SETUP;
    }
    if (result >= 0) {
        result = GROBO_OK;
        take_reading(robot, joint, slot->asked_us, got);
        grobo_robot_axis *axis = &robot->axes[joint];
        if (axis->seen_us == slot->asked_us) { /* mostly it answers the last attempt */
            axis->seen_us = grobo_i_later(axis->seen_us, slot->txn.sent_us);
        }
        note_goal(slot, got);
        if (GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), goal_energises)) {
            note_heard(slot, got);
        }
    } else {
        robot->axes[joint].status = result;
        if (grobo_i_is_loss(result)) {
            robot->axes[joint].lost++;
            note_silence(robot, joint);
        }
        if (result == GROBO_ERR_SETUP) {
            take_no_angles(robot, joint, slot->asked_us, got);
        }
    }
    return result;
}
