/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/dxl2.h>
#include <grobo/core/port.h>

#include "tools/grctl/bringup/found.h"
#include "tools/grctl/bringup/scan.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/node.h"

enum { REGISTER_BYTES = 4, MODE_EXTENDED = 4 };

/* ---- looking -------------------------------------------------------------------------------- */

/* Of a register of positions; false: it has none, or does not answer. */
static bool read_limit(conn *c, const found_servo *one, grobo_register_role role, double *deg)
{
    const grobo_servo_register *reg = grobo_servo_register_of(one->servo, role);
    int32_t ticks = 0;
    if (!reg || servos_get(c, one->id, one->servo, reg, &ticks) != GROBO_OK) {
        return false;
    }
    *deg = (double)(ticks - one->servo->middle) * one->servo->span_deg / one->servo->span_ticks;
    return true;
}

/* Rounded to where the servo surely goes. DYNAMIXEL X that count turns (operating mode 4) have no
 * limits. */
static void read_limits(conn *c, found_servo *one)
{
    const grobo_servo_register *mode = grobo_servo_register_of(one->servo, GROBO_ROLE_MODE);
    double low, high;
    int32_t is = 0;
    one->turns = grobo_servo_series(one->servo) == grobo_dxl2_table() && mode &&
                 servos_get(c, one->id, one->servo, mode, &is) == GROBO_OK && is == MODE_EXTENDED;
    const grobo_servo_register *offset = grobo_servo_register_of(one->servo, GROBO_ROLE_OFFSET);
    one->calibrated =
        offset && servos_get(c, one->id, one->servo, offset, &is) == GROBO_OK && is != 0;
    if (one->turns) {
        return;
    }
    one->limited = read_limit(c, one, GROBO_ROLE_MIN_POSITION, &low) &&
                   read_limit(c, one, GROBO_ROLE_MAX_POSITION, &high) && low < high;
    if (one->limited) {
        one->limits_deg[0] = ceil(low * 10) / 10;
        one->limits_deg[1] = floor(high * 10) / 10;
    }
}

typedef struct search {
    app *a;
    found_servos *all;
    progress bar;
} search;

static void show(const scan_pass *p, int id)
{
    search *s = p->ctx;
    char text[64];
    if (s->bar.shown) {
        snprintf(text, sizeof text, "%d bps, id %d", p->baud_bps, id);
        progress_draw(&s->bar, (double)(id - p->first) / (p->last - p->first + 1), text);
    }
}

static void begin_rate(scan_search *what, scan_pass *p, int rate, int n_rates)
{
    (void)rate;
    (void)n_rates;
    p->progress = show;
    p->ctx = what->ctx;
}

static void end_rate(scan_search *what, const grobo_robot_family *family, conn *c,
                     const scan_pass *p)
{
    search *s = what->ctx;
    progress_clear(&s->bar);
    s->all->sure &= p->sure;
    if (p->n > 0) {
        (void)servos_wait(c, p->baud_bps, REGISTER_BYTES, SERVOS_PATIENT_US, 2, NULL);
    }
    for (int id = p->first; id <= p->last && s->all->n < FOUND_MAX; id++) {
        if (!p->there[id]) {
            continue;
        }
        const scan_identity is = scan_identity_of(p->driver, p->identity[id]);
        found_servo *one = &s->all->servo[s->all->n++];
        *one = (found_servo){.family = family,
                             .servo = is.servo ? is.servo : &family->tables[0]->models[0],
                             .told = is.servo != NULL,
                             .unknown = !is.known,
                             .id = id,
                             .baud_bps = p->baud_bps};
        snprintf(one->model, sizeof one->model, "%s", is.model);
        if (is.known) {
            read_limits(c, one);
        }
    }
}

int found_look(app *a, const char *family, found_servos *all)
{
    search s = {.a = a, .all = all};
    const int first[] = {0, FOUND_IDS}, last[] = {FOUND_IDS - 1, SCAN_IDS - 1};
    int status = 0;
    scan_search what = {.family = family ? family : "all",
                        .who = N_("servos are looked for on a line"),
                        .begins = begin_rate,
                        .ends = end_rate,
                        .ctx = &s};
    all->n = 0;
    all->sure = true;
    progress_start(&s.bar, a);
    for (int i = 0; i < 2 && !status && all->n == 0; i++) {
        what.first = first[i];
        what.last = last[i];
        status = scan_families(a, &what);
    }
    progress_clear(&s.bar);
    return status;
}

/* ---- choosing ------------------------------------------------------------------------------- */

static bool same_line(const found_servo *x, const found_servo *y)
{
    return x->family == y->family && x->baud_bps == y->baud_bps;
}

/* Those that one family takes for its own, and another knows better, are the other's. */
static void drop_unknown(const app *a, found_servos *all)
{
    int kept = 0;
    for (int i = 0; i < all->n; i++) {
        const found_servo one = all->servo[i];
        bool better = false;
        for (int k = 0; k < all->n && one.unknown; k++) {
            const found_servo *other = &all->servo[k];
            better |= k < kept || k > i ? !other->unknown && other->id == one.id &&
                                              other->baud_bps == one.baud_bps
                                        : false;
        }
        if (!one.unknown) {
            all->servo[kept++] = one;
        } else if (!better) {
            app_note(a,
                     "id %d at %d bps talks as %s do: %s; if it is like a known one, describe it "
                     "in a file (docs/guide/own-servo.md)",
                     one.id, one.baud_bps, one.family->name, one.model);
        }
    }
    all->n = kept;
}

