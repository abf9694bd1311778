/* SPDX-License-Identifier: MIT */
/* A robot on a loop: over the simulator in process, over a pty, over TCP; lost and back. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/robot.h>
#include <grobo/core/sim.h>
#include <grobo/robot_file.h>

#include "src/link/session/session.h"
#include "tests/support/counted_mem.h"
#include "tests/support/folder.h"
#include "tests/support/line.h"
#include "tests/support/loop.h"
#include "tests/support/session_kit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static void free_it(grobo_session *from)
{
    grobo_session_free(from);
    session = NULL;
}

static void free_it_then(const grobo_event *event)
{
    (void)event;
    seen.then_robot = NULL;
    free_it(session);
    event_base_loopbreak(base);
}

static void open_it(grobo_session *from)
{
    seen.then_line = NULL;
    assert_int_equal(grobo_session_open(from), GROBO_OK);
}

static int set_up(void)
{
    session_kit_begin();
    return 0;
}

static int tear_down(void)
{
    session_kit_end();
    return 0;
}

static const test_fixture on_loop[] = {{NULL, set_up, tear_down}};

static void come_up(void)
{
    int before = seen.ups;

    assert_int_equal(grobo_session_open(session), GROBO_OK);
    assert_int_equal(seen.ups, before);
    loop_run_until(base, &seen.ups, before + 1);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_UP);
}

/* Senses all joints, moves one, and finds it where it was sent. */
static void assert_it_works(void)
{
    const grobo_model *model = grobo_robot_driver(grobo_session_robot(session))->model;
    grobo_joint_mask all = GROBO_JOINTS_ALL(model->n_joints);
    grobo_posture target;
    grobo_posture now;
    uint64_t tx_bytes;
    uint64_t rx_bytes;
    double angle_deg;

    assert_int_equal(
        session_kit_await(grobo_robot_sense(grobo_session_robot(session), all, GROBO_SENSE_FULL)),
        GROBO_OK);
    assert_int_equal(grobo_robot_posture(grobo_session_robot(session), GROBO_NEVER_US, &now),
                     model->n_joints);
    assert_int_equal(grobo_posture_init(&target, model->n_joints), GROBO_OK);
    assert_int_equal(grobo_posture_set_deg(&target, 13, 5.0), GROBO_OK);
    target.time_us = 100000;
    assert_int_equal(session_kit_await(grobo_robot_move(grobo_session_robot(session), &target)),
                     GROBO_OK);
    assert_int_equal(
        session_kit_await(grobo_robot_sense(grobo_session_robot(session), all, GROBO_SENSE_FULL)),
        GROBO_OK);
    grobo_robot_posture(grobo_session_robot(session), GROBO_NEVER_US, &now);
    assert_int_equal(grobo_posture_get_deg(&now, 13, &angle_deg), GROBO_OK);
    assert_true(angle_deg > 4.89 && angle_deg < 5.11);
    grobo_session_bytes(session, &tx_bytes, &rx_bytes);
    assert_int_equal(tx_bytes, seen.tapped[GROBO_DIR_TX]);
    assert_int_equal(rx_bytes, seen.tapped[GROBO_DIR_RX]);
    assert_true(rx_bytes >= 2 * 20 * 26);
}

/* ---- lines that work ---------------------------------------------------------------------- */

TEST_WITH(on_loop, a_simulator_in_the_process)
{
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim"});
    assert_null(grobo_session_sim(session));
    come_up();
    assert_non_null(grobo_session_sim(session));
    assert_string_equal(grobo_session_device(session), "sim");
    const grobo_driver *driver = grobo_robot_driver(grobo_session_robot(session));
    assert_ptr_equal(driver, grobo_gr001_driver(GROBO_WIRING_BOARD));
    assert_int_equal(grobo_driver_wiring(driver), GROBO_WIRING_BOARD);
    assert_string_equal(driver->name, "GR001");
    assert_int_equal(grobo_session_open(session), GROBO_ERR_STATE);
    assert_it_works();
    /* A reply comes in one piece, or in two where the engine has looked meanwhile. */
    assert_true(seen.taps[GROBO_DIR_RX] <= seen.tapped[GROBO_DIR_RX] / 13);
}

