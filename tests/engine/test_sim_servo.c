/* SPDX-License-Identifier: MIT */
/* Registers and packets: who may write what, what comes back, what a packet does. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/lx16a.h>
#include <grobo/core/sim.h>

#include "tests/support/simkit.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tests/support/vectors.h"

static simkit kit;

/* Index of motor 1, CHEST_P; of motor 10, R_HIP_P. Both are RS301CR; motor 2 is an RS302CD. */
enum { CHEST = 12, R_HIP_P = 2 };

/* ---- every vector -------------------------------------------------------------------------- */

typedef struct heard {
    uint8_t bytes[160];
    size_t n;
    int packets;
} heard;

static void hear(void *ctx, const grobo_sim_event *event)
{
    heard *last = ctx;
    if (event->kind == GROBO_SIM_PACKET) {
        memcpy(last->bytes, event->bytes, event->n_bytes);
        last->n = event->n_bytes;
        last->packets++;
    }
}

/* What a servo packet asks for, by the table of flags; written here from the manual's text. */
static size_t reply_bytes(const uint8_t *p)
{
    static const uint8_t by_nibble[16] = {0, 1, 0, 38, 0, 38, 0, 18, 0, 26, 0, 20, 0, 0, 0, 0};
    bool silent = p[2] == 0 || p[2] == 0xFF;
    return silent ? 0 : (p[3] & 0xF) == 0xF ? p[5] + 8u : by_nibble[p[3] & 0xF];
}

static bool send_vector(const vector *v)
{
    static grobo_sim sim;
    static heard last;
    bool servo = strcmp(v->layer, "servo") == 0 &&
                 (strcmp(v->kind, "short") == 0 || strcmp(v->kind, "long") == 0);
    bool relay = strcmp(v->layer, "controller") == 0 && v->n > 3 && v->bytes[0] != 0x50;
    if (!servo && !relay) {
        return false;
    }
    memset(&last, 0, sizeof last);
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT,
                                     .wiring = servo ? GROBO_WIRING_BUS : GROBO_WIRING_BOARD,
                                     .hook = hear, .hook_ctx = &last};
    assert_int_equal(grobo_sim_init(&sim, &config, 0), 0);
    assert_int_equal(grobo_sim_rx(&sim, v->bytes, v->n, 0), v->n);
    uint8_t got[256];
    size_t n = grobo_sim_tx(&sim, got, sizeof got, 100000);
    const uint8_t *packet = v->bytes + (servo ? 0 : 2);
    if (!v->valid) {
        assert_int_equal(last.packets, 0);
        assert_int_equal(n, 0);
    } else {
        assert_int_equal(last.packets, 1);
        assert_memory_equal(last.bytes, packet, last.n);
        assert_int_equal(n, relay && v->bytes[0] == 0x53 ? 0 : reply_bytes(packet));
    }
    return true;
}

TEST(every_vector_is_understood)
{
    vectors_check(send_vector, 40);
}

/* ---- reading ------------------------------------------------------------------------------- */

TEST(blocks_come_as_their_nibble_says)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 0A 03 00 00 01", 38);
    assert_int_equal(kit.n_got, 38);
    static const uint8_t head[] = {0xFD, 0xDF, 0x0A, 0x00, 0x00, 0x1E, 0x01, 0x10, 0x30};
    assert_memory_equal(kit.got, head, sizeof head);
    assert_int_equal(kit.got[7 + 4], 10);
    assert_int_equal(kit.got[7 + 6], 7);
    assert_int_equal(simkit_i16(&kit, 7 + 8), 1500);
    assert_int_equal(simkit_i16(&kit, 7 + 10), -1500);
    assert_int_equal(simkit_i16(&kit, 7 + 28), 180);
    simkit_packet(&kit, "FA AF 0A 05 00 00 01", 38);
    assert_int_equal(kit.n_got, 38);
    assert_int_equal(kit.got[7 + 5], 100);
    simkit_packet(&kit, "FA AF 0A 07 00 00 01", 18);
    assert_int_equal(kit.n_got, 18);
    simkit_packet(&kit, "FA AF 0A 09 00 00 01", 26);
    assert_int_equal(kit.n_got, 26);
    assert_int_equal(simkit_i16(&kit, 7), 200);
    simkit_packet(&kit, "FA AF 0A 0B 00 00 01", 20);
    assert_int_equal(kit.n_got, 20);
}

