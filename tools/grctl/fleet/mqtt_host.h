/* SPDX-License-Identifier: MIT */
/* The process that has the connection, see mqtt.h. */
#ifndef GRCTL_MQTT_HOST_H
#define GRCTL_MQTT_HOST_H

enum { MQTT_BEAT_MS = 500 };

/* What this program is called with for it. */
#define MQTT_HOST_WORD "broker"

/* All of the process; its exit status. */
int mqtt_host_main(void);

#endif
