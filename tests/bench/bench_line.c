/* SPDX-License-Identifier: MIT */
/*
 * Servos at the far end of pseudo-terminals, which know of no library, and the clients in C that
 * are measured against them.
 *
 * usage: bench_line serve BPS LATE_PERCENT LATE_US LINES COMMAND...
 *   runs the command with the paths of the lines behind its arguments, and answers until it ends.
 *   BPS: a reply comes when both frames have had their time on such a wire; 0: at once.
 *        bench_line session|session20|sensing|runner|libevent|libmodbus N PATH...
 *   session: a job each; session20: the same with GR001's joints on a bus, in turn; sensing: in the
 *   background, as fast as the line allows; runner: grobo_runner_read_angle() of these joints by a
 *   thread beside the runner's.
 *   makes N transactions in all, one at a time on each line; prints transactions a second,
 *   microseconds of processor time of each, and the p99 of the lateness of a timer of 10 ms beside
 *   them.
 *        bench_line cycle SECONDS PATH
 *   sends GR001 a pose and reads 20 full states, over and over: cycles a second, and those that the
 *   wire has time for.
 */
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <event2/event.h>

#include <grobo/core/loop.h>
#include <grobo/core/robot.h>
#include <grobo/core/rs30x.h>
#include <grobo/core/runner.h>
#include <grobo/session.h>

#include "tests/bench/bench.h"
#include "tests/bench/one_servo.h"
#include "tests/support/tables.h"

enum { LINES_MAX = 512, FRAME_MAX = 256, PROBE_US = 10000, PROBES = 4096, TIMEOUT_US = 50000 };

/* ---- the servos ------------------------------------------------------------------------------ */

typedef struct servo_line {
    uint8_t got[FRAME_MAX], reply[4 * FRAME_MAX];
    size_t used, size; /* of both */
    int64_t due_us;    /* of the replies that wait */
} servo_line;

static struct {
    servo_line line[LINES_MAX];
    struct pollfd wait[LINES_MAX + 1]; /* the last one tells the end of the command */
    char path[LINES_MAX][64];
    int lines;
    long bps, late_percent, late_us, replies;
} far_end;

static uint8_t xor_of(const uint8_t *bytes, size_t n)
{
    uint8_t sum = 0;

    while (n-- > 0) {
        sum ^= *bytes++;
    }
    return sum;
}

/* RS30x: FD DF id flags address length count, data, sum. */
static size_t answer_rs30x(const uint8_t *p, size_t n, uint8_t *reply)
{
    size_t data = p[5];

    if (n < 8 || p[3] != 0x0F) {
        return 0;
    }
    const uint8_t header[] = {0xFD, 0xDF, p[2], 0, p[4], p[5], 1};
    memcpy(reply, header, sizeof header);
    memset(reply + 7, 0, data);
    reply[7 + data] = xor_of(reply + 2, 5 + data);
    return 8 + data;
}

/* Dynamixel 1 and Feetech: FF FF id length error, data, sum; a sync read (82) asks several. */
static size_t answer_dxl1(const uint8_t *p, size_t n, uint8_t *reply)
{
    bool sync = p[4] == 0x82;
    size_t data = p[4] == 2 || sync ? p[6] : 0;
    size_t count = sync ? p[3] - 4u : 1, size = 0;

    if (n < p[3] + 4u) {
        return 0;
    }
    for (size_t i = 0; i < count; i++) {
        uint8_t *to = reply + size;
        const uint8_t header[] = {0xFF, 0xFF, sync ? p[7 + i] : p[2], (uint8_t)(data + 2), 0};

        memcpy(to, header, sizeof header);
        memset(to + 5, 1, data);
        to[5 + data] = (uint8_t) ~(to[2] + to[3] + data);
        size += 6 + data;
    }
    return size;
}

/* Modbus RTU, function 3: id 3 bytes, data, sum. */
static size_t answer_modbus(const uint8_t *p, size_t n, uint8_t *reply)
{
    uint16_t crc = 0xFFFF;
    size_t data = n < 8 ? 0 : 2u * p[5];

    if (n < 8) {
        return 0;
    }
    memset(reply, 0, 3 + data);
    reply[0] = p[0];
    reply[1] = p[1];
    reply[2] = (uint8_t)data;
    for (size_t i = 0; i < 3 + data; i++) {
        crc ^= reply[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (uint16_t)(crc >> 1 ^ ((crc & 1) != 0 ? 0xA001 : 0));
        }
    }
    reply[3 + data] = (uint8_t)crc;
    reply[4 + data] = (uint8_t)(crc >> 8);
    return 5 + data;
}

