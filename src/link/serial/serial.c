/* SPDX-License-Identifier: MIT */
/* A serial port's life: made, opened, what the loop brings, what it tells. */
#include <string.h>

#include "src/base/sized.h"
#include "src/link/serial/loop.h"
#include "src/link/serial/serial.h"

static const grobo_os_cause too_late = {0, "no connection in 2 s"};

/* ---- callbacks ---------------------------------------------------------------------------- */

static void destroy(grobo_serial *serial)
{
    const grobo_mem *mem = serial->config.mem;

    if (serial->tell != NULL) {
        event_free(serial->tell);
    }
    grobo_i_free(mem, serial->port, serial->port_bytes);
    grobo_i_free(mem, serial->queue, serial->config.tx_queue_bytes);
    grobo_i_free(mem, serial, sizeof *serial);
}

/* Leaves a callback. False: the callback has freed the port. */
static bool unpin(grobo_serial *serial)
{
    serial->pins--;
    if (!serial->freed) {
        return true;
    }
    if (serial->pins == 0) {
        destroy(serial);
    }
    return false;
}

static bool tell_one(grobo_serial *serial, grobo_serial_event event, int error)
{
    if (serial->config.on_event == NULL) {
        return true;
    }
    serial->pins++;
    serial->config.on_event(serial->config.ctx, serial, event, error);
    return unpin(serial);
}

/* Each callback may close, open again or free: what is to be told is looked at afresh. */
static void tell_all(grobo_serial *serial)
{
    while (serial->to_tell != 0) {
        grobo_serial_event event;
        int error = GROBO_OK;

        if ((serial->to_tell & TELL_OPENED) != 0) {
            serial->to_tell &= ~(unsigned)TELL_OPENED;
            event = GROBO_SERIAL_OPENED;
        } else if ((serial->to_tell & TELL_DRAINED) != 0) {
            serial->to_tell &= ~(unsigned)TELL_DRAINED;
            event = GROBO_SERIAL_DRAINED;
        } else {
            serial->to_tell = 0;
            error = serial->lost_error;
            event = error == GROBO_ERR_UNPLUGGED ? GROBO_SERIAL_UNPLUGGED : GROBO_SERIAL_FAILED;
        }
        if (!tell_one(serial, event, error)) {
            return;
        }
    }
}

static void on_tell(evutil_socket_t fd, short what, void *arg)
{
    (void)fd;
    (void)what;
    tell_all(arg);
}

/* ---- the loop's side ---------------------------------------------------------------------- */

static void on_readable(evutil_socket_t fd, short what, void *arg)
{
    grobo_serial *serial = arg;
    uint8_t buf[READ_BYTES];
    int got = grobo_i_serial_take(serial, buf, sizeof buf);

    (void)fd;
    (void)what;
    if (got > 0) {
        serial->pins++;
        serial->config.on_data(serial->config.ctx, serial, buf, (size_t)got);
        (void)unpin(serial);
    }
}

static void on_resume(evutil_socket_t fd, short what, void *arg)
{
    grobo_serial *serial = arg;

    (void)fd;
    (void)what;
    serial->paused = false;
    if (event_add(serial->rx, NULL) != 0) {
        (void)grobo_i_serial_lose(serial, GROBO_ERR_NOMEM);
    }
}

/* Waits for the port to become writable; span_us < 0: for ever. */
static int await_writable(grobo_serial *serial, int64_t span_us)
{
    struct timeval tv = grobo_i_link_timeval(span_us);

    return event_add(serial->tx, span_us < 0 ? NULL : &tv) == 0 ? GROBO_OK : GROBO_ERR_NOMEM;
}

/* The port is usable: listen, and send what was queued meanwhile. */
static int begin(grobo_serial *serial)
{
    serial->ready = true;
    serial->counters.opens++;
    if (event_add(serial->rx, NULL) != 0) {
        return GROBO_ERR_NOMEM;
    }
    grobo_i_serial_tell(serial, TELL_OPENED);
    return grobo_i_serial_flush(serial);
}

static void on_writable(evutil_socket_t fd, short what, void *arg)
{
    grobo_serial *serial = arg;
    int r;

    (void)fd;
    if (serial->ready) {
        (void)grobo_i_serial_flush(serial);
        return;
    }
    if ((what & EV_TIMEOUT) != 0) {
        serial->cause = too_late;
        (void)grobo_i_serial_lose(serial, GROBO_ERR_TIMEOUT);
        return;
    }
    r = serial->ops->ready(serial->port, &serial->cause);
    if (r == 0) {
        r = await_writable(serial, CONNECT_TIMEOUT_US);
    } else if (r > 0) {
        r = begin(serial);
    }
    if (r < 0 && grobo_serial_is_open(serial)) {
        (void)grobo_i_serial_lose(serial, r);
    }
}

