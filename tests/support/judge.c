/* SPDX-License-Identifier: MIT */
/* What was asked for, what leaves, and how jobs end. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "tests/support/judge.h"
#include "tests/support/test.h"

/* The first frame of an emergency stop may wait for the longest frame on the wire. */
#define ESTOP_FRAME_US 25000
/* All of it for a robot that restarts again and again. */
#define ESTOP_US 10000000
#define EXIT_US 10010000
/* Any other job: the slowest move and all repetitions on the worst line. */
#define JOB_US 120000000
/* After this time a stopped robot stands still. */
#define REST_US 600000
/* A stop may reach so far ahead of a moving joint, and so far from one that stands still. */
#define AHEAD_S 0.15
#define SMOOTH_S 0.2
/* The longest frame is on its way for so long, and a joint goes on. */
#define LATE_S 0.02
/* A frame is on its way for so long at most. */
#define FLIGHT_US 60000
#define AHEAD_DEG 6.0
/* Of the line and of the servo bus. */
#define BAUD_BPS 115200
/* A joint nearer to its goal than this has arrived. */
#define THERE_DEG 0.5

void judge_start(judge *w, grobo_test_rig *rig)
{
    memset(w, 0, sizeof *w);
    w->rig = rig;
    rig->judged = true;
    for (int j = 0; j < rig->driver->model->n_joints; j++) {
        int32_t goal = 0;
        assert_int_equal(grobo_sim_get_register(&rig->sim, j, GROBO_RS30X_GOAL, &goal), 0);
        w->axes[j].goal_deg = goal / 10.0;
        w->axes[j].from_deg = w->axes[j].to_deg = rig_angle_deg(rig, j);
    }
}

/* ---- requests -------------------------------------------------------------------------------- */

/* It runs already, and serves for what was asked again. */
static bool runs(const judge *w, int number)
{
    size_t i = 0;
    while (i < w->n_jobs && w->jobs[i].number != number) {
        i++;
    }
    return i < w->n_jobs;
}

/* One that joined another has its number. */
void judge_job_began(judge *w, int number, grobo_job_kind kind)
{
    assert_true(number > 0);
    if (runs(w, number)) {
        assert_true(kind == GROBO_JOB_SENSE || kind == GROBO_JOB_MOVE || kind == GROBO_JOB_TORQUE);
        return;
    }
    assert_true(w->n_jobs < JUDGE_JOBS);
    w->jobs[w->n_jobs++] = (judge_job){.number = number, .kind = kind, .asked_us = w->rig->now_us};
}

void judge_motion_asked(judge *w)
{
    w->resting = false;
    w->rig->asked = true;
}

void judge_stop_asked(judge *w, grobo_joint_mask joints, bool smooth)
{
    w->resting = true;
    w->rig->asked = true; /* to bring to rest what moves by itself since the line is back */
    w->rest_joints = joints;
    w->smooth = smooth;
    w->rest_looked =
        w->by_estop; /* that takes as long as the line needs, and is judged at its end */
    w->rest_us = w->rig->now_us;
    judge_halts_asked(w); /* others may be stopped, too */
}

void judge_halts_asked(judge *w)
{
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        w->axes[j].halt_owed = w->rig->now_us < w->axes[j].to_us + FLIGHT_US;
        w->axes[j].halts_until_us = w->axes[j].halt_owed ? w->rig->now_us + FLIGHT_US : 0;
    }
}

void judge_raws_stopped(judge *w, bool all)
{
    for (int i = 0; i < JUDGE_RAWS; i++) {
        judge_raw *raw = &w->raws[i];
        if (raw->n > 0 && !raw->stale && (all || raw->moves)) {
            w->raws_void++;
            raw->stale = true;
        }
    }
}

static bool same(const judge_raw *raw, const uint8_t *bytes, size_t n)
{
    return raw->n == n && memcmp(raw->bytes, bytes, n) == 0;
}

/* The packet in a frame; NULL for a frame of the board's own. */
static const uint8_t *packet_of(const judge *w, const uint8_t *bytes)
{
    bool relays = bytes[0] == 0x53 || bytes[0] == 0x54;
    return grobo_driver_wiring(w->rig->driver) == GROBO_WIRING_BUS ? bytes
           : relays                                                ? bytes + 2
                                                                   : NULL;
}

static bool is_question(const judge *w, const uint8_t *bytes)
{
    const uint8_t *p = packet_of(w, bytes);
    return p != NULL && p[2] != 0 && p[6] == 0 && p[3] == GROBO_RS30X_WANT_GIVEN;
}

