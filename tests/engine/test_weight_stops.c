/* SPDX-License-Identifier: MIT */
/*
 * Whatever stops or holds an arm that carries weight keeps the error that carries it: it neither
 * dips nor creeps, and is not thrown upwards either. Judged by where the simulated shafts are, for
 * each robot of the library whose file has masses and whose servos hold where they are stopped.
 */
#include <math.h>
#include <stdlib.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tests/support/weight_kit.h"

/* What a stop may do to a joint at rest: 0.5 degrees, or two steps of a servo of 1024. */
#define STAYS_DEG 0.5
/* A joint that moves is not known that well. */
#define DIPS_DEG 0.75
/* A halt leaves so much later than it is asked for; the joint goes on until then, and brakes. */
#define HEARD_S 0.15
#define THROWN_DEG 2.0

enum { LIFT = 1, ELBOW = 2 };

typedef struct arm {
    const char *name, *robot;
    int gain; /* 0: what the servos come with */
} arm;

static const arm arms[] = {
    {"so101, gain 16", "so101", 16},
    {"so101, gain 32", "so101", 32},
    {"koch", "koch", 0},
    {"openmanipulator-x", "openmanipulator-x", 0},
};

static int end(void)
{
    weight_finish();
    return 0;
}

TESTS_BETWEEN(NULL, end)

/* ---- ways to stop ---------------------------------------------------------------------------- */

typedef enum way_to_stop { STOP, SMOOTH, CANCEL, ESTOP, EXIT, TRIP, GUARD, WAYS } way_to_stop;

static const char *const way_names[] = {
    "stop", "smooth", "cancel", "estop", "exit", "trip", "a new engine exits"};

/* What comes before the moment of the stop. */
static void lead_up_to(way_to_stop way)
{
    if (way == GUARD) {
        weight_new_engine();
    } else if (way == TRIP) { /* by the next reading */
        weight.robot.config.temperature_c = 1;
        for (int i = 0; i < 3000 && weight.tripped == GROBO_TRIP_NONE; i++) {
            weight_run(WEIGHT_MS);
        }
    }
}

/* @return the job that carries it out, 0: none */
static int stop_by(way_to_stop way)
{
    switch (way) {
    case STOP:
        return grobo_robot_stop(&weight.robot, true);
    case SMOOTH:
        return grobo_robot_stop(&weight.robot, false);
    case CANCEL:
        return grobo_robot_cancel(&weight.robot);
    case ESTOP:
        return grobo_robot_estop(&weight.robot);
    case EXIT:
        return grobo_robot_exit(&weight.robot, GROBO_EXIT_HOLD);
    case TRIP:
        return 0; /* it has */
    case GUARD:
        return grobo_robot_exit(&weight.robot, GROBO_EXIT_HOLD);
    case WAYS:
        break;
    }
    return GROBO_ERR_ARG;
}

/* Where an emergency stop takes the torque, nothing is left that could hold. */
static bool falls(way_to_stop way)
{
    grobo_exchange frame;
    return way == ESTOP &&
           weight.driver.torque(&weight.driver, NULL, 1, GROBO_TORQUE_BRAKE, 0, &frame) > 0;
}

/* ---- in motion ------------------------------------------------------------------------------- */

/* Where the joint may come to rest that was at `at_deg` and went at `dps` when a stop was asked
 * for: not behind that, nor further than it takes to hear and to brake. An engine that has not seen
 * it stand does not know what it carries: it sags by that once, and no more. */
static int judge_rest(const arm *row, way_to_stop way, int joint, double at_deg, double dps)
{
    double rest_deg = weight_angle_deg(joint);
    double on_deg = (rest_deg - at_deg) * copysign(1, dps);
    double most_deg = fabs(dps) * HEARD_S + THROWN_DEG;
    double sags_deg = way == GUARD ? fabs(weight_goal_deg(joint) - rest_deg) : 0;
    most_deg += sags_deg;
    if (on_deg < -DIPS_DEG - sags_deg || on_deg > most_deg) {
        print_message("%s: %s at %.1f deg and %.0f deg/s: at rest %.2f deg further\n", row->name,
                      way_names[way], at_deg, dps, on_deg);
        return 1;
    }
    return 0;
}

