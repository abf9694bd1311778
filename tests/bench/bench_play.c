/* SPDX-License-Identifier: MIT */
/*
 * Playing at 50 and 100 Hz on simulated servos behind a pty at 460800 bps, while another process
 * keeps a core busy: how late frames leave, and the processor time of each, beside two bare loops
 * that write as many bytes: clock_nanosleep() alone, and a timer of libevent.
 *
 * `bench_play realtime`: an SO-101 at 50 to 1000 Hz while every core is busy, as any thread and
 * with grobo_thread_realtime(), beside clock_nanosleep() with the same (make bench-realtime).
 */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/loop.h>
#include <grobo/core/robot.h>
#include <grobo/robot_file.h>
#include <grobo/session.h>
#include <grobo/sim_server.h>

#include "tests/bench/bench.h"
#include "tests/support/tables.h"

enum { SPAN_S = 5, LATE_MAX = 8192, POSE_BYTES = 108, BUSY_MAX = 64 };
enum { PRIORITY = 50 };

/* What plays: GR001 on a bus, or for `realtime` an SO-101, whose pose takes less of a line. */
static struct {
    const char *row; /* its rows in the table */
    const grobo_driver *driver;
    grobo_sim_config sim;
    uint32_t baud_bps;
    size_t pose_bytes;
    bool prior; /* with a priority of its own */
} played = {.row = "S7", .baud_bps = 460800, .pose_bytes = POSE_BYTES};

static double late_us[LATE_MAX];
static int n_late;
static int64_t period_us;

static void note_late(int64_t us)
{
    if (n_late < LATE_MAX) {
        late_us[n_late++] = (double)us;
    }
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void row(const char *what, const char *who, double value)
{
    char measure[96];

    (void)snprintf(measure, sizeof measure, "%d Hz, %s busy%s: %s", (int)(1000000 / period_us),
                   played.driver != NULL ? "all cores" : "a core", played.prior ? ", first" : "",
                   what);
    bench_row(played.row, measure, who, value);
}

static void report(const char *who, double cpu_us, int frames)
{
    qsort(late_us, (size_t)n_late, sizeof late_us[0], by_value);
    row("lateness p50, us", who, n_late > 0 ? late_us[n_late / 2] : NAN);
    row("lateness p99, us", who, n_late > 0 ? late_us[n_late * 99 / 100] : NAN);
    row(played.driver != NULL ? "CPU a period, us" : "CPU a frame, us", who, cpu_us / frames);
    n_late = 0;
}

/* As many bytes as a pose has, which mean nothing to a servo. */
static uint8_t filler[POSE_BYTES];

static void write_filler(int fd)
{
    /* A far end that gets no time does not read: then there is no room. */
    if (write(fd, filler, played.pose_bytes) < 0 && errno != EAGAIN) {
        perror("bench_play");
    }
}

static void sleep_loop(int fd)
{
    const int frames = (int)(SPAN_S * 1000000 / period_us);
    const double begin_us = bench_cpu_us();
    int64_t due_us = grobo_now_us();
    struct timespec now; /* of a clock that is not that of grobo_now_us() everywhere */

    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    const int64_t apart_us = (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000 - due_us;
    for (int i = 0; i < frames; i++) {
        due_us += period_us;
        const int64_t at_us = due_us + apart_us;
        const struct timespec at = {at_us / 1000000, at_us % 1000000 * 1000};

        (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL);
        note_late(grobo_now_us() - due_us);
        write_filler(fd);
    }
    report("floor clock_nanosleep", bench_cpu_us() - begin_us, frames);
}

static struct {
    struct event_base *base;
    struct event *timer;
    int fd, left;
    int64_t due_us;
} bare;

static void on_bare(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    (void)ctx;
    note_late(grobo_now_us() - bare.due_us);
    write_filler(bare.fd);
    bare.due_us += period_us;
    if (--bare.left <= 0) {
        (void)event_base_loopbreak(bare.base);
        return;
    }
    int64_t span_us = bare.due_us - grobo_now_us();
    const struct timeval span = {0, (int)(span_us > 0 ? span_us : 0)};
    (void)event_add(bare.timer, &span);
}

static void libevent_loop(int fd)
{
    const int frames = (int)(SPAN_S * 1000000 / period_us);
    const double begin_us = bench_cpu_us();

    bare.base = grobo_loop_new();
    bare.timer = event_new(bare.base, -1, 0, on_bare, NULL);
    bare.fd = fd;
    bare.left = frames;
    bare.due_us = grobo_now_us() + period_us;
    (void)event_add(bare.timer, &(const struct timeval){0, (int)period_us});
    (void)event_base_dispatch(bare.base);
    report("libevent", bench_cpu_us() - begin_us, frames);
    event_free(bare.timer);
    event_base_free(bare.base);
}

/* ---- ours ----------------------------------------------------------------------------------- */

static int wave_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    (void)ctx;
    const grobo_model *model = played.driver != NULL ? played.driver->model : &grobo_i_gr001_model;
    int r = grobo_posture_init(posture, model->n_joints);
    double by_deg = (double)llabs(t_us % 4000000 - 2000000) / 200000.0;

    for (int j = 0; j < model->n_joints; j++) {
        double init_deg = grobo_deg_from_rad(model->joints[j].init_rad);

        (void)grobo_posture_set_deg(posture, j, j == 12 ? init_deg - by_deg : init_deg + by_deg);
    }
    return r;
}

static int wave_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    *at_us = (int64_t)i * 1000000;
    return wave_sample(ctx, *at_us, posture);
}

