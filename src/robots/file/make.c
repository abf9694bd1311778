/* SPDX-License-Identifier: MIT */
/* From a draft to a robot: what belongs together is checked here. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/unit.h>
#include <grobo/posture.h>

#include "src/model/joint.h"
#include "src/motion/text/nearest.h"
#include "src/robots/file/draft.h"
#include "src/robots/file/families.h"
#include "src/robots/file/own.h"
#include "src/robots/robots.h"

typedef struct maker {
    const grobo_i_draft *draft;
    grobo_i_reader *reader;
    grobo_i_robot_file *file;
    grobo_driver driver; /* of the family, for what the file does not say */
} maker;

static const char *nearest_of(const grobo_i_nearest *nearest)
{
    return nearest->word != NULL ? nearest->word : "";
}

static grobo_i_place place_of(const maker *m, const char *key)
{
    return grobo_i_place_of(GROBO_I_BLOCK_ROBOT, m->draft->at, m->draft->place, key);
}

static grobo_i_place joint_place(const maker *m, int j, const char *key)
{
    const grobo_i_joint_draft *joint = &m->draft->joint[j];
    return grobo_i_place_of(GROBO_I_BLOCK_JOINT, joint->at, joint->place, key);
}

static bool joint_has(const maker *m, int j, const char *key)
{
    return grobo_i_has_key(GROBO_I_BLOCK_JOINT, m->draft->joint[j].at, key);
}

static int complain(const maker *m, grobo_i_place place, const char *code, const char *text,
                    const char *name)
{
    return grobo_i_complain(m->reader, GROBO_ERR_SYNTAX, code, place, text, name);
}

/* One of the words, by its index; -1 with a complaint. */
static int word_at(const maker *m, const char *key, grobo_i_place place, const char *given,
                   const char *const *words)
{
    grobo_i_nearest nearest = {NULL, 0};
    for (int i = 0; words[i] != NULL; i++) {
        if (strcmp(words[i], given) == 0) {
            return i;
        }
        grobo_i_nearest_try(&nearest, given, words[i]);
    }
    char what[64];
    snprintf(what, sizeof what, "%s called", key);
    (void)grobo_i_complain_word(m->reader, place, what, given, nearest_of(&nearest));
    return -1;
}

static int word_of(const maker *m, const char *key, const char *given, const char *const *words)
{
    return word_at(m, key, place_of(m, key), given, words);
}

/* ---- the whole ------------------------------------------------------------------------------ */

/* The family of this name; NULL with a complaint. */
static const grobo_robot_family *family_called(const maker *m, const char *name,
                                               grobo_i_place place)
{
    const char *names[8] = {NULL};
    for (int i = 0; grobo_i_robot_families[i] != NULL; i++) {
        names[i] = grobo_i_robot_families[i]->name;
    }
    int family = word_at(m, "family", place, name, names);
    return family < 0 ? NULL : grobo_i_robot_families[family];
}

static const char *const wirings[] = {"board", "bus", NULL};

/* Several lines, each with a family of its own. */
static void make_line(maker *m, int i)
{
    const grobo_i_lines_draft *draft = &m->draft->lines[i];
    grobo_i_robot_file *file = m->file;
    grobo_robot_file_line *line = &file->lines[i];
    memcpy(file->line_names[i], draft->name, sizeof draft->name);
    memcpy(file->line_ports[i], draft->port, sizeof draft->port);
    line->name = file->line_names[i];
    line->port = *draft->port != '\0' ? file->line_ports[i] : NULL;
    line->echo = draft->echo;
    line->family = family_called(
        m, draft->family, grobo_i_place_of(GROBO_I_BLOCK_LINES, draft->at, draft->place, "family"));
    for (int k = 0; k < i; k++) {
        if (strcmp(file->lines[k].name, line->name) == 0) {
            (void)complain(m, draft->place, "twice", "two lines are called '%s'", line->name);
        }
        if (line->port != NULL && file->lines[k].port != NULL &&
            strcmp(file->lines[k].port, line->port) == 0) {
            (void)complain(m, draft->place, "twice", "two lines have the port '%s'", line->port);
        }
    }
    if (line->family == NULL) {
        return;
    }
    line->wiring = line->family->wiring;
    if (*draft->wiring != '\0') {
        int word = word_at(m, "wiring",
                           grobo_i_place_of(GROBO_I_BLOCK_LINES, draft->at, draft->place, "wiring"),
                           draft->wiring, wirings);
        line->wiring = word == 0 ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS;
    }
    if (line->family->init[line->wiring] == NULL) {
        (void)complain(m, draft->place, "wiring", "servos of line %s cannot be wired so",
                       line->name);
        line->family = NULL;
    }
    line->baud_bps = draft->baud_bps > 0                ? (uint32_t)draft->baud_bps
                     : m->file->lines[i].family == NULL ? 0
                                                        : line->family->baud_bps;
}

