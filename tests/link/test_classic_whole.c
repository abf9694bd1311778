/* SPDX-License-Identifier: MIT */
/* The classic shelf to the last motor and the exact value: each of the twenty by itself, and what
 * functions return and keep as the reason where they refuse. In virtual time. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/classic_alone.h"
#include "tests/support/folder.h"

enum { MOTORS = 20 };

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
    assert_non_null(com.device);
    assert_string_equal(com.device, "/nowhere/port");
    assert_int_equal(SerialCom_Read(&com, bytes, 2), -1);
    assert_int_equal(SerialCom_Write(&com, bytes, 2), -1);
    assert_int_equal(SerialCom_recieveData(&com, bytes, 2), -1);
    assert_int_equal(SerialCom_sendData(&com, bytes, 2), -1);
    assert_int_equal(SerialCom_chkBuffer(&com), -1);
    assert_int_equal(SerialCom_clearBuffer(&com), -1);
    assert_int_equal(bytes[0], 7);
    assert_int_equal(SerialCom_setMode(&com, 1), 1);
    SerialCom_deinit(&com);
    assert_null(com.device);
    assert_int_equal(com.mode, 0);
    assert_int_equal(SerialCom_isConnected(&com), -1);
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

/* ---- what is played, kept and printed -------------------------------------------------------- */

/* Two postures of 100 and 250 ms, in which each motor has an angle of its own. */
static void make_motion(RobotMotion *motion)
{
    RobotPosture posture;

    assert_int_equal(RobotPosture_init(&posture, MOTORS), 0);
    for (int i = 0; i < 2; i++) {
        for (int id = 1; id <= MOTORS; id++) {
            RobotPosture_setDegree(&posture, id, angle_of(id) + i);
        }
        (void)RobotPosture_setMotionTime(&posture, i == 0 ? 100 : 250);
        assert_true(RobotMotion_appendPosture(motion, &posture));
    }
}

