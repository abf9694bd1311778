/* SPDX-License-Identifier: MIT */
/*
 * Requests to stop: those that any thread and any signal handler may make, and the emergency stops
 * of other programs (grobo/estop.h).
 *
 * `asked` is one atomic word: a bit for each kind of request that the loop has not looked at. The
 * poster sets it and writes a byte to the wake-up socket. The loop takes the bits in
 * grobo_i_session_obey(), which every way out of the session passes before bytes leave;
 * grobo_i_session_send() sends nothing while a bit is set. So the first frame after a request is
 * the stop, wherever the loop was.
 *
 * An exit waits in `exit_owed` while an emergency stop is carried out. An emergency stop without a
 * line is the engine's to keep (grobo_robot_estop()).
 */
#include <errno.h>

#include <grobo/core/robot.h>

#include "src/link/session/session.h"
#include "src/robot/query.h"

_Static_assert(ATOMIC_INT_LOCK_FREE == 2 && ATOMIC_BOOL_LOCK_FREE == 2,
               "a signal handler may use what is lock-free only");
_Static_assert(GROBO_EXIT_SIT <= 3, "an exit policy has two bits");

/* The bits of `asked`. */
enum {
    ASK_ESTOP = 1,
    ASK_STOP = 2,
    ASK_STOP_AT_ONCE = 4,
    ASK_EXIT = 8,
    ASK_POLICY_SHIFT = 4,
    ASK_POLICY = 3 << ASK_POLICY_SHIFT
};

/* ---- any thread, signal handlers ---------------------------------------------------------- */

void grobo_i_session_wake(grobo_session *session)
{
    int kept = errno;

    /* A full socket has bytes enough to wake the loop. */
    (void)send(session->wake_socket[1], "", 1, 0);
    errno = kept;
}

static int ask(grobo_session *session, unsigned what, unsigned instead_of)
{
    unsigned old = atomic_load(&session->asked);

    while (!atomic_compare_exchange_weak(&session->asked, &old, (old & ~instead_of) | what)) {
    }
    grobo_i_session_wake(session);
    return GROBO_OK;
}

int grobo_session_post_estop(grobo_session *session)
{
    if (session == NULL) {
        return GROBO_ERR_ARG;
    }
    atomic_fetch_add(&session->estops, 1);
    return ask(session, ASK_ESTOP, 0);
}

int grobo_session_post_stop(grobo_session *session, bool at_once)
{
    return session != NULL ? ask(session, at_once ? ASK_STOP_AT_ONCE : ASK_STOP, 0) : GROBO_ERR_ARG;
}

int grobo_session_post_exit(grobo_session *session, grobo_exit_policy policy)
{
    if (session == NULL || (unsigned)policy > GROBO_EXIT_SIT) {
        return GROBO_ERR_ARG;
    }
    return ask(session, ASK_EXIT | (unsigned)policy << ASK_POLICY_SHIFT, ASK_POLICY);
}

bool grobo_session_is_latched(const grobo_session *session)
{
    if (session == NULL) {
        return false;
    }
    /* In this order: take() clears the bit when `latched` is set. */
    return (atomic_load(&session->asked) & ASK_ESTOP) != 0 || atomic_load(&session->latched);
}

bool grobo_i_session_has_asked(const grobo_session *session)
{
    return atomic_load(&session->asked) != 0;
}

/* ---- on the loop -------------------------------------------------------------------------- */

void grobo_i_session_note_latch(grobo_session *session)
{
    grobo_i_lock(&session->robot);
    bool latched = session->robot.trip.latched;
    grobo_i_unlock(&session->robot);

    if (atomic_load(&session->latched) != latched) { /* to store costs more, each transaction */
        atomic_store(&session->latched, latched);
    }
}

/* Takes the bits. */
static unsigned take(grobo_session *session)
{
    unsigned asked = atomic_load(&session->asked);

    if (asked == 0) {
        return 0;
    }
    do {
        if ((asked & ASK_ESTOP) != 0) {
            atomic_store(&session->latched, true);
        }
    } while (!atomic_compare_exchange_weak(&session->asked, &asked, 0));
    return asked;
}

static void exit_when_due(grobo_session *session)
{
    bool up = session->state == GROBO_SESSION_UP;

    if (session->exit_owed && !(up && grobo_robot_job(&session->robot) == GROBO_JOB_ESTOP)) {
        session->exit_owed = false;
        if (up) {
            /* Its end is a job event. Cannot be refused: the policy has been checked. */
            (void)grobo_robot_exit(&session->robot, session->exit_policy);
        }
    }
}

