/* SPDX-License-Identifier: MIT */
/*
 * Makes const tables of a robot's file: `robots FILE.yaml` writes C to standard output. `make
 * robots` runs it for src/robots; what it writes is committed, so that firmware needs no such tool.
 */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/robot_file.h>

#define PI 3.14159265358979323846

static const char *identifier(const char *name)
{
    static char text[GROBO_NAME_MAX_BYTES];
    snprintf(text, sizeof text, "%s", name);
    for (char *c = text; *c; c++) {
        *c = isalnum((unsigned char)*c) ? *c : '_';
    }
    return text;
}

/* The shortest number of degrees that is these radians to the bit, computed as RAD() does. */
static const char *rad(double value)
{
    static char text[8][40];
    static unsigned next;
    char *to = text[next++ % 8];
    char deg[32];
    for (int digits = 0; digits <= 17; digits++) {
        snprintf(deg, sizeof deg, digits ? "%.*g" : "%.*f", digits, value * 180.0 / PI);
        if (strtod(deg, NULL) * PI / 180.0 == value) {
            snprintf(to, sizeof text[0], value == 0 ? "0" : "RAD(%s)", deg);
            return to;
        }
    }
    snprintf(to, sizeof text[0], "%.17g", value);
    return to;
}

static void print_joints(const grobo_model *model)
{
    printf("static const grobo_joint joints[] = {\n");
    for (int i = 0; i < model->n_joints; i++) {
        const grobo_joint *j = grobo_model_joint(model, i);
        printf("    {.name = \"%s\", .min_rad = %s, .max_rad = %s, .max_speed_rad_s = %s, ",
               j->name, rad(j->min_rad), rad(j->max_rad), rad(j->max_speed_rad_s));
        printf(".init_rad = %s, .servo_model = 0x%04X, .free_current_ma = %u, .motor = %u, ",
               rad(j->init_rad), j->servo_model, j->free_current_ma, j->motor);
        printf(".mirror = %u, .mirror_sign = %d", j->mirror, j->mirror_sign);
        if (j->sign < 0) {
            printf(", .sign = -1");
        }
        if (j->turns) {
            printf(", .turns = true");
        }
        if (j->zero_rad != 0) {
            printf(", .zero_rad = %s", rad(j->zero_rad));
        }
        if (j->gear != 0) {
            printf(", .gear = %.17g", j->gear);
        }
        if (j->torque_limit_pct > 0) {
            printf(", .torque_limit_pct = %u", j->torque_limit_pct);
        }
        if (j->calibrated) {
            printf(", .calibrated = true");
        }
        if (j->ratio != 0) {
            printf(", .follows = %u, .ratio = %.17g, .apart_rad = %s", j->follows, j->ratio,
                   rad(j->apart_rad));
        }
        if (j->unit != 0) {
            printf(", .unit = %u, .unit_zero_rad = %s, .unit_rad = %.17g", j->unit,
                   rad(j->unit_zero_rad), j->unit_rad);
        }
        printf("},\n");
    }
    printf("};\n\n");
}

static void print_groups(const grobo_model *model)
{
    if (model->n_groups == 0) {
        return;
    }
    printf("static const grobo_group groups[] = {\n");
    for (int i = 0; i < model->n_groups; i++) {
        printf("    {\"%s\", 0x%llX},\n", model->groups[i].name,
               (unsigned long long)model->groups[i].joints);
    }
    printf("};\n\n");
}

static void print_model(const grobo_robot_def *def, const char *name)
{
    const grobo_model *model = def->model;
    print_joints(model);
    print_groups(model);
    printf("%sconst grobo_model %s = GROBO_TABLE(grobo_model, .name = \"%s\", "
           "GROBO_MODEL_JOINTS(joints), ",
           strcmp(name, "model") == 0 ? "static " : "", name, model->name);
    if (model->n_groups > 0) {
        printf(".groups = groups, .n_groups = %u, ", model->n_groups);
    }
    printf(".n_joints = %u, .limit_slack_deg = %.17g);\n\n", model->n_joints,
           model->limit_slack_deg);
}

