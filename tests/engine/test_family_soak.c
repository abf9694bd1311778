/* SPDX-License-Identifier: MIT */
/*
 * A restless user on a bad line with servos of each family: random requests under faults of every
 * kind, with the rules of safety that need no knowledge of a family held at every step:
 *   - no servo that has torque is sent outside its joint's limits;
 *   - none turns faster than its joint may, where nothing was lost lately;
 *   - torque comes on only where the servo's goal is near its shaft, whatever switches it on;
 *   - an emergency stop is carried out within its bound, nothing moves after it, and nothing is
 *     accepted that moves;
 *   - each job ends once, within a minute, or when the longest way that a servo was sent ends;
 *   - after a stop nothing goes on, be it behind its way, weak, held fast or turned round;
 *   - on a line that is good again each joint is where it is read to be.
 * A servo that took a packet which nobody sent is excused until it takes the next goal, or for ever
 * where that changed a setting that lasts: the line has made it up, and its sum is right
 * (tests/support/family_kit.c).
 * A broken rule prints the command that repeats it. Half of the runs have weight: a chain that
 * hangs on the first joint, which sags, lags, swings, and falls without torque.
 *
 * tests/engine/test_robot_soak.c does the same with RS30x, and knows its packets.
 *
 * Environment (make soak sets it): GROBO_SOAK=6 seeds of half an hour for each line,
 * GROBO_SOAK_FROM, GROBO_SOAK_LINE, GROBO_SOAK_MINUTES as there; GROBO_SOAK_FAMILY one family
 * alone. Without GROBO_SOAK: seed 1, a minute for each family.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/sim_physics.h>

#include "src/base/instant.h"
#include "src/sim/servo/shaft.h"
#include "tests/support/family_kit.h"
#include "tests/support/next_random.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { MS = 1000, S = 1000000, OPEN_MAX = 64, RUNS_MAX = 4096 };

/* Requests ask for ways of so long at the most; raw goals have any speed. A job ends so long after
 * it was asked for, or so long after the slowest way; an emergency stop waits for no way. */
enum { ASKED_MAX_US = 3000 * MS, JOB_MAX_US = 60 * S, ENDS_US = 10 * S, ESTOP_MAX_US = 11 * S };

static const char *const lines[] = {
    "drop=0",
    "drop=0.01",
    "flip=0.01",
    "duplicate=0.01,delay=0.01,split=0.01",
    "rubbish=0.02,silent=0.02",
    "brownout=0.0005",
    "drop=0.002,flip=0.002,split=0.01,rubbish=0.01,silent=0.01",
};
enum { LINES = sizeof lines / sizeof lines[0] };

/* What was lost makes the engine's picture of a joint wrong until it was read again. */
enum { DOUBT_US = 1500 * MS };
/* Of the steps of goals and of their times, and of a servo that catches up. */
#define SPEED_SLACK 1.3
#define LIMIT_SLACK_DEG 1.2
#define HOLD_DEG 3.5
/* A ramp that comes to its end. */
#define REST_DEG 1.0

typedef struct run {
    const family *family;
    uint32_t seed;
    int line;
    char name[120];
} run;

enum { KEYS = 4, MOTIONS = 4 };

typedef struct motion {
    grobo_clip clip;
    grobo_posture key[KEYS];
    int64_t at_us[KEYS];
} motion;

static family_kit kit;
static grobo_sim_physics *physics; /* of a run with weight, else NULL */
static struct {
    motion motions[MOTIONS];
    uint32_t random;
    int open[OPEN_MAX]; /* jobs that have not ended */
    int64_t open_us[OPEN_MAX];
    unsigned n_open, seen;
    uint32_t injected; /* faults so far */
    int64_t doubt_until_us;
    int64_t hand_until_us[FAMILY_JOINTS]; /* a hand turns it, or did lately */
    bool misled[FAMILY_JOINTS];           /* the line made up what it was told last, */
    bool ruined[FAMILY_JOINTS];           /* or a setting that lasts: its limits, its middle */
    int64_t held_until_us;                /* somebody holds this joint fast, */
    int held_joint;
    int64_t weak_until_us; /* and the supply is low */
    int estop;             /* its job, 0 when it is over */
    bool latched, stands;
    int64_t stands_us, looked_us;
    int64_t still_us; /* after a stop all stand from then on; 0: somebody asked for something */
    int64_t slow_until_us; /* a servo is on a way longer than requests ask for: a raw goal's */
    int64_t estop_us;      /* when its job began */
} user;
static struct {
    unsigned runs, moves, torque_on, estops, jobs, refused, checked, retargets, stops, plays;
    int64_t virtual_us;
} total;
static run runs[RUNS_MAX];
static size_t n_runs;
static double minutes = 1;

