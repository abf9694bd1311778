/* SPDX-License-Identifier: MIT */
#include "src/base/bytes.h"
#include "src/sim/registers.h"

const grobo_servo_model *grobo_i_sim_rs30x_model(const grobo_sim_servo *servo)
{
    const grobo_servo_model *model = grobo_servo_model_numbered(
        &grobo_rs30x_table, grobo_i_get_u16(&servo->reg[GROBO_RS30X_MODEL]));
    return model != NULL ? model : &grobo_rs30x_table.models[0];
}

int32_t grobo_i_sim_value(const grobo_sim_servo *servo, uint8_t address)
{
    const grobo_servo_model *model = grobo_i_sim_rs30x_model(servo);
    return grobo_servo_register_get(model, grobo_servo_register_at(model, address),
                                    &servo->reg[address]);
}

void grobo_i_sim_hold(grobo_sim_servo *servo, uint8_t address, int64_t value)
{
    const grobo_servo_model *model = grobo_i_sim_rs30x_model(servo);
    const grobo_servo_register *reg = grobo_servo_register_at(model, address);
    int64_t held = value < reg->min ? reg->min : value > reg->max ? reg->max : value;
    (void)grobo_servo_register_put(model, reg, (int32_t)held, &servo->reg[address]);
}
