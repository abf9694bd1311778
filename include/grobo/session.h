/* SPDX-License-Identifier: MIT */
/**
 * @file session.h
 * @brief A robot on an event loop: the engine of robot.h, pumped over a line.
 *
 * The line is a serial port, a connection, or a simulator in the same process. The session opens
 * it, asks whether a robot answers, moves bytes both ways, calls the engine at its deadlines, and
 * opens a lost line again where so configured. It adds nothing to what the engine decides: every
 * request and question of robot.h works on grobo_session_robot(), at the present time, and what a
 * request sends leaves at once. Its events come from the loop, never from within the request.
 *
 * It obeys emergency stops that other programs ask for (estop.h), except with GROBO_DEVICE_SIM.
 * grobo_robot_reset() clears the mark of such a stop, where the latched stop is an emergency
 * stop. Where that fails (GROBO_ERR_PERM, GROBO_ERR_IO), and while a stop that was just asked for
 * is carried out (GROBO_ERR_STATE), the session stays latched.
 *
 * A session belongs to the thread that runs its loop. Every function may be called in its
 * callbacks but on_tap, which only looks; closing and freeing take effect when the callback has
 * returned. While a callback runs, nothing is read, watched or sent. One that takes longer than
 * GROBO_CALLBACK_SLOW_US is reported to on_robot by GROBO_EVENT_SLOW_CALLBACK, in any state of the
 * session; of callbacks that run one inside another the outer one is reported.
 *
 * Other threads and signal handlers may call grobo_session_post_estop(), grobo_session_post_stop(),
 * grobo_session_post_exit() and grobo_session_is_latched(), and nothing else of a session. The
 * program makes sure that none of them is called once the session is being freed. A process that
 * the program forked calls nothing of it, not even grobo_session_free(): port and loop are its
 * parent's.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_SESSION_H
#define GROBO_SESSION_H

#include <grobo/core/serial.h>
#include <grobo/guard.h>
#include <grobo/robot.h>
#include <grobo/sim.h>

GROBO_BEGIN_DECLS

/** The device that is a simulator in the same process, in real time. */
#define GROBO_DEVICE_SIM "sim"
/** The device that is the first serial port on which a robot answers; of a robot of several lines
 *  (core/lines.h) the ports that its lines name. */
#define GROBO_DEVICE_AUTO "auto"

/** Serial ports that GROBO_DEVICE_AUTO tries at most; USB adapters come first, ttyUSB2
 *  before ttyUSB10. */
#define GROBO_SCAN_PORTS_MAX 32

/** First pause between two attempts to open a lost line again; they double. */
#define GROBO_RECONNECT_FIRST_US 20000
/** Longest such pause. */
#define GROBO_RECONNECT_MAX_US 100000

/** The state of a session. */
typedef enum grobo_session_state {
    GROBO_SESSION_CLOSED = 0, /**< nothing open */
    GROBO_SESSION_OPENING,    /**< waits until the connection is made */
    GROBO_SESSION_CHECKING,   /**< waits for the robot's answer */
    GROBO_SESSION_UP,         /**< a robot is there */
    GROBO_SESSION_WAITING     /**< the line is lost, the next attempt is scheduled */
} grobo_session_state;

/** What a session reports. */
typedef enum grobo_session_event {
    GROBO_SESSION_EVENT_UP,       /**< a robot is there, for the first time or again */
    GROBO_SESSION_EVENT_LOST,     /**< the line was up and is lost; error: why */
    GROBO_SESSION_EVENT_FAILED,   /**< grobo_session_open() failed; error: why */
    GROBO_SESSION_EVENT_UNGUARDED /**< the guard has ended (GROBO_ERR_CLOSED) or cannot guard this
                                       robot (GROBO_ERR_UNSUPPORTED); reported once, the session
                                       stays as it is */
} grobo_session_event;

/** A robot on a loop. */
typedef struct grobo_session grobo_session;

