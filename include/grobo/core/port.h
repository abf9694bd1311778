/* SPDX-License-Identifier: MIT */
/**
 * @file port.h
 * @brief What the library asks of an operating system: clock, thread, lock, byte ports.
 *
 * A port is a folder (ports/posix, ports/win32) that brings grobo/core/port_os.h with the types and
 * implements everything declared here. ports/README.md explains how to write another one.
 *
 * Nothing here knows an event loop. A byte port has a socket that a loop can wait on: on
 * POSIX the descriptor itself, on Win32 one end of a socket pair that a thread of the port pumps
 * from and to the COM handle by overlapped I/O.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_PORT_H
#define GROBO_CORE_PORT_H

#include <grobo/core/port_os.h>
#include <grobo/types.h>

GROBO_BEGIN_DECLS

/** Longest device name, with its NUL. */
#define GROBO_DEVICE_MAX_BYTES 256
/** Longest text of a cause, with its NUL. */
#define GROBO_CAUSE_MAX_BYTES 192

/* ---- the operating system's cause --------------------------------------------------------- */

/** Why the operating system refused; kept beside the GROBO_ERR_* it was turned into. */
typedef struct grobo_os_cause {
    int code;                         /**< errno or GetLastError(); 0 where the OS gave none */
    char text[GROBO_CAUSE_MAX_BYTES]; /**< one phrase for a person: "held by minicom (pid 812)" */
} grobo_os_cause;

/* ---- start -------------------------------------------------------------------------------- */

/**
 * Prepares what the system wants prepared before its first socket is made (Win32: WSAStartup; on
 * POSIX nothing). grobo_loop_new() and the opening of a port do it; a program that makes an event
 * base of its own calls it first. Any number of times; thread safe.
 * @return GROBO_OK, GROBO_ERR_IO.
 */
GROBO_API int grobo_port_start(void);

/* ---- clock -------------------------------------------------------------------------------- */

/**
 * Now, in microseconds of a monotonic clock with an arbitrary start. Never negative, never goes
 * back, goes on while the machine sleeps, and is not affected when the system's date is changed.
 * Thread safe.
 */
GROBO_API int64_t grobo_now_us(void);

/* ---- threads and locks -------------------------------------------------------------------- */

/** The function a thread runs: `GROBO_THREAD_FUNC run(void *arg) { ...; GROBO_THREAD_RETURN; }` */
typedef GROBO_THREAD_FUNC (*grobo_thread_fn)(void *arg);

/**
 * Starts a thread. It takes no signals: they stay with the threads the program made itself.
 * @param[out] thread to be joined by grobo_thread_join(), exactly once.
 * @param arg borrowed, handed to fn.
 * @return GROBO_OK, GROBO_ERR_ARG (a NULL), GROBO_ERR_NOMEM (the system has no more threads).
 */
GROBO_API int grobo_thread_start(grobo_thread *thread, grobo_thread_fn fn, void *arg);

/**
 * Waits until the thread's function has returned, and frees the thread.
 * @return GROBO_OK; GROBO_ERR_STATE when called by the thread itself.
 */
GROBO_API int grobo_thread_join(grobo_thread thread);

/** True when the calling thread is `thread`. */
GROBO_API bool grobo_thread_is_self(grobo_thread thread);

/** How the system chooses among the threads that can run. */
typedef enum grobo_realtime_policy {
    GROBO_REALTIME_NONE = 0, /**< as it was */
    GROBO_REALTIME_FIFO,     /**< before every thread of less priority, until it waits */
    GROBO_REALTIME_RR        /**< the same, in turns with those of its own priority */
} grobo_realtime_policy;

/** How a thread shall run. Zeros change nothing. Gets no more fields. */
typedef struct grobo_realtime {
    grobo_realtime_policy policy; /**< Windows has one: time critical, for both */
    int priority;  /**< 1..99, higher before lower; 0 where policy is GROBO_REALTIME_NONE */
    uint64_t cpus; /**< bit k: CPU k may run it; 0: as it was. Linux and Windows */
    bool mlock;    /**< the whole process stays in memory, what it allocates later too */
} grobo_realtime;

/**
 * Has the calling thread run so. Processes that it starts get neither its priority nor its memory's
 * lock (Linux; elsewhere they may), but its CPUs. What was changed before an error stays changed:
 * memory, then CPUs, then priority; who wants to say which was refused asks for one at a time.
 * @return GROBO_OK; GROBO_ERR_ARG; GROBO_ERR_PERM (the limits `ulimit -r` and `ulimit -l` of the
 *   user, or the groups that the process is in); GROBO_ERR_NOTFOUND (none of those CPUs);
 *   GROBO_ERR_UNSUPPORTED (not known on this system).
 */
