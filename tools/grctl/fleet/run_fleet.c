/* SPDX-License-Identifier: MIT */
/* `grctl fleet`: its verbs. */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <event2/util.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/fleet/leader.h"
#include "tools/grctl/fleet/run.h"
#include "tools/grctl/lang/lang.h"

enum {
    ANSWER_US = 3000000,
    READY_US = 35000000,
    STOPPED_US = 12000000,
    UNHEARD_US = 3000000, /* a stop that the broker did not take yet, where nobody is seen */
    STATE_US = 400000,
    BEFORE_US = 1500000, /* clocks are compared so long before a time that was told */
    WATCH_US = 500000,
    SILENT_US = 1500000,
    LEAD_US = 300000,
    IF_LOST_CONTINUE = 2, /* of FLEET_OPT_IF_LOST */
    TRIPS = 20            /* the start is at least so many round trips ahead */
};

/* ---- who is asked ---------------------------------------------------------------------------- */

/* The groups that agents are of, for who mistyped one: ", a, b". */
static bool name_groups(const leader *l, char *text, size_t capacity)
{
    size_t at = 0, k;
    json_t *one, *groups = json_object();
    const char *name;
    for (int i = 0; i < l->n; i++) {
        json_array_foreach(json_object_get(l->peers[i].facts, "groups"), k, one)
        {
            if (json_is_string(one) && fleet_is_name(json_string_value(one))) {
                json_object_set_new(groups, json_string_value(one), json_null());
            }
        }
    }
    bool known = json_object_get(groups, l->group) != NULL;
    *text = '\0';
    json_object_foreach(groups, name, one)
    {
        if (at + strlen(name) + sizeof ", " < capacity) {
            at += (size_t)snprintf(text + at, capacity - at, ", %s", name);
        }
    }
    json_decref(groups);
    return known;
}

/* Nobody is there to be asked; what follows from that. */
static int fail_nobody(const leader *l, const char *so)
{
    char groups[512];
    if (!name_groups(l, groups, sizeof groups) && *groups) {
        return app_fail(l->a, EXIT_ROBOT, "NOTFOUND",
                        "fleet: no agent is of group %s; there are %s%s", l->group,
                        groups + strlen(", "), so);
    }
    return l->host
               ? app_fail(l->a, EXIT_ROBOT, "NOTFOUND",
                          "fleet: no agent of group %s at %s is online%s", l->group, l->host, so)
               : app_fail(l->a, EXIT_ROBOT, "NOTFOUND", "fleet: no agent of group %s is online%s",
                          l->group, so);
}

/* ---- answers --------------------------------------------------------------------------------- */

/* Says who refused, or did not answer. The exit status. */
static int say_answers(leader *l, const char *doing)
{
    int status = EXIT_DONE;
    for (int i = 0; i < l->n; i++) {
        const peer *p = &l->peers[i];
        if (!p->chosen || json_is_true(json_object_get(p->answer, "ok"))) {
            continue;
        }
        const char *code = fleet_text(p->answer, "code"), *why = fleet_text(p->answer, "message");
        status = app_fail(l->a, EXIT_ROBOT, p->answer && code ? code : "TIMEOUT", "%s: %s: %s",
                          p->host, doing,
                          p->answer && why ? why
                          : p->gone        ? _("its agent is gone")
                                           : _("no answer"));
    }
    return status;
}

static int order(leader *l, const char *verb, json_t *body, int64_t bound_us)
{
    leader_order(l, verb, body);
    (void)leader_wait(l, bound_us, leader_answered);
    return say_answers(l, verb);
}

/* ---- list and status ------------------------------------------------------------------------- */

/* Is it asked for? Nobody knows of which groups one is that never said it. */
static bool is_shown(const leader *l, const peer *p)
{
    return *p->state && (leader_has(l, p) || (!p->facts && strcmp(l->group, FLEET_ALL) == 0 &&
                                              (!l->host || strcmp(l->host, p->host) == 0)));
}

