/* SPDX-License-Identifier: MIT */
/* RobotMotion of the classic shelf: an array of postures in motor order; files by grobo_motion. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/classic/classic.h"

/* Numbers that a name may get: name0.m ... */
#define NAMES_MAX 1000000

/* ---- making ------------------------------------------------------------------------------- */

int RobotMotion_init(RobotMotion *motion)
{
    if (motion == NULL) {
        return -1;
    }
    *motion = (RobotMotion){.numJoints = 0};
    return 0;
}

void RobotMotion_deinit(RobotMotion *motion)
{
    if (motion != NULL) {
        RobotMotion_clear(motion);
        free(motion->motion);
        (void)RobotMotion_init(motion);
    }
}

RobotMotion *RobotMotion_new(void)
{
    RobotMotion *motion = malloc(sizeof *motion);

    if (motion != NULL) {
        (void)RobotMotion_init(motion);
    }
    return motion;
}

void RobotMotion_delete(RobotMotion *motion)
{
    RobotMotion_deinit(motion);
    free(motion);
}

/* ---- walking through ---------------------------------------------------------------------- */

int RobotMotion_setJoints(RobotMotion *motion, int n)
{
    if (motion == NULL || n < 0 || n > GROBO_JOINTS_MAX) {
        return -1;
    }
    return motion->numJoints = n;
}

int RobotMotion_getSize(const RobotMotion *motion)
{
    return motion != NULL ? motion->size : 0;
}

int RobotMotion_setReverse(RobotMotion *motion, bool f)
{
    if (motion != NULL) {
        motion->reverse = f;
        (void)RobotMotion_reset(motion);
    }
    return f;
}

int RobotMotion_reset(RobotMotion *motion)
{
    return motion == NULL ? -1 : (motion->current = motion->reverse ? motion->size - 1 : 0);
}

RobotPosture *RobotMotion_next(RobotMotion *motion)
{
    if (RobotMotion_getSize(motion) == 0) {
        return NULL;
    }
    /* Postures may have been deleted since, or a program may have set it. */
    int at = motion->current > 0 && motion->current < motion->size ? motion->current : 0;
    motion->current = (at + (motion->reverse ? motion->size - 1 : 1)) % motion->size;
    return motion->motion[at];
}

RobotPosture *RobotMotion_get(const RobotMotion *motion, int nth)
{
    return nth >= 0 && nth < RobotMotion_getSize(motion) ? motion->motion[nth] : NULL;
}

RobotPosture *RobotMotion_rget(const RobotMotion *motion, int nth)
{
    return nth > 0 ? RobotMotion_get(motion, RobotMotion_getSize(motion) - nth) : NULL;
}

/* ---- postures ----------------------------------------------------------------------------- */

static bool make_room(RobotMotion *motion, int size)
{
    if (size > motion->capacity) {
        int capacity = size + size / 2 + 8;
        RobotPosture **grown = realloc(motion->motion, (size_t)capacity * sizeof *grown);
        if (grown == NULL) {
            return false;
        }
        motion->motion = grown;
        motion->capacity = capacity;
    }
    return true;
}

bool RobotMotion_appendPosture(RobotMotion *motion, RobotPosture *js)
{
    return RobotMotion_insertPosture(motion, js, RobotMotion_getSize(motion));
}

bool RobotMotion_insertPosture(RobotMotion *motion, RobotPosture *js, int nth)
{
    if (motion == NULL || js == NULL || motion->size >= GROBO_MOTION_FRAMES_MAX ||
        !make_room(motion, motion->size + 1)) {
        return false;
    }
    RobotPosture *own = js->home == POSTURE_FREE ? js : RobotPosture_dupPosture(js);
    if (own == NULL) {
        return false;
    }
    int at = nth < 0 ? 0 : nth < motion->size ? nth : motion->size;
    memmove(motion->motion + at + 1, motion->motion + at,
            (size_t)(motion->size - at) * sizeof *motion->motion);
    own->home = POSTURE_IN_MOTION;
    motion->motion[at] = own;
    motion->size++;
    return true;
}

void RobotMotion_deletePosture(RobotMotion *motion, int n)
{
    RobotPosture *posture = RobotMotion_get(motion, n);

    if (posture != NULL) {
        motion->size--;
        memmove(motion->motion + n, motion->motion + n + 1,
                (size_t)(motion->size - n) * sizeof *motion->motion);
        posture->home = POSTURE_FREE;
        RobotPosture_delete(posture);
    }
}

void RobotMotion_clear(RobotMotion *motion)
{
    while (RobotMotion_getSize(motion) > 0) {
        RobotMotion_deletePosture(motion, motion->size - 1);
    }
}

bool RobotMotion_appendMotion(RobotMotion *motion, const RobotMotion *rm)
{
    int before = RobotMotion_getSize(motion);
    int n = RobotMotion_getSize(rm);

    if (motion == NULL || rm == NULL) {
        return false;
    }
    for (int i = 0; i < n; i++) {
        if (!RobotMotion_appendPosture(motion, rm->motion[i])) {
            while (motion->size > before) {
                RobotMotion_deletePosture(motion, motion->size - 1);
            }
            return false;
        }
    }
    return true;
}

