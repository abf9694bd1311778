/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

const grobo_robot_config quiet = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = GROBO_SENSE_NEVER};
grobo_wiring rig_wiring = GROBO_WIRING_BOARD;
int64_t rig_epoch_us = 1000000;

/* ---- what must always hold, judged on the frames themselves ---------------------------------- */

static int joint_of(const grobo_test_rig *rig, int id)
{
    return grobo_model_joint_of_motor(rig->driver->model, id);
}

static double along_deg(const rig_way *way, int64_t now_us)
{
    if (now_us >= way->to_us || way->to_us <= way->from_us) {
        return way->to_deg;
    }
    double part = (double)(now_us - way->from_us) / (double)(way->to_us - way->from_us);
    return way->from_deg + (way->to_deg - way->from_deg) * part;
}

/* A joint that is read to stand still so far beside its way has lost the frame of that way. The
 * engine draws the line at 12 degrees, and what it takes for the way is rounded: just below and
 * above that it may take either. */
static const double beside_deg[RIG_ASKED] = {11, 13};
/* Nor is it on it where it is read ahead of it, or, so long after the frame, before its begin. */
static const double before_deg[RIG_ASKED] = {-0.5, 0.5};
#define TURNED_US 200000
/* The servo's speed below which a joint stands still. */
#define SLOW_DPS 8

/* Of a joint that is not on a way, or has left it: restarted, or moved by a frame that nobody can
 * read. The next goal is judged from where the joint is. */
static void leave_ways(grobo_test_rig *rig, grobo_joint_mask joints)
{
    rig->on_way &= ~joints;
}

/* So far past an end of that part of its way that it should have gone by then. */
static double past_deg(const rig_way *way, double deg, double now_deg)
{
    double sign = now_deg < way->from_deg ? -1 : 1;
    return fmax((way->from_deg - deg) * sign, (deg - now_deg) * sign);
}

/* The way that a servo is on by itself, as far as it told. */
static rig_way own_way(grobo_test_rig *rig, int j, const grobo_joint_state *state)
{
    double deg = grobo_deg_from_rad(state->angle_rad);
    double most_rad_s = rig->driver->model->joints[j].max_speed_rad_s;
    double way_rad = fabs(state->goal_rad - state->angle_rad);
    int64_t left_us = state->goal_time_us - state->time_us;
    int64_t least_us = (int64_t)(way_rad / most_rad_s * 1e6);
    bool creeps = state->speed_dps != 0 && left_us > 0;
    bool moves = abs(state->speed_dps) >= SLOW_DPS || creeps;
    rig_way own = {deg, deg, rig->now_us, rig->now_us};
    if (!witness_told(&rig->witness, GROBO_RS30X_GOAL)) {
        own.to_deg = rig->own[j].to_us > rig->now_us ? rig->own[j].to_deg : deg;
        own.to_us = rig->own[j].to_us;
    } else if (state->torque == GROBO_TORQUE_ON && moves) {
        own.to_deg = grobo_deg_from_rad(state->goal_rad);
        own.to_us += left_us > least_us ? left_us : least_us;
    }
    return own;
}

/* A joint was read: is it on its ways? What was asked before the last frame left tells nothing of
 * what that frame does. */
static void look_for_ways(grobo_test_rig *rig, int j, const grobo_joint_state *state)
{
    double deg = grobo_deg_from_rad(state->angle_rad);
    int64_t asked_us = rig->witness.answered.since_us;
    bool slow = abs(state->speed_dps) < SLOW_DPS;
    if (asked_us < rig->told_us[j]) {
        return;
    }
    rig->own[j] = own_way(rig, j, state);
    for (int i = 0; witness_told(&rig->witness, GROBO_RS30X_SPEED) && i < RIG_ASKED; i++) {
        const rig_way *way = &rig->ways[j][i];
        double now_deg = along_deg(way, rig->now_us);
        double least_deg = fmin(fabs(deg - along_deg(way, asked_us)), fabs(deg - now_deg));
        bool turned = asked_us - rig->told_us[j] > TURNED_US;
        bool past = turned && past_deg(way, deg, now_deg) > before_deg[i];
        rig->off[j][i] = (slow || past) && least_deg > beside_deg[i];
    }
    if (witness_told(&rig->witness, GROBO_RS30X_GOAL)) {
        rig->own_told |= GROBO_JOINT_BIT(j);
    }
}

