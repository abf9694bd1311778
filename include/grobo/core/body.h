/* SPDX-License-Identifier: MIT */
/**
 * @file body.h
 * @brief Whole-body playback: key poses that give the legs as targets of waist and feet become
 * joint angles, frame by frame, as Choreonoid's author saw them.
 *
 * Nothing here allocates, reads a clock or prints: a motion being solved lives in a workspace the
 * caller gives. Lengths are metres, angles radians, masses kilograms, times seconds (double: they
 * are what motion files hold). Rotations are row-major 3x3 matrices that turn a link's frame into
 * the world's. A grobo_body belongs to one thread at a time; two bodies share nothing.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_BODY_H
#define GROBO_CORE_BODY_H

#include <grobo/model.h>

GROBO_BEGIN_DECLS

/** Links a body model can have. */
#define GROBO_BODY_LINKS_MAX 64
/** Joints of a leg, waist to foot. */
#define GROBO_BODY_LEG_JOINTS 6
/** Largest number a key pose may hold, in metres, radians or seconds. */
#define GROBO_BODY_NUMBER_MAX 1e6
/** Acceleration of gravity of the balancer and of every ZMP (Choreonoid's value), m/s^2. */
#define GROBO_BODY_GRAVITY_M_S2 9.8

/* ---- the model: a table of rigid bodies ------------------------------------------------- */

/** Place and attitude of a link. */
typedef struct grobo_transform {
    double p_m[3]; /**< origin */
    double r[9];   /**< rotation, row-major */
} grobo_transform;

/** One rigid body and the revolute joint that ties it to its parent. */
typedef struct grobo_body_link {
    const char *name;       /**< "R_KNEE_P" */
    int parent;             /**< index of an earlier link; -1: the root */
    int joint;              /**< joint index; -1: the root, which floats */
    double axis[3];         /**< unit vector of the joint, the same in the parent and the link */
    double offset_m[3];     /**< origin in the parent's frame; of the root: in the world */
    double mass_kg;         /**< 0 or more */
    double com_m[3];        /**< centre of mass in the link's frame */
    double inertia_kgm2[9]; /**< about the centre of mass, axes of the link's frame */
} grobo_body_link;

/** A foot: the last link of a leg, and its sole. */
typedef struct grobo_body_foot {
    int link;         /**< link index */
    double sole_m[3]; /**< centre of the sole in the link's frame */
    double half_m[2]; /**< half length (x) and half width (y) of the sole's rectangle */
} grobo_body_foot;

/**
 * A robot with a waist and two legs. Link 0 is the waist and the root. A leg has six joints with
 * axes Z, X, Y, Y, Y, X (either sign) and knees that bend the shank backwards.
 */
typedef struct grobo_body_model {
    const char *name;             /**< "GR001" */
    const grobo_body_link *links; /**< n_links of them, parents first */
    int n_links;                  /**< 1..GROBO_BODY_LINKS_MAX */
    int n_joints;                 /**< 1..GROBO_JOINTS_MAX; each joint moves exactly one link */
    grobo_body_foot feet[2];      /**< right, left */
} grobo_body_model;

/** HPI GR001: 21 links, 20 joints in joint order, 0.88475 kg. */
GROBO_API const grobo_body_model *grobo_gr001_body(void);

/**
 * Checks a table: counts, parents first, unit axes, every joint once, finite numbers, positive
 * total mass, and legs of the structure described at grobo_body_model.
 * @return 0, or GROBO_ERR_ARG. Pure; thread safe.
 */
GROBO_API int grobo_body_model_check(const grobo_body_model *model);

/**
 * Forward kinematics: where every link is.
 * @param root the waist; NULL: where the model's table puts it
 * @param q_rad n_joints angles
 * @param[out] links n_links transforms
 */
GROBO_API void grobo_body_forward(const grobo_body_model *model, const grobo_transform *root,
                                  const double *q_rad, grobo_transform *links);

