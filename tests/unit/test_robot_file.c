/* SPDX-License-Identifier: MIT */
/* Files of robots: what is read, and each mistake with its line and column. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <jansson.h>

#include <grobo/core/lines.h>
#include <grobo/core/unit.h>
#include <grobo/posture.h>
#include <grobo/robot_file.h>

#include "src/robots/file/draft.h"
#include "tests/support/counted_mem.h"
#include "tests/support/test.h"

static grobo_diagnostics *list;

typedef struct text_source {
    const char *at;
    size_t left, at_once;
} text_source;

static int read_text(void *ctx, void *buffer, size_t size)
{
    text_source *source = ctx;
    size_t n = source->left < size ? source->left : size;
    n = n < source->at_once ? n : source->at_once;
    memcpy(buffer, source->at, n);
    source->at += n;
    source->left -= n;
    return (int)n;
}

static int read_def(const char *text, const grobo_mem *mem, grobo_robot_def **def)
{
    text_source source = {text, strlen(text), 100};
    grobo_diagnostics_clear(list);
    return grobo_robot_def_read(&(grobo_source){read_text, &source}, "arm.yaml", list, mem, def);
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

/* ---- what is read --------------------------------------------------------------------------- */

static const char whole[] =
    "# An arm.\n"
    "name: arm\n"
    "title: An arm for a test\n"
    "model: ARM\n"
    "family: feetech\n"
    "line: {baud: 500000}\n"
    "usb: [\"1a86:55d3\", \"0403:6014\"]\n"
    "safety: {temperature_c: 55, lost_replies: 3, current_ma: 900,\n"
    "  current_ms: 200, voltage_mv: 5500, approach_deg_s: 20}\n"
    "exit: sit\n"
    "arm: false\n"
    "limit_slack_deg: 0.5\n"
    "joints:\n"
    "  - {name: lift, id: 7, servo: STS3215, limits_deg: [-90, 45],\n"
    "     init_deg: 5, rest_deg: -10, speed_deg_s: 100, free_ma: 80,\n"
    "     sign: -1, zero_deg: 10, gear: 1.5, mirror: drop,\n"
    "     mirror_sign: -1, readback_deg: 2}\n"
    "  - {name: drop, id: 8, servo: SCS0009, limits_deg: [-30, 30],\n"
    "     mirror: lift, mirror_sign: -1}\n"
    "groups:\n"
    "  - {name: one, joints: [drop]}\n"
    "  - {name: both, joints: [one, lift]}\n"
    "links:\n"
    "  - {name: base}\n"
    "  - {name: boom, parent: base, joint: lift, origin_m: [0, 0.1, -0.2],\n"
    "     origin_deg: [90, 0, -90], axis: [0, 0, -1], mass_kg: 0.25}\n";

/* Behind a gear a joint turns slower than its servo. */
TEST(a_gear_takes_speed)
{
    grobo_robot_def *def = NULL;
    assert_int_equal(
        read_def("name: arm\nfamily: feetech\njoints:\n"
                 "  - {name: a, id: 1, servo: STS3215, limits_deg: [-9, 9]}\n"
                 "  - {name: b, id: 2, servo: STS3215, limits_deg: [-9, 9], gear: 4}\n",
                 NULL, &def),
        GROBO_OK);
    const grobo_joint *joints = def->model->joints;
    assert_true(joints[1].max_speed_rad_s > 0);
    assert_true(joints[0].max_speed_rad_s == 4 * joints[1].max_speed_rad_s);
    grobo_robot_def_free(def);
}

TEST(each_robot_of_the_library_is_found_by_its_name)
{
    int n = 0;

    for (; grobo_robot_def_at((size_t)n) != NULL; n++) {
        const grobo_robot_def *def = grobo_robot_def_at((size_t)n);
        assert_ptr_equal(grobo_robot_def_find(def->name), def);
    }
    assert_true(n >= 7);
    assert_null(grobo_robot_def_find("so10"));
    assert_null(grobo_robot_def_find("SO-101 (follower)"));
    assert_null(grobo_robot_def_find(""));
}

