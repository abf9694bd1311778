/* SPDX-License-Identifier: MIT */
/* Servos with the frame of DYNAMIXEL protocol 1: what far_dxl1.c has to know of the registers that
 * far_dxl1_tables.c keeps. */
#ifndef GROBO_TESTS_FAR_DXL1_H
#define GROBO_TESTS_FAR_DXL1_H

#include "tests/support/far_side.h"

typedef struct far_dxl1_layout {
    int goal, torque; /* where they are */
    bool sync_read, bulk_read;
    int speed_at; /* where a wheel's is; 0: no wheel is known */
    /* Whether it is a wheel, and how fast, by its registers; NULL: it is none. */
    void (*spin)(far_joint *joint);
    /* Writes what it measures into the registers. */
    void (*refresh)(far_joint *joint);
} far_dxl1_layout;

const far_dxl1_layout *far_dxl1_layout_of(const far_family *family);

int far_dxl1_measure(const uint8_t *bytes, int n);
bool far_dxl1_sound(const uint8_t *frame, int n);
/* A goal or a torque where these are. */
bool far_dxl1_moves(const far_dxl1_layout *where, const uint8_t *frame, int n);
void far_dxl1_obey(far_side *far, const uint8_t *frame, int n);

#endif
