/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "tests/support/next_random.h"
#include "tests/support/sample_clip.h"
#include "tests/support/test.h"

static const grobo_joint joints[SAMPLE_JOINTS] = {
    {.name = "LEFT",
     .min_rad = -3,
     .max_rad = 3,
     .max_speed_rad_s = 6,
     .motor = 1,
     .mirror = 1,
     .mirror_sign = -1},
    {.name = "RIGHT",
     .min_rad = -3,
     .max_rad = 3,
     .max_speed_rad_s = 6,
     .motor = 2,
     .mirror = 0,
     .mirror_sign = -1},
    {.name = "MIDDLE",
     .min_rad = -3,
     .max_rad = 3,
     .max_speed_rad_s = 6,
     .motor = 3,
     .mirror = 2,
     .mirror_sign = 1},
};

const grobo_model sample_model = GROBO_TABLE(grobo_model, .name = "SAMPLE",
                                             GROBO_MODEL_JOINTS(joints), .n_joints = SAMPLE_JOINTS);

static int sample_key_at(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    const sample_clip *sample = (const sample_clip *)ctx;
    if (i == sample->fail_at) {
        return GROBO_ERR_UNREACHABLE;
    }
    assert_true(i < sample->clip.n_keys);
    (void)grobo_posture_init(posture, SAMPLE_JOINTS);
    memcpy(posture->angle_rad, sample->keys[i].angle_rad, sizeof sample->keys[i].angle_rad);
    posture->set = sample->keys[i].set;
    posture->time_us = sample->keys[i].time_us;
    *at_us = 0;
    for (size_t k = 0; k <= i; k++) {
        *at_us += sample->keys[k].time_us;
    }
    return 0;
}

static int sample_at(void *ctx, int64_t t_us, grobo_posture *posture)
{
    const sample_clip *sample = (const sample_clip *)ctx;
    int64_t before_us = sample->keys[0].time_us;
    size_t i = 1;

    if (sample->sample_error < 0) {
        return sample->sample_error;
    }
    assert_true(t_us >= 0 && t_us <= sample->clip.length_us);
    (void)grobo_posture_init(posture, SAMPLE_JOINTS);
    posture->set = GROBO_JOINTS_ALL(SAMPLE_JOINTS);
    while (i < sample->clip.n_keys && t_us > before_us + sample->keys[i].time_us) {
        before_us += sample->keys[i++].time_us;
    }
    for (int j = 0; j < SAMPLE_JOINTS; j++) {
        double a = sample->keys[i - 1].angle_rad[j];
        double part = 0.0;
        if (i < sample->clip.n_keys && t_us > before_us) {
            part = (double)(t_us - before_us) / (double)sample->keys[i].time_us;
            posture->angle_rad[j] = a + (sample->keys[i].angle_rad[j] - a) * part;
        } else {
            posture->angle_rad[j] = a;
        }
    }
    return 0;
}

void sample_clip_init(sample_clip *sample, const sample_key *keys, size_t n)
{
    memset(sample, 0, sizeof *sample);
    sample->keys = keys;
    sample->fail_at = SIZE_MAX;
    sample->clip = (grobo_clip){.key = sample_key_at,
                                .sample = sample_at,
                                .ctx = sample,
                                .n_keys = n,
                                .n_joints = SAMPLE_JOINTS};
    for (size_t i = 0; i < n; i++) {
        sample->clip.length_us += keys[i].time_us;
    }
}

grobo_posture sample_posture(double left_rad, double right_rad, double middle_rad)
{
    grobo_posture p;
    (void)grobo_posture_init(&p, SAMPLE_JOINTS);
    p.set = GROBO_JOINTS_ALL(SAMPLE_JOINTS);
    p.angle_rad[0] = left_rad;
    p.angle_rad[1] = right_rad;
    p.angle_rad[2] = middle_rad;
    return p;
}

void sample_pump_init(sample_pump *pump, const grobo_model *model)
{
    memset(pump, 0, sizeof *pump);
    grobo_sequencer_init(&pump->seq, model);
    pump->last_due_us = INT64_MIN;
}

static void check_frame(sample_pump *pump, const grobo_play_frame *frame)
{
    assert_true(frame->due_us <= pump->now_us);
    assert_true(frame->due_us >= pump->last_due_us);
    assert_true(frame->posture.time_us >= GROBO_PLAY_TIME_UNIT_US);
    assert_true(frame->posture.time_us <= GROBO_PLAY_TIME_MAX_US);
    assert_true(frame->posture.set != 0);
    for (int j = 0; j < SAMPLE_JOINTS; j++) {
        if ((frame->posture.set & GROBO_JOINT_BIT(j)) != 0) {
            assert_true(isfinite(frame->posture.angle_rad[j]));
        }
    }
    pump->last_due_us = frame->due_us;
}

void sample_pump_look(sample_pump *pump)
{
    grobo_sequencer_state state = grobo_sequencer_get_state(&pump->seq);
    assert_true(state == pump->state || grobo_sequencer_may_go(pump->state, state));
    pump->state_us = state == pump->state ? pump->state_us : pump->now_us;
    pump->state = state;
}

int sample_pump_take(sample_pump *pump)
{
    grobo_play_frame frame;
    int result;
    int taken = 0;

    sample_pump_look(pump);
    while ((result = grobo_sequencer_next(&pump->seq, pump->now_us, &frame)) > 0) {
        assert_int_equal(result, 1);
        sample_pump_look(pump);
        check_frame(pump, &frame);
        assert_true(pump->n < SAMPLE_FRAMES_MAX);
        pump->frames[pump->n++] = frame;
        assert_int_equal(++taken, 1);
    }
    sample_pump_look(pump);
    assert_true(grobo_sequencer_deadline(&pump->seq) > pump->now_us);
    return result;
}

void sample_pump_run(sample_pump *pump, int64_t until_us)
{
    (void)sample_pump_take(pump);
    while (grobo_sequencer_deadline(&pump->seq) <= until_us) {
        pump->now_us = grobo_sequencer_deadline(&pump->seq);
        (void)sample_pump_take(pump);
    }
    pump->now_us = until_us;
}

void sample_pump_stall(sample_pump *pump, int64_t time_us)
{
    pump->now_us += time_us;
    (void)sample_pump_take(pump);
}

grobo_play_options sample_options(uint32_t *seed, unsigned rate_hz, unsigned from_us)
{
    grobo_play_options options = {0};
    options.mode = next_random(seed) % 2 ? GROBO_PLAY_KEY : GROBO_PLAY_RATE;
    options.reverse = next_random(seed) % 2;
    options.mirror = next_random(seed) % 2;
    options.repeat = (int32_t)(next_random(seed) % 5) - 2;
    options.speed_pct = (uint16_t)(next_random(seed) % 500);
    options.rate_hz = (uint16_t)(next_random(seed) % rate_hz);
    options.from_us = next_random(seed) % from_us;
    return options;
}
