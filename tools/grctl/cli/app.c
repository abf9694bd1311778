/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/files.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

static bool wants_color(const app *a, bool screen)
{
    const cli_value *v = app_global(a, GLOBAL_COLOR);
    const char *no_color = getenv("NO_COLOR");
    if (v->given && v->choice == 1) { /* always */
        return true;
    }
    if (v->given && v->choice == 2) { /* never */
        return false;
    }
    return screen && !(no_color && *no_color);
}

/* One that takes escape sequences. */
static bool is_screen(bool tty)
{
    const char *term = getenv("TERM"); /* not there on Windows */
    return tty && !(term && (!*term || strcmp(term, "dumb") == 0));
}

void app_settle(app *a)
{
    a->json = app_global(a, GLOBAL_JSON)->given > 0;
    lang_keep_english(a->json);
    a->verbosity = app_global(a, GLOBAL_QUIET)->given ? -1 : app_global(a, GLOBAL_VERBOSE)->given;
    a->tty_in = os_is_terminal(stdin);
    a->tty_out = os_is_terminal(stdout);
    a->tty_err = os_is_terminal(stderr);
    a->screen_out = is_screen(a->tty_out);
    a->screen_err = is_screen(a->tty_err);
    a->color_out = wants_color(a, a->screen_out);
    a->color_err = wants_color(a, a->screen_err);
}

const cli_value *app_option(const app *a, int i)
{
    return &a->line.option[i];
}

const cli_value *app_global(const app *a, int i)
{
    return &a->line.global[i];
}

const grobo_driver *app_driver(const app *a)
{
    return a->driver ? a->driver
                     : grobo_gr001_driver((grobo_wiring)app_global(a, GLOBAL_WIRING)->choice);
}

const grobo_model *app_model(const app *a)
{
    return app_driver(a)->model;
}

double app_number(const app *a, int i, double otherwise)
{
    return a->line.option[i].given ? a->line.option[i].number : otherwise;
}

void app_make_one_line(char *text)
{
    for (unsigned char *c = (unsigned char *)text; *c; c++) {
        bool c1 = c[0] == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0; /* controls of eight bits */
        if (*c < 0x20 || *c == 0x7f || c1) {
            *c = '?';
            c += c1;
            *c = '?';
        }
    }
}

static int fail(app *a, int status, const char *code, grobo_trip trip, const char *format,
                va_list list)
{
    char text[APP_LINE_BYTES];
    int n = snprintf(text, sizeof text, "%s", a->place);
    vsnprintf(text + n, sizeof text - (size_t)n, lang_text(format), list);
    app_make_one_line(text);
    snprintf(a->failed, sizeof a->failed, "%s", code);
    if (a->hushed) {
        memcpy(a->hushed, text, sizeof text);
        return status;
    }
    output_flush();
    output_complain("%sgrctl:%s %s\n", a->color_err ? "\033[1;31m" : "",
                    a->color_err ? "\033[0m" : "", text);
    if (a->json) {
        json_t *word = trip == GROBO_TRIP_NONE ? NULL : app_json_code(grobo_trip_name(trip));
        app_print_json(json_pack("{s:{s:o,s:o,s:o*}}", "error", "code", app_json_code(code),
                                 "message", app_json_text(text), "trip", word));
    }
    return status;
}

void app_hush(app *a, char *text)
{
    *text = '\0';
    a->hushed = text;
    a->verbosity = -1;
    a->json = false;
}

int app_fail(app *a, int status, const char *code, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    status = fail(a, status, code, GROBO_TRIP_NONE, format, list);
    va_end(list);
    return status;
}

/* With the reason behind a colon. */
static int fail_because(app *a, int status, int error, const char *reason, const char *format,
                        va_list list)
{
    char text[APP_LINE_BYTES];
    vsnprintf(text, sizeof text, lang_text(format), list);
    return app_fail(a, status, grobo_error_name(error), "%s: %s", text, reason);
}

int app_fail_error(app *a, int status, int error, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    status = fail_because(a, status, error, app_error_text(error), format, list);
    va_end(list);
    return status;
}

int app_fail_trip(app *a, grobo_trip trip, const char *format, ...)
{
    int error = trip == GROBO_TRIP_HOST_STALL ? GROBO_ERR_STALLED : GROBO_ERR_LATCHED;
    va_list list;
    va_start(list, format);
    fail(a, EXIT_SAFETY, grobo_error_name(error), trip, format, list);
    va_end(list);
    return EXIT_SAFETY;
}

int app_status_of(int error)
{
    switch (error) {
    case GROBO_ERR_LIMIT:
    case GROBO_ERR_SPEED:
    case GROBO_ERR_LATCHED:
    case GROBO_ERR_UNWATCHED:
    case GROBO_ERR_STALLED:
        return EXIT_SAFETY;
    case GROBO_ERR_ARG:
        return EXIT_USAGE;
    case GROBO_ERR_SYNTAX:
        return EXIT_FILE;
    }
    return EXIT_ROBOT;
}

const char *app_error_text(int error)
{
    return lang_text(grobo_error_text(error));
}

