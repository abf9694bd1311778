/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stdio.h>

#include "tools/grctl/bringup/contact_step.h"
#include "tools/grctl/lang/lang.h"

static const char *const verdicts[] = {N_("as assumed"), N_("NOT as assumed"), N_("not done")};
static const char *const words[] = {"as_assumed", "not_as_assumed", "not_done"};

/* The report is in English; what the person reads is in that of the person. */
void contact_note(contact *k, const char *name, verdict v, const char *format, ...)
{
    char message[APP_LINE_BYTES], said[APP_LINE_BYTES];
    va_list list, again;
    va_start(list, format);
    va_copy(again, list);
    vsnprintf(message, sizeof message, format, list);
    vsnprintf(said, sizeof said, _(format), again);
    va_end(again);
    va_end(list);
    app_make_one_line(message);
    app_make_one_line(said);
    k->n_bad += v == NOT_AS_ASSUMED;
    app_note(k->a, "%-14s  %-14s  %s", _(verdicts[v]), name, said);
    heap_print(&k->text, "%-14s  %-14s  %s\n", verdicts[v], name, message);
    json_array_append_new(k->steps, json_pack("{s:s,s:s,s:o}", "name", name, "verdict", words[v],
                                              "message", app_json_text(message)));
}

/* ---- a line for each part -------------------------------------------------------------------- */

static void on_bytes(conn *c, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                     size_t size)
{
    contact *k = c->ctx;
    (void)bytes;
    (void)size;
    *(direction == GROBO_DIR_TX ? &k->sent_us : &k->came_us) = now_us;
}

/* Questions are asked while no line is open: each part opens it, with a trace of its own. */
int contact_open(contact *k, const char *part, bool moves)
{
    snprintf(k->trace, sizeof k->trace, "%.900s-%s.pcapng", k->prefix, part);
    k->a->line.global[GLOBAL_TRACE] = (cli_value){.given = 1, .text = k->trace};
    int status = moves ? conn_open_to_move(&k->c, k->a) : conn_open(&k->c, k->a);
    k->c.ctx = k;
    k->c.on_bytes = on_bytes;
    return status;
}

int contact_close(contact *k, int status)
{
    k->c.on_bytes = NULL;
    return conn_close(&k->c, status);
}

/* ---- the joint ------------------------------------------------------------------------------- */

int contact_sense(contact *k, grobo_joint_info *is)
{
    int error = conn_sense(&k->c, GROBO_JOINT_BIT(k->joint), GROBO_SENSE_FULL);
    return error ? error : grobo_robot_joint(k->c.robot, k->joint, is);
}
