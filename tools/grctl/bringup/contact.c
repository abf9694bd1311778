/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/version.h>

#include "tools/grctl/bringup/ask.h"
#include "tools/grctl/bringup/contact.h"
#include "tools/grctl/bringup/contact_compare.h"
#include "tools/grctl/bringup/contact_rate.h"
#include "tools/grctl/bringup/scan.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/lang/lang.h"

enum { READS = 50, LOOKS = 5, LOOK_US = 100000, MOVE_US = 1000000, BLOCK_BYTES = 30 };

#define STEP_DEG 2.0
#define NEAR_DEG 1.0 /* of the gears' play and the servo's dead band */

/* ---- the report ------------------------------------------------------------------------------ */

static int save(contact *k, const char *end, const char *text, size_t size)
{
    char path[CONTACT_PATH_BYTES + 8];
    snprintf(path, sizeof path, "%s%s", k->prefix, end);
    int error = file_save(path, text, size);
    return error ? app_fail(k->a, EXIT_FILE, grobo_error_name(error), "%s: %s", path,
                            file_write_error_text(error))
                 : 0;
}

static int write_report(contact *k)
{
    json_t *all = json_pack("{s:s,s:s,s:s,s:s,s:i,s:i,s:O,s:O}", "version", GROBO_VERSION_STRING,
                            "robot", robot_of(k->a)->name, "family", robot_of(k->a)->family->name,
                            "wiring", app_driver(k->a)->protocol->relay ? "board" : "bus",
                            "baud_bps", (int)conn_baud(k->a), "not_as_assumed", k->n_bad, "steps",
                            k->steps, "servos", k->servos);
    if (all && k->other) {
        json_object_set_new(all, "differs", contact_compare(k, k->other));
    }
    char *text = all ? json_dumps(all, JSON_INDENT(1) | JSON_REAL_PRECISION(12)) : NULL;
    int status = text ? save(k, ".json", text, strlen(text))
                      : app_fail_error(k->a, EXIT_ROBOT, GROBO_ERR_NOMEM, "first-contact");
    if (!status) {
        status = save(k, ".txt", k->text.bytes, k->text.size);
    }
    if (!status && k->a->json) {
        app_print_json(json_incref(all));
    }
    if (!status) {
        app_note(k->a, "report: %s.txt and .json, traces: %s-*.pcapng; please send them to us",
                 k->prefix, k->prefix);
    }
    free(text);
    json_decref(all);
    return status;
}

/* ---- reading --------------------------------------------------------------------------------- */

static json_t *read_registers(contact *k, int id, const grobo_servo_model *servo, int *n_read)
{
    json_t *all = json_object();
    const grobo_driver *driver = grobo_robot_driver(k->c.robot);
    const grobo_servo_register *first, *reg;
    int n;
    for (size_t i = 0; (first = grobo_servo_register_row(servo, i)) != NULL; i += (size_t)n) {
        uint8_t bytes[FAMILY_PIECE_BYTES] = {0};
        n = family_block(driver, servo, i, BLOCK_BYTES);
        reg = grobo_servo_register_row(servo, i + (size_t)(n ? n - 1 : 0));
        int length = reg->address + reg->bytes - first->address;
        int error = n ? servos_read(&k->c, id, first->address, length, bytes) : GROBO_OK;
        for (int r = 0; r < n && !error; r++) {
            reg = grobo_servo_register_row(servo, i + (size_t)r);
            json_object_set_new(all, reg->name,
                                json_integer(grobo_servo_register_get(
                                    servo, reg, bytes + (reg->address - first->address))));
            *n_read += 1;
        }
        n = n ? n : 1;
    }
    return all;
}

