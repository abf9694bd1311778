/* SPDX-License-Identifier: MIT */
/* The wire of the far side: when bytes are there, and when replies are back. */
#include <math.h>
#include <string.h>

#include "tests/support/far_side.h"

int64_t far_wire_us(const far_side *far, int bytes)
{
    return (int64_t)bytes * far->family->bits_a_byte * 1000000 / far->baud_bps;
}

void far_put16(uint8_t *to, int value)
{
    to[0] = (uint8_t)((unsigned)value & 0xFF);
    to[1] = (uint8_t)((unsigned)value >> 8 & 0xFF);
}

int far_get16(const uint8_t *from)
{
    return from[0] | from[1] << 8;
}

int far_signed16(const uint8_t *from)
{
    return (int16_t)far_get16(from);
}

void far_begin(far_side *far, const far_family *family, int n_joints, int64_t now_us)
{
    memset(far, 0, sizeof *far);
    far->family = family;
    far->baud_bps = family->baud_bps;
    far->n_joints = n_joints;
    far->now_us = far->free_us = now_us;
    far->lose_motor = far->lose_reply = FAR_NEVER;
    far->motor_left_us = far->first_left_us = FAR_NEVER;
    for (int i = 0; i < n_joints; i++) {
        far_joint *joint = &far->joint[i];
        joint->family = family;
        joint->id = i + 1;
        joint->top_dps = family->top_dps;
        joint->celsius = 35;
        joint->at_us = now_us;
        far->told_us[i] = FAR_NEVER;
        family->begin(joint);
    }
}

far_joint *far_find(far_side *far, int id)
{
    for (int i = 0; i < far->n_joints; i++) {
        if (far->joint[i].id == id) {
            return &far->joint[i];
        }
    }
    return NULL;
}

/* ---- what servos are told -------------------------------------------------------------------- */

static void report(far_side *far, far_joint *joint, far_news *news)
{
    int i = (int)(joint - far->joint);
    if (far->loses) {
        far->missed |= UINT64_C(1) << i;
        return;
    }
    news->missed = joint->missed;
    news->joint = i;
    news->now_us = far->now_us;
    news->left_us = far->obeyed->left_us;
    news->left_deg = far->obeyed->left_deg[i];
    if (far->hear != NULL) {
        far->hear(far->ctx, news);
    }
}

void far_goal(far_side *far, far_joint *joint)
{
    far_news news = {.is_goal = true, .torque = joint->torque};
    double accel_dps2;
    far_turn_to(joint, far->now_us);
    if (joint->torque != 1 && !far->loses) {
        return;
    }
    joint->waits = true;
    joint->leaps = false; /* it has a way to go by */
    joint->wakes_us = far->now_us + far->family->dead_us;
    joint->family->plan(joint, &news.goal_deg, &news.ask_dps, &accel_dps2);
    report(far, joint, &news);
}

void far_torque(far_side *far, far_joint *joint, int torque)
{
    far_news news = {.torque = torque};
    int before = joint->torque;
    far_turn_to(joint, far->now_us);
    joint->torque = torque;
    if (torque != 1) {
        joint->waits = false;
        joint->set_dps = 0;
        joint->goal_deg = joint->set_deg = joint->at_deg;
        joint->dps = joint->sag_deg != 0 ? joint->dps : 0;
    } else if (before != 1) {
        joint->waits = joint->leaps = true;
        joint->wakes_us = far->now_us + far->family->dead_us;
    }
    report(far, joint, &news);
}

void far_put(far_side *far, int joint, double deg, bool holds, int64_t now_us)
{
    far_joint *j = &far->joint[joint];
    far_turn_to(j, now_us);
    j->waits = false;
    j->at_deg = j->set_deg = j->goal_deg = deg;
    j->dps = j->set_dps = 0;
    j->torque = holds;
    j->begun_us = now_us;
    j->family->hold(j, deg, 0, now_us);
}

void far_foreign(far_side *far, int joint, double deg, double dps, int64_t now_us)
{
    far_joint *j = &far->joint[joint];
    far_turn_to(j, now_us);
    j->waits = false;
    j->torque = 1;
    j->goal_deg = deg;
    j->cruise_dps = dps;
    j->accel_dps2 = 0;
    j->begun_us = now_us;
    j->family->hold(j, deg, dps, now_us);
}

/* ---- bytes ----------------------------------------------------------------------------------- */

static void add_frame(far_side *far, const uint8_t *bytes, int n, int64_t now_us)
{
    far_frame *frame = &far->frame[far->n_frames];
    if (far->n_frames == FAR_FRAMES) {
        far->broken_frames++;
        return;
    }
    far->n_frames++;
    frame->left_us = now_us;
    frame->due_us = far->free_us;
    if (far->family->relay_us != NULL) {
        frame->due_us += far->family->relay_us(far, bytes, n);
    }
    frame->n = n;
    memcpy(frame->bytes, bytes, (size_t)n);
    for (int i = 0; i < far->n_joints; i++) {
        frame->left_deg[i] = far_angle(far, i, now_us);
    }
    far->first_left_us = far->first_left_us == FAR_NEVER ? now_us : far->first_left_us;
    if (far->family->moves(bytes, n)) {
        far->motor_left_us = far->motor_left_us == FAR_NEVER ? now_us : far->motor_left_us;
    }
}

