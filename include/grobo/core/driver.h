/* SPDX-License-Identifier: MIT */
/**
 * @file driver.h
 * @brief What a robot of one's own fills in: a const table of functions and data.
 *
 * The engine (robot.h) decides what is sent and when; the driver knows how it looks on the wire.
 * Every function is pure apart from `ctx`: no I/O, no waiting, no allocation. They run inside the
 * engine's calls, so they must not call the engine back.
 *
 * A robot of servos that the library knows needs data only: grobo_rs30x_driver_init() and its like
 * below fill a whole table from a model, and single functions may then be replaced. Another kind
 * of servo or board replaces all of them, and brings a protocol of its own (protocol.h).
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_DRIVER_H
#define GROBO_CORE_DRIVER_H

#include <grobo/core/protocol.h>
#include <grobo/core/registers.h>
#include <grobo/model.h>
#include <grobo/posture.h>

GROBO_BEGIN_DECLS

struct grobo_imu; /* imu.h */

/* ---- what goes over the wire ------------------------------------------------------------- */

/** What a read asks of a joint. */
typedef enum grobo_sense_kind {
    GROBO_SENSE_FULL = 0,     /**< everything measured (RS30x: No.36-53, 26 bytes back) */
    GROBO_SENSE_POSITION = 1, /**< the angle only (No.42-43, 10 bytes) */
    GROBO_SENSE_GOAL = 2,     /**< goal, torque and way to it, to check what was sent (No.30-47) */
    GROBO_SENSE_ALL = 3       /**< full and goal (No.30-53, 32 bytes) */
} grobo_sense_kind;

/** One frame to send and the reply it waits for. Plain data. */
typedef struct grobo_exchange {
    uint16_t frame_bytes;                 /**< how much of frame is sent */
    grobo_reply reply;                    /**< what must come back */
    int64_t settle_us;                    /**< silence the device needs afterwards, 0: none */
    uint8_t frame[GROBO_FRAME_MAX_BYTES]; /**< what is sent */
} grobo_exchange;

/* ---- what a joint reports ------------------------------------------------------------------ */

/** Fields of a grobo_joint_state, as bits of grobo_joint_state.valid. */
typedef enum grobo_field {
    GROBO_FIELD_ANGLE = 1 << 0,
    GROBO_FIELD_TIME = 1 << 1,
    GROBO_FIELD_SPEED = 1 << 2,
    GROBO_FIELD_CURRENT = 1 << 3,
    GROBO_FIELD_TEMPERATURE = 1 << 4,
    GROBO_FIELD_VOLTAGE = 1 << 5,
    GROBO_FIELD_TORQUE = 1 << 6,
    GROBO_FIELD_GOAL = 1 << 7,
    GROBO_FIELD_RANGE = 1 << 8,
    GROBO_FIELD_TORQUE_LIMIT = 1 << 9,
    GROBO_FIELD_FAST = 1 << 10
} grobo_field;

/** What of a servo is not as its joint needs it. */
typedef struct grobo_setup_fault {
    const grobo_servo_register *reg; /**< NULL: nothing, as far as was read */
    int32_t found;                   /**< its counts */
    int32_t low, high;               /**< what would do, in counts; low > high: the servo is as it
                                          left its factory, and the joint is a calibrated one */
    uint8_t more;                    /**< registers beside it that are wrong, too */
} grobo_setup_fault;

/** One reading of one joint. Plain data; a field means something only where `valid` has its bit. */
typedef struct grobo_joint_state {
    double angle_rad;      /**< present angle */
    double goal_rad;       /**< the goal that the servo has */
    int64_t goal_time_us;  /**< and in which time; 0: as fast as it can. Valid with goal_rad */
    int64_t time_us;       /**< since its present move began */
    int32_t speed_dps;     /**< degrees a second */
    int32_t current_ma;    /**< motor current */
    int32_t voltage_mv;    /**< supply */
    int16_t temperature_c; /**< degrees Celsius */
    uint16_t valid;        /**< GROBO_FIELD_... bits */
    grobo_torque torque;   /**< as read, not as asked */
    bool overheated;       /**< the servo reports that it was too hot and has cut its torque */
    uint8_t flags;         /**< of the reply, in bits of its family (GROBO_RS30X_STATUS_...) */
    bool torque_limited;   /**< its torque limit is its joint's, or lower */
    bool fast;             /**< it answers sense_fast() of its driver */
    double low_rad;        /**< range of a calibrated joint, by the limits that its servo keeps */
    double high_rad;
    grobo_setup_fault setup; /**< of a joint that was read with GROBO_ERR_SETUP */
#if !GROBO_DRIVERS_PLAIN
    double goal_rad_s; /**< of a wheel, in place of goal_rad: the speed that the servo was told */
#endif
} grobo_joint_state;

