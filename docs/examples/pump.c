/* SPDX-License-Identifier: MIT */
/* The engine as firmware runs it: bytes and the time in, bytes and the next deadline out. */
#include <stdio.h>

#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>

static grobo_robot robot; /* storage of the program: there is no heap */
static grobo_sim sim;     /* stands for UART and servos */

static int64_t pump(int64_t now_us)
{
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    grobo_robot_rx(&robot, bytes, grobo_sim_tx(&sim, bytes, sizeof bytes, now_us), now_us);
    grobo_robot_step(&robot, now_us);
    int n = grobo_robot_tx(&robot, bytes, sizeof bytes, now_us);
    (void)grobo_sim_rx(&sim, bytes, n > 0 ? (size_t)n : 0, now_us);
    int64_t next_us = grobo_robot_deadline(&robot, now_us);
    int64_t sim_us = grobo_sim_packet_deadline(&sim);
    return sim_us < next_us ? sim_us : next_us; /* sleep until then, or until a byte comes */
}

int main(void)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .model = grobo_gr001_model()};
    grobo_posture target;
    grobo_posture_init_pose(&target, grobo_gr001_model());
    if (grobo_sim_init(&sim, &config, 0) < 0 ||
        grobo_robot_init(&robot, grobo_gr001_driver(GROBO_WIRING_BOARD), NULL, NULL, 0) < 0) {
        return 1;
    }
    grobo_robot_link_up(&robot, 0);
    int job = grobo_robot_move(&robot, &target);
    int64_t now_us = 0;
    while (grobo_robot_is_pending(&robot, job)) {
        now_us = pump(now_us);
    }
    printf("there after %d ms\n", (int)(now_us / 1000));
    return job < 0;
}
