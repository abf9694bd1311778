/* SPDX-License-Identifier: MIT */
/**
 * @file robot_file.h
 * @brief A robot as a file: what it is made of, how its line is, what is safe.
 *
 * A description is data. Those that come with the library are const tables, made from the files in
 * src/robots; any other is read from a file of the same form (docs/guide/own-robot.md). Either
 * fills a driver (driver.h) for the engine and the configuration of a simulator (sim.h).
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_ROBOT_FILE_H
#define GROBO_ROBOT_FILE_H

#include <grobo/core/body.h>
#include <grobo/core/driver.h>
#include <grobo/core/registers.h>
#include <grobo/core/sim_physics.h>
#include <grobo/core/words.h>
#include <grobo/motion_io.h>

GROBO_BEGIN_DECLS

/** A family of servos: one way to talk, and the models that talk so. */
typedef struct grobo_robot_family {
    const char *name;                   /**< "feetech": as a file names it */
    const grobo_servo_table *tables[3]; /**< of its models, NULL behind the last */
    uint32_t baud_bps;                  /**< where a file has none */
    grobo_wiring wiring;                /**< where a file has none */
    /** Fills a driver, as grobo_feetech_driver_init() does, by grobo_wiring; NULL: it cannot be
     *  wired so. */
    int (*init[2])(grobo_driver *driver, const grobo_model *model);
    bool fixed; /**< its servos have no registers but those of its tables: a user's model can add
                     none */
} grobo_robot_family;

/** Family i of those that a file may name, counted from 0. @return NULL behind the last. */
GROBO_API const grobo_robot_family *grobo_robot_family_at(size_t i);

/** All that the library knows of a family. A program that names the parts it uses is linked without
 *  the others; this is for programs that take any family. */
typedef struct grobo_family {
    const grobo_robot_family *robot; /**< tables, line and driver: what a robot's file names */
    const grobo_sim_family *sim;     /**< its simulated servos */
    const grobo_words *const *words; /**< what its frames say, by series, NULL behind the last */
} grobo_family;

/** Every family, in the order of grobo_robot_family_at(); `robot` is NULL behind the last. */
GROBO_API const grobo_family *grobo_families(void);

/** The simulated servos of these families, in the same order, NULL behind the last: what a
 *  grobo_sim_config names as its families. */
GROBO_API const grobo_sim_family *const *grobo_sim_families(void);

/** A USB adapter by its numbers. */
typedef struct grobo_usb_id {
    uint16_t vendor;
    uint16_t product;
} grobo_usb_id;

/** A rigid part. Its frame is that of its joint; angles are roll, pitch, yaw about fixed axes. */
typedef struct grobo_robot_link {
    const char *name;
    int8_t parent;        /**< index of the part that carries it, smaller than its own; -1: none */
    int8_t joint;         /**< the joint between them; -1: it is fixed */
    double origin_m[3];   /**< its frame in the parent's, where the joint is at 0 */
    double origin_rad[3]; /**< roll, pitch, yaw of it */
    double axis[3];       /**< of the joint, in its own frame, of length 1 */
    double mass_kg;       /**< 0: unknown */
    double com_m[3];      /**< centre of mass, in its frame */
    double inertia_kgm2[6]; /**< about that, along its axes: xx, yy, zz, xy, xz, yz */
} grobo_robot_link;

/** A foot: the last link of a leg, and the rectangle of its sole. */
typedef struct grobo_robot_foot {
    int8_t link;      /**< index of the part */
    double sole_m[3]; /**< centre of the sole, in the part's frame */
    double half_m[2]; /**< half of its length (along x) and width (along y) */
} grobo_robot_foot;

/** What a file says of a joint's motor, for a simulator with weight; 0: as the servo's model has it
 *  (grobo_sim_motor_of()). With any of it the motor counts as given (GROBO_SIM_MOTOR_GIVEN). */
typedef struct grobo_robot_motor {
    double kt_nm_a;
    double resistance_ohm;
    double armature_kgm2;
    double torque_max_nm;
    double friction_nm; /**< with viscous_nms all of its friction */
    double viscous_nms;
    double backlash_rad;
} grobo_robot_motor;

/** A line of a robot that has several. */
typedef struct grobo_robot_file_line {
    const char *name;                 /**< "left": what joints and commands call it */
    const grobo_robot_family *family; /**< of the servos on it */
    grobo_wiring wiring;
    uint32_t baud_bps;
    const char *port; /**< the device that it usually is; NULL: not told */
    bool echo;        /**< its adapter returns what is sent */
} grobo_robot_file_line;

