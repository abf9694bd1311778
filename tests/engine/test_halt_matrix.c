/* SPDX-License-Identifier: MIT */
/*
 * Stops at every moment, judged by a far side that is not ours (tests/support/far_side.h).
 *
 * A cell is one stop: of one family, while a joint was brought on its way in one of six ways, by
 * one of ten ways to stop, at a moment from a second before it arrives to a second after, with
 * keys that hold or clips of some joints alone, on a clean line or with one lost frame. Cells that
 * share what comes before the stop share it: the world is kept at each moment, and goes on from
 * there once for each stop.
 *
 * Rules, by what the far side saw (tests/support/halt_kit.c):
 *   - no halt sends a joint further than its braking way and 2 degrees from where it is;
 *   - none comes to rest further away than that;
 *   - no goal asks for more than the joint's speed;
 *   - the first frame leaves within a frame on the line and 10 ms;
 *   - nothing moves once the stop is reported done.
 * A halt of a joint that missed a frame, and has not told since where it is, is excused, and
 * counted. A cell that fails prints the command that repeats it.
 *
 * Robots of 20 and 64 joints, other rates of the line and coupled joints are sampled; two servos on
 * one shaft come to rest at one place. These are stopped on a clean line alone: of a lost frame the
 * far side parts two shafts that are one in a robot.
 *
 * Half of the sample is run once more with joints that carry a weight (tests/support/far_weight.c):
 * a halt keeps the error that carries it, one at rest moves by less than 0.5 degrees or two steps,
 * and no weight is taken for a wall.
 *
 * Environment: GROBO_HALT=all runs every moment (make soak); GROBO_HALT_CELL="dxl2 keys stop 200
 * hold clean" one cell, and what the far side saw of it; GROBO_HALT_FAMILY one family.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/halt_kit.h"
#include "tests/support/next_random.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)
#define FROM_DEG (-60.0)
#define TO_DEG 60.0

/* The longest attempt of a reading whose reply is lost. */
#define LOST_REPLY_US 45000

/* Larger robots are looked at in one way alone: they take the longest. */
enum { LARGE_JOINTS = 20 };

enum {
    AWAY_US = 300000,
    STREAM_US = 20000,
    FOLLOW_US = 40000,
    TAIL_US = 1500000,
    SWINGS_US = 600000, /* a joint that carries a weight, behind the time of its trajectory */
    AROUND_MS = 1000,
    STEP_MS = 5
};

typedef enum way_in { KEYS, RATE, SEND, MOVE, RETARGET, FOLLOW, WAYS_IN } way_in;
typedef enum stop_kind {
    STOP,
    SMOOTH,
    CANCEL,
    PAUSE,
    ESTOP,
    EXIT,
    TRIP,
    GUARD,
    STALL,
    BREAK,
    STOPS
} stop_kind;
typedef enum clip_shape { HOLD, PARTIAL, SHAPES } clip_shape;
/* LOST: a frame or a reply behind the request. MISSED: a motor frame before it. */
typedef enum line_loss { CLEAN, LOST, MISSED, LOSSES } line_loss;

static const char *const way_names[] = {"keys", "rate", "send", "move", "retarget", "follow"};
static const char *const stop_names[] = {"stop", "smooth", "cancel", "pause", "estop",
                                         "exit", "trip",   "guard",  "stall", "break"};
static const char *const shape_names[] = {"hold", "partial"};
static const char *const loss_names[] = {"clean", "lost", "missed"};

typedef struct cell {
    int family;
    way_in way;
    stop_kind stop;
    int moment_ms;
    clip_shape shape;
    line_loss loss;
} cell;

static struct {
    unsigned long cells, failed, refused, excused, known;
    double worst_deg; /* by what a joint came to rest beside where it may */
    int told;
} sum;

/* ---- how a joint is brought on its way ------------------------------------------------------- */

static struct script {
    way_in way;
    clip_shape shape;
    int64_t begun_us, way_us, next_us;
    bool turned; /* the second target was given */
    bool breaks; /* its motion cannot be read on */
} script, kept_script;

static halt_world kept;

/* That it cannot be read is the request to stop. */
static int broken(void)
{
    if (!halt.judged) {
        halt_judge(0);
    }
    return GROBO_ERR_IO;
}