TEST(a_whole_file_is_read)
{
    grobo_robot_def *def = NULL;
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    assert_int_equal(read_def(whole, NULL, &def), GROBO_OK);
    grobo_diagnostic said;
    assert_int_equal(grobo_diagnostics_get(list, 0, &said), GROBO_ERR_ARG);
    assert_string_equal(def->name, "arm");
    assert_string_equal(def->title, "An arm for a test");
    assert_string_equal(def->model->name, "ARM");
    assert_string_equal(def->family->name, "feetech");
    assert_int_equal(def->baud_bps, 500000);
    assert_int_equal(def->wiring, GROBO_WIRING_BUS);
    assert_int_equal(def->n_usb, 2);
    assert_int_equal(def->usb[1].vendor, 0x0403);
    assert_int_equal(def->usb[1].product, 0x6014);
    const grobo_joint *lift = &def->model->joints[0], *drop = &def->model->joints[1];
    assert_true(lift->min_rad == grobo_rad_from_deg(-90) &&
                lift->max_rad == grobo_rad_from_deg(45));
    assert_true(lift->init_rad == grobo_rad_from_deg(5) &&
                lift->zero_rad == grobo_rad_from_deg(10));
    assert_true(lift->max_speed_rad_s == grobo_rad_from_deg(100) && lift->gear == 1.5);
    assert_int_equal(lift->sign, -1);
    assert_int_equal(lift->motor, 7);
    assert_int_equal(lift->servo_model, 777);
    assert_int_equal(lift->free_current_ma, 80);
    assert_int_equal(lift->mirror, 1);
    assert_int_equal(lift->mirror_sign, -1);
    assert_int_equal(drop->servo_model, 1284);
    assert_true(drop->max_speed_rad_s > 0);
    assert_true(def->rest_rad[0] == grobo_rad_from_deg(-10) && def->rest_rad[1] == 0);
    assert_int_equal(def->n_readback, 1);
    assert_true(def->readback[0].add_rad == grobo_rad_from_deg(2) && def->readback[0].joint == 0);
    assert_int_equal(def->model->n_groups, 2);
    assert_int_equal(def->model->groups[1].joints, 3);
    assert_true(def->model->limit_slack_deg == 0.5);
    assert_int_equal(def->n_links, 2);
    assert_int_equal(def->links[0].parent, -1);
    assert_int_equal(def->links[1].parent, 0);
    assert_int_equal(def->links[1].joint, 0);
    assert_true(def->links[1].origin_m[2] == -0.2 && def->links[1].axis[2] == -1);
    assert_true(def->links[1].origin_rad[0] == grobo_rad_from_deg(90));
    assert_true(def->links[1].mass_kg == 0.25);
    assert_int_equal(grobo_robot_def_driver(def, GROBO_WIRING_BUS, &driver), GROBO_OK);
    assert_int_equal(driver.limits.temperature_c, 55);
    assert_int_equal(driver.limits.lost_replies, 3);
    assert_int_equal(driver.limits.current_ma, 900);
    assert_int_equal(driver.limits.current_us, 200000);
    assert_int_equal(driver.limits.voltage_mv, 5500);
    assert_true(driver.limits.approach_rad_s == grobo_rad_from_deg(20));
    assert_int_equal(driver.on_exit, GROBO_EXIT_SIT);
    assert_false(driver.arm);
    grobo_robot_def_free(def);
}

TEST(what_is_not_said_is_the_familys)
{
    grobo_robot_def *def = NULL;
    assert_int_equal(read_def("name: a\nfamily: dynamixel2\njoints:\n"
                              "  - {name: x, id: 0, servo: XL330-M288, limits_deg: [-9, 9]}\n",
                              NULL, &def),
                     GROBO_OK);
    assert_string_equal(def->title, "a");
    assert_string_equal(def->model->name, "a");
    assert_int_equal(def->baud_bps, 57600);
    assert_int_equal(def->on_exit, GROBO_EXIT_HOLD);
    assert_true(def->arm);
    assert_int_equal(def->limits.temperature_c, 65);
    assert_int_equal(def->limits.lost_replies, 5);
    assert_true(def->rest_rad == NULL && def->readback == NULL);
    grobo_robot_def_free(def);
}

/* ---- what is refused ------------------------------------------------------------------------ */

/* Behind a head of three lines, with a joint of its own on the fourth. */
#define HEAD "name: a\nfamily: feetech\njoints:\n"
#define JOINT "  - {name: x, id: 1, servo: STS3215, limits_deg: [-9, 9]}\n"
#define LIMP(servo) "joints:\n  - {name: x, id: 1, servo: " servo ", limits_deg: [-9, 9]}\n"
#define WITH(more) HEAD "  - {name: x, id: 1, servo: STS3215, limits_deg: [-9, 9], " more "}\n"

typedef struct mistake {
    const char *text;
    unsigned line, column;
    const char *says;
    int error; /* 0: SYNTAX */
} mistake;

#define TWO(more)                                                                                  \
    HEAD "  - {name: x, servos: [1, 2], servo: STS3215, limits_deg: [-9, 9]" more "}\n"
#define AFTER(more) HEAD JOINT "  - {name: y, id: 2, servo: STS3215, " more "}\n"

#define LINEAR(range)                                                                              \
    HEAD "  - {name: x, id: 1, servo: STS3215, mm_per_turn: 36, limits_mm: " range "}\n"