TEST(every_reply_has_its_sum)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 02 0F 00 8C 00", 148);
    assert_int_equal(kit.n_got, 148);
    uint8_t sum = 0;
    for (size_t i = 2; i < 147; i++) {
        sum = (uint8_t)(sum ^ kit.got[i]);
    }
    assert_int_equal(kit.got[147], sum);
    assert_int_equal(simkit_i16(&kit, 7), 0x3020);
    assert_int_equal(kit.got[7 + 26], 15);
    assert_int_equal(kit.got[7 + 35], 77);
}

TEST(what_cannot_be_read_is_refused)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 01 0D 00 00 01", 76);
    simkit_expect(&kit, "");
    simkit_packet(&kit, "FA AF 01 0F 8B 02 00", 10);
    simkit_expect(&kit, "");
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REFUSED, NULL), 2);
    simkit_packet(&kit, "FA AF 01 0F 24 01 00", 9);
    simkit_expect(&kit, "FD DF 01 02 24 01 01 00 27");
    simkit_packet(&kit, "FA AF 01 0F 24 01 00", 9);
    simkit_expect(&kit, "FD DF 01 00 24 01 01 00 25");
}

/* A robot of another make: one RS303MR, which has the blocks that the early models lack. */
static const grobo_joint late_joint = {.name = "ONE",
                                       .min_rad = -1,
                                       .max_rad = 1,
                                       .max_speed_rad_s = 9,
                                       .servo_model = GROBO_RS30X_RS303MR,
                                       .motor = 7,
                                       .mirror_sign = 1};
static const grobo_model late_robot =
    GROBO_TABLE(grobo_model, .name = "late", GROBO_MODEL_JOINTS(&late_joint), .n_joints = 1);

TEST(later_models_have_more)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .model = &late_robot};
    simkit_start(&kit, &config);
    simkit_packet(&kit, "FA AF 07 0D 00 00 01", 76);
    assert_int_equal(kit.n_got, 76);
    simkit_packet(&kit, "FA AF 07 00 16 02 01 03 04", 0);
    assert_int_equal(simkit_register(&kit, 0, GROBO_RS30X_SILENCE_TORQUE), 3);
    assert_int_equal(simkit_register(&kit, 0, GROBO_RS30X_WARM_UP_TIME), 4);
    assert_int_equal(simkit_register(&kit, 0, GROBO_RS30X_MODEL), 0x3030);
}

TEST(behind_the_robots_back_the_map_holds_too)
{
    simkit_start(&kit, NULL);
    int32_t value = 77;
    assert_int_equal(grobo_sim_get_register(&kit.sim, 20, 4, &value), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_get_register(&kit.sim, 0, 31, &value), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_get_register(&kit.sim, 0, 140, &value), GROBO_ERR_ARG);
    assert_int_equal(value, 77);
    assert_int_equal(grobo_sim_set_register(&kit.sim, 0, GROBO_RS30X_POSITION, 0), GROBO_ERR_ARG);
    assert_int_equal(grobo_sim_set_register(&kit.sim, 0, GROBO_RS30X_ID, 128), GROBO_ERR_LIMIT);
    assert_int_equal(grobo_sim_set_register(&kit.sim, 0, GROBO_RS30X_TEMPERATURE_LIMIT, 60), 0);
    assert_int_equal(grobo_sim_set_register(&kit.sim, 0, GROBO_RS30X_TORQUE, 1), 0);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_TORQUE, NULL), 1);
    assert_int_equal(simkit_register(&kit, 0, GROBO_RS30X_TEMPERATURE_LIMIT), 60);
}

/* ---- writing ------------------------------------------------------------------------------- */

