/* SPDX-License-Identifier: MIT */
/* What the classic shelf has besides what classic_kit.h compares with the original. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/classic/classic.h>

#include "tests/support/folder.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static GR001 *g;

static int set_up(void)
{
    g = GR001_new("sim");
    assert_non_null(g);
    return SerialRobot_connect(g) == 1 ? 0 : -1;
}

static int set_up_threaded(void)
{
    return set_up() == 0 && SerialRobot_startThread(g) == 1 ? 0 : -1;
}

static int tear_down(void)
{
    GR001_delete(g);
    g = NULL;
    return 0;
}

static const test_fixture alone[] = {{NULL, set_up, tear_down}};
static const test_fixture threaded[] = {{"threaded", set_up_threaded, tear_down}};
static const test_fixture robots[] = {{NULL, set_up, tear_down},
                                      {"threaded", set_up_threaded, tear_down}};

/* ---- SerialCom ---------------------------------------- */

TEST(a_port_has_the_documents_defaults)
{
    SerialCom com;

    assert_int_equal(SerialCom_init(&com), 0);
    assert_null(com.device);
    assert_int_equal(com.baudrate, 115200);
    assert_int_equal(com.mode, 0);
    assert_true(com.handle == GROBO_HANDLE_NULL);
    assert_int_equal(SerialCom_isConnected(&com), -1);
    assert_int_equal(SerialCom_openPort(&com), -1);
    assert_int_equal(SerialCom_setDevPort(&com, "/nowhere/port"), 0);
    assert_non_null(com.device);
    assert_string_equal(com.device, "/nowhere/port");
    assert_int_equal(SerialCom_openPort(&com), -1);
    assert_int_equal(SerialCom_setBaudrate(&com, 57600), 57600);
    assert_int_equal(SerialCom_getBaudrate(&com), 57600);
    assert_int_equal(SerialCom_setBaudrate(&com, -1), -1);
    assert_int_equal(SerialCom_getBaudrate(&com), 57600);
    assert_int_equal(SerialCom_setMode(&com, 1), 1);
    assert_int_equal(SerialCom_getMode(&com), 1);
    SerialCom_deinit(&com);
}

TEST(a_port_knows_the_constants_of_termios)
{
    SerialCom *com = SerialCom_new("/nowhere/port");

    assert_non_null(com);
    assert_int_equal(SerialCom_setBaudrate(com, 4098), 4098); /* B115200 of Linux */
    assert_int_equal(grobo_serial_baud(com->serial), 115200);
    assert_int_equal(SerialCom_setBaudrate(com, 13), 13); /* B9600 */
    assert_int_equal(grobo_serial_baud(com->serial), 9600);
    SerialCom_delete(com);
}

TEST_WITH(alone, the_port_of_a_robot_sends_nothing)
{
    char bytes[2] = {0x41, 0};

    assert_int_equal(SerialCom_isConnected(g->com), 1);
    assert_string_equal(g->com->device, "sim");
    assert_int_equal(SerialCom_Write(g->com, bytes, 2), -1);
    assert_int_equal(SerialCom_sendData(g->com, bytes, 2), -1);
    assert_int_equal(SerialCom_Read(g->com, bytes, 2), -1);
    assert_int_equal(SerialCom_recieveData(g->com, bytes, 2), -1);
    assert_int_equal(SerialCom_chkBuffer(g->com), -1);
    assert_int_equal(SerialCom_clearBuffer(g->com), -1);
    SerialCom_closePort(g->com);
    assert_int_equal(SerialCom_isConnected(g->com), -1);
    assert_int_equal(SerialRobot_setDevice(g, "sim"), 0);
}

/* ---- a posture in a motion ---------------------------------------- */

