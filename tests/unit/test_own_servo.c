/* SPDX-License-Identifier: MIT */
/* Servo models of a user's own beside a robot's file: of every model of the library one that is
 * like it, and each mistake with the file and line that it is in. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/sim_static.h>
#include <grobo/posture.h>
#include <grobo/robot_file.h>

#include "src/robots/file/families.h"
#include "src/robots/file/own.h"
#include "tests/support/counted_mem.h"
#include "tests/support/test.h"

static grobo_diagnostics *list;

typedef struct text_source {
    const char *at;
    size_t left;
} text_source;

/* One file beside the robot's. */
typedef struct shelf {
    const char *path, *text;
    text_source source;
    int opened, closed;
} shelf;

static int read_text(void *ctx, void *buffer, size_t size)
{
    text_source *source = ctx;
    size_t n = source->left < size ? source->left : size;
    n = n < 50 ? n : 50;
    memcpy(buffer, source->at, n);
    source->at += n;
    source->left -= n;
    return (int)n;
}

static int open_text(void *ctx, const char *path, grobo_source *source)
{
    shelf *s = ctx;
    if (strcmp(path, s->path) != 0) {
        return GROBO_ERR_NOENT;
    }
    s->opened++;
    s->source = (text_source){s->text, strlen(s->text)};
    *source = (grobo_source){read_text, &s->source};
    return GROBO_OK;
}

static void close_text(void *ctx, const grobo_source *source)
{
    shelf *s = ctx;
    assert_ptr_equal(source->ctx, &s->source);
    s->closed++;
}

static int read_robot(const char *robot, shelf *s, const grobo_mem *mem, grobo_robot_def **def)
{
    text_source source = {robot, strlen(robot)};
    const grobo_i_beside beside = {open_text, close_text, s};
    grobo_diagnostics_clear(list);
    int result = grobo_i_robot_read(&(grobo_source){read_text, &source}, "arms/arm.yaml", &beside,
                                    list, mem, def);
    assert_int_equal(s->opened, s->closed);
    return result;
}

static int set_up(void)
{
    return grobo_diagnostics_new(NULL, &list);
}

static int tear_down(void)
{
    grobo_diagnostics_free(list);
    return 0;
}

#define ROBOT(family, own)                                                                         \
    "name: a\nfamily: " family "\njoints:\n"                                                       \
    "  - {name: x, id: 1, servo: " own ", limits_deg: [-9, 9]}\n"                                  \
    "  - {name: y, id: 2, servo: " own ", limits_deg: [-9, 9]}\n"
#define BESIDE ROBOT("feetech", "./mine.yaml")

/* ---- what is read --------------------------------------------------------------------------- */

TEST(a_model_of_ones_own_is_driven_and_simulated)
{
    static grobo_robot_sim sim;
    shelf s = {"arms/mine.yaml",
               "name: Mine\nlike: STS3215\nnumber: 4711\nspeed_dps: 111\nscale: [2048, 360, 1024]\n"
               "registers:\n  goal_position: {range: [-100, 2047]}\n"
               "  my_gain: {at: 50, bytes: 2, access: kept rw, range: [0, 500], default: 7}\n",
               {0},
               0,
               0};
    grobo_robot_def *def = NULL;
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    assert_int_equal(read_robot(BESIDE, &s, NULL, &def), GROBO_OK);
    assert_int_equal(s.opened, 1); /* for both joints */
    const grobo_joint *x = &def->model->joints[0];
    assert_ptr_equal(x->servo, def->model->joints[1].servo);
    assert_string_equal(x->servo->name, "Mine");
    assert_int_equal(x->servo_model, 4711);
    assert_true(fabs(x->max_speed_rad_s - grobo_rad_from_deg(0.8 * 111)) < 1e-9);
    const grobo_servo_register *gain = grobo_servo_register_named(x->servo, "my_gain");
    assert_non_null(gain);
    assert_int_equal(gain->factory, 7);
    assert_int_equal(grobo_servo_register_of(x->servo, GROBO_ROLE_GOAL)->max, 2047);
    assert_int_equal(grobo_servo_baud_code(x->servo, 1000000), 0);
    assert_string_equal(grobo_servo_series(x->servo)->name, "Feetech STS");
    assert_int_equal(grobo_robot_def_driver(def, GROBO_WIRING_BUS, &driver), GROBO_OK);
    assert_true(fabs(driver.angle_step_rad - grobo_rad_from_deg(360.0 / 2048)) < 1e-9);
    assert_int_equal(grobo_robot_def_sim(def, GROBO_WIRING_BUS, &sim), GROBO_OK);
    assert_ptr_equal(sim.servos[1], x->servo);
    static grobo_sim simulator;
    int32_t value = 0;
    assert_int_equal(grobo_sim_init(&simulator, &sim.config, 0), GROBO_OK);
    assert_int_equal(grobo_sim_get_register(&simulator, 0, gain->address, &value), GROBO_OK);
    assert_int_equal(value, 7);
    grobo_robot_def_free(def);
}

