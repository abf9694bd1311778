/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <event2/event.h>

#include <grobo/core/robot.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/cli/realtime.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/keys.h"
#include "tools/grctl/play/frames.h"
#include "tools/grctl/play/keys.h"
#include "tools/grctl/play/play.h"
#include "tools/grctl/view/render.h"

static const cli_option options[PLAY_OPTIONS] = {
    [PLAY_REPEAT] = OPTION_WHOLE("repeat", 'n', "N", 1, 1000000, "play N times"),
    [PLAY_REVERSE] = OPTION_FLAG("reverse", 'r', "from the end to the beginning"),
    [PLAY_MIRROR] = OPTION_FLAG("mirror", 'm', "left for right"),
    [PLAY_SPEED] =
        OPTION_WHOLE("speed", 's', "PCT", 1, GROBO_PLAY_SPEED_MAX_PCT, "speed in percent (100)"),
    [PLAY_FROM] = OPTION_REAL("from", 'f', "MS", 0, 1e9, "begin at this time of the first file"),
    [PLAY_RATE] = OPTION_WHOLE("rate", 0, "HZ", 1, GROBO_PLAY_RATE_MAX_HZ,
                               "interpolate, so many frames a second (pseq and yaml)"),
    [PLAY_KEY] =
        OPTION_FLAG("key", 'k', "one frame a key pose, the servos interpolate (m and mseq)"),
    [PLAY_CLAMP] = OPTION_FLAG("clamp", 0, "play angles outside a joint's limits at the limit"),
    [PLAY_UNWATCHED] = OPTION_FLAG("unwatched", 0, "allow a rate at which joints cannot be read"),
    [PLAY_FORCE] =
        OPTION_FLAG("force", 0, "play what was made for another robot; do not warn of a fall"),
    [PLAY_DRY_RUN] = OPTION_FLAG("dry-run", 0, "print 'time_ms hex' a frame; touch no port"),
    [PLAY_TABLE] = OPTION_FLAG("table", 0, "at the end, target, reached and error of every joint"),
    [PLAY_IF_LOST] = OPTION_CHOICE("if-lost", 0, "stop|pause|continue",
                                   "what the others of a group do when a robot falls out (stop)"),
    [PLAY_REALTIME] = REALTIME_OPTION,
    BODY_OPTION_ROWS(PLAY_BODY),
};

enum { TICK_US = 100000, REPORT_EVERY = 10 /* ticks of a JSON line */ };

/* How far a joint was from where the motion had it. */
typedef struct deviation {
    double deg;
    int joint; /* -1: none was read */
} deviation;

typedef struct show {
    playlist list;
    progress bar;
    keys input;
    play_keys keys;
    int ticks;
    bool started, over, unwatched;
    int error;           /* why it failed, 0: it did not */
    uint32_t items;      /* of the sequencer, before the first clip */
    deviation following; /* the largest, of readings while it was played at a rate */
} show;

/* A reading: where was the joint to be just then? By keys the servos go their own way between. */
static void follow(conn *c, show *s, int joint)
{
    grobo_play_progress p;
    grobo_joint_info info;
    grobo_posture wanted;
    grobo_robot_progress(c->robot, &p);
    uint32_t i = p.item - s->items - 1;
    if (p.state != GROBO_SEQUENCER_PLAYING || i >= (uint32_t)s->list.n) {
        return;
    }
    const grobo_play_options *o = &s->list.options[i];
    if (o->mode != GROBO_PLAY_RATE || !s->list.clip[i].sample || s->list.clip[i].relative ||
        s->list.clip[i].sample(s->list.clip[i].ctx, o->reverse ? p.total_us - p.t_us : p.t_us,
                               &wanted) < 0 ||
        !(wanted.set & GROBO_JOINT_BIT(joint)) || grobo_robot_joint(c->robot, joint, &info) < 0) {
        return;
    }
    double off_deg = fabs(grobo_deg_from_rad(info.state.angle_rad - wanted.angle_rad[joint]));
    if (s->following.joint < 0 || off_deg > s->following.deg) {
        s->following = (deviation){.deg = off_deg, .joint = joint};
    }
}

static void report_progress(conn *c, show *s)
{
    grobo_play_progress p;
    char text[128];
    grobo_robot_progress(c->robot, &p);
    if (s->started && p.state == GROBO_SEQUENCER_IDLE) {
        return; /* stopped: how far it had come stays */
    }
    if (c->a->json) {
        if (s->ticks % REPORT_EVERY == 0) {
            app_print_json(json_pack("{s:I,s:I,s:I,s:I}", "t_ms", (json_int_t)(p.t_us / 1000),
                                     "total_ms", (json_int_t)(p.total_us / 1000), "step",
                                     (json_int_t)p.step, "steps", (json_int_t)p.steps));
        }
        return;
    }
    snprintf(text, sizeof text, _("%s %.1f of %.1f s, %.0f s left at %d %%"),
             _(grobo_sequencer_state_name(p.state)), (double)p.t_us / 1e6, (double)p.total_us / 1e6,
             ceil((double)(p.total_us - p.t_us) / 1e4 / s->keys.speed_pct), s->keys.speed_pct);
    progress_draw(&s->bar, p.total_us ? (double)p.t_us / (double)p.total_us : 0, text);
}

