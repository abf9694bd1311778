/* SPDX-License-Identifier: MIT */
/* The frames of the sequencer, on time (play.c). */
#ifndef GROBO_ROBOT_PLAY_I_H
#define GROBO_ROBOT_PLAY_I_H

#include <grobo/core/static.h>

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

#endif