TEST(a_motion_owns_what_was_made_for_it_and_copies_the_rest)
{
    RobotMotion *m = RobotMotion_new();
    RobotPosture here;
    RobotPosture *made = RobotPosture_new(20);

    assert_int_equal(RobotPosture_init(&here, 20), 0);
    RobotPosture_setDegree(&here, 1, 5);
    assert_true(RobotMotion_appendPosture(m, &here));
    assert_true(RobotMotion_appendPosture(m, made));
    assert_true(RobotMotion_appendPosture(m, made)); /* again: a copy */
    assert_int_equal(RobotMotion_getSize(m), 3);
    assert_ptr_not_equal(RobotMotion_get(m, 0), &here);
    assert_ptr_equal(RobotMotion_get(m, 1), made);
    assert_ptr_not_equal(RobotMotion_get(m, 2), made);
    RobotPosture_delete(made); /* it belongs to the motion */
    assert_int_equal(RobotPosture_getDegree(RobotMotion_get(m, 0), 1), 5);
    assert_null(RobotMotion_get(m, 3));
    assert_null(RobotMotion_get(m, -1));
    assert_null(RobotMotion_rget(m, 0));
    assert_null(RobotMotion_rget(m, 4));
    RobotMotion_clear(m);
    assert_null(RobotMotion_next(m));
    RobotMotion_delete(m);
    RobotPosture_deinit(&here);
    assert_int_equal(here.numJoints, 0);
    assert_null(RobotPosture_new(GROBO_JOINTS_MAX + 1));
    assert_null(RobotPosture_new(-1));
}

TEST(files_of_choreonoid_are_written_and_read)
{
    static const char *const files[] = {"b.pseq", "b.yaml"};
    GR001 *robot = GR001_new("sim");
    RobotMotion m;
    RobotPosture posture;

    (void)folder_set_up();
    assert_int_equal(RobotMotion_init(&m), 0);
    assert_int_equal(RobotPosture_init(&posture, 20), 0);
    for (int i = 1; i <= 3; i++) {
        RobotPosture_setDegree(&posture, 2, 10 * i);
        RobotPosture_setMotionTime(&posture, 200);
        assert_true(RobotMotion_appendPosture(&m, &posture));
    }
    assert_true(RobotMotion_saveMotionToPseqFile(&m, in_folder("b.pseq"), robot));
    assert_true(RobotMotion_loadMotionFromPseqFile(&m, in_folder("b.pseq"), robot));
    assert_int_equal(RobotMotion_getSize(&m), 3);
    assert_int_equal(RobotPosture_getDegree(RobotMotion_get(&m, 2), 2), 30);
    assert_true(fabs(RobotMotion_get(&m, 2)->motionTime - 200) < 0.01);
    assert_true(RobotMotion_saveMotionToYamlFile(&m, in_folder("b.yaml"), robot));
    assert_true(RobotMotion_loadMotionFromYamlFile(&m, in_folder("b.yaml"), robot));
    RobotPosture *last = RobotMotion_rget(&m, 1);
    assert_int_equal(RobotPosture_getDegree(last, 2), 30);
    assert_false(RobotMotion_loadMotionFromYamlFile(&m, in_folder("none.yaml"), robot));
    assert_ptr_equal(RobotMotion_rget(&m, 1), last);
    assert_false(RobotMotion_saveMotionToYamlFile(&m, in_folder("b.yaml"), NULL));
    RobotMotion_deinit(&m);
    GR001_delete(robot);
    folder_remove(files, 2);
}

/* ---- a robot ---------------------------------------- */

TEST_WITH(alone, a_robot_has_the_documents_fields)
{
    assert_string_equal(g->name, "GR001");
    assert_int_equal(SerialRobot_numJoints(g), 20);
    assert_int_equal(g->joints, 20);
    assert_int_equal(g->motionTime, 300);
    assert_int_equal(g->senseTime, 300);
    assert_int_equal(SerialRobot_getTimeout(g), 500);
    assert_int_equal(SerialRobot_setTimeout(g, 20), 20);
    assert_int_equal(g->timeout, 20);
    assert_ptr_equal(SerialRobot_getTargetPosture(g), g->targetPosture);
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_int_equal(SerialRobot_getServoState(g)[0], 0);
    assert_int_equal(RobotPosture_getDegree(g->initPosture, 12), -400);
    assert_true(g->targetPosture->motionTime > 99 && g->targetPosture->motionTime < 101);
    for (int id = 1; id <= 20; id++) {
        assert_int_equal(RobotPosture_getDegree(g->targetPosture, id), 0);
    }
    assert_int_equal(SerialRobot_setCommand(g, "abc", 3), 3);
    assert_int_equal(g->commandSize, 3);
    assert_memory_equal(g->commandBuf, "abc", 3);
    assert_int_equal(SerialRobot_setCommand(g, "abc", SERIAL_ROBOT_COMMAND_BYTES + 1), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_CAP);
    assert_int_equal(g->commandSize, 3);
}

