/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/files.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/fleet/orders.h"
#include "tools/grctl/fleet/say.h"
#include "tools/grctl/fleet/wire.h"

enum { PENDING_US = 1000000, MOTION_NAME_BYTES = 128, WORDS = 16 };

static void answer(agent *g, const agent_order *order, const char *code, const char *message)
{
    say_answer(g, order, code, message, NULL);
}

static void drop(agent_order *order)
{
    json_decref(order->is.body);
    memset(order, 0, sizeof *order);
}

/* ---- their clock ----------------------------------------------------------------------------- */

/* Of a sender; the one that was used longest ago makes way. */
static agent_leader *leader_of(agent *g, const char *id)
{
    agent_leader *oldest = &g->leaders[0];
    for (int i = 0; i < AGENT_LEADERS; i++) {
        agent_leader *l = &g->leaders[i];
        if (strcmp(l->id, id) == 0) {
            l->used_us = grobo_now_us();
            return l;
        }
        oldest = l->used_us < oldest->used_us ? l : oldest;
    }
    memset(oldest, 0, sizeof *oldest);
    snprintf(oldest->id, sizeof oldest->id, "%s", id);
    oldest->used_us = grobo_now_us();
    return oldest;
}

static bool is_fresh(const agent_leader *l, int64_t now_us)
{
    return l->clock.n > 0 &&
           now_us - l->clock.at_us[(l->clock.n - 1) % FLEET_CLOCK_SAMPLES] < AGENT_CLOCK_AGE_US;
}

static void ask_time(agent *g, agent_leader *l, int number)
{
    l->sent_us[number] = grobo_now_us();
    (void)wire_tell(g->m, "time", l->id, "ping",
                    json_pack("{s:i,s:s,s:i}", "v", FLEET_VERSION, "host", g->host, "n", number),
                    WIRE_ONCE);
}

/* ---- judging --------------------------------------------------------------------------------- */

/* By the clock of who sent it, once that is known. */
static void judge(agent *g, agent_order *order)
{
    const agent_leader *l = leader_of(g, order->is.from);
    int64_t now_us = grobo_now_us(), offset_us, bound_us;
    if (order->timed || !is_fresh(l, now_us) ||
        !fleet_clock_read(&l->clock, now_us, &offset_us, &bound_us)) {
        return;
    }
    const char *why = fleet_order_judge(&order->is, g->epoch, now_us + offset_us);
    if (why) {
        answer(g, order, "stale", why);
        drop(order);
        return;
    }
    order->timed = true;
}

void orders_take_time(agent *g, const mqtt_message *message)
{
    json_t *pong = fleet_read(message->payload, message->size);
    const char *from = pong ? fleet_text(pong, "leader") : NULL;
    int64_t number = pong ? fleet_number(pong, "n", -1) : -1;
    int64_t theirs_us = pong ? fleet_number(pong, "t_us", -1) : -1;
    for (int i = 0; from && i < AGENT_LEADERS; i++) {
        agent_leader *l = &g->leaders[i];
        bool asked = number >= 0 && number < FLEET_CLOCK_SAMPLES && theirs_us >= 0 &&
                     strcmp(l->id, from) == 0 && l->sent_us[number] > 0;
        if (asked) {
            fleet_clock_add(&l->clock, l->sent_us[number], theirs_us, grobo_now_us());
            l->sent_us[number] = 0;
            if (number + 1 < FLEET_CLOCK_SAMPLES) {
                ask_time(g, l, (int)number + 1);
                json_decref(pong);
                return;
            }
        }
    }
    json_decref(pong);
    for (int i = 0; i < AGENT_PENDING; i++) {
        if (g->orders[i].used) {
            judge(g, &g->orders[i]);
        }
    }
}

/* ---- taking ---------------------------------------------------------------------------------- */

