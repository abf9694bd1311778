/* SPDX-License-Identifier: MIT */
#include <stdarg.h>

#include "tools/grctl/bringup/checkup.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/lang/lang.h"

void checkup_start(checkup *k, app *a)
{
    *k = (checkup){.a = a, .checks = a->json ? json_array() : NULL};
}

static void print(const checkup *k, const char *color, const char *verdict, const char *name,
                  const char *message)
{
    if (k->aside) {
        app_note(k->a, "%-4s  %-10s  %s", verdict, name, message);
        return;
    }
    app_print("%s%-4s%s  %-10s  %s\n", k->a->color_out ? color : "", verdict,
              k->a->color_out ? "\033[0m" : "", name, message);
}

void checkup_found(void *ctx, const char *name, const char *fix, const char *format, ...)
{
    checkup *k = ctx;
    bool ok = !fix || !*fix;
    char message[APP_LINE_BYTES];
    va_list list;
    va_start(list, format);
    vsnprintf(message, sizeof message, lang_text(format), list);
    va_end(list);
    app_make_one_line(message);
    fix = fix ? lang_text(fix) : NULL;
    k->n++;
    k->failed += !ok;
    if (k->checks) {
        json_array_append_new(k->checks, json_pack("{s:s,s:b,s:o,s:o}", "name", name, "ok", (int)ok,
                                                   "message", app_json_text(message), "fix",
                                                   ok ? json_null() : app_json_text(fix)));
    } else if (!ok) {
        char line[APP_LINE_BYTES + sizeof "-> "];
        snprintf(line, sizeof line, "-> %s", fix);
        print(k, "\033[1;31m", "BAD", name, message);
        print(k, "", "", "", line);
    } else if (!fix || k->a->verbosity > 0) {
        print(k, "\033[32m", "ok", name, message);
    }
    output_flush();
}

int checkup_end(checkup *k)
{
    if (k->checks) {
        app_print_json(json_pack("{s:b,s:o}", "ok", k->failed == 0, "checks", k->checks));
    } else if (k->failed) {
        app_note(k->a, "%d of %d check%s failed", k->failed, k->n, k->n == 1 ? "" : "s");
    } else {
        app_note(k->a, "all %d checks passed", k->n);
    }
    return k->failed ? EXIT_ROBOT : EXIT_DONE;
}