GROBO_API int grobo_thread_realtime(const grobo_realtime *how);

/** Makes a lock in caller's storage, with priority inheritance where the system has it.
 *  @return GROBO_OK, GROBO_ERR_NOMEM. */
GROBO_API int grobo_mutex_init(grobo_mutex *mutex);

/** Takes the lock, waits for it. Not recursive: taking it twice in one thread is a fault. */
GROBO_API void grobo_mutex_lock(grobo_mutex *mutex);

/** Gives the lock back; the thread that took it must call. */
GROBO_API void grobo_mutex_unlock(grobo_mutex *mutex);

/** Ends a lock that no thread holds. */
GROBO_API void grobo_mutex_deinit(grobo_mutex *mutex);

/**
 * Makes a condition in caller's storage: threads sleep at it until another one wakes them. It takes
 * no descriptor. @return GROBO_OK, GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_cond_init(grobo_cond *cond);

/**
 * Releases the lock, which the caller holds, sleeps, and takes the lock again. No wake-up between
 * the release and the sleep is lost. It may return early for no reason: test the predicate again.
 * @param until_us the moment of grobo_now_us() to return at; GROBO_NEVER_US: when woken.
 */
GROBO_API void grobo_cond_wait(grobo_cond *cond, grobo_mutex *mutex, int64_t until_us);

/** Wakes all threads that sleep at the condition; with or without the lock. */
GROBO_API void grobo_cond_wake_all(grobo_cond *cond);

/** Ends a condition at which no thread sleeps. */
GROBO_API void grobo_cond_deinit(grobo_cond *cond);

/* ---- byte ports --------------------------------------------------------------------------- */

/** The form of a byte on a serial line, and how a line is driven; all zero: 8N1. */
typedef struct grobo_line_format {
    grobo_parity parity; /**< bytes with a wrong parity are dropped */
    int stop_bits;       /**< 1 or 2; 0: 1 */
    bool rs485;          /**< the driver enables the transmitter by RTS while bytes leave; false:
                              the adapter does, or it is no RS-485 line */
} grobo_line_format;

/** An open byte port: storage of grobo_port_ops.size_bytes that the caller provides. */
typedef struct grobo_port grobo_port;

/**
 * A kind of byte port. A table of these functions is all that src/link knows of a line, so a test
 * or a program may hand in its own (grobo_serial_config.ops).
 *
 * No function but close() blocks, and none is called again by a signal's interruption (EINTR is
 * taken care of inside). `cause` is filled when a function fails, and is never NULL. A port belongs
 * to the thread that uses it. Reading, writing and ready() return GROBO_ERR_UNPLUGGED when the
 * other end or the device is gone, GROBO_ERR_IO for any other failure; after either only close()
 * may follow.
 */