TEST(read_only_registers_stay)
{
    static const char *const writes[] = {
        "FA AF 01 00 00 01 01 55", "FA AF 01 00 0E 01 01 55", "FA AF 01 00 2A 02 01 01 00",
        "FA AF 01 00 34 02 01 01 00",
        "FA AF 01 00 1D 0E 01 00 00 00 00 00 00 00 00 00 00 00 00 00 00"};
    simkit_start(&kit, NULL);
    for (size_t i = 0; i < sizeof writes / sizeof *writes; i++) {
        uint8_t before[GROBO_REGISTERS];
        memcpy(before, kit.sim.servo[CHEST].reg, sizeof before);
        simkit_forget(&kit);
        simkit_packet(&kit, writes[i], 0);
        assert_int_equal(simkit_events(&kit, GROBO_SIM_REFUSED, NULL), 1);
        assert_memory_equal(before, kit.sim.servo[CHEST].reg, sizeof before);
    }
}

TEST(values_out_of_range_are_refused)
{
    static const struct {
        const char *packet;
        int address;
        int32_t stays;
    } rows[] = {
        {"FA AF 01 00 04 01 01 00", GROBO_RS30X_ID, 1},
        {"FA AF 01 00 04 01 01 80", GROBO_RS30X_ID, 1},
        {"FA AF 01 00 05 01 01 02", GROBO_RS30X_REVERSE, 0},
        {"FA AF 01 00 07 01 01 80", GROBO_RS30X_DELAY, 0},
        {"FA AF 01 00 08 02 01 DD 05", GROBO_RS30X_CW_LIMIT, 1500},
        {"FA AF 01 00 20 02 01 00 40", GROBO_RS30X_GOAL_TIME, 0},
        {"FA AF 01 00 24 01 01 03", GROBO_RS30X_TORQUE, 0},
        {"FA AF 01 00 1E 07 01 64 00 00 00 00 50 03", GROBO_RS30X_GOAL, 0},
    };
    simkit_start(&kit, NULL);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        simkit_forget(&kit);
        simkit_packet(&kit, rows[i].packet, 0);
        assert_int_equal(simkit_events(&kit, GROBO_SIM_REFUSED, NULL), 1);
        assert_int_equal(simkit_register(&kit, CHEST, rows[i].address), rows[i].stays);
    }
}

TEST(some_values_out_of_range_become_others)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .wiring = GROBO_WIRING_BUS,
                                     .baud_bps = 9600, .baud_at_once = true};
    simkit_start(&kit, &config);
    simkit_packet(&kit, "FA AF 01 01 23 01 01 C8", 1);
    simkit_expect(&kit, "07");
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_MAX_TORQUE), 100);
    simkit_packet(&kit, "FA AF 01 01 06 01 01 0B", 1);
    simkit_expect(&kit, "07");
    assert_int_equal(simkit_look(&kit, CHEST).baud_bps, 115200);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REFUSED, NULL), 0);
}

TEST(goals_are_clamped_to_the_limits)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 01 00 08 04 01 2C 01 38 FF", 0);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_CW_LIMIT), 300);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_CCW_LIMIT), -200);
    simkit_packet(&kit, "FA AF 01 00 1E 02 01 84 03", 0);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_GOAL), 300);
    simkit_packet(&kit, "FA AF 01 00 1E 02 01 00 80", 0);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_GOAL), -200);
}

TEST(reserved_registers_take_nothing)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 01 00 3C 02 01 11 22", 0);
    simkit_packet(&kit, "FA AF 01 00 16 02 01 01 01", 0);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REFUSED, NULL), 0);
    simkit_packet(&kit, "FA AF 01 0F 3C 02 00", 10);
    assert_int_equal(simkit_i16(&kit, 7), 0);
    simkit_packet(&kit, "FA AF 01 0F 16 02 00", 10);
    assert_int_equal(simkit_i16(&kit, 7), 0);
}

TEST(acks_come_when_asked_for)
{
    simkit_start(&kit, NULL);
    simkit_ask(&kit, "54 0A FA AF 01 01 24 01 01 01 25 01", 100000);
    simkit_expect(&kit, "07");
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_TORQUE), GROBO_TORQUE_ON);
    simkit_packet(&kit, "FA AF 01 01 FF 00 00", 1);
    simkit_expect(&kit, "07");
    simkit_packet(&kit, "FA AF 01 01 00 00 00", 1);
    simkit_expect(&kit, "07");
    simkit_packet(&kit, "FA AF 01 01 FF 01 00", 1);
    simkit_expect(&kit, "07");
    simkit_packet(&kit, "FA AF 01 01 24 01 01 09", 1);
    simkit_expect(&kit, "");
    const grobo_sim_config nack = {GROBO_SIM_CONFIG_INIT, .nack = true};
    simkit_start(&kit, &nack);
    simkit_packet(&kit, "FA AF 01 01 24 01 01 09", 1);
    simkit_expect(&kit, "08");
}

