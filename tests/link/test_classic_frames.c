/* SPDX-License-Identifier: MIT */
/* What a GR001 of the classic shelf sends and returns, beside the original: classic_kit.h. */
#include <string.h>

#include "src/link/session/session.h"
#include "tests/support/classic_kit.h"
#include "tests/support/virtual_clock.h"

/* ---- a simulated robot in virtual time ----------------------------------------------------- */

static void (*theirs)(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                      size_t size);

/* What leaves, beside what the shelf looks at. */
static void note(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                 size_t size)
{
    if (direction == GROBO_DIR_TX) {
        words_bytes(bytes, size);
    }
    theirs(ctx, direction, now_us, bytes, size);
}

static void go(void)
{
    (void)SerialRobot_wait(g, 20000);
}

/* Waits until a frame with goals has left. */
static void sent(void)
{
    int64_t end_us = grobo_now_us() + 10000000;

    while (strstr(words_told(), "goals") == NULL) {
        assert_int_equal(SerialRobot_error(g), GROBO_OK);
        assert_true(grobo_now_us() < end_us);
        assert_int_equal(SerialRobot_svc(g), 0);
    }
}

static int set_up(void)
{
    classic_make_files();
    words_begin();
    g = GR001_new("sim");
    assert_non_null(g);
    grobo_session *session = grobo_runner_session(SerialRobot_runner(g));
    theirs = session->config.on_tap;
    session->config.on_tap = note;
    assert_int_equal(SerialRobot_connect(g), 1);
    assert_int_equal(SerialRobot_setMotionDir(g, folder), 0);
    assert_int_equal(GR001_setServo(g, 1, 0), 0);
    assert_int_equal(SerialRobot_startMotion(g), 0);
    go();
    return 0;
}

static int tear_down(void)
{
    GR001_delete(g);
    classic_remove_files();
    return 0;
}

TESTS_BETWEEN(set_up, tear_down)

/* ---- the statements -------------------------------------------------------------------------- */

static void rp11(void)
{
    RobotPosture_setDegree(g->targetPosture, 2, 200);
    (void)SerialRobot_setMotionTime(g, 400);
    (void)SerialRobot_startMotion(g);
    sent();
}

static void rp12(void)
{
    RobotPosture_setRad(g->targetPosture, 2, 0.1);
    (void)SerialRobot_startMotion(g);
    sent();
}

static void sr28(void)
{
    (void)SerialRobot_setJoint(g, 2, 30);
    (void)SerialRobot_setMotionTime(g, 200);
    (void)SerialRobot_startMotion(g);
    sent();
}

static void sr29(void)
{
    g->initPosture->motionTime = 900;
    (void)SerialRobot_initPosition(g);
    sent();
}

static void sr32(void)
{
    say(SerialRobot_loadMotion(g, "a"));
    say_motion(g->motion);
    say(SerialRobot_loadMotion(g, "none"));
    say(RobotMotion_getSize(g->motion));
}

static void sr33(void)
{
    say(SerialRobot_loadMotionFromM(g, "a.m"));
}

static void sr34(void)
{
    say(SerialRobot_loadMotionFromYaml(g, "a.yaml"));
}

static void sr35(void)
{
    say(SerialRobot_loadMotionFromPseq(g, "a.pseq"));
}

static void sr36(void)
{
    say(SerialRobot_loadMotionFromMseq(g, "a.mseq"));
}

static void sr37(void)
{
    (void)SerialRobot_loadMotion(g, "a");
    say(SerialRobot_saveMotionToM(g, NULL));
    say_file(in_folder("Motion0.m"));
}

static void sr40(void)
{
    (void)SerialRobot_setMotionTime(g, 400);
    say(SerialRobot_setJoint(g, 2, 200));
    (void)SerialRobot_startMotion(g);
    sent();
}

