/* SPDX-License-Identifier: MIT */
/*
 * Units of .m files: a number n in a file is n * NAME / NAME_UNITS here, computed in this order, so
 * that writing can look for the n that gives a value to the bit.
 */
#ifndef GROBO_MOTION_UNITS_H
#define GROBO_MOTION_UNITS_H

/* Milliseconds. */
#define GROBO_I_M_SECOND 1.0
#define GROBO_I_M_SECOND_UNITS 1000.0
/* 0.1 degrees: pi radians are 1800. As grobo_rad_from_ddeg() computes. */
#define GROBO_I_M_ANGLE 3.14159265358979323846
#define GROBO_I_M_ANGLE_UNITS 1800.0

#endif
