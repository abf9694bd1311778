/* SPDX-License-Identifier: MIT */
/*
 * What a driver says that its servos do (grobo_driver: goal_energises, tells_no_speed, keeps_setup,
 * timed_posture), compared with what the simulated servos of each family do. The engine takes no
 * part but where it is asked.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/rs30x.h>
#include <grobo/core/sim.h>
#include <grobo/robot_file.h>

#include "src/servo/families.h"
#include "tests/support/family_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { MS = 1000, S = 1000000, JOINT = 0 };

static family_kit kit;
static const grobo_robot_config idle = {GROBO_ROBOT_CONFIG_INIT,
                                        .sense_interval_us = GROBO_NEVER_US};

static int rs30x_init(grobo_driver *driver, const grobo_model *model)
{
    return grobo_i_family_rs30x.init[GROBO_WIRING_BUS](driver, model);
}

/* Those of the kit, and RS30x. */
static const family *each(const family *before)
{
    static const family rs30x = {"rs30x", &grobo_i_rs30x_table, "RS301CR", rs30x_init, 0.5, 115200,
                                 false};
    if (before == &rs30x) {
        return NULL;
    }
    const family *next = family_next(before);
    return next != NULL ? next : &rs30x;
}

/* A line without an echo, so that all that comes back is of servos. */
static void begin(const family *row)
{
    static family silent;
    silent = *row;
    silent.echo = false;
    family_start(&kit, &silent, &idle, NULL);
}

/* ---- without the engine ---------------------------------------------------------------------- */

static void pass(int64_t us)
{
    kit.now_us += us;
    grobo_sim_step(&kit.sim, kit.now_us);
}

/* Sends a frame; the reply is in bytes. */
static size_t ask(const grobo_exchange *exchange, uint8_t *bytes, size_t cap)
{
    size_t n = 0;
    assert_true(exchange->frame_bytes > 0);
    assert_int_equal(grobo_sim_rx(&kit.sim, exchange->frame, exchange->frame_bytes, kit.now_us),
                     exchange->frame_bytes);
    for (int i = 0; i < 100; i++) {
        pass(MS);
        n += grobo_sim_tx(&kit.sim, bytes + n, cap - n, kit.now_us);
    }
    return n;
}

/* Part `part` of what moves the joint to an angle in a second, from another angle; 0: no more. */
static int goal(double deg, double from_deg, int part, grobo_exchange *exchange)
{
    grobo_target target = {0};
    assert_int_equal(grobo_posture_init(&target.posture, kit.model.n_joints), 0);
    target.posture.set = GROBO_JOINT_BIT(JOINT);
    target.posture.angle_rad[JOINT] = grobo_rad_from_deg(deg);
    target.joint_time_us[JOINT] = S;
    target.from_rad[JOINT] = grobo_rad_from_deg(from_deg);
    memset(exchange, 0, sizeof *exchange);
    return kit.driver.posture(&kit.driver, NULL, &target, part, exchange);
}

static void send_goal(double deg)
{
    grobo_exchange exchange;
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    for (int part = 0; goal(deg, family_angle_deg(&kit, JOINT), part, &exchange) > 0; part++) {
        (void)ask(&exchange, bytes, sizeof bytes);
    }
}

static void switch_on(void)
{
    grobo_exchange exchange = {0};
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    for (int part = 0; kit.driver.torque(&kit.driver, NULL, GROBO_JOINT_BIT(JOINT), GROBO_TORQUE_ON,
                                         part, &exchange) > 0;
         part++) {
        (void)ask(&exchange, bytes, sizeof bytes);
        memset(&exchange, 0, sizeof exchange);
    }
}

/* All exchanges of a reading: which values it has, and the speed. */
static grobo_joint_state read_all(void)
{
    grobo_joint_state all = {0};
    grobo_exchange exchange = {0};
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    int more = 1;
    assert_int_equal(kit.driver.sense(&kit.driver, NULL, JOINT, GROBO_SENSE_FULL, &exchange), 0);
    for (int part = 1; more > 0; part++) {
        grobo_packet packet;
        grobo_joint_state state = {0};
        size_t n = ask(&exchange, bytes, sizeof bytes);
        assert_int_equal(n, exchange.reply.bytes);
        kit.driver.protocol->unpack(bytes, n, &packet);
        packet.address = exchange.reply.address;
        assert_int_equal(kit.driver.parse(&kit.driver, NULL, JOINT, &packet, &state), 0);
        all.valid |= state.valid;
        all.speed_dps = (state.valid & GROBO_FIELD_SPEED) != 0 ? state.speed_dps : all.speed_dps;
        memset(&exchange, 0, sizeof exchange);
        more = kit.driver.sense_more == NULL
                   ? 0
                   : kit.driver.sense_more(&kit.driver, NULL, JOINT, GROBO_SENSE_FULL, part,
                                           &exchange);
    }
    return all;
}

static grobo_sim_view look(void)
{
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&kit.sim, JOINT, &view), GROBO_OK);
    return view;
}

/* ---- the tests ------------------------------------------------------------------------------- */

/* A goal to a limp joint: whether it comes to life is what the driver says. */
TEST_FOR(family, each, a_goal_energises_whom_it_is_said_to)
{
    begin(row);
    double before_deg = family_angle_deg(&kit, JOINT);
    assert_int_equal(look().torque, GROBO_TORQUE_OFF);
    send_goal(before_deg + 20);
    pass(2 * S);
    bool on = look().torque == GROBO_TORQUE_ON;
    bool moved = fabs(family_angle_deg(&kit, JOINT) - before_deg) > 5;
    assert_int_equal(on, kit.driver.goal_energises);
    assert_int_equal(moved, kit.driver.goal_energises);
}

