/* SPDX-License-Identifier: MIT */
/* RobotPosture of the classic shelf: 0.1 degree in motor order; radians are computed from it. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/classic/classic.h"

short rad2deg(double d)
{
    double deg = isnan(d) ? 0 : grobo_deg_from_rad(d);

    return (short)fmax(SHRT_MIN, fmin(SHRT_MAX, deg));
}

double deg2rad(short d)
{
    return grobo_rad_from_deg(d);
}

/* ---- making ------------------------------------------------------------------------------- */

int RobotPosture_init(RobotPosture *posture, int n)
{
    if (posture == NULL || n < 0 || n > GROBO_JOINTS_MAX) {
        return -1;
    }
    *posture = (RobotPosture){.numJoints = n,
                              .motionTime = (double)GROBO_POSTURE_TIME_US / 1000,
                              .home = POSTURE_CALLERS};
    return 0;
}

void RobotPosture_deinit(RobotPosture *posture)
{
    if (posture != NULL) {
        posture->numJoints = 0;
    }
}

RobotPosture *RobotPosture_new(int n)
{
    RobotPosture *posture = malloc(sizeof *posture);

    if (posture == NULL || RobotPosture_init(posture, n) < 0) {
        free(posture);
        return NULL;
    }
    posture->home = POSTURE_FREE;
    return posture;
}

void RobotPosture_delete(RobotPosture *posture)
{
    if (posture != NULL && posture->home == POSTURE_FREE) {
        free(posture);
    }
}

RobotPosture *RobotPosture_dupPosture(const RobotPosture *posture)
{
    RobotPosture *copy = posture != NULL ? RobotPosture_new(posture->numJoints) : NULL;

    if (copy != NULL) {
        RobotPosture_copyPosture(copy, posture);
    }
    return copy;
}

/* ---- angles ------------------------------------------------------------------------------- */

static bool has(const RobotPosture *posture, int id)
{
    return posture != NULL && id > 0 && id <= posture->numJoints && id <= GROBO_JOINTS_MAX;
}

/* How many angles it has, whatever a program wrote into it. */
static int count(const RobotPosture *posture)
{
    int n = posture->numJoints;

    return n < 0 ? 0 : n < GROBO_JOINTS_MAX ? n : GROBO_JOINTS_MAX;
}

double RobotPosture_setMotionTime(RobotPosture *posture, double n)
{
    if (posture != NULL && !isnan(n)) {
        posture->motionTime = n;
    }
    return n;
}

int RobotPosture_getDegree(const RobotPosture *posture, int id)
{
    return has(posture, id) ? posture->jointAngles[id - 1] : ROBOT_POSTURE_NO_ANGLE;
}

double RobotPosture_getRad(const RobotPosture *posture, int id)
{
    return has(posture, id) ? grobo_classic_rad(posture->jointAngles[id - 1])
                            : ROBOT_POSTURE_NO_ANGLE;
}

void RobotPosture_setDegree(RobotPosture *posture, int id, int deg)
{
    if (has(posture, id)) {
        posture->jointAngles[id - 1] = deg;
        posture->jointAnglesRad[id - 1] = grobo_classic_rad(deg);
    }
}

void RobotPosture_setRad(RobotPosture *posture, int id, double rad)
{
    double ddeg = round(grobo_deg_from_rad(rad) * 10);

    if (ddeg > SHRT_MIN && ddeg < SHRT_MAX) {
        RobotPosture_setDegree(posture, id, (int)ddeg);
    }
}

/* ---- the whole ---------------------------------------------------------------------------- */

void RobotPosture_printPosture(const RobotPosture *posture)
{
    RobotPosture_printPosture_stream(posture, stderr);
}

void RobotPosture_printPosture_stream(const RobotPosture *posture, FILE *stream)
{
    if (posture == NULL || stream == NULL) {
        return;
    }
    for (int i = 0; i < count(posture); i++) {
        fprintf(stream, " %d", posture->jointAngles[i]);
    }
    fputc('\n', stream);
}

void RobotPosture_copyPosture(RobotPosture *posture, const RobotPosture *p)
{
    RobotPosture_copyPosture_offset(posture, p, 0);
}

void RobotPosture_copyPosture_offset(RobotPosture *posture, const RobotPosture *p, int offset)
{
    if (posture == NULL || p == NULL || offset < 0) {
        return;
    }
    for (int i = 0; i < count(p) && i < count(posture) - offset; i++) {
        RobotPosture_setDegree(posture, i + offset + 1, p->jointAngles[i]);
    }
    posture->motionTime = p->motionTime;
}

int *RobotPosture_getJointAngles(RobotPosture *posture)
{
    return posture != NULL ? posture->jointAngles : NULL;
}

double *RobotPosture_getJointAnglesRad(RobotPosture *posture)
{
    if (posture == NULL) {
        return NULL;
    }
    for (int i = 0; i < count(posture); i++) {
        posture->jointAnglesRad[i] = grobo_classic_rad(posture->jointAngles[i]);
    }
    return posture->jointAnglesRad;
}

bool RobotPosture_equalTo(const RobotPosture *posture, const RobotPosture *pos)
{
    return posture != NULL && pos != NULL && posture->numJoints == pos->numJoints &&
           memcmp(posture->jointAngles, pos->jointAngles,
                  (size_t)count(pos) * sizeof pos->jointAngles[0]) == 0;
}

bool RobotPosture_nearTo(const RobotPosture *posture, const RobotPosture *pos, int delta)
{
    if (posture == NULL || pos == NULL || posture->numJoints != pos->numJoints) {
        return false;
    }
    for (int i = 0; i < count(pos); i++) {
        if (llabs((long long)posture->jointAngles[i] - pos->jointAngles[i]) >= delta) {
            return false;
        }
    }
    return true;
}
