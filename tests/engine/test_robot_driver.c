/* SPDX-License-Identifier: MIT */
/* What the engine owes a driver: its context, every part of an order, and what it answers. */
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip;
static const grobo_driver *inner;
static int context;
static unsigned calls[9];
static bool has_no_frame; /* for any target */
static unsigned frames;   /* before the driver fails */
static bool fails_once;

/* ---- a driver that looks at its context ------------------------------------------------------ */

static void count(const grobo_driver *self, void *ctx, int what)
{
    assert_ptr_equal(self, rig.driver);
    assert_ptr_equal(ctx, &context);
    calls[what]++;
}

/* So it comes to a driver, which need not say what it does not want; the bytes of the frame it
 * writes all. */
static void expect_zeroed(const grobo_exchange *exchange)
{
    static const grobo_exchange zeroed;
    assert_memory_equal(exchange, &zeroed, offsetof(grobo_exchange, frame));
}

static int check(const grobo_driver *self, void *ctx, int part, grobo_exchange *exchange)
{
    count(self, ctx, 0);
    expect_zeroed(exchange);
    return inner->check(inner, NULL, part, exchange);
}

/* Frames of four joints at most, as many as that takes. */
static grobo_joint_mask part_of(grobo_joint_mask joints, int part)
{
    grobo_joint_mask mine = 0;
    int n = 0;
    for (int j = 0; j < 20; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) != 0) {
            mine |= n / 4 == part ? GROBO_JOINT_BIT(j) : 0;
            n++;
        }
    }
    return mine;
}

static int posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                   grobo_exchange *exchange)
{
    count(self, ctx, 1);
    expect_zeroed(exchange);
    if (has_no_frame) {
        return 0;
    }
    if (frames == 0 || fails_once) {
        fails_once = false;
        return GROBO_ERR_SPACE;
    }
    frames--;
    grobo_target mine = *target;
    mine.posture.set = part_of(target->posture.set, part);
    return mine.posture.set == 0 ? 0 : inner->posture(inner, NULL, &mine, 0, exchange);
}

static int torque(const grobo_driver *self, void *ctx, grobo_joint_mask joints, grobo_torque mode,
                  int part, grobo_exchange *exchange)
{
    count(self, ctx, 2);
    expect_zeroed(exchange);
    grobo_joint_mask mine = part_of(joints, part);
    return mine == 0 ? 0 : inner->torque(inner, NULL, mine, mode, 0, exchange);
}

static int sense(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                 grobo_exchange *exchange)
{
    count(self, ctx, 3);
    expect_zeroed(exchange);
    return inner->sense(inner, NULL, joint, kind, exchange);
}

static int parse(const grobo_driver *self, void *ctx, int joint, const grobo_packet *reply,
                 grobo_joint_state *state)
{
    count(self, ctx, 4);
    return inner->parse(inner, NULL, joint, reply, state);
}

static int registers(const grobo_driver *self, void *ctx, const grobo_register_io *io,
                     grobo_exchange *exchange)
{
    count(self, ctx, 5);
    expect_zeroed(exchange);
    return inner->registers(inner, NULL, io, exchange);
}

static int command(const grobo_driver *self, void *ctx, int id, grobo_servo_command what,
                   grobo_exchange *exchange)
{
    count(self, ctx, 6);
    expect_zeroed(exchange);
    return inner->command(inner, NULL, id, what, exchange);
}

static int inspect(const grobo_driver *self, void *ctx, const uint8_t *frame, size_t size,
                   grobo_target *target, grobo_joint_mask *torqued)
{
    count(self, ctx, 7);
    return inner->inspect(inner, NULL, frame, size, target, torqued);
}

static int stabilize(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                     grobo_posture *target)
{
    count(self, ctx, 8);
    assert_int_equal(sensed->n_joints, target->n_joints);
    return 0;
}

static void start(const grobo_robot_config *config)
{
    static grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_robot_config used = *config;
    inner = grobo_gr001_driver(rig_wiring);
    driver = *inner;
    driver.check = check;
    driver.posture = posture;
    driver.torque = torque;
    driver.sense = sense;
    driver.parse = parse;
    driver.registers = registers;
    driver.command = command;
    driver.inspect = inspect;
    driver.stabilize = stabilize;
    memset(calls, 0, sizeof calls);
    has_no_frame = false;
    frames = UINT_MAX;
    rig_start_driver(&rig, &driver, config, NULL);
    grobo_event_fn on_event = rig.robot.on_event; /* again, with a context */
    assert_int_equal(grobo_robot_init(&rig.robot, &driver, &context, &used, rig.now_us), 0);
    rig_host(&rig);
    grobo_robot_on_event(&rig.robot, on_event, &rig);
    grobo_robot_link_up(&rig.robot, rig.now_us);
}