TEST_WITH(on_loop, a_simulator_keeps_its_state_while_closed)
{
    grobo_sim_view view;

    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim"});
    come_up();
    assert_int_equal(session_kit_await(grobo_robot_torque(grobo_session_robot(session),
                                                          GROBO_JOINT_BIT(3), GROBO_TORQUE_ON)),
                     GROBO_OK);
    grobo_session_close(session);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_CLOSED);
    come_up();
    assert_int_equal(grobo_sim_look(grobo_session_sim(session), 3, &view), 0);
    assert_int_equal(view.torque, GROBO_TORQUE_ON);
}

/* Of a machine that is busy a reply may be late by any time: none is lost. */
static const grobo_robot_config patient = {GROBO_ROBOT_CONFIG_INIT, .timeout_us = 5000000};

TEST_WITH(on_loop, a_pseudo_terminal)
{
    grobo_sim_server *server =
        loop_serve(base, (grobo_sim_server_config){GROBO_SIM_SERVER_CONFIG_INIT});

    session_kit_make((grobo_session_config){
        GROBO_SESSION_CONFIG_INIT, .device = grobo_sim_server_device(server), .robot = &patient});
    come_up();
    assert_string_equal(grobo_session_device(session), grobo_sim_server_device(server));
    assert_it_works();
    grobo_sim_server_free(server);
}

TEST_WITH(on_loop, a_connection)
{
    grobo_sim_server *server =
        loop_serve(base, (grobo_sim_server_config){GROBO_SIM_SERVER_CONFIG_INIT, .no_pty = true,
                                                   .tcp = "tcp:127.0.0.1:0"});

    session_kit_make((grobo_session_config){
        GROBO_SESSION_CONFIG_INIT, .device = grobo_sim_server_device(server), .robot = &patient});
    come_up();
    assert_it_works();
    grobo_sim_server_free(server);
}

TEST_WITH(on_loop, auto_takes_the_first_port_that_answers)
{
    grobo_sim_server *server =
        loop_serve(base, (grobo_sim_server_config){GROBO_SIM_SERVER_CONFIG_INIT});
    grobo_sim_server *another =
        loop_serve(base, (grobo_sim_server_config){GROBO_SIM_SERVER_CONFIG_INIT});
    test_line silent;
    const char *scan[5] = {"/dev/no-such-port", NULL, NULL, NULL, NULL};

    test_line_open(&silent);
    scan[1] = silent.device;
    scan[2] = grobo_sim_server_device(server);
    scan[3] = grobo_sim_server_device(another);
    session_kit_make(
        (grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "auto", .scan = scan});
    come_up();
    assert_string_equal(grobo_session_device(session), grobo_sim_server_device(server));
    assert_it_works();
    grobo_session_close(session);
    come_up();
    assert_string_equal(grobo_session_device(session), grobo_sim_server_device(server));
    test_line_close(&silent);
    grobo_sim_server_free(another);
    grobo_sim_server_free(server);
}

/* ---- lines that do not -------------------------------------------------------------------- */

TEST_WITH(on_loop, what_cannot_be_opened_is_told_at_once)
{
    const char *none[1] = {NULL};

    session_kit_make(
        (grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "/dev/no-such-port"});
    assert_int_equal(grobo_session_open(session), GROBO_ERR_NOENT);
    assert_true(strlen(grobo_session_cause(session)->text) > 0);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_CLOSED);
    grobo_session_free(session);
    session_kit_make(
        (grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "auto", .scan = none});
    assert_int_equal(grobo_session_open(session), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_CLOSED);
    assert_true(loop_run(base, 10000));
    assert_int_equal(seen.fails, 0);
}

TEST_WITH(on_loop, nobody_answers)
{
    test_line silent;
    int64_t start_us = grobo_now_us();
    const char *scan[2] = {silent.device, NULL};

    test_line_open(&silent);
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = silent.device,
                                            .reconnect = true});
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.fails, 1);
    assert_int_equal(seen.error, GROBO_ERR_TIMEOUT);
    assert_string_equal(grobo_session_cause(session)->text, "no answer to the check");
    assert_true(grobo_now_us() - start_us < 2000000);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_CLOSED);
    assert_int_equal(seen.robot, 0);
    grobo_session_free(session);

    session_kit_make(
        (grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "auto", .scan = scan});
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.fails, 2);
    assert_int_equal(seen.error, GROBO_ERR_NOTFOUND);
    assert_string_equal(grobo_session_cause(session)->text, "no robot on any of 1 serial ports");
    assert_int_equal(seen.ups + seen.losts, 0);
    test_line_close(&silent);
}

