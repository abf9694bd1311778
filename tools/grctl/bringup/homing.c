/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/core/dxl1.h>
#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>

#include "tools/grctl/bringup/homing.h"
#include "tools/grctl/bringup/homing_file.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/eeprom.h"
#include "tools/grctl/conn/fall.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/os/keys.h"

enum { LOST_LOOKS = 10 };
enum { PATH_BYTES = 1024, LOOK_US = 50000, NEAR_TICKS = 12 };

typedef struct calibration {
    app *a;
    const homing_orders *orders;
    conn c;
    keys input;
    progress line;
    struct event *look;
    homing before[GROBO_JOINTS_MAX], wanted[GROBO_JOINTS_MAX];
    int32_t now[GROBO_JOINTS_MAX];  /* positions read last */
    uint8_t lost[GROBO_JOINTS_MAX]; /* looks in a row without an answer */
    bool is_due, pressed, has_ended, listens;
    char kept[PATH_BYTES], saved[PATH_BYTES];
} calibration;

/* DYNAMIXEL add their offset to a position, MX where they count turns (emanual homing_offset,
 * mx_multi_turn_offset), STS take it away (LeRobot). 0: this one keeps none; its range alone. */
static int sign_of_offset(const grobo_joint *joint, const grobo_servo_model *servo)
{
    bool adds = grobo_servo_series(servo) == grobo_dxl2_table() ||
                (joint->turns && grobo_servo_register_of(servo, GROBO_ROLE_OFFSET));
    return grobo_servo_series(servo) == grobo_sts_table() ? -1 : adds ? 1 : 0;
}

static const grobo_joint *joint_of(const app *a, int joint)
{
    return grobo_model_joint(app_model(a), joint);
}

static const grobo_servo_model *servo_of(const app *a, int joint)
{
    return family_servo(app_driver(a), joint_of(a, joint)->motor);
}

/* Each of its limits is a register of its own. */
static bool keeps_range(const grobo_servo_model *servo)
{
    return servo && (grobo_servo_series(servo) == grobo_sts_table() ||
                     grobo_servo_series(servo) == grobo_scs_table() ||
                     grobo_servo_series(servo) == grobo_dxl1_table() ||
                     grobo_servo_series(servo) == grobo_dxl2_table());
}

bool homing_fits(const app *a)
{
    for (int j = 0; j < app_model(a)->n_joints; j++) {
        if (!keeps_range(servo_of(a, j))) {
            return false;
        }
    }
    return true;
}

/* ---- registers ------------------------------------------------------------------------------- */

static bool keeps_offset(const calibration *k, int joint)
{
    return sign_of_offset(joint_of(k->a, joint), servo_of(k->a, joint)) != 0;
}

static int read_role(calibration *k, int joint, grobo_register_role role, int32_t *value)
{
    const grobo_servo_model *servo = servo_of(k->a, joint);
    return servos_get(&k->c, joint_of(k->a, joint)->motor, servo,
                      grobo_servo_register_of(servo, role), value);
}

static int put_role(calibration *k, int joint, grobo_register_role role, int32_t value)
{
    const grobo_servo_model *servo = servo_of(k->a, joint);
    return servos_put(&k->c, joint_of(k->a, joint)->motor, servo,
                      grobo_servo_register_of(servo, role), value);
}

/* The engine knows a joint's torque before each write: a setting makes it unknown. */
static int know_torque(calibration *k, int joint)
{
    int error = conn_sense(&k->c, GROBO_JOINT_BIT(joint), GROBO_SENSE_GOAL);
    return error == GROBO_ERR_SETUP ? GROBO_OK : error;
}

/* Written where it is another value only (the memory wears out), and read back. */
static int write_role(calibration *k, int joint, grobo_register_role role, int32_t value)
{
    bool locks = servo_of(k->a, joint)->table->keeps == GROBO_KEEPS_LOCK;
    int32_t is;
    int error = read_role(k, joint, role, &is);
    if (error || is == value) {
        return error;
    }
    error = know_torque(k, joint);
    if (!error && locks) {
        error = put_role(k, joint, GROBO_ROLE_LOCK, 0);
    }
    if (!error) {
        error = put_role(k, joint, role, value);
    }
    if (locks) {
        int locked = put_role(k, joint, GROBO_ROLE_LOCK, 1);
        error = error ? error : locked;
    }
    if (!error) {
        error = read_role(k, joint, role, &is);
    }
    return error ? error : is == value ? GROBO_OK : GROBO_ERR_MISMATCH;
}

static int fail(calibration *k, int error, int joint)
{
    return conn_fail_servo(&k->c, error, grobo_model_joint(app_model(k->a), joint)->motor);
}