TEST(a_write_may_carry_a_request)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 0A 0B 24 01 01 01", 20);
    assert_int_equal(kit.n_got, 20);
    assert_int_equal(kit.got[3], 0);
    assert_int_equal(kit.got[7 + 6], 1);
    simkit_packet(&kit, "FA AF 0A 0B 24 01 01 07", 20);
    assert_int_equal(kit.got[3], GROBO_RS30X_STATUS_REFUSED);
    assert_int_equal(kit.got[7 + 6], 1);
}

/* ---- who is meant -------------------------------------------------------------------------- */

TEST(all_are_meant_by_255_and_none_replies)
{
    simkit_start(&kit, NULL);
    simkit_ask(&kit, "53 09 FA AF FF 00 24 01 01 01 DA", 100000);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(simkit_register(&kit, i, GROBO_RS30X_TORQUE), GROBO_TORQUE_ON);
    }
    simkit_packet(&kit, "FA AF FF 0F 2A 02 00", 10);
    simkit_expect(&kit, "");
}

TEST(a_later_model_answers_what_all_are_asked)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .model = &late_robot,
                                     .wiring = GROBO_WIRING_BUS};
    simkit_start(&kit, &config);
    simkit_packet(&kit, "FA AF FF 0F 04 04 00", 12);
    simkit_expect(&kit, "FD DF 07 00 04 04 01 07 00 07 00 06");
    simkit_packet(&kit, "FA AF FF 01 24 01 01 01", 1);
    simkit_expect(&kit, "07");
    simkit_packet(&kit, "FA AF FF 00 24 01 01 00", 0);
    simkit_expect(&kit, "");
}

TEST(long_packets_reach_those_named)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 00 00 1E 05 03 01 64 00 64 00 02 9C FF 64 00 05 F4 01 64 00", 0);
    assert_int_equal(simkit_register(&kit, simkit_servo(&kit, 1), GROBO_RS30X_GOAL), 100);
    assert_int_equal(simkit_register(&kit, simkit_servo(&kit, 2), GROBO_RS30X_GOAL), -100);
    assert_int_equal(simkit_register(&kit, simkit_servo(&kit, 5), GROBO_RS30X_GOAL), 500);
    assert_int_equal(simkit_register(&kit, simkit_servo(&kit, 5), GROBO_RS30X_GOAL_TIME), 100);
    assert_int_equal(simkit_register(&kit, simkit_servo(&kit, 3), GROBO_RS30X_GOAL), 0);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_GOAL, NULL), 3);
}

/* Another servo stands between the two parts; the later one is the one that counts. */
TEST(one_is_spoken_to_twice)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 00 00 1E 05 03 05 64 00 64 00 02 9C FF 64 00 05 F4 01 32 00", 0);
    assert_int_equal(simkit_register(&kit, simkit_servo(&kit, 5), GROBO_RS30X_GOAL), 500);
    assert_int_equal(simkit_register(&kit, simkit_servo(&kit, 5), GROBO_RS30X_GOAL_TIME), 50);
    assert_int_equal(simkit_register(&kit, simkit_servo(&kit, 2), GROBO_RS30X_GOAL), -100);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_GOAL, NULL), 3);
    simkit_forget(&kit);
    simkit_packet(&kit, "FA AF 00 00 1E 05 02 05 64 00 64 00 05 F4 01 00 40", 0); /* refused */
    assert_int_equal(simkit_register(&kit, simkit_servo(&kit, 5), GROBO_RS30X_GOAL), 100);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REFUSED, NULL), 1);
}

