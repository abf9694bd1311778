/* SPDX-License-Identifier: MIT */
/**
 * @file posture.h
 * @brief The angles of a robot's joints, which of them are meant, and the time to get there.
 *
 * One truth for an angle: radians in double. Degrees and the wire's 0.1 degree are views, computed
 * by rounding to nearest. All functions are pure or touch only their arguments: safe from any
 * thread that owns the posture.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_POSTURE_H
#define GROBO_POSTURE_H

#include <grobo/model.h>

GROBO_BEGIN_DECLS

/** Time of a fresh posture (reference document, RobotPosture: 100 ms). */
#define GROBO_POSTURE_TIME_US 100000

/** A posture. Plain data: copy it with =. Angles of joints outside `set` mean nothing. */
typedef struct grobo_posture {
    grobo_joint_mask set;               /**< which joints this posture gives */
    int64_t time_us;                    /**< time to reach it; 0: the default time of the player */
    uint8_t n_joints;                   /**< 0..GROBO_JOINTS_MAX */
    double angle_rad[GROBO_JOINTS_MAX]; /**< by joint, 0..n_joints-1 */
} grobo_posture;

/** Degrees of an angle in radians. */
GROBO_API double grobo_deg_from_rad(double angle_rad);
/** Radians of an angle in degrees. */
GROBO_API double grobo_rad_from_deg(double angle_deg);
/**
 * The wire's unit of an angle: 0.1 degree, rounded to nearest, halves away from zero, saturated
 * to int16_t. NaN gives 0: check first with grobo_posture_check().
 */
GROBO_API int16_t grobo_ddeg_from_rad(double angle_rad);
/** Radians of an angle in 0.1 degree. */
GROBO_API double grobo_rad_from_ddeg(int angle_ddeg);

/**
 * Makes an empty posture: no joint set, angles 0, time GROBO_POSTURE_TIME_US.
 * @param n_joints 0..GROBO_JOINTS_MAX
 * @return 0, or GROBO_ERR_CAP.
 */
GROBO_API int grobo_posture_init(grobo_posture *posture, int n_joints);

/** The model's initial posture, every joint set but wheels, time as grobo_posture_init() gives. */
GROBO_API void grobo_posture_init_pose(grobo_posture *posture, const grobo_model *model);

/** Sets one joint. @return 0, GROBO_ERR_ARG (no such joint) or GROBO_ERR_NAN. */
GROBO_API int grobo_posture_set_rad(grobo_posture *posture, int joint, double angle_rad);
/** Sets one joint in degrees. Errors as grobo_posture_set_rad(). */
GROBO_API int grobo_posture_set_deg(grobo_posture *posture, int joint, double angle_deg);
/** Reads one joint. @return 0, GROBO_ERR_ARG (no such joint) or GROBO_ERR_EMPTY (not set). */
GROBO_API int grobo_posture_get_rad(const grobo_posture *posture, int joint, double *angle_rad);
/** Reads one joint in degrees. Errors as grobo_posture_get_rad(). */
GROBO_API int grobo_posture_get_deg(const grobo_posture *posture, int joint, double *angle_deg);
/**
 * All angles in degrees, in joint order; joints not set give NaN.
 * @return number of joints written, or GROBO_ERR_SPACE if capacity < n_joints.
 */
GROBO_API int grobo_posture_all_deg(const grobo_posture *posture, double *angle_deg,
                                    size_t capacity);
/** All angles in radians; as grobo_posture_all_deg(). */
GROBO_API int grobo_posture_all_rad(const grobo_posture *posture, double *angle_rad,
                                    size_t capacity);
/**
 * Sets the time to reach the posture.
 * @param time_ms finite, 0..163830 (what register No.32-33 can hold: 16383 x 10 ms)
 * @return 0, or GROBO_ERR_ARG.
 */
GROBO_API int grobo_posture_set_time_ms(grobo_posture *posture, double time_ms);

/**
 * Copies time and angles into another posture, which keeps its own number of joints: joint
 * `offset + k` of src becomes joint k of dst, as far as both reach. Joints of dst beyond are as
 * they were.
 * @return number of joints copied, or GROBO_ERR_ARG (offset negative or beyond src).
 */
GROBO_API int grobo_posture_copy(grobo_posture *dst, const grobo_posture *src, int offset);

/** Takes over those angles of `over` that are set; n_joints and time stay. */
GROBO_API void grobo_posture_merge(grobo_posture *posture, const grobo_posture *over);

/** True if the same joints are set to exactly the same angles (times are not compared). */
GROBO_API bool grobo_posture_equal(const grobo_posture *a, const grobo_posture *b);
/** True if the same joints are set and every angle differs by less than delta_rad. */
GROBO_API bool grobo_posture_near(const grobo_posture *a, const grobo_posture *b, double delta_rad);

/** Mirrors left and right by the model's table. @return 0, or GROBO_ERR_ARG if n_joints differ. */
GROBO_API int grobo_posture_mirror(grobo_posture *posture, const grobo_model *model);

/**
 * Checks what is set against numbers and limits.
 * @param[out] joint where not NULL: the first joint at fault; untouched when all is well.
 * @return 0, GROBO_ERR_NAN, GROBO_ERR_LIMIT, or GROBO_ERR_ARG if n_joints differ. A limit is kept
 * when the angle rounded to 0.1 degree keeps it.
 */
GROBO_API int grobo_posture_check(const grobo_posture *posture, const grobo_model *model,
                                  int *joint);
/** Moves every set angle into its limits. @return joints changed, or GROBO_ERR_ARG, _NAN. */
GROBO_API int grobo_posture_clamp(grobo_posture *posture, const grobo_model *model);

/**
 * Parses the seed's line form "time a1 .. an": time in ms, angles in 0.1 degree in motor order
 * (GR001::setJointsFromString). Fewer angles set fewer joints.
 * @return number of angles read, GROBO_ERR_SYNTAX, or GROBO_ERR_CAP for more angles than joints.
 */
GROBO_API int grobo_posture_parse(grobo_posture *posture, const grobo_model *model,
                                  const char *text, size_t length);

GROBO_END_DECLS

#endif
