/* SPDX-License-Identifier: MIT */
/* Register tables of every family: whole, found by name, address and role, values both ways. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/rs30x.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"

static const grobo_servo_table *const tables[] = {&grobo_i_rs30x_table, &grobo_i_dxl2_table,
                                                  &grobo_i_dxl1_table, &grobo_i_sts_table,
                                                  &grobo_i_scs_table};
enum { TABLES = (int)(sizeof tables / sizeof tables[0]) };

static void row_is_whole(const grobo_servo_model *model, const grobo_servo_register *reg)
{
    assert_true(reg->bytes == 1 || reg->bytes == 2 || reg->bytes == 4);
    assert_true(reg->min <= reg->max);
    bool writable = (reg->flags & GROBO_REGISTER_W) != 0;
    /* What a model is made with must be what it may be set to. */
    assert_true(!writable || (reg->factory >= reg->min && reg->factory <= reg->max));
    assert_ptr_equal(grobo_servo_register_named(model, reg->name), reg);
    assert_ptr_equal(grobo_servo_register_at(model, reg->address), reg);
    assert_ptr_equal(grobo_servo_register_at(model, (uint16_t)(reg->address + reg->bytes - 1)),
                     reg);
    if (reg->role != GROBO_ROLE_NONE) {
        assert_ptr_equal(grobo_servo_register_of(model, (grobo_register_role)reg->role), reg);
    }
    const int32_t values[] = {reg->min, reg->max, 0, 1, -1, reg->factory};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        uint8_t bytes[4];
        int result = grobo_servo_register_put(model, reg, values[i], bytes);
        if (values[i] < reg->min || values[i] > reg->max) {
            assert_int_equal(result, GROBO_ERR_LIMIT);
            continue;
        }
        assert_int_equal(result, reg->bytes);
        assert_int_equal(grobo_servo_register_get(model, reg, bytes), values[i]);
    }
}

TEST(tables_are_whole)
{
    for (int t = 0; t < TABLES; t++) {
        for (int m = 0; m < tables[t]->model_count; m++) {
            const grobo_servo_model *model = &tables[t]->models[m];
            const grobo_servo_register *reg = NULL;
            int end = 0;
            assert_ptr_equal(model->table, tables[t]);
            assert_ptr_equal(grobo_servo_model_named(tables[t], model->name), model);
            assert_int_equal(grobo_servo_model_numbered(tables[t], model->number)->number,
                             model->number);
            for (size_t i = 0; (reg = grobo_servo_register_row(model, i)) != NULL; i++) {
                assert_true(reg->address >= end);
                end = reg->address + reg->bytes;
                row_is_whole(model, reg);
            }
            /* What every driver needs. */
            static const grobo_register_role needed[] = {
                GROBO_ROLE_MODEL,        GROBO_ROLE_ID,           GROBO_ROLE_BAUD,
                GROBO_ROLE_TORQUE,       GROBO_ROLE_GOAL,         GROBO_ROLE_POSITION,
                GROBO_ROLE_MIN_POSITION, GROBO_ROLE_MAX_POSITION, GROBO_ROLE_VOLTAGE,
                GROBO_ROLE_TEMPERATURE};
            for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++) {
                assert_non_null(grobo_servo_register_of(model, needed[i]));
            }
            bool hls = tables[t] == &grobo_i_sts_table &&
                       grobo_servo_register_named(model, "secondary_id") != NULL;
            assert_true((grobo_servo_register_of(model, GROBO_ROLE_RETURN_DELAY) == NULL) == hls);
            bool locks = grobo_servo_register_of(model, GROBO_ROLE_LOCK) != NULL;
            assert_true(locks || tables[t]->keeps != GROBO_KEEPS_LOCK);
        }
    }
}

