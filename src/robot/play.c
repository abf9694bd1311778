/* SPDX-License-Identifier: MIT */
/* The sequencer's frames, on time. */
#include <math.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "src/base/sized.h"
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/job.h"
#include "src/robot/lines.h"
#include "src/robot/orders.h"
#include "src/robot/play.h"
#include "src/robot/query.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/stop.h"
#include "src/robot/trajectories.h"
#include "src/robot/trip.h"
#include "src/robot/wheel.h"

void grobo_i_play_tell(grobo_robot *robot)
{
    grobo_sequencer_state state = grobo_sequencer_get_state(&robot->sequencer);
    if (state == robot->told_state) {
        return;
    }
    grobo_play_progress progress;
    grobo_sequencer_progress(&robot->sequencer, robot->now_us, &progress);
    grobo_event event = {.kind = GROBO_EVENT_PLAY};
    event.u.play.from = robot->told_state;
    event.u.play.to = state;
    event.u.play.error = progress.error;
    robot->settling = state == GROBO_SEQUENCER_FINISHED;
    robot->told_state = state;
    grobo_i_tell(robot, &event);
}

/* Every joint that a clip sets: by keys all of them are looked at, at a rate its ends. */
static int joints_of_clip(const grobo_clip *clip, const grobo_play_options *options,
                          grobo_joint_mask *joints)
{
    grobo_posture posture;
    int64_t at_us;
    int result = GROBO_OK;
    *joints = 0;
    if (options->mode == GROBO_PLAY_RATE && clip->sample != NULL) {
        result = clip->sample(clip->ctx, 0, &posture);
        *joints = result < 0 ? 0 : posture.set;
        if (result >= 0) {
            result = clip->sample(clip->ctx, clip->length_us, &posture);
        }
        *joints |= result < 0 ? 0 : posture.set;
        return result;
    }
    if (clip->key == NULL) {
        return GROBO_ERR_ARG;
    }
    for (size_t i = 0; i < clip->n_keys && result >= 0; i++) {
        result = clip->key(clip->ctx, i, &posture, &at_us);
        *joints |= result < 0 ? 0 : posture.set;
    }
    return result;
}

int grobo_i_play_joints(const grobo_robot *robot, const grobo_clip *clip,
                        const grobo_play_options *options, grobo_joint_mask *joints)
{
    int result = joints_of_clip(clip, options, joints);
    if (result >= 0 && options->mirror) {
        grobo_posture posture;
        (void)grobo_posture_init(&posture, robot->driver->model->n_joints);
        posture.set = *joints;
        result = grobo_posture_mirror(&posture, robot->driver->model);
        *joints = posture.set;
    }
    /* A clip cannot move a joint without the one that it follows. */
    for (int joint; grobo_i_follows_alone(robot, *joints, &joint);) {
        *joints &= ~GROBO_JOINT_BIT(joint);
    }
    *joints = grobo_i_coupled(robot, *joints) & ~grobo_i_wheels(robot);
    return result;
}

int grobo_i_play_options(const grobo_robot *robot, const grobo_play_options *options,
                         grobo_play_options *chosen)
{
    int result = grobo_i_sized_take(chosen, sizeof *chosen, options);
    if (result < 0) {
        return result;
    }
    if (chosen->approach_deg_s == 0) {
        chosen->approach_deg_s =
            (uint16_t)lround(fmin(fmax(robot->config.approach_dps, 1), UINT16_MAX));
    }
    if (chosen->default_time_us == 0) {
        chosen->default_time_us = robot->config.default_time_us;
    }
    return GROBO_OK;
}

int grobo_i_play_rate(const grobo_robot *robot, grobo_play_options *chosen)
{
    grobo_budget budget;
    if (chosen->mode != GROBO_PLAY_RATE) {
        return GROBO_OK;
    }
    int result = grobo_robot_budget(robot, &budget);
    if (result < 0) {
        return result;
    }
    if (chosen->rate_hz == 0) {
        chosen->rate_hz = budget.default_hz > 0 ? budget.default_hz : 1;
    }
    bool watched = chosen->rate_hz <= budget.watched_hz;
    if (!watched && !chosen->unwatched) {
        return GROBO_ERR_UNWATCHED;
    }
    chosen->unwatched = !watched;
    return GROBO_OK;
}

/* ---- watching -------------------------------------------------------------------------------- */

