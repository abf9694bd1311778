/* SPDX-License-Identifier: MIT */
/**
 * @file rs30x.h
 * @brief Packets and memory map of Futaba RS30x command servos.
 *
 * Both ends of the wire: a host builds commands and parses returns, a servo (firmware, simulator)
 * parses commands and builds returns. Everything works on the caller's bytes; no allocation, no
 * clock, no global state. Functions are re-entrant; one parser must not be used by two threads at
 * the same time.
 *
 * Sources of the constants: Futaba RS301CR/RS302CD manual v1.0 (packets p.11-15, memory map
 * p.17-29), RS204MD manual p.23-24 (NACK, second spelling of the factory reset).
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_RS30X_H
#define GROBO_CORE_RS30X_H

#include <grobo/core/protocol.h>
#include <grobo/core/registers.h>

GROBO_BEGIN_DECLS

/** Bytes of a packet beside its data: header, id, flags, address, length, count, sum. */
#define GROBO_RS30X_OVERHEAD_BYTES 8

/** Longest packet built or parsed, in both directions (28 servos with goal and time fit in it). */
#define GROBO_RS30X_PACKET_MAX_BYTES GROBO_REPLY_MAX_BYTES

/** Highest id of a servo; the lowest is 1. */
#define GROBO_RS30X_ID_MAX 127

/** Address of every servo; no servo replies to it. */
#define GROBO_RS30X_ID_ALL 255

/** RS30x servos straight on their bus. */
GROBO_API const grobo_protocol *grobo_rs30x_protocol(void);

/** The byte that says "done". */
#define GROBO_RS30X_ACK 0x07
/** The byte that says "refused" (documented for RS204MD only). */
#define GROBO_RS30X_NACK 0x08

/* ---- flags of a command --------------------------------------------------------------------- */

/** Write No.4-29 to flash: takes a second or more, power must stay on. */
#define GROBO_RS30X_FLASH 0x40
/** Reboot: allow two seconds. With GROBO_RS30X_FLASH in one packet on RS301/302 only. */
#define GROBO_RS30X_REBOOT 0x20
/** Factory reset of No.4-29; the id becomes 1. */
#define GROBO_RS30X_FACTORY 0x10

/** Low nibble of the flags: what comes back. */
typedef enum grobo_rs30x_want {
    GROBO_RS30X_WANT_NOTHING = 0x0, /**< no reply */
    GROBO_RS30X_WANT_ACK = 0x1,     /**< one byte, ACK */
    GROBO_RS30X_WANT_0_29 = 0x3,    /**< No.0-29 */
    GROBO_RS30X_WANT_30_59 = 0x5,   /**< No.30-59 */
    GROBO_RS30X_WANT_20_29 = 0x7,   /**< No.20-29 */
    GROBO_RS30X_WANT_42_59 = 0x9,   /**< No.42-59, the present values */
    GROBO_RS30X_WANT_30_41 = 0xB,   /**< No.30-41 */
    GROBO_RS30X_WANT_60_127 = 0xD,  /**< No.60-127, not on RS301/302 */
    GROBO_RS30X_WANT_GIVEN = 0xF    /**< the address and length given in the command */
} grobo_rs30x_want;

/* ---- flags of a return packet --------------------------------------------------------------- */

/** Temperature limit reached, torque was cut; resume by writing No.36. */
#define GROBO_RS30X_STATUS_OVERHEATED 0x80
/** Temperature alarm. */
#define GROBO_RS30X_STATUS_HOT 0x20
/** Writing to flash failed. */
#define GROBO_RS30X_STATUS_FLASH_ERROR 0x08
/** The command could not be processed. */
#define GROBO_RS30X_STATUS_REFUSED 0x02

/* ---- memory map ----------------------------------------------------------------------------- */

/** Addresses of registers; grobo_rs30x_table has names, units and ranges. */
typedef enum grobo_rs30x_address {
    GROBO_RS30X_MODEL = 0,
    GROBO_RS30X_FIRMWARE = 2,
    GROBO_RS30X_ID = 4,
    GROBO_RS30X_REVERSE = 5,
    GROBO_RS30X_BAUD = 6,
    GROBO_RS30X_DELAY = 7,
    GROBO_RS30X_CW_LIMIT = 8,
    GROBO_RS30X_CCW_LIMIT = 10,
    GROBO_RS30X_TEMPERATURE_LIMIT = 14,
    GROBO_RS30X_SILENCE_TORQUE = 22,
    GROBO_RS30X_WARM_UP_TIME = 23,
    GROBO_RS30X_CW_MARGIN = 24,
    GROBO_RS30X_CCW_MARGIN = 25,
    GROBO_RS30X_CW_SLOPE = 26,
    GROBO_RS30X_CCW_SLOPE = 27,
    GROBO_RS30X_PUNCH = 28,
    GROBO_RS30X_GOAL = 30,
    GROBO_RS30X_GOAL_TIME = 32,
    GROBO_RS30X_MAX_TORQUE = 35,
    GROBO_RS30X_TORQUE = 36,
    GROBO_RS30X_POSITION = 42,
    GROBO_RS30X_TIME = 44,
    GROBO_RS30X_SPEED = 46,
    GROBO_RS30X_CURRENT = 48,
    GROBO_RS30X_TEMPERATURE = 50,
    GROBO_RS30X_VOLTAGE = 52,
    GROBO_RS30X_ADDRESS_END = GROBO_REGISTERS /**< one past the last address */
} grobo_rs30x_address;

