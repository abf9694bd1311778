/* SPDX-License-Identifier: MIT */
/* A trace against a fresh simulator: chunks as they were, at their times, in virtual time. */
#include <string.h>

#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>

#include "tools/grctl/cli/robot.h"
#include "tools/grctl/decode/replay.h"

/* After the last chunk a reply may take this long. */
enum { TAIL_US = 1000000 };

typedef struct stage {
    replay *r;
    grobo_robot_sim robot; /* what the simulator is of */
    grobo_sim sim;
    int64_t now_us; /* from the trace's beginning */
} stage;

static void on_host(void *ctx, const frame *f)
{
    replay_ask(ctx, f);
}

static void listen(stage *s)
{
    uint8_t bytes[256];
    size_t n;
    while ((n = grobo_sim_tx(&s->sim, bytes, sizeof bytes, s->now_us)) > 0) {
        replay_answer(s->r, REPLAY_REPLAYED, s->now_us, bytes, n);
    }
}

/* One step of the simulator towards a time; false when it has nothing to do before it. */
static bool step_towards(stage *s, int64_t until_us)
{
    int64_t next_us = grobo_sim_deadline(&s->sim);
    if (next_us > until_us) {
        return false;
    }
    if (next_us > s->now_us) {
        s->now_us = next_us;
    }
    listen(s);
    grobo_sim_step(&s->sim, s->now_us);
    return true;
}

static void run_until(stage *s, int64_t until_us)
{
    while (step_towards(s, until_us)) {
    }
    if (until_us > s->now_us) {
        s->now_us = until_us;
    }
    listen(s);
}

/* A full wire takes the rest when it has room again. */
static void speak(stage *s, const uint8_t *bytes, size_t n)
{
    while (n > 0) {
        size_t took = grobo_sim_rx(&s->sim, bytes, n, s->now_us);
        bytes += took;
        n -= took;
        if (took == 0 && !step_towards(s, GROBO_NEVER_US - 1)) {
            return;
        }
    }
}

static int on_chunk(void *ctx, const pcapng_chunk *chunk)
{
    stage *s = ctx;
    int64_t at_us = chunk->time_us - s->r->first_us;
    if (chunk->direction == PCAPNG_OUT) {
        run_until(s, at_us);
        frames_feed(&s->r->host, s->now_us, chunk->bytes, chunk->size);
        speak(s, chunk->bytes, chunk->size);
    } else if (chunk->direction == PCAPNG_IN) {
        replay_answer(s->r, REPLAY_RECORDED, at_us, chunk->bytes, chunk->size);
    }
    return 0;
}

int replay_to_sim(replay *r)
{
    static stage s;
    memset(&s, 0, sizeof s);
    int error = grobo_robot_def_sim(robot_of(r->a), r->wiring, &s.robot);
    if (error) {
        return app_fail(r->a, EXIT_FILE, grobo_error_name(error),
                        "%s: recorded through GR001's board, where the servos of %s cannot be; see "
                        "--robot and --wiring",
                        r->path, app_model(r->a)->name);
    }
    s.robot.config.baud_bps = (uint32_t)r->baud_bps;
    error = grobo_sim_init(&s.sim, &s.robot.config, 0);
    if (error) {
        return app_fail(r->a, EXIT_FILE, grobo_error_name(error),
                        "%s: the simulator does not run at %d bps; see -b and --wiring", r->path,
                        r->baud_bps);
    }
    s.r = r;
    replay_begin(r, on_host);
    int status = replay_read(r, on_chunk, &s);
    if (!status) {
        run_until(&s, s.now_us + TAIL_US);
    }
    return status;
}