/* Two models of the library may have one number: the file's name is what counts. */
TEST(a_joint_has_the_model_that_its_file_names)
{
    static grobo_robot_sim sim;
    shelf s = {"", "", {0}, 0, 0};
    grobo_robot_def *def = NULL;
    assert_int_equal(read_robot(ROBOT("feetech", "STS3215-12V"), &s, NULL, &def), GROBO_OK);
    assert_int_equal(grobo_robot_def_sim(def, GROBO_WIRING_BUS, &sim), GROBO_OK);
    assert_string_equal(sim.servos[0]->name, "STS3215-12V");
    assert_int_equal(sim.config.supply_mv, 12000);
    grobo_robot_def_free(def);
}

/* Of every model: the same registers, its own name and number, and a simulator that runs. */
TEST(one_may_be_like_any_model)
{
    static grobo_sim simulator;
    static grobo_robot_sim sim;
    int n = 0;
    for (size_t f = 0; grobo_robot_family_at(f) != NULL; f++) {
        const grobo_robot_family *family = grobo_robot_family_at(f);
        const grobo_servo_model *like;
        for (size_t i = 0; (like = grobo_i_family_row(family, i)) != NULL; i++) {
            char robot[512], text[256];
            snprintf(robot, sizeof robot,
                     "name: a\nfamily: %s\njoints:\n"
                     "  - {name: x, id: 1, servo: ./mine.yaml, limits_deg: [-9, 9]}\n",
                     family->name);
            snprintf(text, sizeof text, "name: Mine\nlike: %s\nnumber: 4711\n", like->name);
            shelf s = {"arms/mine.yaml", text, {0}, 0, 0};
            grobo_robot_def *def = NULL;
            int result = read_robot(robot, &s, NULL, &def);
            if ((like->flags & GROBO_MODEL_NO_JOINT) != 0) {
                assert_int_equal(result, GROBO_ERR_SYNTAX);
                continue;
            }
            assert_int_equal(result, GROBO_OK);
            const grobo_servo_model *own = def->model->joints[0].servo;
            const grobo_servo_register *a, *b;
            for (size_t k = 0; (a = grobo_servo_register_row(like, k)) != NULL; k++) {
                b = grobo_servo_register_row(own, k);
                assert_non_null(b);
                assert_string_equal(a->name, b->name);
                assert_int_equal(a->address, b->address);
                assert_int_equal(a->factory, b->factory);
            }
            assert_int_equal(grobo_robot_def_sim(def, GROBO_WIRING_BUS, &sim), GROBO_OK);
            assert_int_equal(grobo_sim_init(&simulator, &sim.config, 0), GROBO_OK);
            grobo_sim_step(&simulator, 1000000);
            const grobo_servo_register *model = grobo_servo_register_of(own, GROBO_ROLE_MODEL);
            int32_t number = 4711;
            if (model != NULL) {
                assert_int_equal(grobo_sim_get_register(&simulator, 0, model->address, &number),
                                 GROBO_OK);
            }
            assert_int_equal(number, 4711);
            grobo_robot_def_free(def);
            n++;
        }
    }
    assert_true(n >= 50);
}

/* ---- what is refused ------------------------------------------------------------------------ */

#define LIKE "name: Mine\nlike: STS3215\n"
#define WITH(more) LIKE "registers:\n  " more "\n"

typedef struct mistake {
    const char *text;
    unsigned line, column;
    const char *says;
} mistake;