static void make_lines(maker *m)
{
    static const char *const alone[] = {"family", "wiring", "line", "usb"};
    grobo_robot_def *def = &m->file->def;
    for (size_t i = 0; i < sizeof alone / sizeof alone[0]; i++) {
        if (grobo_i_has_key(GROBO_I_BLOCK_ROBOT, m->draft->at, alone[i])) {
            (void)complain(m, place_of(m, alone[i]), "keys",
                           "'%s' and 'lines' cannot be used together: each line has its own",
                           alone[i]);
        }
    }
    if (m->draft->n_lines < 2) {
        (void)complain(m, place_of(m, "lines"), "lines",
                       "%s: two lines or more are wanted; one is said by 'family' and 'line'",
                       m->draft->name);
        return;
    }
    bool good = true;
    for (int i = 0; i < m->draft->n_lines; i++) {
        make_line(m, i);
        good = good && m->file->lines[i].family != NULL;
    }
    if (good) {
        def->lines = m->file->lines;
        def->n_lines = (uint8_t)m->draft->n_lines;
        def->family = def->lines[0].family;
        def->wiring = def->lines[0].wiring;
        def->baud_bps = def->lines[0].baud_bps;
    }
}

/* The line of a joint, with its complaints. */
static uint8_t line_of(const maker *m, int j)
{
    const grobo_i_joint_draft *draft = &m->draft->joint[j];
    const grobo_robot_def *def = &m->file->def;
    grobo_i_nearest nearest = {NULL, 0};
    bool told = joint_has(m, j, "line");
    if (told != (def->n_lines > 0)) {
        (void)complain(m, joint_place(m, j, "line"), told ? "keys" : "missing",
                       told ? "%s: 'line' of a joint needs 'lines' of the robot"
                            : "%s has no 'line': the robot has several",
                       draft->name);
        return 0;
    }
    for (uint8_t i = 0; told && i < def->n_lines; i++) {
        if (strcmp(def->lines[i].name, draft->line) == 0) {
            return i;
        }
        grobo_i_nearest_try(&nearest, draft->line, def->lines[i].name);
    }
    if (told) {
        (void)grobo_i_complain_word(m->reader, joint_place(m, j, "line"), "line called",
                                    draft->line, nearest_of(&nearest));
    }
    return 0;
}

/* How the servo of a joint talks. */
static const grobo_robot_family *family_of(const maker *m, int j)
{
    const grobo_robot_def *def = &m->file->def;
    return def->n_lines > 0 ? def->lines[m->file->joints[j].line].family : def->family;
}

static grobo_wiring wiring_of(const maker *m, int j)
{
    const grobo_robot_def *def = &m->file->def;
    return def->n_lines > 0 ? def->lines[m->file->joints[j].line].wiring : def->wiring;
}

static void make_family(maker *m)
{
    if (m->draft->n_lines > 0 || grobo_i_has_key(GROBO_I_BLOCK_ROBOT, m->draft->at, "lines")) {
        make_lines(m);
        return;
    }
    if (!grobo_i_has_key(GROBO_I_BLOCK_ROBOT, m->draft->at, "family")) {
        (void)complain(m, m->draft->place, "missing", "%s has no 'family'", "the file");
        return;
    }
    const grobo_robot_family *family = family_called(m, m->draft->family, place_of(m, "family"));
    if (family == NULL) {
        return;
    }
    grobo_robot_def *def = &m->file->def;
    def->family = family;
    def->wiring = def->family->wiring;
    def->baud_bps = def->family->baud_bps;
    if (*m->draft->wiring != '\0') {
        int wiring = word_of(m, "wiring", m->draft->wiring, wirings);
        def->wiring = wiring == 0 ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS;
    }
    if (m->draft->line.baud_bps > 0) {
        def->baud_bps = (uint32_t)m->draft->line.baud_bps;
    }
}

static bool has_safety(const maker *m, const char *key)
{
    return grobo_i_has_key(GROBO_I_BLOCK_SAFETY, m->draft->safety.at, key);
}

static void make_safety(maker *m)
{
    static const char *const exits[] = {"off", "hold", "sit", NULL};
    const grobo_i_safety_draft *safety = &m->draft->safety;
    grobo_robot_def *def = &m->file->def;
    grobo_safety_limits *limits = &def->limits;
    *limits = m->driver.limits;
    def->on_exit = m->driver.on_exit;
    def->arm =
        grobo_i_has_key(GROBO_I_BLOCK_ROBOT, m->draft->at, "arm") ? m->draft->arm : m->driver.arm;
    if (*m->draft->exit != '\0') {
        int word = word_of(m, "exit", m->draft->exit, exits);
        def->on_exit = word < 0 ? def->on_exit : (grobo_exit_policy)(word + GROBO_EXIT_OFF);
    }
    if (has_safety(m, "temperature_c")) {
        limits->temperature_c = (int16_t)safety->temperature_c;
    }
    if (has_safety(m, "lost_replies")) {
        limits->lost_replies = (int16_t)safety->lost_replies;
    }
    if (has_safety(m, "voltage_mv")) {
        limits->voltage_mv = (int32_t)safety->voltage_mv;
    }
    if (has_safety(m, "current_ma")) {
        limits->current_ma = (int32_t)safety->current_ma;
    }
    if (has_safety(m, "current_ms")) {
        limits->current_us = (int64_t)safety->current_ms * 1000;
    }
    if (has_safety(m, "approach_deg_s")) {
        limits->approach_rad_s = grobo_rad_from_deg(safety->approach_deg_s);
    }
    if ((limits->current_ma > 0) != (limits->current_us > 0)) {
        (void)complain(m, safety->place, "range", "%s: current_ma and current_ms belong together",
                       "safety");
    }
}

