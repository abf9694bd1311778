/* SPDX-License-Identifier: MIT */
/**
 * @file limits.h
 * @brief Everything that grows has a cap, and the cap has a name here.
 *
 * A cap that is defined only where it is not yet may be lowered with -D when the core is built for
 * a small machine; library and users must then be compiled with the same value.
 */
#ifndef GROBO_LIMITS_H
#define GROBO_LIMITS_H

/** Joints a posture can hold; at most 64 (a grobo_joint_mask has 64 bits). */
#ifndef GROBO_JOINTS_MAX
#define GROBO_JOINTS_MAX 64
#endif

/*
 * A program and its library must have the same cap, as postures are as long as that. So another cap
 * than the default is part of the names of what makes things: a mismatch fails where the program is
 * linked. The shared library has the default.
 */
#if GROBO_JOINTS_MAX != 64
#define GROBO_CAPPED__(name, cap) name##_##cap
#define GROBO_CAPPED_(name, cap) GROBO_CAPPED__(name, cap)
#define grobo_posture_init GROBO_CAPPED_(grobo_posture_init, GROBO_JOINTS_MAX)
#define grobo_posture_init_pose GROBO_CAPPED_(grobo_posture_init_pose, GROBO_JOINTS_MAX)
#define grobo_robot_init_sized GROBO_CAPPED_(grobo_robot_init_sized, GROBO_JOINTS_MAX)
#define grobo_sequencer_init GROBO_CAPPED_(grobo_sequencer_init, GROBO_JOINTS_MAX)
#define grobo_sim_init_sized GROBO_CAPPED_(grobo_sim_init_sized, GROBO_JOINTS_MAX)
#define grobo_session_new GROBO_CAPPED_(grobo_session_new, GROBO_JOINTS_MAX)
#define grobo_runner_new GROBO_CAPPED_(grobo_runner_new, GROBO_JOINTS_MAX)
#define grobo_motion_new GROBO_CAPPED_(grobo_motion_new, GROBO_JOINTS_MAX)
#define grobo_motion_read GROBO_CAPPED_(grobo_motion_read, GROBO_JOINTS_MAX)
#define grobo_motion_read_file GROBO_CAPPED_(grobo_motion_read_file, GROBO_JOINTS_MAX)
#endif

/** Longest packet inside a relay frame of the board: its length has 7 bits (protocol 2). */
#define GROBO_RELAY_MAX_BYTES 127

/** Longest return packet: No.0..139 of the memory map with header and sum (protocol 3, 4). */
#define GROBO_REPLY_MAX_BYTES 148

/** Longest frame on a line, sent or received, of any family. Firmware lowers it to what its family
 *  needs: RS30x takes GROBO_REPLY_MAX_BYTES, which is the least (a relay frame is shorter). */
#ifndef GROBO_FRAME_MAX_BYTES
#define GROBO_FRAME_MAX_BYTES 1024
#endif

/** Registers of an RS30x servo: No.0..139 (protocol 3: FLAGS 0F reads 0..139). */
#define GROBO_REGISTERS 140

/** Highest servo id of any family; a protocol has its own (grobo_protocol.id_max). */
#define GROBO_SERVO_ID_MAX 253

/** Replies that one frame may ask for by name. */
#define GROBO_REPLIES_MAX 64

/**
 * 1 in a firmware whose drivers are like that of RS30x servos, which tell the time of their way:
 * what the engine does for others is left out. A driver is refused that has `accel_rad_s2`,
 * `goal_energises`, `tells_no_speed`, `keeps_setup`, sense_many(), sense_fast(), sense_more(),
 * watchdog() or torque_limit().
 */
#ifndef GROBO_DRIVERS_PLAIN
#define GROBO_DRIVERS_PLAIN 0
#endif

/**
 * 1 in a firmware whose drivers, models and protocols are compiled with the core: these tables keep
 * no sizes, and none is looked at. See GROBO_TABLE() (types.h).
 */
#ifndef GROBO_TABLES_FIXED
#define GROBO_TABLES_FIXED 0
#endif

/** Lines (ports) of a robot: grobo/core/lines.h. Firmware has one. */
#ifndef GROBO_LINES_MAX
#if GROBO_TABLES_FIXED || GROBO_DRIVERS_PLAIN
#define GROBO_LINES_MAX 1
#else
#define GROBO_LINES_MAX 4
#endif
#endif

