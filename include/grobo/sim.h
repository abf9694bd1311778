/* SPDX-License-Identifier: MIT */
/**
 * @file sim.h
 * @brief A robot that is not there: board and servos at register level, on a wire that takes time.
 *
 * Bytes and the time go in, bytes and the next deadline come out: no descriptor, clock, thread,
 * malloc or printf. The same object runs under virtual time in tests, behind a pty and in a
 * microcontroller. What it models, and which of that is assumption, is in docs/simulator.md.
 *
 * A servo is named by its index 0..n-1, the joint of the model it moves: ids may change, and two
 * servos may have one id. Times never go back: a call with an earlier time counts as one at the
 * latest time seen. Inspection shows the state at that latest time.
 *
 * Nothing here is re-entrant; one simulator belongs to one thread. The hook may inspect, but must
 * not call grobo_sim_init, _rx, _tx, _step, _plug or any _set_ function of its simulator.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_SIM_H
#define GROBO_SIM_H

#include <grobo/core/board.h>
#include <grobo/core/registers.h>
#include <grobo/core/rs30x.h>
#include <grobo/model.h>

GROBO_BEGIN_DECLS

/* ---- faults --------------------------------------------------------------------------------- */

/**
 * Every fault: X(NAME, name, what it hits, what happens). A rate is the probability, 0..1, that
 * one of what it hits is hit: a byte of the host's line in either direction, a frame from the
 * host that reached the board (bus wiring: a packet), a reply on its way to the host, a servo
 * that is spoken to.
 */
#define GROBO_SIM_FAULT_LIST(X)                                                                    \
    X(DROP, "drop", "byte", "is lost")                                                             \
    X(FLIP, "flip", "byte", "has one bit inverted")                                                \
    X(DUPLICATE, "duplicate", "reply", "is sent twice")                                            \
    X(DELAY, "delay", "reply", "is held back by up to GROBO_SIM_DELAY_MAX_US")                     \
    X(SPLIT, "split", "reply", "pauses inside for up to GROBO_SIM_SPLIT_MAX_US")                   \
    X(RUBBISH, "rubbish", "reply", "has 1 to 8 random bytes in front")                             \
    X(SILENT, "silent", "servo", "does not hear this packet")                                      \
    X(DUPLICATE_ID, "dupid", "servo", "replies together with a ghost of the same id")              \
    X(HANG_UP, "hangup", "frame", "is the last: the port is gone until plugged in again")          \
    X(BROWN_OUT, "brownout", "frame", "comes with a dip of the supply: all servos reboot")

/** The faults: GROBO_SIM_FAULT_DROP, ... */
typedef enum grobo_sim_fault {
/** Makes one of them. */
#define GROBO_SIM_FAULT_ENUM(name, text, hits, does) GROBO_SIM_FAULT_##name,
    GROBO_SIM_FAULT_LIST(GROBO_SIM_FAULT_ENUM)
#undef GROBO_SIM_FAULT_ENUM
        GROBO_SIM_FAULTS /**< number of them */
} grobo_sim_fault;

/** Longest time a delayed reply is held back. */
#define GROBO_SIM_DELAY_MAX_US 20000
/** Longest pause inside a split reply. */
#define GROBO_SIM_SPLIT_MAX_US 5000

/** "drop" of GROBO_SIM_FAULT_DROP; NULL for a number that is no fault. Static string. */
GROBO_API const char *grobo_sim_fault_name(int fault);

/* ---- events --------------------------------------------------------------------------------- */

/** What a hook gets. `servo` is -1 where none is meant. */
typedef enum grobo_sim_event_kind {
    GROBO_SIM_FRAME,     /**< board: a whole frame; value: grobo_board_kind, bytes: its packet */
    GROBO_SIM_PACKET,    /**< a whole command packet on the servos' bus; bytes: the packet */
    GROBO_SIM_REPLY,     /**< a reply starts for the host; bytes: before any fault */
    GROBO_SIM_GOAL,      /**< a goal was written; value: 0.1 degree (clamped), value2: 10 ms */
    GROBO_SIM_TORQUE,    /**< torque changed, by whatever cause; value: new grobo_torque */
    GROBO_SIM_REGISTER,  /**< another register was written; value: address, value2: its value */
    GROBO_SIM_REBOOT,    /**< a servo restarts: command, brown-out, plugged in again */
    GROBO_SIM_SAVED,     /**< registers No.4-29 went to flash */
    GROBO_SIM_OVERHEAT,  /**< a servo cut its torque; value: deg C */
    GROBO_SIM_REFUSED,   /**< a servo could not process a packet */
    GROBO_SIM_MISSED,    /**< a servo that is busy missed a packet; value: grobo_sim_busy */
    GROBO_SIM_STALLED,   /**< a packet on the servos' bus stalled and was forgotten; bytes: of it */
    GROBO_SIM_SLOT,      /**< the board was asked to play a motion; value: its number */
    GROBO_SIM_SCENARIO,  /**< the board was asked to play a scenario; value: its number */
    GROBO_SIM_COLLISION, /**< two talked at once on the servos' bus; value: 1: a servo and the
                              host or board, 0: two servos */
    GROBO_SIM_INJECTED   /**< a fault struck; value: grobo_sim_fault */
} grobo_sim_event_kind;