/* So many degrees, the other way where they lead out of the joint's limits. */
static double within(int joint, double from_deg, double by_deg)
{
    const grobo_joint *model = &weight.def->model->joints[joint];
    double to_rad = grobo_rad_from_deg(from_deg + by_deg);
    return to_rad < model->min_rad || to_rad > model->max_rad ? -by_deg : by_deg;
}

/* A joint on its way by so many degrees is stopped after so long. */
static int stop_on_way(const arm *row, way_to_stop way, int joint, double by_deg, int after_ms)
{
    grobo_sim_physics_view view;
    weight_begin(row->robot, row->gain);
    assert_int_equal(weight_torque(GROBO_TORQUE_ON), 0);
    double from_deg = weight_angle_deg(joint);
    by_deg = within(joint, from_deg, by_deg);
    grobo_posture target = weight_target(joint, from_deg + by_deg, 1000);
    assert_true(grobo_robot_move(&weight.robot, &target) > 0);
    weight_run(after_ms * WEIGHT_MS);
    lead_up_to(way);
    double at_deg = weight_angle_deg(joint);
    assert_int_equal(grobo_sim_physics_look(weight.physics, joint, &view), 0);
    double dps = view.speed_rad_s * 57.29577951308232;
    dps = copysign(fmax(fabs(dps), fabs(by_deg)), by_deg);
    if (falls(way)) {
        return 0;
    }
    int job = stop_by(way);
    if (job > 0) {
        (void)weight_wait(job);
    }
    weight_run(2 * WEIGHT_S);
    return judge_rest(row, way, joint, at_deg, dps);
}

TEST_EACH(arm, arms, a_stop_in_motion_neither_dips_nor_throws)
{
    static const double ways_deg[] = {-30, 30, 8};
    static const int moments_ms[] = {60, 150, 480, 1100};
    int failed = 0, n = 0;
    for (int way = 0; way < WAYS; way++) {
        for (size_t k = 0; k < sizeof ways_deg / sizeof ways_deg[0]; k++) {
            for (size_t m = 0; m < sizeof moments_ms / sizeof moments_ms[0]; m++) {
                int joint = k < 2 ? LIFT : ELBOW;
                failed += stop_on_way(row, (way_to_stop)way, joint, ways_deg[k], moments_ms[m]);
                n++;
            }
        }
    }
    print_message("%s: %d of %d stops in motion dip or throw\n", row->name, failed, n);
    assert_int_equal(failed, 0);
}

/* ---- at rest --------------------------------------------------------------------------------- */

enum { DEEDS = 100 };

/* What leaves the arm where it is, whatever comes of it. */
static const char *do_nothing_much(uint32_t *seed)
{
    unsigned which = next_random(seed) % 9;
    if (which < WEIGHT_NOTHINGS) {
        return weight_do_nothing(which);
    }
    if (which == WEIGHT_NOTHINGS) { /* one that nobody answers for a while */
        weight.lose = 12;
        weight_wait_if(grobo_robot_sense(&weight.robot, GROBO_JOINTS_ALL(2), GROBO_SENSE_FULL));
        weight.lose = 0;
        weight_wait_if(grobo_robot_exit(&weight.robot, GROBO_EXIT_HOLD));
        weight_new_engine();
        return "lost replies";
    }
    way_to_stop way = (way_to_stop)(next_random(seed) % WAYS);
    way = falls(way) ? STOP : way;
    lead_up_to(way);
    weight_wait_if(stop_by(way));
    weight_run((int)(next_random(seed) % 300) * WEIGHT_MS);
    if (way == ESTOP || way == EXIT || way == TRIP || way == GUARD) {
        weight_new_engine();
    }
    return way_names[way];
}

