/* SPDX-License-Identifier: MIT */
/* What GR001 of the classic shelf prints for people, and what its driver expects. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "src/classic/view.h"
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

TEST_WITH(rig_wirings, voltages_and_currents_are_got_in_motor_order)
{
    int32_t value[GROBO_JOINTS_MAX];
    start();
    assert_int_equal(grobo_classic_mean_mv(&rig.robot), GROBO_ERR_STALE);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_SENSE_FULL), 0);
    assert_int_equal(grobo_classic_voltages(&rig.robot, value), 20); /* torque on read all */
    assert_int_equal(grobo_sim_set_load(&rig.sim, R_ELBOW, 200), 0);
    read_all();
    assert_int_equal(grobo_classic_currents(&rig.robot, value), 20);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(value[i] > 150, i == R_ELBOW_ID - 1);
    }
    assert_int_equal(grobo_classic_voltages(&rig.robot, value), 20);
    int32_t sum_mv = 0;
    for (int i = 0; i < 20; i++) {
        assert_in_range(value[i], 7000, 7500);
        sum_mv += value[i];
    }
    assert_true(fabs(grobo_classic_mean_mv(&rig.robot) - sum_mv / 20.0) <= 0.5);
}

/* Only one motor is read: it alone counts. */
TEST_WITH(rig_wirings, motors_that_were_not_read_do_not_count)
{
    int32_t value[GROBO_JOINTS_MAX];
    start();
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(NECK), GROBO_SENSE_FULL), 0);
    assert_int_equal(grobo_classic_currents(&rig.robot, value), 1);
    assert_int_equal(grobo_classic_voltages(&rig.robot, value), 1);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(value[i] >= 0, i == NECK_ID - 1);
    }
    assert_int_equal(grobo_classic_mean_mv(&rig.robot), value[NECK_ID - 1]);
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
    return grobo_classic_print_voltages(&rig.robot, stream);
}

static int print_currents(FILE *stream)
{
    return grobo_classic_print_currents(&rig.robot, stream);
}

static int print_body(FILE *stream)
{
    grobo_posture posture;
    grobo_posture_init_pose(&posture, &grobo_i_gr001_model);
    posture.set &= ~GROBO_JOINT_BIT(NECK);
    return grobo_classic_print_posture(&posture, stream);
}

TEST_WITH(rig_wirings, voltages_and_currents_are_printed)
{
    char line[64];
    int32_t current_ma[GROBO_JOINTS_MAX];
    int32_t voltage_mv[GROBO_JOINTS_MAX];
    start();
    assert_string_equal(printed(print_voltages), "mean -\n");
    assert_string_equal(printed(print_currents), "");
    read_all();
    (void)grobo_classic_currents(&rig.robot, current_ma);
    (void)grobo_classic_voltages(&rig.robot, voltage_mv);
    const char *text = printed(print_voltages);
    snprintf(line, sizeof line, " 1 CHEST_P      %6.2f V\n 2 NECK_Y ", voltage_mv[0] / 1000.0);
    assert_memory_equal(text, line, strlen(line));
    int mean_mv = grobo_classic_mean_mv(&rig.robot);
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
    assert_int_equal(grobo_classic_print_posture(&small, stream), GROBO_ERR_ARG);
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

/* ---- the driver --------------------------------------------------------------------------- */

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
