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
    const grobo_control_config config = {GROBO_CONTROL_CONFIG_INIT, .session = &session};
    grobo_control *control;
    if (grobo_control_new(&config, &control) < 0) {
        return 1;
    }
    if (grobo_control_connect(control, 0) >= 0 && grobo_control_init_position(control) >= 0) {
        (void)grobo_control_wait(control, 0);
        (void)grobo_control_estop(control);
        (void)grobo_control_wait(control, 0);
    }
    return grobo_control_free(control) < 0;
}
