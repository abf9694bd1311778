/* SPDX-License-Identifier: MIT */
/* What the bus knows of time: wire times, margins, reservations, replies that may yet come. */
#ifndef GROBO_CORE_BUS_TIME_H
#define GROBO_CORE_BUS_TIME_H

#include <grobo/core/bus.h>

/* Time given above the computed one to attempt number attempts (1 the first). */
uint32_t grobo_i_bus_margin_us(const grobo_bus *bus, unsigned attempts);

/* When what costs this and starts at start_us is over, the board's backlog considered. */
int64_t grobo_i_bus_over_at(const grobo_bus *bus, const grobo_bus_cost *cost, int64_t start_us);

/* The active transaction's reply has come, in its first attempt. */
void grobo_i_bus_learn(grobo_bus *bus);

/* Two replies of the same key would be taken for one another. An ACK has no name. */
uint32_t grobo_i_bus_key(const grobo_reply *reply);
/* The same of a return packet. */
uint32_t grobo_i_bus_packet_key(const grobo_packet *packet);

/*
 * Counts one more reply to this transaction that may yet come, that of its active attempt. Until it
 * has come, or for the time of lateness that the bus has learnt from from_us on, nothing is asked
 * that it would be taken for.
 */
void grobo_i_bus_hold(grobo_bus *bus, const grobo_txn *txn, int64_t from_us);

/* The hold that counts on a reply with this key, or NULL. Nothing that comes before the first of
 * them is due is a reply that is owed. */
grobo_bus_hold *grobo_i_bus_owed(grobo_bus *bus, uint32_t key);

/* A reply came that is owed: strikes it off, learns how late it was. False if it was not owed. */
bool grobo_i_bus_settle(grobo_bus *bus, uint32_t key);

/* A reply with this key, 0 for a byte without a name, ends a later attempt than the first. It may
 * have been the late one to an earlier attempt: then one more comes, as late as this one. */
void grobo_i_bus_hold_more(grobo_bus *bus, const grobo_txn *txn, uint32_t key);

/* The board and the adapter keep the order: what was lost before the reply that came now will not
 * come. Only a servo on a bus may answer a little later than another one. */
void grobo_i_bus_release_holds(grobo_bus *bus);

/* The first moment, not before now_us, at which this waiting transaction may start. */
int64_t grobo_i_bus_start_at(const grobo_bus *bus, const grobo_txn *txn, int64_t now_us);

#endif
