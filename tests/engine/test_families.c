/* SPDX-License-Identifier: MIT */
/* The engine on servos of each family that is a table of registers: it plays postures, trips, and
 * stops; what is set up otherwise, or guarded, is refused. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/rs30x.h>

#include "tests/support/table_bus.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { JOINTS = 3, MS = 1000, S = 1000000 };

/* The second is mounted the other way round, the third turned by 20 degrees and geared down. */
#define JOINT(text, id, number, sense, zero_deg, ratio)                                            \
    {                                                                                              \
        .name = (text), .min_rad = RAD(-80), .max_rad = RAD(80), .max_speed_rad_s = RAD(180),      \
        .servo_model = (number), .motor = (id), .mirror = (id)-1, .mirror_sign = 1,                \
        .sign = (sense), .zero_rad = RAD(zero_deg), .gear = (ratio)                                \
    }
#define ARM(name, number)                                                                          \
    static const grobo_joint name##_joints[] = {JOINT("A", 1, number, 1, 0, 0),                    \
                                                JOINT("B", 2, number, -1, 0, 1),                   \
                                                JOINT("C", 3, number, 1, 20, 1.5)};                \
    static const grobo_model name = GROBO_TABLE(grobo_model, #name, name##_joints,                 \
                                                sizeof(grobo_joint), NULL, JOINTS, 0, 0, NULL)

ARM(xl330, 1200);
ARM(sts3215, 777);
ARM(scs0009, 1284);
ARM(ax12, 12);

typedef struct family {
    const grobo_model *model;
    int (*init)(grobo_driver *driver, const grobo_model *model);
    double step_deg; /* of goals */
    uint8_t hot;     /* an error that tells of heat */
    bool in_status;  /* in each status, else in the register */
    bool many;
} family;

static const family families[] = {
    {&xl330, grobo_dxl2_driver_init, 0.09, GROBO_DXL2_OVERHEATED, false, true},
    {&sts3215, grobo_feetech_driver_init, 0.09, GROBO_FEETECH_OVERHEATED, true, true},
    {&scs0009, grobo_feetech_driver_init, 0.3, GROBO_FEETECH_OVERHEATED, true, false},
    {&ax12, grobo_dxl1_driver_init, 0.3, GROBO_DXL1_OVERHEATED, true, false},
};
enum { FAMILIES = sizeof families / sizeof families[0] };

static const grobo_robot_config quiet = {GROBO_ROBOT_CONFIG_INIT,
                                         .sense_interval_us = GROBO_SENSE_NEVER};
static table_bus bus;
static const family *now;

static void begin(const family *f)
{
    memset(&bus, 0, sizeof bus);
    now = f;
    bus.driver.size = sizeof bus.driver;
    assert_int_equal(f->init(&bus.driver, f->model), GROBO_OK);
}

static void start(const family *f, const grobo_robot_config *config)
{
    begin(f);
    table_start(&bus, config);
}

static grobo_posture posture(double a_deg, double b_deg, double c_deg, int time_ms)
{
    grobo_posture p;
    assert_int_equal(grobo_posture_init(&p, JOINTS), 0);
    p.angle_rad[0] = RAD(a_deg);
    p.angle_rad[1] = RAD(b_deg);
    p.angle_rad[2] = RAD(c_deg);
    p.set = GROBO_JOINTS_ALL(JOINTS);
    p.time_us = time_ms * (int64_t)MS;
    return p;
}

static void at(int joint, double deg)
{
    if (fabs(table_angle_deg(&bus, joint) - deg) > now->step_deg) {
        fail_msg("%s: joint %d is at %f, not %f", now->model->name, joint,
                 table_angle_deg(&bus, joint), deg);
    }
}

static const grobo_event *last(grobo_event_kind kind)
{
    for (size_t i = bus.n_events; i > 0; i--) {
        if (bus.event[i - 1].kind == kind) {
            return &bus.event[i - 1];
        }
    }
    return NULL;
}

/* Torque comes on where the joints stand, whatever the goal was; then they go where they are sent,
 * in the time asked for, and never faster than they can. */