static grobo_posture all_at(double way_deg, int time_ms)
{
    grobo_posture target;
    grobo_posture_init_pose(&target, rig.driver->model);
    for (int j = 0; j < target.n_joints; j++) {
        target.angle_rad[j] += grobo_rad_from_deg(way_deg);
    }
    (void)grobo_posture_clamp(&target, rig.driver->model);
    target.time_us = time_ms * 1000LL;
    return target;
}

static void expect_all_at(const grobo_posture *target)
{
    for (int j = 0; j < target->n_joints; j++) {
        assert_true(fabs(rig_angle_deg(&rig, j) - grobo_deg_from_rad(target->angle_rad[j])) < 0.1);
    }
}

/* ---- tests ----------------------------------------------------------------------------------- */

TEST_WITH(rig_wirings, every_function_gets_the_context)
{
    static const rig_key nod[] = {{0, {{NECK, 10}}}, {500, {{NECK, 0}}}};
    uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 200000};
    start(&config);
    rig_expect(&rig, grobo_robot_check(&rig.robot), GROBO_OK);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 10, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_clip_init(&clip, nod, 2);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_FINISHED);
    grobo_register_io io = {R_ELBOW_ID, 42, 2, NULL};
    rig_expect(&rig, grobo_robot_registers(&rig.robot, &io), GROBO_OK);
    int n =
        grobo_frame_read(grobo_wiring_protocol(rig_wiring), NECK_ID, 42, 2, frame, sizeof frame);
    rig_expect(&rig, grobo_robot_raw(&rig.robot, frame, (size_t)n), GROBO_OK);
    rig_run(&rig, 1000000);
    rig_expect(&rig, grobo_robot_command(&rig.robot, NECK_ID, GROBO_SERVO_REBOOT), GROBO_OK);
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        assert_true(calls[i] > 0);
    }
}

/* A bus that has no frame for all joints: all parts of an order leave, of whatever kind it is. */
TEST_WITH(rig_wirings, an_order_of_several_frames_is_whole)
{
    start(&quiet);
    rig_power(&rig);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), GROBO_TORQUE_ON);
    }
    grobo_posture target = all_at(5, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    expect_all_at(&target);
    target = all_at(-5, 500);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 700000);
    expect_all_at(&target);
    rig_expect(&rig, grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_BRAKE), GROBO_OK);
    for (int j = 0; j < 20; j++) {
        assert_int_equal(rig_torque(&rig, j), GROBO_TORQUE_BRAKE);
    }
}

TEST_WITH(rig_wirings, a_halt_of_several_frames_stops_all)
{
    start(&quiet);
    rig_power(&rig);
    grobo_posture target = all_at(5, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    target = all_at(-5, 5000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
    rig_run(&rig, 400000);
    double here_deg[20];
    for (int j = 0; j < 20; j++) {
        here_deg[j] = rig_angle_deg(&rig, j);
    }
    rig_run(&rig, 3000000);
    for (int j = 0; j < 20; j++) {
        assert_true(fabs(rig_angle_deg(&rig, j) - here_deg[j]) < 0.01);
    }
    target = all_at(-5, 500);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - grobo_deg_from_rad(target.angle_rad[NECK])) > 3);
}

/* Most of the frames would have no joint that moves. */
TEST_WITH(rig_wirings, a_halt_of_several_frames_stops_one)
{
    for (int j = 0; j < 20; j++) {
        start(&quiet);
        rig_power(&rig);
        grobo_posture target = all_at(0, 500);
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
        const grobo_joint *limits = &rig.driver->model->joints[j];
        double from_deg = rig_angle_deg(&rig, j);
        bool down = from_deg * 2 > grobo_deg_from_rad(limits->min_rad + limits->max_rad);
        target = rig_posture(&rig, j, from_deg + (down ? -5 : 5), 2000);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
        rig_run(&rig, 1000000);
        assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
        rig_run(&rig, 2000000);
        assert_in_range(lround(10 * fabs(rig_angle_deg(&rig, j) - from_deg)), 22, 32);
    }
}

