/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include <event2/event.h>

#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>
#include <grobo/estop.h>
#include <grobo/sim_server.h>

#include "src/base/instant.h"
#include "src/base/sized.h"
#include "src/link/serial/loop.h"
#include "src/sim/servo/servo.h"

/* How often one end is read before others have their turn: a wire without pace never is full. */
#define READS_MAX 8

/*
 * A program that writes faster than the line carries leaves a backlog in the system when it closes:
 * the next one would wait for minutes. While somebody waits, such a backlog is read ahead of the
 * line, so that its end is seen; it is dropped then, or where it is larger than this, which is more
 * than any program that looks after its line writes ahead.
 */
#define AHEAD_BYTES 65536

/* How often a backlog is looked at: whether its program has left, or more of it has come. */
#define LOOK_US 2000

/*
 * A packet's bytes come to a program together, when the last of them is over, as from a USB
 * adapter; those of a packet that takes longer after at most this time, a frame of full-speed USB
 * (USB 2.0, 4.2.1). A wake for each byte would cost more than its time on the wire.
 */
#define GATHER_US 1000

/* How long nobody is let in after a failure: the system has no descriptor, and who calls waits. */
#define DOOR_SHUT_US 100000

/* Where programs come in. */
enum { END_PTY, END_TCP, ENDS };

typedef struct {
    grobo_sim_server *server;
    const grobo_port_ops *ops;
    grobo_port *port;
    struct event *readable; /* NULL: closed */
    bool paused;            /* there is more than the simulator takes now */
    bool armed;             /* readable is waited for */
    bool waits;             /* until the other end's backlog is over */
    bool left;              /* pty: the program that wrote its backlog has closed it */
    size_t ahead_bytes;     /* read and not yet given to the simulator */
    uint8_t ahead[AHEAD_BYTES];
} end;

struct grobo_sim_server {
    grobo_sim_server_config config;
    char link[GROBO_DEVICE_MAX_BYTES];
    char tcp[GROBO_DEVICE_MAX_BYTES];
    char device[GROBO_DEVICE_MAX_BYTES];
    grobo_timer *timer;
    end ends[ENDS];
    end *answers; /* the end that spoke last, which the board answers */
    grobo_socket listener;
    struct event *callers; /* NULL: not listening */
    bool knocked;          /* a caller waits until the one before has gone */
    int tcp_port;
    int baud_bps; /* of the board's port, and what programs find */
    bool paced;
    int64_t replug_us; /* when to come back; GROBO_NEVER_US: plugged in, or stays away */
    int64_t door_us;   /* when callers are let in again; GROBO_NEVER_US: they are */
    size_t bytes;      /* of all this, as the robot has joints */
    grobo_sim sim;     /* the last member: grobo_i_sim_bytes() */
};

static void tap(const grobo_sim_server *server, grobo_direction direction, int64_t now_us,
                const uint8_t *bytes, size_t size)
{
    if (server->config.on_tap != NULL) {
        server->config.on_tap(server->config.ctx, direction, now_us, bytes, size);
    }
}

/* ---- ends --------------------------------------------------------------------------------- */

static void end_close(end *e)
{
    if (e->readable != NULL) {
        event_free(e->readable);
        e->readable = NULL;
        e->ops->close(e->port);
    }
    e->paused = e->armed = e->waits = e->left = false;
    e->ahead_bytes = 0;
    if (e->server->answers == e) {
        e->server->answers = NULL;
    }
}

/* What a program sets at its end of the pseudo-terminal, the simulated line has too. */
static void follow_baud(grobo_sim_server *server, const end *e)
{
    int baud_bps = e == &server->ends[END_PTY] ? grobo_port_pty_baud(e->port) : 0;

    if (baud_bps > 0 && server->paced) {
        /* A rate too low for a line is a rate at which nothing is understood: the old one. */
        (void)grobo_sim_set_line_bps(&server->sim, (uint32_t)baud_bps);
    }
}

static end *other_end(const end *e)
{
    return &e->server->ends[e == &e->server->ends[END_PTY] ? END_TCP : END_PTY];
}

