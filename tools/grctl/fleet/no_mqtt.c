/* SPDX-License-Identifier: MIT */
#include "tools/grctl/fleet/direct.h"
#include "tools/grctl/lang/lang.h"

bool direct_possible(void)
{
    return false;
}

direct *direct_new(const mqtt_config *config, const char **why)
{
    (void)config;
    *why = _("this grctl was built without libmosquitto");
    return NULL;
}

void direct_start(direct *m)
{
    (void)m;
}

bool direct_is_up(const direct *m)
{
    (void)m;
    return false;
}

int direct_publish(direct *m, const mqtt_message *message, int qos, int expiry_s)
{
    (void)m;
    (void)message;
    (void)qos;
    (void)expiry_s;
    return 0;
}

bool direct_subscribe(direct *m, const char *filter, int qos, bool retained)
{
    (void)m;
    (void)filter;
    (void)qos;
    (void)retained;
    return false;
}

void direct_free(direct *m)
{
    (void)m;
}
