/* SPDX-License-Identifier: MIT */
/* Life, pump and link of the engine. */
#include <math.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "src/base/instant.h"
#include "src/base/sized.h"
#include "src/robot/axis.h"
#include "src/robot/blocked.h"
#include "src/robot/gate.h"
#include "src/robot/halted.h"
#include "src/robot/job.h"
#include "src/robot/lines.h"
#include "src/robot/play.h"
#include "src/robot/query.h"
#include "src/robot/queue.h"
#include "src/robot/request.h"
#include "src/robot/robot.h"
#include "src/robot/segments.h"
#include "src/robot/sense.h"
#include "src/robot/speed.h"
#include "src/robot/stand.h"
#include "src/robot/state.h"
#include "src/robot/trip.h"
#include "src/robot/turn.h"
#include "src/robot/wheel.h"

#define STALL_US 250000
#define EXIT_BOUND_US 10000000
#define SENSE_INTERVAL_US 1000000
#define RETRIES 2

/* ---- configuration --------------------------------------------------------------------------- */

static bool choices_sound(const grobo_robot_config *c)
{
    return (c->limit_policy == GROBO_LIMIT_REFUSE || c->limit_policy == GROBO_LIMIT_CLAMP) &&
           (c->estop_torque == GROBO_ESTOP_BRAKE || c->estop_torque == GROBO_ESTOP_OFF) &&
           (unsigned)c->on_exit <= GROBO_EXIT_SIT && (unsigned)c->goals <= GROBO_GOALS_SEGMENTS;
}

static bool config_sound(const grobo_robot_config *c)
{
    bool speeds = c->speed_limit_pct >= 0 && c->speed_limit_pct <= 100 &&
                  isfinite(c->approach_dps) && c->approach_dps >= 0;
    bool times = c->sense_interval_us >= GROBO_SENSE_NEVER && c->stall_us >= 0 &&
                 c->default_time_us >= 0 && c->default_time_us <= GROBO_PLAY_TIME_MAX_US &&
                 c->exit_bound_us >= 0;
    return choices_sound(c) && speeds && times && c->retries >= -1 && c->retries <= UINT8_MAX;
}

/* A limit: 0 is the driver's, less is none (0 from here on). */
static int limit_or(int value, int other)
{
    return value == 0 ? other : value < 0 ? 0 : value;
}

static int64_t time_or(int64_t value_us, int64_t other_us)
{
    return value_us == 0 ? other_us : value_us;
}

static void config_fill(grobo_robot_config *c, const grobo_driver *driver)
{
    const grobo_safety_limits *limits = &driver->limits;
    c->speed_limit_pct = c->speed_limit_pct == 0 ? 100 : c->speed_limit_pct;
    if (c->approach_dps <= 0) {
        c->approach_dps = grobo_deg_from_rad(limits->approach_rad_s);
    }
    c->sense_interval_us = time_or(c->sense_interval_us, SENSE_INTERVAL_US);
    c->sense_interval_us = grobo_i_sooner(c->sense_interval_us, GROBO_NEVER_US / 4);
    c->temperature_c = limit_or(c->temperature_c, limits->temperature_c);
    c->current_ma = limit_or(c->current_ma, limits->current_ma);
    c->voltage_mv = limit_or(c->voltage_mv, limits->voltage_mv);
    c->lost_replies = limit_or(c->lost_replies, limits->lost_replies);
    c->stall_us = time_or(c->stall_us, STALL_US);
    c->default_time_us = time_or(c->default_time_us, GROBO_POSTURE_TIME_US);
    c->exit_bound_us = time_or(c->exit_bound_us, EXIT_BOUND_US);
    c->on_exit = c->on_exit == GROBO_EXIT_DEFAULT ? driver->on_exit : c->on_exit;
    c->retries = c->retries == 0 ? RETRIES : c->retries < 0 ? 0 : c->retries;
    c->bus.protocol = driver->protocol;
}

static int config_take(grobo_robot_config *to, const grobo_robot_config *from)
{
    int result = grobo_i_sized_take(to, sizeof *to, from);
    return result < 0 || config_sound(to) ? result : GROBO_ERR_ARG;
}

size_t grobo_i_robot_bytes(const grobo_driver *driver)
{
    return offsetof(grobo_robot, axes) + driver->model->n_joints * sizeof(grobo_robot_axis);
}