TEST_WITH(on_loop, only_the_check_is_sent_before_somebody_answers)
{
    test_line silent;
    uint8_t bytes[256];
    size_t size;

    test_line_open(&silent);
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = silent.device});
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.fails, 1);
    size = test_line_read_some(&silent, bytes, sizeof bytes);
    assert_true(size >= 2 && size % 2 == 0);
    for (size_t i = 0; i < size; i += 2) {
        assert_int_equal(bytes[i], 0x41);
        assert_int_equal(bytes[i + 1], 0x00);
    }
    test_line_close(&silent);
}

TEST_WITH(on_loop, nobody_needs_to_answer_if_so_configured)
{
    test_line silent;

    test_line_open(&silent);
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = silent.device,
                                            .skip_check = true});
    come_up();
    test_line_close(&silent);
    loop_run_until(base, &seen.losts, 1);
    assert_int_equal(seen.error, GROBO_ERR_UNPLUGGED);
}

TEST_WITH(on_loop, requests_need_a_robot)
{
    grobo_trip_info trip;

    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim"});
    assert_int_equal(grobo_robot_check(grobo_session_robot(session)), GROBO_ERR_CLOSED);
    assert_int_equal(grobo_robot_sense(grobo_session_robot(session), 1, GROBO_SENSE_FULL),
                     GROBO_ERR_CLOSED);
    assert_int_equal(grobo_robot_exit(grobo_session_robot(session), GROBO_EXIT_HOLD),
                     GROBO_ERR_CLOSED);
    /* A stop is latched all the same. */
    assert_int_equal(grobo_robot_estop(grobo_session_robot(session)), GROBO_ERR_CLOSED);
    grobo_robot_tripped(grobo_session_robot(session), &trip);
    assert_int_equal(trip.trip, GROBO_TRIP_ESTOP);
    come_up();
    assert_int_equal(grobo_robot_torque(grobo_session_robot(session), 1, GROBO_TORQUE_ON),
                     GROBO_ERR_LATCHED);
    assert_int_equal(grobo_robot_reset(grobo_session_robot(session)), GROBO_OK);
    assert_int_equal(
        session_kit_await(grobo_robot_torque(grobo_session_robot(session), 1, GROBO_TORQUE_ON)),
        GROBO_OK);
}

/* ---- lost and back ------------------------------------------------------------------------ */

TEST_WITH(on_loop, a_lost_port_is_found_again)
{
    const char *link;
    grobo_sim_server *server;
    int sense;

    (void)folder_set_up();
    link = in_folder("gr001");
    server =
        loop_serve(base, (grobo_sim_server_config){GROBO_SIM_SERVER_CONFIG_INIT, .link = link});
    session_kit_make(
        (grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = link, .reconnect = true});
    come_up();
    assert_int_equal(
        session_kit_await(grobo_robot_torque(grobo_session_robot(session), 1, GROBO_TORQUE_ON)),
        GROBO_OK);

    /* A job that runs ends with the line. */
    sense = grobo_robot_sense(grobo_session_robot(session), 0xfffff, GROBO_SENSE_FULL);
    assert_int_equal(grobo_sim_server_plug(server, false), GROBO_OK);
    assert_int_equal(session_kit_await(sense), GROBO_ERR_UNPLUGGED);
    loop_run_until(base, &seen.losts, 1);
    assert_int_equal(seen.error, GROBO_ERR_UNPLUGGED);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_WAITING);
    assert_int_equal(grobo_robot_check(grobo_session_robot(session)), GROBO_ERR_CLOSED);

    assert_int_equal(grobo_sim_server_plug(server, true), GROBO_OK);
    loop_run_until(base, &seen.ups, 2);
    assert_int_equal(seen.losts, 1);
    assert_int_equal(seen.fails, 0);
    assert_it_works();
    grobo_sim_server_free(server);
    folder_remove(NULL, 0);
}

