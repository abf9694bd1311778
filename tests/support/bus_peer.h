/* SPDX-License-Identifier: MIT */
/*
 * A bus in virtual time with a scripted peer: bytes are put on the line for a given time, time is
 * let pass from deadline to deadline, and what was sent and what ended is written down.
 */
#ifndef GROBO_TEST_BUS_PEER_H
#define GROBO_TEST_BUS_PEER_H

#include <grobo/core/board.h>
#include <grobo/core/bus.h>

/* Through the board, everything else by default. */
extern const grobo_bus_config board_line;

enum { PEER_LOG_MAX = 256, PEER_CHUNKS_MAX = 64, PEER_CHUNK_BYTES = 160 };

typedef struct peer_chunk {
    int64_t at_us;
    uint8_t bytes[PEER_CHUNK_BYTES];
    size_t n;
} peer_chunk;

typedef struct peer_sent {
    int64_t at_us;
    uint8_t id; /* servo id in the frame, 0 for a long packet or a frame for the board */
    uint8_t first;
} peer_sent;

typedef struct peer_ended {
    int64_t at_us;
    grobo_txn *txn;
    int result;
    int16_t value; /* the reply's first two data bytes */
    bool has_reply;
} peer_ended;

/* What every transaction's ctx points to. */
typedef struct peer {
    grobo_bus bus;
    int64_t now_us;
    peer_chunk chunks[PEER_CHUNKS_MAX];
    int chunk_count;
    peer_sent sent[PEER_LOG_MAX];
    int sent_count;
    peer_ended ended[PEER_LOG_MAX];
    int ended_count;
    int64_t reply_after_us; /* the answer of an obliging peer comes this long after over */
    bool obliging;          /* answers every read with the value 100 x id */
    uint8_t silent_id;      /* but not this one's */
    void (*on_done)(struct peer *p, grobo_txn *txn, int result);
} peer;

void peer_init(peer *p, const grobo_bus_config *config);

/* A transaction whose end is written down; frame must stay. Asserts that it is well formed. */
void peer_txn(peer *p, grobo_txn *txn, const uint8_t *frame, int n, grobo_priority priority);

/* A transaction with room for its frame. */
typedef struct request {
    grobo_txn txn;
    uint8_t frame[GROBO_FRAME_MAX_BYTES];
} request;

/* Makes it read this many bytes of a servo from No.42 on. */
void peer_read(peer *p, request *r, uint8_t id, uint8_t bytes, grobo_priority priority);

/* Submits a reading of No.42-43, a ping that wants an ACK, or a goal that wants no reply. */
void peer_submit_read(peer *p, request *r, uint8_t id, uint8_t retries);
void peer_submit_ping(peer *p, request *r, uint8_t id, uint8_t retries);
void peer_submit_goal(peer *p, request *r, uint8_t id, grobo_priority priority);

/* Bytes that arrive at a time; in any order of calls. */
void peer_bytes_at(peer *p, int64_t at_us, const uint8_t *bytes, size_t n);

/* A return packet of this id for No.42-43. */
void peer_position_at(peer *p, int64_t at_us, uint8_t id, int16_t value);

/* Lets time pass until everything that is due at until_us is done. */
void peer_run(peer *p, int64_t until_us);

#endif