/** Models, as register MODEL gives them. */
typedef enum grobo_rs30x_model {
    GROBO_RS30X_RS301CR = 0x3010,
    GROBO_RS30X_RS302CD = 0x3020,
    GROBO_RS30X_RS303MR = 0x3030,
    GROBO_RS30X_RS304MD = 0x3040
} grobo_rs30x_model;

/** Registers of the series, and its models. SILENCE_TORQUE and WARM_UP_TIME came with RS303MR. */
GROBO_API const grobo_servo_table *grobo_rs30x_table(void);

/** The factory's code of register BAUD: 115200 bps. */
#define GROBO_RS30X_BAUD_CODE_DEFAULT 7

/** Time a servo waits before it returns, in us, for a value of register DELAY: 100 + 50 n. */
#define GROBO_RS30X_DELAY_US(n) (100 + 50 * (n))

/* ---- packets -------------------------------------------------------------------------------- */

/** What a packet is. */
typedef enum grobo_rs30x_kind {
    GROBO_RS30X_SHORT,    /**< FA AF, one servo (or all, with id 255) */
    GROBO_RS30X_LONG,     /**< FA AF with id 0: other data for each of several servos */
    GROBO_RS30X_RETURN,   /**< FD DF */
    GROBO_RS30X_ACK_BYTE, /**< the single byte 07 */
    GROBO_RS30X_NACK_BYTE /**< the single byte 08 */
} grobo_rs30x_kind;

/** A packet taken apart, or to be put together. Fields as on the wire. */
typedef struct grobo_rs30x_packet {
    grobo_rs30x_kind kind;
    uint8_t id;          /**< SHORT 1..127 or 255; LONG 0; RETURN 1..127 */
    uint8_t flags;       /**< of a command or of a return */
    uint8_t address;     /**< first register */
    uint8_t length;      /**< SHORT, RETURN: data bytes; LONG: bytes per servo, its id included */
    uint8_t count;       /**< SHORT: 1 with data, 0 for a read; LONG: servos; RETURN: 1 */
    const uint8_t *data; /**< borrowed; LONG: {id data}... */
    size_t data_bytes;   /**< number of them */
} grobo_rs30x_packet;

/**
 * Puts a packet together. packet->data may lie in buf where the data goes (offset 7).
 * @return size, or GROBO_ERR_ARG (field out of range, data_bytes not what length and count say),
 *         GROBO_ERR_CAP (longer than GROBO_RS30X_PACKET_MAX_BYTES), GROBO_ERR_SPACE
 */
GROBO_API int grobo_rs30x_build(const grobo_rs30x_packet *packet, uint8_t *buf, size_t cap);

/** Read of length bytes from address: flags 0F. Errors as grobo_rs30x_build. */
GROBO_API int grobo_rs30x_read(uint8_t id, uint8_t address, uint8_t length, uint8_t *buf,
                               size_t cap);

/** Request of one of the fixed blocks by its nibble (address 0, length 0, count 1). */
GROBO_API int grobo_rs30x_read_block(uint8_t id, grobo_rs30x_want want, uint8_t *buf, size_t cap);

/** Write of one byte; flags may ask for a reply or for flash and reboot. */
GROBO_API int grobo_rs30x_write_u8(uint8_t id, uint8_t flags, uint8_t address, uint8_t value,
                                   uint8_t *buf, size_t cap);

/** Write of 16 bits; a negative value is given as its two's complement. */
GROBO_API int grobo_rs30x_write_u16(uint8_t id, uint8_t flags, uint8_t address, uint16_t value,
                                    uint8_t *buf, size_t cap);

/** A goal of one servo. */
typedef struct grobo_rs30x_goal {
    uint8_t id;       /**< 1..127 */
    int16_t pos_ddeg; /**< -1500..1500 */
    uint16_t time_cs; /**< duration of the move in 10 ms, 0..16383; 0 at full speed */
} grobo_rs30x_goal;