static int key_at(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    if (script.breaks) {
        return broken();
    }
    bool whole = script.shape == HOLD;
    *at_us = i == 0 ? 0 : i == 1 ? script.way_us : script.way_us + TAIL_US;
    *posture = halt_posture(i == 0 ? FROM_DEG : TO_DEG, 0, whole);
    if (!whole && i == 2) { /* another joint alone */
        posture->set = GROBO_JOINT_BIT(halt.of->other);
        posture->angle_rad[halt.of->moved] = 0;
        posture->angle_rad[halt.of->other] = RAD(20);
    } else if (!whole && i == 0) {
        posture->set |= GROBO_JOINT_BIT(halt.of->other);
    }
    posture->time_us = i == 0 ? 0 : i == 1 ? script.way_us : TAIL_US;
    return 0;
}

static double where(int64_t t_us)
{
    double part = fmin((double)t_us / (double)script.way_us, 1);
    return FROM_DEG + (TO_DEG - FROM_DEG) * fmax(part, 0);
}

static int sample_at(void *ctx, int64_t t_us, grobo_posture *posture)
{
    (void)ctx;
    if (script.breaks) {
        return broken();
    }
    bool whole = script.shape == HOLD;
    *posture = halt_posture(where(t_us), 0, whole);
    if (!whole) {
        double part = fmax((double)(t_us - script.way_us) / TAIL_US, 0);
        posture->set |= GROBO_JOINT_BIT(halt.of->other);
        posture->angle_rad[halt.of->other] = RAD(20 * part);
    }
    return 0;
}

static void begin_play(bool at_rate)
{
    const grobo_clip clip = {.key = key_at,
                             .sample = sample_at,
                             .length_us = script.way_us + TAIL_US,
                             .n_keys = HALT_KEYS,
                             .n_joints = halt.of->driver.model->n_joints};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT,
                                        .mode = at_rate ? GROBO_PLAY_RATE : GROBO_PLAY_KEY};
    assert_true(grobo_robot_play(&halt.robot, &clip, &options) > 0);
    for (int i = 0; i < 20000; i++) {
        if (grobo_robot_play_state(&halt.robot) == GROBO_SEQUENCER_PLAYING) {
            return;
        }
        halt_run(HALT_MS);
    }
    fail_msg("%s: the motion does not begin", halt.of->name);
}

static void ask_move(double deg, int64_t time_us)
{
    grobo_posture p = halt_posture(deg, time_us, script.shape == HOLD);
    int r = grobo_robot_move(&halt.robot, &p);
    if (r <= 0) {
        fail_msg("%s: move refused: %d", halt.of->name, r);
    }
}

static void set_out(const cell *c)
{
    halt_begin(halt_robot_of(c->family), FROM_DEG);
    script = (struct script){.way = c->way, .shape = c->shape};
    double dps = (c->shape == HOLD ? 200 : 110) * (halt_weighs ? 0.5 : 1);
    script.way_us = (int64_t)((TO_DEG - FROM_DEG) / dps * HALT_S);
    halt_run(500 * HALT_MS);
    if (c->way == KEYS || c->way == RATE) {
        begin_play(c->way == RATE);
    } else {
        halt_make_ready(FROM_DEG);
        if (c->way == MOVE) {
            ask_move(TO_DEG, script.way_us);
        } else if (c->way == RETARGET) {
            ask_move(0, script.way_us / 2);
        } else if (c->way == FOLLOW) {
            ask_move(where(FOLLOW_US), FOLLOW_US);
        }
    }
    script.begun_us = halt.now_us;
    script.next_us = halt.now_us + (c->way == FOLLOW ? FOLLOW_US : 0);
}

static void stream(int64_t period_us)
{
    int64_t t_us = halt.now_us - script.begun_us + period_us;
    grobo_posture p = halt_posture(where(t_us), period_us, script.shape == HOLD);
    if (script.way == SEND) {
        (void)grobo_robot_send(&halt.robot, &p);
    } else if (grobo_robot_retarget(&halt.robot, &p) == GROBO_ERR_STATE &&
               grobo_robot_job(&halt.robot) == GROBO_JOB_NONE) {
        (void)grobo_robot_move(&halt.robot, &p);
    }
    script.next_us += period_us;
}

