/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <event2/util.h>

#include "tools/grctl/fleet/message.h"
#include "tools/grctl/os/os.h"

/* ---- names and topics ------------------------------------------------------------------------ */

static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";

bool fleet_is_name(const char *name)
{
    size_t length = name ? strlen(name) : 0;
    return length > 0 && length < FLEET_NAME_BYTES && strspn(name, letters) == length;
}

bool fleet_is_link(const char *url)
{
    bool fits = url && strlen(url) < FLEET_URL_BYTES &&
                (strncmp(url, "http://", 7) == 0 || strncmp(url, "https://", 8) == 0) &&
                strcspn(url, " \"<>\\^`{|}\x7f") == strlen(url);
    for (const char *c = url; fits && *c; c++) {
        fits = (unsigned char)*c > ' ';
    }
    return fits;
}

void fleet_host_name(char *name)
{
    os_host_name(name, FLEET_NAME_BYTES);
    for (char *at = name; *(at += strspn(at, letters));) {
        *at = '-';
    }
    if (*name == '\0') {
        snprintf(name, FLEET_NAME_BYTES, "robot-host");
    }
}

void fleet_make_id(char *id)
{
    unsigned char bytes[FLEET_ID_BYTES / 2];
    evutil_secure_rng_get_bytes(bytes, sizeof bytes);
    for (size_t i = 0; i < sizeof bytes; i++) {
        snprintf(id + 2 * i, 3, "%02x", bytes[i]);
    }
}

bool fleet_topic(char *topic, const char *a, const char *b, const char *c, const char *d)
{
    const char *const parts[] = {a, b, c, d};
    size_t n = (size_t)snprintf(topic, FLEET_TOPIC_BYTES, "%s", FLEET_ROOT);
    for (int i = 0; i < 4 && parts[i] && n < FLEET_TOPIC_BYTES; i++) {
        n += (size_t)snprintf(topic + n, FLEET_TOPIC_BYTES - n, "/%s", parts[i]);
    }
    return n < FLEET_TOPIC_BYTES;
}

int fleet_parts(const char *topic, char parts[4][FLEET_NAME_BYTES])
{
    size_t root = strlen(FLEET_ROOT);
    int n = 0;
    if (strncmp(topic, FLEET_ROOT "/", root + 1) != 0) {
        return 0;
    }
    for (const char *at = topic + root; *at; n++) {
        size_t length = strcspn(++at, "/");
        if (n == 4 || length >= FLEET_NAME_BYTES) {
            return 0;
        }
        snprintf(parts[n], FLEET_NAME_BYTES, "%.*s", (int)length, at);
        if (!fleet_is_name(parts[n])) {
            return 0;
        }
        at += length;
    }
    return n;
}

/* ---- payloads -------------------------------------------------------------------------------- */

/* What every reader of JSON keeps exactly, 2^53: sums of such times do not overflow. */
#define NUMBER_MAX INT64_C(9007199254740992)

json_t *fleet_read(const void *payload, size_t size)
{
    json_t *object = json_loadb(payload, size, JSON_REJECT_DUPLICATES, NULL);
    if (!json_is_object(object) || fleet_number(object, "v", 0) != FLEET_VERSION) {
        json_decref(object);
        return NULL;
    }
    return object;
}

