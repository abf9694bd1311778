/* SPDX-License-Identifier: MIT */
/* What a session speaks over: a serial port, or the simulator. And the ports that may be one. */
#include <string.h>

#include <grobo/core/sim.h>

#include "src/base/assert.h"
#include "src/link/serial/loop.h"
#include "src/link/serial/serial.h"
#include "src/link/session/session.h"
#include "src/robot/lines.h"
#include "src/robot/robot.h"
#include "src/sim/imu.h"
#include "src/sim/lines.h"
#include "src/sim/servo/servo.h"

/* How often one call reads at most: a line that never pauses must not keep us. */
#define READS_MAX 16

/* ---- a serial port ------------------------------------------------------------------------ */

static int port_open(session_wire *wire, const char *path)
{
    int r = grobo_serial_set_device(wire->serial, path);

    if (r >= 0) {
        r = grobo_serial_open(wire->serial);
        wire->session->cause = *grobo_serial_cause(wire->serial);
    }
    if (r >= 0) {
        memmove(wire->used, path, strlen(path) + 1);
        grobo_i_session_estop_begin(wire, path);
    }
    return r;
}

static int port_take(session_wire *wire, int64_t *until_us)
{
    uint8_t buf[256];
    int got = 1;

    for (int reads = 0; got > 0 && reads < READS_MAX; reads++) {
        /* The time before the read that finds nothing: what had come until then has been read. */
        *until_us = grobo_now_us();
        /* A failure closes the port, and it tells that from the loop. */
        got = grobo_serial_read(wire->serial, buf, sizeof buf);
        if (got > 0) {
            grobo_robot_line_rx(&wire->session->robot, wire->line, buf, (size_t)got,
                                grobo_now_us());
        }
    }
    return GROBO_OK;
}

static bool port_has_room(session_wire *wire)
{
    /* What was answered has left; only of other frames the system must be asked. */
    size_t unsent = *grobo_i_answered(&wire->session->robot, wire->line)
                        ? grobo_serial_pending(wire->serial)
                        : grobo_serial_unsent(wire->serial);

    return grobo_serial_is_open(wire->serial) && unsent == 0;
}

static void port_give(session_wire *wire, const uint8_t *frame, size_t size)
{
    /* A failure closes the port, and it tells that from the loop. */
    (void)grobo_serial_send(wire->serial, frame, size);
}

static void port_take_back(session_wire *wire, size_t size, size_t behind)
{
    grobo_i_serial_take_back(wire->serial, size, behind);
}

static int64_t port_deadline(const session_wire *wire)
{
    (void)wire;
    return GROBO_NEVER_US; /* it tells by the loop */
}

const session_line grobo_i_session_port = {
    .open = port_open,
    .take = port_take,
    .has_room = port_has_room,
    .give = port_give,
    .take_back = port_take_back,
    .deadline = port_deadline,
};

/* ---- the simulator ------------------------------------------------------------------------ */

struct session_sim {
    grobo_i_sim_line own;                   /* of one of several lines */
    uint8_t backlog[GROBO_FRAME_MAX_BYTES]; /* of a frame that it took in part */
    grobo_sim sim;                          /* the last member: grobo_i_sim_bytes() */
};

/* Of a robot of several lines, what is on this one. */
static const grobo_sim_config *config_of(const session_wire *wire, grobo_i_sim_line *own)
{
    const grobo_session *session = wire->session;
    const grobo_lines *lines = grobo_driver_lines(session->robot.driver);

    if (lines == NULL) {
        return &session->sim_config;
    }
    grobo_i_sim_of_line(lines, wire->line, &session->sim_config, own);
    return &own->config;
}

static const grobo_model *model_of(const session_wire *wire)
{
    const grobo_lines *lines = grobo_driver_lines(wire->session->robot.driver);

    return lines == NULL ? wire->session->sim_config.model : &lines->line[wire->line].model;
}

static size_t simulated_bytes(const session_wire *wire)
{
    return offsetof(struct session_sim, sim) + grobo_i_sim_bytes(model_of(wire));
}

