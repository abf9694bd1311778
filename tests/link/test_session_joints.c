/* SPDX-License-Identifier: MIT */
/* Robots of one joint and of as many as there may be: those whose frames are the longest. */
#include <stdint.h>
#include <stdio.h>

#include <event2/event.h>

#include <grobo/core/board.h>
#include <grobo/session.h>

#include "tests/support/loop.h"
#include "tests/support/test.h"

static struct event_base *base;
static int ends, result;

static void on_event(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    (void)session;
    (void)ctx;
    assert_int_equal(event, GROBO_SESSION_EVENT_UP);
    assert_int_equal(error, GROBO_OK);
    ends++;
    event_base_loopbreak(base);
}

static void on_robot(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        result = event->u.job.result;
        ends++;
        event_base_loopbreak(base);
    }
}

static void move_all(const grobo_model *model, grobo_wiring wiring)
{
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_posture target;
    grobo_session *session;
    const grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .unpaced = true};
    const grobo_session_config config = {GROBO_SESSION_CONFIG_INIT,
                                         .base = base,
                                         .device = GROBO_DEVICE_SIM,
                                         .driver = &driver,
                                         .on_event = on_event,
                                         .on_robot = on_robot,
                                         .sim = &sim};

    ends = 0;
    assert_int_equal(grobo_rs30x_driver_init(&driver, model, grobo_wiring_protocol(wiring)),
                     GROBO_OK);
    assert_int_equal(grobo_session_new(&config, &session), GROBO_OK);
    assert_int_equal(grobo_session_open(session), GROBO_OK);
    loop_run_until(base, &ends, 1);
    assert_int_equal(grobo_posture_init(&target, model->n_joints), GROBO_OK);
    for (int j = 0; j < model->n_joints; j++) {
        assert_int_equal(grobo_posture_set_rad(&target, j, 0.05), GROBO_OK);
    }
    assert_true(grobo_robot_move(grobo_session_robot(session), &target) > 0);
    loop_run_until(base, &ends, 2);
    assert_int_equal(result, GROBO_OK);
    grobo_session_free(session);
}

TEST(every_number_of_joints_moves)
{
    /* 24 and 25: the most that a relay frame's packet holds, and one more. */
    static const uint8_t numbers[] = {1, 24, 25, GROBO_JOINTS_MAX};
    static grobo_joint joints[GROBO_JOINTS_MAX];
    static char names[GROBO_JOINTS_MAX][8];

    base = grobo_loop_new();
    assert_non_null(base);
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        assert_true(snprintf(names[j], sizeof names[j], "J_%d", j) > 0);
        joints[j] = (grobo_joint){.name = names[j],
                                  .min_rad = -1,
                                  .max_rad = 1,
                                  .max_speed_rad_s = 10,
                                  .motor = (uint8_t)(j + 1),
                                  .mirror = (uint8_t)j,
                                  .mirror_sign = 1};
    }
    for (size_t i = 0; i < sizeof numbers; i++) {
        const grobo_model model = GROBO_TABLE(grobo_model, .name = "many",
                                              GROBO_MODEL_JOINTS(joints), .n_joints = numbers[i]);

        move_all(&model, GROBO_WIRING_BOARD);
        move_all(&model, GROBO_WIRING_BUS);
    }
    event_base_free(base);
}
