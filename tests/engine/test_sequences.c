/* SPDX-License-Identifier: MIT */
/*
 * All sequences of requests and of what happens on a line, in virtual time, for every family. The
 * judge (tests/support/sequence_judge.h) reads the frames by the protocols' texts.
 *
 * A sequence begins with a robot that was just linked and is limp, or with one that holds; each of
 * its events is followed by 25 ms, or by 3 ms. Behind the last one the line is there again and
 * nothing happens for 0.6 s; then the robot is left, and all is over. Sequences that come to the
 * same state go on as one: what may be asked of the engine, the steps of its jobs, and the far
 * side's joints (angles to 2 degrees), hashed.
 *
 * `make check` runs some by chance. GROBO_SEQUENCES=3 runs all of 3 events (make check-sequences);
 * GROBO_SEQUENCE="dxl2 holds 25 move estop reset move" one, and what the far side saw of it;
 * GROBO_HALT_FAMILY one family. It ends with the first sequence that breaks a rule; with
 * GROBO_SEQUENCES_ALL=1 it goes on.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/next_random.h"
#include "tests/support/sequence_judge.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)
#define FROM_DEG (-20.0)

enum {
    DEPTH_MAX = 6,
    CLIP_US = 700 * HALT_MS,
    QUIET_US = 600 * HALT_MS,
    EXIT_US = 10600 * HALT_MS,
    LATE_US = 8 * HALT_MS,
    LONG_US = 300 * HALT_MS,
    TOLD = 20
};

typedef struct event {
    const char *name;
    void (*happen)(void);
} event;

static grobo_joint_mask all(void)
{
    return GROBO_JOINTS_ALL(halt.of->n_joints);
}

static grobo_joint_mask moved(void)
{
    return GROBO_JOINT_BIT(halt.of->moved);
}

static grobo_joint_mask other(void)
{
    return GROBO_JOINT_BIT(halt.of->other);
}

static int servo_of(int joint)
{
    return halt.of->driver.model->joints[joint].motor - 1;
}

static bool is_set(const char *text)
{
    return text != NULL && *text != '\0';
}

/* ---- requests -------------------------------------------------------------------------------- */

static int asked(int number)
{
    sequence_asked(number);
    return number;
}

static void move_to(double deg, int64_t time_us, bool whole)
{
    grobo_posture p = halt_posture(deg, time_us, whole);
    if (asked(grobo_robot_move(&halt.robot, &p)) > 0) {
        sequence_license(p.set, fmin(deg, whole ? 0 : deg), fmax(deg, whole ? 0 : deg));
    }
}

static void move_one(void)
{
    move_to(40, 300 * HALT_MS, false);
}

static void move_all(void)
{
    move_to(-45, 400 * HALT_MS, true);
}

static void move_other(void)
{
    grobo_posture p = halt_posture(0, 300 * HALT_MS, false);
    p.set = other();
    p.angle_rad[halt.of->other] = RAD(30);
    if (asked(grobo_robot_move(&halt.robot, &p)) > 0) {
        sequence_license(p.set, 30, 30);
    }
}

static void retarget(void)
{
    grobo_posture p = halt_posture(-30, 300 * HALT_MS, true);
    if (asked(grobo_robot_retarget(&halt.robot, &p)) > 0) {
        sequence_license(p.set, -30, 0);
    }
}

static void send_one(void)
{
    grobo_posture p = halt_posture(10, 100 * HALT_MS, false);
    if (grobo_robot_send(&halt.robot, &p) >= 0) {
        sequence_license(p.set, 10, 10);
    }
}

static int key_at(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    *posture = halt_posture(i == 0 ? -10 : 35, i == 0 ? 0 : CLIP_US, true);
    *at_us = (int64_t)i * CLIP_US;
    return 0;
}

static grobo_clip clip(void)
{
    return (grobo_clip){.key = key_at,
                        .length_us = CLIP_US,
                        .n_keys = 2,
                        .n_joints = halt.of->driver.model->n_joints};
}

static void play(void)
{
    const grobo_clip its = clip();
    if (asked(grobo_robot_play(&halt.robot, &its, NULL)) > 0) {
        sequence_license(all(), -10, 35);
    }
}

