/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "src/base/instant.h"
#include "tests/support/sequence_judge.h"
#include "tests/support/test.h"

#define DEG(rad) ((rad)*57.29577951308232)

/* Those of halt_kit.c, where they are explained. */
#define SLACK_DEG 2.0
#define STILL_DPS 1.0
#define STILL_DEG 0.5
#define COUNT_DPS 4.0
#define COUNT_S 0.6
#define BRAKE_S 0.05
#define HALT_TIME_US 100000
#define LOST_REPLY_US 45000
#define JUST_NOW_US 100000
/* A joint that others turn is read every 100 ms, twice where its servo tells no speed. */
#define FOREIGN_US 400000
#define FOREIGN_DPS 60
#define FOREIGN_READ_S 0.1
/* One that is slower may sink to the goal that carries its weight. */
#define CREEP_DPS 8
/* A joint's torque is read as often as that, at least. */
#define FULL_READING_US 2500000
/* Heat is read at least every 2 s, and trips in the reading that shows it. */
#define HOT_US 2500000

/* As far beyond where it ever was a joint may be halted that turns: so much it comes to rest in. */
#define BEYOND_DEG 4.0

sequence_judge sequence;

void sequence_blame(const char *rule, int servo, double is, double may)
{
    if (sequence.fault[0] == '\0') {
        (void)snprintf(sequence.fault, sizeof sequence.fault, "%s: joint %d: %.2f, allowed %.2f",
                       rule, servo + 1, is, may);
    }
}

static int servo_of(int joint)
{
    return halt.of->driver.model->joints[joint].motor - 1;
}

static double braking_deg(const far_joint *joint, double dps)
{
    double ramp_deg = joint->accel_dps2 > 0 ? dps * dps / (2 * joint->accel_dps2) : 0;
    return fmax(ramp_deg, fabs(dps) * BRAKE_S);
}

static double slack_deg(const far_joint *joint)
{
    return SLACK_DEG + joint->family->step_deg + joint->family->count_dps * COUNT_S;
}

/* One that arrived just now may be taken to turn yet. */
static double turning_dps(const far_joint *joint)
{
    bool just_now = joint->last_us > 0 && halt.now_us - joint->last_us < JUST_NOW_US;
    return joint->dps != 0 || !just_now ? joint->dps : joint->last_dps;
}

/* Where a joint comes to rest that is told so now. */
static double rest_deg(const far_joint *joint, double soft_s)
{
    double dps = turning_dps(joint), dead_s = (double)joint->family->dead_us / HALT_S;
    return joint->at_deg + copysign(braking_deg(joint, dps), dps) + dps * (dead_s + soft_s);
}

static void widen(sequence_joint *its, double deg)
{
    its->lo_deg = fmin(its->lo_deg, deg);
    its->hi_deg = fmax(its->hi_deg, deg);
}

/* Its servo restarted, and is not known to have no torque: torque is read as often as that. */
static bool is_restarted(int servo)
{
    const sequence_joint *its = &sequence.joint[servo];
    return its->restarted && halt.now_us < its->foreign_us + FULL_READING_US;
}

/* It missed a frame, and nothing that it told since has shown that to who reads every joint in full
 * so often. */
static bool is_lost(int servo)
{
    const sequence_joint *its = &sequence.joint[servo];
    return halt.far.joint[servo].missed || halt.now_us < its->missed_us + FULL_READING_US;
}

/* What was done to it is nothing that its engine can know by now: of a servo that tells no speed
 * two places show it. */
static bool is_unsure(int servo)
{
    const sequence_joint *its = &sequence.joint[servo];
    bool twice = halt.of->driver.tells_no_speed;
    bool just_now = its->foreign_us > 0 && halt.now_us < its->foreign_us + 2 * FOREIGN_US;
    return its->unheard || (twice && just_now);
}

/* Where a joint is now, and may be sent. */
static void note_place(const far_joint *joint, sequence_joint *its)
{
    its->least_deg = fmin(its->least_deg, fmin(its->lo_deg, joint->at_deg));
    its->most_deg = fmax(its->most_deg, fmax(its->hi_deg, joint->at_deg));
}

