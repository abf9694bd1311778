/* SPDX-License-Identifier: MIT */
/* What a bus makes of the bytes that come; grobo_bus_rx itself is in grobo/core/bus.h. */
#ifndef GROBO_CORE_BUS_RECEIVE_H
#define GROBO_CORE_BUS_RECEIVE_H

#include <grobo/core/bus.h>

/* Drops the stump of an earlier reply: it must not become the head of the next one. */
void grobo_i_bus_clear_line(grobo_bus *bus);

/* The time of the active one is over. What came instead of its echo is no silence. */
void grobo_i_bus_end_silence(grobo_bus *bus);

#endif