static void enqueue(void)
{
    const grobo_clip its = clip();
    if (grobo_robot_enqueue(&halt.robot, &its, NULL) >= 0) {
        sequence_license(all(), -10, 35);
    }
}

static void pause_it(void)
{
    if (grobo_robot_pause(&halt.robot) >= 0) {
        sequence_halt(all() & ~sequence_raw_waits(), GROBO_PLAY_STOP_US, false);
    }
}

static void resume(void)
{
    if (grobo_robot_resume(&halt.robot) >= 0) {
        sequence_license(all(), -10, 35);
    }
}

/* A motion that is played comes to rest evenly. */
static int64_t soft_us(void)
{
    return grobo_robot_is_playing(&halt.robot) ? GROBO_PLAY_STOP_US : 0;
}

/* A stop is for what moves: torque that was asked for comes on all the same, and a joint in free
 * mode stays in it. */
static void stop_motion(bool at_once)
{
    bool wakes = sequence.wakes, free = sequence.joint[servo_of(halt.of->other)].free;
    sequence_halt(all(), at_once ? 0 : soft_us(), at_once);
    sequence.wakes = wakes;
    sequence.joint[servo_of(halt.of->other)].free = free;
    (void)grobo_robot_stop(&halt.robot, at_once);
}

static void stop(void)
{
    stop_motion(true);
}

static void stop_softly(void)
{
    stop_motion(false);
}

static void cancel(void)
{
    bool moves = grobo_robot_job(&halt.robot) == GROBO_JOB_MOVE ||
                 grobo_robot_job(&halt.robot) == GROBO_JOB_PLAY;
    int64_t rest_us = soft_us();
    if (grobo_robot_cancel(&halt.robot) >= 0 && moves) {
        sequence_halt(all(), rest_us, rest_us == 0);
    }
}

static void estop(void)
{
    bool running = grobo_robot_job(&halt.robot) == GROBO_JOB_ESTOP;
    sequence_halt(all(), 0, !running);
    sequence_latch(true);
    (void)asked(grobo_robot_estop(&halt.robot));
}

static void reset(void)
{
    if (grobo_robot_reset(&halt.robot) >= 0 && sequence.latched) {
        sequence_latch(false);
    }
}

static void torque_on(void)
{
    if (asked(grobo_robot_torque(&halt.robot, all(), GROBO_TORQUE_ON)) > 0) {
        sequence.wakes = true;
        sequence_license_here(all());
    }
}

static void torque_off(void)
{
    (void)asked(grobo_robot_torque(&halt.robot, other(), GROBO_TORQUE_OFF));
}

static void leave_by(grobo_exit_policy policy)
{
    sequence_halt(all(), soft_us(), false);
    int number = asked(grobo_robot_exit(&halt.robot, policy));
    sequence.exits_off = number > 0 && policy == GROBO_EXIT_OFF ? number : sequence.exits_off;
}

static void exit_hold(void)
{
    leave_by(GROBO_EXIT_HOLD);
}

static void exit_off(void)
{
    leave_by(GROBO_EXIT_OFF);
}

static void sense(void)
{
    (void)asked(grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_ALL));
}

static void free_other(void)
{
    if (grobo_robot_free(&halt.robot, other(), true) >= 0) {
        sequence.joint[servo_of(halt.of->other)].free = true;
        sequence_license_here(other());
    }
}

static void free_end(void)
{
    if (asked(grobo_robot_free(&halt.robot, other(), false)) > 0) {
        sequence.wakes = true;
        sequence_license_here(other());
    }
}

/* A goal of the caller's own, in as many frames as the family needs. */
static void raw(void)
{
    grobo_exchange exchange;
    grobo_target target;
    memset(&exchange, 0, sizeof exchange);
    memset(&target, 0, sizeof target);
    target.posture = halt_posture(-5, HALT_S, false);
    target.joint_time_us[halt.of->moved] = HALT_S;
    for (int part = 0; part < 2; part++) {
        if (halt.of->driver.posture(&halt.of->driver, NULL, &target, part, &exchange) != 1) {
            break;
        }
        if (asked(grobo_robot_raw(&halt.robot, exchange.frame, exchange.frame_bytes)) > 0) {
            sequence.joint[servo_of(halt.of->moved)].soft = false;
            sequence_license_raw(moved(), -5);
        }
    }
}

