/* SPDX-License-Identifier: MIT */
/*
 * A port that goes and comes back: told at once, waited for without work, found again, and nothing
 * moves because of it. In real time: of several hang-ups most must keep their bound, as any one may
 * meet a busy machine.
 */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <event2/event.h>

#include <grobo/core/robot.h>

#include "tests/support/folder.h"
#include "tests/support/loop.h"
#include "tests/support/os.h"
#include "tests/support/session_kit.h"
#include "tests/support/test.h"

enum { NECK = 13, HANG_UPS = 9, MOST = 5, IDLE_US = 2000000 };

static grobo_sim_server *server;

/* What the engine said of motions and of readings. */
static int play_error, rounds;

/* What the servos heard. */
static struct {
    int reads, writes;
} heard;

static void on_robot(const grobo_event *event)
{
    if (event->kind == GROBO_EVENT_PLAY) {
        play_error = event->u.play.error;
    } else if (event->kind == GROBO_EVENT_ROUND) {
        rounds++;
        event_base_loopbreak(base);
    }
}

static void on_sim(void *ctx, const grobo_sim_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_SIM_PACKET) {
        bool reads = event->bytes[2] != 0 && event->bytes[6] == 0;
        heard.reads += reads;
        heard.writes += !reads;
    }
}

/* ---- set-up ------------------------------------------------------------------------------- */

static int set_up(void)
{
    static const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 300000,
                                             .timeout_us = 300000, .stall_us = 30000000};
    grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .hook = on_sim};
    const char *link;

    (void)folder_set_up();
    link = in_folder("gr001");
    memset(&heard, 0, sizeof heard);
    rounds = 0;
    play_error = 0;
    session_kit_begin();
    seen.then_robot = on_robot;
    server = loop_serve(base, (grobo_sim_server_config){GROBO_SIM_SERVER_CONFIG_INIT, .sim = &sim,
                                                        .link = link, .replug_ms = -1});
    session_kit_make((grobo_session_config){GROBO_SESSION_CONFIG_INIT, .device = link,
                                            .reconnect = true, .robot = &robot});
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    return 0;
}

static int tear_down(void)
{
    grobo_sim_server_free(server);
    session_kit_end();
    folder_remove(NULL, 0);
    return 0;
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

static void unplug(void)
{
    int before = seen.losts;

    assert_int_equal(grobo_sim_server_plug(server, false), GROBO_OK);
    loop_run_until(base, &seen.losts, before + 1);
    assert_int_equal(seen.error, GROBO_ERR_UNPLUGGED);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_WAITING);
}

static void plug(void)
{
    int before = seen.ups;

    assert_int_equal(grobo_sim_server_plug(server, true), GROBO_OK);
    loop_run_until(base, &seen.ups, before + 1);
    assert_int_equal(grobo_session_get_state(session), GROBO_SESSION_UP);
}

static grobo_sim_view look(int servo)
{
    grobo_sim_view view;

    assert_int_equal(grobo_sim_look(grobo_sim_server_sim(server), servo, &view), 0);
    return view;
}

/* ---- tests -------------------------------------------------------------------------------- */

TEST_WITH(fixture, a_lost_port_is_told_within_10_ms_and_found_within_250)
{
    int told = 0;
    int found = 0;

    loop_run_until(base, &seen.ups, 1);
    for (int i = 0; i < HANG_UPS; i++) {
        int64_t from_us = grobo_now_us();
        unplug();
        told += seen.at_us - from_us <= 10000;
        assert_int_equal(grobo_robot_check(grobo_session_robot(session)), GROBO_ERR_CLOSED);
        loop_run_for(base, 20000 * i); /* at any moment between two attempts */
        from_us = grobo_now_us();
        plug();
        found += seen.at_us - from_us <= 250000;
    }
    assert_true(told >= MOST);
    assert_true(found >= MOST);
    assert_int_equal(seen.losts, HANG_UPS);
    assert_int_equal(seen.fails, 0);
}

TEST_WITH(fixture, waiting_for_a_port_takes_less_than_a_hundredth)
{
    int64_t cpu_us;

    loop_run_until(base, &seen.ups, 1);
    unplug();
    loop_run_for(base, 500000); /* the first attempts follow each other fast */
    cpu_us = test_cpu_us();
    loop_run_for(base, IDLE_US);
    cpu_us = test_cpu_us() - cpu_us;
    print_message("# %d us of processor time in %d us\n", (int)cpu_us, IDLE_US);
    assert_true(cpu_us < IDLE_US / 100);
    assert_int_equal(seen.losts, 1);
    plug();
}

/* The servos finish what they were told last; from the line's return on they hear reads alone. */
static void expect_stillness(void)
{
    grobo_sim_view before;
    int before_rounds;

    memset(&heard, 0, sizeof heard);
    plug();
    loop_run_for(base, 700000);
    before = look(NECK);
    before_rounds = rounds;
    loop_run_until(base, &rounds, before_rounds + 2);
    assert_int_equal(heard.writes, 0);
    assert_true(heard.reads >= 40);
    assert_int_equal(look(NECK).angle_mdeg, before.angle_mdeg);
    assert_int_equal(look(NECK).torque, GROBO_TORQUE_ON);
}

static grobo_posture neck(double angle_deg, int64_t time_us)
{
    grobo_posture target;

    assert_int_equal(grobo_posture_init(&target, 20), GROBO_OK);
    assert_int_equal(grobo_posture_set_deg(&target, NECK, angle_deg), GROBO_OK);
    target.time_us = time_us;
    return target;
}

TEST_WITH(fixture, nothing_moves_by_itself_after_a_move_was_cut)
{
    grobo_posture target = neck(30, 500000);
    int move;

    loop_run_until(base, &seen.ups, 1);
    assert_int_equal(session_kit_await(grobo_robot_torque(grobo_session_robot(session),
                                                          GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON)),
                     GROBO_OK);
    move = grobo_robot_move(grobo_session_robot(session), &target);
    loop_run_for(base, 200000);
    unplug();
    assert_int_equal(session_kit_await(move), GROBO_ERR_UNPLUGGED);
    expect_stillness();
    /* Asked, it moves. */
    target = neck(-10, 100000);
    assert_int_equal(session_kit_await(grobo_robot_move(grobo_session_robot(session), &target)),
                     GROBO_OK);
    assert_true(heard.writes > 0);
    assert_in_range(look(NECK).angle_mdeg + 20000, 9900, 10100);
}

/* ---- a motion ----------------------------------------------------------------------------- */

static int nod_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    *posture = neck(i % 2 == 0 ? 20 : -20, 200000);
    *at_us = (int64_t)i * 200000;
    return 0;
}

TEST_WITH(fixture, nothing_moves_by_itself_after_a_motion_was_cut)
{
    const grobo_clip nod = {
        .key = nod_key, .n_keys = 100, .n_joints = 20, .length_us = 100 * 200000LL};

    loop_run_until(base, &seen.ups, 1);
    assert_int_equal(session_kit_await(grobo_robot_play(grobo_session_robot(session), &nod, NULL)),
                     GROBO_OK);
    loop_run_for(base, 1000000);
    unplug();
    assert_int_equal(play_error, GROBO_ERR_UNPLUGGED);
    expect_stillness();
    assert_int_equal(session_kit_await(grobo_robot_play(grobo_session_robot(session), &nod, NULL)),
                     GROBO_OK);
}