typedef struct grobo_port_ops {
    const char *name;  /**< "serial", "tcp" */
    size_t size_bytes; /**< size of a grobo_port of this kind, for malloc-like alignment */

    /**
     * Opens a device: raw, 8 data bits, no parity, 1 stop bit, no flow control, for this process
     * alone, what was received before is dropped. The storage needs no preparation.
     * @return GROBO_OK; or one of these, and there is nothing to close: GROBO_ERR_NOENT,
     *   GROBO_ERR_PERM, GROBO_ERR_BUSY (cause names the holder where it is known),
     *   GROBO_ERR_ISDIR, GROBO_ERR_TYPE (no serial port), GROBO_ERR_UNSUPPORTED (baud rate),
     *   GROBO_ERR_ARG (malformed name), GROBO_ERR_UNPLUGGED (the node is there, the device not),
     *   GROBO_ERR_NOMEM (the system has no memory or no handle left),
     *   GROBO_ERR_IO.
     */
    int (*open)(grobo_port *port, const char *device, int baud_bps, grobo_os_cause *cause);

    /**
     * Closes; the storage may be used for another open() then. What was written still leaves: the
     * one call that may wait, for the time that takes on the line and 0.1 s more.
     */
    void (*close)(grobo_port *port);

    /**
     * Whether open() has been completed: a connection may still be on its way. While 0, wait
     * until socket() is writable and ask again.
     * @return 1 usable, 0 not yet, or an error (GROBO_ERR_NOENT: no listener).
     */
    int (*ready)(grobo_port *port, grobo_os_cause *cause);

    /** Takes what has been received, at most `size` bytes. @return count; 0 nothing now. */
    int (*read)(grobo_port *port, void *buf, size_t size, grobo_os_cause *cause);

    /** Hands over what the system takes at once. @return count, may be short; 0 none now. */
    int (*write)(grobo_port *port, const void *buf, size_t size, grobo_os_cause *cause);

    /** Bytes received and not yet read; the system may cap the number. */
    int (*waiting)(grobo_port *port, grobo_os_cause *cause);

    /**
     * Drops what was written and has not left yet. Where the system cannot, nothing happens.
     * (To drop what was received, read it: then its count is known.)
     */
    void (*discard_output)(grobo_port *port);

    /**
     * Changes the speed of an open port, reads it back and compares.
     * @return the rate in effect, within 2 % of what was asked for (a UART's tolerance);
     *   GROBO_ERR_UNSUPPORTED when the device runs at another one (the old one is set again);
     *   for a kind without a speed: baud_bps.
     */
    int (*set_baud)(grobo_port *port, int baud_bps, grobo_os_cause *cause);

    /**
     * Changes the form of the bytes of an open port, which stays so until it is closed.
     * @return GROBO_OK, also for a kind that has no such form (a pseudo-terminal takes a parity and
     *   drops it); GROBO_ERR_UNSUPPORTED where device or system cannot, GROBO_ERR_ARG.
     */
    int (*set_format)(grobo_port *port, const grobo_line_format *format, grobo_os_cause *cause);

    /**
     * Asks the driver to hand over received bytes at once (FTDI: latency timer 1 ms for 16).
     * @return GROBO_OK, GROBO_ERR_UNSUPPORTED where the driver knows no such thing,
     *   GROBO_ERR_PERM where it may not be set.
     */
    int (*set_low_latency)(grobo_port *port, grobo_os_cause *cause);

    /** What an event loop or grobo_port_wait() waits on; valid until close(). */
    grobo_socket (*socket)(const grobo_port *port);

    /** The operating system's handle; belongs to the port, valid until close(). */
    grobo_handle (*handle)(const grobo_port *port);

    /**
     * Bytes that the system has taken by write() and that have not left, as far as it is known.
     * Of a connection: more than it may have on its way before an acknowledgement is due.
     * @return count; 0 also where it is not known. NULL: it never is.
     */
    int (*unsent)(const grobo_port *port);
} grobo_port_ops;

/**
 * Serial ports: a path (/dev/ttyUSB0, a link in /dev/serial/by-id, a pty's slave), or on Win32
 * COM1, COM10 and the like, with or without the prefix of devices. Static, thread safe.
 */
GROBO_API const grobo_port_ops *grobo_port_serial_ops(void);

/**
 * Raw TCP, as ser2net serves a serial port: the device is "tcp:HOST:PORT", HOST being a numeric
 * IPv4 address, a numeric IPv6 address in [], or localhost: nothing here may block, and a look-up
 * of names does (grobo_port_resolve() does it beforehand). Static, thread safe.
 */
GROBO_API const grobo_port_ops *grobo_port_tcp_ops(void);

/**
 * Turns "tcp:HOST:PORT" with a name for HOST into the numeric form; any other device is copied as
 * it is. BLOCKS while the system looks the name up: call it before a loop runs. Thread safe.
 * @param[out] numeric NUL-terminated on success.
 * @return GROBO_OK, GROBO_ERR_ARG (malformed), GROBO_ERR_NOENT (no such host),
 *   GROBO_ERR_SPACE (numeric_bytes too small; GROBO_DEVICE_MAX_BYTES is always enough).
 */
GROBO_API int grobo_port_resolve(const char *device, char *numeric, size_t numeric_bytes,
                                 grobo_os_cause *cause);

/** Wait for bytes to read. */
#define GROBO_PORT_READABLE 1u
/** Wait for room to write. */
#define GROBO_PORT_WRITABLE 2u

/**
 * Waits, without using the processor, until a port's socket is ready or timeout_us have passed
 * (0 asks only, negative is taken for 0). For calls that wait; a loop never calls it.
 * @param what GROBO_PORT_READABLE, GROBO_PORT_WRITABLE or both.
 * @return the ready ones of `what` (an error or hang-up counts as ready: the next read or write
 *   tells), 0 when the time has passed or a signal came, GROBO_ERR_IO.
 */
GROBO_API int grobo_port_wait(grobo_socket socket, unsigned what, int64_t timeout_us);

/* ---- far ends: what a simulator serves ---------------------------------------------------- */

/**
 * Pseudo-terminals: open() makes one, and the port is its far end; programs open the other one,
 * which is raw and at baud_bps until they set it. The device's name is that of a symbolic link to
 * it, "" for none; a symbolic link that is there is replaced, anything else refused with
 * GROBO_ERR_EXISTS; close() removes it. Programs may come and go: the port stays, and does not
 * notice.
 * @return static table; NULL on systems without pseudo-terminals (Win32).
 */