/* ---- the table ----------------------------------------------------------------------------- */

/** Where joints go, and in which time each: what the engine asks a driver to put in frames. */
typedef struct grobo_target {
    grobo_posture posture;                   /**< checked: finite, within limits */
    int64_t joint_time_us[GROBO_JOINTS_MAX]; /**< by joint, multiples of the driver's time step */
    double from_rad[GROBO_JOINTS_MAX];       /**< where each is when the frame leaves: families
                                                  without a goal time make a speed of it */
} grobo_target;

/** A motion kept in the robot itself. */
typedef enum grobo_stored_kind {
    GROBO_STORED_SLOT = 0,    /**< one motion (GR001: 50 4D k) */
    GROBO_STORED_SCENARIO = 1 /**< a sequence of motions (GR001: 50 53 k) */
} grobo_stored_kind;

/** A register transfer of one servo. */
typedef struct grobo_register_io {
    uint8_t id;          /**< servo id, as its protocol has them */
    uint16_t address;    /**< first register */
    uint16_t length;     /**< bytes, > 0 */
    const uint8_t *data; /**< bytes to write, or NULL to read */
} grobo_register_io;

/** What writing registers does. */
typedef enum grobo_write_kind {
    GROBO_WRITE_HARMLESS = 0, /**< nothing moves, and goals mean what they meant */
    GROBO_WRITE_SETTING = 1,  /**< goals mean something else (id, direction, limits): a servo that
                                   holds would jump */
    GROBO_WRITE_MOTOR = 2     /**< a goal, its time, torque: there are requests for these */
} grobo_write_kind;

/** What a servo does with itself. */
typedef enum grobo_servo_command {
    GROBO_SERVO_FLASH = 0,        /**< write No.4-29 to flash (1 s) */
    GROBO_SERVO_REBOOT = 1,       /**< restart (2 s) */
    GROBO_SERVO_FACTORY_RESET = 2 /**< factory settings; the id becomes 1 */
} grobo_servo_command;

/** Safety limits; where the engine's configuration is silent, its driver's hold. */
typedef struct grobo_safety_limits {
    int16_t temperature_c; /**< stop above this; 0: no limit */
    int16_t lost_replies;  /**< stop after so many readings lost in a row of one joint; 0: none */
    int32_t current_ma;    /**< stop when above it for current_us; 0: no limit */
    int32_t voltage_mv;    /**< stop when below; 0: no limit */
    int64_t current_us;    /**< how long a current may stand above its limit */
    double approach_rad_s; /**< speed of the first move from a sensed posture, > 0 */
} grobo_safety_limits;

/** A correction of one joint's reading. */
typedef struct grobo_readback {
    double add_rad; /**< added to the angle read */
    uint8_t joint;  /**< joint id */
} grobo_readback;

typedef struct grobo_driver grobo_driver;

/**
 * A robot's table. Borrowed by the engine: it must outlive it. A function that is NULL makes the
 * engine refuse what needs it with GROBO_ERR_UNSUPPORTED; `posture`, `sense` and `parse` must be
 * there.
 *
 * What the servos do, where families differ, is in `keeps_setup`, `goal_energises`,
 * `tells_no_speed`, `accel_rad_s2`, `watchdog_us` and `timed_posture`; `arm` is about the robot.
 * The engine knows nothing else about a family. tests/engine/test_capabilities.c compares them with
 * what a simulated servo of each family does.
 *
 * Functions with a `part` may give several frames: they are called with part 0, 1, 2... They
 * return 1 with *exchange filled, 0 when part is past the last frame, or an error. *exchange
 * comes zeroed, but for the bytes of its frame.
 */