/* ---- joints --------------------------------------------------------------------------------- */

/* A servo that carries something is slower than its maker says. */
#define OF_ITS_SPEED 0.8

/* The servo of this name; NULL with a complaint. */
static const grobo_servo_model *servo_called(const maker *m, const grobo_robot_family *family,
                                             const char *name, grobo_i_place place)
{
    grobo_i_nearest nearest = {NULL, 0};
    const grobo_servo_model *servo;
    if (grobo_i_is_own_servo(name)) {
        return grobo_i_own_servo_find(m->reader, m->file, family, name, place);
    }
    for (size_t i = 0; (servo = grobo_i_family_row(family, i)) != NULL; i++) {
        if (strcmp(servo->name, name) == 0) {
            return servo;
        }
        grobo_i_nearest_try(&nearest, name, servo->name);
    }
    char what[96];
    snprintf(what, sizeof what, "servo of family %s called", family->name);
    (void)grobo_i_complain_word(m->reader, place, what, name, nearest_of(&nearest));
    return NULL;
}

static bool is_wheel(const maker *m, int j)
{
    return strcmp(m->draft->joint[j].type, "wheel") == 0;
}

/* A wheel comes to its full speed in this time where the file says nothing. */
#define WHEEL_RAMP_S 0.5

/* The joint's servo, and its speed where the file says none. */
static void find_servo(const maker *m, int j, grobo_joint *joint)
{
    const grobo_i_joint_draft *draft = &m->draft->joint[j];
    joint->servo = servo_called(m, family_of(m, j), draft->servo, joint_place(m, j, "servo"));
    if (joint->servo != NULL) {
        double own_deg_s =
            OF_ITS_SPEED * joint->servo->speed_dps / (joint->gear > 0 ? joint->gear : 1);
        joint->servo_model = joint->servo->number;
        joint->max_speed_rad_s =
            grobo_rad_from_deg(joint_has(m, j, "speed_deg_s") ? draft->speed_deg_s : own_deg_s);
        joint->accel_rad_s2 = !is_wheel(m, j) ? 0
                              : joint_has(m, j, "accel_deg_s2")
                                  ? grobo_rad_from_deg(draft->accel_deg_s2)
                                  : joint->max_speed_rad_s / WHEEL_RAMP_S;
    }
}

/* The joint of this name, else -1 with a complaint at `place`. */
static int find_joint(const maker *m, const char *name, grobo_i_place place)
{
    grobo_i_nearest nearest = {NULL, 0};
    for (int j = 0; j < m->draft->n_joints; j++) {
        if (strcmp(m->draft->joint[j].name, name) == 0) {
            return j;
        }
        grobo_i_nearest_try(&nearest, name, m->draft->joint[j].name);
    }
    (void)grobo_i_complain_word(m->reader, place, "joint called", name, nearest_of(&nearest));
    return -1;
}

/* How far servos on one shaft may be apart by what is read of them, where the file says nothing. */
#define APART_DEG 5

static bool follows(const maker *m, int j)
{
    return m->draft->joint[j].twin >= 0 || joint_has(m, j, "follows");
}

/* The joint that this one follows; -1 with a complaint. */
static int followed_by(const maker *m, int j)
{
    const grobo_i_joint_draft *draft = &m->draft->joint[j];
    int first = draft->twin >= 0 ? draft->twin
                                 : find_joint(m, draft->follows, joint_place(m, j, "follows"));
    if (first == j || (first >= 0 && follows(m, first))) {
        (void)complain(m, joint_place(m, j, "follows"), "follows",
                       first == j ? "%s: a joint cannot follow itself"
                                  : "%s: the joint that it follows must not follow another one",
                       draft->name);
        return -1;
    }
    return first;
}

