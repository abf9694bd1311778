/* SPDX-License-Identifier: MIT */
/* An engine on simulated servos of one family, in virtual time: four joints from -90 to 90 degrees,
 * the second mounted the other way round. */
#ifndef GROBO_TEST_FAMILY_KIT_H
#define GROBO_TEST_FAMILY_KIT_H

#include <grobo/core/registers.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>

enum { FAMILY_JOINTS = 4, FAMILY_EVENTS = 64, FAMILY_SENT = 32 };

typedef struct family {
    const char *name; /* of make soak FAMILY= */
    const grobo_servo_table *table;
    const char *servo;
    int (*init)(grobo_driver *driver, const grobo_model *model);
    double near_deg; /* of where it was sent */
    uint32_t baud_bps;
    bool echo;
} family;

/* Every family with a simulated servo: the first behind NULL, NULL behind the last. */
const family *family_next(const family *before);
const family *family_named(const char *name);

typedef struct family_kit {
    const family *family;
    grobo_joint joints[FAMILY_JOINTS];
    grobo_model model;
    const grobo_servo_model *servos[FAMILY_JOINTS];
    grobo_driver driver;
    grobo_robot robot;
    grobo_sim sim;
    grobo_sim_physics *physics; /* set by `change` of family_start_as(); NULL: no weight */
    int64_t now_us;
    grobo_event_job done[FAMILY_EVENTS]; /* the last ones, as a ring */
    unsigned n_done;
    grobo_trip trips[FAMILY_EVENTS];
    unsigned n_trips;
    grobo_event_halted halted; /* the last one */
    unsigned n_halted;
    double most_dps;                                  /* that a shaft was seen to turn */
    uint8_t sent[FAMILY_SENT][GROBO_FRAME_MAX_BYTES]; /* the last frames, as a ring */
    size_t sent_bytes[FAMILY_SENT];
    unsigned n_sent;
    int lose;     /* so many of the next frames do not arrive */
    bool made_up; /* the packet that servos heard last was none of these */
    /* Called at every look at the shafts, and at what servos do; NULL: not. */
    void (*on_look)(struct family_kit *kit);
    void (*on_sim)(struct family_kit *kit, const grobo_sim_event *event);
} family_kit;

/* sim NULL: seed 7. What of it makes the family is filled in. */
void family_start(family_kit *kit, const family *f, const grobo_robot_config *config,
                  const grobo_sim_config *sim);
/* The same with other joints: `change` is called when those above are made. */
void family_start_as(family_kit *kit, const family *f, const grobo_robot_config *config,
                     const grobo_sim_config *sim, void (*change)(family_kit *kit));
/* Takes what the robot tells, and brings its link up: of one that was initialised anew, too. */
void family_listen(family_kit *kit);
/* Sets a register of a servo behind the robot's back. */
void family_set_up(family_kit *kit, int servo, grobo_register_role role, int32_t value);
double family_angle_deg(family_kit *kit, int joint);
void family_run(family_kit *kit, int64_t us);
/* Lets time pass until a job is over: its result. */
int family_wait(family_kit *kit, int number);
/* The first joint to deg, each further one 10 degrees below the one before. */
grobo_posture family_posture(const family_kit *kit, double deg, int time_ms);
int family_move(family_kit *kit, double deg, int time_ms);
/* Fails unless the joints are at such a posture. */
void family_at(family_kit *kit, double deg);

#endif
