/* SPDX-License-Identifier: MIT */
/* The classic shelf at its edges: the least time, the first posture, a request that fails, a reply
 * that nobody asked for. In virtual time. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/classic_alone.h"
#include "tests/support/folder.h"

/* ---- packets --------------------------------------------------------------------------------- */

TEST_WITH(alone, a_packet_of_one_motor_is_that_of_the_protocol)
{
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
    char packet[GROBO_FRAME_MAX_BYTES];
    const grobo_protocol *protocol =
        grobo_robot_driver(grobo_runner_robot(SerialRobot_runner(g)))->protocol;
    const grobo_rs30x_goal goal = {.id = 3, .pos_ddeg = -25, .time_cs = 40};

    int n = grobo_frame_goal(protocol, &goal, frame, sizeof frame);
    assert_true(n > 0);
    assert_int_equal(GR001_MoveJointPacket(g, 3, -25, 40, packet, sizeof packet), n);
    assert_memory_equal(packet, frame, (size_t)n);
    assert_int_equal(GR001_MoveJointPacket(g, 3, -25, 40, packet, n), n);
    assert_int_equal(GR001_MoveJointPacket(g, 3, -25, 40, packet, n - 1), -1);
    n = grobo_frame_torque(protocol, 5, GROBO_TORQUE_BRAKE, frame, sizeof frame);
    assert_true(n > 0);
    assert_int_equal(GR001_ServoPacket(g, 5, 2, packet, sizeof packet), n);
    assert_memory_equal(packet, frame, (size_t)n);
    n = grobo_frame_read(protocol, 7, GROBO_STATE_ADDRESS, GROBO_STATE_BYTES, frame, sizeof frame);
    assert_true(n > 0);
    assert_int_equal(GR001_MotorInfoPacket(g, 7, packet, sizeof packet), n);
    assert_memory_equal(packet, frame, (size_t)n);
}

TEST_WITH(alone, a_time_below_a_step_of_the_servos_is_one_step)
{
    RobotPosture posture;
    char packet[128];

    assert_int_equal(RobotPosture_init(&posture, 20), 0);
    (void)RobotPosture_setMotionTime(&posture, 10);
    int n = GR001_PosturePacket(g, &posture, packet, sizeof packet);
    assert_true(n > 0);
    posture.motionTime = 4;
    assert_int_equal(SerialRobot_postureToCommand(g, &posture), 0);
    assert_int_equal(g->commandSize, n);
    assert_memory_equal(g->commandBuf, packet, (size_t)n);
}

/* ---- commands -------------------------------------------------------------------------------- */

TEST_WITH(alone, only_the_reply_to_a_command_is_kept)
{
    char packet[64], byte = 0;

    int n = GR001_MotorInfoPacket(g, 7, packet, sizeof packet);
    assert_int_equal(SerialRobot_sendCommand(g, packet, n), n);
    char reply[128];
    int got = 0;
    while (got < (int)sizeof reply && SerialRobot_recieveData(g, &reply[got], 1) == 1) {
        got++;
    }
    assert_in_range(got, 10, 40);
    assert_int_equal(SerialRobot_getPosture(g), 0); /* its replies are nobody's */
    assert_int_equal(SerialRobot_recieveData(g, &byte, 1), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_TIMEOUT);
    n = GR001_MoveJointPacket(g, 2, 1500, 100, packet, sizeof packet); /* beyond its limit */
    assert_true(SerialRobot_sendCommand(g, packet, n) < 0);
    assert_int_equal(SerialRobot_getPosture(g), 0);
    assert_int_equal(SerialRobot_recieveData(g, &byte, 1), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_TIMEOUT);
}

TEST_WITH(alone, a_stop_refuses_free_mode)
{
    char reason[64];

    assert_int_equal(SerialRobot_estop(g), 0);
    for (int i = 0; i < 1000 && !GR001_checkEmergency(g, reason, sizeof reason, NULL); i++) {
        assert_int_equal(SerialRobot_svc(g), 0);
    }
    assert_int_equal(GR001_setFreeMotion(g, 1), -1);
    assert_int_equal(SerialRobot_error(g), GROBO_ERR_LATCHED);
}

/* ---- moving ---------------------------------------------------------------------------------- */

TEST_WITH(alone, a_joint_that_is_sent_off_moves_at_once)
{
    assert_int_equal(SerialRobot_isMoving(g), 0);
    assert_int_equal(GR001_moveJoint(g, 4, -20, 5), 0);
    assert_int_equal(SerialRobot_isMoving(g), 1);
    go();
    assert_int_equal(SerialRobot_isMoving(g), 0);
}

TEST_WITH(alone, a_posture_is_printed_as_it_is_now)
{
    RobotPosture_setDegree(g->currentPosture, 2, 777);
    assert_int_equal(SerialRobot_getPosture(g), 0);
    RobotPosture_setDegree(g->currentPosture, 2, 777); /* of a program, or long ago */
    GR001_printPosture(g);
    assert_in_range(RobotPosture_getDegree(g->currentPosture, 2) + 10, 0, 20);
}

