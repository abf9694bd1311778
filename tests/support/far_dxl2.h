/* SPDX-License-Identifier: MIT */
/* Servos with the frame of DYNAMIXEL protocol 2: what far_dxl2.c has to know of the registers that
 * far_dxl2_tables.c keeps. */
#ifndef GROBO_TESTS_FAR_DXL2_H
#define GROBO_TESTS_FAR_DXL2_H

#include "tests/support/far_side.h"

enum { FAR_DXL2_PARTS = 3 };

/* Registers from an address on, and where far_joint keeps them. */
typedef struct far_dxl2_part {
    int from, bytes, kept;
} far_dxl2_part;

typedef struct far_dxl2_field {
    int at, bytes; /* 0 bytes: it has none */
} far_dxl2_field;

typedef struct far_dxl2_layout {
    far_dxl2_part part[FAR_DXL2_PARTS];
    far_dxl2_field torque, goal, velocity; /* velocity: of a wheel */
    int watchdog;                          /* where it is kept; 0: it has none */
    /* Whether it is a wheel, and how fast, by its registers; NULL: it is none. */
    void (*spin)(far_joint *joint);
    /* Writes what it measures into the registers. */
    void (*refresh)(far_joint *joint);
} far_dxl2_layout;

const far_dxl2_layout *far_dxl2_layout_of(const far_family *family);

int far_dxl2_measure(const uint8_t *bytes, int n);
bool far_dxl2_sound(const uint8_t *frame, int n);
/* A goal, a torque or a wheel's velocity. */
bool far_dxl2_moves(const far_dxl2_layout *its, const uint8_t *frame, int n);
void far_dxl2_obey(far_side *far, const uint8_t *frame, int n);

#endif
