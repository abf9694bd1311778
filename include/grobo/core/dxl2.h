/* SPDX-License-Identifier: MIT */
/**
 * @file dxl2.h
 * @brief Packets and registers of DYNAMIXEL Protocol 2.0, X series.
 *
 * Both ends of the wire, on the caller's bytes; no allocation, no clock, no state.
 *
 * Source of the constants: the maker's manual (ROBOTIS emanual: protocol2.md, the pages of XL330,
 * XL430, XM430); fast reads: DynamixelSDK group_sync_read.py.
 */
#ifndef GROBO_CORE_DXL2_H
#define GROBO_CORE_DXL2_H

#include <grobo/core/protocol.h>
#include <grobo/core/registers.h>

GROBO_BEGIN_DECLS

/** Longest frame built or taken; the length field could say more. */
#define GROBO_DXL2_FRAME_MAX_BYTES 1024
/** Bytes of an instruction without parameters: header, id, length, instruction, CRC. */
#define GROBO_DXL2_OVERHEAD_BYTES 10
/** Bytes of a status without data. */
#define GROBO_DXL2_STATUS_BYTES 11
/** Highest id of a servo. */
#define GROBO_DXL2_ID_MAX 252
/** All servos; also the sender of a fast status. */
#define GROBO_DXL2_ID_ALL 254

/** Instructions. */
typedef enum grobo_dxl2_code {
    GROBO_DXL2_PING = 0x01,
    GROBO_DXL2_READ = 0x02,
    GROBO_DXL2_WRITE = 0x03,
    GROBO_DXL2_REG_WRITE = 0x04, /**< is done at the next ACTION */
    GROBO_DXL2_ACTION = 0x05,
    GROBO_DXL2_FACTORY_RESET = 0x06, /**< data: GROBO_DXL2_RESET_... */
    GROBO_DXL2_REBOOT = 0x08,
    GROBO_DXL2_CLEAR = 0x10,  /**< data 01 44 58 4C 22: forget turns */
    GROBO_DXL2_BACKUP = 0x20, /**< data 01 or 02, 43 54 52 4C: store, restore */
    GROBO_DXL2_STATUS = 0x55,
    GROBO_DXL2_SYNC_READ = 0x82,
    GROBO_DXL2_SYNC_WRITE = 0x83,
    GROBO_DXL2_FAST_SYNC_READ = 0x8A,
    GROBO_DXL2_BULK_READ = 0x92,
    GROBO_DXL2_BULK_WRITE = 0x93,
    GROBO_DXL2_FAST_BULK_READ = 0x9A
} grobo_dxl2_code;

/** Data of FACTORY_RESET: what is reset. */
typedef enum grobo_dxl2_reset {
    GROBO_DXL2_RESET_BUT_ID = 0x01,
    GROBO_DXL2_RESET_BUT_ID_BAUD = 0x02,
    GROBO_DXL2_RESET_ALL = 0xFF
} grobo_dxl2_reset;

/** Bit of a status' error: the register hardware_error is not 0. The request was done all the
 *  same. */
#define GROBO_DXL2_ALERT 0x80u

/** The other bits of a status' error: a number. */
typedef enum grobo_dxl2_error {
    GROBO_DXL2_DONE = 0,
    GROBO_DXL2_FAILED = 1,
    GROBO_DXL2_BAD_INSTRUCTION = 2,
    GROBO_DXL2_BAD_CRC = 3,
    GROBO_DXL2_BAD_RANGE = 4,
    GROBO_DXL2_BAD_LENGTH = 5,
    GROBO_DXL2_BAD_LIMIT = 6,
    GROBO_DXL2_NO_ACCESS = 7
} grobo_dxl2_error;

/** Bits of the registers shutdown and hardware_error. */
#define GROBO_DXL2_VOLTAGE 0x01u          /**< outside its limits */
#define GROBO_DXL2_OVERHEATED 0x04u       /**< above its limit */
#define GROBO_DXL2_ENCODER 0x08u          /**< the encoder of the motor fails */
#define GROBO_DXL2_SHOCK 0x10u            /**< an electrical shock, or too little power */
#define GROBO_DXL2_OVERLOAD 0x20u         /**< a load that lasts */
#define GROBO_DXL2_XL320_OVERLOAD 0x01u   /**< those of XL-320 (emanual xl320) */
#define GROBO_DXL2_XL320_OVERHEATED 0x02u /**< above its limit */
#define GROBO_DXL2_XL320_VOLTAGE 0x04u    /**< outside its limits */

