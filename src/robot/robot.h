/* SPDX-License-Identifier: MIT */
/*
 * What all files of the engine use. A header has the name of the file whose functions it declares.
 *
 * The layers of the engine, the lowest first: a function calls its own layer or lower ones. What
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
 *   astray.c     joints that go on though they were told to stand
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

/* Puts an event into the queue. */
void grobo_i_tell(grobo_robot *robot, const grobo_event *event);

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

/* True if the joint is one of these. */
static inline bool grobo_i_has(grobo_joint_mask joints, int joint)
{
    return (joints & GROBO_JOINT_BIT(joint)) != 0;
}

/* What was known of these joints may be wrong: their line went. */
void grobo_i_forget_joints(grobo_robot *robot, grobo_joint_mask joints);

/* Bytes of an engine with no more axes than this robot has joints: what lies behind them of a
 * grobo_robot is not there. */
size_t grobo_i_robot_bytes(const grobo_driver *driver);

/* grobo_robot_configure() for who pumps afterwards: nobody is woken, so nothing leaves by it.
 * Without `senses` nothing is read in the background, whatever it says. */
int grobo_i_robot_configure(grobo_robot *robot, const grobo_robot_config *config, bool senses);

#endif