/* Only later models keep "silence_torque": in one packet it is written and it is reserved. */
TEST(one_packet_is_another_to_each_model)
{
    static const uint16_t models[] = {GROBO_RS30X_RS301CR, GROBO_RS30X_RS303MR, GROBO_RS30X_RS301CR,
                                      GROBO_RS30X_RS303MR};
    static const char *const names[] = {"A", "B", "C", "D"};
    grobo_joint joints[4];
    const grobo_model model =
        GROBO_TABLE(grobo_model, .name = "mixed", GROBO_MODEL_JOINTS(joints), .n_joints = 4);
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .model = &model,
                                     .wiring = GROBO_WIRING_BUS};
    for (int i = 0; i < 4; i++) {
        joints[i] = (grobo_joint){.name = names[i],
                                  .min_rad = -1,
                                  .max_rad = 1,
                                  .max_speed_rad_s = 1,
                                  .servo_model = models[i],
                                  .motor = (uint8_t)(i + 1),
                                  .mirror = (uint8_t)i,
                                  .mirror_sign = 1};
    }
    simkit_start(&kit, &config);
    simkit_packet(&kit, "FA AF 00 00 16 02 04 01 11 02 12 03 13 04 14", 0);
    for (int i = 0; i < 4; i++) {
        bool keeps = models[i] == GROBO_RS30X_RS303MR;
        assert_int_equal(kit.sim.servo[i].reg[22], keeps ? 0x11 + i : 0);
    }
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REFUSED, NULL), 0);
}

/* The high byte of a goal time alone: in range or not with the low one that is there. */
TEST(a_part_of_a_register_is_judged_with_the_rest)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 01 00 20 02 01 FF 00", 0);
    simkit_packet(&kit, "FA AF 01 00 21 01 01 3F", 0);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_GOAL_TIME), 0x3FFF);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REFUSED, NULL), 0);
    simkit_packet(&kit, "FA AF 01 00 21 01 01 40", 0);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_GOAL_TIME), 0x3FFF);
    assert_int_equal(simkit_events(&kit, GROBO_SIM_REFUSED, NULL), 1);
}

TEST(an_id_changes_at_once)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 01 00 04 01 01 1E", 0);
    assert_int_equal(grobo_sim_find(&kit.sim, 1), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_sim_find(&kit.sim, 30), CHEST);
    simkit_packet(&kit, "FA AF 01 0F 2A 02 00", 10);
    simkit_expect(&kit, "");
    simkit_packet(&kit, "FA AF 1E 0F 2A 02 00", 10);
    assert_int_equal(kit.n_got, 10);
    assert_int_equal(kit.got[2], 30);
}

TEST(two_with_one_id_collide)
{
    simkit_start(&kit, NULL);
    assert_int_equal(grobo_sim_set_register(&kit.sim, CHEST, GROBO_RS30X_ID, 10), 0);
    simkit_packet(&kit, "FA AF 0A 0F 2A 02 00", 10);
    assert_int_equal(kit.n_got, 10);
    /* 20.0 deg is C8 00, 0 is 00 00; the sums EF and 27. */
    simkit_expect(&kit, "FD DF 0A 00 2A 02 01 00 00 23");
    assert_true(simkit_events(&kit, GROBO_SIM_COLLISION, NULL) > 0);
}

TEST(wrong_sums_are_ignored)
{
    simkit_start(&kit, NULL);
    simkit_ask(&kit, "53 09 FA AF 01 00 24 01 01 01 25", 100000);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_TORQUE), GROBO_TORQUE_OFF);
    simkit_ask(&kit, "53 09 FA AF 01 00 24 01 01 01 24", 100000);
    assert_int_equal(simkit_register(&kit, CHEST, GROBO_RS30X_TORQUE), GROBO_TORQUE_ON);
}

/* ---- reverse ------------------------------------------------------------------------------- */

TEST(reverse_turns_signs_and_limits)
{
    simkit_start(&kit, NULL);
    simkit_packet(&kit, "FA AF 0A 00 05 01 01 01", 0);
    simkit_packet(&kit, "FA AF 0A 0F 2A 02 00", 10);
    assert_int_equal(simkit_i16(&kit, 7), -200);
    simkit_packet(&kit, "FA AF 0A 00 08 02 01 64 00", 0);
    simkit_packet(&kit, "FA AF 0A 00 24 01 01 01", 0);
    simkit_packet(&kit, "FA AF 0A 00 1E 02 01 2C 01", 0);
    simkit_run(&kit, 1000000);
    assert_int_equal(simkit_look(&kit, R_HIP_P).angle_mdeg, -10000);
    assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_POSITION), 100);
    simkit_packet(&kit, "FA AF 0A 00 05 01 01 00", 0);
    simkit_run(&kit, 1000000);
    assert_int_equal(simkit_look(&kit, R_HIP_P).angle_mdeg, -10000);
    assert_int_equal(simkit_register(&kit, R_HIP_P, GROBO_RS30X_GOAL), -100);
}

