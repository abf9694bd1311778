/* SPDX-License-Identifier: MIT */
#include "src/sim/registers.h"

int32_t grobo_i_sim_value(const grobo_sim_servo *servo, uint8_t address)
{
    return grobo_rs30x_register_get(grobo_rs30x_register_at(address), &servo->reg[address]);
}

void grobo_i_sim_hold(grobo_sim_servo *servo, uint8_t address, int64_t value)
{
    const grobo_rs30x_register *reg = grobo_rs30x_register_at(address);
    int64_t held = value < reg->min ? reg->min : value > reg->max ? reg->max : value;
    (void)grobo_rs30x_register_put(reg, (int32_t)held, &servo->reg[address]);
}