/** A robot. Plain data; all that it points to lives as long as it. */
typedef struct grobo_robot_def {
    const char *name;                 /**< "so101": what it is called on a command line */
    const char *title;                /**< "SO-101 (follower)": for people */
    const grobo_robot_family *family; /**< of all of its servos; of several lines the first one's */
    const grobo_model *model;         /**< joints, groups; its name is `name`, but "GR001" */
    grobo_wiring wiring;              /**< how it usually is connected */
    uint32_t baud_bps;                /**< of its line, with 8 data bits and a stop bit; the parity
                                           is that of the family's protocol */
    const grobo_usb_id *usb;          /**< n_usb adapters that it is sold with */
    grobo_safety_limits limits;       /**< as in a driver */
    grobo_exit_policy on_exit;        /**< what GROBO_EXIT_DEFAULT stands for */
    const double *rest_rad;         /**< posture for GROBO_EXIT_SIT, by joint; NULL: initial one */
    const grobo_readback *readback; /**< n_readback corrections of what is read */
    const grobo_robot_link *links;  /**< n_links parts; none: its geometry is not known */
    uint8_t n_usb, n_readback, n_links;
    bool arm;            /**< it may stop anywhere: see grobo_driver */
    int8_t payload_link; /**< the part that holds what the robot carries; -1: not told */
    double payload_kg;   /**< the heaviest that its maker names; 0: not told */
    const grobo_robot_motor *motors;    /**< by joint; NULL: as the servos' models have them */
    uint8_t n_feet;                     /**< 2, or 0: they are not told */
    grobo_robot_foot feet[2];           /**< in either order */
    uint8_t n_lines;                    /**< 2 and more, or 0: one, as above */
    const grobo_robot_file_line *lines; /**< n_lines; grobo_joint.line counts them */
    const struct grobo_lines *on_lines; /**< what a driver of these is made of (core/lines.h) */
} grobo_robot_def;

/** Robot i of those that come with the library, counted from 0. @return NULL behind the last. */
GROBO_API const grobo_robot_def *grobo_robot_def_at(size_t i);
/** The robot of the library of this name ("so101"). @return NULL where there is none. */
GROBO_API const grobo_robot_def *grobo_robot_def_find(const char *name);

/**
 * Reads the description of a robot. Every mistake is in the list, with its line and column.
 * @param source where the bytes of the file come from
 * @param name the file's name in diagnostics
 * @param list diagnostics are added to it; NULL: none are kept
 * @param mem of the description and of reading; NULL: the C library's
 * @param[out] def to be freed with grobo_robot_def_free(); untouched on error.
 * @return 0; GROBO_ERR_SYNTAX (a mistake), GROBO_ERR_NAN, GROBO_ERR_CAP (a cap of limits.h),
 *   GROBO_ERR_NOMEM, or what the source gave. Every error but NOMEM adds a diagnostic.
 */
GROBO_API int grobo_robot_def_read(const grobo_source *source, const char *name,
                                   grobo_diagnostics *list, const grobo_mem *mem,
                                   grobo_robot_def **def);

/**
 * Reads the description of a robot from a file. A joint's servo may be a file of its own beside it
 * ("./my-servo.yaml", docs/guide/own-servo.md), whose mistakes are in the list with its name.
 * grobo_robot_def_read() refuses such a servo.
 * @return as grobo_robot_def_read(); GROBO_ERR_NOENT, GROBO_ERR_PERM, GROBO_ERR_ISDIR or
 *   GROBO_ERR_IO for a file itself
 */
GROBO_API int grobo_robot_def_read_file(const char *path, grobo_diagnostics *list,
                                        const grobo_mem *mem, grobo_robot_def **def);

/** Frees what grobo_robot_def_read() or grobo_robot_def_read_file() gave; NULL is fine. */
GROBO_API void grobo_robot_def_free(grobo_robot_def *def);

/** A robot's body, for body.h; it must stay where it is. */
typedef struct grobo_robot_body {
    grobo_body_model model;
    grobo_body_link links[GROBO_BODY_LINKS_MAX]; /**< the model's */
} grobo_robot_body;

/**
 * The body of a robot whose description has feet: its first link is the waist, and its legs are as
 * grobo_body_model asks. Frames of the body's links stand upright where all joints are at 0; parts
 * that are fixed are joined to what carries them.
 * @param def borrowed by the body
 * @return 0, GROBO_ERR_ARG, or GROBO_ERR_UNSUPPORTED: no feet, or legs that are not solved
 */
GROBO_API int grobo_robot_def_body(const grobo_robot_def *def, grobo_robot_body *body);

/**
 * Fills a driver for a robot, of several lines too (core/lines.h).
 * @param def borrowed by the driver
 * @param wiring of a robot of several lines that of its def
 * @param[in,out] driver GROBO_TABLE_INIT(grobo_driver)
 * @return 0, GROBO_ERR_ARG, or GROBO_ERR_UNSUPPORTED: its servos cannot be wired so
 */
GROBO_API int grobo_robot_def_driver(const grobo_robot_def *def, grobo_wiring wiring,
                                     grobo_driver *driver);

/** What a simulator of a robot needs beside its configuration. */
typedef struct grobo_robot_sim {
    grobo_sim_config config;                           /**< for grobo_sim_init() */
    const grobo_servo_model *servos[GROBO_JOINTS_MAX]; /**< config points here */
} grobo_robot_sim;

/**
 * Fills the configuration of a simulator: model, servos that are set up as the robot needs them,
 * line, supply. All else is 0, for the caller to change.
 * @param sim outlives the simulator, as def does
 * @return 0, or GROBO_ERR_ARG
 */
GROBO_API int grobo_robot_def_sim(const grobo_robot_def *def, grobo_wiring wiring,
                                  grobo_robot_sim *sim);

/**
 * Makes a world in which the robot has weight, for grobo_robot_sim.config.physics. The base is
 * fixed: a robot with legs hangs by its first link.
 * @param real_time see grobo_sim_physics_config
 * @param mem NULL: the C library's
 * @param[out] physics freed with grobo_sim_physics_free() after the simulator's last use. def must
 *   live as long
 * @return as grobo_sim_physics_new()
 */
GROBO_API int grobo_robot_def_physics(const grobo_robot_def *def, bool real_time,
                                      const grobo_mem *mem, grobo_sim_physics **physics);

GROBO_END_DECLS

#endif
