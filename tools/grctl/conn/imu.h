/* SPDX-License-Identifier: MIT */
/* An IMU beside the robot: how its base stands, read from a port of its own, for the engine. */
#ifndef GRCTL_IMU_H
#define GRCTL_IMU_H

#include <grobo/core/imu.h>
#include <grobo/core/serial.h>

#include "tools/grctl/conn/conn.h"

enum { IMU_LINE_BYTES = 160 };

/* What --imu says in the help. */
#define IMU_OPTION                                                                                 \
    OPTION_TEXT("imu", 0, "PORT", "an IMU of the base: lines of roll, pitch and three rates")

typedef struct imu imu;
struct imu {
    /* private */
    conn *c;
    grobo_serial *serial;
    char line[IMU_LINE_BYTES];
    size_t n;
    bool broken; /* the rest of this line is dropped: it is too long, or its begin was not seen */
    unsigned long lines, bad;
    void (*took)(void *ctx, const grobo_imu *reading); /* each reading, or NULL */
    void *ctx;
};

/* Opens a port and reads from then on, in the loop of the connection. Returns 0, or the exit status
 * with the reason said. imu_close() is called in either case. */
int imu_open(imu *i, conn *c, const char *port);

void imu_close(imu *i);

/*
 * A line: roll, pitch in degrees, and three rates in degrees a second, with spaces, tabs or a comma
 * between them; what follows is not looked at. Returns whether it is one.
 */
bool imu_parse(const char *line, grobo_imu *reading);

#endif
