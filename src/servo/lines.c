/* SPDX-License-Identifier: MIT */
/*
 * A driver of a robot on several lines, made of the drivers of the lines. Each function finds the
 * line of the joints that it gets, numbers them as that line's model does, and asks its driver. The
 * engine never asks about joints of two lines at once.
 */
#include <string.h>

#include <grobo/core/lines.h>

#include "src/base/assert.h"
#include "src/base/sized.h"
#include "src/model/joint.h"

#if GROBO_LINES_MAX > 1

/* ---- joints of the robot, and of a line ----------------------------------------------------- */

static bool has(grobo_joint_mask joints, int joint)
{
    return (joints & GROBO_JOINT_BIT(joint)) != 0;
}

static const grobo_lines *lines_of(const grobo_driver *self)
{
    return self->lines;
}

/* The line of these joints; NULL: there are none, or they are on two. */
static const grobo_lines_line *line_with(const grobo_lines *lines, grobo_joint_mask joints)
{
    for (int i = 0; i < lines->n_lines; i++) {
        if ((joints & lines->on[i]) != 0) {
            return (joints & ~lines->on[i]) == 0 ? &lines->line[i] : NULL;
        }
    }
    return NULL;
}

static const grobo_lines_line *line_at(const grobo_driver *self, int joint)
{
    const grobo_lines *lines = lines_of(self);
    GROBO_ASSERT(joint >= 0 && joint < self->model->n_joints);
    return &lines->line[lines->line_of[joint]];
}

/* Joints of one line, as its model counts them. */
static grobo_joint_mask on_line(const grobo_lines *lines, grobo_joint_mask joints, int n_joints)
{
    grobo_joint_mask found = 0;
    for (int j = 0; j < n_joints; j++) {
        found |= has(joints, j) ? GROBO_JOINT_BIT(lines->joint_on[j]) : 0;
    }
    return found;
}

/* ---- splitting ------------------------------------------------------------------------------- */

static int count_lines(const grobo_model *model)
{
    int n = 0;
    for (int j = 0; j < model->n_joints; j++) {
        int line = grobo_i_joint_line(model, j);
        n = line >= n ? line + 1 : n;
    }
    return n;
}

/* A joint of a line's model: what points to other joints points to those of that model. */
static int take_joint(grobo_lines *lines, const grobo_model *model, int j, grobo_joint *to)
{
    const grobo_joint *from = grobo_i_joint(model, j);
    size_t bytes = sizeof *to;
#if !GROBO_TABLES_FIXED
    bytes = model->joint_size < bytes ? model->joint_size : bytes;
#endif
    memset(to, 0, sizeof *to);
    memcpy(to, from, bytes);
    to->mirror = lines->joint_on[j];
    to->mirror_sign = 1;
    to->line = 0;
    if (grobo_i_joint_follows(model, j)) {
        int first = grobo_i_first(from);
        to->follows = lines->joint_on[first];
        return lines->line_of[first] == lines->line_of[j] ? GROBO_OK : GROBO_ERR_ARG;
    }
    return GROBO_OK;
}

int grobo_lines_split(grobo_lines *lines, const grobo_model *model)
{
    if (lines == NULL || model == NULL || grobo_model_check(model) < 0) {
        return GROBO_ERR_ARG;
    }
    int result = GROBO_OK, at = 0;
    lines->n_lines = (uint8_t)count_lines(model);
    if (lines->n_lines < 2) {
        return GROBO_ERR_ARG;
    }
    for (int i = 0; i < lines->n_lines; i++) {
        grobo_joint *first = &lines->joints[at];
        int n = 0;
        lines->on[i] = 0;
        for (int j = 0; j < model->n_joints; j++) {
            if (grobo_i_joint_line(model, j) == i) {
                lines->line_of[j] = (uint8_t)i;
                lines->joint_on[j] = (uint8_t)n++;
                lines->on[i] |= GROBO_JOINT_BIT(j);
            }
        }
        for (int j = 0; j < model->n_joints && result >= 0; j++) {
            result =
                has(lines->on[i], j) ? take_joint(lines, model, j, &lines->joints[at++]) : result;
        }
        lines->line[i].model = (grobo_model)GROBO_TABLE(
            grobo_model, .name = model->name, GROBO_MODEL_JOINTS(first), .n_joints = (uint8_t)n,
            .limit_slack_deg = model->limit_slack_deg);
        result = n == 0 ? GROBO_ERR_ARG : result;
    }
    return result;
}