/* What a program has left behind, here and on the line, makes way for the next one. */
static void forget(end *e)
{
    e->ahead_bytes = 0;
    if (!grobo_sim_hung_up(&e->server->sim)) {
        grobo_sim_plug(&e->server->sim, true, grobo_now_us());
    }
}

/* Whether a backlog is to be read ahead of the line: somebody waits for its end. */
static bool is_in_the_way(end *e)
{
    if (!e->paused) {
        e->left = false;
        return false;
    }
    if (e == &e->server->ends[END_TCP]) {
        return e->server->knocked || other_end(e)->waits;
    }
    bool in_use = grobo_port_pty_in_use(e->port);

    if (in_use && e->left) {
        forget(e); /* it is the next one that has it open */
    }
    e->left = !in_use;
    return e->left;
}

/* Reads a backlog; of a flood a part, for the loop has others to serve. True: as far as it goes. */
static bool read_ahead(end *e)
{
    int got = 1;

    for (int reads = 0; got > 0 && reads < READS_MAX; reads++) {
        grobo_os_cause cause;

        if (e->ahead_bytes == sizeof e->ahead) {
            forget(e);
        }
        got = e->ops->read(e->port, e->ahead + e->ahead_bytes, sizeof e->ahead - e->ahead_bytes,
                           &cause);
        e->ahead_bytes += got > 0 ? (size_t)got : 0;
    }
    if (got < 0 || (got == 0 && e->left && other_end(e)->waits)) {
        forget(e);
    }
    if (got < 0) {
        end_close(e);
    }
    return got <= 0;
}

/* The next bytes of a program. Returns as the port's read(). */
static int take(end *e, uint8_t *buf, size_t size)
{
    grobo_os_cause cause;

    if (e->ahead_bytes == 0) {
        return e->ops->read(e->port, buf, size, &cause);
    }
    size = size < e->ahead_bytes ? size : e->ahead_bytes;
    memcpy(buf, e->ahead, size);
    e->ahead_bytes -= size;
    memmove(e->ahead, e->ahead + size, e->ahead_bytes);
    return (int)size;
}

/* Gives the simulated wire what it has room for. */
static void feed(end *e)
{
    grobo_sim_server *server = e->server;
    size_t room = grobo_sim_rx_room(&server->sim);

    for (int reads = 0; e->readable != NULL && room > 0 && reads < READS_MAX; reads++) {
        uint8_t buf[512];
        int got = take(e, buf, room < sizeof buf ? room : sizeof buf);
        int64_t now_us = grobo_now_us();

        if (got < 0) {
            end_close(e);
        }
        if (got <= 0) {
            break;
        }
        follow_baud(server, e);
        server->answers = e;
        tap(server, GROBO_DIR_RX, now_us, buf, (size_t)got);
        (void)grobo_sim_rx(&server->sim, buf, (size_t)got, now_us);
        room = grobo_sim_rx_room(&server->sim);
    }
    e->paused = e->readable != NULL && (room == 0 || e->ahead_bytes > 0);
}

/*
 * Takes from a program what the simulated wire has room for; of a flood a part, for others wait.
 * Bytes of one end do not come into the middle of what the other one has begun.
 */
static void end_read(end *e)
{
    bool dry = is_in_the_way(e) && read_ahead(e);
    bool armed;

    e->waits = other_end(e)->paused && !other_end(e)->waits;
    if (e->waits) {
        e->paused = e->readable != NULL;
    } else {
        feed(e);
    }
    /* Without room the bytes stay where they are, and must not wake the loop. */
    armed = dry || !e->paused;
    if (e->readable != NULL && e->armed != armed) {
        /* One that could not be added is looked at with those that wait for room. */
        e->armed = armed && event_add(e->readable, NULL) == 0;
        e->paused = e->paused || e->armed != armed;
        if (!armed) {
            (void)event_del(e->readable);
        }
    }
}

static void on_readable(evutil_socket_t fd, short what, void *arg)
{
    end *e = arg;

    (void)fd;
    (void)what;
    end_read(e);
    grobo_sim_server_pump(e->server);
}

