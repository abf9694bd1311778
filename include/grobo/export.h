/* SPDX-License-Identifier: MIT */
/**
 * @file export.h
 * @brief Visibility and linkage of public names.
 *
 * What carries GROBO_API is the whole of the shared library's binary interface; src/libgrobo.map
 * lists it. A function with GROBO_CORE is in the static libraries alone: it works in storage of
 * the caller, whose size changes from version to version (static.h), or so few programs need it
 * that it is not promised. On Windows define GROBO_STATIC when linking a static library.
 */
#ifndef GROBO_EXPORT_H
#define GROBO_EXPORT_H

#ifdef __cplusplus
#define GROBO_BEGIN_DECLS extern "C" {
#define GROBO_END_DECLS }
#else
/** Before declarations: they are C's in C++ too. */
#define GROBO_BEGIN_DECLS
/** Behind them. */
#define GROBO_END_DECLS
#endif

#if defined(_WIN32) && !defined(GROBO_STATIC)
#ifdef GROBO_BUILDING
#define GROBO_API __declspec(dllexport)
#else
#define GROBO_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
/** In every library. */
#define GROBO_API __attribute__((visibility("default")))
#else
#define GROBO_API
#endif

/** In the classic library (classic/classic.h), which is a static one on Windows. */
#if defined(__GNUC__) && !defined(_WIN32)
#define GROBO_CLASSIC_API __attribute__((visibility("default")))
#else
#define GROBO_CLASSIC_API
#endif

/** In the static libraries alone. */
#define GROBO_CORE

#endif