static const mistake mistakes[] = {
    {"", 1, 1, "empty"},
    {"[]\n", 1, 1, "not a servo model's file: no mapping at the top"},
    {"name: Mine\n", 1, 1, "it has no 'like'"},
    {"like: STS3215\n", 1, 1, "it has no 'name'"},
    {"name: Mine\nlike: STS3125\n", 2, 7,
     "no servo of family feetech called 'STS3125'; did you mean 'STS3215'?"},
    {"name: Mine\nlike: AX-12A\n", 2, 7, "no servo of family feetech called 'AX-12A'"},
    {"name: Mine\nnumber: 5\nlike: STS3215\n", 3, 7, "like: it comes before what differs"},
    {LIKE "like: STS3250\n", 3, 1, "'like' is there twice"},
    {LIKE "sped_dps: 5\n", 3, 1, "no key in the file called 'sped_dps'; did you mean 'speed_dps'?"},
    {LIKE "number: 70000\n", 3, 9, "not a whole number in range"},
    {LIKE "speed_dps: 0\n", 3, 12, "speed_dps: '0' is not a whole number in range"},
    {LIKE "current_ma: 0\n", 3, 13, "current_ma: '0' is not a whole number in range"},
    {LIKE "voltage_mv: 0\n", 3, 13, "voltage_mv: '0' is not a whole number in range"},
    {LIKE "rates: [[0, 9600], [0, 57600]]\n", 3, 20, "rates: code 0 is there twice"},
    {"name: Mine\nlike: STS3215\nscale: [4096, 360, 40000]\n", 3, 8,
     "scale: the middle 40000 is not within the range of max_position"},
    {LIKE "scale: [0, 360, 0]\n", 3, 8, "scale: at least 1 count"},
    {LIKE "scale: [4096, 360]\n", 3, 8, "scale has 2 numbers, not 3"},
    {LIKE "scale: [4096, 300, 0]\n", 2, 7, "scale: it must be as STS3215 has it"},
    {LIKE "keeps: limp\n", 2, 7, "keeps: it must be as STS3215 has it"},
    {LIKE "big_endian: true\n", 2, 7, "big_endian: it must be"},
    {LIKE "joint: false\n", 2, 7, "joint: it must be"},
    {LIKE "indirect: [[100, 120, 4]]\n", 2, 7, "indirect: it must be"},
    {LIKE "without: [torque]\n", 2, 7, "register torque: STS3215 has it"},
    {LIKE "without: [tork]\n", 3, 11, "there is no register 'tork'"},
    {WITH("goal_position: {at: 44}"), 4, 3, "register goal_position: only its range and default"},
    {WITH("goal_position: {role: none}"), 4, 3, "register goal_position: only its range"},
    {WITH("goal_speed: {unit: 1 rpm}"), 4, 3, "register goal_speed: only its range"},
    {WITH("goal_speed: {range: [-9, 0]}"), 4, 3, "register goal_speed: its range must reach 1"},
    {WITH("id: {default: 254}"), 4, 3, "register id: its default is outside its range"},
    {WITH("mine: {at: 90, role: goal}"), 4, 3, "register mine: its role is that of another one"},
    {WITH("mine: {at: 90, role: goal_current}"), 4, 3, "can have no role"},
    {WITH("mine: {at: 895, bytes: 2}"), 4, 3, "register mine: its address is too high"},
    {WITH("mine: {at: 90, access: kept rw}"), 4, 3, "is too high for one that is kept"},
    {WITH("mine: {at: 1024}"), 4, 14, "at"},
    {WITH("mine: {at: 43}"), 4, 3, "register mine: it shares a byte with goal_position"},
    {WITH("mine: {bytes: 2}"), 4, 3, "register mine: it has no 'at'"},
    {WITH("mine: {at: 90, range: [0, 256]}"), 4, 3, "register mine: its range does not fit"},
    {WITH("mine: {at: 90, bytes: 3}"), 4, 25, "bytes: 1, 2 or 4 are wanted"},
    {WITH("mine: {adress: 90}"), 4, 10, "no key in a register called 'adress'"},
    {LIKE "---\nname: b\n", 3, 1, "another document"},
    {LIKE "notes: &a x\nphysics: *a\n", 4, 10, "aliases are not known here"},
};

/* And not besides that its list is in no order. */
TEST(a_number_that_is_none_is_told_once)
{
    static const char *const texts[] = {WITH("mine: {at: 90, range: [3, .nan]}"),
                                        WITH("mine: {at: 90, range: [.inf, 3]}")};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        shelf s = {"arms/mine.yaml", texts[i], {0}, 0, 0};
        grobo_robot_def *def = NULL;
        grobo_diagnostic d;
        assert_true(read_robot(BESIDE, &s, NULL, &def) < 0);
        assert_int_equal(grobo_diagnostics_get(list, 0, &d), GROBO_OK);
        assert_non_null(strstr(d.message, "is not a finite number"));
        assert_true(grobo_diagnostics_get(list, 1, &d) < 0);
    }
}

TEST(each_mistake_is_in_the_servos_file)
{
    for (size_t i = 0; i < sizeof mistakes / sizeof mistakes[0]; i++) {
        const mistake *m = &mistakes[i];
        shelf s = {"arms/mine.yaml", m->text, {0}, 0, 0};
        grobo_robot_def *def = NULL;
        int error = read_robot(BESIDE, &s, NULL, &def);
        bool found = false;
        grobo_diagnostic d = {0};
        assert_null(def);
        for (size_t k = 0; grobo_diagnostics_get(list, k, &d) == 0 && !found; k++) {
            found = d.line == m->line && d.column == m->column && strstr(d.message, m->says);
            assert_string_equal(d.file, "arms/mine.yaml"); /* said once, for both joints */
        }
        if (!found || error != GROBO_ERR_SYNTAX) {
            fail_msg("%d, last said at %u:%u: %s\nwanted %u:%u: %s\n%s", error, d.line, d.column,
                     d.message ? d.message : "-", m->line, m->column, m->says, m->text);
        }
    }
}

