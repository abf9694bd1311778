/* SPDX-License-Identifier: MIT */
/**
 * @file serial.h
 * @brief A serial port: asynchronous on a caller's event loop, or synchronous without one.
 *
 * Always 8 data bits, raw, no flow control, opened for this process alone; no parity and 1 stop bit
 * unless configured otherwise. The device is a serial port's name (see grobo_port_serial_ops()) or
 * "tcp:HOST:PORT".
 *
 * Asynchronous mode: bytes received come by a callback on the loop, bytes to send go through a
 * bounded queue, and no function waits. A peer that never stops writing is read at most 10000 times
 * and 1 MB a second; what it writes beyond that waits in the system.
 *
 * Synchronous mode: no callback is ever called, functions wait, with a limit, and return what
 * happened.
 *
 * A lost port is closed at once, and reported once: by GROBO_SERIAL_UNPLUGGED in
 * asynchronous mode, by GROBO_ERR_UNPLUGGED of the call in synchronous mode. It may be opened
 * again when it is back.
 *
 * A grobo_serial belongs to one thread, the one that runs its loop. Every function may be called
 * inside its callbacks, grobo_serial_free() too.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_SERIAL_H
#define GROBO_CORE_SERIAL_H

#include <stdio.h>

#include <grobo/core/loop.h>
#include <grobo/core/port.h>
#include <grobo/mem.h>
#include <grobo/types.h>

GROBO_BEGIN_DECLS

/** Baud rate where none is given: that of GR001's board (protocol 1). */
#define GROBO_BAUD_DEFAULT_BPS 115200

/** How long grobo_serial_receive() waits in all, where no other time is given: as long as the
 *  original library (recieveData: 100 looks, 1 ms apart). */
#define GROBO_SILENCE_DEFAULT_MS 100

/** How the functions of a port behave. */
typedef enum grobo_serial_mode {
    GROBO_SERIAL_SYNC = 0, /**< functions wait; no loop is needed */
    GROBO_SERIAL_ASYNC = 1 /**< functions return at once; received bytes come by callback */
} grobo_serial_mode;

/** What happened to a port in asynchronous mode. */
typedef enum grobo_serial_event {
    GROBO_SERIAL_OPENED,    /**< open, and connected where it is a connection */
    GROBO_SERIAL_DRAINED,   /**< the queue of bytes to send has become empty */
    GROBO_SERIAL_UNPLUGGED, /**< the device or the other end is gone; the port is closed */
    GROBO_SERIAL_FAILED     /**< the system failed otherwise; the port is closed */
} grobo_serial_event;

/** Which way a byte went. */
typedef enum grobo_direction {
    GROBO_DIR_RX = 0, /**< received */
    GROBO_DIR_TX = 1  /**< handed over to the operating system */
} grobo_direction;

/** What a port has done since it was made. Monotonic. */
typedef struct grobo_serial_counters {
    uint64_t rx_bytes;      /**< received */
    uint64_t tx_bytes;      /**< handed over to the operating system */
    uint64_t reads;         /**< reads that gave bytes */
    uint64_t writes;        /**< writes that took bytes */
    uint64_t short_writes;  /**< writes that took fewer than given */
    uint64_t full;          /**< sends refused because the queue was full */
    uint64_t dropped_bytes; /**< received bytes thrown away by discard and by broken receives */
    uint64_t opens;         /**< successful opens */
    uint64_t unplugs;       /**< times the device was lost */
} grobo_serial_counters;

/** A serial port. */
typedef struct grobo_serial grobo_serial;

/** Bytes received (asynchronous mode). `bytes` is valid during the call; size > 0. */
typedef void (*grobo_serial_data_fn)(void *ctx, grobo_serial *serial, const uint8_t *bytes,
                                     size_t size);

/**
 * Something happened (asynchronous mode), reported from the loop, never from inside a function of
 * this header. `error` is GROBO_OK, or the GROBO_ERR_* of UNPLUGGED and FAILED, whose cause
 * grobo_serial_cause() has.
 */
typedef void (*grobo_serial_event_fn)(void *ctx, grobo_serial *serial, grobo_serial_event event,
                                      int error);

/** Every byte that goes in or out, for a trace, in either mode; must not call this header. */
typedef void (*grobo_serial_tap_fn)(void *ctx, grobo_direction direction, int64_t now_us,
                                    const uint8_t *bytes, size_t size);