TEST(postures_are_played)
{
    for (int i = 0; i < FAMILIES; i++) {
        start(&families[i], &quiet);
        table_turn(&bus, 0, 30);
        table_turn(&bus, 1, 10);
        table_put(&bus, 0, GROBO_ROLE_GOAL, 100);
        grobo_posture p = posture(-20, 40, 15, 1000);
        int64_t from_us = bus.now_us;
        assert_int_equal(table_wait(&bus, grobo_robot_move(&bus.robot, &p)), GROBO_OK);
        at(0, -20);
        at(1, 40);
        at(2, 15);
        assert_true(bus.now_us - from_us >= 900 * MS && bus.now_us - from_us < 1600 * MS);
        for (int j = 0; j < JOINTS; j++) {
            assert_int_equal(table_get(&bus, j, GROBO_ROLE_TORQUE), 1);
            assert_int_equal(bus.servo[j].jumps, 0);
        }
        p = posture(79, -79, 50, 200); /* faster than the servos: they get more time */
        assert_int_equal(table_wait(&bus, grobo_robot_move(&bus.robot, &p)), GROBO_OK);
        at(0, 79);
        at(1, -79);
        at(2, 50);
        assert_int_equal(bus.servo[0].jumps + bus.servo[1].jumps + bus.servo[2].jumps, 0);
        p = posture(81, 0, 0, 1000);
        assert_int_equal(grobo_robot_move(&bus.robot, &p), GROBO_ERR_LIMIT);
    }
}

/* Half-way the way is straight: the host tells it in segments. */
TEST(ways_are_straight_in_time)
{
    for (int i = 0; i < FAMILIES; i++) {
        start(&families[i], &quiet);
        grobo_posture p = posture(0, 0, 0, 500);
        assert_int_equal(table_wait(&bus, grobo_robot_move(&bus.robot, &p)), GROBO_OK);
        p = posture(60, -60, 30, 2000);
        assert_true(grobo_robot_move(&bus.robot, &p) > 0);
        table_run(&bus, 1100 * MS);
        assert_true(fabs(table_angle_deg(&bus, 0) - 32) < 6);
        assert_true(fabs(table_angle_deg(&bus, 1) + 32) < 6);
    }
}

/* In DYNAMIXEL's X and in STS one frame asks all joints. */
TEST(a_whole_robot_is_read_in_one_frame)
{
    for (int i = 0; i < FAMILIES; i++) {
        const grobo_robot_config busy = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 10 * MS};
        start(&families[i], &busy);
        table_turn(&bus, 2, 33);
        table_run(&bus, S);
        for (int j = 0; j < JOINTS; j++) {
            grobo_joint_info got;
            assert_int_equal(grobo_robot_joint(&bus.robot, j, &got), GROBO_OK);
            double deg = grobo_deg_from_rad(got.state.angle_rad);
            assert_true(fabs(deg - table_angle_deg(&bus, j)) < 0.2);
            assert_int_equal(got.state.temperature_c, 30);
        }
        size_t many = table_count(&bus, GROBO_DXL2_SYNC_READ);
        size_t single = table_count(&bus, GROBO_DXL2_READ);
        if (families[i].many) {
            assert_true(many >= 95 && many <= 101 && single == 0);
        } else {
            assert_true(single >= 285 && many == 0);
        }
    }
}

/* As fast as the wire allows: 98 % of what the bytes of request and replies let through. */
TEST(the_wire_sets_the_rate_of_readings)
{
    static const grobo_robot_config fast = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    for (int i = 0; i < FAMILIES; i++) {
        if (!families[i].many) {
            continue;
        }
        begin(&families[i]);
        grobo_robot_config config = fast;
        config.bus.return_delay_us = 1;
        table_start(&bus, &config);
        table_run(&bus, 100 * MS);
        size_t before = table_count(&bus, GROBO_DXL2_SYNC_READ);
        grobo_bus_cost cost;
        grobo_exchange exchange = {0};
        assert_int_equal(bus.driver.sense_many(&bus.driver, NULL, GROBO_JOINTS_ALL(JOINTS),
                                               GROBO_SENSE_FULL, &exchange),
                         GROBO_OK);
        const grobo_txn txn = {
            .frame = exchange.frame, .frame_bytes = exchange.frame_bytes, .reply = exchange.reply};
        grobo_bus_cost_of(&bus.robot.bus, &txn, &cost);
        table_run(&bus, S);
        size_t reads = table_count(&bus, GROBO_DXL2_SYNC_READ) - before;
        assert_true(reads * cost.total_us >= 98 * (S / 100));
    }
}

