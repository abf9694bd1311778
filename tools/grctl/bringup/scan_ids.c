/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/bringup/scan.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/conn/wire.h"

/* Looks at all ids that are missing, at most LOOKS_MAX times. A line on which nobody has answered
 * is quiet after LISTEN_US without a byte; one whose replies are known, after twice the longest
 * that one took, but LISTEN_KNOWN_US at least: an adapter that holds bytes back did so there too.
 * None is listened to for longer than LISTEN_MAX_US. What comes later than LATE_MAX_US is no
 * reply. */
enum {
    FEW = 4,
    LOOKS_MAX = 4,
    LISTEN_US = 150000,
    LISTEN_KNOWN_US = 30000,
    LISTEN_MAX_US = 2000000,
    LATE_MAX_US = 1000000
};

scan_identity scan_identity_of(const grobo_driver *driver, const uint8_t *bytes)
{
    const grobo_servo_model *any = family_servo(driver, -1);
    const grobo_servo_register *reg = grobo_servo_register_of(any, GROBO_ROLE_MODEL);
    scan_identity is = {.family = family_of_servo(any)->name, .known = true, .firmware = -1};
    uint16_t from = 0;
    (void)family_identity(driver, any, &from);
    snprintf(is.model, sizeof is.model, "%s", any->table->name);
    if (reg) {
        const grobo_servo_model *model = family_identify(driver, bytes + (reg->address - from));
        is.servo = model;
        is.known = model != NULL;
        int number = grobo_servo_register_get(any, reg, bytes + (reg->address - from));
        if (model) {
            snprintf(is.model, sizeof is.model, "%s", model->name);
        } else {
            snprintf(is.model, sizeof is.model, "unknown model %d", number);
        }
    }
    reg = grobo_servo_register_of(is.servo ? is.servo : any, GROBO_ROLE_FIRMWARE);
    if (reg) {
        is.firmware = grobo_servo_register_get(any, reg, bytes + (reg->address - from));
    }
    return is;
}

/* ---- what comes ------------------------------------------------------------------------------ */

/* A question of this look has one reply. What else a servo says, to another master or under a
 * wrong id, is no late one: all that follow would wait as long. */
static void take_reply(scan_pass *p, const grobo_packet *packet, int64_t now_us)
{
    int id = packet->id;
    int64_t took_us = now_us - p->asked_us[id];
    if (packet->kind != GROBO_PACKET_RETURN || packet->refused || p->asked_us[id] == 0 ||
        packet->data_bytes != (size_t)p->bytes || took_us > LATE_MAX_US) {
        return;
    }
    p->asked_us[id] = 0;
    if (took_us > p->worst_us) {
        p->worst_us = took_us;
    }
    p->late |= took_us > p->timeout_us;
    p->there[id] = true;
    memcpy(p->identity[id], packet->data, packet->data_bytes);
}

static void drop(scan_pass *p, size_t n)
{
    p->n_kept -= n;
    memmove(p->kept, p->kept + n, p->n_kept);
}

/* Packets of those that came, as far as they are whole; end: nothing more comes. */
static void take_replies(scan_pass *p, int64_t now_us, bool end)
{
    while (p->n_kept > 0) {
        grobo_packet packet;
        uint8_t bytes[GROBO_FRAME_MAX_BYTES];
        int size =
            p->protocol->measure(p->kept, p->n_kept, GROBO_ACCEPT_COMMANDS | GROBO_ACCEPT_RETURNS);
        if (size == 0 && !end && p->n_kept < sizeof p->kept) {
            return;
        }
        if (size <= 0) {
            p->rubbish++;
            drop(p, 1);
            continue;
        }
        memcpy(bytes, p->kept, (size_t)size); /* it may be changed */
        p->protocol->unpack(bytes, (size_t)size, &packet);
        take_reply(p, &packet, now_us);
        drop(p, (size_t)size);
    }
}

static void on_bytes(conn *c, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                     size_t size)
{
    scan_pass *p = c->ctx;
    if (direction == GROBO_DIR_TX) {
        p->asked_us[p->asking] = now_us;
        return;
    }
    p->heard_us = now_us;
    while (size > 0) {
        size_t room = sizeof p->kept - p->n_kept, took = size < room ? size : room;
        memcpy(p->kept + p->n_kept, bytes, took);
        p->n_kept += took;
        take_replies(p, now_us, false);
        bytes += took;
        size -= took;
    }
}

static int64_t quiet_at(const scan_pass *p, int64_t since_us)
{
    int64_t least_us = p->worst_us > 0 ? LISTEN_KNOWN_US : LISTEN_US;
    int64_t quiet_us = 2 * p->worst_us > least_us ? 2 * p->worst_us : least_us;
    return (p->heard_us > since_us ? p->heard_us : since_us) + quiet_us;
}

/* Until the line is quiet: nothing that was asked can be answered any more. */
static int listen_on(conn *c, scan_pass *p)
{
    int64_t since_us = grobo_now_us(), at_us;
    int error;
    do {
        at_us = quiet_at(p, since_us);
        error = conn_sleep_until(c, at_us);
    } while (!error && quiet_at(p, since_us) > at_us && grobo_now_us() < since_us + LISTEN_MAX_US);
    take_replies(p, grobo_now_us(), true); /* none of the bytes of a packet that is cut follow */
    return error;
}