/* Lets time pass while the script goes on. */
static void go_on(int64_t until_us)
{
    while (halt.now_us < until_us) {
        int64_t end_us = until_us;
        if (script.way == SEND || script.way == FOLLOW) {
            if (halt.now_us >= script.next_us) {
                stream(script.way == SEND ? STREAM_US : FOLLOW_US);
            }
            end_us = script.next_us < end_us ? script.next_us : end_us;
        } else if (script.way == RETARGET && !script.turned &&
                   halt.now_us >= script.begun_us + script.way_us / 4) {
            grobo_posture p = halt_posture(TO_DEG, script.way_us * 3 / 4, script.shape == HOLD);
            script.turned = grobo_robot_retarget(&halt.robot, &p) > 0;
            end_us = halt.now_us + HALT_MS < end_us ? halt.now_us + HALT_MS : end_us;
        } else if (script.way == RETARGET && !script.turned) {
            end_us = halt.now_us + HALT_MS < end_us ? halt.now_us + HALT_MS : end_us;
        }
        halt_run(end_us - halt.now_us);
    }
}

/* ---- how it is stopped ----------------------------------------------------------------------- */

/* What a program's guard does: its engine knows nothing, and the line is quiet first. */
static int guard_stops(void)
{
    static const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                              .sense_interval_us = GROBO_SENSE_NEVER};
    uint8_t dropped[FAR_FRAME_BYTES];
    int64_t until_us = halt.now_us + 10000 + far_wire_us(&halt.far, 444);
    while (halt.now_us < until_us) {
        (void)far_give(&halt.far, dropped, (int)sizeof dropped, halt.now_us);
        halt.now_us += HALT_MS;
    }
    halt_judge(0);
    halt_new_engine(&config);
    return grobo_robot_exit(&halt.robot, GROBO_EXIT_HOLD);
}

/* A servo is too hot: the stop is asked for when that was read. */
static int trip(int64_t soft_us)
{
    halt.far.joint[halt.of->driver.model->joints[halt.of->moved].motor - 1].celsius = 95;
    halt.trip_us = 0;
    halt.trip_soft_us = soft_us;
    halt.judges_trip = true;
    for (int i = 0; i < 3000 && halt.trip_us == 0; i++) {
        go_on(halt.now_us + HALT_MS);
    }
    return halt.trip_us > 0 ? GROBO_OK : GROBO_ERR_TIMEOUT;
}

/* The host was away for longer than a motion may be late: it ends, and what moves is halted. Where
 * no frame was due meanwhile, between keys, it goes on; and one whose last frame had left has come
 * to its end: no stops. */
static int stall(void)
{
    halt.now_us += AWAY_US;
    far_step(&halt.far, halt.now_us);
    bool played = grobo_robot_is_playing(&halt.robot);
    halt_judge(0);
    halt_run(0);
    bool ended = grobo_robot_play_state(&halt.robot) == GROBO_SEQUENCER_FINISHED;
    return played && !ended && !grobo_robot_is_playing(&halt.robot) ? 0 : GROBO_ERR_STATE;
}

/* The motion's file breaks where it is read next. */
static int break_off(void)
{
    script.breaks = grobo_robot_is_playing(&halt.robot);
    for (int i = 0; i < 200 && script.breaks && !halt.judged; i++) {
        halt_run(HALT_MS);
    }
    return halt.judged ? 0 : GROBO_ERR_STATE;
}

/* Number of the job that carries it out, 0 where there is none, or an error. */
static int ask_stop(stop_kind stop)
{
    int64_t soft_us = script.way == KEYS || script.way == RATE ? GROBO_PLAY_STOP_US : 0;
    switch (stop) {
    case STOP:
        halt_judge(0);
        return grobo_robot_stop(&halt.robot, true);
    case SMOOTH:
        halt_judge(soft_us);
        return grobo_robot_stop(&halt.robot, false);
    case CANCEL:
        halt_judge(0);
        return grobo_robot_cancel(&halt.robot);
    case PAUSE:
        halt_judge(soft_us);
        return grobo_robot_pause(&halt.robot);
    case ESTOP:
        halt_judge(0);
        return grobo_robot_estop(&halt.robot);
    case EXIT:
        halt_judge(soft_us);
        return grobo_robot_exit(&halt.robot, GROBO_EXIT_HOLD);
    case TRIP:
        return trip(soft_us);
    case GUARD:
        return guard_stops();
    case STALL:
        return stall();
    case BREAK:
        return break_off();
    case STOPS:
        break;
    }
    return GROBO_ERR_ARG;
}

