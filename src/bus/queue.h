/* SPDX-License-Identifier: MIT */
/* The queues of a bus and the ends of its transactions. */
#ifndef GROBO_CORE_BUS_QUEUE_H
#define GROBO_CORE_BUS_QUEUE_H

#include <grobo/core/bus.h>

/* Asserts what always holds of a bus between two calls; nothing with NDEBUG. */
void grobo_i_bus_assert(const grobo_bus *bus);

void grobo_i_bus_put_last(grobo_bus *bus, grobo_txn *txn);

/* True if it was there. */
bool grobo_i_bus_take_out(grobo_bus *bus, grobo_txn *txn);

/* The last touch: after the callback the transaction may not exist any more. */
void grobo_i_bus_finish(grobo_bus *bus, grobo_txn *txn, int result, const grobo_packet *reply);

/* An attempt of the active transaction has failed: it waits for the next one, or ends. */
void grobo_i_bus_fail(grobo_bus *bus, int error);

/*
 * The line has talked out of turn, or has failed: it must be quiet before it is asked again. Where
 * it babbles on, a request goes out all the same when the longest silence asked for is over.
 */
void grobo_i_bus_ask_for_quiet(grobo_bus *bus);

#endif