TEST_WITH(robots, joints_one_by_one_are_switched_and_moved)
{
    for (int id = 1; id <= 20; id++) {
        assert_int_equal(GR001_setTorque(g, (unsigned char)id, 1), 0);
    }
    for (int id = 1; id <= 20; id++) {
        assert_int_equal(SerialRobot_getServoState(g)[id - 1], 1);
    }
    assert_int_equal(GR001_moveJoint(g, 2, 30, 20), 0);
    assert_int_equal(GR001_moveJoint(g, 3, 240, 20), 0);
    assert_int_equal(SerialRobot_wait(g, 0), 0);
    assert_true(abs(SerialRobot_getAngle(g, 2) - 30) <= 3);
    assert_true(abs(GR001_getAngle(g, 3) - 240) <= 3);
    assert_int_equal(GR001_getAngle(g, 21), ROBOT_POSTURE_NO_ANGLE);
    assert_int_equal(GR001_setTorque(g, 0, 1), -1);
    assert_int_equal(GR001_setTorque(g, 1, 3), -1);
    assert_int_equal(GR001_setServo(g, 1, 8), -1);
    assert_int_equal(GR001_moveJoint(g, 1, 900, 20), -1); /* outside its limits */
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_LIMIT);
}

TEST_WITH(threaded, joints_have_names_and_groups)
{
    static const char *const hands[] = {"R_ELBOW_P", "l_elbow_p"};
    static const char *const nobody[] = {"R_ELBOW_P", "TAIL"};
    int ids[2] = {-7, -7};

    assert_true(GR001_names2ids(g, hands, 2, ids));
    assert_int_equal(ids[0], 5);
    assert_int_equal(ids[1], 8);
    assert_false(GR001_names2ids(g, nobody, 2, ids));
    assert_int_equal(ids[0], 5);
    assert_true(GR001_addJointGroup(g, "hands", hands, 2));
    assert_false(GR001_addJointGroup(g, "hands", hands, 2));
    assert_false(GR001_addJointGroup(g, "none", nobody, 2));
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_true(GR001_servo_name(g, "hands", true));
    for (int id = 1; id <= 20; id++) {
        assert_int_equal(SerialRobot_getServoState(g)[id - 1], id == 5 || id == 8);
    }
    assert_true(GR001_servo_name(g, "all", true));
    assert_int_equal(SerialRobot_getServoState(g)[19], 1);
    assert_false(GR001_servo_name(g, "TAIL", true));
    assert_false(GR001_servo(g, -1, true));
    assert_true(GR001_servo(g, 19, false)); /* L_ELBOW_P */
    assert_int_equal(SerialRobot_getServoState(g)[7], 0);
}

TEST_WITH(alone, voltages_are_read_and_meant)
{
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_true(abs(g->Volts[0] - 740) < 60);
    assert_true(abs(GR001_printVolts(g, 1) - 740) < 60);
    GR001_printCurrents(g, 1);
    GR001_printPosture(g);
}

TEST_WITH(threaded, an_emergency_is_told_and_ends)
{
    char reason[128] = "none";
    int id = 7;

    assert_false(GR001_checkEmergency(g, reason, sizeof reason, &id));
    assert_string_equal(reason, "none");
    assert_int_equal(id, 7);
    assert_int_equal(SerialRobot_estop(g), 0);
    assert_int_equal(SerialRobot_wait(g, 0), 0);
    while (!GR001_checkEmergency(g, reason, 8, &id)) {
        assert_int_equal(SerialRobot_svc(g), 0);
    }
    assert_int_equal(strlen(reason), 7);
    assert_int_equal(id, -1);
    assert_int_equal(SerialRobot_startMotion(g), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_LATCHED);
    while (SerialRobot_reset(g) < 0) {
        assert_int_equal(SerialRobot_svc(g), 0);
    }
    assert_false(GR001_checkEmergency(g, reason, sizeof reason, NULL));
}