/* ---- what happens on the line ---------------------------------------------------------------- */

static void frame_lost(void)
{
    halt.far.lose_motor = 0;
}

static void reply_lost(void)
{
    halt.far.lose_reply = 0;
}

static void reply_late(void)
{
    halt.far.late_us = LATE_US;
}

static void link_down(void)
{
    if (sequence.up) {
        sequence_line(false);
        grobo_robot_link_down(&halt.robot, halt.now_us);
    }
}

static void link_up(void)
{
    if (!sequence.up) {
        halt.far.n_replies = halt.far.n_in = 0;
        sequence_line(true);
        grobo_robot_link_up(&halt.robot, halt.now_us);
    }
}

/* Its supply is back: it is limp, where it is. */
static void servo_reset(void)
{
    int servo = servo_of(halt.of->moved);
    far_put(&halt.far, servo, far_angle(&halt.far, servo, halt.now_us), false, halt.now_us);
    sequence_disturbed(servo, true, false);
}

/* A hand turns a joint that does not hold. */
static void hand(void)
{
    int servo = servo_of(halt.of->other);
    double deg = far_angle(&halt.far, servo, halt.now_us);
    if (halt.far.joint[servo].torque != 1) {
        far_put(&halt.far, servo, deg > 20 ? deg - 25 : deg + 25, false, halt.now_us);
        sequence_disturbed(servo, false, false);
    }
}

static void others_move(void)
{
    int servo = servo_of(halt.of->other);
    far_foreign(&halt.far, servo, 40, 60, halt.now_us);
    sequence_disturbed(servo, false, true);
}

static void hot(void)
{
    halt.far.joint[servo_of(halt.of->moved)].celsius = 95;
    sequence.hot_us = halt.now_us;
}

static void stall(void)
{
    halt.now_us += LONG_US;
    far_step(&halt.far, halt.now_us);
    sequence_away(LONG_US);
}

static void later(void)
{
    halt_run(LONG_US);
}

static const event events[] = {
    {"move", move_one},
    {"move-all", move_all},
    {"move-other", move_other},
    {"retarget", retarget},
    {"send", send_one},
    {"play", play},
    {"enqueue", enqueue},
    {"pause", pause_it},
    {"resume", resume},
    {"stop", stop},
    {"stop-softly", stop_softly},
    {"cancel", cancel},
    {"estop", estop},
    {"reset", reset},
    {"torque-on", torque_on},
    {"torque-off", torque_off},
    {"exit-hold", exit_hold},
    {"exit-off", exit_off},
    {"sense", sense},
    {"free", free_other},
    {"free-end", free_end},
    {"raw", raw},
    {"frame-lost", frame_lost},
    {"reply-lost", reply_lost},
    {"reply-late", reply_late},
    {"link-down", link_down},
    {"link-up", link_up},
    {"servo-reset", servo_reset},
    {"hand", hand},
    {"others-move", others_move},
    {"hot", hot},
    {"stall", stall},
    {"later", later},
};
enum { EVENTS = sizeof events / sizeof events[0] };

/* ---- states ---------------------------------------------------------------------------------- */

typedef struct world {
    halt_world halt;
    sequence_judge judge;
} world;

static void keep(world *to)
{
    to->halt = halt;
    to->judge = sequence;
}

static void go_back(const world *to)
{
    halt = to->halt;
    sequence = to->judge;
}

static uint64_t hash;

static void mix(int64_t value)
{
    hash = (hash ^ (uint64_t)value) * UINT64_C(0x9E3779B97F4A7C15);
    hash ^= hash >> 29;
}

static void mix_deg(double deg)
{
    mix((int64_t)floor(deg / 2));
}

