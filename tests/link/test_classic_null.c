/* SPDX-License-Identifier: MIT */
/* What the functions of the classic shelf do with NULL, and what they refuse: nothing is done, and
 * what they return says so. */
#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include <grobo/classic/classic.h>

#include "tests/support/test.h"
#include "tests/support/virtual_clock.h"

#define IS(value, call) assert_int_equal(call, value)
#define REFUSES(call) IS(-1, call)

/* ---- nobody ---------------------------------------------------------------------------------- */

TEST(no_port)
{
    char bytes[2] = {7, 8};

    REFUSES(SerialCom_init(NULL));
    REFUSES(SerialCom_init_devname(NULL, "x"));
    SerialCom_deinit(NULL);
    SerialCom_delete(NULL);
    REFUSES(SerialCom_setDevPort(NULL, "x"));
    REFUSES(SerialCom_openPort(NULL));
    SerialCom_closePort(NULL);
    REFUSES(SerialCom_Read(NULL, bytes, 1));
    REFUSES(SerialCom_Write(NULL, bytes, 1));
    REFUSES(SerialCom_recieveData(NULL, bytes, 1));
    REFUSES(SerialCom_sendData(NULL, bytes, 1));
    REFUSES(SerialCom_chkBuffer(NULL));
    REFUSES(SerialCom_clearBuffer(NULL));
    SerialCom_printPacket(NULL, NULL, 1);
    REFUSES(SerialCom_getBaudrate(NULL));
    REFUSES(SerialCom_setBaudrate(NULL, 9600));
    REFUSES(SerialCom_getMode(NULL));
    REFUSES(SerialCom_setMode(NULL, 1));
    REFUSES(SerialCom_isConnected(NULL));
    IS(7, bytes[0]);
}

TEST(no_posture)
{
    RobotPosture p;

    IS(0, RobotPosture_init(&p, 20));
    REFUSES(RobotPosture_init(NULL, 20));
    RobotPosture_deinit(NULL);
    RobotPosture_delete(NULL);
    assert_null(RobotPosture_dupPosture(NULL));
    assert_true(RobotPosture_setMotionTime(NULL, 5) == 5);
    IS(ROBOT_POSTURE_NO_ANGLE, RobotPosture_getDegree(NULL, 1));
    assert_true(RobotPosture_getRad(NULL, 1) == ROBOT_POSTURE_NO_ANGLE);
    RobotPosture_setDegree(NULL, 1, 1);
    RobotPosture_setRad(NULL, 1, 1);
    RobotPosture_printPosture(NULL);
    RobotPosture_printPosture_stream(NULL, stderr);
    RobotPosture_printPosture_stream(&p, NULL);
    RobotPosture_copyPosture(NULL, &p);
    RobotPosture_copyPosture(&p, NULL);
    RobotPosture_copyPosture_offset(NULL, &p, 1);
    RobotPosture_copyPosture_offset(&p, NULL, 1);
    assert_null(RobotPosture_getJointAngles(NULL));
    assert_null(RobotPosture_getJointAnglesRad(NULL));
    assert_false(RobotPosture_equalTo(NULL, &p));
    assert_false(RobotPosture_equalTo(&p, NULL));
    assert_false(RobotPosture_nearTo(NULL, &p, 1));
    assert_false(RobotPosture_nearTo(&p, NULL, 1));
    IS(20, p.numJoints);
}

