/* SPDX-License-Identifier: MIT */
/* One rule of halting for all families: whatever moves a joint and whatever stops it, the joint
 * comes to rest between where it is and where it can come to rest from there. */
#include <math.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/sim.h>

#include "tests/support/family_kit.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { MS = 1000, S = 1000000, JOINTS = FAMILY_JOINTS, FROM = -40, TO = 80 };

static family_kit kit;

/* ---- ways ------------------------------------------------------------------------------------ */

typedef enum way { BY_KEYS, AT_A_RATE, IN_A_STREAM, BY_A_MOVE, WAYS } way;
typedef enum stop { AT_ONCE, SMOOTHLY, CANCEL, PAUSE, ESTOP, LEAVE, STOPS } stop;

static const char *const way_names[WAYS] = {"keys", "rate", "stream", "move"};
static const char *const stop_names[STOPS] = {"stop", "smooth", "cancel", "pause", "estop", "exit"};

/* From FROM to TO at dps degrees a second, and there for 600 ms. */
typedef struct course {
    int64_t there_us;
} course;

static double course_deg(const course *c, int64_t at_us)
{
    double part = fmin((double)at_us / (double)c->there_us, 1);
    return FROM + (TO - FROM) * part;
}

static int course_key(void *ctx, size_t i, grobo_posture *p, int64_t *at_us)
{
    const course *c = ctx;
    const int64_t at[] = {0, c->there_us, c->there_us + 600 * MS};
    *at_us = at[i];
    *p = family_posture(&kit, course_deg(c, at[i]), 0);
    p->time_us = i > 0 ? at[i] - at[i - 1] : 0;
    return GROBO_OK;
}

static int course_sample(void *ctx, int64_t at_us, grobo_posture *p)
{
    *p = family_posture(&kit, course_deg(ctx, at_us), 0);
    return GROBO_OK;
}

static void play(course *c, grobo_play_mode mode)
{
    const grobo_clip clip = {.key = course_key,
                             .sample = course_sample,
                             .ctx = c,
                             .length_us = c->there_us + 600 * MS,
                             .n_keys = 3,
                             .n_joints = JOINTS};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = mode, .rate_hz = 20,
                                        .unwatched = true};
    assert_true(grobo_robot_play(&kit.robot, &clip, &options) > 0);
    for (int i = 0; grobo_robot_play_state(&kit.robot) != GROBO_SEQUENCER_PLAYING; i++) {
        assert_true(i < 10000);
        family_run(&kit, MS);
    }
}

static void stream(const course *c, int64_t us)
{
    for (int64_t at_us = 0; at_us < us; at_us += 20 * MS) {
        grobo_posture p = family_posture(&kit, course_deg(c, at_us + 20 * MS), 20);
        assert_int_equal(grobo_robot_send(&kit.robot, &p), GROBO_OK);
        family_run(&kit, us - at_us < 20 * MS ? us - at_us : 20 * MS);
    }
}

/* Goes that way until so long after it should be there. */
static void go(way by, course *c, int64_t after_us)
{
    int64_t us = c->there_us + after_us;
    assert_int_equal(family_move(&kit, FROM, 1500), GROBO_OK);
    grobo_posture p = family_posture(&kit, TO, (int)(c->there_us / MS));
    switch (by) {
    case BY_KEYS:
        play(c, GROBO_PLAY_KEY);
        family_run(&kit, us);
        break;
    case AT_A_RATE:
        play(c, GROBO_PLAY_RATE);
        family_run(&kit, us);
        break;
    case IN_A_STREAM:
        stream(c, us);
        break;
    case BY_A_MOVE:
        assert_true(grobo_robot_move(&kit.robot, &p) > 0);
        family_run(&kit, us);
        break;
    case WAYS:
        break;
    }
}

static void halt(stop how)
{
    switch (how) {
    case AT_ONCE:
    case SMOOTHLY:
        (void)grobo_robot_stop(&kit.robot, how == AT_ONCE);
        break;
    case CANCEL:
        (void)grobo_robot_cancel(&kit.robot);
        break;
    case PAUSE:
        (void)grobo_robot_pause(&kit.robot);
        break;
    case ESTOP:
        assert_true(grobo_robot_estop(&kit.robot) > 0);
        break;
    case LEAVE:
        assert_true(grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD) > 0);
        break;
    case STOPS:
        break;
    }
}

/* ---- what is seen ---------------------------------------------------------------------------- */