/* Listens to a port that has just been opened. */
static int end_begin(end *e)
{
    e->readable = event_new(e->server->config.base, e->ops->socket(e->port), EV_READ | EV_PERSIST,
                            on_readable, e);
    if (e->readable == NULL) {
        e->ops->close(e->port);
        return GROBO_ERR_NOMEM;
    }
    if (event_add(e->readable, NULL) != 0) {
        end_close(e);
        return GROBO_ERR_NOMEM;
    }
    e->armed = true;
    return GROBO_OK;
}

/* Gives programs what has come out of the wire. */
static void answer(grobo_sim_server *server)
{
    uint8_t buf[256];
    size_t got;

    do {
        int64_t now_us = grobo_now_us();
        end *e = server->answers;

        got = grobo_sim_tx(&server->sim, buf, sizeof buf, now_us);
        if (got > 0 && e != NULL) {
            grobo_os_cause cause;

            tap(server, GROBO_DIR_TX, now_us, buf, got);
            /* Where nobody reads, the rest is lost: bytes of a serial line do not wait. */
            if (e->ops->write(e->port, buf, got, &cause) < 0) {
                end_close(e);
            }
        }
    } while (got == sizeof buf);
}

/* ---- cable -------------------------------------------------------------------------------- */

static int open_pty(grobo_sim_server *server, grobo_os_cause *cause)
{
    end *e = &server->ends[END_PTY];
    bool stopped = server->link[0] != '\0' && grobo_estop_stands(server->link);
    int r = e->ops->open(e->port, server->link, server->baud_bps, cause);

    if (r >= 0) {
        r = end_begin(e);
    }
    if (r >= 0) {
        r = grobo_port_pty_path(e->port, server->device, sizeof server->device);
    }
    if (r >= 0 && server->link[0] != '\0') {
        /* The number may have been another terminal's: this robot is stopped by its link. */
        (void)grobo_estop_clear(server->device, NULL);
        if (stopped && !grobo_estop_stands(server->link)) { /* it was this robot's */
            (void)grobo_estop_set(server->link, NULL, NULL);
        }
    }
    return r;
}

static void on_caller(evutil_socket_t fd, short what, void *arg)
{
    grobo_sim_server *server = arg;
    end *e = &server->ends[END_TCP];
    grobo_os_cause cause;

    (void)fd;
    (void)what;
    /* One at a time, as a serial port: who calls while somebody is there waits its turn. */
    server->knocked = e->readable != NULL;
    if (!server->knocked) {
        int r = grobo_port_accept(server->listener, e->port, &cause);

        r = r < 0 ? r : end_begin(e);
        if (r < 0 && r != GROBO_ERR_EMPTY) {
            server->door_us = grobo_now_us() + DOOR_SHUT_US;
        }
    }
    grobo_sim_server_pump(server);
}

static int open_tcp(grobo_sim_server *server, grobo_os_cause *cause)
{
    size_t host_bytes;
    int r = grobo_port_listen(server->tcp, &server->listener, &server->tcp_port, cause);

    if (r < 0) {
        return r;
    }
    server->callers =
        event_new(server->config.base, server->listener, EV_READ | EV_PERSIST, on_caller, server);
    if (server->callers == NULL) {
        grobo_port_listen_close(server->listener);
        return GROBO_ERR_NOMEM;
    }
    /* A port that was free to choose stays the same from now on. */
    host_bytes = (size_t)(strrchr(server->tcp, ':') + 1 - server->tcp);
    snprintf(server->tcp + host_bytes, sizeof server->tcp - host_bytes, "%d", server->tcp_port);
    if (server->device[0] == '\0') {
        memcpy(server->device, server->tcp, sizeof server->device);
    }
    return event_add(server->callers, NULL) == 0 ? GROBO_OK : GROBO_ERR_NOMEM;
}

static void unplug(grobo_sim_server *server)
{
    for (int i = 0; i < ENDS; i++) {
        end_close(&server->ends[i]);
    }
    if (server->callers != NULL) {
        event_free(server->callers);
        server->callers = NULL;
        grobo_port_listen_close(server->listener);
    }
    server->device[0] = '\0';
}

