/* SPDX-License-Identifier: MIT */
/* GR001 by motor number and in motor order, for people, and its record. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/gr001.h>
#include <grobo/core/motion.h>

#include "tests/support/rig.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static grobo_test_rig rig;

static void start(void)
{
    rig_start(&rig, &quiet, NULL);
}

static void read_all(void)
{
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_FULL), GROBO_OK);
}

/* ---- one motor, a group of motors ------------------------------------------------------------ */

TEST_WITH(rig_wirings, a_motor_is_switched_by_its_number)
{
    static const grobo_torque modes[] = {GROBO_TORQUE_ON, GROBO_TORQUE_BRAKE, GROBO_TORQUE_OFF};
    start();
    for (int i = 0; i < 3; i++) {
        rig_expect(&rig, grobo_gr001_torque(&rig.robot, NECK_ID, modes[i]), GROBO_OK);
        assert_int_equal(rig_torque(&rig, NECK), modes[i]);
        assert_int_equal(rig_torque(&rig, 1), GROBO_TORQUE_OFF);
    }
    assert_int_equal(grobo_gr001_torque(&rig.robot, 0, GROBO_TORQUE_ON), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_gr001_torque(&rig.robot, 21, GROBO_TORQUE_ON), GROBO_ERR_NOTFOUND);
}

TEST_WITH(rig_wirings, groups_are_switched_by_their_number)
{
    /* First and last motor of each group (protocol 5). */
    static const int motors[8][2] = {{1, 20}, {1, 2},  {3, 5},   {6, 8},
                                     {3, 8},  {9, 14}, {15, 20}, {9, 20}};
    for (int g = GROBO_GR001_ALL; g <= GROBO_GR001_LEGS; g++) {
        start();
        rig_expect(&rig, grobo_gr001_servo(&rig.robot, (grobo_gr001_group)g, GROBO_TORQUE_ON),
                   GROBO_OK);
        for (int j = 0; j < 20; j++) {
            int motor = grobo_model_motor_of_joint(rig.driver->model, j);
            bool on = motor >= motors[g][0] && motor <= motors[g][1];
            assert_int_equal(rig_torque(&rig, j), on ? GROBO_TORQUE_ON : GROBO_TORQUE_OFF);
        }
    }
    assert_int_equal(grobo_gr001_servo(&rig.robot, (grobo_gr001_group)8, GROBO_TORQUE_ON),
                     GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_gr001_servo(&rig.robot, (grobo_gr001_group)-1, GROBO_TORQUE_ON),
                     GROBO_ERR_NOTFOUND);
}

TEST_WITH(rig_wirings, a_motor_is_moved_by_a_short_packet)
{
    start();
    rig_power(&rig);
    rig_expect(&rig, grobo_gr001_move(&rig.robot, NECK_ID, 0, 10), GROBO_OK);
    rig_forget(&rig);
    rig_expect(&rig, grobo_gr001_move(&rig.robot, NECK_ID, 300, 50), GROBO_OK);
    assert_true(rig_packet_was_sent(&rig, "\xFA\xAF\x02\x00\x1E\x04\x01\x2C\x01\x32\x00\x06", 12));
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 30) < 0.1);
    /* 0 is as fast as the servo can: 60 degrees in 0.16 s. */
    int64_t begun_us = rig.now_us;
    rig_expect(&rig, grobo_gr001_move(&rig.robot, NECK_ID, -300, 0), GROBO_OK);
    assert_in_range(rig.now_us - begun_us, 150000, 300000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) + 30) < 0.1);
    assert_int_equal(grobo_gr001_move(&rig.robot, NECK_ID, 600, 50), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_gr001_move(&rig.robot, NECK_ID, 0, -1), GROBO_ERR_ARG);
    assert_int_equal(grobo_gr001_move(&rig.robot, NECK_ID, 0, 16384), GROBO_ERR_ARG);
    assert_int_equal(grobo_gr001_move(&rig.robot, 99, 0, 10), GROBO_ERR_NOTFOUND);
}

static int angle(int motor, int64_t max_age_us, int *angle_ddeg)
{
    return grobo_gr001_angle(&rig.robot, motor, max_age_us, angle_ddeg);
}

