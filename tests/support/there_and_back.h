/* SPDX-License-Identifier: MIT */
/* A sequencer that plays: LEFT goes 1 rad in 1 s, back in 2 s. */
#ifndef GROBO_TESTS_THERE_AND_BACK_H
#define GROBO_TESTS_THERE_AND_BACK_H

#include "tests/support/sample_clip.h"

extern const sample_key there_and_back[3];

/* The sequencer, the clip it plays, and another one like it. */
extern sample_pump pump;
extern sample_clip clip, other;

extern const grobo_play_options by_key;
extern const grobo_play_options at_rate;

/* Plays at time 0, from where LEFT stands at this angle. */
void there_and_back_start(const grobo_play_options *options, double left_rad);

/* Asks for it at the pump's time; what grobo_sequencer_play() returned. */
int there_and_back_again(grobo_play_options options);

#endif