static double furthest_deg[JOINTS];

static double from_there_deg[JOINTS];

static void look_how_far(family_kit *k)
{
    for (int j = 0; j < JOINTS; j++) {
        double on_deg = family_angle_deg(k, j) - from_there_deg[j];
        furthest_deg[j] = fabs(on_deg) > fabs(furthest_deg[j]) ? on_deg : furthest_deg[j];
    }
}

/* Joints that stand stay there; where they still turn, one has the way that it needs to come to
 * rest in the 50 ms of a halt, or in the time of a smooth stop. */
static void one_stop(const family *f, way by, stop how, int after_ms)
{
    static const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .lost_replies = -1};
    course c = {.there_us = 900 * MS};
    double dps[JOINTS];
    family_start(&kit, f, &config, NULL);
    go(by, &c, after_ms * MS);
    family_run(&kit, 0); /* what is seen is of now */
    for (int j = 0; j < JOINTS; j++) {
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(&kit.sim, j, &view), GROBO_OK);
        dps[j] = fabs((double)view.speed_dps);
        if (after_ms < 0) { /* servos that are told no time hurry from goal to goal */
            dps[j] = fmax(dps[j], (TO - FROM) * (double)S / (double)c.there_us);
        }
        from_there_deg[j] = family_angle_deg(&kit, j);
        furthest_deg[j] = 0;
    }
    kit.on_look = look_how_far;
    halt(how);
    family_run(&kit, S);
    for (int j = 0; j < JOINTS; j++) {
        bool even = (how == SMOOTHLY || how == PAUSE || how == LEAVE) && by <= AT_A_RATE;
        double most_deg = dps[j] * (even ? 0.11 : 0.06) + 2;
        if (fabs(furthest_deg[j]) > most_deg) {
            fail_msg("%s: %s, %s %d ms after: joint %d at %.1f deg and %.0f deg/s goes %.1f deg "
                     "further",
                     f->name, way_names[by], stop_names[how], after_ms, j, from_there_deg[j],
                     dps[j], furthest_deg[j]);
        }
    }
}

TEST_FOR(family, family_next, a_joint_that_stands_is_not_thrown)
{
    for (way by = 0; by < WAYS; by++) {
        for (stop how = 0; how < STOPS; how++) {
            for (int after_ms = 50; after_ms <= 350; after_ms += 150) {
                if (how != PAUSE || by <= AT_A_RATE) {
                    one_stop(row, by, how, after_ms);
                }
            }
        }
    }
}

TEST_FOR(family, family_next, a_joint_that_moves_stops_where_it_can)
{
    for (way by = 0; by < WAYS; by++) {
        for (stop how = 0; how < STOPS; how++) {
            bool meant = how == CANCEL ? by == BY_A_MOVE : how == PAUSE ? by <= AT_A_RATE : true;
            for (int after_ms = -500; meant && after_ms < 0; after_ms += 220) {
                one_stop(row, by, how, after_ms);
            }
        }
    }
}

/* ---- joints of which nobody knows where they are --------------------------------------------- */

static const grobo_robot_config whole = {GROBO_ROBOT_CONFIG_INIT, .goals = GROBO_GOALS_WHOLE,
                                         .lost_replies = -1};

/* One frame on the line takes at most 5 ms on the slowest of these lines. */
static void expect_a_frame_at_once(unsigned n_sent)
{
    family_run(&kit, 15 * MS);
    if (kit.n_sent == n_sent) {
        fail_msg("%s: nothing has left, %u before", kit.family->name, n_sent);
    }
}

/* Of the first joint, by now. */
static double at_deg(void)
{
    grobo_sim_step(&kit.sim, kit.now_us);
    return family_angle_deg(&kit, 0);
}

static void expect_rest(int within_ms, double most_deg)
{
    double from_deg = at_deg();
    family_run(&kit, within_ms * MS);
    double then_deg = at_deg();
    family_run(&kit, S);
    if (fabs(at_deg() - then_deg) > 0.5 || fabs(then_deg - from_deg) > most_deg) {
        fail_msg("%s: from %.1f to %.1f, and on to %.1f deg", kit.family->name, from_deg, then_deg,
                 at_deg());
    }
}

/* The line was away while a joint moved: whenever the stop comes, what was not read since is read
 * at once, and halted. */
