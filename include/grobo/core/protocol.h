/* SPDX-License-Identifier: MIT */
/**
 * @file protocol.h
 * @brief How servos talk, as a table: what the bus (bus.h) asks a family of servos.
 *
 * The bus knows when something is sent and what it waits for; a protocol knows what bytes mean. A
 * table is const data and pure functions, so that one serves any number of lines and threads. The
 * library has grobo_rs30x_protocol (rs30x.h), grobo_board_protocol (board.h: the same servos behind
 * GR001's board), grobo_dxl2_protocol, grobo_dxl1_protocol, grobo_feetech_protocol,
 * grobo_lx16a_protocol and grobo_ics_protocol, each in the header of its family.
 *
 * No function of a table is given NULL. n is the number of bytes, cap the room of a buffer. What
 * builds a frame returns its bytes, or GROBO_ERR_SPACE.
 */
#ifndef GROBO_CORE_PROTOCOL_H
#define GROBO_CORE_PROTOCOL_H

#include <stddef.h>

#include <grobo/types.h>

GROBO_BEGIN_DECLS

/* ---- replies ------------------------------------------------------------------------------- */

/** What a frame is answered by. */
typedef enum grobo_reply_kind {
    GROBO_REPLY_NONE = 0,   /**< nothing */
    GROBO_REPLY_ACK = 1,    /**< one byte without a name (RS30x: 07 or 08) */
    GROBO_REPLY_RETURN = 2, /**< packets of these ids and lengths: one, or several by one frame */
    GROBO_REPLY_ANY = 3     /**< packets of any servo that is there, until the time is over */
} grobo_reply_kind;

/** The reply to expect. Of GROBO_REPLY_NONE and _ACK only kind and bytes count. */
typedef struct grobo_reply {
    grobo_reply_kind kind;
    uint8_t id;       /**< of the servo; of several, or of one packet for all: the id of all */
    uint8_t tag;      /**< what a reply repeats of the request beside its id (RS30x: the address;
                           0 where a reply repeats nothing) */
    uint8_t count;    /**< packets: 1, or at most GROBO_REPLIES_MAX of several; of ANY 0 */
    uint16_t address; /**< first register asked for; the bus hands it on in grobo_packet.address */
    uint16_t length;  /**< data bytes of each packet; of several, of the first */
    uint32_t bytes;   /**< on the wire, all packets together; of ANY 0 */
} grobo_reply;

/* ---- packets ------------------------------------------------------------------------------- */

/** What came off the line, whatever the family. */
typedef enum grobo_packet_kind {
    GROBO_PACKET_COMMAND, /**< of a host: an echo, or another host's */
    GROBO_PACKET_RETURN,  /**< of a servo, with its name */
    GROBO_PACKET_ACK      /**< of a servo, without one */
} grobo_packet_kind;

/** A packet taken apart. */
typedef struct grobo_packet {
    grobo_packet_kind kind;
    bool refused;        /**< the servo says that it did not do what it was told */
    uint8_t id;          /**< RETURN: the servo's */
    uint8_t flags;       /**< RETURN: the servo's status, in bits of its family */
    uint16_t address;    /**< RETURN: first register. unpack() gives what the packet repeats of its
                              request, as grobo_reply.tag; the bus the address asked for */
    const uint8_t *data; /**< borrowed */
    size_t data_bytes;   /**< number of them */
} grobo_packet;

/** Packets that are believed, or-ed. What is not, is rubbish. */
#define GROBO_ACCEPT_COMMANDS 0x1u /**< of a host */
#define GROBO_ACCEPT_RETURNS 0x2u  /**< of servos */
/** Packets without a name, between others. */
#define GROBO_ACCEPT_ACKS 0x4u

/** What a framer met since it was initialised. Bytes in = bytes of frames + dropped + buffered. */
typedef struct grobo_framer_stats {
    uint32_t frames;        /**< good ones returned */
    uint32_t frame_bytes;   /**< their bytes */
    uint32_t dropped_bytes; /**< rubbish skipped while looking for a frame */
    uint32_t bad_sums;      /**< frames whole in form whose sum was wrong */
} grobo_framer_stats;

