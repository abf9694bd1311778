/* SPDX-License-Identifier: MIT */
/* The driver functions of servos that are registers, and the table of such a robot. */
#include <math.h>
#include <string.h>

#include "src/model/joint.h"
#include "src/servo/table/family.h"
#include "src/servo/unit.h"

/* A run of registers. */
typedef struct span {
    int from, to; /* addresses; to is behind the last byte */
} span;

#define MS_US 1000
/* Rebooting, or taking factory settings. */
#define RESTART_US 2000000
/* A register this far from the goal is not written with it. */
#define NEAR_BYTES 8
/* Registers this far apart are read in two exchanges: those of DYNAMIXEL P begin anew at 512. */
#define FAR_BYTES 256

static const grobo_register_role motion[] = {GROBO_ROLE_ACCELERATION, GROBO_ROLE_SPEED,
                                             GROBO_ROLE_GOAL_TIME, GROBO_ROLE_GOAL};

/* What each kind of sensing reads. The first reading of all looks at the setup, too. */
static const grobo_register_role setup_roles[] = {GROBO_ROLE_MODEL, GROBO_ROLE_SHUTDOWN};
static const grobo_register_role goal_roles[] = {GROBO_ROLE_TORQUE, GROBO_ROLE_GOAL,
                                                 GROBO_ROLE_POSITION, GROBO_ROLE_PRESENT_SPEED};
static const grobo_register_role full_roles[] = {
    GROBO_ROLE_TORQUE, GROBO_ROLE_POSITION, GROBO_ROLE_PRESENT_SPEED, GROBO_ROLE_VOLTAGE,
    GROBO_ROLE_ERROR,  GROBO_ROLE_CURRENT,  GROBO_ROLE_TEMPERATURE};
static const grobo_register_role position_roles[] = {GROBO_ROLE_POSITION};

static const struct {
    const grobo_register_role *roles;
    size_t n;
} kinds[] = {
    [GROBO_SENSE_FULL] = {full_roles, sizeof full_roles / sizeof full_roles[0]},
    [GROBO_SENSE_POSITION] = {position_roles, 1},
    [GROBO_SENSE_GOAL] = {goal_roles, sizeof goal_roles / sizeof goal_roles[0]},
    [GROBO_SENSE_ALL] = {full_roles, sizeof full_roles / sizeof full_roles[0]},
};

static const grobo_i_family *family_of(const grobo_driver *self)
{
    return self->family;
}

/* ---- runs of registers ----------------------------------------------------------------------- */

static void widen(span *s, const grobo_servo_model *servo, grobo_register_role role)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servo, role);
    /* Behind all others they are not worth the time: an error that counts cuts the torque. */
    bool far = reg != NULL && s->to > 0 && reg->address > s->to + NEAR_BYTES &&
               (role == GROBO_ROLE_CURRENT || role == GROBO_ROLE_ERROR);
    if (reg != NULL && !far) {
        s->from = s->to == 0 || reg->address < s->from ? reg->address : s->from;
        s->to = reg->address + reg->bytes > s->to ? reg->address + reg->bytes : s->to;
    }
}

/* Whether what a servo keeps lies far before the rest. */
static bool is_apart(const grobo_servo_model *servo)
{
    const grobo_servo_register *torque = grobo_servo_register_of(servo, GROBO_ROLE_TORQUE);
    const grobo_servo_register *model = grobo_servo_register_of(servo, GROBO_ROLE_MODEL);
    return torque != NULL && model != NULL && torque->address - model->address > FAR_BYTES;
}

static span setup_span(const grobo_servo_model *servo)
{
    span s = {0, 0};
    for (size_t i = 0; i < sizeof setup_roles / sizeof setup_roles[0]; i++) {
        widen(&s, servo, setup_roles[i]);
    }
    return s;
}