static int read_before(calibration *k)
{
    for (int j = 0; j < app_model(k->a)->n_joints; j++) {
        int error = keeps_offset(k, j) ? read_role(k, j, GROBO_ROLE_OFFSET, &k->before[j].offset)
                                       : GROBO_OK;
        if (!error) {
            error = read_role(k, j, GROBO_ROLE_MIN_POSITION, &k->before[j].min);
        }
        if (!error) {
            error = read_role(k, j, GROBO_ROLE_MAX_POSITION, &k->before[j].max);
        }
        if (error) {
            return fail(k, error, j);
        }
    }
    return 0;
}

/* A range that is the factory's, with an offset that is none, would look like no calibration. */
static homing not_as_new(const calibration *k, int joint)
{
    homing h = k->wanted[joint];
    int32_t factory =
        grobo_servo_register_of(servo_of(k->a, joint), GROBO_ROLE_MAX_POSITION)->factory;
    h.max = !k->orders->restore && h.offset == 0 && h.max == factory ? factory - 1 : h.max;
    return h;
}

static int write_all(calibration *k)
{
    for (int j = 0; j < app_model(k->a)->n_joints; j++) {
        const homing h = k->wanted[j] = not_as_new(k, j);
        int error = keeps_offset(k, j) ? write_role(k, j, GROBO_ROLE_OFFSET, h.offset) : GROBO_OK;
        if (!error) {
            error = write_role(k, j, GROBO_ROLE_MIN_POSITION, h.min);
        }
        if (!error) {
            error = write_role(k, j, GROBO_ROLE_MAX_POSITION, h.max);
        }
        if (error) {
            return fail(k, error, j);
        }
    }
    return 0;
}

/* ---- by hand --------------------------------------------------------------------------------- */

static void on_key(void *ctx, int key)
{
    calibration *k = ctx;
    k->pressed |= key == '\n' || key == '\r';
    k->has_ended |= key == KEYS_END;
}

static bool is_due(conn *c)
{
    const calibration *k = c->ctx;
    return k->is_due || k->pressed || k->has_ended;
}

/* A hand that moves an arm moves its cables: a joint that misses a look has not moved in it, and
 * one that misses many in a row ends the calibration. */
static int look(calibration *k)
{
    k->is_due = false;
    for (int j = 0; j < app_model(k->a)->n_joints; j++) {
        int error = read_role(k, j, GROBO_ROLE_POSITION, &k->now[j]);
        k->lost[j] = error ? (uint8_t)(k->lost[j] + 1) : 0;
        if (error && (!conn_is_of_reply(error) || k->lost[j] >= LOST_LOOKS)) {
            return fail(k, error, j);
        }
    }
    return 0;
}

/* A joint that jumps by half a turn goes all the way round. */
static void widen(calibration *k, const int32_t *last)
{
    for (int j = 0; j < app_model(k->a)->n_joints; j++) {
        homing *h = &k->wanted[j];
        homing before = *h;
        int32_t span = (int32_t)servo_of(k->a, j)->span_ticks;
        int32_t first = servo_of(k->a, j)->middle - span / 2;
        h->min = k->now[j] < h->min ? k->now[j] : h->min;
        h->max = k->now[j] > h->max ? k->now[j] : h->max;
        if (k->now[j] - last[j] > span / 2 || last[j] - k->now[j] > span / 2) {
            h->min = first;
            h->max = first + span - 1;
        }
        if (h->min != before.min || h->max != before.max) {
            app_detail(k->a, "%s: %d to %d", grobo_model_joint(app_model(k->a), j)->name,
                       (int)h->min, (int)h->max);
        }
    }
}

static void draw(calibration *k)
{
    char text[512];
    size_t at = 0;
    for (int j = 0; j < app_model(k->a)->n_joints && at < sizeof text - 1; j++) {
        int n = snprintf(text + at, sizeof text - at, "%s%s %d<%d<%d", at ? "  " : "",
                         grobo_model_joint(app_model(k->a), j)->name, (int)k->wanted[j].min,
                         (int)k->now[j], (int)k->wanted[j].max);
        at += n > 0 ? (size_t)n : 0;
    }
    progress_draw(&k->line, -1, text);
}

/* Until enter is pressed. */
static int watch(calibration *k, bool ranges)
{
    int status = 0;
    k->pressed = false;
    while (!k->pressed && !status) {
        int32_t last[GROBO_JOINTS_MAX];
        int error = conn_wait_until(&k->c, is_due);
        if (error) {
            status = conn_fail(&k->c, error, "calibrate");
        } else if (k->has_ended && !k->pressed) {
            status = app_fail(k->a, EXIT_USAGE, "CANCELED",
                              "calibrate: needs a person to press enter, or --from FILE");
        } else {
            memcpy(last, k->now, sizeof last);
            status = look(k);
        }
        if (!status && ranges) {
            widen(k, last);
            draw(k);
        }
    }
    progress_clear(&k->line);
    return status;
}