/* Two lines on lines 2 to 4; line 6 is the first joint, on `l`. */
#define LINES(one, two) "name: a\nlines:\n  - {" one "}\n  - {" two "}\njoints:\n"
#define BOTH LINES("name: l, family: feetech", "name: r, family: dynamixel2")
#define ON_L "  - {name: x, id: 1, servo: STS3215, limits_deg: [-9, 9], line: l}\n"
#define ON_R "  - {name: y, id: 1, servo: XL430-W250, limits_deg: [-9, 9], line: r}\n"

static const mistake mistakes[] = {
    {BOTH ON_L "  - {name: y, id: 1, servo: XL430-W250, limits_deg: [-9, 9], line: right}\n", 7, 68,
     "no line called 'right'", 0},
    {BOTH ON_L ON_R "  - {name: z, id: 2, servo: STS3215, limits_deg: [-9, 9]}\n", 8, 5,
     "z has no 'line': the robot has several", 0},
    {BOTH ON_L ON_R "  - {name: z, id: 1, servo: STS3215, limits_deg: [-9, 9], line: l}\n", 8, 19,
     "z has the id of another joint", 0},
    {BOTH ON_L "  - {name: y, id: 1, servo: STS3215, limits_deg: [-9, 9], line: r}\n", 7, 29,
     "no servo of family dynamixel2 called 'STS3215'", 0},
    {BOTH ON_L, 4, 5, "line r has no joints", 0},
    {BOTH ON_L ON_R "  - {name: z, id: 2, servo: XL430-W250, follows: x, line: r}\n", 8, 50,
     "z: the joint that it follows must be on the same line", 0},
    {LINES("name: l, family: feetech", "name: l, family: feetech") ON_L, 4, 5,
     "two lines are called 'l'", 0},
    {LINES("name: l, family: feetech, port: /dev/a", "name: r, family: feetech, port: /dev/a") ON_L,
     4, 5, "two lines have the port '/dev/a'", 0},
    {LINES("name: l, family: feetech", "name: r, family: dynamite") ON_L, 4, 23,
     "no family called 'dynamite'", 0},
    {LINES("name: l, family: feetech", "name: r, family: feetech, wiring: board") ON_L, 4, 5,
     "servos of line r cannot be wired so", 0},
    {LINES("name: l, family: feetech", "name: r, family: feetech, baud: 1") ON_L, 4, 38,
     "baud: a whole number from 300", 0},
    {LINES("name: l, family: feetech", "name: r") ON_L, 4, 5, "a line has no 'family'", 0},
    {"name: a\nlines:\n  - {name: l, family: feetech}\njoints:\n" ON_L, 3, 3,
     "two lines or more are wanted", 0},
    {"name: a\nfamily: feetech\nlines:\n  - {name: l, family: feetech}\n"
     "  - {name: r, family: feetech}\njoints:\n" ON_L,
     2, 9, "'family' and 'lines' cannot be used together", 0},
    {HEAD "  - {name: x, id: 1, servo: STS3215, limits_deg: [-9, 9], line: l}\n", 4, 65,
     "x: 'line' of a joint needs 'lines' of the robot", 0},
    {TWO(", id: 3"), 4, 5, "cannot have 'servos' and 'id' together", 0},
    {TWO(", follows: x"), 4, 5, "cannot have 'follows' and 'servos' together", 0},
    {TWO(", signs: [1, 0]"), 4, 75, "signs: 1 or -1 is wanted", 0},
    {TWO(", signs: [1]"), 4, 75, "signs has 1 number, not 2", 0},
    {TWO(", sign: -1, signs: [1, 1]"), 4, 74, "'sign' and 'signs' cannot be used together", 0},
    {TWO(", apart_deg: 0.1"), 4, 79, "from 0.5 to 90", 0},
    {HEAD "  - {name: x, servos: [1], servo: STS3215, limits_deg: [-9, 9]}\n", 4, 23,
     "servos has 1 number, not 2", 0},
    {HEAD "  - {name: x, servos: [1, 1], servo: STS3215, limits_deg: [-9, 9]}\n", 4, 5,
     "x.2 has the id of another joint", 0},
    {HEAD "  - {name: xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx,\n"
          "     servos: [1, 2], servo: STS3215, limits_deg: [-9, 9]}\n",
     4, 5, "too long for a joint of two servos", 0},
    {TWO("") "  - {name: x.2, id: 3, servo: STS3215, limits_deg: [-9, 9]}\n", 5, 12,
     "two joints are called 'x.2'", 0},
    {WITH("apart_deg: 3"), 4, 70, "'apart_deg' needs 'servos' or 'follows'", 0},
    {WITH("signs: [1, 1]"), 4, 66, "'signs' needs 'servos' or 'follows'", 0},
    {WITH("ratio: 2"), 4, 66, "'ratio' needs 'servos' or 'follows'", 0},
    {WITH("limits_mm: [0, 9]"), 4, 70, "x: 'limits_mm' needs 'mm_per_turn'", 0},
    {WITH("mm_per_turn: 36, limits_mm: [0, 9]"), 4, 87,
     "x: 'limits_mm' and 'limits_deg' cannot be used together", 0},
    {WITH("mm_per_turn: 36, percent_deg: [0, 9]"), 4, 5,
     "x: 'percent_deg' and 'mm_per_turn' cannot be used together", 0},
    {WITH("percent_deg: [3, 3]"), 4, 72, "x: 0 and 100 % cannot be one angle", 0},
    {LINEAR("[9, 0]"), 4, 66, "x: the lower limit comes first", 0},
    {LINEAR("[0, 30]"), 4, 66, "x: its servo does not reach these limits", 0},
    {LINEAR("[0, 9]") "links:\n  - {name: a}\n"
                      "  - {name: b, parent: a, joint: x, axis: [0, 0, 1]}\n",
     7, 5, "link b: a linear joint turns no link; leave 'joint' and 'axis' out", 0},
    {AFTER("follows: z"), 5, 47, "no joint called 'z'", 0},
    {AFTER("follows: y"), 5, 47, "y: a joint cannot follow itself", 0},
    {AFTER("follows: x, ratio: 0"), 5, 57, "y: a ratio is not 0", 0},
    {AFTER("follows: x, limits_deg: [-9, 9]"), 5, 5, "'follows' and 'limits_deg' together", 0},
    {AFTER("follows: x, init_deg: 1"), 5, 60, "'init_deg' is that of the joint that it follows", 0},
    {AFTER("follows: x, ratio: 40"), 5, 5, "y: its servo does not reach these limits", 0},
    {AFTER("follows: x") "  - {name: z, id: 3, servo: STS3215, follows: y}\n", 6, 47,
     "the joint that it follows must not follow another one", 0},
    {"", 1, 1, "empty", 0},
    {"- a\n", 1, 1, "no mapping at the top", 0},
    {"name: [\n", 2, 1, "did not find expected", 0},
    {"family: feetech\njoints:\n" JOINT, 1, 1, "the file has no 'name'", 0},
    {"name: a\njoints:\n" JOINT, 1, 1, "the file has no 'family'", 0},
    {"name: a\nfamily: feetech\n", 1, 1, "the file has no 'joints'", 0},
    {"name: a\nfamily: feetech\njoints: []\n", 3, 9, "a has no joints", 0},
    {"nmae: a\n" HEAD JOINT, 1, 1, "no key in the file called 'nmae'; did you mean 'name'?", 0},
    {"colour: a\n" HEAD JOINT, 1, 1, "no key in the file called 'colour'", 0},
    {HEAD JOINT "name: b\n", 5, 1, "'name' is there twice in the file", 0},
    {HEAD JOINT "nope: b\nnope: c\n", 6, 1, "'nope' is there twice in the file", 0},
    {"name: a b\nfamily: feetech\njoints:\n" JOINT, 1, 7, "a name has letters", 0},
    {"name: m12\nfamily: feetech\njoints:\n" JOINT, 1, 7, "is the number of a motor", 0},
    {"name: \"\"\nfamily: feetech\njoints:\n" JOINT, 1, 7, "a name has letters", 0},
    {"name: {a: 1}\nfamily: feetech\njoints:\n" JOINT, 1, 7, "a mapping where a text belongs", 0},
    {"name: aaaaaaaaaabbbbbbbbbbccccccccccddddddddddeeeeeeeeeeffffffffffgggg\n"
     "family: feetech\njoints:\n" JOINT,
     1, 7, "at most 63 bytes", 0},
    {"name: a\nfamily: feetec\njoints:\n" JOINT, 2, 9, "no family called 'feetec'; did you mean",
     0},
    {"name: a\nfamily: futaba\njoints:\n" JOINT, 2, 9, "no family called 'futaba'", 0},
    {HEAD JOINT "wiring: buss\n", 5, 9, "did you mean 'bus'?", 0},
    {HEAD JOINT "wiring: board\n", 5, 9, "cannot be wired so", 0},
    {HEAD JOINT "exit: stay\n", 5, 7, "no exit called 'stay'", 0},
    {HEAD JOINT "arm: maybe\n", 5, 6, "'maybe' is not true or false", 0},
    {HEAD JOINT "limit_slack_deg: 6\n", 5, 18, "from 0 to 5", 0},
    {HEAD JOINT "line: {baud: fast}\n", 5, 14, "'fast' is not a number", 0},
    {HEAD JOINT "line: {baud: 1.5e3.2}\n", 5, 14, "is not a number", 0},
    {HEAD JOINT "line: {baud: 9600.5}\n", 5, 14, "a whole number from 300 to 4e+06", 0},
    {HEAD JOINT "line: {bauds: 9600}\n", 5, 8, "did you mean 'baud'?", 0},
    {HEAD JOINT "line: 9600\n", 5, 7, "'line': a text where a mapping belongs", 0},
    {HEAD JOINT "usb: [0403-6001]\n", 5, 7, "'0403-6001' is no USB id", 0},
    {HEAD JOINT "usb: [\"0403:600g\"]\n", 5, 7, "is no USB id", 0},
    {HEAD JOINT "safety: {temperature_c: 200}\n", 5, 25, "from 0 to 150", 0},
    {HEAD JOINT "safety: {current_ma: 200}\n", 5, 9, "current_ma and current_ms belong", 0},
    {HEAD "  - {name: x, id: 1, servo: STS3215}\n", 4, 5, "a joint has no 'limits_deg'", 0},
    {HEAD "  - {name: x, servo: STS3215, limits_deg: [-9, 9]}\n", 4, 5, "a joint has no 'id'", 0},
    {HEAD "  - x\n", 4, 5, "a joint: a text where a mapping belongs", 0},
    {HEAD "  - {name: x, id: 1, servo: STS3125, limits_deg: [-9, 9]}\n", 4, 29,
     "no servo of family feetech called 'STS3125'; did you mean 'STS3215'?", 0},
    {HEAD "  - {name: x, id: 254, servo: STS3215, limits_deg: [-9, 9]}\n", 4, 19, "0 to 253", 0},
    {HEAD "  - {name: x, id: -1, servo: STS3215, limits_deg: [-9, 9]}\n", 4, 19, "0 to 253", 0},
    {HEAD "  - {name: x, id: 1, servo: STS3215, limits_deg: [9, -9]}\n", 4, 50,
     "x: the lower limit comes first", 0},
    {HEAD "  - {name: x, id: 1, servo: STS3215, limits_deg: [-9]}\n", 4, 50, "has 1 number", 0},
    {HEAD "  - {name: x, id: 1, servo: STS3215, limits_deg: [-9, .nan]}\n", 4, 55, "not a finite",
     GROBO_ERR_NAN},
    {HEAD "  - {name: x, id: 1, servo: STS3215, limits_deg: [-9, 1e999]}\n", 4, 55,
     "is not a number", 0},
    {HEAD "  - {name: x, id: 1, servo: STS3215, limits_deg: [-270, 9]}\n", 4, 50,
     "x: its servo does not reach these limits", 0},
    {"name: a\nfamily: lx16a\njoints:\n  - {name: x, id: 1, servo: LX-16A, limits_deg: [-9, 9], "
     "torque_limit_pct: 40}\n",
     4, 76, "x: its servo has no limit of torque", 0},
    {"name: a\nfamily: lx16a\ncalibrated: true\n" LIMP("LX-16A"), 3, 13, "lx16a keep no calib", 0},
    {"name: a\nfamily: ics\ncalibrated: true\n" LIMP("KRS-3301"), 3, 13, "ics keep no calib", 0},
    {"name: a\nfamily: rs30x\ncalibrated: true\n" LIMP("RS304MD"), 3, 13, "rs30x keep no calib", 0},
    {WITH("torque_limit_pct: 0"), 4, 77, "from 1 to 100", 0},
    {WITH("init_deg: 10"), 4, 69, "x: its initial angle is outside its limits", 0},
    {WITH("rest_deg: -10"), 4, 69, "x: its resting angle is outside its limits", 0},
    {WITH("speed_deg_s: 0"), 4, 72, "from 1 to 10000", 0},
    {WITH("sign: 0"), 4, 65, "sign: 1 or -1 is wanted", 0},
    {WITH("mirror_sign: 0"), 4, 72, "mirror_sign: 1 or -1 is wanted", 0},
    {WITH("gear: 0"), 4, 65, "from 0.001 to 1000", 0},
    {WITH("turns: 2"), 4, 66, "'2' is not true or false", 0},
    {WITH("mirror: y"), 4, 67, "no joint called 'y'", 0},
    {HEAD JOINT "  - {name: X, id: 2, servo: STS3215, limits_deg: [-9, 9]}\n", 5, 12,
     "two joints are called 'X'", 0},
    {HEAD JOINT "  - {name: y, id: 1, servo: STS3215, limits_deg: [-9, 9]}\n", 5, 19,
     "y has the id of another joint", 0},
    {HEAD JOINT "  - {name: y, id: 2, servo: STS3215, limits_deg: [-9, 9], mirror: x}\n", 5, 67,
     "y: its partner in the mirror must name it", 0},
    {HEAD JOINT "groups:\n  - {name: g, joints: [y]}\n", 6, 24, "no joint or group above", 0},
    {HEAD JOINT "groups:\n  - {name: g, joints: []}\n", 6, 5, "group g has no joints", 0},
    {HEAD JOINT "groups:\n  - {name: x, joints: [x]}\n", 6, 5, "is called 'x' already", 0},
    {"name: a\nfamily: feetech\ngroups:\n  - {name: g, joints: [x]}\njoints:\n" JOINT, 4, 3,
     "groups come below the joints", 0},
    {HEAD JOINT "groups:\n  - {joints: [x]}\n", 6, 5, "a group has no 'name'", 0},
    {HEAD JOINT "links:\n  - {name: b}\n  - {name: c}\n", 7, 5, "link c has no 'parent'", 0},
    {HEAD JOINT "links:\n  - {name: b, parent: c}\n", 6, 23, "no link above called 'c'", 0},
    {HEAD JOINT "links:\n  - {name: b}\n  - {name: b, parent: b}\n", 7, 5, "two links", 0},
    {HEAD JOINT "links:\n  - {name: b, joint: y}\n", 6, 22, "no joint called 'y'", 0},
    {HEAD JOINT "links:\n  - {name: b, joint: x, axis: [0, 0, 0.5]}\n", 6, 5, "of length 1", 0},
    {HEAD JOINT "links:\n  - {name: b, origin_m: [0, 0, 1000]}\n", 6, 25, "from -100 to 100", 0},
    {HEAD JOINT "usb: &a []\ntitle: *a\n", 6, 8, "aliases are not known here", 0},
    {"x: &a {name: y}\n<<: *a\n" HEAD JOINT, 2, 5, "aliases are not known here", 0},
    {HEAD JOINT "---\nname: b\n", 5, 1, "another document", 0},
    {HEAD JOINT "title: \"a\\0b\"\n", 5, 8, "NUL", 0},
    {"name: a\nfamily: rs30x\njoints:\n  - {name: x, id: 0, servo: RS301CR, limits_deg: [-9, 9]}\n",
     4, 19, "an id from 1 to 127 is wanted", 0},
    {"name: a\nfamily: ics\njoints:\n  - {name: x, id: 32, servo: KRS-3301, limits_deg: [-9, 9]}\n",
     4, 19, "an id from 0 to 31 is wanted", 0},
    {"name: a\nfamily: dynamixel2\njoints:\n"
     "  - {name: x, id: 253, servo: XL330-M288, limits_deg: [-9, 9]}\n",
     4, 19, "an id from 0 to 252 is wanted", 0},
};

