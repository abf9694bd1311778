/* SPDX-License-Identifier: MIT */
/* An open serial port: its bytes, the queue, the calls that wait, its end. */
#include <limits.h>
#include <string.h>

#include "ports/common/guard.h"
#include "src/base/assert.h"
#include "src/link/serial/loop.h"
#include "src/link/serial/serial.h"

/* ---- what ends it, what is to be told ----------------------------------------------------- */

static void free_event(struct event **event)
{
    if (*event != NULL) {
        event_free(*event);
        *event = NULL;
    }
}

void grobo_serial_close(grobo_serial *serial)
{
    if (serial == NULL) {
        return;
    }
    serial->to_tell = 0;
    serial->ready = false;
    serial->paused = false;
    serial->head = 0;
    serial->used = 0;
    free_event(&serial->rx);
    free_event(&serial->tx);
    free_event(&serial->resume);
    if (serial->ops != NULL) {
        serial->ops->close(serial->port);
        serial->ops = NULL;
    }
}

bool grobo_serial_is_open(const grobo_serial *serial)
{
    return serial != NULL && serial->ops != NULL;
}

int grobo_i_serial_check(const grobo_serial *serial, bool sound)
{
    if (serial == NULL || !sound) {
        return GROBO_ERR_ARG;
    }
    return serial->ops != NULL ? GROBO_OK : GROBO_ERR_CLOSED;
}

void grobo_i_serial_tell(grobo_serial *serial, unsigned what)
{
    if (serial->config.mode == GROBO_SERIAL_ASYNC) {
        serial->to_tell |= what;
        event_active(serial->tell, 0, 0);
    }
}

int grobo_i_serial_lose(grobo_serial *serial, int error)
{
    if (error == GROBO_ERR_UNPLUGGED) {
        serial->counters.unplugs++;
    }
    grobo_serial_close(serial);
    serial->lost_error = error;
    grobo_i_serial_tell(serial, TELL_LOST);
    return error;
}

/* ---- one read, one write ------------------------------------------------------------------ */

/* Tells the bytes of a read or write to counters and trace. */
static void note_bytes(grobo_serial *serial, grobo_direction direction, const void *bytes,
                       size_t size)
{
    switch (direction) {
    case GROBO_DIR_RX:
        serial->counters.reads++;
        serial->counters.rx_bytes += size;
        break;
    case GROBO_DIR_TX:
        serial->counters.writes++;
        serial->counters.tx_bytes += size;
        break;
    }
    if (serial->config.on_tap != NULL) {
        int64_t now_us = direction == GROBO_DIR_RX ? serial->read_us : grobo_now_us();

        serial->config.on_tap(serial->config.ctx, direction, now_us, bytes, size);
    }
}

/* Where the timer cannot be added, the port is not paused. */
static void pause_until(grobo_serial *serial, int64_t end_us, int64_t now_us)
{
    struct timeval span = grobo_i_link_timeval(end_us - now_us);

    if (event_add(serial->resume, &span) == 0) {
        (void)event_del(serial->rx);
        serial->paused = true;
    }
}

static void spend(grobo_serial *serial, int size, int64_t now_us)
{
    if (serial->spent_us < now_us - READ_BUDGET_US) {
        serial->spent_us = now_us - READ_BUDGET_US;
    }
    serial->spent_us += READ_COST_US + (int64_t)size * BYTE_COST_US;
    if (serial->spent_us > now_us && serial->resume != NULL) {
        pause_until(serial, serial->spent_us, now_us);
    }
}

int grobo_i_serial_take(grobo_serial *serial, void *buf, size_t size)
{
    serial->read_us = grobo_now_us();
    int got = serial->ops->read(serial->port, buf, size, &serial->cause);

    serial->more = got > 0 && (size_t)got == size;
    if (got > 0) {
        spend(serial, got, serial->read_us);
        note_bytes(serial, GROBO_DIR_RX, buf, (size_t)got);
    }
    return got < 0 ? grobo_i_serial_lose(serial, got) : got;
}

/* Writes once; the port is closed when that fails. What another process has stopped meanwhile is
 * not moved by a byte from before. */
static int put(grobo_serial *serial, const void *bytes, size_t size)
{
    if (serial->barred != NULL && atomic_load(serial->barred) != 0) {
        grobo_i_port_abandon(serial->port);
        return grobo_i_serial_lose(serial, GROBO_ERR_STALLED);
    }
    int done = serial->ops->write(serial->port, bytes, size, &serial->cause);

    if (done < 0) {
        return grobo_i_serial_lose(serial, done);
    }
    GROBO_ASSERT((size_t)done <= size);
    if ((size_t)done < size) {
        serial->counters.short_writes++;
    }
    if (done > 0) {
        note_bytes(serial, GROBO_DIR_TX, bytes, (size_t)done);
    }
    return done;
}