int grobo_robot_init_sized(grobo_robot *robot, size_t robot_bytes, const grobo_driver *driver,
                           void *driver_ctx, const grobo_robot_config *config, int64_t now_us)
{
    grobo_robot_config taken;
    int sound = robot != NULL ? grobo_driver_check(driver) : GROBO_ERR_ARG;
    if (sound < 0) {
        return sound;
    }
    if (config_take(&taken, config) < 0 ||
        (robot_bytes != sizeof *robot && robot_bytes != grobo_i_robot_bytes(driver))) {
        return GROBO_ERR_ARG;
    }
    memset(robot, 0, robot_bytes);
    robot->driver = driver;
    robot->job = robot->jobs;
    robot->driver_ctx = driver_ctx;
    robot->leave = grobo_i_gate_leave;
    robot->over = grobo_i_frame_over;
    robot->each = grobo_i_reply_came;
    robot->config = taken;
    config_fill(&robot->config, driver);
#if GROBO_LINES_MAX > 1
    if (grobo_i_lines_init(robot) < 0) {
        return GROBO_ERR_ARG;
    }
#else
    if (grobo_bus_init(&robot->bus, &robot->config.bus) < 0) {
        return GROBO_ERR_ARG;
    }
#endif
    robot->renew_us = GROBO_SEGMENT_RENEW_US;
    grobo_sequencer_init(&robot->sequencer, driver->model);
    for (int j = 0; j < driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        axis->angle_us = axis->full_us = axis->goal_us = GROBO_NEVER_US;
        axis->seen_dps = GROBO_I_NO_SPEED;
        grobo_i_stand_forget(axis);
        axis->current_since_us = axis->before_us = GROBO_NEVER_US;
        grobo_i_blocked_forget(robot, j);
        axis->status = GROBO_ERR_EMPTY;
        if (!GROBO_DRIVERS_PLAIN && grobo_i_joint_follows(driver->model, j)) {
            robot->followers |= GROBO_JOINT_BIT(j);
        }
#if !GROBO_DRIVERS_PLAIN
        robot->wheels |= grobo_i_joint_is_wheel(driver->model, j) ? GROBO_JOINT_BIT(j) : 0;
        axis->stalled_us = GROBO_NEVER_US;
#endif
    }
    robot->trip.joint = robot->fault_joint = -1;
    robot->now_us = robot->sense_us = now_us;
    grobo_i_gate_soften(robot);
    return GROBO_OK;
}

void grobo_robot_on_event(grobo_robot *robot, grobo_event_fn on_event, void *ctx)
{
    if (robot == NULL) {
        return;
    }
    robot->on_event = on_event;
    robot->event_ctx = ctx;
}

void grobo_robot_set_host(grobo_robot *robot, const grobo_robot_host *host)
{
    if (robot != NULL) {
        robot->host = host != NULL ? *host : (grobo_robot_host){.ctx = NULL};
    }
}

int grobo_i_robot_configure(grobo_robot *robot, const grobo_robot_config *config, bool senses)
{
    grobo_robot_config taken;
    if (config_take(&taken, config) < 0) {
        return GROBO_ERR_ARG;
    }
    if (!senses) {
        taken.sense_interval_us = GROBO_SENSE_NEVER;
    }
    grobo_i_lock(robot);
    grobo_bus_config bus = robot->config.bus;
    robot->config = taken;
    config_fill(&robot->config, robot->driver);
    robot->config.bus = bus; /* the line stays what it is */
    grobo_i_unlock(robot);
    return GROBO_OK;
}

int grobo_robot_configure(grobo_robot *robot, const grobo_robot_config *config)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    int result = grobo_i_robot_configure(robot, config, true);
    if (result >= 0 && robot->host.wake != NULL) {
        robot->host.wake(robot->host.ctx); /* readings may be due sooner */
    }
    return result;
}

static void tell_kind(grobo_robot *robot, grobo_event_kind kind)
{
    grobo_event event = {.kind = kind};
    grobo_i_tell(robot, &event);
}

/* ---- pump ------------------------------------------------------------------------------------ */

static inline void rx(grobo_robot *robot, int line, const uint8_t *bytes, size_t size,
                      int64_t now_us)
{
    if (robot == NULL || (bytes == NULL && size > 0)) {
        return;
    }
    grobo_i_enter(robot, now_us);
    if (robot->link) {
        grobo_bus_rx(grobo_i_bus(robot, line), bytes, size, robot->now_us);
    }
    grobo_i_leave(robot);
}

void grobo_robot_rx(grobo_robot *robot, const uint8_t *bytes, size_t size, int64_t now_us)
{
    rx(robot, 0, bytes, size, now_us);
}

/* Frames are judged in here, and what is refused may end a job. Events of that wait for the next
 * step: a callback must not come between this frame and its trajectory to the line. */
static inline int tx(grobo_robot *robot, int line, uint8_t *buf, size_t capacity, int64_t now_us)
{
    grobo_i_lock(robot);
    if (now_us > robot->now_us) {
        robot->now_us = now_us;
    }
    int size =
        robot->link ? grobo_bus_tx(grobo_i_bus(robot, line), buf, capacity, robot->now_us) : 0;
    if (size > 0) {
        *grobo_i_left_us(robot, line) = robot->now_us;
        *grobo_i_answered(robot, line) = false;
    }
    if (robot->queue_may_go) { /* a job has ended, with what was refused */
        grobo_i_jobs_close_up(robot);
    }
    grobo_i_unlock(robot);
    return size;
}