/* The robot's file says where it is to be. */
TEST(a_file_that_is_not_there)
{
    static const struct {
        const char *servo;
        int error;
        const char *says;
    } rows[] = {{"./other.yaml", GROBO_ERR_NOENT, "arms/other.yaml: no such file"},
                {"./../mine.yaml", GROBO_ERR_SYNTAX, "a file beside the robot's file is wanted"},
                {"./a/../../mine.yaml", GROBO_ERR_SYNTAX, "a file beside the robot's file"},
                {"./", GROBO_ERR_SYNTAX, "a file beside the robot's file"},
                {"/etc/passwd", GROBO_ERR_SYNTAX, "no servo of family feetech called"}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char robot[256];
        shelf s = {"arms/mine.yaml", LIKE, {0}, 0, 0};
        grobo_robot_def *def = NULL;
        grobo_diagnostic d;
        snprintf(robot, sizeof robot,
                 "name: a\nfamily: feetech\njoints:\n"
                 "  - {name: x, id: 1, servo: %s, limits_deg: [-9, 9]}\n",
                 rows[i].servo);
        assert_int_equal(read_robot(robot, &s, NULL, &def), rows[i].error);
        assert_int_equal(grobo_diagnostics_get(list, 0, &d), 0);
        assert_string_equal(d.file, "arms/arm.yaml");
        assert_int_equal(d.line, 4);
        assert_int_equal(d.column, 29);
        assert_non_null(strstr(d.message, rows[i].says));
    }
}

/* A robot that is read from elsewhere than a file has nothing beside it. */
TEST(a_robot_that_is_no_file_has_no_files)
{
    text_source source = {BESIDE, strlen(BESIDE)};
    grobo_robot_def *def = NULL;
    grobo_diagnostic d;
    grobo_diagnostics_clear(list);
    assert_int_equal(
        grobo_robot_def_read(&(grobo_source){read_text, &source}, "arm.yaml", list, NULL, &def),
        GROBO_ERR_SYNTAX);
    assert_int_equal(grobo_diagnostics_get(list, 0, &d), 0);
    assert_non_null(strstr(d.message, "'./mine.yaml': only a robot that is read as a file"));
}

/* Kondo's, Hiwonder's and Futaba's servos have what their frames carry. */
TEST(a_fixed_family_gets_no_registers)
{
    static const char *const like[][2] = {
        {"lx16a", "LX-16A"}, {"ics", "KRS-3301"}, {"rs30x", "RS304MD"}};
    for (size_t i = 0; i < sizeof like / sizeof like[0]; i++) {
        char robot[256], text[256];
        grobo_robot_def *def = NULL;
        grobo_diagnostic d;
        snprintf(robot, sizeof robot,
                 "name: a\nfamily: %s\njoints:\n"
                 "  - {name: x, id: 1, servo: ./mine.yaml, limits_deg: [-9, 9]}\n",
                 like[i][0]);
        snprintf(text, sizeof text, "name: Mine\nlike: %s\nregisters:\n  mine: {at: 150}\n",
                 like[i][1]);
        shelf s = {"arms/mine.yaml", text, {0}, 0, 0};
        assert_int_equal(read_robot(robot, &s, NULL, &def), GROBO_ERR_SYNTAX);
        assert_int_equal(grobo_diagnostics_get(list, 0, &d), 0);
        assert_int_equal(d.line, 4);
        assert_non_null(strstr(d.message, "servos of this family have no registers of their own"));
    }
}

TEST(every_allocation_may_fail)
{
    for (int n = 1;; n++) {
        counted_mem counter = {.fail_at = (size_t)n};
        const grobo_mem mem = counted_mem_of(&counter);
        shelf s = {"arms/mine.yaml", LIKE, {0}, 0, 0};
        grobo_robot_def *def = NULL;
        int error = read_robot(BESIDE, &s, &mem, &def);
        grobo_robot_def_free(def);
        assert_int_equal(counter.bytes, 0);
        if (error == GROBO_OK) {
            assert_true(n > 4);
            return;
        }
        assert_int_equal(error, GROBO_ERR_NOMEM);
    }
}

TESTS_BETWEEN(set_up, tear_down)