/* ---- the queue ---------------------------------------------------------------------------- */

static void enqueue(grobo_serial *serial, const uint8_t *bytes, size_t size)
{
    size_t capacity = serial->config.tx_queue_bytes;
    size_t tail = (serial->head + serial->used) % capacity;
    size_t first = size < capacity - tail ? size : capacity - tail;

    GROBO_ASSERT(serial->head < capacity && size <= capacity - serial->used);
    memcpy(serial->queue + tail, bytes, first);
    memcpy(serial->queue, bytes + first, size - first);
    serial->used += size;
}

/* What waits leaves when the port takes it. A port that cannot tell that is lost: the bytes would
 * wait for ever. */
static int await_room(grobo_serial *serial)
{
    return event_add(serial->tx, NULL) == 0 ? GROBO_OK
                                            : grobo_i_serial_lose(serial, GROBO_ERR_NOMEM);
}

int grobo_i_serial_flush(grobo_serial *serial)
{
    size_t capacity = serial->config.tx_queue_bytes;
    bool had = serial->used > 0;

    while (serial->used > 0) {
        size_t run = capacity - serial->head;
        size_t size = serial->used < run ? serial->used : run;
        int done = put(serial, serial->queue + serial->head, size);

        if (done < 0) {
            return done;
        }
        serial->head = (serial->head + (size_t)done) % capacity;
        serial->used -= (size_t)done;
        if ((size_t)done < size) {
            return await_room(serial);
        }
    }
    if (had) {
        grobo_i_serial_tell(serial, TELL_DRAINED);
    }
    return GROBO_OK;
}

static int send_async(grobo_serial *serial, const uint8_t *bytes, size_t size)
{
    int done = 0;

    if (size > serial->config.tx_queue_bytes - serial->used) {
        serial->counters.full++;
        return GROBO_ERR_FULL;
    }
    if (serial->ready && serial->used == 0) {
        done = put(serial, bytes, size);
    }
    if (done < 0) {
        return done;
    }
    if ((size_t)done < size) {
        enqueue(serial, bytes + done, size - (size_t)done);
        done = serial->ready ? await_room(serial) : 0;
    }
    return done < 0 ? done : (int)size;
}

/* ---- waiting ------------------------------------------------------------------------------ */

static int wait_until(grobo_serial *serial, unsigned what, int64_t end_us)
{
    int r = grobo_port_wait(serial->ops->socket(serial->port), what, end_us - grobo_now_us());

    return r < 0 ? grobo_i_serial_lose(serial, r) : r;
}

static int64_t silence_end(const grobo_serial *serial)
{
    return grobo_now_us() + (int64_t)serial->config.silence_ms * 1000;
}

/*
 * Reads at least a byte, or 0 when end_us came first. The clock is asked before the line: a process
 * that is held up between the two must not take what has come for silence.
 */
static int take_until(grobo_serial *serial, void *buf, size_t size, int64_t end_us)
{
    int64_t now_us = grobo_now_us();
    int got = grobo_i_serial_take(serial, buf, size);

    while (got == 0 && now_us < end_us) {
        got = wait_until(serial, GROBO_PORT_READABLE, end_us);
        if (got >= 0) {
            now_us = grobo_now_us();
            got = grobo_i_serial_take(serial, buf, size);
        }
    }
    return got;
}

/* Writes at least a byte, or 0 when end_us came first. */
static int put_until(grobo_serial *serial, const void *bytes, size_t size, int64_t end_us)
{
    int done = put(serial, bytes, size);

    while (done == 0 && grobo_now_us() < end_us) {
        done = wait_until(serial, GROBO_PORT_WRITABLE, end_us);
        if (done >= 0) {
            done = put(serial, bytes, size);
        }
    }
    return done;
}

static int send_sync(grobo_serial *serial, const uint8_t *bytes, size_t size)
{
    size_t sent = 0;

    while (sent < size) {
        int done = put_until(serial, bytes + sent, size - sent, grobo_now_us() + SEND_TIMEOUT_US);

        if (done <= 0) {
            return done < 0 ? done : GROBO_ERR_TIMEOUT;
        }
        sent += (size_t)done;
    }
    return (int)size;
}

/* ---- the public functions ----------------------------------------------------------------- */

