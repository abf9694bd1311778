/* SPDX-License-Identifier: MIT */
#include <grobo/core/robot.h>

#include "tools/grctl/play/frames.h"

json_t *frames_json(const conn *c)
{
    grobo_robot_counters n;
    grobo_jitter jitter;
    conn_counters(c, &n);
    grobo_robot_jitter(c->robot, &jitter);
    return json_pack("{s:b,s:I,s:I,s:{s:I,s:I,s:I}}", "done", 1, "frames",
                     (json_int_t)n.motion_frames, "late_frames", (json_int_t)n.late_frames,
                     "jitter_us", "p50", (json_int_t)jitter.p50_us, "p99",
                     (json_int_t)jitter.p99_us, "max", (json_int_t)jitter.max_us);
}

void frames_print(const conn *c, const char *name)
{
    grobo_robot_counters n;
    grobo_jitter jitter;
    conn_counters(c, &n);
    grobo_robot_jitter(c->robot, &jitter);
    app_print("%s%llu frame%s, %llu late; jitter p50 %lld us, p99 %lld us, largest %lld us\n", name,
              (unsigned long long)n.motion_frames, n.motion_frames == 1 ? "" : "s",
              (unsigned long long)n.late_frames, (long long)jitter.p50_us, (long long)jitter.p99_us,
              (long long)jitter.max_us);
}
