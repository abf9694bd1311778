/* SPDX-License-Identifier: MIT */
/* What a SerialRobot keeps, and that its functions do what the document says: without the frames,
 * which test_classic_frames.c compares. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/classic_alone.h"

/* The target that the engine has for a motor, 0.1 degree. */
static int target_of(int motor)
{
    grobo_posture target;
    int joint = SerialRobot_motorIdToJointId(g, motor);

    (void)grobo_robot_target(grobo_runner_robot(SerialRobot_runner(g)), &target);
    assert_true((target.set & GROBO_JOINT_BIT(joint)) != 0);
    return grobo_ddeg_from_rad(target.angle_rad[joint]);
}

static void begin_at_zero(void)
{
    assert_int_equal(SerialRobot_setMotionTime(g, 50), 0);
    assert_int_equal(SerialRobot_startMotion(g), 0);
    go();
}

/* Two postures of 100 ms: motor 2 at 3 and at 6 degrees. */
static void have_motion(void)
{
    RobotPosture posture;

    assert_int_equal(RobotPosture_init(&posture, 20), 0);
    (void)RobotPosture_setMotionTime(&posture, 100);
    SerialRobot_clearMotion(g);
    for (int i = 1; i <= 2; i++) {
        RobotPosture_setDegree(&posture, 2, 30 * i);
        assert_true(RobotMotion_appendPosture(g->motion, &posture));
    }
}

/* ---- fields --------------------------------------------------------------------------------- */

TEST_WITH(alone, torque_is_kept_by_motor)
{
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_int_equal(SerialRobot_setServoState(g, 5, 1), 1);
    assert_int_equal(g->servoState[4], 1); /* kept, and nothing is switched, as in the original */
    assert_int_equal(GR001_setTorque(g, 3, 1), 0);
    assert_int_equal(SerialRobot_getServoState(g)[2], 1);
    assert_int_equal(g->servoState[2], 1);
    assert_int_equal(g->servoState[0], 0);
    assert_int_equal(g->servoState[4], 0);
    assert_int_equal(GR001_setTorque(g, 9, 2), 0);
    assert_int_equal(GR001_setServo(g, 1, 1), 0); /* motors 1 and 2 */
    (void)SerialRobot_getServoState(g);
    for (int id = 1; id <= 20; id++) {
        assert_int_equal(g->servoState[id - 1], id == 9 ? 2 : id <= 3);
    }
    assert_true(GR001_servo(g, 13, false)); /* NECK_Y */
    assert_int_equal(SerialRobot_getServoState(g)[1], 0);
}

TEST_WITH(alone, postures_are_the_robots_own)
{
    double angle_rad[20] = {0};

    assert_int_equal(RobotPosture_getDegree(g->initPosture, 12), -400);
    RobotPosture_setDegree(g->initPosture, 2, 50);
    (void)RobotPosture_setMotionTime(g->initPosture, 50);
    assert_int_equal(SerialRobot_initPosition(g), 0);
    go();
    assert_int_equal(target_of(2), 50);
    assert_int_equal(target_of(12), -400);
    assert_ptr_equal(SerialRobot_getTargetPosture(g), g->targetPosture);
    assert_int_equal(RobotPosture_getDegree(SerialRobot_getTargetPosture(g), 2), 50);
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_ptr_equal(SerialRobot_getCurrentPosture(g), g->currentPosture);
    assert_true(abs(RobotPosture_getDegree(g->currentPosture, 2) - 50) <= 3);
    assert_true(abs(GR001_getAngle(g, 2) - 50) <= 3);
    GR001_readJointAngles(g, angle_rad);
    assert_true(fabs(grobo_deg_from_rad(angle_rad[1]) - 5) < 0.4);
    double *all_rad = GR001_getCurrentJointAngles(g);
    assert_non_null(all_rad);
    assert_true(fabs(grobo_deg_from_rad(all_rad[1]) - 5) < 0.4);
    assert_true(fabs(grobo_deg_from_rad(all_rad[9]) - 20) < 0.4);
}