static uint32_t pick(uint32_t n)
{
    return next_random(&user.random) % n;
}

static double angle_deg(void)
{
    return (double)pick(2000) / 10 - 100; /* sometimes beyond the limits */
}

/* ---- rules ----------------------------------------------------------------------------------- */

static bool doubtful(int joint)
{
    return kit.now_us < user.doubt_until_us || kit.now_us < user.hand_until_us[joint];
}

static void look_at_faults(void)
{
    uint32_t injected = 0;
    for (int i = 0; i < (int)GROBO_SIM_FAULTS; i++) {
        injected += kit.sim.stats.injected[i];
    }
    if (injected != user.injected) {
        user.injected = injected;
        user.doubt_until_us = kit.now_us + DOUBT_US;
    }
}

/* What all joints stand behind by now, or NULL. */
static const char *stopped_by(void)
{
    bool stopped = user.still_us > 0 && kit.now_us > user.still_us;
    return user.stands && kit.now_us > user.stands_us ? "an emergency stop"
           : stopped                                  ? "a stop"
                                                      : NULL;
}

/* How long a way takes, by its length and its servo's speed. */
static void note_slow(const grobo_sim_servo *servo)
{
    int64_t ends_us = servo->start_us + servo->move_us;
    if (servo->move_us > ASKED_MAX_US && ends_us > user.slow_until_us) {
        user.slow_until_us = ends_us;
    }
}

/* In a world with weight the shaft sags, lags and swings beside the place that its servo has it at:
 * the rules are of that place. */
static grobo_sim_view view_of(family_kit *k, int j)
{
    const grobo_sim_servo *servo = &k->sim.servo[j];
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&k->sim, j, &view), GROBO_OK);
    if (physics != NULL && view.torque == GROBO_TORQUE_ON) {
        double mdeg_s = grobo_i_sim_planned_mdeg_s(servo, k->now_us);
        view.angle_mdeg = (int32_t)lround(grobo_i_sim_planned_mdeg(servo, k->now_us));
        int32_t planned_dps = (int32_t)lround(fabs(mdeg_s) / 1000);
        view.moving = planned_dps > 0; /* a plan may outrun a motor */
        view.speed_dps = view.speed_dps < planned_dps ? view.speed_dps : planned_dps;
    }
    return view;
}

static void look_at(family_kit *k, int j)
{
    const grobo_sim_servo *servo = &k->sim.servo[j];
    const grobo_sim_view view = view_of(k, j);
    double sign = k->joints[j].sign < 0 ? -1 : 1;
    double to_deg = sign * view.target_mdeg / 1000.0;
    double left_deg = fabs(to_deg - sign * view.angle_mdeg / 1000.0);
    if (view.torque != GROBO_TORQUE_ON || !view.moving) {
        return;
    }
    note_slow(servo);
    if (fabs(to_deg) > 90 + LIMIT_SLACK_DEG && k->now_us >= user.hand_until_us[j] &&
        !user.misled[j] && !user.ruined[j]) {
        fail_msg("joint %d is sent to %.2f deg", j, to_deg);
    }
    double most_dps = k->joints[j].max_speed_rad_s / RAD(1) * SPEED_SLACK + 5;
    bool goes = abs(servo->to_mdeg - servo->from_mdeg) > 500; /* not a step of the wire */
    if (goes && !doubtful(j) && view.speed_dps > most_dps) {
        fail_msg("joint %d turns by %d deg/s, and may by %.0f", j, (int)view.speed_dps, most_dps);
    }
    if (stopped_by() != NULL && left_deg > REST_DEG && !doubtful(j)) {
        fail_msg("joint %d moves after %s: %d deg/s, to %.1f deg", j, stopped_by(),
                 (int)view.speed_dps, to_deg);
    }
}

