/* SPDX-License-Identifier: MIT */
/* Structures with a size: shorter ones of older programs, longer ones of newer, and nonsense. */
#include <stdint.h>
#include <string.h>

#include <event2/event.h>

#include <grobo/core/body_motion.h>
#include <grobo/core/loop.h>
#include <grobo/core/motion_io.h>
#include <grobo/core/robot.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/core/team.h>
#include <grobo/core/virtual.h>
#include <grobo/grobo.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

/* What takes a structure; each returns GROBO_OK and frees what it made. */
static grobo_robot engine;
static grobo_sim sim;
static struct event_base *base;

static int make_robot(const void *config)
{
    return grobo_robot_init(&engine, grobo_gr001_driver(GROBO_WIRING_BOARD), NULL, config, 0);
}

static int configure(const void *config)
{
    return grobo_robot_configure(&engine, config);
}

static int make_sim(const void *config)
{
    return grobo_sim_init(&sim, config, 0);
}

static int make_serial(const void *config)
{
    grobo_serial *made = NULL;
    int r = grobo_serial_new(config, &made);
    grobo_serial_free(made);
    return r;
}

static int make_session(const void *config)
{
    grobo_session *made = NULL;
    int r = grobo_session_new(config, &made);
    grobo_session_free(made);
    return r;
}

static int make_virtual(const void *config)
{
    grobo_virtual *made = NULL;
    int r = grobo_virtual_new(config, &made);
    grobo_virtual_free(made);
    return r;
}

static int make_runner(const void *config)
{
    grobo_runner *made = NULL;
    int r = grobo_runner_new(config, &made);
    (void)grobo_runner_free(made);
    return r;
}

static int make_server(const void *config)
{
    grobo_sim_server *made = NULL;
    grobo_os_cause cause;
    int r = grobo_sim_server_new(config, &made, &cause);
    grobo_sim_server_free(made);
    return r;
}

static int with_robot(const void *config)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .base = base,
                                          .device = GROBO_DEVICE_SIM, .robot = config};
    return make_session(&session);
}

static int with_sim(const void *config)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .base = base,
                                          .device = GROBO_DEVICE_SIM, .sim = config};
    return make_session(&session);
}

/* There is no such program, which is found out when the structure was taken. */
static int start_guard(const void *config)
{
    grobo_guard *made = NULL;
    int r = grobo_guard_new(config, &made);
    grobo_guard_free(made);
    return r == GROBO_ERR_NOENT || r == GROBO_ERR_UNSUPPORTED ? GROBO_OK : r;
}

/* Of what fails for another reason, behind the structure. */
static int taken(int result)
{
    return result == GROBO_ERR_ARG ? result : GROBO_OK;
}

static grobo_motion *keys;
static grobo_body *body;
static grobo_runner *runner_of;

static int clip_of(const void *options)
{
    grobo_clip clip = {0};
    int r = grobo_motion_clip(keys, options, &clip);
    grobo_motion_clip_free(&clip);
    return r;
}

static int play(const void *options)
{
    grobo_clip clip;
    assert_int_equal(grobo_motion_clip(keys, NULL, &clip), GROBO_OK);
    int r = grobo_robot_play(&engine, &clip, options);
    grobo_motion_clip_free(&clip);
    return taken(r);
}

static int enqueue(const void *options)
{
    grobo_clip clip;
    assert_int_equal(grobo_motion_clip(keys, NULL, &clip), GROBO_OK);
    int r = grobo_robot_enqueue(&engine, &clip, options);
    grobo_motion_clip_free(&clip);
    return taken(r);
}

static int play_motion(const void *options)
{
    return taken(grobo_runner_play_motion(runner_of, options));
}

static int play_team(const void *options)
{
    const grobo_team_config config = {GROBO_TEAM_CONFIG_INIT};
    const grobo_clip *clips[1] = {NULL};
    grobo_team *team = NULL;
    assert_int_equal(grobo_team_new(&config, &team), GROBO_OK);
    int r = grobo_team_play(team, clips, false, options, 0);
    grobo_team_free(team);
    return taken(r);
}

