/* SPDX-License-Identifier: MIT */
/* `sim --strict`: each offence of a client against the protocol, in a line of its own. */
#ifndef GRCTL_SIM_STRICT_H
#define GRCTL_SIM_STRICT_H

#include <grobo/core/sim.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/decode/frames.h"

typedef struct sim_strict {
    app *a; /* NULL: not strict */
    int robot;
    uint64_t offences;
    /* private */
    grobo_wiring wiring;
    int64_t start_us, collision_us;
    frames host;
    talk talk;
    const grobo_servo_model *const *servos;  /* of the simulator, NULL: RS30x of the model */
    uint8_t packet[GROBO_WORDS_FRAME_BYTES]; /* the last one on the servos' bus */
    size_t n_packet;
    bool told;                             /* of that packet */
    uint8_t last[GROBO_WORDS_FRAME_BYTES]; /* what the client wrote last */
    size_t n_last;
} sim_strict;

/* sim: of the simulator, whose servos are judged each by its own model. words: how they talk. */
void sim_strict_start(sim_strict *s, app *a, int robot, const grobo_sim_config *sim,
                      const grobo_words *words);
/* What the client has written. */
void sim_strict_bytes(sim_strict *s, int64_t now_us, const uint8_t *bytes, size_t n);
/* What happened in the simulator. */
void sim_strict_event(sim_strict *s, const grobo_sim_event *event);
/* Nothing more comes: what is cut off is an offence too. */
void sim_strict_end(sim_strict *s);

#endif
