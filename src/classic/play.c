/* SPDX-License-Identifier: MIT */
/* SerialRobot of the classic shelf: what makes it move, and its current motion with its files. */
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/runner.h>

#include "src/classic/classic.h"

/* ---- moving ------------------------------------------------------------------------------- */

/* A posture as the engine takes it. */
static void target_of(const SerialRobot *robot, const RobotPosture *from, grobo_posture *to)
{
    grobo_classic_to_joints(robot, from, to);
    if (to->time_us == 0) {
        to->time_us = (int64_t)robot->motionTime * 1000;
    }
}

int SerialRobot_startMotion(SerialRobot *robot)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    grobo_robot *engine = grobo_classic_engine(robot);
    grobo_posture target;

    target_of(robot, robot->targetPosture, &target);
    int job = grobo_robot_retarget(engine, &target);
    if (job < 0) { /* no move is under way, or it has other joints */
        job = grobo_robot_move(engine, &target);
    }
    robot->inside->job = job > 0 ? job : robot->inside->job;
    return grobo_classic_end(robot, job, 0);
}

int SerialRobot_initPosition(SerialRobot *robot)
{
    if (robot == NULL) {
        return -1;
    }
    RobotPosture_copyPosture(robot->targetPosture, robot->initPosture);
    return SerialRobot_startMotion(robot);
}

int SerialRobot_doNthMotion(SerialRobot *robot, int n)
{
    const RobotPosture *posture = SerialRobot_getNthPosture(robot, n);

    if (posture == NULL) {
        return -1;
    }
    RobotPosture_copyPosture(robot->targetPosture, posture);
    robot->targetPosture->motionTime = 0;
    return SerialRobot_startMotion(robot);
}

/* True while a motion is approached or played. */
static bool plays(const SerialRobot *robot)
{
    return robot->inside->playing != NULL &&
           (grobo_robot_is_pending(grobo_classic_engine(robot), robot->inside->job) ||
            grobo_robot_is_playing(grobo_classic_engine(robot)));
}

static void release(SerialRobot *robot)
{
    if (robot->inside->playing != NULL) {
        grobo_motion_clip_free(&robot->inside->clip);
        grobo_motion_free(robot->inside->playing);
        robot->inside->playing = NULL;
    }
}

/* The motion as it is played: angles that leave a limit by the model's slack at the limit, and the
 * first posture in the default time, as doNthMotion(0) has it. */
static int prepare(const SerialRobot *robot, bool reverse, grobo_motion **motion)
{
    const grobo_model *model = grobo_classic_model(robot);
    grobo_posture posture;
    int size = RobotMotion_getSize(robot->motion);
    int r = grobo_motion_new(GROBO_MOTION_POSTURES, robot->joints, NULL, motion);

    for (int i = 0; r >= 0 && i < size; i++) {
        grobo_classic_to_joints(robot, RobotMotion_get(robot->motion, reverse ? size - 1 - i : i),
                                &posture);
        for (int j = 0; j < posture.n_joints; j++) {
            posture.angle_rad[j] = grobo_model_take_slack(model, j, posture.angle_rad[j]);
        }
        posture.time_us =
            i == 0 || posture.time_us == 0 ? (int64_t)robot->motionTime * 1000 : posture.time_us;
        r = grobo_motion_append(*motion, &posture);
    }
    return r;
}

static int play(SerialRobot *robot, int count, bool reverse)
{
    const grobo_play_options options = {
        GROBO_PLAY_OPTIONS_INIT,
        .repeat = count,
        .default_time_us = (int64_t)robot->motionTime * 1000,
    };
    grobo_motion *motion = NULL;
    int job = prepare(robot, reverse, &motion);

    if (job >= 0) {
        job = grobo_motion_clip(motion, NULL, &robot->inside->clip);
    }
    if (job >= 0) {
        job = grobo_robot_play(grobo_classic_engine(robot), &robot->inside->clip, &options);
        if (job < 0) {
            grobo_motion_clip_free(&robot->inside->clip);
        }
    }
    if (job < 0) {
        grobo_motion_free(motion);
        return job;
    }
    robot->inside->playing = motion;
    robot->inside->job = job;
    return GROBO_OK;
}

int SerialRobot_setMotionCount(SerialRobot *robot, int count)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    if (count == 0) {
        (void)grobo_robot_stop(grobo_classic_engine(robot), false);
    }
    if (count == 0 || RobotMotion_getSize(robot->motion) == 0) {
        return grobo_classic_end(robot, GROBO_OK, 0);
    }
    if (plays(robot) || count == INT_MIN) {
        return grobo_classic_end(robot, GROBO_ERR_STATE, 0);
    }
    release(robot);
    robot->reverseFlag = count < 0;
    robot->repeatCount = count < 0 ? -count : count;
    (void)RobotMotion_setReverse(robot->motion, count < 0);
    return grobo_classic_end(robot, play(robot, robot->repeatCount, count < 0), robot->repeatCount);
}

