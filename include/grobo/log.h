/* SPDX-License-Identifier: MIT */
/**
 * @file log.h
 * @brief The library never prints; what it has to say goes to this callback.
 */
#ifndef GROBO_LOG_H
#define GROBO_LOG_H

#include <grobo/export.h>

GROBO_BEGIN_DECLS

/** How much a line matters. */
typedef enum grobo_log_level {
    GROBO_LOG_ERROR = 0, /**< something asked for will not happen */
    GROBO_LOG_WARN = 1,  /**< works, but a person should know */
    GROBO_LOG_INFO = 2,  /**< what happens, a line now and then */
    GROBO_LOG_DEBUG = 3  /**< every step */
} grobo_log_level;

/** A sink of log lines. line: one line without its newline, valid during the call only. */
typedef struct grobo_log {
    void (*write)(void *ctx, grobo_log_level level, const char *line); /**< NULL: silence */
    void *ctx;                                                         /**< handed back to write */
} grobo_log;

GROBO_END_DECLS

#endif