TEST_WITH(rig_wirings, a_motor_is_read_by_its_number)
{
    int angle_ddeg = 7777;
    start();
    assert_int_equal(angle(R_ELBOW_ID, GROBO_NEVER_US, &angle_ddeg), GROBO_ERR_STALE);
    rig_expect(&rig, grobo_gr001_sense(&rig.robot, R_ELBOW_ID), GROBO_OK);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_JOINT), 1);
    assert_int_equal(angle(R_ELBOW_ID, GROBO_NEVER_US, &angle_ddeg), GROBO_OK);
    assert_int_equal(angle_ddeg, -200);
    /* A failure is no angle: neither -254 nor -1000. */
    angle_ddeg = 7777;
    assert_int_equal(grobo_sim_set_cable(&rig.sim, R_ELBOW, GROBO_SIM_CABLE_MUTE), 0);
    rig_run(&rig, 300000);
    rig_wait(&rig, grobo_gr001_sense(&rig.robot, R_ELBOW_ID));
    assert_int_equal(angle(R_ELBOW_ID, 300000, &angle_ddeg), GROBO_ERR_STALE);
    assert_int_equal(angle(0, GROBO_NEVER_US, &angle_ddeg), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_gr001_sense(&rig.robot, 0), GROBO_ERR_NOTFOUND);
    assert_int_equal(angle_ddeg, 7777);
}

TEST_WITH(rig_wirings, goals_are_packed_as_in_a_packet)
{
    uint8_t data[4];
    assert_int_equal(grobo_gr001_pack_goal(900, 10, data, sizeof data), 4);
    assert_memory_equal(data, "\x84\x03\x0A\x00", 4); /* as in the packet of protocol 5 */
    assert_int_equal(grobo_gr001_pack_goal(-10, 0, data, sizeof data), 4);
    assert_memory_equal(data, "\xF6\xFF\x00\x00", 4);
    assert_int_equal(grobo_gr001_pack_goal(-1500, 16383, data, sizeof data), 4);
    assert_memory_equal(data, "\x24\xFA\xFF\x3F", 4);
    assert_int_equal(grobo_gr001_pack_goal(1501, 0, data, sizeof data), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_gr001_pack_goal(-1501, 0, data, sizeof data), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_gr001_pack_goal(0, 16384, data, sizeof data), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_gr001_pack_goal(0, -1, data, sizeof data), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_gr001_pack_goal(0, 0, data, 3), GROBO_ERR_SPACE);
    assert_memory_equal(data, "\x24\xFA\xFF\x3F", 4);
}

/* ---- all motors ------------------------------------------------------------------------------ */

TEST_WITH(rig_wirings, postures_are_made_in_motor_order)
{
    const grobo_model *model = &grobo_i_gr001_model;
    int16_t angle_ddeg[20];
    grobo_posture posture;
    for (int m = 1; m <= 20; m++) {
        angle_ddeg[m - 1] = (int16_t)(m * 7);
    }
    assert_int_equal(grobo_gr001_posture(model, angle_ddeg, 20, 25, &posture), 20);
    assert_int_equal(posture.time_us, 250000);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(grobo_ddeg_from_rad(posture.angle_rad[j]), model->joints[j].motor * 7);
    }
    assert_int_equal(grobo_gr001_posture(model, angle_ddeg, 2, 0, &posture), 2);
    assert_true(posture.set == (GROBO_JOINT_BIT(12) | GROBO_JOINT_BIT(NECK)));
    assert_int_equal(posture.time_us, 0);
    assert_int_equal(grobo_gr001_posture(model, angle_ddeg, 21, 25, &posture), GROBO_ERR_CAP);
    assert_int_equal(grobo_gr001_posture(model, angle_ddeg, 20, 16384, &posture), GROBO_ERR_ARG);
    assert_int_equal(posture.n_joints, 20);
}