/* A joint goes on for so long after a stop: the line, the frame, the halt. */
#define STILL_US (600 * MS)

/* Servos are looked at so often: a byte is shorter. */
#define LOOK_US 1000

static void on_look(family_kit *k)
{
    look_at_faults();
    for (int j = 0; j < FAMILY_JOINTS && k->now_us >= user.looked_us + LOOK_US; j++) {
        look_at(k, j);
    }
    user.looked_us = k->now_us >= user.looked_us + LOOK_US ? k->now_us : user.looked_us;
}

/* What the host has read of a joint is wrong, and its sum of 8 bits right: nobody can know. */
static bool is_misread(family_kit *k, int joint, double is_deg)
{
    double read_deg = k->robot.axes[joint].state.angle_rad / RAD(1);
    return k->now_us < user.doubt_until_us && strcmp(k->family->name, "dxl2") != 0 &&
           fabs(read_deg - is_deg) > HOLD_DEG;
}

/* A joint that is halted though no reply of it was whole for so long: it may have restarted, or
 * hear what it does not answer (docs/guide/safety.md). */
#define UNHEARD_US (800 * MS)

static bool is_unheard(const family_kit *k, int joint)
{
    return k->now_us - k->robot.axes[joint].angle_us > UNHEARD_US;
}

/* A register that lasts was written, by a packet that nobody sent. */
static bool is_setting(const family_kit *k, const grobo_sim_event *event)
{
    const grobo_servo_model *model = k->servos[event->servo];
    const grobo_servo_register *reg = NULL;
    for (size_t i = 0; (reg = grobo_servo_register_row(model, i)) != NULL; i++) {
        if (reg->address == event->value && (reg->flags & GROBO_REGISTER_KEPT) != 0) {
            return event->kind == GROBO_SIM_REGISTER && k->made_up;
        }
    }
    return false;
}

static void on_sim(family_kit *k, const grobo_sim_event *event)
{
    if (event->kind == GROBO_SIM_GOAL || (event->kind == GROBO_SIM_REGISTER && k->made_up)) {
        user.misled[event->servo] = k->made_up;
        user.ruined[event->servo] = user.ruined[event->servo] || is_setting(k, event);
    }
    if (event->kind != GROBO_SIM_TORQUE || event->value != GROBO_TORQUE_ON || k->made_up) {
        return;
    }
    const grobo_sim_servo *servo = &k->sim.servo[event->servo];
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&k->sim, event->servo, &view), GROBO_OK);
    double off_deg = (servo->plant.goal_mdeg - view.angle_mdeg) / 1000.0;
    double is_deg = view.angle_mdeg / (k->joints[event->servo].sign < 0 ? -1000.0 : 1000.0);
    double read_deg = k->robot.axes[event->servo].state.angle_rad / RAD(1);
    double fell_deg = physics != NULL ? fabs(read_deg - is_deg) : 0; /* since it was read */
    total.torque_on++;
    if (k->now_us >= user.hand_until_us[event->servo] && fabs(off_deg) > HOLD_DEG + fell_deg &&
        !is_misread(k, event->servo, is_deg) && !is_unheard(k, event->servo) &&
        !user.ruined[event->servo]) {
        fail_msg("torque of joint %d comes on %.1f deg away from its goal", event->servo, off_deg);
    }
}

/* ---- jobs ------------------------------------------------------------------------------------ */

static void began(int number)
{
    if (number <= 0) {
        total.refused++;
        return;
    }
    user.still_us = 0;
    for (unsigned i = 0; i < user.n_open; i++) {
        if (user.open[i] == number) {
            return; /* it joins one that waits, and ends with it */
        }
    }
    assert_true(user.n_open < OPEN_MAX);
    user.open[user.n_open] = number;
    user.open_us[user.n_open++] = kit.now_us;
}