/** Why a servo does not hear. */
typedef enum grobo_sim_busy {
    GROBO_SIM_BUSY_FLASH, /**< it writes its flash */
    GROBO_SIM_BUSY_REBOOT /**< it restarts */
} grobo_sim_busy;

/** One event. Borrowed bytes, valid during the call of the hook. */
typedef struct grobo_sim_event {
    grobo_sim_event_kind kind;
    int64_t time_us;      /**< when it happened */
    int servo;            /**< index of the servo, or -1 */
    int32_t value;        /**< see grobo_sim_event_kind */
    int32_t value2;       /**< see grobo_sim_event_kind */
    const uint8_t *bytes; /**< or NULL */
    size_t n_bytes;
} grobo_sim_event;

/**
 * Called at each event. What comes over wires is reported in order of time; what a servo does on
 * its own (overheating, end of a flash write) when the host next sends to it or a test looks at it.
 */
typedef void (*grobo_sim_hook)(void *ctx, const grobo_sim_event *event);

/* ---- servos --------------------------------------------------------------------------------- */

/** How the servos of a family talk, what they remember and do. Private. */
typedef struct grobo_sim_family grobo_sim_family;

/** A world in which servos carry weight: sim_physics.h. Private. */
typedef struct grobo_sim_physics grobo_sim_physics;

/* ---- configuration -------------------------------------------------------------------------- */

/** Where the limp joints are at power-up. */
typedef enum grobo_sim_start {
    GROBO_SIM_START_INIT = 0, /**< the model's initial posture */
    GROBO_SIM_START_ZERO,     /**< all at 0, or at the limit nearest to it */
    GROBO_SIM_START_LIMP      /**< anywhere within the limits, by the seed */
} grobo_sim_start;

/** Zero in a field means its default. */
typedef struct grobo_sim_config {
    size_t size;              /**< GROBO_SIM_CONFIG_INIT */
    const grobo_model *model; /**< NULL: GR001. Borrowed for the life of the simulator */
    grobo_wiring wiring;      /**< default: board */
    const grobo_servo_model *const *servos;  /**< of each joint, NULL: an RS30x, the joint's
                                                 servo_model; NULL: all are RS30x, as a board needs
                                                 them. Borrowed */
    const grobo_sim_family *const *families; /**< of those servos, NULL behind the last. Borrowed */
    uint32_t baud_bps; /**< board: its host port; bus: the servos' line. 115200, or what servos of
                            the first one's family have as a rule */
    bool unpaced;      /**< bytes take no time on any wire */
    uint32_t seed;     /**< of every random choice */
    grobo_sim_start start;      /**< posture at power-up */
    uint32_t board_silence_us;  /**< board gives up a reply after this much silence. 2000 */
    uint32_t board_stall_us;    /**< board forgets a frame that stalls. GROBO_BOARD_STALL_US */
    uint32_t supply_mv;         /**< battery. 7400 */
    int32_t ambient_c;          /**< -40..60; 25 */
    uint32_t latency_us;        /**< a byte for the host waits so long at its adapter for others */
    bool echo;                  /**< bus: the host's adapter returns what is sent on one wire */
    bool nack;                  /**< a servo that cannot process an ACK request answers 08 */
    bool mounted;               /**< servos of other families are set up as the model's joints need
                                    them: mode, sense of goals, and the range of a calibrated joint;
                                    else as from the factory */
    bool no_stops;              /**< nothing but its limit registers keeps a servo from turning */
    bool baud_at_once;          /**< register BAUD takes effect when written, not at a restart */
    bool jump_on_torque;        /**< torque on runs to the goal register instead of holding */
    grobo_sim_hook hook;        /**< or NULL */
    void *hook_ctx;             /**< given to the hook */
    grobo_sim_physics *physics; /**< weight, friction, motors: of this simulator alone, outlives it.
                                     Borrowed; NULL: a shaft is where its servo wants it */
} grobo_sim_config;
/** Begins an initializer of one. */
#define GROBO_SIM_CONFIG_INIT GROBO_SIZED(grobo_sim_config)

/* ---- inspection ----------------------------------------------------------------------------- */

