/* SPDX-License-Identifier: MIT */
/* The X series: registers and models. Rows and defaults: the maker's pages of XL330-M288,
 * XC330-M288, XC330-T288, XL430-W250 and XM430-W350; numbers of models: DynamixelSDK's
 * dynamixel.model. Speeds, torques and currents are at the nominal supply, and have not been
 * compared with the data sheets yet. */
#include <grobo/dxl2.h>

#include "src/servo/row.h"

/* Groups of models: XL330, XC330 for 5 V and for 12 V; those that report a load; the larger ones
 * that report a current. */
enum { XL330 = 1, XC330M = 2, XC330T = 4, LOAD = 8, LARGE = 16 };
enum { XC330 = XC330M | XC330T, LOW = XL330 | XC330M, SMALL = XL330 | XC330 };
enum { ALL = SMALL | LOAD | LARGE };

static const grobo_servo_register rows[] = {
    ROW("model", 0, 2, 0, E, MODEL, "", 0, 65535, 0, ALL),
    ROW("firmware", 6, 1, 0, E, FIRMWARE, "", 0, 255, 0, ALL),
    ROW("id", 7, 1, 0, EW, ID, "", 0, 252, 1, ALL),
    ROW("baud", 8, 1, 0, EW, BAUD, "code", 0, 6, 1, SMALL),
    ROW("baud", 8, 1, 0, EW, BAUD, "code", 0, 7, 1, LOAD | LARGE),
    ROW("return_delay", 9, 1, 0, EW, RETURN_DELAY, "2 us", 0, 254, 250, ALL),
    ROW("drive_mode", 10, 1, 0, EW, DIRECTION, "bits", 0, 13, 0, ALL),
    ROW("operating_mode", 11, 1, 0, EW, MODE, "", 0, 16, 3, ALL),
    ROW("secondary_id", 12, 1, 0, EW, NONE, "", 0, 255, 255, ALL),
    ROW("protocol_type", 13, 1, 0, EW, NONE, "", 1, 22, 2, ALL),
    ROW("homing_offset", 20, 4, 1, EW, OFFSET, "0.088 deg", -1044479, 1044479, 0, ALL),
    ROW("moving_threshold", 24, 4, 0, EW, NONE, "0.229 rpm", 0, 1023, 10, ALL),
    ROW("temperature_limit", 31, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 100, 70, SMALL),
    ROW("temperature_limit", 31, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 100, 72, LOAD),
    ROW("temperature_limit", 31, 1, 0, EW, TEMPERATURE_LIMIT, "deg C", 0, 100, 80, LARGE),
    ROW("max_voltage", 32, 2, 0, EW, MAX_VOLTAGE, "0.1 V", 31, 70, 70, LOW),
    ROW("max_voltage", 32, 2, 0, EW, MAX_VOLTAGE, "0.1 V", 55, 140, 140, XC330T),
    ROW("max_voltage", 32, 2, 0, EW, MAX_VOLTAGE, "0.1 V", 60, 140, 140, LOAD),
    ROW("max_voltage", 32, 2, 0, EW, MAX_VOLTAGE, "0.1 V", 95, 160, 160, LARGE),
    ROW("min_voltage", 34, 2, 0, EW, MIN_VOLTAGE, "0.1 V", 31, 70, 35, LOW),
    ROW("min_voltage", 34, 2, 0, EW, MIN_VOLTAGE, "0.1 V", 55, 140, 55, XC330T),
    ROW("min_voltage", 34, 2, 0, EW, MIN_VOLTAGE, "0.1 V", 60, 140, 60, LOAD),
    ROW("min_voltage", 34, 2, 0, EW, MIN_VOLTAGE, "0.1 V", 95, 160, 95, LARGE),
    ROW("pwm_limit", 36, 2, 0, EW, MAX_TORQUE, "0.113 %", 0, 885, 885, ALL),
    ROW("current_limit", 38, 2, 0, EW, CURRENT_LIMIT, "1 mA", 0, 1750, 1750, XL330),
    ROW("current_limit", 38, 2, 0, EW, CURRENT_LIMIT, "1 mA", 0, 2352, 2352, XC330M),
    ROW("current_limit", 38, 2, 0, EW, CURRENT_LIMIT, "1 mA", 0, 910, 910, XC330T),
    ROW("current_limit", 38, 2, 0, EW, CURRENT_LIMIT, "2.69 mA", 0, 1193, 1193, LARGE),
    ROW("velocity_limit", 44, 4, 0, EW, SPEED_LIMIT, "0.229 rpm", 0, 2047, 445, XL330),
    ROW("velocity_limit", 44, 4, 0, EW, SPEED_LIMIT, "0.229 rpm", 0, 2047, 350, XC330M),
    ROW("velocity_limit", 44, 4, 0, EW, SPEED_LIMIT, "0.229 rpm", 0, 2047, 320, XC330T),
    ROW("velocity_limit", 44, 4, 0, EW, SPEED_LIMIT, "0.229 rpm", 0, 1023, 265, LOAD),
    ROW("velocity_limit", 44, 4, 0, EW, SPEED_LIMIT, "0.229 rpm", 0, 1023, 200, LARGE),
    ROW("max_position", 48, 4, 0, EW, MAX_POSITION, "0.088 deg", 0, 4095, 4095, ALL),
    ROW("min_position", 52, 4, 0, EW, MIN_POSITION, "0.088 deg", 0, 4095, 0, ALL),
    ROW("startup", 60, 1, 0, EW, NONE, "bits", 0, 3, 0, ALL),
    ROW("pwm_slope", 62, 1, 0, EW, NONE, "1.977 mV/ms", 1, 255, 140, LOW),
    ROW("pwm_slope", 62, 1, 0, EW, NONE, "3.955 mV/ms", 1, 255, 255, XC330T),
    ROW("shutdown", 63, 1, 0, EW, SHUTDOWN, "bits", 0, 255, 53, XL330),
    ROW("shutdown", 63, 1, 0, EW, SHUTDOWN, "bits", 0, 255, 52, XC330 | LOAD | LARGE),
    ROW("torque", 64, 1, 0, W, TORQUE, "", 0, 1, 0, ALL),
    ROW("led", 65, 1, 0, W, NONE, "", 0, 1, 0, ALL),
    ROW("reply_level", 68, 1, 0, W, REPLY_LEVEL, "", 0, 2, 2, ALL),
    ROW("registered", 69, 1, 0, R, REGISTERED, "", 0, 1, 0, ALL),
    ROW("hardware_error", 70, 1, 0, R, ERROR, "bits", 0, 255, 0, ALL),
    ROW("velocity_i", 76, 2, 0, W, NONE, "", 0, 16383, 1600, LOW),
    ROW("velocity_i", 76, 2, 0, W, NONE, "", 0, 16383, 1200, XC330T),
    ROW("velocity_i", 76, 2, 0, W, NONE, "", 0, 16383, 1000, LOAD),
    ROW("velocity_i", 76, 2, 0, W, NONE, "", 0, 16383, 1920, LARGE),
    ROW("velocity_p", 78, 2, 0, W, NONE, "", 0, 16383, 180, XL330),
    ROW("velocity_p", 78, 2, 0, W, NONE, "", 0, 16383, 50, XC330M),
    ROW("velocity_p", 78, 2, 0, W, NONE, "", 0, 16383, 40, XC330T),
    ROW("velocity_p", 78, 2, 0, W, NONE, "", 0, 16383, 100, LOAD | LARGE),
    ROW("position_d", 80, 2, 0, W, NONE, "", 0, 16383, 0, XL330 | XC330T | LARGE),
    ROW("position_d", 80, 2, 0, W, NONE, "", 0, 16383, 500, XC330M),
    ROW("position_d", 80, 2, 0, W, NONE, "", 0, 16383, 4000, LOAD),
    ROW("position_i", 82, 2, 0, W, NONE, "", 0, 16383, 0, ALL),
    ROW("position_p", 84, 2, 0, W, NONE, "", 0, 16383, 400, XL330),
    ROW("position_p", 84, 2, 0, W, NONE, "", 0, 16383, 1100, XC330M),
    ROW("position_p", 84, 2, 0, W, NONE, "", 0, 16383, 900, XC330T),
    ROW("position_p", 84, 2, 0, W, NONE, "", 0, 16383, 640, LOAD),
    ROW("position_p", 84, 2, 0, W, NONE, "", 0, 16383, 800, LARGE),
    ROW("feedforward_2", 88, 2, 0, W, NONE, "", 0, 16383, 0, ALL),
    ROW("feedforward_1", 90, 2, 0, W, NONE, "", 0, 16383, 0, ALL),
    ROW("watchdog", 98, 1, 1, W, WATCHDOG, "20 ms", -1, 127, 0, ALL),
    ROW("goal_pwm", 100, 2, 1, W, GOAL_PWM, "0.113 %", -885, 885, 885, ALL),
    ROW("goal_current", 102, 2, 1, W, GOAL_CURRENT, "1 mA", -1750, 1750, 1750, XL330),
    ROW("goal_current", 102, 2, 1, W, GOAL_CURRENT, "1 mA", -2352, 2352, 2352, XC330M),
    ROW("goal_current", 102, 2, 1, W, GOAL_CURRENT, "1 mA", -910, 910, 910, XC330T),
    ROW("goal_current", 102, 2, 1, W, GOAL_CURRENT, "2.69 mA", -1193, 1193, 1193, LARGE),
    ROW("goal_velocity", 104, 4, 1, W, GOAL_SPEED, "0.229 rpm", -2047, 2047, 0, ALL),
    ROW("profile_acceleration", 108, 4, 0, W, ACCELERATION, "214.577 rev/min2 or ms", 0, 32767, 0,
        ALL),
    ROW("profile_velocity", 112, 4, 0, W, SPEED, "0.229 rpm or ms", 0, 32767, 0, ALL),
    ROW("goal_position", 116, 4, 1, W, GOAL, "0.088 deg", -1048575, 1048575, 0, ALL),
    ROW("tick", 120, 2, 0, R, NONE, "1 ms", 0, 32767, 0, ALL),
    ROW("moving", 122, 1, 0, R, MOVING, "", 0, 1, 0, ALL),
    ROW("moving_status", 123, 1, 0, R, NONE, "bits", 0, 255, 0, ALL),
    ROW("present_pwm", 124, 2, 1, R, NONE, "0.113 %", -885, 885, 0, ALL),
    ROW("present_current", 126, 2, 1, R, CURRENT, "1 mA", -32768, 32767, 0, SMALL),
    ROW("present_load", 126, 2, 1, R, LOAD, "0.1 %", -1000, 1000, 0, LOAD),
    ROW("present_current", 126, 2, 1, R, CURRENT, "2.69 mA", -32768, 32767, 0, LARGE),
    ROW("present_velocity", 128, 4, 1, R, PRESENT_SPEED, "0.229 rpm", -32767, 32767, 0, ALL),
    ROW("present_position", 132, 4, 1, R, POSITION, "0.088 deg", INT32_MIN, INT32_MAX, 0, ALL),
    ROW("velocity_trajectory", 136, 4, 1, R, NONE, "0.229 rpm", -32767, 32767, 0, ALL),
    ROW("position_trajectory", 140, 4, 1, R, NONE, "0.088 deg", INT32_MIN, INT32_MAX, 0, ALL),
    ROW("voltage", 144, 2, 0, R, VOLTAGE, "0.1 V", 0, 65535, 0, ALL),
    ROW("temperature", 146, 1, 0, R, TEMPERATURE, "deg C", 0, 255, 0, ALL),
    ROW("backup_ready", 147, 1, 0, R, NONE, "", 0, 1, 0, ALL),
};