static int ask(conn *c, scan_pass *p, int id)
{
    uint8_t bytes[FAMILY_PIECE_BYTES];
    p->asking = id;
    int error = servos_read(c, id, p->address, p->bytes, bytes);
    bool silent = error == GROBO_ERR_TIMEOUT || error == GROBO_ERR_SHORT;
    if (!error) {
        p->there[id] = true;
        memcpy(p->identity[id], bytes, (size_t)p->bytes);
    }
    p->why[id] = silent ? 0 : error;
    return c->signal || c->link_error ? error : GROBO_OK;
}

/* So long that nothing is asked while a reply to the question before may come. */
static uint32_t patience(const scan_pass *p)
{
    return (uint32_t)(2 * p->worst_us) + SERVOS_PATIENT_US;
}

/* The second look after late replies: as late as the latest, twice. What is later still counts when
 * it comes, and makes another look. */
static uint32_t margin_of_second(const scan_pass *p)
{
    return p->late ? (uint32_t)(2 * p->worst_us) + WIRE_SILENT_MARGIN_US : SERVOS_PATIENT_US;
}

/* Asks all ids that are missing, or the robot's alone, and listens to what is still on its
 * way. */
static int look(conn *c, scan_pass *p, uint32_t margin_us, bool joints_only)
{
    int error = servos_wait(c, p->baud_bps, p->bytes, margin_us, -1, &p->timeout_us);
    p->late = false;
    p->rubbish = 0;
    memset(p->asked_us, 0, sizeof p->asked_us);
    for (int id = p->first; id <= p->last && !error; id++) {
        if (p->progress) {
            p->progress(p, id);
        }
        bool joint = grobo_model_joint_of_motor(conn_model(c), id) >= 0;
        if (!p->there[id] && (joint || !joints_only)) {
            error = ask(c, p, id);
        }
    }
    if (!error) {
        error = listen_on(c, p);
    }
    p->n = 0;
    for (int id = p->first; id <= p->last; id++) {
        p->n += p->there[id];
    }
    return error;
}

/* One that the robot should have is missing, though others answer. */
static bool misses_joint(const conn *c, const scan_pass *p)
{
    const grobo_model *model = conn_model(c);
    for (int joint = 0; joint < model->n_joints && p->heard_us && p->own; joint++) {
        int id = grobo_model_motor_of_joint(model, joint);
        if (id >= p->first && id <= p->last && !p->there[id]) {
            return true;
        }
    }
    return false;
}

static bool has_suspects(const scan_pass *p)
{
    for (int id = p->first; id <= p->last; id++) {
        if (p->why[id] && !p->there[id]) {
            return true;
        }
    }
    return false;
}

/*
 * The first look is quick: it takes a servo for silent after milliseconds. Where anything came late
 * or broken, those that are missing are asked again with patience, until a look finds nothing more
 * and hears no rubbish. Where all was well but joints of the robot are missing, they alone are
 * asked again first: all ids with patience would take ten seconds.
 */
static int look_until_sure(conn *c, scan_pass *p, bool *sure)
{
    bool few = p->last - p->first < FEW, joints_only = false;
    int error = GROBO_OK, looks = 0;
    *sure = false;
    for (; !error && !*sure && looks < LOOKS_MAX; looks++) {
        int before = p->n;
        error = look(c, p,
                     looks > 1    ? patience(p)
                     : few        ? SERVOS_PATIENT_US
                     : looks == 1 ? margin_of_second(p)
                                  : WIRE_SILENT_MARGIN_US,
                     joints_only);
        bool clean = p->rubbish == 0 && !has_suspects(p);
        *sure = p->n == p->last - p->first + 1 ||
                (clean && (looks ? p->n == before : !p->late && !misses_joint(c, p)));
        joints_only = looks == 0 && clean && !p->late;
    }
    return error;
}

/* Nobody is accused but by an answer to a question on a quiet line, with all the time it may take.
 * One that is silent then is silent. */
static int question_suspects(conn *c, scan_pass *p, bool *sure)
{
    int error = servos_wait(c, p->baud_bps, p->bytes, patience(p), -1, NULL);
    for (int id = p->first; id <= p->last && !error; id++) {
        if (!p->why[id] || p->there[id]) {
            continue;
        }
        error = ask(c, p, id);
        if (!error) {
            error = listen_on(c, p);
        }
        if (p->why[id] && !p->there[id] && !error) {
            app_note(c->a, "id %d answers, but: %s (two servos with one id?)", id,
                     grobo_error_text(p->why[id]));
        }
    }
    *sure = *sure && !has_suspects(p);
    return error;
}

int scan_line(conn *c, scan_pass *p)
{
    int64_t began_us = grobo_now_us();
    bool sure = false;
    const grobo_driver *driver = grobo_robot_driver(c->robot);
    p->protocol = driver->protocol;
    p->bytes = family_identity(driver, family_servo(driver, -1), &p->address);
    int error = wire_read_us(driver, p->baud_bps, p->bytes, &p->wire_us);
    c->ctx = p;
    c->on_bytes = on_bytes;
    if (!error) {
        error = look_until_sure(c, p, &sure);
    }
    if (!error) {
        error = question_suspects(c, p, &sure);
    }
    c->on_bytes = NULL;
    p->sure = sure;
    p->took_us = grobo_now_us() - began_us;
    return error;
}