/* Postures of the present pass that have not left, and those of the passes after it. */
static int frames_left(const grobo_play_progress *progress)
{
    /* No overflow: a motion has GROBO_MOTION_FRAMES_MAX frames at most, or as many as its rate
     * gives in its length. */
    uint64_t left = progress->steps - progress->step +
                    progress->steps * (uint64_t)(progress->passes - progress->pass);

    return left < INT_MAX ? (int)left : INT_MAX;
}

int SerialRobot_isMoving(SerialRobot *robot)
{
    grobo_play_progress progress;

    if (SerialRobot_runner(robot) == NULL) {
        return 0;
    }
    const grobo_robot *engine = grobo_classic_engine(robot);
    bool moving = grobo_robot_moving(engine) || grobo_robot_settling(engine) ||
                  (robot->inside->job > 0 && grobo_robot_is_pending(engine, robot->inside->job));

    robot->executeMotion = plays(robot);
    grobo_robot_progress(engine, &progress);
    robot->commandCount = robot->executeMotion ? frames_left(&progress) : moving;
    return moving || robot->executeMotion;
}

int SerialRobot_wait(SerialRobot *robot, int timeout_ms)
{
    int64_t timeout_us = timeout_ms > 0 ? (int64_t)timeout_ms * 1000 : GROBO_RUNNER_TIMEOUT_US;

    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    for (int64_t end_us = grobo_now_us() + timeout_us; SerialRobot_isMoving(robot);) {
        if (grobo_now_us() >= end_us) {
            return grobo_classic_end(robot, GROBO_ERR_TIMEOUT, 0);
        }
        (void)grobo_runner_svc(robot->inside->runner);
    }
    return grobo_classic_end(robot, GROBO_OK, 0);
}

/* ---- postures of the motion --------------------------------------------------------------- */

RobotPosture *SerialRobot_getNthPosture(SerialRobot *robot, int n)
{
    if (robot == NULL) {
        return NULL;
    }
    return robot->reverseFlag && n >= 0 ? RobotMotion_rget(robot->motion, n + 1)
                                        : RobotMotion_get(robot->motion, n);
}

RobotPosture *SerialRobot_getFirstPosture(SerialRobot *robot)
{
    return SerialRobot_getNthPosture(robot, 0);
}

RobotPosture *SerialRobot_getLastPosture(SerialRobot *robot)
{
    return robot != NULL ? SerialRobot_getNthPosture(robot, RobotMotion_getSize(robot->motion) - 1)
                         : NULL;
}

int SerialRobot_appendCurrentPosture(SerialRobot *robot)
{
    return robot != NULL ? SerialRobot_appendCurrentPosture_time(robot, robot->motionTime) : -1;
}

int SerialRobot_appendCurrentPosture_time(SerialRobot *robot, double mtime)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    if (grobo_classic_refresh(robot) < robot->joints) {
        return grobo_classic_end(robot, GROBO_ERR_STALE, 0);
    }
    RobotPosture posture = robot->inside->current;
    posture.motionTime = mtime;
    bool kept = RobotMotion_appendPosture(robot->motion, &posture);
    return grobo_classic_end(robot, kept ? GROBO_OK : GROBO_ERR_NOMEM,
                             RobotMotion_getSize(robot->motion));
}

void SerialRobot_clearMotion(SerialRobot *robot)
{
    if (robot != NULL) {
        RobotMotion_clear(robot->motion);
    }
}

/* ---- files -------------------------------------------------------------------------------- */

int SerialRobot_setMotionDir(SerialRobot *robot, const char *dir)
{
    if (robot == NULL || dir == NULL || strlen(dir) >= sizeof robot->motionDir) {
        return -1;
    }
    memcpy(robot->motionDir, dir, strlen(dir) + 1);
    return 0;
}

static const char *directory(const SerialRobot *robot)
{
    return robot->motionDir[0] != '\0' ? robot->motionDir : ".";
}

/* NAME, or NAME and the extension of a format where it has none. */
static int with_extension(grobo_motion_format format, const char *name, char *to, size_t bytes)
{
    bool has =
        format == GROBO_FORMAT_AUTO || grobo_motion_format_of_path(name) != GROBO_FORMAT_AUTO;
    int length = snprintf(to, bytes, "%s%s%s", name, has ? "" : ".",
                          has ? "" : grobo_motion_format_name(format));

    return length < 0 || (size_t)length >= bytes ? GROBO_ERR_SPACE : GROBO_OK;
}

