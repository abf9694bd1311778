/* SPDX-License-Identifier: MIT */
/**
 * @file core/unit.h
 * @brief What people give and read a joint in: degrees, millimetres, percent of its range.
 *
 * Postures, motions, limits and readings are radians whatever the unit is. A program converts where
 * it talks to people, by these functions.
 */
#ifndef GROBO_CORE_UNIT_H
#define GROBO_CORE_UNIT_H

#include <grobo/model.h>

GROBO_BEGIN_DECLS

/** A joint's unit (grobo_joint.unit). */
typedef enum grobo_unit {
    GROBO_UNIT_DEG = 0, /**< degrees */
    GROBO_UNIT_MM,      /**< millimetres: the joint is linear, as a rack or a spindle */
    GROBO_UNIT_PCT      /**< 0 to 100: a gripper from closed to open */
} grobo_unit;

/** The unit of a joint. GROBO_UNIT_DEG where there is no such joint. Thread safe. */
GROBO_API grobo_unit grobo_model_unit(const grobo_model *model, int joint);

/** "deg", "mm" or "%". @return never NULL. Thread safe. */
GROBO_API const char *grobo_unit_name(grobo_unit unit);

/**
 * The value of a joint, in its unit, where it is at an angle.
 * @param joint 0..n-1. @return NAN where there is none. Pure; thread safe.
 */
GROBO_API double grobo_model_value(const grobo_model *model, int joint, double angle_rad);

/**
 * The angle at which a joint has a value. One that is a limit but for the last bits is that limit.
 * @param joint 0..n-1. @return radians, NAN where there is no such joint. Pure; thread safe.
 */
GROBO_API double grobo_model_angle(const grobo_model *model, int joint, double value);

/**
 * A difference of angles in the unit of a joint, with the sign that it has there.
 * @param joint 0..n-1. @return NAN where there is none. Pure; thread safe.
 */
GROBO_API double grobo_model_change(const grobo_model *model, int joint, double by_rad);

GROBO_END_DECLS

#endif