int grobo_robot_tx(grobo_robot *robot, uint8_t *buf, size_t capacity, int64_t now_us)
{
    return robot == NULL || buf == NULL ? GROBO_ERR_ARG : tx(robot, 0, buf, capacity, now_us);
}

#if GROBO_LINES_MAX > 1
static bool is_line(const grobo_robot *robot, int line)
{
    return robot != NULL && line >= 0 && line < grobo_i_lines(robot);
}

void grobo_robot_line_rx(grobo_robot *robot, int line, const uint8_t *bytes, size_t size,
                         int64_t now_us)
{
    if (is_line(robot, line)) {
        rx(robot, line, bytes, size, now_us);
    }
}

int grobo_robot_line_tx(grobo_robot *robot, int line, uint8_t *buf, size_t capacity, int64_t now_us)
{
    if (buf == NULL || !is_line(robot, line)) {
        return GROBO_ERR_ARG;
    }
    bool gone = (robot->lines_gone & 1u << line) != 0;
    return gone ? 0 : tx(robot, line, buf, capacity, now_us);
}
#endif

static void step(grobo_robot *robot)
{
    grobo_bus_step(&robot->bus, robot->now_us);
#if GROBO_LINES_MAX > 1
    if (robot->lines != NULL) {
        grobo_i_lines_step(robot);
    }
#endif
    grobo_i_segments_step(robot);
    grobo_i_wheels_step(robot);
    grobo_i_play_step(robot);
    grobo_i_play_reserve(robot);
    grobo_i_job_run(robot);
    grobo_i_queue_step(robot);
    grobo_i_halted_step(robot);
    grobo_i_sense_step(robot);
}

void grobo_robot_step(grobo_robot *robot, int64_t now_us)
{
    if (robot == NULL) {
        return;
    }
    grobo_i_enter(robot, now_us);
    if (robot->link) {
        step(robot);
    }
    grobo_i_leave(robot);
}

void grobo_robot_rx_step(grobo_robot *robot, const uint8_t *bytes, size_t size, int64_t now_us)
{
    if (robot == NULL || (bytes == NULL && size > 0)) {
        return;
    }
    grobo_i_enter(robot, now_us);
    if (robot->link) {
        grobo_bus_rx(&robot->bus, bytes, size, robot->now_us);
        step(robot);
    }
    grobo_i_leave(robot);
}

static int64_t deadline(const grobo_robot *robot, int64_t now_us)
{
    if (!robot->link) {
        return GROBO_NEVER_US;
    }
    if (robot->events_n > 0 || robot->told_state != grobo_sequencer_get_state(&robot->sequencer)) {
        return now_us; /* to be told by the next step */
    }
    int64_t at_us = grobo_bus_deadline(&robot->bus, now_us);
#if GROBO_LINES_MAX > 1
    if (robot->lines != NULL) {
        at_us = grobo_i_sooner(at_us, grobo_i_lines_deadline(robot, now_us));
    }
#endif
    at_us = grobo_i_sooner(at_us, grobo_sequencer_deadline(&robot->sequencer));
    at_us = grobo_i_sooner(at_us, grobo_i_segments_deadline(robot));
    if (grobo_i_wheels(robot) != 0) {
        at_us = grobo_i_sooner(at_us, grobo_i_wheels_deadline(robot));
    }
    at_us = grobo_i_sooner(at_us, grobo_i_job_deadline(robot));
    at_us = grobo_i_sooner(at_us, grobo_i_queue_deadline(robot));
    at_us = grobo_i_sooner(at_us, grobo_i_halted_deadline(robot));
    return grobo_i_sooner(at_us, grobo_i_sense_deadline(robot));
}

int64_t grobo_robot_deadline(const grobo_robot *robot, int64_t now_us)
{
    if (robot == NULL) {
        return GROBO_NEVER_US;
    }
    grobo_i_lock(robot);
    int64_t at_us = deadline(robot, now_us);
    grobo_i_unlock(robot);
    return at_us;
}

/* ---- link ------------------------------------------------------------------------------------ */

void grobo_robot_link_up(grobo_robot *robot, int64_t now_us)
{
    if (robot == NULL) {
        return;
    }
    grobo_i_enter(robot, now_us);
    if (!robot->link) {
        robot->link = true;
        for (int i = 0; i < grobo_i_lines(robot); i++) {
            *grobo_i_answered(robot, i) = false;
        }
#if GROBO_LINES_MAX > 1
        robot->lines_gone = 0;
#endif
        grobo_i_gate_soften(robot);
        robot->sense_us = robot->now_us;
        robot->round = grobo_i_all_joints(robot);
        tell_kind(robot, GROBO_EVENT_LINK_UP);
        grobo_i_wheels_link(robot, true);
        if (robot->stop_owed) {
            (void)grobo_i_estop_start(robot);
        }
    }
    grobo_i_leave(robot);
}

