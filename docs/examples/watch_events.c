/* SPDX-License-Identifier: MIT */
/* Prints what happens while the robot moves: jobs that end, safety stops, the line. */
#include <stdio.h>

#include <grobo/grobo.h>

static void on_robot(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        printf("job %d: %s\n", event->u.job.number, grobo_error_text(event->u.job.result));
    } else if (event->kind == GROBO_EVENT_TRIP) {
        printf("safety stop: %s\n", grobo_trip_name(event->u.trip.trip));
    }
}

static void on_line(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    (void)ctx;
    printf("line %s: %s%s\n", grobo_session_device(session),
           event == GROBO_SESSION_EVENT_UP ? "up, " : "", grobo_error_text(error));
}

int main(void)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = "sim",
                                          .on_robot = on_robot, .on_event = on_line};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    grobo_runner *runner;
    if (grobo_runner_new(&config, &runner) < 0) {
        return 1;
    }
    if (grobo_runner_connect(runner, 0) >= 0 && grobo_runner_init_position(runner) >= 0) {
        (void)grobo_runner_wait(runner, 0);
        (void)grobo_runner_estop(runner);
        (void)grobo_runner_wait(runner, 0);
    }
    return grobo_runner_free(runner) < 0;
}
