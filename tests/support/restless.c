/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/next_random.h"
#include "tests/support/restless.h"
#include "tests/support/test.h"

/* The user's own loop, and how often bounds are looked at. */
#define TICK_US 20000
/* After the last request all jobs are waited for so long. */
#define END_US 130000000

static const rig_key sway[] = {{0, {{NECK, 0}}},
                               {800, {{NECK, 40}, {SHOULDER, 90}}},
                               {1500, {{NECK, -40}, {R_KNEE, -100}}},
                               {2500, {{SHOULDER, -90}}}};
static const rig_key nod[] = {{0, {{NECK, 20}}}, {600, {{NECK, -20}}}};
static const rig_key rush[] = {{0, {{SHOULDER, 100}}}, {300, {{SHOULDER, -50}, {R_ELBOW, 40}}}};

static const char *const names[RESTLESS_KINDS] = {
#define RESTLESS_NAME(name, weight) #name,
    RESTLESS_LIST(RESTLESS_NAME)
#undef RESTLESS_NAME
};

static const unsigned weights[RESTLESS_KINDS] = {
#define RESTLESS_WEIGHT(name, weight) weight,
    RESTLESS_LIST(RESTLESS_WEIGHT)
#undef RESTLESS_WEIGHT
};

const char *restless_name(int kind)
{
    return names[kind];
}

uint32_t restless_pick(restless *u, uint32_t n)
{
    return next_random(&u->random) % n;
}

static int any_joint(restless *u)
{
    return (int)restless_pick(u, 20);
}

static grobo_joint_mask any_joints(restless *u)
{
    grobo_joint_mask few = GROBO_JOINT_BIT(any_joint(u)) | GROBO_JOINT_BIT(any_joint(u));
    return restless_pick(u, 2) == 0 ? rig_all(u->rig) : few;
}

double restless_angle_deg(restless *u, int joint)
{
    const grobo_joint *limits = &u->rig->driver->model->joints[joint];
    double part = (restless_pick(u, 1021) - 10.0) / 1000; /* one in fifty is outside */
    return grobo_deg_from_rad(limits->min_rad + (limits->max_rad - limits->min_rad) * part);
}

void restless_told(restless *u, grobo_job_kind kind, int result, restless_effect effect)
{
    chronicle_note(&u->judge.notes, u->rig->now_us, "%s: %s %d", names[u->asked_by],
                   grobo_error_name(result), result < 0 ? 0 : result);
    if (result < 0) {
        return;
    }
    u->accepted[u->asked_by]++;
    if (kind != GROBO_JOB_NONE && result > 0) {
        judge_job_began(&u->judge, result, kind);
    }
    if (effect == RESTLESS_MOVES) {
        judge_motion_asked(&u->judge);
    }
}

/* ---- motions --------------------------------------------------------------------------------- */

static grobo_posture any_target(restless *u, uint32_t longest_ms)
{
    int joint = any_joint(u);
    return rig_posture(u->rig, joint, restless_angle_deg(u, joint),
                       (int)restless_pick(u, longest_ms));
}

static void ask_move(restless *u)
{
    grobo_posture target = any_target(u, 2000);
    int result = grobo_robot_move(&u->rig->robot, &target);
    restless_told(u, GROBO_JOB_MOVE, result, RESTLESS_MOVES);
    u->moved = result < 0 ? u->moved : target.set;
}

static grobo_play_options any_options(restless *u)
{
    static const uint16_t rates_hz[] = {20, 30, 39, 50, 60};
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT,
                                  .mode = restless_pick(u, 2) ? GROBO_PLAY_RATE : GROBO_PLAY_KEY,
                                  .rate_hz = rates_hz[restless_pick(u, 5)],
                                  .repeat = 1 + (int32_t)restless_pick(u, 3),
                                  .reverse = restless_pick(u, 8) == 0,
                                  .mirror = restless_pick(u, 4) == 0,
                                  .speed_pct = (uint16_t)(50 + restless_pick(u, 200)),
                                  .unwatched = restless_pick(u, 3) != 0,
                                  .also = restless_pick(u, 2) ? rig_all(u->rig) : 0};
    uint32_t later = restless_pick(u, 12);
    options.start_us = later == 0   ? GROBO_START_LATER
                       : later == 1 ? u->rig->now_us + (int64_t)restless_pick(u, 3000000)
                                    : 0;
    return options;
}