TEST(each_mistake_has_a_place)
{
    for (size_t i = 0; i < sizeof mistakes / sizeof mistakes[0]; i++) {
        const mistake *m = &mistakes[i];
        grobo_robot_def *def = NULL;
        int error = read_def(m->text, NULL, &def);
        bool found = false;
        grobo_diagnostic d = {0};
        assert_null(def);
        for (size_t k = 0; grobo_diagnostics_get(list, k, &d) == 0 && !found; k++) {
            found = d.line == m->line && d.column == m->column && strstr(d.message, m->says);
            assert_string_equal(d.file, "arm.yaml");
        }
        if (!found || error != (m->error ? m->error : GROBO_ERR_SYNTAX)) {
            fail_msg("%d, last said at %u:%u: %s\nwanted %u:%u: %s\n%s", error, d.line, d.column,
                     d.message ? d.message : "-", m->line, m->column, m->says, m->text);
        }
    }
}

/* One reading finds them all. */
TEST(all_mistakes_are_told)
{
    grobo_robot_def *def = NULL;
    assert_int_equal(read_def("name: a\nfamily: feetech\nlien: 3\nexit: {}\njoints:\n"
                              "  - {name: x, id: 999, servo: STS3215, limits_deg: [-9, nan]}\n",
                              NULL, &def),
                     GROBO_ERR_SYNTAX);
    assert_int_equal(grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR), 4);
}

