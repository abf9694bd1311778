/* SPDX-License-Identifier: MIT */
/*
 * The floors of the engine, the lowest first: a function calls its own floor or lower ones. What
 * must go up goes as data, as an event, or through the two functions of a robot that robot.c sets:
 * `leave` when a frame would leave, `over` when it is over.
 *
 *   event.c      the queue of events
 *   state.c      what moves a joint: states, events, and their table
 *   axis.c       where a joint is, by what it was sent to and what was read
 *   couple.c     joints that follow others
 *   query.c      what may be asked
 *   lines.c      lines of a robot that has several: which frame and which joint is on which
 *   slot.c       frames under way: from an exchange to a transaction and back
 *   budget.c     how many motion frames a second leave time to read
 *   pace.c       how often the line carries more of the trajectories of joints, and readings beside
 *   often.c      how often joints are read while one moves or is strained
 *   stand.c      whether a joint stands
 *   weight.c     the error that carries a joint, and goals that keep it
 *   reading.c    what a reading tells of a joint
 *   trajectories.c       trajectories that are told in segments
 *   speed.c      where targets may be, and how fast joints may go there
 *   wheel.c      speeds of wheels: judged and noted
 *   gate.c       the only way to motors: judges and notes each order as its frame leaves
 *   orders.c     orders to motors: into frames that wait for the line
 *   halted.c     reads back what was halted, and repeats what was lost
 *   job.c        runs the script of a job, step by step
 *   stop.c       what ends the engine's own work and stops joints that move
 *   trip.c       stops for safety
 *   blocked.c    judges angles: joints that are held up or overloaded
 *   watch.c      judges readings
 *   play.c       the sequencer's frames, on time
 *   drive.c      wheels that turn: asked for, told again in time, ended
 *   segments.c   long moves told in parts, in time
 *   sense.c      when the background reads which joint, free mode
 *   check.c      the script that asks whether the robot is there
 *   steps.c      the steps that other scripts are made of
 *   turn.c       the end of a call and of a frame
 *   join.c       requests joint by joint, joined to what was asked for just before
 *   queue.c      which jobs run side by side, and what waits for its turn
 *   request.c    the public requests: checks, then starts a script
 *   control.c    the public controls of a motion
 *   robot.c      life, pump, link
 */
#ifndef GROBO_ROBOT_ROBOT_I_H
#define GROBO_ROBOT_ROBOT_I_H

#include <stddef.h>

#include <grobo/core/lines.h>
#include <grobo/core/static.h>

#include "src/base/sized.h"
#include "src/model/joint.h"
#include "src/robot/state.h"

/* ---- event.c --------------------------------------------------------------------------------- */

/* Puts an event into the queue. */
void grobo_i_tell(grobo_robot *robot, const grobo_event *event);

/* ---- axis.c ---------------------------------------------------------------------------------- */

/* What drivers of servos other than RS30x may have. A build for plain ones (limits.h) knows that it
 * is missing: the compiler leaves out what follows from it. */
#define GROBO_I_EXTRA(driver, member) (GROBO_DRIVERS_PLAIN ? 0 : (driver)->member)

/* The driver of a joint's servo, for what families differ in. Its functions are asked by way of
 * grobo_robot.driver, which knows the joints of all. */
#if GROBO_LINES_MAX > 1
static inline const grobo_driver *grobo_i_driver_of(const grobo_robot *robot, int joint)
{
    const grobo_lines *lines = robot->lines;
    return lines == NULL ? robot->driver : &lines->line[lines->line_of[joint]].driver;
}
#else
static inline const grobo_driver *grobo_i_driver_of(const grobo_robot *robot, int joint)
{
    (void)joint;
    return robot->driver;
}
#endif

/* ---- lines.c --------------------------------------------------------------------------------- */

#if GROBO_LINES_MAX > 1
static inline int grobo_i_lines(const grobo_robot *robot)
{
    return robot->lines == NULL ? 1 : robot->lines->n_lines;
}
static inline grobo_bus *grobo_i_bus(grobo_robot *robot, int line)
{
    return line == 0 ? &robot->bus : &robot->more[line - 1].bus;
}
static inline const grobo_bus *grobo_i_bus_read(const grobo_robot *robot, int line)
{
    return line == 0 ? &robot->bus : &robot->more[line - 1].bus;
}
/* The line of a joint, and of a frame. */
static inline int grobo_i_line_of(const grobo_robot *robot, int joint)
{
    return robot->lines == NULL ? 0 : robot->lines->line_of[joint];
}
static inline int grobo_i_slot_line(const grobo_robot_slot *slot)
{
    return slot->line;
}
/* Joints of a line. */
static inline grobo_joint_mask grobo_i_joints_on(const grobo_robot *robot, int line)
{
    return robot->lines == NULL ? GROBO_JOINTS_ALL(robot->driver->model->n_joints)
                                : robot->lines->on[line];
}
static inline void grobo_i_slot_on(grobo_robot_slot *slot, int line)
{
    slot->line = (uint8_t)line;
}
/* The driver of a line, its first one where there is no such, and what its functions get. */
static inline const grobo_driver *grobo_i_line_driver(const grobo_robot *robot, int line,
                                                      void **ctx)
{
    const grobo_lines *lines = robot->lines;
    int i = lines != NULL && line > 0 && line < lines->n_lines ? line : 0;
    if (ctx != NULL) {
        *ctx = lines != NULL ? lines->line[i].ctx : robot->driver_ctx;
    }
    return lines != NULL ? &lines->line[i].driver : robot->driver;
}
/* Of these joints, those that a goal gives torque. */
grobo_joint_mask grobo_i_woken(const grobo_robot *robot, grobo_joint_mask joints);
/* Makes what a robot of several lines has, where its driver is of such. */
int grobo_i_lines_init(grobo_robot *robot);
/* What the bus of a line is made of, which `whole` has where the line does not say otherwise. */
grobo_bus_config grobo_i_line_config(const grobo_lines *lines, int line,
                                     const grobo_bus_config *whole);
