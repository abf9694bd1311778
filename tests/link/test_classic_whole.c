/* SPDX-License-Identifier: MIT */
/* The classic shelf to the last motor and the exact value: each of the twenty by itself, and what
 * functions return and keep as the reason where they refuse. In virtual time. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/classic/classic.h>

#include "tests/support/test.h"
#include "tests/support/virtual_clock.h"

enum { MOTORS = 20 };

static GR001 *g;

static int set_up(void)
{
    g = GR001_new("sim");
    assert_non_null(g);
    return SerialRobot_connect(g) == 1 ? 0 : -1;
}

static int tear_down(void)
{
    GR001_delete(g);
    g = NULL;
    return 0;
}

static const test_fixture alone[] = {{NULL, set_up, tear_down}};

static void go(void)
{
    assert_int_equal(SerialRobot_wait(g, 20000), 0);
}

/* Two degrees from where the motor stands at first, to one side and to the other. */
static int angle_of(int id)
{
    return RobotPosture_getDegree(g->initPosture, id) + (id % 2 == 0 ? 20 : -20);
}

/* The original's corrections of what it reads of the knees. */
static int corrected(int id)
{
    return id == 12 ? 20 : id == 18 ? -20 : 0;
}

static void stand(void)
{
    for (int id = 1; id <= MOTORS; id++) {
        assert_int_equal(SerialRobot_setJoint(g, (unsigned char)id, (short)angle_of(id)), 0);
    }
    assert_int_equal(SerialRobot_setMotionTime(g, 300), 0);
    assert_int_equal(SerialRobot_startMotion(g), 0);
    go();
}

/* ---- each motor ------------------------------------------------------------------------------ */

TEST_WITH(alone, each_motor_is_where_it_was_sent)
{
    double rad[MOTORS];

    stand();
    assert_int_equal(SerialRobot_getPosture(g), 0);
    GR001_readJointAngles(g, rad);
    const double *current_rad = GR001_getCurrentJointAngles(g);
    assert_non_null(current_rad);
    for (int id = 1; id <= MOTORS; id++) {
        int ddeg = angle_of(id) + corrected(id);
        assert_in_range(RobotPosture_getDegree(g->currentPosture, id) - ddeg + 3, 0, 6);
        assert_in_range(SerialRobot_getAngle(g, (unsigned char)id) - ddeg + 3, 0, 6);
        assert_true(fabs(rad[id - 1] - deg2rad(1) * ddeg / 10) < 0.006);
        assert_true(fabs(current_rad[id - 1] - deg2rad(1) * ddeg / 10) < 0.006);
        assert_in_range(g->Volts[id - 1], 680, 800);
        assert_int_equal(SerialRobot_getServoState(g)[id - 1], 1);
    }
    assert_int_equal(SerialRobot_appendCurrentPosture(g), 1);
    for (int id = 1; id <= MOTORS; id++) {
        int ddeg = RobotPosture_getDegree(RobotMotion_get(g->motion, 0), id);
        assert_in_range(ddeg - angle_of(id) - corrected(id) + 3, 0, 6);
    }
    assert_true(RobotMotion_get(g->motion, 0)->motionTime == 300);
}

TEST_WITH(alone, each_motor_is_told_by_itself)
{
    double rad[MOTORS];
    short ddeg[MOTORS];

    for (int id = 1; id <= MOTORS; id++) {
        ddeg[id - 1] = (short)angle_of(id);
        rad[id - 1] = deg2rad(1) * (angle_of(id) + 10) / 10;
    }
    assert_int_equal(GR001_setJoints(g, ddeg, 30), 0);
    assert_true(g->targetPosture->motionTime == 300);
    for (int id = 1; id <= MOTORS; id++) {
        assert_int_equal(RobotPosture_getDegree(g->targetPosture, id), angle_of(id));
    }
    GR001_writeJointCommands(g, rad);
    for (int id = 1; id <= MOTORS; id++) {
        assert_int_equal(RobotPosture_getDegree(g->targetPosture, id), angle_of(id) + 10);
    }
    assert_int_equal(GR001_setJoints(g, ddeg, 0), 0);
    assert_true(g->targetPosture->motionTime == 0);
    for (int id = 1; id <= MOTORS; id++) {
        rad[id - 1] = deg2rad(1) * (angle_of(id) - 10) / 10;
    }
    assert_int_equal(GR001_setTargetJointAngles(g, rad), 0);
    for (int id = 1; id <= MOTORS; id++) {
        assert_int_equal(RobotPosture_getDegree(g->targetPosture, id), angle_of(id) - 10);
    }
}

/* ---- lines of text --------------------------------------------------------------------------- */

TEST_WITH(alone, a_line_begins_with_its_time)
{
    static const struct {
        const char *line;
        double time_ms;
    } rows[] = {
        {"1 5 6", 10},  {"999 5 6", 9990}, {"1000 5 6", 500},
        {"0 5 6", 500}, {"-20 5 6", 500},  {"\t30\r\n 5 6\n", 300},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        RobotPosture_setDegree(g->targetPosture, 1, 77);
        assert_int_equal(GR001_setJointsFromString(g, rows[i].line), 0);
        assert_true(g->targetPosture->motionTime == rows[i].time_ms);
        assert_int_equal(RobotPosture_getDegree(g->targetPosture, 1), 5);
        assert_int_equal(RobotPosture_getDegree(g->targetPosture, 2), 6);
    }
    static const struct {
        const char *line;
        int error;
    } bad[] = {
        {"", GROBO_ERR_EMPTY},
        {" \n", GROBO_ERR_EMPTY},
        {"10 x", GROBO_ERR_SYNTAX},
        {"10 5 32768", GROBO_ERR_CAP},
        {"10 -32769", GROBO_ERR_CAP},
        {"1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0", GROBO_ERR_CAP},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(GR001_setJointsFromString(g, bad[i].line), -1);
        assert_int_equal(SerialRobot_error(g), bad[i].error);
        assert_int_equal(RobotPosture_getDegree(g->targetPosture, 1), 5);
    }
    assert_int_equal(GR001_setJointsFromString(g, "1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 32767"),
                     0);
    assert_int_equal(RobotPosture_getDegree(g->targetPosture, 20), 32767);
}

