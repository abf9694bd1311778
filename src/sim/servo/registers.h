/* SPDX-License-Identifier: MIT */
/* What servos with a register table have in common, whatever their frame. */
#ifndef GROBO_SIM_SERVO_REGISTERS_H
#define GROBO_SIM_SERVO_REGISTERS_H

#include <grobo/core/sim_static.h>

/* Value of the register of a role; 0 where the model has none. */
int32_t grobo_i_dxl_get(const grobo_sim_servo *servo, grobo_register_role role);
/* Sets it, to the end of its range where the value is beyond; nothing where there is none. */
void grobo_i_dxl_put(grobo_sim_servo *servo, grobo_register_role role, int64_t value);
void grobo_i_dxl_hold(grobo_sim_servo *servo, const grobo_servo_register *reg, int64_t value);
/* The register of this name, which the model has. */
const grobo_servo_register *grobo_i_dxl_row(const grobo_sim_servo *servo, const char *name);

/* Every register as from the factory. */
void grobo_i_dxl_factory(grobo_sim_servo *servo);
/* The same with an id and the code of a rate, and with the range of a calibrated joint where servos
 * are mounted; kept. */
void grobo_i_dxl_sold(grobo_sim *sim, int servo, uint8_t id, int baud_code);
/* Registers in RAM as after a restart, those of EEPROM from where they are kept. */
void grobo_i_dxl_boot(grobo_sim *sim, int servo);
/* What the registers say of the plant, beside what a series has of its own: speeds and mode. */
void grobo_i_dxl_follow(grobo_sim *sim, int servo);
/* Present values that every series has. current_ma: what a count of the current is worth. */
void grobo_i_dxl_refresh(grobo_sim *sim, int servo, double speed_mdeg_s, double count_ma);

/* Copies bytes into the registers; those that survive power-off to EEPROM too, if it is open. */
void grobo_i_dxl_store(grobo_sim_servo *servo, int address, const uint8_t *bytes, size_t n,
                       bool open);
/* The value of a register in bytes that are to be written at an address. */
int32_t grobo_i_dxl_value_in(const grobo_sim_servo *servo, const grobo_servo_register *reg,
                             int address, const uint8_t *bytes);
/* Where the registers of the model end. */
int grobo_i_dxl_end(const grobo_sim_servo *servo);

/* Counts of the shaft in the servo's direction, turn after turn. */
int32_t grobo_i_dxl_ticks(const grobo_sim_servo *servo, bool reverse, int32_t angle_mdeg);
/* One count is so many 0.001 degree. */
double grobo_i_dxl_tick_mdeg(const grobo_sim_servo *servo);
/* Ticks in one turn; 0 for a model that does not turn around. */
int32_t grobo_i_dxl_turn(const grobo_sim_servo *servo);
/* x within 0..turn-1. */
int32_t grobo_i_dxl_wrap(int32_t x, int32_t turn);

/* How hard the motor works, signed: 1 is its most. */
double grobo_i_dxl_effort(const grobo_sim *sim, int servo);
/* The motor's current, with the sign of its torque. */
double grobo_i_dxl_current_ma(const grobo_sim *sim, int servo);

/* For inspection. */
int grobo_i_dxl_look(const grobo_sim_servo *servo, int address, int32_t *value);
int grobo_i_dxl_set(grobo_sim *sim, int servo, int address, int32_t value);

/* Reports the value that was written to a register. */
void grobo_i_dxl_tell(grobo_sim *sim, int servo, const grobo_servo_register *reg, int32_t value);
/* The next servo behind `before` (-1: the first) that has this id (GROBO_I_DXL_ALL: any) and hears
 * a packet; negative: no more. Several may have one id, each is asked once. */
enum { GROBO_I_DXL_ALL = -1 };
int grobo_i_dxl_hearer(grobo_sim *sim, const grobo_sim_family *family, int id, int before,
                       const grobo_sim_event *raw);
/* Has a servo as it is sold, at this id and rate. False: none has them. */
bool grobo_i_dxl_sell(grobo_sim *sim, int servo, uint8_t id, uint8_t id_max, uint32_t baud_bps);

/* What the battery's voltage is for a servo: each has a supply of its own kind. */
int64_t grobo_i_dxl_own_mv(const grobo_sim *sim, const grobo_sim_servo *servo, int64_t battery_mv);
/* Whether its supply is within the registers that bound it, whose counts are so many mV. */
bool grobo_i_dxl_fed(const grobo_sim *sim, const grobo_sim_servo *servo, int count_mv);
/* Turns before now are forgotten. */
void grobo_i_dxl_one_turn(const grobo_sim *sim, grobo_sim_servo *servo, bool reverse);
/* A goal that is beyond the limits becomes that limit. */
int32_t grobo_i_dxl_within(const grobo_sim_servo *servo, int32_t goal);

/*
 * Servos of a list answer one after another: each listens to those before it and speaks after its
 * own delay. A servo that is silent has its time all the same.
 */
typedef struct grobo_i_dxl_round {
    int64_t at_ns; /* when the one before is over, from now */
} grobo_i_dxl_round;
void grobo_i_dxl_answer(grobo_sim *sim, int servo, grobo_i_dxl_round *round, uint8_t *bytes,
                        size_t n);
void grobo_i_dxl_silence(const grobo_sim *sim, grobo_i_dxl_round *round, size_t n);
/* One of those with an id speaks when the one before is over, as the others do: its own round. The
 * next id waits for the last of them. */
void grobo_i_dxl_beside(grobo_i_dxl_round *round, const grobo_i_dxl_round *own);

#endif
