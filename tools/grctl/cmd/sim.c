/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <event2/event.h>

#include <grobo/core/robot_plant.h>
#include <grobo/sim_server.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cli/each_line.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/narrow.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/trace.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/sim/chain.h"
#include "tools/grctl/sim/console.h"
#include "tools/grctl/sim/state.h"
#include "tools/grctl/sim/strict.h"

enum {
    OPT_LINK,
    OPT_TCP,
    OPT_SERVO,
    OPT_NO_STOPS,
    OPT_NO_PACING,
    OPT_LATENCY,
    OPT_ROBOTS,
    OPT_SEED,
    OPT_START,
    OPT_FAULT,
    OPT_STRICT,
    OPT_STATE,
    OPT_BAUD_AT_ONCE
};
enum { ROBOTS_MAX = 16 };

static const cli_option options[] = {
    [OPT_LINK] = OPTION_TEXT("link", 'l', "PATH",
                             "keep a symbolic link to the pty; PATH2, PATH3... of more robots"),
    [OPT_TCP] = OPTION_WHOLE("tcp", 0, "PORT", 0, 65535,
                             "listen on 127.0.0.1 too; 0: any port; the next ones for more robots"),
    [OPT_SERVO] = OPTION_TEXT("servo", 0, "ID=TYPE,...",
                              "simulate these servos, on a bus, instead of GR001: RS301CR, "
                              "XL330-M288, STS3215, AX-12A...; an unknown type lists all"),
    [OPT_NO_STOPS] = OPTION_FLAG("no-stops", 0, "shafts meet no mechanical stops"),
    [OPT_NO_PACING] = OPTION_FLAG("no-pacing", 0, "bytes take no time on the wire"),
    [OPT_LATENCY] =
        OPTION_WHOLE("latency", 0, "MS", 0, 255, "latency of the adapter (0; FTDI: 16)"),
    [OPT_ROBOTS] = OPTION_WHOLE("robots", 'n', "N", 1, ROBOTS_MAX,
                                "number of robots, each behind a pty of its own (1)"),
    [OPT_SEED] = OPTION_WHOLE("seed", 0, "N", 0, 4294967295.0, "seed of all random numbers"),
    [OPT_START] = OPTION_CHOICE("start", 0, "init|zero|limp",
                                "where the joints are at power-up; limp: anywhere (init)"),
    [OPT_FAULT] = OPTION_TEXT("fault", 0, "LIST",
                              "KIND=RATE,...: drop flip duplicate delay split rubbish silent dupid "
                              "hangup brownout, or all; rates 0 to 1"),
    [OPT_STRICT] =
        OPTION_FLAG("strict", 0,
                    "report each offence of a client against the protocol; then the exit "
                    "status is 3, else 0"),
    [OPT_STATE] =
        OPTION_TEXT("state", 0, "FILE",
                    "keep the servos' flash in FILE from one simulator to the next; FILE2, "
                    "FILE3... of more robots"),
    [OPT_BAUD_AT_ONCE] = OPTION_FLAG("baud-at-once", 0,
                                     "servos change their baud rate when it is written, not when "
                                     "they restart"),
};

/* What goes with a robot. */
typedef struct watched {
    trace trace;
    sim_strict strict;
    sim_state state;
} watched;

typedef struct farm {
    app *a;
    struct event_base *base;
    struct event *signals[OS_ENDINGS_MAX];
    grobo_sim_server *server[ROBOTS_MAX];
    grobo_sim_physics *physics[ROBOTS_MAX];
    watched watched[ROBOTS_MAX];
    sim_console console;
    sim_chain chain; /* of --servo */
    int n_lines;     /* of the robot: each is a server of its own, one robot after the other */
    grobo_robot_sim robot[GROBO_LINES_MAX]; /* where it is no chain */
    const grobo_model *model[ROBOTS_MAX];   /* of each server */
    int n;
    int signal;
} farm;

