/* SPDX-License-Identifier: MIT */
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/sim.h>

#include "tests/support/far_robot.h"
#include "tests/support/test.h"

#define TORQUE_REGISTER 36 /* No.36, torque enable (protocol 4) */

static unsigned char count_torqued(grobo_sim *sim)
{
    unsigned char n = 0;

    for (int i = 0; i < grobo_sim_servos(sim); i++) {
        int32_t value = 0;

        if (grobo_sim_get_register(sim, i, TORQUE_REGISTER, &value) >= 0 && value == 1) {
            n++;
        }
    }
    return n;
}

static void on_order(evutil_socket_t socket, short what, void *ctx)
{
    far_robot *robot = ctx;
    unsigned char order = 0;
    unsigned char answer = 0;

    (void)what;
    if (read(socket, &order, 1) != 1) {
        order = 'q';
    }
    switch (order) {
    case 'i':
    case 'o':
        answer = grobo_sim_server_plug(robot->server, order == 'i') != GROBO_OK;
        break;
    case 't':
        answer = count_torqued(grobo_sim_server_sim(robot->server));
        break;
    default:
        event_base_loopbreak(robot->base);
        break;
    }
    (void)!write(socket, &answer, 1);
}

static GROBO_THREAD_FUNC serve(void *arg)
{
    far_robot *robot = arg;
    struct event *order = event_new(robot->base, robot->its, EV_READ | EV_PERSIST, on_order, robot);

    if (order != NULL) {
        event_add(order, NULL);
        event_base_dispatch(robot->base);
        event_free(order);
    }
    GROBO_THREAD_RETURN;
}

static unsigned char order(far_robot *robot, char what)
{
    unsigned char answer = 255;

    assert_int_equal(write(robot->ours, &what, 1), 1);
    assert_int_equal(read(robot->ours, &answer, 1), 1);
    return answer;
}

void far_robot_start(far_robot *robot, const char *link)
{
    const grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .baud_bps = FAR_ROBOT_BPS};
    grobo_sim_server_config config = {GROBO_SIM_SERVER_CONFIG_INIT, .sim = &sim, .replug_ms = -1};
    grobo_os_cause cause;
    evutil_socket_t pair[2];

    assert_true(strlen(link) < sizeof robot->link);
    memcpy(robot->link, link, strlen(link) + 1);
    assert_int_equal(evutil_socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
    robot->ours = pair[0];
    robot->its = pair[1];
    robot->base = grobo_loop_new();
    assert_non_null(robot->base);
    config.base = robot->base;
    config.link = robot->link;
    assert_int_equal(grobo_sim_server_new(&config, &robot->server, &cause), GROBO_OK);
    assert_int_equal(grobo_thread_start(&robot->thread, serve, robot), GROBO_OK);
}

void far_robot_plug(far_robot *robot, bool in)
{
    assert_int_equal(order(robot, in ? 'i' : 'o'), 0);
}

int far_robot_torqued(far_robot *robot)
{
    return order(robot, 't');
}

void far_robot_end(far_robot *robot)
{
    (void)order(robot, 'q');
    assert_int_equal(grobo_thread_join(robot->thread), GROBO_OK);
    grobo_sim_server_free(robot->server);
    event_base_free(robot->base);
    assert_int_equal(close(robot->ours), 0);
    assert_int_equal(close(robot->its), 0);
}
