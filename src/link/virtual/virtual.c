/* SPDX-License-Identifier: MIT */
/*
 * An engine and a simulator, pumped by a clock that goes from one deadline to the next. In each
 * round the engine gets what the simulator has said by now, does what is due, and gives its next
 * frame, as static.h asks; a frame that the wire takes in part is given on before any other.
 */
#include <string.h>

#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/core/virtual.h>
#include <grobo/model.h>

#include "src/base/assert.h"
#include "src/base/memory.h"
#include "src/base/sized.h"
#include "src/sim/imu.h"
#include "src/sim/lines.h"
#include "src/sim/servo/servo.h"

/* A wire to simulated servos. */
typedef struct virtual_wire {
    grobo_sim *sim;
    int64_t replug_us; /* of a cable that is out; GROBO_NEVER_US: it is in */
    size_t n_rest;
    uint8_t rest[GROBO_FRAME_MAX_BYTES]; /* of a frame that the wire took in part */
} virtual_wire;

/* The simulator of a line behind the first one. */
typedef struct virtual_more {
    grobo_i_sim_line made;
    grobo_sim sim;
} virtual_more;

struct grobo_virtual {
    const grobo_mem *mem;
    size_t bytes;
    int64_t now_us;
    int n_lines;
    virtual_wire wire[GROBO_LINES_MAX];
    virtual_more *more[GROBO_LINES_MAX]; /* NULL: the first one, or not there */
    grobo_i_sim_line made;               /* of the first one, where there are several */
    grobo_robot robot;
    grobo_sim sim; /* the last member: grobo_i_sim_bytes() */
};

/* ---- a round -------------------------------------------------------------------------------- */

/* Bytes of a frame that go on the wire now. */
static void give(virtual_wire *wire, const uint8_t *frame, size_t size, int64_t now_us)
{
    size_t taken = grobo_sim_rx(wire->sim, frame, size, now_us);
    GROBO_ASSERT(taken <= size && size - taken <= sizeof wire->rest);
    wire->n_rest = size - taken;
    memmove(wire->rest, frame + taken, wire->n_rest);
}

static void cable_out(grobo_virtual *robot, int line)
{
    if (robot->n_lines > 1) {
        grobo_robot_line_down(&robot->robot, line, robot->now_us);
    } else {
        grobo_robot_link_down(&robot->robot, robot->now_us);
    }
}

static void cable_in(grobo_virtual *robot, int line)
{
    if (robot->n_lines > 1) {
        grobo_robot_line_up(&robot->robot, line, robot->now_us);
    } else {
        grobo_robot_link_up(&robot->robot, robot->now_us);
    }
}

static void watch_cable(grobo_virtual *robot, int line)
{
    virtual_wire *wire = &robot->wire[line];
    if (wire->replug_us == GROBO_NEVER_US && grobo_sim_hung_up(wire->sim)) {
        wire->replug_us = robot->now_us + GROBO_VIRTUAL_REPLUG_US;
        wire->n_rest = 0;
        cable_out(robot, line);
    } else if (robot->now_us >= wire->replug_us) {
        wire->replug_us = GROBO_NEVER_US;
        grobo_sim_plug(wire->sim, true, robot->now_us);
        cable_in(robot, line);
    }
}

