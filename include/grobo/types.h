/* SPDX-License-Identifier: MIT */
/**
 * @file types.h
 * @brief Small types that every layer shares.
 *
 * Units are in the names: _us _ms _s _deg _rad _ddeg (0.1 degree, the wire's unit) _ma _mv _bps
 * _bytes _pct. A time is int64_t microseconds of one monotonic clock of the caller's choice, never
 * negative and below INT64_MAX / 1000 (292 years).
 *
 * A function takes its object first and its out-parameters last. The time of a pump stands behind
 * its bytes, the timeout of a call that waits behind everything. A callback gets its context
 * (`void *ctx`) first, then the object that calls it; a function of a driver's table gets the
 * driver, then the context.
 */
#ifndef GROBO_TYPES_H
#define GROBO_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <grobo/error.h>
#include <grobo/limits.h>

/**
 * The first member of a structure that a later version may lengthen, as the program was compiled:
 * a GROBO_..._INIT of each such structure is `GROBO_SIZED(type)`. The library takes a shorter
 * structure of an older program for one whose missing fields are zero, and refuses with
 * GROBO_ERR_ARG a `size` that no version had (0: not initialised) and a field set that it does not
 * know.
 * @code
 *   grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .speed_limit_pct = 50};
 * @endcode
 * C++ before C++20 has no `.speed_limit_pct`: there, and for a program that is C and C++,
 * @code
 *   grobo_robot_config config = GROBO_INIT(grobo_robot_config);
 *   config.speed_limit_pct = 50;
 * @endcode
 */
#if !defined(__cplusplus) || __cplusplus >= 202002L
#define GROBO_SIZED(type) .size = sizeof(type)
#else
#define GROBO_SIZED(type) sizeof(type)
#endif

/** An initializer of such a structure with its size, all else zero. */
#ifdef __cplusplus
#define GROBO_INIT(type)                                                                           \
    ([] {                                                                                          \
        type made_ = type();                                                                       \
        made_.size = sizeof(type);                                                                 \
        return made_;                                                                              \
    }())
#else
#define GROBO_INIT(type)                                                                           \
    {                                                                                              \
        .size = sizeof(type)                                                                       \
    }
#endif

/**
 * A table that the library borrows and does not copy (grobo_driver, grobo_model, grobo_protocol),
 * with its size as the program was compiled:
 * @code
 *   static const grobo_model model = GROBO_TABLE(grobo_model, .name = "HEAD",
 *                                                GROBO_MODEL_JOINTS(joints), .n_joints = 2);
 *   grobo_driver driver = GROBO_TABLE_INIT(grobo_driver); // for what a function fills in
 * @endcode
 * The library reads a member that lies behind the size of an older program's table as zero. With
 * GROBO_ERR_ARG it refuses a size that no version had (0: not initialised), and a table of a newer
 * program that sets a member which the library does not know. Where GROBO_TABLES_FIXED is set,
 * tables have no size, and this is a plain initializer.
 */
#if GROBO_TABLES_FIXED
#define GROBO_TABLE(type, ...)                                                                     \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }
#ifdef __cplusplus
#define GROBO_TABLE_INIT(type) type()
#else
#define GROBO_TABLE_INIT(type)                                                                     \
    {                                                                                              \
        0                                                                                          \
    }
#endif
#else
#define GROBO_TABLE(type, ...)                                                                     \
    {                                                                                              \
        GROBO_SIZED(type), __VA_ARGS__                                                             \
    }
/** The empty initializer of such a table, for what a function fills in. */
#define GROBO_TABLE_INIT(type) GROBO_INIT(type)
#endif

/** No deadline: later than any time. */
#define GROBO_NEVER_US INT64_MAX

/** One bit a joint, bit j for joint j. */
#if GROBO_JOINTS_MAX > 32
typedef uint64_t grobo_joint_mask;
#else
typedef uint32_t grobo_joint_mask;
#endif

/** The bit of joint j, 0 <= j < GROBO_JOINTS_MAX. */
#define GROBO_JOINT_BIT(j) ((grobo_joint_mask)1 << (j))

/** The bits of joints 0..n-1, 0 <= n <= GROBO_JOINTS_MAX. */
#define GROBO_JOINTS_ALL(n)                                                                        \
    ((n) >= (int)sizeof(grobo_joint_mask) * 8 ? ~(grobo_joint_mask)0                               \
                                              : ((grobo_joint_mask)1 << (n)) - 1)

/** Torque of a servo; the values are those of register No.36 (protocol 4). */
typedef enum grobo_torque {
    GROBO_TORQUE_OFF = 0,  /**< free */
    GROBO_TORQUE_ON = 1,   /**< holds and follows its goal */
    GROBO_TORQUE_BRAKE = 2 /**< damped, does not follow */
} grobo_torque;

/** What the servos do when a program ends or dies. */
typedef enum grobo_exit_policy {
    GROBO_EXIT_DEFAULT = 0, /**< the driver's choice; GR001: hold */
    GROBO_EXIT_OFF = 1,     /**< torque off */
    GROBO_EXIT_HOLD = 2,    /**< stop smoothly, keep torque where it is */
    GROBO_EXIT_SIT = 3      /**< go to the resting posture, then torque off; not in time: hold */
} grobo_exit_policy;

/** A line's parity bit. */
typedef enum grobo_parity {
    GROBO_PARITY_NONE = 0, /**< no such bit: a byte takes 10 bits on the wire, else 11 */
    GROBO_PARITY_EVEN = 1,
    GROBO_PARITY_ODD = 2
} grobo_parity;

/** How the servos are reached. */
typedef enum grobo_wiring {
    GROBO_WIRING_BOARD = 0, /**< through GR001's controller board (relay frames) */
    GROBO_WIRING_BUS = 1    /**< straight on an RS-485 or TTL bus */
} grobo_wiring;

#endif