/* One that falls silent is missed, and the others are read on. */
TEST(a_silent_joint_trips_a_motion_and_hides_no_other)
{
    for (int i = 0; i < FAMILIES; i++) {
        const grobo_robot_config busy = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 20 * MS};
        start(&families[i], &busy);
        grobo_posture p = posture(0, 0, 0, 500);
        assert_int_equal(table_wait(&bus, grobo_robot_move(&bus.robot, &p)), GROBO_OK);
        p = posture(40, 40, 40, 3000);
        assert_true(grobo_robot_move(&bus.robot, &p) > 0);
        table_run(&bus, 500 * MS);
        bus.servo[1].silent = true;
        table_run(&bus, 2 * S);
        const grobo_event *trip = last(GROBO_EVENT_TRIP);
        assert_non_null(trip);
        assert_int_equal(trip->u.trip.trip, GROBO_TRIP_LOST_REPLIES);
        assert_int_equal(trip->u.trip.joint, 1);
        assert_true(table_angle_deg(&bus, 0) < 38); /* it stopped on its way */
        grobo_joint_info got;
        assert_int_equal(grobo_robot_joint(&bus.robot, 0, &got), GROBO_OK);
        assert_true(got.angle_age_us < 200 * MS);
    }
}

TEST(heat_stops_for_safety)
{
    for (int i = 0; i < FAMILIES; i++) {
        const grobo_robot_config busy = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 20 * MS};
        start(&families[i], &busy);
        grobo_posture p = posture(0, 0, 0, 500);
        assert_int_equal(table_wait(&bus, grobo_robot_move(&bus.robot, &p)), GROBO_OK);
        if (families[i].in_status) {
            bus.error = families[i].hot;
        } else {
            table_put(&bus, 1, GROBO_ROLE_ERROR, families[i].hot);
        }
        table_run(&bus, S);
        assert_non_null(last(GROBO_EVENT_TRIP));
        assert_int_equal(last(GROBO_EVENT_TRIP)->u.trip.trip, GROBO_TRIP_OVERHEATED);
        start(&families[i], &busy);
        assert_int_equal(table_wait(&bus, grobo_robot_move(&bus.robot, &p)), GROBO_OK);
        table_put(&bus, 2, GROBO_ROLE_TEMPERATURE, 66);
        table_run(&bus, S);
        assert_int_equal(last(GROBO_EVENT_TRIP)->u.trip.trip, GROBO_TRIP_TEMPERATURE);
    }
}

/* These servos have no brake: by default they stop and hold; torque off is asked for. */
TEST(an_emergency_stop_holds_or_lets_go)
{
    for (int i = 0; i < FAMILIES; i++) {
        for (int off = 0; off < 2; off++) {
            grobo_robot_config config = quiet;
            config.estop_torque = off ? GROBO_ESTOP_OFF : GROBO_ESTOP_BRAKE;
            start(&families[i], &config);
            grobo_posture p = posture(0, 0, 0, 500);
            int job = grobo_robot_move(&bus.robot, &p);
            assert_int_equal(table_wait(&bus, job), GROBO_OK);
            p = posture(70, -70, 70, 2000);
            assert_true(grobo_robot_move(&bus.robot, &p) > 0);
            table_run(&bus, 700 * MS);
            job = grobo_robot_estop(&bus.robot);
            assert_int_equal(table_wait(&bus, job), GROBO_OK);
            double stopped_deg = table_angle_deg(&bus, 0);
            table_run(&bus, S);
            assert_true(stopped_deg < 40);
            assert_true(fabs(table_angle_deg(&bus, 0) - stopped_deg) < 1);
            for (int j = 0; j < JOINTS; j++) {
                assert_int_equal(table_get(&bus, j, GROBO_ROLE_TORQUE), off ? 0 : 1);
            }
            assert_int_equal(grobo_robot_move(&bus.robot, &p), GROBO_ERR_LATCHED);
        }
    }
}

/* ---- refused --------------------------------------------------------------------------------- */

static void refused(const family *f, int joint, grobo_register_role role, int32_t value)
{
    start(f, &quiet);
    table_put(&bus, joint, role, value);
    grobo_posture p = posture(10, 10, 10, 500);
    int result = table_wait(&bus, grobo_robot_move(&bus.robot, &p));
    if (result != GROBO_ERR_SETUP) {
        fail_msg("%s, role %d, %d: %d", f->model->name, (int)role, (int)value, result);
    }
    assert_int_equal(table_count(&bus, GROBO_DXL2_SYNC_WRITE), 0);
}