static void ask_play(restless *u)
{
    grobo_play_options options = any_options(u);
    const grobo_clip *clip = &u->clips[restless_pick(u, RESTLESS_CLIPS)].clip;
    restless_told(u, GROBO_JOB_PLAY, grobo_robot_play(&u->rig->robot, clip, &options),
                  RESTLESS_MOVES);
}

static void ask_enqueue(restless *u)
{
    grobo_play_options options = any_options(u);
    const grobo_clip *clip = &u->clips[restless_pick(u, RESTLESS_CLIPS)].clip;
    restless_told(u, GROBO_JOB_NONE, grobo_robot_enqueue(&u->rig->robot, clip, &options),
                  RESTLESS_MOVES);
}

/* A move under way goes elsewhere, and the joint of this target with it. */
static void redirect(restless *u, grobo_posture target)
{
    for (int j = 0; j < target.n_joints; j++) {
        if ((u->moved & ~target.set & GROBO_JOINT_BIT(j)) != 0) {
            assert_int_equal(grobo_posture_set_deg(&target, j, restless_angle_deg(u, j)), 0);
        }
    }
    int result = grobo_robot_retarget(&u->rig->robot, &target);
    restless_told(u, GROBO_JOB_NONE, result < 0 ? result : GROBO_OK, RESTLESS_MOVES);
    u->moved = result < 0 ? u->moved : target.set;
}

static void ask_send(restless *u)
{
    grobo_posture target = any_target(u, 400);
    int result = grobo_robot_send(&u->rig->robot, &target);
    restless_told(u, GROBO_JOB_NONE, result, RESTLESS_MOVES);
    if (grobo_robot_job(&u->rig->robot) == GROBO_JOB_MOVE) {
        redirect(u, target);
    }
}

/* One target of the user's own loop: on at a speed, back at a limit. */
static void stream_on(restless *u)
{
    const grobo_joint *limits = &u->rig->driver->model->joints[u->stream_joint];
    double min_deg = grobo_deg_from_rad(limits->min_rad);
    double max_deg = grobo_deg_from_rad(limits->max_rad);
    u->stream_deg += u->stream_dps * TICK_US / 1e6;
    if (u->stream_deg < min_deg || u->stream_deg > max_deg) {
        u->stream_dps = -u->stream_dps;
        u->stream_deg = fmin(fmax(u->stream_deg, min_deg), max_deg);
    }
    grobo_posture target = rig_posture(u->rig, u->stream_joint, u->stream_deg, TICK_US / 1000);
    u->asked_by = RESTLESS_send;
    u->asked[RESTLESS_send]++;
    int result = grobo_robot_send(&u->rig->robot, &target);
    restless_told(u, GROBO_JOB_NONE, result, RESTLESS_MOVES);
    if (result < 0 && restless_pick(u, 4) == 0) {
        u->stream_until_us = 0;
    }
}

static void ask_stream(restless *u)
{
    u->stream_joint = any_joint(u);
    u->stream_deg = rig_angle_deg(u->rig, u->stream_joint);
    u->stream_dps = (double)restless_pick(u, 1200) - 600;
    u->stream_until_us = u->rig->now_us + (int64_t)restless_pick(u, 4000000);
    u->accepted[RESTLESS_stream]++;
}

static void ask_torque(restless *u)
{
    static const grobo_torque modes[] = {GROBO_TORQUE_ON, GROBO_TORQUE_ON, GROBO_TORQUE_ON,
                                         GROBO_TORQUE_OFF, GROBO_TORQUE_BRAKE};
    grobo_torque mode = modes[restless_pick(u, 5)];
    grobo_joint_mask joints = any_joints(u);
    restless_told(u, GROBO_JOB_TORQUE, grobo_robot_torque(&u->rig->robot, joints, mode),
                  mode == GROBO_TORQUE_ON ? RESTLESS_MOVES : RESTLESS_NOTHING);
}