/** Motions that may wait behind the one being played. */
#ifndef GROBO_QUEUE_MAX
#define GROBO_QUEUE_MAX 8
#endif

/** Bytes that may wait to be sent on a serial port. */
#ifndef GROBO_SERIAL_QUEUE_BYTES
#define GROBO_SERIAL_QUEUE_BYTES 4096
#endif

/** Transactions that may wait in one bus. */
#ifndef GROBO_BUS_QUEUE_MAX
#define GROBO_BUS_QUEUE_MAX (3 * GROBO_JOINTS_MAX + 16)
#endif

/** Servos a simulator has; at least the joints of its model. */
#ifndef GROBO_SIM_SERVOS_MAX
#define GROBO_SIM_SERVOS_MAX GROBO_JOINTS_MAX
#endif
/** Bytes on a simulated wire, in each direction; at most 32767. */
#ifndef GROBO_SIM_WIRE_BYTES
#define GROBO_SIM_WIRE_BYTES 1024
#endif
/** Bytes the simulated board keeps while it is busy; at most 32767. */
#ifndef GROBO_SIM_FIFO_BYTES
#define GROBO_SIM_FIFO_BYTES 512
#endif
/** Longest packet that simulated servos hear. */
#ifndef GROBO_SIM_EAR_BYTES
#define GROBO_SIM_EAR_BYTES GROBO_FRAME_MAX_BYTES
#endif
/** Replies under way at the same time on the simulated servos' bus. */
#ifndef GROBO_SIM_TALKS_MAX
#define GROBO_SIM_TALKS_MAX (GROBO_SIM_SERVOS_MAX + 8)
#endif

/** Motion files: bytes read at most. */
#define GROBO_FILE_MAX_BYTES (1024L * 1024L * 1024L)
/** Motion files: nesting of the YAML document. */
#define GROBO_YAML_DEPTH_MAX 32
/** Motion files: aliases followed in one document. */
#define GROBO_YAML_ALIASES_MAX 1024
/** Motion files: nodes with an anchor in one document. */
#define GROBO_YAML_ANCHORS_MAX 1024
/** Motion files: YAML events remembered of nodes with an anchor. */
#define GROBO_YAML_ANCHORED_EVENTS_MAX 65536
/** Motion files: bytes of texts remembered of nodes with an anchor. */
#define GROBO_YAML_ANCHORED_MAX_BYTES (1024L * 1024L)
/** Motion files: YAML events that following aliases makes. */
#define GROBO_YAML_REPLAYED_EVENTS_MAX 4000000
/** Motion files: bytes between two YAML events: a long comment, or a text that is refused. */
#define GROBO_YAML_GAP_MAX_BYTES 131072
/** Motion files: keys of one mapping that have no meaning here. */
#define GROBO_YAML_UNKNOWN_KEYS_MAX 256
/** Motion files: anchors that one mapping merges (<<). */
#define GROBO_YAML_MERGES_MAX 16
/** Motion files: bytes of one mapping key. */
#define GROBO_YAML_KEY_MAX_BYTES 128
/** Motion files: bytes of one scalar that is kept (names, unknown values). */
#define GROBO_YAML_SCALAR_MAX_BYTES 65536
/** Largest limit_slack_deg of a model. */
#define GROBO_LIMIT_SLACK_MAX_DEG 5
/** Motion files: postures or frames of one motion. */
#define GROBO_MOTION_FRAMES_MAX 10000000
/** Motion files: postures from the front whose angles' places can be kept (keep_positions). */
#define GROBO_MOTION_POSITIONS_MAX 10000
/** Motion files: components of a body motion whose rates are compared with that of the joints. */
#define GROBO_MOTION_COMPONENTS_MAX 64
/** Motion files: bytes of one line of a .m file. */
#define GROBO_M_LINE_MAX_BYTES 16384
/** Motion files: ikLinks of one key pose. */
#define GROBO_IK_LINKS_MAX 16
/** Names of joints, links, motions: bytes with the final NUL. */
#define GROBO_NAME_MAX_BYTES 64
/** Robot files: groups of joints. */
#define GROBO_ROBOT_GROUPS_MAX 32
/** Robot files: rigid parts. */
#define GROBO_ROBOT_LINKS_MAX 64
/** Robot files: USB ids. */
#define GROBO_ROBOT_USB_MAX 8
/** Motion files: diagnostics kept of one file; more are counted only. */
#define GROBO_DIAGNOSTICS_MAX 1000

#endif