static void read_servos(contact *k)
{
    const grobo_driver *driver = grobo_robot_driver(k->c.robot);
    const grobo_model *model = driver->model;
    uint16_t address;
    int n_there = 0, n_other = 0, n_registers = 0;
    for (int j = 0; j < model->n_joints && !k->c.signal && !k->c.link_error; j++) {
        uint8_t bytes[FAMILY_PIECE_BYTES];
        int id = grobo_model_joint(model, j)->motor;
        const grobo_servo_model *servo = family_servo(driver, id);
        int length = family_identity(driver, servo, &address);
        int error = servos_read(&k->c, id, address, length, bytes);
        json_t *one = json_pack("{s:i,s:s}", "id", id, "joint", grobo_model_joint(model, j)->name);
        if (error) {
            json_object_set_new(one, "status", app_json_code(grobo_error_name(error)));
        } else {
            const scan_identity is = scan_identity_of(driver, bytes);
            bool tells = grobo_servo_register_of(servo, GROBO_ROLE_MODEL) != NULL;
            n_there++;
            n_other += tells && (!is.servo || is.servo->number != servo->number);
            json_object_set_new(one, "model", json_string(is.model));
            json_object_set_new(one, "firmware", json_integer(is.firmware));
            json_object_set_new(one, "registers", read_registers(k, id, servo, &n_registers));
        }
        json_array_append_new(k->servos, one);
    }
    contact_note(k, "ping", n_there == model->n_joints ? AS_ASSUMED : NOT_AS_ASSUMED,
                 "%d of %d servos answer", n_there, model->n_joints);
    contact_note(k, "models", n_other == 0 ? AS_ASSUMED : NOT_AS_ASSUMED,
                 "%d servos are of another model than in the robot's file", n_other);
    contact_note(k, "registers", n_registers > 0 ? AS_ASSUMED : NOT_AS_ASSUMED,
                 "%d values were read", n_registers);
}