static void list_one(const leader *l, const peer *p)
{
    size_t i;
    json_t *robot;
    const json_t *robots = json_object_get(p->facts, "robots");
    if (l->a->json) {
        app_print_json(json_pack("{s:s,s:s,s:O*,s:O*}", "host", p->host, "state", p->state,
                                 "groups", json_object_get(p->facts, "groups"), "robots", robots));
        return;
    }
    json_array_foreach(robots, i, robot)
    {
        const char *name = fleet_text(robot, "name"), *model = fleet_text(robot, "model");
        app_print_line("%-20s  %-16s  %-16s  %s", p->host, p->state, name ? name : "",
                       model && *model ? model : "-");
    }
}

static int run_list(leader *l)
{
    if (!l->a->json) {
        app_print("host                  connection        robot             model\n");
    }
    for (int i = 0; i < l->n; i++) {
        if (is_shown(l, &l->peers[i])) {
            list_one(l, &l->peers[i]);
        }
    }
    return EXIT_DONE;
}

static void show_status(const leader *l)
{
    if (!l->a->json) {
        if (app_option(l->a, FLEET_OPT_WATCH)->given) {
            app_print_home(l->a);
        }
        app_print("host                  robot             line    play          trip\n");
    }
    for (int i = 0; i < l->n; i++) {
        const peer *p = &l->peers[i];
        const char *name;
        json_t *state;
        json_object_foreach(is_shown(l, p) ? p->states : NULL, name, state)
        {
            const char *play = fleet_text(state, "play"), *trip = fleet_text(state, "trip");
            int64_t age_us = grobo_now_us() - fleet_number(state, "heard_us", 0);
            bool silent = age_us > SILENT_US, up = json_is_true(json_object_get(state, "up"));
            if (l->a->json) {
                app_print_json(json_pack("{s:s,s:s,s:b,s:s?,s:s?}", "host", p->host, "robot", name,
                                         "up", up && !silent, "play", play, "trip", trip));
            } else {
                app_print_line("%-20s  %-16s  %-6s  %-12s  %s", p->host, name,
                               silent ? "silent"
                               : up   ? "up"
                                      : "down",
                               play ? play : "-", trip ? trip : "-");
            }
        }
    }
}

static int run_status(leader *l)
{
    bool watches = app_option(l->a, FLEET_OPT_WATCH)->given > 0;
    leader_listen(l, "state");
    (void)leader_wait(l, STATE_US, NULL);
    show_status(l);
    while (watches && output_flush() && !l->link.signal) {
        (void)leader_wait(l, WATCH_US, NULL);
        show_status(l);
    }
    return watches && l->link.signal ? EXIT_SIGNAL + l->link.signal : EXIT_DONE;
}

/* ---- stops ----------------------------------------------------------------------------------- */

/* What can be heard of the stop was heard. Who is gone has nothing to say. */
static bool all_told(const leader *l)
{
    for (int i = 0; i < l->n; i++) {
        const peer *p = &l->peers[i];
        if (p->chosen && !p->gone && !p->stopped) {
            return l->stop_refused;
        }
    }
    return l->stop_taken || l->stop_refused;
}

/* Those that may have robots of which nothing was heard. */
static int say_unheard(leader *l)
{
    int status = EXIT_DONE;
    if (!l->stop_taken) {
        status = app_fail(l->a, EXIT_ROBOT, "UNREACHABLE",
                          "fleet: the broker did not take the stop: use the switches");
    }
    for (int i = 0; i < l->n; i++) {
        const peer *p = &l->peers[i];
        if (leader_is_unknown(p) && !p->stopped && (!l->host || strcmp(l->host, p->host) == 0)) {
            status = app_fail(l->a, EXIT_ROBOT, "TIMEOUT",
                              "%s: is online and never said which robots it has; nothing of it was "
                              "seen to stop: use their switches",
                              p->host);
        }
    }
    return status;
}

