/* SPDX-License-Identifier: MIT */
/**
 * @file grobo.h
 * @brief The main shelf: what a program with a robot needs.
 *
 * Firmware, drivers and protocols find their headers in grobo/core; programs of the original
 * library find theirs in grobo/classic.
 */
#ifndef GROBO_GROBO_H
#define GROBO_GROBO_H

#include <grobo/callback.h>
#include <grobo/clip.h>
#include <grobo/error.h>
#include <grobo/estop.h>
#include <grobo/files.h>
#include <grobo/guard.h>
#include <grobo/limits.h>
#include <grobo/mem.h>
#include <grobo/model.h>
#include <grobo/motion.h>
#include <grobo/motion_io.h>
#include <grobo/posture.h>
#include <grobo/robot.h>
#include <grobo/robot_config.h>
#include <grobo/robot_event.h>
#include <grobo/robot_file.h>
#include <grobo/runner.h>
#include <grobo/session.h>
#include <grobo/sim.h>
#include <grobo/sim_server.h>
#include <grobo/types.h>
#include <grobo/version.h>

#endif