/* And the engine sends none there, whatever its servos would do. */
TEST_FOR(family, each, no_move_energises_a_limp_joint)
{
    begin(row);
    assert_int_equal(family_move(&kit, 0, 500), GROBO_OK);
    int number = grobo_robot_torque(&kit.robot, GROBO_JOINT_BIT(1), GROBO_TORQUE_OFF);
    assert_int_equal(family_wait(&kit, number), GROBO_OK);
    double before_deg = family_angle_deg(&kit, 1);
    grobo_posture p = family_posture(&kit, 20, 500);
    p.set = GROBO_JOINT_BIT(JOINT);
    assert_int_equal(family_wait(&kit, grobo_robot_move(&kit.robot, &p)), GROBO_OK);
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&kit.sim, 1, &view), GROBO_OK);
    assert_int_equal(view.torque, GROBO_TORQUE_OFF);
    assert_true(fabs(family_angle_deg(&kit, 1) - before_deg) < 1);
}

/* A reading on the way: it has a speed, and that of the shaft, where the driver says so. */
TEST_FOR(family, each, a_speed_is_told_where_it_is_said_to_be)
{
    begin(row);
    send_goal(family_angle_deg(&kit, JOINT)); /* some move as torque comes on */
    switch_on();
    pass(S);
    send_goal(family_angle_deg(&kit, JOINT) + 40);
    grobo_sim_view view = look();
    grobo_joint_state state = read_all();
    assert_true(view.moving && view.speed_dps > 20);
    assert_true((state.valid & GROBO_FIELD_ANGLE) != 0);
    assert_int_equal((state.valid & GROBO_FIELD_SPEED) == 0, kit.driver.tells_no_speed);
    if (!kit.driver.tells_no_speed) {
        assert_true(abs(state.speed_dps - view.speed_dps) < 0.2 * view.speed_dps);
    }
}

/* The first frame that asks for angles, of one joint or of all. */
static grobo_exchange first;
static bool first_is_all;

static void keep_first(family_kit *of, const grobo_sim_event *event)
{
    static const grobo_sense_kind kinds[] = {GROBO_SENSE_ALL, GROBO_SENSE_POSITION};
    for (int i = 0; i < 4 && event->kind == GROBO_SIM_PACKET && first.frame_bytes == 0; i++) {
        grobo_exchange expected = {0};
        grobo_sense_kind kind = kinds[i / 2];
        int result = i % 2 == 0 ? of->driver.sense(&of->driver, NULL, JOINT, kind, &expected)
                     : of->driver.sense_many == NULL
                         ? GROBO_ERR_UNSUPPORTED
                         : of->driver.sense_many(&of->driver, NULL, GROBO_JOINTS_ALL(FAMILY_JOINTS),
                                                 kind, &expected);
        if (result >= 0 && event->n_bytes == expected.frame_bytes &&
            memcmp(event->bytes, expected.frame, event->n_bytes) == 0) {
            first = expected;
            first_is_all = kind == GROBO_SENSE_ALL;
        }
    }
}

/* Where servos keep a setup, the first reading of a joint is of all, also where angles alone are
 * asked for. */
TEST_FOR(family, each, the_first_reading_looks_at_a_setup)
{
    static const grobo_robot_config angles = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 50 * MS,
                                              .sense_position_only = true};
    memset(&first, 0, sizeof first);
    family_start(&kit, row, &angles, NULL);
    kit.on_sim = keep_first;
    family_run(&kit, S);
    assert_true(first.frame_bytes > 0);
    assert_true(first_is_all || !kit.driver.keeps_setup);
}

/* A joint that its servo's setup does not let reach its limits is not moved. */
TEST_FOR(family, family_next, a_joint_that_is_set_up_otherwise_stays)
{
    begin(row);
    assert_true(kit.driver.keeps_setup);
    family_set_up(&kit, JOINT, GROBO_ROLE_MAX_POSITION, kit.servos[JOINT]->middle);
    double before_deg = family_angle_deg(&kit, JOINT);
    grobo_posture p = family_posture(&kit, 20, 500);
    p.set = GROBO_JOINT_BIT(JOINT);
    int number = grobo_robot_move(&kit.robot, &p);
    assert_int_equal(number > 0 ? family_wait(&kit, number) : number, GROBO_ERR_SETUP);
    assert_true(fabs(family_angle_deg(&kit, JOINT) - before_deg) < 0.5);
}

/* A goal that is an angle and a time is the same frame wherever the joint is. */
TEST_FOR(family, each, a_timed_posture_does_not_ask_from_where)
{
    begin(row);
    grobo_exchange here, there;
    bool timed = kit.driver.timed_posture == kit.driver.posture;
    for (int part = 0; goal(30, 0, part, &here) > 0; part++) {
        assert_int_equal(goal(30, -60, part, &there), 1);
        bool same = here.frame_bytes == there.frame_bytes &&
                    memcmp(here.frame, there.frame, here.frame_bytes) == 0;
        assert_true(same || !timed);
    }
    assert_int_equal(timed, strcmp(row->name, "rs30x") == 0);
}
