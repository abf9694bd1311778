/* SPDX-License-Identifier: MIT */
/* The waist balancer. */
#ifndef GROBO_SRC_BODY_BALANCE_H
#define GROBO_SRC_BODY_BALANCE_H

#include "src/body/body.h"

/* How many doubles of workspace it needs. */
size_t grobo_i_balance_doubles(int n_frames);

/* Computes the shift of the waist at every frame: solves the whole motion a few times. */
void grobo_i_balance(grobo_body *body);

#endif