static void ended(const grobo_event_job *job)
{
    unsigned i = 0;
    while (i < user.n_open && user.open[i] != job->number) {
        i++;
    }
    if (job->number == user.estop) {
        total.estops++;
        user.stands = job->result == GROBO_OK;
        user.stands_us = kit.now_us + 100 * MS;
        user.estop = 0;
    }
    if (i == user.n_open) {
        return; /* the engine's own, or it ended within its request */
    }
    user.n_open--;
    user.open[i] = user.open[user.n_open];
    user.open_us[i] = user.open_us[user.n_open];
    total.jobs++;
    total.moves += job->kind == GROBO_JOB_MOVE && job->result == GROBO_OK;
}

static void look_at_jobs(void)
{
    for (; user.seen < kit.n_done; user.seen++) {
        ended(&kit.done[user.seen % FAMILY_EVENTS]);
    }
    for (unsigned i = 0; i < user.n_open; i++) {
        if (kit.now_us > user.open_us[i] + JOB_MAX_US &&
            kit.now_us > user.slow_until_us + ENDS_US) {
            fail_msg("job %d does not end", user.open[i]);
        }
    }
    if (user.estop != 0 && kit.now_us > user.estop_us + ESTOP_MAX_US) {
        fail_msg("emergency stop %d does not end", user.estop);
    }
}

/* ---- requests -------------------------------------------------------------------------------- */

static grobo_joint_mask some_joints(void)
{
    return 1 + pick((1U << FAMILY_JOINTS) - 1);
}

static grobo_posture some_posture(void)
{
    grobo_posture p;
    assert_int_equal(grobo_posture_init(&p, FAMILY_JOINTS), 0);
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        p.angle_rad[j] = RAD(angle_deg() * (pick(3) == 0 ? 1 : 0.85));
    }
    p.set = some_joints();
    p.time_us = pick(3000) * (int64_t)MS;
    return p;
}

static void ask_move(void)
{
    grobo_posture p = some_posture();
    int result = grobo_robot_move(&kit.robot, &p);
    assert_true(!user.latched || result < 0);
    began(result);
}

static void ask_send(void)
{
    grobo_posture p = some_posture();
    int result = grobo_robot_send(&kit.robot, &p);
    assert_true(!user.latched || result < 0);
    user.still_us = result < 0 ? user.still_us : 0;
}

static void ask_retarget(void)
{
    grobo_posture p = some_posture();
    p.set = GROBO_JOINTS_ALL(FAMILY_JOINTS); /* what the move before set among them */
    int result = grobo_robot_retarget(&kit.robot, &p);
    assert_true(!user.latched || result < 0);
    user.still_us = result < 0 ? user.still_us : 0;
    total.retargets += result > 0;
}

static void ask_torque(void)
{
    static const grobo_torque modes[] = {GROBO_TORQUE_ON, GROBO_TORQUE_OFF, GROBO_TORQUE_BRAKE};
    began(grobo_robot_torque(&kit.robot, some_joints(), modes[pick(3)]));
}

static void ask_reading(void)
{
    began(grobo_robot_sense(&kit.robot, some_joints(), (grobo_sense_kind)pick(4)));
}

/* Frames as the driver builds them for anything, and rubbish. */
static void ask_raw(void)
{
    grobo_exchange exchange = {.frame_bytes = 0};
    grobo_target target = {.posture = some_posture()};
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        target.joint_time_us[j] = (1 + pick(2000)) * (int64_t)MS;
    }
    uint32_t what = pick(4);
    int part = (int)pick(2);
    if (what == 0) {
        exchange.frame_bytes = (uint16_t)(1 + pick(12));
        for (int i = 0; i < exchange.frame_bytes; i++) {
            exchange.frame[i] = (uint8_t)next_random(&user.random);
        }
    } else if (what == 1) {
        (void)kit.driver.torque(&kit.driver, NULL, some_joints(), (grobo_torque)pick(2), part,
                                &exchange);
    } else {
        (void)kit.driver.posture(&kit.driver, NULL, &target, part, &exchange);
    }
    if (exchange.frame_bytes > 0) {
        began(grobo_robot_raw(&kit.robot, exchange.frame, exchange.frame_bytes));
    }
}

/* Any register: those that are guarded must be refused, what is a setting lasts. Only values that
 * it had before, so that the robot remains one. */
