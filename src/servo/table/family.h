/* SPDX-License-Identifier: MIT */
/*
 * A driver for servos that are registers: what it reads and writes are the registers of certain
 * roles, so that a family is its table, its frames and the few things below.
 */
#ifndef GROBO_CORE_TABLE_FAMILY_H
#define GROBO_CORE_TABLE_FAMILY_H

#include <grobo/core/driver.h>
#include <grobo/core/dxl2.h>

enum { GROBO_I_TABLES = 2 };

/* How a family moves in a given time. */
typedef enum grobo_i_pace {
    GROBO_I_PACE_TIME,    /* by GOAL_TIME in ms, where there is one; else as SPEED */
    GROBO_I_PACE_PROFILE, /* SPEED is the duration of the move in ms */
    GROBO_I_PACE_SPEED    /* SPEED is a speed: what leads there in this time */
} grobo_i_pace;

/* How a servo turns on and on. */
typedef struct grobo_i_wheel {
    grobo_register_role role; /* of the register that its speed is in */
    double dps;               /* a count of it, at the servo's output */
    int32_t most;             /* the largest count */
    int32_t sign;             /* a bit that says that it turns back; 0: the register has a sign */
    int32_t mode;             /* what MODE must hold */
    int32_t any;              /* bits of DIRECTION that a wheel may have or not: of goals alone */
    bool by_limits;           /* both limits 0 make it a wheel, MODE does not */
} grobo_i_wheel;

typedef struct grobo_i_family {
    const grobo_servo_table *tables[GROBO_I_TABLES];
    /* Frames, as those of DYNAMIXEL 2.0: instructions have the same numbers. parse() is of frames
     * to servos. */
    int (*build)(const grobo_dxl2_packet *packet, uint8_t *buf, size_t cap);
    int (*parse)(const uint8_t *frame, size_t n, uint8_t *data, size_t cap,
                 grobo_dxl2_packet *packet);
    /* What the register of a role must hold for the joint, which holds this: the same, where that
     * will do. Asked of MODE and DIRECTION. */
    int32_t (*wants)(const grobo_joint *joint, const grobo_servo_model *servo,
                     grobo_register_role role, int32_t found);
    /* How this servo is a wheel. False: it cannot be one. NULL: none of the family can. */
    bool (*wheel)(const grobo_servo_model *servo, grobo_i_wheel *wheel);
    /* The same for a servo of the family that differs from this one; NULL: there is none. */
    const struct grobo_i_family *(*of)(const grobo_servo_model *servo);
    int32_t limits_mode;           /* the MODE in which a servo keeps within its limits */
    int32_t turns_limits;          /* there, both limits of a joint of several turns */
    bool offset_trims;             /* OFFSET is but a trim, whatever the joint */
    uint32_t watchdog_us;          /* a count of WATCHDOG; 0: it has none */
    uint16_t frame_max_bytes;      /* of one frame, any id */
    uint16_t time_max_ms;          /* longest time of a move */
    bool numbers_errors;           /* a status tells why it refused; else bits of ERROR */
    uint8_t overheated;            /* bits of the register ERROR */
    uint8_t cuts;                  /* bits of it that come with no torque, as SHUTDOWN says */
    uint8_t reset[1], reset_bytes; /* data of FACTORY_RESET */
    bool resets, reboots;          /* instructions that it has */
    bool (*sync_read)(const grobo_servo_model *servo);
    /* Takes the part of servo k out of a packet of n together, which answers FAST_SYNC_READ. False:
     * that is not in there. NULL: no servo of the family answers it. */
    bool (*fast_part)(const grobo_packet *reply, int n, int k, grobo_packet *part);
    uint8_t pace;       /* grobo_i_pace */
    uint8_t off, brake; /* values of TORQUE; brake == off: it has none */
} grobo_i_family;

/* Fills a whole table. @return 0, or GROBO_ERR_ARG: a joint whose servo is in no table, or that
 * does not reach its limits. */
int grobo_i_table_driver(grobo_driver *driver, const grobo_model *model,
                         const grobo_protocol *protocol, const grobo_i_family *family);