static int load(SerialRobot *robot, const char *name, grobo_motion_format format)
{
    char file[GROBO_PATH_MAX_BYTES];
    char path[GROBO_PATH_MAX_BYTES];

    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    int r = name != NULL ? with_extension(format, name, file, sizeof file) : GROBO_ERR_ARG;
    if (r >= 0) {
        r = grobo_motion_find(grobo_files_os(), directory(robot), file, path, sizeof path);
    }
    RobotMotion_clear(robot->motion);
    if (r >= 0) {
        (void)grobo_classic_refresh(robot); /* increments count from there */
        r = grobo_classic_load(robot->motion, path, format, robot);
    }
    return grobo_classic_end(robot, r, RobotMotion_getSize(robot->motion));
}

int SerialRobot_loadMotion(SerialRobot *robot, const char *name)
{
    return load(robot, name, GROBO_FORMAT_AUTO);
}

int SerialRobot_loadMotionFromM(SerialRobot *robot, const char *fname)
{
    return load(robot, fname, GROBO_FORMAT_M);
}

int SerialRobot_loadMotionFromYaml(SerialRobot *robot, const char *fname)
{
    return load(robot, fname, GROBO_FORMAT_YAML);
}

int SerialRobot_loadMotionFromPseq(SerialRobot *robot, const char *fname)
{
    return load(robot, fname, GROBO_FORMAT_PSEQ);
}

int SerialRobot_loadMotionFromMseq(SerialRobot *robot, const char *fname)
{
    return load(robot, fname, GROBO_FORMAT_MSEQ);
}

/* A plain name, so that the file stays in the directory. */
static int save(SerialRobot *robot, const char *name, grobo_motion_format format)
{
    char file[GROBO_PATH_MAX_BYTES];
    char path[GROBO_PATH_MAX_BYTES];

    if (SerialRobot_runner(robot) == NULL || name == NULL || name[0] == '\0') {
        return -1;
    }
    bool plain = strpbrk(name, "/\\:") == NULL && name[0] != '.';
    int r = plain ? with_extension(format, name, file, sizeof file) : GROBO_ERR_PERM;
    if (r >= 0) {
        int length = snprintf(path, sizeof path, "%s/%s", directory(robot), file);
        r = length >= 0 && (size_t)length < sizeof path
                ? grobo_classic_save(robot->motion, path, format, robot)
                : GROBO_ERR_SPACE;
    }
    return grobo_classic_end(robot, r, RobotMotion_getSize(robot->motion));
}

int SerialRobot_saveMotionToM(SerialRobot *robot, const char *fname)
{
    if (SerialRobot_runner(robot) == NULL) {
        return -1;
    }
    if (fname != NULL) {
        return save(robot, fname, GROBO_FORMAT_M);
    }
    bool saved = RobotMotion_saveMotionToFile_dir(robot->motion, "Motion", directory(robot));
    return grobo_classic_end(robot, saved ? GROBO_OK : GROBO_ERR_IO,
                             RobotMotion_getSize(robot->motion));
}

int SerialRobot_saveMotionToYaml(SerialRobot *robot, const char *fname)
{
    return save(robot, fname, GROBO_FORMAT_YAML);
}

int SerialRobot_saveMotionToPseq(SerialRobot *robot, const char *fname)
{
    return save(robot, fname, GROBO_FORMAT_PSEQ);
}

/* ---- frames ------------------------------------------------------------------------------- */

int SerialRobot_postureToCommand(SerialRobot *robot, const RobotPosture *pos)
{
    if (SerialRobot_runner(robot) == NULL || pos == NULL) {
        return -1;
    }
    const grobo_driver *driver = &robot->inside->driver;
    grobo_target target = {.from_rad = {0}};
    grobo_exchange exchange;

    target_of(robot, pos, &target.posture);
    int64_t steps = target.posture.time_us / driver->time_step_us;
    for (int j = 0; j < robot->joints; j++) {
        target.joint_time_us[j] = (steps > 0 ? steps : 1) * driver->time_step_us;
    }
    memset(&exchange, 0, sizeof exchange);
    int r = driver->posture(driver, robot, &target, 0, &exchange);
    if (r <= 0) {
        return grobo_classic_end(robot, r < 0 ? r : GROBO_ERR_EMPTY, 0);
    }
    return SerialRobot_setCommand(robot, (const char *)exchange.frame, exchange.frame_bytes) < 0
               ? -1
               : 0;
}

int SerialRobot_stabilizer(SerialRobot *robot)
{
    return robot != NULL && robot->stabilizer != NULL
               ? robot->stabilizer(robot, robot->currentPosture, robot->targetPosture)
               : 0;
}
