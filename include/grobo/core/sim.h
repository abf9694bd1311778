/* SPDX-License-Identifier: MIT */
/**
 * @file core/sim.h
 * @brief The rest of the simulator: its line, its registers, its families.
 *
 * grobo/sim.h has the simulated robot, its faults and what a test looks at.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_SIM_H
#define GROBO_CORE_SIM_H

#include <grobo/sim.h>

GROBO_BEGIN_DECLS

struct grobo_imu; /* imu.h */

/* ---- faults --------------------------------------------------------------------------------- */

/** The fault called name[0..length-1], or GROBO_ERR_NOTFOUND. */
GROBO_API int grobo_sim_fault_find(const char *name, size_t length);

/* ---- servos --------------------------------------------------------------------------------- */

/** Models of grobo_rs30x_table(). */
GROBO_API const grobo_sim_family *grobo_sim_rs30x(void);
/** Models of grobo_dxl2_table(). */
GROBO_API const grobo_sim_family *grobo_sim_dxl2(void);
/** Models of grobo_dxl1_table(). */
GROBO_API const grobo_sim_family *grobo_sim_dxl1(void);
/** Models of grobo_sts_table() and grobo_scs_table(). */
GROBO_API const grobo_sim_family *grobo_sim_feetech(void);
/** Models of grobo_lx16a_table(). */
GROBO_API const grobo_sim_family *grobo_sim_lx16a(void);
/** Models of grobo_ics_table(). */
GROBO_API const grobo_sim_family *grobo_sim_ics(void);

/* ---- the simulator -------------------------------------------------------------------------- */

/**
 * The host writes. With pacing the bytes take their time on the wire, one after another, before
 * the board has them.
 * @return bytes taken: fewer than n when the wire's queue is full (write the rest later, as after
 *         a short write; deadline has the time); n when the port is gone (they are lost)
 */
GROBO_API size_t grobo_sim_rx(grobo_sim *sim, const uint8_t *bytes, size_t n, int64_t now_us);

/**
 * The host reads: bytes whose time on the wire is over by now.
 * @return bytes put into buf, 0 when there are none yet
 */
GROBO_API size_t grobo_sim_tx(grobo_sim *sim, uint8_t *buf, size_t cap, int64_t now_us);

/** Lets everything happen that is due by now. _rx and _tx do it too. */
GROBO_API void grobo_sim_step(grobo_sim *sim, int64_t now_us);

/**
 * When to call again: a byte is ready for the host (at or before the latest time when it is ready
 * already), or a step has something to do. Moves, temperatures and reboots need no step: they are
 * functions of time.
 * @return GROBO_NEVER_US when nothing will happen without the host
 */
GROBO_API int64_t grobo_sim_deadline(const grobo_sim *sim);

/**
 * As grobo_sim_deadline(), for a host that needs packets, not bytes: when the last of the bytes is
 * ready that come to the host without a pause. The bytes before it wait in the simulator, so that
 * a reading wakes the host once for each packet on a wire, not for each byte.
 */
GROBO_API int64_t grobo_sim_packet_deadline(const grobo_sim *sim);

/** Room for bytes of the host: what grobo_sim_rx would take now. */
GROBO_API size_t grobo_sim_rx_room(const grobo_sim *sim);

/**
 * What the plant of the simulator's world reports of the base (grobo_sim_plant.imu).
 * @return 0; GROBO_ERR_UNSUPPORTED: there is no world, or its plant reports none; what the plant
 *         returned
 */
GROBO_API int grobo_sim_imu(const grobo_sim *sim, struct grobo_imu *imu);

/** True from a hang-up to the next grobo_sim_plug(): the server of the port closes it. */
GROBO_API bool grobo_sim_hung_up(const grobo_sim *sim);

/**
 * Takes the host's cable out (in = false) or puts it back. Out: bytes on the line are lost, the
 * servos continue; in: the line and the board start afresh.
 */
GROBO_API void grobo_sim_plug(grobo_sim *sim, bool in, int64_t now_us);

/**
 * The host speaks at another rate from now on. Board wiring: at another rate than config.baud_bps
 * the board hears rubbish. Bus wiring: the line has the host's rate, and servos that listen at
 * another do not understand it: grobo_sim_view.baud_bps.
 * @return 0, or GROBO_ERR_ARG below 300 bps
 */
GROBO_API int grobo_sim_set_line_bps(grobo_sim *sim, uint32_t line_bps);

/** First servo whose register ID is id, or GROBO_ERR_NOTFOUND. */
GROBO_API int grobo_sim_find(const grobo_sim *sim, int id);

/**
 * Reads a register, present values as a read packet would give them.
 * @return 0, or GROBO_ERR_ARG (no such servo, or no register begins at this address)
 */
GROBO_API int grobo_sim_get_register(grobo_sim *sim, int servo, int address, int32_t *value);

/**
 * Writes a register as a write packet would, with all that follows from it; read-only registers
 * of kind ROM and FLASH may be written here, present values may not.
 * @return 0, GROBO_ERR_ARG (no such servo or register, present value), GROBO_ERR_LIMIT (range)
 */
GROBO_API int grobo_sim_set_register(grobo_sim *sim, int servo, int address, int32_t value);

/** Gives a servo another id, perhaps that of another one. @return as grobo_sim_set_register(). */
GROBO_API int grobo_sim_set_id(grobo_sim *sim, int servo, int id);

/**
 * What an RS30x's flash holds: registers No.4-29 as they were saved last.
 * @return 0, GROBO_ERR_ARG (no such servo), GROBO_ERR_UNSUPPORTED (no RS30x)
 */
GROBO_API int grobo_sim_get_flash(grobo_sim *sim, int servo, uint8_t flash[GROBO_SIM_FLASH_BYTES]);

/**
 * Gives an RS30x another flash, and power off and on at once: it is limp afterwards.
 * @return 0; GROBO_ERR_ARG (no such servo); GROBO_ERR_UNSUPPORTED (no RS30x); GROBO_ERR_LIMIT (a
 *         value that no servo can have, or a reserved byte that is not 0): nothing has changed
 */
GROBO_API int grobo_sim_set_flash(grobo_sim *sim, int servo,
                                  const uint8_t flash[GROBO_SIM_FLASH_BYTES]);

/** Sets the rate of a fault from now on. @return 0, or GROBO_ERR_ARG (no fault, rate not 0..1). */
GROBO_API int grobo_sim_set_fault(grobo_sim *sim, int fault, double rate);

GROBO_END_DECLS

#endif
