/* SPDX-License-Identifier: MIT */
/* The public requests: what is asked is checked here, then a script is started. */
#include <math.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/couple.h"
#include "src/robot/gate.h"
#include "src/robot/job.h"
#include "src/robot/lines.h"
#include "src/robot/orders.h"
#include "src/robot/pace.h"
#include "src/robot/play.h"
#include "src/robot/query.h"
#include "src/robot/queue.h"
#include "src/robot/request.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/speed.h"
#include "src/robot/state.h"
#include "src/robot/steps.h"
#include "src/robot/stop.h"
#include "src/robot/trip.h"
#include "src/robot/turn.h"
#include "src/robot/wheel.h"

/* May a job of this kind begin now? */
static int admit(grobo_robot *robot, grobo_job_kind kind, grobo_joint_mask joints, bool moves)
{
    int result = grobo_i_admit(robot, kind, joints, moves);
    return result == GROBO_I_LATER ? GROBO_ERR_STATE : result;
}

/* Runs a job just begun as far as it goes, and leaves. */
static int begin(grobo_robot *robot, int number)
{
    grobo_i_job_run(robot);
    grobo_i_end(robot);
    return number;
}

/* Begins nothing: for an error, or because the job of this number carries it out. */
static int refuse(grobo_robot *robot, int result)
{
    grobo_i_end(robot);
    return result;
}

int grobo_robot_check(grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = admit(robot, GROBO_JOB_CHECK, 0, false);
    if (result >= 0 && robot->driver->check == NULL) {
        result = GROBO_ERR_UNSUPPORTED;
    }
    if (result < 0) {
        return refuse(robot, result);
    }
    return begin(robot, grobo_i_job_start(robot, GROBO_JOB_CHECK, grobo_i_script_check, 0));
}

static bool joints_sound(const grobo_robot *robot, grobo_joint_mask joints)
{
    return joints != 0 && (joints & ~grobo_i_all_joints(robot)) == 0;
}

int grobo_robot_sense(grobo_robot *robot, grobo_joint_mask joints, grobo_sense_kind kind)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    grobo_robot_request request; /* a target is a move's alone: half a kilobyte is not cleared */
    request.number = 0;
    request.kind = GROBO_JOB_SENSE;
    request.joints = joints;
    request.sense = kind;
    request.begin_by_us = 0;
    request.target.n_joints = 0;
    request.target.set = 0;
    request.target.time_us = 0;
    request.singly = false;
    int result = joints_sound(robot, joints) && (unsigned)kind <= GROBO_SENSE_ALL
                     ? grobo_i_queue_ask(robot, &request)
                     : GROBO_ERR_ARG;
    grobo_i_end(robot);
    return result;
}

/* A motion that is being prepared goes no further. */
static void stop_prepared(grobo_robot *robot)
{
    if (robot->job->kind == GROBO_JOB_PLAY && grobo_i_is_playing(robot)) {
        (void)grobo_sequencer_stop(&robot->sequencer, false, robot->now_us);
        grobo_i_slots_cancel_goals(robot, grobo_i_all_joints(robot), true);
    }
}

/* Taking torque away goes before what the joints do, but not before what leaves a servo deaf. */
static bool is_patient(const grobo_robot_task *job)
{
    return job->kind == GROBO_JOB_COMMAND || job->kind == GROBO_JOB_EXIT ||
           job->kind == GROBO_JOB_ESTOP;
}

static bool is_alone(const grobo_robot_task *job)
{
    return job->kind == GROBO_JOB_CHECK || job->kind == GROBO_JOB_PLAY ||
           job->kind == GROBO_JOB_STORED;
}

static int switch_on(grobo_robot *robot, grobo_joint_mask joints)
{
    const grobo_robot_request request = {
        .kind = GROBO_JOB_TORQUE, .joints = joints, .sense = GROBO_SENSE_ALL};
    if (robot->driver->torque != NULL) {
        return grobo_i_queue_ask(robot, &request);
    }
    int result = admit(robot, GROBO_JOB_TORQUE, joints, true);
    return result < 0 ? result : GROBO_ERR_UNSUPPORTED;
}

static bool is_not_off(const grobo_robot_task *job)
{
    return job->kind != GROBO_JOB_TORQUE || job->torque == GROBO_TORQUE_ON;
}