static void ask_free(restless *u)
{
    bool on = restless_pick(u, 4) != 0;
    grobo_joint_mask joints = any_joints(u);
    int result = grobo_robot_free(&u->rig->robot, joints, on);
    restless_told(u, on ? GROBO_JOB_NONE : GROBO_JOB_TORQUE, result, RESTLESS_MOVES);
}

static void ask_control(restless *u)
{
    grobo_robot *robot = &u->rig->robot;
    int result = 0;
    switch (restless_pick(u, 5)) {
    case 0:
        result = grobo_robot_pause(robot);
        break;
    case 4:
        result = grobo_robot_start_at(robot, u->rig->now_us + (int64_t)restless_pick(u, 1000000));
        break;
    case 1:
        result = grobo_robot_resume(robot);
        break;
    case 2:
        result = grobo_robot_seek(robot, (int64_t)restless_pick(u, 2500000));
        break;
    default:
        result = grobo_robot_speed(robot, 20 + (int)restless_pick(u, 300));
        break;
    }
    restless_told(u, GROBO_JOB_NONE, result, RESTLESS_MOVES);
}

/* ---- the rest of the interface --------------------------------------------------------------- */

static void ask_raw_goal(restless *u)
{
    restless_raw_goal(u);
}

static void ask_raw_torque(restless *u)
{
    restless_raw_torque(u);
}

static void ask_raw_other(restless *u)
{
    restless_raw_other(u);
}

static void ask_registers(restless *u)
{
    restless_registers(u);
}

/* A factory reset would give the servo another id: that is no robot any more. */
static void ask_command(restless *u)
{
    int id = u->rig->driver->model->joints[any_joint(u)].motor;
    grobo_servo_command command = restless_pick(u, 3) ? GROBO_SERVO_REBOOT : GROBO_SERVO_FLASH;
    restless_told(u, GROBO_JOB_COMMAND, grobo_robot_command(&u->rig->robot, id, command),
                  RESTLESS_NOTHING);
}

static void ask_stored(restless *u)
{
    grobo_stored_kind kind = restless_pick(u, 2) ? GROBO_STORED_SLOT : GROBO_STORED_SCENARIO;
    restless_told(u, GROBO_JOB_STORED, grobo_robot_stored(&u->rig->robot, kind, 2), RESTLESS_MOVES);
}

static void ask_sense(restless *u)
{
    grobo_joint_mask joints = any_joints(u);
    grobo_sense_kind kind = (grobo_sense_kind)restless_pick(u, 4);
    restless_told(u, GROBO_JOB_SENSE, grobo_robot_sense(&u->rig->robot, joints, kind),
                  RESTLESS_NOTHING);
}

static void ask_check(restless *u)
{
    restless_told(u, GROBO_JOB_CHECK, grobo_robot_check(&u->rig->robot), RESTLESS_NOTHING);
}

/* ---- ends ------------------------------------------------------------------------------------ */

static void end_stream(restless *u)
{
    if (restless_pick(u, 4) != 0) {
        u->stream_until_us = 0;
    }
}

/* A robot that sits down at its exit goes on with it. */
static void ask_stop(restless *u)
{
    bool at_once = restless_pick(u, 2) == 0;
    grobo_job_kind job = grobo_robot_job(&u->rig->robot);
    int result = grobo_robot_stop(&u->rig->robot, at_once);
    restless_told(u, GROBO_JOB_NONE, result, RESTLESS_NOTHING);
    judge_raws_stopped(&u->judge, false);
    if (result >= 0 && job != GROBO_JOB_EXIT) {
        judge_stop_asked(&u->judge, rig_all(u->rig), !at_once);
    } else if (result >= 0) {
        judge_halts_asked(&u->judge);
    }
    end_stream(u);
}

static void ask_cancel(restless *u)
{
    grobo_job_kind job = grobo_robot_job(&u->rig->robot);
    int result = grobo_robot_cancel(&u->rig->robot);
    restless_told(u, GROBO_JOB_NONE, result, RESTLESS_NOTHING);
    if (result >= 0 && job == GROBO_JOB_MOVE) {
        judge_stop_asked(&u->judge, u->moved, false);
    } else if (result >= 0) {
        judge_halts_asked(&u->judge);
    }
    end_stream(u);
}

