/* SPDX-License-Identifier: MIT */
/*
 * A host in virtual time that knows nothing of the library's builders and parsers: it writes bytes
 * that are spelled out, and notes each byte that comes back with its time.
 */
#ifndef GROBO_TEST_SIMKIT_H
#define GROBO_TEST_SIMKIT_H

#include <grobo/core/sim_static.h>

enum { SIMKIT_BYTES = 4096, SIMKIT_EVENTS = 512 };

typedef struct simkit {
    grobo_sim sim;
    int64_t now_us;
    uint8_t got[SIMKIT_BYTES]; /* bytes that came since the last send */
    int64_t got_us[SIMKIT_BYTES];
    size_t n_got;
    grobo_sim_event events[SIMKIT_EVENTS]; /* without their bytes */
    size_t n_events;                       /* may be more than are kept */
} simkit;

/* Time 1 s, so that a mix-up of absolute and relative shows. config NULL: defaults. */
void simkit_start(simkit *kit, const grobo_sim_config *config);
/* Writes the bytes of "41 00" at the present time and forgets what came before. */
void simkit_send(simkit *kit, const char *hex);
/* Lets time go on to now + us, reading whenever the simulator says so. */
void simkit_run(simkit *kit, int64_t us);
/* simkit_send, then time until the simulator is idle, or for at_most_us. */
void simkit_ask(simkit *kit, const char *hex, int64_t at_most_us);
/*
 * A servo packet without its sum, "FA AF 01 0F 2A 02 00": adds the sum, wraps it for the wiring
 * (53 without a reply, 54 for r > 0 bytes), lets it be carried out, and 50 ms go by at most.
 */
void simkit_packet(simkit *kit, const char *hex, uint8_t r);
/* The bytes that came are exactly those of hex. */
void simkit_expect(const simkit *kit, const char *hex);
/* Events of this kind noted since the last simkit_forget; the last of them where not NULL. */
size_t simkit_events(const simkit *kit, grobo_sim_event_kind kind, grobo_sim_event *last);
void simkit_forget(simkit *kit);
/* A register of the servo with this index, read behind the robot's back. */
int32_t simkit_register(simkit *kit, int servo, int address);
grobo_sim_view simkit_look(simkit *kit, int servo);
/* Index of the servo with this id; it must be there. */
int simkit_servo(const simkit *kit, int id);
/* 16 bits of the reply that came, from this place on, signed. */
int simkit_i16(const simkit *kit, size_t at);

#endif