typedef struct playing {
    struct event_base *base;
    grobo_session *session;
    double begin_us, cpu_us;
    uint64_t frames, frames_before;
    bool failed;
} playing;

static void on_line(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    playing *p = ctx;
    const grobo_clip clip = {.key = wave_key,
                             .sample = wave_sample,
                             .length_us = (SPAN_S + 1) * INT64_C(1000000),
                             .n_keys = SPAN_S + 2,
                             .n_joints =
                                 played.driver != NULL ? played.driver->model->n_joints : 20};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                        .rate_hz = (uint16_t)(1000000 / period_us),
                                        .unwatched = true};

    (void)error;
    if (event != GROBO_SESSION_EVENT_UP ||
        grobo_robot_play(grobo_session_robot(session), &clip, &options) < 0) {
        p->failed = true;
        (void)event_base_loopbreak(p->base);
    }
}

static void on_robot(void *ctx, const grobo_event *event)
{
    playing *p = ctx;
    const grobo_robot *robot = grobo_session_robot(p->session);

    if (event->kind != GROBO_EVENT_PLAY) {
        return;
    }
    const uint64_t frames = grobo_robot_get_counters(robot)->motion_frames;

    if (event->u.play.to == GROBO_SEQUENCER_PLAYING) {
        p->begin_us = bench_cpu_us();
        p->frames_before = frames;
    } else if (event->u.play.from == GROBO_SEQUENCER_PLAYING) {
        p->cpu_us = bench_cpu_us() - p->begin_us;
        p->frames = frames - p->frames_before;
        (void)event_base_loopbreak(p->base);
    }
}

static bool session_loop(const char *device)
{
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT,
                                      .sense_interval_us = GROBO_SENSE_NEVER};
    playing p = {.base = grobo_loop_new()};
    const grobo_session_config config = {
        GROBO_SESSION_CONFIG_INIT,
        .base = p.base,
        .device = device,
        .baud_bps = (int)played.baud_bps,
        .driver = played.driver != NULL ? played.driver : grobo_gr001_driver(GROBO_WIRING_BUS),
        .robot = &robot,
        .on_event = on_line,
        .on_robot = on_robot,
        .ctx = &p};
    grobo_jitter jitter;

    if (grobo_session_new(&config, &p.session) < 0 || grobo_session_open(p.session) < 0) {
        return false;
    }
    (void)event_base_dispatch(p.base);
    if (!p.failed && p.frames > 0) {
        grobo_robot_jitter(grobo_session_robot(p.session), &jitter);
        row("lateness p50, us", "grobo", (double)jitter.p50_us);
        row("lateness p99, us", "grobo", (double)jitter.p99_us);
        /* At 1000 Hz most postures of a slow motion are the one before, and send nothing. */
        row(played.driver != NULL ? "CPU a period, us" : "CPU a frame, us", "grobo",
            p.cpu_us / (played.driver != NULL ? (SPAN_S + 1) * 1e6 / (double)period_us
                                              : (double)p.frames));
        row("frames skipped", "grobo",
            (double)grobo_robot_get_counters(grobo_session_robot(p.session))->late_frames);
    }
    grobo_session_free(p.session);
    event_base_free(p.base);
    return !p.failed && p.frames > 0;
}

/* ---- the far end ---------------------------------------------------------------------------- */