TEST(what_is_set_up_otherwise_does_not_move)
{
    const family *x = &families[0], *sts = &families[1], *scs = &families[2], *ax = &families[3];
    refused(x, 1, GROBO_ROLE_MODEL, 1190);
    refused(x, 1, GROBO_ROLE_MODE, GROBO_DXL2_MODE_EXTENDED);
    refused(x, 1, GROBO_ROLE_MODE, GROBO_DXL2_MODE_VELOCITY);
    refused(x, 1, GROBO_ROLE_DIRECTION, 0);
    refused(x, 1, GROBO_ROLE_DIRECTION, GROBO_DXL2_DRIVE_TIME | GROBO_DXL2_DRIVE_REVERSE);
    refused(x, 1, GROBO_ROLE_DIRECTION, GROBO_DXL2_DRIVE_TIME | GROBO_DXL2_DRIVE_WAKES);
    refused(x, 0, GROBO_ROLE_MAX_POSITION, 2900);
    refused(sts, 1, GROBO_ROLE_MODE, GROBO_STS_MODE_PWM);
    refused(sts, 1, GROBO_ROLE_DIRECTION, 8);
    refused(sts, 1, GROBO_ROLE_DIRECTION, 12 | GROBO_STS_PHASE_TURNS);
    refused(sts, 0, GROBO_ROLE_MIN_POSITION, 1200);
    refused(scs, 1, GROBO_ROLE_DIRECTION, 1);
    refused(scs, 1, GROBO_ROLE_MODEL, 1285);
    refused(ax, 1, GROBO_ROLE_MODEL, 18);
    refused(ax, 1, GROBO_ROLE_MAX_POSITION, 0);
}

/* The same arm, of joints whose middle and range are found by hand, or whose first is a gripper. */
static void begin_with(const family *f, bool calibrated, uint8_t torque_limit_pct)
{
    static grobo_joint joints[JOINTS];
    static grobo_model model = GROBO_TABLE_INIT(grobo_model);
    begin(f);
    memcpy(joints, f->model->joints, sizeof joints);
    for (int j = 0; j < JOINTS; j++) {
        joints[j].calibrated = calibrated;
    }
    joints[0].torque_limit_pct = torque_limit_pct;
    model = *f->model;
    model.joints = joints;
    bus.driver.size = sizeof bus.driver;
    assert_int_equal(f->init(&bus.driver, &model), GROBO_OK);
    table_start(&bus, &quiet);
}

static void begin_calibrated(const family *f)
{
    begin_with(f, true, 0);
}

static int moved_to(double a_deg, double b_deg, double c_deg)
{
    grobo_posture p = posture(a_deg, b_deg, c_deg, 500);
    int job = grobo_robot_move(&bus.robot, &p);
    return job < 0 ? job : table_wait(&bus, job);
}

/* It may be read, and made limp; the fault says which register shows it. */
TEST(a_joint_that_was_never_calibrated_does_not_move)
{
    for (int i = 0; i < FAMILIES; i++) {
        begin_calibrated(&families[i]);
        assert_int_equal(moved_to(10, 10, 10), GROBO_ERR_SETUP);
        assert_int_equal(table_count(&bus, GROBO_DXL2_SYNC_WRITE), 0);
        grobo_joint_info got;
        assert_int_equal(grobo_robot_joint(&bus.robot, 0, &got), GROBO_OK);
        const grobo_setup_fault *fault = &got.state.setup;
        assert_non_null(fault->reg);
        bool offset = grobo_servo_register_of(bus.servo[0].servo, GROBO_ROLE_OFFSET) != NULL;
        assert_int_equal(fault->reg->role, offset ? GROBO_ROLE_OFFSET : GROBO_ROLE_MIN_POSITION);
        assert_true(fault->low > fault->high);
        table_put(&bus, 1, GROBO_ROLE_TORQUE, 1);
        int job = grobo_robot_torque(&bus.robot, GROBO_JOINTS_ALL(JOINTS), GROBO_TORQUE_OFF);
        assert_int_equal(table_wait(&bus, job), GROBO_OK);
        assert_int_equal(table_get(&bus, 1, GROBO_ROLE_TORQUE), 0);
    }
}

static void faulty(int joint, double angle_deg)
{
    double value_deg = NAN;
    assert_int_equal(grobo_robot_fault(&bus.robot, &value_deg), joint);
    assert_float_equal(value_deg, angle_deg, 1e-6);
}

