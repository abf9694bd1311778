/* SPDX-License-Identifier: MIT */
/**
 * @file virtual.h
 * @brief An engine and a simulated robot in virtual time: a motion of a minute in a second.
 *
 * Engine and simulator are those of a real line; only the clock is not. Nothing happens between two
 * calls of grobo_virtual_run(), so a program may take its time to look. The same requests at the
 * same times give the same bytes and angles to the bit, on any machine.
 *
 * A robot of this kind belongs to one thread, needs no loop, and opens nothing.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_VIRTUAL_H
#define GROBO_CORE_VIRTUAL_H

#include <grobo/core/driver.h>
#include <grobo/core/robot.h>
#include <grobo/core/sim.h>
#include <grobo/mem.h>

GROBO_BEGIN_DECLS

/** After a hang-up (fault of the simulator) the cable is put back in after this long. */
#define GROBO_VIRTUAL_REPLUG_US 1000000

/** A robot in virtual time. */
typedef struct grobo_virtual grobo_virtual;

/** What it is made of. Zero in a field means its default. */
typedef struct grobo_virtual_config {
    size_t size;                     /**< GROBO_VIRTUAL_CONFIG_INIT */
    const grobo_driver *driver;      /**< borrowed; NULL: GR001 through its board */
    void *driver_ctx;                /**< borrowed, handed to the driver */
    const grobo_robot_config *robot; /**< copied; NULL: defaults */
    const grobo_sim_config *sim;     /**< copied; NULL: of the driver's model. Wiring and echo are
                                          those of driver and robot; one line has one rate, where
                                          robot or sim gives one */
    const grobo_mem *mem;            /**< borrowed allocator; NULL: the C library's */
} grobo_virtual_config;
/** Begins an initializer of one. */
#define GROBO_VIRTUAL_CONFIG_INIT GROBO_SIZED(grobo_virtual_config)

/**
 * Makes a robot, powered up and connected, at time 0.
 * @param[out] made freed with grobo_virtual_free().
 * @return 0, GROBO_ERR_NOMEM, or what grobo_robot_init() and grobo_sim_init() return
 */
GROBO_API int grobo_virtual_new(const grobo_virtual_config *config, grobo_virtual **made);

/** Frees; NULL is fine. */
GROBO_API void grobo_virtual_free(grobo_virtual *robot);

/** The engine: every request and question of robot.h, at the present virtual time. */
GROBO_API grobo_robot *grobo_virtual_robot(grobo_virtual *robot);

/** The simulator, for inspection and faults; of a robot of several lines that of the first one. */
GROBO_API grobo_sim *grobo_virtual_sim(grobo_virtual *robot);

/** The simulator of a line (lines.h), 0..n-1; NULL where there is none. */
GROBO_API grobo_sim *grobo_virtual_line_sim(grobo_virtual *robot, int line);

/** Virtual time since it was made; negative error code without a robot. */
GROBO_API int64_t grobo_virtual_now_us(const grobo_virtual *robot);

/**
 * Lets time pass. Events come from here (grobo_robot_on_event()); callbacks may make requests, but
 * not call this.
 * @param for_us 0 or more; GROBO_ERR_ARG otherwise
 * @return 0, or GROBO_ERR_ARG
 */
GROBO_API int grobo_virtual_run(grobo_virtual *robot, int64_t for_us);

GROBO_END_DECLS

#endif