/* The same item differs by model: what the maker's pages say. */
static const struct {
    const char *model, *name;
    int address, factory; /* -1: the model has none */
} own_rows[] = {
    {"XL330-M288", "current_limit", 38, 1750},
    {"XM430-W350", "current_limit", 38, 1193},
    {"XC330-T288", "current_limit", 38, 910},
    {"XL430-W250", "current_limit", -1, 0},
    {"XL330-M288", "shutdown", 63, 53},
    {"XL430-W250", "shutdown", 63, 52},
    {"XL430-W250", "present_load", 126, 0},
    {"XL330-M077", "present_current", 126, 0},
    {"XM430-W350", "position_p", 84, 800},
    {"XL430-W250", "position_d", 80, 4000},
    {"XL330-M288", "max_voltage", 32, 70},
    {"XC330-T181", "min_voltage", 34, 55},
    {"XM430-W210", "temperature_limit", 31, 80},
    {"2XL430-W250", "velocity_limit", 44, 265},
    {"XC430-W150", "velocity_limit", 44, 460},
    {"XC430-W150", "temperature_limit", 31, 80},
    {"XC430-W150", "max_voltage", 32, 160},
    {"XC430-W150", "velocity_i", 76, 1920},
    {"XC430-W150", "position_d", 80, 0},
    {"XC430-W150", "position_p", 84, 460},
    {"XC430-W150", "moving_threshold", 24, 20},
    {"XC430-W240", "velocity_limit", 44, 306},
    {"XC430-W240", "position_p", 84, 700},
    {"XC430-W240", "max_voltage", 32, 160},
    {"XM430-W210", "velocity_limit", 44, 330},
    {"XL330-M077", "velocity_limit", 44, 1620},
    {"XL330-M077", "velocity_i", 76, 400},
    {"XL330-M077", "velocity_p", 78, 40},
    {"XL330-M077", "position_i", 82, 400},
    {"XC330-M181", "velocity_limit", 44, 545},
    {"XC330-M181", "velocity_i", 76, 1400},
    {"XC330-M181", "position_p", 84, 1200},
    {"XC330-T181", "velocity_limit", 44, 510},
    {"XC330-T288", "velocity_limit", 44, 320},
    {"XC330-T288", "model_information", 2, 0},
    {"XL-320", "moving_speed", 32, 0},
    {"XL-320", "present_position", 37, 0},
    {"XL-320", "temperature_limit", 12, 65},
    {"XL-320", "max_voltage", 14, 90},
    {"XL-320", "shutdown", 18, 3},
    {"PH54-200-S500-R", "current_limit", 38, 22740},
    {"PH54-200-S500-R", "position_p", 532, 314},
    {"PH54-200-S500-R", "shutdown", 63, 52},
    {"PH54-100-S500-R", "shutdown", 63, 58},
    {"PH42-020-S300-R", "max_position", 48, 303454},
    {"PM54-060-S250-R", "acceleration_limit", 40, 11145},
    {"PM54-040-S250-R", "velocity_limit", 44, 2840},
    {"PM42-010-S260-R", "min_position", 52, -262931},
    {"H54-200-S500-RA", "acceleration_limit", 40, 9982},
    {"H54-100-S500-RA", "moving_threshold", 24, 50},
    {"H42-20-S300-RA", "protocol_type", -1, 0},
    {"M54-60-S250-RA", "temperature", 594, 0},
    {"M54-40-S250-RA", "current_limit", 38, 4470},
    {"M42-10-S260-RA", "goal_position", 564, 0},
    {"H54-200-S500-R", "torque", 562, 0},
    {"H54-200-S500-R", "torque_limit", 30, 620},
    {"H54-200-S500-R", "velocity_p", 588, 399},
    {"H54-200-S500-R", "hardware_error", 892, 0},
    {"H54-100-S500-R", "torque_limit", 30, 310},
    {"H42-20-S300-R", "velocity_limit", 32, 10300},
    {"M54-60-S250-R", "max_position", 36, 125708},
    {"M54-40-S250-R", "torque_limit", 30, 120},
    {"M42-10-S260-R", "velocity_p", 588, 520},
    {"L54-50-S500-R", "goal_position", 596, 0},
    {"L54-50-S290-R", "position_p", 594, 250},
    {"L54-30-S500-R", "max_position", 36, 180692},
    {"L54-30-S400-R", "velocity_limit", 32, 9000},
    {"L42-10-S300-R", "min_position", 40, -2047},
    {"L42-10-S300-R", "shutdown", 48, 30},
};