/* A target for which the driver has no frame is no move. */
TEST_WITH(rig_wirings, an_order_without_a_frame_is_over)
{
    start(&quiet);
    rig_power(&rig);
    grobo_posture target = all_at(5, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    rig_forget(&rig);
    has_no_frame = true;
    target = all_at(-5, 5000);
    (void)grobo_robot_send(&rig.robot, &target);
    rig_run(&rig, 100000);
    assert_int_equal(rig.n_sent, 0);
    assert_false(grobo_robot_moving(&rig.robot));
    target = rig_posture(&rig, NECK, 10, 5000);
    (void)grobo_robot_send(&rig.robot, &target);
    rig_run(&rig, 100000);
    assert_false(grobo_robot_moving(&rig.robot));
    has_no_frame = false;
    target = all_at(0, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    expect_all_at(&target);
}

/* Half of a target is no posture: where a later frame of it cannot be made, none leaves. */
TEST_WITH(rig_wirings, an_order_leaves_whole_or_not_at_all)
{
    for (unsigned n = 1; n < 12; n++) {
        start(&quiet);
        rig_power(&rig);
        grobo_posture target = all_at(5, 500);
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
        rig_forget(&rig);
        frames = n;
        target = all_at(-5, 5000);
        int result = grobo_robot_send(&rig.robot, &target);
        frames = UINT_MAX;
        rig_run(&rig, 100000);
        if (result < 0) {
            assert_int_equal(result, GROBO_ERR_SPACE);
            assert_int_equal(rig.n_sent, 0);
            assert_false(grobo_robot_moving(&rig.robot));
        }
    }
}

/* A motion of which a frame cannot be made ends, and all that moves beside it comes to rest. */
TEST_WITH(rig_wirings, a_motion_that_cannot_go_on_stops_the_robot)
{
    static const rig_key nod[] = {{0, {{NECK, 0}}}, {500, {{NECK, 20}}}, {1000, {{NECK, 0}}}};
    start(&quiet);
    rig_power(&rig);
    grobo_posture beside = rig_posture(&rig, R_ELBOW, -100, 8000);
    rig_clip_init(&clip, nod, 3);
    clip.only = GROBO_JOINT_BIT(NECK);
    assert_true(grobo_robot_play(&rig.robot, &clip.clip, NULL) > 0);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    assert_true(grobo_robot_move(&rig.robot, &beside) > 0);
    rig_run(&rig, 200000);
    fails_once = true;
    rig_wait_play(&rig, GROBO_SEQUENCER_FAILED);
    assert_false(fails_once);
    rig_run(&rig, 300000);
    const double stopped_deg = rig_angle_deg(&rig, R_ELBOW);
    rig_run(&rig, 5000000);
    assert_true(fabs(rig_angle_deg(&rig, R_ELBOW) - stopped_deg) < 0.5);
    assert_true(stopped_deg > -40);
}

/* What does not take is told again, in frames of few joints: they get through. */
TEST_WITH(rig_wirings, what_is_told_again_is_told_in_small_frames)
{
    unsigned of_four = 0;
    rig_start(&rig, &quiet, NULL);
    assert_int_equal(grobo_sim_set_fault(&rig.sim, GROBO_SIM_FAULT_SILENT, 0.3), 0);
    (void)rig_wait(&rig, grobo_robot_torque(&rig.robot, rig_all(&rig), GROBO_TORQUE_ON));
    unsigned whole = 0;
    for (size_t i = 0; i < rig.n_sent; i++) {
        const uint8_t *p;
        (void)rig_packet(&rig.sent[i], &p);
        if (p[2] == 0 && p[4] == GROBO_RS30X_GOAL) { /* one that means several servos */
            whole += p[6] > 4;
            of_four += p[6] == 4;
        }
    }
    assert_int_equal(whole, 1);
    assert_true(of_four > 0);
}

static int torque_that_fails(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                             grobo_torque mode, int part, grobo_exchange *exchange)
{
    (void)self;
    (void)ctx;
    (void)joints;
    (void)mode;
    (void)part;
    (void)exchange;
    return GROBO_ERR_UNSUPPORTED;
}

/* The neck has not arrived, and stands. */
static void expect_neck_stands(void)
{
    double here_deg = rig_angle_deg(&rig, NECK);
    rig_run(&rig, 1000000);
    assert_true(fabs(rig_angle_deg(&rig, NECK) - here_deg) < 0.01);
    assert_in_range(fabs(here_deg), 1, 35);
    assert_int_equal(rig_torque(&rig, NECK), GROBO_TORQUE_ON);
}

/* It is latched, and what moves is halted and holds; so it is where the line comes back. */
TEST_WITH(rig_wirings, an_emergency_stop_without_torque_halts)
{
    for (int way = 0; way < 4; way++) {
        grobo_driver driver = *grobo_gr001_driver(rig_wiring);
        grobo_posture target;
        rig_start_driver(&rig, &driver, &quiet, NULL);
        rig_power(&rig);
        target = rig_posture(&rig, NECK, 10, 500);
        rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
        driver.torque = way % 2 == 0 ? NULL : torque_that_fails;
        rig.halts_at_estop = true;
        target = rig_posture(&rig, NECK, -40, 3000);
        int move = grobo_robot_move(&rig.robot, &target);
        rig_run(&rig, 1000000);
        if (way < 2) {
            int number = grobo_robot_estop(&rig.robot);
            assert_true(number > move);
            rig_expect(&rig, number, GROBO_OK);
        } else {
            grobo_robot_link_down(&rig.robot, rig.now_us);
            assert_int_equal(grobo_robot_estop(&rig.robot), GROBO_ERR_CLOSED);
            rig_forget(&rig);
            grobo_robot_link_up(&rig.robot, rig.now_us);
            rig_run(&rig, 600000);
            assert_int_equal(rig_last(&rig, GROBO_EVENT_JOB)->u.job.kind, GROBO_JOB_ESTOP);
            assert_int_equal(rig_last(&rig, GROBO_EVENT_JOB)->u.job.result, GROBO_OK);
        }
        expect_neck_stands();
        assert_int_equal(grobo_robot_move(&rig.robot, &target), GROBO_ERR_LATCHED);
        assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_ERR_LATCHED);
    }
}

/* It missed the halt, and its reading is lost: the stop is over when it was heard again. */
TEST_WITH(rig_wirings, an_emergency_stop_without_torque_reaches_who_was_deaf)
{
    grobo_driver driver = *grobo_gr001_driver(rig_wiring);
    rig_start_driver(&rig, &driver, &quiet, NULL);
    rig_power(&rig);
    grobo_posture target = rig_posture(&rig, NECK, 10, 500);
    rig_expect(&rig, grobo_robot_move(&rig.robot, &target), GROBO_OK);
    driver.torque = NULL;
    rig.halts_at_estop = true;
    target = rig_posture(&rig, NECK, -40, 9000);
    assert_true(grobo_robot_move(&rig.robot, &target) > 0);
    rig_run(&rig, 1000000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    int number = grobo_robot_estop(&rig.robot);
    rig_run(&rig, 2000000);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_IN), 0);
    rig_expect(&rig, number, GROBO_OK);
    expect_neck_stands();
}

