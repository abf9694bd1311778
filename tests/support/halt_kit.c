/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/dxl1.h>
#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/ics.h>
#include <grobo/core/lx16a.h>

#include "src/base/instant.h"
#include "src/model/joint.h"
#include "tests/support/halt_kit.h"
#include "tests/support/many_joints.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)
#define DEG(rad) ((rad)*57.29577951308232)

/* What the issue of stops allows beyond the braking way. */
#define SLACK_DEG 2.0
/* A shaft that stands; of a reading's step. */
#define STILL_DEG 0.5
#define STILL_DPS 0.05
#define HANGS_DPS 0.5
#define HANGS_DEG 0.05
/* A speed in counts of its register is rounded up: of KRS that is 3.9 deg/s. */
#define COUNT_DPS 4.0
#define COUNT_S 0.6
/* A lost frame is repeated when its halt should be over and every joint was read; a reading whose
 * reply is lost takes so much longer. */
#define HALT_TIME_US 100000
#define LOST_REPLY_US 45000
/* Servos without ramps slow down evenly over 100 ms: the way of half that time at their speed. */
#define BRAKE_S 0.05
/* From one target of a stream to the next; and of readings of servos that tell no speed. */
#define PAUSE_US 20000
#define UNKNOWN_US 100000

halt_world halt;
bool halt_traced, halt_weighs;

/* ---- robots ---------------------------------------------------------------------------------- */

/* Of the coupled ones, two are servos on one shaft, and the last follows the one before it. */
enum { SMALL_JOINTS = 3, PAIRS_JOINTS = 4, PAIR = 1, SECOND = 2, FOLLOWER = 3 };
#define FOLLOWER_RATIO (-0.5)
#define APART_DEG 5

/* Where all joints are read in one exchange or written in one frame, frame_us grows with them; a
 * frame of protocol 1 has 259 bytes at the most. reading_us: twice where servos tell no speed. */
typedef struct recipe {
    const char *name;
    const far_family *far;
    int n_joints, baud_bps;
    int64_t frame_us;
    int64_t reading_us; /* all joints */
    bool coupled;
} recipe;

enum { M1 = 1000000 };