/* ---- what the far side hears ----------------------------------------------------------------- */

static void judge_limits(const far_news *news, double slack)
{
    const grobo_joint *joint = &halt.of->driver.model->joints[halt_joint_of(news->joint)];
    double min_deg = DEG(joint->min_rad), max_deg = DEG(joint->max_rad);
    if (news->goal_deg < min_deg - slack || news->goal_deg > max_deg + slack) {
        sequence_blame("a goal outside the limits", news->joint, news->goal_deg,
                       news->goal_deg < min_deg ? min_deg : max_deg);
    }
}

/* As in halt_kit.c: a speed counts whatever the way is, a time with the way. */
static void judge_speed(const far_joint *joint, const far_news *news)
{
    double way_deg = fabs(news->goal_deg - joint->at_deg);
    double lag_deg = fabs(joint->at_deg - news->left_deg) + joint->family->step_deg;
    double top_dps = DEG(halt.of->driver.model->joints[halt_joint_of(news->joint)].max_speed_rad_s);
    double most_dps = (top_dps + COUNT_DPS) * 1.01;
    double asked_dps = news->ask_dps > 0 ? news->ask_dps : INFINITY;
    bool timed = joint->family->count_dps == 0;
    if (way_deg <= lag_deg + (timed ? SLACK_DEG / 2 : 0)) {
        return;
    }
    asked_dps *= timed && !isinf(asked_dps) ? (way_deg - lag_deg) / way_deg : 1;
    if (asked_dps > most_dps) {
        sequence_blame("faster than the joint may", news->joint, asked_dps, most_dps);
    }
}

/* The first move of all joints behind a line that is there, or an emergency stop, is slow. */
static void soften(void)
{
    for (int i = 0; i < halt.far.n_joints; i++) {
        sequence.joint[i].soft = true;
    }
}

/* A move is under way: the first one is that. */
static bool any_way(void)
{
    for (int i = 0; i < halt.far.n_joints; i++) {
        if (sequence.joint[i].licensed && far_turns(&halt.far, i, halt.now_us)) {
            return true;
        }
    }
    return false;
}

/* The first move is slow: of a raw goal only the speed of its joint counts. */
static void judge_first(const far_joint *joint, const far_news *news)
{
    const sequence_joint *its = &sequence.joint[news->joint];
    double slow_dps = DEG(halt.of->driver.limits.approach_rad_s) * 1.05 + COUNT_DPS;
    double lag_deg = fabs(joint->at_deg - news->left_deg) + SLACK_DEG;
    if (!its->soft || !its->licensed || its->foreign ||
        fabs(news->goal_deg - joint->at_deg) <= lag_deg) {
        return;
    }
    for (int i = 0; i < halt.far.n_joints; i++) {
        sequence.joint[i].soft = false; /* the first of all of them */
    }
    if (news->ask_dps > slow_dps || news->ask_dps <= 0) {
        sequence_blame("a first move that is fast", news->joint, news->ask_dps, slow_dps);
    }
}

static void judge_place(const far_joint *joint, const far_news *news)
{
    sequence_joint *its = &sequence.joint[news->joint];
    double on_deg = rest_deg(joint, its->licensed ? 0 : sequence.soft_s);
    double lo_deg = fmin(fmin(its->lo_deg, news->left_deg), fmin(joint->at_deg, on_deg));
    double hi_deg = fmax(fmax(its->hi_deg, news->left_deg), fmax(joint->at_deg, on_deg));
    double slack = slack_deg(joint);
    if (!its->licensed && fabs(joint->dps) < CREEP_DPS) { /* it may hang there by its weight */
        lo_deg = fmin(lo_deg, joint->goal_deg);
        hi_deg = fmax(hi_deg, joint->goal_deg);
    }
    if (its->foreign) { /* nobody knows which way it goes by now */
        slack += FOREIGN_DPS * (BRAKE_S + FOREIGN_READ_S);
    }
    if (news->goal_deg < lo_deg - slack || news->goal_deg > hi_deg + slack) {
        sequence_blame(its->licensed ? "a goal that nobody asked for" : "a halt throws a joint",
                       news->joint, news->goal_deg, joint->at_deg);
    }
    if (!its->licensed) {
        widen(its, news->goal_deg);
    }
}