/* A trace is told as the host sees it: what the robot receives, the host has sent. */
static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    watched *w = ctx;
    if (direction == GROBO_DIR_RX) {
        sim_strict_bytes(&w->strict, now_us, bytes, size);
    }
    trace_bytes(&w->trace, 0, direction == GROBO_DIR_RX ? GROBO_DIR_TX : GROBO_DIR_RX, now_us,
                bytes, size);
}

static void on_sim(void *ctx, const grobo_sim_event *event)
{
    watched *w = ctx;
    sim_strict_event(&w->strict, event);
    sim_state_event(&w->state, event);
}

static void on_signal(evutil_socket_t number, short what, void *ctx)
{
    farm *f = ctx;
    (void)what;
    f->signal = (int)number;
    event_base_loopbreak(f->base);
}

/*
 * What was ignored when it was started stays so: a shell does that to SIGINT for what a script runs
 * in the background, nohup to SIGHUP. The Ctrl-C is for the program that plays, which needs the
 * robot to leave it in good order.
 */
static int watch_signals(farm *f)
{
    for (int i = 0; i < os_n_endings; i++) {
        if (os_is_ignored(os_endings[i])) {
            continue;
        }
        f->signals[i] = evsignal_new(f->base, os_endings[i], on_signal, f);
        if (!f->signals[i] || evsignal_add(f->signals[i], NULL) != 0) {
            return GROBO_ERR_NOMEM;
        }
    }
    return GROBO_OK;
}

/* The line that a server is for; 0 of a robot that has one. */
static int line_of(const farm *f, int server)
{
    return server % f->n_lines;
}

static const char *line_name(const farm *f, int server)
{
    return f->n_lines > 1 ? robot_of(f->a)->lines[line_of(f, server)].name : NULL;
}

static grobo_sim_config sim_config(const farm *f, int robot)
{
    const app *a = f->a;
    const cli_value *baud = app_global(a, GLOBAL_BAUD), *wiring = app_global(a, GLOBAL_WIRING);
    grobo_sim_config config = f->robot[line_of(f, robot)].config;
    if (app_option(a, OPT_SERVO)->given) {
        config = (grobo_sim_config){
            GROBO_SIM_CONFIG_INIT,
            .model = &f->chain.model,
            .wiring = wiring->given ? (grobo_wiring)wiring->choice : GROBO_WIRING_BUS,
            .servos = f->chain.servos,
            .families = config.families,
            .baud_bps = baud->given ? (uint32_t)baud->number : 0,
        };
    }
    config.no_stops = app_option(a, OPT_NO_STOPS)->given > 0;
    config.latency_us = (uint32_t)app_number(a, OPT_LATENCY, 0) * 1000;
    config.echo = app_global(a, GLOBAL_ECHO)->given > 0 ||
                  (f->n_lines > 1 && robot_of(a)->lines[line_of(f, robot)].echo);
    config.unpaced = app_option(a, OPT_NO_PACING)->given > 0;
    config.seed = (uint32_t)app_number(a, OPT_SEED, 0) + (uint32_t)robot;
    config.baud_at_once = app_option(a, OPT_BAUD_AT_ONCE)->given > 0;
    config.start = (grobo_sim_start)app_option(a, OPT_START)->choice;
    return config;
}

/* The table of all servos; NULL: they are of several. */
static const grobo_servo_table *table_of(const farm *f, int server)
{
    const grobo_sim_config config = sim_config(f, server);
    for (int i = 1; i < config.model->n_joints; i++) {
        if (grobo_servo_series(config.servos[i]) != grobo_servo_series(config.servos[0])) {
            return NULL;
        }
    }
    return grobo_servo_series(config.servos[0]);
}

/* How the servos talk, where all are of one family; else NULL. */
static const grobo_words *words_of(const farm *f, int server)
{
    const grobo_servo_table *table = table_of(f, server);
    return table ? talk_of_servo(&table->models[0]) : NULL;
}