TEST(no_motion)
{
    RobotMotion m;
    RobotPosture p;

    IS(0, RobotMotion_init(&m));
    IS(0, RobotPosture_init(&p, 20));
    REFUSES(RobotMotion_init(NULL));
    RobotMotion_deinit(NULL);
    RobotMotion_delete(NULL);
    REFUSES(RobotMotion_setJoints(NULL, 20));
    IS(0, RobotMotion_getSize(NULL));
    IS(1, RobotMotion_setReverse(NULL, true));
    REFUSES(RobotMotion_reset(NULL));
    assert_null(RobotMotion_next(NULL));
    assert_null(RobotMotion_get(NULL, 0));
    assert_null(RobotMotion_rget(NULL, 1));
    assert_false(RobotMotion_appendPosture(NULL, &p));
    assert_false(RobotMotion_appendPosture(&m, NULL));
    assert_false(RobotMotion_insertPosture(NULL, &p, 0));
    assert_false(RobotMotion_insertPosture(&m, NULL, 0));
    RobotMotion_deletePosture(NULL, 0);
    assert_false(RobotMotion_loadMotionFromFile(NULL, "x.m"));
    assert_false(RobotMotion_loadMotionFromFile(&m, NULL));
    assert_false(RobotMotion_saveMotionToFile(NULL, "/nowhere/x.m"));
    assert_false(RobotMotion_saveMotionToFile(&m, NULL));
    assert_false(RobotMotion_saveMotionToFile_dir(NULL, "x", "/nowhere"));
    assert_false(RobotMotion_saveMotionToFile_dir(&m, NULL, "/nowhere"));
    assert_false(RobotMotion_saveMotionToFile_dir(&m, "x", NULL));
    assert_false(RobotMotion_loadMotionFromMseqFile(&m, "x.mseq", NULL));
    assert_false(RobotMotion_loadMotionFromPseqFile(&m, "x.pseq", NULL));
    assert_false(RobotMotion_loadMotionFromYamlFile(&m, "x.yaml", NULL));
    assert_false(RobotMotion_saveMotionToPseqFile(&m, "/nowhere/x.pseq", NULL));
    assert_false(RobotMotion_saveMotionToYamlFile(&m, "/nowhere/x.yaml", NULL));
    RobotMotion_printMotion(NULL);
    RobotMotion_printMotion_stream(NULL, stderr);
    RobotMotion_printMotion_stream(&m, NULL);
    RobotMotion_clear(NULL);
    assert_false(RobotMotion_appendMotion(NULL, &m));
    assert_false(RobotMotion_appendMotion(&m, NULL));
    assert_null(RobotMotion_dupMotion(NULL));
    IS(0, RobotMotion_getSize(&m));
    RobotMotion_deinit(&m);
}

TEST(no_robot)
{
    char text[8] = "none";

    IS(GROBO_ERR_ARG, SerialRobot_error(NULL));
    REFUSES(SerialRobot_errorText(NULL, text, sizeof text));
    assert_null(SerialRobot_runner(NULL));
    REFUSES(SerialRobot_wait(NULL, 1));
    REFUSES(SerialRobot_estop(NULL));
    REFUSES(SerialRobot_reset(NULL));
    IS(GROBO_ERR_ARG, SerialRobot_locked(NULL, NULL, NULL));
    REFUSES(SerialRobot_init(NULL, "sim", 20, NULL));
    SerialRobot_deinit(NULL);
    SerialRobot_delete(NULL);
    REFUSES(SerialRobot_openPort(NULL));
    REFUSES(SerialRobot_closePort(NULL));
    REFUSES(SerialRobot_setDevice(NULL, "sim"));
    REFUSES(SerialRobot_startMotion(NULL));
    REFUSES(SerialRobot_initPosition(NULL));
    REFUSES(SerialRobot_appendCurrentPosture(NULL));
    REFUSES(SerialRobot_appendCurrentPosture_time(NULL, 5));
    REFUSES(SerialRobot_loadMotion(NULL, "x"));
    REFUSES(SerialRobot_loadMotionFromM(NULL, "x"));
    REFUSES(SerialRobot_loadMotionFromYaml(NULL, "x"));
    REFUSES(SerialRobot_loadMotionFromPseq(NULL, "x"));
    REFUSES(SerialRobot_loadMotionFromMseq(NULL, "x"));
    REFUSES(SerialRobot_saveMotionToM(NULL, "x"));
    REFUSES(SerialRobot_saveMotionToYaml(NULL, "x"));
    REFUSES(SerialRobot_saveMotionToPseq(NULL, "x"));
    IS(0, strcmp(text, "none"));
}