/* A goal that had left when the stop was asked for: the joint sets out, and is taken to turn. */
static void note_on_the_line(const far_joint *joint, sequence_joint *its, double goal_deg,
                             double ask_dps)
{
    double dps = ask_dps > 0 ? fmin(ask_dps, joint->top_dps) : joint->top_dps;
    double on_s = (double)(halt.of->frame_us + joint->family->dead_us) / HALT_S;
    double on_deg = fmin(dps * (BRAKE_S + sequence.soft_s + on_s), fabs(goal_deg - joint->at_deg));
    widen(its, joint->at_deg + copysign(on_deg, goal_deg - joint->at_deg));
}

/* What its engine cannot know of a joint, or SEQUENCE_EXCUSES. */
static sequence_excuse excuse_of(int servo, bool wakes)
{
    return sequence.joint[servo].unheard  ? SEQUENCE_UNHEARD
           : is_unsure(servo)             ? SEQUENCE_DISTURBED
           : wakes && is_restarted(servo) ? SEQUENCE_RESTARTED
           : is_lost(servo)               ? SEQUENCE_LOST
                                          : SEQUENCE_EXCUSES;
}

/* A goal that is excused leads to no place where the joint never was, nor was sent. */
static void judge_excused(const far_joint *joint, const far_news *news, sequence_excuse excuse)
{
    const sequence_joint *its = &sequence.joint[news->joint];
    double beyond_deg = its->foreign ? FOREIGN_DPS * (BRAKE_S + FOREIGN_READ_S) : BEYOND_DEG;
    double slack = slack_deg(joint) + beyond_deg;
    sequence.excused[excuse]++;
    if (news->goal_deg < its->least_deg - slack || news->goal_deg > its->most_deg + slack) {
        sequence_blame("a goal where the joint never was", news->joint, news->goal_deg,
                       joint->at_deg);
    }
}

static void hear_goal(const far_joint *joint, const far_news *news)
{
    sequence_joint *its = &sequence.joint[news->joint];
    int64_t told_us = halt.far.told_us[news->joint];
    sequence.goals++;
    its->raw_waits = its->raw_waits && fabs(news->goal_deg - its->raw_deg) > slack_deg(joint);
    note_place(joint, its);
    if (news->left_us < sequence.up_us) {
        return; /* it was on the line */
    }
    judge_limits(news, slack_deg(joint));
    if (told_us == FAR_NEVER || told_us > news->left_us) {
        if (!its->unheard) {
            sequence_blame("a goal for a joint that was not read", news->joint, news->goal_deg,
                           joint->at_deg);
        }
        judge_excused(joint, news, SEQUENCE_UNHEARD);
        return;
    }
    if (its->licensed && sequence.hot_us > 0 && news->left_us > sequence.hot_us + HOT_US) {
        sequence_blame("a goal for a hot robot", news->joint, news->goal_deg, joint->at_deg);
    }
    sequence_excuse excuse = excuse_of(news->joint, halt.of->driver.goal_energises);
    if (excuse != SEQUENCE_EXCUSES) {
        judge_excused(joint, news, excuse);
        return;
    }
    if (news->left_us >= sequence.halted_us || its->licensed) {
        judge_place(joint, news);
    } else {
        note_on_the_line(joint, its, news->goal_deg, news->ask_dps);
    }
    judge_speed(joint, news);
    judge_first(joint, news);
}

