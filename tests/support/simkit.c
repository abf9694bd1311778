/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <string.h>

#include <grobo/core/sim.h>

#include "tests/support/simkit.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"

static void note(void *ctx, const grobo_sim_event *event)
{
    simkit *kit = ctx;
    if (kit->n_events < SIMKIT_EVENTS) {
        kit->events[kit->n_events] = *event;
    }
    kit->n_events++;
}

void simkit_start(simkit *kit, const grobo_sim_config *config)
{
    grobo_sim_config with = {GROBO_SIM_CONFIG_INIT};
    if (config != NULL) {
        with = *config;
    }
    with.hook = note;
    with.hook_ctx = kit;
    memset(kit, 0, sizeof *kit);
    kit->now_us = 1000000;
    assert_int_equal(grobo_sim_init(&kit->sim, &with, kit->now_us), 0);
    simkit_forget(kit);
}

static void read_all(simkit *kit)
{
    size_t n =
        grobo_sim_tx(&kit->sim, kit->got + kit->n_got, SIMKIT_BYTES - kit->n_got, kit->now_us);
    for (size_t i = 0; i < n; i++) {
        kit->got_us[kit->n_got++] = kit->now_us;
    }
}

static void send_bytes(simkit *kit, const uint8_t *bytes, size_t n)
{
    kit->n_got = 0;
    assert_int_equal(grobo_sim_rx(&kit->sim, bytes, n, kit->now_us), n);
}

void simkit_send(simkit *kit, const char *hex)
{
    uint8_t bytes[VECTOR_MAX_BYTES];
    int n = vector_from_hex(hex, bytes, sizeof bytes);
    assert_true(n > 0);
    send_bytes(kit, bytes, (size_t)n);
}

/* Goes to the next deadline, or to end_us; false when there is nothing up to then. */
static bool go_on(simkit *kit, int64_t end_us)
{
    int64_t at_us = grobo_sim_deadline(&kit->sim);
    if (at_us > end_us) {
        return false;
    }
    kit->now_us = at_us > kit->now_us ? at_us : kit->now_us;
    read_all(kit);
    return true;
}

void simkit_run(simkit *kit, int64_t us)
{
    int64_t end_us = kit->now_us + us;
    while (go_on(kit, end_us)) {
    }
    kit->now_us = end_us;
    read_all(kit);
}

static void wait_idle(simkit *kit, int64_t at_most_us)
{
    int64_t end_us = kit->now_us + at_most_us;
    while (go_on(kit, end_us)) {
    }
}

void simkit_ask(simkit *kit, const char *hex, int64_t at_most_us)
{
    simkit_send(kit, hex);
    wait_idle(kit, at_most_us);
}

void simkit_packet(simkit *kit, const char *hex, uint8_t r)
{
    uint8_t frame[VECTOR_MAX_BYTES];
    int n = vector_from_hex(hex, frame + 2, sizeof frame - 4);
    assert_true(n >= 7);
    uint8_t sum = 0;
    for (int i = 2; i < n; i++) {
        sum = (uint8_t)(sum ^ frame[2 + i]);
    }
    frame[2 + n] = sum;
    n++;
    if (kit->sim.config.wiring == GROBO_WIRING_BUS) {
        send_bytes(kit, frame + 2, (size_t)n);
    } else {
        frame[0] = r > 0 ? 0x54 : 0x53;
        frame[1] = (uint8_t)(n + (r > 0));
        frame[2 + n] = r;
        send_bytes(kit, frame, (size_t)(2 + n + (r > 0)));
    }
    wait_idle(kit, 50000);
}

void simkit_expect(const simkit *kit, const char *hex)
{
    uint8_t bytes[VECTOR_MAX_BYTES];
    int n = hex[0] == '\0' ? 0 : vector_from_hex(hex, bytes, sizeof bytes);
    assert_int_equal(kit->n_got, n);
    if (n > 0) {
        assert_memory_equal(kit->got, bytes, (size_t)n);
    }
}

size_t simkit_events(const simkit *kit, grobo_sim_event_kind kind, grobo_sim_event *last)
{
    size_t n = 0;
    assert_true(kit->n_events <= SIMKIT_EVENTS);
    for (size_t i = 0; i < kit->n_events; i++) {
        if (kit->events[i].kind == kind) {
            n++;
            if (last != NULL) {
                *last = kit->events[i];
            }
        }
    }
    return n;
}

void simkit_forget(simkit *kit)
{
    kit->n_events = 0;
}

int32_t simkit_register(simkit *kit, int servo, int address)
{
    int32_t value = 0;
    grobo_sim_step(&kit->sim, kit->now_us);
    assert_int_equal(grobo_sim_get_register(&kit->sim, servo, address, &value), 0);
    return value;
}

grobo_sim_view simkit_look(simkit *kit, int servo)
{
    grobo_sim_view view;
    grobo_sim_step(&kit->sim, kit->now_us);
    assert_int_equal(grobo_sim_look(&kit->sim, servo, &view), 0);
    return view;
}

int simkit_servo(const simkit *kit, int id)
{
    int servo = grobo_sim_find(&kit->sim, id);
    assert_true(servo >= 0);
    return servo;
}

int simkit_i16(const simkit *kit, size_t at)
{
    assert_true(at + 2 <= kit->n_got);
    return (int16_t)(uint16_t)(kit->got[at] | kit->got[at + 1] << 8);
}