/** The buffer behind every push parser. All fields are private but stats. */
typedef struct grobo_framer {
    grobo_framer_stats stats; /**< read freely */
    /* private */
    uint16_t used;  /* bytes in buf */
    uint16_t taken; /* of them, those of the frame returned last */
    bool ending;    /* what is incomplete now will never be completed */
    uint8_t buf[GROBO_FRAME_MAX_BYTES];
} grobo_framer;

/* ---- the table ----------------------------------------------------------------------------- */

/**
 * A board between the host and the servos: it keeps a frame until it is whole and forwards the
 * packet in it. It answers in the order in which it was asked.
 */
typedef struct grobo_relay {
    size_t packet_max_bytes; /**< longest packet that fits in a frame */
    /** Puts a command packet in a frame; packet may lie in buf. @return size or an error. */
    int (*wrap)(const uint8_t *packet, size_t n, uint8_t *buf, size_t cap);
    /** The packet in a frame. @return its bytes, 0 for a frame that asks the board itself and
     *  changes nothing, or an error: no frame, or the board does something on its own. */
    int (*unwrap)(const uint8_t *frame, size_t n, const uint8_t **packet);
    /** Bytes that the board puts on the servos' bus for a frame; 0 for its own. */
    size_t (*forwarded)(const uint8_t *frame, size_t n);
    /** The frame that asks whether the board is there. @return size or an error. */
    int (*check)(uint8_t *buf, size_t cap);
    /** The frame that plays motion `number` of the board's memory, or scenario. */
    int (*stored)(bool scenario, uint8_t number, uint8_t *buf, size_t cap);
} grobo_relay;

struct grobo_bus;

/**
 * What a bus does with several replies to one frame: grobo_bus_several() (bus.h). A table that has
 * no such frames has NULL, and then a program is linked without it.
 */
typedef bool (*grobo_several)(struct grobo_bus *bus, const grobo_packet *packet);

/** A protocol. Everything but `relay`, `several` and `reply_at` must be there. */
typedef struct grobo_protocol {
#if !GROBO_TABLES_FIXED
    size_t size; /**< GROBO_TABLE() */
#endif
    const char *name; /**< "RS30x" */
    /**
     * Judges n > 0 bytes: the size of the good packet that they start with; 0 when they may start
     * one and more are needed; GROBO_ERR_FRAME when they cannot, GROBO_ERR_CHECKSUM when only the
     * sum is wrong. A size is never above GROBO_FRAME_MAX_BYTES.
     * @param accept GROBO_ACCEPT_... or-ed
     */
    int (*measure)(const uint8_t *bytes, size_t n, unsigned accept);
    /** Takes the packet of n bytes apart that measure() found; packet->data points into bytes,
     *  which this may change (to take stuffing out). What tells nothing worth believing, as a
     *  servo that received a broken request, is a GROBO_PACKET_COMMAND. */
    void (*unpack)(uint8_t *bytes, size_t n, grobo_packet *packet);
    /** What a frame of n bytes is answered by. @return bytes of the reply (0: none), or
     *  GROBO_ERR_FRAME, GROBO_ERR_CHECKSUM: no whole frame, GROBO_ERR_ARG: it asks for nothing
     *  that there is, GROBO_ERR_CAP: for more than GROBO_REPLIES_MAX */
    int (*reply_to)(const uint8_t *frame, size_t n, grobo_reply *reply);
    /** Of a frame that reply_to() said to have several replies: id, tag and length of reply k,
     *  0..count-1, in the order in which servos answer. NULL with `several`. */
    void (*reply_at)(const uint8_t *frame, size_t n, unsigned k, grobo_reply *reply);
    grobo_several several;
    uint32_t return_delay_us; /**< before a servo replies, as it leaves the factory */
    uint32_t call_us;         /**< of GROBO_REPLY_ANY: how long the servos may take */
    grobo_parity parity;      /**< of its lines */
    uint8_t id_min, id_max;   /**< ids that a servo can have */
    const grobo_relay *relay; /**< the board in between; NULL: the line is the servos' own bus */
} grobo_protocol;

GROBO_END_DECLS

#endif