/* How far a joint is sent, from where it is or from where it should be on its ways, whatever is
 * nearest: a frame may have been lost. Of a joint without a way only the first is true. */
static double least_way_deg(grobo_test_rig *rig, int j, double to_deg, int64_t time_us)
{
    double here_deg = rig_angle_deg(rig, j);
    bool on_way = (rig->on_way & GROBO_JOINT_BIT(j)) != 0;
    bool told = (rig->own_told & GROBO_JOINT_BIT(j)) != 0;
    bool loose = (rig->loose & GROBO_JOINT_BIT(j)) != 0;
    double least_deg = fabs(to_deg - here_deg);
    if (on_way) {
        double way_deg = along_deg(&rig->ways[j][RIG_ASKED], rig->now_us);
        least_deg = fmin(least_deg, fabs(to_deg - way_deg));
    }
    for (int i = 0; i < RIG_WAYS; i++) {
        bool off = i < RIG_ASKED ? rig->off[j][i] : told;
        const rig_way *way = off ? &rig->own[j] : &rig->ways[j][i];
        bool here = !on_way || (loose && i == RIG_ASKED);
        double from_deg = here ? here_deg : along_deg(way, rig->now_us);
        least_deg = fmin(least_deg, fabs(to_deg - from_deg));
        rig->ways[j][i] = (rig_way){from_deg, to_deg, rig->now_us, rig->now_us + time_us};
    }
    memset(rig->off[j], 0, sizeof rig->off[j]);
    rig->own[j].to_us = rig->now_us;
    rig->on_way |= GROBO_JOINT_BIT(j);
    rig->own_told &= ~GROBO_JOINT_BIT(j);
    rig->loose &= ~GROBO_JOINT_BIT(j);
    return least_deg;
}

/* The line made up what this joint was told or said, and its sum was right; or it holds again after
 * a restart that nobody saw: not the engine's fault what came of it. */
static bool excused(grobo_test_rig *rig, int j)
{
    bool misled =
        (rig->witness.misled & GROBO_JOINT_BIT(j)) != 0 || witness_restarted(&rig->witness, j);
    rig->excused += misled;
    return misled;
}

static void check_goal(grobo_test_rig *rig, int id, const uint8_t *data)
{
    int j = joint_of(rig, id);
    assert_true(j >= 0);
    const grobo_joint *joint = &rig->driver->model->joints[j];
    double deg = (int16_t)(data[0] | data[1] << 8) / 10.0;
    int64_t time_us = (data[2] | data[3] << 8) * 10000LL;
    if (deg < grobo_deg_from_rad(joint->min_rad) - 0.05001 ||
        deg > grobo_deg_from_rad(joint->max_rad) + 0.05001) {
        fail_msg("%s sent to %.1f deg, outside its limits", joint->name, deg);
    }
    bool holds = rig_torque(rig, j) != GROBO_TORQUE_ON;
    double most_dps = grobo_deg_from_rad(joint->max_speed_rad_s);
    double way_deg = least_way_deg(rig, j, deg, time_us) - 0.2;
    if (!holds && way_deg > most_dps * 1.02 * (double)time_us / 1e6 && !excused(rig, j)) {
        fail_msg("%s sent %.1f deg in %lld us", joint->name, way_deg, (long long)time_us);
    }
}

static void check_torque(grobo_test_rig *rig, int id, int value)
{
    int j = joint_of(rig, id);
    assert_true(j >= 0 && value <= 2);
    if (value != GROBO_TORQUE_ON) {
        rig->loose |= GROBO_JOINT_BIT(j); /* where a hand has it, or on its way if this is lost */
    }
    if (value != GROBO_TORQUE_ON || rig_torque(rig, j) == GROBO_TORQUE_ON) {
        return;
    }
    rig->torque_on++;
    int32_t goal = 0;
    assert_int_equal(grobo_sim_get_register(&rig->sim, j, GROBO_RS30X_GOAL, &goal), 0);
    double apart_deg = fabs(goal / 10.0 - rig_angle_deg(rig, j));
    if (apart_deg > 3.6 && !rig->judged && !witness_restarted(&rig->witness, j) &&
        !excused(rig, j)) {
        fail_msg("torque of %s comes on %.1f deg from its goal", rig->driver->model->joints[j].name,
                 apart_deg);
    }
}

