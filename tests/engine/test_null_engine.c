/* SPDX-License-Identifier: MIT */
/* Bus, sequencer, engine and simulator refuse NULL for each thing that must be there. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <grobo/core/board.h>
#include <grobo/core/imu.h>
#include <grobo/core/lines.h>
#include <grobo/core/robot.h>
#include <grobo/core/sim.h>
#include <grobo/core/sim_physics.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/core/team.h>
#include <grobo/core/wheel.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

#define REFUSES(call) assert_int_equal(call, GROBO_ERR_ARG)

static uint8_t bytes[256];
static char text[] = "CHEST";
static double reals[64];
static int32_t wides[64];
static grobo_clip clip;
static grobo_bus bus;
static grobo_bus_config bus_config;
static grobo_txn txn;
static grobo_bus_cost cost;
static const grobo_driver *driver;
static grobo_robot robot;
static grobo_posture posture;
static grobo_play_options play_options = {GROBO_PLAY_OPTIONS_INIT};
static grobo_robot_config robot_config = {GROBO_ROBOT_CONFIG_INIT};
static grobo_register_io io;
static grobo_joint_info joint_info;
static grobo_trip_info trip;
static grobo_play_progress progress;
static grobo_budget budget;
static grobo_jitter jitter;
static grobo_sequencer seq;
static grobo_play_frame frame;
static grobo_sim_config sim_config = {GROBO_SIM_CONFIG_INIT};
static grobo_sim sim;
static grobo_sim_view view;

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    (void)event;
}

static int set_up(void)
{
    driver = grobo_gr001_driver(GROBO_WIRING_BOARD);
    bus_config.protocol = driver->protocol;
    assert_int_equal(grobo_bus_init(&bus, &bus_config), GROBO_OK);
    assert_int_equal(grobo_board_check(bytes, sizeof bytes), 2);
    assert_int_equal(grobo_txn_init(&txn, driver->protocol, bytes, 2), GROBO_OK);
    assert_int_equal(grobo_robot_init(&robot, driver, NULL, NULL, 0), GROBO_OK);
    grobo_robot_link_up(&robot, 0);
    grobo_sequencer_init(&seq, driver->model);
    assert_int_equal(grobo_sim_init(&sim, NULL, 0), GROBO_OK);
    grobo_posture_init_pose(&posture, driver->model);
    io = (grobo_register_io){.id = 1, .length = 1};
    return 0;
}

static int tear_down(void)
{
    return 0;
}

TEST(bus_refuses_null)
{
    REFUSES(grobo_bus_init(NULL, &bus_config));
    REFUSES(grobo_bus_init(&bus, NULL));
    REFUSES(grobo_txn_init(NULL, &grobo_i_rs30x_protocol, bytes, 1));
    REFUSES(grobo_txn_init(&txn, NULL, bytes, 1));
    REFUSES(grobo_txn_init(&txn, &grobo_i_rs30x_protocol, NULL, 1));
    REFUSES(grobo_bus_submit(NULL, &txn));
    REFUSES(grobo_bus_submit(&bus, NULL));
    assert_false(grobo_txn_is_pending(NULL));
    REFUSES(grobo_bus_cancel(NULL, &txn));
    REFUSES(grobo_bus_cancel(&bus, NULL));
    REFUSES(grobo_bus_raise(NULL, &txn, 0));
    REFUSES(grobo_bus_raise(&bus, NULL, 0));
    REFUSES(grobo_bus_cancel_all(NULL, 0, 0));
    grobo_bus_rx(NULL, bytes, 1, 1000);
    grobo_bus_rx(&bus, NULL, 1, 1000);
    grobo_bus_step(NULL, 1000);
    REFUSES(grobo_bus_tx(NULL, bytes, sizeof bytes, 1000));
    REFUSES(grobo_bus_tx(&bus, NULL, sizeof bytes, 1000));
    assert_true(grobo_bus_deadline(NULL, 1000) == GROBO_NEVER_US);
    grobo_bus_reserve(NULL, 0, 0);
    assert_false(grobo_bus_fits(NULL, 1000, &txn));
    assert_false(grobo_bus_fits(&bus, 1000, NULL));
    assert_true(grobo_bus_free_at(NULL, 1000) == GROBO_NEVER_US);
    REFUSES(grobo_bus_pending(NULL));
    grobo_bus_cost_of(NULL, &txn, &cost);
    grobo_bus_cost_of(&bus, NULL, &cost);
    grobo_bus_cost_of(&bus, &txn, NULL);
}

TEST(robot_refuses_null_in_its_first_functions)
{
    grobo_robot_set_host(NULL, NULL);
    REFUSES(grobo_robot_init_sized(&robot, sizeof robot - 1, driver, NULL, &robot_config, 1000));
    REFUSES(grobo_robot_init_sized(NULL, sizeof robot, driver, NULL, &robot_config, 1000));
    REFUSES(grobo_robot_init(NULL, driver, NULL, &robot_config, 1000));
    REFUSES(grobo_robot_init(&robot, NULL, NULL, &robot_config, 1000));
    grobo_robot_on_event(NULL, on_event, NULL);
    REFUSES(grobo_robot_configure(NULL, &robot_config));
    grobo_robot_rx(NULL, bytes, 1, 1000);
    grobo_robot_rx(&robot, NULL, 1, 1000);
    REFUSES(grobo_robot_tx(NULL, bytes, sizeof bytes, 1000));
    REFUSES(grobo_robot_tx(&robot, NULL, sizeof bytes, 1000));
    grobo_robot_step(NULL, 1000);
    grobo_robot_rx_step(NULL, bytes, 1, 1000);
    grobo_robot_rx_step(&robot, NULL, 1, 1000);
    assert_false(grobo_robot_stops(NULL, 1000));
    assert_true(grobo_robot_deadline(NULL, 1000) == GROBO_NEVER_US);
    grobo_robot_link_up(NULL, 1000);
    grobo_robot_link_down(NULL, 1000);
    REFUSES(grobo_robot_check(NULL));
    REFUSES(grobo_robot_sense(NULL, 1, 0));
    REFUSES(grobo_robot_torque(NULL, 1, 0));
    REFUSES(grobo_robot_move(NULL, &posture));
    REFUSES(grobo_robot_move(&robot, NULL));
    REFUSES(grobo_robot_retarget(NULL, &posture));
    REFUSES(grobo_robot_retarget(&robot, NULL));
    REFUSES(grobo_robot_send(NULL, &posture));
    REFUSES(grobo_robot_send(&robot, NULL));
    REFUSES(grobo_robot_raw(NULL, bytes, 1));
}

TEST(robot_refuses_null_in_its_second_functions)
{
    REFUSES(grobo_robot_raw(&robot, NULL, 1));
    REFUSES(grobo_robot_raw_until(NULL, bytes, 1, 1000));
    REFUSES(grobo_robot_raw_until(&robot, NULL, 1, 1000));
    REFUSES(grobo_robot_registers(NULL, &io));
    REFUSES(grobo_robot_registers(&robot, NULL));
    REFUSES(grobo_robot_command(NULL, 1, 0));
    REFUSES(grobo_robot_stored(NULL, 0, 1));
    REFUSES(grobo_robot_exit(NULL, 0));
    REFUSES(grobo_robot_estop(NULL));
    REFUSES(grobo_robot_latch(NULL));
    REFUSES(grobo_robot_drive(NULL, 1, (const double[1]){0}));
    REFUSES(grobo_robot_wheel(NULL, 0, &(grobo_wheel_info){.asked_rad_s = 0}));
    REFUSES(grobo_robot_set_imu(NULL, &(grobo_imu){.roll_rad = 0}));
    REFUSES(grobo_robot_set_imu(&robot, NULL));
    REFUSES(grobo_robot_imu(NULL, &(grobo_imu){.roll_rad = 0}, NULL));
    REFUSES(grobo_robot_imu(&robot, NULL, NULL));
    assert_true(grobo_imu_tilt(NULL) == 0);
    REFUSES(grobo_sim_imu(NULL, &(grobo_imu){.roll_rad = 0}));
    REFUSES(grobo_robot_reset(NULL));
    REFUSES(grobo_robot_cancel(NULL));
    REFUSES(grobo_robot_play(NULL, &clip, &play_options));
    REFUSES(grobo_robot_play(&robot, NULL, &play_options));
    REFUSES(grobo_robot_enqueue(NULL, &clip, &play_options));
    REFUSES(grobo_robot_enqueue(&robot, NULL, &play_options));
    REFUSES(grobo_robot_pause(NULL));
    REFUSES(grobo_robot_resume(NULL));
    REFUSES(grobo_robot_stop(NULL, true));
    REFUSES(grobo_robot_seek(NULL, 0));
    REFUSES(grobo_robot_speed(NULL, 0));
    REFUSES(grobo_robot_free(NULL, 1, true));
    REFUSES(grobo_robot_joint(NULL, 1, &joint_info));
}

TEST(robot_refuses_null_in_its_third_functions)
{
    REFUSES(grobo_robot_joint(&robot, 1, NULL));
    REFUSES(grobo_robot_posture(NULL, 0, &posture));
    REFUSES(grobo_robot_posture(&robot, 0, NULL));
    REFUSES(grobo_robot_target(NULL, &posture));
    REFUSES(grobo_robot_target(&robot, NULL));
    assert_false(grobo_robot_moving(NULL));
    assert_false(grobo_robot_is_pending(NULL, 1));
    assert_false(grobo_bus_several(NULL, NULL));
    REFUSES(grobo_sim_set_id(NULL, 0, 1));
    assert_false(grobo_robot_settling(NULL));
    assert_int_equal(grobo_robot_job(NULL), GROBO_JOB_NONE);
    grobo_robot_tripped(NULL, &trip);
    grobo_robot_tripped(&robot, NULL);
    REFUSES(grobo_robot_fault(NULL, reals));
    REFUSES(grobo_robot_error_text(NULL, GROBO_ERR_ARG, text, sizeof text));
    REFUSES(grobo_robot_error_text(&robot, GROBO_ERR_ARG, NULL, sizeof text));
    assert_null(grobo_robot_get_counters(NULL));
    assert_null(grobo_robot_get_bus_stats(NULL));
    assert_int_equal(grobo_robot_play_state(NULL), GROBO_SEQUENCER_IDLE);
    assert_false(grobo_robot_is_playing(NULL));
    assert_false(grobo_robot_is_quiet(NULL));
    grobo_robot_progress(NULL, &progress);
    grobo_robot_progress(&robot, NULL);
    REFUSES(grobo_robot_budget(NULL, &budget));
    REFUSES(grobo_robot_budget(&robot, NULL));
    grobo_robot_jitter(NULL, &jitter);
    grobo_robot_jitter(&robot, NULL);
    assert_null(grobo_robot_driver(NULL));
}

TEST(robot_config_refuses_null)
{
    REFUSES(grobo_budget_init(NULL, driver, NULL, &bus_config));
    REFUSES(grobo_budget_init(&budget, NULL, NULL, &bus_config));
}

TEST(sequencer_refuses_null)
{
    grobo_sequencer_init(NULL, &grobo_i_gr001_model);
    REFUSES(grobo_sequencer_play(NULL, &clip, &play_options, &posture, 1000));
    REFUSES(grobo_sequencer_play(&seq, NULL, &play_options, &posture, 1000));
    REFUSES(grobo_sequencer_enqueue(NULL, &clip, &play_options));
    REFUSES(grobo_sequencer_enqueue(&seq, NULL, &play_options));
    REFUSES(grobo_sequencer_pause(NULL, 1000));
    REFUSES(grobo_sequencer_resume(NULL, 1000));
    REFUSES(grobo_sequencer_stop(NULL, true, 1000));
    REFUSES(grobo_sequencer_seek(NULL, 0, 1000));
    REFUSES(grobo_sequencer_set_speed(NULL, 0, 1000));
    REFUSES(grobo_sequencer_fail(NULL, 0));
    grobo_sequencer_reset(NULL);
    REFUSES(grobo_sequencer_next(NULL, 1000, &frame));
    REFUSES(grobo_sequencer_next(&seq, 1000, NULL));
    assert_true(grobo_sequencer_deadline(NULL) == GROBO_NEVER_US);
    assert_int_equal(grobo_sequencer_get_state(NULL), GROBO_SEQUENCER_IDLE);
    grobo_sequencer_progress(NULL, 1000, &progress);
    grobo_sequencer_progress(&seq, 1000, NULL);
    assert_null(grobo_sequencer_stats(NULL));
}

TEST(sim_refuses_null_in_its_first_functions)
{
    REFUSES(grobo_sim_fault_find(NULL, 4));
    REFUSES(grobo_sim_init_sized(&sim, sizeof sim - 1, NULL, 0));
    REFUSES(grobo_sim_init(NULL, &sim_config, 1000));
    assert_int_equal(grobo_sim_rx(NULL, bytes, 1, 1000), 0);
    assert_int_equal(grobo_sim_rx(&sim, NULL, 1, 1000), 0);
    assert_int_equal(grobo_sim_tx(NULL, bytes, sizeof bytes, 1000), 0);
    assert_int_equal(grobo_sim_tx(&sim, NULL, sizeof bytes, 1000), 0);
    grobo_sim_step(NULL, 1000);
    assert_true(grobo_sim_deadline(NULL) == GROBO_NEVER_US);
    assert_true(grobo_sim_packet_deadline(NULL) == GROBO_NEVER_US);
    assert_int_equal(grobo_sim_rx_room(NULL), 0);
    assert_false(grobo_sim_hung_up(NULL));
    grobo_sim_plug(NULL, true, 1000);
    REFUSES(grobo_sim_set_line_bps(NULL, 115200));
    REFUSES(grobo_sim_servos(NULL));
    REFUSES(grobo_sim_find(NULL, 1));
    REFUSES(grobo_sim_look(NULL, 0, &view));
}

TEST(sim_refuses_null_in_its_second_functions)
{
    REFUSES(grobo_sim_look(&sim, 0, NULL));
    REFUSES(grobo_sim_get_register(NULL, 0, 0, wides));
    REFUSES(grobo_sim_get_register(&sim, 0, 0, NULL));
    REFUSES(grobo_sim_set_register(NULL, 0, 0, 0));
    REFUSES(grobo_sim_get_flash(NULL, 0, bytes));
    REFUSES(grobo_sim_get_flash(&sim, 0, NULL));
    REFUSES(grobo_sim_set_flash(NULL, 0, bytes));
    REFUSES(grobo_sim_set_flash(&sim, 0, NULL));
    REFUSES(grobo_sim_set_angle(NULL, 0, 0, 1000));
    REFUSES(grobo_sim_set_blocked(NULL, 0, true));
    REFUSES(grobo_sim_set_load(NULL, 0, 0));
    REFUSES(grobo_sim_set_temperature(NULL, 0, 0));
    REFUSES(grobo_sim_set_cable(NULL, 0, 0));
    grobo_sim_set_supply(NULL, 0);
    REFUSES(grobo_sim_set_fault(NULL, 0, 0));
    REFUSES(grobo_sim_set_faults(NULL, text, 4));
    REFUSES(grobo_sim_set_faults(&sim, NULL, 4));
}

TEST(a_world_refuses_null)
{
    grobo_sim_physics *physics = NULL;
    grobo_sim_physics_view seen;
    grobo_sim_motor motor;
    const grobo_sim_physics_config config = {GROBO_SIM_PHYSICS_CONFIG_INIT,
                                             .model = &grobo_i_gr001_model};
    REFUSES(grobo_sim_motor_of(NULL, &motor));
    REFUSES(grobo_sim_motor_of(&grobo_i_rs30x_table.models[0], NULL));
    REFUSES(grobo_sim_physics_new(NULL, NULL, &physics));
    REFUSES(grobo_sim_physics_new(&config, NULL, NULL));
    REFUSES(grobo_sim_physics_look(NULL, 0, &seen));
    assert_int_equal(grobo_sim_physics_new(&config, NULL, &physics), GROBO_OK);
    REFUSES(grobo_sim_physics_look(physics, 0, NULL));
    grobo_sim_physics_free(physics);
    grobo_sim_physics_free(NULL);
    assert_int_equal(grobo_sim_physics_skipped(NULL), 0);
    REFUSES(grobo_sim_push(NULL, 0, 0));
    REFUSES(grobo_sim_set_payload(NULL, NULL, 0));
    REFUSES(grobo_sim_set_wall(NULL, 0, 0, 0));
    REFUSES(grobo_sim_set_supply_mohm(NULL, 0));
}

TEST(a_team_refuses_null)
{
    grobo_team *team = NULL;
    grobo_team_member member;
    const grobo_clip *one = &clip;
    const grobo_event event = {.kind = GROBO_EVENT_TRIP};
    REFUSES(grobo_team_new(NULL, NULL));
    assert_int_equal(grobo_team_new(NULL, &team), GROBO_OK);
    REFUSES(grobo_team_add(NULL, &robot));
    REFUSES(grobo_team_add(team, NULL));
    REFUSES(grobo_team_play(NULL, &one, true, &play_options, 0));
    REFUSES(grobo_team_play(team, NULL, true, &play_options, 0));
    REFUSES(grobo_team_start_at(NULL, 0, 0));
    REFUSES(grobo_team_pause(NULL));
    REFUSES(grobo_team_resume(NULL));
    REFUSES(grobo_team_stop(NULL, true));
    REFUSES(grobo_team_estop(NULL));
    REFUSES(grobo_team_get(NULL, 0, &member));
    REFUSES(grobo_team_get(team, 0, NULL));
    assert_int_equal(grobo_team_get_state(NULL), GROBO_TEAM_IDLE);
    assert_true(grobo_team_step(NULL, 0) == GROBO_NEVER_US);
    grobo_team_event(NULL, 0, &event);
    grobo_team_event(team, 0, NULL);
    grobo_team_free(NULL);
    grobo_team_free(team);
    REFUSES(grobo_robot_start_at(NULL, 0));
    REFUSES(grobo_sequencer_start_at(NULL, 0, 0));
    assert_false(grobo_sequencer_is_ready(NULL));
}

TEST(lines_refuse_null)
{
    static grobo_lines lines;
    static grobo_driver made = GROBO_TABLE_INIT(grobo_driver);
    REFUSES(grobo_lines_split(NULL, driver->model));
    REFUSES(grobo_lines_split(&lines, NULL));
    REFUSES(grobo_lines_driver_init(NULL, &lines, driver->model));
    REFUSES(grobo_lines_driver_init(&made, NULL, driver->model));
    REFUSES(grobo_lines_driver_init(&made, &lines, NULL));
    assert_null(grobo_driver_lines(NULL));
    REFUSES(grobo_robot_lines(NULL));
    grobo_robot_line_rx(NULL, 0, bytes, sizeof bytes, 0);
    grobo_robot_line_rx(&robot, 0, NULL, 1, 0);
    REFUSES(grobo_robot_line_tx(NULL, 0, bytes, sizeof bytes, 0));
    REFUSES(grobo_robot_line_tx(&robot, 0, NULL, 1, 0));
    grobo_robot_line_down(NULL, 0, 0);
    grobo_robot_line_up(NULL, 0, 0);
    REFUSES(grobo_robot_line_registers(NULL, 0, &io));
    REFUSES(grobo_robot_line_registers(&robot, 0, NULL));
    assert_null(grobo_robot_line_stats(NULL, 0));
}

TESTS_BETWEEN(set_up, tear_down)