/* What an exchange of this kind reads: the only one, or, of registers apart, the last. */
static span sense_span(const grobo_servo_model *servo, grobo_sense_kind kind)
{
    span s = {0, 0};
    /* The error cuts the torque where the bit of the other register says so, if that is near. */
    const grobo_servo_register *torque = grobo_servo_register_of(servo, GROBO_ROLE_TORQUE);
    const grobo_servo_register *shutdown = grobo_servo_register_of(servo, GROBO_ROLE_SHUTDOWN);
    for (size_t i = 0; i < kinds[kind].n; i++) {
        widen(&s, servo, kinds[kind].roles[i]);
    }
    if (kind == GROBO_SENSE_FULL && torque != NULL && shutdown != NULL &&
        torque->address - shutdown->address <= NEAR_BYTES) {
        widen(&s, servo, GROBO_ROLE_SHUTDOWN);
    }
    if (kind == GROBO_SENSE_ALL) {
        widen(&s, servo, GROBO_ROLE_GOAL);
    }
    if (kind == GROBO_SENSE_ALL && !is_apart(servo)) {
        widen(&s, servo, GROBO_ROLE_MODEL);
    }
    return s;
}

/* The first exchange of this kind. */
static span first_span(const grobo_servo_model *servo, grobo_sense_kind kind)
{
    return kind == GROBO_SENSE_ALL && is_apart(servo) ? setup_span(servo) : sense_span(servo, kind);
}

static span goal_span(const grobo_driver *self, const grobo_servo_model *servo)
{
    (void)self;
    span s = {0, 0};
    const grobo_servo_register *goal = grobo_servo_register_of(servo, GROBO_ROLE_GOAL);
    for (size_t i = 0; i < sizeof motion / sizeof motion[0]; i++) {
        const grobo_servo_register *reg = grobo_servo_register_of(servo, motion[i]);
        if (reg != NULL && reg->address + NEAR_BYTES >= goal->address &&
            reg->address <= goal->address + NEAR_BYTES) {
            widen(&s, servo, motion[i]);
        }
    }
    return s;
}

static bool same(span a, span b)
{
    return a.from == b.from && a.to == b.to;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static int finish(const grobo_driver *self, const grobo_dxl2_packet *packet,
                  grobo_exchange *exchange)
{
    int size = family_of(self)->build(packet, exchange->frame, sizeof exchange->frame);
    return grobo_i_table_finish(self, size, exchange);
}

static int read_span(const grobo_driver *self, uint8_t id, span s, grobo_exchange *exchange)
{
    const grobo_dxl2_packet packet = {.id = id,
                                      .instruction = GROBO_DXL2_READ,
                                      .address = (uint16_t)s.from,
                                      .length = (uint16_t)(s.to - s.from)};
    return finish(self, &packet, exchange);
}

/* Servos that a frame writes to, so many bytes each. */
static int servos_per_frame(const grobo_driver *self, int bytes)
{
    const int head = 16; /* header, id, length, instruction, address, length, sum: at most */
    int most = family_of(self)->frame_max_bytes;
    most = most < GROBO_FRAME_MAX_BYTES ? most : GROBO_FRAME_MAX_BYTES;
    return (most - head) / (1 + bytes);
}

/* The joints of part `part`: those of a frame have the same registers. */
static grobo_joint_mask joints_of_part(const grobo_driver *self, grobo_joint_mask joints, int part,
                                       span (*span_of)(const grobo_driver *self,
                                                       const grobo_servo_model *servo),
                                       span *s)
{
    grobo_joint_mask mine = 0;
    for (; part >= 0; part--) {
        int n = 0;
        mine = 0;
        for (int j = 0; j < self->model->n_joints; j++) {
            if ((joints & GROBO_JOINT_BIT(j)) == 0) {
                continue;
            }
            span own = span_of(self, grobo_i_table_servo(self, j));
            *s = n == 0 ? own : *s;
            if (same(own, *s) && n < servos_per_frame(self, own.to - own.from)) {
                mine |= GROBO_JOINT_BIT(j);
                n++;
            }
        }
        joints &= ~mine;
    }
    return mine;
}

/* A sync write of these joints; put() fills in what each gets. */
static int write_part(const grobo_driver *self, grobo_joint_mask joints, span s, const void *what,
                      void (*put)(const grobo_driver *self, int joint, const void *what, span s,
                                  uint8_t *to),
                      grobo_exchange *exchange)
{
    uint8_t data[GROBO_FRAME_MAX_BYTES];
    const size_t each = (size_t)(s.to - s.from);
    size_t n = 0;
    if (joints == 0) {
        return 0;
    }
    for (int j = 0; j < self->model->n_joints; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) != 0) {
            data[n] = grobo_i_joint(self->model, j)->motor;
            memset(data + n + 1, 0, each);
            put(self, j, what, s, data + n + 1);
            n += 1 + each;
        }
    }
    const grobo_dxl2_packet packet = {.id = GROBO_DXL2_ID_ALL,
                                      .instruction = GROBO_DXL2_SYNC_WRITE,
                                      .address = (uint16_t)s.from,
                                      .length = (uint16_t)each,
                                      .data = data,
                                      .data_bytes = n};
    int result = finish(self, &packet, exchange);
    return result < 0 ? result : 1;
}