/** Monotonic counters; read freely. */
typedef struct grobo_sim_stats {
    uint32_t rx_bytes;      /**< bytes of the host that arrived */
    uint32_t tx_bytes;      /**< bytes given to the host */
    uint32_t frames;        /**< board: whole frames of the host */
    uint32_t packets;       /**< whole command packets on the servos' bus */
    uint32_t replies;       /**< replies that entered the line to the host */
    uint32_t short_replies; /**< board: replies with fewer bytes than asked for */
    uint32_t overflows;     /**< bytes lost to a full buffer: board's, or towards the host */
    uint32_t stalls;        /**< packets on the servos' bus forgotten because they stalled */
    uint32_t collisions;    /**< bytes on the servos' bus with two talkers */
    uint32_t stray_bytes;   /**< bytes of servos that were not listened to */
    uint32_t slots;         /**< slots played */
    uint32_t scenarios;     /**< scenarios played */
    uint8_t last_slot;      /**< number of the last one */
    uint8_t last_scenario;  /**< number of the last one */
    uint32_t injected[GROBO_SIM_FAULTS]; /**< faults that struck */
} grobo_sim_stats;

/** How a servo is connected. */
typedef enum grobo_sim_cable {
    GROBO_SIM_CABLE_IN = 0, /**< as it should be */
    GROBO_SIM_CABLE_MUTE,   /**< powered, holds, but neither hears nor speaks */
    GROBO_SIM_CABLE_OUT     /**< no power: limp */
} grobo_sim_cable;

/** What a servo does now. Angles are the shaft's: the sign of register REVERSE is not in them. */
typedef struct grobo_sim_view {
    int32_t angle_mdeg;    /**< where the shaft is, 0.001 degree */
    int32_t target_mdeg;   /**< where its present move ends */
    int32_t speed_dps;     /**< magnitude, degrees a second */
    int32_t current_ma;    /**< of its motor and circuit */
    double temperature_c;  /**< of its case */
    grobo_torque torque;   /**< what it does, also while it is rebooting */
    grobo_sim_cable cable; /**< as set */
    bool moving;           /**< on its way to target_mdeg */
    bool stalled;          /**< wants to go where it cannot */
    bool deaf;             /**< writing flash, rebooting, without power, or its cable is not in */
    uint8_t id;            /**< register ID */
    uint32_t baud_bps;     /**< rate at which it listens: of register BAUD at its last restart */
} grobo_sim_view;

/* ---- the simulator -------------------------------------------------------------------------- */

/** Registers No.4-29 of an RS30x, those that flash keeps. */
#define GROBO_SIM_FLASH_BYTES 26
/** A simulated robot. sim_static.h completes it, for programs that keep it themselves. */
typedef struct grobo_sim grobo_sim;

/** Number of servos. */
GROBO_API int grobo_sim_servos(const grobo_sim *sim);

/** What a servo does at the latest time. @return 0 or GROBO_ERR_ARG (no such servo). */
GROBO_API int grobo_sim_look(grobo_sim *sim, int servo, grobo_sim_view *view);

/**
 * Turns a shaft as a hand does: from where it is to angle_mdeg (within the mechanical stops) in
 * time_us, at once for 0, whatever the torque is and becomes meanwhile. With torque on at the end
 * of it the servo drives to its goal.
 * @return 0 or GROBO_ERR_ARG (no such servo, time_us < 0 or above INT32_MAX: half an hour)
 */
GROBO_API int grobo_sim_set_angle(grobo_sim *sim, int servo, int32_t angle_mdeg, int64_t time_us);

/** Holds a shaft fast, or lets it go. @return 0 or GROBO_ERR_ARG. */
GROBO_API int grobo_sim_set_blocked(grobo_sim *sim, int servo, bool blocked);

/** Extra current while torque is on, as a hand or a weight causes: 0..5000 mA. @return 0/ARG. */
GROBO_API int grobo_sim_set_load(grobo_sim *sim, int servo, int32_t load_ma);

/** Sets the temperature of a servo, -40..150. @return 0 or GROBO_ERR_ARG. */
GROBO_API int grobo_sim_set_temperature(grobo_sim *sim, int servo, double temperature_c);

/** Connects or disconnects a servo. @return 0 or GROBO_ERR_ARG. */
GROBO_API int grobo_sim_set_cable(grobo_sim *sim, int servo, grobo_sim_cable cable);

/**
 * Sets the battery's voltage. Speeds follow it; below GROBO_SIM_BROWN_OUT_MV the servos are
 * without power, and they boot when it comes back. The board lives from the host's cable.
 */
GROBO_API void grobo_sim_set_supply(grobo_sim *sim, uint32_t supply_mv);

/** Below this servos reset. An assumption. */
#define GROBO_SIM_BROWN_OUT_MV 4500

/**
 * Sets rates by a list "drop=0.01,flip=0.02"; "all=R" means all but hang-up.
 * @return number of rates set; GROBO_ERR_NOTFOUND (name) or GROBO_ERR_ARG (number): none was set
 */
GROBO_API int grobo_sim_set_faults(grobo_sim *sim, const char *list, size_t length);

GROBO_END_DECLS

#endif