TEST(models_have_their_own_rows)
{
    for (size_t i = 0; i < sizeof own_rows / sizeof own_rows[0]; i++) {
        const grobo_servo_model *model =
            grobo_servo_model_named(&grobo_i_dxl2_table, own_rows[i].model);
        const grobo_servo_register *reg = grobo_servo_register_named(model, own_rows[i].name);
        assert_int_equal(reg != NULL ? reg->address : -1, own_rows[i].address);
        assert_int_equal(reg != NULL ? reg->factory : 0, own_rows[i].factory);
    }
    /* The bound itself, as its page has it. */
    const grobo_servo_register *bound = grobo_servo_register_named(
        grobo_servo_model_named(&grobo_i_dxl2_table, "XC430-W150"), "max_voltage");
    assert_int_equal(bound->min, 60);
    assert_int_equal(bound->max, 160);
    /* RX have the registers of AX; their pages of the e-manual. */
    static const char *const rx[] = {"RX-24F", "RX-28", "RX-64"};
    static const uint16_t numbers[] = {24, 28, 64};
    for (size_t i = 0; i < 3; i++) {
        const grobo_servo_model *model = grobo_servo_model_named(&grobo_i_dxl1_table, rx[i]);
        assert_ptr_equal(grobo_servo_model_numbered(&grobo_i_dxl1_table, numbers[i]), model);
        assert_int_equal(grobo_servo_register_named(model, "baud")->factory, 34);
        assert_int_equal(grobo_servo_register_named(model, "temperature_limit")->factory, 80);
        assert_int_equal(grobo_servo_register_named(model, "max_voltage")->factory, 190);
        assert_int_equal(model->span_deg, 300);
    }
    assert_null(grobo_servo_model_named(&grobo_i_dxl2_table, "XL330"));
    assert_null(grobo_servo_model_numbered(&grobo_i_dxl2_table, 9999));
}

/* What a model does at its voltage: of the same column of the data sheet. */
TEST(models_have_figures_of_their_voltage)
{
    static const struct {
        const char *model;
        int dps, mnm, ma, mv;
    } rows[] = {
        {"XC330-T181", 678, 800, 880, 12000},    {"XC330-T288", 426, 1000, 880, 12000},
        {"XC330-M288", 486, 930, 1800, 5000},    {"XL330-M077", 2298, 215, 1470, 5000},
        {"XM540-W270", 180, 10600, 4400, 12000}, {"XH540-V150", 360, 6400, 2400, 24000},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_servo_model *model =
            grobo_servo_model_named(&grobo_i_dxl2_table, rows[i].model);
        assert_non_null(model);
        assert_int_equal(model->speed_dps, rows[i].dps);
        assert_int_equal(model->torque_mnm, rows[i].mnm);
        assert_int_equal(model->current_ma, rows[i].ma);
        assert_int_equal(model->voltage_mv, rows[i].mv);
    }
}

