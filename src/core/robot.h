/* SPDX-License-Identifier: MIT */
/*
 * The rooms of the engine and what they say to each other.
 *
 *   robot.c          life, pump, link, the queue of events
 *   robot_slot.c     frames under way: from an exchange to a transaction and back
 *   robot_job.c      runs the script of a job, step by step
 *   robot_steps.c    the steps that scripts are made of
 *   robot_request.c  the public requests: checks, then starts a script
 *   robot_play.c     the sequencer's frames, on time
 *   robot_query.c    what may be asked
 *   sensing.c        readings: into the axes, in the background, free mode
 *   safety_gate.c    the only way to motors: every target and every torque passes here
 *   safety_watch.c   judges readings, trips
 */
#ifndef GROBO_CORE_ROBOT_H
#define GROBO_CORE_ROBOT_H

#include <grobo/robot.h>

/* ---- robot.c --------------------------------------------------------------------------------- */

/* Every public call that may change something stands between these two: the outermost leave tells
 * the events. */
void grobo_i_enter(grobo_robot *robot, int64_t now_us);
void grobo_i_leave(grobo_robot *robot);
/* Puts an event into the queue. */
void grobo_i_tell(grobo_robot *robot, const grobo_event *event);
/* All joints of the model. */
grobo_joint_mask grobo_i_all_joints(const grobo_robot *robot);

/* ---- robot_slot.c ---------------------------------------------------------------------------- */

/* What a frame under way is for. */
typedef enum grobo_i_use {
    GROBO_I_USE_FREE = 0,
    GROBO_I_USE_JOB,    /* its end goes to the job that is named in it */
    GROBO_I_USE_SENSE,  /* a reading of the background */
    GROBO_I_USE_MOTION, /* a target; a played one if it has a due time */
    GROBO_I_USE_PLAIN   /* sent for its effect; a later reading shows whether it took */
} grobo_i_use;

/* A free slot with a zeroed exchange, or NULL. */
grobo_robot_slot *grobo_i_slot_take(grobo_robot *robot, grobo_i_use use);
/* Gives the slot's exchange to the bus; on error the slot is free again. */
int grobo_i_slot_send(grobo_robot_slot *slot, grobo_priority priority);
/* Gives a slot back that was not sent. */
void grobo_i_slot_drop(grobo_robot_slot *slot);
/* Takes back every frame of this use. */
void grobo_i_slots_cancel(grobo_robot *robot, grobo_i_use use);
/* Takes back frames that would switch torque on and have not left. */
void grobo_i_slots_keep_off(grobo_robot *robot);
/* Notes the frames that the bus has just given out. */
void grobo_i_slots_sent(grobo_robot *robot);
/* True if a frame of this use is under way. */
bool grobo_i_slots_busy(const grobo_robot *robot, grobo_i_use use);

/* ---- robot_job.c ----------------------------------------------------------------------------- */

/* What a step returns: on to the next step, or one of the activities, or an error. */
typedef enum grobo_i_activity {
    GROBO_I_NEXT = 0, /* nothing to wait for */
    GROBO_I_ASK,      /* until the frame that the step sent is answered, into robot.reply */
    GROBO_I_READ,     /* reads job.todo, job.sense each */
    GROBO_I_DRAIN,    /* until the frames of the job that were sent are out */
    GROBO_I_WAIT      /* until job.until_us */
} grobo_i_activity;