/* ---- what goes to one line ------------------------------------------------------------------- */

static int lines_posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                         grobo_exchange *exchange)
{
    const grobo_lines *lines = lines_of(self);
    const grobo_lines_line *line = line_with(lines, target->posture.set);
    grobo_target own;
    (void)ctx;
    if (line == NULL) {
        return target->posture.set == 0 ? 0 : GROBO_ERR_CAP;
    }
    (void)grobo_posture_init(&own.posture, line->model.n_joints);
    own.posture.time_us = target->posture.time_us;
    for (int j = 0; j < self->model->n_joints; j++) {
        int on = lines->joint_on[j];
        if (&lines->line[lines->line_of[j]] == line) {
            own.posture.angle_rad[on] = target->posture.angle_rad[j];
            own.joint_time_us[on] = target->joint_time_us[j];
            own.from_rad[on] = target->from_rad[j];
        }
    }
    own.posture.set = on_line(lines, target->posture.set, self->model->n_joints);
    return line->driver.posture(&line->driver, line->ctx, &own, part, exchange);
}

/* The line of the joints of a mask, and these joints there. */
static const grobo_lines_line *find(const grobo_driver *self, grobo_joint_mask *joints)
{
    const grobo_lines *lines = lines_of(self);
    const grobo_lines_line *line = line_with(lines, *joints);
    *joints = on_line(lines, *joints, self->model->n_joints);
    return line;
}

static int lines_torque(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                        grobo_torque mode, int part, grobo_exchange *exchange)
{
    const grobo_lines_line *line = find(self, &joints);
    (void)ctx;
    if (line == NULL) {
        return joints == 0 ? 0 : GROBO_ERR_CAP;
    }
    return line->driver.torque(&line->driver, line->ctx, joints, mode, part, exchange);
}

static int lines_watchdog(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                          int64_t time_us, int part, grobo_exchange *exchange)
{
    const grobo_lines_line *line = find(self, &joints);
    (void)ctx;
    return line == NULL || line->driver.watchdog == NULL || line->driver.watchdog_us == 0
               ? 0
               : line->driver.watchdog(&line->driver, line->ctx, joints, time_us, part, exchange);
}

static int lines_speed(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                       const double *rad_s, int part, grobo_exchange *exchange)
{
    const grobo_lines *lines = lines_of(self);
    double own[GROBO_JOINTS_MAX] = {0};
    for (int j = 0; j < self->model->n_joints; j++) {
        if (has(joints, j)) {
            own[lines->joint_on[j]] = rad_s[j];
        }
    }
    const grobo_lines_line *line = find(self, &joints);
    (void)ctx;
    if (line == NULL) {
        return joints == 0 ? 0 : GROBO_ERR_CAP;
    }
    return line->driver.speed == NULL
               ? 0
               : line->driver.speed(&line->driver, line->ctx, joints, own, part, exchange);
}

static int lines_torque_limit(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                              int part, grobo_exchange *exchange)
{
    const grobo_lines_line *line = find(self, &joints);
    (void)ctx;
    return line == NULL || line->driver.torque_limit == NULL
               ? 0
               : line->driver.torque_limit(&line->driver, line->ctx, joints, part, exchange);
}

static int lines_sense(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                       grobo_exchange *exchange)
{
    const grobo_lines_line *line = line_at(self, joint);
    (void)ctx;
    return line->driver.sense(&line->driver, line->ctx, lines_of(self)->joint_on[joint], kind,
                              exchange);
}

static int lines_sense_more(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                            int part, grobo_exchange *exchange)
{
    const grobo_lines_line *line = line_at(self, joint);
    (void)ctx;
    return line->driver.sense_more == NULL
               ? 0
               : line->driver.sense_more(&line->driver, line->ctx, lines_of(self)->joint_on[joint],
                                         kind, part, exchange);
}

static int lines_parse(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                       grobo_joint_state *state)
{
    const grobo_lines_line *line = line_at(self, joint);
    (void)ctx;
    return line->driver.parse(&line->driver, line->ctx, lines_of(self)->joint_on[joint], reply,
                              state);
}

/* ---- the table ------------------------------------------------------------------------------- */