static const recipe recipes[] = {
    {"board", &far_board, 20, 115200, 19000, 210000, false},
    {"bus", &far_bus, 20, 115200, 9500, 110000, false},
    {"dxl2", &far_dxl2, SMALL_JOINTS, M1, 2500, 8000, false},
    {"dxl1", &far_dxl1, SMALL_JOINTS, M1, 1500, 5000, false},
    {"mx", &far_mx, SMALL_JOINTS, M1, 1500, 5000, false},
    {"sts", &far_sts, SMALL_JOINTS, M1, 1500, 5000, false},
    {"scs", &far_scs, SMALL_JOINTS, M1, 1500, 5000, false},
    {"ics", &far_ics, SMALL_JOINTS, 115200, 7500, 135000, false},
    {"lx16a", &far_lx16a, SMALL_JOINTS, 115200, 3000, 160000, false},
    {"xl320", &far_xl320, SMALL_JOINTS, M1, 2500, 8000, false},
    {"p", &far_p, SMALL_JOINTS, M1, 2500, 8000, false},
    {"pro", &far_pro, SMALL_JOINTS, M1, 2500, 8000, false},
    {"hls", &far_hls, SMALL_JOINTS, M1, 1500, 5000, false},
    {"sm", &far_sm, SMALL_JOINTS, M1, 2500, 8000, false},
    {"bus-57600", &far_bus, 20, 57600, 19000, 220000, false},
    {"bus-460800", &far_bus, 20, 460800, 2500, 40000, false},
    {"dxl2-20", &far_dxl2, 20, M1, 15000, 20000, false},
    {"dxl2-64", &far_dxl2, 64, M1, 66000, 140000, false},
    {"dxl2-57600", &far_dxl2, SMALL_JOINTS, 57600, 53000, 110000, false},
    {"dxl2-4000000", &far_dxl2, SMALL_JOINTS, 4 * M1, 2500, 8000, false},
    {"xl320-20", &far_xl320, 20, M1, 15000, 20000, false},
    {"xl320-64", &far_xl320, 64, M1, 66000, 140000, false},
    {"xl320-57600", &far_xl320, SMALL_JOINTS, 57600, 53000, 110000, false},
    {"p-20", &far_p, 20, M1, 15000, 20000, false},
    {"p-57600", &far_p, SMALL_JOINTS, 57600, 53000, 110000, false},
    {"pro-20", &far_pro, 20, M1, 15000, 20000, false},
    {"pro-115200", &far_pro, SMALL_JOINTS, 115200, 27000, 55000, false},
    {"dxl1-20", &far_dxl1, 20, M1, 3000, 20000, false},
    {"dxl1-64", &far_dxl1, 64, M1, 3000, 60000, false},
    {"dxl1-57600", &far_dxl1, SMALL_JOINTS, 57600, 10000, 50000, false},
    {"mx-20", &far_mx, 20, M1, 3000, 20000, false},
    {"mx-64", &far_mx, 64, M1, 3000, 60000, false},
    {"mx-57600", &far_mx, SMALL_JOINTS, 57600, 10000, 50000, false},
    {"mx-3000000", &far_mx, SMALL_JOINTS, 3 * M1, 1500, 5000, false},
    {"sts-20", &far_sts, 20, M1, 7000, 20000, false},
    {"sts-64", &far_sts, 64, M1, 21000, 60000, false},
    {"sts-38400", &far_sts, SMALL_JOINTS, 38400, 30000, 80000, false},
    {"hls-20", &far_hls, 20, M1, 7000, 20000, false},
    {"hls-38400", &far_hls, SMALL_JOINTS, 38400, 30000, 80000, false},
    {"sm-20", &far_sm, 20, M1, 17000, 30000, false},
    {"sm-38400", &far_sm, SMALL_JOINTS, 38400, 30000, 80000, false},
    {"scs-20", &far_scs, 20, M1, 3000, 20000, false},
    {"scs-64", &far_scs, 64, M1, 3000, 60000, false},
    {"scs-38400", &far_scs, SMALL_JOINTS, 38400, 15000, 80000, false},
    {"ics-20", &far_ics, 20, 115200, 7500, 900000, false},
    {"ics-20-1250000", &far_ics, 20, 1250000, 2000, 300000, false},
    {"lx16a-20", &far_lx16a, 20, 115200, 3000, 500000, false},
    {"lx16a-64", &far_lx16a, 64, 115200, 3000, 1500000, false},
    {"dxl2-pairs", &far_dxl2, PAIRS_JOINTS, M1, 3000, 9000, true},
    {"xl320-pairs", &far_xl320, PAIRS_JOINTS, M1, 3000, 9000, true},
    {"p-pairs", &far_p, PAIRS_JOINTS, M1, 3000, 9000, true},
    {"pro-pairs", &far_pro, PAIRS_JOINTS, M1, 3000, 9000, true},
    {"mx-pairs", &far_mx, PAIRS_JOINTS, M1, 2000, 7000, true},
    {"sts-pairs", &far_sts, PAIRS_JOINTS, M1, 2000, 7000, true},
    {"sm-pairs", &far_sm, PAIRS_JOINTS, M1, 4000, 10000, true},
    {"hls-pairs", &far_hls, PAIRS_JOINTS, M1, 2000, 7000, true},
    {"scs-pairs", &far_scs, PAIRS_JOINTS, M1, 2000, 7000, true},
    {"lx16a-pairs", &far_lx16a, PAIRS_JOINTS, 115200, 3000, 220000, true},
};
enum { ROBOTS = sizeof recipes / sizeof recipes[0] };

/* Servos of the families that robots are put together of. */
static const struct kind {
    const far_family *far;
    const grobo_servo_table *table;
    const char *servo;
    int (*init)(grobo_driver *driver, const grobo_model *model);
} kinds[] = {
    {&far_dxl2, &grobo_i_dxl2_table, "XL430-W250", grobo_dxl2_driver_init},
    {&far_xl320, &grobo_i_dxl2_table, "XL-320", grobo_dxl2_driver_init},
    {&far_p, &grobo_i_dxl2_table, "PH42-020-S300-R", grobo_dxl2_driver_init},
    {&far_pro, &grobo_i_dxl2_table, "H54-200-S500-R", grobo_dxl2_driver_init},
    {&far_dxl1, &grobo_i_dxl1_table, "AX-12A", grobo_dxl1_driver_init},
    {&far_mx, &grobo_i_dxl1_table, "MX-28", grobo_dxl1_driver_init},
    {&far_sts, &grobo_i_sts_table, "STS3215", grobo_feetech_driver_init},
    {&far_hls, &grobo_i_sts_table, "HLS3930", grobo_feetech_driver_init},
    {&far_sm, &grobo_i_sts_table, "SM8512BL", grobo_feetech_driver_init},
    {&far_scs, &grobo_i_scs_table, "SCS0009", grobo_feetech_driver_init},
    {&far_ics, &grobo_i_ics_table, "KRS-3301", grobo_ics_driver_init},
    {&far_lx16a, &grobo_i_lx16a_table, "LX-16A", grobo_lx16a_driver_init},
};

