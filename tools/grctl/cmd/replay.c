/* SPDX-License-Identifier: MIT */
#include <string.h>

#include <grobo/session.h>

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

static int run(app *a)
{
    static replay r;
    const cli_value *device = app_global(a, GLOBAL_DEVICE);
    bool to_sim = !device->given || strcmp(device->text, GROBO_DEVICE_SIM) == 0;
    memset(&r, 0, sizeof r);
    r.a = a;
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
        return app_fail(a, EXIT_FILE, "EMPTY", "%s: nothing went over the line", r.path);
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
        "time. With -d it goes to a real robot, of RS30x servos only: reads only as they are;\n"
        "goals and torque through the same checks as everything else, after a question (or with\n"
        "--yes); a trace that does anything else (settings, flash, stored motions) is refused\n"
        "before anything is sent.\n",
    .example = "  grctl -d sim --trace walk.pcapng play motions/greet.pseq\n"
               "  grctl replay walk.pcapng\n",
    .run = run,
};