/* A motion that pauses is still one: nothing says when its joints stand but the time it takes, by
 * what they were told where a lost frame takes them further. One whose pause is refused, as a joint
 * was read to be moved by others, has failed, and is stopped like any. */
static bool is_done(const cell *c, int job)
{
    if (c->stop == PAUSE && grobo_robot_play_state(&halt.robot) != GROBO_SEQUENCER_FAILED) {
        return halt.now_us >= halt.ends_us + (halt.weighs ? SWINGS_US : 0) &&
               grobo_robot_play_state(&halt.robot) == GROBO_SEQUENCER_PAUSED &&
               halt.now_us >= halt.asked_us + GROBO_PLAY_STOP_US + 2 * halt.of->frame_us + 10000;
    }
    return (job <= 0 || halt.over) && !grobo_robot_settling(&halt.robot) &&
           !grobo_robot_moving(&halt.robot);
}

/* Whoever knows nothing reads first; a reply that was lost costs it a time-out. So it does where
 * each frame of a motion is answered (KRS), but for an emergency stop, which waits for none. */
static int64_t bound_of(const cell *c)
{
    int64_t bound_us = halt.of->frame_us + 10000;
    bool waits = c->stop == GUARD || (halt.of->far == &far_ics && c->stop != ESTOP);
    int64_t lost_us = c->loss != CLEAN && waits ? LOST_REPLY_US : 0;
    /* An arm stands at the end of the last part of its way that it was told. */
    bound_us += c->stop == STALL && halt.of->driver.arm ? GROBO_SEGMENT_US : 0;
    return c->stop == GUARD ? bound_us + halt.of->reading_us + lost_us : bound_us + lost_us;
}

/* Of a way in segments, or of a stream, the next frame makes good what one did not do: the joint is
 * behind by what it would have gone until then. */
static double lag_deg(const cell *c)
{
    double dps = (TO_DEG - FROM_DEG) / (double)script.way_us * HALT_S;
    return dps * (GROBO_SEGMENT_RENEW_US + (c->way == FOLLOW ? FOLLOW_US : 0)) / HALT_S;
}

static bool stop_and_judge(const cell *c)
{
    halt.awaited = 0;
    halt.over = false;
    if (c->loss == LOST) { /* of what comes now: the first or second frame, or a reply */
        int which = (c->moment_ms + AROUND_MS) / STEP_MS % 3;
        halt.far.lose_motor = which < 2 ? which : FAR_NEVER;
        halt.far.lose_reply = which == 2 ? 0 : FAR_NEVER;
    }
    halt.streamed = c->way == RATE || c->way == SEND || c->way == FOLLOW;
    halt.blind = c->stop == GUARD;
    halt.lag_deg = c->loss == MISSED && halt.of->driver.arm ? lag_deg(c) : 0;
    int job = ask_stop(c->stop);
    if (job < 0) {
        sum.refused++;
        return true;
    }
    halt.awaited = job;
    for (int i = 0; i < 3000 && !is_done(c, job); i++) {
        halt_run(HALT_MS);
    }
    if (is_done(c, job)) {
        halt_done();
    }
    halt_run((halt_weighs ? 2000 : 600) * HALT_MS);
    halt_verdict(bound_of(c));
    sum.excused += (unsigned)halt.excused;
    sum.worst_deg = fmax(sum.worst_deg, halt.worst_deg);
    return halt.fault[0] == '\0';
}

/* ---- cells ----------------------------------------------------------------------------------- */

/* With a weight: cells of the sample that are known to break a rule (docs/guide/safety.md). */
static struct {
    const char *family, *rule;
    unsigned long may, are;
} known[] = {
    /* 309 deg/s of 300 allowed, for a way of 1.3 degrees. */
    {"dxl2", "faster than the joint may", 1, 0},
};
enum { KNOWN = sizeof known / sizeof known[0] };