static void print_rest(const grobo_robot_def *def)
{
    if (def->rest_rad) {
        printf("static const double rest_rad[] = {");
        for (int j = 0; j < def->model->n_joints; j++) {
            printf("%s%s", j ? ", " : "", rad(def->rest_rad[j]));
        }
        printf("};\n\n");
    }
    if (def->n_readback > 0) {
        printf("static const grobo_readback readback[] = {");
        for (int i = 0; i < def->n_readback; i++) {
            printf("{%s, %u},", rad(def->readback[i].add_rad), def->readback[i].joint);
        }
        printf("};\n\n");
    }
}

static void print_vector(const char *name, const double *v, bool angles)
{
    printf(", .%s = {", name);
    for (int i = 0; i < 3; i++) {
        if (angles) {
            printf("%s%s", i ? ", " : "", rad(v[i]));
        } else {
            printf("%s%.15g", i ? ", " : "", v[i]);
        }
    }
    printf("}");
}

static bool is_zero(const double *v)
{
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

static void print_links(const grobo_robot_def *def)
{
    if (def->n_links == 0) {
        return;
    }
    printf("static const grobo_robot_link links[] = {\n");
    for (int i = 0; i < def->n_links; i++) {
        const grobo_robot_link *l = &def->links[i];
        printf("    {.name = \"%s\", .parent = %d, .joint = %d", l->name, l->parent, l->joint);
        if (!is_zero(l->origin_m)) {
            print_vector("origin_m", l->origin_m, false);
        }
        if (!is_zero(l->origin_rad)) {
            print_vector("origin_rad", l->origin_rad, true);
        }
        if (!is_zero(l->axis)) {
            print_vector("axis", l->axis, false);
        }
        if (l->mass_kg > 0) {
            printf(", .mass_kg = %.15g", l->mass_kg);
        }
        if (!is_zero(l->com_m)) {
            print_vector("com_m", l->com_m, false);
        }
        if (!is_zero(l->inertia_kgm2)) {
            printf(", .inertia_kgm2 = {");
            for (int k = 0; k < 6; k++) {
                printf("%s%.15g", k ? ", " : "", l->inertia_kgm2[k]);
            }
            printf("}");
        }
        printf("},\n");
    }
    printf("};\n\n");
}

static void print_motors(const grobo_robot_def *def)
{
    if (!def->motors) {
        return;
    }
    printf("static const grobo_robot_motor motors[] = {");
    for (int j = 0; j < def->model->n_joints; j++) {
        const grobo_robot_motor *m = &def->motors[j];
        printf("{%.15g, %.15g, %.15g, %.15g, %.15g, %.15g, %s},", m->kt_nm_a, m->resistance_ohm,
               m->armature_kgm2, m->torque_max_nm, m->friction_nm, m->viscous_nms,
               rad(m->backlash_rad));
    }
    printf("};\n\n");
}

static void print_usb(const grobo_robot_def *def)
{
    if (def->n_usb == 0) {
        return;
    }
    printf("static const grobo_usb_id usb[] = {");
    for (int i = 0; i < def->n_usb; i++) {
        printf("{0x%04X, 0x%04X},", def->usb[i].vendor, def->usb[i].product);
    }
    printf("};\n\n");
}

/* What description and driver share: limits and the posture at rest. */
static void print_safety(const grobo_robot_def *def)
{
    static const char *const exits[] = {"DEFAULT", "OFF", "HOLD", "SIT"};
    const grobo_safety_limits *l = &def->limits;
    printf(".limits = {.temperature_c = %d, .lost_replies = %d, .current_ma = %ld, ",
           l->temperature_c, l->lost_replies, (long)l->current_ma);
    printf(".voltage_mv = %ld, .current_us = %lld, .approach_rad_s = %s}, ", (long)l->voltage_mv,
           (long long)l->current_us, rad(l->approach_rad_s));
    printf(".on_exit = GROBO_EXIT_%s, .arm = %s", exits[def->on_exit], def->arm ? "true" : "false");
    if (def->rest_rad) {
        printf(", .rest_rad = rest_rad");
    }
    if (def->n_readback > 0) {
        printf(", .readback = readback, .n_readback = %u", def->n_readback);
    }
}

/* GR001's driver is const: firmware has it in its flash. */
static void print_drivers(const grobo_robot_def *def)
{
    static const char *const wirings[] = {"BOARD", "BUS"};
    static const char *const protocols[] = {"board", "rs30x"};
    printf("const grobo_driver grobo_i_gr001_drivers[] = {\n");
    for (int w = 0; w < 2; w++) {
        printf("[GROBO_WIRING_%s] = GROBO_TABLE(grobo_driver, GROBO_I_RS30X_FUNCTIONS, "
               ".name = \"%s\", ",
               wirings[w], def->model->name);
        printf(".model = &grobo_i_gr001_model, .protocol = &grobo_i_%s_protocol, ", protocols[w]);
        if (w == GROBO_WIRING_BOARD) {
            printf(".stored = grobo_i_rs30x_stored, ");
        }
        print_safety(def);
        printf("),\n");
    }
    printf("};\n\n");
}

static void print_def(const grobo_robot_def *def, const char *model)
{
    printf("const grobo_robot_def grobo_i_robot_%s = {\n", identifier(def->name));
    printf("    .name = \"%s\", .title = \"%s\", ", def->name, def->title);
    printf(".family = &grobo_i_family_%s, .model = &%s, ", identifier(def->family->name), model);
    printf(".wiring = GROBO_WIRING_%s, .baud_bps = %lu, ",
           def->wiring == GROBO_WIRING_BOARD ? "BOARD" : "BUS", (unsigned long)def->baud_bps);
    if (def->n_usb > 0) {
        printf(".usb = usb, .n_usb = %u, ", def->n_usb);
    }
    if (def->n_links > 0) {
        printf(".links = links, .n_links = %u, ", def->n_links);
    }
    printf(".payload_link = %d, ", def->payload_link);
    if (def->motors) {
        printf(".motors = motors, ");
    }
    if (def->n_feet > 0) {
        printf(".n_feet = 2, .feet = {");
        for (int i = 0; i < 2; i++) {
            const grobo_robot_foot *f = &def->feet[i];
            printf("{%d, {%.15g, %.15g, %.15g}, {%.15g, %.15g}},", f->link, f->sole_m[0],
                   f->sole_m[1], f->sole_m[2], f->half_m[0], f->half_m[1]);
        }
        printf("}, ");
    }
    if (def->payload_kg > 0) {
        printf(".payload_kg = %.15g, ", def->payload_kg);
    }
    print_safety(def);
    printf("};\n");
}

static void print(const grobo_robot_def *def)
{
    bool is_gr001 = strcmp(def->name, "gr001") == 0;
    const char *model = is_gr001 ? "grobo_i_gr001_model" : "model";
    printf("/* SPDX-License-Identifier: MIT */\n/* Made from src/robots/%s.yaml by `make robots`. "
           "*/\n",
           def->name);
    if (is_gr001) {
        printf("#include <grobo/core/board.h>\n\n#include \"src/robots/robots.h\"\n"
               "#include \"src/servo/rs30x/driver.h\"\n#include \"src/servo/tables.h\"\n\n");
    } else {
        printf("#include \"src/robots/robots.h\"\n\n");
    }
    printf(
        "#define PI 3.14159265358979323846\n#define RAD(angle_deg) ((angle_deg)*PI / 180.0)\n\n");
    print_model(def, model);
    print_rest(def);
    print_usb(def);
    print_links(def);
    print_motors(def);
    if (is_gr001) {
        print_drivers(def);
    }
    print_def(def, model);
    if (is_gr001) {
        printf("\nconst grobo_model *grobo_gr001_model(void)\n{\n");
        printf("    return &grobo_i_gr001_model;\n}\n");
    }
}

static int read_stream(void *ctx, void *buffer, size_t size)
{
    size_t n = fread(buffer, 1, size, ctx);
    return n == 0 && ferror((FILE *)ctx) ? GROBO_ERR_IO : (int)n;
}

int main(int argc, char **argv)
{
    grobo_robot_def *def = NULL;
    grobo_diagnostics *list = NULL;
    grobo_diagnostic d;
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    if (!file || grobo_diagnostics_new(NULL, &list) < 0) {
        fprintf(stderr, "usage: robots FILE.yaml\n");
        return 2;
    }
    int error = grobo_robot_def_read(&(grobo_source){read_stream, file}, argv[1], list, NULL, &def);
    for (size_t i = 0; grobo_diagnostics_get(list, i, &d) == 0; i++) {
        fprintf(stderr, "%s:%u:%u: %s\n", d.file, d.line, d.column, d.message);
    }
    if (!error) {
        print(def);
    }
    grobo_robot_def_free(def);
    grobo_diagnostics_free(list);
    fclose(file);
    return error ? 1 : 0;
}