/* ---- goals ----------------------------------------------------------------------------------- */

static void put_role(const grobo_servo_model *servo, grobo_register_role role, double value, span s,
                     uint8_t *to)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servo, role);
    if (reg != NULL && reg->address >= s.from && reg->address + reg->bytes <= s.to) {
        value = fmin(fmax(value, reg->min), reg->max);
        (void)grobo_servo_register_put(servo, reg, (int32_t)value, to + (reg->address - s.from));
    }
}

/* A current that lies between a goal and its speed bounds the move, as from the factory: 0 would
 * be no force. */
static void put_between(const grobo_servo_model *servo, span s, uint8_t *to)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servo, GROBO_ROLE_GOAL_CURRENT);
    if (reg != NULL) {
        put_role(servo, GROBO_ROLE_GOAL_CURRENT, reg->factory, s, to);
    }
}

static bool takes_time(const grobo_driver *self, const grobo_servo_model *servo)
{
    const grobo_i_family *family = grobo_i_table_family(self, servo);
    return family->pace == GROBO_I_PACE_PROFILE ||
           (family->pace == GROBO_I_PACE_TIME &&
            grobo_servo_register_of(servo, GROBO_ROLE_GOAL_TIME) != NULL);
}

/* How joints speed up and brake: as the slowest of them, where each goal is told the most of a
 * register of acceleration; else 0. */
static double least_accel(const grobo_driver *self)
{
    double least_dps2 = INFINITY;
    for (int j = 0; j < self->model->n_joints; j++) {
        const grobo_joint *joint = grobo_i_joint(self->model, j);
        const grobo_servo_model *servo = grobo_i_table_servo(self, j);
        const grobo_servo_register *reg = grobo_servo_register_of(servo, GROBO_ROLE_ACCELERATION);
        span s = goal_span(self, servo);
        bool told = reg != NULL && reg->address >= s.from && reg->address < s.to &&
                    !takes_time(self, servo);
        double ratio = grobo_joint_from_servo(joint, 1) - grobo_joint_from_servo(joint, 0);
        double own_dps2 = told ? reg->max * grobo_i_register_unit(reg) * fabs(ratio) : 0;
        least_dps2 = fmin(least_dps2, own_dps2);
    }
    return grobo_rad_from_deg(least_dps2);
}

static void put_goal(const grobo_driver *self, int joint, const void *what, span s, uint8_t *to)
{
    const grobo_target *target = what;
    const grobo_joint *moved = grobo_i_joint(self->model, joint);
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    double angle_rad = target->posture.angle_rad[joint];
    int64_t time_us = target->joint_time_us[joint] > 0 ? target->joint_time_us[joint] : MS_US;
    double ms = (double)((time_us + MS_US / 2) / MS_US);
    put_role(servo, GROBO_ROLE_GOAL, grobo_i_table_ticks(moved, servo, angle_rad), s, to);
    put_between(servo, s, to);
    if (grobo_i_table_family(self, servo)->pace == GROBO_I_PACE_PROFILE) {
        put_role(servo, GROBO_ROLE_SPEED, fmax(ms, 1), s, to);
    } else if (takes_time(self, servo)) {
        put_role(servo, GROBO_ROLE_GOAL_TIME, fmax(ms, 1), s, to);
    } else {
        const grobo_servo_register *speed = grobo_servo_register_of(servo, GROBO_ROLE_SPEED);
        double counts = grobo_i_table_speed_dps(self, target, joint) / grobo_i_register_unit(speed);
        put_role(servo, GROBO_ROLE_SPEED, fmax(ceil(counts), 1), s, to); /* 0 is the fastest */
        put_role(servo, GROBO_ROLE_ACCELERATION, INT32_MAX, s, to);      /* the way is straight */
    }
}

