/* SPDX-License-Identifier: MIT */
/* GR001 of the classic shelf: its motors, its groups, its packets, its record. */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "src/classic/classic.h"

/* ---- making ------------------------------------------------------------------------------- */

int GR001_init(GR001 *robot, const char *devname)
{
    grobo_posture stands;

    if (SerialRobot_init(robot, devname, 20, NULL) < 0) {
        return -1;
    }
    grobo_posture_init_pose(&stands, grobo_classic_model(robot));
    grobo_classic_to_motors(robot, &stands, robot->initPosture);
    return 0;
}

void GR001_deinit(GR001 *robot)
{
    SerialRobot_deinit(robot);
}

GR001 *GR001_new(const char *devname)
{
    GR001 *robot = malloc(sizeof *robot);

    if (robot != NULL && GR001_init(robot, devname) < 0) {
        free(robot);
        return NULL;
    }
    return robot;
}

void GR001_delete(GR001 *robot)
{
    SerialRobot_delete(robot);
}

/* ---- connecting --------------------------------------------------------------------------- */

int GR001_connect_port(GR001 *robot, int n)
{
    char device[32] = GROBO_DEVICE_AUTO;

    if (n < 0) {
        return -1;
    }
    if (n > 0) {
        (void)snprintf(device, sizeof device, GROBO_SERIAL_NAME_FORM, n);
    }
    return SerialRobot_setDevice(robot, device) < 0 || SerialRobot_connect(robot) < 0 ? -1 : 0;
}

int GR001_connect(GR001 *robot)
{
    return SerialRobot_connect(robot);
}

int GR001_checkConnection(GR001 *robot)
{
    return SerialRobot_checkConnection(robot);
}

/* ---- for people --------------------------------------------------------------------------- */

int GR001_printVolts(GR001 *robot, int flag)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    if (flag != 0) {
        (void)grobo_classic_print_voltages(grobo_classic_engine(robot), stderr);
    }
    int mean_mv = grobo_classic_mean_mv(grobo_classic_engine(robot));
    (void)grobo_classic_refresh(robot);
    return mean_mv < 0 ? 0 : (mean_mv + 5) / 10;
}

void GR001_printCurrents(GR001 *robot, int flag)
{
    (void)flag;
    if (SerialRobot_runner(robot) != NULL) {
        (void)grobo_classic_print_currents(grobo_classic_engine(robot), stderr);
    }
}

void GR001_printPosture(GR001 *robot)
{
    grobo_posture posture;

    if (SerialRobot_runner(robot) != NULL) {
        (void)grobo_classic_refresh(robot);
        grobo_classic_to_joints(robot, robot->currentPosture, &posture);
        (void)grobo_classic_print_posture(&posture, stderr);
    }
}

/* ---- motors ------------------------------------------------------------------------------- */

/* Torque comes on where a motor stands: while one moves, its end is waited for. */
static int ask_torque(classic_request *request, grobo_robot *engine)
{
    return grobo_robot_torque(engine, request->joints, request->torque);
}

int grobo_classic_torque(SerialRobot *robot, grobo_joint_mask joints, char mode)
{
    if (mode < 0 || mode > 2) {
        return grobo_classic_end(robot, GROBO_ERR_ARG, 0);
    }
    return grobo_classic_ask(
        robot,
        (classic_request){.start = ask_torque, .joints = joints, .torque = (grobo_torque)mode});
}

int GR001_setTorque(GR001 *robot, unsigned char id, char val)
{
    int joint = SerialRobot_runner(robot) != NULL ? grobo_classic_joint(robot, id) : -1;

    return joint < 0 ? -1 : grobo_classic_torque(robot, GROBO_JOINT_BIT(joint), val);
}

int GR001_setServo(GR001 *robot, char on, int c)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    const grobo_model *model = grobo_classic_model(robot);
    return c < 0 || c >= model->n_groups ? grobo_classic_end(robot, GROBO_ERR_NOTFOUND, 0)
                                         : grobo_classic_torque(robot, model->groups[c].joints, on);
}

short GR001_getAngle(GR001 *robot, unsigned char id)
{
    return SerialRobot_getAngle(robot, id);
}

/* Of a goal: 10 ms, as the servos count. */
static bool is_time(unsigned cs)
{
    return cs <= GROBO_PLAY_TIME_MAX_US / GROBO_PLAY_TIME_UNIT_US;
}

