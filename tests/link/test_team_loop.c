/* SPDX-License-Identifier: MIT */
/* 64 robots on one loop begin a motion together: within a millisecond where the machine is free. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <event2/event.h>

#include <grobo/core/loop.h>
#include <grobo/core/port.h>
#include <grobo/core/team.h>
#include <grobo/session.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

enum { N = 64, MOTION = 110, BOUND_US = 60000000 };

typedef struct seat {
    grobo_session *session;
    int member;
    bool up;
    int64_t began_us; /* when the first frame of the motion left */
} seat;

static struct event_base *base;
static struct event *timer;
static seat seats[N];
static grobo_team *team;
static int64_t start_us;
static int out;

static void look(void)
{
    int64_t now_us = grobo_now_us();
    int64_t at_us = grobo_team_step(team, now_us);
    if (at_us != GROBO_NEVER_US) {
        int64_t rest_us = at_us > now_us ? at_us - now_us : 0;
        const struct timeval rest = {rest_us / 1000000, rest_us % 1000000};
        (void)evtimer_add(timer, &rest);
    }
}

static void on_timer(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    (void)ctx;
    look();
}

static void on_line(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    (void)session;
    assert_int_equal(error, GROBO_OK);
    ((seat *)ctx)->up = event == GROBO_SESSION_EVENT_UP;
}

static void on_robot(void *ctx, const grobo_event *event)
{
    grobo_team_event(team, ((seat *)ctx)->member, event);
    if (event->kind != GROBO_EVENT_JOINT) {
        look();
    }
}

static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    seat *s = ctx;
    (void)bytes;
    if (direction == GROBO_DIR_TX && size == MOTION && start_us > 0 && now_us >= start_us &&
        s->began_us == 0) {
        s->began_us = now_us;
    }
}

static void on_team(void *ctx, const grobo_team_event_info *event)
{
    (void)ctx;
    out += event->kind == GROBO_TEAM_EVENT_OUT;
    if (event->kind == GROBO_TEAM_EVENT_START) {
        start_us = event->at_us;
    }
}

static bool all_up(void)
{
    for (int i = 0; i < N; i++) {
        if (!seats[i].up) {
            return false;
        }
    }
    return true;
}

static void begin(void)
{
    const grobo_team_config config = {GROBO_TEAM_CONFIG_INIT, .on_event = on_team};
    static const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT};
    base = grobo_loop_new();
    assert_non_null(base);
    timer = evtimer_new(base, on_timer, NULL);
    assert_int_equal(grobo_team_new(&config, &team), GROBO_OK);
    for (int i = 0; i < N; i++) {
        const grobo_session_config session = {
            GROBO_SESSION_CONFIG_INIT, .base = base,     .device = GROBO_DEVICE_SIM,
            .baud_bps = 460800,        .robot = &robot,  .on_event = on_line,
            .on_robot = on_robot,      .on_tap = on_tap, .ctx = &seats[i]};
        assert_int_equal(grobo_session_new(&session, &seats[i].session), GROBO_OK);
        seats[i].member = grobo_team_add(team, grobo_session_robot(seats[i].session));
        assert_int_equal(seats[i].member, i);
        assert_int_equal(grobo_session_open(seats[i].session), GROBO_OK);
    }
    int64_t until_us = grobo_now_us() + BOUND_US;
    while (!all_up()) {
        assert_true(grobo_now_us() < until_us);
        assert_int_equal(event_base_loop(base, EVLOOP_ONCE), 0);
    }
}

static void end(void)
{
    for (int i = 0; i < N; i++) {
        grobo_session_free(seats[i].session);
    }
    grobo_team_free(team);
    event_free(timer);
    event_base_free(base);
}

static int by_size(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

TEST(sixty_four_robots_begin_together)
{
    static const rig_key nod[] = {{0, {{NECK, 0}}}, {400, {{NECK, 20}}}, {800, {{NECK, 0}}}};
    static rig_clip clip;
    int64_t late_us[N];
    begin();
    rig_clip_init(&clip, nod, 3);
    const grobo_clip *one = &clip.clip;
    assert_int_equal(grobo_team_play(team, &one, true, NULL, grobo_now_us()), GROBO_OK);
    look();
    int64_t until_us = grobo_now_us() + BOUND_US;
    while (grobo_team_get_state(team) != GROBO_TEAM_ENDED) {
        assert_true(grobo_now_us() < until_us);
        assert_int_equal(event_base_loop(base, EVLOOP_ONCE), 0);
    }
    assert_int_equal(out, 0);
    for (int i = 0; i < N; i++) {
        grobo_team_member member;
        assert_int_equal(grobo_team_get(team, i, &member), GROBO_OK);
        assert_int_equal(member.result, GROBO_OK);
        assert_true(seats[i].began_us >= start_us);
        late_us[i] = seats[i].began_us - start_us;
    }
    qsort(late_us, N, sizeof late_us[0], by_size);
    print_message("# first frames of %d robots: %lld to %lld us behind the start\n", N,
                  (long long)late_us[0], (long long)late_us[N - 1]);
    end();
}