/* The narrower of two limits, of which 0 is none. */
static int lower(int a, int b)
{
    return a == 0 || (b != 0 && b < a) ? b : a;
}

static void merge_limits(grobo_safety_limits *to, const grobo_safety_limits *from)
{
    to->temperature_c = (int16_t)lower(to->temperature_c, from->temperature_c);
    to->lost_replies = (int16_t)lower(to->lost_replies, from->lost_replies);
    /* Of servos of another supply or size they would say nothing. */
    to->voltage_mv = to->voltage_mv == from->voltage_mv ? to->voltage_mv : 0;
    to->current_ma = to->current_ma == from->current_ma ? to->current_ma : 0;
    to->current_us = to->current_ma == 0                 ? 0
                     : to->current_us < from->current_us ? to->current_us
                                                         : from->current_us;
    if (from->approach_rad_s < to->approach_rad_s) {
        to->approach_rad_s = from->approach_rad_s;
    }
}

static bool is_timed(const grobo_driver *driver)
{
    return driver->posture == GROBO_I_MEMBER(driver, driver->size, timed_posture);
}

/* What is asked of the whole robot; by joint the engine asks the driver of its line. */
static void merge(grobo_driver *to, const grobo_driver *from)
{
    merge_limits(&to->limits, &from->limits);
    to->time_step_us =
        to->time_step_us > from->time_step_us ? to->time_step_us : from->time_step_us;
    to->time_max_us = to->time_max_us < from->time_max_us ? to->time_max_us : from->time_max_us;
    to->angle_step_rad =
        to->angle_step_rad > from->angle_step_rad ? to->angle_step_rad : from->angle_step_rad;
    to->accel_rad_s2 =
        to->accel_rad_s2 > from->accel_rad_s2 ? to->accel_rad_s2 : from->accel_rad_s2;
    to->watchdog_us = to->watchdog_us > from->watchdog_us ? to->watchdog_us : from->watchdog_us;
    to->arm = to->arm && from->arm;
    to->keeps_setup = to->keeps_setup || from->keeps_setup;
    to->goal_energises = to->goal_energises || from->goal_energises;
    to->tells_no_speed = to->tells_no_speed || from->tells_no_speed;
    to->watchdog = from->watchdog != NULL ? lines_watchdog : to->watchdog;
    to->torque_limit = from->torque_limit != NULL ? lines_torque_limit : to->torque_limit;
    to->speed = from->speed != NULL ? lines_speed : to->speed;
    to->sense_more = from->sense_more != NULL ? lines_sense_more : to->sense_more;
    to->timed_posture = is_timed(from) ? to->timed_posture : NULL;
}

int grobo_lines_driver_init(grobo_driver *driver, const grobo_lines *lines,
                            const grobo_model *model)
{
    if (driver == NULL || lines == NULL || model == NULL || lines->n_lines < 2 ||
        lines->n_lines > GROBO_LINES_MAX) {
        return GROBO_ERR_ARG;
    }
    const grobo_driver *first = &lines->line[0].driver;
    for (int i = 0; i < lines->n_lines; i++) {
        const grobo_driver *own = &lines->line[i].driver;
        if (grobo_driver_check(own) < 0 || own->model != &lines->line[i].model) {
            return GROBO_ERR_ARG;
        }
        if (own->torque == NULL || own->check == NULL) {
            return GROBO_ERR_UNSUPPORTED;
        }
    }
    grobo_driver made = GROBO_TABLE_INIT(grobo_driver);
    made.name = model->name;
    made.model = model;
    made.protocol = first->protocol;
    made.time_step_us = first->time_step_us;
    made.time_max_us = first->time_max_us;
    made.angle_step_rad = first->angle_step_rad;
    made.limits = first->limits;
    made.on_exit = GROBO_EXIT_HOLD;
    made.arm = first->arm;
    /* The engine asks a line for its check, registers and commands: they are of none of its joints.
     */
    made.check = first->check;
    made.posture = made.timed_posture = lines_posture;
    made.torque = lines_torque;
    made.sense = lines_sense;
    made.parse = lines_parse;
    made.lines = lines;
    for (int i = 0; i < lines->n_lines; i++) {
        merge(&made, &lines->line[i].driver);
    }
    int result = grobo_driver_check(&made);
    return result < 0 ? result : grobo_driver_copy(driver, &made);
}

#endif
