/* SPDX-License-Identifier: MIT */
/* What a session speaks over: a serial port, or the simulator. And the ports that may be one. */
#include <string.h>

#include <grobo/core/sim.h>

#include "src/base/assert.h"
#include "src/link/serial/loop.h"
#include "src/link/serial/serial.h"
#include "src/link/session/session.h"
#include "src/sim/servo/servo.h"

/* How often one call reads at most: a line that never pauses must not keep us. */
#define READS_MAX 16

/* ---- a serial port ------------------------------------------------------------------------ */

static int port_open(grobo_session *session, const char *path)
{
    int r = grobo_serial_set_device(session->serial, path);

    if (r >= 0) {
        r = grobo_serial_open(session->serial);
        session->cause = *grobo_serial_cause(session->serial);
    }
    if (r >= 0) {
        memmove(session->used, path, strlen(path) + 1);
        grobo_i_session_estop_begin(session, path);
    }
    return r;
}

static int port_take(grobo_session *session, int64_t *until_us)
{
    uint8_t buf[256];
    int got = 1;

    for (int reads = 0; got > 0 && reads < READS_MAX; reads++) {
        /* The time before the read that finds nothing: what had come until then has been read. */
        *until_us = grobo_now_us();
        /* A failure closes the port, and it tells that from the loop. */
        got = grobo_serial_read(session->serial, buf, sizeof buf);
        if (got > 0) {
            grobo_robot_rx(&session->robot, buf, (size_t)got, grobo_now_us());
        }
    }
    return GROBO_OK;
}

static bool port_has_room(grobo_session *session)
{
    /* What was answered has left; only of other frames the system must be asked. */
    size_t unsent = session->robot.answered ? grobo_serial_pending(session->serial)
                                            : grobo_serial_unsent(session->serial);

    return grobo_serial_is_open(session->serial) && unsent == 0;
}

static void port_give(grobo_session *session, const uint8_t *frame, size_t size)
{
    /* A failure closes the port, and it tells that from the loop. */
    (void)grobo_serial_send(session->serial, frame, size);
}

static void port_take_back(grobo_session *session, size_t size, size_t behind)
{
    grobo_i_serial_take_back(session->serial, size, behind);
}

static int64_t port_deadline(const grobo_session *session)
{
    (void)session;
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
    uint8_t backlog[GROBO_FRAME_MAX_BYTES]; /* of a frame that it took in part */
    grobo_sim sim;                          /* the last member: grobo_i_sim_bytes() */
};

static size_t simulated_bytes(const grobo_session *session)
{
    return offsetof(struct session_sim, sim) + grobo_i_sim_bytes(session->sim_config.model);
}

void grobo_i_session_sim_free(grobo_session *session)
{
    grobo_i_free(session->config.mem, session->simulated, simulated_bytes(session));
    session->simulated = NULL;
    session->sim = NULL;
}

static int sim_open(grobo_session *session, const char *name)
{
    int64_t now_us = grobo_now_us();

    (void)name;
    if (session->sim == NULL) {
        session->simulated = grobo_i_new(session->config.mem, simulated_bytes(session));
        int r = session->simulated != NULL
                    ? grobo_sim_init_sized(&session->simulated->sim,
                                           grobo_i_sim_bytes(session->sim_config.model),
                                           &session->sim_config, now_us)
                    : GROBO_ERR_NOMEM;

        if (r < 0) {
            grobo_i_session_sim_free(session);
            return r;
        }
        session->sim = &session->simulated->sim;
    }
    if (grobo_sim_hung_up(session->sim)) {
        grobo_sim_plug(session->sim, true, now_us);
    }
    return GROBO_OK;
}

static int sim_take(grobo_session *session, int64_t *until_us)
{
    uint8_t buf[256];
    size_t got;

    do {
        /* What comes later was not taken: the engine may not be told of a later time. */
        int64_t now_us = *until_us = grobo_now_us();

        got = grobo_sim_tx(session->sim, buf, sizeof buf, now_us);
        if (got > 0) {
            session->sim_rx_bytes += got;
            grobo_i_session_tell_tap(session, GROBO_DIR_RX, now_us, buf, got);
            grobo_robot_rx(&session->robot, buf, got, now_us);
        }
    } while (got == sizeof buf);
    return grobo_sim_hung_up(session->sim) ? GROBO_ERR_UNPLUGGED : GROBO_OK;
}

static void sim_give(grobo_session *session, const uint8_t *frame, size_t size)
{
    int64_t now_us = grobo_i_session_now(session); /* when it left, by its engine */
    size_t taken = grobo_sim_rx(session->sim, frame, size, now_us);

    session->sim_tx_bytes += taken;
    if (taken > 0) {
        grobo_i_session_tell_tap(session, GROBO_DIR_TX, now_us, frame, taken);
    }
    GROBO_ASSERT(taken <= size && size - taken <= sizeof session->simulated->backlog);
    session->backlog_bytes = size - taken;
    memmove(session->simulated->backlog, frame + taken, session->backlog_bytes);
}

static bool sim_has_room(grobo_session *session)
{
    if (session->backlog_bytes > 0) {
        sim_give(session, session->simulated->backlog, session->backlog_bytes);
    }
    return session->backlog_bytes == 0;
}

static void sim_take_back(grobo_session *session, size_t size, size_t behind)
{
    GROBO_ASSERT(session->backlog_bytes <= size);
    if (session->backlog_bytes == size) {
        session->backlog_bytes = 0;
    } else if (session->backlog_bytes > behind) {
        session->simulated->backlog[session->backlog_bytes - 1 - behind] ^= 0xFF;
    }
}

static int64_t sim_deadline(const grobo_session *session)
{
    return session->state == GROBO_SESSION_OPENING ? grobo_now_us()
                                                   : grobo_sim_packet_deadline(session->sim);
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
