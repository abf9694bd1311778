/* SPDX-License-Identifier: MIT */
/* SerialRobot of the classic shelf: its life, its port, its thread, and raw commands. */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/runner.h>

#include "src/classic/classic.h"

/* ---- not in the document ------------------------------------------------------------------ */

/* Keeps no reason: a signal handler may call it. */
int SerialRobot_estop(SerialRobot *robot)
{
    return SerialRobot_runner(robot) != NULL && grobo_runner_estop(robot->inside->runner) >= 0 ? 0
                                                                                               : -1;
}

int SerialRobot_reset(SerialRobot *robot)
{
    return SerialRobot_runner(robot) == NULL
               ? -1
               : grobo_classic_end(robot, grobo_runner_reset(robot->inside->runner), 0);
}

/* ---- what the loop calls ------------------------------------------------------------------ */

static int on_svc(void *arg, grobo_runner *runner)
{
    SerialRobot *robot = arg;
    int64_t now_us = grobo_now_us();

    (void)runner;
    if (robot->svc != NULL && now_us >= robot->inside->svc_us) {
        robot->inside->svc_us = now_us + (int64_t)robot->timeout * 1000;
        robot->svc(robot);
    }
    return 0;
}

/* Keeps the reply to a command, which is on the wire from its first byte to the end of its job;
 * where there is no room, the rest is dropped. */
static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    struct serial_robot_inside *inside = ((SerialRobot *)ctx)->inside;

    (void)now_us;
    if (direction == GROBO_DIR_TX && inside->n_sending > 0) {
        size_t same = size < inside->n_sending ? size : inside->n_sending;
        inside->recording = inside->recording || memcmp(bytes, inside->sending, same) == 0;
    } else if (direction == GROBO_DIR_RX && inside->recording) {
        size_t room = sizeof inside->received - inside->n_received;
        size_t taken = size < room ? size : room;
        memcpy(inside->received + inside->n_received, bytes, taken);
        inside->n_received += taken;
    }
}

static void on_robot(void *ctx, const grobo_event *event)
{
    struct serial_robot_inside *inside = ((SerialRobot *)ctx)->inside;

    if (event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_RAW) {
        inside->recording = false;
        inside->n_sending = 0;
    }
}

/* The driver's stabilizer: the field's, which gets motor order. */
static int call_stabilizer(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                           grobo_posture *target)
{
    SerialRobot *robot = ctx;
    RobotPosture current;
    RobotPosture wanted;
    grobo_posture given;

    (void)self;
    if (robot->stabilizer == NULL) {
        return GROBO_OK;
    }
    (void)RobotPosture_init(&current, robot->joints);
    (void)RobotPosture_init(&wanted, robot->joints);
    grobo_classic_to_motors(robot, sensed, &current);
    grobo_classic_to_motors(robot, target, &wanted);
    int r = robot->stabilizer(robot, &current, &wanted);
    if (r != 0) {
        return r < 0 ? r : GROBO_ERR_ARG;
    }
    grobo_classic_to_joints(robot, &wanted, &given);
    for (int j = 0; j < robot->joints; j++) {
        if ((target->set & GROBO_JOINT_BIT(j)) != 0) {
            target->angle_rad[j] = given.angle_rad[j];
        }
    }
    return GROBO_OK;
}

/* ---- making ------------------------------------------------------------------------------- */

static int make_runner(SerialRobot *robot, const char *devname)
{
    const grobo_robot_config config = {
        GROBO_ROBOT_CONFIG_INIT,
        .readback_correction = true,
        .sense_interval_us = (int64_t)robot->senseTime * 1000,
        .default_time_us = (int64_t)robot->motionTime * 1000,
    };
    const grobo_session_config session = {
        GROBO_SESSION_CONFIG_INIT,
        .device = devname != NULL ? devname : "",
        .driver = &robot->inside->driver,
        .driver_ctx = robot,
        .robot = &config,
        .on_robot = on_robot,
        .on_tap = on_tap,
        .ctx = robot,
    };
    const grobo_runner_config runner = {GROBO_RUNNER_CONFIG_INIT, .session = &session,
                                        .on_svc = on_svc};

    return grobo_runner_new(&runner, &robot->inside->runner);
}

