/* SPDX-License-Identifier: MIT */
/**
 * @file robot_motion.h
 * @brief RobotMotion of the reference document: postures one after the other, and their files.
 *
 * Postures are in motor order (robot_posture.h), and so are the columns of .m files: they are read
 * and written as they stand. Choreonoid's files are in joint order, so that they need a robot.
 * Times of Choreonoid's files are those of the file; the original cuts them to whole seconds, and
 * angles to whole degrees.
 *
 * A motion belongs to one thread.
 * NULL where something must be gives the return value of a failure; nothing happens then.
 */
#ifndef GROBO_CLASSIC_ROBOT_MOTION_H
#define GROBO_CLASSIC_ROBOT_MOTION_H

#include <grobo/classic/robot_posture.h>
#include <grobo/motion_io.h>

GROBO_BEGIN_DECLS

struct SerialRobot;

/** A motion. */
typedef struct RobotMotion {
    RobotPosture **motion; /**< its postures, RobotMotion_getSize() of them; they belong to it */
    int numJoints;         /**< of postures read from files */
    int current;           /**< of RobotMotion_next() */
    bool reverse;          /**< direction of RobotMotion_next() */
    /* private */
    int size;
    int capacity;
} RobotMotion;

/** RobotMotion(): empty, numJoints 0. @return 0, or -1: NULL. */
GROBO_CLASSIC_API int RobotMotion_init(RobotMotion *motion);
/** ~RobotMotion(): deletes all postures. */
GROBO_CLASSIC_API void RobotMotion_deinit(RobotMotion *motion);
/** new RobotMotion(). @return NULL: no memory. */
GROBO_CLASSIC_API RobotMotion *RobotMotion_new(void);
/** delete motion. NULL is fine. */
GROBO_CLASSIC_API void RobotMotion_delete(RobotMotion *motion);

/** Sets numJoints. @return n; -1 where it is not 0..GROBO_JOINTS_MAX. */
GROBO_CLASSIC_API int RobotMotion_setJoints(RobotMotion *motion, int n);
/** Number of postures. */
GROBO_CLASSIC_API int RobotMotion_getSize(const RobotMotion *motion);
/** Sets the direction, and goes to its first posture, as the original does. @return f. */
GROBO_CLASSIC_API int RobotMotion_setReverse(RobotMotion *motion, bool f);
/** Goes to the first posture, in reverse to the last. @return `current`; -1 in an empty motion in
 *  reverse. */
GROBO_CLASSIC_API int RobotMotion_reset(RobotMotion *motion);
/** The posture at `current`, which steps on, behind the last to the first again.
 *  @return NULL: the motion is empty. */
GROBO_CLASSIC_API RobotPosture *RobotMotion_next(RobotMotion *motion);
/** Posture nth from the front, counted from 0. @return NULL: there is none. */
GROBO_CLASSIC_API RobotPosture *RobotMotion_get(const RobotMotion *motion, int nth);
/** get(size - nth): 1 is the last. @return NULL: there is none, as for 0. */
GROBO_CLASSIC_API RobotPosture *RobotMotion_rget(const RobotMotion *motion, int nth);
/** Appends a posture: it belongs to the motion then. One that is in the caller's own storage, or in
 *  a motion already, is copied. @return false: no memory. */
GROBO_CLASSIC_API bool RobotMotion_appendPosture(RobotMotion *motion, RobotPosture *js);
/** Inserts a posture before posture nth; beyond the end it is appended. As appendPosture(). */
GROBO_CLASSIC_API bool RobotMotion_insertPosture(RobotMotion *motion, RobotPosture *js, int nth);
/** Deletes posture n. There is none: nothing happens. */
GROBO_CLASSIC_API void RobotMotion_deletePosture(RobotMotion *motion, int n);
/** Reads a .m file of numJoints columns; missing ones are 0. @return false, and the motion stays:
 *  the file cannot be read. */
GROBO_CLASSIC_API bool RobotMotion_loadMotionFromFile(RobotMotion *motion, const char *name);
/** saveMotionToFile(name): writes a .m file. An old file is replaced whole or not at all, and only
 *  where it is a motion of that format. @return false: nothing was written. */
GROBO_CLASSIC_API bool RobotMotion_saveMotionToFile(const RobotMotion *motion, const char *name);
/** saveMotionToFile(name, dir): writes the first of dir/name0.m, dir/name1.m, ... that is not there
 *  yet, as the original does. @param dir "": the present directory. */
GROBO_CLASSIC_API bool RobotMotion_saveMotionToFile_dir(const RobotMotion *motion, const char *name,
                                                        const char *dir);
/** Reads increments (.mseq): each posture is the one before with its increments added, the first
 *  counts from r's currentPosture. @return false, and the motion stays. */
GROBO_CLASSIC_API bool RobotMotion_loadMotionFromMseqFile(RobotMotion *motion, const char *name,
                                                          struct SerialRobot *r);
/** Reads Choreonoid's key poses (.pseq): a joint that a pose does not set is as in the posture
 *  before, in the first as in r's currentPosture. @return false, and the motion stays. */
GROBO_CLASSIC_API bool RobotMotion_loadMotionFromPseqFile(RobotMotion *motion, const char *name,
                                                          struct SerialRobot *r);
/** Reads Choreonoid's body motion (.yaml), one posture a frame. @return false, and the motion
 *  stays. */
GROBO_CLASSIC_API bool RobotMotion_loadMotionFromYamlFile(RobotMotion *motion, const char *name,
                                                          struct SerialRobot *r);
/** Writes Choreonoid's key poses; the original cannot. @return false: nothing was written. */
GROBO_CLASSIC_API bool RobotMotion_saveMotionToPseqFile(const RobotMotion *motion, const char *name,
                                                        struct SerialRobot *r);
/** Writes Choreonoid's body motion; the original cannot. @return false: nothing was written. */
GROBO_CLASSIC_API bool RobotMotion_saveMotionToYamlFile(const RobotMotion *motion, const char *name,
                                                        struct SerialRobot *r);
/** Prints each posture with its number and time, a line each on standard error. */
GROBO_CLASSIC_API void RobotMotion_printMotion(const RobotMotion *motion);
/** printMotion(stream): the lines of a .m file into a stream: the time in ms counted from the
 *  beginning, then the angles. */
GROBO_CLASSIC_API void RobotMotion_printMotion_stream(const RobotMotion *motion, FILE *stream);
/** Deletes all postures. */
GROBO_CLASSIC_API void RobotMotion_clear(RobotMotion *motion);
/** Appends copies of rm's postures. (The original shares them, and frees them twice.)
 *  @return false: no memory; then none is appended. */
GROBO_CLASSIC_API bool RobotMotion_appendMotion(RobotMotion *motion, const RobotMotion *rm);
/** A copy with postures of its own. @return NULL: no memory. */
GROBO_CLASSIC_API RobotMotion *RobotMotion_dupMotion(const RobotMotion *motion);

GROBO_END_DECLS

#endif