/* @return whether it is one of those */
static bool is_known(const char *family, const char *fault)
{
    for (size_t i = 0; i < KNOWN; i++) {
        if (strcmp(known[i].family, family) == 0 &&
            strncmp(known[i].rule, fault, strlen(known[i].rule)) == 0) {
            return ++known[i].are <= known[i].may;
        }
    }
    return false;
}

enum { TOLD = 40 }; /* of the cells that fail; GROBO_HALT_TOLD=1: all */

static void judge_cell(const cell *c)
{
    bool told = getenv("GROBO_HALT_TOLD") != NULL;
    sum.cells++;
    if (stop_and_judge(c)) {
        return;
    }
    if (halt_weighs && is_known(halt.of->name, halt.fault)) {
        sum.known++;
    } else {
        sum.failed++;
    }
    if (told || sum.told++ < TOLD) {
        print_message("GROBO_HALT_CELL=\"%s %s %s %d %s %s\""
                      " build/tests/engine/test_halt_matrix # %s\n",
                      halt.of->name, way_names[c->way], stop_names[c->stop], c->moment_ms,
                      shape_names[c->shape], loss_names[c->loss], halt.fault);
    }
}

/* When the joint arrives, by the far side, counted from the script's begin. */
static int64_t arrival_us(const cell *c)
{
    set_out(c);
    int moved = halt.of->driver.model->joints[halt.of->moved].motor - 1;
    for (int i = 0; i < 5000; i++) {
        go_on(halt.now_us + HALT_MS);
        (void)far_angle(&halt.far, moved, halt.now_us);
        if (fabs(halt.far.joint[moved].set_deg - TO_DEG) < (halt_weighs ? 4 : 0.5) &&
            halt.far.joint[moved].set_dps == 0) {
            return halt.now_us - script.begun_us;
        }
    }
    const far_joint *joint = &halt.far.joint[moved];
    fail_msg("%s %s %s: it does not arrive: at %.2f, goal %.2f, trip %d, state %d", halt.of->name,
             way_names[c->way], shape_names[c->shape], joint->at_deg, joint->goal_deg,
             (int)halt.trip, (int)grobo_robot_play_state(&halt.robot));
    return 0;
}

typedef bool (*chooser)(const cell *c, void *ctx);

/* Of what is sent before the stop the first motor frame of the way is lost, or a later one where
 * there are many. */
static void lose_before(const cell *c)
{
    bool many = c->way == RATE || c->way == SEND || c->way == FOLLOW;
    halt.far.lose_motor = many ? 5 : 0;
}

static void run_moments(cell c, int64_t arrives_us, chooser chosen, void *ctx)
{
    set_out(&c);
    if (c.loss == MISSED) {
        lose_before(&c);
    }
    for (c.moment_ms = -AROUND_MS; c.moment_ms <= AROUND_MS; c.moment_ms += STEP_MS) {
        int64_t at_us = script.begun_us + arrives_us + c.moment_ms * (int64_t)HALT_MS;
        if (at_us < halt.now_us) {
            continue;
        }
        go_on(at_us);
        kept = halt;
        kept_script = script;
        for (c.stop = STOP; c.stop < STOPS; c.stop++) {
            if (chosen(&c, ctx)) {
                judge_cell(&c);
                halt = kept;
                script = kept_script;
            }
        }
    }
}

static void run_way(int family, way_in way, clip_shape shape, chooser chosen, void *ctx)
{
    cell c = {.family = family, .way = way, .shape = shape};
    if (way == RATE && halt_robot_of(family)->no_rate) {
        return;
    }
    int64_t arrives_us = arrival_us(&c);
    line_loss losses = halt_is_paired(halt_robot_of(family)) ? LOST : LOSSES;
    for (c.loss = CLEAN; c.loss < losses; c.loss++) {
        run_moments(c, arrives_us, chosen, ctx);
    }
}

static void run_family(int family, chooser chosen, void *ctx)
{
    for (way_in way = KEYS; way < WAYS_IN; way++) {
        for (clip_shape shape = HOLD; shape < SHAPES; shape++) {
            run_way(family, way, shape, chosen, ctx);
        }
    }
}

