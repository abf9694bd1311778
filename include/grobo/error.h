/* SPDX-License-Identifier: MIT */
/**
 * @file error.h
 * @brief The one result convention: int, >= 0 is success or a count, < 0 is one of these.
 *
 * Out-parameters are untouched when a call fails. The cause that an operating system gave is kept
 * by the object that met it (grobo_serial_cause() and the like); callers never read errno.
 *
 * NULL where something must be is GROBO_ERR_ARG; for no bytes at all it may stand. What returns no
 * such result does nothing then, and returns 0, false or NULL, as a deadline GROBO_NEVER_US.
 * `_free` takes NULL.
 */
#ifndef GROBO_ERROR_H
#define GROBO_ERROR_H

#include <grobo/export.h>

GROBO_BEGIN_DECLS

/** Every error: X(name, value, text). Values are part of the binary interface: append only. */
#define GROBO_ERROR_LIST(X)                                                                        \
    X(ARG, -1, "argument out of range")                                                            \
    X(NOMEM, -2, "out of memory")                                                                  \
    X(STATE, -3, "not possible in the present state")                                              \
    X(SPACE, -4, "buffer too small")                                                               \
    X(FULL, -5, "queue full")                                                                      \
    X(CAP, -6, "larger than a built-in cap allows")                                                \
    X(LIMIT, -7, "outside a joint's limits")                                                       \
    X(SPEED, -8, "faster than the servo can move")                                                 \
    X(NAN, -9, "not a finite number")                                                              \
    X(FRAME, -10, "malformed frame")                                                               \
    X(CHECKSUM, -11, "wrong checksum")                                                             \
    X(NACK, -12, "refused by the device")                                                          \
    X(TIMEOUT, -13, "no reply in time")                                                            \
    X(SHORT, -14, "reply cut short")                                                               \
    X(MISMATCH, -15, "reply does not fit the request")                                             \
    X(IO, -16, "input or output failed")                                                           \
    X(NOENT, -17, "no such file or device")                                                        \
    X(PERM, -18, "permission denied")                                                              \
    X(BUSY, -19, "in use by another program")                                                      \
    X(UNPLUGGED, -20, "device is gone")                                                            \
    X(CLOSED, -21, "not open")                                                                     \
    X(UNSUPPORTED, -22, "not supported here")                                                      \
    X(SYNTAX, -23, "malformed file")                                                               \
    X(TYPE, -24, "not the kind of file expected")                                                  \
    X(CANCELED, -25, "canceled")                                                                   \
    X(LATCHED, -26, "stopped for safety until reset")                                              \
    X(STALE, -27, "no fresh value")                                                                \
    X(NOTFOUND, -28, "no such name")                                                               \
    X(EMPTY, -29, "nothing there")                                                                 \
    X(EXISTS, -30, "exists already")                                                               \
    X(ISDIR, -31, "is a directory")                                                                \
    X(UNREACHABLE, -32, "target out of reach")                                                     \
    X(DISK, -33, "no room left on the disk")                                                       \
    X(UNWATCHED, -34, "the line leaves no time to read the joints")                                \
    X(STALLED, -35, "stopped by the guard while the program stood still")                          \
    X(SUPERSEDED, -36, "another request took its joints")                                          \
    X(SETUP, -37, "servo is not set up as its joint needs")                                        \
    X(PENDING, -38, "has not ended in the time given")                                             \
    X(OUTSIDE, -39, "outside the directory of motions")

/** The errors as an enum: GROBO_ERR_ARG, GROBO_ERR_NOMEM, ... */
typedef enum grobo_error {
    GROBO_OK = 0, /**< success */
/** Makes one of them. */
#define GROBO_ERROR_ENUM(name, value, text) GROBO_ERR_##name = (value),
    GROBO_ERROR_LIST(GROBO_ERROR_ENUM)
#undef GROBO_ERROR_ENUM
} grobo_error;

/**
 * Short name of a result, for logs and JSON: "TIMEOUT" for GROBO_ERR_TIMEOUT, "OK" for any
 * value >= 0, "UNKNOWN" for a number that is no error of this library.
 * @return static string, never NULL. Thread safe.
 */
GROBO_API const char *grobo_error_name(int result);

/**
 * One English phrase for a result, without capital and without full stop: "no reply in time".
 * @return static string, never NULL. Thread safe.
 */
GROBO_API const char *grobo_error_text(int result);

GROBO_END_DECLS

#endif