static halt_robot robots[ROBOTS];
static char joint_names[GROBO_JOINTS_MAX][16];

static void make_gr001(halt_robot *robot)
{
    robot->driver =
        *grobo_gr001_driver(robot->far == &far_board ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS);
    robot->n_joints = robot->driver.model->n_joints;
    robot->moved = grobo_model_joint_of_motor(robot->driver.model, 3);
    robot->other = grobo_model_joint_of_motor(robot->driver.model, 6);
}

static void make_joints(halt_robot *robot, const struct kind *kind, bool coupled)
{
    const grobo_servo_model *servo = grobo_servo_model_named(kind->table, kind->servo);
    assert_non_null(servo);
    robot->other = 1;
    for (int j = 0; j < robot->n_joints; j++) {
        (void)snprintf(joint_names[j], sizeof joint_names[j], "J%d", j + 1);
        robot->joints[j] = (grobo_joint){.name = joint_names[j],
                                         .min_rad = RAD(-100),
                                         .max_rad = RAD(100),
                                         .max_speed_rad_s = RAD(0.8 * servo->speed_dps),
                                         .servo_model = servo->number,
                                         .motor = (uint8_t)(j + 1),
                                         .mirror = (uint8_t)j,
                                         .mirror_sign = 1,
                                         .sign = 1};
    }
    if (coupled) {
        robot->other = SECOND;
        robot->joints[PAIR].follows = (uint8_t)robot->moved;
        robot->joints[PAIR].ratio = 1;
        robot->joints[PAIR].apart_rad = RAD(APART_DEG);
        robot->joints[FOLLOWER].follows = SECOND;
        robot->joints[FOLLOWER].ratio = FOLLOWER_RATIO;
        robot->joints[FOLLOWER].min_rad = RAD(100 * FOLLOWER_RATIO);
        robot->joints[FOLLOWER].max_rad = RAD(-100 * FOLLOWER_RATIO);
    }
    robot->model = (grobo_model)GROBO_TABLE(grobo_model, .name = kind->servo,
                                            GROBO_MODEL_JOINTS(robot->joints),
                                            .n_joints = (uint8_t)robot->n_joints);
    robot->driver.size = sizeof robot->driver;
    assert_int_equal(kind->init(&robot->driver, &robot->model), GROBO_OK);
    robot->driver.arm = true;
}

static void make(halt_robot *robot, const recipe *from)
{
    robot->name = from->name;
    robot->far = from->far;
    robot->baud_bps = from->baud_bps;
    robot->n_joints = from->n_joints;
    robot->frame_us = from->frame_us;
    robot->reading_us = from->reading_us;
    robot->no_rate = from->far == &far_lx16a && from->n_joints > 20; /* a frame a joint */
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (kinds[i].far == from->far) {
            make_joints(robot, &kinds[i], from->coupled);
            return;
        }
    }
    make_gr001(robot);
}

const halt_robot *halt_robot_of(int number)
{
    if (number < 0 || number >= ROBOTS) {
        return NULL;
    }
    if (robots[number].far == NULL) {
        make(&robots[number], &recipes[number]);
    }
    return &robots[number];
}

const halt_robot *halt_robot_named(const char *name)
{
    for (int i = 0; i < ROBOTS; i++) {
        if (strcmp(recipes[i].name, name) == 0) {
            return halt_robot_of(i);
        }
    }
    return NULL;
}

int halt_joint_of(int servo)
{
    return grobo_model_joint_of_motor(halt.of->driver.model, (uint8_t)(servo + 1));
}

void halt_robot_make(halt_robot *robot, const char *of, int n_joints, int baud_bps)
{
    size_t i = 0;
    while (i < ROBOTS && strcmp(recipes[i].name, of) != 0) {
        i++;
    }
    assert_true(i < ROBOTS);
    recipe from = recipes[i];
    from.n_joints = n_joints;
    from.baud_bps = baud_bps;
    memset(robot, 0, sizeof *robot);
    make(robot, &from);
    if (robot->n_joints != n_joints) {
        bool board = from.far == &far_board;
        robot->driver = *many_joints(board ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS, n_joints);
        robot->n_joints = n_joints;
        robot->moved = robot->other = 0;
    }
}

