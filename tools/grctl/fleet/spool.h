/* SPDX-License-Identifier: MIT */
/* Events of an agent whose broker is away: kept on disk, at most 256 KiB, the oldest go first. */
#ifndef GRCTL_FLEET_SPOOL_H
#define GRCTL_FLEET_SPOOL_H

#include <stdbool.h>

#include <jansson.h>

enum { SPOOL_FILE_BYTES = 1 << 17, SPOOL_LINE_BYTES = 1 << 14 };

/*
 * Keeps one in PATH, or in PATH.old when that is full. path: shorter than 1000 bytes. The disk has
 * it a moment later (tools/grctl/cli/sync.h), sync_end() waits for that. False: it is not kept, or
 * the disk refused one before.
 */
bool spool_add(const char *path, const json_t *event);
/* Hands over what is kept, the oldest first, and forgets it; what cannot be read is dropped. */
void spool_empty(const char *path, void (*take)(void *ctx, json_t *event), void *ctx);

#endif