/** What a port is made of. All zero is a valid one: synchronous, no device yet. */
typedef struct grobo_serial_config {
    size_t size;              /**< GROBO_SERIAL_CONFIG_INIT */
    const char *device;       /**< copied; NULL: none yet (grobo_serial_set_device) */
    int baud_bps;             /**< 0: GROBO_BAUD_DEFAULT_BPS; any positive rate, standard or not */
    grobo_line_format format; /**< set when the port is opened; zero: 8N1. A format that the
                                   device has not is an error of grobo_serial_open() */
    int silence_ms;           /**< bound of each call that waits; 0: GROBO_SILENCE_DEFAULT_MS */
    struct event_base *base;  /**< borrowed; NULL: synchronous mode only */
    grobo_serial_mode mode;   /**< ASYNC needs base and on_data */
    size_t tx_queue_bytes;    /**< 0: GROBO_SERIAL_QUEUE_BYTES, which is the most as well */
    grobo_serial_data_fn on_data;   /**< needed in ASYNC mode */
    grobo_serial_event_fn on_event; /**< or NULL */
    grobo_serial_tap_fn on_tap;     /**< NULL: no trace */
    void *ctx;                      /**< borrowed, handed to the callbacks */
    const grobo_mem *mem;           /**< borrowed allocator; NULL: the C library's */
    const grobo_port_ops *ops;      /**< borrowed; NULL: chosen by the device's name */
} grobo_serial_config;
/** Begins an initializer of one. */
#define GROBO_SERIAL_CONFIG_INIT GROBO_SIZED(grobo_serial_config)

/**
 * Makes a port, closed. config is copied, NULL stands for all zero.
 * @param[out] serial freed with grobo_serial_free().
 * @return GROBO_OK, GROBO_ERR_ARG (negative number, ASYNC without base or on_data),
 *   GROBO_ERR_CAP (device name or queue too long), GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_serial_new(const grobo_serial_config *config, grobo_serial **serial);

/** Closes and frees; bytes not sent are lost. NULL is fine; legal inside its own callbacks. */
GROBO_API void grobo_serial_free(grobo_serial *serial);

/* ---- device, mode, speed ------------------------------------------------------------------ */

/**
 * Sets the device's name (copied, NULL: none).
 * @return GROBO_OK, GROBO_ERR_STATE (open: close it first), GROBO_ERR_CAP (name too long).
 */
GROBO_API int grobo_serial_set_device(grobo_serial *serial, const char *device);

/** The device's name, NULL where none is set; valid until it is set again. */
GROBO_API const char *grobo_serial_device(const grobo_serial *serial);

/**
 * Sets the mode of a closed port.
 * @return GROBO_OK, GROBO_ERR_STATE (open: the mode stays), GROBO_ERR_ARG (ASYNC without base or
 *   on_data).
 */
GROBO_API int grobo_serial_set_mode(grobo_serial *serial, grobo_serial_mode mode);

/** The mode. */
GROBO_API grobo_serial_mode grobo_serial_get_mode(const grobo_serial *serial);

/**
 * Sets the speed, of an open port at once: bytes on their way are sent at either speed, so let
 * the line fall silent before. A rate that is not standard is set where the system can.
 * @return the rate in effect (an open port's may differ by up to 2 %), GROBO_ERR_ARG (not
 *   positive), GROBO_ERR_UNSUPPORTED (the device cannot: the old rate stays), GROBO_ERR_UNPLUGGED,
 *   GROBO_ERR_IO.
 */
GROBO_API int grobo_serial_set_baud(grobo_serial *serial, int baud_bps);

/** The speed that was asked for last and not refused, in bits per second. */
GROBO_API int grobo_serial_baud(const grobo_serial *serial);

/**
 * Asks the driver of an open port to hand over bytes at once; grobo_serial_open() has done so.
 * @return GROBO_OK, GROBO_ERR_UNSUPPORTED, GROBO_ERR_PERM, GROBO_ERR_CLOSED, GROBO_ERR_UNPLUGGED,
 *   GROBO_ERR_IO.
 */
GROBO_API int grobo_serial_set_low_latency(grobo_serial *serial);

/** What the driver of an open port answered to that last, or GROBO_ERR_CLOSED. */
GROBO_API int grobo_serial_low_latency(const grobo_serial *serial);

/* ---- open and close ----------------------------------------------------------------------- */

/**
 * Opens the device, and asks its driver for low latency: where the driver has none or refuses, the
 * port is open all the same. In asynchronous mode GROBO_SERIAL_OPENED follows from the loop, for a
 * connection when it is made; bytes may be sent before. In synchronous mode a connection is
 * waited for, at most 2 s.
 * @return GROBO_OK, GROBO_ERR_STATE (open already), GROBO_ERR_ARG (no device, malformed name),
 *   GROBO_ERR_TIMEOUT (no connection), GROBO_ERR_NOMEM, or as grobo_port_ops.open;
 *   grobo_serial_cause() has the reason.
 */
GROBO_API int grobo_serial_open(grobo_serial *serial);

/**
 * Closes; queued bytes and pending events are dropped. What the system has taken still leaves, and
 * this waits for it: for the time the bytes need on the line, at most 0.1 s more, and none when the
 * line is lost. Closed already: nothing happens.
 */