RobotMotion *RobotMotion_dupMotion(const RobotMotion *motion)
{
    RobotMotion *copy = motion != NULL ? RobotMotion_new() : NULL;

    if (copy != NULL && !RobotMotion_appendMotion(copy, motion)) {
        RobotMotion_delete(copy);
        return NULL;
    }
    if (copy != NULL) {
        copy->numJoints = motion->numJoints;
    }
    return copy;
}

/* ---- to and from grobo_motion ------------------------------------------------------------- */

/* A posture as it stands, element by element. */
static int plain(const RobotPosture *from, grobo_posture *to)
{
    int r = grobo_posture_init(to, from->numJoints);

    for (int i = 0; r >= 0 && i < from->numJoints; i++) {
        r = grobo_posture_set_rad(to, i, grobo_classic_rad(from->jointAngles[i]));
    }
    to->time_us = grobo_classic_time_us(from->motionTime);
    return r;
}

/* Appends postures, by motors or by the joints of a robot. */
static int append_all(const SerialRobot *robot, const RobotMotion *from, grobo_motion *to)
{
    int r = GROBO_OK;

    for (int i = 0; r >= 0 && i < from->size; i++) {
        const RobotPosture *posture = from->motion[i];
        grobo_posture one;
        if (robot == NULL) {
            r = plain(posture, &one);
        } else {
            grobo_classic_to_joints(robot, posture, &one);
        }
        r = r < 0 ? r : grobo_motion_append(to, &one);
    }
    return r;
}

static int convert(const SerialRobot *robot, const RobotMotion *from, int n_joints,
                   grobo_motion **to)
{
    int r = grobo_motion_new(GROBO_MOTION_POSTURES, n_joints, NULL, to);

    if (r >= 0 && (r = append_all(robot, from, *to)) < 0) {
        grobo_motion_free(*to);
    }
    return r;
}

int grobo_classic_to_motion(const RobotMotion *from, grobo_motion **to)
{
    int n_joints = from->numJoints;

    for (int i = 0; i < from->size; i++) {
        n_joints = from->motion[i]->numJoints > n_joints ? from->motion[i]->numJoints : n_joints;
    }
    return convert(NULL, from, n_joints, to);
}

int grobo_classic_to_joint_motion(const SerialRobot *robot, const RobotMotion *from,
                                  grobo_motion **to)
{
    return convert(robot, from, robot->joints, to);
}

/* One posture of a file as one of a RobotMotion; `last` is the one before, and takes it over. */
static void take(const SerialRobot *robot, grobo_motion_kind kind, const grobo_posture *from,
                 RobotPosture *last)
{
    RobotPosture moved = *last;

    if (robot == NULL) {
        for (int i = 0; i < last->numJoints && i < from->n_joints; i++) {
            RobotPosture_setRad(last, i + 1, from->angle_rad[i]);
        }
    } else if (kind == GROBO_MOTION_STEPS) {
        memset(moved.jointAngles, 0, sizeof moved.jointAngles);
        grobo_classic_to_motors(robot, from, &moved);
        for (int i = 0; i < last->numJoints; i++) {
            RobotPosture_setDegree(last, i + 1, last->jointAngles[i] + moved.jointAngles[i]);
        }
    } else {
        grobo_classic_to_motors(robot, from, last);
    }
    last->motionTime = (double)from->time_us / 1000;
}

/* The first frame of a body motion stands at 0: it takes the time of the second. */
static void time_first(RobotMotion *motion, grobo_motion_kind kind)
{
    if (kind == GROBO_MOTION_FRAMES && motion->size > 1 && motion->motion[0]->motionTime <= 0) {
        motion->motion[0]->motionTime = motion->motion[1]->motionTime;
    }
}

/* Replaces the postures of a motion by those of a file. */
static int replace(RobotMotion *motion, const SerialRobot *robot, const grobo_motion *file)
{
    RobotMotion made = {.numJoints = robot != NULL ? robot->joints : motion->numJoints};
    grobo_motion_kind kind = grobo_motion_get_kind(file);
    RobotPosture last;
    grobo_posture posture;

    (void)RobotPosture_init(&last, made.numJoints);
    if (robot != NULL) {
        RobotPosture_copyPosture(&last, robot->currentPosture);
    }
    for (size_t i = 0; grobo_motion_get(file, i, &posture) >= 0; i++) {
        take(robot, kind, &posture, &last);
        if (!RobotMotion_appendPosture(&made, &last)) {
            RobotMotion_deinit(&made);
            return GROBO_ERR_NOMEM;
        }
    }
    time_first(&made, kind);
    made.reverse = motion->reverse;
    RobotMotion_deinit(motion);
    *motion = made;
    (void)RobotMotion_reset(motion);
    return motion->size;
}

static bool is_for(const grobo_motion *file, grobo_motion_format format, const SerialRobot *robot)
{
    return format == GROBO_FORMAT_M ? grobo_motion_joints(file) == robot->joints
                                    : grobo_motion_is_for(file, grobo_classic_model(robot));
}