static int posture(const grobo_driver *self, void *ctx, const grobo_target *target, int part,
                   grobo_exchange *exchange)
{
    (void)ctx;
    span s = {0, 0};
    grobo_joint_mask joints = joints_of_part(self, target->posture.set, part, goal_span, &s);
    return write_part(self, joints, s, target, put_goal, exchange);
}

/* ---- wheels ---------------------------------------------------------------------------------- */

/* The register of a wheel's speed; nothing of a servo that cannot be one. */
#if !GROBO_DRIVERS_PLAIN
static span speed_span(const grobo_driver *self, const grobo_servo_model *servo)
{
    const grobo_i_family *family = grobo_i_table_family(self, servo);
    grobo_i_wheel wheel;
    span s = {0, 0};
    if (family->wheel != NULL && family->wheel(servo, &wheel)) {
        widen(&s, servo, wheel.role);
    }
    return s;
}

static void put_speed(const grobo_driver *self, int joint, const void *what, span s, uint8_t *to)
{
    const double *rad_s = what;
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    grobo_i_wheel wheel;
    (void)s;
    if (grobo_i_table_wheel(self, joint, &wheel)) {
        int32_t counts =
            grobo_i_wheel_counts(grobo_i_joint(self->model, joint), &wheel, rad_s[joint]);
        (void)grobo_servo_register_put(servo, grobo_servo_register_of(servo, wheel.role), counts,
                                       to);
    }
}

static int speed(const grobo_driver *self, void *ctx, grobo_joint_mask joints, const double *rad_s,
                 int part, grobo_exchange *exchange)
{
    (void)ctx;
    span s = {0, 0};
    joints = joints_of_part(self, joints, part, speed_span, &s);
    return write_part(self, joints, s, rad_s, put_speed, exchange);
}
#endif

/* ---- torque ---------------------------------------------------------------------------------- */

static span torque_span(const grobo_driver *self, const grobo_servo_model *servo)
{
    (void)self;
    span s = {0, 0};
    widen(&s, servo, GROBO_ROLE_TORQUE);
    return s;
}

static void put_torque(const grobo_driver *self, int joint, const void *what, span s, uint8_t *to)
{
    const grobo_i_family *family = self->family;
    const grobo_torque *mode = what;
    (void)joint;
    (void)s;
    to[0] = *mode == GROBO_TORQUE_ON ? 1 : *mode == GROBO_TORQUE_OFF ? family->off : family->brake;
}

static int torque(const grobo_driver *self, void *ctx, grobo_joint_mask joints, grobo_torque mode,
                  int part, grobo_exchange *exchange)
{
    (void)ctx;
    const grobo_i_family *family = self->family;
    span s = {0, 0};
    if (mode == GROBO_TORQUE_BRAKE && family->brake == family->off) {
        return GROBO_ERR_UNSUPPORTED;
    }
    joints = joints_of_part(self, joints, part, torque_span, &s);
    return write_part(self, joints, s, &mode, put_torque, exchange);
}

/* ---- torque limits --------------------------------------------------------------------------- */

/* Nothing of a servo that keeps its limit over power-off: that is its setup. */
static span limit_span(const grobo_driver *self, const grobo_servo_model *servo)
{
    (void)self;
    int32_t counts;
    span s = {0, 0};
    const grobo_joint any = {.torque_limit_pct = 100};
    const grobo_servo_register *reg = grobo_i_table_limit(&any, servo, &counts);
    if (reg != NULL && (reg->flags & GROBO_REGISTER_KEPT) == 0) {
        s = (span){reg->address, reg->address + reg->bytes};
    }
    return s;
}

static void put_limit(const grobo_driver *self, int joint, const void *what, span s, uint8_t *to)
{
    int32_t counts;
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    const grobo_servo_register *reg =
        grobo_i_table_limit(grobo_i_joint(self->model, joint), servo, &counts);
    (void)what;
    put_role(servo, (grobo_register_role)reg->role, counts, s, to);
}

