/* SPDX-License-Identifier: MIT */
/* An engine and a simulator in virtual time. */
#include <grobo/core/loop.h>
#include <grobo/core/port.h>
#include <grobo/core/virtual.h>
#include <grobo/model.h>
#include <grobo/posture.h>
#include <grobo/robot_file.h>

#include "tests/support/test.h"

enum { SECOND_US = 1000000 };

/* How the last job ended. */
static int ended;

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        ended = event->u.job.result;
    }
}

static int begin_move(grobo_virtual *robot)
{
    grobo_posture target;
    grobo_posture_init_pose(&target, grobo_gr001_model());
    ended = GROBO_ERR_PENDING;
    grobo_robot_on_event(grobo_virtual_robot(robot), on_event, NULL);
    return grobo_robot_move(grobo_virtual_robot(robot), &target);
}

static double knee_deg(grobo_virtual *robot)
{
    int knee = grobo_model_find_joint(grobo_gr001_model(), "L_KNEE_P", 8);
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(grobo_virtual_sim(robot), knee, &view), 0);
    return view.angle_mdeg / 1000.0;
}

/* What a run of ten seconds ends with. */
static grobo_bus_stats run_ten(const grobo_virtual_config *config, double *deg)
{
    grobo_virtual *robot = NULL;
    assert_int_equal(grobo_virtual_new(config, &robot), GROBO_OK);
    int job = begin_move(robot);
    assert_true(job > 0);
    for (int i = 0; i < 10; i++) {
        assert_int_equal(grobo_virtual_run(robot, SECOND_US), GROBO_OK);
    }
    assert_int_equal(grobo_virtual_now_us(robot), 10 * SECOND_US);
    assert_false(grobo_robot_is_pending(grobo_virtual_robot(robot), job));
    *deg = knee_deg(robot);
    grobo_bus_stats stats = *grobo_robot_get_bus_stats(grobo_virtual_robot(robot));
    grobo_virtual_free(robot);
    return stats;
}

TEST(a_robot_moves_and_each_run_gives_the_same)
{
    const grobo_sim_config limp = {GROBO_SIM_CONFIG_INIT, .start = GROBO_SIM_START_ZERO};
    const grobo_virtual_config config = {GROBO_VIRTUAL_CONFIG_INIT, .sim = &limp};
    double first_deg, second_deg;
    grobo_bus_stats first = run_ten(&config, &first_deg);
    grobo_bus_stats second = run_ten(&config, &second_deg);
    assert_true(first_deg > 39.5 && first_deg < 40.5);
    assert_memory_equal(&first, &second, sizeof first);
    assert_true(first_deg == second_deg);
    assert_true(first.tx_frames > 20); /* it is asked in the background, too */
}

TEST(the_rate_of_the_line_is_that_of_the_robots_file)
{
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    static grobo_robot_sim setting;
    const grobo_robot_def *arm = grobo_robot_def_find("so101");
    grobo_virtual *robot = NULL;
    assert_int_equal(grobo_robot_def_driver(arm, arm->wiring, &driver), 0);
    assert_int_equal(grobo_robot_def_sim(arm, arm->wiring, &setting), 0);
    const grobo_virtual_config config = {GROBO_VIRTUAL_CONFIG_INIT, .driver = &driver,
                                         .sim = &setting.config};
    assert_int_equal(grobo_virtual_new(&config, &robot), GROBO_OK);
    grobo_posture target;
    grobo_posture_init_pose(&target, arm->model);
    ended = GROBO_ERR_PENDING;
    grobo_robot_on_event(grobo_virtual_robot(robot), on_event, NULL);
    assert_true(grobo_robot_move(grobo_virtual_robot(robot), &target) > 0);
    assert_int_equal(grobo_virtual_run(robot, 10 * SECOND_US), GROBO_OK);
    assert_int_equal(ended, GROBO_OK);
    grobo_virtual_free(robot);
}

TEST(a_cable_that_hung_up_comes_back)
{
    grobo_virtual *robot = NULL;
    const grobo_virtual_config config = {GROBO_VIRTUAL_CONFIG_INIT};
    assert_int_equal(grobo_virtual_new(&config, &robot), GROBO_OK);
    assert_int_equal(grobo_virtual_run(robot, SECOND_US), GROBO_OK);
    grobo_sim *sim = grobo_virtual_sim(robot);
    assert_int_equal(grobo_sim_set_fault(sim, GROBO_SIM_FAULT_HANG_UP, 1), 0);
    int lost = begin_move(robot);
    assert_true(lost > 0);
    assert_int_equal(grobo_virtual_run(robot, SECOND_US / 2), GROBO_OK);
    assert_true(grobo_sim_hung_up(sim));
    assert_int_equal(ended, GROBO_ERR_UNPLUGGED);
    assert_int_equal(grobo_sim_set_fault(sim, GROBO_SIM_FAULT_HANG_UP, 0), 0);
    assert_int_equal(grobo_virtual_run(robot, GROBO_VIRTUAL_REPLUG_US), GROBO_OK);
    assert_false(grobo_sim_hung_up(sim));
    int job = begin_move(robot);
    assert_int_equal(grobo_virtual_run(robot, 5 * SECOND_US), GROBO_OK);
    assert_true(job > 0);
    assert_int_equal(ended, GROBO_OK);
    grobo_virtual_free(robot);
}

TEST(mistakes_of_the_caller_are_refused)
{
    grobo_virtual *robot = NULL;
    const grobo_sim_config cold = {GROBO_SIM_CONFIG_INIT, .ambient_c = -300};
    const grobo_virtual_config config = {GROBO_VIRTUAL_CONFIG_INIT, .sim = &cold};
    assert_int_equal(grobo_virtual_new(&config, &robot), GROBO_ERR_ARG);
    assert_null(robot);
    const grobo_virtual_config good = {GROBO_VIRTUAL_CONFIG_INIT};
    assert_int_equal(grobo_virtual_new(&good, &robot), GROBO_OK);
    assert_int_equal(grobo_virtual_run(robot, -1), GROBO_ERR_ARG);
    assert_int_equal(grobo_virtual_run(robot, INT64_MAX), GROBO_ERR_ARG);
    assert_int_equal(grobo_virtual_now_us(robot), 0);
    grobo_virtual_free(robot);
}

TEST(a_loop_runs_for_as_long_as_it_is_told)
{
    struct event_base *base = grobo_loop_new();
    assert_non_null(base);
    int64_t begin_us = grobo_now_us();
    assert_int_equal(grobo_loop_run(base, 0), GROBO_OK);
    assert_int_equal(grobo_loop_run(base, 20000), GROBO_OK);
    assert_true(grobo_now_us() - begin_us >= 20000);
    assert_int_equal(grobo_loop_run(base, -1), GROBO_ERR_ARG);
    grobo_loop_free(base);
}