bool grobo_i_play_unwatched(const grobo_robot *robot)
{
    return grobo_i_is_playing(robot) && robot->sequencer.item.options.unwatched;
}

/* Once for each clip that begins. */
static void tell_unwatched(grobo_robot *robot)
{
    const grobo_play_options *options = &robot->sequencer.item.options;
    bool read =
        robot->config.sense_interval_us != GROBO_SENSE_NEVER && !robot->config.sense_position_only;
    if (robot->told_item == robot->sequencer.n_items) {
        return;
    }
    robot->told_item = robot->sequencer.n_items;
    if (read && !options->unwatched) {
        return;
    }
    grobo_budget budget = {0};
    grobo_event event = {.kind = GROBO_EVENT_UNWATCHED};
    (void)grobo_robot_budget(robot, &budget);
    event.u.unwatched.rate_hz = options->mode == GROBO_PLAY_RATE ? options->rate_hz : 0;
    event.u.unwatched.watched_hz = budget.watched_hz;
    grobo_i_tell(robot, &event);
}

int grobo_i_play_start(grobo_robot *robot)
{
    grobo_robot_task *job = robot->job;
    if (grobo_sequencer_get_state(&robot->sequencer) == GROBO_SEQUENCER_FAILED) {
        grobo_sequencer_reset(&robot->sequencer);
    }
    grobo_posture here;
    (void)grobo_robot_posture(robot, GROBO_NEVER_US, &here);
    for (int j = 0; j < here.n_joints; j++) {
        if (grobo_i_has(job->joints, j)) {
            here.angle_rad[j] = grobo_i_axis_commanded(&robot->axes[j], robot->now_us);
        }
    }
    robot->played_joints = 0;
    memset(robot->late_bins, 0, sizeof robot->late_bins);
    robot->late_max_us = 0;
    int result =
        grobo_sequencer_play(&robot->sequencer, &job->clip, &job->options, &here, robot->now_us);
    if (result < 0) {
        return result;
    }
    grobo_play_progress progress;
    if (robot->sense_us > robot->now_us) {
        robot->sense_us = robot->now_us; /* read so far in an interval that may be long */
    }
    grobo_i_play_step(robot); /* the approach leaves at once */
    grobo_sequencer_progress(&robot->sequencer, robot->now_us, &progress);
    return progress.error;
}

/* ---- lateness -------------------------------------------------------------------------------- */

/* Four an octave: where the highest bit is, and how far the number is on the trajectory to the
 * next. */
static int bin_of(int64_t late_us)
{
    static const uint32_t edges[] = {0x9837F052, 0xB504F334, 0xD744FCCB}; /* 2^(31 + k/4) */
    uint32_t rest = late_us < 1 ? 1 : late_us < UINT32_MAX ? (uint32_t)late_us : UINT32_MAX;
    int bin = 4 * 31;
    for (; rest < UINT32_C(1) << 31; rest <<= 1) {
        bin -= 4;
    }
    for (int k = 0; k < 3; k++) {
        bin += rest >= edges[k];
    }
    return bin < GROBO_ROBOT_JITTER_BINS ? bin : GROBO_ROBOT_JITTER_BINS - 1;
}

static void note_lateness(grobo_robot *robot, int64_t late_us)
{
    robot->late_bins[bin_of(late_us)]++;
    if (late_us > robot->late_max_us) {
        robot->late_max_us = late_us;
    }
}

static int64_t quantile(const grobo_robot *robot, uint64_t frames, unsigned pct)
{
    uint64_t below = 0;
    for (int bin = 0; bin < GROBO_ROBOT_JITTER_BINS; bin++) {
        below += robot->late_bins[bin];
        if (below * 100 >= frames * pct) {
            int64_t edge_us = (int64_t)ceil(exp2((bin + 1) / 4.0));
            return edge_us < robot->late_max_us ? edge_us : robot->late_max_us;
        }
    }
    return robot->late_max_us;
}

void grobo_robot_jitter(const grobo_robot *robot, grobo_jitter *jitter)
{
    if (robot == NULL || jitter == NULL) {
        return;
    }
    uint64_t frames = 0;
    for (int bin = 0; bin < GROBO_ROBOT_JITTER_BINS; bin++) {
        frames += robot->late_bins[bin];
    }
    jitter->frames = frames;
    jitter->p50_us = frames == 0 ? 0 : quantile(robot, frames, 50);
    jitter->p99_us = frames == 0 ? 0 : quantile(robot, frames, 99);
    jitter->max_us = robot->late_max_us;
}