struct grobo_driver {
#if !GROBO_TABLES_FIXED
    size_t size; /**< GROBO_TABLE() or GROBO_TABLE_INIT() */
#endif
    const char *name;               /**< "GR001" */
    const grobo_model *model;       /**< joints, motors, limits */
    const grobo_protocol *protocol; /**< how its servos talk, and over what line */
    int64_t time_step_us;           /**< unit of a goal time on the wire, > 0 (RS30x: 10 ms) */
    int64_t time_max_us;            /**< longest goal time of the wire, >= time_step_us, at most
                                         GROBO_PLAY_TIME_MAX_US */
    double angle_step_rad;          /**< goals are rounded to multiples of this, > 0 */
    double accel_rad_s2;            /**< joints speed up and brake so on the way to a goal; 0: too
                                         fast to count, or not known */
    grobo_safety_limits limits;     /**< safety limits of this robot */
    grobo_exit_policy on_exit;      /**< what GROBO_EXIT_DEFAULT stands for; not DEFAULT itself */
    bool arm;                       /**< its joints do not stand on each other, so that it may stop
                                     anywhere: goals go in segments, see grobo_goals */
    const double *rest_rad; /**< resting posture by joint for GROBO_EXIT_SIT; NULL: initial one */
    const grobo_readback *readback; /**< n_readback corrections, used if the engine is told to */
    uint8_t n_readback;
    const void *family;  /**< for the table's own functions */
    bool keeps_setup;    /**< its servos keep settings (limits, directions, modes) that a joint may
                              need otherwise: a joint's first reading is always of GROBO_SENSE_ALL,
                              in which parse() looks at them */
    int64_t watchdog_us; /**< what watchdog() is told whenever joints are to move, until the engine
                              leaves, or twice the interval of readings where that is longer; not
                              where there are none. 0: nothing */
    bool goal_energises; /**< a goal switches torque on: joints without it get none but to hold, and
                              none that may have restarted before they were read again */
    bool tells_no_speed; /**< a reading has no speed: the engine takes that between two angles */