/* What a joint has of the one that it follows, which is made by now. */
static void make_follower(const maker *m, int j)
{
    const grobo_i_joint_draft *draft = &m->draft->joint[j];
    grobo_joint *joint = &m->file->joints[j];
    int first = followed_by(m, j);
    if (draft->ratio == 0) {
        (void)complain(m, joint_place(m, j, "ratio"), "range", "%s: a ratio is not 0", draft->name);
    }
    if (first < 0 || draft->ratio == 0) {
        return;
    }
    const grobo_joint *of = &m->file->joints[first];
    if (of->line != joint->line) {
        (void)complain(m, joint_place(m, j, "follows"), "follows",
                       "%s: the joint that it follows must be on the same line", draft->name);
        return;
    }
    bool apart = joint_has(m, j, "apart_deg");
    joint->follows = (uint8_t)first;
    joint->ratio = draft->twin >= 0 ? 1 : draft->ratio;
    joint->apart_rad = grobo_rad_from_deg(apart              ? draft->apart_deg
                                          : draft->twin >= 0 ? APART_DEG
                                                             : 0);
    /* Not -0, which would be printed so. */
    joint->min_rad = fmin(of->min_rad * joint->ratio, of->max_rad * joint->ratio) + 0.0;
    joint->max_rad = fmax(of->min_rad * joint->ratio, of->max_rad * joint->ratio) + 0.0;
    joint->init_rad = of->init_rad * joint->ratio + 0.0;
    m->file->rest_rad[j] = m->file->rest_rad[first] * joint->ratio + 0.0;
}

/* Keys that say nothing without another one. */
static void check_coupling(const maker *m, int j)
{
    static const char *const of[][2] = {{"signs", "servos"},
                                        {"ratio", "follows"},
                                        {"apart_deg", NULL},
                                        {"init_deg", ""},
                                        {"rest_deg", ""}};
    bool servos = joint_has(m, j, "servos"), coupled = joint_has(m, j, "follows");
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        const char *need = of[i][1];
        bool alone = need == NULL      ? !servos && !coupled
                     : need[0] == '\0' ? coupled
                                       : !joint_has(m, j, need);
        if (joint_has(m, j, of[i][0]) && alone) {
            (void)grobo_i_complain(m->reader, GROBO_ERR_SYNTAX, "keys", joint_place(m, j, of[i][0]),
                                   need != NULL && need[0] == '\0'
                                       ? "%s: '%s' is that of the joint that it follows"
                                       : "%s: '%s' needs 'servos' or 'follows'",
                                   m->draft->joint[j].name, of[i][0]);
        }
    }
    if (servos && (joint_has(m, j, "sign") && joint_has(m, j, "signs"))) {
        (void)complain(m, joint_place(m, j, "sign"), "keys",
                       "%s: 'sign' and 'signs' cannot be used together", m->draft->joint[j].name);
    }
}

static void make_limits(const maker *m, int j, grobo_joint *joint)
{
    const grobo_i_joint_draft *draft = &m->draft->joint[j];
    if (is_wheel(m, j)) {
        joint->wheel = true;
        return; /* it goes to no angle */
    }
    if (follows(m, j)) {
        return; /* they are those of the joint that it follows */
    }
    joint->min_rad = grobo_rad_from_deg(draft->limits_deg[0]);
    joint->max_rad = grobo_rad_from_deg(draft->limits_deg[1]);
    joint->init_rad = grobo_rad_from_deg(draft->init_deg);
    m->file->rest_rad[j] =
        joint_has(m, j, "rest_deg") ? grobo_rad_from_deg(draft->rest_deg) : joint->init_rad;
    if (joint->min_rad >= joint->max_rad) {
        (void)complain(m, joint_place(m, j, "limits_deg"), "limits",
                       "%s: the lower limit comes first", draft->name);
    } else if (joint->init_rad < joint->min_rad || joint->init_rad > joint->max_rad) {
        (void)complain(m, joint_place(m, j, "init_deg"), "limits",
                       "%s: its initial angle is outside its limits", draft->name);
    } else if (m->file->rest_rad[j] < joint->min_rad || m->file->rest_rad[j] > joint->max_rad) {
        (void)complain(m, joint_place(m, j, "rest_deg"), "limits",
                       "%s: its resting angle is outside its limits", draft->name);
    }
}

static void check_unique(const maker *m, int j)
{
    const grobo_i_joint_draft *joint = &m->draft->joint[j];
    for (int i = 0; i < j; i++) {
        grobo_joint_mask found;
        const grobo_group as_group = {m->file->joint_names[i], 1};
        const grobo_model one = GROBO_TABLE(grobo_model, GROBO_MODEL_JOINTS(m->file->joints),
                                            .groups = &as_group, .n_groups = 1);
        if (grobo_model_find_joints(&one, joint->name, strlen(joint->name), &found) >= 0) {
            (void)complain(m, joint_place(m, j, "name"), "twice", "two joints are called '%s'",
                           joint->name);
        }
        if (m->draft->joint[i].id == joint->id &&
            m->file->joints[i].line == m->file->joints[j].line) {
            (void)complain(m, joint_place(m, j, "id"), "twice", "%s has the id of another joint",
                           joint->name);
        }
    }
}

