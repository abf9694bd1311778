/* SPDX-License-Identifier: MIT */
/* What servos keep over power-off, saved to a file before it changes and put back from it. */
#include <errno.h>
#include <string.h>
#include <time.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/conn/eeprom.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

#define EEPROM (GROBO_REGISTER_KEPT | GROBO_REGISTER_W)

static bool is_kept(const grobo_servo_register *reg)
{
    return (reg->flags & EEPROM) == EEPROM;
}

static size_t count_kept(const grobo_servo_model *servo)
{
    const grobo_servo_register *reg;
    size_t n = 0;
    for (size_t i = 0; (reg = grobo_servo_register_row(servo, i)) != NULL; i++) {
        n += is_kept(reg);
    }
    return n;
}

static void take(void *registers, const grobo_servo_register *reg, int32_t value)
{
    json_object_set_new(registers, reg->name, json_integer(value));
}

/* eeprom/NAME-1-20261127-184500.json; a second file of one second is called -2. */
static FILE *create(const conn *c, int id, char *path, size_t capacity)
{
    char stamp[32] = "", name[160];
    time_t now = time(NULL);
    const struct tm *utc = gmtime(&now);
    if (utc) {
        strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", utc);
    }
    for (int n = 1; n < 1000; n++) {
        snprintf(name, sizeof name, "eeprom/%.60s-%d-%s%s%.0d.json", conn_model(c)->name, id, stamp,
                 n > 1 ? "-" : "", n > 1 ? n : 0);
        errno = 0;
        FILE *file = os_state_path(name, path, capacity) ? fopen(path, "wx") : NULL;
        if (file || errno != EEXIST) {
            return file;
        }
    }
    return NULL;
}

static int write_file(conn *c, int id, const json_t *all, char *path, size_t capacity)
{
    *path = '\0';
    FILE *file = create(c, id, path, capacity);
    bool written = file && json_dumpf(all, file, JSON_INDENT(2)) == 0 && fputc('\n', file) != EOF;
    if (file && fclose(file) != 0) {
        written = false;
    }
    return written ? 0
                   : app_fail(c->a, EXIT_FILE, "IO",
                              "%s: what servo %d keeps cannot be saved: %s; nothing was written",
                              *path ? path : _("its file"), id, strerror(errno ? errno : ENOENT));
}

int eeprom_save(conn *c, int id, const grobo_servo_model *servo, char *path, size_t capacity)
{
    json_t *registers = json_object();
    const servos_visit visit = {is_kept, take, registers};
    int error = servos_each(c, id, servo, &visit);
    if (!error && json_object_size(registers) != count_kept(servo)) {
        error = GROBO_ERR_UNSUPPORTED; /* a file of a part would put back a part */
    }
    if (error) {
        json_decref(registers);
        return conn_fail_servo(c, error, id);
    }
    json_t *all =
        json_pack("{s:i,s:s,s:o}", "id", id, "model", servo->name, "registers", registers);
    int status = write_file(c, id, all, path, capacity);
    json_decref(all);
    return status;
}

static int complain(app *a, const char *path, const char *what, const char *why)
{
    return app_fail(a, EXIT_FILE, "SYNTAX", "%s: %s: %s", path, what, lang_text(why));
}

/* Each a register of the model that may be written so. */
static int check(app *a, const char *path, const grobo_servo_model *servo, json_t *registers)
{
    const char *name;
    json_t *value;
    json_object_foreach(registers, name, value)
    {
        const grobo_servo_register *reg = grobo_servo_register_named(servo, name);
        if (!reg || !is_kept(reg)) {
            return complain(a, path, name, N_("its servo keeps no such register"));
        }
        if (!json_is_integer(value) || json_integer_value(value) < reg->min ||
            json_integer_value(value) > reg->max) {
            return complain(a, path, name, N_("its servo does not take that value"));
        }
    }
    return 0;
}

/* What a servo keeps that does not tell its model may be of any of its series. */
static bool is_of(const grobo_servo_model *servo, const char *model)
{
    bool any = family_is_any(servo) && !grobo_servo_register_of(servo, GROBO_ROLE_MODEL);
    return strcmp(model, servo->name) == 0 ||
           (any && grobo_servo_model_named(grobo_servo_series(servo), model));
}

int eeprom_load(app *a, const char *path, const grobo_servo_model *servo, json_t **registers)
{
    json_error_t error;
    int status = file_refuse_pipe(a, path);
    if (status) {
        return status;
    }
    errno = 0;
    json_t *all = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    if (!all && errno) {
        return app_fail(a, EXIT_FILE, "IO", "%s: %s", path, strerror(errno));
    }
    const char *model = json_string_value(json_object_get(all, "model"));
    json_t *found = json_object_get(all, "registers");
    if (!model || !json_is_object(found)) {
        status = complain(a, path, "registers", N_("it is no file of servo-set or calibrate"));
    } else if (!is_of(servo, model)) {
        status = app_fail(a, EXIT_SAFETY, "MISMATCH", "%s: it is of a %.40s; the servo is a %s",
                          path, model, servo->name);
    } else {
        status = check(a, path, servo, found);
    }
    *registers = status ? NULL : json_incref(found);
    json_decref(all);
    return status;
}