/* A goal wakes servos of some families: it is one where the joint is, all the same. */
static void judge_torque(const far_joint *joint, const far_news *news, double goal_deg)
{
    const sequence_joint *its = &sequence.joint[news->joint];
    sequence_excuse excuse = excuse_of(news->joint, true);
    if (excuse != SEQUENCE_EXCUSES) {
        judge_excused(joint, &(far_news){.joint = news->joint, .goal_deg = goal_deg}, excuse);
    } else if (fabs(goal_deg - joint->at_deg) > slack_deg(joint)) {
        sequence_blame("torque comes on elsewhere", news->joint, goal_deg, joint->at_deg);
    } else if (sequence.latched && news->left_us >= sequence.latched_us) {
        sequence_blame("torque comes on behind a latched stop", news->joint, goal_deg,
                       joint->at_deg);
    } else if (!its->licensed && !its->free && !sequence.wakes &&
               news->left_us >= sequence.halted_us) {
        sequence_blame("torque comes on that nobody asked for", news->joint, goal_deg,
                       joint->at_deg);
    }
}

static void hear_torque(const far_joint *joint, const far_news *news)
{
    sequence_joint *its = &sequence.joint[news->joint];
    double goal_deg, ask_dps, accel_dps2;
    note_place(joint, its);
    if (news->torque == 1 && joint->leaps) {
        its->soft = its->soft || (!is_restarted(news->joint) && !any_way());
        joint->family->plan(joint, &goal_deg, &ask_dps, &accel_dps2);
        judge_torque(joint, news, goal_deg);
    }
}

static void hear(void *ctx, const far_news *news)
{
    const far_joint *joint = &halt.far.joint[news->joint];
    (void)ctx;
    if (halt_traced) {
        printf("%9.3f ms   joint %d at %.2f turns %.1f/s: %s %.2f at %.1f deg/s%s\n",
               (double)(halt.now_us - halt.asked_us) / HALT_MS, news->joint + 1, joint->at_deg,
               joint->dps, news->is_goal ? "goal" : "torque",
               news->is_goal ? news->goal_deg : news->torque, news->ask_dps,
               news->missed ? ", missed one" : "");
    }
    if (news->is_goal) {
        hear_goal(joint, news);
    } else {
        hear_torque(joint, news);
    }
}

/* ---- what the engine tells ------------------------------------------------------------------- */

/* Slower than is noticed, or as near to its goal as is taken to stand, it stands. */
static bool turns(int servo)
{
    far_joint *joint = &halt.far.joint[servo];
    bool on_its_way = far_turns(&halt.far, servo, halt.now_us);
    return on_its_way && fabs(joint->dps) > STILL_DPS &&
           fabs(joint->goal_deg - joint->at_deg) > STILL_DEG + 2 * joint->family->step_deg;
}

static bool is_excused(int servo)
{
    const sequence_joint *its = &sequence.joint[servo];
    bool foreign = its->foreign && halt.now_us < its->foreign_us + 2 * HALT_S;
    return foreign || is_lost(servo);
}

static void judge_standing(const char *rule)
{
    for (int i = 0; i < halt.far.n_joints; i++) {
        if (turns(i) && !is_excused(i)) {
            sequence_blame(rule, i, halt.far.joint[i].dps, 0);
        }
    }
}

static void judge_stop(const grobo_event_job *job)
{
    if (job->result == GROBO_OK && job->kind == GROBO_JOB_ESTOP) {
        judge_standing("an emergency stop is done, and a joint turns");
    }
    if (job->kind == GROBO_JOB_ESTOP && job->result != GROBO_ERR_UNPLUGGED) {
        sequence.owed = false;
    }
    if (job->result == GROBO_OK && job->kind == GROBO_JOB_EXIT) {
        judge_standing("an exit is done, and a joint turns");
    }
    for (int i = 0;
         job->result == GROBO_OK && job->number == sequence.exits_off && i < halt.far.n_joints;
         i++) {
        if (halt.far.joint[i].torque == 1 && !is_excused(i)) {
            sequence_blame("an exit without torque is done, and a joint has it", i, 1, 0);
        }
    }
}

static void hear_job(const grobo_event_job *job)
{
    const char *name = grobo_error_name(job->result);
    if (job->number <= 0 || job->number >= SEQUENCE_NUMBERS) {
        sequence_blame("a job without a number", -1, job->number, SEQUENCE_NUMBERS);
        return;
    }
    if (sequence.ended[job->number]++ > 0) {
        sequence_blame("a job ends twice", -1, job->number, 0);
    }
    if (name == NULL || *name == '\0') {
        sequence_blame("an error without a name", -1, job->result, 0);
    }
    judge_stop(job);
}