static void hear(int at)
{
    servo_line *line = &far_end.line[at];
    ssize_t got = read(far_end.wait[at].fd, line->got + line->used, FRAME_MAX - line->used);

    if (got <= 0) {
        return;
    }
    line->used += (size_t)got;
    if (line->used < 6 || line->size > sizeof line->reply - FRAME_MAX) {
        return;
    }
    uint8_t *reply = line->reply + line->size;
    size_t size = line->got[0] == 0xFA   ? answer_rs30x(line->got, line->used, reply)
                  : line->got[0] == 0xFF ? answer_dxl1(line->got, line->used, reply)
                                         : answer_modbus(line->got, line->used, reply);
    if (size == 0) {
        return;
    }
    int64_t due_us = grobo_now_us();
    if (far_end.bps > 0) {
        due_us += (int64_t)(line->used + size) * 10000000 / far_end.bps;
    }
    far_end.replies++;
    if (far_end.late_percent > 0 && far_end.replies % (100 / far_end.late_percent) == 0) {
        due_us += far_end.late_us;
    }
    if (line->size == 0 || due_us > line->due_us) { /* behind one that is late they wait, too */
        line->due_us = due_us;
    }
    line->size += size;
    line->used = 0;
}

/* Sends what is due; when to look again. */
static int64_t answer(int64_t now_us)
{
    int64_t next_us = GROBO_NEVER_US;

    for (int i = 0; i < far_end.lines; i++) {
        servo_line *line = &far_end.line[i];

        if (line->size > 0 && line->due_us <= now_us) {
            if (write(far_end.wait[i].fd, line->reply, line->size) < 0) {
                perror("bench_line");
            }
            line->size = 0;
        } else if (line->size > 0 && line->due_us < next_us) {
            next_us = line->due_us;
        }
    }
    return next_us;
}

/* The last of the time to a reply is not slept: sleeping is not as exact as a wire. */
static void serve_until_end(void)
{
    enum { SPIN_US = 150 };
    int64_t next_us = GROBO_NEVER_US;

    for (;;) {
        int64_t now_us = grobo_now_us();
        int64_t left_us = next_us - now_us - SPIN_US;
        int wait_ms = next_us == GROBO_NEVER_US ? -1 : left_us < 0 ? 0 : (int)(left_us / 1000);

        if (poll(far_end.wait, (nfds_t)far_end.lines + 1, wait_ms) > 0) {
            if (far_end.wait[far_end.lines].revents != 0) {
                return;
            }
            for (int i = 0; i < far_end.lines; i++) {
                if ((far_end.wait[i].revents & POLLIN) != 0) {
                    hear(i);
                }
            }
        }
        next_us = answer(grobo_now_us());
    }
}

/* The near end stays open here, so that the far end never hangs up. */
static bool open_line(int at)
{
    struct termios raw;
    int far = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);

    if (far < 0 || grantpt(far) != 0 || unlockpt(far) != 0 || ptsname(far) == NULL) {
        return false;
    }
    (void)snprintf(far_end.path[at], sizeof far_end.path[at], "%s", ptsname(far));
    int near = open(far_end.path[at], O_RDWR | O_NOCTTY | O_CLOEXEC);

    if (near < 0 || tcgetattr(near, &raw) != 0) {
        return false;
    }
    cfmakeraw(&raw);
    far_end.wait[at] = (struct pollfd){.fd = far, .events = POLLIN};
    return tcsetattr(near, TCSANOW, &raw) == 0 && fcntl(far, F_SETFL, O_NONBLOCK) == 0;
}

