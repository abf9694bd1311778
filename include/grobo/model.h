/* SPDX-License-Identifier: MIT */
/**
 * @file model.h
 * @brief What a robot is made of: joints, motors, groups, limits. Tables of constants.
 *
 * A model is data: a robot of one's own is a table of its own. Joint order (0..n-1) is the order
 * of postures and of Choreonoid's files; motor numbers are the ids on the wire.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_MODEL_H
#define GROBO_MODEL_H

#include <grobo/types.h>

GROBO_BEGIN_DECLS

/** One joint and the servo that moves it. grobo_model.joint_size is the size of one. */
typedef struct grobo_joint {
    const char *name;         /**< "R_KNEE_P" */
    double min_rad;           /**< lower limit of the angle */
    double max_rad;           /**< upper limit of the angle */
    double max_speed_rad_s;   /**< what the servo can do without load */
    double init_rad;          /**< angle in the initial posture */
    uint16_t servo_model;     /**< register No.0-1 of the servo, 0 where it does not matter */
    uint16_t free_current_ma; /**< free (teaching) mode brakes above this current, 0: never */
    uint8_t motor;            /**< id on the wire, 0..GROBO_SERVO_ID_MAX */
    uint8_t mirror;           /**< joint that takes this one's place in the mirror, or itself */
    int8_t mirror_sign;       /**< +1 or -1: sign of the angle in the mirror */
    int8_t sign;              /**< -1: the servo turns against the joint; else with it */
    bool turns;               /**< the servo counts several turns; else its angle is within one */
    double zero_rad;          /**< angle of the servo, from its middle, where the joint is at 0 */
    double gear;              /**< turns of the servo for one of the joint; 0: 1 */
    bool calibrated;          /**< its servo keeps a middle and a range that were found by hand: one
                                   as it left its factory is not moved, and a narrower range narrows
                                   the limits. Else the middle must be the factory's, and the servo
                                   must reach the limits */
    uint8_t
        torque_limit_pct; /**< of what its servo can, 1..100: set before it gets torque; 0: all */
    /** Its servo: of a table of its family, or of a user's file. NULL: the first of the family
     *  whose number is servo_model. grobo_robot_def_read() sets it, as two may have one number. */
    const struct grobo_servo_model *servo;
#if !GROBO_DRIVERS_PLAIN
    /** A joint with a ratio follows another one: whatever moves, stops, switches or frees one of
     *  the two does so with both, in one frame where the family can, and it goes to `ratio` times
     *  the other's angle. It cannot be sent anywhere else. 0: it follows none. */
    double ratio;
    /** Two servos on one shaft: so far from there, by what is read of both, the engine stops
     *  (GROBO_TRIP_APART), and a stop sends both to one place. 0: each has a shaft of its own. */
    double apart_rad;
    uint8_t follows; /**< the joint that it follows, which follows none itself */
    /** What people give and read the joint in, a grobo_unit (core/unit.h): the library's own angles
     *  stay radians. 0: degrees. */
    uint8_t unit;
    uint8_t line;         /**< which line its servo is on, 0..GROBO_LINES_MAX-1 (core/lines.h) */
    double unit_zero_rad; /**< its angle where its value is 0 */
    double unit_rad;      /**< how much the angle grows for 1 of the unit, not 0; of degrees 0 */
    /** A wheel has speeds (core/wheel.h) and no angle to go to: its limits and initial angle are 0,
     *  the angle read is that of its servo's shaft within one turn, whatever its gear, and what
     *  moves joints to angles leaves it out or refuses it. max_speed_rad_s is the most that it may
     *  be asked for. */
    bool wheel;
    double accel_rad_s2; /**< how fast a wheel's speed may change, > 0; of other joints 0 */
#endif
} grobo_joint;

/** The angle of a joint's servo, from the middle of its range, where the joint is at an angle. */
GROBO_API double grobo_joint_to_servo(const grobo_joint *joint, double angle_rad);

/** The angle of a joint where its servo is at an angle, from the middle of its range. */
GROBO_API double grobo_joint_from_servo(const grobo_joint *joint, double servo_rad);

/** A named set of joints. */
typedef struct grobo_group {
    const char *name;        /**< "right_arm" */
    grobo_joint_mask joints; /**< its joints */
} grobo_group;

