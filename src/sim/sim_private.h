/* SPDX-License-Identifier: MIT */
/*
 * What the files of the simulator share. Times of wires are nanoseconds (a byte at 115200 bps is
 * no whole number of microseconds), times of servos microseconds.
 *
 *   host - in - board (fifo, send) - servos' bus - packet - servo - talk - board (got) - out - host
 *   host - in ---------------------- servos' bus - packet - servo - talk ------------- out - host
 */
#ifndef GROBO_SIM_PRIVATE_H
#define GROBO_SIM_PRIVATE_H

#include <grobo/sim.h>

/* Assumptions; docs/simulator.md lists them. */
#define GROBO_I_SIM_SUPPLY_MV 7400
#define GROBO_I_SIM_AMBIENT_C 25
#define GROBO_I_SIM_SILENCE_US 2000
/* The board's rate towards the servos (protocol 2). */
#define GROBO_I_SIM_BUS_BPS 115200
#define GROBO_I_SIM_BOOT_US 500000
#define GROBO_I_SIM_SAVE_US 1000000
/* A servo forgets a packet that stands still for this long. */
#define GROBO_I_SIM_SERVO_STALL_NS 10000000

/* The generator of what is no fault: start posture, bytes at a wrong rate. */
#define GROBO_I_SIM_CHANCE GROBO_SIM_FAULTS

/* The first microsecond at which something at t_ns is over. */
static inline int64_t grobo_i_sim_us(int64_t t_ns)
{
    int64_t us = t_ns / 1000;
    return us * 1000 < t_ns ? us + 1 : us;
}

/* ---- fault.c: chance ---- */

void grobo_i_sim_seed(grobo_sim *sim);
/* 0 .. below - 1 */
uint32_t grobo_i_sim_random(grobo_sim *sim, int generator, uint32_t below);
/* True if the fault strikes now; counts and tells it. */
bool grobo_i_sim_strikes(grobo_sim *sim, grobo_sim_fault fault, int servo);
/* A byte that crosses the host's line: lost (false), damaged, or as it was. */
bool grobo_i_sim_crosses(grobo_sim *sim, uint8_t *byte);

/* Where the parts of a reply go: bytes from start_ns on without a pause. */
typedef void (*grobo_i_sim_emit)(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t start_ns);
/* Sends a reply to the host by emit, with the faults that replies have. */
void grobo_i_sim_reply(grobo_sim *sim, const grobo_sim_event *reply, int64_t start_ns,
                       grobo_i_sim_emit emit);

/* ---- sim.c ---- */

void grobo_i_sim_tell(grobo_sim *sim, const grobo_sim_event *event);
/* Tells an event without bytes, now. */
void grobo_i_sim_note(grobo_sim *sim, grobo_sim_event_kind kind, int servo, int32_t value);
/* The host's cable is out: what is on the line is lost. */
void grobo_i_sim_cut(grobo_sim *sim);
/* A byte for the host that is over at at_ns. */
void grobo_i_sim_to_host(grobo_sim *sim, uint8_t byte, int64_t at_ns);

/* ---- board.c: the controller board ---- */

/* A whole frame has come: what may befall the robot then. */
void grobo_i_sim_frame_faults(grobo_sim *sim);
/* A byte of the host has arrived. */
void grobo_i_sim_board_hear(grobo_sim *sim, uint8_t byte, int64_t t_ns);
/* A byte of a servo has arrived. */
void grobo_i_sim_board_got(grobo_sim *sim, uint8_t byte, int64_t t_ns);
/* When the board does something on its own, or GROBO_NEVER_US; and doing it. */
int64_t grobo_i_sim_board_next(const grobo_sim *sim);
void grobo_i_sim_board_act(grobo_sim *sim, int64_t t_ns);

/* ---- bus.c: the servos' half-duplex line ---- */

