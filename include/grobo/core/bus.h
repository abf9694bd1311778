/* SPDX-License-Identifier: MIT */
/**
 * @file bus.h
 * @brief Bounded transactions on a half-duplex line, sans I/O.
 *
 * A transaction is a frame and the reply to it. The bus keeps the transactions that wait, by
 * priority, and has one on the wire at a time. It gives bytes to send, takes bytes received, and
 * returns when it must be called next; it has no descriptor, clock or allocation.
 *
 * A pump does, whenever bytes came or the deadline passed, always in this order:
 * @code
 *   grobo_bus_rx(&bus, bytes, n, now);              // what has arrived, first
 *   grobo_bus_step(&bus, now);                      // timeouts, replies that need none
 *   n = grobo_bus_tx(&bus, buf, sizeof buf, now);   // > 0: write buf, all of it, in order
 *   wake_up_at(grobo_bus_deadline(&bus, now));      // <= now: again at once
 * @endcode
 *
 * Rules it keeps:
 * - Order: stop, then motion, then a user's request, then sensing; first come first served within
 *   a priority. While a stop or a motion frame waits, a lower transaction on the wire gets no more
 *   time than its reply needs, and is tried again afterwards if its budget allows.
 * - A transaction ends exactly once, by its callback. Timeouts, wrong sums, broken echoes and a
 *   NACK, one byte without a name, are retried within its budget; a refusal in a return packet
 *   (GROBO_RS30X_STATUS_REFUSED) is never retried.
 * - A deadline is computed: wire time of the request at the baud rate, forwarding by the board,
 *   return delay, wire time of the reply, plus a margin learnt from the replies so far.
 * - A reply is believed when header, id, length and sum are those expected, and the address where
 *   the family's replies tell one, and it came after its request was sent. After a failure the line
 *   must be quiet for a moment before the next request that wants a reply. An ACK is one byte
 *   without a name: it must be the first byte after the request.
 * - A late reply is credited: it ends the transaction that waits for its next attempt. The replies
 *   owed to attempts that failed are counted. While one is owed, no other transaction that it
 *   would satisfy is sent, until it has come or twice the worst lateness learnt has passed, at most
 *   hold_us. An ACK is waited for during all of hold_us. A reply to a later request ends this wait:
 *   the board keeps the order, so the lost reply cannot come any more. On a bus the adapter keeps
 *   the order but servos answer on their own: there the wait ends GROBO_BUS_MARGIN_MAX_US after
 *   that reply. Retries of the same transaction do not wait: a late reply to its first attempt is a
 *   reply to it.
 * - An echo is found behind late echoes and late replies. As many other bytes as it has, or no
 *   echo in time, is a broken echo.
 *
 * - What was right when a transaction was submitted may be wrong when its turn comes: a transaction
 *   with a `leave` function is asked at every attempt, retries included, at the moment its frame
 *   would be given out. A refusal ends it, and the next transaction leaves in the same call.
 *
 * The bus is not thread safe: one thread, or the caller's lock. Callbacks run inside rx, step, tx
 * and the cancel functions; in a callback submit, cancel, reserve and the questions are allowed,
 * also freeing or resubmitting the transaction that ended; rx, step and tx are not. In a `leave`
 * function only the questions are.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_BUS_H
#define GROBO_CORE_BUS_H

#include <grobo/core/protocol.h>
#include <grobo/limits.h>

GROBO_BEGIN_DECLS

/** Which transaction goes first. */
typedef enum grobo_priority {
    GROBO_PRIORITY_STOP = 0,   /**< emergency stop and what makes the robot safe */
    GROBO_PRIORITY_MOTION = 1, /**< motion frames, on time */
    GROBO_PRIORITY_USER = 2,   /**< what a person asked for */
    GROBO_PRIORITY_SENSE = 3   /**< reading along */
} grobo_priority;

/** Number of priorities. */
#define GROBO_PRIORITIES 4

typedef struct grobo_txn grobo_txn;

/**
 * The end of a transaction. It is the caller's again: it may be freed or submitted here.
 * @param ctx    txn->ctx
 * @param txn    the transaction, no longer known to the bus
 * @param result GROBO_OK; GROBO_ERR_TIMEOUT (nothing came), GROBO_ERR_SHORT (some bytes came),
 *               GROBO_ERR_CHECKSUM, GROBO_ERR_MISMATCH (the echo was broken, or an ACK came
 *               among other bytes), GROBO_ERR_NACK, GROBO_ERR_STALE (start_by_us passed), what
 *               `leave` returned, or what the cancel function was given. Of several replies:
 *               GROBO_OK when all came, or it was not known which servos are there;
 *               GROBO_ERR_SHORT when some came, GROBO_ERR_TIMEOUT when none did
 * @param reply  the return packet or ACK that ended it, valid during the call; NULL when there is
 *               none. GROBO_ERR_NACK comes with it: its flags say why.
 */
