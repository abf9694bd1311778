/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

/* The last columns stay free for the ^C that a terminal shows. */
enum { BAR_MOST = 40, LINE_BYTES = 512, FREE = 3 };

void progress_start(progress *p, const app *a)
{
    memset(p, 0, sizeof *p);
    p->shown = a->screen_err && !a->json && a->verbosity >= 0;
    p->blocks = os_shows_utf8();
}

static size_t append(char *line, size_t at, const char *text)
{
    size_t n = strlen(text);
    if (at + n >= LINE_BYTES) {
        return at;
    }
    memcpy(line + at, text, n + 1);
    return at + n;
}

void progress_draw(progress *p, double fraction, const char *text)
{
    char line[LINE_BYTES] = "";
    size_t at = 0;
    if (!p->shown || output_is_behind(stderr)) {
        return;
    }
    int room = os_columns(stderr) - FREE; /* it may have changed */
    int bar = fraction < 0 ? 0 : room - 3 - lang_columns(text, strlen(text));
    bar = bar > BAR_MOST ? BAR_MOST : bar;
    if (bar >= 8) {
        int full = (int)(fraction * bar + 0.5);
        full = full < 0 ? 0 : full > bar ? bar : full;
        at = append(line, at, p->blocks ? "" : "[");
        for (int i = 0; i < bar; i++) {
            at = append(line, at, p->blocks ? (i < full ? "█" : "░") : i < full ? "#" : "-");
        }
        at = append(line, at, p->blocks ? "  " : "] ");
    }
    output_complain("\r%s%.*s\033[K", line, (int)lang_fit(text, room > 0 ? room : 0), text);
    p->drawn = true;
}

void progress_clear(progress *p)
{
    if (p->drawn) {
        output_complain("\r\033[K");
    }
    p->drawn = false;
}
