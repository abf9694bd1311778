/* SPDX-License-Identifier: MIT */
/* Which servo moves which joint: no description says so, and a wrong one moves another joint. */
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/robot.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/robot/make.h"

enum { TABLE_BYTES = 64 * (SKETCH_TEXT_BYTES + 8) };

/* A number at *text, which is moved behind it; -1: there is none. */
static long take_id(const char **text)
{
    char *end;
    if (**text < '0' || **text > '9') {
        return -1;
    }
    long id = strtol(*text, &end, 10);
    *text = end;
    return id > GROBO_SERVO_ID_MAX ? -1 : id;
}

/* "1,2,5-8": as many as there are joints. */
static bool read_list(sketch *s, const char *text)
{
    int n = 0, wanted = sketch_joints(s);
    while (n < wanted) {
        long first = take_id(&text), last = first;
        if (first >= 0 && *text == '-') {
            text++;
            last = take_id(&text);
        }
        if (first < 0 || last < first) {
            return false;
        }
        for (long id = first; id <= last; id++) {
            if (n == wanted) {
                return false;
            }
            sketch_joint(s, n++)->id = (int)id;
        }
        if (*text != ',') {
            break;
        }
        text++;
    }
    return n == wanted && *text == '\0';
}

static sketch_part *joint_called(sketch *s, const char *name, size_t length)
{
    for (int i = 0; i < sketch_joints(s); i++) {
        sketch_part *part = sketch_joint(s, i);
        if (strlen(part->called) == length && memcmp(part->called, name, length) == 0) {
            return part;
        }
    }
    return NULL;
}

/* "turn=3,lift=4": each joint once. */
static int read_named(app *a, sketch *s, const char *text)
{
    for (int i = 0; i < sketch_joints(s); i++) {
        sketch_joint(s, i)->id = -1;
    }
    while (*text) {
        size_t length = strcspn(text, "=,");
        sketch_part *part = joint_called(s, text, length);
        const char *number = text + length + (text[length] == '=');
        long id = text[length] == '=' ? take_id(&number) : -1;
        if (!part || id < 0 || part->id >= 0 || (*number && *number != ',')) {
            return app_fail(a, EXIT_USAGE, "ARG",
                            "--ids: '%.*s': each joint once is wanted, as %s=1,...",
                            (int)strcspn(text, ","), text, sketch_joint(s, 0)->called);
        }
        part->id = (int)id;
        text = number + (*number == ',');
    }
    for (int i = 0; i < sketch_joints(s); i++) {
        if (sketch_joint(s, i)->id < 0) {
            return app_fail(a, EXIT_USAGE, "ARG", "--ids: no id for %s",
                            sketch_joint(s, i)->called);
        }
    }
    return EXIT_DONE;
}

/* ---- a known robot -------------------------------------------------------------------------- */

static int find_joint(const grobo_model *model, const char *name)
{
    for (int j = 0; j < model->n_joints; j++) {
        if (strcmp(grobo_model_joint(model, j)->name, name) == 0) {
            return j;
        }
    }
    return -1;
}

const grobo_robot_def *sketch_namesake(const grobo_model *model)
{
    for (size_t i = 0; grobo_robot_def_at(i); i++) {
        const grobo_model *known = grobo_robot_def_at(i)->model;
        int n = 0;
        while (n < model->n_joints && find_joint(known, grobo_model_joint(model, n)->name) >= 0) {
            n++;
        }
        if (n == model->n_joints && n == known->n_joints) {
            return grobo_robot_def_at(i);
        }
    }
    return NULL;
}

/* "@arm.yaml": as of that robot, whose joints have these names. */
static int read_robot(app *a, sketch *s, const char *text)
{
    char complaint[APP_LINE_BYTES];
    const grobo_robot_def *def = robot_find(text + 1, complaint, sizeof complaint);
    if (!def) {
        return app_fail(a, EXIT_FILE, "NOTFOUND", "--ids %s: %s", text, complaint);
    }
    for (int i = 0; i < sketch_joints(s); i++) {
        sketch_part *part = sketch_joint(s, i);
        int j = find_joint(def->model, part->called);
        if (j < 0) {
            return app_fail(a, EXIT_USAGE, "ARG", "--ids %s: %s has no joint '%s'", text, def->name,
                            part->called);
        }
        part->id = grobo_model_joint(def->model, j)->motor;
    }
    return EXIT_DONE;
}

/* The robot of the library, of this family, with joints of these names. */
static const grobo_robot_def *known_robot(sketch *s)
{
    for (size_t i = 0; grobo_robot_def_at(i); i++) {
        const grobo_robot_def *def = grobo_robot_def_at(i);
        int n = 0;
        while (n < sketch_joints(s) && find_joint(def->model, sketch_joint(s, n)->called) >= 0) {
            n++;
        }
        if (n == sketch_joints(s) && n == def->model->n_joints && def->family == s->family) {
            return def;
        }
    }
    return NULL;
}

static int id_of(const grobo_robot_def *def, const sketch_part *part)
{
    return grobo_model_joint(def->model, find_joint(def->model, part->called))->motor;
}

/* ---- what a person sees --------------------------------------------------------------------- */

/* "turn=3,lift=4", as --ids takes it; without ids "turn=ID,lift=ID". */
static const char *table_of(sketch *s, bool with_ids)
{
    static char text[TABLE_BYTES];
    size_t used = 0;
    for (int i = 0; i < sketch_joints(s) && used < sizeof text; i++) {
        const sketch_part *part = sketch_joint(s, i);
        char id[16] = "ID";
        if (with_ids) {
            snprintf(id, sizeof id, "%d", part->id);
        }
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s=%s", i ? "," : "",
                                 part->called, id);
    }
    return text;
}