/* ---- making and configuring --------------------------------------------------------------- */

static int check_mode(const grobo_serial_config *config, grobo_serial_mode mode)
{
    switch (mode) {
    case GROBO_SERIAL_SYNC:
        return GROBO_OK;
    case GROBO_SERIAL_ASYNC:
        return config->base != NULL && config->on_data != NULL ? GROBO_OK : GROBO_ERR_ARG;
    }
    return GROBO_ERR_ARG;
}

static int check(const grobo_serial_config *config)
{
    if (config->baud_bps < 0 || config->silence_ms < 0) {
        return GROBO_ERR_ARG;
    }
    if (config->tx_queue_bytes > GROBO_SERIAL_QUEUE_BYTES) {
        return GROBO_ERR_CAP;
    }
    return check_mode(config, config->mode);
}

static void fill_defaults(grobo_serial_config *config)
{
    if (config->baud_bps == 0) {
        config->baud_bps = GROBO_BAUD_DEFAULT_BPS;
    }
    if (config->silence_ms == 0) {
        config->silence_ms = GROBO_SILENCE_DEFAULT_MS;
    }
    if (config->tx_queue_bytes == 0) {
        config->tx_queue_bytes = GROBO_SERIAL_QUEUE_BYTES;
    }
}

int grobo_serial_new(const grobo_serial_config *config, grobo_serial **serial)
{
    grobo_serial_config from;
    int r = serial != NULL ? grobo_i_sized_take(&from, sizeof from, config) : GROBO_ERR_ARG;

    if (r >= 0) {
        r = check(&from);
    }
    if (r < 0) {
        return r;
    }
    grobo_serial *made = grobo_i_new(from.mem, sizeof *made);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->config = from;
    fill_defaults(&made->config);
    r = grobo_serial_set_device(made, from.device);
    made->config.device = NULL;
    if (r >= 0) {
        made->queue = grobo_i_new(from.mem, made->config.tx_queue_bytes);
        made->tell = from.base != NULL ? event_new(from.base, -1, 0, on_tell, made) : NULL;
        if (made->queue == NULL || (from.base != NULL && made->tell == NULL)) {
            r = GROBO_ERR_NOMEM;
        }
    }
    if (r < 0) {
        destroy(made);
        return r;
    }
    *serial = made;
    return GROBO_OK;
}

void grobo_serial_free(grobo_serial *serial)
{
    if (serial == NULL) {
        return;
    }
    grobo_serial_close(serial);
    if (serial->pins > 0) {
        serial->freed = true;
    } else {
        destroy(serial);
    }
}

int grobo_serial_set_device(grobo_serial *serial, const char *device)
{
    if (serial == NULL) {
        return GROBO_ERR_ARG;
    }
    if (grobo_serial_is_open(serial)) {
        return GROBO_ERR_STATE;
    }
    if (device != NULL) {
        size_t size = strlen(device);

        if (size >= sizeof serial->device) {
            return GROBO_ERR_CAP;
        }
        memmove(serial->device, device, size + 1);
    }
    serial->has_device = device != NULL;
    return GROBO_OK;
}

const char *grobo_serial_device(const grobo_serial *serial)
{
    return serial != NULL && serial->has_device ? serial->device : NULL;
}

int grobo_serial_set_mode(grobo_serial *serial, grobo_serial_mode mode)
{
    if (serial == NULL) {
        return GROBO_ERR_ARG;
    }
    int r = check_mode(&serial->config, mode);

    if (grobo_serial_is_open(serial)) {
        return GROBO_ERR_STATE;
    }
    if (r >= 0) {
        serial->config.mode = mode;
    }
    return r;
}

grobo_serial_mode grobo_serial_get_mode(const grobo_serial *serial)
{
    return serial == NULL ? GROBO_SERIAL_SYNC : serial->config.mode;
}

/* Closes a port whose setting found no device. */
static int or_lost(grobo_serial *serial, int r)
{
    return r == GROBO_ERR_UNPLUGGED ? grobo_i_serial_lose(serial, r) : r;
}

int grobo_serial_set_baud(grobo_serial *serial, int baud_bps)
{
    if (serial == NULL || baud_bps <= 0) {
        return GROBO_ERR_ARG;
    }
    int r = baud_bps;

    if (grobo_serial_is_open(serial)) {
        r = serial->ops->set_baud(serial->port, baud_bps, &serial->cause);
    }
    if (r > 0) {
        serial->config.baud_bps = baud_bps;
    }
    return or_lost(serial, r);
}

