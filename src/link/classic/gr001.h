/* SPDX-License-Identifier: MIT */
/* The inside of gr001.h. */
#ifndef GROBO_LINK_GR001_I_H
#define GROBO_LINK_GR001_I_H

#include <grobo/model.h>

/* Joints in the order of their motors; joints: room for GROBO_JOINTS_MAX. @return how many. */
int grobo_i_gr001_order(const grobo_model *model, uint8_t *joints);

#endif
