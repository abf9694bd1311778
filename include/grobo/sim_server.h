/* SPDX-License-Identifier: MIT */
/**
 * @file sim_server.h
 * @brief A simulated robot that other programs can open: behind a pseudo-terminal, behind TCP.
 *
 * The simulator of sim.h in real time: bytes reach it and leave it when their time on the wire is
 * over. Programs may come and go, the robot stays as they left it. Any number of servers may run
 * on one loop. A server belongs to the thread that runs its loop; it prints nothing.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_SIM_SERVER_H
#define GROBO_SIM_SERVER_H

#include <grobo/core/serial.h>
#include <grobo/sim.h>

GROBO_BEGIN_DECLS

/** How long a port that hung up (fault of the simulator) stays away, where nothing is given. */
#define GROBO_SIM_REPLUG_DEFAULT_MS 1000

/** A server of one simulated robot. */
typedef struct grobo_sim_server grobo_sim_server;

/** What a server is made of. Zero means default. */
typedef struct grobo_sim_server_config {
    size_t size;                 /**< GROBO_SIM_SERVER_CONFIG_INIT */
    struct event_base *base;     /**< borrowed; needed */
    const grobo_sim_config *sim; /**< copied; NULL: all defaults */
    bool no_pty;                 /**< serve by TCP only */
    const char *link;            /**< copied; symbolic link to the pseudo-terminal, or NULL */
    const char *tcp;             /**< copied; "tcp:HOST:PORT" to listen on (PORT 0: any), or NULL */
    int replug_ms;               /**< 0: GROBO_SIM_REPLUG_DEFAULT_MS; negative: stays away */
    grobo_serial_tap_fn on_tap;  /**< every byte, RX from the host, TX to it; or NULL */
    void *ctx;                   /**< borrowed, handed to on_tap */
    const grobo_mem *mem;        /**< borrowed allocator; NULL: the C library's */
} grobo_sim_server_config;
/** Begins an initializer of one. */
#define GROBO_SIM_SERVER_CONFIG_INIT GROBO_SIZED(grobo_sim_server_config)

/**
 * Makes a server and opens what it serves.
 * @param[out] server freed with grobo_sim_server_free().
 * @param[out] cause filled where opening fails; may be NULL.
 * @return GROBO_OK; GROBO_ERR_ARG (no base, nothing to serve, bad simulator), GROBO_ERR_CAP (name
 *   too long), GROBO_ERR_UNSUPPORTED (no pseudo-terminals here), GROBO_ERR_NOMEM, or what
 *   grobo_port_pty_ops() and grobo_port_listen() say.
 */
GROBO_API int grobo_sim_server_new(const grobo_sim_server_config *config, grobo_sim_server **server,
                                   grobo_os_cause *cause);

/** Hangs up, removes the link, frees. NULL is fine. */
GROBO_API void grobo_sim_server_free(grobo_sim_server *server);

/**
 * The device to open: the pseudo-terminal's path, else "tcp:HOST:PORT". Valid until the server
 * hangs up; "" while it is hung up.
 */
GROBO_API const char *grobo_sim_server_device(const grobo_sim_server *server);

/** The TCP port it listens on, 0 for none. */
GROBO_API int grobo_sim_server_tcp_port(const grobo_sim_server *server);

/**
 * The simulator, for inspection and faults. After a change that makes it act by itself call
 * grobo_sim_server_pump().
 */
GROBO_API grobo_sim *grobo_sim_server_sim(grobo_sim_server *server);

/** Moves what is due and sets the timer. */
GROBO_API void grobo_sim_server_pump(grobo_sim_server *server);

/**
 * Takes the cable out (in = false): programs see their port hang up; or puts it back: there is a
 * pseudo-terminal again, with the same link, and the TCP port. The robot is not touched.
 * @return GROBO_OK, or what opening says when putting back.
 */
GROBO_API int grobo_sim_server_plug(grobo_sim_server *server, bool in);

GROBO_END_DECLS

#endif
