/* SPDX-License-Identifier: MIT */
/* First contact: what differs between this report and one that was kept. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/bringup/contact_compare.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

enum { REPORT_BYTES = 1 << 20, VALUE_BYTES = 64 };

static const char differs[] = N_("differs");

static const char *text_of(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

int contact_read_report(app *a, const char *path, json_t **report)
{
    json_error_t error;
    int status = file_refuse_pipe(a, path);
    heap file = status ? (heap){0} : file_bytes(path, REPORT_BYTES);
    if (status || !file.bytes) {
        int cause = os_is_folder(path) ? EISDIR : errno;
        return status ? status : app_fail_cause(a, EXIT_FILE, cause, "%s", path);
    }
    json_t *read = json_loadb(file.bytes, file.size, JSON_REJECT_DUPLICATES, &error);
    free(file.bytes);
    if (!json_is_array(json_object_get(read, "servos")) ||
        !json_is_array(json_object_get(read, "steps"))) {
        status = app_fail(a, EXIT_FILE, "SYNTAX", "%s: is no report of first-contact", path);
    } else if (strcmp(text_of(read, "robot"), robot_of(a)->name) != 0) {
        status = app_fail(a, EXIT_USAGE, "TYPE", "%s: is of %s; choose that robot with --robot",
                          path, text_of(read, "robot"));
    }
    if (status) {
        json_decref(read);
        return status;
    }
    *report = read;
    return 0;
}

/* A value as it is said; what is not there is "-". */
static void say_value(const json_t *value, char *text)
{
    if (json_is_integer(value)) {
        snprintf(text, VALUE_BYTES, "%lld", (long long)json_integer_value(value));
    } else {
        snprintf(text, VALUE_BYTES, "%s", json_is_string(value) ? json_string_value(value) : "-");
    }
    app_make_one_line(text);
}

static void compare(contact *k, json_t *all, const char *whose, const char *what,
                    const json_t *here, const json_t *there)
{
    char one[VALUE_BYTES], other[VALUE_BYTES], name[APP_LINE_BYTES];
    if (here == there || json_equal(here, there)) {
        return;
    }
    say_value(here, one);
    say_value(there, other);
    snprintf(name, sizeof name, "%s %s", whose, what);
    app_note(k->a, "%-14s  %s: %s here, %s in the other report", _(differs), name, one, other);
    heap_print(&k->text, "%-14s  %s: %s (%s)\n", differs, name, one, other);
    json_array_append_new(all, json_pack("{s:o,s:o,s:o}", "what", app_json_text(name), "here",
                                         app_json_text(one), "there", app_json_text(other)));
}

static const json_t *named(const json_t *list, const char *key, const char *name)
{
    size_t i;
    const json_t *one;
    json_array_foreach((json_t *)list, i, one)
    {
        if (strcmp(text_of(one, key), name) == 0) {
            return one;
        }
    }
    return NULL;
}

static void compare_servo(contact *k, json_t *all, const json_t *here, const json_t *there)
{
    const char *joint = text_of(here, "joint");
    const json_t *mine = json_object_get(here, "registers"),
                 *theirs = json_object_get(there, "registers");
    const grobo_servo_register *reg;
    int id = (int)json_integer_value(json_object_get(here, "id"));
    const grobo_servo_model *servo = family_servo(app_driver(k->a), id);
    static const char *const facts[] = {"id", "model", "firmware", "status"};
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; i++) {
        compare(k, all, joint, facts[i], json_object_get(here, facts[i]),
                json_object_get(there, facts[i]));
    }
    for (size_t i = 0; mine && theirs && (reg = grobo_servo_register_row(servo, i)); i++) {
        if (reg->flags & GROBO_REGISTER_KEPT) {
            compare(k, all, joint, reg->name, json_object_get(mine, reg->name),
                    json_object_get(theirs, reg->name));
        }
    }
}

json_t *contact_compare(contact *k, const json_t *other)
{
    json_t *all = json_array();
    const json_t *steps = json_object_get(other, "steps"),
                 *servos = json_object_get(other, "servos");
    size_t i;
    const json_t *one;
    json_array_foreach(k->steps, i, one)
    {
        const char *name = text_of(one, "name");
        compare(k, all, name, "verdict", json_object_get(one, "verdict"),
                json_object_get(named(steps, "name", name), "verdict"));
    }
    json_array_foreach(k->servos, i, one)
    {
        compare_servo(k, all, one, named(servos, "joint", text_of(one, "joint")));
    }
    app_note(k->a, "%zu thing%s differ%s from the other report", json_array_size(all),
             json_array_size(all) == 1 ? "" : "s", json_array_size(all) == 1 ? "s" : "");
    return all;
}