TEST(too_much_is_refused)
{
    static char text[200000];
    grobo_robot_def *def = NULL;
    size_t n = (size_t)snprintf(text, sizeof text, HEAD);
    for (int i = 0; i <= GROBO_JOINTS_MAX; i++) {
        n += (size_t)snprintf(text + n, sizeof text - n,
                              "  - {name: x%d, id: %d, servo: STS3215, limits_deg: [-9, 9]}\n", i,
                              i);
    }
    assert_int_equal(read_def(text, NULL, &def), GROBO_ERR_CAP);
    n = (size_t)snprintf(text, sizeof text, "name: ");
    memset(text + n, '[', 100);
    text[n + 100] = '\0';
    assert_int_equal(read_def(text, NULL, &def), GROBO_ERR_CAP);
    memset(text, '#', sizeof text - 1); /* a comment without an end */
    text[sizeof text - 1] = '\0';
    assert_int_equal(read_def(text, NULL, &def), GROBO_ERR_CAP);
    assert_null(def);
}

TEST(every_allocation_may_fail)
{
    for (int n = 1;; n++) {
        counted_mem counter = {.fail_at = (size_t)n};
        const grobo_mem mem = counted_mem_of(&counter);
        grobo_robot_def *def = NULL;
        int error = read_def(whole, &mem, &def);
        grobo_robot_def_free(def);
        assert_int_equal(counter.bytes, 0);
        if (error == GROBO_OK) {
            assert_true(n > 3);
            return;
        }
        assert_int_equal(error, GROBO_ERR_NOMEM);
    }
}