/* ---- the table of types -------------------------------------------------------------------- */

/* A chain of every type there is: each says which it is, and behaves as its row says. */
TEST(every_type_is_what_its_row_says)
{
    grobo_joint joints[GROBO_SIM_SERVOS_MAX];
    char names[GROBO_SIM_SERVOS_MAX][8];
    grobo_model model = GROBO_TABLE(grobo_model, .name = "chain", GROBO_MODEL_JOINTS(joints));
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .model = &model,
                                     .wiring = GROBO_WIRING_BUS, .no_stops = true};
    for (; model.n_joints < grobo_i_rs30x_table.model_count; model.n_joints++) {
        int i = model.n_joints;
        assert_true(i < GROBO_SIM_SERVOS_MAX);
        snprintf(names[i], sizeof names[i], "S%d", i);
        joints[i] = (grobo_joint){.name = names[i],
                                  .min_rad = -2.6,
                                  .max_rad = 2.6,
                                  .max_speed_rad_s = 1,
                                  .servo_model = grobo_i_rs30x_table.models[i].number,
                                  .motor = (uint8_t)(i + 1),
                                  .mirror = (uint8_t)i,
                                  .mirror_sign = 1};
    }
    assert_true(model.n_joints >= 4);
    simkit_start(&kit, &config);
    simkit_packet(&kit, "FA AF FF 00 24 01 01 01", 0);
    for (int i = 0; i < model.n_joints; i++) {
        assert_int_equal(simkit_register(&kit, i, GROBO_RS30X_MODEL), joints[i].servo_model);
        const grobo_servo_register *reg;
        for (size_t k = 0;
             (reg = grobo_servo_register_row(&grobo_i_rs30x_table.models[i], k)) != NULL; k++) {
            bool as_made = reg->factory != 0 && reg->role != GROBO_ROLE_ID;
            assert_true(!as_made || simkit_register(&kit, i, reg->address) == reg->factory);
        }
        assert_int_equal(grobo_sim_set_register(&kit.sim, i, GROBO_RS30X_GOAL, 1000), 0);
        kit.now_us += 100000;
        /* In 0.1 s, of 60 degrees in 0.11, 0.16 and 0.22 s. */
        static const int32_t ways_mdeg[] = {54545, 37500, 54545, 37500, 27273, 54545};
        assert_int_equal(model.n_joints, sizeof ways_mdeg / sizeof *ways_mdeg);
        const int32_t way_mdeg = ways_mdeg[i];
        assert_in_range(simkit_look(&kit, i).angle_mdeg, way_mdeg - 1, way_mdeg + 1);
        char hex[64];
        snprintf(hex, sizeof hex, "FA AF %02X 0D 00 00 01", (unsigned)i + 1);
        simkit_packet(&kit, hex, 76);
        assert_int_equal(kit.n_got, i == 2 || i == 3 ? 76 : 0); /* RS303MR and RS304MD have it */
    }
}

/* Behind a board too an RS30x may be named by its model; nothing else relays there. */
TEST(a_board_has_servos_of_its_own_only)
{
    const grobo_servo_model *servos[GROBO_SIM_SERVOS_MAX];
    const grobo_sim_family *const families[] = {&grobo_i_sim_rs30x, &grobo_i_sim_lx16a, NULL};
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .servos = servos, .families = families};
    for (int j = 0; j < grobo_i_gr001_model.n_joints; j++) {
        servos[j] = grobo_servo_model_named(&grobo_i_rs30x_table, "RS304MD");
    }
    simkit_start(&kit, &config);
    assert_int_equal(simkit_register(&kit, 0, GROBO_RS30X_MODEL), GROBO_RS30X_RS304MD);
    servos[1] = &grobo_i_lx16a_table.models[0];
    assert_int_equal(grobo_sim_init(&kit.sim, &config, 0), GROBO_ERR_ARG);
}