static void mix_joint(int j)
{
    const far_joint *far = &halt.far.joint[servo_of(j)];
    const sequence_joint *its = &sequence.joint[servo_of(j)];
    grobo_joint_info info;
    (void)grobo_robot_joint(&halt.robot, j, &info);
    mix(info.status);
    mix(info.has_target | info.torque_known << 1 | info.stands << 2);
    mix((int64_t)info.state.torque);
    mix((int64_t)info.state.valid);
    mix(halt.robot.axes[j].phase);
    mix_deg(info.state.angle_rad * 57.3);
    mix_deg(info.target_rad * 57.3);
    mix(far->torque | far->waits << 2 | far->missed << 3 | far->leaps << 4);
    mix_deg(far->at_deg);
    mix_deg(far->goal_deg);
    mix_deg(far->dps / 10);
    mix(its->licensed | its->unheard << 1 | its->foreign << 2);
}

/* What may be asked of the engine, the steps of its jobs, and what the far side knows. */
static uint64_t state_hash(void)
{
    const grobo_robot *robot = &halt.robot;
    grobo_trip_info trip;
    hash = UINT64_C(1469598103934665603);
    grobo_robot_tripped(robot, &trip);
    mix(trip.trip);
    mix(trip.latched);
    mix(grobo_robot_play_state(robot));
    mix(grobo_robot_moving(robot) | grobo_robot_settling(robot) << 1);
    mix(grobo_robot_is_quiet(robot) | grobo_robot_is_playing(robot) << 1 | sequence.up << 2);
    for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
        mix(robot->jobs[i].kind);
        mix(robot->jobs[i].at);
        mix((int64_t)robot->jobs[i].joints);
    }
    mix(robot->queued);
    mix((int64_t)(robot->halts_owed ^ robot->free_joints << 20 ^ robot->played_joints << 40));
    mix(robot->stop_owed);
    mix(halt.far.n_frames << 8 | halt.far.n_replies);
    mix(halt.far.lose_motor + 2 * halt.far.lose_reply + 8 * (halt.far.late_us > 0));
    mix(sequence.hot_us > 0);
    for (int j = 0; j < halt.of->n_joints; j++) {
        mix_joint(j);
    }
    return hash == 0 ? 1 : hash;
}

/* States that were met, each with how many events could follow. */
static struct {
    uint64_t *hash;
    uint8_t *left;
    size_t room, n;
} met;

static void forget_states(size_t room)
{
    free(met.hash);
    free(met.left);
    met.hash = calloc(room, sizeof *met.hash);
    met.left = calloc(room, sizeof *met.left);
    assert_non_null(met.hash);
    assert_non_null(met.left);
    met.room = room;
    met.n = 0;
}

typedef enum meeting { KNOWN, DEEPER, NEW } meeting;

static meeting meet(uint64_t its, int left)
{
    size_t at = (size_t)its % met.room;
    while (met.hash[at] != 0 && met.hash[at] != its) {
        at = (at + 1) % met.room;
    }
    if (met.hash[at] == its) {
        bool deeper = met.left[at] < left;
        met.left[at] = deeper ? (uint8_t)left : met.left[at];
        return deeper ? DEEPER : KNOWN;
    }
    assert_true(met.n < met.room / 4 * 3);
    met.hash[at] = its;
    met.left[at] = (uint8_t)left;
    met.n++;
    return NEW;
}

/* ---- sequences ------------------------------------------------------------------------------- */

typedef struct root {
    const char *name;
    bool holds;
    int64_t gap_us;
} root;

static const root roots[] = {
    {"limp 25", false, 25 * HALT_MS},
    {"holds 25", true, 25 * HALT_MS},
    {"holds 3", true, 3 * HALT_MS},
};
enum { ROOTS = sizeof roots / sizeof roots[0] };

static const root *begun;
static int path[DEPTH_MAX], path_n;
static struct {
    unsigned long sequences, states, failed, told, excused[SEQUENCE_EXCUSES], goals;
} sum;

static halt_robot small[HALT_FAMILIES];