typedef void (*grobo_txn_done)(void *ctx, grobo_txn *txn, int result, const grobo_packet *reply);

/**
 * An attempt is about to be given out. May write the frame anew: its bytes, `frame_bytes` (never
 * more than before) and `reply`. `sent_us` is still that of the attempt before, -1 at the first.
 * @return >= 0: the frame leaves now; < 0: it never leaves, and this error ends the transaction.
 */
typedef int (*grobo_txn_leave)(void *ctx, grobo_txn *txn);

/**
 * One of several replies to a transaction; `done` follows, with no packet. After a retry those of
 * the attempt before come again.
 * @param reply valid during the call; `refused` may be set
 */
typedef void (*grobo_txn_each)(void *ctx, grobo_txn *txn, const grobo_packet *reply);

/**
 * A transaction. The caller owns the struct and the frame's bytes; both must stay as they are until
 * done, but for what `leave` changes. Start from grobo_txn_init, then set what differs.
 */
struct grobo_txn {
    const uint8_t *frame;    /**< borrowed: what is sent */
    uint16_t frame_bytes;    /**< 1..GROBO_FRAME_MAX_BYTES */
    uint8_t retries;         /**< attempts after the first, 0 none */
    bool patient;            /**< the last attempt is given GROBO_BUS_MARGIN_MAX_US above the wire
                                  time, where neither timeout_us nor margin_us says otherwise. Not
                                  a stop or motion, and not into the reserved span. For where a
                                  stall at the other end is more likely than a dead servo */
    grobo_priority priority; /**< what goes first */
    grobo_reply reply;       /**< what must come back */
    uint32_t timeout_us;     /**< time from the first byte sent to the reply; 0: computed */
    uint8_t attempts_;       /**< private: begun */
    bool pending_;           /**< private: belongs to a bus */
    bool urgent;             /**< a stop waits for it: it is held for a reply that is owed no
                                  longer than a stop is, whatever its priority */
    int64_t start_by_us;     /**< not worth sending after this time; 0: always */
    grobo_txn_leave leave;   /**< NULL: every attempt leaves */
    grobo_txn_each each;     /**< gets the replies where there are several; may be NULL */
    grobo_txn_done done;     /**< may be NULL */
    void *ctx;               /**< handed back to leave, each and done */
    int64_t sent_us;         /**< out: when the last attempt was given out; -1: never */
    grobo_txn *next_;        /**< private */
};

/** The line's physics. Zero means default, but for the protocol. */
typedef struct grobo_bus_config {
    const grobo_protocol *protocol; /**< how the servos talk; borrowed */
    uint32_t baud_bps;              /**< of the host's line; default 115200 */
    uint32_t servo_baud_bps;        /**< of the bus behind the board; default 115200 */
    uint32_t return_delay_us;       /**< of the servos; default: the protocol's */
    uint32_t margin_us; /**< time given above the wire time, fixed; default: learnt, between
                                    GROBO_BUS_MARGIN_MIN_US and GROBO_BUS_MARGIN_MAX_US */
    uint32_t quiet_us;  /**< silence after a failure; default GROBO_BUS_QUIET_US */
    uint32_t hold_us;   /**< upper bound, see above; default GROBO_BUS_HOLD_US */
    bool echo;          /**< the adapter returns what is sent: check and remove it */
    bool overlap;       /**< the board takes a frame while it still forwards the one before;
                                    no document states that, so by default it is not relied upon */
} grobo_bus_config;

/** Learnt margin: lower bound. */
#define GROBO_BUS_MARGIN_MIN_US 3000
/** Learnt margin: upper bound, and of a retry, whose margin doubles. The last of a patient one. */
#define GROBO_BUS_MARGIN_MAX_US 40000
/** Learnt margin: before the first reply. An FTDI adapter holds bytes back for 16 ms. */
#define GROBO_BUS_MARGIN_FIRST_US 20000
/** Silence after a failure, before a request that wants a reply. */
#define GROBO_BUS_QUIET_US 1000
/** A babbling line is not waited for longer than this. */
#define GROBO_BUS_QUIET_MAX_US 50000
/** How long a reply may be late and still be told apart: upper bound, and before any reply. */
#define GROBO_BUS_HOLD_US 100000
/** Lost replies that are remembered at a time: the ACKs, and of the others the latest. */
#define GROBO_BUS_HOLDS 8