static void sr41(void)
{
    say(SerialRobot_setMotionTime(g, 700));
    (void)SerialRobot_startMotion(g);
    sent();
}

static void sr43(void)
{
    say(SerialRobot_setDefaultMotionTime(g, 350));
    say(SerialRobot_setDefaultMotionTime(g, 10000));
    (void)SerialRobot_setMotionTime(g, 0);
    (void)SerialRobot_startMotion(g);
    sent();
    (void)SerialRobot_setDefaultMotionTime(g, 300);
}

static void sr47(void)
{
    say(SerialRobot_setCommand(g, "\101\0", 2));
}

static void sr49(void)
{
    say(SerialRobot_sendCommand(g, "\101\0", 2));
    char b[1];
    say(SerialRobot_recieveData(g, b, 1));
    say(b[0]);
}

static void sr53(void)
{
    (void)SerialRobot_loadMotion(g, "a");
    say_posture(SerialRobot_getNthPosture(g, 0));
    say_posture(SerialRobot_getNthPosture(g, 1));
}

static void sr54(void)
{
    (void)SerialRobot_loadMotion(g, "a");
    (void)SerialRobot_doNthMotion(g, 1);
    sent();
}

static void sr57(void)
{
    (void)SerialRobot_loadMotion(g, "a");
    say_posture(SerialRobot_getFirstPosture(g));
    say_posture(SerialRobot_getLastPosture(g));
}

static void sr60(void)
{
    (void)SerialRobot_loadMotion(g, "a");
    say(SerialRobot_setMotionCount(g, 1));
    go();
}

static void sr60_twice(void)
{
    (void)SerialRobot_loadMotion(g, "a");
    (void)SerialRobot_setMotionCount(g, 2);
    go();
}

static void sr60_reverse(void)
{
    (void)SerialRobot_loadMotion(g, "a");
    (void)SerialRobot_setMotionCount(g, -1);
    go();
    g->reverseFlag = 0;
}

static void sr63(void)
{
    say(SerialRobot_setServoState(g, 3, 1));
}

static void sr64(void)
{
    say(SerialRobot_checkConnection(g));
}

static void sr65(void)
{
    (void)SerialRobot_setMotionTime(g, 300);
    (void)SerialRobot_setJoint(g, 9, -50);
    (void)SerialRobot_startMotion(g);
    go();
    say(SerialRobot_getAngle(g, 9));
    say(SerialRobot_getAngle(g, 12));
    say(SerialRobot_getAngle(g, 18));
}

static void sr66(void)
{
    say(SerialRobot_connect(g));
}

static void sr67(void)
{
    (void)SerialRobot_getPosture(g);
    say_posture(g->currentPosture);
}

static void sr70(void)
{
    say(SerialRobot_jointIdToMotorId(g, 1));
    say(SerialRobot_jointIdToMotorId(g, 0));
    say(SerialRobot_jointIdToMotorId(g, 19));
}

static void sr71(void)
{
    say(SerialRobot_motorIdToJointId(g, 9));
    say(SerialRobot_motorIdToJointId(g, 11));
    say(SerialRobot_motorIdToJointId(g, 21));
}

static void gr18(void)
{
    say(GR001_setTorque(g, 9, 0));
}

static void gr18_on(void)
{
    (void)GR001_setTorque(g, 9, 0);
    say(GR001_setTorque(g, 9, 1));
}

static void gr19_0(void)
{
    (void)GR001_setServo(g, 0, 0);
    (void)GR001_setServo(g, 1, 0);
}

static void gr19_1(void)
{
    (void)GR001_setServo(g, 0, 0);
    (void)GR001_setServo(g, 1, 1);
}

static void gr19_2(void)
{
    (void)GR001_setServo(g, 0, 0);
    (void)GR001_setServo(g, 1, 2);
}

static void gr19_3(void)
{
    (void)GR001_setServo(g, 0, 0);
    (void)GR001_setServo(g, 1, 3);
}