bool halt_is_paired(const halt_robot *robot)
{
    return robot->driver.model->n_joints > PAIR &&
           grobo_i_joint(robot->driver.model, PAIR)->apart_rad > 0;
}

static int far_of(int joint)
{
    return halt.of->driver.model->joints[joint].motor - 1;
}

/* ---- the world ------------------------------------------------------------------------------- */

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB && event->u.job.number == halt.awaited) {
        halt.result = event->u.job.result;
        halt.over = true;
    } else if (event->kind == GROBO_EVENT_TRIP && halt.trip_us == 0) {
        halt.trip_us = event->now_us;
        halt.trip = event->u.trip.trip;
        if (halt.weighs && (halt.trip == GROBO_TRIP_BLOCKED || halt.trip == GROBO_TRIP_OVERLOAD)) {
            halt_blame("a weight is taken for a wall", event->u.trip.joint, event->u.trip.value, 0);
        }
        if (halt.judges_trip) {
            halt_judge(halt.trip_soft_us);
        }
    }
}

static void hear(void *ctx, const far_news *news);

void halt_new_engine(const grobo_robot_config *asked)
{
    grobo_robot_config config = *asked;
    config.bus.baud_bps = (uint32_t)halt.of->baud_bps;
    config.bus.echo = halt.of->far->echo;
    assert_int_equal(grobo_robot_init(&halt.robot, &halt.of->driver, NULL, &config, halt.now_us),
                     GROBO_OK);
    grobo_robot_on_event(&halt.robot, on_event, NULL);
    grobo_robot_link_up(&halt.robot, halt.now_us);
}

void halt_begin(const halt_robot *robot, double deg)
{
    static const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT};
    memset(&halt, 0, sizeof halt);
    halt.of = robot;
    halt.now_us = HALT_S;
    far_begin(&halt.far, robot->far, robot->n_joints, halt.now_us);
    halt.far.baud_bps = robot->baud_bps;
    halt.far.hear = hear;
    halt.weighs = halt_weighs;
    for (int i = 0; halt.weighs && i < robot->n_joints; i++) {
        far_put(&halt.far, i, 0, true, halt.now_us);
    }
    far_put(&halt.far, far_of(robot->moved), deg, halt.weighs, halt.now_us);
    if (halt_is_paired(robot)) {
        far_put(&halt.far, far_of(PAIR), deg, halt.weighs, halt.now_us);
    }
    if (halt.weighs) {
        far_weigh(&halt.far, halt.now_us);
        halt.now_us += 2 * HALT_S;
        far_step(&halt.far, halt.now_us);
    }
    halt_new_engine(&config);
}

/* GROBO_HALT_CELL: what was on the wire from the stop on. */
static void trace(char way, const uint8_t *bytes, int n)
{
    if (!halt_traced || !halt.judged) {
        return;
    }
    printf("%9.3f ms %c", (double)(halt.now_us - halt.asked_us) / HALT_MS, way);
    for (int i = 0; i < n; i++) {
        printf(" %02X", bytes[i]);
    }
    printf("\n");
}

void halt_run(int64_t us)
{
    int64_t until_us = halt.now_us + us;
    for (int spins = 0;; spins++) {
        uint8_t bytes[FAR_FRAME_BYTES];
        int n;
        assert_true(spins < 4000000);
        while ((n = far_give(&halt.far, bytes, (int)sizeof bytes, halt.now_us)) > 0) {
            trace('<', bytes, n);
            grobo_robot_rx(&halt.robot, bytes, (size_t)n, halt.now_us);
        }
        grobo_robot_step(&halt.robot, halt.now_us);
        n = grobo_robot_tx(&halt.robot, bytes, sizeof bytes, halt.now_us);
        assert_true(n >= 0);
        if (n > 0) {
            trace('>', bytes, n);
            far_take(&halt.far, bytes, n, halt.now_us);
        }
        int64_t next_us =
            grobo_i_sooner(grobo_robot_deadline(&halt.robot, halt.now_us), far_next_us(&halt.far));
        if (next_us > until_us) {
            halt.now_us = until_us;
            return;
        }
        halt.now_us = grobo_i_later(halt.now_us, next_us);
    }
}

int halt_wait(int number, int64_t us)
{
    int64_t end_us = halt.now_us + us;
    halt.awaited = number;
    halt.over = false;
    while (number > 0 && !halt.over && halt.now_us < end_us) {
        halt_run(HALT_MS);
    }
    return number <= 0 ? number : halt.over ? halt.result : GROBO_ERR_TIMEOUT;
}

