/* SPDX-License-Identifier: MIT */
/* SVG: how numbers are written, and which texts are taken apart. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/test.h"
#include "tools/grctl/view/svg.h"

static void expect_points(double x, double y, const char *be)
{
    svg s;
    svg_open(&s, 100, 50, "");
    svg_polyline(&s, "line");
    svg_point(&s, x, y);
    svg_polyline_end(&s);
    assert_true(svg_close(&s));
    const char *points = strstr(s.bytes, "points=\"");
    assert_non_null(points);
    if (strncmp(points + 8, be, strlen(be)) != 0) {
        fail_msg("%g and %g: %.40s", x, y, points);
    }
    free(s.bytes);
}

TEST(a_number_has_its_sign_and_the_decimals_that_it_needs)
{
    expect_points(-12.5, 12.5, "-12.5,12.5 \"");
    expect_points(-0.25, 0.25, "-0.25,0.25 \"");
    expect_points(-0.004, 0.005, "0,0.01 \"");
    expect_points(-3, 120, "-3,120 \"");
    expect_points(7.05, -7.05, "7.05,-7.05 \"");
    expect_points(0, -0.0, "0,0 \"");
}

TEST(what_is_no_number_is_written_as_one)
{
    svg s;
    svg_open(&s, 100, 50, "");
    svg_line(&s, "line", (double)NAN, (double)INFINITY, -(double)INFINITY, 1e300);
    assert_true(svg_close(&s));
    assert_null(strstr(s.bytes, "nan"));
    assert_null(strstr(s.bytes, "inf"));
    assert_non_null(strstr(s.bytes, "x1=\"0\""));
    assert_non_null(strstr(s.bytes, "x2=\"-1"));
    free(s.bytes);
}

TEST(a_text_says_nothing_but_text)
{
    static const struct {
        const char *text, *be;
    } rows[] = {{"a<b>&\"", ">a&lt;b&gt;&amp;&quot;<"},
                {"\xc3\xa4\xe2\x82\xac", ">\xc3\xa4\xe2\x82\xac<"},
                {"\x01", ">\xef\xbf\xbd<"},
                {"\xe2\x80\xae", ">\xef\xbf\xbd<"},         /* turns the direction */
                {"\xed\xa0\x80", ">\xef\xbf\xbd"},          /* a surrogate */
                {"\xc0\xaf", ">\xef\xbf\xbd\xef\xbf\xbd<"}, /* longer than it needs to be */
                {"\xef\xbf\xbe", ">\xef\xbf\xbd<"},
                {"\xe2\x82", ">\xef\xbf\xbd"}}; /* cut */
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        svg s;
        svg_open(&s, 100, 50, "");
        svg_text(&s, "name", 1, 2, "start", rows[i].text);
        assert_true(svg_close(&s));
        if (strstr(s.bytes, rows[i].be) == NULL) {
            fail_msg("row %zu: %s", i, s.bytes);
        }
        free(s.bytes);
    }
}
