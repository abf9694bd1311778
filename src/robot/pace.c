/* SPDX-License-Identifier: MIT */
/*
 * How often the line carries more of the trajectories of joints that are told in segments
 * (segments.c), and how long a reading may have the line in between. Frames of all joints that
 * move, and as many readings as each joint needs in its time, make a period; the shortest that does
 * is taken, and GROBO_SEGMENT_RENEW_US where that is longer. A servo's segment must not be over
 * before the next frame has come: a line that needs more is too slow for so many joints. /
 */
#include "src/base/instant.h"
#include "src/robot/axis.h"
#include "src/robot/budget.h"
#include "src/robot/pace.h"
#include "src/robot/robot.h"
#include "src/robot/slot.h"
#include "src/robot/trajectories.h"

/* A reading takes this part more than it should now and then. */
#define SPARE 16
/* What is left of a segment when the next one has come. */
#define SLACK_US 35000

typedef struct costs {
    uint32_t motion_us;      /* all frames */
    uint32_t one_us, all_us; /* a reading of one joint, and of all where one frame does */
    uint32_t all, n;         /* joints of the robot, and those that are read */
    uint32_t watch_us;       /* in which each is */
    bool wakes;              /* a goal wakes servos, and they do not answer it */
} costs;

static uint32_t cost_of_many(const grobo_i_line *line, grobo_joint_mask joints)
{
    const grobo_driver *driver = line->driver;
    grobo_exchange exchange = {0};
    int result = driver->sense_many(driver, line->ctx, joints, GROBO_SENSE_FULL, &exchange);
    return result < 0 ? 0 : grobo_i_line_us(line->bus, &exchange);
}

static void find_costs(const grobo_i_line *line, grobo_joint_mask joints, costs *c)
{
    const grobo_driver *driver = line->driver;
    bool answered = false;
    c->motion_us = c->one_us = c->all_us = 0;
    (void)grobo_i_motion_cost(line, joints, &c->motion_us, &answered);
    c->all = driver->model->n_joints;
    c->wakes = GROBO_I_EXTRA(driver, goal_energises) && !answered;
    c->n = line->unread && !c->wakes ? 0 : (uint32_t)grobo_joints_count(joints);
    c->watch_us = c->wakes ? GROBO_I_RESTART_US : GROBO_WATCH_US;
    if (GROBO_I_EXTRA(driver, sense_many) != NULL) {
        c->one_us = cost_of_many(line, GROBO_JOINT_BIT(0));
        c->all_us = cost_of_many(line, GROBO_JOINTS_ALL(driver->model->n_joints));
    } else {
        (void)grobo_i_reading_cost(line, &c->one_us);
    }
}

/* The period with k readings of one joint each, or with one reading of k. */
static uint32_t period_of(const costs *c, uint32_t k)
{
    bool many = c->all_us > c->one_us && c->all > 1;
    uint32_t each_us = many ? (c->all_us - c->one_us) / (c->all - 1) : c->one_us;
    uint32_t readings_us = c->one_us + (k - 1) * each_us;
    return c->motion_us + readings_us + readings_us / SPARE;
}

/* True if a frame is not late though a reading was begun just before it was due: of all that are
 * read at once, or of one. */
static bool is_in_time(const costs *c, uint32_t us)
{
    uint32_t reading_us = c->all_us > 0 && us > c->motion_us ? us - c->motion_us : c->one_us;
    return us + reading_us + SLACK_US <= GROBO_SEGMENT_US;
}

/* The shortest period in which each joint is read within that time; 0: there is none. */
static uint32_t period_within(const costs *c, uint32_t watch_us)
{
    for (uint32_t k = 1; k <= c->n; k++) {
        uint32_t us = period_of(c, k);
        if ((uint64_t)us * ((c->n + k - 1) / k) <= watch_us && is_in_time(c, us)) {
            return us;
        }
    }
    return 0;
}

/* In microseconds; 0: it cannot be in time. Servos that a goal wakes get none while they are
 * unheard: there a third of the time is spare, or an eighth where all are read in each period. */
static uint32_t pace_of(const costs *c)
{
    uint32_t us = c->n == 0  ? c->motion_us
                  : c->wakes ? period_within(c, c->watch_us / 3 * 2)
                             : period_within(c, c->watch_us);
    if (us == 0 && c->wakes) {
        us = period_of(c, c->n);
        us = us <= c->watch_us / 8 * 7 ? us : 0;
    }
    if (us == 0 || !is_in_time(c, us)) {
        return 0;
    }
    return us > GROBO_SEGMENT_RENEW_US ? us : GROBO_SEGMENT_RENEW_US;
}

uint32_t grobo_i_pace_of(const grobo_i_line *line, grobo_joint_mask joints)
{
    costs c;
    find_costs(line, joints, &c);
    return pace_of(&c);
}

grobo_i_line grobo_i_line_of_robot(const grobo_robot *robot)
{
    return (grobo_i_line)
    {
        .bus = &robot->bus, .driver = robot->driver, .ctx = robot->driver_ctx,
#if GROBO_LINES_MAX > 1
        .lines = robot->lines, .more = robot->more,
#endif
        .unread = robot->config.sense_interval_us == GROBO_SENSE_NEVER
    };
}

bool grobo_i_pace_fits(const grobo_robot *robot, grobo_joint_mask joints)
{
    const grobo_robot_order order = {.kind = GROBO_I_ORDER_GOAL};
    grobo_i_line line = grobo_i_line_of_robot(robot);
    return joints == 0 || !grobo_i_goes_in_parts(robot, &order) ||
           grobo_i_pace_of(&line, joints) > 0;
}

bool grobo_i_pace(grobo_robot *robot, grobo_joint_mask joints)
{
    costs c;
    grobo_i_line line = grobo_i_line_of_robot(robot);
    if (joints == robot->paced) {
        return true;
    }
    find_costs(&line, joints, &c);
    uint32_t pace_us = pace_of(&c);
    if (pace_us == 0) {
        return false;
    }
    robot->renew_us = (int32_t)pace_us;
    robot->read_us = (int32_t)(pace_us - c.motion_us);
    robot->paced = joints;
    return true;
}