static void on_tick(evutil_socket_t fd, short what, void *ctx)
{
    conn *c = ctx;
    show *s = c->ctx;
    (void)fd;
    (void)what;
    report_progress(c, s);
    s->ticks++;
}

static void on_key(void *ctx, int key)
{
    conn *c = ctx;
    show *s = c->ctx;
    if (play_keys_take(&s->keys, key)) {
        report_progress(c, s);
    }
}

static void warn_unwatched(const conn *c, const grobo_event_unwatched *told)
{
    char rate[32];
    snprintf(rate, sizeof rate, told->rate_hz > 0 ? _("at %d Hz") : _("by keys"), told->rate_hz);
    app_note(c->a,
             "play: unwatched %s: heat, current and lost torque may stop nothing "
             "(joints are watched up to %d Hz)",
             rate, told->watched_hz);
}

static void on_event(conn *c, const grobo_event *event)
{
    show *s = c->ctx;
    if (event->kind == GROBO_EVENT_PLAY) {
        grobo_sequencer_state to = event->u.play.to;
        s->started = true;
        s->over = to == GROBO_SEQUENCER_FINISHED || to == GROBO_SEQUENCER_IDLE ||
                  to == GROBO_SEQUENCER_FAILED;
        if (to == GROBO_SEQUENCER_FAILED) {
            s->error = event->u.play.error;
        }
    } else if (event->kind == GROBO_EVENT_JOINT && event->u.joint.result == GROBO_OK) {
        follow(c, s, event->u.joint.joint);
    } else if (event->kind == GROBO_EVENT_UNWATCHED) {
        s->unwatched = true;
        warn_unwatched(c, &event->u.unwatched);
    } else if (event->kind == GROBO_EVENT_TRIP) {
        s->error = GROBO_ERR_LATCHED;
    }
}

/* Over when the last posture has been read back too, and repeated if it was lost. */
static bool is_over(conn *c)
{
    const show *s = c->ctx;
    return s->over && !grobo_robot_settling(c->robot);
}

static json_t *deviation_json(deviation d)
{
    return d.joint < 0 ? json_null() : app_json_number(d.deg, 2);
}

static json_t *summary_json(const conn *c, deviation following, deviation end)
{
    const show *s = c->ctx;
    json_t *summary = frames_json(c);
    json_object_set_new(summary, "watched", json_boolean(!s->unwatched));
    json_object_set_new(summary, "max_error_deg", deviation_json(end));
    json_object_set_new(summary, "max_following_deg", deviation_json(following));
    return summary;
}

static void print_deviation(const conn *c, const char *what, deviation d)
{
    char text[JOINTS_TEXT_BYTES];
    if (d.joint >= 0) {
        app_print("%s %s (%s)\n", what, joints_error_text(conn_model(c), d.joint, d.deg, text),
                  grobo_model_joint(conn_model(c), d.joint)->name);
    }
}

static void print_summary(const conn *c, deviation following)
{
    grobo_robot_counters n;
    deviation end;
    end.deg = render_worst_error(c, &end.joint);
    if (c->a->json) {
        app_print_json(summary_json(c, following, end));
        return;
    }
    conn_counters(c, &n);
    if (app_option(c->a, PLAY_TABLE)->given) {
        render_reached(c);
    }
    frames_print(c, "");
    if (n.stretched) {
        app_print("%llu move%s too fast for a servo and got more time\n",
                  (unsigned long long)n.stretched, n.stretched == 1 ? " was" : "s were");
    }
    if (n.clamped) {
        app_print("angles outside a joint's limits, taken to the limit: %llu\n",
                  (unsigned long long)n.clamped);
    }
    print_deviation(c, "largest error on the way", following);
    print_deviation(c, "largest error at the end", end);
}

/* Frames that the line cannot carry would be left out: better said before. */
static void warn_of_rate(const conn *c, const grobo_play_options *o)
{
    grobo_budget line;
    if (o->mode != GROBO_PLAY_RATE || grobo_robot_budget(c->robot, &line) < 0) {
        return;
    }
    if ((double)o->rate_hz * line.motion_us > 1e6) {
        app_note(c->a, "%d frames a second exceed what the line carries (%.0f): some are dropped",
                 o->rate_hz, 1e6 / line.motion_us);
    }
}

static int start(conn *c, show *s)
{
    grobo_play_progress before;
    grobo_robot_progress(c->robot, &before);
    s->items = before.item;
    s->following.joint = -1;
    int error = conn_wait(c, grobo_robot_play(c->robot, &s->list.clip[0], &s->list.options[0]));
    for (int i = 1; i < s->list.n && error >= 0; i++) {
        error = grobo_robot_enqueue(c->robot, &s->list.clip[i], &s->list.options[i]);
    }
    return error < 0 ? error : 0;
}