int grobo_classic_load(RobotMotion *motion, const char *path, grobo_motion_format format,
                       SerialRobot *robot)
{
    grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .format = format};
    grobo_motion *file = NULL;

    if (motion == NULL || path == NULL || (robot == NULL && format != GROBO_FORMAT_M)) {
        return GROBO_ERR_ARG;
    }
    if (format == GROBO_FORMAT_AUTO) {
        format = grobo_motion_format_of_path(path);
    }
    /* Columns of .m are motors, as postures are. */
    options.model = format != GROBO_FORMAT_M ? grobo_classic_model(robot) : NULL;
    int r = grobo_motion_read_file(path, &options, NULL, &file);
    /* Six angles would move the first six motors, and the others to 0. */
    if (r >= 0 && robot != NULL && !is_for(file, format, robot)) {
        grobo_motion_free(file);
        return GROBO_ERR_ARG;
    }
    if (r >= 0) {
        r = replace(motion, format != GROBO_FORMAT_M ? robot : NULL, file);
        grobo_motion_free(file);
    }
    return r;
}

int grobo_classic_save(const RobotMotion *motion, const char *path, grobo_motion_format format,
                       const SerialRobot *robot)
{
    grobo_motion *file = NULL;
    grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .format = format};

    if (motion == NULL || path == NULL || (robot == NULL && format != GROBO_FORMAT_M)) {
        return GROBO_ERR_ARG;
    }
    int r = format == GROBO_FORMAT_M ? grobo_classic_to_motion(motion, &file)
                                     : grobo_classic_to_joint_motion(robot, motion, &file);
    if (format != GROBO_FORMAT_M) {
        options.model = grobo_classic_model(robot);
        options.default_us = (int64_t)robot->motionTime * 1000;
    }
    if (r >= 0) {
        r = grobo_motion_save(file, grobo_files_os(), path, &options, NULL);
        grobo_motion_free(file);
    }
    return r;
}

/* ---- files -------------------------------------------------------------------------------- */

bool RobotMotion_loadMotionFromFile(RobotMotion *motion, const char *name)
{
    return grobo_classic_load(motion, name, GROBO_FORMAT_M, NULL) >= 0;
}

bool RobotMotion_saveMotionToFile(const RobotMotion *motion, const char *name)
{
    return grobo_classic_save(motion, name, GROBO_FORMAT_M, NULL) >= 0;
}

bool RobotMotion_saveMotionToFile_dir(const RobotMotion *motion, const char *name, const char *dir)
{
    char path[GROBO_PATH_MAX_BYTES];
    FILE *there;

    if (motion == NULL || name == NULL || dir == NULL) {
        return false;
    }
    for (int i = 0; i < NAMES_MAX; i++) {
        int length =
            snprintf(path, sizeof path, "%s%s%s%d.m", dir, dir[0] != '\0' ? "/" : "", name, i);
        if (length < 0 || (size_t)length >= sizeof path) {
            return false;
        }
        if ((there = fopen(path, "r")) == NULL) {
            return RobotMotion_saveMotionToFile(motion, path);
        }
        fclose(there);
    }
    return false;
}

bool RobotMotion_loadMotionFromMseqFile(RobotMotion *motion, const char *name, SerialRobot *r)
{
    return grobo_classic_load(motion, name, GROBO_FORMAT_MSEQ, r) >= 0;
}

bool RobotMotion_loadMotionFromPseqFile(RobotMotion *motion, const char *name, SerialRobot *r)
{
    return grobo_classic_load(motion, name, GROBO_FORMAT_PSEQ, r) >= 0;
}

bool RobotMotion_loadMotionFromYamlFile(RobotMotion *motion, const char *name, SerialRobot *r)
{
    return grobo_classic_load(motion, name, GROBO_FORMAT_YAML, r) >= 0;
}

bool RobotMotion_saveMotionToPseqFile(const RobotMotion *motion, const char *name, SerialRobot *r)
{
    return grobo_classic_save(motion, name, GROBO_FORMAT_PSEQ, r) >= 0;
}

bool RobotMotion_saveMotionToYamlFile(const RobotMotion *motion, const char *name, SerialRobot *r)
{
    return grobo_classic_save(motion, name, GROBO_FORMAT_YAML, r) >= 0;
}

/* ---- printing ----------------------------------------------------------------------------- */

void RobotMotion_printMotion(const RobotMotion *motion)
{
    for (int i = 0; i < RobotMotion_getSize(motion); i++) {
        fprintf(stderr, "Posture[ %d ] = %g:", i, motion->motion[i]->motionTime);
        RobotPosture_printPosture(motion->motion[i]);
    }
}

void RobotMotion_printMotion_stream(const RobotMotion *motion, FILE *stream)
{
    double time_ms = 0;

    for (int i = 0; stream != NULL && i < RobotMotion_getSize(motion); i++) {
        time_ms += motion->motion[i]->motionTime;
        fprintf(stream, "%.15g ", time_ms);
        RobotPosture_printPosture_stream(motion->motion[i], stream);
    }
}