static void gr19_4(void)
{
    (void)GR001_setServo(g, 0, 0);
    (void)GR001_setServo(g, 1, 4);
}

static void gr19_5(void)
{
    (void)GR001_setServo(g, 0, 0);
    (void)GR001_setServo(g, 1, 5);
}

static void gr19_6(void)
{
    (void)GR001_setServo(g, 0, 0);
    (void)GR001_setServo(g, 1, 6);
}

static void gr19_7(void)
{
    (void)GR001_setServo(g, 0, 0);
    (void)GR001_setServo(g, 1, 7);
}

static void gr20(void)
{
    say(GR001_getAngle(g, 3));
}

static void gr21(void)
{
    char b[4];
    say(GR001_setDegMs(g, b, 900, 10));
    say((signed char)b[0]);
    say((signed char)b[1]);
    say((signed char)b[2]);
    say((signed char)b[3]);
}

static void gr22(void)
{
    (void)GR001_moveJoint(g, 9, -100, 40);
    sent();
}

static void gr23(void)
{
    short d[20] = {0, 20, 30};
    say(GR001_setJoints(g, d, 30));
    (void)SerialRobot_startMotion(g);
    sent();
}

static void gr24(void)
{
    say(GR001_setJointsFromString(g, " 50 0 0 30 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 "));
    (void)SerialRobot_startMotion(g);
    sent();
}

static void gr25(void)
{
    say(GR001_activateMotionSlot(g, 3));
}

static void gr26(void)
{
    say(GR001_activateSenario(g, 2));
}

static void gr28(void)
{
    say(GR001_getCurrentJointAngles(g)[11]);
}

static void gr29(void)
{
    double a[20] = {0, 0.1};
    (void)SerialRobot_setMotionTime(g, 300);
    say(GR001_setTargetJointAngles(g, a));
    sent();
}

static void gr30(void)
{
    say(GR001_jointIdToMotorId(g, 1));
    say(GR001_jointIdToMotorId(g, 13));
}

static void gr31(void)
{
    say(GR001_motorIdToJointId(g, 2));
}

static void gr33(void)
{
    say(GR001_clearRecord(g));
    say(RobotMotion_getSize(g->record));
}

static void gr34(void)
{
    (void)GR001_clearRecord(g);
    (void)SerialRobot_getPosture(g);
    say(GR001_recordCurrentPosture(g));
    say_posture(RobotMotion_get(g->record, 0));
    (void)GR001_clearRecord(g);
}

static void gr35(void)
{
    (void)GR001_clearRecord(g);
    (void)RobotMotion_appendPosture(g->record, RobotPosture_dupPosture(p));
    RobotPosture_setDegree(q, 2, 20);
    (void)RobotPosture_setMotionTime(q, 200);
    (void)RobotMotion_appendPosture(g->record, RobotPosture_dupPosture(q));
    say(GR001_doRecord(g));
    go();
}

static void gr36(void)
{
    (void)GR001_setServo(g, 0, 0);
    say(GR001_servo(g, 13, true));
}

static void gr38(void)
{
    (void)SerialRobot_getPosture(g);
    double a[20];
    GR001_readJointAngles(g, a);
    say(a[11]);
    say(a[1]);
}

static void gr39(void)
{
    double a[20] = {0, 0.1};
    (void)SerialRobot_setMotionTime(g, 300);
    GR001_writeJointCommands(g, a);
    (void)GR001_oneStep(g);
    sent();
}

static void gr41(void)
{
    (void)SerialRobot_setJoint(g, 2, 40);
    (void)SerialRobot_setMotionTime(g, 300);
    (void)GR001_oneStep(g);
    sent();
}