/* ---- joints that follow others -------------------------------------------------------------- */

TEST(two_servos_make_a_joint_and_one_that_follows)
{
    grobo_robot_def *def = NULL;
    assert_int_equal(read_def("name: a\nfamily: feetech\njoints:\n"
                              "  - {name: y, id: 4, servo: STS3215, follows: x, ratio: -0.5}\n"
                              "  - {name: x, servos: [1, 2], servo: STS3215, limits_deg: [-20, 40],"
                              " init_deg: 10, zero_deg: 5, sign: -1, mirror_sign: -1}\n"
                              "  - {name: w, servos: [5, 6], servo: STS3215, limits_deg: [-9, 9],"
                              " signs: [1, 1], zero_deg: 5, apart_deg: 3}\n"
                              "groups:\n  - {name: g, joints: [x]}\n",
                              NULL, &def),
                     0);
    const grobo_joint *j = def->model->joints;
    assert_int_equal(def->model->n_joints, 5);
    assert_string_equal(j[2].name, "x.2");
    assert_int_equal(j[1].motor, 1);
    assert_int_equal(j[2].motor, 2);
    assert_int_equal(j[2].follows, 1);
    assert_true(j[1].ratio == 0 && j[2].ratio == 1 && j[0].ratio == -0.5);
    assert_int_equal(j[0].follows, 1);
    assert_int_equal(j[1].sign, -1);
    assert_int_equal(j[2].sign, 0); /* the other way round */
    assert_true(fabs(j[1].zero_rad + j[2].zero_rad) < 1e-9 && j[1].zero_rad > 0);
    assert_true(fabs(grobo_deg_from_rad(j[2].apart_rad) - 5) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(j[4].apart_rad) - 3) < 1e-9);
    assert_true(j[0].apart_rad == 0);
    assert_true(j[4].zero_rad == j[3].zero_rad && j[4].sign >= 0 && j[3].sign >= 0);
    assert_true(fabs(grobo_deg_from_rad(j[0].min_rad) + 20) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(j[0].max_rad) - 10) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(j[0].init_rad) + 5) < 1e-9);
    assert_int_equal(def->model->groups[0].joints, 6);
    grobo_robot_def_free(def);
}

