/* SPDX-License-Identifier: MIT */
/* What the bus knows of time: wire times, margins, reservations, replies that may yet come. */
#ifndef GROBO_CORE_BUS_TIME_H
#define GROBO_CORE_BUS_TIME_H

#include <grobo/bus.h>

/* Time given above the computed one to attempt number attempts (1 the first). */
uint32_t grobo_i_bus_margin_us(const grobo_bus *bus, unsigned attempts);

/* When what costs this and starts at start_us is over, the board's backlog considered. */
int64_t grobo_i_bus_over_at(const grobo_bus *bus, const grobo_bus_cost *cost, int64_t start_us);

/* The active transaction's reply has come, in its first attempt. */
void grobo_i_bus_learn(grobo_bus *bus);

/* Remembers that a reply to this transaction may yet come, counted from from_us. */
void grobo_i_bus_hold(grobo_bus *bus, const grobo_txn *txn, int64_t from_us);

/* The line keeps the order: what was lost before the reply that came now will not come. */
void grobo_i_bus_release_holds(grobo_bus *bus);

/* The first moment, not before now_us, at which this waiting transaction may start. */
int64_t grobo_i_bus_start_at(const grobo_bus *bus, const grobo_txn *txn, int64_t now_us);

#endif
