/* SPDX-License-Identifier: MIT */
/* Flash, reboot, supply, and what a servo does on its own as time goes by. */
#ifndef GROBO_SIM_POWER_H
#define GROBO_SIM_POWER_H

#include <grobo/sim.h>

/* From the factory, with an id and a rate that were set and saved since. */
void grobo_i_sim_factory(grobo_sim_servo *servo, uint16_t model, uint8_t id, uint32_t baud_bps);
/* True if a servo may have these bytes as No.4-29. */
bool grobo_i_sim_flash_fits(const uint8_t *flash);
/* Out of and into power, with another flash. */
void grobo_i_sim_exchange_flash(grobo_sim *sim, int servo, const uint8_t *flash);
void grobo_i_sim_boot(grobo_sim *sim, int servo, int64_t deaf_us);
void grobo_i_sim_reboot(grobo_sim *sim, int servo);
void grobo_i_sim_save(grobo_sim *sim, int servo, bool reboot_after);
/* Factory reset: No.4-29 here and, after the time it takes, in flash. */
void grobo_i_sim_reset(grobo_sim *sim, int servo);
/* On or off, by the supply and its cable. */
void grobo_i_sim_feed(grobo_sim *sim, int servo);
/* All servos lose power for a moment. */
void grobo_i_sim_brown_out(grobo_sim *sim);
/* Lets what the servo does on its own happen up to the latest time. */
void grobo_i_sim_settle(grobo_sim *sim, int servo);

#endif
