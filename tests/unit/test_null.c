/* SPDX-License-Identifier: MIT */
/* Codecs, models, motions and bodies refuse NULL for each thing that must be there. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <grobo/core/board.h>
#include <grobo/core/body_motion.h>
#include <grobo/core/driver.h>
#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/ics.h>
#include <grobo/core/interpolate.h>
#include <grobo/core/lx16a.h>
#include <grobo/core/motion.h>
#include <grobo/core/motion_io.h>
#include <grobo/core/robot_plant.h>
#include <grobo/core/rs30x.h>
#include <grobo/core/unit.h>
#include <grobo/core/wheel.h>
#include <grobo/robot_file.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

#define REFUSES(call) assert_int_equal(call, GROBO_ERR_ARG)

static uint8_t bytes[256];
static char text[] = "CHEST";
static double reals[64];
static int ints[64];
static size_t sizes[4];
static uint32_t longs[4];
static bool flag;
static grobo_board_frame board_frame;
static grobo_board_parser board_parser;
static grobo_transform transforms[GROBO_BODY_LINKS_MAX];
static grobo_body_stand stand;
static const double *const poses[3] = {reals, reals, reals};
static grobo_body_velocity velocity;
static grobo_momentum momentum;
static const grobo_body_key one_key;
static const grobo_body_setup setup = {.model = &grobo_i_gr001_body, .keys = &one_key, .n_keys = 1};
static grobo_body *made_body;
static grobo_body *body;
static grobo_body_report report;
static grobo_body_check_options body_check = {GROBO_BODY_CHECK_OPTIONS_INIT};
static grobo_body_options body_options = {GROBO_BODY_OPTIONS_INIT};
static grobo_motion *motion;
static grobo_motion *made_motion;
static grobo_clip clip;
static grobo_driver made_driver = GROBO_TABLE_INIT(grobo_driver);
static grobo_posture posture;
static FILE *stream;
static grobo_joint_mask joints;
static grobo_spline_key keys[4];
static grobo_spline_track track;
static grobo_key_info key;
static grobo_ik_link links[2];
static grobo_kept kept;
static grobo_clip_options clip_options = {GROBO_CLIP_OPTIONS_INIT};
static grobo_diagnostics *list;
static grobo_diagnostic diagnostic;
static grobo_read_options read_options = {GROBO_READ_OPTIONS_INIT};
static grobo_source source;
static grobo_check_options check_options = {GROBO_CHECK_OPTIONS_INIT};
static grobo_write_options write_options = {GROBO_WRITE_OPTIONS_INIT};
static grobo_sink sink;
static grobo_reply reply;
static grobo_rs30x_packet packet;
static grobo_rs30x_goal goals[] = {{1, 0, 1}};
static grobo_rs30x_byte pairs[] = {{1, 1}};
static grobo_rs30x_parser parser;
static grobo_rs30x_state servo_state;

static int read_nothing(void *ctx, void *buffer, size_t size)
{
    (void)ctx;
    (void)buffer;
    (void)size;
    return 0;
}

static int write_nothing(void *ctx, const void *data, size_t size)
{
    (void)ctx;
    (void)data;
    (void)size;
    return 0;
}

static int set_up(void)
{
    grobo_board_parser_init(&board_parser, 0);
    grobo_rs30x_parser_init(&parser, GROBO_ACCEPT_RETURNS);
    assert_int_equal(grobo_motion_new(GROBO_MOTION_KEYS, 20, NULL, &motion), GROBO_OK);
    grobo_posture_init_pose(&posture, &grobo_i_gr001_model);
    posture.time_us = 1000000;
    assert_int_equal(grobo_motion_append(motion, &posture), GROBO_OK);
    assert_int_equal(grobo_motion_append(motion, &posture), GROBO_OK);
    links[0] =
        (grobo_ik_link){.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .name = "WAIST", .is_base = true};
    assert_int_equal(grobo_motion_set_ik_links(motion, 0, links, 1), GROBO_OK);
    assert_int_equal(grobo_body_new(&grobo_i_gr001_body, motion, NULL, NULL, &body), GROBO_OK);
    assert_int_equal(grobo_motion_clip(motion, NULL, &clip), GROBO_OK);
    assert_int_equal(grobo_diagnostics_new(NULL, &list), GROBO_OK);
    stream = tmpfile();
    assert_non_null(stream);
    track = (grobo_spline_track){keys, 0, 4};
    kept = (grobo_kept){.key = "key", .value = "value"};
    diagnostic = (grobo_diagnostic){.file = "file", .code = "code", .message = "text"};
    source.read = read_nothing;
    sink.write = write_nothing;
    packet = (grobo_rs30x_packet){.kind = GROBO_RS30X_SHORT, .id = 1, .data = bytes, .count = 1};
    return 0;
}

static int tear_down(void)
{
    (void)fclose(stream);
    grobo_diagnostics_free(list);
    grobo_motion_clip_free(&clip);
    grobo_body_free(body);
    grobo_motion_free(motion);
    return 0;
}

TEST(board_refuses_null)
{
    REFUSES(grobo_board_check(NULL, sizeof bytes));
    REFUSES(grobo_board_slot(0, NULL, sizeof bytes));
    REFUSES(grobo_board_scenario(0, NULL, sizeof bytes));
    REFUSES(grobo_board_send(NULL, 1, bytes, sizeof bytes));
    REFUSES(grobo_board_send(bytes, 1, NULL, sizeof bytes));
    REFUSES(grobo_board_ask(NULL, 1, 0, bytes, sizeof bytes));
    REFUSES(grobo_board_ask(bytes, 1, 0, NULL, sizeof bytes));
    REFUSES(grobo_board_relay(NULL, 1, bytes, sizeof bytes));
    REFUSES(grobo_board_relay(bytes, 1, NULL, sizeof bytes));
    REFUSES(grobo_board_parse(NULL, 1, &board_frame));
    REFUSES(grobo_board_parse(bytes, 1, NULL));
    REFUSES(grobo_board_peek(NULL, 1, &board_frame));
    REFUSES(grobo_board_peek(bytes, 1, NULL));
    grobo_board_parser_init(NULL, 0);
    assert_int_equal(grobo_board_parser_feed(NULL, bytes, 1, 1000), 0);
    assert_int_equal(grobo_board_parser_feed(&board_parser, NULL, 1, 1000), 0);
    REFUSES(grobo_board_parser_next(NULL, 1000, &board_frame));
    REFUSES(grobo_board_parser_next(&board_parser, 1000, NULL));
    assert_true(grobo_board_parser_deadline(NULL) == GROBO_NEVER_US);
    grobo_board_parser_reset(NULL);
}

TEST(body_refuses_null)
{
    REFUSES(grobo_body_model_check(NULL));
    grobo_body_forward(NULL, transforms, reals, transforms);
    grobo_body_forward(&grobo_i_gr001_body, transforms, NULL, transforms);
    grobo_body_forward(&grobo_i_gr001_body, transforms, reals, NULL);
    assert_true(grobo_body_com(NULL, transforms, reals) == 0);
    assert_true(grobo_body_com(&grobo_i_gr001_body, NULL, reals) == 0);
    assert_true(grobo_body_com(&grobo_i_gr001_body, transforms, NULL) == 0);
    REFUSES(grobo_body_stand_pose(NULL, reals, NULL, &stand));
    REFUSES(grobo_body_stand_pose(&grobo_i_gr001_body, NULL, NULL, &stand));
    REFUSES(grobo_body_stand_pose(&grobo_i_gr001_body, reals, NULL, NULL));
    assert_true(grobo_body_stand_margin(NULL, reals) == -INFINITY);
    assert_true(grobo_body_stand_margin(&stand, NULL) == -INFINITY);
    REFUSES(grobo_body_zmp_of_poses(NULL, transforms, poses, 1, reals));
    REFUSES(grobo_body_zmp_of_poses(&grobo_i_gr001_body, NULL, poses, 1, reals));
    REFUSES(grobo_body_zmp_of_poses(&grobo_i_gr001_body, transforms, NULL, 1, reals));
    REFUSES(grobo_body_zmp_of_poses(&grobo_i_gr001_body, transforms, poses, 1, NULL));
    grobo_body_momentum(NULL, transforms, &velocity, &momentum);
    grobo_body_momentum(&grobo_i_gr001_body, NULL, &velocity, &momentum);
    grobo_body_momentum(&grobo_i_gr001_body, transforms, NULL, &momentum);
    grobo_body_momentum(&grobo_i_gr001_body, transforms, &velocity, NULL);
    grobo_body_zmp(NULL, 0, &momentum, reals);
    grobo_body_zmp(reals, 0, NULL, reals);
    grobo_body_zmp(reals, 0, &momentum, NULL);
    REFUSES(grobo_body_leg_exact(NULL, 0, transforms, reals));
    REFUSES(grobo_body_leg_exact(&grobo_i_gr001_body, 0, NULL, reals));
    REFUSES(grobo_body_leg_exact(&grobo_i_gr001_body, 0, transforms, NULL));
    REFUSES(grobo_body_workspace_bytes(NULL, sizes));
    REFUSES(grobo_body_workspace_bytes(&setup, NULL));
    REFUSES(grobo_body_init(&setup, bytes, sizeof bytes, NULL));
    REFUSES(grobo_body_init(NULL, bytes, sizeof bytes, &made_body));
    REFUSES(grobo_body_init(&setup, NULL, sizeof bytes, &made_body));
    REFUSES(grobo_body_frame_count(NULL));
    assert_int_equal(grobo_body_joints(NULL), 0);
    REFUSES(grobo_body_frame(NULL, 0, reals, &report));
    REFUSES(grobo_body_frame(body, 0, NULL, &report));
    REFUSES(grobo_body_sample(NULL, 0, reals, &report));
    REFUSES(grobo_body_sample(body, 0, NULL, &report));
    REFUSES(grobo_body_check(NULL, &body_check));
    REFUSES(grobo_body_check(body, NULL));
}

TEST(body_motion_refuses_null)
{
    assert_false(grobo_body_wanted(&grobo_i_gr001_body, NULL));
    REFUSES(grobo_body_new(&grobo_i_gr001_body, motion, &body_options, grobo_mem_default(), NULL));
    REFUSES(grobo_body_new(NULL, motion, &body_options, grobo_mem_default(), &made_body));
    REFUSES(
        grobo_body_new(&grobo_i_gr001_body, NULL, &body_options, grobo_mem_default(), &made_body));
    grobo_body_free(NULL);
    grobo_body_clip(NULL, true, &clip);
    grobo_body_clip(body, true, NULL);
    REFUSES(grobo_body_frames(NULL, grobo_mem_default(), &made_motion));
    REFUSES(grobo_body_frames(body, grobo_mem_default(), NULL));
}

TEST(dxl_refuses_null)
{
    static grobo_dxl2_packet packet2;
    static grobo_dxl1_packet packet1;
    const grobo_servo_model *model = &grobo_i_sts_table.models[0];
    const grobo_servo_register *reg = grobo_servo_register_of(model, GROBO_ROLE_GOAL);
    REFUSES(grobo_dxl2_measure(NULL, 1, GROBO_ACCEPT_RETURNS));
    REFUSES(grobo_dxl2_parse(NULL, 1, bytes, sizeof bytes, &packet2));
    REFUSES(grobo_dxl2_parse(bytes, 1, NULL, sizeof bytes, &packet2));
    REFUSES(grobo_dxl2_parse(bytes, 1, bytes, sizeof bytes, NULL));
    REFUSES(grobo_dxl2_build(NULL, bytes, sizeof bytes));
    REFUSES(grobo_dxl2_build(&packet2, NULL, sizeof bytes));
    packet2.data_bytes = 1;
    REFUSES(grobo_dxl2_build(&packet2, bytes, sizeof bytes));
    REFUSES(grobo_dxl2_block(NULL, 30, 8, 4, &packet2));
    REFUSES(grobo_dxl2_block(bytes, 30, 8, 4, NULL));
    assert_int_equal(grobo_dxl2_crc(1, NULL, 4), 1);
    REFUSES(grobo_dxl1_measure(NULL, 1, GROBO_ACCEPT_RETURNS));
    REFUSES(grobo_dxl1_answer(NULL, 1, bytes, 1));
    REFUSES(grobo_dxl1_answer(bytes, 1, NULL, 1));
    REFUSES(grobo_dxl1_parse(NULL, 1, false, &packet1));
    REFUSES(grobo_dxl1_parse(bytes, 1, false, NULL));
    REFUSES(grobo_dxl1_build(NULL, bytes, sizeof bytes));
    REFUSES(grobo_dxl1_build(&packet1, NULL, sizeof bytes));
    packet1.data_bytes = 1;
    REFUSES(grobo_dxl1_build(&packet1, bytes, sizeof bytes));
    assert_null(grobo_servo_model_named(NULL, "STS3215"));
    assert_null(grobo_servo_series(NULL));
    assert_null(grobo_model_joint(NULL, 0));
    assert_null(grobo_servo_model_named(&grobo_i_sts_table, NULL));
    assert_null(grobo_servo_model_numbered(NULL, 777));
    assert_null(grobo_servo_register_row(NULL, 0));
    assert_null(grobo_servo_register_named(NULL, "id"));
    assert_null(grobo_servo_register_named(model, NULL));
    assert_null(grobo_servo_register_at(NULL, 0));
    assert_null(grobo_servo_register_of(NULL, GROBO_ROLE_ID));
    assert_int_equal(grobo_servo_register_get(NULL, reg, bytes), 0);
    assert_int_equal(grobo_servo_register_get(model, NULL, bytes), 0);
    assert_int_equal(grobo_servo_register_get(model, reg, NULL), 0);
    REFUSES(grobo_servo_register_put(NULL, reg, 0, bytes));
    REFUSES(grobo_servo_register_put(model, NULL, 0, bytes));
    REFUSES(grobo_servo_register_put(model, reg, 0, NULL));
    REFUSES(grobo_servo_baud_bps(NULL, 1));
    REFUSES(grobo_servo_baud_code(NULL, 115200));
}

TEST(lx16a_and_ics_refuse_null)
{
    static grobo_lx16a_packet lx16a;
    static grobo_ics_packet ics;
    REFUSES(grobo_ics_measure(NULL, 1));
    REFUSES(grobo_ics_answer(NULL, 1, bytes, 1));
    REFUSES(grobo_ics_answer(bytes, 1, NULL, 1));
    REFUSES(grobo_ics_parse(NULL, 0, NULL, 1, &ics));
    REFUSES(grobo_ics_parse(NULL, 0, bytes, 1, NULL));
    REFUSES(grobo_ics_build(NULL, bytes, sizeof bytes));
    REFUSES(grobo_ics_build(&ics, NULL, sizeof bytes));
    REFUSES(grobo_lx16a_measure(NULL, 1, GROBO_ACCEPT_RETURNS));
    REFUSES(grobo_lx16a_answer(NULL, 1, bytes, 1));
    REFUSES(grobo_lx16a_answer(bytes, 1, NULL, 1));
    REFUSES(grobo_lx16a_parse(NULL, 1, &lx16a));
    REFUSES(grobo_lx16a_parse(bytes, 1, NULL));
    REFUSES(grobo_lx16a_build(NULL, bytes, sizeof bytes));
    REFUSES(grobo_lx16a_build(&lx16a, NULL, sizeof bytes));
    lx16a.data_bytes = 1;
    REFUSES(grobo_lx16a_build(&lx16a, bytes, sizeof bytes));
}

TEST(driver_refuses_null)
{
    REFUSES(grobo_driver_check(NULL));
    REFUSES(grobo_driver_copy(NULL, &made_driver));
    REFUSES(grobo_driver_copy(&made_driver, NULL));
    assert_int_equal(grobo_driver_wiring(NULL), GROBO_WIRING_BOARD);
    REFUSES(grobo_dxl2_driver_init(NULL, &grobo_i_gr001_model));
    REFUSES(grobo_dxl2_driver_init(&made_driver, NULL));
    assert_false(grobo_ics_tells_position(NULL));
    REFUSES(grobo_ics_driver_init(NULL, &grobo_i_gr001_model));
    REFUSES(grobo_ics_driver_init(&made_driver, NULL));
    REFUSES(grobo_lx16a_driver_init(NULL, &grobo_i_gr001_model));
    REFUSES(grobo_lx16a_driver_init(&made_driver, NULL));
    REFUSES(grobo_dxl1_driver_init(NULL, &grobo_i_gr001_model));
    REFUSES(grobo_dxl1_driver_init(&made_driver, NULL));
    REFUSES(grobo_feetech_driver_init(NULL, &grobo_i_gr001_model));
    REFUSES(grobo_feetech_driver_init(&made_driver, NULL));
    assert_true(grobo_joint_to_servo(NULL, 1) >= 0 && grobo_joint_from_servo(NULL, 1) >= 0);
    REFUSES(grobo_rs30x_driver_init(NULL, &grobo_i_gr001_model, &grobo_i_rs30x_protocol));
    REFUSES(grobo_rs30x_driver_init(&made_driver, NULL, &grobo_i_rs30x_protocol));
    REFUSES(grobo_rs30x_driver_init(&made_driver, &grobo_i_gr001_model, NULL));
}

TEST(interpolate_refuses_null)
{
    grobo_spline_order(NULL, 1, sizes);
    grobo_spline_order(reals, 1, NULL);
    REFUSES(grobo_spline_append(NULL, 0, 0, 0, true));
    grobo_spline_prepare(NULL, 1);
    assert_true(grobo_spline_at(NULL, 1, 0, sizes) == 0);
    assert_true(grobo_spline_cubic(NULL, keys, 0) == 0);
    assert_true(grobo_spline_cubic(keys, NULL, 0) == 0);
}

TEST(model_refuses_null)
{
    REFUSES(grobo_model_check(NULL));
    assert_true(grobo_model_take_slack(NULL, 1, 0) == 0);
    assert_int_equal(grobo_model_unit(NULL, 0), GROBO_UNIT_DEG);
    assert_int_equal(grobo_model_wheels(NULL), 0);
    assert_true(isnan(grobo_model_value(NULL, 0, 1)));
    assert_true(isnan(grobo_model_angle(NULL, 0, 1)));
    assert_true(isnan(grobo_model_change(NULL, 0, 1)));
    REFUSES(grobo_model_joint_of_motor(NULL, 1));
    REFUSES(grobo_model_motor_of_joint(NULL, 1));
    REFUSES(grobo_model_motor_order(NULL, NULL));
    REFUSES(grobo_model_find_joint(NULL, text, 4));
    REFUSES(grobo_model_find_joint(&grobo_i_gr001_model, NULL, 4));
    REFUSES(grobo_model_find_joints(NULL, text, 4, &joints));
    REFUSES(grobo_model_find_joints(&grobo_i_gr001_model, NULL, 4, &joints));
    REFUSES(grobo_model_find_joints(&grobo_i_gr001_model, text, 4, NULL));
}

TEST(motion_refuses_null_in_its_first_functions)
{
    REFUSES(grobo_motion_new(0, 20, grobo_mem_default(), NULL));
    grobo_motion_free(NULL);
    REFUSES(grobo_motion_dup(NULL, &made_motion));
    REFUSES(grobo_motion_dup(motion, NULL));
    grobo_motion_clear(NULL);
    grobo_motion_renew(NULL, 0);
    REFUSES(grobo_motion_resolve(NULL, &posture));
    REFUSES(grobo_motion_resolve(motion, NULL));
    assert_int_equal(grobo_motion_size(NULL), 0);
    assert_int_equal(grobo_motion_get_kind(NULL), GROBO_MOTION_POSTURES);
    REFUSES(grobo_motion_joints(NULL));
    REFUSES(grobo_motion_set_joints(NULL, 20));
    assert_null(grobo_motion_name(NULL));
    REFUSES(grobo_motion_set_name(NULL, text));
    REFUSES(grobo_motion_set_name(motion, NULL));
    assert_null(grobo_motion_target_body(NULL));
    REFUSES(grobo_motion_set_target_body(NULL, text));
    REFUSES(grobo_motion_set_target_body(motion, NULL));
    assert_true(grobo_motion_frame_rate(NULL) == 0);
    REFUSES(grobo_motion_set_frame_rate(NULL, 50.0));
    assert_false(grobo_motion_has_frame_times(NULL));
    REFUSES(grobo_motion_set_frame_times(NULL, true));
    REFUSES(grobo_motion_get(NULL, 1, &posture));
    REFUSES(grobo_motion_get(motion, 1, NULL));
    REFUSES(grobo_motion_rget(NULL, 1, &posture));
    REFUSES(grobo_motion_rget(motion, 1, NULL));
    REFUSES(grobo_motion_time_s(NULL, 1, reals));
    REFUSES(grobo_motion_time_s(motion, 1, NULL));
    assert_true(grobo_motion_step_us(NULL, 1) == 0);
    assert_true(grobo_motion_length_us(NULL, 0) == 0);
}

TEST(motion_refuses_null_in_its_second_functions)
{
    REFUSES(grobo_motion_append(NULL, &posture));
    REFUSES(grobo_motion_append(motion, NULL));
    REFUSES(grobo_motion_append_at(NULL, 0, &posture));
    REFUSES(grobo_motion_append_at(motion, 0, NULL));
    REFUSES(grobo_motion_insert(NULL, 1, &posture));
    REFUSES(grobo_motion_insert(motion, 1, NULL));
    REFUSES(grobo_motion_insert_at(NULL, 0, &posture));
    REFUSES(grobo_motion_insert_at(motion, 0, NULL));
    REFUSES(grobo_motion_delete(NULL, 1));
    REFUSES(grobo_motion_delete_keep_times(NULL, 1));
    REFUSES(grobo_motion_set(NULL, 1, &posture));
    REFUSES(grobo_motion_set(motion, 1, NULL));
    REFUSES(grobo_motion_set_time_s(NULL, 1, 0));
    REFUSES(grobo_motion_get_key(NULL, 1, &key));
    REFUSES(grobo_motion_get_key(motion, 1, NULL));
    REFUSES(grobo_motion_set_key(NULL, 1, &key));
    REFUSES(grobo_motion_set_key(motion, 1, NULL));
    assert_null(grobo_motion_key_name(NULL, 1));
    REFUSES(grobo_motion_set_key_name(NULL, 1, text));
    REFUSES(grobo_motion_set_key_name(motion, 1, NULL));
    assert_null(grobo_motion_ik_links(NULL, 1, sizes));
    assert_null(grobo_motion_ik_links(motion, 1, NULL));
    REFUSES(grobo_motion_set_ik_links(NULL, 1, links, 1));
    REFUSES(grobo_motion_set_ik_links(motion, 1, NULL, 1));
    assert_int_equal(grobo_motion_kept_count(NULL, 1), 0);
    REFUSES(grobo_motion_get_kept(NULL, 1, 0, &kept));
    REFUSES(grobo_motion_get_kept(motion, 1, 0, NULL));
    REFUSES(grobo_motion_keep(NULL, 1, &kept));
    REFUSES(grobo_motion_keep(NULL, GROBO_MOTION_TOP, &kept));
    REFUSES(grobo_motion_keep(motion, 1, NULL));
    assert_int_equal(grobo_motion_line(NULL, 1), 0);
}

TEST(motion_refuses_null_in_its_third_functions)
{
    assert_false(grobo_motion_position(NULL, 1, 1, longs, longs));
    assert_false(grobo_motion_position(motion, 1, 1, NULL, longs));
    assert_false(grobo_motion_position(motion, 1, 1, longs, NULL));
    assert_false(grobo_motion_set_reverse(NULL, true));
    assert_false(grobo_motion_is_reverse(NULL));
    grobo_motion_reset(NULL);
    assert_int_equal(grobo_motion_current(NULL), 0);
    REFUSES(grobo_motion_next(NULL, &posture));
    REFUSES(grobo_motion_next(motion, NULL));
    assert_false(grobo_motion_equal(NULL, motion));
    assert_false(grobo_motion_equal(motion, NULL));
    assert_false(grobo_motion_near(NULL, motion, 0, 0));
    assert_false(grobo_motion_near(motion, NULL, 0, 0));
    REFUSES(grobo_motion_append_motion(NULL, motion));
    REFUSES(grobo_motion_append_motion(motion, NULL));
    REFUSES(grobo_motion_concat(NULL, motion, 0));
    REFUSES(grobo_motion_concat(motion, NULL, 0));
    REFUSES(grobo_motion_mirror(NULL, &grobo_i_gr001_model));
    REFUSES(grobo_motion_mirror(motion, NULL));
    REFUSES(grobo_motion_reverse(NULL));
    REFUSES(grobo_motion_scale_time(NULL, 50.0));
    REFUSES(grobo_motion_crop(NULL, 0, 0));
    assert_false(grobo_motion_is_for(NULL, &grobo_i_gr001_model));
    grobo_motion_start(NULL, &grobo_i_gr001_model, &posture);
    grobo_motion_start(motion, &grobo_i_gr001_model, NULL);
    REFUSES(grobo_motion_clip(NULL, &clip_options, &clip));
    REFUSES(grobo_motion_clip(motion, &clip_options, NULL));
    grobo_motion_clip_free(NULL);
    REFUSES(grobo_motion_resample(NULL, 50.0, grobo_mem_default(), &made_motion));
    REFUSES(grobo_motion_resample(&clip, 50.0, grobo_mem_default(), NULL));
}

TEST(motion_io_refuses_null_in_its_first_functions)
{
    REFUSES(grobo_diagnostics_new(grobo_mem_default(), NULL));
    grobo_diagnostics_free(NULL);
    grobo_diagnostics_clear(NULL);
    assert_int_equal(grobo_diagnostics_total(NULL, 0), 0);
    assert_int_equal(grobo_diagnostics_kept(NULL), 0);
    REFUSES(grobo_diagnostics_get(NULL, 0, &diagnostic));
    REFUSES(grobo_diagnostics_get(list, 0, NULL));
    grobo_diagnostics_add(NULL, &diagnostic);
    grobo_diagnostics_add(list, NULL);
    assert_int_equal(grobo_motion_format_of_path(NULL), GROBO_FORMAT_AUTO);
    REFUSES(grobo_motion_read_file(NULL, &read_options, list, &made_motion));
    REFUSES(grobo_motion_read_file(text, &read_options, list, NULL));
    REFUSES(grobo_motion_read_memory(NULL, 1, &read_options, list, &made_motion));
    REFUSES(grobo_motion_read_memory(bytes, 1, &read_options, list, NULL));
    REFUSES(grobo_motion_read(NULL, &read_options, list, &made_motion));
    REFUSES(grobo_motion_read(&source, &read_options, list, NULL));
    REFUSES(grobo_motion_check(NULL, &grobo_i_gr001_model, &check_options, list));
    REFUSES(grobo_motion_check(motion, NULL, &check_options, list));
    REFUSES(grobo_motion_convert(NULL, 0, &write_options, list, &made_motion));
    REFUSES(grobo_motion_convert(motion, 0, &write_options, list, NULL));
}

TEST(motion_io_refuses_null_in_its_second_functions)
{
    REFUSES(grobo_motion_verify(NULL, motion, &write_options, list));
    REFUSES(grobo_motion_verify(motion, NULL, &write_options, list));
    REFUSES(grobo_motion_write(NULL, 0, &write_options, &sink, list));
    REFUSES(grobo_motion_write(motion, 0, &write_options, NULL, list));
    REFUSES(grobo_motion_may_save(NULL, text, 0));
    REFUSES(grobo_motion_may_save(grobo_files_os(), NULL, 0));
    REFUSES(grobo_motion_save(NULL, grobo_files_os(), text, &write_options, list));
    REFUSES(grobo_motion_save(motion, NULL, text, &write_options, list));
    REFUSES(grobo_motion_save(motion, grobo_files_os(), NULL, &write_options, list));
    REFUSES(
        grobo_motion_save_next(NULL, grobo_files_os(), text, &write_options, text, sizeof bytes));
    REFUSES(grobo_motion_save_next(motion, NULL, text, &write_options, text, sizeof bytes));
    REFUSES(
        grobo_motion_save_next(motion, grobo_files_os(), NULL, &write_options, text, sizeof bytes));
    REFUSES(
        grobo_motion_save_next(motion, grobo_files_os(), text, &write_options, NULL, sizeof bytes));
    REFUSES(grobo_motion_find(NULL, text, text, text, sizeof bytes));
    REFUSES(grobo_motion_find(grobo_files_os(), NULL, text, text, sizeof bytes));
    REFUSES(grobo_motion_find(grobo_files_os(), text, NULL, text, sizeof bytes));
    REFUSES(grobo_motion_find(grobo_files_os(), text, text, NULL, sizeof bytes));
    REFUSES(grobo_posture_print(NULL, stream));
    REFUSES(grobo_posture_print(&posture, NULL));
    REFUSES(grobo_motion_print(NULL, &grobo_i_gr001_model, stream));
    REFUSES(grobo_motion_print(motion, &grobo_i_gr001_model, NULL));
}

TEST(posture_refuses_null_in_its_first_functions)
{
    REFUSES(grobo_posture_init(NULL, 20));
    grobo_posture_init_pose(NULL, &grobo_i_gr001_model);
    grobo_posture_init_pose(&posture, NULL);
    REFUSES(grobo_posture_set_rad(NULL, 1, 0));
    REFUSES(grobo_posture_set_deg(NULL, 1, 0));
    REFUSES(grobo_posture_get_rad(NULL, 1, reals));
    REFUSES(grobo_posture_get_rad(&posture, 1, NULL));
    REFUSES(grobo_posture_get_deg(NULL, 1, reals));
    REFUSES(grobo_posture_get_deg(&posture, 1, NULL));
    REFUSES(grobo_posture_all_deg(NULL, reals, sizeof bytes));
    REFUSES(grobo_posture_all_deg(&posture, NULL, sizeof bytes));
    REFUSES(grobo_posture_all_rad(NULL, reals, sizeof bytes));
    REFUSES(grobo_posture_all_rad(&posture, NULL, sizeof bytes));
    REFUSES(grobo_posture_set_time_ms(NULL, 0));
    REFUSES(grobo_posture_copy(NULL, &posture, 0));
    REFUSES(grobo_posture_copy(&posture, NULL, 0));
}

TEST(posture_refuses_null_in_its_second_functions)
{
    grobo_posture_merge(NULL, &posture);
    grobo_posture_merge(&posture, NULL);
    assert_false(grobo_posture_equal(NULL, &posture));
    assert_false(grobo_posture_equal(&posture, NULL));
    assert_false(grobo_posture_near(NULL, &posture, 0));
    assert_false(grobo_posture_near(&posture, NULL, 0));
    REFUSES(grobo_posture_mirror(NULL, &grobo_i_gr001_model));
    REFUSES(grobo_posture_mirror(&posture, NULL));
    REFUSES(grobo_posture_check(NULL, &grobo_i_gr001_model, ints));
    REFUSES(grobo_posture_check(&posture, NULL, ints));
    REFUSES(grobo_posture_clamp(NULL, &grobo_i_gr001_model));
    REFUSES(grobo_posture_clamp(&posture, NULL));
    REFUSES(grobo_posture_parse(NULL, &grobo_i_gr001_model, text, 4));
    REFUSES(grobo_posture_parse(&posture, NULL, text, 4));
    REFUSES(grobo_posture_parse(&posture, &grobo_i_gr001_model, NULL, 4));
}

TEST(rs30x_refuses_null_in_its_first_functions)
{
    REFUSES(grobo_rs30x_build(NULL, bytes, sizeof bytes));
    REFUSES(grobo_rs30x_build(&packet, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_read(1, 0, 4, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_read_block(1, 0, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_write_u8(1, 0, 0, 0, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_write_u16(1, 0, 0, 0, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_write_goal(NULL, bytes, sizeof bytes));
    REFUSES(grobo_rs30x_write_goal(goals, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_write_goals(NULL, 1, bytes, sizeof bytes));
    REFUSES(grobo_rs30x_write_goals(goals, 1, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_write_bytes(0, NULL, 1, bytes, sizeof bytes));
    REFUSES(grobo_rs30x_write_bytes(0, pairs, 1, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_control(1, 0, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_factory_reset(1, 0, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_ping(1, 0, NULL, sizeof bytes));
    REFUSES(grobo_rs30x_reply_to(NULL, 1, &reply));
    REFUSES(grobo_rs30x_reply_to(bytes, 1, NULL));
    REFUSES(grobo_frame_goal(NULL, goals, bytes, sizeof bytes));
    REFUSES(grobo_frame_goal(&grobo_i_rs30x_protocol, NULL, bytes, sizeof bytes));
    REFUSES(grobo_frame_goal(&grobo_i_rs30x_protocol, goals, NULL, sizeof bytes));
}

TEST(rs30x_refuses_null_in_its_second_functions)
{
    REFUSES(grobo_frame_goals(NULL, goals, 1, bytes, sizeof bytes));
    REFUSES(grobo_frame_goals(&grobo_i_rs30x_protocol, NULL, 1, bytes, sizeof bytes));
    REFUSES(grobo_frame_goals(&grobo_i_rs30x_protocol, goals, 1, NULL, sizeof bytes));
    REFUSES(grobo_frame_torque(NULL, 1, 0, bytes, sizeof bytes));
    REFUSES(grobo_frame_torque(&grobo_i_rs30x_protocol, 1, 0, NULL, sizeof bytes));
    REFUSES(grobo_frame_torques(NULL, pairs, 1, bytes, sizeof bytes));
    REFUSES(grobo_frame_torques(&grobo_i_rs30x_protocol, NULL, 1, bytes, sizeof bytes));
    REFUSES(grobo_frame_torques(&grobo_i_rs30x_protocol, pairs, 1, NULL, sizeof bytes));
    REFUSES(grobo_frame_read(NULL, 1, 0, 4, bytes, sizeof bytes));
    REFUSES(grobo_frame_read(&grobo_i_rs30x_protocol, 1, 0, 4, NULL, sizeof bytes));
    REFUSES(grobo_frame_wrap(NULL, bytes, 1, bytes, sizeof bytes));
    REFUSES(grobo_frame_wrap(&grobo_i_rs30x_protocol, NULL, 1, bytes, sizeof bytes));
    REFUSES(grobo_frame_wrap(&grobo_i_rs30x_protocol, bytes, 1, NULL, sizeof bytes));
    grobo_rs30x_parser_init(NULL, 0);
    assert_int_equal(grobo_rs30x_parser_feed(NULL, bytes, 1), 0);
    assert_int_equal(grobo_rs30x_parser_feed(&parser, NULL, 1), 0);
    REFUSES(grobo_rs30x_parser_next(NULL, &packet));
    REFUSES(grobo_rs30x_parser_next(&parser, NULL));
    grobo_rs30x_parser_end(NULL);
    grobo_rs30x_parser_reset(NULL);
    assert_int_equal(grobo_rs30x_parser_pending(NULL), 0);
    REFUSES(grobo_rs30x_peek(NULL, 1, 0, &packet, &flag));
    REFUSES(grobo_rs30x_peek(bytes, 1, 0, NULL, &flag));
    REFUSES(grobo_rs30x_peek(bytes, 1, 0, &packet, NULL));
    REFUSES(grobo_rs30x_state_decode(0, NULL, 1, &servo_state));
    REFUSES(grobo_rs30x_state_decode(0, bytes, 1, NULL));
}

TEST(robot_file_refuses_null)
{
    const grobo_source bytes_of = {0};
    grobo_robot_def *def = NULL;
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_robot_sim sim;
    REFUSES(grobo_robot_def_read(NULL, "", NULL, NULL, &def));
    REFUSES(grobo_robot_def_read(&bytes_of, NULL, NULL, NULL, &def));
    REFUSES(grobo_robot_def_read(&bytes_of, "", NULL, NULL, NULL));
    REFUSES(grobo_robot_def_read_file(NULL, NULL, NULL, &def));
    assert_null(grobo_robot_def_find(NULL));
    REFUSES(grobo_robot_def_read_file("", NULL, NULL, NULL));
    grobo_robot_def_free(NULL);
    REFUSES(grobo_robot_def_driver(NULL, GROBO_WIRING_BUS, &driver));
    REFUSES(grobo_robot_def_driver(grobo_i_robot_defs[0], GROBO_WIRING_BUS, NULL));
    static grobo_robot_body own;
    REFUSES(grobo_robot_def_body(NULL, &own));
    REFUSES(grobo_robot_def_body(grobo_i_robot_defs[0], NULL));
    REFUSES(grobo_robot_def_sim(NULL, GROBO_WIRING_BUS, &sim));
    REFUSES(grobo_robot_def_sim(grobo_i_robot_defs[0], GROBO_WIRING_BUS, NULL));
    grobo_sim_physics *physics = NULL;
    assert_false(grobo_robot_def_has_weight(NULL));
    REFUSES(grobo_robot_def_physics(NULL, false, NULL, &physics));
    REFUSES(grobo_robot_def_physics(grobo_i_robot_defs[0], false, NULL, NULL));
    const grobo_sim_plant plant = {0};
    REFUSES(grobo_robot_def_plant(NULL, &plant, false, NULL, &physics));
    REFUSES(grobo_robot_def_plant(grobo_i_robot_defs[0], NULL, false, NULL, &physics));
    REFUSES(grobo_robot_def_plant(grobo_i_robot_defs[0], &plant, false, NULL, NULL));
}

TESTS_BETWEEN(set_up, tear_down)