/* An answer goes to the branch of who asks and nowhere else. */
static bool take_response(agent_order *order, const mqtt_message *message)
{
    char part[4][FLEET_NAME_BYTES];
    if (!message->response || strlen(message->response) >= sizeof order->response ||
        message->correlation_bytes > sizeof order->correlation) {
        return false;
    }
    int n = fleet_parts(message->response, part);
    if (n != 2 || strcmp(part[0], "ack") != 0 || strcmp(part[1], order->is.from) != 0) {
        return false;
    }
    snprintf(order->response, sizeof order->response, "%s", message->response);
    if (message->correlation_bytes) {
        memcpy(order->correlation, message->correlation, message->correlation_bytes);
    }
    order->correlation_bytes = message->correlation_bytes;
    return true;
}

/* What was done before is answered again, and not done again. */
static bool is_known(agent *g, const agent_order *order)
{
    const char *before = fleet_seen_find(&g->seen, order->is.id);
    if (before && *before) {
        say_again(g, order, before);
    }
    return before != NULL;
}

static agent_order *free_place(agent *g)
{
    for (int i = 0; i < AGENT_PENDING; i++) {
        if (!g->orders[i].used) {
            return &g->orders[i];
        }
    }
    return NULL;
}

void orders_take(agent *g, const char *verb, const mqtt_message *message)
{
    agent_order order = {.used = true, .came_us = grobo_now_us()};
    const char *why = "it is no object of version 1";
    json_t *body = fleet_read(message->payload, message->size);
    if (!body || !fleet_order_read(&order.is, verb, body, &why) ||
        !take_response(&order, message)) {
        say_event(g, NULL, "refused", why ? why : "its answer would go elsewhere");
        json_decref(body);
        return;
    }
    if (strcmp(order.is.epoch, g->epoch) != 0) {
        answer(g, &order, "stale", "it is for another life of this agent");
        json_decref(body);
        return;
    }
    if (is_known(g, &order)) {
        json_decref(body);
        return;
    }
    fleet_seen_begin(&g->seen, order.is.id);
    agent_order *place = free_place(g);
    if (!place) {
        answer(g, &order, "full", "too many orders wait");
        json_decref(body);
        return;
    }
    order.number = ++g->taken;
    *place = order;
    agent_leader *l = leader_of(g, order.is.from);
    if (is_fresh(l, grobo_now_us())) {
        judge(g, place);
    } else {
        ask_time(g, l, 0);
    }
}

void orders_age(agent *g, int64_t now_us)
{
    for (int i = 0; i < AGENT_PENDING; i++) {
        agent_order *order = &g->orders[i];
        if (order->used && !order->timed && now_us - order->came_us > PENDING_US) {
            answer(g, order, "stale", "the clock of its sender is not known");
            drop(order);
        }
    }
}

void orders_forget(agent *g)
{
    for (int i = 0; i < AGENT_PENDING; i++) {
        if (g->orders[i].used) {
            drop(&g->orders[i]);
        }
    }
}

/* ---- prepare --------------------------------------------------------------------------------- */

