/* SPDX-License-Identifier: MIT */
/*
 * SVG written into memory. Numbers know no locale, texts are escaped whatever bytes they hold, and
 * a failed allocation is kept until svg_close(): nobody checks every line of a drawing.
 */
#ifndef GRCTL_SVG_H
#define GRCTL_SVG_H

#include "tools/grctl/cli/heap.h"

/* The document. */
typedef heap svg;

typedef struct svg_box {
    double x, y, width, height;
} svg_box;

/* Begins a document so large; style: the rules of its style sheet, trusted. */
void svg_open(svg *s, double width, double height, const char *style);
/* Ends it. @return false if memory ran out; then there is no document. */
bool svg_close(svg *s);

/* Names the document, for tooltips and screen readers. kind: "title" or "desc". */
void svg_describe(svg *s, const char *kind, const char *text);

/* Shapes; style_class: a class of the style sheet, trusted. */
void svg_line(svg *s, const char *style_class, double x1, double y1, double x2, double y2);
void svg_rect(svg *s, const char *style_class, const svg_box *box);
/* tip: what is shown when a pointer rests on it, NULL for nothing. */
void svg_circle(svg *s, const char *style_class, double x, double y, double radius,
                const char *tip);
/* anchor: "start", "middle" or "end" of the text is at x. */
void svg_text(svg *s, const char *style_class, double x, double y, const char *anchor,
              const char *text);

/* A line through points: begin, then svg_point() for each, then end. */
void svg_polyline(svg *s, const char *style_class);
void svg_point(svg *s, double x, double y);
void svg_polyline_end(svg *s);

/* Bytes at the start of every document of ours, to know one again. */
extern const char svg_signature[];

#endif