/* What people give the joint in. */
static void make_unit(const maker *m, int j, grobo_joint *joint)
{
    const grobo_i_joint_draft *draft = &m->draft->joint[j];
    if (joint_has(m, j, "mm_per_turn")) {
        joint->unit = GROBO_UNIT_MM;
        joint->unit_rad = grobo_rad_from_deg(360) / draft->mm_per_turn;
    }
    if (joint_has(m, j, "percent_deg")) {
        joint->unit = GROBO_UNIT_PCT;
        joint->unit_zero_rad = grobo_rad_from_deg(draft->percent_deg[0]);
        joint->unit_rad = grobo_rad_from_deg(draft->percent_deg[1] - draft->percent_deg[0]) / 100;
        if (joint->unit_rad == 0) {
            (void)complain(m, joint_place(m, j, "percent_deg"), "range",
                           "%s: 0 and 100 %% cannot be one angle", draft->name);
        }
    }
}

/* What the file says of a joint's motor; a key that is missing is 0, the servo's own. */
static void make_motor(const maker *m, int j)
{
    const grobo_i_motor_draft *motor = &m->draft->joint[j].motor;
    if (!joint_has(m, j, "motor")) {
        return;
    }
    m->file->motors[j] =
        (grobo_robot_motor){.kt_nm_a = motor->kt_nm_a,
                            .resistance_ohm = motor->resistance_ohm,
                            .armature_kgm2 = motor->armature_kgm2,
                            .torque_max_nm = motor->torque_max_nm,
                            .friction_nm = motor->friction_nm,
                            .viscous_nms = motor->viscous_nms,
                            .backlash_rad = grobo_rad_from_deg(motor->backlash_deg)};
    m->file->def.motors = m->file->motors;
}

static void make_joint(const maker *m, int j)
{
    const grobo_i_joint_draft *draft = &m->draft->joint[j];
    grobo_i_robot_file *file = m->file;
    grobo_joint *joint = &file->joints[j];
    memcpy(file->joint_names[j], draft->name, sizeof draft->name);
    *joint = (grobo_joint){.name = file->joint_names[j],
                           .free_current_ma = (uint16_t)draft->free_ma,
                           .motor = (uint8_t)draft->id,
                           .mirror = (uint8_t)j,
                           .mirror_sign = (int8_t)draft->mirror_sign,
                           .sign = draft->sign < 0 ? -1 : 0,
                           .turns = draft->turns,
                           .torque_limit_pct = (uint8_t)draft->torque_limit_pct,
                           .calibrated = m->draft->calibrated,
                           .zero_rad = grobo_rad_from_deg(draft->zero_deg),
                           .gear = draft->gear};
    if (draft->sign == 0 || draft->mirror_sign == 0) {
        const char *key = draft->sign == 0 ? "sign" : "mirror_sign";
        (void)complain(m, joint_place(m, j, joint_has(m, j, "signs") ? "signs" : key), "range",
                       "%s: 1 or -1 is wanted", joint_has(m, j, "signs") ? "signs" : key);
    }
    joint->line = line_of(m, j);
    if (draft->twin < 0) {
        check_coupling(m, j);
    }
    make_limits(m, j, joint);
    make_unit(m, j, joint);
    find_servo(m, j, joint);
    check_unique(m, j);
    if (*draft->mirror != '\0') {
        int mirror = find_joint(m, draft->mirror, joint_place(m, j, "mirror"));
        joint->mirror = (uint8_t)(mirror < 0 ? j : mirror);
    }
    if (joint_has(m, j, "readback_deg")) {
        file->readback[file->def.n_readback++] =
            (grobo_readback){grobo_rad_from_deg(draft->readback_deg), (uint8_t)j};
        file->def.readback = file->readback;
    }
    if (joint_has(m, j, "rest_deg")) {
        file->def.rest_rad = file->rest_rad;
    }
    make_motor(m, j);
}

static void check_mirrors(const maker *m)
{
    const grobo_joint *joints = m->file->joints;
    for (int j = 0; j < m->draft->n_joints; j++) {
        const grobo_joint *other = &joints[joints[j].mirror];
        if (other->mirror != j || other->mirror_sign != joints[j].mirror_sign) {
            (void)complain(m, joint_place(m, j, "mirror"), "mirror",
                           "%s: its partner in the mirror must name it, with the same mirror_sign",
                           joints[j].name);
        }
    }
}

/* A servo can do nothing that its joint asks for. */
static void refuse_servo(const maker *m, int j)
{
    const grobo_i_joint_draft *draft = &m->draft->joint[j];
    if (m->file->joints[j].wheel) {
        (void)grobo_i_complain(m->reader, GROBO_ERR_SYNTAX, "wheel", joint_place(m, j, "type"),
                               "%s: a %s cannot be a wheel: it has no mode for speeds", draft->name,
                               draft->servo);
        return;
    }
    (void)complain(m, joint_place(m, j, "limits_deg"), "limits",
                   "%s: its servo does not reach these limits", draft->name);
}