/* What print() writes to a stream, or to standard error. */
static const char *printed(void (*print)(FILE *stream), bool to_stderr)
{
    static char text[1024];
    FILE *file = tmpfile();
    int kept = dup(STDERR_FILENO);

    assert_true(file != NULL && kept >= 0);
    (void)fflush(stderr);
    assert_true(!to_stderr || dup2(fileno(file), STDERR_FILENO) >= 0);
    print(to_stderr ? NULL : file);
    (void)fflush(stderr);
    assert_true(dup2(kept, STDERR_FILENO) >= 0);
    (void)close(kept);
    rewind(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    (void)fclose(file);
    return text;
}

static void print_posture(FILE *stream)
{
    if (stream == NULL) {
        RobotPosture_printPosture(RobotMotion_get(g->motion, 0));
    } else {
        RobotPosture_printPosture_stream(RobotMotion_get(g->motion, 0), stream);
    }
}

static void print_motion(FILE *stream)
{
    if (stream == NULL) {
        RobotMotion_printMotion(g->motion);
    } else {
        RobotMotion_printMotion_stream(g->motion, stream);
    }
}

TEST_WITH(alone, postures_and_motions_are_printed)
{
    char lines[2][256], wanted[1024];

    make_motion(g->motion);
    for (int i = 0; i < 2; i++) {
        int n = 0;
        for (int id = 1; id <= MOTORS; id++) {
            n += snprintf(lines[i] + n, sizeof lines[i] - (size_t)n, " %d", angle_of(id) + i);
        }
        (void)snprintf(lines[i] + n, sizeof lines[i] - (size_t)n, "\n");
    }
    assert_string_equal(printed(print_posture, false), lines[0]);
    assert_string_equal(printed(print_posture, true), lines[0]);
    (void)snprintf(wanted, sizeof wanted, "100 %s350 %s", lines[0], lines[1]);
    assert_string_equal(printed(print_motion, false), wanted);
    (void)snprintf(wanted, sizeof wanted, "Posture[ 0 ] = 100:%sPosture[ 1 ] = 250:%s", lines[0],
                   lines[1]);
    assert_string_equal(printed(print_motion, true), wanted);
}

TEST_WITH(alone, each_motor_counts_when_postures_are_compared)
{
    RobotPosture a, b;

    assert_int_equal(RobotPosture_init(&a, MOTORS), 0);
    for (int id = 1; id <= MOTORS; id++) {
        RobotPosture_setDegree(&a, id, 100 * id);
    }
    RobotPosture_copyPosture(&b, &a);
    assert_int_equal(RobotPosture_init(&b, MOTORS), 0);
    RobotPosture_copyPosture(&b, &a);
    assert_true(RobotPosture_equalTo(&a, &b));
    assert_true(RobotPosture_nearTo(&a, &b, 1));
    assert_false(RobotPosture_nearTo(&a, &b, 0));
    for (int id = 1; id <= MOTORS; id++) {
        RobotPosture_setDegree(&b, id, 100 * id + 5);
        assert_false(RobotPosture_equalTo(&a, &b));
        assert_false(RobotPosture_nearTo(&a, &b, 5));
        assert_true(RobotPosture_nearTo(&a, &b, 6));
        RobotPosture_setDegree(&b, id, 100 * id);
    }
}

TEST_WITH(alone, a_motion_is_saved_under_a_plain_name_and_loaded_from_its_beginning)
{
    static const char *const files[] = {"a.m", "a.yaml", "a.pseq"};

    (void)folder_set_up();
    assert_int_equal(SerialRobot_setMotionDir(g, folder), 0);
    make_motion(g->motion);
    assert_int_equal(SerialRobot_saveMotionToM(g, "a"), 2);
    assert_int_equal(SerialRobot_saveMotionToYaml(g, "a"), 2);
    assert_int_equal(SerialRobot_saveMotionToPseq(g, "a"), 2);
    assert_int_equal(SerialRobot_saveMotionToYaml(g, "../a"), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_PERM);
    assert_int_equal(SerialRobot_saveMotionToPseq(g, ".a"), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_PERM);
    for (int i = 0; i < 3; i++) {
        int n = i == 0   ? SerialRobot_loadMotionFromM(g, "a")
                : i == 1 ? SerialRobot_loadMotionFromYaml(g, "a")
                         : SerialRobot_loadMotionFromPseq(g, "a");
        assert_true(i == 1 ? n > 2 : n == 2); /* frames at a rate */
        assert_int_equal(SerialRobot_error(g), GROBO_OK);
        assert_int_equal(g->motion->current, 0);
        RobotPosture *last = RobotMotion_rget(g->motion, 1);
        for (int id = 1; id <= MOTORS; id++) {
            assert_int_equal(RobotPosture_getDegree(last, id), angle_of(id) + 1);
        }
        assert_non_null(RobotMotion_next(g->motion));
        assert_non_null(RobotMotion_next(g->motion));
    }
    folder_remove(files, 3);
}

TEST_WITH(alone, one_motion_is_played_at_a_time)
{
    stand();
    make_motion(g->motion);
    assert_int_equal(SerialRobot_setMotionCount(g, 3), 3);
    assert_int_equal(SerialRobot_setMotionCount(g, 1), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_STATE);
    go();
    assert_int_equal(SerialRobot_setMotionCount(g, 1), 1);
    go();
}

/* ---- commands and packets -------------------------------------------------------------------- */

TEST_WITH(alone, a_posture_without_a_time_takes_the_default_time)
{
    RobotPosture posture;
    char with[128], without[128], command[SERIAL_ROBOT_COMMAND_BYTES] = {0};

    assert_int_equal(RobotPosture_init(&posture, MOTORS), 0);
    (void)RobotPosture_setMotionTime(&posture, 300);
    int n = GR001_PosturePacket(g, &posture, with, sizeof with);
    assert_true(n > 0);
    (void)RobotPosture_setMotionTime(&posture, 0);
    assert_int_equal(GR001_PosturePacket(g, &posture, without, sizeof without), n);
    assert_memory_equal(with, without, (size_t)n);
    assert_int_equal(SerialRobot_setCommand(g, command, sizeof command), sizeof command);
    assert_int_equal(g->commandSize, sizeof command);
}

static const RobotPosture *stabilized[2];

static int stabilize(SerialRobot *robot, const RobotPosture *current, RobotPosture *target)
{
    (void)robot;
    stabilized[0] = current;
    stabilized[1] = target;
    return 5;
}

TEST_WITH(alone, a_stabilizer_gets_the_robots_postures)
{
    g->stabilizer = stabilize;
    assert_int_equal(GR001_stabilizer(g), 5);
    assert_ptr_equal(stabilized[0], g->currentPosture);
    assert_ptr_equal(stabilized[1], g->targetPosture);
}

TEST_WITH(alone, a_reason_is_cut_and_a_port_is_the_robots)
{
    char reason[6] = "xxxxx";

    assert_int_equal(SerialCom_setDevPort(g->com, "/nowhere/port"), -1); /* it is open */
    assert_int_equal(SerialRobot_estop(g), 0);
    for (int i = 0; i < 1000 && !GR001_checkEmergency(g, reason, sizeof reason, NULL); i++) {
        assert_int_equal(SerialRobot_svc(g), 0);
    }
    assert_string_equal(reason, "emerg");
    assert_int_equal(SerialRobot_closePort(g), 0);
    assert_int_equal(SerialCom_setDevPort(g->com, "/nowhere/port"), 0);
    assert_string_equal(g->com->device, "/nowhere/port");
    assert_int_equal(SerialRobot_connect(g), -1);
}

/* ---- objects in storage of one's own --------------------------------------------------------- */

TEST(a_fresh_posture_is_the_documents)
{
    RobotPosture p;

    assert_int_equal(RobotPosture_init(&p, MOTORS), 0);
    assert_int_equal(p.numJoints, MOTORS);
    assert_true(p.motionTime == 100);
    for (int id = 1; id <= MOTORS; id++) {
        assert_int_equal(p.jointAngles[id - 1], 0);
        assert_true(p.jointAnglesRad[id - 1] == 0);
    }
    RobotPosture_setDegree(&p, MOTORS, 900);
    assert_int_equal(p.jointAngles[MOTORS - 1], 900);
    assert_true(fabs(p.jointAnglesRad[MOTORS - 1] - deg2rad(90)) < 1e-12);
    RobotPosture_setRad(&p, 1, deg2rad(-45));
    assert_int_equal(p.jointAngles[0], -450);
    assert_true(fabs(p.jointAnglesRad[0] - deg2rad(-45)) < 1e-12);
    assert_int_equal(p.jointAngles[1], 0);
    RobotPosture_deinit(&p);
    assert_int_equal(p.numJoints, 0);
    assert_int_equal(RobotPosture_init(&p, GROBO_JOINTS_MAX), 0);
    assert_int_equal(p.numJoints, GROBO_JOINTS_MAX);
    assert_int_equal(RobotPosture_init(&p, GROBO_JOINTS_MAX + 1), -1);
    assert_int_equal(RobotPosture_init(&p, -1), -1);
}

TEST(a_motion_goes_both_ways)
{
    RobotMotion m;

    g = NULL;
    assert_int_equal(RobotMotion_init(&m), 0);
    assert_int_equal(m.numJoints, 0);
    assert_int_equal(m.current, 0);
    assert_false(m.reverse);
    assert_int_equal(RobotMotion_setJoints(&m, MOTORS), MOTORS);
    assert_int_equal(m.numJoints, MOTORS);
    assert_int_equal(RobotMotion_setJoints(&m, GROBO_JOINTS_MAX + 1), -1);
    assert_int_equal(m.numJoints, MOTORS);
    for (int i = 0; i < 3; i++) {
        assert_true(RobotMotion_appendPosture(&m, RobotPosture_new(MOTORS)));
        RobotPosture_setDegree(RobotMotion_get(&m, i), 1, i);
    }
    for (int i = 0; i < 5; i++) {
        assert_int_equal(m.current, i % 3);
        assert_int_equal(RobotPosture_getDegree(RobotMotion_next(&m), 1), i % 3);
    }
    assert_int_equal(RobotMotion_setReverse(&m, true), 1);
    assert_true(m.reverse);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(m.current, 2 - i % 3);
        assert_int_equal(RobotPosture_getDegree(RobotMotion_next(&m), 1), 2 - i % 3);
    }
    assert_int_equal(RobotMotion_reset(&m), 2);
    assert_int_equal(RobotMotion_setReverse(&m, false), 0);
    assert_int_equal(m.current, 0);
    assert_int_equal(RobotMotion_getSize(&m), 3);
    RobotMotion_deinit(&m);
    assert_int_equal(RobotMotion_getSize(&m), 0);
    assert_null(m.motion);
}