static int read_here(calibration *k, int joint, int error)
{
    error = error ? error : read_role(k, joint, GROBO_ROLE_POSITION, &k->now[joint]);
    return error ? fail(k, error, joint) : 0;
}

/* Where a joint stands becomes the middle of its servo. */
static int home_joint(calibration *k, int j)
{
    const grobo_servo_model *servo = servo_of(k->a, j);
    const grobo_joint *joint = joint_of(k->a, j);
    int sign = sign_of_offset(joint, servo);
    /* DYNAMIXEL X within one turn take no more than a quarter (emanual homing_offset). */
    int32_t most = grobo_servo_series(servo) == grobo_dxl2_table() && !joint->turns
                       ? (int32_t)servo->span_ticks / 4
                       : grobo_servo_register_of(servo, GROBO_ROLE_OFFSET)->max;
    int status = read_here(k, j, write_role(k, j, GROBO_ROLE_OFFSET, 0));
    if (status) {
        return status;
    }
    int32_t offset = sign * (servo->middle - k->now[j]);
    if (offset < -most || offset > most) {
        return app_fail(k->a, EXIT_SAFETY, "LIMIT",
                        "calibrate: %s is %d counts off its middle, more than its servo can "
                        "take (%d); does its horn sit right?",
                        joint->name, (int)offset, (int)most);
    }
    status = read_here(k, j, write_role(k, j, GROBO_ROLE_OFFSET, offset));
    if (status) {
        return status;
    }
    if (k->now[j] < servo->middle - NEAR_TICKS || k->now[j] > servo->middle + NEAR_TICKS) {
        return app_fail(k->a, EXIT_ROBOT, "MISMATCH",
                        "calibrate: %s reads %d and not %d, its middle: hold it still", joint->name,
                        (int)k->now[j], servo->middle);
    }
    k->wanted[j] = (homing){offset, k->now[j], k->now[j]};
    return 0;
}

static int home(calibration *k)
{
    int status = 0;
    for (int j = 0; j < app_model(k->a)->n_joints && !status; j++) {
        if (keeps_offset(k, j)) {
            status = home_joint(k, j);
        } else {
            status = read_here(k, j, GROBO_OK);
            k->wanted[j] = (homing){0, k->now[j], k->now[j]};
        }
    }
    return status;
}

static int check_ranges(calibration *k)
{
    for (int j = 0; j < app_model(k->a)->n_joints; j++) {
        const homing *h = &k->wanted[j];
        if (h->max - h->min < (int32_t)servo_of(k->a, j)->span_ticks / 36) {
            return app_fail(k->a, EXIT_USAGE, "EMPTY", "calibrate: %s was not moved",
                            grobo_model_joint(app_model(k->a), j)->name);
        }
    }
    return 0;
}

/* A person is there before torque goes off. */
static int hear_enter(calibration *k)
{
    if (!keys_start(&k->input, k->c.base, true, on_key, k)) {
        return app_fail(k->a, EXIT_USAGE, "CANCELED",
                        "calibrate: needs a person to press enter, or --from FILE");
    }
    k->listens = true;
    k->look = conn_every(k->c.base, LOOK_US, conn_note, &k->is_due);
    progress_start(&k->line, k->a);
    app_note(k->a, "hold the robot, what is raised falls: torque goes off when you press enter");
    (void)fall_note(&k->c, GROBO_JOINTS_ALL(app_model(k->a)->n_joints));
    return watch(k, false);
}

static void hear_no_more(calibration *k)
{
    if (k->listens) {
        conn_forget(k->look);
        keys_stop(&k->input);
    }
}

static bool any_offset(const calibration *k)
{
    bool any = false;
    for (int j = 0; j < app_model(k->a)->n_joints; j++) {
        any |= keeps_offset(k, j);
    }
    return any;
}

static int by_hand(calibration *k)
{
    int status = 0;
    if (any_offset(k)) {
        app_note(k->a, "put every joint into the middle of its range, then press enter");
        status = watch(k, false);
    }
    if (!status) {
        status = home(k);
    }
    if (!status) {
        app_note(k->a, any_offset(k) ? "that is the middle; now move every joint to both of its "
                                       "ends, then press enter"
                                     : "move every joint to both of its ends, then press enter");
        status = watch(k, true);
    }
    return status ? status : check_ranges(k);
}

/* ---- from the beginning to the end ----------------------------------------------------------- */

