/* SPDX-License-Identifier: MIT */
#include <string.h>
#include <strings.h>

#include <grobo/posture.h>
#include <grobo/robot_file.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/sim/chain.h"

/* No RS30x turns further than its registers CW_LIMIT and CCW_LIMIT allow. */
#define RANGE_DEG 150.0
/* The others turn around; a model needs an end. */
#define TURNS_DEG 360000.0

static int refuse(app *a, const char *item, size_t length, const char *why)
{
    char shown[64];
    snprintf(shown, sizeof shown, "%.*s", (int)(length < 40 ? length : 40), item);
    app_make_one_line(shown);
    return app_fail(a, EXIT_USAGE, "ARG", "sim: --servo: '%s': %s", shown, lang_text(why));
}

/* Model number index of all families, NULL behind the last. */
static const grobo_servo_model *model_row(size_t index)
{
    for (size_t f = 0; grobo_robot_family_at(f); f++) {
        const grobo_servo_table *table;
        for (size_t t = 0; (table = grobo_robot_family_at(f)->tables[t]) != NULL; t++) {
            if (index < table->model_count) {
                return &table->models[index];
            }
            index -= table->model_count;
        }
    }
    return NULL;
}

static int refuse_type(app *a, const char *item, size_t length)
{
    char why[160];
    const grobo_servo_model *model;
    const char *name = memchr(item, '=', length);
    name = name ? name + 1 : item;
    cli_guess guess = {.name = name, .length = length - (size_t)(name - item)};
    for (size_t i = 0; (model = model_row(i)) != NULL; i++) {
        cli_guess_try(&guess, model->name);
    }
    if (guess.best) {
        snprintf(why, sizeof why,
                 _("unknown type; did you mean %s? 'grctl robot servos' lists all"), guess.best);
    } else {
        snprintf(why, sizeof why, _("unknown type; 'grctl robot servos' lists all"));
    }
    return refuse(a, item, length, why);
}

/* The model called name[0..length-1], in any case. */
static const grobo_servo_model *model_named(const char *name, size_t length)
{
    const grobo_servo_model *model;
    for (size_t i = 0; (model = model_row(i)) != NULL; i++) {
        if (strlen(model->name) == length && strncasecmp(model->name, name, length) == 0) {
            return model;
        }
    }
    return NULL;
}

static void add(sim_chain *chain, int id, const grobo_servo_model *model)
{
    int i = chain->model.n_joints++;
    double range_deg = model->span_deg == 360 ? TURNS_DEG : RANGE_DEG;
    snprintf(chain->names[i], sizeof chain->names[i], "SERVO_%u", (uint8_t)id);
    chain->servos[i] = model;
    chain->joints[i] = (grobo_joint){
        .name = chain->names[i],
        .min_rad = grobo_rad_from_deg(-range_deg),
        .max_rad = grobo_rad_from_deg(range_deg),
        .max_speed_rad_s = grobo_rad_from_deg(model->speed_dps),
        .servo_model = model->number,
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
    const grobo_servo_model *model = model_named(equals + 1, length - digits - 1);
    if (!model) {
        return refuse_type(a, item, length);
    }
    const grobo_servo_register *ids = grobo_servo_register_of(model, GROBO_ROLE_ID);
    if (id < ids->min || id > ids->max) {
        char why[128];
        snprintf(why, sizeof why, _("the id must be from %d to %d"), (int)ids->min, (int)ids->max);
        return refuse(a, item, length, why);
    }
    if (chain->model.n_joints == GROBO_SIM_SERVOS_MAX) {
        return refuse(a, item, length, "too many servos");
    }
    add(chain, id, model);
    return 0;
}

int sim_chain_read(app *a, sim_chain *chain, const char *list)
{
    chain->model =
        (grobo_model)GROBO_TABLE(grobo_model, .name = "servos", GROBO_MODEL_JOINTS(chain->joints));
    for (;;) {
        size_t length = strcspn(list, ",");
        int status = read_one(a, chain, list, length);
        if (status || list[length] == '\0') {
            return status;
        }
        list += length + 1;
    }
}