TEST_WITH(rig_wirings, angles_are_set_and_got_in_motor_order)
{
    double angle_rad[21] = {0};
    start();
    for (int j = 0; j < 20; j++) {
        const grobo_joint *joint = &rig.driver->model->joints[j];
        angle_rad[joint->motor - 1] = (joint->min_rad + 3 * joint->max_rad) / 4;
    }
    assert_int_equal(grobo_gr001_set_angles(&rig.robot, angle_rad, 19, 500000), GROBO_ERR_ARG);
    assert_int_equal(grobo_gr001_set_angles(&rig.robot, angle_rad, 21, 500000), GROBO_ERR_ARG);
    int64_t begun_us = rig.now_us;
    rig_expect(&rig, grobo_gr001_set_angles(&rig.robot, angle_rad, 20, 5000000), 0);
    assert_in_range(rig.now_us - begun_us, 5000000, 6500000);
    for (int j = 0; j < 20; j++) {
        double want_rad = angle_rad[rig.driver->model->joints[j].motor - 1];
        assert_true(fabs(rig_angle_deg(&rig, j) - grobo_deg_from_rad(want_rad)) < 0.1);
    }
    double got_rad[20];
    assert_int_equal(grobo_gr001_get_angles(&rig.robot, GROBO_NEVER_US, got_rad, 19),
                     GROBO_ERR_SPACE);
    assert_int_equal(grobo_gr001_get_angles(&rig.robot, GROBO_NEVER_US, got_rad, 20), 20);
    for (int i = 0; i < 20; i++) {
        assert_true(fabs(got_rad[i] - angle_rad[i]) < 0.002);
    }
    angle_rad[4] = NAN;
    assert_int_equal(grobo_gr001_set_angles(&rig.robot, angle_rad, 20, 500000), GROBO_ERR_NAN);
}

TEST_WITH(rig_wirings, angles_not_read_are_no_numbers)
{
    double angle_rad[20];
    start();
    rig_expect(&rig, grobo_gr001_sense(&rig.robot, 11), GROBO_OK); /* R_HIP_R */
    assert_int_equal(grobo_gr001_get_angles(&rig.robot, GROBO_NEVER_US, angle_rad, 20), 1);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(isnan(angle_rad[i]) != 0, i != 10);
    }
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_gr001_get_angles(&rig.robot, 900000, angle_rad, 20), 0);
}

TEST_WITH(rig_wirings, voltages_and_currents_are_got_in_motor_order)
{
    int32_t value[20];
    start();
    assert_int_equal(grobo_gr001_mean_voltage_mv(&rig.robot, GROBO_NEVER_US), GROBO_ERR_STALE);
    rig_power(&rig);
    assert_int_equal(grobo_sim_set_load(&rig.sim, R_ELBOW, 200), 0);
    read_all();
    assert_int_equal(grobo_gr001_currents(&rig.robot, GROBO_NEVER_US, value, 20), 20);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(value[i] > 150, i == R_ELBOW_ID - 1);
    }
    assert_int_equal(grobo_gr001_currents(&rig.robot, GROBO_NEVER_US, value, 19), GROBO_ERR_SPACE);
    assert_int_equal(grobo_gr001_voltages(&rig.robot, GROBO_NEVER_US, value, 19), GROBO_ERR_SPACE);
    assert_int_equal(grobo_gr001_voltages(&rig.robot, GROBO_NEVER_US, value, 20), 20);
    int32_t sum_mv = 0;
    for (int i = 0; i < 20; i++) {
        assert_in_range(value[i], 7000, 7500);
        sum_mv += value[i];
    }
    int mean_mv = grobo_gr001_mean_voltage_mv(&rig.robot, GROBO_NEVER_US);
    assert_true(fabs(mean_mv - sum_mv / 20.0) <= 0.5);
    /* Only one motor is read later: it alone counts. */
    grobo_sim_set_supply(&rig.sim, 6500);
    rig_run(&rig, 2000000);
    rig_expect(&rig, grobo_gr001_sense(&rig.robot, NECK_ID), GROBO_OK);
    assert_int_equal(grobo_gr001_voltages(&rig.robot, 1000000, value, 20), 1);
    assert_int_equal(value[0], -1);
    assert_int_equal(grobo_gr001_currents(&rig.robot, 1000000, value, 20), 1);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(value[i] >= 0, i == NECK_ID - 1);
    }
    assert_int_equal(grobo_gr001_voltages(&rig.robot, 1000000, value, 20), 1);
    assert_int_equal(grobo_gr001_mean_voltage_mv(&rig.robot, 1000000), value[NECK_ID - 1]);
}

/* ---- for people ------------------------------------------------------------------------------ */

/* What print() wrote, whole. */
static const char *printed(int (*print)(FILE *stream))
{
    static char text[4096];
    FILE *stream = tmpfile();
    assert_non_null(stream);
    assert_int_equal(print(stream), GROBO_OK);
    rewind(stream);
    text[fread(text, 1, sizeof text - 1, stream)] = '\0';
    fclose(stream);
    return text;
}