/* One that is being carried out serves for both: begun anew each time, it would never end. */
static int estop(grobo_session *session)
{
    int r = GROBO_OK;

    if (grobo_robot_job(&session->robot) != GROBO_JOB_ESTOP) {
        atomic_store(&session->obeying, true);
        r = grobo_robot_estop(&session->robot);
        atomic_store(&session->obeying, false);
    }
    return r;
}

void grobo_i_session_obey(grobo_session *session)
{
    unsigned asked = take(session);

    if ((asked & ASK_ESTOP) != 0) {
        (void)estop(session);
    } else if ((asked & (ASK_STOP | ASK_STOP_AT_ONCE)) != 0 && session->state == GROBO_SESSION_UP) {
        (void)grobo_robot_stop(&session->robot, (asked & ASK_STOP_AT_ONCE) != 0);
    }
    if ((asked & ASK_EXIT) != 0) {
        session->exit_owed = true;
        session->exit_policy = (grobo_exit_policy)((asked & ASK_POLICY) >> ASK_POLICY_SHIFT);
    }
    if (asked != 0) { /* what take() noted may have been refused */
        grobo_i_session_note_latch(session);
    }
    exit_when_due(session);
}

void grobo_i_session_attend(grobo_session *session)
{
    if (grobo_i_session_has_asked(session) || session->slow.count > 0) {
        grobo_i_session_enter(session);
        grobo_i_session_obey(session);
        grobo_i_session_leave(session);
    }
}

static void on_wake(evutil_socket_t socket, short what, void *ctx)
{
    grobo_session *session = ctx;
    char bytes[64];

    (void)what;
    while (recv(socket, bytes, sizeof bytes, 0) == (int)sizeof bytes) {
    }
    if (session->untimed) {
        session->on_time(session);
        return;
    }
    grobo_i_session_enter(session);
    grobo_i_session_leave(session); /* obeys, and sends what was asked for */
}

/* ---- of other programs -------------------------------------------------------------------- */

static void watch_no_more(grobo_session *session)
{
    if (session->mark_event != NULL) {
        event_free(session->mark_event);
    }
    session->mark_event = NULL;
    grobo_i_note_watch_close(session->mark_socket);
    session->mark_socket = GROBO_SOCKET_NULL;
}

static void watch(grobo_session *session);

static void on_marks(evutil_socket_t socket, short what, void *ctx)
{
    grobo_session *session = ctx;
    grobo_i_note_news news = grobo_i_note_watch_read(socket, GROBO_I_ESTOP_MARK);

    (void)what;
    if (news == NOTE_NEWS_NONE) {
        return;
    }
    if (news == NOTE_NEWS_GONE) {
        watch(session);
    }
    grobo_i_session_estop_look_anew(session);
    grobo_i_session_enter(session);
    grobo_i_session_leave(session); /* looks, and sets the timer */
}

/* Has the system tell of marks, as far as it can. */
static void watch(grobo_session *session)
{
    watch_no_more(session);
    session->mark_socket = grobo_i_note_watch_open();
    if (session->mark_socket != GROBO_SOCKET_NULL) {
        session->mark_event = event_new(session->config.base, session->mark_socket,
                                        EV_READ | EV_PERSIST, on_marks, session);
        if (session->mark_event == NULL || event_add(session->mark_event, NULL) != 0) {
            watch_no_more(session);
        }
    }
}

void grobo_i_session_estop_begin(session_wire *wire, const char *device)
{
    if (wire->estop.on && !wire->session->was_up) { /* the port before it, of a scan */
        grobo_i_estop_watch_end(&wire->estop);
    }
    grobo_i_estop_watch_begin(&wire->estop, device);
    watch(wire->session); /* behind the first note, for which the directories are made */
}

void grobo_i_session_estop_end(grobo_session *session)
{
    watch_no_more(session);
    for (int i = 0; i < session->n_wires; i++) {
        grobo_i_estop_watch_end(&session->wire[i].estop);
    }
}

static void obey_mark(session_wire *wire)
{
    int r = estop(wire->session);

    wire->estop.say = GROBO_ESTOP_HEARD;
    if (r < 0 && r != GROBO_ERR_CLOSED) { /* latched, but the driver has no way to stop */
        wire->estop.say = GROBO_ESTOP_FAILED;
        wire->estop.result = r;
    }
}

static void arm(session_wire *wire)
{
    bool pending = false;

    if (!wire->estop.on || wire->estop.armed) {
        return;
    }
    wire->estop.armed = true;
    if (!grobo_i_estop_watch_look(&wire->estop, &pending)) {
        return;
    }
    if (pending) {
        obey_mark(wire);
    } else {
        (void)grobo_robot_latch(&wire->session->robot);
    }
}

void grobo_i_session_estop_arm(grobo_session *session)
{
    for (int i = 0; i < session->n_wires; i++) {
        arm(&session->wire[i]);
    }
}