static const statement statements[] = {
    /* clang-format off */
    {"RP11", rp11,
     "g->targetPosture->setDegree(2, 200); g->setMotionTime(400); "
     "g->startMotion(); go();",
     NULL,
     NULL},
    {"RP12", rp12,
     "g->targetPosture->setRad(2, 0.1); g->startMotion(); go();",
     "goals 20 in 20: 2=57",
     "its setRad() is never sent"},
    {"SR28", sr28,
     "g->setJoint(2, 30); g->setMotionTime(200); g->startMotion(); go();",
     NULL,
     NULL},
    {"SR29", sr29,
     "g->initPosture->motionTime = 900; g->initPosition(); go();",
     NULL,
     NULL},
    {"SR32", sr32,
     "say(g->loadMotion((char *)\"a\")); say_motion(g->motion); "
     "say(g->loadMotion((char *)\"none\")); say(g->motion->getSize());",
     NULL,
     NULL},
    {"SR33", sr33,
     "say(g->loadMotionFromM((char *)\"a.m\"));",
     NULL,
     NULL},
    {"SR34", sr34,
     "say(g->loadMotionFromYaml((char *)\"a.yaml\"));",
     NULL,
     NULL},
    {"SR35", sr35,
     "say(g->loadMotionFromPseq((char *)\"a.pseq\"));",
     NULL,
     NULL},
    {"SR36", sr36,
     "say(g->loadMotionFromMseq((char *)\"a.mseq\"));",
     NULL,
     NULL},
    {"SR37", sr37,
     "g->loadMotion((char *)\"a\"); say(g->saveMotionToM(NULL)); "
     "say_file(in_folder(\"Motion0.m\"));",
     NULL,
     NULL},
    {"SR40", sr40,
     "g->setMotionTime(400); say(g->setJoint(2, 200)); g->startMotion(); go();",
     NULL,
     NULL},
    {"SR41", sr41,
     "say(g->setMotionTime(700)); g->startMotion(); go();",
     NULL,
     NULL},
    {"SR43", sr43,
     "say(g->setDefaultMotionTime(350)); say(g->setDefaultMotionTime(10000)); "
     "g->setMotionTime(0); g->startMotion(); go(); g->setDefaultMotionTime(300);",
     NULL,
     NULL},
    {"SR47", sr47,
     "g->setMotionTime(500); say(g->setCommand((char *)\"\\101\\0\", 2));",
     NULL,
     NULL},
    {"SR49", sr49,
     "quiet(); say(g->sendCommand((char *)\"\\101\\0\", 2)); char b[1]; "
     "say(g->recieveData(b, 1)); say(b[0]);",
     NULL,
     NULL},
    {"SR53", sr53,
     "g->loadMotion((char *)\"a\"); say_posture(g->getNthPosture(0)); "
     "say_posture(g->getNthPosture(1));",
     NULL,
     NULL},
    {"SR54", sr54,
     "g->loadMotion((char *)\"a\"); g->doNthMotion(1); go();",
     NULL,
     NULL},
    {"SR57", sr57,
     "g->loadMotion((char *)\"a\"); say_posture(g->getFirstPosture()); "
     "say_posture(g->getLastPosture());",
     NULL,
     NULL},
    {"SR60", sr60,
     "g->loadMotion((char *)\"a\"); say(g->setMotionCount(1)); go();",
     NULL,
     NULL},
    {"SR60_twice", sr60_twice,
     "g->loadMotion((char *)\"a\"); g->setMotionCount(2); go();",
     NULL,
     NULL},
    {"SR60_reverse", sr60_reverse,
     "g->loadMotion((char *)\"a\"); g->setMotionCount(-1); go();",
     "goals 20 in 30:; goals 20 in 15: 2=20 3=30; goals 20 in 10: 2=10",
     "it throws an exception"},
    {"SR63", sr63,
     "say(g->setServoState(3, 1));",
     NULL,
     NULL},
    {"SR64", sr64,
     "quiet(); say(g->checkConnection());",
     NULL,
     NULL},
    {"SR65", sr65,
     "g->setMotionTime(300); g->setJoint(9, -50); g->startMotion(); go(); "
     "quiet(); say(g->getAngle(9)); say(g->getAngle(12)); say(g->getAngle(18));",
     NULL,
     NULL},
    {"SR66", sr66,
     "say(g->connect());",
     NULL,
     NULL},
    {"SR67", sr67,
     "quiet(); g->getPosture(); say_posture(g->currentPosture);",
     NULL,
     NULL},
    {"SR70", sr70,
     "say(g->jointIdToMotorId(1)); say(g->jointIdToMotorId(0)); "
     "say(g->jointIdToMotorId(19));",
     NULL,
     NULL},
    {"SR71", sr71,
     "say(g->motorIdToJointId(9)); say(g->motorIdToJointId(11)); "
     "say(g->motorIdToJointId(21));",
     "said 0 1 -1",
     "0 is a joint"},
    {"GR18", gr18,
     "say(g->setTorque(9, 0));",
     NULL,
     NULL},
    {"GR18_on", gr18_on,
     "g->setTorque(9, 0); say(g->setTorque(9, 1));",
     "torque",
     "the goal is set to where the motor stands before torque comes on"},
    {"GR19_0", gr19_0,
     "g->setServo(0, 0); g->setServo(1, 0);",
     "torque",
     "the goals are set to where the motors stand before torque comes on"},
    {"GR19_1", gr19_1,
     "g->setServo(0, 0); g->setServo(1, 1);",
     "torque",
     "the goals are set to where the motors stand before torque comes on"},
    {"GR19_2", gr19_2,
     "g->setServo(0, 0); g->setServo(1, 2);",
     "torque",
     "the goals are set to where the motors stand before torque comes on"},
    {"GR19_3", gr19_3,
     "g->setServo(0, 0); g->setServo(1, 3);",
     "torque",
     "the goals are set to where the motors stand before torque comes on"},
    {"GR19_4", gr19_4,
     "g->setServo(0, 0); g->setServo(1, 4);",
     "torque",
     "the goals are set to where the motors stand before torque comes on"},
    {"GR19_5", gr19_5,
     "g->setServo(0, 0); g->setServo(1, 5);",
     "torque",
     "the goals are set to where the motors stand before torque comes on"},
    {"GR19_6", gr19_6,
     "g->setServo(0, 0); g->setServo(1, 6);",
     "torque",
     "the goals are set to where the motors stand before torque comes on"},
    {"GR19_7", gr19_7,
     "g->setServo(0, 0); g->setServo(1, 7);",
     "torque",
     "the goals are set to where the motors stand before torque comes on"},
    {"GR20", gr20,
     "quiet(); say(g->getAngle(3));",
     NULL,
     NULL},
    {"GR21", gr21,
     "char b[4]; say(g->setDegMs(b, 900, 10)); say(b[0]); say(b[1]); say(b[2]); "
     "say(b[3]);",
     NULL,
     NULL},
    {"GR22", gr22,
     "g->moveJoint(9, -100, 40); go_on();",
     NULL,
     NULL},
    {"GR23", gr23,
     "short d[20] = {0, 20, 30}; say(g->setJoints(d, 30)); g->startMotion(); go();",
     NULL,
     NULL},
    {"GR24", gr24,
     "say(g->setJointsFromString((char *)\" 50 0 0 30 0 0 0 0 0 0 0 0 0 0 0 0 0 0 "
     "0 0 0 \")); g->startMotion(); go();",
     "goals 20 in 50: 3=30 | said 0",
     "it takes the time for motor 1, and each angle for the motor behind"},
    {"GR25", gr25,
     "say(g->activateMotionSlot(3));",
     NULL,
     NULL},
    {"GR26", gr26,
     "say(g->activateSenario(2));",
     NULL,
     NULL},
    {"GR28", gr28,
     "quiet(); g->getPosture(); say(g->getCurrentJointAngles()[11]);",
     "said 0.0349066",
     "its radians are ten times as large"},
    {"GR29", gr29,
     "double a[21] = {0, 0.1}; g->setMotionTime(300); "
     "say(g->setTargetJointAngles(a)); go();",
     "goals 20 in 30: 2=57 | said 0",
     "it takes each angle for the motor before, and degrees for 0.1 degree"},
    {"GR30", gr30,
     "say(g->GR001::jointIdToMotorId(1)); say(g->GR001::jointIdToMotorId(13));",
     NULL,
     NULL},
    {"GR31", gr31,
     "say(g->GR001::motorIdToJointId(2));",
     NULL,
     NULL},
    {"GR33", gr33,
     "say(g->clearRecord()); say(g->record->getSize());",
     NULL,
     NULL},
    {"GR34", gr34,
     "quiet(); g->clearRecord(); g->getPosture(); say(g->recordCurrentPosture()); "
     "say_posture(g->record->get(0)); g->record->clear();",
     NULL,
     NULL},
    {"GR35", gr35,
     "g->clearRecord(); g->record->appendPosture(p->dupPosture()); "
     "q->setDegree(2, 20); q->setMotionTime(200); "
     "g->record->appendPosture(q->dupPosture()); say(g->doRecord()); go(); "
     "g->motion->motion.clear(); g->record->motion.clear();",
     NULL,
     NULL},
    {"GR36", gr36,
     "g->setServo(0, 0); say(g->servo(13, true));",
     "goals 1 in 1: | torque 1=0 2=1 3=0 4=0 5=0 6=0 7=0 8=0 9=0 10=0 11=0 12=0 "
     "13=0 14=0 15=0 16=0 17=0 18=0 19=0 20=0 | said 1",
     "it switches the group of that number, and all for most numbers"},
    {"GR38", gr38,
     "quiet(); g->getPosture(); double a[20]; g->readJointAngles(a); say(a[11]); "
     "say(a[1]);",
     "said 0.0349066 0",
     "its radians are ten times as large; the order is that of motors"},
    {"GR39", gr39,
     "double a[22] = {0, 0.1}; g->setMotionTime(300); g->writeJointCommands(a); "
     "g->oneStep(); go();",
     "goals 20 in 30: 2=57",
     "it takes each angle for two motors before, and degrees for 0.1 degree"},
    {"GR41", gr41,
     "g->setJoint(2, 40); g->setMotionTime(300); g->oneStep(); go();",
     NULL,
     NULL},
    /* clang-format on */
};