TEST(no_robot_of_which_more_is_asked)
{
    char text[8] = "none";

    REFUSES(SerialRobot_setJoint(NULL, 1, 1));
    REFUSES(SerialRobot_setMotionTime(NULL, 5));
    SerialRobot_clearMotion(NULL);
    REFUSES(SerialRobot_setDefaultMotionTime(NULL, 5));
    REFUSES(SerialRobot_getDefaultMotionTime(NULL));
    REFUSES(SerialRobot_getTimeout(NULL));
    REFUSES(SerialRobot_setCommand(NULL, text, 1));
    REFUSES(SerialRobot_recieveData(NULL, text, 1));
    REFUSES(SerialRobot_sendCommand(NULL, text, 1));
    assert_null(SerialRobot_getNthPosture(NULL, 0));
    REFUSES(SerialRobot_doNthMotion(NULL, 0));
    assert_null(SerialRobot_getTargetPosture(NULL));
    assert_null(SerialRobot_getCurrentPosture(NULL));
    assert_null(SerialRobot_getFirstPosture(NULL));
    assert_null(SerialRobot_getLastPosture(NULL));
    IS(0, SerialRobot_isMoving(NULL));
    IS(0, SerialRobot_isActive(NULL));
    REFUSES(SerialRobot_setMotionCount(NULL, 1));
    assert_null(SerialRobot_getServoState(NULL));
    IS(1, SerialRobot_setServoState(NULL, 1, 1));
    IS(70, SerialRobot_setTimeout(NULL, 70));
    REFUSES(SerialRobot_checkConnection(NULL));
    IS(ROBOT_POSTURE_NO_ANGLE, SerialRobot_getAngle(NULL, 1));
    REFUSES(SerialRobot_connect(NULL));
    REFUSES(SerialRobot_getPosture(NULL));
    REFUSES(SerialRobot_svc(NULL));
    REFUSES(SerialRobot_postureToCommand(NULL, NULL));
    REFUSES(SerialRobot_jointIdToMotorId(NULL, 1));
    REFUSES(SerialRobot_motorIdToJointId(NULL, 1));
    IS(0, SerialRobot_stabilizer(NULL));
    REFUSES(SerialRobot_setMotionDir(NULL, "."));
    IS(0, strcmp(text, "none"));
}

TEST(no_gr001)
{
    double rad[20] = {0};
    short ddeg[20] = {0};
    char text[8] = "none";
    const char *const names[] = {"NECK_Y"};
    int id = 7;

    REFUSES(GR001_init(NULL, "sim"));
    GR001_deinit(NULL);
    GR001_delete(NULL);
    REFUSES(GR001_connect_port(NULL, 0));
    REFUSES(GR001_connect(NULL));
    REFUSES(GR001_checkConnection(NULL));
    REFUSES(GR001_printVolts(NULL, 1));
    GR001_printCurrents(NULL, 1);
    GR001_printPosture(NULL);
    REFUSES(GR001_setTorque(NULL, 1, 1));
    REFUSES(GR001_setServo(NULL, 1, 0));
    IS(ROBOT_POSTURE_NO_ANGLE, GR001_getAngle(NULL, 1));
    REFUSES(GR001_moveJoint(NULL, 1, 0, 10));
    REFUSES(GR001_setJoints(NULL, ddeg, 10));
    REFUSES(GR001_setJointsFromString(NULL, "10 0"));
    REFUSES(GR001_activateMotionSlot(NULL, 1));
    REFUSES(GR001_activateSenario(NULL, 1));
    REFUSES(GR001_postureToCommand(NULL, NULL));
    assert_null(GR001_getCurrentJointAngles(NULL));
    REFUSES(GR001_setTargetJointAngles(NULL, rad));
    REFUSES(GR001_jointIdToMotorId(NULL, 1));
    REFUSES(GR001_motorIdToJointId(NULL, 1));
    IS(0, GR001_stabilizer(NULL));
    REFUSES(GR001_clearRecord(NULL));
    REFUSES(GR001_recordCurrentPosture(NULL));
    REFUSES(GR001_doRecord(NULL));
    REFUSES(GR001_setFreeMotion(NULL, 1));
    REFUSES(GR001_MoveJointPacket(NULL, 1, 0, 10, text, 8));
    REFUSES(GR001_PosturePacket(NULL, NULL, text, 8));
    REFUSES(GR001_MotorInfoPacket(NULL, 1, text, 8));
    REFUSES(GR001_ServoPacket(NULL, 1, 1, text, 8));
    assert_false(GR001_servo(NULL, 1, true));
    assert_false(GR001_servo_name(NULL, "all", true));
    rad[0] = 3;
    GR001_readJointAngles(NULL, rad);
    assert_true(rad[0] == 3);
    GR001_writeJointCommands(NULL, rad);
    assert_false(GR001_checkEmergency(NULL, text, sizeof text, &id));
    REFUSES(GR001_oneStep(NULL));
    assert_false(GR001_addJointGroup(NULL, "x", names, 1));
    assert_false(GR001_names2ids(NULL, names, 1, &id));
    IS(7, id);
    IS(0, strcmp(text, "none"));
}

