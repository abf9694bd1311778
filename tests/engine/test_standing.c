/* SPDX-License-Identifier: MIT */
/* Who says that a joint stands has read it: two positions, or its goal read back and reached. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "src/robot/trip.h"
#include "src/robot/turn.h"
#include "tests/support/family_kit.h"
#include "tests/support/rig.h"
#include "tests/support/test.h"

enum { JOINTS = FAMILY_JOINTS, MILLI = 1000, SECOND = 1000000 };

static family_kit kit;
static grobo_test_rig rig;

/* ---- creeping joints ------------------------------------------------------------------------- */

static const grobo_robot_config unread = {
    GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = GROBO_SENSE_NEVER, .goals = GROBO_GOALS_WHOLE};

/* Another program has sent all joints on their way, so slowly. */
static void set_creeping(const family *f, double dps)
{
    family_start(&kit, f, &unread, NULL);
    assert_int_equal(family_move(&kit, 60, 2000), GROBO_OK);
    double way_deg = fmin(20 * dps, 115);
    grobo_posture p = family_posture(&kit, 60 - way_deg, (int)(way_deg / dps * 1000));
    assert_true(grobo_robot_move(&kit.robot, &p) > 0);
    family_run(&kit, 1500 * MILLI);
}

static void another_program(const family *f)
{
    grobo_robot_config config = unread;
    config.bus.baud_bps = f->baud_bps;
    config.bus.echo = f->echo;
    assert_int_equal(grobo_robot_init(&kit.robot, &kit.driver, NULL, &config, kit.now_us), 0);
    family_listen(&kit);
}

static double at_now_deg(int joint)
{
    grobo_sim_step(&kit.sim, kit.now_us);
    return family_angle_deg(&kit, joint);
}

static void stands_from_now_on(double dps, const char *how)
{
    double at_deg[JOINTS];
    for (int j = 0; j < JOINTS; j++) {
        at_deg[j] = at_now_deg(j);
    }
    family_run(&kit, SECOND);
    for (int j = 0; j < JOINTS; j++) {
        double on_deg = fabs(at_now_deg(j) - at_deg[j]);
        if (on_deg > 0.6) {
            fail_msg("%s: verified at %g deg/s by %s, and joint %d went on by %.1f degrees",
                     kit.family->name, dps, how, j, on_deg);
        }
    }
}

static const double creeps_dps[] = {1, 2, 3, 5, 6, 7.5, 10, 14};

TEST_FOR(family, family_next, who_leaves_says_so_of_joints_that_stand)
{
    for (size_t i = 0; i < sizeof creeps_dps / sizeof creeps_dps[0]; i++) {
        for (int emergency = 0; emergency < 2; emergency++) {
            set_creeping(row, creeps_dps[i]);
            another_program(row);
            int number = emergency ? grobo_robot_estop(&kit.robot)
                                   : grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
            int64_t begun_us = kit.now_us;
            assert_int_equal(family_wait(&kit, number), GROBO_OK);
            assert_true(kit.now_us - begun_us < 2 * (int64_t)SECOND);
            stands_from_now_on(creeps_dps[i], emergency ? "an emergency stop" : "exit");
        }
    }
}

/* Who stands where it was sent is shown to by its goal, at once; where no servo tells that, by two
 * positions, of which none is from before the request: another program may have set it going. */
TEST_FOR(family, family_next, who_stands_where_it_was_sent_is_believed_at_once)
{
    bool tells_goal = strcmp(row->name, "ics") != 0;
    for (int watched = 0; watched < 2; watched++) {
        grobo_robot_config config = unread;
        config.sense_interval_us = watched ? 300 * MILLI : GROBO_SENSE_NEVER;
        family_start(&kit, row, &config, NULL);
        assert_int_equal(family_move(&kit, 30, 1000), GROBO_OK);
        family_run(&kit, 2 * (int64_t)SECOND);
        int64_t begun_us = kit.now_us;
        int number = grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD);
        assert_int_equal(family_wait(&kit, number), GROBO_OK);
        double took_ms = (double)(kit.now_us - begun_us) / 1000;
        if (took_ms > (tells_goal ? 250 : 1000)) {
            fail_msg("%s: %.0f ms", row->name, took_ms);
        }
    }
}

/* ---- a short bound --------------------------------------------------------------------------- */