GROBO_API void grobo_serial_close(grobo_serial *serial);

/** True from a successful open until close or loss. */
GROBO_API bool grobo_serial_is_open(const grobo_serial *serial);

/** The operating system's handle, GROBO_HANDLE_NULL when closed. It belongs to the port. */
GROBO_API grobo_handle grobo_serial_handle(const grobo_serial *serial);

/** The operating system's reason of the last failure. Never NULL; valid until the next call. */
GROBO_API const grobo_os_cause *grobo_serial_cause(const grobo_serial *serial);

/** Copies the counters. */
GROBO_API void grobo_serial_get_counters(const grobo_serial *serial,
                                         grobo_serial_counters *counters);

/* ---- bytes -------------------------------------------------------------------------------- */

/**
 * Low-level read: what is there, at most `size` bytes. Synchronous mode waits for the first byte,
 * at most silence_ms.
 * @return count, 0 where nothing came or an asynchronous port is paused under a flood (see above);
 *   GROBO_ERR_CLOSED, GROBO_ERR_UNPLUGGED, GROBO_ERR_IO.
 */
GROBO_API int grobo_serial_read(grobo_serial *serial, void *buf, size_t size);

/**
 * Low-level write: hands over what the system takes. Synchronous mode waits until it takes the
 * first byte, at most silence_ms. While bytes are queued it takes none, to keep the order.
 * @return count, may be short; GROBO_ERR_CLOSED, GROBO_ERR_UNPLUGGED, GROBO_ERR_IO.
 */
GROBO_API int grobo_serial_write(grobo_serial *serial, const void *bytes, size_t size);

/**
 * Receives exactly `size` bytes (synchronous mode), and waits for them silence_ms in all, counted
 * from the call, however they come. Where fewer are there by then, they are dropped. A message
 * that takes longer on the line needs a larger silence_ms.
 * @param[out] buf undefined on error.
 * @return size, GROBO_ERR_TIMEOUT (nothing came), GROBO_ERR_SHORT (fewer came), GROBO_ERR_STATE
 *   (asynchronous mode), GROBO_ERR_CLOSED, GROBO_ERR_UNPLUGGED, GROBO_ERR_IO.
 */
GROBO_API int grobo_serial_receive(grobo_serial *serial, void *buf, size_t size);

/**
 * Sends all bytes. Asynchronous mode: all or none of them are queued (and go out as the line takes
 * them). Synchronous mode: waits until the system has taken all.
 * @return size; GROBO_ERR_FULL (asynchronous: no room for all), GROBO_ERR_TIMEOUT (synchronous:
 *   the line takes nothing for 1 s; part may have left), GROBO_ERR_CLOSED, GROBO_ERR_UNPLUGGED,
 *   GROBO_ERR_IO. In asynchronous mode a port found lost here reports it by its event.
 */
GROBO_API int grobo_serial_send(grobo_serial *serial, const void *bytes, size_t size);

/** Bytes queued to be sent that the system has not taken yet. */
GROBO_API size_t grobo_serial_pending(const grobo_serial *serial);

/**
 * These, and those that the system has taken and not put on the line yet, as far as it is known
 * (Linux knows it of serial ports and connections; 0 of a pseudo-terminal, and on Windows).
 */
GROBO_API size_t grobo_serial_unsent(const grobo_serial *serial);

/**
 * Bytes received and not read yet; the system may cap the number (Linux: 4095).
 * @return count, GROBO_ERR_CLOSED, GROBO_ERR_UNPLUGGED, GROBO_ERR_IO.
 */
GROBO_API int grobo_serial_waiting(grobo_serial *serial);

/**
 * Drops the bytes received and not read yet.
 * @return how many were dropped, GROBO_ERR_CLOSED, GROBO_ERR_UNPLUGGED, GROBO_ERR_IO.
 */
GROBO_API int grobo_serial_discard(grobo_serial *serial);

/** Drops the bytes not sent yet, in the queue and, where it can be done, in the system. */
GROBO_API void grobo_serial_discard_output(grobo_serial *serial);

/* ---- hex ---------------------------------------------------------------------------------- */

/**
 * A packet as hex, "FA AF 03", NUL-terminated. No port is needed. Thread safe.
 * @return the length of the text; GROBO_ERR_SPACE when text_bytes < 3 * size (1 for size 0).
 */
GROBO_API int grobo_hex(const void *bytes, size_t size, char *text, size_t text_bytes);

/** A packet as one line of hex into a stream that the caller gives. @return GROBO_OK,
 *  GROBO_ERR_IO. */
GROBO_API int grobo_hex_print(const void *bytes, size_t size, FILE *stream);

GROBO_END_DECLS

#endif