static int level(SerialRobot *robot, const RobotPosture *current, RobotPosture *target)
{
    *(int *)robot->user += 1;
    RobotPosture_setDegree(target, 2, RobotPosture_getDegree(target, 2) + 50);
    return current->numJoints == 20 ? 0 : -1;
}

TEST_WITH(threaded, a_stabilizer_corrects_targets)
{
    int calls = 0;

    g->user = &calls;
    g->stabilizer = level;
    RobotPosture_copyPosture(g->targetPosture, g->initPosture);
    assert_int_equal(SerialRobot_startMotion(g), 0);
    assert_int_equal(SerialRobot_wait(g, 0), 0);
    assert_true(calls > 0);
    assert_true(abs(SerialRobot_getAngle(g, 2) - 50) <= 3);
    assert_int_equal(SerialRobot_stabilizer(g), 0);
    assert_int_equal(RobotPosture_getDegree(g->targetPosture, 2), 50);
    assert_int_equal(GR001_stabilizer(g), 0);
    assert_int_equal(RobotPosture_getDegree(g->targetPosture, 2), 100);
    g->stabilizer = NULL;
    assert_int_equal(SerialRobot_stabilizer(g), 0);
}

static void count_round(SerialRobot *robot)
{
    *(int *)robot->user += 1;
}

TEST(the_field_svc_is_called_each_timeout)
{
    int calls = 0;

    assert_int_equal(set_up(), 0);
    g->user = &calls;
    g->timeout = 10;
    g->svc = count_round;
    for (int i = 0; i < 1000 && calls < 3; i++) {
        assert_int_equal(SerialRobot_svc(g), 0);
    }
    assert_int_equal(calls, 3);
    (void)tear_down();
}

static int add_one(void *arg)
{
    return *(int *)arg + 1;
}

TEST_WITH(robots, the_loop_is_locked_for_a_function)
{
    int one = 41;

    assert_int_equal(SerialRobot_locked(g, add_one, &one), 42);
}

TEST(thread_execution_is_the_body_of_a_thread_of_ones_own)
{
    grobo_thread thread;

    assert_int_equal(set_up(), 0);
    assert_int_equal(grobo_thread_start(&thread, thread_execution, g), GROBO_OK);
    for (int64_t end_us = grobo_now_us() + 5000000; SerialRobot_isActive(g) == 0;) {
        assert_true(grobo_now_us() < end_us);
    }
    assert_true(SerialRobot_checkConnection(g) >= 0);
    assert_int_equal(SerialRobot_stopThread(g), 0);
    assert_int_equal(grobo_thread_join(thread), GROBO_OK);
    assert_int_equal(SerialRobot_isActive(g), 0);
    (void)tear_down();
}

TEST(the_thread_starts_and_stops)
{
    grobo_thread thread;

    assert_int_equal(set_up(), 0);
    assert_int_equal(SerialRobot_isActive(g), 0);
    assert_int_equal(SerialRobot_hThread(g, &thread), -1);
    assert_int_equal(SerialRobot_startThread(g), 1);
    assert_int_equal(SerialRobot_startThread(g), 0);
    assert_int_equal(SerialRobot_isActive(g), 1);
    assert_int_equal(SerialRobot_hThread(g, &thread), 0);
    assert_int_equal(SerialRobot_stopThread(g), 0);
    assert_int_equal(SerialRobot_stopThread(g), 1);
    assert_int_equal(SerialRobot_isActive(g), 0);
    assert_int_equal(SerialRobot_closePort(g), 0);
    assert_int_equal(SerialRobot_openPort(g), 0);
    (void)tear_down();
}

