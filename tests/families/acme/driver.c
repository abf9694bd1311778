/* SPDX-License-Identifier: MIT */
/* The driver of registers, with what is special here: a goal has a time, and that is all. */
#include "src/servo/acme/acme.h"
#include "src/servo/table/family.h"

static int32_t wants(const grobo_joint *joint, const grobo_servo_model *servo,
                     grobo_register_role role, int32_t found)
{
    (void)joint;
    (void)servo;
    (void)role;
    return found;
}

static bool sync_read(const grobo_servo_model *servo)
{
    (void)servo;
    return false;
}

static const grobo_i_family family = {
    .tables = {&grobo_i_acme_table},
    .build = grobo_i_acme_build,
    .parse = grobo_i_acme_parse,
    .wants = wants,
    .frame_max_bytes = ACME_FRAME_MAX_BYTES,
    .time_max_ms = 30000,
    .overheated = ACME_OVERHEATED,
    .sync_read = sync_read,
    .pace = GROBO_I_PACE_TIME,
};

int grobo_i_acme_driver_init(grobo_driver *driver, const grobo_model *model)
{
    return grobo_i_table_driver(driver, model, &grobo_i_acme_protocol, &family);
}
