/* SPDX-License-Identifier: MIT */
/* doctor: from the port to the last servo, what is wrong and what mends it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/estop.h>

#include "tools/grctl/bringup/checkup.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/auto_ports.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/lang/lang.h"

enum { READ_BYTES = 30 /* the longest */, NAME_BYTES = 16, FIX_BYTES = 512 };
/* How often a servo is asked again whose reply came broken, and how many of those show two. */
enum { ASKED_AGAIN = 8, BROKEN_AGAIN = 2 };

/* A delay before replies that is worth a line. */
enum { DELAY_WORTH_US = 100 };

typedef struct patient {
    checkup k;
    conn c;
    const grobo_model *model;
    int answered; /* servos */
    int32_t low_mv, high_mv;
    int32_t over_mv, most_mv; /* at the servo that is furthest above what it is made for */
    int over_id;              /* which that is; 0 mV: none is */
    int hottest_c;
    int delay_us, delayed;             /* the longest delay before a reply; its servo */
    const grobo_servo_register *delay; /* which says so */
} patient;

static bool is_path(const char *device)
{
    return strcmp(device, GROBO_DEVICE_SIM) != 0 && strncmp(device, "tcp:", 4) != 0;
}

/* ---- the line -------------------------------------------------------------------------------- */

/* Opens the line and asks; what is said of it is in `said`. True: somebody answered. */
static bool ask(patient *p, char *said)
{
    app *a = p->k.a;
    a->hushed = said;
    bool ok =
        conn_open(&p->c, a) == EXIT_DONE &&
        servos_wait(&p->c, (int)conn_baud(a), READ_BYTES, SERVOS_PATIENT_US, 0, NULL) == GROBO_OK;
    if (!ok) {
        conn_close(&p->c, EXIT_DONE);
    }
    a->hushed = NULL;
    return ok;
}

static void set_baud(app *a, int baud_bps)
{
    a->line.global[GLOBAL_BAUD].given = 1;
    a->line.global[GLOBAL_BAUD].number = baud_bps;
}

/* Somebody who answers at another rate, or straight on the line: 0 nobody, else the rate. */
static int find_answer(patient *p, int asked_bps)
{
    app *a = p->k.a;
    const grobo_driver *driver = app_driver(a);
    const grobo_servo_table *table = family_servo(driver, -1)->table;
    char said[APP_LINE_BYTES];
    progress bar;
    progress_start(&bar, a);
    for (int i = 0; i < table->rate_count && !p->c.signal; i++) {
        int baud_bps = table->rates[i].bps;
        if (baud_bps == asked_bps) {
            continue;
        }
        set_baud(a, baud_bps);
        snprintf(said, sizeof said, _("no reply at %d bps; asking at %d"), asked_bps, baud_bps);
        progress_draw(&bar, (double)i / table->rate_count, said);
        bool found = ask(p, said);
        progress_clear(&bar);
        if (found) {
            return baud_bps;
        }
    }
    set_baud(a, asked_bps);
    a->line.global[GLOBAL_WIRING].choice = !a->line.global[GLOBAL_WIRING].choice;
    return app_driver(a) != driver && ask(p, said) ? asked_bps : 0;
}

/* ---- an echo --------------------------------------------------------------------------------- */

static bool may_echo(const app *a)
{
    return app_global(a, GLOBAL_WIRING)->choice == GROBO_WIRING_BUS &&
           !app_global(a, GLOBAL_ECHO)->given;
}

static void found_echo(patient *p, const char *device)
{
    char fix[FIX_BYTES + GROBO_DEVICE_MAX_BYTES];
    snprintf(fix, sizeof fix, "grctl -d %s --wiring bus --echo ...", device);
    checkup_found(&p->k, "echo", fix, "the adapter returns what is sent to it");
}

static void check_echo(patient *p, const char *device)
{
    if (may_echo(p->k.a) && wire_echoes(grobo_robot_get_bus_stats(p->c.robot))) {
        found_echo(p, device);
    }
}

/* Of a family without sums no reply is found behind an echo that is not reckoned with. */
static bool answers_behind_echo(patient *p, const char *device)
{
    app *a = p->k.a;
    char said[APP_LINE_BYTES];
    if (!may_echo(a)) {
        return false;
    }
    a->line.global[GLOBAL_ECHO].given = 1;
    bool found = ask(p, said);
    if (found) {
        found_echo(p, device);
    } else {
        a->line.global[GLOBAL_ECHO].given = 0;
    }
    return found;
}

