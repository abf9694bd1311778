/* SPDX-License-Identifier: MIT */
/**
 * @file dxl1.h
 * @brief Packets of DYNAMIXEL Protocol 1.0, and the registers of AX and MX.
 *
 * Feetech's servos (feetech.h) use the same frame with other registers and some other instructions.
 * Both ends of the wire, on the caller's bytes; no allocation, no clock, no state.
 *
 * Source of the constants: the maker's manual (ROBOTIS emanual: protocol1.md, the pages of AX-12A,
 * AX-18A, MX-28, MX-64, MX-106); Feetech: FTServo SDK, LeRobot's tables.
 */
#ifndef GROBO_CORE_DXL1_H
#define GROBO_CORE_DXL1_H

#include <grobo/core/protocol.h>
#include <grobo/core/registers.h>

GROBO_BEGIN_DECLS

/** Longest frame: its length has one byte. */
#define GROBO_DXL1_FRAME_MAX_BYTES 259
/** Bytes of a frame without parameters: header, id, length, instruction or error, sum. */
#define GROBO_DXL1_OVERHEAD_BYTES 6
/** Highest id of a servo. */
#define GROBO_DXL1_ID_MAX 253
/** All servos. */
#define GROBO_DXL1_ID_ALL 254

/** Instructions of both makers. */
typedef enum grobo_dxl1_code {
    GROBO_DXL1_PING = 0x01,
    GROBO_DXL1_READ = 0x02,
    GROBO_DXL1_WRITE = 0x03,
    GROBO_DXL1_REG_WRITE = 0x04, /**< is done at the next ACTION */
    GROBO_DXL1_ACTION = 0x05,
    GROBO_DXL1_FACTORY_RESET = 0x06,
    GROBO_DXL1_REBOOT = 0x08,      /**< Feetech */
    GROBO_DXL1_RESET_TURNS = 0x0A, /**< Feetech: forget turns */
    GROBO_DXL1_CALIBRATE = 0x0B,   /**< Feetech: here is the middle, or the position in the data */
    GROBO_DXL1_SYNC_READ = 0x82,   /**< Feetech STS and SMS */
    GROBO_DXL1_SYNC_WRITE = 0x83,
    GROBO_DXL1_BULK_READ = 0x92 /**< MX */
} grobo_dxl1_code;

/** Bits of a status' error, and of the registers alarm_led and shutdown. Feetech's are others. */
#define GROBO_DXL1_VOLTAGE 0x01u         /**< outside its limits */
#define GROBO_DXL1_ANGLE_LIMIT 0x02u     /**< the goal is outside the limits */
#define GROBO_DXL1_OVERHEATED 0x04u      /**< above its limit */
#define GROBO_DXL1_BAD_RANGE 0x08u       /**< a value outside its register's range */
#define GROBO_DXL1_BAD_SUM 0x10u         /**< of the instruction */
#define GROBO_DXL1_OVERLOAD 0x20u        /**< the load is more than it can hold */
#define GROBO_DXL1_BAD_INSTRUCTION 0x40u /**< unknown, or an action without a write */

/** A frame taken apart, or to be put together. Fields that an instruction lacks are 0. */
typedef struct grobo_dxl1_packet {
    bool status;         /**< of a servo: nothing in a frame tells */
    uint8_t id;          /**< 0..253, or 254 for an instruction to all */
    uint8_t instruction; /**< grobo_dxl1_code; 0 for a status */
    uint8_t error;       /**< status: bits */
    uint8_t address;     /**< READ, WRITE, REG_WRITE, sync ones: first register */
    uint8_t length;      /**< READ, sync ones: bytes of each servo */
    const uint8_t *data; /**< borrowed; what is read or written; SYNC_READ: ids; SYNC_WRITE:
                              {id, data}...; BULK_READ: 0, {length, id, address}... */
    size_t data_bytes;   /**< number of them */
} grobo_dxl1_packet;

/**
 * Judges n > 0 bytes: the size of the good frame that they start with; 0 when they may start one
 * and more are needed; GROBO_ERR_FRAME when they cannot, GROBO_ERR_CHECKSUM when only the sum is
 * wrong. Data are not stuffed and the sum is weak: a host that knows what it has sent asks
 * grobo_dxl1_answer() instead.
 * @param accept GROBO_ACCEPT_COMMANDS, GROBO_ACCEPT_RETURNS (protocol.h) or-ed: an id of 254 is
 *               good for a command only
 */
GROBO_API int grobo_dxl1_measure(const uint8_t *bytes, size_t n, unsigned accept);

/**
 * As grobo_dxl1_measure(), for statuses that answer an instruction: of the id asked, as long as it
 * must be (an error may come without the data asked for). An echo of the instruction is none.
 * @param sent the whole instruction; its answers are not counted: with SYNC_READ and BULK_READ
 *             each servo of the list has one
 */
GROBO_API int grobo_dxl1_answer(const uint8_t *sent, size_t sent_bytes, const uint8_t *bytes,
                                size_t n);

/**
 * Takes the good frame of n bytes apart that grobo_dxl1_measure() found.
 * @param status whether it is one; packet->data points into frame
 * @return GROBO_OK; GROBO_ERR_FRAME: no frame of n bytes; GROBO_ERR_SHORT: a good frame without the
 *         parameters that its instruction needs
 */
GROBO_API int grobo_dxl1_parse(const uint8_t *frame, size_t n, bool status,
                               grobo_dxl1_packet *packet);

/**
 * Puts a frame together. packet->data may lie in buf where it goes.
 * @return size, or GROBO_ERR_ARG (an id that is none), GROBO_ERR_CAP (longer than the length can
 *         say), GROBO_ERR_SPACE
 */
GROBO_API int grobo_dxl1_build(const grobo_dxl1_packet *packet, uint8_t *buf, size_t cap);

/** How long servos may take to answer a ping to all: LeRobot waits so for Feetech's. */
#define GROBO_DXL1_CALL_US 772000

/** The protocol, for the bus. Servos must have a reply level of 2, as they leave the factory. */
GROBO_API const grobo_protocol *grobo_dxl1_protocol(void);

/** Registers of AX and MX with Protocol 1.0, and their models. */
GROBO_API const grobo_servo_table *grobo_dxl1_table(void);

GROBO_END_DECLS

#endif