    /** Is the robot there? Parts are tried one after the other until one is answered. */
    int (*check)(const grobo_driver *self, void *ctx, int part, grobo_exchange *exchange);
    /** Moves the joints that target->posture sets; several frames where one does not hold them. */
    int (*posture)(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                   grobo_exchange *exchange);
    /** Sets the torque of `joints`. NULL: it cannot be switched, and an emergency stop halts. */
    int (*torque)(const grobo_driver *self, void *ctx, grobo_joint_mask joints, grobo_torque mode,
                  int part, grobo_exchange *exchange);
    /** Has servos stop by themselves once nothing was sent to them for time_us while they have
     *  torque, also where they have done so before; 0: never, also where the time is longer than
     *  they can count. Moves nothing. NULL: they cannot. */
    int (*watchdog)(const grobo_driver *self, void *ctx, grobo_joint_mask joints, int64_t time_us,
                    int part, grobo_exchange *exchange);
    /** Sets the torque limits of joints that have one, and moves nothing; a reading says whether it
     *  took. NULL: they have none, and a model with one is refused. */
    int (*torque_limit)(const grobo_driver *self, void *ctx, grobo_joint_mask joints, int part,
                        grobo_exchange *exchange);
    /** Asks one joint for its state. @return 0 or an error. */
    int (*sense)(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                 grobo_exchange *exchange);
    /** What a reading takes besides the exchange of sense(), where one exchange reads one value:
     *  parts 1, 2... are asked when the part before is answered, and parse() gets each reply. What
     *  shows the servo's setup comes before its angle. NULL: one exchange is all. */
    int (*sense_more)(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                      int part, grobo_exchange *exchange);
    /** Asks several joints for their state in one exchange: each answers with a packet of its id,
     *  or one packet that has an id of no servo answers for all. NULL: they are asked one by one.
     *  @return 0 or an error. */
    int (*sense_many)(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                      grobo_sense_kind kind, grobo_exchange *exchange);
    /** As sense_many() of all joints, for servos that answer with one packet together: asked where
     *  each has told that it does (grobo_joint_state.fast, of a reading of GROBO_SENSE_ALL). NULL:
     *  there are none. @return 0 or an error: sense_many() is asked. */
    int (*sense_fast)(const grobo_driver *self, void *ctx, grobo_sense_kind kind,
                      grobo_exchange *exchange);
    /**
     * Reads what a joint returned; the packet has been checked against the exchange's reply.
     * Sets the fields it finds and their bits in state->valid. @return 0 or an error: a joint that
     * is read with one was never sensed, so that it is not moved either.
     */
    int (*parse)(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                 grobo_joint_state *state);
    /** What writing these registers would do; the worst counts. Must be there with `registers`. */
    grobo_write_kind (*write_kind)(const grobo_driver *self, const grobo_register_io *io);
    /** Reads or writes registers of one servo. @return 0 or an error: GROBO_ERR_ARG where there are
     *  no such registers. */
    int (*registers)(const grobo_driver *self, void *ctx, const grobo_register_io *io,
                     grobo_exchange *exchange);
    /** Flash, reboot, factory reset; sets exchange->settle_us. @return 0 or an error. */
    int (*command)(const grobo_driver *self, void *ctx, int id, grobo_servo_command command,
                   grobo_exchange *exchange);
    /** Plays a motion kept in the robot. @return 0 or an error. */
    int (*stored)(const grobo_driver *self, void *ctx, grobo_stored_kind kind, int number,
                  grobo_exchange *exchange);
    /**
     * Reads what a raw frame of a user asks for, so that the engine can check it as
     * it checks its own: sets *target for joints the frame moves (times too), and adds the joints
     * whose torque it sets to torqued[], which has a mask for each grobo_torque and comes zeroed.
     * @return 0, or GROBO_ERR_UNSUPPORTED for a frame that cannot be understood, or that moves what
     *         is no joint, or changes what goals mean (ids, directions, limits).
     */
    int (*inspect)(const grobo_driver *self, void *ctx, const uint8_t *frame, size_t size,
                   grobo_target *target, grobo_joint_mask *torqued);
    /**
     * The stabilizer: may change the angles of a target before it is checked and sent, knowing
     * the posture sensed last (joints not sensed are not set in it). NULL: nothing to correct.
     * @return 0; an error stops the motion with it.
     */
    int (*stabilize)(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                     grobo_posture *target);
    /**
     * posture() again, where it makes the same frames of the same angles and times, whoever asks
     * and whenever: from_rad says nothing to it and is not filled in, and a frame that waited with
     * nothing changed leaves as it is. NULL, or another one than posture(): it may not.
     */
    int (*timed_posture)(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                         grobo_exchange *exchange);
#if !GROBO_DRIVERS_PLAIN
    /**
     * Has wheels turn at these speeds, in rad/s by joint, from now on; 0: they stand. Switches no
     * torque on. parse() has read that their servos are wheels, see grobo_joint.wheel. NULL: a
     * model with a wheel is refused.
     */
    int (*speed)(const grobo_driver *self, void *ctx, grobo_joint_mask joints, const double *rad_s,
                 int part, grobo_exchange *exchange);
#endif
#if GROBO_LINES_MAX > 1
    const struct grobo_lines *lines; /**< of a robot of several (lines.h); NULL: it has one */
#endif
#if !GROBO_DRIVERS_PLAIN
    /**
     * A stabilizer that knows how the base stands, behind stabilize(): as that, with the reading
     * of an IMU that was given last (imu.h); NULL where none was in the last GROBO_IMU_AGE_US.
     */
    int (*stabilize_by)(const grobo_driver *self, void *ctx, const struct grobo_imu *imu,
                        const grobo_posture *sensed, grobo_posture *target);
#endif
};

/**
 * Copies a table, for a program that changes a driver of the library: an assignment would take the
 * library's size for the program's.
 * @param[in,out] to its size is set: GROBO_TABLE_INIT(grobo_driver). What it has no room for is not
 *   copied.
 * @return 0, or GROBO_ERR_ARG: a size that no version had. Pure; thread safe.
 */
GROBO_API int grobo_driver_copy(grobo_driver *to, const grobo_driver *from);

/**
 * Checks a table: its size, functions that must be there, time step, limits, exit policy, the model
 * (grobo_model_check()), joints of `readback`.
 * @return 0, GROBO_ERR_ARG; GROBO_ERR_UNSUPPORTED where the build is for plain drivers alone and
 *         this is none (GROBO_DRIVERS_PLAIN of limits.h). Pure; thread safe.
 */
GROBO_API int grobo_driver_check(const grobo_driver *driver);

/** Whether there is a board between the host and its servos. */
GROBO_API grobo_wiring grobo_driver_wiring(const grobo_driver *driver);

/**
 * Fills a table for RS30x servos: every function but `stabilize`, `stabilize_by`, and `stored` only
 * where a board is in between. Limits: 70 deg C, 5 lost replies, 60 deg/s for the first move, no
 * limit of current and voltage; exit policy hold.
 * @param[in,out] driver the caller's table, GROBO_TABLE_INIT(grobo_driver); change what is
 *   different in it afterwards.
 * @param model borrowed.
 * @param protocol grobo_rs30x_protocol, or grobo_board_protocol through GR001's board.
 * @return 0, or GROBO_ERR_ARG for a bad model, no protocol, a size that no version had.
 */