/* ---- nothing --------------------------------------------------------------------------------- */

TEST(a_robot_is_given_nothing)
{
    GR001 *g = GR001_new("sim");
    char frame[128] = {0};

    assert_non_null(g);
    assert_int_equal(SerialRobot_connect(g), 1);
    IS(GROBO_ERR_ARG, SerialRobot_locked(g, NULL, NULL));
    REFUSES(SerialRobot_loadMotion(g, NULL));
    REFUSES(SerialRobot_saveMotionToYaml(g, NULL));
    REFUSES(SerialRobot_saveMotionToYaml(g, ""));
    REFUSES(SerialRobot_setCommand(g, NULL, 1));
    REFUSES(SerialRobot_setCommand(g, frame, -1));
    REFUSES(SerialRobot_recieveData(g, NULL, 1));
    REFUSES(SerialRobot_recieveData(g, frame, -1));
    REFUSES(SerialRobot_sendCommand(g, NULL, 1));
    REFUSES(SerialRobot_sendCommand(g, frame, -1));
    REFUSES(SerialRobot_postureToCommand(g, NULL));
    REFUSES(SerialRobot_setMotionDir(g, NULL));
    IS(0, SerialRobot_stabilizer(g));
    REFUSES(GR001_setDegMs(g, NULL, 0, 10));
    REFUSES(GR001_setJoints(g, NULL, 10));
    REFUSES(GR001_setJointsFromString(g, NULL));
    REFUSES(GR001_setTargetJointAngles(g, NULL));
    REFUSES(GR001_MoveJointPacket(g, 1, 0, 10, NULL, 128));
    REFUSES(GR001_PosturePacket(g, NULL, frame, 128));
    REFUSES(GR001_MotorInfoPacket(g, 1, NULL, 128));
    REFUSES(GR001_ServoPacket(g, 1, 1, NULL, 128));
    REFUSES(GR001_ServoPacket(g, 1, 3, frame, 128));
    REFUSES(GR001_ServoPacket(g, 1, -1, frame, 128));
    assert_false(GR001_servo_name(g, NULL, true));
    GR001_readJointAngles(g, NULL);
    GR001_writeJointCommands(g, NULL);
    assert_false(GR001_checkEmergency(g, NULL, 0, NULL));
    assert_false(GR001_addJointGroup(g, NULL, NULL, 1));
    assert_false(GR001_names2ids(g, NULL, 1, NULL));
    REFUSES(GR001_connect_port(g, -1));
    IS(0, frame[0]);
    GR001_delete(g);
}