/* Each robot by itself: only what was read back is a success. */
static int say_stopped(leader *l)
{
    int status = say_unheard(l);
    for (int i = 0; i < l->n; i++) {
        const peer *p = &l->peers[i];
        size_t k;
        json_t *robot;
        if (p->chosen && !p->stopped) {
            status = app_fail(l->a, EXIT_ROBOT, "TIMEOUT",
                              "%s: no answer; go there and use the switch", p->host);
        }
        json_array_foreach(json_object_get(p->stopped, "robots"), k, robot)
        {
            const char *name = fleet_text(robot, "name");
            bool stopped = json_is_true(json_object_get(robot, "stopped"));
            if (!p->chosen) {
                continue;
            }
            if (l->a->json) {
                app_print_json(json_pack("{s:s,s:s,s:b,s:I}", "host", p->host, "robot",
                                         name ? name : "", "stopped", stopped, "told_us",
                                         (json_int_t)p->told_us));
            }
            if (!stopped) {
                status =
                    app_fail(l->a, EXIT_ROBOT, "BUSY", "%s/%s: NOT seen to stop; use its switch",
                             p->host, name ? name : "");
            } else {
                app_note(l->a, "%s/%s: stopped", p->host, name ? name : "");
            }
        }
    }
    if (!status) {
        app_done(l->a, "all stopped; 'grctl fleet reset' releases the stop");
    }
    return status;
}

/* The latch is out since there is a connection, see leader_open(): for agents that are not seen
 * too, but of these nobody was seen to stop. */
static int run_stop(leader *l)
{
    int n = leader_choose(l);
    (void)leader_wait(l, n > 0 ? STOPPED_US : UNHEARD_US, all_told);
    if (n == 0) {
        (void)say_unheard(l);
        return fail_nobody(l, _(": nothing was seen to stop; use the switches"));
    }
    return say_stopped(l);
}

/* The latch first, then what the engines keep. A stop that came after this command is none that it
 * may take back. */
static int run_reset(leader *l)
{
    const char *id = l->latch ? fleet_text(l->latch, "id") : NULL;
    if (id && json_is_true(json_object_get(l->latch, "stopped"))) {
        if (strcmp(id, l->stood) != 0) {
            return app_fail(l->a, EXIT_ROBOT, "STATE",
                            "fleet: another stop was given meanwhile: it stands; 'grctl fleet "
                            "reset' again releases it");
        }
        (void)leader_latch(l, NULL);
        (void)leader_wait(l, STATE_US, NULL);
    }
    if (leader_choose(l) == 0) {
        return fail_nobody(l, "");
    }
    int status = order(l, "reset", json_object(), ANSWER_US);
    if (!status) {
        app_done(l->a, "released; nothing moves");
    }
    return status;
}

/* ---- push ------------------------------------------------------------------------------------ */

static json_t *text_of(app *a, const char *path)
{
    heap text = file_bytes(path, MQTT_PAYLOAD_MAX_BYTES / 2 - 1);
    json_t *string = text.bytes ? json_stringn(text.bytes, text.size) : NULL;
    if (!string) {
        (void)app_fail(a, EXIT_FILE, "IO", "%s: a text file of less than 512 KiB is wanted", path);
    }
    free(text.bytes);
    return string;
}

static int run_push(leader *l)
{
    int status = EXIT_DONE;
    for (int i = 1; i < l->a->line.n_arguments && !status; i++) {
        const char *path = l->a->line.argument[i];
        json_t *text = text_of(l->a, path);
        if (!text) {
            return EXIT_FILE;
        }
        status = order(l, "put", json_pack("{s:s,s:o}", "file", file_last_part(path), "text", text),
                       ANSWER_US);
    }
    if (!status) {
        app_done(l->a, "done");
    }
    return status;
}

/* ---- play ------------------------------------------------------------------------------------ */

static bool any_ended(const leader *l)
{
    for (int i = 0; i < l->n; i++) {
        if (l->peers[i].chosen && l->peers[i].ended) {
            return true;
        }
    }
    return false;
}

/* All have ended, but for those of which nothing will be heard. */
static bool all_ended(const leader *l)
{
    for (int i = 0; i < l->n; i++) {
        const peer *p = &l->peers[i];
        if (p->chosen && !p->gone && !p->ended) {
            return false;
        }
    }
    return true;
}

static bool any_lost(const leader *l)
{
    return any_ended(l) || leader_lacks(l);
}