static int64_t sooner(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* Does what is due; returns when the next round is. */
static int64_t turn(grobo_virtual *robot)
{
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    int64_t next_us = GROBO_NEVER_US;
    bool free = true;
    grobo_imu imu;
    if (grobo_i_sim_imu_at(robot->wire[0].sim, robot->now_us, &imu) == GROBO_OK) {
        (void)grobo_robot_set_imu(&robot->robot, &imu);
    }
    for (int i = robot->n_lines - 1; i >= 0; i--) {
        size_t got = grobo_sim_tx(robot->wire[i].sim, bytes, sizeof bytes, robot->now_us);
        if (i > 0) {
            grobo_robot_line_rx(&robot->robot, i, bytes, got, robot->now_us);
        } else {
            grobo_robot_rx_step(&robot->robot, bytes, got, robot->now_us);
        }
    }
    for (int i = 0; i < robot->n_lines; i++) {
        virtual_wire *wire = &robot->wire[i];
        give(wire, wire->rest, wire->n_rest, robot->now_us);
        int n = wire->n_rest > 0
                    ? 0
                    : grobo_robot_line_tx(&robot->robot, i, bytes, sizeof bytes, robot->now_us);
        if (n > 0) {
            give(wire, bytes, (size_t)n, robot->now_us);
        }
        watch_cable(robot, i);
        free = free && wire->n_rest == 0;
        next_us = sooner(next_us, grobo_sim_packet_deadline(wire->sim));
        next_us = sooner(next_us, wire->replug_us);
    }
    return free ? sooner(next_us, grobo_robot_deadline(&robot->robot, robot->now_us)) : next_us;
}

int grobo_virtual_run(grobo_virtual *robot, int64_t for_us)
{
    if (robot == NULL || for_us < 0 || for_us >= GROBO_NEVER_US - robot->now_us) {
        return GROBO_ERR_ARG;
    }
    int64_t end_us = robot->now_us + for_us;
    int64_t next_us = turn(robot);
    while (next_us <= end_us) {
        robot->now_us = next_us > robot->now_us ? next_us : robot->now_us;
        next_us = turn(robot);
    }
    robot->now_us = end_us;
    for (int i = 0; i < robot->n_lines; i++) {
        grobo_sim_step(robot->wire[i].sim, end_us);
    }
    return GROBO_OK;
}

/* ---- life ----------------------------------------------------------------------------------- */

static int64_t clock_us(void *ctx)
{
    const grobo_virtual *robot = ctx;
    return robot->now_us;
}

/* One line has two ends. */
static void complete(const grobo_driver *driver, grobo_robot_config *robot, grobo_sim_config *sim)
{
    sim->wiring = grobo_driver_wiring(driver);
    sim->echo = robot->bus.echo;
    sim->model = sim->model != NULL ? sim->model : driver->model;
    sim->baud_bps = sim->baud_bps != 0 ? sim->baud_bps : robot->bus.baud_bps;
    robot->bus.baud_bps = robot->bus.baud_bps != 0 ? robot->bus.baud_bps : sim->baud_bps;
}

static int start_line(grobo_virtual *robot, const grobo_lines *lines, int line,
                      const grobo_sim_config *whole)
{
    virtual_more *more = grobo_i_new(robot->mem, sizeof *more);
    if (more == NULL) {
        return GROBO_ERR_NOMEM;
    }
    robot->more[line] = more;
    grobo_i_sim_of_line(lines, line, whole, &more->made);
    robot->wire[line] = (virtual_wire){.sim = &more->sim, .replug_us = GROBO_NEVER_US};
    return grobo_sim_init_sized(&more->sim, sizeof more->sim, &more->made.config, 0);
}

static int start(grobo_virtual *robot, const grobo_driver *driver, void *driver_ctx,
                 const grobo_robot_config *config, const grobo_sim_config *whole)
{
    const grobo_sim_config *sim = whole;
    const grobo_lines *lines = grobo_driver_lines(driver);
    robot->n_lines = lines == NULL ? 1 : lines->n_lines;
    if (lines != NULL) {
        grobo_i_sim_of_line(lines, 0, sim, &robot->made);
        sim = &robot->made.config;
    }
    robot->wire[0] = (virtual_wire){.sim = &robot->sim, .replug_us = GROBO_NEVER_US};
    int result = grobo_sim_init_sized(&robot->sim, grobo_i_sim_bytes(sim->model), sim, 0);
    for (int i = 1; i < robot->n_lines && result >= 0; i++) {
        result = start_line(robot, lines, i, whole);
    }
    if (result >= 0) {
        result = grobo_robot_init(&robot->robot, driver, driver_ctx, config, 0);
    }
    if (result >= 0) {
        const grobo_robot_host host = {.clock = clock_us, .ctx = robot};
        grobo_robot_set_host(&robot->robot, &host);
        grobo_robot_link_up(&robot->robot, 0);
    }
    return result;
}

int grobo_virtual_new(const grobo_virtual_config *config, grobo_virtual **made)
{
    grobo_virtual_config taken;
    grobo_robot_config engine;
    grobo_sim_config sim;
    if (config == NULL || made == NULL || grobo_i_sized_take(&taken, sizeof taken, config) < 0 ||
        grobo_i_sized_take(&engine, sizeof engine, taken.robot) < 0 ||
        grobo_i_sized_take(&sim, sizeof sim, taken.sim) < 0) {
        return GROBO_ERR_ARG;
    }
    const grobo_driver *driver =
        taken.driver != NULL ? taken.driver : grobo_gr001_driver(GROBO_WIRING_BOARD);
    int result = grobo_driver_check(driver);
    if (result < 0) {
        return result;
    }
    complete(driver, &engine, &sim);
    size_t bytes = offsetof(grobo_virtual, sim) + grobo_i_sim_bytes(sim.model);
    grobo_virtual *robot = grobo_i_new(taken.mem, bytes);
    if (robot == NULL) {
        return GROBO_ERR_NOMEM;
    }
    robot->mem = taken.mem;
    robot->bytes = bytes;
    result = start(robot, driver, taken.driver_ctx, &engine, &sim);
    if (result < 0) {
        grobo_virtual_free(robot);
        return result;
    }
    *made = robot;
    return GROBO_OK;
}

void grobo_virtual_free(grobo_virtual *robot)
{
    if (robot != NULL) {
        for (int i = 0; i < GROBO_LINES_MAX; i++) {
            grobo_i_free(robot->mem, robot->more[i], sizeof *robot->more[i]);
        }
        grobo_i_free(robot->mem, robot, robot->bytes);
    }
}

grobo_robot *grobo_virtual_robot(grobo_virtual *robot)
{
    return robot != NULL ? &robot->robot : NULL;
}

grobo_sim *grobo_virtual_sim(grobo_virtual *robot)
{
    return robot != NULL ? &robot->sim : NULL;
}

grobo_sim *grobo_virtual_line_sim(grobo_virtual *robot, int line)
{
    return robot != NULL && line >= 0 && line < robot->n_lines ? robot->wire[line].sim : NULL;
}

int64_t grobo_virtual_now_us(const grobo_virtual *robot)
{
    return robot != NULL ? robot->now_us : GROBO_ERR_ARG;
}