/* Three joints of a family: those of GR001 differ from each other. */
static const halt_robot *robot_of(int family)
{
    halt_robot *robot = &small[family];
    const halt_robot *whole = halt_robot_of(family);
    if (whole->n_joints <= 3) {
        return whole;
    }
    halt_robot_make(robot, whole->name, 3, whole->baud_bps);
    robot->moved = 0;
    robot->other = 2;
    return robot;
}

static void set_out(int family, const root *from)
{
    halt_begin(robot_of(family), FROM_DEG);
    halt_run(500 * HALT_MS);
    if (from->holds) {
        halt_make_ready(FROM_DEG);
        halt_run(HALT_S);
    }
    sequence_begin();
    begun = from;
    path_n = 0;
}

static void tell(void)
{
    sum.failed++;
    if (sum.told++ >= TOLD) {
        return;
    }
    print_message("GROBO_SEQUENCE=\"%s %s", halt.of->name, begun->name);
    for (int i = 0; i < path_n; i++) {
        print_message(" %s", events[path[i]].name);
    }
    print_message("\" build/tests/engine/test_sequences # %s\n", sequence.fault);
}

/* Time passes in parts: what must be over by then is looked at in each. */
static void pass(int64_t us)
{
    for (int64_t end_us = halt.now_us + us; halt.now_us < end_us;) {
        int64_t left_us = end_us - halt.now_us;
        halt_run(left_us < 100 * HALT_MS ? left_us : 100 * HALT_MS);
        sequence_look();
    }
}

static void step(int what)
{
    path[path_n++] = what;
    if (halt_traced) {
        printf("%9.3f ms %s\n", (double)(halt.now_us - halt.asked_us) / HALT_MS, events[what].name);
    }
    events[what].happen();
    pass(begun->gap_us);
}

/* The line is there again and nothing happens; then the robot is left. */
static void end(void)
{
    link_up();
    pass(QUIET_US);
    for (int64_t by_us = halt.now_us + EXIT_US;
         grobo_robot_job(&halt.robot) == GROBO_JOB_ESTOP && halt.now_us < by_us;) {
        pass(100 * HALT_MS);
    }
    sequence_halt(all(), soft_us(), false);
    int number = asked(grobo_robot_exit(&halt.robot, GROBO_EXIT_HOLD));
    (void)halt_wait(number, EXIT_US);
    if (number > 0 && !halt.over) {
        sequence_blame("an exit does not end", -1, number, 0);
    }
    pass(100 * HALT_MS);
    sequence_verdict();
    sum.sequences++;
    for (int i = 0; i < SEQUENCE_EXCUSES; i++) {
        sum.excused[i] += (unsigned long)sequence.excused[i];
    }
    sum.goals += (unsigned long)sequence.goals;
    if (sequence.fault[0] != '\0') {
        tell();
    }
}

static world kept[DEPTH_MAX + 1], before_end;

/* All sequences that go on from here with at most so many events. */
static void explore(int left)
{
    world *here = &kept[left];
    keep(here);
    int n = path_n;
    for (int i = 0; i < EVENTS && (sum.failed == 0 || is_set(getenv("GROBO_SEQUENCES_ALL"))); i++) {
        go_back(here);
        path_n = n;
        step(i);
        if (sequence.fault[0] != '\0') {
            tell();
            continue;
        }
        meeting how = meet(state_hash(), left - 1);
        if (how == NEW) {
            keep(&before_end);
            end();
            go_back(&before_end);
        }
        if (how != KNOWN && left > 1) {
            explore(left - 1);
        }
    }
    path_n = n;
}

static bool is_chosen(int family)
{
    const char *name = getenv("GROBO_HALT_FAMILY");
    return !is_set(name) || strcmp(name, halt_robot_of(family)->name) == 0;
}

static void run_all(int depth)
{
    for (int family = 0; family < HALT_FAMILIES; family++) {
        if (!is_chosen(family)) {
            continue;
        }
        unsigned long sequences = sum.sequences, failed = sum.failed;
        size_t states = 0;
        for (int i = 0; i < ROOTS; i++) {
            forget_states((size_t)1 << 22);
            set_out(family, &roots[i]);
            explore(depth);
            states += met.n;
        }
        sum.states += states;
        print_message("%s: %zu states, %lu ends, %lu broke a rule\n", halt_robot_of(family)->name,
                      states, sum.sequences - sequences, sum.failed - failed);
    }
    forget_states(1);
}

