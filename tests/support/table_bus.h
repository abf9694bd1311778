/* SPDX-License-Identifier: MIT */
/*
 * Servos that are registers, on a bus in virtual time, with an engine that drives them: written
 * from the packets and the tables alone. They answer at the time of the wire, and move straight.
 */
#ifndef GROBO_TEST_TABLE_BUS_H
#define GROBO_TEST_TABLE_BUS_H

#include <grobo/core/dxl2.h>
#include <grobo/core/feetech.h>
#include <grobo/core/static.h>

enum { TABLE_SERVOS_MAX = 8, TABLE_MEMORY = 256, TABLE_EVENTS = 512, TABLE_FRAMES = 4096 };

typedef struct table_servo {
    const grobo_servo_model *servo;
    uint8_t memory[TABLE_MEMORY];
    double from_ticks, to_ticks;
    int64_t from_us, to_us;
    bool silent;
    uint16_t frozen; /* writing here does nothing; 0: nowhere */
    unsigned jumps;  /* goals that asked for more than the servo can do */
} table_servo;

typedef struct table_frame {
    int64_t at_us;
    uint16_t size;
    uint8_t bytes[256];
} table_frame;

typedef struct table_bus {
    grobo_driver driver;
    grobo_robot robot;
    table_servo servo[TABLE_SERVOS_MAX];
    int n;
    int64_t now_us;
    struct {
        int64_t at_us;
        uint8_t bytes[256];
        size_t n;
    } reply[16]; /* under way */
    int n_replies;
    grobo_event event[TABLE_EVENTS];
    size_t n_events;
    table_frame frame[TABLE_FRAMES];
    size_t n_frames;
    uint8_t error; /* of each status: as the family has it */
} table_bus;

/* An engine with the driver in bus->driver, its line up; each joint has its servo, set up as it
 * leaves the factory and in the middle. 1 Mbps, no return delay. */
void table_start(table_bus *bus, const grobo_robot_config *config);
void table_run(table_bus *bus, int64_t us);
/* Lets time pass until the job is over: its result. */
int table_wait(table_bus *bus, int number);
/* Value of a servo's register, and what it becomes. */
int32_t table_get(const table_bus *bus, int joint, grobo_register_role role);
void table_put(table_bus *bus, int joint, grobo_register_role role, int32_t value);
/* Where a joint is, in degrees. */
double table_angle_deg(const table_bus *bus, int joint);
/* Turns a joint without torque by hand. */
void table_turn(table_bus *bus, int joint, double angle_deg);
/* Instructions of this kind sent. */
size_t table_count(const table_bus *bus, uint8_t instruction);

#endif