/* A name of the folder, and nothing that leads out of it. */
static bool is_motion_name(const char *name)
{
    static const char ok[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
    size_t length = name ? strlen(name) : 0;
    return length > 0 && length < MOTION_NAME_BYTES && *name != '.' && strspn(name, ok) == length;
}

/* The line of `play` that the order asks for: its words live in the buffers. */
typedef struct words {
    char text[WORDS][CONFIG_PATH_BYTES];
    char *argv[WORDS];
    int n;
} words;

static void add(words *w, const char *text)
{
    snprintf(w->text[w->n], sizeof w->text[0], "%s", text);
    w->argv[w->n] = w->text[w->n];
    w->n++;
}

static void add_number(words *w, const json_t *body, const char *key, const char *option)
{
    const json_t *value = json_object_get(body, key);
    if (json_is_number(value)) {
        char text[32];
        snprintf(text, sizeof text, "%.12g", json_number_value(value));
        add(w, option);
        add(w, text);
    }
}

static void line_of(words *w, const agent *g, const json_t *body)
{
    char path[CONFIG_PATH_BYTES];
    snprintf(path, sizeof path, "%s/%s", g->motions, fleet_text(body, "file"));
    w->n = 0;
    add(w, "grctl");
    add(w, "play");
    add_number(w, body, "speed_pct", "--speed");
    add_number(w, body, "repeat", "--repeat");
    add_number(w, body, "rate_hz", "--rate");
    if (json_is_true(json_object_get(body, "mirror"))) {
        add(w, "--mirror");
    }
    add(w, "--");
    add(w, path);
}

/* The order's line, with the robot's own global options. */
static bool parse(seat *s, words *w, char *complaint, size_t capacity)
{
    cli_line line;
    if (!cli_parse(&line, w->n, w->argv, complaint, capacity)) {
        return false;
    }
    memcpy(line.global, s->a.line.global, sizeof line.global);
    s->a.line = line;
    return true;
}

static bool is_wanted(const json_t *robots, const char *name)
{
    size_t i;
    json_t *one;
    json_array_foreach(robots, i, one)
    {
        if (json_is_string(one) && strcmp(json_string_value(one), name) == 0) {
            return true;
        }
    }
    return robots == NULL;
}

static bool prepare_one(seat *s, words *w, char *complaint, size_t capacity)
{
    *complaint = '\0';
    if (!s->is_open || s->c.link_error) {
        snprintf(complaint, capacity, "%s: is not there", s->name);
        return false;
    }
    if (!parse(s, w, complaint, capacity)) {
        return false;
    }
    s->a.hushed = complaint;
    int status = seat_load(s);
    if (!status) {
        status = seat_prepare(s);
    }
    s->a.hushed = NULL;
    return status == EXIT_DONE;
}

/* Why it cannot be now; NULL: it can. */
static const char *busy(const agent *g)
{
    const char *latched = agent_latched(g);
    return latched ? latched : g->plays ? "another motion is played" : NULL;
}

static void choose_ends(agent *g, const json_t *body)
{
    const char *lost = fleet_text(body, "on_link_lost");
    const char *group = fleet_text(body, "group");
    g->on_lost = !lost                         ? AGENT_STOP
                 : strcmp(lost, "finish") == 0 ? AGENT_FINISH
                 : strcmp(lost, "exit") == 0   ? AGENT_EXIT
                                               : AGENT_STOP;
    snprintf(g->permit_group, sizeof g->permit_group, "%s", group ? group : FLEET_ALL);
    g->permit_us = grobo_now_us();
    g->spread_us = fleet_number(body, "spread_us", 5000);
}

static grobo_team_policy policy_of(const json_t *body)
{
    const char *lost = fleet_text(body, "if_lost");
    return !lost                           ? GROBO_TEAM_STOP_ALL
           : strcmp(lost, "continue") == 0 ? GROBO_TEAM_CONTINUE
           : strcmp(lost, "pause") == 0    ? GROBO_TEAM_PAUSE_ALL
                                           : GROBO_TEAM_STOP_ALL;
}

static int begin(agent *g, const json_t *body)
{
    const seat *first = NULL;
    for (int i = 0; i < g->all.n; i++) {
        seat *s = &g->all.seats[i];
        s->c.moving = s->c.moving || s->chosen;
        first = first || !s->chosen ? first : s;
    }
    grobo_play_options options = first->list.options[0];
    options.start_us = GROBO_START_LATER;
    return robot_group_play(&g->all, policy_of(body), &options);
}

/* It came to nothing, or is over. */
static void forget_play(agent *g)
{
    json_decref(g->play.is.body);
    memset(&g->play, 0, sizeof g->play);
    g->plays = g->started = false;
    robot_group_disband(&g->all);
}

/* NULL: every robot that is wanted is prepared; their number. */
static const char *prepare_all(agent *g, words *w, char *complaint, size_t capacity)
{
    const json_t *robots = json_object_get(g->play.is.body, "robots");
    int n = 0;
    for (int i = 0; i < g->all.n; i++) {
        seat *s = &g->all.seats[i];
        s->chosen = is_wanted(robots, s->name);
        n += s->chosen;
        if (s->chosen && !prepare_one(s, w, complaint, capacity)) {
            return complaint;
        }
    }
    return n == 0             ? "no such robot"
           : agent_latched(g) ? agent_latched(g)
           : !g->listens      ? "the broker went away"
                              : NULL;
}

static void prepare(agent *g, agent_order *order)
{
    static words w;
    char complaint[APP_LINE_BYTES];
    const char *why = busy(g), *file = fleet_text(order->is.body, "file");
    const char *group = fleet_text(order->is.body, "group");
    if (why || !is_motion_name(file) || (group && !agent_find_group(g, group))) {
        answer(g, order, why ? "state" : "arg",
               why                     ? why
               : !is_motion_name(file) ? "file: a name of the folder is wanted"
                                       : "group: none of this agent");
        return;
    }
    line_of(&w, g, order->is.body);
    g->play = *order; /* answered when all are ready; permits are heard from now on */
    json_incref(g->play.is.body);
    g->plays = true; /* no second one, while robots are waited for */
    g->started = g->let_go = false;
    choose_ends(g, order->is.body);
    why = prepare_all(g, &w, complaint, sizeof complaint);
    int error = why ? GROBO_OK : begin(g, order->is.body);
    if (why || (error < 0 && grobo_team_get_state(g->all.team) == GROBO_TEAM_ENDED)) {
        answer(g, order, why ? "state" : grobo_error_name(error),
               why ? why : grobo_error_text(error));
        forget_play(g);
    }
}

/* ---- the others ------------------------------------------------------------------------------ */

/* What is played was prepared by the order that this one names, and by the same sender. */
static bool is_for_play(const agent *g, const agent_order *order)
{
    const char *of = fleet_text(order->is.body, "of");
    return g->plays && of && strcmp(of, g->play.is.id) == 0 &&
           strcmp(g->play.is.from, order->is.from) == 0;
}

static void start(agent *g, agent_order *order)
{
    int64_t at_us = fleet_number(order->is.body, "at_us", -1), offset_us, bound_us;
    const agent_leader *l = leader_of(g, order->is.from);
    if (!is_for_play(g, order)) {
        answer(g, order, "state", "nothing was prepared by that order");
        return;
    }
    if (!fleet_clock_read(&l->clock, grobo_now_us(), &offset_us, &bound_us) || at_us < 0) {
        answer(g, order, "arg", "at_us: a time is wanted");
        return;
    }
    if (2 * bound_us > g->spread_us) {
        char text[96];
        snprintf(text, sizeof text, "its clock is known to %.1f ms only, %.1f ms are asked for",
                 (double)bound_us / 1e3, (double)g->spread_us / 2e3);
        answer(g, order, "speed", text);
        return;
    }
    g->start_us = at_us - offset_us;
    int error = grobo_team_start_at(g->all.team, g->start_us, grobo_now_us());
    robot_group_look(&g->all);
    if (error < 0) {
        answer(g, order, grobo_error_name(error),
               error == GROBO_ERR_STALE ? "that time is over" : grobo_error_text(error));
        return;
    }
    g->started = true;
    say_answer(g, order, NULL, NULL,
               json_pack("{s:I,s:I}", "bound_us", (json_int_t)bound_us, "here_us",
                         (json_int_t)g->start_us));
}

/* Of one's own motion: a stop of the group is for everybody's. */
static void cancel(agent *g, agent_order *order)
{
    if (!is_for_play(g, order)) {
        answer(g, order, "state", "nothing was prepared by that order");
        return;
    }
    if (g->all.team) {
        (void)grobo_team_stop(g->all.team, false);
        robot_group_look(&g->all);
    }
    answer(g, order, NULL, NULL);
}

/* After the latch was taken back: what the engines keep latched too. Nothing moves. */
static void reset(agent *g, agent_order *order)
{
    const char *latched = agent_latched(g);
    int error = latched ? GROBO_ERR_LATCHED : GROBO_OK;
    for (int i = 0; i < g->all.n && !error; i++) {
        seat *s = &g->all.seats[i];
        error = s->is_open ? grobo_robot_reset(s->c.robot) : GROBO_OK;
    }
    answer(g, order, error ? grobo_error_name(error) : NULL,
           latched ? latched
           : error ? grobo_error_text(error)
                   : "");
}

static void put(agent *g, agent_order *order)
{
    const char *name = fleet_text(order->is.body, "file");
    const json_t *text = json_object_get(order->is.body, "text");
    char path[CONFIG_PATH_BYTES];
    if (!is_motion_name(name) || grobo_motion_format_of_path(name) == GROBO_FORMAT_AUTO ||
        !json_is_string(text)) {
        answer(g, order, "arg", "file, text: the name of a motion and its content are wanted");
        return;
    }
    if (g->plays) {
        answer(g, order, "busy", "a motion is played, which a slow disk would hold up");
        return;
    }
    snprintf(path, sizeof path, "%s/%s", g->motions, name);
    int error = file_save(path, json_string_value(text), json_string_length(text));
    answer(g, order, error ? grobo_error_name(error) : NULL,
           error ? file_write_error_text(error) : "");
}

/* For who measures a round trip. */
static void ping(agent *g, agent_order *order)
{
    answer(g, order, NULL, NULL);
}

static void carry_out(agent *g, agent_order *order)
{
    static const struct {
        const char *verb;
        void (*fn)(agent *g, agent_order *order);
    } verbs[] = {{"prepare", prepare}, {"start", start}, {"abort", cancel},
                 {"reset", reset},     {"put", put},     {"ping", ping}};
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; i++) {
        if (strcmp(order->is.verb, verbs[i].verb) == 0) {
            verbs[i].fn(g, order);
            return;
        }
    }
    answer(g, order, "unsupported", "no such order");
}

