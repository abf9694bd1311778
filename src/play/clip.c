/* SPDX-License-Identifier: MIT */
#include <float.h>
#include <math.h>
#include <string.h>

#include "src/play/sequencer.h"

#define DEG_PER_RAD (180.0 / 3.14159265358979323846)

/* Half of the wire's 0.1 degree: nearer than this is there. */
#define THERE_RAD (0.05 / DEG_PER_RAD)
#define UNKNOWN_RAD (GROBO_PLAY_UNKNOWN_DEG / DEG_PER_RAD)

/* Longest time of a frame, in units. */
#define TIME_MAX_UNITS (GROBO_PLAY_TIME_MAX_US / GROBO_PLAY_TIME_UNIT_US)

static bool has(const grobo_posture *posture, int joint)
{
    return (posture->set >> joint & 1u) != 0;
}

/* ---- one posture of a clip ---- */

static int check_posture(const grobo_posture *posture, const grobo_clip *clip)
{
    if (posture->n_joints != clip->n_joints) {
        return GROBO_ERR_ARG;
    }
    for (int j = 0; j < clip->n_joints; j++) {
        if (has(posture, j) && !(fabs(posture->angle_rad[j]) <= DBL_MAX)) {
            return GROBO_ERR_NAN; /* or infinite; NaN fails any comparison */
        }
    }
    return 0;
}

static int finish_read(const grobo_play_item *item, grobo_posture *posture)
{
    int result = check_posture(posture, &item->clip);
    if (result == 0 && item->options.mirror) {
        result = grobo_posture_mirror(posture, item->model);
    }
    return result;
}

static int read_sample(const grobo_play_item *item, grobo_posture *posture, int64_t t_us)
{
    int result = item->clip.sample(item->clip.ctx, t_us, posture);
    return result < 0 ? result : finish_read(item, posture);
}

/* Reads key i, the one behind that of `key`, and adds it to the count of time. */
static int read_key(const grobo_play_item *item, size_t i, grobo_posture *posture,
                    grobo_play_key *key)
{
    int64_t at_us;
    int result = item->clip.key(item->clip.ctx, i, posture, &at_us);
    if (result >= 0) {
        result = at_us < 0                          ? GROBO_ERR_ARG
                 : at_us > GROBO_PLAY_LENGTH_MAX_US ? GROBO_ERR_CAP
                                                    : finish_read(item, posture);
    }
    if (result == 0) {
        key->i = i;
        key->is_empty = posture->set == 0;
        key->defaults += posture->time_us == 0;
        key->at_us = at_us + (int64_t)key->defaults * item->options.default_time_us;
    }
    return result;
}

/* Reads all keys: the item's times, and the joints they set. */
static int scan_keys(grobo_play_item *item, grobo_joint_mask *set)
{
    grobo_play_key key = {0};
    int64_t before_us = -1;
    for (size_t i = 0; i < item->clip.n_keys; i++) {
        grobo_posture posture;
        int result = read_key(item, i, &posture, &key);
        if (result < 0) {
            return result;
        }
        if (key.at_us <= before_us) {
            return GROBO_ERR_ARG;
        }
        before_us = key.at_us;
        item->first_key_us = i == 0 ? key.at_us : item->first_key_us;
        *set |= posture.set;
    }
    item->span_us = key.at_us - item->first_key_us;
    return item->span_us > GROBO_PLAY_LENGTH_MAX_US ? GROBO_ERR_CAP : 0;
}

/* ---- items ---- */

enum { OPTION_TIMES = 3 };

/* Fills in the defaults of times. @return false if one is out of range */
static bool settle_times(grobo_play_options *o)
{
    static const int32_t default_us[OPTION_TIMES] = {GROBO_POSTURE_TIME_US, GROBO_PLAY_STOP_US,
                                                     GROBO_PLAY_LATE_US};
    int64_t *const times_us[OPTION_TIMES] = {&o->default_time_us, &o->stop_us, &o->late_us};
    for (int i = 0; i < OPTION_TIMES; i++) {
        if (*times_us[i] == 0) {
            *times_us[i] = default_us[i];
        }
        if (*times_us[i] < 0 || *times_us[i] > GROBO_PLAY_TIME_MAX_US) {
            return false;
        }
    }
    return true;
}

static void fill_number(uint16_t *number, uint16_t otherwise)
{
    if (*number == 0) {
        *number = otherwise;
    }
}

int32_t grobo_play_passes(int32_t repeat)
{
    if (repeat < 0) {
        return repeat < -INT32_MAX ? INT32_MAX : -repeat;
    }
    return repeat > 0 ? repeat : 1;
}