/**
 * Centre of mass of a pose that grobo_body_forward() gave.
 * @param[out] com_m in the world
 * @return the total mass in kg
 */
GROBO_API double grobo_body_com(const grobo_body_model *model, const grobo_transform *links,
                                double com_m[3]);

/** How a body moves; the root's velocities are those of its origin, along the world's axes. */
typedef struct grobo_body_velocity {
    double linear_m_s[3];      /**< of the root's origin */
    double angular_rad_s[3];   /**< of the root */
    const double *joint_rad_s; /**< n_joints speeds */
} grobo_body_velocity;

/** Linear momentum, and angular momentum about the world's origin. */
typedef struct grobo_momentum {
    double p_kgm_s[3];  /**< sum of m v */
    double l_kgm2_s[3]; /**< sum of c x m v + I w */
} grobo_momentum;

/** Momentum of a pose that grobo_body_forward() gave, moving so. */
GROBO_API void grobo_body_momentum(const grobo_body_model *model, const grobo_transform *links,
                                   const grobo_body_velocity *velocity, grobo_momentum *momentum);

/**
 * Zero-moment point: where in the plane of height zmp_m[2] the ground's force acts. In free fall
 * there is none; it is then far away.
 * @param com_m centre of mass @param mass_kg total mass
 * @param rate rate of change of momentum (N and Nm in the fields of grobo_momentum)
 * @param[in,out] zmp_m z is read, x and y are written
 */
GROBO_API void grobo_body_zmp(const double com_m[3], double mass_kg, const grobo_momentum *rate,
                              double zmp_m[3]);

/**
 * Leg IK in closed form: exact, no seed, the same answer for the same target.
 * @param foot 0 right, 1 left
 * @param target the foot in the frame of the waist
 * @param[out] q_rad six angles, hip to ankle
 * @return 0, or GROBO_ERR_UNREACHABLE (out of reach, or toes pointing along the leg). Joint limits
 * are not looked at. Thread safe.
 */
GROBO_API int grobo_body_leg_exact(const grobo_body_model *model, int foot,
                                   const grobo_transform *target,
                                   double q_rad[GROBO_BODY_LEG_JOINTS]);

/* ---- a pose on the ground ------------------------------------------------------------------ */

/** A pose of which only the angles are known, on level ground at z 0. */
typedef struct grobo_body_stand {
    grobo_transform root;   /**< the waist in the world */
    double com_m[3];        /**< centre of mass */
    double sole_m[2][4][3]; /**< corners of the right and the left sole */
    double support_m[8][2]; /**< corners of the convex hull of the standing soles, counter-clockwise
                                 seen from above */
    int n_support;          /**< how many, 0: no foot stands */
    int foot;               /**< the foot it stands on: 0 right, 1 left */
    bool standing[2];       /**< all corners are within 4 mm of the ground: right, left */
} grobo_body_stand;

/**
 * Stands a pose on its lower foot: that sole lies flat on the ground, its centre below where it is
 * with straight legs.
 * @param q_rad n_joints angles
 * @param root where the waist is; NULL: as the lower foot has it
 * @param[out] stand untouched on error
 * @return 0, GROBO_ERR_ARG or GROBO_ERR_NAN. Thread safe.
 */
GROBO_API int grobo_body_stand_pose(const grobo_body_model *model, const double *q_rad,
                                    const grobo_transform *root, grobo_body_stand *stand);

/** How far a point of the ground is inside the support polygon, in metres; negative: outside,
 *  -INFINITY where no foot stands. */
GROBO_API double grobo_body_stand_margin(const grobo_body_stand *stand, const double *point_m);

/**
 * Zero-moment point at the second of three poses of a motion that are dt_s apart, on the ground.
 * @param root the waist in each @param q_rad n_joints angles of each @param[out] zmp_m z is 0
 * @return 0, or GROBO_ERR_ARG.
 */