/* True if writing n bytes from an address on sets a goal or switches torque on. */
static bool write_moves(int address, const uint8_t *data, int n)
{
    int torque = GROBO_RS30X_TORQUE - address;
    bool on = torque >= 0 && torque < n && data[torque] == GROBO_TORQUE_ON;
    return on || (address <= GROBO_RS30X_GOAL_TIME + 1 && address + n > GROBO_RS30X_GOAL);
}

/* True for what a stop takes back; what the board does on its own nobody knows. */
static bool may_move(const judge *w, const uint8_t *bytes)
{
    const uint8_t *p = packet_of(w, bytes);
    bool moves = p == NULL;
    for (int i = 0; p != NULL && i < p[6]; i++) {
        moves |= p[2] == 0 ? write_moves(p[4], p + 8 + i * p[5], p[5] - 1)
                           : write_moves(p[4], p + 7, p[5]);
    }
    return moves;
}

void judge_raw_asked(judge *w, const uint8_t *bytes, size_t n, int result)
{
    if (result > 0) {
        judge_job_began(w, result, GROBO_JOB_RAW);
    }
    if (n > GROBO_FRAME_MAX_BYTES || is_question(w, bytes)) {
        return; /* the engine asks the same */
    }
    judge_raw *raw = &w->raws[w->n_raws++ % JUDGE_RAWS];
    *raw = (judge_raw){
        .job = result > 0 ? result : 0, .stale = result < 0, .moves = may_move(w, bytes), .n = n};
    memcpy(raw->bytes, bytes, n);
}

void judge_estop_asked(judge *w, int result)
{
    if (result < 0 && result != GROBO_ERR_CLOSED) {
        fail_msg("an emergency stop was refused: %s", grobo_error_name(result));
    }
    if (runs(w, result)) {
        return;
    }
    judge_raws_stopped(w, true);
    w->latched = w->by_estop = true;
    w->resting = false;               /* what follows is stricter */
    if (result <= 0 || !w->made_up) { /* else it joins the one that began with the line */
        w->estop_us = w->rig->now_us;
        w->estop_waits = result > 0;
    }
    w->made_up = w->made_up && result <= 0;
    if (result > 0) {
        judge_job_began(w, result, GROBO_JOB_ESTOP);
    }
}

void judge_exit_asked(judge *w, int number, grobo_exit_policy policy)
{
    if (runs(w, number)) {
        return;
    }
    judge_job_began(w, number, GROBO_JOB_EXIT);
    bool holds = policy == GROBO_EXIT_SIT && w->latched; /* a stopped robot does not sit down */
    w->jobs[w->n_jobs - 1].policy = holds ? GROBO_EXIT_HOLD : policy;
    judge_raws_stopped(w, true);
    judge_motion_asked(w);
    if (policy != GROBO_EXIT_SIT) {
        judge_stop_asked(w, rig_all(w->rig), true);
        w->rest_looked = true; /* its job takes as long as the line needs, and is judged then */
    }
}

void judge_reset_done(judge *w)
{
    w->latched = w->by_estop = w->estop_waits = false;
}

void judge_stalled(judge *w, int64_t us)
{
    w->rest_us += us;
    w->estop_us += us;
    for (size_t i = 0; i < w->n_jobs; i++) {
        w->jobs[i].asked_us += us;
    }
}