static int error_of_cause(int number)
{
    switch (number) {
    case ENOENT:
    case ENOTDIR:
        return GROBO_ERR_NOENT;
    case EISDIR:
        return GROBO_ERR_ISDIR;
    case EACCES:
    case EPERM:
        return GROBO_ERR_PERM;
    case ENOSPC:
        return GROBO_ERR_DISK;
    }
    return GROBO_ERR_IO;
}

const char *app_cause_text(int number)
{
    int error = error_of_cause(number);
    return error == GROBO_ERR_NOENT ? _("no such file")
           : error == GROBO_ERR_IO  ? strerror(number)
                                    : app_error_text(error);
}

int app_fail_cause(app *a, int status, int number, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    status = fail_because(a, status, error_of_cause(number), app_cause_text(number), format, list);
    va_end(list);
    return status;
}

static void say(const app *a, int least, const char *format, va_list list)
{
    char text[APP_LINE_BYTES];
    if (a->verbosity < least) {
        return;
    }
    vsnprintf(text, sizeof text, lang_text(format), list);
    app_make_one_line(text);
    output_complain("%s\n", text);
}

void app_note(const app *a, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    say(a, 0, format, list);
    va_end(list);
}

void app_detail(const app *a, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    say(a, 1, format, list);
    va_end(list);
}

void app_report(const app *a, json_t *object, const char *format, ...)
{
    va_list list;
    if (a->json) {
        app_print_json(object);
        return;
    }
    json_decref(object);
    va_start(list, format);
    say(a, 0, format, list);
    va_end(list);
}

void app_done(const app *a, const char *text)
{
    app_report(a, json_pack("{s:b}", "done", 1), "%s", lang_text(text));
}

static bool dropped; /* some of standard output */

static void report_dropped(const app *a, const char *name, uint64_t n)
{
    if (n > 0) {
        app_note(a, "standard %s: %llu messages were dropped: its reader was too slow", name,
                 (unsigned long long)n);
    }
}

void app_attach(const app *a)
{
    output_dropped lost = output_attach();
    dropped |= lost.out > 0;
    report_dropped(a, _("output"), lost.out);
    report_dropped(a, _("error"), lost.err);
}

int app_finish(app *a, int status)
{
    app_attach(a);
    if (output_flush() || status != EXIT_DONE) {
        return status == EXIT_DONE && dropped ? EXIT_ROBOT : status;
    }
    if (output_error() == EPIPE) {
        return EXIT_SIGNAL + OS_BROKEN_PIPE;
    }
    a->json = false; /* there is no output left to put it on */
    return app_fail_cause(a, EXIT_ROBOT, output_error(), "standard output: cannot write");
}

void app_print(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    output_print(format, list);
    va_end(list);
}

void app_print_home(const app *a)
{
    if (a->screen_out) {
        app_print("\033[H\033[J");
    }
}

void app_print_line(const char *format, ...)
{
    char text[GROBO_PATH_MAX_BYTES + APP_LINE_BYTES];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    app_make_one_line(text);
    app_print("%s\n", text);
}

static int print_part(const char *bytes, size_t size, void *ctx)
{
    (void)ctx;
    output_bytes(bytes, size);
    return 0;
}

static const char *json_line;

void app_json_line(const char *name)
{
    json_line = name;
}

void app_print_json(json_t *object)
{
    if (json_line) {
        json_object_set_new(object, "line", json_string(json_line));
    }
    json_dump_callback(object, print_part, NULL, JSON_COMPACT | JSON_REAL_PRECISION(12));
    app_print("\n");
    output_flush();
    json_decref(object);
}

json_t *app_json_text(const char *text)
{
    json_t *string = json_string(text);
    size_t n = strlen(text);
    for (size_t cut = 1; !string && cut < 4 && cut < n; cut++) {
        string = json_stringn(text, n - cut); /* of the last character some bytes were cut off */
    }
    if (!string) { /* not UTF-8: keep what can be shown */
        char *copy = strdup(text);
        for (char *c = copy; c && *c; c++) {
            if ((unsigned char)*c >= 0x80) {
                *c = '?';
            }
        }
        string = json_string(copy ? copy : "?");
        free(copy);
    }
    return string;
}

json_t *app_json_code(const char *name)
{
    char code[32];
    size_t n = 0;
    for (; name[n] && n < sizeof code; n++) {
        bool large = name[n] >= 'A' && name[n] <= 'Z'; /* whatever the locale says */
        bool joins = name[n] == ' ' || name[n] == '-';
        code[n] = joins ? '_' : (char)(large ? name[n] - 'A' + 'a' : name[n]);
    }
    return json_stringn(code, n);
}

json_t *app_json_printed(void (*print)(FILE *to))
{
    char *text = os_printed(print);
    json_t *string = text ? json_string(text) : json_null();
    free(text);
    return string;
}

json_t *app_json_number(double number, int decimals)
{
    double scale = pow(10, decimals);
    double rounded = round(number * scale) / scale;
    if (!isfinite(rounded)) {
        return json_null();
    }
    return json_real(rounded == 0 ? 0 : rounded); /* no -0.0 */
}