TEST_WITH(alone, packets_are_those_of_the_document)
{
    char bytes[128];
    RobotPosture posture;

    assert_int_equal(RobotPosture_init(&posture, 20), 0);
    RobotPosture_setDegree(&posture, 2, 200);
    assert_int_equal(GR001_MoveJointPacket(g, 3, -100, 50, bytes, 128), 14);
    assert_memory_equal(bytes, "\x53\x0c\xfa\xaf\x03\x00\x1e\x04\x01\x9c\xff\x32\x00", 13);
    assert_int_equal(GR001_MotorInfoPacket(g, 9, bytes, 128), 11);
    assert_memory_equal(bytes, "\x54\x09\xfa\xaf\x09\x0f\x24\x12\x00\x30\x1a", 11);
    assert_int_equal(GR001_ServoPacket(g, 20, 1, bytes, 128), 11);
    assert_memory_equal(bytes, "\x53\x09\xfa\xaf\x14\x00\x24\x01\x01\x01", 10);
    assert_int_equal(GR001_PosturePacket(g, &posture, bytes, 128), 110);
    assert_memory_equal(bytes + 9, "\x01\x00\x00\x0a\x00\x02\xc8\x00\x0a\x00", 10);
    assert_int_equal(GR001_PosturePacket(g, &posture, bytes, 109), -1);
    assert_int_equal(GR001_postureToCommand(g, &posture), 0);
    assert_int_equal(g->commandSize, 110);
    assert_int_equal(GR001_PosturePacket(g, &posture, bytes, 128), 110);
    assert_memory_equal(g->commandBuf, bytes, 110);
}

TEST_WITH(alone, what_is_raw_is_judged)
{
    static const char torque_on[] = "\x53\x09\xfa\xaf\x09\x00\x24\x01\x01\x01\x2c";
    char far_away[14];

    assert_int_equal(SerialRobot_sendCommand(g, torque_on, 11), -1);
    assert_int_equal(GR001_MoveJointPacket(g, 1, 900, 50, far_away, 14), 14);
    assert_int_equal(SerialRobot_sendCommand(g, far_away, 14), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_LIMIT);
    assert_int_equal(SerialRobot_recieveData(g, far_away, 1), -1);
}

TEST_WITH(alone, a_line_of_numbers_is_a_target)
{
    assert_int_equal(GR001_setJointsFromString(g, "50 0 20"), 0);
    assert_int_equal(RobotPosture_getDegree(g->targetPosture, 2), 20);
    assert_true(g->targetPosture->motionTime > 499 && g->targetPosture->motionTime < 501);
    assert_int_equal(GR001_setJointsFromString(g, "1000 0 30"), 0);
    assert_true(g->targetPosture->motionTime > 499 && g->targetPosture->motionTime < 501);
    assert_int_equal(GR001_setJointsFromString(g, "50 x"), -1);
    assert_int_equal(GR001_setJointsFromString(g, ""), -1);
    assert_int_equal(GR001_setJointsFromString(g, "1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1"),
                     -1);
    assert_int_equal(RobotPosture_getDegree(g->targetPosture, 2), 30);
}

TEST_WITH(alone, the_current_posture_is_appended_and_recorded)
{
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_int_equal(SerialRobot_appendCurrentPosture(g), 1);
    assert_int_equal(SerialRobot_appendCurrentPosture_time(g, 700), 2);
    assert_true(RobotMotion_get(g->motion, 0)->motionTime > 299);
    assert_true(RobotMotion_get(g->motion, 1)->motionTime > 699);
    assert_int_equal(RobotPosture_getDegree(RobotMotion_get(g->motion, 1), 10), 200);
    assert_int_equal(SerialRobot_appendCurrentPosture_time(g, 0), 3);
    assert_true(RobotMotion_get(g->motion, 2)->motionTime < 1);
    assert_int_equal(SerialRobot_setMotionCount(g, 0), 0);
    SerialRobot_clearMotion(g);
    assert_int_equal(SerialRobot_setMotionCount(g, 1), 0); /* empty */
    assert_null(SerialRobot_getFirstPosture(g));
    assert_null(SerialRobot_getLastPosture(g));
    assert_int_equal(SerialRobot_doNthMotion(g, 0), -1);
}