/* Joints that move by what is no motion. */
static grobo_joint_mask raw_joints(void)
{
    grobo_joint_mask joints = 0;
    for (int j = 0; j < halt.of->n_joints; j++) {
        joints |= sequence.joint[servo_of(j)].raw ? GROBO_JOINT_BIT(j) : 0;
    }
    return joints;
}

static void on_event(void *ctx, const grobo_event *event)
{
    grobo_joint_mask all = GROBO_JOINTS_ALL(halt.of->n_joints);
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        hear_job(&event->u.job);
        if (event->u.job.number == halt.awaited) {
            halt.result = event->u.job.result;
            halt.over = true;
        }
    } else if (event->kind == GROBO_EVENT_TRIP) {
        bool wakes = sequence.wakes && !event->u.trip.latched;
        sequence_halt(event->u.trip.latched ? all : all & ~raw_joints(), GROBO_PLAY_STOP_US, false);
        sequence.wakes = wakes;
        sequence.latched = sequence.latched || event->u.trip.latched;
        sequence.latched_us = event->u.trip.latched ? halt.now_us + 1 : sequence.latched_us;
    } else if (event->kind == GROBO_EVENT_PLAY && event->u.play.to == GROBO_SEQUENCER_FAILED) {
        sequence_halt(all, GROBO_PLAY_STOP_US, false);
    }
}

/* ---- what is asked for ----------------------------------------------------------------------- */

void sequence_listen(void)
{
    halt.far.hear = hear;
    grobo_robot_on_event(&halt.robot, on_event, NULL);
}

void sequence_begin(void)
{
    memset(&sequence, 0, sizeof sequence);
    sequence.up = true;
    sequence.up_us = halt.now_us;
    for (int i = 0; i < halt.far.n_joints; i++) {
        sequence.joint[i].lo_deg = sequence.joint[i].hi_deg = halt.far.joint[i].at_deg;
        sequence.joint[i].missed_us = -FULL_READING_US;
        sequence.joint[i].least_deg = sequence.joint[i].most_deg = halt.far.joint[i].at_deg;
    }
    sequence_listen();
}

static void license(grobo_joint_mask joints, const double *lo_deg, const double *hi_deg)
{
    bool idle = !grobo_robot_is_playing(&halt.robot);
    for (int j = 0; j < halt.of->n_joints; j++) {
        int servo = servo_of(j);
        sequence_joint *its = &sequence.joint[servo];
        if ((joints & GROBO_JOINT_BIT(j)) == 0) {
            continue;
        }
        if (!its->licensed && idle) {
            its->lo_deg = its->hi_deg = far_angle(&halt.far, servo, halt.now_us);
        }
        its->licensed = true;
        widen(its, rest_deg(&halt.far.joint[servo], 0));
        widen(its, lo_deg != NULL ? *lo_deg : its->lo_deg);
        widen(its, hi_deg != NULL ? *hi_deg : its->hi_deg);
        note_place(&halt.far.joint[servo], its);
    }
}

void sequence_license(grobo_joint_mask joints, double lo_deg, double hi_deg)
{
    license(joints, &lo_deg, &hi_deg);
}

void sequence_license_raw(grobo_joint_mask joints, double deg)
{
    license(joints, &deg, &deg);
    for (int j = 0; j < halt.of->n_joints; j++) {
        sequence_joint *its = &sequence.joint[servo_of(j)];
        if ((joints & GROBO_JOINT_BIT(j)) != 0) {
            its->raw = its->raw_waits = true;
            its->raw_deg = deg;
        }
    }
}

grobo_joint_mask sequence_raw_waits(void)
{
    grobo_joint_mask joints = 0;
    for (int j = 0; j < halt.of->n_joints; j++) {
        joints |= sequence.joint[servo_of(j)].raw_waits ? GROBO_JOINT_BIT(j) : 0;
    }
    return joints;
}