void grobo_i_session_sim_free(session_wire *wire)
{
    grobo_i_free(wire->session->config.mem, wire->simulated, simulated_bytes(wire));
    wire->simulated = NULL;
    wire->sim = NULL;
}

static int sim_open(session_wire *wire, const char *name)
{
    int64_t now_us = grobo_now_us();

    (void)name;
    if (wire->sim == NULL) {
        wire->simulated = grobo_i_new(wire->session->config.mem, simulated_bytes(wire));
        int r = wire->simulated != NULL
                    ? grobo_sim_init_sized(&wire->simulated->sim, grobo_i_sim_bytes(model_of(wire)),
                                           config_of(wire, &wire->simulated->own), now_us)
                    : GROBO_ERR_NOMEM;

        if (r < 0) {
            grobo_i_session_sim_free(wire);
            return r;
        }
        wire->sim = &wire->simulated->sim;
    }
    if (grobo_sim_hung_up(wire->sim)) {
        grobo_sim_plug(wire->sim, true, now_us);
    }
    return GROBO_OK;
}

static int sim_take(session_wire *wire, int64_t *until_us)
{
    uint8_t buf[256];
    size_t got;
    grobo_imu imu;

    if (wire->line == 0 && grobo_i_sim_imu_at(wire->sim, grobo_now_us(), &imu) == GROBO_OK) {
        (void)grobo_robot_set_imu(&wire->session->robot, &imu);
    }
    do {
        /* What comes later was not taken: the engine may not be told of a later time. */
        int64_t now_us = *until_us = grobo_now_us();

        got = grobo_sim_tx(wire->sim, buf, sizeof buf, now_us);
        if (got > 0) {
            wire->session->sim_rx_bytes += got;
            grobo_i_session_tell_tap(wire, GROBO_DIR_RX, now_us, buf, got);
            grobo_robot_line_rx(&wire->session->robot, wire->line, buf, got, now_us);
        }
    } while (got == sizeof buf);
    return grobo_sim_hung_up(wire->sim) ? GROBO_ERR_UNPLUGGED : GROBO_OK;
}

static void sim_give(session_wire *wire, const uint8_t *frame, size_t size)
{
    int64_t now_us = grobo_i_session_now(wire->session); /* when it left, by its engine */
    size_t taken = grobo_sim_rx(wire->sim, frame, size, now_us);

    wire->session->sim_tx_bytes += taken;
    if (taken > 0) {
        grobo_i_session_tell_tap(wire, GROBO_DIR_TX, now_us, frame, taken);
    }
    GROBO_ASSERT(taken <= size && size - taken <= sizeof wire->simulated->backlog);
    wire->backlog_bytes = size - taken;
    memmove(wire->simulated->backlog, frame + taken, wire->backlog_bytes);
}

static bool sim_has_room(session_wire *wire)
{
    if (wire->backlog_bytes > 0) {
        sim_give(wire, wire->simulated->backlog, wire->backlog_bytes);
    }
    return wire->backlog_bytes == 0;
}

static void sim_take_back(session_wire *wire, size_t size, size_t behind)
{
    GROBO_ASSERT(wire->backlog_bytes <= size);
    if (wire->backlog_bytes == size) {
        wire->backlog_bytes = 0;
    } else if (wire->backlog_bytes > behind) {
        wire->simulated->backlog[wire->backlog_bytes - 1 - behind] ^= 0xFF;
    }
}

static int64_t sim_deadline(const session_wire *wire)
{
    return wire->session->state == GROBO_SESSION_OPENING ? grobo_now_us()
                                                         : grobo_sim_packet_deadline(wire->sim);
}

const session_line grobo_i_session_sim = {
    .open = sim_open,
    .take = sim_take,
    .has_room = sim_has_room,
    .give = sim_give,
    .take_back = sim_take_back,
    .deadline = sim_deadline,
};

/* ---- the ports that GROBO_DEVICE_AUTO tries, in which order ------------------------------- */