TEST_WITH(alone, targets_are_set_in_motor_order)
{
    short ddeg[20] = {0, 20, 30};
    double angle_rad[20] = {0, 0.1};

    begin_at_zero();
    assert_int_equal(SerialRobot_setJoint(g, 2, 40), 0);
    assert_int_equal(SerialRobot_setMotionTime(g, 100), 0);
    assert_true(fabs(g->targetPosture->motionTime - 100) < 0.1);
    assert_int_equal(SerialRobot_startMotion(g), 0);
    go();
    assert_int_equal(target_of(2), 40);
    assert_int_equal(GR001_setJoints(g, ddeg, 5), 0);
    assert_int_equal(RobotPosture_getDegree(g->targetPosture, 3), 30);
    assert_true(fabs(g->targetPosture->motionTime - 50) < 0.1);
    assert_int_equal(GR001_oneStep(g), 0);
    go();
    assert_int_equal(target_of(3), 30);
    assert_int_equal(GR001_setTargetJointAngles(g, angle_rad), 0);
    go();
    assert_int_equal(target_of(2), 57);
    angle_rad[1] = 0.05;
    GR001_writeJointCommands(g, angle_rad);
    assert_int_equal(RobotPosture_getDegree(g->targetPosture, 2), 29);
    assert_int_equal(target_of(2), 57); /* nothing is sent */
    assert_int_equal(GR001_moveJoint(g, 4, -20, 5), 0);
    go();
    assert_int_equal(target_of(4), -20);
    assert_int_equal(GR001_setJointsFromString(g, "5 10 20 30"), 0);
    assert_int_equal(RobotPosture_getDegree(g->targetPosture, 3), 30);
    assert_int_equal(SerialRobot_jointIdToMotorId(g, 1), 11);
    assert_int_equal(GR001_jointIdToMotorId(g, 13), 2);
}

TEST_WITH(alone, times_are_kept)
{
    assert_int_equal(SerialRobot_getDefaultMotionTime(g), 300);
    assert_int_equal(SerialRobot_setDefaultMotionTime(g, 350), 350);
    assert_int_equal(SerialRobot_getDefaultMotionTime(g), 350);
    assert_int_equal(g->motionTime, 350);
    assert_int_equal(SerialRobot_setTimeout(g, 70), 70);
    assert_int_equal(SerialRobot_getTimeout(g), 70);
    assert_int_equal(g->timeout, 70);
    assert_int_equal(g->senseTime, 300);
}

TEST_WITH(alone, a_motion_is_counted_while_it_is_played)
{
    begin_at_zero();
    have_motion();
    assert_int_equal(SerialRobot_isMoving(g), 0);
    assert_int_equal(g->commandCount, 0);
    assert_false(g->executeMotion);
    assert_int_equal(SerialRobot_setMotionCount(g, 3), 3);
    assert_int_equal(g->repeatCount, 3);
    assert_int_equal(g->reverseFlag, 0);
    int most = 0;
    for (int before = 6; SerialRobot_isMoving(g);) {
        assert_in_range(g->commandCount, 0, before); /* one after the other leaves */
        before = g->executeMotion && g->commandCount > 0 ? g->commandCount : before;
        most = g->commandCount > most ? g->commandCount : most;
        assert_true(g->executeMotion || g->commandCount <= 1);
        assert_int_equal(SerialRobot_svc(g), 0);
    }
    assert_in_range(most, 3, 6); /* not of the present pass alone, which has 2 */
    assert_int_equal(g->commandCount, 0);
    assert_int_equal(target_of(2), 60);
    assert_int_equal(SerialRobot_setMotionCount(g, -1), 1);
    assert_int_equal(g->reverseFlag, 1);
    go();
    assert_int_equal(target_of(2), 30);
    SerialRobot_clearMotion(g);
    assert_int_equal(RobotMotion_getSize(g->motion), 0);
    assert_int_equal(SerialRobot_setMotionCount(g, 1), 0);
}

TEST_WITH(alone, what_moves_is_known_until_it_rests)
{
    begin_at_zero();
    assert_int_equal(SerialRobot_isMoving(g), 0);
    assert_int_equal(SerialRobot_setJoint(g, 2, 40), 0);
    assert_int_equal(SerialRobot_setMotionTime(g, 300), 0);
    assert_int_equal(SerialRobot_startMotion(g), 0);
    assert_int_equal(SerialRobot_isMoving(g), 1);
    assert_false(g->executeMotion); /* a move is no motion */
    assert_int_equal(g->commandCount, 1);
    go();
    assert_int_equal(SerialRobot_isMoving(g), 0);
}