void sequence_license_here(grobo_joint_mask joints)
{
    license(joints, NULL, NULL);
}

static bool any_turns(int64_t for_us)
{
    for (int i = 0; i < halt.far.n_joints; i++) {
        const far_joint *joint = &halt.far.joint[i];
        if (turns(i) && sequence.joint[i].licensed && !sequence.joint[i].foreign && !is_lost(i) &&
            fabs(joint->goal_deg - joint->at_deg) >
                fabs(joint->dps) * (double)for_us / HALT_S + braking_deg(joint, joint->dps)) {
            return true;
        }
    }
    return false;
}

void sequence_halt(grobo_joint_mask joints, int64_t soft_us, bool at_once)
{
    const halt_robot *of = halt.of;
    int64_t bound_us = of->frame_us + 10000;
    /* A KRS is told nothing before it has answered. */
    bound_us += of->far == &far_ics && halt.far.lose_reply != FAR_NEVER ? LOST_REPLY_US : 0;
    if (sequence.up && at_once && any_turns(bound_us)) {
        halt.far.first_left_us = FAR_NEVER;
        sequence.first_by_us = halt.now_us + bound_us;
    }
    sequence.wakes = false;
    sequence.soft_s = (double)soft_us / HALT_S;
    sequence.halted_us = halt.now_us + 1;
    halt.now_us++; /* behind what has left by now */
    for (int j = 0; j < of->n_joints; j++) {
        int servo = servo_of(j);
        sequence_joint *its = &sequence.joint[servo];
        const far_joint *joint = &halt.far.joint[servo];
        if ((joints & GROBO_JOINT_BIT(j)) == 0) {
            continue;
        }
        double at_deg = far_angle(&halt.far, servo, halt.now_us);
        if (its->licensed) {
            its->lo_deg = its->hi_deg = at_deg;
        }
        its->licensed = its->free = its->raw = false;
        widen(its, at_deg);
        widen(its, rest_deg(joint, sequence.soft_s));
        if (joint->waits) { /* its goal came just now */
            double goal_deg, ask_dps, accel_dps2;
            joint->family->plan(joint, &goal_deg, &ask_dps, &accel_dps2);
            note_on_the_line(joint, its, goal_deg, ask_dps);
        }
    }
    sequence.still_by_us = !sequence.up
                               ? 0
                               : halt.now_us + bound_us + 2 * of->reading_us + of->frame_us +
                                     soft_us + 2 * HALT_TIME_US + LOST_REPLY_US + of->far->dead_us;
}

/* What a joint tells shows what became of it. */
static void hear_out(void)
{
    for (int i = 0; i < halt.far.n_joints; i++) {
        int64_t told_us = halt.far.told_us[i];
        if (halt.far.joint[i].missed) {
            sequence.joint[i].missed_us = halt.now_us;
        }
        if (told_us != FAR_NEVER && told_us <= halt.now_us) {
            sequence.joint[i].unheard = false;
        }
    }
}

void sequence_disturbed(int servo, bool restarted, bool foreign)
{
    sequence_joint *its = &sequence.joint[servo];
    its->unheard = true;
    its->restarted = its->restarted || restarted;
    its->foreign = its->foreign || foreign;
    its->foreign_us = halt.now_us;
    note_place(&halt.far.joint[servo], its);
    if (foreign) { /* to where another program sends it */
        its->least_deg = fmin(its->least_deg, halt.far.joint[servo].goal_deg);
        its->most_deg = fmax(its->most_deg, halt.far.joint[servo].goal_deg);
    }
    halt.far.told_us[servo] = FAR_NEVER;
}

void sequence_away(int64_t us)
{
    hear_out();
    for (int i = 0; i < halt.far.n_joints; i++) { /* what it is told next was asked before */
        if (sequence.joint[i].foreign) {
            sequence_disturbed(i, false, true);
        }
    }
    sequence.first_by_us += sequence.first_by_us > 0 ? us : 0;
    sequence.still_by_us += sequence.still_by_us > 0 ? us : 0;
}