GROBO_API int grobo_rs30x_driver_init(grobo_driver *driver, const grobo_model *model,
                                      const grobo_protocol *protocol);

/**
 * Fills a table for a robot of DYNAMIXEL X servos (Protocol 2.0). grobo_joint.servo_model names the
 * servo by its model number. Goals come with a duration, which the servo takes for a profile: its
 * drive mode must be 4 (time, not reversed, not woken by a goal), and its operating mode 3, or 4
 * for a joint of several turns, or 5. All joints are read in one frame, and answer in one where the
 * firmware of each does (grobo_servo_model.fast_firmware). Torque on does not move a servo whose
 * goal is where it stands; whether it keeps an old goal depends on its firmware, so that the engine
 * always sets it. An error of its register shutdown cuts the torque until a reboot. No brake:
 * torque is on or off, and an emergency stop holds unless it is to release.
 * Its bus watchdog is the dead-man: a servo that nothing was sent to for watchdog_us, 0.5 s, stops
 * where it is and keeps its torque; a move, a play or a torque on clears that.
 * Limits: 65 deg C, 5 lost replies, 60 deg/s for the first move; exit policy hold; an arm.
 * @param[in,out] driver the caller's table, GROBO_TABLE_INIT(grobo_driver); change what is
 *   different in it afterwards.
 * @param model borrowed.
 * @return 0, or GROBO_ERR_ARG: a bad model, a servo that is not known, a joint beyond its reach.
 * Joints whose servo is set up otherwise are read with GROBO_ERR_SETUP, and never move.
 */
GROBO_API int grobo_dxl2_driver_init(grobo_driver *driver, const grobo_model *model);

/** The same for AX and MX servos with Protocol 1.0. They have no time of a move: its speed is that
 *  of the whole way. Joints are read one by one. An error of the register shutdown sets the torque
 *  limit to 0, which counts as torque lost. */
GROBO_API int grobo_dxl1_driver_init(grobo_driver *driver, const grobo_model *model);

/**
 * The same for Feetech's STS, SMS and SCS servos. STS have no time of a move but a speed, counted
 * in single steps (bit 2 of the register phase); all joints of STS are read in one frame. Torque on
 * with an old goal runs there: the engine sets the goal before. An overload bounds the output until
 * there is another goal or torque was off; it counts neither as heat nor as torque lost.
 */
GROBO_API int grobo_feetech_driver_init(grobo_driver *driver, const grobo_model *model);

/**
 * The same for LewanSoul's and Hiwonder's LX and HTS servos (lx16a.h). grobo_joint.servo_model is a
 * number of grobo_lx16a_table. Goals have a time in ms. One frame moves or reads one servo, and
 * writes are not answered: at most 32 joints. Servos measure neither
 * speed nor current: the engine takes the speed of two angles. A goal switches the torque on.
 * A register is named by its address in the table; GROBO_SERVO_FLASH keeps the offset.
 * @return 0, or GROBO_ERR_ARG: a bad model, a servo that is not known, a joint beyond its reach or
 *         of several turns.
 */
GROBO_API int grobo_lx16a_driver_init(grobo_driver *driver, const grobo_model *model);

/**
 * The same for Kondo's KRS servos with ICS 3.6 (ics.h), on a line with even parity, mostly with an
 * echo. grobo_joint.servo_model is a number of grobo_ics_table. Goals have no time: the servo's
 * speed is set before each goal, and taken for a part of its top speed. One frame moves or reads
 * one servo: a robot may have at most 18 joints. A goal is answered with where the joint is, and
 * switches the torque on. Servos report neither speed nor goal.
 * @return 0, GROBO_ERR_ARG: a bad model, a servo that is not known, a joint beyond its reach or of
 *         several turns; GROBO_ERR_UNSUPPORTED: a servo with ICS 3.5, which cannot tell where it is
 *         but by being moved or released.
 */
GROBO_API int grobo_ics_driver_init(grobo_driver *driver, const grobo_model *model);

/**
 * The table of HPI's GR001.
 * @param wiring through its board, or its servos straight on a bus.
 * @return a static table, or NULL for an unknown wiring. Thread safe.
 */
GROBO_API const grobo_driver *grobo_gr001_driver(grobo_wiring wiring);

GROBO_END_DECLS

#endif