/* It tells no position, or its positions are bare counts. */
static const char *why_no_joint(const grobo_servo_model *servo)
{
    const grobo_servo_register *position = grobo_servo_register_of(servo, GROBO_ROLE_POSITION);
    return position == NULL     ? "%s: a %s does not tell where it stands"
           : servo->number == 0 ? "%s: %s stands for servos of which the scale is not known"
                                : "%s: the scale of a %s is not known";
}

/* Whether its family takes a joint. False: nothing more is to be said of any. */
static bool check_servo(maker *m, int j)
{
    const grobo_robot_family *family = family_of(m, j);
    int (*init)(grobo_driver *, const grobo_model *) = family->init[wiring_of(m, j)];
    grobo_joint joint = m->file->joints[j];
    int id = joint.motor;
    joint.line = 0;
    joint.mirror = joint.follows = 0;
    joint.ratio = joint.apart_rad = 0;
    joint.motor = 1; /* which each family has: its own is judged below */
    const grobo_model one = GROBO_TABLE(grobo_model, .name = m->file->model_name,
                                        GROBO_MODEL_JOINTS(&joint), .n_joints = 1);
    int result = init(&m->driver, &one);
    if (result == GROBO_ERR_UNSUPPORTED) {
        (void)grobo_i_complain(m->reader, GROBO_ERR_SYNTAX, "servo", joint_place(m, j, "servo"),
                               why_no_joint(joint.servo), joint.name, m->draft->joint[j].servo);
        return true;
    }
    bool calibrated = joint.calibrated;
    joint.calibrated = false;
    if (result == GROBO_ERR_ARG && calibrated && init(&m->driver, &one) == GROBO_OK) {
        (void)complain(m, place_of(m, "calibrated"), "calibrated",
                       "servos of family %s keep no calibration", family->name);
        return false;
    }
    bool limited = joint.torque_limit_pct > 0;
    joint.torque_limit_pct = 0;
    if (result == GROBO_ERR_ARG && limited && init(&m->driver, &one) == GROBO_OK) {
        (void)complain(m, joint_place(m, j, "torque_limit_pct"), "range",
                       "%s: its servo has no limit of torque", joint.name);
        return true;
    }
    const grobo_protocol *protocol = m->driver.protocol;
    if (result == GROBO_OK && (id < protocol->id_min || id > protocol->id_max)) {
        result = grobo_i_complain(m->reader, GROBO_ERR_SYNTAX, "range", joint_place(m, j, "id"),
                                  "%s: an id from %d to %d is wanted", joint.name, protocol->id_min,
                                  protocol->id_max);
    } else if (result < 0) {
        refuse_servo(m, j);
    }
    return true;
}

/* The family takes joints one by one here, to find the one that it refuses. */
static void check_servos(maker *m)
{
    const grobo_robot_def *def = &m->file->def;
    if (def->n_lines == 0 && def->family->init[def->wiring] == NULL) {
        (void)complain(m, place_of(m, "wiring"), "wiring", "servos of family %s cannot be wired so",
                       def->family->name);
        return;
    }
    int j = 0;
    while (j < m->draft->n_joints && check_servo(m, j)) {
        j++;
    }
}

/* ---- several lines -------------------------------------------------------------------------- */

static bool has_joint(const maker *m, int line)
{
    int j = 0;
    while (j < m->draft->n_joints && m->file->joints[j].line != line) {
        j++;
    }
    return j < m->draft->n_joints;
}

/* What the drivers of the lines are made of; the robot's own is in m->driver then. */
static void make_drivers(maker *m)
{
    grobo_robot_def *def = &m->file->def;
    grobo_lines *lines = &m->file->on_lines;
    for (int i = 0; i < def->n_lines; i++) {
        if (!has_joint(m, i)) {
            (void)complain(m, m->draft->lines[i].place, "missing", "line %s has no joints",
                           def->lines[i].name);
        }
    }
    if (def->n_lines == 0 || m->reader->result < 0) {
        return;
    }
    int result = grobo_lines_split(lines, &m->file->model);
    for (int i = 0; i < def->n_lines && result >= 0; i++) {
        grobo_lines_line *line = &lines->line[i];
        line->driver = (grobo_driver)GROBO_TABLE_INIT(grobo_driver);
        line->baud_bps = def->lines[i].baud_bps;
        line->echo = def->lines[i].echo;
        line->name = def->lines[i].name;
        line->port = def->lines[i].port;
        result = def->lines[i].family->init[def->lines[i].wiring](&line->driver, &line->model);
    }
    result = result < 0 ? result : grobo_lines_driver_init(&m->driver, lines, &m->file->model);
    if (result < 0) {
        (void)complain(m, place_of(m, "lines"), "lines", "%s: the lines do not fit together",
                       m->draft->name);
        return;
    }
    def->on_lines = lines;
}

/* What is safe for the robot is safe for each of its lines. */
static void share_limits(maker *m)
{
    for (int i = 0; i < m->file->def.n_lines; i++) {
        m->file->on_lines.line[i].driver.limits = m->file->def.limits;
    }
}

/* ---- groups, links -------------------------------------------------------------------------- */