static void add_reply(far_side *far, const uint8_t *bytes, int n, int64_t due_us)
{
    if (far->n_replies < FAR_REPLIES && n <= FAR_REPLY_BYTES) {
        far_reply *reply = &far->reply[far->n_replies++];
        reply->due_us = due_us;
        reply->n = n;
        memcpy(reply->bytes, bytes, (size_t)n);
    }
}

void far_take(far_side *far, const uint8_t *bytes, int n, int64_t now_us)
{
    far_step(far, now_us);
    far->free_us = far->free_us > now_us ? far->free_us : now_us;
    for (int i = 0; i < n; i++) {
        int size;
        far->free_us += far_wire_us(far, 1);
        far->in[far->n_in++] = bytes[i];
        while (far->n_in > 0 && (size = far->family->measure(far->in, far->n_in)) != 0) {
            int gone = size > 0 ? size : 1;
            if (size > 0) {
                add_frame(far, far->in, size, now_us);
            } else {
                far->broken_frames++;
            }
            far->n_in -= gone;
            memmove(far->in, far->in + gone, (size_t)far->n_in);
        }
    }
    if (far->family->echo) {
        add_reply(far, bytes, n, far->free_us);
    }
}

/* A reply waits for those before it, and takes its time on the wire. */
void far_answer(far_side *far, far_joint *told, const uint8_t *bytes, int n)
{
    int64_t due_us = far->now_us;
    if (far->loses || far->mute) {
        return;
    }
    for (int i = 0; i < far->n_replies; i++) {
        due_us = far->reply[i].due_us > due_us ? far->reply[i].due_us : due_us;
    }
    due_us += far->family->think_us + far_wire_us(far, n) + far->late_us;
    far->late_us = 0;
    if (far->lose_reply != FAR_NEVER && far->lose_reply-- == 0) {
        far->lost_frames++;
        far->lost_us = far->now_us;
        return;
    }
    if (told != NULL && due_us > far->lost_us + FAR_TELLS_US) {
        told->missed = false;
    }
    if (told != NULL && far->told_us[told - far->joint] == FAR_NEVER) {
        far->told_us[told - far->joint] = due_us;
    }
    add_reply(far, bytes, n, due_us);
}

/* Nobody obeys this frame. Who would have, missed it. */
static void lose(far_side *far, const far_frame *frame)
{
    static far_joint before[FAR_JOINTS];
    memcpy(before, far->joint, sizeof before);
    far->loses = true;
    far->missed = 0;
    far->family->obey(far, frame->bytes, frame->n);
    far->loses = false;
    memcpy(far->joint, before, sizeof before);
    for (int i = 0; i < far->n_joints; i++) {
        far->joint[i].missed = far->joint[i].missed || (far->missed >> i & 1U) != 0;
    }
    far->lost_frames++;
    far->lost_us = far->now_us;
}

static void obey_frame(far_side *far, far_frame *frame)
{
    far->now_us = frame->due_us > far->now_us ? frame->due_us : far->now_us;
    far->frames++;
    if (!far->family->sound(frame->bytes, frame->n)) {
        far->broken_frames++;
        return;
    }
    if (far->family->moves(frame->bytes, frame->n)) {
        far->motor_frames++;
        if (far->lose_motor != FAR_NEVER && far->lose_motor-- == 0) {
            lose(far, frame);
            return;
        }
    }
    far->obeyed = frame;
    far->family->obey(far, frame->bytes, frame->n);
    far->obeyed = NULL;
}

void far_step(far_side *far, int64_t now_us)
{
    while (far->n_frames > 0 && far->frame[0].due_us <= now_us) {
        far_frame frame = far->frame[0];
        far->n_frames--;
        memmove(far->frame, far->frame + 1, (size_t)far->n_frames * sizeof frame);
        obey_frame(far, &frame);
    }
    far->now_us = now_us > far->now_us ? now_us : far->now_us;
}

int far_give(far_side *far, uint8_t *bytes, int cap, int64_t now_us)
{
    int n = 0;
    far_step(far, now_us);
    while (far->n_replies > 0 && far->reply[0].due_us <= now_us && far->reply[0].n <= cap - n) {
        memcpy(bytes + n, far->reply[0].bytes, (size_t)far->reply[0].n);
        n += far->reply[0].n;
        far->n_replies--;
        memmove(far->reply, far->reply + 1, (size_t)far->n_replies * sizeof far->reply[0]);
    }
    return n;
}

int64_t far_next_us(const far_side *far)
{
    int64_t next_us = far->n_frames > 0 ? far->frame[0].due_us : INT64_MAX;
    return far->n_replies > 0 && far->reply[0].due_us < next_us ? far->reply[0].due_us : next_us;
}