/* Numbers and scales, as the makers' pages have them. */
TEST(models_have_their_numbers_and_scales)
{
    static const struct {
        const grobo_servo_table *table;
        const char *model;
        unsigned number, ticks, deg;
    } rows[] = {
        {&grobo_i_dxl2_table, "XL-320", 350, 1023, 300},
        {&grobo_i_dxl2_table, "PH54-200-S500-R", 2020, 1003846, 360},
        {&grobo_i_dxl2_table, "PH54-100-S500-R", 2010, 1003846, 360},
        {&grobo_i_dxl2_table, "PH42-020-S300-R", 2000, 607500, 360},
        {&grobo_i_dxl2_table, "PM54-060-S250-R", 2120, 502834, 360},
        {&grobo_i_dxl2_table, "PM54-040-S250-R", 2110, 502834, 360},
        {&grobo_i_dxl2_table, "PM42-010-S260-R", 2100, 526374, 360},
        {&grobo_i_dxl2_table, "H54-200-S500-RA", 54025, 1003846, 360},
        {&grobo_i_dxl2_table, "H54-100-S500-RA", 53769, 1003846, 360},
        {&grobo_i_dxl2_table, "H42-20-S300-RA", 51201, 607500, 360},
        {&grobo_i_dxl2_table, "M54-60-S250-RA", 46353, 502834, 360},
        {&grobo_i_dxl2_table, "M54-40-S250-RA", 46097, 502834, 360},
        {&grobo_i_dxl2_table, "M42-10-S260-RA", 43289, 526374, 360},
        {&grobo_i_dxl1_table, "MX-12W", 104, 4096, 360},
        {&grobo_i_sts_table, "STS3032", 521, 4096, 360},
        {&grobo_i_sts_table, "SM40BL", 10248, 4096, 360},
        {&grobo_i_sts_table, "SM60CL", 6662, 4096, 360},
        {&grobo_i_sts_table, "SM85CL", 6150, 4096, 360},
        {&grobo_i_sts_table, "HLS3930", 4106, 4096, 360},
        {&grobo_i_sts_table, "HLS3915", 5130, 4096, 360},
        {&grobo_i_scs_table, "SCS225", 8969, 1024, 300},
        {&grobo_i_rs30x_table, "RS405CB", 0x4050, 3000, 300},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_servo_model *model = grobo_servo_model_named(rows[i].table, rows[i].model);
        assert_non_null(model);
        assert_int_equal(model->number, rows[i].number);
        assert_int_equal(model->span_ticks, rows[i].ticks);
        assert_int_equal(model->span_deg, rows[i].deg);
    }
}

/* Where the maker's header of SMCL has what differs from STS (SMSCL.h): the lock stands where STS
 * has its limit of torque. */
TEST(an_sm85cl_has_a_layout_of_its_own)
{
    static const struct {
        grobo_register_role role;
        int address;
    } rows[] = {
        {GROBO_ROLE_OFFSET, 33},    {GROBO_ROLE_MODE, 35},    {GROBO_ROLE_GOAL, 42},
        {GROBO_ROLE_GOAL_TIME, 44}, {GROBO_ROLE_SPEED, 46},   {GROBO_ROLE_LOCK, 48},
        {GROBO_ROLE_POSITION, 56},  {GROBO_ROLE_CURRENT, 69},
    };
    const grobo_servo_model *model = grobo_servo_model_named(&grobo_i_sts_table, "SM85CL");
    assert_non_null(model);
    assert_true((model->flags & GROBO_MODEL_NO_JOINT) != 0);
    assert_null(grobo_servo_register_of(model, GROBO_ROLE_TORQUE_LIMIT));
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_servo_register *reg = grobo_servo_register_of(model, rows[i].role);
        assert_non_null(reg);
        assert_int_equal(reg->address, rows[i].address);
    }
}

