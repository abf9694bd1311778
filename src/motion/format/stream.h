/* SPDX-License-Identifier: MIT */
/* Files as sources of bytes. */
#ifndef GROBO_MOTION_STREAM_H
#define GROBO_MOTION_STREAM_H

#include <grobo/core/motion_io.h>

/* Opens a file for reading. @return 0, or GROBO_ERR_NOENT, _PERM, _ISDIR, _IO */
int grobo_i_stream_open(const char *path, grobo_source *source);
/* The same; what is wrong is said of the file of this name. */
int grobo_i_stream_open_said(const char *path, const char *name, grobo_diagnostics *list,
                             grobo_source *source);
void grobo_i_stream_close(const grobo_source *source);

#endif