static int read_text(const void *options)
{
    grobo_motion *made = NULL;
    int r = grobo_motion_read_memory("", 0, options, NULL, &made);
    grobo_motion_free(made);
    return taken(r);
}

static int read_file(const void *options)
{
    grobo_motion *made = NULL;
    return taken(grobo_motion_read_file("/nowhere/walk.m", options, NULL, &made));
}

static int look_through(const void *options)
{
    return taken(grobo_motion_check(keys, &grobo_i_gr001_model, options, NULL));
}

static int convert(const void *options)
{
    grobo_motion *made = NULL;
    int r = grobo_motion_convert(keys, GROBO_MOTION_POSTURES, options, NULL, &made);
    grobo_motion_free(made);
    return r;
}

static int swallow(void *ctx, const void *data, size_t size)
{
    (void)ctx, (void)data, (void)size;
    return GROBO_OK;
}

static int write_out(const void *options)
{
    const grobo_sink sink = {swallow, NULL};
    return grobo_motion_write(keys, GROBO_FORMAT_AUTO, options, &sink, NULL);
}

static int save(const void *options)
{
    return taken(grobo_motion_save(keys, grobo_files_os(), "/nowhere/walk.m", options, NULL));
}

static int verify(const void *options)
{
    return grobo_motion_verify(keys, keys, options, NULL);
}

static int make_body(const void *options)
{
    grobo_body *made = NULL;
    int r = grobo_body_new(&grobo_i_gr001_body, keys, options, NULL, &made);
    grobo_body_free(made);
    return r;
}

static int check_body(const void *options)
{
    return taken(grobo_body_check(body, options));
}

static const grobo_session_config good_session = {GROBO_SESSION_CONFIG_INIT,
                                                  .device = GROBO_DEVICE_SIM};

static int for_each(void (*look)(int (*take)(const void *config), const void *good, size_t bytes))
{
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT};
    const grobo_sim_config of_sim = {GROBO_SIM_CONFIG_INIT};
    const grobo_serial_config serial = {GROBO_SERIAL_CONFIG_INIT};
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .base = base,
                                          .device = GROBO_DEVICE_SIM};
    const grobo_runner_config runner = {GROBO_RUNNER_CONFIG_INIT, .session = &good_session};
    const grobo_sim_server_config server = {GROBO_SIM_SERVER_CONFIG_INIT, .base = base,
                                            .no_pty = true, .tcp = "tcp:127.0.0.1:0"};
    const grobo_guard_config guard = {GROBO_GUARD_CONFIG_INIT, .program = "/nowhere/guard"};

    const grobo_clip_options clip = {GROBO_CLIP_OPTIONS_INIT};
    const grobo_play_options playing = {GROBO_PLAY_OPTIONS_INIT};
    const grobo_read_options reading = {GROBO_READ_OPTIONS_INIT};
    const grobo_check_options checking = {GROBO_CHECK_OPTIONS_INIT};
    const grobo_write_options writing = {GROBO_WRITE_OPTIONS_INIT};
    const grobo_body_options solving = {GROBO_BODY_OPTIONS_INIT};
    const grobo_body_check_options balance = {GROBO_BODY_CHECK_OPTIONS_INIT};

    const grobo_virtual_config unreal = {GROBO_VIRTUAL_CONFIG_INIT};

    look(make_virtual, &unreal, sizeof unreal);
    look(make_robot, &robot, sizeof robot);
    look(configure, &robot, sizeof robot);
    look(make_sim, &of_sim, sizeof of_sim);
    look(make_serial, &serial, sizeof serial);
    look(make_session, &session, sizeof session);
    look(with_robot, &robot, sizeof robot);
    look(with_sim, &of_sim, sizeof of_sim);
    look(make_runner, &runner, sizeof runner);
    look(make_server, &server, sizeof server);
    look(start_guard, &guard, sizeof guard);
    look(clip_of, &clip, sizeof clip);
    look(play, &playing, sizeof playing);
    look(enqueue, &playing, sizeof playing);
    look(play_motion, &playing, sizeof playing);
    look(play_team, &playing, sizeof playing);
    look(read_text, &reading, sizeof reading);
    look(read_file, &reading, sizeof reading);
    look(look_through, &checking, sizeof checking);
    look(convert, &writing, sizeof writing);
    look(write_out, &writing, sizeof writing);
    look(save, &writing, sizeof writing);
    look(verify, &writing, sizeof writing);
    look(make_body, &solving, sizeof solving);
    look(check_body, &balance, sizeof balance);
    return 25;
}

