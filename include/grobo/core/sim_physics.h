/* SPDX-License-Identifier: MIT */
/**
 * @file sim_physics.h
 * @brief Weight for a simulated robot: motors with their firmware's loop, friction, gravity.
 *
 * A simulator (sim.h) whose configuration names a world of this file has servos that sag, swing and
 * stall. Each servo is its firmware's position loop at its own registers, a motor, a gear with
 * friction; the links are a tree on a fixed base. Time is virtual, in steps of 1 ms: the same bytes
 * at the same times give the same angles to the bit. What is measured, what is from a data sheet
 * and what is chosen is in docs/simulator.md.
 *
 * The links may be somebody else's: grobo_sim_plant is all that the motors know of them.
 *
 * What is in here is in the static library alone (libgrobo.a).
 * A world belongs to one simulator, and to its thread. Angles are radians of the joints (not of the
 * servos' shafts), torques Nm at the joints, unless a name says otherwise.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_SIM_PHYSICS_H
#define GROBO_CORE_SIM_PHYSICS_H

#include <grobo/mem.h>
#include <grobo/sim.h>

GROBO_BEGIN_DECLS

struct grobo_imu; /* imu.h */

/** Length of a step. */
#define GROBO_SIM_STEP_US 1000

/* ---- motors --------------------------------------------------------------------------------- */

/** Where the numbers of a motor come from. */
typedef enum grobo_sim_motor_source {
    GROBO_SIM_MOTOR_IDENTIFIED = 0, /**< fitted to real servos; `source` names the work */
    GROBO_SIM_MOTOR_DATA_SHEET = 1, /**< from stall torque and no-load speed; the rest is chosen */
    GROBO_SIM_MOTOR_GIVEN = 2       /**< by the robot's file or a program */
} grobo_sim_motor_source;

/**
 * Friction, the largest that can act, in Nm: base + viscous |w|, and where others are given, with
 * s = exp(-|w / stribeck_rad_s|^stribeck_power), e the torque from outside and m that of the motor:
 * + stribeck s + |e load_external - m load_motor| + s |e load_external_s - m load_motor_s|, and
 * where e and m have different signs + s (|e| < |m| ? square_external e^2 : square_motor m^2).
 * Source: Duclusaud and others, arXiv 2410.08650, models m1 and m6.
 */
typedef struct grobo_sim_friction {
    double base_nm;
    double viscous_nms; /**< Nm s/rad */
    double stribeck_nm; /**< 0: no Stribeck effect */
    double load_external, load_motor;
    double load_external_s, load_motor_s;
    double square_external, square_motor; /**< 1/Nm */
    double stribeck_rad_s;                /**< rad/s */
    double stribeck_power;
} grobo_sim_friction;

/** A servo's motor with its gear, at the servo's shaft. */
typedef struct grobo_sim_motor {
    const char *model;  /**< of grobo_servo_model: "STS3215" */
    const char *source; /**< of the numbers, for people */
    grobo_sim_motor_source from;
    double duty_per_rad; /**< of an error of 1 rad at a P of 1; 0: as the family's manual has it */
    double duty_max;     /**< 0..1 of the supply */
    double kt_nm_a;      /**< torque of a current; also volts of a speed, V s/rad */
    double resistance_ohm;
    double armature_kgm2;
    double torque_max_nm; /**< what the gear gives at most; 0: no bound */
    double profile_rad_s; /**< the loop's set point moves no faster; 0: at once */
    double backlash_rad;  /**< of the gear, from one end to the other */
    grobo_sim_friction friction;
} grobo_sim_motor;

/**
 * The motor of a servo's model: identified where somebody has published it, else of its data sheet.
 * @param[out] motor strings in it are static, or the model's
 * @return 0, or GROBO_ERR_ARG
 */
GROBO_API int grobo_sim_motor_of(const grobo_servo_model *model, grobo_sim_motor *motor);

/* ---- the body ------------------------------------------------------------------------------- */

/** What a servo does to its joint during a step. */
typedef struct grobo_sim_drive {
    double torque_nm;     /**< at no speed */
    double damping_nms;   /**< less torque by so much for each rad/s */
    double friction_nm;   /**< against any motion, as much as is needed to stop it, up to this */
    double armature_kgm2; /**< inertia of rotor and gear */
    double low_rad_s;     /**< speeds outside of these cannot be: a stop, a wall, a hand */
    double high_rad_s;
} grobo_sim_drive;

/** How a joint is, in and out of a step. */
typedef struct grobo_sim_state {
    double angle_rad;
    double speed_rad_s;
    double load_nm; /**< what the links put on it, gravity and coupling, at no acceleration; 0 where
                         a plant cannot tell: friction of gears then does not grow with load */
} grobo_sim_state;

/** What the motors move: torques go out, angles and speeds come in, a step of time. */
typedef struct grobo_sim_plant {
    /**
     * Moves all joints on by dt_s.
     * @param drive of each joint
     * @param[in,out] state of each joint: as it is, which may have been set since the last step (a
     *   hand), and as it is afterwards
     * @return 0; negative: the step did not happen, and the joints stay where they are
     */
    int (*step)(void *ctx, const grobo_sim_drive *drive, double dt_s, grobo_sim_state *state);
    void *ctx;
    /** How the base stands at the end of the latest step. NULL: it is not told. @return 0, or an
     *  error: there is no reading. */
    int (*imu)(void *ctx, struct grobo_imu *imu);
} grobo_sim_plant;