/* Its limits are those of its servo, where they are narrower than the robot's. */
TEST(a_calibrated_joint_goes_as_far_as_its_servo)
{
    for (int i = 0; i < FAMILIES; i++) {
        begin_calibrated(&families[i]);
        for (int j = 0; j < JOINTS; j++) {
            const grobo_servo_model *servo = bus.servo[j].servo;
            int32_t ticks_of_deg = (int32_t)servo->span_ticks / servo->span_deg;
            table_put(&bus, j, GROBO_ROLE_MIN_POSITION, servo->middle - 30 * ticks_of_deg);
            table_put(&bus, j, GROBO_ROLE_MAX_POSITION, servo->middle + 50 * ticks_of_deg);
        }
        assert_int_equal(moved_to(40, 20, 10), GROBO_OK);
        at(0, 40);
        at(1, 20);
        assert_int_equal(moved_to(60, 20, 10), GROBO_ERR_LIMIT);
        faulty(0, 60);
        assert_int_equal(moved_to(40, 40, 10), GROBO_ERR_LIMIT); /* mounted the other way round */
        faulty(1, 40);
        assert_int_equal(moved_to(40, -40, 10), GROBO_OK);
        at(0, 40);
        table_put(&bus, 0, GROBO_ROLE_MIN_POSITION, bus.servo[0].servo->middle);
        table_put(&bus, 0, GROBO_ROLE_MAX_POSITION, bus.servo[0].servo->middle);
        grobo_robot_link_down(&bus.robot, bus.now_us);
        grobo_robot_link_up(&bus.robot, bus.now_us);
        assert_int_equal(moved_to(10, 10, 10), GROBO_ERR_SETUP);
    }
}

/* Families whose servos forget their limit of torque, and where it is. */
static const struct {
    int family;
    grobo_register_role role;
    int32_t wanted; /* for 30 % */
} limits[] = {{0, GROBO_ROLE_GOAL_CURRENT, 525},
              {1, GROBO_ROLE_TORQUE_LIMIT, 300},
              {3, GROBO_ROLE_TORQUE_LIMIT, 306}};

static void begin_gripper(size_t i)
{
    begin_with(&families[limits[i].family], false, 30);
    if (limits[i].role == GROBO_ROLE_GOAL_CURRENT) {
        table_put(&bus, 0, GROBO_ROLE_MODE, GROBO_DXL2_MODE_GRIP);
        table_put(&bus, 0, GROBO_ROLE_GOAL_CURRENT, 1750);
    }
}

/* It is there before the torque is, and again where another program has raised it. */
TEST(a_gripper_has_its_limit_before_its_torque)
{
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        begin_gripper(i);
        assert_int_equal(moved_to(20, 20, 20), GROBO_OK);
        assert_int_equal(table_get(&bus, 0, limits[i].role), limits[i].wanted);
        at(0, 20);
        table_put(&bus, 0, limits[i].role, 1000);
        assert_int_equal(moved_to(10, 20, 20), GROBO_OK);
        assert_int_equal(table_get(&bus, 0, limits[i].role), limits[i].wanted);
        table_put(&bus, 0, limits[i].role, limits[i].wanted / 2); /* less is not more */
        assert_int_equal(moved_to(20, 20, 20), GROBO_OK);
        assert_int_equal(table_get(&bus, 0, limits[i].role), limits[i].wanted / 2);
        const grobo_servo_register *reg =
            grobo_servo_register_of(bus.servo[0].servo, limits[i].role);
        static const uint8_t zeros[4];
        const grobo_register_io io = {1, reg->address, reg->bytes, zeros};
        assert_int_equal(grobo_robot_registers(&bus.robot, &io),
                         limits[i].role == GROBO_ROLE_TORQUE_LIMIT ? GROBO_ERR_STATE
                                                                   : GROBO_ERR_UNSUPPORTED);
    }
}

TEST(a_gripper_that_takes_no_limit_gets_no_torque)
{
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        begin_gripper(i);
        bus.servo[0].frozen = grobo_servo_register_of(bus.servo[0].servo, limits[i].role)->address;
        assert_int_equal(moved_to(20, 20, 20), GROBO_ERR_MISMATCH);
        assert_int_equal(table_get(&bus, 0, GROBO_ROLE_TORQUE), 0);
        assert_int_equal(table_get(&bus, 0, GROBO_ROLE_GOAL), 0); /* a goal may wake it */
        table_put(&bus, 0, GROBO_ROLE_TORQUE, 1);
        assert_int_equal(moved_to(20, 20, 20), GROBO_ERR_MISMATCH);
        assert_int_equal(table_get(&bus, 0, GROBO_ROLE_GOAL), 0);
    }
}