/* Room for a structure that is longer than today's. */
static union {
    size_t size;
    int64_t aligned;
    uint8_t bytes[4096];
} own;

static void put(const void *good, size_t bytes, size_t size)
{
    memset(&own, 0, sizeof own);
    memcpy(&own, good, bytes);
    own.size = size;
}

static void look_at_nonsense(int (*take)(const void *config), const void *good, size_t bytes)
{
    static const size_t sizes[] = {0, 1, sizeof(size_t), SIZE_MAX, SIZE_MAX / 2, 1u << 20};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        put(good, bytes, sizes[i]);
        assert_int_equal(take(&own), GROBO_ERR_ARG);
    }
    put(good, bytes, bytes);
    assert_int_equal(take(&own), GROBO_OK);
}

TEST(nonsense_is_refused)
{
    assert_int_equal(for_each(look_at_nonsense), 25);
}

static void look_at_longer(int (*take)(const void *config), const void *good, size_t bytes)
{
    put(good, bytes, bytes + 64);
    assert_int_equal(take(&own), GROBO_OK);
    own.bytes[bytes + 63] = 1;
    assert_int_equal(take(&own), GROBO_ERR_ARG);
    own.size = bytes + 63;
    assert_int_equal(take(&own), GROBO_OK);
}

TEST(what_a_newer_program_sets_is_refused)
{
    assert_int_equal(for_each(look_at_longer), 25);
}

/* What is behind a shorter structure is not looked at. */
TEST(fields_that_an_older_program_lacks_are_zero)
{
    grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT, .speed_limit_pct = 50, .retries = 1000};
    assert_int_equal(make_robot(&robot), GROBO_ERR_ARG); /* retries */
    robot.size = offsetof(grobo_robot_config, retries);
    assert_int_equal(make_robot(&robot), GROBO_OK);
    assert_int_equal(engine.config.speed_limit_pct, 50);
    robot.size = offsetof(grobo_robot_config, speed_limit_pct);
    assert_int_equal(grobo_robot_configure(&engine, &robot), GROBO_OK);
    assert_int_equal(engine.config.speed_limit_pct, 100);

    grobo_runner_config runner = {GROBO_RUNNER_CONFIG_INIT, .session = &good_session};
    runner.events = SIZE_MAX;
    assert_int_equal(make_runner(&runner), GROBO_ERR_ARG);
    runner.size = offsetof(grobo_runner_config, events);
    assert_int_equal(make_runner(&runner), GROBO_OK);
}

static int set_up(void)
{
    const grobo_runner_config runner = {GROBO_RUNNER_CONFIG_INIT, .session = &good_session};
    grobo_posture posture;
    base = grobo_loop_new();
    grobo_posture_init_pose(&posture, &grobo_i_gr001_model);
    posture.time_us = 100000;
    return base == NULL || grobo_motion_new(GROBO_MOTION_KEYS, 20, NULL, &keys) < 0 ||
           grobo_motion_append(keys, &posture) < 0 ||
           grobo_body_new(&grobo_i_gr001_body, keys, NULL, NULL, &body) < 0 ||
           grobo_runner_new(&runner, &runner_of) < 0;
}

static int tear_down(void)
{
    grobo_body_free(body);
    grobo_motion_free(keys);
    event_base_free(base);
    return grobo_runner_free(runner_of);
}

TESTS_BETWEEN(set_up, tear_down)
