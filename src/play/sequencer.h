/* SPDX-License-Identifier: MIT */
/* Between the files of the sequencer: sequencer_clip.c knows clips, sequencer.c knows time. */
#ifndef GROBO_SEQUENCER_I_H
#define GROBO_SEQUENCER_I_H

#include <grobo/core/sequencer.h>

/*
 * Checks a clip with its options and fills in the defaults. By keys it reads all of them.
 * start: for relative clips, NULL if it is not known yet. On error what is in item means nothing.
 */
int grobo_i_item_make(grobo_play_item *item, const grobo_model *model, const grobo_clip *clip,
                      const grobo_play_options *options, const grobo_posture *start);

/* Takes over the first item of the queue; a relative clip starts at `from`. */
void grobo_i_item_load(grobo_sequencer *seq);

/* Sets `late`. */
void grobo_i_see_if_late(grobo_sequencer *seq);
/* A frame's time has passed, it will not be handed out. */
void grobo_i_count_skipped(grobo_sequencer *seq);

/* The position at a real time, while PLAYING; never before the anchor, never past the end. */
int64_t grobo_i_pos_at(const grobo_sequencer *seq, int64_t t_us);

/* What was the goal is where the robot is now. */
void grobo_i_arrive(grobo_sequencer *seq);

/* RATE: makes `to` the posture at a position. */
int grobo_i_sample(grobo_sequencer *seq, int64_t pos_us);

/* KEY: position of the present key. */
int64_t grobo_i_key_pos(const grobo_sequencer *seq);
/* KEY: true if there is a key behind the present one, in playing direction. */
bool grobo_i_key_has_next(const grobo_sequencer *seq);
/* KEY: goes to key i of the clip and makes `to` its posture. */
int grobo_i_key_load(grobo_sequencer *seq, size_t i);
/* KEY: goes to the next key in playing direction; sets `silent`. */
int grobo_i_key_next(grobo_sequencer *seq);
/* KEY: goes to the last key at or before a position and makes `to` the posture there. */
int grobo_i_key_seek(grobo_sequencer *seq, int64_t pos_us);
/* KEY: time that the move to the first key of a pass takes by itself. */
int64_t grobo_i_key_first_time(const grobo_sequencer *seq);

/* Makes `posture`, which is one of the two, what lies between them, part in 0..1. A joint that is
 * not known in `from` is nowhere until all the way is made. */
void grobo_i_between(grobo_posture *posture, const grobo_posture *from, const grobo_posture *to,
                     double part);

/* Time of an approach from `from` to `to`, in whole units; 0 if it is there already. */
int32_t grobo_i_approach_time(const grobo_sequencer *seq);

#endif
