/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/posture.h>

#include "tools/grctl/sim/chain.h"

/* No servo of the table turns further than its registers CW_LIMIT and CCW_LIMIT allow. */
#define RANGE_DEG 150.0

static int refuse(app *a, const char *item, size_t length, const char *why)
{
    char shown[64];
    snprintf(shown, sizeof shown, "%.*s", (int)(length < 40 ? length : 40), item);
    app_make_one_line(shown);
    return app_fail(a, EXIT_USAGE, "ARG", "sim: --servo: '%s': %s", shown, why);
}

static int refuse_type(app *a, const char *item, size_t length)
{
    char why[256];
    size_t used = (size_t)snprintf(why, sizeof why, "unknown type; known:");
    for (size_t i = 0; grobo_sim_type_row(i) && used < sizeof why; i++)
        used += (size_t)snprintf(why + used, sizeof why - used, " %s", grobo_sim_type_row(i)->name);
    return refuse(a, item, length, why);
}

static void add(sim_chain *chain, int id, const grobo_sim_type *type)
{
    int i = chain->model.n_joints++;
    snprintf(chain->names[i], sizeof chain->names[i], "SERVO_%d", id);
    chain->joints[i] = (grobo_joint){
        .name = chain->names[i],
        .min_rad = grobo_rad_from_deg(-RANGE_DEG),
        .max_rad = grobo_rad_from_deg(RANGE_DEG),
        .max_speed_rad_s = grobo_rad_from_deg(type->speed_mdeg_s / 1e3),
        .servo_model = type->model,
        .motor = (uint8_t)id,
        .mirror = (uint8_t)i,
        .mirror_sign = 1,
    };
}

/* One ID=TYPE of the list. */
static int read_one(app *a, sim_chain *chain, const char *item, size_t length)
{
    const char *equals = memchr(item, '=', length);
    size_t digits = equals ? (size_t)(equals - item) : 0;
    const grobo_sim_type *type;
    int id = 0;
    if (digits == 0 || digits > 3 || strspn(item, "0123456789") != digits)
        return refuse(a, item, length, "expected ID=TYPE, such as 1=RS304MD");
    for (size_t i = 0; i < digits; i++)
        id = id * 10 + (item[i] - '0');
    if (id < 1 || id > GROBO_RS30X_ID_MAX)
        return refuse(a, item, length, "the id must be from 1 to 127");
    if (grobo_model_joint_of_motor(&chain->model, id) >= 0)
        return refuse(a, item, length, "the id is used twice");
    type = grobo_sim_type_named(equals + 1, length - digits - 1);
    if (!type)
        return refuse_type(a, item, length);
    if (chain->model.n_joints == GROBO_SIM_SERVOS_MAX)
        return refuse(a, item, length, "too many servos");
    add(chain, id, type);
    return 0;
}

int sim_chain_read(app *a, sim_chain *chain, const char *list)
{
    chain->model = (grobo_model){.name = "servos", .joints = chain->joints};
    for (;;) {
        size_t length = strcspn(list, ",");
        int status = read_one(a, chain, list, length);
        if (status || list[length] == '\0')
            return status;
        list += length + 1;
    }
}
