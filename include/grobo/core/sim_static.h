/* SPDX-License-Identifier: MIT */
/**
 * @file sim_static.h
 * @brief A simulated robot in storage of one's own: for firmware and for tests in virtual time.
 *
 * The sizes below change from version to version: link such a program statically (libgrobo-core.a,
 * libgrobo.a). With the shared library a simulator comes from session.h or sim_server.h.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_SIM_STATIC_H
#define GROBO_CORE_SIM_STATIC_H

#include <grobo/core/sim.h>

GROBO_BEGIN_DECLS

/** Bytes of registers of a servo; one that has more cannot be simulated. Private. */
#ifndef GROBO_SIM_REGISTER_BYTES
#define GROBO_SIM_REGISTER_BYTES 896
#endif
/** Those of them that survive power-off. Private. */
#define GROBO_SIM_KEPT_BYTES 64
/** Longest write that a servo keeps until its action. Private. */
#define GROBO_SIM_WRITE_BYTES 32
/** Indirect registers of a servo. Private. */
#ifndef GROBO_SIM_INDIRECTS
#define GROBO_SIM_INDIRECTS 256
#endif
/** Bytes of registers that a servo backs up; one that has more has no backup. Private. */
#ifndef GROBO_SIM_BACKUP_BYTES
#define GROBO_SIM_BACKUP_BYTES GROBO_SIM_REGISTER_BYTES
#endif
/** Families on one line. Private. */
#define GROBO_SIM_FAMILIES_MAX 4

/** What a servo wants and can do, by its registers. Private. */
typedef struct grobo_sim_wants {
    /* private */
    double heat_c_per_ma2;     /* above ambient, of a current that lasts */
    int32_t goal_mdeg;         /* where it wants its shaft */
    int32_t speed_mdeg_s;      /* without load at nominal_mv */
    int32_t stall_ma, most_ma; /* at a stop: by the motor, by the registers */
    int32_t limit_c, nominal_mv;
    int32_t cap_mdeg_s;       /* top speed of a move by the registers; 0: none */
    int32_t accel_mdeg_s2;    /* of a move; 0: at once */
    int32_t time_us, ramp_us; /* a move by its duration; 0: not so */
    int32_t wheel_mdeg_s;     /* speed where it turns on and on */
    bool wheel;
    uint8_t torque; /* grobo_torque */
    uint8_t id;
} grobo_sim_wants;

/** A move with ramps: signed speeds in 0.001 degree a second, times in seconds. Private. */
typedef struct grobo_sim_ramps {
    /* private */
    double start, peak, end_accel; /* speed at its begin and in its middle; how it ends */
    double ramp_s, even_s, brake_s;
} grobo_sim_ramps;

/** One servo. Private: use the functions. */
typedef struct grobo_sim_servo {
    /* private */
    double temperature_c;       /* at settled_us */
    int64_t settled_us;         /* what it did on its own is known up to here */
    int64_t start_us, move_us;  /* the present move: when it began, how long the shaft takes */
    int64_t plan_us;            /* how long it takes where no stop is met; 0 by hand */
    int64_t begun_us;           /* when the last goal was written; later by what it rested since */
    int64_t due_us;             /* when the goal time of the last goal is over */
    int64_t deaf_until_us;      /* end of a flash write or a reboot */
    int64_t saved_us;           /* end of a flash write under way, or GROBO_NEVER_US */
    int32_t from_mdeg, to_mdeg; /* the present move, of the shaft */
    int32_t stop_min_mdeg, stop_max_mdeg; /* mechanical stops */
    int32_t load_ma;                      /* extra current of a hand or a weight */
    int32_t baud_bps;                     /* of register BAUD at the last restart */
    grobo_sim_ramps ramps;                /* of the present move */
    int64_t heard_us;                     /* the last instruction for it */
    int32_t turns_ticks;                  /* what a restart made of turns before */
    uint8_t kept[GROBO_SIM_WRITE_BYTES];  /* a write that waits for its action */
    uint16_t kept_address;
    uint8_t kept_bytes; /* 0: none */
    const grobo_sim_family *family;
    const grobo_servo_model *model;
    grobo_sim_wants plant;                  /* follows the registers */
    uint8_t reg[GROBO_SIM_REGISTER_BYTES];  /* present values are filled in when read */
    uint8_t flash[GROBO_SIM_KEPT_BYTES];    /* registers that survive power-off */
    uint16_t indirect[GROBO_SIM_INDIRECTS]; /* addresses that indirect data stand for */
    uint8_t indirect_data[GROBO_SIM_INDIRECTS];
    uint8_t status; /* flags of the next return packet */
    uint8_t cable;  /* grobo_sim_cable */
    bool powered, blocked, stalled, by_hand, reboots_after_save, ramped;
    struct grobo_i_body *body; /* where its shaft is in a world with weight; NULL: in none */
    uint8_t backup[GROBO_SIM_BACKUP_BYTES]; /* registers when its control table was backed up */
    uint16_t backup_indirect[GROBO_SIM_INDIRECTS];
    bool backed_up; /* there is such a backup */
} grobo_sim_servo;