TEST_WITH(robots, a_motion_is_not_begun_twice)
{
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_int_equal(SerialRobot_appendCurrentPosture(g), 1);
    assert_int_equal(SerialRobot_appendCurrentPosture(g), 2);
    assert_int_equal(SerialRobot_setMotionCount(g, -2), 2);
    assert_int_equal(g->reverseFlag, 1);
    assert_int_equal(SerialRobot_isMoving(g), 1);
    assert_true(g->executeMotion);
    assert_int_equal(SerialRobot_setMotionCount(g, 1), -1);
    assert_int_equal(SerialRobot_wait(g, 0), 0);
    assert_int_equal(SerialRobot_setMotionCount(g, 1), 1);
    assert_int_equal(SerialRobot_setMotionCount(g, 0), 0); /* ends it */
    assert_int_equal(SerialRobot_wait(g, 0), 0);
    assert_int_equal(SerialRobot_isMoving(g), 0);
}

TEST(a_robot_of_ones_own)
{
    grobo_joint joints[3];
    grobo_model model =
        GROBO_TABLE(grobo_model, .name = "leg", GROBO_MODEL_JOINTS(joints), .n_joints = 3);
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);

    for (int j = 0; j < 3; j++) { /* motors 9, 11, 10: ids 1, 3, 2 */
        joints[j] = grobo_i_gr001_model.joints[j];
        joints[j].mirror = (uint8_t)j;
    }
    assert_int_equal(grobo_rs30x_driver_init(&driver, &model, &grobo_i_rs30x_protocol), GROBO_OK);
    SerialRobot *leg = SerialRobot_new("sim", 3, &driver);
    assert_non_null(leg);
    assert_null(SerialRobot_new("sim", 4, &driver));
    assert_int_equal(SerialRobot_jointIdToMotorId(leg, 1), 11);
    assert_int_equal(SerialRobot_motorIdToJointId(leg, 10), 2);
    assert_int_equal(SerialRobot_jointIdToMotorId(leg, 3), -1);
    assert_int_equal(SerialRobot_connect(leg), 1);
    assert_int_equal(SerialRobot_setJoint(leg, 3, -40), 0); /* motor 11 */
    assert_int_equal(SerialRobot_startMotion(leg), 0);
    assert_int_equal(SerialRobot_wait(leg, 0), 0);
    grobo_joint_info info;
    assert_int_equal(grobo_robot_joint(grobo_runner_robot(SerialRobot_runner(leg)), 1, &info), 0);
    assert_int_equal(grobo_ddeg_from_rad(info.target_rad), -40);
    SerialRobot_delete(leg);
}

TEST(motions_are_saved_and_loaded)
{
    static const char *const files[] = {"a.m", "a.pseq", "a.yaml"};
    RobotPosture posture;

    (void)folder_set_up();
    g = GR001_new("sim");
    assert_int_equal(SerialRobot_setMotionDir(g, folder), 0);
    assert_int_equal(RobotPosture_init(&posture, 20), 0);
    RobotPosture_setMotionTime(&posture, 500);
    for (int i = 1; i <= 2; i++) {
        RobotPosture_setDegree(&posture, 2, 100 * i);
        assert_true(RobotMotion_appendPosture(g->motion, &posture));
    }
    assert_int_equal(SerialRobot_saveMotionToPseq(g, "a"), 2);
    assert_int_equal(SerialRobot_loadMotionFromPseq(g, "a"), 2);
    assert_int_equal(SerialRobot_saveMotionToM(g, "a"), 2);
    assert_int_equal(SerialRobot_loadMotionFromM(g, "a.m"), 2);
    assert_int_equal(RobotPosture_getDegree(SerialRobot_getLastPosture(g), 2), 200);
    assert_int_equal(RobotPosture_getDegree(SerialRobot_getFirstPosture(g), 2), 100);
    assert_int_equal(SerialRobot_doNthMotion(g, 1), -1); /* it is not connected */
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_CLOSED);
    assert_int_equal(RobotPosture_getDegree(g->targetPosture, 2), 200);
    assert_true(g->targetPosture->motionTime < 1); /* the default time */
    assert_true(SerialRobot_saveMotionToYaml(g, "a") > 0);
    int frames = SerialRobot_loadMotionFromYaml(g, "a");
    assert_true(frames > 2);
    assert_int_equal(RobotPosture_getDegree(SerialRobot_getLastPosture(g), 2), 200);
    assert_int_equal(SerialRobot_loadMotionFromMseq(g, "a"), -1); /* there is none */
    assert_int_equal(RobotMotion_getSize(g->motion), 0);
    assert_int_equal(SerialRobot_saveMotionToM(g, "a.pseq"), -1); /* another format stays */
    (void)tear_down();
    folder_remove(files, 3);
}