const char *fleet_text(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

int64_t fleet_number(const json_t *object, const char *key, int64_t otherwise)
{
    const json_t *value = json_object_get(object, key);
    int64_t number = json_is_integer(value) ? (int64_t)json_integer_value(value) : otherwise;
    return number > NUMBER_MAX || number < -NUMBER_MAX ? otherwise : number;
}

static bool take_id(char *id, const char *text)
{
    bool ok = text && strlen(text) == FLEET_ID_BYTES - 1 &&
              strspn(text, "0123456789abcdef") == FLEET_ID_BYTES - 1;
    snprintf(id, FLEET_ID_BYTES, "%s", ok ? text : "");
    return ok;
}

bool fleet_order_read(fleet_order *order, const char *verb, json_t *body, const char **why)
{
    memset(order, 0, sizeof *order);
    snprintf(order->verb, sizeof order->verb, "%s", verb);
    order->body = body;
    order->issued_us = fleet_number(body, "issued_us", INT64_MIN);
    order->deadline_us = fleet_number(body, "deadline_us", INT64_MIN);
    *why = !take_id(order->id, fleet_text(body, "id"))         ? "it has no id"
           : !take_id(order->from, fleet_text(body, "from"))   ? "it does not say who sends it"
           : !take_id(order->epoch, fleet_text(body, "epoch")) ? "it has no epoch"
           : order->issued_us < 0 || order->deadline_us < order->issued_us ? "it has no times"
                                                                           : NULL;
    return *why == NULL;
}

const char *fleet_order_judge(const fleet_order *order, const char *epoch, int64_t their_now_us)
{
    if (strcmp(order->epoch, epoch) != 0) {
        return "it is for another life of this agent";
    }
    if (order->deadline_us - order->issued_us > FLEET_ORDER_LIFE_US) {
        return "it is valid for too long";
    }
    if (their_now_us > order->deadline_us) {
        return "it is too late";
    }
    /* Clocks that were compared differ by less than half a second. */
    return order->issued_us > their_now_us + FLEET_ORDER_LIFE_US / 4 ? "it is from the future"
                                                                     : NULL;
}

/* ---- what was answered before ---------------------------------------------------------------- */

static int place_of(const fleet_seen *seen, const char *id)
{
    for (int i = 0; i < FLEET_SEEN; i++) {
        if (strcmp(seen->id[i], id) == 0) {
            return i;
        }
    }
    return -1;
}

const char *fleet_seen_find(const fleet_seen *seen, const char *id)
{
    int i = place_of(seen, id);
    return i < 0 ? NULL : seen->answer[i] ? seen->answer[i] : "";
}

void fleet_seen_begin(fleet_seen *seen, const char *id)
{
    int i = seen->next;
    free(seen->answer[i]);
    seen->answer[i] = NULL;
    snprintf(seen->id[i], FLEET_ID_BYTES, "%s", id);
    seen->next = (i + 1) % FLEET_SEEN;
}

void fleet_seen_end(fleet_seen *seen, const char *id, const char *answer)
{
    int i = place_of(seen, id);
    size_t bytes = strlen(answer) + 1;
    if (i < 0) {
        return;
    }
    free(seen->answer[i]);
    seen->answer[i] = malloc(bytes);
    if (seen->answer[i]) {
        memcpy(seen->answer[i], answer, bytes);
    }
}

void fleet_seen_free(fleet_seen *seen)
{
    for (int i = 0; i < FLEET_SEEN; i++) {
        free(seen->answer[i]);
        seen->answer[i] = NULL;
    }
}

/* ---- another's clock ------------------------------------------------------------------------- */

void fleet_clock_add(fleet_clock *clock, int64_t sent_us, int64_t theirs_us, int64_t heard_us)
{
    unsigned i = clock->n++ % FLEET_CLOCK_SAMPLES;
    clock->trip_us[i] = heard_us - sent_us;
    clock->offset_us[i] = theirs_us - (sent_us + (heard_us - sent_us) / 2);
    clock->at_us[i] = heard_us;
}

bool fleet_clock_read(const fleet_clock *clock, int64_t now_us, int64_t *offset_us,
                      int64_t *bound_us)
{
    unsigned n = clock->n < FLEET_CLOCK_SAMPLES ? clock->n : FLEET_CLOCK_SAMPLES;
    *bound_us = INT64_MAX;
    for (unsigned i = 0; i < n; i++) {
        int64_t bound = clock->trip_us[i] / 2 + (now_us - clock->at_us[i]) / 20000;
        if (bound < *bound_us) {
            *bound_us = bound;
            *offset_us = clock->offset_us[i];
        }
    }
    return n > 0;
}