static bool check_reply(patient *p, const char *device)
{
    app *a = p->k.a;
    char said[APP_LINE_BYTES] = "", fix[FIX_BYTES];
    int asked_bps = (int)conn_baud(a);
    int wiring = app_global(a, GLOBAL_WIRING)->choice;
    if (ask(p, said)) {
        checkup_found(&p->k, "reply", NULL, "the %s answers at %d bps",
                      wiring == GROBO_WIRING_BOARD ? _("board") : _("robot"), asked_bps);
        return true;
    }
    if (p->c.signal) {
        return false;
    }
    if (!strstr(said, _("no robot answers"))) {
        if (answers_behind_echo(p, device)) {
            return true;
        }
        checkup_found(&p->k, "reply",
                      strncmp(device, "tcp:", 4) == 0 ? "start a serial server there (ser2net), or "
                                                        "correct the address: -d tcp:HOST:PORT"
                                                      : "switch the robot on, push its cables in",
                      "%s", said);
        return false;
    }
    int found_bps = find_answer(p, asked_bps);
    if (found_bps == 0) {
        checkup_found(&p->k, "reply", "switch the robot on, push its cables in", "%s", said);
        return false;
    }
    if (found_bps != asked_bps) {
        snprintf(fix, sizeof fix, "grctl -d %s -b %d ...", device, found_bps);
    } else {
        snprintf(fix, sizeof fix, "grctl -d %s --wiring %s ...", device,
                 wiring == GROBO_WIRING_BOARD ? "bus" : "board");
    }
    checkup_found(&p->k, "reply", fix,
                  "no reply at the rate asked for, but there is one at %d bps%s", found_bps,
                  found_bps != asked_bps         ? ""
                  : wiring == GROBO_WIRING_BOARD ? _(", straight on the line")
                                                 : _(", through a board"));
    return true;
}

/* ---- the servos ------------------------------------------------------------------------------ */

/* Asking again may hide that two talk at once. */
static uint64_t broken_replies(const patient *p)
{
    return grobo_robot_get_bus_stats(p->c.robot)->bad_sums;
}

/* Two servos that answer at once break each other's replies, again and again; noise breaks one. */
static bool break_each_other(patient *p, int id)
{
    const grobo_servo_register *reg =
        grobo_servo_register_of(family_servo(grobo_robot_driver(p->c.robot), id), GROBO_ROLE_MODEL);
    uint8_t bytes[4];
    int n = 0;
    for (int i = 0; i < ASKED_AGAIN && reg && !p->c.signal && !p->c.link_error; i++) {
        uint64_t broken = broken_replies(p);
        int error = servos_read(&p->c, id, reg->address, reg->bytes, bytes);
        n += broken_replies(p) > broken || (error && error != GROBO_ERR_TIMEOUT);
    }
    return n >= BROKEN_AGAIN;
}

/* A servo that answers, but is set up for another joint, or as it left its factory. */
static void say_setup(patient *p, const char *name, int joint)
{
    const char *who = grobo_model_joint(p->model, joint)->name;
    conn_setup why;
    if (conn_setup_of(&p->c, joint, &why)) {
        checkup_found(&p->k, name, why.fix, "%s: %s", who, why.fact);
    } else {
        checkup_found(&p->k, name, "compare its registers with the robot's file: servo-get",
                      "%s: %s", who, app_error_text(GROBO_ERR_SETUP));
    }
}

static void say_silent(patient *p, const char *name, int joint, int error)
{
    const grobo_joint *j = grobo_model_joint(p->model, joint);
    char fix[FIX_BYTES], servo[JOINTS_SERVO_BYTES];
    if (error == GROBO_ERR_TIMEOUT || error == GROBO_ERR_SHORT) {
        snprintf(fix, sizeof fix, _("push its cable in; has it another id? grctl%s scan"),
                 app_global(p->k.a, GLOBAL_WIRING)->choice ? " --wiring bus" : "");
        checkup_found(&p->k, name, fix, "%s does not answer", j->name);
    } else if (conn_is_of_reply(error) && break_each_other(p, j->motor)) {
        snprintf(fix, sizeof fix,
                 _("unplug all servos but one of id %d, and: grctl servo-set %s id NEW --flash"),
                 j->motor, joints_servo(p->k.a, joint, "", servo));
        checkup_found(&p->k, name, fix, "%s answers, but: %s; two servos with id %d?", j->name,
                      app_error_text(error), j->motor);
    } else {
        checkup_found(&p->k, name, "look at its cable and plugs, and run doctor again",
                      "%s: a reply came broken: %s", j->name, app_error_text(error));
    }
}

