/* SPDX-License-Identifier: MIT */
/*
 * A topic and a payload of a stranger at the broker: refused, or an order whose fields are within
 * their bounds. The first line of the bytes is the topic.
 */
#include <string.h>

#include "tests/fuzz/target.h"
#include "tools/grctl/fleet/message.h"

enum { FIRST_BYTES = 512 };

/* A topic that is taken apart is put together again as it was. */
static int see_topic(const char *topic, char part[4][FLEET_NAME_BYTES])
{
    char again[FLEET_TOPIC_BYTES];
    int n = fleet_parts(topic, part);
    for (int i = 0; i < n; i++) {
        MUST(fleet_is_name(part[i]));
    }
    if (n > 0) {
        MUST(fleet_topic(again, part[0], n > 1 ? part[1] : NULL, n > 2 ? part[2] : NULL,
                         n > 3 ? part[3] : NULL));
        MUST(strcmp(again, topic) == 0);
    }
    return n;
}

static void see_order(const char *verb, json_t *body)
{
    fleet_order order;
    const char *why = NULL;
    bool ok = fleet_order_read(&order, verb, body, &why);
    MUST(ok == (why == NULL));
    if (!ok) {
        return;
    }
    MUST(strlen(order.id) == FLEET_ID_BYTES - 1 && strlen(order.from) == FLEET_ID_BYTES - 1);
    MUST(strlen(order.epoch) == FLEET_ID_BYTES - 1);
    MUST(order.issued_us >= 0 && order.deadline_us >= order.issued_us);
    /* For another life, long after, long before, and valid for too long: never done. */
    char other[FLEET_ID_BYTES];
    memcpy(other, order.epoch, sizeof other);
    other[0] = other[0] == '0' ? '1' : '0';
    MUST(fleet_order_judge(&order, other, order.issued_us));
    MUST(order.deadline_us == INT64_MAX ||
         fleet_order_judge(&order, order.epoch, order.deadline_us + 1));
    MUST(order.issued_us < FLEET_ORDER_LIFE_US ||
         fleet_order_judge(&order, order.epoch, order.issued_us - FLEET_ORDER_LIFE_US));
    MUST(order.deadline_us - order.issued_us <= FLEET_ORDER_LIFE_US ||
         fleet_order_judge(&order, order.epoch, order.issued_us));
}

/* What an agent takes from another's clock is an offset with a bound, whatever it is told. */
static void see_clock(const json_t *body)
{
    static fleet_clock clock;
    int64_t offset_us, bound_us, theirs_us = fleet_number(body, "t_us", -1);
    if (theirs_us >= 0) {
        fleet_clock_add(&clock, 1000, theirs_us, 3000);
        MUST(fleet_clock_read(&clock, 4000, &offset_us, &bound_us) && bound_us >= 0);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *end = size ? memchr(data, '\n', size) : NULL;
    size_t first = end ? (size_t)(end - data) : size;
    char topic[FIRST_BYTES], part[4][FLEET_NAME_BYTES];
    size_t length = first < sizeof topic ? first : sizeof topic - 1;
    memcpy(topic, size ? data : (const uint8_t *)"", length);
    topic[length] = '\0';
    int n = see_topic(topic, part);
    json_t *body = end ? fleet_read(end + 1, size - first - 1) : NULL;
    if (body) {
        MUST(fleet_number(body, "v", 0) == FLEET_VERSION);
        see_order(n == 3 ? part[2] : "put", body);
        see_clock(body);
    }
    json_decref(body);
    return 0;
}