/* After an emergency stop nothing moves and nothing is switched on, after a line is back not
 * before somebody asks. */
static void check_may_move(const grobo_test_rig *rig, bool switches_on)
{
    grobo_trip_info trip;
    grobo_robot_tripped(&rig->robot, &trip);
    assert_true(rig->asked);
    assert_false(trip.trip == GROBO_TRIP_ESTOP && !rig->halts_at_estop);
    assert_false(switches_on && trip.latched);
}

static void check_write(grobo_test_rig *rig, int id, int address, const uint8_t *data, int n)
{
    if (joint_of(rig, id) >= 0) {
        rig->told_us[joint_of(rig, id)] = rig->now_us;
    }
    if (address == GROBO_RS30X_GOAL && n >= 4) {
        check_may_move(rig, false);
        check_goal(rig, id, data);
    } else if (address == GROBO_RS30X_TORQUE) {
        if (data[0] == GROBO_TORQUE_ON) {
            check_may_move(rig, true);
        }
        check_torque(rig, id, data[0]);
        rig->torque_us = rig->now_us;
    }
}

static void check_packet(grobo_test_rig *rig, const uint8_t *p, size_t n)
{
    uint8_t sum = 0;
    assert_true(n >= 8 && p[0] == 0xFA && p[1] == 0xAF);
    for (size_t i = 2; i < n; i++) {
        sum ^= p[i];
    }
    assert_int_equal(sum, 0);
    witness_sent(&rig->witness, p, n, rig->robot.bus.active, rig->now_us);
    if (p[2] == 0) {
        for (int i = 0; i < p[6]; i++) {
            const uint8_t *entry = p + 7 + i * p[5];
            check_write(rig, entry[0], p[4], entry + 1, p[5] - 1);
        }
    } else if (p[6] == 1) {
        check_write(rig, p[2], p[4], p + 7, p[5]);
    } else if (p[3] >= GROBO_RS30X_FACTORY) {
        int j = joint_of(rig, p[2]);
        leave_ways(rig, j >= 0 ? GROBO_JOINT_BIT(j) : rig_all(rig));
    }
}

static void check_frame(grobo_test_rig *rig, const uint8_t *bytes, size_t n)
{
    if (grobo_driver_wiring(rig->driver) == GROBO_WIRING_BUS) {
        check_packet(rig, bytes, n);
    } else if (bytes[0] == 0x53 || bytes[0] == 0x54) {
        check_packet(rig, bytes + 2, n - 2 - (bytes[0] == 0x54));
    } else if (bytes[0] == 0x50) {
        leave_ways(rig, rig_all(rig)); /* a motion of the board's own */
    }
}

/* No reading is another joint's, another time's, or nobody's. */
static void check_reading(grobo_test_rig *rig, const grobo_event_joint *event)
{
    grobo_joint_info info;
    if (event->result != GROBO_OK || rig->robot.config.readback_correction) {
        return; /* nothing was read, or it is not what was said */
    }
    assert_int_equal(grobo_robot_joint(&rig->robot, event->joint, &info), 0);
    witness_believed(&rig->witness, event->joint, &info.state, rig->now_us);
    look_for_ways(rig, event->joint, &info.state);
}

static void note_event(void *ctx, const grobo_event *event)
{
    grobo_test_rig *rig = ctx;
    assert_true(event->now_us == rig->now_us); /* the time of the call that made it */
    if (rig->n_events < RIG_EVENTS) {
        rig->events[rig->n_events++] = *event;
    }
    if (event->kind == GROBO_EVENT_JOINT) {
        check_reading(rig, &event->u.joint);
    }
    if (rig->on_event != NULL) {
        rig->on_event(rig, event);
    }
}

static void note_sim(void *ctx, const grobo_sim_event *event)
{
    grobo_test_rig *rig = ctx;
    witness_heard(&rig->witness, event);
    if (rig->on_sim != NULL) {
        rig->on_sim(rig, event);
    }
}

/* ---- the pump ---------------------------------- */

static int64_t rig_clock(void *ctx)
{
    const grobo_test_rig *rig = ctx;
    return rig->now_us;
}