void sequence_latch(bool latched)
{
    sequence.latched = sequence.owed = latched;
    sequence.latched_us = halt.now_us;
    soften();
}

void sequence_line(bool up)
{
    if (!up) {
        sequence_halt(GROBO_JOINTS_ALL(halt.of->n_joints), 0, false);
        sequence.still_by_us = sequence.first_by_us = 0;
    } else {
        sequence.up_us = halt.now_us;
        soften();
        for (int i = 0; i < halt.far.n_joints; i++) {
            halt.far.told_us[i] = FAR_NEVER;
            if (far_turns(&halt.far, i, halt.now_us)) { /* from before: as if another moved it */
                sequence.joint[i].foreign = true;
                sequence.joint[i].foreign_us = halt.now_us;
            }
        }
    }
    sequence.up = up;
    if (up && sequence.owed) {
        sequence_halt(GROBO_JOINTS_ALL(halt.of->n_joints), 0, false);
    }
}

void sequence_asked(int number)
{
    if (number >= SEQUENCE_NUMBERS) {
        sequence_blame("a number too large", -1, number, SEQUENCE_NUMBERS);
    } else if (number > 0) {
        sequence.asked[number] = 1;
    }
}

/* ---- what time shows ------------------------------------------------------------------------- */

static bool is_late(int servo)
{
    const sequence_joint *its = &sequence.joint[servo];
    int64_t by_us = sequence.still_by_us;
    if (its->foreign) {
        by_us = grobo_i_later(by_us, its->foreign_us + FOREIGN_US) + FOREIGN_US;
    }
    if (halt.far.lost_us > 0 && halt.far.lost_frames > 0) { /* it is repeated once all are read */
        by_us = grobo_i_later(by_us, halt.far.lost_us) + HALT_TIME_US + halt.of->reading_us +
                halt.of->frame_us + LOST_REPLY_US;
    }
    return halt.now_us > by_us;
}

static void judge_stopped(int servo)
{
    const sequence_joint *its = &sequence.joint[servo];
    /* What a trip halts is what was read to turn by 8 deg/s, and not what lost its torque on its
     * way; an exit has its own verdict. */
    bool creeps = (its->foreign || its->restarted) && fabs(halt.far.joint[servo].dps) < CREEP_DPS;
    bool began = creeps || (its->foreign && its->foreign_us >= sequence.halted_us);
    if (!its->licensed && !began && turns(servo) && !is_lost(servo) && is_late(servo)) {
        sequence_blame("turns though it was stopped", servo, halt.far.joint[servo].dps, 0);
    }
}

void sequence_look(void)
{
    hear_out();
    if (sequence.first_by_us > 0 && halt.now_us > sequence.first_by_us) {
        int64_t left_us = halt.far.first_left_us;
        if (left_us == FAR_NEVER || left_us > sequence.first_by_us) {
            sequence_blame("the first frame of a stop is late", -1,
                           (double)(left_us - sequence.first_by_us) / HALT_MS, 0);
        }
        sequence.first_by_us = 0;
    }
    for (int i = 0; sequence.still_by_us > 0 && sequence.up && i < halt.far.n_joints; i++) {
        judge_stopped(i);
    }
}

void sequence_verdict(void)
{
    sequence_look();
    for (int n = 1; n < SEQUENCE_NUMBERS; n++) {
        if (sequence.asked[n] != sequence.ended[n] && sequence.asked[n] != 0) {
            sequence_blame("a job that never ends", -1, n, 0);
        }
    }
    if (sequence.owed) {
        sequence_blame("an emergency stop that was never carried out", -1, 1, 0);
    }
    if (grobo_robot_job(&halt.robot) != GROBO_JOB_NONE) {
        sequence_blame("a job is left", -1, grobo_robot_job(&halt.robot), 0);
    }
    for (int i = 0; i < halt.far.n_joints; i++) {
        if (turns(i) && !is_excused(i)) {
            sequence_blame("turns when all is over", i, halt.far.joint[i].dps, 0);
        }
    }
}