/* There is always room: what does the same is joined, what does not makes way. */
static int begin_off(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode)
{
    int number = grobo_i_join_off(robot, joints, mode, false);
    if (number > 0) {
        return number;
    }
    grobo_i_jobs_leave(robot, joints);
    if (!grobo_i_jobs_have_room(robot, true)) {
        number = grobo_i_join_off(robot, joints, mode, true);
    }
    if (number == 0 && !grobo_i_jobs_have_room(robot, true)) {
        bool (*others)(const grobo_robot_task *job) =
            grobo_i_jobs_any(robot, is_not_off) ? is_not_off : NULL;
        grobo_i_jobs_end(robot, others, GROBO_ERR_CANCELED);
    }
    if (number == 0) {
        grobo_i_jobs_close_up(robot);
        number = grobo_i_job_start(robot, GROBO_JOB_TORQUE, grobo_i_script_torque_off, 0);
        robot->job->joints = joints;
        robot->job->torque = mode;
        grobo_i_job_run(robot);
    }
    return number;
}

static int switch_off(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode)
{
    if (!robot->link) {
        return GROBO_ERR_CLOSED;
    }
    grobo_i_make_way(robot);
    if (grobo_i_jobs_any(robot, is_patient)) {
        return GROBO_ERR_STATE;
    }
    if (robot->driver->torque == NULL) {
        return GROBO_ERR_UNSUPPORTED;
    }
    stop_prepared(robot);
    grobo_i_jobs_end(robot, is_alone, GROBO_ERR_CANCELED);
    grobo_i_queue_end(robot, GROBO_ERR_CANCELED);
    robot->free_joints &= ~joints;
    return begin_off(robot, joints, mode);
}

int grobo_robot_torque(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    joints = grobo_i_coupled(robot, joints);
    int result = !joints_sound(robot, joints) || (unsigned)mode > GROBO_TORQUE_BRAKE ? GROBO_ERR_ARG
                 : mode == GROBO_TORQUE_ON ? switch_on(robot, joints)
                                           : switch_off(robot, joints, mode);
    grobo_i_end(robot);
    return result;
}

/* A move of one joint may be joined to others. */
static void singly(grobo_robot_request *request)
{
    int64_t time_us = grobo_i_later(request->target.time_us, 0);
    request->singly = grobo_joints_count(request->joints) == 1 && time_us <= INT32_MAX;
    if (request->singly) {
        request->joint_time_us[grobo_i_lowest(request->joints)] = (int32_t)time_us;
    }
}

/* True of a target for a joint that follows another one, and not for that; and for a wheel. */
static bool follows_alone(grobo_robot *robot, const grobo_posture *target)
{
    if ((target->set & grobo_i_wheels(robot)) != 0) {
        robot->fault_joint = grobo_i_lowest(target->set & grobo_i_wheels(robot));
        return true;
    }
    return grobo_i_follows_alone(robot, target->set, &robot->fault_joint);
}

