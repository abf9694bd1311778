/* SPDX-License-Identifier: MIT */
#ifndef GROBO_CORE_LX16A_ITEMS_H
#define GROBO_CORE_LX16A_ITEMS_H

#include <grobo/core/lx16a.h>

#include "src/servo/item.h"

/* Codes: grobo_lx16a_code. */
extern const grobo_i_item grobo_i_lx16a_items[];

#endif