#define MODEL(name, number, dps, mnm, ma, mv, group)                                               \
    {                                                                                              \
        name, number, 4096, 360, 2048, dps, mnm, ma, mv, group, 52, &grobo_dxl2_table              \
    }

static const grobo_servo_model models[] = {
    MODEL("XL330-M288", 1200, 618, 520, 1470, 5000, XL330),
    MODEL("XL330-M077", 1190, 2298, 215, 1470, 5000, XL330),
    MODEL("XC330-M181", 1230, 774, 600, 1800, 5000, XC330M),
    MODEL("XC330-M288", 1240, 486, 930, 1800, 5000, XC330M),
    MODEL("XC330-T181", 1210, 774, 760, 800, 12000, XC330T),
    MODEL("XC330-T288", 1220, 390, 920, 800, 12000, XC330T),
    MODEL("XL430-W250", 1060, 366, 1500, 1400, 12000, LOAD),
    MODEL("2XL430-W250", 1090, 366, 1500, 1400, 12000, LOAD),
    MODEL("XC430-W150", 1070, 636, 1600, 1400, 12000, LOAD),
    MODEL("XC430-W240", 1080, 420, 1900, 1400, 12000, LOAD),
    MODEL("XM430-W350", 1020, 276, 4100, 2300, 12000, LARGE),
    MODEL("XM430-W210", 1030, 462, 3000, 2300, 12000, LARGE),
};

#undef MODEL

static const grobo_servo_rate rates[] = {
    {0, ALL, 9600},    {1, ALL, 57600},   {2, ALL, 115200},  {3, ALL, 1000000},
    {4, ALL, 2000000}, {5, ALL, 3000000}, {6, ALL, 4000000}, {7, LOAD | LARGE, 4500000},
};

const grobo_servo_table grobo_dxl2_table = {
    .name = "DYNAMIXEL X",
    LIST(registers, register_count, rows),
    LIST(models, model_count, models),
    LIST(rates, rate_count, rates),
    .keeps = GROBO_KEEPS_LIMP,
};