static bool settle_options(grobo_play_options *o)
{
    o->reverse |= o->repeat < 0;
    o->repeat = grobo_play_passes(o->repeat);
    fill_number(&o->speed_pct, 100);
    fill_number(&o->rate_hz, GROBO_PLAY_RATE_HZ);
    fill_number(&o->approach_deg_s, GROBO_PLAY_APPROACH_DEG_S);
    return (o->mode == GROBO_PLAY_KEY || o->mode == GROBO_PLAY_RATE) && o->from_us >= 0 &&
           o->start_us >= 0 && o->start_us <= GROBO_START_LATER &&
           o->speed_pct <= GROBO_PLAY_SPEED_MAX_PCT && o->rate_hz <= GROBO_PLAY_RATE_MAX_HZ &&
           settle_times(o);
}

static int check_clip(const grobo_play_item *item)
{
    const grobo_clip *clip = &item->clip;
    if (clip->n_keys == 0 || clip->n_joints == 0) {
        return GROBO_ERR_EMPTY;
    }
    if (clip->n_joints > GROBO_JOINTS_MAX || clip->length_us < 0 || clip->key == NULL ||
        (item->model != NULL && clip->n_joints != item->model->n_joints)) {
        return GROBO_ERR_ARG;
    }
    if (clip->length_us > GROBO_PLAY_LENGTH_MAX_US) {
        return GROBO_ERR_CAP;
    }
    if ((item->options.mode == GROBO_PLAY_RATE && clip->sample == NULL) ||
        (item->options.mirror && item->model == NULL)) {
        return GROBO_ERR_UNSUPPORTED;
    }
    return 0;
}

/* Reads what the mode will read: the item's times, and the joints it sets. */
static int look_through(grobo_play_item *item, grobo_joint_mask *set)
{
    if (item->options.mode == GROBO_PLAY_KEY) {
        return scan_keys(item, set);
    }
    grobo_posture posture;
    int result = read_sample(item, &posture, 0);
    if (result == 0) {
        item->span_us = item->clip.length_us;
        *set = posture.set;
    }
    return result;
}

/* Where the robot is when the item begins. */
static int check_start(const grobo_play_item *item, const grobo_posture *start,
                       grobo_joint_mask set)
{
    int result = check_posture(start, &item->clip);
    bool unknown = item->clip.relative && (set & ~start->set) != 0;
    return result == 0 && unknown ? GROBO_ERR_EMPTY : result;
}

int grobo_i_item_make(grobo_play_item *item, const grobo_model *model, const grobo_clip *clip,
                      const grobo_play_options *options, const grobo_posture *start)
{
    grobo_joint_mask set = 0;

    memset(item, 0, sizeof *item);
    item->model = model;
    item->clip = *clip;
    if (options != NULL) {
        item->options = *options;
    }
    if (!settle_options(&item->options)) {
        return GROBO_ERR_ARG;
    }
    int result = check_clip(item);
    if (result == 0) {
        result = look_through(item, &set);
    }
    if (result == 0 && item->options.from_us > item->span_us) {
        result = GROBO_ERR_ARG;
    }
    if (result == 0 && start != NULL) {
        result = check_start(item, start, set);
    }
    return result;
}

void grobo_i_item_load(grobo_sequencer *seq)
{
    seq->item = seq->queue[seq->queue_head];
    seq->queue_head = (uint8_t)((seq->queue_head + 1) % GROBO_QUEUE_MAX);
    seq->queue_n--;
    seq->anchor_pos_us = seq->item.options.from_us;
    seq->pass = 1;
    seq->base = seq->from;
    seq->n_items++;
}

/* ---- postures of an item ---- */

/* Puts a posture of the clip over `to`; increments go onto what is there, or onto the base. */
static int put_over(grobo_sequencer *seq, grobo_posture *posture)
{
    for (int j = 0; seq->item.clip.relative && j < posture->n_joints; j++) {
        const grobo_posture *ground = has(&seq->to, j) ? &seq->to : &seq->base;
        if (has(posture, j) && !has(ground, j)) {
            return GROBO_ERR_EMPTY;
        }
        posture->angle_rad[j] += ground->angle_rad[j];
    }
    grobo_posture_merge(&seq->to, posture);
    return 0;
}

void grobo_i_arrive(grobo_sequencer *seq)
{
    grobo_posture_merge(&seq->from, &seq->to);
}