/* One that keeps its limit over power-off is set up by hand; one that has none is refused. */
TEST(a_limit_that_is_kept_is_a_setup)
{
    begin_with(&families[2], false, 30);
    assert_int_equal(moved_to(20, 20, 20), GROBO_ERR_SETUP);
    grobo_joint_info got;
    assert_int_equal(grobo_robot_joint(&bus.robot, 0, &got), GROBO_OK);
    assert_int_equal(got.state.setup.reg->role, GROBO_ROLE_MAX_TORQUE);
    assert_int_equal(got.state.setup.high, 300);
    begin_with(&families[2], false, 30);
    table_put(&bus, 0, GROBO_ROLE_MAX_TORQUE, 300);
    assert_int_equal(moved_to(20, 20, 20), GROBO_OK);
    begin_with(&families[0], false, 30); /* a current is bounded in mode 5 alone */
    assert_int_equal(moved_to(20, 20, 20), GROBO_ERR_SETUP);
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_joint joint = {.name = "A",
                         .min_rad = -1,
                         .max_rad = 1,
                         .max_speed_rad_s = 3,
                         .motor = 1,
                         .mirror_sign = 1,
                         .servo_model = 16,
                         .torque_limit_pct = 30};
    const grobo_model one =
        GROBO_TABLE(grobo_model, .name = "ONE", GROBO_MODEL_JOINTS(&joint), .n_joints = 1);
    assert_int_equal(grobo_lx16a_driver_init(&driver, &one), GROBO_ERR_ARG);
    joint.servo_model = 3301;
    assert_int_equal(grobo_ics_driver_init(&driver, &one), GROBO_ERR_ARG);
    assert_int_equal(grobo_rs30x_driver_init(&driver, &one, &grobo_i_rs30x_protocol),
                     GROBO_ERR_ARG);
}

/* Which register, what it holds, what it should. */
TEST(a_fault_says_what_is_wanted)
{
    static const struct {
        int family;
        grobo_register_role role;
        int32_t found, low, high;
    } faults[] = {
        {0, GROBO_ROLE_DIRECTION, 1, 4, 4},
        {0, GROBO_ROLE_DIRECTION, 12, 4, 4},
        {0, GROBO_ROLE_MODE, 4, 3, 3},
        {0, GROBO_ROLE_MODEL, 1190, 1200, 1200},
        {0, GROBO_ROLE_OFFSET, -7, 0, 0},
        {0, GROBO_ROLE_MAX_POSITION, 2900, 2958, 4095},
        {1, GROBO_ROLE_DIRECTION, 0x18, 0x0C, 0x0C},
        {1, GROBO_ROLE_DIRECTION, 0x8C, 0x0C, 0x0C},
        {1, GROBO_ROLE_DIRECTION, 0x8D, 0x0C, 0x0C}, /* both senses: never one without the other */
        {1, GROBO_ROLE_OFFSET, 25, 0, 0},
        {1, GROBO_ROLE_MIN_POSITION, 1200, -32767, 1138},
        {2, GROBO_ROLE_DIRECTION, 1, 0, 0},
        {3, GROBO_ROLE_MODEL, 18, 12, 12},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        grobo_joint_info got;
        refused(&families[faults[i].family], 0, faults[i].role, faults[i].found);
        assert_int_equal(grobo_robot_joint(&bus.robot, 0, &got), GROBO_OK);
        assert_non_null(got.state.setup.reg);
        assert_int_equal(got.state.setup.reg->role, faults[i].role);
        assert_int_equal(got.state.setup.found, faults[i].found);
        assert_int_equal(got.state.setup.low, faults[i].low);
        assert_int_equal(got.state.setup.high, faults[i].high);
    }
}

/* A count of a position that is worth more than the table says: a goal would lead further. */
TEST(a_coarser_count_is_refused)
{
    static grobo_joint joints[JOINTS];
    grobo_joint_info got;
    start(&families[1], &quiet);
    bus.servo[1].memory[30] = 2;
    assert_int_equal(moved_to(10, 10, 10), GROBO_ERR_SETUP);
    assert_int_equal(grobo_robot_joint(&bus.robot, 1, &got), GROBO_OK);
    assert_string_equal(got.state.setup.reg->name, "angular_resolution");
    assert_int_equal(got.state.setup.low, 1);
    for (int way = 0; way < 3; way++) { /* where an MX counts no turns, it means nothing */
        const bool turns = way > 0;
        const uint8_t divider = way < 2 ? 2 : 1;
        const grobo_model model = GROBO_TABLE(grobo_model, .name = "mx28",
                                              GROBO_MODEL_JOINTS(joints), .n_joints = JOINTS);
        const family mx = {&model, grobo_dxl1_driver_init, 0.09, 0, true, false};
        memcpy(joints, ax12_joints, sizeof joints);
        for (int j = 0; j < JOINTS; j++) {
            joints[j].servo_model = 29;
            joints[j].turns = turns;
        }
        start(&mx, &quiet);
        for (int j = 0; j < JOINTS && turns; j++) {
            table_put(&bus, j, GROBO_ROLE_MIN_POSITION, 4095);
        }
        bus.servo[1].memory[22] = divider;
        assert_int_equal(moved_to(10, 10, 10), way == 1 ? GROBO_ERR_SETUP : GROBO_OK);
    }
}