/* It never answers: the stop ends, names it, and the others were read. */
TEST_WITH(rig_wirings, an_emergency_stop_without_torque_gives_up_who_is_silent)
{
    grobo_driver driver = *grobo_gr001_driver(rig_wiring);
    rig_start_driver(&rig, &driver, &quiet, NULL);
    rig_power(&rig);
    driver.torque = NULL;
    rig.halts_at_estop = true;
    assert_int_equal(grobo_sim_set_cable(&rig.sim, NECK, GROBO_SIM_CABLE_MUTE), 0);
    int64_t begun_us = rig.now_us;
    int number = grobo_robot_estop(&rig.robot);
    const grobo_event_job *job = rig_expect(&rig, number, GROBO_ERR_TIMEOUT);
    assert_true(job->failed == GROBO_JOINT_BIT(NECK));
    assert_int_equal(job->joint, NECK);
    assert_true(rig.now_us - begun_us < 5000000);
}

static int no_more(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind, int part,
                   grobo_exchange *exchange)
{
    (void)self;
    (void)ctx;
    (void)kind;
    (void)exchange;
    assert_int_equal(part, 1);
    return joint == NECK ? GROBO_ERR_SPACE : 0;
}

/* A reading is as good as what a driver has to ask for it. */
TEST_WITH(rig_wirings, a_reading_that_cannot_be_asked_on_fails)
{
    grobo_driver driver = *grobo_gr001_driver(rig_wiring);
    driver.sense_more = no_more;
    rig_start_driver(&rig, &driver, &quiet, NULL);
    const grobo_joint_mask neck = GROBO_JOINT_BIT(NECK);
    int number = grobo_robot_sense(&rig.robot, neck, GROBO_SENSE_ALL);
    assert_int_equal(rig_expect(&rig, number, GROBO_ERR_SPACE)->failed, neck);
    assert_int_equal(rig_last(&rig, GROBO_EVENT_JOINT)->u.joint.result, GROBO_ERR_SPACE);
    number = grobo_robot_sense(&rig.robot, rig_all(&rig) & ~neck, GROBO_SENSE_ALL);
    rig_expect(&rig, number, GROBO_OK);
}