/* The first of these joints, of which there is one at least. */
int grobo_i_lowest(grobo_joint_mask joints);
/* Starts a job; its number, or the reason why not. `script` ends with NULL. */
int grobo_i_job_start(grobo_robot *robot, grobo_job_kind kind, const grobo_robot_step_fn *script);
/* Goes on with the job as far as it goes now. */
void grobo_i_job_run(grobo_robot *robot);
/* Ends the job and tells so. */
void grobo_i_job_end(grobo_robot *robot, int result);
/* A frame of the job is over. */
void grobo_i_job_done(grobo_robot_slot *slot, int result, const grobo_rs30x_packet *reply);
/* One joint failed; the job goes on with the others. The first error is the job's result. */
void grobo_i_job_fail_joint(grobo_robot *robot, int joint, int error, double value);
/* The step to go on with instead of the next one; it must be in the script. */
void grobo_i_job_goto(grobo_robot *robot, grobo_robot_step_fn step);
/* When the job wants to be run though nothing happens. */
int64_t grobo_i_job_deadline(const grobo_robot *robot);

/* ---- robot_steps.c --------------------------------------------------------------------------- */

extern const grobo_robot_step_fn grobo_i_script_check[];
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

/* ---- robot_request.c ------------------------------------------------------------------------- */

/* Begins to carry an emergency stop out; the link is up. @return the job's number. */
int grobo_i_estop_start(grobo_robot *robot);

/* ---- robot_play.c ---------------------------------------------------------------------------- */

/* Sends what the sequencer has due, watches the host's lateness, keeps the line free for what
 * comes next, tells new states. */
void grobo_i_play_step(grobo_robot *robot);
/* Takes back targets that still wait for the line when the next one is there. */
void grobo_i_play_overtake(grobo_robot *robot);
/* A motion frame is over. */
void grobo_i_play_done(grobo_robot_slot *slot, int result);
/* Tells a new state of the sequencer. */
void grobo_i_play_tell(grobo_robot *robot);
/* After a motion, unless somebody asked for something else: its last posture is read back. */
void grobo_i_play_settle(grobo_robot *robot);
/* What a caller leaves open is as the robot is configured. */
void grobo_i_play_options(const grobo_robot *robot, const grobo_play_options *options,
                          grobo_play_options *chosen);
/* Joints that a clip moves, played so. */
int grobo_i_play_joints(const grobo_robot *robot, const grobo_clip *clip,
                        const grobo_play_options *options, grobo_joint_mask *joints);
/* Begins what job.clip and job.options say, from where the joints are. */
int grobo_i_play_start(grobo_robot *robot);

/* ---- sensing.c ------------------------------------------------------------------------------- */

/* Takes a reading of a joint, or the reason why there is none. @return result, or parse's error. */
int grobo_i_sense_take(grobo_robot *robot, int joint, int result, const grobo_rs30x_packet *reply);
/* The goal that holds a joint where its servo says that it is, drawn in to its limits; NaN where it
 * stands too far outside. */
double grobo_i_hold_rad(const grobo_robot *robot, int joint);
/* Starts a background reading if one is due. */
void grobo_i_sense_step(grobo_robot *robot);
/* A background reading is over. */
void grobo_i_sense_done(grobo_robot_slot *slot, int result, const grobo_rs30x_packet *reply);
/* When the background reads next. */
int64_t grobo_i_sense_deadline(const grobo_robot *robot);

/* ---- safety_gate.c --------------------------------------------------------------------------- */

/* Checks numbers and limits of a target; clamps if so configured. The fault is kept for
 * grobo_robot_fault(). @return 0, GROBO_ERR_NAN, _LIMIT, _ARG. */
int grobo_i_gate_target(grobo_robot *robot, grobo_posture *target);
/* How a target is sent. */
typedef struct grobo_i_motion {
    grobo_priority priority;
    int64_t due_us; /* GROBO_NEVER_US, or when it should leave: it is a played one */
    bool each;      /* more time only for joints that need it, not for all alike */
    bool as_is;     /* not for the stabilizer */
} grobo_i_motion;
/* Checks a target, gives it the time that is safe, builds the frames and sends them.
 * @return 0 or an error of the gate, the driver or the bus.
 * *time_us, if not NULL, becomes the longest time of a joint. */
int grobo_i_gate_send(grobo_robot *robot, const grobo_posture *target, const grobo_i_motion *how,
                      int64_t *time_us);