static bool is_old(const session_wire *wire, int64_t now_us)
{
    return wire->estop.armed && now_us >= wire->estop.looked_us + GROBO_ESTOP_WATCH_US;
}

bool grobo_i_session_estop_old(const grobo_session *session, int64_t now_us)
{
    bool old = false;

    for (int i = 0; i < session->n_wires && !old; i++) {
        old = is_old(&session->wire[i], now_us);
    }
    return old;
}

int64_t grobo_i_session_estop_deadline(const grobo_session *session)
{
    int64_t at_us = GROBO_NEVER_US;

    for (int i = 0; i < session->n_wires && session->mark_event == NULL; i++) {
        const grobo_i_estop_watch *own = &session->wire[i].estop;
        int64_t own_us = own->looked_us + GROBO_ESTOP_WATCH_US;

        at_us = own->armed && own_us < at_us ? own_us : at_us;
    }
    return at_us;
}

/* A mark of one line's device stops the whole robot. */
void grobo_i_session_estop_look(grobo_session *session)
{
    for (int i = 0; i < session->n_wires; i++) {
        session_wire *wire = &session->wire[i];
        bool pending = false;

        if (!is_old(wire, grobo_i_session_now(session))) {
            continue;
        }
        bool looked = grobo_i_estop_watch_look(&wire->estop, &pending);

        session->turn_us = 0; /* a file system may take its time */
        if (looked) {
            obey_mark(wire);
        }
    }
}

void grobo_i_session_estop_look_anew(grobo_session *session)
{
    for (int i = 0; i < session->n_wires; i++) {
        session->wire[i].estop.looked_us = 0;
    }
}

void grobo_i_session_estop_answer(grobo_session *session)
{
    for (int i = 0; i < session->n_wires; i++) {
        grobo_i_estop_watch_answer(&session->wire[i].estop);
    }
}

int grobo_i_session_estop_clear(grobo_session *session)
{
    int r = GROBO_OK;

    for (int i = 0; i < session->n_wires && r >= 0; i++) {
        grobo_i_estop_watch *own = &session->wire[i].estop;

        r = own->on ? grobo_i_estop_watch_clear(own, &session->cause) : GROBO_OK;
    }
    return r;
}

void grobo_i_session_estop_ended(grobo_session *session, int result)
{
    /* Another one took its place, or the line went: it is carried out later. */
    if (result == GROBO_ERR_CANCELED || result == GROBO_ERR_UNPLUGGED) {
        return;
    }
    for (int i = 0; i < session->n_wires; i++) {
        grobo_i_estop_watch *own = &session->wire[i].estop;

        own->say = result < 0 ? GROBO_ESTOP_FAILED : GROBO_ESTOP_DONE;
        own->result = result;
    }
}

/* ---- making and freeing ------------------------------------------------------------------- */

int grobo_i_session_pair_new(grobo_socket pair[2])
{
    evutil_socket_t made[2];

    /* libevent takes AF_UNIX for a local pair on every system. */
    if (grobo_port_start() < 0 || evutil_socketpair(AF_UNIX, SOCK_STREAM, 0, made) != 0) {
        return GROBO_ERR_NOMEM;
    }
    for (int i = 0; i < 2; i++) {
        pair[i] = made[i];
    }
    for (int i = 0; i < 2; i++) {
        if (evutil_make_socket_nonblocking(made[i]) != 0 ||
            evutil_make_socket_closeonexec(made[i]) != 0) {
            return GROBO_ERR_NOMEM;
        }
    }
    return GROBO_OK;
}

void grobo_i_session_pair_free(const grobo_socket pair[2])
{
    for (int i = 0; i < 2; i++) {
        if (pair[i] != GROBO_SOCKET_NULL) {
            evutil_closesocket(pair[i]);
        }
    }
}

int grobo_i_session_listen(grobo_session *session, bool always)
{
    session->always_listens = session->always_listens || always;
    return event_add(session->wake, NULL) == 0 ? GROBO_OK : GROBO_ERR_NOMEM;
}

void grobo_i_session_rest(grobo_session *session)
{
    if (!session->always_listens) {
        (void)event_del(session->wake);
    }
}

int grobo_i_session_wake_new(grobo_session *session)
{
    int r = grobo_i_session_pair_new(session->wake_socket);

    if (r >= 0) {
        session->wake = event_new(session->config.base, session->wake_socket[0],
                                  EV_READ | EV_PERSIST, on_wake, session);
        r = session->wake != NULL ? GROBO_OK : GROBO_ERR_NOMEM;
    }
    return r;
}

void grobo_i_session_wake_free(grobo_session *session)
{
    if (session->wake != NULL) {
        event_free(session->wake);
    }
    grobo_i_session_pair_free(session->wake_socket);
}