/* A joint that lags behind its goal is not left to crawl there by the next frame with that goal: it
 * gets the speed of a first move. */
TEST(the_same_goal_again_is_no_crawl)
{
    static const int by_speed[] = {1, 3};
    for (size_t i = 0; i < sizeof by_speed / sizeof by_speed[0]; i++) {
        start(&families[by_speed[i]], &quiet);
        assert_int_equal(moved_to(20, 20, 20), GROBO_OK);
        bus.servo[0].from_ticks = bus.servo[0].servo->middle; /* it lags */
        bus.servo[0].from_us = bus.servo[0].to_us = bus.now_us;
        grobo_posture p = posture(20, 20, 20, 100);
        assert_int_equal(grobo_robot_send(&bus.robot, &p), GROBO_OK);
        table_run(&bus, 50 * MS);
        const grobo_servo_register *speed =
            grobo_servo_register_of(bus.servo[0].servo, GROBO_ROLE_SPEED);
        double rpm = strcmp(speed->unit, "0.111 rpm") == 0 ? 6 * 0.111 : 0.088;
        double dps = table_get(&bus, 0, GROBO_ROLE_SPEED) * rpm;
        assert_true(dps > 40 && dps <= 60.7);
    }
}

/* Outside its limits by a little, it is drawn in as it gets torque, and not at once. */
TEST(a_joint_is_drawn_in_softly)
{
    for (int i = 0; i < FAMILIES; i++) {
        start(&families[i], &quiet);
        table_turn(&bus, 0, 82.5);
        grobo_joint_mask one = GROBO_JOINT_BIT(0);
        assert_int_equal(table_wait(&bus, grobo_robot_torque(&bus.robot, one, GROBO_TORQUE_ON)),
                         GROBO_OK);
        assert_true(bus.servo[0].to_us - bus.servo[0].from_us >= 2400 * MS / 61);
        table_run(&bus, 100 * MS);
        at(0, 80);
    }
}

static int write_register(grobo_register_role role)
{
    const grobo_servo_register *reg = grobo_servo_register_of(bus.servo[0].servo, role);
    static const uint8_t zeros[4];
    if (reg == NULL) {
        return GROBO_ERR_UNSUPPORTED;
    }
    const grobo_register_io io = {1, reg->address, reg->bytes, zeros};
    return grobo_robot_registers(&bus.robot, &io);
}

/* Goals and torque are for requests; a setting needs a servo that holds nothing. */
TEST(guarded_registers_are_refused)
{
    static const grobo_register_role motor[] = {GROBO_ROLE_TORQUE,       GROBO_ROLE_GOAL,
                                                GROBO_ROLE_GOAL_TIME,    GROBO_ROLE_SPEED,
                                                GROBO_ROLE_GOAL_SPEED,   GROBO_ROLE_GOAL_PWM,
                                                GROBO_ROLE_GOAL_CURRENT, GROBO_ROLE_ACCELERATION};
    static const grobo_register_role settings[] = {GROBO_ROLE_ID, GROBO_ROLE_MIN_POSITION,
                                                   GROBO_ROLE_MAX_POSITION, GROBO_ROLE_BAUD};
    for (int i = 0; i < FAMILIES; i++) {
        start(&families[i], &quiet);
        grobo_posture p = posture(0, 0, 0, 500);
        assert_int_equal(table_wait(&bus, grobo_robot_move(&bus.robot, &p)), GROBO_OK);
        for (size_t k = 0; k < sizeof motor / sizeof motor[0]; k++) {
            assert_int_equal(write_register(motor[k]), GROBO_ERR_UNSUPPORTED);
        }
        for (size_t k = 0; k < sizeof settings / sizeof settings[0]; k++) {
            assert_int_equal(write_register(settings[k]), GROBO_ERR_STATE);
        }
        static const uint8_t byte[1];
        const grobo_register_io nowhere = {1, 200, 1, byte}; /* as an indirect one would be */
        assert_int_equal(grobo_robot_registers(&bus.robot, &nowhere), GROBO_ERR_UNSUPPORTED);
        const grobo_register_io read = {1, 0, 4, NULL};
        assert_int_equal(table_wait(&bus, grobo_robot_registers(&bus.robot, &read)), GROBO_OK);
    }
}