static void ask_registers(void)
{
    int servo = (int)pick(FAMILY_JOINTS);
    const grobo_servo_register *reg =
        grobo_servo_register_row(kit.servos[servo], pick(kit.family->table->register_count));
    uint8_t data[64];
    uint8_t n = 0;
    if (reg == NULL) {
        return;
    }
    n = reg->bytes;
    memcpy(data, &kit.sim.servo[servo].reg[reg->address], n);
    const grobo_register_io io = {(uint8_t)(servo + 1), reg->address, n,
                                  pick(2) == 0 ? NULL : data};
    began(grobo_robot_registers(&kit.robot, &io));
}

/* One that was held fast has cut its torque until then. */
static void ask_restart(void)
{
    began(grobo_robot_command(&kit.robot, 1 + (int)pick(FAMILY_JOINTS), GROBO_SERVO_REBOOT));
}

/* ---- motions --------------------------------------------------------------------------------- */

static int key_of(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    const motion *m = ctx;
    *posture = m->key[i];
    *at_us = m->at_us[i];
    return GROBO_OK;
}

static int sample_of(void *ctx, int64_t at_us, grobo_posture *posture)
{
    const motion *m = ctx;
    int i = 0;
    while (i < KEYS - 2 && m->at_us[i + 1] < at_us) {
        i++;
    }
    double part = (double)(at_us - m->at_us[i]) / (double)(m->at_us[i + 1] - m->at_us[i]);
    *posture = m->key[i];
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        posture->angle_rad[j] += (m->key[i + 1].angle_rad[j] - m->key[i].angle_rad[j]) * part;
    }
    return GROBO_OK;
}

static void make_motions(void)
{
    for (int i = 0; i < MOTIONS; i++) {
        motion *m = &user.motions[i];
        grobo_joint_mask joints = some_joints();
        int64_t at_us = 0;
        for (int k = 0; k < KEYS; k++) {
            m->key[k] = some_posture();
            m->key[k].set = joints;
            for (int j = 0; j < FAMILY_JOINTS && i > 0; j++) {
                m->key[k].angle_rad[j] *= 0.8; /* only one of them is beyond the limits */
            }
            m->at_us[k] = at_us;
            at_us += (100 + pick(1500)) * (int64_t)MS;
        }
        m->clip = (grobo_clip){.key = key_of,
                               .sample = sample_of,
                               .ctx = m,
                               .length_us = m->at_us[KEYS - 1],
                               .n_keys = KEYS,
                               .n_joints = FAMILY_JOINTS};
    }
}

static void ask_motion(void)
{
    const grobo_clip *clip = &user.motions[pick(MOTIONS)].clip;
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT,
                                        .mode = pick(2) ? GROBO_PLAY_RATE : GROBO_PLAY_KEY,
                                        .rate_hz = pick(2) ? 20 : 0,
                                        .repeat = 1 + (int32_t)pick(2),
                                        .reverse = pick(4) == 0,
                                        .speed_pct = (uint16_t)(50 + pick(250)),
                                        .stop_us = (1 + pick(300)) * (int64_t)MS,
                                        .unwatched = true,
                                        .also = pick(2) ? GROBO_JOINTS_ALL(FAMILY_JOINTS) : 0};
    if (grobo_robot_is_playing(&kit.robot) && pick(2) == 0) {
        int result = grobo_robot_enqueue(&kit.robot, clip, &options);
        assert_true(!user.latched || result < 0);
        return;
    }
    int result = grobo_robot_play(&kit.robot, clip, &options);
    assert_true(!user.latched || result < 0);
    total.plays += result > 0;
    began(result);
}

static void ask_control(void)
{
    int result = 0;
    switch (pick(4)) {
    case 0:
        result = grobo_robot_pause(&kit.robot);
        break;
    case 1:
        result = grobo_robot_resume(&kit.robot);
        break;
    case 2:
        result = grobo_robot_seek(&kit.robot, pick(3000) * (int64_t)MS);
        break;
    default:
        result = grobo_robot_speed(&kit.robot, 20 + (int)pick(300));
        break;
    }
    user.still_us = result < 0 ? user.still_us : 0;
}

