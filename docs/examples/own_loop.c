/* SPDX-License-Identifier: MIT */
/* A robot on the program's own libevent loop: no thread, everything happens in callbacks. */
#include <stdio.h>

#include <event2/event.h>

#include <grobo/grobo.h>

static void on_line(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    grobo_robot *robot = grobo_session_robot(session);
    if (event != GROBO_SESSION_EVENT_UP || grobo_robot_torque(robot, 1, GROBO_TORQUE_ON) < 0) {
        fprintf(stderr, "no robot: %s\n", grobo_error_text(error));
        (void)event_base_loopbreak(ctx);
    }
}

static void on_robot(void *ctx, const grobo_event *event)
{
    if (event->kind == GROBO_EVENT_JOB && event->u.job.kind == GROBO_JOB_TORQUE) {
        printf("torque of joint 0: %s\n", grobo_error_text(event->u.job.result));
        (void)event_base_loopbreak(ctx);
    }
}

int main(void)
{
    struct event_base *base = grobo_loop_new();
    grobo_session_config config = {GROBO_SESSION_CONFIG_INIT, .base = base, .ctx = base};
    config.device = "sim";
    config.on_event = on_line;
    config.on_robot = on_robot;
    grobo_session *session = NULL;
    if (grobo_session_new(&config, &session) >= 0 && grobo_session_open(session) >= 0) {
        (void)event_base_dispatch(base);
    }
    grobo_session_free(session);
    event_base_free(base);
    return 0;
}