/** Goal and time of one servo (short packet; id 255: all). GROBO_ERR_LIMIT outside the ranges. */
GROBO_API int grobo_rs30x_write_goal(const grobo_rs30x_goal *goal, uint8_t *buf, size_t cap);

/** Goals and times of n servos in one long packet. GROBO_ERR_LIMIT outside the ranges. */
GROBO_API int grobo_rs30x_write_goals(const grobo_rs30x_goal *goals, size_t n, uint8_t *buf,
                                      size_t cap);

/** One byte for one servo, in a long packet. */
typedef struct grobo_rs30x_byte {
    uint8_t id;    /**< 1..127 */
    uint8_t value; /**< what is written */
} grobo_rs30x_byte;

/** The register at address of n servos in one long packet: torques, torque limits. */
GROBO_API int grobo_rs30x_write_bytes(uint8_t address, const grobo_rs30x_byte *bytes, size_t n,
                                      uint8_t *buf, size_t cap);

/** GROBO_RS30X_FLASH, GROBO_RS30X_REBOOT or both, with nothing else (address FF). */
GROBO_API int grobo_rs30x_control(uint8_t id, uint8_t flags, uint8_t *buf, size_t cap);

/** The two spellings of a factory reset that the manuals print. */
typedef enum grobo_rs30x_reset_form {
    GROBO_RS30X_RESET_WITH_DATA, /**< RS301CR/RS302CD manual: 9 bytes, data FF */
    GROBO_RS30X_RESET_BARE       /**< RS204MD manual: 8 bytes */
} grobo_rs30x_reset_form;

/** Factory reset of No.4-29. */
GROBO_API int grobo_rs30x_factory_reset(uint8_t id, grobo_rs30x_reset_form form, uint8_t *buf,
                                        size_t cap);

/** The spellings of an ACK request without data seen in drivers: address, length, count. */
typedef enum grobo_rs30x_ping_form {
    GROBO_RS30X_PING_FF_0_0,
    GROBO_RS30X_PING_0_0_0,
    GROBO_RS30X_PING_FF_1_0
} grobo_rs30x_ping_form;

/** ACK request without data: is this servo there? */
GROBO_API int grobo_rs30x_ping(uint8_t id, grobo_rs30x_ping_form form, uint8_t *buf, size_t cap);

/* ---- replies -------------------------------------------------------------------------------- */

/**
 * What a command packet (n bytes, one whole packet) will be answered by.
 * @return bytes of the reply (0: none); GROBO_ERR_FRAME or GROBO_ERR_CHECKSUM when the bytes are
 *         no whole command packet, GROBO_ERR_ARG when it asks for registers that do not exist
 */
GROBO_API int grobo_rs30x_reply_to(const uint8_t *packet, size_t n, grobo_reply *reply);

/* ---- frames ---------------------------------------------------------------------------------
 * A packet as it goes over the line: itself on a servo bus, in a frame of the board in between.
 * They return the size or the error of the builder above. buf needs GROBO_FRAME_MAX_BYTES. */

/** Goal of one servo (14 bytes through the board). */
GROBO_API int grobo_frame_goal(const grobo_protocol *protocol, const grobo_rs30x_goal *goal,
                               uint8_t *buf, size_t cap);

/** Goals of n servos in one frame (110 bytes through the board for 20; 23 fit at most). */
GROBO_API int grobo_frame_goals(const grobo_protocol *protocol, const grobo_rs30x_goal *goals,
                                size_t n, uint8_t *buf, size_t cap);

/** Torque of one servo, or of all with id 255 (11 bytes through the board). */
GROBO_API int grobo_frame_torque(const grobo_protocol *protocol, uint8_t id, grobo_torque torque,
                                 uint8_t *buf, size_t cap);

/** Torques (values of grobo_torque) of n servos in one frame (50 bytes for 20). */
GROBO_API int grobo_frame_torques(const grobo_protocol *protocol, const grobo_rs30x_byte *torques,
                                  size_t n, uint8_t *buf, size_t cap);

/** First register of the state block that GR001's programs read: No.36-53. */
#define GROBO_STATE_ADDRESS 36
/** Registers of that block; its return packet has 26 bytes. */
#define GROBO_STATE_BYTES 18

/** Read of length registers from address (11 bytes through the board). */
GROBO_API int grobo_frame_read(const grobo_protocol *protocol, uint8_t id, uint8_t address,
                               uint8_t length, uint8_t *buf, size_t cap);

/** Any command packet that is already built, for this line. packet may lie in buf. */
GROBO_API int grobo_frame_wrap(const grobo_protocol *protocol, const uint8_t *packet, size_t n,
                               uint8_t *buf, size_t cap);