TEST(a_directory_is_kept)
{
    char longer[GROBO_PATH_MAX_BYTES + 1];

    g = GR001_new("sim");
    assert_string_equal(g->motionDir, "");
    assert_int_equal(SerialRobot_setMotionDir(g, "/nowhere"), 0);
    assert_string_equal(g->motionDir, "/nowhere");
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    assert_int_equal(SerialRobot_setMotionDir(g, longer), -1);
    assert_string_equal(g->motionDir, "/nowhere");
    assert_int_equal(SerialRobot_loadMotion(g, "a"), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_NOENT);
    (void)tear_down();
}

/* ---- commands ------------------------------------------------------------------------------- */

TEST_WITH(alone, commands_are_kept_and_answered)
{
    char got[4] = {0};

    assert_int_equal(SerialRobot_setCommand(g, "\101\0", 2), 2);
    assert_int_equal(g->commandSize, 2);
    assert_memory_equal(g->commandBuf, "\101\0", 2);
    assert_int_equal(SerialRobot_sendCommand(g, g->commandBuf, g->commandSize), 2);
    assert_int_equal(SerialRobot_recieveData(g, got, 1), 1);
    assert_int_equal(got[0], 7); /* the board is there */
    assert_int_equal(SerialRobot_recieveData(g, got, 1), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_TIMEOUT);
    assert_int_equal(SerialRobot_sendCommand(g, "\101\0", 2), 2);
    assert_int_equal(SerialRobot_sendCommand(g, "\101\0", 2), 2);
    assert_int_equal(SerialRobot_recieveData(g, got, 3), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_SHORT);
    assert_true(grobo_session_serial(grobo_runner_session(SerialRobot_runner(g))) != NULL);
    assert_string_equal(g->com->device, "sim");
}

TEST(goals_are_packed_as_in_a_packet)
{
    char data[4];

    assert_int_equal(GR001_setDegMs(NULL, data, 900, 10), 1);
    assert_memory_equal(data, "\x84\x03\x0A\x00", 4); /* as in the packet of protocol 5 */
    assert_int_equal(GR001_setDegMs(NULL, data, -10, 300), 1);
    assert_memory_equal(data, "\xF6\xFF\x2C\x01", 4);
    assert_int_equal(GR001_setDegMs(NULL, data, -1500, 16383), 1);
    assert_memory_equal(data, "\x24\xFA\xFF\x3F", 4);
    assert_int_equal(GR001_setDegMs(NULL, data, 1501, 0), -1);
    assert_int_equal(GR001_setDegMs(NULL, data, -1501, 0), -1);
    assert_int_equal(GR001_setDegMs(NULL, data, 0, 16384), -1);
    assert_int_equal(GR001_setDegMs(NULL, NULL, 0, 0), -1);
    assert_memory_equal(data, "\x24\xFA\xFF\x3F", 4);
}

/* ---- for people, the record ----------------------------------------------------------------- */