TEST_WITH(on_loop, a_simulator_that_hung_up_is_plugged_in_again)
{
    session_kit_make(
        (grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim", .reconnect = true});
    come_up();
    grobo_sim_plug(grobo_session_sim(session), false, grobo_now_us());
    /* The engine finds out when it next looks. */
    assert_true(grobo_robot_sense(grobo_session_robot(session), 1, GROBO_SENSE_FULL) > 0);
    loop_run_until(base, &seen.losts, 1);
    loop_run_until(base, &seen.ups, 2);
    assert_it_works();
}

static grobo_torque torque_of(int servo)
{
    grobo_sim_view view;

    assert_int_equal(grobo_sim_look(grobo_session_sim(session), servo, &view), 0);
    return view.torque;
}

/* Whatever the session was about when a person stopped the robot. */
TEST_WITH(on_loop, an_emergency_stop_reaches_a_robot_that_is_lost_or_just_found)
{
    session_kit_make(
        (grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim", .reconnect = true});
    come_up();
    assert_int_equal(session_kit_await(grobo_robot_torque(grobo_session_robot(session),
                                                          GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON)),
                     GROBO_OK);
    grobo_sim_plug(grobo_session_sim(session), false, grobo_now_us());
    assert_true(grobo_robot_sense(grobo_session_robot(session), 1, GROBO_SENSE_FULL) > 0);
    loop_run_until(base, &seen.losts, 1);
    assert_int_equal(grobo_robot_estop(grobo_session_robot(session)), GROBO_ERR_CLOSED);
    loop_run_until(base, &seen.ups, 2);
    assert_int_equal(torque_of(0), GROBO_TORQUE_BRAKE);
    assert_int_equal(torque_of(19), GROBO_TORQUE_BRAKE);
    assert_int_equal(grobo_robot_reset(grobo_session_robot(session)), GROBO_OK);

    assert_int_equal(session_kit_await(grobo_robot_torque(grobo_session_robot(session),
                                                          GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON)),
                     GROBO_OK);
    grobo_session_close(session);
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    while (grobo_session_get_state(session) != GROBO_SESSION_CHECKING) {
        assert_int_equal(event_base_loop(base, EVLOOP_ONCE), 0);
    }
    assert_int_equal(session_kit_await(grobo_robot_estop(grobo_session_robot(session))), GROBO_OK);
    loop_run_until(base, &seen.ups, 3); /* who is there was asked afterwards */
    assert_int_equal(torque_of(0), GROBO_TORQUE_BRAKE);
    assert_int_equal(torque_of(19), GROBO_TORQUE_BRAKE);
    assert_int_equal(seen.fails, 0);
}

static size_t asked_till_up;

static void note_asked(grobo_session *from)
{
    (void)from;
    asked_till_up = seen.taps[GROBO_DIR_TX];
}

/* Until the robot has answered nothing is asked but who it is, whatever is configured meanwhile; a
 * configuration that is refused changes nothing. */
TEST_WITH(on_loop, who_is_checked_is_not_read)
{
    static const grobo_robot_config brisk = {GROBO_ROBOT_CONFIG_INIT};
    static const grobo_robot_config eager = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 1};
    static const grobo_robot_config bad = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = -2};
    const grobo_robot_def *const *arm = grobo_i_robot_defs;
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_robot_sim sim;

    while (strcmp((*arm)->name, "so101") != 0) {
        arm++;
    }
    assert_int_equal(grobo_robot_def_driver(*arm, GROBO_WIRING_BUS, &driver), GROBO_OK);
    assert_int_equal(grobo_robot_def_sim(*arm, GROBO_WIRING_BUS, &sim), GROBO_OK);
    size_t asked[2];
    for (int configures = 0; configures < 2; configures++) {
        session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim",
                                                .driver = &driver, .sim = &sim.config,
                                                .robot = &brisk});
        seen.then_line = note_asked;
        assert_int_equal(grobo_session_open(session), GROBO_OK);
        for (int j = 0; j + 1 < driver.model->n_joints; j++) { /* one after the other is asked */
            assert_int_equal(
                grobo_sim_set_cable(grobo_session_sim(session), j, GROBO_SIM_CABLE_MUTE), GROBO_OK);
        }
        while (grobo_session_get_state(session) != GROBO_SESSION_CHECKING) {
            assert_int_equal(event_base_loop(base, EVLOOP_ONCE), 0);
        }
        if (configures) {
            assert_int_equal(grobo_session_configure(session, &eager), GROBO_OK);
            assert_int_equal(grobo_session_configure(session, &bad), GROBO_ERR_ARG);
        }
        while (grobo_session_get_state(session) == GROBO_SESSION_CHECKING) {
            assert_true(grobo_bus_pending(&session->robot.bus) <= 1); /* nor waits a reading */
            assert_int_equal(event_base_loop(base, EVLOOP_ONCE), 0);
        }
        assert_int_equal(seen.ups, 1 + configures);
        asked[configures] = asked_till_up;
        loop_run_for(base, 50000);
        assert_true(seen.taps[GROBO_DIR_TX] > asked_till_up); /* now it is read */
        grobo_session_free(session);
        seen.taps[GROBO_DIR_TX] = 0;
    }
    session = NULL;
    assert_true(asked[0] > 5);
    assert_int_equal(asked[1], asked[0]);
}