/* ---- parser --------------------------------------------------------------------------------- */

/**
 * A push parser of packets: takes any bytes in any split, returns packets whose header, id,
 * flags, address, length, count and sum are right, and finds the next one after rubbish by going
 * back to the byte after the false start. All fields are private but framer.stats.
 */
typedef struct grobo_rs30x_parser {
    grobo_framer framer;
    unsigned accept;
} grobo_rs30x_parser;

/** Makes a parser ready; accept: GROBO_ACCEPT_... or-ed. Counters start at zero. */
GROBO_API void grobo_rs30x_parser_init(grobo_rs30x_parser *parser, unsigned accept);

/**
 * Takes bytes. After a call of feed, call next until it gives 0, then feed the rest:
 * @code
 *   while (n > 0) {
 *       size_t took = grobo_rs30x_parser_feed(&parser, bytes, n);
 *       bytes += took, n -= took;
 *       while (grobo_rs30x_parser_next(&parser, &packet) > 0) use(&packet);
 *   }
 * @endcode
 * @return bytes taken; at least 1 of n > 0 when next gave 0 before
 */
GROBO_API size_t grobo_rs30x_parser_feed(grobo_rs30x_parser *parser, const uint8_t *bytes,
                                         size_t n);

/**
 * Returns the next packet. packet->data points into the parser and is valid until the next call
 * of next, feed or reset.
 * @return 1 with a packet, 0 when more bytes are needed (packet untouched)
 */
GROBO_API int grobo_rs30x_parser_next(grobo_rs30x_parser *parser, grobo_rs30x_packet *packet);

/**
 * Says that the line fell silent (or the file ended): what is incomplete now stays so. The calls
 * of next that follow return what is whole behind a false start and drop the rest. The mark
 * goes with the first 0 from next.
 */
GROBO_API void grobo_rs30x_parser_end(grobo_rs30x_parser *parser);

/** Forgets what is buffered (it counts as dropped); counters stay. */
GROBO_API void grobo_rs30x_parser_reset(grobo_rs30x_parser *parser);

/** Bytes taken and neither returned nor dropped yet. */
GROBO_API size_t grobo_rs30x_parser_pending(const grobo_rs30x_parser *parser);

/**
 * Looks at the packet that n bytes start with, without a parser: for what shows the packets of
 * others, those with a wrong sum too. packet->data points into bytes.
 * @param accept GROBO_ACCEPT_... or-ed
 * @param[out] sum_ok whether the sum is right; true for ACK and NACK
 * @return size of the packet; 0 when more bytes are needed, GROBO_ERR_FRAME when none starts here
 *         (then nothing is written)
 */
GROBO_API int grobo_rs30x_peek(const uint8_t *bytes, size_t n, unsigned accept,
                               grobo_rs30x_packet *packet, bool *sum_ok);

/* ---- state of a servo ----------------------------------------------------------------------- */

/** Which fields of a grobo_rs30x_state were in the block that was read; or-ed. */
#define GROBO_RS30X_HAS_TORQUE 0x01u      /**< state of the torque */
#define GROBO_RS30X_HAS_POSITION 0x02u    /**< present angle */
#define GROBO_RS30X_HAS_TIME 0x04u        /**< time since the goal */
#define GROBO_RS30X_HAS_SPEED 0x08u       /**< present speed */
#define GROBO_RS30X_HAS_CURRENT 0x10u     /**< present current */
#define GROBO_RS30X_HAS_TEMPERATURE 0x20u /**< temperature */
#define GROBO_RS30X_HAS_VOLTAGE 0x40u     /**< supply voltage */

/** The present values of a servo, No.36 and No.42-53. Fields that were not read are 0. */
typedef struct grobo_rs30x_state {
    uint32_t voltage_mv;   /**< supply */
    uint16_t time_cs;      /**< since the move began, 10 ms */
    uint16_t current_ma;   /**< motor current */
    int16_t pos_ddeg;      /**< present position */
    int16_t speed_dps;     /**< present speed, deg/s */
    int16_t temperature_c; /**< of the circuit */
    uint8_t torque;        /**< a grobo_torque */
    uint8_t has;           /**< GROBO_RS30X_HAS_... */
} grobo_rs30x_state;

/**
 * Takes apart a block of n registers from address: No.36-53, No.42-59, a few of them.
 * @return number of fields found, 0 when the block holds none of them whole
 */
GROBO_API int grobo_rs30x_state_decode(uint8_t address, const uint8_t *data, size_t n,
                                       grobo_rs30x_state *state);

GROBO_END_DECLS

#endif