static int open_trace(farm *f, int robot)
{
    grobo_sim_config sim = sim_config(f, robot);
    trace_line line = {.device = grobo_sim_server_device(f->server[robot]),
                       .wiring = sim.wiring,
                       .baud_bps = (int)sim.baud_bps,
                       .number = robot + 1};
    return trace_open(&f->watched[robot].trace, f->a, &line, 1, grobo_now_us());
}

/* PATH of the first robot, PATH2, PATH3... of more; of several lines PATH-NAME, PATH2-NAME.
 * False: too long. */
static bool number_path(const farm *f, const char *path, int server, char *numbered,
                        size_t capacity)
{
    const char *line = line_name(f, server);
    char number[16] = "";
    int robot = server / f->n_lines;
    if (robot > 0) {
        snprintf(number, sizeof number, "%d", robot + 1);
    }
    int n =
        snprintf(numbered, capacity, "%s%s%s%s", path, number, line ? "-" : "", line ? line : "");
    return n >= 0 && (size_t)n < capacity;
}

/* Where programs find a robot. */
typedef struct place {
    char link[GROBO_DEVICE_MAX_BYTES], tcp[32];
    const char *name; /* for messages */
} place;

/* Fills the place, and what leads to it in config. Returns 0, or the exit status. */
static int find_place(const farm *f, int robot, place *at, grobo_sim_server_config *config)
{
    app *a = f->a;
    const char *path = app_option(a, OPT_LINK)->text;
    int port = (int)app_number(a, OPT_TCP, 0);
    config->no_pty = grobo_port_pty_ops() == NULL;
    at->name = config->no_pty ? at->tcp : "pty";
    if (path && config->no_pty) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "sim: --link: there are no pseudo-terminals here; --tcp serves programs");
    }
    if (path) {
        if (!number_path(f, path, robot, at->link, sizeof at->link)) {
            return app_fail(a, EXIT_USAGE, "CAP", "sim: --link: the path is too long");
        }
        config->link = at->name = at->link;
    }
    if (port + robot > 65535) {
        return app_fail(a, EXIT_USAGE, "LIMIT", "sim: --tcp: %d is the last port there is", 65535);
    }
    if (app_option(a, OPT_TCP)->given || config->no_pty) {
        snprintf(at->tcp, sizeof at->tcp, "tcp:127.0.0.1:%d", port ? port + robot : 0);
        config->tcp = at->tcp;
    }
    return 0;
}

/* What could not be opened: nothing but a listener is bound. */
static const char *name_of_failed(const place *at, const grobo_os_cause *cause)
{
    return strncmp(cause->text, "bind", 4) == 0 ? at->tcp : at->name;
}

static int open_state(farm *f, int robot)
{
    const char *path = app_option(f->a, OPT_STATE)->text;
    char numbered[1024];
    if (!path) {
        return 0;
    }
    if (!number_path(f, path, robot, numbered, sizeof numbered)) {
        return app_fail(f->a, EXIT_USAGE, "CAP", "sim: --state: the path is too long");
    }
    return sim_state_start(&f->watched[robot].state, f->a, f->base, f->server[robot], numbered);
}