TEST(a_robot_in_ones_own_storage_opens_and_closes)
{
    SerialRobot robot;

    assert_int_equal(SerialRobot_init(&robot, "sim", 19, NULL), -1);
    assert_int_equal(SerialRobot_init(&robot, "sim", MOTORS, NULL), 0);
    assert_string_equal(robot.name, "GR001");
    assert_int_equal(robot.joints, MOTORS);
    assert_int_equal(robot.motionTime, 300);
    assert_int_equal(robot.repeatCount, 1);
    assert_string_equal(robot.com->device, "sim");
    assert_int_equal(SerialRobot_openPort(&robot), 0);
    assert_int_equal(SerialRobot_connect(&robot), 1);
    assert_int_equal(SerialCom_isConnected(robot.com), 1);
    assert_int_equal(SerialRobot_setDevice(&robot, "/nowhere/port"), -1); /* it is open */
    assert_string_equal(robot.com->device, "sim");
    assert_int_equal(SerialRobot_closePort(&robot), 0);
    assert_int_equal(SerialCom_isConnected(robot.com), -1);
    assert_int_equal(SerialRobot_setDevice(&robot, "/nowhere/port"), 0);
    assert_string_equal(robot.com->device, "/nowhere/port");
    assert_int_equal(SerialRobot_openPort(&robot), -1);
    assert_true(SerialRobot_error(&robot) < 0);
    SerialRobot_deinit(&robot);
    assert_null(SerialRobot_runner(&robot));
}