grobo_posture halt_posture(double deg, int64_t time_us, bool whole)
{
    grobo_posture p;
    const grobo_model *model = halt.of->driver.model;
    assert_int_equal(grobo_posture_init(&p, model->n_joints), 0);
    p.angle_rad[halt.of->moved] = RAD(deg);
    p.set = whole ? GROBO_JOINTS_ALL(model->n_joints) : GROBO_JOINT_BIT(halt.of->moved);
    p.time_us = time_us;
    return p;
}

void halt_make_ready(double deg)
{
    int n = halt.of->driver.model->n_joints;
    int r = halt_wait(grobo_robot_torque(&halt.robot, GROBO_JOINTS_ALL(n), GROBO_TORQUE_ON),
                      10 * HALT_S);
    grobo_posture p = halt_posture(deg, 200 * HALT_MS, true);
    r = r < 0 ? r : halt_wait(grobo_robot_move(&halt.robot, &p), 10 * HALT_S);
    if (r < 0) {
        fail_msg("%s: cannot be made ready: %s", halt.of->name, grobo_error_name(r));
    }
    halt_run(100 * HALT_MS);
}

/* ---- the judge ------------------------------------------------------------------------------- */

void halt_blame(const char *rule, int joint, double is, double may)
{
    if (halt.fault[0] == '\0') {
        (void)snprintf(halt.fault, sizeof halt.fault,
                       "%s: joint %d, %+.1f ms after the request: %.2f, allowed %.2f", rule,
                       joint + 1, (double)(halt.now_us - halt.asked_us) / HALT_MS, is, may);
    }
}

static double top_dps(int servo)
{
    return DEG(halt.of->driver.model->joints[halt_joint_of(servo)].max_speed_rad_s);
}

/* One that arrived just now may be about to go on with the next target of a stream; of a KRS nobody
 * but its program knows where it goes. */
static double turning_dps(const far_joint *joint)
{
    bool unknown = halt.blind && joint->family == &far_ics;
    int64_t ago_us = unknown ? UNKNOWN_US : halt.streamed ? PAUSE_US : 0;
    bool just_now = halt.now_us - joint->last_us < ago_us;
    double dps = fabs(joint->set_dps) > fabs(joint->dps) ? joint->set_dps : joint->dps;
    return dps != 0 || !just_now ? dps : joint->last_dps;
}

static double braking_deg(const far_joint *joint, double dps)
{
    double ramp_deg = joint->accel_dps2 > 0 ? dps * dps / (2 * joint->accel_dps2) : 0;
    return fmax(ramp_deg, fabs(dps) * BRAKE_S);
}

/* A speed that is rounded up has a joint ahead of where it was sent. */
static double slack_deg(const far_joint *joint)
{
    return SLACK_DEG + joint->family->step_deg + joint->family->count_dps * COUNT_S + halt.lag_deg;
}

/* How far out of from..to. */
static double outside(double deg, double from_deg, double to_deg)
{
    return fmax(fmax(from_deg - deg, deg - to_deg), 0);
}

double halt_stays_deg(const far_joint *joint)
{
    return fmax(STILL_DEG, 2 * joint->family->step_deg);
}

/* True of one that hangs in its load, and so stays where it is. */
static bool hangs(const far_joint *joint)
{
    double off_deg = joint->set_deg - joint->at_deg - far_carries_deg(joint, joint->at_deg);
    return joint->sag_deg != 0 && joint->torque == 1 && !joint->waits && joint->set_dps == 0 &&
           joint->set_deg == joint->goal_deg && fabs(joint->dps) < HANGS_DPS &&
           fabs(off_deg) <= joint->family->loop.friction_deg + HANGS_DEG;
}

/* Where a halt may bring a joint to rest that it reaches now: from where it was as the frame left,
 * over where it is, to where it can come to rest; a soft stop, so much further on its way. One that
 * lags behind its set point, or swings, may hang in that. */