static int add_robot(farm *f, int robot)
{
    const char *faults = app_option(f->a, OPT_FAULT)->text;
    grobo_sim_config sim = sim_config(f, robot);
    grobo_sim_server_config config = {GROBO_SIM_SERVER_CONFIG_INIT, .base = f->base, .sim = &sim,
                                      .on_tap = on_tap, .ctx = &f->watched[robot]};
    grobo_os_cause cause = {0};
    place at;
    int error = find_place(f, robot, &at, &config);
    if (error) {
        return error;
    }
    sim.hook = on_sim;
    sim.hook_ctx = &f->watched[robot];
    if (app_option(f->a, OPT_STRICT)->given) {
        sim_strict_start(&f->watched[robot].strict, f->a, robot + 1, &sim, words_of(f, robot));
    }
    error = robot_physics(f->a, &sim, &f->physics[robot]);
    if (error) {
        return app_fail_error(f->a, EXIT_ROBOT, error, "sim");
    }
    error = grobo_sim_server_new(&config, &f->server[robot], &cause);
    if (error == GROBO_ERR_NOENT) { /* of the link, whose folder is missing */
        return app_fail(f->a, EXIT_ROBOT, grobo_error_name(error), "sim: %s: %s",
                        name_of_failed(&at, &cause), file_write_error_text(error));
    }
    if (error) {
        return app_fail(f->a, EXIT_ROBOT, grobo_error_name(error), "sim: %s: %s%s%s",
                        name_of_failed(&at, &cause), app_error_text(error), *cause.text ? ": " : "",
                        cause.text);
    }
    f->n = robot + 1;
    f->model[robot] = sim.model;
    if (faults &&
        grobo_sim_set_faults(grobo_sim_server_sim(f->server[robot]), faults, strlen(faults)) < 0) {
        return app_fail(f->a, EXIT_USAGE, "ARG",
                        "sim: --fault: '%s' is not a list such as drop=0.01,flip=0.02; see "
                        "'grctl help sim'",
                        faults);
    }
    error = open_state(f, robot);
    return error ? error : open_trace(f, robot);
}

/* The lines of a robot as -d takes them: NAME=DEVICE,NAME=DEVICE; of one line its device. */
static void device_text(const farm *f, int robot, char *text, size_t capacity)
{
    size_t at = 0;
    *text = '\0';
    for (int i = robot * f->n_lines; i < (robot + 1) * f->n_lines && at < capacity; i++) {
        const char *line = line_name(f, i);
        at += (size_t)snprintf(text + at, capacity - at, "%s%s%s%s", i % f->n_lines > 0 ? "," : "",
                               line ? line : "", line ? "=" : "",
                               grobo_sim_server_device(f->server[i]));
    }
}

static json_t *port_json(const farm *f, int server)
{
    int port = grobo_sim_server_tcp_port(f->server[server]);
    return port > 0 ? json_integer(port) : NULL;
}

static json_t *robot_json(const farm *f, int robot, const char *device)
{
    json_t *lines = f->n_lines > 1 ? json_array() : NULL;
    for (int i = robot * f->n_lines; i < (robot + 1) * f->n_lines && lines; i++) {
        json_array_append_new(lines, json_pack("{s:s,s:s,s:o*}", "name", line_name(f, i), "device",
                                               grobo_sim_server_device(f->server[i]), "tcp_port",
                                               port_json(f, i)));
    }
    return json_pack("{s:s,s:o*,s:o*}", "device", device, "tcp_port",
                     lines ? NULL : port_json(f, robot), "lines", lines);
}

/*
 * Standard output is data: the device alone, so that a script can read it. False when it cannot be
 * told: nobody would find the robot.
 */
static bool announce(const farm *f)
{
    json_t *list = json_array();
    char device[GROBO_LINES_MAX * GROBO_DEVICE_MAX_BYTES];
    for (int robot = 0; robot < f->n / f->n_lines; robot++) {
        device_text(f, robot, device, sizeof device);
        json_array_append_new(list, robot_json(f, robot, device));
        if (!f->a->json) {
            app_print("%s\n", device);
        }
    }
    for (int i = 0; i < f->n; i++) {
        int port = grobo_sim_server_tcp_port(f->server[i]);
        if (port > 0 && grobo_port_pty_ops() != NULL) {
            output_flush();
            app_note(f->a, "also at tcp:127.0.0.1:%d", port);
        }
    }
    if (f->a->json) {
        app_print_json(json_pack("{s:b,s:o}", "simulated", 1, "robots", list));
    } else {
        json_decref(list);
    }
    if (!output_flush()) {
        return false;
    }
    app_note(f->a, "SIMULATED robot%s, no motor moves anywhere; Ctrl-C ends it",
             f->n == f->n_lines ? "" : "s");
    return true;
}

