/* SPDX-License-Identifier: MIT */
/*
 * Instructions of the engine on a microcontroller: it plays all joints of a GR001 50 times a second
 * and reads along, in virtual time, against a simulated robot in the same firmware. QEMU counts: an
 * instruction takes it 1024 ns of its clock (tests/bench/pump.sh), so that what the clock says of a
 * call is instructions. At its UART it says how many pumps there were, the instructions of one on
 * average, of one that sends a frame, and the most.
 */
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>

#include "docs/examples/firmware/mcu.h"
#include "tests/support/tables.h"

#define SECOND_US 1000000

enum { POSTURES = 16, JOINTS = 20, FRAME_US = 20000 };

static grobo_robot robot;
static grobo_sim sim;
static grobo_posture wave[POSTURES];
static int64_t now_us;

static struct {
    int64_t all, frames, most;
    int64_t pumps, sent;
} count;

/* ---- the motion, made before: what it costs is not the engine's ---- */

static void make_wave(void)
{
    for (int i = 0; i < POSTURES; i++) {
        (void)grobo_posture_init(&wave[i], JOINTS);
        for (int j = 0; j < JOINTS; j++) {
            double by_deg = i < POSTURES / 2 ? i : POSTURES - i;
            double init_rad = grobo_i_gr001_model.joints[j].init_rad;
            double to_rad = grobo_rad_from_deg(j == 12 ? -by_deg : by_deg);
            (void)grobo_posture_set_rad(&wave[i], j, init_rad + to_rad);
        }
    }
}

static int wave_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    (void)ctx;
    *posture = wave[((uint32_t)t_us / FRAME_US) % POSTURES];
    return 0;
}

static int wave_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    *at_us = (int64_t)i * SECOND_US;
    return wave_sample(ctx, *at_us, posture);
}

/* ---- the pump ---- */

/* Instructions since the clock said this; what asking it takes is not among them. */
static int64_t since(int64_t begin_us)
{
    static int64_t asking = -1;
    int64_t us = mcu_now_us() - begin_us;
    if (asking < 0) {
        asking = us;
    }
    return (us - asking) * 1000 / 1024;
}

static void pump(void)
{
    uint8_t bytes[GROBO_FRAME_MAX_BYTES], frame[GROBO_FRAME_MAX_BYTES];
    size_t got = grobo_sim_tx(&sim, bytes, sizeof bytes, now_us);
    int64_t begin_us = mcu_now_us();
    grobo_robot_rx(&robot, bytes, got, now_us);
    grobo_robot_step(&robot, now_us);
    int size = grobo_robot_tx(&robot, frame, sizeof frame, now_us);
    int64_t at_us = grobo_robot_deadline(&robot, now_us);
    int64_t took = since(begin_us);
    count.all += took;
    count.pumps++;
    count.most = took > count.most ? took : count.most;
    if (size > JOINTS * 5) {
        count.frames += took;
        count.sent++;
    }
    if (size > 0) {
        (void)grobo_sim_rx(&sim, frame, (size_t)size, now_us);
    }
    int64_t sim_us = grobo_sim_packet_deadline(&sim);
    at_us = at_us < sim_us ? at_us : sim_us;
    now_us = at_us > now_us ? at_us : now_us;
}

static void run_us(int64_t us)
{
    for (int64_t end_us = now_us + us; now_us < end_us;) {
        pump();
    }
}

/* ---- what is said ---- */

static void say(const char *text)
{
    mcu_uart_write((const uint8_t *)text, strlen(text));
}

static void say_number(int64_t number)
{
    char text[24];
    size_t at = sizeof text - 1;
    uint32_t left = (uint32_t)number;
    text[at] = '\0';
    do {
        text[--at] = (char)('0' + left % 10);
        left /= 10;
    } while (left > 0);
    text[--at] = ' ';
    say(&text[at]);
}

int main(void)
{
    const grobo_clip clip = {.key = wave_key,
                             .sample = wave_sample,
                             .length_us = (int64_t)600 * SECOND_US,
                             .n_keys = 601,
                             .n_joints = JOINTS};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                        .rate_hz = 50, .unwatched = true};
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT};
    mcu_start();
    make_wave();
    (void)since(mcu_now_us());
    now_us = SECOND_US;
    (void)grobo_sim_init(&sim, &config, now_us);
    (void)grobo_robot_init(&robot, grobo_gr001_driver(GROBO_WIRING_BOARD), NULL, NULL, now_us);
    grobo_robot_link_up(&robot, now_us);
    run_us(SECOND_US);
    (void)grobo_robot_play(&robot, &clip, &options);
    run_us((int64_t)5 * SECOND_US);
    memset(&count, 0, sizeof count);
    run_us(SECOND_US);
    if (grobo_robot_play_state(&robot) != GROBO_SEQUENCER_PLAYING || count.sent == 0) {
        say("it does not play.\n");
        return 1;
    }
    say("pumps");
    say_number(count.pumps);
    say(" average");
    say_number(count.all / count.pumps);
    say(" frame");
    say_number(count.frames / count.sent);
    say(" most");
    say_number(count.most);
    say(".\n");
    return 0;
}