static int print_voltages(FILE *stream)
{
    return grobo_gr001_print_voltages(&rig.robot, stream);
}

static int print_currents(FILE *stream)
{
    return grobo_gr001_print_currents(&rig.robot, stream);
}

static int print_body(FILE *stream)
{
    grobo_posture posture;
    grobo_posture_init_pose(&posture, &grobo_i_gr001_model);
    posture.set &= ~GROBO_JOINT_BIT(NECK);
    return grobo_gr001_print_posture(&posture, stream);
}

TEST_WITH(rig_wirings, voltages_and_currents_are_printed)
{
    char line[64];
    int32_t current_ma[20];
    int32_t voltage_mv[20];
    start();
    assert_string_equal(printed(print_voltages), "mean -\n");
    assert_string_equal(printed(print_currents), "");
    read_all();
    (void)grobo_gr001_currents(&rig.robot, GROBO_NEVER_US, current_ma, 20);
    (void)grobo_gr001_voltages(&rig.robot, GROBO_NEVER_US, voltage_mv, 20);
    const char *text = printed(print_voltages);
    snprintf(line, sizeof line, " 1 CHEST_P      %6.2f V\n 2 NECK_Y ", voltage_mv[0] / 1000.0);
    assert_memory_equal(text, line, strlen(line));
    int mean_mv = grobo_gr001_mean_voltage_mv(&rig.robot, GROBO_NEVER_US);
    snprintf(line, sizeof line, "\nmean            %6.2f V\n", mean_mv / 1000.0);
    assert_string_equal(strstr(text, "\nmean"), line);
    text = printed(print_currents);
    snprintf(line, sizeof line, "\n20 L_ANKLE_R    %6d mA\n", (int)current_ma[19]);
    assert_string_equal(strstr(text, "\n20"), line);
}

TEST_WITH(rig_wirings, a_posture_is_printed_as_the_body_stands)
{
    assert_string_equal(printed(print_body), "                   right  middle    left\n"
                                             "neck yaw                       -\n"
                                             "shoulder pitch      20.0           -20.0\n"
                                             "shoulder roll        0.0             0.0\n"
                                             "elbow pitch        -20.0            20.0\n"
                                             "chest pitch                  0.0\n"
                                             "hip yaw              0.0             0.0\n"
                                             "hip roll             0.0             0.0\n"
                                             "hip pitch           20.0           -20.0\n"
                                             "knee pitch         -40.0            40.0\n"
                                             "ankle pitch        -20.0            20.0\n"
                                             "ankle roll           0.0             0.0\n");
    grobo_posture small;
    assert_int_equal(grobo_posture_init(&small, 19), 0);
    FILE *stream = tmpfile();
    assert_non_null(stream);
    assert_int_equal(grobo_gr001_print_posture(&small, stream), GROBO_ERR_ARG);
    fclose(stream);
}

TEST_WITH(rig_wirings, a_stream_that_takes_nothing_is_told)
{
    FILE *full = fopen("/dev/full", "w");
    if (full == NULL) {
        print_message("no /dev/full here\n");
        skip();
    }
    setvbuf(full, NULL, _IONBF, 0);
    start();
    read_all();
    assert_int_equal(print_voltages(full), GROBO_ERR_IO);
    assert_int_equal(print_currents(full), GROBO_ERR_IO);
    assert_int_equal(print_body(full), GROBO_ERR_IO);
    fclose(full);
}

/* ---- the record ------------------------------------------------------------------------------ */

static int record(grobo_motion *motion, int64_t time_us)
{
    return grobo_gr001_record(motion, &rig.robot, time_us);
}

static void turn(double neck_deg)
{
    assert_int_equal(grobo_sim_set_angle(&rig.sim, NECK, (int32_t)(neck_deg * 1000), 200000), 0);
    rig_run(&rig, 300000);
    read_all();
}

