/* SPDX-License-Identifier: MIT */
/**
 * @file version.h
 * @brief The version of the headers, and of the library a program is linked with.
 */
#ifndef GROBO_VERSION_H
#define GROBO_VERSION_H

#include <grobo/export.h>

/** Changes with what breaks programs. */
#define GROBO_VERSION_MAJOR 0
/** Before 1.0 it does so too. */
#define GROBO_VERSION_MINOR 1
/** Changes with corrections alone. */
#define GROBO_VERSION_PATCH 0
/** All three. */
#define GROBO_VERSION_STRING "0.1.0"

/** major * 10000 + minor * 100 + patch, for conditions of the preprocessor. */
#define GROBO_VERSION_NUMBER                                                                       \
    (GROBO_VERSION_MAJOR * 10000 + GROBO_VERSION_MINOR * 100 + GROBO_VERSION_PATCH)

GROBO_BEGIN_DECLS

/** GROBO_VERSION_STRING of the library at run time. Static string. Thread safe. */
GROBO_API const char *grobo_version(void);

GROBO_END_DECLS

#endif
