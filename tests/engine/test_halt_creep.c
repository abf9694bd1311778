/* SPDX-License-Identifier: MIT */
/*
 * A joint creeps at 1 to 20 degrees a second to a goal that another program gave it, and is
 * stopped. Its servo obeys, or answers and obeys nothing: of a joint that goes on nobody says that
 * it stands. Judged by a far side that is not ours, for all families.
 *
 * What is said is the result of the job: an emergency stop or an exit that ends with GROBO_OK has
 * seen every joint stand.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/halt_kit.h"
#include "tests/support/test.h"

#define FROM_DEG (-60.0)
#define TO_DEG 80.0
/* Standing: what the safety page allows between two positions half a second apart. */
#define STANDS_DPS 1.0
#define MOVED_DEG 0.6

typedef enum creep { TO_A_GOAL, DEAF, CREEPS } creep;
typedef enum asks { ESTOP, EXIT, FRESH_ESTOP, FRESH_EXIT, ASKS } asks;

static const char *const creep_names[] = {"goal", "deaf"};
static const char *const ask_names[] = {"estop", "exit", "fresh estop", "fresh exit"};

static struct {
    int cells, failed, verified;
} sum;

static int moved_servo(void)
{
    return halt.of->driver.model->joints[halt.of->moved].motor - 1;
}

static void begin_creep(creep how, double dps)
{
    far_joint *joint = &halt.far.joint[moved_servo()];
    far_foreign(&halt.far, moved_servo(), TO_DEG, dps, halt.now_us);
    joint->deaf = how == DEAF;
}

/* The result of the stop. */
static int stop(asks ask)
{
    static const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT};
    if (ask == FRESH_ESTOP || ask == FRESH_EXIT) {
        halt_new_engine(&config);
    }
    bool estop = ask == ESTOP || ask == FRESH_ESTOP;
    return halt_wait(estop ? grobo_robot_estop(&halt.robot)
                           : grobo_robot_exit(&halt.robot, GROBO_EXIT_HOLD),
                     15 * HALT_S);
}

/* How far it goes on in the second behind the stop. */
static double goes_on_deg(void)
{
    double before_deg = far_angle(&halt.far, moved_servo(), halt.now_us);
    halt_run(HALT_S);
    return fabs(far_angle(&halt.far, moved_servo(), halt.now_us) - before_deg);
}

static void judge(const halt_robot *robot, creep how, asks ask, double dps)
{
    halt_begin(robot, FROM_DEG);
    halt_run(500 * HALT_MS);
    halt_make_ready(FROM_DEG);
    begin_creep(how, dps);
    halt_run(300 * HALT_MS);
    int r = stop(ask);
    double on_deg = goes_on_deg();
    bool says = r == GROBO_OK;
    sum.cells++;
    sum.verified += says;
    if (says && on_deg > MOVED_DEG && dps > STANDS_DPS) {
        sum.failed++;
        print_message("%s: %s, %.1f deg/s, %s: said to stand, and went on for %.2f deg in 1 s\n",
                      robot->name, creep_names[how], dps, ask_names[ask], on_deg);
    }
    if (how == TO_A_GOAL && !says) { /* it obeys: it can be stopped */
        sum.failed++;
        print_message("%s: %s, %.1f deg/s, %s: not stopped: %s\n", robot->name, creep_names[how],
                      dps, ask_names[ask], grobo_error_name(r));
    }
}

static void creep_at(const halt_robot *robot, double dps)
{
    for (creep how = TO_A_GOAL; how < CREEPS; how++) {
        for (asks ask = ESTOP; ask < ASKS; ask++) {
            judge(robot, how, ask, dps);
        }
    }
}

TEST(nobody_says_that_a_creeping_joint_stands)
{
    static const double speeds[] = {1, 1.5, 2, 3, 4, 6, 8, 10, 15, 20};
    enum { SPEEDS = sizeof speeds / sizeof speeds[0] };
    for (int i = 0; halt_robot_of(i) != NULL; i++) {
        for (int k = 0; i < HALT_FAMILIES && k < SPEEDS; k++) {
            creep_at(halt_robot_of(i), speeds[k]);
        }
        if (i >= HALT_FAMILIES) { /* larger ones, and other rates: one slow, one of the others */
            creep_at(halt_robot_of(i), speeds[i % 2]);
            creep_at(halt_robot_of(i), speeds[2 + i % (SPEEDS - 2)]);
        }
    }
    print_message("%d stops of a creeping joint, %d said to stand, %d broke a rule\n", sum.cells,
                  sum.verified, sum.failed);
    assert_true(sum.verified > 0);
    assert_int_equal(sum.failed, 0);
}