static int serve(char **argv)
{
    enum { ARGS_MAX = 64 };
    char *args[ARGS_MAX + LINES_MAX + 1];
    int ends[2], status = 0, n = 0;

    far_end.bps = bench_number(argv[0]);
    far_end.late_percent = bench_number(argv[1]);
    far_end.late_us = bench_number(argv[2]);
    far_end.lines = (int)bench_number(argv[3]);
    for (argv += 4; *argv != NULL && n < ARGS_MAX; argv++) {
        args[n++] = *argv;
    }
    for (int i = 0; i < far_end.lines; i++) {
        if (i >= LINES_MAX || !open_line(i)) {
            perror("bench_line: no pseudo-terminal");
            return 1;
        }
        args[n++] = far_end.path[i];
    }
    args[n] = NULL;
    if (pipe(ends) != 0) {
        return 1;
    }
    pid_t child = fork();

    if (child == 0) {
        (void)close(ends[0]);
        (void)execvp(args[0], args);
        perror(args[0]);
        _exit(127);
    }
    (void)close(ends[1]);
    far_end.wait[far_end.lines] = (struct pollfd){.fd = ends[0], .events = POLLIN};
    serve_until_end();
    return waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

/* ---- the clients ----------------------------------------------------------------------------- */

static struct {
    struct event_base *base;
    struct event *probe;
    long wanted, begun, ended, failed;
    int64_t due_us;
    double late_us[PROBES];
    int probes;
} run;

/* True where there is one more to begin. */
static bool next_transaction(bool good)
{
    run.ended++;
    run.failed += good ? 0 : 1;
    if (run.ended >= run.wanted) {
        (void)event_base_loopbreak(run.base);
    }
    return run.begun < run.wanted && ++run.begun > 0;
}

static void on_probe(evutil_socket_t fd, short what, void *ctx)
{
    int64_t now_us = grobo_now_us();

    (void)fd;
    (void)what;
    (void)ctx;
    if (run.probes < PROBES) {
        run.late_us[run.probes++] = (double)(now_us - run.due_us);
    }
    while (run.due_us <= now_us) {
        run.due_us += PROBE_US;
    }
    const struct timeval span = {0, (int)(run.due_us - now_us)};
    (void)event_add(run.probe, &span);
}

/* Both loops are of the same kind. */
static void begin_run(void)
{
    run.base = grobo_loop_new();
    run.probe = event_new(run.base, -1, 0, on_probe, NULL);
}

static void turn(void)
{
    if (getenv("GROBO_BENCH_STILL") == NULL) { /* what is counted has no timer beside it */
        run.due_us = grobo_now_us();
        on_probe(-1, 0, NULL);
        run.probes = 0;
    }
    (void)event_base_dispatch(run.base);
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static int report(int64_t begin_us, double begin_cpu_us)
{
    const double took_s = (double)(grobo_now_us() - begin_us) / 1e6;
    const double cpu_us = bench_cpu_us() - begin_cpu_us;

    qsort(run.late_us, (size_t)run.probes, sizeof run.late_us[0], by_value);
    printf("%.1f %.3f %.1f\n", (double)run.ended / took_s, cpu_us / (double)run.ended,
           run.probes > 0 ? run.late_us[run.probes * 99 / 100] : 0);
    if (run.failed > 0) {
        fprintf(stderr, "bench_line: %ld of %ld failed\n", run.failed, run.ended);
    }
    return run.failed * 100 > run.ended ? 1 : 0;
}

/* The floor: what any client on libevent does, and nothing else: a timeout for each reply, too. */
typedef struct bare_line {
    struct event *readable;
    int fd;
    size_t used;
} bare_line;

static void bare_send(const bare_line *line)
{
    static const uint8_t request[] = {0xFA, 0xAF, 1, 0x0F, 0x2A, 2, 0, 1 ^ 0x0F ^ 0x2A ^ 2};

    if (write(line->fd, request, sizeof request) != (ssize_t)sizeof request) {
        perror("bench_line");
    }
    (void)event_add(line->readable, &(const struct timeval){0, TIMEOUT_US});
}

static void bare_read(evutil_socket_t fd, short what, void *ctx)
{
    enum { REPLY = 10 };
    bare_line *line = ctx;
    uint8_t bytes[64];
    ssize_t got = read(fd, bytes, sizeof bytes);

    (void)what;
    line->used += got > 0 ? (size_t)got : 0;
    if (line->used >= REPLY) {
        line->used = 0;
        if (next_transaction(true)) {
            bare_send(line);
        }
    }
}

static int run_libevent(int lines, char **path)
{
    bare_line *line = calloc((size_t)lines, sizeof *line);

    begin_run();
    for (int i = 0; line != NULL && i < lines; i++) {
        line[i].fd = open(path[i], O_RDWR | O_NOCTTY | O_NONBLOCK);
        line[i].readable =
            event_new(run.base, line[i].fd, EV_READ | EV_PERSIST, bare_read, &line[i]);
    }
    const int64_t begin_us = grobo_now_us();
    const double begin_cpu_us = bench_cpu_us();

    for (int i = 0; line != NULL && i < lines; i++) {
        run.begun++;
        bare_send(&line[i]);
    }
    turn();
    return report(begin_us, begin_cpu_us);
}

/* Ours: a session on each line, of one servo. */
static grobo_session **sessions;
static int n_sessions, n_up;
static bool in_background;
static int n_joints = 1, next_joint;

static void sense(grobo_session *session)
{
    const grobo_joint_mask joint = (grobo_joint_mask)1 << next_joint;

    next_joint = (next_joint + 1) % n_joints;
    if (grobo_robot_sense(grobo_session_robot(session), joint, GROBO_SENSE_POSITION) < 0) {
        (void)next_transaction(false);
    }
}

static void on_line(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    (void)session;
    (void)ctx;
    if (event != GROBO_SESSION_EVENT_UP) {
        fprintf(stderr, "bench_line: session lost: %d\n", error);
        exit(1);
    }
    if (++n_up == n_sessions) {
        (void)event_base_loopbreak(run.base);
    }
}

static void on_robot(void *ctx, const grobo_event *event)
{
    grobo_session **session = ctx;

    if (event->kind == (in_background ? GROBO_EVENT_JOINT : GROBO_EVENT_JOB) &&
        next_transaction((in_background ? event->u.joint.result : event->u.job.result) ==
                         GROBO_OK) &&
        !in_background) {
        sense(*session);
    }
}

/* The robot of one servo, or GR001's joints without its board. */
static int begin_driver(grobo_driver *driver)
{
    return grobo_rs30x_driver_init(driver, n_joints == 1 ? &one_servo_model : &grobo_i_gr001_model,
                                   &grobo_i_rs30x_protocol);
}

static int run_sessions(int lines, char **path)
{
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT,
                                      .sense_interval_us = in_background ? 1 : GROBO_SENSE_NEVER,
                                      .sense_position_only = true};
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);

    if (begin_driver(&driver) < 0) {
        return 1;
    }
    begin_run();
    n_sessions = lines;
    sessions = calloc((size_t)lines, sizeof *sessions);
    if (sessions == NULL) {
        return 1;
    }
    for (int i = 0; i < lines; i++) {
        const grobo_session_config config = {
            GROBO_SESSION_CONFIG_INIT, .base = run.base,     .device = path[i],
            .driver = &driver,         .robot = &robot,      .skip_check = true,
            .on_event = on_line,       .on_robot = on_robot, .ctx = &sessions[i]};

        if (grobo_session_new(&config, &sessions[i]) < 0 || grobo_session_open(sessions[i]) < 0) {
            fputs("bench_line: cannot open a session\n", stderr);
            return 1;
        }
    }
    (void)event_base_dispatch(run.base);
    const int64_t begin_us = grobo_now_us();
    const double begin_cpu_us = bench_cpu_us();

    run.ended = 0;
    for (int i = 0; !in_background && i < lines; i++) {
        run.begun++;
        sense(sessions[i]);
    }
    turn();
    return report(begin_us, begin_cpu_us);
}

