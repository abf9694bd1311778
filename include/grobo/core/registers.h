/* SPDX-License-Identifier: MIT */
/**
 * @file registers.h
 * @brief Register tables of servos: names, addresses, sizes, units, and what a register does.
 *
 * A table holds the registers of a series and its models; one row may serve some of the models
 * only. Tables are const data: grobo_rs30x_table (rs30x.h), grobo_dxl2_table (dxl2.h),
 * grobo_dxl1_table (dxl1.h), grobo_sts_table and grobo_scs_table (feetech.h), grobo_lx16a_table
 * (lx16a.h), grobo_ics_table (ics.h). All functions are pure and thread safe.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_REGISTERS_H
#define GROBO_CORE_REGISTERS_H

#include <grobo/types.h>

GROBO_BEGIN_DECLS

/** What a register does, whatever the family. A table has at most one row a model for a role. */
typedef enum grobo_register_role {
    GROBO_ROLE_NONE, /**< a setting that the library does not touch */
    /* identity and line */
    GROBO_ROLE_MODEL,
    GROBO_ROLE_FIRMWARE,
    GROBO_ROLE_ID,
    GROBO_ROLE_BAUD,
    GROBO_ROLE_RETURN_DELAY, /**< before a reply */
    GROBO_ROLE_REPLY_LEVEL,  /**< which instructions are answered */
    GROBO_ROLE_LOCK,         /**< opens or closes the registers that survive power-off */
    GROBO_ROLE_WATCHDOG,     /**< stops the servo when the line is silent */
    /* what a position means and which are allowed */
    GROBO_ROLE_DIRECTION,
    GROBO_ROLE_MODE,
    GROBO_ROLE_OFFSET,
    GROBO_ROLE_MIN_POSITION,
    GROBO_ROLE_MAX_POSITION,
    /* protection */
    GROBO_ROLE_TEMPERATURE_LIMIT,
    GROBO_ROLE_MIN_VOLTAGE,
    GROBO_ROLE_MAX_VOLTAGE,
    GROBO_ROLE_MAX_TORQUE,    /**< the torque limit after power-on */
    GROBO_ROLE_CURRENT_LIMIT, /**< cuts or bounds the current */
    GROBO_ROLE_SPEED_LIMIT,
    GROBO_ROLE_SHUTDOWN, /**< which errors cut the torque */
    /* orders */
    GROBO_ROLE_TORQUE,
    GROBO_ROLE_TORQUE_LIMIT, /**< lost at power-off */
    GROBO_ROLE_GOAL,
    GROBO_ROLE_GOAL_TIME,    /**< duration of a move */
    GROBO_ROLE_SPEED,        /**< top speed of a move (of a profile) */
    GROBO_ROLE_ACCELERATION, /**< of a move (of a profile) */
    GROBO_ROLE_GOAL_SPEED,   /**< of a wheel */
    GROBO_ROLE_GOAL_CURRENT,
    GROBO_ROLE_GOAL_PWM,
    /* present values */
    GROBO_ROLE_ERROR, /**< bits of what is wrong */
    GROBO_ROLE_REGISTERED,
    GROBO_ROLE_MOVING,
    GROBO_ROLE_POSITION,
    GROBO_ROLE_PRESENT_SPEED,
    GROBO_ROLE_LOAD,
    GROBO_ROLE_CURRENT,
    GROBO_ROLE_VOLTAGE,
    GROBO_ROLE_TEMPERATURE
} grobo_register_role;

/** How negative numbers are written; a number above GROBO_SIGN_TWOS is the bit of the sign. */
#define GROBO_SIGN_NONE 0u /**< there are none */
#define GROBO_SIGN_TWOS 1u /**< two's complement */

/** What a register is, or-ed. */
#define GROBO_REGISTER_W 0x1u    /**< may be written */
#define GROBO_REGISTER_KEPT 0x2u /**< survives power-off (EEPROM) */

/** One register. */
typedef struct grobo_servo_register {
    const char *name; /**< "goal_position": the name on the command line */
    const char *unit; /**< what one count is worth: "0.1 V"; "" for plain numbers */
    int32_t min, max; /**< range of counts */
    int32_t factory;  /**< as the servo leaves the factory; 0 for present values */
    uint16_t address; /**< of the first byte */
    uint8_t bytes;    /**< 1, 2 or 4 */
    uint8_t sign;     /**< GROBO_SIGN_..., or the bit that is the sign of a magnitude */
    uint8_t flags;    /**< GROBO_REGISTER_... */
    uint8_t role;     /**< grobo_register_role */
    uint8_t set;      /**< index of grobo_servo_table.sets: the models that have it */
} grobo_servo_register;

/** How what is written to registers of GROBO_REGISTER_KEPT survives power-off. */
typedef enum grobo_keeps {
    GROBO_KEEPS_LIMP,   /**< at once; they can be written without torque only */
    GROBO_KEEPS_LOCK,   /**< at once, while register LOCK is 0; else it lasts until power-off */
    GROBO_KEEPS_COMMAND /**< when told to write its flash (GROBO_SERVO_FLASH) */
} grobo_keeps;

/** A rate of the line, and its code in register BAUD. */
typedef struct grobo_servo_rate {
    uint8_t code;
    uint8_t set; /**< index of grobo_servo_table.sets: the models that have it */
    int32_t bps;
} grobo_servo_rate;

