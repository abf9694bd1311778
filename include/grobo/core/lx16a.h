/* SPDX-License-Identifier: MIT */
/**
 * @file lx16a.h
 * @brief Packets of LewanSoul and Hiwonder bus servos: LX-16A, LX-15D, LX-224, HTS-35H.
 *
 * These servos have no registers: an item has a command that writes it and one that reads it.
 * Writes are never answered. Both ends of the wire, on the caller's bytes; no allocation, no clock,
 * no state.
 *
 * Source of the constants: the maker's "Bus Servo Communication Protocol".
 */
#ifndef GROBO_CORE_LX16A_H
#define GROBO_CORE_LX16A_H

#include <grobo/core/protocol.h>
#include <grobo/core/registers.h>

GROBO_BEGIN_DECLS

/** Longest frame of the maker's commands. */
#define GROBO_LX16A_FRAME_MAX_BYTES 10
/** Bytes of a frame without parameters: header, id, length, command, sum. */
#define GROBO_LX16A_OVERHEAD_BYTES 6
/** Highest id of a servo. */
#define GROBO_LX16A_ID_MAX 253
/** All servos; they answer ID_READ alone. */
#define GROBO_LX16A_ID_ALL 254

/** Commands. Values of two bytes have the low one first. */
typedef enum grobo_lx16a_code {
    GROBO_LX16A_MOVE = 1,      /**< position 0..1000 (0.24 deg), time 0..30000 ms */
    GROBO_LX16A_MOVE_READ = 2, /**< what the last MOVE was */
    GROBO_LX16A_WAIT = 7,      /**< as MOVE, at the next START */
    GROBO_LX16A_WAIT_READ = 8,
    GROBO_LX16A_START = 11,
    GROBO_LX16A_STOP = 12, /**< holds where it is */
    GROBO_LX16A_ID = 13,
    GROBO_LX16A_ID_READ = 14,
    GROBO_LX16A_OFFSET = 17, /**< -125..125, lost at power-off without OFFSET_SAVE */
    GROBO_LX16A_OFFSET_SAVE = 18,
    GROBO_LX16A_OFFSET_READ = 19,
    GROBO_LX16A_LIMITS = 20, /**< positions min, max */
    GROBO_LX16A_LIMITS_READ = 21,
    GROBO_LX16A_VOLTAGES = 22, /**< mV min, max */
    GROBO_LX16A_VOLTAGES_READ = 23,
    GROBO_LX16A_HEAT = 24, /**< limit in deg C */
    GROBO_LX16A_HEAT_READ = 25,
    GROBO_LX16A_TEMPERATURE_READ = 26,
    GROBO_LX16A_VOLTAGE_READ = 27,
    GROBO_LX16A_POSITION_READ = 28, /**< signed */
    GROBO_LX16A_MODE = 29,          /**< 0 servo, 1 motor; 0; speed -1000..1000 */
    GROBO_LX16A_MODE_READ = 30,
    GROBO_LX16A_LOAD = 31, /**< 1: torque on */
    GROBO_LX16A_LOAD_READ = 32,
    GROBO_LX16A_LED = 33, /**< 0: on */
    GROBO_LX16A_LED_READ = 34,
    GROBO_LX16A_ALARM = 35, /**< bits of what the LED shows: 1 heat, 2 voltage, 4 stall */
    GROBO_LX16A_ALARM_READ = 36
} grobo_lx16a_code;

/** A frame taken apart, or to be put together. */
typedef struct grobo_lx16a_packet {
    uint8_t id;
    uint8_t command;     /**< grobo_lx16a_code; a reply has that of its request */
    const uint8_t *data; /**< borrowed */
    size_t data_bytes;   /**< number of them, at most 4 */
} grobo_lx16a_packet;

/**
 * Judges n > 0 bytes: the size of the good frame that they start with; 0 when they may start one
 * and more are needed; GROBO_ERR_FRAME when they cannot, GROBO_ERR_CHECKSUM when only the sum is
 * wrong.
 * @param accept GROBO_ACCEPT_COMMANDS, GROBO_ACCEPT_RETURNS (protocol.h) or-ed; a return is one of
 *               a command that reads, with all its data
 */
GROBO_API int grobo_lx16a_measure(const uint8_t *bytes, size_t n, unsigned accept);

/** As grobo_lx16a_measure(), for the reply to the request sent: of its id and command. */
GROBO_API int grobo_lx16a_answer(const uint8_t *sent, size_t sent_bytes, const uint8_t *bytes,
                                 size_t n);

/** Takes the good frame of n bytes apart; packet->data points into it. @return GROBO_OK, or
 *  GROBO_ERR_FRAME, GROBO_ERR_CHECKSUM: no frame of n bytes. */
GROBO_API int grobo_lx16a_parse(const uint8_t *frame, size_t n, grobo_lx16a_packet *packet);

/** Puts a frame together. packet->data may lie in buf at offset 5. @return size, or GROBO_ERR_ARG
 *  (an id that is none), GROBO_ERR_CAP (more data than a frame has), GROBO_ERR_SPACE. */
GROBO_API int grobo_lx16a_build(const grobo_lx16a_packet *packet, uint8_t *buf, size_t cap);

/** The protocol, for the bus. The maker prints no return delay: 500 us is assumed. */
GROBO_API const grobo_protocol *grobo_lx16a_protocol(void);

/**
 * Their values, and models. The servos know no addresses and do not tell their model: both numbers
 * are this library's. Values that go in one frame stand side by side, and are read and written
 * together only: min_position with max_position, min_voltage with max_voltage, mode with
 * mode_speed (from mode to the end of mode_speed), goal_position with goal_time, next_position
 * with next_time.
 */
GROBO_API const grobo_servo_table *grobo_lx16a_table(void);

/** Data bytes of the reply to a command; 0: it is never answered. */
GROBO_API size_t grobo_lx16a_reply_bytes(uint8_t command);

GROBO_END_DECLS

#endif