TEST(a_gr001_in_ones_own_storage_connects)
{
    GR001 robot;

    assert_int_equal(GR001_init(&robot, "sim"), 0);
    assert_int_equal(RobotPosture_getDegree(robot.initPosture, 12), -400);
    assert_int_equal(RobotPosture_getDegree(robot.initPosture, 2), 0);
    assert_int_equal(GR001_checkConnection(&robot), -1); /* closed */
    assert_int_equal(GR001_connect(&robot), 1);
    assert_true(GR001_checkConnection(&robot) >= 0);
    assert_int_equal(GR001_connect_port(&robot, 7), -1); /* it is open */
    assert_string_equal(robot.com->device, "sim");
    assert_int_equal(SerialRobot_closePort(&robot), 0);
    assert_int_equal(GR001_connect_port(&robot, 987), -1);
    char named[32];
    (void)snprintf(named, sizeof named, GROBO_SERIAL_NAME_FORM, 987);
    assert_string_equal(robot.com->device, named);
    GR001_deinit(&robot);
    assert_null(SerialRobot_runner(&robot));
}

TEST_WITH(alone, a_posture_becomes_the_command)
{
    RobotPosture posture;
    char packet[128];

    assert_int_equal(RobotPosture_init(&posture, MOTORS), 0);
    for (int id = 1; id <= MOTORS; id++) {
        RobotPosture_setDegree(&posture, id, angle_of(id));
    }
    (void)RobotPosture_setMotionTime(&posture, 500);
    int n = GR001_PosturePacket(g, &posture, packet, sizeof packet);
    assert_true(n > 0);
    assert_int_equal(SerialRobot_postureToCommand(g, &posture), 0);
    assert_int_equal(g->commandSize, n);
    assert_memory_equal(g->commandBuf, packet, (size_t)n);
}