static void ask_estop(void)
{
    int result = grobo_robot_estop(&kit.robot);
    user.latched = user.latched || result > 0;
    if (result != user.estop) { /* it is being carried out */
        user.estop = result > 0 ? result : user.estop;
        user.estop_us = kit.now_us;
        began(result);
    }
}

static void ask_exit(void)
{
    bool again = grobo_robot_job(&kit.robot) == GROBO_JOB_EXIT;
    int result = grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
    if (!again || result < 0) {
        began(result);
    }
}

static void ask_free(void)
{
    (void)grobo_robot_free(&kit.robot, some_joints(), pick(3) == 0);
    user.still_us = 0;
}

/* A hand turns a joint that is limp. */
static void turn_by_hand(void)
{
    int j = (int)pick(FAMILY_JOINTS);
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&kit.sim, j, &view), GROBO_OK);
    if (view.torque == GROBO_TORQUE_OFF) {
        int32_t to_mdeg = (int32_t)(angle_deg() * 800);
        assert_int_equal(grobo_sim_set_angle(&kit.sim, j, to_mdeg, 300 * MS), GROBO_OK);
        user.hand_until_us[j] = kit.now_us + 3 * (int64_t)S;
    }
}

/* A joint is held fast for a while, or the supply is low. What is let go jumps after its goal. */
static void hold_fast(void)
{
    if (user.held_until_us == 0) {
        user.held_joint = (int)pick(FAMILY_JOINTS);
        user.held_until_us = kit.now_us + (100 + pick(900)) * (int64_t)MS;
        user.hand_until_us[user.held_joint] = user.held_until_us + 3 * (int64_t)S;
        assert_int_equal(grobo_sim_set_blocked(&kit.sim, user.held_joint, true), GROBO_OK);
    }
}

static uint32_t nominal_mv(void)
{
    return kit.servos[0]->voltage_mv;
}

static void weaken(void)
{
    user.weak_until_us = kit.now_us + (100 + pick(3000)) * (int64_t)MS;
    grobo_sim_set_supply(&kit.sim, nominal_mv() * (60 + pick(30)) / 100);
}

static void let_go(int64_t now_us)
{
    if (user.held_until_us > 0 && now_us >= user.held_until_us) {
        assert_int_equal(grobo_sim_set_blocked(&kit.sim, user.held_joint, false), GROBO_OK);
        user.held_until_us = 0;
    }
    if (user.weak_until_us > 0 && now_us >= user.weak_until_us) {
        grobo_sim_set_supply(&kit.sim, nominal_mv());
        user.weak_until_us = 0;
    }
}

/* After a stop for safety a person resets after a while. */
static void reset_some_time(void)
{
    grobo_trip_info trip;
    grobo_robot_tripped(&kit.robot, &trip);
    user.latched = trip.latched;
    if (trip.latched && user.estop == 0 && pick(3) == 0 && grobo_robot_reset(&kit.robot) >= 0) {
        user.latched = user.stands = false;
    }
}

/* Nobody asks for anything for a while. */
static void stop_and_look(void)
{
    if (grobo_robot_stop(&kit.robot, pick(2) == 0) >= 0) {
        look_at_jobs();
        user.still_us = user.n_open == 0 ? kit.now_us + STILL_US : 0;
        total.stops += user.n_open == 0;
        family_run(&kit, pick(2) * 2 * STILL_US);
    }
}

static void ask(void)
{
    static void (*const requests[])(void) = {
        ask_move,    ask_move,   ask_move,    ask_send,     ask_send,      ask_torque, ask_torque,
        ask_raw,     ask_raw,    ask_estop,   ask_exit,     ask_registers, ask_free,   turn_by_hand,
        ask_move,    ask_move,   ask_reading, ask_retarget, ask_send,      hold_fast,  weaken,
        ask_restart, ask_motion, ask_motion,  ask_control,  ask_control};
    reset_some_time();
    let_go(kit.now_us);
    if (user.n_open < OPEN_MAX - 1) {
        requests[pick(sizeof requests / sizeof requests[0])]();
    }
    if (pick(10) == 0) {
        stop_and_look();
    }
    if (pick(30) == 0) {
        (void)grobo_robot_cancel(&kit.robot);
    }
}