static void may_go(const far_joint *joint, const far_news *news, const halt_base *base,
                   double *from_deg, double *to_deg)
{
    double dead_s = (double)joint->family->dead_us / HALT_S;
    double dps = turning_dps(joint);
    bool just_asked = halt.now_us - halt.asked_us < 2 * halt.of->frame_us;
    if (base->begins && just_asked && fabs(base->asked_dps) > fabs(dps)) {
        dps = base->asked_dps;
    }
    double soft_s = (double)(base->turned || dps != 0 ? halt.soft_us : 0) / HALT_S;
    double brake_deg = copysign(braking_deg(joint, dps), dps) + dps * dead_s;
    double soft_deg = (fabs(dps) > fabs(base->asked_dps) ? dps : base->asked_dps) * soft_s;
    double on_deg = joint->at_deg + brake_deg + soft_deg;
    double rests_deg = far_hangs_deg(joint, joint->set_deg + brake_deg + soft_deg);
    double hangs_deg = far_hangs_deg(joint, joint->set_deg);
    *from_deg = fmin(fmin(news->left_deg, joint->at_deg), fmin(on_deg, fmin(hangs_deg, rests_deg)));
    *to_deg = fmax(fmax(news->left_deg, joint->at_deg), fmax(on_deg, fmax(hangs_deg, rests_deg)));
}

/* No frame asks more than the joint's speed of the shaft, from where that is: 1 % and one count of
 * the slowest wire more. A speed in a register counts whatever the way; a time counts with the way,
 * less what the shaft went on while the frame was under way. */
static void judge_speed(const far_joint *joint, const far_news *news)
{
    double way_deg =
        fmin(fabs(news->goal_deg - joint->at_deg), fabs(news->goal_deg - joint->set_deg));
    double lag_deg = fabs(joint->at_deg - news->left_deg) + joint->family->step_deg + halt.lag_deg;
    double most_dps = (top_dps(news->joint) + COUNT_DPS) * 1.01;
    double asked_dps = news->ask_dps > 0 ? news->ask_dps : INFINITY;
    bool timed = joint->family->count_dps == 0;
    if (way_deg <= lag_deg + (timed ? SLACK_DEG / 2 : 0)) {
        return; /* it stays where it is */
    }
    double whole_deg = fabs(news->goal_deg - joint->set_deg); /* in that time */
    asked_dps *= timed && !isinf(asked_dps) ? (way_deg - lag_deg) / whole_deg : 1;
    if (asked_dps > most_dps) {
        halt_blame("faster than the joint may", news->joint, asked_dps, most_dps);
    }
}

static void judge_goal(const far_joint *joint, const far_news *news)
{
    halt_base *base = &halt.base[news->joint];
    double from_deg, to_deg;
    may_go(joint, news, base, &from_deg, &to_deg);
    base->rested = base->rested && !news->missed; /* nobody knew it */
    if (!base->halted) {
        base->halted = true;
        base->halt_left_us = news->left_us;
        base->from_deg = from_deg;
        base->to_deg = to_deg;
    } else { /* a halt after a soft one */
        from_deg = fmin(from_deg, base->from_deg);
        to_deg = fmax(to_deg, base->to_deg);
    }
    halt.judged_goals++;
    if (news->ask_dps > 0 && joint->family->count_dps == 0) { /* of a time */
        double way_us = fabs(news->goal_deg - joint->set_deg) / news->ask_dps * HALT_S;
        halt.ends_us = grobo_i_later(halt.ends_us, halt.now_us + (int64_t)way_us);
    }
    double carries_deg = far_carries_deg(joint, joint->at_deg); /* the goal is so much beyond */
    double off_deg =
        outside(news->goal_deg, from_deg + fmin(carries_deg, 0), to_deg + fmax(carries_deg, 0));
    if (off_deg > slack_deg(joint)) {
        if (news->missed) {
            halt.excused++;
            base->excused = true;
        } else {
            halt_blame("a halt throws a joint", news->joint, news->goal_deg, joint->at_deg);
        }
    }
    judge_speed(joint, news);
}

/* A frame that was on the line when the stop was asked for sets the joint going yet. */
static void note_last(const far_joint *joint, const far_news *news)
{
    halt_base *base = &halt.base[news->joint];
    double dps = news->ask_dps > 0 ? fmin(news->ask_dps, joint->top_dps) : joint->top_dps;
    base->turned = base->begins = true;
    base->rested = base->rested && fabs(news->goal_deg - base->held_deg) <= joint->family->step_deg;
    base->begins_deg = joint->at_deg;
    base->asked_dps = copysign(dps, news->goal_deg - joint->at_deg);
}

static void judge_limits(const far_joint *joint, const far_news *news)
{
    const grobo_joint *limits = grobo_i_joint(halt.of->driver.model, halt_joint_of(news->joint));
    double sign = limits->sign, deg = sign * news->goal_deg;
    double least_deg = DEG(limits->min_rad) - joint->family->step_deg;
    double most_deg = DEG(limits->max_rad) + joint->family->step_deg;
    if (deg < least_deg || deg > most_deg) {
        halt_blame("a goal leaves the limits", news->joint, deg, deg < 0 ? least_deg : most_deg);
    }
}