static int raw(uint8_t id, uint8_t code, uint16_t address, const uint8_t *data, size_t n)
{
    uint8_t b[64];
    int size;
    if (bus.driver.protocol == &grobo_i_dxl2_protocol) {
        const grobo_dxl2_packet p = {
            .id = id, .instruction = code, .address = address, .data = data, .data_bytes = n};
        size = grobo_dxl2_build(&p, b, sizeof b);
    } else {
        const grobo_dxl1_packet p = {.id = id,
                                     .instruction = code,
                                     .address = (uint8_t)address,
                                     .data = data,
                                     .data_bytes = n};
        size = grobo_dxl1_build(&p, b, sizeof b);
    }
    assert_true(size > 0);
    return grobo_robot_raw(&bus.robot, b, (size_t)size);
}

/* A raw goal is checked as one of the engine's own; what nobody can read is refused. */
TEST(raw_frames_are_judged)
{
    for (int i = 0; i < FAMILIES; i++) {
        static const uint8_t ends[4];
        start(&families[i], &quiet);
        grobo_posture p = posture(0, 0, 0, 500);
        assert_int_equal(table_wait(&bus, grobo_robot_move(&bus.robot, &p)), GROBO_OK);
        const grobo_servo_register *goal =
            grobo_servo_register_of(bus.servo[0].servo, GROBO_ROLE_GOAL);
        assert_int_equal(raw(1, GROBO_DXL2_WRITE, goal->address, ends, goal->bytes),
                         GROBO_ERR_LIMIT);
        assert_int_equal(raw(1, GROBO_DXL2_REG_WRITE, goal->address, ends, goal->bytes),
                         GROBO_ERR_UNSUPPORTED);
        assert_int_equal(raw(1, GROBO_DXL2_FACTORY_RESET, 0, ends, 1), GROBO_ERR_UNSUPPORTED);
        uint8_t here[4] = {0};
        assert_int_equal(
            grobo_servo_register_put(bus.servo[0].servo, goal, bus.servo[0].servo->middle, here),
            goal->bytes);
        assert_true(raw(1, GROBO_DXL2_WRITE, goal->address, here, goal->bytes) > 0);
    }
}

/* A goal, and all registers behind it up to this one, where the joint is. */
static int raw_up_to(grobo_register_role role)
{
    const grobo_servo_model *servo = bus.servo[0].servo;
    const grobo_servo_register *goal = grobo_servo_register_of(servo, GROBO_ROLE_GOAL);
    const grobo_servo_register *other = grobo_servo_register_of(servo, role);
    bool behind = other->address > goal->address;
    const grobo_servo_register *first = behind ? goal : other;
    const grobo_servo_register *end = behind ? other : goal;
    uint8_t data[32] = {0};
    size_t n = (size_t)(end->address + end->bytes - first->address);
    assert_true(n <= sizeof data);
    (void)grobo_servo_register_put(servo, other, other->max,
                                   data + (other->address - first->address));
    (void)grobo_servo_register_put(servo, goal, table_get(&bus, 0, GROBO_ROLE_GOAL),
                                   data + (goal->address - first->address));
    return raw(1, GROBO_DXL2_WRITE, first->address, data, n);
}

/* A raw goal brings no other limit of the torque with it: the gripper would pinch harder. */
TEST(a_raw_goal_leaves_a_gripper_its_limit)
{
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        begin_gripper(i);
        assert_int_equal(moved_to(20, 20, 20), GROBO_OK);
        assert_true(raw_up_to(GROBO_ROLE_GOAL) > 0);
        assert_int_equal(raw_up_to(limits[i].role), GROBO_ERR_UNSUPPORTED);
    }
}

TEST(what_a_servo_cannot_reach_is_no_robot)
{
    grobo_joint joints[JOINTS];
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    for (int i = 0; i < FAMILIES; i++) {
        grobo_model model = *families[i].model;
        model.joints = joints;
        memcpy(joints, families[i].model->joints, sizeof joints);
        assert_int_equal(families[i].init(&driver, &model), GROBO_OK);
        joints[0].gear = 4;
        assert_int_equal(families[i].init(&driver, &model), GROBO_ERR_ARG);
        joints[0].gear = 1;
        joints[0].servo_model = 9999;
        assert_int_equal(families[i].init(&driver, &model), GROBO_ERR_ARG);
        assert_int_equal(families[i].init(NULL, &model), GROBO_ERR_ARG);
        assert_int_equal(families[i].init(&driver, NULL), GROBO_ERR_ARG);
    }
}