static void make_groups(const maker *m)
{
    grobo_i_robot_file *file = m->file;
    for (int g = 0; g < m->draft->n_groups; g++) {
        const grobo_i_group_draft *draft = &m->draft->group[g];
        memcpy(file->group_names[g], draft->name, sizeof draft->name);
        grobo_joint_mask joints = draft->joints;
        for (int j = 0; j < m->draft->n_joints; j++) {
            int twin = m->draft->joint[j].twin;
            joints |= twin >= 0 && (joints & GROBO_JOINT_BIT(twin)) != 0 ? GROBO_JOINT_BIT(j) : 0;
        }
        file->groups[g] = (grobo_group){file->group_names[g], joints};
        file->model.n_groups = (uint8_t)g;
        grobo_joint_mask found;
        if (grobo_model_find_joints(&file->model, draft->name, strlen(draft->name), &found) >= 0) {
            (void)complain(m, draft->place, "twice", "a joint or group is called '%s' already",
                           draft->name);
        }
        if (draft->joints == 0) {
            (void)complain(m, draft->place, "missing", "group %s has no joints", draft->name);
        }
    }
    file->model.n_groups = (uint8_t)m->draft->n_groups;
}

static int find_parent(const maker *m, int index, grobo_i_place place)
{
    const char *name = m->draft->link[index].parent;
    grobo_i_nearest nearest = {NULL, 0};
    for (int i = 0; i < index; i++) {
        if (strcmp(m->draft->link[i].name, name) == 0) {
            return i;
        }
        grobo_i_nearest_try(&nearest, name, m->draft->link[i].name);
    }
    (void)grobo_i_complain_word(m->reader, place, "link above called", name, nearest_of(&nearest));
    return -1;
}

/* No body has less inertia about one axis than the other two leave it: their sum is no smaller. */
static void check_inertia(const maker *m, const grobo_i_link_draft *draft)
{
    const double *i = draft->inertia_kgm2;
    double most = fmax(i[0], fmax(i[1], i[2])), all = i[0] + i[1] + i[2];
    if (fmin(i[0], fmin(i[1], i[2])) < 0 || 2 * most > all * (1 + 1e-6)) {
        (void)complain(m, draft->place, "inertia",
                       "link %s: no body has such an inertia: xx, yy, zz, xy, xz, yz are wanted",
                       draft->name);
    }
}

/* The link of a name; -1: there is none, which is said. */
static int find_link(const maker *m, const char *name, grobo_i_place place)
{
    const grobo_robot_def *def = &m->file->def;
    grobo_i_nearest nearest = {NULL, 0};
    for (int i = 0; i < def->n_links; i++) {
        if (strcmp(def->links[i].name, name) == 0) {
            return i;
        }
        grobo_i_nearest_try(&nearest, name, def->links[i].name);
    }
    (void)grobo_i_complain_word(m->reader, place, "link called", name, nearest_of(&nearest));
    return -1;
}

static void make_payload(const maker *m)
{
    const grobo_i_payload_draft *payload = &m->draft->payload;
    grobo_robot_def *def = &m->file->def;
    def->payload_link = -1;
    if (*payload->link != '\0') {
        def->payload_link = (int8_t)find_link(m, payload->link, payload->place);
        def->payload_kg = def->payload_link < 0 ? 0 : payload->max_kg;
    }
}

static void make_feet(const maker *m)
{
    const grobo_i_draft *draft = m->draft;
    grobo_robot_def *def = &m->file->def;
    if (draft->n_feet == 1) {
        (void)complain(m, draft->foot[0].place, "feet", "one foot only, %s: two are wanted",
                       draft->foot[0].link);
    }
    for (int i = 0; i < draft->n_feet; i++) {
        const grobo_i_foot_draft *from = &draft->foot[i];
        grobo_robot_foot *foot = &def->feet[i];
        foot->link = (int8_t)find_link(m, from->link, from->place);
        memcpy(foot->sole_m, from->sole_m, sizeof foot->sole_m);
        memcpy(foot->half_m, from->half_m, sizeof foot->half_m);
    }
    if (draft->n_feet == 2 && def->feet[0].link == def->feet[1].link) {
        (void)complain(m, draft->foot[1].place, "feet", "both feet are the link '%s'",
                       draft->foot[1].link);
    }
    def->n_feet = draft->n_feet == 2 ? 2 : 0;
}

