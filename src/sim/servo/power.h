/* SPDX-License-Identifier: MIT */
/* Flash, reboot, supply, and what a servo does on its own as time goes by. */
#ifndef GROBO_SIM_POWER_H
#define GROBO_SIM_POWER_H

#include <grobo/core/sim_static.h>

/* Out of and into power, with another flash. */
void grobo_i_sim_exchange_flash(grobo_sim *sim, int servo, const uint8_t *flash);
void grobo_i_sim_boot(grobo_sim *sim, int servo, int64_t deaf_us);
void grobo_i_sim_reboot(grobo_sim *sim, int servo);
void grobo_i_sim_save(grobo_sim *sim, int servo, bool reboot_after);
/* On or off, by the supply and its cable. */
void grobo_i_sim_feed(grobo_sim *sim, int servo);
/* All servos lose power for a moment. */
void grobo_i_sim_brown_out(grobo_sim *sim);
/* Lets what the servo does on its own happen up to the latest time. */
void grobo_i_sim_settle(grobo_sim *sim, int servo);

#endif