/* ---- a run ----------------------------------------------------------------------------------- */

/* Half of the runs have weight. */
static bool is_heavy(const run *r)
{
    return (r->seed + (uint32_t)r->line) % 2 == 1;
}

/* A chain of four links that hangs on its first joint: at most a tenth of what the servo lifts. */
static void add_weight(family_kit *k)
{
    grobo_sim_link links[FAMILY_JOINTS];
    double kg = k->servos[0]->torque_mnm / 1000.0 / 9.81 / 4;
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        links[j] = (grobo_sim_link){.parent = j - 1,
                                    .joint = j,
                                    .origin_m = {j == 0 ? 0 : 0.05, 0, 0},
                                    .r = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                    .axis = {0, 1, 0},
                                    .mass_kg = kg,
                                    .com_m = {0.025, 0, 0},
                                    .inertia_kgm2 = {2e-5, 2e-5, 2e-5, 0, 0, 0}};
    }
    const grobo_sim_physics_config config = {GROBO_SIM_PHYSICS_CONFIG_INIT, .model = &k->model,
                                             .links = links, .n_links = FAMILY_JOINTS};
    assert_int_equal(grobo_sim_physics_new(&config, NULL, &physics), 0);
    k->physics = physics;
}

static void start(const run *r)
{
    static const int64_t intervals_us[] = {1, 50 * MS, 150 * MS};
    const char *faults = lines[r->line];
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                       .sense_interval_us =
                                           intervals_us[(r->seed + (unsigned)r->line) % 3],
                                       .voltage_mv = -1,
                                       .limit_policy = r->seed % 3 == 0 ? GROBO_LIMIT_CLAMP : 0,
                                       .goals = r->seed % 5 < 2 ? GROBO_GOALS_WHOLE : 0,
                                       .estop_torque = r->seed % 2 == 0 ? GROBO_ESTOP_OFF : 0,
                                       .lost_replies = 30};
    const grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .seed = r->seed * 7 + 1, .no_stops = true};
    memset(&user, 0, sizeof user);
    user.random = (r->seed * 100 + (uint32_t)r->line) * 2654435761u + 17;
    grobo_sim_physics_free(physics);
    physics = NULL;
    family_start_as(&kit, r->family, &config, &sim, is_heavy(r) ? add_weight : NULL);
    for (int j = 0; j < FAMILY_JOINTS && physics != NULL; j++) {
        assert_int_equal(grobo_sim_set_wall(&kit.sim, j, -100000, 100000), 0);
    }
    make_motions();
    kit.on_look = on_look;
    kit.on_sim = on_sim;
    assert_true(grobo_sim_set_faults(&kit.sim, faults, strlen(faults)) > 0);
}

static bool anything_turns(void)
{
    bool turns = grobo_robot_moving(&kit.robot); /* what was sent last may wait for the line */
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        turns = turns || view_of(&kit, j).moving;
    }
    return turns;
}

/* The line is good again, and everybody waits: jobs end, what lost its halt arrives, and what is
 * read is true. */
static void calm_down(void)
{
    assert_true(grobo_sim_set_faults(&kit.sim, "all=0,hangup=0", 14) > 0);
    let_go(GROBO_NEVER_US);
    if (grobo_robot_is_playing(&kit.robot)) { /* it may be paused */
        assert_int_equal(grobo_robot_stop(&kit.robot, false), GROBO_OK);
    }
    (void)grobo_robot_free(&kit.robot, GROBO_JOINTS_ALL(FAMILY_JOINTS), false);
    while (user.n_open > 0) { /* within their bound */
        family_run(&kit, S);
        look_at_jobs();
    }
    int64_t calm_us = kit.now_us;
    while (anything_turns() && kit.now_us < grobo_i_later(calm_us, user.slow_until_us) + ENDS_US) {
        family_run(&kit, S);
    }
    assert_false(anything_turns());
    family_run(&kit, 2 * (int64_t)S);
    for (int j = 0; j < FAMILY_JOINTS; j++) {
        grobo_joint_info info;
        assert_int_equal(grobo_robot_joint(&kit.robot, j, &info), GROBO_OK);
        double read_deg = info.state.angle_rad / RAD(1);
        if (info.status == GROBO_OK && fabs(read_deg - family_angle_deg(&kit, j)) > 1) {
            fail_msg("joint %d is read at %.1f deg, %.0f ms ago, and stands at %.1f", j, read_deg,
                     (double)info.angle_age_us / MS, family_angle_deg(&kit, j));
        }
        total.checked += info.status == GROBO_OK;
    }
}

