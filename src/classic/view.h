/* SPDX-License-Identifier: MIT */
/*
 * What GR001 of the classic shelf has in the manner of hrpsys, on an engine: joints and groups by
 * name, angles in joint order, emergencies in words. Nothing here waits. Names are found in any
 * case, and no text is changed. It knows no SerialRobot.
 */
#ifndef GROBO_CLASSIC_VIEW_I_H
#define GROBO_CLASSIC_VIEW_I_H

#include <stdio.h>

#include <grobo/robot.h>

/* Groups of joints that may be added. */
#define VIEW_GROUPS 16

/* Room that every reason of an emergency fits into, with its NUL. */
#define VIEW_REASON_MAX_BYTES 128

typedef struct classic_view {
    grobo_robot *robot;
    struct {
        char name[GROBO_NAME_MAX_BYTES];
        grobo_joint_mask joints;
    } groups[VIEW_GROUPS];
    unsigned n_groups;
} classic_view;

/* Begins with no groups but the model's. robot is borrowed. */
void grobo_classic_view_init(classic_view *view, grobo_robot *robot);

/* Joints called so: "all", a joint, a group of the model or one that was added. A bare number is no
 * name. @return number of joints, or GROBO_ERR_NOTFOUND, and *joints is as it was. */
int grobo_classic_find(const classic_view *view, const char *name, grobo_joint_mask *joints);

/* Gives a name to some joints; groups among them stand for their joints. @return number of joints;
 * GROBO_ERR_NOTFOUND (one of joints: no group is made), GROBO_ERR_EXISTS (the name is taken),
 * GROBO_ERR_ARG (no name, a number, no joints), GROBO_ERR_CAP (name too long), GROBO_ERR_FULL. */
int grobo_classic_add_group(classic_view *view, const char *name, const char *const *joints,
                            size_t n);

/* The motor numbers of n names, one each: no groups. @return n, or GROBO_ERR_NOTFOUND, and motors
 * are as they were. */
int grobo_classic_motors_of(const classic_view *view, const char *const *names, size_t n,
                            int *motors);

/* Switches the torque of what grobo_classic_find() finds. @return a job number, or an error. */
int grobo_classic_servo_name(classic_view *view, const char *name, bool on);

/* The angles read last, in joint order; NaN for joints not read within max_age_us. @return number
 * of joints that have an angle, or GROBO_ERR_SPACE (capacity < joints). */
int grobo_classic_read_angles(const classic_view *view, int64_t max_age_us, double *angle_rad,
                              size_t capacity);

/* Has the engine stopped? @param[out] reason "over-temperature: NECK_Y at 71 deg C". @param[out]
 * joint which, or -1 where it is no single one; may be NULL. Both are untouched unless 1 is
 * returned. @return 1 for an emergency, 0 for none, GROBO_ERR_SPACE. */
int grobo_classic_emergency(const classic_view *view, char *reason, size_t reason_bytes,
                            int *joint);

/* ---- people.c: for people, into a stream ------------------------------------------------- */

/* Voltages and currents read last, in motor order; -1 for those that were never read. @return
 * number of motors that have one. */
int grobo_classic_voltages(const grobo_robot *robot, int32_t voltage_mv[GROBO_JOINTS_MAX]);
int grobo_classic_currents(const grobo_robot *robot, int32_t current_ma[GROBO_JOINTS_MAX]);

/* Mean of the voltages, rounded. @return mV, or GROBO_ERR_STALE where there is none. */
int grobo_classic_mean_mv(const grobo_robot *robot);

/* Prints the voltage of each motor that was ever read, a line each, and their mean; the currents; a
 * posture of GR001 in degrees as the body stands, "-" for joints not set. @return 0, GROBO_ERR_IO,
 * of a posture GROBO_ERR_ARG (not 20 joints). */
int grobo_classic_print_voltages(const grobo_robot *robot, FILE *stream);
int grobo_classic_print_currents(const grobo_robot *robot, FILE *stream);
int grobo_classic_print_posture(const grobo_posture *posture, FILE *stream);

#endif