static void add(session_scan *scan, const char *path)
{
    size_t size = strlen(path);

    if (scan->count < GROBO_SCAN_PORTS_MAX && size < GROBO_DEVICE_MAX_BYTES) {
        memcpy(scan->path[scan->count++], path, size + 1);
    }
}

typedef struct {
    session_scan *scan;
    bool usb; /* this round takes USB adapters, the other one the rest */
} round_of;

static int add_port(void *ctx, const grobo_port_info *info)
{
    const round_of *round = ctx;

    if (info->open_result == GROBO_OK && (info->usb_vendor >= 0) == round->usb) {
        add(round->scan, info->path);
    }
    return 0;
}

int grobo_i_session_scan_begin(grobo_session *session)
{
    const char *const *device = session->config.scan;
    session_scan *scan = grobo_i_new(session->config.mem, sizeof *scan);

    if (scan == NULL) {
        return GROBO_ERR_NOMEM;
    }
    session->scan = scan;
    if (device == NULL) {
        (void)grobo_port_list(add_port, &(round_of){scan, true});
        (void)grobo_port_list(add_port, &(round_of){scan, false});
    }
    while (device != NULL && *device != NULL) {
        add(scan, *device++);
    }
    if (scan->count == 0) {
        static const grobo_os_cause none = {0, "no serial port that may be opened"};

        session->cause = none;
        grobo_i_session_scan_end(session);
        return GROBO_ERR_NOTFOUND;
    }
    return GROBO_OK;
}

void grobo_i_session_scan_end(grobo_session *session)
{
    grobo_i_free(session->config.mem, session->scan, sizeof *session->scan);
    session->scan = NULL;
}

/* ---- the ports of several lines ------------------------------------------------------------ */

static int set_path(session_wire *wire, const char *port, size_t size)
{
    if (size >= sizeof wire->path) {
        return GROBO_ERR_CAP;
    }
    memcpy(wire->path, port, size);
    wire->path[size] = '\0';
    memcpy(wire->used, wire->path, size + 1);
    return GROBO_OK;
}

/* NAME=PORT, as far as `end`. */
static int take_port(grobo_session *session, const char *item, const char *end)
{
    const grobo_lines *lines = grobo_driver_lines(session->robot.driver);
    const char *equals = memchr(item, '=', (size_t)(end - item));

    for (int i = 0; equals != NULL && equals + 1 < end && i < session->n_wires; i++) {
        const char *name = lines->line[i].name;
        size_t size = (size_t)(equals - item);

        if (name != NULL && strlen(name) == size && memcmp(name, item, size) == 0) {
            return set_path(&session->wire[i], equals + 1, (size_t)(end - equals - 1));
        }
    }
    return GROBO_ERR_ARG;
}

int grobo_i_session_set_paths(grobo_session *session)
{
    const grobo_lines *lines = grobo_driver_lines(session->robot.driver);
    const char *item = session->device;
    bool sim = session->line == &grobo_i_session_sim;
    int r = GROBO_OK;

    for (int i = 0; i < session->n_wires && r >= 0; i++) {
        const char *port = sim ? session->device : lines->line[i].port;

        r = set_path(&session->wire[i], port != NULL ? port : "", port != NULL ? strlen(port) : 0);
    }
    if (sim || strcmp(item, GROBO_DEVICE_AUTO) == 0) {
        return r;
    }
    while (r >= 0 && *item != '\0') {
        const char *end = item + strcspn(item, ",");

        r = take_port(session, item, end);
        item = *end == ',' ? end + 1 : end;
    }
    return r;
}

const char *grobo_i_session_without_port(const grobo_session *session)
{
    const grobo_lines *lines = grobo_driver_lines(session->robot.driver);

    for (int i = 0; i < session->n_wires && session->n_wires > 1; i++) {
        if (session->wire[i].path[0] == '\0') {
            return lines->line[i].name != NULL ? lines->line[i].name : "";
        }
    }
    return NULL;
}
