/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/dxl2.h>
#include <grobo/feetech.h>
#include <grobo/ics.h>
#include <grobo/lx16a.h>
#include <grobo/posture.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/sim/chain.h"

/* No RS30x turns further than its registers CW_LIMIT and CCW_LIMIT allow. */
#define RANGE_DEG 150.0
/* The others turn around; a model needs an end. */
#define TURNS_DEG 360000.0

static const grobo_servo_table *const tables[] = {&grobo_dxl2_table,  &grobo_dxl1_table,
                                                  &grobo_sts_table,   &grobo_scs_table,
                                                  &grobo_lx16a_table, &grobo_ics_table};
enum { TABLES = (int)(sizeof tables / sizeof *tables) };

static const grobo_sim_family *const families[] = {&grobo_sim_dxl2, &grobo_sim_dxl1,
                                                   &grobo_sim_lx16a, &grobo_sim_ics, NULL};

static int refuse(app *a, const char *item, size_t length, const char *why)
{
    char shown[64];
    snprintf(shown, sizeof shown, "%.*s", (int)(length < 40 ? length : 40), item);
    app_make_one_line(shown);
    return app_fail(a, EXIT_USAGE, "ARG", "sim: --servo: '%s': %s", shown, lang_text(why));
}

static int refuse_type(app *a, const char *item, size_t length)
{
    char why[512];
    size_t used = (size_t)snprintf(why, sizeof why, _("unknown type; known:"));
    for (size_t i = 0; grobo_sim_type_row(i) && used < sizeof why; i++) {
        used += (size_t)snprintf(why + used, sizeof why - used, " %s", grobo_sim_type_row(i)->name);
    }
    for (int t = 0; t < TABLES; t++) {
        for (int m = 0; m < tables[t]->model_count && used < sizeof why; m++) {
            used +=
                (size_t)snprintf(why + used, sizeof why - used, " %s", tables[t]->models[m].name);
        }
    }
    return refuse(a, item, length, why);
}

/* The model called name[0..length-1], in any case. */
static const grobo_servo_model *model_named(const char *name, size_t length)
{
    char upper[32];
    if (length >= sizeof upper) {
        return NULL;
    }
    for (size_t i = 0; i < length; i++) {
        upper[i] = name[i] >= 'a' && name[i] <= 'z' ? (char)(name[i] - 'a' + 'A') : name[i];
    }
    upper[length] = '\0';
    for (int t = 0; t < TABLES; t++) {
        const grobo_servo_model *model = grobo_servo_model_named(tables[t], upper);
        if (model) {
            return model;
        }
    }
    return NULL;
}

/* A joint for a servo of either kind. */
static void add(sim_chain *chain, int id, const grobo_sim_type *type,
                const grobo_servo_model *model)
{
    int i = chain->model.n_joints++;
    double range_deg = model && model->span_deg == 360 ? TURNS_DEG : RANGE_DEG;
    snprintf(chain->names[i], sizeof chain->names[i], "SERVO_%u", (uint8_t)id);
    chain->servos[i] = model;
    chain->only_rs30x = chain->only_rs30x && !model;
    chain->joints[i] = (grobo_joint){
        .name = chain->names[i],
        .min_rad = grobo_rad_from_deg(-range_deg),
        .max_rad = grobo_rad_from_deg(range_deg),
        .max_speed_rad_s = grobo_rad_from_deg(model ? model->speed_dps : type->speed_mdeg_s / 1e3),
        .servo_model = model ? model->number : type->model,
        .motor = (uint8_t)id,
        .mirror = (uint8_t)i,
        .mirror_sign = 1,
    };
}

/* The highest id, and from where they are counted. */
static bool id_fits(int id, const grobo_servo_model *model)
{
    if (!model) {
        return id >= 1 && id <= GROBO_RS30X_ID_MAX;
    }
    return id <= (model->table == &grobo_dxl2_table  ? GROBO_DXL2_ID_MAX
                  : model->table == &grobo_ics_table ? GROBO_ICS_ID_MAX
                                                     : GROBO_DXL1_ID_MAX);
}

/* One ID=TYPE of the list. */
static int read_one(app *a, sim_chain *chain, const char *item, size_t length)
{
    const char *equals = memchr(item, '=', length);
    size_t digits = equals ? (size_t)(equals - item) : 0;
    int id = 0;
    if (digits == 0 || digits > 3 || strspn(item, "0123456789") != digits) {
        return refuse(a, item, length, "expected ID=TYPE, such as 1=RS304MD");
    }
    for (size_t i = 0; i < digits; i++) {
        id = id * 10 + (item[i] - '0');
    }
    if (grobo_model_joint_of_motor(&chain->model, id) >= 0) {
        return refuse(a, item, length, "the id is used twice");
    }
    const grobo_sim_type *type = grobo_sim_type_named(equals + 1, length - digits - 1);
    const grobo_servo_model *model = type ? NULL : model_named(equals + 1, length - digits - 1);
    if (!type && !model) {
        return refuse_type(a, item, length);
    }
    if (!id_fits(id, model)) {
        return refuse(a, item, length,
                      model ? "the id must be from 0 to 252 (AX, MX, Feetech, LX: 253; KRS: 31)"
                            : "the id must be from 1 to 127");
    }
    if (chain->model.n_joints == GROBO_SIM_SERVOS_MAX) {
        return refuse(a, item, length, "too many servos");
    }
    add(chain, id, type, model);
    return 0;
}

int sim_chain_read(app *a, sim_chain *chain, const char *list)
{
    chain->model = (grobo_model){.name = "servos", .joints = chain->joints};
    chain->families = families;
    chain->only_rs30x = true;
    for (;;) {
        size_t length = strcspn(list, ",");
        int status = read_one(a, chain, list, length);
        if (status || list[length] == '\0') {
            return status;
        }
        list += length + 1;
    }
}