void found_choose(app *a, found_servos *all)
{
    drop_unknown(a, all);
    const found_servo *best = NULL;
    int most = 0, kept = 0;
    for (int i = 0; i < all->n; i++) {
        int n = 0;
        for (int k = 0; k < all->n; k++) {
            n += same_line(&all->servo[i], &all->servo[k]);
        }
        if (n > most) {
            most = n;
            best = &all->servo[i];
        }
    }
    if (!best) {
        return;
    }
    const found_servo line = *best;
    for (int i = 0; i < all->n; i++) {
        const found_servo *one = &all->servo[i];
        if (same_line(one, &line)) {
            all->servo[kept++] = *one;
        } else {
            app_note(
                a, "skipped: %s of id %d, family %s at %d bps: a robot has one family and one rate",
                one->servo->name, one->id, one->family->name, one->baud_bps);
        }
    }
    all->n = kept;
}

bool found_fits(const found_servos *all, const grobo_robot_def *def)
{
    if (all->n != def->model->n_joints || def->family != all->servo[0].family) {
        return false;
    }
    for (int i = 0; i < all->n; i++) {
        int joint = grobo_model_joint_of_motor(def->model, all->servo[i].id);
        if (joint < 0 || !all->servo[i].told ||
            grobo_model_joint(def->model, joint)->servo_model != all->servo[i].servo->number) {
            return false;
        }
    }
    return true;
}

/* ---- a sketch ------------------------------------------------------------------------------- */

typedef struct adapter {
    const char *path;
    char *usb;
    size_t capacity;
} adapter;

static int take_port(void *ctx, const grobo_port_info *info)
{
    const adapter *wanted = ctx;
    if (strcmp(info->path, wanted->path) != 0 || info->usb_vendor < 0) {
        return 0;
    }
    snprintf(wanted->usb, wanted->capacity, "%04x:%04x", (unsigned)info->usb_vendor & 0xffff,
             (unsigned)info->usb_product & 0xffff);
    return 1;
}

void found_sketch(app *a, const found_servos *all, const char *name, sketch *s)
{
    char path[GROBO_DEVICE_MAX_BYTES] = "";
    s->n = 0;
    s->bare = true;
    s->guessed_servos = s->calibrated = false;
    s->usb[0] = '\0';
    s->family = all->servo[0].family;
    s->baud_bps = all->servo[0].baud_bps;
    snprintf(s->name, sizeof s->name, "%s", name);
    snprintf(s->source, sizeof s->source, "what answers on %.64s", conn_requested(a));
    if (node_true_path(conn_requested(a), path, sizeof path)) {
        adapter wanted = {path, s->usb, sizeof s->usb};
        (void)grobo_port_list(take_port, &wanted);
    }
    for (int i = 0; i < all->n; i++) {
        const found_servo *one = &all->servo[i];
        sketch_part *part = sketch_add(s);
        snprintf(part->name, sizeof part->name, "joint%d", i + 1);
        part->motion = SKETCH_TURNS;
        part->id = one->id;
        part->servo = one->servo;
        part->turns = one->turns;
        s->calibrated |= one->calibrated;
        part->limited = one->limited;
        part->limits_rad[0] = grobo_rad_from_deg(one->limits_deg[0]);
        part->limits_rad[1] = grobo_rad_from_deg(one->limits_deg[1]);
        if (!one->told) {
            snprintf(part->note, sizeof part->note, "servo: it does not tell its model");
        }
    }
}

static json_t *name_fitting(app *a, const found_servos *all)
{
    json_t *list = json_array();
    for (size_t i = 0; grobo_robot_def_at(i); i++) {
        if (found_fits(all, grobo_robot_def_at(i))) {
            app_note(a, "these are the ids and servos of %s (%s), which needs no file: --robot %s",
                     grobo_robot_def_at(i)->name, grobo_robot_def_at(i)->title,
                     grobo_robot_def_at(i)->name);
            json_array_append_new(list, json_string(grobo_robot_def_at(i)->name));
        }
    }
    return list;
}

int found_new(app *a, const char *family, const char *name, const char *out)
{
    static found_servos all;
    static sketch s;
    char complaint[APP_LINE_BYTES];
    int status = found_look(a, family, &all);
    if (status) {
        return status;
    }
    found_choose(a, &all);
    if (all.n == 0) {
        return app_fail(a, EXIT_ROBOT, "NOTFOUND",
                        "robot new: no servo answers on %s; are they powered? see 'grctl doctor'",
                        conn_requested(a));
    }
    if (!all.sure) {
        app_note(a, "bytes came that are of no whole reply: some may be missing; see 'grctl scan'");
    }
    found_sketch(a, &all, name ? name : "robot", &s);
    if (!sketch_order(&s, complaint, sizeof complaint) ||
        !sketch_fit(&s, complaint, sizeof complaint)) {
        return app_fail(a, EXIT_ROBOT, "CAP", "robot new: %s", complaint);
    }
    json_t *fits = name_fitting(a, &all);
    status = sketch_write(a, &s, out, fits);
    json_decref(fits);
    return status;
}