/**
 * Something happened to the line; always from the loop. After LOST without `reconnect`, and after
 * FAILED, the session is closed. grobo_session_cause() has details. LOST with GROBO_ERR_STALLED:
 * this process was stopped (SIGSTOP) while joints moved, and its guard stopped the robot.
 */
typedef void (*grobo_session_event_fn)(void *ctx, grobo_session *session, grobo_session_event event,
                                       int error);

/** What a session is made of. Zero means default. */
typedef struct grobo_session_config {
    size_t size;                     /**< GROBO_SESSION_CONFIG_INIT */
    struct event_base *base;         /**< borrowed; needed */
    const char *device;              /**< copied; needed: a serial port, "tcp:HOST:PORT",
                                          GROBO_DEVICE_SIM or GROBO_DEVICE_AUTO; of a robot of
                                          several lines "NAME=PORT,NAME=PORT": lines that are left
                                          out have the port that they name themselves */
    int baud_bps;                    /**< 0: GROBO_BAUD_DEFAULT_BPS */
    grobo_line_format format;        /**< stop bits, RS-485; the parity is the driver's */
    const grobo_driver *driver;      /**< borrowed; NULL: GR001 through its board */
    void *driver_ctx;                /**< borrowed, handed to the driver */
    const grobo_robot_config *robot; /**< copied; NULL: defaults; baud_bps 0: the session's */
    const grobo_sim_config *sim;     /**< copied; NULL: of the driver's model and the line's baud;
                                          wiring and echo are those of driver and robot */
    const char *const *scan;         /**< borrowed; devices that GROBO_DEVICE_AUTO tries, in this
                                          order, ended by NULL; NULL: all serial ports */
    bool skip_check;                 /**< up as soon as the line is open: no robot is asked for */
    bool reconnect;                  /**< open a lost line again, until closed, by the name
                                          that stays (grobo_port_identity()) */
    grobo_session_event_fn on_event; /**< the line's events, or NULL */
    grobo_event_fn on_robot;         /**< the engine's events while up, or NULL */
    grobo_serial_tap_fn on_tap;      /**< every byte, for a trace, or NULL */
    void *ctx;                       /**< borrowed, handed to the callbacks */
    grobo_guard *guard;              /**< borrowed, of one session at a time, freed after it: stops
                                          the robot when this process dies (guard.h); NULL: none.
                                          Not used for GROBO_DEVICE_SIM */
    const void *guard_data;          /**< borrowed as long as the session: what the guard's program
                                          needs to make the same driver, or NULL */
    size_t guard_bytes;              /**< of it, at most GROBO_GUARD_DATA_BYTES */
    const grobo_mem *mem;            /**< borrowed allocator; NULL: the C library's */
} grobo_session_config;
/** Begins an initializer of one. */
#define GROBO_SESSION_CONFIG_INIT GROBO_SIZED(grobo_session_config)

/**
 * Makes a session, closed.
 * @param[out] session freed with grobo_session_free().
 * @return GROBO_OK, GROBO_ERR_ARG (what is needed is missing, driver or robot configuration bad),
 *   GROBO_ERR_CAP (device name or guard data too long), GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_session_new(const grobo_session_config *config, grobo_session **session);

/** Closes and frees; NULL is fine. No exit policy is carried out: grobo_robot_exit() before. */
GROBO_API void grobo_session_free(grobo_session *session);

/**
 * Opens the device. GROBO_SESSION_EVENT_UP or _FAILED follows from the loop, unless an error is
 * returned. FAILED comes with GROBO_ERR_TIMEOUT where no robot answers, for GROBO_DEVICE_AUTO with
 * GROBO_ERR_NOTFOUND, after at most 2 s for each port.
 * @return GROBO_OK, GROBO_ERR_STATE (not closed), GROBO_ERR_NOTFOUND (GROBO_DEVICE_AUTO: no
 *   serial port to try), GROBO_ERR_NOMEM, or as grobo_serial_open().
 */