static bool all_ended_or_one_lost(const leader *l)
{
    return all_ended(l) || leader_lacks(l);
}

/* "HH:MM[:SS]", the next one, by the clock of who leads: as an instant. False: it is none. */
static bool read_time(const char *text, int64_t *at_us)
{
    int h, m, s = 0, n = 0;
    struct timeval now;
    if ((sscanf(text, "%2d:%2d%n:%2d%n", &h, &m, &n, &s, &n) < 2) || text[n] || h < 0 || h > 23 ||
        m < 0 || m > 59 || s < 0 || s > 59) {
        return false;
    }
    evutil_gettimeofday(&now, NULL);
    time_t clock = now.tv_sec;
    struct tm day = *localtime(&clock);
    day.tm_hour = h;
    day.tm_min = m;
    day.tm_sec = s;
    day.tm_isdst = -1;
    clock = mktime(&day);
    if (clock < now.tv_sec) {
        day.tm_mday++;
        day.tm_isdst = -1;
        clock = mktime(&day);
    }
    *at_us = grobo_now_us() + (int64_t)(clock - now.tv_sec) * 1000000 - now.tv_usec;
    return true;
}

static json_t *motion_of(const leader *l, const char *path)
{
    static const char *const lost[] = {"stop", "pause", "continue"};
    static const char *const on_lost[] = {"stop", "finish", "exit"};
    const app *a = l->a;
    return json_pack(
        "{s:s,s:s,s:i,s:i,s:b,s:s,s:s,s:I}", "group", l->group, "file", file_last_part(path),
        "speed_pct", (int)app_number(a, FLEET_OPT_SPEED, 100), "repeat",
        (int)app_number(a, FLEET_OPT_REPEAT, 1), "mirror",
        app_option(a, FLEET_OPT_MIRROR)->given > 0, "if_lost",
        lost[app_option(a, FLEET_OPT_IF_LOST)->given ? app_option(a, FLEET_OPT_IF_LOST)->choice
                                                     : 0],
        "on_link_lost",
        on_lost[app_option(a, FLEET_OPT_ON_LOST)->given ? app_option(a, FLEET_OPT_ON_LOST)->choice
                                                        : 0],
        "spread_us", (json_int_t)(app_number(a, FLEET_OPT_SPREAD, 5) * 1000));
}

static int64_t slowest_us(const leader *l)
{
    int64_t slowest = 0;
    for (int i = 0; i < l->n; i++) {
        const peer *p = &l->peers[i];
        slowest = p->chosen && p->took_us > slowest ? p->took_us : slowest;
    }
    return slowest;
}

static int say_ended(leader *l)
{
    int status = EXIT_DONE;
    for (int i = 0; i < l->n; i++) {
        const peer *p = &l->peers[i];
        size_t k;
        json_t *robot;
        if (p->chosen && !p->ended) {
            status = p->gone
                         ? app_fail(l->a, EXIT_ROBOT, "UNREACHABLE",
                                    "%s: its agent went away in the motion; see what its robots "
                                    "do, or use their switches",
                                    p->host)
                         : app_fail(l->a, EXIT_ROBOT, "TIMEOUT", "%s: does not say how it ended",
                                    p->host);
        }
        json_array_foreach(json_object_get(p->ended, "robots"), k, robot)
        {
            const char *name = fleet_text(robot, "name"), *why = fleet_text(robot, "message");
            bool ok = json_is_true(json_object_get(robot, "ok"));
            if (l->a->json) {
                app_print_json(json_pack("{s:s,s:s,s:b,s:s,s:O*,s:O*}", "host", p->host, "robot",
                                         name ? name : "", "ok", ok, "message", why ? why : "",
                                         "late_us", json_object_get(robot, "late_us"), "bound_us",
                                         json_object_get(p->answer, "bound_us")));
            } else if (ok) {
                app_print_line("%s/%s: played", p->host, name ? name : "");
            } else {
                status = app_fail(l->a, EXIT_ROBOT, "CANCELED", "%s/%s: %s", p->host,
                                  name ? name : "", why ? why : "");
            }
            status = ok || status ? status : EXIT_ROBOT;
        }
    }
    return status;
}