int grobo_serial_baud(const grobo_serial *serial)
{
    return serial == NULL ? GROBO_ERR_ARG : serial->config.baud_bps;
}

int grobo_serial_set_low_latency(grobo_serial *serial)
{
    int r = grobo_i_serial_check(serial, true);

    if (r >= 0) {
        r = serial->quick_result = serial->ops->set_low_latency(serial->port, &serial->cause);
    }
    return or_lost(serial, r);
}

int grobo_serial_low_latency(const grobo_serial *serial)
{
    int r = grobo_i_serial_check(serial, true);

    return r < 0 ? r : serial->quick_result;
}

/* ---- opening ------------------------------------------------------------------------------ */

static const grobo_port_ops *choose_ops(const grobo_serial *serial)
{
    if (serial->config.ops != NULL) {
        return serial->config.ops;
    }
    return strncmp(serial->device, "tcp:", 4) == 0 ? grobo_port_tcp_ops() : grobo_port_serial_ops();
}

static int open_port(grobo_serial *serial)
{
    const grobo_port_ops *ops = choose_ops(serial);

    if (ops->size_bytes > serial->port_bytes) {
        grobo_i_free(serial->config.mem, serial->port, serial->port_bytes);
        serial->port = grobo_i_new(serial->config.mem, ops->size_bytes);
        serial->port_bytes = serial->port != NULL ? ops->size_bytes : 0;
        if (serial->port == NULL) {
            return GROBO_ERR_NOMEM;
        }
    }
    int r = ops->open(serial->port, serial->device, serial->config.baud_bps, &serial->cause);
    if (r >= 0) {
        grobo_os_cause cause;
        const grobo_line_format *format = &serial->config.format;

        if (format->parity != GROBO_PARITY_NONE || format->stop_bits > 1 || format->rs485) {
            r = ops->set_format(serial->port, format, &serial->cause);
        }
        if (r < 0) {
            ops->close(serial->port);
            return r;
        }
        serial->ops = ops;
        serial->quick_result = ops->set_low_latency(serial->port, &cause);
    }
    return r;
}

static int start_async(grobo_serial *serial)
{
    evutil_socket_t socket = serial->ops->socket(serial->port);
    struct event_base *base = serial->config.base;

    serial->rx = event_new(base, socket, EV_READ | EV_PERSIST, on_readable, serial);
    serial->tx = event_new(base, socket, EV_WRITE, on_writable, serial);
    serial->resume = event_new(base, -1, 0, on_resume, serial);
    if (serial->rx == NULL || serial->tx == NULL || serial->resume == NULL) {
        return GROBO_ERR_NOMEM;
    }
    int r = serial->ops->ready(serial->port, &serial->cause);
    if (r > 0) {
        return begin(serial);
    }
    return r < 0 ? r : await_writable(serial, CONNECT_TIMEOUT_US);
}

static int start_sync(grobo_serial *serial)
{
    int64_t end_us = grobo_now_us() + CONNECT_TIMEOUT_US;
    int r = serial->ops->ready(serial->port, &serial->cause);

    while (r == 0 && grobo_now_us() < end_us) {
        r = grobo_port_wait(serial->ops->socket(serial->port), GROBO_PORT_WRITABLE,
                            end_us - grobo_now_us());
        if (r >= 0) {
            r = serial->ops->ready(serial->port, &serial->cause);
        }
    }
    if (r > 0) {
        serial->ready = true;
        serial->counters.opens++;
    }
    if (r == 0) {
        serial->cause = too_late;
        r = GROBO_ERR_TIMEOUT;
    }
    return r;
}

int grobo_serial_open(grobo_serial *serial)
{
    if (serial == NULL || (serial->ops == NULL && !serial->has_device)) {
        return GROBO_ERR_ARG;
    }
    if (grobo_serial_is_open(serial)) {
        return GROBO_ERR_STATE;
    }
    serial->to_tell = 0;
    int r = open_port(serial);
    if (r >= 0) {
        r = serial->config.mode == GROBO_SERIAL_ASYNC ? start_async(serial) : start_sync(serial);
        if (r < 0) {
            grobo_serial_close(serial);
        }
    }
    return r < 0 ? r : GROBO_OK;
}

grobo_handle grobo_serial_handle(const grobo_serial *serial)
{
    return grobo_serial_is_open(serial) ? serial->ops->handle(serial->port) : GROBO_HANDLE_NULL;
}

const grobo_os_cause *grobo_serial_cause(const grobo_serial *serial)
{
    return serial == NULL ? NULL : &serial->cause;
}

void grobo_serial_get_counters(const grobo_serial *serial, grobo_serial_counters *counters)
{
    if (serial != NULL && counters != NULL) {
        *counters = serial->counters;
    }
}