/* ---- what is refused, and why ---------------------------------------------------------------- */

TEST(nothing_is_appended_that_was_not_read)
{
    g = GR001_new("sim");
    assert_int_equal(SerialRobot_appendCurrentPosture(g), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_STALE);
    assert_int_equal(GR001_recordCurrentPosture(g), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_STALE);
    assert_int_equal(RobotMotion_getSize(g->motion) + RobotMotion_getSize(g->record), 0);
    (void)tear_down();
}

TEST_WITH(alone, who_waits_too_short_is_told)
{
    assert_int_equal(SerialRobot_setJoint(g, 2, 200), 0);
    assert_int_equal(SerialRobot_setMotionTime(g, 3000), 0);
    assert_int_equal(SerialRobot_startMotion(g), 0);
    assert_int_equal(SerialRobot_wait(g, 100), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_TIMEOUT);
    go();
    assert_int_equal(SerialRobot_error(g), GROBO_OK);
}

TEST_WITH(alone, a_thread_is_shown_while_there_is_one)
{
    grobo_thread thread;

    memset(&thread, 0, sizeof thread);
    assert_int_equal(SerialRobot_hThread(g, &thread), -1);
    assert_true(SerialRobot_error(g) < 0);
    assert_int_equal(SerialRobot_numJoints(g), MOTORS);
    assert_int_equal(SerialRobot_numJoints(NULL), 0);
}

TEST_WITH(alone, a_stop_is_kept_until_it_is_reset)
{
    char reason[128] = "";
    int id = 7;

    stand();
    assert_int_equal(SerialRobot_estop(g), 0);
    for (int i = 0; i < 1000 && !GR001_checkEmergency(g, reason, sizeof reason, &id); i++) {
        assert_int_equal(SerialRobot_svc(g), 0);
    }
    assert_string_equal(reason, "emergency stop");
    assert_int_equal(id, -1);
    for (int i = 0; i < 1000 && memchr(SerialRobot_getServoState(g), 1, MOTORS) != NULL; i++) {
        assert_int_equal(SerialRobot_svc(g), 0);
    }
    for (int i = 1; i <= MOTORS; i++) {
        assert_int_equal(g->servoState[i - 1], 2); /* braked */
    }
    go();
    assert_int_equal(SerialRobot_startMotion(g), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_LATCHED);
    assert_int_equal(SerialRobot_reset(g), 0);
    assert_false(GR001_checkEmergency(g, reason, sizeof reason, &id));
    assert_int_equal(SerialRobot_startMotion(g), 0);
    go();
}

TEST_WITH(alone, names_are_motors_or_nothing_is_set)
{
    const char *const names[] = {"CHEST_P", "L_ANKLE_R"};
    const char *const wrong[] = {"CHEST_P", "TAIL"};
    int ids[2] = {-7, -7};

    assert_false(GR001_names2ids(g, wrong, 2, ids));
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_NOTFOUND);
    assert_int_equal(ids[0], -7);
    assert_true(GR001_names2ids(g, names, 2, ids));
    assert_int_equal(SerialRobot_error(g), GROBO_OK);
    assert_int_equal(ids[0], 1);
    assert_int_equal(ids[1], 20);
}

TEST(a_port_that_is_closed_gives_nothing)
{
    SerialCom com;
    char bytes[2] = {7, 7};

    assert_int_equal(SerialCom_init_devname(&com, "/nowhere/port"), 0);
    assert_string_equal(com.device, "/nowhere/port");
    assert_int_equal(SerialCom_Read(&com, bytes, 2), -1);
    assert_int_equal(SerialCom_Write(&com, bytes, 2), -1);
    assert_int_equal(SerialCom_recieveData(&com, bytes, 2), -1);
    assert_int_equal(SerialCom_sendData(&com, bytes, 2), -1);
    assert_int_equal(SerialCom_chkBuffer(&com), -1);
    assert_int_equal(SerialCom_clearBuffer(&com), -1);
    assert_int_equal(bytes[0], 7);
    SerialCom_deinit(&com);
}

/* ---- free mode ------------------------------------------------------------------------------- */

TEST_WITH(alone, a_person_may_move_the_joints_in_free_mode)
{
    stand();
    assert_int_equal(GR001_setFreeMotion(g, 1), 1);
    grobo_posture target;
    grobo_robot *engine = grobo_runner_robot(SerialRobot_runner(g));

    (void)grobo_robot_target(engine, &target);
    assert_int_equal(grobo_robot_send(engine, &target), GROBO_ERR_STATE);
    assert_int_equal(GR001_setFreeMotion(g, 0), 0);
    assert_int_equal(grobo_robot_send(engine, &target), GROBO_OK);
    assert_int_equal(SerialRobot_setJoint(g, 2, 0), 0);
    assert_int_equal(SerialRobot_startMotion(g), 0);
    go();
    assert_in_range(GR001_getAngle(g, 2) + 3, 0, 6);
}