TEST_WITH(on_loop, without_reconnect_a_lost_port_is_closed)
{
    grobo_sim_server *server =
        loop_serve(base, (grobo_sim_server_config){GROBO_SIM_SERVER_CONFIG_INIT});

    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT,
                                            .device = grobo_sim_server_device(server)});
    come_up();
    assert_int_equal(grobo_sim_server_plug(server, false), GROBO_OK);
    loop_run_until(base, &seen.losts, 1);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_CLOSED);
    assert_true(loop_run(base, 150000));
    assert_int_equal(seen.ups, 1);
    grobo_sim_server_free(server);
}

/* ---- inside callbacks --------------------------------------------------------------------- */

TEST_WITH(on_loop, it_may_be_freed_in_its_event)
{
    counted_mem counter = {0};
    const grobo_mem mem = counted_mem_of(&counter);

    session_kit_make(
        (grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim", .mem = &mem});
    seen.then_line = free_it;
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.ups, 1);
    assert_null(session);
    assert_true(loop_run(base, 10000));
    assert_int_equal(counter.bytes, 0);
}

TEST_WITH(on_loop, it_may_be_freed_in_an_event_of_the_engine)
{
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim"});
    come_up();
    seen.then_robot = free_it_then;
    assert_true(grobo_robot_sense(grobo_session_robot(session), 3, GROBO_SENSE_FULL) > 0);
    assert_false(loop_run(base, 5000000));
    assert_null(session);
    assert_int_equal(seen.robot, 1);
}

TEST_WITH(on_loop, it_may_be_closed_in_its_event)
{
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim"});
    seen.then_line = grobo_session_close;
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &seen.ups, 1);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_CLOSED);
    assert_true(loop_run(base, 10000));
    seen.then_line = NULL;
    come_up();
}

TEST_WITH(on_loop, it_may_be_opened_again_when_lost)
{
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = "sim"});
    come_up();
    seen.then_line = open_it;
    grobo_sim_plug(grobo_session_sim(session), false, grobo_now_us());
    assert_true(grobo_robot_check(grobo_session_robot(session)) > 0);
    loop_run_until(base, &seen.losts, 1);
    loop_run_until(base, &seen.ups, 2);
    assert_it_works();
}

/* ---- refusals ----------------------------------------------------------------------------- */

TEST_WITH(on_loop, bad_configurations_and_lack_of_memory)
{
    counted_mem counter;
    const grobo_mem mem = counted_mem_of(&counter);
    static const grobo_robot_config bad_robot = {GROBO_ROBOT_CONFIG_INIT, .speed_limit_pct = 200};
    grobo_session_config config = {GROBO_SESSION_CONFIG_INIT, .base = base, .device = "sim",
                                   .mem = &mem};
    grobo_session *made = NULL;
    size_t failures = 0;
    int r = GROBO_ERR_NOMEM;

    while (r == GROBO_ERR_NOMEM) {
        counter = (counted_mem){.fail_at = ++failures};
        r = grobo_session_new(&config, &made);
        if (r >= 0) {
            r = grobo_session_open(made);
            grobo_session_free(made);
            made = NULL;
        }
        assert_null(made);
        assert_int_equal(counter.bytes, 0);
    }
    assert_int_equal(r, GROBO_OK);
    assert_int_equal(failures, 6);

    counter.fail_at = 0;
    config.robot = &bad_robot;
    assert_int_equal(grobo_session_new(&config, &made), GROBO_ERR_ARG);
    config.robot = NULL;
    config.base = NULL;
    assert_int_equal(grobo_session_new(&config, &made), GROBO_ERR_ARG);
    config.base = base;
    config.device = NULL;
    assert_int_equal(grobo_session_new(&config, &made), GROBO_ERR_ARG);
    assert_int_equal(grobo_session_new(NULL, &made), GROBO_ERR_ARG);
    assert_int_equal(counter.bytes, 0);
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = GROBO_DEVICE_SIM});
    assert_int_equal(grobo_session_configure(session, &bad_robot), GROBO_ERR_ARG);
    assert_int_equal(grobo_session_configure(session, NULL), GROBO_OK);
    assert_int_equal(grobo_session_set_device(session, NULL), GROBO_ERR_ARG);
    assert_string_equal(grobo_session_device(session), GROBO_DEVICE_SIM);
}
