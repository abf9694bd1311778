/* SPDX-License-Identifier: MIT */
/**
 * @file core/lines.h
 * @brief A robot whose servos are on several lines: ports, rates and families of their own.
 *
 * grobo_joint.line says which line the servo of a joint is on. Ids are unique on a line, not in the
 * robot. Each line has a driver of its own, made from a model that holds its joints alone; a
 * driver of the whole robot is made from these, and an engine of that has one clock, one gate and
 * one stop:
 * @code
 *   grobo_lines_split(&lines, &model);
 *   grobo_feetech_driver_init(&lines.line[0].driver, &lines.line[0].model);
 *   grobo_dxl2_driver_init(&lines.line[1].driver, &lines.line[1].model);
 *   grobo_lines_driver_init(&driver, &lines, &model);
 *   grobo_robot_init(&robot, &driver, NULL, &config, now_us);
 * @endcode
 * The engine is pumped as static.h has it, with the bytes of each line: grobo_robot_line_rx(),
 * grobo_robot_line_tx(). A frame never has joints of two lines. What an engine of several lines
 * does not do yet: raw frames and motions kept in the robot (GROBO_ERR_UNSUPPORTED); joints are
 * read one by one on every line. A joint follows only one of its own line.
 *
 * There are no lines but one where GROBO_LINES_MAX is 1 (limits.h).
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_LINES_H
#define GROBO_CORE_LINES_H

#include <grobo/core/driver.h>
#include <grobo/core/static.h>

GROBO_BEGIN_DECLS

#if GROBO_LINES_MAX > 1

/** One line: what is on it, and its rate. */
typedef struct grobo_lines_line {
    grobo_model model;   /**< the joints of this line, in the robot's order; grobo_lines_split() */
    grobo_driver driver; /**< the caller's: of that model, GROBO_TABLE_INIT(grobo_driver) before */
    const char *name;    /**< what a session's device calls it; may be NULL, as `port` */
    const char *port;    /**< the device that it usually is */
    void *ctx;           /**< handed to its functions; may be NULL */
    uint32_t baud_bps;   /**< 0: as the engine's configuration has it */
    bool echo;           /**< the adapter returns what is sent */
} grobo_lines_line;

/** Several lines. Caller storage, borrowed by the driver that is made of it. */
typedef struct grobo_lines {
    grobo_lines_line line[GROBO_LINES_MAX];
    uint8_t n_lines;                      /**< 2..GROBO_LINES_MAX */
    uint8_t line_of[GROBO_JOINTS_MAX];    /**< the line of a joint of the robot, */
    uint8_t joint_on[GROBO_JOINTS_MAX];   /**< and which joint of that line's model it is */
    grobo_joint_mask on[GROBO_LINES_MAX]; /**< joints of the robot on each line */
    grobo_joint joints[GROBO_JOINTS_MAX]; /**< of the lines' models */
} grobo_lines;

/**
 * Makes the models of the lines from the robot's: `line[].model`, and who is where. Drivers,
 * contexts and rates are left as they are.
 * @param lines zeroed before
 * @param model borrowed: its names stay where they are
 * @return 0, or GROBO_ERR_ARG: a bad model, one line alone, a line without a joint, a joint that
 *         follows one of another line.
 */
GROBO_API int grobo_lines_split(grobo_lines *lines, const grobo_model *model);

/**
 * Fills a table for the robot on these lines, whose drivers are made. Limits are the narrowest of
 * the lines' (temperature, lost replies, approach; voltage and current where all lines have one);
 * exit policy hold, no arm where a line is none: change what is different in it afterwards.
 * @param[in,out] driver the caller's table, GROBO_TABLE_INIT(grobo_driver)
 * @param lines borrowed
 * @param model borrowed: that of grobo_lines_split()
 * @return 0, GROBO_ERR_ARG, or GROBO_ERR_UNSUPPORTED: a line whose driver switches no torque.
 */
GROBO_API int grobo_lines_driver_init(grobo_driver *driver, const grobo_lines *lines,
                                      const grobo_model *model);

/** The lines of a driver. @return NULL where it has one line. Thread safe. */
GROBO_API const grobo_lines *grobo_driver_lines(const grobo_driver *driver);

/** The servo of a line and an id, for grobo_robot_command(). With one line it is the id. */
#define GROBO_SERVO_ON(line, id) ((int)(line) << 8 | (int)(id))

/* ---- the pump of an engine ------------------------------------------------------------------ */

/** Lines of an engine: 1, or those of its driver. */
GROBO_API int grobo_robot_lines(const grobo_robot *robot);

/** grobo_robot_rx() of a line, 0..n-1; nothing of any other. */
GROBO_API void grobo_robot_line_rx(grobo_robot *robot, int line, const uint8_t *bytes, size_t size,
                                   int64_t now_us);

/** grobo_robot_tx() of a line. @return as that; GROBO_ERR_ARG where there is no such line. */
GROBO_API int grobo_robot_line_tx(grobo_robot *robot, int line, uint8_t *buf, size_t capacity,
                                  int64_t now_us);

/**
 * A line is gone while others are there: what its joints do is not known any more, and they count
 * as silent. What moves stops on the lines that are left, latched (GROBO_TRIP_LOST_REPLIES with
 * the first joint of that line, value 0). grobo_robot_link_down() where all are gone.
 */
GROBO_API void grobo_robot_line_down(grobo_robot *robot, int line, int64_t now_us);

/** It is there again: its joints are read before any of them moves. */
GROBO_API void grobo_robot_line_up(grobo_robot *robot, int line, int64_t now_us);

/** grobo_robot_registers() of a servo on a line; that one is of the first. */
GROBO_API int grobo_robot_line_registers(grobo_robot *robot, int line, const grobo_register_io *io);

/** Counters of a line. Borrowed, as grobo_robot_get_bus_stats(). @return NULL: no such line. */
GROBO_API const grobo_bus_stats *grobo_robot_line_stats(const grobo_robot *robot, int line);

/* ---- a session ------------------------------------------------------------------------------ */

struct grobo_session;

/**
 * The line of the bytes that grobo_session_config.on_tap is being told, 0..n-1; of a robot of one
 * line 0. Callable in it; outside of it the line of the last bytes.
 * @return GROBO_ERR_ARG: NULL.
 */
GROBO_API int grobo_session_tapped(const struct grobo_session *session);

#endif

GROBO_END_DECLS

#endif