/* Goal and time as they stand in a packet: registers No.30-33, little endian. */
int GR001_setDegMs(const GR001 *robot, char *data, short deg, unsigned short cs)
{
    (void)robot;
    if (data == NULL || deg < -1500 || deg > 1500 || !is_time(cs)) {
        return -1;
    }
    const uint8_t goal[] = {(uint8_t)(deg & 0xFF), (uint8_t)((unsigned)deg >> 8 & 0xFF),
                            (uint8_t)(cs & 0xFF), (uint8_t)(cs >> 8)};
    memcpy(data, goal, sizeof goal);
    return 1;
}

/* Moves one joint at once; 0 is one unit of time, which the engine stretches to what it can do. */
static int move_joint(GR001 *robot, int joint, int ddeg, unsigned cs)
{
    grobo_posture target;

    if (joint < 0 || !is_time(cs)) {
        return joint < 0 ? joint : GROBO_ERR_ARG;
    }
    (void)grobo_posture_init(&target, robot->joints);
    (void)grobo_posture_set_rad(&target, joint, grobo_rad_from_ddeg(ddeg));
    target.time_us = (cs == 0 ? 1 : cs) * (int64_t)GROBO_PLAY_TIME_UNIT_US;
    return grobo_robot_move(grobo_classic_engine(robot), &target);
}

int GR001_moveJoint(GR001 *robot, unsigned char id, short deg, unsigned short cs)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    int job = move_joint(robot, grobo_classic_joint(robot, id), deg, cs);

    robot->inside->job = job > 0 ? job : robot->inside->job;
    return grobo_classic_end(robot, job, 0);
}

/* ---- the target --------------------------------------------------------------------------- */

int GR001_setJoints(GR001 *robot, const short *deg, int cs)
{
    if (robot == NULL || deg == NULL) {
        return -1;
    }
    for (int i = 0; i < robot->joints; i++) {
        RobotPosture_setDegree(robot->targetPosture, i + 1, deg[i]);
    }
    (void)RobotPosture_setMotionTime(robot->targetPosture, cs > 0 ? cs * 10.0 : 0);
    return 0;
}

int GR001_setJointsFromString(GR001 *robot, const char *str)
{
    long number[1 + GROBO_JOINTS_MAX];
    int n = 0;
    char *end;

    if (SerialRobot_runner(robot) == NULL || str == NULL) {
        return -1;
    }
    for (const char *at = str + strspn(str, " \t\r\n"); *at != '\0';
         at = end + strspn(end, " \t\r\n")) {
        long value = strtol(at, &end, 10);
        if (end == at || n > robot->joints || value < SHRT_MIN || value > SHRT_MAX) {
            return grobo_classic_end(robot, end == at ? GROBO_ERR_SYNTAX : GROBO_ERR_CAP, 0);
        }
        number[n++] = value;
    }
    if (n == 0) {
        return grobo_classic_end(robot, GROBO_ERR_EMPTY, 0);
    }
    bool timed = number[0] > 0 && number[0] < 1000;
    (void)RobotPosture_setMotionTime(robot->targetPosture, timed ? (double)number[0] * 10 : 500);
    for (int i = 1; i < n; i++) {
        RobotPosture_setDegree(robot->targetPosture, i, (int)number[i]);
    }
    return grobo_classic_end(robot, GROBO_OK, 0);
}

double *GR001_getCurrentJointAngles(GR001 *robot)
{
    return SerialRobot_getPosture(robot) == 0
               ? RobotPosture_getJointAnglesRad(robot->currentPosture)
               : NULL;
}

int GR001_setTargetJointAngles(GR001 *robot, const double *rad)
{
    if (robot == NULL || rad == NULL) {
        return -1;
    }
    for (int i = 0; i < robot->joints; i++) {
        RobotPosture_setRad(robot->targetPosture, i + 1, rad[i]);
    }
    return SerialRobot_startMotion(robot);
}

int GR001_jointIdToMotorId(const GR001 *robot, int jid)
{
    return SerialRobot_jointIdToMotorId(robot, jid);
}

int GR001_motorIdToJointId(const GR001 *robot, int mid)
{
    return SerialRobot_motorIdToJointId(robot, mid);
}

int GR001_stabilizer(GR001 *robot)
{
    return SerialRobot_stabilizer(robot);
}

/* ---- kept in the board -------------------------------------------------------------------- */

static int ask_stored(classic_request *request, grobo_robot *engine)
{
    return grobo_robot_stored(engine, request->stored, request->number);
}

