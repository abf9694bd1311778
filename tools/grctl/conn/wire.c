/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/lang/lang.h"

static void measure(const grobo_bus *bus, const grobo_exchange *exchange, wire_cost *to)
{
    grobo_txn txn;
    grobo_bus_cost found = {0};
    if (grobo_txn_init(&txn, bus->config.protocol, exchange->frame, exchange->frame_bytes) < 0) {
        return;
    }
    grobo_bus_cost_of(bus, &txn, &found);
    to->frame_bytes += exchange->frame_bytes;
    to->reply_bytes += (int)txn.reply.bytes;
    to->total_us += found.total_us;
}

/* Every joint to its initial angle; as many frames as the driver needs for that. */
static void measure_motion(const grobo_bus *bus, const grobo_driver *driver, wire_cost *to)
{
    grobo_target target = {0};
    grobo_posture_init_pose(&target.posture, driver->model);
    for (int part = 0;; part++) {
        grobo_exchange exchange = {0};
        if (driver->posture(driver, NULL, &target, part, &exchange) != 1) {
            return;
        }
        measure(bus, &exchange, to);
    }
}

/* All that one reading of a joint asks for. */
static void measure_read(const grobo_bus *bus, const grobo_driver *driver, grobo_sense_kind kind,
                         wire_cost *to)
{
    grobo_exchange exchange = {0};
    int more = driver->sense(driver, NULL, 0, kind, &exchange);
    if (more < 0) {
        return;
    }
    measure(bus, &exchange, to);
    for (int part = 1; driver->sense_more; part++) {
        exchange = (grobo_exchange){0};
        if (driver->sense_more(driver, NULL, 0, kind, part, &exchange) <= 0) {
            return;
        }
        measure(bus, &exchange, to);
    }
}

static int make_bus(const grobo_driver *driver, int baud_bps, grobo_bus *bus)
{
    grobo_bus_config config = {.protocol = driver->protocol, .baud_bps = (uint32_t)baud_bps};
    return grobo_bus_init(bus, &config);
}

int wire_budget(const grobo_driver *driver, int baud_bps, grobo_budget *budget)
{
    grobo_bus_config line = {.baud_bps = (uint32_t)baud_bps};
    return grobo_budget_init(budget, driver, NULL, &line);
}

/* Whether all of a driver's servos have that rate. */
static bool have_rate(const grobo_driver *driver, int baud_bps)
{
    for (int j = 0; j < driver->model->n_joints; j++) {
        const grobo_servo_model *servo =
            family_servo(driver, grobo_model_joint(driver->model, j)->motor);
        if (!servo || !grobo_servo_register_of(servo, GROBO_ROLE_BAUD) ||
            grobo_servo_baud_code(servo, baud_bps) < 0) {
            return false;
        }
    }
    return true;
}

static bool is_slow(const grobo_driver *driver, int baud_bps)
{
    grobo_budget budget;
    return driver->arm && wire_budget(driver, baud_bps, &budget) >= 0 && budget.pace_us == 0;
}

bool wire_is_slow(const grobo_driver *driver, int baud_bps, int *rate_bps)
{
    static const int rates_bps[] = {115200,  500000,  625000,  1000000,
                                    1250000, 2000000, 3000000, 4000000};
    *rate_bps = 0;
    if (!is_slow(driver, baud_bps)) {
        return false;
    }
    for (size_t i = 0; i < sizeof rates_bps / sizeof rates_bps[0] && *rate_bps == 0; i++) {
        bool enough = rates_bps[i] > baud_bps && have_rate(driver, rates_bps[i]) &&
                      !is_slow(driver, rates_bps[i]);
        *rate_bps = enough ? rates_bps[i] : 0;
    }
    return true;
}

const char *wire_slow_text(const grobo_driver *driver, int baud_bps, int rate_bps)
{
    static char text[APP_LINE_BYTES];
    int n = driver->model->n_joints;
    if (rate_bps > 0) {
        snprintf(text, sizeof text,
                 _("%d bps are too slow to move and read %d joints in time; raise the baud rate: "
                   "grctl servo-set ID baud %d --flash"),
                 baud_bps, n, rate_bps);
    } else {
        snprintf(text, sizeof text,
                 _("%d bps are too slow to move and read %d joints in time, and the servos have no "
                   "faster rate; move fewer joints at a time"),
                 baud_bps, n);
    }
    return text;
}

int wire_read_us(const grobo_driver *driver, int baud_bps, int length, uint32_t *time_us)
{
    grobo_register_io io = {.id = 1, .length = (uint16_t)length};
    grobo_exchange exchange = {0};
    wire_cost cost = {0};
    grobo_bus bus;
    int error = make_bus(driver, baud_bps, &bus);
    if (!error && driver->registers(driver, NULL, &io, &exchange) < 0) {
        /* One of those that are read in pieces as they are: the whole joint takes longest. */
        error = driver->sense(driver, NULL, 0, GROBO_SENSE_FULL, &exchange);
    }
    if (error < 0) {
        return error;
    }
    measure(&bus, &exchange, &cost);
    *time_us = cost.total_us;
    return GROBO_OK;
}

double wire_taught_hz(const grobo_driver *driver, int baud_bps, int n)
{
    wire_cost taught = {0}, other = {0};
    grobo_bus bus;
    if (make_bus(driver, baud_bps, &bus) < 0) {
        return 0;
    }
    measure_read(&bus, driver, GROBO_SENSE_ALL, &taught);
    measure_read(&bus, driver, GROBO_SENSE_FULL, &other);
    double left_us =
        1e6 - (double)(driver->model->n_joints - n) * other.total_us; /* each in a second */
    return fmax(left_us / taught.total_us, 1e6 / (taught.total_us + other.total_us)) / n;
}

int wire_measure(const grobo_driver *driver, int baud_bps, wire_cost *costs)
{
    grobo_bus bus;
    int error = make_bus(driver, baud_bps, &bus);
    if (error) {
        return error;
    }
    costs[WIRE_MOTION] = (wire_cost){.name = ""};
    snprintf(costs[WIRE_MOTION].name, sizeof costs[WIRE_MOTION].name, "motion, %d joint%s",
             driver->model->n_joints, driver->model->n_joints == 1 ? "" : "s");
    costs[WIRE_READ_FULL] = (wire_cost){.name = "one joint, full"};
    costs[WIRE_READ_ANGLE] = (wire_cost){.name = "one joint, angle only"};
    measure_motion(&bus, driver, &costs[WIRE_MOTION]);
    measure_read(&bus, driver, GROBO_SENSE_FULL, &costs[WIRE_READ_FULL]);
    measure_read(&bus, driver, GROBO_SENSE_POSITION, &costs[WIRE_READ_ANGLE]);
    return GROBO_OK;
}

bool wire_echoes(const grobo_bus_stats *n)
{
    enum { REQUEST_BYTES = 6 }; /* none is shorter, but of ICS */
    return n->replies > 0 && n->resync_bytes + n->late_bytes >= n->replies * REQUEST_BYTES / 2;
}
