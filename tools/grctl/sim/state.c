/* SPDX-License-Identifier: MIT */
/*
 * The file: a line "grobo sim state 1", and for each servo of the chain, in its order, a line with
 * its model and its registers No.4-29, all in hexadecimal. It is replaced whole after each flash
 * write, so that a simulator that is killed leaves the file of before or after it.
 */
#include <errno.h>
#include <string.h>

#include <grobo/core/serial.h>
#include <grobo/core/sim.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/alarm.h"
#include "tools/grctl/os/pipe.h"
#include "tools/grctl/sim/state.h"

/* A flash write takes 1 s; it is looked for a little later, and then once a second. */
#define FIRST_LOOK_US 1050000
#define NEXT_LOOK_US 1000000

static const char head[] = "grobo sim state 1\n";

enum { LINE_BYTES = 6 + 3 * GROBO_SIM_FLASH_BYTES, FILE_BYTES = 64 + GROBO_SIM_SERVOS_MAX * 128 };

static grobo_sim *sim_of(const sim_state *s)
{
    return grobo_sim_server_sim(s->server);
}

static int fail(const sim_state *s, const char *why)
{
    return app_fail(s->a, EXIT_FILE, "IO", "sim: --state: %s: %s", s->path, lang_text(why));
}

/* ---- writing --------------------------------------------------------------------------------- */

static size_t put_servo(const sim_state *s, int servo, char *text, size_t room)
{
    uint8_t flash[GROBO_SIM_FLASH_BYTES];
    char hex[3 * GROBO_SIM_FLASH_BYTES + 1];
    int32_t model = 0;
    (void)grobo_sim_get_register(sim_of(s), servo, GROBO_RS30X_MODEL, &model);
    (void)grobo_sim_get_flash(sim_of(s), servo, flash);
    (void)grobo_hex(flash, sizeof flash, hex, sizeof hex);
    return (size_t)snprintf(text, room, "%04X %s\n", (unsigned)model, hex);
}

static int write_file(sim_state *s)
{
    char text[FILE_BYTES];
    size_t used = sizeof head - 1;
    memcpy(text, head, used);
    for (int i = 0; i < grobo_sim_servos(sim_of(s)); i++) {
        used += put_servo(s, i, text + used, sizeof text - used);
    }
    s->dirty = false;
    return file_save(s->path, text, used);
}

static void keep(sim_state *s)
{
    int error = s->dirty ? write_file(s) : 0;
    if (error && !s->failed) {
        (void)fail(s, file_write_error_text(error));
    }
    s->failed |= error < 0;
}

/* What servos do on their own is known when they are looked at. True while one writes its flash. */
static bool settle(sim_state *s)
{
    bool busy = false;
    grobo_sim_view view;
    grobo_sim_step(sim_of(s), grobo_now_us());
    for (int i = 0; grobo_sim_look(sim_of(s), i, &view) == 0; i++) {
        busy |= view.deaf && view.cable == GROBO_SIM_CABLE_IN;
    }
    return busy;
}

static void look_again(sim_state *s, long us)
{
    if (!s->settling) {
        s->settling = true;
        alarm_set(s->settle, us);
    }
}

static void on_settle(evutil_socket_t fd, short what, void *ctx)
{
    sim_state *s = ctx;
    bool busy = settle(s);
    (void)fd;
    (void)what;
    s->settling = false;
    alarm_clear(s->settle);
    keep(s);
    if (busy) {
        look_again(s, NEXT_LOOK_US);
    }
}

void sim_state_event(sim_state *s, const grobo_sim_event *event)
{
    if (!s->a) {
        return;
    }
    if (event->kind == GROBO_SIM_SAVED) {
        s->dirty = true;
    } else if (event->kind == GROBO_SIM_PACKET &&
               (event->bytes[3] & (GROBO_RS30X_FLASH | GROBO_RS30X_FACTORY)) != 0) {
        look_again(s, FIRST_LOOK_US);
    }
}

/* ---- reading --------------------------------------------------------------------------------- */