TEST_FOR(family, family_next, a_short_bound_switches_torque_off)
{
    static const int bounds_ms[] = {5, 20, 100, 300};
    for (size_t i = 0; i < sizeof bounds_ms / sizeof bounds_ms[0]; i++) {
        grobo_robot_config config = unread;
        config.exit_bound_us = bounds_ms[i] * MILLI;
        family_start(&kit, row, &config, NULL);
        assert_int_equal(family_move(&kit, 30, 1000), GROBO_OK);
        grobo_posture p = family_posture(&kit, -30, 3000);
        assert_true(grobo_robot_move(&kit.robot, &p) > 0);
        family_run(&kit, SECOND);
        int64_t begun_us = kit.now_us;
        (void)family_wait(&kit, grobo_robot_exit(&kit.robot, GROBO_EXIT_OFF));
        assert_true(kit.now_us - begun_us <= (bounds_ms[i] + 2) * MILLI);
        family_run(&kit, 20 * MILLI);
        for (int j = 0; j < JOINTS; j++) {
            grobo_sim_view view;
            assert_int_equal(grobo_sim_look(&kit.sim, j, &view), GROBO_OK);
            if (view.torque != GROBO_TORQUE_OFF) {
                fail_msg("%s: joint %d has torque after %d ms", row->name, j, bounds_ms[i]);
            }
        }
    }
}

/* What an exit that sits down came to. */
static void sits_or_holds(int result, double from_deg, int bound_ms, const char *how)
{
    double at_deg[JOINTS];
    family_run(&kit, 150 * MILLI); /* a halt */
    for (int j = 0; j < JOINTS; j++) {
        at_deg[j] = at_now_deg(j);
    }
    family_run(&kit, 2 * SECOND);
    for (int j = 0; j < JOINTS; j++) {
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(&kit.sim, j, &view), GROBO_OK);
        bool limp = view.torque == GROBO_TORQUE_OFF;
        double is_deg = at_now_deg(j), near_deg = kit.family->near_deg + 0.5;
        bool sits = fabs(is_deg) < near_deg;
        bool went = fabs(is_deg - (from_deg - 10 * j)) > near_deg;
        const char *wrong = fabs(is_deg - at_deg[j]) > 0.6        ? "goes on"
                            : limp && !sits                       ? "falls"
                            : result == GROBO_OK && !limp         ? "is left with torque"
                            : result != GROBO_OK && went && !*how ? "was sent off"
                            : result != GROBO_OK && limp          ? "is let go"
                                                                  : NULL;
        if (wrong != NULL) {
            fail_msg("%s, %d ms%s: joint %d at %g %s after %s", kit.family->name, bound_ms, how, j,
                     is_deg, wrong, grobo_error_name(result));
        }
    }
}

static const double stood_deg = 60;

static void stand_up(const family *f, int bound_ms)
{
    grobo_robot_config config = unread;
    config.exit_bound_us = bound_ms * MILLI;
    family_start(&kit, f, &config, NULL);
    assert_int_equal(family_move(&kit, stood_deg, 2000), GROBO_OK);
}

TEST_FOR(family, family_next, who_cannot_sit_in_time_stays_as_it_is)
{
    static const int bounds_ms[] = {5, 50, 200, 800, 8000};
    for (size_t i = 0; i < sizeof bounds_ms / sizeof bounds_ms[0]; i++) {
        stand_up(row, bounds_ms[i]);
        int64_t begun_us = kit.now_us;
        int result = family_wait(&kit, grobo_robot_exit(&kit.robot, GROBO_EXIT_SIT));
        assert_true(kit.now_us - begun_us <= (bounds_ms[i] + 2) * MILLI);
        assert_int_equal(result, bounds_ms[i] < 1000 ? GROBO_ERR_TIMEOUT : GROBO_OK);
        sits_or_holds(result, stood_deg, bounds_ms[i], "");
    }
}