/* What is not known of its weight. */
static void tell_weight(const farm *f)
{
    const grobo_sim_physics *physics = f->physics[0];
    grobo_sim_physics_view view;
    if (!physics) {
        return;
    }
    if (app_option(f->a, OPT_SERVO)->given || !grobo_robot_def_has_weight(robot_of(f->a))) {
        app_note(f->a, "no masses of its links are known: only motors and friction are simulated");
    }
    for (int i = 0; grobo_sim_physics_look(physics, i, &view) == 0; i++) {
        if (view.motor->from == GROBO_SIM_MOTOR_DATA_SHEET) {
            app_note(f->a, "motors of %s are not identified: friction and inertia are chosen",
                     view.motor->model);
            return;
        }
    }
}

static int close_farm(farm *f, int status)
{
    for (int i = 0; i < f->n; i++) {
        status = sim_state_end(&f->watched[i].state, status);
        grobo_sim_server_free(f->server[i]);
        status = trace_close(&f->watched[i].trace, f->a, status);
    }
    for (int i = 0; i < ROBOTS_MAX; i++) {
        uint64_t skipped = grobo_sim_physics_skipped(f->physics[i]);
        if (skipped > 0) {
            app_note(f->a, "%llu steps of 1 ms were skipped: this machine was too slow or slept",
                     (unsigned long long)skipped);
        }
        grobo_sim_physics_free(f->physics[i]);
    }
    for (int i = 0; i < os_n_endings; i++) {
        if (f->signals[i]) {
            event_free(f->signals[i]);
        }
    }
    if (f->base) {
        event_base_free(f->base);
    }
    return status;
}

/* However it was ended: whether the clients kept to the protocol. */
static int strict_status(farm *f)
{
    uint64_t offences = 0;
    for (int i = 0; i < f->n; i++) {
        sim_strict_end(&f->watched[i].strict);
        offences += f->watched[i].strict.offences;
    }
    app_note(f->a, "%llu offence%s against the protocol", (unsigned long long)offences,
             offences == 1 ? "" : "s");
    return offences > 0 ? EXIT_FILE : EXIT_DONE;
}

/* Until a signal, or until somebody says quit. */
static int serve(farm *f)
{
    f->console = (sim_console){
        .a = f->a, .base = f->base, .model = f->model, .server = f->server, .n = f->n};
    f->console.payload_link = robot_payload_link(f->a);
    int error = sim_console_start(&f->console) ? GROBO_OK : GROBO_ERR_NOMEM;
    if (!error && event_base_dispatch(f->base) < 0) {
        error = GROBO_ERR_IO;
    }
    sim_console_stop(&f->console);
    if (error) {
        return app_fail_error(f->a, EXIT_ROBOT, error, "sim");
    }
    if (app_option(f->a, OPT_STRICT)->given) {
        return strict_status(f);
    }
    return f->signal ? EXIT_SIGNAL + f->signal : EXIT_DONE;
}

/* What knows RS30x and GR001's board only. */
static int check_families(const farm *f, int line)
{
    const app *a = f->a;
    if (table_of(f, line) == grobo_rs30x_table()) {
        return 0;
    }
    if (app_option(a, OPT_STRICT)->given && !words_of(f, line)) {
        return app_fail(f->a, EXIT_USAGE, "UNSUPPORTED",
                        "sim: --strict: knows one family on a line; use it with servos of one");
    }
    if (app_option(a, OPT_STATE)->given) {
        return app_fail(f->a, EXIT_USAGE, "UNSUPPORTED",
                        "sim: --state: keeps the flash of RS30x only; use it without other servos");
    }
    if (app_global(a, GLOBAL_WIRING)->given &&
        app_global(a, GLOBAL_WIRING)->choice == GROBO_WIRING_BOARD) {
        return app_fail(f->a, EXIT_USAGE, "UNSUPPORTED",
                        "sim: --wiring board: relays to RS30x only; use --wiring bus");
    }
    return 0;
}