static int plug(grobo_sim_server *server, grobo_os_cause *cause)
{
    int r = GROBO_OK;

    if (!server->config.no_pty) {
        r = open_pty(server, cause);
    }
    if (r >= 0 && server->tcp[0] != '\0') {
        r = open_tcp(server, cause);
    }
    if (r < 0) {
        unplug(server);
        return r;
    }
    server->replug_us = GROBO_NEVER_US;
    return GROBO_OK;
}

/* The simulator has hung up: the port goes, and comes back after a while. */
static void hang_up(grobo_sim_server *server)
{
    unplug(server);
    if (server->config.replug_ms >= 0) {
        server->replug_us = grobo_now_us() + (int64_t)server->config.replug_ms * 1000;
    }
}

/* ---- pumping ------------------------------------------------------------------------------ */

static bool is_plugged(const grobo_sim_server *server)
{
    return server->device[0] != '\0';
}

/* A caller in the queue is heard when the one before has gone. */
static void await_callers(grobo_sim_server *server)
{
    if (server->door_us <= grobo_now_us()) {
        server->door_us = GROBO_NEVER_US;
    }
    if (server->callers != NULL) {
        bool heard = server->knocked && server->ends[END_TCP].readable != NULL;

        if (heard || server->door_us != GROBO_NEVER_US) {
            (void)event_del(server->callers);
        } else {
            server->door_us =
                event_add(server->callers, NULL) == 0 ? GROBO_NEVER_US : grobo_now_us() + LOOK_US;
        }
    }
}

/* When the wire has a packet for a program, or bytes of one that have waited long enough. */
static int64_t next_bytes_us(const grobo_sim *sim)
{
    int64_t byte_us = grobo_sim_deadline(sim);

    return byte_us == GROBO_NEVER_US
               ? byte_us
               : grobo_i_sooner(grobo_sim_packet_deadline(sim), byte_us + GATHER_US);
}

/* When there is something to do without anybody's bytes. */
static int64_t next_look_us(const grobo_sim_server *server)
{
    int64_t next_us = grobo_i_sooner(next_bytes_us(&server->sim), server->replug_us);
    bool paused = server->ends[END_PTY].paused || server->ends[END_TCP].paused;

    next_us = grobo_i_sooner(next_us, server->door_us);
    return paused ? grobo_i_sooner(next_us, grobo_now_us() + LOOK_US) : next_us;
}

void grobo_sim_server_pump(grobo_sim_server *server)
{
    if (server == NULL) {
        return;
    }
    answer(server);
    for (int i = 0; i < ENDS; i++) {
        if (server->ends[i].paused) {
            end_read(&server->ends[i]);
        }
    }
    if (grobo_sim_hung_up(&server->sim) && is_plugged(server)) {
        hang_up(server);
    }
    await_callers(server);
    if (grobo_timer_set(server->timer, next_look_us(server)) < 0) {
        grobo_i_timer_instead(server->timer);
    }
}

static void on_time(void *ctx, grobo_timer *timer, int64_t late_us)
{
    grobo_sim_server *server = ctx;

    (void)timer;
    (void)late_us;
    if (server->replug_us <= grobo_now_us() && grobo_sim_server_plug(server, true) < 0) {
        /* What was free a moment ago is taken: it will be free again. */
        server->replug_us = grobo_now_us() + GROBO_SIM_REPLUG_DEFAULT_MS * INT64_C(1000);
    }
    grobo_sim_server_pump(server);
}

