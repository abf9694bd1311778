/* SPDX-License-Identifier: MIT */
/* A small clip to play in tests, a robot of three joints for it, and a pump in virtual time. */
#ifndef SAMPLE_CLIP_H
#define SAMPLE_CLIP_H

#include <grobo/core/sequencer.h>

enum { SAMPLE_JOINTS = 3, SAMPLE_KEYS_MAX = 64, SAMPLE_FRAMES_MAX = 8192 };

#define MS 1000LL

/* Bits of joints. */
enum { LEFT = 1, RIGHT = 2, MIDDLE = 4, ALL = 7 };

/* Joints LEFT (0) and RIGHT (1) are each other's mirror, MIDDLE (2) its own. */
extern const grobo_model sample_model;

typedef struct sample_key {
    int64_t time_us; /* from the key before; 0: the default time */
    unsigned set;    /* bits of joints */
    double angle_rad[SAMPLE_JOINTS];
} sample_key;

typedef struct sample_clip {
    grobo_clip clip;
    const sample_key *keys;
    size_t fail_at;   /* key that gives an error; past the end: none */
    int sample_error; /* < 0: what sample() says */
} sample_clip;

/* keys: borrowed. sample() goes straight from key to key; only all joints at once. */
void sample_clip_init(sample_clip *sample, const sample_key *keys, size_t n);

/* All three joints at these angles. */
grobo_posture sample_posture(double left_rad, double right_rad, double middle_rad);

typedef struct sample_pump {
    grobo_sequencer seq;
    int64_t now_us;
    grobo_play_frame frames[SAMPLE_FRAMES_MAX];
    size_t n;
    int64_t last_due_us;
    grobo_sequencer_state state; /* last seen */
    int64_t state_us;            /* since when */
} sample_pump;

void sample_pump_init(sample_pump *pump, const grobo_model *model);

/* Looks at what a command has done to the state. */
void sample_pump_look(sample_pump *pump);

/*
 * Takes what is due now, as often as the sequencer wants, and asserts what must always hold:
 * legal transitions, due times that rise and have come, one frame at most, a deadline ahead.
 * Returns what the sequencer said last.
 */
int sample_pump_take(sample_pump *pump);

/* Lives through every deadline up to and including until_us. */
void sample_pump_run(sample_pump *pump, int64_t until_us);

/* Options by chance: rates and starting points below these. */
grobo_play_options sample_options(uint32_t *seed, unsigned rate_hz, unsigned from_us);

/* Lets time pass without serving anybody, then serves. */
void sample_pump_stall(sample_pump *pump, int64_t time_us);

#endif