static void take_ids_of(sketch *s, const grobo_robot_def *def)
{
    for (int i = 0; i < sketch_joints(s); i++) {
        sketch_joint(s, i)->id = id_of(def, sketch_joint(s, i));
    }
}

/* Does the chain branch? Then nothing says which branch comes first. */
static bool branches(const sketch *s)
{
    for (int i = 1; i < s->n_joints; i++) {
        int above = s->part[s->joints[i]].above;
        while (above >= 0 && s->part[above].motion != SKETCH_TURNS) {
            above = s->part[above].above;
        }
        if (above != s->joints[i - 1]) {
            return true;
        }
    }
    return false;
}

/* A list that contradicts a known robot: the first joint that has another id there. */
static int refuse_list(app *a, sketch *s, const sketch_orders *orders, const grobo_robot_def *def)
{
    for (int i = 0; i < sketch_joints(s); i++) {
        const sketch_part part = *sketch_joint(s, i);
        int known = id_of(def, &part);
        if (part.id != known) {
            take_ids_of(s, def);
            return app_fail(a, EXIT_USAGE, "ARG",
                            "--ids %s gives %s the id %d, in %s it has %d; name the joints: --ids "
                            "%s",
                            orders->ids, part.called, part.id, def->name, known, table_of(s, true));
        }
    }
    return EXIT_DONE;
}

/* A list without names: it is that of a known robot, or a person accepts it. */
static int confirm_list(app *a, sketch *s, const sketch_orders *orders)
{
    const grobo_robot_def *def = known_robot(s);
    char answer[SKETCH_ANSWER_BYTES];
    if (def) {
        return refuse_list(a, s, orders, def);
    }
    if (sketch_joints(s) == 1) {
        return EXIT_DONE;
    }
    app_note(a, "ids: %s", table_of(s, true));
    if (app_global(a, GLOBAL_YES)->given) {
        return EXIT_DONE;
    }
    if (orders->ask && orders->ask(a, N_("is that the id of each joint's servo?"), "n", answer) &&
        (*answer == 'y' || *answer == 'Y')) {
        return EXIT_DONE;
    }
    return app_fail(a, EXIT_USAGE, "ARG",
                    "--ids %s: %s; name the joints: --ids %s, or accept the list with --yes",
                    orders->ids,
                    branches(s) ? _("the chain branches, so the order of its joints is not certain")
                                : _("the description does not say which servo moves which joint"),
                    table_of(s, true));
}

/* Asks until the answer is an id; there is no usual one, which a person might accept by mistake. */
static int ask_one(app *a, sketch_part *part, const sketch_orders *orders)
{
    char question[SKETCH_ANSWER_BYTES], answer[SKETCH_ANSWER_BYTES];
    snprintf(question, sizeof question, _("id of the servo of %s?"), part->called);
    while (orders->ask(a, question, "", answer)) {
        const char *text = answer;
        long id = take_id(&text);
        if (id >= 0 && !*text) {
            part->id = (int)id;
            return EXIT_DONE;
        }
        app_note(a, "'%s' is no id", answer);
    }
    return app_fail(a, EXIT_USAGE, "ARG", "import: an id for %s is wanted; nothing is written",
                    part->called);
}

static int ask_each(app *a, sketch *s, const sketch_orders *orders)
{
    int status = EXIT_DONE;
    for (int i = 0; !status && i < sketch_joints(s); i++) {
        status = ask_one(a, sketch_joint(s, i), orders);
    }
    return status;
}

/* ---- all of them ---------------------------------------------------------------------------- */

/* Without --ids. A wrong id moves another joint, so none is guessed. */
static int find_ids(app *a, sketch *s, const sketch_orders *orders)
{
    const grobo_robot_def *def = known_robot(s);
    if (def) {
        take_ids_of(s, def);
        return EXIT_DONE;
    }
    if (orders->ask) {
        return ask_each(a, s, orders);
    }
    return app_fail(a, EXIT_USAGE, "ARG",
                    "import: the description has no ids of servos; give them: --ids %s",
                    table_of(s, false));
}

void sketch_say_ids(const app *a, sketch *s, const sketch_orders *orders)
{
    const grobo_robot_def *def = known_robot(s);
    if (!orders->ids && def) {
        app_note(a, "ids as of %s, whose joints have these names: %s", def->name,
                 table_of(s, true));
    }
}

static int check_range(app *a, sketch *s)
{
    const grobo_protocol *protocol = family_driver(s->family)->protocol;
    for (int i = 0; i < sketch_joints(s); i++) {
        int id = sketch_joint(s, i)->id;
        if (id < protocol->id_min || id > protocol->id_max) {
            return app_fail(a, EXIT_USAGE, "LIMIT", "id %d: servos of family %s have %d to %d", id,
                            s->family->name, protocol->id_min, protocol->id_max);
        }
    }
    return EXIT_DONE;
}

int sketch_give_ids(app *a, sketch *s, const sketch_orders *orders)
{
    int status = EXIT_DONE;
    if (!orders->ids) {
        status = find_ids(a, s, orders);
    } else if (*orders->ids == '@') {
        status = read_robot(a, s, orders->ids);
    } else if (strchr(orders->ids, '=')) {
        status = read_named(a, s, orders->ids);
    } else if (!read_list(s, orders->ids)) {
        status =
            app_fail(a, EXIT_USAGE, "ARG", "--ids %s: %d ids are wanted, one for each joint: 1-4,7",
                     orders->ids, sketch_joints(s));
    } else {
        status = check_range(a, s);
        status = status ? status : confirm_list(a, s, orders);
    }
    return status ? status : check_range(a, s);
}
