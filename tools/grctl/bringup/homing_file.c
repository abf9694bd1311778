/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/bringup/homing_file.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

/* Of 64 joints a tenth. */
enum { FILE_BYTES = 1 << 17 };

static int complain(app *a, const char *path, const char *joint, const char *what)
{
    return app_fail(a, EXIT_FILE, "SYNTAX", "%s: %s: %s", path, joint, lang_text(what));
}

static bool take(const json_t *one, const char *key, int32_t *value)
{
    const json_t *number = json_object_get(one, key);
    bool fits = json_is_integer(number) && json_integer_value(number) >= INT32_MIN &&
                json_integer_value(number) <= INT32_MAX;
    if (fits) {
        *value = (int32_t)json_integer_value(number);
    }
    return fits;
}

static bool holds(const grobo_servo_register *reg, int32_t value)
{
    return value >= reg->min && value <= reg->max;
}

static int read_joint(app *a, const char *path, const json_t *one, int joint, bool any, homing *h)
{
    const grobo_joint *moved = grobo_model_joint(app_model(a), joint);
    const grobo_servo_model *servo = family_servo(app_driver(a), moved->motor);
    int32_t id, mirrored;
    char text[128];
    if (!take(one, "id", &id) || !take(one, "drive_mode", &mirrored) ||
        !take(one, "homing_offset", &h->offset) || !take(one, "range_min", &h->min) ||
        !take(one, "range_max", &h->max)) {
        return complain(a, path, moved->name,
                        "needs whole numbers id, drive_mode, homing_offset, range_min, range_max");
    }
    if (id != moved->motor) {
        snprintf(text, sizeof text, _("id is %d; it is %d in %s"), (int)id, moved->motor,
                 robot_of(a)->name);
        return complain(a, path, moved->name, text);
    }
    if (mirrored != 0) {
        return complain(a, path, moved->name,
                        "drive_mode is not 0; say sign: -1 in the robot file");
    }
    const grobo_servo_register *offset = grobo_servo_register_of(servo, GROBO_ROLE_OFFSET);
    if (offset ? !holds(offset, h->offset) : h->offset != 0) {
        return complain(a, path, moved->name, "homing_offset is more than its servo takes");
    }
    if (!holds(grobo_servo_register_of(servo, GROBO_ROLE_MIN_POSITION), h->min) ||
        !holds(grobo_servo_register_of(servo, GROBO_ROLE_MAX_POSITION), h->max) ||
        (!any && (h->min >= servo->middle || h->max <= servo->middle))) {
        snprintf(text, sizeof text, _("range %d to %d is none of its servo, around %d"),
                 (int)h->min, (int)h->max, servo->middle);
        return complain(a, path, moved->name, text);
    }
    return 0;
}

static int read_all(app *a, const char *path, const json_t *file, bool any, homing *all)
{
    const grobo_model *model = app_model(a);
    const char *key;
    json_t *one;
    json_object_foreach((json_t *)file, key, one)
    {
        int joint = grobo_model_find_joint(model, key, strlen(key));
        if (joint < 0 || strcmp(grobo_model_joint(model, joint)->name, key) != 0) {
            char text[128];
            snprintf(text, sizeof text, _("%s has no such joint"), robot_of(a)->name);
            return complain(a, path, key, text);
        }
    }
    for (int j = 0; j < model->n_joints; j++) {
        int status = read_joint(a, path, json_object_get(file, grobo_model_joint(model, j)->name),
                                j, any, &all[j]);
        if (status) {
            return status;
        }
    }
    return 0;
}

int homing_take(app *a, const char *path, const char *bytes, size_t size, bool any, homing *all)
{
    json_error_t error;
    json_t *file = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, &error);
    if (!file) {
        return app_fail(a, EXIT_FILE, "SYNTAX", "%s:%d:%d: %s", path, error.line, error.column,
                        error.text);
    }
    int status = json_is_object(file)
                     ? read_all(a, path, file, any, all)
                     : complain(a, path, robot_of(a)->name, "is not a calibration");
    json_decref(file);
    return status;
}

int homing_read(app *a, const char *path, bool any, homing *all)
{
    int status = file_refuse_pipe(a, path);
    if (status) {
        return status;
    }
    heap file = file_bytes(path, FILE_BYTES);
    if (!file.bytes) {
        return app_fail_cause(a, EXIT_FILE, os_is_folder(path) ? EISDIR : errno, "%s", path);
    }
    status = homing_take(a, path, file.bytes, file.size, any, all);
    free(file.bytes);
    return status;
}

/* The text of a file, to be freed; NULL: no memory. */
static char *make_text(const app *a, const homing *all, size_t *size)
{
    const grobo_model *model = app_model(a);
    json_t *file = json_object();
    for (int j = 0; j < model->n_joints; j++) {
        json_object_set_new(file, grobo_model_joint(model, j)->name,
                            json_pack("{s:i,s:i,s:i,s:i,s:i}", "id",
                                      grobo_model_joint(model, j)->motor, "drive_mode", 0,
                                      "homing_offset", (int)all[j].offset, "range_min",
                                      (int)all[j].min, "range_max", (int)all[j].max));
    }
    *size = json_dumpb(file, NULL, 0, JSON_INDENT(4));
    char *text = malloc(*size + 1);
    if (text) {
        (void)json_dumpb(file, text, *size, JSON_INDENT(4));
        text[(*size)++] = '\n';
    }
    json_decref(file);
    return text;
}

int homing_write(app *a, const char *path, const homing *all, char *written, size_t capacity)
{
    size_t size;
    char *text = make_text(a, all, &size);
    int error = text ? GROBO_ERR_EXISTS : GROBO_ERR_NOMEM;
    for (int n = 1; n < 1000 && error == GROBO_ERR_EXISTS; n++) {
        char number[16] = "";
        if (n > 1) {
            snprintf(number, sizeof number, "%d", n);
        }
        snprintf(written, capacity, path ? "%s" : "%s-before%s.json",
                 path ? path : robot_of(a)->name, number);
        error = path ? file_save(written, text, size) : file_save_new(written, text, size);
    }
    free(text);
    return error ? app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: %s", written,
                            file_write_error_text(error))
                 : 0;
}
