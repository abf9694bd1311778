/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/ics.h>
#include <grobo/robot_file.h>

#include "tests/support/chain_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

void chain_start(chain_kit *chain, const grobo_servo_model *servo, int n,
                 const grobo_sim_config *config)
{
    grobo_sim_config with = config != NULL ? *config : (grobo_sim_config){GROBO_SIM_CONFIG_INIT};
    assert_true(n <= CHAIN_MAX);
    assert_non_null(servo);
    memset(chain, 0, sizeof *chain);
    for (int i = 0; i < n; i++) {
        (void)snprintf(chain->names[i], sizeof chain->names[i], "S%u", (uint8_t)(i + 1));
        chain->servos[i] = servo;
        chain->joints[i] = (grobo_joint){.name = chain->names[i],
                                         .min_rad = -3,
                                         .max_rad = 3,
                                         .max_speed_rad_s = 5,
                                         .motor = (uint8_t)(i + 1),
                                         .mirror = (uint8_t)i,
                                         .mirror_sign = 1};
    }
    chain->model = (grobo_model)GROBO_TABLE(
        grobo_model, .name = "chain", GROBO_MODEL_JOINTS(chain->joints), .n_joints = (uint8_t)n);
    with.model = &chain->model;
    with.wiring = GROBO_WIRING_BUS;
    with.servos = chain->servos;
    with.families = grobo_i_sim_families;
    simkit_start(&chain->kit, &with);
}

int32_t chain_register(chain_kit *chain, int servo, grobo_register_role role)
{
    const grobo_servo_register *reg = grobo_servo_register_of(chain->servos[servo], role);
    assert_non_null(reg);
    return simkit_register(&chain->kit, servo, reg->address);
}

static void send(chain_kit *chain, const uint8_t *bytes, int n)
{
    char hex[2 * 300 + 1];
    assert_true(n > 0 && n <= 300);
    for (int i = 0; i < n; i++) {
        (void)snprintf(hex + 2 * i, sizeof hex - 2 * (size_t)i, "%02X", bytes[i]);
    }
    simkit_ask(&chain->kit, hex, 50000);
}

void chain_send_packet(chain_kit *chain, const grobo_dxl2_packet *packet)
{
    uint8_t bytes[300];
    const grobo_dxl1_packet other = {.id = packet->id,
                                     .instruction = packet->instruction,
                                     .address = (uint8_t)packet->address,
                                     .length = (uint8_t)packet->length,
                                     .data = packet->data,
                                     .data_bytes = packet->data_bytes};
    send(chain, bytes,
         chain->servos[0]->table == &grobo_i_dxl2_table
             ? grobo_dxl2_build(packet, bytes, sizeof bytes)
             : grobo_dxl1_build(&other, bytes, sizeof bytes));
}

int chain_write(chain_kit *chain, int id, grobo_register_role role, int32_t value)
{
    const grobo_servo_register *reg = grobo_servo_register_of(chain->servos[0], role);
    uint8_t data[4];
    assert_non_null(reg);
    int n = grobo_servo_register_put(chain->servos[0], reg, value, data);
    assert_true(n > 0);
    chain_send(chain, (uint8_t)id, GROBO_DXL1_WRITE, reg->address, 0, data, (size_t)n);
    if (chain->kit.n_got == 0) {
        return -1;
    }
    return chain->kit.got[chain->servos[0]->table == &grobo_i_dxl2_table ? 8 : 4];
}