/* Fills in all of a table but the functions and what is not the same everywhere. @return as
 * above */
int grobo_i_table_make(grobo_driver *made, const grobo_model *model, const grobo_protocol *protocol,
                       const grobo_i_family *family);

/* The end of each init: made becomes the driver, where result is no error. */
int grobo_i_table_give(grobo_driver *driver, const grobo_driver *made, int result);

/* The end of each frame: what it is answered by. size: of the frame, or an error. */
int grobo_i_table_finish(const grobo_driver *self, int size, grobo_exchange *exchange);

/* The joint number `part` of a set, -1 behind the last: of families that tell one in a frame. */
int grobo_i_table_joint_of_part(const grobo_driver *self, grobo_joint_mask joints, int part);

/* What the family is for this servo. */
const grobo_i_family *grobo_i_table_family(const grobo_driver *self,
                                           const grobo_servo_model *servo);

/* The servo of a joint, NULL: in no table. */
const grobo_servo_model *grobo_i_table_servo(const grobo_driver *self, int joint);

/* A value out of a block of registers that begins at address. False: it is not in it. */
bool grobo_i_table_value(const grobo_servo_model *servo, grobo_register_role role, uint16_t address,
                         const uint8_t *data, size_t n, int32_t *value);

/* Registers of one servo. */
typedef struct grobo_i_block {
    const grobo_servo_model *servo;
    uint16_t address;
    const uint8_t *data;
    size_t n;
} grobo_i_block;

/* Whether the servo is set up as the joint needs it, as far as these registers tell; wheel: NULL
 * where the joint is none; the range of a calibrated joint into state. @return 0, or
 * GROBO_ERR_SETUP and the reason in state->setup. */
int grobo_i_table_setup(const grobo_i_family *family, const grobo_joint *joint,
                        const grobo_i_wheel *wheel, const grobo_i_block *block,
                        grobo_joint_state *state);

/* The register that limits the torque of a joint, and its counts: of a servo that loses it at
 * power-off, else one that it keeps. NULL: it has none. */
const grobo_servo_register *grobo_i_table_limit(const grobo_joint *joint,
                                                const grobo_servo_model *servo, int32_t *counts);

/* The least speed of a servo that leads its joint to a target in time, in deg/s. One that was told
 * this goal already may lag behind it: that of a first move, or it would crawl there. */
double grobo_i_table_speed_dps(const grobo_driver *self, const grobo_target *target, int joint);

/* How the servo of a joint that is a wheel turns; false: the joint is none. */
bool grobo_i_table_wheel(const grobo_driver *self, int joint, grobo_i_wheel *wheel);
/* The counts of a register that tell a wheel this speed, and back. */
int32_t grobo_i_wheel_counts(const grobo_joint *joint, const grobo_i_wheel *wheel, double rad_s);
double grobo_i_wheel_rad_s(const grobo_joint *joint, const grobo_i_wheel *wheel, int32_t counts);

/* Angle of a joint from counts of its servo, and back. */
double grobo_i_table_angle(const grobo_joint *joint, const grobo_servo_model *servo, int32_t ticks);
int32_t grobo_i_table_ticks(const grobo_joint *joint, const grobo_servo_model *servo,
                            double angle_rad);

/* The coarsest count of a joint's servo. */
double grobo_i_table_step_rad(const grobo_driver *self);

/* How long the slowest of the joints' servos waits before it replies, as it leaves the factory; 0
 * where no model has a register for that. */
uint32_t grobo_i_table_delay_us(const grobo_driver *self);

/* Of grobo_driver; inspect.c */
grobo_write_kind grobo_i_table_write_kind(const grobo_driver *self, const grobo_register_io *io);
int grobo_i_table_inspect(const grobo_driver *self, void *ctx, const uint8_t *frame, size_t size,
                          grobo_target *target, grobo_joint_mask *torqued);

/* parse of grobo_driver; reading.c */
int grobo_i_table_parse(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                        grobo_joint_state *state);

#endif
