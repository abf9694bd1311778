/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/bringup/scan.h"
#include "tools/grctl/lang/lang.h"

/* One family at one rate: the line is opened for it. */
static int look_for(app *a, scan_search *s, const grobo_robot_family *family, scan_pass *p)
{
    conn c;
    cli_value *baud = &a->line.global[GLOBAL_BAUD];
    const cli_value before = *baud;
    *baud = (cli_value){.given = 1, .number = p->baud_bps};
    int status = conn_open_unchecked(&c, a);
    if (!status && grobo_session_sim(c.session)) {
        status = app_fail(a, EXIT_USAGE, "ARG", "%s; 'grctl sim --servo' makes one", _(s->who));
    }
    int error = status ? 0 : scan_line(&c, p);
    if (error) {
        status = conn_fail(&c, error, "scan");
    } else if (!status) {
        s->ends(s, family, &c, p);
    }
    status = conn_close(&c, status);
    *baud = before;
    return status;
}

/* Rate number i at which servos of a family are looked for, 0 behind the last. */
static int rate_of(const app *a, const scan_search *s, const grobo_robot_family *family, int i)
{
    const cli_value *asked = app_global(a, GLOBAL_BAUD);
    const grobo_servo_table *table = family->tables[0];
    bool tcp = strncmp(conn_requested(a), "tcp:", 4) == 0;
    if (asked->given || tcp) {
        return i > 0 ? 0 : asked->given ? (int)asked->number : (int)family->baud_bps;
    }
    if (s->all_rates && table->rate_count > 0) {
        return i < table->rate_count ? table->rates[i].bps : 0;
    }
    return family_usual_bps(family, (size_t)i);
}

static int look_at_rates(app *a, scan_search *s, const grobo_robot_family *family)
{
    const grobo_protocol *protocol = a->driver->protocol;
    static scan_pass p;
    int n = 0, status = 0;
    while (rate_of(a, s, family, n) > 0) {
        n++;
    }
    for (int i = 0; i < n && !status; i++) {
        memset(&p, 0, sizeof p);
        p.driver = a->driver;
        p.baud_bps = rate_of(a, s, family, i);
        p.first = s->first > protocol->id_min ? s->first : protocol->id_min;
        p.last = s->last < protocol->id_max ? s->last : protocol->id_max;
        if (s->begins) {
            s->begins(s, &p, i, n);
        }
        status = p.first <= p.last ? look_for(a, s, family, &p) : 0;
    }
    return status;
}

int scan_families(app *a, scan_search *s)
{
    const grobo_driver *driver = a->driver;
    const struct config_robot *robot = a->robot;
    int status = 0;
    a->robot = NULL; /* its trims are of other joints */
    for (size_t i = 0; grobo_robot_family_at(i) && !status; i++) {
        const grobo_robot_family *family = grobo_robot_family_at(i);
        a->driver = family_driver(family);
        if (a->driver && (strcmp(s->family, "all") == 0 || strcmp(family->name, s->family) == 0)) {
            status = look_at_rates(a, s, family);
        }
    }
    a->driver = driver;
    a->robot = robot;
    return status;
}
