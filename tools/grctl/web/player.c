/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/play/play.h"
#include "tools/grctl/web/library.h"
#include "tools/grctl/web/pose.h"
#include "tools/grctl/web/serve.h"

struct player_item {
    player_item *next;
    char name[LIBRARY_NAME_BYTES];
    playlist list; /* of one file */
    bool loop;
};

/* A file on its way to being played. */
typedef struct load {
    worker_task task;
    serve *s;
    http_request *request;
    app app; /* its own, for the words of the command */
    char said[APP_LINE_BYTES];
    player_item *item;
    int status;
    unsigned epoch;
    uint64_t sequence;
    char secret[ACCESS_SECRET_BYTES];
    player_lost on_lost;
    bool queued;
} load;

static const char *const lost_words[] = {"stop", "finish", "exit"};

/* ---- the request ----------------------------------------------------------------------------- */

static void set(app *a, int option, double number)
{
    a->line.option[option] = (cli_value){.given = 1, .number = number};
}

/* A number of the body, or `otherwise` where there is none. */
static double number_of(const json_t *body, const char *key, double otherwise)
{
    const json_t *number = json_object_get(body, key);
    return number ? json_number_value(number) : otherwise;
}

static player_lost lost_of(const json_t *body)
{
    const char *word = json_string_value(json_object_get(body, "on_lost"));
    int i = 0;
    while (word && i < PLAYER_EXIT && strcmp(word, lost_words[i]) != 0) {
        i++;
    }
    return (player_lost)i;
}

/* The options of `grctl play`, by their names here. */
static void read_options(load *l, const json_t *body)
{
    static const struct {
        const char *name;
        int option;
    } flags[] = {{"mirror", PLAY_MIRROR},
                 {"reverse", PLAY_REVERSE},
                 {"by_keys", PLAY_KEY},
                 {"force", PLAY_FORCE}};
    l->app.line = (cli_line){
        .command = cli_find_command("play"), .argument = {l->item->name}, .n_arguments = 1};
    memcpy(l->app.line.global, l->s->a->line.global, sizeof l->app.line.global);
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++) {
        if (json_is_true(json_object_get(body, flags[i].name))) {
            set(&l->app, flags[i].option, 1);
        }
    }
    l->app.clamps = json_is_true(json_object_get(body, "clamp"));
    l->item->loop = json_is_true(json_object_get(body, "loop"));
    l->on_lost = lost_of(body);
    set(&l->app, PLAY_SPEED, number_of(body, "speed_pct", 100));
    set(&l->app, PLAY_REPEAT, l->item->loop ? 1e9 : number_of(body, "repeat", 1));
    set(&l->app, PLAY_FROM, number_of(body, "from_ms", 0));
}

static void free_item(player_item *item)
{
    playlist_free(&item->list);
    free(item);
}

static void free_items(player *p)
{
    while (p->items) {
        player_item *next = p->items->next;
        free_item(p->items);
        p->items = next;
    }
}

static void work(worker_task *task)
{
    load *l = (load *)task;
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(&l->app),
                               .name = l->item->name, .keep_positions = true};
    grobo_motion *motion = NULL;
    library_file file;
    int error = library_read(l->s->library, l->item->name, &file);
    if (!error) {
        error = grobo_motion_read_memory(file.bytes, file.size, &read, NULL, &motion);
    }
    library_drop(&file);
    l->status = error ? app_fail(&l->app, EXIT_FILE, grobo_error_name(error), "%s: %s",
                                 l->item->name, file_error_text(error))
                      : playlist_take(&l->item->list, &l->app, l->item->name, motion);
}

/* Is it still what is wanted? Time has passed. */
static bool may_begin(const load *l)
{
    return l->s->player.epoch == l->epoch && lease_is_holder(&l->s->lease, l->secret) &&
           l->s->c.up && !l->s->ending && !stops_is_latched(l->s);
}

static int begin(load *l)
{
    serve *s = l->s;
    player *p = &s->player;
    grobo_robot_config config;
    grobo_play_progress progress;
    grobo_robot_progress(s->c.robot, &progress);
    if (p->clamps != l->app.clamps) {
        p->clamps = l->app.clamps;
        s->a->clamps = p->clamps;
        config = serve_config(s);
        (void)grobo_session_configure(s->c.session, &config);
    }
    int job = grobo_robot_play(s->c.robot, &l->item->list.clip[0], &l->item->list.options[0]);
    if (job > 0) {
        free_items(p); /* the engine has none of them any more */
        p->items = l->item;
        p->begun = progress.item + 1;
        p->on_lost = l->on_lost;
        p->speed_pct = l->item->list.options[0].speed_pct;
        snprintf(p->by, sizeof p->by, "%s", s->lease.holder.name);
        l->item = NULL;
    }
    return serve_note_job(s, job, "play");
}

static int queue(load *l)
{
    player_item **end = &l->s->player.items;
    int result =
        grobo_robot_enqueue(l->s->c.robot, &l->item->list.clip[0], &l->item->list.options[0]);
    while (*end) {
        end = &(*end)->next;
    }
    if (result >= 0) {
        *end = l->item;
        l->item = NULL;
        result = GROBO_OK;
    }
    return result;
}