/* ---- the motion ------------------------------------------------------------------------------ */

/* Who asked for it hears that all are ready, or why not. */
static void answer_play(agent *g, const char *code, const char *message)
{
    if (g->play.used && *g->play.response) {
        answer(g, &g->play, code, message);
        *g->play.response = '\0';
    }
}

void orders_on_team(void *ctx, const grobo_team_event_info *event)
{
    agent *g = ctx;
    switch (event->kind) {
    case GROBO_TEAM_EVENT_READY:
        answer_play(g, NULL, NULL);
        break;
    case GROBO_TEAM_EVENT_OUT:
    case GROBO_TEAM_EVENT_PAUSED: {
        for (int i = 0; event->kind == GROBO_TEAM_EVENT_OUT && i < g->all.n; i++) {
            if (g->all.seats[i].member == event->member) {
                say_event(g, &g->all.seats[i], "out", grobo_error_text(event->result));
            }
        }
        break;
    }
    case GROBO_TEAM_EVENT_START:
    case GROBO_TEAM_EVENT_ENDED:
        break;
    }
}

static bool settles(const agent *g)
{
    for (int i = 0; i < g->all.n; i++) {
        const conn *c = &g->all.seats[i].c;
        if (g->all.seats[i].chosen && c->up && !c->link_error &&
            (grobo_robot_settling(c->robot) || grobo_robot_moving(c->robot))) {
            return true;
        }
    }
    return false;
}