/* The line that a frame is for, by the joints that it is about. */
void grobo_i_slot_aim(grobo_robot_slot *slot);
/* The joint of a motor on a line, or an error. */
int grobo_i_joint_on(const grobo_robot *robot, int line, int motor);
/* Time passes for the lines behind the first one, and when it is to pass next. */
void grobo_i_lines_step(grobo_robot *robot);
int64_t grobo_i_lines_deadline(const grobo_robot *robot, int64_t now_us);
/* grobo_bus_reserve() of these. */
void grobo_i_reserve_more(grobo_robot *robot, int64_t at_us, uint32_t duration_us);
static inline void grobo_i_lines_reserve(grobo_robot *robot, int64_t at_us, uint32_t duration_us)
{
    if (robot->lines != NULL) {
        grobo_i_reserve_more(robot, at_us, duration_us);
    }
}
/* grobo_driver.check() of the line that is asked whether its servos are there. */
int grobo_i_lines_check(grobo_robot *robot, int part);
/* When the last frame of a line was given out, and that it was answered. */
static inline int64_t *grobo_i_left_us(grobo_robot *robot, int line)
{
    return line == 0 ? &robot->left_us : &robot->more[line - 1].left_us;
}
static inline bool *grobo_i_answered(grobo_robot *robot, int line)
{
    return line == 0 ? &robot->answered : &robot->more[line - 1].answered;
}
#else
static inline int grobo_i_lines(const grobo_robot *robot)
{
    (void)robot;
    return 1;
}
static inline void grobo_i_lines_reserve(const grobo_robot *robot, int64_t at_us,
                                         uint32_t duration_us)
{
    (void)robot;
    (void)at_us;
    (void)duration_us;
}
static inline grobo_bus *grobo_i_bus(grobo_robot *robot, int line)
{
    (void)line;
    return &robot->bus;
}
static inline const grobo_bus *grobo_i_bus_read(const grobo_robot *robot, int line)
{
    (void)line;
    return &robot->bus;
}
static inline int grobo_i_line_of(const grobo_robot *robot, int joint)
{
    (void)robot;
    (void)joint;
    return 0;
}
static inline int grobo_i_slot_line(const grobo_robot_slot *slot)
{
    (void)slot;
    return 0;
}
static inline grobo_joint_mask grobo_i_joints_on(const grobo_robot *robot, int line)
{
    (void)line;
    return GROBO_JOINTS_ALL(robot->driver->model->n_joints);
}
static inline grobo_joint_mask grobo_i_woken(const grobo_robot *robot, grobo_joint_mask joints)
{
    return GROBO_I_EXTRA(robot->driver, goal_energises) ? joints : 0;
}
static inline const grobo_driver *grobo_i_line_driver(const grobo_robot *robot, int line,
                                                      void **ctx)
{
    (void)line;
    if (ctx != NULL) {
        *ctx = robot->driver_ctx;
    }
    return robot->driver;
}
static inline void grobo_i_slot_on(grobo_robot_slot *slot, int line)
{
    (void)slot;
    (void)line;
}
static inline void grobo_i_slot_aim(grobo_robot_slot *slot)
{
    (void)slot;
}
static inline int grobo_i_joint_on(const grobo_robot *robot, int line, int motor)
{
    (void)line;
    return grobo_model_joint_of_motor(robot->driver->model, motor);
}
static inline int64_t *grobo_i_left_us(grobo_robot *robot, int line)
{
    (void)line;
    return &robot->left_us;
}
static inline bool *grobo_i_answered(grobo_robot *robot, int line)
{
    (void)line;
    return &robot->answered;
}
#endif
/* The bus of a frame. */
static inline grobo_bus *grobo_i_bus_of(const grobo_robot_slot *slot)
{
    return grobo_i_bus(slot->robot, grobo_i_slot_line(slot));
}
/* True of a frame that is on its wire. */
static inline bool grobo_i_is_active(const grobo_robot_slot *slot)
{
    return grobo_i_bus_of(slot)->active == &slot->txn;
}

/* True if the joint is one of these. */
static inline bool grobo_i_has(grobo_joint_mask joints, int joint)
{
    return (joints & GROBO_JOINT_BIT(joint)) != 0;
}

/* How far its goal is beyond the place where it stands by that: the error that carries its weight;
 * 0 where nothing is known of one (weight.c). The second is what a stop keeps of it. */
static inline double grobo_i_load(const grobo_robot_axis *axis)
{
    return GROBO_DRIVERS_PLAIN ? 0 : axis->load_rad;
}
static inline double grobo_i_load_kept(const grobo_robot_axis *axis)
{
    bool kept = axis->load_is_sure || (grobo_i_has_target(axis) && !grobo_i_is_stray(axis));
    return kept ? grobo_i_load(axis) : 0;
}

/* True if its goal was read, or its servo answered with it, behind the frame that left last: one
 * read at the very moment when that left is the goal before. */
bool grobo_i_goal_is_told(const grobo_robot_axis *axis);
/* True while the servo was not told the end of its trajectory. */
bool grobo_i_trajectory_is_short(const grobo_robot_axis *axis);
/* A servo that reports the time of its trajectory is counted along it. */
static inline bool grobo_i_axis_is_counted(const grobo_robot_axis *axis)
{
    return GROBO_DRIVERS_PLAIN || (axis->state.valid & GROBO_FIELD_TIME) != 0;
}
/* The goal that its servo has, where that is known; false else. */
bool grobo_i_axis_goal(const grobo_robot *robot, int joint, double *goal_rad);
/* The largest error that can be of a weight. */
double grobo_i_load_most(const grobo_robot *robot, int joint);
/* True of a joint that turns as a body that hangs in the goal of its servo: it sinks from there, or
 * swings about the place where it stood. */
bool grobo_i_swings(const grobo_robot *robot, int joint);
/* True of a joint near the goal of its servo, which it may sag from, since it was told that goal or
 * since then, and which did not have the time to come to rest. */
bool grobo_i_may_sag(const grobo_robot *robot, int joint, int64_t since_us);

/* All joints of the model. */
grobo_joint_mask grobo_i_all_joints(const grobo_robot *robot);

