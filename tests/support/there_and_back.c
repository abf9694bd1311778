/* SPDX-License-Identifier: MIT */

#include "tests/support/test.h"
#include "tests/support/there_and_back.h"

const sample_key there_and_back[3] = {
    {0, ALL, {0.0, 0, 0}}, {1000 * MS, ALL, {1.0, 0, 0}}, {2000 * MS, ALL, {0.0, 0, 0}}};

sample_pump pump;
sample_clip clip, other;

const grobo_play_options by_key = {.default_time_us = 100 * MS};
const grobo_play_options at_rate = {.mode = GROBO_PLAY_RATE};

void there_and_back_start(const grobo_play_options *options, double left_rad)
{
    grobo_posture from = sample_posture(left_rad, 0, 0);
    sample_pump_init(&pump, &sample_model);
    sample_clip_init(&clip, there_and_back, 3);
    sample_clip_init(&other, there_and_back, 3);
    assert_int_equal(grobo_sequencer_play(&pump.seq, &clip.clip, options, &from, 0), 0);
    sample_pump_look(&pump);
}

int there_and_back_again(grobo_play_options options)
{
    grobo_posture from = sample_posture(0, 0, 0);
    return grobo_sequencer_play(&pump.seq, &clip.clip, &options, &from, pump.now_us);
}