static int call_off(leader *l, int status)
{
    leader_order(l, "abort", json_object());
    l->link.signal = 0;
    (void)leader_wait(l, ANSWER_US, leader_answered);
    return status;
}

/* All stand at the first posture: until just before the time. */
static void wait_for_time(leader *l, int64_t at_us)
{
    int64_t rest_us = at_us - grobo_now_us() - BEFORE_US;
    if (rest_us > 0) {
        app_note(l->a, "all are ready; they begin in %.1f s", (double)(rest_us + BEFORE_US) / 1e6);
        (void)leader_wait(l, rest_us, any_lost);
    }
}

/* They stand and wait: tells them one time, 0: as soon as all hear of it. */
static int set_off(leader *l, int64_t at_us)
{
    /* The answers to `prepare` waited for robots: a round trip is measured by another order. */
    leader_order(l, "ping", json_object());
    (void)leader_wait(l, ANSWER_US, leader_answered);
    if (leader_lacks(l)) { /* before anybody begins without it */
        return say_answers(l, "start");
    }
    int64_t ahead_us = TRIPS * slowest_us(l) > LEAD_US ? TRIPS * slowest_us(l) : LEAD_US;
    int64_t soonest_us = grobo_now_us() + ahead_us;
    if (at_us && at_us < soonest_us) {
        return app_fail(l->a, EXIT_ROBOT, "STALE", "fleet: that time is over");
    }
    at_us = at_us ? at_us : soonest_us;
    int status = order(l, "start", json_pack("{s:I}", "at_us", (json_int_t)at_us), ANSWER_US);
    if (!status) {
        app_note(l->a, "all begin in %.1f s", (double)(at_us - grobo_now_us()) / 1e6);
    }
    return status;
}

static int fail_lost(leader *l)
{
    return app_fail(l->a, EXIT_ROBOT, "UNREACHABLE",
                    "fleet: the broker is lost: the robots act by --on-link-lost");
}

/* To the end of what they play. An agent that goes away is a robot that is lost. */
static int see_through(leader *l)
{
    const cli_value *if_lost = app_option(l->a, FLEET_OPT_IF_LOST);
    bool goes_on = if_lost->given && if_lost->choice == IF_LOST_CONTINUE;
    bool (*const done)(const leader *) = goes_on ? all_ended : all_ended_or_one_lost;
    while (!leader_wait(l, 3600000000, done) && !l->link.signal && !l->lost) {
        continue;
    }
    int signal = l->link.signal;
    if (signal || (!l->lost && !all_ended(l))) {
        (void)call_off(l, 0);
        (void)leader_wait(l, ANSWER_US, all_ended);
    }
    if (l->lost) {
        return fail_lost(l);
    }
    int status = say_ended(l);
    return signal ? EXIT_SIGNAL + signal : status;
}

/* at_us: when they are to begin, 0: as soon as all are ready. */
static int play(leader *l, const char *path, int64_t at_us)
{
    int status = order(l, "prepare", motion_of(l, path), READY_US);
    if (at_us && !status && !l->link.signal && !l->lost) {
        wait_for_time(l, at_us);
    }
    int signal = l->link.signal;
    if (l->lost) {
        return fail_lost(l);
    }
    if (status || signal) {
        return call_off(l, signal ? EXIT_SIGNAL + signal : status);
    }
    status = set_off(l, at_us);
    return status ? call_off(l, status) : see_through(l);
}

/* One after the other; the time is that of the first. */
static int run_play(leader *l)
{
    const cli_value *time = app_option(l->a, FLEET_OPT_AT);
    int64_t at_us = 0;
    int status = EXIT_DONE;
    if (time->given && !read_time(time->text, &at_us)) {
        return app_fail(l->a, EXIT_USAGE, "ARG", "--at '%s': HH:MM or HH:MM:SS is wanted",
                        time->text);
    }
    l->permits = true;
    for (int i = 1; i < l->a->line.n_arguments && !status; i++) {
        status = play(l, l->a->line.argument[i], i == 1 ? at_us : 0);
    }
    return status;
}