static void hear(void *ctx, const far_news *news)
{
    const far_joint *joint = &halt.far.joint[news->joint];
    (void)ctx;
    if (halt_traced && halt.judged) {
        printf("%9.3f ms   joint %d at %.2f turns %.1f/s: %s %.2f at %.1f deg/s\n",
               (double)(halt.now_us - halt.asked_us) / HALT_MS, news->joint + 1, joint->at_deg,
               joint->dps, news->is_goal ? "goal" : "torque",
               news->is_goal ? news->goal_deg : news->torque, news->ask_dps);
    }
    if (news->is_goal) {
        judge_limits(joint, news);
    }
    if (halt.judged && news->is_goal && news->left_us < halt.asked_us) {
        note_last(joint, news);
    }
    if (!halt.judged || news->left_us < halt.asked_us) {
        return;
    }
    if (news->is_goal) {
        judge_goal(joint, news);
    } else if (news->torque != 1 && !halt.base[news->joint].halted) {
        halt_base *base = &halt.base[news->joint];
        base->halted = true;
        base->halt_left_us = news->left_us;
        base->from_deg = fmin(news->left_deg, joint->at_deg);
        base->to_deg = fmax(news->left_deg, joint->at_deg);
    }
}

/* For how long it turns yet if nobody stops it. One whose gears stick, behind a set point that goes
 * on, does not: whether it turns later, the place where it rests shows. */
static int64_t left_us(const far_joint *joint)
{
    double left_deg = fabs(joint->goal_deg - joint->set_deg);
    bool ends = left_deg <= braking_deg(joint, joint->set_dps) + SLACK_DEG; /* where a halt would */
    bool sticks = joint->sag_deg != 0 && fabs(joint->dps) < HANGS_DPS;
    return joint->torque != 1 || joint->set_dps == 0 || ends || sticks
               ? 0
               : (int64_t)(left_deg / fabs(joint->set_dps) * HALT_S);
}

void halt_judge(int64_t soft_us)
{
    halt.judged = true;
    halt.now_us++; /* behind what has left by now */
    halt.asked_us = halt.now_us;
    halt.done_us = halt.ends_us = 0;
    halt.soft_us = soft_us;
    halt.far.motor_left_us = halt.far.first_left_us = FAR_NEVER;
    memset(halt.base, 0, sizeof halt.base);
    for (int j = 0; j < halt.far.n_joints; j++) {
        halt.base[j].asked_deg = far_angle(&halt.far, j, halt.now_us);
        halt.base[j].asked_dps = halt.far.joint[j].dps;
        halt.base[j].turned = far_turns(&halt.far, j, halt.now_us);
        halt.base[j].missed = halt.far.joint[j].missed;
        halt.base[j].rested = hangs(&halt.far.joint[j]);
        halt.base[j].held_deg = halt.far.joint[j].goal_deg;
        halt.base[j].hangs_deg = far_hangs_deg(&halt.far.joint[j], halt.far.joint[j].goal_deg);
        halt.base[j].halt_left_us = FAR_NEVER;
        if (halt.far.joint[j].waits) { /* its dead time is not over */
            const far_joint *joint = &halt.far.joint[j];
            far_news news = {.joint = j};
            double accel_dps2;
            joint->family->plan(joint, &news.goal_deg, &news.ask_dps, &accel_dps2);
            note_last(joint, &news);
        }
        halt.base[j].left_us = left_us(&halt.far.joint[j]);
    }
}

void halt_done(void)
{
    halt.done_us = halt.now_us;
    for (int j = 0; j < halt.far.n_joints; j++) {
        halt.base[j].done_deg = far_angle(&halt.far, j, halt.now_us);
        halt.base[j].done_dps = halt.far.joint[j].dps;
    }
}

/* Where a joint may come to rest. One that no halt reached goes on for as long as the first frame
 * may take. @return by how much it may be outside of that */