void rig_host(grobo_test_rig *rig)
{
    const grobo_robot_host host = {.clock = rig_clock, .ctx = rig};
    grobo_robot_set_host(&rig->robot, &host);
}

void rig_start_driver(grobo_test_rig *rig, const grobo_driver *driver,
                      const grobo_robot_config *config, const grobo_sim_config *sim)
{
    grobo_sim_config sim_config = {GROBO_SIM_CONFIG_INIT};
    memset(rig, 0, sizeof *rig);
    if (sim != NULL) {
        sim_config = *sim;
    }
    if (sim_config.model == NULL) {
        sim_config.model = driver->model;
    }
    sim_config.wiring = grobo_driver_wiring(driver);
    sim_config.hook = note_sim;
    sim_config.hook_ctx = rig;
    rig->driver = driver;
    rig->now_us = rig->wake_us = rig_epoch_us;
    rig->asked = true;
    witness_init(&rig->witness, driver->model, &rig->sim, &rig->robot.bus);
    assert_int_equal(grobo_sim_init(&rig->sim, &sim_config, rig->now_us), 0);
    assert_int_equal(grobo_robot_init(&rig->robot, driver, NULL, config, rig->now_us), 0);
    rig_host(rig);
    grobo_robot_on_event(&rig->robot, note_event, rig);
    grobo_robot_link_up(&rig->robot, rig->now_us);
}

void rig_start(grobo_test_rig *rig, const grobo_robot_config *config, const grobo_sim_config *sim)
{
    rig_start_driver(rig, grobo_gr001_driver(rig_wiring), config, sim);
}

static void send_all(grobo_test_rig *rig)
{
    uint8_t buf[GROBO_RS30X_PACKET_MAX_BYTES];
    int n;
    while ((n = grobo_robot_tx(&rig->robot, buf, sizeof buf, rig->now_us)) > 0) {
        if (rig->n_sent < RIG_SENT) {
            rig_frame *frame = &rig->sent[rig->n_sent++];
            frame->at_us = rig->now_us;
            frame->size = (uint8_t)n;
            memcpy(frame->bytes, buf, (size_t)n);
        }
        rig->frames++;
        check_frame(rig, buf, (size_t)n);
        if (rig->lose > 0) {
            rig->lose--;
            continue;
        }
        assert_int_equal(grobo_sim_rx(&rig->sim, buf, (size_t)n, rig->now_us), n);
        if (rig->on_frame != NULL) {
            rig->on_frame(rig, buf, (size_t)n);
        }
    }
    assert_true(n == 0);
}

static void pump(grobo_test_rig *rig)
{
    uint8_t buf[64];
    size_t n;
    if (rig->now_us < rig->wake_us) {
        grobo_sim_step(&rig->sim, rig->now_us);
        return;
    }
    while ((n = grobo_sim_tx(&rig->sim, buf, sizeof buf, rig->now_us)) > 0) {
        witness_arrived(&rig->witness, buf, n, rig->now_us);
        grobo_robot_rx(&rig->robot, buf, n, rig->now_us);
    }
    if (grobo_sim_hung_up(&rig->sim) && rig->back_us == 0) {
        grobo_robot_link_down(&rig->robot, rig->now_us);
        rig->back_us = rig->replug_us == 0 ? GROBO_NEVER_US : rig->now_us + rig->replug_us;
    } else if (rig->back_us != 0 && rig->now_us >= rig->back_us) {
        rig->back_us = 0;
        rig->asked = false;
        leave_ways(rig, rig_all(rig)); /* what was asked before may have been lost with it */
        grobo_sim_plug(&rig->sim, true, rig->now_us);
        grobo_robot_link_up(&rig->robot, rig->now_us);
    }
    grobo_robot_step(&rig->robot, rig->now_us);
    send_all(rig);
}

static int64_t next_us(const grobo_test_rig *rig, int64_t until_us)
{
    int64_t at_us = grobo_robot_deadline(&rig->robot, rig->now_us);
    int64_t sim_us = grobo_sim_deadline(&rig->sim);
    at_us = sim_us < at_us ? sim_us : at_us;
    at_us = rig->back_us != 0 && rig->back_us < at_us ? rig->back_us : at_us;
    at_us = at_us < rig->wake_us ? rig->wake_us : at_us;
    return at_us < until_us ? at_us : until_us;
}