/* Bytes as clients send and read them (LeRobot 0.6.1, rustypot 1.13.1, feetech-servo-sdk). */
TEST(values_are_written_as_each_series_does)
{
    static const struct {
        const grobo_servo_table *table;
        const char *model, *name;
        int32_t value;
        const char *hex;
    } rows[] = {
        {&grobo_i_sts_table, "STS3215", "goal_position", 2048, "00 08"},
        {&grobo_i_scs_table, "SCS0009", "goal_position", 1000, "03 E8"},
        {&grobo_i_sts_table, "STS3215", "offset", -195, "C3 08"},
        {&grobo_i_sts_table, "STS3215", "offset", 100, "64 00"},
        {&grobo_i_sts_table, "STS3215", "goal_speed", -600, "58 82"},
        {&grobo_i_sts_table, "STS3215", "present_load", -300, "2C 05"},
        {&grobo_i_dxl2_table, "XL330-M288", "goal_velocity", -100, "9C FF FF FF"},
        {&grobo_i_dxl2_table, "XL330-M288", "homing_offset", -50, "CE FF FF FF"},
        {&grobo_i_dxl2_table, "XL330-M288", "watchdog", -1, "FF"},
        {&grobo_i_dxl1_table, "MX-64", "goal_position", -2048, "00 F8"},
        {&grobo_i_dxl1_table, "AX-12A", "present_speed", -300, "2C 05"},
        {&grobo_i_rs30x_table, "RS302CD", "goal", -1500, "24 FA"},
        {&grobo_i_rs30x_table, "RS302CD", "speed", -1, "FF FF"},
        {&grobo_i_rs30x_table, "RS302CD", "current", 65535, "FF FF"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_servo_model *model = grobo_servo_model_named(rows[i].table, rows[i].model);
        const grobo_servo_register *reg = grobo_servo_register_named(model, rows[i].name);
        uint8_t bytes[4];
        vector_expect(grobo_servo_register_put(model, reg, rows[i].value, bytes), bytes,
                      rows[i].hex);
        assert_int_equal(grobo_servo_register_get(model, reg, bytes), rows[i].value);
    }
}

TEST(codes_of_rates_go_both_ways)
{
    static const struct {
        const grobo_servo_table *table;
        const char *model;
        int code;
        int32_t bps;
    } rows[] = {
        {&grobo_i_rs30x_table, "RS301CR", 10, 460800},
        {&grobo_i_dxl2_table, "XL430-W250", 7, 4500000},
        {&grobo_i_dxl1_table, "AX-12A", 1, 1000000},
        {&grobo_i_dxl1_table, "MX-28", 252, 3000000},
        {&grobo_i_sts_table, "STS3215", 4, 115200},
        {&grobo_i_scs_table, "SCS0009", 0, 1000000},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_servo_model *model = grobo_servo_model_named(rows[i].table, rows[i].model);
        const grobo_servo_register *reg = grobo_servo_register_of(model, GROBO_ROLE_BAUD);
        assert_int_equal(grobo_servo_baud_bps(model, rows[i].code), rows[i].bps);
        for (int code = 0; code <= reg->max; code++) {
            int32_t bps = grobo_servo_baud_bps(model, code);
            assert_true(bps < 0 || grobo_servo_baud_code(model, bps) == code);
        }
        assert_true(grobo_servo_baud_bps(model, reg->factory) > 0);
        assert_int_equal(grobo_servo_baud_bps(model, 255), GROBO_ERR_ARG);
        assert_int_equal(grobo_servo_baud_code(model, 115201), GROBO_ERR_UNSUPPORTED);
    }
    const grobo_servo_model *small = grobo_servo_model_named(&grobo_i_dxl2_table, "XL330-M288");
    assert_int_equal(grobo_servo_baud_bps(small, 7), GROBO_ERR_ARG);
    const grobo_servo_model *ax = grobo_servo_model_named(&grobo_i_dxl1_table, "AX-12A");
    assert_int_equal(grobo_servo_baud_bps(ax, 252), GROBO_ERR_ARG);
}

TEST(what_is_not_there_is_null)
{
    const grobo_servo_model *model = &grobo_i_sts_table.models[0];
    assert_null(grobo_servo_register_at(model, 4000));
    assert_null(grobo_servo_register_at(model, 50));
    assert_null(grobo_servo_register_named(model, "goal"));
    assert_null(grobo_servo_register_of(model, GROBO_ROLE_NONE));
    assert_null(grobo_servo_register_of(model, GROBO_ROLE_WATCHDOG));
    assert_null(grobo_servo_register_row(model, 1000));
}