static void end_play(agent *g)
{
    if (!g->plays || !g->all.team || grobo_team_get_state(g->all.team) != GROBO_TEAM_ENDED ||
        settles(g)) {
        return;
    }
    answer_play(g, "canceled", agent_latched(g) ? agent_latched(g) : "it was stopped");
    say_ended(g, g->play.is.id);
    for (int i = 0; i < g->all.n; i++) {
        g->all.seats[i].c.moving = g->all.seats[i].c.moving && !g->all.seats[i].chosen;
    }
    forget_play(g);
}

/* In the order in which they came: what is called off was prepared before. */
static agent_order *next_due(agent *g)
{
    agent_order *first = NULL;
    for (int i = 0; i < AGENT_PENDING; i++) {
        agent_order *order = &g->orders[i];
        if (order->used && order->timed && (!first || order->number < first->number)) {
            first = order;
        }
    }
    return first;
}

void orders_work(agent *g)
{
    for (agent_order *due = next_due(g); due; due = next_due(g)) {
        agent_order order = *due;
        memset(due, 0, sizeof *due); /* it may take a while: others may come */
        carry_out(g, &order);
        json_decref(order.is.body);
    }
    end_play(g);
}

void orders_free(agent *g)
{
    orders_forget(g);
    json_decref(g->play.is.body);
    fleet_seen_free(&g->seen);
}
