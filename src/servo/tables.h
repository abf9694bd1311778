/* SPDX-License-Identifier: MIT */
/* The tables of the families, for const tables that point to them; the public functions of their
 * names return them. */
#ifndef GROBO_CORE_SERVO_TABLES_H
#define GROBO_CORE_SERVO_TABLES_H

#include <grobo/core/protocol.h>
#include <grobo/core/registers.h>

extern const grobo_protocol grobo_i_board_protocol;
extern const grobo_protocol grobo_i_dxl1_protocol;
extern const grobo_protocol grobo_i_dxl2_protocol;
extern const grobo_protocol grobo_i_feetech_protocol;
extern const grobo_protocol grobo_i_feetech_delayed_protocol;
extern const grobo_protocol grobo_i_ics_protocol;
extern const grobo_protocol grobo_i_lx16a_protocol;
extern const grobo_protocol grobo_i_rs30x_protocol;
extern const grobo_servo_table grobo_i_dxl1_table;
extern const grobo_servo_table grobo_i_dxl2_table;
extern const grobo_servo_table grobo_i_ics_table;
extern const grobo_servo_table grobo_i_lx16a_table;
extern const grobo_servo_table grobo_i_rs30x_table;
extern const grobo_servo_table grobo_i_scs_table;
extern const grobo_servo_table grobo_i_sts_table;

#endif