int grobo_serial_read(grobo_serial *serial, void *buf, size_t size)
{
    int r = grobo_i_serial_check(serial, buf != NULL);
    size_t most = size < INT_MAX ? size : INT_MAX;

    if (r < 0 || most == 0 || !serial->ready || serial->paused) {
        return r;
    }
    return serial->config.mode == GROBO_SERIAL_ASYNC
               ? grobo_i_serial_take(serial, buf, most)
               : take_until(serial, buf, most, silence_end(serial));
}

int grobo_serial_write(grobo_serial *serial, const void *bytes, size_t size)
{
    int r = grobo_i_serial_check(serial, bytes != NULL || size == 0);
    size_t most = size < INT_MAX ? size : INT_MAX;

    if (r < 0 || most == 0 || !serial->ready || serial->used > 0) {
        return r;
    }
    return serial->config.mode == GROBO_SERIAL_ASYNC
               ? put(serial, bytes, most)
               : put_until(serial, bytes, most, silence_end(serial));
}

int grobo_serial_receive(grobo_serial *serial, void *buf, size_t size)
{
    int r = grobo_i_serial_check(serial, buf != NULL && size <= INT_MAX);

    if (r < 0 || serial->config.mode != GROBO_SERIAL_SYNC) {
        return r < 0 ? r : GROBO_ERR_STATE;
    }
    uint8_t *to = buf;
    int64_t end_us = silence_end(serial);
    size_t got = 0;

    while (got < size) {
        r = take_until(serial, to + got, size - got, end_us);
        if (r < 0) {
            return r;
        }
        if (r == 0) {
            serial->counters.dropped_bytes += got;
            return got > 0 ? GROBO_ERR_SHORT : GROBO_ERR_TIMEOUT;
        }
        got += (size_t)r;
    }
    return (int)size;
}

int grobo_serial_send(grobo_serial *serial, const void *bytes, size_t size)
{
    int r = grobo_i_serial_check(serial, (bytes != NULL || size == 0) && size <= INT_MAX);

    if (r < 0 || size == 0) {
        return r;
    }
    return serial->config.mode == GROBO_SERIAL_ASYNC ? send_async(serial, bytes, size)
                                                     : send_sync(serial, bytes, size);
}

size_t grobo_serial_pending(const grobo_serial *serial)
{
    return serial == NULL ? 0 : serial->used;
}

size_t grobo_serial_unsent(const grobo_serial *serial)
{
    if (serial == NULL) {
        return 0;
    }
    bool tells = serial->ops != NULL && serial->ops->unsent != NULL;

    return serial->used + (tells ? (size_t)serial->ops->unsent(serial->port) : 0);
}

void grobo_i_serial_take_back(grobo_serial *serial, size_t size, size_t behind)
{
    size_t capacity = serial->config.tx_queue_bytes;

    GROBO_ASSERT(serial->used <= size); /* a frame is sent only when nothing waits */
    if (serial->used == size || (serial->used == 0 && grobo_serial_unsent(serial) >= size)) {
        grobo_serial_discard_output(serial);
    } else if (serial->used > behind) {
        serial->queue[(serial->head + serial->used - 1 - behind) % capacity] ^= 0xFF;
    }
}

int grobo_serial_waiting(grobo_serial *serial)
{
    int r = grobo_i_serial_check(serial, true);

    if (r >= 0 && serial->ready) {
        r = serial->ops->waiting(serial->port, &serial->cause);
    }
    return r < 0 && grobo_serial_is_open(serial) ? grobo_i_serial_lose(serial, r) : r;
}

int grobo_serial_discard(grobo_serial *serial)
{
    uint8_t scratch[READ_BYTES];
    int r = grobo_i_serial_check(serial, true);
    int dropped = 0;
    int got = 1;

    if (r < 0) {
        return r;
    }
    /* Bounded: a sender that never pauses must not keep us here. */
    for (int round = 0; serial->ready && got > 0 && round < 64; round++) {
        got = grobo_i_serial_take(serial, scratch, sizeof scratch);
        if (got < 0) {
            return got;
        }
        dropped += got;
    }
    serial->counters.dropped_bytes += (uint64_t)dropped;
    return dropped;
}

void grobo_serial_discard_output(grobo_serial *serial)
{
    if (serial == NULL) {
        return;
    }
    serial->head = 0;
    serial->used = 0;
    if (grobo_serial_is_open(serial)) {
        if (serial->tx != NULL && serial->ready) {
            (void)event_del(serial->tx);
        }
        serial->ops->discard_output(serial->port);
    }
}