/* The document's fields. */
static void fill(SerialRobot *robot)
{
    struct serial_robot_inside *inside = robot->inside;

    robot->name = inside->driver.name;
    robot->initPosture = &inside->init;
    robot->currentPosture = &inside->current;
    robot->targetPosture = &inside->target;
    robot->motion = &inside->motion;
    robot->record = &inside->record;
    robot->com = &inside->com;
    inside->com = (SerialCom){.device = inside->device,
                              .baudrate = GROBO_BAUD_DEFAULT_BPS,
                              .handle = GROBO_HANDLE_NULL,
                              .robot = robot};
    (void)RobotPosture_init(&inside->init, robot->joints);
    (void)RobotPosture_init(&inside->current, robot->joints);
    (void)RobotPosture_init(&inside->target, robot->joints);
    inside->motion.numJoints = robot->joints;
    inside->record.numJoints = robot->joints;
    memset(robot->servoState, SERIAL_ROBOT_STATE_UNKNOWN, sizeof robot->servoState);
}

int SerialRobot_init(SerialRobot *robot, const char *devname, int n, const grobo_driver *driver)
{
    driver = driver != NULL ? driver : grobo_gr001_driver(GROBO_WIRING_BOARD);
    if (robot == NULL || (n != 0 && n != driver->model->n_joints) ||
        (devname != NULL && strlen(devname) >= GROBO_PATH_MAX_BYTES)) {
        return -1;
    }
    *robot = (SerialRobot){.joints = driver->model->n_joints,
                           .motionTime = 300,
                           .senseTime = 300,
                           .timeout = 500,
                           .repeatCount = 1};
    robot->inside = calloc(1, sizeof *robot->inside);
    if (robot->inside == NULL) {
        return -1;
    }
    robot->inside->robot = robot;
    robot->inside->driver.size = sizeof robot->inside->driver;
    if (grobo_driver_copy(&robot->inside->driver, driver) < 0) {
        free(robot->inside);
        robot->inside = NULL;
        return -1;
    }
    robot->inside->driver.stabilize = call_stabilizer;
    (void)grobo_model_motor_order(robot->inside->driver.model, robot->inside->joint_of);
    fill(robot);
    if (make_runner(robot, devname) < 0) {
        free(robot->inside);
        robot->inside = NULL;
        return -1;
    }
    memcpy(robot->inside->device, devname != NULL ? devname : "",
           devname != NULL ? strlen(devname) + 1 : 1);
    grobo_classic_view_init(&robot->inside->view, grobo_classic_engine(robot));
    return 0;
}

void SerialRobot_deinit(SerialRobot *robot)
{
    if (robot == NULL || robot->inside == NULL) {
        return;
    }
    struct serial_robot_inside *inside = robot->inside;

    (void)grobo_runner_free(inside->runner);
    if (inside->playing != NULL) {
        grobo_motion_clip_free(&inside->clip);
        grobo_motion_free(inside->playing);
    }
    RobotMotion_deinit(&inside->motion);
    RobotMotion_deinit(&inside->record);
    free(inside);
    robot->inside = NULL;
}

SerialRobot *SerialRobot_new(const char *devname, int n, const grobo_driver *driver)
{
    SerialRobot *robot = malloc(sizeof *robot);

    if (robot != NULL && SerialRobot_init(robot, devname, n, driver) < 0) {
        free(robot);
        return NULL;
    }
    return robot;
}

void SerialRobot_delete(SerialRobot *robot)
{
    SerialRobot_deinit(robot);
    free(robot);
}

/* ---- the port ----------------------------------------------------------------------------- */

int SerialRobot_openPort(SerialRobot *robot)
{
    return SerialRobot_runner(robot) == NULL
               ? -1
               : grobo_classic_end(robot, grobo_runner_open(robot->inside->runner), 0);
}

int SerialRobot_closePort(SerialRobot *robot)
{
    return SerialRobot_runner(robot) == NULL
               ? -1
               : grobo_classic_end(robot, grobo_runner_close(robot->inside->runner, 0), 0);
}

int SerialRobot_setDevice(SerialRobot *robot, const char *devname)
{
    if (SerialRobot_runner(robot) == NULL || devname == NULL) {
        return -1;
    }
    int r = grobo_runner_set_device(robot->inside->runner, devname);
    if (r >= 0) {
        memcpy(robot->inside->device, devname, strlen(devname) + 1);
    }
    return grobo_classic_end(robot, r, 0);
}

int SerialRobot_connect(SerialRobot *robot)
{
    return SerialRobot_runner(robot) == NULL
               ? -1
               : grobo_classic_end(robot, grobo_runner_connect(robot->inside->runner, 0), 1);
}

static int ask_check(classic_request *request, grobo_robot *engine)
{
    (void)request;
    return grobo_robot_check(engine);
}

int SerialRobot_checkConnection(SerialRobot *robot)
{
    return SerialRobot_runner(robot) == NULL
               ? -1
               : grobo_classic_ask(robot, (classic_request){.start = ask_check});
}

/* ---- the thread --------------------------------------------------------------------------- */

