/* SPDX-License-Identifier: MIT */
/**
 * @file grobo.h
 * @brief Everything. A program for a small machine includes the headers it needs instead.
 */
#ifndef GROBO_GROBO_H
#define GROBO_GROBO_H

#include <grobo/board.h>
#include <grobo/body.h>
#include <grobo/body_motion.h>
#include <grobo/bus.h>
#include <grobo/callback.h>
#include <grobo/clip.h>
#include <grobo/driver.h>
#include <grobo/dxl1.h>
#include <grobo/dxl2.h>
#include <grobo/error.h>
#include <grobo/estop.h>
#include <grobo/feetech.h>
#include <grobo/files.h>
#include <grobo/gr001.h>
#include <grobo/guard.h>
#include <grobo/hrpsys.h>
#include <grobo/ics.h>
#include <grobo/interpolate.h>
#include <grobo/limits.h>
#include <grobo/loop.h>
#include <grobo/lx16a.h>
#include <grobo/mem.h>
#include <grobo/model.h>
#include <grobo/motion.h>
#include <grobo/motion_io.h>
#include <grobo/port.h>
#include <grobo/posture.h>
#include <grobo/protocol.h>
#include <grobo/registers.h>
#include <grobo/robot.h>
#include <grobo/robot_config.h>
#include <grobo/robot_event.h>
#include <grobo/robot_file.h>
#include <grobo/rs30x.h>
#include <grobo/runner.h>
#include <grobo/sequencer.h>
#include <grobo/serial.h>
#include <grobo/session.h>
#include <grobo/sim.h>
#include <grobo/sim_physics.h>
#include <grobo/sim_server.h>
#include <grobo/team.h>
#include <grobo/types.h>
#include <grobo/version.h>
#include <grobo/words.h>

#endif