static int torque_limit(const grobo_driver *self, void *ctx, grobo_joint_mask joints, int part,
                        grobo_exchange *exchange)
{
    (void)ctx;
    span s = {0, 0};
    for (int j = 0; j < self->model->n_joints; j++) {
        span own = limit_span(self, grobo_i_table_servo(self, j));
        joints &= own.to > 0 ? joints : ~GROBO_JOINT_BIT(j);
    }
    joints = joints_of_part(self, joints, part, limit_span, &s);
    return write_part(self, joints, s, NULL, put_limit, exchange);
}

/* ---- watchdog -------------------------------------------------------------------------------- */

static span watchdog_span(const grobo_driver *self, const grobo_servo_model *servo)
{
    (void)self;
    span s = {0, 0};
    widen(&s, servo, GROBO_ROLE_WATCHDOG);
    return s;
}

static void put_watchdog(const grobo_driver *self, int joint, const void *what, span s, uint8_t *to)
{
    const grobo_i_family *family = self->family;
    const int64_t *time_us = what;
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    double counts = ceil((double)*time_us / family->watchdog_us);
    bool fits = counts <= grobo_servo_register_of(servo, GROBO_ROLE_WATCHDOG)->max;
    put_role(servo, GROBO_ROLE_WATCHDOG, fits ? counts : 0, s, to);
}

/* Joints whose servos have a watchdog. */
static grobo_joint_mask watched(const grobo_driver *self)
{
    grobo_joint_mask joints = 0;
    for (int j = 0; j < self->model->n_joints; j++) {
        bool has = watchdog_span(self, grobo_i_table_servo(self, j)).to > 0;
        joints |= has ? GROBO_JOINT_BIT(j) : 0;
    }
    return joints;
}

static int watchdog(const grobo_driver *self, void *ctx, grobo_joint_mask joints, int64_t time_us,
                    int part, grobo_exchange *exchange)
{
    (void)ctx;
    span s = {0, 0};
    joints = joints_of_part(self, joints & watched(self), part, watchdog_span, &s);
    return write_part(self, joints, s, &time_us, put_watchdog, exchange);
}

/* ---- reading --------------------------------------------------------------------------------- */

static int check(const grobo_driver *self, void *ctx, int part, grobo_exchange *exchange)
{
    (void)ctx;
    if (part >= self->model->n_joints) {
        return 0;
    }
    span s = {0, 0};
    widen(&s, grobo_i_table_servo(self, part), GROBO_ROLE_MODEL);
    int result = read_span(self, grobo_i_joint(self->model, part)->motor, s, exchange);
    return result < 0 ? result : 1;
}

static int sense(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                 grobo_exchange *exchange)
{
    (void)ctx;
    span s = first_span(grobo_i_table_servo(self, joint), kind);
    return read_span(self, grobo_i_joint(self->model, joint)->motor, s, exchange);
}

static int sense_more(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                      int part, grobo_exchange *exchange)
{
    (void)ctx;
    const grobo_servo_model *servo = grobo_i_table_servo(self, joint);
    if (part > 1 || kind != GROBO_SENSE_ALL || !is_apart(servo)) {
        return 0;
    }
    int result = read_span(self, grobo_i_joint(self->model, joint)->motor, sense_span(servo, kind),
                           exchange);
    return result < 0 ? result : 1;
}

static bool any_apart(const grobo_driver *self)
{
    bool any = false;
    for (int j = 0; j < self->model->n_joints; j++) {
        any = any || is_apart(grobo_i_table_servo(self, j));
    }
    return any;
}

static int ask_many(const grobo_driver *self, grobo_dxl2_code instruction, grobo_joint_mask joints,
                    grobo_sense_kind kind, grobo_exchange *exchange)
{
    uint8_t ids[GROBO_JOINTS_MAX];
    size_t n = 0;
    span s = {0, 0};
    for (int j = 0; j < self->model->n_joints; j++) {
        if ((joints & GROBO_JOINT_BIT(j)) != 0) {
            s = first_span(grobo_i_table_servo(self, j), kind);
            ids[n++] = grobo_i_joint(self->model, j)->motor;
        }
    }
    const grobo_dxl2_packet packet = {.id = GROBO_DXL2_ID_ALL,
                                      .instruction = (uint8_t)instruction,
                                      .address = (uint16_t)s.from,
                                      .length = (uint16_t)(s.to - s.from),
                                      .data = ids,
                                      .data_bytes = n};
    return finish(self, &packet, exchange);
}

