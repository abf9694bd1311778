/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "commands.h"
#include "file.h"
#include "joints.h"

enum { OPT_JOINTS };

static const cli_option options[] = {
    [OPT_JOINTS] = {.name = "joints",
                    .letter = 'j',
                    .kind = CLI_TEXT,
                    .value = "LIST",
                    .help = "only these joints or groups, split by commas"},
};

enum { TIME_WIDTH = 9, MIN_WIDTH = 7 };

typedef struct table {
    const grobo_motion *motion;
    const grobo_model *model;
    int joint[GROBO_JOINTS_MAX];
    int n_joints;
    int width; /* of the terminal, 0: no limit */
} table;

static const char *joint_name(const table *t, int column, char *buffer, size_t capacity)
{
    int joint = t->joint[column];
    if (t->model && joint < t->model->n_joints)
        return t->model->joints[joint].name;
    snprintf(buffer, capacity, "j%d", joint);
    return buffer;
}

static int column_width(const table *t, int column)
{
    char buffer[16];
    int n = (int)strlen(joint_name(t, column, buffer, sizeof buffer)) + 2;
    return n < MIN_WIDTH ? MIN_WIDTH : n;
}

/* Prints the columns from..to-1 of every posture. */
static void print_block(const table *t, int from, int to)
{
    char buffer[16];
    grobo_posture posture;
    printf("%*s", TIME_WIDTH, "time_ms");
    for (int c = from; c < to; c++)
        printf("%*s", column_width(t, c), joint_name(t, c, buffer, sizeof buffer));
    putchar('\n');
    for (size_t i = 0; grobo_motion_get(t->motion, i, &posture) == 0; i++) {
        double time_s = 0, deg;
        grobo_motion_time_s(t->motion, i, &time_s);
        printf("%*.*f", TIME_WIDTH, fabs(time_s * 1e3 - round(time_s * 1e3)) < 1e-6 ? 0 : 1,
               time_s * 1e3);
        for (int c = from; c < to; c++) {
            if (grobo_posture_get_deg(&posture, t->joint[c], &deg) == 0)
                printf("%*.1f", column_width(t, c), deg);
            else
                printf("%*s", column_width(t, c), ".");
        }
        putchar('\n');
    }
}

static void print_table(const table *t)
{
    for (int from = 0, to; from < t->n_joints; from = to) {
        int used = TIME_WIDTH;
        if (from)
            putchar('\n');
        for (to = from; to < t->n_joints; to++) {
            used += column_width(t, to);
            if (t->width && used > t->width && to > from)
                break;
        }
        print_block(t, from, to);
    }
}

static json_t *key_json(const table *t, size_t i, const grobo_posture *posture)
{
    json_t *angles = json_array();
    double time_s = 0, deg;
    grobo_motion_time_s(t->motion, i, &time_s);
    for (int c = 0; c < t->n_joints; c++)
        json_array_append_new(angles, grobo_posture_get_deg(posture, t->joint[c], &deg) == 0
                                          ? app_json_number(deg, 6)
                                          : json_null());
    return json_pack("{s:o,s:o}", "time_ms", app_json_number(time_s * 1e3, 6), "angle_deg", angles);
}

static void print_json(const table *t, const char *path, const char *format)
{
    char buffer[16];
    grobo_posture posture;
    json_t *names = json_array(), *keys = json_array();
    for (int c = 0; c < t->n_joints; c++)
        json_array_append_new(names, json_string(joint_name(t, c, buffer, sizeof buffer)));
    for (size_t i = 0; grobo_motion_get(t->motion, i, &posture) == 0; i++)
        json_array_append_new(keys, key_json(t, i, &posture));
    app_print_json(
        json_pack("{s:o,s:s,s:o,s:o,s:o,s:o}", "file", app_json_text(path), "format", format,
                  "name", app_json_text(grobo_motion_name(t->motion)), "length_ms",
                  app_json_number((double)grobo_motion_length_us(t->motion, -1) / 1e3, 3), "joints",
                  names, "keys", keys));
}

static void print_head(const table *t, const char *path, const char *format)
{
    double length_s = (double)grobo_motion_length_us(t->motion, -1) / 1e6;
    const char *name = grobo_motion_name(t->motion), *body = grobo_motion_target_body(t->motion);
    printf("%s: %s", path, format);
    if (*name)
        printf(" \"%s\"", name);
    if (*body)
        printf(" for %s", body);
    printf(", %zu postures, %.3f s\n", grobo_motion_size(t->motion), length_s);
}

/* Which joints are shown: those asked for, else those that any posture sets. */
static int choose_joints(app *a, table *t)
{
    grobo_joint_mask joints = 0;
    grobo_posture posture;
    if (app_option(a, OPT_JOINTS)->given) {
        int status = joints_parse_list(a, app_option(a, OPT_JOINTS)->text, &joints);
        if (status)
            return status;
    } else {
        for (size_t i = 0; grobo_motion_get(t->motion, i, &posture) == 0; i++)
            joints |= posture.set;
    }
    for (int j = 0; j < grobo_motion_joints(t->motion); j++)
        if (joints & GROBO_JOINT_BIT(j))
            t->joint[t->n_joints++] = j;
    return 0;
}

static int run(app *a)
{
    grobo_read_options read = {.model = &grobo_gr001_model};
    grobo_motion *motion = NULL;
    table t = {0};
    struct winsize size;
    const char *format;
    int status = file_load(a, a->line.argument[0], &read, &motion);
    if (status)
        return status;
    t.motion = motion;
    t.model = grobo_motion_joints(motion) <= grobo_gr001_model.n_joints ? &grobo_gr001_model : NULL;
    if (a->tty_out && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0)
        t.width = size.ws_col;
    format = grobo_motion_format_name(grobo_motion_kind_format(grobo_motion_get_kind(motion)));
    status = choose_joints(a, &t);
    if (!status && a->json)
        print_json(&t, a->line.argument[0], format);
    if (!status && !a->json) {
        print_head(&t, a->line.argument[0], format);
        print_table(&t);
    }
    grobo_motion_free(motion);
    return status;
}

const cli_command cmd_show = {
    .name = "show",
    .arguments = "FILE",
    .summary = "a motion file as a table of angles",
    .details = "Prints every posture of a motion file: its time in milliseconds and the angles of\n"
               "its joints in degrees; a dot for a joint that the posture leaves alone.\n",
    .example = "  grctl show motions/greet.pseq\n  grctl show -j right_arm,NECK_Y greet.pseq\n",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .min_arguments = 1,
    .max_arguments = 1,
    .argument = CLI_ARG_FILE,
    .run = run,
};