int grobo_robot_move(grobo_robot *robot, const grobo_posture *target)
{
    if (robot == NULL || target == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    grobo_robot_request request = {
        .kind = GROBO_JOB_MOVE, .joints = target->set, .target = *target};
    int result = !robot->link                   ? GROBO_ERR_CLOSED
                 : grobo_i_is_latched(robot)    ? GROBO_ERR_LATCHED
                 : request.target.set == 0      ? GROBO_ERR_ARG
                 : follows_alone(robot, target) ? GROBO_ERR_UNSUPPORTED
                                                : grobo_i_gate_target(robot, &request.target);
    int64_t time_us =
        request.target.time_us > 0 ? request.target.time_us : robot->config.default_time_us;
    if (result >= 0 && time_us > GROBO_SEGMENT_US &&
        !grobo_i_pace_fits(robot, request.target.set)) {
        result = GROBO_ERR_UNWATCHED; /* a short one that gets more time is refused as it leaves */
    }
    if (result >= 0) {
        request.joints = request.target.set;
        singly(&request);
        result = grobo_i_queue_ask(robot, &request);
    }
    grobo_i_end(robot);
    return result;
}

/* One that was not sensed either is refused for that. */
static bool all_hold(const grobo_robot *robot, grobo_joint_mask joints)
{
    for (int j = 0; j < robot->driver->model->n_joints; j++) {
        const grobo_robot_axis *axis = &robot->axes[j];
        if (grobo_i_has(joints, j) && grobo_i_is_sensed(axis) && !grobo_i_axis_is_on(axis)) {
            return false;
        }
    }
    return true;
}

/* A target for joints that nothing is read of before. */
static int admit_target(grobo_robot *robot, const grobo_posture *target)
{
    grobo_joint_mask joints = grobo_i_coupled(robot, target->set);
    if (!robot->link) {
        return GROBO_ERR_CLOSED;
    }
    if (grobo_i_is_latched(robot)) {
        return GROBO_ERR_LATCHED;
    }
    if (target->set == 0) {
        return GROBO_ERR_ARG;
    }
    if (follows_alone(robot, target)) {
        return GROBO_ERR_UNSUPPORTED;
    }
    bool others = grobo_i_externally_moved(robot, joints, &robot->fault_joint) ||
                  (joints & robot->free_joints) != 0;
    return others || !all_hold(robot, joints) ? GROBO_ERR_STATE : GROBO_OK;
}

/* True while something moves the robot that a target of the caller's stream must not disturb. */
static bool is_taken(const grobo_robot *robot)
{
    return grobo_i_in_motion(robot) || robot->queued > 0 || robot->job->kind == GROBO_JOB_PLAY ||
           robot->job->kind == GROBO_JOB_EXIT || robot->job->kind == GROBO_JOB_COMMAND;
}

int grobo_robot_send(grobo_robot *robot, const grobo_posture *target)
{
    if (robot == NULL || target == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    grobo_i_motion how = {
        .priority = GROBO_PRIORITY_MOTION, .due_us = GROBO_NEVER_US, .each = true, .single = true};
    int result = admit_target(robot, target);
    if (result >= 0 && is_taken(robot)) {
        result = GROBO_ERR_STATE;
    }
    if (result >= 0) {
        grobo_i_make_way(robot);
        grobo_i_gate_single(robot);
        grobo_i_slots_cancel_goals(robot, grobo_i_all_joints(robot), false);
        result = grobo_i_gate_send(robot, target, &how);
    }
    grobo_i_end(robot);
    return result < 0 ? result : GROBO_OK;
}

/* Which of the jobs is the move that may go to these joints' target instead: all of it, or these of
 * several moves of single joints. NULL: none. */
static grobo_robot_task *move_of(grobo_robot *robot, grobo_joint_mask joints)
{
    grobo_robot_task *shared = NULL;
    for (int i = 0; i < GROBO_ROBOT_JOBS && !robot->soft; i++) {
        grobo_robot_task *job = &robot->jobs[i];
        if (job->kind != GROBO_JOB_MOVE || !grobo_i_move_is_sent(job)) {
            continue;
        }
        if ((job->joints & ~joints) == 0) {
            return job;
        }
        shared = shared == NULL && job->singly && (job->joints & joints) != 0 ? job : shared;
    }
    return shared;
}

int grobo_robot_retarget(grobo_robot *robot, const grobo_posture *target)
{
    if (robot == NULL || target == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    grobo_posture checked = *target;
    grobo_robot_task *job = move_of(robot, grobo_i_coupled(robot, target->set));
    int result = admit_target(robot, target);
    if (result >= 0 && job == NULL) {
        result = GROBO_ERR_STATE;
    }
    if (result >= 0) {
        result = grobo_i_gate_target(robot, &checked);
    }
    if (result >= 0 && !grobo_i_all_sensed(robot, checked.set, &robot->fault_joint)) {
        result = GROBO_ERR_STALE;
    }
    if (result >= 0) {
        result = grobo_i_move_takes(robot, checked.set & ~job->joints);
    }
    if (result >= 0) {
        result = job->number;
        robot->job = job;
        grobo_i_move_retarget(robot, &checked);
    }
    grobo_i_end(robot);
    return result;
}

/* May this clip be played now? *joints: those it moves. */
static int admit_clip(grobo_robot *robot, const grobo_clip *clip, grobo_play_options *options,
                      grobo_joint_mask *joints)
{
    int result = admit(robot, GROBO_JOB_PLAY, 0, true);
    if (result >= 0 && grobo_i_is_playing(robot)) {
        result = GROBO_ERR_STATE;
    }
    if (result >= 0 && clip->n_joints != robot->driver->model->n_joints) {
        result = GROBO_ERR_ARG;
    }
    if (result >= 0) {
        result = grobo_i_play_joints(robot, clip, options, joints);
        *joints |= grobo_i_coupled(robot, options->also);
    }
    if (result >= 0 && !joints_sound(robot, *joints)) {
        result = *joints == 0 ? GROBO_ERR_EMPTY : GROBO_ERR_ARG;
    }
    if (result >= 0 && !grobo_i_pace_fits(robot, *joints)) {
        result = GROBO_ERR_UNWATCHED;
    }
    return result < 0 ? result : grobo_i_play_rate(robot, options);
}

int grobo_robot_play(grobo_robot *robot, const grobo_clip *clip, const grobo_play_options *options)
{
    if (robot == NULL || clip == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    grobo_play_options chosen;
    grobo_joint_mask joints = 0;
    int result = grobo_i_play_options(robot, options, &chosen);
    result = result < 0 ? result : admit_clip(robot, clip, &chosen, &joints);
    if (result < 0) {
        return refuse(robot, result);
    }
    int number = grobo_i_job_start(robot, GROBO_JOB_PLAY, grobo_i_script_play, 0);
    robot->job->joints = joints;
    robot->job->clip = *clip;
    robot->job->options = chosen;
    robot->clip_joints = joints;
    robot->free_joints = 0;
    return begin(robot, number);
}

/* ---- frames of other kinds ------------------------------------------------------------------- */

/* Sends an exchange, which is judged again when it leaves. */
static int start_exchange(grobo_robot *robot, grobo_job_kind kind, const grobo_robot_order *order,
                          const grobo_exchange *exchange)
{
    int number = grobo_i_job_start(robot, kind, grobo_i_script_ask, 0);
    robot->asked = *exchange; /* until its first step, in this call */
    robot->asked_by = number;
    robot->job->settle_us = exchange->settle_us;
    robot->job->order = *order;
    robot->job->joints = order->joints;
    return number;
}

static int begin_exchange(grobo_robot *robot, int line, grobo_job_kind kind,
                          const grobo_robot_order *order, const grobo_exchange *exchange)
{
#if GROBO_LINES_MAX > 1
    robot->asked_line = (uint8_t)line;
#else
    (void)line;
#endif
    return begin(robot, start_exchange(robot, kind, order, exchange));
}

int grobo_robot_raw(grobo_robot *robot, const uint8_t *frame, size_t size)
{
    return grobo_robot_raw_until(robot, frame, size, GROBO_NEVER_US);
}

int grobo_robot_raw_until(grobo_robot *robot, const uint8_t *frame, size_t size, int64_t until_us)
{
    if ((frame == NULL && size > 0) || robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_exchange exchange = {0};
    grobo_robot_order order;
    grobo_i_begin(robot);
    int result = admit(robot, GROBO_JOB_RAW, 0, false);
    if (result >= 0 && grobo_i_lines(robot) > 1) {
        result = GROBO_ERR_UNSUPPORTED; /* it does not say for which */
    }
    if (size == 0 || size > sizeof exchange.frame) {
        result = GROBO_ERR_ARG;
    }
    if (result >= 0 && until_us < robot->now_us) {
        result = GROBO_ERR_STALE;
    }
    if (result >= 0) {
        memcpy(exchange.frame, frame, size);
        exchange.frame_bytes = (uint16_t)size;
        result = grobo_i_gate_raw(robot, &exchange, &order);
    }
    if (result >= 0) {
        result = admit(robot, GROBO_JOB_RAW, order.joints, order.moves);
    }
    if (result < 0) {
        return refuse(robot, result);
    }
    /* A frame that asks for nothing that there is, is sent all the same. */
    (void)robot->driver->protocol->reply_to(frame, size, &exchange.reply);
#if GROBO_LINES_MAX > 1
    robot->asked_line = 0;
#endif
    int number = start_exchange(robot, GROBO_JOB_RAW, &order, &exchange);
    robot->job->leave_by_us = until_us == GROBO_NEVER_US ? 0 : until_us;
    return begin(robot, number);
}

static bool is_servo(const grobo_robot *robot, int line, int id)
{
    if (line < 0 || line >= grobo_i_lines(robot)) {
        return false;
    }
    const grobo_protocol *protocol = grobo_i_bus_read(robot, line)->config.protocol;
    return id >= protocol->id_min && id <= protocol->id_max;
}

/* The joint of a motor, none where it is not the model's. */
static grobo_joint_mask joint_of(const grobo_robot *robot, int line, int id)
{
    int joint = grobo_i_joint_on(robot, line, id);
    return joint >= 0 ? GROBO_JOINT_BIT(joint) : 0;
}

static int admit_write(grobo_robot *robot, int line, const grobo_register_io *io,
                       grobo_robot_order *order)
{
    const grobo_driver *driver = grobo_i_line_driver(robot, line, NULL);
    grobo_write_kind kind = driver->write_kind(driver, io);
    if (kind == GROBO_WRITE_MOTOR) {
        return GROBO_ERR_UNSUPPORTED;
    }
    if (kind == GROBO_WRITE_SETTING) {
        order->kind = GROBO_I_ORDER_SETTING;
        order->joints = joint_of(robot, line, io->id);
    }
    return grobo_i_gate_judge(robot, order, NULL);
}

static int registers(grobo_robot *robot, int line, const grobo_register_io *io)
{
    void *ctx;
    grobo_exchange exchange = {0};
    grobo_robot_order order = {.kind = GROBO_I_ORDER_NONE};
    grobo_i_begin(robot);
    const grobo_driver *driver = grobo_i_line_driver(robot, line, &ctx);
    int result = admit(robot, GROBO_JOB_REGISTERS, joint_of(robot, line, io->id), false);
    if (!is_servo(robot, line, io->id) || io->length < 1) {
        result = GROBO_ERR_ARG;
    }
    if (result >= 0 && driver->registers == NULL) {
        result = GROBO_ERR_UNSUPPORTED;
    }
    if (result >= 0 && io->data != NULL) {
        result = admit_write(robot, line, io, &order);
    }
    if (result >= 0) {
        result = driver->registers(driver, ctx, io, &exchange);
    }
    if (result < 0) {
        return refuse(robot, result);
    }
    return begin_exchange(robot, line, GROBO_JOB_REGISTERS, &order, &exchange);
}

int grobo_robot_registers(grobo_robot *robot, const grobo_register_io *io)
{
    return robot == NULL || io == NULL ? GROBO_ERR_ARG : registers(robot, 0, io);
}

#if GROBO_LINES_MAX > 1
int grobo_robot_line_registers(grobo_robot *robot, int line, const grobo_register_io *io)
{
    return robot == NULL || io == NULL || line < 0 || line >= grobo_i_lines(robot)
               ? GROBO_ERR_ARG
               : registers(robot, line, io);
}
#endif

int grobo_robot_command(grobo_robot *robot, int id, grobo_servo_command command)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_exchange exchange = {0};
    grobo_robot_order order = {.kind = GROBO_I_ORDER_COMMAND};
    void *ctx;
    grobo_i_begin(robot);
    const grobo_driver *driver = grobo_i_line_driver(robot, id >> 8, &ctx);
    int result = admit(robot, GROBO_JOB_COMMAND, 0, false);
    if (result >= 0) {
        result = grobo_i_gate_judge(robot, &order, NULL);
    }
    if (!is_servo(robot, id >> 8, id & 0xFF) || (unsigned)command > GROBO_SERVO_FACTORY_RESET) {
        result = GROBO_ERR_ARG;
    }
    if (result >= 0 && driver->command == NULL) {
        result = GROBO_ERR_UNSUPPORTED;
    }
    if (result >= 0) {
        result = driver->command(driver, ctx, id & 0xFF, command, &exchange);
    }
    if (result < 0) {
        return refuse(robot, result);
    }
    order.joints = command != GROBO_SERVO_FLASH ? joint_of(robot, id >> 8, id & 0xFF) : 0;
    return begin_exchange(robot, id >> 8, GROBO_JOB_COMMAND, &order, &exchange);
}

int grobo_robot_stored(grobo_robot *robot, grobo_stored_kind kind, int number)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_exchange exchange = {0};
    grobo_robot_order order = {
        .kind = GROBO_I_ORDER_UNKNOWN, .joints = grobo_i_all_joints(robot), .moves = true};
    grobo_i_begin(robot);
    int result = admit(robot, GROBO_JOB_STORED, 0, true);
    if (result >= 0) {
        result = grobo_i_gate_judge(robot, &order, NULL);
    }
    if (result >= 0 && robot->driver->stored == NULL) {
        result = GROBO_ERR_UNSUPPORTED;
    }
    if (result >= 0) {
        result = robot->driver->stored(robot->driver, robot->driver_ctx, kind, number, &exchange);
    }
    if (result < 0) {
        return refuse(robot, result);
    }
    robot->free_joints = 0;
    return begin_exchange(robot, 0, GROBO_JOB_STORED, &order, &exchange);
}

/* ---- ends ------------------------------------------------------------------------------------ */

/* Ends what runs and what waits; what is moved by it is stopped, or all that moves. */
static void displace(grobo_robot *robot, bool all)
{
    /* What a motion has sent before it plays is on its trajectory, too. */
    bool moves = all || grobo_i_jobs_any(robot, grobo_i_job_moves);
    stop_prepared(robot);
    grobo_i_jobs_end(robot, NULL, GROBO_ERR_CANCELED);
    grobo_i_queue_end(robot, GROBO_ERR_CANCELED);
    if (moves) {
        grobo_i_stop_moves(robot);
    }
}

int grobo_robot_cancel(grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = GROBO_OK;
    if (robot->job->kind == GROBO_JOB_NONE || robot->job->kind == GROBO_JOB_ESTOP ||
        robot->job->kind == GROBO_JOB_SETTLE) {
        result = GROBO_ERR_STATE;
    } else {
        displace(robot, false);
    }
    grobo_i_end(robot);
    return result;
}

static const grobo_robot_step_fn *exit_script(const grobo_robot *robot, grobo_exit_policy policy)
{
    switch (policy == GROBO_EXIT_DEFAULT ? robot->config.on_exit : policy) {
    case GROBO_EXIT_OFF:
        return grobo_i_script_exit_off;
    case GROBO_EXIT_SIT:
        return robot->trip.latched ? grobo_i_script_exit_hold : grobo_i_script_exit_sit;
    case GROBO_EXIT_DEFAULT:
    case GROBO_EXIT_HOLD:
        return grobo_i_script_exit_hold;
    }
    return grobo_i_script_exit_hold;
}

int grobo_robot_exit(grobo_robot *robot, grobo_exit_policy policy)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    if (!robot->link || (unsigned)policy > GROBO_EXIT_SIT || robot->job->kind == GROBO_JOB_ESTOP) {
        return refuse(robot, !robot->link                        ? GROBO_ERR_CLOSED
                             : (unsigned)policy > GROBO_EXIT_SIT ? GROBO_ERR_ARG
                                                                 : GROBO_ERR_STATE);
    }
    const grobo_robot_step_fn *script = exit_script(robot, policy);
    if (robot->job->kind == GROBO_JOB_EXIT && robot->job->script == script) {
        return refuse(robot, robot->job->number); /* it is being carried out */
    }
    if (grobo_i_is_playing(robot)) {
        (void)grobo_sequencer_stop(&robot->sequencer, false, robot->now_us);
    }
    displace(robot, true);
    grobo_i_slots_cancel(robot, GROBO_I_USE_PLAIN); /* such as torque that free mode asked for */
    int number = grobo_i_job_start(robot, GROBO_JOB_EXIT, script, 0);
    robot->stop_us = robot->now_us;
    robot->job->joints = grobo_i_all_joints(robot);
    robot->job->torque = GROBO_TORQUE_OFF;
    robot->job->lets_go = script == grobo_i_script_exit_off;
    robot->job->bound_us =
        robot->now_us + grobo_i_sooner(robot->config.exit_bound_us, GROBO_NEVER_US - robot->now_us);
    robot->free_joints = 0;
    return begin(robot, number);
}

/* Where nobody answers any more, nobody waits longer than that. */
#define ESTOP_BOUND_US 10000000

int grobo_i_estop_start(grobo_robot *robot)
{
    int number = grobo_i_job_start(robot, GROBO_JOB_ESTOP, grobo_i_script_torque_off, 0);
    robot->stop_us = robot->now_us;
    robot->job->joints = grobo_i_all_joints(robot);
    robot->job->torque =
        robot->config.estop_torque == GROBO_ESTOP_OFF ? GROBO_TORQUE_OFF : GROBO_TORQUE_BRAKE;
    robot->job->priority = GROBO_PRIORITY_STOP;
    robot->job->bound_us = robot->now_us + ESTOP_BOUND_US;
    robot->holds_at_stop = false;
    grobo_i_job_run(robot);
    return number;
}

int grobo_robot_estop(grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    robot->counters.estops++;
    if (robot->job->kind == GROBO_JOB_ESTOP) { /* begun anew each time, it would never end */
        return refuse(robot, robot->job->number);
    }
    grobo_i_jobs_end(robot, NULL, GROBO_ERR_CANCELED);
    grobo_i_queue_end(robot, GROBO_ERR_CANCELED);
    grobo_sequencer_reset(&robot->sequencer);
    grobo_bus_reserve(&robot->bus, GROBO_NEVER_US, 0);
    grobo_i_lines_reserve(robot, GROBO_NEVER_US, 0);
    grobo_i_slots_cancel_all(robot);
    grobo_i_slots_hurry(robot);
    grobo_i_trip(robot, GROBO_TRIP_ESTOP, -1, 0, true);
    robot->halts_owed = 0;
    robot->stop_owed = true;
    int number = robot->link ? grobo_i_estop_start(robot) : GROBO_ERR_CLOSED;
    grobo_i_end(robot);
    return number;
}

int grobo_robot_latch(grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = grobo_i_in_motion(robot) ? GROBO_ERR_STATE : GROBO_OK;
    if (result >= 0 && robot->trip.trip != GROBO_TRIP_ESTOP) {
        for (int i = 0; i < robot->slots_end; i++) { /* what was to stop before does */
            robot->slots[i].order.owed = robot->slots[i].use == GROBO_I_USE_HALT;
        }
        grobo_i_trip(robot, GROBO_TRIP_ESTOP, -1, 0, true);
    }
    grobo_i_end(robot);
    return result;
}

int grobo_robot_reset(grobo_robot *robot)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_i_begin(robot);
    int result = robot->host.may_reset != NULL ? robot->host.may_reset(robot->host.ctx) : GROBO_OK;
    if (robot->job->kind == GROBO_JOB_ESTOP) {
        result = GROBO_ERR_STATE;
    }
    if (result >= 0) {
        robot->trip = (grobo_trip_info){.joint = -1};
        grobo_i_gate_soften(robot);
        robot->low_readings = 0;
        robot->stop_owed = false;
    }
    grobo_i_end(robot);
    return result;
}

/* ---- free mode ------------------------------------------------------------------------------- */

int grobo_robot_free(grobo_robot *robot, grobo_joint_mask joints, bool on)
{
    if (robot == NULL) {
        return GROBO_ERR_ARG;
    }
    if (!on) {
        return grobo_robot_torque(robot, joints, GROBO_TORQUE_ON);
    }
    grobo_i_begin(robot);
    joints = grobo_i_coupled(robot, joints) & ~grobo_i_wheels(robot); /* a wheel without torque */
    /* Beside no job: one that is under way may still send joints to where they were. */
    int result = admit(robot, GROBO_JOB_PLAY, 0, true);
    if (result >= 0 && grobo_i_is_playing(robot)) {
        result = GROBO_ERR_STATE;
    }
    if (!joints_sound(robot, joints)) {
        result = GROBO_ERR_ARG;
    }
    if (result >= 0 && robot->driver->torque == NULL) {
        result = GROBO_ERR_UNSUPPORTED;
    }
    if (result >= 0) {
        for (int j = 0; j < robot->driver->model->n_joints; j++) {
            robot->axes[j].away_rad = INFINITY; /* it may be on a trajectory */
        }
        grobo_i_queue_end(robot, GROBO_ERR_CANCELED);
        robot->free_joints |= joints;
        robot->sense_us = robot->now_us;
    }
    grobo_i_end(robot);
    return result < 0 ? result : GROBO_OK;
}