/* The interface of threads: each call waits for its answer. */
static int run_runner(const char *path)
{
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT,
                                      .sense_interval_us = GROBO_SENSE_NEVER};
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    grobo_runner *runner = NULL;
    double angle_rad;

    n_joints = 20;
    if (begin_driver(&driver) < 0) {
        return 1;
    }
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = path,
                                          .driver = &driver, .robot = &robot, .skip_check = true};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};

    if (grobo_runner_new(&config, &runner) < 0 || grobo_runner_start(runner) < 0 ||
        grobo_runner_connect(runner, 0) < 0) {
        fputs("bench_line: cannot start a runner\n", stderr);
        return 1;
    }
    const int64_t begin_us = grobo_now_us();
    const double begin_cpu_us = bench_cpu_us();

    for (; run.ended < run.wanted; run.ended++) {
        const int joint = (int)(run.ended % n_joints);

        run.failed += grobo_runner_read_angle(runner, joint, &angle_rad, 0) == GROBO_OK ? 0 : 1;
    }
    int failed = report(begin_us, begin_cpu_us);

    grobo_runner_free(runner);
    return failed;
}

/* ---- a robot's whole cycle ------------------------------------------------------------------ */

/* A pose, then all joints in full, through the board, for some seconds. */
static struct {
    grobo_session *session;
    grobo_posture pose;
    int64_t end_us, begin_us;
    long count;
    long lost; /* cycles in which a servo of a busy machine did not answer in time */
    int error; /* of the last of them */
} cycle;

static void on_cycle(void *ctx, const grobo_event *event)
{
    grobo_robot *robot = grobo_session_robot(cycle.session);
    int64_t now_us = grobo_now_us();
    int r = 0;

    (void)ctx;
    if (event->kind != GROBO_EVENT_JOB) {
        return;
    }
    if (event->u.job.kind == GROBO_JOB_CHECK) {
        return;
    }
    if (event->u.job.kind == GROBO_JOB_TORQUE) {
        cycle.begin_us = now_us;
        cycle.end_us += now_us;
    } else if (event->u.job.result >= 0) {
        cycle.count++;
    } else {
        cycle.lost++;
        cycle.error = event->u.job.result;
    }
    if (now_us >= cycle.end_us || (r = grobo_robot_send(robot, &cycle.pose)) < 0 ||
        (r = grobo_robot_sense(robot, GROBO_JOINTS_ALL(20), GROBO_SENSE_FULL)) < 0) {
        run.failed += r < 0;
        cycle.error = r < 0 ? r : cycle.error;
        (void)event_base_loopbreak(run.base);
    }
}