/** What the bus met; monotonic, wraps. */
typedef struct grobo_bus_stats {
    uint32_t tx_frames;    /**< frames given out, retries included */
    uint32_t tx_bytes;     /**< their bytes */
    uint32_t rx_bytes;     /**< bytes taken */
    uint32_t rx_frames;    /**< whole packets and ACKs among them */
    uint32_t replies;      /**< of these, those that ended a transaction well */
    uint32_t refusals;     /**< NACK or refused */
    uint32_t timeouts;     /**< attempts without a whole reply in time */
    uint32_t retries;      /**< attempts after the first */
    uint32_t bad_sums;     /**< replies whose sum was wrong */
    uint32_t resync_bytes; /**< skipped while a reply or an echo was awaited */
    uint32_t late_frames;  /**< whole replies that fitted nothing awaited, late echoes */
    uint32_t late_bytes;   /**< their bytes, and all that came when nothing was awaited */
    uint32_t bad_echoes;   /**< frames whose echo was broken */
    uint32_t failed;       /**< transactions that ended badly after their retries, or were refused
                                by `leave` */
    uint32_t canceled;     /**< transactions canceled by their owner */
} grobo_bus_stats;

/** What a bus is doing. */
typedef enum grobo_bus_phase {
    GROBO_BUS_IDLE,    /**< nothing on the wire */
    GROBO_BUS_GOING,   /**< a frame on its way that nothing will answer */
    GROBO_BUS_ECHOING, /**< waits for the echo of its frame */
    GROBO_BUS_AWAITING /**< waits for a reply */
} grobo_bus_phase;

/** Replies that did not come in time and may yet come. */
typedef struct grobo_bus_hold {
    int64_t due_us;         /**< when the first of them was due */
    int64_t until_us;       /**< after this time it is taken for granted that none comes */
    const grobo_txn *owner; /**< whose; only compared, it may be gone */
    uint32_t key;           /**< kind, id, address and length of the replies */
    uint32_t owed;          /**< how many may yet come; 0: the hold is free */
} grobo_bus_hold;

/** A bus. The struct is open so that it needs no heap; read stats, leave the rest. */
typedef struct grobo_bus {
    /* private; small and busy members first, where a Cortex-M0 reaches them in one instruction */
    grobo_bus_phase phase;
    bool learnt;          /* overhead_us and deviation_us come from a reply */
    uint8_t next_hold;    /* the slot used last, of 1.. */
    uint8_t accept;       /* packets that are believed now */
    uint16_t waiting;     /* transactions in the queues */
    grobo_txn *active;    /* on the wire; NULL when idle */
    int32_t overhead_us;  /* smoothed: how much later than computed replies come */
    int32_t deviation_us; /* smoothed deviation of that */
    int32_t worst_us;     /* the worst of that, slowly forgotten; at most half of hold_us */
    grobo_txn *head[GROBO_PRIORITIES];
    uint32_t bad_sums_before; /* the parser's counters when the active frame was sent */
    uint32_t dropped_before;
    grobo_bus_config config; /* no zeros left in it, but margin_us */
    int64_t now_us;          /* of the rx or step that is running */
    int64_t over_us;         /* when the active one is over if all goes well */
    int64_t limit_us;        /* when it has failed; when it is over if nothing answers it */
    int64_t free_us;         /* when the line is free for the next frame */
    int64_t servo_us;        /* when the bus behind the board is free */
    int64_t quiet_us;        /* when the silence after a failure is long enough */
    int64_t quiet_by_us;     /* when it is long enough in any case */
    int64_t reserve_us;
    int64_t reserve_end_us; /* 0: no span */
    /* public */
    grobo_bus_stats stats; /**< read freely */
    /* private */
    grobo_framer framer;
    uint64_t came;    /* of several replies, by their places, those that have come */
    uint32_t came_to; /* tx_frames of the attempt that they came to */
    grobo_bus_hold hold[GROBO_BUS_HOLDS];
} grobo_bus;

/**
 * Makes a bus ready; nothing is sent. config is copied.
 * @return GROBO_OK or GROBO_ERR_ARG (no protocol, echo through a board, a baud rate below 1200)
 */
GROBO_API int grobo_bus_init(grobo_bus *bus, const grobo_bus_config *config);

/** Fills a transaction with a frame of this protocol and the reply that the frame calls for.
 *  Priority user, two retries, computed timeout, no callback.
 *  @return GROBO_OK or the errors of protocol->reply_to */
GROBO_API int grobo_txn_init(grobo_txn *txn, const grobo_protocol *protocol, const uint8_t *frame,
                             size_t n);

/**
 * Puts a transaction at the end of its priority's queue.
 * @return GROBO_OK; GROBO_ERR_FULL when GROBO_BUS_QUEUE_MAX wait (a stop is always taken),
 *         GROBO_ERR_ARG (no frame, unknown priority), GROBO_ERR_BUSY (it is submitted already)
 */