void judge_turned(judge *w, int joint, int64_t until_us)
{
    w->axes[joint].turned_us = until_us;
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* A raw frame leaves once it was accepted, and not after its job ended or somebody stopped.
 * @return whether this is one. */
static bool check_raw(const judge *w, const uint8_t *bytes, size_t n)
{
    bool is_stale = false;
    for (int i = 0; i < JUDGE_RAWS; i++) {
        if (same(&w->raws[i], bytes, n)) {
            if (!w->raws[i].stale) {
                return true;
            }
            is_stale = true;
        }
    }
    if (is_stale) {
        fail_msg("a raw frame leaves that was refused, ended or stopped");
    }
    return false;
}

/* How far from where it is a stop may send a joint: by what it does until the frame is there; where
 * a motion stops smoothly, by half of what the joint could do meanwhile. */
static double ahead_deg(const judge *w, int joint, const grobo_sim_view *view)
{
    const judge_axis *axis = &w->axes[joint];
    const grobo_joint *limits = &w->rig->driver->model->joints[joint];
    double most_dps = grobo_deg_from_rad(limits->max_speed_rad_s);
    bool asked = w->rig->now_us < axis->to_us + FLIGHT_US && axis->to_us > axis->from_us;
    double deg = view->moving ? view->speed_dps * AHEAD_S : 0;
    if (asked) {
        double asked_s = (double)(axis->to_us - axis->from_us) / 1e6;
        deg = fmax(deg, fabs(axis->to_deg - axis->from_deg) / asked_s * AHEAD_S);
    }
    if (asked || view->moving) {
        deg += most_dps * LATE_S;
    }
    return w->smooth && !axis->by_raw ? fmax(deg, most_dps * (SMOOTH_S / 2 + LATE_S)) : deg;
}

/* Of a robot that was stopped: goals may only bring it to rest where it is. */
static void check_rest(judge *w, int joint, int32_t ddeg)
{
    grobo_sim_view view = judge_view(w, joint);
    double here_deg = view.angle_mdeg / 1000.0;
    double way_deg = ddeg / 10.0 - here_deg;
    if (view.torque == GROBO_TORQUE_ON && fabs(way_deg) > AHEAD_DEG + ahead_deg(w, joint, &view) &&
        !judge_excused(w, joint)) {
        fail_msg("%s is sent from %.1f to %.1f deg after a stop", judge_name(w, joint), here_deg,
                 ddeg / 10.0);
    }
}

/* Of a joint in free mode: a person moves it, a goal may only hold it where it is. A joint that was
 * stopped on its way and then given to the person still gets the goal that stops it, and one for
 * each stop that was asked for at once. */
static void check_free(judge *w, int joint, int32_t ddeg)
{
    grobo_sim_view view = judge_view(w, joint);
    double way_deg = fabs(ddeg / 10.0 - view.angle_mdeg / 1000.0);
    bool is_free = (w->rig->robot.free_joints & GROBO_JOINT_BIT(joint)) != 0;
    bool halts = w->axes[joint].halt_owed || w->rig->now_us < w->axes[joint].halts_until_us;
    double may_deg = halts ? AHEAD_DEG + ahead_deg(w, joint, &view) : judge_hold_deg(w, joint);
    /* A stop may be for one that has lost its torque in a dip since it was read: it stays limp. */
    bool limp = halts && view.torque == GROBO_TORQUE_OFF;
    if (is_free && !w->resting && !limp && way_deg > may_deg && !judge_excused(w, joint)) {
        fail_msg("%s, in free mode, is sent to where it is not: %.1f deg", judge_name(w, joint),
                 way_deg);
    }
}

static void leaves_goal(judge *w, int joint, int32_t ddeg, int32_t time_cs)
{
    if (w->by_estop) {
        fail_msg("a goal of %s leaves after an emergency stop", judge_name(w, joint));
    }
    if (w->resting && !w->leaves_raw && (w->rest_joints & GROBO_JOINT_BIT(joint)) != 0) {
        check_rest(w, joint, ddeg);
    }
    check_free(w, joint, ddeg);
    w->axes[joint].halt_owed = false;
    w->axes[joint].by_raw = w->leaves_raw || (w->resting && w->axes[joint].by_raw);
    judge_goal_left(w, joint, ddeg, time_cs);
}

/* What is written to one servo, from an address on. */
static void leaves_write(judge *w, int id, int address, const uint8_t *data, int n)
{
    int joint = grobo_model_joint_of_motor(w->rig->driver->model, id);
    int goal = GROBO_RS30X_GOAL - address;
    int time = GROBO_RS30X_GOAL_TIME - address;
    int torque = GROBO_RS30X_TORQUE - address;
    if (joint >= 0 && goal >= 0 && goal + 2 <= n) {
        int32_t cs = time + 2 <= n ? data[time] | data[time + 1] << 8 : -1;
        leaves_goal(w, joint, (int16_t)(data[goal] | data[goal + 1] << 8), cs);
    }
    if (joint >= 0 && torque >= 0 && torque < n && data[torque] == GROBO_TORQUE_ON && w->latched) {
        fail_msg("torque of %s is switched on after a latched stop", judge_name(w, joint));
    }
}

static bool is_torque_off(const uint8_t *p)
{
    const uint8_t *first = p[2] == 0 ? p + 8 : p + 7;
    return p[4] == GROBO_RS30X_TORQUE && p[6] > 0 && *first != GROBO_TORQUE_ON;
}

static void check_estop_first(judge *w, const uint8_t *packet)
{
    if (!w->estop_waits) {
        return;
    }
    if (packet == NULL || !is_torque_off(packet)) {
        fail_msg("a frame leaves before the emergency stop");
    }
    assert_true(w->rig->now_us - w->estop_us <= ESTOP_FRAME_US);
    w->estop_waits = false;
}

/* How long a frame is on its way to the servos: the board takes it whole before it relays it. */
static int64_t wire_us(const judge *w, size_t n)
{
    bool relayed = grobo_driver_wiring(w->rig->driver) == GROBO_WIRING_BOARD;
    return (int64_t)(relayed ? 2 * n - GROBO_BOARD_HEADER_BYTES : n) * 10 * 1000000 / BAUD_BPS;
}

void judge_frame(judge *w, const uint8_t *bytes, size_t n)
{
    const uint8_t *p = packet_of(w, bytes);
    if (is_question(w, bytes)) {
        chronicle_asked(&w->notes, w->rig->now_us);
    } else {
        chronicle_frame(&w->notes, w->rig->now_us, bytes, n);
    }
    w->leaves_raw = check_raw(w, bytes, n);
    check_estop_first(w, p);
    w->wire_us = wire_us(w, n);
    if (p == NULL || p[6] == 0) {
        return;
    }
    if (p[2] != 0) {
        leaves_write(w, p[2], p[4], p + 7, p[5]);
        return;
    }
    for (int i = 0; i < p[6]; i++) {
        const uint8_t *entry = p + 7 + i * p[5];
        leaves_write(w, entry[0], p[4], entry + 1, p[5] - 1);
    }
}

/* ---- events ---------------------------------------------------------------------------------- */

static bool moves_on(judge *w, int joint)
{
    grobo_sim_view view = judge_view(w, joint);
    bool by_hand = w->rig->now_us < w->axes[joint].turned_us;
    return view.torque == GROBO_TORQUE_ON && view.moving && !by_hand &&
           fabs((view.target_mdeg - view.angle_mdeg) / 1000.0) > THERE_DEG;
}

/* All joints are without torque, or (still) with it and at rest. */
static void check_rests(judge *w, bool off, const char *after)
{
    for (int j = 0; j < w->rig->driver->model->n_joints; j++) {
        bool bad = off ? judge_view(w, j).torque == GROBO_TORQUE_ON : moves_on(w, j);
        if (bad && (w->rig->witness.misled & GROBO_JOINT_BIT(j)) == 0 &&
            !w->rig->witness.settings_hit) {
            fail_msg("%s %s after %s", judge_name(w, j), off ? "has torque" : "moves", after);
        }
    }
}

static void most(int64_t *worst_us, int64_t us)
{
    *worst_us = us > *worst_us ? us : *worst_us;
}

/* Only a line that goes, or another emergency stop, ends one before all joints have taken it; or
 * a servo that the line gave another id: it says itself that it was not reached. */
static void estop_ended(judge *w, const judge_job *job, int result)
{
    if (result == GROBO_OK) {
        check_rests(w, true, "an emergency stop");
        w->estops++;
        most(&w->estop_worst_us, w->rig->now_us - job->asked_us);
    } else if (result != GROBO_ERR_UNPLUGGED && result != GROBO_ERR_CANCELED &&
               !w->rig->witness.settings_hit) {
        fail_msg("an emergency stop ended with %s", grobo_error_name(result));
    }
}

static void exit_ended(judge *w, const judge_job *job, int result)
{
    bool off = job->policy == GROBO_EXIT_OFF || job->policy == GROBO_EXIT_SIT;
    if (result == GROBO_OK) {
        check_rests(w, off, "leaving");
        w->exits++;
    }
    most(&w->exit_worst_us, w->rig->now_us - job->asked_us);
}

static void job_ended(judge *w, const grobo_event_job *event)
{
    size_t i = 0;
    while (i < w->n_jobs && w->jobs[i].number != event->number) {
        i++;
    }
    judge_job job = {.number = event->number, .kind = event->kind, .asked_us = w->estop_us};
    if (i < w->n_jobs) {
        job = w->jobs[i];
        w->jobs[i] = w->jobs[--w->n_jobs];
    } else if (event->kind == GROBO_JOB_ESTOP && w->made_up) {
        w->made_up = false;
    } else {
        fail_msg("job %d ended that nobody asked for, or a second time", event->number);
    }
    if (job.kind != event->kind || strcmp(grobo_error_name(event->result), "UNKNOWN") == 0) {
        fail_msg("job %d of kind %d ended as kind %d with result %d", job.number, (int)job.kind,
                 (int)event->kind, event->result);
    }
    w->jobs_ended++;
    for (int k = 0; k < JUDGE_RAWS; k++) {
        w->raws[k].stale |= w->raws[k].job == job.number;
    }
    if (job.kind == GROBO_JOB_ESTOP) {
        estop_ended(w, &job, event->result);
    } else if (job.kind == GROBO_JOB_EXIT) {
        exit_ended(w, &job, event->result);
    }
}

static void tripped(judge *w, const grobo_trip_info *trip)
{
    grobo_trip_info now;
    grobo_robot_tripped(&w->rig->robot, &now);
    if (trip->trip == GROBO_TRIP_ESTOP || now.latched != trip->latched) {
        return; /* known since it was asked for; or reset by now */
    }
    w->latched |= trip->latched;
    if (trip->latched) {
        judge_raws_stopped(w, false);
    }
    if (trip->latched && grobo_robot_job(&w->rig->robot) != GROBO_JOB_EXIT) {
        judge_stop_asked(w, rig_all(w->rig), true);
    }
}

static void link_changed(judge *w, bool up)
{
    judge_lost_all(w);
    w->resting = false;
    w->made_up |= up && grobo_robot_job(&w->rig->robot) == GROBO_JOB_ESTOP;
    w->estop_waits = up && w->by_estop && w->made_up;
    w->estop_us = w->rig->now_us;
    for (int j = 0; up && j < GROBO_JOINTS_MAX; j++) {
        w->axes[j].parted = w->axes[j].sent = false; /* joints are read anew */
    }
}

void judge_event(judge *w, const grobo_event *event)
{
    grobo_joint_info info;
    int64_t now_us = w->rig->now_us;
    switch (event->kind) {
    case GROBO_EVENT_JOB:
        chronicle_note(&w->notes, now_us, "job %d ended: %s", event->u.job.number,
                       grobo_error_name(event->u.job.result));
        job_ended(w, &event->u.job);
        break;
    case GROBO_EVENT_JOINT:
        if (event->u.joint.result == GROBO_OK &&
            grobo_robot_joint(&w->rig->robot, event->u.joint.joint, &info) == 0) {
            w->axes[event->u.joint.joint].read_deg = grobo_deg_from_rad(info.state.angle_rad);
        }
        break;
    case GROBO_EVENT_TRIP:
        chronicle_note(&w->notes, now_us, "trip: %s", grobo_trip_name(event->u.trip.trip));
        tripped(w, &event->u.trip);
        break;
    case GROBO_EVENT_PLAY:
        chronicle_note(&w->notes, now_us, "play: %s", grobo_sequencer_state_name(event->u.play.to));
        break;
    case GROBO_EVENT_LINK_DOWN:
    case GROBO_EVENT_LINK_UP:
        chronicle_note(&w->notes, now_us, "line %s",
                       event->kind == GROBO_EVENT_LINK_UP ? "up" : "down");
        link_changed(w, event->kind == GROBO_EVENT_LINK_UP);
        break;
    case GROBO_EVENT_ROUND:
    case GROBO_EVENT_UNWATCHED:
    case GROBO_EVENT_SLOW_CALLBACK:
    case GROBO_EVENT_HALTED:
        break;
    }
}

void judge_sim(judge *w, const grobo_sim_event *event)
{
    judge_servo(w, event);
}

/* ---- bounds ---------------------------------------------------------------------------------- */

static int64_t bound_us(const judge_job *job)
{
    return job->kind == GROBO_JOB_ESTOP ? ESTOP_US : job->kind == GROBO_JOB_EXIT ? EXIT_US : JOB_US;
}

void judge_look(judge *w)
{
    int64_t now_us = w->rig->now_us;
    if (w->estop_waits && w->rig->back_us == 0 && now_us - w->estop_us > ESTOP_FRAME_US) {
        fail_msg("an emergency stop has not left after %lld us", (long long)(now_us - w->estop_us));
    }
    for (size_t i = 0; i < w->n_jobs; i++) {
        if (now_us - w->jobs[i].asked_us > bound_us(&w->jobs[i]) + 20000) {
            fail_msg("job %d of kind %d has not ended", w->jobs[i].number, (int)w->jobs[i].kind);
        }
    }
    if (w->resting && !w->rest_looked && now_us - w->rest_us > REST_US) {
        w->rest_looked = true;
        w->rests++;
        for (int j = 0; j < w->rig->driver->model->n_joints; j++) {
            bool stopped = (w->rest_joints & GROBO_JOINT_BIT(j)) != 0 && w->axes[j].sent;
            if (stopped && moves_on(w, j) && !judge_excused(w, j)) {
                fail_msg("%s moves %d ms after a stop", judge_name(w, j), REST_US / 1000);
            }
        }
    }
}

void judge_end(judge *w)
{
    if (w->n_jobs > 0) {
        fail_msg("job %d of kind %d never ended", w->jobs[0].number, (int)w->jobs[0].kind);
    }
}
