/* SPDX-License-Identifier: MIT */
/*
 * The engine against the simulator in virtual time: bytes go between them at the very
 * microsecond, and what must always hold is checked at every frame and every event.
 */
#ifndef GROBO_TEST_RIG_H
#define GROBO_TEST_RIG_H

#include <grobo/core/board.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>

#include "tests/support/test.h"
#include "tests/support/witness.h"

enum { RIG_EVENTS = 4096, RIG_SENT = 4096 };

/* A frame as it left the engine. */
typedef struct rig_frame {
    int64_t at_us;
    uint8_t size;
    uint8_t bytes[GROBO_RS30X_PACKET_MAX_BYTES];
} rig_frame;

/* The way that the frames ask of a joint. */
typedef struct rig_way {
    double from_deg, to_deg;
    int64_t from_us, to_us;
} rig_way;

/* A joint should be on one of these ways. Two are what the frames ask for, and a joint is taken to
 * be off them where it is read far beside them, off the one sooner than off the other; the third
 * begins anew with a goal before which the servo told where it is going. */
enum { RIG_ASKED = 2, RIG_WAYS };

typedef struct grobo_test_rig {
    grobo_robot robot;
    grobo_sim sim;
    const grobo_driver *driver;
    int64_t now_us;
    int64_t wake_us;   /* a stalled host does not pump the engine before */
    int64_t replug_us; /* 0: a line that hung up stays so; else it is back after this time */
    int64_t back_us;   /* when */
    bool asked;        /* false from then until the test says that somebody asked for something */
    grobo_event events[RIG_EVENTS];
    size_t n_events;
    rig_frame sent[RIG_SENT];
    size_t n_sent;
    /* Hooks, NULL where nobody wants them: an event of the engine, a frame after it left, an event
     * of the simulator. */
    void (*on_event)(struct grobo_test_rig *rig, const grobo_event *event);
    void (*on_frame)(struct grobo_test_rig *rig, const uint8_t *bytes, size_t n);
    void (*on_sim)(struct grobo_test_rig *rig, const grobo_sim_event *event);
    void *ctx;                                /* of the hooks */
    bool halts_at_estop;                      /* the driver switches no torque */
    bool judged;                              /* somebody else judges where torque comes on */
    rig_way ways[GROBO_JOINTS_MAX][RIG_WAYS]; /* to check speeds by */
    rig_way own[GROBO_JOINTS_MAX];            /* by what the servo said of its move last */
    bool off[GROBO_JOINTS_MAX][RIG_ASKED];    /* it is on its own way instead */
    grobo_joint_mask on_way;                  /* joints that have one */
    grobo_joint_mask own_told;                /* since the last goal */
    grobo_joint_mask loose;                   /* told to be without torque since then */
    int64_t told_us[GROBO_JOINTS_MAX];        /* when a frame for it left last */
    witness witness;                          /* of what was truly said */
    int64_t torque_us;                        /* when a torque was last switched */
    unsigned torque_on;                       /* torques switched on */
    unsigned excused;                         /* goals and torques that a made-up packet explains */
    unsigned frames;                          /* sent */
    unsigned lose;                            /* so many of the next ones do not arrive */
} grobo_test_rig;

/* Joints of GR001 that tests move, in joint order, and the ids of some. */
enum {
    HIP = 0,
    R_HIP_R = 1,
    R_HIP_P = 2,
    R_KNEE = 3,
    CHEST = 12,
    NECK = 13,
    SHOULDER = 14,
    R_ELBOW = 16,
    L_ELBOW = 19,
    NECK_ID = 2,
    R_ELBOW_ID = 5
};
/* A config for rig_start(): joints are read only where something asks. */
extern const grobo_robot_config quiet;
/* How rig_start() reaches the servos: through the board, unless a test says otherwise. */
extern grobo_wiring rig_wiring;
/* When rig_start() begins, on its clock: 1 s, unless a test says otherwise. */
extern int64_t rig_epoch_us;
/* For tests that begin with rig_start(): the board, and servos straight on a bus. */
extern const test_fixture rig_wirings[2];
/* GR001, all defaults, link up at once. config, sim NULL: defaults. */
void rig_start(grobo_test_rig *rig, const grobo_robot_config *config, const grobo_sim_config *sim);
/* The clock of the rig for its engine, where a test made that anew. */
void rig_host(grobo_test_rig *rig);
/* The same with a driver of one's own. */
void rig_start_driver(grobo_test_rig *rig, const grobo_driver *driver,
                      const grobo_robot_config *config, const grobo_sim_config *sim);
/* The same, quiet; the driver lets the neck go to 20 degrees, its servo farther. */
void rig_start_narrow(grobo_test_rig *rig);
/* rig_start() with torque on, the neck moved there in 1 s, and all of that forgotten. */
void rig_start_at(grobo_test_rig *rig, double deg, const grobo_robot_config *config);
/* Lets time pass up to now + us. */
void rig_run(grobo_test_rig *rig, int64_t us);
/* Lets time pass until a job ends, 60 s at most. */
const grobo_event_job *rig_wait(grobo_test_rig *rig, int number);
/* rig_wait, and the result is this. */
const grobo_event_job *rig_expect(grobo_test_rig *rig, int number, int result);
/* Lets time pass until playing is in this state. */
void rig_wait_play(grobo_test_rig *rig, grobo_sequencer_state state);
/* The host does nothing for this time, while the robot goes on. */
void rig_stall(grobo_test_rig *rig, int64_t us);
/* Last event of a kind since the last rig_forget(), or NULL. */
const grobo_event *rig_last(const grobo_test_rig *rig, grobo_event_kind kind);
/* Number of events of a kind. */
size_t rig_count(const grobo_test_rig *rig, grobo_event_kind kind);
/* Forgets events and frames. */
void rig_forget(grobo_test_rig *rig);
/* A joint's angle as the simulator has it, degrees. */
double rig_angle_deg(grobo_test_rig *rig, int joint);
grobo_torque rig_torque(grobo_test_rig *rig, int joint);
/* All joints of the model. */
grobo_joint_mask rig_all(const grobo_test_rig *rig);
/* Switches everything on, and asserts that it worked. */
void rig_power(grobo_test_rig *rig);
/* A posture of one joint. */
grobo_posture rig_posture(const grobo_test_rig *rig, int joint, double angle_deg, int time_ms);
/* The packet for servos in a frame, without what the board puts around it; its bytes. */
size_t rig_packet(const rig_frame *frame, const uint8_t **packet);
/* True if this packet for servos is in a frame sent since the last rig_forget(). */
bool rig_packet_was_sent(const grobo_test_rig *rig, const void *bytes, size_t size);

/* The time in the frame that moves motor `id` alone, the last one sent; in ms, -1 for none. */
int rig_sent_ms(const grobo_test_rig *rig, int id);

/* A clip of GR001: key postures that differ from the initial one in a few joints, straight lines
 * between them when sampled. */
typedef struct rig_key {
    int64_t at_ms;
    struct {
        int joint;
        double angle_deg;
    } to[3]; /* joints after the first with joint 0 and angle 0 are none */
} rig_key;

typedef struct rig_clip {
    grobo_clip clip;
    const rig_key *keys;
    grobo_joint_mask only; /* joints that its postures set; 0: all */
} rig_clip;

void rig_clip_init(rig_clip *clip, const rig_key *keys, size_t n);

#endif
