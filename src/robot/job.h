/* SPDX-License-Identifier: MIT */
/* Runs the script of a job, step by step (job.c). */
#ifndef GROBO_ROBOT_JOB_I_H
#define GROBO_ROBOT_JOB_I_H

#include <grobo/core/static.h>

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

#endif