GROBO_API int grobo_session_open(grobo_session *session);

/** Closes: a job ends with GROBO_ERR_UNPLUGGED. A simulator keeps its state for the next open. */
GROBO_API void grobo_session_close(grobo_session *session);

/**
 * Sets the device for the next open, as in the configuration (copied).
 * @return GROBO_OK, GROBO_ERR_ARG (NULL), GROBO_ERR_STATE (not closed), GROBO_ERR_CAP (name too
 *   long).
 */
GROBO_API int grobo_session_set_device(grobo_session *session, const char *device);

/**
 * Changes the engine's configuration (copied; NULL: all defaults), from now on and for every time
 * the line comes up; the line's physics stay as they are.
 * @return GROBO_OK, or GROBO_ERR_ARG: then nothing changed.
 */
GROBO_API int grobo_session_configure(grobo_session *session, const grobo_robot_config *config);

/** Its state. */
GROBO_API grobo_session_state grobo_session_get_state(const grobo_session *session);

/** The device in use: what was configured; for GROBO_DEVICE_AUTO the port that is open. */
GROBO_API const char *grobo_session_device(const grobo_session *session);

/** The operating system's reason of the last failure. Never NULL; valid until the next call. */
GROBO_API const grobo_os_cause *grobo_session_cause(const grobo_session *session);

/** The engine: every request and question of robot.h. Valid as long as the session. */
GROBO_API grobo_robot *grobo_session_robot(grobo_session *session);

/** The simulator of GROBO_DEVICE_SIM, from the first open on; else NULL. */
GROBO_API grobo_sim *grobo_session_sim(grobo_session *session);

/** The serial port, which is closed for GROBO_DEVICE_SIM. It belongs to the session. */
GROBO_API grobo_serial *grobo_session_serial(grobo_session *session);

/** Bytes of both directions, in either kind of line, since the session was made. */
GROBO_API void grobo_session_bytes(const grobo_session *session, uint64_t *tx_bytes,
                                   uint64_t *rx_bytes);

/* ---- requests of other threads and signal handlers ------------------------------------------
 * They take no lock, no memory and no descriptor, keep errno, and never wait: what is asked for is
 * noted in an atomic word, and the loop is woken. It is kept until the loop has carried it out, and
 * nothing else leaves before: the next frame on the wire is the stop. Where the loop does not run,
 * because a callback holds it or no thread runs it, the request waits. Requests of the same
 * kind that the loop finds together are one. What other threads ask of the engine meanwhile is
 * stopped as well. All return GROBO_OK, or GROBO_ERR_ARG. */

/**
 * grobo_robot_estop(), by the loop. The stop counts as latched from the return of this call on;
 * without a line it is carried out when the line is there.
 */
GROBO_API int grobo_session_post_estop(grobo_session *session);

/** grobo_robot_stop(), by the loop. At once prevails over smoothly, an emergency stop over both.
 *  Without a robot nothing is done. */
GROBO_API int grobo_session_post_stop(grobo_session *session, bool at_once);

/**
 * grobo_robot_exit(), by the loop, after an emergency stop that is being carried out; its end is
 * a job event. The last policy prevails. Without a robot nothing is done.
 */
GROBO_API int grobo_session_post_exit(grobo_session *session, grobo_exit_policy policy);

/**
 * True from a safety stop, or from the return of grobo_session_post_estop(), until the loop has
 * carried out a grobo_robot_reset() that came after it: whatever is requested in between that
 * moves or switches torque on is refused, or is stopped before anything of it leaves. True means
 * that a stop is certain, not that it has been carried out: the end of the job GROBO_JOB_ESTOP
 * says that, or grobo_robot_tripped() on the loop.
 */
GROBO_API bool grobo_session_is_latched(const grobo_session *session);

GROBO_END_DECLS

#endif