/** A rigid part. Its frame is that of its joint. */
typedef struct grobo_sim_link {
    const char *name;       /**< for payloads; may be NULL */
    int parent;             /**< index of an earlier part; -1: the base */
    int joint;              /**< the joint between them; -1: it is fixed */
    double origin_m[3];     /**< its frame in the parent's, where the joint is at 0 */
    double r[9];            /**< rotation of it, row-major */
    double axis[3];         /**< of the joint, in its own frame, of length 1 */
    double mass_kg;         /**< 0: none */
    double com_m[3];        /**< centre of mass, in its frame */
    double inertia_kgm2[6]; /**< about that, along its axes: xx, yy, zz, xy, xz, yz */
} grobo_sim_link;

/* ---- a world -------------------------------------------------------------------------------- */

/** Zero in a field means its default. */
typedef struct grobo_sim_physics_config {
    size_t size;                          /**< GROBO_SIM_PHYSICS_CONFIG_INIT */
    const grobo_model *model;             /**< of the simulator; needed. Borrowed */
    const grobo_sim_link *links;          /**< n_links of them, each behind its parent; copied */
    int n_links;                          /**< 0: joints without weight */
    double gravity_m_s2[3];               /**< all 0: 9.80665 down (-z of the base) */
    const grobo_sim_motor *const *motors; /**< of each joint, NULL: of its servo's model; NULL: all
                                               are. Copied */
    const grobo_sim_plant *plant;         /**< copied; NULL: the links, by the library's dynamics */
    bool real_time; /**< a clock drives it: what is late by more than 0.2 s is skipped, not made up
                             for */
    uint32_t supply_mohm;  /**< resistance of battery and wires; 100 */
    bool no_encoder_steps; /**< the loop sees angles without steps */
} grobo_sim_physics_config;
/** Begins an initializer of one. */
#define GROBO_SIM_PHYSICS_CONFIG_INIT GROBO_SIZED(grobo_sim_physics_config)

/**
 * Makes a world for grobo_sim_config.physics.
 * @param mem NULL: the C library's
 * @param[out] physics freed with grobo_sim_physics_free() after its simulator's last use
 * @return 0, GROBO_ERR_ARG (a bad model, links that are not a tree or not finite, a joint of two
 *   links), GROBO_ERR_CAP, GROBO_ERR_NOMEM
 */
GROBO_API int grobo_sim_physics_new(const grobo_sim_physics_config *config, const grobo_mem *mem,
                                    grobo_sim_physics **physics);

/** Frees; NULL is fine. */
GROBO_API void grobo_sim_physics_free(grobo_sim_physics *physics);

/** What a joint of a world does now. Of the joint, but for what is of its servo. */
typedef struct grobo_sim_physics_view {
    double angle_rad;
    double speed_rad_s;
    double load_nm;               /**< of gravity and coupling */
    double motor_nm;              /**< of the motor, before friction */
    double duty;                  /**< -1..1 */
    double winding_a;             /**< with the sign of the servo's torque */
    double set_rad;               /**< where the loop wants the servo's shaft now */
    const grobo_sim_motor *motor; /**< of its servo */
} grobo_sim_physics_view;

/** What a joint does at the end of the latest step. @return 0, or GROBO_ERR_ARG. */
GROBO_API int grobo_sim_physics_look(const grobo_sim_physics *physics, int joint,
                                     grobo_sim_physics_view *view);

/** Steps that were skipped because the clock was ahead. */
GROBO_API uint64_t grobo_sim_physics_skipped(const grobo_sim_physics *physics);

/**
 * A hand pushes a joint with this torque until told otherwise, -100..100 Nm; 0: it is gone.
 * @return 0; GROBO_ERR_ARG; GROBO_ERR_UNSUPPORTED: the simulator has no world
 */
GROBO_API int grobo_sim_push(grobo_sim *sim, int servo, double torque_nm);

/**
 * Something heavy in the hand: a mass of 0..100 kg at a link's origin. Only one; 0 takes it away.
 * @param link its name; NULL: the last link
 * @return 0; GROBO_ERR_ARG; GROBO_ERR_NOTFOUND: no such link; GROBO_ERR_UNSUPPORTED: the simulator
 *   has no world, or its links are a plant's
 */
GROBO_API int grobo_sim_set_payload(grobo_sim *sim, const char *link, double mass_kg);

/**
 * Walls that a joint's shaft meets, beside its mechanical stops: it gets no further than these.
 * @param min_mdeg INT32_MIN: none @param max_mdeg INT32_MAX: none
 * @return 0; GROBO_ERR_ARG (also min > max); GROBO_ERR_UNSUPPORTED: the simulator has no world
 */
GROBO_API int grobo_sim_set_wall(grobo_sim *sim, int servo, int32_t min_mdeg, int32_t max_mdeg);

/**
 * A weak supply: resistance of battery and wires, 0..100000 mOhm.
 * @return 0; GROBO_ERR_ARG; GROBO_ERR_UNSUPPORTED: the simulator has no world
 */
GROBO_API int grobo_sim_set_supply_mohm(grobo_sim *sim, uint32_t mohm);

GROBO_END_DECLS

#endif