/* The first of these joints, of which there is one at least. */
int grobo_i_lowest(grobo_joint_mask joints);
/* Goals that differ by no more are the same on the wire. */
double grobo_i_same_goal_rad(const grobo_robot *robot, int joint);
/* Where a trajectory is by then. */
double grobo_i_trajectory_at(const grobo_robot_trajectory *trajectory, int64_t now_us);
/* Where a joint is by now on the move it was sent on. */
double grobo_i_axis_commanded(const grobo_robot_axis *axis, int64_t now_us);
/* When it is there: on that move, or on the one its servo is on where it lost the frame. */
int64_t grobo_i_axis_until(const grobo_robot_axis *axis);
/* False where a joint is known to be there, or to be without torque. One that was told to let go
 * may not have heard it. */
bool grobo_i_axis_moves(const grobo_robot_axis *axis, int64_t now_us);
/* Where it was last asked to go, whether that frame has left or waits. */
double grobo_i_axis_target(const grobo_robot_axis *axis);
/* An angle this far from the trajectory that a joint was sent on is not of a joint on that
 * trajectory: more than what the fastest one does while a frame is on its trajectory. */
#define GROBO_I_OFF_TRAJECTORY_RAD (12 * 0.017453292519943295)
/* So long after it was told a joint turns that can, and no frame is under way. */
#define GROBO_I_BEGUN_US 100000
/* grobo_robot_axis.seen_dps of a reading without a speed. */
#define GROBO_I_NO_SPEED INT16_MIN
/* True of servos that tell how fast they turn and which way, and not how long: what was read last
 * is all that is known of their turning. */
bool grobo_i_axis_tells_turn(const grobo_robot *robot, int joint);
/* Where a joint is now. What counts is where it was read and how it can have gone on from there:
 * it may be behind its trajectory by far, too weak for it or still turning the other way. A
 * reading from before the last frame that left to it says where it was then, and nothing of how
 * it turns now. */
double grobo_i_axis_place(const grobo_robot *robot, int joint);
/* How fast it turns by that, in radians a second. */
double grobo_i_axis_speed(const grobo_robot *robot, int joint);
/* How long it needs to come to rest, in microseconds; 0 of servos without ramps. */
double grobo_i_axis_brake_us(const grobo_robot *robot, int joint);
/* Where it comes to rest that is told so now, and no sooner than by then. */
double grobo_i_axis_reached(const grobo_robot *robot, int joint, int64_t rest_us);
/* What was read of where a joint is; and that it is told to go elsewhere from now on. */
void grobo_i_axis_seen(grobo_robot_axis *axis, int64_t asked_us, const grobo_joint_state *got);
void grobo_i_axis_told(grobo_robot *robot, int joint);
/* True of one that an angle alone has shown not to be at the end of its trajectory: it may turn. */
bool grobo_i_axis_is_late(const grobo_robot_axis *axis);
/* True of one whose trajectory is over and that was read not to be there yet, or lately to turn
 * and not to be on it. */
bool grobo_i_axis_lags(const grobo_robot *robot, int joint);
/* Takes the sensed angle for where a joint is, nothing being asked of it. */
void grobo_i_axis_rest(grobo_robot_axis *axis, int64_t now_us);
/* Takes what was read for where a joint is: at the angle, or on the move the servo told of. */
void grobo_i_axis_here(grobo_robot_axis *axis, int64_t now_us);
/* The limits of a joint: those of the model, or the narrower ones that its servo keeps. */
typedef struct grobo_i_limits {
    double min_rad, max_rad;
} grobo_i_limits;
grobo_i_limits grobo_i_joint_limits(const grobo_robot *robot, int joint);
/* False where a joint has a torque limit that its servo was not read to keep. */
bool grobo_i_torque_is_limited(const grobo_robot *robot, int joint);
/* True if it is known to have torque. */
bool grobo_i_axis_is_on(const grobo_robot_axis *axis);
/* True if it is known to have none, or to brake. */
bool grobo_i_axis_is_limp(const grobo_robot_axis *axis);
/* A servo that restarts hears nothing for longer: KRS find out for 500 ms how they are to be driven
 * (ICS 3.5 manual). Of the others the makers do not say. */
#define GROBO_I_RESTART_US 400000
/* True if its servo may have restarted since it was known to have torque, and its next goal would
 * wake it, wherever it sank to: nothing came from it for so long, or a reply was lost. */
bool grobo_i_may_sleep(const grobo_robot *robot, int joint);
/* True where nobody knows where a joint is: it was not read since the line is there, it was read
 * to turn beside its trajectory a while ago, or its servo may have restarted. A stop reads it
 * before it halts it. */
bool grobo_i_axis_is_unknown(const grobo_robot *robot, int joint);
/* False behind an emergency stop, which halts nobody where it takes the torque; of halts from
 * before it those alone leave that grobo_robot_latch() has found waiting. */
bool grobo_i_may_halt(const grobo_robot *robot);
/* The trajectory of a joint in segments ends where it was told to go. */
void grobo_i_axis_cut(grobo_robot_axis *axis);
/* True while a joint is on the trajectory it was sent on, or a target waits for the line. */
bool grobo_i_moving(const grobo_robot *robot, int64_t now_us);
/* True if one of these moves though nothing was asked of it, nobody knows where to; *joint is the
 * first of them, else -1. */
bool grobo_i_externally_moved(const grobo_robot *robot, grobo_joint_mask joints, int *joint);
/* True if all of these were sensed; else *joint is one that was not. */
bool grobo_i_all_sensed(const grobo_robot *robot, grobo_joint_mask joints, int *joint);
/* True if all of these are known to have torque. */
bool grobo_i_all_on(const grobo_robot *robot, grobo_joint_mask joints);

/* ---- couple.c -------------------------------------------------------------------------------- */

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

/* ---- robot.c --------------------------------------------------------------------------------- */

/* What was known of these joints may be wrong: their line went. */
void grobo_i_forget_joints(grobo_robot *robot, grobo_joint_mask joints);

/* Bytes of an engine with no more axes than this robot has joints: what lies behind them of a
 * grobo_robot is not there. */
size_t grobo_i_robot_bytes(const grobo_driver *driver);

/* grobo_robot_configure() for who pumps afterwards: nobody is woken, so nothing leaves by it.
 * Without `senses` nothing is read in the background, whatever it says. */
