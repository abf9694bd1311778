/* SPDX-License-Identifier: MIT */
#define GROBO_I_INSTANT_HERE
#include "src/base/instant.h"
