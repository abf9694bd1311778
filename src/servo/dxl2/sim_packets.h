/* SPDX-License-Identifier: MIT */
/* What packets of Protocol 2.0 (sim_packets.c) ask of the servos that carry them out (sim.c). */
#ifndef GROBO_SERVO_DXL2_SIM_PACKETS_H
#define GROBO_SERVO_DXL2_SIM_PACKETS_H

#include <grobo/core/dxl2.h>
#include <grobo/core/sim_static.h>

/* Of grobo_sim_family. */
bool grobo_i_dxl2_sim_factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps);
void grobo_i_dxl2_sim_restart(grobo_sim *sim, int index);
void grobo_i_dxl2_sim_cut(grobo_sim *sim, int index, bool hot);
int32_t grobo_i_dxl2_sim_goal_mdeg(const grobo_sim *sim, const grobo_sim_servo *servo);
int32_t grobo_i_dxl2_sim_bps(const grobo_sim *sim, int index);
int64_t grobo_i_dxl2_sim_next_us(const grobo_sim *sim, int index);
void grobo_i_dxl2_sim_act(grobo_sim *sim, int index);
int grobo_i_dxl2_sim_store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n);

/* Whether all of a write can be done, its indirect part too: GROBO_DXL2_DONE, or why not. */
uint8_t grobo_i_dxl2_sim_judge(const grobo_sim_servo *servo, int address, const uint8_t *bytes,
                               size_t n);
/* Judges a write and does it. */
uint8_t grobo_i_dxl2_sim_write(grobo_sim *sim, int servo, int address, const uint8_t *bytes,
                               size_t n);
/* Fills in the present values. */
void grobo_i_dxl2_sim_refresh(grobo_sim *sim, int servo);
/* Its drive mode turns it the other way round. */
bool grobo_i_dxl2_sim_reverses(const grobo_sim_servo *servo);

/* First byte of a control table backup. */
enum { GROBO_I_DXL2_STORE = 1, GROBO_I_DXL2_RESTORE = 2 };

/* Control table backup (sim_backup.c): whether it is done; stores or restores the EEPROM; what a
 * restart does with it, as the register startup says. */
uint8_t grobo_i_dxl2_sim_judge_backup(const grobo_sim_servo *servo,
                                      const grobo_dxl2_packet *packet);
void grobo_i_dxl2_sim_store_backup(grobo_sim_servo *servo);
void grobo_i_dxl2_sim_restore_backup(grobo_sim_servo *servo);
void grobo_i_dxl2_sim_start_up(grobo_sim_servo *servo);

#endif