GROBO_API int grobo_body_zmp_of_poses(const grobo_body_model *model, const grobo_transform root[3],
                                      const double *const q_rad[3], double dt_s, double zmp_m[3]);

/* ---- a motion being solved --------------------------------------------------------------- */

/** Where a link shall be at a key pose. */
typedef struct grobo_body_target {
    grobo_transform at; /**< in the world */
    int link;           /**< link index; targets of links other than waist and feet are ignored */
    bool base;          /**< the tree is walked from here */
    bool stationary;    /**< stands still at this key */
    bool touching;      /**< a foot: on the ground */
    bool slave;         /**< a foot: follows the joints' own keys unless touching */
} grobo_body_target;

/**
 * A key pose. What it points to is read during the call it is given to only. As in Choreonoid, a
 * key whose time equals an earlier one's goes before it.
 */
typedef struct grobo_body_key {
    double time_s;               /**< absolute; keys may come in any order */
    double max_transition_s;     /**< 0: none; otherwise the longest way from the key before */
    grobo_joint_mask joints;     /**< which joints this key gives */
    grobo_joint_mask stationary; /**< which of them have zero speed here */
    const double *q_rad;         /**< by joint index; read where `joints` says so */
    const grobo_body_target *targets;
    size_t n_targets;
    double zmp_m[3];
    bool has_zmp;        /**< zmp_m is given */
    bool zmp_stationary; /**< the ZMP stands still at this key */
} grobo_body_key;

/** How the legs are solved. */
typedef enum grobo_body_ik {
    GROBO_BODY_IK_EXACT = 0,   /**< closed form */
    GROBO_BODY_IK_NUMERIC = 1, /**< Choreonoid's iteration with its tolerance */
    GROBO_BODY_IK_OFF = 2      /**< targets are ignored */
} grobo_body_ik;

/** What is added where a foot lifts and lands. */
typedef enum grobo_body_step {
    GROBO_BODY_STEP_NONE = 0,    /**< nothing */
    GROBO_BODY_STEP_STEALTHY = 1 /**< up and down without sliding or stamping */
} grobo_body_step;

/** Where the desired ZMP comes from. */
typedef enum grobo_body_zmp_source {
    GROBO_BODY_ZMP_FILE = 0, /**< from the key poses alone */
    GROBO_BODY_ZMP_AUTO = 1  /**< keys are added where steps need them */
} grobo_body_zmp_source;

/**
 * Whether the waist is moved so that the body balances on the desired ZMP. A motion without any
 * (no key has one, none is added) is left as it is.
 */
typedef enum grobo_body_balance {
    GROBO_BODY_BALANCE_OFF = 0,
    GROBO_BODY_BALANCE_ON = 1,
    GROBO_BODY_BALANCE_COMPAT11 = 2 /**< as Choreonoid 1.1 did, which made the robot's motions */
} grobo_body_balance;

/** Options; zero is: exact, none, file, off, 100 Hz. grobo_body_init() does not look at `size`. */
typedef struct grobo_body_options {
    size_t size; /**< GROBO_BODY_OPTIONS_INIT */
    grobo_body_ik ik;
    grobo_body_step step;
    grobo_body_zmp_source zmp;
    grobo_body_balance balance;
    double rate_hz; /**< frames a second, up to 10000; 0: 100 */
} grobo_body_options;
/** Begins an initializer of one. */
#define GROBO_BODY_OPTIONS_INIT GROBO_SIZED(grobo_body_options)

/** What is to be solved. Nothing of it but `model` is used after the call it is given to. */
typedef struct grobo_body_setup {
    const grobo_body_model *model; /**< borrowed while the body is in use */
    const grobo_body_key *keys;
    size_t n_keys; /**< at least 1 */
    grobo_body_options options;
} grobo_body_setup;

/** A motion being solved. Lives in the caller's workspace; needs no end. */
typedef struct grobo_body grobo_body;