int grobo_i_robot_configure(grobo_robot *robot, const grobo_robot_config *config, bool senses);

/* ---- query.c --------------------------------------------------------------------------------- */

/* Around whatever is told or asked of the engine, where several threads may; see
 * grobo_robot_host. Functions where a word has 32 bits: code is short there. */
#if SIZE_MAX > UINT32_MAX
static inline void grobo_i_lock(const grobo_robot *robot)
{
    if (robot->host.lock != NULL) {
        robot->host.lock(robot->host.ctx);
    }
}
static inline void grobo_i_unlock(const grobo_robot *robot)
{
    if (robot->host.unlock != NULL) {
        robot->host.unlock(robot->host.ctx);
    }
}
#else
void grobo_i_lock(const grobo_robot *robot);
void grobo_i_unlock(const grobo_robot *robot);
#endif
/* The time of a request or a question. */
int64_t grobo_i_now(const grobo_robot *robot);

/* True if requests that move are refused: behind a latched stop, and one that is on its
 * trajectory. */
bool grobo_i_is_latched(const grobo_robot *robot);

/* True if a frame waits that the wire has time for now; `any`: or any, and the line is free. */
bool grobo_i_has_frame(const grobo_robot *robot, int line, bool any, int64_t now_us);

/* True if the frame that has just left stops joints. */
bool grobo_i_frame_stops(const grobo_robot *robot, int line);
/* grobo_robot_stops() of a line. */
bool grobo_i_stops(const grobo_robot *robot, int line, int64_t now_us);

/* True if that is true of a job that runs; NULL: if one runs. */
bool grobo_i_jobs_any(const grobo_robot *robot, bool (*is)(const grobo_robot_task *job));

/* grobo_robot_is_playing() for the engine itself, which is locked. */
bool grobo_i_is_playing(const grobo_robot *robot);

/* True while joints are being moved, by a job or by the sequencer. */
bool grobo_i_in_motion(const grobo_robot *robot);

/* ---- holds.c --------------------------------------------------------------------------------- */

/* Asserts what always holds between two calls; nothing with NDEBUG. */
void grobo_i_robot_assert(const grobo_robot *robot);

/* ---- slot.c ---------------------------------------------------------------------------------- */

/* What a frame under way is for. */
typedef enum grobo_i_use {
    GROBO_I_USE_FREE = 0,
    GROBO_I_USE_JOB,     /* its end goes to the job that is named in it */
    GROBO_I_USE_SENSE,   /* a reading of the background */
    GROBO_I_USE_MOTION,  /* a target; a played one if it has a due time */
    GROBO_I_USE_SEGMENT, /* further on the trajectories of targets that have left */
    GROBO_I_USE_HALT,    /* what moves is to stop */
    GROBO_I_USE_SPEED,   /* wheels turn on */
    GROBO_I_USE_PLAIN    /* sent for its effect; a later reading shows whether it took */
} grobo_i_use;

/* What a frame does to joints: grobo_robot_order.kind. */
typedef enum grobo_i_order_kind {
    GROBO_I_ORDER_NONE = 0, /* it reads, or writes what moves nothing */
    GROBO_I_ORDER_GOAL,     /* joints go to their targets, grobo_robot_axis.next */
    GROBO_I_ORDER_SEGMENT,  /* joints go further on the trajectories that they are on */
    GROBO_I_ORDER_HALT,     /* joints that move stop where they are by then */
    GROBO_I_ORDER_HOLD,     /* goals of joints without torque become where they are */
    GROBO_I_ORDER_TORQUE,   /* torque is switched */
    GROBO_I_ORDER_RAW,      /* what the driver reads in a frame of the user's */
    GROBO_I_ORDER_UNKNOWN,  /* nobody can read what: a raw frame, a motion of the robot's own */
    GROBO_I_ORDER_SETTING,  /* a goal means something else to these afterwards */
    GROBO_I_ORDER_COMMAND,  /* a servo is busy with itself; `joints` restart without torque */
    GROBO_I_ORDER_SPEED     /* wheels go on to the speeds that they were asked for */
} grobo_i_order_kind;

/* The index of a free slot, or -1; there is always one for a halt. */
int grobo_i_slot_find(const grobo_robot *robot, grobo_i_use use);
/* Takes it, with a zeroed order and grobo_robot.built (but for the bytes of the frame), or NULL. */
grobo_robot_slot *grobo_i_slot_take(grobo_robot *robot, grobo_i_use use);
/* Gives the bus this frame, which is copied; on error the slot is free again. */
int grobo_i_slot_send(grobo_robot_slot *slot, const grobo_exchange *exchange,
                      grobo_priority priority);
/* Puts grobo_robot.built in the place of the frame that waits. @return GROBO_OK, or GROBO_ERR_SPACE
 * where it is longer than that was at first. */
int grobo_i_slot_renew(grobo_robot_slot *slot);
/* Makes grobo_robot.built ask all of slot->unread, by the driver's sense_many(). @return GROBO_OK
 * or an error of the driver. */
int grobo_i_slot_ask_unread(grobo_robot_slot *slot);
/* Gives a slot back that was not sent. */
void grobo_i_slot_drop(grobo_robot_slot *slot);
/* A stop waits: the reply on the line gets no more time than the shortest margin. */
void grobo_i_slots_hurry(grobo_robot *robot);
/* Takes back every frame that has not left. */
void grobo_i_slots_cancel_all(grobo_robot *robot);
/* Takes back every frame of this use, but for one that waits to bring a motion to rest. */
void grobo_i_slots_cancel(grobo_robot *robot, grobo_i_use use);
/* Takes back every frame that a step of this job made. */
void grobo_i_slots_cancel_job(grobo_robot *robot, int number);
/* Takes back targets that have not left and move one of these joints; `played`: and those of the
 * motion that is played. Not what brings it to rest. */
void grobo_i_slots_cancel_goals(grobo_robot *robot, grobo_joint_mask joints, bool played);
/* Takes back targets that have not left and move none but these joints: what others wait for in the
 * same frame leaves. */
