/* SPDX-License-Identifier: MIT */
/* The driver of HPI's GR001. */
#include <grobo/board.h>

#include "src/servo/rs30x/driver.h"

#define RAD(deg) ((deg)*0.017453292519943295)

/* Crouched with flat feet, arms as in the initial posture: the knees give the height, hips and
 * ankles share their angle. Torque may go from here without a fall. */
static const double rest_rad[] = {
    0, 0, RAD(60),  RAD(-120), RAD(-60), 0,                    /* right leg */
    0, 0, RAD(-60), RAD(120),  RAD(60),  0,                    /* left leg */
    0, 0, RAD(20),  0,         RAD(-20), RAD(-20), 0, RAD(20), /* chest, neck, arms */
};

/* The original program adds these to what it reads (protocol 5). */
static const grobo_readback readback[] = {
    {RAD(2.0), 3},  /* motor 12, R_KNEE_P */
    {RAD(-2.0), 9}, /* motor 18, L_KNEE_P */
};

/* Chosen by us, none is documented: 65 deg C is below the servos' own limit; 6.0 V is an empty
 * battery of two lithium cells; joints that move freely draw about half of 600 mA, stuck ones more
 * than that. */
#define GR001_LIMITS                                                                               \
    .limits = {.temperature_c = 65,                                                                \
               .lost_replies = 5,                                                                  \
               .current_ma = 600,                                                                  \
               .voltage_mv = 6000,                                                                 \
               .current_us = 1000000,                                                              \
               .approach_rad_s = RAD(GROBO_PLAY_APPROACH_DEG_S)}

static const grobo_driver tables[] = {
    [GROBO_WIRING_BOARD] = {.name = "GR001",
                            .model = &grobo_gr001_model,
                            .protocol = &grobo_board_protocol,
                            .rest_rad = rest_rad,
                            .readback = readback,
                            .n_readback = sizeof readback / sizeof readback[0],
                            .stored = grobo_i_rs30x_stored,
                            GR001_LIMITS,
                            GROBO_I_RS30X_FUNCTIONS},
    [GROBO_WIRING_BUS] = {.name = "GR001",
                          .model = &grobo_gr001_model,
                          .protocol = &grobo_rs30x_protocol,
                          .rest_rad = rest_rad,
                          .readback = readback,
                          .n_readback = sizeof readback / sizeof readback[0],
                          GR001_LIMITS,
                          GROBO_I_RS30X_FUNCTIONS},
};

const grobo_driver *grobo_gr001_driver(grobo_wiring wiring)
{
    return wiring == GROBO_WIRING_BOARD || wiring == GROBO_WIRING_BUS ? &tables[wiring] : NULL;
}