static int sense_many(const grobo_driver *self, void *ctx, grobo_joint_mask joints,
                      grobo_sense_kind kind, grobo_exchange *exchange)
{
    (void)ctx;
    return ask_many(self, GROBO_DXL2_SYNC_READ, joints, kind, exchange);
}

static int sense_fast(const grobo_driver *self, void *ctx, grobo_sense_kind kind,
                      grobo_exchange *exchange)
{
    (void)ctx;
    int result = ask_many(self, GROBO_DXL2_FAST_SYNC_READ, GROBO_JOINTS_ALL(self->model->n_joints),
                          kind, exchange);
    bool too_long = result >= 0 && exchange->reply.bytes > GROBO_FRAME_MAX_BYTES;
    return too_long ? GROBO_ERR_CAP : result;
}

/* ---- registers and commands ------------------------------------------------------------------ */

static int registers(const grobo_driver *self, void *ctx, const grobo_register_io *io,
                     grobo_exchange *exchange)
{
    (void)ctx;
    bool read = io->data == NULL;
    const grobo_dxl2_packet packet = {.id = io->id,
                                      .instruction = read ? GROBO_DXL2_READ : GROBO_DXL2_WRITE,
                                      .address = io->address,
                                      .length = read ? io->length : 0,
                                      .data = io->data,
                                      .data_bytes = read ? 0 : io->length};
    return finish(self, &packet, exchange);
}

static int command(const grobo_driver *self, void *ctx, int id, grobo_servo_command what,
                   grobo_exchange *exchange)
{
    (void)ctx;
    const grobo_i_family *family = self->family;
    bool reset = what == GROBO_SERVO_FACTORY_RESET;
    if ((reset && !family->resets) || (what == GROBO_SERVO_REBOOT && !family->reboots) ||
        what == GROBO_SERVO_FLASH) {
        return GROBO_ERR_UNSUPPORTED;
    }
    const grobo_dxl2_packet packet = {.id = (uint8_t)id,
                                      .instruction =
                                          reset ? GROBO_DXL2_FACTORY_RESET : GROBO_DXL2_REBOOT,
                                      .data = family->reset,
                                      .data_bytes = reset ? family->reset_bytes : 0};
    exchange->settle_us = RESTART_US;
    return finish(self, &packet, exchange);
}

/* ---- the table ------------------------------------------------------------------------------- */

/* Whether one frame can ask all joints. */
static bool reads_alike(const grobo_driver *self)
{
    for (int kind = GROBO_SENSE_FULL; kind <= GROBO_SENSE_ALL; kind++) {
        span first = first_span(grobo_i_table_servo(self, 0), (grobo_sense_kind)kind);
        for (int j = 1; j < self->model->n_joints; j++) {
            span own = first_span(grobo_i_table_servo(self, j), (grobo_sense_kind)kind);
            if (!same(first, own)) {
                return false;
            }
        }
    }
    return family_of(self)->sync_read(grobo_i_table_servo(self, 0));
}

int grobo_i_table_driver(grobo_driver *driver, const grobo_model *model,
                         const grobo_protocol *protocol, const grobo_i_family *family)
{
    grobo_driver made =
        GROBO_TABLE(grobo_driver, .check = check, .posture = posture, .torque = torque,
                    .torque_limit = torque_limit, .sense = sense, .parse = grobo_i_table_parse,
                    .write_kind = grobo_i_table_write_kind, .registers = registers,
                    .command = command, .inspect = grobo_i_table_inspect);
#if !GROBO_DRIVERS_PLAIN
    made.speed = family->wheel != NULL || family->of != NULL ? speed : NULL;
#endif
    int result = grobo_i_table_make(&made, model, protocol, family);
    made.watchdog = result >= 0 && watched(&made) != 0 ? watchdog : NULL;
    made.accel_rad_s2 = result >= 0 ? least_accel(&made) : 0;
    made.sense_many = result >= 0 && reads_alike(&made) ? sense_many : NULL;
    made.sense_more = result >= 0 && any_apart(&made) ? sense_more : NULL;
    made.sense_fast = made.sense_many != NULL && family->fast_part != NULL ? sense_fast : NULL;
    return grobo_i_table_give(driver, &made, result);
}