void grobo_i_slots_cancel_own(grobo_robot *robot, grobo_joint_mask joints);
/* Takes back the parts of an order that wait behind this one, which has failed. */
void grobo_i_slots_cancel_rest(const grobo_robot_slot *before);
/* Takes back every frame of this job that has not left. @return the joints of their orders. */
grobo_joint_mask grobo_i_slots_take_back(grobo_robot *robot, int number);
/* True if a frame of this job that reads one of these joints has left. */
bool grobo_i_slots_read(const grobo_robot *robot, int number, grobo_joint_mask joints);
/* Takes back frames that would switch the torque of one of these joints on. */
void grobo_i_slots_keep_off(grobo_robot *robot, grobo_joint_mask joints);
/* True if such an order to the joint waits for the line; `torque` OFF where it switches none. */
bool grobo_i_slots_wait(const grobo_robot *robot, grobo_joint_mask joint, grobo_i_order_kind kind,
                        grobo_torque torque);
/* True if a frame of this use is under way. */
bool grobo_i_slots_busy(const grobo_robot *robot, grobo_i_use use);

/* ---- budget.c -------------------------------------------------------------------------------- */

/* A line, or all of a robot, and what drives servos on it. */
typedef struct grobo_i_line {
    const grobo_bus *bus;
    const grobo_driver *driver;
#if GROBO_LINES_MAX > 1
    const grobo_lines *lines;     /* NULL: it is the only one */
    const grobo_robot_line *more; /* the buses of the others */
#endif
    void *ctx;   /* the driver's */
    bool unread; /* nothing is read in the background */
} grobo_i_line;

/* Of an engine. */
grobo_i_line grobo_i_line_of_robot(const grobo_robot *robot);

/* How long an exchange has the line, in microseconds. */
uint32_t grobo_i_line_us(const grobo_bus *bus, const grobo_exchange *exchange);

/* What a goal of all these joints costs, in as many frames as it takes. *answered: servos answer
 * their goals. @return 0, or an error of the driver. */
int grobo_i_motion_cost(const grobo_i_line *line, grobo_joint_mask joints, uint32_t *us,
                        bool *answered);
/* The costliest reading of one joint, or of all where one frame reads all; of several lines the
 * mean of one joint. */
int grobo_i_reading_cost(const grobo_i_line *line, uint32_t *us);

/* ---- pace.c ---------------------------------------------------------------------------------- */

/* grobo_budget.pace_us for these joints. */
uint32_t grobo_i_pace_of(const grobo_i_line *line, grobo_joint_mask joints);
/* True if the line can tell these joints their trajectories in segments in time, and read each
 * as often as it must; or if they are told whole trajectories. */
bool grobo_i_pace_fits(const grobo_robot *robot, grobo_joint_mask joints);
/* These are told their trajectories from now on: how often. @return false, and nothing has
 * changed, where the line is too slow for that. */
bool grobo_i_pace(grobo_robot *robot, grobo_joint_mask joints);

/* ---- stand.c --------------------------------------------------------------------------------- */

/* Two positions show that a joint stands where they are so far apart: 0.5 s and more. */
int64_t grobo_i_stand_us(const grobo_robot *robot, int joint);

/* A frame tells the joint something: what was read before shows nothing of it. */
void grobo_i_stand_forget(grobo_robot_axis *axis);
/* Where it is, by a reading that was asked for since then. */
void grobo_i_stand_seen(grobo_robot *robot, int joint, int64_t asked_us, double angle_rad);
/* True if the last reading found the joint elsewhere than the one before. */
bool grobo_i_stand_left(const grobo_robot_axis *axis);
/* True of a joint whose trajectory is over, and which by the last reading is at its end, or
 * hangs beside it, and is slow; or has not moved between two of them. Less than what follows. */
bool grobo_i_rests(const grobo_robot *robot, int joint);
/* True if it was read to stand since then. */
bool grobo_i_stands(const grobo_robot *robot, int joint);
/* True if the goal read is the one that it was sent to, or of a trajectory told in segments lies
 * ahead of where it was by then. */
bool grobo_i_goal_is_taken(const grobo_robot *robot, int joint);

/* A frame that tells these joints something has left: to stop, or anything else. */
void grobo_i_halt_left(grobo_robot *robot, grobo_joint_mask joints, bool halts);
/* These are halted once they were read. */
void grobo_i_halt_owe(grobo_robot *robot, grobo_joint_mask joints);

/* ---- weight.c -------------------------------------------------------------------------------- */

/* A reading of a joint: the load that it stands in, where it stands and its goal is known. */
void grobo_i_load_take(grobo_robot *robot, int joint, const grobo_joint_state *got);
/* A trajectory that begins where a joint is begins at the goal that its servo holds it by: one that
 * begins at the joint, and a load that was another one when it stood, would have it dip. */
void grobo_i_begin_at_goal(grobo_robot *robot, int joint);
/* The goal that has a joint rest where it can by then: it keeps the load. */
double grobo_i_goal_to_rest(const grobo_robot *robot, int joint, int64_t rest_us);
/* This goal, drawn in so that its joint rests no further than that from here, and on this side: 1
 * above, -1 below, 0 on either. */
double grobo_i_goal_near(const grobo_robot_axis *axis, double goal_rad, double here_rad,
                         double most_rad, int side);

/* ---- reading.c ------------------------------------------------------------------------------- */

/* A joint slower than this does not move: in free mode it holds again (protocol 5). */
#define GROBO_I_SLOW_DPS 8

/* Takes what a slot has read of its joint, or the reason why there is nothing. *got: what was read,
 * corrected. @return result, or the error of the driver's parse. */
int grobo_i_reading_take(const grobo_robot_slot *slot, int result, const grobo_packet *reply,
                         grobo_joint_state *got);
/* True for a result that says that no reading came. */
bool grobo_i_is_loss(int result);
/* The goal that holds a joint where its servo says that it is, drawn in to its limits; NaN where it
 * stands too far outside. */
double grobo_i_hold_rad(const grobo_robot *robot, int joint);

/* ---- trajectories.c ------------------------------------------------------------------------- */

/* True if this order's joints are told their trajectories in parts, those that get so much time. */
bool grobo_i_goes_in_parts(const grobo_robot *robot, const grobo_robot_order *order);
bool grobo_i_segments_wanted(const grobo_robot *robot, int joint, int64_t time_us);
/* The part of a target that its frame asks for. @return false, and nothing in *part, where that is
 * all of it. */
