/* SPDX-License-Identifier: MIT */
/* Memory of a robot engine, of a session on a port, of a simulated robot. */
#include <stddef.h>

#include <event2/event.h>

#include <grobo/core/loop.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/session.h>
#include <grobo/sim_server.h>

#include "tests/bench/bench.h"
#include "tests/support/counted_mem.h"

static const double KIB = 1024;

int main(void)
{
    struct event_base *base = grobo_loop_new();
    counted_mem served = {0}, used = {0};
    const grobo_mem served_mem = counted_mem_of(&served), used_mem = counted_mem_of(&used);
    const grobo_sim_server_config far_end = {GROBO_SIM_SERVER_CONFIG_INIT, .base = base,
                                             .mem = &served_mem};
    grobo_sim_server *server = NULL;
    grobo_session *session = NULL;

    if (base == NULL || grobo_sim_server_new(&far_end, &server, NULL) < 0) {
        fputs("bench_memory: no simulated robot behind a pseudo-terminal\n", stderr);
        return 1;
    }
    const grobo_session_config config = {GROBO_SESSION_CONFIG_INIT, .base = base,
                                         .device = grobo_sim_server_device(server),
                                         .mem = &used_mem};

    if (grobo_session_new(&config, &session) < 0 || grobo_session_open(session) < 0) {
        fputs("bench_memory: no session\n", stderr);
        return 1;
    }
    bench_row("S8", "a robot engine of 20 joints, KiB", "grobo",
              (double)(offsetof(grobo_robot, axes) + 20 * sizeof(grobo_robot_axis)) / KIB);
    bench_row("S8", "a pty session, KiB", "grobo", (double)used.bytes / KIB);
    bench_row("S8", "a simulated robot of 20 joints, KiB", "grobo",
              (double)(offsetof(grobo_sim, servo) + 20 * sizeof(grobo_sim_servo)) / KIB);
    bench_row("S8", "a simulated robot behind a pty, KiB", "grobo", (double)served.bytes / KIB);
    grobo_session_free(session);
    grobo_sim_server_free(server);
    event_base_free(base);
    return 0;
}
