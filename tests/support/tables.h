/* SPDX-License-Identifier: MIT */
/* The library's tables, for const tables of tests that point to them. */
#ifndef GROBO_TESTS_TABLES_H
#define GROBO_TESTS_TABLES_H

#include "src/body/body.h"
#include "src/robots/file/families.h"
#include "src/servo/tables.h"
#include "src/sim/servo/family.h"

#endif
