/* SPDX-License-Identifier: MIT */
/*
 * Tables of programs that were compiled with another version: driver, model, joints and protocol as
 * an older one (its structures end earlier) and a newer one (they are longer) has them.
 */
#include <string.h>

#include <grobo/core/bus.h>
#include <grobo/core/static.h>
#include <grobo/robot_file.h>

#include "tests/support/test.h"

#define END_OF(type, member) (offsetof(type, member) + sizeof(((type *)0)->member))
#define ROUND(bytes) (((bytes) + 7) / 8 * 8)
#define MORE 24 /* bytes that a newer version added */
#define NO_TABLE 0xA5

/* What a version knows. Behind it lies what is no part of the table. */
typedef struct version {
    const char *name;
    size_t driver, model, joint, protocol;
} version;

static const version versions[] = {
    {"the least", ROUND(END_OF(grobo_driver, stabilize)),
     ROUND(END_OF(grobo_model, limit_slack_deg)), ROUND(END_OF(grobo_joint, torque_limit_pct)),
     sizeof(grobo_protocol)},
    {"this one", sizeof(grobo_driver), sizeof(grobo_model), sizeof(grobo_joint),
     sizeof(grobo_protocol)},
    {"a newer one", sizeof(grobo_driver) + MORE, sizeof(grobo_model) + MORE,
     sizeof(grobo_joint) + MORE, sizeof(grobo_protocol) + MORE},
};

/* Tables of a program of a version. */
static struct {
    _Alignas(16) uint8_t driver[sizeof(grobo_driver) + 2 * MORE];
    _Alignas(16) uint8_t model[sizeof(grobo_model) + 2 * MORE];
    _Alignas(16) uint8_t joints[GROBO_JOINTS_MAX * (sizeof(grobo_joint) + 2 * MORE)];
    _Alignas(16) uint8_t protocol[sizeof(grobo_protocol) + 2 * MORE];
} theirs;

static void lay(void *at, size_t bytes, const void *from, size_t from_bytes)
{
    size_t most = bytes < from_bytes ? bytes : from_bytes;
    memset(at, 0, bytes);
    memcpy(at, from, most);
    memset((uint8_t *)at + bytes, NO_TABLE, MORE);
}

/* A library's model as a program of a version has it. */
static grobo_model *lay_model(const version *v, const grobo_model *from)
{
    for (int j = from->n_joints - 1; j >= 0; j--) {
        uint8_t *at = theirs.joints + (size_t)j * v->joint;
        uint8_t kept[MORE];
        memcpy(kept, at + v->joint, sizeof kept); /* of the joint behind */
        lay(at, v->joint, grobo_model_joint(from, j), sizeof(grobo_joint));
        if (j < from->n_joints - 1) {
            memcpy(at + v->joint, kept, sizeof kept);
        }
    }
    grobo_model *model = (void *)theirs.model;
    lay(model, v->model, from, sizeof *from);
    model->size = v->model;
    model->joint_size = v->joint;
    model->joints = (const void *)theirs.joints;
    return model;
}

static grobo_driver *lay_driver(const version *v, const grobo_robot_def *def)
{
    const grobo_model *model = lay_model(v, def->model);
    grobo_driver *driver = (void *)theirs.driver;
    memset(driver, NO_TABLE, sizeof theirs.driver);
    driver->size = v->driver;
    assert_int_equal(def->family->init[def->wiring](driver, model), GROBO_OK);
    assert_int_equal(driver->size, v->driver);
    for (size_t i = sizeof *driver; i < v->driver; i++) {
        assert_int_equal(theirs.driver[i], 0);
    }
    for (size_t i = v->driver; i < sizeof theirs.driver; i++) {
        assert_int_equal(theirs.driver[i], NO_TABLE); /* nothing is written behind it */
    }
    lay(theirs.protocol, v->protocol, driver->protocol, sizeof *driver->protocol);
    grobo_protocol *protocol = (void *)theirs.protocol;
    protocol->size = v->protocol;
    driver->protocol = protocol;
    return driver;
}

static void same_exchange(const grobo_exchange *a, const grobo_exchange *b)
{
    assert_int_equal(a->frame_bytes, b->frame_bytes);
    assert_memory_equal(a->frame, b->frame, a->frame_bytes);
    assert_int_equal(a->reply.bytes, b->reply.bytes);
}

/* A driver of theirs sends what the library's own does. */
static void same_frames(const grobo_driver *a, const grobo_driver *b)
{
    grobo_target target = {.posture = {0}};
    grobo_exchange of_a, of_b;
    int parts = 0, result = 1;
    grobo_posture_init_pose(&target.posture, a->model);
    for (int j = 0; j < a->model->n_joints; j++) {
        target.joint_time_us[j] = 10 * a->time_step_us;
    }
    for (; result > 0; parts += result) {
        memset(&of_a, 0, sizeof of_a);
        memset(&of_b, 0, sizeof of_b);
        result = a->posture(a, NULL, &target, parts, &of_a);
        assert_int_equal(b->posture(b, NULL, &target, parts, &of_b), result);
        assert_true(result >= 0);
        same_exchange(&of_a, &of_b);
    }
    assert_true(parts > 0);
    for (int j = 0; j < a->model->n_joints; j++) {
        memset(&of_a, 0, sizeof of_a);
        memset(&of_b, 0, sizeof of_b);
        assert_int_equal(a->sense(a, NULL, j, GROBO_SENSE_FULL, &of_a), GROBO_OK);
        assert_int_equal(b->sense(b, NULL, j, GROBO_SENSE_FULL, &of_b), GROBO_OK);
        same_exchange(&of_a, &of_b);
    }
}

