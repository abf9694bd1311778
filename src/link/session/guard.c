/* SPDX-License-Identifier: MIT */
/* When a session gives its port to its guard, what it tells it, and what it hears. */
#include <stdio.h>
#include <string.h>

#include "src/link/guard/guard.h"
#include "src/link/serial/serial.h"
#include "src/link/session/session.h"

/* How often the loop turns while the guard knows that a joint moves: it stops one whose loop does
 * not turn for GROBO_GUARD_SILENCE_US, and is told soon when nothing moves any more. */
#define GUARD_BEAT_US INT64_C(50000)

/* Says once that the robot has no guard any more. */
static void say_unguarded(grobo_session *session, int error)
{
    if (!session->unguarded) {
        session->unguarded = true;
        grobo_i_session_say(session, GROBO_SESSION_EVENT_UNGUARDED, error);
    }
}

bool grobo_i_session_guard_hear(grobo_session *session)
{
    grobo_guard *guard = session->config.guard;

    grobo_i_guard_hear(guard);
    if (guard->ended || guard->refused) {
        (void)event_del(session->guard_news); /* a socket that is closed, or nothing to come */
        say_unguarded(session, guard->refused ? GROBO_ERR_UNSUPPORTED : GROBO_ERR_CLOSED);
    }
    return guard->taken;
}

int grobo_i_session_guard_new(grobo_session *session, event_callback_fn on_news)
{
    const grobo_session_config *config = &session->config;

    if (config->guard == NULL) {
        return GROBO_OK;
    }
    if (config->guard_bytes > GROBO_GUARD_DATA_BYTES) {
        return GROBO_ERR_CAP;
    }
    session->guard_news = event_new(config->base, config->guard->process.socket,
                                    EV_READ | EV_PERSIST, on_news, session);
    return session->guard_news != NULL && event_add(session->guard_news, NULL) == 0
               ? GROBO_OK
               : GROBO_ERR_NOMEM;
}

void grobo_i_session_guard_free(grobo_session *session)
{
    if (session->guard_news != NULL) {
        event_free(session->guard_news);
    }
}

/* An emergency stop goes before the exit policy, for the guard too. */
static guard_policy policy_of(const grobo_session *session)
{
    grobo_trip_info trip;

    grobo_robot_tripped(&session->robot, &trip);
    if (trip.trip == GROBO_TRIP_ESTOP) {
        return GUARD_ESTOP;
    }
    return session->robot.config.on_exit == GROBO_EXIT_OFF ? GUARD_OFF : GUARD_HOLD;
}

static int count_open(const grobo_session *session)
{
    int n = 0;

    for (int i = 0; i < session->n_wires; i++) {
        n += grobo_serial_is_open(session->wire[i].serial);
    }
    return n;
}

static bool all_open(const grobo_session *session)
{
    return count_open(session) == session->n_wires;
}

static bool any_open(const grobo_session *session)
{
    return count_open(session) > 0;
}

void grobo_i_session_guard_take(grobo_session *session)
{
    const grobo_session_config *config = &session->config;
    const grobo_driver *driver = session->robot.driver;
    guard_message message;

    /* A port that has just been lost is told of soon. */
    if (session->guard_news == NULL || !all_open(session)) {
        return;
    }
    memset(&message, 0, sizeof message); /* what lies between its fields goes too */
    message.magic = GUARD_MAGIC;
    message.kind = GUARD_TAKE;
    message.policy = (uint32_t)policy_of(session);
    message.connection = strcmp(session->wire[0].serial->ops->name, "tcp") == 0;
    message.data_bytes = (uint32_t)config->guard_bytes;
    message.wiring = grobo_driver_wiring(driver);
    message.robot = session->robot.config;
    (void)snprintf(message.driver, sizeof message.driver, "%s", driver->name);
    (void)snprintf(message.device, sizeof message.device, "%s", session->wire[0].used);
    for (int i = 1; i < session->n_wires; i++) {
        const grobo_serial *serial = session->wire[i].serial;

        grobo_i_guard_more(config->guard, strcmp(serial->ops->name, "tcp") == 0,
                           grobo_serial_handle(serial));
    }
    grobo_i_guard_take(config->guard, &message, config->guard_data,
                       grobo_serial_handle(session->wire[0].serial));
    if (config->guard->ended) {
        event_active(session->guard_news, EV_READ, 0);
    } else {
        for (int i = 0; i < session->n_wires; i++) {
            session->wire[i].serial->barred = &config->guard->shared->line;
        }
    }
}

void grobo_i_session_guard_release(grobo_session *session)
{
    if (session->guard_news == NULL) {
        return;
    }
    grobo_i_guard_release(session->config.guard);
    for (int i = 0; i < session->n_wires; i++) {
        grobo_serial *serial = session->wire[i].serial;

        serial->barred = NULL;
        if (session->config.guard->taken && grobo_serial_is_open(serial)) {
            grobo_i_port_abandon(serial->port);
        }
    }
}

bool grobo_i_session_guard_has_it(grobo_session *session)
{
    grobo_guard *guard = session->config.guard;

    if (session->guard_news == NULL || !any_open(session)) {
        return false;
    }
    grobo_i_guard_hear(guard);
    if (guard->taken || ((guard->ended || guard->refused) && !session->unguarded)) {
        event_active(session->guard_news, EV_READ, 0); /* told from the loop */
    }
    return guard->taken;
}

int64_t grobo_i_session_guard_deadline(const grobo_session *session)
{
    const grobo_guard *guard = session->config.guard;
    bool watched = session->guard_news != NULL && guard->has_port && guard->message.moves != 0;

    return watched ? grobo_now_us() + GUARD_BEAT_US : GROBO_NEVER_US;
}

void grobo_i_session_guard_tell(grobo_session *session)
{
    if (session->guard_news != NULL) {
        grobo_i_guard_tell(session->config.guard, policy_of(session),
                           grobo_robot_moving(&session->robot));
    }
}