static void run_some(unsigned n, uint32_t *seed)
{
    for (unsigned k = 0; k < n; k++) {
        for (int family = 0; family < HALT_FAMILIES; family++) {
            if (is_chosen(family)) {
                set_out(family, &roots[next_random(seed) % ROOTS]);
                for (int i = 0; i < 4 && sequence.fault[0] == '\0'; i++) {
                    step((int)(next_random(seed) % EVENTS));
                }
                end();
            }
        }
    }
}

/* The next word of a text, and what is behind it. */
static const char *word_of(const char *text, char word[32])
{
    int n = 0;
    word[0] = '\0';
    return sscanf(text, "%31s%n", word, &n) == 1 ? text + n : text;
}

static const root *root_of(const char *name, const char *gap)
{
    char whole[65];
    (void)snprintf(whole, sizeof whole, "%s %s", name, gap);
    for (int i = 0; i < ROOTS; i++) {
        if (strcmp(roots[i].name, whole) == 0) {
            return &roots[i];
        }
    }
    fail_msg("no such begin: %s", whole);
    return NULL;
}

static int event_of(const char *name)
{
    int i = 0;
    while (i < EVENTS && strcmp(events[i].name, name) != 0) {
        i++;
    }
    assert_true(i < EVENTS);
    return i;
}

static void run_one(const char *text, bool traced)
{
    char family[32], name[32], gap[32], word[32];
    int number = 0;
    text = word_of(word_of(word_of(text, family), name), gap);
    while (strcmp(halt_robot_of(number)->name, family) != 0) {
        number++;
    }
    set_out(number, root_of(name, gap));
    halt_traced = halt.judged = traced;
    halt.asked_us = halt.now_us;
    for (text = word_of(text, word); word[0] != '\0'; text = word_of(text, word)) {
        step(event_of(word));
    }
    end();
}

/* Sequences that broke a rule once. */
static const char *const mended[] = {
    "sts limp 25 move move reply-late stop",
    "sts limp 25 move sense reply-late estop",
    "sts limp 25 play raw reply-late pause",
    "sts holds 25 move stall play pause",
    "mx holds 25 send stall play raw",
    "sts limp 25 play others-move raw stall",
    "sts holds 3 move-other frame-lost move-all frame-lost",
    "scs limp 25 move-other link-down link-up reply-late",
    "lx16a holds 25 free torque-off others-move",
    "xl320 holds 25 move-other reply-late move stop",
    "ics limp 25 move-all hand later stop",
};

TEST(sequences_that_broke_a_rule_break_none_any_more)
{
    for (size_t i = 0; i < sizeof mended / sizeof mended[0]; i++) {
        memset(&sum, 0, sizeof sum);
        run_one(mended[i], false);
        assert_int_equal(sum.failed, 0);
    }
}

TEST(sequences_of_requests_and_line_events_keep_the_rules)
{
    const char *depth = getenv("GROBO_SEQUENCES"), *one = getenv("GROBO_SEQUENCE");
    uint32_t seed = 36;
    memset(&sum, 0, sizeof sum);
    if (is_set(one)) {
        run_one(one, true);
    } else if (is_set(depth)) {
        int n = (int)strtol(depth, NULL, 10);
        assert_in_range(n, 1, DEPTH_MAX);
        run_all(n);
    } else {
        run_some(60, &seed);
    }
    print_message("%lu states, %lu ends, %lu goals, %lu broke a rule\n", sum.states, sum.sequences,
                  sum.goals, sum.failed);
    print_message("excused: %lu not heard, %lu disturbed, %lu restarted, %lu missed a frame\n",
                  sum.excused[SEQUENCE_UNHEARD], sum.excused[SEQUENCE_DISTURBED],
                  sum.excused[SEQUENCE_RESTARTED], sum.excused[SEQUENCE_LOST]);
    assert_int_equal(sum.failed, 0);
}