static int named(const char *const *names, int n, const char *name)
{
    for (int i = 0; i < n; i++) {
        if (strcmp(names[i], name) == 0) {
            return i;
        }
    }
    fail_msg("no such name: %s", name);
    return 0;
}

static bool same_cell(const cell *c, void *ctx)
{
    const cell *other = ctx;
    return c->stop == other->stop && c->moment_ms == other->moment_ms;
}

static void run_one(const char *text)
{
    char family[16], way[16], stop[16], shape_name[16], loss_name[16];
    cell c = {0};
    int n = sscanf(text, "%15s %15s %15s %d %15s %15s", family, way, stop, &c.moment_ms, shape_name,
                   loss_name);
    assert_int_equal(n, 6);
    while (strcmp(halt_robot_of(c.family)->name, family) != 0) {
        c.family++;
    }
    c.way = (way_in)named(way_names, WAYS_IN, way);
    c.stop = (stop_kind)named(stop_names, STOPS, stop);
    c.shape = (clip_shape)named(shape_names, SHAPES, shape_name);
    c.loss = (line_loss)named(loss_names, LOSSES, loss_name);
    cell wanted = c;
    halt_traced = getenv("GROBO_HALT_CELL") != NULL;
    run_moments(c, arrival_us(&c), same_cell, &wanted);
}

static bool every(const cell *c, void *ctx)
{
    (void)c;
    (void)ctx;
    return true;
}

/* Around arrival in steps of 50 ms, and some others by chance. */
static bool some(const cell *c, void *ctx)
{
    uint32_t *seed = ctx;
    bool lucky = next_random(seed) % 200 == 0;
    return lucky || (c->loss == CLEAN && c->moment_ms % 50 == 0 && abs(c->moment_ms) <= 300);
}

static bool half(const cell *c, void *ctx)
{
    return some(c, ctx) && (c->moment_ms + AROUND_MS) / (2 * STEP_MS) % 2 == 0;
}

/* Of larger robots and other rates. */
static bool few(const cell *c, void *ctx)
{
    (void)c;
    return next_random(ctx) % 100 == 0;
}

static bool fifth(const cell *c, void *ctx)
{
    (void)ctx;
    return c->moment_ms % (5 * STEP_MS) == 0;
}

/* A small robot of each family in all ways. A larger one, or one at another rate, in one way that
 * goes by its number; where all is asked for, one of up to 20 joints in all ways, every 25 ms. */
static void run_robot(int i, bool all, uint32_t *seed)
{
    unsigned long before = sum.failed, cells = sum.cells;
    if (i < HALT_FAMILIES) {
        run_family(i, all ? every : some, seed);
    } else if (all && halt_robot_of(i)->n_joints <= LARGE_JOINTS) {
        run_family(i, fifth, seed);
    } else {
        run_way(i, (way_in)((i + 1) % WAYS_IN), (clip_shape)(i / WAYS_IN % SHAPES), few, seed);
    }
    print_message("%s: %lu of %lu stops broke a rule\n", halt_robot_of(i)->name,
                  sum.failed - before, sum.cells - cells);
}

static bool is_set(const char *text)
{
    return text != NULL && *text != '\0';
}

static void tell_known(void)
{
    for (size_t i = 0; i < KNOWN; i++) {
        print_message("known: %s, %s: %lu, %lu at most\n", known[i].family, known[i].rule,
                      known[i].are, known[i].may);
        known[i].are = 0;
    }
}

/* Half of the sample, of robots whose joints carry a weight. */
TEST(stops_of_joints_that_carry_weight_neither_dip_nor_throw)
{
    const char *one = getenv("GROBO_HALT_CELL"), *family = getenv("GROBO_HALT_FAMILY");
    bool all = is_set(getenv("GROBO_HALT"));
    halt_weighs = true;
    memset(&sum, 0, sizeof sum);
    if (one != NULL) {
        run_one(one);
    }
    for (int i = 0; one == NULL && i < HALT_FAMILIES; i++) {
        const char *name = halt_robot_of(i)->name;
        unsigned long before = sum.failed, excused = sum.known;
        uint32_t seed = (uint32_t)(33 + i);
        if (is_set(family) && strcmp(name, family) != 0) {
            continue;
        }
        sum.worst_deg = 0;
        run_family(i, all ? fifth : half, &seed);
        print_message("%s, with weight: %lu broke a rule, %lu as is known, %.1f deg at most\n",
                      name, sum.failed - before, sum.known - excused, sum.worst_deg);
    }
    tell_known();
    print_message("with weight: %lu stops, %lu refused, %lu excused, %lu known, "
                  "%lu broke a rule\n",
                  sum.cells, sum.refused, sum.excused, sum.known, sum.failed);
    assert_int_equal(sum.failed, 0);
}

