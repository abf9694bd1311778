/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tools/grctl/fleet/wire.h"

int64_t wire_wall_ms(void)
{
    return (int64_t)time(NULL) * 1000;
}

void wire_subscribe(mqtt *m, const char *a, const char *b, const char *c, bool retained)
{
    char topic[FLEET_TOPIC_BYTES];
    if (fleet_topic(topic, a, b, c, NULL)) {
        (void)mqtt_subscribe(m, topic, 1, retained);
    }
}

int wire_publish(mqtt *m, const mqtt_message *with, json_t *object, int qos, int expiry_s)
{
    mqtt_message message = *with;
    char *text = object ? json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(6)) : NULL;
    int number = 0;
    if (text) {
        message.payload = text;
        message.size = strlen(text);
        number = mqtt_publish(m, &message, qos, expiry_s);
    }
    free(text);
    json_decref(object);
    return number;
}

int wire_tell(mqtt *m, const char *a, const char *b, const char *c, json_t *object, int how)
{
    char topic[FLEET_TOPIC_BYTES];
    const mqtt_message message = {.topic = topic, .retained = (how & WIRE_KEPT) != 0};
    if (!fleet_topic(topic, a, b, c, NULL)) {
        json_decref(object);
        return 0;
    }
    return wire_publish(m, &message, object, how & WIRE_SURE, 0);
}