/* What a function prints to standard error. */
static const char *printed(void (*print)(void))
{
    static char text[8192];
    FILE *file = tmpfile();
    int kept = dup(STDERR_FILENO);

    assert_non_null(file);
    assert_true(kept >= 0);
    (void)fflush(stderr);
    assert_true(dup2(fileno(file), STDERR_FILENO) >= 0);
    print();
    (void)fflush(stderr);
    assert_true(dup2(kept, STDERR_FILENO) >= 0);
    (void)close(kept);
    rewind(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    (void)fclose(file);
    return text;
}

static void print_volts(void)
{
    assert_true(abs(GR001_printVolts(g, 1) - 740) < 60);
}

static void print_currents(void)
{
    GR001_printCurrents(g, 1);
}

static void print_posture(void)
{
    GR001_printPosture(g);
}

TEST_WITH(alone, what_is_measured_is_printed)
{
    char line[64];

    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_true(abs(g->Volts[0] - 740) < 60);
    assert_in_range(g->Currents[19], 0, 200);
    const char *text = printed(print_volts);
    snprintf(line, sizeof line, " 1 CHEST_P      %6.2f V\n", g->Volts[0] / 100.0);
    assert_memory_equal(text, line, strlen(line));
    assert_non_null(strstr(text, "\nmean "));
    text = printed(print_currents);
    snprintf(line, sizeof line, "\n20 L_ANKLE_R    %6d mA\n", g->Currents[19]);
    assert_string_equal(strstr(text, "\n20"), line);
    text = printed(print_posture);
    assert_memory_equal(text, "                   right  middle    left\nneck yaw ", 49);
    assert_non_null(strstr(text, "\nknee pitch         -38.0            38.0\n"));
}

TEST_WITH(alone, a_record_is_made_by_hand_and_played)
{
    assert_int_equal(GR001_clearRecord(g), 0);
    assert_int_equal(RobotMotion_getSize(g->record), 0);
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_int_equal(GR001_recordCurrentPosture(g), 0);
    assert_int_equal(RobotMotion_getSize(g->record), 1);
    assert_int_equal(RobotPosture_getDegree(RobotMotion_get(g->record, 0), 12), -380);
    RobotPosture_setDegree(RobotMotion_get(g->record, 0), 2, 20);
    (void)RobotPosture_setMotionTime(RobotMotion_get(g->record, 0), 50);
    assert_int_equal(GR001_doRecord(g), 0);
    assert_int_equal(RobotMotion_getSize(g->motion), 1);
    go();
    assert_int_equal(target_of(2), 20);
}

/* A driver whose table says nothing of its size is none; what is left may be freed. */
TEST(a_driver_without_a_size_is_refused)
{
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    SerialRobot robot;

    assert_int_equal(grobo_driver_copy(&driver, grobo_gr001_driver(GROBO_WIRING_BUS)), GROBO_OK);
    driver.size = 0;
    assert_int_equal(SerialRobot_init(&robot, "sim", 0, &driver), -1);
    SerialRobot_deinit(&robot);
    assert_null(SerialRobot_new("sim", 0, &driver));
}

/* ---- beside another thread's requests ------------------------------------------------------ */

/* Another thread may use the runner below: what waits here waits behind what it asked for. */
TEST_WITH(alone, a_function_that_waits_is_not_refused_beside_a_move_of_another)
{
    grobo_robot *robot = grobo_runner_robot(SerialRobot_runner(g));
    grobo_posture target;
    int joint = SerialRobot_motorIdToJointId(g, 2);

    assert_int_equal(grobo_posture_init(&target, 20), GROBO_OK);
    target.time_us = 150000;
    for (int i = 0; i < 4; i++) {
        assert_int_equal(grobo_posture_set_deg(&target, joint, 2.0 * (i + 1)), GROBO_OK);
        int move = grobo_robot_move(robot, &target);
        assert_true(move > 0);
        int r = i == 0   ? GR001_setTorque(g, 2, 1)
                : i == 1 ? SerialRobot_sendCommand(g, "\x41\x00", 2) - 2
                : i == 2 ? (int)GR001_servo_name(g, "NECK_Y", true) - 1
                         : SerialRobot_checkConnection(g);
        assert_int_equal(r, 0);
        assert_false(grobo_robot_is_pending(robot, move) && i < 3);
        assert_int_equal(grobo_runner_wait_job(SerialRobot_runner(g), move, 0), GROBO_OK);
    }
}

/* ---- errors -------------------------------------------------------------------------------- */

TEST_WITH(alone, an_error_has_motor_joint_value_and_range_in_degrees)
{
    const grobo_joint *neck = grobo_model_joint(grobo_gr001_model(), 13);
    char text[160], wanted[160], small[8];

    assert_int_equal(SerialRobot_setJoint(g, 2, 1790), 0);
    assert_int_equal(SerialRobot_startMotion(g), -1);
    int n = snprintf(wanted, sizeof wanted,
                     "%s: motor 2 (NECK_Y), 179.0 deg is not within %.1f to %.1f deg",
                     grobo_error_text(GROBO_ERR_LIMIT), grobo_deg_from_rad(neck->min_rad),
                     grobo_deg_from_rad(neck->max_rad));
    assert_int_equal(SerialRobot_errorText(g, text, sizeof text), n);
    assert_string_equal(text, wanted);
    assert_int_equal(SerialRobot_errorText(g, small, sizeof small), (int)sizeof small - 1);
    assert_memory_equal(small, wanted, sizeof small - 1);
    assert_int_equal(SerialRobot_sendCommand(g, text, 10000), -1);
    assert_true(SerialRobot_errorText(g, text, sizeof text) > 0);
    assert_string_equal(text, grobo_error_text(GROBO_ERR_CAP));
    assert_int_equal(SerialRobot_errorText(g, NULL, 10), -1);
    assert_int_equal(SerialRobot_errorText(g, text, 0), -1);
    assert_int_equal(SerialRobot_errorText(NULL, text, sizeof text), -1);
}