/* Its way is longer then than it seemed. */
static unsigned late_where_frames_are_lost(const family *f)
{
    unsigned late = 0;
    stand_up(f, 0);
    int64_t begun_us = kit.now_us;
    assert_int_equal(family_wait(&kit, grobo_robot_exit(&kit.robot, GROBO_EXIT_SIT)), 0);
    int bound_ms = (int)((kit.now_us - begun_us) / MILLI) * 3 / 2;
    for (unsigned frame = 1; frame <= 16; frame++) {
        stand_up(f, bound_ms);
        begun_us = kit.now_us;
        unsigned sent = kit.n_sent;
        int number = grobo_robot_exit(&kit.robot, GROBO_EXIT_SIT);
        while (kit.n_sent - sent < frame && kit.now_us - begun_us < bound_ms * MILLI) {
            family_run(&kit, MILLI / 4);
        }
        kit.lose = 2;
        int result = family_wait(&kit, number);
        assert_true(kit.now_us - begun_us <= (bound_ms + 2) * MILLI);
        late += result == GROBO_ERR_TIMEOUT;
        sits_or_holds(result, stood_deg, bound_ms, " and a lost frame");
    }
    return late;
}

TEST(who_is_held_up_while_it_sits_down_is_halted)
{
    unsigned late = 0;
    for (const family *f = family_next(NULL); f != NULL; f = family_next(f)) {
        late += late_where_frames_are_lost(f);
    }
    assert_true(late > 0); /* LX-16A and KRS, whose goals are frames of their own, are in time */
}

/* ---- what was halted is read back ------------------------------------------------------------ */

typedef enum stop_kind { AT_ONCE, SMOOTH, CANCEL, TRIP, LATCH, PAUSE, KINDS } stop_kind;

static const char *const stop_names[] = {"stop", "smooth stop",    "cancel",
                                         "trip", "stop and latch", "pause"};

static void halt(grobo_robot *robot, stop_kind kind)
{
    switch (kind) {
    case AT_ONCE:
    case SMOOTH:
        assert_int_equal(grobo_robot_stop(robot, kind == AT_ONCE), GROBO_OK);
        break;
    case CANCEL:
        assert_int_equal(grobo_robot_cancel(robot), GROBO_OK);
        break;
    case TRIP:
        grobo_i_enter(robot, robot->now_us);
        grobo_i_trip(robot, GROBO_TRIP_CURRENT, 1, 900, true);
        grobo_i_leave(robot);
        break;
    case LATCH: /* as a page's STOP, where the latch comes too early */
        assert_int_equal(grobo_robot_stop(robot, true), GROBO_OK);
        assert_int_equal(grobo_robot_latch(robot), GROBO_OK);
        break;
    case PAUSE:
        assert_int_equal(grobo_robot_pause(robot), GROBO_OK);
        break;
    case KINDS:
        break;
    }
}

/* A motion of all joints, to one posture and to another. */
static int key_of(void *ctx, size_t key, grobo_posture *posture, int64_t *at_us)
{
    const family_kit *of = ctx;
    *posture = family_posture(of, key == 0 ? 60 : -60, key == 0 ? 100 : 6000);
    *at_us = key == 0 ? 0 : 6 * (int64_t)SECOND;
    return GROBO_OK;
}

static void set_going(const family *f, stop_kind kind)
{
    family_start(&kit, f, &unread, NULL);
    assert_int_equal(family_move(&kit, 60, 1000), GROBO_OK);
    if (kind == PAUSE) {
        const grobo_clip clip = {.key = key_of,
                                 .ctx = &kit,
                                 .length_us = 6 * (int64_t)SECOND,
                                 .n_keys = 2,
                                 .n_joints = JOINTS};
        const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_KEY};
        assert_true(grobo_robot_play(&kit.robot, &clip, &options) > 0);
        family_run(&kit, 3 * (int64_t)SECOND);
    } else {
        grobo_posture p = family_posture(&kit, -60, 6000);
        assert_true(grobo_robot_move(&kit.robot, &p) > 0);
        family_run(&kit, 2 * (int64_t)SECOND);
    }
}

/* One frame or two of a halt do not arrive: until what it stops was read back, the robot moves; the
 * halt is repeated, and nothing goes on. */