bool grobo_i_segments_cut(const grobo_robot *robot, const grobo_robot_order *order,
                          const grobo_target *whole, grobo_target *part);
/* A joint begins the trajectory just noted, which is told in parts. */
void grobo_i_segments_begin(grobo_robot *robot, int joint);
/* Where these of the joints that are told more go next; and that they were told. */
void grobo_i_segments_aim(const grobo_robot *robot, grobo_joint_mask joints, grobo_target *target);
void grobo_i_segments_told(grobo_robot *robot, const grobo_target *target);
/* When joints are told more; GROBO_NEVER_US: none is. */
int64_t grobo_i_segments_due(const grobo_robot *robot);
/* The joints of which that is true now. */
grobo_joint_mask grobo_i_joints_that(const grobo_robot *robot,
                                     bool (*is)(const grobo_robot_axis *axis, int64_t now_us));
/* Joints that are told more of their trajectories. */
grobo_joint_mask grobo_i_trajectories_renewed(const grobo_robot *robot);

/* ---- gate.c ---------------------------------------------------------------------------------- */

/* A servo that is told a speed comes to rest at this one at least: a joint a degree beside where it
 * is taken to be would creep there. */
#define GROBO_I_REST_RAD_S (20 * 0.017453292519943295)

/* The frame of this slot would leave now: judges its order, builds the frame anew from it, and
 * notes what it does. @return 0, or why it must not leave: then nothing is noted. */
int grobo_i_gate_leave(grobo_robot_slot *slot);
/* The same judgement now, when a frame is asked for. */
int grobo_i_gate_judge(grobo_robot *robot, const grobo_robot_order *order,
                       const grobo_exchange *exchange);
/* Reads and judges a raw frame. *order is its order then. */
int grobo_i_gate_raw(grobo_robot *robot, const grobo_exchange *exchange, grobo_robot_order *order);
/* Judges, and builds part order->part of a GOAL, HALT, HOLD or TORQUE, as long as it may be when it
 * leaves; a GOAL in the call that has judged its target, grobo_i_gate_send(). Sets order->stands.
 * @return 1, or 0 where the driver has none; GROBO_ERR_CAP: several joints do not fit one frame. */
int grobo_i_gate_build(grobo_robot *robot, grobo_robot_order *order, grobo_exchange *exchange);
/* The targets of this order wait no more: they have left, or never will. */
void grobo_i_gate_unwait(grobo_robot *robot, const grobo_robot_order *order);
/* True if the engine cannot know whether the joint moves: its servo reports no speed, and it was
 * not sent anywhere. */
static inline bool grobo_i_is_mute(const grobo_robot *robot, int joint)
{
    return GROBO_I_EXTRA(grobo_i_driver_of(robot, joint), tells_no_speed) &&
           !grobo_i_has_target(&robot->axes[joint]);
}
/* True if it was read to turn so slowly that it may as well tremble, and was not sent anywhere. */
static inline bool grobo_i_may_creep(const grobo_robot *robot, int joint)
{
    const grobo_robot_axis *axis = &robot->axes[joint];
    return !GROBO_DRIVERS_PLAIN && !grobo_i_has_target(axis) && axis->seen_dps != 0 &&
           axis->seen_dps != GROBO_I_NO_SPEED && axis->seen_dps < GROBO_I_SLOW_DPS &&
           axis->seen_dps > -GROBO_I_SLOW_DPS;
}
/* True if the goal read back is the one that holds. */
bool grobo_i_goal_holds(const grobo_robot *robot, int joint);
/* Holds a goal this far from the angle to be the angle, for switching torque on. */
#define GROBO_I_HOLD_NEAR_DEG 2.0
/* How far outside its limits a joint may stand to be switched on; it is drawn to the limit. */
#define GROBO_I_HOLD_OUTSIDE_DEG 3.0

/* ---- orders.c -------------------------------------------------------------------------------- */

/* How a target is sent. */
typedef struct grobo_i_motion {
    grobo_priority priority;
    int64_t due_us; /* GROBO_NEVER_US, or when it should leave: it is a played one */
    bool each;      /* more time only for joints that need it, not for all alike */
    bool as_is;     /* not for the stabilizer */
    bool single;    /* from a stream of the caller's own */
    bool stops;     /* leaves after a latched stop as well */
    bool rests;     /* ends a motion: each joint comes to rest near where it is by then */
    const int32_t *joint_time_us; /* as asked for each joint; NULL: as for all */
} grobo_i_motion;
/* Checks a target and has it wait for the line; its time is found when it leaves.
 * @return 0 or an error of the gate, the driver or the bus: then none of it is sent. */
int grobo_i_gate_send(grobo_robot *robot, const grobo_posture *target, const grobo_i_motion *how);
/* Tells these joints more of the trajectories in segments that they are on. */
void grobo_i_gate_renew(grobo_robot *robot, grobo_joint_mask joints);
/* Stops those of the joints that are being moved where they are, softly; targets that wait are
 * cancelled. One that may have restarted is owed its halt until it was heard, or is silent for
 * longer than that takes. */
void grobo_i_gate_halt(grobo_robot *robot, grobo_joint_mask joints);
/* Halts these once more, behind a latch as well; nothing else is cancelled for it. */
void grobo_i_gate_halt_again(grobo_robot *robot, grobo_joint_mask joints);
/* Joints of which nobody knows where they are: a stop reads them before it halts them. */
grobo_joint_mask grobo_i_unknown(const grobo_robot *robot);
/* Halts those that are owed it, where it is time; when it is. */
void grobo_i_gate_halt_owed(grobo_robot *robot);
int64_t grobo_i_gate_halt_at(const grobo_robot *robot);
/* Joints in a frame; small frames get through a line that loses bytes. */
typedef enum grobo_i_chunk { GROBO_I_WHOLE = GROBO_JOINTS_MAX, GROBO_I_SMALL = 4 } grobo_i_chunk;
/* Takes up to `chunk` joints out of *joints. */
grobo_joint_mask grobo_i_take_chunk(grobo_joint_mask *joints, grobo_i_chunk chunk);
/* Sets goal := present for `joints` without torque; not for those that stand too far outside their
 * limits. */