/** What is worth knowing about a frame beside its angles. */
typedef struct grobo_body_report {
    double time_s;        /**< of the frame */
    grobo_transform root; /**< the waist in the world */
    double zmp_m[3];      /**< desired; meaningful with has_zmp */
    bool has_zmp;
    bool touching[2];     /**< whether the right and the left foot are meant to stand */
    uint64_t unreachable; /**< bit of the foot's link of each leg that does not reach its target */
} grobo_body_report;

/**
 * Bytes of workspace grobo_body_init() needs.
 * @param[out] bytes untouched on error
 * @return 0, GROBO_ERR_ARG (model, options, a number beyond GROBO_BODY_NUMBER_MAX, balancer without
 * IK), GROBO_ERR_NAN or GROBO_ERR_CAP (more than GROBO_MOTION_FRAMES_MAX frames).
 */
GROBO_API int grobo_body_workspace_bytes(const grobo_body_setup *setup, size_t *bytes);

/**
 * Makes a body ready at its first frame. With the balancer this solves the whole motion several
 * times; without, it only sorts keys and frames are solved as they are asked for.
 * @param workspace aligned as malloc() aligns; to be kept while the body is in use
 * @param[out] body points into the workspace; untouched on error
 * @return 0, GROBO_ERR_SPACE, or as grobo_body_workspace_bytes().
 */
GROBO_API int grobo_body_init(const grobo_body_setup *setup, void *workspace,
                              size_t workspace_bytes, grobo_body **body);

/** Number of frames, at least 1. With the balancer they last one second beyond the last key. */
GROBO_API int grobo_body_frame_count(const grobo_body *body);

/** Joints that the motion moves: those with keys, and of legs between waist and foot targets. */
GROBO_API grobo_joint_mask grobo_body_joints(const grobo_body *body);

/**
 * Solves one frame. Frames may be asked for in any order; joints that the motion gives no key and
 * legs out of reach stay as the frame solved before left them, as they do in Choreonoid, so that
 * frames in order from 0 agree with it.
 * @param frame 0..grobo_body_frame_count() - 1
 * @param[out] q_rad n_joints angles
 * @param[out] report may be NULL
 * @return 0, or GROBO_ERR_ARG. An unreachable target is no error: see the report.
 */
GROBO_API int grobo_body_frame(grobo_body *body, int frame, double *q_rad,
                               grobo_body_report *report);

/**
 * As grobo_body_frame() at any time; before the first and after the last key the pose is constant.
 * @return 0, or GROBO_ERR_NAN.
 */
GROBO_API int grobo_body_sample(grobo_body *body, double time_s, double *q_rad,
                                grobo_body_report *report);

/* ---- the lint of a walk ------------------------------------------------------------------ */

/** What can be wrong with a whole-body motion. */
typedef enum grobo_body_problem {
    GROBO_BODY_UNREACHABLE = 0, /**< a leg does not reach its target; index: its foot's link */
    GROBO_BODY_ZMP_MARGIN = 1,  /**< the ZMP is nearer to the soles' edge than asked, or outside */
    GROBO_BODY_NO_SUPPORT = 2,  /**< no foot stands */
    GROBO_BODY_FOOT_SLIP = 3,   /**< a standing foot moves; index: its link */
    GROBO_BODY_JOINT_LIMIT = 4, /**< an angle beyond its limit after IK; index: the joint */
    GROBO_BODY_JOINT_SPEED = 5, /**< faster than the servo after IK; index: the joint */
    GROBO_BODY_FALL = 6         /**< the body falls; index: a grobo_body_side */
} grobo_body_problem;

/** To which side a body falls. */
typedef enum grobo_body_side {
    GROBO_BODY_AHEAD = 0,
    GROBO_BODY_BACK = 1,
    GROBO_BODY_LEFT = 2,
    GROBO_BODY_RIGHT = 3
} grobo_body_side;