/** Bytes on a wire, each with the time at which it is over. Private. */
typedef struct grobo_sim_wire {
    /* private */
    int64_t at_ns[GROBO_SIM_WIRE_BYTES];
    uint8_t byte[GROBO_SIM_WIRE_BYTES];
    uint16_t head, used;
    int64_t free_ns; /* the last byte's end */
} grobo_sim_wire;

/** Longest reply of a simulated servo. Private. */
#ifndef GROBO_SIM_TALK_BYTES
#define GROBO_SIM_TALK_BYTES 256
#endif

/** Of all talks under way: what 64 servos say to one question fits. Private. */
#ifndef GROBO_SIM_TALKS_BYTES
#define GROBO_SIM_TALKS_BYTES (GROBO_SIM_TALKS_MAX * 96)
#endif

/** Bytes that servos say in one go, from start_ns on without a pause. Private. */
typedef struct grobo_sim_talk {
    /* private */
    int64_t start_ns;
    uint16_t at; /* in grobo_sim.talk_byte; the next talk's are behind them */
    uint16_t used, said;
} grobo_sim_talk;

/** What servos of a family hear: one for all, as they hear the same. Private. */
typedef struct grobo_sim_ear {
    /* private */
    const grobo_sim_family *family;
    uint16_t used;
    uint8_t byte[GROBO_SIM_EAR_BYTES];
} grobo_sim_ear;

/** What the board is doing. Private. */
typedef enum grobo_sim_board_state {
    GROBO_SIM_BOARD_IDLE,    /* takes bytes of the host */
    GROBO_SIM_BOARD_SENDING, /* relays a payload to the servos */
    GROBO_SIM_BOARD_WAITING, /* for the bytes of a reply */
    GROBO_SIM_BOARD_REPLYING /* sends a reply to the host */
} grobo_sim_board_state;

/**
 * A simulated robot in the caller's storage. It holds no resource: there is nothing to deinit.
 * Fields are private but stats.
 */
struct grobo_sim {
    grobo_sim_stats stats; /**< read freely */
    /* private */
    grobo_sim_config config;
    int64_t now_us, now_ns;            /* of what happens; the latest time outside of calls */
    int64_t line_byte_ns, bus_byte_ns; /* 10 bits at the baud rate; 0 unpaced */
    uint32_t line_bps, bus_bps;        /* the host's rate; the servos' bus's */
    uint32_t supply_mv;
    uint32_t fault_below[GROBO_SIM_FAULTS]; /* a fault strikes when its generator gives less */
    uint32_t random[GROBO_SIM_FAULTS + 1];  /* one generator a fault, one for the rest */
    bool gone;                              /* hung up */
    bool parity;                            /* a byte has 11 bits, and is lost with one wrong */
    uint8_t n_servos;
    grobo_sim_wire in, out; /* from the host, to the host */
    int64_t hand_over_ns;   /* when the host's adapter hands over what it has */

    grobo_board_parser board;
    grobo_sim_board_state board_state;
    int64_t board_at_ns;                /* end of the byte it sends, of its reply, of silence */
    uint8_t fifo[GROBO_SIM_FIFO_BYTES]; /* bytes that arrived while it was busy */
    uint16_t fifo_head, fifo_used;
    uint8_t send[GROBO_RELAY_MAX_BYTES]; /* the payload being relayed */
    uint8_t send_used, sent;
    uint8_t sending;        /* bytes behind those that are over at board_at_ns */
    uint8_t want;           /* bytes asked for by T; 0 for S */
    uint8_t got[UINT8_MAX]; /* of the reply */
    uint8_t got_used;

    grobo_sim_ear ear[GROBO_SIM_FAMILIES_MAX];
    uint8_t n_ears;
    int64_t bus_heard_ns;                     /* end of the last byte they heard */
    grobo_sim_talk talk[GROBO_SIM_TALKS_MAX]; /* n_talks of them, in the order they began */
    uint16_t n_talks;
    uint16_t talk_bytes; /* of them all */
    uint8_t talk_byte[GROBO_SIM_TALKS_BYTES];
    /* The last member: where the library makes a simulator there are as many as its model has
     * joints (grobo_i_sim_bytes()). */
    grobo_sim_servo servo[GROBO_SIM_SERVOS_MAX];
};

/**
 * Powers a simulated robot up: torque off everywhere, goals 0, flash as the factory left it but
 * for the ids of the model and, on bus wiring, the rate of the line. The hook hears nothing of it.
 * @param config NULL: all defaults. Copied; the model is borrowed.
 * @return 0; GROBO_ERR_ARG for a bad model, ambient temperature, baud rate below 300 or (bus
 *         wiring) not one of the servos', a simulator of another size than the library's, an id
 *         that a servo cannot have, an echo or other servos than RS30x through the board;
 *         GROBO_ERR_CAP for more than GROBO_SIM_SERVOS_MAX joints; GROBO_ERR_UNSUPPORTED for a
 *         servo that no family knows. After an error the simulator must not be used.
 */
#define grobo_sim_init(sim, config, now_us)                                                        \
    grobo_sim_init_sized(sim, sizeof(grobo_sim), config, now_us)
/** Of grobo_sim_init(). */
GROBO_API int grobo_sim_init_sized(grobo_sim *sim, size_t sim_bytes, const grobo_sim_config *config,
                                   int64_t now_us);

GROBO_END_DECLS

#endif