/* True when something is wrong with what it reports. */
static bool check_state(patient *p, const char *name, int joint, const grobo_joint_state *s)
{
    const grobo_driver *driver = grobo_robot_driver(p->c.robot);
    const grobo_joint *j = grobo_model_joint(p->model, joint);
    bool rs30x = family_is(driver, "rs30x");
    char fix[FIX_BYTES], motor[JOINTS_SERVO_BYTES], servo[JOINTS_SERVO_BYTES];
    joints_servo(p->k.a, joint, "m", motor);
    joints_servo(p->k.a, joint, "", servo);
    snprintf(fix, sizeof fix, _("let it cool down: grctl servo off %s"), motor);
    if (s->overheated) { /* it says so until it is told, however cold it is */
        snprintf(
            fix, sizeof fix,
            _("let it cool down, then: grctl servo off %s; if it is reported again, switch the "
              "power off and on"),
            motor);
        checkup_found(&p->k, name, fix, "%s has cut its torque for heat (%d C)", j->name,
                      s->temperature_c);
    } else if ((rs30x && (s->flags & GROBO_RS30X_STATUS_HOT)) ||
               s->temperature_c > driver->limits.temperature_c) {
        checkup_found(&p->k, name, fix, "%s is hot: %d C, at most %d are good for it", j->name,
                      s->temperature_c, driver->limits.temperature_c);
    } else if (rs30x && (s->flags & GROBO_RS30X_STATUS_FLASH_ERROR)) {
        snprintf(fix, sizeof fix, _("write its settings again: grctl servo-set %s id %d --flash"),
                 servo, j->motor);
        checkup_found(&p->k, name, fix, "%s lost power while it wrote its flash", j->name);
    } else if (!rs30x && s->flags) {
        const grobo_servo_register *error =
            grobo_servo_register_of(family_servo(driver, j->motor), GROBO_ROLE_ERROR);
        snprintf(fix, sizeof fix, _("see what: grctl servo-get %s%s%s"), servo, error ? " " : "",
                 error ? error->name : "");
        checkup_found(&p->k, name, fix, "%s reports errors (%02Xh)", j->name, s->flags);
    } else {
        return false;
    }
    return true;
}

static void keep_extremes(patient *p, const grobo_joint_state *s)
{
    bool volts = (s->valid & GROBO_FIELD_VOLTAGE) != 0;
    if (volts && (p->low_mv == 0 || s->voltage_mv < p->low_mv)) {
        p->low_mv = s->voltage_mv;
    }
    if (volts && s->voltage_mv > p->high_mv) {
        p->high_mv = s->voltage_mv;
    }
    if (p->answered == 0 || s->temperature_c > p->hottest_c) { /* below zero in the cold */
        p->hottest_c = s->temperature_c;
    }
    p->answered++;
}

/* type NULL: a servo that is not known. */
static void check_model(patient *p, const char *name, int joint, const grobo_servo_model *type,
                        const grobo_joint_state *s)
{
    const grobo_joint *j = grobo_model_joint(p->model, joint);
    const grobo_driver *driver = grobo_robot_driver(p->c.robot);
    const grobo_servo_model *expected = family_numbered(driver, j->servo_model);
    if (j->servo_model && (!type || type->number != j->servo_model)) {
        checkup_found(&p->k, name, "put the right servo there; its speed and torque are others",
                      "%s is %s, not %s", j->name, type ? type->name : _("of an unknown model"),
                      expected ? expected->name : _("that"));
    } else {
        char volts[24] = "";
        if (s->valid & GROBO_FIELD_VOLTAGE) {
            snprintf(volts, sizeof volts, ", %.2f V", s->voltage_mv / 1e3);
        }
        checkup_found(&p->k, name, "", "%s: %s, %d C%s", j->name, type ? type->name : _("a servo"),
                      s->temperature_c, volts);
    }
}

/* Where the servo keeps a delay before its replies: each reading costs that. */
static void look_at_delay(patient *p, int id, const grobo_servo_model *servo)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servo, GROBO_ROLE_RETURN_DELAY);
    int32_t counts = 0;
    if (!reg || reg->min > 0 || servos_get(&p->c, id, servo, reg, &counts)) {
        return;
    }
    int delay_us = (int)(counts * strtod(reg->unit, NULL));
    if (delay_us > p->delay_us) {
        p->delay_us = delay_us;
        p->delayed = id;
        p->delay = reg;
    }
}

