/* SPDX-License-Identifier: MIT */
/*
 * Simulated servos whose registers are written by packets of Protocol 1.0: AX, MX and Feetech's.
 * What packets do is one code (sim_packets.c); a series is a table of what its servos do otherwise.
 */
#ifndef GROBO_SERVO_DXL1_SIM_PACKETS_H
#define GROBO_SERVO_DXL1_SIM_PACKETS_H

#include <grobo/core/dxl1.h>

#include "src/sim/servo/family.h"

/* What a stall leads to, and after how long; error 0: to nothing. */
typedef struct grobo_i_dxl1_stall {
    unsigned error;
    int64_t after_us;
} grobo_i_dxl1_stall;

/* A series of servos: grobo_sim_family.series() of a family returns one. */
typedef struct grobo_i_dxl1_series {
    bool judges;     /* values outside their range are refused, and errors are told; else a servo
                        takes any value, and is silent about what it cannot do */
    bool locks;      /* EEPROM is kept only while the register lock is open */
    bool sync_read;  /* answers a sync read */
    bool bulk_read;  /* answers a bulk read */
    bool ping_turns; /* a ping of all is answered by one after the other */
    bool wheel_mode; /* MODE 1 makes a wheel of it; else both limits at 0 do */
    double count_ma; /* a count of the present current; 0: it has no such register */
    /* What a count of speed, and of acceleration, is worth. */
    double (*speed_mdeg_s)(const grobo_sim_servo *servo);
    double (*accel_mdeg_s2)(const grobo_sim_servo *servo);
    /* Positions go on behind a turn, or the servo has no way around. */
    bool (*counts_turns)(const grobo_sim_servo *servo);
    /* What the offset adds to a position. */
    int32_t (*offset)(const grobo_sim_servo *servo);
    /* Goals are trajectories from here on; NULL: never. */
    bool (*steps)(const grobo_sim_servo *servo);
    /* Whether it turns on and on, and the part of its top speed at which it then does. */
    bool (*is_wheel)(const grobo_sim_servo *servo, double *speed_mdeg_s);
    /* The size of the goal's speed; tells the plant what else it should know of the move. */
    int32_t (*move_speed)(grobo_sim_servo *servo);
    /* What the registers leave of the torque, of torque_full. */
    int32_t (*torque_limit)(const grobo_sim_servo *servo);
    int32_t torque_full;
    /* The rate of a code that the model does not list; NULL: none. */
    int32_t (*bps)(int32_t code);
    /* Present values beside those that all have; NULL: none. */
    void (*refresh)(grobo_sim *sim, int index);
    /* An error that the register shutdown names has come up. */
    void (*shut_down)(grobo_sim_servo *servo, unsigned error);
    grobo_i_dxl1_stall (*stall)(const grobo_sim_servo *servo);
    /* Bits of the status that a write to a register clears. */
    uint8_t (*clears)(const grobo_sim_servo *servo, const grobo_servo_register *reg);
    /* What else a value does that was written; NULL: nothing. */
    void (*wrote)(grobo_sim *sim, int index, const grobo_servo_register *reg, int32_t value);
    /* The other instructions of the series: false where this is none; NULL: there are none. */
    bool (*extra)(grobo_sim *sim, int index, const grobo_dxl1_packet *packet);
} grobo_i_dxl1_series;

bool grobo_i_dxl1_sim_reverses(const grobo_sim_servo *servo);
bool grobo_i_dxl1_sim_limits_are(const grobo_sim_servo *servo, int32_t both);
/* Value of the register of this name, which the model has. */
int32_t grobo_i_dxl1_sim_named(const grobo_sim_servo *servo, const char *name);
/* Sign and magnitude with the sign in bit 10. */
int32_t grobo_i_dxl1_sim_bit10(int32_t raw);
/* A count of its speed, by the unit of that register. */
double grobo_i_dxl1_sim_speed_mdeg_s(const grobo_sim_servo *servo);
/* Registers changed: the plant is brought up to date. */
void grobo_i_dxl1_sim_follow(grobo_sim *sim, int index);

/* Functions of a grobo_sim_family. */
void grobo_i_dxl1_sim_packet(const grobo_sim_family *family, grobo_sim *sim,
                             const grobo_sim_event *raw);
void grobo_i_dxl1_sim_broken(const grobo_sim_family *family, grobo_sim *sim, const uint8_t *bytes,
                             size_t n);
int grobo_i_dxl1_sim_measure(const uint8_t *bytes, size_t n, bool good);
bool grobo_i_dxl1_sim_factory(grobo_sim *sim, int index, uint8_t id, uint32_t baud_bps);
void grobo_i_dxl1_sim_restart(grobo_sim *sim, int index);
void grobo_i_dxl1_sim_cut(grobo_sim *sim, int index, bool hot);
int32_t grobo_i_dxl1_sim_goal_mdeg(const grobo_sim *sim, const grobo_sim_servo *servo);
void grobo_i_dxl1_sim_refresh(grobo_sim *sim, int index);
int32_t grobo_i_dxl1_sim_bps(const grobo_sim *sim, int index);
int64_t grobo_i_dxl1_sim_next_us(const grobo_sim *sim, int index);
void grobo_i_dxl1_sim_act(grobo_sim *sim, int index);
int grobo_i_dxl1_sim_store(grobo_sim *sim, int index, int address, const uint8_t *bytes, size_t n);

/* All of a grobo_sim_family but its tables and its series. */
#define GROBO_I_DXL1_SIM                                                                           \
    .measure = grobo_i_dxl1_sim_measure, .packet = grobo_i_dxl1_sim_packet,                        \
    .factory = grobo_i_dxl1_sim_factory, .boot = grobo_i_dxl1_sim_restart,                         \
    .cut = grobo_i_dxl1_sim_cut, .goal_mdeg = grobo_i_dxl1_sim_goal_mdeg,                          \
    .refresh = grobo_i_dxl1_sim_refresh, .bps = grobo_i_dxl1_sim_bps,                              \
    .next_us = grobo_i_dxl1_sim_next_us, .act = grobo_i_dxl1_sim_act,                              \
    .broken = grobo_i_dxl1_sim_broken, .store = grobo_i_dxl1_sim_store

#endif