GROBO_API const grobo_port_ops *grobo_port_pty_ops(void);

/**
 * The path under which programs open an open pseudo-terminal.
 * @param[out] path NUL-terminated on success.
 * @return GROBO_OK, GROBO_ERR_SPACE, GROBO_ERR_UNSUPPORTED.
 */
GROBO_API int grobo_port_pty_path(const grobo_port *port, char *path, size_t path_bytes);

/** The speed that a program has set on an open pseudo-terminal, 0 not known. */
GROBO_API int grobo_port_pty_baud(const grobo_port *port);

/**
 * Whether a program has the other end of an open pseudo-terminal open. What it wrote before it
 * closed is still to be read.
 */
GROBO_API bool grobo_port_pty_in_use(grobo_port *port);

/**
 * Listens for connections.
 * @param device "tcp:HOST:PORT", HOST numeric or localhost; PORT 0 takes a free one.
 * @param[out] listener to be waited on until readable; closed by grobo_port_listen_close().
 * @param[out] tcp_port the port taken.
 * @return GROBO_OK, GROBO_ERR_ARG, GROBO_ERR_NOENT (no such address), GROBO_ERR_BUSY (port in
 *   use), GROBO_ERR_PERM, GROBO_ERR_IO.
 */
GROBO_API int grobo_port_listen(const char *device, grobo_socket *listener, int *tcp_port,
                                grobo_os_cause *cause);

/** Ends listening; connections stay. */
GROBO_API void grobo_port_listen_close(grobo_socket listener);

/**
 * Takes a connection; it is a port of grobo_port_tcp_ops() then. Does not wait.
 * @return GROBO_OK, GROBO_ERR_EMPTY (none is there), GROBO_ERR_IO.
 */
GROBO_API int grobo_port_accept(grobo_socket listener, grobo_port *port, grobo_os_cause *cause);

/* ---- list of ports ------------------------------------------------------------------------ */

/** One serial port of this machine. Texts that are not known are empty. */
typedef struct grobo_port_info {
    char path[GROBO_DEVICE_MAX_BYTES];  /**< what to open: /dev/ttyUSB0, COM3 */
    char by_id[GROBO_DEVICE_MAX_BYTES]; /**< the name that stays when it is plugged in elsewhere */
    char driver[64];                    /**< ftdi_sio, cdc_acm, serial8250 */
    char manufacturer[64];              /**< from the USB device */
    char product[64];                   /**< from the USB device */
    char serial_number[64];             /**< from the USB device */
    int usb_vendor;                     /**< USB vendor id, -1 for no USB device */
    int usb_product;                    /**< USB product id, -1 for no USB device */
    int latency_ms;                     /**< the FTDI driver's latency timer, -1 unknown */
    int owner_pid;                      /**< a process that has it open, 0 none or not known */
    char owner_name[64];                /**< the name of that process */
    bool console;    /**< the system's console: what is printed at boot, a login (Linux) */
    bool bluetooth;  /**< a Bluetooth chip is wired to it (Linux) */
    int open_result; /**< GROBO_OK: may be opened; else GROBO_ERR_PERM, GROBO_ERR_BUSY, ... */
} grobo_port_info;

/**
 * Visits every serial port of this machine, without opening any (opening moves modem lines).
 * @param visit called for each, in the order of their names (COM2 before COM10); `info` is valid
 *   during the call; a result other than 0 ends the visit and is returned.
 * @return the number of ports, or what visit returned; GROBO_ERR_UNSUPPORTED where the system
 *   has no list. Blocks for as long as the system takes to list (milliseconds). Thread safe.
 */
GROBO_API int grobo_port_list(int (*visit)(void *ctx, const grobo_port_info *info), void *ctx);

/**
 * The name of a device that stays the same when it is unplugged and comes back elsewhere: its
 * link in /dev/serial/by-id; for a device without one, its own name.
 * @param[out] name NUL-terminated on success.
 * @return GROBO_OK, GROBO_ERR_ARG, GROBO_ERR_SPACE.
 */
GROBO_API int grobo_port_identity(const char *device, char *name, size_t name_bytes);

/** The name of a guard's process (guard.h) where the system tells names: 15 characters at most. */
#define GROBO_GUARD_NAME "grobo-guard"

/**
 * A process that has a device open: the one that holds its lock, else the first found that has it
 * open and is not the caller.
 * @param[out] name the process's name, NUL-terminated, cut to size; untouched where none.
 * @return its pid, 0 where there is none or it is not known.
 */
GROBO_API int grobo_port_owner(const char *device, char *name, size_t name_bytes);

GROBO_END_DECLS

#endif
