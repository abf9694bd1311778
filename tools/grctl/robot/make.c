/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/robot/make.h"

/* ---- what the command line knows ------------------------------------------------------------- */

/* Number i of words with commas between them: its length, 0 behind the last. */
static size_t word_of(const char *list, int i, const char **word)
{
    for (; i > 0 && *list; i--) {
        list += strcspn(list, ",");
        list += *list == ',';
    }
    *word = list;
    return strcspn(list, ",");
}

static int give_servos(app *a, sketch *s, const sketch_orders *orders)
{
    const grobo_servo_table *table = s->family->tables[0];
    bool one = orders->servos && !strchr(orders->servos, ',');
    for (int i = 0; i < sketch_joints(s); i++) {
        const char *word = table->models[0].name;
        char name[GROBO_NAME_MAX_BYTES] = "";
        size_t n = orders->servos ? word_of(orders->servos, one ? 0 : i, &word) : strlen(word);
        snprintf(name, sizeof name, "%.*s", (int)(n < sizeof name ? n : sizeof name - 1), word);
        sketch_joint(s, i)->servo = family_model(s->family, name);
        if (!sketch_joint(s, i)->servo) {
            return *name ? app_fail(a, EXIT_USAGE, "NOTFOUND",
                                    "no servo of family %s is called '%s'; 'grctl robot servos' "
                                    "lists them",
                                    s->family->name, name)
                         : app_fail(a, EXIT_USAGE, "ARG",
                                    "--servo: one for all, or one for each of %d joints is wanted",
                                    sketch_joints(s));
        }
    }
    return EXIT_DONE;
}

/* ---- out ------------------------------------------------------------------------------------ */

typedef struct text_source {
    const char *at;
} text_source;

static int read_text(void *ctx, void *buffer, size_t size)
{
    text_source *source = ctx;
    size_t left = strlen(source->at), n = left < size ? left : size;
    memcpy(buffer, source->at, n);
    source->at += n;
    return (int)n;
}

int sketch_read_back(const char *text, grobo_diagnostics *list, grobo_robot_def **def)
{
    text_source source = {text};
    return grobo_robot_def_read(&(grobo_source){read_text, &source}, "robot", list, NULL, def);
}

/* What the reader of robot files says of it. Returns 0, or the exit status with that said. */
static int check_text(app *a, const char *text)
{
    grobo_diagnostics *list = NULL;
    grobo_robot_def *def = NULL;
    grobo_diagnostic d = {.message = _("not enough memory")};
    int error = grobo_diagnostics_new(NULL, &list);
    if (!error) {
        error = sketch_read_back(text, list, &def);
    }
    if (error) {
        (void)grobo_diagnostics_get(list, 0, &d);
        error =
            app_fail(a, EXIT_FILE, "SYNTAX", "no robot's file can be made of this: %s", d.message);
    }
    grobo_robot_def_free(def);
    grobo_diagnostics_free(list);
    return error;
}

int sketch_save(app *a, const char *out, const char *text)
{
    if (file_is_there(out) && !app_global(a, GLOBAL_YES)->given) {
        return app_fail(a, EXIT_USAGE, "EXISTS", "%s is there already; --yes replaces it", out);
    }
    int error = file_save(out, text, strlen(text));
    return error ? app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: %s", out,
                            file_write_error_text(error))
                 : EXIT_DONE;
}

int sketch_write(app *a, sketch *s, const char *out, json_t *fits)
{
    char *text = sketch_text(s);
    if (!text) {
        return app_fail_error(a, EXIT_ROBOT, GROBO_ERR_NOMEM, "%s", a->line.command->name);
    }
    int status = check_text(a, text);
    if (!status && out) {
        status = sketch_save(a, out, text);
    }
    if (!status && a->json) {
        app_print_json(json_pack("{s:s,s:o?,s:i,s:o?,s:O*}", "name", s->name, "file",
                                 out ? app_json_text(out) : NULL, "n_joints", sketch_joints(s),
                                 "text", out ? NULL : json_string(text), "fits", fits));
    } else if (!status && out) {
        app_note(a, "%s: %d joint%s; check it, then: grctl --robot %s -d sim init", out,
                 sketch_joints(s), sketch_joints(s) == 1 ? "" : "s", out);
    } else if (!status) {
        app_print("%s", text);
    }
    free(text);
    return status;
}

/* ---- in ------------------------------------------------------------------------------------- */

/* All of a file, to be freed; NULL with the reason said. */
static char *read_file(app *a, const char *path, size_t *size, int *status)
{
    heap all = file_bytes(path, SKETCH_FILE_MAX_BYTES);
    if (!all.bytes) {
        int cause = os_is_folder(path) ? EISDIR : errno;
        *status = cause == EFBIG ? app_fail(a, EXIT_FILE, "CAP", "%s: is longer than 4 MiB", path)
                                 : app_fail_cause(a, EXIT_FILE, cause, "%s", path);
    }
    *size = all.size;
    return all.bytes;
}

static bool is_xml(const char *bytes, size_t size)
{
    size_t i = size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (i < size && strchr(" \t\r\n", bytes[i])) {
        i++;
    }
    return i < size && bytes[i] == '<';
}

static int describe(app *a, sketch *s, const char *path, const sketch_orders *orders)
{
    char complaint[APP_LINE_BYTES];
    if (!sketch_order(s, complaint, sizeof complaint)) {
        return app_fail(a, EXIT_FILE, "SYNTAX", "%s: %s", path, complaint);
    }
    s->family = family_called(orders->family ? orders->family : "feetech");
    s->guessed_servos = !orders->family || !orders->servos;
    int status = give_servos(a, s, orders);
    if (!status) {
        status = sketch_give_ids(a, s, orders);
    }
    if (status) {
        return status;
    }
    if (!sketch_fit(s, complaint, sizeof complaint)) {
        return app_fail(a, EXIT_FILE, "LIMIT", "%s: %s", path, complaint);
    }
    status = sketch_write(a, s, orders->out, NULL);
    if (!status) {
        sketch_say_ids(a, s, orders);
    }
    return status;
}

int sketch_import(app *a, const char *path, const sketch_orders *orders)
{
    static sketch s;
    char complaint[APP_LINE_BYTES];
    size_t size = 0;
    int status = 0;
    char *bytes = read_file(a, path, &size, &status);
    if (!bytes) {
        return status;
    }
    s.n = 0;
    s.bare = false;
    s.n_feet = 0;
    s.as_listed = orders->as_listed;
    s.name[0] = s.usb[0] = '\0';
    snprintf(s.source, sizeof s.source, "%s", path);
    bool xml = is_xml(bytes, size);
    bool fine = xml ? sketch_read_urdf(&s, path, bytes, size, complaint, sizeof complaint)
                    : sketch_read_body(&s, path, bytes, size, complaint, sizeof complaint);
    free(bytes);
    if (!fine) {
        return app_fail(a, EXIT_FILE, "SYNTAX", "%s", complaint);
    }
    if (orders->name || !*s.name) {
        snprintf(s.name, sizeof s.name, "%s", orders->name ? orders->name : "robot");
    }
    return describe(a, &s, path, orders);
}
