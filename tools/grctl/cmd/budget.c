/* SPDX-License-Identifier: MIT */
/* What the wire allows: computed from the same costs that the bus plans with. */
#include <grobo/core/serial.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/wire.h"

enum { OPT_RATE };

static const cli_option options[] = {
    [OPT_RATE] = OPTION_REAL("rate", 'r', "HZ", 0, 1000, "motion frames a second (as play has it)"),
};

/* Reads of one kind that fit between two motion frames; between none, those of a second. */
static double reads_per_s(const wire_cost *motion, const wire_cost *read, double rate_hz)
{
    double period_us = 1e6 / (rate_hz > 0 ? rate_hz : 1);
    double left_us = rate_hz > 0 ? period_us - motion->total_us : period_us;
    if (left_us < 0) {
        return 0;
    }
    return (double)(long)(left_us / read->total_us) * (rate_hz > 0 ? rate_hz : 1);
}

/* The register that sets how long servos wait before they reply, where a reply costs that; NULL. */
static const grobo_servo_register *delay_of(const grobo_driver *driver)
{
    const grobo_servo_register *reg = grobo_servo_register_of(
        family_servo(driver, grobo_model_joint(driver->model, 0)->motor), GROBO_ROLE_RETURN_DELAY);
    return driver->protocol->return_delay_us > 0 && reg && reg->min == 0 ? reg : NULL;
}

/* What every reply costs beside its bytes, and how to save it. */
static void print_delay(const grobo_driver *driver)
{
    const grobo_servo_register *reg = delay_of(driver);
    double delay_ms = driver->protocol->return_delay_us / 1e3;
    if (reg) {
        app_print("of each reply %.2f ms is a delay of the servo's, as it leaves the factory: "
                  "grctl servo-set ID %s 0 --flash\n",
                  delay_ms, reg->name);
    } else if (delay_ms > 0) {
        app_print("of each reply %.2f ms is a delay of the servo's\n", delay_ms);
    }
}

/* How often an arm is told more of its trajectories. */
static void print_pace(const grobo_driver *driver, const grobo_budget *line, int baud_bps)
{
    int rate_bps;
    if (driver->arm && line->pace_us > 0) {
        app_print("trajectories in segments  renewed every %.0f ms\n", line->pace_us / 1e3);
    } else if (wire_is_slow(driver, baud_bps, &rate_bps)) {
        app_print("%s\n", wire_slow_text(driver, baud_bps, rate_bps));
    }
}

static void print_text(const wire_cost *costs, const grobo_budget *line, int baud_bps,
                       double rate_hz, int n_joints)
{
    double largest_hz = 1e6 / costs[WIRE_MOTION].total_us;
    app_print("at %d bps                 to robot  from robot  wire time\n", baud_bps);
    for (int i = 0; i < WIRE_COSTS; i++) {
        app_print("%-24s  %6d B    %6d B  %6.2f ms\n", costs[i].name, costs[i].frame_bytes,
                  costs[i].reply_bytes, costs[i].total_us / 1e3);
    }
    app_print("motion frames alone       at most %.1f Hz\n", largest_hz);
    app_print("each joint read in %.0f s    at most %d Hz\n", GROBO_WATCH_US / 1e6,
              line->watched_hz);
    for (int i = WIRE_READ_FULL; i < WIRE_COSTS; i++) {
        app_print("%-24s  %.1f times a second when nothing moves, %.1f beside motion at %g Hz\n",
                  i == WIRE_READ_FULL ? "all joints, full" : "all joints, angle only",
                  reads_per_s(&costs[WIRE_MOTION], &costs[i], 0) / n_joints,
                  reads_per_s(&costs[WIRE_MOTION], &costs[i], rate_hz) / n_joints, rate_hz);
    }
    if (rate_hz > largest_hz) {
        app_print("motion at %g Hz does not fit: frames would be dropped\n", rate_hz);
    } else if (rate_hz > line->watched_hz) {
        app_print("motion at %g Hz is unwatched: joints would be read too seldom\n", rate_hz);
    }
}

static json_t *to_json(const wire_cost *costs, const grobo_budget *line, int baud_bps,
                       double rate_hz, int n_joints)
{
    json_t *list = json_array();
    for (int i = 0; i < WIRE_COSTS; i++) {
        json_array_append_new(list, json_pack("{s:s,s:i,s:i,s:I}", "name", costs[i].name,
                                              "to_robot_bytes", costs[i].frame_bytes,
                                              "from_robot_bytes", costs[i].reply_bytes, "wire_us",
                                              (json_int_t)costs[i].total_us));
    }
    return json_pack(
        "{s:i,s:o,s:o,s:o,s:i,s:b,s:o,s:o}", "baud_bps", baud_bps, "rate_hz",
        app_json_number(rate_hz, 3), "costs", list, "motion_max_hz",
        app_json_number(1e6 / costs[WIRE_MOTION].total_us, 2), "watched_max_hz", line->watched_hz,
        "fits", rate_hz * costs[WIRE_MOTION].total_us <= 1e6, "full_rounds_per_s",
        app_json_number(
            reads_per_s(&costs[WIRE_MOTION], &costs[WIRE_READ_FULL], rate_hz) / n_joints, 2),
        "angle_rounds_per_s",
        app_json_number(
            reads_per_s(&costs[WIRE_MOTION], &costs[WIRE_READ_ANGLE], rate_hz) / n_joints, 2));
}

static int run(app *a)
{
    const grobo_driver *driver = app_driver(a);
    int baud_bps = (int)conn_baud(a);
    grobo_budget line;
    wire_cost costs[WIRE_COSTS];
    int error = wire_measure(driver, baud_bps, costs);
    if (!error) {
        error = wire_budget(driver, baud_bps, &line);
    }
    if (error) {
        return app_fail_error(a, EXIT_USAGE, error, "budget");
    }
    double rate_hz = app_number(a, OPT_RATE, line.default_hz);
    if (a->json) {
        json_t *o = to_json(costs, &line, baud_bps, rate_hz, driver->model->n_joints);
        json_object_set_new(o, "return_delay_us",
                            json_integer((json_int_t)driver->protocol->return_delay_us));
        json_object_set_new(o, "pace_us", json_integer((json_int_t)line.pace_us));
        app_print_json(o);
    } else {
        print_text(costs, &line, baud_bps, rate_hz, driver->model->n_joints);
        print_pace(driver, &line, baud_bps);
        print_delay(driver);
    }
    return EXIT_DONE;
}

const cli_command cmd_budget = {
    .name = "budget",
    .lines = CLI_LINES_EACH,
    .arguments = "",
    .summary = "compute how many frames per second the line can carry",
    .details =
        "Computes from the baud rate, the sizes of the frames and the way through the board\n"
        "how long a motion frame and a reading take, how many frames a second fit, and how\n"
        "often all joints can be read beside them. Touches no port.\n",
    .example = "  grctl budget --rate 20\n  grctl budget --wiring bus -b 460800\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
