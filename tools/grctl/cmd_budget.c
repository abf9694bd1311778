/* SPDX-License-Identifier: MIT */
/* What the wire allows: computed from the same costs that the bus plans with. */
#include <grobo/bus.h>
#include <grobo/driver.h>
#include <grobo/serial.h>

#include "app.h"
#include "commands.h"

enum { OPT_RATE };

static const cli_option options[] = {
    [OPT_RATE] = {.name = "rate",
                  .letter = 'r',
                  .kind = CLI_NUMBER,
                  .value = "HZ",
                  .help = "motion frames a second (50)",
                  .min = 0,
                  .max = 1000,
                  .real = true},
};

typedef struct cost {
    const char *name;
    int frame_bytes, reply_bytes;
    uint32_t total_us;
} cost;

enum { MOTION, READ_FULL, READ_POSITION, COSTS };

static void measure(const grobo_bus *bus, grobo_wiring wiring, const grobo_exchange *exchange,
                    cost *to)
{
    grobo_txn txn;
    grobo_bus_cost found = {0};
    if (grobo_txn_init(&txn, wiring, exchange->frame, exchange->frame_bytes) < 0)
        return;
    grobo_bus_cost_of(bus, &txn, &found);
    to->frame_bytes += exchange->frame_bytes;
    to->reply_bytes += (int)grobo_reply_bytes(&txn.reply);
    to->total_us += found.total_us;
}

/* Every joint to its initial angle; as many frames as the driver needs for that. */
static void measure_motion(const grobo_bus *bus, const grobo_driver *driver, cost *to)
{
    grobo_target target = {0};
    grobo_posture_init_pose(&target.posture, driver->model);
    for (int part = 0;; part++) {
        grobo_exchange exchange = {0};
        if (driver->posture(driver, NULL, &target, part, &exchange) != 1)
            return;
        measure(bus, driver->wiring, &exchange, to);
    }
}

static void measure_read(const grobo_bus *bus, const grobo_driver *driver, grobo_sense_kind kind,
                         cost *to)
{
    grobo_exchange exchange = {0};
    if (driver->sense(driver, NULL, 0, kind, &exchange) >= 0)
        measure(bus, driver->wiring, &exchange, to);
}

/* Reads of one kind that fit between two motion frames; between none, those of a second. */
static double reads_per_s(const cost *motion, const cost *read, double rate_hz)
{
    double period_us = 1e6 / (rate_hz > 0 ? rate_hz : 1);
    double left_us = rate_hz > 0 ? period_us - motion->total_us : period_us;
    if (left_us < 0)
        return 0;
    return (double)(long)(left_us / read->total_us) * (rate_hz > 0 ? rate_hz : 1);
}

static void print_text(const cost *costs, int baud_bps, double rate_hz, int n_joints)
{
    double largest_hz = 1e6 / costs[MOTION].total_us;
    printf("at %d bps                 to robot  from robot  wire time\n", baud_bps);
    for (int i = 0; i < COSTS; i++)
        printf("%-24s  %6d B    %6d B  %6.2f ms\n", costs[i].name, costs[i].frame_bytes,
               costs[i].reply_bytes, costs[i].total_us / 1e3);
    printf("motion frames alone       at most %.1f Hz\n", largest_hz);
    for (int i = READ_FULL; i < COSTS; i++)
        printf("%-24s  %.1f times a second when nothing moves, %.1f beside motion at %g Hz\n",
               i == READ_FULL ? "all joints, full" : "all joints, angle only",
               reads_per_s(&costs[MOTION], &costs[i], 0) / n_joints,
               reads_per_s(&costs[MOTION], &costs[i], rate_hz) / n_joints, rate_hz);
    if (rate_hz > largest_hz)
        printf("motion at %g Hz does not fit: frames would be left out\n", rate_hz);
}

static json_t *to_json(const cost *costs, int baud_bps, double rate_hz, int n_joints)
{
    json_t *list = json_array();
    for (int i = 0; i < COSTS; i++)
        json_array_append_new(list, json_pack("{s:s,s:i,s:i,s:I}", "name", costs[i].name,
                                              "to_robot_bytes", costs[i].frame_bytes,
                                              "from_robot_bytes", costs[i].reply_bytes, "wire_us",
                                              (json_int_t)costs[i].total_us));
    return json_pack(
        "{s:i,s:o,s:o,s:o,s:b,s:o,s:o}", "baud_bps", baud_bps, "rate_hz",
        app_json_number(rate_hz, 3), "costs", list, "motion_max_hz",
        app_json_number(1e6 / costs[MOTION].total_us, 2), "fits",
        rate_hz * costs[MOTION].total_us <= 1e6, "full_rounds_per_s",
        app_json_number(reads_per_s(&costs[MOTION], &costs[READ_FULL], rate_hz) / n_joints, 2),
        "angle_rounds_per_s",
        app_json_number(reads_per_s(&costs[MOTION], &costs[READ_POSITION], rate_hz) / n_joints, 2));
}

static int run(app *a)
{
    grobo_wiring wiring = (grobo_wiring)app_global(a, GLOBAL_WIRING)->choice;
    const grobo_driver *driver = grobo_gr001_driver(wiring);
    const cli_value *baud = app_global(a, GLOBAL_BAUD);
    int baud_bps = baud->given ? (int)baud->number : GROBO_BAUD_DEFAULT_BPS;
    double rate_hz = app_number(a, OPT_RATE, 50);
    grobo_bus_config config = {.wiring = wiring, .baud_bps = (uint32_t)baud_bps};
    grobo_bus bus;
    cost costs[COSTS] = {{.name = "motion, 20 joints"},
                         {.name = "one joint, full"},
                         {.name = "one joint, angle only"}};
    int error = grobo_bus_init(&bus, &config);
    if (error)
        return app_fail(a, EXIT_USAGE, grobo_error_name(error), "budget: %s",
                        grobo_error_text(error));
    measure_motion(&bus, driver, &costs[MOTION]);
    measure_read(&bus, driver, GROBO_SENSE_FULL, &costs[READ_FULL]);
    measure_read(&bus, driver, GROBO_SENSE_POSITION, &costs[READ_POSITION]);
    if (a->json)
        app_print_json(to_json(costs, baud_bps, rate_hz, driver->model->n_joints));
    else
        print_text(costs, baud_bps, rate_hz, driver->model->n_joints);
    return EXIT_DONE;
}

const cli_command cmd_budget = {
    .name = "budget",
    .arguments = "",
    .summary = "what the wire allows",
    .details =
        "Computes from the baud rate, the sizes of the frames and the way through the board\n"
        "how long a motion frame and a reading take, how many frames a second fit, and how\n"
        "often all joints can be read beside them. Touches no port.\n",
    .example = "  grctl budget --rate 20\n  grctl budget --wiring bus -b 460800\n",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .run = run,
};