static void report(const calibration *k)
{
    json_t *list = json_array();
    for (int j = 0; j < app_model(k->a)->n_joints; j++) {
        const grobo_joint *moved = grobo_model_joint(app_model(k->a), j);
        const homing *is = &k->wanted[j], *was = &k->before[j];
        if (!k->a->json) {
            app_print("%5d  %-14s  offset %5d -> %5d  range %4d..%4d -> %4d..%4d\n", moved->motor,
                      moved->name, (int)was->offset, (int)is->offset, (int)was->min, (int)was->max,
                      (int)is->min, (int)is->max);
        }
        json_array_append_new(
            list, json_pack("{s:i,s:i,s:s,s:i,s:[i,i],s:i,s:[i,i]}", "joint", j, "motor",
                            moved->motor, "name", moved->name, "before_offset", (int)was->offset,
                            "before_range", (int)was->min, (int)was->max, "offset", (int)is->offset,
                            "range", (int)is->min, (int)is->max));
    }
    if (k->a->json) {
        app_print_json(json_pack("{s:s,s:o*,s:o*,s:b,s:o}", "robot", robot_of(k->a)->name,
                                 "before_file", *k->kept ? app_json_text(k->kept) : NULL, "file",
                                 *k->saved ? app_json_text(k->saved) : NULL, "written",
                                 !k->orders->dry_run, "joints", list));
    } else {
        json_decref(list);
    }
}

static int save(calibration *k)
{
    char path[PATH_BYTES];
    if (k->orders->from || k->orders->restore) {
        return 0;
    }
    snprintf(path, sizeof path, "%s-calibration.json", robot_of(k->a)->name);
    int status = homing_write(k->a, k->orders->out ? k->orders->out : path, k->wanted, k->saved,
                              sizeof k->saved);
    if (!status) {
        app_note(k->a, "calibration written to %s", k->saved);
    }
    return status;
}

static int let_limp(calibration *k)
{
    grobo_joint_mask all = GROBO_JOINTS_ALL(app_model(k->a)->n_joints);
    if (!k->listens) {
        app_note(k->a, "torque goes off: what is raised falls");
        (void)fall_note(&k->c, all);
    }
    return conn_wait(&k->c, grobo_robot_torque(k->c.robot, all, GROBO_TORQUE_OFF));
}

/* All that the servos keep, a file each. */
static int save_all(calibration *k)
{
    char path[EEPROM_PATH_BYTES];
    int status = 0;
    for (int j = 0; j < app_model(k->a)->n_joints && !status; j++) {
        int id = joint_of(k->a, j)->motor;
        status = eeprom_save(&k->c, id, servo_of(k->a, j), path, sizeof path);
        if (!status) {
            app_detail(k->a, "servo %d: what it keeps is saved: %s", id, path);
        }
    }
    return status;
}

/* The robot is limp, and what its servos hold is in a file. */
static int prepare(calibration *k, bool by_file)
{
    int status = by_file ? 0 : hear_enter(k);
    if (!status && !k->orders->dry_run) {
        int error = let_limp(k);
        status = error ? conn_fail(&k->c, error, "calibrate") : 0;
    }
    if (!status) {
        status = read_before(k);
    }
    if (status || k->orders->dry_run) {
        return status;
    }
    status = homing_write(k->a, NULL, k->before, k->kept, sizeof k->kept);
    if (!status) {
        app_note(k->a, "what the servos hold is in %s; 'grctl calibrate --restore %s' undoes this",
                 k->kept, k->kept);
    }
    return status ? status : save_all(k);
}

static int calibrate(calibration *k)
{
    bool by_file = k->orders->from || k->orders->restore;
    k->c.ctx = k;
    int status = prepare(k, by_file);
    if (!status && !by_file) {
        status = by_hand(k);
    }
    if (!status && !k->orders->dry_run) {
        status = write_all(k);
    }
    if (!status) {
        status = save(k);
    }
    if (!status) {
        report(k);
    }
    hear_no_more(k);
    return status;
}

int homing_run(app *a, const homing_orders *orders)
{
    static calibration k;
    int status = 0;
    memset(&k, 0, sizeof k);
    k.a = a;
    k.orders = orders;
    if (!grobo_model_joint(app_model(a), 0)->calibrated && !orders->restore) {
        return app_fail(
            a, EXIT_USAGE, "UNSUPPORTED",
            "calibrate: the file of %s does not say 'calibrated: true': its servos must "
            "have the middle of their factory; --restore writes what they held before",
            robot_of(a)->name);
    }
    if (orders->dry_run && !orders->from && !orders->restore) {
        return app_fail(a, EXIT_USAGE, "ARG", "calibrate: --dry-run needs --from or --restore");
    }
    if (orders->from || orders->restore) {
        status = homing_read(a, orders->from ? orders->from : orders->restore,
                             orders->restore != NULL, k.wanted);
    }
    if (status) {
        return status;
    }
    status = conn_open(&k.c, a);
    return conn_close(&k.c, status ? status : calibrate(&k));
}
