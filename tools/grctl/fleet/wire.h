/* SPDX-License-Identifier: MIT */
/* Objects over a connection: what agents and those who ask them both do with it. */
#ifndef GRCTL_FLEET_WIRE_H
#define GRCTL_FLEET_WIRE_H

#include "tools/grctl/fleet/message.h"
#include "tools/grctl/fleet/mqtt.h"

typedef enum wire_how {
    WIRE_ONCE = 0, /* QoS 0 */
    WIRE_SURE = 1, /* QoS 1 */
    WIRE_KEPT = 2  /* retained by the broker */
} wire_how;

/* Now, by the wall clock: for people and logs alone. */
int64_t wire_wall_ms(void);

/* "grobo/v1/A/B/C" from now on and, where asked for, what is retained; NULL parts end it. */
void wire_subscribe(mqtt *m, const char *a, const char *b, const char *c, bool retained);

/*
 * Publishes an object with the topic and properties of `with`. Takes the reference of the object;
 * NULL: nothing is sent. As mqtt_publish().
 */
int wire_publish(mqtt *m, const mqtt_message *with, json_t *object, int qos, int expiry_s);
/* The same at "grobo/v1/A/B/C"; how: flags of wire_how. */
int wire_tell(mqtt *m, const char *a, const char *b, const char *c, json_t *object, int how);

#endif