/* Serves a simulated robot until it is killed, and writes where. */
static void serve(int fd)
{
    struct event_base *base = grobo_loop_new();
    const grobo_sim_server_config config = {GROBO_SIM_SERVER_CONFIG_INIT, .base = base,
                                            .sim = &played.sim};
    grobo_sim_server *server = NULL;

    if (grobo_sim_server_new(&config, &server, NULL) >= 0) {
        const char *device = grobo_sim_server_device(server);

        if (write(fd, device, strlen(device) + 1) > 0) {
            (void)event_base_dispatch(base);
        }
    }
    _exit(1);
}

/* Its process, and its device; -1: there is none. */
static pid_t start_server(char *device, size_t size)
{
    int ends[2];

    if (pipe(ends) != 0) {
        return -1;
    }
    pid_t server = fork();

    if (server == 0) {
        serve(ends[1]);
    }
    (void)close(ends[1]);
    return read(ends[0], device, size - 1) > 0 ? server : -1;
}

static void keep_busy(void)
{
    for (;;) {
        __asm__ volatile("");
    }
}

/* One rate, as a thread like any other; the floors by the same pty. */
static bool measure(const char *device, bool libevent_too)
{
    int fd = open(device, O_RDWR | O_NOCTTY | O_NONBLOCK);

    sleep_loop(fd);
    if (libevent_too) {
        libevent_loop(fd);
    }
    (void)close(fd);
    return session_loop(device);
}

/* The rates of a table, each in a process that gets a priority for the second half. */
static bool measure_realtime(const char *device)
{
    static const int rates_hz[] = {50, 100, 200, 500, 1000};
    const grobo_realtime first = {.policy = GROBO_REALTIME_FIFO, .priority = PRIORITY};
    bool good = true;

    for (int turn = 0; turn < 2; turn++) {
        if (turn == 1) {
            if (grobo_thread_realtime(&first) < 0) {
                fputs("bench_play: no priority is granted here (ulimit -r)\n", stderr);
                return good;
            }
            played.prior = true;
        }
        for (size_t i = 0; i < sizeof rates_hz / sizeof rates_hz[0]; i++) {
            period_us = 1000000 / rates_hz[i];
            good = measure(device, false) && good;
        }
    }
    return good;
}

static bool measure_plain(const char *device)
{
    bool good = true;

    for (period_us = 20000; period_us >= 10000; period_us -= 10000) {
        good = measure(device, true) && good;
    }
    return good;
}

/* Takes the SO-101 instead of GR001. */
static bool take_arm(void)
{
    static grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    static grobo_robot_sim sim;
    const grobo_robot_def *def = grobo_robot_def_find("so101");

    if (def == NULL || grobo_robot_def_driver(def, GROBO_WIRING_BUS, &driver) < 0 ||
        grobo_robot_def_sim(def, GROBO_WIRING_BUS, &sim) < 0) {
        return false;
    }
    played.row = "RT";
    played.driver = &driver;
    played.sim = sim.config;
    played.baud_bps = def->baud_bps;
    played.pose_bytes = 8 + 7 * (size_t)def->model->n_joints; /* a sync write of goal and time */
    return true;
}

int main(int argc, char **argv)
{
    bool realtime = argc > 1 && strcmp(argv[1], "realtime") == 0;
    long n_busy = realtime ? sysconf(_SC_NPROCESSORS_ONLN) : 1;
    pid_t busy[BUSY_MAX];
    char device[128] = "";

    played.sim = (grobo_sim_config){GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS};
    if (realtime && !take_arm()) {
        return 1;
    }
    played.sim.baud_bps = played.baud_bps;
    pid_t server = start_server(device, sizeof device);

    if (server < 0) {
        fputs("bench_play: no simulated robot\n", stderr);
        return 1;
    }
    n_busy = n_busy < 1 ? 1 : n_busy > BUSY_MAX ? BUSY_MAX : n_busy;
    for (long i = 0; i < n_busy; i++) {
        busy[i] = fork();
        if (busy[i] == 0) {
            keep_busy();
        }
    }
    bool good = realtime ? measure_realtime(device) : measure_plain(device);

    for (long i = 0; i < n_busy; i++) {
        (void)kill(busy[i], SIGKILL);
        (void)waitpid(busy[i], NULL, 0);
    }
    (void)kill(server, SIGKILL);
    (void)waitpid(server, NULL, 0);
    if (!good) {
        fputs("bench_play: it does not play\n", stderr);
    }
    return good ? 0 : 1;
}