/* ---- log ------------------------------------------------------------------------------------- */

static void say_event(leader *l, const peer *p, json_t *event)
{
    const char *robot = fleet_text(event, "robot"), *kind = fleet_text(event, "kind");
    const char *text = fleet_text(event, "message");
    if (l->a->json) {
        app_print_json(json_pack("{s:s,s:s?,s:s,s:s?}", "host", p->host, "robot", robot, "kind",
                                 kind ? kind : "", "message", text));
    } else {
        app_print_line("%s%s%s: %s %s", p->host, robot ? "/" : "", robot ? robot : "",
                       kind ? kind : "", text ? text : "");
    }
    output_flush();
}

static bool is_up(const leader *l)
{
    return l->up;
}

static bool is_away(const leader *l)
{
    return !l->up;
}

/* Nothing is heard while the broker is away: that is told. */
static int run_log(leader *l)
{
    l->on_event = say_event;
    while (!l->link.signal) {
        if (leader_wait(l, 3600000000, is_away)) {
            app_note(l->a, "the broker is away: %s", l->why);
            (void)leader_wait(l, 3600000000, is_up);
        }
    }
    return EXIT_SIGNAL + l->link.signal;
}

/* ---- the command ----------------------------------------------------------------------------- */

static const struct {
    const char *word;
    int (*run)(leader *l);
    bool asks; /* for files, and agents must be there */
} verbs[] = {{"list", run_list, false}, {"status", run_status, false}, {"play", run_play, true},
             {"stop", run_stop, false}, {"estop", run_stop, false},    {"reset", run_reset, false},
             {"push", run_push, true},  {"log", run_log, false}};

/* "all" where somebody meant a group: what is not asked for is a mistake. 0, or the status. */
static int check_files(app *a, bool asks)
{
    const char *verb = a->line.argument[0], *extra = a->line.argument[1];
    if (asks && a->line.n_arguments < 2) {
        return app_fail(a, EXIT_USAGE, "ARG", "fleet %s needs FILE...; see 'grctl help fleet'",
                        verb);
    }
    if (!asks && a->line.n_arguments > 1) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "fleet %s: '%s' is one argument too many; a group is --group %s", verb,
                        extra, extra);
    }
    return 0;
}

/* The verb and the names of the line: 0, or the status. */
static int check_line(app *a, size_t *verb)
{
    const cli_value *group = app_option(a, FLEET_OPT_GROUP), *host = app_option(a, FLEET_OPT_HOST);
    size_t v = 0;
    while (v < sizeof verbs / sizeof verbs[0] && strcmp(verbs[v].word, a->line.argument[0]) != 0) {
        v++;
    }
    if (v == sizeof verbs / sizeof verbs[0]) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "fleet %s: there are list, status, play, stop, estop, reset, push, log",
                        a->line.argument[0]);
    }
    *verb = v;
    if ((group->given && !fleet_is_name(group->text)) ||
        (host->given && !fleet_is_name(host->text))) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "fleet: letters, digits, _ and - in the name of a group or a host");
    }
    return 0;
}

int fleet_run(app *a)
{
    static leader l;
    static broker b;
    const cli_value *group = app_option(a, FLEET_OPT_GROUP), *host = app_option(a, FLEET_OPT_HOST);
    size_t v = 0;
    int status = check_line(a, &v);
    if (status) {
        return status;
    }
    bool stops = verbs[v].run == run_stop; /* they stop first */
    status = stops ? 0 : check_files(a, verbs[v].asks);
    status = status ? status : broker_read(&b, a);
    if (status) {
        return status;
    }
    status = leader_begin(&l, a, &b.config, group->given ? group->text : FLEET_ALL,
                          host->given ? host->text : NULL, stops ? verbs[v].word : NULL);
    if (!status) {
        int n = leader_choose(&l);
        status = verbs[v].asks && n == 0 ? fail_nobody(&l, "") : verbs[v].run(&l);
    }
    leader_end(&l);
    int late = stops ? check_files(a, false) : 0;
    return status ? status : late;
}