static double may_rest(int j, int64_t bound_us, double *from_deg, double *to_deg)
{
    const halt_base *base = &halt.base[j];
    const far_joint *joint = &halt.far.joint[j];
    *from_deg = base->from_deg;
    *to_deg = base->to_deg;
    if (base->rested) {
        *from_deg = *to_deg = base->asked_deg;
        return halt_stays_deg(joint);
    }
    if (!base->halted) {
        double begins_deg = base->begins ? base->begins_deg : base->asked_deg;
        double on_deg = begins_deg + base->asked_dps * ((double)bound_us / HALT_S + BRAKE_S);
        *from_deg = fmin(fmin(base->asked_deg, begins_deg), on_deg);
        *to_deg = fmax(fmax(base->asked_deg, begins_deg), on_deg);
    }
    if (halt.weighs && !base->halted) {
        *from_deg = fmin(*from_deg, base->hangs_deg);
        *to_deg = fmax(*to_deg, base->hangs_deg);
    } else if (halt.weighs &&
               halt.blind) { /* what it carries, nobody has told: it sags once more */
        *from_deg -= far_carries_deg(joint, joint->at_deg);
    }
    return slack_deg(joint);
}

/* Nothing goes on when the stop was told to be done. With a weight, only a job says that all
 * stands: an exit, an emergency stop. */
static void judge_end(int j, double at_deg)
{
    const halt_base *base = &halt.base[j];
    far_joint *joint = &halt.far.joint[j];
    double still_dps = halt.weighs ? HANGS_DPS : STILL_DPS;
    if (far_turns(&halt.far, j, halt.now_us) && fabs(joint->dps) > still_dps) {
        halt_blame("still turns", j, joint->dps, 0);
    }
    /* The engine takes a frame to arrive at once (docs/guide/safety.md): 19 ms through a board. */
    double on_s = (double)(halt.of->frame_us + joint->family->dead_us) / HALT_S;
    double still_deg = STILL_DEG + joint->family->step_deg + fabs(base->done_dps) * on_s +
                       joint->family->count_dps * COUNT_S + halt.lag_deg;
    bool told = halt.done_us > 0 && (!halt.weighs || halt.awaited > 0);
    if (told && fabs(at_deg - base->done_deg) > still_deg) {
        halt_blame("goes on after the stop was done", j, at_deg, base->done_deg);
    }
}

static void judge_rest(int j, int64_t bound_us)
{
    const halt_base *base = &halt.base[j];
    const far_joint *joint = &halt.far.joint[j];
    double at_deg = far_angle(&halt.far, j, halt.now_us), from_deg, to_deg;
    if (halt.weighs && joint->torque != 1) {
        return; /* it was let go, and falls */
    }
    if (halt.far.lost_frames > 0 && halt.far.lost_us >= halt.asked_us) {
        /* until it is repeated, when every joint was read */
        bound_us += HALT_TIME_US + halt.of->reading_us + halt.of->frame_us + LOST_REPLY_US;
        halt.excused += !base->halted && base->turned;
    }
    double most_deg = may_rest(j, bound_us, &from_deg, &to_deg);
    double off_deg = outside(at_deg, from_deg, to_deg);
    if (base->excused || joint->missed) { /* nobody knew where it was */
        halt.excused += off_deg > most_deg;
        return;
    }
    halt.worst_deg = fmax(halt.worst_deg, off_deg);
    if (off_deg > most_deg) {
        halt_blame(base->rested ? "a joint at rest moves" : "comes to rest too far away", j, at_deg,
                   base->asked_deg);
    }
    judge_end(j, at_deg);
}

/* Servos on one shaft come to rest at one place. */
static void judge_pair(void)
{
    int a = far_of(halt.of->moved), b = far_of(PAIR);
    double apart_deg =
        fabs(far_angle(&halt.far, a, halt.now_us) - far_angle(&halt.far, b, halt.now_us));
    if (apart_deg > APART_DEG) {
        halt_blame("servos on one shaft rest apart", halt.of->moved, apart_deg, APART_DEG);
    }
}

void halt_verdict(int64_t bound_us)
{
    bool turned = false;
    int64_t waited_us = halt.far.motor_left_us - halt.asked_us;
    for (int j = 0; j < halt.far.n_joints; j++) {
        turned = turned || (halt.base[j].left_us > bound_us && !halt.base[j].missed);
        judge_rest(j, bound_us);
    }
    if (halt_is_paired(halt.of)) {
        judge_pair();
    }
    if (turned && (halt.far.motor_left_us == FAR_NEVER || waited_us > bound_us)) {
        halt_blame(halt.far.motor_left_us == FAR_NEVER ? "no frame left"
                                                       : "the first frame is late",
                   -1, (double)waited_us / HALT_MS, (double)bound_us / HALT_MS);
    }
    if (halt.done_us == 0) {
        halt_blame("is never done", -1, 0, 0);
    }
}