static int by_size(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* Round trips of one request, from when it was given out until its reply was whole. */
static void measure_times(contact *k)
{
    const grobo_driver *driver = grobo_robot_driver(k->c.robot);
    int id = grobo_model_joint(driver->model, k->joint)->motor, n = 0;
    uint8_t bytes[FAMILY_PIECE_BYTES];
    int64_t took_us[READS];
    uint16_t address;
    uint32_t wire_us = 0;
    int length = family_identity(driver, family_servo(driver, id), &address);
    int error = wire_read_us(driver, (int)conn_baud(k->a), length, &wire_us);
    for (int i = 0; i < READS && !error && !k->c.signal && !k->c.link_error; i++) {
        if (servos_read(&k->c, id, address, length, bytes) == GROBO_OK) {
            took_us[n++] = k->came_us - k->sent_us;
        }
    }
    if (n == 0) {
        contact_note(k, "latency", NOT_DONE, "no servo answers");
        return;
    }
    qsort(took_us, (size_t)n, sizeof *took_us, by_size);
    contact_note(
        k, "latency", took_us[n / 2] - wire_us < 5000 ? AS_ASSUMED : NOT_AS_ASSUMED,
        "%d replies of %d; from %.2f to %.2f ms, half within %.2f ms; the wire takes %.2f ms", n,
        READS, (double)took_us[0] / 1e3, (double)took_us[n - 1] / 1e3, (double)took_us[n / 2] / 1e3,
        wire_us / 1e3);
    if (!driver->protocol->relay) {
        contact_note(k, "board", NOT_DONE, "no board: the servos are straight on the line");
        return;
    }
    /* One that forwards bytes as they come would be done before that. The quickest of all may be a
     * program that was held up between sending and looking at the clock. */
    int64_t quick_us = took_us[n / 10];
    contact_note(
        k, "board", (double)quick_us > 0.95 * wire_us ? AS_ASSUMED : NOT_AS_ASSUMED,
        "stores a frame and then forwards it: a quick reply took %.2f ms, by reckoning %.2f",
        (double)quick_us / 1e3, wire_us / 1e3);
}

static void look_for_echo(contact *k)
{
    const grobo_bus_stats *n = grobo_robot_get_bus_stats(k->c.robot);
    bool told = app_global(k->a, GLOBAL_ECHO)->given > 0;
    bool comes = !grobo_robot_driver(k->c.robot)->protocol->relay && wire_echoes(n);
    contact_note(k, "echo", comes ? NOT_AS_ASSUMED : AS_ASSUMED,
                 told    ? "the adapter echoes, as configured"
                 : comes ? "the adapter echoes, which is not configured: --wiring bus --echo"
                         : "the adapter does not echo");
    /* One in fifty may be lost to a busy machine. */
    bool good = n->bad_sums == 0 && n->timeouts <= n->tx_frames / 50;
    contact_note(k, "line", good ? AS_ASSUMED : NOT_AS_ASSUMED,
                 "%u frames, %u replies, %u late or missing, %u with a wrong sum, %u stray bytes",
                 (unsigned)n->tx_frames, (unsigned)n->replies, (unsigned)n->timeouts,
                 (unsigned)n->bad_sums, (unsigned)n->resync_bytes);
}

static int read_only(contact *k)
{
    app_note(k->a, "reading; nothing moves");
    int status = contact_open(k, "read", false);
    if (!status) {
        read_servos(k);
        measure_times(k);
        look_for_echo(k);
    }
    return contact_close(k, status);
}

/* ---- one joint ------------------------------------------------------------------------------- */

static int switch_torque(contact *k, grobo_torque torque)
{
    return conn_wait(&k->c, grobo_robot_torque(k->c.robot, GROBO_JOINT_BIT(k->joint), torque));
}

static int go_to(contact *k, double deg, double *reached_deg)
{
    grobo_posture target;
    grobo_joint_info is;
    grobo_posture_init(&target, app_model(k->a)->n_joints);
    grobo_posture_set_deg(&target, k->joint, deg);
    target.time_us = MOVE_US;
    int error = conn_wait(&k->c, grobo_robot_move(k->c.robot, &target));
    if (!error) {
        error = contact_sense(k, &is);
    }
    *reached_deg = error ? 0 : grobo_deg_from_rad(is.state.angle_rad);
    return error;
}

/* Reads where it stands; from here on every way out carries out the exit policy. */
static int begin_joint(contact *k)
{
    grobo_joint_info is;
    int error = contact_sense(k, &is);
    if (!error) {
        k->before_deg = grobo_deg_from_rad(is.state.angle_rad);
        k->was_on = is.state.torque != GROBO_TORQUE_OFF;
        k->c.moving = true;
        error = switch_torque(k, GROBO_TORQUE_ON);
    }
    return error;
}

/* As it was found: one that was limp is limp again. */
static int end_joint(contact *k, int error)
{
    int let_go = error || k->was_on ? GROBO_OK : switch_torque(k, GROBO_TORQUE_OFF);
    error = error ? error : let_go;
    k->c.moving = error != 0;
    return error ? conn_fail(&k->c, error, "first-contact") : EXIT_DONE;
}

static int test_torque(contact *k)
{
    double most_deg = 0;
    int status = contact_open(k, "torque", true);
    if (status) {
        return contact_close(k, status);
    }
    int error = begin_joint(k);
    for (int i = 0; i < LOOKS && !error; i++) {
        grobo_joint_info is;
        error = conn_sleep_until(&k->c, grobo_now_us() + LOOK_US);
        error = error ? error : contact_sense(k, &is);
        if (!error) {
            double off_deg = grobo_deg_from_rad(is.state.angle_rad) - k->before_deg;
            most_deg = fabs(off_deg) > fabs(most_deg) ? off_deg : most_deg;
        }
    }
    status = end_joint(k, error);
    if (!status) {
        contact_note(k, "torque_on", fabs(most_deg) < NEAR_DEG ? AS_ASSUMED : NOT_AS_ASSUMED,
                     "does not jump: %+.2f deg at most in %.1f s", most_deg, LOOKS * LOOK_US / 1e6);
    }
    return contact_close(k, status);
}

static int test_move(contact *k, double *step_deg)
{
    const grobo_joint *joint = grobo_model_joint(app_model(k->a), k->joint);
    double there_deg = 0, back_deg = 0;
    int status = contact_open(k, "move", true);
    if (status) {
        return contact_close(k, status);
    }
    int error = begin_joint(k);
    *step_deg =
        k->before_deg + STEP_DEG <= grobo_deg_from_rad(joint->max_rad) ? STEP_DEG : -STEP_DEG;
    error = error ? error : go_to(k, k->before_deg + *step_deg, &there_deg);
    error = error ? error : go_to(k, k->before_deg, &back_deg);
    status = end_joint(k, error);
    if (!status) {
        bool there = fabs(there_deg - k->before_deg - *step_deg) < NEAR_DEG &&
                     fabs(back_deg - k->before_deg) < NEAR_DEG;
        contact_note(k, "move", there ? AS_ASSUMED : NOT_AS_ASSUMED,
                     "from %.2f by %+.0f deg to %.2f, and back to %.2f", k->before_deg, *step_deg,
                     there_deg, back_deg);
    }
    return contact_close(k, status);
}

static void ask_direction(contact *k, double step_deg)
{
    char answer[ASK_BYTES];
    if (!ask_line(k->a, "did the joint turn, first towards larger angles (yes, no, other way)?",
                  "not seen", answer)) {
        return;
    }
    bool fine = answer[0] == 'y' || answer[0] == 'Y';
    bool unseen = answer[0] == 'n' && strncmp(answer, "not", 3) == 0;
    contact_note(k, "seen",
                 fine     ? AS_ASSUMED
                 : unseen ? NOT_DONE
                          : NOT_AS_ASSUMED,
                 "the answer for %+.0f deg: %.80s", step_deg, answer);
}

static int try_joint(contact *k)
{
    const char *name = grobo_model_joint(app_model(k->a), k->joint)->name;
    char question[APP_LINE_BYTES];
    double step_deg = STEP_DEG;
    snprintf(question, sizeof question,
             _("hold the robot. Switch the torque of %s on for half a second? It should not move"),
             name);
    if (!ask_yes(k->a, question)) {
        contact_note(k, "torque_on", NOT_DONE, "the person declined");
        contact_note(k, "move", NOT_DONE, "the person declined");
        return contact_try_rates(k);
    }
    int status = test_torque(k);
    if (status) {
        return status;
    }
    snprintf(question, sizeof question, _("keep your hands off. Move %s by %.0f degrees and back?"),
             name, STEP_DEG);
    if (k->n_bad > 0) {
        app_note(k->a, "something was not as assumed; better send the report first");
    }
    if (!ask_yes(k->a, question)) {
        contact_note(k, "move", NOT_DONE, "the person declined");
        return contact_try_rates(k);
    }
    status = test_move(k, &step_deg);
    if (!status) {
        ask_direction(k, step_deg);
        status = contact_try_rates(k);
    }
    return status;
}

/* ---- all of it ------------------------------------------------------------------------------- */

static int begin(contact *k, const contact_orders *orders)
{
    char path[CONTACT_PATH_BYTES + 8];
    snprintf(k->prefix, sizeof k->prefix, orders->out ? "%.900s" : "first-contact-%.900s",
             orders->out ? orders->out : robot_of(k->a)->name);
    snprintf(path, sizeof path, "%s.txt", k->prefix);
    if (file_is_there(path)) {
        return app_fail(k->a, EXIT_USAGE, "EXISTS", "%s is there already; -o names another", path);
    }
    k->joint = orders->joint >= 0 ? orders->joint : app_model(k->a)->n_joints - 1;
    k->steps = json_array();
    k->servos = json_array();
    return orders->other ? contact_read_report(k->a, orders->other, &k->other) : 0;
}

int contact_run(app *a, const contact_orders *orders)
{
    static contact k;
    int status = 0;
    memset(&k, 0, sizeof k);
    k.a = a;
    if (a->link) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "first-contact opens the line for itself; not in a shell");
    }
    if (app_global(a, GLOBAL_TRACE)->given) {
        return app_fail(a, EXIT_USAGE, "ARG", "first-contact has traces of its own: -o names them");
    }
    if (!ask_can(a, "'grctl doctor' and 'grctl status'", &status)) {
        return status;
    }
    status = begin(&k, orders);
    if (!status) {
        status = read_only(&k);
    }
    if (!status) {
        status = try_joint(&k);
    }
    int written = k.steps && json_array_size(k.steps) > 0 ? write_report(&k) : 0;
    json_decref(k.steps);
    json_decref(k.servos);
    json_decref(k.other);
    free(k.text.bytes);
    status = ask_signal() ? EXIT_SIGNAL + ask_signal() : status ? status : written;
    return status ? status : k.n_bad ? EXIT_ROBOT : EXIT_DONE;
}
