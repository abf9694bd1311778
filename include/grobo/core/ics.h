/* SPDX-License-Identifier: MIT */
/**
 * @file ics.h
 * @brief Packets of Kondo KRS servos, ICS 3.5 and 3.6.
 *
 * A line has 8 data bits and even parity, and returns what is sent on most adapters. Frames have no
 * header, length or sum: bit 7 marks the first byte of a command, and what comes back is known by
 * what was sent. Both ends of the wire, on the caller's bytes; no allocation, no clock, no state.
 *
 * Source of the constants: the maker's ICS3.5 Software Manual; reading of positions (3.6): the
 * maker's Arduino library IcsBaseClass.
 */
#ifndef GROBO_CORE_ICS_H
#define GROBO_CORE_ICS_H

#include <grobo/core/protocol.h>
#include <grobo/core/registers.h>

GROBO_BEGIN_DECLS

/** Highest id. */
#define GROBO_ICS_ID_MAX 31
/** Bytes of the EEPROM on the wire: 32, each as two nibbles. */
#define GROBO_ICS_EEPROM_BYTES 64
/** Longest frame: the EEPROM. */
#define GROBO_ICS_FRAME_MAX_BYTES 66
/** Positions: 270 degrees from the least to the largest. */
#define GROBO_ICS_POSITION_MIN 3500
#define GROBO_ICS_POSITION_MIDDLE 7500 /**< 0 degrees */
#define GROBO_ICS_POSITION_MAX 11500   /**< the largest */
/** The position that takes the torque. */
#define GROBO_ICS_FREE 0
/** Bit of the flags in the EEPROM, set by the servo itself: it has no torque. */
#define GROBO_ICS_FLAG_FREE 0x02

/** The first three bits of a command. */
typedef enum grobo_ics_command {
    GROBO_ICS_POSITION = 0x80, /**< goal; answered with the present position */
    GROBO_ICS_READ = 0xA0,
    GROBO_ICS_WRITE = 0xC0,
    GROBO_ICS_ID = 0xE0 /**< of the one servo on the line: item 0 reads, 1 writes */
} grobo_ics_command;

/** Items of READ and WRITE. */
typedef enum grobo_ics_item {
    GROBO_ICS_EEPROM = 0,
    GROBO_ICS_STRETCH = 1,
    GROBO_ICS_SPEED = 2,
    GROBO_ICS_CURRENT = 3,      /**< read: now; write: limit */
    GROBO_ICS_TEMPERATURE = 4,  /**< read: now, small is hot; write: limit */
    GROBO_ICS_POSITION_ITEM = 5 /**< read only, ICS 3.6; ICS 3.5 is silent */
} grobo_ics_item;

/** A frame taken apart, or to be put together. */
typedef struct grobo_ics_packet {
    bool reply;
    uint8_t command; /**< grobo_ics_command */
    uint8_t id;
    uint8_t item;        /**< READ, WRITE: grobo_ics_item; ID: 0 read, 1 write */
    uint16_t value;      /**< a position 0..16383, or an item's value 0..127 */
    const uint8_t *data; /**< EEPROM: 64 nibbles, borrowed; else NULL */
} grobo_ics_packet;

/**
 * Judges n > 0 bytes of a host: the size of the command that they start with; 0 when they may start
 * one and more are needed; GROBO_ERR_FRAME when they cannot.
 */
GROBO_API int grobo_ics_measure(const uint8_t *bytes, size_t n);

/**
 * As grobo_ics_measure(), for the reply to the command sent, behind its echo. The servo with id 0
 * may answer a position with the command's own first byte, as ICS 2.0 did.
 * @return GROBO_ERR_ARG where sent is no command
 */
GROBO_API int grobo_ics_answer(const uint8_t *sent, size_t sent_bytes, const uint8_t *bytes,
                               size_t n);

/** Takes a command, or the reply to the command sent, of n bytes apart; packet->data points into
 *  it. sent NULL: a command. @return GROBO_OK, or GROBO_ERR_FRAME: no frame of n bytes. */
GROBO_API int grobo_ics_parse(const uint8_t *sent, size_t sent_bytes, const uint8_t *frame,
                              size_t n, grobo_ics_packet *packet);

/** Puts a frame together. @return size, or GROBO_ERR_ARG (an id, item or value that is none),
 *  GROBO_ERR_SPACE. */
GROBO_API int grobo_ics_build(const grobo_ics_packet *packet, uint8_t *buf, size_t cap);

/** The protocol, for the bus. The maker prints no return delay: 500 us is assumed. */
GROBO_API const grobo_protocol *grobo_ics_protocol(void);

/**
 * Their values, and models. The servos know no addresses and do not tell their model: both numbers
 * are this library's. 0 to 31 are the EEPROM, whose nibbles are put together; it is read and
 * written as a whole, and reserved bytes go back as they were read. The others are read or written
 * one by one.
 */
GROBO_API const grobo_servo_table *grobo_ics_table(void);

/** True for servos with ICS 3.6, which tell their position without being moved. */
GROBO_API bool grobo_ics_tells_position(const grobo_servo_model *servo);

GROBO_END_DECLS

#endif