static void ask_estop(restless *u)
{
    int result = grobo_robot_estop(&u->rig->robot);
    restless_told(u, GROBO_JOB_NONE, result, RESTLESS_NOTHING);
    judge_estop_asked(&u->judge, result);
    end_stream(u);
}

static void ask_exit(restless *u)
{
    grobo_exit_policy policy = (grobo_exit_policy)restless_pick(u, 4);
    int result = grobo_robot_exit(&u->rig->robot, policy);
    restless_told(u, GROBO_JOB_NONE, result, RESTLESS_NOTHING);
    if (result > 0) {
        judge_exit_asked(&u->judge, result,
                         policy == GROBO_EXIT_DEFAULT ? u->rig->driver->on_exit : policy);
    }
    end_stream(u);
}

/* ---- a hand ---------------------------------------------------------------------------------- */

/* A hand takes hold of a joint: it pushes, and where there is no torque it turns the joint. */
static void take_hold(restless *u)
{
    u->hand_joint = any_joint(u);
    u->hand_until_us = u->rig->now_us + 100000 + (int64_t)restless_pick(u, 1500000);
    (void)grobo_sim_set_load(&u->rig->sim, u->hand_joint, 100 + (int32_t)restless_pick(u, 800));
}

static void use_hand(restless *u)
{
    int joint = u->hand_joint;
    int64_t left_us = u->hand_until_us - u->rig->now_us;
    if (joint < 0) {
        return;
    }
    grobo_sim_view view = judge_view(&u->judge, joint);
    if (left_us <= 0) {
        (void)grobo_sim_set_load(&u->rig->sim, joint, 0);
        u->hand_joint = -1;
    } else if (view.torque != GROBO_TORQUE_ON && !view.moving) {
        const grobo_joint *limits = &u->rig->driver->model->joints[joint];
        double here_deg = view.angle_mdeg / 1000.0;
        double by_deg = (double)left_us / 1e6 * ((double)restless_pick(u, 300) - 150);
        double to_deg = fmin(fmax(here_deg + by_deg, grobo_deg_from_rad(limits->min_rad)),
                             grobo_deg_from_rad(limits->max_rad));
        (void)grobo_sim_set_angle(&u->rig->sim, joint, (int32_t)(to_deg * 1000), left_us);
        judge_turned(&u->judge, joint, u->hand_until_us);
    }
}

/* ---- asking ---------------------------------------------------------------------------------- */

static void (*const asks[RESTLESS_KINDS])(restless *u) = {
#define RESTLESS_ASK(name, weight) ask_##name,
    RESTLESS_LIST(RESTLESS_ASK)
#undef RESTLESS_ASK
};

static int any_kind(restless *u)
{
    unsigned all = 0;
    for (int i = 0; i < RESTLESS_KINDS; i++) {
        all += weights[i];
    }
    unsigned left = restless_pick(u, all);
    int kind = 0;
    while (left >= weights[kind]) {
        left -= weights[kind++];
    }
    return kind;
}

/* A request that is refused sends nothing. */
static void ask(restless *u)
{
    grobo_trip_info trip;
    grobo_robot_tripped(&u->rig->robot, &trip);
    if (trip.latched && restless_pick(u, 2) == 0 && grobo_robot_reset(&u->rig->robot) == GROBO_OK) {
        chronicle_note(&u->judge.notes, u->rig->now_us, "reset");
        judge_reset_done(&u->judge);
    }
    u->asked_by = any_kind(u);
    u->asked[u->asked_by]++;
    u->requests++;
    unsigned accepted = u->accepted[u->asked_by];
    int pending = grobo_bus_pending(&u->rig->robot.bus);
    u->asking = true;
    asks[u->asked_by](u);
    u->asking = false;
    if (u->accepted[u->asked_by] == accepted && grobo_bus_pending(&u->rig->robot.bus) > pending) {
        fail_msg("a refused request (%s) sends a frame", names[u->asked_by]);
    }
}