void rig_run(grobo_test_rig *rig, int64_t us)
{
    int64_t until_us = rig->now_us + us;
    int idle = 0;
    pump(rig);
    while (rig->now_us < until_us) {
        int64_t at_us = next_us(rig, until_us);
        idle = at_us > rig->now_us ? 0 : idle + 1;
        assert_true(idle < 1000); /* a deadline that is never met spins */
        rig->now_us = at_us > rig->now_us ? at_us : rig->now_us;
        pump(rig);
    }
}

void rig_stall(grobo_test_rig *rig, int64_t us)
{
    rig->wake_us = rig->now_us + us;
    rig_run(rig, us);
}

/* ---- waiting and looking ---------------------------------- */

static const grobo_event_job *find_job(const grobo_test_rig *rig, int number)
{
    for (size_t i = 0; i < rig->n_events; i++) {
        if (rig->events[i].kind == GROBO_EVENT_JOB && rig->events[i].u.job.number == number) {
            return &rig->events[i].u.job;
        }
    }
    return NULL;
}

const grobo_event_job *rig_wait(grobo_test_rig *rig, int number)
{
    assert_true(number > 0);
    int64_t until_us = rig->now_us + 60000000;
    while (find_job(rig, number) == NULL && rig->now_us < until_us) {
        rig_run(rig, 1000);
    }
    const grobo_event_job *job = find_job(rig, number);
    assert_non_null(job);
    return job;
}

const grobo_event_job *rig_expect(grobo_test_rig *rig, int number, int result)
{
    const grobo_event_job *job = rig_wait(rig, number);
    if (job->result != result) {
        fail_msg("job %d of kind %d ended with %s (joint %d), not %s", job->number, (int)job->kind,
                 grobo_error_name(job->result), job->joint, grobo_error_name(result));
    }
    return job;
}

void rig_wait_play(grobo_test_rig *rig, grobo_sequencer_state state)
{
    int64_t until_us = rig->now_us + 120000000;
    while (grobo_robot_play_state(&rig->robot) != state && rig->now_us < until_us) {
        rig_run(rig, 1000);
    }
    assert_int_equal(grobo_robot_play_state(&rig->robot), state);
}

const grobo_event *rig_last(const grobo_test_rig *rig, grobo_event_kind kind)
{
    for (size_t i = rig->n_events; i > 0; i--) {
        if (rig->events[i - 1].kind == kind) {
            return &rig->events[i - 1];
        }
    }
    return NULL;
}

size_t rig_count(const grobo_test_rig *rig, grobo_event_kind kind)
{
    size_t n = 0;
    for (size_t i = 0; i < rig->n_events; i++) {
        n += rig->events[i].kind == kind;
    }
    return n;
}

void rig_forget(grobo_test_rig *rig)
{
    rig->n_events = rig->n_sent = 0;
}

double rig_angle_deg(grobo_test_rig *rig, int joint)
{
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&rig->sim, joint, &view), 0);
    return view.angle_mdeg / 1000.0;
}

grobo_torque rig_torque(grobo_test_rig *rig, int joint)
{
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&rig->sim, joint, &view), 0);
    return view.torque;
}

grobo_joint_mask rig_all(const grobo_test_rig *rig)
{
    return GROBO_JOINTS_ALL(rig->driver->model->n_joints);
}

void rig_power(grobo_test_rig *rig)
{
    rig_expect(rig, grobo_robot_torque(&rig->robot, rig_all(rig), GROBO_TORQUE_ON), GROBO_OK);
}

grobo_posture rig_posture(const grobo_test_rig *rig, int joint, double angle_deg, int time_ms)
{
    grobo_posture posture;
    assert_int_equal(grobo_posture_init(&posture, rig->driver->model->n_joints), 0);
    assert_int_equal(grobo_posture_set_deg(&posture, joint, angle_deg), 0);
    posture.time_us = time_ms * 1000LL;
    return posture;
}

size_t rig_packet(const rig_frame *frame, const uint8_t **packet)
{
    size_t ahead = frame->bytes[0] == 0x53 || frame->bytes[0] == 0x54 ? 2 : 0;
    *packet = frame->bytes + ahead;
    return frame->size - ahead - (frame->bytes[0] == 0x54);
}