static int digit(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Two digits; negative: they are none. */
static int read_byte(const char *text)
{
    int high = digit(text[0]), low = high < 0 ? -1 : digit(text[1]);
    return low < 0 ? -1 : high * 16 + low;
}

/* The line of a servo, LINE_BYTES and a NUL behind it; NULL, or what is wrong with it. */
static const char *read_servo(const sim_state *s, int servo, const char *line)
{
    uint8_t flash[GROBO_SIM_FLASH_BYTES];
    int high = read_byte(line), low = high < 0 ? -1 : read_byte(line + 2);
    int32_t model = 0;
    (void)grobo_sim_get_register(sim_of(s), servo, GROBO_RS30X_MODEL, &model);
    if (low < 0 || high * 256 + low != model) {
        return _("another servo than the one to simulate");
    }
    for (int i = 0; i < GROBO_SIM_FLASH_BYTES; i++) {
        int byte = line[4 + 3 * i] == ' ' ? read_byte(line + 5 + 3 * i) : -1;
        if (byte < 0) {
            return _("no registers in hexadecimal");
        }
        flash[i] = (uint8_t)byte;
    }
    return grobo_sim_set_flash(sim_of(s), servo, flash) < 0
               ? _("a register has a value that no servo can have")
               : NULL;
}

static const char *read_text(const sim_state *s, const char *text, size_t size, int *line)
{
    int n = grobo_sim_servos(sim_of(s));
    const char *wrong = NULL;
    *line = 1;
    if (size < sizeof head - 1 || memcmp(text, head, sizeof head - 1) != 0) {
        return _("is not a state of 'grctl sim'");
    }
    text += sizeof head - 1;
    size -= sizeof head - 1;
    for (int i = 0; i < n && !wrong; i++) {
        const char *end = memchr(text, '\n', size);
        ++*line;
        if (!end || end - text != LINE_BYTES - 2) {
            return end ? _("is not a line of a servo") : _("is cut off");
        }
        wrong = read_servo(s, i, text);
        size -= (size_t)(end + 1 - text);
        text = end + 1;
    }
    if (!wrong && size > 0) {
        ++*line;
        return _("is of more servos than are to be simulated");
    }
    return wrong;
}

static int read_file(sim_state *s, FILE *file)
{
    char text[FILE_BYTES];
    char why[160];
    size_t size = fread(text, 1, sizeof text, file);
    int line = 1;
    const char *wrong = ferror(file) ? _("cannot be read") : NULL;
    fclose(file);
    if (!wrong && size == sizeof text) {
        wrong = _("is not a state of 'grctl sim'");
    }
    if (!wrong) {
        wrong = read_text(s, text, size, &line);
    }
    if (!wrong) {
        return 0;
    }
    snprintf(why, sizeof why, _("line %d: %s; name another file"), line, wrong);
    return fail(s, why);
}

static int load(sim_state *s)
{
    if (os_is_folder(s->path)) {
        return fail(s, app_error_text(GROBO_ERR_ISDIR));
    }
    if (pipe_is(s->path)) {
        return fail(s, "is not a regular file");
    }
    FILE *file = fopen(s->path, "rb");
    if (file) {
        return read_file(s, file);
    }
    if (errno != ENOENT) {
        return fail(s, app_cause_text(errno));
    }
    int error = write_file(s);
    return error ? fail(s, file_write_error_text(error)) : 0;
}

/* ---- from begin to end ----------------------------------------------------------------------- */

int sim_state_start(sim_state *s, app *a, struct event_base *base, grobo_sim_server *server,
                    const char *path)
{
    *s = (sim_state){.a = a, .server = server};
    snprintf(s->path, sizeof s->path, "%s", path);
    int status = os_lock_file(&s->lock, s->path);
    if (status) {
        s->a = NULL;
        return app_fail(a, EXIT_FILE, status == EWOULDBLOCK ? "BUSY" : "IO", "sim: --state: %s: %s",
                        path,
                        status == EWOULDBLOCK ? _("another simulator has it; name another file")
                                              : app_cause_text(status));
    }
    s->settle = alarm_new(base, on_settle, s);
    if (!s->settle) {
        return fail(s, app_error_text(GROBO_ERR_NOMEM));
    }
    return load(s);
}

int sim_state_end(sim_state *s, int status)
{
    if (!s->a) {
        return status;
    }
    if (s->settle) {
        (void)settle(s);
        keep(s);
        event_free(s->settle);
    }
    os_unlock_file(&s->lock);
    return s->failed ? EXIT_FILE : status;
}