static void make_link(const maker *m, int index)
{
    const grobo_i_link_draft *draft = &m->draft->link[index];
    grobo_robot_link *link = &m->file->links[index];
    const double *axis = draft->axis;
    double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    memcpy(m->file->link_names[index], draft->name, sizeof draft->name);
    *link = (grobo_robot_link){
        .name = m->file->link_names[index], .parent = -1, .joint = -1, .mass_kg = draft->mass_kg};
    if (*draft->parent != '\0') {
        link->parent = (int8_t)find_parent(
            m, index, grobo_i_place_of(GROBO_I_BLOCK_LINK, draft->at, draft->place, "parent"));
    } else if (index > 0) {
        (void)complain(m, draft->place, "missing", "link %s has no 'parent'", draft->name);
    }
    if (*draft->joint != '\0') {
        link->joint = (int8_t)find_joint(
            m, draft->joint,
            grobo_i_place_of(GROBO_I_BLOCK_LINK, draft->at, draft->place, "joint"));
        if (link->joint >= 0 && m->file->joints[link->joint].unit == GROBO_UNIT_MM) {
            (void)complain(m, draft->place, "joint",
                           "link %s: a linear joint turns no link; leave 'joint' and 'axis' out",
                           draft->name);
        }
        if (fabs(length - 1) > 1e-6) {
            (void)complain(m, draft->place, "axis", "link %s: its 'axis' must be of length 1",
                           draft->name);
        }
    }
    for (int i = 0; i < 3; i++) {
        link->origin_m[i] = draft->origin_m[i];
        link->origin_rad[i] = grobo_rad_from_deg(draft->origin_deg[i]);
        link->axis[i] = draft->axis[i];
        link->com_m[i] = draft->com_m[i];
    }
    memcpy(link->inertia_kgm2, draft->inertia_kgm2, sizeof link->inertia_kgm2);
    check_inertia(m, draft);
    for (int i = 0; i < index; i++) {
        if (strcmp(m->draft->link[i].name, draft->name) == 0) {
            (void)complain(m, draft->place, "twice", "two links are called '%s'", draft->name);
        }
    }
}

/* ---- all of it ------------------------------------------------------------------------------ */

static void make_names(const maker *m)
{
    const grobo_i_draft *draft = m->draft;
    grobo_i_robot_file *file = m->file;
    memcpy(file->name, draft->name, sizeof file->name);
    memcpy(file->title, *draft->title != '\0' ? draft->title : draft->name, sizeof file->title);
    memcpy(file->model_name, *draft->model != '\0' ? draft->model : draft->name,
           sizeof file->model_name);
    memcpy(file->usb, draft->usb, sizeof file->usb);
    file->model = (grobo_model)GROBO_TABLE(grobo_model, .name = file->model_name,
                                           GROBO_MODEL_JOINTS(file->joints), .groups = file->groups,
                                           .n_joints = (uint8_t)draft->n_joints,
                                           .limit_slack_deg = draft->limit_slack_deg);
    file->def = (grobo_robot_def){.name = file->name,
                                  .title = file->title,
                                  .model = &file->model,
                                  .usb = file->usb,
                                  .links = file->links,
                                  .n_usb = (uint8_t)draft->n_usb,
                                  .n_links = (uint8_t)draft->n_links};
}

static bool has_same_joints(const grobo_model *a, const grobo_model *b)
{
    int j = 0;
    while (a->n_joints == b->n_joints && j < a->n_joints &&
           strcmp(grobo_i_joint(a, j)->name, grobo_i_joint(b, j)->name) == 0) {
        j++;
    }
    return j == a->n_joints;
}

/* The robots of the library whose motions this one may play. */
static void find_alike(const maker *m)
{
    grobo_i_robot_file *file = m->file;
    int n = 0;
    for (int i = 0; grobo_i_robot_defs[i] != NULL && n < GROBO_I_ALIKE_MAX; i++) {
        const grobo_model *known = grobo_i_robot_defs[i]->model;
        if (has_same_joints(&file->model, known)) {
            file->alike[n++] = known->name;
        }
    }
    file->alike[n] = NULL;
    file->model.alike = file->alike;
}

int grobo_i_robot_make(const grobo_i_draft *draft, grobo_i_robot_file *file)
{
    maker m = {.draft = draft,
               .reader = draft->reader,
               .file = file,
               .driver = GROBO_TABLE_INIT(grobo_driver)};
    make_names(&m);
    if (draft->n_joints == 0) {
        return complain(&m, place_of(&m, "joints"), "missing", "%s has no joints", draft->name);
    }
    make_family(&m);
    for (int j = 0; j < draft->n_joints && file->def.family != NULL; j++) {
        make_joint(&m, j);
    }
    for (int j = 0; j < draft->n_joints && m.reader->result == 0; j++) {
        if (follows(&m, j)) {
            make_follower(&m, j);
        }
    }
    if (m.reader->result < 0) {
        return m.reader->result;
    }
    find_alike(&m);
    check_mirrors(&m);
    check_servos(&m);
    make_drivers(&m);
    make_safety(&m);
    share_limits(&m);
    make_groups(&m);
    for (int i = 0; i < draft->n_links; i++) {
        make_link(&m, i);
    }
    make_payload(&m);
    make_feet(&m);
    if (m.reader->result < 0) {
        return m.reader->result;
    }
    int result = grobo_robot_def_driver(&file->def, file->def.wiring, &m.driver);
    return result < 0 ? complain(&m, draft->place, "robot", "%s: the parts do not fit together",
                                 draft->name)
                      : result;
}
