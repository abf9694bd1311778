/* SPDX-License-Identifier: MIT */
/**
 * @file words.h
 * @brief What frames of a family of servos say, for those who read along on a line.
 *
 * A protocol (protocol.h) knows what the bus asks. This knows the rest: frames that the bus never
 * sends, what stands in a frame, and what is wrong with one that servos would not take. A family is
 * a const table of functions without state. What a frame says goes into one form, of which
 * `grctl decode` makes text and JSON. Firmware is linked without it: only grobo_families()
 * (robot_file.h) names these tables.
 *
 * No function of a table is given NULL. n is the number of bytes of a buffer.
 */
#ifndef GROBO_CORE_WORDS_H
#define GROBO_CORE_WORDS_H

#include <grobo/core/protocol.h>
#include <grobo/core/registers.h>
#include <grobo/model.h>

GROBO_BEGIN_DECLS

/* ---- what a frame says ----------------------------------------------------------------------- */

#define GROBO_TELEGRAM_PARTS_MAX 256 /**< servos that one frame names */
#define GROBO_TELEGRAM_STATUS_MAX 9  /**< things that a reply reports */
#define GROBO_TELEGRAM_TEXT_BYTES 48 /**< of a text, with its NUL */
#define GROBO_WORDS_FRAME_BYTES 1024 /**< longest frame that is read */
#define GROBO_WORDS_SENT_MAX 4       /**< requests that may still be answered */

/** One servo's share of a frame: registers that are asked for, or bytes of them. */
typedef struct grobo_telegram_part {
    int id;
    int address;         /**< first register; -1: not known which registers they are */
    int length;          /**< bytes */
    const uint8_t *data; /**< NULL: they are asked for */
} grobo_telegram_part;

/** What a reply reports of its servo. */
typedef struct grobo_telegram_status {
    const char *key;  /**< for scripts; NULL: the text */
    const char *text; /**< for people */
} grobo_telegram_status;

/** A board between host and servos has a frame of its own around a packet, or instead of one. */
typedef struct grobo_telegram_relay {
    const char *kind;                     /**< "relay", "slot": for scripts; NULL: no such frame */
    char lead[GROBO_TELEGRAM_TEXT_BYTES]; /**< in front of what the packet says */
    int number;                           /**< of a stored motion; -1: none */
    int asked_bytes; /**< bytes that the board is to wait for; -1: none, or as many as come */
} grobo_telegram_relay;

/** What a frame says. Texts that are pointers are constant. */
typedef struct grobo_telegram {
    bool reply;
    bool all;           /**< to all servos; then id says nothing */
    int id;             /**< -1: it names none */
    const char *action; /**< "write", "sync read", "returns"; NULL: see code */
    unsigned code;      /**< instruction, flags, or the error of a reply */
    bool shares;        /**< each part is a servo's own */
    size_t n_parts;
    grobo_telegram_part part[GROBO_TELEGRAM_PARTS_MAX];
    size_t n_status;
    grobo_telegram_status status[GROBO_TELEGRAM_STATUS_MAX];
    char trouble[GROBO_TELEGRAM_TEXT_BYTES]; /**< why it is no good frame though its sum is right */
    unsigned sum;
    int right_sum; /**< -1: not known */
    int sum_bytes; /**< 0: frames of the family have no sum */
    /* Of families whose frames say more. */
    const char *kind;    /**< "long": for scripts; NULL: "command" or "return" */
    bool bare;           /**< what it writes means nothing: its action is all */
    bool headed;         /**< address, length and count stand in the frame, as header[] */
    uint8_t header[3];   /**< those */
    int address, length; /**< registers that it asks for or returns, of a headed one */
    const char *then;    /**< what it does behind a write, or NULL */
    const char *remark;  /**< what is odd about it, or NULL */
    const char *plain;   /**< all that it says, or NULL: then nothing else is set */
    bool bad;            /**< `plain` is a refusal, or no packet */
    const uint8_t *rest; /**< n_rest bytes behind `plain`, which are no packet */
    size_t n_rest;
    grobo_telegram_relay relay;
    uint8_t data[GROBO_WORDS_FRAME_BYTES]; /**< room for what parts point to */
} grobo_telegram;

/* ---- how it is said -------------------------------------------------------------------------- */

/** A request, to know its reply by. */
typedef struct grobo_words_sent {
    uint8_t bytes[GROBO_WORDS_FRAME_BYTES];
    size_t n; /**< 0: none */
} grobo_words_sent;

/** What a host's frames may be, or-ed, where a family has a board between. */
#define GROBO_WORDS_BOARD 0x1u /**< those of the board */
#define GROBO_WORDS_BUS 0x2u   /**< packets for servos */

/** What a family looks for in bytes. */
typedef struct grobo_words_look {
    const uint8_t *bytes;
    size_t n;
    bool from_host, from_robot;   /**< both: nobody knows */
    unsigned wiring;              /**< GROBO_WORDS_... of a host */
    const grobo_words_sent *sent; /**< GROBO_WORDS_SENT_MAX of them, the last one first, or NULL */
} grobo_words_look;

/** What was found. */
typedef struct grobo_words_frame {
    bool reply, echo, sum_ok;
    bool relay;                   /**< a frame of a board */
    const grobo_words_sent *sent; /**< the request that a reply answers; NULL: not known */
} grobo_words_frame;

/** How a series of servos talks. Only `peek`, `answers` and `explain` must be there. */
typedef struct grobo_words {
    const char *name;  /**< of --family */
    const char *title; /**< for people */
    const grobo_servo_table *table;
    const grobo_protocol *protocol;
    bool last_model; /**< a frame is read by the last model of the table, whoever it is for; else by
                          the servo's own, or the first */
    bool numbered;   /**< registers are called by their numbers, and values are not judged */
    bool says_request; /**< a reply says what it answers, however many requests ago */
    /** The frame that look->bytes begin with, whatever its sum: its size, 0 when more bytes are
     *  needed, GROBO_ERR_FRAME when none begins here. *found comes zeroed. */
    int (*peek)(const grobo_words_look *look, grobo_words_frame *found);
    /** Why bytes that begin no frame are none; NULL: nothing to say. */
    const char *(*why)(const uint8_t *bytes, size_t n);
    /** What a command is answered by, where the protocol does not tell of all; NULL: it does. */
    int (*reply_to)(const uint8_t *frame, size_t n, grobo_reply *reply);
    /** The same of the packet in a board's frame that is to wait for another number of bytes. */
    int (*carried)(const uint8_t *frame, size_t n, grobo_reply *reply);
    /** Whether a good frame answers a request. */
    bool (*answers)(const grobo_words_sent *sent, const uint8_t *bytes, size_t n);
    /** Takes a whole frame apart; *to comes zeroed. */
    void (*explain)(const uint8_t *bytes, size_t n, const grobo_words_frame *as,
                    grobo_telegram *to);
    /** What no servo can do with a whole frame of a good sum, beside what its registers say: a code
     *  ("request", "range", "relay") with the reason, or NULL: nothing. */
    const char *(*offence)(const uint8_t *bytes, size_t n, char *why, size_t cap);
    /** What a value means beside its unit, or NULL. */
    const char *(*remark)(const grobo_servo_register *reg, int32_t value);
} grobo_words;

GROBO_END_DECLS

#endif