/** A problem that lasts from one frame to another. */
typedef struct grobo_body_finding {
    grobo_body_problem problem;
    int index;      /**< link or joint, see grobo_body_problem; 0 where there is none */
    double begin_s; /**< first frame that has it */
    double end_s;   /**< last frame that has it */
    double worst_s; /**< the frame where it is worst */
    /**
     * How bad it is there: ZMP_MARGIN: metres inside the edge, negative outside; FOOT_SLIP: metres
     * from where the sole came to stand; JOINT_LIMIT: radians beyond; JOINT_SPEED: radians a
     * second; FALL: radians by which the floor slopes, 0: level; otherwise 0.
     */
    double worst;
} grobo_body_finding;

/** Balance of one frame, what a picture of a walk is drawn from. */
typedef struct grobo_body_balance_frame {
    double time_s;
    double com_m[3];        /**< centre of mass */
    double zmp_m[3];        /**< of the moving body, in the plane of the standing soles */
    double desired_m[3];    /**< the motion's own ZMP; meaningful with has_desired */
    double margin_m;        /**< ZMP inside the soles' hull, negative outside; with standing feet */
    double sole_m[2][4][3]; /**< corners of the right and the left sole */
    bool has_desired;
    bool standing[2]; /**< right, left */
} grobo_body_balance_frame;

/** What is looked for, and the callbacks. Zero: balance only, tolerances as given, no callback. */
typedef struct grobo_body_check_options {
    size_t size;              /**< GROBO_BODY_CHECK_OPTIONS_INIT */
    const grobo_model *robot; /**< limits and speeds of the joints; NULL: not checked */
    double margin_m;          /**< the ZMP shall be so far inside; 0: anywhere inside */
    double slip_m;            /**< how far a standing foot may move; 0: 0.001 */
    uint16_t speed_pct;       /**< the speed it is played at; 0: 100 */
    /**
     * Balance is that of the angles which `robot` plays: grobo_model_take_slack(). JOINT_LIMIT is
     * reported all the same.
     */
    bool takes_slack;
    /** Told of each frame in order; may be NULL. The frame is valid during the call. */
    void (*frame)(void *ctx, const grobo_body_balance_frame *frame);
    /** Told of each problem when it has ended; may be NULL. Valid during the call. */
    void (*finding)(void *ctx, const grobo_body_finding *finding);
    void *ctx; /**< handed back */
    /**
     * Also plays the motion on a body that can fall, for GROBO_BODY_FALL, before all else. The body
     * is free and begins on its feet, in the initial posture of `robot` where there is one; its
     * servos lag, give way to loads and are no faster than they can; the corners of the soles bear
     * what they can bear, whatever the motion says of them. If it stands on level floor it is
     * tried on floors that slope by 1.5 degrees to each side. A fall begins when a sole was last
     * tilted by less than 10 degrees and is worst where both pass 30. At most the first 600 s are
     * played; a second of them takes about 40 ms.
     */
    bool falls;
} grobo_body_check_options;
/** Begins an initializer of one. */
#define GROBO_BODY_CHECK_OPTIONS_INIT GROBO_SIZED(grobo_body_check_options)

/**
 * Solves every frame and finds whether the robot will fall. Feet without targets have no support to
 * be checked against; then limits and speeds alone are. The ZMP is that of the motion started from
 * rest, by differences between frames: frames 0.01 s apart or more are sensible. Times in findings
 * are those of the motion, whatever its speed.
 * @return number of findings, or GROBO_ERR_ARG (robot has other joints than the body's model).
 */
GROBO_API int grobo_body_check(grobo_body *body, const grobo_body_check_options *options);

/** Name of a problem, for text and JSON: "zmp-margin". Static string, never NULL. Thread safe. */
GROBO_API const char *grobo_body_problem_name(grobo_body_problem problem);

GROBO_END_DECLS

#endif