int SerialRobot_startThread(SerialRobot *robot)
{
    return SerialRobot_runner(robot) != NULL &&
           grobo_classic_end(robot, grobo_runner_start(robot->inside->runner), 0) == 0;
}

int SerialRobot_stopThread(SerialRobot *robot)
{
    return SerialRobot_runner(robot) == NULL ||
           grobo_classic_end(robot, grobo_runner_stop(robot->inside->runner), 0) < 0;
}

int SerialRobot_isActive(const SerialRobot *robot)
{
    return SerialRobot_runner(robot) != NULL && grobo_runner_is_active(robot->inside->runner);
}

int SerialRobot_svc(SerialRobot *robot)
{
    return SerialRobot_runner(robot) == NULL
               ? -1
               : grobo_classic_end(robot, grobo_runner_svc(robot->inside->runner), 0);
}

int SerialRobot_hThread(SerialRobot *robot, grobo_thread *thread)
{
    return SerialRobot_runner(robot) == NULL
               ? -1
               : grobo_classic_end(robot, grobo_runner_thread(robot->inside->runner, thread), 0);
}

GROBO_THREAD_FUNC thread_execution(void *args)
{
    if (SerialRobot_runner(args) != NULL) {
        (void)grobo_runner_run(SerialRobot_runner(args));
    }
    GROBO_THREAD_RETURN;
}

int SerialRobot_setTimeout(SerialRobot *robot, int val)
{
    if (robot != NULL) {
        robot->timeout = val;
    }
    return val;
}

int SerialRobot_getTimeout(const SerialRobot *robot)
{
    return robot != NULL ? robot->timeout : -1;
}

/* ---- raw commands ------------------------------------------------------------------------- */

int SerialRobot_setCommand(SerialRobot *robot, const char *packet, int len)
{
    if (SerialRobot_runner(robot) == NULL || packet == NULL || len < 0) {
        return -1;
    }
    if (len > SERIAL_ROBOT_COMMAND_BYTES) {
        return grobo_classic_end(robot, GROBO_ERR_CAP, 0);
    }
    memcpy(robot->commandBuf, packet, (size_t)len);
    robot->commandSize = len;
    return grobo_classic_end(robot, GROBO_OK, len);
}

/* Sends alone, as its reply is told from others by the time: behind what runs. One that is late is
 * not sent: nobody waits for it any more. */
static int ask_raw(classic_request *request, grobo_robot *engine)
{
    struct serial_robot_inside *inside = request->robot->inside;

    if (grobo_robot_job(engine) != GROBO_JOB_NONE) {
        return GROBO_ERR_STATE;
    }
    /* It may leave, and even be answered, before the request returns. */
    memcpy(inside->sending, request->text, request->size);
    inside->n_sending = request->size;
    int job =
        grobo_robot_raw_until(engine, inside->sending, inside->n_sending, request->end_us - 1);

    inside->n_sending = job > 0 ? inside->n_sending : 0;
    return job;
}

int SerialRobot_sendCommand(SerialRobot *robot, const char *data, int len)
{
    if (SerialRobot_runner(robot) == NULL || data == NULL || len < 0) {
        return -1;
    }
    int r = (size_t)len <= sizeof robot->inside->sending
                ? grobo_runner_connect(robot->inside->runner, 0)
                : GROBO_ERR_CAP;
    if (r < 0) {
        return grobo_classic_end(robot, r, 0);
    }
    r = grobo_classic_ask(robot,
                          (classic_request){.start = ask_raw, .text = data, .size = (size_t)len});
    return r < 0 ? r : len;
}

/* Where received bytes go. */
typedef struct taken {
    struct serial_robot_inside *inside;
    char *data;
    size_t size;
} taken;

static int take_received(void *arg)
{
    const taken *wanted = arg;
    struct serial_robot_inside *inside = wanted->inside;
    bool enough = inside->n_received >= wanted->size;

    if (enough) {
        memcpy(wanted->data, inside->received, wanted->size);
        memmove(inside->received, inside->received + wanted->size,
                inside->n_received - wanted->size);
    }
    int r = enough ? GROBO_OK : inside->n_received > 0 ? GROBO_ERR_SHORT : GROBO_ERR_TIMEOUT;
    inside->n_received = enough ? inside->n_received - wanted->size : 0;
    return r;
}

int SerialRobot_recieveData(SerialRobot *robot, char *data, int len)
{
    if (SerialRobot_runner(robot) == NULL || data == NULL || len < 0) {
        return -1;
    }
    taken wanted = {robot->inside, data, (size_t)len};
    return grobo_classic_end(robot, SerialRobot_locked(robot, take_received, &wanted), len);
}