struct grobo_servo_table;

/** Registers that stand for others: address k of a run says which byte data k is. */
typedef struct grobo_servo_indirect {
    uint16_t address; /**< of the first address, of 2 bytes each; each holds that of its data at
                           power-on */
    uint16_t data;    /**< address of the first byte of data */
    uint16_t count;   /**< of both */
} grobo_servo_indirect;

/** It cannot be a joint: it does not tell its position (grobo_servo_model.flags). */
#define GROBO_MODEL_NO_JOINT 0x1u
/** Of its speed, torque and current one at least has no source but memory. */
#define GROBO_MODEL_UNVERIFIED 0x2u

/** One model of a series. */
typedef struct grobo_servo_model {
    const char *name;                      /**< "XL330-M288" */
    uint16_t number;                       /**< as its register MODEL gives it */
    uint32_t span_ticks;                   /**< counts of position ... */
    uint16_t span_deg;                     /**< ... in so many degrees */
    uint16_t middle;                       /**< the position in the middle of the span */
    uint16_t speed_dps;                    /**< top speed without load at voltage_mv */
    uint16_t torque_mnm;                   /**< stall torque at voltage_mv, in 0.001 N m */
    uint16_t current_ma;                   /**< stall current at voltage_mv */
    uint16_t voltage_mv;                   /**< nominal supply */
    uint8_t firmware;                      /**< a version that is sold; of KRS that of ICS, 35 or
                                              36 */
    uint8_t flags;                         /**< GROBO_MODEL_... */
    const struct grobo_servo_table *table; /**< of its series */
    const grobo_servo_indirect *indirect;  /**< indirect_count runs; NULL: none */
    uint8_t indirect_count;
    uint8_t
        fast_firmware; /**< of DYNAMIXEL: the first firmware that answers FAST SYNC READ and FAST
                                BULK READ (ROBOTIS e-manual, Protocol 2.0, Fast Sync Read); 0: none
                                does. What does not answer is silent */
} grobo_servo_model;

/** A series: registers by rising address, models, rates as its manuals list them. */
typedef struct grobo_servo_table {
    const char *name; /**< "DYNAMIXEL X" */
    const grobo_servo_register *registers;
    const grobo_servo_model *models;
    const grobo_servo_rate *rates;
    const uint64_t *sets; /**< sets of models, bit n for models[n]; at most 64 models a table */
    uint16_t register_count;
    uint8_t model_count;
    uint8_t rate_count;
    uint8_t keeps;                          /**< grobo_keeps */
    bool big_endian;                        /**< the high byte of a value comes first */
    const struct grobo_servo_table *series; /**< of a model that a user's file describes: the table
                                                 of the model that it is like; NULL: this table is
                                                 one of the library */
} grobo_servo_table;

/** The series of a model: the table of the library whose servos talk as it does. Its own, but for a
 *  model of a user's file. NULL for NULL. Static storage. */
GROBO_API const grobo_servo_table *grobo_servo_series(const grobo_servo_model *model);

/** The model of this name (exact), NULL when there is none. Static storage. */
GROBO_API const grobo_servo_model *grobo_servo_model_named(const grobo_servo_table *table,
                                                           const char *name);

/** The first model of this number, NULL when there is none. Static storage. */
GROBO_API const grobo_servo_model *grobo_servo_model_numbered(const grobo_servo_table *table,
                                                              uint16_t number);

/** Register number index of a model, by rising address; NULL behind the last. Static storage. */
GROBO_API const grobo_servo_register *grobo_servo_register_row(const grobo_servo_model *model,
                                                               size_t index);

/** The register of this text name (exact), NULL when the model has none. Static storage. */
GROBO_API const grobo_servo_register *grobo_servo_register_named(const grobo_servo_model *model,
                                                                 const char *name);

/** The register that holds this address, its higher bytes too; NULL when the model has none. */
GROBO_API const grobo_servo_register *grobo_servo_register_at(const grobo_servo_model *model,
                                                              uint16_t address);

/** The register of this role; NULL when the model has none. */
GROBO_API const grobo_servo_register *grobo_servo_register_of(const grobo_servo_model *model,
                                                              grobo_register_role role);

/** Value of a register from its bytes (reg->bytes of them), in counts; 0 for NULL. */
GROBO_API int32_t grobo_servo_register_get(const grobo_servo_model *model,
                                           const grobo_servo_register *reg, const uint8_t *bytes);

/**
 * Puts a value into reg->bytes bytes.
 * @return bytes written, or GROBO_ERR_LIMIT outside reg->min..max (nothing is written)
 */
GROBO_API int grobo_servo_register_put(const grobo_servo_model *model,
                                       const grobo_servo_register *reg, int32_t value,
                                       uint8_t *bytes);

/** Line speed in bps of a code of register BAUD; GROBO_ERR_ARG for a code that is not listed. */
GROBO_API int32_t grobo_servo_baud_bps(const grobo_servo_model *model, int32_t code);

/** Code of register BAUD for a line speed in bps; GROBO_ERR_UNSUPPORTED for other speeds. */
GROBO_API int grobo_servo_baud_code(const grobo_servo_model *model, int32_t baud_bps);

GROBO_END_DECLS

#endif