TEST_WITH(rig_wirings, a_record_is_made_by_hand_and_played)
{
    grobo_motion *motion = NULL;
    grobo_posture posture;
    grobo_clip clip;
    start();
    assert_int_equal(grobo_motion_new(GROBO_MOTION_POSTURES, 20, NULL, &motion), 0);
    assert_int_equal(record(motion, 0), GROBO_ERR_STALE);
    assert_int_equal(grobo_gr001_play_record(motion, &rig.robot, NULL, &clip), GROBO_ERR_EMPTY);
    turn(20);
    assert_int_equal(record(motion, 400000), 1);
    turn(-30);
    assert_int_equal(record(motion, 600000), 2);
    rig_run(&rig, 2 * GROBO_GR001_RECORD_AGE_US);
    assert_int_equal(record(motion, 400000), GROBO_ERR_STALE);
    assert_int_equal(grobo_motion_get(motion, 1, &posture), 0);
    assert_int_equal(posture.time_us, 600000);
    turn(-30);
    assert_int_equal(record(motion, 0), 3); /* 0 stays: the default time of who plays it */
    assert_int_equal(grobo_motion_get(motion, 2, &posture), 0);
    assert_int_equal(posture.time_us, 0);
    assert_true(posture.set == GROBO_JOINTS_ALL(20));
    assert_true(fabs(grobo_deg_from_rad(posture.angle_rad[NECK]) + 30) < 0.06);

    grobo_play_options back = {GROBO_PLAY_OPTIONS_INIT, .repeat = -1};
    rig_forget(&rig);
    rig_expect(&rig, grobo_gr001_play_record(motion, &rig.robot, &back, &clip), 0);
    assert_int_equal(grobo_gr001_play_record(motion, &rig.robot, NULL, &clip), GROBO_ERR_STATE);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    rig_run(&rig, 100000); /* the last frame took its time on the line */
    assert_true(fabs(rig_angle_deg(&rig, NECK) - 20) < 0.2);
    grobo_motion_clip_free(&clip);
    grobo_motion_clear(motion);
    assert_int_equal(grobo_motion_size(motion), 0);
    grobo_motion_free(motion);
}

/* The record is a motion that was something else: what is read is no increment to it. */
TEST_WITH(rig_wirings, a_record_is_what_was_read)
{
    grobo_posture step;
    grobo_clip clip;
    start();
    turn(-20);
    for (int kind = GROBO_MOTION_POSTURES; kind <= GROBO_MOTION_FRAMES; kind++) {
        grobo_motion *motion = NULL;
        assert_int_equal(grobo_motion_new((grobo_motion_kind)kind, 20, NULL, &motion), 0);
        if (kind == GROBO_MOTION_FRAMES) {
            assert_int_equal(grobo_motion_set_frame_rate(motion, 100), 0);
        }
        assert_int_equal(grobo_posture_init(&step, 20), 0);
        step.set = GROBO_JOINT_BIT(NECK);
        step.angle_rad[NECK] = -0.1;
        step.time_us = 400000;
        assert_int_equal(grobo_motion_append(motion, &step), 0);
        bool takes = kind == GROBO_MOTION_POSTURES || kind == GROBO_MOTION_KEYS;
        assert_int_equal(record(motion, 400000), takes ? 2 : GROBO_ERR_TYPE);
        assert_int_equal(grobo_motion_size(motion), takes ? 2 : 1);
        assert_int_equal(grobo_motion_get_kind(motion), kind);

        grobo_motion_clear(motion);
        assert_int_equal(record(motion, 400000), 1);
        assert_int_equal(grobo_motion_step_us(motion, 0), 400000);
        rig_forget(&rig);
        rig_expect(&rig, grobo_gr001_play_record(motion, &rig.robot, NULL, &clip), 0);
        rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
        rig_run(&rig, 100000);
        assert_true(fabs(rig_angle_deg(&rig, NECK) + 20) < 0.2);
        read_all();
        grobo_motion_clip_free(&clip);
        grobo_motion_free(motion);
    }
}

/* The driver says what answers its readings without looking at the frame again. */
TEST_WITH(rig_wirings, a_reading_is_answered_as_its_frame_says)
{
    for (int wiring = 0; wiring < 2; wiring++) {
        const grobo_driver *driver = grobo_gr001_driver((grobo_wiring)wiring);
        for (int i = 0; i < 4 * driver->model->n_joints; i++) {
            grobo_exchange exchange = {.frame_bytes = 0};
            grobo_reply reply;
            assert_int_equal(
                driver->sense(driver, NULL, i / 4, (grobo_sense_kind)(i % 4), &exchange), GROBO_OK);
            assert_true(driver->protocol->reply_to(exchange.frame, exchange.frame_bytes, &reply) >
                        0);
            assert_memory_equal(&exchange.reply, &reply, sizeof reply);
        }
    }
}
