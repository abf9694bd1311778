/* SPDX-License-Identifier: MIT */
/* XML of strangers, read by expat: elements with their attributes. No document types, so no
 * entities but those of XML itself. */
#ifndef GRCTL_XML_H
#define GRCTL_XML_H

#include <stddef.h>

enum { XML_DEPTH_MAX = 64, XML_TROUBLE_BYTES = 128 };

/* Hears elements; attributes are names and values in turn, NULL behind the last. What stands in an
 * element may come in pieces. */
typedef struct xml_ear {
    void (*begin)(void *ctx, int depth, const char *name, const char *const *attributes);
    void (*text)(void *ctx, const char *bytes, size_t size);
    void (*end)(void *ctx, int depth);
    void *ctx;
} xml_ear;

typedef struct xml_trouble {
    unsigned line, column; /* from 1 */
    char text[XML_TROUBLE_BYTES];
} xml_trouble;

/* Reads all of it. The first element has depth 0. Returns 0, or -1 with the trouble: the first. */
int xml_read(const char *bytes, size_t size, const xml_ear *ear, xml_trouble *trouble);

/* While an ear hears: the line that it is at. */
unsigned xml_line(void);

/* Why there is no XML here, or NULL. */
const char *xml_missing(void);

#endif