/* Joints in a frame; small frames get through a line that loses bytes. */
typedef enum grobo_i_chunk { GROBO_I_WHOLE = GROBO_JOINTS_MAX, GROBO_I_SMALL = 4 } grobo_i_chunk;
/* The next move is the first from a sensed posture: a slow one. */
void grobo_i_gate_soften(grobo_robot *robot);
/* Around targets that come one by one, from a loop of the caller's own or as raw frames: the first
 * of them is the slow one. */
void grobo_i_gate_single(grobo_robot *robot);
void grobo_i_gate_single_sent(grobo_robot *robot, int64_t time_us);
/* Takes up to `chunk` joints out of *joints. */
grobo_joint_mask grobo_i_take_chunk(grobo_joint_mask *joints, grobo_i_chunk chunk);
/* True if the goal read back is the one that holds. */
bool grobo_i_goal_holds(const grobo_robot *robot, int joint);
/* Sets goal := present for `joints`, which were just read; not for those that stand too far
 * outside their limits. */
int grobo_i_gate_hold(grobo_robot *robot, grobo_joint_mask joints, grobo_i_chunk chunk);
/* The frame with this target leaves now: its moves begin now. */
void grobo_i_gate_sent(grobo_robot *robot, uint32_t motion);
/* The frame with this target never left: the joints are still on the way they were on. */
void grobo_i_gate_unsent(grobo_robot *robot, uint32_t motion);
/* True if all of these were sensed and hold. */
bool grobo_i_gate_ready(const grobo_robot *robot, grobo_joint_mask joints);
/* True while a joint is on the way it was sent on. */
bool grobo_i_gate_moving(const grobo_robot *robot);
/* Where these joints are is not known any more: read first, then moved softly. */
void grobo_i_gate_forget(grobo_robot *robot, grobo_joint_mask joints);
/* Stops joints that are being moved where they are, softly. */
void grobo_i_gate_halt(grobo_robot *robot);
/* Switches torque. ON is refused with GROBO_ERR_STATE for joints whose goal was not read back to
 * be where they are. */
int grobo_i_gate_torque(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode,
                        grobo_i_chunk chunk);
/* Checks a raw frame. */
int grobo_i_gate_raw(grobo_robot *robot, const uint8_t *frame, size_t size);
/* Where a joint is by now on the move it was sent on. */
double grobo_i_axis_commanded(const grobo_robot_axis *axis, int64_t now_us);
/* Takes the sensed angle for where a joint is, nothing being asked of it. */
void grobo_i_axis_rest(grobo_robot_axis *axis, int64_t now_us);
/* Takes what was read for where a joint is: at the angle, or on the move the servo told of. */
void grobo_i_axis_here(grobo_robot_axis *axis, int64_t now_us);
/* True if one of these moves though nothing was asked of it, nobody knows where to. */
bool grobo_i_adrift(const grobo_robot *robot, grobo_joint_mask joints);
/* Holds a goal this far from the angle to be the angle, for switching torque on. */
#define GROBO_I_HOLD_NEAR_DEG 2.0
/* How far outside its limits a joint may stand to be switched on; it is drawn to the limit. */
#define GROBO_I_HOLD_OUTSIDE_DEG 3.0

/* ---- safety_watch.c -------------------------------------------------------------------------- */

/* Judges the reading of a joint just taken. */
void grobo_i_watch_reading(grobo_robot *robot, int joint, const grobo_joint_state *got);
/* Judges a reading that did not come. */
void grobo_i_watch_lost(grobo_robot *robot, int joint);
/* Stops for safety. Latched ones end a job that moves or switches on. */
void grobo_i_trip(grobo_robot *robot, grobo_trip reason, int joint, double value, bool latched);
/* True while joints are being moved, by a job or by the sequencer. */
bool grobo_i_in_motion(const grobo_robot *robot);

#endif