int grobo_i_gate_hold(grobo_robot *robot, grobo_joint_mask joints, grobo_i_chunk chunk);
/* Switches torque. ON leaves out joints whose goal was not read back to be where they are;
 * GROBO_ERR_STATE where none is left. */
int grobo_i_gate_torque(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode,
                        grobo_i_chunk chunk);
/* True if all of these were sensed and hold. */
bool grobo_i_gate_ready(const grobo_robot *robot, grobo_joint_mask joints);

/* Tells these wheels the speeds that they were asked for. */
void grobo_i_gate_speeds(grobo_robot *robot, grobo_joint_mask wheels);

/* ---- halted.c -------------------------------------------------------------------------------- */

/* A joint, just read, moves though it was not sent there: it stops where it is. */
void grobo_i_astray(grobo_robot *robot, int joint);
/* A joint was just read: what is known by that of its halt. */
void grobo_i_halted_look(grobo_robot *robot, int joint);
/* True if halted joints are to be read now. When they are; GROBO_NEVER_US: there are none. */
bool grobo_i_halted_due(const grobo_robot *robot);
int64_t grobo_i_halted_at(const grobo_robot *robot);
/* Which of them is read next, one by one; or all of them. */
int grobo_i_halted_next(grobo_robot *robot);
grobo_joint_mask grobo_i_halted_ask(grobo_robot *robot);
/* Tells what was read back when that is all, and what was not when it takes too long; when. */
void grobo_i_halted_step(grobo_robot *robot);
int64_t grobo_i_halted_deadline(const grobo_robot *robot);

/* ---- job.c ----------------------------------------------------------------------------------- */

/* What a step returns: on to the next step, or one of the activities, or an error. */
typedef enum grobo_i_activity {
    GROBO_I_NEXT = 0, /* nothing to wait for */
    GROBO_I_ASK,      /* until the frame that the step sent is answered, into robot.reply */
    GROBO_I_READ,     /* reads job.todo, job.sense each */
    GROBO_I_DRAIN,    /* until the frames of the job that were sent are out */
    GROBO_I_WAIT      /* until job.until_us */
} grobo_i_activity;

/* True for jobs that others may run beside. */
bool grobo_i_job_is_shared(grobo_job_kind kind);
/* A number for a job. */
int grobo_i_job_number(grobo_robot *robot);
/* True if there is room for one more; `last`: in the place that is kept for what takes torque
 * away, too. */
bool grobo_i_jobs_have_room(const grobo_robot *robot, bool last);
/* Starts a job, which robot.job points to until the next grobo_i_job_run(). `number` 0: a new one.
 * `script` ends with NULL. @return its number. */
int grobo_i_job_start(grobo_robot *robot, grobo_job_kind kind, const grobo_robot_step_fn *script,
                      int number);
/* Goes on with every job as far as it goes now. */
void grobo_i_job_run(grobo_robot *robot);
/* Where one runs, the first place is not free. At the end of every call. */
void grobo_i_jobs_close_up(grobo_robot *robot);
/* Joints of a move asked for joint by joint have failed for good: it continues with its others. The
 * error is the one of robot.job. */
void grobo_i_job_give_up(grobo_robot *robot, grobo_joint_mask joints);
/* Ends robot.job and tells so. */
void grobo_i_job_end(grobo_robot *robot, int result);
/* The same for each job of which that is true; NULL: of all. */
void grobo_i_jobs_end(grobo_robot *robot, bool (*is)(const grobo_robot_task *job), int result);
/* Moves and torques that run leave these joints to another; one that has no joint left ends. */
void grobo_i_jobs_leave(grobo_robot *robot, grobo_joint_mask joints);
/* Tells how one that waited for its turn has ended. */
void grobo_i_queue_tell(grobo_robot *robot, const grobo_robot_request *request, int result);
/* Ends what waits for its turn. */
void grobo_i_queue_end(grobo_robot *robot, int result);
/* One joint failed; the job goes on with the others. The first error is the job's result. */
void grobo_i_job_fail_joint(grobo_robot *robot, int joint, int error, double value);
/* The step to go on with instead of the next one; it must be in the script. */
void grobo_i_job_goto(grobo_robot *robot, grobo_robot_step_fn step);
/* When a job wants to be run though nothing happens. */
int64_t grobo_i_job_deadline(const grobo_robot *robot);

/* True if the frame is of a job that runs. */
bool grobo_i_job_has(const grobo_robot_slot *slot);
/* A target of the job was refused as it would have left: the job ends so. */
void grobo_i_job_refused(const grobo_robot_slot *slot, int result);
/* A frame of the job is over; a reading was taken. */
void grobo_i_job_done(const grobo_robot_slot *slot, int result, const grobo_packet *reply);

/* ---- stop.c ---------------------------------------------------------------------------------- */

/* What the engine does by itself after a motion makes way for any request. */
void grobo_i_make_way(grobo_robot *robot);
/* Cancels targets that wait, and halts what moves; while a motion is played, which ends by itself,
 * only what was sent beside it. */
void grobo_i_stop_moves(grobo_robot *robot);
/* A motion cannot go on: halts all that moves, and ends what moves or waits to move beside it. */
void grobo_i_stop_broken(grobo_robot *robot);
/* True if a job moves joints, or would: a stop ends it. */
bool grobo_i_job_moves(const grobo_robot_task *job);

/* ---- trip.c ---------------------------------------------------------------------------------- */

/* Stops for safety. Latched ones end a job that moves or switches on. */
void grobo_i_trip(grobo_robot *robot, grobo_trip reason, int joint, double value, bool latched);

/* ---- watch.c --------------------------------------------------------------------------------- */

/* Judges the reading of a joint just taken. */
void grobo_i_watch_reading(grobo_robot *robot, int joint, const grobo_joint_state *got);
/* Judges a reading that did not come. */
void grobo_i_watch_lost(grobo_robot *robot, int joint);

/* ---- play.c ---------------------------------------------------------------------------------- */