TEST_FOR(family, family_next, a_halt_that_is_lost_is_repeated)
{
    for (int kind = 0; kind < KINDS; kind++) {
        for (int lost = 0; lost < 3; lost++) {
            set_going(row, (stop_kind)kind);
            double from_deg = at_now_deg(0);
            int64_t begun_us = kit.now_us;
            halt(&kit.robot, (stop_kind)kind);
            kit.lose = lost;
            do {
                assert_true(kit.now_us - begun_us < SECOND);
                family_run(&kit, MILLI);
            } while (kit.n_halted == 0 || (grobo_robot_moving(&kit.robot) && kind != PAUSE));
            if (kit.halted.joints != GROBO_JOINTS_ALL(JOINTS) || kit.halted.failed != 0) {
                fail_msg("%s: %s, %d lost: %#x were read back, %#x not", row->name,
                         stop_names[kind], lost, (unsigned)kit.halted.joints,
                         (unsigned)kit.halted.failed);
            }
            family_run(&kit, 200 * MILLI);
            double on_deg = fabs(at_now_deg(0) - from_deg);
            if (on_deg > 8) {
                fail_msg("%s: %s, %d lost: %.1f degrees on", row->name, stop_names[kind], lost,
                         on_deg);
            }
            stands_from_now_on(20, stop_names[kind]);
            assert_int_equal(kit.n_halted, 1);
        }
    }
}

/* The one of the board is not answered at all. */
TEST_WITH(rig_wirings, a_halt_of_gr001_that_is_lost_is_repeated)
{
    for (int kind = AT_ONCE; kind < PAUSE; kind++) {
        rig_start_at(&rig, 0, &quiet);
        grobo_posture p = rig_posture(&rig, R_ELBOW, -80, 4000);
        assert_true(grobo_robot_move(&rig.robot, &p) > 0);
        rig_run(&rig, 1300 * MILLI);
        double from_deg = rig_angle_deg(&rig, R_ELBOW);
        rig.judged = true;
        rig.halts_at_estop = kind == LATCH;
        rig.lose = 1;
        halt(&rig.robot, (stop_kind)kind);
        int64_t begun_us = rig.now_us;
        do {
            assert_true(rig.now_us - begun_us < SECOND);
            rig_run(&rig, MILLI);
        } while (grobo_robot_moving(&rig.robot));
        assert_int_equal(rig_count(&rig, GROBO_EVENT_HALTED), 1);
        const grobo_event *event = rig_last(&rig, GROBO_EVENT_HALTED);
        assert_true(event->u.halted.joints == GROBO_JOINT_BIT(R_ELBOW));
        assert_true(event->u.halted.failed == 0);
        double at_deg = rig_angle_deg(&rig, R_ELBOW);
        assert_true(fabs(at_deg - from_deg) < 6);
        rig_run(&rig, SECOND);
        assert_true(fabs(rig_angle_deg(&rig, R_ELBOW) - at_deg) < 0.5);
    }
}

/* Who does not answer is named, in time. */
TEST_FOR(family, family_next, who_cannot_be_read_back_is_named)
{
    set_going(row, AT_ONCE);
    halt(&kit.robot, AT_ONCE);
    kit.lose = INT32_MAX;
    int64_t begun_us = kit.now_us;
    while (grobo_robot_moving(&kit.robot)) {
        assert_true(kit.now_us - begun_us < 4 * (int64_t)SECOND);
        family_run(&kit, MILLI);
    }
    assert_true(kit.now_us - begun_us > 2 * (int64_t)SECOND);
    assert_int_equal(kit.n_halted, 1);
    assert_true(kit.halted.failed == GROBO_JOINTS_ALL(JOINTS));
    assert_true(kit.halted.joints == 0);
}

/* Targets that follow a stop at once are sent at their rate: nothing is waited for. */
TEST_FOR(family, family_next, a_stream_behind_a_stop_is_not_held_up)
{
    set_going(row, AT_ONCE);
    halt(&kit.robot, AT_ONCE);
    family_run(&kit, 10 * MILLI);
    double at_deg = at_now_deg(0);
    for (int i = 0; i < 100; i++) {
        grobo_posture p = family_posture(&kit, at_deg - 0.1 * i, 20);
        assert_int_equal(grobo_robot_send(&kit.robot, &p), GROBO_OK);
        family_run(&kit, 10 * MILLI);
    }
    family_run(&kit, 200 * MILLI);
    assert_int_equal(kit.n_trips, 0);
    assert_true(fabs(at_now_deg(0) - (at_deg - 9.9)) < 1.5);
    if (kit.n_halted > 1) {
        fail_msg("%s: %u stops were told of", row->name, kit.n_halted);
    }
}