/* ---- several lines --------------------------------------------------------------------------- */

TEST(a_robot_may_have_several_lines)
{
    grobo_robot_def *def = NULL;
    assert_int_equal(
        read_def(
            "name: a\nlines:\n"
            "  - {name: l, family: feetech, baud: 500000, port: /dev/a}\n"
            "  - {name: r, family: dynamixel2, echo: true}\n"
            "safety: {temperature_c: 50}\nexit: off\narm: false\njoints:\n"
            "  - {name: y, id: 1, servo: XL430-W250, limits_deg: [-9, 9], line: r, mirror: x}\n"
            "  - {name: x, id: 1, servo: STS3215, limits_deg: [-9, 9], line: l, mirror: y}\n"
            "  - {name: w, servos: [2, 3], servo: STS3215, limits_deg: [-9, 9], line: l}\n",
            NULL, &def),
        0);
    assert_int_equal(def->n_lines, 2);
    assert_string_equal(def->lines[0].name, "l");
    assert_string_equal(def->lines[0].port, "/dev/a");
    assert_null(def->lines[1].port);
    assert_int_equal(def->lines[0].baud_bps, 500000);
    assert_int_equal(def->lines[1].baud_bps, def->lines[1].family->baud_bps);
    assert_string_equal(def->lines[1].family->name, "dynamixel2");
    assert_true(def->lines[1].echo && !def->lines[0].echo);
    assert_int_equal(def->model->joints[0].line, 1);
    assert_int_equal(def->model->joints[3].line, 0);
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    assert_int_equal(grobo_robot_def_driver(def, GROBO_WIRING_BUS, &driver), 0);
    assert_int_equal(driver.on_exit, GROBO_EXIT_OFF);
    assert_false(driver.arm);
    const grobo_lines *lines = grobo_driver_lines(&driver);
    assert_non_null(lines);
    assert_int_equal(lines->on[0], 2 + 4 + 8);
    assert_int_equal(lines->line[0].baud_bps, 500000);
    assert_int_equal(lines->line[1].driver.limits.temperature_c, 50);
    assert_string_equal(lines->line[0].port, "/dev/a");
    assert_int_equal(lines->line[0].model.joints[2].follows, 1);
    assert_int_equal(grobo_robot_def_driver(def, GROBO_WIRING_BOARD, &driver),
                     GROBO_ERR_UNSUPPORTED);
    grobo_robot_def_free(def);
}