TEST_FOR(family, family_next, a_stop_after_a_replug_reads_and_halts)
{
    for (int i = 0; i < 12; i++) {
        family_start(&kit, row, &whole, NULL);
        assert_int_equal(family_move(&kit, 60, 1000), GROBO_OK);
        grobo_posture p = family_posture(&kit, -60, 4000);
        assert_true(grobo_robot_move(&kit.robot, &p) > 0);
        family_run(&kit, S);
        grobo_robot_link_down(&kit.robot, kit.now_us);
        family_run(&kit, 50 * MS);
        grobo_robot_link_up(&kit.robot, kit.now_us);
        family_run(&kit, i / 3 * 3 * MS);
        unsigned n_sent = kit.n_sent;
        switch (i % 3) {
        case 0:
            assert_int_equal(grobo_robot_stop(&kit.robot, true), GROBO_OK);
            break;
        case 1:
            assert_true(grobo_robot_exit(&kit.robot, GROBO_EXIT_HOLD) > 0);
            break;
        case 2:
            assert_true(grobo_robot_estop(&kit.robot) > 0);
            break;
        }
        expect_a_frame_at_once(n_sent);
        expect_rest(400, 10);
    }
}

/* A raw goal far away to a joint that is limp: its way never ends, and nobody waits for that. */
TEST_FOR(family, family_next, a_limp_joint_holds_up_no_emergency_stop)
{
    grobo_exchange goal;
    family_start(&kit, row, &whole, NULL);
    assert_int_equal(family_move(&kit, 60, 1000), GROBO_OK);
    int off = grobo_robot_torque(&kit.robot, GROBO_JOINT_BIT(3), GROBO_TORQUE_OFF);
    assert_int_equal(family_wait(&kit, off), GROBO_OK);
    grobo_posture p = family_posture(&kit, -60, 6000);
    p.set = GROBO_JOINT_BIT(0);
    assert_int_equal(grobo_robot_send(&kit.robot, &p), GROBO_OK);
    family_run(&kit, 100 * MS);
    grobo_target target = {.posture = family_posture(&kit, 0, 0)};
    target.posture.set = GROBO_JOINT_BIT(3);
    target.posture.angle_rad[3] = RAD(-80);
    target.joint_time_us[3] = 12 * S;
    target.from_rad[3] = RAD(30);
    memset(&goal, 0, sizeof goal);
    assert_int_equal(kit.driver.posture(&kit.driver, NULL, &target, 0, &goal), 1);
    int raw = grobo_robot_raw(&kit.robot, goal.frame, goal.frame_bytes);
    assert_true(raw > 0 || kit.driver.goal_energises);
    family_run(&kit, 100 * MS);
    unsigned n_sent = kit.n_sent;
    int number = grobo_robot_estop(&kit.robot);
    expect_a_frame_at_once(n_sent);
    int64_t from_us = kit.now_us;
    assert_int_equal(family_wait(&kit, number), GROBO_OK);
    assert_true(kit.now_us - from_us < 3 * (int64_t)S);
    expect_rest(1, 0.5);
}

/* ---- a reading that a halt waits for --------------------------------------------------------- */

/* How many servos a frame behind the first `from` asks at once; 0: none. */
static int asked_by(unsigned from)
{
    enum { SYNC_READ = 0x82, HEAD = 6 };
    const uint8_t *frame = kit.sent[from % FAMILY_SENT];
    size_t n = kit.sent_bytes[from % FAMILY_SENT];
    bool is_one = n > HEAD && frame[2] == 0xFE && frame[4] == SYNC_READ;
    return is_one ? frame[3] - 4 : 0;
}

/* Who has answered is not asked again: the one that is missing alone, until the next reading. */
TEST(a_reading_is_asked_again_of_those_that_are_missing)
{
    static const grobo_robot_config silent = {GROBO_ROBOT_CONFIG_INIT,
                                              .sense_interval_us = GROBO_SENSE_NEVER};
    int all = 0, again = 0;
    family_start(&kit, family_named("sts"), &silent, NULL);
    assert_int_equal(grobo_sim_set_id(&kit.sim, 1, 40), GROBO_OK);
    unsigned n_sent = kit.n_sent;
    assert_int_equal(grobo_robot_stop(&kit.robot, false), GROBO_OK);
    family_run(&kit, 50 * MS);
    for (unsigned i = n_sent; i < kit.n_sent; i++) {
        all += asked_by(i) == JOINTS;
        again += asked_by(i) == 1;
    }
    assert_int_equal(all, 1);
    assert_true(again >= 2);
}
