/* SPDX-License-Identifier: MIT */
/* A simulated chain of servos with register tables, and requests by role of a register. */
#ifndef GROBO_TEST_CHAIN_KIT_H
#define GROBO_TEST_CHAIN_KIT_H

#include <grobo/core/dxl2.h>

#include "tests/support/simkit.h"

enum { CHAIN_MAX = 20 };

typedef struct chain_kit {
    simkit kit;
    grobo_model model;
    grobo_joint joints[CHAIN_MAX];
    const grobo_servo_model *servos[CHAIN_MAX];
    char names[CHAIN_MAX][8];
} chain_kit;

/* Powers up n servos of a model with ids 1..n at 1 Mbps, where their position is the middle. config
 * NULL: defaults; what of it makes the chain is filled in. */
void chain_start(chain_kit *chain, const grobo_servo_model *servo, int n,
                 const grobo_sim_config *config);
/* Value of a register behind the robot's back, by its role. */
int32_t chain_register(chain_kit *chain, int servo, grobo_register_role role);
/* Writes it as its family's WRITE would, and returns the error of the status, -1 for silence. */
int chain_write(chain_kit *chain, int id, grobo_register_role role, int32_t value);
/* Sends an instruction of the family of the chain: address and length count where it has them. */
void chain_send_packet(chain_kit *chain, const grobo_dxl2_packet *packet);
#define chain_send(chain, to, code, first, each, bytes, n)                                         \
    chain_send_packet((chain), &(grobo_dxl2_packet){.id = (to),                                    \
                                                    .instruction = (code),                         \
                                                    .address = (first),                            \
                                                    .length = (each),                              \
                                                    .data = (bytes),                               \
                                                    .data_bytes = (n)})

#endif