TEST(stops_throw_no_joint)
{
    halt_weighs = false;
    const char *one = getenv("GROBO_HALT_CELL"), *family = getenv("GROBO_HALT_FAMILY");
    bool all = is_set(getenv("GROBO_HALT"));
    uint32_t seed = 29;
    memset(&sum, 0, sizeof sum);
    if (one != NULL) {
        run_one(one);
    }
    for (int i = 0; one == NULL && halt_robot_of(i) != NULL; i++) {
        if (!is_set(family) || strcmp(halt_robot_of(i)->name, family) == 0) {
            run_robot(i, all, &seed);
        }
    }
    print_message("%lu stops, %lu refused, %lu excused, %lu broke a rule\n", sum.cells, sum.refused,
                  sum.excused, sum.failed);
    assert_int_equal(sum.failed, 0);
}

/* Stops that broke a rule once, and that the sample above does not have. */
TEST(stops_that_broke_a_rule_break_none_any_more)
{
    /* First: a mean speed between two angles 0.2 s apart was taken for one of a joint that had
     * arrived where its servo had said that it goes. */
    static const char *const cells[] = {
        "lx16a-20 move guard -150 hold lost",
        /* Read once, at 5 deg/s, a joint was neither taken to move nor looked at again. */
        "sts-38400 send guard -100 hold clean", "sts-38400 send guard -100 hold missed",
        /* Its halt was lost and had the goal of before, at which the joint crept on: to read that
         * goal was taken for the halt. */
        "sts-38400 send trip -125 hold lost",
        /* It passed the goal of its halt, was read there, and turned back. */
        "sts-38400 retarget stop -450 hold lost",
        /* A motion named one of two servos on a shaft: the other one was halted beside it. */
        "lx16a-pairs keys smooth -1000 partial clean", "lx16a-pairs keys pause -1000 partial clean",
        "lx16a-pairs rate exit -75 partial clean",
        /* Halted alone, one braked further than the other one had turned. */
        "mx-pairs follow guard -575 hold clean",
        /* A stop behind a lost key was timed from where the joint should have been. */
        "board keys stop -420 hold missed", "bus keys stop -410 hold missed",
        /* Behind a stalled host nobody looked at a joint that was behind its segment and went on to
         * the end of it. */
        "pro-115200 keys stall -925 hold missed"};

    if (getenv("GROBO_HALT_CELL") != NULL) {
        skip();
    }
    halt_weighs = false;
    memset(&sum, 0, sizeof sum);
    for (size_t i = 0; i < sizeof cells / sizeof cells[0]; i++) {
        run_one(cells[i]);
    }
    assert_int_equal(sum.cells, sizeof cells / sizeof cells[0]);
    assert_int_equal(sum.failed, 0);
}

/* The same of joints that carry a weight. */
TEST(stops_of_weight_that_broke_a_rule_break_none_any_more)
{
    /* First: a joint that sank from its halt was halted where it was, again and again. */
    static const char *const cells[] = {
        "bus keys guard 100 hold clean", "ics keys estop -750 hold clean",
        /* The mean speed of one that swings in its goal was taken for that of one that goes on. */
        "ics move exit -400 hold lost", "lx16a move estop -820 hold lost"};

    if (getenv("GROBO_HALT_CELL") != NULL) {
        skip();
    }
    halt_weighs = true;
    memset(&sum, 0, sizeof sum);
    for (size_t i = 0; i < sizeof cells / sizeof cells[0]; i++) {
        run_one(cells[i]);
    }
    halt_weighs = false;
    assert_int_equal(sum.cells, sizeof cells / sizeof cells[0]);
    assert_int_equal(sum.failed, 0);
}