TEST(files_stay_in_the_directory)
{
    static const char *const files[] = {"a.m"};

    (void)folder_set_up();
    assert_int_equal(set_up(), 0);
    assert_int_equal(SerialRobot_setMotionDir(g, folder), 0);
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_int_equal(SerialRobot_appendCurrentPosture(g), 1);
    assert_int_equal(SerialRobot_saveMotionToM(g, "../a"), -1);
    assert_int_equal(SerialRobot_saveMotionToM(g, "a"), 1);
    assert_int_equal(SerialRobot_loadMotion(g, "a"), 1);
    assert_int_equal(SerialRobot_loadMotion(g, "../a"), -1);
    FILE *file = fopen(in_folder("a.m"), "w");
    assert_true(file != NULL && fputs("500 0 0 0 0 0 0\n", file) >= 0 && fclose(file) == 0);
    assert_int_equal(SerialRobot_loadMotion(g, "a"), -1); /* six angles */
    assert_int_equal(RobotMotion_getSize(g->motion), 0);
    (void)tear_down();
    folder_remove(files, 1);
}

TEST(nothing_happens_without_an_object)
{
    char bytes[4];
    double reals[20];

    assert_int_equal(SerialCom_init(NULL), -1);
    SerialCom_deinit(NULL);
    SerialCom_delete(NULL);
    assert_int_equal(SerialCom_openPort(NULL), -1);
    assert_int_equal(SerialCom_Read(NULL, bytes, 1), -1);
    assert_int_equal(SerialCom_isConnected(NULL), -1);
    assert_int_equal(RobotPosture_init(NULL, 1), -1);
    RobotPosture_delete(NULL);
    assert_null(RobotPosture_dupPosture(NULL));
    assert_int_equal(RobotPosture_getDegree(NULL, 1), ROBOT_POSTURE_NO_ANGLE);
    RobotPosture_setDegree(NULL, 1, 1);
    RobotPosture_copyPosture(NULL, NULL);
    assert_false(RobotPosture_equalTo(NULL, NULL));
    assert_int_equal(RobotMotion_init(NULL), -1);
    RobotMotion_delete(NULL);
    assert_int_equal(RobotMotion_getSize(NULL), 0);
    assert_false(RobotMotion_appendPosture(NULL, NULL));
    assert_false(RobotMotion_loadMotionFromFile(NULL, NULL));
    assert_null(RobotMotion_dupMotion(NULL));
    assert_int_equal(SerialRobot_init(NULL, NULL, 0, NULL), -1);
    SerialRobot_delete(NULL);
    assert_int_equal(SerialRobot_connect(NULL), -1);
    assert_int_equal(SerialRobot_startMotion(NULL), -1);
    assert_int_equal(SerialRobot_setMotionCount(NULL, 1), -1);
    assert_int_equal(SerialRobot_sendCommand(NULL, bytes, 1), -1);
    assert_int_equal(SerialRobot_getAngle(NULL, 1), ROBOT_POSTURE_NO_ANGLE);
    assert_null(SerialRobot_getCurrentPosture(NULL));
    assert_int_equal(SerialRobot_isMoving(NULL), 0);
    assert_int_equal(SerialRobot_estop(NULL), -1);
    assert_int_equal(GR001_init(NULL, NULL), -1);
    assert_int_equal(GR001_setTorque(NULL, 1, 1), -1);
    assert_int_equal(GR001_setServo(NULL, 1, 0), -1);
    assert_int_equal(GR001_setJoints(NULL, NULL, 1), -1);
    assert_null(GR001_getCurrentJointAngles(NULL));
    assert_false(GR001_servo_name(NULL, "all", true));
    GR001_readJointAngles(NULL, reals);
    GR001_writeJointCommands(NULL, reals);
    assert_false(GR001_checkEmergency(NULL, NULL, 0, NULL));
    assert_int_equal(GR001_setDegMs(NULL, bytes, 2000, 1), -1);
}
