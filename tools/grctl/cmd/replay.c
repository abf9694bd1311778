/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/session.h>

#include "tools/grctl/cli/each_line.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/trace.h"
#include "tools/grctl/decode/replay.h"

/* Line and clock of the trace, as its first chunk has them; options go before. */
static void take_line(replay *r, const pcapng_chunk *chunk)
{
    const cli_value *wiring = app_global(r->a, GLOBAL_WIRING);
    const cli_value *baud = app_global(r->a, GLOBAL_BAUD);
    uint64_t speed_bps = chunk->interface->speed_bps;
    r->first_us = chunk->time_us;
    r->wiring = GROBO_WIRING_BOARD;
    if (!trace_wiring(chunk->interface, &r->wiring) || wiring->given) {
        r->wiring = (grobo_wiring)wiring->choice;
    }
    r->baud_bps = speed_bps <= INT32_MAX ? (int)speed_bps : 0;
    if (baud->given) {
        r->baud_bps = (int)baud->number;
    }
}

static int take_first(void *ctx, const pcapng_chunk *chunk)
{
    take_line(ctx, chunk);
    return -1;
}

/* Lines do not know of each other in their simulators: one after the other. */
static int run_lines(app *a, bool to_sim)
{
    if (!to_sim) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "replay: a trace of several lines goes to a simulator: without -d");
    }
    a->line.global[GLOBAL_DEVICE] = (cli_value){.given = 1, .text = GROBO_DEVICE_SIM};
    return each_line_all(a);
}

static int run(app *a)
{
    static replay r;
    const cli_value *device = app_global(a, GLOBAL_DEVICE);
    bool to_sim = !device->given || a->unasked || strcmp(device->text, GROBO_DEVICE_SIM) == 0;
    if (robot_of(a)->n_lines > 0) {
        return run_lines(a, to_sim);
    }
    memset(&r, 0, sizeof r);
    r.a = a;
    r.line = a->on_line;
    r.each = a->on_line && !app_global(a, GLOBAL_LINE)->given;
    r.path = a->line.argument[0];
    r.first_us = -1;
    if (strcmp(r.path, "-") == 0) {
        return app_fail(a, EXIT_USAGE, "ARG", "replay: a trace is read twice: name a file");
    }
    if (!to_sim && !family_is(app_driver(a), "rs30x")) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "replay: cannot judge the frames of %s before they move a real robot; "
                        "without -d they go to a simulator",
                        app_model(a)->name);
    }
    int status = replay_read(&r, take_first, &r);
    if (status > 0) {
        return status;
    }
    if (status == 0) {
        return app_fail(a, EXIT_FILE, "EMPTY",
                        r.line ? "%s: nothing went over line %s" : "%s: nothing went over the line",
                        r.path, r.line);
    }
    status = to_sim ? replay_to_sim(&r) : replay_to_robot(&r);
    return status ? status : replay_report(&r);
}

const cli_command cmd_replay = {
    .name = "replay",
    COMMAND_ARGUMENTS("TRACE", 1, 1, CLI_ARG_FILE),
    .summary = "run a trace again and compare the replies",
    .details =
        "Sends what the host said in a trace of --trace, at the same times, and compares the\n"
        "replies with those in the trace: which are equal, differ, are missing, or came though\n"
        "there were none. The first differences are shown in words, with -v all. Exit status 0\n"
        "if nothing differs, 1 otherwise.\n"
        "Without -d it goes to a fresh simulator of --robot in virtual time, which takes no\n"
        "time; of a robot of several lines each to its own, one after the other. With -d it goes\n"
        "to a real robot, of RS30x servos only: reads only as they are; goals and torque through\n"
        "the same checks as everything else, after a question (or with --yes); a trace that does\n"
        "anything else (settings, flash, stored motions) is refused before anything is sent.\n",
    .example = "  grctl -d sim --trace walk.pcapng play motions/greet.pseq\n"
               "  grctl replay walk.pcapng\n",
    .run = run,
};