/** A robot's table. Borrowed by whatever is given one: it must outlive its users. */
typedef struct grobo_model {
#if !GROBO_TABLES_FIXED
    size_t size; /**< GROBO_TABLE() */
#endif
    const char *name;          /**< "GR001" */
    const grobo_joint *joints; /**< n_joints of them, in joint order; GROBO_MODEL_JOINTS() sets them
                                    with their size. grobo_model_joint() reads one */
#if !GROBO_TABLES_FIXED
    size_t joint_size; /**< sizeof(grobo_joint), as the program was compiled */
#endif
    const grobo_group *groups; /**< n_groups of them; the index is the seed's group number */
    uint8_t n_joints;          /**< 1..GROBO_JOINTS_MAX */
    uint8_t n_groups;          /**< may be 0 */
    /**
     * How far outside a joint's limits a motion file's angle may be and still be played: it is
     * played at the limit. 0..GROBO_LIMIT_SLACK_MAX_DEG degrees. See grobo_model_take_slack().
     */
    double limit_slack_deg;
    /**
     * Names of other models whose motions are for this one too, because their joints have the same
     * names in the same order. NULL-terminated; NULL: none. grobo_robot_def_read() sets it to those
     * of the library; see grobo_motion_is_for().
     */
    const char *const *alike;
} grobo_model;

/** Initializes the joints of a model, in GROBO_TABLE(grobo_model, ...): an array, or a pointer. */
#if GROBO_TABLES_FIXED
#define GROBO_MODEL_JOINTS(array) .joints = (array)
#elif !defined(__cplusplus) || __cplusplus >= 202002L
#define GROBO_MODEL_JOINTS(array) .joints = (array), .joint_size = sizeof(grobo_joint)
#else
#define GROBO_MODEL_JOINTS(array) (array), sizeof(grobo_joint)
#endif

/**
 * A joint of a model. A program must not index `joints` of a model that the library made: a library
 * of another version has larger ones.
 * @param joint 0..n-1. @return NULL where there is none. Thread safe.
 */
GROBO_API const grobo_joint *grobo_model_joint(const grobo_model *model, int joint);

/**
 * Checks a table: its sizes (GROBO_TABLE()), counts within caps, names present and unique, motors
 * unique on their line and within 0..GROBO_SERVO_ID_MAX (its family may have fewer:
 * grobo_driver_check()), limits finite with min <= init <= max, speed > 0, mirrors pairing up with
 * equal signs, a finite zero, a gear that is not negative, a torque limit of at most 100, a slack
 * within its range, joints that follow one that follows none, with limits and an initial angle that
 * are that one's times the ratio, a unit with its scale, wheels without limits, ratio or unit and
 * with an acceleration, a line within GROBO_LINES_MAX.
 * @return 0, or GROBO_ERR_ARG. Pure; thread safe.
 */
GROBO_API int grobo_model_check(const grobo_model *model);

/**
 * The angle at which a joint plays an angle of a motion file: the nearest limit where that is
 * exceeded by no more than the model's limit_slack_deg, else the angle as it is. Moves and raw
 * frames have no slack; nothing applies it by itself.
 * @param joint 0..n-1
 * @return radians. Pure; thread safe.
 */
GROBO_API double grobo_model_take_slack(const grobo_model *model, int joint, double angle_rad);

/** Joint moved by a motor. @return joint 0..n-1, or GROBO_ERR_NOTFOUND. Thread safe. */
GROBO_API int grobo_model_joint_of_motor(const grobo_model *model, int motor);

/** Motor of a joint. @return motor id, or GROBO_ERR_ARG. Thread safe. */
GROBO_API int grobo_model_motor_of_joint(const grobo_model *model, int joint);

/**
 * A model's joints in motor order: line by line, on each by the ids of their servos. Postures of
 * text and .m files are in it.
 * @param[out] joints room for GROBO_JOINTS_MAX: joints[i] is the i-th
 * @return how many, or GROBO_ERR_ARG. Thread safe.
 */
GROBO_API int grobo_model_motor_order(const grobo_model *model, uint8_t *joints);

/**
 * Joint called name[0..length-1]: its name in any case ("r_knee_p"), its motor ("m12", where no
 * other line has that id) or its joint id ("j3").
 * @return joint 0..n-1, or GROBO_ERR_NOTFOUND. The text is not changed. Thread safe.
 */
GROBO_API int grobo_model_find_joint(const grobo_model *model, const char *name, size_t length);

/**
 * Joints called name[0..length-1]: a group's name in any case, a group's number ("0".."7" for
 * GR001), or anything grobo_model_find_joint() takes.
 * @param[out] joints the set found; untouched on error.
 * @return number of joints in it, or GROBO_ERR_NOTFOUND. Thread safe.
 */
GROBO_API int grobo_model_find_joints(const grobo_model *model, const char *name, size_t length,
                                      grobo_joint_mask *joints);

/** Number of joints in a mask. Thread safe. */
GROBO_API int grobo_joints_count(grobo_joint_mask joints);

/** HPI GR001: 20 joints, groups all body right_arm left_arm arms right_leg left_leg legs. */
GROBO_API const grobo_model *grobo_gr001_model(void);

GROBO_END_DECLS

#endif
