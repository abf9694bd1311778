/* SPDX-License-Identifier: MIT */
/*
 * Indirect registers of a simulated servo: byte k of its indirect data is the byte whose address
 * indirect address k holds. A read or a write of a block is cut into pieces of one kind.
 */
#ifndef GROBO_SIM_INDIRECT_H
#define GROBO_SIM_INDIRECT_H

#include <grobo/core/sim_static.h>

typedef enum grobo_i_indirect_kind {
    GROBO_I_INDIRECT_REGISTERS, /* of the table, or none at all */
    GROBO_I_INDIRECT_ADDRESS,   /* bytes of indirect addresses */
    GROBO_I_INDIRECT_STORE      /* indirect data whose address is still its own */
} grobo_i_indirect_kind;

typedef struct grobo_i_indirect_piece {
    grobo_i_indirect_kind kind;
    int address; /* of REGISTERS that of the table; else of the first byte in the block */
    size_t n;    /* bytes of the block */
} grobo_i_indirect_piece;

/* Indirect addresses as from the factory, and both as after power-on. */
void grobo_i_indirect_factory(grobo_sim_servo *servo);
void grobo_i_indirect_restart(grobo_sim_servo *servo);

/* Whether its indirect addresses last, and are locked by torque. */
bool grobo_i_indirect_kept(const grobo_sim_servo *servo);

/* The first piece of n > 0 bytes at an address. */
grobo_i_indirect_piece grobo_i_indirect_piece_at(const grobo_sim_servo *servo, int address,
                                                 size_t n);

/* Whether a piece of ADDRESS is whole addresses, each within the RAM of the model. */
bool grobo_i_indirect_fits(const grobo_sim_servo *servo, const grobo_i_indirect_piece *piece,
                           const uint8_t *bytes);

/* Writes a piece of ADDRESS or STORE. */
void grobo_i_indirect_write(grobo_sim_servo *servo, const grobo_i_indirect_piece *piece,
                            const uint8_t *bytes);

/* Whether each of these bytes is a register, one beside registers, or indirect. */
bool grobo_i_indirect_readable(const grobo_sim_servo *servo, int address, int length);

/* Copies bytes that are readable. */
void grobo_i_indirect_read(const grobo_sim_servo *servo, int address, int length, uint8_t *to);

#endif