static uint32_t number(const char *name, uint32_t otherwise)
{
    const char *text = getenv(name);
    return text != NULL && text[0] != '\0' ? (uint32_t)strtoul(text, NULL, 10) : otherwise;
}

static void add_runs(const family *f, uint32_t seed, uint32_t only)
{
    for (int line = 0; line < LINES; line++) {
        if ((only < LINES && (int)only != line) || n_runs >= RUNS_MAX) {
            continue;
        }
        run *r = &runs[n_runs++];
        *r = (run){.family = f, .seed = seed, .line = line};
        (void)snprintf(r->name, sizeof r->name, "%s, seed %u, line %d: %s", f->name, (unsigned)seed,
                       line, lines[line]);
    }
}

/* As the environment wants them. */
static void make_runs(void)
{
    const char *only_family = getenv("GROBO_SOAK_FAMILY");
    bool is_long = getenv("GROBO_SOAK") != NULL;
    uint32_t seeds = number("GROBO_SOAK", 1);
    uint32_t first = number("GROBO_SOAK_FROM", is_long ? 0 : 1);
    uint32_t only = number("GROBO_SOAK_LINE", LINES);
    const char *length = getenv("GROBO_SOAK_MINUTES");
    minutes = length != NULL && length[0] != '\0' ? strtod(length, NULL)
              : is_long                           ? 30
                                                  : 1.0 / LINES;
    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        bool meant =
            only_family == NULL || only_family[0] == '\0' || strcmp(only_family, f->name) == 0;
        for (uint32_t seed = first; meant && seed < first + seeds; seed++) {
            add_runs(f, seed, only);
        }
    }
}

static const run *next_run(const run *before)
{
    if (n_runs == 0) {
        make_runs();
    }
    const run *next = before == NULL ? runs : before + 1;
    return next < runs + n_runs ? next : NULL;
}

static void tell(const void *row)
{
    const run *r = row;
    print_message("# A rule is broken at %.6f s. It is repeated by: make soak FAMILY=%s SEEDS=1 "
                  "FROM=%u LINE=%d MINUTES=%g\n",
                  (double)kit.now_us / 1e6, r->family->name, (unsigned)r->seed, r->line, minutes);
}

TEST_FOR(run, next_run, rules_hold)
{
    test_if_it_breaks(tell);
    start(row);
    for (int64_t end_us = kit.now_us + (int64_t)(minutes * 60e6); kit.now_us < end_us;) {
        family_run(&kit, (1 + (int64_t)pick(pick(4) == 0 ? 2000 : 200)) * MS);
        look_at_jobs();
        ask();
    }
    calm_down();
    total.virtual_us += kit.now_us;
    total.runs++;
}

/* It was a soak and not a stall. */
TEST(everything_was_done)
{
    if (n_runs == 0) {
        fail_msg("no such family: %s", getenv("GROBO_SOAK_FAMILY"));
    }
    if (total.runs < n_runs) {
        skip(); /* not all of it was asked for, or it has failed */
    }
    print_message("# %u runs, %.1f virtual minutes: %u jobs, %u moves done, %u torques on, %u "
                  "emergency stops, %u requests refused, %u retargets, %u stops, %u motions, %u "
                  "joints true at the end\n",
                  total.runs, (double)total.virtual_us / 60e6, total.jobs, total.moves,
                  total.torque_on, total.estops, total.refused, total.retargets, total.stops,
                  total.plays, total.checked);
    assert_true(total.moves > 0 && total.torque_on > 0 && total.checked > 0);
    assert_true(total.estops > 0 && total.refused > 0 && total.stops > 0);
    assert_true(total.plays > 0);
}