/* The maker sets it for the supply that this variant of a model is made for. */
static void look_at_supply(patient *p, int id, const grobo_servo_model *servo, int32_t mv)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servo, GROBO_ROLE_MAX_VOLTAGE);
    int32_t counts = 0;
    if (!reg || mv <= p->over_mv || servos_get(&p->c, id, servo, reg, &counts)) {
        return;
    }
    int32_t most_mv = (int32_t)lround(counts * strtod(reg->unit, NULL) * 1000);
    if (most_mv > 0 && mv > most_mv) {
        p->over_mv = mv;
        p->most_mv = most_mv;
        p->over_id = id;
    }
}

static void check_servo(patient *p, int joint)
{
    const grobo_joint *j = grobo_model_joint(p->model, joint);
    const grobo_driver *driver = grobo_robot_driver(p->c.robot);
    const grobo_servo_model *servo = family_servo(driver, j->motor);
    const grobo_servo_register *reg = grobo_servo_register_of(servo, GROBO_ROLE_MODEL);
    uint8_t bytes[4];
    char name[NAME_BYTES];
    grobo_joint_info i = {0};
    uint64_t broken = broken_replies(p);
    int error = reg ? servos_read(&p->c, j->motor, reg->address, reg->bytes, bytes) : GROBO_OK;
    snprintf(name, sizeof name, "servo_%d", j->motor);
    if (!error) {
        error = conn_sense(&p->c, GROBO_JOINT_BIT(joint), GROBO_SENSE_FULL);
    }
    if (p->c.signal || p->c.link_error) {
        return;
    }
    if (!error) {
        error = grobo_robot_joint(p->c.robot, joint, &i);
    }
    broken = broken_replies(p) - broken;
    if (error == GROBO_ERR_SETUP && grobo_robot_joint(p->c.robot, joint, &i) == GROBO_OK) {
        keep_extremes(p, &i.state);
        say_setup(p, name, joint);
        return;
    }
    if (error || broken) {
        say_silent(p, name, joint, broken && !error ? GROBO_ERR_CHECKSUM : error);
        return;
    }
    keep_extremes(p, &i.state);
    look_at_supply(p, j->motor, servo,
                   (i.state.valid & GROBO_FIELD_VOLTAGE) ? i.state.voltage_mv : 0);
    if (check_state(p, name, joint, &i.state)) {
        return;
    }
    check_model(p, name, joint, reg ? family_identify(driver, bytes) : servo, &i.state);
    look_at_delay(p, j->motor, servo);
}

static void check_servos(patient *p)
{
    p->model = conn_model(&p->c);
    for (int joint = 0; joint < p->model->n_joints && !p->c.signal && !p->c.link_error; joint++) {
        check_servo(p, joint);
    }
    if (p->c.signal || p->c.link_error || p->answered == 0) {
        return;
    }
    int32_t least_mv = grobo_robot_driver(p->c.robot)->limits.voltage_mv * 11 / 10;
    if (p->high_mv == 0) {
        checkup_found(&p->k, "voltage", "", "these servos do not report their voltage");
    } else if (p->over_mv > 0) {
        checkup_found(&p->k, "voltage", "switch it off: is this the supply of another variant?",
                      "%.2f V at the servos: servo %d is made for %.1f V at most", p->high_mv / 1e3,
                      p->over_id, p->most_mv / 1e3);
    } else if (p->low_mv < least_mv) {
        checkup_found(&p->k, "voltage", "charge the battery",
                      "%.2f V at the servos: low; at %.1f V every motion is stopped",
                      p->low_mv / 1e3, grobo_robot_driver(p->c.robot)->limits.voltage_mv / 1e3);
    } else if (p->low_mv == p->high_mv) {
        checkup_found(&p->k, "voltage", NULL, "%.2f V at the servos", p->low_mv / 1e3);
    } else {
        checkup_found(&p->k, "voltage", NULL, "%.2f to %.2f V at the servos", p->low_mv / 1e3,
                      p->high_mv / 1e3);
    }
    if (p->delay_us >= DELAY_WORTH_US) {
        char servo[JOINTS_SERVO_BYTES];
        checkup_found(&p->k, "delay", NULL,
                      "each reply waits up to %d us (servo %d); it need not: grctl servo-set %s %s "
                      "0 --flash",
                      p->delay_us, p->delayed, joints_servo_of(p->k.a, p->delayed, "", servo),
                      p->delay->name);
    }
    if (p->answered == p->model->n_joints) {
        checkup_found(&p->k, "servos", NULL, "all %d answer; the warmest has %d C", p->answered,
                      p->hottest_c);
    }
}

