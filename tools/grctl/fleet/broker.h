/* SPDX-License-Identifier: MIT */
/* Which broker, by the options that every command of a fleet has. */
#ifndef GRCTL_FLEET_BROKER_H
#define GRCTL_FLEET_BROKER_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/fleet/mqtt.h"

enum { BROKER_URL, BROKER_CA, BROKER_CERT, BROKER_KEY, BROKER_OPTIONS };

#define BROKER_OPTION_ROWS                                                                         \
    [BROKER_URL] = OPTION_TEXT("broker", 0, "URL",                                                 \
                               "mqtt://[USER@]HOST[:PORT], mqtts:// with TLS (mqtt://localhost)"), \
    [BROKER_CA] = OPTION_TEXT("ca", 0, "FILE", "CA certificates to verify the broker"),            \
    [BROKER_CERT] = OPTION_TEXT("cert", 0, "FILE", "the certificate of this machine"),             \
    [BROKER_KEY] = OPTION_TEXT("key", 0, "FILE", "its key")

typedef struct broker {
    mqtt_config config; /* host, port, user, TLS; its texts are in here */
    char host[256], user[64];
} broker;

/* Fills in what the options say. 0, or the exit status with the reason said. */
int broker_read(broker *b, app *a);

#endif
