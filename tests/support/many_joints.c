/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include <grobo/core/board.h>

#include "tests/support/many_joints.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

grobo_driver *many_joints(grobo_wiring wiring, int n)
{
    static char names[GROBO_JOINTS_MAX][8];
    static grobo_joint joints[GROBO_JOINTS_MAX];
    static grobo_model model = GROBO_TABLE_INIT(grobo_model);
    static grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    model = grobo_i_gr001_model;
    for (int j = 0; j < n; j++) {
        joints[j] = grobo_i_gr001_model.joints[j % grobo_i_gr001_model.n_joints];
        names[j][0] = 'J';
        names[j][1] = (char)('0' + j / 10);
        names[j][2] = (char)('0' + j % 10);
        joints[j].name = names[j];
        joints[j].motor = (uint8_t)(j + 1);
        joints[j].mirror = (uint8_t)j;
        joints[j].mirror_sign = 1;
    }
    model.joints = joints;
    model.n_groups = 0;
    model.n_joints = (uint8_t)n;
    assert_int_equal(grobo_rs30x_driver_init(&driver, &model, grobo_wiring_protocol(wiring)), 0);
    return &driver;
}

grobo_driver *many_unlike_joints(grobo_wiring wiring, int n)
{
    static grobo_joint joints[GROBO_JOINTS_MAX];
    static grobo_model model = GROBO_TABLE_INIT(grobo_model);
    grobo_driver *driver = many_joints(wiring, n);
    model = *driver->model;
    for (int j = 0; j < n; j++) {
        joints[j] = model.joints[j];
        joints[j].min_rad = -grobo_rad_from_deg(70 + j);
        joints[j].max_rad = grobo_rad_from_deg(70 + j);
        joints[j].init_rad = 0;
        joints[j].max_speed_rad_s = grobo_rad_from_deg(100 + 5 * j);
    }
    model.joints = joints;
    driver->model = &model;
    return driver;
}