static void on_cycle_line(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    (void)error;
    (void)ctx;
    if (event != GROBO_SESSION_EVENT_UP ||
        grobo_robot_torque(grobo_session_robot(session), GROBO_JOINTS_ALL(20), GROBO_TORQUE_ON) <
            0) {
        run.failed++;
        (void)event_base_loopbreak(run.base);
    }
}

/* Prints cycles a second, and how many the wire allows. */
static int run_cycle(long seconds, const char *path)
{
    const grobo_robot_config robot = {GROBO_ROBOT_CONFIG_INIT,
                                      .sense_interval_us = GROBO_SENSE_NEVER};
    grobo_budget budget;

    begin_run();
    cycle.end_us = seconds * 1000000;
    (void)grobo_posture_init_pose(&cycle.pose, &grobo_i_gr001_model);
    cycle.pose.time_us = 200000;
    const grobo_session_config config = {
        GROBO_SESSION_CONFIG_INIT, .base = run.base,          .device = path,
        .robot = &robot,           .on_event = on_cycle_line, .on_robot = on_cycle};

    if (grobo_session_new(&config, &cycle.session) < 0 || grobo_session_open(cycle.session) < 0) {
        return 1;
    }
    (void)event_base_dispatch(run.base);
    if (run.failed > 0 || cycle.count == 0 || cycle.lost * 10 > cycle.count ||
        grobo_robot_budget(grobo_session_robot(cycle.session), &budget) < 0) {
        fprintf(stderr, "bench_line: no cycle: %s, after %ld\n", grobo_error_text(cycle.error),
                cycle.count);
        return 1;
    }
    printf("%.3f %.3f\n", (double)cycle.count * 1e6 / (double)(grobo_now_us() - cycle.begin_us),
           1e6 / (double)(budget.motion_us + 20 * budget.reading_us));
    grobo_session_free(cycle.session);
    return 0;
}

/* A peer, where GROBO_LIBMODBUS names it: no header of it is needed. */
static int run_libmodbus(char **path)
{
    const char *file = getenv("GROBO_LIBMODBUS");
    void *peer = file != NULL ? dlopen(file, RTLD_NOW) : NULL;

    if (peer == NULL) {
        return 77;
    }
    void *(*new_rtu)(const char *, int, char, int, int);
    int (*set_slave)(void *, int), (*connect)(void *);
    int (*read_registers)(void *, int, int, uint16_t *);

    *(void **)&new_rtu = dlsym(peer, "modbus_new_rtu");
    *(void **)&set_slave = dlsym(peer, "modbus_set_slave");
    *(void **)&connect = dlsym(peer, "modbus_connect");
    *(void **)&read_registers = dlsym(peer, "modbus_read_registers");
    void *modbus = new_rtu(path[0], 115200, 'N', 8, 1);

    if (modbus == NULL || set_slave(modbus, 1) != 0 || connect(modbus) != 0) {
        return 1;
    }
    const int64_t begin_us = grobo_now_us();
    const double begin_cpu_us = bench_cpu_us();

    for (; run.ended < run.wanted; run.ended++) {
        uint16_t value;

        run.failed += read_registers(modbus, 0x2A, 1, &value) == 1 ? 0 : 1;
    }
    return report(begin_us, begin_cpu_us);
}

int main(int argc, char **argv)
{
    if (argc > 6 && strcmp(argv[1], "serve") == 0) {
        return serve(argv + 2);
    }
    if (argc < 4) {
        return argc == 1 ? 0 : 2;
    }
    run.wanted = bench_number(argv[2]);
    if (strcmp(argv[1], "libmodbus") == 0) {
        return run_libmodbus(argv + 3);
    }
    if (strcmp(argv[1], "cycle") == 0) {
        return run_cycle(run.wanted, argv[3]);
    }
    if (strcmp(argv[1], "runner") == 0) {
        return run_runner(argv[3]);
    }
    in_background = strcmp(argv[1], "sensing") == 0;
    n_joints = strcmp(argv[1], "session20") == 0 ? 20 : 1;
    return in_background || strncmp(argv[1], "session", 7) == 0 ? run_sessions(argc - 3, argv + 3)
                                                                : run_libevent(argc - 3, argv + 3);
}