static void count_played(const grobo_robot_slot *slot, int result)
{
    grobo_robot_counters *counters = &slot->robot->counters;
    if (result >= 0) {
        int64_t late_us = slot->txn.sent_us - slot->due_us;
        note_lateness(slot->robot, late_us);
        /* Late because of the line; the sequencer counted what came late to it. */
        if (late_us > GROBO_PLAY_LATE_US && slot->given_us - slot->due_us <= GROBO_PLAY_LATE_US) {
            counters->late_frames++;
        }
    } else {
        counters->late_frames++; /* a later one took its place */
    }
}

/* ---- frames ---------------------------------------------------------------------------------- */

static void give_up(grobo_robot *robot, int error)
{
    (void)grobo_sequencer_fail(&robot->sequencer, error);
    if (error == GROBO_ERR_LIMIT || error == GROBO_ERR_NAN) {
        grobo_i_trip(robot, error == GROBO_ERR_LIMIT ? GROBO_TRIP_LIMIT : GROBO_TRIP_NUMBER,
                     robot->fault_joint, robot->fault_deg, false);
    }
    grobo_i_stop_broken(robot);
}

void grobo_i_play_done(grobo_robot_slot *slot, int result)
{
    grobo_robot *robot = slot->robot;
    /* Its joints are read first, or a later one has taken its place: one tried again, mostly. */
    bool refused = slot->refused && result != GROBO_ERR_EMPTY && result != GROBO_ERR_SUPERSEDED;
    robot->counters.motion_frames += result >= 0;
    if (slot->due_us != GROBO_NEVER_US) {
        count_played(slot, result);
        if (refused) {
            give_up(robot, result);
        }
    } else if (refused) {
        grobo_i_job_refused(slot, result);
    }
}

static bool send_frame(grobo_robot *robot, const grobo_play_frame *frame)
{
    bool rests = frame->phase == GROBO_SEQUENCER_STOPPING || frame->phase == GROBO_SEQUENCER_PAUSED;
    grobo_i_motion how = {.priority = GROBO_PRIORITY_MOTION,
                          .due_us = frame->due_us,
                          .each = frame->phase != GROBO_SEQUENCER_APPROACHING,
                          .stops = rests,
                          .rests = rests};
    grobo_i_slots_cancel_goals(robot, frame->posture.set, true);
    int result = grobo_i_gate_send(robot, &frame->posture, &how);
    if (result < 0) {
        give_up(robot, result);
        return false;
    }
    return true;
}

static void watch_host(grobo_robot *robot)
{
    int64_t due_us = grobo_sequencer_deadline(&robot->sequencer);
    if (due_us == GROBO_NEVER_US || robot->now_us - due_us <= robot->config.stall_us) {
        return;
    }
    robot->counters.stalls++;
    grobo_i_trip(robot, GROBO_TRIP_HOST_STALL, -1, (double)(robot->now_us - due_us) / 1000.0,
                 false);
}

void grobo_i_play_reserve(grobo_robot *robot)
{
    int64_t due_us = grobo_sequencer_deadline(&robot->sequencer);
    int64_t renew_us = grobo_i_segments_due(robot);
    due_us = renew_us < due_us ? renew_us : due_us;
    uint32_t motion_us = due_us == GROBO_NEVER_US ? 0 : robot->motion_us;
    grobo_bus_reserve(&robot->bus, due_us, motion_us);
    grobo_i_lines_reserve(robot, due_us, motion_us);
}

void grobo_i_play_step(grobo_robot *robot)
{
    if (!grobo_i_is_playing(robot)) {
        return;
    }
    watch_host(robot);
    const grobo_play_stats *stats = grobo_sequencer_stats(&robot->sequencer);
    uint32_t late_before = stats->late_frames;
    grobo_play_frame frame;
    int more;
    while ((more = grobo_sequencer_next(&robot->sequencer, robot->now_us, &frame)) > 0) {
        if (!send_frame(robot, &frame)) {
            break;
        }
    }
    if (more < 0) {
        grobo_i_stop_broken(robot);
    }
    robot->counters.late_frames += (uint32_t)(stats->late_frames - late_before);
    tell_unwatched(robot);
    grobo_i_play_reserve(robot);
}