/* The joints of the arm: a gripper is at the end. */
static int arm_joints(void)
{
    return weight.def->model->n_joints - 1;
}

static void hundred_actions(const arm *row, uint32_t seed)
{
    double before_deg[GROBO_JOINTS_MAX], first_deg[GROBO_JOINTS_MAX];
    for (int j = 0; j < arm_joints(); j++) {
        before_deg[j] = first_deg[j] = weight_angle_deg(j);
    }
    for (int i = 0; i < DEEDS; i++) {
        const char *action = do_nothing_much(&seed);
        weight_run((int)(next_random(&seed) % 400) * WEIGHT_MS);
        for (int j = 0; j < arm_joints(); j++) {
            double deg = weight_angle_deg(j);
            if (fabs(deg - before_deg[j]) > STAYS_DEG || fabs(deg - first_deg[j]) > STAYS_DEG) {
                fail_msg("%s: action %d, %s: joint %d at %.2f deg; before %.2f, first %.2f",
                         row->name, i, action, j, deg, before_deg[j], first_deg[j]);
            }
            before_deg[j] = deg;
        }
    }
}

TEST_EACH(arm, arms, nothing_moves_a_loaded_arm_at_rest)
{
    weight_begin(row->robot, row->gain);
    assert_int_equal(weight_torque(GROBO_TORQUE_ON), 0);
    assert_int_equal(weight_move(LIFT, -20, 1000), 0);
    assert_int_equal(weight_move(ELBOW, 20, 1000), 0);
    weight_run(2 * WEIGHT_S);
    hundred_actions(row, 1);
}

/* Right behind a move, while the arm still sags or swings, nothing makes it creep either: it comes
 * to rest where it would have without that, or on the way there. *at_deg: where it was. */
static double rest_behind_move(const arm *row, int joint, double to_deg, int wait_ms,
                               way_to_stop way, double *at_deg)
{
    weight_begin(row->robot, row->gain);
    assert_int_equal(weight_torque(GROBO_TORQUE_ON), 0);
    weight_run(WEIGHT_S);
    (void)weight_move(joint, to_deg, 300);
    weight_run(wait_ms * WEIGHT_MS);
    if (way < WAYS) {
        lead_up_to(way);
        *at_deg = weight_angle_deg(joint);
        weight_wait_if(stop_by(way));
    }
    weight_run(2 * WEIGHT_S);
    return weight_angle_deg(joint);
}

TEST_EACH(arm, arms, a_stop_behind_a_move_keeps_its_goal)
{
    static const int waits_ms[] = {0, 60, 250};
    int failed = 0, n = 0;
    for (int k = 0; k < 3; k++) {
        int joint = k < 2 ? LIFT : ELBOW;
        double to_deg = k % 2 == 0 ? -20 : 20;
        double rest_deg = rest_behind_move(row, joint, to_deg, 0, WAYS, NULL);
        for (int way = 0; way < WAYS; way++) {
            for (size_t w = 0; w < sizeof waits_ms / sizeof waits_ms[0]; w++) {
                if (falls((way_to_stop)way)) {
                    continue;
                }
                double at_deg;
                double deg =
                    rest_behind_move(row, joint, to_deg, waits_ms[w], (way_to_stop)way, &at_deg);
                double sags_deg = way == GUARD ? fabs(weight_goal_deg(joint) - deg) : 0;
                n++;
                if (deg < fmin(at_deg, rest_deg) - DIPS_DEG - sags_deg ||
                    deg > fmax(at_deg, rest_deg) + DIPS_DEG + sags_deg) {
                    failed++;
                    print_message("%s: joint %d to %.0f deg, %s %d ms later: at %.2f, not %.2f\n",
                                  row->name, joint, to_deg, way_names[way], waits_ms[w], deg,
                                  rest_deg);
                }
            }
        }
    }
    print_message("%s: %d of %d stops behind a move leave another goal\n", row->name, failed, n);
    assert_int_equal(failed, 0);
}