/* Shows how it goes, and takes keys, until it is over. */
static int watch_it(conn *c, show *s)
{
    progress_start(&s->bar, c->a);
    s->keys = (play_keys){.c = c, .speed_pct = (int)app_number(c->a, PLAY_SPEED, 100)};
    if (keys_start(&s->input, c->base, false, on_key, c) && s->bar.shown) {
        app_note(c->a, "space: pause   + -: speed   s: stop   e: EMERGENCY STOP");
    }
    struct event *tick = conn_every(c->base, TICK_US, on_tick, c);
    int error = conn_wait_until(c, is_over);
    conn_forget(tick);
    keys_stop(&s->input);
    progress_clear(&s->bar);
    return error;
}

/* The stop is verified joint by joint before anything else is said. */
static int after_estop(conn *c, int error)
{
    if (!error) {
        error = conn_end_estop(c);
    }
    if (error) {
        return conn_fail(c, error, "estop");
    }
    return app_fail_trip(c->a, GROBO_TRIP_ESTOP,
                         "play: emergency stop; 'grctl estop --reset' releases it");
}

/* Plays to the end, then reads where the joints are. */
static int play(conn *c, show *s)
{
    grobo_joint_mask all = GROBO_JOINTS_ALL(conn_model(c)->n_joints);
    warn_of_rate(c, &s->list.options[0]);
    int error = start(c, s);
    if (error) {
        return conn_fail(c, error, "play");
    }
    error = watch_it(c, s);
    if (s->keys.estop || c->trip.trip == GROBO_TRIP_ESTOP) {
        return after_estop(c, error);
    }
    if (!error && s->error) {
        error = s->error;
    }
    if (error) {
        return conn_fail(c, error, "play");
    }
    c->moving = false;
    conn_watch(c, false);
    error = conn_sense(c, all, GROBO_SENSE_FULL);
    if (error && c->job.failed == 0) {
        return conn_fail(c, error, "play");
    }
    print_summary(c, s->following);
    return EXIT_DONE;
}

static int run(app *a)
{
    static show s;
    conn c;
    int status = realtime_begin(a, PLAY_REALTIME);
    if (status || a->group) {
        return status ? status : play_together(a);
    }
    memset(&s, 0, sizeof s);
    a->clamps = app_option(a, PLAY_CLAMP)->given > 0;
    status = playlist_load(&s.list, a);
    if (!status && app_option(a, PLAY_DRY_RUN)->given) {
        status = play_dry_run(&s.list, a);
    } else if (!status) {
        status = conn_open_to_move(&c, a);
        c.ctx = &s;
        c.on_event = on_event;
        if (!status) {
            status = playlist_prepare_sensed(&s.list, &c);
        }
        if (!status) {
            c.moving = true;
            status = play(&c, &s);
        }
        status = conn_close(&c, status);
    }
    playlist_free(&s.list);
    a->clamps = false;
    return status;
}

const cli_command cmd_play = {
    .name = "play",
    .heading = "Motions",
    COMMAND_ARGUMENTS("FILE...", 1, -1, CLI_ARG_FILE),
    .summary = "play motion files",
    .details =
        "Plays .m, .pseq, .mseq, .yaml and .seq files, one after the other. Every file is\n"
        "checked before anything moves: an angle outside a joint's limits is refused with its\n"
        "place in the file and exit status 4, or played at the limit with --clamp. An angle up\n"
        "to one degree outside, as recordings have them, is played at the limit, with a warning.\n"
        "One warning reports where the robot would fall; --force and 'warn_fall: false' in\n"
        "config.yaml silence it. Torque comes on where it is off, and the robot goes slowly from\n"
        "where it is to where the motion begins. Ctrl-C stops smoothly and carries out the exit\n"
        "policy.\n"
        "\n"
        "While it plays, every joint is read at least every 2 s, and heat, current, low voltage\n"
        "and lost torque stop it. --rate is the rate that leaves time for that, at most 50; a\n"
        "higher one needs --unwatched. 'grctl budget' computes it: 39 through the board at\n"
        "115200 bps.\n"
        "\n"
        "Where -d names a group of the configuration, its robots approach, wait for each other\n"
        "and begin together; --if-lost chooses what the others do if one trips or loses its line.\n"
        "\n"
        "On a terminal it takes keys:\n"
        "\n" PLAY_KEYS_HELP,
    .example = "  grctl play motions/greet.pseq\n"
               "  grctl play --speed 50 --mirror walk.pseq\n"
               "  grctl play --dry-run --key greet.pseq | head\n",
    .options = options,
    .n_options = PLAY_OPTIONS,
    .group = CLI_GROUP_TOGETHER,
    .run = run,
};
