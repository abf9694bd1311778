/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/board.h>
#include <grobo/dxl2.h>
#include <grobo/feetech.h>
#include <grobo/rs30x.h>

#include "tools/grctl/servo/family.h"

static int rs30x_driver(grobo_driver *driver, const grobo_model *model)
{
    return grobo_rs30x_driver_init(driver, model, &grobo_rs30x_protocol);
}

static const family families[] = {
    {"rs30x", &grobo_rs30x_protocol, &grobo_rs30x_table, {115200}, rs30x_driver},
    {"dxl2",
     &grobo_dxl2_protocol,
     &grobo_dxl2_table,
     {57600, 1000000, 3000000},
     grobo_dxl2_driver_init},
    {"dxl1", &grobo_dxl1_protocol, &grobo_dxl1_table, {1000000, 57600}, grobo_dxl1_driver_init},
    {"sts",
     &grobo_feetech_protocol,
     &grobo_sts_table,
     {1000000, 115200},
     grobo_feetech_driver_init},
    {"scs",
     &grobo_feetech_protocol,
     &grobo_scs_table,
     {1000000, 115200},
     grobo_feetech_driver_init},
};

enum { FAMILIES = sizeof families / sizeof *families };

const family *family_row(size_t i)
{
    return i < FAMILIES ? &families[i] : NULL;
}

/* Behind a board are RS30x. */
static bool speaks(const family *f, const grobo_driver *driver)
{
    return f->protocol == (driver->protocol->relay ? &grobo_rs30x_protocol : driver->protocol);
}

bool family_is(const grobo_driver *driver, const char *name)
{
    for (size_t i = 0; i < FAMILIES; i++) {
        if (strcmp(families[i].name, name) == 0) {
            return speaks(&families[i], driver);
        }
    }
    return false;
}

const grobo_servo_model *family_numbered(const grobo_driver *driver, uint16_t number)
{
    const grobo_servo_model *found = NULL;
    for (size_t i = 0; i < FAMILIES && !found; i++) {
        if (speaks(&families[i], driver)) {
            found = grobo_servo_model_numbered(families[i].table, number);
        }
    }
    return found;
}

const grobo_servo_model *family_servo(const grobo_driver *driver, int id)
{
    int joint = grobo_model_joint_of_motor(driver->model, id);
    const grobo_servo_model *found =
        joint < 0 ? NULL : family_numbered(driver, driver->model->joints[joint].servo_model);
    for (size_t i = 0; i < FAMILIES && !found; i++) {
        found = speaks(&families[i], driver) ? &families[i].table->models[0] : NULL;
    }
    return found;
}

const grobo_servo_model *family_identify(const grobo_driver *driver, const uint8_t *bytes)
{
    const grobo_servo_model *found = NULL;
    for (size_t i = 0; i < FAMILIES && !found; i++) {
        if (speaks(&families[i], driver)) {
            const grobo_servo_model *any = &families[i].table->models[0];
            const grobo_servo_register *model = grobo_servo_register_of(any, GROBO_ROLE_MODEL);
            int32_t number = grobo_servo_register_get(any, model, bytes);
            found = grobo_servo_model_numbered(families[i].table, (uint16_t)number);
        }
    }
    return found;
}

int family_identity(const grobo_servo_model *servo, uint16_t *address)
{
    const grobo_servo_register *a = grobo_servo_register_of(servo, GROBO_ROLE_MODEL);
    const grobo_servo_register *b = grobo_servo_register_of(servo, GROBO_ROLE_FIRMWARE);
    a = a ? a : grobo_servo_register_of(servo, GROBO_ROLE_ID);
    b = b ? b : a;
    if (!a) {
        return 0;
    }
    int end = a->address + a->bytes > b->address + b->bytes ? a->address + a->bytes
                                                            : b->address + b->bytes;
    *address = a->address < b->address ? a->address : b->address;
    return end - *address;
}

const char *family_of(const grobo_servo_model *servo)
{
    size_t i = 0;
    while (i < FAMILIES - 1 && (!servo || families[i].table != servo->table)) {
        i++;
    }
    return families[i].name;
}

const char *family_name(const grobo_driver *driver)
{
    return family_of(family_servo(driver, driver->model->joints[0].motor));
}

const grobo_driver *family_driver(const family *f)
{
    static grobo_driver driver;
    static grobo_joint joint;
    static const grobo_group all = {.name = "all", .joints = 1};
    static const grobo_model model = {
        .name = "any", .joints = &joint, .groups = &all, .n_joints = 1, .n_groups = 1};
    joint = (grobo_joint){.name = "any",
                          .min_rad = -0.1,
                          .max_rad = 0.1,
                          .max_speed_rad_s = 1,
                          .servo_model = f->table->models[0].number,
                          .motor = f->protocol->id_max,
                          .mirror_sign = 1};
    return f->driver(&driver, &model) < 0 ? NULL : &driver;
}