/* ---- other loads ----------------------------------------------------------------------------- */

/* It falls out of the hand on the way up: the stop does not throw the arm by what it weighed. */
TEST(a_payload_that_is_lost_on_the_way_throws_no_arm)
{
    for (int after_ms = 200; after_ms < 900; after_ms += 100) {
        weight_begin("so101", 16);
        assert_int_equal(grobo_sim_set_payload(&weight.sim, NULL, 0.15), 0);
        weight_run(2 * WEIGHT_S);
        assert_int_equal(weight_torque(GROBO_TORQUE_ON), 0);
        weight_run(WEIGHT_S);
        grobo_posture target = weight_target(LIFT, -30, 1000);
        assert_true(grobo_robot_move(&weight.robot, &target) > 0);
        weight_run(after_ms * WEIGHT_MS);
        assert_int_equal(grobo_sim_set_payload(&weight.sim, NULL, 0), 0);
        weight_run(300 * WEIGHT_MS);
        grobo_sim_physics_view view;
        assert_int_equal(grobo_sim_physics_look(weight.physics, LIFT, &view), 0);
        double at_deg = weight_angle_deg(LIFT), dps = fabs(view.speed_rad_s) * 57.29577951308232;
        assert_int_equal(grobo_robot_stop(&weight.robot, true), 0);
        weight_run(2 * WEIGHT_S);
        double up_deg = at_deg - weight_angle_deg(LIFT);
        if (up_deg > dps * HEARD_S + THROWN_DEG) {
            fail_msg("lost after %d ms: %.2f deg further up", after_ms, up_deg);
        }
    }
}

/* Torque comes on where the arm lies: nothing steps upwards. */
TEST(torque_that_comes_on_lifts_no_arm)
{
    for (int held = 0; held < 2; held++) { /* it lies on its stop, or a hand holds it */
        weight_begin("so101", 16);
        assert_int_equal(weight_torque(GROBO_TORQUE_OFF), 0);
        if (held) {
            assert_int_equal(grobo_sim_push(&weight.sim, LIFT, -weight_load_nm(LIFT)), 0);
        }
        weight_run(3 * WEIGHT_S);
        double highest_deg = weight_angle_deg(LIFT);
        int job = grobo_robot_torque(&weight.robot, GROBO_JOINTS_ALL(6), GROBO_TORQUE_ON);
        assert_true(job > 0);
        for (int ms = 0; ms < 2000; ms++) {
            weight_run(WEIGHT_MS);
            assert_true(weight_angle_deg(LIFT) > highest_deg - STAYS_DEG);
            highest_deg = fmax(highest_deg, weight_angle_deg(LIFT));
        }
    }
}

/* Where the error would lie outside the limits, the goal is the limit. */
TEST_EACH(arm, arms, no_goal_leaves_the_limits)
{
    const grobo_joint *model;
    for (int joint = LIFT; joint <= ELBOW; joint++) {
        for (int k = 0; k < 8; k++) {
            weight_begin(row->robot, row->gain);
            assert_int_equal(weight_torque(GROBO_TORQUE_ON), 0);
            model = &weight.def->model->joints[joint];
            double end_deg = grobo_deg_from_rad(k % 2 == 0 ? model->min_rad : model->max_rad);
            (void)weight_move(joint, end_deg * 0.97, 2000);
            grobo_posture target = weight_target(joint, end_deg, 200);
            assert_true(grobo_robot_move(&weight.robot, &target) > 0);
            weight_run((40 + 40 * k) * WEIGHT_MS);
            weight_wait_if(grobo_robot_stop(&weight.robot, true));
            weight_run(WEIGHT_S);
            assert_true(weight_goal_deg(joint) >= grobo_deg_from_rad(model->min_rad) - 0.1);
            assert_true(weight_goal_deg(joint) <= grobo_deg_from_rad(model->max_rad) + 0.1);
        }
    }
}