/* No reading is begun that would not be over when the next motion frame is due. */
void grobo_i_play_reserve(grobo_robot *robot);
/* Sends what the sequencer has due, watches the host's lateness, keeps the line free for what
 * comes next, tells new states. */
void grobo_i_play_step(grobo_robot *robot);
/* A motion frame is over. */
void grobo_i_play_done(grobo_robot_slot *slot, int result);
/* Tells a new state of the sequencer. */
void grobo_i_play_tell(grobo_robot *robot);
/* What a caller leaves open is as the robot is configured. */
int grobo_i_play_options(const grobo_robot *robot, const grobo_play_options *options,
                         grobo_play_options *chosen);
/* Fills in the rate, and refuses one that leaves no time to watch the joints. `unwatched` remains
 * only where it is needed. @return 0, GROBO_ERR_UNWATCHED, or an error of the driver. */
int grobo_i_play_rate(const grobo_robot *robot, grobo_play_options *chosen);
/* True if the clip being played may make no frame wait for a reading. */
bool grobo_i_play_unwatched(const grobo_robot *robot);
/* Joints that a clip moves, played so. */
int grobo_i_play_joints(const grobo_robot *robot, const grobo_clip *clip,
                        const grobo_play_options *options, grobo_joint_mask *joints);
/* Begins what job.clip and job.options say, from where the joints are. */
int grobo_i_play_start(grobo_robot *robot);

/* ---- segments.c ------------------------------------------------------------------------------ */

/* Tells more of their trajectories when it is time for that, and ends what the host has left
 * standing. */
void grobo_i_segments_step(grobo_robot *robot);
/* When that is to be looked at next. */
int64_t grobo_i_segments_deadline(const grobo_robot *robot);

/* ---- sense.c --------------------------------------------------------------------------------- */

/* Starts a background reading if one is due. */
void grobo_i_sense_step(grobo_robot *robot);
/* When the background reads next. */
int64_t grobo_i_sense_deadline(const grobo_robot *robot);

/* A background reading is over, and taken. */
void grobo_i_sense_done(const grobo_robot_slot *slot, int result);

/* ---- check.c -------------------------------------------------------------------------------- */

extern const grobo_robot_step_fn grobo_i_script_check[];

/* ---- steps.c --------------------------------------------------------------------------------- */

extern const grobo_robot_step_fn grobo_i_script_sense[];
extern const grobo_robot_step_fn grobo_i_script_torque_on[];
extern const grobo_robot_step_fn grobo_i_script_torque_off[]; /* brake as well */
extern const grobo_robot_step_fn grobo_i_script_move[];
extern const grobo_robot_step_fn grobo_i_script_play[];
extern const grobo_robot_step_fn grobo_i_script_settle[];
extern const grobo_robot_step_fn grobo_i_script_ask[];
extern const grobo_robot_step_fn grobo_i_script_exit_off[];
extern const grobo_robot_step_fn grobo_i_script_exit_hold[];
extern const grobo_robot_step_fn grobo_i_script_exit_sit[];

/* True of a move that is done, and whose joints come to rest yet. */
bool grobo_i_move_settles(const grobo_robot_task *job);
/* True if the target of a move has been sent. */
bool grobo_i_move_is_sent(const grobo_robot_task *job);
/* Sends the joints of such a move, robot.job, to another target, and goes on from there; of one
 * asked for joint by joint these joints alone. */
void grobo_i_move_retarget(grobo_robot *robot, const grobo_posture *target);

/* ---- turn.c ---------------------------------------------------------------------------------- */

/* Every call of the pump that may change something stands between these two: the outermost leave
 * tells the events, without the lock. */
void grobo_i_enter(grobo_robot *robot, int64_t now_us);
void grobo_i_leave(grobo_robot *robot);
/* The same around every request. Where a host is woken, the pump tells the events. */
void grobo_i_begin(grobo_robot *robot);
void grobo_i_end(grobo_robot *robot);
/* One of several joints has answered: grobo_robot.each. */
void grobo_i_reply_came(grobo_robot_slot *slot, const grobo_packet *reply);
/* A frame is over: grobo_robot.over. The slot is a copy. */
void grobo_i_frame_over(grobo_robot_slot *slot, int result, const grobo_packet *reply);

/* ---- join.c ---------------------------------------------------------------------------------- */

/* Joins a request to a job or to one that waits, where it is as if both had been asked for at once:
 * a reading or torque on to one that has not read these joints yet, a move of a joint to one that
 * has not read its joints yet. @return the number of that job; 0: there is none. */
int grobo_i_join_job(grobo_robot *robot, const grobo_robot_request *request);
int grobo_i_join_waiting(grobo_robot *robot, const grobo_robot_request *request);
/* Joins torque off or brake to a job that does the same; `sent`: to one that has sent its frames,
 * too, which begins anew. @return the number of that job; 0: there is none. */
int grobo_i_join_off(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode, bool sent);

/* ---- queue.c --------------------------------------------------------------------------------- */

/* May a job of this kind begin on these joints? GROBO_I_LATER: when others have ended. */
#define GROBO_I_LATER 1
int grobo_i_admit(grobo_robot *robot, grobo_job_kind kind, grobo_joint_mask joints, bool moves);
/* A move that runs takes these joints besides its own, from the moves that have them.
 * @return 0, or GROBO_ERR_STATE where they are a motion's or another job's: none is taken. */
int grobo_i_move_takes(grobo_robot *robot, grobo_joint_mask joints);
/* Joints of the moves that run or wait. */
grobo_joint_mask grobo_i_joints_of_moves(const grobo_robot *robot);
/* Begins a move, a reading or torque on, joins it to another one, or has it wait. @return its
 * number, or the reason why not. */
int grobo_i_queue_ask(grobo_robot *robot, const grobo_robot_request *request);
/* Begins what waits and may go; ends what has waited too long. */
void grobo_i_queue_step(grobo_robot *robot);
/* When that is next. */
int64_t grobo_i_queue_deadline(const grobo_robot *robot);

/* ---- request.c ------------------------------------------------------------------------------- */

/* Begins to carry an emergency stop out; the link is up. @return the job's number. */
int grobo_i_estop_start(grobo_robot *robot);

#endif
