/* SPDX-License-Identifier: MIT */
/*
 * The connection itself, in this very process: a malformed packet of a broker may end it
 * (libmosquitto 2.0.11 asserts). mqtt.h has it in a process of its own; its functions are those of
 * mqtt.h.
 */
#ifndef GRCTL_MQTT_DIRECT_H
#define GRCTL_MQTT_DIRECT_H

#include "tools/grctl/fleet/mqtt.h"

typedef struct direct direct;

bool direct_possible(void);
direct *direct_new(const mqtt_config *config, const char **why);
void direct_start(direct *d);
bool direct_is_up(const direct *d);
int direct_publish(direct *d, const mqtt_message *message, int qos, int expiry_s);
bool direct_subscribe(direct *d, const char *filter, int qos, bool retained);
void direct_free(direct *d);

/* From one try to the next: it doubles. */
enum { PAUSE_FIRST_MS = 100, PAUSE_LONGEST_MS = 5000 };
/* The one to make now, up to half longer by chance: 4000 agents do not come back together. */
int pause_next_ms(int *pause_ms);

#endif