static int stored(GR001 *robot, grobo_stored_kind kind, int number)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    const classic_request request = {.start = ask_stored, .stored = kind, .number = number};

    return grobo_classic_ask(robot, request) < 0 ? -1 : 1;
}

int GR001_activateMotionSlot(GR001 *robot, unsigned char id)
{
    return stored(robot, GROBO_STORED_SLOT, id);
}

int GR001_activateSenario(GR001 *robot, unsigned char id)
{
    return stored(robot, GROBO_STORED_SCENARIO, id);
}

/* ---- the record --------------------------------------------------------------------------- */

int GR001_clearRecord(GR001 *robot)
{
    if (robot == NULL) {
        return -1;
    }
    RobotMotion_clear(robot->record);
    return 0;
}

int GR001_recordCurrentPosture(GR001 *robot)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    if (grobo_classic_refresh(robot) < robot->joints) {
        return grobo_classic_end(robot, GROBO_ERR_STALE, 0);
    }
    bool kept = RobotMotion_appendPosture(robot->record, robot->currentPosture);
    return grobo_classic_end(robot, kept ? GROBO_OK : GROBO_ERR_NOMEM, 0);
}

int GR001_doRecord(GR001 *robot)
{
    if (robot == NULL) {
        return -1;
    }
    SerialRobot_clearMotion(robot);
    return RobotMotion_appendMotion(robot->motion, robot->record) &&
                   SerialRobot_setMotionCount(robot, 1) > 0
               ? 0
               : -1;
}

/* ---- free mode ----------------------------------------------------------------------------- */

static int ask_free(classic_request *request, grobo_robot *engine)
{
    return grobo_robot_free(engine, request->joints, request->number == 1);
}

int GR001_setFreeMotion(GR001 *robot, int x)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    const classic_request request = {
        .start = ask_free, .joints = GROBO_JOINTS_ALL(robot->joints), .number = x};

    return grobo_classic_ask(robot, request) < 0 ? -1 : x;
}

/* ---- packets ------------------------------------------------------------------------------ */

/* Copies a frame that was built. */
static int give(int size, const uint8_t *frame, char *data, int room)
{
    if (size < 0 || size > room || data == NULL) {
        return -1;
    }
    memcpy(data, frame, (size_t)size);
    return size;
}

int GR001_postureToCommand(GR001 *robot, const RobotPosture *pos)
{
    return SerialRobot_postureToCommand(robot, pos);
}

int GR001_MoveJointPacket(const GR001 *robot, unsigned char id, short deg, unsigned short cs,
                          char *data, int room)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    const grobo_rs30x_goal goal = {.id = id, .pos_ddeg = deg, .time_cs = cs};

    return SerialRobot_runner(robot) == NULL
               ? -1
               : give(grobo_frame_goal(grobo_classic_protocol(robot), &goal, frame, sizeof frame),
                      frame, data, room);
}

int GR001_PosturePacket(const GR001 *robot, const RobotPosture *pos, char *data, int room)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    grobo_rs30x_goal goals[GROBO_JOINTS_MAX];

    if (SerialRobot_runner(robot) == NULL || pos == NULL || pos->numJoints != robot->joints) {
        return -1;
    }
    int64_t time_us = grobo_classic_time_us(pos->motionTime);
    int time_cs = time_us > 0 ? (int)(time_us / 10000) : robot->motionTime / 10;
    for (int i = 0; i < robot->joints; i++) {
        goals[i] = (grobo_rs30x_goal){.id = (uint8_t)(i + 1),
                                      .pos_ddeg = (int16_t)pos->jointAngles[i],
                                      .time_cs = (uint16_t)time_cs};
    }
    return give(grobo_frame_goals(grobo_classic_protocol(robot), goals, (size_t)robot->joints,
                                  frame, sizeof frame),
                frame, data, room);
}

int GR001_MotorInfoPacket(const GR001 *robot, unsigned char id, char *data, int room)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];

    return SerialRobot_runner(robot) == NULL
               ? -1
               : give(grobo_frame_read(grobo_classic_protocol(robot), id, GROBO_STATE_ADDRESS,
                                       GROBO_STATE_BYTES, frame, sizeof frame),
                      frame, data, room);
}

int GR001_ServoPacket(const GR001 *robot, unsigned char id, char val, char *data, int room)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];

    return SerialRobot_runner(robot) == NULL || val < 0 || val > 2
               ? -1
               : give(grobo_frame_torque(grobo_classic_protocol(robot), id, (grobo_torque)val,
                                         frame, sizeof frame),
                      frame, data, room);
}