static void done(worker_task *task)
{
    load *l = (load *)task;
    serve *s = l->s;
    grobo_posture sensed;
    if (!l->status && !may_begin(l)) {
        serve_refuse(s, l->request, GROBO_ERR_CANCELED, "play");
    } else {
        grobo_robot_posture(s->c.robot, GROBO_NEVER_US, &sensed);
        if (!l->status) {
            l->status = playlist_prepare(&l->item->list, &l->app, l->queued ? NULL : &sensed);
        }
        if (l->status) {
            serve_refuse_said(l->request, l->status, &l->app);
        } else {
            serve_accept(s, l->request, l->queued ? queue(l) : begin(l), "play");
        }
    }
    if (l->item) {
        free_item(l->item);
    }
    free(l);
}

static void load_motion(serve *s, http_request *r, json_t *body, bool queued)
{
    const char *name = json_string_value(json_object_get(body, "motion"));
    load *l = calloc(1, sizeof *l);
    player_item *item = calloc(1, sizeof *item);
    if (!l || !item) {
        free(l);
        free(item);
        serve_refuse(s, r, GROBO_ERR_NOMEM, "play");
        return;
    }
    *l = (load){.task = {.work = work, .done = done},
                .s = s,
                .request = r,
                .item = item,
                .epoch = s->player.epoch,
                .queued = queued};
    l->app = *s->a;
    app_hush(&l->app, l->said);
    snprintf(item->name, sizeof item->name, "%s", name ? name : "");
    snprintf(l->secret, sizeof l->secret, "%s", s->lease.holder.secret);
    if (!name || !library_is_name(name)) {
        http_refuse(r, 404, "noent", "play: there is no motion of this name");
    } else {
        read_options(l, body);
        worker_put(s->worker, &l->task);
        return;
    }
    free(item);
    free(l);
}

void verb_play(serve *s, http_request *r, json_t *body)
{
    load_motion(s, r, body, false);
}

void verb_queue(serve *s, http_request *r, json_t *body)
{
    load_motion(s, r, body, true);
}

/* ---- what is played -------------------------------------------------------------------------- */

/* The motion that is played now; those before it are over. */
static player_item *present(const serve *s, const grobo_play_progress *progress)
{
    player_item *item = s->player.items;
    for (uint32_t i = s->player.begun; item && item->next && i < progress->item; i++) {
        item = item->next;
    }
    return item;
}

static int sample(const player_item *item, const grobo_model *model, int64_t t_us,
                  grobo_posture *posture)
{
    const grobo_clip *clip = &item->list.clip[0];
    const grobo_play_options *o = &item->list.options[0];
    if (!clip->sample || clip->relative) {
        return GROBO_ERR_UNSUPPORTED;
    }
    t_us = o->reverse ? clip->length_us - t_us : t_us;
    int error = clip->sample(clip->ctx, t_us, posture);
    if (error >= 0 && o->mirror) {
        error = grobo_posture_mirror(posture, model);
    }
    return error;
}

bool player_at(const serve *s, int64_t offset_us, grobo_posture *posture)
{
    grobo_play_progress progress;
    grobo_robot_progress(s->c.robot, &progress);
    const player_item *item = present(s, &progress);
    bool plays = progress.state == GROBO_SEQUENCER_PLAYING ||
                 progress.state == GROBO_SEQUENCER_PAUSED ||
                 progress.state == GROBO_SEQUENCER_APPROACHING;
    return item && plays && sample(item, s->model, progress.t_us + offset_us, posture) >= 0;
}

bool player_is_endless(const serve *s)
{
    grobo_play_progress progress;
    grobo_robot_progress(s->c.robot, &progress);
    const player_item *item = present(s, &progress);
    while (item && !item->loop) {
        item = item->next;
    }
    return item != NULL;
}

json_t *player_json(serve *s)
{
    grobo_play_progress progress;
    grobo_posture ghost;
    grobo_robot_progress(s->c.robot, &progress);
    const player_item *item = present(s, &progress);
    const grobo_play_options *o = item ? &item->list.options[0] : NULL;
    json_t *queue = json_array(), *angles = NULL;
    for (const player_item *i = item ? item->next : NULL; i; i = i->next) {
        json_array_append_new(queue, app_json_text(i->name));
    }
    if (player_at(s, 0, &ghost)) {
        angles = pose_angles_json(&ghost, s->model->n_joints, 1);
    }
    return json_pack("{s:s,s:o?,s:o,s:o,s:i,s:i,s:b,s:b,s:b,s:i,s:o,s:o?,s:s?,s:o?}", "state",
                     grobo_sequencer_state_name(progress.state), "motion",
                     item ? app_json_text(item->name) : NULL, "t_ms",
                     app_json_number((double)progress.t_us / 1e3, 1), "total_ms",
                     app_json_number((double)progress.total_us / 1e3, 1), "pass",
                     (int)progress.pass, "passes", (int)progress.passes, "loop", item && item->loop,
                     "mirror", o && o->mirror, "reverse", o && o->reverse, "speed_pct",
                     item ? s->player.speed_pct : 100, "queue", queue, "ghost_deg", angles,
                     "on_lost", item ? lost_words[s->player.on_lost] : NULL, "by",
                     item ? app_json_text(s->player.by) : NULL);
}

void player_on_event(serve *s, const grobo_event *event)
{
    if (event->kind != GROBO_EVENT_PLAY) {
        return;
    }
    const char *level = event->u.play.error ? "error" : "info";
    const player_item *item = s->player.items;
    events_tell(&s->events, "play", level, NULL, "%s%s%s%s%s", item ? item->name : "motion", ": ",
                grobo_sequencer_state_name(event->u.play.to), event->u.play.error ? ": " : "",
                event->u.play.error ? grobo_error_text(event->u.play.error) : "");
}

void player_free(serve *s)
{
    free_items(&s->player);
}
