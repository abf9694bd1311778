/* SPDX-License-Identifier: MIT */
/**
 * @file classic.h
 * @brief The classic shelf: every class of the reference document. Link with -lgrobo-classic.
 *
 * `a.b(c)` of a C++ program is `Class_b(&a, c)`, where Class is the one that the document has b in;
 * a GR001 is a SerialRobot. `new Class(c)` is `Class_new(c)`, `delete a` is `Class_delete(a)`, and
 * an object in the caller's storage begins with Class_init() and ends with Class_deinit().
 *
 * Overloads:
 * | C++ | C |
 * |---|---|
 * | SerialCom() | SerialCom_init() |
 * | SerialCom(devname) | SerialCom_init_devname() |
 * | printPosture(stream), printMotion(stream) | ..._stream() |
 * | copyPosture(p, offset) | RobotPosture_copyPosture_offset() |
 * | saveMotionToFile(name, dir) | RobotMotion_saveMotionToFile_dir() |
 * | appendCurrentPosture(mtime) | SerialRobot_appendCurrentPosture_time() |
 * | connect(n) | GR001_connect_port() |
 * | servo(jname, turnon) | GR001_servo_name() |
 *
 * std::ofstream is a FILE, std::string a char array and its size, std::vector an array and its
 * length.
 */
#ifndef GROBO_CLASSIC_CLASSIC_H
#define GROBO_CLASSIC_CLASSIC_H

#include <grobo/classic/gr001.h>
#include <grobo/classic/hrpsys.h>
#include <grobo/classic/robot_motion.h>
#include <grobo/classic/robot_posture.h>
#include <grobo/classic/serial_com.h>
#include <grobo/classic/serial_robot.h>

#endif
