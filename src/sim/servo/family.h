/* SPDX-License-Identifier: MIT */
/*
 * What the simulator asks a family of servos. The core knows wires, shafts, heat and power; a
 * family knows packets and registers. After each change of a register the family brings the
 * servo's plant up to date, and the core reads nothing but that.
 */
#ifndef GROBO_SIM_FAMILY_H
#define GROBO_SIM_FAMILY_H

#include <grobo/core/sim_static.h>

struct grobo_sim_family {
    /* Rate of the line where nothing else is asked for; 0: 1 Mbps. */
    uint32_t usual_bps;
    bool parity;                        /* of the line where the first servo is of this family */
    const grobo_servo_table *tables[4]; /* of its models, NULL behind the last */
    int32_t turns_mdeg; /* as far as it can tell, without a stop to either side; 0: a wheel's way */
    /* Size of the command packet that n > 0 bytes start with, whatever its sum; 0: more is needed;
     * negative: none. good: a packet with a wrong sum is none either. */
    int (*measure)(const uint8_t *bytes, size_t n, bool good);
    /* The servos of the family carry out a packet that they heard; raw holds its bytes. */
    void (*packet)(const grobo_sim_family *self, grobo_sim *sim, const grobo_sim_event *raw);
    /* Registers and flash as from the factory, with an id and a rate that were set and saved since.
     * False: it has no such rate. */
    bool (*factory)(grobo_sim *sim, int servo, uint8_t id, uint32_t baud_bps);
    /* Registers after a restart, and the rate of the line. */
    void (*boot)(grobo_sim *sim, int servo);
    /* A flash write is over; or power was lost within it. NULL: it has none. */
    void (*saved)(grobo_sim *sim, int servo, bool whole);
    /* The torque goes by itself: registers say so. hot: for the temperature. */
    void (*cut)(grobo_sim *sim, int servo, bool hot);
    /* The shaft's angle at the goal of its registers. NULL: the plant always has it. */
    int32_t (*goal_mdeg)(const grobo_sim *sim, const grobo_sim_servo *servo);
    /* The torque came on: true to drive to the goal, as where NULL; false: here became the goal. */
    bool (*starts)(grobo_sim *sim, int servo, int32_t here_mdeg);
    /* Fills in the present values. */
    void (*refresh)(grobo_sim *sim, int servo);
    /* The rate at which a servo listens and speaks; negative: its register has no such code. */
    int32_t (*bps)(const grobo_sim *sim, int servo);
    /* When a servo does something by itself that is no heat (GROBO_NEVER_US: nothing), and doing
     * it. NULL: never. */
    int64_t (*next_us)(const grobo_sim *sim, int servo);
    void (*act)(grobo_sim *sim, int servo);
    /* Bytes have the form of a packet and a wrong sum; NULL: nothing follows. */
    void (*broken)(const grobo_sim_family *self, grobo_sim *sim, const uint8_t *bytes, size_t n);
    /* For inspection, as the factory would, with what follows from it: a register gets a value
     * (GROBO_ERR_ARG where none begins at the address), NULL: grobo_i_dxl_set(); and for that, its
     * bytes. */
    int (*set)(grobo_sim *sim, int servo, int address, int32_t value);
    int (*store)(grobo_sim *sim, int servo, int address, const uint8_t *bytes, size_t n);
    /* What the packets' code of several series knows them by (src/servo/dxl1/sim_packets.h). */
    const struct grobo_i_dxl1_series *(*series)(const grobo_sim_servo *servo);
    /* Whether it may have these bytes as its flash; NULL: it has none. */
    bool (*flash_fits)(const uint8_t *flash);
};

/* An RS30x by its number; one that is not known is the first of the table. */
const grobo_servo_model *grobo_i_sim_rs30x_model(uint16_t number);

#endif
