/* SPDX-License-Identifier: MIT */
/**
 * @file export.h
 * @brief Visibility and linkage of public names.
 *
 * Whatever a header of this directory declares is in every library: shared, static, DLL.
 * src/libgrobo.map lists it. On Windows define GROBO_STATIC when linking a static library.
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

#endif