/* A byte of the board or host is over on the bus. */
void grobo_i_sim_bus_hear(grobo_sim *sim, uint8_t byte, int64_t t_ns);
/* Servos begin to say bytes at start_ns. */
void grobo_i_sim_talk(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t start_ns);
/* When the next byte of a servo is over, or GROBO_NEVER_US; and that byte. */
int64_t grobo_i_sim_talk_next(const grobo_sim *sim);
void grobo_i_sim_talk_act(grobo_sim *sim, int64_t t_ns);
/* When the first of the talks is over, or GROBO_NEVER_US. */
int64_t grobo_i_sim_talks_end(const grobo_sim *sim);

/* ---- servo.c: registers and packets ---- */

/* Every servo that hears the packet carries it out and may reply; raw holds its bytes. */
void grobo_i_sim_packet(grobo_sim *sim, const grobo_rs30x_packet *packet,
                        const grobo_sim_event *raw);
/* Writes what is given and lets it take effect; the caller has checked it. */
void grobo_i_sim_store(grobo_sim *sim, int servo, int address, const uint8_t *bytes, size_t n);
/* Fills in the present values. */
void grobo_i_sim_refresh(grobo_sim *sim, int servo);
/* True while it neither hears nor speaks, whatever the rate. */
bool grobo_i_sim_deaf(const grobo_sim *sim, int servo);
int32_t grobo_i_sim_value(const grobo_sim_servo *servo, uint8_t address);
/* The rate at which a servo listens and speaks; negative: none has this code. */
int32_t grobo_i_sim_bps(const grobo_sim *sim, int servo);

/* ---- power.c: flash, reboot, supply ---- */

/* From the factory, with an id and a rate that were set and saved since. */
void grobo_i_sim_factory(grobo_sim_servo *servo, uint16_t model, uint8_t id, uint32_t baud_bps);
/* True if a servo may have these bytes as No.4-29. */
bool grobo_i_sim_flash_fits(const uint8_t *flash);
/* Out of and into power, with another flash. */
void grobo_i_sim_exchange_flash(grobo_sim *sim, int servo, const uint8_t *flash);
void grobo_i_sim_boot(grobo_sim *sim, int servo, int64_t deaf_us);
void grobo_i_sim_reboot(grobo_sim *sim, int servo);
void grobo_i_sim_save(grobo_sim *sim, int servo, bool reboot_after);
void grobo_i_sim_saved(grobo_sim *sim, int servo);
/* Factory reset: No.4-29 here and, after the time it takes, in flash. */
void grobo_i_sim_reset(grobo_sim *sim, int servo);
void grobo_i_sim_power(grobo_sim *sim, int servo, bool on);
/* All servos lose power for a moment. */
void grobo_i_sim_brown_out(grobo_sim *sim);

/* ---- types.c: what tells one servo from another ---- */

const grobo_sim_type *grobo_i_sim_type_of(const grobo_sim_servo *servo);

/* ---- shaft.c: moves, currents, temperatures as functions of time ---- */

int32_t grobo_i_sim_angle_mdeg(const grobo_sim_servo *servo, int64_t t_us);
int32_t grobo_i_sim_speed_dps(const grobo_sim_servo *servo, int64_t t_us);
int32_t grobo_i_sim_current_ma(const grobo_sim_servo *servo, int64_t t_us);
int64_t grobo_i_sim_move_age_us(const grobo_sim_servo *servo, int64_t t_us);
bool grobo_i_sim_moving(const grobo_sim_servo *servo, int64_t t_us);
/* The unit of the wire in the servo's own direction. */
int32_t grobo_i_sim_ddeg(const grobo_sim_servo *servo, int32_t mdeg);
int32_t grobo_i_sim_mdeg_of_rad(double angle_rad);
/* Lets what the servo does on its own happen up to the latest time. */
void grobo_i_sim_settle(grobo_sim *sim, int servo);
/* Moves towards the goal register from here on; stops and stays here. */
void grobo_i_sim_drive(grobo_sim *sim, int servo);
void grobo_i_sim_halt(grobo_sim *sim, int servo);
/* Torque goes from what it was to the value in its register. */
void grobo_i_sim_torque(grobo_sim *sim, int servo, grobo_torque before);

#endif
