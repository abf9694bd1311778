/* SPDX-License-Identifier: MIT */
/*
 * Files that are to outlive a loss of power: a thread waits for the disk, so that the loop that
 * moves a robot never does. All functions are for one and the same thread.
 */
#ifndef GRCTL_SYNC_H
#define GRCTL_SYNC_H

/*
 * Has what was written to the file until now, and its name, reach the disk soon. path is shorter
 * than GROBO_PATH_MAX_BYTES. Returns 0 or errno: ENOMEM (no thread), or why the disk refused one
 * before.
 */
int sync_soon(const char *path);
/* Waits until the disk has all of it. */
void sync_end(void);

#endif