/* The original adds 2 degrees to what it reads of motor 12, and -2 of 18. */
static bool is_at_0(void)
{
    RobotPosture zero = *SerialRobot_getCurrentPosture(g);

    RobotPosture_setDegree(&zero, 12, RobotPosture_getDegree(&zero, 12) - 20);
    RobotPosture_setDegree(&zero, 18, RobotPosture_getDegree(&zero, 18) + 20);
    return RobotPosture_nearTo(&zero, g->targetPosture, 2);
}

/* Each begins at rest, all motors on and at 0. */
static void begin(void)
{
    (void)RobotPosture_init(g->targetPosture, 20);
    (void)RobotPosture_setMotionTime(g->targetPosture, 200);
    go();
    if (memchr(SerialRobot_getServoState(g), 0, 20) != NULL) {
        (void)GR001_setServo(g, 1, 0);
        assert_int_equal(SerialRobot_error(g), GROBO_OK);
    }
    if (!is_at_0()) {
        assert_int_equal(SerialRobot_startMotion(g), 0);
        go();
    }
    SerialRobot_clearMotion(g);
    classic_begin();
}

TEST_EACH(statement, statements, what_leaves_is_what_the_original_sends)
{
    begin();
    classic_judge(row);
}

int main(int argc, char **argv)
{
    return classic_main(argc, argv, statements, sizeof statements / sizeof statements[0]);
}