static void clear_to(grobo_sequencer *seq)
{
    (void)grobo_posture_init(&seq->to, seq->item.clip.n_joints);
}

int grobo_i_sample(grobo_sequencer *seq, int64_t pos_us)
{
    grobo_posture posture;
    int64_t t_us = seq->item.options.reverse ? seq->item.span_us - pos_us : pos_us;
    int result = read_sample(&seq->item, &posture, t_us);
    if (result < 0) {
        return result;
    }
    clear_to(seq);
    return put_over(seq, &posture);
}

/* Adds key i, the one behind the last added, to `to` and to the count of time. */
static int add_key(grobo_sequencer *seq, size_t i)
{
    grobo_posture posture;
    int result = read_key(&seq->item, i, &posture, &seq->key);
    return result < 0 ? result : put_over(seq, &posture);
}

int grobo_i_key_load(grobo_sequencer *seq, size_t i)
{
    seq->key = (grobo_play_key){0};
    clear_to(seq);
    int result = 0;
    for (size_t k = 0; k <= i && result == 0; k++) {
        result = add_key(seq, k);
    }
    return result;
}

int64_t grobo_i_key_pos(const grobo_sequencer *seq)
{
    int64_t pos_us = seq->key.at_us - seq->item.first_key_us;
    return seq->item.options.reverse ? seq->item.span_us - pos_us : pos_us;
}

bool grobo_i_key_has_next(const grobo_sequencer *seq)
{
    return seq->item.options.reverse ? seq->key.i > 0 : seq->key.i + 1 < seq->item.clip.n_keys;
}

int grobo_i_key_next(grobo_sequencer *seq)
{
    if (!seq->item.options.reverse) {
        int result = add_key(seq, seq->key.i + 1);
        seq->silent = seq->key.is_empty;
        return result;
    }
    /* Backwards a key is taken away: what was before it is found from the beginning. */
    seq->silent = seq->key.is_empty;
    return grobo_i_key_load(seq, seq->key.i - 1);
}

int grobo_i_key_seek(grobo_sequencer *seq, int64_t pos_us)
{
    int result = grobo_i_key_load(seq, seq->item.options.reverse ? seq->item.clip.n_keys - 1 : 0);
    while (result == 0 && grobo_i_key_pos(seq) < pos_us) {
        grobo_play_key key = seq->key;
        grobo_posture before = seq->to;
        int64_t before_us = grobo_i_key_pos(seq);
        result = grobo_i_key_next(seq);
        int64_t time_us = grobo_i_key_pos(seq) - before_us;
        int64_t made_us = pos_us - before_us;
        if (result == 0 && time_us > made_us) {
            double part = (double)made_us / (double)time_us;
            grobo_i_between(&seq->to, &before, &seq->to, part);
            seq->key = key;
            break;
        }
    }
    return result;
}

int64_t grobo_i_key_first_time(const grobo_sequencer *seq)
{
    return seq->item.options.reverse ? seq->item.options.default_time_us : seq->item.first_key_us;
}

void grobo_i_between(grobo_posture *posture, const grobo_posture *from, const grobo_posture *to,
                     double part)
{
    bool there = part >= 1.0;
    for (int j = 0; j < to->n_joints; j++) {
        double start_rad = from->angle_rad[j];
        double way_rad = to->angle_rad[j] - start_rad;
        if (has(to, j)) {
            posture->angle_rad[j] = there ? to->angle_rad[j] : start_rad + way_rad * part;
        }
    }
    posture->set = there ? posture->set | to->set : posture->set & from->set;
}

int32_t grobo_i_approach_time(const grobo_sequencer *seq)
{
    double far_rad = 0.0;
    for (int j = 0; j < seq->to.n_joints; j++) {
        double way_rad = UNKNOWN_RAD;
        if (!has(&seq->to, j)) {
            continue;
        }
        if (has(&seq->from, j)) {
            way_rad = fabs(seq->to.angle_rad[j] - seq->from.angle_rad[j]);
        }
        far_rad = way_rad > far_rad ? way_rad : far_rad;
    }
    if (far_rad < THERE_RAD) {
        return 0;
    }
    double units = ceil(far_rad * (DEG_PER_RAD * 1e6 / GROBO_PLAY_TIME_UNIT_US) /
                        seq->item.options.approach_deg_s);
    /* A posture out of all reason takes the longest time there is; limits are checked elsewhere. */
    units = units < (double)TIME_MAX_UNITS ? units : (double)TIME_MAX_UNITS;
    return (int32_t)units * GROBO_PLAY_TIME_UNIT_US;
}