/* ---- the whole of it ------------------------------------------------------------------------- */

static void check_latch(checkup *k, const char *device)
{
    char fix[FIX_BYTES + GROBO_DEVICE_MAX_BYTES];
    snprintf(fix, sizeof fix, "grctl -d %s estop --reset", device);
    if (grobo_estop_stands(device)) {
        checkup_found(k, "estop", fix, "an emergency stop stands: nothing will move");
    }
}

/* The first adapter that `auto` would try; one that is blocked is looked at where there is none. */
static bool choose_adapter(checkup *k, char *device)
{
    static choice all;
    char fix[FIX_BYTES + GROBO_DEVICE_MAX_BYTES];
    if (auto_ports(&all) < 0) {
        choose_begin(&all);
    }
    for (int i = 0; i < all.n_blocked && all.n_usb > 0; i++) {
        choose_fix(&all.blocked[i], fix, sizeof fix);
        checkup_found(k, "port", fix, "%s: %s", all.blocked[i].path,
                      app_error_text(all.blocked[i].open_result));
    }
    if (all.n_usb + all.n_blocked > 0) {
        snprintf(device, GROBO_DEVICE_MAX_BYTES, "%s",
                 all.n_usb ? all.usb[0].path : all.blocked[0].path);
        return true;
    }
    snprintf(fix, sizeof fix,
             _("plug the robot's cable in, or name its port: -d DEV; 'grctl ports' lists them"));
    if (all.n_uart > 0) {
        snprintf(fix, sizeof fix,
                 _("plug the robot's cable in, or where it is wired to this machine: -d %s"),
                 all.uart[0].path);
    }
    checkup_found(k, "device", fix, "no USB serial adapter is here");
    return false;
}

/* The device to look at: auto is the first USB adapter. False: there is none. */
static bool choose_device(checkup *k, char *device)
{
    app *a = k->a;
    cli_value *asked = &a->line.global[GLOBAL_DEVICE];
    const char *fallback = getenv("GRCTL_DEVICE");
    const char *name = asked->given ? asked->text : fallback && *fallback ? fallback : "auto";
    if (strcmp(name, GROBO_DEVICE_AUTO) != 0) {
        snprintf(device, GROBO_DEVICE_MAX_BYTES, "%s", name);
    } else if (!choose_adapter(k, device)) {
        return false;
    }
    asked->given = 1;
    asked->text = device;
    return true;
}

static int run(app *a)
{
    static char device[GROBO_DEVICE_MAX_BYTES];
    static patient p;
    int signal = 0;
    memset(&p, 0, sizeof p);
    if (a->portless) {
        return app_fail(a, EXIT_USAGE, "ARG", "nothing says which port line %s has: -d %s=PORT",
                        a->portless, a->portless);
    }
    checkup_start(&p.k, a);
    if (choose_device(&p.k, device) && (!is_path(device) || checkup_port(&p.k, device))) {
        check_latch(&p.k, device);
        if (check_reply(&p, device)) {
            check_servos(&p);
            if (!p.c.signal && !p.c.link_error) {
                check_echo(&p, device);
            }
            if (p.c.link_error) {
                checkup_found(&p.k, "link", "push the cable in at both ends",
                              "%s was lost on the way", device);
            }
            conn_close(&p.c, EXIT_DONE);
        }
        signal = p.c.signal;
    }
    if (signal) {
        json_decref(p.k.checks);
        return EXIT_SIGNAL + signal;
    }
    return checkup_end(&p.k);
}

const cli_command cmd_doctor = {
    .name = "doctor",
    .lines = CLI_LINES_EACH,
    .arguments = "",
    .summary = "find faults from the port to the last servo, suggest fixes",
    .details =
        "Checks the port (does it exist, may you open it, which program holds it, is its latency\n"
        "timer short), asks for a reply (without one also at other baud rates and wirings), then\n"
        "asks every servo for its model, voltage, temperature and flags. Each problem is printed\n"
        "with its fix, and makes the exit status 1. Nothing moves. -v shows the servos without a\n"
        "problem too.\n",
    .example = "  grctl doctor\n  grctl -d /dev/ttyUSB0 doctor -v\n",
    .group = CLI_GROUP_EACH,
    .run = run,
};