static void ask_burst(restless *u)
{
    for (uint32_t n = restless_pick(u, 6) == 0 ? 2 + restless_pick(u, 4) : 1; n > 0; n--) {
        ask(u);
    }
}

/* ---- hooks ----------------------------------------------------------------------------------- */

static void ask_within(restless *u, uint32_t one_in)
{
    if (!u->asking && restless_pick(u, one_in) == 0) {
        u->in_callbacks++;
        ask_burst(u);
    }
}

static void on_event(grobo_test_rig *rig, const grobo_event *event)
{
    restless *u = rig->ctx;
    judge_event(&u->judge, event);
    u->moves += event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_MOVE &&
                event->u.job.result == GROBO_OK;
    u->plays += event->kind == GROBO_EVENT_PLAY && event->u.play.to == GROBO_SEQUENCER_FINISHED;
    u->trips += event->kind == GROBO_EVENT_TRIP;
    ask_within(u, event->kind == GROBO_EVENT_JOINT ? 1000 : 20);
}

static void on_frame(grobo_test_rig *rig, const uint8_t *bytes, size_t n)
{
    restless *u = rig->ctx;
    judge_frame(&u->judge, bytes, n);
    ask_within(u, 2000);
}

static void on_sim(grobo_test_rig *rig, const grobo_sim_event *event)
{
    restless *u = rig->ctx;
    judge_sim(&u->judge, event);
}

/* ---- life ------------------------------------------------------------------------------------ */

void restless_start(restless *u, grobo_test_rig *rig, uint32_t seed)
{
    u->rig = rig;
    u->random = seed;
    u->requests = 0;
    u->asking = false;
    u->stream_until_us = 0;
    u->hand_joint = -1;
    rig_clip_init(&u->clips[0], sway, sizeof sway / sizeof sway[0]);
    rig_clip_init(&u->clips[1], nod, sizeof nod / sizeof nod[0]);
    rig_clip_init(&u->clips[2], rush, sizeof rush / sizeof rush[0]);
    u->clips[1].only = GROBO_JOINT_BIT(NECK);
    judge_start(&u->judge, rig);
    rig->on_event = on_event;
    rig->on_frame = on_frame;
    rig->on_sim = on_sim;
    rig->ctx = u;
}

/* Lets time pass up to a moment, with the user's own loop and a hand. */
static void pass(restless *u, int64_t until_us)
{
    while (u->rig->now_us < until_us) {
        int64_t left_us = until_us - u->rig->now_us;
        rig_run(u->rig, left_us < TICK_US ? left_us : TICK_US);
        judge_look(&u->judge);
        use_hand(u);
        if (u->rig->now_us < u->stream_until_us) {
            u->asking = true;
            stream_on(u);
            u->asking = false;
        }
    }
}

static int64_t any_pause_us(restless *u)
{
    static const uint32_t longest_us[] = {60000, 60000, 600000, 600000, 600000, 1500000, 5000000};
    uint32_t kinds = sizeof longest_us / sizeof longest_us[0];
    return (int64_t)restless_pick(u, longest_us[restless_pick(u, kinds)]);
}

int64_t restless_live(restless *u, int64_t length_us)
{
    int64_t from_us = u->rig->now_us;
    while (u->rig->now_us - from_us < length_us && !u->rig->witness.settings_hit) {
        ask_burst(u);
        pass(u, u->rig->now_us + any_pause_us(u));
        if (restless_pick(u, 20) == 0) {
            int64_t stall_us = (int64_t)restless_pick(u, 600000);
            judge_stalled(&u->judge, stall_us);
            rig_stall(u->rig, stall_us);
        }
        if (u->hand_joint < 0 && restless_pick(u, 6) == 0) {
            take_hold(u);
        }
        rig_forget(u->rig);
    }
    int64_t lived_us = u->rig->now_us - from_us;
    u->asking = true; /* no more requests, from callbacks neither */
    u->stream_until_us = 0;
    for (int64_t left_us = END_US; u->judge.n_jobs > 0 && left_us > 0; left_us -= TICK_US) {
        pass(u, u->rig->now_us + TICK_US);
        rig_forget(u->rig);
    }
    judge_end(&u->judge);
    return lived_us;
}