GROBO_API int grobo_bus_submit(grobo_bus *bus, grobo_txn *txn);

/** True while a transaction belongs to a bus: between submit and its callback. */
GROBO_API bool grobo_txn_is_pending(const grobo_txn *txn);

/**
 * Cancels a transaction; its callback gets GROBO_ERR_CANCELED before this returns. If it is on
 * the wire the line stays occupied until it would have been over.
 * @return GROBO_OK, or GROBO_ERR_NOTFOUND when the bus does not have it
 */
GROBO_API int grobo_bus_cancel(grobo_bus *bus, grobo_txn *txn);

/**
 * Changes the priority of a transaction that waits: it goes to the end of the other queue and keeps
 * its attempts.
 * @return GROBO_OK; GROBO_ERR_NOTFOUND when the bus does not have it or it is on the wire,
 *         GROBO_ERR_ARG (unknown priority)
 */
GROBO_API int grobo_bus_raise(grobo_bus *bus, grobo_txn *txn, grobo_priority priority);

/** Bit of a priority, for grobo_bus_cancel_all. */
#define GROBO_PRIORITY_BIT(priority) (1u << (unsigned)(priority))
/** Bits of all priorities. */
#define GROBO_PRIORITY_ALL ((1u << GROBO_PRIORITIES) - 1u)

/**
 * Ends every transaction of these priorities with this result (< 0: GROBO_ERR_CANCELED,
 * GROBO_ERR_UNPLUGGED...). Those submitted again by a callback stay.
 * @return how many were ended
 */
GROBO_API int grobo_bus_cancel_all(grobo_bus *bus, unsigned priority_bits, int result);

/** Takes n bytes that arrived; callbacks may run. now_us must not run backwards. */
GROBO_API void grobo_bus_rx(grobo_bus *bus, const uint8_t *bytes, size_t n, int64_t now_us);

/** Lets time pass: ends what is over or too late; callbacks may run. */
GROBO_API void grobo_bus_step(grobo_bus *bus, int64_t now_us);

/**
 * Gives the next frame to send, if one may start now. It counts as sent at now_us. Transactions
 * that `leave` refuses end here: callbacks may run.
 * @return bytes put into buf, all of one frame; 0 when nothing may start now; GROBO_ERR_SPACE when
 *         the frame is longer than cap (GROBO_FRAME_MAX_BYTES is always enough)
 */
GROBO_API int grobo_bus_tx(grobo_bus *bus, uint8_t *buf, size_t cap, int64_t now_us);

/** When to call step and tx next, though no byte comes; GROBO_NEVER_US: no need. */
GROBO_API int64_t grobo_bus_deadline(const grobo_bus *bus, int64_t now_us);

/**
 * Keeps [at_us, at_us + duration_us) free for a motion frame: no user's request and no sensing is
 * started that would not be over before at_us, nor inside the span. One span at a time; a new call
 * replaces it; GROBO_NEVER_US removes it.
 */
GROBO_API void grobo_bus_reserve(grobo_bus *bus, int64_t at_us, uint32_t duration_us);

/** True if this transaction, started at now_us, would be over before the reserved span. */
GROBO_API bool grobo_bus_fits(const grobo_bus *bus, int64_t now_us, const grobo_txn *txn);

/**
 * grobo_protocol.several: takes a packet that may be one of several replies to the frame on the
 * wire, or NULL: their time is over. Replies are known by id, tag and length. When the last one of
 * the list has come no other is waited for, as servos answer in the order of the list. Called by
 * the bus only.
 * @return true when it was for such a frame
 */
GROBO_API bool grobo_bus_several(grobo_bus *bus, const grobo_packet *packet);

/** When the line will be free for the next frame, as far as is known: now_us if it is. */
GROBO_API int64_t grobo_bus_free_at(const grobo_bus *bus, int64_t now_us);

/** Transactions that wait or are on the wire. */
GROBO_API int grobo_bus_pending(const grobo_bus *bus);

/** Wire time of one transaction, computed. */
typedef struct grobo_bus_cost {
    uint32_t request_us; /**< host's line, request */
    uint32_t servo_us;   /**< servo bus behind the board: request, return delay and reply; 0 when
                              there is no board */
    uint32_t reply_us;   /**< host's line, reply (without a board: return delay included) */
    uint32_t total_us;   /**< from the first byte of the request until the line is free again */
    uint32_t timeout_us; /**< after how long a first attempt has failed, as things are now */
} grobo_bus_cost;

/** What a transaction costs on this bus, whether submitted or not. */
GROBO_API void grobo_bus_cost_of(const grobo_bus *bus, const grobo_txn *txn, grobo_bus_cost *cost);

GROBO_END_DECLS

#endif