int grobo_sim_server_plug(grobo_sim_server *server, bool in)
{
    if (server == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_os_cause cause;
    int r = GROBO_OK;

    if (in && !is_plugged(server)) {
        r = plug(server, &cause);
    } else if (!in) {
        unplug(server);
        server->replug_us = GROBO_NEVER_US;
    }
    if (r >= 0 && grobo_sim_hung_up(&server->sim) == in) {
        grobo_sim_plug(&server->sim, in, grobo_now_us());
    }
    grobo_sim_server_pump(server);
    return r;
}

/* ---- making ------------------------------------------------------------------------------- */

static int copy_name(char *to, const char *name)
{
    size_t size = name != NULL ? strlen(name) : 0;

    if (size >= GROBO_DEVICE_MAX_BYTES) {
        return GROBO_ERR_CAP;
    }
    memcpy(to, name != NULL ? name : "", size + 1);
    return GROBO_OK;
}

static int fill(grobo_sim_server *server, const grobo_sim_server_config *config,
                const grobo_sim_config *sim)
{
    int r;

    server->config = *config;
    server->config.sim = NULL;
    server->config.link = NULL;
    server->config.tcp = NULL;
    if (server->config.replug_ms == 0) {
        server->config.replug_ms = GROBO_SIM_REPLUG_DEFAULT_MS;
    }
    server->paced = !sim->unpaced;
    server->replug_us = GROBO_NEVER_US;
    server->door_us = GROBO_NEVER_US;
    r = copy_name(server->link, config->link);
    if (r >= 0) {
        r = copy_name(server->tcp, config->tcp);
    }
    if (r >= 0) {
        r = grobo_sim_init_sized(&server->sim, grobo_i_sim_bytes(sim->model), sim, grobo_now_us());
    }
    server->baud_bps = (int)server->sim.line_bps;
    return r;
}

static int make_ends(grobo_sim_server *server)
{
    const grobo_port_ops *ops[ENDS] = {grobo_port_pty_ops(), grobo_port_tcp_ops()};

    for (int i = 0; i < ENDS; i++) {
        end *e = &server->ends[i];

        e->ops = ops[i];
        if (e->ops == NULL && server->config.no_pty) {
            continue;
        }
        if (e->ops == NULL) {
            return GROBO_ERR_UNSUPPORTED;
        }
        e->port = grobo_i_new(server->config.mem, e->ops->size_bytes);
        if (e->port == NULL) {
            return GROBO_ERR_NOMEM;
        }
    }
    return grobo_timer_new(server->config.base, on_time, server, server->config.mem,
                           &server->timer);
}

int grobo_sim_server_new(const grobo_sim_server_config *config, grobo_sim_server **server,
                         grobo_os_cause *cause)
{
    grobo_os_cause unheard = {0};
    grobo_sim_server_config taken;
    grobo_sim_server *made;
    grobo_sim_config sim;
    size_t bytes;
    int r;

    if (server == NULL || grobo_i_sized_take(&taken, sizeof taken, config) < 0 ||
        grobo_i_sized_take(&sim, sizeof sim, taken.sim) < 0 || taken.base == NULL ||
        (taken.no_pty && taken.tcp == NULL)) {
        return GROBO_ERR_ARG;
    }
    config = &taken;
    bytes = offsetof(grobo_sim_server, sim) + grobo_i_sim_bytes(sim.model);
    made = grobo_i_new(config->mem, bytes);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->bytes = bytes;
    for (int i = 0; i < ENDS; i++) {
        made->ends[i].server = made;
    }
    made->config.mem = config->mem;
    r = fill(made, config, &sim);
    if (r >= 0) {
        r = make_ends(made);
    }
    if (r >= 0) {
        r = plug(made, cause != NULL ? cause : &unheard);
    }
    if (r < 0) {
        grobo_sim_server_free(made);
        return r;
    }
    /* Another robot had these names, and may have been stopped under them. */
    (void)grobo_estop_clear(made->device, NULL);
    (void)grobo_estop_clear(made->link, NULL);
    grobo_sim_server_pump(made);
    *server = made;
    return GROBO_OK;
}

void grobo_sim_server_free(grobo_sim_server *server)
{
    if (server == NULL) {
        return;
    }
    const grobo_mem *mem = server->config.mem;

    unplug(server);
    grobo_timer_free(server->timer);
    for (end *e = server->ends; e < server->ends + ENDS; e++) {
        grobo_i_free(mem, e->port, e->ops != NULL ? e->ops->size_bytes : 0);
    }
    grobo_i_free(mem, server, server->bytes);
}

const char *grobo_sim_server_device(const grobo_sim_server *server)
{
    return server == NULL ? NULL : server->device;
}

int grobo_sim_server_tcp_port(const grobo_sim_server *server)
{
    return server == NULL ? GROBO_ERR_ARG : server->callers != NULL ? server->tcp_port : 0;
}

grobo_sim *grobo_sim_server_sim(grobo_sim_server *server)
{
    return server == NULL ? NULL : &server->sim;
}