/* ---- units ---------------------------------------------------------------------------------- */

TEST(a_joint_may_be_linear_or_a_gripper)
{
    grobo_robot_def *def = NULL;
    assert_int_equal(
        read_def("name: a\nfamily: feetech\njoints:\n"
                 "  - {name: x, id: 1, servo: STS3215, limits_mm: [-4, 10], mm_per_turn: 36,"
                 " init_mm: 2, rest_mm: 1, speed_mm_s: 3}\n"
                 "  - {name: y, id: 2, servo: STS3215, limits_deg: [-10, 90],"
                 " percent_deg: [90, -10]}\n"
                 "  - {name: z, id: 3, servo: STS3215, limits_deg: [-10, 90]}\n",
                 NULL, &def),
        0);
    const grobo_joint *j = def->model->joints;
    assert_int_equal(j[0].unit, GROBO_UNIT_MM);
    assert_true(fabs(grobo_deg_from_rad(j[0].min_rad) + 40) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(j[0].max_rad) - 100) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(j[0].init_rad) - 20) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(def->rest_rad[0]) - 10) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(j[0].max_speed_rad_s) - 30) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(j[0].unit_rad) - 10) < 1e-9 && j[0].unit_zero_rad == 0);
    assert_int_equal(j[1].unit, GROBO_UNIT_PCT);
    assert_true(fabs(grobo_deg_from_rad(j[1].unit_zero_rad) - 90) < 1e-9);
    assert_true(fabs(grobo_deg_from_rad(j[1].unit_rad) + 1) < 1e-9);
    assert_int_equal(j[2].unit, GROBO_UNIT_DEG);
    assert_true(j[2].unit_rad == 0);
    grobo_robot_def_free(def);
}

/* ---- the schema ----------------------------------------------------------------------------- */

TEST(the_schema_has_the_same_keys)
{
    static const char *const names[] = {
        [GROBO_I_BLOCK_LINE] = "line",   [GROBO_I_BLOCK_SAFETY] = "safety",
        [GROBO_I_BLOCK_JOINT] = "joint", [GROBO_I_BLOCK_GROUP] = "group",
        [GROBO_I_BLOCK_LINK] = "link",   [GROBO_I_BLOCK_PAYLOAD] = "payload",
        [GROBO_I_BLOCK_MOTOR] = "motor", [GROBO_I_BLOCK_FOOT] = "foot",
        [GROBO_I_BLOCK_LINES] = "lines",
    };
    json_error_t error;
    json_t *schema = json_load_file("docs/robot.schema.json", 0, &error);
    if (schema == NULL) {
        fail_msg("docs/robot.schema.json:%d: %s", error.line, error.text);
    }
    for (int block = 0; block < GROBO_I_BLOCKS; block++) {
        const json_t *rule = block == GROBO_I_BLOCK_ROBOT
                                 ? schema
                                 : json_object_get(json_object_get(schema, "$defs"), names[block]);
        const json_t *keys = json_object_get(rule, "properties");
        const char *key;
        size_t n = 0;
        for (; (key = grobo_i_robot_key((grobo_i_block)block, n)) != NULL; n++) {
            if (json_object_get(keys, key) == NULL) {
                fail_msg("the schema does not know '%s'", key);
            }
        }
        assert_int_equal(json_object_size(keys), n);
        assert_true(json_is_false(json_object_get(rule, "additionalProperties")));
        const json_t *needed = json_object_get(rule, "required");
        size_t n_needed = 0;
        for (size_t i = 0; i < n; i++) {
            key = grobo_i_robot_key((grobo_i_block)block, i);
            bool is = false;
            for (size_t k = 0; k < json_array_size(needed); k++) {
                is |= strcmp(json_string_value(json_array_get(needed, k)), key) == 0;
            }
            assert_int_equal(is, grobo_i_robot_key_needed((grobo_i_block)block, i));
            n_needed += is;
        }
        assert_int_equal(n_needed, json_array_size(needed));
    }
    json_decref(schema);
}

TESTS_BETWEEN(set_up, tear_down)
