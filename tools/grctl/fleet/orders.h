/* SPDX-License-Identifier: MIT */
/* Orders to an agent: from the message to the answer. */
#ifndef GRCTL_FLEET_ORDERS_H
#define GRCTL_FLEET_ORDERS_H

#include "tools/grctl/fleet/agent.h"

/* Of handlers: nothing here waits. */
void orders_take(agent *g, const char *verb, const mqtt_message *message);
void orders_take_time(agent *g, const mqtt_message *message);
void orders_on_team(void *ctx, const grobo_team_event_info *event);
/* Those whose sender's clock stays unknown are refused. */
void orders_age(agent *g, int64_t now_us);
/* Those that wait; the broker is away. */
void orders_forget(agent *g);

/* Does those whose turn it is; may wait for robots. */
void orders_work(agent *g);
void orders_free(agent *g);

#endif
