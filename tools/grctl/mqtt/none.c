/* SPDX-License-Identifier: MIT */
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/mqtt/mqtt.h"

bool mqtt_possible(void)
{
    return false;
}

mqtt *mqtt_new(const mqtt_config *config, const char **why)
{
    (void)config;
    *why = _("this grctl was built without libmosquitto");
    return NULL;
}

void mqtt_start(mqtt *m)
{
    (void)m;
}

bool mqtt_is_up(const mqtt *m)
{
    (void)m;
    return false;
}

int mqtt_publish(mqtt *m, const mqtt_message *message, int qos, int expiry_s)
{
    (void)m;
    (void)message;
    (void)qos;
    (void)expiry_s;
    return 0;
}

bool mqtt_subscribe(mqtt *m, const char *filter, int qos, bool retained)
{
    (void)m;
    (void)filter;
    (void)qos;
    (void)retained;
    return false;
}

void mqtt_free(mqtt *m)
{
    (void)m;
}