TEST_WITH(alone, a_motion_that_leaves_a_limit_by_less_than_a_degree_is_played_at_it)
{
    RobotPosture posture;
    const grobo_model *model = grobo_robot_driver(grobo_runner_robot(SerialRobot_runner(g)))->model;
    int joint = SerialRobot_motorIdToJointId(g, 2);
    int most = grobo_ddeg_from_rad(grobo_model_joint(model, joint)->max_rad);
    grobo_posture target;

    assert_int_equal(RobotPosture_init(&posture, 20), 0);
    (void)RobotPosture_setMotionTime(&posture, 2000);
    RobotPosture_setDegree(&posture, 2, most + 6);
    assert_true(RobotMotion_appendPosture(g->motion, &posture));
    assert_int_equal(SerialRobot_setMotionCount(g, 1), 1);
    go();
    (void)grobo_robot_target(grobo_runner_robot(SerialRobot_runner(g)), &target);
    assert_int_equal(grobo_ddeg_from_rad(target.angle_rad[joint]), most);
}

/* ---- files, names ---------------------------------------------------------------------------- */

static int columns_of(const char *path)
{
    char text[1024] = "";
    FILE *file = fopen(path, "r");

    assert_non_null(file);
    assert_non_null(fgets(text, sizeof text, file));
    (void)fclose(file);
    int n = 0;
    for (const char *at = text + strspn(text, " \t\n"); *at != '\0'; n++) {
        at += strcspn(at, " \t\n");
        at += strspn(at, " \t\n");
    }
    return n;
}

TEST_WITH(alone, a_file_has_the_joints_of_the_largest_posture)
{
    static const char *const files[] = {"n.m"};
    RobotMotion motion;
    RobotPosture posture;

    (void)folder_set_up();
    assert_int_equal(RobotMotion_init(&motion), 0);
    for (int n = 2; n <= 4; n++) {
        assert_int_equal(RobotPosture_init(&posture, n == 4 ? 1 : n), 0);
        assert_true(RobotMotion_appendPosture(&motion, &posture));
    }
    assert_true(RobotMotion_saveMotionToFile(&motion, in_folder("n.m")));
    assert_int_equal(columns_of(in_folder("n.m")), 1 + 3); /* behind a time */
    RobotMotion_deinit(&motion);
    folder_remove(files, 1);
}

TEST_WITH(alone, a_file_is_looked_for_by_the_format_that_is_asked_for)
{
    static const char *const files[] = {"a.m", "a.pseq", "a.yaml"};
    RobotPosture posture;

    (void)folder_set_up();
    assert_int_equal(SerialRobot_setMotionDir(g, folder), 0);
    assert_int_equal(RobotPosture_init(&posture, 20), 0);
    (void)RobotPosture_setMotionTime(&posture, 100);
    for (int n = 1; n <= 2; n++) {
        assert_true(RobotMotion_appendPosture(g->motion, &posture));
        assert_int_equal(
            n == 1 ? SerialRobot_saveMotionToM(g, "a") : SerialRobot_saveMotionToPseq(g, "a"), n);
    }
    assert_int_equal(SerialRobot_saveMotionToYaml(g, "a"), 2);
    assert_int_equal(SerialRobot_loadMotionFromM(g, "a"), 1);
    assert_int_equal(SerialRobot_loadMotionFromPseq(g, "a"), 2);
    assert_true(SerialRobot_loadMotionFromYaml(g, "a") > 2); /* frames at a rate */
    assert_false(RobotMotion_saveMotionToFile_dir(g->motion, NULL, folder));
    assert_false(RobotMotion_saveMotionToFile_dir(g->motion, "b", NULL));
    folder_remove(files, 3);
}

TEST_WITH(alone, a_group_is_not_called_by_a_number)
{
    const char *const joints[] = {"CHEST_P"};

    assert_false(GR001_addJointGroup(g, "9", joints, 1));
    assert_false(GR001_addJointGroup(g, "0", joints, 1));
    assert_true(GR001_addJointGroup(g, "9a", joints, 1));
}

/* ---- a port that is closed ------------------------------------------------------------------- */

TEST(a_port_takes_its_speed_while_it_is_closed)
{
    SerialCom com;

    assert_int_equal(SerialCom_init_devname(&com, "/nowhere/port"), 0);
    assert_int_equal(SerialCom_setBaudrate(&com, 57600), 57600);
    assert_int_equal(SerialCom_getBaudrate(&com), 57600);
    SerialCom_deinit(&com);
    assert_true(com.handle == GROBO_HANDLE_NULL);
    assert_int_equal(SerialCom_setBaudrate(&com, 57600), -1);
}