bool rig_packet_was_sent(const grobo_test_rig *rig, const void *bytes, size_t size)
{
    for (size_t i = 0; i < rig->n_sent; i++) {
        const uint8_t *packet;
        if (rig_packet(&rig->sent[i], &packet) == size && memcmp(packet, bytes, size) == 0) {
            return true;
        }
    }
    return false;
}

int rig_sent_ms(const grobo_test_rig *rig, int id)
{
    for (size_t i = rig->n_sent; i > 0; i--) {
        const uint8_t *p;
        size_t n = rig_packet(&rig->sent[i - 1], &p);
        if (n == 12 && p[2] == id && p[4] == GROBO_RS30X_GOAL) {
            return (p[9] | p[10] << 8) * 10;
        }
    }
    return -1;
}

void rig_start_narrow(grobo_test_rig *rig)
{
    static grobo_joint joints[GROBO_JOINTS_MAX];
    static grobo_model model = GROBO_TABLE_INIT(grobo_model);
    static grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .model = &grobo_i_gr001_model};
    model = grobo_i_gr001_model;
    memcpy(joints, model.joints, (size_t)model.n_joints * sizeof *joints);
    joints[NECK].max_rad = grobo_rad_from_deg(20);
    model.joints = joints;
    driver = *grobo_gr001_driver(GROBO_WIRING_BOARD);
    driver.model = &model;
    rig_start_driver(rig, &driver, &quiet, &sim);
}

/* ---- clips ---------------------------------- */

static int clip_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    const rig_clip *clip = ctx;
    const rig_key *key = &clip->keys[i];
    grobo_posture_init_pose(posture, &grobo_i_gr001_model);
    for (int k = 0; k < 3 && (k == 0 || key->to[k].joint != 0 || key->to[k].angle_deg != 0); k++) {
        posture->angle_rad[key->to[k].joint] = grobo_rad_from_deg(key->to[k].angle_deg);
    }
    posture->set = clip->only != 0 ? clip->only : posture->set;
    *at_us = key->at_ms * 1000;
    posture->time_us = i == 0 ? 0 : *at_us - clip->keys[i - 1].at_ms * 1000;
    return 0;
}

static int clip_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    const rig_clip *clip = ctx;
    size_t i = 1;
    while (i + 1 < clip->clip.n_keys && clip->keys[i].at_ms * 1000 < t_us) {
        i++;
    }
    grobo_posture a;
    int64_t from_us;
    int64_t to_us;
    (void)clip_key(ctx, i - 1, &a, &from_us);
    (void)clip_key(ctx, i, posture, &to_us);
    double part = fmin(fmax((double)(t_us - from_us) / (double)(to_us - from_us), 0), 1);
    for (int j = 0; j < posture->n_joints; j++) {
        posture->angle_rad[j] = a.angle_rad[j] + (posture->angle_rad[j] - a.angle_rad[j]) * part;
    }
    return 0;
}

void rig_clip_init(rig_clip *clip, const rig_key *keys, size_t n)
{
    memset(clip, 0, sizeof *clip);
    clip->keys = keys;
    clip->clip.key = clip_key;
    clip->clip.sample = clip_sample;
    clip->clip.ctx = clip;
    clip->clip.n_keys = n;
    clip->clip.n_joints = grobo_i_gr001_model.n_joints;
    clip->clip.length_us = keys[n - 1].at_ms * 1000;
}

/* ---- both wirings ---------------------------------- */

static int on_the_board(void)
{
    rig_wiring = GROBO_WIRING_BOARD;
    return 0;
}

static int on_a_bus(void)
{
    rig_wiring = GROBO_WIRING_BUS;
    return 0;
}

const test_fixture rig_wirings[2] = {{"on the board", on_the_board, NULL},
                                     {"on a bus", on_a_bus, on_the_board}};

void rig_start_at(grobo_test_rig *rig, double deg, const grobo_robot_config *config)
{
    rig_start(rig, config, NULL);
    rig_power(rig);
    grobo_posture target = rig_posture(rig, NECK, deg, 1000);
    rig_expect(rig, grobo_robot_move(&rig->robot, &target), GROBO_OK);
    rig_forget(rig);
}