/* What was known of the servos before the line went may be wrong when it comes back. */
void grobo_i_forget_joints(grobo_robot *robot, grobo_joint_mask joints)
{
    grobo_i_wheels_link(robot, false);
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        grobo_robot_axis *axis = &robot->axes[j];
        if (!grobo_i_has(joints, j)) {
            continue;
        }
        grobo_i_joint_to(axis, GROBO_I_JOINT_FORGET);
        axis->torque_known = axis->wants_torque = axis->state.fast = false;
        axis->own_until_us = 0;
        axis->status = GROBO_ERR_UNPLUGGED;
        axis->lost = 0;
        axis->seen_dps = GROBO_I_NO_SPEED;
        grobo_i_stand_forget(axis);
        axis->current_since_us = GROBO_NEVER_US;
        grobo_i_blocked_forget(robot, j);
        axis->trajectory.to_us = robot->now_us;
    }
    robot->free_joints &= ~joints;
    robot->played_joints &= ~joints;
    robot->halts_owed &= ~joints;
    robot->renews_owed &= ~joints;
    robot->halted &= ~joints;
    robot->halted_all &= ~joints;
    robot->low_readings = robot->fast_lost = 0;
}

void grobo_robot_link_down(grobo_robot *robot, int64_t now_us)
{
    if (robot == NULL) {
        return;
    }
    grobo_i_enter(robot, now_us);
    if (robot->link) {
        robot->link = false;
        tell_kind(robot, GROBO_EVENT_LINK_DOWN);
        if (grobo_i_is_playing(robot)) {
            (void)grobo_sequencer_fail(&robot->sequencer, GROBO_ERR_UNPLUGGED);
        }
        for (int i = 0; i < GROBO_ROBOT_JOBS; i++) {
            robot->jobs[i].failed |= robot->jobs[i].pending;
        }
        grobo_i_jobs_end(robot, NULL, GROBO_ERR_UNPLUGGED);
        grobo_i_queue_end(robot, GROBO_ERR_UNPLUGGED);
        for (int i = 0; i < grobo_i_lines(robot); i++) {
            grobo_bus *bus = grobo_i_bus(robot, i);
            (void)grobo_bus_cancel_all(bus, GROBO_PRIORITY_ALL, GROBO_ERR_UNPLUGGED);
            grobo_bus_reserve(bus, GROBO_NEVER_US, 0);
        }
        grobo_i_forget_joints(robot, grobo_i_all_joints(robot));
    }
    grobo_i_leave(robot);
}

/* ---- one of several lines -------------------------------------------------------------------- */

#if GROBO_LINES_MAX > 1

/* What is known of the joints of a line that has gone, or that is there again, is void. */
static void forget_line(grobo_robot *robot, int line)
{
    grobo_i_forget_joints(robot, grobo_i_joints_on(robot, line));
}

void grobo_robot_line_down(grobo_robot *robot, int line, int64_t now_us)
{
    if (!is_line(robot, line)) {
        return;
    }
    grobo_i_enter(robot, now_us);
    if (robot->link && (robot->lines_gone & 1u << line) == 0) {
        robot->lines_gone |= (uint8_t)(1u << line);
        (void)grobo_bus_cancel_all(grobo_i_bus(robot, line), GROBO_PRIORITY_ALL,
                                   GROBO_ERR_UNPLUGGED);
        forget_line(robot, line);
        grobo_i_trip(robot, GROBO_TRIP_LOST_REPLIES, grobo_i_lowest(grobo_i_joints_on(robot, line)),
                     0, true);
    }
    grobo_i_leave(robot);
}

void grobo_robot_line_up(grobo_robot *robot, int line, int64_t now_us)
{
    if (!is_line(robot, line)) {
        return;
    }
    grobo_i_enter(robot, now_us);
    if (robot->link && (robot->lines_gone & 1u << line) != 0) {
        robot->lines_gone &= (uint8_t) ~(1u << line);
        (void)grobo_bus_cancel_all(grobo_i_bus(robot, line), GROBO_PRIORITY_ALL,
                                   GROBO_ERR_UNPLUGGED);
        forget_line(robot, line);
        *grobo_i_answered(robot, line) = false;
        grobo_i_gate_soften(robot);
        robot->sense_us = robot->now_us;
        robot->round = grobo_i_all_joints(robot);
    }
    grobo_i_leave(robot);
}

#endif