/** Operating modes. */
typedef enum grobo_dxl2_mode {
    GROBO_DXL2_MODE_CURRENT = 0,
    GROBO_DXL2_MODE_VELOCITY = 1,
    GROBO_DXL2_MODE_POSITION = 3, /**< one turn, between the limits */
    GROBO_DXL2_MODE_EXTENDED = 4, /**< 256 turns either way, no limits */
    GROBO_DXL2_MODE_GRIP = 5,     /**< position, bounded by the goal current */
    GROBO_DXL2_MODE_PWM = 16,
    GROBO_DXL2_MODE_XL320_WHEEL = 1, /**< of XL-320: a speed of the output */
    GROBO_DXL2_MODE_XL320_JOINT = 2  /**< of XL-320: positions of 300 degrees */
} grobo_dxl2_mode;

/** Bits of the drive mode. */
#define GROBO_DXL2_DRIVE_REVERSE 0x01u
#define GROBO_DXL2_DRIVE_TIME 0x04u  /**< profiles by duration instead of by velocity */
#define GROBO_DXL2_DRIVE_WAKES 0x08u /**< a goal switches torque on */

/** A frame taken apart, or to be put together. Fields that an instruction lacks are 0. */
typedef struct grobo_dxl2_packet {
    uint8_t id;          /**< 0..252, or 254 */
    uint8_t instruction; /**< grobo_dxl2_code */
    uint8_t error;       /**< STATUS of one servo: GROBO_DXL2_ALERT and a grobo_dxl2_error */
    uint16_t address;    /**< READ, WRITE, REG_WRITE, sync ones: first register */
    uint16_t length;     /**< READ, sync ones: bytes of each servo */
    const uint8_t *data; /**< borrowed, without stuffing: what is read or written; sync reads:
                              ids; SYNC_WRITE: {id, data}...; BULK_READ: {id, address of 2 bytes,
                              length of 2 bytes}...; BULK_WRITE: the same, each with its data;
                              a fast status: its blocks as they are on the wire (error, id, data,
                              CRC of the next block, ...) but for the last CRC */
    size_t data_bytes;   /**< number of them */
} grobo_dxl2_packet;

/**
 * Judges n > 0 bytes: the size of the good frame that they start with; 0 when they may start one
 * and more are needed; GROBO_ERR_FRAME when they cannot, GROBO_ERR_CHECKSUM when only the CRC is
 * wrong. A status with an unstuffed header in its data is refused, an instruction is not: some
 * hosts (dynamixel-sdk 4.1.0 for Python) do not stuff.
 * @param accept GROBO_ACCEPT_COMMANDS, GROBO_ACCEPT_RETURNS (protocol.h) or-ed
 */
GROBO_API int grobo_dxl2_measure(const uint8_t *bytes, size_t n, unsigned accept);

/**
 * Takes the good frame of n bytes apart that grobo_dxl2_measure() found.
 * @param data room for its parameters without stuffing; packet->data points into it. It may be
 *             the frame's own bytes from offset 8 on, whose CRC is then no longer right.
 * @param cap bytes of that room; n - 10 always do
 * @return GROBO_OK; GROBO_ERR_FRAME: no frame of n bytes; GROBO_ERR_SPACE: no room;
 *         GROBO_ERR_SHORT: a good frame without the parameters that its instruction needs
 */
GROBO_API int grobo_dxl2_parse(const uint8_t *frame, size_t n, uint8_t *data, size_t cap,
                               grobo_dxl2_packet *packet);

/**
 * Puts a frame together and stuffs it. packet->data may lie in buf at offset 8, or behind the
 * error, address and length that come first.
 * @return size, or GROBO_ERR_ARG (an id that is none), GROBO_ERR_CAP (longer than
 *         GROBO_DXL2_FRAME_MAX_BYTES), GROBO_ERR_SPACE
 */
GROBO_API int grobo_dxl2_build(const grobo_dxl2_packet *packet, uint8_t *buf, size_t cap);

/**
 * One servo's block of a good fast status of n bytes, the answer of FAST_SYNC_READ and
 * FAST_BULK_READ. Each block has a CRC of its own.
 * @param at where the block starts: 8 for the first, then the result for the one before
 * @param length data bytes of it
 * @param block id, error and data of it, as in a status
 * @return where the next block would start; GROBO_ERR_SHORT: there is no such block;
 *         GROBO_ERR_CHECKSUM: its CRC is wrong
 */
GROBO_API int grobo_dxl2_block(const uint8_t *frame, size_t n, size_t at, uint16_t length,
                               grobo_dxl2_packet *block);

/** The CRC of Protocol 2.0 over n more bytes; starts with 0. */
GROBO_API uint16_t grobo_dxl2_crc(uint16_t crc, const uint8_t *bytes, size_t n);

/** The protocol, for the bus. Servos must have a reply level of 2, as they leave the factory. */
GROBO_API const grobo_protocol *grobo_dxl2_protocol(void);

/** Registers of the X series, and its models. */
GROBO_API const grobo_servo_table *grobo_dxl2_table(void);

GROBO_END_DECLS

#endif
