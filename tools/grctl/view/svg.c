/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "tools/grctl/view/svg.h"

enum { DECIMALS = 100 };

/* Beyond this a coordinate means nothing; it keeps numbers short and the arithmetic exact. */
static const double number_most = 1e9;

const char svg_signature[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- drawn by grctl plot -->\n";

static void put(svg *s, const char *markup)
{
    heap_add(s, markup, strlen(markup));
}

/* A number with at most two decimals, none that are zero at its end. */
static void put_number(svg *s, double number)
{
    char text[32];
    size_t at = sizeof text;
    double nearest = round(fabs(number) * DECIMALS);
    if (!(nearest <= number_most * DECIMALS)) {
        nearest = isnan(number) ? 0 : number_most * DECIMALS;
    }
    uint64_t rest = (uint64_t)nearest;
    if (number < 0 && rest > 0) {
        put(s, "-");
    }
    if (rest % DECIMALS) {
        if (rest % 10) {
            text[--at] = (char)('0' + rest % 10);
        }
        text[--at] = (char)('0' + rest / 10 % 10);
        text[--at] = '.';
    }
    rest /= DECIMALS;
    do {
        text[--at] = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest);
    heap_add(s, text + at, sizeof text - at);
}

/* ---- text ---------------------------------------------------------------------------------- */

/* The character at text and its length, or -1 where the bytes are no UTF-8. */
static long decode(const unsigned char *text, size_t *length)
{
    static const long least[] = {0, 0, 0x80, 0x800, 0x10000};
    size_t n = text[0] < 0x80   ? 1
               : text[0] < 0xc2 ? 0
               : text[0] < 0xe0 ? 2
               : text[0] < 0xf0 ? 3
                                : 4;
    *length = 1;
    if (n == 1) {
        return text[0];
    }
    if (n == 0 || text[0] > 0xf4) {
        return -1;
    }
    long c = text[0] & (0x7f >> n);
    for (size_t i = 1; i < n; i++) {
        if ((text[i] & 0xc0) != 0x80) {
            return -1;
        }
        c = c << 6 | (text[i] & 0x3f);
    }
    if (c < least[n] || c > 0x10ffff) {
        return -1;
    }
    *length = n;
    return c;
}

/* Characters that XML forbids, and those that turn the direction of what stands around them. */
static bool is_fit(long c)
{
    bool control = c < 0x20 || (c >= 0x7f && c < 0xa0);
    bool surrogate = c >= 0xd800 && c < 0xe000;
    bool none = c == 0xfffe || c == 0xffff;
    bool turns = (c >= 0x202a && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
    return !control && !surrogate && !none && !turns;
}

static const char *entity(long c)
{
    switch (c) {
    case '&':
        return "&amp;";
    case '<':
        return "&lt;";
    case '>':
        return "&gt;";
    case '"':
        return "&quot;";
    }
    return NULL;
}

static void put_text(svg *s, const char *text)
{
    for (size_t length; *text; text += length) {
        long c = decode((const unsigned char *)text, &length);
        if (c < 0 || !is_fit(c)) {
            put(s, "\xef\xbf\xbd"); /* U+FFFD */
        } else if (entity(c)) {
            put(s, entity(c));
        } else {
            heap_add(s, text, length);
        }
    }
}

/* ---- elements ------------------------------------------------------------------------------ */

static void put_attribute(svg *s, const char *name, double number)
{
    heap_print(s, " %s=\"", name);
    put_number(s, number);
    put(s, "\"");
}

static void begin(svg *s, const char *element, const char *style_class)
{
    heap_print(s, "<%s class=\"%s\"", element, style_class);
}

void svg_open(svg *s, double width, double height, const char *style)
{
    memset(s, 0, sizeof *s);
    put(s, svg_signature);
    put(s, "<svg xmlns=\"http://www.w3.org/2000/svg\"");
    put_attribute(s, "width", width);
    put_attribute(s, "height", height);
    put(s, " viewBox=\"0 0 ");
    put_number(s, width);
    put(s, " ");
    put_number(s, height);
    put(s, "\" role=\"img\">\n<style>\n");
    put(s, style);
    put(s, "</style>\n");
}

bool svg_close(svg *s)
{
    put(s, "</svg>\n");
    return s->bytes != NULL;
}

void svg_describe(svg *s, const char *kind, const char *text)
{
    heap_print(s, "<%s>", kind);
    put_text(s, text);
    heap_print(s, "</%s>\n", kind);
}

void svg_line(svg *s, const char *style_class, double x1, double y1, double x2, double y2)
{
    begin(s, "line", style_class);
    put_attribute(s, "x1", x1);
    put_attribute(s, "y1", y1);
    put_attribute(s, "x2", x2);
    put_attribute(s, "y2", y2);
    put(s, "/>\n");
}

void svg_rect(svg *s, const char *style_class, const svg_box *box)
{
    begin(s, "rect", style_class);
    put_attribute(s, "x", box->x);
    put_attribute(s, "y", box->y);
    put_attribute(s, "width", box->width);
    put_attribute(s, "height", box->height);
    put(s, "/>\n");
}

void svg_circle(svg *s, const char *style_class, double x, double y, double radius, const char *tip)
{
    begin(s, "circle", style_class);
    put_attribute(s, "cx", x);
    put_attribute(s, "cy", y);
    put_attribute(s, "r", radius);
    if (tip) {
        put(s, "><title>");
        put_text(s, tip);
        put(s, "</title></circle>\n");
    } else {
        put(s, "/>\n");
    }
}

void svg_text(svg *s, const char *style_class, double x, double y, const char *anchor,
              const char *text)
{
    begin(s, "text", style_class);
    put_attribute(s, "x", x);
    put_attribute(s, "y", y);
    heap_print(s, " text-anchor=\"%s\">", anchor);
    put_text(s, text);
    put(s, "</text>\n");
}

void svg_polyline(svg *s, const char *style_class)
{
    begin(s, "polyline", style_class);
    put(s, " points=\"");
}

void svg_point(svg *s, double x, double y)
{
    put_number(s, x);
    put(s, ",");
    put_number(s, y);
    put(s, " ");
}

void svg_polyline_end(svg *s)
{
    put(s, "\"/>\n");
}