TEST_EACH(version, versions, any_version_makes_the_same_robot)
{
    int robots = 0;
    for (const grobo_robot_def *def; (def = grobo_robot_def_at((size_t)robots)) != NULL; robots++) {
        grobo_driver own = GROBO_TABLE_INIT(grobo_driver);
        assert_int_equal(def->family->init[def->wiring](&own, def->model), GROBO_OK);
        grobo_driver *driver = lay_driver(row, def);
        assert_int_equal(grobo_driver_check(driver), GROBO_OK);
        same_frames(&own, driver);
        const grobo_model *model = driver->model;
        int last = model->n_joints - 1;
        const char *name = grobo_model_joint(def->model, last)->name;
        assert_int_equal(grobo_model_find_joint(model, name, strlen(name)), last);
        assert_string_equal(grobo_model_joint(model, last)->name, name);
        assert_null(grobo_model_joint(model, last + 1));
        assert_null(grobo_model_joint(model, -1));
        grobo_bus bus;
        grobo_bus_config line = {.protocol = driver->protocol};
        assert_int_equal(grobo_bus_init(&bus, &line), GROBO_OK);
        static grobo_robot robot;
        assert_int_equal(grobo_robot_init(&robot, driver, NULL, NULL, 0), GROBO_OK);
    }
    assert_true(robots > 0);
}

/* What a newer program sets and the library does not know is refused, not left out. */
TEST(what_a_newer_program_wants_is_refused)
{
    const version *newer = &versions[2];
    const grobo_robot_def *def = grobo_robot_def_at(0);
    grobo_driver *driver = lay_driver(newer, def);
    assert_int_equal(grobo_driver_check(driver), GROBO_OK);
    struct {
        uint8_t *at;
        int of_bus;
    } wants[] = {
        {theirs.driver + newer->driver - 1, GROBO_OK},
        {theirs.model + newer->model - 1, GROBO_OK},
        {theirs.joints + 3 * newer->joint - 1, GROBO_OK},
        {theirs.protocol + newer->protocol - 1, GROBO_ERR_ARG},
    };
    for (size_t i = 0; i < sizeof wants / sizeof *wants; i++) {
        *wants[i].at = 1;
        grobo_bus bus;
        grobo_bus_config line = {.protocol = driver->protocol};
        assert_int_equal(grobo_driver_check(driver), GROBO_ERR_ARG);
        assert_int_equal(grobo_bus_init(&bus, &line), wants[i].of_bus);
        *wants[i].at = 0;
        assert_int_equal(grobo_driver_check(driver), GROBO_OK);
    }
}

/* Sizes that no version had: not initialised, too short, absurd. */
TEST(nonsense_is_refused)
{
    const version *now = &versions[1];
    grobo_driver *driver = lay_driver(now, grobo_robot_def_at(0));
    grobo_model *model = (void *)theirs.model;
    grobo_protocol *protocol = (void *)theirs.protocol;
    size_t *sizes[] = {&driver->size, &model->size, &model->joint_size, &protocol->size};
    size_t least[] = {versions[0].driver - 8, versions[0].model - 8, versions[0].joint - 8,
                      sizeof(grobo_protocol) - 1};
    assert_int_equal(grobo_driver_check(driver), GROBO_OK);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        size_t good = *sizes[i], bad[] = {0, sizeof(size_t), least[i], (size_t)-1, 1u << 20};
        for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
            *sizes[i] = bad[k];
            assert_int_equal(grobo_driver_check(driver), GROBO_ERR_ARG);
        }
        *sizes[i] = good;
    }
    grobo_driver fresh = {.size = 0};
    assert_int_equal(grobo_rs30x_driver_init(&fresh, grobo_gr001_model(), grobo_rs30x_protocol()),
                     GROBO_ERR_ARG);
    assert_int_equal(grobo_driver_copy(&fresh, driver), GROBO_ERR_ARG);
    assert_int_equal(grobo_driver_copy(NULL, driver), GROBO_ERR_ARG);
    fresh.size = sizeof fresh;
    assert_int_equal(grobo_driver_copy(&fresh, NULL), GROBO_ERR_ARG);
}

/* A program changes a driver of a library of another version. */
TEST_EACH(version, versions, a_copy_keeps_its_own_size)
{
    const grobo_driver *gr001 = grobo_gr001_driver(GROBO_WIRING_BUS);
    grobo_driver *mine = (void *)theirs.driver;
    memset(mine, NO_TABLE, sizeof theirs.driver);
    mine->size = row->driver;
    assert_int_equal(grobo_driver_copy(mine, gr001), GROBO_OK);
    assert_int_equal(mine->size, row->driver);
    assert_ptr_equal(mine->model, gr001->model);
    assert_ptr_equal(mine->inspect, gr001->inspect);
    for (size_t i = row->driver; i < sizeof theirs.driver; i++) {
        assert_int_equal(theirs.driver[i], NO_TABLE);
    }
    assert_int_equal(grobo_driver_check(mine), GROBO_OK);
    same_frames(gr001, mine);
}