/* What is simulated behind each pty: the robot, or what of it is on a line. */
static int take_lines(farm *f)
{
    const grobo_robot_def *def = robot_of(f->a);
    f->n_lines = def->n_lines > 0 ? def->n_lines : 1;
    robot_sim(f->a, &f->robot[0]);
    for (int i = 0; i < def->n_lines; i++) {
        const grobo_robot_def *line = narrow_def(def, i);
        int error = line ? grobo_robot_def_sim(line, line->wiring, &f->robot[i]) : GROBO_ERR_NOMEM;
        if (error) {
            return app_fail_error(f->a, EXIT_ROBOT, error, "sim");
        }
    }
    return each_line_refuse_trace(f->a);
}

static int run(app *a)
{
    static farm f;
    int robots = (int)app_number(a, OPT_ROBOTS, 1);
    int status = 0;
    memset(&f, 0, sizeof f);
    f.a = a;
    os_take_signals();
    f.base = grobo_loop_new();
    if (!f.base || watch_signals(&f) != GROBO_OK) {
        status = app_fail_error(a, EXIT_ROBOT, GROBO_ERR_NOMEM, "sim");
    }
    if (!status) {
        status = take_lines(&f);
    }
    if (app_option(a, OPT_SERVO)->given && !status) {
        f.n_lines = 1;
        status = sim_chain_read(a, &f.chain, app_option(a, OPT_SERVO)->text);
    }
    if (!status && robots * f.n_lines > ROBOTS_MAX) {
        status = app_fail(a, EXIT_USAGE, "CAP", "sim: %d lines, at most %d are simulated",
                          robots * f.n_lines, ROBOTS_MAX);
    }
    for (int i = 0; i < f.n_lines && !status; i++) {
        status = check_families(&f, i);
    }
    for (int i = 0; i < robots * f.n_lines && !status; i++) {
        status = add_robot(&f, i);
    }
    if (!status && announce(&f)) {
        tell_weight(&f);
        status = serve(&f);
    }
    return close_farm(&f, status);
}

const cli_command cmd_sim = {
    .name = "sim",
    .arguments = "",
    .summary = "simulate a robot behind a pty, for any program",
    .details =
        "Runs a simulated robot (GR001, or that of --robot), or a chain of servos, until a\n"
        "signal. Prints the path of its pty, one line a robot, when it can be opened; where\n"
        "there are no ptys (Windows) that of its TCP port. Of a robot of several lines each has\n"
        "a pty: the line printed is for -d (left=PTY,right=PTY), the links are PATH-left and\n"
        "PATH-right, and on standard input each line is a robot. The robot is honest at register\n"
        "level and bytes take their time on the wire; programs may come and go, it stays as\n"
        "they left it.\n"
        "\n"
        "With --strict each offence of a client is a line on standard error, with --json an\n"
        "object on standard output: a wrong sum, a value out of range or a read-only register,\n"
        "bytes that are no frame or cut off, talking over a reply, writing to a servo that\n"
        "writes its flash or restarts, a pause inside a packet, a wrong count of bytes to\n"
        "return. The exit status is then 3, and 0 where there was none, whatever ended it:\n"
        "tests of any library for such servos may run against it.\n"
        "\n"
        "While it runs it takes commands on standard input, when that is a terminal or a pipe.\n"
        "SERVO is a motor's number, a joint or a group; angles are the shaft's.\n"
        "\n" SIM_CONSOLE_HELP,
    .example = "  grctl sim --link /tmp/gr001\n"
               "  grctl sim --robot so101 --link /tmp/arm\n"
               "  grctl sim --wiring bus --fault drop=0.01,flip=0.001 --seed 7\n"
               "  grctl sim --servo 1=RS304MD,2=RS302CD --no-stops --state servos.state\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
